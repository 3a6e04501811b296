//! Processor time of a run, estimated before it.

use std::collections::HashSet;

use wythe_contact::InterfaceLaw;

use super::memory::planes_through;
use crate::deck::schema::Deck;
use crate::model::Model;
use crate::model::scene::Step;
use crate::model::sizes::sizes;

/// Estimated processor time [s] of the steps: where an increment takes few solves, because little cracks, and where it
/// takes many, because units snap and increments are repeated.
///
/// The sum over the steps has at least one increment for each `increments.max` of every branch of the amplitude, and
/// the time of a solve: contact points, elements, and the linear equations, whose number of operations grows as that of
/// a plane grid with 3 w unknowns in each of its points, where a wall is w nodes thick; scenes without walls count as a
/// cube. The constants are measured on walls of 1,000 to 180,000 unknowns. Of 134 runs of more than a second 10 took
/// less than the range and 32 more, 24 of these because most of their increments were motion with inertia.
pub(super) fn seconds(deck: &Deck, model: &Model) -> [f64; 2] {
    let increments: f64 = model.steps.iter().map(increments).sum();
    let solve = a_solve(deck, model);
    SOLVES.map(|solves| increments * solves * solve)
}

/// Solves of an increment: few, many [-].
const SOLVES: [f64; 2] = [2.5, 20.0];

/// Smallest number of increments of a step.
fn increments(step: &Step) -> f64 {
    let max = step.increments.max;
    match &step.amplitude {
        None => (1.0 / max).ceil(),
        Some(amplitude) => amplitude
            .rows()
            .windows(2)
            .map(|row| ((row[1][0] - row[0][0]) / max).ceil())
            .sum(),
    }
}

/// Processor time of a solve with all that belongs to it [s].
fn a_solve(deck: &Deck, model: &Model) -> f64 {
    let sizes = sizes(model);
    let laws = &model.contact.laws;
    let has_caps = laws.iter().any(|law| matches!(law, InterfaceLaw::Cap(_)));
    let point = if has_caps { CAP_POINT } else { POINT };
    let elements = model.mesh.elements.len() - rigid_elements(model).count();
    let equations = equations(deck, model, unknowns(model, sizes.dofs));
    sizes.contact_points as f64 * point + elements as f64 * ELEMENT + equations
}

/// Elements of units that are taken as rigid bodies.
fn rigid_elements(model: &Model) -> impl Iterator<Item = usize> {
    let is_rigid = |e: &usize| model.materials[usize::from(model.mesh.material[*e])].rigid;
    (0..model.mesh.elements.len()).filter(is_rigid)
}

/// Unknowns of the linear equations, of `dofs` of all nodes: a rigid body has six, and its nodes have none.
fn unknowns(model: &Model, dofs: usize) -> f64 {
    let mesh = &model.mesh;
    let (mut units, mut nodes) = (HashSet::new(), HashSet::new());
    for e in rigid_elements(model) {
        units.insert(mesh.unit[e]);
        nodes.extend(mesh.elements[e]);
    }
    let kept = dofs.saturating_sub(3 * nodes.len());
    (kept + 6 * units.len()).max(1) as f64
}

/// Processor time of a contact point in a solve [s], with the law of joints and with that of expanded units.
const POINT: f64 = 1.5e-6;
const CAP_POINT: f64 = 3e-6;

/// Processor time of a deformable element in a solve [s].
const ELEMENT: f64 = 6e-6;

/// Processor time of an equation [s], where 10,000 of them are those of a wall with nine unknowns through its thickness.
const EQUATION: f64 = 0.7e-6;

/// Processor time of `n` linear equations in a solve [s].
fn equations(deck: &Deck, model: &Model, n: f64) -> f64 {
    let cube = 3.0 * (n / 3.0).cbrt();
    let thick = planes_through(deck, model).map_or(cube, |planes| cube.min(3.0 * planes as f64));
    EQUATION * n * (n / 1e4).powf(0.3) * (thick / 9.0).powi(2)
}

/// A range of times in words, in the unit of the upper end, with two digits [s].
pub(super) fn in_words([low, high]: [f64; 2]) -> String {
    if high < 1.0 {
        return "less than 1 s".to_owned();
    }
    let (unit, name) = match high {
        ..120.0 => (1.0, "s"),
        ..7200.0 => (60.0, "min"),
        _ => (3600.0, "h"),
    };
    let [low, high] = [low, high].map(|time| {
        let value = time / unit;
        let decimals = usize::from(value < 9.95);
        format!("{value:.decimals$}")
    });
    format!("{low} to {high} {name}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_told_in_the_unit_of_the_longer_one() {
        assert_eq!(in_words([0.1, 0.6]), "less than 1 s");
        assert_eq!(in_words([2.04, 12.2]), "2.0 to 12 s");
        assert_eq!(in_words([30.0, 180.0]), "0.5 to 3.0 min");
        assert_eq!(in_words([9000.0, 54000.0]), "2.5 to 15 h");
    }

    #[test]
    fn every_branch_of_an_amplitude_has_increments_of_its_own() {
        use crate::model::amplitude::Amplitude;
        let mut step = Step::default();
        step.increments.max = 0.1;
        assert_eq!(increments(&step), 10.0);
        // 0.25/0.1 and 0.75/0.1, rounded up.
        step.amplitude = Amplitude::new(vec![[0.0, 0.0], [0.25, 1.0], [1.0, 0.0]]).ok();
        assert_eq!(increments(&step), 11.0);
    }
}
