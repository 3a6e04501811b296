//! Natural coordinates of a point in a hex8 element, and the weights of its nodes there.

use nalgebra::{Matrix3, Vector3};

use super::hex8::CORNERS;

/// Newton iterations of [`natural`]: the map of an element that is no box converges in three to six.
const ITERATIONS: usize = 30;

/// Weights N_a(ξ) of the eight nodes [-].
pub fn weights(xi: [f64; 3]) -> [f64; 8] {
    CORNERS.map(|c| (0..3).map(|d| 1.0 + c[d] * xi[d]).product::<f64>() / 8.0)
}

/// Natural coordinates ξ of a point with Σ N_a(ξ) x_a = x, by Newton's method; −1 to 1 inside the element. None where
/// the map does not reach the point.
pub fn natural(corners: &[[f64; 3]; 8], point: [f64; 3]) -> Option<[f64; 3]> {
    let mut xi = Vector3::zeros();
    for _ in 0..ITERATIONS {
        let n = weights(xi.into());
        let mut rest = Vector3::from(point);
        let mut jacobian = Matrix3::zeros();
        for (a, corner) in corners.iter().enumerate() {
            let x = Vector3::from(*corner);
            rest -= n[a] * x;
            let c = CORNERS[a];
            let factor = [0, 1, 2].map(|d| 1.0 + c[d] * xi[d]);
            for d in 0..3 {
                let slope = c[d] * factor[(d + 1) % 3] * factor[(d + 2) % 3] / 8.0;
                for i in 0..3 {
                    jacobian[(i, d)] += slope * x[i];
                }
            }
        }
        let step = jacobian.lu().solve(&rest)?;
        xi += step;
        // Far outside, the trilinear map may fold.
        if xi.amax() >= 50.0 || xi.iter().any(|x| x.is_nan()) {
            return None;
        }
        if step.amax() < 1e-12 {
            return Some(xi.into());
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_found_in_a_skewed_element() {
        let mut corners = CORNERS.map(|c| [50.0 * c[0] + 3.0 * c[2], 20.0 * c[1], 10.0 * c[2]]);
        corners[6][0] += 4.0;
        let wanted = [0.3, -0.8, 0.95];
        let n = weights(wanted);
        let point = [0, 1, 2].map(|d| (0..8).map(|a| n[a] * corners[a][d]).sum::<f64>());
        let found = natural(&corners, point).unwrap();
        for d in 0..3 {
            // Newton's method ends with a step below 1e-12.
            assert!((found[d] - wanted[d]).abs() < 1e-10, "{found:?}");
        }
        assert!((n.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
