//! Steps of a deck: the faces that move as one, and their motion.

use super::bodies::Bodies;
use super::contradictions;
use super::gravity::GravityNow;
use super::keys;
use super::probes;
use super::quantity::Quantity;
use super::rigid;
use super::schema::{
    Deck, DeckBlock, DeckSettlement, DeckStep, Heading, Names, StepKind, Vertical,
};
use crate::element::hexahedron::range;
use crate::error::{ErrorKind, Errors, ModelError};
use crate::model::amplitude::Amplitude;
use crate::model::scene::{Beam, BeamMotion, Driven, GroundMotion, Spring, Step, Stop, Support};
use std::collections::{BTreeMap, BTreeSet};

/// Beams and steps of a scene.
#[derive(Default)]
pub(super) struct Loading {
    pub(super) beams: Vec<Beam>,
    pub(super) steps: Vec<Step>,
}

/// A face is normal to an axis if its unit normal has at least this component along it.
const ALONG: f64 = 1.0 - 1e-9;

/// Builds beams and steps.
///
/// Every face that a step presses or drives is a beam during the whole run. It is free until a step moves it, then
/// locked in place or left under its pressure. The top of a clamped wall is a beam too (`clamped`); steps that name
/// no face refer to it.
///
/// # Errors
/// Unknown names, faces with common nodes, pressure on a face that is not normal to an axis.
pub(super) fn loading(
    deck: &Deck,
    bodies: &Bodies<'_>,
    clamped: Option<Beam>,
    supports: &[Support],
    springs: &[Spring],
) -> Result<Loading, ModelError> {
    let top = clamped.is_some();
    let beams = beams(deck, bodies, clamped)?;
    let beam_of = |step: &DeckStep| beam_of(step, &beams, top);
    let mut now: Vec<[BeamMotion; 3]> = beams.iter().map(at_first).collect();
    let mut load = vec![[0.0; 3]; beams.len()];
    let mut gravity = GravityNow::none();
    let mut steps = Vec::with_capacity(deck.steps.len());
    let mut errors = Errors::default();
    for (i, step) in deck.steps.iter().enumerate() {
        // A beam that the last step has driven is locked in place.
        now.iter_mut().flatten().for_each(BeamMotion::lock);
        let mut far_ends = vec![[0.0; 3]; springs.len()];
        let (by, beam) = (driven_by(step), beam_of(step));
        if let Some(b) = beam.filter(|b| beams[*b].settles()) {
            for (axis, by) in driven_axes(step) {
                now[b][axis] = BeamMotion::Driven(by);
            }
        } else if let Some(b) = beam.filter(|_| step.face.is_none()) {
            let force = step.top_pressure.map(|p| -p.get() * beams[b].area);
            load[b][2] = force.unwrap_or(load[b][2]);
            now[b] = level_beam(step, load[b][2], now[b][2]);
        } else if let Some(b) = beam {
            if step.kind == StepKind::Preload {
                let force = errors.keep(pressure(deck, i, step, &beams[b]));
                load[b] = force.unwrap_or_default();
            }
            now[b] = face_motion(step, beams[b].normal, load[b]);
        } else if let Some(name) = &step.spring {
            match spring_of(deck, i, springs, name, by) {
                Ok(s) => far_ends[s] = by,
                Err(error) => errors.push(error),
            }
        }
        // The history records the driven face; before a drive, the face of the next drive.
        let drives = |s: &DeckStep| {
            (s.kind == StepKind::Drive).then(|| Some(driven_along(beam_of(s)?, s)))?
        };
        let driven = deck.steps[i..].iter().find_map(drives);
        // Of the top of a wall after its drive the same, and of one that is never driven the load on top.
        let top_of_wall = || {
            let before = deck.steps[..i].iter().rev().find_map(drives);
            before.or_else(|| top.then_some(Driven::along(0, 2)))
        };
        let driven = driven.or_else(|| top_of_wall().filter(|_| beam == Some(0)));
        let normal = |b: &Beam| (0..3).find(|d| b.normal[*d].abs() > ALONG);
        let pressed = beam.and_then(|b| Some(Driven::along(b, normal(&beams[b])?)));
        let rules = errors.keep(rules(deck, i, step, &mut gravity));
        steps.extend(rules.map(|rules| Step {
            motion: now.clone(),
            driven: driven.or(pressed),
            springs: far_ends,
            ..rules
        }));
    }
    // Step indices are valid only if no step is missing.
    if steps.len() == deck.steps.len() {
        let beam_of = |i: usize| deck.steps.get(i).and_then(beam_of);
        let judged = contradictions::judge(deck, &beams, &mut steps, supports, beam_of);
        errors.keep(judged);
    }
    errors.end(Loading { beams, steps })
}

/// Index of the beam that a step moves, if any. `top`: whether the first one is the top of a clamped wall.
pub(super) fn beam_of(step: &DeckStep, beams: &[Beam], top: bool) -> Option<usize> {
    if let Some(faces) = &step.face {
        let name = beam_name(faces);
        return beams.iter().position(|beam| beam.name == name);
    }
    match &step.settlement {
        Some(name) => beams.iter().position(|b| b.settles() && b.name == *name),
        None => (top && step.spring.is_none()).then_some(0),
    }
}

/// Motion of a beam before the first step: ground is held until a step moves it.
fn at_first(beam: &Beam) -> [BeamMotion; 3] {
    if beam.settles() {
        [BeamMotion::Locked; 3]
    } else {
        [BeamMotion::Force(0.0); 3]
    }
}

/// Motion of the level beam of a wall in a step. A pressed beam moves vertically only. A driven beam stays level;
/// it is locked vertically, or free under its load [N]. A step of loads keeps its vertical motion. In other steps
/// it stays under its load and moves vertically.
fn level_beam(step: &DeckStep, load: f64, vertical: BeamMotion) -> [BeamMotion; 3] {
    let mut motion = [BeamMotion::Locked; 3];
    if step.kind == StepKind::Load {
        motion[2] = vertical;
    } else if step.kind != StepKind::Drive || step.vertical == Some(Vertical::Free) {
        motion[2] = BeamMotion::Force(load);
    }
    if step.kind == StepKind::Drive {
        for (axis, by) in driven_axes(step) {
            motion[axis] = BeamMotion::Driven(by);
        }
    }
    motion
}

/// Direction of a drive, of length 1. The ground of a settlement goes down.
fn heading(step: &DeckStep) -> [f64; 3] {
    if step.settlement.is_some() {
        return step.direction.map_or([0.0, 0.0, -1.0], Heading::unit);
    }
    step.direction.map_or([1.0, 0.0, 0.0], Heading::unit)
}

/// Displacement of a drive [mm]. `[xyz]`
fn driven_by(step: &DeckStep) -> [f64; 3] {
    heading(step).map(|part| part * step.drive())
}

/// Axes along which a drive moves its face, with the displacements [mm].
fn driven_axes(step: &DeckStep) -> impl Iterator<Item = (usize, f64)> {
    let (along, by) = (heading(step), driven_by(step));
    (0..3)
        .filter(move |axis| along[*axis] != 0.0)
        .map(move |axis| (axis, by[axis]))
}

/// The face that a drive moves, and the line along which it does: positive along the first axis that it has a part of.
fn driven_along(beam: usize, step: &DeckStep) -> Driven {
    let along = heading(step);
    let first = along.iter().find(|part| **part != 0.0);
    let sign = first.map_or(1.0, |part| part.signum());
    Driven {
        beam,
        direction: along.map(|part| if part == 0.0 { 0.0 } else { sign * part }),
    }
}

/// Motion of a face that a step presses or drives, under its load [N].
fn face_motion(step: &DeckStep, normal: [f64; 3], load: [f64; 3]) -> [BeamMotion; 3] {
    let (along, by) = (heading(step), driven_by(step));
    let is_free = |d: usize| step.free.iter().flatten().any(|axis| axis.index() == d);
    [0, 1, 2].map(|d| {
        let pressed = step.kind == StepKind::Preload && normal[d].abs() > ALONG;
        if step.kind == StepKind::Drive && along[d] != 0.0 {
            BeamMotion::Driven(by[d])
        } else if pressed || is_free(d) {
            BeamMotion::Force(load[d])
        } else {
            BeamMotion::Locked
        }
    })
}

/// Index of the spring whose far end step `i` moves by these displacements. `[xyz]`
fn spring_of(
    deck: &Deck,
    i: usize,
    springs: &[Spring],
    name: &str,
    by: [f64; 3],
) -> Result<usize, ModelError> {
    let Some(s) = springs.iter().position(|s| s.name == name) else {
        let path = format!("steps.{i}.spring");
        let help = keys::example("springs");
        return Err(deck
            .error(&path, format!("there is no spring named `{name}`"), &help)
            .of_kind(ErrorKind::UnknownName));
    };
    if (0..3).any(|axis| by[axis] != 0.0 && springs[s].stiffness[axis] == 0.0) {
        return Err(deck
            .error(
                &format!("steps.{i}.direction"),
                format!("the spring `{name}` has no stiffness in this direction"),
                "give it one: springs.stiffness, along x, y, z",
            )
            .of_kind(ErrorKind::Missing));
    }
    Ok(s)
}

/// The step without motion of faces and springs: amplitude, procedure, increments, gravity and the like.
pub(super) fn rules(
    deck: &Deck,
    i: usize,
    step: &DeckStep,
    gravity: &mut GravityNow,
) -> Result<Step, ModelError> {
    let mut errors = Errors::default();
    let control = errors.keep(probes::control(deck, i, step)).flatten();
    let gravity = errors.keep(gravity.step(deck, i, step));
    let ground = errors.keep(deck.ground_motion(i));
    let amplitude = errors.keep(deck.amplitude(i)).flatten();
    let finest = ground.as_ref().map_or(f64::INFINITY, GroundMotion::spacing);
    let steepest = amplitude.as_ref().map_or(1.0, Amplitude::steepest);
    errors.end(Step {
        name: step.name().to_owned(),
        duration: step.duration.get(),
        motion: Vec::new(),
        driven: None,
        increments: step.increments_of(steepest, finest / step.duration.get()),
        viscosity: step.viscosity.get(),
        procedure: step.procedure.with(step.alpha, step.rayleigh),
        tangent: step.tangent,
        control,
        stop: step.stop.map(|stop| Stop {
            below_peak: stop.below_peak.map(Quantity::get),
            displacement: stop.displacement.map(Quantity::get),
        }),
        tolerance: step.tolerance(),
        gravity: gravity.unwrap_or_default(),
        ground: ground.unwrap_or_default(),
        springs: Vec::new(),
        ties: Vec::new(),
        loads: Vec::new(),
        amplitude,
    })
}

fn beam_name(faces: &Names) -> String {
    faces.0.join(", ")
}

/// Beams: the top of the clamped wall, and the faces that steps name, each once.
fn beams(deck: &Deck, bodies: &Bodies<'_>, clamped: Option<Beam>) -> Result<Vec<Beam>, ModelError> {
    let mut beams: Vec<Beam> = clamped.into_iter().collect();
    let mut errors = Errors::default();
    for (i, step) in deck.steps.iter().enumerate() {
        let Some(faces) = &step.face else { continue };
        if !beams.iter().any(|b| b.name == beam_name(faces)) {
            let beam = beam(deck, i, faces, bodies, &beams);
            beams.extend(errors.keep(beam));
        }
    }
    for (i, settlement) in deck.settlements.iter().enumerate() {
        let ground = ground(deck, i, settlement, bodies, &beams);
        beams.extend(errors.keep(ground));
    }
    errors.end(beams)
}

/// Nodes on the ground of a settlement, which must not be those of the other `beams`.
fn ground(
    deck: &Deck,
    i: usize,
    settlement: &DeckSettlement,
    bodies: &Bodies<'_>,
    beams: &[Beam],
) -> Result<Beam, ModelError> {
    let path = format!("settlements.{i}.on");
    let places = bodies.places(&path, &settlement.on, false)?;
    let nodes = bodies.nodes(&places);
    require_apart(deck, &path, &settlement.name, &nodes, beams)?;
    let along = settlement.along.index();
    let part = |n: &u32| settlement.part(bodies.mesh.nodes[*n as usize][along]);
    let shape: Vec<f64> = nodes.iter().map(part).collect();
    if shape.iter().all(|part| *part == 0.0) {
        return Err(deck
            .error(
                &path,
                format!("`{}` moves none of these nodes", settlement.name),
                "the shape is 0 at all of them: look at its coordinates",
            )
            .of_kind(ErrorKind::Geometry));
    }
    Ok(Beam {
        name: settlement.name.clone(),
        free: free_along(bodies, &nodes, along),
        nodes,
        area: 0.0,
        normal: [0.0; 3],
        shape,
        depth: 0.0,
    })
}

/// Nodes of rigid units on ground whose shape varies along a horizontal axis, but those in the middle of each unit:
/// they stay free along the axis. The others of the ground are held in all directions.
fn free_along(bodies: &Bodies<'_>, ground: &[u32], along: usize) -> Vec<(u32, usize)> {
    let mesh = &bodies.mesh;
    if along == 2 {
        return Vec::new();
    }
    let mut of_unit: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    let elements = mesh.elements.iter().zip(&mesh.unit).zip(&mesh.material);
    for ((nodes, unit), material) in elements {
        let name = &bodies.materials[usize::from(*material)];
        if rigid::base(name) != name {
            let on_ground = nodes.iter().filter(|n| ground.binary_search(n).is_ok());
            of_unit.entry(*unit).or_default().extend(on_ground);
        }
    }
    let s = |n: u32| mesh.nodes[n as usize][along];
    let free = |nodes: &BTreeSet<u32>| -> Vec<(u32, usize)> {
        let [low, high] = range(nodes.iter().map(|n| s(*n)));
        let middle = 0.5 * (low + high);
        let away = |n: u32| (s(n) - middle).abs();
        let nearest = nodes
            .iter()
            .copied()
            .min_by(|a, b| away(*a).total_cmp(&away(*b)));
        let held = nearest.map_or(middle, s);
        let others = nodes
            .iter()
            .filter(|n| (s(**n) - held).abs() > SAME * (high - low));
        others.map(|n| (*n, along)).collect()
    };
    of_unit.values().flat_map(free).collect()
}

/// Part of the length of a unit within which nodes lie in one plane across it.
const SAME: f64 = 1e-6;

/// Rejects nodes that other beams move.
fn require_apart(
    deck: &Deck,
    path: &str,
    name: &str,
    nodes: &[u32],
    beams: &[Beam],
) -> Result<(), ModelError> {
    let shares = |b: &&Beam| b.nodes.iter().any(|n| nodes.binary_search(n).is_ok());
    let Some(other) = beams.iter().find(shares) else {
        return Ok(());
    };
    Err(deck
        .error(
            path,
            format!("{name} has nodes in common with {}", other.name),
            "a node follows one face: drive one of them, or faces of different blocks",
        )
        .of_kind(ErrorKind::Conflict))
}

/// The face of step `i`, which must share no nodes with the `beams` of earlier steps.
fn beam(
    deck: &Deck,
    i: usize,
    faces: &Names,
    bodies: &Bodies<'_>,
    beams: &[Beam],
) -> Result<Beam, ModelError> {
    let path = format!("steps.{i}.face");
    let name = beam_name(faces);
    let places = bodies.places(&path, faces, true)?;
    if places.is_empty() {
        return Err(deck
            .error(&path, "the list is empty", &keys::example("face"))
            .of_kind(ErrorKind::Missing));
    }
    let nodes = bodies.nodes(&places);
    require_apart(deck, &path, &name, &nodes, beams)?;
    let (vector, area) = bodies.area(&places);
    // The top of one of `[[beams]]`: its depth is a part of it, not of the wall.
    let is_beam = deck.said(&path).rsplit('.').next() == Some("beam");
    let below = |block: &DeckBlock| is_beam && name == format!("{}.top", block.name);
    let block = deck.blocks.iter().find(|block| below(block));
    let depth = block
        .and_then(|block| block.size)
        .map_or(0.0, |size| size[2].get());
    let length = crate::element::hexahedron::norm(vector);
    Ok(Beam {
        name,
        nodes,
        area,
        normal: if length > 0.0 {
            vector.map(|x| x / length)
        } else {
            [0.0; 3]
        },
        shape: Vec::new(),
        free: Vec::new(),
        depth,
    })
}

/// Force of a pressure on a face, against its normal [N].
fn pressure(
    deck: &Deck,
    index: usize,
    step: &DeckStep,
    beam: &Beam,
) -> Result<[f64; 3], ModelError> {
    if !beam.normal.iter().any(|n| n.abs() > ALONG) {
        return Err(deck
            .error(
                &format!("steps.{index}.face"),
                format!(
                    "no axis is normal to {}: pressure would have to turn with it",
                    beam.name
                ),
                "press a face that looks along x, y or z",
            )
            .of_kind(ErrorKind::Geometry));
    }
    let force = step.pressure.map_or(0.0, Quantity::get) * beam.area;
    Ok(beam.normal.map(|n| {
        if n.abs() > ALONG {
            -force * n.signum()
        } else {
            0.0
        }
    }))
}
