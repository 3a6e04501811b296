//! The registry of the solids' laws: `kind = "..."` of `[materials.NAME]` → law.
//!
//! A law of a deck is a variant of [`SolidKind`], a line of [`SOLIDS`], and its keys in [`Material`]. A law that is
//! only used from Rust needs neither: [`MaterialParameters::custom`](crate::material::MaterialParameters::custom).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::materials::Material;
use crate::material::MaterialParameters;

/// Law of a solid.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum SolidKind {
    /// Concrete damaged plasticity; linear elastic without tables.
    #[default]
    DamagePlasticity,
    /// Hyperbolic Drucker–Prager plasticity, with or without softening.
    DruckerPrager,
}

/// A law as decks know it.
#[derive(Clone, Copy, Debug)]
pub struct RegisteredSolid {
    /// Its `kind`.
    pub kind: SolidKind,
    /// As the deck spells it.
    pub name: &'static str,
    /// Keys beside [`COMMON`] that it reads; others are errors.
    pub keys: &'static [&'static str],
    /// Of these, the ones that must be given.
    pub required: &'static [&'static str],
    /// Its parameters, from a table whose ranges have been checked.
    pub parameters: fn(&Material) -> MaterialParameters,
}

/// Keys that a material of any law may have.
pub const COMMON: [&str; 6] = ["kind", "name", "f_b", "E", "nu", "density"];

/// All laws of the solids.
pub const SOLIDS: [RegisteredSolid; 2] = [
    RegisteredSolid {
        kind: SolidKind::DamagePlasticity,
        name: "damage-plasticity",
        keys: &[
            "tension",
            "compression",
            "f_t",
            "G_ft",
            "f_c",
            "G_fc",
            "dilation_angle",
            "eccentricity",
            "fb0_fc0",
            "K_c",
            "tension_recovery",
            "compression_recovery",
            "viscosity",
            "reference_length",
            "crack_band",
            "interpolation",
        ],
        required: &[],
        parameters: Material::damage_plasticity,
    },
    RegisteredSolid {
        kind: SolidKind::DruckerPrager,
        name: "drucker-prager",
        keys: &["c", "phi", "psi", "f_t", "G_I", "G_c", "reference_length"],
        required: &["c", "phi", "f_t"],
        parameters: Material::drucker_prager,
    },
];

impl SolidKind {
    /// Its line of the registry.
    pub fn registered(self) -> &'static RegisteredSolid {
        // Every kind has a line: `tests::every_kind_has_one_line`.
        let line = SOLIDS.iter().find(|line| line.kind == self);
        line.unwrap_or(&SOLIDS[0])
    }
}

impl Material {
    /// Keys that the deck gives beside those of every law, as far as they differ from what they are if they are absent.
    pub fn given(&self) -> Vec<String> {
        let table = |of: &Self| toml::Table::try_from(of).unwrap_or_default();
        let absent = table(&Self::elastic(self.E, self.nu, self.density));
        let given = table(self).into_iter();
        given
            .filter(|(key, value)| {
                !COMMON.contains(&key.as_str()) && absent.get(key) != Some(value)
            })
            .map(|(key, _)| key)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_one_line() {
        for (i, line) in SOLIDS.iter().enumerate() {
            assert_eq!(line.kind.registered().name, line.name);
            let written = serde_json::to_value(line.kind).unwrap();
            assert_eq!(written, line.name);
            assert!(line.required.iter().all(|key| line.keys.contains(key)));
            assert!(SOLIDS[..i].iter().all(|other| other.kind != line.kind));
        }
        let schema = serde_json::to_value(schemars::schema_for!(SolidKind)).unwrap();
        let kinds = schema["oneOf"].as_array().unwrap();
        assert_eq!(kinds.len(), SOLIDS.len());
    }

    #[test]
    fn keys_are_given_where_they_differ_from_their_defaults() {
        let read = |text: &str| toml::from_str::<Material>(text).unwrap();
        let plain = read("E = 1000\nnu = 0.2\ndensity = 1e-9\nK_c = 0.6666666666666666");
        assert_eq!(plain.given(), Vec::<String>::new());
        let more =
            read("E = 1000\nnu = 0.2\nviscosity = 0.1\ntension = [[1, 0, 0], [0.1, 0.01, 0.5]]");
        assert_eq!(more.given(), ["tension", "viscosity"]);
    }
}
