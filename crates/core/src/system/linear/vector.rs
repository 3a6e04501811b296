//! Substitution with one right-hand side in one front: every number of the factor is read once, in
//! the order of memory, four columns at a time. All there is to gain is the speed of memory.

use pulp::{Arch, NullaryFnOnce};

/// Columns worked on at once: the vector is then read and written a quarter as often.
const WIDE: usize = 4;
/// Partial sums of an inner product, so that additions need not wait for one another.
const LANES: usize = 8;

/// x₁ ← L₁₁⁻¹ x₁, x₂ ← x₂ − L₂₁ x₁ with the columns (m × k) of a front; x₁ has k numbers, x₂ m − k.
pub(super) struct Forward<'a> {
    /// L has ones on its diagonal.
    pub unit: bool,
    pub columns: &'a [f64],
    pub x: &'a mut [f64],
    pub below: &'a mut [f64],
}

/// x₁ ← L₁₁⁻ᵀ (x₁ − L₂₁ᵀ x₂)
pub(super) struct BackwardTransposed<'a> {
    pub columns: &'a [f64],
    pub x: &'a mut [f64],
    pub known: &'a [f64],
}

/// x₁ ← U₁₁⁻¹ (x₁ − U₁₂ x₂), U₁₁ the upper triangle of the columns (m × k), U₁₂ = `rest` (k × m − k).
pub(super) struct Backward<'a> {
    pub columns: &'a [f64],
    pub rest: &'a [f64],
    pub x: &'a mut [f64],
    pub known: &'a [f64],
}

/// Does it with the widest vector unit there is.
pub(super) fn run(work: impl NullaryFnOnce<Output = ()>) {
    Arch::new().dispatch(work);
}

impl NullaryFnOnce for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let (k, m) = (self.x.len(), self.x.len() + self.below.len());
        let mut j = 0;
        while j + WIDE <= k {
            self.block::<WIDE>(j, m);
            j += WIDE;
        }
        for j in j..k {
            self.block::<1>(j, m);
        }
    }
}

impl Forward<'_> {
    /// Columns j to j + W − 1.
    #[inline(always)]
    fn block<const W: usize>(&mut self, j: usize, m: usize) {
        let k = self.x.len();
        let columns: [&[f64]; W] = std::array::from_fn(|i| &self.columns[(j + i) * m..][..m]);
        let (head, tail) = self.x[j..].split_at_mut(W);
        for i in 0..W {
            if !self.unit {
                head[i] /= columns[i][j + i];
            }
            for r in i + 1..W {
                head[r] -= columns[i][j + r] * head[i];
            }
        }
        let factors = std::array::from_fn(|i| head[i]);
        subtract(tail, columns.map(|c| &c[j + W..k]), factors);
        subtract(self.below, columns.map(|c| &c[k..]), factors);
    }
}

impl NullaryFnOnce for BackwardTransposed<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let k = self.x.len();
        let m = k + self.known.len();
        let wide = k / WIDE * WIDE;
        for j in (wide..k).rev() {
            self.block::<1>(j, m);
        }
        for j in (0..wide).step_by(WIDE).rev() {
            self.block::<WIDE>(j, m);
        }
    }
}

impl BackwardTransposed<'_> {
    /// Columns j to j + W − 1.
    #[inline(always)]
    fn block<const W: usize>(&mut self, j: usize, m: usize) {
        let k = self.x.len();
        let columns: [&[f64]; W] = std::array::from_fn(|i| &self.columns[(j + i) * m..][..m]);
        let (head, tail) = self.x[j..].split_at_mut(W);
        let near = products(tail, columns.map(|c| &c[j + W..k]));
        let far = products(self.known, columns.map(|c| &c[k..]));
        for i in (0..W).rev() {
            let mut sum = head[i] - (near[i] + far[i]);
            for r in i + 1..W {
                sum -= columns[i][j + r] * head[r];
            }
            head[i] = sum / columns[i][j + i];
        }
    }
}

impl NullaryFnOnce for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let (k, b) = (self.x.len(), self.known.len());
        let wide = b / WIDE * WIDE;
        for j in (0..wide).step_by(WIDE) {
            let columns: [&[f64]; WIDE] = std::array::from_fn(|i| &self.rest[(j + i) * k..][..k]);
            subtract(self.x, columns, std::array::from_fn(|i| self.known[j + i]));
        }
        for j in wide..b {
            subtract(self.x, [&self.rest[j * k..][..k]], [self.known[j]]);
        }
        let wide = k / WIDE * WIDE;
        for j in (wide..k).rev() {
            self.block::<1>(j, k + b);
        }
        for j in (0..wide).step_by(WIDE).rev() {
            self.block::<WIDE>(j, k + b);
        }
    }
}

impl Backward<'_> {
    /// Columns j to j + W − 1 of U₁₁.
    #[inline(always)]
    fn block<const W: usize>(&mut self, j: usize, m: usize) {
        let columns: [&[f64]; W] = std::array::from_fn(|i| &self.columns[(j + i) * m..][..m]);
        let (before, rest) = self.x.split_at_mut(j);
        let head = &mut rest[..W];
        for i in (0..W).rev() {
            head[i] /= columns[i][j + i];
            for r in 0..i {
                head[r] -= columns[i][j + r] * head[i];
            }
        }
        let factors = std::array::from_fn(|i| head[i]);
        subtract(before, columns.map(|c| &c[..j]), factors);
    }
}

/// y ← y − Σ_i a_i c_i
#[inline(always)]
fn subtract<const W: usize>(y: &mut [f64], c: [&[f64]; W], a: [f64; W]) {
    let n = y.len();
    let c = c.map(|c| &c[..n]);
    for r in 0..n {
        let mut sum = 0.0;
        for i in 0..W {
            sum += c[i][r] * a[i];
        }
        y[r] -= sum;
    }
}

/// cᵢᵀ y
#[inline(always)]
fn products<const W: usize>(y: &[f64], c: [&[f64]; W]) -> [f64; W] {
    let n = y.len();
    let c = c.map(|c| &c[..n]);
    let mut sums = [[0.0; LANES]; W];
    let whole = n / LANES * LANES;
    for r in (0..whole).step_by(LANES) {
        let y = &y[r..r + LANES];
        for i in 0..W {
            let c = &c[i][r..r + LANES];
            for l in 0..LANES {
                sums[i][l] += c[l] * y[l];
            }
        }
    }
    for r in whole..n {
        for i in 0..W {
            sums[i][r - whole] += c[i][r] * y[r];
        }
    }
    sums.map(|s| ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7])))
}
