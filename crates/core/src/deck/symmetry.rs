//! Planes of symmetry: the supports that they add, and the loads that they exclude.
//!
//! Displacements of the two sides are mirror images, so that displacements in the plane have no component normal to
//! it. Where a joint lies in the plane (walls, `masonry::symmetry`), its middle stays in the plane: a mirror, which
//! is a fixed facet, represents the other half, and the law of the joint opens by half as much
//! ([`InterfaceLaw::half`](wythe_contact::InterfaceLaw::half)).

use super::bodies::Bodies;
use super::masonry;
use super::overlap;
use super::schema::{Deck, DeckLoad, Keep};
use crate::element::hexahedron::norm;
use crate::error::{ErrorKind, Errors, ModelError};
use crate::model::axis::Axis;
use crate::model::loads::{Load, LoadOn};
use crate::model::scene::{Beam, BeamMotion, HeldBy, Spring, Step, Support};

/// A plane of symmetry.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    /// Axis normal to it.
    pub(super) axis: usize,
    /// Position along this axis [mm].
    pub(super) at: f64,
    /// Whether the side above it is modelled, else the side below.
    pub(super) above: bool,
    /// Path in the deck.
    pub(super) path: String,
}

/// Nodes within this distance lie in the plane [mm]: coordinates in decks are rounded to 0.01 mm.
const IN_PLANE: f64 = 0.01;

/// Fraction of gravity that may remain along a normal by rounding of its direction.
const ROUNDING: f64 = 1e-9;

/// A face lies in the plane if this component of its unit normal is at least this.
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

    /// Signed distance of a coordinate beyond the plane [mm]; negative on the modelled side.
    pub(super) fn beyond(&self, x: f64) -> f64 {
        if self.above { self.at - x } else { x - self.at }
    }

    /// Mirror image of a coordinate [mm].
    pub(super) fn image(&self, x: f64) -> f64 {
        2.0 * self.at - x
    }

    /// Description of an action along the normal.
    fn across(&self, what: &str) -> String {
        format!(
            "{what} along {}, across the plane of symmetry {}",
            Axis::NAMES[self.axis],
            self.called()
        )
    }

    /// Name of the plane, such as `x = 480.5 mm`.
    pub(super) fn called(&self) -> String {
        format!("{} = {} mm", Axis::NAMES[self.axis], self.at)
    }
}

/// Middle of the walls of a deck along an axis [mm]; none if there are none or if one is turned.
pub(super) fn middle(deck: &Deck, axis: usize) -> Option<f64> {
    let mut ends: Option<[f64; 2]> = None;
    for (_, _, wall) in deck.walls() {
        let (along, through) = wall.axes();
        let size = match axis {
            _ if wall.rotate.is_some() => return None,
            a if a == along => wall.length.get(),
            a if a == through => masonry::thickness(wall),
            _ => {
                let bed = wall.bed_joint.get();
                f64::from(wall.courses) * (wall.unit[2].get() + bed) - bed
            }
        };
        let low = wall.at[axis].get();
        let [first, last] = ends.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
        ends = Some([first.min(low), last.max(low + size)]);
    }
    ends.map(|[low, high]| 0.5 * (low + high))
}

/// Number of copies of the modelled part in the whole scene.
pub(super) fn multiplicity(deck: &Deck) -> u32 {
    1 << deck.symmetry.len()
}

/// Supports of the planes: nodes of all bodies in the plane, except those of joints that are cut at their middle;
/// and the mirrors of these joints.
///
/// # Errors
/// Bodies that reach beyond a plane, planes in which no body lies.
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
                let (who, plane_name) = (bodies.called(b), plane.called());
                let message = format!(
                    "{who} reaches {farthest:.3} mm beyond the plane of symmetry {plane_name}"
                );
                let help = "walls are cut at the plane; of blocks, arches and imported meshes model what lies on the \
                            side that is kept, up to the plane";
                let error = deck.error(&format!("{}.at", plane.path), message, help);
                errors.push(error.of_kind(ErrorKind::Geometry));
                continue;
            }
            if bodies.mirrors_at(b, d) {
                mirrors = true;
                continue;
            }
            held.extend(body.nodes.clone().filter(|n| beyond(*n) > -IN_PLANE));
        }
        if held.is_empty() && !mirrors {
            let message = format!("nothing lies in the plane of symmetry {}", plane.called());
            let help = "let a body end there, or a wall go through it";
            let error = deck.error(&format!("{}.at", plane.path), message, help);
            errors.push(error.of_kind(ErrorKind::Geometry));
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

/// Advice about actions that a plane excludes.
const HELP: &str =
    "what acts across a plane acts the other way on the other side of it: model the whole scene";

/// Rejects steps that are not mirror images of themselves. Faces that move as one and lie in a plane are locked in
/// it.
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
                errors.push(
                    deck.error(&format!("steps.{i}"), across("gravity pulls"), HELP)
                        .of_kind(ErrorKind::Geometry),
                );
            }
            if !step.ground.acceleration[d].is_empty() {
                let path = format!("steps.{i}.ground.{axis}");
                errors.push(
                    deck.error(&path, across("the ground moves"), HELP)
                        .of_kind(ErrorKind::Geometry),
                );
            }
            for (beam, motion) in beams.iter().zip(&mut step.motion) {
                if !lies_in(beam) {
                    continue;
                }
                match motion[d] {
                    BeamMotion::Driven(_) => {
                        let message = across(&format!("{} is driven", beam.name));
                        errors.push(
                            deck.error(&format!("steps.{i}.direction"), message, HELP)
                                .of_kind(ErrorKind::Geometry),
                        );
                    }
                    // The force on the other side is opposite.
                    BeamMotion::Force(_) => motion[d] = BeamMotion::Locked,
                    BeamMotion::Locked => {}
                }
            }
        }
    }
    errors.end(())
}

/// Springs and loads of a scene, and the steps in which they act.
pub(super) struct Actions<'a> {
    pub(super) springs: &'a [Spring],
    pub(super) loads: &'a [Load],
    pub(super) steps: &'a [Step],
}

/// Rejects springs, velocities and loads across a plane on nodes that it holds. `held`: supports of the planes.
///
/// # Errors
/// Driven springs, velocities and loads across a plane.
pub(super) fn judge_held(
    deck: &Deck,
    bodies: &Bodies<'_>,
    held: &[Support],
    actions: &Actions<'_>,
) -> Result<(), ModelError> {
    let mut errors = Errors::default();
    for (plane, held) in Plane::all(deck).iter().zip(held) {
        let mut is_held = vec![false; bodies.mesh.nodes.len()];
        for n in &held.nodes {
            is_held[*n as usize] = true;
        }
        let is_held = |n: u32| is_held[n as usize];
        let d = plane.axis;
        for (s, step) in actions.steps.iter().enumerate() {
            for (spring, end) in actions.springs.iter().zip(&step.springs) {
                if end[d] != 0.0 && spring.nodes.iter().any(|n| is_held(*n)) {
                    let message = plane.across(&format!("the spring {} is driven", spring.name));
                    errors.push(
                        deck.error(&format!("steps.{s}.direction"), message, HELP)
                            .of_kind(ErrorKind::Geometry),
                    );
                }
            }
            for (l, said) in deck.steps[s].loads.iter().enumerate() {
                let load = actions.loads.iter().find(|load| load.name == said.name);
                if load.is_some_and(|load| acts_across(d, said, load, &is_held)) {
                    let message = plane.across(&format!(
                        "the load {} acts on nodes that are held",
                        said.name
                    ));
                    errors.push(
                        deck.error(&format!("steps.{s}.loads.{l}"), message, HELP)
                            .of_kind(ErrorKind::Geometry),
                    );
                }
            }
        }
        for (b, body) in bodies.all.iter().enumerate() {
            let mut moving = body.nodes.clone().filter(|n| is_held(*n));
            let velocity = |n: u32| bodies.velocity.get(n as usize);
            if moving.any(|n| velocity(n).is_some_and(|v| v[d] != 0.0)) {
                let path = format!("{}.velocity", overlap::table_of(deck, bodies, b));
                let message = plane.across(&format!("{} moves", bodies.called(b)));
                errors.push(
                    deck.error(&path, message, HELP)
                        .of_kind(ErrorKind::Geometry),
                );
            }
        }
    }
    errors.end(())
}

/// Returns whether a load acts along axis `d` on nodes that are held in this direction.
///
/// Tractions and pressures on faces that only end at the plane are correct: they have a mirror image, and the two
/// forces at the plane cancel.
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
            // The part of a total force on held nodes is lost. Other loads are wrong only if all their nodes are
            // held.
            value[d] != 0.0
                && if said.force.is_some() {
                    held.any(|held| held)
                } else {
                    held.all(|held| held)
                }
        }
    }
}
