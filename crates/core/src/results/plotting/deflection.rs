//! Deflection of a wall: a displacement along a line on its face.
//!
//! ```text
//!   z ▲ ┌──┬──┬──┐        along the height at mid-length:    along the length at mid-height:
//!     │ ├─┬┴─┬┴─┬┤   z ▲ ╭╯                                u ▲   ╭───╮
//!     │ ├─┴┬─┴┬─┴┤     │ ╰╮                                  │  ╭╯   ╰╮
//!     └▶└──┴──┴──┘     └───▶ u                               └──────────▶ x
//! ```
//!
//! Every element of the face y = min that the line crosses at rest gives one piece. Open or sliding joints appear as
//! steps.

use super::chart::{self, Line, run_pen};
use crate::experiment::Point;
use crate::model::Mesh;
use crate::results::elevation;
use crate::state::Frame;

/// Line on the face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Vertical at mid-length.
    Height,
    /// Horizontal at mid-height.
    Length,
}

impl Along {
    /// Axes along the line and across it.
    fn axes(self) -> (usize, usize) {
        match self {
            Self::Height => (2, 0),
            Self::Length => (0, 2),
        }
    }
}

/// A displacement along a line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deflection {
    /// Position along the line from the lowest node, and displacement [mm]. Two points per element.
    pub points: Vec<Point>,
}

/// The horizontal axis, x or y, with the larger displacements.
pub fn main_axis(frame: &Frame) -> usize {
    let moved = |axis: usize| {
        frame
            .displacement
            .iter()
            .map(|u| u[axis].powi(2))
            .sum::<f64>()
    };
    usize::from(moved(1) > moved(0))
}

impl Deflection {
    /// Displacement along `axis` (0 to 2) on a line of the face y = min; no points if no element of the face meets
    /// the line. The mesh and the frame must fit together.
    pub fn of(mesh: &Mesh, frame: &Frame, along: Along, axis: usize) -> Self {
        let (on, across) = along.axes();
        let [low, high] = mesh.extent(across);
        let [origin, _] = mesh.extent(on);
        let at = 0.5 * (low + high);
        let mut pieces: Vec<[Point; 2]> = Vec::new();
        for e in elevation::front(mesh) {
            let corners = elevation::FRONT.map(|i| mesh.elements[e][i] as usize);
            let mut crossings: Vec<Point> = Vec::new();
            for k in 0..4 {
                let (a, b) = (corners[k], corners[(k + 1) % 4]);
                let (xa, xb) = (mesh.nodes[a], mesh.nodes[b]);
                // Half-open interval, so that a line through a corner is counted once.
                if (xa[across] <= at) != (xb[across] <= at) {
                    let t = (at - xa[across]) / (xb[across] - xa[across]);
                    let between = |from: f64, to: f64| from + t * (to - from);
                    let [ua, ub] = [a, b].map(|n| frame.displacement[n][axis]);
                    crossings.push((between(xa[on], xb[on]) - origin, between(ua, ub)));
                }
            }
            crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
            if let [first, .., last] = crossings[..] {
                pieces.push([first, last]);
            }
        }
        pieces.sort_by(|a, b| a[0].0.total_cmp(&b[0].0));
        Self {
            points: pieces.into_flattened(),
        }
    }
}

/// Deflections of several runs with their names as SVG text; `axis` is that of the displacement.
///
/// # Errors
/// No point has finite numbers.
pub fn deflections(
    title: &str,
    along: Along,
    axis: usize,
    runs: &[(String, Deflection)],
) -> Result<String, String> {
    let u = format!("displacement {} [mm]", ["x", "y", "z"][axis]);
    let line = |(i, (name, deflection)): (usize, &(String, Deflection))| {
        let points = deflection.points.iter().map(|&(at, u)| match along {
            Along::Height => (u, at),
            Along::Length => (at, u),
        });
        let line = Line {
            name: name.clone(),
            points: points.collect(),
            marks: Vec::new(),
        };
        (line, run_pen(i))
    };
    let lines: Vec<_> = runs.iter().enumerate().map(line).collect();
    let axes = match along {
        Along::Height => [u.as_str(), "height at mid-length [mm]"],
        Along::Length => ["along the length at mid-height [mm]", u.as_str()],
    };
    chart::picture(title, axes, &lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    #[test]
    fn a_line_crosses_the_elements_of_the_face() {
        let model = fake::model();
        let frame = fake::frame(&model, 1.0); // u = 1e-3 (x + 1)
        // At mid-length, x = 101 mm, is the gap between the cubes.
        assert!(
            Deflection::of(&model.mesh, &frame, Along::Height, 0)
                .points
                .is_empty()
        );
        let along = Deflection::of(&model.mesh, &frame, Along::Length, 0);
        let places: Vec<f64> = along.points.iter().map(|p| p.0).collect();
        assert_eq!(places, [0.0, 100.0, 102.0, 202.0]);
        for (at, u) in along.points {
            assert!((u - 1e-3 * (at + 1.0)).abs() < 1e-15);
        }
    }

    #[test]
    fn the_axis_is_the_one_that_moves() {
        let model = fake::model();
        let mut frame = fake::frame(&model, 1.0);
        assert_eq!(main_axis(&frame), 0);
        for u in &mut frame.displacement {
            *u = [0.1, -3.0, 9.0];
        }
        assert_eq!(main_axis(&frame), 1);
    }

    #[test]
    fn the_picture_names_its_axes() {
        let deflection = Deflection {
            points: vec![(0.0, 0.0), (100.0, 2.0)],
        };
        let runs = [("wall".to_owned(), deflection)];
        let svg = deflections("Wall", Along::Height, 1, &runs).unwrap();
        assert!(svg.contains("displacement y [mm]") && svg.contains("height at mid-length"));
    }
}
