//! Walls that a plane of symmetry cuts.
//!
//! ```text
//!  ├────┬──┊─┬────┤      a unit is cut at its middle and held there; a joint is cut at its middle, and opens
//!  ├─┬────┬┊┬────┬┤      against its mirror image; all others are whole or on the other side
//! ```
//!
//! Each layer of mortar belongs to one unit, so that the halves of a wall with mortar are no mirror images to the
//! last detail: its joints open at one of their faces, those in the plane now in their middle. Dry joints are.

use super::course::TOLERANCE;
use super::layout::{Refusal, Unit};
use super::representative;
use crate::deck::schema::Wall;
use crate::deck::symmetry::Plane;
use crate::element::hexahedron::range;

/// What is left of the units of a wall on the side of the planes that is modelled, and at which faces planes cut it.
///
/// # Errors
/// A wall that lies beyond a plane, or that is no mirror image of itself; elements that a plane would cut. Blames
/// the path of the plane.
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
            continue; // it ends at the plane, or before
        }
        require_fit(plane, wall, name, clamped)?;
        let images = images(plane, name, &units, tolerance)?;
        // Each layer of mortar belongs to the unit below it: where what lies above is kept, to the image.
        let owner = |i: usize| if plane.above { images[i] } else { i };
        let joints: Vec<f64> = (0..units.len())
            .map(|i| units[owner(i)].joint(d, true))
            .collect();
        require_even(plane, wall, name, &units, tolerance)?;
        faces[2 * d + usize::from(!plane.above)] = true;
        let mut joints = joints.into_iter();
        units.retain_mut(|unit| keep(plane, unit, joints.next().unwrap_or(0.0), tolerance));
    }
    Ok((units, faces))
}

/// What is wrong with a plane, and where it stands.
fn refusal(plane: &Plane, key: &str, message: String, help: &str) -> (String, Refusal) {
    let refusal = Refusal {
        key: key.to_owned(),
        message,
        help: help.to_owned(),
    };
    (plane.path.clone(), refusal)
}

/// Refuses planes that no wall of this kind can be cut by.
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

/// Refuses a plane that would go through an element.
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

/// The mirror image of each unit.
///
/// # Errors
/// A unit that has none.
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
        vec![units] // images are in other courses
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
            // Those that begin where it would.
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

/// Cuts a unit, of which the joint towards the plane is `joint` mm thick; false if nothing of it is left. Units are
/// mirror images of each other, so that a plane meets them and the joints between them at their middle.
fn keep(plane: &Plane, unit: &mut Unit, joint: f64, tolerance: f64) -> bool {
    let d = plane.axis;
    // The side that looks at the plane.
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
        // It reaches its image, with half the joint.
        unit.all[d][side] = plane.at;
        if joint <= tolerance {
            unit.own[d][side] = plane.at;
        }
        unit.mirror[d] = true;
    }
    true
}
