//! General contact between bodies that may meet anywhere, from any direction and at any speed.

use crate::common::inside::{penetration, positions};
use crate::common::scene::{self, Block, DENSITY, G, Recording, imbalance, most};
use wythe::model::Model;
use wythe::model::scene::{Gravity, Procedure};
use wythe::state::HistoryRow;

const E: f64 = 1e4;

/// Largest excess of kinetic, elastic and dissipated energy over the energy input, relative to the input.
fn gain(recording: &Recording) -> f64 {
    let of = |r: &HistoryRow| {
        r.kinetic_energy_J + r.elastic_energy_J + r.interface_dissipation_J - r.external_work_J
    };
    let gained = recording
        .rows
        .iter()
        .map(of)
        .fold(f64::NEG_INFINITY, f64::max);
    gained / most(recording, |r| r.external_work_J.abs())
}

fn velocity(model: &Model, recording: &Recording, block: &Block) -> [f64; 3] {
    let dofs = wythe::assembly::DofMap::new(model);
    let state = recording.states.last().unwrap();
    let nodes = block.nodes();
    [0, 1, 2].map(|i| {
        let of = |n: &u32| state.velocity[dofs.slot[*n as usize][i] as usize];
        nodes.iter().map(of).sum::<f64>() / nodes.len() as f64
    })
}

fn tell(model: &Model, recording: &Recording) -> f64 {
    let deep = penetration(model, recording);
    let last = recording.rows.last().unwrap();
    println!(
        "  deepest {deep:.2e} mm, balance {:.1e}, gain {:.1e}, kinetic {:.3e} of {:.3e} J, friction {:.2e}, numerical {:.2e}",
        imbalance(recording),
        gain(recording),
        last.kinetic_energy_J,
        most(recording, |r| r.external_work_J.abs()),
        last.interface_dissipation_J,
        last.numerical_dissipation_J,
    );
    deep
}

/// Two cubes of 100 mm in free flight. The second is rotated and has this velocity.
fn collide(
    at: [f64; 3],
    turns: &[([f64; 3], f64)],
    v: [f64; 3],
    increments: usize,
    time: f64,
) -> (Model, Recording, [Block; 2]) {
    let mut model = scene::empty();
    let solid = scene::heavy(E, 0.2, DENSITY);
    let first = scene::block(&mut model, [-50.0; 3], [100.0; 3], [1, 1, 1], &solid);
    let low = at.map(|x| x - 50.0);
    let second = scene::block(&mut model, low, [100.0; 3], [1, 1, 1], &solid);
    for (axis, angle) in turns {
        scene::turn(&mut model, &second, at, *axis, angle.to_radians());
    }
    scene::throw(&mut model, &second, v);
    scene::general(&mut model, 0.5);
    model.steps = vec![scene::set_free(
        Gravity::None,
        time,
        increments,
        5e-3,
        -0.05,
    )];
    let recording = scene::completed(&model);
    (model, recording, [first, second])
}

#[test]
fn cubes_collide_face_edge_and_corner_first() {
    let to_corner = 2.0_f64.sqrt().atan().to_degrees();
    let (x, z) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    /// Position of a block: name, place, rotations about axes.
    type Lying = (&'static str, [f64; 3], Vec<([f64; 3], f64)>);
    let cases: [Lying; 7] = [
        ("face on face", [0.0, 0.0, 110.0], vec![]),
        ("face on face, half over", [47.0, 31.0, 110.0], vec![]),
        ("edge on face", [3.0, 5.0, 130.0], vec![(x, 45.0)]),
        (
            "corner on face",
            [3.0, 5.0, 145.0],
            vec![(z, 45.0), (x, to_corner)],
        ),
        (
            "crossed edges",
            [0.0, 3.0, 130.0],
            vec![(x, 45.0), (z, 30.0)],
        ),
        ("flat, turned", [2.0, 3.0, 110.0], vec![(z, 40.0)]),
        (
            "corner on the rim",
            [49.0, 5.0, 145.0],
            vec![(z, 45.0), (x, to_corner)],
        ),
    ];
    // Speed [mm/s], increments, time [s], and allowed penetration [mm]. At 20 m/s the bodies deform by 0.5 mm, and
    // faces warp between their corners.
    let speeds = [
        (-1000.0, 60, 0.06, 0.01),
        (-1000.0, 600, 0.06, 0.01),
        (-20000.0, 40, 0.02, 0.2),
    ];
    for (name, at, turns) in cases {
        for (v, mut increments, time, most) in speeds {
            if name == "corner on the rim" && v < -1e4 {
                // A corner that leaves a rim at 20 m/s needs finer increments: in 40, 60, 100, 200 and 1000 of them the
                // balance closes to 1.1, 1.7, 0.7, 0.14 and 0.02 %.
                increments = 100;
            }
            println!("{name}, {v} mm/s, {increments} increments");
            let (model, recording, [a, b]) = collide(at, &turns, [0.0, 0.0, v], increments, time);
            let deep = tell(&model, &recording);
            let [va, vb] = [&a, &b].map(|b| velocity(&model, &recording, b)[2]);
            let restitution = (va - vb) / v;
            println!("  {va:.1} and {vb:.1} mm/s, restitution {restitution:.3}");
            assert!(deep < most, "{name}: {deep}");
            // HHT may create a hundredth of the kinetic energy of an impact before backward Euler dissipates it.
            assert!(
                imbalance(&recording) < 1e-2 && gain(&recording) < 1e-2,
                "{name}"
            );
            assert!(((va + vb) / v - 1.0).abs() < 1e-3, "{name}: {va} {vb}");
            // Bodies whose contact stays together after a blow beside their middles turn about it, and their middles go on
            // approaching: r² over the sum with the square of the radius of gyration, r half of the distance of the middles.
            let [beside, gyration] = [(at[0] * at[0] + at[1] * at[1]) / 4.0, 1e4 / 6.0];
            let least = -beside / (beside + gyration);
            assert!(
                (least..=1.0).contains(&restitution),
                "{name}: {restitution}"
            );
        }
    }
}

const DOWN: [f64; 3] = [0.0, 0.0, -G];

/// A fixed floor of 100 mm thickness.
fn floor(model: &mut Model, size: f64) {
    let solid = scene::heavy(E, 0.2, DENSITY);
    let low = [-0.5 * size, -0.5 * size, -100.0];
    let block = scene::block(model, low, [size, size, 100.0], [1, 1, 1], &solid);
    scene::hold(model, block.nodes(), [true; 3]);
}

/// Height of the highest and the lowest corner of a block at the end [mm].
fn heights(model: &Model, recording: &Recording, block: &Block) -> [f64; 2] {
    let x = positions(model, recording, recording.frames.len() - 1);
    let z = || block.nodes().into_iter().map(|n| x[n as usize][2]);
    [z().fold(f64::MIN, f64::max), z().fold(f64::MAX, f64::min)]
}

/// Runs the model under gravity.
fn let_fall(model: &mut Model, time: f64, increments: usize, procedure: Procedure) -> Recording {
    let mut step = scene::set_free(Gravity::Constant(DOWN), time, increments, 5e-3, -0.05);
    step.procedure = procedure;
    step.increments.min *= 1e-2;
    step.tolerance.max_iterations = 25;
    model.steps = vec![step];
    let begin = std::time::Instant::now();
    let recording = scene::completed(model);
    println!("  {:.2} s", begin.elapsed().as_secs_f64());
    recording
}

fn dynamic() -> Procedure {
    Procedure::Dynamic {
        alpha: -0.05,
        damping: wythe::model::scene::Rayleigh::default(),
    }
}

#[test]
fn a_block_falls_on_the_floor_and_comes_to_rest() {
    let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for turns in [vec![], vec![(y, 20.0_f64)], vec![(y, 20.0), (x, 15.0)]] {
        for procedure in [Procedure::QuasiStatic, dynamic()] {
            let mut model = scene::empty();
            floor(&mut model, 1000.0);
            let solid = scene::heavy(E, 0.2, DENSITY);
            let low = [-50.0, -50.0, 60.0];
            let block = scene::block(&mut model, low, [100.0; 3], [1, 1, 1], &solid);
            for (axis, angle) in &turns {
                let centre = [0.0, 0.0, 110.0];
                scene::turn(&mut model, &block, centre, *axis, angle.to_radians());
            }
            scene::general(&mut model, 0.5);
            let recording = let_fall(&mut model, 1.0, 400, procedure);
            assert!(tell(&model, &recording) < 1e-3);
            assert!(imbalance(&recording) < 1e-2 && gain(&recording) < 1e-2);
            let [top, bottom] = heights(&model, &recording, &block);
            // Tolerance: own weight over the penalty, some 1e-5 mm.
            assert!(
                (top - 100.0).abs() < 1e-3 && bottom.abs() < 1e-3,
                "{top} {bottom}"
            );
            let last = recording.rows.last().unwrap();
            assert!(last.kinetic_energy_J < 1e-9 * last.external_work_J);
        }
    }
}

/// A beam falls across a block of about its own length; `over` [mm] of it projects over the rim at either end. Only
/// its four corners, the ends of the edges that cross the rims, carry it. Returns its final height [mm].
fn beam_across(over: f64, height: f64) -> (Model, Recording, f64) {
    let mut model = scene::empty();
    floor(&mut model, 200.0);
    let solid = scene::heavy(E, 0.2, DENSITY);
    let length = 200.0 / (1.0 - 2.0 * over);
    let low = [-30.0, -0.5 * length, height];
    let beam = scene::block(&mut model, low, [60.0, length, 50.0], [1, 1, 1], &solid);
    scene::general(&mut model, 0.5);
    let recording = let_fall(&mut model, 0.2, 80, Procedure::QuasiStatic);
    let [_, bottom] = heights(&model, &recording, &beam);
    (model, recording, bottom)
}

#[test]
fn a_beam_whose_ends_meet_a_rim_is_supported() {
    for over in [-1e-5, 0.0, 3e-7, 1e-6, 2e-6, 3e-6, 3.9e-6, 5e-6, 1e-5, 1e-3] {
        let (model, recording, bottom) = beam_across(over, 5.0);
        println!("{over:e} over: at {bottom:e} mm");
        assert!(tell(&model, &recording) < 1e-3 && bottom > -1e-3, "{over}");
    }
}

/// The same beam, placed half a millimetre too low.
#[test]
fn a_beam_placed_within_a_block_stays_there_at_a_rim() {
    for over in [-1e-3, -1e-5, 0.0, 2e-6, 1e-5, 1e-3] {
        let (model, recording, bottom) = beam_across(over, -0.5);
        println!("{over:e} over: at {bottom:e} mm");
        tell(&model, &recording);
        assert!((bottom + 0.5).abs() < 1e-3, "{over}: {bottom}");
    }
}

#[test]
fn a_thin_plate_is_not_penetrated_by_any_increment() {
    for (speed, increments) in [(-5e3, 20), (-5e4, 5), (-5e4, 100)] {
        let mut model = scene::empty();
        let solid = scene::heavy(E, 0.2, DENSITY);
        let low = [-100.0, -100.0, -10.0];
        let plate = scene::block(&mut model, low, [200.0, 200.0, 10.0], [1, 1, 1], &solid);
        scene::hold(&mut model, plate.nodes(), [true; 3]);
        let low = [-20.0, -10.0, 50.0];
        let ball = scene::block(&mut model, low, [40.0; 3], [1, 1, 1], &solid);
        scene::throw(&mut model, &ball, [0.0, 0.0, speed]);
        scene::general(&mut model, 0.5);
        let time = 400.0 / -speed;
        model.steps = vec![scene::set_free(
            Gravity::None,
            time,
            increments,
            5e-3,
            -0.05,
        )];
        let recording = scene::completed(&model);
        let v = velocity(&model, &recording, &ball)[2];
        let [_, bottom] = heights(&model, &recording, &ball);
        println!("{speed} mm/s, {increments}: back at {v:.0} mm/s, {bottom} mm");
        assert!(
            bottom > -0.1 && v > -1e-3 * -speed && v <= -speed,
            "{v} {bottom}"
        );
        assert!(gain(&recording) < 1e-2);
    }
}

#[test]
fn a_block_that_comes_from_the_side_is_stopped_by_the_side() {
    // One millimetre below the top. Planned contact lets the block pass, and a corner detected by its depth would be
    // lifted onto the top.
    let mut model = scene::empty();
    let solid = scene::heavy(E, 0.2, DENSITY);
    let low = [0.0, -20.0, -50.0];
    let table = scene::block(&mut model, low, [200.0, 100.0, 50.0], [2, 1, 1], &solid);
    scene::hold(&mut model, table.nodes(), [true; 3]);
    let low = [205.0, 0.0, -1.0];
    let slider = scene::block(&mut model, low, [100.0, 60.0, 50.0], [4, 2, 2], &solid);
    scene::throw(&mut model, &slider, [-1000.0, 0.0, 0.0]);
    scene::general(&mut model, 0.4);
    model.steps = vec![scene::set_free(Gravity::None, 0.02, 20, 5e-3, -0.05)];
    let recording = scene::completed(&model);
    assert!(tell(&model, &recording) < 0.01);
    assert!(imbalance(&recording) < 1e-2 && gain(&recording) < 1e-2);
    let x = positions(&model, &recording, recording.frames.len() - 1);
    let left = slider
        .nodes()
        .iter()
        .map(|&n| x[n as usize][0])
        .fold(f64::MAX, f64::min);
    assert!(left > 199.9, "{left}");
}

#[test]
fn dominoes_fall_one_on_the_other() {
    let mut model = scene::empty();
    floor(&mut model, 2000.0);
    let solid = scene::heavy(E, 0.2, DENSITY);
    let stones: Vec<Block> = (0..3)
        .map(|i| {
            let low = [60.0 * f64::from(i), 0.0, 0.0];
            scene::block(&mut model, low, [20.0, 50.0, 100.0], [1, 1, 1], &solid)
        })
        .collect();
    let (foot, y) = ([20.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    scene::turn(&mut model, &stones[0], foot, y, 15.0_f64.to_radians());
    scene::general(&mut model, 0.4);
    let recording = let_fall(&mut model, 1.0, 300, Procedure::QuasiStatic);
    assert!(tell(&model, &recording) < 0.01);
    assert!(imbalance(&recording) < 1e-2 && gain(&recording) < 1e-2);
    // The last stone lies on its side, the others lean on each other.
    let tops: Vec<f64> = (stones.iter())
        .map(|s| heights(&model, &recording, s)[0])
        .collect();
    println!("  {tops:?}");
    assert!(
        (tops[2] - 20.0).abs() < 0.01 && tops.iter().all(|t| *t < 70.0),
        "{tops:?}"
    );
    let last = recording.rows.last().unwrap();
    assert!(last.kinetic_energy_J < 1e-6 * last.external_work_J);
}

#[test]
fn blocks_are_thrown_on_a_heap() {
    let mut model = scene::empty();
    floor(&mut model, 3000.0);
    let solid = scene::heavy(E, 0.2, DENSITY);
    let mut random = crate::common::Random(7);
    for i in 0..6 {
        let size = [0, 1, 2].map(|_| 60.0 + 60.0 * random.uniform());
        let z = 120.0 + 170.0 * f64::from(i);
        let low = [60.0 * random.signed(), 60.0 * random.signed(), z];
        let stone = scene::block(&mut model, low, size, [1, 1, 1], &solid);
        let axis = [random.signed(), random.signed(), random.signed()];
        let centre = [0, 1, 2].map(|d| low[d] + 0.5 * size[d]);
        scene::turn(&mut model, &stone, centre, axis, 3.0 * random.uniform());
        let v = [200.0 * random.signed(), 200.0 * random.signed(), -1000.0];
        scene::throw(&mut model, &stone, v);
    }
    scene::general(&mut model, 0.6);
    let recording = let_fall(&mut model, 0.7, 300, Procedure::QuasiStatic);
    assert!(tell(&model, &recording) < 0.05);
    assert!(imbalance(&recording) < 1e-2 && gain(&recording) < 1e-2);
}
