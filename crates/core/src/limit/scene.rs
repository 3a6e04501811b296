//! Rigid bodies of a model with their joints, ties and actions.

use super::actions::Actions;
use super::bodies::Bodies;
use super::joints::Joint;
use super::program::{Program, Solution};
use super::rods::Rod;
use super::unknowns::Unknowns;
use super::yield_surface::YieldSurface;
use super::{LimitError, LimitSettings, Live};
use crate::model::Model;

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
    /// Whether clarabel solves its programs.
    by_clarabel: bool,
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
        let rods = Rod::all(model, &bodies);
        let crushed = settings.strength.is_some();
        let reduced = (!settings.whole)
            .then(|| Unknowns::symmetric(&bodies, &joints, &rods, &actions, crushed));
        let unknowns = reduced.flatten();
        let unknowns = unknowns.unwrap_or_else(|| Unknowns::all(&bodies, &joints, &rods));
        Ok(Self {
            model,
            bodies,
            joints,
            rods,
            actions,
            unknowns,
            by_clarabel: false,
        })
    }

    /// The same scene with its whole programs, solved by clarabel: of the many solutions of an almost level yield surface
    /// it finds those from which the search without dilatancy settles.
    ///
    /// # Errors
    /// As [`RigidScene::of`].
    pub fn by_clarabel(
        model: &'a Model,
        live: (usize, Live),
        settings: &LimitSettings,
    ) -> Result<Self, LimitError> {
        let whole = LimitSettings {
            whole: true,
            ..*settings
        };
        let scene = Self::of(model, live, &whole)?;
        Ok(Self {
            by_clarabel: true,
            ..scene
        })
    }

    /// Largest factor with a yield surface.
    ///
    /// # Errors
    /// No state carries the dead loads, no factor is too large, the solver fails.
    pub fn solve(
        &self,
        surface: &YieldSurface<'_>,
        settings: &LimitSettings,
    ) -> Result<Solution, LimitError> {
        let program = Program {
            bodies: &self.bodies,
            joints: &self.joints,
            corners: surface.corners(),
            loads: [&self.actions.dead, &self.actions.live],
            strength: settings.strength,
            rods: &self.rods,
            unknowns: &self.unknowns,
            by_clarabel: self.by_clarabel,
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
