//! Picture of a limit analysis: the units as they move in the mechanism, and the forces in the joints.

use std::fmt::Write as _;

use nalgebra::Vector3;

use super::LimitAnalysis;
use crate::model::Model;

/// Width of the drawing [px].
const WIDTH: f64 = 900.0;
/// Margin on all sides [px].
const MARGIN: f64 = 40.0;
/// Height of the line of text [px].
const HEADER: f64 = 34.0;
/// Largest motion in the picture over the size of the scene.
const MOTION: f64 = 0.06;
/// Length of the line of the largest force over the size of the scene.
const FORCE: f64 = 0.12;
/// Parts of the fastest motion below which a unit counts as still.
const STILL: f64 = 1e-2;

/// SVG text: an elevation along the larger horizontal motion, x or y, with units at rest in grey and moved ones in
/// orange. Red lines are the forces in the joints, as wide as long, through the point where the normal force acts.
#[expect(
    clippy::too_many_lines,
    reason = "a picture is written from its frame to its last line"
)]
pub fn picture(model: &Model, found: &LimitAnalysis) -> String {
    let mesh = &model.mesh;
    let moved = |axis: usize| {
        found
            .mechanism
            .iter()
            .map(|unit| unit.velocity[axis].powi(2))
            .sum::<f64>()
    };
    let extent = |axis: usize| {
        let [low, high] = mesh.extent(axis);
        high - low
    };
    let across = moved(1) > moved(0) || (moved(0) + moved(1) == 0.0 && extent(1) > extent(0));
    let along = usize::from(across);
    let size = extent(along).max(extent(2));
    let by_unit: std::collections::BTreeMap<u32, usize> = found
        .mechanism
        .iter()
        .enumerate()
        .map(|(i, unit)| (unit.unit, i))
        .collect();
    let mut corners: Vec<Vec<[f64; 2]>> = vec![Vec::new(); found.mechanism.len()];
    for (e, nodes) in mesh.elements.iter().enumerate() {
        let Some(i) = by_unit.get(&mesh.unit[e]) else {
            continue;
        };
        let unit = &found.mechanism[*i];
        for n in nodes {
            let x = Vector3::from(mesh.nodes[*n as usize]);
            let arm = x - Vector3::from(unit.centre_mm);
            let velocity = Vector3::from(unit.velocity) + Vector3::from(unit.spin).cross(&arm);
            let at = x + MOTION * size * velocity;
            corners[*i].push([at[along], at[2]]);
        }
    }
    let all = || corners.iter().flatten();
    let bound = |axis: usize, high: bool| {
        let values = all().map(|x| x[axis]);
        if high {
            values.fold(f64::NEG_INFINITY, f64::max)
        } else {
            values.fold(f64::INFINITY, f64::min)
        }
    };
    let [left, right, low, high] = [
        bound(0, false),
        bound(0, true),
        bound(1, false),
        bound(1, true),
    ];
    let zoom = (WIDTH - 2.0 * MARGIN)
        / (right - left)
            .max((high - low) / 1.4)
            .max(f64::MIN_POSITIVE);
    let tall = HEADER + 2.0 * MARGIN + (high - low) * zoom;
    let offset = 0.5 * (WIDTH - (right - left) * zoom);
    let place = |[x, z]: [f64; 2]| {
        [
            offset + (x - left) * zoom,
            HEADER + MARGIN + (high - z) * zoom,
        ]
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{tall:.0}\" \
         viewBox=\"0 0 {WIDTH} {tall:.0}\" font-family=\"sans-serif\" font-size=\"15\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let _ = writeln!(
        svg,
        "<text x=\"{MARGIN}\" y=\"26\">{}</text>",
        escaped(&heading(model, found))
    );
    for (unit, points) in found.mechanism.iter().zip(&corners) {
        let spun = Vector3::from(unit.spin).norm() * size;
        let moves = Vector3::from(unit.velocity).norm() + spun > STILL;
        let fill = if moves { "#f0b27a" } else { "#d5d8dc" };
        let outline = hull(points).into_iter().map(|p| {
            let [x, y] = place(p);
            format!("{x:.2},{y:.2}")
        });
        let outline: Vec<String> = outline.collect();
        let _ = writeln!(
            svg,
            "<polygon points=\"{}\" fill=\"{fill}\" fill-opacity=\"0.85\" stroke=\"#555\" stroke-width=\"0.8\"/>",
            outline.join(" ")
        );
    }
    let most = found
        .joints
        .iter()
        .map(|joint| Vector3::from(joint.force).norm())
        .fold(0.0, f64::max);
    for joint in found.joints.iter().filter(|_| most > 0.0) {
        let force = Vector3::from(joint.force) / most;
        let half = 0.5 * FORCE * size * Vector3::new(force[along], force[2], 0.0);
        let [x, z] = [joint.at_mm[along], joint.at_mm[2]];
        let ends = [
            place([x - half.x, z - half.y]),
            place([x + half.x, z + half.y]),
        ];
        let width = 0.4 + 4.0 * force.norm();
        let _ = writeln!(
            svg,
            "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" stroke=\"#c0392b\" stroke-opacity=\"0.7\" \
             stroke-width=\"{width:.2}\" stroke-linecap=\"round\"/>",
            ends[0][0], ends[0][1], ends[1][0], ends[1][1]
        );
    }
    svg += "</svg>\n";
    svg
}

fn heading(model: &Model, found: &LimitAnalysis) -> String {
    let factor = match found.force {
        Some(force) => format!("{force:.3} kN"),
        None => format!("factor {:.5}", found.factor),
    };
    format!("{}: {factor}", model.title)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// Convex outline of points.
fn hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let points = points.iter().map(|p| nalgebra::Vector2::from(*p)).collect();
    super::joints::hull(points)
        .into_iter()
        .map(Into::into)
        .collect()
}
