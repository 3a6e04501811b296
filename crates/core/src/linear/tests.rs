//! All back ends compared with dense L U.

use faer::prelude::Solve;
use faer::{Mat, MatRef};

use super::stencils::{Case, Noise, assemble, solid};
use super::*;

const ALL: [Backend; 5] = [
    Backend::MultifrontalLlt,
    Backend::MixedLlt,
    Backend::MultifrontalLu,
    Backend::FaerLlt,
    Backend::FaerLu,
];

/// Dense matrix with the values that the kind reads.
fn dense(pattern: &Pattern, values: &[f64], kind: Kind) -> Mat<f64> {
    let mut a = Mat::zeros(pattern.n(), pattern.n());
    for j in 0..pattern.n() {
        for k in pattern.col_ptr()[j]..pattern.col_ptr()[j + 1] {
            let i = pattern.row_idx()[k] as usize;
            match kind {
                Kind::Unsymmetric => a[(i, j)] = values[k],
                Kind::Symmetric if i >= j => {
                    a[(i, j)] = values[k];
                    a[(j, i)] = values[k];
                }
                Kind::Symmetric => {}
            }
        }
    }
    a
}

fn rhs(n: usize, columns: usize) -> Vec<f64> {
    let mut noise = Noise(7);
    (0..n * columns).map(|_| noise.next()).collect()
}

/// Largest difference relative to the largest reference value.
fn distance(x: &[f64], reference: &[f64]) -> f64 {
    let scale = reference
        .iter()
        .fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
    x.iter()
        .zip(reference)
        .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
        / scale
}

fn compare(case: &Case, options: Options, columns: usize) {
    // Refinement to the limit, for single precision as well.
    let options = Options {
        target: 1e-14,
        ..options
    };
    let n = case.pattern.n();
    let mut solver = LinearSolver::analyse(&case.pattern, options).unwrap();
    let a = dense(&case.pattern, &case.values, options.backend.kind());
    let b = rhs(n, columns);
    let reference = a
        .partial_piv_lu()
        .solve(MatRef::from_column_major_slice(&b, n, columns));
    let reference: Vec<f64> = (0..columns)
        .flat_map(|j| (0..n).map(move |i| (i, j)))
        .map(|ij| reference[ij])
        .collect();
    // Twice, because the second factorisation must not depend on data of the first.
    for _ in 0..2 {
        solver.factorise(&case.values).unwrap();
        let mut x = b.clone();
        let report = solver.solve(&mut x).unwrap();
        let d = distance(&x, &reference);
        // Condition numbers here are below 1e5; rounding errors of 2e-16 occur in dense L U and here.
        assert!(
            d < 1e-10,
            "{} {:?}: {d:e}, {report:?}",
            case.name,
            options.backend
        );
    }
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name, (pattern, values)| {
        cases.push(Case {
            name,
            pattern,
            values,
        });
    };
    for (name, n) in [("1", 1), ("2", 2), ("3", 3), ("4", 4), ("5", 5)] {
        let all: Vec<Vec<usize>> = vec![(0..n).collect(); n];
        let here = vec![[0.0; 3]; n];
        let value = &mut |i: usize, j: usize| if i == j { 4.0 } else { -0.3 / (i + j) as f64 };
        add(name, assemble(&all, 1, &here, value));
    }
    add("wall", solid([9, 3, 10], 5.0, 0.0, 1));
    add("cube", solid([6, 6, 6], 5.0, 0.0, 2));
    add("skew wall", solid([9, 3, 10], 5.0, 1e-3, 3));
    add("blocks", blocks());
    add("arrow", arrow(40));
    add("empty", (Pattern::new(0, vec![0], vec![]).unwrap(), vec![]));
    add("level beam", beam(5.0));
    cases
}

/// One equation coupled to all others, which are coupled to nothing else.
fn arrow(n: usize) -> (Pattern, Vec<f64>) {
    let mut lists: Vec<Vec<usize>> = vec![vec![0]; n];
    lists[0] = (0..n).collect();
    assemble(&lists, 1, &[], &mut |i, j| match (i, j) {
        (0, 0) => n as f64,
        _ if i == j => 3.0,
        _ => 0.7 / (1 + i) as f64 - 0.2 / (1 + j) as f64,
    })
}

/// Two grids and a single node without couplings between them.
fn blocks() -> (Pattern, Vec<f64>) {
    let (a, av) = solid([4, 3, 3], 5.0, 1e-3, 4);
    let (b, bv) = solid([3, 3, 5], 5.0, 1e-3, 5);
    let shift = a.n() as u32;
    let mut col_ptr = a.col_ptr().to_vec();
    let mut row_idx = a.row_idx().to_vec();
    col_ptr.extend(b.col_ptr()[1..].iter().map(|p| p + a.nnz()));
    row_idx.extend(b.row_idx().iter().map(|r| r + shift));
    row_idx.push(shift + b.n() as u32);
    col_ptr.push(row_idx.len());
    let n = a.n() + b.n() + 1;
    (
        Pattern::new(n, col_ptr, row_idx).unwrap(),
        [av, bv, vec![2.0]].concat(),
    )
}

/// A grid whose top is kept level by one additional equation, which couples with every node of the top.
fn beam(ground: f64) -> (Pattern, Vec<f64>) {
    let nodes = [12, 3, 6];
    let (body, values) = solid(nodes, ground, 1e-3, 6);
    let n = body.n();
    let top = |i: usize| i < n && i >= n - 3 * nodes[0] * nodes[1];
    let (mut col_ptr, mut row_idx, mut out) = (vec![0], Vec::new(), Vec::new());
    for j in 0..n {
        let range = body.col_ptr()[j]..body.col_ptr()[j + 1];
        row_idx.extend_from_slice(&body.row_idx()[range.clone()]);
        out.extend_from_slice(&values[range]);
        if top(j) {
            row_idx.push(n as u32);
            out.push(-0.05);
        }
        col_ptr.push(row_idx.len());
    }
    for j in (0..n).filter(|&j| top(j)) {
        row_idx.push(j as u32);
        out.push(-0.05);
    }
    row_idx.push(n as u32);
    out.push(8.0);
    col_ptr.push(row_idx.len());
    // The shared equation is a node of its own, without coordinates.
    let node: Vec<u32> = (0..=n).map(|j| (j / 3) as u32).collect();
    let (_, mut places) = crate::linear::stencils::grid(nodes);
    places.push([f64::NAN; 3]);
    let pattern = Pattern::new(n + 1, col_ptr, row_idx).unwrap();
    (pattern.with_nodes(&node, &places).unwrap(), out)
}

#[test]
fn every_back_end_agrees_with_dense_lu() {
    for case in cases() {
        for backend in ALL {
            for columns in [1, 3] {
                compare(&case, Options::new(backend), columns);
            }
        }
    }
}

#[test]
fn every_ordering_gives_the_same_solution() {
    for case in cases() {
        for backend in ALL {
            for ordering in [Ordering::Natural, Ordering::Amd, Ordering::Dissection] {
                let options = Options {
                    ordering,
                    ..Options::new(backend)
                };
                compare(&case, options, 1);
            }
        }
    }
}

#[test]
fn the_solution_has_the_same_bits_on_any_number_of_threads() {
    // Large enough for a few tasks (at least 5e6 operations each) and for a last front of 18 × 7 nodes, with 378³/3
    // = 1.8e7 operations, that is divided into pieces.
    let (pattern, values) = solid([18, 7, 18], 5.0, 1e-3, 12);
    for backend in [
        Backend::MultifrontalLlt,
        Backend::MixedLlt,
        Backend::MultifrontalLu,
    ] {
        let solve = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let mut solver = LinearSolver::analyse(&pattern, Options::new(backend)).unwrap();
                assert!(solver.stats().flops > 5e7, "{:e}", solver.stats().flops);
                solver.factorise(&values).unwrap();
                let mut x = rhs(pattern.n(), 2);
                solver.solve(&mut x).unwrap();
                x.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
            })
        };
        let serial = solve(1);
        for threads in [2, 4] {
            assert!(solve(threads) == serial, "{backend:?} on {threads} threads");
        }
    }
}

#[test]
fn an_analysis_is_reused_only_for_an_identical_pattern() {
    let (pattern, values) = solid([4, 3, 5], 5.0, 1e-3, 12);
    let options = Options::new(Backend::MixedLlt);
    let mut first = LinearSolver::analyse(&pattern, options).unwrap();
    let known = first.analysis().cloned();
    let beside = |pattern: &Pattern, options| {
        LinearSolver::analyse_beside(pattern.clone(), options, known.as_ref()).unwrap()
    };
    let shares = |solver: &LinearSolver| {
        let (a, b) = (solver.analysis().unwrap(), known.as_ref().unwrap());
        Arc::ptr_eq(&a.plan, &b.plan)
    };
    // Another precision with the same triangle, too.
    let double = Options::new(Backend::MultifrontalLlt);
    assert!(shares(&beside(&pattern, double)));
    assert!(!shares(&beside(
        &pattern,
        Options::new(Backend::MultifrontalLu)
    )));
    let mut places = pattern.coordinates().unwrap().to_vec();
    places[7][1] += 1e-9;
    let moved = pattern.clone().with_nodes(pattern.group(), &places);
    assert!(!shares(&beside(&moved.unwrap(), options)));
    let (other, _) = solid([4, 5, 3], 5.0, 1e-3, 12);
    assert!(!shares(&beside(&other, options)));

    let mut second = beside(&pattern, options);
    assert!(shares(&second));
    let solve = |solver: &mut LinearSolver| {
        solver.factorise(&values).unwrap();
        let mut x = rhs(pattern.n(), 1);
        solver.solve(&mut x).unwrap();
        x
    };
    assert!(solve(&mut second) == solve(&mut first));
}

#[test]
fn dissection_does_not_depend_on_the_orientation_of_the_mesh() {
    let (pattern, _) = solid([14, 14, 14], 5.0, 0.0, 13);
    let places = pattern.coordinates().unwrap().to_vec();
    let node: Vec<u32> = (0..pattern.n()).map(|j| (j / 3) as u32).collect();
    let mut noise = Noise(6);
    // Rotated by 0.5 about z and 0.7 about x. Then nodes are moved by up to a tenth of their distance.
    let turned = places.iter().map(|x| {
        let ((s, c), (t, d)) = (0.5f64.sin_cos(), 0.7f64.sin_cos());
        let y = [c * x[0] - s * x[1], s * x[0] + c * x[1], x[2]];
        [y[0], d * y[1] - t * y[2], t * y[1] + d * y[2]]
    });
    let turned: Vec<[f64; 3]> = turned.collect();
    let moved: Vec<[f64; 3]> = turned
        .iter()
        .map(|x| x.map(|x| x + 0.1 * noise.next()))
        .collect();
    let flops = |places: &[[f64; 3]]| {
        let pattern = pattern.clone().with_nodes(&node, places).unwrap();
        let options = Options::new(Backend::MultifrontalLlt);
        let solver = LinearSolver::analyse(&pattern, options).unwrap();
        solver.stats().flops
    };
    let straight = flops(&places);
    for askew in [flops(&turned), flops(&moved)] {
        // Cuts across the axes would cost two to three times as much. Leaves differ a little.
        assert!(askew < 1.1 * straight, "{askew:e} {straight:e}");
    }
}

#[test]
fn nested_dissection_of_a_cube_costs_less_than_minimum_degree() {
    let (pattern, _) = solid([14, 14, 14], 5.0, 0.0, 13);
    let flops = |ordering| {
        let options = Options {
            ordering,
            ..Options::new(Backend::MultifrontalLlt)
        };
        let solver = LinearSolver::analyse(&pattern, options).unwrap();
        solver.stats().flops
    };
    let (natural, amd, cut) = (
        flops(Ordering::Natural),
        flops(Ordering::Amd),
        flops(Ordering::Dissection),
    );
    assert!(cut < amd && amd < natural, "{cut:e} {amd:e} {natural:e}");
}

#[test]
fn a_floating_body_is_reported_never_solved() {
    for (nodes, backend) in [[8, 3, 8], [3, 3, 40], [10, 10, 10]]
        .into_iter()
        .flat_map(|nodes| ALL.map(|backend| (nodes, backend)))
    {
        let (pattern, values) = solid(nodes, 0.0, 0.0, 9);
        let mut solver = LinearSolver::analyse(&pattern, Options::new(backend)).unwrap();
        match solver.factorise(&values) {
            Err(
                LinearError::Singular { equation } | LinearError::NotPositiveDefinite { equation },
            ) => assert!(equation < pattern.n()),
            other => panic!("{backend:?}: {other:?}"),
        }
        let mut x = rhs(pattern.n(), 1);
        assert_eq!(solver.solve(&mut x), Err(LinearError::NotFactorised));
    }
}

#[test]
fn an_indefinite_matrix_is_rejected_by_cholesky_and_solved_by_lu() {
    let (pattern, mut values) = solid([4, 3, 4], 5.0, 0.0, 10);
    let entry = pattern.find(70, 70).unwrap();
    values[entry] -= 500.0;
    for backend in ALL {
        let mut solver = LinearSolver::analyse(&pattern, Options::new(backend)).unwrap();
        let result = solver.factorise(&values);
        match backend.kind() {
            Kind::Symmetric => {
                assert!(
                    matches!(result, Err(LinearError::NotPositiveDefinite { .. })),
                    "{result:?}"
                );
            }
            Kind::Unsymmetric => {
                result.unwrap();
                solver.solve(&mut rhs(pattern.n(), 1)).unwrap();
            }
        }
    }
}

#[test]
fn lu_pivots_within_a_front() {
    // Saddle point: the diagonal entry of the multiplier is zero, in either order.
    let pattern = Pattern::new(2, vec![0, 2, 4], vec![0, 1, 0, 1]).unwrap();
    for values in [[0.0, 1.0, 1.0, 2.0], [2.0, 1.0, 1.0, 0.0]] {
        let options = Options::new(Backend::MultifrontalLu);
        let mut solver = LinearSolver::analyse(&pattern, options).unwrap();
        solver.factorise(&values).unwrap();
        // x = (3, 4).
        let mut x = [
            3.0 * values[0] + 4.0 * values[2],
            3.0 * values[1] + 4.0 * values[3],
        ];
        solver.solve(&mut x).unwrap();
        // Two rounding errors of numbers of this size.
        assert!(
            (x[0] - 3.0).abs() < 4e-15 && (x[1] - 4.0).abs() < 4e-15,
            "{x:?}"
        );
    }
}

#[test]
fn a_matrix_that_needs_pivots_from_other_fronts_uses_the_fallback() {
    // Three blocks without stiffness of their own, each coupled with its part of a fourth block. They are too large
    // to be merged with it, and singular in their own fronts.
    let (parts, size) = (3, 40);
    let part = |i: usize| i / size;
    let half = parts * size;
    let coupled = |a: usize, b: usize| part(a) % parts == part(b) % parts || a.min(b) >= half;
    let lists: Vec<Vec<usize>> = (0..2 * half)
        .map(|i| (0..2 * half).filter(|&j| coupled(i, j)).collect())
        .collect();
    let mut noise = Noise(14);
    let (pattern, values) = assemble(&lists, 1, &[], &mut |i, j| {
        if i.max(j) < half {
            0.0
        } else if i % half == j % half {
            30.0
        } else {
            noise.next()
        }
    });
    let options = Options::new(Backend::MultifrontalLu);
    let plan = Plan::analyse(&pattern, options.ordering, Kind::Unsymmetric).unwrap();
    let mut fronts = Multifrontal::<f64>::new(Arc::new(plan), &pattern).unwrap();
    let sums = vec![1.0; pattern.n()];
    assert!(matches!(
        fronts.factorise(&values, &sums),
        Err(LinearError::Singular { equation }) if equation < half
    ));
    let case = Case {
        name: "saddle",
        pattern,
        values,
    };
    compare(&case, options, 2);
}

#[test]
fn bad_numbers_and_lengths_are_named() {
    let (pattern, mut values) = solid([3, 3, 3], 5.0, 0.0, 11);
    for backend in ALL {
        let mut solver = LinearSolver::analyse(&pattern, Options::new(backend)).unwrap();
        assert!(matches!(
            solver.factorise(&values[1..]),
            Err(LinearError::Length { .. })
        ));
        let entry = pattern.find(40, 7).unwrap();
        let good = std::mem::replace(&mut values[entry], f64::NAN);
        let refused = solver.factorise(&values);
        assert!(
            matches!(refused, Err(LinearError::NotFinite { equation: 40 | 7 })),
            "{refused:?}"
        );
        values[entry] = good;
        solver.factorise(&values).unwrap();
        let mut x = rhs(pattern.n(), 1);
        assert!(matches!(
            solver.solve(&mut x[1..]),
            Err(LinearError::Length { .. })
        ));
        x[5] = f64::INFINITY;
        assert_eq!(
            solver.solve(&mut x),
            Err(LinearError::NotFinite { equation: 5 })
        );
    }
}
