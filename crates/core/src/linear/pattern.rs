//! Pattern of a structurally symmetric sparse matrix.

use std::collections::HashMap;

use super::LinearError;

/// Pattern of a square, structurally symmetric matrix in compressed columns, with both triangles.
///
/// It may also contain the node of each equation and the coordinates of nodes. Equations of one node couple with
/// the same others, so ordering and symbolic analysis can use the graph of nodes, with nine times fewer entries for
/// three equations a node. Coordinates allow geometric dissection of the graph.
#[derive(Clone, Debug)]
pub struct Pattern {
    n: usize,
    col_ptr: Vec<usize>, // [column + 1]
    row_idx: Vec<u32>,   // [entry], ascending within a column
    group: Vec<u32>,     // [equation] → group
    n_groups: usize,
    coordinates: Vec<[f64; 3]>, // [group][xyz], or empty
}

impl Pattern {
    /// Makes a pattern of `n` columns from `col_ptr` `[n + 1]` and `row_idx` `[entry]`, with ascending rows in each
    /// column.
    ///
    /// Equations with equal column patterns form a group. For meshes see [`Pattern::with_nodes`].
    ///
    /// # Errors
    /// [`LinearError::Pattern`] if the pointers do not fit, rows are not strictly ascending or out of range, a
    /// diagonal entry is missing, or (i, j) exists without (j, i).
    pub fn new(n: usize, col_ptr: Vec<usize>, row_idx: Vec<u32>) -> Result<Self, LinearError> {
        check(n, &col_ptr, &row_idx)?;
        let mut seen: HashMap<&[u32], u32> = HashMap::new();
        let mut group = Vec::with_capacity(n);
        for j in 0..n {
            let next = seen.len() as u32;
            group.push(
                *seen
                    .entry(&row_idx[col_ptr[j]..col_ptr[j + 1]])
                    .or_insert(next),
            );
        }
        let n_groups = seen.len();
        Ok(Self {
            n,
            col_ptr,
            row_idx,
            group,
            n_groups,
            coordinates: Vec::new(),
        })
    }

    /// Sets the node of each equation and the coordinates of nodes.
    ///
    /// `node_of_equation` `[equation]`; `coordinates` `[node][xyz]`, in any unit of length, may be empty. A node
    /// without a position (the shared unknown of a level beam) has a NaN coordinate and comes last in geometric
    /// dissection. Equations of a node may differ in their couplings. Their union is used then, at the cost of some
    /// explicit zeros.
    ///
    /// # Errors
    /// [`LinearError::Pattern`] if the lengths do not fit.
    pub fn with_nodes(
        mut self,
        node_of_equation: &[u32],
        coordinates: &[[f64; 3]],
    ) -> Result<Self, LinearError> {
        let fault = |why: String| Err(LinearError::Pattern { why });
        if node_of_equation.len() != self.n {
            return fault(format!(
                "{} nodes for {} equations",
                node_of_equation.len(),
                self.n
            ));
        }
        let mut renumber: HashMap<u32, u32> = HashMap::new();
        self.coordinates.clear();
        for (j, &node) in node_of_equation.iter().enumerate() {
            let next = renumber.len() as u32;
            let group = *renumber.entry(node).or_insert(next);
            self.group[j] = group;
            if group == next && !coordinates.is_empty() {
                match coordinates.get(node as usize) {
                    Some(&x) => self.coordinates.push(x),
                    None => return fault(format!("node {node} has no coordinates")),
                }
            }
        }
        self.n_groups = renumber.len();
        Ok(self)
    }

    /// Number of equations.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Number of entries, both triangles.
    pub fn nnz(&self) -> usize {
        self.row_idx.len()
    }

    /// Start of each column in [`Pattern::row_idx`]. `[column + 1]`
    pub fn col_ptr(&self) -> &[usize] {
        &self.col_ptr
    }

    /// Row of each entry, ascending in each column. `[entry]`
    pub fn row_idx(&self) -> &[u32] {
        &self.row_idx
    }

    /// Group (node) of each equation, `0..n_groups`. `[equation]`
    pub fn group(&self) -> &[u32] {
        &self.group
    }

    /// Number of groups of equations, each ordered as a whole.
    pub fn n_groups(&self) -> usize {
        self.n_groups
    }

    /// Coordinates of the groups `[group][xyz]`, if they are known.
    pub fn coordinates(&self) -> Option<&[[f64; 3]]> {
        (self.n_groups > 0 && self.coordinates.len() == self.n_groups)
            .then_some(self.coordinates.as_slice())
    }

    /// Whether both patterns are equal to the last bit, coordinates included.
    pub fn is_same(&self, other: &Self) -> bool {
        let bits = |x: &[f64; 3]| x.map(f64::to_bits);
        let places = self.coordinates.iter().map(bits);
        self.n == other.n
            && self.col_ptr == other.col_ptr
            && self.row_idx == other.row_idx
            && self.group == other.group
            && places.eq(other.coordinates.iter().map(bits))
    }

    /// Index of entry (row, column) among the values, if the pattern contains it.
    pub fn find(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.col_ptr[column]..self.col_ptr[column + 1];
        let rows = &self.row_idx[range.clone()];
        rows.binary_search(&u32::try_from(row).ok()?)
            .ok()
            .map(|k| range.start + k)
    }
}

fn check(n: usize, col_ptr: &[usize], row_idx: &[u32]) -> Result<(), LinearError> {
    let fault = |why: String| Err(LinearError::Pattern { why });
    if n >= i32::MAX as usize {
        return fault(format!("{n} equations are too many for 32-bit indices"));
    }
    if col_ptr.len() != n + 1 || col_ptr[0] != 0 || col_ptr[n] != row_idx.len() {
        return fault("the column pointers do not span the rows".into());
    }
    if let Some(j) = (0..n).find(|&j| col_ptr[j] > col_ptr[j + 1]) {
        return fault(format!("the column pointer falls after column {j}"));
    }
    // One sweep checks symmetry. In the order of columns, the rows below the diagonal of column i must appear as
    // columns j in the same order as the entries (i, j) above the diagonal.
    let mut cursor = vec![0usize; n];
    for j in 0..n {
        let rows = &row_idx[col_ptr[j]..col_ptr[j + 1]];
        if rows.windows(2).any(|w| w[0] >= w[1]) || rows.last().is_some_and(|&r| r as usize >= n) {
            return fault(format!("rows of column {j} are not ascending below {n}"));
        }
        let Ok(diagonal) = rows.binary_search(&(j as u32)) else {
            return fault(format!("column {j} has no diagonal entry"));
        };
        // After the diagonal: the first row below it must be the first column with an entry in row j.
        cursor[j] = col_ptr[j] + diagonal + 1;
        for &i in &rows[..diagonal] {
            let i = i as usize;
            if cursor[i] >= col_ptr[i + 1] || row_idx[cursor[i]] as usize != j {
                return fault(format!(
                    "entry ({i}, {j}) has no mirror, or ({j}, {i}) before it"
                ));
            }
            cursor[i] += 1;
        }
    }
    match (0..n).find(|&j| cursor[j] != col_ptr[j + 1]) {
        Some(j) => fault(format!("entry ({}, {j}) has no mirror", row_idx[cursor[j]])),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_symmetric_pattern_is_accepted_and_grouped() {
        // Equations 0 and 1 couple to everything, 2 and 3 not to each other.
        let p = Pattern::new(
            4,
            vec![0, 4, 8, 11, 14],
            vec![0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 0, 1, 3],
        )
        .unwrap();
        assert_eq!(p.group(), [0, 0, 1, 2]);
        assert_eq!(p.find(3, 1), Some(7));
        assert_eq!(p.find(3, 2), None);
    }

    #[test]
    fn an_unsymmetric_pattern_is_rejected() {
        for (col_ptr, row_idx) in [
            (vec![0, 2, 3], vec![0, 1, 1]),    // (1, 0) without (0, 1)
            (vec![0, 1, 3], vec![0, 0, 1]),    // (0, 1) without (1, 0)
            (vec![0, 1, 2], vec![0, 0]),       // no diagonal
            (vec![0, 2, 4], vec![1, 0, 0, 1]), // descending
            (vec![0, 1, 2], vec![0, 2]),       // out of range
            (vec![0, 1], vec![0]),             // too few pointers
        ] {
            assert!(Pattern::new(2, col_ptr, row_idx).is_err());
        }
        // 3 × 3: (0, 2) and (1, 0) have no mirror entries. The numbers of entries on both sides are equal.
        assert!(Pattern::new(3, vec![0, 2, 3, 5], vec![0, 1, 1, 0, 2]).is_err());
    }

    #[test]
    fn nodes_need_one_entry_an_equation_and_known_coordinates() {
        let p = Pattern::new(2, vec![0, 1, 2], vec![0, 1]).unwrap();
        assert!(p.clone().with_nodes(&[0], &[]).is_err());
        assert!(p.clone().with_nodes(&[0, 7], &[[0.0; 3]]).is_err());
        let p = p
            .with_nodes(&[3, 3], &[[0.0; 3], [0.0; 3], [0.0; 3], [1.0, 2.0, 3.0]])
            .unwrap();
        assert_eq!(p.n_groups(), 1);
        assert_eq!(p.coordinates(), Some(&[[1.0, 2.0, 3.0]][..]));
    }
}
