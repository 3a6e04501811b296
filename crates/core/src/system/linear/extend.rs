//! Adding a child's Schur complement to its parent's front.

use super::assembly::Run;

/// A child's Schur complement and where it goes.
pub(super) struct Child<'a> {
    /// `[column][row]`
    pub schur: &'a [f64],
    /// Its order.
    pub rows: usize,
    /// Rows that the parent eliminates.
    pub summed: usize,
    /// Its rows in the parent's front.
    pub runs: &'a [Run],
}

impl Child<'_> {
    /// Adds to the lower triangle of the parent's columns (m rows).
    pub fn add_columns_lower(&self, columns: &mut [f64], m: usize) {
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
    pub fn add_schur_lower(&self, schur: &mut [f64], k: usize, b: usize) {
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
    pub fn add_columns(&self, columns: &mut [f64], rest: &mut [f64], m: usize, k: usize) {
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
    pub fn add_schur(&self, schur: &mut [f64], k: usize, b: usize) {
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
