//! Mesh of a representative element, which is a unit with its joints:
//!
//! ```text
//!  z  ┌────┬────┬────┬────┬──┐  bed joint (mortar) and, over the head joint, the corner
//!  │  ├────┼────┼────┼────┼──┤
//!  │  │  unit   │    │    │  │  head joint (mortar)
//!  └x └────┴────┴────┴────┴──┘
//! ```
//!
//! Its nodes are its own. Halves of collar joints lie before and behind it in the same way.

use super::Masonry;
use super::layout::Unit;
use crate::deck::body::{Body, Grid};
use crate::deck::quantity::Quantity;
use crate::deck::schema::{FilledFrom, Subdivision, Wall};
use crate::model::Mesh;

/// Grid planes along an axis [mm], and the cells between them that belong to the unit.
struct Planes {
    at: Vec<f64>,
    unit: std::ops::Range<usize>,
}

impl Planes {
    fn new(own: [f64; 2], all: [f64; 2], inner: Vec<f64>) -> Self {
        let before = usize::from(all[0] < own[0]);
        let cells = inner.len() - 1;
        let mut at = Vec::with_capacity(inner.len() + 2);
        at.extend((before > 0).then_some(all[0]));
        at.extend(inner);
        at.extend((all[1] > own[1]).then_some(all[1]));
        Self {
            at,
            unit: before..before + cells,
        }
    }
}

/// Appends a unit with its joints to the mesh. `materials`: those of the unit and of the mortar. `lines`: grid
/// planes of the unit, if they do not follow from the wall's mesh.
pub(in crate::deck) fn append(
    mesh: &mut Mesh,
    masonry: &Masonry<'_>,
    unit: &Unit,
    materials: [u16; 2],
    lines: Option<&[Vec<f64>; 3]>,
) -> Body {
    let wall = masonry.wall;
    let (along, through) = wall.axes();
    let counts = elements(wall, unit);
    let filled = wall.head_filling.get() * (unit.own[through][1] - unit.own[through][0]);
    // Depth of the filling from the front and from the back [mm].
    let depth = match wall.filled_from {
        FilledFrom::Both => [0.5 * filled; 2],
        FilledFrom::Front => [filled, 0.0],
        FilledFrom::Back => [0.0, filled],
    };
    let part_filled = wall.head_filling.get() < 1.0;
    let planes: [Planes; 3] = [0, 1, 2].map(|d| {
        let own = unit.own[d];
        let inner = if let Some(lines) = lines {
            lines[d].clone()
        } else if d == through && part_filled && filled > 0.0 {
            let strips = depth.iter().filter(|depth| **depth > 0.0).count();
            let middle = counts[d].saturating_sub(strips).max(1);
            let mut at = Vec::from_iter((depth[0] > 0.0).then_some(own[0]));
            at.extend(equal(own[0] + depth[0], own[1] - depth[1], middle));
            at.extend((depth[1] > 0.0).then_some(own[1]));
            at
        } else {
            equal(own[0], own[1], counts[d])
        };
        Planes::new(own, unit.all[d], inner)
    });
    let cells = [0, 1, 2].map(|d| planes[d].at.len() - 1);
    let first_element = mesh.elements.len();
    let is_empty = |at: [usize; 3]| {
        // In a partly filled head joint only strips along the faces of the unit are filled. The bed joint above it
        // is complete.
        let beside = !planes[along].unit.contains(&at[along]) && planes[2].unit.contains(&at[2]);
        let strips = &planes[through].unit;
        let in_front = depth[0] > 0.0 && at[through] == strips.start;
        let behind = depth[1] > 0.0 && at[through] + 1 == strips.end;
        part_filled && beside && !in_front && !behind
    };
    let body = Body::new(
        mesh,
        unit.name(&masonry.name),
        &Grid {
            cells,
            material: &|at| {
                let unit = (0..3).all(|d| planes[d].unit.contains(&at[d]));
                let of = if unit { materials[0] } else { materials[1] };
                (!is_empty(at)).then_some(of)
            },
            node: &|at| [0, 1, 2].map(|d| planes[d].at[at[d]]),
        },
    );
    mesh.course[first_element..].fill(unit.course);
    body
}

/// Number of elements of the unit along x, y, z: those of a whole unit in proportion to its sizes.
pub(super) fn elements(wall: &Wall, unit: &Unit) -> [usize; 3] {
    let (along, through) = wall.axes();
    let [length, thickness, height] = wall.unit.map(Quantity::get);
    let own = [0, 1, 2].map(|d| unit.own[d][1] - unit.own[d][0]);
    let whole = unit_elements(wall);
    // Halves are rounded up, whatever the last bits of the coordinates.
    let share = |n: f64, size: f64, of: f64| ((n * size / of + 1e-9).round() as usize).max(1);
    let mut counts = [1; 3];
    counts[along] = share(whole[0], own[along], length);
    counts[through] = share(whole[1], own[through], thickness);
    counts[2] = share(whole[2], own[2], height);
    counts
}

/// Number of elements of a whole unit along, through and up the wall.
pub(super) fn unit_elements(wall: &Wall) -> [f64; 3] {
    let m = wall.mesh;
    // The named meshes always count joints; a mesh given by numbers counts them only where they have a thickness.
    let named = [Subdivision::COARSE, Subdivision::FINE].contains(&m);
    let joint = |thickness: f64| u32::from(!wall.expanded && (named || thickness > 0.0));
    // The difference may be 0: such a mesh is rejected, but only after planes of symmetry have used this number.
    let unit = |n: u32, thickness: f64| f64::from(n) - f64::from(joint(thickness));
    [
        unit(m.length, wall.head_joint.get()),
        f64::from(m.thickness),
        unit(m.height, wall.bed_joint.get()),
    ]
}

/// Divides a to b into `n` equal intervals; both ends are exact.
fn equal(a: f64, b: f64, n: usize) -> Vec<f64> {
    let inner = |i: usize| a + (b - a) * (i as f64 / n as f64);
    (0..=n).map(|i| if i == n { b } else { inner(i) }).collect()
}
