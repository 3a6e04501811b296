//! Multifrontal L Lᵀ and L U (Duff & Reid 1983; Liu 1992).
//!
//! Along the assembly tree each supernode gathers its matrix entries and the Schur complements of
//! its children into one dense front, eliminates its columns there and leaves its own Schur
//! complement on a stack. LU pivots within the columns that a front eliminates, so that the tree
//! stays as it was analysed.

use super::assembly::{Assembly, Run};
use super::kernels::{self, Scratch};
use super::ordering::{self, Graph};
use super::tasks::{self, Places, Task};
use super::tree::Tree;
use super::{Kind, LinearError, Ordering, Pattern};
use faer::{MatMut, MatRef};

/// A pivot that is smaller than this, relative to its row of the matrix, is what rounding leaves
/// of zero.
const VANISHED: f64 = 64.0 * f64::EPSILON;

/// Analysis and factors.
#[derive(Debug)]
pub(super) struct Multifrontal {
    plan: Plan,
    task: Task,
    factors: Vec<f64>,
    pivots: Vec<u32>, // [position], LU only: row of the front's block that came here
    stacks: [Vec<f64>; 2], // Schur complements
    permuted: Vec<f64>, // [column][position], of a solution
    gathered: Vec<f64>, // [column][row below], of one front
}

/// What the analysis knows and every thread reads.
#[derive(Debug)]
struct Plan {
    kind: Kind,
    tree: Tree,
    assembly: Assembly,
    places: Places,
    children: Vec<u32>,       // ascending within a supernode
    children_ptr: Vec<usize>, // [supernode + 1]
}

/// The matrix to factorise.
#[derive(Clone, Copy)]
struct Matrix<'a> {
    values: &'a [f64], // [entry]
    /// Σ_j |a_ij|. `[equation]`
    sums: &'a [f64],
}

/// The stretch of all buffers that belongs to a range of supernodes.
struct Share<'a> {
    factors: &'a mut [f64],
    pivots: &'a mut [u32],
    stacks: [&'a mut [f64]; 2],
}

impl Share<'_> {
    /// Cuts off the first numbers of each buffer.
    fn split(self, factors: usize, pivots: usize, stacks: [usize; 2]) -> (Self, Self) {
        let (factors, factors_after) = self.factors.split_at_mut(factors);
        let (pivots, pivots_after) = self.pivots.split_at_mut(pivots);
        let [even, odd] = self.stacks;
        let (even, even_after) = even.split_at_mut(stacks[0]);
        let (odd, odd_after) = odd.split_at_mut(stacks[1]);
        (
            Self {
                factors,
                pivots,
                stacks: [even, odd],
            },
            Self {
                factors: factors_after,
                pivots: pivots_after,
                stacks: [even_after, odd_after],
            },
        )
    }

    fn reborrow(&mut self) -> Share<'_> {
        let [even, odd] = &mut self.stacks;
        Share {
            factors: self.factors,
            pivots: self.pivots,
            stacks: [even, odd],
        }
    }
}

impl Multifrontal {
    /// Orders, builds the assembly tree and allocates all that factorisations need.
    pub fn analyse(pattern: &Pattern, ordering: Ordering, kind: Kind) -> Result<Self, LinearError> {
        let graph = Graph::of(pattern)?;
        let order = ordering::order(pattern, &graph, ordering)?;
        let tree = Tree::new(pattern, &graph, &order)?;
        let assembly = Assembly::new(pattern, &tree, kind)?;
        let (mut task, places) = tasks::plan(&tree);
        task.allocate(&tree)?;
        let (children_ptr, children) = tree.children();
        let below = (0..tree.len()).map(|s| tree.below(s).len()).max();
        let pivots = match kind {
            Kind::Symmetric => 0,
            Kind::Unsymmetric => pattern.n(),
        };
        Ok(Self {
            factors: vec![0.0; assembly.storage[tree.len()]],
            pivots: vec![0; pivots],
            stacks: task.stack.map(|numbers| vec![0.0; numbers]),
            permuted: vec![0.0; pattern.n()],
            gathered: vec![0.0; below.unwrap_or(0)],
            task,
            plan: Plan {
                kind,
                tree,
                assembly,
                places,
                children,
                children_ptr,
            },
        })
    }

    /// Numbers in the factors.
    pub fn factor_nnz(&self) -> usize {
        self.factors.len()
    }

    /// Multiplications and additions of a factorisation.
    pub fn flops(&self) -> f64 {
        let tree = &self.plan.tree;
        let symmetric: f64 = (0..tree.len()).map(|s| tree.work(s)).sum();
        match self.plan.kind {
            Kind::Symmetric => symmetric,
            Kind::Unsymmetric => 2.0 * symmetric,
        }
    }

    /// Numeric factorisation of `values` `[entry]`; `sums` Σ_j |a_ij| `[equation]` say what is
    /// small.
    pub fn factorise(&mut self, values: &[f64], sums: &[f64]) -> Result<(), LinearError> {
        let [even, odd] = &mut self.stacks;
        let share = Share {
            factors: &mut self.factors,
            pivots: &mut self.pivots,
            stacks: [even, odd],
        };
        self.plan
            .run(&mut self.task, Matrix { values, sums }, share)
    }

    /// x ← A⁻¹ x for the columns of `x`, `[column][equation]`.
    pub fn solve(&mut self, x: &mut [f64], columns: usize) {
        let n = self.plan.tree.order.len();
        if n == 0 {
            return;
        }
        self.permuted.resize(x.len(), 0.0);
        for (y, x) in self.permuted.chunks_mut(n).zip(x.chunks(n)) {
            for (y, &e) in y.iter_mut().zip(&self.plan.tree.order) {
                *y = x[e as usize];
            }
        }
        self.forward(columns);
        self.backward(columns);
        for (y, x) in self.permuted.chunks(n).zip(x.chunks_mut(n)) {
            for (y, &e) in y.iter().zip(&self.plan.tree.order) {
                x[e as usize] = *y;
            }
        }
    }

    fn forward(&mut self, columns: usize) {
        let tree = &self.plan.tree;
        let n = tree.order.len();
        for s in 0..tree.len() {
            let (first, k, below) = (tree.first[s], tree.columns(s), tree.below(s));
            let (m, b) = (k + below.len(), below.len());
            let unit = self.plan.kind == Kind::Unsymmetric;
            if unit {
                let pivots = &self.pivots[first..first + k];
                self.gathered.resize(self.gathered.len().max(k), 0.0);
                let moved = &mut self.gathered[..k];
                for y in self.permuted.chunks_mut(n) {
                    let y = &mut y[first..first + k];
                    moved.copy_from_slice(y);
                    for (to, &from) in y.iter_mut().zip(pivots) {
                        *to = moved[from as usize];
                    }
                }
            }
            self.gathered
                .resize(self.gathered.len().max(b * columns), 0.0);
            let update = &mut self.gathered[..b * columns];
            let front = &self.factors[self.plan.assembly.storage[s]..][..m * k];
            let x = MatMut::from_column_major_slice_mut(&mut self.permuted, n, columns);
            kernels::forward(
                unit,
                front,
                m,
                x.subrows_mut(first, k),
                MatMut::from_column_major_slice_mut(update, b, columns),
            );
            if b > 0 {
                for (y, update) in self.permuted.chunks_mut(n).zip(update.chunks(b)) {
                    for (&p, u) in below.iter().zip(update) {
                        y[p as usize] -= u;
                    }
                }
            }
        }
    }

    fn backward(&mut self, columns: usize) {
        let tree = &self.plan.tree;
        let n = tree.order.len();
        for s in (0..tree.len()).rev() {
            let (first, k, below) = (tree.first[s], tree.columns(s), tree.below(s));
            let (m, b) = (k + below.len(), below.len());
            let known = &mut self.gathered[..b * columns];
            if b > 0 {
                for (y, known) in self.permuted.chunks(n).zip(known.chunks_mut(b)) {
                    for (&p, x) in below.iter().zip(known) {
                        *x = y[p as usize];
                    }
                }
            }
            let start = self.plan.assembly.storage[s];
            let (own, below) = kernels::parts(&self.factors[start..][..m * k], m, k);
            let (upper, rest) = match self.plan.kind {
                Kind::Symmetric => (own.transpose(), below.transpose()),
                Kind::Unsymmetric => {
                    let rest = &self.factors[start + m * k..][..k * b];
                    (own, MatRef::from_column_major_slice(rest, k, b))
                }
            };
            let x = MatMut::from_column_major_slice_mut(&mut self.permuted, n, columns);
            let known = MatRef::from_column_major_slice(known, b, columns);
            kernels::backward(upper, rest, x.subrows_mut(first, k), known);
        }
    }
}

impl Plan {
    /// Works a task through: its children at once, if there are threads for them, then its own
    /// supernodes in postorder.
    fn run(&self, task: &mut Task, matrix: Matrix, mut share: Share) -> Result<(), LinearError> {
        self.run_all(&mut task.children, matrix, share.reborrow())?;
        let storage = &self.assembly.storage;
        let skip = storage[task.own.start] - storage[task.start];
        let skip_pivots = self.pivots(task.start..task.own.start);
        let (_, mut own) = share.split(skip, skip_pivots, [0; 2]);
        let Some(scratch) = &mut task.scratch else {
            return Ok(()); // no supernodes
        };
        for s in task.own.clone() {
            // The last one's Schur complement is handed on at the start of the stretch.
            let offset = if s + 1 == task.own.end {
                0
            } else {
                self.places.offset[s]
            };
            let (mut front, rest) =
                own.split(storage[s + 1] - storage[s], self.pivots(s..s + 1), [0; 2]);
            own = rest;
            front.stacks = own.stacks;
            self.eliminate(s, offset, matrix, &mut front, scratch)?;
            own.stacks = front.stacks;
        }
        Ok(())
    }

    /// Works several tasks through, each on its stretch of the buffers. Of several errors the
    /// first in postorder is told, whoever was first in time.
    fn run_all(&self, tasks: &mut [Task], matrix: Matrix, share: Share) -> Result<(), LinearError> {
        let Some((task, others)) = tasks.split_first_mut() else {
            return Ok(());
        };
        let storage = &self.assembly.storage;
        let range = task.start..task.own.end;
        let numbers = storage[range.end] - storage[range.start];
        let (own, rest) = share.split(numbers, self.pivots(range), task.stack);
        if others.is_empty() {
            return self.run(task, matrix, own);
        }
        let (a, b) = rayon::join(
            || self.run(task, matrix, own),
            || self.run_all(others, matrix, rest),
        );
        a.and(b)
    }

    /// Number of pivots kept for these supernodes.
    fn pivots(&self, supernodes: std::ops::Range<usize>) -> usize {
        match self.kind {
            Kind::Symmetric => 0,
            Kind::Unsymmetric => {
                self.tree.first[supernodes.end] - self.tree.first[supernodes.start]
            }
        }
    }

    /// Assembles and eliminates front `s`; its Schur complement goes to `offset` of its stack.
    fn eliminate(
        &self,
        s: usize,
        offset: usize,
        matrix: Matrix,
        share: &mut Share,
        scratch: &mut Scratch,
    ) -> Result<(), LinearError> {
        let (k, b) = (self.tree.columns(s), self.tree.below(s).len());
        let m = k + b;
        let parity = usize::from(self.places.parity[s]);
        let [even, odd] = &mut share.stacks;
        let (made, consumed) = if parity == 0 {
            (even, odd)
        } else {
            (odd, even)
        };
        let schur = &mut made[offset..][..b * b];
        let children = &self.children[self.children_ptr[s]..self.children_ptr[s + 1]];
        let child = |c: u32| {
            let c = c as usize;
            let rows = self.tree.below(c).len();
            Child {
                schur: &consumed[self.places.offset[c]..][..rows * rows],
                rows,
                summed: self.assembly.summed[c] as usize,
                runs: self.assembly.runs(c),
            }
        };

        share.factors.fill(0.0);
        for &[entry, place] in self.assembly.entries(s) {
            share.factors[place as usize] += matrix.values[entry as usize];
        }
        let (columns, rest) = share.factors.split_at_mut(m * k);
        for &c in children {
            match self.kind {
                Kind::Symmetric => child(c).add_columns_lower(columns, m),
                Kind::Unsymmetric => child(c).add_columns(columns, rest, m, k),
            }
        }
        let equation = |column: usize| self.tree.order[self.tree.first[s] + column] as usize;
        match self.kind {
            Kind::Symmetric => kernels::llt(columns, m, k, schur, scratch).map_err(|column| {
                LinearError::NotPositiveDefinite {
                    equation: equation(column),
                }
            })?,
            Kind::Unsymmetric => {
                kernels::lu(columns, rest, m, k, schur, share.pivots, scratch);
            }
        }
        for column in 0..k {
            let pivot = match self.kind {
                Kind::Symmetric => columns[column * (m + 1)].powi(2),
                Kind::Unsymmetric => columns[column * (m + 1)].abs(),
            };
            let equation = equation(column);
            // NaN, from a pivot that vanished earlier, is a verdict too.
            if pivot.is_nan() || pivot <= VANISHED * matrix.sums[equation] {
                return Err(LinearError::Singular { equation });
            }
        }
        for &c in children {
            match self.kind {
                Kind::Symmetric => child(c).add_schur_lower(schur, k, b),
                Kind::Unsymmetric => child(c).add_schur(schur, k, b),
            }
        }
        Ok(())
    }
}

/// A child's Schur complement and where it goes.
struct Child<'a> {
    schur: &'a [f64], // [column][row]
    rows: usize,
    summed: usize, // rows that the parent eliminates
    runs: &'a [Run],
}

impl Child<'_> {
    /// Adds to the lower triangle of the parent's columns (m rows).
    fn add_columns_lower(&self, columns: &mut [f64], m: usize) {
        for (r, run) in self.runs.iter().enumerate() {
            if run.from as usize >= self.summed {
                break;
            }
            for i in 0..run.len as usize {
                let from = &self.schur[(run.from as usize + i) * self.rows..][..self.rows];
                let to = &mut columns[(run.to as usize + i) * m..][..m];
                add(&self.runs[r..], 0, i, from, to);
            }
        }
    }

    /// Adds to the lower triangle of the parent's Schur complement (order b, after k columns).
    fn add_schur_lower(&self, schur: &mut [f64], k: usize, b: usize) {
        let start = self
            .runs
            .partition_point(|run| (run.from as usize) < self.summed);
        for r in start..self.runs.len() {
            let run = self.runs[r];
            for i in 0..run.len as usize {
                let from = &self.schur[(run.from as usize + i) * self.rows..][..self.rows];
                let to = &mut schur[(run.to as usize - k + i) * b..][..b];
                add(&self.runs[r..], k, i, from, to);
            }
        }
    }

    /// Adds to the parent's columns (m rows) and to the rest of its k rows.
    fn add_columns(&self, columns: &mut [f64], rest: &mut [f64], m: usize, k: usize) {
        let start = self
            .runs
            .partition_point(|run| (run.from as usize) < self.summed);
        for run in self.runs {
            for i in 0..run.len as usize {
                let from = &self.schur[(run.from as usize + i) * self.rows..][..self.rows];
                let column = run.to as usize + i;
                if column < k {
                    add(self.runs, 0, 0, from, &mut columns[column * m..][..m]);
                } else {
                    let to = &mut rest[(column - k) * k..][..k];
                    add(&self.runs[..start], 0, 0, from, to);
                }
            }
        }
    }

    /// Adds to the parent's Schur complement (order b, after k columns).
    fn add_schur(&self, schur: &mut [f64], k: usize, b: usize) {
        let start = self
            .runs
            .partition_point(|run| (run.from as usize) < self.summed);
        for run in &self.runs[start..] {
            for i in 0..run.len as usize {
                let from = &self.schur[(run.from as usize + i) * self.rows..][..self.rows];
                let to = &mut schur[(run.to as usize - k + i) * b..][..b];
                add(&self.runs[start..], k, 0, from, to);
            }
        }
    }
}

/// Adds the rows of one column run by run, without the first `skip` of the first run; the rows of
/// `to` are counted from `base` of the parent's front.
#[inline]
fn add(runs: &[Run], base: usize, skip: usize, from: &[f64], to: &mut [f64]) {
    let mut skip = skip;
    for run in runs {
        let len = run.len as usize - skip;
        let source = &from[run.from as usize + skip..][..len];
        let target = &mut to[run.to as usize - base + skip..][..len];
        for (t, s) in target.iter_mut().zip(source) {
            *t += s;
        }
        skip = 0;
    }
}
