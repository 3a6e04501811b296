//! Axes of coordinates.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Component of a vector along a direction of length 1; along an axis it is that component, unchanged.
pub fn component_along(direction: [f64; 3], of: impl Fn(usize) -> f64) -> f64 {
    let all = direction.iter().enumerate();
    let parts = all.filter(|(_, part)| **part != 0.0);
    let parts = parts.map(|(axis, part)| part * of(axis));
    parts.reduce(|sum, part| sum + part).unwrap_or_default()
}

/// The direction of an axis, 0 to 2.
pub fn along_axis(axis: usize) -> [f64; 3] {
    [0, 1, 2].map(|d| f64::from(u8::from(d == axis)))
}

/// An axis without a sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// x.
    #[default]
    X,
    /// y.
    Y,
    /// z.
    Z,
}

impl Axis {
    /// Names of the axes, by their index.
    pub const NAMES: [&'static str; 3] = ["x", "y", "z"];

    /// 0, 1, 2.
    pub fn index(self) -> usize {
        self as usize
    }
}
