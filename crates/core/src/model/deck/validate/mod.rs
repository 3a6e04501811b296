//! Ranges of a deck, and what its keys demand of each other. Every error is found, not the first.

mod blocks;
mod interfaces;
mod loads;
mod materials;
mod probes;
mod references;
mod steps;

use super::form::Broken;
use super::{Deck, Wall};
use crate::error::ModelError;
use crate::model::layout;
use crate::model::quantity::{Number, Quantity};
pub(in crate::model) use loads::misfit;

/// Errors found so far.
struct Checks<'a> {
    deck: &'a Deck,
    broken: &'a Broken,
    errors: Vec<ModelError>,
}

/// Checks all that needs no mesh: values out of range, contradictions, names of nothing. What rests on
/// something `broken` is let be.
pub(super) fn validate(deck: &Deck, broken: &Broken) -> Vec<ModelError> {
    let mut checks = Checks {
        deck,
        broken,
        errors: Vec::new(),
    };
    checks.demand(
        deck.format == 1,
        "format",
        || format!("format {} is not known", deck.format),
        "this version reads format = 1",
    );
    for (name, material) in &deck.materials {
        checks.material(&format!("materials.{name}"), material);
    }
    for (name, interface) in &deck.interfaces {
        checks.interface(&format!("interfaces.{name}"), interface);
    }
    if let Some(wall) = &deck.wall {
        checks.wall(wall);
    }
    checks.scene();
    checks.probes();
    checks.loads();
    for (i, step) in deck.steps.iter().enumerate() {
        checks.step(&format!("steps.{i}"), step);
    }
    checks.require(
        deck.output.every > 0,
        "output.every",
        || "a frame every 0 increments means nothing".to_owned(),
        "1 writes every increment",
    );
    checks.require(
        deck.output.scene_every > 0,
        "output.scene_every",
        || "a scene every 0 frames means nothing".to_owned(),
        "1 shows every frame; mcap = false writes no run.mcap at all",
    );
    if let Some(radius) = deck.contact.search_radius {
        checks.positive("contact.search_radius", radius);
    }
    checks.references();
    checks.errors
}

impl Checks<'_> {
    /// What the key at `path` and others of its section must be to each other.
    fn require(&mut self, ok: bool, path: &str, message: impl FnOnce() -> String, help: &str) {
        if !self.broken.section(path) {
            self.demand(ok, path, message, help);
        }
    }

    /// What the value at `path` must be by itself.
    fn demand(&mut self, ok: bool, path: &str, message: impl FnOnce() -> String, help: &str) {
        if !ok && !self.broken.holds(path) {
            self.errors.push(self.deck.error(path, message(), help));
        }
    }

    fn positive<const L: i8, const M: i8, const T: i8, const A: i8>(
        &mut self,
        path: &str,
        value: Quantity<L, M, T, A>,
    ) {
        let value = value.get();
        self.demand(
            value > 0.0,
            path,
            || format!("{value} is not positive"),
            "give a value above 0",
        );
    }

    fn not_negative<const L: i8, const M: i8, const T: i8, const A: i8>(
        &mut self,
        path: &str,
        value: Quantity<L, M, T, A>,
    ) {
        let value = value.get();
        self.demand(
            value >= 0.0,
            path,
            || format!("{value} is negative"),
            "give 0 or more",
        );
    }

    fn within(&mut self, path: &str, value: Number, range: std::ops::RangeInclusive<f64>) {
        let value = value.get();
        let (low, high) = (*range.start(), *range.end());
        self.demand(
            range.contains(&value),
            path,
            || format!("{value} is not between {low} and {high}"),
            &format!("give a value from {low} to {high}"),
        );
    }

    fn wall(&mut self, wall: &Wall) {
        for (i, size) in wall.unit.into_iter().enumerate() {
            self.positive(&format!("wall.unit.{i}"), size);
        }
        self.positive("wall.bed_joint", wall.bed_joint);
        self.positive("wall.head_joint", wall.head_joint);
        self.positive("wall.length", wall.length);
        self.demand(
            wall.courses > 0,
            "wall.courses",
            || "a wall has at least one course".to_owned(),
            "courses = 18",
        );
        let m = wall.mesh;
        self.require(
            m.length >= 2 && m.height >= 2 && m.thickness >= 1,
            "wall.mesh",
            || {
                let [l, h, t] = [m.length, m.height, m.thickness];
                format!("the subdivision [{l}, {h}, {t}] leaves no element for the unit")
            },
            "length and height count one joint element each: at least [2, 2, 1]; the paper's coarse \
             mesh is [5, 2, 2]",
        );
        let (bottom, top) = (wall.clamped.bottom_courses, wall.clamped.top_courses);
        let courses = wall.courses;
        if courses > 0 {
            // Held and driven nodes must differ: neither may be all of them, nor both overlap.
            let apart = u64::from(bottom) + u64::from(top) <= u64::from(courses);
            self.require(
                apart && bottom < courses && top < courses,
                "wall.clamped",
                || format!("{bottom} courses held and {top} driven are too many of {courses}"),
                "clamp fewer courses; 0 holds only the face",
            );
        }
        self.known_material("wall.unit_material", &wall.unit_material);
        self.known_material("wall.mortar_material", &wall.mortar_material);
        self.known_interface("wall.interface", &wall.interface);
        let sizes = [
            wall.bed_joint,
            wall.head_joint,
            wall.length,
            wall.unit[0],
            wall.unit[2],
        ];
        if sizes.iter().all(|s| s.get() > 0.0)
            && self.proportions(wall)
            && let Err(refusal) = layout::course_pattern(wall)
        {
            self.require(false, refusal.key, || refusal.message, &refusal.help);
        }
    }

    /// Refuses sizes of which no sound element can be made; false if it did. The key is that of the
    /// size farthest from the others.
    fn proportions(&mut self, wall: &Wall) -> bool {
        let mut sizes = [
            ("wall.unit.0", wall.unit[0].get()),
            ("wall.unit.1", wall.unit[1].get()),
            ("wall.unit.2", wall.unit[2].get()),
            ("wall.bed_joint", wall.bed_joint.get()),
            ("wall.head_joint", wall.head_joint.get()),
        ];
        sizes.sort_by(|a, b| a.1.total_cmp(&b.1));
        let [smallest, _, middle, _, largest] = sizes;
        // Divided one by one: the ratio of all may overflow.
        let (below, above) = (middle.1 / smallest.1, largest.1 / middle.1);
        let fine = below <= MOST_SLENDER && above <= MOST_SLENDER;
        let (path, size) = if below > above { smallest } else { largest };
        self.require(
            fine,
            path,
            || {
                let beside = middle.1;
                format!("{size} mm beside {beside} mm: no sound element can be made of these")
            },
            "see that the unit of length is right: units and joints differ by a factor of 1000 at most",
        );
        fine
    }
}

/// Largest ratio of the sizes of units and joints to the middle one: thin joints of stone blocks
/// reach a hundred.
const MOST_SLENDER: f64 = 1e3;
