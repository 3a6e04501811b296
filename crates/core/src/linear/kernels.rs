//! Dense elimination of the leading k of m rows and columns of a front.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{
    LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch,
};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_unit_lower_triangular_in_place,
    solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

use super::number::Number;
use super::schur::Panels;
use super::tree::flops;
use super::{Kind, LinearError, tiles};

/// Columns that a Cholesky front of many columns eliminates before it updates the others by matrix products.
const BLOCK: usize = 64;
/// Columns that a large front eliminates at once.
fn block(k: usize) -> usize {
    if k > 256 { 64 } else { 16 }
}
/// Operations from which a front is divided into pieces that may run in parallel.
const LARGE: f64 = 1e7;
/// Largest number of rows or columns of such a piece: an eighth of all, at least 96.
fn piece(all: usize) -> usize {
    (all / 8).max(96)
}

/// Working memory of the dense kernels.
pub(super) struct Scratch<T> {
    memory: MemBuffer,
    inverse: Vec<u32>,
    column: Vec<T>,
}

impl<T: Number> Scratch<T> {
    /// Allocates memory for fronts that eliminate at most `k` columns.
    pub fn new(k: usize) -> Result<Self, LinearError> {
        let need =
            cholesky_in_place_scratch::<T>(k, Par::Seq, Spec::default()).or(lu_in_place_scratch::<
                u32,
                T,
            >(
                k,
                k,
                Par::Seq,
                Spec::default(),
            ));
        Ok(Self {
            memory: MemBuffer::try_new(need).map_err(|_| LinearError::TooLarge)?,
            inverse: vec![0; k],
            column: vec![T::ZERO; k],
        })
    }

    /// Moves `x[pivots[i]]` to `x[i]`.
    pub fn exchange(&mut self, x: &mut [T], pivots: &[u32]) {
        let moved = &mut self.column[..x.len()];
        moved.copy_from_slice(x);
        for (to, &from) in x.iter_mut().zip(pivots) {
            *to = moved[from as usize];
        }
    }
}

// Written by hand, because faer's buffer has no Debug.
impl<T> std::fmt::Debug for Scratch<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Scratch").finish_non_exhaustive()
    }
}

/// Splits a front's columns (m × k, by columns) into the block of its own rows and the rows below.
fn split<T: Number>(columns: &mut [T], m: usize, k: usize) -> (MatMut<'_, T>, MatMut<'_, T>) {
    MatMut::from_column_major_slice_mut(columns, m, k).split_at_row_mut(k)
}

/// The same for reading.
pub(super) fn parts<T: Number>(
    columns: &[T],
    m: usize,
    k: usize,
) -> (MatRef<'_, T>, MatRef<'_, T>) {
    MatRef::from_column_major_slice(columns, m, k).split_at_row(k)
}

/// Layout of the Schur complement of a front. For L Lᵀ it is the lower triangle in panels. In large fronts panels
/// are wide and each is one product. The triangle above the diagonal of such a panel is computed in vain, but one
/// product is faster than two halves.
pub(super) fn panels(kind: Kind, m: usize, k: usize) -> Panels {
    let order = m - k;
    let wide = match kind {
        Kind::Unsymmetric => order.max(1),
        Kind::Symmetric if is_large(m, k) => (order / 16).max(48),
        Kind::Symmetric => 16,
    };
    Panels { order, wide }
}

/// L₁₁ L₁₁ᵀ = F₁₁ and L₂₁ = F₂₁ L₁₁⁻ᵀ in place of `columns` (m × k), and the lower triangle of S = −L₂₁ L₂₁ᵀ in
/// `schur`. The error is the column whose pivot is not positive.
pub(super) fn llt<T: Number>(
    columns: &mut [T],
    m: usize,
    k: usize,
    schur: &mut [T],
    scratch: &mut Scratch<T>,
) -> Result<(), usize> {
    let panels = panels(Kind::Symmetric, m, k);
    if is_large(m, k) {
        eliminate_in_pieces(columns, m, k, scratch)?;
    } else {
        for j in (0..k).step_by(BLOCK) {
            if j > 0 {
                update(columns, m, j, BLOCK.min(k - j));
            }
            tiles::eliminate(columns, m, j, k.min(j + BLOCK))?;
        }
    }
    if m == k {
        return Ok(());
    }
    if !is_large(m, k) {
        tiles::schur(columns, m, panels, schur);
        return Ok(());
    }
    let (_, below) = parts(columns, m, k);
    let panels: Vec<_> = panels.split(schur).collect();
    panels.into_par_iter().for_each(|(j, panel)| {
        let height = m - k - j;
        let width = panel.len() / height;
        matmul(
            MatMut::from_column_major_slice_mut(panel, height, width),
            Accum::Replace,
            below.subrows(j, height),
            below.subrows(j, width).transpose(),
            -T::ONE,
            Par::Seq,
        );
    });
    Ok(())
}

/// Subtracts the contribution of the columns before j from columns j.., from row j downwards.
fn update<T: Number>(columns: &mut [T], m: usize, j: usize, width: usize) {
    let (done, rest) = columns.split_at_mut(j * m);
    let done = MatRef::from_column_major_slice(done, m, j).subrows(j, m - j);
    let block = MatMut::from_column_major_slice_mut(&mut rest[..width * m], m, width);
    let across = done.subrows(0, width).transpose();
    let rows = block.subrows_mut(j, m - j);
    matmul(rows, Accum::Add, done, across, -T::ONE, Par::Seq);
}

/// Eliminates the columns of a large front, divided into pieces of rows that may run in parallel.
fn eliminate_in_pieces<T: Number>(
    columns: &mut [T],
    m: usize,
    k: usize,
    scratch: &mut Scratch<T>,
) -> Result<(), usize> {
    // Left-looking: block j first takes all updates from the columns before it by one product.
    for j in (0..k).step_by(block(k)) {
        let width = block(k).min(k - j);
        let (done, rest) = columns.split_at_mut(j * m);
        let done = MatRef::from_column_major_slice(done, m, j);
        let (_, block) = MatMut::from_column_major_slice_mut(&mut rest[..width * m], m, width)
            .split_at_row_mut(j);
        let (mut own, below) = block.split_at_row_mut(width);
        let across = done.subrows(j, width).transpose();
        let update = |rows: MatMut<'_, T>, first: usize| {
            if j > 0 {
                let done = done.subrows(first, rows.nrows());
                matmul(rows, Accum::Add, done, across, -T::ONE, Par::Seq);
            }
        };
        update(own.rb_mut(), j);
        cholesky_in_place(
            own.rb_mut(),
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut scratch.memory),
            Spec::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| j + index)?;
        let own = own.rb();
        in_rows(piece(m - j), below, j + width, &|mut rows, first| {
            update(rows.rb_mut(), first);
            solve_lower_triangular_in_place(own, rows.transpose_mut(), Par::Seq);
        });
    }
    Ok(())
}

/// Whether a front is divided into pieces. It depends on the size of the front alone, so the number of threads
/// changes no bit.
fn is_large(m: usize, k: usize) -> bool {
    flops(m, k) > LARGE
}

/// Calls `work` with the rows of `x` and the index of the first one, in pieces of at most `most` rows.
fn in_rows<T: Number, F>(most: usize, x: MatMut<'_, T>, first: usize, work: &F)
where
    F: Fn(MatMut<'_, T>, usize) + Sync,
{
    let rows = x.nrows();
    if rows <= most {
        if rows > 0 {
            work(x, first);
        }
        return;
    }
    let (a, b) = x.split_at_row_mut(rows / 2);
    rayon::join(
        || in_rows(most, a, first, work),
        || in_rows(most, b, first + rows / 2, work),
    );
}

/// P F₁₁ = L₁₁ U₁₁ and L₂₁ = F₂₁ U₁₁⁻¹ in place of `columns` (m × k), U₁₂ = L₁₁⁻¹ P F₁₂ in place of `rest` (k × (m
/// − k)), and S = −L₂₁ U₁₂ in `schur`. Row `pivots[i]` became row i.
///
/// The caller must check for vanishing pivots: their columns then contain numbers that are not finite.
#[expect(
    clippy::too_many_arguments,
    reason = "a dense kernel: sizes, strides and slices"
)]
pub(super) fn lu<T: Number>(
    columns: &mut [T],
    rest: &mut [T],
    m: usize,
    k: usize,
    schur: &mut [T],
    pivots: &mut [u32],
    scratch: &mut Scratch<T>,
) {
    let b = m - k;
    let (mut own, mut below) = split(columns, m, k);
    lu_in_place(
        own.rb_mut(),
        pivots,
        &mut scratch.inverse[..k],
        Par::Seq,
        MemStack::new(&mut scratch.memory),
        Spec::default(),
    );
    if b == 0 {
        return;
    }
    let large = is_large(m, k);
    let own = own.rb();
    // L₂₁ U₁₁ = F₂₁, transposed.
    let most = if large { piece(b) } else { b };
    in_rows(most, below.rb_mut(), 0, &|rows, _| {
        solve_lower_triangular_in_place(own.transpose(), rows.transpose_mut(), Par::Seq);
    });
    for column in rest.chunks_exact_mut(k) {
        scratch.exchange(column, pivots);
    }
    let rest = MatMut::from_column_major_slice_mut(rest, k, b);
    let schur = MatMut::from_column_major_slice_mut(schur, b, b);
    let below = below.rb();
    in_columns(most, rest, schur, &|mut rest, schur| {
        solve_unit_lower_triangular_in_place(own, rest.rb_mut(), Par::Seq);
        matmul(schur, Accum::Replace, below, rest.rb(), -T::ONE, Par::Seq);
    });
}

/// Calls `work` with the columns of `x` and those of `y`, in pieces of at most `most` columns.
fn in_columns<T: Number, F>(most: usize, x: MatMut<'_, T>, y: MatMut<'_, T>, work: &F)
where
    F: Fn(MatMut<'_, T>, MatMut<'_, T>) + Sync,
{
    let columns = x.ncols();
    if columns <= most {
        return work(x, y);
    }
    let (x, x_after) = x.split_at_col_mut(columns / 2);
    let (y, y_after) = y.split_at_col_mut(columns / 2);
    rayon::join(
        || in_columns(most, x, y, work),
        || in_columns(most, x_after, y_after, work),
    );
}

/// Forward elimination of one front: x₁ ← L₁₁⁻¹ x₁, x₂ ← x₂ − L₂₁ x₁. For L U the rows of x₁ are already exchanged.
pub(super) fn forward<T: Number>(
    unit: bool,
    columns: &[T],
    m: usize,
    mut x: MatMut<'_, T>,
    below_x: MatMut<'_, T>,
) {
    let (own, below) = parts(columns, m, x.nrows());
    if unit {
        solve_unit_lower_triangular_in_place(own, x.rb_mut(), Par::Seq);
    } else {
        solve_lower_triangular_in_place(own, x.rb_mut(), Par::Seq);
    }
    if below_x.nrows() > 0 {
        matmul(below_x, Accum::Add, below, x.rb(), -T::ONE, Par::Seq);
    }
}

/// Back substitution of one front with U₁₂ (L₂₁ᵀ) and U₁₁ (L₁₁ᵀ): x₁ ← U₁₁⁻¹ (x₁ − U₁₂ x₂).
pub(super) fn backward<T: Number>(
    upper: MatRef<'_, T>,
    rest: MatRef<'_, T>,
    mut x: MatMut<'_, T>,
    known: MatRef<'_, T>,
) {
    if known.nrows() > 0 {
        matmul(x.rb_mut(), Accum::Add, rest, known, -T::ONE, Par::Seq);
    }
    solve_upper_triangular_in_place(upper, x, Par::Seq);
}
