//! Bonds between mortars and units by name.

use super::materials::{MATERIALS, Sort};
use super::{Fact, Rule, Strengths};
use crate::deck::schema::JointKind;

/// Parameters of a joint by name.
#[derive(Clone, Debug)]
pub struct JointSet {
    /// Name in a deck, `MORTAR on UNITS`.
    pub name: String,
    /// Cohesion [MPa].
    pub c: Fact,
    /// Tensile strength [MPa].
    pub f_t: Fact,
}

/// Groups of units of table 3.4 of EN 1996-1-1, with f_vk0 [MPa] of mortars M10 to M20, M2.5 to M9, M1 to M2 and of
/// thin layers.
const UNITS: [(&str, [f64; 4]); 4] = [
    ("clay", [0.30, 0.20, 0.10, 0.30]),
    ("calcium silicate", [0.20, 0.15, 0.10, 0.40]),
    ("AAC", [0.20, 0.15, 0.10, 0.30]),
    ("stone", [0.20, 0.15, 0.10, 0.30]),
];

/// Name of a mortar in a thin layer.
const THIN: &str = "thin layer";

/// Mean over characteristic value: EN 1052-3 takes 0.8 of the mean as characteristic.
const MEAN: f64 = 1.0 / 0.8;

const SHEAR: &str = "f_vk0 of EN 1996-1-1, table 3.4, over 0.8 (EN 1052-3)";
const FRICTION: &str = "0.4 of EN 1996-1-1, 3.6.2, over 0.8 (EN 1052-3); tests have 0.7 to 0.8";
const SHAPE: &str = "table 1 of D'Altri et al. (2018)";

impl JointSet {
    /// Keys of a deck with their values, in the order in which they follow from each other.
    pub fn facts(&self) -> [(&'static str, Fact); 8] {
        let fact = |rule, source| Fact { rule, source };
        [
            ("c", self.c),
            ("f_t", self.f_t),
            ("tan_phi", fact(Rule::Value(0.4 * MEAN), FRICTION)),
            ("mu", fact(Rule::Value(0.4 * MEAN), FRICTION)),
            ("zeta", fact(Rule::Value(4.38), SHAPE)),
            ("xi", fact(Rule::Value(1.1), SHAPE)),
            ("G_I", fact(Rule::Value(0.012), "Lourenço (2004)")),
            (
                "G_II",
                fact(
                    Rule::OfCohesion(0.093),
                    "ductility index of 0.093 mm, Lourenço (2004)",
                ),
            ),
        ]
    }

    /// Whether a joint of `kind` reads a key.
    pub(super) fn is_read(key: &str, kind: JointKind) -> bool {
        kind == JointKind::CohesiveFrictional || !matches!(key, "zeta" | "xi")
    }
}

/// All bonds by name.
pub fn joints() -> Vec<JointSet> {
    let mortars = MATERIALS.iter().filter(|m| m.sort == Sort::Mortar);
    let of_class = |strength: f64| match strength {
        f if f >= 10.0 => 0,
        f if f >= 2.5 => 1,
        _ => 2,
    };
    let mortars = mortars.map(|m| {
        (
            m.name,
            of_class(m.strength.rule.value(Strengths::default())),
        )
    });
    let mortars: Vec<(&str, usize)> = mortars.chain([(THIN, 3)]).collect();
    let pair = |(units, shear): &(&str, [f64; 4])| -> Vec<JointSet> {
        let set = |(mortar, class): &(&str, usize)| JointSet {
            name: format!("{mortar} on {units}"),
            c: Fact {
                rule: Rule::Value(round(shear[*class] * MEAN)),
                source: SHEAR,
            },
            f_t: Fact {
                rule: Rule::OfCohesion(round(1.0 / 1.4)),
                source: "c over 1.4, as in the walls of Lourenço (1996)",
            },
        };
        mortars.iter().map(set).collect()
    };
    UNITS.iter().flat_map(pair).collect()
}

/// Rounds to four digits after the point, as the tables are read.
fn round(value: f64) -> f64 {
    (1e4 * value).round() * 1e-4
}
