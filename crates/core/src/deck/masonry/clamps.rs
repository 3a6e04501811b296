//! Parts of a wall that the steel beams of a test hold: its lowest courses, and its top, tied to the level beam.

use super::layout::Unit;
use super::{Kind, Masonry};
use crate::deck::bodies::Bodies;
use crate::deck::schema::Clamped;
use crate::element::hexahedron::range;
use crate::model::scene::{Beam, HeldBy, Support};

/// Supports at the clamped feet of walls.
pub(in crate::deck) fn supports(bodies: &Bodies<'_>) -> Vec<Support> {
    let clamped = |wall: &Masonry<'_>| {
        let clamped = wall.clamped?;
        let held = |unit: &Unit| match clamped.bottom_courses {
            0 if unit.course == 0 => Some([unit.own[2][0]; 2]),
            n if u32::from(unit.course) < n => Some(unit.own[2]),
            _ => None,
        };
        Some(Support {
            name: "bottom".to_owned(),
            nodes: nodes(bodies, wall, held),
            fixed: [true; 3],
            by: HeldBy::Ground,
        })
    };
    bodies.walls.iter().filter_map(clamped).collect()
}

/// The level beam at the top of the clamped wall.
pub(in crate::deck) fn level_beam(bodies: &Bodies<'_>) -> Option<Beam> {
    let clamped = |wall: &Masonry<'_>| {
        let Clamped { top_courses, .. } = wall.clamped?;
        let courses = wall.wall.courses;
        let tied = |unit: &Unit| {
            let top = u32::from(unit.course) + 1;
            match top_courses {
                0 if top == courses => Some([unit.own[2][1]; 2]),
                n if n > 0 && top + n > courses => Some(unit.own[2]),
                _ => None,
            }
        };
        Some(Beam {
            name: "top".to_owned(),
            nodes: nodes(bodies, wall, tied),
            area: area(wall),
            normal: [0.0, 0.0, 1.0],
            shape: Vec::new(),
            free: Vec::new(),
            depth: 0.0,
        })
    };
    bodies.walls.iter().find_map(clamped)
}

/// Area of the wall in plan, or of the part that planes of symmetry leave [mm²].
fn area(wall: &Masonry<'_>) -> f64 {
    if wall.cut == [false; 6] {
        return wall.wall.length.get() * thickness(wall);
    }
    let extent = |d: usize| {
        let [low, high] = range(wall.units.iter().flat_map(|u| u.all[d]));
        high - low
    };
    extent(0) * extent(1)
}

/// Thickness of a wall [mm].
fn thickness(wall: &Masonry<'_>) -> f64 {
    let (_, through) = wall.wall.axes();
    let front = wall.wall.at[through].get();
    let backs = wall.units.iter().map(|u| u.own[through][1]);
    backs.fold(front, f64::max) - front
}

/// Nodes of the units of a wall whose height is in the range `of(unit)`, if it gives one.
fn nodes(
    bodies: &Bodies<'_>,
    wall: &Masonry<'_>,
    of: impl Fn(&Unit) -> Option<[f64; 2]>,
) -> Vec<u32> {
    let mut nodes = Vec::new();
    for (unit, body) in wall.units.iter().zip(wall.bodies.clone()) {
        let Some([low, high]) = of(unit).filter(|_| matches!(unit.kind, Kind::Unit(_))) else {
            continue;
        };
        let all = bodies.all[body].nodes.clone();
        nodes.extend(all.filter(|n| {
            let z = bodies.mesh.nodes[*n as usize][2];
            (low..=high).contains(&z)
        }));
    }
    nodes
}
