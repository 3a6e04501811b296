//! P F = L U of the block of its own rows that a front eliminates, its columns in parallel where it is
//! large: panels of columns from left to right, each with its pivots, then the rest updated at once.

use faer::dyn_stack::MemStack;
use faer::linalg::lu::partial_pivoting::factor::lu_in_place;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

use super::kernels::Scratch;

/// Columns that are eliminated at once.
const PANEL: usize = 64;
/// Columns of a block from which on it is worked in panels.
const LARGE: usize = 256;

/// Factorises the leading k rows of `columns` (m × k) in place; row `pivots[i]` became row i.
pub(super) fn lu(columns: &mut [f64], m: usize, pivots: &mut [u32], scratch: &mut Scratch) {
    let k = pivots.len();
    let width = if k > LARGE { PANEL } else { k };
    for (i, pivot) in pivots.iter_mut().enumerate() {
        *pivot = i as u32;
    }
    for j in (0..k).step_by(width.max(1)) {
        let width = width.min(k - j);
        let (left, rest) = columns.split_at_mut(j * m);
        let (panel, right) = rest.split_at_mut(width * m);
        let swaps = &mut scratch.swaps[..k - j];
        lu_in_place(
            MatMut::from_column_major_slice_mut(panel, m, width).subrows_mut(j, k - j),
            swaps,
            &mut scratch.inverse[..k - j],
            Par::Seq,
            MemStack::new(&mut scratch.memory),
            Spec::default(),
        );
        transpositions(swaps);
        let swaps = &swaps[..width];
        let exchange = |column: &mut [f64]| {
            for (i, &p) in swaps.iter().enumerate() {
                column.swap(j + i, j + p as usize);
            }
        };
        for (i, &p) in swaps.iter().enumerate() {
            pivots.swap(j + i, j + p as usize);
        }
        left.par_chunks_mut(m * PANEL)
            .for_each(|piece| piece.chunks_mut(m).for_each(exchange));
        let panel = MatRef::from_column_major_slice(panel, m, width);
        let (own, below) = panel.subrows(j, k - j).split_at_row(width);
        right.par_chunks_mut(m * PANEL).for_each(|piece| {
            piece.chunks_mut(m).for_each(exchange);
            let columns = piece.len() / m;
            let piece = MatMut::from_column_major_slice_mut(piece, m, columns);
            let (mut upper, rest) = piece.subrows_mut(j, k - j).split_at_row_mut(width);
            // U₁₂ = L₁₁⁻¹ F₁₂, F₂₂ ← F₂₂ − L₂₁ U₁₂
            solve_unit_lower_triangular_in_place(own, upper.as_mut(), Par::Seq);
            matmul(rest, Accum::Add, below, upper, -1.0, Par::Seq);
        });
    }
}

/// Turns "row p[i] becomes row i" into "row i is exchanged with row p[i], one i after the other".
fn transpositions(p: &mut [u32]) {
    for i in 0..p.len() {
        let mut from = p[i] as usize;
        // What stood there has been moved already: to where that was exchanged with.
        while from < i {
            from = p[from] as usize;
        }
        p[i] = from as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::super::stencils::Noise;
    use super::*;

    #[test]
    fn exchanges_one_after_the_other_make_the_permutation() {
        let permutation = [3u32, 0, 4, 1, 2];
        let mut swaps = permutation;
        transpositions(&mut swaps);
        let mut rows = [0u32, 1, 2, 3, 4];
        for (i, &p) in swaps.iter().enumerate() {
            rows.swap(i, p as usize);
        }
        assert_eq!(rows, permutation);
    }

    #[test]
    fn a_block_in_panels_is_p_f_as_its_factors_say() {
        // Two panels' width beyond what is done at once, and rows below that stay as they are.
        let (k, m) = (LARGE + 70, LARGE + 75);
        let mut noise = Noise(5);
        let front: Vec<f64> = (0..m * k).map(|_| noise.next()).collect();
        let (mut columns, mut pivots) = (front.clone(), vec![0u32; k]);
        lu(&mut columns, m, &mut pivots, &mut Scratch::new(k).unwrap());
        assert!(pivots.iter().enumerate().any(|(i, &p)| p as usize != i));
        for j in 0..k {
            for i in 0..k {
                // Row i of L, its diagonal 1, times column j of U.
                let product: f64 = (0..=i.min(j))
                    .map(|p| if p == i { 1.0 } else { columns[i + p * m] } * columns[p + j * m])
                    .sum();
                let error = (product - front[pivots[i] as usize + j * m]).abs();
                // |L| ≤ 1, pivots of random numbers grow to some tens: 326 roundings of those.
                assert!(error < 1e-11, "({i}, {j}): {error:e}");
                assert!(i <= j || columns[i + j * m].abs() <= 1.0);
            }
            assert_eq!(
                columns[k + j * m..(j + 1) * m],
                front[k + j * m..(j + 1) * m]
            );
        }
    }
}
