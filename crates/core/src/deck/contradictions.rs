//! Contradictions between supports and steps: a step presses, drives or frees a face in a direction in which
//! supports hold the whole face.

use super::schema::{Deck, StepKind, Vertical};
use crate::error::{ErrorKind, Errors, ModelError};
use crate::model::scene::{Beam, BeamMotion, HeldBy, Step, Support};

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

/// Rejects steps that press, drive or free a face in a direction in which supports hold it. The face is locked in
/// this direction in all steps, because it has no other unknown there.
///
/// # Errors
/// One for each step and direction, with the names of the supports and the step. `beam_of`: the face that a step
/// moves.
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
                continue;
            };
            for (i, step) in steps.iter_mut().enumerate() {
                let motion = &mut step.motion[b][axis];
                if let Some(does) =
                    contradicted(deck, i, axis, *motion).filter(|_| beam_of(i) == Some(b))
                {
                    errors.push(refusal(deck, i, (beam, axis), &names, does));
                }
                *motion = BeamMotion::Locked;
            }
        }
    }
    errors.end(())
}

/// Action of a step on its face in a direction that contradicts a support.
#[derive(Clone, Copy)]
enum Does {
    Presses,
    Drives,
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

fn refusal(
    deck: &Deck,
    i: usize,
    (beam, axis): (&Beam, usize),
    supports: &[&str],
    does: Does,
) -> ModelError {
    let of = &deck.steps[i];
    let direction = ["x", "y", "z"][axis];
    let (key, verb, help) = match does {
        Does::Drives => (
            "face",
            "drives it",
            "take the support away, or drive another face",
        ),
        Does::Presses => (
            "face",
            "presses it: no force reaches the body",
            "take the direction out of `fixed` of the support, or press a face that may move",
        ),
        Does::Frees => (
            "free",
            "leaves it free",
            "take the direction out of `free`, or out of `fixed` of the support",
        ),
    };
    let key = match (key, &of.face) {
        ("face", None) if of.top_pressure.is_some() => "top_pressure",
        ("face", None) => "direction",
        ("free", _) if of.free.is_none() => "vertical",
        (key, _) => key,
    };
    deck.error(
        &format!("steps.{i}.{key}"),
        format!(
            "the support on {} holds all of {} in {direction}, in which step {i} ({}) {verb}",
            supports.join(" and on "),
            beam.name,
            of.name()
        ),
        help,
    )
    .of_kind(ErrorKind::Conflict)
}
