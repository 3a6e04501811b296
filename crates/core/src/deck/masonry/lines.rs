//! Grid lines of rigid units: they lie where the neighbouring units end.
//!
//! ```text
//!  ├───────┬───────┤
//!  ├───┬───┊───┬───┤   a unit has a line where the joint of the next course stands: points of contact are at the
//!  ├───────┴───────┤   corners of both, about which they turn
//! ```

use super::layout::Unit;
use wythe_contact::{Aabb, Bvh};

/// Grid planes of each unit along x, y, z, including its ends [mm]. Planes nearer than [`ONE_PLANE`] are merged, so
/// that no element is a sliver. `[unit][xyz]`
pub(in crate::deck) fn lines(units: &[Unit]) -> Vec<[Vec<f64>; 3]> {
    let least: Vec<f64> = units.iter().map(least_distance).collect();
    let mut within: Vec<[Vec<f64>; 3]> = vec![[const { Vec::new() }; 3]; units.len()];
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
                    let (low, high) = (low + least[one], high - least[one]);
                    let ends = units[other].own[d].into_iter();
                    within[one][d].extend(ends.filter(|x| *x > low && *x < high));
                }
            }
        }
    }
    let of_unit = |((unit, within), least): ((&Unit, [Vec<f64>; 3]), f64)| {
        let mut ends = unit.own.into_iter();
        within.map(|planes| {
            let [low, high] = ends.next().unwrap_or_default();
            let inner = merged(planes, least);
            [vec![low], inner, vec![high]].concat()
        })
    };
    units.iter().zip(within).zip(least).map(of_unit).collect()
}

/// Part of the shortest edge of a unit up to which planes within it are one plane.
const ONE_PLANE: f64 = 0.01;

/// Distance up to which planes within a unit are one plane [mm].
fn least_distance(unit: &Unit) -> f64 {
    let edges = unit.own.iter().map(|[low, high]| high - low);
    (ONE_PLANE * edges.fold(f64::INFINITY, f64::min)).max(NEAR)
}

/// Planes, ascending, of which those that lie within a range of `least` are one in the middle of the range [mm]: the
/// planes of mirror images are mirror images.
fn merged(mut planes: Vec<f64>, least: f64) -> Vec<f64> {
    planes.sort_by(f64::total_cmp);
    let mut groups: Vec<[f64; 2]> = Vec::new();
    for x in planes {
        match groups.last_mut() {
            Some([first, last]) if x - *first <= least => *last = x,
            _ => groups.push([x, x]),
        }
    }
    let middle = |[first, last]: [f64; 2]| 0.5 * (first + last);
    groups.into_iter().map(middle).collect()
}

/// Faces touch if their distance is no larger, and overlap if they do by more [mm].
const NEAR: f64 = 1e-6;

/// Axis normal to the faces at which two units touch, if they do.
fn touching(a: &Unit, b: &Unit) -> Option<usize> {
    let common = |d: usize| a.own[d][1].min(b.own[d][1]) - a.own[d][0].max(b.own[d][0]);
    let gaps = [0, 1, 2].map(common);
    let axis = (0..3).find(|d| gaps[*d].abs() <= NEAR)?;
    (0..3).all(|d| d == axis || gaps[d] > NEAR).then_some(axis)
}

#[cfg(test)]
mod tests {
    use super::super::layout::Kind;
    use super::*;

    fn unit(along: [f64; 2], up: [f64; 2]) -> Unit {
        let own = [along, [0.0, 200.0], up];
        Unit {
            own,
            all: own,
            course: 0,
            kind: Kind::Unit(0),
            material: None,
            mirror: [false; 3],
            half: None,
        }
    }

    /// Ends of units above that differ by rounding from those below, or from the end of the unit, make no slivers.
    #[test]
    fn planes_that_differ_by_rounding_are_one() {
        let units = [
            unit([0.0, 400.0], [0.0, 200.0]),
            unit([-200.0, 200.0], [200.0, 400.0]),
            unit([200.0, 400.0003], [200.0, 400.0]),
            unit([100.0, 200.0 + 1e-9], [-200.0, 0.0]),
            unit([201.5, 400.0 - 1e-9], [-200.0, 0.0]),
        ];
        let lines = lines(&units);
        assert_eq!(lines[0][0], [0.0, 100.0, 200.75, 400.0]);
        assert_eq!(lines[0][1..], [vec![0.0, 200.0], vec![0.0, 200.0]]);
        assert_eq!(lines[2][0], [200.0, 400.0003]);
        // Planes of mirror images are mirror images.
        assert_eq!(merged(vec![102.0, 101.0, 300.0], 1.0), [101.5, 300.0]);
        assert_eq!(merged(vec![298.0, 100.0, 299.0], 1.0), [100.0, 298.5]);
    }
}
