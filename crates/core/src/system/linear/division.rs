//! X ← X L⁻ᵀ for a tall X of few columns: the rows of a front below the columns it eliminates. Rows
//! do not know of one another, so they go through in stripes that stay in cache, all columns at once.

use faer::linalg::matmul::matmul;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, NullaryFnOnce};

/// Columns worked on at once; more are taken in blocks, with products between them.
const WIDE: usize = 16;
/// Rows of a stripe: as many independent sums as a core works on at a time.
const STRIPE: usize = 32;
/// Rows of a stripe of what is left.
const NARROW: usize = 8;

/// X ← X L⁻ᵀ, `lower` the matrix whose lower triangle is L (w × w), X = `rows` (n × w, its columns
/// contiguous).
pub(super) fn divide(lower: MatRef<'_, f64>, mut rows: MatMut<'_, f64>) {
    for j in (0..lower.nrows()).step_by(WIDE) {
        let width = WIDE.min(lower.nrows() - j);
        let (done, rest) = rows.rb_mut().split_at_col_mut(j);
        let mut block = rest.subcols_mut(0, width);
        if j > 0 {
            let across = lower.submatrix(j, 0, width, j).transpose();
            matmul(
                block.rb_mut(),
                Accum::Add,
                done.rb(),
                across,
                -1.0,
                Par::Seq,
            );
        }
        let mut columns = block.col_iter_mut();
        Arch::new().dispatch(Stripes {
            factors: std::array::from_fn(|a| {
                std::array::from_fn(|b| {
                    if b < a && a < width {
                        -lower[(j + a, j + b)]
                    } else {
                        0.0
                    }
                })
            }),
            inverse: std::array::from_fn(|a| {
                if a < width {
                    lower[(j + a, j + a)].recip()
                } else {
                    0.0
                }
            }),
            columns: std::array::from_fn(|_| {
                let Some(column) = columns.next() else {
                    return &mut [][..];
                };
                let column = column.try_as_col_major_mut();
                column.map_or(&mut [][..], |c| c.as_slice_mut())
            }),
            width,
        });
    }
}

/// x_j ← (x_j − Σ_{i<j} l_ji x_i) / l_jj for all rows of x.
struct Stripes<'a> {
    factors: [[f64; WIDE]; WIDE], // −l_ji
    inverse: [f64; WIDE],         // 1 / l_jj
    columns: [&'a mut [f64]; WIDE],
    width: usize,
}

impl NullaryFnOnce for Stripes<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let n = self.columns[0].len();
        let mut row = 0;
        while row + STRIPE <= n {
            self.stripe::<STRIPE>(row, STRIPE);
            row += STRIPE;
        }
        while row < n {
            self.stripe::<NARROW>(row, NARROW.min(n - row));
            row += NARROW;
        }
    }
}

impl Stripes<'_> {
    /// Rows `row` to `row + rows − 1`, at most N.
    #[inline(always)]
    fn stripe<const N: usize>(&mut self, row: usize, rows: usize) {
        let mut x = [[0.0; N]; WIDE];
        for j in 0..self.width {
            let column = &mut self.columns[j][row..row + rows];
            let mut sum = [0.0; N];
            if rows == N {
                sum.copy_from_slice(column);
            } else {
                sum[..rows].copy_from_slice(column);
            }
            for i in 0..j {
                let factor = self.factors[j][i];
                for r in 0..N {
                    sum[r] = factor.mul_add(x[i][r], sum[r]);
                }
            }
            for r in 0..N {
                x[j][r] = sum[r] * self.inverse[j];
            }
            if rows == N {
                column.copy_from_slice(&x[j]);
            } else {
                column.copy_from_slice(&x[j][..rows]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::stencils::Noise;
    use super::*;
    use faer::Mat;

    #[test]
    fn rows_are_divided_whatever_their_number() {
        let mut noise = Noise(3);
        for (n, w) in [
            (1, 1),
            (7, 3),
            (8, 16),
            (45, 16),
            (77, 17),
            (130, 50),
            (3, 33),
        ] {
            // What stands above the diagonal is none of its business.
            let lower = Mat::from_fn(w, w, |i, j| noise.next() + if i == j { 8.0 } else { 0.0 });
            let x = Mat::from_fn(n, w, |_, _| noise.next());
            // X Lᵀ
            let mut rows = Mat::from_fn(n, w, |i, j| {
                (0..=j).map(|p| x[(i, p)] * lower[(j, p)]).sum::<f64>()
            });
            divide(lower.as_ref(), rows.as_mut());
            for i in 0..n {
                for j in 0..w {
                    let error = (rows[(i, j)] - x[(i, j)]).abs();
                    // Diagonally dominant up to w = 8, mildly growing beyond: roundings of O(1).
                    assert!(error < 1e-12, "{n} × {w}: {error:e}");
                }
            }
        }
    }
}
