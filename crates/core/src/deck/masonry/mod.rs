//! Walls: positions and mesh of their units, joints between them, and clamped courses.

mod bond;
mod clamps;
mod corner;
mod course;
mod expand;
mod headers;
mod interlock;
mod joints;
mod layers;
mod layout;
mod lines;
mod openings;
mod placement;
mod plan;
mod representative;
mod snap;
mod symmetry;

pub use bond::courses;
pub use course::{CourseRow, Slot};
pub(super) use layout::levels;
pub use layout::{Half, Kind, Refusal, Unit};

pub(super) use clamps::{level_beam, supports};
pub(super) use corner::Corner;
pub(super) use interlock::least_lap;
pub(super) use joints::joints;
pub(super) use layers::storey_heights;
pub(super) use lines::lines;
pub(super) use representative::append;

use super::amount;
use super::quantity::Quantity;
use super::schema::{Bond, Clamped, Deck, DeckCourse, DeckLeaf, Wall};
use super::symmetry::Plane;
use crate::element::hexahedron::Face;
use interlock::Interlock;
use placement::Placement;
use snap::Snapped;
use std::ops::Range;

/// A wall whose units have been placed.
#[derive(Debug)]
pub(super) struct Masonry<'a> {
    /// Its description in the deck.
    pub(super) wall: &'a Wall,
    /// Path in the deck.
    pub(super) path: String,
    /// Its name.
    pub(super) name: String,
    /// Units, course by course; within a course from front to back and from left to right.
    pub(super) units: Vec<Unit>,
    /// Bodies of these units, in the same order.
    pub(super) bodies: Range<usize>,
    /// Clamped courses.
    pub(super) clamped: Option<Clamped>,
    /// Walls along the other axis that pass through it or through which it passes.
    pub(super) joined: Vec<usize>,
    /// Other such walls, where it or they are turned.
    pub(super) corners: Vec<Corner>,
    /// From where units are laid to where they stand.
    pub(super) placement: Placement,
    /// Sides at which a plane of symmetry cuts it. `[face]`
    pub(super) cut: [bool; 6],
    /// Short pieces that were joined to their neighbours.
    pub(super) snapped: Snapped,
    /// How it is laid where it meets other walls.
    pub(super) interlock: Interlock,
}

/// Places the units of all walls of a deck, which are the first bodies of the scene. An error has the path of its
/// wall.
///
/// # Errors
/// Walls that cannot be built.
pub(super) fn lay_all(deck: &Deck) -> Result<Vec<Masonry<'_>>, (String, Refusal)> {
    for (path, _, wall) in deck.walls() {
        require_sound(wall).map_err(|refusal| (path, refusal))?;
    }
    amount::require_countable(deck)?;
    let plan = plan::plan(deck)?;
    let planes = Plane::all(deck);
    let mut first = 0;
    let mut elements = 0.0;
    let mut walls = Vec::new();
    for (i, (path, name, wall)) in deck.walls().enumerate() {
        let mut snapped = Snapped::new(wall);
        let refused = |refusal| (path.clone(), refusal);
        let spans = openings::spans(wall, &mut snapped).map_err(refused)?;
        let mut cuts = openings::cuts(wall, &spans, &mut snapped);
        cuts.extend(plan.cuts[i].iter().cloned());
        let mut pattern = bond::courses(wall).map_err(refused)?;
        let interlock = Interlock::of(wall, &pattern, &plan.cuts[i]);
        pattern.rotate_left(interlock.first);
        let units = layout::lay(wall, pattern, &cuts, &spans, &mut snapped).map_err(refused)?;
        if !wall.rigid {
            elements += require_countable(wall, &units, elements)
                .map_err(|refusal| (path.clone(), refusal))?;
        }
        let clamped = deck.clamped().filter(|_| i == 0 && deck.wall.is_some());
        let (units, cut) = symmetry::cut(&planes, wall, name, clamped.is_some(), units)?;
        let bodies = first..first + units.len();
        first = bodies.end;
        let corners = plan.corners[i].clone();
        let placement = Placement::new(wall, &corners).map_err(refused)?;
        walls.push(Masonry {
            wall,
            path,
            name: name.to_owned(),
            clamped,
            units,
            bodies,
            joined: plan.joined[i].clone(),
            corners,
            placement,
            cut,
            snapped,
            interlock,
        });
    }
    expand::expand(&mut walls);
    Ok(walls)
}

/// Thickness of a wall [mm].
pub(super) fn thickness(wall: &Wall) -> f64 {
    let collar = wall.collar_joint.unwrap_or(wall.head_joint).get();
    let [length, width, _] = wall.unit.map(Quantity::get);
    match wall.bond {
        Bond::Stretcher | Bond::Stack => f64::from(wall.leaves) * (width + collar) - collar,
        Bond::English | Bond::EnglishCross if wall.leaves > 2 => {
            let whole = f64::from(wall.leaves / 2) * (length + collar) - collar;
            whole + f64::from(wall.leaves % 2) * (width + collar)
        }
        Bond::Header | Bond::English | Bond::EnglishCross | Bond::Flemish => length,
        Bond::Pattern => {
            let of_course = |course: &DeckCourse| {
                let leaves = course.leaves.iter();
                let leaf = |l: &DeckLeaf| l.thickness.map_or(width, Quantity::get) + collar;
                leaves.map(leaf).sum::<f64>() - collar
            };
            wall.pattern.iter().map(of_course).fold(0.0, f64::max)
        }
    }
}

/// Number of elements of the units of a wall; long units have more than the wall's `unit`.
///
/// # Errors
/// Together with the elements `before` they are too many.
fn require_countable(wall: &Wall, units: &[Unit], before: f64) -> Result<f64, Refusal> {
    let of = |unit: &Unit| -> f64 {
        let own = representative::elements(wall, unit);
        let joints = |d: usize| [false, true].map(|high| usize::from(unit.joint(d, high) > 0.0));
        (0..3)
            .map(|d| own[d] as f64 + joints(d).iter().sum::<usize>() as f64)
            .product()
    };
    let elements: f64 = units.iter().map(of).sum();
    if before + elements <= amount::MOST_ELEMENTS {
        return Ok(elements);
    }
    let most = amount::MOST_ELEMENTS;
    Err(Refusal::new(
        "mesh",
        format!(
            "{} units, up to {:.0} elements each, are too many",
            units.len(),
            units.iter().map(of).fold(0.0, f64::max)
        ),
        format!(
            "at most {most:e} elements in all: `mesh` is that of a unit as large as `unit`, and longer ones have more"
        ),
    ))
}

/// Rejects sizes and counts from which no wall can be built, before any unit is placed.
fn require_sound(wall: &Wall) -> Result<(), Refusal> {
    let [length, thickness, height] = wall.unit.map(|size| ("unit", size));
    for (key, size) in [length, thickness, height, ("length", wall.length)] {
        if size.get() <= 0.0 {
            let message = format!("{} mm is not positive", size.get());
            return Err(Refusal::new(key, message, "give a length above 0"));
        }
    }
    let joints = [
        ("bed_joint", Some(wall.bed_joint)),
        ("head_joint", Some(wall.head_joint)),
        ("collar_joint", wall.collar_joint),
    ];
    for (key, size) in joints {
        if let Some(size) = size.filter(|size| size.get() < 0.0) {
            let message = format!("{} mm is negative", size.get());
            return Err(Refusal::new(
                key,
                message,
                "give 0 (units that touch) or more",
            ));
        }
    }
    if u16::try_from(wall.courses).is_err() {
        let message = format!("{} courses are too many", wall.courses);
        return Err(Refusal::new("courses", message, "at most 65535"));
    }
    for (k, course) in wall.pattern.iter().enumerate() {
        require_sound_course(wall, k, course)?;
    }
    course::Sizes::of(wall).require_few()?;
    layers::require_storeys(wall)
}

/// Rejects sizes and counts of course `k` of a pattern.
fn require_sound_course(wall: &Wall, k: usize, course: &DeckCourse) -> Result<(), Refusal> {
    let leaves = course.leaves.iter();
    let sizes = leaves.flat_map(|l| l.units.iter().chain(&l.thickness));
    if sizes.chain(&course.height).any(|size| size.get() <= 0.0) {
        return Err(Refusal::new(
            format!("pattern.{k}"),
            "a size is not positive",
            "heights, thicknesses and units are above 0",
        ));
    }
    for (l, leaf) in course.leaves.iter().enumerate() {
        let offset = leaf.offset.get();
        if offset.abs() > course::MOST_UNITS * wall.unit[0].get() {
            return Err(Refusal::new(
                format!("pattern.{k}.leaves.{l}.offset"),
                format!("the leaf would begin at {offset} mm"),
                "where its first unit begins; below 0 it is cut",
            ));
        }
        let units = amount::units_of(wall, leaf);
        if units > course::MOST_UNITS + leaf.units.len() as f64 {
            return Err(Refusal::new(
                format!("pattern.{k}.leaves.{l}.units"),
                format!("{units} units are too many for a course"),
                "at most 1e4: is the unit of length the one meant?",
            ));
        }
    }
    Ok(())
}

impl Masonry<'_> {
    /// Whether it and the wall of this index meet in plan and interlock, or one ends at the other.
    pub(super) fn meets(&self, other: usize) -> bool {
        let mut corners = self.corners.iter();
        self.joined.contains(&other) || corners.any(|corner| corner.with == other)
    }

    /// Walls that meet it, by their index, and where they stand along it [mm].
    pub(super) fn met(&self, deck: &Deck) -> Vec<(usize, [f64; 2])> {
        let along = self.wall.axes().0;
        let begin = self.wall.at[along].get();
        let walls: Vec<&Wall> = deck.walls().map(|(_, _, wall)| wall).collect();
        let straight = self.joined.iter().filter_map(|other| {
            let wall = walls.get(*other)?;
            let from = wall.at[along].get() - begin;
            Some((*other, [from, from + thickness(wall)]))
        });
        let corners = self
            .corners
            .iter()
            .map(|corner| (corner.with, corner.range));
        straight.chain(corners).collect()
    }

    /// Units whose face lies on that of the whole wall; none where a plane of symmetry cuts it.
    pub(super) fn on(&self, face: Face) -> Vec<usize> {
        if self.cut[face as usize] {
            return Vec::new();
        }
        let (axis, high) = face.side();
        let plane = |unit: &Unit| unit.all[axis][usize::from(high)];
        let planes = self.units.iter().map(plane);
        let outermost = if high {
            planes.fold(f64::NEG_INFINITY, f64::max)
        } else {
            planes.fold(f64::INFINITY, f64::min)
        };
        let tolerance = course::TOLERANCE * self.wall.unit[0].get();
        let on = self.units.iter().zip(self.bodies.clone());
        on.filter(|(unit, _)| (plane(unit) - outermost).abs() <= tolerance)
            .map(|(_, body)| body)
            .collect()
    }

    /// Shortest unit, and least distance between head joints of neighbouring courses [mm]; infinite if there are
    /// none. Small values mean slivers and continuous vertical joints.
    pub(super) fn bat_and_lap(&self) -> (f64, f64) {
        let (along, _) = self.wall.axes();
        let length = |u: &Unit| u.own[along][1] - u.own[along][0];
        let shortest = self.units.iter().map(length).fold(f64::INFINITY, f64::min);
        let mut heads: Vec<Vec<f64>> = vec![Vec::new(); self.wall.courses as usize];
        for unit in &self.units {
            if unit.joint(along, true) > 0.0 {
                let middle = 0.5 * (unit.own[along][1] + unit.all[along][1]);
                heads[usize::from(unit.course)].push(middle);
            }
        }
        // A few courses show the whole bond.
        let pairs = heads.windows(2).take(MOST_COURSES);
        let distances = pairs.flat_map(|pair| {
            let (a, b) = (&pair[0], &pair[1]);
            a.iter()
                .flat_map(move |a| b.iter().map(move |b| (a - b).abs()))
        });
        (shortest, distances.fold(f64::INFINITY, f64::min))
    }
}

/// Number of courses whose head joints are compared.
const MOST_COURSES: usize = 24;
