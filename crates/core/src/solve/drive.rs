//! The run: steps, increments, commits.

use std::cell::OnceCell;

use super::checkpoint::CheckpointError;
use super::collapse::Departure;
use super::course::{Course, Leg};
use super::energy_watch::EnergyWatch;
use super::fidelity::{Instead, Part, Reached};
use super::fingerprint::Fingerprint;
use super::judge::{GROW, growth, resolving};
use super::ladder::Ladder;
use super::method::Method;
use super::newton::Newton;
use super::outcome::{Attempt, Clock, Outcome, Refusal, Report, Solves};
use super::state::State;
use super::stop::Watch;
use super::tally::{Snaps, Swings};
use crate::model::Model;
use crate::model::scene::{Procedure, Step, Tangent};
use crate::results::curve::QUIET;
use crate::results::{Recorder, Sizes, Status, Summary};
use crate::system::bulk::BulkError;
use crate::system::{Steered, System, Trial};
use wythe_contact::{InterfaceLaw, JointLaw};

/// A run that could not begin, or could not be recorded.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// An element or a material does not work.
    #[error(transparent)]
    Bulk(#[from] BulkError),
    /// Results could not be written.
    #[error("results could not be written: {0}")]
    Output(#[from] std::io::Error),
    /// A checkpoint that the model cannot go on from.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A joint law whose answer is not finite.
    #[error(
        "the joint law {law} gives a traction or a history that is not finite at contact point {point}, \
         for the opening {} and the slip {}, {} mm: see what it does there, and whether its parameters are finite",
        gap[0], gap[1], gap[2]
    )]
    JointLaw {
        /// Name of the law.
        law: &'static str,
        /// Number of the contact point.
        point: usize,
        /// Opening and slip at the last commit [mm].
        gap: [f64; 3],
    },
    /// Inertia without mass.
    #[error(
        "step {step} ({name}) has inertia and {place} has no mass: give every material a density"
    )]
    NoMass {
        /// Step.
        step: usize,
        /// Its name in the deck.
        name: String,
        /// What has none.
        place: String,
    },
}

/// Factor of a refused increment (docs/solver.md, "Start, line search, cut").
pub(super) const CUT: f64 = 0.4;

/// Runs a model from rest through all its steps.
///
/// # Errors
/// [`RunError`]. Lost convergence is no error but a [`Status`] with everything before it kept.
pub fn run(model: &Model, recorder: &mut dyn Recorder) -> Result<Summary, RunError> {
    run_part(model, &Part::default(), recorder).map(Summary::in_words)
}

/// Runs a model that is this part of what is shown.
fn run_part(model: &Model, part: &Part, recorder: &mut dyn Recorder) -> Result<Summary, RunError> {
    if let Some(instead) = Instead::of(model) {
        return instead.show(model, part, recorder, Reached::default(), run_part);
    }
    if let Some(told) = part.told() {
        recorder.note(&told);
    }
    // On a thread of the pool: from outside it each of the hundreds of small parallel pieces of an
    // iteration would put this thread to sleep and wake it again.
    rayon::scope(|_| Run::new(model, part)?.finish(None, recorder))
}

/// A run in progress.
pub(super) struct Run<'m> {
    pub(super) model: &'m Model,
    pub(super) part: Part,
    pub(super) system: System,
    pub(super) state: State,
    pub(super) trial: Trial,
    pub(super) summary: Summary,
    pub(super) clock: Clock,
    pub(super) output_seconds: f64,
    pub(super) snaps: Snaps,
    pub(super) swings: Swings,
    pub(super) energy_watch: EnergyWatch,
    /// Where inertia took over from statics, while it acts.
    pub(super) departure: Option<Departure>,
    /// Of the model, when the first checkpoint wants it.
    pub(super) fingerprint: OnceCell<Fingerprint>,
}

impl<'m> Run<'m> {
    pub(super) fn new(model: &'m Model, part: &Part) -> Result<Self, RunError> {
        let numbered = |why: BulkError| why.with_number(|e| part.element(e));
        let mut system = System::new(model).map_err(numbered)?;
        let state = system.initial_state(model);
        let units = model.mesh.unit.iter().max().map_or(0, |u| *u as usize + 1);
        let sizes = Sizes {
            units,
            elements: model.mesh.elements.len(),
            nodes: model.mesh.nodes.len(),
            dofs: 0,
            contact_points: system.contact.points.len(),
        };
        // Warnings of the model were told when it was built.
        let mut summary = Summary::begun(sizes, rayon::current_num_threads());
        summary.mirror_planes.clone_from(&part.planes);
        summary.log.extend(part.told());
        let (clock, trial) = (Clock::default(), Trial::default());
        Ok(Self {
            model,
            part: part.clone(),
            system,
            state,
            trial,
            summary,
            clock,
            output_seconds: 0.0,
            snaps: Snaps::default(),
            swings: Swings::default(),
            energy_watch: EnergyWatch::default(),
            departure: None,
            fingerprint: OnceCell::new(),
        })
    }

    /// All steps, or the rest of one in progress and those after it.
    pub(super) fn finish(
        mut self,
        course: Option<Course<'m>>,
        recorder: &mut dyn Recorder,
    ) -> Result<Summary, RunError> {
        // A run that was killed between its collapse and its summary.
        let (mut next, mut go_on) = (0, self.summary.status != Status::Collapsed);
        if let (Some(course), true) = (course, go_on) {
            next = course.index + 1;
            go_on = self.walk(course, recorder)?;
        }
        while go_on && next < self.model.steps.len() {
            let course = self.begin(next)?;
            next += 1;
            go_on = self.walk(course, recorder)?;
        }
        self.tell_what_moves();
        self.summary.warnings.extend(self.snaps.warning());
        self.summary.warnings.extend(self.swings.warning());
        self.summary.warnings.extend(self.energy_watch.warning());
        Ok(self.summary)
    }

    /// A step to its end; false if the run ends here.
    fn walk(
        &mut self,
        mut course: Course<'m>,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        while let Some(leg) = course.next() {
            let (before, time) = (course.solves, self.state.time);
            let index = course.index;
            let part = course.part(&leg);
            let mut tell = |count| recorder.progress(index, time, before + count);
            let outcome = course.newton.converge(
                &mut self.system,
                &self.state,
                &mut self.trial,
                Attempt {
                    increment: leg.increment,
                    load: course.load,
                    load_end: course.branch.factor(leg.increment.end()),
                    repeat: course.repeat,
                    advance: leg.advance(&course.trail, course.control.as_ref(), part),
                },
                Solves::new(&mut tell),
            );
            let go_on = match outcome {
                Outcome::Converged(report)
                    if self.try_as_shock(&mut course, leg)
                        || self.go_back_to_peak(&mut course, leg, report) =>
                {
                    course.solves += report.iterations;
                    self.cut_back(&mut course);
                    true
                }
                Outcome::Converged(report) => match self.jump(&course, leg) {
                    None => self.accept(&mut course, leg, report, recorder)?,
                    Some(refusal) => {
                        course.solves += report.iterations;
                        self.cut_back(&mut course);
                        self.relax_or_refuse(&mut course, leg, &refusal, recorder)?
                    }
                },
                Outcome::Refused(refusal, spent) => {
                    course.solves += spent;
                    self.cut_back(&mut course);
                    self.relax_or_refuse(&mut course, leg, &refusal, recorder)?
                }
            };
            if !go_on {
                return Ok(false);
            }
        }
        self.clock = self.clock + course.newton.clock;
        Ok(self.keeps_symmetry(&course, recorder))
    }

    /// Relaxes the structure over a snap, or chooses what to try after a refusal; false if the run ends here.
    fn relax_or_refuse(
        &mut self,
        course: &mut Course<'m>,
        leg: Leg,
        refusal: &Refusal,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        course.refusals += 1;
        self.joint_laws_answer()?;
        let size = leg.increment.size;
        let unsolved = !matches!(refusal, Refusal::Snap | Refusal::Linear { .. });
        if unsolved && course.ladder.may_snap() && course.step.procedure == Procedure::Auto {
            self.bound_damage(course);
        }
        if may_relax(course, leg, refusal) {
            match self.relax(course, leg, recorder) {
                Some(relaxed) => return self.accept_relaxed(course, leg, relaxed, recorder),
                None => course.relaxes_below = RELAX_AGAIN * size,
            }
        }
        Ok(self.refuse(course, leg, refusal, recorder))
    }

    /// Whether the laws of users have given finite answers in the last iterate.
    fn joint_laws_answer(&self) -> Result<(), RunError> {
        let laws = &self.model.contact.laws;
        if !laws
            .iter()
            .any(|law| matches!(law, InterfaceLaw::Custom(_)))
        {
            return Ok(());
        }
        let histories = self.trial.interface.iter().enumerate();
        for (point, history) in histories {
            let numbers = history.traction.iter().chain(&history.slots);
            if numbers.clone().all(|n| n.is_finite()) && history.damage.is_finite() {
                continue;
            }
            let law = self.system.contact.law(self.model, point).name();
            let [slip_1, slip_2] = history.slip;
            let gap = [self.state.interface[point].opening, slip_1, slip_2];
            return Err(RunError::JointLaw { law, point, gap });
        }
        Ok(())
    }

    /// From here on the damage of a point has a largest rate, unless a viscosity holds it back.
    fn bound_damage(&mut self, course: &mut Course<'m>) {
        let step = course.step;
        if step.viscosity == 0.0 {
            course.damage_rate = 1.0 / (SNAPS_TAKE * step.increments.max * step.duration);
            self.system.bulk.stabilise(0.0, course.damage_rate);
        }
    }

    /// Takes the bound on the rate of damage away where it holds nothing back any more.
    fn free_damage(&mut self, course: &mut Course<'m>) {
        if course.damage_rate.is_infinite() {
            return;
        }
        let points = self.state.material.iter();
        let lag = points
            .map(|h| h.damage - h.viscous_damage)
            .fold(0.0, f64::max);
        if lag <= SETTLED {
            course.damage_rate = f64::INFINITY;
            self.system
                .bulk
                .stabilise(course.step.viscosity, f64::INFINITY);
        }
    }

    /// Commits the end of a relaxation that `leg` began.
    fn accept_relaxed(
        &mut self,
        course: &mut Course<'m>,
        leg: Leg,
        (last, report): (Leg, Report),
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        course.resumes_at = Some(GROW * leg.increment.size);
        let go_on = self.accept(course, last, report, recorder)?;
        course.newton.dashpots = None;
        Ok(go_on)
    }

    /// Prepares a step.
    fn begin(&mut self, index: usize) -> Result<Course<'m>, RunError> {
        let model = self.model;
        let step = &model.steps[index];
        self.system.steered = steered(model, step);
        let newton = Newton::new(model, step, &self.system, &self.state);
        self.summary.sizes.dofs = self.summary.sizes.dofs.max(newton.unknowns());
        self.system.bulk.stabilise(step.viscosity, f64::INFINITY);
        let massless = self.massless(step);
        if let (true, Some(place)) = (step.procedure.has_inertia(), &massless) {
            return Err(RunError::NoMass {
                step: index,
                name: step.name.clone(),
                place: place.clone(),
            });
        }
        let mut ladder = Ladder::new(model, step, massless.is_none());
        if self.state.energies.moving() > QUIET {
            // What the ladder has set in motion falls on.
            ladder.go_on_moving();
            if self.departure.is_none() {
                self.depart(index, 0.0);
            }
        }
        let mut course = Course::new(newton, ladder, index, step);
        course.steer(model, &self.system);
        let [displacement, force] = self.watched(index);
        course.watch = Watch::new(&model.steps, step, displacement, self.part.wholes());
        course.see(force);
        if step.procedure.has_inertia() {
            self.set_in_motion(index);
        } else if !course.ladder.method().has_inertia() {
            self.bring_to_rest();
        }
        self.adopt(&mut course);
        // The boundary conditions change: the last increment says nothing of the next.
        (self.state.last, self.state.moved) = (None, None);
        self.state.wants_double = false;
        Ok(course)
    }

    /// Goes on by the method of the ladder.
    pub(super) fn adopt(&mut self, course: &mut Course) {
        let rung = course.ladder.rung();
        course
            .newton
            .adopt(rung, &mut self.system, &mut self.state, &mut self.trial);
    }

    /// Commits an increment and chooses the next; false if the run should stop.
    fn accept(
        &mut self,
        course: &mut Course<'m>,
        leg: Leg,
        report: Report,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        let solves = course.solves + report.iterations;
        let size = leg.increment.size;
        let added = report.load_factor - course.load;
        let before = self.state.energies;
        if let Some(motion) = course.newton.motion() {
            motion.end_shock();
        }
        let dq = self.commit(&mut course.newton, course.step, size, added);
        course.load = report.load_factor;
        let (index, cuts) = (course.index, course.cutbacks);
        let row = self.row(index, leg.method, report, leg.increment.end(), solves, cuts);
        self.energy_watch.add(&row);
        match leg.method {
            // What the ladder leaves to inertia moves; what is to be quasi-static should not.
            Method::QuasiStatic if course.step.procedure == Procedure::QuasiStatic => {
                self.swings.add(&row);
            }
            Method::Implex if course.step.procedure == Procedure::Auto => self.snaps.add(&row),
            Method::QuasiStatic => self.mark_what_fell(),
            _ => {}
        }
        let collapsed = self.collapses(course, leg.method, before.kinetic);
        let growth = growth(leg, report, course.ladder.floor());
        if leg.method.follows_path() {
            course.schedule.reach(course.branch.time(course.load));
        } else if leg.method == Method::QuasiStatic && course.step.procedure == Procedure::Auto {
            let hurry = self.state.energies.kinetic / before.kinetic;
            course
                .schedule
                .accept(leg.increment, growth.min(resolving(hurry)));
        } else {
            course.schedule.accept(leg.increment, growth);
        }
        self.free_damage(course);
        course.relaxations = if leg.method == Method::Relaxation {
            course.relaxations + 1
        } else {
            0
        };
        if let Some(size) = course.resumes_at.take() {
            // What moved in pseudo-time says nothing of the next increment.
            course.schedule.resume(size);
            course.trail.forget();
            course.peak.forget();
            self.state.last = None;
        } else if let Some(measure) = course.measured_by() {
            let share = self.state.energies.dissipated_share(&before);
            let dissipates = measure == Method::ArcLength || share > SHARE;
            let (system, trial) = (&self.system, &self.trial);
            if !dissipates
                || !course
                    .trail
                    .learn(measure, system, trial, &dq, (size, added), growth)
            {
                course.trail.forget();
            }
        }
        let seen = self.watched(course.index);
        let carried = leg.method == Method::QuasiStatic && course.step.procedure == Procedure::Auto;
        let moves = self.state.energies.moves_on(&before);
        let swings = carried && moves;
        let why = course
            .watch
            .as_mut()
            .and_then(|watch| watch.take(seen, swings));
        course.see(seen[1]);
        course.resolve_peak();
        let whole = course.is_whole();
        let end = whole || why.is_some() || collapsed;
        if let (Some(why), false) = (&why, whole) {
            self.stop(course, why, recorder);
        }
        let keep = self.record(&row, recorder, end)?;
        self.summary.increments += 1;
        self.summary.iterations += solves;
        (course.cutbacks, course.solves) = (0, 0);
        (course.refusals, course.relaxes_below) = (0, f64::INFINITY);
        (course.repeat, course.end_refused, course.tried) = (true, false, None);
        let done = course.schedule.done();
        if leg.method == Method::Static || course.beyond.is_some_and(|beyond| beyond <= done) {
            course.beyond = None;
        }
        let sense = course.sense();
        let forth = (sense * added, sense * course.load);
        if course.ladder.descend(report, moves, forth.0, forth.1) {
            if leg.method.has_inertia() {
                self.bring_to_rest();
                // The last increment is no guess of the next one. Its motion may go on.
                self.state.moved = self.state.last.take();
            }
            if leg.method.follows_path() {
                // The pace of the path is none of the load.
                let pace = forth.0 / course.branch.slope().abs();
                course.schedule.resume(pace.max(course.ladder.floor()));
                self.state.last = None;
            }
            self.adopt(course);
            let why = format!("{} has passed the trouble", leg.method.name());
            self.note(course, &why, recorder);
        }
        let mut keeps_symmetry = true;
        if collapsed {
            self.tell_collapse(course, recorder);
        }
        if !end && course.is_at_row() {
            keeps_symmetry = self.keeps_symmetry(course, recorder);
            self.turn(course);
        }
        self.tally(&course.newton);
        let all_done = collapsed || (end && course.index + 1 == self.model.steps.len());
        self.offer(course, all_done || !keep || !keeps_symmetry, recorder)?;
        self.tally(&course.newton);
        if !keep && !collapsed {
            self.summary.status = Status::Interrupted;
            "stopped by the user".clone_into(&mut self.summary.message);
        }
        Ok(keep && keeps_symmetry && !collapsed)
    }

    /// Goes on along the next branch of the amplitude.
    fn turn(&mut self, course: &mut Course<'m>) {
        let before = course.branch.slope();
        self.state.moved = None;
        course.row += 1;
        course.branch = course.step.branch(course.row);
        course.schedule.turn(course.branch);
        let slope = course.branch.slope();
        course
            .newton
            .turn(slope, &mut self.system, &mut self.state, &mut self.trial);
        if before * slope > 0.0 {
            // The same way at another rate.
            if let Some(last) = &mut self.state.last {
                last.dt *= before / slope;
            }
            return;
        }
        // Where loads turn round the last increment says nothing of the next.
        self.state.last = None;
        course.trail.forget();
        course.peak.forget();
        course.see(self.watched(course.index)[1]);
        course.schedule.begin_small();
        course.beyond = None;
        if course.ladder.turn() {
            self.adopt(course);
        }
    }

    /// Tells of a change of method.
    pub(super) fn note(&mut self, course: &Course, why: &str, recorder: &mut dyn Recorder) {
        let text = format!(
            "step {} ({}), {}: {why}; goes on by {}",
            course.index,
            course.step.name,
            course.progress(),
            course.ladder.method().name()
        );
        recorder.note(&text);
        self.summary.log.push(text);
    }

    /// Ends a step before its loads are whole, as the deck has it.
    fn stop(&mut self, course: &mut Course, why: &str, recorder: &mut dyn Recorder) {
        course.stopped = true;
        let text = format!(
            "step {} ({}) ends at {}: {why}",
            course.index,
            course.step.name,
            course.progress()
        );
        recorder.note(&text);
        self.summary.log.push(text);
    }

    /// Wall time so far.
    pub(super) fn tally(&mut self, newton: &Newton) {
        let c = self.clock + newton.clock;
        self.summary.factorisations = c.factorisations;
        self.summary.reused = c.reused;
        self.summary.local_solves = c.local_solves;
        self.summary.evaluations = c.evaluations;
        self.summary.seconds_by_phase = [
            c.elements,
            c.contact,
            c.assembly,
            c.factorise,
            c.solve,
            self.output_seconds,
        ];
    }
}

/// Damage that a bound on its rate holds back, at most, where a snap is over [-].
const SETTLED: f64 = 0.02;

/// Largest increments of a step in which the damage of a point may rise from 0 to 1, at least (docs/solver.md, "Snaps").
const SNAPS_TAKE: f64 = 4.0;

/// Stiffness along what steers the load of a step, which secant tangents want.
pub(super) fn steered(model: &Model, step: &Step) -> Option<Steered> {
    let controls = step.procedure == Procedure::DisplacementControl;
    let control = step
        .control
        .filter(|_| controls && step.tangent == Tangent::Secant)?;
    Steered::new(model, control)
}

/// Whether a relaxation may lead over the trouble that an increment was refused for.
fn may_relax(course: &Course, leg: Leg, refusal: &Refusal) -> bool {
    let applies = match course.step.procedure {
        Procedure::Auto => course.ladder.may_snap(),
        Procedure::DisplacementControl => true,
        _ => false,
    };
    let size = leg.increment.size;
    let stuck = match refusal {
        // The path of a clear snap-back is followed, where that is possible.
        Refusal::Snap => course.relaxations == 0 && !course.ladder.prefers_paths(),
        Refusal::Linear { .. } => false,
        // One right behind another creeps: walls 13, 27 and 35 of the zoo took up to three times as many solves.
        _ => course.relaxations == 0 && (course.refusals > 1 || course.ladder.is_small(size)),
    };
    applies && stuck && size < course.relaxes_below
}

/// Part of the size of an increment whose relaxation led nowhere below which another one is tried.
const RELAX_AGAIN: f64 = 0.2;

/// Part of the energy that an increment takes in or gives back, from which on what it dissipates
/// measures the path.
const SHARE: f64 = 0.02;
