//! Which method solves the next increment.
//!
//! `auto` begins with the cheapest that is safe and steps over to the next where that finds no
//! equilibrium:
//!
//! ```text
//! static ──▶ static with consistent tangents (secant ones settle too slowly for any increment)
//!        ──▶ dissipation (the load must fall before it rises: snap-back; with consistent tangents
//!            where secant ones do not get along it)
//!        ──▶ implex (a unit snaps: solids extrapolated; only where materials soften)
//!        ──▶ direct (points that do not match settle too slowly with the shifted penalty)
//!        ──▶ quasi_static (bodies that nothing holds, falls: inertia; only where all has mass)
//!        ──▶ static (over what nothing leads through: where it found equilibrium, or in the largest
//!            increments)
//! ```
//!
//! and back to static when the trouble has passed. A matrix that a free body makes singular leads to
//! inertia at once. Every other procedure is a ladder of one rung.

use serde::{Deserialize, Serialize};

use super::method::Method;
use super::newton::IMBALANCE;
use super::outcome::{Refusal, Report};
use crate::model::Model;
use crate::model::scene::{Procedure, Step, Tangent};

/// Part of the first increment below which static increments are not cut before another method is
/// tried.
pub const FLOOR: f64 = 0.1;
/// The same for extrapolated solids and the direct method, of that.
const SECOND_FLOOR: f64 = 0.1;
/// Quiet increments after which statics is tried again; doubled each time that it fails.
const PATIENCE: usize = 3;
/// A path that led nowhere is tried again after 2, 4, 8, … further troubles, 128 at most.
const MOST_LOST: u32 = 6;
/// Refusals in a row after which secant tangents, not the size of the increment, are to blame.
const STALLS: usize = 2;
/// Solves of an increment with consistent tangents within which secant ones may be tried again.
const EASY: usize = 2;
/// Increments in which the load must rise before statics takes over from a path; doubled each time.
const RISING: usize = 2;

/// What to do after a refusal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// A smaller increment.
    Cut,
    /// The next method.
    Climb,
    /// Nothing is left to try.
    GiveUp,
}

/// A method and its tangents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rung {
    /// What solves the increments.
    pub method: Method,
    /// With which matrices.
    pub tangent: Tangent,
}

/// The methods of a step, the one that is used now, and what it must show before it is left.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Ladder {
    rungs: Vec<Rung>,
    at: usize,
    /// Size of increments below which statics gives up.
    floor: f64,
    /// Increments in a row without the trouble for which the first method was left.
    calm: usize,
    patience: usize,
    rising: usize,
    /// Part of the loads when the first method was left.
    left_at: f64,
    /// How often paths led nowhere, and how many troubles yet pass without one being tried.
    lost: u32,
    passed_over: usize,
    /// Whether statics was left for a snap.
    snaps: bool,
    /// How many rungs stand before the first that is for trouble, and refusals in a row on the first.
    statics: usize,
    stalls: usize,
}

impl Ladder {
    /// The ladder of a step; `all_has_mass` if inertia could act.
    pub fn new(model: &Model, step: &Step, all_has_mass: bool) -> Self {
        let softens = model.materials.iter().any(|m| m.parameters.yields());
        let own = |method| Rung {
            method,
            // Extrapolated solids are linear: their tangent is their secant.
            tangent: if method == Method::Implex {
                Tangent::Secant
            } else {
                step.tangent
            },
        };
        let mut rungs = vec![own(Method::of(step.procedure))];
        if step.procedure == Procedure::Auto {
            let path = own(Method::Dissipation);
            if softens {
                if step.tangent == Tangent::Secant {
                    rungs.push(Rung {
                        method: Method::Static,
                        tangent: Tangent::Consistent,
                    });
                }
                rungs.push(path);
                if step.tangent == Tangent::Secant {
                    rungs.push(Rung {
                        tangent: Tangent::Consistent,
                        ..path
                    });
                }
                rungs.push(own(Method::Implex));
            }
            if step.tangent != Tangent::Direct {
                rungs.push(Rung {
                    method: Method::Direct,
                    tangent: Tangent::Direct,
                });
            }
            if !softens {
                rungs.push(path);
            }
            if all_has_mass {
                rungs.push(own(Method::QuasiStatic));
            }
            rungs.push(own(Method::Static));
        }
        let statics = rungs.iter().take_while(|r| r.method == Method::Static);
        Self {
            statics: statics.count().max(1),
            stalls: 0,
            rungs,
            at: 0,
            floor: FLOOR * step.increments.initial,
            calm: 0,
            patience: PATIENCE,
            rising: RISING,
            left_at: 0.0,
            lost: 0,
            passed_over: 0,
            snaps: false,
        }
    }

    /// Where this ladder was, as that of a step; none if the step has other methods.
    pub fn of_step(self, model: &Model, step: &Step, all_has_mass: bool) -> Option<Self> {
        let Self { rungs, floor, .. } = Self::new(model, step, all_has_mass);
        let fits = self.rungs == rungs
            && self.at < rungs.len()
            && (1..=rungs.len()).contains(&self.statics);
        fits.then_some(Self { floor, ..self })
    }

    /// The whole step becomes `part` of a longer one.
    pub fn lengthen(&mut self, part: f64) {
        self.floor *= part;
        self.left_at *= part;
    }

    /// Loads turn round: back to the first method from a path, which is none of the way back. Whether that
    /// changes anything.
    pub fn turn(&mut self) -> bool {
        let leaves = self.at > 0 && self.method().follows_path();
        if leaves {
            (self.at, self.calm) = (0, 0);
        }
        leaves
    }

    /// Begins with inertia, if it may.
    pub fn go_on_moving(&mut self) {
        self.at = self.inertia().unwrap_or(0);
    }

    /// The method of now.
    pub fn method(&self) -> Method {
        self.rung().method
    }

    /// The method of now with its tangents.
    pub fn rung(&self) -> Rung {
        self.rungs[self.at]
    }

    /// Whether nothing is left to try but what `auto` ends with.
    pub fn is_last(&self) -> bool {
        self.at > 0 && self.at + 1 == self.rungs.len()
    }

    /// Whether statics is the method of now, before anything else was tried, and solids may snap.
    pub fn may_snap(&self) -> bool {
        self.at < self.statics && self.place(Method::Implex).is_some()
    }

    /// Size of increments below which errors are reported and no longer pursued.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// What follows from the refusal of an increment of this size; `spent` if its path cannot be cut
    /// further.
    pub fn refused(&mut self, refusal: &Refusal, size: f64, spent: bool) -> Answer {
        let higher = self.at + 1 < self.rungs.len();
        let free = matches!(refusal, Refusal::Linear { dof: Some(_), .. });
        let enough = match self.method() {
            _ if spent => true,
            Method::Static if self.at + 1 < self.statics => {
                self.stalls += 1;
                self.stalls >= STALLS || self.is_small(size) || free
            }
            Method::Static => self.is_small(size) || (free && self.inertia().is_some()),
            Method::Implex | Method::Direct => size <= SECOND_FLOOR * self.floor,
            _ => false,
        };
        match (enough, higher) {
            (true, true) => Answer::Climb,
            (true, false) if spent => Answer::GiveUp,
            _ => Answer::Cut,
        }
    }

    /// Whether smaller increments are not worth trying.
    pub fn is_small(&self, size: f64) -> bool {
        size <= self.floor
    }

    /// Whether a snap should be followed along its path rather than jumped over.
    pub fn prefers_paths(&self) -> bool {
        self.at < self.statics && self.place(Method::Dissipation).is_some()
    }

    /// Steps over to the next method, at part `load` of the loads. A free body needs inertia.
    pub fn climb(&mut self, refusal: &Refusal, load: f64) {
        self.stalls = 0;
        if self.at < self.statics {
            self.left_at = load;
            self.snaps = *refusal == Refusal::Snap;
        }
        let wanted = match refusal {
            Refusal::Linear { dof: Some(_), .. } => self.inertia(),
            // Where secant tangents stalled before, they do along the path.
            Refusal::Snap => self
                .place(Method::Dissipation)
                .map(|path| path + usize::from(self.at > 0)),
            _ => None,
        };
        if self.method() == Method::Dissipation {
            let again = self
                .rungs
                .get(self.at + 1)
                .is_some_and(|rung| rung.method == Method::Dissipation);
            // What nothing holds any more is beyond every path.
            let comes_loose = wanted.is_some() && *refusal != Refusal::Snap;
            if self.snaps && !comes_loose {
                // If no tangent leads along the path: statics has found what lies beyond, that is taken.
                self.at = if again {
                    self.at + 1
                } else {
                    self.rungs.len() - 1
                };
                self.calm = 0;
                return;
            }
            self.passed_over = 2 << self.lost.min(MOST_LOST);
            self.lost += 1;
        }
        let last = self.rungs.len() - 1;
        let mut next = (self.at + 1).min(last);
        if self.rungs[next].method == Method::Dissipation
            && wanted.is_none()
            && self.passed_over > 0
        {
            self.passed_over -= 1;
            next += 1;
        }
        // A path of consistent tangents is for snaps: elsewhere extrapolation is cheaper.
        while self.rungs[next].method == Method::Dissipation
            && self.rungs[next - 1].method == Method::Dissipation
        {
            next += 1;
        }
        self.at = wanted.map_or(next, |rung| rung.max(next));
        self.calm = 0;
    }

    /// The rung with inertia.
    fn inertia(&self) -> Option<usize> {
        self.place(Method::QuasiStatic)
    }

    /// The first rung of a method.
    fn place(&self, method: Method) -> Option<usize> {
        self.rungs.iter().position(|rung| rung.method == method)
    }

    /// Back to the first method if the increment shows that the trouble has passed. `moves`: bodies still move; `added`: part of
    /// the load that the increment added; `load`: the load now.
    pub fn descend(&mut self, report: Report, moves: bool, added: f64, load: f64) -> bool {
        self.stalls = 0;
        if self.at == 0 {
            return false;
        }
        let (passed, needed) = match self.method() {
            Method::Implex => (report.extrapolation_error <= IMBALANCE, 1),
            Method::QuasiStatic => (!moves, self.patience),
            Method::Direct => (true, self.patience),
            Method::Static => (report.iterations <= EASY, self.patience),
            _ => (added > 0.0 && load >= self.left_at, self.rising),
        };
        self.calm = if passed { self.calm + 1 } else { 0 };
        if self.calm < needed {
            return false;
        }
        match self.method() {
            Method::QuasiStatic | Method::Direct | Method::Static => self.patience *= 2,
            Method::Dissipation => self.rising *= 2,
            _ => {}
        }
        (self.at, self.calm) = (0, 0);
        true
    }
}
