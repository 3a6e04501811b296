//! One step in progress: chooses the next increment and its method.

use super::acceptance::resolving;
use super::damage_bound::SNAPS_TAKE;
use super::explain::progress;
use super::fallback::{Fallback, Least};
use super::path::{Advance, PathMeasure};
use super::peak_control::PeakWatch;
use super::snap::Relaxations;
use super::step_size::{Increment, Schedule};
use super::stop::Watch;
use crate::assembly::System;
use crate::model::Model;
use crate::model::amplitude::Branch;
use crate::model::scene::{Procedure, Step};
use crate::solve::increment::newton::Newton;
use crate::state::Method;

/// A step in progress.
pub(in crate::solve) struct StepRun<'m> {
    pub(in crate::solve) index: usize,
    pub(in crate::solve) step: &'m Step,
    pub(in crate::solve) newton: Newton<'m>,
    pub(in crate::solve) schedule: Schedule,
    pub(in crate::solve) fallback: Fallback,
    pub(in crate::solve) path: PathRun,
    pub(in crate::solve) branch: BranchRun,
    /// Part of the step's loads that acts now.
    pub(in crate::solve) load: f64,
    pub(in crate::solve) attempts: Attempts,
    /// Whether the next increment starts by repeating the last one.
    pub(in crate::solve) repeat: bool,
    /// Conditions that end the step early, if it drives or loads.
    pub(in crate::solve) watch: Option<Watch>,
    /// Whether the step ended early.
    pub(in crate::solve) stopped: bool,
    /// Watches for peaks between the increments.
    pub(in crate::solve) peak: PeakWatch,
    pub(in crate::solve) snap: SnapRun,
    /// Number of increments for which the loads have been held, the next one included; 0 where they grow.
    pub(in crate::solve) held: usize,
}

/// Path that a step follows where its loads are not prescribed.
pub(in crate::solve) struct PathRun {
    pub(in crate::solve) measure: PathMeasure,
    /// Displacement that steers the load, if the step has one.
    pub(in crate::solve) control: Option<Steering>,
    /// Whether the rest of the step was tried in one static increment and rejected; the path then continues.
    pub(in crate::solve) end_rejected: bool,
}

/// Present branch of the amplitude.
pub(in crate::solve) struct BranchRun {
    /// Index among the branches of the step.
    pub(in crate::solve) index: usize,
    pub(in crate::solve) of: Branch,
    /// Largest part of the loads that statics carried on it, counted in the sense in which it changes.
    pub(in crate::solve) carried: f64,
    /// Part of the loads from which the equilibrium is not stable, since the last increment of statics.
    pub(in crate::solve) unstable_from: Option<f64>,
}

/// Attempts since the last commit.
#[derive(Default)]
pub(in crate::solve) struct Attempts {
    /// Linear solves.
    pub(in crate::solve) solves: usize,
    /// Attempts that were rejected, or repeated with a smaller size.
    pub(in crate::solve) cutbacks: usize,
    /// Attempts that were rejected.
    pub(in crate::solve) rejections: usize,
    /// Largest rise of the force per part of the step among the attempts at the present increment.
    pub(in crate::solve) tried: Option<f64>,
}

/// Treatment of a snap in progress.
pub(in crate::solve) struct SnapRun {
    /// Part of the step at which a static increment found equilibrium beyond a snap.
    pub(in crate::solve) beyond: Option<f64>,
    /// Largest rate of damage while a snap lasts [1/s]; infinite otherwise.
    pub(in crate::solve) damage_rate: f64,
    /// Number of the largest increments in which the damage of a point may rise from 0 to 1 while a snap lasts.
    pub(in crate::solve) takes: f64,
    /// Relaxations in a row, and those that failed.
    pub(in crate::solve) relaxations: Relaxations,
    /// Size of the increment after a relaxation that is about to be committed.
    pub(in crate::solve) resumes_at: Option<f64>,
    /// Size below which a relaxation is tried again after one that failed.
    pub(in crate::solve) relaxes_below: f64,
}

/// A displacement c·q that steers the load factor.
pub(in crate::solve) struct Steering {
    /// c. `[slot]`
    gradient: Vec<f64>,
    /// Displacement of the whole step [mm].
    way: f64,
}

impl Steering {
    /// Advance by `part` of the displacement of the whole step.
    pub(in crate::solve) fn along(&self, part: f64) -> Advance<'_> {
        Advance::Along {
            gradient: &self.gradient,
            by: part * self.way,
        }
    }
}

/// Next increment to attempt.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct IncrementRequest {
    pub(in crate::solve) method: Method,
    /// Part of the step's time, which is that of its loads where these are prescribed.
    pub(in crate::solve) increment: Increment,
}

impl IncrementRequest {
    /// How far an increment that adds `added` to the load factor advances, as a part of the step.
    fn progress(&self, added: f64) -> f64 {
        match self.method {
            Method::Relaxation => 0.0,
            method if method.follows_path() => added.abs(),
            _ => self.increment.size,
        }
    }

    /// Advance of the increment. A displacement that steers the load advances by `part` of its way in the step.
    pub(in crate::solve) fn advance<'a>(
        &self,
        path_measure: &'a PathMeasure,
        control: Option<&'a Steering>,
        part: f64,
    ) -> Advance<'a> {
        match (self.method, control) {
            (Method::DisplacementControl | Method::QuasiStatic, Some(control)) => {
                control.along(part)
            }
            (method, _) if method.follows_path() => path_measure.advance(),
            _ => Advance::Load,
        }
    }
}

impl<'m> StepRun<'m> {
    /// Step before its first increment.
    pub(in crate::solve) fn new(
        newton: Newton<'m>,
        fallback: Fallback,
        index: usize,
        step: &'m Step,
    ) -> Self {
        Self {
            index,
            step,
            newton,
            schedule: Schedule::new(step.increments, step.branch(0).to[0]),
            fallback,
            path: PathRun {
                measure: PathMeasure::new(
                    step.increments.max * step.steepest() * longest_drive(step),
                    step.increments.max,
                ),
                control: None,
                end_rejected: false,
            },
            branch: BranchRun {
                index: 0,
                of: step.branch(0),
                carried: f64::NEG_INFINITY,
                unstable_from: None,
            },
            load: 0.0,
            attempts: Attempts::default(),
            repeat: true,
            watch: None,
            stopped: false,
            peak: PeakWatch::default(),
            snap: SnapRun {
                beyond: None,
                damage_rate: f64::INFINITY,
                takes: SNAPS_TAKE,
                relaxations: Relaxations::default(),
                resumes_at: None,
                relaxes_below: f64::INFINITY,
            },
            held: 0,
        }
    }

    /// Notes that statics carries the present loads.
    pub(in crate::solve) fn note_carried(&mut self) {
        let load = self.sense() * self.load;
        self.branch.carried = self.branch.carried.max(load);
        self.branch.unstable_from = None;
    }

    /// Holds the loads while bodies that inertia carries `move`, and lets them grow again once these are at rest
    /// (docs/theory/inertia.md, Algorithm). A step that drives goes on, and so does a weight that grows from nothing: dry
    /// bodies that nothing presses move at any load.
    pub(in crate::solve) fn hold_or_go_on(&mut self, moves: bool) {
        let carried = self.fallback.method() == Method::QuasiStatic;
        let seeks = self.step.procedure == Procedure::Auto && self.step.only_loads();
        let holds = moves && carried && seeks && self.held < MOST_HELD;
        if holds {
            self.held += 1;
        } else if self.held > 0 {
            self.held = 0;
            let size = self
                .fallback
                .floor()
                .max(self.step.increments.peak * self.load.abs());
            self.schedule.shorten(size);
        }
    }

    /// Sets the displacement that steers the load, if the step has one.
    pub(in crate::solve) fn steer(&mut self, model: &Model, system: &System) {
        let Some(control) = self.step.control else {
            return;
        };
        let probe = &model.probes[control.probe];
        let mut nodal = vec![[0.0; 3]; system.bulk.reference.len()];
        for (n, axis, part) in probe.gradient() {
            nodal[n][axis] += part;
        }
        let mut gradient = vec![0.0; system.dofs.slots];
        system.dofs.collect(&nodal, &mut gradient);
        self.path.control = Some(Steering {
            gradient,
            way: control.displacement,
        });
    }

    /// Whether no increment of the step is accepted yet.
    pub(in crate::solve) fn is_fresh(&self) -> bool {
        self.branch.index == 0 && self.schedule.done() == 0.0
    }

    /// Sizes down to which the next static increment is cut. The first of a step is cut until the structure is elastic
    /// in it, however far the step goes. A force at which bodies come loose is found to the part `increments.peak` of
    /// itself. Below the largest force of a drive inertia carries the bodies at once.
    pub(in crate::solve) fn least(&self) -> Least {
        let (floor, increments) = (self.fallback.floor(), self.step.increments);
        let first = floor.min(FIRST * increments.initial);
        let loads = !self.step.drives() && self.step.control.is_none();
        match (self.is_fresh(), loads) {
            (true, _) => Least {
                before_motion: first,
                of_statics: first,
            },
            (false, true) => {
                let limit = floor.min(increments.peak * self.load.abs());
                // Without solids that soften, any trouble is that of a limit load.
                let softens = self.fallback.may_snap();
                Least {
                    before_motion: limit,
                    of_statics: if softens { floor } else { limit },
                }
            }
            // The limit of a stiff scene may lie within few of the smallest increments of a long drive.
            (false, false) => Least {
                before_motion: self.peak.resolves(increments.peak),
                of_statics: floor.min(EARLY * self.schedule.done().abs()),
            },
        }
    }

    /// Part of the step's drives and loads that the increment adds, where these are prescribed.
    pub(in crate::solve) fn part(&self, request: &IncrementRequest) -> f64 {
        let start = request.increment.start;
        let size = request.increment.end() - start;
        match self.step.amplitude {
            None => size,
            Some(_) => self.branch.of.factor(start + size) - self.branch.of.factor(start),
        }
    }

    /// Records a point of the curve for peak control: the load factor where a displacement steers it, else the
    /// `force` of the drive. Steps that neither drive nor steer record nothing.
    pub(in crate::solve) fn see(&mut self, force: f64) {
        let force = match (&self.path.control, self.step.drives()) {
            (Some(_), _) => self.load,
            (None, true) => force,
            (None, false) => return,
        };
        self.peak.take(self.schedule.done(), force);
    }

    /// Shortens the next increment where it would pass a peak.
    pub(in crate::solve) fn resolve_peak(&mut self) {
        let method = self.fallback.method();
        // Paths have their own measure, and motion has peaks of its own.
        if method.follows_path() || method.has_inertia() {
            return;
        }
        let (next, part) = (self.schedule.size(), self.step.increments.peak);
        if let Some(size) = self.peak.shortens(next, part) {
            self.schedule.shorten(size);
        }
    }

    /// 1 where loads and drives grow, −1 where they decrease.
    pub(in crate::solve) fn sense(&self) -> f64 {
        self.branch.of.slope().signum()
    }

    /// Whether the last increment reached the end of its branch of the amplitude.
    pub(in crate::solve) fn is_at_row(&self) -> bool {
        self.schedule.next().is_none()
    }

    /// Chooses the size of the next increment. `growth`: factor by the solves of the last one; `hurry`: growth of
    /// the kinetic energy in it.
    pub(in crate::solve) fn choose_size(
        &mut self,
        request: IncrementRequest,
        growth: f64,
        hurry: f64,
    ) {
        if request.method.follows_path() {
            self.schedule.reach(self.branch.of.time(self.load));
        } else if request.method == Method::QuasiStatic && self.step.procedure.seeks_equilibrium() {
            let growth = growth.min(resolving(hurry));
            self.schedule.accept(request.increment, growth);
        } else {
            self.schedule.accept(request.increment, growth);
        }
    }

    /// Begins the attempts at the next increment after one of so many solves that added `added` to the load factor.
    pub(in crate::solve) fn begin_attempts(
        &mut self,
        request: IncrementRequest,
        solves: usize,
        added: f64,
    ) {
        self.attempts = Attempts::default();
        self.fallback.count(solves, request.progress(added));
        self.snap.relaxations.end_increment(request.method);
        self.snap.relaxes_below = f64::INFINITY;
        (self.repeat, self.path.end_rejected) = (true, false);
        let done = self.schedule.done();
        if request.method == Method::Static || self.snap.beyond.is_some_and(|beyond| beyond <= done)
        {
            self.snap.beyond = None;
        }
    }

    /// Whether the step is complete.
    pub(in crate::solve) fn is_whole(&self) -> bool {
        self.is_at_row() && self.branch.index + 1 == self.step.branches()
    }

    /// Progress of the step, in words.
    pub(in crate::solve) fn progress(&self) -> String {
        let done = match self.step.amplitude {
            None => self.load,
            Some(_) => self.schedule.done(),
        };
        progress(self.step, done)
    }

    /// The next increment; none when the step is done.
    pub(in crate::solve) fn next(&self) -> Option<IncrementRequest> {
        if self.stopped {
            return None;
        }
        let increment = self.schedule.next()?;
        let method = self.fallback.method();
        if self.held > 0 {
            let size = self.schedule.size();
            let holds = true;
            let increment = Increment {
                size,
                holds,
                ..increment
            };
            return Some(IncrementRequest { method, increment });
        }
        if !method.follows_path() {
            return Some(IncrementRequest { method, increment });
        }
        if !self.path.measure.leads(method) {
            return Some(IncrementRequest {
                method: Method::Static,
                increment,
            });
        }
        let start = self.branch.of.time(self.load);
        let (size, adds) = self.path.measure.next();
        let (sense, [end, most]) = (self.sense(), self.branch.of.to);
        // If the path would pass the end of the step or branch, prescribe the loads there, so that it ends exactly.
        if sense * adds > 0.0
            && sense * (self.load + adds) >= sense * most
            && !self.path.end_rejected
        {
            return Some(IncrementRequest {
                method: Method::Static,
                increment: Increment {
                    start,
                    size: end - start,
                    holds: false,
                },
            });
        }
        Some(IncrementRequest {
            method,
            increment: Increment {
                start,
                size,
                holds: false,
            },
        })
    }

    /// Method by whose measure the last increment is taken, if any.
    pub(in crate::solve) fn measured_by(&self) -> Option<Method> {
        match (self.fallback.method(), self.step.procedure) {
            (Method::ArcLength, _) => Some(Method::ArcLength),
            (Method::Dissipation, _) | (_, Procedure::Auto) => Some(Method::Dissipation),
            _ => None,
        }
    }
}

/// Most increments for which loads are held.
const MOST_HELD: usize = 400;

/// Part of the way so far down to which a step that drives or steers is cut, where that is less than its smallest size.
const EARLY: f64 = 0.02;

/// Size down to which the first increment of a step is cut, as a part of its given size.
const FIRST: f64 = 1e-3;

/// Largest displacement of a drive in a step [mm]; infinite without drive.
fn longest_drive(step: &Step) -> f64 {
    use crate::model::scene::BeamMotion;
    let beams = step.motion.iter().flatten().map(|motion| match motion {
        BeamMotion::Driven(by) => by.abs(),
        _ => 0.0,
    });
    let springs = step.springs.iter().flatten().map(|by| by.abs());
    let longest = beams.chain(springs).fold(0.0, f64::max);
    if longest > 0.0 {
        longest
    } else {
        f64::INFINITY
    }
}
