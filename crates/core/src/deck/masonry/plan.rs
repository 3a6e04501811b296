//! Walls that meet in plan: corners and T-junctions.
//!
//! ```text
//! even courses          odd courses
//! ┌──────────┐          ┌───────┬┬─┐
//! ├──────┬┬──┤          ├───────┤│ │    where two walls are in the same place, one of them passes
//!        ├┴──┤                  ││ │    through, by turns; the other ends at it with a joint
//!        │   │                  ├┴─┤
//! ```
//!
//! Walls along the axes meet at right angles. Turned walls meet others at any angle (`corner`).

use super::bond::courses;
use super::corner::{Corner, Frame, LEAST_SINE};
use super::course::{Sizes, TOLERANCE};
use super::layout::{Courses, Cut, Refusal};
use crate::deck::quantity::Quantity;
use crate::deck::schema::{Corners, Deck, Wall};

/// Intersections of all walls. `[wall]`
pub(super) struct Plan {
    /// Parts through which other walls pass.
    pub(super) cuts: Vec<Vec<Cut>>,
    /// Walls along the other axis that meet this one.
    pub(super) joined: Vec<Vec<usize>>,
    /// Walls that meet this one, if one of both is turned.
    pub(super) corners: Vec<Vec<Corner>>,
}

/// Finds the intersections of walls.
///
/// # Errors
/// Walls in the same place that cannot pass through each other.
pub(super) fn plan(deck: &Deck) -> Result<Plan, (String, Refusal)> {
    let walls: Vec<Named> = deck.walls().collect();
    let mut plan = Plan {
        cuts: vec![Vec::new(); walls.len()],
        joined: vec![Vec::new(); walls.len()],
        corners: vec![Vec::new(); walls.len()],
    };
    if walls.len() < 2 {
        return Ok(plan);
    }
    let mut outlines = Vec::new();
    for (path, _, wall) in &walls {
        outlines.push(outline(wall).map_err(|refusal| (path.clone(), refusal))?);
    }
    for b in 1..walls.len() {
        for a in 0..b {
            let pair = Pair {
                walls: [&walls[a], &walls[b]],
                indices: [a, b],
            };
            if pair.walls.iter().any(|wall| wall.2.rotate.is_some()) {
                let heights = [a, b].map(|i| outlines[i][2]);
                pair.at_an_angle(&mut plan, heights)?;
            } else {
                pair.along_axes(&mut plan, [&outlines[a], &outlines[b]])?;
            }
        }
    }
    Ok(plan)
}

/// A reason why a wall cannot be built, and the path of the wall.
type Refused = (String, Refusal);

/// Path, name and description of a wall.
type Named<'a> = (String, &'a str, &'a Wall);

/// Two walls that may meet.
struct Pair<'a> {
    walls: [&'a Named<'a>; 2],
    indices: [usize; 2],
}

impl Pair<'_> {
    /// An error of wall `own`, of a key: message and help.
    fn refuse(
        &self,
        own: usize,
        (key, message, help): (&str, String, impl Into<String>),
    ) -> Result<(), Refused> {
        Err((self.walls[own].0.clone(), Refusal::new(key, message, help)))
    }

    /// Adds the intersection of walls along the axes with these bounding boxes.
    ///
    /// # Errors
    /// Walls along the same axis; courses that are not level.
    fn along_axes(&self, plan: &mut Plan, outlines: [&[[f64; 2]; 3]; 2]) -> Result<(), Refused> {
        let [(_, first, wall), (_, second, other)] = self.walls;
        let common = [0, 1, 2].map(|d| {
            let ([low, high], [from, to]) = (outlines[0][d], outlines[1][d]);
            [low.max(from), high.min(to)]
        });
        let tolerance = TOLERANCE * wall.unit[0].get();
        if common.iter().any(|[low, high]| high - low <= tolerance) {
            return Ok(());
        }
        if wall.axes().0 == other.axes().0 {
            return self.refuse(
                1,
                (
                    "at",
                    format!("{first} and {second} run along the same axis and overlap"),
                    "make one wall of them, or move one by `at`",
                ),
            );
        }
        self.require_level()?;
        for own in [0, 1] {
            let wall = self.walls[own].2;
            let d = wall.axes().0;
            let at = wall.at[d].get();
            self.cut(plan, own, common[d].map(|x| x - at), wall.head_joint.get());
            plan.joined[self.indices[own]].push(self.indices[1 - own]);
        }
        Ok(())
    }

    /// Adds the intersection of walls of which one is turned, and which have these ranges of height [mm].
    ///
    /// # Errors
    /// Sharp angles; a wall that ends within the other one; courses that are not level.
    fn at_an_angle(&self, plan: &mut Plan, heights: [[f64; 2]; 2]) -> Result<(), Refused> {
        let [(_, first, wall), (_, second, other)] = self.walls;
        let [a, b] = self.indices;
        let tolerance = TOLERANCE * wall.unit[0].get();
        let [low, high] = [
            heights[0][0].max(heights[1][0]),
            heights[0][1].min(heights[1][1]),
        ];
        let corners = [Corner::of(wall, other, b), Corner::of(other, wall, a)];
        let ([Some(of_first), Some(of_second)], true) = (corners, high - low > tolerance) else {
            return Ok(()); // parallel, one above the other, or not upright
        };
        let corners = [of_first, of_second];
        let meets = |own: usize| {
            let [low, high] = corners[own].range;
            high > FLUSH && low < self.walls[own].2.length.get() - FLUSH
        };
        if !meets(0) || !meets(1) {
            return Ok(());
        }
        if of_first.sine() < LEAST_SINE - TOLERANCE {
            let angle = of_first.sine().asin().to_degrees();
            return self.refuse(
                1,
                (
                    "rotate",
                    format!("{first} and {second} meet at an angle of {angle:.1} degrees"),
                    "at least 30 degrees: smaller angles need units with edges that are too sharp",
                ),
            );
        }
        for own in [0, 1] {
            self.require_whole(own, &corners[own])?;
        }
        self.require_level()?;
        for own in [0, 1] {
            let corner = corners[own];
            let joint = self.walls[own].2.head_joint.get() / corner.sine();
            self.cut(plan, own, corner.range, joint);
            plan.corners[self.indices[own]].push(corner);
        }
        Ok(())
    }

    /// Requires that a wall reaches through the whole thickness of the other one.
    fn require_whole(&self, own: usize, corner: &Corner) -> Result<(), Refused> {
        let (_, name, wall) = self.walls[own];
        let (_, other, _) = self.walls[1 - own];
        let [low, high] = corner.range;
        let length = wall.length.get();
        if low < -FLUSH {
            let at = Frame::of(wall).map_or([0.0; 2], |frame| frame.point(low));
            return self.refuse(own, (
                "at",
                format!("{name} begins within {other}, {:.2} mm behind its outer face", -low),
                format!(
                    "at = [{:.2}, {:.2}, {:.2}] and length = {:.2} let {name} begin at the face of {other}",
                    at[0],
                    at[1],
                    wall.at[2].get(),
                    length - low
                ),
            ));
        }
        if high > length + FLUSH {
            return self.refuse(
                own,
                (
                    "length",
                    format!(
                        "{name} ends within {other}, {:.2} mm before its outer face",
                        high - length
                    ),
                    format!("length = {high:.2} lets {name} end at the face of {other}"),
                ),
            );
        }
        Ok(())
    }

    /// Requires that the courses of both walls are level.
    fn require_level(&self) -> Result<(), Refused> {
        let [(_, first, wall), (_, second, other)] = self.walls;
        let level = wall.at[2].get() == other.at[2].get()
            && wall.unit[2].get() == other.unit[2].get()
            && wall.bed_joint.get() == other.bed_joint.get();
        if !level {
            return self.refuse(
                1,
                (
                    "at",
                    format!("{first} and {second} meet, and their courses are not level"),
                    "give both the same height of units, bed joint and height of `at`",
                ),
            );
        }
        Ok(())
    }

    /// Removes the other wall, in the range `along`, from the courses of wall `own` in which it passes through.
    fn cut(&self, plan: &mut Plan, own: usize, along: [f64; 2], joint: f64) {
        let (_, name, through) = self.walls[1 - own];
        let wall = self.walls[own].2;
        let top = through.courses.min(wall.courses);
        // A wall that ends at the other face but for rounding leaves no sliver there.
        let (length, flush) = (wall.length.get(), flush(wall));
        let ends = |x: f64| {
            let end = if x < 0.5 * length { 0.0 } else { length };
            if (x - end).abs() <= flush { end } else { x }
        };
        let along = along.map(ends);
        let butted = self
            .walls
            .map(|(_, _, wall)| wall.corners == Corners::Butted);
        let courses = match (own, butted) {
            (1, [_, true]) | (0, [true, false]) => Courses::Range(0, top),
            (0, [_, true]) | (1, [true, false]) => return,
            _ => Courses::Every(1 - own as u32, top),
        };
        plan.cuts[self.indices[own]].push(Cut {
            along,
            courses,
            joint: Some(joint),
            filled: false,
            what: format!("the wall {name} that passes through"),
            key: "at".to_owned(),
        });
    }
}

/// Distance by which a wall may miss the face at which it begins or ends [mm]: decks are rounded to 0.01 mm.
const FLUSH: f64 = 0.1;

/// Distance by which ends of units may miss the face of a wall that meets theirs, by rounding of the deck [mm].
pub(super) fn flush(wall: &Wall) -> f64 {
    FLUSH.min(0.01 * wall.unit[0].get())
}

/// Bounding box of a wall before it is turned [mm]. `[xyz][low, high]`
fn outline(wall: &Wall) -> Result<[[f64; 2]; 3], Refusal> {
    let sizes = Sizes::of(wall);
    let rows = courses(wall)?;
    let backs = rows.iter().flatten().map(|row| row.through[1]);
    let back = backs.fold(0.0, f64::max);
    let at = wall.at.map(Quantity::get);
    let rise = sizes.height + sizes.bed;
    let height = f64::from(wall.courses) * rise - sizes.bed;
    let mut outline = [0, 1, 2].map(|d| [at[d], at[d]]);
    outline[wall.axes().0][1] += sizes.length;
    outline[wall.axes().1][1] += back;
    outline[2][1] += height;
    Ok(outline)
}
