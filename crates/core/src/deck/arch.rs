//! The voussoirs of a circular arch, and the springings that carry them.
//!
//! ```text
//!        ___---___         z
//!      /  \  |  /  \       │   voussoir 0 is the leftmost; left and right are its joints,
//!     /----     ----\      └x  bottom is its intrados, top its extrados
//!    |__|         |__|
//!   [====]       [====]   springings: held, a quarter of the thickness wider on each side
//! ```

use super::schema::DeckArch;
use crate::element::hexahedron::Corners;

/// Bodies of an arch.
pub(super) struct Stones {
    /// Voussoirs from left to right.
    pub(super) voussoirs: Vec<Corners>,
    /// Left and right springing, each as deep as the arch is thick.
    pub(super) springings: [Corners; 2],
}

/// Stones with flat faces: their corners lie on the circles of radius R ∓ t/2 at equal angles.
pub(super) fn stones(arch: &DeckArch) -> Stones {
    let (radius, thickness) = (arch.centre_line(), arch.thickness.get());
    let width = arch.width.get();
    let embrace = arch.embrace();
    let count = arch.voussoirs as usize;
    // Sine and cosine of the angle from the crown, joint by joint.
    let joint = |i: usize| (embrace * (i as f64 / count as f64 - 0.5)).sin_cos();
    let on = |(sin, cos): (f64, f64), r: f64, y: f64| [r * sin, y, r * cos];
    let (inner, outer) = (radius - 0.5 * thickness, radius + 0.5 * thickness);
    let voussoir = |i: usize| {
        let (l, r) = (joint(i), joint(i + 1));
        [
            on(l, inner, 0.0),
            on(r, inner, 0.0),
            on(r, inner, width),
            on(l, inner, width),
            on(l, outer, 0.0),
            on(r, outer, 0.0),
            on(r, outer, width),
            on(l, outer, width),
        ]
    };
    // A springing continues along the tangent of the arch; `side` is −1 at its left end, 1 at its right.
    let springing = |i: usize, side: f64| {
        let at = joint(i);
        let (low, high) = (inner - 0.25 * thickness, outer + 0.25 * thickness);
        let face = |r: f64, y: f64| on(at, r, y);
        let back = |r: f64, y: f64| {
            let x = on(at, r, y);
            let away = side * thickness;
            [x[0] + away * at.1, x[1], x[2] - away * at.0]
        };
        let ends: [&dyn Fn(f64, f64) -> [f64; 3]; 2] = if side < 0.0 {
            [&back, &face]
        } else {
            [&face, &back]
        };
        let [l, r] = ends;
        [
            l(low, 0.0),
            r(low, 0.0),
            r(low, width),
            l(low, width),
            l(high, 0.0),
            r(high, 0.0),
            r(high, width),
            l(high, width),
        ]
    };
    Stones {
        voussoirs: (0..count).map(voussoir).collect(),
        springings: [springing(0, -1.0), springing(count, 1.0)],
    }
}
