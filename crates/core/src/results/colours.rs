//! Colours of materials, damage and joints: one table for pictures, report, animations and `run.mcap`.
//!
//! `docs/reference/joint-states.json` has the same colours of the states for ParaView.

use serde::Serialize;

use crate::state::InterfaceState;

/// Red, green, blue.
pub type Rgb = [u8; 3];

/// Sound materials by index, repeated if there are more materials.
pub const MATERIALS: [Rgb; 8] = [
    [214, 160, 130],
    [226, 222, 212],
    [190, 180, 150],
    [170, 190, 200],
    [159, 180, 160],
    [201, 167, 184],
    [185, 199, 216],
    [216, 199, 167],
];
/// Tensile damage at thirds of 1; sound elements have the colour of their material.
pub const TENSILE: [Rgb; 3] = [[150, 107, 87], [85, 58, 51], CRACKED];
/// Compressive damage at thirds of 1.
pub const COMPRESSIVE: [Rgb; 3] = [[124, 192, 232], CRUSHED, [12, 21, 80]];
/// Crack width at thirds of the largest.
pub const WIDTH: [Rgb; 3] = [[155, 209, 122], [31, 138, 112], [6, 48, 74]];
/// Fully damaged in tension, and cracks in the solids.
pub const CRACKED: Rgb = [20, 10, 15];
/// Marks of crushed elements.
pub const CRUSHED: Rgb = [31, 95, 208];
/// States of a joint by their number: intact, softening, failed and open, failed and sliding.
pub const STATES: [Rgb; 4] = [
    [185, 178, 168],
    [242, 200, 15],
    [208, 28, 28],
    [232, 126, 0],
];
/// Names of the states by their number.
pub const STATE_NAMES: [&str; 4] = ["intact", "softening", "failed, open", "failed, sliding"];

/// Colour of a sound material.
pub fn material(index: usize) -> Rgb {
    MATERIALS[index % MATERIALS.len()]
}

/// Colour of a state of a joint.
pub fn state(of: InterfaceState) -> Rgb {
    STATES[of as usize]
}

/// Colour of an element with this tensile damage, from that of its material at 0 to [`CRACKED`] at 1.
pub fn damaged(index: usize, damage: f64) -> Rgb {
    mixed(material(index), CRACKED, damage)
}

/// Colour between two, linear in `part` from 0 to 1.
pub fn mixed(from: Rgb, to: Rgb, part: f64) -> Rgb {
    let t = part.clamp(0.0, 1.0);
    std::array::from_fn(|i| {
        let (a, b) = (f64::from(from[i]), f64::from(to[i]));
        (a + t * (b - a)).round() as u8
    })
}

/// `#rrggbb`
pub fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Components from 0 to 1.
pub fn fractions(of: Rgb) -> [f64; 3] {
    of.map(|c| f64::from(c) / 255.0)
}

/// The table for the scripts of the report.
#[derive(Debug, Serialize)]
pub struct Table {
    sound: Vec<String>,
    states: Vec<String>,
    state_names: [&'static str; 4],
    tensile: Vec<String>,
    compressive: Vec<String>,
    crack: Vec<String>,
}

impl Table {
    /// All colours as text.
    pub fn new() -> Self {
        let all = |of: &[Rgb]| of.iter().map(|c| hex(*c)).collect();
        Self {
            sound: all(&MATERIALS),
            states: all(&STATES),
            state_names: STATE_NAMES,
            tensile: all(&TENSILE),
            compressive: all(&COMPRESSIVE),
            crack: all(&WIDTH),
        }
    }
}

impl Default for Table {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damage_goes_from_the_material_to_black() {
        assert_eq!(hex(damaged(0, 0.0)), "#d6a082");
        assert_eq!(damaged(0, 1.0), damaged(1, 2.0));
        assert_eq!(hex(damaged(0, 1.0)), "#140a0f");
        assert_eq!(mixed([0, 10, 20], [10, 0, 20], 0.5), [5, 5, 20]);
    }

    #[test]
    fn no_two_states_look_alike() {
        for (i, a) in STATES.iter().enumerate() {
            for b in &STATES[..i] {
                let off: i32 = (0..3)
                    .map(|k| (i32::from(a[k]) - i32::from(b[k])).abs())
                    .sum();
                // Of 765, a third of the distance from black to one full colour.
                assert!(off > 85, "{a:?} {b:?}");
            }
        }
    }

    /// The look-up table for ParaView has the same colours and names.
    #[test]
    fn the_table_of_paraview_is_this_one() {
        let text = include_str!("../../../../docs/reference/joint-states.json");
        let file: serde_json::Value = serde_json::from_str(text).unwrap();
        let colours = file[0]["IndexedColors"].as_array().unwrap();
        let names = file[0]["Annotations"].as_array().unwrap();
        for (i, state) in STATES.iter().enumerate() {
            for (k, wanted) in fractions(*state).into_iter().enumerate() {
                let found = colours[3 * i + k].as_f64().unwrap();
                assert!((found - wanted).abs() < 5e-4, "{i}: {found}"); // rounded to three decimals
            }
            assert_eq!(names[2 * i], i.to_string());
            assert_eq!(names[2 * i + 1], STATE_NAMES[i]);
        }
    }
}
