//! Shared helpers of the tests: tables of the paper, CSV files, random numbers.
#![allow(dead_code, reason = "each test file uses its part")]

pub mod blocks;
pub mod boxes;
pub mod examples;
pub mod halves;
pub mod inside;
pub mod masonry;
pub mod scene;

use std::collections::HashMap;
use std::path::Path;

use nalgebra::Vector6;
use wythe::contact::{CohesiveFrictional, Coupling};
use wythe::deck::Deck;
use wythe::material::{
    CrackBand, DamagePlasticityParameters, ElasticParameters, Interpolation, TableRow,
};
use wythe::model::Model;

/// A CSV file with `#` comments: column name → values.
pub fn csv(path: &str) -> HashMap<String, Vec<f64>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(path);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut lines = text
        .lines()
        .filter(|l| !l.starts_with('#') && !l.trim().is_empty());
    let names: Vec<String> = lines
        .next()
        .expect("a header")
        .split(',')
        .map(|n| n.trim().to_owned())
        .collect();
    let mut columns: HashMap<String, Vec<f64>> = HashMap::new();
    for line in lines {
        for (name, field) in names.iter().zip(line.split(',')) {
            columns
                .entry(name.clone())
                .or_default()
                .push(field.trim().parse().unwrap_or(f64::NAN));
        }
    }
    columns
}

/// Strain of each row.
pub fn strains(table: &HashMap<String, Vec<f64>>) -> Vec<Vector6<f64>> {
    let names = ["eps_xx", "eps_yy", "eps_zz", "gam_xy", "gam_yz", "gam_zx"];
    (0..table[names[0]].len())
        .map(|i| Vector6::from_iterator(names.iter().map(|n| table[*n][i])))
        .collect()
}

fn rows(table: &[[f64; 3]]) -> Vec<TableRow> {
    table
        .iter()
        .map(|r| TableRow {
            stress: r[0],
            inelastic_strain: r[1],
            damage: r[2],
        })
        .collect()
}

/// Table 2 and Table 3 of the paper.
#[allow(non_snake_case)]
fn quasi_brittle(
    E: f64,
    tension: &[[f64; 3]],
    compression: &[[f64; 3]],
) -> DamagePlasticityParameters {
    DamagePlasticityParameters {
        elastic: ElasticParameters {
            E,
            nu: 0.15,
            density: 0.0,
        },
        tension: rows(tension),
        compression: rows(compression),
        dilation_angle: 10.0_f64.to_radians(),
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

/// Brick of Table 3.
pub fn brick() -> DamagePlasticityParameters {
    quasi_brittle(
        16700.0,
        &[[3.5, 0.0, 0.0], [0.3, 0.002, 0.95]],
        &[[11.0, 0.0, 0.0], [11.5, 0.001, 0.0], [0.6, 0.007, 0.95]],
    )
}

/// Mortar of Table 3; E = 850 in plane, 2300 out of plane.
pub fn mortar(e: f64) -> DamagePlasticityParameters {
    quasi_brittle(
        e,
        &[[1.5, 0.0, 0.0], [0.1, 0.002, 0.95]],
        &[[7.8, 0.0, 0.0], [8.2, 0.002, 0.0], [0.4, 0.015, 0.95]],
    )
}

/// Interface of Table 1 with the stiffnesses of the golden curves.
pub fn table_1() -> CohesiveFrictional {
    CohesiveFrictional {
        f_t: 0.28,
        c: 0.87,
        tan_phi: 1.01,
        mu: 0.73,
        u_k: 0.2,
        delta_k: 0.4,
        zeta: 4.38,
        xi: 1.1,
        normal_stiffness: 99000.0,
        shear_stiffness: 99000.0 / 2.3,
        coupling: Coupling::Max,
    }
}

/// Interface of Table 3, in plane.
pub fn table_3() -> CohesiveFrictional {
    CohesiveFrictional {
        f_t: 0.2,
        c: 0.22,
        tan_phi: 0.75,
        mu: 0.75,
        u_k: 0.36,
        delta_k: 0.4,
        zeta: 4.38,
        xi: 1.1,
        normal_stiffness: 34000.0,
        shear_stiffness: 34000.0 / 2.3,
        coupling: Coupling::Max,
    }
}

/// A small generator of reproducible random numbers (splitmix64).
pub struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [−1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }
}

/// Four courses of two units of the wall J7D, half as thick (one element), pushed by 0.3 mm: its joints open and
/// slide.
pub fn small_wall() -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/03_shear_wall_j7d.toml");
    let overrides = [
        ("wall.courses", "4"),
        ("wall.length", "420.5 mm"),
        ("wall.unit", "[204, 49, 50]"),
        ("wall.mesh", "[5, 2, 1]"),
        ("steps.1.displacement", "0.3 mm"),
        // 0.01 mm of the prescribed displacement, as in the deck.
        ("steps.1.viscosity", "0.033"),
    ];
    let overrides = overrides.map(|(k, v)| (k.into(), v.into()));
    let deck = Deck::load(path, &overrides).expect("the example is a deck");
    Model::from_deck(&deck).expect("the example is a model").0
}
