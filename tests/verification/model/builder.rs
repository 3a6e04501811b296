//! Models built from Rust, and runs that advance step by step on request.

use crate::common::scene;
use std::sync::Arc;
use wythe::element::hexahedron::Face;
use wythe::material::{ElasticParameters, MaterialParameters};
use wythe::model::builder::{BuildError, ModelBuilder};
use wythe::model::scene::{BeamMotion, Driven, Step};
use wythe::solve::Stepper;
use wythe::state::Status;

/// A cube of elastic stone whose top is lifted by 0.1 mm.
fn cube() -> ModelBuilder {
    let mut cube = ModelBuilder::new("cube");
    let stone = cube.material(
        "stone",
        MaterialParameters::Elastic(ElasticParameters {
            E: 1000.0,
            nu: 0.0,
            density: 0.0,
        }),
    );
    let block = cube.block("cube", [0.0; 3], [100.0; 3], [2, 2, 2], stone);
    cube.support("ground", block.face(Face::Bottom), [true; 3]);
    cube.beam("top", &[(&block, Face::Top)]);
    cube.probe("top_mm", block.face(Face::Top), 2);
    cube.step(Step {
        motion: vec![[
            BeamMotion::Locked,
            BeamMotion::Locked,
            BeamMotion::Driven(0.1),
        ]],
        driven: Some(Driven::along(0, 2)),
        ..Step::default()
    });
    cube
}

#[test]
fn a_built_cube_carries_its_stiffness() {
    let model = cube().build().unwrap();
    assert_eq!(model.beams[0].normal, [0.0, 0.0, 1.0]);
    let rows = scene::completed(&model).rows;
    let last = rows.last().unwrap();
    // Corotational elements give F = E A ε with the engineering strain, up to rounding.
    let force = 1000.0 * 1e4 * 1e-3 * 1e-3;
    assert!(
        (last.force_kN / force - 1.0).abs() < 1e-10,
        "{}",
        last.force_kN
    );
    assert!((last.probes[0] - 0.1).abs() < 1e-12, "{:?}", last.probes);
}

#[test]
fn a_stepper_takes_the_increments_of_a_run() {
    let model = cube().build().unwrap();
    let whole = scene::completed(&model).rows;
    let mut stepper = Stepper::new(Arc::new(model.clone()));
    let rows: Vec<_> = stepper.by_ref().map(|increment| increment.row).collect();
    assert_eq!(stepper.finish().unwrap().unwrap().status, Status::Completed);
    assert_eq!(rows.len(), whole.len());
    for (a, b) in rows.iter().zip(&whole) {
        assert_eq!(a.force_kN.to_bits(), b.force_kN.to_bits());
        assert_eq!(a.displacement_mm.to_bits(), b.displacement_mm.to_bits());
    }
    // A stepper that is stopped after three increments has solved three.
    let mut stepper = Stepper::new(Arc::new(model));
    assert_eq!(stepper.by_ref().take(3).count(), 3);
    let summary = stepper.finish().unwrap().unwrap();
    assert_eq!(
        (summary.status, summary.increments),
        (Status::Interrupted, 3)
    );
}

#[test]
fn a_stepper_that_never_started_has_no_summary() {
    let model = Arc::new(cube().build().unwrap());
    assert!(Stepper::new(model).finish().unwrap().is_none());
}

#[test]
fn faults_of_a_built_model_are_named() {
    let fault = |change: fn(&mut ModelBuilder)| {
        let mut cube = cube();
        change(&mut cube);
        cube.build().unwrap_err()
    };
    assert_eq!(
        ModelBuilder::new("").build().unwrap_err(),
        BuildError::NoBlocks
    );
    assert_eq!(fault(|b| b.model.steps.clear()), BuildError::NoSteps);
    let flat = fault(|b| {
        let stone = b.material("flat", b.model.materials[0].parameters.clone());
        b.block("slab", [0.0; 3], [1.0, 1.0, 0.0], [1; 3], stone);
    });
    assert_eq!(
        flat.to_string(),
        "element 8 of slab has the volume 0 mm³: give its block positive sizes"
    );
    let node = fault(|b| b.support("peg", vec![99], [true; 3]));
    assert_eq!(
        node.to_string(),
        "support peg refers to node 99, and there are 27"
    );
    let many = fault(|b| {
        for _ in 0..1 << 16 {
            b.material("another", b.model.materials[0].parameters.clone());
        }
    });
    assert_eq!(
        many.to_string(),
        "there are 65537 materials, and at most 65536: share them between blocks"
    );
    let beams = fault(|b| b.step(Step::default()));
    assert_eq!(
        beams.to_string(),
        "step step moves 0 beams, and there are 1: give one entry for each"
    );
}
