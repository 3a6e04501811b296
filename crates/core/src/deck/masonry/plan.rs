//! Walls that meet in plan: corners and T-junctions.
//!
//! ```text
//! even courses          odd courses
//! ┌──────────┐          ┌───────┬┬─┐
//! ├──────┬┬──┤          ├───────┤│ │    where two walls are in the same place, one of them passes
//!        ├┴──┤                  ││ │    through, by turns; the other ends at it with a joint
//!        │   │                  ├┴─┤
//! ```

use super::bond::courses;
use super::course::{Sizes, TOLERANCE};
use super::layout::{Courses, Cut, Refusal};
use crate::deck::quantity::Quantity;
use crate::deck::schema::{Deck, Wall};

/// Intersections of all walls. `[wall]`
pub(super) struct Plan {
    /// Parts through which other walls pass.
    pub(super) cuts: Vec<Vec<Cut>>,
    /// Walls that meet this one.
    pub(super) joined: Vec<Vec<usize>>,
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
    };
    if walls.len() < 2 {
        return Ok(plan);
    }
    let mut boxes = Vec::new();
    for (path, _, wall) in &walls {
        boxes.push(outline(wall).map_err(|refusal| (path.clone(), refusal))?);
    }
    for b in 1..walls.len() {
        for a in 0..b {
            // The courses of a turned wall are level with none: others may only touch it.
            if walls[a].2.rotate.is_some() || walls[b].2.rotate.is_some() {
                continue;
            }
            let common = [0, 1, 2].map(|d| {
                let ([low, high], [from, to]) = (boxes[a][d], boxes[b][d]);
                [low.max(from), high.min(to)]
            });
            let tolerance = TOLERANCE * walls[a].2.unit[0].get();
            if common.iter().any(|[low, high]| high - low <= tolerance) {
                continue;
            }
            let refuse = |refusal: Refusal| (walls[b].0.clone(), refusal);
            require_crossing(&walls[a], &walls[b]).map_err(refuse)?;
            for (own, through, parity) in [(a, b, 1), (b, a, 0)] {
                let wall = walls[own].2;
                let d = wall.axes().0;
                let at = wall.at[d].get();
                plan.cuts[own].push(Cut {
                    along: common[d].map(|x| x - at),
                    courses: Courses::Every(parity, walls[through].2.courses.min(wall.courses)),
                    joint: Some(wall.head_joint.get()),
                    filled: false,
                    what: format!("the wall {} that passes through", walls[through].1),
                    key: "at".to_owned(),
                });
                plan.joined[own].push(through);
            }
        }
    }
    Ok(plan)
}

/// Path, name and description of a wall.
type Named<'a> = (String, &'a str, &'a Wall);

/// Requires that two walls in the same place cross, and that their courses are level.
fn require_crossing((_, first, wall): &Named, (_, second, other): &Named) -> Result<(), Refusal> {
    if wall.axes().0 == other.axes().0 {
        return Err(Refusal::new(
            "at",
            format!("{first} and {second} run along the same axis and overlap"),
            "make one wall of them, or move one by `at`",
        ));
    }
    let level = wall.at[2].get() == other.at[2].get()
        && wall.unit[2].get() == other.unit[2].get()
        && wall.bed_joint.get() == other.bed_joint.get();
    if !level {
        return Err(Refusal::new(
            "at",
            format!("{first} and {second} meet, and their courses are not level"),
            "give both the same height of units, bed joint and height of `at`",
        ));
    }
    Ok(())
}

/// Bounding box of a wall [mm]. `[xyz][low, high]`
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
