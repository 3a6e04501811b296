//! The decks of `examples/`.

use std::path::{Path, PathBuf};

use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::Status;

use super::scene::{Recording, run};

/// Path of an example.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name)
        .with_extension("toml")
}

/// The example with the keys of `overrides` replaced.
pub fn load(name: &str, overrides: &[(&str, &str)]) -> Deck {
    let overrides: Vec<_> = overrides
        .iter()
        .map(|(k, v)| ((*k).into(), (*v).into()))
        .collect();
    Deck::load(path(name), &overrides).unwrap()
}

/// Runs the example to its end and checks its energy balance.
pub fn completed(name: &str, overrides: &[(&str, &str)]) -> (Model, Recording) {
    let deck = load(name, overrides);
    let (model, _) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{name}: {e}"));
    let (recording, summary) = run(&model);
    // A tilting test ends with collapse.
    let ends = [Status::Completed, Status::Collapsed];
    assert!(
        ends.contains(&summary.status),
        "{name}: {}",
        summary.message
    );
    let last = recording.rows.last().unwrap();
    let moved = last.kinetic_energy_J + last.damping_dissipation_J + last.numerical_dissipation_J;
    // Each term is integrated separately; theory/energies.md, Decisions (1 %), allows an error of 1 %.
    let open = last.external_work_J - last.taken_J() - moved;
    assert!(
        open.abs() <= 1e-2 * last.external_work_J.abs(),
        "{name}: {open} J of {} J",
        last.external_work_J
    );
    (model, recording)
}
