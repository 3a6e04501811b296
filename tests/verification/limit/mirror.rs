//! Scenes that are their own mirror images: programs with half of the forces against those with all.

use super::{along, associated, near, read};
use wythe::limit::{LimitAnalysis, LimitSettings, analyse};
use wythe::model::Model;

/// Accuracy of both factors: the tolerance of the programs, much above rounding.
const EXACT: f64 = 1e-6;

/// Solutions of both programs.
fn pair(model: &Model, settings: LimitSettings) -> [LimitAnalysis; 2] {
    [false, true].map(|whole| {
        let settings = LimitSettings { whole, ..settings };
        let found = analyse(model, &settings).unwrap();
        assert!(found.gap < EXACT, "{}", found.gap);
        found
    })
}

/// Associated factors of both programs are equal, forces and mechanism of the half lie in the plane, and the factor
/// without dilatancy is at most this one.
fn agree(model: &Model, settings: LimitSettings, axis: &str) {
    let [half, whole] = pair(model, associated(settings));
    assert_eq!((half.mirror, whole.mirror), (Some(axis), None));
    near(half.factor, whole.factor, EXACT);
    assert_eq!(half.joints.len(), whole.joints.len());
    let across = ["x", "y", "z"]
        .iter()
        .position(|name| *name == axis)
        .unwrap();
    for joint in &half.joints {
        // Resultants of symmetric states: in the plane, and in the middle of the joint, to rounding.
        let middle = joint.corners_mm.iter().map(|x| x[across]).sum::<f64>();
        let middle = middle / joint.corners_mm.len() as f64;
        let size = joint.force.iter().map(|f| f * f).sum::<f64>().sqrt();
        assert!(joint.force[across].abs() <= 1e-12 * size, "{joint:?}");
        assert!((joint.at_mm[across] - middle).abs() < 1e-6, "{joint:?}");
    }
    for unit in &half.mechanism {
        assert_eq!(unit.velocity[across], 0.0);
        let turns = (0..3).all(|i| i == across || unit.spin[i] == 0.0);
        assert!(turns, "{unit:?}");
    }
    let level = analyse(model, &settings).unwrap();
    assert_eq!(level.mirror, Some(axis));
    near(level.associated_factor, half.factor, EXACT);
    assert!(
        level.factor <= (1.0 + EXACT) * half.factor,
        "{}",
        level.factor
    );
}

#[test]
fn walls_arches_and_piers_have_the_same_factors() {
    let wall = read("docs/validation/06-dry-blocks/wall-06-half.toml");
    agree(&wall, along(0), "y");
    let arch = read("docs/validation/05-arches/sideways-27-15.toml");
    agree(&arch, LimitSettings::default(), "y");
    agree(&arch, along(0), "y");
    let pier = read("examples/66_rocking_pier.toml");
    agree(&pier, LimitSettings::default(), "y");
    let crushed = LimitSettings {
        strength: Some(2.0),
        ..LimitSettings::default()
    };
    agree(&pier, crushed, "y");
    let driven = read("examples/63_dry_stone_wall.toml");
    agree(&driven, LimitSettings::default(), "y");
    agree(&driven, crushed, "y");
    let window = read("examples/61_wall_with_opening.toml");
    let bonded = LimitSettings {
        bonded: true,
        strength: Some(5.0),
        ..LimitSettings::default()
    };
    agree(&window, bonded, "y");
    let tied = read("examples/93_arch_with_a_tie.toml");
    agree(&tied, along(0), "y");
}

/// Programs of scenes in which bodies have images have the same factors; mechanisms and forces are mirror images of
/// themselves.
fn images_agree(model: &Model, settings: LimitSettings, axis: usize) {
    let [half, whole] = pair(model, associated(settings));
    let name = ["x", "y", "z"][axis];
    assert_eq!((half.mirror, whole.mirror), (Some(name), None));
    near(half.factor, whole.factor, EXACT);
    let places = half.joints.iter().flat_map(|joint| &joint.corners_mm);
    let places: Vec<f64> = places.map(|x| x[axis]).collect();
    let low = places.iter().copied().fold(f64::INFINITY, f64::min);
    let high = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let image = |x: [f64; 3]| -> [f64; 3] {
        let mut image = x;
        image[axis] = low + high - x[axis];
        image
    };
    let flipped = |v: [f64; 3]| -> [f64; 3] {
        let mut flipped = v;
        flipped[axis] = -v[axis];
        flipped
    };
    let close = |a: [f64; 3], b: [f64; 3], size: f64| (0..3).all(|i| (a[i] - b[i]).abs() <= size);
    let most = half.joints.iter().flat_map(|joint| joint.force);
    let most = most.fold(0.0, |most: f64, f| most.max(f.abs()));
    for joint in half
        .joints
        .iter()
        .filter(|joint| joint.normal > 1e-6 * most)
    {
        // Rounding of sums; the force acts on the image of the first body, which may be the second one.
        let (at, force) = (image(joint.at_mm), flipped(joint.force));
        let found = half.joints.iter().any(|other| {
            close(other.at_mm, at, 1e-3)
                && (close(other.force, force, 1e-9 * most)
                    || close(other.force.map(|f| -f), force, 1e-9 * most))
        });
        assert!(found, "{joint:?}");
    }
    for unit in &half.mechanism {
        let (centre, velocity) = (image(unit.centre_mm), flipped(unit.velocity));
        let found = half.mechanism.iter().any(|other| {
            close(other.centre_mm, centre, 1e-6) && close(other.velocity, velocity, 1e-9)
        });
        assert!(found, "{unit:?}");
    }
}

/// A wall of two leaves with headers, whose joints crush, dry and bonded.
#[test]
fn walls_of_leaves_have_the_same_factors() {
    let english = read("examples/60_english_bond_wall.toml");
    for bonded in [false, true] {
        let crushed = LimitSettings {
            bonded,
            strength: Some(5.0),
            ..LimitSettings::default()
        };
        images_agree(&english, crushed, 1);
    }
}

/// The plane of a block that is pushed along y is across x; one that is pushed askew has none.
#[test]
fn planes_have_any_normal_or_are_none() {
    let block = super::block([200.0, 100.0, 800.0]);
    agree(&block, along(1), "x");
    agree(&block, along(0), "y");
    let askew = LimitSettings {
        along: Some([1.0, 1.0, 0.0]),
        ..LimitSettings::default()
    };
    let [half, whole] = pair(&block, associated(askew));
    assert_eq!((half.mirror, half.factor), (None, whole.factor));
}
