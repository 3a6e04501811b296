//! Symmetric 3 × 3 tensors in Voigt order xx, yy, zz, xy, yz, zx.

use nalgebra::{Matrix3, Vector3, Vector6};

/// Unit tensor.
pub const UNIT: Vector6<f64> = Vector6::new(1.0, 1.0, 1.0, 0.0, 0.0, 0.0);

/// Mean of the normal components.
pub fn mean(s: &Vector6<f64>) -> f64 {
    (s[0] + s[1] + s[2]) / 3.0
}

/// s:s of a stress-like tensor (shear components as they are).
pub fn norm_squared(s: &Vector6<f64>) -> f64 {
    s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])
}

/// As a matrix; stress-like.
pub fn matrix(s: &Vector6<f64>) -> Matrix3<f64> {
    Matrix3::new(s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2])
}

/// n ⊗ n, stress-like.
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

/// Principal values in descending order and their directions (columns), by Jacobi's rotations:
/// accurate to rounding also where values coincide.
pub fn principal(s: &Vector6<f64>) -> ([f64; 3], [Vector3<f64>; 3]) {
    let mut a = matrix(s);
    let mut v = Matrix3::identity();
    for _ in 0..30 {
        let off = a[(0, 1)].abs() + a[(0, 2)].abs() + a[(1, 2)].abs();
        let size = a[(0, 0)].abs() + a[(1, 1)].abs() + a[(2, 2)].abs();
        if off <= 1e-17 * size || off == 0.0 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let b = a[(p, q)];
            if b == 0.0 {
                continue;
            }
            let theta = (a[(q, q)] - a[(p, p)]) / (2.0 * b);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let t = if t.is_finite() { t } else { 0.0 };
            let c = 1.0 / (t * t + 1.0).sqrt();
            let sn = t * c;
            let (app, aqq) = (a[(p, p)] - t * b, a[(q, q)] + t * b);
            let r = 3 - p - q;
            let (apr, aqr) = (a[(p, r)], a[(q, r)]);
            a[(p, p)] = app;
            a[(q, q)] = aqq;
            a[(p, q)] = 0.0;
            a[(q, p)] = 0.0;
            a[(p, r)] = c * apr - sn * aqr;
            a[(r, p)] = a[(p, r)];
            a[(q, r)] = sn * apr + c * aqr;
            a[(r, q)] = a[(q, r)];
            for k in 0..3 {
                let (vp, vq) = (v[(k, p)], v[(k, q)]);
                v[(k, p)] = c * vp - sn * vq;
                v[(k, q)] = sn * vp + c * vq;
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[(j, j)].total_cmp(&a[(i, i)]));
    (order.map(|i| a[(i, i)]), order.map(|i| v.column(i).into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_values_rebuild_the_tensor() {
        let tensors = [
            Vector6::new(1.0, 2.0, 3.0, 0.4, -0.5, 0.6),
            Vector6::new(5.0, 5.0, 5.0, 0.0, 0.0, 0.0),
            Vector6::new(5.0, 5.0, -1.0, 1e-14, 0.0, 0.0),
            Vector6::zeros(),
            Vector6::new(0.0, 0.0, 0.0, 3.0, 0.0, 0.0),
        ];
        for s in tensors {
            let (values, directions) = principal(&s);
            assert!(values[0] >= values[1] && values[1] >= values[2]);
            let mut rebuilt = Vector6::zeros();
            for i in 0..3 {
                rebuilt += dyad(&directions[i]) * values[i];
            }
            // A few roundings of numbers of size 5.
            assert!((rebuilt - s).amax() < 1e-14, "{s} {rebuilt}");
        }
    }
}
