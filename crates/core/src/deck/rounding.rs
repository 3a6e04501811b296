//! Rounding errors of internal forces, and loads that are too small in comparison.

use super::schema::Deck;
use crate::error::ModelError;
use crate::model::Model;
use crate::model::floors::Floor;
use crate::model::rounding::largest;
use crate::model::scene::{BeamMotion, Step};

/// Rounding forces times this factor must stay below the tolerance of the residual, so that loads are resolved.
const CLEAR: f64 = 4.0;
/// Tolerance of the residual in this check: the default one. Runs with a smaller tolerance are at least this
/// accurate.
const TOLERANCE: f64 = 5e-2;

/// Rejects solids so stiff that rounding errors of their forces exceed the loads of a step: the state at rest would
/// count as equilibrium. Steps that drive have larger forces and are not checked.
///
/// # Errors
/// The first such step, with the material and its E.
pub(super) fn judge(deck: &Deck, model: &Model) -> Option<ModelError> {
    if model.mesh.elements.is_empty() {
        return None;
    }
    let (rounding, element) = largest(model);
    let drowns = |step: &&Step| {
        let load = load(model, step);
        load > 0.0 && !step.drives() && CLEAR * rounding > TOLERANCE * load
    };
    let index = model.steps.iter().position(|step| drowns(&step))?;
    let step = &model.steps[index];
    let material = &model.materials[model.mesh.material[element] as usize];
    let name = &material.name;
    Some(deck.error(
        &format!("materials.{name}.E"),
        format!(
            "E = {:e} MPa of {name} is too stiff for step {index} ({}): rounding leaves forces of {rounding:.1e} N in its \
             elements, and the loads of the step are {:.1e} N a node",
            material.parameters.elastic().E,
            step.name,
            load(model, step),
        ),
        "a stiffness as of a real material (steel has 210 GPa), or rigid = true for what is as good as rigid",
    ))
}

/// Sum of the weight and of the forces on faces at the end of a step, over the number of nodes [N].
fn load(model: &Model, step: &Step) -> f64 {
    let mesh = &model.mesh;
    let gravity = step
        .gravity
        .at(1.0)
        .iter()
        .map(|g| g * g)
        .sum::<f64>()
        .sqrt();
    let mass = |e: usize| {
        let parameters = &model.materials[mesh.material[e] as usize].parameters;
        parameters.elastic().density * mesh.volume(e)
    };
    let weight = if gravity > 0.0 {
        let floors = model.floors.iter().map(Floor::mass);
        gravity
            * (0..mesh.elements.len())
                .map(mass)
                .chain(floors)
                .sum::<f64>()
    } else {
        0.0
    };
    let forces = step.motion.iter().flatten().map(|motion| match motion {
        BeamMotion::Force(force) => force.abs(),
        _ => 0.0,
    });
    (weight + forces.sum::<f64>()) / mesh.nodes.len() as f64
}
