//! Placement of a wall: from the coordinates in which its units are laid to those of the scene.
//!
//! ```text
//! laid: a box                         placed: skewed where another wall meets it, then turned
//! u                                   ┌──────┬──────┬────┬───╱───╱
//! ├──────┬──────┬──────┬──────┐       │      │      │    ╱   ╱   ╱
//! └──────┴──────┴──────┴──────┘ s'    └──────┴──────┴───┴───┴───┘
//! ```
//!
//! With the skew k, a point at s' along the wall and u through it comes to
//!
//! ```text
//! s = s' + k(s') u
//! ```
//!
//! k is constant where another wall passes and at the joints to it, and falls to 0 along the wall beside it. Planes s' =
//! const and u = const stay planes, so that units stay solids with six plane faces that meet those of their neighbours.

use super::corner::Corner;
use super::layout::Refusal;
use super::thickness;
use crate::deck::quantity::Quantity;
use crate::deck::schema::{Rotation, Wall};

/// Placement of a wall.
#[derive(Clone, Debug)]
pub(in crate::deck) struct Placement {
    /// The point about which the wall is turned, which is the origin of s' and u [mm].
    at: [f64; 3],
    /// Axes along and through the wall before it is turned.
    axes: (usize, usize),
    rotation: Option<Rotation>,
    /// Points (s' [mm], k [-]) of the skew, ascending in s'. It is linear between them and constant beyond.
    skew: Vec<[f64; 2]>,
}

/// Part of the length of a unit that remains at least where the skew changes.
const LEAST_STRETCH: f64 = 0.5;

impl Placement {
    /// Placement of a wall that others meet at `corners`.
    ///
    /// # Errors
    /// Corners of different skew so close to each other that no masonry fits between them.
    pub(super) fn new(wall: &Wall, corners: &[Corner]) -> Result<Self, Refusal> {
        Ok(Self {
            at: wall.at.map(Quantity::get),
            axes: wall.axes(),
            rotation: wall.rotate,
            skew: skew(wall, corners)?,
        })
    }

    /// Whether units stay where they were laid.
    pub(in crate::deck) fn is_identity(&self) -> bool {
        self.rotation.is_none() && self.skew.is_empty()
    }

    /// Position in the scene of a point as it was laid [mm].
    pub(in crate::deck) fn to_scene(&self, mut x: [f64; 3]) -> [f64; 3] {
        let (along, through) = self.axes;
        if !self.skew.is_empty() {
            let (s, u) = (x[along] - self.at[along], x[through] - self.at[through]);
            x[along] += self.skew_at(s) * u;
        }
        self.rotation.map_or(x, |rotation| {
            let turned = rotation.turn([0, 1, 2].map(|d| x[d] - self.at[d]));
            [0, 1, 2].map(|d| self.at[d] + turned[d])
        })
    }

    /// Inverse of [`Self::to_scene`].
    pub(in crate::deck) fn to_laid(&self, mut x: [f64; 3]) -> [f64; 3] {
        if let Some(rotation) = self.rotation {
            let back = rotation.turn_back([0, 1, 2].map(|d| x[d] - self.at[d]));
            x = [0, 1, 2].map(|d| self.at[d] + back[d]);
        }
        let (along, through) = self.axes;
        if !self.skew.is_empty() {
            let (s, u) = (x[along] - self.at[along], x[through] - self.at[through]);
            x[along] = self.at[along] + self.laid_along(s, u);
        }
        x
    }

    /// k(s') [-].
    fn skew_at(&self, s: f64) -> f64 {
        let after = self.skew.partition_point(|[at, _]| *at <= s);
        match (after.checked_sub(1), self.skew.get(after)) {
            (Some(before), Some([b, kb])) => {
                let [a, ka] = self.skew[before];
                ka + (kb - ka) * (s - a) / (b - a)
            }
            (Some(before), None) => self.skew[before][1],
            (None, Some([_, first])) => *first,
            (None, None) => 0.0,
        }
    }

    /// s' of a point at s and u [mm].
    fn laid_along(&self, s: f64, u: f64) -> f64 {
        let after = self.skew.partition_point(|[at, k]| at + k * u <= s);
        match (after.checked_sub(1), self.skew.get(after)) {
            (Some(before), Some([b, kb])) => {
                let [a, ka] = self.skew[before];
                let (low, high) = (a + ka * u, b + kb * u);
                a + (b - a) * (s - low) / (high - low)
            }
            (Some(before), None) => s - self.skew[before][1] * u,
            (None, Some([_, first])) => s - first * u,
            (None, None) => s,
        }
    }
}

/// Points of the skew of a wall, none if all corners are right angles.
fn skew(wall: &Wall, corners: &[Corner]) -> Result<Vec<[f64; 2]>, Refusal> {
    if corners.iter().all(|corner| corner.skew.abs() <= SQUARE) {
        return Ok(Vec::new());
    }
    let head = wall.head_joint.get();
    let thickness = thickness(wall);
    let least = |change: f64| change.abs() * thickness / LEAST_STRETCH;
    let fall = |k: f64| least(k).max(wall.unit[0].get() + head);
    let mut zones: Vec<([f64; 2], f64)> = corners
        .iter()
        .map(|corner| {
            let joint = head / corner.sine();
            let [low, high] = corner.range;
            ([low - joint, high + joint], corner.skew)
        })
        .collect();
    zones.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let mut points: Vec<[f64; 2]> = Vec::new();
    for ([low, high], k) in zones {
        match points.last().copied() {
            None => points.push([low - fall(k), 0.0]),
            Some([before, other]) => {
                let gap = low - before;
                if gap < least(k - other).max(SHORTEST) {
                    return Err(Refusal::new(
                        "at",
                        format!(
                            "two walls meet this one at different angles, {gap:.1} mm apart: no masonry fits between"
                        ),
                        format!(
                            "move them apart, to {:.0} mm at least",
                            least(k - other).max(SHORTEST)
                        ),
                    ));
                }
                if gap > fall(k) + fall(other) {
                    points.push([before + fall(other), 0.0]);
                    points.push([low - fall(k), 0.0]);
                }
            }
        }
        points.push([low, k]);
        points.push([high, k]);
    }
    if let Some(&[last, k]) = points.last() {
        points.push([last + fall(k), 0.0]);
    }
    Ok(points)
}

/// Skews below this are those of right angles [-].
const SQUARE: f64 = 1e-9;

/// Shortest distance of two corners [mm].
const SHORTEST: f64 = 1.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_return_from_the_scene_to_where_they_were_laid() {
        let placement = Placement {
            at: [100.0, -40.0, 7.0],
            axes: (0, 1),
            rotation: None,
            skew: vec![
                [-300.0, 0.0],
                [0.0, 0.6],
                [120.0, 0.6],
                [500.0, -0.2],
                [900.0, 0.0],
            ],
        };
        for s in [
            -500.0, -300.0, -10.0, 0.0, 60.0, 120.0, 333.0, 500.0, 700.0, 1200.0,
        ] {
            for u in [0.0, 51.0, 102.5] {
                let x = [100.0 + s, -40.0 + u, 12.0];
                let there = placement.to_scene(x);
                let back = placement.to_laid(there);
                // Rounding of a few operations on numbers of 1e3.
                assert!(
                    (0..3).all(|d| (back[d] - x[d]).abs() < 1e-11),
                    "{x:?} {back:?}"
                );
            }
        }
        let skewed = placement.to_scene([160.0, 60.0, 0.0]);
        assert!((skewed[0] - (160.0 + 0.6 * 100.0)).abs() < 1e-12);
    }
}
