//! A mode shape: the deformed bodies in parallel projection, coloured by the size of the displacement.
//!
//! ```text
//!   z│  y
//!    │ ╱     seen from the front, the right and above; faces are painted from the farthest to the nearest
//!    │╱
//!    └────x
//! ```

use std::fmt::Write as _;

use super::super::elevation::bounds;
use super::super::svg_text::escape;
use crate::element::exterior::{corners, exterior_faces};
use crate::model::Mesh;

const WIDTH: f64 = 900.0;
const MARGIN: f64 = 24.0;
const HEADER: f64 = 48.0;
/// Largest ratio of the height of the drawing to its width.
const TALLEST: f64 = 1.2;
/// Largest drawn displacement over the largest extent of the bodies.
const LARGEST: f64 = 0.08;
/// Angle of the view about z and above the horizon [rad]: 30° and 20°.
const TURN: [f64; 2] = [0.523_598_775_598_298_8, 0.349_065_850_398_865_9];

/// Colours at no displacement, in the middle and at the largest.
const COLOURS: [[f64; 3]; 3] = [[236., 232., 222.], [222., 150., 90.], [120., 20., 40.]];

/// Right, up and towards the viewer.
fn axes() -> [[f64; 3]; 3] {
    let [(s, c), (a, b)] = TURN.map(f64::sin_cos);
    [[c, s, 0.0], [-s * a, c * a, b], [s * b, -c * b, a]]
}

fn along(axis: [f64; 3], x: [f64; 3]) -> f64 {
    (0..3).map(|i| axis[i] * x[i]).sum()
}

/// A face on the drawing.
struct Face {
    corners: Vec<[f64; 2]>,
    depth: f64,
    size: f64,
}

/// The shape as SVG text. `shape` `[node][xyz]` has a largest displacement of 1.
pub fn shape(title: &str, caption: &str, mesh: &Mesh, shape: &[[f64; 3]]) -> String {
    let extents = [0, 1, 2].map(|i| {
        let [low, high] = mesh.extent(i);
        (high - low).max(0.0)
    });
    let scale = LARGEST * extents.into_iter().fold(0.0, f64::max);
    let rest = faces(mesh, shape, 0.0);
    let moved = faces(mesh, shape, scale);
    let all = rest.iter().chain(&moved).flat_map(|face| &face.corners);
    let [x0, y0, x1, y1] = bounds(all.copied());
    let (wide, tall) = (x1 - x0, y1 - y0);
    let zoom = (WIDTH - 2.0 * MARGIN) / wide.max(tall / TALLEST).max(f64::MIN_POSITIVE);
    let left = 0.5 * (WIDTH - wide * zoom);
    let place = |[x, y]: [f64; 2]| [left + (x - x0) * zoom, HEADER + (y1 - y) * zoom];
    let height = HEADER + tall * zoom + MARGIN;
    let mut svg = String::new();
    let drawn = draw(&mut svg, [title, caption], height, &[rest, moved], place);
    debug_assert!(drawn.is_ok(), "writing to a string does not fail");
    svg
}

/// Exterior faces of the bodies displaced by `scale` times the shape, the farthest first.
fn faces(mesh: &Mesh, shape: &[[f64; 3]], scale: f64) -> Vec<Face> {
    let [right, up, near] = axes();
    let exterior = exterior_faces(&mesh.elements, |e| mesh.unit[e]);
    let face = |(e, face): (u32, u8)| {
        let nodes = corners(&mesh.elements[e as usize], face).map(|n| n as usize);
        let at = nodes.map(|n| [0, 1, 2].map(|i| mesh.nodes[n][i] + scale * shape[n][i]));
        let size = nodes.map(|n| along(shape[n], shape[n]).sqrt());
        Face {
            corners: at.map(|x| [along(right, x), along(up, x)]).to_vec(),
            depth: at.iter().map(|x| along(near, *x)).sum(),
            size: size.iter().sum::<f64>() / 4.0,
        }
    };
    let mut faces: Vec<Face> = exterior.into_iter().map(face).filter(is_seen).collect();
    faces.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    faces
}

/// Whether the outer side of a face is towards the viewer: its corners go counter-clockwise.
fn is_seen(face: &Face) -> bool {
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| face.corners[k]);
    (c[0] - a[0]) * (d[1] - b[1]) - (c[1] - a[1]) * (d[0] - b[0]) > 0.0
}

fn draw(
    svg: &mut String,
    [title, caption]: [&str; 2],
    height: f64,
    [rest, moved]: &[Vec<Face>; 2],
    place: impl Fn([f64; 2]) -> [f64; 2],
) -> std::fmt::Result {
    writeln!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0}" height="{height:.0}" viewBox="0 0 {WIDTH:.0} {height:.0}" font-family="sans-serif">"#
    )?;
    writeln!(
        svg,
        r##"<rect width="100%" height="100%" fill="#ffffff"/>"##
    )?;
    let (title, caption) = (escape(title), escape(caption));
    writeln!(
        svg,
        r#"<text x="{MARGIN}" y="22" font-size="17">{title}</text>"#
    )?;
    writeln!(
        svg,
        r#"<text x="{MARGIN}" y="40" font-size="13">{caption}</text>"#
    )?;
    // At rest: pale, behind the moved bodies.
    writeln!(
        svg,
        r##"<g fill="#f4f4f4" stroke="#00000018" stroke-width="0.5">"##
    )?;
    for face in rest {
        writeln!(svg, r#"<path d="{}"/>"#, path(face, &place))?;
    }
    writeln!(svg, "</g>")?;
    writeln!(svg, r##"<g stroke="#00000050" stroke-width="0.4">"##)?;
    for face in moved {
        let fill = colour(face.size);
        writeln!(svg, r#"<path fill="{fill}" d="{}"/>"#, path(face, &place))?;
    }
    writeln!(svg, "</g>")?;
    writeln!(svg, "</svg>")
}

fn path(face: &Face, place: impl Fn([f64; 2]) -> [f64; 2]) -> String {
    let corners = face.corners.iter().map(|corner| {
        let [x, y] = place(*corner);
        format!("{x:.1} {y:.1}")
    });
    format!("M{}Z", corners.collect::<Vec<_>>().join("L"))
}

fn colour(size: f64) -> String {
    let at = 2.0 * size.clamp(0.0, 1.0);
    let first = usize::from(at >= 1.0);
    let part = at - first as f64;
    let mix = |i: usize| COLOURS[first][i] + part * (COLOURS[first + 1][i] - COLOURS[first][i]);
    format!("rgb({:.0},{:.0},{:.0})", mix(0), mix(1), mix(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    #[test]
    fn faces_towards_the_viewer_are_drawn_at_rest_and_moved() {
        let mesh = fake::model().mesh;
        let mut moved = vec![[0.0; 3]; mesh.nodes.len()];
        moved[15] = [0.0, 1.0, 0.0];
        let svg = shape("a <wall>", "mode 1", &mesh, &moved);
        // Two cubes, three faces of each.
        assert_eq!(svg.matches("<path ").count(), 12);
        assert!(svg.contains("a &lt;wall&gt;"), "{svg}");
        assert_ne!(colour(0.0), colour(1.0));
    }
}
