//! Checks that every body is held. A body without support makes the equations singular.

use super::bodies::Bodies;
use super::meeting::Touching;
use super::overlap;
use super::schema::{Deck, DeckProcedure, DeckStep, Heading, StepKind};
use crate::error::{ErrorKind, ModelError, Warning};
use crate::model::scene::{Beam, BeamMotion, Spring, Step, Support};

/// Rejects a floating body: no chain of contacts joins it to the ground when a step seeks its equilibrium.
///
/// A dry contact holds a body if it has friction and is pressed. With general contact a body may rest on any
/// neighbour; a floating body is then a warning if the procedure has inertia.
pub(super) fn require_held(
    deck: &Deck,
    bodies: &Bodies<'_>,
    held_nodes: &[u32],
    touching: &[Touching],
) -> Result<Option<Warning>, ModelError> {
    let Some(at_rest) = deck.steps.iter().position(|s| s.kind != StepKind::Free) else {
        return Ok(None); // all bodies move freely
    };
    let step = &deck.steps[at_rest];
    // Bodies that moved freely in an earlier step may have come to rest.
    let pressed = presses(deck, step) || at_rest > 0;
    let mut held = vec![false; bodies.all.len()];
    let body_of = body_of(bodies);
    for n in held_nodes {
        held[body_of[*n as usize]] = true;
    }
    let joins = |t: &&Touching| {
        deck.interfaces
            .get(&t.interface)
            .is_some_and(|f| !f.is_dry() || (pressed && f.residual_friction() > 0.0))
    };
    let joints = touching.iter().filter(joins).map(|t| t.bodies);
    let boxes = overlap::boxes(bodies);
    let near = neighbours(deck, bodies, &boxes)?;
    let unheld = unheld_bodies(&held, joints.chain(near));
    let Some(&body) = unheld.first() else {
        return Ok(None);
    };
    let [x, y, z] = boxes[body].map(|[low, high]| 0.5 * (low + high));
    let kind = if body < bodies.walls.last().map_or(0, |wall| wall.bodies.end) {
        "units"
    } else {
        "blocks"
    };
    let who = format!(
        "{} is held by nothing, near ({x:.1}, {y:.1}, {z:.1}) mm ({} {kind} are)",
        bodies.called(body),
        unheld.len()
    );
    let path = format!("steps.{at_rest}");
    if deck.contact.general.is_some() {
        return falls(deck, step, &path, &who).map(Some);
    }
    let touches = |t: &&Touching| [t.bodies.0, t.bodies.1].contains(&(body as u32));
    Err(loose(deck, &path, &who, touching.iter().find(touches)))
}

/// Body of each node. `[node]`
fn body_of(bodies: &Bodies<'_>) -> Vec<usize> {
    let mut body_of = vec![0; bodies.mesh.nodes.len()];
    for (nodes, unit) in bodies.mesh.elements.iter().zip(&bodies.mesh.unit) {
        for n in nodes {
            body_of[*n as usize] = *unit as usize;
        }
    }
    body_of
}

/// Pairs of bodies beside each other: with general contact a body may rest on any neighbour.
fn neighbours(
    deck: &Deck,
    bodies: &Bodies<'_>,
    boxes: &[[[f64; 2]; 3]],
) -> Result<Vec<(u32, u32)>, ModelError> {
    if deck.contact.general.is_none() {
        return Ok(Vec::new());
    }
    let near = overlap::near(boxes, -BESIDE).map_err(|crowded| crowded.error(deck, bodies))?;
    Ok(near
        .into_iter()
        .map(|(a, b)| (a as u32, b as u32))
        .collect())
}

/// Supports, springs, beams and steps of a scene.
#[derive(Clone, Copy)]
pub(super) struct Holding<'a> {
    pub(super) supports: &'a [Support],
    pub(super) springs: &'a [Spring],
    pub(super) beams: &'a [Beam],
    pub(super) steps: &'a [Step],
}

impl Holding<'_> {
    /// Nodes that are held in a direction during a step.
    fn nodes(&self, step: usize, axis: usize) -> impl Iterator<Item = u32> {
        let supports = self.supports.iter().filter(move |s| s.fixed[axis]);
        let springs = self
            .springs
            .iter()
            .filter(move |s| s.stiffness[axis] != 0.0);
        let motion = &self.steps[step].motion;
        let beams = self.beams.iter().zip(motion);
        let beams = beams.filter(move |(_, by)| !matches!(by[axis], BeamMotion::Force(_)));
        let of_supports = supports.flat_map(|s| &s.nodes);
        let of_springs = springs.flat_map(|s| &s.nodes);
        let of_beams = beams.flat_map(|(beam, _)| &beam.nodes);
        of_supports.chain(of_springs).chain(of_beams).copied()
    }
}

/// Rejects a step that presses or drives bodies which are not held in a direction: they can move that way as one,
/// and equilibrium is not unique.
///
/// Steps with inertia, and steps under displacement control, are not checked.
///
/// # Errors
/// The first such step, with the body and the direction.
pub(super) fn require_held_each_way(
    deck: &Deck,
    bodies: &Bodies<'_>,
    touching: &[Touching],
    holding: Holding<'_>,
) -> Result<(), ModelError> {
    let all_has_mass = deck.materials.values().all(|m| m.density.get() > 0.0);
    let asked = |step: &DeckStep| {
        let moves = [DeckProcedure::QuasiStatic, DeckProcedure::Dynamic];
        matches!(step.kind, StepKind::Preload | StepKind::Drive)
            && !moves.contains(&step.procedure)
            && step.control.is_none()
            // With mass in all materials, `auto` changes to inertia.
            && !(step.procedure == DeckProcedure::Auto && all_has_mass)
    };
    let body_of = body_of(bodies);
    let boxes = overlap::boxes(bodies);
    let near = neighbours(deck, bodies, &boxes)?;
    let count = deck.steps.len().min(holding.steps.len());
    for (i, step) in deck.steps[..count].iter().enumerate() {
        if !asked(step) {
            continue;
        }
        for axis in 0..3 {
            let mut held = vec![false; bodies.all.len()];
            for n in holding.nodes(i, axis) {
                held[body_of[n as usize]] = true;
            }
            let joints = touching.iter().map(|t| t.bodies);
            let unheld = unheld_bodies(&held, joints.chain(near.iter().copied()));
            let Some(&body) = unheld.first() else {
                continue;
            };
            let others = match unheld.len() - 1 {
                0 => String::new(),
                1 => " and one other body".to_owned(),
                n => format!(" and {n} other bodies"),
            };
            let direction = ["x", "y", "z"][axis];
            return Err(deck.error(
                &format!("steps.{i}"),
                format!(
                    "nothing holds {}{others} in {direction} in step {i} ({}): all of it moves that way as one",
                    bodies.called(body),
                    step.name()
                ),
                "hold it by [[supports]] on a face that the step does not move, or by [[springs]]; give bodies that may fly \
                 procedure = \"dynamic\"",
            ).of_kind(ErrorKind::Unheld));
        }
    }
    Ok(())
}

/// Warning about a floating body in a scene with general contact.
///
/// # Errors
/// A step whose procedure has no inertia.
fn falls(deck: &Deck, step: &DeckStep, path: &str, who: &str) -> Result<Warning, ModelError> {
    let inertia = [
        DeckProcedure::Auto,
        DeckProcedure::QuasiStatic,
        DeckProcedure::Dynamic,
    ];
    if inertia.contains(&step.procedure) {
        let message = format!("{who} and lies on nothing: it falls under inertia");
        return Ok(deck.warning(path, message));
    }
    Err(deck.error(
        path,
        format!("{who} and lies on nothing, so this step has no equilibrium"),
        "let it lie on something, hold it by [[supports]], or give it inertia: procedure = \"dynamic\"",
    ).of_kind(ErrorKind::Unheld))
}

/// Error about a body that is not held. `touches`: a contact of the body, if it has one.
fn loose(deck: &Deck, path: &str, who: &str, touches: Option<&Touching>) -> ModelError {
    let Some(touches) = touches else {
        return deck
            .error(
                path,
                format!("{who}: it touches no other block and has no support"),
                "add [[contacts]] to what it rests on, [[supports]], or begin with kind = \"free\"",
            )
            .of_kind(ErrorKind::Unheld);
    };
    let interface = deck.interfaces.get(&touches.interface);
    if interface.is_some_and(|f| f.residual_friction() == 0.0) {
        return deck
            .error(
                &format!("interfaces.{}", touches.interface),
                format!("{who}: the joint has neither bond nor friction"),
                "give mu above 0, or f_t and c; or support the block along the joint",
            )
            .of_kind(ErrorKind::Unheld);
    }
    deck.error(
        path,
        format!("{who}: the joints are dry and no load presses them together"),
        if deck.clamped().is_some() {
            "begin with a preload: kind = \"preload\", top_pressure = \"0.3 MPa\""
        } else {
            "begin with kind = \"gravity\", or with a preload"
        },
    )
    .of_kind(ErrorKind::Unheld)
}

/// Bodies whose boxes are no farther apart than this may rest on each other [mm].
const BESIDE: f64 = 0.1;

/// Returns whether a step presses joints together.
fn presses(deck: &Deck, step: &DeckStep) -> bool {
    match step.kind {
        StepKind::Preload => {
            let pressures = [step.pressure, step.top_pressure];
            pressures.into_iter().flatten().any(|p| p.get() > 0.0)
        }
        StepKind::Drive if step.settlement.is_some() => false,
        StepKind::Drive if deck.clamped().is_some() && step.face.is_none() => {
            let along = step.direction.map_or([1.0, 0.0, 0.0], Heading::unit);
            step.displacement.is_some_and(|d| along[2] * d.get() < 0.0)
        }
        StepKind::Drive => step.face.is_some(),
        StepKind::Gravity | StepKind::Tilt | StepKind::Free | StepKind::Load => true,
    }
}

/// Bodies that no chain of interfaces joins to a held body.
///
/// `held`: whether a support or a beam holds the body, `[body]`; `joints`: pairs of bodies whose interface
/// transfers force in all directions.
fn unheld_bodies(held: &[bool], joints: impl Iterator<Item = (u32, u32)>) -> Vec<usize> {
    let ground = held.len();
    let mut parent: Vec<usize> = (0..=ground).collect();
    for (body, _) in held.iter().enumerate().filter(|(_, held)| **held) {
        unite(&mut parent, body, ground);
    }
    for (a, b) in joints {
        unite(&mut parent, a as usize, b as usize);
    }
    let root = find(&mut parent, ground);
    (0..ground)
        .filter(|&body| find(&mut parent, body) != root)
        .collect()
}

fn find(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

fn unite(parent: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(parent, a), find(parent, b));
    parent[a.max(b)] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_connected_to_the_ground_are_held() {
        let held = [true, false, false, false, false];
        // 0–2–1 is joined to the ground, 3–4 is not.
        let joints = [(2, 1), (0, 2), (3, 4)];
        assert_eq!(unheld_bodies(&held, joints.into_iter()), vec![3, 4]);
        assert_eq!(
            unheld_bodies(&held, joints.into_iter().chain([(4, 1)])),
            Vec::<usize>::new()
        );
        assert_eq!(
            unheld_bodies(&[false, false], [(0, 1)].into_iter()),
            vec![0, 1]
        );
    }
}
