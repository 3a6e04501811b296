//! Scatter of bond strength from unit to unit: `[interfaces.NAME.scatter]`.
//!
//! The strength of a bond scatters because mortar adheres to a different part of the face of each unit (van der
//! Pluijm's net bond surface). On the bonded part of the area, tensile strength f_t, cohesion c and both fracture
//! energies have their usual values. Over the whole area all four are proportional to that part: f_t and c have one
//! factor x, and the separations u_k and δ_k at complete loss of bond do not change. Friction acts on all surfaces
//! that press on each other, bonded or not, and stiffnesses are penalties: neither changes. The law has no
//! dilatancy that could scatter.
//!
//! x is lognormal with mean 1 and coefficient of variation v; z is a standard normal number of the unit:
//!
//! x = exp(s z − s²/2),  s² = ln(1 + v²)

use super::schema::Deck;
use crate::error::{ErrorKind, ModelError};
use crate::model::scene::ContactSurfaces;
use chacha20::ChaCha20Rng;
use chacha20::rand_core::{Rng, SeedableRng};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Number of laws that the `u16` of a facet can index.
pub(super) const MOST_LAWS: usize = 1 << 16;

/// Factor of the bond strength of the unit (body) number `unit`: lognormal, with mean 1 and coefficient of
/// variation `cv`.
///
/// It depends on the arguments only. `interface` counts the interfaces that scatter, from 0, in the order in which
/// they first occur among the slave facets of the model; their names do not matter. The random numbers are those of
/// ChaCha20 (64-bit counter and nonce), which is a fixed algorithm: key `seed` (little-endian, then zeros), nonce
/// `interface`, block `unit`. The first two 64-bit words of the block give z by the transform of Box and Muller.
pub fn factor(cv: f64, seed: u64, interface: u64, unit: u32) -> f64 {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    let mut words = ChaCha20Rng::from_seed(key);
    words.set_stream(interface);
    words.set_block_pos(u64::from(unit));
    // Integers below 2⁵³, which a double represents exactly.
    let mut uniform = || (words.next_u64() >> 11) as f64;
    let scale = 1.0 / (1_u64 << 53) as f64;
    // (0, 1]: its logarithm is finite.
    let radius = (-2.0 * ((uniform() + 1.0) * scale).ln()).sqrt();
    let z = radius * (TAU * (uniform() * scale)).cos();
    let variance = (cv * cv).ln_1p();
    (variance.sqrt() * z - 0.5 * variance).exp()
}

/// Factors of all units that own slave facets of the interface `name`, by the number of the unit; none if the
/// interface does not scatter.
pub fn factors(deck: &Deck, contact: &ContactSurfaces, name: &str) -> Option<Vec<(u32, f64)>> {
    let scatter = deck.interfaces.get(name)?.scatter?;
    let number = scattered(deck, contact).iter().position(|n| *n == name)?;
    let of = |f: &usize| contact.law_names[usize::from(contact.slave_law[*f])] == name;
    let facets = (0..contact.slave_facets.len()).filter(of);
    let mut units: Vec<u32> = facets.map(|f| contact.slave_body[f]).collect();
    units.sort_unstable();
    units.dedup();
    let drawn = |unit| factor(scatter.cv.get(), scatter.seed, number as u64, unit);
    Some(units.into_iter().map(|unit| (unit, drawn(unit))).collect())
}

/// Interfaces that scatter, in the order in which they first occur among the slave facets.
fn scattered<'a>(deck: &Deck, contact: &'a ContactSurfaces) -> Vec<&'a str> {
    let mut met = vec![false; contact.laws.len()];
    let mut names: Vec<&str> = Vec::new();
    for &law in &contact.slave_law {
        let law = usize::from(law);
        if std::mem::replace(&mut met[law], true) {
            continue;
        }
        let name = contact.law_names[law].as_str();
        let scatters = deck
            .interfaces
            .get(name)
            .is_some_and(|i| i.scatter.is_some());
        if scatters && !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Gives each unit laws of its own on its slave facets of interfaces that scatter.
///
/// # Errors
/// More laws than facets can index, with or without scatter.
pub(super) fn scatter(deck: &Deck, contact: &mut ContactSurfaces) -> Result<(), ModelError> {
    if contact.laws.len() > MOST_LAWS {
        return Err(too_many(deck, "interfaces", contact.laws.len()));
    }
    let order = scattered(deck, contact);
    let Some(&first) = order.first() else {
        return Ok(());
    };
    let (mut laws, mut law_names, mut slave_law) = (Vec::new(), Vec::new(), Vec::new());
    // Index of the new law by the law between two elements and, if it scatters, the unit.
    let mut places: HashMap<(u16, Option<u32>), usize> = HashMap::new();
    for (&law, &unit) in contact.slave_law.iter().zip(&contact.slave_body) {
        let name = contact.law_names[usize::from(law)].as_str();
        let number = order.iter().position(|n| *n == name);
        let place = *places
            .entry((law, number.map(|_| unit)))
            .or_insert_with(|| {
                let mut own = contact.laws[usize::from(law)].clone();
                let scatter = deck.interfaces.get(name).and_then(|i| i.scatter);
                if let Some((number, scatter)) = number.zip(scatter) {
                    let x = factor(scatter.cv.get(), scatter.seed, number as u64, unit);
                    own.scale_bond(x);
                }
                laws.push(own);
                law_names.push(name.to_owned());
                laws.len() - 1
            });
        slave_law.push(place as u16);
    }
    if laws.len() > MOST_LAWS {
        return Err(too_many(
            deck,
            &format!("interfaces.{first}.scatter"),
            laws.len(),
        ));
    }
    (contact.laws, contact.law_names, contact.slave_law) = (laws, law_names, slave_law);
    Ok(())
}

fn too_many(deck: &Deck, path: &str, count: usize) -> ModelError {
    deck.error(
        path,
        format!(
            "{count} laws of interfaces, one for every pair of stiffnesses that meet and every unit that \
             scatters, are too many"
        ),
        "at most 65536: give normal_stiffness and shear_stiffness, so that all facets share them, or build \
         a part of it",
    ).of_kind(ErrorKind::TooMany)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::templates;

    /// A contact with one facet of each unit, all with one law.
    fn contact(deck: &Deck, units: u32) -> ContactSurfaces {
        let count = units as usize;
        ContactSurfaces {
            slave_facets: vec![[0; 4]; count],
            slave_body: (0..units).collect(),
            slave_law: vec![0; count],
            laws: vec![deck.interfaces["joint"].law(1.0, 1.0)],
            law_names: vec!["joint".to_owned()],
            ..ContactSurfaces::default()
        }
    }

    fn deck(overrides: &[(&str, &str)]) -> Deck {
        let text = templates::find("couplet").unwrap().text;
        let overrides = overrides.iter().map(|(k, v)| ((*k).into(), (*v).into()));
        let overrides: Vec<_> = overrides.collect();
        Deck::from_str_with(text, "couplet.toml", &overrides).unwrap()
    }

    #[test]
    fn more_laws_than_facet_indices_allow_are_rejected() {
        let scattered = deck(&[("interfaces.joint.scatter.cv", "0.3")]);
        let mut most = contact(&scattered, 65536);
        scatter(&scattered, &mut most).unwrap();
        assert_eq!((most.laws.len(), most.slave_law[65535]), (65536, 65535));
        let error = scatter(&scattered, &mut contact(&scattered, 65537)).unwrap_err();
        assert_eq!(error.key(), "interfaces.joint.scatter");
        assert!(error.message().starts_with("65537 laws"), "{error}");
        // Without scatter units share their laws, unless their elements differ.
        let plain = deck(&[]);
        let mut shared = contact(&plain, 65537);
        scatter(&plain, &mut shared).unwrap();
        assert_eq!(shared.laws.len(), 1);
        shared.laws = vec![shared.laws[0].clone(); 65537];
        assert!(scatter(&plain, &mut shared).is_err());
    }
}
