//! Cholesky elimination of small fronts in tiles that stay in registers.
//!
//! A dense library packs its operands, which pays for large products alone. A front of some hundred
//! rows lies in the second cache, its columns are contiguous: tiles of a few vectors of rows by four
//! columns read them where they are. Every number of the result is one chain of multiplications and
//! additions in the order of the columns, whatever the vector unit: vectors of any width give the
//! same bits where products and sums are fused.

use pulp::{Arch, Simd, WithSimd};

use super::schur::Panels;

/// Columns of a tile.
const WIDE: usize = 4;
/// Vectors of rows in a tile: with four columns twelve sums, enough to hide the latency of each.
const TALL: usize = 3;
/// Rows of the widest tile (512 bits).
const MOST: usize = TALL * 8;

/// L₁₁ L₁₁ᵀ = F₁₁ and L₂₁ = F₂₁ L₁₁⁻ᵀ of columns `from..to` in place of `columns` (m rows each),
/// where all columns before `from` are done and have been taken off. Returns the column whose pivot
/// is not positive.
pub(super) fn eliminate(
    columns: &mut [f64],
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

/// S = −L₂₁ L₂₁ᵀ, its lower triangle, of a front whose `columns` (m rows each) are eliminated.
pub(super) fn schur(columns: &[f64], m: usize, panels: Panels, out: &mut [f64]) {
    Arch::new().dispatch(Complement {
        columns,
        m,
        panels,
        out,
    });
}

struct Eliminate<'a> {
    columns: &'a mut [f64],
    m: usize,
    from: usize,
    to: usize,
}

impl WithSimd for Eliminate<'_> {
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
                4 => step::<S, 4>(simd, done, panel, m, j),
                3 => step::<S, 3>(simd, done, panel, m, j),
                2 => step::<S, 2>(simd, done, panel, m, j),
                _ => step::<S, 1>(simd, done, panel, m, j),
            }
            .map_err(|column| j + column)?;
        }
        Ok(())
    }
}

/// Eliminates W columns from row j on.
#[inline(always)]
fn step<S: Simd, const W: usize>(
    simd: S,
    done: &[f64],
    panel: &mut [f64],
    m: usize,
    j: usize,
) -> Result<(), usize> {
    // The block on the diagonal, by itself: rows beyond it are thrown away.
    let mut sums = [[0.0; MOST]; W];
    tile::<S, 1, W>(simd, done, m, j, j, &mut sums);
    let mut own = [[0.0; W]; W]; // [column][row]
    let mut inverse = [0.0; W];
    for c in 0..W {
        for r in c..W {
            let mut x = panel[c * m + j + r] - sums[c][r];
            for q in 0..c {
                x -= own[q][r] * own[q][c];
            }
            own[c][r] = x;
        }
        let pivot = own[c][c];
        if pivot.is_nan() || pivot <= 0.0 {
            return Err(c);
        }
        let root = pivot.sqrt();
        inverse[c] = 1.0 / root;
        own[c][c] = root;
        for r in c + 1..W {
            own[c][r] *= inverse[c];
        }
        panel[c * m + j + c..c * m + j + W].copy_from_slice(&own[c][c..]);
    }
    let mut i = j + W;
    let lanes = S::F64_LANES;
    while i < m {
        let rows = (m - i).min(TALL * lanes);
        match rows.div_ceil(lanes) {
            1 => below::<S, 1, W>(simd, done, panel, m, i, j, &own, &inverse),
            2 => below::<S, 2, W>(simd, done, panel, m, i, j, &own, &inverse),
            _ => below::<S, 3, W>(simd, done, panel, m, i, j, &own, &inverse),
        }
        i += rows;
    }
    Ok(())
}

/// Rows i.. of W columns: what the columns before take off, then division by the block on the
/// diagonal.
#[inline(always)]
fn below<S: Simd, const R: usize, const W: usize>(
    simd: S,
    done: &[f64],
    panel: &mut [f64],
    m: usize,
    i: usize,
    j: usize,
    own: &[[f64; W]; W],
    inverse: &[f64; W],
) {
    let rows = (m - i).min(R * S::F64_LANES);
    let mut x = sums::<S, R, W>(simd, done, m, i, j);
    if rows == R * S::F64_LANES {
        for c in 0..W {
            let at = &panel[c * m + i..][..R * S::F64_LANES];
            let (at, _) = S::as_simd_f64s(at);
            for r in 0..R {
                x[c][r] = simd.sub_f64s(at[r], x[c][r]);
            }
        }
        divide(simd, &mut x, own, inverse);
        for c in 0..W {
            let at = &mut panel[c * m + i..][..R * S::F64_LANES];
            let (at, _) = S::as_mut_simd_f64s(at);
            at.copy_from_slice(&x[c]);
        }
    } else {
        let whole = (R - 1) * S::F64_LANES;
        for c in 0..W {
            let (head, tail) = panel[c * m + i..][..rows].split_at(whole);
            let (head, _) = S::as_simd_f64s(head);
            for r in 0..R - 1 {
                x[c][r] = simd.sub_f64s(head[r], x[c][r]);
            }
            x[c][R - 1] = simd.sub_f64s(simd.partial_load_f64s(tail), x[c][R - 1]);
        }
        divide(simd, &mut x, own, inverse);
        for c in 0..W {
            let (head, tail) = panel[c * m + i..][..rows].split_at_mut(whole);
            let (head, _) = S::as_mut_simd_f64s(head);
            head.copy_from_slice(&x[c][..R - 1]);
            simd.partial_store_f64s(tail, x[c][R - 1]);
        }
    }
}

/// X ← X L₁₁⁻ᵀ
#[inline(always)]
fn divide<S: Simd, const R: usize, const W: usize>(
    simd: S,
    x: &mut [[S::f64s; R]; W],
    own: &[[f64; W]; W],
    inverse: &[f64; W],
) {
    for c in 0..W {
        for q in 0..c {
            let factor = simd.splat_f64s(-own[q][c]);
            for r in 0..R {
                x[c][r] = simd.mul_add_e_f64s(factor, x[q][r], x[c][r]);
            }
        }
        let factor = simd.splat_f64s(inverse[c]);
        for r in 0..R {
            x[c][r] = simd.mul_f64s(factor, x[c][r]);
        }
    }
}

/// A Bᵀ of R vectors of rows from row i on and W columns, whose rows start at j, over all columns of
/// `done`. Vectors that stick out of a column's end read the next column there, which nobody minds.
#[inline(always)]
fn sums<S: Simd, const R: usize, const W: usize>(
    simd: S,
    done: &[f64],
    m: usize,
    i: usize,
    j: usize,
) -> [[S::f64s; R]; W] {
    let rows = R * S::F64_LANES;
    let mut sum = [[simd.splat_f64s(0.0); R]; W];
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
        let mut space = [0.0; MOST];
        space[..m - i].copy_from_slice(&done[at + i..at + m]);
        add(simd, &space[..rows], &done[at + j..][..W], &mut sum);
        at += m;
    }
    sum
}

/// Σ ← Σ + x yᵀ
#[inline(always)]
fn add<S: Simd, const R: usize, const W: usize>(
    simd: S,
    x: &[f64],
    y: &[f64],
    sum: &mut [[S::f64s; R]; W],
) {
    let (x, _) = S::as_simd_f64s(x);
    for c in 0..W {
        let factor = simd.splat_f64s(y[c]);
        for r in 0..R {
            sum[c][r] = simd.mul_add_e_f64s(factor, x[r], sum[c][r]);
        }
    }
}

/// The same, written to memory.
#[inline(always)]
fn tile<S: Simd, const R: usize, const W: usize>(
    simd: S,
    done: &[f64],
    m: usize,
    i: usize,
    j: usize,
    out: &mut [[f64; MOST]; W],
) {
    let sum = sums::<S, R, W>(simd, done, m, i, j);
    for c in 0..W {
        let (to, _) = S::as_mut_simd_f64s(&mut out[c][..R * S::F64_LANES]);
        to.copy_from_slice(&sum[c]);
    }
}

struct Complement<'a> {
    columns: &'a [f64],
    m: usize,
    panels: Panels,
    out: &'a mut [f64],
}

impl WithSimd for Complement<'_> {
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
                    4 => strip::<S, 4>(simd, columns, m, first, tile, height),
                    3 => strip::<S, 3>(simd, columns, m, first, tile, height),
                    2 => strip::<S, 2>(simd, columns, m, first, tile, height),
                    _ => strip::<S, 1>(simd, columns, m, first, tile, height),
                }
            }
        }
    }
}

/// W columns of a panel, from the one on its row `first` on, from their diagonal down.
#[inline(always)]
fn strip<S: Simd, const W: usize>(
    simd: S,
    columns: &[f64],
    m: usize,
    first: usize,
    tile: &mut [f64],
    height: usize,
) {
    let top = m - height; // row of the front
    let lanes = S::F64_LANES;
    let mut i = first;
    while i < height {
        let vectors = (height - i).div_ceil(lanes).min(TALL);
        // The last tile ends where the panel does and writes some rows again, with the same numbers, or
        // some above the diagonal, which nobody reads.
        let at = i.min(height.saturating_sub(vectors * lanes));
        match vectors {
            1 => product::<S, 1, W>(simd, columns, m, top + at, top + first, tile, height, at),
            2 => product::<S, 2, W>(simd, columns, m, top + at, top + first, tile, height, at),
            _ => product::<S, 3, W>(simd, columns, m, top + at, top + first, tile, height, at),
        }
        i += vectors * lanes;
    }
}

/// One tile of −L₂₁ L₂₁ᵀ.
#[inline(always)]
fn product<S: Simd, const R: usize, const W: usize>(
    simd: S,
    columns: &[f64],
    m: usize,
    i: usize,
    j: usize,
    tile: &mut [f64],
    height: usize,
    at: usize,
) {
    let x = sums::<S, R, W>(simd, columns, m, i, j);
    let rows = (height - at).min(R * S::F64_LANES);
    if rows == R * S::F64_LANES {
        for c in 0..W {
            let to = &mut tile[c * height + at..][..R * S::F64_LANES];
            let (to, _) = S::as_mut_simd_f64s(to);
            for r in 0..R {
                to[r] = simd.neg_f64s(x[c][r]);
            }
        }
    } else {
        let mut space = [0.0; MOST];
        for c in 0..W {
            let (to, _) = S::as_mut_simd_f64s(&mut space[..R * S::F64_LANES]);
            for r in 0..R {
                to[r] = simd.neg_f64s(x[c][r]);
            }
            tile[c * height + at..][..rows].copy_from_slice(&space[..rows]);
        }
    }
}
