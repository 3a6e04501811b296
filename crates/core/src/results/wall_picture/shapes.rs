//! Visible faces of the solids, their cracks, and the joints, projected and sorted from far to near.

use std::collections::{HashMap, HashSet};

use nalgebra::{Vector3, Vector6};

use super::view::{Camera, View, dot, no_section};
use crate::element::exterior::{corners, exterior_faces};
use crate::element::hexahedron::EDGES;
use crate::results::colours::{self, Rgb};
use crate::results::{ReadError, Snapshot};
use crate::state::{CRUSHED, InterfaceState};
use crate::tensor;

/// Part of the widest crack below which a crack in a solid is not drawn.
const NARROWEST: f64 = 0.01;

/// Something to draw.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// Right and up [mm], displaced.
    pub corners: Vec<[f64; 2]>,
    /// Nearness to the viewer [mm].
    pub near: f64,
    pub kind: Kind,
}

/// Kind of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A face or a section of an element.
    Solid { fill: Rgb, crushed: bool },
    /// A crack in a solid and its width [mm].
    Crack { width: f64 },
    /// Part of a joint and its opening [mm].
    Joint { state: InterfaceState, width: f64 },
}

impl Kind {
    /// Order of drawing at the same distance.
    fn rank(self) -> u8 {
        match self {
            Self::Solid { .. } => 0,
            Self::Crack { .. } => 1,
            Self::Joint { state, .. } => match state {
                InterfaceState::Intact => 2,
                InterfaceState::Softening => 3,
                InterfaceState::FailedSliding => 4,
                InterfaceState::FailedOpen => 5,
            },
        }
    }
}

/// A snapshot as it is seen.
pub(super) struct Scene<'a> {
    pub snapshot: &'a Snapshot,
    pub camera: Camera,
    /// Magnification of displacements.
    pub scale: f64,
    /// Whether faces are shaded by their direction.
    pub shaded: bool,
}

/// A point at rest and displaced [mm].
#[derive(Clone, Copy)]
struct Place {
    rest: [f64; 3],
    now: [f64; 3],
}

impl Place {
    fn between(self, other: Self, part: f64) -> Self {
        let mix = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + part * (b[i] - a[i]));
        Self {
            rest: mix(self.rest, other.rest),
            now: mix(self.now, other.now),
        }
    }
}

/// Half of an edge at rest, in thousandths of a millimetre, the smaller end first.
type HalfEdge = [[i64; 3]; 2];

fn half_edge(a: [f64; 3], b: [f64; 3]) -> HalfEdge {
    let mut ends = [a, b].map(|x| x.map(|x| (1e3 * x).round() as i64));
    ends.sort_unstable();
    ends
}

impl Scene<'_> {
    /// All shapes of a view, the farthest first.
    ///
    /// # Errors
    /// [`ReadError::NoSection`]: the section meets no element.
    pub fn shapes(&self, view: &View) -> Result<Vec<Shape>, ReadError> {
        let mut shapes = match *view {
            View::Outside { .. } => self.outside(),
            View::Section { axis, at } => self.section(axis, at)?,
        };
        let order = |a: &Shape, b: &Shape| {
            let near = a.near.total_cmp(&b.near);
            near.then(a.kind.rank().cmp(&b.kind.rank()))
        };
        shapes.sort_by(order);
        Ok(shapes)
    }

    fn node(&self, n: u32) -> Place {
        let Snapshot { mesh, frame, .. } = self.snapshot;
        self.placed(mesh.nodes[n as usize], frame.displacement[n as usize])
    }

    fn point(&self, n: u32) -> Place {
        let of = self.snapshot;
        self.placed(
            of.surface.points[n as usize],
            of.surface_displacement[n as usize],
        )
    }

    fn placed(&self, rest: [f64; 3], moved: [f64; 3]) -> Place {
        Place {
            rest,
            now: [0, 1, 2].map(|i| rest[i] + self.scale * moved[i]),
        }
    }

    /// State and opening of a contact point.
    fn joint(&self, point: usize) -> Kind {
        let of = &self.snapshot.frame.interfaces;
        Kind::Joint {
            state: of.state.get(point).copied().unwrap_or_default(),
            width: of.opening.get(point).map_or(0.0, |w| w.max(0.0)),
        }
    }

    /// Colour of an element on a face with this normal.
    fn solid(&self, e: usize, normal: [f64; 3]) -> Kind {
        let Snapshot { mesh, frame, .. } = self.snapshot;
        let mut fill = colours::damaged(usize::from(mesh.material[e]), frame.tensile_damage[e]);
        if self.shaded {
            let camera = &self.camera;
            // The light stands above the viewer's left.
            let light = [0, 1, 2].map(|i| camera.toward[i] + camera.up[i] - 0.6 * camera.right[i]);
            let bright = dot(normal, light).max(0.0) / dot(light, light).sqrt();
            fill = colours::mixed([0; 3], fill, 0.62 + 0.38 * bright);
        }
        Kind::Solid {
            fill,
            crushed: frame.compressive_damage[e] > CRUSHED,
        }
    }

    fn outside(&self) -> Vec<Shape> {
        let mesh = &self.snapshot.mesh;
        let mut shapes = Vec::new();
        let mut seen: HashMap<HalfEdge, f64> = HashMap::new();
        let mut hidden: HashSet<HalfEdge> = HashSet::new();
        let widest = self.widest();
        for (e, face) in exterior_faces(&mesh.elements, |_| 0) {
            let places = corners(&mesh.elements[e as usize], face).map(|n| self.node(n));
            let rest = places.map(|p| p.rest);
            let normal = normal(rest);
            let near = rest.map(|x| self.camera.near(x)).iter().sum::<f64>() / 4.0;
            let visible = dot(normal, self.camera.toward) > 1e-6;
            for k in 0..4 {
                let (a, b) = (rest[k], rest[(k + 1) % 4]);
                let middle = [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]));
                for half in [half_edge(a, middle), half_edge(middle, b)] {
                    if visible {
                        let nearest = seen.entry(half).or_insert(near);
                        *nearest = nearest.max(near);
                    } else {
                        hidden.insert(half);
                    }
                }
            }
            if visible {
                let flat = places.map(|p| self.camera.flat(p.now)).to_vec();
                shapes.extend(self.crack(e as usize, (&flat, near), normal, widest));
                shapes.push(Shape {
                    corners: flat,
                    near,
                    kind: self.solid(e as usize, normal),
                });
            }
        }
        let front = shapes
            .iter()
            .map(|s| s.near)
            .fold(f64::NEG_INFINITY, f64::max);
        let slack = 1e-6 * front.abs().max(1.0);
        for (p, quad) in self.snapshot.surface.quads.iter().enumerate() {
            // Edges within the facet are no edges of elements.
            for k in 0..4 {
                let [a, b] = [quad[k], quad[(k + 1) % 4]];
                let ends = [a, b].map(|n| self.point(n));
                let half = half_edge(ends[0].rest, ends[1].rest);
                let near = seen.get(&half).copied().or_else(|| {
                    // Parts of facets end within faces of the elements.
                    let near = self.camera.near(ends[0].between(ends[1], 0.5).rest);
                    (!hidden.contains(&half) && near >= front - slack).then_some(near)
                });
                if let Some(near) = near {
                    shapes.push(Shape {
                        corners: ends.map(|p| self.camera.flat(p.now)).to_vec(),
                        near,
                        kind: self.joint(p),
                    });
                }
            }
        }
        shapes
    }

    /// Largest width of a crack, in joints and solids [mm].
    pub fn widest(&self) -> f64 {
        let frame = &self.snapshot.frame;
        let all = frame.crack_width.iter().chain(&frame.interfaces.opening);
        all.copied().filter(|w| w.is_finite()).fold(0.0, f64::max)
    }

    /// The crack through the middle of a face, in the plane normal to the largest principal plastic strain (of the
    /// stress without one).
    fn crack(
        &self,
        e: usize,
        (face, near): (&[[f64; 2]], f64),
        normal: [f64; 3],
        widest: f64,
    ) -> Option<Shape> {
        let frame = &self.snapshot.frame;
        let width = frame.crack_width[e];
        if !(width > 0.0 && width >= NARROWEST * widest) {
            return None;
        }
        let mut strain = frame.plastic_strain[e];
        if strain == [0.0; 6] {
            strain = frame.stress[e];
        } else {
            // From engineering shear to tensor components.
            strain[3..].iter_mut().for_each(|shear| *shear *= 0.5);
        }
        let (_, directions) = tensor::principal(&Vector6::from(strain));
        let along = directions[0].cross(&Vector3::from(normal));
        // A crack nearly parallel to the face has no line on it.
        if along.norm() < 0.2 {
            return None;
        }
        Some(Shape {
            corners: across(face, self.camera.flat(along.into()))?.to_vec(),
            near,
            kind: Kind::Crack { width },
        })
    }

    fn section(&self, axis: usize, at: f64) -> Result<Vec<Shape>, ReadError> {
        let mesh = &self.snapshot.mesh;
        let [low, high] = mesh.extent(axis);
        // A section of an end face shows the elements behind it.
        let inner = if at <= low {
            low + 1e-9 * (high - low)
        } else {
            at
        };
        let cut = |a: Place, b: Place| {
            let (s, t) = (a.rest[axis] - inner, b.rest[axis] - inner);
            ((s < 0.0) != (t < 0.0)).then(|| a.between(b, s / (s - t)).now)
        };
        let (normal, widest) = (self.camera.toward, self.widest());
        let mut shapes = Vec::new();
        for (e, nodes) in mesh.elements.iter().enumerate() {
            let nodes = nodes.map(|n| self.node(n));
            let cuts = EDGES.iter().filter_map(|[a, b]| cut(nodes[*a], nodes[*b]));
            let corners = around(cuts.map(|x| self.camera.flat(x)).collect());
            if corners.len() >= 3 {
                shapes.extend(self.crack(e, (&corners, 0.0), normal, widest));
                shapes.push(Shape {
                    corners,
                    near: 0.0,
                    kind: self.solid(e, normal),
                });
            }
        }
        if shapes.is_empty() || at < low || at > high {
            return Err(no_section(axis, at, [low, high]));
        }
        for (p, quad) in self.snapshot.surface.quads.iter().enumerate() {
            let ends = quad.map(|n| self.point(n));
            let cuts = (0..4).filter_map(|k| cut(ends[k], ends[(k + 1) % 4]));
            let corners: Vec<[f64; 2]> = cuts.map(|x| self.camera.flat(x)).collect();
            if corners.len() == 2 {
                shapes.push(Shape {
                    corners,
                    near: 0.0,
                    kind: self.joint(p),
                });
            }
        }
        Ok(shapes)
    }
}

/// Unit normal of a quad from its diagonals; zero of one without area.
fn normal(x: [[f64; 3]; 4]) -> [f64; 3] {
    let d = |a: usize, b: usize| Vector3::from_fn(|i, _| x[b][i] - x[a][i]);
    let n = d(0, 2).cross(&d(1, 3));
    n.try_normalize(0.0).unwrap_or_default().into()
}

fn middle(corners: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| corners.iter().map(|c| c[i]).sum::<f64>() / corners.len() as f64)
}

/// Corners in the order around their middle.
fn around(mut corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let [x, y] = middle(&corners);
    let angle = |c: &[f64; 2]| (c[1] - y).atan2(c[0] - x);
    corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    corners
}

/// The line through the middle of a polygon in this direction, from edge to edge.
fn across(corners: &[[f64; 2]], [dx, dy]: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let [x, y] = middle(corners);
    let (mut back, mut forth) = (0.0_f64, 0.0_f64);
    for k in 0..corners.len() {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
        let side = dx * ey - dy * ex;
        if side == 0.0 {
            continue;
        }
        let (px, py) = (a[0] - x, a[1] - y);
        let t = (px * ey - py * ex) / side;
        let s = (px * dy - py * dx) / side;
        if (-1e-9..=1.0 + 1e-9).contains(&s) {
            back = back.min(t);
            forth = forth.max(t);
        }
    }
    let ends = [back, forth].map(|t| [x + t * dx, y + t * dy]);
    (forth > back && ends.iter().flatten().all(|c| c.is_finite())).then_some(ends)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    fn snapshot() -> Snapshot {
        let model = fake::model();
        Snapshot {
            frame: fake::frame(&model, 1.0),
            mesh: model.mesh,
            ..Snapshot::default()
        }
    }

    fn solids(snapshot: &Snapshot, view: View, scale: f64) -> Vec<Vec<[f64; 2]>> {
        let scene = Scene {
            snapshot,
            camera: view.camera(),
            scale,
            shaded: false,
        };
        let shapes = scene.shapes(&view).unwrap().into_iter();
        shapes
            .filter(|s| matches!(s.kind, Kind::Solid { .. }))
            .map(|s| s.corners)
            .collect()
    }

    #[test]
    fn corners_lie_at_their_magnified_places() {
        let mut of = snapshot();
        // The right cube moves by 1 mm in x and 0.5 mm in z; the displacement in y is not visible.
        of.frame.displacement[..8].fill([0.0; 3]);
        of.frame.displacement[8..].fill([1.0, 7.0, 0.5]);
        let front = solids(&of, View::default(), 10.0);
        assert_eq!(front.len(), 2);
        assert!(front[1].contains(&[112.0, 5.0]) && front[1].contains(&[212.0, 105.0]));
        // From behind x runs to the left.
        let back = solids(&of, "back".parse().unwrap(), 10.0);
        assert!(back.iter().any(|quad| quad.contains(&[-212.0, 105.0])));
        // Three faces of either cube are seen obliquely.
        assert_eq!(solids(&of, "iso".parse().unwrap(), 1.0).len(), 6);
    }

    /// A hexahedron bent out of its plane shows its two faces at different places.
    #[test]
    fn front_and_back_differ_where_the_wall_is_bent() {
        let mut of = snapshot();
        for (u, x) in of.frame.displacement.iter_mut().zip(&of.mesh.nodes) {
            // Rotation about the x axis.
            *u = [0.0, -0.01 * x[2], 0.01 * x[1]];
        }
        let top = |view: &str| {
            let quads = solids(&of, view.parse().unwrap(), 1.0)
                .into_iter()
                .flatten();
            quads.map(|c| c[1]).fold(f64::NEG_INFINITY, f64::max)
        };
        assert!((top("front") - 100.0).abs() < 1e-9 && (top("back") - 101.0).abs() < 1e-9);
    }

    #[test]
    fn a_section_cuts_what_lies_there() {
        let of = snapshot();
        let cut = |axis, at| solids(&of, View::Section { axis, at }, 0.0).len();
        assert_eq!(
            [cut(0, 50.0), cut(1, 0.0), cut(1, 100.0), cut(2, 30.0)],
            [1, 2, 2, 2]
        );
        let view = View::Section { axis: 0, at: 101.0 };
        let scene = Scene {
            snapshot: &of,
            camera: view.camera(),
            scale: 1.0,
            shaded: false,
        };
        let error = scene.shapes(&view).unwrap_err().to_string();
        assert_eq!(error, "no part of the model lies at x = 101 mm");
    }

    #[test]
    fn a_crack_runs_from_edge_to_edge() {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(across(&square, [0.5, 0.0]), Some([[0.0, 1.0], [2.0, 1.0]]));
        assert_eq!(across(&square, [1.0, 1.0]), Some([[0.0, 0.0], [2.0, 2.0]]));
        assert_eq!(across(&square, [0.0, 0.0]), None);
    }
}
