//! Which faces of a scene of blocks meet: slaves, masters, laws; and which blocks rest on which.

use super::blocks::{Blocks, Place};
use super::deck::{Deck, DeckContact, Interface};
use super::hexahedron::{Face, Shape, area_vector, difference, dot, mean, norm};
use super::joint::{Side, law_between};
use super::quantity::Quantity;
use super::scene::ContactSurfaces;
use super::touch;
use crate::error::{ModelError, Warning};
use crate::material::ElasticParameters;

/// A face of a block. `(block, face)`
type Patch = (usize, Face);

/// Slave faces with the masters that they are declared to meet.
struct Pairing {
    slave: Patch,
    masters: Vec<Patch>,
    interface: String,
    path: String,
}

/// Two blocks that touch at rest.
pub(super) struct Touching {
    pub(super) bodies: (u32, u32),
    pub(super) interface: String,
}

/// Surfaces of a scene of blocks.
pub(super) struct Meeting {
    pub(super) contact: ContactSurfaces,
    pub(super) touching: Vec<Touching>,
    pub(super) warnings: Vec<Warning>,
}

/// Gap up to which faces touch at rest, as part of the smaller one's size: decks round.
const TOUCHES: f64 = 1e-3;

/// Finds what meets.
///
/// `elastic`: constants of the materials by index.
///
/// # Errors
/// Names of nothing, faces of two interfaces, faces that never face each other.
pub(super) fn meeting(
    deck: &Deck,
    blocks: &Blocks<'_>,
    elastic: &[ElasticParameters],
) -> Result<Meeting, ModelError> {
    let mut pairings = arch_pairings(deck, blocks);
    for (i, contact) in deck.contacts.iter().enumerate() {
        let path = format!("contacts.{i}");
        if let (Some(slave), Some(master)) = (&contact.slave, &contact.master) {
            let slaves = patches(&blocks.places(&format!("{path}.slave"), slave, true)?);
            let masters = patches(&blocks.places(&format!("{path}.master"), master, true)?);
            for slave in slaves {
                let others = masters.iter().filter(|m| m.0 != slave.0);
                let masters: Vec<Patch> = others.copied().collect();
                if masters.is_empty() {
                    let name = &blocks.placed[slave.0].name;
                    return Err(deck.error(
                        &path,
                        format!("`{name}` would meet itself"),
                        "slave and master are faces of different blocks",
                    ));
                }
                let interface = contact.interface.clone();
                let path = path.clone();
                add(
                    deck,
                    blocks,
                    &mut pairings,
                    Pairing {
                        slave,
                        masters,
                        interface,
                        path,
                    },
                )?;
            }
        }
    }
    for (i, contact) in deck.contacts.iter().enumerate() {
        if contact.slave.is_none() {
            add_touching(
                deck,
                blocks,
                &mut pairings,
                contact,
                &format!("contacts.{i}"),
            )?;
        }
    }
    assemble(deck, blocks, elastic, &pairings)
}

fn patches(places: &[Place]) -> Vec<Patch> {
    let patch = |place: &Place| place.face.map(|face| (place.block, face));
    places.iter().filter_map(patch).collect()
}

/// Each voussoir's right face against the next one's left, the ends against the springings.
fn arch_pairings(deck: &Deck, blocks: &Blocks<'_>) -> Vec<Pairing> {
    let Some(arch) = &deck.arch else {
        return Vec::new();
    };
    let (left, right) = (blocks.placed.len() - 2, blocks.placed.len() - 1);
    let first = left - arch.voussoirs as usize;
    let joint = |slave, master| Pairing {
        slave,
        masters: vec![master],
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

/// Adds a pairing to that of the same slave face.
fn add(
    deck: &Deck,
    blocks: &Blocks<'_>,
    pairings: &mut Vec<Pairing>,
    new: Pairing,
) -> Result<(), ModelError> {
    let face = |(block, face): Patch| {
        let name = Face::ALL.iter().find(|f| f.1 == face).map_or("", |f| f.0);
        format!("{}.{name}", blocks.placed[block].name)
    };
    let reversed = pairings
        .iter()
        .find(|p| new.masters.contains(&p.slave) && p.masters.contains(&new.slave));
    if let Some(other) = reversed {
        return Err(deck.error(
            &new.path,
            format!(
                "{} is slave and master of {}",
                face(new.slave),
                face(other.slave)
            ),
            "one side is the slave, the finer one; the other is the master",
        ));
    }
    let Some(old) = pairings.iter_mut().find(|p| p.slave == new.slave) else {
        pairings.push(new);
        return Ok(());
    };
    if old.interface != new.interface {
        return Err(deck.error(
            &new.path,
            format!(
                "{} has the interface {} by {}",
                face(new.slave),
                old.interface,
                old.path
            ),
            "a slave face has one interface; make it the master here, or cut the block in two",
        ));
    }
    old.masters.extend(new.masters);
    old.masters
        .sort_by_key(|(block, face)| (*block, *face as usize));
    old.masters.dedup();
    Ok(())
}

/// All faces that touch at rest and are not yet paired; the finer one is the slave, or else that of
/// the block which comes first.
fn add_touching(
    deck: &Deck,
    blocks: &Blocks<'_>,
    pairings: &mut Vec<Pairing>,
    contact: &DeckContact,
    path: &str,
) -> Result<(), ModelError> {
    struct Side {
        patch: Patch,
        outline: [[f64; 3]; 4],
        from: f64,
        to: f64,
        facet_area: f64,
        area: f64,
    }
    let mut sides = Vec::new();
    for (b, block) in blocks.placed.iter().enumerate() {
        for (_, face) in Face::ALL {
            let facet_area = block.mean_facet(face, &blocks.mesh);
            for outline in block.outlines(face, &blocks.mesh) {
                let x = outline.map(|x| x[0]);
                sides.push(Side {
                    patch: (b, face),
                    outline,
                    from: x.iter().copied().fold(f64::INFINITY, f64::min),
                    to: x.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                    facet_area,
                    area: norm(area_vector(&outline)),
                });
            }
        }
    }
    // Sorted along x, a face can touch only those that begin before it ends.
    sides.sort_by(|a, b| a.from.total_cmp(&b.from));
    let mut found = Vec::new();
    for (i, a) in sides.iter().enumerate() {
        let reach = TOUCHES * a.area.sqrt();
        for b in sides[i + 1..].iter().take_while(|b| b.from <= a.to + reach) {
            let reach = TOUCHES * a.area.min(b.area).sqrt();
            let near = a.patch.0 != b.patch.0
                && touch::distance(&a.outline, &b.outline).is_some_and(|d| d.abs() <= reach);
            if !near {
                continue;
            }
            let finer = b.facet_area < a.facet_area * (1.0 - 1e-6);
            let coarser = b.facet_area > a.facet_area * (1.0 + 1e-6);
            let (slave, master) = if finer || (!coarser && b.patch.0 < a.patch.0) {
                (b.patch, a.patch)
            } else {
                (a.patch, b.patch)
            };
            found.push((slave, master));
        }
    }
    found.sort_by_key(|((a, f), (b, g))| (*a, *f as usize, *b, *g as usize));
    found.dedup();
    let paired = |a: Patch, b: Patch, pairings: &[Pairing]| {
        let is = |p: &Pairing, a, b| p.slave == a && p.masters.contains(&b);
        pairings.iter().any(|p| is(p, a, b) || is(p, b, a))
    };
    let count = found.len();
    found.retain(|(a, b)| !paired(*a, *b, pairings));
    if count == 0 {
        return Err(deck.error(
            path,
            "no two faces touch at rest",
            "name slave and master, or move the blocks together",
        ));
    }
    for (slave, master) in found {
        let new = Pairing {
            slave,
            masters: vec![master],
            interface: contact.interface.clone(),
            path: path.to_owned(),
        };
        add(deck, blocks, pairings, new)?;
    }
    Ok(())
}

/// A facet of a master face, as slaves look for it.
struct Facing<'a> {
    centre: [f64; 3],
    normal: [f64; 3],
    side: Side<'a>,
}

/// Facets and laws of all pairings.
fn assemble(
    deck: &Deck,
    blocks: &Blocks<'_>,
    elastic: &[ElasticParameters],
    pairings: &[Pairing],
) -> Result<Meeting, ModelError> {
    let mut contact = ContactSurfaces::default();
    let (mut touching, mut warnings) = (Vec::new(), Vec::new());
    let mesh = &blocks.mesh;
    let describe = |element: usize, facet: &[u32; 4]| {
        let x = facet.map(|n| mesh.nodes[n as usize]);
        let area = area_vector(&x);
        Facing {
            centre: mean(&x),
            normal: area,
            side: Side {
                material: &elastic[mesh.material[element] as usize],
                size: mesh.volume(element) / norm(area),
            },
        }
    };
    for pairing in pairings {
        let Some(interface) = deck.interfaces.get(&pairing.interface) else {
            continue; // refused when the deck was read
        };
        let body = blocks.placed[pairing.slave.0].body;
        let facets = |patch: &Patch| blocks.placed[patch.0].facets(patch.1);
        let masters: Vec<Facing<'_>> = pairing
            .masters
            .iter()
            .flat_map(facets)
            .map(|(element, facet)| describe(element, &facet))
            .collect();
        for (element, facet) in facets(&pairing.slave) {
            let here = describe(element, &facet);
            let opposed = masters.iter().filter(|m| dot(m.normal, here.normal) < 0.0);
            let distance = |m: &Facing<'_>| norm(difference(m.centre, here.centre));
            let nearest = opposed.min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let Some(facing) = nearest else {
                return Err(deck.error(
                    &pairing.path,
                    format!(
                        "{}.{}: no master faces it",
                        blocks.placed[pairing.slave.0].name,
                        Face::ALL[pairing.slave.1 as usize].0
                    ),
                    "faces that meet look at each other: block.bottom on base.top",
                ));
            };
            let (a, b) = (here.side, facing.side);
            let law = law_between(&mut contact, &pairing.interface, interface, a, b);
            contact.slave_facets.push(facet);
            contact.slave_body.push(body);
            contact.slave_law.push(law);
        }
        warnings.extend(overhang(deck, blocks, interface, pairing));
        let slave_area = mean_facet(blocks, pairing.slave);
        let coarser = pairing
            .masters
            .iter()
            .find(|m| mean_facet(blocks, **m) < 0.5 * slave_area);
        if let Some(master) = coarser.filter(|_| pairing.path != "arch") {
            warnings.push(deck.warning(
                &pairing.path,
                format!(
                    "the slave {} is coarser than its master {}: points are on the slave, which \
                     should be the finer side",
                    blocks.placed[pairing.slave.0].name, blocks.placed[master.0].name
                ),
            ));
        }
        for master in &pairing.masters {
            let Some(gap) = gap(blocks, pairing.slave, *master) else {
                continue;
            };
            let reach = reach(deck, interface, blocks, pairing.slave);
            if gap.abs() <= reach {
                touching.push(Touching {
                    bodies: (body, blocks.placed[master.0].body),
                    interface: pairing.interface.clone(),
                });
            }
            if gap < -TOUCHES * slave_area.sqrt() && gap > -0.1 * slave_area.sqrt() {
                let (a, b) = (
                    &blocks.placed[pairing.slave.0].name,
                    &blocks.placed[master.0].name,
                );
                warnings.push(deck.warning(
                    &pairing.path,
                    format!("{a} and {b} interpenetrate by {:.4} mm at rest", -gap),
                ));
            }
        }
    }
    add_masters(blocks, pairings, &mut contact);
    Ok(Meeting {
        contact,
        touching,
        warnings,
    })
}

/// Slave facets that reach over the edges of the masters below them: points beyond carry nothing, and
/// the points that are left do not show where the edge is.
fn overhang(
    deck: &Deck,
    blocks: &Blocks<'_>,
    interface: &Interface,
    pairing: &Pairing,
) -> Option<Warning> {
    let block = &blocks.placed[pairing.slave.0];
    let curved = |(b, _): &Patch| matches!(blocks.placed[*b].shape, Shape::Grid(_));
    if pairing.masters.iter().any(curved) {
        return None; // what is curved leaves its neighbour before its edge
    }
    let reach = reach(deck, interface, blocks, pairing.slave);
    let outlines = pairing.masters.iter();
    let outlines: Vec<_> = outlines
        .flat_map(|(block, face)| blocks.placed[*block].outlines(*face, &blocks.mesh))
        .collect();
    let facets = block.facets(pairing.slave.1);
    let over = |facet: &[u32; 4]| {
        let x = facet.map(|n| blocks.mesh.nodes[n as usize]);
        let below = |o: &&[[f64; 3]; 4]| touch::distance(&x, o).is_some_and(|d| d.abs() <= reach);
        let below: Vec<_> = outlines.iter().filter(below).collect();
        let covered = |corner: &[f64; 3]| below.iter().any(|o| touch::covers(o, *corner));
        !below.is_empty() && !x.iter().all(covered)
    };
    let count = facets.iter().filter(|(_, facet)| over(facet)).count();
    (count > 0).then(|| {
        deck.warning(
            &pairing.path,
            format!(
                "{count} facets of {} reach over the edge of what they rest on: points beyond it carry \
                 nothing (let a line of the mesh follow the edge, or make the smaller face the slave)",
                block.name
            ),
        )
    })
}

/// Every master face once.
fn add_masters(blocks: &Blocks<'_>, pairings: &[Pairing], contact: &mut ContactSurfaces) {
    let mut masters: Vec<Patch> = pairings.iter().flat_map(|p| p.masters.clone()).collect();
    masters.sort_by_key(|(block, face)| (*block, *face as usize));
    masters.dedup();
    for (block, face) in masters {
        let block = &blocks.placed[block];
        for (_, facet) in block.facets(face) {
            contact.master_facets.push(facet);
            contact.master_body.push(block.body);
        }
    }
}

/// Mean area of the facets of a face [mm²].
fn mean_facet(blocks: &Blocks<'_>, (block, face): Patch) -> f64 {
    blocks.placed[block].mean_facet(face, &blocks.mesh)
}

/// Least distance between faces where they oppose each other [mm], see [`touch::distance`].
fn gap(blocks: &Blocks<'_>, a: Patch, b: Patch) -> Option<f64> {
    let outlines = |(block, face): Patch| blocks.placed[block].outlines(face, &blocks.mesh);
    let (a, b) = (outlines(a), outlines(b));
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
    let gaps = pairs.filter_map(|(a, b)| touch::distance(a, b));
    gaps.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// Gap up to which two faces hold each other at rest [mm]: that of the search, else 0.06 of a facet,
/// at least 2 `u_k`.
fn reach(deck: &Deck, interface: &Interface, blocks: &Blocks<'_>, slave: Patch) -> f64 {
    let chosen = 0.06 * mean_facet(blocks, slave).sqrt();
    let least = 2.0 * interface.ultimate_opening();
    deck.contact
        .search_radius
        .map_or(chosen.max(least), Quantity::get)
}
