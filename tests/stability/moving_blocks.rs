//! Dry blocks that slide, brake and rock, compared with rigid-body mechanics.

use crate::common::blocks;
use crate::common::scene::{self, Block, DENSITY, Face, G, Recording, completed, imbalance};
use wythe::contact::CohesiveFrictional;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::model::scene::{ContactPoints, Gravity, Procedure, Tangent};

const MU: f64 = 0.4;

/// A block of 100 × 60 × 50 mm on a table of length `length`, without any motion.
fn on_a_table(length: f64) -> (Model, Block) {
    let mut model = scene::empty();
    let solid = scene::heavy(1e4, 0.2, DENSITY);
    let cells = [(length / 100.0) as usize, 1, 1];
    let table = scene::block(
        &mut model,
        [-100.0, -20.0, -50.0],
        [length, 100.0, 50.0],
        cells,
        &solid,
    );
    let slider = scene::block(&mut model, [0.0; 3], [100.0, 60.0, 50.0], [4, 2, 2], &solid);
    scene::hold(&mut model, table.nodes(), [true; 3]);
    scene::master(&mut model, &table, Face::Top);
    let k = 500.0 * 1e4 / 25.0;
    scene::slave(
        &mut model,
        &slider,
        Face::Bottom,
        CohesiveFrictional::dry(MU, k, k / 2.4),
    );
    (model, slider)
}

/// Time, mean displacement and mean velocity in x of a block at each accepted increment.
fn way(model: &Model, recording: &Recording, block: &Block) -> Vec<[f64; 3]> {
    let dofs = wythe::assembly::DofMap::new(model);
    let nodes = block.nodes();
    let mean = |of: &[f64]| {
        let sum: f64 = nodes
            .iter()
            .map(|&n| of[dofs.slot[n as usize][0] as usize])
            .sum();
        sum / nodes.len() as f64
    };
    recording
        .states
        .iter()
        .map(|s| [s.time, mean(&s.q), mean(&s.velocity)])
        .collect()
}

#[test]
fn a_block_slides_down_a_slope() {
    let (mut model, slider) = on_a_table(1400.0);
    // The table is level and gravity is tilted by 30°.
    let (sin, cos) = (0.5, 0.75_f64.sqrt());
    let settle = Gravity::Growing([0.0, 0.0, -G * cos]);
    let slide = Gravity::Constant([G * sin, 0.0, -G * cos]);
    // 1506.7 mm/s²: 1 m in 1.1521 s.
    let expected = G * (sin - MU * cos);
    assert!((expected - 1506.7).abs() < 0.05);
    let duration = (2000.0 / expected).sqrt();
    for (residual, tolerance) in [(5e-2, 2e-3), (1e-4, 2e-4)] {
        model.steps = vec![
            scene::left_alone(settle, 1.0, 2, residual),
            scene::set_free(slide, duration, 100, residual, -0.05),
        ];
        let recording = completed(&model);
        let [_, u, v] = *way(&model, &recording, &slider).last().unwrap();
        println!(
            "{residual}: {u} mm, {v} mm/s, energies {:.1e}",
            imbalance(&recording)
        );
        // The first increment goes half a Δt² too far, 1e-4 of the distance. The rest is the residual of equilibrium.
        assert!((u / 1000.0 - 1.0).abs() < tolerance, "{u}");
        assert!((v / (expected * duration) - 1.0).abs() < tolerance, "{v}");
        assert!(imbalance(&recording) < 1e-2);
    }
}

#[test]
fn a_block_brakes() {
    let (mut model, slider) = on_a_table(600.0);
    let down = [0.0, 0.0, -G];
    let v0 = 1000.0;
    model.initial_velocity = vec![[0.0; 3]; model.mesh.nodes.len()];
    for n in slider.nodes() {
        model.initial_velocity[n as usize] = [v0, 0.0, 0.0];
    }
    // v²/(2μg) = 127.42 mm in v/(μg) = 0.2548 s.
    let (distance, time) = (v0 * v0 / (2.0 * MU * G), v0 / (MU * G));
    assert!((distance - 127.42).abs() < 0.01);
    for residual in [5e-2, 1e-4] {
        model.steps = vec![
            scene::left_alone(Gravity::Growing(down), 1.0, 2, residual),
            scene::set_free(Gravity::Constant(down), 1.4 * time, 140, residual, -0.1),
        ];
        let recording = completed(&model);
        let way = way(&model, &recording, &slider);
        let stopped: Vec<_> = way.iter().filter(|w| w[0] > 1.0 + 1.2 * time).collect();
        println!(
            "{residual}: {:?}, energies {:.1e}",
            way.last(),
            imbalance(&recording)
        );
        for [_, u, v] in stopped {
            // Backward Euler errs by ½ μg Δt² in the first and in the last increment, 1.3e-2 mm; the rest is the
            // residual of equilibrium.
            assert!((u / distance - 1.0).abs() < 2e-3, "{u}");
            // The block vibrates in shear, which the scheme damps.
            assert!(v.abs() < 1e-2 * v0, "{v}");
        }
        assert!(imbalance(&recording) < 1e-2);
    }
}

#[test]
fn a_block_that_comes_from_the_side_is_not_caught_below_the_surface() {
    // Only the top and bottom faces are contact pairs. The bottom is one millimetre below the top when its corners
    // pass the edge; a penalty of 200 GPa/mm would throw the block off.
    let mut model = scene::empty();
    let solid = scene::heavy(1e4, 0.2, DENSITY);
    let table = scene::block(
        &mut model,
        [0.0, -20.0, -50.0],
        [200.0, 100.0, 50.0],
        [2, 1, 1],
        &solid,
    );
    let slider = scene::block(
        &mut model,
        [201.0, 0.0, -1.0],
        [100.0, 60.0, 50.0],
        [4, 2, 2],
        &solid,
    );
    scene::hold(&mut model, table.nodes(), [true; 3]);
    scene::master(&mut model, &table, Face::Top);
    let k = 500.0 * 1e4 / 25.0;
    scene::slave(
        &mut model,
        &slider,
        Face::Bottom,
        CohesiveFrictional::dry(MU, k, k / 2.4),
    );
    let v0 = -1000.0;
    model.initial_velocity = vec![[0.0; 3]; model.mesh.nodes.len()];
    for n in slider.nodes() {
        model.initial_velocity[n as usize][0] = v0;
    }
    model.steps = vec![scene::set_free(
        Gravity::Constant([0.0; 3]),
        0.05,
        50,
        1e-3,
        -0.05,
    )];
    let recording = completed(&model);
    for [t, u, v] in way(&model, &recording, &slider) {
        // No force acts on the block: the tolerances are rounding.
        assert!(
            (u - v0 * t).abs() < 1e-6 * 50.0 && (v / v0 - 1.0).abs() < 1e-6,
            "{u} {v}"
        );
    }
}

/// The block of the reference, 0.2 × 1.0 m, rotated by θ about its lower right edge.
fn tilted(theta: f64, points: ContactPoints) -> (Model, Block) {
    let mut model = scene::empty();
    let solid = scene::heavy(3e4, 0.2, DENSITY);
    let floor = scene::block(
        &mut model,
        [-300.0, -50.0, -100.0],
        [600.0, 200.0, 100.0],
        [3, 1, 1],
        &solid,
    );
    scene::hold(&mut model, floor.nodes(), [true; 3]);
    scene::master(&mut model, &floor, Face::Top);
    let block = scene::block(
        &mut model,
        [0.0; 3],
        [200.0, 100.0, 1000.0],
        [4, 1, 20],
        &solid,
    );
    let (sin, cos) = theta.sin_cos();
    for n in block.nodes() {
        let x = &mut model.mesh.nodes[n as usize];
        let arm = [x[0] - 200.0, x[2]];
        x[0] = cos * arm[0] + sin * arm[1];
        x[2] = -sin * arm[0] + cos * arm[1];
    }
    let k = 500.0 * 3e4 / 50.0;
    scene::slave(
        &mut model,
        &block,
        Face::Bottom,
        CohesiveFrictional::dry(1.0, k, k / 2.4),
    );
    scene::points(&mut model, points);
    (model, block)
}

#[test]
fn a_rocking_block_falls_back_in_a_quarter_of_housners_period() {
    let table = crate::common::csv("exact/rocking_block_housner.csv");
    let alpha = 0.2_f64.atan();
    for (ratio, period) in table["theta0_over_alpha"].iter().zip(&table["T_s"]) {
        let theta = ratio * alpha;
        let (mut model, block) = tilted(theta, ContactPoints::Corner);
        let quarter = period / 4.0;
        let duration = 1.5 * quarter;
        model.steps = vec![scene::set_free(
            Gravity::Constant([0.0, 0.0, -G]),
            duration,
            150,
            5e-3,
            -0.1,
        )];
        let recording = completed(&model);
        // Height of the lower left edge over time, and its passage through the floor.
        let corner = block.corner() as usize;
        let heights: Vec<[f64; 2]> = recording
            .frames
            .iter()
            .map(|f| {
                [
                    f.time,
                    model.mesh.nodes[corner][2] + f.displacement[corner][2],
                ]
            })
            .collect();
        let impact = heights
            .windows(2)
            .find(|w| w[1][1] <= 0.0)
            .expect("an impact");
        let [[t0, z0], [t1, z1]] = [impact[0], impact[1]];
        let time = t0 + (t1 - t0) * z0 / (z0 - z1);
        println!(
            "{ratio}: impact at {time:.5} s, T/4 = {quarter:.5} s ({:+.2} %), energies {:.1e}",
            100.0 * (time / quarter - 1.0),
            imbalance(&recording)
        );
        // The linearised reference errs by 0.03 to 0.27 %.
        assert!((time / quarter - 1.0).abs() < 1e-2, "{time} {quarter}");
        assert!(imbalance(&recording) < 1e-2);
    }
}

/// With the tangent of slip the first iterates of a reversed drive alternated between the two limits of friction, for
/// any size of the increment.
#[test]
fn a_block_that_slid_is_pulled_back() {
    let deck = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/stability/cases/04-stick-slip/deck.toml"
    );
    let set = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    for tangent in ["secant", "consistent", "direct"] {
        for mesh in ["[1, 1, 1]", "[2, 1, 1]", "[2, 2, 2]"] {
            let overrides = [
                set("steps.1.tangent", tangent),
                set("steps.2.tangent", tangent),
                set("blocks.1.mesh", mesh),
            ];
            let deck = Deck::load(deck, &overrides).unwrap();
            let (model, _) = Model::from_deck(&deck).unwrap();
            let recording = completed(&model);
            let way = recording.rows.last().unwrap().probes[0];
            // δ = μ N/k = 0.4 x 39.24 N/20 N/mm; the residual of equilibrium affects it.
            assert!((way / 0.7848 - 1.0).abs() < 1e-2, "{tangent} {mesh}: {way}");
        }
    }
}

#[test]
fn a_moving_block_has_the_same_history_on_1_2_and_4_threads() {
    let (mut model, slider) = on_a_table(600.0);
    let down = [0.0, 0.0, -G];
    model.initial_velocity = vec![[0.0; 3]; model.mesh.nodes.len()];
    for n in slider.nodes() {
        model.initial_velocity[n as usize] = [1000.0, 100.0, 0.0];
    }
    let mut step = scene::set_free(Gravity::Constant(down), 0.1, 20, 5e-3, -0.1);
    if let Procedure::Dynamic { damping, .. } = &mut step.procedure {
        damping.mass = 1.0;
        damping.stiffness = 1e-5;
    }
    for tangent in [Tangent::Secant, Tangent::Consistent] {
        step.tangent = tangent;
        model.steps = vec![
            scene::left_alone(Gravity::Growing(down), 1.0, 2, 5e-3),
            step.clone(),
        ];
        let digits = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let recording = pool.install(|| completed(&model));
            assert!(recording.rows.iter().any(|r| r.sliding_points > 0));
            format!("{:?} {:?}", recording.rows, recording.states)
        };
        let one = digits(1);
        for threads in [2, 4] {
            assert!(digits(threads) == one, "{tangent:?}, {threads} threads");
        }
    }
}

/// A block of 40 mm moves at 1 m/s over two tables of 200 mm. The second table is higher by `step` [mm].
fn over_a_step(step: f64) -> Recording {
    let scene = format!(
        r#"
[[blocks]]
name = "low"
size = [200, 100, 50]
material = "stone"
[[blocks]]
name = "high"
size = [200, 100, 50]
at = [200, 0, {step}]
material = "stone"
[[blocks]]
name = "slider"
size = [100, 60, 40]
at = [80, 20, 50]
material = "stone"
velocity = ["1 m/s", 0, 0]
[[contacts]]
slave = "slider.bottom"
master = ["low.top", "high.top"]
interface = "dry"
[[supports]]
on = ["low", "high"]
[[probes]]
name = "rise"
on = "slider"
direction = "z"
"#
    );
    let slides = r#"
[[steps]]
kind = "free"
gravity = "9.81 m/s^2"
procedure = "quasi_static"
duration = "0.1 s"
increments = { initial = 0.01, max = 0.01, min = 1e-7 }
tolerance = { residual = 5e-3 }
"#;
    completed(&blocks::model(&scene, slides))
}

#[test]
fn energies_balance_when_points_change_to_a_facet_of_another_height() {
    // Steps up, level and down. At the end two of the four corners are on the second table.
    for step in [0.02, 0.0, -0.2, -2.0] {
        let recording = over_a_step(step);
        let last = recording.rows.last().unwrap();
        println!("{step}: {:?} {last:?}", imbalance(&recording));
        assert!((last.probes[0] - 0.5 * step).abs() < 0.01, "{step}");
        // Error from the residual tolerance; 2e-5 in the worst case.
        assert!(imbalance(&recording) < 1e-4, "{step}");
        // No energy may be created: the tolerance is rounding of 0.24 J.
        assert!(last.numerical_dissipation_J > -1e-6, "{step}");
    }
}

#[test]
fn the_side_of_a_higher_table_does_not_throw_a_sliding_block() {
    // Without `contact.general` the block enters below the face, which is behind its corners.
    for step in [0.2, 2.0] {
        let recording = over_a_step(step);
        let last = recording.rows.last().unwrap();
        assert!(last.probes[0] < 0.0, "{step}: {last:?}");
        assert!(last.numerical_dissipation_J > -1e-6, "{step}: {last:?}");
        // It has no more energy than it began with and its weight gave it: 0.24 J at first, then it falls.
        for row in &recording.rows {
            assert!(row.kinetic_energy_J <= row.external_work_J, "{row:?}");
        }
        // What it may gain unbooked: 2 mJ.
        assert!(imbalance(&recording) < 5e-3, "{step}: {last:?}");
    }
}

/// A pad on a very soft spring is pressed across a gap. The first solve does not detect contact and would carry the
/// pad through the block by some metres.
#[test]
fn a_pad_pressed_across_a_gap_comes_to_lie_on_the_block() {
    for gap in [1e-7, 1e-4, 0.01, 0.5] {
        let scene = format!(
            r#"
[[blocks]]
name = "block"
size = [50, 50, 50]
material = "stone"
[[blocks]]
name = "pad"
size = [50, 50, 20]
at = [0, 0, {}]
material = "stone"
[[contacts]]
slave = "block.top"
master = "pad.bottom"
interface = "dry"
[[supports]]
on = "block.bottom"
[[springs]]
name = "above"
on = "pad.top"
stiffness = [1, 1, 1]
[[probes]]
name = "gone"
on = "pad.bottom"
direction = "-z"
"#,
            50.0 + gap
        );
        let pressed = r#"
[[steps]]
kind = "preload"
face = "pad.top"
pressure = "1 MPa"
"#;
        let recording = completed(&blocks::model(&scene, pressed));
        let last = recording.rows.last().unwrap();
        let gone = last.probes[0];
        // 1 MPa over 50 mm of 5 GPa, fixed sideways at its foot, plus the penalty: slightly more than 0.01 mm.
        println!("gap {gap}: {gone} mm, {} mm²", last.contact_area_mm2);
        assert!((gone - gap - 0.01).abs() < 0.002, "{gap}: {gone}");
        assert_eq!(last.contact_area_mm2, 2500.0);
    }
}

/// Eleven courses of dry blocks collapse under a load that grows over 1000 s. The collapse takes a fraction of a
/// second and is followed with inertia, in increments far below a millionth of the step. Friction varies in its
/// eighth digit, because the hardest path is reached only for some values: with minimum increments of 1 ms each of
/// these three stopped.
#[test]
fn a_wall_falls_in_a_long_step() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/docs/validation/06-dry-blocks/wall.toml"
    );
    for eighth in [0.0, 2.0, 4.0] {
        let set = |key: &str, value: String| (key.to_owned(), value);
        let friction = 0.65 * (1.0 + 1e-8 * eighth);
        let overrides = [
            set("wall.courses", "11".to_owned()),
            set("steps.1.loads.0.force", "[15107.4, 0, 0]".to_owned()),
            set("interfaces.dry.mu", friction.to_string()),
            set("interfaces.dry.tan_phi", friction.to_string()),
        ];
        let deck = Deck::load(path, &overrides).unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        // A tenth of a millisecond, independently of the duration of the step.
        assert_eq!(model.steps[1].increments.min, 1e-4 / 1000.0);
        let recording = completed(&model);
        // The displacement at which the step stops.
        assert!(recording.rows.last().unwrap().displacement_mm >= 0.1);
    }
}
