//! Tests of the change from single to double precision, and of the solutions of both.

use super::stencils::{Noise, solid};
use super::*;

/// A wall on ground of stiffness `ground`, where the stiffness of its edges is one. Softer ground gives a worse
/// condition number.
fn wall(ground: f64) -> (Pattern, Vec<f64>) {
    solid([9, 3, 10], ground, 0.0, 11)
}

fn rhs(n: usize) -> Vec<f64> {
    let mut noise = Noise(3);
    (0..n).map(|_| noise.next()).collect()
}

fn in_double(solver: &LinearSolver) -> bool {
    let Engine::Mixed(f) = &solver.engine else {
        panic!("of one precision");
    };
    assert!(!f.holds_both());
    f.in_double()
}

fn mixed(pattern: &Pattern) -> LinearSolver {
    LinearSolver::analyse(pattern, Options::new(Backend::MixedLlt)).unwrap()
}

#[test]
fn a_good_matrix_is_refined_from_single_precision() {
    let (pattern, values) = wall(5.0);
    let mut solver = mixed(&pattern);
    solver.factorise(&values).unwrap();
    let mut x = rhs(pattern.n());
    let report = solver.solve(&mut x).unwrap();
    assert!(!in_double(&solver));
    // One refinement follows from 6e-8 times the condition number of some 1e3. None would mean a factor of double
    // precision.
    assert!((1..=2).contains(&report.refinements), "{report:?}");
    assert!(report.relative <= 1e-5, "{report:?}");
}

#[test]
fn ill_conditioned_matrices_switch_to_double_precision_for_some_time() {
    let (pattern, good) = wall(5.0);
    let (_, bad) = wall(1e-7);
    let scaled = |values: &[f64]| -> Vec<f64> { values.iter().map(|a| 1.5 * a).collect() };
    let (other, worse) = (scaled(&good), scaled(&bad));
    let mut solver = mixed(&pattern);
    let mut double =
        LinearSolver::analyse(&pattern, Options::new(Backend::MultifrontalLlt)).unwrap();
    // The same target.
    double.options.target = solver.options.target;
    let mut solved = |solver: &mut LinearSolver, values: &[f64], expected: bool| {
        let kept = solver.factorise(values).unwrap().reused;
        let mut x = rhs(pattern.n());
        solver.solve(&mut x).unwrap();
        assert_eq!(in_double(solver), expected);
        assert_eq!(solver.distrusts_single(), expected);
        // The bits are those of one precision alone, independent of earlier matrices.
        let mut y = rhs(pattern.n());
        let alone = if expected {
            &mut double
        } else {
            &mut mixed(&pattern)
        };
        alone.factorise(values).unwrap();
        alone.solve(&mut y).unwrap();
        assert!(x == y);
        kept
    };
    for _ in 0..2 {
        solver.trust_single(true);
        solved(&mut solver, &good, false);
        solved(&mut solver, &bad, true);
        solved(&mut solver, &worse, true);
        solved(&mut solver, &good, true);
        // Factors of double precision are kept as well.
        assert_eq!(solved(&mut solver, &good, true), 1.0);
        // The same matrix again, but single precision is tried first.
        solver.trust_single(true);
        assert_eq!(solved(&mut solver, &good, false), 0.0);
        assert_eq!(solved(&mut solver, &good, false), 1.0);
        solved(&mut solver, &other, false);
        solver.trust_single(false);
        assert_eq!(solved(&mut solver, &other, true), 0.0);
    }
}

#[test]
fn verdicts_are_those_of_double_precision() {
    let (pattern, values) = wall(5.0);
    let mut indefinite = values.clone();
    indefinite[pattern.find(70, 70).unwrap()] -= 500.0;
    let (_, floating) = wall(0.0);
    let verdict = |backend, values: &[f64]| {
        let mut solver = LinearSolver::analyse(&pattern, Options::new(backend)).unwrap();
        let verdict = solver.factorise(values).unwrap_err();
        // The solver works again after an error.
        solver.factorise(&wall(5.0).1).unwrap();
        let mut x = rhs(pattern.n());
        solver.solve(&mut x).unwrap();
        (verdict, x)
    };
    for values in [&indefinite, &floating] {
        let (single, x) = verdict(Backend::MixedLlt, values);
        let (double, y) = verdict(Backend::MultifrontalLlt, values);
        assert_eq!(single, double);
        let scale = y.iter().fold(0.0, |m: f64, y| m.max(y.abs()));
        for (x, y) in x.iter().zip(&y) {
            // The condition number of some 1e3, times the error after refinement.
            assert!((x - y).abs() < 1e-4 * scale, "{x} {y}");
        }
    }
}

#[test]
fn numbers_beyond_the_range_of_single_precision_are_solved() {
    let (pattern, values) = wall(5.0);
    let mut solver = mixed(&pattern);
    let tiny: Vec<f64> = rhs(pattern.n()).iter().map(|x| x * 1e-200).collect();
    for (factor, expected) in [(1.0, false), (1e60, true)] {
        let values: Vec<f64> = values.iter().map(|a| a * factor).collect();
        solver.factorise(&values).unwrap();
        let mut x = tiny.clone();
        let report = solver.solve(&mut x).unwrap();
        assert!(report.relative <= 1e-5, "{factor:e}: {report:?}");
        assert_eq!(in_double(&solver), expected, "{factor:e}");
    }
}
