//! The stiffness at a state, apart from any increment: whether an equilibrium is stable.

use crate::assembly::dofs::{DofMap, Equations};
use crate::assembly::{Evaluation, STIFFEST_UNDER_LOADS, Solids, System, Trial, Turning};
use crate::linear::LinearError;
use crate::linear::eigen::{EigenError, Lowest};
use crate::model::Model;
use crate::model::scene::Step;
use crate::state::{Clock, State};

/// Part of the diagonal that is added to the stiffness before it is factorised. It lies above the roundings of a mode
/// without stiffness and below the least stiffness of slender structures (400 elements with joints: some 1e-11).
const NEUTRAL: f64 = 1e-13;

/// −λ over the shift of the eigenvalue problem from which a mode has a negative stiffness: beyond the rounding errors of
/// the stiffness, which are seen in the modes of free bodies.
const UNSTABLE: f64 = 1e-5;

/// Evaluates the stiffness of all cells at a state: solids with their secant, joints with the stiffness of the laws. None
/// if a law fails. The trial is restarted.
pub(in crate::solve) fn write_stiffness(
    model: &Model,
    system: &mut System,
    state: &State,
    trial: &mut Trial,
) -> Option<()> {
    system.start(model, trial, state);
    trial.spring_ends.clone_from(&state.spring_ends);
    trial.ties.stages.clear();
    trial.shift.stiffest = STIFFEST_UNDER_LOADS;
    trial.shift.stiffening = STIFFEST_UNDER_LOADS;
    let setting = Evaluation {
        dt: 1.0,
        solids: Solids::Held,
        shifted: true,
        tangent: true,
        turning: Turning::Ignored,
    };
    let mut clock = Clock::default();
    system
        .evaluate(model, state, trial, &state.q, setting, &mut clock)
        .ok()
}

/// Whether the stiffness about a state gives way in some motion. The trial is restarted.
pub(in crate::solve) fn gives_way(
    (model, step): (&Model, &Step),
    system: &mut System,
    state: &State,
    trial: &mut Trial,
) -> bool {
    let rigid = system.let_deform();
    let written = write_stiffness(model, system, state, trial);
    let equations = Equations::new(&system.dofs, step);
    let gives_way = written.is_some() && is_negative(system, (&system.dofs, &equations), trial);
    system.make_rigid(rigid);
    gives_way
}

/// Whether the trial's stiffness in these unknowns has a negative eigenvalue over its own diagonal. A motion without
/// resistance, such as that of a stone that may turn on its bed, says nothing about stability.
pub(in crate::solve) fn is_negative(
    system: &System,
    (dofs, equations): (&DofMap, &Equations),
    trial: &Trial,
) -> bool {
    let tried = system.try_factor(dofs, equations, trial, NEUTRAL);
    let may_be = matches!(
        tried,
        Err(LinearError::NotPositiveDefinite { .. } | LinearError::Singular { .. })
    );
    may_be
        && match system.lowest_over_diagonal(dofs, equations, trial) {
            Ok(found) => has_negative(&found),
            // Lower than the lowest shift: far beyond its critical load.
            Err(EigenError::Linear(LinearError::NotPositiveDefinite { .. })) => true,
            Err(_) => false,
        }
}

/// Whether the first eigenvalue is negative beyond the rounding errors of the stiffness.
fn has_negative(found: &Lowest) -> bool {
    let lowest = found.pairs.first();
    lowest.is_some_and(|lowest| lowest.value < -UNSTABLE * found.shift.abs())
}

/// Shape of the lowest natural mode about a state if its stiffness is negative; none otherwise, or if it cannot be
/// computed. The trial is restarted. `[slot]`
pub(in crate::solve) fn unstable_mode(
    (model, step): (&Model, &Step),
    system: &mut System,
    state: &State,
    trial: &mut Trial,
) -> Option<Vec<f64>> {
    let rigid = system.let_deform();
    let found = write_stiffness(model, system, state, trial).and_then(|()| {
        let equations = Equations::new(&system.dofs, step);
        let found = system.lowest_modes(&equations, trial, 1).ok()?;
        has_negative(&found).then(|| {
            let mut shape = vec![0.0; state.q.len()];
            for (x, slot) in found.pairs[0].vector.iter().zip(&equations.slot_of) {
                shape[*slot as usize] = *x;
            }
            shape
        })
    });
    system.make_rigid(rigid);
    found
}
