//! Division of the assembly tree into tasks, and the storage of Schur complements.
//!
//! A task is a chain of supernodes with all light subtrees attached to it. One thread processes it in postorder.
//! Where two or more heavy subtrees meet, they are tasks of their own and may run in parallel. The division depends
//! on the tree alone, never on the number of threads.
//!
//! Schur complements are on two stacks, one for even and one for odd depths of the tree. A front pushes its own on
//! one stack and pops its children's from the other, so no data is moved. Tasks own disjoint ranges of both stacks.

use std::ops::Range;

use super::kernels::{self, Scratch};
use super::number::Number;
use super::tree::{ROOT, Tree};
use super::{Kind, LinearError};

/// A part of the tree and of the stacks.
#[derive(Debug)]
pub(super) struct Task<T> {
    /// Tasks that must be complete before this one.
    pub children: Vec<Task<T>>,
    /// Supernodes of this task, in order. Those of its children precede them without a gap.
    pub own: Range<usize>,
    /// First supernode of the whole subtree.
    pub start: usize,
    /// Numbers needed on each stack, with those of its children. `[parity]`
    pub stack: [usize; 2],
    /// Memory for the kernels, once [`Task::allocate`] was called.
    pub scratch: Option<Scratch<T>>,
}

impl<T: Number> Task<T> {
    /// Allocates the working memory of this task and of all below it.
    pub fn allocate(&mut self, tree: &Tree) -> Result<(), LinearError> {
        for child in &mut self.children {
            child.allocate(tree)?;
        }
        let most = self.own.clone().map(|s| tree.columns(s)).max();
        self.scratch = most.map(Scratch::new).transpose()?;
        Ok(())
    }
}

// Written by hand, because the derived form requires a default of T.
impl<T> Default for Task<T> {
    fn default() -> Self {
        Self {
            children: Vec::new(),
            own: 0..0,
            start: 0,
            stack: [0; 2],
            scratch: None,
        }
    }
}

/// Storage of each Schur complement.
#[derive(Debug, Default)]
pub(super) struct Places {
    /// Depth of each supernode modulo two: its stack. `[supernode]`
    pub parity: Vec<u8>,
    /// Offset in the stack range of the task that makes it and, equally, of the one that consumes it. `[supernode]`
    pub offset: Vec<usize>,
}

/// Operations below which a subtree gets no task of its own: a hundred times the cost of a fork.
const LEAST: f64 = 5e6;
/// Approximate limit of the number of tasks. It also limits the depth of the recursion over tasks.
const MOST: f64 = 256.0;

/// Places of the Schur complements of a tree.
pub(super) fn places(tree: &Tree, kind: Kind) -> Places {
    plan::<f64>(tree, kind).1
}

/// Divides the tree into tasks and places the Schur complements.
pub(super) fn plan<T: Number>(tree: &Tree, kind: Kind) -> (Task<T>, Places) {
    let n = tree.len();
    let mut work: Vec<f64> = (0..n).map(|s| tree.work(s)).collect();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); n + 1];
    let mut total = 0.0;
    for s in 0..n {
        // Index n stands for a common root of all roots.
        let parent = match tree.parent[s] {
            ROOT => n,
            p => p as usize,
        };
        children[parent].push(s);
        if parent == n {
            total += work[s];
        } else {
            work[parent] += work[s];
        }
    }
    work.push(f64::INFINITY);
    let limit = LEAST.max(total / MOST);

    let mut places = Places {
        parity: vec![0; n],
        offset: vec![0; n],
    };
    for s in (0..n).rev().filter(|&s| tree.parent[s] != ROOT) {
        places.parity[s] = 1 - places.parity[tree.parent[s] as usize];
    }

    let mut first = vec![0; n + 1]; // first supernode of each subtree
    let mut tasks: Vec<Option<Task<T>>> = (0..=n).map(|_| None).collect();
    for s in 0..=n {
        first[s] = children[s].first().map_or(s, |&c| first[c]);
        if work[s] <= limit {
            continue;
        }
        // Heavy children come first in postorder.
        let mut heavy: Vec<Task<T>> = children[s]
            .iter()
            .filter_map(|&c| tasks[c].take())
            .collect();
        let mut task = match heavy.len() {
            1 => heavy.swap_remove(0),
            _ => Task {
                start: first[s],
                own: heavy.last().map_or(first[s], |t| t.own.end)..s,
                children: heavy,
                ..Task::default()
            },
        };
        task.own.end = (s + 1).min(n);
        tasks[s] = Some(task);
    }
    let mut task = tasks[n].take().unwrap_or_default();
    place(&mut task, tree, kind, &children, &mut places);
    (task, places)
}

/// Assigns places by simulating the pushes and pops of a task.
fn place<T>(
    task: &mut Task<T>,
    tree: &Tree,
    kind: Kind,
    children: &[Vec<usize>],
    places: &mut Places,
) {
    let size = |s: usize| {
        let (k, b) = (tree.columns(s), tree.below(s).len());
        kernels::panels(kind, k + b, k).len()
    };
    let (mut top, mut base) = ([0; 2], [0; 2]);
    for child in &mut task.children {
        place(child, tree, kind, children, places);
        // The last supernode of the child leaves its Schur complement at the start of the child's range.
        let root = child.own.end - 1;
        let q = usize::from(places.parity[root]);
        places.offset[root] = base[q];
        top[q] = base[q] + size(root);
        for q in 0..2 {
            base[q] += child.stack[q];
        }
    }
    task.stack = base;
    for s in task.own.clone() {
        let own = usize::from(places.parity[s]);
        places.offset[s] = top[own];
        top[own] += size(s);
        task.stack[own] = task.stack[own].max(top[own]);
        if let Some(&c) = children[s].first() {
            top[1 - own] = places.offset[c];
        }
    }
}
