//! The interface law against golden curves, closed forms and its own derivatives.

use crate::common::{Random, csv, table_1, table_3};
use wythe::contact::{CohesiveFrictional, Coupling, InterfaceHistory, Shift};

fn laws() -> Vec<CohesiveFrictional> {
    let mut all = vec![table_1(), table_3()];
    let hardening = CohesiveFrictional {
        mu: 1.4,
        zeta: 0.2,
        xi: 6.0,
        ..table_1()
    };
    all.push(hardening);
    let additive: Vec<_> = all
        .iter()
        .map(|l| CohesiveFrictional {
            coupling: Coupling::Additive,
            ..*l
        })
        .collect();
    all.extend(additive);
    all.push(CohesiveFrictional::dry(0.65, 5000.0, 2000.0));
    all
}

#[test]
fn golden_curves() {
    let law = table_1();
    for name in ["mode1_cyclic", "mode2_cyclic", "mode2_sig0.5", "mixed45"] {
        let table = csv(&format!("golden/itf_T1_{name}.csv"));
        let mut history = law.virgin();
        let mut worst: f64 = 0.0;
        for i in 0..table["u_mm"].len() {
            let gap = ["u_mm", "d1_mm", "d2_mm"].map(|c| table[c][i]);
            history = law.update(gap, &history).history;
            let golden = ["sig_be_MPa", "tau1_be_MPa", "tau2_be_MPa"].map(|c| table[c][i]);
            for k in 0..3 {
                worst = worst.max((history.traction[k] - golden[k]).abs());
            }
            worst = worst.max((history.damage - table["D_be"][i]).abs());
        }
        println!("{name}: {worst:.1e} MPa");
        // Tolerance: the curves are given to 1e-12 MPa; gaps with 15 digits times k_n = 1e5 N/mm³ leave 1e-11.
        assert!(worst < 1e-10, "{name}: {worst:.2e}");
        // Substepping converges to the exact path.
        let errors = [1, 10, 100].map(|n| {
            let mut history = law.virgin();
            let mut last = [0.0; 3];
            let mut worst: f64 = 0.0;
            for i in 0..table["u_mm"].len() {
                let gap = ["u_mm", "d1_mm", "d2_mm"].map(|c| table[c][i]);
                for s in 1..=n {
                    let f = f64::from(s) / f64::from(n);
                    let at = [0, 1, 2].map(|k| last[k] + f * (gap[k] - last[k]));
                    history = law.update(at, &history).history;
                }
                last = gap;
                let exact = ["sig_ex_MPa", "tau1_ex_MPa", "tau2_ex_MPa"].map(|c| table[c][i]);
                for k in 0..3 {
                    worst = worst.max((history.traction[k] - exact[k]).abs());
                }
            }
            worst
        });
        println!("{name}: substeps 1, 10, 100: {errors:?}");
        // At least first order, or exact from the start (the exact columns are given to 1e-11).
        assert!(errors[2] < 0.02 * errors[0] + 1e-10, "{name}: {errors:?}");
    }
}

#[test]
fn figure_7_tension_and_shear() {
    let law = table_1();
    assert!((law.mode_1_energy() * 1e3 - 12.08).abs() < 5e-3);
    for (sigma, peak, residual) in [
        (0.1, 0.971, 0.073),
        (0.5, 1.375, 0.365),
        (1.0, 1.880, 0.730),
    ] {
        let u = -sigma / law.normal_stiffness;
        let mut history = law.virgin();
        let mut top: f64 = 0.0;
        for k in 1..=4500 {
            // Elastic slip is 2e-5 mm at k_s, so that steps are smaller at first.
            let d = if k <= 500 {
                1e-7 * f64::from(k)
            } else {
                1e-4 * f64::from(k - 500) + 5e-5
            };
            history = law.update([u, d, 0.0], &history).history;
            top = top.max(history.traction[1]);
        }
        // Peak c + sigma tan phi and friction mu sigma are exact. 0.1 % allows for softening within one step of 1e-7
        // mm.
        assert!((top - peak).abs() < 1e-3 * peak, "{top}");
        assert!((history.traction[1] - residual).abs() < 1e-3 * residual);
    }
}

#[test]
fn softening_curves_of_the_data() {
    let table = csv("exact/daltri_interface_tension.csv");
    let law = table_1();
    for (i, w) in table["u_mm"].iter().enumerate() {
        let u = w + law.f_t / law.normal_stiffness;
        let sigma = law.update([u, 0.0, 0.0], &law.virgin()).traction[0];
        // Tolerance: six printed digits.
        assert!((sigma - table["sigma_T1_MPa"][i]).abs() < 6e-7);
    }
    let table = csv("exact/daltri_interface_shear.csv");
    for (column, sigma) in [("tau_s0.1", 0.1), ("tau_s0.5", 0.5), ("tau_s1.0", 1.0)] {
        for (i, slip) in table["slip_mm"].iter().enumerate() {
            let golden = table[column][i];
            let d = slip + golden / law.shear_stiffness;
            let tau = law
                .update([-sigma / law.normal_stiffness, d, 0.0], &law.virgin())
                .traction[1];
            // Tolerance: six printed digits; slip is measured without its elastic part.
            assert!((tau - golden).abs() < 6e-6, "{tau} {golden}");
        }
    }
}

fn walk(random: &mut Random, law: &CohesiveFrictional, steps: usize) -> Vec<[f64; 3]> {
    let unit = if law.is_dry() { 1e-3 } else { 0.05 * law.u_k };
    let mut gap = [0.0; 3];
    let mut drift = [0.0; 3];
    (0..steps)
        .map(|step| {
            if step % 6 == 0 {
                drift = [random.signed() * 0.5, random.signed(), random.signed()];
            }
            for k in 0..3 {
                gap[k] += unit * (drift[k] + 0.3 * random.signed());
            }
            // In compression the gap has the scale of the penetration.
            let u = if gap[0] < 0.0 {
                gap[0] * 2.0 / (law.normal_stiffness * unit)
            } else {
                gap[0]
            };
            [u, gap[1], gap[2]]
        })
        .collect()
}

#[test]
fn tangents_match_central_differences() {
    let mut random = Random(11);
    let (mut checked, mut kinks) = (0, 0);
    for law in laws() {
        for _ in 0..40 {
            let mut old = law.virgin();
            for gap in walk(&mut random, &law, 30) {
                let answer = law.update(gap, &old);
                for j in 0..3 {
                    // A thousandth of the elastic slip.
                    let h = 1e-9;
                    let side = |s: f64| {
                        let mut g = gap;
                        g[j] += s * h;
                        law.update(g, &old).traction
                    };
                    let (up, down) = (side(1.0), side(-1.0));
                    let (mut central, mut one_sided) = (0.0_f64, [0.0_f64; 2]);
                    for i in 0..3 {
                        let t = answer.tangent[(i, j)];
                        central = central.max(((up[i] - down[i]) / (2.0 * h) - t).abs());
                        one_sided[0] =
                            one_sided[0].max(((up[i] - answer.traction[i]) / h - t).abs());
                        one_sided[1] =
                            one_sided[1].max(((answer.traction[i] - down[i]) / h - t).abs());
                    }
                    // Tolerance: rounding 1e-16/1e-9 of tractions of 1 MPa, and curvature of the return direction
                    // over h: 1e-4 of k.
                    let scale = law.normal_stiffness;
                    if central > 1e-4 * scale {
                        kinks += 1;
                        let nearest = one_sided[0].min(one_sided[1]);
                        assert!(
                            nearest < 1e-3 * scale,
                            "{nearest:.2e} {central:.2e} {law:?}"
                        );
                    }
                    checked += 1;
                }
                old = answer.history;
            }
        }
    }
    println!("{checked} columns, {kinks} at kinks");
    assert!(kinks * 200 < checked, "{kinks} of {checked}");
}

/// Name, path to the state, the state [mm], the step of the finite difference [mm].
type Named<'a> = (&'a str, &'a [[f64; 3]], [f64; 3], f64);

#[test]
fn tangents_of_every_named_state() {
    for law in laws().into_iter().filter(|l| !l.is_dry()) {
        let u0 = law.f_t / law.normal_stiffness;
        let p = -0.5 / law.normal_stiffness;
        // Slip at which |τ| reaches the cohesion c + tanφ |σ| of an undamaged point.
        let limit = (law.c + 0.5 * law.tan_phi) / law.shear_stiffness;
        let (just, over) = (1.0 - 1e-6, 1.0 + 1e-6);
        // The finite difference stays on one side of a corner.
        let states: [Named; 14] = [
            ("elastic, pulled", &[], [0.3 * u0, 1e-6, -2e-6], 1e-10),
            ("elastic, pressed", &[], [p, 5e-6, 3e-6], 1e-10),
            (
                "softening in tension",
                &[[0.01, 0.0, 0.0]],
                [0.02, 0.0, 0.0],
                1e-9,
            ),
            (
                "unloading in tension",
                &[[0.05, 0.0, 0.0]],
                [0.03, 0.0, 0.0],
                1e-9,
            ),
            (
                "closing of an opened point",
                &[[0.05, 0.0, 0.0]],
                [p, 1e-6, 0.0],
                1e-10,
            ),
            (
                "slipping under pressure",
                &[[p, 0.01, 0.0]],
                [p, 0.02, 0.0],
                1e-9,
            ),
            (
                "slipping round a bend",
                &[[p, 0.02, 0.0]],
                [p, 0.015, 0.02],
                1e-9,
            ),
            (
                "unloading in shear",
                &[[p, 0.02, 0.0]],
                [p, 0.02 - 0.5 * limit, 0.0],
                1e-10,
            ),
            ("reversal", &[[p, 0.05, 0.01]], [p, -0.02, 0.0], 1e-9),
            (
                "opening and slipping",
                &[[0.01, 0.01, 0.0]],
                [0.02, 0.03, 0.01],
                1e-9,
            ),
            (
                "before the tensile corner",
                &[],
                [just * u0, 0.0, 0.0],
                u0 * 3e-7,
            ),
            (
                "after the tensile corner",
                &[],
                [over * u0, 0.0, 0.0],
                u0 * 3e-7,
            ),
            (
                "before the shear corner",
                &[],
                [p, just * limit, 0.0],
                limit * 1e-7,
            ),
            (
                "after the shear corner",
                &[],
                [p, over * limit, 0.0],
                limit * 1e-7,
            ),
        ];
        for (name, path, gap, h) in states {
            let old = path
                .iter()
                .fold(law.virgin(), |old, g| law.update(*g, &old).history);
            let answer = law.update(gap, &old);
            for j in 0..3 {
                let side = |s: f64| {
                    let mut g = gap;
                    g[j] += s * h;
                    law.update(g, &old).traction
                };
                let (up, down) = (side(1.0), side(-1.0));
                for i in 0..3 {
                    let error = ((up[i] - down[i]) / (2.0 * h) - answer.tangent[(i, j)]).abs();
                    // Tolerance: rounding 1e-16 of tractions over h ≥ 8e-13, and the next derivative (the direction
                    // rotates over
                    // δ_e| = 3e-5 mm) times h²: below 1e-6 of k.
                    assert!(
                        error < 1e-6 * law.normal_stiffness,
                        "{name}: ({i},{j}) {error:.1e} {law:?}"
                    );
                }
            }
        }
    }
}

/// Twenty substeps between two gaps, and one more where the path crosses u = 0. There the secant stiffness changes
/// within a step, and the trapezoidal rule uses only the values at its ends.
fn substeps(from: [f64; 3], to: [f64; 3]) -> Vec<[f64; 3]> {
    let mut fractions: Vec<f64> = (1..=20).map(|s| f64::from(s) / 20.0).collect();
    if from[0] * to[0] < 0.0 {
        fractions.push(from[0] / (from[0] - to[0]));
        fractions.sort_by(f64::total_cmp);
    }
    let closed = from[0] / (from[0] - to[0]);
    fractions
        .into_iter()
        .map(|f| {
            let mut gap = [0, 1, 2].map(|k| from[k] + f * (to[k] - from[k]));
            if f == closed {
                gap[0] = 0.0;
            }
            gap
        })
        .collect()
}

#[test]
fn every_walk_dissipates_and_balances() {
    let mut random = Random(12);
    let mut bonded = laws();
    // A bond in one mode only: no ultimate separation in the other.
    bonded.push(CohesiveFrictional {
        f_t: 0.0,
        u_k: 0.0,
        ..table_1()
    });
    bonded.push(CohesiveFrictional {
        c: 0.0,
        delta_k: 0.0,
        ..table_1()
    });
    bonded.push(CohesiveFrictional {
        zeta: 1e-9,
        xi: 1e-9,
        ..table_3()
    });
    for law in bonded {
        let size_of_walk = CohesiveFrictional { u_k: 0.2, ..law };
        for _ in 0..100 {
            let mut old = law.virgin();
            let mut last = [0.0; 3];
            let (mut work, mut dissipated, mut elastic, mut size) = (0.0, 0.0, 0.0, 0.0);
            for target in walk(&mut random, &size_of_walk, 40) {
                for gap in substeps(last, target) {
                    let answer = law.update(gap, &old);
                    let new = answer.history;
                    let mut rate = 0.0;
                    for k in 0..2 {
                        rate += new.traction[1 + k] * (new.plastic_slip[k] - old.plastic_slip[k]);
                    }
                    // Slip does work against friction, and the secant stiffness never increases (theory/joint.md, eq.
                    // 21). Tolerance: rounding of slips of 1e-2 mm times tractions of 1e2 MPa.
                    assert!(rate >= -1e-15, "{rate:e}");
                    assert!(new.damage >= old.damage && new.damage <= 1.0);
                    for (k, from) in [old.opening, old.slip[0], old.slip[1]].iter().enumerate() {
                        let part = 0.5 * (old.traction[k] + new.traction[k]) * (gap[k] - from);
                        work += part;
                        size += part.abs();
                    }
                    dissipated += answer.dissipation;
                    elastic = answer.elastic_energy;
                    old = new;
                }
                last = target;
            }
            // ½(t_n + t_{n+1})·Δg = Δψ + dissipation is an identity in every step that stays on one side of u = 0.
            // Tolerance: slips of 1e-1 mm with rounding of 1e-17, times k_s of 1e5, times tractions.
            let error = (work - elastic - dissipated).abs();
            assert!(
                error <= 1e-10 * size + 1e-13,
                "{error:.2e} of {size:.2e} {law:?}"
            );
            assert!(dissipated > -1e-12);
        }
    }
}

#[test]
fn a_bond_of_one_mode_lasts_until_the_other_moves() {
    // No tensile strength: cohesion remains while the joint is closed; any opening destroys it.
    let shear = CohesiveFrictional {
        f_t: 0.0,
        u_k: 0.0,
        ..table_1()
    };
    let answer = shear.update([0.0, 1e-5, 0.0], &shear.virgin());
    assert_eq!(answer.history.damage, 0.0);
    // Tolerance: k_s δ with one rounding.
    assert!((answer.traction[1] - 1e-5 * shear.shear_stiffness).abs() < 1e-15);
    let opened = shear.update([1e-6, 0.0, 0.0], &answer.history);
    assert_eq!((opened.history.damage, opened.traction[0]), (1.0, 0.0));
    // No cohesion: tensile strength remains until the joint slips.
    let tension = CohesiveFrictional {
        c: 0.0,
        delta_k: 0.0,
        ..table_1()
    };
    let answer = tension.update([1e-6, 0.0, 0.0], &tension.virgin());
    assert_eq!(answer.history.damage, 0.0);
    assert!((answer.traction[0] - 1e-6 * tension.normal_stiffness).abs() < 1e-15);
    let slipped = tension.update([1e-6, 1e-3, 0.0], &answer.history);
    assert_eq!((slipped.history.damage, slipped.traction), (1.0, [0.0; 3]));
}

#[test]
fn a_turned_slip_path_gives_turned_tractions() {
    let mut random = Random(13);
    for law in laws() {
        let angle = 2.0 * random.signed();
        let turn = |v: [f64; 2]| {
            let (s, c) = f64::sin_cos(angle);
            [c * v[0] - s * v[1], s * v[0] + c * v[1]]
        };
        let (mut a, mut b) = (law.virgin(), law.virgin());
        for gap in walk(&mut random, &law, 60) {
            let [d1, d2] = turn([gap[1], gap[2]]);
            a = law.update(gap, &a).history;
            b = law.update([gap[0], d1, d2], &b).history;
            let t = turn([a.traction[1], a.traction[2]]);
            // Tolerance: rounding times k_s.
            assert!((t[0] - b.traction[1]).abs() < 1e-9 && (t[1] - b.traction[2]).abs() < 1e-9);
            assert!((a.traction[0] - b.traction[0]).abs() < 1e-9);
        }
    }
}

#[test]
fn the_shifted_law_converges_to_the_law() {
    let mut random = Random(14);
    for law in laws() {
        for _ in 0..20 {
            let mut old = law.virgin();
            for gap in walk(&mut random, &law, 20) {
                let direct = law.update(gap, &old);
                let mut traction = old.traction;
                let stiffness = [law.normal_stiffness / 4.0, law.shear_stiffness / 4.0];
                let mut shifted = direct;
                for _ in 0..400 {
                    shifted = law.update_shifted(
                        gap,
                        &old,
                        &Shift {
                            stiffness,
                            traction,
                            bounding: traction[0],
                        },
                    );
                    traction = shifted.traction;
                }
                for k in 0..3 {
                    // Tolerance: the contraction (3/4)^400, and rounding.
                    let error = (shifted.traction[k] - direct.traction[k]).abs();
                    assert!(error < 1e-9, "{k}: {shifted:?} {direct:?} {law:?}");
                }
                assert!((shifted.history.damage - direct.history.damage).abs() < 1e-10);
                assert!((shifted.tangent - shifted.tangent.transpose()).amax() == 0.0);
                old = direct.history;
            }
        }
    }
}

#[test]
fn the_shifted_law_converges_from_afar_at_the_solver_s_stiffness() {
    // 2 E/h against 500 E/h: each iteration reduces the error by 1 − 1/250.
    let mut random = Random(15);
    for law in laws() {
        let mut old = law.virgin();
        for gap in walk(&mut random, &law, 12) {
            let direct = law.update(gap, &old);
            let stiffness = [law.normal_stiffness / 250.0, law.shear_stiffness / 250.0];
            let mut traction = [0, 1, 2].map(|_| 3.0 * random.signed());
            let mut last = direct;
            for _ in 0..12_000 {
                last = law.update_shifted(
                    gap,
                    &old,
                    &Shift {
                        stiffness,
                        traction,
                        bounding: traction[0],
                    },
                );
                traction = last.traction;
                let eigenvalues = last.tangent.symmetric_eigenvalues();
                // Tolerance: rounding of a projector times k_s/250.
                assert!(eigenvalues.min() >= -1e-12 * law.shear_stiffness);
                if (0..3).all(|k| traction[k] == direct.traction[k]) {
                    break;
                }
            }
            for k in 0..3 {
                // Tolerance: rounding of an iterate, amplified by 250, for tractions up to 1e2 MPa.
                let error = (last.traction[k] - direct.traction[k]).abs();
                assert!(
                    error < 1e-10 * (1.0 + direct.traction[k].abs()),
                    "{error:.1e}"
                );
            }
            old = direct.history;
        }
    }
}

#[test]
fn a_dry_joint_has_friction_and_nothing_else() {
    let law = CohesiveFrictional::dry(0.6, 1000.0, 400.0);
    let mut h: InterfaceHistory = law.virgin();
    assert_eq!(h.damage, 1.0);
    assert_eq!(law.update([0.01, 0.3, 0.0], &h).traction, [0.0; 3]);
    h = law.update([-0.01, 1.0, 0.0], &h).history;
    assert!((h.traction[1] - 6.0).abs() < 1e-12);
    // After sliding while open, a joint that closes sticks at the new place.
    h = law.update([0.5, 3.0, 0.0], &h).history;
    h = law.update([-0.01, 3.0, 0.0], &h).history;
    assert!(h.traction[1].abs() < 1e-12);
}
