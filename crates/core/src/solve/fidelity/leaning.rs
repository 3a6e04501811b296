//! Loss of symmetry of a half (docs/theory/symmetry.md, eqs 7 and 8): a wall that buckles out of its plane moves to
//! one side, which a half held in the plane cannot.
//!
//! Motion symmetric about a plane and motion antisymmetric about it are not coupled: the stiffness of a mirrored
//! scene falls into two blocks. The first is that of the half. The second has the same cells, but its nodes in the
//! plane are held along the plane instead of across, and its images have the opposite sign. If the second block is
//! not positive definite, the whole does not stay symmetric (Healey and Treacy, Int. J. Numer. Meth. Engng 31, 1991).

use super::part::Part;
use crate::assembly::dofs::{DofMap, Equations};
use crate::assembly::{System, Trial};
use crate::model::Model;
use crate::model::loads::LoadOn;
use crate::model::mesh::Reflected;
use crate::model::scene::{BeamMotion, HeldBy, Step, Support};
use crate::solve::Recorder;
use crate::solve::stability::{is_negative, write_stiffness};
use crate::solve::stepping::run::Run;
use crate::solve::stepping::step_run::StepRun;
use crate::state::QUIET;
use crate::state::State;
use crate::state::Status;

impl Run<'_> {
    /// Whether a solved part of the scene keeps the symmetry of the whole, where a step ends or its loads reverse. If
    /// not, the run ends here, because its results are not those of the whole.
    ///
    /// The check is skipped while bodies move and after something fell: its stiffness at rest does not tell whether
    /// it stands.
    pub(in crate::solve) fn keeps_symmetry(
        &mut self,
        step_run: &StepRun,
        recorder: &mut dyn Recorder,
    ) -> bool {
        let step = step_run.index;
        let moves =
            step_run.step.procedure.has_inertia() || step_run.fallback.method().has_inertia();
        moves || self.is_symmetric(step, recorder)
    }

    /// The same for the state of the last commit, whatever method comes next.
    pub(in crate::solve) fn is_symmetric(
        &mut self,
        step: usize,
        recorder: &mut dyn Recorder,
    ) -> bool {
        if self.state.fell || self.state.energies.moving() > QUIET {
            return true;
        }
        let (model, state) = (self.model, &self.state);
        let (system, trial) = (&mut self.system, &mut self.trial);
        let Some(planes) = symmetry_loss(model, &self.part, step, system, state, trial) else {
            return true;
        };
        self.summary.status = Status::NotConverged;
        self.summary.lost_symmetry = true;
        self.summary.message = self.part.symmetry_message(&planes, &model.steps[step].name);
        recorder.note(&self.summary.message);
        false
    }
}

/// Planes about which the solved part loses its symmetry: the first combination of its planes whose antisymmetric
/// stiffness is not positive definite; none if it keeps its symmetry. Solids have their secant stiffness, joints that
/// of their penalty. Follower pressures are not checked, because their stiffness is not symmetric. The trial is
/// restarted.
fn symmetry_loss(
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
    let rigid = system.let_deform();
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
    let symmetry_loss = sets.find(|turned| asked.gives_way(turned, state));
    system.springs.stiffen(springs);
    system.steered = steered;
    system.make_rigid(rigid);
    symmetry_loss
}

/// Arguments of the check, with its work space.
struct Asked<'a> {
    model: &'a Model,
    part: &'a Part,
    step: usize,
    system: &'a mut System,
    trial: &'a mut Trial,
}

impl Asked<'_> {
    /// Whether the stiffness against motion antisymmetric about the planes `turned` is not positive definite at a state.
    fn gives_way(&mut self, turned: &[usize], state: &State) -> bool {
        let Self {
            model,
            part,
            step,
            system,
            trial,
        } = self;
        system.springs.stiffen(across(part, turned));
        if write_stiffness(model, system, state, trial).is_none() {
            return false;
        }
        let (dofs, equations) = turned_over(model, part, *step, turned);
        is_negative(system, (&dofs, &equations), trial)
    }
}

/// Stiffness of springs on the mean of their nodes against antisymmetric motion, which is across one plane or zero
/// [N/mm]. `[spring][xyz]`
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

/// Unknowns of motion antisymmetric about the planes `turned`.
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
    // In antisymmetric motion a level beam moves across one plane, or not at all.
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
