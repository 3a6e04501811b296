//! Reuse of factors changes no bit of the results.

use super::stencils::{Noise, solid};
use super::*;

const THREE: [Backend; 3] = [
    Backend::MultifrontalLlt,
    Backend::MixedLlt,
    Backend::MultifrontalLu,
];

/// Bits of the solution for one right-hand side, or its error, and the saved part of the operations.
fn outcome(solver: &mut LinearSolver, values: &[f64]) -> (Result<Vec<u64>, LinearError>, f64) {
    solver.trust_single(true);
    let solved = solver.factorise(values).and_then(|_| {
        let mut noise = Noise(21);
        let mut x: Vec<f64> = (0..solver.n()).map(|_| noise.next()).collect();
        solver.solve(&mut x)?;
        Ok(x.iter().map(|x| x.to_bits()).collect())
    });
    (solved, solver.stats().reused)
}

/// Adds `by` to the diagonal of a range of equations.
fn shift(pattern: &Pattern, values: &mut [f64], equations: std::ops::Range<usize>, by: f64) {
    for e in equations {
        values[pattern.find(e, e).unwrap()] += by;
    }
}

/// A sequence of matrices: all entries changed, none, a few in different places, and changed back; singular,
/// indefinite and not finite ones, each followed by good ones.
fn matrices(pattern: &Pattern, first: &[f64]) -> Vec<Vec<f64>> {
    let n = pattern.n();
    let mut noise = Noise(22);
    let mut place = |most: usize| ((noise.next() + 1.0) * 0.5 * most as f64) as usize;
    let mut list = vec![first.to_vec(); 2];
    for round in 0..6 {
        let mut next = list[list.len() - 1].clone();
        let from = place(n - 40);
        // Eight equations, forty equations, one entry off the diagonal.
        match round % 3 {
            0 => shift(pattern, &mut next, from..from + 8, 1e-3),
            1 => shift(pattern, &mut next, from..from + 40, 1e-15),
            _ => {
                let (k, j) = (
                    pattern.col_ptr()[from],
                    pattern.row_idx()[pattern.col_ptr()[from]],
                );
                next[k] *= 1.0 + f64::EPSILON;
                let mirror = pattern.find(from, j as usize).unwrap();
                next[mirror] = next[k];
            }
        }
        list.push(next);
    }
    // Changes are reversed.
    list.push(list[3].clone());
    list.push(list[2].clone());
    for bad in [-500.0, f64::NAN] {
        let mut broken = list[2].clone();
        shift(pattern, &mut broken, n / 2..n / 2 + 1, bad);
        list.push(broken.clone());
        // Still not factorisable, with another value changed elsewhere.
        shift(pattern, &mut broken, 3..6, 0.25);
        list.push(broken);
        let mut good = list[2].clone();
        shift(pattern, &mut good, n - 9..n, 0.5);
        list.push(good);
    }
    // A node without any stiffness: singular.
    let mut broken = list[2].clone();
    for e in n / 3..n / 3 + 3 {
        for k in pattern.col_ptr()[e]..pattern.col_ptr()[e + 1] {
            broken[k] = 0.0;
            broken[pattern.find(e, pattern.row_idx()[k] as usize).unwrap()] = 0.0;
        }
    }
    list.push(broken);
    list.push(list[2].clone());
    list
}

#[test]
fn reused_factors_are_bitwise_those_of_a_complete_factorisation() {
    // Some twenty tasks, a front divided into pieces (see the test of threads), and a hundred units.
    let (pattern, values) = solid([18, 7, 18], 5.0, 0.0, 12);
    for backend in THREE {
        let list = matrices(&pattern, &values);
        let whole: Vec<_> = list
            .iter()
            .map(|values| {
                let mut fresh = LinearSolver::analyse(&pattern, Options::new(backend)).unwrap();
                outcome(&mut fresh, values).0
            })
            .collect();
        for threads in [1, 2, 4] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let saved = pool.build().unwrap().install(|| {
                let mut solver = LinearSolver::analyse(&pattern, Options::new(backend)).unwrap();
                let mut saved = Vec::new();
                for (round, (values, whole)) in list.iter().zip(&whole).enumerate() {
                    let (solved, share) = outcome(&mut solver, values);
                    assert!(
                        solved == *whole,
                        "{backend:?}, {threads} threads, round {round}"
                    );
                    saved.push(share);
                }
                saved
            });
            // The second matrix equals the first one. After the third one Schur complements are kept.
            assert_eq!(saved[..3], [0.0, 1.0, 0.0], "{backend:?}");
            // The last front contains changed nodes always; it is a quarter of all operations. Two of three changes
            // affect one plane of nodes at most.
            let least = saved[3..8].iter().fold(1.0, |a: f64, &b| a.min(b));
            assert!(least > 0.1, "{backend:?} {saved:?}");
        }
    }
}

#[test]
fn nothing_is_reused_of_matrices_that_change_everywhere() {
    let (pattern, mut values) = solid([9, 3, 10], 5.0, 0.0, 1);
    for backend in THREE {
        let mut solver = LinearSolver::analyse(&pattern, Options::new(backend)).unwrap();
        for _ in 0..3 {
            for a in &mut values {
                *a *= 1.01;
            }
            assert_eq!(solver.factorise(&values).unwrap().reused, 0.0);
        }
    }
}
