//! First damage of a run with its places.

use super::place::Place;
use crate::model::Model;
use crate::state;

/// Increments in which damage begins, with names of the model.
pub type FirstDamage = state::FirstDamage<Place>;
/// Begin of damage: its increment, and its most damaged place at the end of that.
pub type Onset = state::Onset<Place>;

/// First damage that the solver noted, with names of the model.
pub fn first_damage(model: &Model, noted: &state::FirstDamage) -> FirstDamage {
    let point = |index| Place::of_point(model, index);
    let element = |index| Place::of_element(model, index);
    FirstDamage {
        joint: noted.joint.and_then(|onset| onset.at(point)),
        crack: noted.crack.and_then(|onset| onset.at(element)),
        crush: noted.crush.and_then(|onset| onset.at(element)),
    }
}
