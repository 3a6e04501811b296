//! Element corotational kinematics (theory D).
//!
//! R is the rotation of the centroid's deformation gradient F = Σ x_a ⊗ b_a = R U. In the rotated
//! frame the element sees local displacements ū_a = Rᵀ(x_a − x_c) − (X_a − X_c), small strains and
//! local forces f̄. With v = Rᵀ x, W = tr(U) 1 − U and δR = R [δω]×,
//!
//! ```text
//! W δω = Σ b_a × δv_a                    (skew part of RᵀδF = [δω]× U + δU)
//! δū_a = δv_a − δv_c − δω × x̄_a
//! f_a  = R (f̄_a − p × b_a),   W p = m = Σ x̄_a × f̄_a
//! ```
//!
//! so f is the exact derivative of the element's energy and balances moments in the deformed
//! configuration. Its derivative is taken exactly too, with the turning of the frame (δω), of the
//! moment (δm) and of W (δU).

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::hex8::{ElementShape, Stiffness};
use crate::material::LocalFailure;

type Wide = SMatrix<f64, 3, 24>;

/// The rotated frame of one element.
#[derive(Clone, Debug)]
pub struct Corotated {
    /// R.
    pub rotation: Matrix3<f64>,
    /// ū [mm]. `[3 node + xyz]`
    pub local: [f64; 24],
    stretch: Matrix3<f64>,
    position: [Vector3<f64>; 8],
    spin: Matrix3<f64>,
}

fn cross(v: &Vector3<f64>) -> Matrix3<f64> {
    v.cross_matrix()
}

/// Rotation of F by Newton's iteration R ← ½ (R + R⁻ᵀ), which converges quadratically for det F > 0.
fn rotation_of(f: &Matrix3<f64>) -> Option<Matrix3<f64>> {
    let mut r = *f;
    for _ in 0..50 {
        let next = (r + r.try_inverse()?.transpose()) * 0.5;
        let change = (next - r).amax();
        r = next;
        if change <= 1e-15 {
            return Some(r);
        }
    }
    // The last digits may alternate.
    (r.transpose() * r - Matrix3::identity())
        .amax()
        .le(&1e-13)
        .then_some(r)
}

impl Corotated {
    /// Frame of an element with current corner positions `x` [mm].
    ///
    /// # Errors
    /// [`LocalFailure::Inverted`] if the element has turned inside out.
    pub fn new(shape: &ElementShape, x: &[[f64; 3]; 8]) -> Result<Self, LocalFailure> {
        let mut f = Matrix3::zeros();
        let mut centre = Vector3::zeros();
        for a in 0..8 {
            let p = Vector3::from(x[a]);
            centre += p / 8.0;
        }
        for a in 0..8 {
            f += (Vector3::from(x[a]) - centre) * Vector3::from(shape.gradient[a]).transpose();
        }
        let determinant = f.determinant();
        if !determinant.is_finite() {
            return Err(LocalFailure::StrainNotFinite);
        }
        // Squeezed to a hundredth the rotation still exists, the small strain does not.
        if determinant <= 1e-2 {
            return Err(LocalFailure::Inverted { determinant });
        }
        let inverted = LocalFailure::Inverted { determinant };
        let rotation = rotation_of(&f).ok_or(inverted)?;
        let stretch = rotation.transpose() * f;
        let stretch = (stretch + stretch.transpose()) * 0.5;
        let w = Matrix3::identity() * stretch.trace() - stretch;
        let spin = w.try_inverse().ok_or(inverted)?;
        let mut position = [Vector3::zeros(); 8];
        let mut local = [0.0; 24];
        for a in 0..8 {
            position[a] = rotation.transpose() * (Vector3::from(x[a]) - centre);
            for i in 0..3 {
                local[3 * a + i] = position[a][i] - shape.relative[a][i];
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
    fn moment(&self, local_force: &[f64; 24]) -> Vector3<f64> {
        let mut m = Vector3::zeros();
        for a in 0..8 {
            m += self.position[a].cross(&node(local_force, a));
        }
        self.spin * m
    }

    /// Global nodal forces of local ones [N].
    pub fn force(&self, shape: &ElementShape, local_force: &[f64; 24]) -> [[f64; 3]; 8] {
        let p = self.moment(local_force);
        let mut force = [[0.0; 3]; 8];
        for a in 0..8 {
            let b = Vector3::from(shape.gradient[a]);
            force[a] = (self.rotation * (node(local_force, a) - p.cross(&b))).into();
        }
        force
    }

    /// Global stiffness `[a][b][i][j]` [N/mm] of a local one, with all geometric terms.
    pub fn stiffness(
        &self,
        shape: &ElementShape,
        local: &Stiffness,
        local_force: &[f64; 24],
        cell: &mut [f64],
    ) {
        let p = self.moment(local_force);
        // Ω: δω = Ω δv
        let mut omega = Wide::zeros();
        for a in 0..8 {
            let block = self.spin * cross(&Vector3::from(shape.gradient[a]));
            omega.fixed_view_mut::<3, 3>(0, 3 * a).copy_from(&block);
        }
        // K̄ X, X_a = [x̄_a]×
        let mut kx = SMatrix::<f64, 24, 3>::zeros();
        for i in 0..24 {
            let mut sum = Vector3::zeros();
            for b in 0..8 {
                // Row k of K̄ times [x̄]× is −(x̄ × k) = k × x̄.
                let k = Vector3::new(local[i][3 * b], local[i][3 * b + 1], local[i][3 * b + 2]);
                sum += k.cross(&self.position[b]);
            }
            for j in 0..3 {
                kx[(i, j)] = sum[j];
            }
        }
        // A = K̄ P = K̄ + (K̄ X) Ω, because K̄ sees no translation.
        let mut a_matrix = kx * omega;
        for i in 0..24 {
            for j in 0..24 {
                a_matrix[(i, j)] += local[i][j];
            }
        }
        // δm = Σ −[f̄_a]× δū_a + [x̄_a]× δf̄_a
        let mut dm = Wide::zeros();
        let mut mx = Matrix3::zeros();
        for a in 0..8 {
            let f = cross(&node(local_force, a));
            let x = cross(&self.position[a]);
            mx -= f * x;
            let rows = a_matrix.fixed_view::<3, 24>(3 * a, 0);
            dm += x * rows;
            let mut own = dm.fixed_view_mut::<3, 3>(0, 3 * a);
            own -= f;
        }
        dm += mx * omega;
        // δW p = Σ (p b_bᵀ − (b_b·p) 1) δv_b − [U p]× δω
        dm += cross(&(self.stretch * p)) * omega;
        for b in 0..8 {
            let g = Vector3::from(shape.gradient[b]);
            let mut own = dm.fixed_view_mut::<3, 3>(0, 3 * b);
            own -= p * g.transpose() - Matrix3::identity() * g.dot(&p);
        }
        let dp = self.spin * dm;
        let (r, rt) = (self.rotation, self.rotation.transpose());
        for a in 0..8 {
            let g = Vector3::from(shape.gradient[a]);
            let f = node(local_force, a) - p.cross(&g);
            let rows = a_matrix.fixed_view::<3, 24>(3 * a, 0) - cross(&f) * omega + cross(&g) * dp;
            for b in 0..8 {
                let block = r * rows.fixed_view::<3, 3>(0, 3 * b) * rt;
                let to = &mut cell[(a * 8 + b) * 9..][..9];
                for i in 0..3 {
                    for j in 0..3 {
                        to[3 * i + j] = block[(i, j)];
                    }
                }
            }
        }
    }
}

fn node(force: &[f64; 24], a: usize) -> Vector3<f64> {
    Vector3::new(force[3 * a], force[3 * a + 1], force[3 * a + 2])
}
