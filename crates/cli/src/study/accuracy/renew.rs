//! Computes references.

use std::fmt::Write as _;
use std::time::Duration;

use super::errors::SLACK;
use super::outcome::{curve, solved};
use super::pattern::Pattern;
use super::scene::{Origin, Scene};
use crate::study::run::Watch;

/// Texts of the files of a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Renewed {
    /// Text of the curve.
    pub curve: String,
    /// Text of the crack pattern; none if the run has no frame within the range.
    pub pattern: Option<String>,
}

/// Computes the reference of a scene by its run, as the texts of its files; none if the reference does not come
/// from a run.
///
/// # Errors
/// In words: the run fails, or does not reach the end of the comparison.
pub fn renew(
    scene: &Scene,
    limit: Duration,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Renewed>, String> {
    let Origin::Run(choice) = &scene.reference.origin else {
        return Ok(None);
    };
    let set = [scene.set.clone(), choice.set.clone()].concat();
    let solved = solved(scene, choice, &set, Watch { limit, stop }, None)?;
    let curve = curve(scene, choice, &solved.ended);
    let end = curve.last().map_or(0.0, |p| p[0]);
    let [from, to] = scene.range;
    if end < to - SLACK * (to - from) {
        return Err(format!("ends at {end} of {to}: {}", solved.ended.message));
    }
    let (cost, number, command) = (solved.cost, scene.number, scene.command());
    let mut text = format!(
        "# {command} --only {number} --references\n# {} increments, {} solves, {:.0} s of CPU\n{},{}\n",
        cost.increments, cost.iterations, solved.cpu, scene.x, scene.y
    );
    for [x, y] in curve {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{x:.9},{y:.9}");
    }
    Ok(Some(Renewed {
        curve: text,
        pattern: solved.pattern.as_ref().map(Pattern::text),
    }))
}
