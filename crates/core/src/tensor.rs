//! Symmetric 3 × 3 tensors in Voigt order xx, yy, zz, xy, yz, zx.

use nalgebra::{Matrix3, Vector3, Vector6};

/// Voigt components of eight points, with the points in vector lanes. `[component][point]`
pub type ByPoint = [[f64; 8]; 6];

/// Unit tensor.
pub const UNIT: Vector6<f64> = Vector6::new(1.0, 1.0, 1.0, 0.0, 0.0, 0.0);

/// Mean of the normal components.
#[inline(always)]
pub fn mean(s: &Vector6<f64>) -> f64 {
    (s[0] + s[1] + s[2]) / 3.0
}

/// s:s of a stress-like tensor (with shear components as they are).
#[inline(always)]
pub fn norm_squared(s: &Vector6<f64>) -> f64 {
    s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])
}

/// Matrix of a stress-like tensor.
#[inline(always)]
pub fn matrix(s: &Vector6<f64>) -> Matrix3<f64> {
    Matrix3::new(s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2])
}

/// n ⊗ n, stress-like.
#[inline(always)]
pub fn dyad(n: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(
        n.x * n.x,
        n.y * n.y,
        n.z * n.z,
        n.x * n.y,
        n.y * n.z,
        n.z * n.x,
    )
}

/// A symmetric tensor reduced to its most distinct principal value and a 2 × 2 block.
struct Reduced {
    mean: f64,
    /// Largest component of the deviator. The following members are divided by it.
    scale: f64,
    /// Whether the distinct value is the largest. Otherwise it is the smallest.
    largest: bool,
    /// Its direction, and two directions normal to it.
    basis: [Vector3<f64>; 3],
    /// Components 11, 22, 12 of the tensor in the plane of the last two directions.
    block: [f64; 3],
}

impl Reduced {
    /// Method of W. M. Scherzinger and C. R. Dohrmann, Comput. Methods Appl. Mech. Engrg. 197 (2008) 4007. The
    /// separate root of the characteristic cubic is well conditioned, and so is the remaining 2 × 2 problem normal to
    /// its direction. The other two roots of the cubic would lose half of their digits where they coincide. None for
    /// a multiple of the unit tensor.
    #[inline(always)]
    fn new(s: &Vector6<f64>) -> Option<Self> {
        let mean = mean(s);
        let deviator = s - UNIT * mean;
        let scale = deviator.amax();
        if scale <= f64::MIN_POSITIVE {
            return None;
        }
        let a = matrix(&(deviator / scale));
        let j2 = 0.5 * norm_squared(&(deviator / scale));
        let j3 = a.determinant();
        // s = 2 √(J₂/3) c with 4c³ − 3c = |cos 3θ| and c in [√3/2, 1]. A cubic through Chebyshev's points errs by
        // 4e-5, and each Newton step doubles the number of digits.
        let radius = (j2 / 3.0).sqrt();
        let w = (0.5 * j3.abs() / (radius * radius * radius)).min(1.0);
        let mut c = 0.866_066_33 + w * (0.165_330_35 + w * (-0.040_691_2 + w * 0.009_319_68));
        for _ in 0..2 {
            c -= ((4.0 * c * c - 3.0) * c - w) / (12.0 * c * c - 3.0);
        }
        let distinct = (2.0 * radius * c).copysign(j3);
        // The columns of a − s 1 span the plane normal to its direction.
        let mut columns = [
            Vector3::new(a.m11 - distinct, a.m21, a.m31),
            Vector3::new(a.m12, a.m22 - distinct, a.m32),
            Vector3::new(a.m13, a.m23, a.m33 - distinct),
        ];
        take_longest(&mut columns);
        let u = columns[0].normalize();
        for column in &mut columns[1..] {
            *column -= u * u.dot(column);
        }
        take_longest(&mut columns[1..]);
        let v = columns[1].normalize();
        let (au, av) = (a * u, a * v);
        Some(Self {
            mean,
            scale,
            largest: j3 >= 0.0,
            basis: [u.cross(&v), u, v],
            block: [u.dot(&au), v.dot(&av), u.dot(&av)],
        })
    }

    /// Half the trace, half the difference of the diagonal, and half the difference of the principal values of the
    /// block.
    #[inline(always)]
    fn circle(&self) -> (f64, f64, f64) {
        let [uu, vv, uv] = self.block;
        let half = 0.5 * (uu - vv);
        (0.5 * (uu + vv), half, (half * half + uv * uv).sqrt())
    }

    /// Principal values in descending order.
    #[inline(always)]
    fn values(&self) -> [f64; 3] {
        let (middle, _, radius) = self.circle();
        let pair = [middle + radius, middle - radius];
        // The deviator has no trace.
        let distinct = -2.0 * middle;
        let values = if self.largest {
            [distinct, pair[0], pair[1]]
        } else {
            [pair[0], pair[1], distinct]
        };
        let (scale, mean) = (self.scale, self.mean);
        [
            scale * values[0] + mean,
            scale * values[1] + mean,
            scale * values[2] + mean,
        ]
    }

    /// Directions in the order of the values.
    #[inline(always)]
    fn directions(&self) -> [Vector3<f64>; 3] {
        let (_, half, radius) = self.circle();
        let [n, u, v] = self.basis;
        // Of two forms of the eigenvector, the one without cancellation is used.
        let (x, y) = if radius == 0.0 {
            (1.0, 0.0)
        } else if half >= 0.0 {
            (half + radius, self.block[2])
        } else {
            (self.block[2], radius - half)
        };
        let length = (x * x + y * y).sqrt();
        let (x, y) = (x / length, y / length);
        let (first, second) = (u * x + v * y, v * x - u * y);
        if self.largest {
            [n, first, second]
        } else {
            [first, second, n]
        }
    }
}

/// Moves the longest vector to the front.
#[inline(always)]
fn take_longest(vectors: &mut [Vector3<f64>]) {
    for i in 1..vectors.len() {
        if vectors[i].norm_squared() > vectors[0].norm_squared() {
            vectors.swap(0, i);
        }
    }
}

/// Principal values in descending order, with directions on request. They are accurate to a few rounding errors of
/// the largest value, even where values coincide.
pub(crate) struct Principal {
    mean: f64,
    /// None for a multiple of the unit tensor.
    reduced: Option<Reduced>,
}

impl Principal {
    #[inline(always)]
    pub fn of(s: &Vector6<f64>) -> Self {
        Self {
            mean: mean(s),
            reduced: Reduced::new(s),
        }
    }

    #[inline(always)]
    pub fn values(&self) -> [f64; 3] {
        self.reduced
            .as_ref()
            .map_or([self.mean; 3], Reduced::values)
    }

    #[inline(always)]
    pub fn directions(&self) -> [Vector3<f64>; 3] {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        self.reduced.as_ref().map_or(axes, Reduced::directions)
    }
}

/// Principal values in descending order, accurate to a few rounding errors of the largest value, even where values
/// coincide.
pub fn principal_values(s: &Vector6<f64>) -> [f64; 3] {
    Principal::of(s).values()
}

/// Principal values in descending order, and their directions.
pub fn principal(s: &Vector6<f64>) -> ([f64; 3], [Vector3<f64>; 3]) {
    let principal = Principal::of(s);
    (principal.values(), principal.directions())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of n ⊗ n times the values must be the tensor, with orthonormal n.
    fn check(s: &Vector6<f64>) {
        let (values, directions) = principal(s);
        assert_eq!(values, principal_values(s));
        assert!(
            values[0] >= values[1] && values[1] >= values[2],
            "{values:?}"
        );
        let mut rebuilt = Vector6::zeros();
        for i in 0..3 {
            rebuilt += dyad(&directions[i]) * values[i];
            for j in 0..3 {
                let unit = if i == j { 1.0 } else { 0.0 };
                // Rounding errors of products of unit vectors.
                assert!((directions[i].dot(&directions[j]) - unit).abs() < 1e-14);
            }
        }
        // Some ten rounding errors of the largest component.
        assert!((rebuilt - s).amax() <= 3e-15 * s.amax(), "{s} {rebuilt}");
    }

    #[test]
    fn principal_values_rebuild_the_tensor() {
        let tensors = [
            [1.0, 2.0, 3.0, 0.4, -0.5, 0.6],
            [5.0, 5.0, 5.0, 0.0, 0.0, 0.0],
            [5.0, 5.0, -1.0, 1e-14, 0.0, 0.0],
            [-5.0, 5.0, -5.0, 0.0, 1e-9, 1e-15],
            [0.0, 0.0, 0.0, 3.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            [0.0, 0.0, 0.0, 1.0, -1.0, 1.0],
            [1e-200, 3e-200, 0.0, 0.0, 1e-200, 0.0],
            [1e200, 3e200, 0.0, 0.0, 1e200, 0.0],
            [1.0, 0.0, -1.0, 0.0, 0.0, 0.0],
        ];
        check(&Vector6::zeros());
        for s in tensors {
            check(&s.into());
        }
    }

    #[test]
    fn coinciding_values_keep_their_digits_in_any_direction() {
        // Rotated diag(2, 2 − e, −1) and diag(−2, −2 + e, 1), with the difference e from 1 to zero.
        let turn = *nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0).matrix();
        for k in 0..60 {
            let e = if k == 59 { 0.0 } else { 0.5_f64.powi(k) };
            for sign in [1.0, -1.0] {
                let exact = [2.0, 2.0 - e, -1.0].map(|v| sign * v);
                let m = turn * Matrix3::from_diagonal(&Vector3::from(exact)) * turn.transpose();
                let s = Vector6::new(
                    m[(0, 0)],
                    m[(1, 1)],
                    m[(2, 2)],
                    m[(0, 1)],
                    m[(1, 2)],
                    m[(0, 2)],
                );
                check(&s);
                let mut sorted = exact;
                sorted.sort_by(|a, b| b.total_cmp(a));
                let found = principal_values(&s);
                for i in 0..3 {
                    // Rounding errors of the rotation.
                    assert!(
                        (found[i] - sorted[i]).abs() < 4e-15,
                        "gap {e:.1e}: {found:?}"
                    );
                }
            }
        }
    }
}
