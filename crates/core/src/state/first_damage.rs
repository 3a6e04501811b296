//! The increments in which joints first soften and solids first crack or crush.

use serde::{Deserialize, Serialize};

/// Tensile damage above which a point of a solid counts as cracked [-].
pub const CRACKED: f64 = 0.1;
/// Compressive damage above which a point of a solid counts as crushed [-]: a quarter of the stress is lost.
pub const CRUSHED: f64 = 0.25;

/// First damage of a run; `None` for what has not happened. The solver knows places by their index.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FirstDamage<P = u32> {
    /// Damage of a bond above 0. Its place is a contact point, `4 facet + point`.
    pub joint: Option<Onset<P>>,
    /// Tensile damage of a solid above [`CRACKED`]. Its place is an element.
    pub crack: Option<Onset<P>>,
    /// Compressive damage of a solid above [`CRUSHED`]. Its place is an element.
    pub crush: Option<Onset<P>>,
}

/// Increment and place of a first damage: the most damaged point at its end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct Onset<P = u32> {
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
    /// Place: the index of the contact point or of the element, or what a reader makes of it.
    pub place: P,
}

impl<P> FirstDamage<P> {
    /// Whether nothing more can be noted.
    pub fn is_complete(&self) -> bool {
        self.joint.is_some() && self.crack.is_some() && self.crush.is_some()
    }
}

impl<P> Default for FirstDamage<P> {
    fn default() -> Self {
        Self {
            joint: None,
            crack: None,
            crush: None,
        }
    }
}

impl Onset {
    /// The same with its place found by its index; `None` if it is not found.
    pub fn at<P>(self, find: impl FnOnce(usize) -> Option<P>) -> Option<Onset<P>> {
        Some(Onset {
            increment: self.increment,
            step: self.step,
            displacement_mm: self.displacement_mm,
            force_kN: self.force_kN,
            load_factor: self.load_factor,
            place: find(self.place as usize)?,
        })
    }
}
