//! Planes of symmetry: what they hold, and what a scene must not do across them.
//!
//! Displacements of the two sides are mirror images, so that those in the plane have no component normal to it.
//! Where a joint lies in the plane (walls, `masonry::symmetry`), its middle takes part in this: a mirror, a facet
//! that is held, stands there for the other half, and the joint's law opens by half as much ([`mirrored`]).

use super::bodies::Bodies;
use super::deck::{Axis, Deck, DeckLoad, Keep};
use super::hexahedron::norm;
use super::loads::{Load, LoadOn};
use super::overlap;
use super::scene::{Beam, BeamMotion, HeldBy, Spring, Step, Support};
use crate::error::{Errors, ModelError};

/// A plane of symmetry.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    /// Axis normal to it.
    pub(super) axis: usize,
    /// Where it lies [mm].
    pub(super) at: f64,
    /// Whether what lies above it is modelled, else what lies below.
    pub(super) above: bool,
    /// Where the deck says so.
    pub(super) path: String,
}

/// Nodes no farther from the plane lie in it [mm]: decks round to 0.01 mm.
const IN_PLANE: f64 = 0.01;

/// Part of gravity that rounding of its direction may leave along a normal.
const ROUNDING: f64 = 1e-9;

/// Component of a unit normal from which a face lies in the plane.
const ALONG: f64 = 1.0 - 1e-6;

impl Plane {
    /// The planes of a deck.
    pub(super) fn all(deck: &Deck) -> Vec<Self> {
        let planes = deck.symmetry.iter().enumerate();
        planes
            .map(|(i, plane)| Self {
                axis: plane.normal.index(),
                at: plane.at.get(),
                above: plane.keep == Keep::Above,
                path: format!("symmetry.{i}"),
            })
            .collect()
    }

    /// How far a coordinate lies beyond the plane, below 0 on the side that is modelled [mm].
    pub(super) fn beyond(&self, x: f64) -> f64 {
        if self.above { self.at - x } else { x - self.at }
    }

    /// Mirror image of a coordinate [mm].
    pub(super) fn image(&self, x: f64) -> f64 {
        2.0 * self.at - x
    }

    /// What goes along the normal.
    fn across(&self, what: &str) -> String {
        format!(
            "{what} along {}, across the plane of symmetry {}",
            Axis::NAMES[self.axis],
            self.called()
        )
    }

    /// As in `x = 480.5 mm`.
    pub(super) fn called(&self) -> String {
        format!("{} = {} mm", Axis::NAMES[self.axis], self.at)
    }
}

/// How many times the modelled part makes up the whole.
pub(super) fn multiplicity(deck: &Deck) -> u32 {
    1 << deck.symmetry.len()
}

/// What the planes hold: nodes of all bodies that lie in them, but for those of joints that are cut at their
/// middle; and the mirrors of these.
///
/// # Errors
/// Bodies that reach beyond a plane, planes in which nothing lies.
pub(super) fn supports(deck: &Deck, bodies: &Bodies<'_>) -> Result<Vec<Support>, ModelError> {
    let mut supports = Vec::new();
    let mut errors = Errors::default();
    for plane in Plane::all(deck) {
        let d = plane.axis;
        let mut held = Vec::new();
        let mut mirrors = false;
        for (b, body) in bodies.all.iter().enumerate() {
            let beyond = |n: u32| plane.beyond(bodies.mesh.nodes[n as usize][d]);
            let farthest = body
                .nodes
                .clone()
                .map(beyond)
                .fold(f64::NEG_INFINITY, f64::max);
            if farthest > IN_PLANE {
                errors.push(deck.error(
                    &format!("{}.at", plane.path),
                    format!(
                        "{} reaches {farthest:.3} mm beyond the plane of symmetry {}",
                        bodies.called(b),
                        plane.called()
                    ),
                    "walls are cut at the plane; of blocks, arches and imported meshes model what lies on the side \
                     that is kept, up to the plane",
                ));
                continue;
            }
            if bodies.mirrors_at(b, d) {
                mirrors = true;
                continue;
            }
            held.extend(body.nodes.clone().filter(|n| beyond(*n) > -IN_PLANE));
        }
        if held.is_empty() && !mirrors {
            errors.push(deck.error(
                &format!("{}.at", plane.path),
                format!("nothing lies in the plane of symmetry {}", plane.called()),
                "let a body end there, or a wall go through it",
            ));
        }
        let mut fixed = [false; 3];
        fixed[d] = true;
        supports.push(Support {
            name: format!("symmetry-{}", Axis::NAMES[d]),
            nodes: held,
            fixed,
            by: HeldBy::Plane {
                axis: d,
                at: plane.at,
            },
        });
    }
    for mirror in &bodies.mirrors {
        supports.push(Support {
            name: format!("mirror-{}", Axis::NAMES[mirror.axis]),
            nodes: mirror.facet.into(),
            fixed: [true; 3],
            by: HeldBy::Mirror,
        });
    }
    errors.end(supports)
}

/// What to do about that which a plane forbids.
const HELP: &str =
    "what acts across a plane acts the other way on the other side of it: model the whole scene";

/// Refuses what is no mirror image of itself; faces that move as one and lie in a plane stay in it.
///
/// # Errors
/// Gravity, motion of the ground or a drive across a plane.
pub(super) fn judge(
    deck: &Deck,
    bodies: &Bodies<'_>,
    beams: &[Beam],
    steps: &mut [Step],
) -> Result<(), ModelError> {
    let mut errors = Errors::default();
    let mesh = &bodies.mesh;
    for plane in Plane::all(deck) {
        let d = plane.axis;
        let across = |what: &str| plane.across(what);
        let axis = Axis::NAMES[d];
        let lies_in = |beam: &Beam| {
            let mut nodes = beam.nodes.iter();
            nodes.any(|n| plane.beyond(mesh.nodes[*n as usize][d]) > -IN_PLANE)
        };
        for (i, step) in steps.iter_mut().enumerate() {
            let pulls = |part: f64| {
                let g = step.gravity.at(part);
                g[d].abs() > ROUNDING * norm(g)
            };
            if pulls(0.5) || pulls(1.0) {
                errors.push(deck.error(&format!("steps.{i}"), across("gravity pulls"), HELP));
            }
            if !step.ground.acceleration[d].is_empty() {
                let path = format!("steps.{i}.ground.{axis}");
                errors.push(deck.error(&path, across("the ground moves"), HELP));
            }
            for (beam, motion) in beams.iter().zip(&mut step.motion) {
                if !lies_in(beam) {
                    continue;
                }
                match motion[d] {
                    BeamMotion::Driven(_) => {
                        let message = across(&format!("{} is driven", beam.name));
                        errors.push(deck.error(&format!("steps.{i}.direction"), message, HELP));
                    }
                    // The other side pulls it the other way.
                    BeamMotion::Force(_) => motion[d] = BeamMotion::Locked,
                    BeamMotion::Locked => {}
                }
            }
        }
    }
    errors.end(())
}

/// Refuses springs, velocities and loads across a plane in which it holds their nodes: `held`, by plane.
///
/// # Errors
/// Springs driven across a plane, velocities and loads across it.
pub(super) fn judge_held(
    deck: &Deck,
    bodies: &Bodies<'_>,
    held: &[Support],
    springs: &[Spring],
    loads: &[Load],
    steps: &[Step],
) -> Result<(), ModelError> {
    let mut errors = Errors::default();
    for (plane, held) in Plane::all(deck).iter().zip(held) {
        let mut is_held = vec![false; bodies.mesh.nodes.len()];
        for n in &held.nodes {
            is_held[*n as usize] = true;
        }
        let is_held = |n: u32| is_held[n as usize];
        let d = plane.axis;
        for (s, step) in steps.iter().enumerate() {
            for (spring, end) in springs.iter().zip(&step.springs) {
                if end[d] != 0.0 && spring.nodes.iter().any(|n| is_held(*n)) {
                    let message = plane.across(&format!("the spring {} is driven", spring.name));
                    errors.push(deck.error(&format!("steps.{s}.direction"), message, HELP));
                }
            }
            for (l, said) in deck.steps[s].loads.iter().enumerate() {
                let load = loads.iter().find(|load| load.name == said.name);
                if load.is_some_and(|load| acts_across(d, said, load, &is_held)) {
                    let message = plane.across(&format!(
                        "the load {} acts on nodes that are held",
                        said.name
                    ));
                    errors.push(deck.error(&format!("steps.{s}.loads.{l}"), message, HELP));
                }
            }
        }
        for (b, body) in bodies.all.iter().enumerate() {
            let mut moving = body.nodes.clone().filter(|n| is_held(*n));
            let velocity = |n: u32| bodies.velocity.get(n as usize);
            if moving.any(|n| velocity(n).is_some_and(|v| v[d] != 0.0)) {
                let path = format!("{}.velocity", overlap::table_of(deck, bodies, b));
                let message = plane.across(&format!("{} moves", bodies.called(b)));
                errors.push(deck.error(&path, message, HELP));
            }
        }
    }
    errors.end(())
}

/// Whether a load acts along axis `d` on nodes that are held there. Tractions and pressures on faces that only end at
/// the plane have their mirror image, and forces of the two at the plane cancel: they are right.
fn acts_across(d: usize, said: &DeckLoad, load: &Load, is_held: &impl Fn(u32) -> bool) -> bool {
    let value = said.value().map_or([0.0; 3], |(_, value)| value);
    match &load.acts {
        LoadOn::Follower(facets) => {
            let in_plane = |facet: &[u32; 4]| facet.iter().all(|n| is_held(*n));
            value[0] != 0.0 && facets.iter().any(in_plane)
        }
        LoadOn::Pressure(areas) => {
            let in_plane =
                |(n, area): &(u32, [f64; 3])| is_held(*n) && area[d].abs() > ALONG * norm(*area);
            value[0] != 0.0 && areas.iter().any(in_plane)
        }
        LoadOn::Shares(shares) => {
            let mut held = shares.iter().map(|(n, _)| is_held(*n));
            // Of a force in all, what acts on these nodes is missing; else it is a matter of the others, too.
            value[d] != 0.0
                && if said.force.is_some() {
                    held.any(|held| held)
                } else {
                    held.all(|held| held)
                }
        }
    }
}
