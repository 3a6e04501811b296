//! Pictures of a wall at a frame, deformed, with its cracks: outside from any direction, or a section.
//!
//! ```text
//!   title                           frame 12: 2.0 mm, 105.84 kN
//!   front, seen from −y                   displacements × 50
//!        ▼ top: 30 kN                    shapes: faces of the solids, cracks in them, joints,
//!   ┌────┬─────────┐  ┬                           drawn from far to near
//!   │    ╱    │    │  │ 1000 mm         symbols: loads, drives, supports, dimensions
//!   ├──╱─┬────┴────┤  │
//!   └────┴─────────┘  ┴
//!    △ △ △ △ △ △ △ △
//!   legend: damage, states of joints, widths of cracks; scale bar
//! ```

mod legend;
mod shapes;
mod symbols;
mod view;

use std::fmt::Write as _;

pub use view::View;

use super::colours::{self, CRACKED, CRUSHED, hex};
use super::elevation::{bounds, magnification};
use super::svg_text::escape;
use super::{ReadError, Snapshot};
use crate::model::Model;
use legend::Widths;
use shapes::{Kind, Scene, Shape};
use symbols::Symbols;

/// Width of the picture [px].
const WIDTH: f64 = 960.0;
/// Space beside the wall, for dimensions and loads [px].
const BESIDE: f64 = 74.0;
const MARGIN: f64 = 24.0;
/// Height of the title, and space above the wall [px].
const HEADER: f64 = 100.0;
/// Space below the wall, for supports and dimensions [px].
const BELOW: f64 = 66.0;
/// Largest ratio of the height of the drawing to its width.
const TALLEST: f64 = 1.1;

/// How to draw a wall.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// From where.
    pub view: View,
    /// Magnification of displacements; `None`: a round one that moves nothing too far.
    pub scale: Option<f64>,
    /// Bounds that several pictures share; `None`: those of the picture.
    pub window: Option<Window>,
}

/// Bounds of the drawing and the scale of the crack widths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Left, low, right, high in the directions of the view [mm].
    pub bounds: [f64; 4],
    /// Width of the widest crack [mm].
    pub widest: f64,
}

impl Window {
    /// The smallest window around two.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (self.bounds, other.bounds);
        Self {
            bounds: [a.min(e), b.min(f), c.max(g), d.max(h)],
            widest: self.widest.max(other.widest),
        }
    }
}

/// Bounds of the wall at a frame.
///
/// # Errors
/// [`ReadError::NoSection`].
pub fn window(snapshot: &Snapshot, look: &Look) -> Result<Window, ReadError> {
    let scale = scale_of(snapshot, look);
    let scene = scene(snapshot, look, scale);
    let shapes = scene.shapes(&look.view)?;
    Ok(Window {
        bounds: bounds_of(&shapes),
        widest: scene.widest(),
    })
}

/// The wall at a frame as SVG text. With the model its supports, drives and loads are drawn as well.
///
/// # Errors
/// [`ReadError::NoSection`]: no element lies at the section.
pub fn wall_picture(
    snapshot: &Snapshot,
    model: Option<&Model>,
    look: &Look,
) -> Result<String, ReadError> {
    let scale = scale_of(snapshot, look);
    let scene = scene(snapshot, look, scale);
    let shapes = scene.shapes(&look.view)?;
    let window = look.window.unwrap_or_else(|| Window {
        bounds: bounds_of(&shapes),
        widest: scene.widest(),
    });
    let [x0, z0, x1, z1] = window.bounds;
    let (length, tall) = (x1 - x0, z1 - z0);
    let room = WIDTH - 2.0 * BESIDE;
    // Limits the height of the picture of a slender wall.
    let zoom = room / length.max(tall / TALLEST).max(f64::MIN_POSITIVE);
    let page = Page {
        zoom,
        left: 0.5 * (WIDTH - length * zoom),
        corner: [x0, z1],
        low: HEADER + tall * zoom,
    };
    let symbols = Symbols::of(&scene, model, look);
    let widths = Widths::of(window.widest);
    let legend = legend::Legend::of(&shapes, &widths);
    let mut svg = String::new();
    let height = page.low + BELOW + legend.height();
    let drawn = head(&mut svg, height, snapshot, &told(&look.view, scale))
        .and_then(|()| symbols.behind(&mut svg, &page))
        .and_then(|()| draw(&mut svg, &shapes, &page, &widths))
        .and_then(|()| symbols.before(&mut svg, &page))
        .and_then(|()| legend.draw(&mut svg, page.low + BELOW))
        .and_then(|()| {
            if look.view.is_square() {
                symbols::scale_bar(&mut svg, &page, page.low + BELOW)
            } else {
                Ok(())
            }
        });
    debug_assert!(drawn.is_ok(), "writing to a string does not fail");
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn scale_of(snapshot: &Snapshot, look: &Look) -> f64 {
    look.scale
        .unwrap_or_else(|| magnification(&snapshot.mesh, &snapshot.frame))
}

fn scene<'a>(snapshot: &'a Snapshot, look: &Look, scale: f64) -> Scene<'a> {
    Scene {
        snapshot,
        camera: look.view.camera(),
        scale,
        shaded: !look.view.is_square(),
    }
}

fn bounds_of(shapes: &[Shape]) -> [f64; 4] {
    let solids = shapes
        .iter()
        .filter(|s| matches!(s.kind, Kind::Solid { .. }));
    bounds(solids.flat_map(|s| s.corners.iter().copied()))
}

fn told(view: &View, scale: f64) -> [String; 2] {
    [view.told(), format!("displacements × {scale}")]
}

/// From the directions of the view [mm] to the picture [px].
struct Page {
    /// Pixels a millimetre.
    zoom: f64,
    left: f64,
    /// Left and high end [mm].
    corner: [f64; 2],
    /// Lowest place of the wall [px].
    low: f64,
}

impl Page {
    fn place(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        [
            self.left + (x - self.corner[0]) * self.zoom,
            HEADER + (self.corner[1] - z) * self.zoom,
        ]
    }
}

fn head(
    svg: &mut String,
    height: f64,
    snapshot: &Snapshot,
    [view, scale]: &[String; 2],
) -> std::fmt::Result {
    writeln!(
        svg,
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:.0}" height="{height:.0}" viewBox="0 0 {WIDTH:.0} {height:.0}" font-family="sans-serif"><rect width="100%" height="100%" fill="#ffffff"/>"##
    )?;
    // A long title would run into the caption.
    let (title, caption) = (&snapshot.title, snapshot.caption());
    let title: String = match title.chars().count() {
        0..=60 => title.clone(),
        _ => title.chars().take(59).chain(['…']).collect(),
    };
    let right = WIDTH - MARGIN;
    writeln!(
        svg,
        r##"<text x="{MARGIN}" y="28" font-size="18">{}</text><text x="{right}" y="28" font-size="14" text-anchor="end">{}</text><text x="{MARGIN}" y="48" font-size="13" fill="#505050">{}</text><text x="{right}" y="48" font-size="13" fill="#505050" text-anchor="end">{}</text>"##,
        escape(&title),
        escape(&caption),
        escape(view),
        escape(scale)
    )
}

/// Draws the shapes from far to near.
fn draw(svg: &mut String, shapes: &[Shape], page: &Page, widths: &Widths) -> std::fmt::Result {
    writeln!(
        svg,
        r#"<g class="wall" stroke-linecap="round" stroke-linejoin="round">"#
    )?;
    for shape in shapes {
        let places = shape.corners.iter().map(|c| page.place(*c));
        let points: Vec<String> = places.map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
        match shape.kind {
            Kind::Solid { fill, crushed } => {
                // Thin lines show the mesh without hiding the damage.
                writeln!(
                    svg,
                    r##"<polygon points="{}" fill="{}" stroke="#00000033" stroke-width="0.4"/>"##,
                    points.join(" "),
                    hex(fill)
                )?;
                if crushed {
                    cross(svg, &points)?;
                }
            }
            Kind::Crack { width } => line(svg, &points, &hex(CRACKED), widths.pixels(width, 0.7))?,
            Kind::Joint { state, width } => {
                use crate::state::InterfaceState::{FailedOpen, FailedSliding, Intact, Softening};
                let least = match state {
                    Intact => 0.6,
                    Softening => 1.3,
                    FailedSliding => 1.8,
                    FailedOpen => 1.4,
                };
                let colour = match state {
                    Intact => "#00000070".to_owned(),
                    state => hex(colours::state(state)),
                };
                let wide = match state {
                    Intact | FailedSliding => least,
                    Softening | FailedOpen => widths.pixels(width, least),
                };
                line(svg, &points, &colour, wide)?;
            }
        }
    }
    writeln!(svg, "</g>")
}

fn line(svg: &mut String, ends: &[String], colour: &str, width: f64) -> std::fmt::Result {
    writeln!(
        svg,
        r#"<path d="M{}" stroke="{colour}" stroke-width="{width:.2}"/>"#,
        ends.join("L")
    )
}

/// Both diagonals of a crushed element.
fn cross(svg: &mut String, corners: &[String]) -> std::fmt::Result {
    if let [a, b, c, d, ..] = corners {
        writeln!(
            svg,
            r#"<path class="crushed" d="M{a}L{c}M{b}L{d}" stroke="{}" stroke-width="1.4"/>"#,
            hex(CRUSHED)
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
