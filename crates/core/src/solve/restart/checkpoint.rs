//! Checkpoint: the data between two increments from which a run continues with the same bits.
//!
//! | Data that survive an increment | Place |
//! |---|---|
//! | displacements, rates, histories, pairs, energies | [`State`] |
//! | positions at the last search for contact candidates, which decide the matrix pattern and its ordering | `searched_at` |
//! | progress of the step, size of the next increment | `Schedule`, `row` of its amplitude |
//! | method, and counters by which it is left | `Fallback` |
//! | measure of the path | `PathMeasure` |
//! | state at the start of the step, for loads and drives | `StepStart` |
//! | residuals and open energies of the last commit | `CarriedOver`, energies of [`State`] |
//! | equilibrium beyond a snap, early end of the step, peaks | `beyond`, `Watch`, `stopped`, `PeakWatch` |
//! | last equilibrium, while inertia acts in place of statics | `LastEquilibrium` |
//! | reports at the end | summary, clock, snaps, swings, carried forces, energies |
//!
//! All other data follow from the model or are temporary: trial, factors, iterates. A commit resets the counts of
//! solves and rejections, and no impact lasts longer than its increment.

use std::cell::OnceCell;

use serde::{Deserialize, Serialize};

use super::fingerprint::Fingerprint;
use super::restart_data::{CarriedOver, StepStart};
use crate::assembly::Trial;
use crate::model::Model;
use crate::model::scene::{Fidelity, Step};
use crate::solve::Recorder;
use crate::solve::dynamics::collapse::LastEquilibrium;
use crate::solve::fidelity::{Part, Reached, Reduction};
use crate::solve::increment::newton::Newton;
use crate::solve::stepping::counts::{Carried, MotionWarnings, Snaps};
use crate::solve::stepping::energy_watch::EnergyWatch;
use crate::solve::stepping::fallback::Fallback;
use crate::solve::stepping::path::PathMeasure;
use crate::solve::stepping::peak_control::PeakWatch;
use crate::solve::stepping::run::{Run, RunError, steered};
use crate::solve::stepping::snap::Relaxations;
use crate::solve::stepping::step_run::StepRun;
use crate::solve::stepping::step_size::Schedule;
use crate::solve::stepping::stop::Watch;
use crate::state::Clock;
use crate::state::State;
use crate::state::Summary;

/// Data for [`resume`], taken after a commit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Checkpoint {
    model: Fingerprint,
    state: State,
    /// Positions at the last search for contact candidates [mm]. `[node]`
    searched_at: Vec<[f64; 3]>,
    /// How deep behind facets that search went [mm].
    searched_deep: f64,
    step_run: Mark,
    summary: Summary,
    clock: Clock,
    output_seconds: f64,
    snaps: Snaps,
    swings: MotionWarnings,
    carried: Carried,
    energy_watch: EnergyWatch,
    last_equilibrium: Option<LastEquilibrium>,
    /// Largest stress of solids that are solved as elastic.
    pub(in crate::solve) reached: Reached,
}

/// Progress of a step.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Mark {
    index: usize,
    starts: StepStart,
    carried: CarriedOver,
    schedule: Schedule,
    fallback: Fallback,
    path_measure: PathMeasure,
    /// Row of the amplitude, the largest part of the loads that statics carried on the way to it, and that from which the
    /// equilibrium is not stable.
    row: (usize, f64, Option<f64>),
    load: f64,
    beyond: Option<f64>,
    watch: Option<Watch>,
    peak: PeakWatch,
    relaxations: Relaxations,
    /// Largest rate of damage [1/s], and the number of increments that follows from it.
    damage_bound: [f64; 2],
    stopped: bool,
    held: usize,
}

impl Mark {
    /// Whether `step` still has the condition that ended it early.
    fn is_stopped_in(&self, step: &Step) -> bool {
        let same = self.watch.as_ref().is_none_or(|watch| watch.stops_as(step));
        self.stopped && same
    }
}

/// A checkpoint from which a model cannot continue.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// The checkpoint was taken from another model.
    #[error("the checkpoint was taken from another model: {0} differ")]
    OtherModel(String),
    /// The checkpoint does not fit the model that it names, so it was not written by a run.
    #[error("the checkpoint does not fit its model: {0}")]
    Unfit(&'static str),
}

/// Continues from a checkpoint through the rest of the model's steps. The recorder gets the results that
/// [`crate::solve::run`] would have given after that commit, to the last bit.
///
/// # Errors
/// [`RunError::Checkpoint`] if the checkpoint belongs to another model, else those of [`crate::solve::run`].
pub fn resume(
    model: &Model,
    checkpoint: Checkpoint,
    recorder: &mut dyn Recorder,
) -> Result<Summary, RunError> {
    resume_part(model, &Part::default(), checkpoint, recorder).map(Summary::in_words)
}

/// Continues with a model that is the given part of the scene shown.
fn resume_part(
    model: &Model,
    part: &Part,
    checkpoint: Checkpoint,
    recorder: &mut dyn Recorder,
) -> Result<Summary, RunError> {
    if let Some(instead) = checkpoint.instead_of(model) {
        let reached = checkpoint.reached;
        return instead.show(model, part, recorder, reached, |model, part, recorder| {
            resume_part(model, part, checkpoint, recorder)
        });
    }
    checkpoint.check(model)?;
    // Work on a thread of the pool, as a run from the start does.
    rayon::scope(|_| {
        let (run, step_run) = Run::rejoin(model, part, checkpoint)?;
        run.finish(Some(step_run), recorder)
    })
}

impl Checkpoint {
    /// Number of increments done, which is that of the history rows.
    pub fn increments(&self) -> usize {
        self.state.increments
    }

    /// Index of the step of the last increment, from 0.
    pub fn step(&self) -> usize {
        self.step_run.index
    }

    /// Step time since the start of the run [s].
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Whether `model` has nothing left to solve.
    pub fn is_the_end_of(&self, model: &Model) -> bool {
        let (mark, last) = (&self.step_run, model.steps.last());
        let stopped = last.is_some_and(|step| mark.is_stopped_in(step));
        mark.index + 1 == model.steps.len() && (stopped || mark.schedule.next().is_none())
    }

    /// Reduction that was solved instead of `model`; none if the run solved the whole.
    fn instead_of(&self, model: &Model) -> Option<Reduction> {
        let whole = model.fidelity == Fidelity::Auto && self.model.is_but_for_steps(model);
        if whole { None } else { Reduction::of(model) }
    }

    /// Checks whether `model` can continue from this checkpoint.
    ///
    /// # Errors
    /// [`CheckpointError`], with the part that differs.
    pub fn check(&self, model: &Model) -> Result<(), CheckpointError> {
        if let Some(instead) = self.instead_of(model) {
            return self.check(instead.model());
        }
        match self.model.difference(&Fingerprint::of(model)) {
            Some(what) => Err(CheckpointError::OtherModel(what)),
            None => Ok(()),
        }
    }

    /// Rescales the checkpoint for a longer last step of `model`, of which the step so far is `part`.
    pub fn lengthen(&mut self, model: &Model, part: f64) {
        if let Some(instead) = self.instead_of(model) {
            return self.lengthen(instead.model(), part);
        }
        if let Some(last) = model.steps.last() {
            self.model.end_with(last);
        }
        if self.step_run.index + 1 != model.steps.len() {
            return;
        }
        let mark = &mut self.step_run;
        mark.load *= part;
        mark.beyond = mark.beyond.map(|load| part * load);
        mark.schedule.lengthen(part);
        mark.fallback.lengthen(part);
        mark.path_measure.lengthen(part);
        mark.peak.lengthen(part);
        if let Some(last) = &mut self.state.last {
            last.load *= part;
        }
    }
}

impl<'m> Run<'m> {
    /// Offers the recorder a checkpoint between two increments. `last` is true if no increment follows.
    pub(in crate::solve) fn offer(
        &mut self,
        step_run: &StepRun<'m>,
        last: bool,
        recorder: &mut dyn Recorder,
    ) -> Result<(), RunError> {
        let start = std::time::Instant::now();
        recorder.checkpoint(last, &|| self.checkpoint(step_run))?;
        self.output_seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    fn checkpoint(&self, step_run: &StepRun<'m>) -> Checkpoint {
        let model = self.fingerprint.get_or_init(|| Fingerprint::of(self.model));
        Checkpoint {
            model: model.clone(),
            state: self.state.clone(),
            searched_at: self.system.contact.searched_at().to_vec(),
            searched_deep: self.system.contact.searched_deep(),
            step_run: Mark {
                index: step_run.index,
                starts: step_run.newton.starts(),
                carried: step_run.newton.carried(),
                schedule: step_run.schedule.clone(),
                fallback: step_run.fallback.clone(),
                path_measure: step_run.path.measure.clone(),
                row: (
                    step_run.branch.index,
                    step_run.branch.carried,
                    step_run.branch.unstable_from,
                ),
                load: step_run.load,
                beyond: step_run.snap.beyond,
                watch: step_run.watch.clone(),
                peak: step_run.peak,
                relaxations: step_run.snap.relaxations,
                damage_bound: [step_run.snap.damage_rate, step_run.snap.takes],
                stopped: step_run.stopped,
                held: step_run.held,
            },
            summary: self.summary.clone(),
            clock: self.clock + step_run.newton.clock,
            output_seconds: self.output_seconds,
            snaps: self.snaps,
            swings: self.swings,
            carried: self.carried,
            energy_watch: self.energy_watch,
            last_equilibrium: self.last_equilibrium.clone(),
            reached: Reached::default(),
        }
    }

    /// Restores the run and its step from a checkpoint.
    fn rejoin(
        model: &'m Model,
        part: &Part,
        checkpoint: Checkpoint,
    ) -> Result<(Self, StepRun<'m>), RunError> {
        let mut run = Self::new(model, part)?;
        run.take_state(
            checkpoint.state,
            &checkpoint.searched_at,
            checkpoint.searched_deep,
        )?;
        let step_run = run.rejoin_step(checkpoint.step_run)?;
        run.summary = Summary {
            threads: run.summary.threads,
            mirror_planes: run.summary.mirror_planes,
            ..checkpoint.summary
        };
        run.clock = checkpoint.clock;
        run.output_seconds = checkpoint.output_seconds;
        (run.snaps, run.swings) = (checkpoint.snaps, checkpoint.swings);
        run.carried = checkpoint.carried;
        run.energy_watch = checkpoint.energy_watch;
        run.last_equilibrium = checkpoint.last_equilibrium;
        let equilibrium = run.last_equilibrium.as_ref();
        if equilibrium.is_some_and(|from| !from.fits(&run.state)) {
            return Err(CheckpointError::Unfit("the last equilibrium has other sizes").into());
        }
        run.trial = Trial::default();
        run.fingerprint = OnceCell::from(checkpoint.model);
        Ok((run, step_run))
    }

    /// Takes over the state and the positions of the last search of contact.
    fn take_state(
        &mut self,
        state: State,
        searched_at: &[[f64; 3]],
        searched_deep: f64,
    ) -> Result<(), CheckpointError> {
        if !same_sizes(&state, &self.state) {
            return Err(CheckpointError::Unfit("the state has other sizes"));
        }
        let masters = self.model.contact.master_facets.len();
        let faces_nothing = |facet: Option<u32>| facet.is_some_and(|f| f as usize >= masters);
        if state.pairs.iter().any(|pair| faces_nothing(pair.facet)) {
            let why = "a contact point faces a facet that is not there";
            return Err(CheckpointError::Unfit(why));
        }
        let finite = |x: &[f64; 3]| x.iter().all(|x| x.is_finite());
        if searched_at.len() != self.model.mesh.nodes.len()
            || !searched_at.iter().all(finite)
            || !searched_deep.is_finite()
        {
            return Err(CheckpointError::Unfit(
                "the search of contact was at no place",
            ));
        }
        self.system.contact.search_from(searched_at, searched_deep);
        self.state = state;
        Ok(())
    }

    /// Restores the step in progress.
    fn rejoin_step(&mut self, mark: Mark) -> Result<StepRun<'m>, CheckpointError> {
        let (model, unfit) = (self.model, CheckpointError::Unfit);
        let step = model.steps.get(mark.index);
        let step = step.ok_or(unfit("there is no such step"))?;
        let slots = self.system.dofs.slots;
        let [damage_rate, _] = mark.damage_bound;
        self.system.bulk.stabilise(step.viscosity, damage_rate);
        self.system.steered = steered(model, step);
        let mut newton = Newton::new(model, step, &self.system, &self.state);
        let stopped = mark.is_stopped_in(step);
        if !newton.begin_from(mark.starts) || !newton.carry_on(mark.carried) {
            return Err(unfit("the state at the start of the step has other sizes"));
        }
        let has_mass = self.massless(step).is_none();
        let fallback = mark.fallback.of_step(model, step, has_mass);
        let fallback = fallback.ok_or(unfit("the step has other methods"))?;
        let (row, carried, unstable_from) = mark.row;
        if row >= step.branches() {
            return Err(unfit("the amplitude of the step has fewer rows"));
        }
        let branch = step.branch(row);
        let choice = fallback.choice();
        newton.rejoin(choice, branch.slope(), &self.system, &self.state);
        let mut step_run = StepRun::new(newton, fallback, mark.index, step);
        step_run.steer(model, &self.system);
        step_run.schedule = mark.schedule.within(step.increments);
        let measure = mark.path_measure.of_step(&step_run.path.measure, slots);
        step_run.path.measure = measure.ok_or(unfit("the path is measured by other sizes"))?;
        (step_run.load, step_run.snap.beyond) = (mark.load, mark.beyond);
        step_run.branch.carried = carried;
        step_run.branch.unstable_from = unstable_from;
        (step_run.branch.index, step_run.branch.of) = (row, branch);
        step_run.peak = mark.peak;
        step_run.snap.relaxations = mark.relaxations;
        [step_run.snap.damage_rate, step_run.snap.takes] = mark.damage_bound;
        step_run.watch = Watch::new(&model.steps, step, 0.0, self.part.wholes());
        match (&mut step_run.watch, &mark.watch) {
            (Some(watch), Some(earlier)) => watch.go_on(earlier),
            (None, None) => {}
            _ => return Err(unfit("the step drives something else")),
        }
        step_run.stopped = stopped;
        step_run.held = mark.held;
        Ok(step_run)
    }
}

/// Whether two states have the same sizes, as states of one model do.
fn same_sizes(a: &State, b: &State) -> bool {
    let sizes = |s: &State| {
        let slots = [
            &s.q,
            &s.velocity,
            &s.acceleration,
            &s.force,
            &s.applied,
            &s.damping,
        ];
        let springs = [
            s.spring_ends.len(),
            s.spring_forces.len(),
            s.loads.len(),
            s.ties.len(),
        ];
        let points = [s.material.len(), s.interface.len(), s.pairs.len()];
        (slots.map(Vec::len), springs, points)
    };
    let fits = |last: &crate::state::LastIncrement| {
        last.dq.len() == b.q.len() && last.dtraction.len() == b.interface.len()
    };
    sizes(a) == sizes(b) && a.last.as_ref().is_none_or(fits)
}
