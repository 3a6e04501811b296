//! Strength of the cap as a function of its plastic displacement (theory/joint-cap.md, eqs 9 to 12).

use std::f64::consts::FRAC_PI_4;

/// Hardening and softening of the cap: an ellipse up to the peak, then a parabola, then an exponential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapCurve {
    /// Compressive strength f_m [MPa].
    pub strength: f64,
    /// Plastic displacement at the peak κ_p [mm].
    pub peak: f64,
    /// Plastic displacement at half the strength after the peak κ_m [mm].
    pub middle: f64,
}

impl CapCurve {
    /// Strength at zero plastic displacement, divided by f_m.
    pub const INITIAL: f64 = 1.0 / 3.0;
    /// Strength at the end of the parabola, divided by f_m.
    pub const MIDDLE: f64 = 0.5;
    /// Residual strength, the asymptote of the exponential, divided by f_m.
    pub const RESIDUAL: f64 = 1.0 / 7.0;

    /// Area between curve and residual strength up to the peak, divided by f_m κ_p.
    pub const RISING: f64 = Self::INITIAL + (1.0 - Self::INITIAL) * FRAC_PI_4 - Self::RESIDUAL;
    /// Area between curve and residual strength beyond the peak, divided by f_m (κ_m − κ_p).
    const FALLING: f64 = 1.0 + (Self::MIDDLE - 1.0) / 3.0 - Self::RESIDUAL
        + 0.5 * (Self::MIDDLE - Self::RESIDUAL) * (Self::MIDDLE - Self::RESIDUAL)
            / (1.0 - Self::MIDDLE);

    /// The curve with strength `strength` [MPa], its peak at `peak` [mm] and the area `energy` [N/mm] above the
    /// residual strength. `None` if the part before the peak alone has that area.
    pub fn with_energy(strength: f64, peak: f64, energy: f64) -> Option<Self> {
        let falling = energy - Self::RISING * strength * peak;
        (falling > 0.0).then(|| Self {
            strength,
            peak,
            middle: peak + falling / (Self::FALLING * strength),
        })
    }

    /// Area between curve and residual strength, G_fc [N/mm].
    pub fn energy(&self) -> f64 {
        let rising = Self::RISING * self.peak;
        self.strength * (rising + Self::FALLING * (self.middle - self.peak))
    }

    /// Magnitude of the steepest softening slope [N/mm³].
    pub fn steepest(&self) -> f64 {
        2.0 * (1.0 - Self::MIDDLE) * self.strength / (self.middle - self.peak)
    }

    /// Strength [MPa] and its slope [N/mm³] at the plastic displacement κ [mm]. The slope at κ = 0 is infinite; the
    /// slope at 10⁻⁹ κ_p is returned instead.
    pub fn evaluate(&self, kappa: f64) -> (f64, f64) {
        let f = self.strength;
        if kappa < self.peak {
            let x = (kappa / self.peak).max(1e-9);
            let root = (2.0 * x - x * x).sqrt();
            let rise = 1.0 - Self::INITIAL;
            let value = if kappa > 0.0 { root } else { 0.0 };
            return (
                f * (Self::INITIAL + rise * value),
                f * rise * (1.0 - x) / (root * self.peak),
            );
        }
        let width = self.middle - self.peak;
        if kappa < self.middle {
            let x = (kappa - self.peak) / width;
            let fall = Self::MIDDLE - 1.0;
            return (f * (1.0 + fall * x * x), 2.0 * f * fall * x / width);
        }
        let slope = 2.0 * (Self::MIDDLE - 1.0) / width;
        let above = Self::MIDDLE - Self::RESIDUAL;
        let decay = (slope * (kappa - self.middle) / above).exp();
        (f * (Self::RESIDUAL + above * decay), f * slope * decay)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_the_curve_is_its_energy_and_slopes_are_its_derivatives() {
        let curve = CapCurve::with_energy(8.5, 0.09, 5.0).unwrap();
        let n = 2_000_000;
        let (end, mut area) = (20.0 * curve.middle, 0.0);
        for k in 0..n {
            let kappa = end * (f64::from(k) + 0.5) / f64::from(n);
            area += curve.evaluate(kappa).0 - CapCurve::RESIDUAL * curve.strength;
        }
        area *= end / f64::from(n);
        // Midpoint rule: the vertical tangent at κ = 0 leaves an error of (end/n)^1.5.
        assert!((area / 5.0 - 1.0).abs() < 1e-6, "{area}");
        assert!((curve.energy() / 5.0 - 1.0).abs() < 1e-14);
        for kappa in [0.001, 0.05, 0.0899, 0.0901, 0.3, 0.9, 2.0] {
            let h = 1e-7;
            let difference =
                (curve.evaluate(kappa + h).0 - curve.evaluate(kappa - h).0) / (2.0 * h);
            let slope = curve.evaluate(kappa).1;
            // Tolerance: rounding 1e-15/h and the curvature of the ellipse.
            assert!(
                (difference - slope).abs() < 1e-5 * (1.0 + slope.abs()),
                "{kappa}"
            );
            assert!(slope >= -curve.steepest() * (1.0 + 1e-12));
        }
        assert!((curve.evaluate(0.0).0 - 8.5 / 3.0).abs() < 1e-15 * 8.5);
        assert_eq!(curve.evaluate(0.09).0, 8.5);
        assert_eq!(CapCurve::with_energy(8.5, 0.09, 0.5), None);
    }
}
