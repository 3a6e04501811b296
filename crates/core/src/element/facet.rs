//! Area vectors of bilinear four-node facets, and their derivatives by the nodal positions.
//!
//! With x = Σ N_b x_b and the tangents x_ξ, x_η, a unit pressure exerts the force −A_a on node a, with
//!
//! ```text
//! A_a = ∫ N_a x_ξ × x_η dξ dη
//! ```
//!
//! The integrand is biquadratic in ξ, η, so that 2×2 Gauss points integrate it exactly, also on a warped facet. Its
//! derivative (Hibbitt 1979; Simo, Taylor, Wriggers 1991) is
//!
//! ```text
//! ∂A_a/∂x_b = ∫ N_a (N_b,η [x_ξ]× − N_b,ξ [x_η]×) dξ dη,   [v]× w = v × w
//! ```
//!
//! This matrix is unsymmetric for a single facet. The sum over a closed surface, or over a surface with a fixed
//! boundary, is symmetric, because the pressure then has a potential.

use crate::element::hexahedron::{cross, norm};

/// Corners in the order of a facet's nodes. `[node][ξη]`
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Shape functions, their derivatives and the tangents at a point.
struct Point {
    n: [f64; 4],
    dn: [[f64; 2]; 4],
    /// x_ξ, x_η [mm].
    tangents: [[f64; 3]; 2],
}

/// The 2×2 Gauss points; each has weight 1.
fn points(x: &[[f64; 3]; 4]) -> impl Iterator<Item = Point> + '_ {
    let g = 1.0 / 3.0_f64.sqrt();
    CORNERS.iter().map(move |corner| {
        let [r, s] = corner.map(|c| g * c);
        let n = CORNERS.map(|[a, b]| 0.25 * (1.0 + a * r) * (1.0 + b * s));
        let dn = CORNERS.map(|[a, b]| [0.25 * a * (1.0 + b * s), 0.25 * b * (1.0 + a * r)]);
        let tangents = [0, 1]
            .map(|t| [0, 1, 2].map(|i| dn.iter().zip(x).map(|(dn, x)| dn[t] * x[i]).sum::<f64>()));
        Point { n, dn, tangents }
    })
}

/// Outward area vectors A_a [mm²] of a facet with nodes at `x` [mm], counter-clockwise seen from outside. `[node]`
pub fn area_vectors(x: &[[f64; 3]; 4]) -> [[f64; 3]; 4] {
    let mut areas = [[0.0; 3]; 4];
    for point in points(x) {
        let normal = cross(point.tangents[0], point.tangents[1]);
        for (area, n) in areas.iter_mut().zip(point.n) {
            for i in 0..3 {
                area[i] += n * normal[i];
            }
        }
    }
    areas
}

/// Tributary areas ∫ N_a dA [mm²] of the nodes of a facet at `x` [mm]. `[node]`
pub fn areas(x: &[[f64; 3]; 4]) -> [f64; 4] {
    let mut areas = [0.0; 4];
    for point in points(x) {
        let size = norm(cross(point.tangents[0], point.tangents[1]));
        for (area, n) in areas.iter_mut().zip(point.n) {
            *area += n * size;
        }
    }
    areas
}

/// Relative difference of shares that are equal but for rounding.
const EVEN: f64 = 1e-9;

/// The same as parts of their sum. Those of a parallelogram are quarters to the last digit.
pub fn shares(x: &[[f64; 3]; 4]) -> [f64; 4] {
    let areas = areas(x);
    let sum: f64 = areas.iter().sum();
    let shares = areas.map(|area| area / sum);
    if shares.iter().any(|share| (4.0 * share - 1.0).abs() > EVEN) {
        shares
    } else {
        [0.25; 4]
    }
}

/// ∂A_a/∂x_b [mm]. `[a][b][i][j]`
pub fn turning(x: &[[f64; 3]; 4]) -> [[[[f64; 3]; 3]; 4]; 4] {
    let mut slopes = [[[[0.0; 3]; 3]; 4]; 4];
    for Point { n, dn, tangents } in points(x) {
        for (of_a, n) in slopes.iter_mut().zip(n) {
            for (block, dn) in of_a.iter_mut().zip(dn) {
                let v: [f64; 3] =
                    [0, 1, 2].map(|i| n * (dn[1] * tangents[0][i] - dn[0] * tangents[1][i]));
                // [v]×
                for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                    block[j][i] += v[k];
                    block[i][j] -= v[k];
                }
            }
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    const WARPED: [[f64; 3]; 4] = [
        [0.1, -0.2, 0.3],
        [9.0, 1.0, -1.0],
        [8.0, 6.5, 2.0],
        [-1.0, 5.0, 0.5],
    ];

    #[test]
    fn a_flat_rectangle_shares_its_area_evenly() {
        let x = [
            [0.0, 0.0, 2.0],
            [8.0, 0.0, 2.0],
            [8.0, 3.0, 2.0],
            [0.0, 3.0, 2.0],
        ];
        for area in area_vectors(&x) {
            for (found, exact) in area.into_iter().zip([0.0, 0.0, 6.0]) {
                assert!((found - exact).abs() < 1e-14, "{area:?}"); // rounding
            }
        }
        assert!(areas(&x).iter().all(|a| (a - 6.0).abs() < 1e-14));
        assert_eq!(shares(&x), [0.25; 4]);
    }

    /// ∫ x dA of a trapezium, 6 and 2 wide and 3 high: its centroid is at 3/3 × (6 + 2 × 2)/(6 + 2) of its height.
    #[test]
    fn shares_of_a_trapezium_have_its_centroid() {
        let x = [
            [0.0, 0.0, 0.0],
            [6.0, 0.0, 0.0],
            [4.0, 3.0, 0.0],
            [2.0, 3.0, 0.0],
        ];
        let shares = shares(&x);
        let at = |i: usize| -> f64 { shares.iter().zip(&x).map(|(s, x)| s * x[i]).sum() };
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-14); // rounding
        assert!((at(0) - 3.0).abs() < 1e-14, "{shares:?}");
        assert!((at(1) - 1.25).abs() < 1e-14, "{shares:?}");
    }

    /// The area vectors sum to half the cross product of the diagonals, also on a warped facet.
    #[test]
    fn a_warped_facet_has_the_area_vector_of_its_rim() {
        let sum = area_vectors(&WARPED)
            .into_iter()
            .fold([0.0; 3], |s, a| [0, 1, 2].map(|i| s[i] + a[i]));
        let exact = crate::element::hexahedron::area_vector(&WARPED);
        for i in 0..3 {
            assert!((sum[i] - exact[i]).abs() < 1e-13, "{sum:?} {exact:?}"); // rounding
        }
    }

    #[test]
    fn derivatives_of_areas_equal_central_differences() {
        const H: f64 = 1e-3;
        let slopes = turning(&WARPED);
        for b in 0..4 {
            for j in 0..3 {
                let at = |h: f64| {
                    let mut x = WARPED;
                    x[b][j] += h;
                    area_vectors(&x)
                };
                let (ahead, behind) = (at(H), at(-H));
                for a in 0..4 {
                    for i in 0..3 {
                        // The area vectors are quadratic in each coordinate, so that central differences are exact up
                        // to rounding.
                        let slope = (ahead[a][i] - behind[a][i]) / (2.0 * H);
                        let error = (slope - slopes[a][b][i][j]).abs();
                        assert!(error < 1e-11, "{a} {b} {i} {j}: {slope}");
                    }
                }
            }
        }
    }
}
