//! Tests of solutions with the factors of another matrix.

use super::stencils::{Noise, solid};
use super::{Backend, LinearSolver, Options, Pattern, dot};

/// A solid, and the same with part of its diagonal increased by the factor `by`, as for points that begin to stick.
fn beside(every: usize, by: f64) -> (Pattern, [Vec<f64>; 2]) {
    let (pattern, values) = solid([18, 9, 18], 5.0, 0.0, 12);
    let mut other = values.clone();
    for j in (0..pattern.n()).step_by(every) {
        other[pattern.find(j, j).unwrap()] *= 1.0 + by;
    }
    (pattern, [values, other])
}

fn rhs(n: usize) -> Vec<f64> {
    let mut noise = Noise(7);
    (0..n).map(|_| noise.next()).collect()
}

fn solver(pattern: &Pattern, values: &[f64], backend: Backend) -> LinearSolver {
    let mut solver = LinearSolver::analyse(pattern, Options::new(backend)).unwrap();
    solver.factorise(values).unwrap();
    solver
}

/// x = A⁻¹ b for any number of columns.
fn exact(pattern: &Pattern, values: &[f64], b: &[f64]) -> Vec<f64> {
    let mut x = b.to_vec();
    let mut solver = solver(pattern, values, Backend::MultifrontalLlt);
    solver.solve(&mut x).unwrap();
    x
}

/// ‖x − A⁻¹b‖ over ‖A⁻¹b‖, both in the norm of A: √(r·A⁻¹r / b·A⁻¹b) with r = b − A x.
fn error(pattern: &Pattern, values: &[f64], x: &[f64], b: &[f64]) -> f64 {
    let mut left = b.to_vec();
    for j in 0..pattern.n() {
        for e in pattern.col_ptr()[j]..pattern.col_ptr()[j + 1] {
            left[pattern.row_idx()[e] as usize] -= values[e] * x[j];
        }
    }
    let whole = dot(b, &exact(pattern, values, b));
    (dot(&left, &exact(pattern, values, &left)) / whole).sqrt()
}

#[test]
fn a_matrix_near_the_factorised_one_is_solved_to_a_twentieth() {
    let (pattern, [values, other]) = beside(97, 1.0);
    let n = pattern.n();
    for backend in [Backend::MixedLlt, Backend::MultifrontalLlt] {
        let mut solver = solver(&pattern, &values, backend);
        let both = rhs(2 * n);
        // Alone, together with another one, and with an almost exact estimate of the other one.
        let known = exact(&pattern, &values, &both[n..]);
        for (columns, guess) in [(1, &known[..0]), (2, &known[..0]), (2, &known[..])] {
            let b = &both[..columns * n];
            let mut x = b.to_vec();
            assert!(solver.solve_near(&other, &mut x, guess).unwrap());
            for (x, b) in x.chunks(n).zip(b.chunks(n)) {
                let found = error(&pattern, &other, x, b);
                // The residual is reduced to a twentieth in the norm of M⁻¹. A differs from M by little, so the
                // error in the norm of A is similar (0.031 to 0.044).
                assert!(found < 0.05, "{backend:?}: {found}");
            }
        }
    }
}

#[test]
fn a_distant_matrix_is_reported_and_the_vector_unchanged() {
    let (pattern, [values, other]) = beside(2, 1e6);
    let b = rhs(pattern.n());
    let refused = |solver: &mut LinearSolver, values: &[f64]| {
        let mut x = b.clone();
        !solver.solve_near(values, &mut x, &[]).unwrap() && x == b
    };
    let mut some = solver(&pattern, &values, Backend::MixedLlt);
    assert!(refused(&mut some, &other));
    // Not positive definite: a factorisation has to find the equation.
    let negative: Vec<f64> = values.iter().map(|a| -a).collect();
    assert!(refused(&mut some, &negative));
    assert!(some.factorise(&negative).is_err());
    assert!(refused(&mut some, &values), "no factors");
    let options = Options::new(Backend::MixedLlt);
    assert!(refused(
        &mut LinearSolver::analyse(&pattern, options).unwrap(),
        &values
    ));
    // L U reads both triangles. A small matrix is factorised as quickly.
    let mut lu = solver(&pattern, &values, Backend::MultifrontalLu);
    assert!(refused(&mut lu, &values));
    let (small, values) = solid([3, 3, 3], 5.0, 0.0, 12);
    let mut x = rhs(small.n());
    let mut small = solver(&small, &values, Backend::MixedLlt);
    assert!(!small.solve_near(&values, &mut x, &[]).unwrap());
    assert!(
        some.solve_near(&values, &mut x, &[])
            .is_ok_and(|found| !found)
    );
}

/// Fronts that an intermediate matrix has changed are recognised as stale.
#[test]
fn the_next_factorisation_has_the_bits_of_a_fresh_one() {
    let (pattern, [values, other]) = beside(97, 1.0);
    let third: Vec<f64> = values.iter().map(|a| 1.5 * a).collect();
    let b = rhs(pattern.n());
    let solve = |solver: &mut LinearSolver, values: &[f64]| {
        solver.factorise(values).unwrap();
        let mut x = b.clone();
        solver.solve(&mut x).unwrap();
        x
    };
    let bits = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut some = solver(&pattern, &values, Backend::MixedLlt);
            let mut near = b.clone();
            assert!(some.solve_near(&other, &mut near, &[]).unwrap());
            // The first matrix again, the intermediate one, and another.
            for next in [&values, &other, &third] {
                let mut x = b.clone();
                some.solve_near(&other, &mut x, &[]).unwrap();
                let fresh = solve(&mut solver(&pattern, &values, Backend::MixedLlt), next);
                assert!(solve(&mut some, next) == fresh);
            }
            near
        })
    };
    let serial = bits(1);
    assert!(bits(2) == serial && bits(4) == serial);
}
