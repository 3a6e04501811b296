//! First damage of a run with its places.

use serde::{Deserialize, Serialize};

use super::place::Place;
use crate::model::Model;
use crate::state;

/// Increments in which damage begins; `None` for what has not happened.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FirstDamage {
    /// A bond softens: damage of a joint that had strength above 0.
    pub joint: Option<Onset>,
    /// A solid cracks: tensile damage above 0.1.
    pub crack: Option<Onset>,
    /// A solid is crushed: compressive damage above 0.25.
    pub crush: Option<Onset>,
}

/// Begin of damage: its increment, and its most damaged place at the end of that.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Where.
    pub place: Place,
}

impl FirstDamage {
    /// First damage that the solver noted, with names of the model.
    pub fn of(model: &Model, noted: &state::FirstDamage) -> Self {
        let told = |onset: Option<state::Onset>, place: fn(&Model, usize) -> Option<Place>| {
            let onset = onset?;
            Some(Onset {
                increment: onset.increment,
                step: onset.step,
                displacement_mm: onset.displacement_mm,
                force_kN: onset.force_kN,
                load_factor: onset.load_factor,
                place: place(model, onset.place as usize)?,
            })
        };
        Self {
            joint: told(noted.joint, Place::of_point),
            crack: told(noted.crack, Place::of_element),
            crush: told(noted.crush, Place::of_element),
        }
    }
}
