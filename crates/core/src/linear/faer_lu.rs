//! Sparse L U of faer: column ordering (COLAMD) and row pivoting over the whole column.
//!
//! It is ten times slower on structurally symmetric matrices than elimination on their own graph, but can pivot
//! anywhere. It serves where pivots within a front do not suffice.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Spec};

use super::{LinearError, Pattern};

/// P A Q = L U. The ordering is COLAMD of faer, which cannot be replaced.
pub(super) struct FaerLu {
    col_ptr: Vec<u32>,
    symbolic: SymbolicLu<u32>,
    numeric: NumericLu<u32, f64>,
    memory: MemBuffer,
}

impl FaerLu {
    /// Symbolic factorisation.
    pub fn analyse(pattern: &Pattern) -> Result<Self, LinearError> {
        let n = pattern.n();
        let col_ptr = pattern
            .col_ptr()
            .iter()
            .map(|&p| u32::try_from(p))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|_| LinearError::TooLarge)?;
        let symbolic = factorize_symbolic_lu(
            SymbolicSparseColMatRef::new_checked(n, n, &col_ptr, None, pattern.row_idx()),
            LuSymbolicParams::default(),
        )
        .map_err(|_| LinearError::TooLarge)?;
        let scratch = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Spec::default());
        let memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::TooLarge)?;
        Ok(Self {
            col_ptr,
            symbolic,
            numeric: NumericLu::new(),
            memory,
        })
    }

    /// Factorises `values`, in the order of the pattern.
    ///
    /// faer divides by a zero pivot without an error, so the caller has to check the result.
    pub fn factorise(&mut self, pattern: &Pattern, values: &[f64]) -> Result<(), LinearError> {
        let n = pattern.n();
        let symbolic =
            SymbolicSparseColMatRef::new_checked(n, n, &self.col_ptr, None, pattern.row_idx());
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                SparseColMatRef::new(symbolic, values),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Spec::default(),
            )
            .map(|_| ())
            .map_err(|error| match error {
                LuError::SymbolicSingular { index } => {
                    let order = self.symbolic.col_perm().arrays().0;
                    LinearError::Singular {
                        equation: order.get(index).map_or(0, |&j| j as usize),
                    }
                }
                LuError::Generic(_) => LinearError::TooLarge,
            })
    }

    /// x ← A⁻¹ x for the columns of `x`, `[column][equation]`.
    pub fn solve(&self, x: &mut [f64], columns: usize) -> Result<(), LinearError> {
        let scratch = self
            .symbolic
            .solve_in_place_scratch::<f64>(columns, Par::Seq);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::TooLarge)?;
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, self.symbolic.nrows(), columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }
}

// Written by hand, because faer's buffer has no Debug.
impl std::fmt::Debug for FaerLu {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FaerLu").finish_non_exhaustive()
    }
}
