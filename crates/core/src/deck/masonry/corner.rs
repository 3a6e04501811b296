//! Walls that meet in plan at any angle.
//!
//! ```text
//!              ╱  B  ╱
//!     ┌───────╱·····╱      the strips of both walls share a parallelogram; lines of A along B's direction have the
//!   A │      ╱     ╱       same s', and lines of B along A's direction the same s' of B
//!     └─────┴─────┴
//! ```
//!
//! With the unit vectors e along and n through each wall and the origins O, a point of wall A on the line u_B = c of wall
//! B has
//!
//! ```text
//! s = (c − (O_A − O_B)·n_B) / (e_A·n_B) + k u,   k = −(n_A·n_B) / (e_A·n_B)
//! ```
//!
//! With s = s' + k u, s' depends on u_B only, and u on s' of B only: boxes of B are boxes in the coordinates of A.

use super::thickness;
use crate::deck::quantity::Quantity;
use crate::deck::schema::Wall;
use crate::element::hexahedron::Face;

/// Axes of an upright wall in plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Where s and u are 0 [mm].
    origin: [f64; 2],
    along: [f64; 2],
    through: [f64; 2],
}

impl Frame {
    /// Axes of a wall; none if it does not stand upright.
    pub(super) fn of(wall: &Wall) -> Option<Self> {
        let (along, through) = wall.axes();
        let upright = wall
            .rotate
            .is_none_or(|rotation| rotation.axis.axis().0 == 2);
        let unit = |axis: usize| {
            let mut x = [0.0; 3];
            x[axis] = 1.0;
            let [x, y, _] = wall.rotate.map_or(x, |rotation| rotation.turn(x));
            [x, y]
        };
        let at = wall.at.map(Quantity::get);
        upright.then(|| Self {
            origin: [at[0], at[1]],
            along: unit(along),
            through: unit(through),
        })
    }

    /// The point at s on the front of the wall [mm].
    pub(super) fn point(&self, s: f64) -> [f64; 2] {
        [0, 1].map(|d| self.origin[d] + s * self.along[d])
    }
}

/// Another wall that meets a wall at an angle.
#[derive(Clone, Copy, Debug)]
pub(in crate::deck) struct Corner {
    /// Index of the other wall.
    pub(super) with: usize,
    /// Skew k of the wall there [-].
    pub(super) skew: f64,
    /// Range of the other wall in s' [mm].
    pub(super) range: [f64; 2],
    /// Sine of the angle between the walls.
    sine: f64,
    /// s' = a + b u of the other wall: a [mm], b [-].
    along: [f64; 2],
    /// u = a + b s' of the other wall: a [mm], b [-].
    through: [f64; 2],
    /// Corner `at`, axes along and through of this wall as it is laid, and of the other one.
    frames: [([f64; 3], (usize, usize)); 2],
}

/// Least sine of the angle between two walls: smaller angles need units with sharper edges than anyone cuts.
pub(super) const LEAST_SINE: f64 = 0.5;

impl Corner {
    /// Sine of the angle between the walls.
    pub(in crate::deck) fn sine(&self) -> f64 {
        self.sine
    }

    /// How wall `b`, which has this index, meets wall `a`; none if they are parallel or one does not stand upright.
    pub(super) fn of(a: &Wall, b: &Wall, with: usize) -> Option<Self> {
        let frames = [Frame::of(a)?, Frame::of(b)?];
        let [own, other] = frames;
        let dot = |x: [f64; 2], y: [f64; 2]| x[0] * y[0] + x[1] * y[1];
        let between = [0, 1].map(|d| own.origin[d] - other.origin[d]);
        let across = dot(own.along, other.through);
        if across.abs() < PARALLEL {
            return None;
        }
        let along = [-dot(between, other.through) / across, 1.0 / across];
        // u = (O_B − O_A)·n_A + (e_B·n_A) s'.
        let through = [-dot(between, own.through), dot(other.along, own.through)];
        let [first, last] = [0.0, thickness(b)].map(|u| along[0] + along[1] * u);
        Some(Self {
            with,
            skew: -dot(own.through, other.through) / across,
            range: [first.min(last), first.max(last)],
            sine: across.abs(),
            along,
            through,
            frames: [a, b].map(|wall| (wall.at.map(Quantity::get), wall.axes())),
        })
    }

    /// A point of the other wall as it is laid, in the coordinates in which this wall is laid [mm].
    pub(super) fn point(&self, x: [f64; 3]) -> [f64; 3] {
        let [(at, (along, through)), (from, (s, u))] = self.frames;
        let mut own = x;
        own[along] = at[along] + (self.along[0] + self.along[1] * (x[u] - from[u]));
        own[through] = at[through] + (self.through[0] + self.through[1] * (x[s] - from[s]));
        own
    }

    /// A box of the other wall in the coordinates in which this wall is laid [mm]. `[xyz][low, high]`
    pub(super) fn of_box(&self, own: [[f64; 2]; 3]) -> [[f64; 2]; 3] {
        let ends = [0, 1].map(|side| self.point([0, 1, 2].map(|d| own[d][side])));
        [0, 1, 2].map(|d| [ends[0][d].min(ends[1][d]), ends[0][d].max(ends[1][d])])
    }

    /// Side of such a box that is this face of the unit of the other wall.
    pub(super) fn side(&self, face: Face) -> Face {
        let [(_, (along, through)), (_, (s, _))] = self.frames;
        let (axis, high) = face.side();
        let (axis, slope) = match axis {
            2 => return face,
            axis if axis == s => (through, self.through[1]),
            _ => (along, self.along[1]),
        };
        let high = high == (slope > 0.0);
        Face::ALL[2 * axis + usize::from(high)].1
    }
}

/// Walls with a smaller sine of their angle are parallel.
const PARALLEL: f64 = 1e-6;
