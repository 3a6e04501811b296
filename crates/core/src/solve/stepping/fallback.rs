//! Fallback: the order in which `auto` tries the methods (docs/theory/procedures.md, Algorithm).
//!
//! `auto` starts with the cheapest safe method and changes to the next where that finds no equilibrium:
//!
//! ```text
//! static ──▶ static with consistent tangents (secant ones converge too slowly at any size)
//!        ──▶ dissipation (snap-back: the load must fall before it rises; with consistent tangents
//!            where secant ones fail on the path)
//!        ──▶ implex (a unit snaps: solids extrapolated; only where materials soften and displacements are driven)
//!        ──▶ direct (points on meshes that do not match converge too slowly with the shifted penalty)
//!        ──▶ quasi_static (bodies without support, falls: inertia; only where everything has mass)
//!        ──▶ static (no method follows the path: jump to the equilibrium found beyond, or take the
//!            largest increments)
//! ```
//!
//! Where all joints are dry, all methods have direct tangents instead of secant ones while these advance further
//! ([`Exchange`]).
//!
//! It returns to static when the trouble has passed. A matrix that a free body makes singular leads to inertia at
//! once. `displacement_control` has consistent tangents to fall back on where secant ones converge too slowly, and
//! inertia, under which the displacement is prescribed as before, where a snap leads to no equilibrium. Every other
//! procedure has a single method.

use serde::{Deserialize, Serialize};
use wythe_contact::JointLaw;

use super::exchange::Exchange;
use crate::model::Model;
use crate::model::scene::{Procedure, Step, Tangent};
use crate::solve::increment::newton::IMBALANCE;
use crate::solve::increment::outcome::{Rejection, Report};
use crate::state::Method;

/// Size, as a part of the first increment, below which static increments are not cut before another method is tried.
pub const FLOOR: f64 = 0.1;
/// The same for extrapolated solids and the direct method, as a part of that floor.
const SECOND_FLOOR: f64 = 0.1;
/// Number of increments without trouble after which statics is tried again; doubled each time.
const PATIENCE: usize = 3;
/// A path that failed is skipped in the next 2·2ⁿ troubles; largest n, for at most 128.
const MOST_LOST: u32 = 6;
/// Rejections in a row after which secant tangents are given up, whatever the increment size.
const STALLS: usize = 2;
/// Most increments of a path in a row. One that leads nowhere goes to and fro.
const LONGEST_PATH: usize = 300;
/// Part of the loads at which a path began, below which it is left where loads are prescribed.
const FALLEN: f64 = 0.5;
/// Most solves of an increment with consistent tangents after which secant ones may be tried again.
const EASY: usize = 2;
/// Increments in which the load must rise before a path is left for statics; doubled each time.
const RISING: usize = 2;

/// Sizes down to which static increments are cut, as parts of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least {
    /// Where a body comes loose: before inertia carries it. Infinite: inertia carries it at once.
    pub before_motion: f64,
    /// In any other trouble: before another method is tried.
    pub of_statics: f64,
}

/// Answer to a rejection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Try a smaller increment.
    Cut,
    /// Try the next method.
    NextMethod,
    /// Give up.
    GiveUp,
}

/// A method and its tangents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MethodChoice {
    /// Method of the increments.
    pub method: Method,
    /// Matrices of the increments.
    pub tangent: Tangent,
}

/// Counters of paths.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Paths {
    /// Number of increments in which the load must rise before a path is left.
    rising: usize,
    /// Number of increments in a row along a path.
    on_path: usize,
    /// Number of paths that failed.
    lost: u32,
    /// Number of further troubles in which paths are skipped.
    passed_over: usize,
}

/// Methods of a step, the present one, and the counters by which it is left.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Fallback {
    choices: Vec<MethodChoice>,
    /// Choices with the other tangents, if these may be exchanged; else empty.
    others: Vec<MethodChoice>,
    exchange: Exchange,
    at: usize,
    /// Increment size below which statics is given up.
    floor: f64,
    /// Increments in a row without the trouble for which the first method was left.
    untroubled: usize,
    patience: usize,
    paths: Paths,
    /// Part of the loads at which the first method was left.
    left_at: f64,
    /// Whether statics was left because of a snap.
    snaps: bool,
    /// Whether any solid yields or softens.
    softens: bool,
    /// Number of leading choices of the first method, and rejections in a row by one of them other than the last.
    statics: usize,
    stalls: usize,
}

const fn with(method: Method, tangent: Tangent) -> MethodChoice {
    MethodChoice { method, tangent }
}

/// Methods of a step with these tangents, in the order in which they are tried; `all_has_mass` if inertia can act.
fn choices(model: &Model, step: &Step, tangent: Tangent, all_has_mass: bool) -> Vec<MethodChoice> {
    let softens = softens(model);
    let first = with(Method::of(step.procedure), tangent);
    let mut choices = vec![first];
    match step.procedure {
        Procedure::Auto => {
            choices.extend(after_statics(tangent, softens, step.drives()));
            choices.extend(inertia(tangent, all_has_mass));
            choices.push(with(Method::Static, tangent));
        }
        Procedure::DisplacementControl => {
            if softens && tangent == Tangent::Secant {
                choices.push(with(first.method, Tangent::Consistent));
            }
            choices.extend(inertia(tangent, all_has_mass));
        }
        _ => {}
    }
    choices
}

/// Whether any solid yields or softens.
fn softens(model: &Model) -> bool {
    model.materials.iter().any(|m| m.parameters.yields())
}

/// Methods of `auto` between statics with these tangents and inertia. `drives`: whether a displacement is driven.
fn after_statics(tangent: Tangent, softens: bool, drives: bool) -> Vec<MethodChoice> {
    let path = with(Method::Dissipation, tangent);
    let mut choices = Vec::new();
    if softens {
        if tangent == Tangent::Secant {
            choices.push(with(Method::Static, Tangent::Consistent));
        }
        choices.push(path);
        if tangent == Tangent::Secant {
            choices.push(with(Method::Dissipation, Tangent::Consistent));
        }
        // Extrapolated solids are linear: their tangent is their secant. Loads would move what has broken without bound.
        if drives {
            choices.push(with(Method::Implex, Tangent::Secant));
        }
    }
    if tangent != Tangent::Direct {
        choices.push(with(Method::Direct, Tangent::Direct));
    }
    if !softens {
        choices.push(path);
    }
    choices
}

/// Inertia with these tangents, if all bodies have mass. Bodies that fly have no stiffness but that of secant tangents.
fn inertia(tangent: Tangent, all_has_mass: bool) -> impl Iterator<Item = MethodChoice> {
    let secant = (tangent == Tangent::Direct).then_some(Tangent::Secant);
    let tangents = std::iter::once(tangent).chain(secant);
    tangents
        .filter(move |_| all_has_mass)
        .map(|tangent| with(Method::QuasiStatic, tangent))
}

/// Whether the tangents of a step may be exchanged: all joints are dry, and it drives or loads. Under a weight that grows
/// from nothing, stones that nothing presses yet have no stiffness without secant tangents.
fn may_exchange(model: &Model, step: &Step) -> bool {
    let contact = &model.contact;
    let dry = !contact.laws.is_empty() && contact.laws.iter().all(JointLaw::is_dry);
    let procedure = step.procedure;
    let seeks = matches!(procedure, Procedure::Auto | Procedure::DisplacementControl);
    let moves = step.drives() || step.control.is_some() || step.only_loads();
    dry && seeks && moves && step.tangent == Tangent::Secant && contact.general.is_none()
}

/// Number of leading choices of the first method.
fn statics(choices: &[MethodChoice]) -> usize {
    let first = choices.iter().take_while(|c| c.method == choices[0].method);
    first.count().max(1)
}

impl Fallback {
    /// Fallback of a step; `all_has_mass` if inertia can act.
    pub fn new(model: &Model, step: &Step, all_has_mass: bool) -> Self {
        let choices = |tangent| choices(model, step, tangent, all_has_mass);
        let (own, others) = (choices(step.tangent), choices(Tangent::Direct));
        Self {
            statics: statics(&own),
            stalls: 0,
            choices: own,
            others: if may_exchange(model, step) {
                others
            } else {
                Vec::new()
            },
            exchange: Exchange::default(),
            at: 0,
            floor: FLOOR * step.increments.initial,
            untroubled: 0,
            patience: PATIENCE,
            paths: Paths {
                rising: RISING,
                on_path: 0,
                lost: 0,
                passed_over: 0,
            },
            left_at: 0.0,
            snaps: false,
            softens: softens(model),
        }
    }

    /// The list of procedures of a resumed step, at the procedure where the checkpoint was written. None if the
    /// procedures of the step are others.
    pub fn of_step(self, model: &Model, step: &Step, all_has_mass: bool) -> Option<Self> {
        let Self {
            choices,
            others,
            floor,
            ..
        } = Self::new(model, step, all_has_mass);
        let same = self.choices == choices && self.others == others;
        let exchanged = self.choices == others && self.others == choices;
        let fits = (same || exchanged)
            && self.at < self.choices.len()
            && self.statics == statics(&self.choices);
        fits.then_some(Self { floor, ..self })
    }

    /// Rescales the fallback for a longer step, of which the present one is `part`.
    pub fn lengthen(&mut self, part: f64) {
        self.floor *= part;
        self.left_at *= part;
    }

    /// Returns from a path to the first method, where the loads reverse: the path does not lead back. True if the
    /// method changed.
    pub fn turn(&mut self) -> bool {
        let leaves = self.at > 0 && self.method().follows_path();
        if leaves {
            (self.at, self.untroubled) = (0, 0);
        }
        leaves
    }

    /// Returns to the first method, where the last one has failed.
    pub fn begin_again(&mut self) {
        (self.at, self.untroubled, self.stalls) = (0, 0, 0);
    }

    /// Starts with inertia, if available, because bodies already move.
    pub fn start_moving(&mut self) {
        self.at = self.inertia().unwrap_or(0);
    }

    /// The present method.
    pub fn method(&self) -> Method {
        self.choice().method
    }

    /// The present method with its tangents.
    pub fn choice(&self) -> MethodChoice {
        self.choices[self.at]
    }

    /// Whether only the last choice of `auto` is left.
    pub fn is_last(&self) -> bool {
        self.at > 0 && self.at + 1 == self.choices.len()
    }

    /// Whether statics is still in use and solids may snap.
    pub fn may_snap(&self) -> bool {
        self.at < self.statics && self.softens
    }

    /// Whether statics is in use and would be left for a body that comes loose in an increment of this size.
    pub fn would_move(&self, size: f64) -> bool {
        self.at < self.statics && (self.inertia().is_some() || self.is_small(size))
    }

    /// Increment size below which errors are reported but no longer reduced.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// Answer to the rejection of an increment of this size. `least`: see [`Least`]; `spent`: its path cannot be cut
    /// further.
    pub fn rejected(
        &mut self,
        rejection: &Rejection,
        size: f64,
        least: Least,
        spent: bool,
    ) -> Answer {
        let higher = self.at + 1 < self.choices.len();
        let comes_free = matches!(rejection, Rejection::Linear { dof: Some(_), .. });
        // A path begins at the peak.
        let is_resolved = *rejection != Rejection::Snap || size <= least.before_motion;
        let would_move = comes_free && self.at < self.statics && self.inertia().is_some();
        let enough = match self.method() {
            _ if spent => true,
            Method::Static | Method::DisplacementControl if would_move => {
                size <= least.before_motion
            }
            Method::Static | Method::DisplacementControl if self.at + 1 < self.statics => {
                self.stalls += 1;
                is_resolved && (self.stalls >= STALLS || size <= least.of_statics)
            }
            Method::Static => is_resolved && size <= least.of_statics,
            Method::DisplacementControl => size <= least.of_statics && self.inertia().is_some(),
            Method::Implex | Method::Direct => size <= SECOND_FLOOR * self.floor,
            _ => false,
        };
        match (enough, higher) {
            (true, true) => Answer::NextMethod,
            (true, false) if spent => Answer::GiveUp,
            _ => Answer::Cut,
        }
    }

    /// Whether the path is left after this increment, wherever it leads.
    pub fn ends_path(&self) -> bool {
        self.method().follows_path() && self.paths.on_path >= LONGEST_PATH
    }

    /// Whether a smaller increment is not worth an attempt.
    pub fn is_small(&self, size: f64) -> bool {
        size <= self.floor
    }

    /// Whether a snap should be followed along its path instead of jumped over.
    pub fn prefers_paths(&self) -> bool {
        self.at < self.statics && self.place(Method::Dissipation).is_some()
    }

    /// Leaves a path on which the loads have fallen far below those at which it began, for inertia: loads that stay
    /// would have let the structure fall there. True if the method changed.
    pub fn leaves_path(&mut self, load: f64) -> bool {
        if !self.method().follows_path() || load >= FALLEN * self.left_at {
            return false;
        }
        let Some(at) = self.inertia() else {
            return false;
        };
        (self.at, self.untroubled) = (at, 0);
        true
    }

    /// Changes to the next method, at part `load` of the loads. A free body needs inertia.
    pub fn take_next(&mut self, rejection: &Rejection, load: f64) {
        self.stalls = 0;
        if self.at < self.statics {
            self.left_at = load;
            self.snaps = *rejection == Rejection::Snap;
        }
        let wanted = match rejection {
            Rejection::Linear { dof: Some(_), .. } => self.inertia(),
            // If secant tangents failed before, take the path with consistent ones.
            Rejection::Snap => self
                .place(Method::Dissipation)
                .map(|path| path + usize::from(self.at > 0)),
            _ => None,
        };
        if self.method() == Method::Dissipation {
            let again = self
                .choices
                .get(self.at + 1)
                .is_some_and(|choice| choice.method == Method::Dissipation);
            // No path leads to equilibrium once a body is without support.
            let comes_loose = wanted.is_some() && *rejection != Rejection::Snap;
            if self.snaps && !comes_loose {
                // If no tangent works along the path, accept the equilibrium that statics found beyond the snap.
                self.at = if again {
                    self.at + 1
                } else {
                    self.choices.len() - 1
                };
                self.untroubled = 0;
                return;
            }
            self.paths.passed_over = 2 << self.paths.lost.min(MOST_LOST);
            self.paths.lost += 1;
        }
        let last = self.choices.len() - 1;
        let mut next = (self.at + 1).min(last);
        if self.choices[next].method == Method::Dissipation
            && wanted.is_none()
            && self.paths.passed_over > 0
        {
            self.paths.passed_over -= 1;
            next += 1;
        }
        // A path with consistent tangents is for snaps only: otherwise extrapolation is cheaper.
        while self.choices[next].method == Method::Dissipation
            && self.choices[next - 1].method == Method::Dissipation
        {
            next += 1;
        }
        self.at = wanted.map_or(next, |choice| choice.max(next));
        self.untroubled = 0;
    }

    /// Counts an increment of so many solves that advances by this part of the step.
    pub fn count(&mut self, solves: usize, advance: f64) {
        self.exchange.count(solves, advance);
    }

    /// Exchanges the tangents if they may be and others seem to advance further; true if it does.
    pub fn exchange(&mut self) -> bool {
        let moving = self.method() == Method::QuasiStatic;
        let may = self.at < self.statics || moving;
        if self.others.is_empty() || !may || !self.exchange.is_due() {
            return false;
        }
        std::mem::swap(&mut self.choices, &mut self.others);
        self.statics = statics(&self.choices);
        self.at = if moving {
            self.inertia().unwrap_or(0)
        } else {
            0
        };
        (self.stalls, self.untroubled) = (0, 0);
        true
    }

    /// Index of the choice with inertia.
    fn inertia(&self) -> Option<usize> {
        self.place(Method::QuasiStatic)
    }

    /// Index of the first choice with a method.
    fn place(&self, method: Method) -> Option<usize> {
        self.choices
            .iter()
            .position(|choice| choice.method == method)
    }

    /// Returns to the first method if the increment shows that the trouble has passed; true if it does. `moves`:
    /// bodies still move; `added`: part of the load that the increment added; `load`: present part of the load.
    pub fn take_first_again(&mut self, report: Report, moves: bool, added: f64, load: f64) -> bool {
        self.stalls = 0;
        let on_path = self.method().follows_path();
        self.paths.on_path = if on_path { self.paths.on_path + 1 } else { 0 };
        if self.at == 0 {
            return false;
        }
        let (passed, needed) = match self.method() {
            Method::Implex => (report.extrapolation_error <= IMBALANCE, 1),
            Method::QuasiStatic => (!moves, self.patience),
            Method::Direct => (true, self.patience),
            Method::Static | Method::DisplacementControl => {
                (report.iterations <= EASY, self.patience)
            }
            _ => (added > 0.0 && load >= self.left_at, self.paths.rising),
        };
        self.untroubled = if passed { self.untroubled + 1 } else { 0 };
        if self.paths.on_path > LONGEST_PATH {
            self.paths.lost = MOST_LOST;
            self.paths.passed_over = 2 << MOST_LOST;
            (self.at, self.untroubled, self.paths.on_path) = (0, 0, 0);
            return true;
        }
        if self.untroubled < needed {
            return false;
        }
        match self.method() {
            Method::QuasiStatic | Method::Direct | Method::Static | Method::DisplacementControl => {
                self.patience *= 2;
            }
            Method::Dissipation => self.paths.rising *= 2,
            _ => {}
        }
        (self.at, self.untroubled) = (0, 0);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::Deck;

    /// A block on the ground, pushed sideways, with this interface.
    fn block(interface: &str) -> Model {
        let text = format!(
            "format = 1\nmaterials.stone = {{ E = \"5 GPa\", nu = 0.2, density = \"2000 kg/m^3\" }}\n\
             [interfaces.joint]\n{interface}\n[[blocks]]\nname = \"ground\"\nsize = [400, 400, 100]\nmaterial = \
             \"stone\"\n[[blocks]]\nname = \"block\"\nsize = [400, 400, 100]\nat = [0, 0, 100]\nmaterial = \
             \"stone\"\n[[contacts]]\nslave = \"block.bottom\"\nmaster = \"ground.top\"\ninterface = \"joint\"\n\
             [[supports]]\non = \"ground\"\n[[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"load\"\n\
             [[steps.loads]]\nname = \"F\"\non = \"block\"\nforce = [100, 0, 0]\n"
        );
        let deck = Deck::from_str(&text, "block.toml").unwrap();
        Model::from_deck(&deck).unwrap().0
    }

    const DRY: &str = "f_t = 0\nc = 0\ntan_phi = 0.5\nmu = 0.5";
    const BONDED: &str =
        "f_t = 0.2\nc = 0.3\ntan_phi = 0.5\nmu = 0.5\nzeta = 4\nxi = 1\nG_I = 0.01\nG_II = 0.02";

    /// Counts increments of many solves and little advance, more than any budget.
    fn labour(fallback: &mut Fallback) -> bool {
        (0..100).any(|_| {
            fallback.count(100, 1e-6);
            fallback.exchange()
        })
    }

    #[test]
    fn dry_joints_exchange_tangents() {
        let model = block(DRY);
        let mut fallback = Fallback::new(&model, &model.steps[1], true);
        let of = |tangent| with(Method::Static, tangent);
        assert_eq!(fallback.choice(), of(Tangent::Secant));
        assert!(labour(&mut fallback));
        assert_eq!(fallback.choice(), of(Tangent::Direct));
        // A resumed step goes on as it was.
        let resumed = fallback.clone().of_step(&model, &model.steps[1], true);
        assert_eq!(resumed.map(|f| f.choice()), Some(of(Tangent::Direct)));
        // Bodies that move go on to do so.
        fallback.start_moving();
        assert!(labour(&mut fallback));
        let moves = with(Method::QuasiStatic, Tangent::Secant);
        assert_eq!(fallback.choice(), moves);
    }

    #[test]
    fn other_steps_keep_their_tangents() {
        // A weight that grows from nothing, and joints with a bond.
        let (dry, bonded) = (block(DRY), block(BONDED));
        for (model, step) in [(&dry, 0), (&bonded, 1)] {
            let mut fallback = Fallback::new(model, &model.steps[step], true);
            assert!(!labour(&mut fallback));
        }
    }
}
