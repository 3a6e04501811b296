//! Largest widths of cracks and their class of damage.

use serde::{Deserialize, Serialize};

use super::place::Place;
use crate::model::Model;
use crate::results::Snapshot;

/// Widest cracks of a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct CrackWidths {
    /// Number of the frame, from 0.
    pub frame: usize,
    /// Its displacement of the drive [mm]; `None` if the history has no row for it.
    pub displacement_mm: Option<f64>,
    /// Largest opening of a joint; `None` if none is open.
    pub joint: Option<Crack>,
    /// Largest crack in a solid (`crack_width`); `None` if none is cracked.
    pub solid: Option<Crack>,
    /// Class of damage of the wider one.
    pub burland_class: u8,
}

/// A crack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct Crack {
    /// Width [mm].
    pub width_mm: f64,
    /// Where.
    pub place: Place,
}

/// Widths up to which the classes 0 to 4 reach [mm]: table 1 of Burland, Broms and de Mello (1977), *Behaviour of
/// foundations and structures*, Proc. 9th Int. Conf. on Soil Mechanics and Foundation Engineering, Tokyo.
pub const BURLAND: [f64; 5] = [0.1, 1.0, 5.0, 15.0, 25.0];

/// Class of damage of a crack of this width [mm], from 0 (negligible) to 5 (very severe).
pub fn burland_class(width: f64) -> u8 {
    BURLAND.iter().filter(|limit| width > **limit).count() as u8
}

/// Description of a class.
pub fn name_of_class(class: u8) -> &'static str {
    match class {
        0 => "negligible",
        1 => "very slight",
        2 => "slight",
        3 => "moderate",
        4 => "severe",
        _ => "very severe",
    }
}

impl CrackWidths {
    /// Widest cracks of a frame of a model.
    pub fn of(model: &Model, snapshot: &Snapshot) -> Self {
        let crack = |widths: &[f64], place: fn(&Model, usize) -> Option<Place>| {
            let (at, width) = widest(widths)?;
            Some(Crack {
                width_mm: width,
                place: place(model, at)?,
            })
        };
        let joint = crack(&snapshot.frame.interfaces.opening, Place::of_point);
        let solid = crack(&snapshot.frame.crack_width, Place::of_element);
        let width = |crack: &Option<Crack>| crack.as_ref().map_or(0.0, |c| c.width_mm);
        Self {
            frame: snapshot.number,
            displacement_mm: snapshot.row.as_ref().map(|row| row.displacement_mm),
            burland_class: burland_class(width(&joint).max(width(&solid))),
            joint,
            solid,
        }
    }
}

/// Index and value of the largest width above 0, the first of equal ones.
fn widest(widths: &[f64]) -> Option<(usize, f64)> {
    let mut best = None;
    for (i, width) in widths.iter().enumerate() {
        if *width > best.map_or(0.0, |(_, most)| most) {
            best = Some((i, *width));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_those_of_the_table() {
        let widths = [0.0, 0.1, 0.11, 1.0, 4.9, 5.1, 15.1, 25.0, 25.1];
        assert_eq!(widths.map(burland_class), [0, 0, 1, 1, 2, 3, 4, 4, 5]);
        assert_eq!(widest(&[-1.0, 0.0]), None);
        assert_eq!(widest(&[0.1, 0.3, f64::NAN, 0.3]), Some((1, 0.3)));
    }
}
