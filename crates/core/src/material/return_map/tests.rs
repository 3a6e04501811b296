//! Comparison of the explicit solution in μ with the general one.

use super::*;
use crate::material::DamagePlasticityParameters;
use crate::material::sample::brick;

fn laws() -> Vec<DamagePlasticity> {
    let with = |dilation_angle, eccentricity, k_c| {
        let p = DamagePlasticityParameters {
            dilation_angle,
            eccentricity,
            k_c,
            ..brick(
                &[[3.5, 0.0, 0.0], [0.3, 0.002, 0.95]],
                &[[11.0, 0.0, 0.0], [11.5, 0.001, 0.0], [0.6, 0.007, 0.95]],
            )
        };
        DamagePlasticity::new(&p, None).expect("a sound table").0
    };
    vec![
        with(0.17, 0.1, 2.0 / 3.0),
        with(0.6, 1.0, 0.55),
        with(0.1, 0.01, 1.0),
    ]
}

/// Trial states of all sizes, including hydrostatic states and states without mean stress.
fn trials() -> Vec<TrialStress> {
    let mut trials = Vec::new();
    for size in [1e-3, 1.0, 4.0, 12.0, 60.0, 900.0_f64] {
        for k in 0..12 {
            for l in 0..7 {
                let angle = f64::from(k) * std::f64::consts::PI / 33.0;
                let mean = size * (f64::from(l) - 3.0) / 2.0;
                let q = size * f64::from((k * l) % 5);
                let third = 2.0 * std::f64::consts::PI / 3.0;
                let s = [angle, angle - third, angle + third].map(|a| 2.0 / 3.0 * q * a.cos());
                for kappa in [0.0, 3e-4, 8e-3] {
                    trials.push(TrialStress {
                        mean,
                        q,
                        s,
                        kappa_t: kappa,
                        kappa_c: 2.0 * kappa,
                        curve_index: [0; 2],
                    });
                }
            }
        }
    }
    trials
}

/// Both solutions find the same root, and the explicit one nearly always converges.
#[test]
fn both_root_searches_agree() {
    let (mut explicit, mut all) = (0, 0);
    for law in laws() {
        for trial in trials() {
            let start = law.point(&trial, 0.0);
            if start.f <= 1e-9 {
                continue;
            }
            all += 1;
            let rounding = 8.0 * f64::EPSILON * (trial.q + trial.mean.abs());
            let tolerance = (1e-12 * 11.0_f64).max(rounding);
            let slow = law.bracketed(&trial, &start, tolerance).expect("a root");
            let Some(found) = law.along_curve(&trial, &start, tolerance) else {
                // The exceptions lie near the apex of the potential, where f is curved in μ.
                assert!(trial.q == 0.0 || slow.eta < 0.3, "{trial:?} {slow:?}");
                continue;
            };
            explicit += 1;
            assert!(found.f.abs() <= tolerance && slow.f.abs() <= tolerance);
            // Slopes exceed 1e-3 E: tolerance is that of f over the slope, plus rounding of the trial stress.
            let close = 1e3 * (tolerance + rounding);
            for (a, b) in found.stress.iter().zip(slow.stress) {
                assert!((a - b).abs() <= close, "{trial:?}: {found:?} {slow:?}");
            }
            assert!((found.lambda - slow.lambda).abs() <= close / law.shear);
            assert!((found.phi - slow.phi).abs() * trial.q <= close / law.shear);
        }
    }
    assert!(2 * explicit > all, "{explicit} of {all}");
}

/// df/dμ equals −f_λ/η_λ from the general derivatives.
#[test]
fn the_derivative_along_mu_equals_the_general_one() {
    for law in laws() {
        for trial in trials() {
            for mu in [0.0, 0.1, 0.7, 0.97] {
                let p = law.point_at(&trial, mu);
                let slope = law.slope(&trial, &p, &Variation::along_lambda());
                let general = -slope.f[0] / slope.eta[0];
                let own = law.fall(&trial, &p);
                // Tolerance: rounding of the sums.
                let terms = trial.q + law.bulk * law.dilation / slope.eta[0].abs() + general.abs();
                assert!(
                    (own - general).abs() <= 1e-11 * terms,
                    "{own} {general} {p:?}"
                );
            }
        }
    }
}
