//! Whether a half would leave its symmetry by itself: a wall that buckles out of its plane moves to one side, and a
//! half that is held in the plane cannot.
//!
//! What goes one way on one side of a plane and the mirrored way on the other does not touch what goes the other way:
//! the stiffness of a mirrored scene falls in two. That of the half is the first; the second has the same cells, with
//! its nodes in the plane held along it instead of across and images of the other sign. Where it is not positive definite,
//! the whole would not stay as the half is (Healey and Treacy, Int. J. Numer. Meth. Engng 31, 1991).

use super::part::Part;
use crate::model::Model;
use crate::model::mesh::Reflected;
use crate::model::scene::{BeamMotion, HeldBy, Step, Support};
use crate::solve::Clock;
use crate::solve::State;
use crate::system::dofs::{DofMap, Equations};
use crate::system::linear::LinearError;
use crate::system::{Evaluation, STIFFEST_UNDER_LOADS, Solids, System, Trial, Turning};

/// Planes that what is solved would leave, of those that it is held in, at the end of a step: the first few of them that
/// its stiffness does not hold it in. Solids have their secant stiffness, joints that of their penalty. The trial is
/// begun anew.
pub(in crate::solve) fn leans(
    model: &Model,
    part: &Part,
    step: usize,
    system: &mut System,
    state: &State,
    trial: &mut Trial,
) -> Option<Vec<usize>> {
    let planes = part.planes.len();
    if planes == 0 {
        return None;
    }
    system.steered = None;
    system.start(trial, state);
    trial.spring_ends.clone_from(&state.spring_ends);
    trial.stiffest = STIFFEST_UNDER_LOADS;
    trial.stiffening = STIFFEST_UNDER_LOADS;
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
        .ok()?;
    (1..1_usize << planes)
        .map(|set| (0..planes).filter(|p| set >> p & 1 != 0).collect())
        .find(|turned: &Vec<usize>| {
            let (dofs, equations) = turned_over(model, part, step, turned);
            let tried = system.try_factor(&dofs, &equations, trial);
            matches!(tried, Err(LinearError::NotPositiveDefinite { .. }))
        })
}

/// Unknowns of what goes the mirrored way beyond these planes.
fn turned_over(model: &Model, part: &Part, step: usize, turned: &[usize]) -> (DofMap, Equations) {
    let axis = |p: &usize| part.planes[*p].axis;
    let is_turned = |d: usize| turned.iter().any(|p| axis(p) == d);
    let support = |support: &Support| {
        let mut support = support.clone();
        if let HeldBy::Plane { axis, at } = support.by {
            let own = |p: &&usize| part.planes[**p].axis == axis && part.planes[**p].at == at;
            if turned.iter().any(|p| own(&p)) {
                support.fixed = support.fixed.map(|held| !held);
            }
        }
        support
    };
    let reflected = model.mesh.reflected.iter().map(|image| {
        let beyond = (0..3).filter(|d| image.sign[*d] < 0.0 && is_turned(*d));
        let turn = if beyond.count() % 2 == 0 { 1.0 } else { -1.0 };
        Reflected {
            sign: image.sign.map(|sign| turn * sign),
            ..*image
        }
    });
    let supports: Vec<Support> = model.supports.iter().map(support).collect();
    let reflected: Vec<Reflected> = reflected.collect();
    let nodes = model.mesh.nodes.len();
    let dofs = DofMap::of(nodes, &model.beams, &supports, &reflected);
    // A level beam goes across a plane or along it, if anything.
    let motion = (0..model.beams.len()).map(|b| {
        let mut motion = [BeamMotion::Locked; 3];
        if let [p] = turned
            && part.free[*p][step][b]
        {
            motion[axis(p)] = BeamMotion::Force(0.0);
        }
        motion
    });
    let turned = Step {
        motion: motion.collect(),
        ..model.steps[step].clone()
    };
    let equations = Equations::new(&dofs, &turned);
    (dofs, equations)
}
