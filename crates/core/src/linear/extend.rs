//! Addition of a child's Schur complement to its parent's front.

use super::assembly::Run;
use super::number::Number;
use super::schur::Panels;

/// A child's Schur complement and its rows in the parent.
pub(super) struct Child<'a, T> {
    /// Its numbers.
    pub schur: &'a [T],
    /// Their layout.
    pub panels: Panels,
    /// Number of rows that the parent eliminates.
    pub summed: usize,
    /// Its rows in the parent's front.
    pub runs: &'a [Run],
}

impl<T: Number> Child<'_, T> {
    /// Column c from row `c - c % wide` downwards, and that row.
    #[inline]
    fn column(&self, c: usize) -> (&[T], usize) {
        let (start, first) = self.panels.column(c);
        (&self.schur[start..][..self.panels.order - first], first)
    }

    /// Adds to the lower triangle of the parent's columns (m rows).
    pub fn add_columns_lower(&self, columns: &mut [T], m: usize) {
        for (r, run) in self.runs.iter().enumerate() {
            if run.from as usize >= self.summed {
                break;
            }
            for i in 0..run.len as usize {
                let from = self.column(run.from as usize + i);
                let to = &mut columns[(run.to as usize + i) * m..][..m];
                add(&self.runs[r..], i, from, to, 0);
            }
        }
    }

    /// Adds to the lower triangle of the parent's Schur complement, which follows its k columns.
    pub fn add_schur_lower(&self, schur: &mut [T], k: usize, panels: Panels) {
        let start = self
            .runs
            .partition_point(|run| (run.from as usize) < self.summed);
        for r in start..self.runs.len() {
            let run = self.runs[r];
            for i in 0..run.len as usize {
                let from = self.column(run.from as usize + i);
                let (at, first) = panels.column(run.to as usize - k + i);
                let to = &mut schur[at..][..panels.order - first];
                add(&self.runs[r..], i, from, to, k + first);
            }
        }
    }

    /// Adds to the parent's columns (m rows) and to the rest of its k rows.
    pub fn add_columns(&self, columns: &mut [T], rest: &mut [T], m: usize, k: usize) {
        let start = self
            .runs
            .partition_point(|run| (run.from as usize) < self.summed);
        for run in self.runs {
            for i in 0..run.len as usize {
                let from = self.column(run.from as usize + i);
                let column = run.to as usize + i;
                if column < k {
                    add(self.runs, 0, from, &mut columns[column * m..][..m], 0);
                } else {
                    let to = &mut rest[(column - k) * k..][..k];
                    add(&self.runs[..start], 0, from, to, 0);
                }
            }
        }
    }

    /// Adds to the parent's Schur complement (order b), which follows its k columns.
    pub fn add_schur(&self, schur: &mut [T], k: usize, b: usize) {
        let start = self
            .runs
            .partition_point(|run| (run.from as usize) < self.summed);
        for run in &self.runs[start..] {
            for i in 0..run.len as usize {
                let from = self.column(run.from as usize + i);
                let to = &mut schur[(run.to as usize - k + i) * b..][..b];
                add(&self.runs[start..], 0, from, to, k);
            }
        }
    }
}

/// Adds the rows of one column run by run, without the first `skip` rows of the first run. Rows of `from` are
/// counted from its second component, rows of `to` from row `base` of the parent's front.
#[inline]
fn add<T: Number>(runs: &[Run], skip: usize, from: (&[T], usize), to: &mut [T], base: usize) {
    let (from, first) = from;
    let mut skip = skip;
    for run in runs {
        let len = run.len as usize - skip;
        let source = &from[run.from as usize + skip - first..][..len];
        let target = &mut to[run.to as usize + skip - base..][..len];
        for (t, s) in target.iter_mut().zip(source) {
            *t += *s;
        }
        skip = 0;
    }
}
