//! Files of numbers that belong to a deck: a fixed number per line, with comments and a line of column names.

use crate::deck::quantity::is_sound;

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
