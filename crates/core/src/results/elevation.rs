//! `crack_pattern.svg`: an elevation of the deformed wall, cracked and crushed elements marked.
//!
//! ```text
//!   z ▲   each element of the face y = min is its quad      1 ┌────┐ 5    nodes 0 1 5 4
//!     │   at x + s u; s magnifies the displacement            │    │      of the hexahedron
//!     └──▶ x                                                0 └────┘ 1
//! ```
//!
//! The fill goes from the material's colour to black with the tensile damage. A blue cross marks
//! compressive damage above [`CRUSHED`]. Open joints show as gaps, being gaps.

use std::fmt::Write as _;

use super::Frame;
use crate::model::Model;

/// Compressive damage above which an element is drawn as crushed [-]: a quarter of the stress is
/// gone.
pub const CRUSHED: f64 = 0.25;

/// Local nodes of the face at −y, counter-clockwise seen from there.
const FRONT: [usize; 4] = [0, 1, 5, 4];

/// Width of the drawing [px].
const WIDTH: f64 = 900.0;
const MARGIN: f64 = 24.0;
const HEADER: f64 = 44.0;
const FOOTER: f64 = 46.0;

/// Colours of sound materials by index, again from the start if there are more.
const SOUND: [[f64; 3]; 4] = [
    [214., 160., 130.],
    [226., 222., 212.],
    [190., 180., 150.],
    [170., 190., 200.],
];
const CRACKED: [f64; 3] = [20., 10., 15.];

/// The elevation as SVG text, with displacements magnified by [`magnification`].
pub fn crack_pattern(model: &Model, frame: &Frame) -> String {
    let scale = magnification(model, frame);
    let quads = quads(model, frame, scale);
    let [x0, z0, x1, z1] = bounds(&quads);
    let zoom = (WIDTH - 2.0 * MARGIN) / (x1 - x0).max(f64::MIN_POSITIVE);
    let height = HEADER + (z1 - z0) * zoom + FOOTER;
    let place = |[x, z]: [f64; 2]| (MARGIN + (x - x0) * zoom, HEADER + (z1 - z) * zoom);

    let mut svg = String::new();
    let drawn = draw(&mut svg, model, &quads, height, scale, frame.time, place);
    debug_assert!(drawn.is_ok(), "writing to a string does not fail");
    svg
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
    model: &Model,
    quads: &[Quad],
    height: f64,
    scale: f64,
    time: f64,
    place: impl Fn([f64; 2]) -> (f64, f64),
) -> std::fmt::Result {
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
        escape(&model.title)
    )?;
    // Hairlines, so that the mesh is seen but the damage dominates.
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
    legend(svg, height, scale, time)?;
    writeln!(svg, "</svg>")
}

/// A bar of damage from 0 to 1, the crushing mark, and the magnification.
fn legend(svg: &mut String, height: f64, scale: f64, time: f64) -> std::fmt::Result {
    let (y, cells) = (height - 30.0, 20);
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

fn quads(model: &Model, frame: &Frame, scale: f64) -> Vec<Quad> {
    let mesh = &model.mesh;
    let front = mesh
        .nodes
        .iter()
        .map(|x| x[1])
        .fold(f64::INFINITY, f64::min);
    let size = mesh.nodes.iter().map(|x| x[1] - front).fold(0.0, f64::max);
    let corner = |n: u32| {
        let (x, u) = (mesh.nodes[n as usize], frame.displacement[n as usize]);
        [x[0] + scale * u[0], x[2] + scale * u[2]]
    };
    let on_front = |e: &usize| {
        // Coordinates of the same face may differ by rounding.
        FRONT
            .iter()
            .all(|&i| mesh.corners(*e)[i][1] - front <= 1e-9 * size)
    };
    (0..mesh.elements.len())
        .filter(on_front)
        .map(|e| Quad {
            corners: FRONT.map(|i| corner(mesh.elements[e][i])),
            material: usize::from(mesh.material[e]),
            tensile_damage: frame.tensile_damage[e],
            compressive_damage: frame.compressive_damage[e],
        })
        .collect()
}

/// Factor by which displacements are drawn: the largest of 1, 2, 5, 10, … which moves no node by
/// more than 4 % of the model's largest extent in the drawing, and at least 1.
pub fn magnification(model: &Model, frame: &Frame) -> f64 {
    let extent = (0..3)
        .map(|i| {
            let (low, high) = model
                .mesh
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

/// Largest displacement in the drawing, x and z [mm].
pub(super) fn largest(displacement: &[[f64; 3]]) -> f64 {
    let size = displacement.iter().map(|u| u[0].hypot(u[2]));
    size.fold(0.0, f64::max)
}

/// Factor by which displacements as large as `largest` are drawn on a model of this extent [mm].
pub(super) fn suitable(extent: f64, largest: f64) -> f64 {
    let most = 0.04 * extent / largest;
    // Not finite: nothing has moved, or nothing is there.
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

/// x₀, z₀, x₁, z₁ of all corners; a unit square if there are none.
fn bounds(quads: &[Quad]) -> [f64; 4] {
    let corners = quads.iter().flat_map(|q| q.corners);
    let start = [
        f64::INFINITY,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NEG_INFINITY,
    ];
    let found = corners.fold(start, |b, [x, z]| {
        [b[0].min(x), b[1].min(z), b[2].max(x), b[3].max(z)]
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

fn escape(text: &str) -> String {
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
        // Of the two cubes one has compressive damage 0, the other 0.4: two lines of one cross, and
        // two in the legend.
        assert_eq!(svg.matches("<line").count(), 4);
        assert!(svg.contains("Two cubes &amp; a &lt;gap&gt;"));
    }

    #[test]
    fn corners_lie_at_their_magnified_places() {
        let model = fake::model();
        let mut frame = fake::frame(&model, 0.0);
        // The right cube moves by +1 mm in x and +0.5 mm in z; y does not show.
        for u in &mut frame.displacement[8..] {
            *u = [1.0, 7.0, 0.5];
        }
        let quads = quads(&model, &frame, 10.0);
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
        assert_eq!(magnification(&model, &frame), 1.0);
        for (moved, expected) in [
            (0.1, 50.0),
            (0.01, 500.0),
            (0.3, 20.0),
            (1.0, 5.0),
            (50.0, 1.0),
        ] {
            frame.displacement[3] = [0.0, 1e3, moved];
            assert_eq!(magnification(&model, &frame), expected, "{moved}");
        }
    }

    #[test]
    fn damage_goes_from_the_material_to_black() {
        assert_eq!(colour(0, 0.0), "#d6a082");
        assert_eq!(colour(0, 1.0), colour(1, 2.0));
        assert_eq!(colour(0, 1.0), "#140a0f");
    }
}
