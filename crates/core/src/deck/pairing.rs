//! Pairs of faces in contact: those that the deck declares, and those that touch at rest.

use super::bodies::Bodies;
use super::name_registry::Place;
use super::overlap;
use super::schema::{Deck, DeckContact, Names};
use super::touch;
use crate::element::hexahedron::{Face, area_vector, norm};
use crate::error::{ErrorKind, Errors, ModelError};
use std::collections::{HashMap, HashSet};
use wythe_contact::{Aabb, Bvh};

/// A face of a body. `(body, face)`
pub(super) type Patch = (usize, usize);

/// A slave face and its masters.
pub(super) struct Pairing {
    pub(super) slave: Patch,
    pub(super) masters: Vec<Patch>,
    pub(super) interface: String,
    pub(super) path: String,
}

/// Largest gap at which faces touch at rest, as a fraction of the size of the smaller one: coordinates in decks are
/// rounded.
pub(super) const TOUCHES: f64 = 1e-3;

/// All pairings: first those of the arch and of columns, then the declared ones, then faces that touch.
///
/// # Errors
/// Unknown names, a slave face with two interfaces, a face that is both slave and master of another.
pub(super) fn pairings(deck: &Deck, bodies: &Bodies<'_>) -> Result<Vec<Pairing>, ModelError> {
    let mut pairings = Pairings::default();
    for joint in arch_pairings(deck, bodies) {
        pairings.push(joint);
    }
    let mut errors = Errors::default();
    for i in 0..deck.blocks.len() {
        for joint in errors
            .keep(column_pairings(deck, bodies, i))
            .unwrap_or_default()
        {
            pairings.push(joint);
        }
    }
    for (i, contact) in deck.contacts.iter().enumerate() {
        errors.keep(add_declared(deck, bodies, &mut pairings, contact, i));
    }
    for (i, contact) in deck.contacts.iter().enumerate() {
        if contact.slave.is_none() {
            let path = format!("contacts.{i}");
            errors.keep(add_touching(deck, bodies, &mut pairings, contact, &path));
        }
    }
    let mut all = pairings.all;
    for pairing in &mut all {
        pairing.masters.sort_unstable();
        pairing.masters.dedup();
    }
    errors.keep(require_apart(deck, bodies, &all));
    errors.end(all)
}

/// Largest number of pairs of a slave face and a master face: each is examined.
const MOST_PAIRS: usize = 1_000_000;

/// Largest mean number of faces that touch one face at rest; more mean that bodies lie in one place.
const MOST_TOUCHING: usize = 200;

/// Pairings, indexed by their slave face.
#[derive(Default)]
struct Pairings {
    all: Vec<Pairing>,
    of_slave: HashMap<Patch, usize>,
    /// Slave face and master face.
    pairs: HashSet<(Patch, Patch)>,
}

impl Pairings {
    fn push(&mut self, new: Pairing) {
        let place = *self.of_slave.entry(new.slave).or_insert(self.all.len());
        self.pairs
            .extend(new.masters.iter().map(|m| (new.slave, *m)));
        match self.all.get_mut(place) {
            Some(old) => old.masters.extend(new.masters),
            None => self.all.push(new),
        }
    }

    /// Returns whether two faces are paired, in either order.
    fn paired(&self, bodies: &Bodies<'_>, a: Patch, b: Patch) -> bool {
        if self.pairs.contains(&(a, b)) || self.pairs.contains(&(b, a)) {
            return true;
        }
        let has_sets = |(body, _): Patch| bodies.all[body].skin < bodies.all[body].faces.len();
        if !has_sets(a) && !has_sets(b) {
            return false;
        }
        let is = |p: &Pairing, a, b| {
            same(bodies, p.slave, a) && p.masters.iter().any(|m| same(bodies, *m, b))
        };
        self.all.iter().any(|p| is(p, a, b) || is(p, b, a))
    }
}

/// Adds the pairings that contact `i` declares, if it declares any.
fn add_declared(
    deck: &Deck,
    bodies: &Bodies<'_>,
    pairings: &mut Pairings,
    contact: &DeckContact,
    i: usize,
) -> Result<(), ModelError> {
    let path = format!("contacts.{i}");
    let (Some(slave), Some(master)) = (&contact.slave, &contact.master) else {
        return Ok(());
    };
    let slaves = patches(&bodies.places(&format!("{path}.slave"), slave, true)?);
    let masters = patches(&bodies.places(&format!("{path}.master"), master, true)?);
    if slaves.len().saturating_mul(masters.len())
        > MOST_PAIRS - pairings.pairs.len().min(MOST_PAIRS)
    {
        return Err(deck.error(
            &path,
            format!("{} slave faces and {} master faces are too many to be paired each with each", slaves.len(), masters.len()),
            "leave out slave and master: then faces that touch at rest meet; or pair them by several [[contacts]]",
        ).of_kind(ErrorKind::TooMany));
    }
    for slave in slaves {
        let others = masters.iter().filter(|m| m.0 != slave.0);
        let masters: Vec<Patch> = others.copied().collect();
        if masters.is_empty() {
            let name = &bodies.all[slave.0].name;
            return Err(deck
                .error(
                    &path,
                    format!("`{name}` would meet itself"),
                    "slave and master are faces of different blocks",
                )
                .of_kind(ErrorKind::Conflict));
        }
        let (interface, path) = (contact.interface.clone(), path.clone());
        let new = Pairing {
            slave,
            masters,
            interface,
            path,
        };
        add(deck, bodies, pairings, new)?;
    }
    Ok(())
}

fn patches(places: &[Place]) -> Vec<Patch> {
    let patch = |place: &Place| place.face.map(|face| (place.body, face));
    places.iter().filter_map(patch).collect()
}

/// Pairs the right face of each voussoir with the left one of the next, and the end faces with the springings.
fn arch_pairings(deck: &Deck, bodies: &Bodies<'_>) -> Vec<Pairing> {
    let Some(arch) = &deck.arch else {
        return Vec::new();
    };
    let (left, right) = (bodies.all.len() - 2, bodies.all.len() - 1);
    let first = left - arch.voussoirs as usize;
    let at = |(body, face): (usize, Face)| (body, face as usize);
    let joint = |slave, master| Pairing {
        slave: at(slave),
        masters: vec![at(master)],
        interface: arch.interface.clone(),
        path: "arch".to_owned(),
    };
    let mut pairings = vec![joint((first, Face::Left), (left, Face::Right))];
    pairings.extend((first..left).map(|i| {
        let next = if i + 1 < left { i + 1 } else { right };
        joint((i, Face::Right), (next, Face::Left))
    }));
    pairings
}

/// Pairs each block of a column with the one below it, if block `i` is a column.
fn column_pairings(deck: &Deck, bodies: &Bodies<'_>, i: usize) -> Result<Vec<Pairing>, ModelError> {
    let block = &deck.blocks[i];
    let (Some(_), Some(interface)) = (block.stack, &block.interface) else {
        return Ok(Vec::new());
    };
    let path = format!("blocks.{i}");
    let names = Names(vec![block.name.clone()]);
    let places = bodies.places(&path, &names, false)?;
    let joint = |pair: &[Place]| Pairing {
        slave: (pair[1].body, Face::Bottom as usize),
        masters: vec![(pair[0].body, Face::Top as usize)],
        interface: interface.clone(),
        path: path.clone(),
    };
    Ok(places.windows(2).map(joint).collect())
}

/// Adds the masters of a pairing to the pairing of the same slave face.
fn add(
    deck: &Deck,
    bodies: &Bodies<'_>,
    pairings: &mut Pairings,
    new: Pairing,
) -> Result<(), ModelError> {
    let face = |(body, face): Patch| {
        let body = &bodies.all[body];
        format!("{}.{}", body.name, body.faces[face].name)
    };
    let reversed = |m: &&Patch| pairings.pairs.contains(&(**m, new.slave));
    if let Some(other) = new.masters.iter().find(reversed) {
        return Err(deck
            .error(
                &new.path,
                format!(
                    "{} is slave and master of {}",
                    face(new.slave),
                    face(*other)
                ),
                "one side is the slave, the finer one; the other is the master",
            )
            .of_kind(ErrorKind::Conflict));
    }
    let old = pairings.of_slave.get(&new.slave).map(|i| &pairings.all[*i]);
    if let Some(old) = old.filter(|old| old.interface != new.interface) {
        return Err(deck
            .error(
                &new.path,
                format!(
                    "{} has the interface {} by {}",
                    face(new.slave),
                    old.interface,
                    old.path
                ),
                "a slave face has one interface; make it the master here, or cut the block in two",
            )
            .of_kind(ErrorKind::Conflict));
    }
    pairings.push(new);
    Ok(())
}

/// Returns whether two faces are equal or have facets in common, as sets of an imported body may.
fn same(bodies: &Bodies<'_>, a: Patch, b: Patch) -> bool {
    let body = &bodies.all[a.0];
    if a == b || a.0 != b.0 || body.skin == body.faces.len() {
        return a == b;
    }
    let [a, b] = [a, b].map(|(_, face)| &body.faces[face].facets);
    let elements: HashSet<[u32; 4]> = a.iter().map(|(_, facet)| *facet).collect();
    b.iter().any(|(_, facet)| elements.contains(facet))
}

/// Rejects facets that are slaves in two pairings: overlapping sets of an imported body.
fn require_apart(deck: &Deck, bodies: &Bodies<'_>, pairings: &[Pairing]) -> Result<(), ModelError> {
    let mut seen = HashSet::new();
    for pairing in pairings {
        let body = &bodies.all[pairing.slave.0];
        if body.skin == body.faces.len() {
            continue;
        }
        let face = &body.faces[pairing.slave.1];
        for (_, facet) in &face.facets {
            if !seen.insert(*facet) {
                return Err(deck
                    .error(
                        &pairing.path,
                        format!(
                            "a facet of {}.{} is in another slave face, too",
                            body.name, face.name
                        ),
                        "let sets that are slaves not overlap, or make one of them the master",
                    )
                    .of_kind(ErrorKind::Conflict));
            }
        }
    }
    Ok(())
}

/// Pairs all faces that touch at rest and are not paired yet. The finer face is the slave; if both are equally
/// fine, that of the first block.
fn add_touching(
    deck: &Deck,
    bodies: &Bodies<'_>,
    pairings: &mut Pairings,
    contact: &DeckContact,
    path: &str,
) -> Result<(), ModelError> {
    // Crowded scenes are rejected before their faces are compared.
    overlap::near(&overlap::boxes(bodies), overlap::TOUCHING)
        .map_err(|crowded| crowded.error(deck, bodies))?;
    let mut found = touching(bodies).map_err(|body| {
        let message = format!(
            "{} and very many others are in one place",
            bodies.called(body)
        );
        let help = "two bodies cannot be in one place: see `at`, `pitch` and the unit of length";
        deck.error(path, message, help).of_kind(ErrorKind::Conflict)
    })?;
    let count = found.len();
    found.retain(|(a, b)| !pairings.paired(bodies, *a, *b));
    if count == 0 {
        return Err(deck
            .error(
                path,
                "no two faces touch at rest",
                "name slave and master, or move the blocks together",
            )
            .of_kind(ErrorKind::Geometry));
    }
    for (slave, master) in found {
        let new = Pairing {
            slave,
            masters: vec![master],
            interface: contact.interface.clone(),
            path: path.to_owned(),
        };
        add(deck, bodies, pairings, new)?;
    }
    Ok(())
}

/// A flat part of a face.
struct Side {
    patch: Patch,
    outline: [[f64; 3]; 4],
    facet_area: f64,
    area: f64,
}

/// Flat parts of the boundaries of all bodies.
fn sides(bodies: &Bodies<'_>) -> Vec<Side> {
    let mut sides = Vec::new();
    for (b, block) in bodies.all.iter().enumerate() {
        for (f, face) in block.faces[..block.skin].iter().enumerate() {
            let facet_area = face.mean_facet();
            sides.extend(face.outlines.iter().map(|outline| Side {
                patch: (b, f),
                outline: *outline,
                facet_area,
                area: norm(area_vector(outline)),
            }));
        }
    }
    sides
}

/// Slave and master of all faces of different bodies that touch at rest, in ascending order.
///
/// # Errors
/// A body that is near too many others.
fn touching(bodies: &Bodies<'_>) -> Result<Vec<(Patch, Patch)>, usize> {
    let sides = sides(bodies);
    let boxes: Vec<Aabb> = sides
        .iter()
        .map(|side| touch::surroundings(&side.outline))
        .collect();
    let tree = Bvh::build(&boxes);
    let (mut stack, mut near, mut tried) = (Vec::new(), Vec::new(), 0);
    let mut found = Vec::new();
    for (i, a) in sides.iter().enumerate() {
        near.clear();
        tree.query(&boxes, &boxes[i], &mut stack, |j| near.push(j as usize));
        near.retain(|j: &usize| {
            let other = sides[*j].patch.0;
            other != a.patch.0 && !bodies.in_one_wall(a.patch.0, other)
        });
        tried += near.len();
        if tried > MOST_TOUCHING * sides.len() + 10_000 {
            return Err(a.patch.0);
        }
        for b in near.iter().filter(|j| **j > i).map(|j| &sides[*j]) {
            let reach = TOUCHES * a.area.min(b.area).sqrt();
            if touch::distance(&a.outline, &b.outline).is_some_and(|d| d.abs() <= reach) {
                found.push(slave_first(a, b));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

/// Slave and master of two faces: the finer one is the slave, else that of the first block.
fn slave_first(a: &Side, b: &Side) -> (Patch, Patch) {
    let finer = b.facet_area < a.facet_area * (1.0 - 1e-6);
    let coarser = b.facet_area > a.facet_area * (1.0 + 1e-6);
    if finer || (!coarser && b.patch.0 < a.patch.0) {
        (b.patch, a.patch)
    } else {
        (a.patch, b.patch)
    }
}
