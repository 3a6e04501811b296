//! Work of points that open, close or change their facet between two commits.

use wythe_contact::{JointLaw, PointPair, extend};

use super::Contact;
use crate::assembly::Trial;
use crate::model::Model;
use crate::state::State;

impl Contact {
    /// Terms of the trapezoidal rule for points that open, close or change their facet in the increment that
    /// `trial` ends [N mm] (theory/contact.md, eqs 17 and 18).
    pub fn crossing_work(&self, model: &Model, state: &State, trial: &Trial) -> f64 {
        let points = state
            .interface
            .iter()
            .zip(&trial.joints.history)
            .enumerate();
        points
            .map(|(p, (old, new))| {
                let work = if trial.joints.pairs[p].facet == state.pairs[p].facet {
                    self.law(model, p).crossing_work(old, new)
                } else {
                    self.work_of_change(p, state, trial)
                };
                work * self.points[p].area
            })
            .sum()
    }

    /// Work of the nodal forces of open points beyond the work of their tractions on gap and slip, in the increment
    /// that `trial` ends [N mm] (theory/contact.md, eq. 19).
    ///
    /// The traction τ acts at the point and at the foot of its perpendicular, with the gap u between them. Slip is
    /// t·(x_s − y). A facet that rotates by δt therefore changes it by u (δt·n). The nodal forces do no such work,
    /// because the couple τ u is left out of them. In closed joints u is negligible. A bond that carries shear
    /// across an open gap has this term at every increment size.
    pub fn turning_work(&self, model: &Model, state: &State, trial: &Trial) -> f64 {
        if trial.x_start.is_empty() {
            return 0.0;
        }
        let points = state
            .interface
            .iter()
            .zip(&trial.joints.history)
            .enumerate();
        let works = points.map(|(p, (old, new))| {
            let gapes = old.opening.max(new.opening) > self.law(model, p).opens_at();
            let shear = [old, new]
                .iter()
                .any(|h| h.traction[1] != 0.0 || h.traction[2] != 0.0);
            let stays = trial.joints.pairs[p].facet.is_some()
                && trial.joints.pairs[p].facet == state.pairs[p].facet;
            if !(gapes && shear && stays) || self.is_image(p) {
                return 0.0;
            }
            self.turning_work_of(p, [&old.traction, &new.traction], state, trial)
                .unwrap_or(0.0)
                * self.points[p].area
        });
        works.sum()
    }

    /// The same for one point with these tractions before and after, over its area [N/mm].
    fn turning_work_of(
        &self,
        p: usize,
        traction: [&[f64; 3]; 2],
        state: &State,
        trial: &Trial,
    ) -> Option<f64> {
        let (x_start, x) = (&trial.x_start, &trial.x);
        let (from, to) = (state.pairs[p], trial.joints.pairs[p]);
        let slave = [x_start, x].map(|x| self.slave.corners(p / 4, x));
        let master = [x_start, x].map(|x| self.master.corners(to.facet.unwrap_or(0) as usize, x));
        let (_, before) = self.see(p, &slave[0], from, from, x_start)?;
        let (_, after) = self.see(p, &slave[1], from, to, x)?;
        let way = |corners: &[[[f64; 3]; 4]; 2], a: usize| {
            [0, 1, 2].map(|i| corners[1][a][i] - corners[0][a][i])
        };
        let mut work = 0.0;
        for (kin, traction) in [&before, &after].into_iter().zip(traction) {
            // Work of the nodal forces at this end.
            for (a, weight) in kin.weights().iter().enumerate() {
                let way = if a < 4 {
                    way(&slave, a)
                } else {
                    way(&master, a - 4)
                };
                for (axis, t) in kin.frame.iter().zip(traction) {
                    work += 0.5 * t * weight * (0..3).map(|i| axis[i] * way[i]).sum::<f64>();
                }
            }
            // Work of its tractions.
            let gap = [
                after.gap - before.gap,
                after.slip[0] - before.slip[0],
                after.slip[1] - before.slip[1],
            ];
            work -= 0.5 * traction.iter().zip(gap).map(|(t, g)| t * g).sum::<f64>();
        }
        Some(work)
    }

    /// Term of the trapezoidal rule for a point that has moved from facet a, or from none, to b, or to none, over
    /// its area [N/mm].
    ///
    /// The rule gives the normal tractions t₀ and t₁ the work ½ t₀ Δg_a + ½ t₁ Δg_b. The energies of the branches
    /// are ½ t₀ g_a0 and ½ t₁ g_b1. The rest is ½ t₀ g_a1 − ½ t₁ g_b0. A point that loses its master also
    /// dissipates its energy.
    fn work_of_change(&self, p: usize, state: &State, trial: &Trial) -> f64 {
        let (old, new) = (&state.interface[p], &trial.joints.history[p]);
        if trial.x_start.is_empty() {
            return 0.0;
        }
        let gap = |pair: PointPair, x: &[[f64; 3]]| {
            let corners = self.master.corners(pair.facet? as usize, x);
            let point = self.position(p / 4, p % 4, x);
            let foot = extend(&point, &corners, pair.xi)?;
            Some(self.opening(p, foot.gap))
        };
        let mut work = 0.0;
        if old.traction[0] != 0.0 {
            let stored = if trial.joints.pairs[p].facet.is_none() {
                old.opening
            } else {
                0.0
            };
            let now = gap(state.pairs[p], &trial.x);
            work += now.map_or(0.0, |now| 0.5 * old.traction[0] * (now - stored));
        }
        if new.traction[0] != 0.0 {
            let before = gap(trial.joints.pairs[p], &trial.x_start);
            work -= before.map_or(0.0, |before| 0.5 * new.traction[0] * before);
        }
        work
    }
}
