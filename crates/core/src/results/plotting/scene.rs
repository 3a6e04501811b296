//! A model before the run: an elevation, a vertical section and plans.
//!
//! ```text
//!   ┌────────────┐ ┌──┐
//!   │ elevation  │ │ s│   s: section across the middle of the length; plans through the lowest two
//!   └────────────┘ └──┘   courses of walls, or at half the height
//!   ├────────────┤        colours by material, interfaces and supports marked
//! ```

use std::fmt::Write as _;

use super::super::colours::{self, hex};
use super::super::elevation;
use super::super::svg_text::escape;
use crate::element::exterior::{corners, exterior_faces};
use crate::element::hexahedron::{EDGES, range};
use crate::model::scene::{HeldBy, Support};
use crate::model::ties::Tie;
use crate::model::{Mesh, Model};

/// Width of the page [px].
const WIDTH: f64 = 1100.0;
const MARGIN: f64 = 24.0;
const HEADER: f64 = 48.0;
const CAPTION: f64 = 22.0;
/// Space between the elevation and the section [px].
const GAP: f64 = 36.0;
/// Width of a caption [px].
const NARROWEST: f64 = 170.0;
/// Height of the tallest drawing [px].
const TALLEST: f64 = 900.0;

/// Colours of interfaces.
const INTERFACES: [&str; 6] = [
    "#c02020", "#2060c0", "#208040", "#a05000", "#8030a0", "#007f8f",
];

/// Style of planes of symmetry: chain lines, as in technical drawings.
const PLANE_STROKE: &str =
    r##"stroke="#111111" stroke-width="1.2" stroke-dasharray="12 3 2 3" fill="none""##;
/// Style of ties.
const TIE_STROKE: &str = r##"stroke="#4b0082" stroke-width="2.5" fill="none""##;
/// Length by which planes extend beyond the bodies [px].
const BEYOND: f64 = 10.0;

/// A drawing in its own plane [mm].
struct Panel {
    caption: String,
    polygons: Vec<Polygon>,
    /// `[end][right, up]`, and index of the interface.
    lines: Vec<([[f64; 2]; 2], usize)>,
    /// Fixed nodes.
    dots: Vec<[f64; 2]>,
    /// Planes of symmetry: their normal, right (0) or up (1), and position.
    planes: Vec<(usize, f64)>,
    /// Segments of ties, seen through the bodies. `[end][right, up]`
    ties: Vec<[[f64; 2]; 2]>,
}

struct Polygon {
    corners: Vec<[f64; 2]>,
    material: usize,
    /// Distance from the viewer; farther polygons are drawn first.
    depth: f64,
}

impl Panel {
    /// x₀, y₀, x₁, y₁ of the polygons.
    fn bounds(&self) -> [f64; 4] {
        elevation::bounds(self.polygons.iter().flat_map(|p| &p.corners).copied())
    }
}

/// The scene as SVG text.
pub fn scene(model: &Model) -> String {
    let names = interface_names(model);
    let front = elevation(model, &names);
    let [x0, _, x1, _] = front.bounds();
    let across = section(model, &names, 0, 0.5 * (x0 + x1));
    let plans = heights(model)
        .into_iter()
        .map(|z| section(model, &names, 2, z));
    let mut panels = vec![front, across];
    panels.extend(plans);
    let mut svg = String::new();
    let drawn = page(&mut svg, model, &names, &panels);
    debug_assert!(drawn.is_ok(), "writing to a string does not fail");
    svg
}

/// Names of the interfaces, each once, in the order of the laws.
fn interface_names(model: &Model) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for name in &model.contact.law_names {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// Index in `names` of the interface of a slave facet.
fn interface_of(model: &Model, names: &[&str], facet: usize) -> usize {
    let law = usize::from(model.contact.slave_law[facet]);
    let name = model.contact.law_names[law].as_str();
    names.iter().position(|n| *n == name).unwrap_or(0)
}

/// Heights of the plans: within the two lowest courses, or at mid-height without courses.
fn heights(model: &Model) -> Vec<f64> {
    let mesh = &model.mesh;
    let extent = |of: &dyn Fn(usize) -> bool| {
        let elements = (0..mesh.elements.len()).filter(|e| of(*e));
        let nodes = elements.flat_map(|e| mesh.elements[e]);
        range(nodes.map(|n| mesh.nodes[n as usize][2]))
    };
    let courses = mesh.course.iter().max().map_or(0, |c| *c);
    if courses == 0 {
        let [low, high] = extent(&|_| true);
        return vec![0.5 * (low + high)];
    }
    // Slightly below the middle: at half the height above a bed joint, thin units would be cut in their mortar.
    let middle = |course: u16| {
        let [low, high] = extent(&|e| mesh.course[e] == course);
        low + 0.4 * (high - low)
    };
    // Blocks belong to course 0 and may be taller than the courses.
    vec![middle(0), middle(1)]
}

/// Boundary facets with their elements, counter-clockwise seen from outside.
fn bare_faces(mesh: &Mesh) -> Vec<(usize, [u32; 4])> {
    let faces = exterior_faces(&mesh.elements, |_| 0).into_iter();
    faces
        .map(|(e, face)| (e as usize, corners(&mesh.elements[e as usize], face)))
        .collect()
}

/// Elevation seen from the front, from −y.
fn elevation(model: &Model, names: &[&str]) -> Panel {
    let mesh = &model.mesh;
    let x = |n: u32| mesh.nodes[n as usize];
    let flat = |n: u32| [x(n)[0], x(n)[2]];
    let mut polygons = Vec::new();
    for (element, facet) in bare_faces(mesh) {
        let corners = facet.map(flat);
        // Twice the signed area, positive if counter-clockwise seen from −y with x to the right and z up.
        let area: f64 = (0..4)
            .map(|k| {
                let ([a, b], [c, d]) = (corners[k], corners[(k + 1) % 4]);
                a * d - b * c
            })
            .sum();
        if area > 0.0 {
            polygons.push(Polygon {
                corners: corners.into(),
                material: usize::from(mesh.material[element]),
                depth: facet.iter().map(|n| x(*n)[1]).sum::<f64>() / 4.0,
            });
        }
    }
    polygons.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    let [front, back] = mesh.extent(1);
    let near = front + 1e-6 * (back - front);
    let mut lines = Vec::new();
    for (f, facet) in model.contact.whole_slaves() {
        for k in 0..4 {
            let ends = [facet[k], facet[(k + 1) % 4]];
            if ends.iter().all(|n| x(*n)[1] <= near) {
                lines.push((ends.map(flat), interface_of(model, names, f)));
            }
        }
    }
    let supports = model.supports.iter().filter(|s| s.by == HeldBy::Ground);
    let held = supports.flat_map(|s| &s.nodes);
    let dots = held
        .filter(|n| x(**n)[1] <= near)
        .map(|n| flat(*n))
        .collect();
    Panel {
        caption: "elevation, from the front".to_owned(),
        polygons,
        lines,
        dots,
        planes: planes(model, [0, 2]),
        ties: ties(model, [0, 2]),
    }
}

/// Planes of symmetry parallel to the line of sight; `axes` are the axes of the drawing.
fn planes(model: &Model, axes: [usize; 2]) -> Vec<(usize, f64)> {
    let stands = |support: &Support| match support.by {
        HeldBy::Plane { axis, at } => Some((axes.iter().position(|a| *a == axis)?, at)),
        HeldBy::Ground | HeldBy::Mirror => None,
    };
    model.supports.iter().filter_map(stands).collect()
}

/// Segments of ties along the axes of the drawing.
fn ties(model: &Model, axes: [usize; 2]) -> Vec<[[f64; 2]; 2]> {
    let segments = model.ties.iter().flat_map(Tie::segments);
    segments
        .map(|ends| ends.map(|end| axes.map(|d| end.at[d])))
        .collect()
}

/// Section normal to an axis at a position on it [mm].
fn section(model: &Model, names: &[&str], axis: usize, at: f64) -> Panel {
    let mesh = &model.mesh;
    // Vertical sections are seen from +x (y to the right), plans from above.
    let axes = if axis == 0 { [1, 2] } else { [0, 1] };
    let x = |n: u32| mesh.nodes[n as usize];
    let cut = |a: u32, b: u32| {
        let (p, q) = (x(a), x(b));
        let (s, t) = (p[axis] - at, q[axis] - at);
        ((s < 0.0) != (t < 0.0)).then(|| axes.map(|d| p[d] + (q[d] - p[d]) * s / (s - t)))
    };
    let mut polygons = Vec::new();
    for (e, nodes) in mesh.elements.iter().enumerate() {
        let mut corners: Vec<[f64; 2]> = EDGES
            .iter()
            .filter_map(|[a, b]| cut(nodes[*a], nodes[*b]))
            .collect();
        if corners.len() < 3 {
            continue;
        }
        let count = corners.len() as f64;
        let middle = [0, 1].map(|d| corners.iter().map(|c| c[d]).sum::<f64>() / count);
        let angle = |c: &[f64; 2]| (c[1] - middle[1]).atan2(c[0] - middle[0]);
        corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        polygons.push(Polygon {
            corners,
            material: usize::from(mesh.material[e]),
            depth: 0.0,
        });
    }
    let mut lines = Vec::new();
    for (f, facet) in model.contact.whole_slaves() {
        let ends: Vec<[f64; 2]> = (0..4)
            .filter_map(|k| cut(facet[k], facet[(k + 1) % 4]))
            .collect();
        if let [a, b] = ends[..] {
            lines.push(([a, b], interface_of(model, names, f)));
        }
    }
    let letter = ["x", "y", "z"][axis];
    let what = if axis == 2 { "plan" } else { "section" };
    Panel {
        caption: format!("{what} at {letter} = {at:.1} mm"),
        polygons,
        lines,
        dots: Vec::new(),
        planes: planes(model, axes),
        ties: ties(model, axes),
    }
}

/// Places of the panels on a page.
struct Layout {
    /// Pixels per millimetre.
    zoom: f64,
    /// Lower left corners [px]. `[panel][xy]`
    places: Vec<[f64; 2]>,
    /// Top of the legend [px].
    legend: f64,
}

impl Layout {
    /// Panels at one scale: elevation and section side by side, plans below.
    fn of(panels: &[Panel]) -> Self {
        let size = |p: &Panel| {
            let [x0, y0, x1, y1] = p.bounds();
            [x1 - x0, y1 - y0].map(|side| side.max(f64::MIN_POSITIVE))
        };
        let sizes: Vec<[f64; 2]> = panels.iter().map(size).collect();
        // A narrow section needs space for its caption.
        let wide = ((WIDTH - 2.0 * MARGIN - GAP) / (sizes[0][0] + sizes[1][0]))
            .min((WIDTH - 2.0 * MARGIN - GAP - NARROWEST) / sizes[0][0]);
        let plans_wide = sizes[2..].iter().map(|s| (WIDTH - 2.0 * MARGIN) / s[0]);
        let zoom = plans_wide.fold(wide.min(TALLEST / sizes[0][1].max(sizes[1][1])), f64::min);
        let mut y = HEADER + CAPTION;
        let tall = sizes[0][1].max(sizes[1][1]) * zoom;
        let mut places = vec![
            [MARGIN, y + tall],
            [MARGIN + sizes[0][0] * zoom + GAP, y + tall],
        ];
        y += tall;
        for size in &sizes[2..] {
            y += CAPTION + GAP / 2.0 + size[1] * zoom;
            places.push([MARGIN, y]);
        }
        Self {
            zoom,
            places,
            legend: y + 30.0,
        }
    }
}

/// Draws the panels and their legend.
fn page(svg: &mut String, model: &Model, names: &[&str], panels: &[Panel]) -> std::fmt::Result {
    let layout = Layout::of(panels);
    let rows = model.materials.len().max(names.len() + 3) as f64;
    let height = layout.legend + 20.0 * rows + MARGIN;
    writeln!(
        svg,
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0}" height="{height:.0}" viewBox="0 0 {WIDTH:.0} {height:.0}" font-family="sans-serif"><rect width="100%" height="100%" fill="#ffffff"/>"##
    )?;
    writeln!(
        svg,
        r#"<text x="{MARGIN}" y="28" font-size="18">{}</text>"#,
        escape(&model.title)
    )?;
    for (panel, place) in panels.iter().zip(layout.places) {
        draw(svg, panel, place, layout.zoom)?;
    }
    for (m, material) in model.materials.iter().enumerate() {
        let y = layout.legend + 20.0 * m as f64;
        let fill = hex(colours::material(m));
        writeln!(
            svg,
            r##"<rect x="{MARGIN}" y="{y:.0}" width="14" height="14" fill="{fill}" stroke="#444444" stroke-width="0.5"/><text x="{:.0}" y="{:.0}" font-size="13">{}</text>"##,
            MARGIN + 22.0,
            y + 12.0,
            escape(&material.name)
        )?;
    }
    let held = |s: &Support| !s.nodes.is_empty() && s.by == HeldBy::Ground;
    let held = model.supports.iter().any(held);
    let mirrored = panels.iter().any(|p| !p.planes.is_empty());
    let marks = [held, mirrored, !model.ties.is_empty()];
    legend_of_lines(svg, layout.legend, names, marks)?;
    writeln!(svg, "</svg>")
}

/// Writes the legend of the interfaces, of held nodes, of planes of symmetry and of ties, if there are any.
fn legend_of_lines(
    svg: &mut String,
    top: f64,
    names: &[&str],
    [held, mirrored, tied]: [bool; 3],
) -> std::fmt::Result {
    let left = WIDTH / 2.0;
    let line =
        |stroke: String| move |y: f64| format!(r#"<path d="M{left:.0} {y:.0}h24" {stroke}/>"#);
    let mut row = 0.0;
    let mut entry = |mark: &dyn Fn(f64) -> String, text: &str| {
        let y = top + 20.0 * row + 7.0;
        row += 1.0;
        writeln!(
            svg,
            r#"{}<text x="{:.0}" y="{:.0}" font-size="13">{text}</text>"#,
            mark(y),
            left + 32.0,
            y + 5.0
        )
    };
    for (i, name) in names.iter().enumerate() {
        let stroke = INTERFACES[i % INTERFACES.len()];
        let stroke = format!(r#"stroke="{stroke}" stroke-width="2""#);
        entry(&line(stroke), &format!("interface {}", escape(name)))?;
    }
    if held {
        let dot = |y: f64| format!(r#"<circle cx="{:.0}" cy="{y:.0}" r="2.5"/>"#, left + 12.0);
        entry(&dot, "held")?;
    }
    if mirrored {
        entry(&line(PLANE_STROKE.to_owned()), "plane of symmetry")?;
    }
    if tied {
        entry(&line(TIE_STROKE.to_owned()), "tie")?;
    }
    Ok(())
}

/// Draws a panel with its lower left corner at `place` [px].
fn draw(svg: &mut String, panel: &Panel, [left, low]: [f64; 2], zoom: f64) -> std::fmt::Result {
    let [x0, y0, x1, y1] = panel.bounds();
    let at = |[x, y]: [f64; 2]| (left + (x - x0) * zoom, low - (y - y0) * zoom);
    writeln!(
        svg,
        r#"<text x="{left:.0}" y="{:.0}" font-size="13">{}</text>"#,
        low - (y1 - y0) * zoom - 7.0,
        escape(&panel.caption)
    )?;
    writeln!(svg, r##"<g stroke="#00000055" stroke-width="0.4">"##)?;
    for polygon in &panel.polygons {
        let fill = hex(colours::material(polygon.material));
        let points: Vec<String> = polygon
            .corners
            .iter()
            .map(|c| at(*c))
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        writeln!(
            svg,
            r#"<polygon points="{}" fill="{fill}"/>"#,
            points.join(" ")
        )?;
    }
    writeln!(svg, "</g>")?;
    for (i, stroke) in INTERFACES.iter().enumerate() {
        let own = panel
            .lines
            .iter()
            .filter(|(_, n)| n % INTERFACES.len() == i);
        let mut path = String::new();
        for ([a, b], _) in own {
            let ((x1, y1), (x2, y2)) = (at(*a), at(*b));
            write!(path, "M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}")?;
        }
        if !path.is_empty() {
            writeln!(
                svg,
                r#"<path d="{path}" stroke="{stroke}" stroke-width="1.2"/>"#
            )?;
        }
    }
    draw_ties(svg, &panel.ties, at)?;
    for dot in &panel.dots {
        let (x, y) = at(*dot);
        writeln!(svg, r#"<circle cx="{x:.1}" cy="{y:.1}" r="2"/>"#)?;
    }
    for &(d, place) in &panel.planes {
        let ends = if d == 0 {
            [[place, y0], [place, y1]]
        } else {
            [[x0, place], [x1, place]]
        };
        draw_plane(svg, d, ends.map(at))?;
    }
    Ok(())
}

/// Draws segments of ties; `at` gives pixels.
fn draw_ties(
    svg: &mut String,
    ties: &[[[f64; 2]; 2]],
    at: impl Fn([f64; 2]) -> (f64, f64),
) -> std::fmt::Result {
    for ends in ties {
        let [(x1, y1), (x2, y2)] = ends.map(&at);
        writeln!(
            svg,
            r#"<path d="M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}" {TIE_STROKE}/>"#
        )?;
    }
    Ok(())
}

/// Draws a plane of symmetry between two points [px]; the line extends beyond the bodies to be recognisable.
fn draw_plane(svg: &mut String, d: usize, [mut a, mut b]: [(f64, f64); 2]) -> std::fmt::Result {
    if d == 0 {
        (a.1, b.1) = (a.1 + BEYOND, b.1 - BEYOND);
    } else {
        (a.0, b.0) = (a.0 - BEYOND, b.0 + BEYOND);
    }
    writeln!(
        svg,
        r#"<path d="M{:.1} {:.1}L{:.1} {:.1}" {PLANE_STROKE}/>"#,
        a.0, a.1, b.0, b.1
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    /// Two cubes of 100 mm at a distance of 2 mm: one square each from the front, and only one of them in the
    /// section.
    #[test]
    fn each_panel_shows_its_section() {
        let model = fake::model();
        let front = elevation(&model, &interface_names(&model));
        assert_eq!(front.polygons.len(), 2);
        assert_eq!(front.bounds(), [0.0, 0.0, 202.0, 100.0]);
        let cut = section(&model, &[], 0, 50.0);
        assert_eq!(cut.polygons.len(), 1);
        assert_eq!(cut.polygons[0].corners.len(), 4);
        assert_eq!(section(&model, &[], 0, 101.0).polygons.len(), 0);
        assert_eq!(section(&model, &[], 2, 50.0).polygons.len(), 2);
        let svg = scene(&model);
        assert!(svg.contains("section at x = 101.0 mm") && svg.contains("Two cubes &amp; a"));
    }
}
