//! An accepted increment: its commit, the counters and watches that it feeds, and the choice of the next one
//! (docs/theory/procedures.md, Algorithm).

use super::acceptance::growth;
use super::run::{Run, RunError};
use super::step_run::{IncrementRequest, StepRun};
use crate::model::scene::Procedure;
use crate::solve::Recorder;
use crate::solve::increment::outcome::Report;
use crate::state::{Energies, ForceBy, HistoryRow, Method, Status};

/// Dissipation of an increment over the energy that it takes or releases, above which it measures the path.
const SHARE: f64 = 0.02;

impl<'m> Run<'m> {
    /// Commits an increment and chooses the next; false if the run should stop.
    pub(super) fn accept(
        &mut self,
        step_run: &mut StepRun<'m>,
        request: IncrementRequest,
        report: Report,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        let solves = step_run.attempts.solves + report.iterations;
        let start = step_run.load;
        let added = report.load_factor - start;
        let before = self.state.energies;
        if let Some(motion) = step_run.newton.motion() {
            motion.end_shock();
        }
        let viscous = self.viscous_share(step_run, request, report);
        self.note_time_error(step_run);
        let size = request.increment.size;
        let dq = self.commit(&mut step_run.newton, step_run.step, size, added);
        step_run.load = report.load_factor;
        if !request.method.has_inertia() {
            step_run.note_carried();
        }
        let row = self.row(step_run, request, report, solves);
        self.note_first_damage(&row);
        let carried = self.count(step_run, request.method, (&row, viscous));
        let light = self.light_body_moves(step_run, request.method);
        let collapsed = self.collapses(step_run, request.method, (before.kinetic, start, light));
        let growth = growth(request, report, step_run.fallback.floor());
        let energies = self.state.energies;
        step_run.choose_size(request, growth, energies.kinetic / before.kinetic);
        self.free_damage(step_run);
        self.measure_path(step_run, request, (&dq, added), growth, &before);
        let hastens = energies.hastens(&before);
        // A block that slides under little more than its limit gains speed, but never much energy beside its friction.
        let moves = light || energies.moves_on(&before) || (step_run.held > 0 && hastens);
        if !collapsed {
            self.watch_stability(step_run, start, recorder);
        }
        let why = self.watch(step_run, carried);
        let whole = step_run.is_whole();
        let end = whole || why.is_some() || collapsed;
        if let (Some(why), false) = (&why, whole) {
            self.stop(step_run, why, recorder);
        }
        let keep = self.record(&row, recorder, end)?;
        self.summary.increments += 1;
        self.summary.iterations += solves;
        step_run.begin_attempts(request, solves, added);
        let forth = step_run.sense() * added;
        self.return_to_first(step_run, request, report, (moves, forth), recorder);
        // What is not stable may begin to move slowly.
        let leaves = step_run.branch.unstable_from.is_some();
        self.hold_or_go_on(step_run, moves || hastens || leaves);
        self.report_collapse(step_run, recorder);
        let mut keeps_symmetry = true;
        if !end && step_run.is_at_row() {
            keeps_symmetry = self.keeps_symmetry(step_run, recorder);
            self.turn(step_run);
        }
        self.tally(&step_run.newton);
        let all_done = collapsed || (end && step_run.index + 1 == self.model.steps.len());
        self.offer(step_run, all_done || !keep || !keeps_symmetry, recorder)?;
        self.tally(&step_run.newton);
        if !keep && !collapsed {
            self.summary.status = Status::Interrupted;
            "stopped by the user".clone_into(&mut self.summary.message);
        }
        Ok(keep && keeps_symmetry && !collapsed)
    }

    /// Notes the error of the time integration in the increment that is to be committed.
    fn note_time_error(&mut self, step_run: &mut StepRun) {
        let Some(motion) = step_run.newton.motion() else {
            return;
        };
        let error = motion.time_error(&self.state);
        let farthest = self
            .state
            .q
            .iter()
            .fold(0.0, |most: f64, q| most.max(q.abs()));
        self.swings.note_time_error(step_run.index, error, farthest);
    }

    /// Adds the increment to the counters from which the warnings of the summary follow. Returns whether inertia
    /// carries its force.
    fn count(
        &mut self,
        step_run: &mut StepRun,
        method: Method,
        (row, viscous): (&HistoryRow, f64),
    ) -> bool {
        self.energy_watch.add(row);
        let most = step_run.step.tolerance.residual;
        if step_run.newton.tighten() && row.residual > most {
            self.snaps.loosen(row);
        }
        let seeks = step_run.step.procedure.seeks_equilibrium();
        match method {
            // Motion is expected where `auto` uses inertia, but not in quasi-static steps of a deck.
            Method::QuasiStatic if step_run.step.procedure == Procedure::QuasiStatic => {
                self.swings.add(row);
            }
            Method::Implex if step_run.step.procedure == Procedure::Auto => self.snaps.add(row),
            Method::QuasiStatic => self.mark_fallen(),
            _ => {}
        }
        let has_inertia = seeks && method == Method::QuasiStatic;
        let by = match has_inertia {
            true if step_run.step.prescribes() => ForceBy::Drive,
            true => ForceBy::Loads,
            false => ForceBy::Equilibrium,
        };
        self.carried.add(row, by, viscous)
    }

    /// Measures the path by the committed increment: its change `dq` of the displacements [mm] `[slot]` and `added`
    /// of the load factor. `before`: energies before it.
    fn measure_path(
        &mut self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        (dq, added): (&[f64], f64),
        growth: f64,
        before: &Energies,
    ) {
        if let Some(size) = step_run.snap.resumes_at.take() {
            // Motion in pseudo-time does not predict the next increment.
            step_run.schedule.resume(size);
            step_run.path.measure.forget();
            step_run.peak.forget();
            self.state.last = None;
        } else if let Some(measure) = step_run.measured_by() {
            let share = self.state.energies.dissipated_share(before);
            let dissipates = measure == Method::ArcLength || share > SHARE;
            let (system, trial, size) = (&self.system, &self.trial, request.increment.size);
            let path = &mut step_run.path.measure;
            if !dissipates || !path.learn(measure, system, trial, dq, (size, added), growth) {
                path.forget();
            }
        }
    }

    /// Watches stop conditions and peaks. Returns why the step stops, if it does. `carried`: whether inertia carries
    /// the force of the increment.
    fn watch(&mut self, step_run: &mut StepRun, carried: bool) -> Option<String> {
        let seen = self.watched(step_run.index);
        let watch = step_run.watch.as_mut();
        let why = watch.and_then(|watch| watch.take(seen, carried));
        step_run.see(seen[1]);
        step_run.resolve_peak();
        why
    }

    /// Returns to the first method of the step where the trouble is passed. `moves`: whether the structure still
    /// moves; `forth`: load factor added in the sense of the branch.
    fn return_to_first(
        &mut self,
        step_run: &mut StepRun<'m>,
        request: IncrementRequest,
        report: Report,
        (moves, forth): (bool, f64),
        recorder: &mut dyn Recorder,
    ) {
        let load = step_run.sense() * step_run.load;
        let fallback = &mut step_run.fallback;
        let falls = !step_run.step.drives() && step_run.step.control.is_none();
        if falls && fallback.leaves_path(load) {
            let floor = fallback.floor();
            self.adopt(step_run);
            self.begin_inertia(step_run, floor);
            let why = "the path leads to less than half of the loads";
            self.note(step_run, why, recorder);
            return;
        }
        let ends = fallback.ends_path();
        if !fallback.take_first_again(report, moves, forth, load) {
            if fallback.exchange() {
                self.adopt(step_run);
                let why = "increments take many solves: tangents are exchanged";
                self.note(step_run, why, recorder);
            }
            return;
        }
        if request.method.has_inertia() {
            self.bring_to_rest();
            // The last increment does not predict the next one, but its motion may continue.
            self.state.moved = self.state.last.take();
        }
        if request.method.follows_path() {
            // Increments along the path may be of another size than those of the load.
            let pace = forth / step_run.branch.of.slope().abs();
            let floor = step_run.fallback.floor();
            step_run.schedule.resume(pace.max(floor));
            self.state.last = None;
        }
        self.adopt(step_run);
        let why = if ends {
            format!("{} leads no further", request.method.name())
        } else {
            format!("{} has passed the trouble", request.method.name())
        };
        self.note(step_run, &why, recorder);
    }
}
