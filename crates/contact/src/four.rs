//! Kinematics and stiffness of the four points of a slave facet at once, each against its own master facet. The
//! results are those of [`Kinematics`] and [`write_stiffness`](crate::write_stiffness) point by point.
//!
//! Relative to the slave point a bilinear facet is c₀ + c₁ ξ + c₂ η + c₃ ξη, and a Newton step for the foot of the
//! perpendicular takes a few products of these vectors. Difficult cases (a distant point, a collapsed or strongly
//! warped facet) are left to [`extend`].
//!
//! [`Kinematics`]: crate::Kinematics
//! [`extend`]: crate::extend

use pulp::Simd;

use crate::lanes::{Lanes, Vectors, along, cross, dot, over};

/// Most Newton steps before a point is left to [`extend`](crate::extend). From the foot of the last iterate two steps
/// suffice.
const STEPS: usize = 6;

/// Input of four points: the master facet of each.
#[derive(Clone, Copy, Debug, Default)]
pub struct FourPlaced {
    /// Master corners relative to `origin` [mm]. `[corner][xyz]`
    pub master: [[Lanes; 3]; 4],
    /// Start of the Newton iteration for the foot. `[ξ η]`
    pub start: [Lanes; 2],
    /// Anchor of the slip on the same facet. `[ξ η]`
    pub anchor: [Lanes; 2],
}

impl FourPlaced {
    /// Sets the master facet of point `p`.
    #[inline(always)]
    pub fn place(
        &mut self,
        p: usize,
        origin: &[f64; 3],
        master: &[[f64; 3]; 4],
        start: [f64; 2],
        anchor: [f64; 2],
    ) {
        for a in 0..4 {
            for i in 0..3 {
                self.master[a][i].0[p] = master[a][i] - origin[i];
            }
        }
        for i in 0..2 {
            self.start[i].0[p] = start[i];
            self.anchor[i].0[p] = anchor[i];
        }
    }
}

/// Kinematics of four points.
#[derive(Clone, Copy, Debug, Default)]
pub struct FourSeen {
    /// Points whose foot was found; the values of the other points are meaningless.
    pub seen: [bool; 4],
    /// Normal gaps u [mm], positive when open.
    pub gap: Lanes,
    /// Slip since the last accepted increment Δδ [mm], in the frame.
    pub slip: [Lanes; 2],
    /// n, t₁, t₂. `[axis][xyz]`
    pub frame: [[Lanes; 3]; 3],
    /// Parameters of the feet of the perpendiculars.
    pub xi: [Lanes; 2],
    /// Weights of the relative displacements. `[slave corners, master corners]`
    pub weights: [Lanes; 8],
}

impl FourSeen {
    /// Kinematics of four points. `slave_weights` `[corner]` are the weights of the slave corners `slave` [mm], which
    /// have the same origin as the master corners.
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "one pass over registers of four lanes, inlined in the hot loop"
    )]
    pub fn new(slave: &[[f64; 3]; 4], slave_weights: &[Lanes; 4], placed: &FourPlaced) -> Self {
        let quarter = Lanes::splat(0.25);
        let one = Lanes::splat(1.0);
        // Facet coordinates relative to the point.
        let (mut c0, mut c1, mut c2, mut c3) = ([one; 3], [one; 3], [one; 3], [one; 3]);
        for i in 0..3 {
            let point = slave_weights[0] * Lanes::splat(slave[0][i])
                + slave_weights[1] * Lanes::splat(slave[1][i])
                + slave_weights[2] * Lanes::splat(slave[2][i])
                + slave_weights[3] * Lanes::splat(slave[3][i]);
            let x = &placed.master;
            let (x0, x1) = (x[0][i] - point, x[1][i] - point);
            let (x2, x3) = (x[2][i] - point, x[3][i] - point);
            let (low, high) = (x1 + x0, x2 + x3);
            let (low_way, high_way) = (x1 - x0, x2 - x3);
            c0[i] = quarter * (high + low);
            c1[i] = quarter * (high_way + low_way);
            c2[i] = quarter * (high - low);
            c3[i] = quarter * (high_way - low_way);
        }
        let facet = [c0, c1, c2, c3];

        let [mut s, mut t] = placed.start;
        let mut to_do = one;
        let mut easy = one;
        for _ in 0..STEPS {
            // x is minus the vector r from the foot to the point.
            let [x, a1, a2] = at(&facet, s, t);
            let (g11, g22) = (dot(&a1, &a1), dot(&a2, &a2));
            let off = dot(&a1, &a2) + dot(&x, &c3);
            let whole = g11 * g22;
            let det = whole - off * off;
            let (b1, b2) = (-dot(&x, &a1), -dot(&x, &a2));
            let inverse = to_do.over(det);
            let d1 = (g22 * b1 - off * b2) * inverse;
            let d2 = (g11 * b2 - off * b1) * inverse;
            let size = d1.abs().max(d2.abs());
            // A comparison with NaN gives 0, so that a point with NaN is not marked as easy.
            easy = easy * (Lanes::splat(1e-10) * whole).less(det) * size.less(one);
            s = s + d1;
            t = t + d2;
            // Newton's method converges quadratically: the error after the step is the square of its size.
            to_do = to_do * Lanes::splat(1e-9).less(size) * easy;
            if to_do.0 == [0.0; 4] {
                break;
            }
        }
        easy = easy * (one - to_do);

        let [x, a1, a2] = at(&facet, s, t);
        let normal = cross(&a1, &a2);
        let area = dot(&normal, &normal).sqrt();
        let n = over(&normal, area);
        let (length, other) = (dot(&a1, &a1).sqrt(), dot(&a2, &a2).sqrt());
        let t1 = over(&a1, length);
        let t2 = cross(&n, &t1);
        let gap = -dot(&x, &n);
        let scale = length + other;
        let rest = dot(&x, &a1).abs().max(dot(&x, &a2).abs());
        let most = Lanes::splat(1e-9) * scale * (scale + gap.abs());
        easy = easy * rest.less(most) * (Lanes::splat(1e-14) * scale * scale).less(area);

        let [reach, ..] = at(&facet, placed.anchor[0], placed.anchor[1]);
        let slip = [-dot(&t1, &reach), -dot(&t2, &reach)];
        let (left, right) = (quarter * (one - s), quarter * (one + s));
        let (low, high) = (one - t, one + t);
        let w = slave_weights;
        Self {
            seen: [
                easy.0[0] == 1.0,
                easy.0[1] == 1.0,
                easy.0[2] == 1.0,
                easy.0[3] == 1.0,
            ],
            gap,
            slip,
            frame: [n, t1, t2],
            xi: [s, t],
            weights: [
                w[0],
                w[1],
                w[2],
                w[3],
                -(left * low),
                -(right * low),
                -(right * high),
                -(left * high),
            ],
        }
    }
}

/// Point of the facet [c₀ c₁ c₂ c₃] and the derivatives a₁, a₂ there.
#[inline(always)]
fn at([c0, c1, c2, c3]: &[Vectors; 4], s: Lanes, t: Lanes) -> [Vectors; 3] {
    let (a1, a2) = (along(c1, c3, t), along(c2, c3, s));
    [along(&along(c0, &a1, s), c2, t), a1, a2]
}

/// Stiffness of one point, to be summed into an element matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Symmetric {
    /// Weights of the relative displacement. `[slave corners, master corners]`
    pub weights: [f64; 8],
    /// All entries of the symmetric block [N/mm]. `[3 i + j]`
    pub block: [f64; 9],
}

impl Symmetric {
    /// From the normal stiffness and the shear stiffnesses `[n, 11, 12, 22]` [N/mm³] in the frame n, t₁, t₂; area in
    /// mm².
    #[inline(always)]
    pub fn new(weights: [f64; 8], frame: &[[f64; 3]; 3], tangent: [f64; 4], area: f64) -> Self {
        let [n, t1, t2] = frame;
        let [k, k11, k12, k22] = tangent;
        let (k, k11, k12, k22) = (k * area, k11 * area, k12 * area, k22 * area);
        let mut block = [0.0; 9];
        for i in 0..3 {
            let (on, u1, u2) = (
                k * n[i],
                k11 * t1[i] + k12 * t2[i],
                k12 * t1[i] + k22 * t2[i],
            );
            for j in i..3 {
                let entry = on * n[j] + u1 * t1[j] + u2 * t2[j];
                block[3 * i + j] = entry;
                block[3 * j + i] = entry;
            }
        }
        Self { weights, block }
    }
}

/// Writes the sum of symmetric stiffnesses `[a][b][i][j]` [N/mm] into a 24 × 24 matrix. Each block is summed once and
/// written on both sides of the diagonal.
#[inline(always)]
pub fn write_symmetric<S: Simd>(simd: S, points: &[Symmetric], cell: &mut [f64]) {
    match points {
        [a] => write_sum(simd, [a], cell),
        [a, b] => write_sum(simd, [a, b], cell),
        [a, b, c] => write_sum(simd, [a, b, c], cell),
        [a, b, c, d] => write_sum(simd, [a, b, c, d], cell),
        _ => {}
    }
}

/// Entries of a block, padded to a multiple of the SIMD width.
const WIDE: usize = 12;

#[inline(always)]
fn write_sum<S: Simd, const N: usize>(simd: S, points: [&Symmetric; N], cell: &mut [f64]) {
    let Some(cell) = cell.first_chunk_mut::<{ 64 * 9 }>() else {
        return;
    };
    let mut blocks = [[0.0; WIDE]; N];
    for p in 0..N {
        blocks[p][..9].copy_from_slice(&points[p].block);
    }
    for a in 0..8 {
        for b in a..8 {
            let mut sum = [0.0; WIDE];
            let (wide, rest) = S::as_mut_simd_f64s(&mut sum);
            for p in 0..N {
                let weight = points[p].weights[a] * points[p].weights[b];
                let (from, from_rest) = S::as_simd_f64s(&blocks[p]);
                for (to, from) in wide.iter_mut().zip(from) {
                    let product = simd.mul_f64s(simd.splat_f64s(weight), *from);
                    *to = simd.add_f64s(*to, product);
                }
                for (to, from) in rest.iter_mut().zip(from_rest) {
                    *to += weight * from;
                }
            }
            cell[(a * 8 + b) * 9..][..9].copy_from_slice(&sum[..9]);
            cell[(b * 8 + a) * 9..][..9].copy_from_slice(&sum[..9]);
        }
    }
}
