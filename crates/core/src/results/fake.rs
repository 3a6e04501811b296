//! A small model with invented fields for the tests of this module.

use crate::element::Formulation;
use crate::material::{ElasticParameters, MaterialParameters};
use crate::model::scene::{
    BeamMotion, Driven, Fidelity, Increments, NamedMaterial, Procedure, Step, Tangent,
};
use crate::model::sizes::Sizes;
use crate::model::{Mesh, Model};
use crate::state::{Frame, HistoryRow, InterfaceFrame, InterfaceState, Status, Summary};

/// Two cubes of 100 mm side by side with a gap of 2 mm; a preload and a driven step.
pub fn model() -> Model {
    let mut mesh = Mesh::default();
    for cube in 0..2_u32 {
        let x = 102.0 * f64::from(cube);
        for z in [0.0, 100.0] {
            for (dx, y) in [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)] {
                mesh.nodes.push([x + dx, y, z]);
            }
        }
        mesh.elements
            .push(std::array::from_fn(|i| 8 * cube + i as u32));
        mesh.material.push(cube as u16);
        mesh.unit.push(cube);
        mesh.course.push(0);
    }
    let elastic = ElasticParameters {
        E: 1000.0,
        nu: 0.2,
        density: 1.9e-9,
    };
    let material = |name: &str| NamedMaterial {
        name: name.to_owned(),
        parameters: MaterialParameters::Elastic(elastic),
        rigid: false,
    };
    let step = |name: &str, x: BeamMotion| Step {
        name: name.to_owned(),
        duration: 1.0,
        motion: vec![[x, BeamMotion::Locked, BeamMotion::Locked]],
        driven: Some(Driven::along(0, 0)),
        increments: Increments {
            initial: 0.1,
            max: 0.1,
            min: 1e-6,
            peak: 1.0,
        },
        procedure: Procedure::Static,
        tangent: Tangent::Direct,
        ..Step::default()
    };
    Model {
        mesh,
        materials: vec![material("brick"), material("mortar")],
        formulation: Formulation::Full,
        steps: vec![
            step("preload", BeamMotion::Locked),
            step("drive", BeamMotion::Driven(3.0)),
        ],
        fidelity: Fidelity::Full,
        ..Model::empty("Two cubes & a <gap>")
    }
}

/// Fields that vary with node, element and time.
pub fn frame(model: &Model, time: f64) -> Frame {
    let elements = 0..model.mesh.elements.len();
    let points = 4 * model.contact.slave_facets.len();
    let each = |of: fn(f64) -> f64| (0..points).map(|p| time * of(p as f64)).collect();
    let tensor = |e: usize| std::array::from_fn(|i| time * (10 * e + i) as f64);
    Frame {
        time,
        displacement: model
            .mesh
            .nodes
            .iter()
            .map(|x| x.map(|x| 1e-3 * time * (x + 1.0)))
            .collect(),
        stress: elements.clone().map(tensor).collect(),
        tensile_damage: elements
            .clone()
            .map(|e| 0.3 * time + 0.1 * e as f64)
            .collect(),
        compressive_damage: elements.clone().map(|e| 0.4 * e as f64).collect(),
        plastic_strain: elements.clone().map(tensor).collect(),
        yielded: elements.clone().map(|e| e % 2 == 1).collect(),
        crack_width: elements.map(|e| 0.01 * time * e as f64).collect(),
        interfaces: InterfaceFrame {
            opening: each(|p| p),
            slip: (0..points).map(|p| [time, time + p as f64]).collect(),
            traction: (0..points).map(|p| [time, p as f64, -time]).collect(),
            damage: each(|p| 0.01 * p),
            state: vec![InterfaceState::Softening; points],
            ..InterfaceFrame::default()
        },
        ..Frame::default()
    }
}

/// A row with this displacement and force.
pub fn row(increment: usize, step: usize, displacement: f64, force: f64) -> HistoryRow {
    HistoryRow {
        increment,
        step,
        displacement_mm: displacement,
        force_kN: force,
        ..HistoryRow::default()
    }
}

/// Summary of a small run.
pub fn summary(status: Status) -> Summary {
    let sizes = Sizes {
        units: 2,
        elements: 2,
        nodes: 16,
        dofs: 48,
        contact_points: 4,
    };
    Summary {
        status,
        increments: 3,
        iterations: 7,
        cutbacks: 1,
        seconds_by_phase: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        ..Summary::begun(sizes, 1)
    }
}
