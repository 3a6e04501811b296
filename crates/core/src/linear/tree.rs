//! Assembly tree: columns that are eliminated together, their fronts, and the order of elimination.
//!
//! L Lᵀ and L U of a structurally symmetric matrix both fill the pattern of the symmetric elimination, so one
//! analysis serves both. It consists of the elimination tree (Liu 1990), column counts by row subtrees, supernodes
//! of equal structure and their merging by a cost model. It works on the graph of nodes, each weighted with its
//! number of equations.

use super::ordering::{Graph, expand};
use super::{LinearError, Pattern};

/// Marks a supernode without a parent.
pub(super) const ROOT: u32 = u32::MAX;

/// Supernodes in postorder: a child precedes its parent, and a subtree is a contiguous range.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// Equation eliminated at each position. `[position]`
    pub order: Vec<u32>,
    /// First position of each supernode. `[supernode + 1]`
    pub first: Vec<usize>,
    /// Start of each supernode's rows. `[supernode + 1]`
    pub row_ptr: Vec<usize>,
    /// Positions of the rows below the columns of each supernode, ascending. `[row_ptr]`
    pub rows: Vec<u32>,
    /// Parent of each supernode or [`ROOT`]. `[supernode]`
    pub parent: Vec<u32>,
}

/// Operations of the Cholesky elimination of `k` columns of a front of `m` rows: Σ (m − j)² multiplications and
/// additions. L U takes twice as many.
pub(super) fn flops(m: usize, k: usize) -> f64 {
    // Σ_{i = m−k+1}^{m} i².
    let sum = |n: f64| n * (n + 1.0) * (2.0 * n + 1.0) / 6.0;
    sum(m as f64) - sum((m - k) as f64)
}

/// Time of a front on one core, in units of 1e-11 s on a machine of 2020 (theory/linear-solver.md, eq. 3).
///
/// Multiplications run faster if more columns are eliminated together. Assembly passes over the Schur complement,
/// and each front has a fixed cost. Only ratios matter, and they control the merging of supernodes only.
fn cost(m: usize, k: usize) -> f64 {
    const RATE: f64 = 3.0; // per operation
    const HALF: f64 = 6.0; // columns at which half the rate is reached
    const PASS: f64 = 60.0; // per number of the front, for assembly
    const FRONT: f64 = 50_000.0; // per front
    let b = (m - k) as f64;
    FRONT + PASS * (b * b + (m * k) as f64) + RATE * (1.0 + HALF / k as f64) * flops(m, k)
}

impl Tree {
    /// Analyses a pattern whose groups are eliminated in this order, `[position] → group`, up to the change of
    /// order that makes it a postorder.
    #[expect(
        clippy::too_many_lines,
        reason = "the steps of the symbolic analysis in their order"
    )]
    pub fn new(pattern: &Pattern, graph: &Graph, order: &[u32]) -> Result<Self, LinearError> {
        let n = graph.len();
        if n == 0 {
            return Ok(Self {
                first: vec![0],
                row_ptr: vec![0],
                ..Self::default()
            });
        }
        let mut weights = vec![0u32; n]; // [vertex]
        for &g in pattern.group() {
            weights[g as usize] += 1;
        }
        let parent = elimination_tree(graph, order);
        let post = postorder(&parent, |_| 0.0);
        let order: Vec<u32> = post.iter().map(|&p| order[p as usize]).collect();
        let parent = renumber(&parent, &post);
        let weight: Vec<u32> = order.iter().map(|&v| weights[v as usize]).collect();
        let count = counts(graph, &order, &parent, &weight);
        let (of_column, mut supernodes) = fundamental(&parent, &count, &weight);
        amalgamate(&mut supernodes);

        // Merged supernodes, with the heaviest subtree first, so that the others reuse its stack.
        let find = |mut s: u32| {
            while supernodes[s as usize].merged {
                s = supernodes[s as usize].parent;
            }
            s
        };
        let alive: Vec<u32> = (0..supernodes.len() as u32)
            .filter(|&s| !supernodes[s as usize].merged)
            .collect();
        let mut index = vec![ROOT; supernodes.len()];
        for (i, &s) in alive.iter().enumerate() {
            index[s as usize] = i as u32;
        }
        let above = |s: u32| match supernodes[s as usize].parent {
            ROOT => ROOT,
            p => index[find(p) as usize],
        };
        let parent: Vec<u32> = alive.iter().map(|&s| above(s)).collect();
        let mut work: Vec<f64> = alive
            .iter()
            .map(|&s| flops(supernodes[s as usize].m, supernodes[s as usize].k))
            .collect();
        for s in 0..work.len() {
            if parent[s] != ROOT {
                work[parent[s] as usize] += work[s];
            }
        }
        let post = postorder(&parent, |s| work[s as usize]);
        let parent = renumber(&parent, &post);
        let mut place = vec![0u32; post.len()];
        for (new, &old) in post.iter().enumerate() {
            place[old as usize] = new as u32;
        }

        // Columns of each supernode keep their relative order. Columns of a merged child come first.
        let column_home: Vec<u32> = of_column
            .iter()
            .map(|&s| place[index[find(s) as usize] as usize])
            .collect();
        let mut columns: Vec<u32> = (0..n as u32).collect();
        columns.sort_by_key(|&c| column_home[c as usize]);
        let order: Vec<u32> = columns.iter().map(|&c| order[c as usize]).collect();
        let home: Vec<u32> = columns.iter().map(|&c| column_home[c as usize]).collect();
        Ok(Self::structure(
            pattern, graph, &order, &home, parent, &weights,
        ))
    }

    /// Rows of each supernode: those of its children and its own couplings, without its columns.
    fn structure(
        pattern: &Pattern,
        graph: &Graph,
        order: &[u32],
        home: &[u32],
        parent: Vec<u32>,
        weights: &[u32],
    ) -> Self {
        let n = graph.len();
        let mut position = vec![0u32; n]; // index of a vertex among vertices
        let mut start = vec![0usize; n + 1]; // first equation of each vertex index
        for (p, &v) in order.iter().enumerate() {
            position[v as usize] = p as u32;
            start[p + 1] = start[p] + weights[v as usize] as usize;
        }
        let supernodes = parent.len();
        let mut range = vec![0usize; supernodes + 1]; // range of vertex indices of each supernode
        for &s in home {
            range[s as usize + 1] += 1;
        }
        for s in 0..supernodes {
            range[s + 1] += range[s];
        }
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); supernodes];
        let mut mark = vec![ROOT; n];
        let (mut row_ptr, mut rows) = (vec![0], Vec::new());
        for s in 0..supernodes {
            // The children have already added their rows.
            let mut list = std::mem::take(&mut lists[s]);
            let end = range[s + 1];
            list.retain(|&p| {
                let fresh = p as usize >= end && mark[p as usize] != s as u32;
                mark[p as usize] = s as u32;
                fresh
            });
            for p in range[s]..end {
                for &v in graph.neighbours_of(order[p] as usize) {
                    let q = position[v as usize];
                    if q as usize >= end && mark[q as usize] != s as u32 {
                        mark[q as usize] = s as u32;
                        list.push(q);
                    }
                }
            }
            list.sort_unstable();
            for &p in &list {
                rows.extend((start[p as usize]..start[p as usize + 1]).map(|e| e as u32));
            }
            row_ptr.push(rows.len());
            if parent[s] != ROOT {
                lists[parent[s] as usize].append(&mut list);
            }
        }
        Self {
            order: expand(pattern, order),
            first: range.iter().map(|&p| start[p]).collect(),
            row_ptr,
            rows,
            parent,
        }
    }

    /// Number of supernodes.
    pub fn len(&self) -> usize {
        self.parent.len()
    }

    /// Number of columns eliminated in front `s`.
    pub fn columns(&self, s: usize) -> usize {
        self.first[s + 1] - self.first[s]
    }

    /// Positions of the rows of front `s` below its columns, ascending.
    pub fn below(&self, s: usize) -> &[u32] {
        &self.rows[self.row_ptr[s]..self.row_ptr[s + 1]]
    }

    /// Children of all supernodes, ascending: the start of each list `[supernode + 1]` and the lists.
    pub fn children(&self) -> (Vec<usize>, Vec<u32>) {
        let mut ptr = vec![0; self.len() + 1];
        for &p in self.parent.iter().filter(|&&p| p != ROOT) {
            ptr[p as usize + 1] += 1;
        }
        for s in 0..self.len() {
            ptr[s + 1] += ptr[s];
        }
        let mut cursor = ptr.clone();
        let mut list = vec![0; ptr[self.len()]];
        for (s, &p) in self.parent.iter().enumerate() {
            if p != ROOT {
                list[cursor[p as usize]] = s as u32;
                cursor[p as usize] += 1;
            }
        }
        (ptr, list)
    }

    /// Operations of front `s` for Cholesky.
    pub fn work(&self, s: usize) -> f64 {
        let k = self.columns(s);
        flops(k + self.below(s).len(), k)
    }
}

/// Parent of each position: the first later position that its elimination fills (Liu 1990).
fn elimination_tree(graph: &Graph, order: &[u32]) -> Vec<u32> {
    let n = order.len();
    let mut position = vec![0u32; n];
    for (p, &v) in order.iter().enumerate() {
        position[v as usize] = p as u32;
    }
    let (mut parent, mut ancestor) = (vec![ROOT; n], vec![ROOT; n]);
    for (i, &v) in order.iter().enumerate() {
        for &u in graph.neighbours_of(v as usize) {
            let mut j = position[u as usize];
            // Follow the path to the root of j's tree and compress it.
            while (j as usize) < i {
                let next = std::mem::replace(&mut ancestor[j as usize], i as u32);
                if next == ROOT {
                    parent[j as usize] = i as u32;
                    break;
                }
                if next as usize == i {
                    break;
                }
                j = next;
            }
        }
    }
    parent
}

/// Postorder of a forest, `[new] → old`. Children have descending weight, then ascending number.
fn postorder(parent: &[u32], weight: impl Fn(u32) -> f64) -> Vec<u32> {
    let n = parent.len();
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); n];
    let mut roots = Vec::new();
    for (s, &p) in parent.iter().enumerate() {
        let list = if p == ROOT {
            &mut roots
        } else {
            &mut children[p as usize]
        };
        list.push(s as u32);
    }
    let sort = |list: &mut Vec<u32>| list.sort_by(|&a, &b| weight(b).total_cmp(&weight(a)));
    sort(&mut roots);
    let mut post = Vec::with_capacity(n);
    let mut stack: Vec<(u32, bool)> = roots.iter().rev().map(|&r| (r, false)).collect();
    while let Some((s, done)) = stack.pop() {
        if done {
            post.push(s);
            continue;
        }
        stack.push((s, true));
        let mut list = std::mem::take(&mut children[s as usize]);
        sort(&mut list);
        stack.extend(list.iter().rev().map(|&c| (c, false)));
    }
    post
}

/// Parents in a new numbering, `[new] → old`.
fn renumber(parent: &[u32], post: &[u32]) -> Vec<u32> {
    let mut new = vec![0u32; post.len()];
    for (i, &old) in post.iter().enumerate() {
        new[old as usize] = i as u32;
    }
    let up = |&old: &u32| match parent[old as usize] {
        ROOT => ROOT,
        p => new[p as usize],
    };
    post.iter().map(up).collect()
}

/// Equations in each column of L, with its own. Row i fills the columns on the paths from its couplings up to i.
/// The time is proportional to the fill, the memory to the order.
fn counts(graph: &Graph, order: &[u32], parent: &[u32], weight: &[u32]) -> Vec<u64> {
    let n = order.len();
    let mut position = vec![0u32; n];
    for (p, &v) in order.iter().enumerate() {
        position[v as usize] = p as u32;
    }
    let mut count: Vec<u64> = weight.iter().map(|&w| u64::from(w)).collect();
    let mut mark = vec![ROOT; n];
    for (i, &v) in order.iter().enumerate() {
        mark[i] = i as u32;
        for &u in graph.neighbours_of(v as usize) {
            let mut j = position[u as usize] as usize;
            while j < i && mark[j] != i as u32 {
                mark[j] = i as u32;
                count[j] += u64::from(weight[i]);
                j = parent[j] as usize;
            }
        }
    }
    count
}

/// A supernode during merging.
#[derive(Clone, Copy, Debug)]
struct Supernode {
    k: usize, // columns
    m: usize, // rows of the front
    parent: u32,
    merged: bool, // with its parent
}

/// Fundamental supernodes: consecutive columns in postorder with the same structure below them.
fn fundamental(parent: &[u32], count: &[u64], weight: &[u32]) -> (Vec<u32>, Vec<Supernode>) {
    let mut supernodes: Vec<Supernode> = Vec::new();
    let mut of_column = Vec::with_capacity(parent.len());
    for j in 0..parent.len() {
        let extends = j > 0
            && parent[j - 1] as usize == j
            && count[j - 1] == count[j] + u64::from(weight[j - 1]);
        match supernodes.last_mut() {
            Some(last) if extends => last.k += weight[j] as usize,
            _ => supernodes.push(Supernode {
                k: weight[j] as usize,
                m: count[j] as usize,
                parent: ROOT,
                merged: false,
            }),
        }
        of_column.push(supernodes.len() as u32 - 1);
    }
    for (j, &s) in of_column.iter().enumerate() {
        // The last column of a supernode determines its parent.
        supernodes[s as usize].parent = match parent[j] {
            ROOT => ROOT,
            p => of_column[p as usize],
        };
    }
    (of_column, supernodes)
}

/// Merges children with parents where one larger front with explicit zeros is faster than two.
fn amalgamate(supernodes: &mut [Supernode]) {
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); supernodes.len()];
    for p in 0..supernodes.len() {
        let mut list = std::mem::take(&mut children[p]);
        // The child that shares most of its rows comes first.
        list.sort_by_key(|&c| std::cmp::Reverse(supernodes[c as usize].m));
        for c in list {
            let (child, parent) = (supernodes[c as usize], supernodes[p]);
            let (k, m) = (child.k + parent.k, child.k + parent.m);
            if cost(m, k) <= cost(child.m, child.k) + cost(parent.m, parent.k) {
                (supernodes[p].k, supernodes[p].m) = (k, m);
                supernodes[c as usize].merged = true;
            }
        }
        if supernodes[p].parent != ROOT {
            children[supernodes[p].parent as usize].push(p as u32);
        }
    }
}
