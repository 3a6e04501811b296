//! A joint law without tension in few lines, as docs/how-to/add-a-joint-law.md shows it, passes all checks.

use nalgebra::{Matrix2, Matrix3, Vector2};
use wythe_contact::checks::{Path, dissipation, objectivity, shifted, tangent};
use wythe_contact::{InterfaceHistory, InterfaceResponse, JointLaw};

/// Coulomb friction μ of a joint without bond, stiffnesses [N/mm³].
#[derive(Debug)]
struct NoTension {
    stiffness: [f64; 2],
    mu: f64,
}

impl JointLaw for NoTension {
    fn name(&self) -> &'static str {
        "no tension"
    }
    fn stiffness(&self) -> [f64; 2] {
        self.stiffness
    }
    fn is_dry(&self) -> bool {
        true
    }
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        let [k_n, k_s] = self.stiffness;
        let sigma = k_n * gap[0].min(0.0);
        let before = Vector2::from(old.plastic_slip);
        let trial = k_s * (Vector2::new(gap[1], gap[2]) - before);
        let (size, limit) = (trial.norm(), -self.mu * sigma);
        let (mut tau, mut after, mut shear) = (trial, before, k_s * Matrix2::identity());
        let mut tangent = Matrix3::zeros();
        tangent[(0, 0)] = if sigma < 0.0 { k_n } else { 0.0 };
        if size > limit {
            let n = trial / size;
            (tau, after) = (limit * n, before + (size - limit) / k_s * n);
            shear = k_s * limit / size * (Matrix2::identity() - n * n.transpose());
            let by_opening = -self.mu * tangent[(0, 0)] * n;
            tangent.fixed_view_mut::<2, 1>(1, 0).copy_from(&by_opening);
        }
        tangent.fixed_view_mut::<2, 2>(1, 1).copy_from(&shear);
        // The opening is elastic: its plastic part stays 0. The damage of a joint without bond is 1.
        let plastic = [[0.0, before.x, before.y], [0.0, after.x, after.y]];
        let traction = [sigma, tau.x, tau.y];
        let (slots, opens_at) = (old.slots, self.opens_at());
        InterfaceResponse::new(
            old,
            gap,
            traction,
            tangent,
            plastic,
            1.0,
            slots,
            self.stiffness,
            opens_at,
        )
    }
    /// The stiffness is k_n where the joint is closed, and 0 where it is open.
    fn crossing_work(&self, old: &InterfaceHistory, new: &InterfaceHistory) -> f64 {
        let k = |h: &InterfaceHistory| {
            if h.opening < 0.0 {
                self.stiffness[0]
            } else {
                0.0
            }
        };
        0.5 * (old.opening * new.opening).min(0.0) * (k(old) - k(new))
    }
}

#[test]
fn a_joint_without_tension_passes_all_checks() {
    let law = NoTension {
        stiffness: [500.0, 200.0],
        mu: 0.6,
    };
    assert_eq!(law.virgin().damage, 1.0);
    let mut all_lost = 0.0;
    for seed in 0..40 {
        let path = Path::random(seed, 30, 0.02, 0.02);
        // Rounding of 1e-15 over the step, and the curvature of the direction of slip over it.
        tangent(&law, &path, 1e-8, 2e-4).unwrap();
        // Rounding of 30 steps.
        objectivity(&law, &path, 0.7, 1e-12).unwrap();
        // The trapezoidal rule leaves a part of a step in which the point begins to slide.
        let [_, lost] = dissipation(&law, &path.divided(400), 2e-4).unwrap();
        all_lost += lost;
        // Newton's method of the default iterate ends at 1e-12 of the tractions.
        shifted(&law, &path, 0.25, 1e-10).unwrap();
    }
    assert!(all_lost > 0.0);
}

/// Without the crossing work the energies of a joint that opens do not balance.
#[derive(Debug)]
struct Forgetful(NoTension);

impl JointLaw for Forgetful {
    fn name(&self) -> &'static str {
        "forgetful"
    }
    fn stiffness(&self) -> [f64; 2] {
        self.0.stiffness
    }
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        self.0.update(gap, old)
    }
}

#[test]
fn a_joint_that_opens_needs_its_crossing_work() {
    let law = Forgetful(NoTension {
        stiffness: [500.0, 200.0],
        mu: 0.6,
    });
    let path = Path(vec![[-0.01, 0.0, 0.0], [0.01, 0.0, 0.0]]);
    let error = dissipation(&law, &path, 1e-6).unwrap_err();
    assert!(error.what.contains("open by"), "{error}");
    dissipation(&law.0, &path, 1e-12).unwrap();
}
