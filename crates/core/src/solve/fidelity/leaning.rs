//! Whether a half would leave its symmetry by itself: a wall that buckles out of its plane moves to one side, and a
//! half that is held in the plane cannot.
//!
//! What goes one way on one side of a plane and the mirrored way on the other does not touch what goes the other way:
//! the stiffness of a mirrored scene falls in two. That of the half is the first; the second has the same cells, with
//! its nodes in the plane held along it instead of across and images of the other sign. Where it is not positive definite,
//! the whole would not stay as the half is (Healey and Treacy, Int. J. Numer. Meth. Engng 31, 1991).

use super::part::Part;
use crate::assembly::dofs::{DofMap, Equations};
use crate::assembly::{Evaluation, STIFFEST_UNDER_LOADS, Solids, System, Trial, Turning};
use crate::linear::LinearError;
use crate::model::Model;
use crate::model::loads::LoadOn;
use crate::model::mesh::Reflected;
use crate::model::scene::{BeamMotion, HeldBy, Step, Support};
use crate::solve::Recorder;
use crate::solve::stepping::run::Run;
use crate::solve::stepping::step_run::StepRun;
use crate::state::QUIET;
use crate::state::Status;
use crate::state::{Clock, State};

/// Part of its own stiffness that holds what nothing else does, or is taken from what is at rest to find what nothing
/// holds there: above what rounding makes of a mode without stiffness, below the least of what is slender (400
/// elements with joints: some 1e-11).
const NEUTRAL: f64 = 1e-13;

impl Run<'_> {
    /// Whether a part of the scene would stay in its planes as the whole, where a step ends or its loads turn
    /// round. If not, the run ends here: what it has found is not what the whole does.
    ///
    /// What moves is not asked, nor what lies where it fell: whether that stands or is loose its stiffness at
    /// rest does not tell.
    pub(in crate::solve) fn keeps_symmetry(
        &mut self,
        step_run: &StepRun,
        recorder: &mut dyn Recorder,
    ) -> bool {
        let step = step_run.index;
        let moves =
            step_run.step.procedure.has_inertia() || step_run.fallback.method().has_inertia();
        if moves || self.state.fell || self.state.energies.moving() > QUIET {
            return true;
        }
        let (model, state) = (self.model, &self.state);
        let (system, trial) = (&mut self.system, &mut self.trial);
        let Some(planes) = leans(model, &self.part, step, system, state, trial) else {
            return true;
        };
        self.summary.status = Status::NotConverged;
        self.summary.message = self.part.told_to_lean(&planes, &model.steps[step].name);
        recorder.note(&self.summary.message);
        false
    }
}

/// Planes that what is solved would leave, of those that it is held in: the first few of them that its stiffness does
/// not hold it in. Solids have their secant stiffness, joints that of their penalty. Under follower pressures, whose own
/// stiffness is not symmetric, it is not asked. The trial is begun anew.
fn leans(
    model: &Model,
    part: &Part,
    step: usize,
    system: &mut System,
    state: &State,
    trial: &mut Trial,
) -> Option<Vec<usize>> {
    let planes = part.planes.len();
    let mut loads = model.loads.iter().zip(&state.loads);
    let follows = loads.any(|(load, value)| {
        matches!(load.acts, LoadOn::Follower(_)) && value.iter().any(|v| *v != 0.0)
    });
    if planes == 0 || follows {
        return None;
    }
    let steered = system.steered.take();
    let springs = system.springs.stiffen(Vec::new());
    let mut asked = Asked {
        model,
        part,
        step,
        system,
        trial,
    };
    let mut sets = (1..1_usize << planes).map(|set| {
        let turned = (0..planes).filter(|p| set >> p & 1 != 0);
        turned.collect::<Vec<usize>>()
    });
    // What nothing holds that way even at rest, as a stone that may turn on its bed, neither stands nor falls.
    let leans = sets.find(|turned| {
        asked.gives_way(turned, state, NEUTRAL) && {
            let rest = asked.system.initial_state(model);
            !asked.gives_way(turned, &rest, -NEUTRAL)
        }
    });
    system.springs.stiffen(springs);
    system.steered = steered;
    leans
}

/// What is asked, and where it is worked out.
struct Asked<'a> {
    model: &'a Model,
    part: &'a Part,
    step: usize,
    system: &'a mut System,
    trial: &'a mut Trial,
}

impl Asked<'_> {
    /// Whether what goes the mirrored way beyond these planes is not held at a state, with `part_of_own` of the diagonal
    /// added.
    fn gives_way(&mut self, turned: &[usize], state: &State, part_of_own: f64) -> bool {
        let Self {
            model,
            part,
            step,
            system,
            trial,
        } = self;
        system.springs.stiffen(across(part, turned));
        if write(model, system, state, trial).is_none() {
            return false;
        }
        let (dofs, equations) = turned_over(model, part, *step, turned);
        let tried = system.try_factor(&dofs, &equations, trial, part_of_own);
        matches!(
            tried,
            Err(LinearError::NotPositiveDefinite { .. } | LinearError::Singular { .. })
        )
    }
}

/// Writes the stiffness of all cells at a state, as joints bear by their law; nothing if a law gives no answer.
fn write(model: &Model, system: &mut System, state: &State, trial: &mut Trial) -> Option<()> {
    system.start(model, trial, state);
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
        .ok()
}

/// Stiffness of springs on the mean of their nodes, which moves across one plane or not at all [N/mm]. `[spring][xyz]`
fn across(part: &Part, turned: &[usize]) -> Vec<[f64; 3]> {
    let springs = part.springs.iter().map(|stiffness| {
        let mut across = [0.0; 3];
        if let [p] = turned {
            let axis = part.planes[*p].axis;
            across[axis] = stiffness[axis];
        }
        across
    });
    springs.collect()
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
