//! Grid lines of rigid units: they lie where the neighbouring units end.
//!
//! ```text
//!  ├───────┬───────┤
//!  ├───┬───┊───┬───┤   a unit has a line where the joint of the next course stands: points of contact are at the
//!  ├───────┴───────┤   corners of both, about which they turn
//! ```

use super::layout::Unit;
use wythe_contact::{Aabb, Bvh};

/// Grid planes of each unit along x, y, z, including its ends [mm]. `[unit][xyz]`
pub(in crate::deck) fn lines(units: &[Unit]) -> Vec<[Vec<f64>; 3]> {
    let mut lines: Vec<[Vec<f64>; 3]> = units.iter().map(|u| u.own.map(Vec::from)).collect();
    let around = |u: &Unit| Aabb {
        min: u.own.map(|range| range[0] - NEAR),
        max: u.own.map(|range| range[1] + NEAR),
    };
    let boxes: Vec<Aabb> = units.iter().map(around).collect();
    let tree = Bvh::build(&boxes);
    let (mut stack, mut near) = (Vec::new(), Vec::new());
    for a in 0..units.len() {
        near.clear();
        tree.query(&boxes, &boxes[a], &mut stack, |b| near.push(b as usize));
        for b in near.iter().copied().filter(|b| *b > a) {
            let Some(axis) = touching(&units[a], &units[b]) else {
                continue;
            };
            for (one, other) in [(a, b), (b, a)] {
                for d in (0..3).filter(|d| *d != axis) {
                    let [low, high] = units[one].own[d];
                    let ends = units[other].own[d].into_iter();
                    let within = ends.filter(|x| *x > low + NEAR && *x < high - NEAR);
                    lines[one][d].extend(within);
                }
            }
        }
    }
    for planes in lines.iter_mut().flatten() {
        planes.sort_by(f64::total_cmp);
        planes.dedup_by(|b, a| *b - *a <= NEAR);
    }
    lines
}

/// Planes closer than this are one plane [mm].
const NEAR: f64 = 1e-6;

/// Axis normal to the faces at which two units touch, if they do.
fn touching(a: &Unit, b: &Unit) -> Option<usize> {
    let common = |d: usize| a.own[d][1].min(b.own[d][1]) - a.own[d][0].max(b.own[d][0]);
    let gaps = [0, 1, 2].map(common);
    let axis = (0..3).find(|d| gaps[*d].abs() <= NEAR)?;
    (0..3).all(|d| d == axis || gaps[d] > NEAR).then_some(axis)
}
