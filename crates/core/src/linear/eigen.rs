//! The lowest pairs of K x = λ M x with symmetric K and M, both sparse, M > 0 (docs/theory/vibration.md, eqs 3 to 6).
//!
//! K − σ M is factorised once at a shift σ < 0 below all eigenvalues. A block of vectors X is improved by rounds:
//!
//! ```text
//! W = (K − σ M)⁻¹ M X                       one solve a vector
//! V = [X, W, (K − σ M)⁻¹ M W, …]            M-orthonormal, each block twice against all before
//! Vᵀ (K − σ M) V S = S Θ,   X ← V S,   λ = σ + θ
//! ```
//!
//! That is block Lanczos by shift and inversion with full orthogonalisation and restarts. The block has more vectors
//! than pairs are wanted, so that equal eigenvalues, as of a square beam or a free body, are all found.

use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use super::{LinearError, LinearSolver, dot};

/// −σ over the largest k_ii/m_ii. Larger than the rounding errors of K over M, smaller than what vibrates.
const SHIFT: f64 = 1e-9;
/// Growth of −σ where K − σ M is not positive definite.
const LOWER: f64 = 100.0;
/// Most attempts to find a shift.
const ATTEMPTS: usize = 4;
/// Largest relative residual of a pair: ‖(λ − σ) (K − σ M)⁻¹ M x − x‖_M. The eigenvalue errs by its square.
const TOLERANCE: f64 = 1e-6;
/// The same where rounds no longer reduce it: rounding of the largest eigenvalues over the shift. It remains at the
/// motions of free bodies, whose eigenvalues are zero.
const ROUNDED: f64 = 1e-5;
/// Blocks of a round.
const DEPTH: usize = 4;
/// Most rounds.
const ROUNDS: usize = 60;
/// Vectors beyond those wanted.
const SPARE: usize = 6;
/// Part of a vector that must be left by orthogonalisation if it is to count as independent.
const INDEPENDENT: f64 = 1e-10;

/// An eigenvalue and its vector.
#[derive(Clone, Debug)]
pub struct EigenPair {
    /// λ.
    pub value: f64,
    /// x with xᵀ M x = 1. `[equation]`
    pub vector: Vec<f64>,
    /// ‖(λ − σ) (K − σ M)⁻¹ M x − x‖_M, a bound of the relative error of λ − σ.
    pub residual: f64,
}

/// A symmetric positive definite matrix M whose entries lie in the pattern of the solver.
#[derive(Clone, Debug)]
pub struct MassMatrix {
    /// m_ii. `[equation]`
    pub diagonal: Vec<f64>,
    /// (row, column, part of m_ij) below the diagonal. An entry is the sum of its parts.
    pub below: Vec<(u32, u32, f64)>,
}

impl MassMatrix {
    /// M x.
    fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut y: Vec<f64> = x.iter().zip(&self.diagonal).map(|(x, m)| x * m).collect();
        for &(row, column, m) in &self.below {
            let [row, column] = [row as usize, column as usize];
            y[row] += m * x[column];
            y[column] += m * x[row];
        }
        y
    }

    /// bᵀ M⁻¹ b, by conjugate gradients: M is well conditioned.
    pub fn inverse_product(&self, b: &[f64]) -> f64 {
        /// Most iterations.
        const ITERATIONS: usize = 1000;
        /// Largest residual of the equations beside b.
        const RESIDUAL: f64 = 1e-12;
        let scaled = |r: &[f64]| -> Vec<f64> {
            let all = r.iter().zip(&self.diagonal);
            all.map(|(r, m)| r / m).collect()
        };
        let (mut x, mut r) = (vec![0.0; b.len()], b.to_vec());
        let mut z = scaled(&r);
        let mut direction = z.clone();
        let mut size = dot(&r, &z);
        let enough = RESIDUAL * RESIDUAL * size;
        for _ in 0..ITERATIONS {
            if size <= enough {
                break;
            }
            let image = self.times(&direction);
            let step = size / dot(&direction, &image);
            for i in 0..x.len() {
                x[i] += step * direction[i];
                r[i] -= step * image[i];
            }
            z = scaled(&r);
            let next = dot(&r, &z);
            for (d, z) in direction.iter_mut().zip(&z) {
                *d = z + next / size * *d;
            }
            size = next;
        }
        dot(&x, b)
    }
}

/// The lowest pairs.
#[derive(Clone, Debug)]
pub struct Lowest {
    /// Pairs, the lowest first.
    pub pairs: Vec<EigenPair>,
    /// σ. Eigenvalues smaller than a small part of it in magnitude are zero.
    pub shift: f64,
    /// Number of solved right-hand sides.
    pub solves: usize,
}

/// Errors of the eigenvalue solver.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EigenError {
    /// An entry of M is not above zero.
    #[error("equation {equation} has no mass")]
    NoMass {
        /// The equation.
        equation: usize,
    },
    /// K − σ M could not be factorised or solved.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// The residuals did not fall below the tolerance.
    #[error(
        "the eigenvalues did not converge: a residual of {residual:.1e} is left after {rounds} rounds"
    )]
    NotConverged {
        /// Largest residual of the wanted pairs.
        residual: f64,
        /// Number of rounds.
        rounds: usize,
    },
}

/// The `wanted` lowest pairs of K x = λ M x, or all if there are fewer.
///
/// `stiffness` `[entry]`: values of K in the order of the pattern of `solver`, which must read the symmetric half. The
/// solver ends with the factors of K − σ M.
///
/// # Errors
/// [`EigenError`].
pub fn lowest(
    solver: &mut LinearSolver,
    stiffness: &[f64],
    mass: &MassMatrix,
    wanted: usize,
) -> Result<Lowest, EigenError> {
    let nothing = |m: &f64| m.is_nan() || *m <= 0.0;
    if let Some(equation) = mass.diagonal.iter().position(nothing) {
        return Err(EigenError::NoMass { equation });
    }
    let n = mass.diagonal.len();
    let wanted = wanted.min(n);
    if wanted == 0 {
        return Ok(Lowest {
            pairs: Vec::new(),
            shift: 0.0,
            solves: 0,
        });
    }
    let shift = factorise(solver, stiffness, mass)?;
    let width = (wanted + SPARE.max(wanted / 2)).min(n);
    let mut search = Search {
        solver,
        mass,
        n,
        solves: 0,
    };
    // Where a basis of all vectors leaves rounding errors of the largest eigenvalues, the next rounds remove them.
    let mut basis = if DEPTH * width >= n {
        search.all()
    } else {
        search.begin(width)
    };
    let (mut worst, mut before) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..ROUNDS {
        let found = search.ritz(&basis, width);
        let next = search.invert(&found.vectors)?;
        let pairs = search.pairs(&found, &next, shift);
        worst = pairs[..wanted]
            .iter()
            .map(|p| p.residual)
            .fold(0.0, f64::max);
        let stays = worst <= ROUNDED && worst > 0.5 * before;
        before = worst;
        if worst <= TOLERANCE || stays {
            return Ok(Lowest {
                pairs: pairs.into_iter().take(wanted).collect(),
                shift,
                solves: search.solves,
            });
        }
        basis = search.grow(found.vectors, next)?;
    }
    Err(EigenError::NotConverged {
        residual: worst,
        rounds: ROUNDS,
    })
}

/// Factorises K − σ M at a shift below all eigenvalues and returns σ.
fn factorise(
    solver: &mut LinearSolver,
    stiffness: &[f64],
    mass: &MassMatrix,
) -> Result<f64, EigenError> {
    let pattern = solver.pattern();
    let find = |(row, column, m): (usize, usize, f64)| Some((pattern.find(row, column)?, m));
    let diagonal = mass.diagonal.iter().enumerate();
    let diagonal: Vec<_> = diagonal.filter_map(|(i, m)| find((i, i, *m))).collect();
    let below = mass.below.iter();
    let below = below.filter_map(|(i, j, m)| find((*i as usize, *j as usize, *m)));
    let entries: Vec<_> = diagonal.iter().copied().chain(below).collect();
    let ratios = diagonal.iter();
    let largest = ratios.map(|(k, m)| stiffness.get(*k).map_or(0.0, |k| k / m));
    let mut shift = -SHIFT * largest.fold(f64::MIN_POSITIVE, f64::max);
    let mut attempt = 1;
    loop {
        let mut values = stiffness.to_vec();
        for (k, m) in &entries {
            if let Some(value) = values.get_mut(*k) {
                *value -= shift * m;
            }
        }
        match solver.factorise(&values) {
            Ok(_) => return Ok(shift),
            Err(LinearError::NotPositiveDefinite { .. } | LinearError::Singular { .. })
                if attempt < ATTEMPTS =>
            {
                attempt += 1;
                shift *= LOWER;
            }
            Err(why) => return Err(why.into()),
        }
    }
}

/// Best approximations in a basis.
struct Ritz {
    /// θ = λ − σ.
    values: Vec<f64>,
    vectors: Vec<Vec<f64>>,
}

/// The factorised matrix and the mass.
struct Search<'a> {
    solver: &'a mut LinearSolver,
    mass: &'a MassMatrix,
    n: usize,
    solves: usize,
}

impl Search<'_> {
    /// An M-orthonormal basis of all vectors.
    fn all(&self) -> Vec<Vec<f64>> {
        let mut basis = Vec::new();
        for i in 0..self.n {
            let mut x = vec![0.0; self.n];
            x[i] = 1.0;
            self.add_to(&mut basis, x);
        }
        basis
    }

    /// Pseudo-random vectors, the same in every run.
    fn begin(&self, width: usize) -> Vec<Vec<f64>> {
        let mut seed = 0x9E37_79B9_7F4A_7C15_u64;
        let mut next = || {
            // Xorshift (Marsaglia 2003).
            seed ^= seed << 13;
            seed ^= seed >> 7;
            seed ^= seed << 17;
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut basis = Vec::new();
        for _ in 0..width {
            let x = (0..self.n).map(|_| next()).collect();
            self.add_to(&mut basis, x);
        }
        basis
    }

    /// xᵀ M y.
    fn product(&self, x: &[f64], y: &[f64]) -> f64 {
        dot(x, &self.mass.times(y))
    }

    /// Adds the part of `x` that is M-orthogonal to the basis, if any is left.
    fn add_to(&self, basis: &mut Vec<Vec<f64>>, mut x: Vec<f64>) {
        let before = self.product(&x, &x).sqrt();
        for _ in 0..2 {
            let weighted = self.mass.times(&x);
            let parts: Vec<f64> = basis.par_iter().map(|v| dot(v, &weighted)).collect();
            // Each row sums over the basis in its order, whatever the threads.
            x.par_chunks_mut(4096).enumerate().for_each(|(chunk, x)| {
                let from = 4096 * chunk;
                for (v, part) in basis.iter().zip(&parts) {
                    for (x, v) in x.iter_mut().zip(&v[from..]) {
                        *x -= part * v;
                    }
                }
            });
        }
        let left = self.product(&x, &x).sqrt();
        if left > INDEPENDENT * before && left > 0.0 {
            for x in &mut x {
                *x /= left;
            }
            basis.push(x);
        }
    }

    /// (K − σ M)⁻¹ M X.
    fn invert(&mut self, vectors: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, LinearError> {
        let mut rhs: Vec<f64> = Vec::with_capacity(self.n * vectors.len());
        for x in vectors {
            rhs.extend(self.mass.times(x));
        }
        self.solver.solve(&mut rhs)?;
        self.solves += vectors.len();
        Ok(rhs.chunks(self.n).map(<[f64]>::to_vec).collect())
    }

    /// The basis [X, W, …] of the next round from X and W = (K − σ M)⁻¹ M X.
    fn grow(
        &mut self,
        vectors: Vec<Vec<f64>>,
        first: Vec<Vec<f64>>,
    ) -> Result<Vec<Vec<f64>>, LinearError> {
        let mut basis = vectors;
        let mut block = first;
        for depth in 1..DEPTH {
            let from = basis.len();
            for x in block {
                self.add_to(&mut basis, x);
            }
            if depth + 1 == DEPTH || basis.len() == from {
                break;
            }
            let last = basis[from..].to_vec();
            block = self.invert(&last)?;
        }
        Ok(basis)
    }

    /// The `count` lowest approximations in an M-orthonormal basis (Rayleigh–Ritz).
    fn ritz(&mut self, basis: &[Vec<f64>], count: usize) -> Ritz {
        let k = basis.len();
        let flat = basis.concat();
        let zeros = vec![0.0; flat.len()];
        let mut product = zeros.clone();
        // r = 0 − A V.
        self.solver.operator.residual(&flat, &zeros, &mut product);
        let images: Vec<&[f64]> = product.chunks(self.n).collect();
        let rows: Vec<Vec<f64>> = (0..k)
            .into_par_iter()
            .map(|i| (0..=i).map(|j| -dot(&basis[i], images[j])).collect())
            .collect();
        let small = DMatrix::from_fn(k, k, |i, j| rows[i.max(j)][i.min(j)]);
        let solved = SymmetricEigen::new(small);
        let mut order: Vec<usize> = (0..k).collect();
        order.sort_by(|&a, &b| solved.eigenvalues[a].total_cmp(&solved.eigenvalues[b]));
        order.truncate(count);
        let vectors = order.par_iter().map(|&c| {
            let mut x = vec![0.0; self.n];
            for (v, part) in basis.iter().zip(solved.eigenvectors.column(c).iter()) {
                x.iter_mut().zip(v).for_each(|(x, v)| *x += part * v);
            }
            x
        });
        let mut vectors: Vec<Vec<f64>> = vectors.collect();
        for x in &mut vectors {
            let size = self.product(x, x).sqrt();
            for x in x.iter_mut() {
                *x /= size;
            }
        }
        Ritz {
            values: order.iter().map(|&c| solved.eigenvalues[c]).collect(),
            vectors,
        }
    }

    /// Pairs with their residuals. `images`: (K − σ M)⁻¹ M x of each vector.
    fn pairs(&self, found: &Ritz, images: &[Vec<f64>], shift: f64) -> Vec<EigenPair> {
        let all = found.values.iter().zip(&found.vectors).zip(images);
        all.map(|((&theta, x), image)| {
            let rest: Vec<f64> = image.iter().zip(x).map(|(w, x)| theta * w - x).collect();
            EigenPair {
                value: shift + theta,
                vector: x.clone(),
                residual: self.product(&rest, &rest).sqrt(),
            }
        })
        .collect()
    }
}
