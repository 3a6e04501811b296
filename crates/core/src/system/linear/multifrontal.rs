//! Multifrontal L Lᵀ and L U (Duff & Reid 1983; Liu 1992).
//!
//! Along the assembly tree each supernode gathers its matrix entries and the Schur complements of
//! its children into one dense front, eliminates its columns there and leaves its own Schur
//! complement on a stack. LU pivots within the columns that a front eliminates, so that the tree
//! stays as it was analysed.

use super::assembly::Assembly;
use super::extend::Child;
use super::kernels::{self, Scratch};
use super::ordering::{self, Graph};
use super::substitution::{Factors, Vectors};
use super::tasks::{self, Places, Task};
use super::tree::Tree;
use super::{Kind, LinearError, Ordering, Pattern};

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
    x: Vec<f64>,      // [supernode][column][row], of a solution
    below: Vec<f64>,  // [supernode][column][row below]
}

/// What the analysis knows and every thread reads.
#[derive(Debug)]
pub(super) struct Plan {
    pub kind: Kind,
    pub tree: Tree,
    pub assembly: Assembly,
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
        let pivots = match kind {
            Kind::Symmetric => 0,
            Kind::Unsymmetric => pattern.n(),
        };
        Ok(Self {
            factors: vec![0.0; assembly.storage[tree.len()]],
            pivots: vec![0; pivots],
            stacks: task.stack.map(|numbers| vec![0.0; numbers]),
            x: vec![0.0; pattern.n()],
            below: vec![0.0; tree.rows.len()],
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
        let tree = &self.plan.tree;
        self.x.resize(x.len(), 0.0);
        self.below.resize(tree.rows.len() * columns, 0.0);
        // Each supernode's unknowns together: x as [supernode][column][row].
        let blocks = || (0..tree.len()).map(|s| (tree.first[s], tree.columns(s)));
        for (first, k) in blocks() {
            let block = &mut self.x[first * columns..][..k * columns];
            for (y, x) in block.chunks_mut(k).zip(x.chunks(n)) {
                for (y, &e) in y.iter_mut().zip(&tree.order[first..first + k]) {
                    *y = x[e as usize];
                }
            }
        }
        let mut vectors = Vectors {
            columns,
            x: &mut self.x,
            below: &mut self.below,
        };
        let factors = Factors {
            numbers: &self.factors,
            pivots: &self.pivots,
        };
        self.plan
            .forward(&mut self.task, factors, vectors.reborrow());
        self.plan.backward(&self.task, factors, vectors);
        for (first, k) in blocks() {
            let block = &self.x[first * columns..][..k * columns];
            for (y, x) in block.chunks(k).zip(x.chunks_mut(n)) {
                for (y, &e) in y.iter().zip(&tree.order[first..first + k]) {
                    x[e as usize] = *y;
                }
            }
        }
    }
}

impl Plan {
    /// Children of supernode `s`, ascending.
    pub fn children(&self, s: usize) -> &[u32] {
        &self.children[self.children_ptr[s]..self.children_ptr[s + 1]]
    }

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
        let children = self.children(s);
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
