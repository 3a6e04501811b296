//! Supernodal sparse Cholesky of faer with an ordering of our own.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use super::{LinearError, Pattern};

/// L Lᵀ of the lower triangle. It is serial: faer's sparse `Par` only threads the dense kernels within a serial
/// loop, which is slower.
pub(super) struct FaerLlt {
    col_ptr: Vec<u32>,
    symbolic: SymbolicCholesky<u32>,
    order: Vec<u32>, // [position] → equation
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl FaerLlt {
    /// Symbolic factorisation in the given order, `[position] → equation`.
    pub fn analyse(pattern: &Pattern, order: Vec<u32>) -> Result<Self, LinearError> {
        let n = pattern.n();
        let too_large = |_| LinearError::TooLarge;
        let col_ptr = pattern
            .col_ptr()
            .iter()
            .map(|&p| u32::try_from(p))
            .collect::<Result<Vec<_>, _>>()
            .map_err(too_large)?;
        let mut inverse = vec![0u32; n];
        for (p, &j) in order.iter().enumerate() {
            inverse[j as usize] = p as u32;
        }
        let symbolic = factorize_symbolic_cholesky(
            SymbolicSparseColMatRef::new_checked(n, n, &col_ptr, None, pattern.row_idx()),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&order, &inverse, n)),
            faer::sparse::linalg::cholesky::CholeskySymbolicParams::default(),
        )
        .map_err(|_| LinearError::TooLarge)?;
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::TooLarge)?;
        let factor = vec![0.0; symbolic.len_val()];
        Ok(Self {
            col_ptr,
            symbolic,
            order,
            factor,
            memory,
        })
    }

    /// Numbers in the factor.
    pub fn factor_nnz(&self) -> usize {
        self.factor.len()
    }

    /// Multiplications and additions: the sum over columns of their squared counts.
    pub fn flops(&self) -> f64 {
        let square = |rows: usize| (rows as f64).powi(2);
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(s) => s
                .col_ptr()
                .windows(2)
                .map(|w| square((w[1] - w[0]) as usize))
                .sum(),
            SymbolicCholeskyRaw::Supernodal(s) => (0..s.n_supernodes())
                .map(|k| {
                    let columns = (s.supernode_end()[k] - s.supernode_begin()[k]) as usize;
                    let below =
                        (s.col_ptr_for_row_idx()[k + 1] - s.col_ptr_for_row_idx()[k]) as usize;
                    (1..=columns).map(|c| square(c + below)).sum::<f64>()
                })
                .sum(),
        }
    }

    /// Factorises `values`, in the order of the pattern.
    pub fn factorise(&mut self, pattern: &Pattern, values: &[f64]) -> Result<(), LinearError> {
        let n = pattern.n();
        let symbolic =
            SymbolicSparseColMatRef::new_checked(n, n, &self.col_ptr, None, pattern.row_idx());
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                SparseColMatRef::new(symbolic, values),
                Side::Lower,
                faer::linalg::cholesky::llt::factor::LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Spec::default(),
            )
            .map(|_| ())
            .map_err(|LltError::NonPositivePivot { index }| {
                // The index of faer belongs to the permuted matrix.
                let equation = self.order.get(index).map_or(0, |&j| j as usize);
                LinearError::NotPositiveDefinite { equation }
            })
    }

    /// x ← A⁻¹ x for the columns of `x`, `[column][equation]`.
    pub fn solve(&self, x: &mut [f64], columns: usize) -> Result<(), LinearError> {
        let scratch = self
            .symbolic
            .solve_in_place_scratch::<f64>(columns, Par::Seq);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::TooLarge)?;
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, self.order.len(), columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }
}

// Written by hand, because faer's buffer has no Debug.
impl std::fmt::Debug for FaerLlt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FaerLlt").finish_non_exhaustive()
    }
}
