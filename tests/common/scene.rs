//! Block scenes built in memory: a hex8 grid per block, faces, beams, steps.

use wythe::contact::{InterfaceHistory, InterfaceLaw};
use wythe::deck::Deck;
pub use wythe::element::hexahedron::Face;
use wythe::material::{ElasticParameters, MaterialParameters};
use wythe::model::Model;
pub use wythe::model::builder::Block;
use wythe::model::builder::ModelBuilder;
use wythe::model::scene::{
    Beam, BeamMotion, ContactPoints, Driven, Fidelity, Gravity, Increments, Procedure, Rayleigh,
    Step, Tangent, Tolerance,
};
use wythe::solve::Recorder;
use wythe::state::State;
use wythe::state::{Frame, HistoryRow, Status, Summary};

/// Gravity [mm/s²].
pub const G: f64 = 9810.0;
/// Density of moving blocks [tonne/mm³].
pub const DENSITY: f64 = 2e-9;

/// A procedure and its tangents.
pub type How = (Procedure, Tangent);
/// Newton's method with the secant stiffness of the solids.
pub const SECANT: How = (Procedure::Static, Tangent::Secant);
/// The same with extrapolated solids (IMPL-EX).
pub const IMPLEX: How = (Procedure::Implex, Tangent::Secant);
/// Newton's method with consistent tangents and the shifted penalty.
pub const CONSISTENT: How = (Procedure::Static, Tangent::Consistent);
/// Newton's method with the exact tangent of the law.
pub const DIRECT: How = (Procedure::Static, Tangent::Direct);

/// A model without bodies and without symmetry reduction.
pub fn empty() -> Model {
    Model {
        fidelity: Fidelity::Full,
        ..Model::empty("")
    }
}

/// Changes a model with the public builder.
fn build<R>(model: &mut Model, change: impl FnOnce(&mut ModelBuilder) -> R) -> R {
    let mut builder = ModelBuilder {
        model: std::mem::replace(model, Model::empty("")),
    };
    let answer = change(&mut builder);
    *model = builder.model;
    answer
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

/// Adds a block with its lower corner at `low`, divided into `cells`.
pub fn block(
    model: &mut Model,
    low: [f64; 3],
    size: [f64; 3],
    cells: [usize; 3],
    material: &MaterialParameters,
) -> Block {
    let name = format!("block {}", model.mesh.names.len());
    build(model, |builder| {
        let material = builder.material(&name, material.clone());
        builder.block(&name, low, size, cells, material)
    })
}

/// Makes a face the slave side of contact with the law `law`.
pub fn slave(model: &mut Model, block: &Block, face: Face, law: impl Into<InterfaceLaw>) {
    build(model, |builder| {
        let law = builder.law("joint", law);
        builder.slave(block, face, law);
    });
}

/// Makes a face the master side of contact.
pub fn master(model: &mut Model, block: &Block, face: Face) {
    build(model, |builder| builder.master(block, face));
}

/// General contact between all bodies: a dry law with 500 E/h.
pub fn general(model: &mut Model, mu: f64) {
    build(model, |builder| builder.general_contact(mu));
}

/// Gives a block a velocity [mm/s].
pub fn throw(model: &mut Model, block: &Block, velocity: [f64; 3]) {
    build(model, |builder| builder.velocity(block, velocity));
}

/// Rotates a block about a point by an angle [rad] about a unit axis.
pub fn turn(model: &mut Model, block: &Block, about: [f64; 3], axis: [f64; 3], angle: f64) {
    build(model, |builder| builder.rotate(block, about, axis, angle));
}

/// Fixes directions of nodes.
pub fn hold(model: &mut Model, nodes: Vec<u32>, fixed: [bool; 3]) {
    build(model, |builder| builder.support("support", nodes, fixed));
}

/// Ties nodes to a beam that stays level; returns its index.
pub fn beam(model: &mut Model, nodes: Vec<u32>) -> usize {
    model.beams.push(Beam {
        name: "beam".to_owned(),
        nodes,
        area: 1.0,
        normal: [0.0, 0.0, 1.0],
        shape: Vec::new(),
        free: Vec::new(),
        depth: 0.0,
    });
    model.beams.len() - 1
}

/// A step with equal increments in which beam 0 has this motion. Tests change the fields that differ.
pub fn step(motion: [BeamMotion; 3], driven: usize, increments: usize, tolerance: f64) -> Step {
    let size = 1.0 / increments as f64;
    Step {
        name: "step".to_owned(),
        duration: 1.0,
        motion: vec![motion],
        driven: Some(Driven::along(0, driven)),
        increments: Increments {
            initial: size,
            max: size,
            min: 1e-3 * size,
            peak: 1.0,
        },
        procedure: Procedure::Static,
        tangent: Tangent::Consistent,
        tolerance: Tolerance {
            residual: tolerance,
            max_iterations: 60,
        },
        ..Step::default()
    }
}

/// A step of `duration` [s] with gravity as the only load.
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

/// Sets the position of the contact points.
pub fn points(model: &mut Model, points: ContactPoints) {
    model.contact.points = points;
}

/// All accepted increments of a run.
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

/// Runs a model and records every accepted increment.
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

/// Error of the energy balance of a row, W − (E + T + ΣD) [J].
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

/// Largest error of the energy balance over the largest energy input [-].
pub fn imbalance(recording: &Recording) -> f64 {
    most(recording, |r| gap(r).abs()) / most(recording, |r| r.external_work_J.abs())
}

/// Points that slid between two accepted increments and face a facet: index and history.
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
