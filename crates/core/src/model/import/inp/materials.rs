//! Materials of an `.inp`: elasticity, density, concrete damaged plasticity.

use super::super::material::{ImportedMaterial, Measure};
use super::super::numbers::real;
use super::super::{Place, Wrong};
use super::lines::Keyword;
use super::reader::Reader;

/// A table of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Table {
    /// Nothing, of a material.
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
    /// The table that a keyword begins; none if it is not one of a material that is read.
    ///
    /// # Errors
    /// Options that mean another law.
    pub(super) fn material_keyword(&mut self, keyword: &Keyword) -> Result<Option<Table>, Wrong> {
        if keyword.name == "MATERIAL" {
            let name = keyword.required("NAME")?;
            let materials = &mut self.raw.materials;
            if materials.iter().any(|m| m.name.eq_ignore_ascii_case(&name)) {
                return Err(Wrong::new(
                    keyword.place,
                    format!("there are two materials named {name}"),
                    "give each a name of its own",
                ));
            }
            materials.push(ImportedMaterial::new(name, keyword.place));
            return Ok(Some(Table::None));
        }
        let Some(material) = self.raw.materials.last_mut() else {
            return Ok(None);
        };
        let refuse = |why: &str, help: &str| {
            Err(Wrong::new(
                keyword.place,
                format!("material {}: {why}", material.name),
                help.to_owned(),
            ))
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
            "ELASTIC" => refuse(
                "its elasticity is not isotropic",
                "write *ELASTIC with E and nu: solids are isotropic",
            ),
            "DENSITY" => Ok(Some(Table::Density)),
            "CONCRETE DAMAGED PLASTICITY" => {
                material.plasticity = Some([f64::NAN; 5]);
                Ok(Some(Table::Plasticity))
            }
            "CONCRETE COMPRESSION HARDENING" => Ok(Some(Table::Hardening)),
            "CONCRETE TENSION STIFFENING" => {
                match measure(kind.as_deref(), true) {
                    Some(measure) => material.stiffening.measure = measure,
                    None => return refuse("an unknown TYPE", "STRAIN, DISPLACEMENT or GFI"),
                }
                Ok(Some(Table::Stiffening))
            }
            "CONCRETE TENSION DAMAGE" => {
                let (measure, recovered) = (
                    measure(kind.as_deref(), false),
                    recovery("COMPRESSION RECOVERY", 1.0),
                );
                let (Some(measure), Some(recovered)) = (measure, recovered) else {
                    return refuse(
                        "an unknown TYPE or recovery",
                        "STRAIN or DISPLACEMENT; 0 to 1",
                    );
                };
                material.tension_damage.measure = measure;
                material.compression_recovery = recovered;
                Ok(Some(Table::TensionDamage))
            }
            "CONCRETE COMPRESSION DAMAGE" => {
                let Some(recovered) = recovery("TENSION RECOVERY", 0.0) else {
                    return refuse("its recovery is no number", "a number from 0 to 1");
                };
                material.tension_recovery = recovered;
                Ok(Some(Table::CompressionDamage))
            }
            _ => Ok(None),
        }
    }

    /// A line of a table.
    pub(super) fn material_row(
        &mut self,
        table: Table,
        fields: &[&str],
        place: Place,
    ) -> Result<(), Wrong> {
        let ended = &mut self.table_ended;
        let Some(material) = self.raw.materials.last_mut() else {
            return Ok(());
        };
        let filled = fields.iter().rposition(|f| !f.is_empty());
        let fields = &fields[..filled.map_or(0, |last| last + 1)];
        let numbers: Option<Vec<f64>> = fields
            .iter()
            .map(|f| {
                if f.is_empty() {
                    Some(f64::NAN)
                } else {
                    real(f)
                }
            })
            .collect();
        let Some(numbers) = numbers else {
            return Err(Wrong::new(
                place,
                format!(
                    "material {}: `{}` is no row",
                    material.name,
                    fields.join(", ")
                ),
                "a row is numbers with commas between them",
            ));
        };
        let at = |i: usize| numbers.get(i).copied().unwrap_or(f64::NAN);
        let pair = || [at(0), if at(1).is_nan() { 0.0 } else { at(1) }];
        match table {
            Table::None => {}
            Table::Elastic if material.elastic.is_none() => {
                material.elastic = Some(pair());
            }
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
            Table::Stiffening => {
                let rows = &mut material.stiffening.rows;
                add(rows, pair(), ended);
            }
            Table::CompressionDamage => {
                let rows = &mut material.compression_damage;
                add(rows, pair(), ended);
            }
            Table::TensionDamage => {
                let rows = &mut material.tension_damage.rows;
                add(rows, pair(), ended);
            }
        }
        material.depends |= *ended;
        Ok(())
    }
}

/// Adds a row. One that begins anew from strain 0 is of another rate or temperature: only the first are
/// taken.
fn add(rows: &mut Vec<[f64; 2]>, row: [f64; 2], ended: &mut bool) {
    *ended |= row[1] == 0.0 && rows.last().is_some_and(|last| last[1] > 0.0);
    if !*ended {
        rows.push(row);
    }
}

/// What the second column of a table in tension is.
fn measure(kind: Option<&str>, or_energy: bool) -> Option<Measure> {
    match kind {
        None | Some("STRAIN") => Some(Measure::Strain),
        Some("DISPLACEMENT") => Some(Measure::Displacement),
        Some("GFI") if or_energy => Some(Measure::Energy),
        _ => None,
    }
}
