//! Assembly of fronts from matrix entries and children. Each index is computed once.

use super::tree::{ROOT, Tree};
use super::{Kind, LinearError, Pattern};

/// Consecutive rows of a Schur complement that are also consecutive in the parent's front.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// First row in the child's Schur complement.
    pub from: u32,
    /// First row in the parent's front.
    pub to: u32,
    /// Number of rows.
    pub len: u32,
}

/// Indices for assembly. A front of m rows, of which k are eliminated, is stored as its k columns (m × k). For L U
/// the rest of its k rows (k × (m − k)) follows. Both are stored by columns.
#[derive(Debug, Default)]
pub(super) struct Assembly {
    /// Start of each front in the storage of the factors. `[supernode + 1]`
    pub storage: Vec<usize>,
    /// Start of each front's matrix entries. `[supernode + 1]`
    pub entry_ptr: Vec<usize>,
    /// Index of the matrix entry, and its index in the storage of the front. `[entry_ptr]`
    pub entries: Vec<[u32; 2]>,
    /// Start of each supernode's runs. `[supernode + 1]`
    pub run_ptr: Vec<usize>,
    /// Its rows in its parent's front, divided where the parent's columns end. `[run_ptr]`
    pub runs: Vec<Run>,
    /// Number of its rows that its parent eliminates. `[supernode]`
    pub summed: Vec<u32>,
}

impl Assembly {
    /// Prepares the fronts of a tree for symmetric or unsymmetric values.
    #[expect(
        clippy::too_many_lines,
        reason = "the places of all blocks in one pass"
    )]
    pub fn new(pattern: &Pattern, tree: &Tree, kind: Kind) -> Result<Self, LinearError> {
        let n = pattern.n();
        let mut position = vec![0u32; n];
        for (p, &e) in tree.order.iter().enumerate() {
            position[e as usize] = p as u32;
        }
        let mirror = mirror(pattern)?;
        let mut local = vec![0u32; n]; // row in the front of each position
        let mut out = Self {
            storage: vec![0],
            entry_ptr: vec![0],
            entries: Vec::with_capacity(match kind {
                Kind::Symmetric => usize::midpoint(pattern.nnz(), n),
                Kind::Unsymmetric => pattern.nnz(),
            }),
            ..Self::default()
        };
        let mut next = 0;
        for s in 0..tree.len() {
            let (k, below) = (tree.columns(s), tree.below(s));
            let m = k + below.len();
            let columns = tree.first[s]..tree.first[s + 1];
            for (row, p) in columns.clone().enumerate() {
                local[p] = row as u32;
            }
            for (row, &p) in below.iter().enumerate() {
                local[p as usize] = (k + row) as u32;
            }
            let size = match kind {
                Kind::Symmetric => m * k,
                Kind::Unsymmetric => m * k + k * (m - k),
            };
            u32::try_from(size).map_err(|_| LinearError::TooLarge)?;
            for p in columns {
                let j = tree.order[p] as usize;
                let column = local[p] as usize;
                for e in pattern.col_ptr()[j]..pattern.col_ptr()[j + 1] {
                    let i = pattern.row_idx()[e] as usize;
                    if (position[i] as usize) < p {
                        continue;
                    }
                    // Entry e is (i, j), its mirror entry (j, i). Equation i is eliminated after j.
                    let row = local[position[i] as usize] as usize;
                    let left = (row + m * column) as u32;
                    match kind {
                        Kind::Symmetric => {
                            let lower = if i >= j { e as u32 } else { mirror[e] };
                            out.entries.push([lower, left]);
                        }
                        Kind::Unsymmetric => {
                            out.entries.push([e as u32, left]);
                            let upper = match row {
                                r if r < k => column + m * r,
                                r => m * k + column + k * (r - k),
                            };
                            if row != column {
                                out.entries.push([mirror[e], upper as u32]);
                            }
                        }
                    }
                }
            }
            next += size;
            out.storage.push(next);
            out.entry_ptr.push(out.entries.len());
        }
        out.connect(tree, &mut local);
        Ok(out)
    }

    /// Finds the runs of each supernode in its parent.
    fn connect(&mut self, tree: &Tree, local: &mut [u32]) {
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); tree.len()];
        for (s, &p) in tree.parent.iter().enumerate() {
            if p != ROOT {
                children[p as usize].push(s);
            }
        }
        let mut lists: Vec<Vec<Run>> = vec![Vec::new(); tree.len()];
        self.summed = vec![0; tree.len()];
        for p in 0..tree.len() {
            let k = tree.columns(p) as u32;
            for (row, q) in (tree.first[p]..tree.first[p + 1]).enumerate() {
                local[q] = row as u32;
            }
            for (row, &q) in tree.below(p).iter().enumerate() {
                local[q as usize] = k + row as u32;
            }
            for &c in &children[p] {
                let rows = tree.below(c);
                self.summed[c] = rows.partition_point(|&q| (q as usize) < tree.first[p + 1]) as u32;
                let list = &mut lists[c];
                for (from, &q) in rows.iter().enumerate() {
                    let to = local[q as usize];
                    match list.last_mut() {
                        Some(run) if run.to + run.len == to && to != k => run.len += 1,
                        _ => list.push(Run {
                            from: from as u32,
                            to,
                            len: 1,
                        }),
                    }
                }
            }
        }
        self.run_ptr = vec![0];
        for list in &lists {
            self.runs.extend_from_slice(list);
            self.run_ptr.push(self.runs.len());
        }
    }

    /// Runs of supernode `s` in its parent.
    pub fn runs(&self, s: usize) -> &[Run] {
        &self.runs[self.run_ptr[s]..self.run_ptr[s + 1]]
    }

    /// Entries of the matrix in front `s`.
    pub fn entries(&self, s: usize) -> &[[u32; 2]] {
        &self.entries[self.entry_ptr[s]..self.entry_ptr[s + 1]]
    }
}

/// Index of entry (j, i) for each entry (i, j).
fn mirror(pattern: &Pattern) -> Result<Vec<u32>, LinearError> {
    u32::try_from(pattern.nnz()).map_err(|_| LinearError::TooLarge)?;
    let mut cursor = pattern.col_ptr()[..pattern.n()].to_vec();
    let mut mirror = vec![0u32; pattern.nnz()];
    for j in 0..pattern.n() {
        for e in pattern.col_ptr()[j]..pattern.col_ptr()[j + 1] {
            // Columns are visited in the order in which rows are listed.
            let i = pattern.row_idx()[e] as usize;
            mirror[e] = cursor[i] as u32;
            cursor[i] += 1;
        }
    }
    Ok(mirror)
}
