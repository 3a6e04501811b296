//! Contradictions between supports and steps: a step presses, drives or frees a face in a direction in which
//! supports hold the whole face, or nodes of it.

use super::schema::{Deck, StepKind, Vertical};
use crate::error::{ErrorKind, Errors, ModelError, Warning};
use crate::model::Model;
use crate::model::scene::{Beam, BeamMotion, HeldBy, Step, Support};
use std::collections::BTreeSet;

/// Names of the supports that hold nodes of a face in a direction, if together they hold all of its nodes.
fn holders<'a>(beam: &Beam, axis: usize, supports: &'a [Support]) -> Option<Vec<&'a str>> {
    let of = |s: &&Support| s.fixed[axis] && s.nodes.iter().any(|n| beam.nodes.contains(n));
    let holders: Vec<&Support> = supports.iter().filter(of).collect();
    let held = |n: &u32| holders.iter().any(|s| s.nodes.contains(n));
    // Planes of symmetry are checked in `symmetry`.
    let by_ground = holders.iter().any(|s| matches!(s.by, HeldBy::Ground));
    let all = !beam.nodes.is_empty() && by_ground && beam.nodes.iter().all(held);
    all.then(|| holders.iter().map(|s| s.name.as_str()).collect())
}

/// Nodes of a face that supports hold in a direction.
struct Shared<'a> {
    /// Names of the supports.
    names: Vec<&'a str>,
    /// Number of these nodes, and that of all nodes of the face; none if they are all.
    part: Option<[usize; 2]>,
}

/// Supports on ground that hold some of the nodes which a beam moves along an axis, if any does.
fn shared<'a>(beam: &Beam, axis: usize, supports: &'a [Support]) -> Option<Shared<'a>> {
    let part_of = |i: usize| beam.shape.get(i).copied().unwrap_or(1.0);
    let nodes = beam.nodes.iter().enumerate();
    let moved = nodes.filter(|(i, _)| part_of(*i) != 0.0);
    let mut moved: BTreeSet<u32> = moved.map(|(_, n)| *n).collect();
    for (n, _) in beam.free.iter().filter(|(_, d)| *d == axis) {
        moved.remove(n);
    }
    let (mut held, mut names) = (BTreeSet::new(), Vec::new());
    let on_ground = |s: &&Support| s.fixed[axis] && matches!(s.by, HeldBy::Ground);
    for support in supports.iter().filter(on_ground) {
        let mut common = support.nodes.iter().filter(|n| moved.contains(n));
        if let Some(first) = common.next() {
            held.insert(*first);
            held.extend(common);
            names.push(support.name.as_str());
        }
    }
    let part = Some([held.len(), moved.len()]);
    (!held.is_empty()).then_some(Shared { names, part })
}

/// Rejects steps that press, drive or free a face in a direction in which supports hold it, or drive it where supports
/// hold some of its nodes. A face that is held is locked in this direction in all steps, because it has no other unknown
/// there.
///
/// # Errors
/// One for each step and direction, with the names of the supports and the step; of drives of faces that are held in part
/// one for each direction. `beam_of`: the face that a step moves.
pub(super) fn judge(
    deck: &Deck,
    beams: &[Beam],
    steps: &mut [Step],
    supports: &[Support],
    beam_of: impl Fn(usize) -> Option<usize>,
) -> Result<(), ModelError> {
    let mut errors = Errors::default();
    for (b, beam) in beams.iter().enumerate() {
        for axis in 0..3 {
            let Some(names) = holders(beam, axis, supports) else {
                let mut own = (0..steps.len()).filter(|i| beam_of(*i) == Some(b));
                let drive = own.find(|i| is_driven(deck, *i, steps[*i].motion[b][axis]));
                let shared = drive.and_then(|i| Some((i, shared(beam, axis, supports)?)));
                if let Some((i, shared)) = shared {
                    errors.push(refusal(deck, i, (beam, axis), &shared, Does::DrivesPart));
                }
                continue;
            };
            let shared = Shared { names, part: None };
            for (i, step) in steps.iter_mut().enumerate() {
                let motion = &mut step.motion[b][axis];
                if let Some(does) =
                    contradicted(deck, i, axis, *motion).filter(|_| beam_of(i) == Some(b))
                {
                    errors.push(refusal(deck, i, (beam, axis), &shared, does));
                }
                *motion = BeamMotion::Locked;
            }
        }
    }
    errors.end(())
}

/// Warnings about steps that press or free a face in a direction in which supports hold some of its nodes, one for each
/// face and direction. `beam_of`: the face that a step moves.
pub(super) fn partly_held(
    deck: &Deck,
    model: &Model,
    beam_of: impl Fn(usize) -> Option<usize>,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (b, beam) in model.beams.iter().enumerate() {
        for axis in 0..3 {
            let mut own = model.steps.iter().enumerate();
            let does = own.find_map(|(i, step)| {
                beam_of(i).filter(|of| *of == b)?;
                let does = contradicted(deck, i, axis, step.motion[b][axis])?;
                matches!(does, Does::Presses | Does::Frees).then_some((i, does))
            });
            let shared = does.and_then(|does| Some((does, shared(beam, axis, &model.supports)?)));
            if let Some(((i, does), shared)) = shared {
                let (key, message) = message(deck, i, (beam, axis), &shared, does);
                let message = format!(
                    "{message}; these nodes stay where they are, and the others move as one"
                );
                warnings.push(deck.warning(&key, message));
            }
        }
    }
    warnings
}

/// Action of a step on its face in a direction that contradicts a support.
#[derive(Clone, Copy)]
enum Does {
    Presses,
    Drives,
    DrivesPart,
    Frees,
}

fn contradicted(deck: &Deck, i: usize, axis: usize, motion: BeamMotion) -> Option<Does> {
    let step = deck.steps.get(i)?;
    let frees = step.free.iter().flatten().any(|free| free.index() == axis)
        || (axis == 2 && step.vertical == Some(Vertical::Free));
    match motion {
        BeamMotion::Driven(_) => Some(Does::Drives),
        BeamMotion::Force(_) if frees => Some(Does::Frees),
        BeamMotion::Force(_) if step.kind == StepKind::Preload => Some(Does::Presses),
        BeamMotion::Locked | BeamMotion::Force(_) => None,
    }
}

/// Whether step `i` drives its face by more than the rounding of a direction.
fn is_driven(deck: &Deck, i: usize, motion: BeamMotion) -> bool {
    let whole = deck.steps.get(i).map_or(0.0, |step| step.drive().abs());
    matches!(motion, BeamMotion::Driven(by) if by.abs() > ROUNDING * whole)
}

/// Part of a drive below which its component along an axis is rounding.
const ROUNDING: f64 = 1e-9;

fn refusal(
    deck: &Deck,
    i: usize,
    moved: (&Beam, usize),
    shared: &Shared<'_>,
    does: Does,
) -> ModelError {
    let help = match does {
        Does::Drives => "take the support away, or drive another face",
        Does::DrivesPart => {
            "a node follows the face or the support: hold other nodes, by `fixed` or `box`, or drive another face"
        }
        Does::Presses => {
            "take the direction out of `fixed` of the support, or press a face that may move"
        }
        Does::Frees => "take the direction out of `free`, or out of `fixed` of the support",
    };
    let (key, message) = message(deck, i, moved, shared, does);
    let error = deck.error(&key, message, help);
    error.of_kind(ErrorKind::Conflict)
}

/// Key of step `i` that contradicts supports, and how.
fn message(
    deck: &Deck,
    i: usize,
    (beam, axis): (&Beam, usize),
    shared: &Shared<'_>,
    does: Does,
) -> (String, String) {
    let of = &deck.steps[i];
    let (key, verb) = match does {
        Does::Drives | Does::DrivesPart => ("face", "drives it"),
        Does::Presses if shared.part.is_none() => ("face", "presses it: no force reaches the body"),
        Does::Presses => ("face", "presses it"),
        Does::Frees => ("free", "leaves it free"),
    };
    let key = match (key, &of.face) {
        ("face", None) if of.top_pressure.is_some() => "top_pressure",
        ("face", None) => "direction",
        ("free", _) if of.free.is_none() => "vertical",
        (key, _) => key,
    };
    let part = match shared.part {
        Some([held, all]) => format!("{held} of the {all} nodes"),
        None => "all".to_owned(),
    };
    let direction = ["x", "y", "z"][axis];
    let message = format!(
        "the support on {} holds {} of {} in {direction}, in which step {i} ({}) {verb}",
        shared.names.join(" and on "),
        part,
        beam.name,
        of.name()
    );
    (format!("steps.{i}.{key}"), message)
}
