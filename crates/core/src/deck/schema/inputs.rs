//! Files that belong to a deck.

use std::path::PathBuf;

use super::{Deck, DeckAmplitude};
use crate::deck::import::included;

impl Deck {
    /// The file of the deck itself, if it was read from one, the files that it names, and the files that its meshes
    /// include.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut inputs = vec![PathBuf::from(&self.source.file)];
        inputs.extend(self.other_files());
        inputs
    }

    /// The files that the deck names, and those that its meshes include.
    pub fn other_files(&self) -> Vec<PathBuf> {
        let named = self.named_files();
        let mut files: Vec<PathBuf> = named.iter().flat_map(|file| included(file)).collect();
        files.extend(named);
        files
    }

    /// Files that the deck names, with the folder to which they are relative.
    pub fn named_files(&self) -> Vec<PathBuf> {
        let grounds = self.steps.iter().filter_map(|step| step.ground.as_ref());
        let grounds = grounds.flat_map(|ground| ground.files().into_iter().flatten());
        let amplitudes = self.steps.iter().filter_map(|step| match &step.amplitude {
            Some(DeckAmplitude::File(file)) => Some(file.as_str()),
            _ => None,
        });
        let nodes = self.blocks.iter().filter_map(|of| of.nodes.as_deref());
        let stones = self.blocks.iter().filter_map(|of| of.file.as_deref());
        let imports = self.imports.iter().map(|of| of.file.as_str());
        let names = grounds
            .chain(amplitudes)
            .chain(nodes)
            .chain(stones)
            .chain(imports)
            .chain(self.output.experiment.as_deref());
        names.map(|name| self.folder().join(name)).collect()
    }
}
