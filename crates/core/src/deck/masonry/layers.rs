//! Courses and storeys of a wall, which supports, loads, steps and probes can name.

use super::Masonry;
use super::course::TOLERANCE;
use super::layout::{Refusal, Unit, levels};
use crate::deck::schema::Wall;
use crate::element::hexahedron::Face;

/// A course, or the courses of a storey.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::deck) struct Layer {
    /// Name after that of the wall and a dot: `course-0`, `storey-1`.
    pub(in crate::deck) name: String,
    /// Bodies of the units that begin in it.
    pub(in crate::deck) bodies: Vec<usize>,
    /// Bodies at its outer sides. `[face]`
    pub(in crate::deck) sides: [Vec<usize>; 6],
}

/// First course of each storey of a wall, then the course after the last one; empty without storeys. A storey ends with the
/// course whose top is nearest to its height.
fn storeys(wall: &Wall) -> Vec<usize> {
    if wall.storeys.is_empty() {
        return Vec::new();
    }
    let levels = levels(wall);
    let base = wall.at[2].get();
    let mut height = 0.0;
    let mut ends = vec![0];
    for storey in &wall.storeys {
        height += storey.get();
        let above = levels.partition_point(|level| level.1 - base < height);
        let away = |k: &usize| (levels[*k].1 - base - height).abs();
        let near = above.saturating_sub(1)..(above + 1).min(levels.len());
        let nearest = near.min_by(|a, b| away(a).total_cmp(&away(b)));
        ends.push(nearest.map_or(0, |k| k + 1));
    }
    ends
}

/// Rejects storeys without a course, and storeys above the wall.
///
/// # Errors
/// The first such storey.
pub(super) fn require_storeys(wall: &Wall) -> Result<(), Refusal> {
    let help = "heights from floor to floor, the lowest first; their sum is at most the height of the wall";
    if let Some(storey) = wall.storeys.iter().find(|height| height.get() <= 0.0) {
        let message = format!("a storey of {} mm", storey.get());
        return Err(Refusal::new("storeys", message, help));
    }
    if wall.storeys.len() > usize::from(u16::MAX) || wall.courses == 0 {
        return Err(Refusal::new("storeys", "more storeys than courses", help));
    }
    let ends = storeys(wall);
    if let Some(s) = ends.windows(2).position(|ends| ends[1] <= ends[0]) {
        let message = format!("storey {} has no course", s + 1);
        return Err(Refusal::new("storeys", message, help));
    }
    // The nearest course ends within half a rise; the bed joint above the last one counts for its storey.
    let above = storey_heights(wall).into_iter().find(|[end, asked]| {
        asked - end > 0.5 * (wall.unit[2].get() + wall.bed_joint.get()) + wall.bed_joint.get()
    });
    match above {
        Some([end, asked]) => Err(Refusal::new(
            "storeys",
            format!("a storey ends {asked} mm above the base, and the wall at {end} mm"),
            help,
        )),
        None => Ok(()),
    }
}

/// Numbers of the units that begin and end in each course. `[course]`
struct Ends {
    first: Vec<Vec<usize>>,
    last: Vec<Vec<usize>>,
}

impl Ends {
    fn of(masonry: &Masonry<'_>) -> Self {
        let levels = levels(masonry.wall);
        let tolerance = TOLERANCE * masonry.wall.unit[0].get();
        let none = vec![Vec::new(); levels.len()];
        let (mut first, mut last) = (none.clone(), none);
        for (i, unit) in masonry.units.iter().enumerate() {
            first[usize::from(unit.course)].push(i);
            // Expanded units reach into the joint above, and lintels through several courses.
            let below = levels.partition_point(|level| level.1 <= unit.own[2][1] + tolerance);
            last[below.saturating_sub(1).max(usize::from(unit.course))].push(i);
        }
        Self { first, last }
    }
}

impl Masonry<'_> {
    /// Courses from the lowest one, then storeys.
    pub(in crate::deck) fn layers(&self) -> Vec<Layer> {
        let ends = Ends::of(self);
        let mut layers: Vec<Layer> = (0..ends.first.len())
            .map(|k| self.layer(format!("course-{k}"), &ends, [k, k + 1]))
            .collect();
        for (s, courses) in storeys(self.wall).windows(2).enumerate() {
            let name = format!("storey-{}", s + 1);
            layers.push(self.layer(name, &ends, [courses[0], courses[1]]));
        }
        layers
    }

    /// The courses from the first to before the second.
    fn layer(&self, name: String, ends: &Ends, [from, to]: [usize; 2]) -> Layer {
        let units: Vec<usize> = ends.first[from..to].iter().flatten().copied().collect();
        let sides = Face::ALL.map(|(_, face)| match face.side() {
            (2, true) => ends.last[to - 1].clone(),
            (2, false) => ends.first[from].clone(),
            side => outermost(
                &self.units,
                &units,
                side,
                TOLERANCE * self.wall.unit[0].get(),
            ),
        });
        let body = |i: usize| self.bodies.start + i;
        let mut at = [const { Vec::new() }; 6];
        for ((_, face), units) in Face::ALL.iter().zip(sides) {
            if !self.cut[*face as usize] {
                at[*face as usize] = units.into_iter().map(body).collect();
            }
        }
        Layer {
            name,
            bodies: units.into_iter().map(body).collect(),
            sides: at,
        }
    }
}

/// Those of some units that reach farthest to one side. `side`: axis, and whether it is the high one.
fn outermost(
    all: &[Unit],
    some: &[usize],
    (axis, high): (usize, bool),
    tolerance: f64,
) -> Vec<usize> {
    let sign = if high { 1.0 } else { -1.0 };
    let reach = |i: &usize| sign * all[*i].all[axis][usize::from(high)];
    let most = some.iter().map(reach).fold(f64::NEG_INFINITY, f64::max);
    let on = some.iter().filter(|i| reach(i) >= most - tolerance);
    on.copied().collect()
}

/// Height at which each storey ends [mm], and the height that the deck asks for.
pub(in crate::deck) fn storey_heights(wall: &Wall) -> Vec<[f64; 2]> {
    if wall.storeys.is_empty() {
        return Vec::new();
    }
    let levels = levels(wall);
    let base = wall.at[2].get();
    let mut asked = 0.0;
    let ends = storeys(wall);
    let heights = wall.storeys.iter().zip(ends.iter().skip(1));
    heights
        .map(|(storey, end)| {
            asked += storey.get();
            [levels[end - 1].1 - base, asked]
        })
        .collect()
}
