//! The unit of a wall that stands for all of them in its joints.

use crate::deck::quantity::Quantity;
use crate::deck::schema::{Bond, DeckCourse, DeckLeaf, Wall};
use std::collections::BTreeMap;

/// Mean sizes of the units of a wall, and the material that most of them have.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Typical {
    /// Size along the wall [mm].
    pub(super) along: f64,
    /// Size through the wall [mm].
    pub(super) through: f64,
    /// Height [mm].
    pub(super) height: f64,
    /// Name of the material.
    pub(super) material: String,
    /// Part of the volume of the units that has this material [-].
    pub(super) share: f64,
}

impl Typical {
    /// The typical unit of a wall far from its ends.
    pub(super) fn of(wall: &Wall) -> Self {
        let [length, width, height] = wall.unit.map(Quantity::get);
        let [along, through] = match wall.bond {
            Bond::Header => [width, length],
            // Half of them are headers.
            Bond::English | Bond::EnglishCross | Bond::Flemish => [0.5 * (length + width), width],
            Bond::Stretcher | Bond::Stack | Bond::Pattern => [length, width],
        };
        let own = Self {
            along,
            through,
            height,
            material: wall.unit_material.clone(),
            share: 1.0,
        };
        if wall.bond == Bond::Pattern {
            own.in_pattern(wall)
        } else {
            own
        }
    }

    /// Means over the courses of a pattern, of which the later ones may not be reached; `self`: what they do not say.
    fn in_pattern(self, wall: &Wall) -> Self {
        let count = wall.pattern.len().min(wall.courses as usize);
        let leaves = |course: &DeckCourse| course.leaves.len() as f64;
        let mut sums = [0.0; 4];
        let mut volumes: BTreeMap<&str, f64> = BTreeMap::new();
        for (k, course) in wall.pattern.iter().take(count).enumerate() {
            // Of six courses in a pattern of four, the first two are there twice.
            let times = f64::from(
                (wall.courses + wall.pattern.len() as u32 - 1 - k as u32)
                    / wall.pattern.len() as u32,
            );
            let height = course.height.map_or(self.height, Quantity::get);
            sums[0] += times;
            sums[1] += times * height;
            for leaf in &course.leaves {
                let (along, thick) = self.of_leaf(leaf);
                sums[2] += times * along / leaves(course);
                sums[3] += times * thick / leaves(course);
                let material = leaf.material.as_deref().unwrap_or(&self.material);
                *volumes.entry(material).or_default() += times * height * thick;
            }
        }
        let whole: f64 = volumes.values().sum();
        let most = volumes.iter().max_by(|a, b| a.1.total_cmp(b.1));
        let Some((material, volume)) = most.filter(|_| sums[0] > 0.0) else {
            return self; // rejected when the deck was read
        };
        Self {
            along: sums[2] / sums[0],
            through: sums[3] / sums[0],
            height: sums[1] / sums[0],
            material: (*material).to_owned(),
            share: volume / whole,
        }
    }

    /// Mean length of the units of a leaf, and its thickness [mm].
    fn of_leaf(&self, leaf: &DeckLeaf) -> (f64, f64) {
        let lengths: f64 = leaf.units.iter().map(|unit| unit.get()).sum();
        let along = lengths / leaf.units.len().max(1) as f64;
        (along, leaf.thickness.map_or(self.through, Quantity::get))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(keys: &str) -> Wall {
        let text = format!(
            "unit = [215, 102.5, 65]\nbed_joint = 10\nhead_joint = 10\nlength = 890\ncourses = 6\nunit_material = \"b\"\n\
             mortar_material = \"m\"\ninterface = \"j\"\n{keys}"
        );
        toml::from_str(&text).unwrap()
    }

    #[test]
    fn headers_are_as_long_as_units_are_thick() {
        let header = Typical::of(&wall("bond = \"header\""));
        assert_eq!([header.along, header.through], [102.5, 215.0]);
    }

    #[test]
    fn a_pattern_has_the_mean_of_its_courses_and_the_material_of_most() {
        let found = Typical::of(&wall(
            "bond = \"pattern\"\npattern = [{ height = 290, leaves = [{ units = [400, 200] }] }, \
             { height = 90, leaves = [{ units = [200], material = \"s\" }] }]",
        ));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b, "{a} {b}"); // some roundings
        near(found.height, 190.0);
        near(found.along, 250.0);
        near(found.through, 102.5);
        assert_eq!(found.material, "b");
        near(found.share, 290.0 / 380.0);
    }
}
