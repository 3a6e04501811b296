//! Rigid bodies of a model with their joints, ties and actions.

use nalgebra::Vector3;

use super::actions::Actions;
use super::bodies::{Bodies, Wrench};
use super::joints::Joint;
use super::program::{Corner, Program, Solution};
use super::rods::Rod;
use super::unknowns::Unknowns;
use super::{LimitError, LimitSettings, Live, Progress};
use crate::model::Model;

/// Part of the largest factor that counts as 0: the programs are solved to 1e-9.
const ROUNDING: f64 = 1e-6;

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
        let mut bodies = Bodies::of(model, &model.steps[live.0])?;
        let mut actions = Actions::of(model, &bodies, live, settings.along)?;
        bodies.reactions.append(&mut actions.springs);
        let joints = Joint::all(model, &bodies, settings.bonded);
        let rods = Rod::all(model, &model.steps[..=live.0], &bodies);
        let crushed = settings.strength.is_some();
        let reduced = (!settings.whole)
            .then(|| Unknowns::symmetric(&bodies, &joints, &rods, &actions, crushed));
        let unknowns = reduced.flatten();
        let unknowns = unknowns.unwrap_or_else(|| Unknowns::all(&bodies, &joints, &rods));
        Ok(Self {
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
