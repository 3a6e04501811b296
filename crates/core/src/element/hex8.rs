//! The eight-node hexahedron in its reference configuration (theory/hex8.md, eqs 1 to 5).
//!
//! [`ElementShape`] holds all data that depend only on geometry and elastic constants: strain operators B̃ at the 2 ×
//! 2 × 2 Gauss points, weights, gradients at the centroid, elastic stiffness. Equal elements share one.

use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3, Vector6};

use super::Formulation;
use crate::material::{ElasticParameters, elastic_stiffness, hooke};
use crate::tensor::ByPoint;

/// Parameters (ξ, η, ζ) of the nodes in the order of VTK's hexahedron. `[node][ξηζ]`
pub const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// A vector at each node. `[xyz][node]`: the innermost index runs over the nodes, so that loops vectorise over them.
pub type Nodal = [[f64; 8]; 3];
/// Strain operator of one point: engineering Voigt strains from the 24 displacements.
pub type Operator = [Nodal; 6];
/// Stiffness of 24 displacements, K_ab. `[node a][xyz of a][xyz of b][node b]`
pub type Stiffness = [[Nodal; 3]; 8];

/// Nodes of each face, counter-clockwise seen from outside.
pub const FACES: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

/// An element whose geometry is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// The Jacobian is not positive: the element is inverted, collapsed or too distorted.
    #[error("the Jacobian is {determinant:.3e} mm³ at point {point}: the element is inverted")]
    Jacobian {
        /// Gauss point; 8 is the centroid.
        point: usize,
        /// det J [mm³].
        determinant: f64,
    },
}

/// Reference geometry of an element and the quantities derived from it.
#[derive(Clone, Debug)]
pub struct ElementShape {
    /// X_a − X_c [mm].
    pub relative: Nodal,
    /// Strain operators B̃ [1/mm]. `[gauss point]`
    pub operator: [Operator; 8],
    /// The strain operators with the Gauss points innermost. `[xyz][node][component][gauss point]`
    by_point: Box<[[ByPoint; 8]; 3]>,
    /// det J · w [mm³], or the [counted](Self::counted) part of it. `[gauss point]`
    pub weight: [f64; 8],
    /// Gradients of the shape functions at the centroid [1/mm].
    pub gradient: Nodal,
    /// Volume [mm³].
    pub volume: f64,
    /// Edge of a cube with this volume [mm].
    pub size: f64,
    elastic: ElasticParameters,
    /// Contribution of each Gauss point to the elastic stiffness [N/mm].
    point_stiffness: Box<[Stiffness]>,
    /// Elastic stiffness [N/mm].
    stiffness: Box<Stiffness>,
}

/// Derivatives of the shape functions by (ξ, η, ζ).
fn derivatives(p: [f64; 3]) -> [[f64; 3]; 8] {
    CORNERS.map(|c| {
        let f = [0, 1, 2].map(|i| 1.0 + c[i] * p[i]);
        [
            0.125 * c[0] * f[1] * f[2],
            0.125 * c[1] * f[0] * f[2],
            0.125 * c[2] * f[0] * f[1],
        ]
    })
}

/// J_ij = ∂x_i/∂ξ_j.
fn jacobian(relative: &[[f64; 3]; 8], by_xi: &[[f64; 3]; 8]) -> Matrix3<f64> {
    let mut j = Matrix3::zeros();
    for a in 0..8 {
        j += Vector3::from(relative[a]) * Vector3::from(by_xi[a]).transpose();
    }
    j
}

/// Strain of a displacement field with only u_i ≠ 0, whose gradient is `g`.
fn strain_of(i: usize, g: &Vector3<f64>) -> Vector6<f64> {
    let mut e = Vector6::zeros();
    e[i] = g[i];
    match i {
        0 => {
            e[3] = g[1];
            e[5] = g[2];
        }
        1 => {
            e[3] = g[0];
            e[4] = g[2];
        }
        _ => {
            e[4] = g[1];
            e[5] = g[0];
        }
    }
    e
}

impl ElementShape {
    /// Precomputes the element with these reference corners [mm].
    ///
    /// # Errors
    /// [`ShapeError`] if the Jacobian is not positive at a Gauss point or at the centroid.
    #[expect(
        clippy::too_many_lines,
        reason = "the precomputed tables of an element, one after the other"
    )]
    pub fn new(
        corners: &[[f64; 3]; 8],
        formulation: Formulation,
        elastic: &ElasticParameters,
    ) -> Result<Self, ShapeError> {
        let centre = [0, 1, 2].map(|i| corners.iter().map(|c| c[i]).sum::<f64>() / 8.0);
        let relative = corners.map(|c| [0, 1, 2].map(|i| c[i] - centre[i]));
        let inverse = |p: [f64; 3], point: usize| {
            let j = jacobian(&relative, &derivatives(p));
            let determinant = j.determinant();
            let inverse = if determinant > 0.0 {
                j.try_inverse()
            } else {
                None
            };
            inverse
                .map(|i| (i, determinant))
                .ok_or(ShapeError::Jacobian { point, determinant })
        };
        let (inverse0, det0) = inverse([0.0; 3], 8)?;
        let at_centre = derivatives([0.0; 3]);
        let gradient = at_centre.map(|d| (inverse0.transpose() * Vector3::from(d)).into());

        let at = 1.0 / 3.0_f64.sqrt();
        let mut b = [SMatrix::<f64, 6, 24>::zeros(); 8];
        let mut g = [SMatrix::<f64, 6, 9>::zeros(); 8];
        let mut weight = [0.0; 8];
        for (point, corner) in CORNERS.iter().enumerate() {
            let p = corner.map(|c| c * at);
            let (inv, det) = inverse(p, point)?;
            weight[point] = det;
            for (a, d) in derivatives(p).iter().enumerate() {
                let grad = inv.transpose() * Vector3::from(*d);
                for i in 0..3 {
                    b[point].set_column(3 * a + i, &strain_of(i, &grad));
                }
            }
            // Wilson–Taylor modes 1 − ξ_k², mapped by the centroid Jacobian and scaled by j0/j: they do no work under
            // a constant stress.
            for k in 0..3 {
                let mut d = Vector3::zeros();
                d[k] = -2.0 * p[k];
                let grad = inverse0.transpose() * d * (det0 / det);
                for i in 0..3 {
                    g[point].set_column(3 * k + i, &strain_of(i, &grad));
                }
            }
        }
        let volume: f64 = weight.iter().sum();
        let c0 = elastic_stiffness(elastic);
        match formulation {
            Formulation::Full => {}
            Formulation::BBar => constant_dilatation(&mut b, &weight, volume),
            Formulation::Incompatible => condense(&mut b, &g, &weight, &c0),
        }
        let operator = b.map(|b| lanes_of(|r, j, n| b[(r, 3 * n + j)]));
        let mut point_stiffness = vec![ZERO; 8].into_boxed_slice();
        let mut stiffness = Box::new(ZERO);
        for p in 0..8 {
            add_btdb(&operator[p], &c0, weight[p], &mut point_stiffness[p]);
            make_symmetric(&mut point_stiffness[p]);
            add_scaled(&point_stiffness[p], 1.0, &mut stiffness);
        }
        let mut by_point = Box::new([[[[0.0; 8]; 6]; 8]; 3]);
        for (j, n, k, g) in (0..3 * 8 * 6 * 8).map(|i| (i / 384, i / 48 % 8, i / 8 % 6, i % 8)) {
            by_point[j][n][k][g] = operator[g][k][j][n];
        }
        Ok(Self {
            relative: transpose(&relative),
            operator,
            by_point,
            weight,
            gradient: transpose(&gradient),
            volume,
            size: volume.cbrt(),
            elastic: *elastic,
            point_stiffness,
            stiffness,
        })
    }

    /// The same element counted only in part, such as one that is cut by a plane of symmetry: forces, stiffness and
    /// energies are multiplied by `part`, strains and sizes are unchanged.
    #[must_use]
    pub fn counted(mut self, part: f64) -> Self {
        self.weight = self.weight.map(|w| part * w);
        let points = self.point_stiffness.iter_mut();
        for k in points.chain(std::iter::once(&mut *self.stiffness)) {
            k.as_flattened_mut()
                .as_flattened_mut()
                .as_flattened_mut()
                .iter_mut()
                .for_each(|k| *k *= part);
        }
        self
    }

    /// Strain at Gauss point `g` from local displacements [mm].
    #[inline(always)]
    pub fn strain(&self, g: usize, local: &Nodal) -> Vector6<f64> {
        let mut strain = Vector6::zeros();
        for (k, row) in self.operator[g].iter().enumerate() {
            let mut sum = [0.0; 8];
            for j in 0..3 {
                for n in 0..8 {
                    sum[n] += row[j][n] * local[j][n];
                }
            }
            strain[k] = total(&sum);
        }
        strain
    }

    /// Strains at the Gauss points from local displacements [mm].
    #[inline(always)]
    pub fn strains(&self, local: &Nodal) -> [Vector6<f64>; 8] {
        let mut strains = [Vector6::zeros(); 8];
        for (g, strain) in strains.iter_mut().enumerate() {
            *strain = self.strain(g, local);
        }
        strains
    }

    /// Strains from local displacements [mm], with the Gauss points innermost.
    #[inline(always)]
    pub fn strains_by_point(&self, local: &Nodal) -> ByPoint {
        let mut strains = [[0.0; 8]; 6];
        for (columns, u) in self.by_point.iter().zip(local) {
            for (column, u) in columns.iter().zip(u) {
                for k in 0..6 {
                    for g in 0..8 {
                        strains[k][g] += column[k][g] * u;
                    }
                }
            }
        }
        strains
    }

    /// f̄ += B̃ᵀ σ w for the stress at Gauss point `g` [N].
    #[inline(always)]
    pub fn add_force(&self, g: usize, stress: &Vector6<f64>, force: &mut Nodal) {
        for (k, row) in self.operator[g].iter().enumerate() {
            let s = stress[k] * self.weight[g];
            for j in 0..3 {
                for n in 0..8 {
                    force[j][n] += row[j][n] * s;
                }
            }
        }
    }

    /// f̄ = Σ B̃ᵀ σ w for the stresses at the Gauss points [N].
    #[inline(always)]
    pub fn internal_force(&self, stresses: &[Vector6<f64>; 8]) -> Nodal {
        let mut force = [[0.0; 8]; 3];
        for (g, stress) in stresses.iter().enumerate() {
            self.add_force(g, stress, &mut force);
        }
        force
    }

    /// f̄ = K̄ ū for an undamaged elastic element [N].
    #[inline(always)]
    pub fn elastic_force(&self, local: &Nodal) -> Nodal {
        let mut force = [[0.0; 8]; 3];
        for (a, rows) in self.stiffness.iter().enumerate() {
            for (i, row) in rows.iter().enumerate() {
                // K̄ is symmetric, so that rows can be summed instead of columns. This vectorises over the nodes.
                let u = local[i][a];
                for j in 0..3 {
                    for n in 0..8 {
                        force[j][n] += row[j][n] * u;
                    }
                }
            }
        }
        force
    }

    /// Stress C₀ : ε of an undamaged point [MPa].
    pub fn elastic_stress(&self, strain: &Vector6<f64>) -> Vector6<f64> {
        hooke(&self.elastic, strain)
    }

    /// K̄ of the undamaged elastic element [N/mm].
    pub fn elastic_stiffness(&self) -> &Stiffness {
        &self.stiffness
    }

    /// K̄ = Σ B̃ᵀ D B̃ w for given tangents [N/mm].
    #[inline(always)]
    pub fn stiffness(&self, tangents: &[Matrix6<f64>; 8]) -> Stiffness {
        let mut k = ZERO;
        for p in 0..8 {
            add_btdb(&self.operator[p], &tangents[p], self.weight[p], &mut k);
        }
        k
    }

    /// K̄ = Σ s_g B̃ᵀ C₀ B̃ w for elastic points with the intact parts s_g [N/mm].
    #[inline(always)]
    pub fn scaled_stiffness(&self, intact: &[f64; 8]) -> Stiffness {
        // Start from the elastic stiffness of the element, which contains all undamaged points.
        let damaged = intact.iter().filter(|&&s| s != 1.0).count();
        let (mut k, whole) = if damaged < 8 {
            (*self.stiffness, 1.0)
        } else {
            (ZERO, 0.0)
        };
        for (part, &s) in self.point_stiffness.iter().zip(intact) {
            if s != whole {
                add_scaled(part, s - whole, &mut k);
            }
        }
        k
    }

    /// K̄ += B̃ᵀ (D − C₀) B̃ w: replaces the elastic stiffness of Gauss point `g` in K̄ by the tangent D.
    #[inline(always)]
    pub fn replace_tangent(&self, g: usize, tangent: &Matrix6<f64>, k: &mut Stiffness) {
        let change = tangent - elastic_stiffness(&self.elastic);
        add_btdb(&self.operator[g], &change, self.weight[g], k);
    }
}

const ZERO: Stiffness = [[[[0.0; 8]; 3]; 3]; 8];

/// `[node][xyz]` to `[xyz][node]`.
pub(super) fn transpose(of_node: &[[f64; 3]; 8]) -> Nodal {
    [0, 1, 2].map(|i| of_node.map(|v| v[i]))
}

/// Σ over the nodes in pairs. The fixed order suits vector instructions.
#[inline(always)]
pub(super) fn total(v: &[f64; 8]) -> f64 {
    let half = [v[0] + v[4], v[1] + v[5], v[2] + v[6], v[3] + v[7]];
    (half[0] + half[2]) + (half[1] + half[3])
}

fn lanes_of(entry: impl Fn(usize, usize, usize) -> f64) -> Operator {
    std::array::from_fn(|r| std::array::from_fn(|j| std::array::from_fn(|n| entry(r, j, n))))
}

/// K += s K'.
#[inline(always)]
fn add_scaled(from: &Stiffness, s: f64, k: &mut Stiffness) {
    for (rows, from) in k.iter_mut().zip(from) {
        for (row, from) in rows.iter_mut().zip(from) {
            for j in 0..3 {
                for n in 0..8 {
                    row[j][n] += s * from[j][n];
                }
            }
        }
    }
}

/// K ← ½ (K + Kᵀ) removes the rounding that makes an elastic stiffness unsymmetric.
fn make_symmetric(k: &mut Stiffness) {
    for a in 0..8 {
        for i in 0..3 {
            for b in 0..8 {
                for j in 0..3 {
                    let mean = 0.5 * (k[a][i][j][b] + k[b][j][i][a]);
                    k[a][i][j][b] = mean;
                    k[b][j][i][a] = mean;
                }
            }
        }
    }
}

/// K += w Bᵀ D B.
#[inline(always)]
fn add_btdb(b: &Operator, d: &Matrix6<f64>, weight: f64, k: &mut Stiffness) {
    let mut db = [[[0.0; 8]; 3]; 6];
    for r in 0..6 {
        for c in 0..6 {
            let factor = weight * d[(r, c)];
            if factor != 0.0 {
                for j in 0..3 {
                    for n in 0..8 {
                        db[r][j][n] += factor * b[c][j][n];
                    }
                }
            }
        }
    }
    for a in 0..8 {
        for i in 0..3 {
            let column = [0, 1, 2, 3, 4, 5].map(|r| b[r][i][a]);
            for j in 0..3 {
                let row = &mut k[a][i][j];
                for n in 0..8 {
                    row[n] += column[0] * db[0][j][n]
                        + column[1] * db[1][j][n]
                        + column[2] * db[2][j][n]
                        + column[3] * db[3][j][n]
                        + column[4] * db[4][j][n]
                        + column[5] * db[5][j][n];
                }
            }
        }
    }
}

/// B-bar: replaces the dilatation at every point by the mean of the element.
fn constant_dilatation(b: &mut [SMatrix<f64, 6, 24>; 8], weight: &[f64; 8], volume: f64) {
    for column in 0..24 {
        let dilatation = |b: &SMatrix<f64, 6, 24>| b[(0, column)] + b[(1, column)] + b[(2, column)];
        let mean = b
            .iter()
            .zip(weight)
            .map(|(b, w)| dilatation(b) * w)
            .sum::<f64>()
            / volume;
        for b in b.iter_mut() {
            let shift = (mean - dilatation(b)) / 3.0;
            for i in 0..3 {
                b[(i, column)] += shift;
            }
        }
    }
}

/// B̃ = B − G K_αα⁻¹ K_αu: condenses the incompatible modes once with the elastic stiffness. This is exact in the
/// elastic range. Beyond it, it is as robust as B-bar, whereas local iteration of the modes diverges.
fn condense(
    b: &mut [SMatrix<f64, 6, 24>; 8],
    g: &[SMatrix<f64, 6, 9>; 8],
    weight: &[f64; 8],
    c0: &Matrix6<f64>,
) {
    let mut k_aa = SMatrix::<f64, 9, 9>::zeros();
    let mut k_au = SMatrix::<f64, 9, 24>::zeros();
    for p in 0..8 {
        let gtc = g[p].transpose() * c0 * weight[p];
        k_aa += gtc * g[p];
        k_au += gtc * b[p];
    }
    // K_αα is positive definite for every element with a positive Jacobian, because the modes are independent.
    if let Some(factor) = k_aa.cholesky() {
        let modes = factor.solve(&k_au);
        for p in 0..8 {
            b[p] -= g[p] * modes;
        }
    }
}
