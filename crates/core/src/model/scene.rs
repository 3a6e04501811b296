//! The frozen model: mesh, laws, contact surfaces, supports. Its steps are in `steps`.

use super::Mesh;
use super::floors::Floor;
use super::loads::Load;
use super::probes::Probe;
use super::reactions;
use super::sections::Section;
pub(crate) use super::steps::turned;
pub use super::steps::{
    BeamMotion, Control, Driven, Gravity, GroundMotion, Increments, Procedure, Rayleigh, Step,
    Stop, Tangent, Tolerance,
};
pub use super::surfaces::{ContactPoints, ContactSurfaces};
use super::ties::Tie;
use crate::element::Formulation;
use crate::error::Warning;
use crate::experiment::Experiment;
use crate::material::LawOutput;

/// All data that a run reads and does not change.
#[derive(Clone, Debug)]
// More than 15 fields: all parts of a scene.
pub struct Model {
    /// Title of the deck.
    pub title: String,
    /// Solids.
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
    /// Velocity of each node when the first step with inertia begins [mm/s]. Empty: rest. `[node]`
    pub initial_velocity: Vec<[f64; 3]>,
    /// Springs to the ground.
    pub springs: Vec<Spring>,
    /// Ties, with two columns of the history each.
    pub ties: Vec<Tie>,
    /// Floors: masses beside those of the solids.
    pub floors: Vec<Floor>,
    /// Whether the deck asks for a limit analysis, so that no steps are to be run.
    pub limit_only: bool,
    /// Names of the bodies that are layers on others.
    pub layers: Vec<String>,
    /// Probes, with a column of the history each.
    pub probes: Vec<Probe>,
    /// Sections, with six columns of the history each.
    pub sections: Vec<Section>,
    /// Named external loads.
    pub loads: Vec<Load>,
    /// Steps, in order.
    pub steps: Vec<Step>,
    /// Output settings.
    pub output: Output,
    /// Warnings for the author of the model.
    pub warnings: Vec<Warning>,
    /// What named materials and joints took from the catalogue, a sentence each.
    pub assumed: Vec<String>,
    /// Part of the scene that is computed.
    pub fidelity: Fidelity,
}

impl Model {
    /// A model without parts: incompatible modes, every increment written, fidelity `auto`.
    pub fn empty(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            mesh: Mesh::default(),
            materials: Vec::new(),
            formulation: Formulation::Incompatible,
            contact: ContactSurfaces::default(),
            beams: Vec::new(),
            supports: Vec::new(),
            initial_velocity: Vec::new(),
            springs: Vec::new(),
            ties: Vec::new(),
            floors: Vec::new(),
            limit_only: false,
            layers: Vec::new(),
            probes: Vec::new(),
            sections: Vec::new(),
            loads: Vec::new(),
            steps: Vec::new(),
            output: Output {
                every: 1,
                ..Output::default()
            },
            warnings: Vec::new(),
            assumed: Vec::new(),
            fidelity: Fidelity::Auto,
        }
    }

    /// Columns of the history after those that every history has: the probes, the loads, the outputs of the laws of the
    /// solids, the ties, the base shear and the reactions of the supports, the sections.
    pub fn columns(&self) -> Vec<String> {
        let probes = self.probes.iter().map(|probe| probe.column.clone());
        let loads = self.loads.iter().flat_map(|load| load.columns.clone());
        let outputs = self.outputs().into_iter().map(|output| output.column());
        let ties = self.ties.iter().flat_map(|tie| Tie::columns(&tie.name));
        let supports = self.supports_on_ground().map(|(_, support)| support);
        let reactions = reactions::columns(supports.map(|s| (s.name.as_str(), s.fixed)));
        let sections = self.sections.iter();
        let sections = sections.flat_map(|s| Section::columns(&s.name, &s.directions));
        let of_solver = probes.chain(loads).chain(outputs).chain(ties);
        of_solver.chain(reactions).chain(sections).collect()
    }

    /// What the laws of the solids show, each name once; nothing where solids stay elastic.
    pub fn outputs(&self) -> Vec<LawOutput> {
        if self.fidelity == Fidelity::Elastic {
            return Vec::new();
        }
        let materials = self.materials.iter();
        LawOutput::once(materials.flat_map(|material| material.parameters.outputs()))
    }

    /// Whether inertia may act in any step: all materials have mass, and a procedure may use inertia.
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
    /// Less work at the same tolerance: mirror halves and regions are solved, stiffness and factors are reused.
    #[default]
    Auto,
    /// The whole scene, without these savings.
    Full,
    /// As `Auto`, with solids that stay linear elastic: only joints open and slide.
    Elastic,
}

/// A material and its name in the deck.
#[derive(Clone, Debug)]
pub struct NamedMaterial {
    /// Name in the deck.
    pub name: String,
    /// Its parameters, with tables as given, not yet scaled to the size of an element.
    pub parameters: crate::material::MaterialParameters,
    /// Whether units of this material are rigid bodies. Those that cannot be, such as units tied to a beam, are solids
    /// with these parameters.
    pub rigid: bool,
}

/// Nodes that move as one without rotation: the level loading beam of a test.
#[derive(Clone, Debug)]
pub struct Beam {
    /// Name in the deck.
    pub name: String,
    /// Nodes tied to the beam.
    pub nodes: Vec<u32>,
    /// Area under pressure [mm²].
    pub area: f64,
    /// Outward normal of the face under pressure.
    pub normal: [f64; 3],
    /// Part of the beam's displacement that each node makes: the shape of a settlement; empty if all move alike.
    /// `[node of the beam]`
    pub shape: Vec<f64>,
    /// Nodes that do not follow the beam along an axis (0, 1, 2): rigid units on ground that settles are held along it in
    /// their middle only, because its slope would stretch them. Empty for faces.
    pub free: Vec<(u32, usize)>,
    /// Depth of a loading beam below these nodes, which are its top [mm]; 0 of a face.
    pub depth: f64,
}

impl Beam {
    /// Whether it is ground that moves by a shape, not a face that moves as one.
    pub fn settles(&self) -> bool {
        !self.shape.is_empty()
    }
}

/// Nodes fixed in some directions.
#[derive(Clone, Debug)]
pub struct Support {
    /// Name in the deck.
    pub name: String,
    /// Fixed nodes.
    pub nodes: Vec<u32>,
    /// Fixed directions x, y, z.
    pub fixed: [bool; 3],
    /// Origin of the support.
    pub by: HeldBy,
}

/// Origin of a [`Support`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum HeldBy {
    /// The ground.
    #[default]
    Ground,
    /// The plane of symmetry normal to `axis`.
    Plane {
        /// 0, 1, 2 for x, y, z.
        axis: usize,
        /// Its coordinate on the axis [mm].
        at: f64,
    },
    /// The nodes are a mirror: they represent the other half of a joint and belong to no body.
    Mirror,
}

/// A spring from a group of nodes to a point of the ground that steps may drive.
///
/// ū is the mean displacement of the nodes and e that of the driven end. In each direction the force is k (e − ū),
/// shared equally by the nodes, and the energy is ½ k (e − ū)². The spring is free of stress at rest.
#[derive(Clone, Debug)]
pub struct Spring {
    /// Name in the deck.
    pub name: String,
    /// Nodes of the group.
    pub nodes: Vec<u32>,
    /// Stiffness k along x, y, z [N/mm]. 0: no spring in this direction.
    pub stiffness: [f64; 3],
}

/// Output settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Increments between frames of fields. The last increment is always written.
    pub every: usize,
    /// Whether `run.mcap` is written.
    pub mcap: bool,
    /// Frames of fields between scenes in `run.mcap`.
    pub scene_every: usize,
    /// Measured curve for comparison.
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

/// A measured load-displacement curve and its file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredCurve {
    /// Name of the file, without its folder.
    pub file: String,
    /// Text of the file.
    pub text: String,
    /// Curve in the file.
    pub curve: Experiment,
}
