//! Answers of a run: modes of failure of scenes whose mode is known, and first damage through halves and checkpoints.

use crate::common::blocks::{deck, model};
use crate::common::scene::run;
use wythe::model::Model;
use wythe::model::scene::Fidelity;
use wythe::results::answers::{Answers, FailureMode};
use wythe::results::{RunDirectory, RunFolder};
use wythe::solve::{self, Checkpoint, Recorder};
use wythe::state::{FirstDamage, Frame, HistoryRow, Status, Summary};

/// A wall of strong units in half bond, with a weak bond, below a level beam that moves freely upwards.
const WALL: &str = r#"
format = 1

[materials.unit]
E = "10 GPa"
nu = 0.2
density = "1800 kg/m^3"

[interfaces.joint]
f_t = "0.1 MPa"
c = "0.15 MPa"
tan_phi = 0.6
mu = 0.6
zeta = 4.38
xi = 1.1
G_I = "0.01 N/mm"
G_II = "0.02 N/mm"

[wall]
unit = ["250 mm", "120 mm", "100 mm"]
bed_joint = 0
head_joint = 0
length = "1000 mm"
courses = 10
unit_material = "unit"
interface = "joint"
mesh = [2, 1, 1]

[[steps]]
kind = "preload"
top_pressure = "0.6 MPa"

[[steps]]
kind = "drive"
direction = "x"
displacement = "1.5 mm"
vertical = "free"
"#;

/// A block pushed over another one, with a friction of 0.4.
const SLIDING: &str = r#"
[[blocks]]
name = "base"
size = [400, 100, 50]
material = "stone"
mesh = [4, 1, 1]

[[blocks]]
name = "top"
size = [200, 100, 50]
at = [0, 0, 50]
material = "stone"
mesh = [2, 1, 1]

[[contacts]]
slave = "top.bottom"
master = "base.top"
interface = "dry"

[[supports]]
on = "base.bottom"

[[steps]]
kind = "preload"
face = "top.top"
pressure = "0.5 MPa"

[[steps]]
kind = "drive"
face = "top.top"
direction = "x"
displacement = -2
free = ["z"]
"#;

fn wall() -> Model {
    Model::from_deck(&deck(WALL)).unwrap().0
}

/// Answers of a run, as they are in the summary of its folder.
fn answers(model: &Model) -> Answers {
    let folder = tempfile::tempdir().unwrap();
    let mut run = RunDirectory::create(folder.path(), model).unwrap();
    let summary = solve::run(model, &mut run).unwrap();
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    run.finish(model, &summary, &[]).unwrap();
    let read = RunFolder::open(folder.path()).unwrap().summary().unwrap();
    read.unwrap().answers.unwrap()
}

#[test]
fn a_pier_rocks_about_its_toe() {
    let text = std::fs::read_to_string("examples/66_rocking_pier.toml").unwrap();
    let (model, _) = Model::from_deck(&deck(&text)).unwrap();
    let found = answers(&model);
    assert_eq!(found.failure_mode, Some(FailureMode::Rocking));
    let measure = found.failure_measure.unwrap();
    // Rigid stones on joints of finite stiffness: the resultant is almost at the toe.
    let eccentricity = measure.eccentricity.unwrap();
    assert!((0.9..=1.0).contains(&eccentricity), "{measure:?}");
    // The stones are 1 m high, and the beam is pushed at half its depth of 100 mm.
    assert_eq!(found.height_mm, Some(1050.0));
    // A rigid block under N = 40 kN and its weight of 1.805 kN carries at most N b/(2 H) at the toe: 40 kN act at
    // half its length, 200 mm, below the height of 1.05 m.
    let limit = (40.0 + 0.2 * 0.4 * 2300.0 * 9.81e-3) * 200.0 / 1050.0;
    let bilinear = found.bilinear.unwrap();
    assert!((0.95..=1.0).contains(&(bilinear.ultimate_force_kN / limit)));
    assert!(!bilinear.reached_80_percent && bilinear.ductility > 10.0);
    // The supports carry what the jack brings. The tolerance is that of equilibrium.
    let shear = found.base_shear_at_peak_kN.unwrap();
    assert!((0.9..=1.0).contains(&(shear / limit)), "{shear} {limit}");
    assert_eq!(found.cracks_at_end.unwrap().burland_class, 2);
    assert_eq!(found.first_damage.joint, None, "dry joints have no bond");
    // In flexure the limit of EN 1998-3 has H0/D = 1050/400. The load has moved by 0.16 mm with the top, which adds
    // 42 kN × 0.16 mm / 8 kN = 0.8 mm to H0.
    let point = &found.performance_points[0];
    let over = point.drift / (0.008 * 1050.0 / 400.0);
    assert!((over - 1.0).abs() < 0.002, "{over}");
    assert_eq!(point.force_kN, None, "5 mm are less than the limit");
}

#[test]
fn a_block_slides() {
    let found = answers(&model(SLIDING, ""));
    assert_eq!(found.failure_mode, Some(FailureMode::BedSliding));
    let measure = found.failure_measure.unwrap();
    assert_eq!(measure.height_of_slip_mm, Some(50.0));
    // The block and the top of the base deform by far less than 1 % of 2 mm.
    assert!(
        (0.99..=1.01).contains(&measure.slip_over_drift),
        "{measure:?}"
    );
    // 0.4 × 0.5 MPa × 200 × 100 mm²; the force counts along the drive, which goes towards −x.
    let shear = found.base_shear_at_peak_kN.unwrap();
    assert!((shear / 4.0 - 1.0).abs() < 1e-3, "{shear}"); // tolerance of equilibrium
    let below = found.reactions_at_peak_kN.values().map(|f| f[0]);
    assert!((below.sum::<f64>() - shear).abs() < 1e-9 * shear);
    let secant = found.secant_stiffness_kN_per_mm.unwrap();
    assert!(secant > 0.0 && found.bilinear.unwrap().ductility > 1.0);
}

/// Steps that push the top of the wall `pushed`.
const PUSH: &str = r#"
[[steps]]
kind = "gravity"

[[steps]]
kind = "preload"
face = "pushed.top"
pressure = "0.5 MPa"

[[steps]]
kind = "drive"
face = "pushed.top"
direction = "x"
displacement = -2
free = ["z"]
"#;

/// A dry wall of three courses on a support of its own.
fn dry_wall(name: &str, at: &str, along: &str) -> String {
    format!(
        r#"
[[walls]]
name = "{name}"
at = {at}
along = "{along}"
unit = ["200 mm", "100 mm", "100 mm"]
bed_joint = 0
head_joint = 0
length = "600 mm"
courses = 3
unit_material = "stone"
interface = "dry"
mesh = [2, 1, 1]

[[supports]]
on = "{name}.bottom"
"#
    )
}

#[test]
fn each_wall_along_the_drive_has_its_own_mode() {
    let pushed = dry_wall("pushed", "[0, 0, 0]", "x");
    let alone = answers(&model(&pushed, PUSH));
    assert_eq!(alone.failure_mode, Some(FailureMode::BedSliding));
    assert!(alone.walls.is_empty(), "one wall is the whole");
    // A wall beside it on which nothing acts, and one across it.
    let walls = [
        pushed,
        dry_wall("idle", r#"[0, "1 m", 0]"#, "x"),
        dry_wall("across", r#"["2 m", 0, 0]"#, "y"),
    ];
    let found = answers(&model(&walls.concat(), PUSH));
    let [pushed, idle] = &found.walls[..] else {
        panic!("{:?}", found.walls);
    };
    assert_eq!((&*pushed.name, &*idle.name), ("pushed", "idle"));
    assert_eq!(pushed.failure_mode, Some(FailureMode::BedSliding));
    assert!((pushed.displacement_mm + 2.0).abs() < 1e-9);
    // All three walls have a joint at this height with as many points, and those of the others do not slide: the mean of
    // the whole is a third.
    let (own, whole) = (&pushed.failure_measure, &found.failure_measure.unwrap());
    assert_eq!(own.height_of_slip_mm, whole.height_of_slip_mm);
    let ratio = own.slip_over_drift / whole.slip_over_drift;
    assert!((ratio - 3.0).abs() < 1e-3, "{own:?} {whole:?}");
    assert_eq!(
        own.inner_courses, 1,
        "that of three which is in the middle half"
    );
    assert_eq!(idle.failure_mode, None);
    assert!(idle.displacement_mm.abs() < 1e-3);
    assert_eq!(idle.failure_measure.compressive_damage, 0.0);
}

#[test]
fn a_wall_cracks_along_a_stepped_diagonal() {
    let found = answers(&wall());
    assert_eq!(found.failure_mode, Some(FailureMode::SteppedDiagonal));
    let measure = found.failure_measure.unwrap();
    // Ten courses, two of them clamped: the four in the middle of the eight.
    assert_eq!(measure.inner_courses, 4);
    assert_eq!(measure.courses_with_cracked_units, 0, "units are elastic");
    assert!(measure.force_lost);
    let joint = found.first_damage.joint.unwrap();
    assert_eq!(joint.place.interface.as_deref(), Some("joint"));
    assert_eq!(joint.place.bodies.len(), 2);
    assert_eq!(found.first_damage.crack, None);
    // Shear: 0.4 % of 800 mm, which is beyond the 1.5 mm of the run.
    let drifts: Vec<f64> = found.performance_points.iter().map(|p| p.drift).collect();
    assert_eq!(drifts, [0.004, 0.004 * 4.0 / 3.0]);
    assert_eq!(found.performance_points[0].displacement_mm, 3.2);
    let end = found.cracks_at_end.unwrap();
    assert!(end.joint.unwrap().width_mm > 0.1 && end.burland_class >= 1);
    assert_eq!(end.solid, None);
}

#[test]
fn beds_under_openings_are_no_damage() {
    // Units below the window reach beyond its jambs, where their beds face nothing.
    let text = std::fs::read_to_string("examples/61_wall_with_opening.toml").unwrap();
    let (mut model, _) = Model::from_deck(&deck(&text)).unwrap();
    model.steps.truncate(1);
    let (recording, _) = run(&model);
    let first = &recording.rows[0];
    assert!(first.open_points > 0, "{first:?}");
    assert_eq!(first.max_interface_damage, 0.0);
}

/// Stops after some rows and keeps the checkpoint.
#[derive(Default)]
struct Stopping {
    rows: usize,
    stop_after: Option<usize>,
    checkpoint: Option<Checkpoint>,
}

impl Recorder for Stopping {
    fn take(&mut self, _: &Model, _: &HistoryRow, _: Option<&Frame>) -> std::io::Result<bool> {
        self.rows += 1;
        Ok(self.stop_after != Some(self.rows))
    }

    fn checkpoint(&mut self, _: bool, make: &dyn Fn() -> Checkpoint) -> std::io::Result<()> {
        self.checkpoint = Some(make());
        Ok(())
    }
}

#[test]
fn first_damage_survives_a_checkpoint_and_is_the_same_of_a_half() {
    let mut model = wall();
    model.steps[1].increments.max = 0.05;
    let first = |summary: &Summary| summary.first_damage.joint.unwrap();
    let half = solve::run(&model, &mut Stopping::default()).unwrap();
    assert!(
        !half.mirror_planes.is_empty(),
        "the wall has a plane of symmetry"
    );
    // Stopped just after it, and before it.
    for rows in [first(&half).increment, first(&half).increment + 3] {
        let mut stopping = Stopping {
            stop_after: Some(rows),
            ..Stopping::default()
        };
        let stopped = solve::run(&model, &mut stopping).unwrap();
        assert_eq!(stopped.status, Status::Interrupted);
        let checkpoint = stopping.checkpoint.unwrap();
        let resumed = solve::resume(&model, checkpoint, &mut Stopping::default()).unwrap();
        assert_eq!(resumed.first_damage, half.first_damage);
    }
    model.fidelity = Fidelity::Full;
    let whole = solve::run(&model, &mut Stopping::default()).unwrap();
    let (a, b) = (first(&half), first(&whole));
    assert_eq!((a.increment, a.step), (b.increment, b.step));
    // Two solutions within the tolerance of equilibrium.
    assert!((a.displacement_mm - b.displacement_mm).abs() < 1e-9);
    assert!((a.force_kN - b.force_kN).abs() < 0.01 * b.force_kN.abs().max(1.0));
    let place = |summary: &Summary| {
        let noted: &FirstDamage = &summary.first_damage;
        let told = wythe::results::answers::first_damage(&model, noted);
        told.joint.unwrap().place
    };
    let (a, b) = (place(&half), place(&whole));
    assert_eq!(a.interface, b.interface);
    // The same joint, or its image.
    assert_eq!(a.at_mm[2], b.at_mm[2]);
}
