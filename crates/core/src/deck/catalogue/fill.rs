//! Fills the keys that a material or joint with a `name` leaves out.

use std::borrow::Cow;
use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::joints::{JointSet, joints};
use super::materials::{MATERIALS, Sort};
use super::{Fact, Strengths, near, plain};
use crate::deck::quantity::Pressure;
use crate::deck::schema::JointKind;
use crate::deck::source::Source;
use crate::error::{ErrorKind, ModelError};

/// What a named material or joint takes from the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumption {
    /// Path of the table in the deck, such as `materials.brick`.
    pub path: String,
    /// Its `name`.
    pub name: String,
    /// Values that the deck does not give.
    pub taken: Vec<Taken>,
}

/// A value that is taken from the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Taken {
    /// Key.
    pub key: &'static str,
    /// Value with its unit.
    pub value: String,
    /// The rule from which it follows, if it is no plain value.
    pub rule: Option<String>,
    /// Its source.
    pub source: &'static str,
}

impl std::fmt::Display for Assumption {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (sort, own) = self.path.split_once('.').unwrap_or(("", &self.path));
        let sort = sort.trim_end_matches('s');
        write!(f, "{sort} {own} is `{}`", self.name)?;
        for (i, taken) in self.taken.iter().enumerate() {
            let sign = if i == 0 { ":" } else { ";" };
            write!(f, "{sign} {} = {}", taken.key, taken.value)?;
            match &taken.rule {
                Some(rule) => write!(f, " ({rule}; {})", taken.source)?,
                None => write!(f, " ({})", taken.source)?,
            }
        }
        if self.taken.is_empty() {
            f.write_str(": the deck gives all values")?;
        }
        Ok(())
    }
}

/// Result of [`fill`].
#[derive(Debug, Default)]
pub(in crate::deck) struct Filled {
    /// What was taken.
    pub(in crate::deck) assumed: Vec<Assumption>,
    /// Unknown names.
    pub(in crate::deck) errors: Vec<ModelError>,
}

/// Sets the keys of named materials and joints that the deck leaves out. Errors about them point at the name.
pub(in crate::deck) fn fill(source: &Source, root: &mut DeTable<'_>) -> Filled {
    let mut filled = Filled::default();
    for (section, of) in [
        ("materials", material as fn(&mut Named<'_, '_>) -> bool),
        ("interfaces", joint),
    ] {
        let Some(DeValue::Table(tables)) = root.get_mut(section).map(Spanned::get_mut) else {
            continue;
        };
        for (own, table) in tables.iter_mut() {
            let path = format!("{section}.{}", own.get_ref());
            let DeValue::Table(table) = table.get_mut() else {
                continue;
            };
            let Some((name, span)) = name_of(table) else {
                continue;
            };
            let mut named = Named {
                name: &name,
                span,
                table,
                taken: Vec::new(),
            };
            if !of(&mut named) {
                filled.errors.push(unknown(source, section, &path, &name));
            }
            let taken = std::mem::take(&mut named.taken);
            filled.assumed.push(Assumption { path, name, taken });
        }
    }
    filled
}

/// The `name` of a table, with its place.
fn name_of(table: &DeTable<'_>) -> Option<(String, Range<usize>)> {
    let value = table.get("name")?;
    match value.get_ref() {
        DeValue::String(name) => Some((name.to_string(), value.span())),
        _ => None,
    }
}

/// A table with a `name`.
struct Named<'t, 'i> {
    name: &'t str,
    span: Range<usize>,
    table: &'t mut DeTable<'i>,
    taken: Vec<Taken>,
}

impl Named<'_, '_> {
    fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    fn text(&self, key: &str) -> Option<&str> {
        match self.table.get(key)?.get_ref() {
            DeValue::String(text) => Some(text),
            _ => None,
        }
    }

    /// A pressure that the deck gives [MPa]; none if it cannot be read or is not positive, which is an error of its
    /// own.
    fn pressure(&self, key: &str) -> Option<f64> {
        let value = toml::de::ValueDeserializer::from(self.table.get(key)?.clone());
        let value = Pressure::deserialize(value).ok()?.get();
        (value > 0.0).then_some(value)
    }

    /// Sets a key and returns its value.
    fn set(&mut self, key: &'static str, fact: Fact, of: Strengths) -> f64 {
        let value = fact.rule.value(of);
        let text = format!("{}{}", rounded(value), unit(key));
        let given = Spanned::new(self.span.clone(), DeValue::String(Cow::Owned(text.clone())));
        self.table
            .insert(Spanned::new(self.span.clone(), Cow::Borrowed(key)), given);
        self.taken.push(Taken {
            key,
            value: text,
            rule: fact.rule.words(),
            source: fact.source,
        });
        value
    }

    /// Sets a pressure unless the deck gives it; returns the one that holds [MPa].
    fn pressure_or(&mut self, key: &'static str, fact: Fact, of: Strengths) -> f64 {
        if self.has(key) {
            let given = self.pressure(key);
            given.unwrap_or_else(|| fact.rule.value(of))
        } else {
            self.set(key, fact, of)
        }
    }
}

/// Fills a material; returns false if its name is not known, and takes the first of the catalogue then, so that no
/// further errors follow.
fn material(named: &mut Named<'_, '_>) -> bool {
    let found = MATERIALS
        .iter()
        .find(|m| plain(m.name) == plain(named.name));
    let material = found.unwrap_or(&MATERIALS[0]);
    let [tension, compression] = ["tension", "compression"].map(|table| named.has(table));
    let other_law = named
        .text("kind")
        .is_some_and(|kind| kind != "damage-plasticity");
    let mut of = Strengths::default();
    let own = material.strength.rule.value(of);
    // A unit's strength by test comes before its uniaxial strength: everything else follows from it.
    let by_test = named
        .pressure("f_b")
        .filter(|_| material.sort == Sort::Unit);
    of.compression = by_test.or_else(|| named.pressure("f_c")).unwrap_or(own);
    let strength = Fact {
        rule: super::Rule::Value(of.compression),
        source: if by_test.is_some() {
            "f_b of the deck"
        } else {
            material.strength.source
        },
    };
    for (key, fact) in material.facts() {
        let unread = match key {
            "f_t" | "G_ft" => other_law || tension,
            "f_c" | "G_fc" => other_law || compression,
            _ => false,
        };
        if unread {
            continue;
        }
        match key {
            "f_c" => {
                named.pressure_or(key, strength, of);
            }
            "f_t" => of.tension = named.pressure_or(key, fact, of),
            _ if !named.has(key) => {
                named.set(key, fact, of);
            }
            _ => {}
        }
    }
    found.is_some()
}

/// Fills a joint; as [`material`].
fn joint(named: &mut Named<'_, '_>) -> bool {
    let sets = joints();
    let found = sets
        .iter()
        .find(|set| plain(&set.name) == plain(named.name));
    let set = found.unwrap_or(&sets[0]);
    let kind = match named.text("kind") {
        Some("cap") => JointKind::Cap,
        _ => JointKind::CohesiveFrictional,
    };
    let mut of = Strengths::default();
    for (key, fact) in set.facts() {
        let other = match key {
            "G_I" => "u_k",
            "G_II" => "delta_k",
            _ => key,
        };
        if key == "c" {
            of.cohesion = named.pressure_or(key, fact, of);
        } else if JointSet::is_read(key, kind) && !named.has(key) && !named.has(other) {
            named.set(key, fact, of);
        }
    }
    found.is_some()
}

fn unknown(source: &Source, section: &str, path: &str, name: &str) -> ModelError {
    let sets = joints();
    let names: Vec<&str> = if section == "materials" {
        MATERIALS.iter().map(|m| m.name).collect()
    } else {
        sets.iter().map(|set| set.name.as_str()).collect()
    };
    let near: Vec<String> = near(name, names.into_iter())
        .into_iter()
        .map(|name| format!("`{name}`"))
        .collect();
    let what = if section == "materials" {
        "material"
    } else {
        "joint"
    };
    source
        .error(
            &format!("{path}.name"),
            format!("the catalogue has no {what} named `{name}`"),
            &format!(
                "near names: {}; docs/reference/materials.md lists all",
                near.join(", ")
            ),
        )
        .of_kind(ErrorKind::UnknownName)
}

/// Unit of the values of a key.
fn unit(key: &str) -> &'static str {
    match key {
        "E" | "f_c" | "f_t" | "c" => " MPa",
        "density" => " kg/m^3",
        "G_ft" | "G_fc" | "G_I" | "G_II" => " N/mm",
        _ => "",
    }
}

/// Rounds a value that follows from others to five digits.
pub(super) fn rounded(value: f64) -> f64 {
    let text = format!("{value:.4e}");
    text.parse().unwrap_or(value)
}
