//! Finite sliding of dry blocks: across a seam, off an edge, and back into contact.

use crate::common::scene::{self, Face, How, Recording, completed};
use wythe::contact::CohesiveFrictional;
use wythe::model::Model;
use wythe::model::scene::{BeamMotion, ContactPoints, Step};

const MU: f64 = 0.6;
/// Normal force [N].
const N: f64 = 2400.0;
/// The default tolerance of the residual.
const TOLERANCE: f64 = 5e-3;
const LOCKED: BeamMotion = BeamMotion::Locked;

/// Two blocks of 100 × 40 × 40 mm side by side, whose tops are the masters. A block of 60 × 40 × 30 mm stands on them
/// at x = 10 mm; its top stays level.
fn three_blocks(e: f64, k_n: f64, points: ContactPoints) -> Model {
    let mut model = scene::empty();
    let solid = scene::elastic(e, 0.2);
    let size = [100.0, 40.0, 40.0];
    let left = scene::block(&mut model, [0.0; 3], size, [5, 2, 1], &solid);
    let right = scene::block(&mut model, [100.0, 0.0, 0.0], size, [5, 2, 1], &solid);
    let slider = [60.0, 40.0, 30.0];
    let slider = scene::block(&mut model, [10.0, 0.0, 40.0], slider, [3, 2, 1], &solid);
    for base in [left, right] {
        scene::master(&mut model, &base, Face::Top);
        scene::hold(&mut model, base.face(Face::Bottom), [true; 3]);
    }
    let law = CohesiveFrictional::dry(MU, k_n, k_n / 2.4);
    scene::slave(&mut model, &slider, Face::Bottom, law);
    scene::points(&mut model, points);
    scene::beam(&mut model, slider.face(Face::Top));
    model
}

fn with(mut step: Step, procedure: How) -> Step {
    (step.procedure, step.tangent) = procedure;
    step
}

/// Compresses the slider and pulls it by 120 mm, over six elements and across the seam.
fn pull_across(model: &mut Model, procedure: How, tolerance: f64) -> Recording {
    let press = [LOCKED, LOCKED, BeamMotion::Force(-N)];
    let press = scene::step(press, 0, 1, tolerance);
    model.steps.push(with(press, procedure));
    let pull = [BeamMotion::Driven(120.0), LOCKED, BeamMotion::Force(-N)];
    model
        .steps
        .push(with(scene::step(pull, 0, 24, tolerance), procedure));
    completed(model)
}

/// Largest | |τ| − μ|σ| | / μ|σ| over all sliding points and accepted increments, and the number of these points.
fn off_the_cone(recording: &Recording) -> (f64, usize) {
    let (mut worst, mut count) = (0.0_f64, 0);
    for pair in recording.states.windows(2) {
        for (_, history) in scene::sliding(&pair[0], &pair[1]) {
            let [sigma, t1, t2] = history.traction;
            if sigma < 0.0 {
                worst = worst.max((t1.hypot(t2) / (-MU * sigma) - 1.0).abs());
                count += 1;
            }
        }
    }
    (worst, count)
}

/// Largest relative deviation of force and reaction from μN and N during the pull.
fn force_error(recording: &Recording) -> f64 {
    let rows = recording.rows.iter().filter(|r| r.step == 1);
    let error = |r: &wythe::state::HistoryRow| {
        let (force, reaction) = (r.force_kN * 1e3, r.reaction_kN * 1e3);
        (force / (MU * N) - 1.0)
            .abs()
            .max((reaction / N - 1.0).abs())
    };
    rows.map(error).fold(0.0, f64::max)
}

/// Whether the seam lies below the slider at some time, which the test requires.
fn crosses_the_seam(model: &Model, recording: &Recording) -> bool {
    let faces = |body: u32| {
        move |state: &wythe::state::State| {
            let master = &model.contact.master_body;
            state
                .pairs
                .iter()
                .any(|p| p.facet.is_some_and(|f| master[f as usize] == body))
        }
    };
    let both = recording
        .states
        .iter()
        .filter(|s| faces(0)(s) && faces(1)(s))
        .count();
    let last = recording.states.last().unwrap();
    both > 4 && faces(1)(last) && !faces(0)(last)
}

#[test]
fn elastic_blocks_slide_with_the_coulomb_force() {
    for points in [ContactPoints::Gauss, ContactPoints::Corner] {
        let mut model = three_blocks(1e4, 125e3, points);
        let recording = pull_across(&mut model, scene::DIRECT, 1e-7);
        assert!(crosses_the_seam(&model, &recording));
        let (cone, count) = off_the_cone(&recording);
        let force = force_error(&recording);
        println!("{points:?}: {count} points off the cone by {cone:.1e}, force by {force:.1e}");
        assert!(count > 300);
        // Tolerance: the law returns |τ| = g(σ) up to rounding.
        assert!(cone < 1e-14, "{cone:e}");
        // The tops are no longer level: slopes of a few times σ/E = 1e-4.
        assert!(force < 1e-3, "{force:e}");
    }
}

#[test]
fn nearly_rigid_blocks_slide_with_the_coulomb_force_exactly() {
    let mut model = three_blocks(1e7, 1e5, ContactPoints::Gauss);
    let recording = pull_across(&mut model, scene::DIRECT, 1e-6);
    assert!(crosses_the_seam(&model, &recording));
    let (cone, count) = off_the_cone(&recording);
    let force = force_error(&recording);
    println!("{count} points off the cone by {cone:.1e}, force by {force:.1e}");
    // Tolerance as above.
    assert!(count == 24 * 24 && cone < 1e-14, "{count}, {cone:e}");
    // Tolerance: slopes of σ/E = 1e-7, and the residual.
    assert!(force < 1e-6, "{force:e}");
    // The points moved with the beam, minus the shear of the blocks, μσ/G × 70 mm = 1e-5 mm, and the elastic slip
    // μσ/k_s = 1e-5 mm. The slip was accumulated over many facets.
    let last = recording.states.last().unwrap();
    for history in &last.interface {
        let [along, across] = history.slip;
        assert!(
            (along.abs() - 120.0).abs() < 3e-5 && across.abs() < 3e-5,
            "{:?}",
            history.slip
        );
    }
    // The energy input is dissipated by friction, except for the first μN/k_s of the path, which is elastic.
    let energies = &last.energies;
    let missing = 1.0 - energies.interface / (MU * N * 120.0);
    let balance = (energies.external - energies.elastic - energies.interface) / energies.external;
    println!("dissipation short by {missing:.1e}, balance {balance:.1e}");
    // The force rises from stick to slip within the first increment of 5 mm, for which the trapezoidal rule counts
    // half of μN: half of 5 mm in 120.
    assert!((missing - 2.5 / 120.0).abs() < 1e-3, "{missing:e}");
    assert!(balance.abs() < 1e-3, "{balance:e}");
}

#[test]
fn the_default_procedure_slides_with_the_coulomb_force() {
    let mut model = three_blocks(1e4, 125e3, ContactPoints::Gauss);
    let recording = pull_across(&mut model, scene::SECANT, 5e-3);
    assert!(crosses_the_seam(&model, &recording));
    let (cone, count) = off_the_cone(&recording);
    let force = force_error(&recording);
    println!("{count} points off the cone by {cone:.1e}, force by {force:.1e}");
    // Each point deviates from the cone by the change of its normal traction in the last iteration. The sum deviates
    // by the tolerance, 5e-3 of a nodal force of some μN/40.
    assert!(force < 1e-3, "{force:e}");
}

/// Compresses the slider, holds its height, and then applies `moves` (displacement, increments).
fn move_level(model: &mut Model, procedure: How, moves: &[([f64; 3], usize)]) -> Recording {
    let press = [LOCKED, LOCKED, BeamMotion::Force(-N)];
    model
        .steps
        .push(with(scene::step(press, 0, 1, TOLERANCE), procedure));
    for (by, increments) in moves {
        let motion = by.map(|d| {
            if d == 0.0 {
                LOCKED
            } else {
                BeamMotion::Driven(d)
            }
        });
        model.steps.push(with(
            scene::step(motion, 0, *increments, TOLERANCE),
            procedure,
        ));
    }
    completed(model)
}

/// Zero force [kN]: if forces vanish, the tolerance is 5e-3 of a hundredth of the largest mean nodal force, here 0.01
/// N per node.
const NOTHING: f64 = 1e-4;

const PROCEDURES: [How; 4] = [
    scene::DIRECT,
    scene::CONSISTENT,
    scene::SECANT,
    scene::IMPLEX,
];

/// Ratio of the force to μ times the reaction, minus one.
fn off_friction(row: &wythe::state::HistoryRow) -> f64 {
    row.force_kN / (MU * row.reaction_kN) - 1.0
}

#[test]
fn a_block_that_slides_off_an_edge_loses_contact_without_an_error() {
    for procedure in PROCEDURES {
        for points in [ContactPoints::Gauss, ContactPoints::Corner] {
            let mut model = three_blocks(1e4, 125e3, points);
            let recording = move_level(&mut model, procedure, &[([210.0, 0.0, 0.0], 42)]);
            for row in recording.rows.iter().filter(|r| r.step == 1) {
                // The slider's end is at 70 mm + displacement, the edge at 200 mm.
                let name = format!("{procedure:?} {points:?} {:.1} mm", row.displacement_mm);
                if row.displacement_mm < 180.0 {
                    // Some of its points are in contact, and all of these slide. Tolerance of the residual: 5e-3 of a
                    // nodal force, which is a tenth of the reaction when few elements carry.
                    assert!(
                        row.reaction_kN > 0.1 && off_friction(row).abs() < 2e-3,
                        "{name}: {row:?}"
                    );
                } else if row.displacement_mm > 191.0 {
                    // No load is carried.
                    assert!(
                        row.force_kN.abs() + row.reaction_kN.abs() < NOTHING,
                        "{name}: {row:?}"
                    );
                    assert_eq!(row.open_points, 24, "{name}");
                }
            }
        }
    }
}

#[test]
fn a_point_that_opens_and_closes_again_carries_load_again() {
    let moves = [
        ([0.0, 0.0, 3.0], 3),
        ([37.0, 0.0, 0.0], 5),
        ([0.0, 0.0, -3.0], 3),
        ([7.0, 0.0, 0.0], 5),
    ];
    for procedure in PROCEDURES {
        for points in [ContactPoints::Gauss, ContactPoints::Corner] {
            let mut model = three_blocks(1e4, 125e3, points);
            let rows = move_level(&mut model, procedure, &moves).rows;
            let name = format!("{procedure:?} {points:?}");
            // The slider is lifted.
            for row in rows.iter().filter(|r| r.step == 1 || r.step == 2) {
                assert!(
                    row.force_kN.abs() + row.reaction_kN.abs() < NOTHING,
                    "{name}: {row:?}"
                );
            }
            // Lowered again at another place, with the same displacement. The base is softer near its edges by some
            // per cent, and the only shear comes from lateral expansion.
            let down = rows.iter().rfind(|r| r.step == 3).unwrap();
            assert!(
                (down.reaction_kN * 1e3 / N - 1.0).abs() < 0.05,
                "{name}: {down:?}"
            );
            assert!(
                down.force_kN.abs() < 0.1 * MU * down.reaction_kN,
                "{name}: {down:?}"
            );
            assert_eq!(down.sliding_points, 0, "{name}");
            // It sticks and then slides.
            for row in rows.iter().filter(|r| r.step == 4) {
                // Tolerance as above.
                assert!(off_friction(row).abs() < 2e-3, "{name}: {row:?}");
            }
        }
    }
}

#[test]
fn a_bonded_block_that_was_torn_off_comes_back_without_its_bond() {
    for procedure in PROCEDURES {
        let mut model = three_blocks(1e4, 125e3, ContactPoints::Gauss);
        let law = CohesiveFrictional {
            normal_stiffness: 125e3,
            shear_stiffness: 125e3 / 2.4,
            ..crate::common::table_1()
        };
        model.contact.laws = vec![law.into()];
        let moves = [
            // Opened beyond u_k = 0.2 mm but within the search radius, and back; then beyond the search radius, and
            // back.
            ([0.0, 0.0, 0.5], 20),
            ([0.0, 0.0, -0.5], 5),
            ([0.0, 0.0, 3.0], 5),
            ([0.0, 0.0, -3.0], 5),
            ([2.0, 0.0, 0.0], 5),
        ];
        let recording = move_level(&mut model, procedure, &moves);
        let rows = &recording.rows;
        let end = |step| rows.iter().rfind(|r| r.step == step).unwrap();
        let most = rows
            .iter()
            .filter(|r| r.step == 1)
            .map(|r| -r.reaction_kN)
            .fold(0.0, f64::max);
        let area = 60.0 * 40.0;
        // The law's f_t A is not reached by all points at once, nor exactly by an increment.
        assert!(
            most > 0.5 * 0.28e-3 * area && most < 0.28e-3 * area,
            "{procedure:?}: {most}"
        );
        assert!(end(1).reaction_kN.abs() < NOTHING && end(1).max_interface_damage == 1.0);
        // No tension is carried any more.
        assert!(
            rows.iter()
                .filter(|r| r.step > 1)
                .all(|r| r.reaction_kN > -NOTHING)
        );
        for step in [2, 4] {
            // The same place and height: the slip of the preload without damage remains.
            let back = end(step).reaction_kN * 1e3 / N - 1.0;
            assert!(back.abs() < 1e-2, "{procedure:?}: {back:e}");
        }
        let (force, reaction) = (end(5).force_kN, end(5).reaction_kN);
        // Residual friction of Table 1; tolerance as above.
        assert!(
            (force / (0.73 * reaction) - 1.0).abs() < 2e-3,
            "{procedure:?}: {:?}",
            end(5)
        );
    }
}
