//! The method against clarabel, on programs of random numbers.

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::{NonnegativeConeT, SecondOrderConeT, ZeroConeT};
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus};

use super::cones::{Cone, Shape};
use super::{Answer, End, solve};
use crate::limit::matrix::Matrix;

/// Numbers between -1 and 1, the same in each run.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        // Knuth's linear congruential generator.
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 33) as f64 / (1u64 << 30) as f64 - 1.0
    }
}

/// max λ with three equations for each of two bodies and eight corners, in cones of friction (n, t, t) or rays (n, t).
/// `loaded`: with a load that does not vanish.
fn program(seed: u64, round: bool, friction: f64, loaded: bool) -> Matrix {
    let mut numbers = Numbers(seed);
    let (equations, corners) = (6, 8);
    let width = if round { 3 } else { 2 };
    let columns = 1 + width * corners;
    let (mut rows, mut at, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut add = |row: usize, column: usize, value: f64| {
        rows.push(row);
        at.push(column);
        values.push(value);
    };
    for row in 0..equations {
        add(row, 0, numbers.next());
        for column in 1..columns {
            add(row, column, numbers.next());
        }
    }
    let load = if loaded { 1.0 } else { 0.0 };
    let mut right: Vec<f64> = (0..equations).map(|_| load * numbers.next()).collect();
    let mut cones = vec![ZeroConeT(equations)];
    for corner in 0..corners {
        let (column, row) = (1 + width * corner, right.len());
        if round {
            add(row, column, -friction);
            add(row + 1, column + 1, -1.0);
            add(row + 2, column + 2, -1.0);
            right.extend([0.1, 0.0, 0.0]);
            cones.push(SecondOrderConeT(3));
        } else {
            for (i, side) in [1.0, -1.0].into_iter().enumerate() {
                add(row + i, column, -friction);
                add(row + i, column + 1, side);
            }
            right.extend([0.1, 0.1]);
            cones.push(NonnegativeConeT(2));
        }
        // Crushing, so that the factor is bounded.
        add(right.len(), column, 1.0);
        right.push(1.0);
        cones.push(NonnegativeConeT(1));
    }
    Matrix {
        entries: CscMatrix::new_from_triplets(right.len(), columns, rows, at, values),
        right,
        cones,
    }
}

fn cost(program: &Matrix) -> Vec<f64> {
    let mut cost = vec![0.0; program.entries.n];
    cost[0] = -1.0;
    cost
}

fn own(program: &Matrix) -> Answer {
    let places = [[0.0; 3], [1.0, 0.0, 0.0]];
    let nodes = [0, 0, 0, 1, 1, 1];
    solve(program, &cost(program), (&nodes, &places), 1e-9).unwrap()
}

fn clarabel(program: &Matrix) -> (SolverStatus, f64) {
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .build()
        .unwrap();
    let columns = program.entries.n;
    let quadratic = CscMatrix::zeros((columns, columns));
    let mut solver = DefaultSolver::new(
        &quadratic,
        &cost(program),
        &program.entries,
        &program.right,
        &program.cones,
        settings,
    )
    .unwrap();
    solver.solve();
    (solver.solution.status, solver.solution.x[0])
}

#[test]
fn programs_have_the_solutions_of_clarabel() {
    for seed in 0..20 {
        for round in [false, true] {
            let program = program(seed, round, 0.6, true);
            let (status, known) = clarabel(&program);
            let found = own(&program);
            if status != SolverStatus::Solved {
                // Too large a load for these corners.
                assert_eq!(
                    (status, found.end),
                    (SolverStatus::PrimalInfeasible, End::Infeasible)
                );
                continue;
            }
            assert_eq!(found.end, End::Solved, "{seed} {round}");
            // Clarabel's own tolerance is 1e-8.
            let scale = known.abs().max(1.0);
            assert!((found.x[0] - known).abs() < 1e-6 * scale, "{seed} {round}");
            // Its multipliers bound the factor.
            assert!(
                (found.x[0] + found.bound).abs() < 1e-8 * scale,
                "{seed} {round}"
            );
        }
    }
}

#[test]
fn programs_without_solution_are_told_apart() {
    let mut too_much = program(1, true, 0.6, true);
    too_much.right[..6].iter_mut().for_each(|b| *b *= 1e3);
    // The factor would have to carry this load by itself: it cannot in six equations.
    assert_eq!(clarabel(&too_much).0, SolverStatus::PrimalInfeasible);
    assert_eq!(own(&too_much).end, End::Infeasible);
    let mut ends = Vec::new();
    for seed in 0..10 {
        let mut program = program(seed, false, 2.0, false);
        // Crushing strengths turned into tensile ones: n ≥ −1, so that forces may grow without bound.
        for entry in 0..program.entries.nzval.len() {
            let row = program.entries.rowval[entry];
            if row >= 6 && (row - 6) % 3 == 2 {
                program.entries.nzval[entry] = -1.0;
            }
        }
        let end = match clarabel(&program).0 {
            SolverStatus::DualInfeasible => End::Unbounded,
            SolverStatus::Solved => End::Solved,
            other => panic!("{other:?}"),
        };
        assert_eq!(own(&program).end, end, "{seed}");
        ends.push(end);
    }
    assert!(ends.contains(&End::Unbounded));
}

#[test]
fn scaling_and_products_of_cones_agree() {
    let (s, z) = ([2.0, 0.3, -1.2], [1.5, -0.7, 0.4]);
    let mut cone = Cone::new(Shape::Round, 0);
    assert!(cone.scale(&s, &z));
    let (mut left, mut right) = (z, s);
    cone.apply(&mut left);
    cone.unapply(&mut right);
    // W z = W⁻¹ s, to rounding.
    assert!(left.iter().zip(right).all(|(a, b)| (a - b).abs() < 1e-14));
    let product = cone.product(&left, &s);
    let back = cone.quotient(&left, &product);
    assert!(back.iter().zip(s).all(|(a, b)| (a - b).abs() < 1e-14));
    // The step to the boundary ends there.
    for d in [[-1.0, 0.2, 0.5], [0.1, 2.0, 1.0], [-3.0, 0.0, 0.0]] {
        let step = cone.step(&s, &d);
        let end = [0, 1, 2].map(|i| s[i] + step * d[i]);
        assert!(cone.depth(&end).abs() < 1e-13, "{d:?}");
    }
    assert_eq!(cone.step(&s, &[1.0, 0.5, 0.5]), f64::INFINITY);
}
