//! Contact surfaces of a scene: facets and laws of faces that meet, and pairs of bodies that touch.

use super::bodies::Bodies;
use super::joint::law_between;
use super::masonry;
use super::overlap;
use super::pairing::{Pairing, Patch, TOUCHES, pairings};
use super::quantity::Quantity;
use super::schema::{Deck, Interface};
use super::touch;
use crate::element::hexahedron::{area_vector, difference, dot, mean, norm};
use crate::error::{Errors, ModelError, Warning};
use crate::material::ElasticParameters;
use crate::model::scene::ContactSurfaces;
use crate::model::surfaces::JointSide;
use std::collections::HashSet;
use wythe_contact::{Aabb, Bvh, JointLaw};

/// Two bodies that touch at rest.
pub(super) struct Touching {
    pub(super) bodies: (u32, u32),
    pub(super) interface: String,
}

/// Contact surfaces of a scene.
pub(super) struct Meeting {
    pub(super) contact: ContactSurfaces,
    pub(super) touching: Vec<Touching>,
    pub(super) warnings: Vec<Warning>,
}

/// A facet of a master face, as a slave facet searches for it.
struct Facing<'a> {
    centre: [f64; 3],
    normal: [f64; 3],
    side: JointSide<'a>,
}

/// Builds facets and laws of all pairings.
///
/// `elastic`: constants of the materials by index.
///
/// # Errors
/// Those of [`pairings`], and faces that never face each other.
pub(super) fn meeting(
    deck: &Deck,
    bodies: &Bodies<'_>,
    elastic: &[ElasticParameters],
) -> Result<Meeting, ModelError> {
    let mut contact = ContactSurfaces::default();
    let mut touching = masonry::joints(deck, bodies, elastic, &mut contact)?;
    let pairings = pairings(deck, bodies)?;
    let mut warnings = Vec::new();
    let mut errors = Errors::default();
    let mesh = &bodies.mesh;
    let describe = |element: usize, facet: &[u32; 4]| {
        let x = facet.map(|n| mesh.nodes[n as usize]);
        let area = area_vector(&x);
        Facing {
            centre: mean(&x),
            normal: area,
            side: JointSide {
                material: &elastic[mesh.material[element] as usize],
                size: mesh.volume(element) / norm(area),
            },
        }
    };
    let mut stack = Vec::new();
    for pairing in &pairings {
        let Some(interface) = deck.interfaces.get(&pairing.interface) else {
            continue; // rejected when the deck was read
        };
        let body = bodies.all[pairing.slave.0].number;
        let facets = |patch: &Patch| bodies.all[patch.0].faces[patch.1].facets.iter();
        let masters: Vec<Facing<'_>> = pairing
            .masters
            .iter()
            .flat_map(facets)
            .map(|(element, facet)| describe(*element, facet))
            .collect();
        let centres: Vec<Aabb> = masters.iter().map(|m| Aabb::of([&m.centre])).collect();
        let tree = Bvh::build(&centres);
        for (element, facet) in facets(&pairing.slave) {
            let here = describe(*element, facet);
            let nearest = tree.nearest(&here.centre, &mut stack, |m| {
                let m = &masters[m as usize];
                if dot(m.normal, here.normal) < 0.0 {
                    norm(difference(m.centre, here.centre)).powi(2)
                } else {
                    f64::INFINITY
                }
            });
            let nearest = nearest.filter(|(_, square)| square.is_finite());
            let Some(facing) = nearest.map(|(m, _)| &masters[m as usize]) else {
                errors.push(deck.error(
                    &pairing.path,
                    format!(
                        "{}.{}: no master faces it",
                        bodies.all[pairing.slave.0].name,
                        bodies.all[pairing.slave.0].faces[pairing.slave.1].name
                    ),
                    "faces that meet look at each other: block.bottom on base.top",
                ));
                break;
            };
            let (a, b) = (here.side, facing.side);
            let law = law_between(&mut contact, &pairing.interface, interface, a, b);
            contact.slave_facets.push(*facet);
            contact.slave_body.push(body);
            contact.slave_law.push(law);
        }
        warnings.extend(overhang(deck, bodies, interface, pairing));
        let slave_area = mean_facet(bodies, pairing.slave);
        let coarser = pairing
            .masters
            .iter()
            .find(|m| mean_facet(bodies, **m) < 0.5 * slave_area);
        if let Some(master) = coarser.filter(|_| pairing.path != "arch") {
            warnings.push(deck.warning(
                &pairing.path,
                format!(
                    "the slave {} is coarser than its master {}: points are on the slave, which \
                     should be the finer side",
                    bodies.all[pairing.slave.0].name, bodies.all[master.0].name
                ),
            ));
        }
        warnings.extend(alone(deck, bodies, interface, pairing));
        for master in &pairing.masters {
            let Some(gap) = gap(bodies, pairing.slave, *master) else {
                continue;
            };
            let reach = reach(deck, interface, bodies, pairing.slave);
            if gap.abs() <= reach {
                touching.push(Touching {
                    bodies: (body, bodies.all[master.0].number),
                    interface: pairing.interface.clone(),
                });
            }
            if gap < -TOUCHES * slave_area.sqrt() && gap > -0.1 * slave_area.sqrt() {
                let (a, b) = (
                    &bodies.all[pairing.slave.0].name,
                    &bodies.all[master.0].name,
                );
                warnings.push(deck.warning(
                    &pairing.path,
                    format!("{a} and {b} interpenetrate by {:.4} mm at rest", -gap),
                ));
            }
        }
    }
    add_masters(bodies, &pairings, &mut contact);
    errors.end(Meeting {
        contact,
        touching,
        warnings,
    })
}

/// Warning about slave facets that reach over the edges of their masters. Points beyond an edge carry no force, and
/// the other points do not represent the position of the edge.
fn overhang(
    deck: &Deck,
    bodies: &Bodies<'_>,
    interface: &Interface,
    pairing: &Pairing,
) -> Option<Warning> {
    let block = &bodies.all[pairing.slave.0];
    let curved = |(b, _): &Patch| bodies.all[*b].curved;
    if pairing.masters.iter().any(curved) {
        return None; // a curved face separates from its neighbour before its edge
    }
    let reach = reach(deck, interface, bodies, pairing.slave);
    let outlines = pairing.masters.iter();
    let outlines: Vec<_> = outlines
        .flat_map(|(block, face)| &bodies.all[*block].faces[*face].outlines)
        .collect();
    let facets = &block.faces[pairing.slave.1].facets;
    let around: Vec<Aabb> = outlines
        .iter()
        .map(|o| touch::surroundings(o).fattened(reach))
        .collect();
    let tree = Bvh::build(&around);
    let (mut stack, mut near) = (Vec::new(), Vec::new());
    let mut over = |facet: &[u32; 4]| {
        let x = facet.map(|n| bodies.mesh.nodes[n as usize]);
        near.clear();
        tree.query(&around, &touch::surroundings(&x), &mut stack, |i| {
            near.push(i as usize);
        });
        let below = |o: &&[[f64; 3]; 4]| touch::distance(&x, o).is_some_and(|d| d.abs() <= reach);
        let below: Vec<_> = near.iter().map(|i| outlines[*i]).filter(below).collect();
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

/// Warning about a slave face that meets none of its masters at rest.
fn alone(
    deck: &Deck,
    bodies: &Bodies<'_>,
    interface: &Interface,
    pairing: &Pairing,
) -> Option<Warning> {
    let (slave, face) = pairing.slave;
    let flat = |(b, _): &Patch| !bodies.all[*b].curved;
    if !flat(&pairing.slave) || !pairing.masters.iter().all(flat) {
        return None; // curved facets touch at few places
    }
    let gaps = pairing
        .masters
        .iter()
        .filter_map(|m| gap(bodies, pairing.slave, *m));
    let nearest = gaps.map(f64::abs).min_by(f64::total_cmp);
    let reach = reach(deck, interface, bodies, pairing.slave);
    if nearest.is_some_and(|gap| gap <= reach) {
        return None;
    }
    let boxed = |b: usize| {
        let nodes = bodies.all[b].nodes.clone();
        overlap::around(nodes.map(|n| bodies.mesh.nodes[n as usize]))
    };
    let own = boxed(slave);
    if pairing
        .masters
        .iter()
        .any(|(b, _)| overlap::beside(&own, &boxed(*b), -reach))
    {
        return None; // an edge or a corner may touch
    }
    let body = &bodies.all[slave];
    let facets = body.faces[face].facets.iter().flat_map(|(_, facet)| *facet);
    let nodes: Vec<[f64; 3]> = facets.map(|n| bodies.mesh.nodes[n as usize]).collect();
    let [x, y, z] = [0, 1, 2].map(|d| nodes.iter().map(|x| x[d]).sum::<f64>() / nodes.len() as f64);
    let masters = pairing.masters.iter().map(|(b, f)| {
        let body = &bodies.all[*b];
        format!("{}.{}", body.name, body.faces[*f].name)
    });
    let masters: Vec<String> = masters.take(3).collect();
    let how = nearest.map_or_else(
        || "they lie beside each other".to_owned(),
        |gap| format!("{gap:.3} mm lie between"),
    );
    Some(deck.warning(
        &pairing.path,
        format!(
            "{}.{} near ({x:.1}, {y:.1}, {z:.1}) mm meets nothing at rest: not {} ({how})",
            body.name,
            body.faces[face].name,
            masters.join(", ")
        ),
    ))
}

/// Adds every master face once.
fn add_masters(bodies: &Bodies<'_>, pairings: &[Pairing], contact: &mut ContactSurfaces) {
    let mut masters: Vec<Patch> = pairings.iter().flat_map(|p| p.masters.clone()).collect();
    masters.sort_unstable();
    masters.dedup();
    // Master faces of wall joints were added before.
    let mut known: HashSet<[u32; 4]> = contact.master_facets.iter().copied().collect();
    for (body, face) in masters {
        let body = &bodies.all[body];
        for (_, facet) in &body.faces[face].facets {
            if known.insert(*facet) {
                contact.master_facets.push(*facet);
                contact.master_body.push(body.number);
            }
        }
    }
}

/// Mean area of the facets of a face [mm²].
fn mean_facet(bodies: &Bodies<'_>, (block, face): Patch) -> f64 {
    bodies.all[block].faces[face].mean_facet()
}

/// Above this number of pairs of parts only neighbouring parts of two faces are compared.
const MOST_PARTS: usize = 1_000_000;

/// Least distance between opposed faces [mm], see [`touch::distance`].
fn gap(bodies: &Bodies<'_>, a: Patch, b: Patch) -> Option<f64> {
    let outlines = |(body, face): Patch| &bodies.all[body].faces[face].outlines;
    let (a, b) = (outlines(a), outlines(b));
    if a.len().saturating_mul(b.len()) > MOST_PARTS {
        let around: Vec<Aabb> = b.iter().map(touch::surroundings).collect();
        let tree = Bvh::build(&around);
        let (mut stack, mut least) = (Vec::new(), None);
        for part in a {
            tree.query(&around, &touch::surroundings(part), &mut stack, |i| {
                let gap = touch::distance(part, &b[i as usize]);
                let nearer = |g: &f64| least.is_none_or(|l: f64| g.abs() < l.abs());
                least = gap.filter(nearer).or(least);
            });
        }
        return least;
    }
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
    let gaps = pairs.filter_map(|(a, b)| touch::distance(a, b));
    gaps.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// Largest gap at which two faces are in contact at rest [mm]: the search radius of the deck, else 0.06 of a facet,
/// at least 2 `u_k`.
fn reach(deck: &Deck, interface: &Interface, bodies: &Bodies<'_>, slave: Patch) -> f64 {
    let chosen = 0.06 * mean_facet(bodies, slave).sqrt();
    let least = 2.0 * interface.law(1.0, 1.0).ultimate_opening();
    deck.contact
        .search_radius
        .map_or(chosen.max(least), Quantity::get)
}
