//! Rigid bodies of a model with their joints, ties and actions.

use nalgebra::Vector3;

use super::actions::Actions;
use super::bodies::{Bodies, Wrench};
use super::joints::Joint;
use super::program::{Corner, Program, Solution};
use super::rods::Rod;
use super::scales::ForceScales;
use super::unknowns::Unknowns;
use super::{LimitError, LimitSettings, Live, Progress};
use crate::model::Model;

/// Part of the largest factor that counts as 0: the programs are solved to 1e-9.
const ROUNDING: f64 = 1e-6;

/// Index of a spring or a tie that may carry any force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Holder {
    Spring(usize),
    Tie(usize),
}

impl Holder {
    /// In words.
    fn called(self, model: &Model) -> String {
        match self {
            Self::Spring(s) => format!("the spring `{}`", model.springs[s].name),
            Self::Tie(t) => format!("the tie `{}`", model.ties[t].name),
        }
    }
}

/// A scene of rigid units.
pub struct RigidScene<'a> {
    /// The model.
    pub model: &'a Model,
    /// Rigid bodies.
    pub bodies: Bodies,
    /// Joints between them.
    pub joints: Vec<Joint>,
    /// Segments of ties between them.
    pub rods: Vec<Rod>,
    /// Dead and live actions.
    actions: Actions,
    /// Sizes of the forces.
    pub scales: ForceScales,
    /// Unknowns of the program.
    pub unknowns: Unknowns,
    /// Corners of the joints, joint by joint.
    pub corners: Vec<Corner>,
    /// Whether the live load is a drive, of which the factor is the force [N].
    drives: bool,
}

impl<'a> RigidScene<'a> {
    /// Scene of a model whose step `live.0` is the live one.
    ///
    /// # Errors
    /// Planes of symmetry; a body force without weight.
    pub fn of(
        model: &'a Model,
        live: (usize, Live),
        settings: &LimitSettings,
    ) -> Result<Self, LimitError> {
        Self::with(model, live, settings, &|_| true)
    }

    /// The same with those springs and ties alone that `keeps` takes.
    fn with(
        model: &'a Model,
        live: (usize, Live),
        settings: &LimitSettings,
        keeps: &dyn Fn(Holder) -> bool,
    ) -> Result<Self, LimitError> {
        let mut bodies = Bodies::of(model, &model.steps[live.0])?;
        let mut actions = Actions::of(model, &bodies, live, settings.along)?;
        actions.springs.retain(|(s, _)| keeps(Holder::Spring(*s)));
        let springs = actions.springs.iter().map(|(_, reaction)| reaction.clone());
        bodies.reactions.extend(springs);
        let joints = Joint::all(model, &bodies, settings.bonded);
        let mut rods = Rod::all(model, &model.steps[..=live.0], &bodies);
        rods.retain(|rod| keeps(Holder::Tie(rod.tie)));
        let crushed = settings.strength.is_some();
        let reduced = (!settings.whole)
            .then(|| Unknowns::symmetric(&bodies, &joints, &rods, &actions, crushed));
        let unknowns = reduced.flatten();
        let unknowns = unknowns.unwrap_or_else(|| Unknowns::all(&bodies, &joints, &rods));
        let parts = (&joints[..], &rods[..]);
        let scales = ForceScales::of(&bodies, parts, &unknowns, &actions, settings.strength);
        Ok(Self {
            scales,
            corners: Corner::all(&joints),
            drives: live.1 == Live::Drive,
            model,
            bodies,
            joints,
            rods,
            actions,
            unknowns,
        })
    }

    /// Progress after so many programs, the last of which has this factor.
    pub fn progress(&self, programs: usize, factor: f64) -> Progress {
        Progress {
            programs,
            factor,
            force: self.force(factor),
        }
    }

    /// Force along the drive [kN] for a factor; none if the live load is none.
    pub fn force(&self, factor: f64) -> Option<f64> {
        self.drives.then_some(1e-3 * factor)
    }

    /// Largest factor if the corners may slip by given velocities without opening ([`Program::slips`]).
    ///
    /// # Errors
    /// No state carries the dead loads, no factor is too large, the solver fails.
    pub fn solve(&self, settings: &LimitSettings, slips: &[f64]) -> Result<Solution, LimitError> {
        self.solve_for(&self.actions.live, settings, slips)
    }

    /// Reason why there is no factor. Springs and ties that carry any force are named if the scene without them has no
    /// state that carries every factor.
    pub fn reason(
        &self,
        why: LimitError,
        live: (usize, Live),
        settings: &LimitSettings,
    ) -> LimitError {
        if why == LimitError::Unbounded && self.unknowns.motions.iter().all(Vec::is_empty) {
            return LimitError::AllHeld;
        }
        let holders = self.holders();
        if why != LimitError::Unbounded || holders.is_empty() {
            return why;
        }
        let free = Self::with(self.model, live, settings, &|one| !holders.contains(&one));
        let found = free.and_then(|scene| scene.solve(settings, &[]));
        if let Err(LimitError::Unbounded | LimitError::Solver(_)) = found {
            return why;
        }
        let names = holders.iter().map(|one| one.called(self.model));
        LimitError::Held(names.collect::<Vec<_>>().join(", "))
    }

    /// Springs that no step drives, and ties without a yield stress.
    fn holders(&self) -> Vec<Holder> {
        let springs = self.actions.springs.iter().map(|(s, _)| Holder::Spring(*s));
        let ties = self.rods.iter().filter(|rod| rod.most.is_infinite());
        let mut holders: Vec<Holder> = springs
            .chain(ties.map(|rod| Holder::Tie(rod.tie)))
            .collect();
        holders.dedup();
        holders
    }

    /// Checks that the joints carry the dead loads without the live ones. Factors that are carried form a range; `largest`
    /// is its upper end, and 0 must not lie below its lower one.
    ///
    /// # Errors
    /// [`LimitError::FallsAt`].
    pub fn stands(&self, settings: &LimitSettings, largest: &Solution) -> Result<(), LimitError> {
        let least = -ROUNDING * largest.factor.abs().max(ROUNDING);
        if largest.factor < least {
            return Err(self.falls_at(largest));
        }
        let reversed: Vec<Wrench> = self.actions.live.iter().map(Wrench::reversed).collect();
        match self.solve_for(&reversed, settings, &[]) {
            Ok(lowest) if lowest.factor < least => Err(self.falls_at(&lowest)),
            Err(why @ LimitError::FallsAt(_)) => Err(why),
            // A program without an answer says nothing about factor 0.
            Ok(_) | Err(_) => Ok(()),
        }
    }

    /// The dead loads move the body that is fastest in this mechanism.
    fn falls_at(&self, solution: &Solution) -> LimitError {
        let bodies = solution.mechanism.iter().zip(&self.bodies.all);
        let speed =
            |moved: &[Vector3<f64>; 2]| moved[0].norm() + moved[1].norm() * self.bodies.size;
        let fastest = bodies.max_by(|a, b| speed(a.0).total_cmp(&speed(b.0)));
        let unit = fastest.map_or(0, |(_, body)| body.unit);
        LimitError::FallsAt(self.model.mesh.called(unit))
    }

    /// Largest factor of these live actions.
    fn solve_for(
        &self,
        live: &[Wrench],
        settings: &LimitSettings,
        slips: &[f64],
    ) -> Result<Solution, LimitError> {
        let program = Program {
            bodies: &self.bodies,
            joints: &self.joints,
            corners: &self.corners,
            loads: [&self.actions.dead, live],
            strength: settings.strength,
            rods: &self.rods,
            unknowns: &self.unknowns,
            scales: &self.scales,
            slips,
        };
        program.solve().map_err(|why| match why {
            LimitError::Falls(body) => {
                let unit = self.bodies.all.get(body).map_or(0, |body| body.unit);
                LimitError::FallsAt(self.model.mesh.called(unit))
            }
            other => other,
        })
    }
}
