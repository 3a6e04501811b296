//! Kinematics of one slave point against one master facet: a small element of 4 + 4 nodes.
//!
//! With x_s = Σ N_a x_a on the slave facet and x_m(ξ) the foot of the perpendicular on the master,
//! u = n·(x_s − x_m) and, from the anchor y (the material point of the master that was the foot at
//! the last commit), Δδ_α = t_α·(x_s − y). The traction σ n + τ_α t_α pulls the slave back and the
//! master at the foot.

use nalgebra::{Matrix3, RowSVector, SMatrix, Vector3};

use crate::part::Part;
use crate::projection::extend;
use crate::surface::{MIXED, blend, shape};

type Gradient = SMatrix<f64, 3, 24>;

/// A sampling point of a slave facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlavePoint {
    /// Weights of the facet's nodes.
    pub weights: [f64; 4],
    /// Its share of the facet's reference area [mm²].
    pub area: f64,
}

/// 2 × 2 Gauss points of a part of a facet with reference positions `corners`.
pub fn gauss_points(corners: &[[f64; 3]; 4], part: &Part) -> [SlavePoint; 4] {
    let at = 1.0 / 3.0_f64.sqrt();
    sample(
        corners,
        part,
        [EVEN.map(|(side, share)| (side * at, share)); 2],
    )
}

/// The corners of a part, moved inwards by 1e-6 of its half size, so that each lies on one facet only where edges of
/// bodies coincide. Areas are ∫ N dA of a flat part: an even pressure acts at its centroid.
pub fn corner_points(corners: &[[f64; 3]; 4], part: &Part) -> [SlavePoint; 4] {
    let mut points = sample(
        corners,
        part,
        [EVEN.map(|(side, share)| (side * OUTERMOST, share)); 2],
    );
    // Quarters by the size of the area element at each corner, which is linear between them.
    let quarters = points.map(|point| point.area);
    for (k, point) in points.iter_mut().enumerate() {
        let beyond = |i: usize| quarters[(k + i) % 4] - quarters[k];
        let more = (2.0 * (beyond(1) + beyond(3)) + beyond(2)) / 9.0;
        // Equal ones of a parallelogram stay as they are.
        if more.abs() > ROUNDING * quarters[k] {
            point.area += more;
        }
    }
    points
}

/// Points of a part along one of its directions.
///
/// Of four Lobatto points of a stretch, which include its ends, moved inwards by 1e-6 of its half length, and integrate
/// polynomials of degree 5, each half of the stretch has two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PointsAlong {
    /// Two Gauss points.
    #[default]
    Gauss,
    /// The first two Lobatto points of a stretch of which the part is the first half.
    FirstHalf,
    /// The last two of a stretch of which it is the second half.
    SecondHalf,
}

/// Points of a part with these points along its two directions.
pub fn points_of(corners: &[[f64; 3]; 4], part: &Part, along: [PointsAlong; 2]) -> [SlavePoint; 4] {
    // On [-1, 1] the inner points are ±1/√5 with weight 5/6, the outer ones ±1 with weight 1/6.
    let inner = 2.0 / 5.0_f64.sqrt() - 1.0;
    let gauss = 1.0 / 3.0_f64.sqrt();
    let along = along.map(|points| match points {
        PointsAlong::SecondHalf => [(inner, 5.0 / 6.0), (OUTERMOST, 1.0 / 6.0)],
        PointsAlong::FirstHalf => [(-OUTERMOST, 1.0 / 6.0), (-inner, 5.0 / 6.0)],
        PointsAlong::Gauss => EVEN.map(|(side, share)| (side * gauss, share)),
    });
    sample(corners, part, along)
}

/// Parameter of the outermost points.
const OUTERMOST: f64 = 1.0 - 1e-6;

/// Relative difference of areas that are equal but for rounding.
const ROUNDING: f64 = 1e-9;

/// Two points on either side of the middle, with equal shares.
const EVEN: [(f64, f64); 2] = [(-1.0, 0.5), (1.0, 0.5)];

/// Points of a part, from their parameters and shares along its two directions.
fn sample(corners: &[[f64; 3]; 4], part: &Part, along: [[(f64, f64); 2]; 2]) -> [SlavePoint; 4] {
    let whole = 4.0 * part.half[0] * part.half[1];
    [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| {
        let ((xi, by_xi), (eta, by_eta)) = (along[0][i], along[1][j]);
        let (weights, by_s, by_t) = shape(part.at([xi, eta]));
        let jacobian = blend(&by_s, corners).cross(&blend(&by_t, corners)).norm();
        let area = jacobian * (whole * by_xi * by_eta);
        SlavePoint { weights, area }
    })
}

/// Reference point from which the slip of this increment is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    /// Parameters on the same facet.
    Same([f64; 2]),
    /// A point elsewhere, given by its current position [mm]. Its nodes are not among the eight. The stiffness
    /// assumes that it moves with the foot, which is exact if both belong to one face.
    At([f64; 3]),
}

/// Kinematics of a pair.
#[derive(Clone, Debug)]
pub struct Kinematics {
    /// Normal gap u [mm], positive when open.
    pub gap: f64,
    /// Slip since the last accepted increment Δδ [mm], in the frame.
    pub slip: [f64; 2],
    /// n, t₁, t₂.
    pub frame: [Vector3<f64>; 3],
    /// Parameters of the foot.
    pub xi: [f64; 2],
    weights: [f64; 8],
    slave: [f64; 4],
    reach: Vector3<f64>,
    anchor_weights: [f64; 4],
    first: Vector3<f64>,
    second: Vector3<f64>,
    twist: Vector3<f64>,
    r: Vector3<f64>,
}

impl Kinematics {
    /// Kinematics of a slave point (corner positions and weights) relative to a master facet. `start` is the initial
    /// guess for the foot. `None` if there is no foot near the facet.
    pub fn new(
        slave: &[[f64; 3]; 4],
        slave_weights: &[f64; 4],
        master: &[[f64; 3]; 4],
        start: [f64; 2],
        anchor: Anchor,
    ) -> Option<Self> {
        let point = blend(slave_weights, slave);
        let foot = extend(&point, master, start)?;
        let (n_m, by_s, by_t) = shape(foot.xi);
        let (a1, a2) = (blend(&by_s, master), blend(&by_t, master));
        let n = foot.normal;
        let t1 = a1 / a1.norm();
        let t2 = n.cross(&t1);
        let (anchor_weights, y) = match anchor {
            Anchor::Same(xi) => {
                let weights = shape(xi).0;
                (weights, blend(&weights, master))
            }
            Anchor::At(y) => (n_m, Vector3::from(y)),
        };
        let reach = point - y;
        let mut weights = [0.0; 8];
        for a in 0..4 {
            weights[a] = slave_weights[a];
            weights[4 + a] = -n_m[a];
        }
        Some(Self {
            gap: foot.gap,
            slip: [t1.dot(&reach), t2.dot(&reach)],
            frame: [n, t1, t2],
            xi: foot.xi,
            weights,
            slave: *slave_weights,
            reach,
            anchor_weights,
            first: a1,
            second: a2,
            twist: blend(&MIXED, master),
            r: point - foot.point,
        })
    }

    /// Weights of the relative displacement. `[slave corners, master corners]`
    pub fn weights(&self) -> &[f64; 8] {
        &self.weights
    }

    /// Traction vector σ n + τ_α t_α [MPa].
    fn vector(&self, traction: &[f64; 3]) -> Vector3<f64> {
        self.frame[0] * traction[0] + self.frame[1] * traction[1] + self.frame[2] * traction[2]
    }

    /// Adds the internal forces of the eight nodes [N]; area in mm².
    pub fn add_force(&self, traction: &[f64; 3], area: f64, force: &mut [[f64; 3]; 8]) {
        let t = self.vector(traction) * area;
        for (f, w) in force.iter_mut().zip(&self.weights) {
            for i in 0..3 {
                f[i] += w * t[i];
            }
        }
    }

    /// Material stiffness of the point from `tangent` (rows σ, τ₁, τ₂; columns u, δ₁, δ₂), for [`write_stiffness`];
    /// area in mm².
    pub fn stiffness(&self, tangent: &Matrix3<f64>, area: f64) -> PointStiffness {
        let rotation = Matrix3::from_columns(&self.frame);
        PointStiffness {
            weights: self.weights,
            block: rotation * tangent * rotation.transpose() * area,
        }
    }

    /// Adds the exact stiffness ∂f/∂x `[a][b][i][j]` [N/mm], including the rotation of the frame and the motion of
    /// the foot.
    #[expect(
        clippy::too_many_lines,
        reason = "the formula of the exact stiffness, term by term"
    )]
    pub fn add_exact_stiffness(
        &self,
        traction: &[f64; 3],
        tangent: &Matrix3<f64>,
        area: f64,
        cell: &mut [f64],
    ) {
        let (n_m, by_s, by_t) = shape(self.xi);
        let [n, t1, t2] = self.frame;
        let (a1, a2) = (self.first, self.second);
        let spread = |weights: &[f64; 4]| {
            let mut g = Gradient::zeros();
            for a in 0..4 {
                for i in 0..3 {
                    g[(i, 12 + 3 * a + i)] = weights[a];
                }
            }
            g
        };
        let mut point = Gradient::zeros();
        for a in 0..4 {
            for i in 0..3 {
                point[(i, 3 * a + i)] = self.slave[a];
            }
        }
        let relative = point - spread(&n_m);
        let (da1, da2) = (spread(&by_s), spread(&by_t));
        // (a_α·a_β − r·a_αβ) δξ_β = (δx_s − δx_m)·a_α + r·δa_α
        let m12 = a1.dot(&a2) - self.r.dot(&self.twist);
        let (m11, m22) = (a1.dot(&a1), a2.dot(&a2));
        let det = m11 * m22 - m12 * m12;
        let b1: RowSVector<f64, 24> = a1.transpose() * relative + self.r.transpose() * da1;
        let b2: RowSVector<f64, 24> = a2.transpose() * relative + self.r.transpose() * da2;
        let dxi1 = (b1 * m22 - b2 * m12) / det;
        let dxi2 = (b2 * m11 - b1 * m12) / det;
        let da1 = da1 + self.twist * dxi2;
        let da2 = da2 + self.twist * dxi1;
        // δn = −a^α (n·δa_α), contravariant basis
        let g12 = a1.dot(&a2);
        let g = m11 * m22 - g12 * g12;
        let up1 = (a1 * m22 - a2 * g12) / g;
        let up2 = (a2 * m11 - a1 * g12) / g;
        let dn = -(up1 * (n.transpose() * da1) + up2 * (n.transpose() * da2));
        let dt1 = (da1 - t1 * (t1.transpose() * da1)) / a1.norm();
        let mut dt2 = Gradient::zeros();
        for c in 0..24 {
            let dn_c: Vector3<f64> = dn.column(c).into();
            let dt1_c: Vector3<f64> = dt1.column(c).into();
            dt2.set_column(c, &(dn_c.cross(&t1) + n.cross(&dt1_c)));
        }
        let du = n.transpose() * relative;
        let from_anchor = point - spread(&self.anchor_weights);
        let d1 = self.reach.transpose() * dt1 + t1.transpose() * from_anchor;
        let d2 = self.reach.transpose() * dt2 + t2.transpose() * from_anchor;
        let row = |k: usize| du * tangent[(k, 0)] + d1 * tangent[(k, 1)] + d2 * tangent[(k, 2)];
        let dt = n * row(0)
            + dn * traction[0]
            + t1 * row(1)
            + dt1 * traction[1]
            + t2 * row(2)
            + dt2 * traction[2];
        let t = self.vector(traction);
        for a in 0..8 {
            let mut rows = dt * self.weights[a];
            if a >= 4 {
                rows -= t * (dxi1 * by_s[a - 4] + dxi2 * by_t[a - 4]);
            }
            for b in 0..8 {
                let block = &mut cell[(a * 8 + b) * 9..][..9];
                for i in 0..3 {
                    for j in 0..3 {
                        block[3 * i + j] += area * rows[(i, 3 * b + j)];
                    }
                }
            }
        }
    }
}

/// Stiffness w_a w_b k of one point between the eight nodes of a slave and a master facet.
#[derive(Clone, Copy, Debug)]
pub struct PointStiffness {
    /// w: weights of the relative displacement. `[slave corners, master corners]`
    pub weights: [f64; 8],
    /// k [N/mm].
    pub block: Matrix3<f64>,
}

/// Writes the sum of the points' stiffnesses `[a][b][i][j]` [N/mm] over the whole element matrix; it is symmetric if
/// the tangents are. The matrix is written once, because writing dominates the cost.
pub fn write_stiffness(points: &[PointStiffness], cell: &mut [f64]) {
    for a in 0..8 {
        for b in 0..8 {
            let mut sum = Matrix3::zeros();
            for point in points {
                sum += point.block * (point.weights[a] * point.weights[b]);
            }
            let block = &mut cell[(a * 8 + b) * 9..][..9];
            for i in 0..3 {
                for j in 0..3 {
                    block[3 * i + j] = sum[(i, j)];
                }
            }
        }
    }
}
