//! Factors that are reused for several iterates of an increment change the iterations, not the result.

use std::path::Path;

use crate::common::scene;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::{HistoryRow, Summary};

/// An example with `fidelity` and these overrides.
fn run(example: &str, fidelity: &str, overrides: &[(&str, &str)]) -> (Vec<HistoryRow>, Summary) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/{example}.toml"));
    let fidelity = ("fidelity", fidelity);
    let overrides = overrides.iter().chain([&fidelity]);
    let overrides: Vec<_> = overrides
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    let (model, _) = Model::from_deck(&Deck::load(path, &overrides).unwrap()).unwrap();
    let (recording, summary) = scene::run(&model);
    (recording.rows, summary)
}

/// Compared with `full`: fewer factorisations, no more solves, and the same curve.
fn serves(
    fidelity: &str,
    example: &str,
    overrides: &[(&str, &str)],
    of: impl Fn(&HistoryRow) -> f64,
) {
    let [(whole, all), (auto, some)] =
        ["full", fidelity].map(|fidelity| run(example, fidelity, overrides));
    println!(
        "{example}: {} solves; {} with {} factorisations",
        all.iterations, some.iterations, some.factorisations
    );
    assert_eq!(all.factorisations, all.iterations);
    assert!(2 * some.factorisations < some.iterations);
    // Rounding alone changes their number as well.
    assert!((some.iterations as f64) < 1.15 * all.iterations as f64);
    let largest = |rows: &[HistoryRow]| rows.iter().map(&of).fold(0.0, f64::max);
    let last = |rows: &[HistoryRow]| of(&rows[rows.len() - 1]);
    // The documented accuracy of `auto` (docs/solver.md).
    for (a, b) in [
        (largest(&whole), largest(&auto)),
        (last(&whole), last(&auto)),
    ] {
        assert!((a - b).abs() < 5e-3 * a, "{a} {b}");
    }
}

/// A pushed wall: one right-hand side.
#[test]
fn a_pushed_wall_factorises_less() {
    let to = [
        ("steps.1.displacement", "0.8 mm"),
        ("steps.1.increments", "{ initial = 0.05, max = 0.1 }"),
    ];
    serves("auto", "03_shear_wall_j7d", &to, |row| row.force_kN);
}

/// A wall with a controlled load: two right-hand sides. Its units crack little, so that elastic units give the same
/// curve.
#[test]
fn a_bent_wall_factorises_less() {
    let to = [
        ("wall.mesh", "[4, 2, 2]"),
        ("steps.1.control.displacement", "0.3"),
        ("steps.1.increments.initial", "0.05"),
        ("steps.1.increments.max", "0.2"),
    ];
    for fidelity in ["auto", "elastic"] {
        serves(fidelity, "62_out_of_plane_wall", &to, |row| row.load_factor);
    }
}
