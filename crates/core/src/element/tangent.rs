//! Exact stiffness of the corotated element in global directions.
//!
//! The derivative of f_a = R (f̄_a − p × b_a) (see [`super::kinematics`]) in the rotated frame is the local stiffness
//! plus two terms of rank three. With X_a = [x̄_a]×, B_b = [b_b]×, S = W⁻¹, and δω = S Σ B_b δv_b,
//!
//! ```text
//! K_ab ← K̄_ab + V_a B_b − B_a U_bᵀ
//! V_a = (K̄X_a − [f̄_a]× + [p]× B_a) S + ½ B_a T          K̄X_a = Σ_c K̄_ac X_c
//! U_b = −(H_bᵀ + [f̄_b]× − [p]× B_b) S + ½ B_b Tᵀ         H_b = Σ_c X_c K̄_cb
//! T = S M S − [p]× S,   M = Σ H_b X_b − Σ [f̄_a]× X_a + [U p]×
//! ```
//!
//! V_a B_b is the change of the forces with the rotation of the frame. B_a U_bᵀ is the change of p = W⁻¹ m with the
//! displacements. T, the change of p with the rotation, is divided equally between both. If K̄ is symmetric, H_bᵀ =
//! −K̄X_b, so that U = V and the sum is symmetric.

use nalgebra::{Matrix3, Vector3};

use super::hex8::{ElementShape, Nodal, Stiffness};
use super::kinematics::{Corotated, dot, products};

/// A 3 × 3 matrix for each node. `[row][column][node]`
type Matrices = [Nodal; 3];

/// Element matrix `[a][b][i][j]` from a symmetric local stiffness.
#[inline(always)]
pub(super) fn symmetric(
    frame: &Corotated,
    shape: &ElementShape,
    k: &Stiffness,
    force: &Nodal,
    cell: &mut [f64],
) {
    let p = frame.moment(force);
    let h = turning_moments(&frame.position, k);
    let t = shared(frame, force, &p, &h);
    let mut kx = [[[0.0; 8]; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            for a in 0..8 {
                kx[i][j][a] = -h[j][i][a];
            }
        }
    }
    let v = factor(frame, shape, force, &p, &kx, &t);
    write(&frame.rotation, shape, k, &v, &v, cell);
}

/// Element matrix `[a][b][i][j]` from any local stiffness.
#[inline(always)]
pub(super) fn unsymmetric(
    frame: &Corotated,
    shape: &ElementShape,
    k: &Stiffness,
    force: &Nodal,
    cell: &mut [f64],
) {
    let p = frame.moment(force);
    let h = turning_moments(&frame.position, k);
    let t = shared(frame, force, &p, &h);
    let (mut kx, mut minus_ht) = ([[[0.0; 8]; 3]; 3], [[[0.0; 8]; 3]; 3]);
    let x = &frame.position;
    for i in 0..3 {
        for j in 0..3 {
            let (l, m) = ((j + 1) % 3, (j + 2) % 3);
            for a in 0..8 {
                // A row k of K̄ times [x̄]× is k × x̄.
                kx[i][j][a] = dot(&k[a][i][l], &x[m]) - dot(&k[a][i][m], &x[l]);
                minus_ht[i][j][a] = -h[j][i][a];
            }
        }
    }
    let v = factor(frame, shape, force, &p, &kx, &t);
    let u = factor(frame, shape, force, &p, &minus_ht, &t.transpose());
    write(&frame.rotation, shape, k, &v, &u, cell);
}

/// H_b = Σ_c [x̄_c]× K̄_cb.
#[inline(always)]
fn turning_moments(x: &Nodal, k: &Stiffness) -> Matrices {
    let mut h = [[[0.0; 8]; 3]; 3];
    for (c, rows) in k.iter().enumerate() {
        for i in 0..3 {
            let (l, m) = ((i + 1) % 3, (i + 2) % 3);
            let (x_l, x_m) = (x[l][c], x[m][c]);
            for j in 0..3 {
                for b in 0..8 {
                    h[i][j][b] += x_l * rows[m][j][b] - x_m * rows[l][j][b];
                }
            }
        }
    }
    h
}

/// The matrix T of the module description.
#[inline(always)]
fn shared(frame: &Corotated, force: &Nodal, p: &Vector3<f64>, h: &Matrices) -> Matrix3<f64> {
    let x = &frame.position;
    // Σ H_b X_b, and Σ [f̄]× X = Σ x̄ f̄ᵀ − (x̄·f̄) 1.
    let mut hx = Matrix3::zeros();
    for i in 0..3 {
        for j in 0..3 {
            let (l, m) = ((j + 1) % 3, (j + 2) % 3);
            hx[(i, j)] = dot(&h[i][l], &x[m]) - dot(&h[i][m], &x[l]);
        }
    }
    let xf = products(x, force);
    let fx = xf - Matrix3::identity() * xf.trace();
    let m = hx - fx + (frame.stretch * p).cross_matrix();
    frame.spin * m * frame.spin - p.cross_matrix() * frame.spin
}

/// (K̄X_a − [f̄_a]× + [p]× B_a) S + ½ B_a T for all nodes.
#[inline(always)]
fn factor(
    frame: &Corotated,
    shape: &ElementShape,
    force: &Nodal,
    p: &Vector3<f64>,
    kx: &Matrices,
    t: &Matrix3<f64>,
) -> Matrices {
    let (g, f) = (&shape.gradient, force);
    let mut y = *kx;
    // [p]× [b]× = b pᵀ − (p·b) 1
    for i in 0..3 {
        let (l, m) = ((i + 1) % 3, (i + 2) % 3);
        for a in 0..8 {
            y[i][i][a] -= p[l] * g[l][a] + p[m] * g[m][a];
            y[i][l][a] += g[i][a] * p[l] + f[m][a];
            y[i][m][a] += g[i][a] * p[m] - f[l][a];
        }
    }
    let (s, half) = (&frame.spin, t * 0.5);
    let mut v = [[[0.0; 8]; 3]; 3];
    for i in 0..3 {
        let (l, m) = ((i + 1) % 3, (i + 2) % 3);
        for j in 0..3 {
            for a in 0..8 {
                let turned =
                    y[i][0][a] * s[(0, j)] + y[i][1][a] * s[(1, j)] + y[i][2][a] * s[(2, j)];
                // Row i of [b]× T.
                v[i][j][a] = turned + (g[l][a] * half[(m, j)] - g[m][a] * half[(l, j)]);
            }
        }
    }
    v
}

/// Writes R (K̄_ab + V_a B_b − B_a U_bᵀ) Rᵀ into the element matrix.
#[inline(always)]
fn write(
    r: &Matrix3<f64>,
    shape: &ElementShape,
    k: &Stiffness,
    v: &Matrices,
    u: &Matrices,
    cell: &mut [f64],
) {
    let g = &shape.gradient;
    for (a, (rows, cell)) in k.iter().zip(cell.chunks_exact_mut(72)).enumerate() {
        let mut half = [[[0.0; 8]; 3]; 3];
        for i in 0..3 {
            let (l, m) = ((i + 1) % 3, (i + 2) % 3);
            let (g_l, g_m) = (g[l][a], g[m][a]);
            let mut sum = rows[i];
            for j in 0..3 {
                let (jl, jm) = ((j + 1) % 3, (j + 2) % 3);
                let (v_l, v_m) = (v[i][jl][a], v[i][jm][a]);
                for b in 0..8 {
                    sum[j][b] +=
                        (v_l * g[jm][b] - v_m * g[jl][b]) - (g_l * u[j][m][b] - g_m * u[j][l][b]);
                }
            }
            for j in 0..3 {
                for b in 0..8 {
                    half[i][j][b] =
                        sum[0][b] * r[(j, 0)] + sum[1][b] * r[(j, 1)] + sum[2][b] * r[(j, 2)];
                }
            }
        }
        let mut turned = [[0.0; 8]; 9];
        for i in 0..3 {
            for j in 0..3 {
                for b in 0..8 {
                    turned[3 * i + j][b] = r[(i, 0)] * half[0][j][b]
                        + r[(i, 1)] * half[1][j][b]
                        + r[(i, 2)] * half[2][j][b];
                }
            }
        }
        for (b, block) in cell.chunks_exact_mut(9).enumerate() {
            for (value, lanes) in block.iter_mut().zip(&turned) {
                *value = lanes[b];
            }
        }
    }
}
