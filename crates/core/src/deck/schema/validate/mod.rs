//! Checks ranges of a deck and conditions between its keys. All errors are found, not only the first.

mod blocks;
mod floors;
mod imports;
mod interfaces;
mod loads;
mod materials;
mod probes;
mod references;
mod sections;
mod settlements;
mod steps;
mod strategy;
mod test;
mod ties;
mod wall;

use super::form::Broken;
use super::{Deck, Material};
use crate::deck::amount;
use crate::deck::keys;
use crate::deck::quantity::{Number, Quantity};
use crate::error::{MOST_ERRORS, ModelError};
pub(in crate::deck) use loads::misfit;

/// Largest number of parts of a facet along an axis: no joint needs more.
const MOST_PARTS: u32 = 16;

/// A value of a key that may be absent.
trait Given {
    fn given(self) -> Option<f64>;
}

impl<const L: i8, const M: i8, const T: i8, const A: i8> Given for Quantity<L, M, T, A> {
    fn given(self) -> Option<f64> {
        Some(self.get())
    }
}

impl<G: Given> Given for Option<G> {
    fn given(self) -> Option<f64> {
        self.and_then(G::given)
    }
}

/// Errors found so far.
struct Checks<'a> {
    deck: &'a Deck,
    broken: &'a Broken,
    errors: Vec<ModelError>,
}

/// Runs all checks that need no mesh: ranges, contradictions, unknown names. Checks that depend on a `broken` value
/// are left out.
pub(super) fn validate(deck: &Deck, broken: &Broken) -> Vec<ModelError> {
    let mut checks = Checks {
        deck,
        broken,
        errors: Vec::new(),
    };
    checks.demand(
        deck.format == 1,
        "format",
        || format!("format {} is not known", deck.format),
        "this version reads format = 1",
    );
    if let Err(too_many) = amount::require_few(deck) {
        checks.errors.push(too_many);
        return checks.errors;
    }
    for (name, material) in &deck.materials {
        checks.material(&format!("materials.{name}"), material);
    }
    for (name, interface) in &deck.interfaces {
        checks.interface(&format!("interfaces.{name}"), interface);
    }
    for (path, _, wall) in deck.walls() {
        checks.wall(&path, wall);
    }
    checks.walls();
    checks.scene();
    checks.imports();
    checks.probes();
    checks.loads();
    checks.settlements();
    checks.ties();
    checks.floors();
    checks.sections();
    checks.simplified();
    checks.test();
    for (i, step) in deck.steps.iter().enumerate() {
        checks.step(&format!("steps.{i}"), step);
    }
    checks.output();
    checks.positive("contact.search_radius", deck.contact.search_radius);
    checks.demand(
        deck.contact
            .parts
            .iter()
            .all(|n| (1..=MOST_PARTS).contains(n)),
        "contact.parts",
        || format!("a facet is cut into 1 to {MOST_PARTS} parts along each axis"),
        "parts = [1, 3, 1] has six points through the thickness of one element",
    );
    checks.general_contact();
    checks.references();
    checks.errors
}

/// Checks a material of an imported file as if it stood at `path` of the deck.
pub(in crate::deck) fn imported_material(
    deck: &Deck,
    path: &str,
    material: &Material,
) -> Vec<ModelError> {
    let broken = Broken::default();
    let mut checks = Checks {
        deck,
        broken: &broken,
        errors: Vec::new(),
    };
    checks.material(path, material);
    checks.errors
}

impl Checks<'_> {
    fn output(&mut self) {
        self.require(
            self.deck.output.every > 0,
            "output.every",
            || "a frame every 0 increments means nothing".to_owned(),
            "1 writes every increment",
        );
        self.require(
            self.deck.output.scene_every > 0,
            "output.scene_every",
            || "a scene every 0 frames means nothing".to_owned(),
            "1 shows every frame; mcap = false writes no run.mcap at all",
        );
    }

    /// Adds an error unless `ok`: a condition between the key at `path` and others of its section.
    fn require(&mut self, ok: bool, path: &str, message: impl FnOnce() -> String, help: &str) {
        if !self.broken.section(path) {
            self.demand(ok, path, message, help);
        }
    }

    /// Returns whether enough errors are known.
    fn is_full(&self) -> bool {
        self.errors.len() > 5 * MOST_ERRORS
    }

    /// Adds an error unless `ok`: a condition on the value at `path` alone.
    fn demand(&mut self, ok: bool, path: &str, message: impl FnOnce() -> String, help: &str) {
        if !ok && !self.is_full() && !self.broken.holds(path) {
            self.errors.push(self.deck.error(path, message(), help));
        }
    }

    /// Requires a value above 0, if there is one.
    fn positive(&mut self, path: &str, value: impl Given) {
        let Some(value) = value.given() else { return };
        self.demand(
            value > 0.0,
            path,
            || format!("{value} is not positive"),
            "give a value above 0",
        );
    }

    /// Requires a name of a letter, then letters, digits, - and _; `of` is the kind of its bearer.
    fn plain_name(&mut self, path: &str, name: &str, of: &str) {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        self.demand(
            name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(plain),
            path,
            || format!("`{name}` is no name for a {of}"),
            "a letter, then letters, digits, - and _",
        );
    }

    /// Requires a value of 0 or more, if there is one.
    fn not_negative(&mut self, path: &str, value: impl Given) {
        let Some(value) = value.given() else { return };
        self.demand(
            value >= 0.0,
            path,
            || format!("{value} is negative"),
            "give 0 or more",
        );
    }

    /// Adds an error about a key that is `needed` and missing.
    fn missing(&mut self, path: &str, name: &str, needed: bool) {
        self.require(
            !needed,
            &format!("{path}.{name}"),
            || format!("the key `{name}` is missing"),
            &keys::example(name),
        );
    }

    fn within(&mut self, path: &str, value: Number, range: std::ops::RangeInclusive<f64>) {
        let value = value.get();
        let (low, high) = (*range.start(), *range.end());
        self.demand(
            range.contains(&value),
            path,
            || format!("{value} is not between {low} and {high}"),
            &format!("give a value from {low} to {high}"),
        );
    }

    /// Checks that the interface of general contact exists and is dry.
    fn general_contact(&mut self) {
        let deck = self.deck;
        let (path, Some(name)) = ("contact.general", &deck.contact.general) else {
            return;
        };
        self.known_interface(path, name);
        let bonded = deck.interfaces.get(name).is_some_and(|f| !f.is_dry());
        let broken = self.broken.holds(&format!("interfaces.{name}.f_t"))
            || self.broken.holds(&format!("interfaces.{name}.c"));
        self.demand(
            !bonded || broken,
            path,
            || format!("{name} is bonded, and bodies that meet later have nothing between them that could bond"),
            "name an interface with f_t = 0 and c = 0; bonds are those of joints that touch at rest: \
             [[contacts]], the joints of a wall or of an arch",
        );
    }
}
