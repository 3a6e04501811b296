//! The cap law against closed forms (docs/theory/joint-cap.md, "Verification").

use wythe_contact::{Cap, CapCurve, InterfaceHistory, JointLaw, PointStatus, Shift};

/// Joints of the solid-clay walls of Raijmakers and Vermeltfoort, as modelled by Lourenço and Rots (1997). Tension
/// and cap have the same kind of softening.
fn law() -> Cap {
    Cap {
        normal_stiffness: 82.0,
        shear_stiffness: 36.0,
        f_t: 0.25,
        mode_1: 0.018,
        c: 0.35,
        mode_2: 0.125,
        tan_phi: 0.75,
        mu: 0.6,
        tan_psi: 0.0,
        sigma_u: f64::INFINITY,
        decay: 0.0,
        curve: CapCurve::with_energy(10.5, 0.09, 5.0).unwrap(),
        c_nn: 1.0,
        c_ss: 9.0,
        closes: true,
    }
}

fn dilatant() -> Cap {
    Cap {
        tan_psi: 0.5,
        sigma_u: 1.3,
        decay: 5.0,
        ..law()
    }
}

/// Histories of a point that starts undamaged and follows the gaps.
fn follow(law: &Cap, gaps: impl IntoIterator<Item = [f64; 3]>) -> Vec<InterfaceHistory> {
    let mut history = law.virgin();
    gaps.into_iter()
        .map(|gap| {
            history = law.update(gap, &history).history;
            history
        })
        .collect()
}

/// Shear at constant normal traction: each step iterates for the opening.
fn sheared(law: &Cap, sigma: f64, slips: impl IntoIterator<Item = f64>) -> Vec<InterfaceHistory> {
    let mut history = law.virgin();
    let mut u = sigma / law.normal_stiffness;
    slips
        .into_iter()
        .map(|slip| {
            for _ in 0..100 {
                let answer = law.update([u, slip, 0.0], &history);
                let off = answer.traction[0] - sigma;
                if off.abs() < 1e-12 {
                    break;
                }
                // At fixed slip the normal stiffness is the diagonal entry of the tangent.
                u -= off / answer.tangent[(0, 0)].max(1.0);
            }
            history = law.update([u, slip, 0.0], &history).history;
            assert!((history.traction[0] - sigma).abs() < 1e-9);
            history
        })
        .collect()
}

#[test]
fn tension_softens_exponentially_and_dissipates_its_energy() {
    let law = law();
    let n = 40_000;
    let end = 25.0 * law.mode_1 / law.f_t;
    let path = (1..=n).map(|k| [end * f64::from(k) / f64::from(n), 0.0, 0.0]);
    let (mut before, mut work) = ([0.0; 2], 0.0);
    for history in follow(&law, path) {
        let (u, sigma) = (history.opening, history.traction[0]);
        let plastic = u - sigma / law.normal_stiffness;
        if history.slots[0] > 0.0 {
            let exact = law.f_t * (-law.f_t * plastic / law.mode_1).exp();
            // Tolerance: rounding of k_n u.
            assert!((sigma - exact).abs() < 1e-12, "{sigma} {exact}");
            // Tensile strength and cohesion of the bond decrease in proportion.
            assert!((1.0 - history.damage - exact / law.f_t).abs() < 1e-12);
        }
        work += 0.5 * (sigma + before[1]) * (u - before[0]);
        before = [u, sigma];
    }
    // e^-25 remains. The trapezoidal rule with 40,000 steps has an error of 1e-7.
    assert!((work / law.mode_1 - 1.0).abs() < 1e-6, "{work}");
}

#[test]
fn an_opened_joint_closes_without_traction_until_its_faces_meet() {
    let law = law();
    let first = 0.5 * law.mode_1 / law.f_t;
    let path = [first, 0.5 * first, 0.0, -0.01, 1e-3, first].map(|u| [u, 0.0, 0.0]);
    let found = follow(&law, path);
    // Tolerances: rounding of k_n u.
    for (closing, sigma) in [(1, 0.0), (2, 0.0), (3, -0.01 * law.normal_stiffness)] {
        let difference = found[closing].traction[0] - sigma;
        assert!(difference.abs() < 1e-12, "{closing}: {difference}");
    }
    // The bond that was left holds until its strength is reached again. Openings add up.
    let strength = law.f_t * (1.0 - found[0].damage);
    let elastic = 1e-3 * law.normal_stiffness;
    assert!(elastic < strength && (found[4].traction[0] - elastic).abs() < 1e-12);
    let opened = [0, 5].map(|i| first - found[i].traction[0] / law.normal_stiffness);
    let exact = law.f_t * (-law.f_t * (opened[0] + opened[1]) / law.mode_1).exp();
    assert!((found[5].traction[0] - exact).abs() < 1e-12);
}

#[test]
fn a_joint_that_does_not_close_unloads_elastically_to_its_plastic_opening() {
    let law = Cap {
        closes: false,
        ..law()
    };
    let back = follow(&law, [[0.1, 0.0, 0.0], [0.099, 0.0, 0.0]]);
    let [first, second] = [0, 1].map(|i| back[i].traction[0]);
    assert!((first - second - 0.001 * law.normal_stiffness).abs() < 1e-12);
}

#[test]
fn shear_peaks_and_residuals_at_several_pressures() {
    for law in [law(), Cap { mu: 0.75, ..law() }] {
        for pressure in [0.1, 0.5, 1.0] {
            let slips: Vec<f64> = (1..=40_000).map(|k| 2e-4 * f64::from(k)).collect();
            let histories = sheared(&law, -pressure, slips.iter().copied());
            let peak = histories.iter().map(|h| h.traction[1]).fold(0.0, f64::max);
            let exact = law.c + law.tan_phi * pressure;
            // Tolerance: softening within one step of 2e-4 mm, c c/G_II: 2e-4 MPa.
            assert!((peak - exact).abs() < 3e-4, "{peak} {exact}");
            let last = histories[histories.len() - 1];
            let residual = law.mu * pressure;
            // e^(-c 8 mm/G_II) remains.
            assert!(
                (last.traction[1] - residual).abs() < 1e-9,
                "{:?}",
                last.traction
            );
            // Area above the residual friction.
            let (mut before, mut work) = ([0.0, residual], 0.0);
            for (slip, h) in slips.iter().zip(&histories) {
                let plastic = h.plastic_slip[0];
                let above = h.traction[1] - residual;
                if plastic > 0.0 {
                    work += 0.5 * (above + before[1]) * (plastic - before[0]);
                    before = [plastic, above];
                } else {
                    before = [0.0, exact - residual];
                }
                assert!(*slip > plastic);
            }
            let energy = law.mode_2 * (1.0 + (law.tan_phi - law.mu) * pressure / law.c);
            // Tolerance: the step at the peak, 2e-4 mm of some 0.3.
            assert!((work / energy - 1.0).abs() < 2e-3, "{work} {energy}");
        }
    }
}

#[test]
fn the_cap_reaches_its_strength_and_dissipates_its_energy() {
    for c_nn in [1.0, 1.44] {
        let law = Cap { c_nn, ..law() };
        let n = 100_000;
        let end = 10.0;
        let path = (1..=n).map(|k| [-end * f64::from(k) / f64::from(n), 0.0, 0.0]);
        let histories = follow(&law, path);
        let most = histories.iter().map(|h| -h.traction[0]).fold(0.0, f64::max);
        // Tolerance: one of 100,000 steps at a horizontal tangent.
        assert!((most * c_nn.sqrt() - 10.5).abs() < 1e-6, "{most}");
        let (mut before, mut work) = ([0.0, 0.0], 0.0);
        for h in &histories {
            let crushed = -(h.opening - h.traction[0] / law.normal_stiffness);
            let root = c_nn.sqrt();
            let strength = law.curve.evaluate(crushed).0 / root;
            if h.slots[2] > 0.0 {
                // Tolerance: rounding of k_n u.
                assert!((-h.traction[0] - strength).abs() < 1e-9, "{h:?}");
            }
            let above = -h.traction[0] - CapCurve::RESIDUAL * 10.5 / root;
            work += 0.5 * (above + before[1]) * (crushed - before[0]);
            before = [crushed, above];
        }
        // At 10 mm the exponential has ended. The vertical tangent at κ = 0 leaves an error of (1e-4/0.09)^1.5.
        assert!((work * c_nn.sqrt() / 5.0 - 1.0).abs() < 1e-4, "{work}");
    }
    // Shear with pressure: C_nn σ² + C_ss τ² = f_m² at the peak.
    let law = Cap {
        tan_phi: 2.0,
        mu: 2.0,
        ..law()
    };
    let mut most = 0.0_f64;
    for k in 1..=40_000 {
        let s = 2e-5 * f64::from(k);
        let gap = [-s, 0.5 * s, 0.5 * s];
        let h = follow(&law, [gap])[0];
        let [sigma, t1, t2] = h.traction;
        most = most.max((sigma * sigma + 9.0 * (t1 * t1 + t2 * t2)).sqrt());
    }
    assert!((most - 10.5).abs() < 1e-4, "{most}");
}

#[test]
fn slip_dilates_only_below_the_limit_pressure() {
    // The cap is moved far away, because it would close the joint.
    let law = Cap {
        curve: CapCurve::with_energy(60.0, 0.09, 40.0).unwrap(),
        ..dilatant()
    };
    for pressure in [0.1, 0.6, 1.3, 2.0] {
        let slips = (1..=20_000).map(|k| 1e-4 * f64::from(k));
        let histories = sheared(&law, -pressure, slips);
        let last = histories[histories.len() - 1];
        let plastic = last.plastic_slip[0];
        let start = law.tan_psi * (1.0 - pressure / law.sigma_u).max(0.0);
        let exact = start * (1.0 - (-law.decay * plastic).exp()) / law.decay;
        // Implicit steps evaluate the dilatancy at their ends: an error of half of 1e-4 mm over 1/δ = 0.2 mm.
        assert!(
            (last.slots[0] - exact).abs() < 5e-4 * exact + 1e-12,
            "{} {exact}",
            last.slots[0]
        );
    }
    // At fixed opening the dilatancy causes pressure instead.
    let held = follow(&law, [[0.0, 0.02, 0.0], [0.0, 0.1, 0.0]]);
    assert!(held[1].traction[0] < held[0].traction[0] && held[0].traction[0] < 0.0);
}

#[test]
fn corners_of_tension_friction_and_cap_lie_on_both_surfaces() {
    let law = law();
    // Large simultaneous opening and slip.
    let h = follow(&law, [[0.05, 0.2, 0.1]])[0];
    let left = 1.0 - h.damage;
    assert!((h.traction[0] - law.f_t * left).abs() < 1e-12);
    let tau = h.traction[1].hypot(h.traction[2]);
    let friction = law.mu + (law.tan_phi - law.mu) * left;
    assert!((tau - (law.c * left - friction * h.traction[0])).abs() < 1e-12);
    // The loss of the bond is the sum of both modes: -ln(1 - D) = f_t u_p/G_I + c s_p/G_II.
    let loss = law.f_t * h.slots[0] / law.mode_1
        + law.c * h.plastic_slip[0].hypot(h.plastic_slip[1]) / law.mode_2;
    assert!((-left.ln() - loss).abs() < 1e-10, "{left} {loss}");
    // Slip at a pressure where cap and friction surface meet.
    let h = follow(&law, [[-0.015, 0.1, 0.0]])[0];
    let [sigma, tau, _] = h.traction;
    let left = 1.0 - h.damage;
    let friction = law.mu + (law.tan_phi - law.mu) * left;
    assert!(
        (tau + friction * sigma - law.c * left).abs() < 1e-9,
        "{h:?}"
    );
    let strength = law.curve.evaluate(h.slots[2]).0;
    assert!(((sigma * sigma + 9.0 * tau * tau).sqrt() - strength).abs() < 1e-9);
    assert!(h.slots[1] > 0.0 && h.slots[2] > 0.0);
    let answer = law.update([-0.015, 0.1, 0.0], &law.virgin());
    assert_eq!(answer.status, PointStatus::Slip);
}

#[test]
fn the_half_of_a_joint_has_half_the_opening_at_the_same_traction() {
    let (whole, half) = (law(), law().half());
    for gaps in [
        vec![0.001, 0.01, 0.05, 0.03, -0.01, 0.2],
        vec![-0.05, -0.2, -0.15, -0.6, -2.0],
    ] {
        let at = |part: f64| gaps.iter().map(move |u| [part * u, 0.0, 0.0]);
        for (a, b) in follow(&whole, at(1.0)).iter().zip(follow(&half, at(0.5))) {
            assert!((a.traction[0] - b.traction[0]).abs() < 1e-10, "{a:?} {b:?}");
        }
    }
    let slid = follow(&half, [[-0.01, 0.5, 0.2]])[0];
    assert_eq!([slid.traction[1], slid.traction[2], slid.damage], [0.0; 3]);
}

#[test]
fn iterates_with_a_soft_stiffness_converge_to_the_law() {
    for law in [law(), dilatant()] {
        let mut old = law.virgin();
        for gap in [
            [0.001, 0.001, 0.0],
            [0.02, 0.01, 0.0],
            [-0.01, 0.03, 0.01],
            [-0.2, 0.4, 0.0],
            [-0.1, 0.1, 0.0],
            [-0.5, 0.1, 0.3],
        ] {
            let exact = law.update(gap, &old);
            let mut shift = Shift {
                stiffness: [20.0, 9.0],
                traction: old.traction,
                bounding: 0.0,
            };
            let mut last = exact;
            for _ in 0..400 {
                last = law.update_shifted(gap, &old, &shift);
                shift.traction = last.traction;
            }
            for i in 0..3 {
                // Tolerance: 400 iterates of a contraction, and the stopping width of the root search.
                let off = last.traction[i] - exact.traction[i];
                assert!(
                    off.abs() < 1e-7,
                    "{gap:?}: {:?} {:?}",
                    last.traction,
                    exact.traction
                );
            }
            assert!((last.history.opening - gap[0]).abs() < 1e-8);
            old = exact.history;
        }
    }
}
