//! `crack_pattern.svg`: elevation of the deformed wall with cracked and crushed elements.
//!
//! ```text
//!   z ▲   each element of the face y = min is its quad      1 ┌────┐ 5    nodes 0 1 5 4
//!     │   at x + s u; s magnifies the displacement            │    │      of the hexahedron
//!     └──▶ x                                                0 └────┘ 1
//! ```
//!
//! The colour changes from that of the material to black with the tensile damage. A blue cross marks compressive
//! damage above [`CRUSHED`]. Open joints appear as gaps.

use std::fmt::Write as _;

use super::Snapshot;
use crate::model::{Mesh, Model};
pub use crate::state::CRUSHED;
use crate::state::{Frame, InterfaceState};

/// Local nodes of the face at −y, counter-clockwise seen from outside.
pub const FRONT: [usize; 4] = [0, 1, 5, 4];

/// Width of the drawing [px].
const WIDTH: f64 = 900.0;
const MARGIN: f64 = 24.0;
const HEADER: f64 = 44.0;
const FOOTER: f64 = 46.0;
/// Height of a further line in the footer.
const LINE: f64 = 22.0;

/// Colours of sound materials by index, repeated if there are more materials.
const SOUND: [[f64; 3]; 4] = [
    [214., 160., 130.],
    [226., 222., 212.],
    [190., 180., 150.],
    [170., 190., 200.],
];
const CRACKED: [f64; 3] = [20., 10., 15.];

/// Elevation of a frame as SVG text, with displacements magnified by [`magnification`].
pub fn crack_pattern(model: &Model, frame: &Frame) -> String {
    elevation(&model.title, &model.mesh, frame, &[], "")
}

/// Elevation of a run at a frame with its failed joints: open ones in red, sliding ones in orange. Only joints that
/// meet the front face are drawn, as lines.
pub fn crack_pattern_of(snapshot: &Snapshot) -> String {
    let (mesh, frame) = (&snapshot.mesh, &snapshot.frame);
    let joints = failed_joints(snapshot);
    elevation(&snapshot.title, mesh, frame, &joints, &snapshot.caption())
}

fn elevation(title: &str, mesh: &Mesh, frame: &Frame, joints: &[Joint], caption: &str) -> String {
    let scale = magnification(mesh, frame);
    let quads = quads(mesh, frame, scale);
    let [x0, z0, x1, z1] = bounds(quads.iter().flat_map(|q| q.corners));
    let (length, tall) = (x1 - x0, z1 - z0);
    // Limits the height of the picture of a slender scene.
    let zoom = (WIDTH - 2.0 * MARGIN) / length.max(tall / TALLEST).max(f64::MIN_POSITIVE);
    let drawing = Drawing {
        title,
        quads: &quads,
        joints,
        height: HEADER + tall * zoom + FOOTER + if joints.is_empty() { 0.0 } else { LINE },
        scale,
        time: frame.time,
        caption,
    };
    let left = 0.5 * (WIDTH - length * zoom);
    let place = |[x, z]: [f64; 2]| (left + (x - x0) * zoom, HEADER + (z1 - z) * zoom);

    let mut svg = String::new();
    let drawn = draw(&mut svg, &drawing, place);
    debug_assert!(drawn.is_ok(), "writing to a string does not fail");
    svg
}

/// Largest ratio of the height of the drawing to its width.
const TALLEST: f64 = 1.6;

/// Content of the drawing.
struct Drawing<'a> {
    title: &'a str,
    quads: &'a [Quad],
    joints: &'a [Joint],
    height: f64,
    scale: f64,
    /// [s]
    time: f64,
    /// Text at the upper right.
    caption: &'a str,
}

/// Line of a failed joint on the front face.
struct Joint {
    /// Position at rest [mm]. `[end][x, z]`
    rest: [[f64; 2]; 2],
    /// Displacement of the slave side [mm]. `[end][x, z]`
    moved: [[f64; 2]; 2],
    open: bool,
}

/// Edges on the front face of quads whose contact point has failed.
fn failed_joints(snapshot: &Snapshot) -> Vec<Joint> {
    let (surface, moved) = (&snapshot.surface, &snapshot.surface_displacement);
    let (front, size) = depth(&snapshot.mesh);
    let on_front = |n: u32| surface.points[n as usize][1] - front <= 1e-9 * size;
    let states = &snapshot.frame.interfaces.state;
    let mut joints = Vec::new();
    for (quad, state) in surface.quads.iter().zip(states) {
        let open = match state {
            InterfaceState::FailedOpen => true,
            InterfaceState::FailedSliding => false,
            InterfaceState::Intact | InterfaceState::Softening => continue,
        };
        for k in 0..4 {
            let ends = [quad[k], quad[(k + 1) % 4]];
            if ends.into_iter().all(on_front) {
                let seen = |of: &[[f64; 3]]| ends.map(|n| [of[n as usize][0], of[n as usize][2]]);
                joints.push(Joint {
                    rest: seen(&surface.points),
                    moved: seen(moved),
                    open,
                });
            }
        }
    }
    joints
}

/// Smallest y and extent in y [mm].
fn depth(mesh: &Mesh) -> (f64, f64) {
    let [front, back] = mesh.extent(1);
    (front, (back - front).max(0.0))
}

/// Elements with a face on y = min.
pub fn front(mesh: &Mesh) -> impl Iterator<Item = usize> + '_ {
    let (front, size) = depth(mesh);
    // Coordinates on the same face may differ by rounding.
    let on_front = move |e: &usize| {
        FRONT
            .iter()
            .all(|&i| mesh.corners(*e)[i][1] - front <= 1e-9 * size)
    };
    (0..mesh.elements.len()).filter(on_front)
}

/// The front face of one element.
struct Quad {
    /// Deformed corners. `[corner][x, z]`
    corners: [[f64; 2]; 4],
    material: usize,
    tensile_damage: f64,
    compressive_damage: f64,
}

fn draw(
    svg: &mut String,
    drawing: &Drawing<'_>,
    place: impl Fn([f64; 2]) -> (f64, f64),
) -> std::fmt::Result {
    let (quads, height) = (drawing.quads, drawing.height);
    writeln!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0}" height="{height:.0}" viewBox="0 0 {WIDTH:.0} {height:.0}" font-family="sans-serif">"#
    )?;
    writeln!(
        svg,
        r##"<rect width="100%" height="100%" fill="#ffffff"/>"##
    )?;
    writeln!(
        svg,
        r#"<text x="{MARGIN}" y="28" font-size="18">{}</text>"#,
        escape(drawing.title)
    )?;
    if !drawing.caption.is_empty() {
        writeln!(
            svg,
            r#"<text x="{}" y="28" font-size="14" text-anchor="end">{}</text>"#,
            WIDTH - MARGIN,
            escape(drawing.caption)
        )?;
    }
    // Thin lines show the mesh without hiding the damage.
    writeln!(svg, r##"<g stroke="#00000033" stroke-width="0.4">"##)?;
    for quad in quads {
        let points: Vec<String> = quad
            .corners
            .iter()
            .map(|&corner| place(corner))
            .map(|(x, y)| format!("{x:.2},{y:.2}"))
            .collect();
        let fill = colour(quad.material, quad.tensile_damage);
        writeln!(
            svg,
            r#"<polygon points="{}" fill="{fill}"/>"#,
            points.join(" ")
        )?;
    }
    writeln!(svg, "</g>")?;
    writeln!(
        svg,
        r##"<g class="crushed" stroke="#1f5fd0" stroke-width="1.6">"##
    )?;
    for quad in quads.iter().filter(|q| q.compressive_damage > CRUSHED) {
        for (from, to) in [(0, 2), (1, 3)] {
            let ((x1, y1), (x2, y2)) = (place(quad.corners[from]), place(quad.corners[to]));
            writeln!(
                svg,
                r#"<line x1="{x1:.2}" y1="{y1:.2}" x2="{x2:.2}" y2="{y2:.2}"/>"#
            )?;
        }
    }
    writeln!(svg, "</g>")?;
    joints(svg, drawing, &place)?;
    legend(svg, drawing)?;
    writeln!(svg, "</svg>")
}

const OPEN: &str = "#d01c1c";
const SLIDING: &str = "#e88a00";

/// Draws failed joints over the elements.
fn joints(
    svg: &mut String,
    drawing: &Drawing<'_>,
    place: &impl Fn([f64; 2]) -> (f64, f64),
) -> std::fmt::Result {
    for (open, colour) in [(false, SLIDING), (true, OPEN)] {
        let of_kind = || drawing.joints.iter().filter(|j| j.open == open);
        if of_kind().next().is_none() {
            continue;
        }
        writeln!(
            svg,
            r#"<g stroke="{colour}" stroke-width="1.8" stroke-linecap="round">"#
        )?;
        for joint in of_kind() {
            let end = |k: usize| {
                let (x, u) = (joint.rest[k], joint.moved[k]);
                place([0, 1].map(|i| x[i] + drawing.scale * u[i]))
            };
            let ((x1, y1), (x2, y2)) = (end(0), end(1));
            writeln!(svg, r#"<path d="M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}"/>"#)?;
        }
        writeln!(svg, "</g>")?;
    }
    if drawing.joints.is_empty() {
        return Ok(());
    }
    let y = drawing.height - 18.0;
    writeln!(svg, r#"<g font-size="13">"#)?;
    writeln!(svg, r#"<text x="{MARGIN}" y="{y:.0}">failed joints</text>"#)?;
    for (x, colour, what) in [
        (MARGIN + 122.0, OPEN, "open"),
        (MARGIN + 222.0, SLIDING, "closed, sliding"),
    ] {
        let (line, end, text) = (y - 5.0, x + 30.0, x + 38.0);
        writeln!(
            svg,
            r#"<path d="M{x:.0} {line:.0}H{end:.0}" stroke="{colour}" stroke-width="2.4"/>"#
        )?;
        writeln!(svg, r#"<text x="{text:.0}" y="{y:.0}">{what}</text>"#)?;
    }
    writeln!(svg, "</g>")
}

/// Draws the scale of damage from 0 to 1, the mark of crushing and the magnification.
fn legend(svg: &mut String, drawing: &Drawing<'_>) -> std::fmt::Result {
    let (scale, time, cells) = (drawing.scale, drawing.time, 20);
    let below = if drawing.joints.is_empty() { 0.0 } else { LINE };
    let y = drawing.height - 30.0 - below;
    writeln!(svg, r#"<g font-size="13">"#)?;
    writeln!(
        svg,
        r#"<text x="{MARGIN}" y="{:.0}">tensile damage 0</text>"#,
        y + 12.0
    )?;
    let left = MARGIN + 122.0;
    for i in 0..cells {
        let fill = colour(0, (f64::from(i) + 0.5) / f64::from(cells));
        let x = left + 6.0 * f64::from(i);
        writeln!(
            svg,
            r#"<rect x="{x:.0}" y="{y:.0}" width="6" height="14" fill="{fill}"/>"#
        )?;
    }
    let right = left + 6.0 * f64::from(cells) + 6.0;
    writeln!(svg, r#"<text x="{right:.0}" y="{:.0}">1</text>"#, y + 12.0)?;
    let (cross, low) = (right + 44.0, y + 14.0);
    for (a, b) in [(y, low), (low, y)] {
        writeln!(
            svg,
            r##"<line x1="{cross:.0}" y1="{a:.0}" x2="{:.0}" y2="{b:.0}" stroke="#1f5fd0" stroke-width="1.6"/>"##,
            cross + 14.0
        )?;
    }
    writeln!(
        svg,
        r#"<text x="{:.0}" y="{:.0}">compressive damage above {CRUSHED}</text>"#,
        cross + 22.0,
        y + 12.0
    )?;
    writeln!(
        svg,
        r#"<text x="{:.0}" y="{:.0}" text-anchor="end">displacements × {scale}, t = {time:.3} s</text>"#,
        WIDTH - MARGIN,
        y + 12.0
    )?;
    writeln!(svg, "</g>")
}

fn quads(mesh: &Mesh, frame: &Frame, scale: f64) -> Vec<Quad> {
    let corner = |n: u32| {
        let (x, u) = (mesh.nodes[n as usize], frame.displacement[n as usize]);
        [x[0] + scale * u[0], x[2] + scale * u[2]]
    };
    front(mesh)
        .map(|e| Quad {
            corners: FRONT.map(|i| corner(mesh.elements[e][i])),
            material: usize::from(mesh.material[e]),
            tensile_damage: frame.tensile_damage[e],
            compressive_damage: frame.compressive_damage[e],
        })
        .collect()
}

/// Magnification of displacements: the largest of 1, 2, 5, 10, … that moves no node by more than 4 % of the largest
/// extent of the model, and at least 1.
pub fn magnification(mesh: &Mesh, frame: &Frame) -> f64 {
    let extent = (0..3)
        .map(|i| {
            let (low, high) = mesh
                .nodes
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                    (low.min(x[i]), high.max(x[i]))
                });
            high - low
        })
        .fold(0.0, f64::max);
    suitable(extent, largest(&frame.displacement))
}

/// Largest displacement in the drawing plane, x and z [mm].
pub(super) fn largest(displacement: &[[f64; 3]]) -> f64 {
    let size = displacement.iter().map(|u| u[0].hypot(u[2]));
    size.fold(0.0, f64::max)
}

/// Magnification for displacements up to `largest` on a model of this extent [mm].
pub(super) fn suitable(extent: f64, largest: f64) -> f64 {
    let most = 0.04 * extent / largest;
    // It is not finite if nothing has moved or the model is empty.
    if !(most.is_finite() && most > 1.0) {
        return 1.0;
    }
    let decade = 10_f64.powf(most.log10().floor());
    [5.0, 2.0, 1.0]
        .map(|f| f * decade)
        .into_iter()
        .find(|f| *f <= most)
        .unwrap_or(1.0)
}

/// Lower and upper bounds of corners: x₀, y₀, x₁, y₁; a unit square without corners.
pub(super) fn bounds(corners: impl Iterator<Item = [f64; 2]>) -> [f64; 4] {
    let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
    let found = corners.fold([low, low, high, high], |b, [x, y]| {
        [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)]
    });
    if found[0] <= found[2] {
        found
    } else {
        [0.0, 0.0, 1.0, 1.0]
    }
}

fn colour(material: usize, damage: f64) -> String {
    let (sound, t) = (SOUND[material % SOUND.len()], damage.clamp(0.0, 1.0));
    let [r, g, b]: [u8; 3] =
        std::array::from_fn(|i| (sound[i] + t * (CRACKED[i] - sound[i])).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Escapes text for XML.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    #[test]
    fn each_front_face_is_drawn_once_and_crushing_is_marked() {
        let model = fake::model();
        let frame = fake::frame(&model, 1.0);
        let svg = crack_pattern(&model, &frame);
        assert_eq!(svg.matches("<polygon").count(), 2);
        // One of the two cubes has compressive damage 0, the other 0.4: the cross has two lines, the legend two more.
        assert_eq!(svg.matches("<line").count(), 4);
        assert!(svg.contains("Two cubes &amp; a &lt;gap&gt;"));
    }

    #[test]
    fn corners_lie_at_their_magnified_places() {
        let model = fake::model();
        let mut frame = fake::frame(&model, 0.0);
        // The right cube moves by 1 mm in x and 0.5 mm in z; the displacement in y is not visible.
        for u in &mut frame.displacement[8..] {
            *u = [1.0, 7.0, 0.5];
        }
        let quads = quads(&model.mesh, &frame, 10.0);
        assert_eq!(
            quads[0].corners,
            [[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 100.0]]
        );
        assert_eq!(
            quads[1].corners,
            [[112.0, 5.0], [212.0, 5.0], [212.0, 105.0], [112.0, 105.0]]
        );
    }

    #[test]
    fn the_magnification_is_round_and_moderate() {
        let model = fake::model(); // 202 mm long: 4 % are 8.08 mm
        let mut frame = fake::frame(&model, 0.0);
        assert_eq!(magnification(&model.mesh, &frame), 1.0);
        for (moved, expected) in [
            (0.1, 50.0),
            (0.01, 500.0),
            (0.3, 20.0),
            (1.0, 5.0),
            (50.0, 1.0),
        ] {
            frame.displacement[3] = [0.0, 1e3, moved];
            assert_eq!(magnification(&model.mesh, &frame), expected, "{moved}");
        }
    }

    #[test]
    fn damage_goes_from_the_material_to_black() {
        assert_eq!(colour(0, 0.0), "#d6a082");
        assert_eq!(colour(0, 1.0), colour(1, 2.0));
        assert_eq!(colour(0, 1.0), "#140a0f");
    }
}
