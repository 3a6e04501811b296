//! The decks of `examples/`.

use std::path::{Path, PathBuf};

use wythe::model::Deck;

/// Where the example of this name lies.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name)
        .with_extension("toml")
}

/// The example, keys of `overrides` said anew.
pub fn load(name: &str, overrides: &[(&str, &str)]) -> Deck {
    let overrides: Vec<_> = overrides
        .iter()
        .map(|(k, v)| ((*k).into(), (*v).into()))
        .collect();
    Deck::load(path(name), &overrides).unwrap()
}
