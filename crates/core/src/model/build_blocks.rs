//! A deck of blocks or of an arch → [`Model`].

use super::blocks::Blocks;
use super::build::require_steps;
use super::deck::{Deck, DeckStep, StepKind};
use super::findings;
use super::loading::{Loading, loading};
use super::loads;
use super::meeting::{Meeting, Touching, meeting};
use super::probes;
use super::quantity::Quantity;
use super::scatter;
use super::scene::{Model, NamedMaterial};
use super::supports::unheld_bodies;
use crate::error::{Errors, ModelError, Warning};
use crate::material::MaterialParameters;

/// Builds the model of a scene of blocks.
///
/// # Errors
/// Names of nothing, contradictions, blocks that float, softening that would snap back.
pub(super) fn build(deck: &Deck) -> Result<(Model, Vec<Warning>), ModelError> {
    let mut errors = Errors::default();
    errors.keep(require_steps(deck));
    let mut blocks = Blocks::new(deck)?;
    errors.keep(require_mass(deck, &blocks));
    let supports = errors.keep(blocks.supports()).unwrap_or_default();
    let springs = errors.keep(blocks.springs()).unwrap_or_default();
    let probes = errors.keep(probes::of_blocks(deck, &blocks));
    let (loaded, met) = (
        loading(deck, &blocks, &supports, &springs),
        surfaces(deck, &blocks),
    );
    let named = errors
        .keep(loads::of_blocks(deck, &blocks))
        .unwrap_or_default();
    let (Loading { beams, mut steps }, surfaces) = match (loaded, met) {
        (Ok(loaded), Ok(met)) => (loaded, met),
        // What holds the blocks, or the sizes of the elements, are not known.
        (Err(error), met) => {
            errors.keep(met);
            return Err(errors.and(error));
        }
        (Ok(_), Err(error)) => return Err(errors.and(error)),
    };
    let Surfaces {
        parameters,
        meeting: Meeting {
            mut contact,
            touching,
            ..
        },
    } = surfaces;
    contact.points = deck.contact.points;
    contact.search_radius = deck.contact.search_radius.map(Quantity::get);
    errors.keep(scatter::scatter(deck, &mut contact));
    let held = supports.iter().map(|s| &s.nodes);
    let held = held.chain(springs.iter().map(|s| &s.nodes));
    let held: Vec<u32> = held
        .chain(beams.iter().map(|b| &b.nodes))
        .flatten()
        .copied()
        .collect();
    errors.keep(require_held(deck, &blocks, &held, &touching));
    let names = std::mem::take(&mut blocks.materials);
    let initial_velocity = std::mem::take(&mut blocks.velocity);
    let model = Model {
        title: deck.title.clone(),
        mesh: blocks.mesh,
        materials: names
            .into_iter()
            .zip(parameters)
            .map(|(name, parameters)| NamedMaterial { name, parameters })
            .collect(),
        formulation: deck.element.formulation,
        contact,
        beams,
        supports,
        initial_velocity,
        springs,
        probes: probes.unwrap_or_default(),
        loads: named.assign(&mut steps),
        steps,
        output: deck.output()?,
    };
    findings::judged(deck, model, errors)
}

/// Materials of the blocks, and what meets.
struct Surfaces {
    parameters: Vec<MaterialParameters>,
    meeting: Meeting,
}

fn surfaces(deck: &Deck, blocks: &Blocks<'_>) -> Result<Surfaces, ModelError> {
    let materials = blocks.materials.iter();
    let parameters = materials
        .map(|name| deck.material(name))
        .collect::<Result<Vec<_>, _>>()?;
    let elastic: Vec<_> = parameters.iter().map(|p| *p.elastic()).collect();
    let meeting = meeting(deck, blocks, &elastic)?;
    Ok(Surfaces {
        parameters,
        meeting,
    })
}

/// What the author of a scene of blocks should know of its surfaces.
pub(super) fn surface_warnings(deck: &Deck) -> Result<Vec<Warning>, ModelError> {
    Ok(surfaces(deck, &Blocks::new(deck)?)?.meeting.warnings)
}

/// Refuses gravity and motion of what has no mass.
fn require_mass(deck: &Deck, blocks: &Blocks<'_>) -> Result<(), ModelError> {
    let needs =
        |s: &DeckStep| matches!(s.kind, StepKind::Gravity | StepKind::Tilt | StepKind::Free);
    let Some(step) = deck.steps.iter().position(needs) else {
        return Ok(());
    };
    let massless = |name: &&String| {
        deck.materials
            .get(*name)
            .is_some_and(|m| m.density.get() == 0.0)
    };
    let Some(name) = blocks.materials.iter().find(massless) else {
        return Ok(());
    };
    let kind = deck.steps[step].kind.name();
    Err(deck.error(
        &format!("materials.{name}.density"),
        format!("steps.{step} is of the kind {kind}, and {name} has no mass"),
        &super::keys::example("density"),
    ))
}

/// Refuses a block that floats: one that no chain of contacts joins to the ground when a step seeks
/// its equilibrium. A dry contact holds if it rubs and something presses.
fn require_held(
    deck: &Deck,
    blocks: &Blocks<'_>,
    held_nodes: &[u32],
    touching: &[Touching],
) -> Result<(), ModelError> {
    let Some(at_rest) = deck.steps.iter().position(|s| s.kind != StepKind::Free) else {
        return Ok(()); // all flies
    };
    let step = &deck.steps[at_rest];
    let pressed = match step.kind {
        StepKind::Preload => step.pressure.is_some_and(|p| p.get() > 0.0),
        StepKind::Drive => step.face.is_some(),
        StepKind::Gravity | StepKind::Tilt | StepKind::Free | StepKind::Load => true,
    };
    let pressed = pressed || at_rest > 0; // what flew before may have come to rest
    let mut held = vec![false; blocks.placed.len()];
    let mut body_of = vec![0; blocks.mesh.nodes.len()];
    for (e, nodes) in blocks.mesh.elements.iter().enumerate() {
        for n in nodes {
            body_of[*n as usize] = blocks.mesh.unit[e] as usize;
        }
    }
    for n in held_nodes {
        held[body_of[*n as usize]] = true;
    }
    let joins = |t: &&Touching| {
        deck.interfaces
            .get(&t.interface)
            .is_some_and(|f| !f.is_dry() || (pressed && f.mu.get() > 0.0))
    };
    let joints = touching.iter().filter(joins).map(|t| t.bodies);
    let unheld = unheld_bodies(&held, joints);
    let Some(&body) = unheld.first() else {
        return Ok(());
    };
    let name = &blocks.placed[body].name;
    let who = format!("{name} is held by nothing ({} blocks are)", unheld.len());
    let touches = |t: &&Touching| [t.bodies.0, t.bodies.1].contains(&(body as u32));
    let path = format!("steps.{at_rest}");
    Err(match touching.iter().find(touches) {
        None => deck.error(
            &path,
            format!("{who}: it touches no other block and has no support"),
            "add [[contacts]] to what it rests on, [[supports]], or begin with kind = \"free\"",
        ),
        Some(t)
            if deck
                .interfaces
                .get(&t.interface)
                .is_some_and(|f| f.mu.get() == 0.0) =>
        {
            deck.error(
                &format!("interfaces.{}", t.interface),
                format!("{who}: the joint has neither bond nor friction"),
                "give mu above 0, or f_t and c; or support the block along the joint",
            )
        }
        Some(_) => deck.error(
            &path,
            format!("{who}: the joints are dry and no load presses them together"),
            "begin with kind = \"gravity\", or with a preload",
        ),
    })
}
