//! Axes of coordinates.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
