//! Substitution with the columns of a Cholesky front for one right-hand side.
//!
//! The factor is read once each way, at the speed of memory: four columns at a time, by columns both
//! ways, so that nothing is read in strides.

use pulp::{Arch, Simd, WithSimd};

/// Columns at a time.
const WIDE: usize = 4;

/// x₁ ← L₁₁⁻¹ x₁, x₂ ← x₂ − L₂₁ x₁ with `columns` (m rows, as many columns as x₁ has).
pub(super) fn forward(columns: &[f64], m: usize, x: &mut [f64], below: &mut [f64]) {
    Arch::new().dispatch(Forward {
        columns,
        m,
        x,
        below,
    });
}

/// x₁ ← L₁₁⁻ᵀ (x₁ − L₂₁ᵀ x₂).
pub(super) fn backward(columns: &[f64], m: usize, x: &mut [f64], below: &[f64]) {
    Arch::new().dispatch(Backward {
        columns,
        m,
        x,
        below,
    });
}

struct Forward<'a> {
    columns: &'a [f64],
    m: usize,
    x: &'a mut [f64],
    below: &'a mut [f64],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            columns,
            m,
            x,
            below,
        } = self;
        let k = x.len();
        let mut j = 0;
        while j + WIDE <= k {
            let block = &columns[j * m..][..WIDE * m];
            let (own, after) = x[j..].split_at_mut(WIDE);
            for c in 0..WIDE {
                own[c] /= block[c * m + j + c];
                for r in c + 1..WIDE {
                    own[r] -= block[c * m + j + r] * own[c];
                }
            }
            let own = [own[0], own[1], own[2], own[3]];
            take_off(simd, rows(block, m, j + WIDE..k), &own, after);
            take_off(simd, rows(block, m, k..m), &own, below);
            j += WIDE;
        }
        for j in j..k {
            let column = &columns[j * m..][..m];
            x[j] /= column[j];
            let own = x[j];
            for (x, l) in x[j + 1..].iter_mut().zip(&column[j + 1..]) {
                *x -= l * own;
            }
            for (x, l) in below.iter_mut().zip(&column[k..]) {
                *x -= l * own;
            }
        }
    }
}

/// These rows of four columns.
#[inline(always)]
fn rows(block: &[f64], m: usize, rows: std::ops::Range<usize>) -> [&[f64]; WIDE] {
    [
        &block[rows.start..rows.end],
        &block[m + rows.start..m + rows.end],
        &block[2 * m + rows.start..2 * m + rows.end],
        &block[3 * m + rows.start..3 * m + rows.end],
    ]
}

/// y ← y − L x
#[inline(always)]
fn take_off<S: Simd>(simd: S, l: [&[f64]; WIDE], x: &[f64; WIDE], y: &mut [f64]) {
    let factor = [
        simd.splat_f64s(-x[0]),
        simd.splat_f64s(-x[1]),
        simd.splat_f64s(-x[2]),
        simd.splat_f64s(-x[3]),
    ];
    let (y, y_rest) = S::as_mut_simd_f64s(y);
    let (l0, rest0) = S::as_simd_f64s(l[0]);
    let (l1, rest1) = S::as_simd_f64s(l[1]);
    let (l2, rest2) = S::as_simd_f64s(l[2]);
    let (l3, rest3) = S::as_simd_f64s(l[3]);
    for ((((y, l0), l1), l2), l3) in y.iter_mut().zip(l0).zip(l1).zip(l2).zip(l3) {
        let mut sum = simd.mul_add_e_f64s(factor[0], *l0, *y);
        sum = simd.mul_add_e_f64s(factor[1], *l1, sum);
        sum = simd.mul_add_e_f64s(factor[2], *l2, sum);
        *y = simd.mul_add_e_f64s(factor[3], *l3, sum);
    }
    for (r, y) in y_rest.iter_mut().enumerate() {
        *y -= rest0[r] * x[0] + rest1[r] * x[1] + rest2[r] * x[2] + rest3[r] * x[3];
    }
}

struct Backward<'a> {
    columns: &'a [f64],
    m: usize,
    x: &'a mut [f64],
    below: &'a [f64],
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            columns,
            m,
            x,
            below,
        } = self;
        let k = x.len();
        let whole = k - k % WIDE;
        for j in (whole..k).rev() {
            let column = &columns[j * m..][..m];
            let mut sum = x[j];
            for (x, l) in x[j + 1..].iter().zip(&column[j + 1..]) {
                sum -= l * x;
            }
            for (x, l) in below.iter().zip(&column[k..]) {
                sum -= l * x;
            }
            x[j] = sum / column[j];
        }
        for j in (0..whole).step_by(WIDE).rev() {
            let block = &columns[j * m..][..WIDE * m];
            let (own, after) = x[j..].split_at_mut(WIDE);
            let mut sum = [0.0; WIDE];
            add_up(simd, rows(block, m, j + WIDE..k), after, &mut sum);
            add_up(simd, rows(block, m, k..m), below, &mut sum);
            for c in (0..WIDE).rev() {
                let mut left = own[c] - sum[c];
                for r in c + 1..WIDE {
                    left -= block[c * m + j + r] * own[r];
                }
                own[c] = left / block[c * m + j + c];
            }
        }
    }
}

/// Σ ← Σ + Lᵀ y
#[inline(always)]
fn add_up<S: Simd>(simd: S, l: [&[f64]; WIDE], y: &[f64], sum: &mut [f64; WIDE]) {
    let mut sums = [simd.splat_f64s(0.0); WIDE];
    let (y, y_rest) = S::as_simd_f64s(y);
    let (l0, rest0) = S::as_simd_f64s(l[0]);
    let (l1, rest1) = S::as_simd_f64s(l[1]);
    let (l2, rest2) = S::as_simd_f64s(l[2]);
    let (l3, rest3) = S::as_simd_f64s(l[3]);
    for ((((y, l0), l1), l2), l3) in y.iter().zip(l0).zip(l1).zip(l2).zip(l3) {
        sums[0] = simd.mul_add_e_f64s(*y, *l0, sums[0]);
        sums[1] = simd.mul_add_e_f64s(*y, *l1, sums[1]);
        sums[2] = simd.mul_add_e_f64s(*y, *l2, sums[2]);
        sums[3] = simd.mul_add_e_f64s(*y, *l3, sums[3]);
    }
    for c in 0..WIDE {
        sum[c] += simd.reduce_sum_f64s(sums[c]);
    }
    for (r, y) in y_rest.iter().enumerate() {
        sum[0] += rest0[r] * y;
        sum[1] += rest1[r] * y;
        sum[2] += rest2[r] * y;
        sum[3] += rest3[r] * y;
    }
}
