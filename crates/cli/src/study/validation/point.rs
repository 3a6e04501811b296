//! A run of a single material point: the constitutive law without a mesh.

use std::num::NonZeroUsize;

use serde::Deserialize;

use crate::study::History;
use wythe_core::deck::Deck;
use wythe_core::point::{MATERIAL, Row, Target, material_path, material_state};

/// A virgin material point under proportional strain.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointTest {
    /// Name of its material in the deck. Softening tables are used as given, because a point has no element size.
    pub material: String,
    /// Strain at the end [-]: xx, yy, zz, and engineering shear xy, yz, zx.
    pub strain: [f64; 6],
    /// Components without stress, by their names in [`MATERIAL`]; their strains are unknowns.
    #[serde(default)]
    pub free: Vec<String>,
    /// Number of rows of the path.
    pub rows: NonZeroUsize,
}

/// Column names of a point's history.
pub fn columns() -> Vec<String> {
    let layout = MATERIAL;
    let names = layout.strains.iter().chain(&layout.stresses);
    std::iter::once(&"time")
        .chain(names)
        .chain(&*layout.state)
        .map(|name| (*name).to_owned())
        .collect()
}

impl PointTest {
    /// First name in `free` that is not a component; none if all are valid.
    pub fn unknown(&self) -> Option<&String> {
        let known = |name: &&String| !MATERIAL.components.contains(&name.as_str());
        self.free.iter().find(known)
    }

    /// Drives the point along its path. Returns its history, and the reason if it stopped before the end.
    ///
    /// # Errors
    /// The deck has no such material, in words.
    pub fn run(&self, deck: &Deck) -> Result<(History, Option<String>), String> {
        let (law, _) = deck.law(&self.material, None).map_err(|e| e.to_string())?;
        let count = self.rows.get();
        let row = |i: usize| {
            let part = i as f64 / count as f64;
            let target = |c: usize| {
                if self.free.iter().any(|f| f == MATERIAL.components[c]) {
                    Target::Stress(0.0)
                } else {
                    Target::Strain(part * self.strain[c])
                }
            };
            Row {
                time: part,
                targets: std::array::from_fn(target),
            }
        };
        let rows: Vec<Row<6>> = (1..=count).map(row).collect();
        let walk = material_path(&law, &rows, NonZeroUsize::MIN);
        let answers: Vec<Vec<f64>> = walk
            .records
            .iter()
            .map(|record| {
                let state = &record.state;
                let numbers = std::iter::once(&state.time)
                    .chain(&state.strain)
                    .chain(&state.stress);
                numbers
                    .copied()
                    .chain(material_state(&state.history))
                    .collect()
            })
            .collect();
        let why = walk.failure.map(|failure| {
            let row = &rows[failure.row];
            format!(
                "row {}: {}",
                failure.row + 1,
                failure.why.explain(row, &MATERIAL)
            )
        });
        Ok((History::of_columns(&columns(), &answers), why))
    }
}
