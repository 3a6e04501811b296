//! Makes references anew.

use std::fmt::Write as _;
use std::time::Duration;

use super::errors::SLACK;
use super::outcome::{curve, solved};
use super::pattern::Pattern;
use super::scene::{Origin, Scene};
use crate::study::run::Watch;

/// A reference, as the texts of its files.
#[derive(Clone, Debug, PartialEq)]
pub struct Renewed {
    /// Its curve.
    pub curve: String,
    /// Its cracks; none where the run shows no frame within the range.
    pub pattern: Option<String>,
}

/// The reference of a scene as the texts of its files, by the run that it is said to come from; none where it comes from
/// elsewhere.
///
/// # Errors
/// In words: the run breaks, or does not come to the end of the comparison.
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
        // A String cannot refuse.
        let _ = writeln!(text, "{x:.9},{y:.9}");
    }
    Ok(Some(Renewed {
        curve: text,
        pattern: solved.pattern.as_ref().map(Pattern::text),
    }))
}
