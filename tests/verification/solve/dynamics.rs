//! Moving blocks, columns and walls: gravity, ground and beams, their energies, and the deck keys.

use crate::common::blocks;
use crate::common::scene::{self, DENSITY, Face, G, Recording, completed, gap};
use wythe::assembly::{Bulk, DofMap, Mass};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::model::scene::{BeamMotion, Gravity, Procedure, Rayleigh, Tangent};
use wythe::solve::RunError;
use wythe::state::HistoryRow;

/// Relative to the mean nodal force: one iteration solves linear problems up to rounding.
const EXACT: f64 = 1e-8;
/// The weight is 1e-6 of the element forces at a strain of 1, so that rounding is larger by this factor.
const OF_WEIGHT: f64 = 1e-5;

/// A block in the air.
fn block_in_the_air() -> Model {
    let mut model = scene::empty();
    let solid = scene::heavy(1e4, 0.2, DENSITY);
    scene::block(&mut model, [0.0; 3], [60.0, 40.0, 50.0], [2, 2, 2], &solid);
    model
}

#[test]
fn a_block_falls_freely() {
    let mut model = block_in_the_air();
    let count = 50;
    model.steps = vec![scene::set_free(
        Gravity::Constant([0.0, 0.0, -G]),
        0.1,
        count,
        OF_WEIGHT,
        -0.05,
    )];
    let recording = completed(&model);
    let dt = 0.1 / count as f64;
    for (n, state) in recording.states.iter().enumerate() {
        let t = (n + 1) as f64 * dt;
        // The first increment, by backward Euler, falls half g Δt² too far; the rest is exact.
        let fall = 0.5 * G * (t * t + dt * dt);
        for s in 0..state.q.len() {
            let (u, v) = if s % 3 == 2 {
                (-fall, -G * t)
            } else {
                (0.0, 0.0)
            };
            // Tolerance: the residual, 1e-5 of the weight per node, with either sign.
            assert!(
                (state.q[s] - u).abs() < 1e-5 * fall,
                "{n} {s}: {}",
                state.q[s]
            );
            assert!((state.velocity[s] - v).abs() < 1e-5 * G * t);
        }
    }
    let last = recording.rows.last().unwrap();
    let weight = DENSITY * 60.0 * 40.0 * 50.0 * G;
    let fall = 0.5 * G * (0.01 + dt * dt);
    assert!((last.external_work_J * 1e3 / (weight * fall) - 1.0).abs() < 1e-6);
    assert!(gap(last).abs() < 1e-6 * last.external_work_J);
    // An increment starts with constant acceleration, so that rounding costs no more than one solve.
    let solves: usize = recording.rows[1..].iter().map(|r| r.iterations).sum();
    assert!(solves <= count, "{solves}");
}

#[test]
fn a_block_flies_on_without_forces_and_turns_without_damping() {
    let mut model = block_in_the_air();
    // Thrown with a spin of 10 rad/s about y through its centre, a quarter of a turn in total.
    let spin = 10.0;
    let centre = [30.0, 20.0, 25.0];
    model.initial_velocity = model
        .mesh
        .nodes
        .iter()
        .map(|x| [spin * (x[2] - centre[2]), 300.0, -spin * (x[0] - centre[0])])
        .collect();
    let quarter = 0.5 * std::f64::consts::PI / spin;
    let mut step = scene::set_free(Gravity::None, quarter, 400, 1e-6, -0.05);
    step.procedure = Procedure::Dynamic {
        alpha: -0.05,
        damping: Rayleigh {
            mass: 0.0,
            // Critical damping of vibrations at 20,000 rad/s, a tenth of an increment.
            stiffness: 1e-4,
        },
    };
    step.tangent = Tangent::Consistent;
    model.steps = vec![step];
    let recording = completed(&model);
    let (first, last) = (&recording.rows[0], recording.rows.last().unwrap());
    let frame = recording.frames.last().unwrap();
    println!("{last:?}");
    // x → z: the corner at the origin moves to its place in a block rotated by a quarter turn.
    let corner = frame.displacement[0];
    let [dx, dz] = [-centre[0], -centre[2]];
    let expected = [dz - dx, 300.0 * quarter, -dx - dz];
    for i in 0..3 {
        // Tolerance: relative phase error (spin Δt)² of a turn, 1.5e-5 of 39 mm, and the elongation by the spin.
        assert!(
            (corner[i] - expected[i]).abs() < 0.05,
            "{corner:?} {expected:?}"
        );
    }
    // Stresses of a spinning block are ϱ(spin × 30 mm)² = 1e-4 MPa; their energy and damping are negligible.
    let energy = first.external_work_J;
    assert!(last.damping_dissipation_J < 1e-3 * energy, "{last:?}");
    assert!(
        (last.kinetic_energy_J / energy - 1.0).abs() < 1e-3,
        "{last:?}"
    );
    assert!(gap(last).abs() < 1e-4 * energy, "{}", gap(last));
}

/// A column of four elements on a fixed base.
pub(super) fn column() -> (Model, usize) {
    let mut model = scene::empty();
    let solid = scene::heavy(1e3, 0.0, DENSITY);
    let column = scene::block(&mut model, [0.0; 3], [50.0, 50.0, 200.0], [1, 1, 4], &solid);
    scene::hold(&mut model, column.face(Face::Bottom), [true; 3]);
    let top = column.face(Face::Top)[0] as usize;
    (model, top)
}

#[test]
fn a_column_settles_under_its_weight_and_stays() {
    let (mut model, top) = column();
    let down = [0.0, 0.0, -G];
    let settle = scene::left_alone(Gravity::Growing(down), 1.0, 4, EXACT);
    let stay = scene::set_free(Gravity::Constant(down), 0.1, 20, EXACT, -0.05);
    model.steps = vec![settle, stay];
    let recording = completed(&model);
    // ϱgL²/2E: linear elements are exact at their nodes.
    let expected = -DENSITY * G * 200.0 * 200.0 / (2.0 * 1e3);
    for row_frame in recording.rows.iter().zip(&recording.frames) {
        let (row, frame) = row_frame;
        if row.step == 0 && row.time < 1.0 {
            continue;
        }
        let u = frame.displacement[top][2];
        // The corotated element uses the engineering strain: linear up to σ/E = 4e-6.
        assert!((u / expected - 1.0).abs() < 1e-5, "{u} {expected}");
    }
    let settled = recording.rows.iter().rfind(|r| r.step == 0).unwrap();
    let last = recording.rows.last().unwrap();
    assert!((settled.external_work_J / settled.elastic_energy_J - 1.0).abs() < 1e-6);
    // No motion beyond the residual.
    assert!(last.kinetic_energy_J < 1e-9 * last.elastic_energy_J);
}

#[test]
fn a_driven_beam_supplies_the_energy_of_the_moved_bodies() {
    let (mut model, _) = column();
    let top: Vec<u32> = (0..model.mesh.nodes.len() as u32)
        .filter(|&n| model.mesh.nodes[n as usize][2] == 200.0)
        .collect();
    scene::beam(&mut model, top);
    let pulled = [
        BeamMotion::Locked,
        BeamMotion::Locked,
        BeamMotion::Driven(1.0),
    ];
    for procedure in [
        Procedure::QuasiStatic,
        Procedure::Dynamic {
            alpha: -0.1,
            damping: Rayleigh {
                mass: 10.0,
                stiffness: 1e-5,
            },
        },
    ] {
        let mut step = scene::step(pulled, 2, 100, 1e-8);
        step.duration = 0.01;
        step.procedure = procedure;
        model.steps = vec![step];
        let recording = completed(&model);
        let last = recording.rows.last().unwrap();
        let worst = recording
            .rows
            .iter()
            .map(|r| gap(r).abs())
            .fold(0.0, f64::max);
        println!("{procedure:?}: {worst:e} of {last:?}");
        // Tolerance: the residual.
        assert!(worst < 1e-5 * last.external_work_J);
        assert!(last.kinetic_energy_J > 0.0);
    }
}

#[test]
fn inertia_without_mass_is_rejected() {
    let mut model = scene::empty();
    let solid = scene::elastic(1e4, 0.2);
    scene::block(&mut model, [0.0; 3], [60.0, 40.0, 50.0], [1, 1, 1], &solid);
    model.steps = vec![scene::set_free(Gravity::None, 1.0, 10, EXACT, 0.0)];
    let error = wythe::solve::run(&model, &mut Recording::default()).unwrap_err();
    assert!(matches!(error, RunError::NoMass { step: 0, .. }), "{error}");
    assert!(error.to_string().contains("density"), "{error}");
}

/// Divergence theorem over the faces; each is the mean of both ways to divide it into triangles.
fn volume_of(x: [[f64; 3]; 8]) -> f64 {
    use nalgebra::Vector3;
    let x = x.map(Vector3::from);
    let faces = wythe::element::hex8::FACES.iter();
    faces
        .map(|face| {
            let c = face.map(|a| x[a]);
            let cut = |i: [usize; 4]| {
                c[i[0]].dot(&c[i[1]].cross(&c[i[2]])) + c[i[0]].dot(&c[i[2]].cross(&c[i[3]]))
            };
            0.5 * (cut([0, 1, 2, 3]) + cut([1, 2, 3, 0])) / 6.0
        })
        .sum()
}

#[test]
fn the_total_of_the_masses_is_the_mass_and_supports_do_not_move() {
    let mut model = block_in_the_air();
    let mass = |model: &Model| {
        let bulk = Bulk::new(model).unwrap();
        Mass::new(model, &bulk, &DofMap::new(model))
    };
    let even = mass(&model);
    // Tolerance, here and below: rounding of a few sums.
    assert!((even.total() / (DENSITY * 60.0 * 40.0 * 50.0) - 1.0).abs() < 1e-13);
    // A corner that is pulled out gains mass; Gauss points integrate the skewed volume exactly.
    let corner = model.mesh.nodes.len() - 1;
    model.mesh.nodes[corner] = [70.0, 44.0, 58.0];
    let uneven = mass(&model);
    let elements = 0..model.mesh.elements.len();
    let volume: f64 = elements.map(|e| volume_of(model.mesh.corners(e))).sum();
    assert!((uneven.total() / (DENSITY * volume) - 1.0).abs() < 1e-13);
    assert!(uneven.node[corner] > even.node[corner]);
    scene::hold(&mut model, vec![0], [true; 3]);
    let held = mass(&model);
    let moving: f64 = held.slot.iter().sum();
    let expected = 3.0 * (held.total() - held.node[0]);
    assert!((moving / expected - 1.0).abs() < 1e-13);
}

#[test]
fn a_wall_moved_slowly_by_backward_euler_is_that_of_statics() {
    let mut model = crate::common::small_wall();
    for material in &mut model.materials {
        if let wythe::material::MaterialParameters::DamagePlasticity(p) = &mut material.parameters {
            p.elastic.density = 1.9e-9;
        }
    }
    let still = completed(&model);
    model.steps[1].procedure = Procedure::QuasiStatic;
    let moved = completed(&model);
    let peak = |r: &Recording| r.rows.iter().map(|r| r.force_kN).fold(0.0, f64::max);
    let last = moved.rows.last().unwrap();
    println!("{} {} {last:?}", peak(&still), peak(&moved));
    // 0.3 mm in a second: inertia is negligible, and paths and increments differ within their tolerance.
    assert!((peak(&moved) / peak(&still) - 1.0).abs() < 5e-3);
    let inside = last.elastic_energy_J + last.interface_dissipation_J;
    assert!(last.kinetic_energy_J < 1e-3 * inside && last.kinetic_energy_J > 0.0);
    assert!(gap(last).abs() < 1e-2 * last.external_work_J, "{last:?}");
}

/// The example of the wall J7D with these keys replaced.
fn wall_with(overrides: &[(&str, &str)]) -> Result<Model, wythe::error::ModelError> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("examples/03_shear_wall_j7d.toml")).unwrap();
    let mut all = vec![("materials.brick.density", "1900 kg/m^3")];
    all.push(("materials.mortar.density", "1900 kg/m^3"));
    all.extend(overrides);
    let all: Vec<_> = all
        .iter()
        .map(|(k, v)| ((*k).into(), (*v).into()))
        .collect();
    // Files are named relative to the deck's folder.
    let file = root.join("tests/data/ground/deck.toml");
    let deck = Deck::from_str_with(&text, &file.display().to_string(), &all)?;
    Ok(Model::from_deck(&deck)?.0)
}

#[test]
fn keys_of_inertia_reach_the_model() {
    let model = wall_with(&[
        ("steps.0.procedure", "quasi_static"),
        ("steps.1.procedure", "dynamic"),
        ("steps.1.alpha", "-0.1"),
        (
            "steps.1.rayleigh",
            "{ mass = \"0.5 s^-1\", stiffness = \"2 ms\" }",
        ),
        ("steps.1.ground", "{ x = \"pulse.csv\" }"),
        ("steps.1.ground_unit", "9.81 m/s^2"),
    ])
    .unwrap();
    assert_eq!(model.steps[0].procedure, Procedure::QuasiStatic);
    let expected = Procedure::Dynamic {
        alpha: -0.1,
        damping: Rayleigh {
            mass: 0.5,
            stiffness: 0.002,
        },
    };
    assert_eq!(model.steps[1].procedure, expected);
    let [x, y, z] = model.steps[1].ground.at(0.05);
    // Tolerance: one product and one interpolation.
    assert!((x - 981.0).abs() < 1e-9 && y == 0.0 && z == 0.0);
    assert!(!wall_with(&[]).unwrap().steps[1].procedure.has_inertia());
}

#[test]
fn a_damping_ratio_at_two_frequencies_gives_both_factors() {
    let damping = Rayleigh::at(0.05, [8.0, 40.0]);
    for frequency in [8.0, 40.0] {
        // Rounding.
        assert!((damping.ratio(frequency) - 0.05).abs() < 1e-15);
    }
    // 2ζ √(f₁f₂)/(f₁+f₂) at √(f₁f₂), where it is least.
    let middle = 320.0_f64.sqrt();
    assert!((damping.ratio(middle) - 0.1 * middle / 48.0).abs() < 1e-15);
    assert!(damping.ratio(20.0) < 0.05 && damping.ratio(4.0) > 0.05 && damping.ratio(80.0) > 0.05);
    let by_ratio = "{ ratio = \"5 %\", frequencies = [\"8 Hz\", \"2400 min^-1\"] }";
    let keys = [
        ("steps.1.procedure", "dynamic"),
        ("steps.1.alpha", "-0.1"),
        ("steps.1.rayleigh", by_ratio),
    ];
    let Procedure::Dynamic { damping: read, .. } = wall_with(&keys).unwrap().steps[1].procedure
    else {
        panic!("the step is not dynamic");
    };
    assert!((read.mass / damping.mass - 1.0).abs() < 1e-14, "{read:?}");
    assert!(
        (read.stiffness / damping.stiffness - 1.0).abs() < 1e-14,
        "{read:?}"
    );
}

#[test]
fn keys_of_inertia_are_checked() {
    let dynamic = ("steps.1.procedure", "dynamic");
    for (overrides, key) in [
        (vec![("steps.1.alpha", "-0.1")], "steps.1.alpha"),
        (vec![dynamic, ("steps.1.alpha", "0.1")], "steps.1.alpha"),
        (vec![dynamic, ("steps.1.alpha", "-0.4")], "steps.1.alpha"),
        (
            vec![dynamic, ("steps.1.rayleigh", "{ mass = -1 }")],
            "steps.1.rayleigh.mass",
        ),
        (
            vec![dynamic, ("steps.1.rayleigh", "{ ratio = 0.05 }")],
            "steps.1.rayleigh",
        ),
        (
            vec![
                dynamic,
                (
                    "steps.1.rayleigh",
                    "{ ratio = 0.05, frequencies = [8, 40], mass = 1 }",
                ),
            ],
            "steps.1.rayleigh",
        ),
        (
            vec![
                dynamic,
                ("steps.1.rayleigh", "{ ratio = 1.5, frequencies = [8, 40] }"),
            ],
            "steps.1.rayleigh.ratio",
        ),
        (
            vec![
                dynamic,
                ("steps.1.rayleigh", "{ ratio = 0.1, frequencies = [0, 40] }"),
            ],
            "steps.1.rayleigh.frequencies",
        ),
        (
            vec![dynamic, ("steps.1.ground", "{ x = \"missing.csv\" }")],
            "steps.1.ground.x",
        ),
        (
            vec![dynamic, ("steps.1.ground_unit", "1 m/s^2")],
            "steps.1.ground_unit",
        ),
        (
            vec![
                dynamic,
                ("steps.1.ground", "{ x = \"record.csv\" }"),
                ("steps.1.ground_factor", "{ z = 2 }"),
            ],
            "steps.1.ground_factor.z",
        ),
        (
            vec![dynamic, ("materials.mortar.density", "0")],
            "steps.1.procedure",
        ),
    ] {
        let error = wall_with(&overrides).unwrap_err();
        assert_eq!(error.key(), key, "{error}");
        assert!(!error.advice().is_empty());
    }
}

/// HHT with increments that are long compared with the impact returned 2.4 times the energy.
#[test]
fn a_block_that_falls_on_a_floor_gains_no_energy() {
    let scene = r#"
        [[blocks]]
        name = "floor"
        size = [300, 200, 50]
        at = [-50, -50, -50]
        material = "stone"
        [[blocks]]
        name = "unit"
        size = [200, 100, 100]
        at = [0, 0, 20]
        material = "stone"
        [[contacts]]
        slave = "unit.bottom"
        master = "floor.top"
        interface = "dry"
        [[supports]]
        on = "floor"
    "#;
    let free = r#"
        [[steps]]
        kind = "free"
        gravity = "9.81 m/s^2"
        procedure = "dynamic"
        duration = 0.3
        increments = { initial = 0.005, max = 0.005 }
    "#;
    let model = blocks::model(scene, free);
    let rows = completed(&model).rows;
    // m g h of 4 kg and 20 mm, plus a little for the compression of the floor.
    let most = 4.0 * 9.81 * 0.02;
    let before = |r: &&HistoryRow| r.time < 0.0638;
    let fallen = rows.iter().rfind(before).unwrap();
    assert!(fallen.kinetic_energy_J > 0.95 * most);
    for row in &rows {
        assert!(row.kinetic_energy_J < 1.01 * most, "{row:?}");
    }
    // The block comes to rest.
    assert!(rows.last().unwrap().kinetic_energy_J < 0.01 * most);
}
