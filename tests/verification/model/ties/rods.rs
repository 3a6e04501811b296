//! Rods and bars against closed forms and finite differences.

use crate::common::scene::{self, Face, completed, elastic, imbalance};
use nalgebra::{DMatrix, Rotation3, Vector3};
use wythe::assembly::{Evaluation, Solids, System, Trial, Turning};
use wythe::contact::CohesiveFrictional;
use wythe::model::Model;
use wythe::model::builder::ModelBuilder;
use wythe::model::scene::{BeamMotion, Driven, Step, Tolerance};
use wythe::model::ties::{TieFault, TieLaw, TieStage};
use wythe::state::{Clock, HistoryRow};

/// Area [mm²], Young's modulus, yield stress and hardening of the rod [MPa]; its length [mm], prestress [N] and strain
/// at rupture.
const AREA: f64 = 100.0;
const E: f64 = 2e5;
const F_Y: f64 = 300.0;
const HARDENING: f64 = 2e3;
const LENGTH: f64 = 200.0;
const PRESTRESS: f64 = 20e3;
const RUPTURE: f64 = 0.01;

const ROD: TieLaw = TieLaw {
    area: AREA,
    E,
    f_y: F_Y,
    hardening: HARDENING,
    rupture: RUPTURE,
    compression: false,
};

/// A thin elastic rod beside it: without any force a scene has no scale for its residual once the rod is broken.
const WIRE: TieLaw = TieLaw {
    area: 1.0,
    f_y: f64::INFINITY,
    rupture: f64::INFINITY,
    ..ROD
};

/// Young's modulus of the blocks [MPa] and normal stiffness of the joint [N/mm³].
const STONE: f64 = 1e4;
const JOINT: f64 = 1e4;

/// Two cubes of 100 mm with a dry joint, pulled apart by `by` [mm] and held by a prestressed rod from face to face; all
/// turned about y by `angle` [rad].
fn pulled(angle: f64, by: f64, rod: TieLaw, increments: usize) -> Model {
    let mut model = scene::empty();
    let stone = elastic(STONE, 0.0);
    let size = [100.0; 3];
    let lower = scene::block(&mut model, [0.0; 3], size, [1; 3], &stone);
    let upper = scene::block(&mut model, [0.0, 0.0, 100.0], size, [1; 3], &stone);
    scene::slave(
        &mut model,
        &upper,
        Face::Bottom,
        CohesiveFrictional::dry(0.5, JOINT, JOINT),
    );
    scene::master(&mut model, &lower, Face::Top);
    for block in [&lower, &upper] {
        scene::turn(&mut model, block, [0.0; 3], [0.0, 1.0, 0.0], angle);
    }
    scene::hold(&mut model, lower.face(Face::Bottom), [true; 3]);
    scene::beam(&mut model, upper.face(Face::Top));
    let turned = Rotation3::from_axis_angle(&Vector3::y_axis(), angle);
    let ends = [0.0, LENGTH].map(|z| (turned * Vector3::new(50.0, 50.0, z)).into());
    let mut builder = ModelBuilder { model };
    builder.tie("rod", ends, rod).unwrap();
    builder.tie("wire", ends, WIRE).unwrap();
    let mut model = builder.model;
    let direction: [f64; 3] = (turned * Vector3::z()).into();
    let free = [BeamMotion::Force(0.0); 3];
    let driven = direction.map(|part| BeamMotion::Driven(by * part));
    let along = Driven { beam: 0, direction };
    for (motion, stage, count) in [
        (free, TieStage::Stressed(PRESTRESS), 4),
        (driven, TieStage::Fixed, increments),
    ] {
        model.steps.push(Step {
            ties: vec![stage, TieStage::Fixed],
            driven: Some(along),
            ..scene::step(motion, 2, count, 1e-9)
        });
    }
    model
}

/// Force of the rod [N] and its stretch [mm] in a row.
pub fn rod(row: &HistoryRow) -> (f64, f64) {
    let [force, stretch, ..] = row.probes[..] else {
        panic!("no columns of the rod");
    };
    (1e3 * force, stretch)
}

/// Force of the rod where its ends have moved apart by `by` since it was stressed [N].
fn force_of_rod(by: f64) -> f64 {
    let strain = PRESTRESS / (E * AREA) + by / LENGTH;
    let yields = F_Y / E;
    let slope = E * HARDENING / (E + HARDENING);
    AREA * if strain < yields {
        E * strain
    } else {
        F_Y + slope * (strain - yields)
    }
}

/// The joint opens where the pull has taken the prestress from the blocks; then the force is that of the rod: elastic,
/// yielding, broken. Blocks and joint are springs in series.
#[test]
fn a_prestressed_rod_holds_two_blocks_together() {
    let recording = completed(&pulled(0.0, 2.4, ROD, 120));
    let stiffness = 1.0 / (2.0 * 100.0 / (STONE * 1e4) + 1.0 / (JOINT * 1e4));
    let stressed = recording.rows[3].clone();
    let (force, stretch) = rod(&stressed);
    assert!((force - PRESTRESS).abs() < 1e-6, "{force}");
    // The blocks shorten by P/k; strains of 2e-4 are neglected in it.
    let shortened = -PRESTRESS / stiffness;
    assert!(
        (stretch / shortened - 1.0).abs() < 1e-3,
        "{stretch} {shortened}"
    );
    let mut broken = 0;
    for row in &recording.rows[4..] {
        // Ends of the rod move with the driven face and the held one.
        let by = row.displacement_mm - stressed.displacement_mm;
        let wanted = force_of_rod(by);
        let (found, _) = rod(row);
        if broken > 0 || found == 0.0 {
            broken += 1;
            assert!(
                (row.force_kN - row.probes[2]).abs() < 1e-6 && found == 0.0,
                "{row:?}"
            );
            continue;
        }
        let pressed = (PRESTRESS - stiffness * by).max(0.0);
        // The rod is exact but for the tolerance of the force.
        assert!(
            (found / wanted - 1.0).abs() < 1e-9,
            "{by}: {found} {wanted}"
        );
        // Strains of 2e-4 of the blocks are neglected in `pressed`.
        let all = wanted - pressed + 1e3 * row.probes[2];
        assert!(
            (1e3 * row.force_kN - all).abs() < 1e-3 * PRESTRESS,
            "{by}: {row:?} {all}"
        );
        // It breaks within one increment after its strain is reached.
        let strain = PRESTRESS / (E * AREA) + by / LENGTH;
        assert!(strain < RUPTURE + 0.02 / LENGTH + 1e-9, "{strain}");
    }
    assert!(broken > 10);
    let worst = imbalance(&recording);
    println!("energy balance {worst:e}");
    // Tolerance of the residual 1e-9; nothing else is left out.
    assert!(worst < 1e-6, "{worst:e}");
    // Plastic work to the strain of the last increment before rupture, by the trapezoidal rule that is exact for a
    // linear law, and the elastic energy at rupture.
    let last = &recording.rows[recording.rows.len() - 1 - broken];
    let by = last.displacement_mm - stressed.displacement_mm;
    let stress = force_of_rod(by) / AREA;
    let plastic = PRESTRESS / (E * AREA) + by / LENGTH - stress / E;
    let volume = AREA * LENGTH;
    let work = 0.5 * (F_Y + stress) * plastic * volume;
    let all = work + 0.5 * stress * stress / E * volume;
    let end = recording.rows.last().unwrap();
    let [before, after] = [last, end].map(|row| 1e3 * row.plastic_damage_dissipation_J);
    println!("plastic work {before} of {work}, with rupture {after} of {all}");
    // The increment in which the rod begins to yield counts the mean of both stresses.
    assert!((before / work - 1.0).abs() < 0.01, "{before} {work}");
    assert!((after - before - (all - work)).abs() < 1e-6 * all);
}

/// Turned by 30°, the rod follows the same curve.
#[test]
fn a_turned_scene_gives_the_same() {
    let recording = completed(&pulled(std::f64::consts::FRAC_PI_6, 2.4, ROD, 60));
    let before = recording.rows.iter().rfind(|row| row.step == 0).unwrap();
    let stressed = before.displacement_mm;
    let mut broken = 0;
    for row in recording.rows.iter().filter(|row| row.step == 1) {
        let by = row.displacement_mm - stressed;
        let (found, _) = rod(row);
        if found == 0.0 {
            broken += 1;
            continue;
        }
        let wanted = force_of_rod(by);
        // Tolerance of the residual 1e-9 and rounding.
        assert!(
            broken == 0 && (found / wanted - 1.0).abs() < 1e-6,
            "{by}: {found} {wanted}"
        );
    }
    assert!(broken > 5 && imbalance(&recording) < 1e-6);
}

/// A rod without compression is slack while the joint is pressed together beyond its length, and takes up its force
/// again where it was left.
#[test]
fn a_slack_rod_carries_nothing_and_its_energy_closes() {
    let rod_law = TieLaw {
        f_y: f64::INFINITY,
        rupture: f64::INFINITY,
        ..ROD
    };
    let mut model = pulled(0.0, -0.3, rod_law, 37);
    let back = scene::step(
        [
            BeamMotion::Driven(0.0),
            BeamMotion::Driven(0.0),
            BeamMotion::Driven(0.6),
        ],
        2,
        41,
        1e-9,
    );
    model.steps.push(Step {
        ties: vec![TieStage::Fixed],
        ..back
    });
    let recording = completed(&model);
    let stressed = recording.rows[3].displacement_mm;
    let mut slack = 0;
    for row in &recording.rows[4..] {
        // The history counts displacements along the first drive, downwards.
        let by = stressed - row.displacement_mm;
        let wanted = (PRESTRESS + E * AREA * by / LENGTH).max(0.0);
        let (found, _) = rod(row);
        assert!(
            (found - wanted).abs() < 1e-6 * PRESTRESS,
            "{by}: {found} {wanted}"
        );
        slack += usize::from(found == 0.0);
    }
    assert!(slack > 10, "{slack}");
    let end = recording.rows.last().unwrap();
    assert_eq!(end.plastic_damage_dissipation_J, 0.0);
    // Tolerance of the residual 1e-9.
    assert!(imbalance(&recording) < 1e-6);
}

/// A rod that is installed in the second step does not feel what the first one did.
#[test]
fn a_rod_is_free_of_stress_when_it_is_installed() {
    let mut model = pulled(0.0, -0.05, ROD, 10);
    let push = scene::step(
        [
            BeamMotion::Driven(0.0),
            BeamMotion::Driven(0.0),
            BeamMotion::Driven(-0.1),
        ],
        2,
        5,
        1e-9,
    );
    model.steps[0] = Step {
        ties: vec![TieStage::Absent],
        ..push
    };
    model.steps[1].motion = vec![[
        BeamMotion::Driven(0.0),
        BeamMotion::Driven(0.0),
        BeamMotion::Driven(0.05),
    ]];
    let recording = completed(&model);
    for row in &recording.rows {
        // The history counts displacements along the first drive, downwards.
        let wanted = if row.step == 0 {
            0.0
        } else {
            E * AREA * (0.1 - row.displacement_mm) / LENGTH
        };
        let (found, _) = rod(row);
        assert!(
            (found - wanted).abs() < 1e-6 * PRESTRESS,
            "{found} {wanted}"
        );
    }
}

/// A bar bonded along a block shares its force in proportion to E A; across a dry joint it carries all, over its
/// unbonded length.
#[test]
fn a_bonded_bar_takes_its_share() {
    let bar = TieLaw {
        f_y: f64::INFINITY,
        rupture: f64::INFINITY,
        compression: true,
        ..ROD
    };
    let line = [[0.0, 50.0, 50.0], [400.0, 50.0, 50.0]];
    let drive = |by: f64| {
        let motion = [
            BeamMotion::Driven(by),
            BeamMotion::Locked,
            BeamMotion::Locked,
        ];
        scene::step(motion, 0, 4, 1e-10)
    };
    let mut model = scene::empty();
    let whole = scene::block(
        &mut model,
        [0.0; 3],
        [400.0, 100.0, 100.0],
        [4, 1, 1],
        &elastic(STONE, 0.0),
    );
    scene::hold(&mut model, whole.face(Face::Left), [true; 3]);
    scene::beam(&mut model, whole.face(Face::Right));
    let mut builder = ModelBuilder { model };
    builder.bonded_tie("bar", &line, 50.0, bar).unwrap();
    builder.step(drive(0.04));
    let recording = completed(&builder.build().unwrap());
    let end = recording.rows.last().unwrap();
    let strain = 0.04 / 400.0;
    // Strains of 1e-4 turn nothing, but the frames of the elements use the stretched lengths.
    assert!(
        (rod(end).0 / (E * AREA * strain) - 1.0).abs() < 1e-9,
        "{end:?}"
    );
    let wanted = (E * AREA + STONE * 1e4) * strain;
    assert!(
        (1e3 * end.force_kN / wanted - 1.0).abs() < 1e-3,
        "{end:?} {wanted}"
    );

    let mut model = scene::empty();
    let stiff = elastic(1e7, 0.0);
    let size = [200.0, 100.0, 100.0];
    let left = scene::block(&mut model, [0.0; 3], size, [2, 1, 1], &stiff);
    let right = scene::block(&mut model, [200.0, 0.0, 0.0], size, [2, 1, 1], &stiff);
    scene::slave(
        &mut model,
        &right,
        Face::Left,
        CohesiveFrictional::dry(0.5, JOINT, JOINT),
    );
    scene::master(&mut model, &left, Face::Right);
    scene::hold(&mut model, left.face(Face::Left), [true; 3]);
    scene::beam(&mut model, right.face(Face::Right));
    let mut builder = ModelBuilder { model };
    builder.bonded_tie("bar", &line, 50.0, bar).unwrap();
    builder.step(Step {
        tolerance: Tolerance {
            residual: 1e-6,
            max_iterations: 60,
        },
        ..drive(0.05)
    });
    let recording = completed(&builder.build().unwrap());
    let end = recording.rows.last().unwrap();
    let wanted = 0.05 / (50.0 / (E * AREA) + 350.0 / (1e7 * 1e4));
    // The blocks are compliant beside the points of the bar, too: a few times 50/(1e7 · 1e4) of 50/(2e5 · 100).
    assert!(
        (1e3 * end.force_kN / wanted - 1.0).abs() < 1e-3,
        "{end:?} {wanted}"
    );
}

const DIRECT: Evaluation = Evaluation {
    dt: 1.0,
    solids: Solids::Implicit,
    shifted: false,
    tangent: true,
    turning: Turning::Exact,
};

/// Two blocks without contact and a rod across.
fn apart() -> Model {
    let mut model = scene::empty();
    let soft = elastic(10.0, 0.2);
    scene::block(&mut model, [0.0; 3], [60.0, 40.0, 20.0], [2, 1, 1], &soft);
    scene::block(
        &mut model,
        [10.0, 0.0, 50.0],
        [60.0, 40.0, 20.0],
        [1, 2, 1],
        &soft,
    );
    let mut builder = ModelBuilder { model };
    let law = TieLaw {
        area: 2.0,
        E: 1e3,
        f_y: 20.0,
        hardening: 300.0,
        rupture: f64::INFINITY,
        compression: true,
    };
    builder
        .tie("rod", [[11.0, 13.0, 7.0], [52.0, 29.0, 61.0]], law)
        .unwrap();
    builder.step(Step::default());
    builder.model
}

/// The tangent of a rod in every state is the derivative of its forces; secant tangents are never negative.
#[test]
fn the_stiffness_of_a_rod_is_the_derivative_of_its_forces() {
    let stretch = |by: f64| {
        move |q: &mut [f64], n: usize| q[n..].chunks_exact_mut(3).for_each(|u| u[2] += by)
    };
    for (name, by, stage, compression) in [
        ("elastic", 0.9, TieStage::Fixed, true),
        ("yielding", 3.0, TieStage::Fixed, true),
        ("pressed", -0.9, TieStage::Fixed, true),
        ("yielding in compression", -3.0, TieStage::Fixed, true),
        ("slack", -0.9, TieStage::Fixed, false),
        ("stressed", 0.5, TieStage::Stressed(30.0), true),
        ("absent", 0.5, TieStage::Absent, true),
    ] {
        let mut model = apart();
        model.ties[0].law.compression = compression;
        let mut system = System::new(&model).unwrap();
        let state = system.initial_state(&model);
        let mut trial = Trial::default();
        let mut q = state.q.clone();
        for (i, q) in q.iter_mut().enumerate() {
            *q = 0.03 * (1.7 * i as f64).sin();
        }
        stretch(by)(&mut q, 3 * 12);
        let mut clock = Clock::default();
        let mut force = |q: &[f64], trial: &mut Trial, system: &mut System| {
            system.start(&model, trial, &state);
            trial.ties.stages = vec![stage];
            system
                .evaluate(&model, &state, trial, q, DIRECT, &mut clock)
                .unwrap();
            trial.force.clone()
        };
        force(&q, &mut trial, &mut system);
        let n = q.len();
        let (mut assembled, mut differences) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            assembled.set_column(j, &system.multiply(&trial, &unit).into());
        }
        for j in 0..n {
            const STEP: f64 = 1e-5;
            let mut moved = q.clone();
            moved[j] += STEP;
            let above = force(&moved, &mut trial, &mut system);
            moved[j] -= 2.0 * STEP;
            let below = force(&moved, &mut trial, &mut system);
            for i in 0..n {
                differences[(i, j)] = (above[i] - below[i]) / (2.0 * STEP);
            }
        }
        let error = (&assembled - &differences).amax() / assembled.amax();
        println!("{name}: {error:e}");
        // Central differences of 1e-5 mm: the square of the step over the size, and rounding 1e-16/1e-5.
        assert!(error < 1e-7, "{name}: {error:e}");
    }
}

#[test]
fn a_rod_that_turns_with_its_blocks_carries_nothing() {
    let model = apart();
    let mut system = System::new(&model).unwrap();
    let state = system.initial_state(&model);
    let mut trial = Trial::default();
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let q: Vec<f64> = (model.mesh.nodes.iter())
        .flat_map(|x| {
            let x = Vector3::from(*x);
            let u: [f64; 3] = (turn * x - x + Vector3::new(3.0, 4.0, 5.0)).into();
            u
        })
        .collect();
    system.start(&model, &mut trial, &state);
    system
        .evaluate(
            &model,
            &state,
            &mut trial,
            &q,
            DIRECT,
            &mut Clock::default(),
        )
        .unwrap();
    let force = trial.ties.segments[0].force;
    // Rounding of lengths of 70 mm, times E A/L₀ of 30 N/mm.
    assert!(force.abs() < 1e-10, "{force:e}");
}

#[test]
fn wrong_places_are_named() {
    let mut builder = ModelBuilder { model: apart() };
    let far = builder.tie("a", [[0.0; 3], [0.0, 0.0, 45.0]], ROD);
    assert_eq!(
        far,
        Err(TieFault::Outside {
            at: [0.0, 0.0, 45.0]
        })
    );
    let point = builder.tie("a", [[1.0; 3], [1.0; 3]], ROD);
    assert_eq!(point, Err(TieFault::NoLength { at: [1.0; 3] }));
    let within = builder.tie("a", [[1.0; 3], [9.0, 9.0, 9.0]], ROD);
    assert!(
        matches!(within, Err(TieFault::OneElement { .. })),
        "{within:?}"
    );
}
