//! Units of files that do not give their units.

use crate::deck::unit;

/// Factors from the units of a file to those of wythe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Unit of length [mm].
    pub length: f64,
    /// Unit of force [N].
    pub force: f64,
    /// Unit of time [s].
    pub time: f64,
}

impl Default for Units {
    fn default() -> Self {
        Self {
            length: 1.0,
            force: 1.0,
            time: 1.0,
        }
    }
}

impl Units {
    /// Parses `"N, m, s"`: units of force, length and time in any order; those left out are N, mm, s.
    ///
    /// # Errors
    /// A sentence that says which part could not be read.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut units = Self::default();
        let mut said = [false; 3];
        for name in text.split(',').map(str::trim).filter(|n| !n.is_empty()) {
            let (value, dimension) = unit::parse(&format!("1 {name}"))?;
            let (place, which) = match dimension.0 {
                [1, 0, 0, 0] => (&mut units.length, 0),
                [1, 1, -2, 0] => (&mut units.force, 1),
                [0, 0, 1, 0] => (&mut units.time, 2),
                _ => return Err(format!("`{name}` is no unit of length, force or time")),
            };
            if said[which] {
                return Err(format!("`{name}` is a second one of its kind"));
            }
            said[which] = true;
            *place = value;
        }
        Ok(units)
    }

    /// Unit of stress [MPa].
    pub fn stress(&self) -> f64 {
        self.force / (self.length * self.length)
    }

    /// Unit of density [tonne/mm³]: force × time² / length⁴.
    pub fn density(&self) -> f64 {
        self.force * self.time * self.time / self.length.powi(4)
    }

    /// Unit of energy per area [N/mm].
    pub fn fracture_energy(&self) -> f64 {
        self.force / self.length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metres_and_newtons_give_pascals_and_kilograms() {
        let si = Units::parse("N, m, s").unwrap();
        // Powers of ten have one rounding each.
        assert!((si.stress() - 1e-6).abs() < 1e-21);
        assert!((si.density() - 1e-12).abs() < 1e-27);
        assert!((si.fracture_energy() - 1e-3).abs() < 1e-18);
        let kilo = Units::parse("m, kN").unwrap();
        assert!((kilo.stress() - 1e-3).abs() < 1e-18);
        assert_eq!(Units::parse(""), Ok(Units::default()));
        for (wrong, why) in [
            ("kg", "no unit of length"),
            ("m, mm", "second"),
            ("furlong", "furlong"),
        ] {
            let error = Units::parse(wrong).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
    }
}
