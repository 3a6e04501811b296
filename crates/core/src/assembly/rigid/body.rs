//! One rigid body: its nodes, its pose, and its motion for small changes of six unknowns.

use nalgebra::{Matrix3, Vector3};

use crate::assembly::dofs::{DofMap, HELD};
use crate::model::mesh::{Mesh, Reflected};

/// Part of the size of a body within which held nodes lie in one plane.
const LEVEL: f64 = 1e-6;

/// Strain that counts as none: some thousand roundings.
const RIGID: f64 = 1e-12;
/// Most iterations for the rotation; from a rigid pose, two or three.
const MOST: usize = 20;
/// Change of the rotation below which the next iterate, whose error is its square, is exact.
const SETTLED: f64 = 1e-8;

/// A body that moves as a rigid one.
#[derive(Clone, Debug)]
pub(super) struct Body {
    /// Its nodes, ascending, without images in a plane of symmetry.
    pub(super) nodes: Vec<u32>,
    /// Nodes at rest, relative to their mean [mm]. `[node]`
    arms: Vec<Vector3<f64>>,
    /// (Σ arm armᵀ)⁻¹ [1/mm²].
    spread: Matrix3<f64>,
    /// Normal of a plane that holds the body, because supports hold some of its nodes there or because the plane is
    /// one of symmetry that the body lies across. It then translates in this plane and rotates about the normal.
    pub(super) plane: Option<usize>,
    /// Root mean square of the arms [mm]. Rotations are counted as the way of a point at this distance.
    pub(super) radius: f64,
    /// Elements of the body.
    pub(super) elements: Vec<u32>,
    /// All its nodes, each with an element that shows its force and its place in this element.
    pub(super) shown: Vec<Shown>,
}

/// Where the force on a node is shown.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shown {
    pub(super) node: u32,
    element: u32,
    place: u8,
}

impl Shown {
    /// The force among those of all cells [N].
    pub(super) fn of(self, force: &[[[f64; 3]; 8]]) -> [f64; 3] {
        force[self.element as usize][self.place as usize]
    }

    /// The same, to be written.
    pub(super) fn to(self, force: &mut [[[f64; 3]; 8]]) -> &mut [f64; 3] {
        &mut force[self.element as usize][self.place as usize]
    }
}

/// Whether and how supports hold the nodes of a body.
#[derive(Clone, Copy)]
enum Held {
    Free,
    /// In a plane with this normal.
    InPlane(usize),
    /// In another way.
    Otherwise,
}

impl Body {
    /// The body of these elements; none if supports hold it in another way than in a plane.
    pub(super) fn of(mesh: &Mesh, dofs: &DofMap, elements: Vec<u32>) -> Option<Self> {
        let connectivity = elements.iter().map(|e| mesh.elements[*e as usize]);
        let mut all: Vec<u32> = connectivity.flatten().collect();
        all.sort_unstable();
        all.dedup();
        let image = |n: &u32| mesh.reflected(*n);
        let nodes: Vec<u32> = all.iter().copied().filter(|n| image(n).is_none()).collect();
        let at = |n: &u32| Vector3::from(mesh.nodes[*n as usize]);
        let centre = nodes.iter().map(at).sum::<Vector3<f64>>() / nodes.len() as f64;
        let arms: Vec<_> = nodes.iter().map(|n| at(n) - centre).collect();
        let square: f64 = arms.iter().map(Vector3::norm_squared).sum();
        let radius = (square / nodes.len() as f64).sqrt();
        let images: Vec<&Reflected> = all.iter().filter_map(image).collect();
        let held = held(dofs, &nodes, &arms, radius);
        let plane = match (held, crossed(&nodes, &images)) {
            (Held::Free, Held::Free) => None,
            (Held::InPlane(axis), Held::Free) | (Held::Free, Held::InPlane(axis)) => Some(axis),
            _ => return None,
        };
        let spread: Matrix3<f64> = arms.iter().map(|arm| arm * arm.transpose()).sum();
        let spread = match plane {
            // The arms of half a body may lie in the plane.
            Some(_) => Matrix3::identity(),
            None => spread.try_inverse()?,
        };
        let shown = all.iter().map(|n| {
            let place = |e: &u32| {
                let place = mesh.elements[*e as usize].iter().position(|of| of == n)?;
                Some(Shown {
                    node: *n,
                    element: *e,
                    place: place as u8,
                })
            };
            elements.iter().find_map(place)
        });
        let shown = shown.collect::<Option<Vec<_>>>()?;
        Some(Self {
            nodes,
            arms,
            spread,
            plane,
            radius,
            elements,
            shown,
        })
    }

    /// Displacements of the nodes at the rigid pose nearest to the displacements `u` [mm] `[node of the body]`; none if
    /// `u` is a rigid pose but for rounding, which could part faces that touch.
    pub(super) fn straightened(&self, u: impl Fn(u32) -> [f64; 3]) -> Option<Vec<[f64; 3]>> {
        let nodes = self.nodes.iter().zip(&self.arms);
        let x: Vec<_> = nodes.map(|(n, arm)| Vector3::from(u(*n)) + arm).collect();
        let mut shift = x.iter().sum::<Vector3<f64>>() / x.len() as f64;
        let rotation = match self.plane {
            Some(axis) => {
                shift[axis] = 0.0;
                self.rotation_about(axis, &x)
            }
            None => self.rotation(&x, &shift),
        };
        let pose = |arm: &Vector3<f64>| shift + rotation * arm;
        let off = self
            .arms
            .iter()
            .zip(&x)
            .map(|(arm, x)| (pose(arm) - x).amax());
        if off.fold(0.0, f64::max) <= RIGID * self.radius {
            return None;
        }
        let arms = self.arms.iter();
        Some(arms.map(|arm| (pose(arm) - arm).into()).collect())
    }

    /// Rotation R of the mean deformation gradient F = R U of the body (theory/rigid-bodies.md, eq. 2).
    fn rotation(&self, x: &[Vector3<f64>], shift: &Vector3<f64>) -> Matrix3<f64> {
        let pairs = x.iter().zip(&self.arms);
        let sum: Matrix3<f64> = pairs.map(|(x, arm)| (x - shift) * arm.transpose()).sum();
        let mut rotation = sum * self.spread;
        for _ in 0..MOST {
            let Some(inverse) = rotation.try_inverse() else {
                return Matrix3::identity();
            };
            let next = 0.5 * (rotation + inverse.transpose());
            let change = (next - rotation).amax();
            rotation = next;
            if change < SETTLED {
                break;
            }
        }
        rotation
    }

    /// Rotation about a fixed axis that is nearest to positions `x`.
    fn rotation_about(&self, axis: usize, x: &[Vector3<f64>]) -> Matrix3<f64> {
        let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
        let (mut sine, mut cosine) = (0.0, 0.0);
        for (x, arm) in x.iter().zip(&self.arms) {
            sine += arm[i] * x[j] - arm[j] * x[i];
            cosine += arm[i] * x[i] + arm[j] * x[j];
        }
        let angle = sine.atan2(cosine);
        nalgebra::Rotation3::from_axis_angle(&Vector3::ith_axis(axis), angle).into_inner()
    }

    /// Mean of the nodes at positions `x` [mm].
    pub(super) fn centre_at(&self, x: &[[f64; 3]]) -> Vector3<f64> {
        let at = self.nodes.iter().map(|n| Vector3::from(x[*n as usize]));
        at.sum::<Vector3<f64>>() / self.nodes.len() as f64
    }

    /// Replaces nodal values by those of a rigid motion, or of a system of forces, with the same sums and moments:
    /// J (JᵀJ)⁻¹ Jᵀ v. `[node of the body]`
    pub(super) fn project(&self, arms: &[Vector3<f64>], values: &mut [Vector3<f64>]) {
        let mut mean = values.iter().sum::<Vector3<f64>>() / values.len() as f64;
        let moment: Vector3<f64> = (arms.iter().zip(&*values))
            .map(|(arm, v)| arm.cross(v))
            .sum();
        let spread: Matrix3<f64> = (arms.iter())
            .map(|arm| Matrix3::from_diagonal_element(arm.norm_squared()) - arm * arm.transpose())
            .sum();
        let turn = match self.plane {
            Some(axis) => {
                mean[axis] = 0.0;
                Vector3::ith(axis, moment[axis] / spread[(axis, axis)])
            }
            None => spread
                .cholesky()
                .map_or(Vector3::zeros(), |s| s.solve(&moment)),
        };
        for (arm, value) in arms.iter().zip(values) {
            *value = mean + turn.cross(arm);
        }
    }

    /// Derivative of the moment of the nodal forces of joints with the rotation of the body, over the square of
    /// `radius` [N/mm] (theory/rigid-bodies.md, eq. 6). `arms`: over `radius` `[node]`; `force`: of all
    /// cells, of which the elements of the body show its forces [N].
    pub(super) fn turning(&self, arms: &[Vector3<f64>], force: &[[[f64; 3]; 8]]) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        for shown in &self.shown {
            let (arm, p) = (arms[shown.node as usize], -Vector3::from(shown.of(force)));
            sum += arm * p.transpose();
            sum -= Matrix3::from_diagonal_element(arm.dot(&p));
        }
        sum / self.radius
    }
}

/// How a plane of symmetry holds a body that lies across it, with these nodes and their images.
fn crossed(nodes: &[u32], images: &[&Reflected]) -> Held {
    let Some(first) = images.first() else {
        return Held::Free;
    };
    let mut turned = (0..3).filter(|i| first.sign[*i] < 0.0);
    let (axis, more) = (turned.next(), turned.next());
    let mut of: Vec<u32> = images.iter().map(|image| image.of).collect();
    of.sort_unstable();
    let alike = images.iter().all(|image| image.sign == first.sign);
    match (axis, more) {
        (Some(axis), None) if alike && of == nodes => Held::InPlane(axis),
        _ => Held::Otherwise,
    }
}

/// How supports hold these nodes.
fn held(dofs: &DofMap, nodes: &[u32], arms: &[Vector3<f64>], radius: f64) -> Held {
    let slots = |n: &u32| dofs.slot[*n as usize];
    let directions = [0, 1, 2].map(|i| nodes.iter().any(|n| slots(n)[i] == HELD));
    let axis = match directions {
        [false, false, false] => return Held::Free,
        [true, false, false] => 0,
        [false, true, false] => 1,
        [false, false, true] => 2,
        _ => return Held::Otherwise,
    };
    let of_plane: Vec<_> = (nodes.iter().zip(arms))
        .filter(|(n, _)| slots(n)[axis] == HELD)
        .map(|(_, arm)| arm)
        .collect();
    let level = |arm: &&Vector3<f64>| (arm[axis] - of_plane[0][axis]).abs() <= LEVEL * radius;
    // Three nodes that span the plane, so that they hold both rotations about its directions.
    let from = |arm: &Vector3<f64>| arm - of_plane[0];
    let longest = of_plane.iter().map(|arm| from(arm));
    let longest = longest.fold(
        Vector3::zeros(),
        |a, b| if b.norm() > a.norm() { b } else { a },
    );
    let widest = (of_plane.iter()).map(|arm| from(arm).cross(&longest).norm());
    let spans = widest.fold(0.0, f64::max) > LEVEL * radius * radius;
    if spans && of_plane.iter().all(level) {
        Held::InPlane(axis)
    } else {
        Held::Otherwise
    }
}
