//! Multifrontal L Lᵀ and L U (Duff & Reid 1983; Liu 1992; theory/linear-solver.md, eq. 2).
//!
//! Each supernode of the assembly tree adds its matrix entries and the Schur complements of its children in one
//! dense front. It eliminates its columns there and leaves its own Schur complement on a stack. L U pivots within
//! the columns that a front eliminates, so the tree stays as analysed.

use std::sync::Arc;

use super::assembly::Assembly;
use super::extend::Child;
use super::kernels::{self, Scratch};
use super::number::Number;
use super::ordering::{self, Graph};
use super::reuse::Reuse;
use super::schur::Panels;
use super::share::{Cut, Front, Matrix, Share};
use super::substitution::{Factors, Vectors};
use super::tasks::{self, Places, Task};
use super::tree::Tree;
use super::{Kind, LinearError, Ordering, Pattern};

/// A pivot below this number of rounding errors, relative to its matrix row, counts as zero
/// (theory/linear-solver.md, eq. 4).
const VANISHED: f64 = 64.0;

/// Factors for a plan, in numbers of one precision.
#[derive(Debug)]
pub(super) struct Multifrontal<T> {
    plan: Arc<Plan>,
    task: Task<T>,
    factors: Vec<T>,
    pivots: Vec<u32>,    // [position], L U only: original row in the front's block
    stacks: [Vec<T>; 2], // Schur complements
    kept: Vec<T>,        // those that later factorisations may need
    reuse: Reuse,
    x: Vec<T>,     // [supernode][column][row], of a solution
    below: Vec<T>, // [supernode][column][row below]
}

/// Result of the analysis, read by all threads.
#[derive(Debug)]
pub(super) struct Plan {
    pub kind: Kind,
    pub tree: Tree,
    pub assembly: Assembly,
    places: Places,
    children: Vec<u32>,       // ascending within a supernode
    children_ptr: Vec<usize>, // [supernode + 1]
}

impl<T: Number> Multifrontal<T> {
    /// Allocates the memory for factorisations.
    pub fn new(plan: Arc<Plan>, pattern: &Pattern) -> Result<Self, LinearError> {
        let (mut task, _) = tasks::plan(&plan.tree, plan.kind);
        task.allocate(&plan.tree)?;
        let pivots = match plan.kind {
            Kind::Symmetric => 0,
            Kind::Unsymmetric => pattern.n(),
        };
        let numbers = plan.factor_nnz();
        let panels = |s| plan.panels(s);
        Ok(Self {
            reuse: Reuse::new(pattern, &plan.tree, plan.kind, numbers, panels),
            kept: Vec::new(),
            factors: vec![T::ZERO; numbers],
            pivots: vec![0; pivots],
            stacks: task.stack.map(|numbers| vec![T::ZERO; numbers]),
            x: vec![T::ZERO; pattern.n()],
            below: vec![T::ZERO; plan.tree.rows.len()],
            task,
            plan,
        })
    }

    /// Compares the values of the last factorisation, successful or not, with the next ones `[entry]`. Returns true
    /// if the last one succeeded and no value that is read has changed.
    pub fn compare(&mut self, old: &[f64], new: &[f64]) -> bool {
        self.reuse.compare(old, new)
    }

    /// Factorises `values` `[entry]`. `sums` Σ_j |a_ij| `[equation]` are the scale of vanishing pivots.
    ///
    /// Returns the part of the operations that was saved by reusing factors. The result has the same bits without
    /// reuse.
    pub fn factorise(&mut self, values: &[f64], sums: &[f64]) -> Result<f64, LinearError> {
        let saved = self.reuse.decide(&mut self.kept);
        let matrix = Matrix {
            todo: self.reuse.todo(),
            kept: self.reuse.kept(),
            values,
            sums,
        };
        let [even, odd] = &mut self.stacks;
        let share = Share {
            factors: &mut self.factors,
            pivots: &mut self.pivots,
            stacks: [even, odd],
            kept: &mut self.kept,
        };
        self.plan.run(&mut self.task, matrix, share)?;
        self.reuse.succeed();
        Ok(saved)
    }

    /// x ← A⁻¹ x for the columns of `x`, `[column][equation]`, to the accuracy of its precision.
    pub fn solve(&mut self, x: &mut [f64], columns: usize) {
        let n = self.plan.tree.order.len();
        if n == 0 {
            return;
        }
        let tree = &self.plan.tree;
        self.x.resize(x.len(), T::ZERO);
        self.below.resize(tree.rows.len() * columns, T::ZERO);
        let scale = T::scale(x);
        // Unknowns of each supernode are contiguous: x is [supernode][column][row].
        let blocks = || (0..tree.len()).map(|s| (tree.first[s], tree.columns(s)));
        for (first, k) in blocks() {
            let block = &mut self.x[first * columns..][..k * columns];
            for (y, x) in block.chunks_mut(k).zip(x.chunks(n)) {
                for (y, &e) in y.iter_mut().zip(&tree.order[first..first + k]) {
                    *y = T::of(scale * x[e as usize]);
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
                    x[e as usize] = y.f64() / scale;
                }
            }
        }
    }
}

impl Plan {
    /// Orders the equations and builds the assembly tree.
    pub fn analyse(pattern: &Pattern, ordering: Ordering, kind: Kind) -> Result<Self, LinearError> {
        let graph = Graph::of(pattern)?;
        let order = ordering::order(pattern, &graph, ordering)?;
        let tree = Tree::new(pattern, &graph, &order)?;
        let assembly = Assembly::new(pattern, &tree, kind)?;
        let (children_ptr, children) = tree.children();
        Ok(Self {
            kind,
            places: tasks::places(&tree, kind),
            assembly,
            children,
            children_ptr,
            tree,
        })
    }

    /// Values of the matrix that are read.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// Count of numbers in the factors.
    pub fn factor_nnz(&self) -> usize {
        self.assembly.storage[self.tree.len()]
    }

    /// Multiplications and additions of a factorisation.
    pub fn flops(&self) -> f64 {
        let symmetric: f64 = (0..self.tree.len()).map(|s| self.tree.work(s)).sum();
        match self.kind {
            Kind::Symmetric => symmetric,
            Kind::Unsymmetric => 2.0 * symmetric,
        }
    }

    /// Children of supernode `s`, ascending.
    pub fn children(&self, s: usize) -> &[u32] {
        &self.children[self.children_ptr[s]..self.children_ptr[s + 1]]
    }

    /// Layout of the Schur complement of supernode `s`.
    fn panels(&self, s: usize) -> Panels {
        let k = self.tree.columns(s);
        kernels::panels(self.kind, k + self.tree.below(s).len(), k)
    }

    /// Processes a task: first its children, in parallel if threads are available, then its own supernodes in
    /// postorder.
    fn run<T: Number>(
        &self,
        task: &mut Task<T>,
        matrix: Matrix,
        mut share: Share<T>,
    ) -> Result<(), LinearError> {
        if !matrix.todo[task.start..task.own.end].contains(&true) {
            return Ok(());
        }
        self.run_all(&mut task.children, matrix, share.reborrow())?;
        let Some(scratch) = &mut task.scratch else {
            return Ok(()); // no supernodes
        };
        let storage = &self.assembly.storage;
        let start = storage[task.start];
        let first_pivot = self.tree.first[task.start];
        let [even, odd] = share.stacks;
        for s in task.own.clone().filter(|&s| matrix.todo[s]) {
            // The Schur complement of the last supernode goes to the start of the task's range, for the parent
            // task.
            let offset = if s + 1 == task.own.end {
                0
            } else {
                self.places.offset[s]
            };
            let range = storage[s] - start..storage[s + 1] - start;
            let pivots = match self.kind {
                Kind::Symmetric => 0..0,
                Kind::Unsymmetric => {
                    self.tree.first[s] - first_pivot..self.tree.first[s + 1] - first_pivot
                }
            };
            let mut front = Front {
                factors: &mut share.factors[range],
                pivots: &mut share.pivots[pivots],
                stacks: [&mut *even, &mut *odd],
                kept: share.kept,
                base: matrix.kept[task.start],
                offset,
            };
            self.eliminate(s, matrix, &mut front, scratch)?;
        }
        Ok(())
    }

    /// Processes several tasks, each on its own range of the buffers. Of several errors the first in postorder is
    /// returned, independent of time.
    fn run_all<T: Number>(
        &self,
        tasks: &mut [Task<T>],
        matrix: Matrix,
        share: Share<T>,
    ) -> Result<(), LinearError> {
        let Some((task, others)) = tasks.split_first_mut() else {
            return Ok(());
        };
        let storage = &self.assembly.storage;
        let range = task.start..task.own.end;
        let numbers = storage[range.end] - storage[range.start];
        let (own, rest) = share.split(&Cut {
            factors: numbers,
            kept: matrix.kept[range.end] - matrix.kept[range.start],
            pivots: self.pivots(range),
            stacks: task.stack,
        });
        if others.is_empty() {
            return self.run(task, matrix, own);
        }
        let (a, b) = rayon::join(
            || self.run(task, matrix, own),
            || self.run_all(others, matrix, rest),
        );
        a.and(b)
    }

    /// Number of stored pivots of these supernodes.
    fn pivots(&self, supernodes: std::ops::Range<usize>) -> usize {
        match self.kind {
            Kind::Symmetric => 0,
            Kind::Unsymmetric => {
                self.tree.first[supernodes.end] - self.tree.first[supernodes.start]
            }
        }
    }

    /// Assembles and eliminates front `s`.
    #[expect(
        clippy::too_many_lines,
        reason = "one front: assembled, factorised and passed on"
    )]
    fn eliminate<T: Number>(
        &self,
        s: usize,
        matrix: Matrix,
        share: &mut Front<T>,
        scratch: &mut Scratch<T>,
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
        let panels = self.panels(s);
        let kept = matrix.kept;
        let (before, here) = share.kept.split_at_mut(kept[s] - share.base);
        let schur = if kept[s + 1] > kept[s] {
            &mut here[..panels.len()]
        } else {
            &mut made[share.offset..][..panels.len()]
        };
        let children = self.children(s);
        let child = |c: u32| {
            let c = c as usize;
            let panels = self.panels(c);
            let from = if kept[c + 1] > kept[c] {
                &before[kept[c] - share.base..]
            } else {
                &consumed[self.places.offset[c]..]
            };
            Child {
                schur: &from[..panels.len()],
                panels,
                summed: self.assembly.summed[c] as usize,
                runs: self.assembly.runs(c),
            }
        };

        share.factors.fill(T::ZERO);
        for &[entry, place] in self.assembly.entries(s) {
            share.factors[place as usize] += T::of(matrix.values[entry as usize]);
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
                Kind::Symmetric => columns[column * (m + 1)].f64().powi(2),
                Kind::Unsymmetric => columns[column * (m + 1)].f64().abs(),
            };
            let equation = equation(column);
            // NaN follows from an earlier vanished pivot.
            if pivot.is_nan() || pivot <= VANISHED * T::EPSILON * matrix.sums[equation] {
                return Err(LinearError::Singular { equation });
            }
        }
        for &c in children {
            match self.kind {
                Kind::Symmetric => child(c).add_schur_lower(schur, k, panels),
                Kind::Unsymmetric => child(c).add_schur(schur, k, b),
            }
        }
        Ok(())
    }
}
