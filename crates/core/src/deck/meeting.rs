//! Contact surfaces of a scene: facets and laws of faces that meet, and pairs of bodies that touch.

use super::bodies::Bodies;
use super::body::{Body, BodyFace};
use super::joint::law_between;
use super::masonry;
use super::overlap;
use super::pairing::{Pairing, Patch, TOUCHES, pairings};
use super::quantity::Quantity;
use super::schema::{Deck, Interface};
use super::touch;
use crate::element::hexahedron::{area_vector, difference, dot, mean, norm};
use crate::error::{ErrorKind, Errors, ModelError, Warning};
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
    let mut touching = masonry::joints(deck, bodies, elastic, &mut contact);
    let pairings = pairings(deck, bodies)?;
    let mut warnings = Vec::new();
    let mut errors = Errors::default();
    for pairing in &pairings {
        let Some(interface) = deck.interfaces.get(&pairing.interface) else {
            continue; // rejected when the deck was read
        };
        let pair = Pair {
            deck,
            bodies,
            interface,
            pairing,
        };
        errors.keep(pair.add_slaves(elastic, &mut contact));
        warnings.extend(pair.overhang());
        warnings.extend(pair.coarser());
        let gaps = pair.gaps();
        warnings.extend(pair.alone(&gaps));
        pair.touching(&gaps, &mut touching, &mut warnings);
    }
    add_masters(bodies, &pairings, &mut contact);
    errors.end(Meeting {
        contact,
        touching,
        warnings,
    })
}

/// A slave face and its masters.
#[derive(Clone, Copy)]
struct Pair<'a> {
    deck: &'a Deck,
    bodies: &'a Bodies<'a>,
    interface: &'a Interface,
    pairing: &'a Pairing,
}

impl<'a> Pair<'a> {
    fn body(&self, (body, _): Patch) -> &'a Body {
        &self.bodies.all[body]
    }

    fn face(&self, (body, face): Patch) -> &'a BodyFace {
        &self.bodies.all[body].faces[face]
    }

    /// Name of a face in messages.
    fn called(&self, patch: Patch) -> String {
        format!("{}.{}", self.body(patch).name, self.face(patch).name)
    }

    /// Adds facets and laws of the slave face: between each facet and the nearest one of the masters that faces it.
    ///
    /// # Errors
    /// No master faces a facet.
    fn add_slaves(
        &self,
        elastic: &[ElasticParameters],
        contact: &mut ContactSurfaces,
    ) -> Result<(), ModelError> {
        let Pairing { slave, masters, .. } = self.pairing;
        let mesh = &self.bodies.mesh;
        let describe = |(element, facet): &(usize, [u32; 4])| {
            let x = facet.map(|n| mesh.nodes[n as usize]);
            let area = area_vector(&x);
            Facing {
                centre: mean(&x),
                normal: area,
                side: JointSide {
                    material: &elastic[mesh.material[*element] as usize],
                    size: mesh.volume(*element) / norm(area),
                },
            }
        };
        let masters = masters.iter().flat_map(|m| &self.face(*m).facets);
        let masters: Vec<Facing<'_>> = masters.map(describe).collect();
        let centres: Vec<Aabb> = masters.iter().map(|m| Aabb::of([&m.centre])).collect();
        let tree = Bvh::build(&centres);
        let mut stack = Vec::new();
        for facet in &self.face(*slave).facets {
            let here = describe(facet);
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
                return Err(self
                    .deck
                    .error(
                        &self.pairing.path,
                        format!("{}: no master faces it", self.called(*slave)),
                        "faces that meet look at each other: block.bottom on base.top",
                    )
                    .of_kind(ErrorKind::Geometry));
            };
            let (a, b) = (here.side, facing.side);
            let law = law_between(contact, &self.pairing.interface, self.interface, a, b);
            contact.add_slave(facet.1, self.body(*slave).number, law);
        }
        Ok(())
    }

    /// Warning about a slave face that is coarser than one of its masters.
    fn coarser(&self) -> Option<Warning> {
        let Pairing {
            slave,
            masters,
            path,
            ..
        } = self.pairing;
        let half = 0.5 * self.face(*slave).mean_facet();
        let is_finer = |m: &&Patch| path != "arch" && self.face(**m).mean_facet() < half;
        let master = masters.iter().find(is_finer)?;
        let (slave, master) = (&self.body(*slave).name, &self.body(*master).name);
        Some(self.deck.warning(
            path,
            format!(
                "the slave {slave} is coarser than its master {master}: points are on the slave, which \
                 should be the finer side"
            ),
        ))
    }

    /// Adds the masters that the slave face touches at rest, and warnings about those that it penetrates.
    fn touching(
        &self,
        gaps: &[Option<f64>],
        touching: &mut Vec<Touching>,
        warnings: &mut Vec<Warning>,
    ) {
        let slave = self.pairing.slave;
        let size = self.face(slave).mean_facet().sqrt();
        for (master, gap) in self.pairing.masters.iter().zip(gaps) {
            let Some(gap) = *gap else {
                continue;
            };
            let (a, b) = (self.body(slave), self.body(*master));
            if gap.abs() <= self.reach() {
                touching.push(Touching {
                    bodies: (a.number, b.number),
                    interface: self.pairing.interface.clone(),
                });
            }
            if gap < -TOUCHES * size && gap > -0.1 * size {
                let (a, b) = (&a.name, &b.name);
                warnings.push(self.deck.warning(
                    &self.pairing.path,
                    format!("{a} and {b} interpenetrate by {:.4} mm at rest", -gap),
                ));
            }
            if gap > TOUCHES * size && gap <= self.reach() && !self.interface.is_dry() {
                let (a, b) = (&a.name, &b.name);
                warnings.push(self.deck.warning(
                    &self.pairing.path,
                    format!(
                        "{a} and {b} are {gap:.4} mm apart at rest: their bond begins with this opening, or is lost"
                    ),
                ));
            }
        }
    }

    /// Warning about slave facets that reach over the edges of their masters. Points beyond an edge carry no force,
    /// and the other points do not represent the position of the edge.
    fn overhang(&self) -> Option<Warning> {
        let Pairing {
            slave,
            masters,
            path,
            ..
        } = self.pairing;
        if masters.iter().any(|m| self.body(*m).curved) {
            return None; // a curved face separates from its neighbour before its edge
        }
        let reach = self.reach();
        let outlines = masters.iter().flat_map(|m| &self.face(*m).outlines);
        let outlines: Vec<_> = outlines.collect();
        let around: Vec<Aabb> = outlines
            .iter()
            .map(|o| touch::surroundings(o).fattened(reach))
            .collect();
        let tree = Bvh::build(&around);
        let (mut stack, mut near) = (Vec::new(), Vec::new());
        let mut over = |facet: &[u32; 4]| {
            let x = facet.map(|n| self.bodies.mesh.nodes[n as usize]);
            near.clear();
            tree.query(&around, &touch::surroundings(&x), &mut stack, |i| {
                near.push(i as usize);
            });
            let below =
                |o: &&[[f64; 3]; 4]| touch::distance(&x, o).is_some_and(|d| d.abs() <= reach);
            let below: Vec<_> = near.iter().map(|i| outlines[*i]).filter(below).collect();
            let covered = |corner: &[f64; 3]| below.iter().any(|o| touch::covers(o, *corner));
            !below.is_empty() && !x.iter().all(covered)
        };
        let facets = self.face(*slave).facets.iter();
        let count = facets.filter(|(_, facet)| over(facet)).count();
        (count > 0).then(|| {
            self.deck.warning(
                path,
                format!(
                    "{count} facets of {} reach over the edge of what they rest on: points beyond it carry \
                     nothing (let a line of the mesh follow the edge, or make the smaller face the slave)",
                    self.body(*slave).name
                ),
            )
        })
    }

    /// Warning about a slave face that meets none of its masters at rest.
    fn alone(&self, gaps: &[Option<f64>]) -> Option<Warning> {
        let Pairing {
            slave,
            masters,
            path,
            ..
        } = self.pairing;
        if masters.iter().chain([slave]).any(|m| self.body(*m).curved) {
            return None; // curved facets touch at few places
        }
        let gaps = gaps.iter().flatten();
        let nearest = gaps.copied().map(f64::abs).min_by(f64::total_cmp);
        let reach = self.reach();
        if nearest.is_some_and(|gap| gap <= reach) {
            return None;
        }
        let place = |n: u32| self.bodies.mesh.nodes[n as usize];
        let boxed = |patch: &Patch| overlap::around(self.body(*patch).nodes.clone().map(place));
        let own = boxed(slave);
        if masters
            .iter()
            .any(|m| overlap::beside(&own, &boxed(m), -reach))
        {
            return None; // an edge or a corner may touch
        }
        let facets = self.face(*slave).facets.iter();
        let nodes: Vec<[f64; 3]> = facets.flat_map(|(_, facet)| facet.map(place)).collect();
        let [x, y, z] =
            [0, 1, 2].map(|d| nodes.iter().map(|x| x[d]).sum::<f64>() / nodes.len() as f64);
        let called: Vec<String> = masters.iter().take(3).map(|m| self.called(*m)).collect();
        let how = nearest.map_or_else(
            || "they lie beside each other".to_owned(),
            |gap| format!("{gap:.3} mm lie between"),
        );
        Some(self.deck.warning(
            path,
            format!(
                "{} near ({x:.1}, {y:.1}, {z:.1}) mm meets nothing at rest: not {} ({how})",
                self.called(*slave),
                called.join(", ")
            ),
        ))
    }

    /// Least distance between the slave face and each master [mm], see [`touch::distance`]. Of many parts only those
    /// near each other are compared. `[master]`
    fn gaps(&self) -> Vec<Option<f64>> {
        let own = &self.face(self.pairing.slave).outlines;
        let masters = self.pairing.masters.iter();
        let masters = masters.map(|master| &self.face(*master).outlines);
        let parts: usize = masters.clone().map(Vec::len).sum();
        let nearest = |gaps: &mut dyn Iterator<Item = f64>| {
            gaps.min_by(|a: &f64, b: &f64| a.abs().total_cmp(&b.abs()))
        };
        if own.len().saturating_mul(parts) <= MOST_PARTS {
            let gap = |other: &Vec<[[f64; 3]; 4]>| {
                let pairs = own.iter().flat_map(|a| other.iter().map(move |b| (a, b)));
                nearest(&mut pairs.filter_map(|(a, b)| touch::distance(a, b)))
            };
            return masters.map(gap).collect();
        }
        let reach = self.reach();
        let around: Vec<Aabb> = own.iter().map(touch::surroundings).collect();
        let tree = Bvh::build(&around);
        let mut stack = Vec::new();
        let gap = |other: &Vec<[[f64; 3]; 4]>| {
            let mut gaps = Vec::new();
            for part in other {
                let about = touch::surroundings(part).fattened(reach);
                tree.query(&around, &about, &mut stack, |i| {
                    gaps.extend(touch::distance(&own[i as usize], part));
                });
            }
            nearest(&mut gaps.into_iter())
        };
        masters.map(gap).collect()
    }

    /// Largest gap at which the faces are in contact at rest [mm]: the search radius of the deck, else 0.06 of a
    /// facet, at least 2 `u_k`.
    fn reach(&self) -> f64 {
        let chosen = 0.06 * self.face(self.pairing.slave).mean_facet().sqrt();
        let least = 2.0 * self.interface.law(1.0, 1.0).ultimate_opening();
        let of_deck = self.deck.contact.search_radius;
        of_deck.map_or(chosen.max(least), Quantity::get)
    }
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
                contact.add_master(*facet, body.number);
            }
        }
    }
}

/// Above this number of pairs of parts only neighbouring parts of two faces are compared.
const MOST_PARTS: usize = 1_000_000;
