//! Work of joints and solids within an increment, along a straight path from the gaps and strains at its start to
//! those at its end (theory/procedures.md, eq. 15).
//!
//! An increment has tractions at its ends only. A bond that breaks within it has carried more in between:
//!
//! ```text
//! t |   /\              t(s): the law, from the old history, at the gap g₀ + s Δg
//!   |  /  \_            the straight line: between the tractions at both ends
//!   | /.....\__
//!   +----------- s      W(s) = Σ A (t(s) − straight)·Δg, and of solids Σ V (σ(s) − straight):Δε
//!   0          1
//! ```

use nalgebra::Vector6;
use rayon::prelude::*;
use wythe_contact::JointLaw;

use super::System;
use super::bulk::Bulk;
use super::contact::Contact;
use crate::assembly::Trial;
use crate::material::MaterialHistory;
use crate::model::Model;
use crate::state::State;

/// Parts of an increment at which this work is computed. They are dense at its start, where a bond breaks that a
/// long increment tears.
pub const PARTS: [f64; 14] = [
    1.0 / 4096.0,
    1.0 / 1024.0,
    1.0 / 256.0,
    1.0 / 128.0,
    1.0 / 64.0,
    1.0 / 32.0,
    1.0 / 16.0,
    1.0 / 8.0,
    1.0 / 4.0,
    3.0 / 8.0,
    1.0 / 2.0,
    5.0 / 8.0,
    3.0 / 4.0,
    7.0 / 8.0,
];

/// Points or elements of one task. Sums of tasks are added in the order of the tasks.
const TASK: usize = 128;

/// Smallest change of damage that counts [-].
const CHANGES: f64 = 1e-6;

/// W(s) at each of [`PARTS`], s [N mm].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Works {
    /// Of the whole way Δg and Δε.
    pub whole: [f64; PARTS.len()],
    /// Of the way Δg and of the inelastic part of the other, Δε − C⁻¹Δσ.
    pub inelastic: [f64; PARTS.len()],
}

impl System {
    /// Work that joints and solids would do on the way of an increment beyond the trapezoidal rule, after each of
    /// [`PARTS`] of the way [N mm]. `trial` ends the increment, which lasts `dt` [s].
    pub fn work_between(&self, model: &Model, state: &State, trial: &Trial, dt: f64) -> Works {
        let mut work = self.contact.work_between(model, state, trial);
        add(&mut work, &self.bulk.work_between(state, trial, dt));
        work
    }

    /// Work in the increment of `dt` [s] that `trial` ends, of the stress that solids carry because their damage lags
    /// behind its law [N mm].
    pub fn work_of_lag(&self, state: &State, trial: &Trial, dt: f64) -> f64 {
        self.bulk.work_of_lag(state, trial, dt)
    }
}

impl Contact {
    fn work_between(&self, model: &Model, state: &State, trial: &Trial) -> Works {
        in_order(self.points.len(), |p, sum| {
            let (old, new) = (&state.interface[p], &trial.joints.history[p]);
            let slid = new.plastic_slip != old.plastic_slip;
            let damaged = new.damage - old.damage > CHANGES;
            if !(slid || damaged) || trial.joints.pairs[p].facet.is_none() || self.is_image(p) {
                return;
            }
            let law = self.law(model, p);
            let gap = |h: &wythe_contact::InterfaceHistory| [h.opening, h.slip[0], h.slip[1]];
            let (from, to) = (gap(old), gap(new));
            let way = [0, 1, 2].map(|i| to[i] - from[i]);
            let area = self.points[p].area;
            for (k, s) in PARTS.into_iter().enumerate() {
                let at = [0, 1, 2].map(|i| from[i] + s * way[i]);
                let traction = law.update(at, old).traction;
                // Tractions of the commits are used here. With the shifted penalty the law at their gaps gives
                // slightly different ones.
                let line = |i: usize| old.traction[i] + s * (new.traction[i] - old.traction[i]);
                let work = area
                    * (0..3)
                        .map(|i| (traction[i] - line(i)) * way[i])
                        .sum::<f64>();
                // The stiffness of the scene contains that of its joints.
                sum.whole[k] += work;
                sum.inelastic[k] += work;
            }
        })
    }
}

impl Bulk {
    fn work_between(&self, state: &State, trial: &Trial, dt: f64) -> Works {
        in_order(self.elements.len(), |e, sum| {
            if trial
                .solids
                .marks
                .get(e)
                .is_some_and(|marks| marks.new == 0)
            {
                return;
            }
            let (law, shape) = (self.law(e), self.shape(e));
            for g in 0..8 {
                let (old, new) = (&state.material[8 * e + g], &trial.solids.history[8 * e + g]);
                let tensile = new.tensile_damage - old.tensile_damage;
                let compressive = new.compressive_damage - old.compressive_damage;
                let yields = new.kappa_t > old.kappa_t || new.kappa_c > old.kappa_c;
                if !yields && tensile.max(compressive) <= CHANGES {
                    continue;
                }
                let (Some(from), Some(to)) = (self.strain(e, old), self.strain(e, new)) else {
                    continue;
                };
                let way = to - from;
                let change = new.stress - old.stress;
                let inelastic = way - law.elastic_strain(&change);
                for (k, s) in PARTS.into_iter().enumerate() {
                    let at = from + way * s;
                    let stress = law.update(&at, old, s * dt, false).map(|r| r.stress);
                    let beyond = stress.unwrap_or_default() - (old.stress + change * s);
                    sum.whole[k] += shape.weight[g] * beyond.dot(&way);
                    sum.inelastic[k] += shape.weight[g] * beyond.dot(&inelastic);
                }
            }
        })
    }

    fn work_of_lag(&self, state: &State, trial: &Trial, dt: f64) -> f64 {
        let prompt = self.prompt_laws();
        let works = (0..self.elements.len()).map(|e| {
            let (law, shape) = (&prompt[self.law_of[e] as usize], self.shape(e));
            let of_point = |g: usize| {
                let (old, new) = (&state.material[8 * e + g], &trial.solids.history[8 * e + g]);
                if new.damage - new.viscous_damage <= CHANGES {
                    return 0.0;
                }
                let (Some(from), Some(to)) = (self.strain(e, old), self.strain(e, new)) else {
                    return 0.0;
                };
                let stress = law
                    .update(&to, old, dt, false)
                    .map_or(new.stress, |r| r.stress);
                shape.weight[g] * (new.stress - stress).dot(&(to - from))
            };
            (0..8).map(of_point).sum::<f64>()
        });
        works.sum()
    }

    /// Strain of a point with this history [-], from its stress. None where the point has lost its stiffness.
    fn strain(&self, e: usize, history: &MaterialHistory) -> Option<Vector6<f64>> {
        let intact = 1.0 - history.viscous_damage;
        (intact > 1e-6).then(|| {
            self.law(e).elastic_strain(&(history.stress / intact)) + history.viscous_strain
        })
    }
}

fn add(sum: &mut Works, more: &Works) {
    for k in 0..PARTS.len() {
        sum.whole[k] += more.whole[k];
        sum.inelastic[k] += more.inelastic[k];
    }
}

/// Sum of the works that `work` adds for each index below `count`. It is the same on any number of threads.
fn in_order(count: usize, work: impl Fn(usize, &mut Works) + Sync) -> Works {
    let tasks: Vec<Works> = (0..count.div_ceil(TASK))
        .into_par_iter()
        .map(|task| {
            let mut sum = Works::default();
            for one in task * TASK..count.min((task + 1) * TASK) {
                work(one, &mut sum);
            }
            sum
        })
        .collect();
    let mut sum = Works::default();
    for task in &tasks {
        add(&mut sum, task);
    }
    sum
}
