//! Shares of units and mortar in a wall.

use crate::deck::quantity::Quantity;
use crate::deck::schema::{Bond, Wall};

/// Parts of the volume of a wall that units and mortar take. The rest are head joints without mortar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    /// Part of the units.
    pub(super) units: f64,
    /// Part of the mortar.
    pub(super) mortar: f64,
}

impl Shares {
    /// Shares in a wall far from its ends.
    pub(super) fn of(wall: &Wall) -> Self {
        let height = wall.unit[2].get();
        let bed = wall.bed_joint.get();
        let course = height / (height + bed);
        let [units, heads, collars] = in_plan(wall);
        let filled = wall.head_filling.get() * heads + collars;
        Self {
            units: course * units,
            mortar: course * filled + (1.0 - course),
        }
    }
}

/// Parts of the area of a course that units, head joints and collar joints take.
fn in_plan(wall: &Wall) -> [f64; 3] {
    let [length, width, _] = wall.unit.map(Quantity::get);
    let head = wall.head_joint.get();
    let collar = wall.collar_joint.map_or(head, Quantity::get);
    let leaves = f64::from(wall.leaves);
    // Of walls as thick as a unit is long, the collar joint is the space between two stretchers.
    let between = (length - 2.0 * width).max(0.0);
    let stretchers = |count: f64, between: f64| {
        let behind = (count - 1.0) * between * (length + head);
        parts([count * length * width, count * head * width, behind])
    };
    let headers = parts([width * length, head * length, 0.0]);
    match wall.bond {
        Bond::Header => headers,
        Bond::English | Bond::EnglishCross => {
            let stretchers = stretchers(2.0, between);
            [0, 1, 2].map(|i| 0.5 * (stretchers[i] + headers[i]))
        }
        Bond::Flemish => parts([
            2.0 * length * width + width * length,
            head * (2.0 * width + length),
            between * (length + head),
        ]),
        Bond::Stretcher | Bond::Stack | Bond::Pattern => stretchers(leaves.max(1.0), collar),
    }
}

fn parts(areas: [f64; 3]) -> [f64; 3] {
    let sum: f64 = areas.iter().sum();
    areas.map(|area| area / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(keys: &str) -> Wall {
        let text = format!(
            "unit = [215, 102.5, 65]\nbed_joint = 10\nhead_joint = 10\nlength = 890\ncourses = 12\nunit_material = \"b\"\n\
             mortar_material = \"m\"\ninterface = \"j\"\n{keys}"
        );
        toml::from_str(&text).unwrap()
    }

    #[test]
    fn collar_joints_are_mortar() {
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}"); // some roundings
        let one = Shares::of(&wall(""));
        near(one.units, 215.0 * 65.0 / (225.0 * 75.0));
        near(one.units + one.mortar, 1.0);
        let two = Shares::of(&wall("leaves = 2"));
        near(two.units, one.units * 205.0 / 215.0);
        near(two.units + two.mortar, 1.0);
        // Headers have twice as many head joints.
        let headers = Shares::of(&wall("bond = \"header\""));
        near(headers.units, 102.5 * 65.0 / (112.5 * 75.0));
        let english = Shares::of(&wall("bond = \"english\""));
        near(english.units, 0.5 * (two.units + headers.units));
        let dry_heads = Shares::of(&wall("head_filling = 0"));
        near(dry_heads.units, one.units);
        near(dry_heads.mortar, 10.0 / 75.0);
    }
}
