//! Supports, drives, loads, dimensions and the scale bar.

use std::fmt::Write as _;

use super::shapes::Scene;
use super::view::dot;
use super::{Look, Page, WIDTH};
use crate::model::Model;
use crate::model::loads::LoadOn;
use crate::model::scene::{BeamMotion, HeldBy, Step};
use crate::results::elevation::bounds;
use crate::results::svg_text::{escape, width};

/// Least distance between two marks of supports [px].
const APART: f64 = 11.0;
/// Length of an arrow [px].
const ARROW: f64 = 30.0;
/// Part of a direction across the line of sight below which it counts as along it.
const ACROSS: f64 = 0.35;
const SUPPORT: &str = "#5a5a5a";
const LOAD: &str = "#1f4e79";

/// A force or a drive.
struct Arrow {
    /// Where it acts [mm], displaced.
    at: [f64; 2],
    /// Direction to the right and up, and towards the viewer.
    along: [f64; 3],
    text: String,
}

/// All that is drawn around a wall.
pub(super) struct Symbols {
    /// Nodes that stand on a support, and those held otherwise [mm].
    stands: Vec<[f64; 2]>,
    held: Vec<[f64; 2]>,
    arrows: Vec<Arrow>,
    /// Bounds at rest, if the picture has their true lengths [mm].
    rest: Option<[f64; 4]>,
}

impl Symbols {
    pub fn of(scene: &Scene<'_>, model: Option<&Model>, look: &Look) -> Self {
        let mesh = &scene.snapshot.mesh;
        let flat = mesh.nodes.iter().map(|x| scene.camera.flat(*x));
        let mut symbols = Self {
            stands: Vec::new(),
            held: Vec::new(),
            arrows: Vec::new(),
            rest: look.view.is_square().then(|| bounds(flat)),
        };
        if let Some(model) = model.filter(|m| m.mesh.nodes.len() == mesh.nodes.len()) {
            symbols.supports(scene, model);
            symbols.loads(scene, model);
        }
        symbols
    }

    fn supports(&mut self, scene: &Scene<'_>, model: &Model) {
        let z = |n: &u32| model.mesh.nodes[*n as usize][2];
        for support in model.supports.iter().filter(|s| s.by == HeldBy::Ground) {
            let lowest = support.nodes.iter().map(z).fold(f64::INFINITY, f64::min);
            for n in &support.nodes {
                let below = support.fixed[2] && z(n) <= lowest + 1e-6;
                let list = if below {
                    &mut self.stands
                } else {
                    &mut self.held
                };
                list.push(displaced(scene, *n));
            }
        }
    }

    fn loads(&mut self, scene: &Scene<'_>, model: &Model) {
        let snapshot = scene.snapshot;
        let last = model.steps.len().saturating_sub(1);
        let at = snapshot.row.as_ref().map_or(last, |row| row.step);
        let Some(step) = model.steps.get(at) else {
            return;
        };
        for (b, beam) in model.beams.iter().enumerate() {
            for (axis, motion) in step.motion.get(b).into_iter().flatten().enumerate() {
                let (sense, said) = match *motion {
                    BeamMotion::Locked => continue,
                    BeamMotion::Force(force) => (force, format!("{:.4} kN", 1e-3 * force.abs())),
                    BeamMotion::Driven(by) => (by, "drive".to_owned()),
                };
                if sense != 0.0 {
                    let mut along = [0.0; 3];
                    along[axis] = sense.signum();
                    self.arrow(scene, &beam.nodes, along, said);
                }
            }
        }
        for (spring, by) in model.springs.iter().zip(&step.springs) {
            if *by != [0.0; 3] {
                self.arrow(scene, &spring.nodes, unit(*by), "drive".to_owned());
            }
        }
        self.named_loads(scene, model, at, step);
    }

    fn named_loads(&mut self, scene: &Scene<'_>, model: &Model, at: usize, step: &Step) {
        for (l, load) in model.loads.iter().enumerate() {
            let of = |step: &Step| step.loads.get(l).copied().flatten();
            let value = of(step).or_else(|| model.steps[..at].iter().rev().find_map(of));
            if value.is_none_or(|value| value == [0.0; 3]) {
                continue;
            }
            let nodes: Vec<u32> = match &load.acts {
                LoadOn::Follower(facets) => facets.as_flattened().to_vec(),
                LoadOn::Pressure(shares) => shares.iter().map(|s| s.0).collect(),
                LoadOn::Shares(shares) => shares.iter().map(|s| s.0).collect(),
            };
            self.arrow(scene, &nodes, load.direction, load.name.clone());
        }
    }

    /// An arrow at the middle of these nodes.
    fn arrow(&mut self, scene: &Scene<'_>, nodes: &[u32], along: [f64; 3], text: String) {
        if nodes.is_empty() || along == [0.0; 3] {
            return;
        }
        let places = bounds(nodes.iter().map(|n| displaced(scene, *n)));
        let camera = &scene.camera;
        self.arrows.push(Arrow {
            at: [0.5 * (places[0] + places[2]), 0.5 * (places[1] + places[3])],
            along: [
                dot(camera.right, along),
                dot(camera.up, along),
                dot(camera.toward, along),
            ],
            text,
        });
    }

    /// Draws what the wall covers.
    pub fn behind(&self, svg: &mut String, page: &Page) -> std::fmt::Result {
        if self.rest.is_none() {
            // Seen obliquely, most held nodes are hidden.
            self.draw_held(svg, page)?;
        }
        let mut path = String::new();
        for [x, y] in spread(&self.stands, page) {
            write!(path, "M{x:.2} {y:.2}l-5 9h10z")?;
        }
        if path.is_empty() {
            return Ok(());
        }
        writeln!(
            svg,
            r##"<path class="support" d="{path}" fill="#ffffff" stroke="{SUPPORT}" stroke-width="1"/>"##
        )
    }

    fn draw_held(&self, svg: &mut String, page: &Page) -> std::fmt::Result {
        for [x, y] in spread(&self.held, page) {
            writeln!(
                svg,
                r##"<circle class="support" cx="{x:.2}" cy="{y:.2}" r="2.8" fill="#ffffff" stroke="{SUPPORT}" stroke-width="1"/>"##
            )?;
        }
        Ok(())
    }

    /// Draws what lies before the wall and around it.
    pub fn before(&self, svg: &mut String, page: &Page) -> std::fmt::Result {
        if self.rest.is_some() {
            self.draw_held(svg, page)?;
        }
        if let Some([x0, z0, x1, z1]) = self.rest {
            let ([left, top], [right, low]) = (page.place([x0, z1]), page.place([x1, z0]));
            let across = format!("{} mm", round(x1 - x0));
            let tall = format!("{} mm", round(z1 - z0));
            dimension(svg, [left, right], page.low + 34.0, &across)?;
            let x = left.min(page.left) - 34.0;
            writeln!(
                svg,
                r#"<g transform="translate({x:.2} {low:.2}) rotate(-90)">"#
            )?;
            dimension(svg, [0.0, low - top], 0.0, &tall)?;
            writeln!(svg, "</g>")?;
        }
        // Texts of arrows at the same place stand above each other.
        let mut taken: Vec<[f64; 2]> = Vec::new();
        for arrow in &self.arrows {
            draw_arrow(svg, arrow, page, &mut taken)?;
        }
        Ok(())
    }
}

fn displaced(scene: &Scene<'_>, n: u32) -> [f64; 2] {
    let (x, u) = (
        scene.snapshot.mesh.nodes[n as usize],
        scene.snapshot.frame.displacement[n as usize],
    );
    scene
        .camera
        .flat([0, 1, 2].map(|i| x[i] + scene.scale * u[i]))
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

/// Places in the picture that are not too near to each other.
fn spread(of: &[[f64; 2]], page: &Page) -> Vec<[f64; 2]> {
    let mut places: Vec<[f64; 2]> = of.iter().map(|x| page.place(*x)).collect();
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for [x, y] in places {
        // Sorted by x, so only the last ones can be near.
        let near = kept.iter().rev().take_while(|k| x - k[0] < APART);
        if near
            .into_iter()
            .all(|k| (x - k[0]).hypot(y - k[1]) >= APART)
        {
            kept.push([x, y]);
        }
    }
    kept
}

/// A length to a tenth of a millimetre.
fn round(length: f64) -> f64 {
    (10.0 * length).round() / 10.0
}

/// A line between two ticks with its text above.
fn dimension(svg: &mut String, [from, to]: [f64; 2], y: f64, text: &str) -> std::fmt::Result {
    writeln!(
        svg,
        r##"<g class="dimension" stroke="#606060" stroke-width="0.8"><path d="M{from:.2} {y:.2}H{to:.2}M{from:.2} {:.2}v10M{to:.2} {:.2}v10"/><text x="{:.2}" y="{:.2}" font-size="12" fill="#404040" stroke="none" text-anchor="middle">{text}</text></g>"##,
        y - 5.0,
        y - 5.0,
        0.5 * (from + to),
        y - 5.0
    )
}

/// A round length as a bar at the lower right.
pub(super) fn scale_bar(svg: &mut String, page: &Page, top: f64) -> std::fmt::Result {
    let most = 200.0 / page.zoom;
    let decade = 10.0_f64.powf(most.log10().floor());
    let round = [5.0, 2.0, 1.0].into_iter().find(|f| f * decade <= most);
    let length = round.unwrap_or(1.0) * decade;
    let (right, y) = (WIDTH - super::MARGIN, top + 5.0);
    let (left, half) = (right - length * page.zoom, 0.5 * length * page.zoom);
    writeln!(
        svg,
        r##"<g class="scale" font-size="12"><rect x="{left:.2}" y="{y:.2}" width="{:.2}" height="5" fill="#ffffff" stroke="#303030" stroke-width="0.8"/><rect x="{left:.2}" y="{y:.2}" width="{half:.2}" height="5" fill="#303030"/><text x="{left:.2}" y="{:.2}" text-anchor="middle">0</text><text x="{right:.2}" y="{:.2}" text-anchor="end">{length} mm</text></g>"##,
        length * page.zoom,
        y + 19.0,
        y + 19.0
    )
}

fn draw_arrow(
    svg: &mut String,
    arrow: &Arrow,
    page: &Page,
    taken: &mut Vec<[f64; 2]>,
) -> std::fmt::Result {
    let at = page.place(arrow.at);
    let [right, up, toward] = arrow.along;
    let size = right.hypot(up);
    writeln!(
        svg,
        r#"<g class="load" stroke="{LOAD}" stroke-width="2" fill="{LOAD}">"#
    )?;
    let mut at = if size < ACROSS {
        along_sight(svg, at, toward)?
    } else {
        across_sight(svg, at, [right / size, -up / size])?
    };
    while taken
        .iter()
        .any(|t| (t[0] - at[0]).abs() < 70.0 && (t[1] - at[1]).abs() < 14.0)
    {
        at[1] -= 14.0;
    }
    taken.push(at);
    let half = 0.5 * width(&arrow.text, 12.0) + 4.0;
    let x = at[0].clamp(half, WIDTH - half);
    writeln!(
        svg,
        r##"<text x="{x:.2}" y="{:.2}" font-size="12" text-anchor="middle" stroke="#ffffff" stroke-width="3" paint-order="stroke">{}</text></g>"##,
        at[1],
        escape(&arrow.text)
    )
}

/// Draws an arrow along the line of sight: towards the viewer its head, a point, away its feathers, a cross. Returns
/// the place of its text.
fn along_sight(
    svg: &mut String,
    [x, y]: [f64; 2],
    toward: f64,
) -> Result<[f64; 2], std::fmt::Error> {
    writeln!(
        svg,
        r##"<circle cx="{x:.2}" cy="{y:.2}" r="8" fill="#ffffff"/>"##
    )?;
    if toward > 0.0 {
        writeln!(svg, r#"<circle cx="{x:.2}" cy="{y:.2}" r="2"/>"#)?;
    } else {
        let (left, top) = (x - 5.5, y - 5.5);
        writeln!(svg, r#"<path d="M{left:.2} {top:.2}l11 11m0 -11l-11 11"/>"#)?;
    }
    Ok([x, y - 13.0])
}

/// Draws an arrow across the line of sight and returns the place of its text.
fn across_sight(
    svg: &mut String,
    [x, y]: [f64; 2],
    [dx, dy]: [f64; 2],
) -> Result<[f64; 2], std::fmt::Error> {
    // It pushes from the nearer side of the picture: its tip is at the wall, or its tail.
    let pushes = if dx.abs() > dy.abs() {
        (0.5 * WIDTH - x) * dx >= 0.0
    } else {
        dy > 0.0
    };
    let (tx, ty) = if pushes {
        (x, y)
    } else {
        (x + ARROW * dx, y + ARROW * dy)
    };
    let (sx, sy) = (tx - ARROW * dx, ty - ARROW * dy);
    let head = |side: f64| {
        let (px, py) = (
            tx - 10.0 * dx - side * 4.5 * dy,
            ty - 10.0 * dy + side * 4.5 * dx,
        );
        format!("{px:.2},{py:.2}")
    };
    writeln!(
        svg,
        r#"<path d="M{sx:.2} {sy:.2}L{:.2} {:.2}"/><polygon points="{tx:.2},{ty:.2} {} {}" stroke="none"/>"#,
        tx - 8.0 * dx,
        ty - 8.0 * dy,
        head(1.0),
        head(-1.0)
    )?;
    let outer = if pushes { [sx, sy] } else { [tx, ty] };
    let above = if dy.abs() > dx.abs() { 6.0 } else { 10.0 };
    Ok([outer[0], outer[1] - above])
}
