//! Curves that are read by hand.

use super::*;
use approx::assert_relative_eq;

fn curve(preload: &[(f64, f64)], driven: &[(f64, f64)]) -> Curve {
    let mut curve = Curve::default();
    for (points, flag) in [(preload, false), (driven, true)] {
        for &(displacement, force) in points {
            curve.push(
                &HistoryRow {
                    displacement_mm: displacement,
                    force_kN: force,
                    ..HistoryRow::default()
                },
                StepOfCurve {
                    driven: flag,
                    ..StepOfCurve::default()
                },
            );
        }
    }
    curve
}

// Rises at 40 kN/mm to 20 kN, bends to a peak of 50 kN at 2 mm, falls to 30 kN at 4 mm.
const WALL: [(f64, f64); 5] = [
    (0.25, 10.0),
    (0.5, 20.0),
    (2.0, 50.0),
    (3.0, 45.0),
    (4.0, 30.0),
];

/// Unloading that the drive asks for is no loss of strength.
#[test]
fn unloading_is_no_fall() {
    let path = [
        (0.5, 10.0),
        (0.2, 3.0),
        (0.5, 9.9),
        (1.0, 9.0),
        (2.0, 8.5),
        (3.0, 8.2),
    ];
    let out = curve(&[], &path);
    assert_eq!(out.displacement_at_80_percent(), None);
    assert!(out.passes_peak());
    let mut fallen = path.to_vec();
    fallen.push((4.0, 7.8));
    // 8 kN between 8.2 and 7.8 kN.
    assert_relative_eq!(
        curve(&[], &fallen).displacement_at_80_percent().unwrap(),
        3.5,
        epsilon = 1e-12
    );
    // A perfect slider loses nothing in its loops.
    let slider = [
        (0.1, 10.0),
        (5.0, 10.0),
        (4.8, -10.0),
        (-5.0, -10.0),
        (-4.8, 10.0),
        (5.0, 10.0),
        (4.9, 0.0),
    ];
    assert!(!curve(&[], &slider).passes_peak());
}

/// A drive that follows another one begins where its step does.
#[test]
fn a_second_drive_begins_at_its_own_force() {
    let mut curve = Curve::default();
    let of = |driven, other| StepOfCurve {
        driven,
        other,
        inertia: ForceBy::Drive,
    };
    let row = |d: f64, f: f64, part: f64| HistoryRow {
        displacement_mm: d,
        force_kN: f,
        load_factor: part,
        ..HistoryRow::default()
    };
    curve.push(&row(3.0, 50.0, 1.0), of(false, true));
    curve.push(&row(0.1, 7.0, 0.1), of(true, false));
    curve.push(&row(0.3, 17.0, 0.3), of(true, false));
    let (d, f) = curve.start();
    assert_relative_eq!(d, 0.0, epsilon = 1e-12);
    assert_relative_eq!(f, 2.0, epsilon = 1e-12);
}

#[test]
fn a_wall_is_read_by_hand() {
    let wall = curve(&[(0.0, 0.0), (0.0, 0.0)], &WALL);
    let peak = wall.peak().unwrap();
    assert_eq!((peak.displacement, peak.force), (2.0, 50.0));
    // 40 kN lies a third of the way from 45 to 30.
    assert_relative_eq!(
        wall.displacement_at_80_percent().unwrap(),
        3.0 + 1.0 / 3.0,
        max_relative = 1e-14 // one interpolation in f64
    );
    // 5 kN at 0.125 mm
    assert_relative_eq!(
        wall.initial_stiffness().unwrap(),
        40.0,
        max_relative = 1e-14
    );
    assert_eq!(wall.final_displacement(), Some(4.0));
}

/// Out to 2 mm, back to −2 mm, out to 3 mm: unloading is not a loss of strength.
#[test]
fn loops_are_read_along_their_envelope() {
    let loops = [
        (1.0, 40.0),
        (2.0, 50.0),
        (1.0, 5.0),
        (-1.0, -30.0),
        (-2.0, -45.0),
        (0.0, 0.0),
        (2.0, 44.0),
        (2.5, 41.0),
        (3.0, 38.0),
        (0.0, -10.0),
    ];
    let wall = curve(&[(0.0, 0.0)], &loops);
    assert!(wall.turns_back());
    assert!(!curve(&[], &WALL).turns_back());
    assert_eq!(wall.peak().unwrap().force, 50.0);
    let other = wall.opposite_peak().unwrap();
    assert_eq!((other.displacement, other.force), (-2.0, -45.0));
    // 40 kN between 41 and 38 kN.
    assert_relative_eq!(
        wall.displacement_at_80_percent().unwrap(),
        2.5 + 0.5 / 3.0,
        max_relative = 1e-14
    );
    // 5 kN at 0.125 mm in the first half cycle.
    assert_relative_eq!(
        wall.initial_stiffness().unwrap(),
        40.0,
        max_relative = 1e-14
    );
}

/// Out to 0.2 mm, then far to the other side, where the peak is: the first way out has the initial stiffness.
#[test]
fn a_drive_that_comes_back_has_the_initial_stiffness_of_its_first_way() {
    let points = [
        (0.1, 20.0),
        (0.2, 36.0),
        (0.01, -3.0),
        (-0.2, -37.0),
        (-3.0, -23.0),
    ];
    for sign in [1.0, -1.0] {
        let wall = curve(&[(0.0, 0.0)], &points.map(|(d, f)| (sign * d, sign * f)));
        assert!(!wall.turns_back());
        assert_relative_eq!(
            wall.initial_stiffness().unwrap(),
            200.0,
            max_relative = 1e-12
        );
    }
}

/// One cycle that ends where it began is a loop, and a slider neither rises nor falls in it.
#[test]
fn one_whole_cycle_is_a_loop() {
    let cycle = [
        (0.1, 10.0),
        (1.0, 10.0),
        (0.8, -10.0),
        (-0.5, -10.0),
        (-1.0, -10.0),
        (-0.8, 10.0),
        (0.0, 10.0),
    ];
    let slider = curve(&[], &cycle);
    assert!(slider.turns_back());
    assert_relative_eq!(slider.initial_stiffness().unwrap(), 100.0, epsilon = 1e-9);
    assert_eq!(slider.opposite_peak().unwrap().force, -10.0);
    for side in [1.0, -1.0] {
        assert_relative_eq!(slider.rises_outwards(side, 0.1), 0.0, epsilon = 1e-12);
    }
    // Out and back by half is no loop.
    assert!(!curve(&[], &[(1.0, 10.0), (2.0, 10.0), (1.1, 1.0)]).turns_back());
    // 10 kN more over the second millimetre: 1 kN over its last two tenths.
    let rises = curve(&[], &[(1.0, 10.0), (2.0, 20.0), (-2.0, -10.0), (0.0, 0.0)]);
    assert_relative_eq!(rises.rises_outwards(1.0, 0.1), 2.0, epsilon = 1e-12);
}

#[test]
fn a_reversed_drive_gives_the_same_values_with_opposite_signs() {
    let mirrored: Vec<_> = WALL.iter().map(|p| (-p.0, -p.1)).collect();
    let (wall, other) = (curve(&[], &WALL), curve(&[], &mirrored));
    let peak = other.peak().unwrap();
    assert_eq!((peak.displacement, peak.force), (-2.0, -50.0));
    assert_eq!(other.initial_stiffness(), wall.initial_stiffness());
    assert_eq!(
        other.displacement_at_80_percent().map(|d| -d),
        wall.displacement_at_80_percent()
    );
}

#[test]
fn the_start_is_the_last_increment_before_driving() {
    let wall = curve(&[(0.1, 3.0)], &[(1.1, 13.0), (2.1, 23.0)]);
    assert_eq!(wall.start(), (0.1, 3.0));
    // (23 − 3)/10 = 2 kN after 0.2 mm
    assert_relative_eq!(
        wall.initial_stiffness().unwrap(),
        10.0,
        max_relative = 1e-12
    );
}

#[test]
fn events_that_did_not_occur_are_none() {
    let nothing = curve(&[(0.0, 0.0)], &[]);
    assert_eq!(nothing.peak(), None);
    assert_eq!(nothing.initial_stiffness(), None);
    assert_eq!(nothing.final_displacement(), None);
    let still_rising = curve(&[], &WALL[..3]);
    assert_eq!(still_rising.displacement_at_80_percent(), None);
    assert_eq!(still_rising.peak().unwrap().force, 50.0);
}

/// Rises to 10 kN and snaps: inertia raises the force to 15 kN; after five quiet increments 12 kN in equilibrium.
fn snaps(inertia: ForceBy) -> Curve {
    let rows = [
        (1.0, 10.0, Method::Static, 0.0),
        (1.01, 15.0, Method::QuasiStatic, 0.5),
        // No more oscillation: steady motion.
        (2.0, 13.0, Method::QuasiStatic, 1e-4),
        (2.2, 13.0, Method::QuasiStatic, 1e-4),
        (2.4, 11.0, Method::QuasiStatic, 1e-4),
        (2.6, 11.0, Method::QuasiStatic, 1e-4),
        (2.8, 11.0, Method::QuasiStatic, 1e-4),
        (3.0, 11.0, Method::QuasiStatic, 1e-4),
        (3.2, 12.0, Method::QuasiStatic, 1e-4),
        (4.0, 9.0, Method::Static, 0.0),
    ];
    let mut curve = Curve::default();
    for (displacement, force, procedure, kinetic) in rows {
        let row = HistoryRow {
            displacement_mm: displacement,
            force_kN: force,
            procedure,
            kinetic_energy_J: kinetic,
            elastic_energy_J: 5.0,
            ..HistoryRow::default()
        };
        let of = StepOfCurve {
            driven: true,
            inertia,
            ..StepOfCurve::default()
        };
        curve.push(&row, of);
    }
    curve
}

#[test]
fn an_overshoot_by_inertia_is_not_a_peak() {
    assert_eq!(snaps(ForceBy::Drive).peak().unwrap().force, 12.0);
    // If the deck asks for inertia, its forces count.
    assert_eq!(snaps(ForceBy::Equilibrium).peak().unwrap().force, 15.0);
}

#[test]
fn numbers_keep_four_digits() {
    for (value, text) in [
        (0.003125, "0.003125"),
        (-1.9, "-1.900"),
        (12345.6, "12346"),
        (0.0, "0"),
    ] {
        assert_eq!(brief(value), text);
    }
}
