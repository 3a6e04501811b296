//! Fill-reducing orderings on the node graph.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use super::{LinearError, Pattern, dissection};

/// Order of elimination of the equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ordering {
    /// Order of their numbers.
    Natural,
    /// Approximate minimum degree on the node graph.
    Amd,
    /// Geometric nested dissection if the pattern has coordinates, else minimum degree.
    #[default]
    Dissection,
}

/// Graph of coupled groups (nodes) of equations: sorted neighbours, without loops.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    pub ptr: Vec<u32>,        // [vertex + 1]
    pub neighbours: Vec<u32>, // [edge], ascending within a vertex
}

impl Graph {
    /// Graph of the groups of a pattern.
    pub fn of(pattern: &Pattern) -> Result<Self, LinearError> {
        let (n, groups) = (pattern.n(), pattern.n_groups());
        // Equations of each group, in order.
        let mut start = vec![0usize; groups + 1];
        for &g in pattern.group() {
            start[g as usize + 1] += 1;
        }
        for g in 0..groups {
            start[g + 1] += start[g];
        }
        let mut members = vec![0u32; n];
        let mut cursor = start.clone();
        for (j, &g) in pattern.group().iter().enumerate() {
            members[cursor[g as usize]] = j as u32;
            cursor[g as usize] += 1;
        }

        let mut ptr = Vec::with_capacity(groups + 1);
        ptr.push(0);
        let mut neighbours: Vec<u32> = Vec::new();
        let mut mark = vec![u32::MAX; groups];
        for g in 0..groups {
            mark[g] = g as u32;
            let first = neighbours.len();
            for &j in &members[start[g]..start[g + 1]] {
                let j = j as usize;
                for &i in &pattern.row_idx()[pattern.col_ptr()[j]..pattern.col_ptr()[j + 1]] {
                    let h = pattern.group()[i as usize];
                    if mark[h as usize] != g as u32 {
                        mark[h as usize] = g as u32;
                        neighbours.push(h);
                    }
                }
            }
            neighbours[first..].sort_unstable();
            ptr.push(u32::try_from(neighbours.len()).map_err(|_| LinearError::TooLarge)?);
        }
        Ok(Self { ptr, neighbours })
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.ptr.len() - 1
    }

    /// Vertices coupled with vertex `v`, ascending.
    pub fn neighbours_of(&self, v: usize) -> &[u32] {
        &self.neighbours[self.ptr[v] as usize..self.ptr[v + 1] as usize]
    }

    /// Order by approximate minimum degree: `[position] → vertex`.
    ///
    /// # Errors
    /// [`LinearError::TooLarge`] if memory or 32-bit indices run out.
    pub fn amd(&self) -> Result<Vec<u32>, LinearError> {
        let n = self.len();
        let (mut order, mut inverse) = (vec![0u32; n], vec![0u32; n]);
        if self.neighbours.is_empty() {
            return Ok((0..n as u32).collect());
        }
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.ptr, None, &self.neighbours);
        let scratch = amd::order_scratch::<u32>(n, self.neighbours.len());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::TooLarge)?;
        amd::order(
            &mut order,
            &mut inverse,
            pattern,
            amd::Control::default(),
            MemStack::new(&mut memory),
        )
        .map_err(|_| LinearError::TooLarge)?;
        Ok(order)
    }
}

/// Orders the groups of a pattern: `[position] → group`.
pub(super) fn order(
    pattern: &Pattern,
    graph: &Graph,
    ordering: Ordering,
) -> Result<Vec<u32>, LinearError> {
    match ordering {
        Ordering::Natural => Ok((0..pattern.n_groups() as u32).collect()),
        Ordering::Amd => graph.amd(),
        Ordering::Dissection => match pattern.coordinates() {
            Some(places) => dissection::dissect(graph, places),
            None => graph.amd(),
        },
    }
}

/// Expands an order of groups into one of equations: `[position] → equation`.
pub(super) fn expand(pattern: &Pattern, order: &[u32]) -> Vec<u32> {
    let mut position = vec![0u32; order.len()];
    for (p, &g) in order.iter().enumerate() {
        position[g as usize] = p as u32;
    }
    let mut equations: Vec<u32> = (0..pattern.n() as u32).collect();
    // The sort is stable, so equations of a node keep their order.
    equations.sort_by_key(|&j| position[pattern.group()[j as usize] as usize]);
    equations
}
