//! The files of a run, written through the public interface with fields known in closed form.
//!
//! `tests/python/` reads the same folder with VTK and h5py and compares it with the same formulas.

use std::path::Path;

use wythe_core::element::Formulation;
use wythe_core::material::{ElasticParameters, MaterialParameters};
use wythe_core::model::probes::Probe;
use wythe_core::model::probes::ProbeQuantity;
use wythe_core::model::scene::{
    BeamMotion, ContactSurfaces, Driven, Fidelity, Gravity, GroundMotion, Increments,
    NamedMaterial, Output, Procedure, Step, Tangent, Tolerance,
};
use wythe_core::model::sizes::Sizes;
use wythe_core::model::{Mesh, Model};
use wythe_core::results::RunDirectory;
use wythe_core::solve::Recorder;
use wythe_core::state::{Frame, HistoryRow, Summary};

/// Elements along x: three cubes of 100 mm, 1 mm apart, that share no nodes.
const CUBES: u32 = 3;
/// Output increments; increment n is at time n/2.
const INCREMENTS: usize = 4;

fn model() -> Model {
    let mut mesh = Mesh::default();
    for cube in 0..CUBES {
        let x = 101.0 * f64::from(cube);
        for z in [0.0, 100.0] {
            for (dx, y) in [(0.0, 0.0), (100.0, 0.0), (100.0, 100.0), (0.0, 100.0)] {
                mesh.nodes.push([x + dx, y, z]);
            }
        }
        mesh.elements
            .push(std::array::from_fn(|i| 8 * cube + i as u32));
        mesh.material.push((cube % 2) as u16);
        mesh.unit.push(10 + cube);
        mesh.course.push(2 * cube as u16);
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
    Model {
        title: "Known fields".to_owned(),
        mesh,
        materials: vec![material("brick"), material("mortar")],
        formulation: Formulation::Full,
        contact: ContactSurfaces::default(),
        beams: Vec::new(),
        supports: Vec::new(),
        initial_velocity: Vec::new(),
        springs: Vec::new(),
        ties: Vec::new(),
        floors: Vec::new(),
        limit_only: false,
        layers: Vec::new(),
        sections: Vec::new(),
        probes: vec![Probe {
            column: "gap_mm".to_owned(),
            nodes: vec![0],
            minus: vec![8],
            direction: [0.0, 0.0, 1.0],
            quantity: ProbeQuantity::Displacement,
            over: 1.0,
        }],
        loads: Vec::new(),
        steps: vec![Step {
            name: "drive".to_owned(),
            duration: 2.0,
            motion: vec![[
                BeamMotion::Driven(4.0),
                BeamMotion::Locked,
                BeamMotion::Locked,
            ]],
            driven: Some(Driven::along(0, 0)),
            increments: Increments {
                initial: 0.25,
                max: 0.25,
                min: 1e-6,
                peak: 1.0,
            },
            viscosity: 0.0,
            procedure: Procedure::Static,
            tangent: Tangent::Direct,
            control: None,
            stop: None,
            tolerance: Tolerance {
                residual: 5e-3,
                max_iterations: 25,
            },
            gravity: Gravity::None,
            ground: GroundMotion::default(),
            springs: Vec::new(),
            ties: Vec::new(),
            loads: Vec::new(),
            amplitude: None,
        }],
        warnings: Vec::new(),
        assumed: Vec::new(),
        fidelity: Fidelity::Full,
        output: Output {
            every: 1,
            ..Output::default()
        },
    }
}

/// With t the time, n the node, e the element and i the component: u = (1e-3 t x, −2e-3 t y, t n), σ = t (10 e + i),
/// ε_p = 1e-3 σ, d_t = t e/10, d_c = t/(8 + e); the probe is −8 t.
fn frame(model: &Model, t: f64) -> Frame {
    let elements = || (0..model.mesh.elements.len()).map(|e| e as f64);
    let tensor = |scale: f64, e: f64| std::array::from_fn(|i| scale * t * (10.0 * e + i as f64));
    let nodes = model.mesh.nodes.iter().enumerate();
    Frame {
        time: t,
        displacement: nodes
            .map(|(n, x)| [1e-3 * t * x[0], -2e-3 * t * x[1], t * n as f64])
            .collect(),
        stress: elements().map(|e| tensor(1.0, e)).collect(),
        plastic_strain: elements().map(|e| tensor(1e-3, e)).collect(),
        tensile_damage: elements().map(|e| t * e / 10.0).collect(),
        compressive_damage: elements().map(|e| t / (8.0 + e)).collect(),
        yielded: elements().map(|e| e > 0.0).collect(),
        crack_width: elements().map(|e| t * e / 100.0).collect(),
        probes: vec![-8.0 * t],
        ..Frame::default()
    }
}

/// Force 10, 20, 30, 20 kN at 1, 2, 3, 4 mm; W = 4, 8, 12, 16 J, of which 1 % is lost.
fn row(increment: usize) -> HistoryRow {
    let n = increment as f64;
    HistoryRow {
        increment,
        time: 0.5 * n,
        displacement_mm: n,
        force_kN: if increment < 4 { 10.0 * n } else { 20.0 },
        iterations: 5,
        external_work_J: 4.0 * n,
        elastic_energy_J: 3.0 * n,
        interface_dissipation_J: 0.96 * n,
        probes: vec![-4.0 * n],
        ..HistoryRow::default()
    }
}

fn summary() -> Summary {
    let sizes = Sizes {
        units: 3,
        elements: 3,
        nodes: 24,
        dofs: 72,
        contact_points: 0,
    };
    Summary {
        increments: INCREMENTS,
        iterations: 5 * INCREMENTS,
        ..Summary::begun(sizes, 1)
    }
}

#[test]
fn a_folder_of_known_fields_is_written_for_the_readers() {
    // The folder remains after the test, because the Python tests read it.
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("known_fields.out");
    let model = model();
    let mut run = RunDirectory::create(&out, &model).unwrap();
    for increment in 1..=INCREMENTS {
        let row = row(increment);
        assert!(
            run.take(&model, &row, Some(&frame(&model, row.time)))
                .unwrap()
        );
    }
    let written = run
        .finish(&model, &summary(), &["a warning".to_owned()])
        .unwrap();
    assert_eq!(written.peak_force_kN, Some(30.0));
    assert_eq!(written.displacement_at_peak_mm, Some(3.0));
    // 24 kN is at 0.6 of the way from 30 to 20 kN.
    let at_80 = written.displacement_at_80_percent_mm.unwrap();
    assert!((at_80 - 3.6).abs() < 1e-14); // one interpolation in f64
    assert_eq!(written.initial_stiffness_kN_per_mm, Some(10.0));
    // The drive does 70 J, and all else -54 J.
    assert!((written.energy_balance_error - 0.16 / 124.0).abs() < 1e-14); // sums of a few terms
    let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["status"], "completed");
    assert_eq!(value["warnings"][0], "a warning");
    // −8 t at t = 0.5 to 2.
    let probe = &value["probes"]["gap_mm"];
    assert_eq!(
        (&probe["lowest"], &probe["highest"]),
        (&(-16.0).into(), &(-4.0).into())
    );
}
