//! A run between two increments: all that it needs to go on from there to the same bits.
//!
//! | Survives an increment | Where it is |
//! |---|---|
//! | displacements, rates, histories, pairs, energies | [`State`] |
//! | where candidates of contact were last searched: they are the pattern, and with it the order of elimination | `searched_at` |
//! | how far the step has come, the size of the next increment | `Schedule`, `row` of its amplitude |
//! | by which method, and what it must show before it is left | `Ladder` |
//! | by what the path is measured | `Trail` |
//! | what a step counts its loads and drives from | `Starts` |
//! | what increments leave open for the next ones | `Carried`, [`State`]'s energies |
//! | where beyond a snap equilibrium was found, what ends the step early, whether a peak is near | `beyond`, `Watch`, `stopped`, `Crest` |
//! | the last equilibrium, while inertia acts in place of statics | `Departure` |
//! | what is told at the end | summary, clock, snaps, swings, energies |
//!
//! Everything else is made from the model, or is scratch: trial, factors, iterates. A commit begins the
//! count of solves and cut-backs anew, and no blow outlives the increment that met it.

use std::cell::OnceCell;

use serde::{Deserialize, Serialize};

use super::fingerprint::Fingerprint;
use super::restart_data::{Carried, Starts};
use crate::assembly::Trial;
use crate::model::Model;
use crate::model::scene::{Fidelity, Step};
use crate::results::{Recorder, Summary};
use crate::solve::dynamics::collapse::Departure;
use crate::solve::fidelity::{Instead, Part, Reached};
use crate::solve::increment::newton::Newton;
use crate::solve::increment::outcome::Clock;
use crate::solve::state::State;
use crate::solve::stepping::counts::{Snaps, Swings};
use crate::solve::stepping::energy_watch::EnergyWatch;
use crate::solve::stepping::fallback::Ladder;
use crate::solve::stepping::path::Trail;
use crate::solve::stepping::peak_control::PeakWatch;
use crate::solve::stepping::run::{Run, RunError, steered};
use crate::solve::stepping::step_run::Course;
use crate::solve::stepping::step_size::Schedule;
use crate::solve::stepping::stop::Watch;

/// All that [`resume`] needs, taken after a commit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Checkpoint {
    model: Fingerprint,
    state: State,
    /// Positions at the last search of candidates [mm]. `[node]`
    searched_at: Vec<[f64; 3]>,
    course: Mark,
    summary: Summary,
    clock: Clock,
    output_seconds: f64,
    snaps: Snaps,
    swings: Swings,
    energy_watch: EnergyWatch,
    departure: Option<Departure>,
    /// How far elastic solids have gone, in place of others.
    pub(in crate::solve) reached: Reached,
}

/// Where a step is.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Mark {
    index: usize,
    starts: Starts,
    carried: Carried,
    schedule: Schedule,
    ladder: Ladder,
    trail: Trail,
    row: usize,
    load: f64,
    beyond: Option<f64>,
    watch: Option<Watch>,
    peak: PeakWatch,
    relaxations: usize,
    damage_rate: f64,
    stopped: bool,
}

impl Mark {
    /// Whether what ended `step` early still ends it there.
    fn is_stopped_in(&self, step: &Step) -> bool {
        let same = self.watch.as_ref().is_none_or(|watch| watch.stops_as(step));
        self.stopped && same
    }
}

/// A checkpoint that a model cannot go on from.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// It was taken from another model.
    #[error("the checkpoint was taken from another model: {0} differ")]
    OtherModel(String),
    /// It does not fit the model it names, so it was not written by a run.
    #[error("the checkpoint does not fit its model: {0}")]
    Unfit(&'static str),
}

/// Goes on from a checkpoint through the rest of the model's steps. What the recorder gets is what it
/// would have got from [`crate::solve::run`] after that commit, to the last bit.
///
/// # Errors
/// [`RunError::Checkpoint`] if it was taken from another model, else as [`crate::solve::run`].
pub fn resume(
    model: &Model,
    checkpoint: Checkpoint,
    recorder: &mut dyn Recorder,
) -> Result<Summary, RunError> {
    resume_part(model, &Part::default(), checkpoint, recorder).map(Summary::in_words)
}

/// Goes on with a model that is this part of what is shown.
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
    // On a thread of the pool, as a run from the start.
    rayon::scope(|_| {
        let (run, course) = Run::rejoin(model, part, checkpoint)?;
        run.finish(Some(course), recorder)
    })
}

impl Checkpoint {
    /// Increments done, which are the rows of the history.
    pub fn increments(&self) -> usize {
        self.state.increments
    }

    /// The step that the last of them belongs to, from 0.
    pub fn step(&self) -> usize {
        self.course.index
    }

    /// Step time since the start of the run [s].
    pub fn time(&self) -> f64 {
        self.state.time
    }

    /// Whether nothing is left to do of `model`.
    pub fn is_the_end_of(&self, model: &Model) -> bool {
        let (course, last) = (&self.course, model.steps.last());
        let stopped = last.is_some_and(|step| course.is_stopped_in(step));
        course.index + 1 == model.steps.len() && (stopped || course.schedule.next().is_none())
    }

    /// What was solved instead of `model`: no half of it, if the run began with the whole.
    fn instead_of(&self, model: &Model) -> Option<Instead> {
        let whole = model.fidelity == Fidelity::Auto && self.model.is_but_for_steps(model);
        if whole { None } else { Instead::of(model) }
    }

    /// Whether `model` can go on from here.
    ///
    /// # Errors
    /// [`CheckpointError`], with what differs.
    pub fn check(&self, model: &Model) -> Result<(), CheckpointError> {
        if let Some(instead) = self.instead_of(model) {
            return self.check(instead.model());
        }
        match self.model.difference(&Fingerprint::of(model)) {
            Some(what) => Err(CheckpointError::OtherModel(what)),
            None => Ok(()),
        }
    }

    /// The last step of `model` is what it was and goes on beyond its end: what was the whole of it is
    /// now `part` of it. Everything counted in parts of the step is counted anew.
    pub fn lengthen(&mut self, model: &Model, part: f64) {
        if let Some(instead) = self.instead_of(model) {
            return self.lengthen(instead.model(), part);
        }
        if let Some(last) = model.steps.last() {
            self.model.end_with(last);
        }
        if self.course.index + 1 != model.steps.len() {
            return;
        }
        let course = &mut self.course;
        course.load *= part;
        course.beyond = course.beyond.map(|load| part * load);
        course.schedule.lengthen(part);
        course.ladder.lengthen(part);
        course.trail.lengthen(part);
        course.peak.lengthen(part);
        if let Some(last) = &mut self.state.last {
            last.load *= part;
        }
    }
}

impl<'m> Run<'m> {
    /// Offers the recorder a checkpoint, between two increments. `last` if no increment follows.
    pub(in crate::solve) fn offer(
        &mut self,
        course: &Course<'m>,
        last: bool,
        recorder: &mut dyn Recorder,
    ) -> Result<(), RunError> {
        let start = std::time::Instant::now();
        recorder.checkpoint(last, &|| self.checkpoint(course))?;
        self.output_seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    fn checkpoint(&self, course: &Course<'m>) -> Checkpoint {
        let model = self.fingerprint.get_or_init(|| Fingerprint::of(self.model));
        Checkpoint {
            model: model.clone(),
            state: self.state.clone(),
            searched_at: self.system.contact.searched_at().to_vec(),
            course: Mark {
                index: course.index,
                starts: course.newton.starts(),
                carried: course.newton.carried(),
                schedule: course.schedule.clone(),
                ladder: course.ladder.clone(),
                trail: course.trail.clone(),
                row: course.row,
                load: course.load,
                beyond: course.beyond,
                watch: course.watch.clone(),
                peak: course.peak,
                relaxations: course.relaxations,
                damage_rate: course.damage_rate,
                stopped: course.stopped,
            },
            summary: self.summary.clone(),
            clock: self.clock + course.newton.clock,
            output_seconds: self.output_seconds,
            snaps: self.snaps,
            swings: self.swings,
            energy_watch: self.energy_watch,
            departure: self.departure.clone(),
            reached: Reached::default(),
        }
    }

    /// The run and its step as they were when the checkpoint was taken.
    fn rejoin(
        model: &'m Model,
        part: &Part,
        checkpoint: Checkpoint,
    ) -> Result<(Self, Course<'m>), RunError> {
        let mut run = Self::new(model, part)?;
        let Checkpoint {
            state,
            searched_at,
            course: mark,
            ..
        } = checkpoint;
        let unfit = |what| Err(CheckpointError::Unfit(what).into());
        if !same_sizes(&state, &run.state) {
            return unfit("the state has other sizes");
        }
        let masters = model.contact.master_facets.len();
        let faces_nothing = |facet: Option<u32>| facet.is_some_and(|f| f as usize >= masters);
        if state.pairs.iter().any(|pair| faces_nothing(pair.facet)) {
            return unfit("a contact point faces a facet that is not there");
        }
        let finite = |x: &[f64; 3]| x.iter().all(|x| x.is_finite());
        if searched_at.len() != model.mesh.nodes.len() || !searched_at.iter().all(finite) {
            return unfit("the search of contact was at no place");
        }
        run.system.contact.search_from(&searched_at);
        let Some(step) = model.steps.get(mark.index) else {
            return unfit("there is no such step");
        };
        let slots = run.system.dofs.slots;
        run.state = state;
        run.system.bulk.stabilise(step.viscosity, mark.damage_rate);
        run.system.steered = steered(model, step);
        let mut newton = Newton::new(model, step, &run.system, &run.state);
        let stopped = mark.is_stopped_in(step);
        if !newton.begin_from(mark.starts) || !newton.carry_on(mark.carried) {
            return unfit("the step began with other sizes");
        }
        let has_mass = run.massless(step).is_none();
        let Some(ladder) = mark.ladder.of_step(model, step, has_mass) else {
            return unfit("the step has other methods");
        };
        if mark.row >= step.branches() {
            return unfit("the amplitude of the step has fewer rows");
        }
        let branch = step.branch(mark.row);
        newton.rejoin(ladder.rung(), branch.slope(), &run.system, &run.state);
        let mut course = Course::new(newton, ladder, mark.index, step);
        course.steer(model, &run.system);
        course.schedule = mark.schedule.within(step.increments);
        let Some(trail) = mark.trail.of_step(&course.trail, slots) else {
            return unfit("the path is measured by other sizes");
        };
        course.trail = trail;
        (course.load, course.beyond) = (mark.load, mark.beyond);
        (course.row, course.branch) = (mark.row, branch);
        course.peak = mark.peak;
        course.relaxations = mark.relaxations;
        course.damage_rate = mark.damage_rate;
        course.watch = Watch::new(&model.steps, step, 0.0, part.wholes());
        match (&mut course.watch, &mark.watch) {
            (Some(watch), Some(earlier)) => watch.go_on(earlier),
            (None, None) => {}
            _ => return unfit("the step drives something else"),
        }
        course.stopped = stopped;
        run.summary = Summary {
            threads: run.summary.threads,
            mirror_planes: run.summary.mirror_planes,
            ..checkpoint.summary
        };
        run.clock = checkpoint.clock;
        run.output_seconds = checkpoint.output_seconds;
        (run.snaps, run.swings) = (checkpoint.snaps, checkpoint.swings);
        run.energy_watch = checkpoint.energy_watch;
        run.departure = checkpoint.departure;
        if run
            .departure
            .as_ref()
            .is_some_and(|from| !from.fits(&run.state))
        {
            return unfit("the last equilibrium has other sizes");
        }
        run.trial = Trial::default();
        run.fingerprint = OnceCell::from(checkpoint.model);
        Ok((run, course))
    }
}

/// Whether two states are of the same model, as far as their sizes tell.
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
        let springs = [s.spring_ends.len(), s.spring_forces.len(), s.loads.len()];
        let points = [s.material.len(), s.interface.len(), s.pairs.len()];
        (slots.map(Vec::len), springs, points)
    };
    let fits = |last: &crate::solve::state::LastIncrement| {
        last.dq.len() == b.q.len() && last.dtraction.len() == b.interface.len()
    };
    sizes(a) == sizes(b) && a.last.as_ref().is_none_or(fits)
}
