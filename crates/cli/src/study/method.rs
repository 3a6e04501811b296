//! Methods of the atlas: each sets a few keys of a step, or the modelling strategy.

use super::case::Case;
use wythe_core::deck::Deck;
use wythe_core::deck::schema::{DeckProcedure, DeckStep, StepKind};

/// A key of a step and its value.
type Key = (&'static str, &'static str);

/// A method of solving a step, or a coarser model of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Name in the atlas and on the command line.
    pub name: &'static str,
    /// Keys of a static step.
    at_rest: &'static [Key],
    /// Keys of a dynamic step (`procedure = "dynamic"`); none if the method is for statics only.
    in_motion: Option<&'static [Key]>,
    /// Whether every material must have a density.
    needs_mass: bool,
    /// Modelling strategy; none for that of the deck.
    pub strategy: Option<&'static str>,
}

/// The methods of the atlas, in its order. No other place depends on their keys in the deck.
pub const METHODS: [Method; 10] = [
    Method {
        name: "auto",
        at_rest: &[],
        in_motion: Some(&[]),
        needs_mass: false,
        strategy: None,
    },
    still(
        "static",
        &[("procedure", "static"), ("tangent", "secant")],
        Some(&[("tangent", "secant")]),
    ),
    still(
        "consistent",
        &[("procedure", "static"), ("tangent", "consistent")],
        Some(&[("tangent", "consistent")]),
    ),
    still(
        "direct",
        &[("procedure", "static"), ("tangent", "direct")],
        Some(&[("tangent", "direct")]),
    ),
    still("implex", &[("procedure", "implex")], None),
    still("arc_length", &[("procedure", "arc_length")], None),
    still("dissipation", &[("procedure", "dissipation")], None),
    Method {
        name: "quasi_static",
        at_rest: &[("procedure", "quasi_static")],
        in_motion: None,
        needs_mass: true,
        strategy: None,
    },
    coarser("simplified"),
    coarser("rigid"),
];

/// A modelling strategy, solved by `auto`.
const fn coarser(strategy: &'static str) -> Method {
    Method {
        name: strategy,
        at_rest: &[],
        in_motion: Some(&[]),
        needs_mass: false,
        strategy: Some(strategy),
    }
}

const fn still(
    name: &'static str,
    at_rest: &'static [Key],
    in_motion: Option<&'static [Key]>,
) -> Method {
    Method {
        name,
        at_rest,
        in_motion,
        needs_mass: false,
        strategy: None,
    }
}

impl Method {
    /// Overrides that make the deck of a case use this method.
    ///
    /// # Errors
    /// The reason in words if the method does not apply.
    pub fn overrides(&self, case: &Case, deck: &Deck) -> Result<Vec<(String, String)>, String> {
        if self.strategy.is_some() && !deck.has_walls() {
            return Err("the scene has no wall".to_owned());
        }
        let massless = |m: &wythe_core::deck::schema::Material| m.density.get() <= 0.0;
        if self.needs_mass
            && let Some((name, _)) = deck.materials.iter().find(|(_, m)| massless(m))
        {
            return Err(format!("{name} has no density"));
        }
        let strategy = self.strategy.iter();
        let strategy = strategy.map(|name| ("strategy".to_owned(), format!("\"{name}\"")));
        let mut overrides: Vec<_> = strategy.collect();
        for (i, step) in deck.steps.iter().enumerate() {
            if !takes(case, i, step) {
                continue;
            }
            let keys = if step.procedure == DeckProcedure::Dynamic {
                self.in_motion
                    .ok_or_else(|| format!("step {i} is a motion"))?
            } else {
                self.at_rest
            };
            let key = |(key, value): &Key| (format!("steps.{i}.{key}"), format!("\"{value}\""));
            overrides.extend(keys.iter().map(key));
        }
        Ok(overrides)
    }
}

/// Whether a step uses the method.
fn takes(case: &Case, index: usize, step: &DeckStep) -> bool {
    match &case.steps {
        Some(steps) => steps.contains(&index),
        None => step.kind != StepKind::Preload,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DECK: &str = r#"
        format = 1
        [materials.stone]
        E = 5000
        nu = 0.2
        DENSITY
        [interfaces.dry]
        f_t = 0
        c = 0
        tan_phi = 0.4
        mu = 0.4
        [[blocks]]
        name = "a"
        size = [1, 1, 1]
        material = "stone"
        [[steps]]
        kind = "preload"
        face = "a.top"
        pressure = 1
        [[steps]]
        kind = "drive"
        face = "a.top"
        direction = "x"
        displacement = 1
        DYNAMICS
    "#;

    fn deck(density: &str, dynamics: &str) -> Deck {
        let text = DECK
            .replace("DENSITY", density)
            .replace("DYNAMICS", dynamics);
        Deck::from_str(&text, "deck.toml").unwrap()
    }

    fn overrides(name: &str, case: &Case, deck: &Deck) -> Result<Vec<(String, String)>, String> {
        let method = METHODS.iter().find(|m| m.name == name).unwrap();
        method.overrides(case, deck)
    }

    #[test]
    fn a_method_is_said_in_every_step_but_preloads_or_in_those_of_the_case() {
        let deck = deck("", "");
        assert_eq!(overrides("auto", &Case::empty(), &deck), Ok(Vec::new()));
        let said = overrides("implex", &Case::empty(), &deck).unwrap();
        assert!(
            said.iter().all(|(key, _)| key.starts_with("steps.1.")),
            "{said:?}"
        );
        assert!(said.contains(&("steps.1.procedure".to_owned(), "\"implex\"".to_owned())));
        let first = Case {
            steps: Some(vec![0]),
            ..Case::empty()
        };
        let said = overrides("implex", &first, &deck).unwrap();
        assert!(
            said.iter().all(|(key, _)| key.starts_with("steps.0.")),
            "{said:?}"
        );
    }

    #[test]
    fn strategies_are_keys_of_decks_with_walls() {
        let case = Case::empty();
        assert!(overrides("rigid", &case, &deck("", "")).is_err());
        let wall = DECK.replace("DENSITY", "").replace("DYNAMICS", "").replace(
            "[[steps]]\n        kind = \"preload\"\n        face = \"a.top\"\n        pressure = 1",
            "[wall]\nunit = [2, 1, 1]\nlength = 4\ncourses = 2\nbed_joint = 0\nhead_joint = 0\n\
             unit_material = \"stone\"\ninterface = \"dry\"\nat = [0, 5, 0]\nclamped = false",
        );
        let wall = Deck::from_str(&wall, "deck.toml").unwrap();
        let said = overrides("rigid", &case, &wall).unwrap();
        assert_eq!(said, [("strategy".to_owned(), "\"rigid\"".to_owned())]);
    }

    #[test]
    fn inertia_wants_mass_and_a_motion_is_none_of_statics() {
        let case = Case::empty();
        assert_eq!(
            overrides("quasi_static", &case, &deck("", "")),
            Err("stone has no density".to_owned())
        );
        assert!(overrides("quasi_static", &case, &deck("density = 2e-9", "")).is_ok());
        let moving = deck("density = 2e-9", "procedure = \"dynamic\"");
        assert!(overrides("quasi_static", &case, &moving).is_err());
        let said = overrides("consistent", &case, &moving).unwrap();
        assert!(
            said.iter().all(|(key, _)| !key.ends_with("procedure")),
            "{said:?}"
        );
    }

    #[test]
    fn every_method_is_one_that_the_deck_knows() {
        let plain = deck("density = 2e-9", "");
        for method in METHODS.iter().filter(|method| method.strategy.is_none()) {
            let said = method.overrides(&Case::empty(), &plain).unwrap();
            let text = DECK
                .replace("DENSITY", "density = 2e-9")
                .replace("DYNAMICS", "");
            let deck = Deck::from_str_with(&text, "deck.toml", &said);
            assert!(deck.is_ok(), "{}: {deck:?}", method.name);
        }
    }
}
