//! Corotational kinematics of an element (theory/hex8.md, eqs 6 to 10).
//!
//! R is the rotation of the deformation gradient F = Σ x_a ⊗ b_a = R U at the centroid. In the rotated frame the
//! element has local displacements ū_a = Rᵀ(x_a − x_c) − (X_a − X_c), small strains and local forces f̄. With v = Rᵀ
//! x, W = tr(U) 1 − U and δR = R [δω]×,
//!
//! ```text
//! W δω = Σ b_a × δv_a                    (skew part of RᵀδF = [δω]× U + δU)
//! δū_a = δv_a − δv_c − δω × x̄_a
//! f_a  = R (f̄_a − p × b_a),   W p = m = Σ x̄_a × f̄_a
//! ```
//!
//! f is the exact derivative of the element's energy and satisfies moment equilibrium in the deformed configuration.
//! Its derivative in `super::tangent` is exact as well: it includes the rotation of the frame (δω) and the changes of
//! the moment (δm) and of W (δU).

use nalgebra::{Matrix3, Vector3};

use super::hex8::{ElementShape, Nodal, Stiffness, total, transpose};
use super::tangent;
use crate::material::LocalFailure;

/// The rotated frame of one element.
#[derive(Clone, Debug)]
pub struct Corotated {
    /// R.
    pub rotation: Matrix3<f64>,
    /// ū [mm].
    pub local: Nodal,
    /// U.
    pub(super) stretch: Matrix3<f64>,
    /// x̄ [mm].
    pub(super) position: Nodal,
    /// W⁻¹.
    pub(super) spin: Matrix3<f64>,
}

/// Rotation of F by Newton's iteration R ← ½ (R + R⁻ᵀ), which converges quadratically for det F > 0.
#[inline(always)]
fn rotation_of(f: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    /// A change δ leaves an error of δ²/2.
    const LAST: f64 = 1e-8;
    let mut r = *f;
    for _ in 0..50 {
        // R⁻ᵀ is the cofactor matrix divided by the determinant.
        let x = Vector3::new(r.m11, r.m21, r.m31);
        let y = Vector3::new(r.m12, r.m22, r.m32);
        let z = Vector3::new(r.m13, r.m23, r.m33);
        let cofactors = Matrix3::from_columns(&[y.cross(&z), z.cross(&x), x.cross(&y)]);
        let determinant = x.dot(&cofactors.column(0));
        if determinant == 0.0 {
            return None;
        }
        let next = r * 0.5 + cofactors * (0.5 / determinant);
        let change = (next - r).amax();
        r = next;
        if change <= LAST {
            return Some(r);
        }
    }
    None
}

/// Green–Lagrange strain ½ (FᵀF − 1) at the centroid of an element with corners `x` [mm], independent of its
/// rotation.
#[inline(always)]
pub fn green_strain(shape: &ElementShape, x: &[[f64; 3]; 8]) -> Matrix3<f64> {
    let f = products(&transpose(x), &shape.gradient);
    (f.transpose() * f - Matrix3::identity()) * 0.5
}

impl Corotated {
    /// Rotated frame of an element with current corner positions `x` [mm]. `[node][xyz]`
    ///
    /// # Errors
    /// [`LocalFailure::Inverted`] if the element is inverted or nearly collapsed,
    /// [`LocalFailure::StrainNotFinite`] if the positions are not finite.
    #[inline(always)]
    pub fn new(shape: &ElementShape, x: &[[f64; 3]; 8]) -> Result<Self, LocalFailure> {
        let mut centred = [[0.0; 8]; 3];
        for i in 0..3 {
            for a in 0..8 {
                centred[i][a] = x[a][i];
            }
            let centre = 0.125 * total(&centred[i]);
            for a in 0..8 {
                centred[i][a] -= centre;
            }
        }
        let f = products(&centred, &shape.gradient);
        let determinant = f.determinant();
        if !determinant.is_finite() {
            return Err(LocalFailure::StrainNotFinite);
        }
        // Below a volume ratio of 1/100 the rotation still exists, but the strains are no longer small.
        if determinant <= 1e-2 {
            return Err(LocalFailure::Inverted { determinant });
        }
        let inverted = LocalFailure::Inverted { determinant };
        let rotation = rotation_of(&f).ok_or(inverted)?;
        let stretch = rotation.transpose() * f;
        let stretch = (stretch + stretch.transpose()) * 0.5;
        let w = Matrix3::identity() * stretch.trace() - stretch;
        let spin = w.try_inverse().ok_or(inverted)?;
        let position = turned(&rotation.transpose(), &centred);
        let mut local = position;
        for i in 0..3 {
            for a in 0..8 {
                local[i][a] -= shape.relative[i][a];
            }
        }
        Ok(Self {
            rotation,
            local,
            stretch,
            position,
            spin,
        })
    }

    /// p = W⁻¹ Σ x̄_a × f̄_a.
    #[inline(always)]
    pub(super) fn moment(&self, local_force: &Nodal) -> Vector3<f64> {
        let (x, f) = (&self.position, local_force);
        let m = products(x, f);
        self.spin
            * Vector3::new(
                m[(1, 2)] - m[(2, 1)],
                m[(2, 0)] - m[(0, 2)],
                m[(0, 1)] - m[(1, 0)],
            )
    }

    /// Global nodal forces from local forces [N]. `[node][xyz]`
    #[inline(always)]
    pub fn force(&self, shape: &ElementShape, local_force: &Nodal) -> [[f64; 3]; 8] {
        let p = self.moment(local_force);
        let g = &shape.gradient;
        let mut f = *local_force;
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            for a in 0..8 {
                f[i][a] -= p[j] * g[k][a] - p[k] * g[j][a];
            }
        }
        let f = turned(&self.rotation, &f);
        let mut force = [[0.0; 3]; 8];
        for a in 0..8 {
            force[a] = [f[0][a], f[1][a], f[2][a]];
        }
        force
    }

    /// Global stiffness `[a][b][i][j]` [N/mm] from a local stiffness, with all geometric terms.
    #[inline(always)]
    pub fn stiffness(
        &self,
        shape: &ElementShape,
        local: &Stiffness,
        local_force: &Nodal,
        cell: &mut [f64],
    ) {
        tangent::unsymmetric(self, shape, local, local_force, cell);
    }

    /// [`Self::stiffness`] for a symmetric local stiffness, which needs one factor V instead of two.
    #[inline(always)]
    pub fn symmetric_stiffness(
        &self,
        shape: &ElementShape,
        local: &Stiffness,
        local_force: &Nodal,
        cell: &mut [f64],
    ) {
        tangent::symmetric(self, shape, local, local_force, cell);
    }
}

/// Σ_a u_a v_a.
#[inline(always)]
pub(super) fn dot(u: &[f64; 8], v: &[f64; 8]) -> f64 {
    let mut products = [0.0; 8];
    for a in 0..8 {
        products[a] = u[a] * v[a];
    }
    total(&products)
}

/// Σ_a u_a v_aᵀ.
#[inline(always)]
pub(super) fn products(u: &Nodal, v: &Nodal) -> Matrix3<f64> {
    let mut sum = Matrix3::zeros();
    for i in 0..3 {
        for j in 0..3 {
            sum[(i, j)] = dot(&u[i], &v[j]);
        }
    }
    sum
}

/// R v_a.
#[inline(always)]
fn turned(r: &Matrix3<f64>, v: &Nodal) -> Nodal {
    let mut turned = [[0.0; 8]; 3];
    for i in 0..3 {
        for a in 0..8 {
            turned[i][a] = r[(i, 0)] * v[0][a] + r[(i, 1)] * v[1][a] + r[(i, 2)] * v[2][a];
        }
    }
    turned
}
