//! Short forms of the scenes of walls in `examples/`: each runs, closes its energies, and does what it is there
//! to show.

#[path = "../common/mod.rs"]
mod common;

use common::examples::load;
use common::scene::run;
use wythe::model::Model;
use wythe::results::{HistoryRow, Status};

fn rows(name: &str, overrides: &[(&str, &str)]) -> Vec<HistoryRow> {
    let deck = load(name, overrides);
    let (model, _) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{name}: {e}"));
    let (recording, summary) = run(&model);
    assert_eq!(
        summary.status,
        Status::Completed,
        "{name}: {}",
        summary.message
    );
    let last = recording.rows.last().unwrap();
    let moved = last.kinetic_energy_J + last.damping_dissipation_J + last.numerical_dissipation_J;
    // Each term is integrated where it arises; 1 % is the most that theory F allows.
    let open = last.external_work_J - last.taken_J() - moved;
    assert!(
        open.abs() <= 1e-2 * last.external_work_J.abs(),
        "{name}: {open} J of {} J",
        last.external_work_J
    );
    recording.rows
}

#[test]
fn an_english_bond_is_pushed() {
    let rows = rows("60_english_bond_wall", &[("steps.1.displacement", "0.1")]);
    let last = rows.last().unwrap();
    // Stiffer than the wall of half the thickness and less slender: some tens of kN at 0.1 mm, and below
    // friction and bond of the whole bed.
    let bed = 890.0 * 215.0;
    assert!(last.force_kN > 10.0 && last.force_kN < 1e-3 * bed * (0.22 + 0.75 * 0.5));
}

/// The wall without a window carries more.
#[test]
fn a_window_weakens_a_wall() {
    let force = |overrides: &[(&str, &str)]| {
        let rows = rows("61_wall_with_opening", overrides);
        rows.last().unwrap().force_kN
    };
    let way = ("steps.1.displacement", "0.3");
    let (with, without) = (force(&[way]), force(&[way, ("wall.openings", "[]")]));
    assert!(with > 0.0 && with < 0.9 * without, "{with} of {without} kN");
}

/// Pressed a little, the wall is nearly an elastic plate: its middle gives way in proportion to the pressure.
#[test]
fn an_airbag_bends_a_wall() {
    let rows = rows(
        "62_out_of_plane_wall",
        &[("steps.1.control.displacement", "0.05")],
    );
    // So little pressure as at first is lost in the tolerance, beside the weight (docs/decisions.md).
    let seen = |r: &&HistoryRow| r.step == 1 && r.displacement_mm > 0.02;
    let pressed: Vec<&HistoryRow> = rows.iter().filter(seen).collect();
    let stiffness = |r: &HistoryRow| r.force_kN / r.displacement_mm;
    let (first, last) = (stiffness(pressed[0]), stiffness(pressed[pressed.len() - 1]));
    // Joints slide and open at the edges: a little softer at the end. Nothing makes a plate stiffer; 1 % for what the
    // tolerance of 5e-2 of a nodal force leaves.
    assert!(
        last > 0.85 * first && last <= 1.01 * first,
        "{first} then {last} kN/mm"
    );
}

/// SW100 of Lourenco et al. (2005): the mean peak of the two repeats is 44.85 kN (41.5 and 48.2 kN, digitised).
/// 10 % is what the issue of validation asks; the repeats differ by 15 %.
#[test]
fn a_dry_stone_wall_rocks_like_the_test() {
    let rows = rows("63_dry_stone_wall", &[("steps.2.displacement", "12")]);
    let peak = rows.iter().map(|r| r.force_kN).fold(0.0, f64::max);
    assert!((peak / 44.85 - 1.0).abs() < 0.1, "{peak} kN");
    // Never more than a rigid block of this load and weight on its toe.
    let weight = 0.9 * 0.2 * 2.3 * 9.81; // kN
    assert!(peak < (100.0 + weight) * 0.5, "{peak} kN");
}

#[test]
fn a_corner_is_tilted() {
    let rows = rows("64_corner", &[("steps.1.angle", "5")]);
    // Nothing breaks yet.
    assert!(rows.iter().all(|r| r.max_interface_damage == 0.0));
}

/// It stands at 10°, which statics find without any inertia.
#[test]
fn a_segmental_arch_stands_on_its_thrust() {
    let rows = rows("67_segmental_arch", &[("steps.1.procedure", "static")]);
    assert!(rows.last().unwrap().elastic_energy_J > 0.0);
}

/// The thrust passes beside the middle of the wall, so that its end moves to the side where mortar is missing.
#[test]
fn joints_filled_from_one_face_bend_a_wall() {
    let bends = |from: &str| {
        let rows = rows(
            "69_joints_filled_from_one_face",
            &[("wall.filled_from", from)],
        );
        rows.last().unwrap().probes[0]
    };
    let (front, back, both) = (bends("front"), bends("back"), bends("both"));
    assert!(front > 0.1, "{front} mm");
    // Mirror images, but for what the tolerance leaves.
    assert!((front + back).abs() < 1e-4 * front, "{front}, {back}");
    assert!(both.abs() < 1e-4 * front, "{both}");
}
