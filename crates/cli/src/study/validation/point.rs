//! A run of a single material point: no mesh, the law alone.

use std::num::NonZeroUsize;

use serde::Deserialize;

use crate::study::History;
use wythe_core::deck::Deck;
use wythe_core::point::{MATERIAL, Row, Target, material_path, material_state};

/// A virgin point of a material that is strained in proportion.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointTest {
    /// Its material in the deck; tables are taken as given, a point has no size.
    pub material: String,
    /// Strain at the end [-]: xx, yy, zz, and engineering shear xy, yz, zx.
    pub strain: [f64; 6],
    /// Components that take no stress, by the names of [`MATERIAL`]; their strain is found.
    #[serde(default)]
    pub free: Vec<String>,
    /// Rows of the path.
    pub rows: NonZeroUsize,
}

/// Names of the columns of a point's history.
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
    /// A component that is none, if one is named.
    pub fn unknown(&self) -> Option<&String> {
        let known = |name: &&String| !MATERIAL.components.contains(&name.as_str());
        self.free.iter().find(known)
    }

    /// Takes the point along its path: what it answers, and why it stopped if it did.
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
