//! Blocks with a grid of nodes from a file.
//!
//! The file is CSV: `#` comments, an optional line of column names, then x, y, z [mm] of one node per line, along x
//! first, then along y, then along z. Its name is relative to the folder of the deck.

use super::Deck;
use super::rows::{Row, rows};
use crate::element::hexahedron::{PLACES, is_upright};
use crate::error::ModelError;
use crate::input;

impl Deck {
    /// Reads the nodes of the block `index` [mm], if it has a file of nodes. `[node][xyz]`
    ///
    /// # Errors
    /// A file that cannot be read or has another format, a number of nodes that differs from `mesh`, an element
    /// that is flat or folded: key, file, line and reason.
    pub fn block_nodes(&self, index: usize) -> Result<Option<Vec<[f64; 3]>>, ModelError> {
        let block = &self.blocks[index];
        let Some(file) = &block.nodes else {
            return Ok(None);
        };
        let key = format!("blocks.{index}.nodes");
        let path = self.folder().join(file);
        let text = input::text(&path, input::MOST_OF_MESH).map_err(|why| {
            let message = format!("{}: {why}", path.display());
            let help = "name a CSV file, relative to the deck's folder";
            self.error(&key, message, help)
        })?;
        let wrong = |(line, why): (usize, String), help: &str| {
            let message = format!("{} line {line}: {why}", path.display());
            self.error(&key, message, help)
        };
        let rows =
            rows(&text, "no node").map_err(|at| wrong(at, "a node is a line of x, y, z in mm"))?;
        let cells = block.mesh.map(|n| n as usize);
        let wanted: usize = cells.iter().map(|n| n + 1).product();
        if rows.len() != wanted {
            let last = rows.last().map_or(0, |row| row.0);
            let [x, y, z] = cells.map(|n| n + 1);
            let why = format!("{} nodes end here, not {x} x {y} x {z}", rows.len());
            return Err(wrong(
                (last, why),
                "`mesh` counts elements: one less each way",
            ));
        }
        if let Some(line) = first_folded(&rows, cells) {
            let why = "the element that begins at this node is flat or folded".to_owned();
            return Err(wrong(
                (line, why),
                "x varies fastest, then y, then z, in a right-handed order",
            ));
        }
        Ok(Some(rows.into_iter().map(|row| row.1).collect()))
    }
}

/// Line of the first node of the first element without a positive volume at each of its corners.
fn first_folded(rows: &[Row<3>], [nx, ny, nz]: [usize; 3]) -> Option<usize> {
    let node = |i: usize, j: usize, k: usize| &rows[(k * (ny + 1) + j) * (nx + 1) + i];
    let mut cells =
        (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))));
    let folded = |&(i, j, k): &(usize, usize, usize)| {
        !is_upright(&PLACES.map(|[a, b, c]| node(i + a, j + b, k + c).1))
    };
    cells.find(folded).map(|(i, j, k)| node(i, j, k).0)
}
