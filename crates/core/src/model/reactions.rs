//! Reactions of the supports as columns of the history.

use super::Model;
use super::axis::Axis;
use super::drive::Drive;
use super::scene::{HeldBy, Support};

/// Column of the base shear.
pub const BASE_SHEAR: &str = "base_shear_kN";
/// Most characters of the name of a support in a column; longer ones get a number instead.
const LONGEST: usize = 40;

/// Whether a column is the base shear or a reaction.
pub fn is_column(name: &str) -> bool {
    name == BASE_SHEAR || name.starts_with("reaction-")
}

/// Columns of supports with these names and held axes: base shear, then the reactions along the held axes. None
/// without supports.
pub fn columns<'a>(supports: impl Iterator<Item = (&'a str, [bool; 3])>) -> Vec<String> {
    let mut columns = Vec::new();
    let mut taken: Vec<String> = Vec::new();
    for (i, (name, fixed)) in supports.enumerate() {
        if columns.is_empty() {
            columns.push(BASE_SHEAR.to_owned());
        }
        let mut plain = plain(name);
        if plain.is_empty() || plain.len() > LONGEST || taken.contains(&plain) {
            plain = format!("support-{i}");
        }
        let held = (0..3).filter(|axis| fixed[*axis]);
        columns.extend(held.map(|axis| format!("reaction-{plain}_{}_kN", Axis::NAMES[axis])));
        taken.push(plain);
    }
    columns
}

/// A name with - for every run of other characters than letters, digits and _.
fn plain(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    words.join("-")
}

impl Model {
    /// Supports on the ground, with their indices: those of the deck, without planes of symmetry.
    pub fn supports_on_ground(&self) -> impl Iterator<Item = (usize, &Support)> {
        let all = self.supports.iter().enumerate();
        all.filter(|(_, support)| support.by == HeldBy::Ground)
    }

    /// Values of the columns of the supports from the forces on beams, supports and loads [N]
    /// `[beam, support, load][xyz]` [kN].
    ///
    /// The base shear is what the supports carry horizontally: along the drive, with the sign of its force; without a
    /// drive sideways, the size of their horizontal resultant.
    pub fn reaction_values(&self, reactions: &[[f64; 3]]) -> Vec<f64> {
        let force = |i: usize| {
            reactions
                .get(self.beams.len() + i)
                .copied()
                .unwrap_or_default()
        };
        let supports = || {
            self.supports_on_ground()
                .map(|(i, support)| (support, force(i)))
        };
        if supports().next().is_none() {
            return Vec::new();
        }
        let sum = |axis: usize| supports().map(|(_, force)| force[axis]).sum::<f64>();
        let base_shear = match Drive::of(self).and_then(Drive::sideways) {
            // 0 − x has no negative zero.
            Some([x, y]) => 0.0 - (x * sum(0) + y * sum(1)),
            None => sum(0).hypot(sum(1)),
        };
        let held = supports().flat_map(|(support, force)| {
            let held = (0..3).filter(|axis| support.fixed[*axis]);
            held.map(move |axis| 1e-3 * force[axis])
        });
        std::iter::once(1e-3 * base_shear).chain(held).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_supports_become_names_of_columns() {
        let all = [true; 3];
        let long = "a-rather-long-name-of-a-face, and-another-one.bottom";
        let names = [
            ("base.bottom, side", [false, false, true]),
            (long, all),
            ("base bottom side", all),
        ];
        let columns = columns(names.into_iter());
        assert_eq!(
            columns[..2],
            ["base_shear_kN", "reaction-base-bottom-side_z_kN"]
        );
        assert_eq!(columns[2], "reaction-support-1_x_kN");
        assert_eq!(
            columns[5..],
            ["x", "y", "z"].map(|d| format!("reaction-support-2_{d}_kN"))
        );
        assert!(super::columns(std::iter::empty()).is_empty());
    }

    #[test]
    fn without_a_drive_the_base_shear_is_the_horizontal_resultant() {
        let support = |fixed| Support {
            name: "foot".to_owned(),
            nodes: Vec::new(),
            fixed,
            by: HeldBy::Ground,
        };
        let mut model = Model::empty("");
        assert!(model.reaction_values(&[]).is_empty());
        model.supports = vec![support([true; 3]), support([true, false, false])];
        let values = model.reaction_values(&[[1e3, -4e3, 7e3], [2e3, 0.0, 0.0]]);
        assert_eq!(values, [5.0, 1.0, -4.0, 7.0, 2.0]);
    }
}
