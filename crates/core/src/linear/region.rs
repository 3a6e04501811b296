//! Solution for some equations of a matrix, with the unknowns of all others fixed (theory/linear-solver.md, eq. 7).

use super::{Backend, LinearError, LinearSolver, Options, Pattern};

/// Some equations of a symmetric positive definite matrix, and their solver.
#[derive(Debug)]
pub struct Region {
    equations: Vec<u32>,
    /// Index of each of its entries among those of the whole matrix.
    entries: Vec<usize>,
    values: Vec<f64>,
    solver: LinearSolver,
}

impl Region {
    /// Selects the equations of the groups of `pattern` that are `inside` `[group]`.
    ///
    /// # Errors
    /// [`LinearError`] of the analysis.
    pub fn new(pattern: &Pattern, inside: &[bool]) -> Result<Self, LinearError> {
        let group = pattern.group();
        let equations: Vec<u32> = (0..pattern.n() as u32)
            .filter(|&e| inside[group[e as usize] as usize])
            .collect();
        let mut place = vec![u32::MAX; pattern.n()];
        for (i, &e) in equations.iter().enumerate() {
            place[e as usize] = i as u32;
        }
        let (mut col_ptr, mut row_idx, mut entries) = (vec![0], Vec::new(), Vec::new());
        let mut node = Vec::with_capacity(equations.len());
        for &e in &equations {
            let column = pattern.col_ptr()[e as usize]..pattern.col_ptr()[e as usize + 1];
            for k in column {
                let row = place[pattern.row_idx()[k] as usize];
                if row != u32::MAX {
                    row_idx.push(row);
                    entries.push(k);
                }
            }
            col_ptr.push(row_idx.len());
            node.push(group[e as usize]);
        }
        let own = Pattern::new(equations.len(), col_ptr, row_idx)?;
        let own = own.with_nodes(&node, pattern.coordinates().unwrap_or_default())?;
        let solver = LinearSolver::analyse(&own, Options::new(Backend::MultifrontalLlt))?;
        Ok(Self {
            values: vec![0.0; entries.len()],
            equations,
            entries,
            solver,
        })
    }

    /// Equations of the region, ascending.
    pub fn equations(&self) -> &[u32] {
        &self.equations
    }

    /// Scalar product of `own` `[own equation]` with the part in the region of `of`, a vector over all equations.
    pub fn dot(&self, own: &[f64], of: &[f64]) -> f64 {
        let both = own.iter().zip(&self.equations);
        both.map(|(x, &e)| x * of[e as usize]).sum()
    }

    /// Square |v_Ω|² of the part in the region of a vector over all equations.
    pub fn square(&self, of: &[f64]) -> f64 {
        let own = self.equations.iter().map(|&e| of[e as usize]);
        own.map(|x| x * x).sum()
    }

    /// Direction −K_ΩΩ⁻¹ r_Ω, from `values` `[entry]` and `residual` `[equation]` of the whole matrix. `[own
    /// equation]`
    ///
    /// # Errors
    /// Those of [`LinearSolver::factorise`] and [`LinearSolver::solve`].
    pub fn direction(&mut self, values: &[f64], residual: &[f64]) -> Result<Vec<f64>, LinearError> {
        for (own, &k) in self.values.iter_mut().zip(&self.entries) {
            *own = values[k];
        }
        self.solver.factorise(&self.values)?;
        let own = self.equations.iter();
        let mut d: Vec<f64> = own.map(|&e| -residual[e as usize]).collect();
        self.solver.solve(&mut d)?;
        Ok(d)
    }
}

impl Pattern {
    /// Whether the group has coordinates. A beam has none, and it couples many nodes.
    fn is_placed(&self, group: u32) -> bool {
        let places = self.coordinates();
        places.is_none_or(|x| x[group as usize].iter().all(|x| x.is_finite()))
    }

    /// Groups that contain the part `share` of the sum of squares of `vector` `[equation]`, the largest first. None
    /// if they are more than `most`, or if one of them has no coordinates.
    pub fn concentrated(&self, vector: &[f64], share: f64, most: usize) -> Option<Vec<u32>> {
        let mut squares = vec![0.0; self.n_groups()];
        for (x, &g) in vector.iter().zip(self.group()) {
            squares[g as usize] += x * x;
        }
        let enough = share * squares.iter().sum::<f64>();
        let by_size = |a: &u32, b: &u32| {
            let (of_a, of_b) = (squares[*a as usize], squares[*b as usize]);
            of_b.total_cmp(&of_a).then(a.cmp(b))
        };
        let mut groups: Vec<u32> = (0..self.n_groups() as u32).collect();
        if most < groups.len() {
            groups.select_nth_unstable_by(most, by_size);
            groups.truncate(most);
        }
        groups.sort_unstable_by(by_size);
        let mut sum = 0.0;
        let last = groups.iter().position(|&g| {
            sum += squares[g as usize];
            sum >= enough
        })?;
        groups.truncate(last + 1);
        groups.iter().all(|&g| self.is_placed(g)).then_some(groups)
    }

    /// The groups and their neighbours over the given number of rings. `[group]` Groups without coordinates are
    /// left out. None if there are more than `most`.
    pub fn around(&self, groups: Vec<u32>, rings: usize, most: usize) -> Option<Vec<bool>> {
        let mut first = vec![u32::MAX; self.n_groups()];
        for (e, &g) in self.group().iter().enumerate() {
            first[g as usize] = first[g as usize].min(e as u32);
        }
        let mut inside = vec![false; self.n_groups()];
        for &g in &groups {
            inside[g as usize] = true;
        }
        let (mut count, mut rim) = (groups.len(), groups);
        for _ in 0..rings {
            let mut next = Vec::new();
            for &g in &rim {
                let e = first[g as usize] as usize;
                for &row in &self.row_idx()[self.col_ptr()[e]..self.col_ptr()[e + 1]] {
                    let other = self.group()[row as usize];
                    if !inside[other as usize] && self.is_placed(other) {
                        inside[other as usize] = true;
                        next.push(other);
                    }
                }
            }
            count += next.len();
            if count > most {
                return None;
            }
            rim = next;
        }
        Some(inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of `n` nodes with one equation each.
    fn chain(n: usize) -> Pattern {
        let rows = |j: usize| j.saturating_sub(1)..(j + 2).min(n);
        let (mut col_ptr, mut row_idx) = (vec![0], Vec::new());
        for j in 0..n {
            row_idx.extend(rows(j).map(|i| i as u32));
            col_ptr.push(row_idx.len());
        }
        let nodes: Vec<u32> = (0..n as u32).collect();
        let mut places: Vec<[f64; 3]> = (0..n).map(|i| [i as f64, 0.0, 0.0]).collect();
        places[n - 1] = [f64::NAN; 3]; // a beam
        let pattern = Pattern::new(n, col_ptr, row_idx).unwrap();
        pattern.with_nodes(&nodes, &places).unwrap()
    }

    #[test]
    fn local_residuals_are_located() {
        let pattern = chain(10);
        let mut r = [0.1; 10];
        (r[4], r[5]) = (-3.0, 2.0);
        assert_eq!(pattern.concentrated(&r, 0.9, 2), Some(vec![4, 5]));
        assert_eq!(pattern.concentrated(&r, 0.5, 2), Some(vec![4]));
        assert_eq!(pattern.concentrated(&r, 0.9, 1), None); // too many
        assert_eq!(pattern.concentrated(&[1.0; 10], 0.9, 5), None); // everywhere
        r[9] = 9.0;
        assert_eq!(pattern.concentrated(&r, 0.9, 5), None); // at a beam
    }

    #[test]
    fn regions_grow_along_couplings_without_nodes_that_have_no_place() {
        let pattern = chain(10);
        let inside = |groups: &[u32], rings, most| {
            let inside = pattern.around(groups.to_vec(), rings, most)?;
            Some((0..10).filter(|&g| inside[g]).collect::<Vec<_>>())
        };
        assert_eq!(inside(&[4], 2, 10), Some(vec![2, 3, 4, 5, 6]));
        assert_eq!(inside(&[8], 3, 10), Some(vec![5, 6, 7, 8]));
        assert_eq!(inside(&[4], 2, 4), None);
    }

    #[test]
    fn a_region_is_solved_with_the_rest_fixed() {
        let pattern = chain(6);
        // 2 on the diagonal, −1 beside it.
        let values: Vec<f64> = (0..6)
            .flat_map(|j: usize| {
                let rows = pattern.row_idx()[pattern.col_ptr()[j]..pattern.col_ptr()[j + 1]].iter();
                rows.map(move |&i| if i as usize == j { 2.0 } else { -1.0 })
            })
            .collect();
        let inside = [false, false, true, true, false, false];
        let mut region = Region::new(&pattern, &inside).unwrap();
        assert_eq!(region.equations(), [2, 3]);
        let r = [9.0, 9.0, 3.0, -6.0, 9.0, 9.0];
        assert_eq!(region.square(&r), 45.0);
        assert_eq!(region.dot(&[1.0, 2.0], &r), -9.0);
        // [2 −1; −1 2] d = [−3, 6]
        let d = region.direction(&values, &r).unwrap();
        assert!((d[0]).abs() < 1e-14 && (d[1] - 3.0).abs() < 1e-14, "{d:?}"); // rounding
    }
}
