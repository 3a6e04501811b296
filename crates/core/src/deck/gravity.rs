//! Gravity in each step of a deck.

use super::quantity::{GRAVITY, Quantity};
use super::schema::{Deck, DeckStep, StepKind};
use crate::error::{ErrorKind, ModelError};
use crate::model::scene::{Gravity, turned};

/// State of gravity after the steps so far.
pub(super) struct GravityNow {
    /// Magnitude [mm/s²]; 0 before gravity acts.
    magnitude: f64,
    /// Unit vector of the axis about which the ground is tilted.
    axis: [f64; 3],
    /// Inclination of the ground [rad].
    angle: f64,
}

impl GravityNow {
    pub(super) fn none() -> Self {
        Self {
            magnitude: 0.0,
            axis: [0.0, 1.0, 0.0],
            angle: 0.0,
        }
    }

    /// Gravity vector in the frame of the ground [mm/s²]: if the ground is turned by the angle, gravity is turned
    /// back by it.
    fn vector(&self) -> [f64; 3] {
        let down = [0.0, 0.0, -self.magnitude];
        if self.angle == 0.0 {
            down
        } else {
            turned(down, self.axis, -self.angle)
        }
    }

    /// Gravity during step `index`; updates the state.
    ///
    /// # Errors
    /// Gravity that is applied twice, a tilt without gravity, a tilt about a second axis.
    pub(super) fn step(
        &mut self,
        deck: &Deck,
        index: usize,
        step: &DeckStep,
    ) -> Result<Gravity, ModelError> {
        let path = |key: &str| format!("steps.{index}.{key}");
        let said = step.gravity.is_some() || step.angle.is_some() || step.axis.is_some();
        match step.kind {
            StepKind::Gravity if self.magnitude > 0.0 => Err(deck
                .error(
                    &path("kind"),
                    "gravity acts already",
                    "let it grow in one step",
                )
                .of_kind(ErrorKind::Conflict)),
            StepKind::Gravity => {
                self.say(step);
                Ok(Gravity::Growing(self.vector()))
            }
            StepKind::Free if said => {
                self.say(step);
                Ok(Gravity::Constant(self.vector()))
            }
            StepKind::Tilt if self.magnitude == 0.0 => Err(deck
                .error(
                    &path("kind"),
                    "there is no gravity yet that a tilt could turn",
                    "put a step before it: kind = \"gravity\"",
                )
                .of_kind(ErrorKind::Conflict)),
            StepKind::Tilt => {
                let axis = step.axis.map_or(self.axis, unit);
                if self.angle != 0.0 && axis != self.axis {
                    return Err(deck
                        .error(
                            &path("axis"),
                            "the ground is tilted about another axis already",
                            "tilt about one axis; leave out `axis` to go on",
                        )
                        .of_kind(ErrorKind::Conflict));
                }
                let from = self.vector();
                let angle = degrees(step);
                let turn = -(angle - self.angle);
                (self.axis, self.angle) = (axis, angle);
                Ok(Gravity::Turning {
                    from,
                    axis,
                    angle: turn,
                })
            }
            _ if self.magnitude > 0.0 => Ok(Gravity::Constant(self.vector())),
            _ => Ok(Gravity::None),
        }
    }

    /// Takes the values of a step; missing ones keep their value or take the default.
    fn say(&mut self, step: &DeckStep) {
        let usual = if self.magnitude > 0.0 {
            self.magnitude
        } else {
            GRAVITY
        };
        self.magnitude = step.gravity.map_or(usual, Quantity::get);
        self.axis = step.axis.map_or(self.axis, unit);
        if step.angle.is_some() {
            self.angle = degrees(step);
        }
    }
}

/// Angle of a step, converted from degrees [rad].
fn degrees(step: &DeckStep) -> f64 {
    step.angle.map_or(0.0, Quantity::get).to_radians()
}

fn unit(direction: crate::deck::schema::Direction) -> [f64; 3] {
    let (d, sign) = direction.axis();
    let mut axis = [0.0; 3];
    axis[d] = sign;
    axis
}
