//! Peaks and verdicts of runs with several loads, of suctions, and of walls whose force inertia carries first: blocks and
//! piers whose force is known by hand.

use wythe::deck::Deck;
use wythe::model::Model;
use wythe::model::live::PartInCurve;
use wythe::results::{Curve, RunDirectory, RunFolder};
use wythe::solve;
use wythe::state::{HistoryRow, Status, Summary};

/// Stone, a dry joint and contact at the corners: the head of a deck. MU: the friction.
const STONE: &str = r#"
format = 1
[materials.stone]
E = "5 GPa"
nu = 0.2
density = "2000 kg/m^3"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = MU
mu = MU
normal_stiffness = "100 N/mm^3"
shear_stiffness = "40 N/mm^3"
[contact]
points = "corner"
"#;

/// A block of 400 × 300 × 500 mm, of 1177.2 N, on the ground, with friction 0.9.
const BLOCK: &str = r#"
[[blocks]]
name = "ground"
size = [1000, 1000, 100]
at = [-300, -300, -100]
material = "stone"
[[blocks]]
name = "block"
size = [400, 300, 500]
at = [0, 0, 0]
material = "stone"
[[contacts]]
slave = "block.bottom"
master = "ground.top"
interface = "dry"
[[supports]]
on = "ground"
[[probes]]
name = "top"
on = "block.top"
direction = "x"
[[steps]]
kind = "gravity"
"#;

/// Weight of the block, and the sideways force at its middle that turns it about its edge: W b/h [kN].
const WEIGHT: f64 = 1.1772;
const TURNS: f64 = WEIGHT * 400.0 / 500.0;

fn deck(friction: f64, scene: &str) -> Deck {
    let text = format!("{}{scene}", STONE.replace("MU", &friction.to_string()));
    Deck::from_str(&text, "scene.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn model(deck: &Deck) -> Model {
    Model::from_deck(deck).unwrap_or_else(|e| panic!("{e}")).0
}

/// The curve of a deck, its history and its summary. The curve of the run is that which its folder gives back.
fn curve(deck: &Deck) -> (Curve, Vec<HistoryRow>, Summary) {
    let (model, folder) = (model(deck), tempfile::tempdir().unwrap());
    let mut run = RunDirectory::of_deck(folder.path(), &model, deck).unwrap();
    let summary = solve::run(&model, &mut run).unwrap();
    let curve = run.curve().clone();
    run.finish(&model, &summary, &[]).unwrap();
    let history = RunFolder::open(folder.path()).unwrap().history().unwrap();
    assert_eq!(history.curve(), curve);
    (curve, history.rows, summary)
}

/// A step whose only load is 0 has a force and a displacement of 0, not none.
#[test]
fn a_load_of_zero_has_a_displacement() {
    let step = "[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"H\"\non = \"block.left\"\nforce = [0, 0, 0]\n";
    let (_, rows, _) = curve(&deck(0.9, &format!("{BLOCK}{step}")));
    let loaded = rows.iter().filter(|row| row.step == 1);
    for row in loaded {
        assert_eq!((row.displacement_mm, row.force_kN), (0.0, 0.0));
    }
}

/// A pressure on one side and a suction on the other turn the block by the same force, which is positive.
#[test]
fn a_suction_has_the_peak_of_a_pressure() {
    let step = |on: &str, pressure: &str, way: i32| {
        format!(
            "{BLOCK}[[steps]]\nkind = \"load\"\nprocedure = \"displacement_control\"\ncontrol = {{ probe = \"top\", \
             displacement = {way} }}\n[[steps.loads]]\nname = \"p\"\non = \"block.{on}\"\npressure = \"{pressure}\"\n"
        )
    };
    for (on, pressure, way) in [
        ("left", "10 kPa", 20),
        ("left", "-10 kPa", -20),
        ("right", "-10 kPa", 20),
    ] {
        let (curve, rows, summary) = curve(&deck(0.9, &step(on, pressure, way)));
        assert_eq!(summary.status, Status::Completed, "{}", summary.message);
        let peak = curve.peak().unwrap();
        // The edge gives by the stiffness of the joint, and the block has turned a little at its peak.
        assert!(
            (peak.force / TURNS - 1.0).abs() < 5e-3,
            "{on} {pressure}: {}",
            peak.force
        );
        assert!(curve.passes_peak());
        assert!(rows.iter().all(|row| row.displacement_mm > -1e-3));
    }
}

/// The curve of a spring drive does not begin at the preload of a face, whose increments show the force of that face.
#[test]
fn a_spring_drive_does_not_begin_at_a_preload() {
    let deck = deck(
        0.9,
        &format!(
            "{BLOCK}[[springs]]\nname = \"rod\"\non = \"block.right\"\nstiffness = [100, 0, 0]\n[[steps]]\nkind = \
             \"preload\"\nface = \"block.top\"\npressure = \"0.5 MPa\"\nfree = [\"x\", \"y\"]\n[[steps]]\nkind = \
             \"drive\"\nspring = \"rod\"\ndirection = \"x\"\ndisplacement = 5\n"
        ),
    );
    let (curve, ..) = curve(&deck);
    // The rod has 100 N/mm, the block on its joint some thousand times as much.
    let stiffness = curve.initial_stiffness().unwrap();
    assert!((stiffness / 0.1 - 1.0).abs() < 0.01, "{stiffness}");
}

/// The curve is that of the load that turns the block, whatever lies on it.
#[test]
fn a_load_that_lies_on_a_block_is_not_its_peak() {
    let deck = deck(
        0.9,
        &format!(
            "{BLOCK}[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"dead\"\non = \"block.top\"\nforce = [0, 0, \
         -5000]\n[[steps]]\nkind = \"load\"\nprocedure = \"displacement_control\"\ncontrol = {{ probe = \"top\", \
         displacement = 1 }}\n[[steps.loads]]\nname = \"live\"\non = \"block.left\"\nforce = [1000, 0, 0]\n"
        ),
    );
    let model = model(&deck);
    assert_eq!(model.live_load(), Some(1));
    let parts = [PartInCurve::Start, PartInCurve::Start, PartInCurve::Points];
    assert_eq!(model.parts_in_curve(), parts);
    let (curve, rows, _) = curve(&deck);
    assert!(
        rows.iter()
            .filter(|row| row.step < 2)
            .all(|row| row.force_kN == 0.0)
    );
    // The weight and the load turn back about the edge: (W + V) b/h.
    let turns = (WEIGHT + 5.0) * 400.0 / 500.0;
    let peak = curve.peak().unwrap();
    assert!((peak.force / turns - 1.0).abs() < 5e-3, "{}", peak.force);
}

/// Drives along different lines are no cycle: the last one counts.
#[test]
fn the_last_of_two_drives_counts() {
    let deck = deck(
        0.9,
        &format!(
            "{BLOCK}[[steps]]\nkind = \"drive\"\nface = \"block.top\"\ndirection = \"-z\"\ndisplacement = 0.05\nfree = \
         [\"x\", \"y\"]\n[[steps]]\nkind = \"drive\"\nface = \"block.top\"\ndirection = \"x\"\ndisplacement = 0.5\n"
        ),
    );
    let parts = [PartInCurve::Other, PartInCurve::Other, PartInCurve::Points];
    assert_eq!(model(&deck).parts_in_curve(), parts);
    let (curve, ..) = curve(&deck);
    // The block presses symmetrically, so that the second drive begins without force; the line through its first two
    // increments is curved by the tolerance of equilibrium.
    let (way, force) = curve.start();
    assert!(
        way.abs() < 1e-3 && force.abs() < 0.02,
        "{way} mm, {force} kN"
    );
    assert!(!curve.turns_back());
}

/// A wall of rigid stones whose first increment is too long for statics: steady sliding is an equilibrium.
#[test]
fn what_slides_steadily_under_inertia_is_in_equilibrium() {
    let slides = |way: f64| {
        let (curve, _, summary) = curve(&deck(
            0.9,
            &format!(
                "{BLOCK}[[steps]]\nkind = \"drive\"\nface = \"block.right\"\ndirection = \"-x\"\nfree = [\"y\", \
             \"z\"]\ndisplacement = {way}\n"
            ),
        ));
        assert_eq!(summary.status, Status::Completed, "{}", summary.message);
        curve.peak().unwrap().force
    };
    for way in [2.0, 200.0] {
        // Friction 0.9 of the weight; 1 % for the tolerance of Newton's method and of quiet increments.
        assert!(
            (slides(way) / (0.9 * WEIGHT) - 1.0).abs() < 0.01,
            "{way} mm: {}",
            slides(way)
        );
    }
}

/// A pier of rigid stones between the ground and a beam, pressed by 0.2 MPa, rocks from 0.02 mm on, however far it is
/// driven: V H = (P + W) b/2, with the force V at half the depth of the beam.
#[test]
fn a_pier_has_its_peak_however_far_it_is_driven() {
    let (pressed, weight) = (0.2 * 300.0 * 200.0, 0.3 * 0.2 * 1.2 * 2000.0 * 9.81);
    let exact = 1e-3 * (pressed + weight) * 150.0 / (1200.0 + 50.0);
    for way in [
        "displacement = 10",
        "displacement = 40",
        "displacement = 200",
        "displacement = 400",
        "cycles = { amplitudes = [\"5 mm\", \"20 mm\"] }",
    ] {
        let (curve, ..) = curve(&deck(0.7, &PIER.replace("WAY", way)));
        let peak = curve.peak().unwrap().force.abs();
        // `increments.peak` of 0.5 %, and joints that yield elastically at the toe.
        assert!(
            (peak / exact - 1.0).abs() < 0.01,
            "{way}: {peak} of {exact} kN"
        );
    }
}

/// The pier.
const PIER: &str = r#"
[wall]
unit = [300, 200, 200]
bed_joint = 0
head_joint = 0
length = 300
courses = 6
unit_material = "stone"
interface = "dry"
rigid = true
clamped = false
[[blocks]]
name = "ground"
size = [600, 600, 100]
at = [-150, -200, -100]
material = "stone"
rigid = true
[[contacts]]
slave = "wall.bottom"
master = "ground.top"
interface = "dry"
[[supports]]
on = "ground"
[[beams]]
name = "beam"
on = "wall.top"
depth = 100
rotation = "free"
interface = "dry"
[[steps]]
kind = "gravity"
[[steps]]
kind = "preload"
beam = "beam"
pressure = 0.2
[[steps]]
kind = "drive"
beam = "beam"
direction = "x"
WAY
"#;

/// A dry wall on the ground, and a pressure on its back.
const WALL: &str = r#"
[wall]
unit = [300, 200, 150]
bed_joint = 0
head_joint = 0
length = 1200
courses = 6
unit_material = "stone"
interface = "dry"
clamped = false
mesh = [2, 1, 1]
[[blocks]]
name = "ground"
size = [1600, 1000, 150]
at = [-200, -400, -150]
material = "stone"
[[contacts]]
slave = "wall.bottom"
master = "ground.top"
interface = "dry"
[[supports]]
on = "ground"
[[steps]]
kind = "gravity"
[[steps]]
kind = "load"
[[steps.loads]]
name = "wind"
on = "wall.back"
pressure = "5 kPa"
"#;

/// A dry wall that a pressure on its back turns about its front edge: the load at which it falls is the last that it
/// carried at rest.
#[test]
fn a_wall_falls_at_the_load_that_it_carried_last() {
    let deck = deck(0.6, WALL);
    let (_, _, summary) = curve(&deck);
    assert_eq!(summary.status, Status::Collapsed, "{}", summary.message);
    // p H L H/2 = W t/2 with W = ρ g t H L: p = ρ g t²/H.
    let exact = 2e-9 * 9810.0 * 200.0 * 200.0 / 900.0 / 5e-3;
    let factor = summary.fall.unwrap().load_factor;
    // `increments.peak` finds the load to 0.5 %, and the fall begins so slowly that an increment or two more count as at
    // rest.
    assert!((factor / exact - 1.0).abs() < 0.01, "{factor} of {exact}");
}

/// A block that a force at its top turns about an edge, or a force along its foot pushes.
#[test]
fn a_block_falls_or_slides_at_the_load_of_its_closed_form() {
    let pushed = |force: &str| {
        format!("{BLOCK}[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"F\"\n{force}\n")
    };
    let weight = 1e3 * WEIGHT;
    for (friction, force, exact) in [
        (
            0.9,
            "on = \"block.top\"\nforce = [800, 0, 0]",
            weight * 200.0 / 500.0 / 800.0,
        ),
        (
            0.9,
            "on = \"block.top\"\nforce = [0, -800, 0]",
            weight * 150.0 / 500.0 / 800.0,
        ),
        (
            0.3,
            "on = \"block\"\nforce = [5000, 0, 0]",
            0.3 * weight / 5000.0,
        ),
    ] {
        let (_, _, summary) = curve(&deck(friction, &pushed(force)));
        let factor = summary.fall.expect("a fall").load_factor;
        // Half a per cent by `increments.peak`, and as much by statics, which finds no equilibrium close to the limit.
        assert!(
            (factor / exact - 1.0).abs() < 0.01,
            "{force}: {factor} of {exact}"
        );
    }
}
