//! Forward elimination and back substitution along the assembly tree.
//!
//! It follows the same scheme as the factorisation. In forward elimination each supernode passes its update of the
//! rows below to its parent; in back substitution it takes the solution at these rows from there. So branches of
//! the tree can run in parallel, and sums always have the same order.

use std::ops::Range;

use faer::{MatMut, MatRef};

use super::Kind;
use super::ahead::Ahead;
use super::kernels;
use super::multifrontal::Plan;
use super::number::Number;
use super::single;
use super::tasks::Task;

/// Largest number of right-hand sides that are treated one by one.
const FEW: usize = 3;

/// Factors, read by all threads.
#[derive(Clone, Copy)]
pub(super) struct Factors<'a, T> {
    /// Fronts, `Assembly::storage`.
    pub numbers: &'a [T],
    /// Row exchanges `[position]`, LU only.
    pub pivots: &'a [u32],
}

/// Right-hand sides of a range of supernodes, and the vectors passed between fronts.
pub(super) struct Vectors<'a, T> {
    /// Number of right-hand sides.
    pub columns: usize,
    /// `[supernode][column][row]`
    pub x: &'a mut [T],
    /// `[supernode][column][row below]`
    pub below: &'a mut [T],
}

impl<T> Vectors<'_, T> {
    pub fn reborrow(&mut self) -> Vectors<'_, T> {
        Vectors {
            columns: self.columns,
            x: self.x,
            below: self.below,
        }
    }
}

impl<'a, T> Vectors<'a, T> {
    /// Splits off the first numbers of each vector.
    fn split(self, x: usize, below: usize) -> (Vectors<'a, T>, Vectors<'a, T>) {
        let columns = self.columns;
        let (x, x_after) = self.x.split_at_mut(x);
        let (below, below_after) = self.below.split_at_mut(below);
        let after = Vectors {
            columns,
            x: x_after,
            below: below_after,
        };
        (Vectors { columns, x, below }, after)
    }
}

impl Plan {
    /// Count of numbers in `x` and in `below` of a range of supernodes.
    fn extent(&self, range: Range<usize>, columns: usize) -> (usize, usize) {
        let tree = &self.tree;
        (
            (tree.first[range.end] - tree.first[range.start]) * columns,
            (tree.row_ptr[range.end] - tree.row_ptr[range.start]) * columns,
        )
    }

    /// x ← L⁻¹ P x on the subtree of a task, children first.
    pub fn forward<T: Number>(
        &self,
        task: &mut Task<T>,
        factors: Factors<T>,
        mut vectors: Vectors<T>,
    ) {
        self.forward_all(&mut task.children, factors, vectors.reborrow());
        let Some(scratch) = &mut task.scratch else {
            return;
        };
        let columns = vectors.columns;
        let mut ahead = Ahead::new(factors.numbers, &self.assembly.storage);
        for s in task.own.clone() {
            ahead.up(s, task.own.end);
            let (k, b) = (self.tree.columns(s), self.tree.below(s).len());
            let (at, at_below) = self.extent(task.start..s, columns);
            let x = &mut vectors.x[at..][..k * columns];
            let (before, here) = vectors.below.split_at_mut(at_below);
            let below = &mut here[..b * columns];
            below.fill(T::ZERO);
            for &c in self.children(s) {
                let (_, start) = self.extent(task.start..c as usize, columns);
                let rows = self.tree.below(c as usize).len();
                let update = &before[start..][..rows * columns];
                for (q, update) in update.chunks(rows.max(1)).enumerate() {
                    let (x, below) = (&mut x[q * k..][..k], &mut below[q * b..][..b]);
                    for run in self.assembly.runs(c as usize) {
                        let (to, len) = (run.to as usize, run.len as usize);
                        let target = if to < k {
                            &mut x[to..][..len]
                        } else {
                            &mut below[to - k..][..len]
                        };
                        for (t, u) in target.iter_mut().zip(&update[run.from as usize..]) {
                            *t += *u;
                        }
                    }
                }
            }
            let unit = self.kind == Kind::Unsymmetric;
            if unit {
                let pivots = &factors.pivots[self.tree.first[s]..][..k];
                for x in x.chunks_mut(k) {
                    scratch.exchange(x, pivots);
                }
            }
            let m = k + b;
            let front = &factors.numbers[self.assembly.storage[s]..][..m * k];
            if columns <= FEW && !unit {
                // From the second column on, the front is in the cache.
                for q in 0..columns {
                    let (x, below) = (&mut x[q * k..][..k], &mut below[q * b..][..b]);
                    single::forward(front, m, x, below);
                }
                continue;
            }
            let x = MatMut::from_column_major_slice_mut(x, k, columns);
            let below = MatMut::from_column_major_slice_mut(below, b, columns);
            kernels::forward(unit, front, m, x, below);
        }
    }

    fn forward_all<T: Number>(
        &self,
        tasks: &mut [Task<T>],
        factors: Factors<T>,
        vectors: Vectors<T>,
    ) {
        let Some((task, others)) = tasks.split_first_mut() else {
            return;
        };
        let (x, below) = self.extent(task.start..task.own.end, vectors.columns);
        let (own, rest) = vectors.split(x, below);
        if others.is_empty() {
            return self.forward(task, factors, own);
        }
        rayon::join(
            || self.forward(task, factors, own),
            || self.forward_all(others, factors, rest),
        );
    }

    /// x ← U⁻¹ x on the subtree of a task, whose root already has the solution at its rows below. Children come
    /// last.
    pub fn backward<T: Number>(&self, task: &Task<T>, factors: Factors<T>, vectors: Vectors<T>) {
        let columns = vectors.columns;
        let mut ahead = Ahead::new(factors.numbers, &self.assembly.storage);
        for s in task.own.clone().rev() {
            ahead.down(s, task.own.start);
            let (k, b) = (self.tree.columns(s), self.tree.below(s).len());
            let (at, at_below) = self.extent(task.start..s, columns);
            let x = &mut vectors.x[at..][..k * columns];
            let (before, here) = vectors.below.split_at_mut(at_below);
            let known = &here[..b * columns];
            let start = self.assembly.storage[s];
            let m = k + b;
            let front = &factors.numbers[start..][..m * k];
            if columns <= FEW && self.kind == Kind::Symmetric {
                for q in 0..columns {
                    let (x, known) = (&mut x[q * k..][..k], &known[q * b..][..b]);
                    single::backward(front, m, x, known);
                }
            } else {
                let (own, below) = kernels::parts(front, m, k);
                let (upper, rest) = match self.kind {
                    Kind::Symmetric => (own.transpose(), below.transpose()),
                    Kind::Unsymmetric => {
                        let rest = &factors.numbers[start + m * k..][..k * b];
                        (own, MatRef::from_column_major_slice(rest, k, b))
                    }
                };
                kernels::backward(
                    upper,
                    rest,
                    MatMut::from_column_major_slice_mut(x, k, columns),
                    MatRef::from_column_major_slice(known, b, columns),
                );
            }
            for &c in self.children(s) {
                let (_, start) = self.extent(task.start..c as usize, columns);
                let rows = self.tree.below(c as usize).len();
                let wanted = &mut before[start..][..rows * columns];
                for (q, wanted) in wanted.chunks_mut(rows.max(1)).enumerate() {
                    let (x, known) = (&x[q * k..][..k], &known[q * b..][..b]);
                    for run in self.assembly.runs(c as usize) {
                        let (to, len) = (run.to as usize, run.len as usize);
                        let source = if to < k { &x[to..] } else { &known[to - k..] };
                        wanted[run.from as usize..][..len].copy_from_slice(&source[..len]);
                    }
                }
            }
        }
        self.backward_all(&task.children, factors, vectors);
    }

    fn backward_all<T: Number>(&self, tasks: &[Task<T>], factors: Factors<T>, vectors: Vectors<T>) {
        let Some((task, others)) = tasks.split_first() else {
            return;
        };
        let (x, below) = self.extent(task.start..task.own.end, vectors.columns);
        let (own, rest) = vectors.split(x, below);
        if others.is_empty() {
            return self.backward(task, factors, own);
        }
        rayon::join(
            || self.backward(task, factors, own),
            || self.backward_all(others, factors, rest),
        );
    }
}
