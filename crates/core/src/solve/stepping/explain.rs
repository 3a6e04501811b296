//! Messages about lost convergence: place, reason and remedies.

use super::step_run::{IncrementRequest, StepRun};
use crate::material::MaterialParameters;
use crate::model::Model;
use crate::model::scene::{NamedMaterial, Procedure, Step, Tangent};
use crate::solve::fidelity::Part;
use crate::solve::increment::body_balance::RESULTANT;
use crate::solve::increment::convergence::{IMBALANCE, WORK};
use crate::solve::increment::outcome::Rejection;
use crate::state::Lost;

/// Message for a run that ends because the increment of its step cannot be cut further. Returns the full message with
/// remedies, and place and reason alone.
pub(in crate::solve) fn explain(
    model: &Model,
    part: &Part,
    step_run: &StepRun,
    request: IncrementRequest,
    rejection: &Rejection,
) -> (String, Lost) {
    let (step, name) = (step_run.index, &step_run.step.name);
    let done = step_run.progress();
    let why = why(model, part, step_run.step, rejection);
    let told = format!(
        "step {step} ({name}), at {done}, an increment of {:.2e} of the step, {}: {why}; try {}",
        request.increment.size,
        request.method.name(),
        advice(model, step, rejection)
    );
    let place = format!("{done} of step {step} ({name})");
    (told, Lost { place, why })
}

/// Progress of a step in words: its load factor, or the part of its time if it has an amplitude.
pub(in crate::solve) fn progress(step: &Step, done: f64) -> String {
    if step.amplitude.is_some() {
        format!("{:.2} % of the time", 100.0 * done)
    } else {
        format!("load factor {done:.4}")
    }
}

/// Reason and place of a rejection, with its measures.
pub(in crate::solve) fn why(
    model: &Model,
    part: &Part,
    step: &Step,
    rejection: &Rejection,
) -> String {
    match rejection {
        // The measures of all forces hold, so one of the two others does not.
        Rejection::Iterations {
            residual,
            root_mean_square,
            work,
            ..
        } if *residual <= step.tolerance.residual
            && *root_mean_square <= IMBALANCE
            && *work <= WORK =>
        {
            format!(
                "no equilibrium within {} iterations: the out-of-balance forces are within their tolerances, but those on a \
                 body without a bond exceed {RESULTANT:e} of the forces that act on it, or the displacements still change",
                step.tolerance.max_iterations
            )
        }
        Rejection::Iterations {
            residual,
            root_mean_square,
            work,
            node,
        } => format!(
            "no equilibrium within {} iterations, the largest out-of-balance force is {residual:.2e} of \
             the mean nodal force (tolerance {:e}), the root mean square {root_mean_square:.2e} \
             ({IMBALANCE:e}), their work {work:.2e} of that of the increment ({WORK:e}), worst at {}",
            step.tolerance.max_iterations,
            step.tolerance.residual,
            place(model, part, *node)
        ),
        Rejection::Local { element, why } => {
            let body = model.mesh.body_of(*element);
            let element = part.element(*element);
            format!("element {element} of {body}: {why}")
        }
        Rejection::Linear {
            why,
            dof: Some((node, direction)),
        } => format!(
            "{why}: {} is free to move in {}",
            place(model, part, *node),
            ["x", "y", "z"][*direction]
        ),
        Rejection::Linear { why, dof: None } => why.to_string(),
        Rejection::Snap => "the load must fall before it rises again (snap-back)".to_owned(),
        Rejection::Back => {
            "the path has slid back beyond the start of the drive or load".to_owned()
        }
        Rejection::Leap => "the increment has left the path for an equilibrium far away".to_owned(),
        Rejection::Energy(part) => format!(
            "the increment leaves {:.1} % of the work done unaccounted for",
            100.0 * part
        ),
        Rejection::NoSuchLoad => {
            "no load leads as far along the path as the increment should go".to_owned()
        }
        Rejection::NotFinite => "the out-of-balance force is not finite".to_owned(),
    }
}

/// Describes a node by its body, position at rest and number, and says whether it lies on an interface.
pub(in crate::solve) fn place(model: &Model, part: &Part, node: usize) -> String {
    let mesh = &model.mesh;
    let [x, y, z] = mesh.nodes[node];
    let has = |nodes: &[u32]| nodes.contains(&(node as u32));
    let element = mesh.elements.iter().position(|nodes| has(nodes));
    let surfaces = &model.contact;
    let mut facets = surfaces.slave_facets.iter().chain(&surfaces.master_facets);
    let on = if facets.any(|nodes| has(nodes)) {
        "on an interface, "
    } else {
        ""
    };
    let number = part.node(node);
    match element {
        Some(e) => format!(
            "{} at ({x:.1}, {y:.1}, {z:.1}) mm ({on}node {number})",
            mesh.body_of(e)
        ),
        None => format!("node {number} at ({x:.1}, {y:.1}, {z:.1}) mm"),
    }
}

/// Deck keys that may help, the likeliest first, without those already set.
fn advice(model: &Model, index: usize, rejection: &Rejection) -> String {
    let step = &model.steps[index];
    if let Rejection::Linear { dof: Some(_), .. } = rejection {
        let inertia = if model.may_move() {
            format!(
                "steps.{index}.increments.min below {:e}: inertia carries what comes loose in increments that are \
                 short beside the vibrations of its joints",
                step.increments.min
            )
        } else {
            "to give every material a density: inertia carries what comes loose".to_owned()
        };
        return format!(
            "to hold that body, to press it into contact before it is moved, or {inertia} (what hangs together \
             and is slender may have buckled: hold it sideways)"
        );
    }
    let mut tries = Vec::new();
    let patience = step.tolerance.max_iterations;
    if patience < USUAL_ITERATIONS && matches!(rejection, Rejection::Iterations { .. }) {
        tries.push(format!(
            "steps.{index}.tolerance.max_iterations = {USUAL_ITERATIONS} (now {patience})"
        ));
    }
    if step.procedure.seeks_equilibrium() && !model.may_move() {
        tries.push(
            "a density for every material: inertia carries what slides or comes loose".to_owned(),
        );
    }
    let min = step.increments.min;
    tries.push(format!("steps.{index}.increments.min below {min:e}"));
    if step.tangent != Tangent::Secant {
        tries.push(format!("steps.{index}.tangent = \"secant\""));
    }
    // A displacement controls the load in one procedure only.
    if step.procedure != Procedure::Auto && step.control.is_none() {
        tries.push(format!("steps.{index}.procedure = \"auto\""));
    }
    let cracks =
        |m: &NamedMaterial| matches!(m.parameters, MaterialParameters::DamagePlasticity(_));
    if step.viscosity == 0.0 && model.materials.iter().any(cracks) {
        let viscosity = USUAL_VISCOSITY * step.duration;
        tries.push(format!(
            "steps.{index}.viscosity = {viscosity} (of step time), which carries the snap of a unit"
        ));
    }
    tries.join("; or ")
}

/// The default of `max_iterations`; with fewer, a larger value is advised.
const USUAL_ITERATIONS: usize = 25;
/// Viscosity over the duration of a step that helped in the walls of the paper.
const USUAL_VISCOSITY: f64 = 0.0025;
