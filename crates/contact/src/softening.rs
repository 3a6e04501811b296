//! Exponential softening, the paper's Q(u) and H(δ) (theory/joint.md, eqs 6, 8 and 10).
//!
//! ```text
//! S(w) = (1 − e^{−ζ w/w_k}) / (1 − e^{−ζ}),  S = 1 beyond w_k
//! ```
//!
//! A bond in one mode only has w_k = 0 in the other mode. The curve is then a step: S(0) = 0, and S = 1 for w > 0.

/// One softening curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softening {
    /// Ultimate separation u_k or δ_k [mm].
    pub ultimate: f64,
    /// Brittleness ζ or ξ [-]; 0 is linear softening.
    pub brittleness: f64,
}

/// Below this brittleness the curve is linear within rounding of (1 − e^{−ζ})/ζ.
const LINEAR: f64 = 1e-8;

impl Softening {
    /// S(w) and S'(w) [1/mm]. From w_k on they are (1, 0).
    pub fn evaluate(&self, w: f64) -> (f64, f64) {
        self.evaluate_with(w, &mut None)
    }

    /// The same with a cached value of 1 − e^{−ζ}.
    #[inline]
    pub(crate) fn evaluate_with(&self, w: f64, whole: &mut Option<f64>) -> (f64, f64) {
        if self.ultimate <= 0.0 {
            return (if w > 0.0 { 1.0 } else { 0.0 }, 0.0);
        }
        if w >= self.ultimate {
            return (1.0, 0.0);
        }
        let (z, x) = (self.brittleness, w.max(0.0) / self.ultimate);
        if z.abs() < LINEAR {
            return (x, 1.0 / self.ultimate);
        }
        let whole = *whole.get_or_insert_with(|| -(-z).exp_m1());
        let part = -(-z * x).exp_m1();
        // e^{−ζx} = 1 − (1 − e^{−ζx}).
        (part / whole, z * (1.0 - part) / (whole * self.ultimate))
    }

    /// Largest S' [1/mm]: at w = 0, or at w_k for a negative brittleness; 0 for a step.
    pub fn steepest(&self) -> f64 {
        if self.ultimate <= 0.0 {
            return 0.0;
        }
        self.evaluate(0.0).1 * (-self.brittleness).exp().max(1.0)
    }

    /// Inverse: w with S(w) = `s`, 0 ≤ s ≤ 1 [mm].
    pub fn inverse(&self, s: f64) -> f64 {
        if s >= 1.0 {
            return self.ultimate;
        }
        let z = self.brittleness;
        if z.abs() < LINEAR {
            return s * self.ultimate;
        }
        -(s * (-z).exp_m1()).ln_1p() / z * self.ultimate
    }

    /// ∫₀¹ (1 − S) dx = 1/ζ − 1/(e^ζ − 1) (theory/joint.md, eqs 30 and 31); ½ for ζ → 0.
    pub fn shape_integral(brittleness: f64) -> f64 {
        let z = brittleness;
        if z.abs() < 1e-3 {
            // Series ½ − ζ/12 + ζ³/720, because the closed form cancels here.
            0.5 - z / 12.0 + z * z * z / 720.0
        } else {
            1.0 / z - 1.0 / z.exp_m1()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_integrals_of_the_paper() {
        // Printed with six digits in theory/joint.md, eqs 30 and 31.
        assert!((Softening::shape_integral(4.38) - 0.215626).abs() < 5e-7);
        assert!((Softening::shape_integral(1.1) - 0.410130).abs() < 5e-7);
        // Series and closed form agree at the change-over; cancellation costs 1e-13.
        let z = 1e-3_f64;
        let closed = 1.0 / z - 1.0 / z.exp_m1();
        assert!((Softening::shape_integral(z * 0.999_999_9) - closed).abs() < 1e-9);
    }

    #[test]
    fn inverse_and_slope() {
        for brittleness in [0.0, 1e-6, 0.3, 1.1, 4.38, -1.5] {
            let curve = Softening {
                ultimate: 0.36,
                brittleness,
            };
            for k in 1..20 {
                let w = 0.36 * f64::from(k) / 20.0;
                let (s, slope) = curve.evaluate(w);
                // A round trip of exp and ln; conditioning up to e^4.38.
                assert!((curve.inverse(s) - w).abs() < 1e-13, "{brittleness} {w}");
                let h = 1e-6;
                let difference = (curve.evaluate(w + h).0 - curve.evaluate(w - h).0) / (2.0 * h);
                // Central difference: rounding 1e-16/h and curvature h².
                assert!((difference - slope).abs() < 1e-8, "{brittleness} {w}");
            }
            assert_eq!(curve.evaluate(0.36), (1.0, 0.0));
            let ends = [0.0, 0.36 * (1.0 - 1e-14)].map(|w| curve.evaluate(w).1);
            // Rounding of an exponential, and 1e-14 of the length.
            assert!((curve.steepest() / ends[0].max(ends[1]) - 1.0).abs() < 1e-12);
        }
    }
}
