//! Walls that a plane of symmetry cuts.
//!
//! ```text
//!  ├────┬──┊─┬────┤      a unit is cut at its middle and held there; a joint is cut at its middle, and opens
//!  ├─┬────┬┊┬────┬┤      against its mirror image; all others are whole or on the other side
//! ```
//!
//! Each layer of bed and head mortar belongs to one unit. The halves of a wall with mortar are therefore not exact
//! mirror images along it: its head joints open at one of their faces, but those in the plane open in their middle. Dry
//! walls are exact mirror images, and all walls through their thickness.

use super::course::TOLERANCE;
use super::layout::{Refusal, Unit};
use super::representative;
use crate::deck::schema::Wall;
use crate::deck::symmetry::Plane;
use crate::element::hexahedron::range;

/// Returns the units of a wall on the modelled side of the planes, and the faces at which planes cut the wall.
///
/// # Errors
/// A wall that lies beyond a plane or is not a mirror image of itself; a plane that would cut elements. The error
/// has the path of the plane.
pub(super) fn cut(
    planes: &[Plane],
    wall: &Wall,
    name: &str,
    clamped: bool,
    mut units: Vec<Unit>,
) -> Result<(Vec<Unit>, [bool; 6]), (String, Refusal)> {
    let mut faces = [false; 6];
    let tolerance = TOLERANCE * wall.unit[0].get();
    for plane in planes {
        let d = plane.axis;
        let ends = units.iter().flat_map(|u| u.own[d]);
        let [nearest, farthest] = range(ends.map(|x| plane.beyond(x)));
        if nearest >= -tolerance {
            return Err(refusal(
                plane,
                "at",
                format!("the wall `{name}` lies beyond the plane {}", plane.called()),
                "keep = \"above\" keeps the other side; leave out walls that lie beyond",
            ));
        }
        if farthest <= tolerance {
            continue; // ends at the plane or before it
        }
        require_fit(plane, wall, name, clamped)?;
        let images = images(plane, name, &units, tolerance)?;
        // Each layer of mortar belongs to the unit below or before it. If the side above the plane is kept, it
        // belongs to the mirror image of that unit. Collar joints belong to the units on both sides.
        let owner = |i: usize| if plane.above { images[i] } else { i };
        let joint = |i: usize| {
            if d == wall.axes().1 {
                2.0 * units[i].joint(d, !plane.above)
            } else {
                units[owner(i)].joint(d, true)
            }
        };
        let joints: Vec<f64> = (0..units.len()).map(joint).collect();
        require_even(plane, wall, name, &units, tolerance)?;
        faces[2 * d + usize::from(!plane.above)] = true;
        let mut joints = joints.into_iter();
        units.retain_mut(|unit| keep(plane, unit, joints.next().unwrap_or(0.0), tolerance));
    }
    Ok((units, faces))
}

/// An error about a plane, with its path.
fn refusal(plane: &Plane, key: &str, message: String, help: &str) -> (String, Refusal) {
    let refusal = Refusal::new(key, message, help);
    (plane.path.clone(), refusal)
}

/// Rejects planes that cannot cut a wall of this kind.
fn require_fit(
    plane: &Plane,
    wall: &Wall,
    name: &str,
    clamped: bool,
) -> Result<(), (String, Refusal)> {
    if plane.axis == wall.axes().1 && wall.head_filling.get() < 1.0 {
        return Err(refusal(
            plane,
            "normal",
            format!("a plane through the thickness would cut the strips of mortar of `{name}`"),
            "head_filling = 1, or model the whole thickness",
        ));
    }
    if plane.axis == 2 && clamped {
        return Err(refusal(
            plane,
            "normal",
            format!("a level plane leaves `{name}` without its top or its foot"),
            "clamped = false; supports and steps name the sides that are left",
        ));
    }
    Ok(())
}

/// Rejects a plane that would cut an element.
fn require_even(
    plane: &Plane,
    wall: &Wall,
    name: &str,
    units: &[Unit],
    tolerance: f64,
) -> Result<(), (String, Refusal)> {
    for unit in units {
        let [low, high] = unit.own[plane.axis].map(|x| plane.beyond(x));
        let count = representative::elements(wall, unit)[plane.axis];
        let crosses = low.max(high) > tolerance && low.min(high) < -tolerance;
        if crosses && count % 2 == 1 && !wall.rigid {
            return Err(refusal(
                plane,
                "at",
                format!(
                    "{} would cut an element: the unit {} that it goes through has {count} of them",
                    plane.called(),
                    unit.name(name)
                ),
                "an even number of elements in `mesh` there, such as mesh = [5, 2, 2]: half of them are on either side",
            ));
        }
    }
    Ok(())
}

/// Index of the mirror image of each unit.
///
/// # Errors
/// A unit without a mirror image.
fn images(
    plane: &Plane,
    name: &str,
    units: &[Unit],
    tolerance: f64,
) -> Result<Vec<usize>, (String, Refusal)> {
    let d = plane.axis;
    let near = |a: [f64; 2], b: [f64; 2]| (0..2).all(|s| (a[s] - b[s]).abs() <= 4.0 * tolerance);
    let mut images = Vec::with_capacity(units.len());
    let courses: Vec<&[Unit]> = if d == 2 {
        vec![units] // mirror images are in other courses
    } else {
        units.chunk_by(|a, b| a.course == b.course).collect()
    };
    for course in courses {
        let first = images.len();
        let mut order: Vec<usize> = (0..course.len()).collect();
        order.sort_by(|a, b| course[*a].own[d][0].total_cmp(&course[*b].own[d][0]));
        for unit in course {
            let mut wanted = unit.own;
            wanted[d] = [plane.image(unit.own[d][1]), plane.image(unit.own[d][0])];
            let is = |other: &Unit| {
                (0..3).all(|d| near(other.own[d], wanted[d])) && other.material == unit.material
            };
            // Units that begin where the mirror image would.
            let begins = |i: &usize| course[*i].own[d][0];
            let from = order.partition_point(|i| begins(i) < wanted[d][0] - 4.0 * tolerance);
            let there = order[from..].iter().copied();
            let there = there.take_while(|i| begins(i) <= wanted[d][0] + 4.0 * tolerance);
            let image = there.filter(|i| is(&course[*i])).min();
            let Some(image) = image else {
                let [from, to] = unit.own[d];
                return Err(refusal(
                    plane,
                    "at",
                    format!(
                        "the wall `{name}` is not symmetric about {}: in course {} the unit {} from {from:.2} to \
                         {to:.2} mm has no mirror image",
                        plane.called(),
                        unit.course,
                        unit.name(name)
                    ),
                    "whole units that fill the length make a stretcher bond symmetric about its middle; a wall that \
                     ends at the plane is not cut",
                ));
            };
            images.push(first + image);
        }
    }
    Ok(images)
}

/// Cuts a unit whose joint towards the plane is `joint` mm thick; returns false if no part of it is left.
///
/// Units are mirror images of each other, so that a plane cuts units and joints at their middle.
fn keep(plane: &Plane, unit: &mut Unit, joint: f64, tolerance: f64) -> bool {
    let d = plane.axis;
    // The side towards the plane.
    let side = usize::from(!plane.above);
    let end = plane.beyond(unit.own[d][side]);
    let begin = plane.beyond(unit.own[d][1 - side]);
    if begin >= -tolerance {
        return false;
    }
    if end > tolerance {
        unit.own[d][side] = plane.at;
        unit.all[d][side] = plane.at;
    } else if (2.0 * end + joint).abs() <= 4.0 * tolerance {
        // The unit ends at a joint in the plane and keeps half of it.
        unit.all[d][side] = plane.at;
        if joint <= tolerance {
            unit.own[d][side] = plane.at;
        }
        unit.mirror[d] = true;
    }
    true
}
