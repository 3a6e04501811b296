//! Cholesky elimination of small fronts in tiles that stay in registers.
//!
//! A dense library packs its operands, which saves time for large products only. A front of some hundred rows fits
//! into the second-level cache, and its columns are contiguous. Tiles of a few vectors of rows by four columns read
//! them in place. Each number of the result is one chain of multiplications and additions in the order of the
//! columns. So vectors of any width give the same bits where multiplications and additions are fused.

use pulp::{Arch, Simd, WithSimd};

use super::number::Number;
use super::schur::Panels;

/// Columns of a tile.
const WIDE: usize = 4;
/// Vectors of rows in a tile. Four columns then have twelve sums, enough to hide the latency of each.
const TALL: usize = 3;
/// Rows of the widest tile (512 bits of single precision).
const MOST: usize = TALL * 16;

/// L₁₁ L₁₁ᵀ = F₁₁ and L₂₁ = F₂₁ L₁₁⁻ᵀ for the columns `from..to`, in place of `columns` (m rows each). The columns
/// before `from` are eliminated, and their contributions are already subtracted. The error is the column whose
/// pivot is not positive.
pub(super) fn eliminate<T: Number>(
    columns: &mut [T],
    m: usize,
    from: usize,
    to: usize,
) -> Result<(), usize> {
    Arch::new().dispatch(Eliminate {
        columns,
        m,
        from,
        to,
    })
}

/// Lower triangle of S = −L₂₁ L₂₁ᵀ of a front whose `columns` (m rows each) are eliminated.
pub(super) fn schur<T: Number>(columns: &[T], m: usize, panels: Panels, out: &mut [T]) {
    Arch::new().dispatch(Complement {
        columns,
        m,
        panels,
        out,
    });
}

struct Eliminate<'a, T> {
    columns: &'a mut [T],
    m: usize,
    from: usize,
    to: usize,
}

impl<T: Number> WithSimd for Eliminate<'_, T> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self {
            columns,
            m,
            from,
            to,
        } = self;
        for j in (from..to).step_by(WIDE) {
            let width = WIDE.min(to - j);
            let (done, rest) = columns.split_at_mut(j * m);
            let (done, panel) = (&done[from * m..], &mut rest[..width * m]);
            match width {
                4 => step::<T, S, 4>(simd, done, panel, m, j),
                3 => step::<T, S, 3>(simd, done, panel, m, j),
                2 => step::<T, S, 2>(simd, done, panel, m, j),
                _ => step::<T, S, 1>(simd, done, panel, m, j),
            }
            .map_err(|column| j + column)?;
        }
        Ok(())
    }
}

/// Eliminates W columns from row j downwards.
#[inline(always)]
fn step<T: Number, S: Simd, const W: usize>(
    simd: S,
    done: &[T],
    panel: &mut [T],
    m: usize,
    j: usize,
) -> Result<(), usize> {
    // Diagonal block. Rows beyond it are discarded.
    let mut sums = [[T::ZERO; MOST]; W];
    tile::<T, S, 1, W>(simd, done, m, j, j, &mut sums);
    let mut own = [[T::ZERO; W]; W]; // [column][row]
    let mut inverse = [T::ZERO; W];
    for c in 0..W {
        for r in c..W {
            let mut x = panel[c * m + j + r] - sums[c][r];
            for q in 0..c {
                x -= own[q][r] * own[q][c];
            }
            own[c][r] = x;
        }
        let pivot = own[c][c];
        if pivot.f64().is_nan() || pivot <= T::ZERO {
            return Err(c);
        }
        let root = pivot.root();
        inverse[c] = T::ONE / root;
        own[c][c] = root;
        for r in c + 1..W {
            own[c][r] *= inverse[c];
        }
        panel[c * m + j + c..c * m + j + W].copy_from_slice(&own[c][c..]);
    }
    let mut i = j + W;
    let lanes = T::lanes::<S>();
    while i < m {
        let rows = (m - i).min(TALL * lanes);
        match rows.div_ceil(lanes) {
            1 => below::<T, S, 1, W>(simd, done, panel, m, i, j, &own, &inverse),
            2 => below::<T, S, 2, W>(simd, done, panel, m, i, j, &own, &inverse),
            _ => below::<T, S, 3, W>(simd, done, panel, m, i, j, &own, &inverse),
        }
        i += rows;
    }
    Ok(())
}

/// Rows i.. of W columns: subtracts the contributions of the columns before, then solves with the diagonal block.
#[inline(always)]
#[expect(
    clippy::too_many_arguments,
    reason = "a dense kernel: sizes, strides and slices"
)]
fn below<T: Number, S: Simd, const R: usize, const W: usize>(
    simd: S,
    done: &[T],
    panel: &mut [T],
    m: usize,
    i: usize,
    j: usize,
    own: &[[T; W]; W],
    inverse: &[T; W],
) {
    let rows = (m - i).min(R * T::lanes::<S>());
    let mut x = sums::<T, S, R, W>(simd, done, m, i, j);
    if rows == R * T::lanes::<S>() {
        for c in 0..W {
            let at = &panel[c * m + i..][..R * T::lanes::<S>()];
            let (at, _) = T::vectors::<S>(at);
            for r in 0..R {
                x[c][r] = T::minus(simd, at[r], x[c][r]);
            }
        }
        divide(simd, &mut x, own, inverse);
        for c in 0..W {
            let at = &mut panel[c * m + i..][..R * T::lanes::<S>()];
            let (at, _) = T::vectors_mut::<S>(at);
            at.copy_from_slice(&x[c]);
        }
    } else {
        let whole = (R - 1) * T::lanes::<S>();
        for c in 0..W {
            let (head, tail) = panel[c * m + i..][..rows].split_at(whole);
            let (head, _) = T::vectors::<S>(head);
            for r in 0..R - 1 {
                x[c][r] = T::minus(simd, head[r], x[c][r]);
            }
            x[c][R - 1] = T::minus(simd, T::load(simd, tail), x[c][R - 1]);
        }
        divide(simd, &mut x, own, inverse);
        for c in 0..W {
            let (head, tail) = panel[c * m + i..][..rows].split_at_mut(whole);
            let (head, _) = T::vectors_mut::<S>(head);
            head.copy_from_slice(&x[c][..R - 1]);
            T::store(simd, tail, x[c][R - 1]);
        }
    }
}

/// X ← X L₁₁⁻ᵀ
#[inline(always)]
fn divide<T: Number, S: Simd, const R: usize, const W: usize>(
    simd: S,
    x: &mut [[T::Vector<S>; R]; W],
    own: &[[T; W]; W],
    inverse: &[T; W],
) {
    for c in 0..W {
        for q in 0..c {
            let factor = T::splat(simd, -own[q][c]);
            for r in 0..R {
                x[c][r] = T::mul_add(simd, factor, x[q][r], x[c][r]);
            }
        }
        let factor = T::splat(simd, inverse[c]);
        for r in 0..R {
            x[c][r] = T::times(simd, factor, x[c][r]);
        }
    }
}

/// A Bᵀ for R vectors of rows from row i and W columns, whose rows start at j, over all columns of `done`. Vectors
/// that extend beyond the end of a column read the next column. These numbers are not used.
#[inline(always)]
fn sums<T: Number, S: Simd, const R: usize, const W: usize>(
    simd: S,
    done: &[T],
    m: usize,
    i: usize,
    j: usize,
) -> [[T::Vector<S>; R]; W] {
    let rows = R * T::lanes::<S>();
    let mut sum = [[T::splat(simd, T::ZERO); R]; W];
    let mut at = 0;
    while at + i + rows <= done.len() {
        add(
            simd,
            &done[at + i..][..rows],
            &done[at + j..][..W],
            &mut sum,
        );
        at += m;
    }
    while at < done.len() {
        let mut space = [T::ZERO; MOST];
        space[..m - i].copy_from_slice(&done[at + i..at + m]);
        add(simd, &space[..rows], &done[at + j..][..W], &mut sum);
        at += m;
    }
    sum
}

/// Σ ← Σ + x yᵀ
#[inline(always)]
fn add<T: Number, S: Simd, const R: usize, const W: usize>(
    simd: S,
    x: &[T],
    y: &[T],
    sum: &mut [[T::Vector<S>; R]; W],
) {
    let (x, _) = T::vectors::<S>(x);
    for c in 0..W {
        let factor = T::splat(simd, y[c]);
        for r in 0..R {
            sum[c][r] = T::mul_add(simd, factor, x[r], sum[c][r]);
        }
    }
}

/// The same, written to memory.
#[inline(always)]
fn tile<T: Number, S: Simd, const R: usize, const W: usize>(
    simd: S,
    done: &[T],
    m: usize,
    i: usize,
    j: usize,
    out: &mut [[T; MOST]; W],
) {
    let sum = sums::<T, S, R, W>(simd, done, m, i, j);
    for c in 0..W {
        let (to, _) = T::vectors_mut::<S>(&mut out[c][..R * T::lanes::<S>()]);
        to.copy_from_slice(&sum[c]);
    }
}

struct Complement<'a, T> {
    columns: &'a [T],
    m: usize,
    panels: Panels,
    out: &'a mut [T],
}

impl<T: Number> WithSimd for Complement<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            columns,
            m,
            panels,
            out,
        } = self;
        for (j, panel) in panels.split(out) {
            let height = panels.order - j;
            for (t, tile) in panel.chunks_mut(WIDE * height).enumerate() {
                let first = t * WIDE;
                match tile.len() / height {
                    4 => strip::<T, S, 4>(simd, columns, m, first, tile, height),
                    3 => strip::<T, S, 3>(simd, columns, m, first, tile, height),
                    2 => strip::<T, S, 2>(simd, columns, m, first, tile, height),
                    _ => strip::<T, S, 1>(simd, columns, m, first, tile, height),
                }
            }
        }
    }
}

/// W columns of a panel, starting with the one whose diagonal is in row `first`, from the diagonal downwards.
#[inline(always)]
fn strip<T: Number, S: Simd, const W: usize>(
    simd: S,
    columns: &[T],
    m: usize,
    first: usize,
    tile: &mut [T],
    height: usize,
) {
    let top = m - height; // row of the front
    let lanes = T::lanes::<S>();
    let mut i = first;
    while i < height {
        let vectors = (height - i).div_ceil(lanes).min(TALL);
        // The last tile ends with the panel. It writes some rows again with the same numbers, or some above the
        // diagonal, which are not read.
        let at = i.min(height.saturating_sub(vectors * lanes));
        match vectors {
            1 => product::<T, S, 1, W>(simd, columns, m, top + at, top + first, tile, height, at),
            2 => product::<T, S, 2, W>(simd, columns, m, top + at, top + first, tile, height, at),
            _ => product::<T, S, 3, W>(simd, columns, m, top + at, top + first, tile, height, at),
        }
        i += vectors * lanes;
    }
}

/// One tile of −L₂₁ L₂₁ᵀ.
#[inline(always)]
#[expect(
    clippy::too_many_arguments,
    reason = "a dense kernel: sizes, strides and slices"
)]
fn product<T: Number, S: Simd, const R: usize, const W: usize>(
    simd: S,
    columns: &[T],
    m: usize,
    i: usize,
    j: usize,
    tile: &mut [T],
    height: usize,
    at: usize,
) {
    let x = sums::<T, S, R, W>(simd, columns, m, i, j);
    let rows = (height - at).min(R * T::lanes::<S>());
    if rows == R * T::lanes::<S>() {
        for c in 0..W {
            let to = &mut tile[c * height + at..][..R * T::lanes::<S>()];
            let (to, _) = T::vectors_mut::<S>(to);
            for r in 0..R {
                to[r] = T::negative(simd, x[c][r]);
            }
        }
    } else {
        let mut space = [T::ZERO; MOST];
        for c in 0..W {
            let (to, _) = T::vectors_mut::<S>(&mut space[..R * T::lanes::<S>()]);
            for r in 0..R {
                to[r] = T::negative(simd, x[c][r]);
            }
            tile[c * height + at..][..rows].copy_from_slice(&space[..rows]);
        }
    }
}
