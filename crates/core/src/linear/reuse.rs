//! Reuse of factors: selection of the fronts that a factorisation eliminates again.
//!
//! The tree is divided into units. A unit is a front whose Schur complement is kept, with everything below it down
//! to the next kept ones. A unit is stale if an entry of the matrix that it contains has changed by a bit, or if a
//! unit below it is stale. The factors of all others equal those of a complete factorisation. Schur complements are
//! kept where they save much work for each number, and only after a matrix has shown that enough could be reused.

use super::number::Number;
use super::schur::Panels;
use super::tree::{ROOT, Tree};
use super::{Kind, Pattern};

/// Part of the operations that could have been saved from which Schur complements are kept.
const WORTH: f64 = 0.1;
/// Largest count of kept numbers, over those in the factors.
const MOST: f64 = 0.5;

/// Consecutive entries of a column that belong to the same unit.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    start: u32,
    end: u32,
    unit: u32,
}

/// Units and the state of their factors.
#[derive(Debug, Default)]
pub(super) struct Reuse {
    unit: Vec<u32>,          // [supernode], ascending with the units' top supernodes
    parent: Vec<u32>,        // [unit], or `ROOT`
    work: Vec<f64>,          // [unit], operations
    stretches: Vec<Stretch>, // all entries that are read
    stale: Vec<bool>,        // [unit]
    todo: Vec<bool>,         // [supernode]
    kept: Vec<usize>,        // [supernode + 1] start of its Schur complement, if they are kept
    sizes: Vec<usize>,       // [supernode] size where it would be kept
    keeps: bool,
}

impl Reuse {
    /// Divides a tree into units. `panels` gives the layout of Schur complements.
    pub fn new(
        pattern: &Pattern,
        tree: &Tree,
        kind: Kind,
        numbers: usize,
        panels: impl Fn(usize) -> Panels,
    ) -> Self {
        let n = tree.len();
        let sizes: Vec<usize> = (0..n).map(|s| panels(s).len()).collect();
        // Operations for each number from which it is kept: as few as memory allows.
        let mut worth = 4.0;
        let kept = loop {
            let kept = cut(tree, &sizes, worth);
            let total: usize = (0..n).filter(|&s| kept[s]).map(|s| sizes[s]).sum();
            if total as f64 <= MOST * numbers as f64 {
                break kept;
            }
            worth *= 1.5;
        };
        let mut out = Self {
            unit: vec![0; n],
            todo: vec![true; n],
            kept: vec![0; n + 1],
            sizes: (0..n).map(|s| if kept[s] { sizes[s] } else { 0 }).collect(),
            ..Self::default()
        };
        let mut units = 0;
        for s in 0..n {
            if kept[s] {
                out.unit[s] = units;
                units += 1;
            }
        }
        out.parent = vec![ROOT; units as usize];
        out.work = vec![0.0; units as usize];
        out.stale = vec![true; units as usize];
        for s in (0..n).rev() {
            if tree.parent[s] != ROOT {
                let above = out.unit[tree.parent[s] as usize];
                if kept[s] {
                    out.parent[out.unit[s] as usize] = above;
                } else {
                    out.unit[s] = above;
                }
            }
            out.work[out.unit[s] as usize] += tree.work(s);
        }
        out.stretch(pattern, tree, kind);
        out
    }

    /// Lists the entries of each unit.
    fn stretch(&mut self, pattern: &Pattern, tree: &Tree, kind: Kind) {
        let mut home = vec![(0, 0); pattern.n()]; // [equation] → position, unit
        for s in 0..tree.len() {
            for p in tree.first[s]..tree.first[s + 1] {
                home[tree.order[p] as usize] = (p, self.unit[s]);
            }
        }
        for j in 0..pattern.n() {
            let column = pattern.col_ptr()[j]..pattern.col_ptr()[j + 1];
            let mut last: Option<Stretch> = None;
            for e in column {
                let i = pattern.row_idx()[e] as usize;
                if kind == Kind::Symmetric && i < j {
                    continue;
                }
                let unit = home[i].min(home[j]).1;
                match &mut last {
                    Some(stretch) if stretch.unit == unit => stretch.end += 1,
                    _ => {
                        self.stretches.extend(last);
                        last = Some(Stretch {
                            start: e as u32,
                            end: e as u32 + 1,
                            unit,
                        });
                    }
                }
            }
            self.stretches.extend(last);
        }
    }

    /// Marks units with changed entries as stale. An entry belongs to the front that eliminates the first of its
    /// two equations. Without old values all units are stale. Returns true if none is stale.
    pub fn compare(&mut self, old: &[f64], new: &[f64]) -> bool {
        if old.len() != new.len() {
            self.stale.fill(true);
            return false;
        }
        for stretch in &self.stretches {
            let stale = &mut self.stale[stretch.unit as usize];
            if *stale {
                continue;
            }
            let range = stretch.start as usize..stretch.end as usize;
            let pairs = old[range.clone()].iter().zip(&new[range]);
            // Without an early exit, which is faster for so few numbers.
            *stale = pairs.fold(0, |any, (a, b)| any | (a.to_bits() ^ b.to_bits())) != 0;
        }
        !self.stale.contains(&true)
    }

    /// Selects the units to eliminate and returns the part of the operations that is saved. The selected units stay
    /// stale until [`Reuse::succeed`].
    pub fn decide<T: Number>(&mut self, kept: &mut Vec<T>) -> f64 {
        for u in 0..self.parent.len() {
            if self.stale[u] && self.parent[u] != ROOT {
                self.stale[self.parent[u] as usize] = true;
            }
        }
        let saved = |stale: &[bool]| -> f64 {
            let fresh = self.work.iter().zip(stale).filter(|(_, stale)| !**stale);
            let total: f64 = self.work.iter().sum();
            fresh.map(|(work, _)| work).sum::<f64>() / total.max(1.0)
        };
        let mut share = saved(&self.stale);
        if !self.keeps && self.stale.contains(&true) {
            if share >= WORTH {
                self.keeps = true;
                for (s, size) in self.sizes.iter().enumerate() {
                    self.kept[s + 1] = self.kept[s] + size;
                }
                kept.resize(self.kept[self.sizes.len()], T::ZERO);
            }
            self.stale.fill(true);
            share = 0.0;
        }
        for (todo, &unit) in self.todo.iter_mut().zip(&self.unit) {
            *todo = self.stale[unit as usize];
        }
        share
    }

    /// Marks all units as up to date after a successful factorisation.
    pub fn succeed(&mut self) {
        self.stale.fill(false);
    }

    /// Fronts to eliminate. `[supernode]`
    pub fn todo(&self) -> &[bool] {
        &self.todo
    }

    /// Start of kept Schur complements. `[supernode + 1]`
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }
}

/// Schur complements to keep: those with at least `worth` operations for each number since the last ones below
/// them, and those of the roots, which are empty.
fn cut(tree: &Tree, sizes: &[usize], worth: f64) -> Vec<bool> {
    let mut work = vec![0.0; tree.len()];
    let mut kept = vec![false; tree.len()];
    for s in 0..tree.len() {
        work[s] += tree.work(s);
        kept[s] = tree.parent[s] == ROOT || work[s] >= worth * sizes[s] as f64;
        if !kept[s] {
            work[tree.parent[s] as usize] += work[s];
        }
    }
    kept
}
