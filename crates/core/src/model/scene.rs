//! The frozen model: mesh, laws, contact surfaces, supports and steps.

use super::Mesh;
use super::amplitude::{Amplitude, Branch};
use super::loads::Load;
use super::probes::Probe;
pub use super::surfaces::{ContactPoints, ContactSurfaces};
use crate::error::Warning;
use crate::experiment::Experiment;
use crate::material::LawOutput;

/// Everything that a run reads and nothing that it changes.
#[derive(Clone, Debug)]
pub struct Model {
    /// Title of the deck.
    pub title: String,
    /// The solids.
    pub mesh: Mesh,
    /// Materials by index.
    pub materials: Vec<NamedMaterial>,
    /// Element formulation, the same for all solids.
    pub formulation: Formulation,
    /// Contact surfaces and their laws.
    pub contact: ContactSurfaces,
    /// Groups of nodes that move together without rotating.
    pub beams: Vec<Beam>,
    /// Fixed nodes.
    pub supports: Vec<Support>,
    /// Velocity of each node when the first step with inertia begins [mm/s]; empty = rest. `[node]`
    pub initial_velocity: Vec<[f64; 3]>,
    /// Springs to the ground.
    pub springs: Vec<Spring>,
    /// Places that the history follows, a column each.
    pub probes: Vec<Probe>,
    /// Loads from outside with a name.
    pub loads: Vec<Load>,
    /// Steps, in order.
    pub steps: Vec<Step>,
    /// What is written, and how often.
    pub output: Output,
    /// What its author should know.
    pub warnings: Vec<Warning>,
    /// How much of the scene is computed.
    pub fidelity: Fidelity,
}

impl Model {
    /// Columns of the history beside those that every history has: the probes, then the loads, then the outputs of the
    /// laws of the solids.
    pub fn columns(&self) -> Vec<String> {
        let probes = self.probes.iter().map(|probe| probe.column.clone());
        let loads = self.loads.iter().flat_map(|load| load.columns.clone());
        let outputs = self.outputs().into_iter().map(|output| output.column());
        probes.chain(loads).chain(outputs).collect()
    }

    /// What the laws of the solids show, each name once; nothing where solids stay elastic.
    pub fn outputs(&self) -> Vec<LawOutput> {
        if self.fidelity == Fidelity::Elastic {
            return Vec::new();
        }
        let materials = self.materials.iter();
        LawOutput::once(materials.flat_map(|material| material.parameters.outputs()))
    }

    /// Whether inertia may act in any step: everything has mass, and a procedure may use it.
    pub fn may_move(&self) -> bool {
        let density = |m: &NamedMaterial| m.parameters.elastic().density;
        let used = |m: usize| self.mesh.material.iter().any(|&of| usize::from(of) == m);
        let massive = |(m, material)| !used(m) || density(material) > 0.0;
        self.steps.iter().any(|step| step.procedure.may_move())
            && self.materials.iter().enumerate().all(massive)
    }
}

/// How much of a scene is computed.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    /// What the rest does not tell: one half of what is its own mirror image, and no stiffness anew of what hardly turns.
    #[default]
    Auto,
    /// All of it.
    Full,
    /// As `Auto`, with solids that stay linear elastic: only joints open and slide.
    Elastic,
}

/// A material and its name in the deck.
#[derive(Clone, Debug)]
pub struct NamedMaterial {
    /// Name in the deck.
    pub name: String,
    /// Its parameters, tables as given (not yet scaled to an element's size).
    pub parameters: crate::material::MaterialParameters,
}

/// How the hex8 interpolates strain.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Deserialize,
    serde::Serialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Formulation {
    /// 2×2×2 points, displacement strains.
    Full,
    /// Constant dilatation.
    BBar,
    /// Wilson–Taylor incompatible modes, condensed elastically once.
    #[default]
    Incompatible,
}

/// Nodes that move as one, without rotation: the level loading beam of a test.
#[derive(Clone, Debug)]
pub struct Beam {
    /// Name in the deck.
    pub name: String,
    /// Nodes tied to the beam.
    pub nodes: Vec<u32>,
    /// Area over which pressure acts [mm²].
    pub area: f64,
    /// Outward normal of the face that carries the pressure.
    pub normal: [f64; 3],
}

/// Nodes held in some directions.
#[derive(Clone, Debug)]
pub struct Support {
    /// Name in the deck.
    pub name: String,
    /// Held nodes.
    pub nodes: Vec<u32>,
    /// Held directions x, y, z.
    pub fixed: [bool; 3],
    /// What holds them.
    pub by: HeldBy,
}

/// What holds the nodes of a [`Support`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum HeldBy {
    /// The ground.
    #[default]
    Ground,
    /// The plane of symmetry normal to `axis`.
    Plane {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// Where it stands on the axis [mm].
        at: f64,
    },
    /// That they are a mirror, which stands for the other half of a joint and belongs to no body.
    Mirror,
}

/// A spring from a group of nodes to a point of the ground, which steps may drive.
///
/// With ū the mean displacement of the nodes and e that of the driven end, direction by direction:
/// force k (e − ū), shared equally by the nodes, and energy ½ k (e − ū)². Stress-free at rest.
#[derive(Clone, Debug)]
pub struct Spring {
    /// Name in the deck.
    pub name: String,
    /// Nodes that it holds.
    pub nodes: Vec<u32>,
    /// Stiffness k along x, y, z; 0 = none in this direction [N/mm].
    pub stiffness: [f64; 3],
}

/// What happens to one direction of a beam during a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamMotion {
    /// Held where the step found it.
    Locked,
    /// Free, under a force that goes linearly from the last step's value to this one [N].
    Force(f64),
    /// Driven by this much during the step, linearly [mm].
    Driven(f64),
}

/// One step of the loading.
#[derive(Clone, Debug)]
pub struct Step {
    /// Name in the deck.
    pub name: String,
    /// Duration in step time [s]; the viscosity of the materials is measured in it.
    pub duration: f64,
    /// What each beam does in x, y, z. `[beam][direction]`
    pub motion: Vec<[BeamMotion; 3]>,
    /// The driven beam and its direction, for the history (force and displacement).
    pub driven: Option<(usize, usize)>,
    /// Sizes of the increments.
    pub increments: Increments,
    /// Viscosity of all damage-plastic solids in this step, where it is above their own [s].
    pub viscosity: f64,
    /// Procedure of this step.
    pub procedure: Procedure,
    /// Tangents of this step.
    pub tangent: Tangent,
    /// What steers the load, in [`Procedure::DisplacementControl`].
    pub control: Option<Control>,
    /// What ends the step before its loads are whole, if anything does.
    pub stop: Option<Stop>,
    /// When an increment counts as converged.
    pub tolerance: Tolerance,
    /// Acceleration of gravity during the step.
    pub gravity: Gravity,
    /// Acceleration of the ground, in which all displacements are measured.
    pub ground: GroundMotion,
    /// How far the far end of each spring moves during the step, linearly; empty = nowhere [mm].
    /// `[spring][xyz]`
    pub springs: Vec<[f64; 3]>,
    /// Value of each load at the end of the step, none where it stays as it is; empty = all stay.
    /// `[load]`
    pub loads: Vec<Option<[f64; 3]>>,
    /// Which part of all this acts when; evenly if none.
    pub amplitude: Option<Amplitude>,
}

impl Step {
    /// How many branches the amplitude has.
    pub fn branches(&self) -> usize {
        self.amplitude.as_ref().map_or(1, Amplitude::branches)
    }

    /// One of them.
    pub fn branch(&self, i: usize) -> Branch {
        let branch = |amplitude: &Amplitude| amplitude.branch(i);
        self.amplitude.as_ref().map_or(Branch::WHOLE, branch)
    }

    /// Fastest change of what is driven and loaded, over that of a step without an amplitude.
    pub fn steepest(&self) -> f64 {
        self.amplitude.as_ref().map_or(1.0, Amplitude::steepest)
    }

    /// Whether the drive or a load turns back.
    pub fn turns(&self) -> bool {
        self.amplitude.as_ref().is_some_and(|a| !a.rises())
    }
}

/// Acceleration of gravity during a step [mm/s²].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Gravity {
    /// None.
    #[default]
    None,
    /// The same throughout.
    Constant([f64; 3]),
    /// Linearly from nothing to this.
    Growing([f64; 3]),
    /// Turning evenly about an axis, as on a tilting table (seen from the table).
    Turning {
        /// Acceleration when the step begins [mm/s²].
        from: [f64; 3],
        /// Unit vector about which it turns, right-handed.
        axis: [f64; 3],
        /// Angle over the whole step [rad].
        angle: f64,
    },
}

impl Gravity {
    /// Acceleration at a fraction of the step, 0 to 1 [mm/s²].
    pub fn at(&self, fraction: f64) -> [f64; 3] {
        match self {
            Self::None => [0.0; 3],
            Self::Constant(g) => *g,
            Self::Growing(g) => g.map(|g| fraction * g),
            Self::Turning { from, axis, angle } => turned(*from, *axis, fraction * angle),
        }
    }
}

/// Rayleigh damping C = a M + b K₀ (Rayleigh 1877, §102), of the ratio a/(2ω) + bω/2 at ω. K₀ is the
/// elastic stiffness of the solids, turning with them; the interfaces have none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rayleigh {
    /// a [1/s].
    pub mass: f64,
    /// b [s].
    pub stiffness: f64,
}

/// Acceleration of the ground over the time since the step began, linear between its rows and zero
/// outside them.
///
/// Displacements and velocities are relative to the ground: on every mass acts −m a beside gravity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroundMotion {
    /// Rows of time [s], ascending, and acceleration [mm/s²]; empty = none. `[xyz][row]`
    pub acceleration: [Vec<[f64; 2]>; 3],
}

impl GroundMotion {
    /// Smallest mean distance of the rows of a record [s]; infinite without any.
    pub fn spacing(&self) -> f64 {
        let records = self.acceleration.iter().filter(|rows| rows.len() > 1);
        let spacing =
            |rows: &Vec<[f64; 2]>| (rows[rows.len() - 1][0] - rows[0][0]) / (rows.len() - 1) as f64;
        records.map(spacing).fold(f64::INFINITY, f64::min)
    }

    /// Acceleration at a time since the step began [mm/s²].
    pub fn at(&self, time: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| interpolate(&self.acceleration[i], time))
    }
}

/// Linear between the rows, zero outside.
fn interpolate(rows: &[[f64; 2]], time: f64) -> f64 {
    let after = rows.partition_point(|row| row[0] < time);
    match rows.get(after) {
        Some(&[t, a]) if t == time => a,
        Some(&[t, a]) if after > 0 => {
            let [from, start] = rows[after - 1];
            start + (a - start) * (time - from) / (t - from)
        }
        _ => 0.0,
    }
}

/// The vector v turned about a unit vector a by φ [rad] (Rodrigues):
/// v cos φ + a × v sin φ + a (a·v)(1 − cos φ).
pub(crate) fn turned(v: [f64; 3], a: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let along = (0..3).map(|i| a[i] * v[i]).sum::<f64>() * (1.0 - cos);
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let cross = a[j] * v[k] - a[k] * v[j];
        v[i] * cos + cross * sin + a[i] * along
    })
}

/// Sizes of increments, as fractions of the step's duration.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Increments {
    /// First.
    pub initial: f64,
    /// Largest.
    pub max: f64,
    /// Smallest: a cut below it ends the run.
    pub min: f64,
    /// Part of the largest force that may lie unseen between two increments at a peak, where a displacement is
    /// driven or steers the load.
    pub peak: f64,
}

/// How a step is solved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Procedure {
    /// [`Self::Static`] as long as that finds equilibrium; where it does not, the next of a ladder
    /// of procedures, until the trouble has passed.
    #[default]
    Auto,
    /// Newton's method on equilibrium, the load prescribed.
    Static,
    /// As static, plastic strain and damage of the solids extrapolated within the increment and
    /// updated at its end.
    Implex,
    /// Inertia carries the system over instabilities and backward Euler takes its motion out. The
    /// duration is real time.
    QuasiStatic,
    /// HHT-α (Hilber, Hughes, Taylor 1977) with Rayleigh damping. The duration is real time.
    Dynamic {
        /// α in [−1/3, 0]: 0 keeps all energy, −1/3 takes most out of what the increments do not
        /// resolve.
        alpha: f64,
        /// Damping.
        damping: Rayleigh,
    },
    /// Equilibrium at given distances along the path (Crisfield 1981): the load is an unknown.
    ArcLength,
    /// Equilibrium at given amounts of dissipated energy (Gutiérrez 2004): the load is an unknown.
    Dissipation,
    /// Equilibrium at given displacements of [`Step::control`]: the load is an unknown.
    DisplacementControl,
}

impl Procedure {
    /// Whether inertia acts throughout.
    pub fn has_inertia(self) -> bool {
        matches!(self, Self::QuasiStatic | Self::Dynamic { .. })
    }

    /// Whether inertia may act: throughout, or where the ladder comes to it.
    pub fn may_move(self) -> bool {
        self.has_inertia() || self == Self::Auto
    }
}

/// Which tangents the iterations take, and with them how the laws enter.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Deserialize,
    serde::Serialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Tangent {
    /// Secant stiffness of the solids, shifted penalty: symmetric and positive definite.
    #[default]
    Secant,
    /// Consistent tangent of the solids, shifted penalty.
    Consistent,
    /// Consistent tangents of solids and interfaces, the penalty taken directly: plain Newton on the
    /// law itself.
    Direct,
}

/// A displacement that steers the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Which of the model's probes measures it.
    pub probe: usize,
    /// How far it goes during the step [mm].
    pub displacement: f64,
}

/// What ends a driven step early; the increment that reaches it is its last.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Stop {
    /// Part of the largest force of this step, both along the drive, to which it falls [-].
    pub below_peak: Option<f64>,
    /// How far the step drives [mm].
    pub displacement: Option<f64>,
}

/// Convergence tolerances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Largest out-of-balance force over the mean nodal force [-].
    pub residual: f64,
    /// Newton iterations before the increment is cut.
    pub max_iterations: usize,
}

/// What is written, and how often.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// A frame of fields every so many increments (the last is always written).
    pub every: usize,
    /// Whether `run.mcap` is written.
    pub mcap: bool,
    /// A scene in `run.mcap` every so many frames of fields.
    pub scene_every: usize,
    /// What the run is compared with.
    pub experiment: Option<MeasuredCurve>,
}

impl Default for Output {
    fn default() -> Self {
        Self {
            every: 5,
            mcap: true,
            scene_every: 1,
            experiment: None,
        }
    }
}

/// A measured load-displacement curve and the file that holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredCurve {
    /// Name of the file, without its folder.
    pub file: String,
    /// The file as it is.
    pub text: String,
    /// What it says.
    pub curve: Experiment,
}
