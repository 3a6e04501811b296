//! Uniaxial tables from a strength and a fracture energy (theory/crack-band.md, eqs 9 to 12).

use super::parameters::TableRow;

/// Strength and fracture energy of a branch, from which its table follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ByEnergy {
    /// Strength f_t or f_c [MPa].
    pub strength: f64,
    /// Energy beyond the peak, per area of crack or crushing plane: G_ft or G_fc [N/mm].
    pub energy: f64,
}

/// Length for which the tables are made if the deck names none [mm].
pub const UNIT_LENGTH: f64 = 1.0;

/// Stresses of the rows in tension over f_t; 2 % are left.
const TENSION: [f64; 9] = [1.0, 0.78, 0.58, 0.42, 0.29, 0.19, 0.11, 0.05, 0.02];

/// x of the rows of the hardening parabola (theory/crack-band.md, eq. 11).
const HARDENING: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// Stresses of the rows in compression from the peak on, over f_c; 5 % are left.
const CRUSHING: [f64; 7] = [1.0, 0.95, 0.8, 0.6, 0.4, 0.2, 0.05];

/// Largest damage of a row: what is left of the stiffness keeps the matrices sound.
const MOST_DAMAGE: f64 = 0.95;

impl ByEnergy {
    /// Rows in tension, for elements of `length` [mm] across the crack.
    ///
    /// The stress decays exponentially with the opening. The openings of the rows are stretched by 0.6 %, so that the
    /// area below the straight lines between them is the energy exactly.
    pub fn tension(self, length: f64) -> Vec<TableRow> {
        let openings = TENSION.map(|part| -part.ln());
        self.softening(&TENSION, &openings, 0.0, length)
    }

    /// Rows in compression, for elements of `length` [mm] across the crushing plane, with Young's modulus `e` [MPa].
    ///
    /// A parabola rises from f_c/3 to f_c at the inelastic strain 2 f_c/3E, without damage; a second one falls. The
    /// area below the second one is the energy exactly; that below the first one is not part of it.
    pub fn compression(self, e: f64, length: f64) -> Vec<TableRow> {
        let third = self.strength / 3.0;
        let at_peak = 2.0 * third / e;
        let mut rows: Vec<TableRow> = HARDENING
            .iter()
            .map(|x| TableRow {
                stress: third * (1.0 + 4.0 * x - 2.0 * x * x),
                inelastic_strain: at_peak * x * x,
                damage: 0.0,
            })
            .collect();
        let closings = CRUSHING.map(|part| (1.0 - part).sqrt());
        rows.extend(self.softening(&CRUSHING, &closings, at_peak, length));
        rows
    }

    /// Rows from the peak on: `parts` of the strength at displacements in proportion to `shape`.
    fn softening(self, parts: &[f64], shape: &[f64], at_peak: f64, length: f64) -> Vec<TableRow> {
        let lines = parts.windows(2).zip(shape.windows(2));
        let area: f64 = lines
            .map(|(s, w)| 0.5 * (s[0] + s[1]) * (w[1] - w[0]))
            .sum();
        let unit = self.energy / (self.strength * area); // [mm]
        let rows = parts.iter().zip(shape);
        rows.map(|(part, w)| TableRow {
            stress: self.strength * part,
            inelastic_strain: at_peak + w * unit / length,
            damage: (1.0 - part).min(MOST_DAMAGE),
        })
        .collect()
    }
}

/// Areas below the rows of a table over the inelastic strain, up to the peak and beyond it [N/mm²]. Times the length
/// for which the table holds they are energies per area.
pub fn areas(rows: &[TableRow]) -> [f64; 2] {
    let peak = super::uniaxial::peak_row(rows);
    let mut sums = [0.0; 2];
    for (i, pair) in rows.windows(2).enumerate() {
        let width = pair[1].inelastic_strain - pair[0].inelastic_strain;
        sums[usize::from(i >= peak)] += 0.5 * (pair[0].stress + pair[1].stress) * width;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::uniaxial::snap_back;
    use crate::material::{Branch, Curve, Interpolation};

    const TENSILE: ByEnergy = ByEnergy {
        strength: 2.0,
        energy: 0.058,
    };
    const CRUSHED: ByEnergy = ByEnergy {
        strength: 20.0,
        energy: 22.0,
    };

    #[test]
    fn the_area_beyond_the_peak_is_the_energy() {
        for length in [1.0, 12.5, 50.0] {
            let [before, beyond] = areas(&TENSILE.tension(length));
            // Tolerance: rounding of a sum of eight terms.
            assert!((length * beyond - TENSILE.energy).abs() < 1e-15 && before == 0.0);
            let [before, beyond] = areas(&CRUSHED.compression(6000.0, length));
            assert!((length * beyond - CRUSHED.energy).abs() < 1e-13);
            // The parabola has 16/27 f_c²/E before the peak, its three and four lines a little less.
            let exact = 16.0 / 27.0 * CRUSHED.strength.powi(2) / 6000.0;
            assert!(before < exact && before > 0.97 * exact, "{before} {exact}");
        }
    }

    #[test]
    fn the_rows_lie_on_their_curves() {
        let [f, g] = [TENSILE.strength, TENSILE.energy];
        for row in TENSILE.tension(1.0) {
            let exact = -(g / f) * (row.stress / f).ln();
            // The stretch of the openings, as documented.
            assert!((row.inelastic_strain - exact).abs() <= 0.006 * exact);
        }
        let rows = CRUSHED.compression(6000.0, 10.0);
        let peak = rows.iter().find(|r| r.stress == 20.0).unwrap();
        assert_eq!(rows[0].stress, 20.0 / 3.0);
        assert!((peak.inelastic_strain - 2.0 / 3.0 * 20.0 / 6000.0).abs() < 1e-18);
        // Total strain 5/3 f_c/E at the peak.
        let total = peak.inelastic_strain + peak.stress / 6000.0;
        assert!((total - 5.0 / 3.0 * 20.0 / 6000.0).abs() < 1e-17);
    }

    #[test]
    fn curves_exist_up_to_the_snap_back_limit() {
        for e in [500.0, 6000.0, 60_000.0] {
            let rows = [
                (Branch::Tension, TENSILE.tension(1.0)),
                (Branch::Compression, CRUSHED.compression(e, 1.0)),
            ];
            for (branch, rows) in rows {
                let (_, limit) = snap_back(e, &rows).unwrap();
                for part in [0.01, 0.5, 0.899, 0.99] {
                    let scaling = Some((1.0, part * limit));
                    let curve = Curve::new(branch, &rows, e, scaling, Interpolation::Eff1);
                    let (curve, warnings) = curve.unwrap();
                    // Damage 1 - σ/f keeps the effective stress, so that a cap is needed from 0.9 of the limit on.
                    assert_eq!(warnings.is_empty(), part < 0.9, "{branch} {part}");
                    assert!(curve.nodes().windows(2).all(|n| n[1].kappa > n[0].kappa));
                }
                let over = Some((1.0, 1.001 * limit));
                assert!(Curve::new(branch, &rows, e, over, Interpolation::Eff1).is_err());
            }
        }
    }

    #[test]
    fn limits_are_those_of_the_documents() {
        let e = 6000.0;
        let limit = |rows: &[TableRow]| snap_back(e, rows).unwrap().1;
        let size = |of: ByEnergy| e * of.energy / of.strength.powi(2);
        let tension = limit(&TENSILE.tension(1.0)) / size(TENSILE);
        let compression = limit(&CRUSHED.compression(e, 1.0)) / size(CRUSHED);
        // Printed digits of theory/crack-band.md.
        assert!((tension - 1.136).abs() < 5e-4, "{tension}");
        assert!((compression - 0.810).abs() < 5e-4, "{compression}");
    }
}
