//! Expanded units: each grows to the middle of its joints, so that joints have no thickness. A unit that can crack is
//! divided in its middle.

use super::joints::touching;
use super::layout::{Half, Kind};
use super::{Masonry, Unit};
use crate::element::hexahedron::{Face, range};

/// Part of the length of a whole unit from which on a unit is divided: bats and closers do not crack through.
const LONG: f64 = 0.75;

/// Expands the units of all walls that are expanded, and divides those that can crack.
pub(super) fn expand(walls: &mut [Masonry<'_>]) {
    if !walls.iter().any(|wall| wall.wall.expanded) {
        return;
    }
    let grown = growth(walls);
    let mut first = 0;
    for (masonry, grown) in walls.iter_mut().zip(grown) {
        if masonry.wall.expanded {
            let along = masonry.wall.axes().0;
            let whole = masonry.wall.unit[0].get();
            let units = std::mem::take(&mut masonry.units);
            let cracks = masonry.wall.crack_interface.is_some();
            let ends = range(units.iter().flat_map(|unit| unit.all[along]));
            masonry.units = units
                .into_iter()
                .zip(grown)
                .flat_map(|(unit, grown)| {
                    let middle = 0.5 * (unit.own[along][0] + unit.own[along][1]);
                    let length = unit.own[along][1] - unit.own[along][0];
                    let is_unit = matches!(unit.kind, Kind::Unit(_));
                    let divided = cracks && is_unit && length >= LONG * whole;
                    let unit = grow(unit, grown);
                    if divided {
                        halves(&unit, along, middle, ends).to_vec()
                    } else {
                        vec![unit]
                    }
                })
                .collect();
        }
        masonry.bodies = first..first + masonry.units.len();
        first = masonry.bodies.end;
    }
}

/// Growth of the faces of a unit [mm]. `[face]`
type Growth = [f64; 6];

/// Growth of all units. Units of one wall share the joint between them. A joint to another wall that passes, or to a
/// plane of symmetry, belongs to the unit that ends there. `[wall][unit]`
fn growth(walls: &[Masonry<'_>]) -> Vec<Vec<Growth>> {
    let mut all: Vec<Vec<Growth>> = walls
        .iter()
        .map(|wall| wall.units.iter().map(full_joints).collect())
        .collect();
    let place = |body: usize| {
        let wall = walls.iter().position(|wall| wall.bodies.contains(&body));
        wall.map(|w| (w, body - walls[w].bodies.start))
    };
    for ((slave, face), (master, other)) in touching(walls) {
        let (Some(own), Some(facing)) = (place(slave), place(master)) else {
            continue;
        };
        let (axis, high) = face.side();
        let of =
            |(wall, unit): (usize, usize), high: bool| walls[wall].units[unit].joint(axis, high);
        let joint = of(own, high) + of(facing, !high);
        if joint > 0.0 && (own.0 == facing.0 || axis == 2) {
            all[own.0][own.1][face as usize] = 0.5 * joint;
            let there = &mut all[facing.0][facing.1][other as usize];
            *there = there.max(0.5 * joint);
        }
    }
    all
}

/// Thickness of the joint at each face [mm].
fn full_joints(unit: &Unit) -> Growth {
    Face::ALL.map(|(_, face)| {
        let (axis, high) = face.side();
        unit.joint(axis, high)
    })
}

fn grow(mut unit: Unit, by: Growth) -> Unit {
    for (_, face) in Face::ALL {
        let (axis, high) = face.side();
        let sign = if high { 1.0 } else { -1.0 };
        unit.own[axis][usize::from(high)] += sign * by[face as usize];
    }
    unit.all = unit.own;
    unit
}

/// Both halves of a unit that is divided at `middle` along the wall, which extends from `ends.0` to `ends.1`. Of a unit
/// at a plane of symmetry the half towards the end of the wall is that at the plane.
fn halves(unit: &Unit, along: usize, middle: f64, ends: [f64; 2]) -> [Unit; 2] {
    let is_left = middle - ends[0] < ends[1] - middle;
    [Half::Left, Half::Right].map(|half| {
        let left = half == Half::Left;
        let mut part = unit.clone();
        part.own[along][usize::from(left)] = middle;
        part.all[along][usize::from(left)] = middle;
        part.half = Some(half);
        part.mirror[along] &= left == is_left;
        part
    })
}

impl Masonry<'_> {
    /// Whether two units, by their bodies, are halves of one.
    pub(in crate::deck) fn are_halves(&self, a: usize, b: usize) -> bool {
        let of = |body: usize| self.units.get(body.checked_sub(self.bodies.start)?);
        let (Some(a), Some(b)) = (of(a), of(b)) else {
            return false;
        };
        a.half.is_some() && b.half.is_some() && a.course == b.course && a.kind == b.kind
    }
}
