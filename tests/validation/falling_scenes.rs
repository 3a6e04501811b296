//! Examples of collapse: planned joints fail, and general contact takes over. The motion of the bodies is measured
//! independently of contact.

use crate::common::examples::completed;
use crate::common::inside::{penetration, positions};
use crate::common::scene::Recording;
use wythe::model::Model;

/// Lowest and highest coordinate of a body along z at the end [mm].
fn heights(model: &Model, recording: &Recording, body: u32) -> [f64; 2] {
    let x = positions(model, recording, recording.frames.len() - 1);
    let of = (0..model.mesh.elements.len()).filter(|&e| model.mesh.unit[e] == body);
    let z = of
        .flat_map(|e| model.mesh.elements[e])
        .map(|n| x[n as usize][2]);
    z.fold([f64::MAX, f64::MIN], |[low, high], z| {
        [low.min(z), high.max(z)]
    })
}

fn bodies(model: &Model) -> std::collections::BTreeSet<u32> {
    model.mesh.unit.iter().copied().collect()
}

/// Checks that no body penetrates another at any time. Remaining penetrations come from the penalty in an impact and
/// from faces that it warps.
fn nothing_is_deep(model: &Model, recording: &Recording) {
    let deep = penetration(model, recording);
    println!("deepest {deep:.2e} mm");
    assert!(deep < 0.2, "{deep} mm");
}

#[test]
fn an_arch_falls_and_lies_on_the_ground() {
    // A fall is chaotic: a stone may stand on its edge for a second before it falls. Increments of 3 ms, as in the
    // example.
    let (model, recording) = completed(
        "89_falling_arch",
        &[
            ("output.every", "1"),
            ("steps.0.duration", "\"3 s\""),
            ("steps.0.increments.max", "0.001"),
        ],
    );
    nothing_is_deep(&model, &recording);
    let last = recording.rows.last().unwrap();
    // At rest: a kinetic energy of a millionth of the work of gravity would still be a motion.
    assert!(last.kinetic_energy_J < 1e-6 * last.external_work_J);
    // The crown lies on the ground, 150 mm below the springings; its centre is half its thickness above. Curved faces
    // are chords, whose middle is at most R - R cos(π/22) cos(π/22) = 2 % of R above that of the arc.
    let fallen = -last.probes[0];
    let flat = 1000.0 + 150.0 - 95.0 / 2.0;
    assert!(fallen < flat && fallen > flat - 20.0, "{fallen} mm");
    for body in bodies(&model) {
        let [low, high] = heights(&model, &recording, body);
        let ground = high < -149.0;
        // No stone is below the ground, and none is higher than two that stand on each other.
        assert!(ground || low > -150.2, "{body}: {low}");
        assert!(high < 2.0 * 290.0, "{body}: {high}");
    }
}

#[test]
fn a_wall_that_is_blown_over_falls_apart_on_the_ground() {
    let (model, recording) = completed("90_falling_wall", &[("output.every", "1")]);
    nothing_is_deep(&model, &recording);
    let rows = &recording.rows;
    let last = rows.last().unwrap();
    // One block may still rock slightly.
    assert!(last.kinetic_energy_J < 1e-2 * last.external_work_J);
    // Half of the points open during the impact on the ground; before, only those at the foot.
    let points = last.open_points + last.sliding_points;
    assert!(points > 40, "{points}");
    let flying = rows.iter().rfind(|r| r.time < 1.2).unwrap();
    assert!(flying.open_points <= 6, "{flying:?}");
    for body in bodies(&model) {
        let [low, high] = heights(&model, &recording, body);
        let ground = high < 1e-3;
        // They lie on a face 100 mm high, or on another block.
        assert!(
            ground || (low > -0.2 && high < 210.0),
            "{body}: {low}, {high}"
        );
    }
    // They lie within the height of the wall in front of it.
    let top = last.probes[0];
    assert!(top > 200.0, "{top} mm");
}

#[test]
fn a_wall_that_rotates_about_gauss_points_does_not_sink() {
    // The wall rotates about its foot, about points a fifth of a facet inside its edge.
    let (model, recording) = completed(
        "90_falling_wall",
        &[("contact.points", "\"gauss\""), ("output.every", "1")],
    );
    nothing_is_deep(&model, &recording);
    assert!(recording.rows.last().unwrap().probes[0] > 100.0);
}
