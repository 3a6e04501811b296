//! Closest-point projection onto a bilinear facet.

use nalgebra::Vector3;

use crate::surface::{MIXED, blend, shape};

/// Projection of a point onto a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Parameters of the closest point [-]. [`extend`] continues the facet beyond ±1; [`project`] stays within.
    pub xi: [f64; 2],
    /// Closest point [mm].
    pub point: Vector3<f64>,
    /// Outward unit normal of the facet there.
    pub normal: Vector3<f64>,
    /// Gap along the normal, positive outside the body [mm].
    pub gap: f64,
    /// Distance to the closest point [mm].
    pub distance: f64,
    /// True if the foot of the perpendicular lies on the facet.
    pub inside: bool,
}

/// Foot of the perpendicular on the facet, which is continued beyond its edges, by Newton's method from `start`.
/// `None` if there is no foot nearby (collapsed or strongly warped facets).
pub fn extend(p: &Vector3<f64>, corners: &[[f64; 3]; 4], start: [f64; 2]) -> Option<Projection> {
    let twist = blend(&MIXED, corners);
    let mut xi = start;
    for _ in 0..40 {
        let (n, by_s, by_t) = shape(xi);
        let (a1, a2) = (blend(&by_s, corners), blend(&by_t, corners));
        let r = p - blend(&n, corners);
        let (g11, g22) = (a1.dot(&a1), a2.dot(&a2));
        let g12 = a1.dot(&a2);
        // Hessian of ½|r|²: g_αβ − r·∂²x/∂ξ∂η off the diagonal.
        let mut off = g12 - r.dot(&twist);
        let mut det = g11 * g22 - off * off;
        let newton = det > 1e-10 * g11 * g22;
        if !newton {
            // Far from a warped facet the curvature term misleads: use Gauss–Newton.
            off = g12;
            det = g11 * g22 - g12 * g12;
        }
        if det <= 1e-20 * (g11 + g22) * (g11 + g22) || !det.is_finite() {
            return None;
        }
        let (b1, b2) = (r.dot(&a1), r.dot(&a2));
        let d = [(g22 * b1 - off * b2) / det, (g11 * b2 - off * b1) / det];
        let size = d[0].abs().max(d[1].abs());
        // Limit the step to half a facet, because the map is only bilinear.
        let factor = if size > 1.0 { 1.0 / size } else { 1.0 };
        xi = [xi[0] + factor * d[0], xi[1] + factor * d[1]];
        // Newton's method leaves the square of its last step as error, Gauss–Newton a fraction of it.
        if size < if newton { 1e-9 } else { 1e-14 } {
            break;
        }
        if !(xi[0].abs() < 50.0 && xi[1].abs() < 50.0) {
            return None;
        }
    }
    let (n, by_s, by_t) = shape(xi);
    let (a1, a2) = (blend(&by_s, corners), blend(&by_t, corners));
    let point = blend(&n, corners);
    let r = p - point;
    // Only rounding of the positions may remain of the tangential distance.
    let scale = a1.norm() + a2.norm();
    let rest = r.dot(&a1).abs().max(r.dot(&a2).abs());
    let cross = a1.cross(&a2);
    let area = cross.norm();
    if rest > 1e-9 * scale * (scale + r.norm()) || area <= 1e-14 * scale * scale {
        return None;
    }
    let normal = cross / area;
    let inside = xi[0].abs() <= 1.0 && xi[1].abs() <= 1.0;
    Some(Projection {
        xi,
        point,
        normal,
        gap: r.dot(&normal),
        distance: r.norm(),
        inside,
    })
}

/// Closest point of the facet itself, including edges and corners. It always exists; for a collapsed facet it lies on
/// the closest edge.
pub fn project(p: &Vector3<f64>, corners: &[[f64; 3]; 4]) -> Projection {
    let mut best: Option<Projection> = None;
    let mut take = |candidate: Projection| {
        if best
            .as_ref()
            .is_none_or(|b| candidate.distance < b.distance)
        {
            best = Some(candidate);
        }
    };
    // A flat facet has at most one foot, a warped facet may have several.
    let starts: &[[f64; 2]] = if is_flat(corners) {
        &STARTS[..1]
    } else {
        &STARTS
    };
    for start in starts {
        if let Some(foot) = extend(p, corners, *start).filter(|foot| foot.inside) {
            take(foot);
        }
    }
    for edge in 0..4 {
        take(on_edge(p, corners, edge));
    }
    best.unwrap_or_else(|| on_edge(p, corners, 0))
}

/// Starting points of the search for a foot.
const STARTS: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [-0.7, -0.7],
    [0.7, -0.7],
    [0.7, 0.7],
    [-0.7, 0.7],
];

/// True if the four corners lie in one plane up to rounding.
fn is_flat(corners: &[[f64; 3]; 4]) -> bool {
    let [a, b, c, d] = corners.map(Vector3::from);
    let (diagonal, other) = (c - a, d - b);
    let volume = diagonal.cross(&other).dot(&(b - a)).abs();
    volume <= 1e-12 * diagonal.norm() * other.norm() * (b - a).norm()
}

/// Closest point of an edge.
fn on_edge(p: &Vector3<f64>, corners: &[[f64; 3]; 4], edge: usize) -> Projection {
    /// Parameters of the corners.
    const CORNER: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let (a, b) = (edge, (edge + 1) % 4);
    let (xa, xb) = (Vector3::from(corners[a]), Vector3::from(corners[b]));
    let along = xb - xa;
    let length = along.norm_squared();
    let s = if length > 0.0 {
        ((p - xa).dot(&along) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let xi = [0, 1].map(|i| CORNER[a][i] + s * (CORNER[b][i] - CORNER[a][i]));
    let point = xa + s * along;
    let normal = crate::surface::frame_at(corners, xi)[0];
    let r = p - point;
    let distance = r.norm();
    // On an edge a point within rounding counts as inside.
    let inside = (r - normal * r.dot(&normal)).norm() <= 1e-12 * length.sqrt();
    Projection {
        xi,
        point,
        normal,
        gap: r.dot(&normal),
        distance,
        inside,
    }
}
