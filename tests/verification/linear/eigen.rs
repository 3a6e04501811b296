//! The eigenvalue solver against the closed form of a grid, with equal eigenvalues, free motion and negative ones.

use wythe::linear::eigen::{EigenError, Lowest, MassMatrix, lowest};
use wythe::linear::{Backend, LinearSolver, Options, Pattern};

/// K of springs between neighbours of a chain, with `ends` held or free; entries in compressed columns.
struct Chain {
    pattern: Pattern,
    values: Vec<f64>,
}

/// Grid of n × n points: K = 4 on the diagonal and −1 between neighbours, which is held at its rim.
fn grid(n: usize, diagonal: impl Fn(usize) -> f64) -> Chain {
    let (mut col_ptr, mut row_idx, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..n * n {
        let (x, y) = (j % n, j / n);
        let mut rows = vec![(j, diagonal(j))];
        if x > 0 {
            rows.push((j - 1, -1.0));
        }
        if x + 1 < n {
            rows.push((j + 1, -1.0));
        }
        if y > 0 {
            rows.push((j - n, -1.0));
        }
        if y + 1 < n {
            rows.push((j + n, -1.0));
        }
        rows.sort_by_key(|(i, _)| *i);
        for (i, value) in rows {
            row_idx.push(i as u32);
            values.push(value);
        }
        col_ptr.push(row_idx.len());
    }
    Chain {
        pattern: Pattern::new(n * n, col_ptr, row_idx).unwrap(),
        values,
    }
}

fn solve(chain: &Chain, mass: &[f64], wanted: usize) -> Result<Lowest, EigenError> {
    let options = Options::new(Backend::MultifrontalLlt);
    let mut solver = LinearSolver::analyse(&chain.pattern, options).unwrap();
    let mass = MassMatrix {
        diagonal: mass.to_vec(),
        below: Vec::new(),
    };
    lowest(&mut solver, &chain.values, &mass, wanted)
}

/// K x.
fn times(chain: &Chain, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    for j in 0..x.len() {
        for k in chain.pattern.col_ptr()[j]..chain.pattern.col_ptr()[j + 1] {
            y[chain.pattern.row_idx()[k] as usize] += chain.values[k] * x[j];
        }
    }
    y
}

/// Residuals ‖K x − λ M x‖ / ‖K‖ and products xᵀ M y.
fn check(chain: &Chain, mass: &[f64], found: &Lowest) {
    for (a, pair) in found.pairs.iter().enumerate() {
        let image = times(chain, &pair.vector);
        let rest = image.iter().zip(&pair.vector).zip(mass);
        let rest = rest.map(|((k, x), m)| (k - pair.value * m * x).powi(2));
        // Bound of the solver, over the largest eigenvalue 8.
        assert!(rest.sum::<f64>().sqrt() < 1e-5, "pair {a}");
        for (b, other) in found.pairs.iter().enumerate() {
            let terms = pair.vector.iter().zip(&other.vector).zip(mass);
            let product: f64 = terms.map(|((x, y), m)| x * y * m).sum();
            // Rounding.
            assert!(
                (product - f64::from(u8::from(a == b))).abs() < 1e-11,
                "{a} {b}"
            );
        }
    }
}

/// Eigenvalues 4 − 2 cos(iπ/(n+1)) − 2 cos(jπ/(n+1)), sorted.
fn closed(n: usize) -> Vec<f64> {
    let one = |i: usize| 2.0 - 2.0 * (i as f64 * std::f64::consts::PI / (n + 1) as f64).cos();
    let mut all: Vec<f64> = (1..=n)
        .flat_map(|i| (1..=n).map(move |j| one(i) + one(j)))
        .collect();
    all.sort_by(f64::total_cmp);
    all
}

#[test]
fn a_grid_has_its_eigenvalues_the_equal_ones_as_often_as_they_are() {
    let chain = grid(30, |_| 4.0);
    let mass = vec![1.0; 900];
    let found = solve(&chain, &mass, 12).unwrap();
    check(&chain, &mass, &found);
    for (pair, closed) in found.pairs.iter().zip(closed(30)) {
        // The square of the residual, and rounding over the smallest eigenvalue.
        assert!(
            (pair.value / closed - 1.0).abs() < 1e-10,
            "{} {closed}",
            pair.value
        );
    }
    println!("{} solves", found.solves);
}

/// Rods side by side with the consistent mass of linear elements, M = 1 ⊗ (1, 4, 1)/6, which has the eigenvectors of K.
#[test]
fn masses_may_couple_the_equations() {
    let n = 20;
    let chain = grid(n, |_| 4.0);
    let neighbours = (0..n * n).filter(|j| j % n > 0);
    let mass = MassMatrix {
        diagonal: vec![4.0 / 6.0; n * n],
        // In two parts.
        below: neighbours
            .flat_map(|j| [1.0 / 24.0, 3.0 / 24.0].map(|m| (j as u32, j as u32 - 1, m)))
            .collect(),
    };
    let cosine = |i: usize| (i as f64 * std::f64::consts::PI / (n + 1) as f64).cos();
    let pairs = (1..=n).flat_map(|i| (1..=n).map(move |j| (cosine(i), cosine(j))));
    let mut closed: Vec<f64> = pairs
        .map(|(a, b)| (4.0 - 2.0 * a - 2.0 * b) / ((4.0 + 2.0 * a) / 6.0))
        .collect();
    closed.sort_by(f64::total_cmp);
    // A few by the block method, all by a basis of all vectors.
    for wanted in [10, n * n] {
        let options = Options::new(Backend::MultifrontalLlt);
        let mut solver = LinearSolver::analyse(&chain.pattern, options).unwrap();
        let found = lowest(&mut solver, &chain.values, &mass, wanted).unwrap();
        assert_eq!(found.pairs.len(), wanted);
        for (pair, closed) in found.pairs.iter().zip(&closed) {
            // The square of the residual, and rounding over the smallest eigenvalue.
            assert!((pair.value / closed - 1.0).abs() < 1e-10, "{}", pair.value);
        }
    }
    // 1ᵀ M⁻¹ 1 from the sine series of each rod: Σ (Σ_j √(2/(n+1)) sin)² / m_i.
    let of_rod = (1..=n).map(|i| {
        let terms =
            (1..=n).map(|j| (i as f64 * j as f64 * std::f64::consts::PI / (n + 1) as f64).sin());
        let sum = terms.sum::<f64>() * (2.0 / (n + 1) as f64).sqrt();
        sum * sum / ((4.0 + 2.0 * cosine(i)) / 6.0)
    });
    let closed = n as f64 * of_rod.sum::<f64>();
    let product = mass.inverse_product(&vec![1.0; n * n]);
    // Bound of the conjugate gradients, and rounding.
    assert!((product / closed - 1.0).abs() < 1e-11, "{product} {closed}");
}

#[test]
fn masses_scale_the_problem() {
    let chain = grid(12, |_| 4.0);
    let mass: Vec<f64> = (0..144).map(|i| 1e-6 * (2.0 + (i as f64).sin())).collect();
    let found = solve(&chain, &mass, 9).unwrap();
    let whole = solve(&chain, &mass, 144).unwrap();
    check(&chain, &mass, &whole);
    for (few, all) in found.pairs.iter().zip(&whole.pairs) {
        // The square of the residual.
        assert!((few.value / all.value - 1.0).abs() < 1e-10);
    }
    // The trace of M⁻¹ K.
    let trace: f64 = mass.iter().map(|m| 4.0 / m).sum();
    let sum: f64 = whole.pairs.iter().map(|pair| pair.value).sum();
    assert!((sum / trace - 1.0).abs() < 1e-12);
}

#[test]
fn free_and_negative_eigenvalues_are_found_by_a_lower_shift() {
    let n = 12;
    let neighbours = |j: usize| {
        let (x, y) = (j % n, j / n);
        [x > 0, x + 1 < n, y > 0, y + 1 < n]
            .into_iter()
            .filter(|there| *there)
            .count() as f64
    };
    let mass = vec![1.0; n * n];
    let free = solve(&grid(n, neighbours), &mass, 3).unwrap();
    // Rounding.
    assert!(free.pairs[0].value.abs() < 1e-5 * free.shift.abs());
    assert!(free.pairs[1].value > 0.01);
    // Shifted by −1e-4, which is below the first shift.
    let shifted = grid(n, |j| neighbours(j) - 1e-4);
    let negative = solve(&shifted, &mass, 3).unwrap();
    assert!((negative.pairs[0].value + 1e-4).abs() < 1e-9);
    check(&shifted, &mass, &negative);
    // A matrix far from positive definite has no shift.
    let wrong = solve(&grid(n, |_| -4.0), &mass, 1).unwrap_err();
    assert!(matches!(wrong, EigenError::Linear(_)), "{wrong}");
    let light = solve(&grid(n, |_| 4.0), &vec![0.0; n * n], 1).unwrap_err();
    assert_eq!(light, EigenError::NoMass { equation: 0 });
}
