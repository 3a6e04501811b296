//! Files of numbers that belong to a deck: a fixed number per line, with comments and a line of column names.

use super::Deck;
use crate::deck::quantity::is_sound;
use crate::error::ModelError;
use crate::input;
use std::path::PathBuf;

impl Deck {
    /// Path and text of a file of numbers that the deck names at `key`.
    pub(super) fn table(&self, key: &str, file: &str) -> Result<(PathBuf, String), ModelError> {
        let path = self.folder().join(file);
        match input::text(&path, input::MOST_OF_TABLE) {
            Ok(text) => Ok((path, text)),
            Err(why) => Err(self.error(
                key,
                format!("{}: {why}", path.display()),
                "name a CSV file, relative to the deck's folder",
            )),
        }
    }
}

/// Line of a row (from 1), and its numbers.
pub(super) type Row<const N: usize> = (usize, [f64; N]);

/// Rows of `N` numbers, or the first invalid line and a message: it `is {what}`.
pub(super) fn rows<const N: usize>(text: &str, what: &str) -> Result<Vec<Row<N>>, (usize, String)> {
    let mut rows = Vec::new();
    let mut named = false;
    for (n, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields = line.split(',').map(|f| f.trim().parse::<f64>().ok());
        let numbers: Vec<f64> = fields.clone().flatten().filter(|v| is_sound(*v)).collect();
        let count = fields.count();
        match <[f64; N]>::try_from(numbers) {
            Ok(row) if count == N => rows.push((n + 1, row)),
            // Names of the columns, once and first.
            Err(none) if none.is_empty() && count == N && rows.is_empty() && !named => named = true,
            _ => return Err((n + 1, format!("`{line}` is {what}"))),
        }
    }
    Ok(rows)
}
