//! Ground that moves: records, reactions, and blocks that slide on it.

use super::dynamics::column;
use crate::common::blocks;
use crate::common::scene::{self, G, Recording, completed, gap};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::model::scene::{Fidelity, Gravity, GroundMotion};

#[test]
fn a_ground_that_accelerates_acts_as_gravity_does() {
    let (mut model, _) = column();
    let shaken = |gravity, ground| {
        let mut step = scene::set_free(gravity, 0.02, 100, 1e-8, -0.05);
        step.ground = ground;
        step
    };
    let down = [0.0, 0.0, -G];
    let up = GroundMotion {
        acceleration: [Vec::new(), Vec::new(), vec![[0.0, G], [0.02, G]]],
    };
    model.steps = vec![shaken(Gravity::Constant(down), GroundMotion::default())];
    let by_gravity = completed(&model);
    model.steps = vec![shaken(Gravity::None, up)];
    let by_ground = completed(&model);
    let last = |r: &Recording| r.states.last().unwrap().q.clone();
    assert_eq!(last(&by_gravity), last(&by_ground));
    let row = by_ground.rows.last().unwrap();
    assert!(row.kinetic_energy_J > 0.0);
    assert!(gap(row).abs() < 1e-5 * row.external_work_J, "{row:?}");
}

#[test]
fn a_record_is_linear_between_its_rows_and_zero_outside() {
    let motion = GroundMotion {
        acceleration: [
            vec![[0.0, 1.0], [0.5, 2.0], [1.0, 0.0]],
            Vec::new(),
            Vec::new(),
        ],
    };
    for (time, expected) in [
        (-0.1, 0.0),
        (0.0, 1.0),
        (0.25, 1.5),
        (0.5, 2.0),
        (0.75, 1.0),
        (1.0, 0.0),
        (1.1, 0.0),
    ] {
        assert_eq!(motion.at(time), [expected, 0.0, 0.0]);
    }
}

/// A block deck with a ground record.
fn shaken(scene: &str, record: &str, step: &str) -> Model {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("record.csv"), record).unwrap();
    let text = format!("{}{scene}{step}", blocks::HEAD);
    let file = folder.path().join("deck.toml");
    let deck = Deck::from_str(&text, &file.display().to_string()).unwrap();
    Model::from_deck(&deck).unwrap().0
}

/// A record that begins after its step ends leaves the ground at rest, and a warning says so.
#[test]
fn records_outside_their_step_are_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("record.csv"), "t,a\n0,1\n1,2\n2,0\n").unwrap();
    for (start, outside) in [("0 s", false), ("1.5 s", false), ("2.5 s", true)] {
        let step = format!(
            "{}[[steps]]\nkind = \"free\"\nprocedure = \"dynamic\"\nduration = 0.1\n\
             ground = {{ x = \"record.csv\" }}\nground_start = \"{start}\"\n",
            blocks::GRAVITY
        );
        let text = format!("{}{}{step}", blocks::HEAD, blocks::PAIR);
        let file = folder.path().join("deck.toml");
        let deck = Deck::from_str(&text, &file.display().to_string()).unwrap();
        let (_, told) = Model::from_deck(&deck).unwrap();
        let told: Vec<String> = told.iter().map(ToString::to_string).collect();
        let named = told
            .iter()
            .any(|w| w.contains("the ground is at rest throughout"));
        assert_eq!(named, outside, "{start}: {told:?}");
    }
}

/// Under gravity a block on a ground that accelerates by 1 g slides against it with (1 - μ) g; at 0.3 g it sticks.
/// The record is in g, twice as strong and 0.1 s late.
#[test]
fn a_block_slides_on_a_shaken_ground() {
    for (factor, slides) in [(2.0, true), (0.6, false)] {
        let step = format!(
            "{}[[steps]]\nkind = \"free\"\nprocedure = \"dynamic\"\nduration = 0.1\n\
             ground = {{ x = \"record.csv\" }}\nground_unit = \"g\"\nground_factor = {{ x = {factor} }}\n\
             ground_start = \"100 ms\"\n",
            blocks::GRAVITY
        );
        let record = "t,a\n0,9\n0.1,0.5\n0.15,0.5\n0.2,0.5\n0.3,0.5\n";
        let scene = blocks::PAIR.replace("velocity = [\"1 m/s\", 0, 0]\n", "");
        let mut model = shaken(&scene, record, &step);
        model.fidelity = Fidelity::Full; // the test reads its states
        assert_eq!(model.steps[1].ground.at(0.0)[0], 0.5 * factor * 9810.0);
        assert!(model.steps[1].increments.max <= 0.01);
        let recording = completed(&model);
        let last = recording.states.last().unwrap();
        let mut u = vec![[0.0; 3]; model.mesh.nodes.len()];
        wythe::assembly::DofMap::new(&model).spread(&last.q, &mut u);
        let way = u.iter().map(|u| u[0]).fold(0.0, f64::min);
        let exact = if slides {
            -0.5 * (1.0 - 0.4) * 9810.0 * 0.01
        } else {
            0.0
        };
        // Tolerance: half of the first increment, in which friction does not act yet, and the sway of the block.
        assert!((way - exact).abs() < 0.3, "{way} {exact}");
        let row = recording.rows.last().unwrap();
        let most = recording
            .rows
            .iter()
            .map(|r| r.external_work_J.abs())
            .fold(0.0, f64::max);
        assert!(!slides || gap(row).abs() < 2e-3 * most, "{row:?}");
    }
}

/// A wall that is slowly accelerated by 0.1 g along x under gravity exerts its mass times both on its supports.
#[test]
fn the_reaction_of_a_wall_on_accelerating_ground_is_its_mass_times_that() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("ramp.csv"), "0,0\n20,0.1\n").unwrap();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("examples/03_shear_wall_j7d.toml")).unwrap();
    let (head, _) = text.split_once("[[steps]]").unwrap();
    let steps = "[[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"free\"\nprocedure = \"dynamic\"\nduration = 20\n\
         rayleigh = { mass = \"50 s^-1\" }\nincrements = { initial = 0.05, max = 0.05 }\n\
         ground = { x = \"ramp.csv\" }\nground_unit = \"g\"\n";
    let overrides = [
        ("wall.courses", "4"),
        ("wall.length", "420.5 mm"),
        ("materials.brick.density", "1900 kg/m^3"),
        ("materials.mortar.density", "1900 kg/m^3"),
    ];
    let overrides = overrides.map(|(k, v)| (k.to_owned(), v.to_owned()));
    let file = folder.path().join("wall.toml").display().to_string();
    let deck = Deck::from_str_with(&format!("{head}{steps}"), &file, &overrides).unwrap();
    let model = Model::from_deck(&deck).unwrap().0;
    let recording = completed(&model);
    let last = recording.rows.last().unwrap();
    let sum = |i: usize| last.reactions.iter().map(|r| r[i]).sum::<f64>();
    let mass: f64 = (0..model.mesh.elements.len())
        .map(|e| 1.9e-9 * model.mesh.volume(e))
        .sum();
    // The beam is fixed along x and free along z: its weight is part of the wall's. Slow: a thousandth of sway.
    for (i, exact) in [(0, 0.1 * 9810.0 * mass), (2, 9810.0 * mass)] {
        assert!(
            (sum(i) / exact - 1.0).abs() < 5e-3,
            "{i}: {} {exact}",
            sum(i)
        );
    }
}

/// Coefficient of friction, amplitude [g], frequency [Hz], interval of the record [s] and its duration [s].
const FRICTION: f64 = 0.3;
const AMPLITUDE: f64 = 0.5;
const FREQUENCY: f64 = 3.0;
const ROW: f64 = 0.002;
const DURATION: f64 = 1.0;

const DECK: &str = r#"
format = 1
[materials.stone]
E = "20 GPa"
nu = 0.2
density = "2000 kg/m^3"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.3
mu = 0.3
[[blocks]]
name = "floor"
size = [1000, 400, 200]
material = "stone"
[[blocks]]
name = "a"
size = [300, 300, 100]
at = [300, 50, 200]
material = "stone"
mesh = [1, 1, 1]
[[contacts]]
slave = "a.bottom"
master = "floor.top"
interface = "dry"
[[supports]]
on = "floor"
[[probes]]
name = "slip"
on = "a"
direction = "x"
[[steps]]
kind = "gravity"
[[steps]]
kind = "free"
procedure = "dynamic"
duration = 1
ground = { x = "record.csv" }
ground_unit = "g"
"#;

/// Acceleration of the ground in a row of the record [g].
fn row(i: usize) -> f64 {
    AMPLITUDE * (std::f64::consts::TAU * FREQUENCY * i as f64 * ROW).sin()
}

/// Slip of a rigid block at the end, its least and its largest [mm], by steps of 2 µs of the equation of motion.
fn exact() -> [f64; 3] {
    let step = 2e-6;
    let (mut slip, mut velocity, mut least, mut most) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for k in 0..(DURATION / step) as usize {
        let at = (k as f64 + 0.5) * step / ROW;
        let part = at.fract();
        let ground = (1.0 - part) * row(at as usize) + part * row(at as usize + 1);
        let pull = -ground * G;
        if velocity == 0.0 && pull.abs() <= FRICTION * G {
            continue;
        }
        let sense = if velocity == 0.0 { pull } else { velocity }.signum();
        let next = velocity + step * (pull - sense * FRICTION * G);
        // It stops where its velocity would change its sign, and friction then acts the other way.
        velocity = if velocity * next < 0.0 { 0.0 } else { next };
        slip += velocity * step;
        (least, most) = (least.min(slip), most.max(slip));
    }
    [slip, least, most]
}

/// The block slides to and fro six times. Friction jumps at each turn, which increments of a row would take over.
#[test]
fn a_block_slides_to_and_fro_as_its_equation_of_motion_says() {
    let folder = tempfile::tempdir().unwrap();
    let rows =
        (0..=(DURATION / ROW).round() as usize).map(|i| format!("{},{}\n", i as f64 * ROW, row(i)));
    std::fs::write(folder.path().join("record.csv"), rows.collect::<String>()).unwrap();
    let file = folder.path().join("deck.toml").display().to_string();
    let deck = Deck::from_str(DECK, &file).unwrap();
    let recording = completed(&Model::from_deck(&deck).unwrap().0);
    let slips = || recording.rows.iter().map(|row| row.probes[0]);
    let found = [
        slips().next_back().unwrap(),
        slips().fold(f64::INFINITY, f64::min),
        slips().fold(f64::NEG_INFINITY, f64::max),
    ];
    let exact = exact();
    let range = exact[2] - exact[1];
    for (found, exact) in found.into_iter().zip(exact) {
        // At a turn the velocity errs by half the jump 2 μ g over a tenth of a row: 0.06 mm in half a period, 0.5 % of the
        // range. Without the cut the end was 8 % away.
        assert!(
            (found - exact).abs() < 0.01 * range,
            "{found} for {exact} in {range} mm"
        );
    }
}
