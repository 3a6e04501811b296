//! Pattern of the system matrix, and its assembly in a fixed order.
//!
//! Cells (elements and contact pairs) own disjoint slots of 8 × 8 blocks of 3 × 3. Each block of the matrix lists
//! the cell blocks that it sums, in a fixed order. So the assembled matrix has the same bits on any number of
//! threads. Columns of one node lie together in the compressed values, so groups of node columns are filled in
//! parallel.

use rayon::prelude::*;

use super::dofs::{DofMap, Equations, HELD, PRESCRIBED};
use crate::linear::Kind;

/// Number of values in one cell's matrix: `[a][b][i][j]` with local nodes a, b and directions i, j.
pub const CELL: usize = 8 * 8 * 9;

/// Marks a missing position in the matrix: the row or the column is prescribed.
const NONE: u32 = u32::MAX;

/// A block of the matrix and the positions of its entries.
#[derive(Clone, Debug)]
struct Block {
    /// Position in the values of each entry of a cell's block, or [`NONE`].
    position: [u32; 9],
    /// One bit for each entry that is subtracted: exactly one of its two displacements changes sign by reflection.
    turned: u16,
    /// First contribution, in [`Gather::sources`]. The range ends before `end`.
    start: u32,
    end: u32,
}

/// Columns filled by one task.
#[derive(Clone, Debug)]
struct Chunk {
    blocks: std::ops::Range<usize>,
    values: std::ops::Range<usize>,
    /// Cells that contribute to them.
    cells: Vec<u32>,
}

/// Pattern of the matrix in compressed columns and the map by which it is filled.
#[derive(Clone, Debug)]
pub struct Gather {
    /// Number of equations.
    pub n: usize,
    /// Start of each column. `[n + 1]`
    pub col_ptr: Vec<usize>,
    /// Row of each entry, ascending in a column.
    pub row_idx: Vec<u32>,
    blocks: Vec<Block>,
    /// Cell block `cell · 64 + a · 8 + b` of each contribution. For a symmetric matrix it is the transposed block,
    /// because the blocks of a node column then lie side by side in the cell.
    sources: Vec<u32>,
    chunks: Vec<Chunk>,
}

impl Gather {
    /// Adds to an entry of a matrix, if the pattern has it.
    pub fn add(&self, row: usize, column: usize, value: f64, values: &mut [f64]) {
        let range = self.col_ptr[column]..self.col_ptr[column + 1];
        if let Ok(k) = self.row_idx[range.clone()].binary_search(&(row as u32)) {
            values[range.start + k] += value;
        }
    }

    /// Place of each diagonal entry among the values, if the pattern has it. `[equation]`
    pub fn diagonal(&self) -> impl Iterator<Item = Option<usize>> {
        self.col_ptr.windows(2).enumerate().map(|(e, column)| {
            let rows = &self.row_idx[column[0]..column[1]];
            let at = rows.binary_search(&(e as u32));
            at.ok().map(|k| column[0] + k)
        })
    }

    /// Builds the pattern of `cells`, which have eight nodes each and are structurally symmetric. For a symmetric
    /// matrix the blocks above the diagonal stay zero, because the solver does not read them.
    #[expect(
        clippy::too_many_lines,
        reason = "one pass over the sorted pairs fills blocks and sources"
    )]
    pub fn new(cells: &[[u32; 8]], dofs: &DofMap, equations: &Equations, kind: Kind) -> Self {
        let n = equations.len();
        let symmetric = kind == Kind::Symmetric;
        let equation = |node: u32, i: usize| match dofs.slot[node as usize][i] {
            HELD => PRESCRIBED,
            s => equations.of_slot[s as usize],
        };
        let rank = node_rank(dofs, equations);
        let mut order: Vec<u32> = (0..rank.len() as u32)
            .filter(|&node| rank[node as usize] != NONE)
            .collect();
        order.sort_unstable_by_key(|&node| (rank[node as usize], node));
        let mut place = vec![NONE; rank.len()];
        for (p, &node) in order.iter().enumerate() {
            place[node as usize] = p as u32;
        }
        let pairs = block_pairs(cells, &place, symmetric);
        let pairs = sorted(pairs, order.len());
        let nodes_of = |pair: u64| (order[(pair >> 32) as usize], order[pair as u32 as usize]);

        let (col_ptr, row_idx) = compress(&pairs, n, &nodes_of, &equation);
        // Rows of a column are usually requested in ascending order.
        let mut expected = [0; 3];
        let mut find = |row: u32, col: u32, j: usize| -> u32 {
            let range = col_ptr[col as usize]..col_ptr[col as usize + 1];
            if !(range.contains(&expected[j]) && row_idx[expected[j]] == row) {
                match row_idx[range.clone()].binary_search(&row) {
                    Ok(k) => expected[j] = range.start + k,
                    Err(_) => return NONE,
                }
            }
            expected[j] += 1;
            (expected[j] - 1) as u32
        };
        let mut blocks: Vec<Block> = Vec::new();
        let mut sources = Vec::with_capacity(pairs.len());
        let mut columns: Vec<u32> = Vec::new();
        let mut last = u64::MAX;
        for &(pair, source) in &pairs {
            let (col, row) = nodes_of(pair);
            // Nodes of equal rank share columns and fill both triangles.
            if symmetric && rank[row as usize] < rank[col as usize] {
                continue;
            }
            if pair != last {
                last = pair;
                let (mut position, mut turned) = ([NONE; 9], 0);
                let sign = |node: u32, i: usize| dofs.sign[node as usize][i];
                for i in 0..3 {
                    for j in 0..3 {
                        let (r, c) = (equation(row, i), equation(col, j));
                        if r != PRESCRIBED && c != PRESCRIBED {
                            let k = if symmetric { 3 * j + i } else { 3 * i + j };
                            position[k] = find(r, c, j);
                            turned |= u16::from(sign(row, i) * sign(col, j) < 0.0) << k;
                        }
                    }
                }
                let start = sources.len() as u32;
                blocks.push(Block {
                    position,
                    turned,
                    start,
                    end: start,
                });
                columns.push(col);
            }
            sources.push(source);
            if let Some(block) = blocks.last_mut() {
                block.end += 1;
            }
        }
        let mut chunks = chunk(&blocks, &columns, &rank, &col_ptr, dofs, equations);
        list_cells(&mut chunks, &blocks, &sources, cells.len());
        Self {
            n,
            col_ptr,
            row_idx,
            blocks,
            sources,
            chunks,
        }
    }

    /// Fills the matrix from the cells' slots. Inactive cells are skipped.
    ///
    /// `values` has one entry for each `row_idx`; `cells` is `[cell][CELL]`; `active` is `[cell]`. If `changed`
    /// `[cell]` is given, `values` are those of the last filling, and chunks without a changed cell keep them.
    pub fn fill(
        &self,
        cells: &[f64],
        active: &[bool],
        changed: Option<&[bool]>,
        values: &mut [f64],
    ) {
        let mut rest = values;
        let mut tasks = Vec::with_capacity(self.chunks.len());
        for chunk in &self.chunks {
            let (head, tail) = rest.split_at_mut(chunk.values.len());
            rest = tail;
            let stays = |changed: &[bool]| !chunk.cells.iter().any(|&c| changed[c as usize]);
            if !changed.is_some_and(stays) {
                tasks.push((chunk, head));
            }
        }
        tasks.into_par_iter().for_each(|(chunk, values)| {
            values.fill(0.0);
            let offset = chunk.values.start;
            for block in &self.blocks[chunk.blocks.clone()] {
                let mut sum = [0.0; 9];
                for &source in &self.sources[block.start as usize..block.end as usize] {
                    if active[source as usize / 64] {
                        let at = source as usize * 9;
                        let from = &cells[at..at + 9];
                        for k in 0..9 {
                            sum[k] += from[k];
                        }
                    }
                }
                if block.turned != 0 {
                    for (k, sum) in sum.iter_mut().enumerate() {
                        if block.turned >> k & 1 != 0 {
                            *sum = -*sum;
                        }
                    }
                }
                for k in 0..9 {
                    if block.position[k] != NONE {
                        values[block.position[k] as usize - offset] += sum[k];
                    }
                }
            }
        });
    }
}

/// Order of the columns of nodes: by their first equation. Nodes tied to beams come last with one common rank.
/// Nodes without unknowns have [`NONE`].
fn node_rank(dofs: &DofMap, equations: &Equations) -> Vec<u32> {
    let beams = dofs.beam_start as u32;
    dofs.slot
        .iter()
        .map(|slot| {
            let mut rank = NONE;
            for &s in slot {
                if s != HELD && equations.of_slot[s as usize] != PRESCRIBED {
                    rank = rank.min(equations.of_slot[s as usize].min(beams));
                }
            }
            rank
        })
        .collect()
}

/// Sorts pairs by column, then row, then source. They come in the order of sources, so a stable counting sort by
/// rows and then by columns suffices. All places are below `places`.
fn sorted(mut pairs: Vec<(u64, u32)>, places: usize) -> Vec<(u64, u32)> {
    let mut to = pairs.clone();
    for shift in [0, 32] {
        let key = |pair: u64| (pair >> shift) as u32 as usize;
        let mut start = vec![0_usize; places + 1];
        for (pair, _) in &pairs {
            start[key(*pair) + 1] += 1;
        }
        for p in 0..places {
            start[p + 1] += start[p];
        }
        for one in &pairs {
            let at = &mut start[key(one.0)];
            to[*at] = *one;
            *at += 1;
        }
        std::mem::swap(&mut pairs, &mut to);
    }
    pairs
}

/// Compressed columns of node pairs sorted by column.
fn compress(
    pairs: &[(u64, u32)],
    n: usize,
    nodes_of: &impl Fn(u64) -> (u32, u32),
    equation: &impl Fn(u32, usize) -> u32,
) -> (Vec<usize>, Vec<u32>) {
    let equations = |node: u32| [0, 1, 2].map(|i| equation(node, i));
    // Rows of nodes that share their columns, such as a node and its image, and the columns that have these rows.
    let mut rows: Vec<u32> = Vec::new();
    let mut parts: Vec<(u32, std::ops::Range<usize>)> = Vec::new();
    let mut of_columns = pairs
        .chunk_by(|a, b| a.0 >> 32 == b.0 >> 32)
        .map(|of_column| (equations(nodes_of(of_column[0].0).0), of_column))
        .peekable();
    let mut own: Vec<u32> = Vec::new();
    while let Some((columns, of_column)) = of_columns.next() {
        for of_pair in of_column.chunk_by(|a, b| a.0 == b.0) {
            let (_, row) = nodes_of(of_pair[0].0);
            own.extend(equations(row).into_iter().filter(|&r| r != PRESCRIBED));
        }
        if of_columns.peek().is_some_and(|next| next.0 == columns) {
            continue;
        }
        // Rows repeat for images and for nodes tied to one beam.
        own.sort_unstable();
        own.dedup();
        let start = rows.len();
        rows.append(&mut own);
        let columns = columns.into_iter().filter(|&c| c != PRESCRIBED);
        parts.extend(columns.map(|c| (c, start..rows.len())));
    }
    parts.sort_by_key(|(c, _)| *c);
    let (mut col_ptr, mut row_idx) = (vec![0; n + 1], Vec::new());
    let mut next = 0;
    for c in 0..n {
        let first = next;
        while parts.get(next).is_some_and(|(of, _)| *of as usize == c) {
            row_idx.extend_from_slice(&rows[parts[next].1.clone()]);
            next += 1;
        }
        // Columns repeat as well, for nodes that share some of their directions.
        if next > first + 1 {
            let mut all = row_idx.split_off(col_ptr[c]);
            all.sort_unstable();
            all.dedup();
            row_idx.append(&mut all);
        }
        col_ptr[c + 1] = row_idx.len();
    }
    (col_ptr, row_idx)
}

/// Divides the blocks into tasks of whole node columns. The columns of beams are one task, the last.
fn chunk(
    blocks: &[Block],
    columns: &[u32],
    rank: &[u32],
    col_ptr: &[usize],
    dofs: &DofMap,
    equations: &Equations,
) -> Vec<Chunk> {
    /// Matrix entries of a task: enough for its work to exceed the cost of its scheduling.
    const ENTRIES: usize = 20_000;
    let beams = dofs.beam_start as u32;
    let last_value = *col_ptr.last().unwrap_or(&0);
    let mut chunks: Vec<Chunk> = Vec::new();
    let (mut block_start, mut value_start) = (0, 0);
    for k in 1..=blocks.len() {
        // Nodes of one rank, such as a node and its image, share columns.
        let rank_of = |k: usize| rank[columns[k] as usize];
        let boundary = k == blocks.len() || rank_of(k) != rank_of(k - 1);
        if !boundary {
            continue;
        }
        let next_rank = if k < blocks.len() {
            rank[columns[k] as usize]
        } else {
            NONE
        };
        let value_end = match next_rank {
            NONE => last_value,
            r if r >= beams => col_ptr[equations.len().min(beams as usize)],
            r => col_ptr[r as usize],
        };
        let inside_beams = k < blocks.len() && rank[columns[k - 1] as usize] >= beams;
        let to_beams = next_rank != NONE && next_rank >= beams;
        if !inside_beams && (value_end - value_start >= ENTRIES || to_beams || k == blocks.len()) {
            chunks.push(Chunk {
                blocks: block_start..k,
                values: value_start..value_end,
                cells: Vec::new(),
            });
            block_start = k;
            value_start = value_end;
        }
    }
    chunks
}

/// Places (column, row) and the cell blocks that contribute to them, in cell order.
fn block_pairs(cells: &[[u32; 8]], place: &[u32], symmetric: bool) -> Vec<(u64, u32)> {
    let mut pairs: Vec<(u64, u32)> = Vec::with_capacity(cells.len() * 64);
    for (c, cell) in cells.iter().enumerate() {
        let places = cell.map(|node| place[node as usize]);
        for block in 0..64 {
            let (a, b) = if symmetric {
                (block % 8, block / 8)
            } else {
                (block / 8, block % 8)
            };
            let (row, col) = (places[a], places[b]);
            if col != NONE && row != NONE {
                let pair = u64::from(col) << 32 | u64::from(row);
                pairs.push((pair, (c * 64 + block) as u32));
            }
        }
    }
    pairs
}

/// Lists in each chunk the cells that contribute to it, each once.
fn list_cells(chunks: &mut [Chunk], blocks: &[Block], sources: &[u32], cells: usize) {
    let mut met = vec![usize::MAX; cells];
    for (k, chunk) in chunks.iter_mut().enumerate() {
        let all = blocks[chunk.blocks.clone()].iter();
        for source in all.flat_map(|b| &sources[b.start as usize..b.end as usize]) {
            let cell = *source as usize / 64;
            if met[cell] != k {
                met[cell] = k;
                chunk.cells.push(cell as u32);
            }
        }
    }
}
