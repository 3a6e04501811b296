//! Materials: elasticity, density, concrete damaged plasticity.

use std::fmt::Write as _;

use crate::material::{DamagePlasticityParameters, MaterialParameters, TableRow};

/// Writes a material with its tables.
pub(super) fn material(text: &mut String, name: &str, of: &MaterialParameters) -> std::fmt::Result {
    let elastic = of.elastic();
    writeln!(text, "*MATERIAL, NAME={name}")?;
    if elastic.density > 0.0 {
        writeln!(text, "*DENSITY\n{:?}", elastic.density)?;
    }
    writeln!(text, "*ELASTIC\n{:?}, {:?}", elastic.E, elastic.nu)?;
    match of {
        MaterialParameters::Elastic(_) => Ok(()),
        MaterialParameters::DamagePlasticity(p) => damage_plasticity(text, p),
        MaterialParameters::DruckerPrager(_) => left_out(text, "drucker-prager"),
        MaterialParameters::Custom(law) => left_out(text, law.name()),
    }
}

fn left_out(text: &mut String, law: &str) -> std::fmt::Result {
    writeln!(text, "** wythe: the law `{law}` is left out; elastic here")
}

fn damage_plasticity(text: &mut String, p: &DamagePlasticityParameters) -> std::fmt::Result {
    if let Some(length) = p.reference_length {
        let across = if p.has_bands() { " across a crack" } else { "" };
        writeln!(
            text,
            "** Tables for elements {length:?} mm long{across}; wythe scales the strains beyond the peak to each \
             element, Abaqus does not.\n** wythe: reference_length = {length:?}"
        )?;
        let band = if p.has_bands() { "projected" } else { "volume" };
        writeln!(text, "** wythe: crack_band = \"{band}\"")?;
    }
    writeln!(text, "*CONCRETE DAMAGED PLASTICITY")?;
    writeln!(
        text,
        "{:?}, {:?}, {:?}, {:?}, {:?}",
        p.dilation_angle.to_degrees(),
        p.eccentricity,
        p.fb0_fc0,
        p.k_c,
        p.viscosity
    )?;
    rows(
        text,
        "*CONCRETE COMPRESSION HARDENING",
        &p.compression,
        |r| r.stress,
    )?;
    rows(text, "*CONCRETE TENSION STIFFENING", &p.tension, |r| {
        r.stress
    })?;
    // Abaqus states the recovery of the other sign with each table.
    let compression = format!(
        "*CONCRETE COMPRESSION DAMAGE, TENSION RECOVERY={:?}",
        p.tension_recovery
    );
    rows(text, &compression, &p.compression, |r| r.damage)?;
    let tension = format!(
        "*CONCRETE TENSION DAMAGE, COMPRESSION RECOVERY={:?}",
        p.compression_recovery
    );
    rows(text, &tension, &p.tension, |r| r.damage)
}

fn rows(
    text: &mut String,
    keyword: &str,
    table: &[TableRow],
    value: impl Fn(&TableRow) -> f64,
) -> std::fmt::Result {
    writeln!(text, "{keyword}")?;
    for row in table {
        writeln!(text, "{:?}, {:?}", value(row), row.inelastic_strain)?;
    }
    Ok(())
}
