//! Materials of an `.inp`: elasticity, density, concrete damaged plasticity.

use super::lines::Keyword;
use super::reader::{Reader, there_are_two};
use crate::deck::import::material::{ImportedMaterial, Measure};
use crate::deck::import::numbers::{numbers, real};
use crate::deck::import::{Place, Wrong};

/// The table of a material to which data lines belong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Table {
    /// No table; the data lines are ignored.
    None,
    Elastic,
    Density,
    Plasticity,
    Hardening,
    Stiffening,
    CompressionDamage,
    TensionDamage,
}

impl Reader {
    /// The table that a keyword begins; none if the keyword does not belong to a material that is read.
    ///
    /// A keyword of another law marks the material as unusable. A deck may replace such a material by one of its
    /// own.
    ///
    /// # Errors
    /// A material without a name, or with the name of another one.
    pub(super) fn material_keyword(&mut self, keyword: &Keyword) -> Result<Option<Table>, Wrong> {
        if keyword.name == "MATERIAL" {
            return self.begin_material(keyword).map(|()| Some(Table::None));
        }
        let Some(material) = self.raw.materials.last_mut() else {
            return Ok(None);
        };
        let (line, name) = (keyword.place.line, &keyword.name);
        let unusable = |of: &mut Option<String>, why: &str| {
            of.get_or_insert_with(|| format!("*{name} (line {line}): {why}"));
            Ok(Some(Table::None))
        };
        let kind = keyword.get("TYPE").map(str::to_uppercase);
        let recovery = |name: &str, default: f64| match keyword.get(name) {
            None => Some(default),
            Some(text) => real(text),
        };
        match keyword.name.as_str() {
            "ELASTIC" if kind.as_deref().is_none_or(|k| k.starts_with("ISO")) => {
                Ok(Some(Table::Elastic))
            }
            "ELASTIC" => unusable(
                &mut material.unusable,
                "its elasticity is not isotropic, as that of solids is here",
            ),
            "DENSITY" => Ok(Some(Table::Density)),
            "CONCRETE DAMAGED PLASTICITY" => {
                material.plasticity = Some([f64::NAN; 5]);
                Ok(Some(Table::Plasticity))
            }
            "CONCRETE COMPRESSION HARDENING" => Ok(Some(Table::Hardening)),
            "CONCRETE TENSION STIFFENING" => {
                let Some(measure) = measure(kind.as_deref(), true) else {
                    let why = "an unknown TYPE, not STRAIN, DISPLACEMENT or GFI";
                    return unusable(&mut material.unusable, why);
                };
                material.stiffening.measure = measure;
                Ok(Some(Table::Stiffening))
            }
            "CONCRETE TENSION DAMAGE" => {
                let (measure, recovered) = (
                    measure(kind.as_deref(), false),
                    recovery("COMPRESSION RECOVERY", 1.0),
                );
                let (Some(measure), Some(recovered)) = (measure, recovered) else {
                    let why = "an unknown TYPE, not STRAIN or DISPLACEMENT, or a recovery that is no number";
                    return unusable(&mut material.unusable, why);
                };
                material.tension_damage.measure = measure;
                material.compression_recovery = recovered;
                Ok(Some(Table::TensionDamage))
            }
            "CONCRETE COMPRESSION DAMAGE" => {
                let Some(recovered) = recovery("TENSION RECOVERY", 0.0) else {
                    return unusable(&mut material.unusable, "its recovery is no number");
                };
                material.tension_recovery = recovered;
                Ok(Some(Table::CompressionDamage))
            }
            _ => Ok(None),
        }
    }

    fn begin_material(&mut self, keyword: &Keyword) -> Result<(), Wrong> {
        let name = keyword.required("NAME")?;
        let materials = &mut self.raw.materials;
        if materials.iter().any(|m| m.name.eq_ignore_ascii_case(&name)) {
            return Err(there_are_two("materials", &name, keyword.place));
        }
        materials.push(ImportedMaterial::new(name, keyword.place));
        Ok(())
    }

    /// Reads a data line of a table.
    pub(super) fn material_row(&mut self, table: Table, fields: &[&str], place: Place) {
        let ended = &mut self.table_ended;
        let Some(material) = self
            .raw
            .materials
            .last_mut()
            .filter(|_| table != Table::None)
        else {
            return;
        };
        let filled = fields.iter().rposition(|f| !f.is_empty());
        let fields = &fields[..filled.map_or(0, |last| last + 1)];
        let Some(numbers) = numbers(fields, f64::NAN) else {
            let (row, line) = (fields.join(", "), place.line);
            let why =
                || format!("`{row}` (line {line}) is no row of numbers with commas between them");
            material.unusable.get_or_insert_with(why);
            return;
        };
        let at = |i: usize| numbers.get(i).copied().unwrap_or(f64::NAN);
        let pair = || [at(0), if at(1).is_nan() { 0.0 } else { at(1) }];
        match table {
            Table::None => {}
            Table::Elastic if material.elastic.is_none() => material.elastic = Some(pair()),
            Table::Density if material.density.is_none() => material.density = Some(at(0)),
            Table::Elastic | Table::Density => material.depends = true,
            Table::Plasticity => {
                if material
                    .plasticity
                    .is_some_and(|p| p.iter().all(|v| v.is_nan()))
                {
                    material.plasticity = Some([0, 1, 2, 3, 4].map(at));
                } else {
                    material.depends = true;
                }
            }
            Table::Hardening => add(&mut material.hardening, pair(), ended),
            Table::Stiffening if material.stiffening.measure == Measure::Energy => {
                // A strength and an energy; further rows are for other temperatures.
                if material.stiffening.rows.is_empty() {
                    material.stiffening.rows.push(pair());
                } else {
                    material.depends = true;
                }
            }
            Table::Stiffening => add(&mut material.stiffening.rows, pair(), ended),
            Table::CompressionDamage => add(&mut material.compression_damage, pair(), ended),
            Table::TensionDamage => add(&mut material.tension_damage.rows, pair(), ended),
        }
        material.depends |= *ended;
    }
}

/// Adds a row. Once the strains start again from 0, the rows are for another rate or temperature and are ignored.
fn add(rows: &mut Vec<[f64; 2]>, row: [f64; 2], ended: &mut bool) {
    *ended |= row[1] == 0.0 && rows.last().is_some_and(|last| last[1] > 0.0);
    if !*ended {
        rows.push(row);
    }
}

/// Meaning of the second column of a table in tension.
fn measure(kind: Option<&str>, or_energy: bool) -> Option<Measure> {
    match kind {
        None | Some("STRAIN") => Some(Measure::Strain),
        Some("DISPLACEMENT") => Some(Measure::Displacement),
        Some("GFI") if or_energy => Some(Measure::Energy),
        _ => None,
    }
}
