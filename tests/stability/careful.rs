//! The result must not depend on the increments: default settings against very careful ones.

use std::path::Path;

use crate::common::scene;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::Status;

/// Displacement [mm] and force [kN].
type Curve = Vec<[f64; 2]>;

/// The stored curve; its deck contains the command that wrote it.
fn careful(folder: &Path) -> Curve {
    let text = std::fs::read_to_string(folder.join("careful.csv")).unwrap();
    let rows = text.lines().filter(|l| !l.starts_with(['#', 'd']));
    rows.map(|row| {
        let mut numbers = row.split(',').map(|n| n.parse().unwrap());
        [numbers.next().unwrap(), numbers.next().unwrap()]
    })
    .collect()
}

/// ∫ F du by the trapezoidal rule [J].
fn work(curve: &Curve) -> f64 {
    let pairs = curve.windows(2);
    pairs
        .map(|p| 0.5 * (p[0][1] + p[1][1]) * (p[1][0] - p[0][0]))
        .sum()
}

fn peak(curve: &Curve) -> f64 {
    curve.iter().map(|p| p[1]).fold(0.0, f64::max)
}

#[test]
fn the_default_agrees_with_a_tenth_of_its_increments_and_a_hundredth_of_its_tolerance() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stability");
    let deck = Deck::load(folder.join("small_wall.toml"), &[]).unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    let (recording, summary) = scene::run(&model);
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    let rows = recording.rows.iter().filter(|r| r.step == 1);
    let curve: Curve = rows.map(|r| [r.displacement_mm, r.force_kN]).collect();
    let careful = careful(&folder);
    // Both curves must show softening: at the end the wall has lost a sixth of its strength (so does the one
    // with 1,250 elements a unit).
    for curve in [&curve, &careful] {
        assert!(curve.last().unwrap()[1] < 0.85 * peak(curve));
    }
    let strength = peak(&curve) / peak(&careful) - 1.0;
    let energy = work(&curve) / work(&careful) - 1.0;
    println!(
        "{} solves: peak {strength:+.1e}, energy {energy:+.1e}",
        summary.iterations
    );
    // The documented accuracy of the default; measured: 0.1 and 0.08 %.
    assert!(strength.abs() < 0.01, "{strength}");
    assert!(energy.abs() < 0.02, "{energy}");
}
