//! A material of an `.inp`, and its conversion to a material of a deck.
//!
//! Abaqus has separate tables of stress and of damage over inelastic strain; a deck has rows of all three. The rows
//! are placed at the strains of both tables, so that both are reproduced exactly where they are linear.

use super::{Place, Units};
use crate::deck::quantity::{Angle, Density, Length, Number, Pressure, Time};
use crate::deck::schema::{Material, Row};
use crate::material::CrackBand;

/// Meaning of the second column of a table in tension.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Measure {
    /// Cracking strain [-].
    #[default]
    Strain,
    /// Cracking displacement [mm].
    Displacement,
    /// Fracture energy [N/mm] (*CONCRETE TENSION STIFFENING, TYPE=GFI).
    Energy,
}

/// A table in tension.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Softening {
    /// Meaning of its second column.
    pub measure: Measure,
    /// Stress [MPa] or damage [-], and the second column. `[row]`
    pub rows: Vec<[f64; 2]>,
}

/// A material as written in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportedMaterial {
    /// Name as written.
    pub name: String,
    /// Position in the file.
    pub place: Place,
    /// E [MPa] and ν.
    pub elastic: Option<[f64; 2]>,
    /// Density [tonne/mm³].
    pub density: Option<f64>,
    /// Dilation angle [deg], eccentricity, f_b0/f_c0, K_c, viscosity [s]; NaN where the file gives no value.
    pub plasticity: Option<[f64; 5]>,
    /// Stress [MPa] over inelastic strain in compression.
    pub hardening: Vec<[f64; 2]>,
    /// Stress in tension.
    pub stiffening: Softening,
    /// Damage over inelastic strain in compression.
    pub compression_damage: Vec<[f64; 2]>,
    /// Damage in tension.
    pub tension_damage: Softening,
    /// Stiffness recovery on reversal to tension.
    pub tension_recovery: f64,
    /// Stiffness recovery on reversal to compression.
    pub compression_recovery: f64,
    /// Whether rows for other temperatures, rates or fields were left out.
    pub depends: bool,
    /// Reason why the material cannot be used: an unsupported law, an invalid row.
    pub unusable: Option<String>,
    /// Length for which the tables hold [mm], if wythe wrote it beside them.
    pub reference_length: Option<f64>,
    /// Length of an element that is compared with it, if wythe wrote that.
    pub crack_band: Option<CrackBand>,
}

/// Equivalent lengths V^(1/3) of the elements of a material [mm].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lengths {
    /// Smallest.
    pub least: f64,
    /// Median.
    pub median: f64,
    /// Largest.
    pub most: f64,
}

/// Smallest fraction of the tensile strength that is left: the limit that Abaqus uses.
const LEAST_TENSION: f64 = 0.01;

/// Elements whose lengths differ by less than this fraction have one size: coordinates in files are rounded.
const SAME_SIZE: f64 = 1e-3;

impl ImportedMaterial {
    pub(super) fn new(name: String, place: Place) -> Self {
        Self {
            name,
            place,
            compression_recovery: 1.0,
            ..Self::default()
        }
    }

    pub(super) fn scale(&mut self, units: &Units) {
        if let Some(elastic) = &mut self.elastic {
            elastic[0] *= units.stress();
        }
        if let Some(length) = &mut self.reference_length {
            *length *= units.length;
        }
        if let Some(density) = &mut self.density {
            *density *= units.density();
        }
        if let Some(plasticity) = &mut self.plasticity {
            plasticity[4] *= units.time;
        }
        for row in self.hardening.iter_mut().chain(&mut self.stiffening.rows) {
            row[0] *= units.stress();
        }
        let opening = |measure: Measure| match measure {
            Measure::Strain => 1.0,
            Measure::Displacement => units.length,
            Measure::Energy => units.fracture_energy(),
        };
        for table in [&mut self.stiffening, &mut self.tension_damage] {
            for row in &mut table.rows {
                row[1] *= opening(table.measure);
            }
        }
    }

    /// The material as a deck would write it, with notes for the author. `lengths`: those of its elements, if it
    /// has any; tables over displacements need them.
    ///
    /// # Errors
    /// A sentence that says which data is missing or cannot be converted.
    pub fn in_a_deck(&self, lengths: Option<Lengths>) -> Result<(Material, Vec<String>), String> {
        let mut notes = Vec::new();
        if let Some(why) = &self.unusable {
            return Err(why.clone());
        }
        let Some([e, nu]) = self.elastic else {
            return Err("it has no *ELASTIC".to_owned());
        };
        let mut material = Material::elastic(
            Pressure::new(e),
            Number::new(nu),
            Density::new(self.density.unwrap_or(0.0)),
        );
        if self.depends {
            notes.push("only its first rate or temperature is taken".to_owned());
        }
        let Some([psi, eccentricity, ratio, k_c, viscosity]) = self.plasticity else {
            return Ok((material, notes));
        };
        if psi.is_nan() {
            return Err("*CONCRETE DAMAGED PLASTICITY has no row".to_owned());
        }
        let said = |value: f64, default: f64| {
            // Abaqus uses its default where the field is empty or 0.
            if value.is_nan() || value == 0.0 {
                default
            } else {
                value
            }
        };
        material.dilation_angle = Angle::new(psi);
        material.eccentricity = Number::new(said(eccentricity, 0.1));
        material.fb0_fc0 = Number::new(said(ratio, 1.16));
        material.K_c = Number::new(said(k_c, 2.0 / 3.0));
        material.viscosity = Time::new(said(viscosity, 0.0));
        material.tension_recovery = Number::new(self.tension_recovery);
        material.compression_recovery = Number::new(self.compression_recovery);
        material.compression = merged(&self.hardening, &self.compression_damage, 0.0)
            .map_err(|why| format!("compression: {why}"))?;
        let (tension, length) = self
            .tension(&material.compression, lengths, &mut notes)
            .map_err(|why| format!("tension: {why}"))?;
        material.tension = tension;
        material.reference_length = length.or(self.reference_length).map(Length::new);
        material.crack_band = self.crack_band;
        Ok((material, notes))
    }

    /// Rows in tension, and the length for which they hold if they come from displacements.
    ///
    /// As in Abaqus, strains beyond the peak, which is in the first row, are then these displacements over the
    /// length of each element (theory/crack-band.md, eq. 4).
    fn tension(
        &self,
        compression: &[Row],
        lengths: Option<Lengths>,
        notes: &mut Vec<String>,
    ) -> Result<(Vec<Row>, Option<f64>), String> {
        let (stiffening, damage) = (&self.stiffening, &self.tension_damage);
        let rows = match stiffening.measure {
            Measure::Energy => linear_to_nothing(&stiffening.rows)?,
            _ => stiffening.rows.clone(),
        };
        let over_strain = stiffening.measure == Measure::Strain;
        if !damage.rows.is_empty() && over_strain != (damage.measure == Measure::Strain) {
            return Err(
                "stress is given over strain and damage over displacement, or the reverse: \
                 write both alike"
                    .to_owned(),
            );
        }
        let strongest = rows.iter().map(|r| r[0]).fold(0.0, f64::max);
        let first = rows.first().map_or(0.0, |r| r[0]);
        let floor = LEAST_TENSION * first;
        if rows.iter().any(|r| r[0] < floor) {
            notes.push(format!(
                "stresses in tension below a hundredth of the strength are raised to {floor} MPa, as Abaqus \
                 does"
            ));
        }
        let merged = merged(&rows, &damage.rows, floor)?;
        if over_strain {
            return Ok((merged, None));
        }
        let Some(lengths) = lengths else {
            return Err(
                "its table is over displacements, but no element has this material".to_owned(),
            );
        };
        if first < strongest {
            return Err(
                "it hardens over displacements before it softens: write the rows up to the peak \
                 over strains"
                    .to_owned(),
            );
        }
        let length = lengths.median;
        let over = |row: Row| Row(row.0, Number::new(row.1.get() / length), row.2);
        let softens = compression
            .windows(2)
            .any(|pair| pair[1].0.get() < pair[0].0.get());
        let (small, large) = (lengths.least / length, lengths.most / length);
        if softens && (small < 1.0 - SAME_SIZE || large > 1.0 + SAME_SIZE) {
            notes.push(format!(
                "tension over displacements is converted with reference_length = {length} mm; beyond the \
                 peak in compression, strains are scaled with it, too, by {:.3} to {:.3} from the largest \
                 element to the smallest, which Abaqus does not do",
                1.0 / large,
                1.0 / small
            ));
        }
        Ok((merged.into_iter().map(over).collect(), Some(length)))
    }
}

/// Converts strength and fracture energy to rows over displacements: a line to 0 at 2 G_f/f_t, cut off at a
/// hundredth of the strength.
fn linear_to_nothing(rows: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, String> {
    match rows {
        [[strength, energy], ..] if *strength > 0.0 && *energy > 0.0 => {
            let end = 2.0 * energy / strength;
            let rest = LEAST_TENSION * strength;
            Ok(vec![[*strength, 0.0], [rest, (1.0 - LEAST_TENSION) * end]])
        }
        _ => Err("TYPE=GFI wants a strength and a fracture energy above 0".to_owned()),
    }
}

/// Rows (stress, strain, damage) at the strains of both tables, and at the strain where the stress reaches `floor`,
/// below which it does not fall. Beyond its last row a table is constant.
fn merged(stress: &[[f64; 2]], damage: &[[f64; 2]], floor: f64) -> Result<Vec<Row>, String> {
    let ascends = |rows: &[[f64; 2]]| rows.windows(2).all(|pair| pair[1][1] > pair[0][1]);
    let (Some(first), Some(last)) = (stress.first(), stress.last()) else {
        return Err("it has no table of stresses".to_owned());
    };
    if first[1] != 0.0 || !ascends(stress) {
        return Err("the strains of its stresses must ascend from 0".to_owned());
    }
    if !ascends(damage) || damage.first().is_some_and(|row| *row != [0.0, 0.0]) {
        return Err("its damage must begin with 0, 0, and its strains must ascend".to_owned());
    }
    let end = damage.last().map_or(last[1], |row| row[1].max(last[1]));
    let crossings = stress.windows(2).filter_map(|pair| {
        let [[high, from], [low, to]] = [pair[0], pair[1]];
        (high > floor && low < floor).then(|| from + (to - from) * (high - floor) / (high - low))
    });
    let own = stress.iter().chain(damage).map(|row| row[1]);
    let mut strains: Vec<f64> = own.chain(crossings).collect();
    strains.sort_by(f64::total_cmp);
    // Strains of two tables that are meant to be equal may differ in their last digits.
    strains.dedup_by(|b, a| *b - *a <= 1e-9 * end);
    let row = |strain: f64| {
        let stress = Pressure::new(at(stress, strain).max(floor));
        Row(stress, Number::new(strain), Number::new(at(damage, strain)))
    };
    Ok(strains.into_iter().map(row).collect())
}

/// First column of a table at a value of its second: linear between rows, constant beyond them; 0 without rows.
fn at(rows: &[[f64; 2]], strain: f64) -> f64 {
    let after = rows.partition_point(|row| row[1] < strain);
    match (
        after.checked_sub(1).and_then(|i| rows.get(i)),
        rows.get(after),
    ) {
        (_, Some(row)) if row[1] == strain => row[0],
        (Some(a), Some(b)) => a[0] + (b[0] - a[0]) * (strain - a[1]) / (b[1] - a[1]),
        (Some(last), None) => last[0],
        (None, Some(first)) => first[0],
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(table: &[Row]) -> Vec<[f64; 3]> {
        let row = |r: &Row| [r.0.get(), r.1.get(), r.2.get()];
        table.iter().map(row).collect()
    }

    fn material() -> ImportedMaterial {
        ImportedMaterial {
            elastic: Some([10_000.0, 0.2]),
            plasticity: Some([30.0, f64::NAN, 0.0, 0.7, f64::NAN]),
            hardening: vec![[8.0, 0.0], [10.0, 0.002], [2.0, 0.01]],
            compression_damage: vec![[0.0, 0.0], [0.0, 0.002], [0.4, 0.006], [0.8, 0.012]],
            stiffening: Softening {
                measure: Measure::Strain,
                rows: vec![[2.0, 0.0], [1.0, 0.25], [0.0, 0.75]],
            },
            tension_damage: Softening {
                measure: Measure::Strain,
                rows: vec![[0.0, 0.0], [0.5, 0.5]],
            },
            ..ImportedMaterial::new("concrete".to_owned(), Place::default())
        }
    }

    #[test]
    fn merged_tables_have_the_rows_of_stress_and_damage() {
        let (made, notes) = material().in_a_deck(None).unwrap();
        // At 0.006: half way from 10 to 2; beyond 0.01 the stress is constant.
        assert_eq!(
            rows(&made.compression),
            [
                [8.0, 0.0, 0.0],
                [10.0, 0.002, 0.0],
                [6.0, 0.006, 0.4],
                [2.0, 0.01, 0.4 + 0.4 * (0.01 - 0.006) / (0.012 - 0.006)],
                [2.0, 0.012, 0.8],
            ]
        );
        // The line to zero reaches a hundredth of 2 MPa at 0.75 - 0.5 × 0.02.
        let tension = rows(&made.tension);
        assert_eq!(tension.len(), 5);
        assert_eq!(tension[2], [0.5, 0.5, 0.5]);
        // The stress is interpolated: some last bits of 1 MPa.
        let near = (tension[3][0] - 0.02).abs() < 4.0 * f64::EPSILON;
        assert!(near && tension[3][1..] == [0.74, 0.5], "{:?}", tension[3]);
        assert_eq!(tension[4], [0.02, 0.75, 0.5]);
        assert!(notes[0].contains("raised to 0.02 MPa"), "{notes:?}");
        let defaults = [made.eccentricity, made.fb0_fc0, made.K_c].map(Number::get);
        assert_eq!(defaults, [0.1, 1.16, 0.7]);
        assert_eq!(made.reference_length, None);
    }

    #[test]
    fn displacements_become_strains_of_a_reference_length() {
        let mut m = material();
        m.stiffening.measure = Measure::Displacement;
        m.tension_damage.measure = Measure::Displacement;
        let even = Lengths {
            least: 50.0,
            median: 50.0,
            most: 50.0,
        };
        let (made, notes) = m.in_a_deck(Some(even)).unwrap();
        assert_eq!(made.reference_length.map(Length::get), Some(50.0));
        assert_eq!(rows(&made.tension)[1], [1.0, 0.25 / 50.0, 0.25]);
        assert_eq!(notes.len(), 1, "one size: nothing else to tell");
        let uneven = Lengths {
            most: 100.0,
            ..even
        };
        let (_, notes) = m.in_a_deck(Some(uneven)).unwrap();
        assert!(notes[1].contains("by 0.500 to 1.000"), "{notes:?}");
        assert!(
            m.in_a_deck(None)
                .unwrap_err()
                .contains("no element has this material")
        );
        m.tension_damage.measure = Measure::Strain;
        let error = m.in_a_deck(Some(even)).unwrap_err();
        assert!(error.contains("write both alike"), "{error}");
    }

    #[test]
    fn a_fracture_energy_is_the_area_below_a_line() {
        let mut m = material();
        m.tension_damage.rows.clear();
        m.stiffening = Softening {
            measure: Measure::Energy,
            rows: vec![[2.0, 0.1]],
        };
        let size = Lengths {
            least: 1.0,
            median: 1.0,
            most: 1.0,
        };
        let (made, _) = m.in_a_deck(Some(size)).unwrap();
        // The line ends at 2 x 0.1/2 = 0.1 mm, a hundredth of the strength before it.
        assert_eq!(rows(&made.tension), [[2.0, 0.0, 0.0], [0.02, 0.099, 0.0]]);
    }

    #[test]
    fn missing_tables_are_reported() {
        let mut m = material();
        m.hardening.clear();
        let error = m.in_a_deck(None).unwrap_err();
        assert_eq!(error, "compression: it has no table of stresses");
        m.hardening = vec![[8.0, 0.001]];
        let error = m.in_a_deck(None).unwrap_err();
        assert!(error.contains("ascend from 0"), "{error}");
        m.elastic = None;
        assert_eq!(m.in_a_deck(None).unwrap_err(), "it has no *ELASTIC");
    }
}
