//! Assembly of cells: every entry against plain sums, with both triangles or one, on any number of threads.

use std::collections::HashMap;
use std::path::Path;

use crate::common::Random;
use wythe::assembly::dofs::{HELD, PRESCRIBED};
use wythe::assembly::pattern::CELL;
use wythe::assembly::{DofMap, Equations, Gather};
use wythe::deck::Deck;
use wythe::linear::Kind;
use wythe::model::Model;

/// Three courses of J7D with free nodes, fixed nodes and nodes tied to the beam. In the first step one direction of
/// the beam is an unknown, in the second none.
struct Wall {
    model: Model,
    dofs: DofMap,
    cells: Vec<[u32; 8]>,
    values: Vec<f64>,
    active: Vec<bool>,
}

fn wall() -> Wall {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/03_shear_wall_j7d.toml");
    let deck = Deck::load(path, &[("wall.courses".into(), "3".into())]).expect("a sound deck");
    let (model, _) = Model::from_deck(&deck).expect("a sound model");
    let mut random = Random(41);
    let mut cells = model.mesh.elements.clone();
    // Cells between bodies, as for contact pairs; the facets of one body are far from those of the other.
    let far = model.contact.master_facets.iter().rev();
    for (slave, master) in model.contact.slave_facets.iter().zip(far) {
        let mut cell = [0; 8];
        cell[..4].copy_from_slice(slave);
        cell[4..].copy_from_slice(master);
        cells.push(cell);
    }
    let values = (0..cells.len() * CELL).map(|_| random.signed()).collect();
    let active = (0..cells.len()).map(|c| c % 7 != 3).collect();
    Wall {
        dofs: DofMap::new(&model),
        model,
        cells,
        values,
        active,
    }
}

/// Entries (row, column) by plain sums.
fn plain(wall: &Wall, equations: &Equations) -> HashMap<(u32, usize), f64> {
    let mut sums = HashMap::new();
    let equation = |node: u32, i: usize| match wall.dofs.slot[node as usize][i] {
        HELD => PRESCRIBED,
        slot => equations.of_slot[slot as usize],
    };
    for (c, nodes) in wall
        .cells
        .iter()
        .enumerate()
        .filter(|(c, _)| wall.active[*c])
    {
        for (k, value) in wall.values[c * CELL..(c + 1) * CELL].iter().enumerate() {
            let (a, b, i, j) = (k / 72, k / 9 % 8, k / 3 % 3, k % 3);
            let (row, column) = (equation(nodes[a], i), equation(nodes[b], j));
            if row != PRESCRIBED && column != PRESCRIBED {
                *sums.entry((row, column as usize)).or_insert(0.0) += value;
            }
        }
    }
    sums
}

fn filled(wall: &Wall, gather: &Gather, threads: usize) -> Vec<f64> {
    // Previous contents of the matrix must not matter.
    let mut matrix = vec![f64::NAN; gather.row_idx.len()];
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads");
    pool.install(|| gather.fill(&wall.values, &wall.active, None, &mut matrix));
    matrix
}

#[test]
fn every_entry_is_the_sum_of_its_cells_on_any_number_of_threads() {
    let wall = wall();
    for step in &wall.model.steps {
        let equations = Equations::new(&wall.dofs, step);
        let sums = plain(&wall, &equations);
        let full = Gather::new(&wall.cells, &wall.dofs, &equations, Kind::Unsymmetric);
        let lower = Gather::new(&wall.cells, &wall.dofs, &equations, Kind::Symmetric);
        assert_eq!(full.col_ptr, lower.col_ptr);
        assert_eq!(full.row_idx, lower.row_idx);
        let matrix = filled(&wall, &full, 1);
        let half = filled(&wall, &lower, 1);
        let (mut met, mut read) = (0, 0);
        for column in 0..full.n {
            for k in full.col_ptr[column]..full.col_ptr[column + 1] {
                let row = full.row_idx[k];
                let sum = sums.get(&(row, column));
                met += usize::from(sum.is_some());
                // Tolerance: up to a few hundred numbers below 1, summed in a different order.
                let error = matrix[k] - sum.unwrap_or(&0.0);
                assert!(error.abs() < 1e-12, "({row}, {column}): {error:e}");
                if row as usize >= column {
                    // It must not matter which triangle of a symmetric cell is read. These cells are not symmetric,
                    // so that a difference would show.
                    let mirrored = lower.col_ptr[row as usize]
                        + lower.row_idx
                            [lower.col_ptr[row as usize]..lower.col_ptr[row as usize + 1]]
                            .binary_search(&(column as u32))
                            .expect("a symmetric pattern");
                    // Blocks of nodes on one beam are summed in a different order.
                    let error = half[k] - matrix[mirrored];
                    assert!(error.abs() < 1e-12, "({row}, {column}): {error:e}");
                    read += 1;
                } else {
                    assert!(half[k].is_finite());
                }
            }
        }
        assert_eq!(met, sums.len(), "entries outside the pattern");
        assert!(read > full.row_idx.len() / 2);
        for threads in [2, 4] {
            assert_eq!(matrix, filled(&wall, &full, threads));
            assert_eq!(half, filled(&wall, &lower, threads));
        }
    }
}
