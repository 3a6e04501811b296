//! One converged increment, as rows and fields.

use crate::model::sizes::Sizes;
use nalgebra::Vector6;
use wythe_contact::{InterfaceHistory, InterfaceLaw, JointLaw};

use crate::model::Model;
use crate::model::mirrored::MirrorPlane;
use crate::solve::{Checkpoint, Method, State};
use crate::sym6;

/// One row of `history.csv`. Field names are the column names.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[allow(non_snake_case)]
pub struct HistoryRow {
    /// Increment, from 1 over all steps.
    pub increment: usize,
    /// Step, from 0.
    pub step: usize,
    /// Step time, accumulated over all steps [s].
    pub time: f64,
    /// Displacement of the driven beam in the driven direction [mm].
    pub displacement_mm: f64,
    /// Force on the driven beam in the driven direction [kN].
    pub force_kN: f64,
    /// Force on the driven beam normal to its face, compression positive [kN].
    pub reaction_kN: f64,
    /// Linear solves of this increment.
    pub iterations: usize,
    /// Cut-backs of this increment.
    pub cutbacks: usize,
    /// Work of reactions, loads, gravity and the ground since the start, and the energy of initial
    /// velocities [J].
    pub external_work_J: f64,
    /// Elastic energy of solids and interfaces now [J].
    pub elastic_energy_J: f64,
    /// Plastic work and damage of the solids since the start [J].
    pub plastic_damage_dissipation_J: f64,
    /// Dissipation of the interfaces since the start [J].
    pub interface_dissipation_J: f64,
    /// Viscous dissipation since the start [J].
    pub viscous_dissipation_J: f64,
    /// Contact points that are open.
    pub open_points: usize,
    /// Contact points that slid in this increment.
    pub sliding_points: usize,
    /// Largest interface damage D [-].
    pub max_interface_damage: f64,
    /// Largest tensile damage of the solids [-].
    pub max_tensile_damage: f64,
    /// Largest compressive damage of the solids [-].
    pub max_compressive_damage: f64,
    /// Largest out-of-balance force at commit, all laws implicit, over the mean nodal force [-].
    pub out_of_balance: f64,
    /// Largest out-of-balance force of the equations that were solved, over the mean nodal force:
    /// what the tolerance refers to [-].
    pub residual: f64,
    /// Kinetic energy now, relative to the ground [J].
    pub kinetic_energy_J: f64,
    /// Work of the Rayleigh damping and of the dashpots of relaxations since the start [J].
    pub damping_dissipation_J: f64,
    /// What the time integration has taken out since the start [J].
    pub numerical_dissipation_J: f64,
    /// Area of the contact points that press, at rest [mm²].
    pub contact_area_mm2: f64,
    /// Part of the step's loads and displacements that act now [-].
    pub load_factor: f64,
    /// What solved the increment.
    pub procedure: Method,
    /// Values of the model's probes, then of its loads: columns of their own after these, see
    /// [`Model::columns`](crate::model::Model::columns).
    #[serde(skip)]
    pub probes: Vec<f64>,
    /// Forces from outside: on each beam, then on each support, then those of each load [N]; in
    /// `results.vtkhdf` only. `[beam, support, load][xyz]`
    #[serde(skip)]
    pub reactions: Vec<[f64; 3]>,
}

impl HistoryRow {
    /// What solids and interfaces have taken: elastic energy and dissipations [J].
    #[expect(non_snake_case, reason = "J is the unit")]
    pub fn taken_J(&self) -> f64 {
        self.elastic_energy_J
            + self.plastic_damage_dissipation_J
            + self.interface_dissipation_J
            + self.viscous_dissipation_J
    }
}

/// Fields of one output increment.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Accumulated step time [s].
    pub time: f64,
    /// Increments done.
    pub increment: usize,
    /// Step, from 0.
    pub step: usize,
    /// Displacement [mm]. `[node][xyz]`
    pub displacement: Vec<[f64; 3]>,
    /// Velocity [mm/s]; empty where no step could have inertia. `[node][xyz]`
    pub velocity: Vec<[f64; 3]>,
    /// Nominal stress, mean over the element's points [MPa]. `[element][xx,yy,zz,xy,yz,zx]`
    pub stress: Vec<[f64; 6]>,
    /// Tensile damage, largest over the element's points [-]. `[element]`
    pub tensile_damage: Vec<f64>,
    /// Compressive damage, largest over the element's points [-]. `[element]`
    pub compressive_damage: Vec<f64>,
    /// Plastic strain, mean over the element's points [-], engineering shear. `[element][xx,yy,zz,xy,yz,zx]`
    pub plastic_strain: Vec<[f64; 6]>,
    /// Whether any point of the element has plastic strain or damage. `[element]`
    pub yielded: Vec<bool>,
    /// Width of the crack band (l_eq, or its own) times the largest principal inelastic strain of the element's tensile cracks, mean over its
    /// points [mm]. `[element]`
    pub crack_width: Vec<f64>,
    /// What the points of the interfaces do.
    pub interfaces: InterfaceFrame,
    /// Forces from outside: on each beam, then on each support, then those of each load [N].
    /// `[beam, support, load][xyz]`
    pub reactions: Vec<[f64; 3]>,
    /// Values of the model's probes and loads, see [`Model::columns`]. `[column]`
    pub probes: Vec<f64>,
}

impl Frame {
    /// Principal nominal stresses, the largest first [MPa]. `[element][3]`
    pub fn principal_stresses(&self) -> Vec<[f64; 3]> {
        let of = |stress: &[f64; 6]| sym6::principal_values(&Vector6::from(*stress));
        self.stress.iter().map(of).collect()
    }
}

/// What the points of the interfaces do at one output increment. `[slave facet][point]`, four points to
/// a facet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InterfaceFrame {
    /// Opening u, closed negative [mm].
    pub opening: Vec<f64>,
    /// Slip δ along the facet's two tangents [mm].
    pub slip: Vec<[f64; 2]>,
    /// Traction [σ, τ₁, τ₂], tension positive [MPa].
    pub traction: Vec<[f64; 3]>,
    /// Damage D [-].
    pub damage: Vec<f64>,
    /// What has become of the bond.
    pub state: Vec<InterfaceState>,
    /// Further fields by the names that the joint laws give them; NaN at points of other laws. `[field]` (name, `[point]`)
    pub outputs: Vec<(String, Vec<f64>)>,
}

/// What has become of a point of an interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum InterfaceState {
    /// No damage; of a dry joint: pressed, and not sliding.
    #[default]
    Intact = 0,
    /// Damaged, with cohesion left.
    Softening = 1,
    /// Without cohesion, and open.
    FailedOpen = 2,
    /// Without cohesion, pressed: friction is left.
    FailedSliding = 3,
}

impl InterfaceState {
    /// Of a point with this opening [mm] and damage under `law`.
    pub fn of(law: &InterfaceLaw, history: &InterfaceHistory) -> Self {
        let open = history.traction[0] >= 0.0 && history.opening > 0.0;
        let failed = history.damage >= FAILED || law.is_dry();
        match (failed, open) {
            (true, true) => Self::FailedOpen,
            (true, false) if law.is_dry() && history.slip_max == 0.0 => Self::Intact,
            // Its slip is the other side's too: nothing slides on anything.
            (true, false) if law.is_dry() && law.is_half() => Self::Intact,
            (true, false) => Self::FailedSliding,
            (false, _) if history.damage > 0.0 => Self::Softening,
            (false, _) => Self::Intact,
        }
    }

    /// From its number in the files.
    pub fn from_number(number: u8) -> Option<Self> {
        [
            Self::Intact,
            Self::Softening,
            Self::FailedOpen,
            Self::FailedSliding,
        ]
        .into_iter()
        .find(|state| *state as u8 == number)
    }
}

/// Damage from which a point counts as failed: exponential softening reaches 1 only where it is cut
/// off.
const FAILED: f64 = 0.99;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// All steps done.
    Completed,
    /// Statics found no equilibrium, inertia took over, and bodies fell: there is none.
    Collapsed,
    /// Convergence was lost; everything before is kept.
    NotConverged,
    /// Stopped by the user after a whole increment.
    Interrupted,
}

/// Bodies that move under inertia, to which `auto` went over because statics found no equilibrium.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[allow(non_snake_case)]
pub struct Fall {
    /// Step in which inertia took over, from 0.
    pub step: usize,
    /// Its name in the deck.
    pub step_name: String,
    /// Part of that step's loads and displacements at the last equilibrium [-].
    pub load_factor: f64,
    /// Kinetic energy at the end [J].
    pub kinetic_energy_J: f64,
    /// Bodies that moved most, those that moved farther than half as far; the farthest first.
    pub bodies: Vec<FallenBody>,
}

/// A body that moved under inertia.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FallenBody {
    /// Name in the deck.
    pub name: String,
    /// Its number, as `unit` of the fields.
    pub unit: u32,
    /// Mean displacement since the last equilibrium [mm].
    pub moved_mm: f64,
    /// Its part along gravity [mm].
    pub fall_mm: f64,
}

/// Where convergence was lost, and why.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Lost {
    /// Where, in words: load factor, step and its name.
    pub place: String,
    /// What was not found.
    pub why: String,
}

/// What `solve` returns when it ends: everything of `summary.json` that the solver knows.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// How it ended.
    pub status: Status,
    /// Where, why and what to try, if it did not complete.
    pub message: String,
    /// What moved under inertia when it ended, if that took over from statics.
    pub fall: Option<Fall>,
    /// Where convergence was lost, if it was.
    pub lost: Option<Lost>,
    /// Sizes of the model.
    pub sizes: Sizes,
    /// Planes that the model is mirrored by, if one half of it was solved; two of a quarter.
    #[serde(skip)]
    pub mirror_planes: Vec<MirrorPlane>,
    /// Converged increments.
    pub increments: usize,
    /// Linear solves.
    pub iterations: usize,
    /// Cut-backs.
    pub cutbacks: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// How many of them the branches of the matrix without a change saved, by their operations.
    pub reused: f64,
    /// Solves of regions by themselves, between those of the whole.
    pub local_solves: usize,
    /// Evaluations of all forces, those of the line search among them.
    pub evaluations: usize,
    /// CPU-independent wall seconds by phase: elements, contact, assembly, factorise, solve, output.
    pub seconds_by_phase: [f64; 6],
    /// Threads used.
    pub threads: usize,
    /// Warnings of the run (those of the model are the checker's).
    pub warnings: Vec<String>,
    /// Where the procedure changed, and why.
    pub log: Vec<String>,
}

impl Summary {
    /// Of a run that has done nothing yet; complete, if nothing happens to it.
    pub fn begun(sizes: Sizes, threads: usize) -> Self {
        Self {
            status: Status::Completed,
            message: String::new(),
            fall: None,
            lost: None,
            sizes,
            mirror_planes: Vec::new(),
            increments: 0,
            iterations: 0,
            cutbacks: 0,
            factorisations: 0,
            reused: 0.0,
            local_solves: 0,
            evaluations: 0,
            seconds_by_phase: [0.0; 6],
            threads,
            warnings: Vec::new(),
            log: Vec::new(),
        }
    }
}

/// Receives each converged increment as it comes, on the thread that solves.
pub trait Recorder: Send {
    /// Called once an increment is committed. `frame` is given at output increments. Returning
    /// `Ok(false)` asks the run to stop there ([`Status::Interrupted`]).
    ///
    /// # Errors
    /// Input/output failures, which end the run.
    fn take(
        &mut self,
        model: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool>;

    /// Called once an increment is committed, before [`Recorder::take`], with all that the run knows:
    /// histories of every point, pairs of contact, energies; of a scene of which one half is solved, those of the half.
    /// Default: nothing.
    fn observe(&mut self, _state: &State) {}

    /// Called after [`Recorder::take`], once everything is ready for the next increment: `make` gives
    /// what [`crate::solve::resume`] goes on from. `last` if no increment follows: the steps are done,
    /// or the recorder asked to stop. Default: nothing.
    ///
    /// # Errors
    /// Input/output failures, which end the run.
    fn checkpoint(&mut self, _last: bool, _make: &dyn Fn() -> Checkpoint) -> std::io::Result<()> {
        Ok(())
    }

    /// Called where the procedure changes, with the reason. Default: nothing.
    fn note(&mut self, _text: &str) {}

    /// Called after each linear solve of an increment that begins at `time` [s], with their number,
    /// those of refused attempts among them. For the terminal; default: nothing.
    fn progress(&mut self, _step: usize, _time: f64, _iterations: usize) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use wythe_contact::{CohesiveFrictional, Coupling};

    /// A joint cut at its middle opens and closes, and slides freely: that is not damage.
    #[test]
    fn slip_along_a_plane_of_symmetry_leaves_the_bond() {
        for coupling in [Coupling::Max, Coupling::Additive] {
            let whole = CohesiveFrictional {
                f_t: 0.2,
                c: 0.3,
                u_k: 0.36,
                delta_k: 0.4,
                zeta: 4.38,
                xi: 1.1,
                coupling,
                ..CohesiveFrictional::dry(0.75, 100.0, 40.0)
            };
            let law = whole.half();
            let u_0 = law.f_t / law.normal_stiffness;
            let after = |opening: f64| {
                let first = law.update([0.5 * opening, 0.1, 0.0], &law.virgin()).history;
                law.update([opening, 0.3, 0.0], &first).history
            };
            for held in [-0.01, 0.5 * u_0] {
                let history = after(held);
                assert_eq!(history.damage, 0.0, "{coupling:?}");
                assert_eq!(
                    InterfaceState::of(&law.into(), &history),
                    InterfaceState::Intact
                );
            }
            let history = after(2.0 * u_0);
            let (expected, _) = law.opening_curve().evaluate(u_0);
            // Rounding of an exponential.
            assert!((history.damage - expected).abs() < 1e-14, "{coupling:?}");
            assert_eq!(
                InterfaceState::of(&law.into(), &history),
                InterfaceState::Softening
            );
        }
        let law = CohesiveFrictional::dry(0.6, 50.0, 20.0).half();
        let pressed = law.update([-0.01, 0.1, 0.0], &law.virgin()).history;
        assert!(pressed.slip_max > 0.0);
        assert_eq!(
            InterfaceState::of(&law.into(), &pressed),
            InterfaceState::Intact
        );
        let open = law.update([0.01, 0.1, 0.0], &law.virgin()).history;
        assert_eq!(
            InterfaceState::of(&law.into(), &open),
            InterfaceState::FailedOpen
        );
    }
}
