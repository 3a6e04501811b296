//! `[[settlements]]`: ground that moves below a wall by a given shape.

use super::Names;
use crate::deck::quantity::{Length, Number};
use crate::model::axis::Axis;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// Nodes that are held, and that a step moves by the shape of a settlement. One of `trough`, `tilt`, `table`.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckSettlement {
    /// Name, used by drives.
    pub name: String,
    /// Blocks or faces that stand on the ground, held in x, y, z.
    pub on: Names,
    /// Axis along which the shape varies.
    #[serde(default)]
    pub along: Axis,
    /// Gaussian trough: 1 in its middle.
    pub trough: Option<DeckTrough>,
    /// Straight line from 0 to 1.
    pub tilt: Option<DeckTilt>,
    /// Straight lines between given values.
    pub table: Option<DeckProfile>,
}

/// A trough exp(−(s − c)² / 2 i²).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckTrough {
    /// Coordinate c of its middle [mm].
    pub centre: Length,
    /// Distance i of its points of inflection from the middle [mm].
    pub inflection: Length,
}

/// A straight line that continues beyond both of its points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckTilt {
    /// Coordinate at which it is 0 [mm].
    pub from: Length,
    /// Coordinate at which it is 1 [mm].
    pub to: Length,
}

/// Values at coordinates, linear between them and constant beyond them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckProfile {
    /// Coordinates, ascending [mm].
    pub at: Vec<Length>,
    /// Part of the displacement there [-].
    pub values: Vec<Number>,
}

impl DeckSettlement {
    /// Part of the displacement at a coordinate along its axis [mm].
    pub fn part(&self, s: f64) -> f64 {
        if let Some(trough) = &self.trough {
            let away = (s - trough.centre.get()) / trough.inflection.get();
            return (-0.5 * away * away).exp();
        }
        if let Some(tilt) = &self.tilt {
            let (from, to) = (tilt.from.get(), tilt.to.get());
            return (s - from) / (to - from);
        }
        self.table.as_ref().map_or(1.0, |table| table.value(s))
    }
}

impl DeckProfile {
    fn value(&self, s: f64) -> f64 {
        let place = |k: usize| self.at.get(k).map_or(0.0, |at| at.get());
        let value = |k: usize| self.values.get(k).map_or(0.0, |value| value.get());
        let above = self.at.partition_point(|at| at.get() <= s);
        if above == 0 {
            return value(0);
        }
        if above == self.at.len() {
            return value(above - 1);
        }
        let (a, b) = (place(above - 1), place(above));
        value(above - 1) + (s - a) / (b - a) * (value(above) - value(above - 1))
    }
}
