//! Width of a hex8 across a direction, for the band in which softening localises (theory/crack-band.md, eq. 2).

use nalgebra::{Matrix3, Vector3};

use crate::element::hex8::CORNERS;
use crate::material::Extent;

/// Extent of the element with these corners [mm] and this volume [mm³]; `None` if the Jacobian at its centroid is not
/// positive.
pub fn extent(corners: &[[f64; 3]; 8], volume: f64) -> Option<Extent> {
    // The columns of the Jacobian at the centroid are half of the mean edges.
    let mut jacobian = Matrix3::zeros();
    for (x, xi) in corners.iter().zip(&CORNERS) {
        jacobian += Vector3::from(*x) * Vector3::from(*xi).transpose() / 8.0;
    }
    let inverse = (jacobian.determinant() > 0.0)
        .then(|| jacobian.try_inverse())
        .flatten()?;
    let mut extent = Extent {
        gradient: CORNERS.map(|xi| inverse.transpose() * Vector3::from(xi) / 8.0),
        ..Extent::ball(volume.cbrt())
    };
    // The width is largest along diagonals, and smallest along edges or face normals.
    let edges = [0, 1, 2].map(|i| jacobian.column(i).into_owned());
    let signs = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9].map(|s| f64::from(s) - 1.0));
    let along = signs.map(|s| edges[0] * s[0] + edges[1] * s[1] + edges[2] * s[2]);
    let normals = [0, 1, 2].map(|i| inverse.row(i).transpose());
    let widths = along
        .chain(normals)
        .filter_map(|n: Vector3<f64>| n.try_normalize(0.0))
        .map(|n| extent.across(&n));
    extent.widths = widths.fold([f64::INFINITY, 0.0], |[a, b], w| [a.min(w), b.max(w)]);
    Some(extent)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(a: f64, b: f64, c: f64) -> [[f64; 3]; 8] {
        CORNERS.map(|[x, y, z]| [0.5 * a * x, 0.5 * b * y, 0.5 * c * z])
    }

    /// Oliver's lengths in closed form: the edge along an edge, a/cos θ for a crack rotated by θ.
    #[test]
    fn the_width_of_a_block_is_that_of_oliver() {
        let (a, b, c) = (51.0, 12.5, 49.0);
        let of = extent(&block(a, b, c), a * b * c).expect("a sound block");
        for (n, width) in [
            ([1.0, 0.0, 0.0], a),
            ([0.0, -1.0, 0.0], b),
            ([0.0, 0.0, 1.0], c),
        ] {
            assert!(
                (of.across(&Vector3::from(n)) - width).abs() < 1e-12 * width,
                "{n:?}"
            );
        }
        for degrees in [0.0_f64, 5.0, 13.0, 30.0, 45.0, 80.0] {
            let (s, c) = degrees.to_radians().sin_cos();
            let exact = 1.0 / (c / a).max(s / b);
            let width = of.across(&Vector3::new(c, s, 0.0));
            assert!(
                (width - exact).abs() < 1e-12 * exact,
                "{degrees}: {width} {exact}"
            );
        }
        assert!((of.widths[0] - b).abs() < 1e-12 * b);
        assert!(
            (of.widths[1] - a.hypot(c)).abs() < 1e-12 * a,
            "{:?}",
            of.widths
        );
        assert!(extent(&block(-1.0, 1.0, 1.0), 1.0).is_none());
    }

    /// The widths in all directions of a skewed element lie within its reported range.
    #[test]
    fn widths_lie_within_their_range() {
        let mut corners = block(40.0, 12.0, 25.0);
        for x in &mut corners {
            x[0] += 0.4 * x[1];
            x[2] += 0.3 * x[0];
        }
        let of = extent(&corners, 12_000.0).expect("a sound element");
        for i in 0..100 {
            for j in 0..50 {
                let (t, p) = (f64::from(i) * 0.063, f64::from(j) * 0.063);
                let n = Vector3::new(p.sin() * t.cos(), p.sin() * t.sin(), p.cos());
                let width = of.across(&n);
                // Tolerance: a direction of the grid may coincide with an extreme, up to rounding.
                assert!(
                    width >= of.widths[0] * (1.0 - 1e-12) && width <= of.widths[1] * (1.0 + 1e-12)
                );
            }
        }
    }
}
