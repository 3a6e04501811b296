//! Substitution with the columns of a Cholesky front for one right-hand side.
//!
//! The factor is read once in each direction, at the speed of memory. Both directions read four columns at a time
//! and by columns, so that no read is strided.

use pulp::{Arch, Simd, WithSimd};

use super::number::Number;

/// Columns at a time.
const WIDE: usize = 4;

/// x₁ ← L₁₁⁻¹ x₁, x₂ ← x₂ − L₂₁ x₁ with `columns` (m rows; as many columns as x₁ has rows).
pub(super) fn forward<T: Number>(columns: &[T], m: usize, x: &mut [T], below: &mut [T]) {
    Arch::new().dispatch(Forward {
        columns,
        m,
        x,
        below,
    });
}

/// x₁ ← L₁₁⁻ᵀ (x₁ − L₂₁ᵀ x₂).
pub(super) fn backward<T: Number>(columns: &[T], m: usize, x: &mut [T], below: &[T]) {
    Arch::new().dispatch(Backward {
        columns,
        m,
        x,
        below,
    });
}

struct Forward<'a, T> {
    columns: &'a [T],
    m: usize,
    x: &'a mut [T],
    below: &'a mut [T],
}

impl<T: Number> WithSimd for Forward<'_, T> {
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

/// The given rows of four columns.
#[inline(always)]
fn rows<T>(block: &[T], m: usize, rows: std::ops::Range<usize>) -> [&[T]; WIDE] {
    [
        &block[rows.start..rows.end],
        &block[m + rows.start..m + rows.end],
        &block[2 * m + rows.start..2 * m + rows.end],
        &block[3 * m + rows.start..3 * m + rows.end],
    ]
}

/// y ← y − L x
#[inline(always)]
fn take_off<T: Number, S: Simd>(simd: S, l: [&[T]; WIDE], x: &[T; WIDE], y: &mut [T]) {
    let factor = [
        T::splat(simd, -x[0]),
        T::splat(simd, -x[1]),
        T::splat(simd, -x[2]),
        T::splat(simd, -x[3]),
    ];
    let (y, y_rest) = T::vectors_mut::<S>(y);
    let (l0, rest0) = T::vectors::<S>(l[0]);
    let (l1, rest1) = T::vectors::<S>(l[1]);
    let (l2, rest2) = T::vectors::<S>(l[2]);
    let (l3, rest3) = T::vectors::<S>(l[3]);
    for ((((y, l0), l1), l2), l3) in y.iter_mut().zip(l0).zip(l1).zip(l2).zip(l3) {
        let mut sum = T::mul_add(simd, factor[0], *l0, *y);
        sum = T::mul_add(simd, factor[1], *l1, sum);
        sum = T::mul_add(simd, factor[2], *l2, sum);
        *y = T::mul_add(simd, factor[3], *l3, sum);
    }
    // Fronts are narrow, so rows that do not fill a vector are common.
    if !y_rest.is_empty() {
        let mut sum = T::load(simd, y_rest);
        sum = T::mul_add(simd, factor[0], T::load(simd, rest0), sum);
        sum = T::mul_add(simd, factor[1], T::load(simd, rest1), sum);
        sum = T::mul_add(simd, factor[2], T::load(simd, rest2), sum);
        sum = T::mul_add(simd, factor[3], T::load(simd, rest3), sum);
        T::store(simd, y_rest, sum);
    }
}

struct Backward<'a, T> {
    columns: &'a [T],
    m: usize,
    x: &'a mut [T],
    below: &'a [T],
}

impl<T: Number> WithSimd for Backward<'_, T> {
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
            let mut sum = [T::ZERO; WIDE];
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
fn add_up<T: Number, S: Simd>(simd: S, l: [&[T]; WIDE], y: &[T], sum: &mut [T; WIDE]) {
    let mut sums = [T::splat(simd, T::ZERO); WIDE];
    let (y, y_rest) = T::vectors::<S>(y);
    let (l0, rest0) = T::vectors::<S>(l[0]);
    let (l1, rest1) = T::vectors::<S>(l[1]);
    let (l2, rest2) = T::vectors::<S>(l[2]);
    let (l3, rest3) = T::vectors::<S>(l[3]);
    for ((((y, l0), l1), l2), l3) in y.iter().zip(l0).zip(l1).zip(l2).zip(l3) {
        sums[0] = T::mul_add(simd, *y, *l0, sums[0]);
        sums[1] = T::mul_add(simd, *y, *l1, sums[1]);
        sums[2] = T::mul_add(simd, *y, *l2, sums[2]);
        sums[3] = T::mul_add(simd, *y, *l3, sums[3]);
    }
    if !y_rest.is_empty() {
        let y = T::load(simd, y_rest);
        sums[0] = T::mul_add(simd, y, T::load(simd, rest0), sums[0]);
        sums[1] = T::mul_add(simd, y, T::load(simd, rest1), sums[1]);
        sums[2] = T::mul_add(simd, y, T::load(simd, rest2), sums[2]);
        sums[3] = T::mul_add(simd, y, T::load(simd, rest3), sums[3]);
    }
    for c in 0..WIDE {
        sum[c] += T::sum(simd, sums[c]);
    }
}
