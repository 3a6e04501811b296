//! Materials and joints by name: values with their sources, which fill the keys that a deck leaves out
//! (docs/reference/materials.md).

mod fill;
mod joints;
mod materials;
mod page;

pub(super) use fill::fill;
pub use fill::{Assumption, Taken};
pub use joints::{JointSet, joints};
pub use materials::{MATERIALS, NamedMaterial, Sort};
pub use page::tables;

use strsim::sorensen_dice;

/// How a value follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// The value itself, in base units but for densities in kg/m³.
    Value(f64),
    /// So many times the compressive strength [MPa].
    OfStrength(f64),
    /// So many times the tensile strength [MPa].
    OfTension(f64),
    /// So many times the cohesion [MPa].
    OfCohesion(f64),
    /// Tensile fracture energy of CEB-FIP Model Code 1990: 0.025 (f_c/10)^0.7 [N/mm].
    ModelCode,
    /// Compressive fracture energy after Lourenço [N/mm]: 1.6 f_c below 12 MPa, 15 + 0.43 f_c − 0.0036 f_c² up to 80
    /// MPa, 0.33 f_c beyond.
    Crushing,
}

/// A value and where it is from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fact {
    /// The value.
    pub rule: Rule,
    /// Its source; a value without one begins with `assumed`.
    pub source: &'static str,
}

/// Strengths from which other values follow [MPa].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Strengths {
    pub compression: f64,
    pub tension: f64,
    pub cohesion: f64,
}

impl Rule {
    /// The value for these strengths.
    pub(super) fn value(self, of: Strengths) -> f64 {
        let f_c = of.compression;
        match self {
            Self::Value(value) => value,
            Self::OfStrength(times) => times * f_c,
            Self::OfTension(times) => times * of.tension,
            Self::OfCohesion(times) => times * of.cohesion,
            Self::ModelCode => 0.025 * (f_c / 10.0).powf(0.7),
            Self::Crushing if f_c < 12.0 => 1.6 * f_c,
            Self::Crushing if f_c <= 80.0 => 15.0 + 0.43 * f_c - 0.0036 * f_c * f_c,
            Self::Crushing => 0.33 * f_c,
        }
    }

    /// The rule in words; none for a plain value.
    pub(super) fn words(self) -> Option<String> {
        Some(match self {
            Self::Value(_) => return None,
            Self::OfStrength(times) => format!("{times} f_c"),
            Self::OfTension(times) => format!("{times} f_t"),
            Self::OfCohesion(times) => format!("{times} c"),
            Self::ModelCode => "0.025 (f_c/10)^0.7".to_owned(),
            Self::Crushing => {
                "1.6 f_c; from 12 MPa on 15 + 0.43 f_c - 0.0036 f_c^2; beyond 80 MPa 0.33 f_c"
                    .to_owned()
            }
        })
    }
}

/// A name as it is compared: without case, spaces and punctuation other than the point of a number.
fn plain(name: &str) -> String {
    let kept = name.chars().filter(|c| c.is_alphanumeric() || *c == '.');
    kept.flat_map(char::to_lowercase).collect()
}

/// Number of names that an error lists.
const NEAR: usize = 4;

/// Names that resemble `name`, the nearest first; all without any resemblance.
fn near<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let name = name.to_lowercase();
    let alike = |known: &'a str| (sorensen_dice(&name, &known.to_lowercase()), known);
    let mut ranked: Vec<(f64, &str)> = known.map(alike).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = ranked.first().map_or(0.0, |(likeness, _)| *likeness);
    let near = ranked.iter().filter(|(l, _)| *l > 0.0 && *l >= 0.5 * best);
    let near: Vec<&str> = near.map(|(_, name)| *name).take(NEAR).collect();
    if near.is_empty() {
        ranked.into_iter().map(|(_, name)| name).collect()
    } else {
        near
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_compared_without_case_and_spaces() {
        assert_eq!(plain("NHL 3.5"), plain("nhl3.5"));
        assert_eq!(plain("Clay brick, solid"), plain("clay-brick solid"));
        assert_ne!(plain("M2.5"), plain("M25"));
    }

    #[test]
    fn near_names_come_first() {
        let known = || MATERIALS.iter().map(|m| m.name);
        assert_eq!(near("solid clay brick", known())[0], "clay brick, solid");
        assert_eq!(near("granit", known())[0], "granite");
        assert!(near("M4", known()).len() <= NEAR || near("M4", known()).len() == MATERIALS.len());
        assert_eq!(near("", known()).len(), MATERIALS.len());
    }

    /// Lourenço's curve of the crushing energy is continuous within 3 % where its parts meet.
    #[test]
    fn the_crushing_energy_is_continuous() {
        let of = |compression| {
            Rule::Crushing.value(Strengths {
                compression,
                ..Strengths::default()
            })
        };
        for at in [12.0, 80.0] {
            let jump = of(at + 1e-9) / of(at - 1e-9);
            assert!((jump - 1.0).abs() < 0.03, "{at}: {jump}");
        }
    }

    /// Every value is positive and has a source; no name is given twice.
    #[test]
    fn entries_are_complete() {
        let joints = joints();
        let names = MATERIALS.iter().map(|m| plain(m.name));
        let names: Vec<String> = names.chain(joints.iter().map(|j| plain(&j.name))).collect();
        for (i, name) in names.iter().enumerate() {
            assert!(!names[..i].contains(name), "{name}");
        }
        for material in MATERIALS {
            let mut of = Strengths {
                compression: material.strength.rule.value(Strengths::default()),
                ..Strengths::default()
            };
            assert!(of.compression > 0.0);
            of.tension = material.f_t.rule.value(of);
            // The yield surface wants 3.83 (theory/crack-band.md).
            assert!(of.compression > 3.83 * of.tension, "{}", material.name);
            for (key, fact) in material.facts() {
                let name = material.name;
                assert!(fact.rule.value(of) > 0.0, "{name}: {key}");
                assert!(!fact.source.is_empty(), "{name}: {key}");
            }
        }
        for joint in &joints {
            let of = Strengths {
                cohesion: joint.c.rule.value(Strengths::default()),
                ..Strengths::default()
            };
            for (key, fact) in joint.facts() {
                assert!(fact.rule.value(of) > 0.0, "{}: {key}", joint.name);
            }
        }
    }
}
