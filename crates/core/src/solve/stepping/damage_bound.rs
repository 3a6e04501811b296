//! Bound on the rate of damage while a unit snaps (docs/theory/procedures.md, eq. 9).
//!
//! Damage that may not rise faster lags behind its law, and its points carry more than they can. Where this is more
//! than a small part of the force, the bound is loosened and the increment repeated, so that no force is reported that
//! only lagging damage carries.

use super::peak_control::Passage;
use super::run::{CUT, Run};
use super::step_run::{IncrementRequest, StepRun};
use crate::solve::increment::outcome::Report;
use crate::state::Method;

/// Largest lag of damage behind its law at which a snap is over [-].
const SETTLED: f64 = 0.02;
/// Number of the largest increments in which the damage of a point may rise from 0 to 1.
pub(in crate::solve) const SNAPS_TAKE: f64 = 4.0;
/// Factor on this number where lagging damage carries too much.
const SOONER: f64 = 0.25;
/// Number below which the rate has no bound.
const SOONEST: f64 = 0.01;
/// Largest part of the largest force that lagging damage may carry: in an increment with a larger force than all before,
/// and in any other.
const CARRIES: [f64; 2] = [0.02, 0.5];

impl<'m> Run<'m> {
    /// Bounds the rate of damage from now on, if a displacement is driven: loads would go on to grow while damage lags.
    /// Steps with a viscosity have no bound.
    pub(super) fn bound_damage(&mut self, step_run: &mut StepRun<'m>) {
        let step = step_run.step;
        if step.viscosity == 0.0 && step.drives() {
            let takes = step_run.snap.takes;
            self.bound_rate(step_run, takes);
        }
    }

    /// Lets the damage of a point rise from 0 to 1 in this number of the largest increments at least.
    fn bound_rate(&mut self, step_run: &mut StepRun<'m>, takes: f64) {
        let step = step_run.step;
        let rate = if takes < SOONEST {
            f64::INFINITY
        } else {
            1.0 / (takes * step.increments.max * step.duration)
        };
        (step_run.snap.takes, step_run.snap.damage_rate) = (takes, rate);
        self.system.bulk.stabilise(step.viscosity, rate);
    }

    /// Whether to repeat the increment that ends at the trial with a smaller size and a looser bound, because lagging
    /// damage carries too much of the force.
    pub(super) fn loosens_bound(
        &mut self,
        step_run: &mut StepRun<'m>,
        request: IncrementRequest,
        report: Report,
    ) -> bool {
        if step_run.snap.damage_rate.is_infinite() || request.method != Method::Static {
            return false;
        }
        let Some(passage) = self.passage(step_run, request, report) else {
            return false;
        };
        let carried = self.carried_by_lag(step_run, request, &passage);
        let (most, force) = (step_run.peak.most(), passage.force.abs());
        if carried <= CARRIES[usize::from(force < most)] * most.max(force) {
            return false;
        }
        let takes = SOONER * step_run.snap.takes;
        self.bound_rate(step_run, takes);
        let size = CUT * request.increment.size;
        let size = size.max(step_run.step.increments.min);
        step_run.schedule.resume(size);
        true
    }

    /// Force that lagging damage carries at the end of the trial, in the unit of the passage.
    fn carried_by_lag(
        &self,
        step_run: &StepRun,
        request: IncrementRequest,
        passage: &Passage,
    ) -> f64 {
        let dt = request.increment.size * step_run.step.duration;
        let work = self.system.work_of_lag(&self.state, &self.trial, dt);
        (passage.by_work * work).abs()
    }

    /// Part of the force at the end of the trial that viscosity carries, if it is larger than all before; else 0.
    pub(super) fn viscous_share(
        &self,
        step_run: &StepRun,
        request: IncrementRequest,
        report: Report,
    ) -> f64 {
        if !self.system.bulk.is_viscous() {
            return 0.0;
        }
        let passage = self.passage(step_run, request, report);
        let rises = |passage: &Passage| passage.force.abs() > step_run.peak.most();
        passage.filter(rises).map_or(0.0, |passage| {
            self.carried_by_lag(step_run, request, &passage) / passage.force.abs()
        })
    }

    /// Removes the bound when no damage lags behind any more.
    pub(super) fn free_damage(&mut self, step_run: &mut StepRun<'m>) {
        if step_run.snap.damage_rate.is_infinite() {
            return;
        }
        let points = self.state.material.iter();
        let lag = points
            .map(|h| h.damage - h.viscous_damage)
            .fold(0.0, f64::max);
        if lag <= SETTLED {
            step_run.snap.damage_rate = f64::INFINITY;
            step_run.snap.takes = (step_run.snap.takes / SOONER).min(SNAPS_TAKE);
            self.system
                .bulk
                .stabilise(step_run.step.viscosity, f64::INFINITY);
        }
    }
}
