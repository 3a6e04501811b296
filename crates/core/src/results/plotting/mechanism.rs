//! Picture of a limit analysis: the units as they move in the mechanism, and the forces in the joints.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use nalgebra::Vector3;

use super::super::svg_text::escape;
use crate::limit::{LimitAnalysis, MovedUnit, convex_outline};
use crate::model::Model;

/// Width of the drawing [px].
const WIDTH: f64 = 900.0;
/// Margin on all sides [px].
const MARGIN: f64 = 40.0;
/// Height of the line of text [px].
const HEADER: f64 = 34.0;
/// Largest height of the drawing over its width.
const TALLEST: f64 = 1.4;
/// Largest motion in the picture over the size of the scene.
const MOTION: f64 = 0.06;
/// Length of the line of the largest force over the size of the scene.
const FORCE: f64 = 0.12;
/// Part of the fastest motion below which a unit counts as still.
const STILL: f64 = 1e-2;

/// SVG text: an elevation along the larger horizontal motion, x or y, with units at rest in grey and moved ones in
/// orange. Red lines are the forces in the joints, as wide as long, through the point where the normal force acts.
pub fn mechanism(model: &Model, found: &LimitAnalysis) -> String {
    let along = direction(model, found);
    let [extent, height] = [along, 2].map(|axis| {
        let [low, high] = model.mesh.extent(axis);
        high - low
    });
    let size = extent.max(height);
    let outlines = outlines(model, found, along, size);
    let page = Page::around(&outlines);
    let mut svg = String::new();
    let drawn = page
        .begin(&mut svg, &heading(model, found))
        .and_then(|()| page.units(&mut svg, &outlines))
        .and_then(|()| page.forces(&mut svg, found, along, size));
    debug_assert!(drawn.is_ok(), "writing to a string does not fail");
    svg += "</svg>\n";
    svg
}

/// The horizontal axis along which the units move most; of a mechanism without such a motion the longer one.
fn direction(model: &Model, found: &LimitAnalysis) -> usize {
    let moved = |axis: usize| {
        let squares = found.mechanism.iter();
        squares.map(|unit| unit.velocity[axis].powi(2)).sum::<f64>()
    };
    let extent = |axis: usize| {
        let [low, high] = model.mesh.extent(axis);
        high - low
    };
    let still = moved(0) + moved(1) == 0.0;
    usize::from(moved(1) > moved(0) || (still && extent(1) > extent(0)))
}

/// Outline of a unit in the elevation [mm], and whether it moves.
struct Outline {
    corners: Vec<[f64; 2]>,
    moves: bool,
}

/// Outlines of the units, moved by a part of the size of the scene [mm].
fn outlines(model: &Model, found: &LimitAnalysis, along: usize, size: f64) -> Vec<Outline> {
    let mesh = &model.mesh;
    let mut points: BTreeMap<u32, Vec<[f64; 2]>> = BTreeMap::new();
    let units = found.mechanism.iter().map(|unit| (unit.unit, unit));
    let units: BTreeMap<u32, &MovedUnit> = units.collect();
    for (e, nodes) in mesh.elements.iter().enumerate() {
        let Some(unit) = units.get(&mesh.unit[e]) else {
            continue;
        };
        let own = points.entry(unit.unit).or_default();
        for n in nodes {
            let x = Vector3::from(mesh.nodes[*n as usize]);
            let arm = x - Vector3::from(unit.centre_mm);
            let turned = Vector3::from(unit.spin).cross(&arm);
            let at = x + MOTION * size * (Vector3::from(unit.velocity) + turned);
            own.push([at[along], at[2]]);
        }
    }
    let outline = |(number, points): (u32, Vec<[f64; 2]>)| {
        let unit = units[&number];
        let spun = Vector3::from(unit.spin).norm() * size;
        Outline {
            corners: convex_outline(points),
            moves: Vector3::from(unit.velocity).norm() + spun > STILL,
        }
    };
    points.into_iter().map(outline).collect()
}

/// From the elevation [mm] to the picture [px].
struct Page {
    zoom: f64,
    /// Left end of the scene [px], its left and high end [mm], and the height of the picture [px].
    left: f64,
    corner: [f64; 2],
    height: f64,
}

impl Page {
    fn around(outlines: &[Outline]) -> Self {
        let all = || outlines.iter().flat_map(|outline| &outline.corners);
        let low = |axis: usize| all().map(|x| x[axis]).fold(f64::INFINITY, f64::min);
        let high = |axis: usize| all().map(|x| x[axis]).fold(f64::NEG_INFINITY, f64::max);
        let [length, tall] = [0, 1].map(|axis| high(axis) - low(axis));
        let widest = length.max(tall / TALLEST).max(f64::MIN_POSITIVE);
        let zoom = (WIDTH - 2.0 * MARGIN) / widest;
        Self {
            zoom,
            left: 0.5 * (WIDTH - length * zoom),
            corner: [low(0), high(1)],
            height: HEADER + 2.0 * MARGIN + tall * zoom,
        }
    }

    fn place(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        [
            self.left + (x - self.corner[0]) * self.zoom,
            HEADER + MARGIN + (self.corner[1] - z) * self.zoom,
        ]
    }

    fn begin(&self, svg: &mut String, heading: &str) -> std::fmt::Result {
        let height = self.height;
        writeln!(
            svg,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {WIDTH} {height:.0}\" font-family=\"sans-serif\" font-size=\"15\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
             <text x=\"{MARGIN}\" y=\"26\">{}</text>",
            escape(heading)
        )
    }

    fn units(&self, svg: &mut String, outlines: &[Outline]) -> std::fmt::Result {
        for outline in outlines {
            let fill = if outline.moves { "#f0b27a" } else { "#d5d8dc" };
            let points = outline.corners.iter().map(|corner| {
                let [x, y] = self.place(*corner);
                format!("{x:.2},{y:.2}")
            });
            let points: Vec<String> = points.collect();
            writeln!(
                svg,
                "<polygon points=\"{}\" fill=\"{fill}\" fill-opacity=\"0.85\" stroke=\"#555\" stroke-width=\"0.8\"/>",
                points.join(" ")
            )?;
        }
        Ok(())
    }

    fn forces(
        &self,
        svg: &mut String,
        found: &LimitAnalysis,
        along: usize,
        size: f64,
    ) -> std::fmt::Result {
        let forces = || found.joints.iter().map(|joint| Vector3::from(joint.force));
        let most = forces().map(|force| force.norm()).fold(0.0, f64::max);
        for (joint, force) in found.joints.iter().zip(forces()).filter(|_| most > 0.0) {
            let part = force / most;
            let half = [along, 2].map(|axis| 0.5 * FORCE * size * part[axis]);
            let at = [joint.at_mm[along], joint.at_mm[2]];
            let [x1, y1] = self.place([at[0] - half[0], at[1] - half[1]]);
            let [x2, y2] = self.place([at[0] + half[0], at[1] + half[1]]);
            let width = 0.4 + 4.0 * part.norm();
            writeln!(
                svg,
                "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" stroke=\"#c0392b\" \
                 stroke-opacity=\"0.7\" stroke-width=\"{width:.2}\" stroke-linecap=\"round\"/>"
            )?;
        }
        Ok(())
    }
}

fn heading(model: &Model, found: &LimitAnalysis) -> String {
    let factor = match found.force {
        Some(force) => format!("{force:.3} kN"),
        None => format!("factor {:.5}", found.factor),
    };
    format!("{}: {factor}", model.title)
}
