//! A sample brick for the tests of this module.

use super::{CrackBand, DamagePlasticityParameters, ElasticParameters, Interpolation, TableRow};

/// Elastic constants of Table 3 (D'Altri et al. 2018) with the given tables (stress [MPa], inelastic strain, damage).
/// Tests change the fields that differ.
pub fn brick(tension: &[[f64; 3]], compression: &[[f64; 3]]) -> DamagePlasticityParameters {
    let rows = |table: &[[f64; 3]]| {
        let row = |&[stress, inelastic_strain, damage]: &[f64; 3]| TableRow {
            stress,
            inelastic_strain,
            damage,
        };
        table.iter().map(row).collect()
    };
    DamagePlasticityParameters {
        elastic: ElasticParameters {
            E: 16700.0,
            nu: 0.15,
            density: 0.0,
        },
        tension: rows(tension),
        compression: rows(compression),
        dilation_angle: 0.2,
        eccentricity: 0.1,
        fb0_fc0: 1.16,
        k_c: 2.0 / 3.0,
        tension_recovery: 0.0,
        compression_recovery: 1.0,
        viscosity: 0.0,
        reference_length: None,
        crack_band: CrackBand::Volume,
        interpolation: Interpolation::Eff1,
    }
}
