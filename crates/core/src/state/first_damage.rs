//! The increments in which joints first soften and solids first crack or crush.

use serde::{Deserialize, Serialize};

/// Tensile damage above which a point of a solid counts as cracked [-].
pub const CRACKED: f64 = 0.1;
/// Compressive damage above which a point of a solid counts as crushed [-]: a quarter of the stress is lost.
pub const CRUSHED: f64 = 0.25;

/// First damage of a run; `None` for what has not happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FirstDamage {
    /// Damage of a bond above 0. Its place is a contact point, `4 facet + point`.
    pub joint: Option<Onset>,
    /// Tensile damage of a solid above [`CRACKED`]. Its place is an element.
    pub crack: Option<Onset>,
    /// Compressive damage of a solid above [`CRUSHED`]. Its place is an element.
    pub crush: Option<Onset>,
}

/// Increment and place of a first damage: the most damaged point at its end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct Onset {
    /// Increment, from 1.
    pub increment: usize,
    /// Step, from 0.
    pub step: usize,
    /// Displacement of the drive [mm].
    pub displacement_mm: f64,
    /// Force of the drive [kN].
    pub force_kN: f64,
    /// Part of the step's loads and displacements that acts [-].
    pub load_factor: f64,
    /// Index of the contact point, or of the element.
    pub place: u32,
}

impl FirstDamage {
    /// Whether nothing more can be noted.
    pub fn is_complete(&self) -> bool {
        self.joint.is_some() && self.crack.is_some() && self.crush.is_some()
    }
}
