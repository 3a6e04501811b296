//! The interface of a joint law and the defaults that the solver derives from it.
//!
//! A law must implement [`name`](JointLaw::name), [`stiffness`](JointLaw::stiffness) and
//! [`update`](JointLaw::update). If its history contains quantities for the results, it also implements
//! [`outputs`](JointLaw::outputs). All other methods have defaults. A law overrides them where it has a better form.
//!
//! The solver iterates with a numerical stiffness k' < k. The default of [`update_shifted`](JointLaw::update_shifted)
//! connects the law in series with an offset spring,
//!
//! ```text
//! t = T(g'),   g' + C (t − t₋) = g,   C = 1/k' − 1/k (normal, shear, shear)                        (1)
//! ```
//!
//! where t₋ is the traction of the last iterate. The fixed point t = t₋ is t = T(g). Equation (1) is solved by
//! Newton's method, and by elastic steps between branches of the law. The stiffness of the iterate is (K⁻¹ + C)⁻¹,
//! where K is the tangent of the law. Only its symmetric blocks (normal, shear), with eigenvalues between 0 and k',
//! enter the matrix.

use std::fmt::Debug;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use crate::law::{InterfaceHistory, InterfaceResponse};
use crate::shifted::Shift;

/// A history variable that is written to the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// Name of the field in lower case with underscores.
    pub name: &'static str,
    /// Unit, such as `mm` or `MPa`; `1` if dimensionless.
    pub unit: &'static str,
    /// Index in [`InterfaceHistory::slots`], below [`SLOTS`](crate::SLOTS).
    pub slot: usize,
}

impl Output {
    /// An output with its name, unit and slot index.
    pub const fn new(name: &'static str, unit: &'static str, slot: usize) -> Self {
        Self { name, unit, slot }
    }

    /// Value of this output in a history.
    pub fn of(&self, history: &InterfaceHistory) -> f64 {
        history.slots.get(self.slot).copied().unwrap_or(f64::NAN)
    }
}

/// Largest number of Newton steps for equation (1).
const STEPS: usize = 300;
/// Tolerance of equation (1), relative to the tractions: rounding of k'/k.
const CLOSE: f64 = 1e-12;
/// Largest number of halvings in the line search for equation (1).
const HALVINGS: usize = 6;

/// A joint law: traction as a function of opening and slip.
///
/// Components are `[normal, tangent 1, tangent 2]`; opening and tension are positive. Lengths are in mm, tractions in
/// MPa, stiffnesses in N/mm³, energies per area in N/mm. A law must not depend on the directions of the tangents
/// (`checks::objectivity`). Its `Debug` text must contain all parameters, because a resumed run compares it.
pub trait JointLaw: Send + Sync + Debug {
    /// Name of the law, as used for `kind` in a deck and in messages.
    fn name(&self) -> &'static str;

    /// Elastic stiffness, normal and shear `[k_n, k_s]` [N/mm³].
    fn stiffness(&self) -> [f64; 2];

    /// One implicit step: traction, consistent tangent and new history at the total gap `[u, δ₁, δ₂]` [mm], from the
    /// history at the start of the step.
    ///
    /// [`InterfaceResponse::new`] fills the parts of the history that the solver reads besides the slots of the law.
    /// A law that has no solution returns a traction that is not finite; the run then ends with an error that names
    /// the law.
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse;

    /// Quantities of the history that become fields of the results. Default: none.
    fn outputs(&self) -> &'static [Output] {
        &[]
    }

    /// Initial history of a point. Default: all zero, but damage 1 where the joint
    /// [is dry](JointLaw::is_dry): it has no bond to lose. Override it if slots begin at other numbers than 0.
    fn virgin(&self) -> InterfaceHistory {
        InterfaceHistory {
            damage: if self.is_dry() { 1.0 } else { 0.0 },
            ..InterfaceHistory::default()
        }
    }

    /// History of a point that has lost contact with the opposite face: no traction, no bond, slip equal to its
    /// plastic slip.
    fn lost(&self, old: &InterfaceHistory) -> InterfaceHistory {
        InterfaceHistory {
            slip: old.plastic_slip,
            damage: if self.is_dry() { old.damage } else { 1.0 },
            traction: [0.0; 3],
            opening: 0.0,
            ..*old
        }
    }

    /// Whether the joint has no bond from the start: neither tension nor shear without pressure. Such points are no
    /// failed bonds in the results, and a lost one keeps its damage. Default: no.
    fn is_dry(&self) -> bool {
        false
    }

    /// Opening beyond which a point counts as open [mm]. Default: 0.
    fn opens_at(&self) -> f64 {
        0.0
    }

    /// Opening up to which a bond may carry traction [mm]; the search radius is twice as large. Default: 0.
    fn ultimate_opening(&self) -> f64 {
        0.0
    }

    /// Free energy of a point [N/mm]. Default: of the elastic parts, ½ σ²/k_n + ½ |τ|²/k_s. Override it if the
    /// stiffness at which a point unloads is another one, as the secant of a damaged bond.
    fn free_energy(&self, history: &InterfaceHistory) -> f64 {
        let [normal, shear] = self.stiffness();
        let [sigma, tau_1, tau_2] = history.traction;
        0.5 * sigma * sigma / normal + 0.5 * (tau_1 * tau_1 + tau_2 * tau_2) / shear
    }

    /// Work that the trapezoidal rule adds where a point changes between branches of different elastic stiffness
    /// between two commits [N/mm]: ½ u₀ u₁ (k₀ − k₁) where the opening goes from u₀ to u₁ of the other sign, with the
    /// stiffness of each. It is no dissipation: closing takes it, opening gives it back. Default: 0, for a law with one
    /// elastic stiffness; one that unloads to a plastic opening has one. A joint without tension that opens elastically
    /// has two, k_n and 0.
    fn crossing_work(&self, _old: &InterfaceHistory, _new: &InterfaceHistory) -> f64 {
        0.0
    }

    /// Shear traction divided by its limit [-]; infinite without pressure or if the law does not define it. Points
    /// well below 1 are iterated with a larger numerical stiffness. Default: infinite.
    fn utilisation(&self, _traction: &[f64; 3], _history: &InterfaceHistory) -> f64 {
        f64::INFINITY
    }

    /// The larger of shear traction over its limit and tension over tensile strength [-]; infinite if the law does
    /// not define it. Default: infinite.
    fn exertion(&self, _traction: &[f64; 3], _history: &InterfaceHistory) -> f64 {
        f64::INFINITY
    }

    /// A predicted traction [MPa], limited to the admissible values for the history `old`. Default: response of the
    /// law to the gap that gives this traction elastically.
    fn within_bounds(&self, guess: [f64; 3], old: &InterfaceHistory) -> [f64; 3] {
        let [normal, shear] = self.stiffness();
        let before = [old.opening, old.slip[0], old.slip[1]];
        let k = [normal, shear, shear];
        let at = [0, 1, 2].map(|i| before[i] + (guess[i] - old.traction[i]) / k[i]);
        self.update(at, old).traction
    }

    /// Steepest softening slopes in opening and in slip [N/mm³]. The numerical stiffness stays above four times this
    /// slope, so that an iterate does not snap back. Default: 0, no softening.
    fn softening_slopes(&self) -> [f64; 2] {
        [0.0; 2]
    }

    /// Law of one half of a joint in a plane of symmetry: half the opening gives the traction of the whole joint, and
    /// slip is free. Default: `None`; a plane of symmetry must then not cut the joint.
    fn halved(&self) -> Option<Arc<dyn JointLaw>> {
        None
    }

    /// One iterate with the numerical stiffness of `shift`, see equation (1) of this module; `checks::shifted` compares
    /// its fixed point with [`update`](JointLaw::update).
    ///
    /// A closed form whose shear limit depends on the pressure should take the limit at [`Shift::bounding`]
    /// (theory/shifted-penalty.md, eq. 7), which makes its tangent symmetric; the default and a return that couples
    /// normal and shear by its flow do not read it, and drop the coupling from their tangent instead.
    fn update_shifted(
        &self,
        gap: [f64; 3],
        old: &InterfaceHistory,
        shift: &Shift,
    ) -> InterfaceResponse {
        in_series(|gap| self.update(gap, old), self.stiffness(), gap, shift)
    }
}

/// Solves equation (1) for a law `update` with the elastic stiffness `[k_n, k_s]`.
fn in_series(
    update: impl Fn([f64; 3]) -> InterfaceResponse,
    stiffness: [f64; 2],
    gap: [f64; 3],
    shift: &Shift,
) -> InterfaceResponse {
    let [normal, shear] = [0, 1].map(|i| 1.0 / shift.stiffness[i].min(stiffness[i]));
    let c = [
        normal - 1.0 / stiffness[0],
        shear - 1.0 / stiffness[1],
        shear - 1.0 / stiffness[1],
    ];
    let compliance = Matrix3::from_diagonal(&Vector3::from(c));
    let last = Vector3::from(shift.traction);
    let goal = Vector3::from(gap);
    // Residuals are measured as tractions with the numerical stiffness.
    let weight = Vector3::new(1.0 / normal, 1.0 / shear, 1.0 / shear);
    let residual =
        |x: &Vector3<f64>, t: [f64; 3]| x + compliance * (Vector3::from(t) - last) - goal;
    let size = |r: &Vector3<f64>| r.component_mul(&weight).norm();
    let scale = last.norm() + size(&goal) + f64::MIN_POSITIVE;

    // 1/(1 + C k) = k'/k.
    let elastic = Vector3::new(normal, shear, shear)
        .map(f64::recip)
        .component_div(&Vector3::new(stiffness[0], stiffness[1], stiffness[1]));

    let mut x = goal;
    let mut response = update(x.into());
    let mut rest = residual(&x, response.traction);
    for _ in 0..STEPS {
        let far = size(&rest);
        if !far.is_finite() || far <= CLOSE * scale {
            break;
        }
        let mut part = 1.0;
        let mut next = None;
        let jacobian = Matrix3::identity() + compliance * response.tangent;
        if let Some(step) = jacobian.lu().solve(&rest) {
            for _ in 0..HALVINGS {
                let at = x - step * part;
                let answer = update(at.into());
                let left = residual(&at, answer.traction);
                if size(&left) < far {
                    next = Some((at, answer, left));
                    break;
                }
                part *= 0.5;
            }
        }
        // Between two branches an elastic step reduces the residual at least by the factor 1 − k'/k.
        (x, response, rest) = next.unwrap_or_else(|| {
            let at = x - rest.component_mul(&elastic);
            let answer = update(at.into());
            (at, answer, residual(&at, answer.traction))
        });
    }
    let stiff = (Matrix3::identity() + response.tangent * compliance)
        .lu()
        .solve(&response.tangent)
        .unwrap_or_else(Matrix3::zeros);
    response.tangent = symmetric_blocks(&stiff, [1.0 / normal, 1.0 / shear]);
    [response.history.slip[0], response.history.slip[1]] = [gap[1], gap[2]];
    response
}

/// The normal and the shear block of a tangent, symmetric, with eigenvalues from 0 to `most` [N/mm³].
pub(crate) fn symmetric_blocks(tangent: &Matrix3<f64>, most: [f64; 2]) -> Matrix3<f64> {
    let mut blocks = Matrix3::zeros();
    blocks[(0, 0)] = tangent[(0, 0)].max(0.0).min(most[0]);
    let off = 0.5 * (tangent[(1, 2)] + tangent[(2, 1)]);
    let (mean, half) = (
        0.5 * (tangent[(1, 1)] + tangent[(2, 2)]),
        0.5 * (tangent[(1, 1)] - tangent[(2, 2)]),
    );
    // Eigenvalues are mean ± radius.
    let radius = half.hypot(off);
    if !(mean.is_finite() && radius.is_finite()) {
        return blocks;
    }
    let bounded = |k: f64| k.max(0.0).min(most[1]);
    let [high, low] = [bounded(mean + radius), bounded(mean - radius)];
    let part = if radius > 0.0 {
        0.5 * (high - low) / radius
    } else {
        0.0
    };
    blocks[(1, 1)] = 0.5 * (high + low) + part * half;
    blocks[(2, 2)] = 0.5 * (high + low) - part * half;
    blocks[(1, 2)] = part * off;
    blocks[(2, 1)] = part * off;
    blocks
}
