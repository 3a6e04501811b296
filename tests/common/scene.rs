//! Scenes of blocks, built in memory: a grid of hex8 per block, faces, beams, steps.

use wythe::contact::{InterfaceHistory, InterfaceLaw};
use wythe::deck::Deck;
use wythe::element::Formulation;
pub use wythe::element::hexahedron::Face;
use wythe::material::{ElasticParameters, MaterialParameters};
use wythe::model::general::GeneralContact;
use wythe::model::scene::{
    Beam, BeamMotion, ContactPoints, ContactSurfaces, Fidelity, Gravity, GroundMotion, HeldBy,
    Increments, NamedMaterial, Output, Procedure, Rayleigh, Step, Support, Tangent, Tolerance,
};
use wythe::model::{Mesh, Model};
use wythe::solve::Recorder;
use wythe::state::State;
use wythe::state::{Frame, HistoryRow, Status, Summary};

/// Gravity [mm/s²].
pub const G: f64 = 9810.0;
/// Density of the blocks that move [tonne/mm³].
pub const DENSITY: f64 = 2e-9;

/// A procedure and its tangents.
pub type How = (Procedure, Tangent);
/// Newton's method with the secant stiffness of the solids.
pub const SECANT: How = (Procedure::Static, Tangent::Secant);
/// The same with extrapolated solids.
pub const IMPLEX: How = (Procedure::Implex, Tangent::Secant);
/// Newton's method with consistent tangents and the shifted penalty.
pub const CONSISTENT: How = (Procedure::Static, Tangent::Consistent);
/// Newton's method on the law itself.
pub const DIRECT: How = (Procedure::Static, Tangent::Direct);

/// A block of a scene: its grid of nodes.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    body: u32,
    first: u32,
    cells: [usize; 3],
    material: u16,
}

impl Block {
    fn node(&self, [i, j, k]: [usize; 3]) -> u32 {
        let [a, b, _] = self.cells;
        self.first + (i + (a + 1) * (j + (b + 1) * k)) as u32
    }

    /// All nodes.
    pub fn nodes(&self) -> Vec<u32> {
        let count = self.cells.iter().map(|c| c + 1).product::<usize>() as u32;
        (self.first..self.first + count).collect()
    }

    /// Facets of a face, counter-clockwise from outside.
    pub fn facets(&self, face: Face) -> Vec<[u32; 4]> {
        // Normal axis, its two others in right-handed order, and the side.
        let (axis, high) = match face {
            Face::Left => (0, false),
            Face::Right => (0, true),
            Face::Front => (1, false),
            Face::Back => (1, true),
            Face::Bottom => (2, false),
            Face::Top => (2, true),
        };
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut facets = Vec::new();
        for b in 0..self.cells[v] {
            for a in 0..self.cells[u] {
                let mut facet = [(a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1)].map(|(a, b)| {
                    let mut at = [0; 3];
                    at[axis] = if high { self.cells[axis] } else { 0 };
                    (at[u], at[v]) = (a, b);
                    self.node(at)
                });
                if !high {
                    facet.swap(1, 3);
                }
                facets.push(facet);
            }
        }
        facets
    }

    /// Nodes of a face.
    pub fn face(&self, face: Face) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.facets(face).into_iter().flatten().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Node nearest the origin of the block.
    pub fn corner(&self) -> u32 {
        self.first
    }

    /// Elements of the block in the mesh.
    pub fn elements<'m>(&self, mesh: &'m Mesh) -> impl Iterator<Item = usize> + 'm {
        let body = self.body;
        (0..mesh.elements.len()).filter(move |&e| mesh.unit[e] == body)
    }
}

/// A model without bodies.
pub fn empty() -> Model {
    Model {
        title: String::new(),
        mesh: Mesh::default(),
        materials: Vec::new(),
        formulation: Formulation::Incompatible,
        contact: ContactSurfaces::default(),
        beams: Vec::new(),
        supports: Vec::new(),
        initial_velocity: Vec::new(),
        springs: Vec::new(),
        probes: Vec::new(),
        loads: Vec::new(),
        steps: Vec::new(),
        warnings: Vec::new(),
        fidelity: Fidelity::Full,
        output: Output {
            every: 1,
            ..Output::default()
        },
    }
}

/// Linear elastic solid.
pub fn elastic(e: f64, nu: f64) -> MaterialParameters {
    MaterialParameters::Elastic(ElasticParameters {
        E: e,
        nu,
        density: 0.0,
    })
}

/// Linear elastic solid with mass [tonne/mm³].
pub fn heavy(e: f64, nu: f64, density: f64) -> MaterialParameters {
    MaterialParameters::Elastic(ElasticParameters { E: e, nu, density })
}

/// Adds a block with its lower corner at `low`, cut into `cells`.
pub fn block(
    model: &mut Model,
    low: [f64; 3],
    size: [f64; 3],
    cells: [usize; 3],
    material: &MaterialParameters,
) -> Block {
    let body = model.mesh.unit.iter().max().map_or(0, |u| u + 1);
    let index = model.materials.len() as u16;
    model.materials.push(NamedMaterial {
        name: format!("block {body}"),
        parameters: material.clone(),
    });
    let block = Block {
        body,
        first: model.mesh.nodes.len() as u32,
        cells,
        material: index,
    };
    let [a, b, c] = cells;
    for k in 0..=c {
        for j in 0..=b {
            for i in 0..=a {
                let at = [i, j, k];
                let x = [0, 1, 2].map(|d| low[d] + size[d] * at[d] as f64 / cells[d] as f64);
                model.mesh.nodes.push(x);
            }
        }
    }
    for k in 0..c {
        for j in 0..b {
            for i in 0..a {
                let ring = [(0, 0), (1, 0), (1, 1), (0, 1)];
                let mut nodes = [0; 8];
                for (n, (di, dj)) in ring.into_iter().enumerate() {
                    nodes[n] = block.node([i + di, j + dj, k]);
                    nodes[n + 4] = block.node([i + di, j + dj, k + 1]);
                }
                model.mesh.elements.push(nodes);
                model.mesh.material.push(index);
                model.mesh.unit.push(body);
                model.mesh.course.push(0);
            }
        }
    }
    block
}

/// Makes a face the slave side under `law`.
pub fn slave(model: &mut Model, block: &Block, face: Face, law: impl Into<InterfaceLaw>) {
    let contact = &mut model.contact;
    contact.laws.push(law.into());
    contact.law_names.push("joint".to_owned());
    for facet in block.facets(face) {
        contact.slave_facets.push(facet);
        contact.slave_body.push(block.body);
        contact.slave_law.push(contact.laws.len() as u16 - 1);
    }
}

/// Makes a face the master side.
pub fn master(model: &mut Model, block: &Block, face: Face) {
    for facet in block.facets(face) {
        model.contact.master_facets.push(facet);
        model.contact.master_body.push(block.body);
    }
}

/// Lets every body meet every other: a dry law of 500 E/h.
pub fn general(model: &mut Model, mu: f64) {
    let of = GeneralContact::new("dry", &model.mesh, &model.materials, mu, 500.0, None);
    model.contact.general = Some(of);
}

/// Gives a block a velocity [mm/s].
pub fn throw(model: &mut Model, block: &Block, velocity: [f64; 3]) {
    model
        .initial_velocity
        .resize(model.mesh.nodes.len(), [0.0; 3]);
    for n in block.nodes() {
        model.initial_velocity[n as usize] = velocity;
    }
}

/// Turns a block about a point by an angle [rad] about a unit axis.
pub fn turn(model: &mut Model, block: &Block, about: [f64; 3], axis: [f64; 3], angle: f64) {
    let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::from(axis));
    let rotation = nalgebra::Rotation3::from_axis_angle(&axis, angle);
    let centre = nalgebra::Vector3::from(about);
    for n in block.nodes() {
        let x = nalgebra::Vector3::from(model.mesh.nodes[n as usize]) - centre;
        model.mesh.nodes[n as usize] = (centre + rotation * x).into();
    }
}

/// Holds nodes.
pub fn hold(model: &mut Model, nodes: Vec<u32>, fixed: [bool; 3]) {
    model.supports.push(Support {
        name: "support".to_owned(),
        nodes,
        fixed,
        by: HeldBy::Ground,
    });
}

/// Ties nodes to a level beam; returns its index.
pub fn beam(model: &mut Model, nodes: Vec<u32>) -> usize {
    model.beams.push(Beam {
        name: "beam".to_owned(),
        nodes,
        area: 1.0,
        normal: [0.0, 0.0, 1.0],
    });
    model.beams.len() - 1
}

/// A step in which beam 0 moves so and all increments are equal; change what differs.
pub fn step(motion: [BeamMotion; 3], driven: usize, increments: usize, tolerance: f64) -> Step {
    let size = 1.0 / increments as f64;
    Step {
        name: "step".to_owned(),
        duration: 1.0,
        motion: vec![motion],
        driven: Some((0, driven)),
        increments: Increments {
            initial: size,
            max: size,
            min: 1e-3 * size,
            peak: 1.0,
        },
        viscosity: 0.0,
        procedure: Procedure::Static,
        tangent: Tangent::Consistent,
        control: None,
        stop: None,
        tolerance: Tolerance {
            residual: tolerance,
            max_iterations: 60,
        },
        gravity: Gravity::None,
        ground: GroundMotion::default(),
        springs: Vec::new(),
        loads: Vec::new(),
        amplitude: None,
    }
}

/// A step of `duration` [s] in which nothing acts but gravity.
pub fn left_alone(gravity: Gravity, duration: f64, increments: usize, tolerance: f64) -> Step {
    Step {
        duration,
        motion: Vec::new(),
        driven: None,
        gravity,
        tangent: Tangent::Secant,
        ..step([BeamMotion::Locked; 3], 0, increments, tolerance)
    }
}

/// The same with HHT-α.
pub fn set_free(
    gravity: Gravity,
    duration: f64,
    increments: usize,
    tolerance: f64,
    alpha: f64,
) -> Step {
    Step {
        procedure: Procedure::Dynamic {
            alpha,
            damping: Rayleigh::default(),
        },
        ..left_alone(gravity, duration, increments, tolerance)
    }
}

/// Where the points of contact sit.
pub fn points(model: &mut Model, points: ContactPoints) {
    model.contact.points = points;
}

/// Everything that a run committed.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    pub rows: Vec<HistoryRow>,
    pub frames: Vec<Frame>,
    pub states: Vec<State>,
}

impl Recorder for Recording {
    fn take(
        &mut self,
        _: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        self.rows.push(row.clone());
        self.frames.extend(frame.cloned());
        Ok(true)
    }

    fn observe(&mut self, state: &State) {
        self.states.push(state.clone());
    }
}

/// Runs a model and keeps every commit.
pub fn run(model: &Model) -> (Recording, Summary) {
    let mut recording = Recording::default();
    let summary = wythe::solve::run(model, &mut recording).expect("the model can be run");
    (recording, summary)
}

/// Runs a model to its end.
pub fn completed(model: &Model) -> Recording {
    let (recording, summary) = run(model);
    println!(
        "{} increments, {} solves, {} cuts",
        summary.increments, summary.iterations, summary.cutbacks
    );
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    recording
}

/// The history of a deck that runs to its end.
pub fn rows(deck: &Deck) -> Vec<HistoryRow> {
    let (model, _) = Model::from_deck(deck).unwrap_or_else(|e| panic!("{e}"));
    completed(&model).rows
}

/// W − (E + T + ΣD), what the energies of a row lack [J].
pub fn gap(row: &HistoryRow) -> f64 {
    row.external_work_J
        - row.elastic_energy_J
        - row.kinetic_energy_J
        - row.plastic_damage_dissipation_J
        - row.interface_dissipation_J
        - row.viscous_dissipation_J
        - row.damping_dissipation_J
        - row.numerical_dissipation_J
}

/// Largest value over a run, at least 0.
pub fn most(recording: &Recording, of: fn(&HistoryRow) -> f64) -> f64 {
    recording.rows.iter().map(of).fold(0.0, f64::max)
}

/// Worst gap of the energies over the most that was put in [-].
pub fn imbalance(recording: &Recording) -> f64 {
    most(recording, |r| gap(r).abs()) / most(recording, |r| r.external_work_J.abs())
}

/// Points that slid from one commit to the next, and do not face nothing: index and history.
pub fn sliding<'s>(
    before: &'s State,
    now: &'s State,
) -> impl Iterator<Item = (usize, &'s InterfaceHistory)> {
    let pairs = before.interface.iter().zip(&now.interface).enumerate();
    pairs.filter_map(|(p, (old, new))| {
        let slid = old.plastic_slip != new.plastic_slip && now.pairs[p].facet.is_some();
        slid.then_some((p, new))
    })
}
