//! The checks for joint laws, applied to all laws of the registry.

use nalgebra::Matrix3;
use wythe_contact::checks::{Path, dissipation, objectivity, shifted, tangent};
use wythe_contact::{
    Cap, CapCurve, CohesiveFrictional, Coupling, InterfaceHistory, InterfaceLaw, InterfaceResponse,
    JointLaw, Shift, registry,
};

fn cohesive(coupling: Coupling) -> CohesiveFrictional {
    CohesiveFrictional {
        f_t: 0.28,
        c: 0.87,
        tan_phi: 1.01,
        mu: 0.73,
        u_k: 0.2,
        delta_k: 0.4,
        zeta: 4.38,
        xi: 1.1,
        normal_stiffness: 9900.0,
        shear_stiffness: 9900.0 / 2.3,
        coupling,
    }
}

fn cap(tan_psi: f64) -> Cap {
    Cap {
        normal_stiffness: 82.0,
        shear_stiffness: 36.0,
        f_t: 0.25,
        mode_1: 0.018,
        c: 0.35,
        mode_2: 0.125,
        tan_phi: 0.75,
        mu: 0.6,
        tan_psi,
        sigma_u: 1.3,
        decay: 5.0,
        curve: CapCurve::with_energy(10.5, 0.09, 5.0).unwrap(),
        c_nn: 1.0,
        c_ss: 9.0,
        closes: true,
    }
}

/// Laws with the scales of opening and closing of their random paths [mm]; every kind occurs.
fn laws() -> Vec<(InterfaceLaw, [f64; 2])> {
    let dry = CohesiveFrictional::dry(0.65, 5000.0, 2000.0);
    let laws = vec![
        (cohesive(Coupling::Max).into(), [0.01, 1e-4]),
        (cohesive(Coupling::Additive).into(), [0.01, 1e-4]),
        (dry.into(), [1e-3, 1e-4]),
        (cap(0.0).into(), [0.02, 0.02]),
        (cap(0.0).into(), [0.05, 0.2]),
        (cap(0.5).into(), [0.02, 0.02]),
        (
            Cap {
                closes: false,
                ..cap(0.5)
            }
            .into(),
            [0.02, 0.02],
        ),
        (
            Cap {
                f_t: 0.0,
                c: 0.0,
                ..cap(0.3)
            }
            .into(),
            [0.02, 0.02],
        ),
        (cap(0.0).half().into(), [0.02, 0.02]),
    ];
    for kind in registry::KINDS {
        assert!(
            laws.iter()
                .any(|(law, _): &(InterfaceLaw, _)| law.name() == kind),
            "{kind}"
        );
    }
    laws
}

#[test]
fn tangents_are_the_derivatives() {
    for (law, [unit, closing]) in laws() {
        let (mut columns, mut corners) = (0, 0);
        for seed in 0..60 {
            let path = Path::random(seed, 30, unit, closing);
            // Tolerance: rounding of 1e-15 over the step, and the curvature over it.
            let found = tangent(&law, &path, 1e-8, 2e-4).unwrap_or_else(|e| panic!("{e} {law:?}"));
            columns += found.columns;
            corners += found.corners;
        }
        println!("{}: {columns} columns, {corners} at corners", law.name());
        assert!(corners * 100 < columns, "{corners} of {columns}: {law:?}");
    }
}

#[test]
fn tractions_rotate_and_mirror_with_the_gap() {
    for (law, [unit, closing]) in laws() {
        for seed in 0..40 {
            let path = Path::random(seed, 40, unit, closing);
            // Tolerance: rounding of 40 steps, amplified a thousandfold by softening.
            objectivity(&law, &path, 0.3 + seed as f64, 1e-9)
                .unwrap_or_else(|e| panic!("{e} {law:?}"));
        }
    }
}

#[test]
fn energies_balance_and_dissipation_is_not_negative() {
    for (law, [unit, closing]) in laws() {
        for seed in 0..10 {
            let path = Path::random(seed, 40, unit, closing).divided(400);
            // Tolerance: within a step the trapezoidal rule and corners of the law leave a fraction of the step's
            // energy.
            let [work, lost] =
                dissipation(&law, &path, 2e-4).unwrap_or_else(|e| panic!("{e} {law:?}"));
            assert!(law.is_dry() || lost > 0.0, "{work} {lost}");
        }
    }
}

#[test]
fn iterates_settle_at_the_law() {
    for (law, [unit, closing]) in laws() {
        for seed in 0..40 {
            let path = Path::random(seed, 30, unit, closing);
            // Iterates end at 1e-14 of the tractions, four times as far from the fixed point as the last change;
            // softening multiplies it a thousandfold.
            shifted(&law, &path, 0.25, 1e-10).unwrap_or_else(|e| panic!("{e} {law:?}"));
        }
    }
}

#[test]
fn the_cap_law_stays_within_its_cut_off_in_a_long_slip() {
    let law = cap(0.0);
    // The trial is beyond friction and cap, not beyond the cut-off; the slip takes the bond away.
    let answer = law.update([0.9 * 0.25 / 82.0, 0.06, 0.0], &law.virgin());
    let strength = 0.25 * (1.0 - answer.history.damage);
    // Both surfaces are active: σ is the strength but for rounding.
    assert!(
        (answer.traction[0] / strength - 1.0).abs() < 1e-12,
        "{answer:?}"
    );
    // Where the cap softens in shear iterates settle with a twentieth of the stiffness, too.
    shifted(&law, &Path::random(21, 30, 0.02, 0.02), 0.05, 1e-10).unwrap();
}

/// Under pressure alone |σ| = f̄/√C_nn and κ is the plastic closing: the cap softens by f̄'/√C_nn, which the numerical
/// stiffness must stay above.
#[test]
fn iterates_settle_for_any_shape_of_the_cap() {
    for c_nn in [0.25, 4.0] {
        let law = Cap { c_nn, ..cap(0.0) };
        for seed in 0..40 {
            // Tolerance: five times that at a quarter of the stiffness, because a twentieth is a fifth of it.
            let path = Path::random(seed, 30, 0.02, 0.3);
            shifted(&law, &path, 0.05, 5e-10).unwrap_or_else(|e| panic!("{e} {law:?}"));
        }
    }
}

/// The cap law with the defaults of the trait.
#[derive(Debug)]
struct Plain(Cap);

impl JointLaw for Plain {
    fn name(&self) -> &'static str {
        "plain"
    }
    fn stiffness(&self) -> [f64; 2] {
        self.0.stiffness()
    }
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        self.0.update(gap, old)
    }
}

#[test]
fn the_default_shifted_update_equals_the_closed_form() {
    let (mut compared, mut tangents) = (0, 0);
    for seed in 0..40 {
        let own = Cap {
            normal_stiffness: if seed % 2 == 0 { 82.0 } else { 360.0 },
            shear_stiffness: if seed % 2 == 0 { 36.0 } else { 200.0 },
            ..cap(0.0)
        };
        let plain = Plain(own);
        let mut old = own.virgin();
        for gap in Path::random(seed, 30, 0.02, 0.02).0 {
            // Above the steepest softening slopes, 21 N/mm³ of the cap and 1 N/mm³ of the bond in shear.
            let shift = Shift {
                stiffness: if seed % 2 == 0 {
                    [40.0, 11.0]
                } else {
                    [84.0, 5.0]
                },
                traction: old.traction,
                bounding: old.traction[0],
            };
            let closed = own.update_shifted(gap, &old, &shift);
            let found = plain.update_shifted(gap, &old, &shift);
            let pairs = closed.traction.iter().zip(&found.traction);
            let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // Newton's method ends at 1e-12 of the tractions; softening amplifies the difference.
            assert!(off < 1e-8, "{gap:?} {old:?}: {closed:?} {found:?}");
            // At corners of the law the tangent of either side is right.
            tangents += usize::from((closed.tangent - found.tangent).amax() < 1e-6 * 84.0);
            compared += 1;
            assert!((found.tangent - found.tangent.transpose()).amax() < 1e-12);
            old = own.update(gap, &old).history;
        }
    }
    assert!(tangents * 100 > 99 * compared, "{tangents} of {compared}");
    // The law limits a guess to the admissible tractions.
    let plain = Plain(cap(0.0));
    let bound = plain.within_bounds([1.0, 2.0, 0.0], &plain.virgin());
    assert!(bound[0] <= 0.25 && bound[1] <= 0.35, "{bound:?}");
}

#[derive(Debug)]
struct Wrong(&'static str);

impl JointLaw for Wrong {
    fn name(&self) -> &'static str {
        self.0
    }
    fn stiffness(&self) -> [f64; 2] {
        [10.0, 10.0]
    }
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        let mut traction = gap.map(|g| 10.0 * g);
        let mut tangent = Matrix3::identity() * 10.0;
        match self.0 {
            "slope" => tangent[(0, 0)] = 9.0,
            "axis" => {
                traction[1] *= 0.5;
                tangent[(1, 1)] *= 0.5;
            }
            "source" => {
                traction[0] = if gap[0] > old.opening {
                    traction[0]
                } else {
                    2.0 * traction[0]
                }
            }
            "right" => {}
            _ => traction[0] = f64::NAN,
        }
        InterfaceResponse::new(
            old,
            gap,
            traction,
            tangent,
            [[0.0; 3]; 2],
            0.0,
            [0.0; 4],
            [10.0, 10.0],
            0.0,
        )
    }
}

/// Linear elasticity whose iterate is wrong.
#[derive(Debug)]
struct WrongIterate(&'static str);

impl JointLaw for WrongIterate {
    fn name(&self) -> &'static str {
        self.0
    }
    fn stiffness(&self) -> [f64; 2] {
        [10.0, 10.0]
    }
    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        Wrong("right").update(gap, old)
    }
    fn update_shifted(
        &self,
        gap: [f64; 3],
        old: &InterfaceHistory,
        shift: &Shift,
    ) -> InterfaceResponse {
        let mut answer = self.update(gap, old);
        let k = shift.stiffness[0];
        answer.traction = [0, 1, 2].map(|i| k * gap[i] + (1.0 - k / 10.0) * shift.traction[i]);
        answer.tangent = Matrix3::identity() * k;
        match self.0 {
            "short" => answer.traction = answer.traction.map(|t| 0.9 * t),
            "swings" => answer.traction[0] = gap[0] - shift.traction[0],
            "skew" => answer.tangent[(1, 0)] = 0.1 * k,
            "softens" => answer.tangent[(0, 0)] = -0.1 * k,
            "forgets" => answer.history.plastic_slip = [1.0, 0.0],
            _ => {}
        }
        answer
    }
}

#[test]
fn wrong_iterates_are_found() {
    let path = Path::random(1, 20, 0.1, 0.1);
    assert!(shifted(&WrongIterate("right"), &path, 0.25, 1e-10).is_ok());
    for (wrong, said) in [
        ("short", "traction of the settled iterate"),
        ("swings", "does not settle"),
        ("skew", "not symmetric"),
        ("softens", "eigenvalue"),
        ("forgets", "lengths"),
    ] {
        let error = shifted(&WrongIterate(wrong), &path, 0.25, 1e-10).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
}

#[test]
fn wrong_laws_are_found() {
    let path = Path::random(1, 20, 0.1, 0.1);
    let found = [
        tangent(&Wrong("slope"), &path, 1e-6, 1e-4).unwrap_err(),
        objectivity(&Wrong("axis"), &path, 0.7, 1e-9).unwrap_err(),
        dissipation(&Wrong("source"), &path, 1e-6).unwrap_err(),
        dissipation(&Wrong("nothing"), &path, 1e-6).unwrap_err(),
    ];
    let said = ["tangent", "turned", "open by", "not finite"];
    for (error, said) in found.iter().zip(said) {
        assert!(error.to_string().contains(said), "{error}");
    }
    assert_eq!(found[0].law, "slope");
}
