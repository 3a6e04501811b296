//! Bilinear idealisation of a curve: stiffness, yield, capacity and ductility of a wall.
//!
//! ```text
//! force ▲          ╭────╮ F_max
//!  V_u  │┄┄┄┄┄╱┄╭──╯┄┄┄┄╰───┄┄┄┄┐        1  k = secant through 0.7 F_max
//!       │    ╱╭─╯               ╲ 0.8 F_max
//!       │   ╱╭╯                 │        2  d_u: the force has fallen to 0.8 F_max
//!       │  ╱╭╯                  │        3  the area below both lines up to d_u is the same:
//!       └─╱─────┴───────────────┴──▶         V_u (d_u − V_u / (2 k)) = ∫ F dd
//!             d_y              d_u
//! ```
//!
//! The equal areas and the fall to 0.8 F_max are those of Magenes and Calvi (1997, *In-plane seismic response of brick
//! masonry walls*, Earthquake Eng. Struct. Dyn. 26) and Tomaževič (1999, *Earthquake-resistant design of masonry
//! buildings*). The latter puts the end of elastic behaviour at about 0.7 F_max; the former takes 0.75 V_u instead.

use serde::{Deserialize, Serialize};

use crate::results::backbone::{Backbone, area};
pub use crate::results::curve::ULTIMATE;

/// Part of the largest force through which the elastic branch passes.
pub const ELASTIC: f64 = 0.7;

/// A bilinear curve with the same energy. Displacements and forces are those of the drive, negative on the opposite
/// side of a drive to and fro.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct Bilinear {
    /// Secant through [`ELASTIC`] of the largest force k [kN/mm].
    pub stiffness_kN_per_mm: f64,
    /// Force of the plastic branch V_u [kN].
    pub ultimate_force_kN: f64,
    /// Displacement at which it begins d_y = V_u/k [mm].
    pub yield_displacement_mm: f64,
    /// Ultimate displacement d_u [mm].
    pub ultimate_displacement_mm: f64,
    /// Drift at the ultimate displacement [-]; `None` without a clear height.
    pub ultimate_drift: Option<f64>,
    /// d_u/d_y [-], both from the start of the drive.
    pub ductility: f64,
    /// Whether the force has fallen to [`ULTIMATE`] of the largest; otherwise d_u is the end of the curve.
    pub reached_80_percent: bool,
}

impl Bilinear {
    /// Idealisation of one side, with the clear height [mm]; `None` without a rise, or if the curve stiffens so much
    /// that no such line has its area.
    pub fn of(side: &Backbone, height: Option<f64>) -> Option<Self> {
        let stiffness = side.secant(ELASTIC)?;
        let (points, reached_80_percent) = side.until(ULTIMATE);
        let ultimate = points.last()?.0;
        // Forces count from that at the start of the drive, as the stiffness does.
        let from = points.first()?.1;
        let energy = area(&points) - from * ultimate;
        // V²/(2 k) − V d_u + A = 0: the smaller root, as d_y is below d_u.
        let root = ultimate * ultimate - 2.0 * energy / stiffness;
        let most = side.points()[side.peak()].1 - from;
        // A side to which the drive comes with slip has more area than a line from its start: V_u is at most F_max.
        let force = (stiffness * (ultimate - root.max(0.0).sqrt())).min(most);
        let yields = force / stiffness;
        let is_one = root >= 0.0 && energy > 0.0 && yields > 0.0;
        is_one.then(|| Self {
            stiffness_kN_per_mm: stiffness,
            ultimate_force_kN: side.force(from + force),
            yield_displacement_mm: side.displacement(yields),
            ultimate_displacement_mm: side.displacement(ultimate),
            ultimate_drift: height.map(|height| ultimate / height),
            ductility: ultimate / yields,
            reached_80_percent,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Curve;
    use approx::assert_relative_eq;

    // A few operations in f64.
    const ROUNDING: f64 = 1e-12;

    fn bilinear(points: &[(f64, f64)]) -> Option<Bilinear> {
        Bilinear::of(
            &Backbone::of(&Curve::of_points(points), false)?,
            Some(1000.0),
        )
    }

    #[test]
    fn a_bilinear_curve_is_its_own_idealisation() {
        let found = bilinear(&[(0.0, 0.0), (2.0, 50.0), (10.0, 50.0)]).unwrap();
        assert_relative_eq!(found.stiffness_kN_per_mm, 25.0, max_relative = ROUNDING);
        assert_relative_eq!(found.ultimate_force_kN, 50.0, max_relative = ROUNDING);
        assert_relative_eq!(found.yield_displacement_mm, 2.0, max_relative = ROUNDING);
        assert_relative_eq!(found.ductility, 5.0, max_relative = ROUNDING);
        assert_eq!(found.ultimate_drift, Some(0.01));
        assert!(!found.reached_80_percent);
    }

    /// 40 kN/mm to 20 kN, a peak of 50 kN at 2 mm, 45 kN at 3 mm, 30 kN at 4 mm. 35 kN lie at 1.25 mm: k = 28 kN/mm.
    /// 40 kN lie at 3 1/3 mm. Area: 5 + 52.5 + 47.5 + (45 + 40)/6 = 119 1/6 J.
    #[test]
    fn a_wall_is_idealised_by_hand() {
        let points = [
            (0.0, 0.0),
            (0.5, 20.0),
            (2.0, 50.0),
            (3.0, 45.0),
            (4.0, 30.0),
        ];
        let found = bilinear(&points).unwrap();
        assert_relative_eq!(found.stiffness_kN_per_mm, 28.0, max_relative = ROUNDING);
        let d_u = 10.0 / 3.0;
        assert_relative_eq!(found.ultimate_displacement_mm, d_u, max_relative = ROUNDING);
        assert!(found.reached_80_percent);
        let energy = 5.0 + 52.5 + 47.5 + 85.0 / 6.0;
        let v_u = 28.0 * (d_u - (d_u * d_u - 2.0 * energy / 28.0_f64).sqrt());
        assert_relative_eq!(found.ultimate_force_kN, v_u, max_relative = ROUNDING);
        let v = found.ultimate_force_kN;
        assert_relative_eq!(v * (d_u - v / 56.0), energy, max_relative = ROUNDING);
        // Driven the other way, both quantities change their sign and the stiffness does not.
        let back = bilinear(&points.map(|(d, f)| (-d, -f))).unwrap();
        assert_eq!(back.ultimate_force_kN, -found.ultimate_force_kN);
        assert_eq!(back.stiffness_kN_per_mm, found.stiffness_kN_per_mm);
        assert_eq!(back.ductility, found.ductility);
    }

    #[test]
    fn a_straight_line_has_a_ductility_of_one_and_a_stiffening_curve_none() {
        let line = bilinear(&[(0.0, 0.0), (1.0, 10.0), (2.0, 20.0)]).unwrap();
        // The root of a difference that is 0 but for rounding.
        assert_relative_eq!(line.ductility, 1.0, max_relative = 1e-6);
        assert!(bilinear(&[(0.0, 0.0), (1.0, 6.0), (2.0, 6.0), (3.0, 6.1)]).is_some());
        assert!(bilinear(&[(0.0, 0.0), (1.0, 0.0)]).is_none());
    }
}
