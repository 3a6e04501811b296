//! The damage-plasticity law against golden curves, closed forms and its own derivatives.

use crate::common::{Random, brick, csv, mortar, strains};
use nalgebra::{Rotation3, Vector6};
use wythe::material::{
    DamagePlasticity, DamagePlasticityParameters, Interpolation, MaterialHistory, TableRow,
    TableWarning,
};
use wythe::tensor;

const STRESS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

fn law(parameters: &DamagePlasticityParameters) -> DamagePlasticity {
    DamagePlasticity::new(parameters, None)
        .expect("the tables are sound")
        .0
}

fn drive(
    law: &DamagePlasticity,
    path: &[Vector6<f64>],
    substeps: usize,
) -> (Vec<Vector6<f64>>, MaterialHistory) {
    let mut history = MaterialHistory::default();
    let mut last = Vector6::zeros();
    let mut stresses = Vec::new();
    for strain in path {
        for k in 1..=substeps {
            let at = last + (strain - last) * (k as f64 / substeps as f64);
            history = law
                .update(&at, &history, 1.0, false)
                .expect("an answer")
                .history;
        }
        last = *strain;
        stresses.push(history.stress);
    }
    (stresses, history)
}

fn golden(name: &str, parameters: &DamagePlasticityParameters) {
    let table = csv(&format!("golden/cdp_{name}.csv"));
    let path = strains(&table);
    let law = law(parameters);
    let columns = |prefix: &str| -> Vec<Vector6<f64>> {
        (0..path.len())
            .map(|i| {
                Vector6::from_iterator(
                    STRESS
                        .iter()
                        .map(|c| table[&format!("{prefix}_{c}_MPa")][i]),
                )
            })
            .collect()
    };
    let worst = |a: &[Vector6<f64>], b: &[Vector6<f64>]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).amax())
            .fold(0.0, f64::max)
    };
    let (one, _) = drive(&law, &path, 1);
    let error = worst(&one, &columns("sigBE"));
    // Tolerance: the curves are given to 1e-9 MPa; strains to 15 digits times E = 16700 MPa.
    assert!(error < 1e-8, "{name}: {error:.2e} MPa from backward Euler");
    let exact = columns("sig");
    let errors = [4, 8, 16].map(|n| worst(&drive(&law, &path, n).0, &exact));
    // Backward Euler is of first order, or better on a nearly straight path. If one step is already exact, only the
    // reference's own error of 1.3e-8 MPa remains.
    if errors[0] > 1e-6 {
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            assert!(ratio > 1.8, "{name}: errors {errors:?}");
        }
    }
    println!("{name}: BE {error:.1e}, substeps 4, 8, 16: {errors:?} MPa");
}

#[test]
fn golden_curves() {
    for test in [
        "biax_comp_1_1",
        "cyclic_tct",
        "nonprop",
        "simple_shear",
        "uniax_compression",
        "uniax_tension",
    ] {
        golden(&format!("brick_eff1_{test}"), &brick());
    }
    golden("mortar850_eff1_uniax_tension", &mortar(850.0));
}

#[test]
fn tables_of_the_golden_curves() {
    for (name, parameters) in [("brick", brick()), ("mortar850", mortar(850.0))] {
        let table = csv(&format!("golden/tables_{name}_eff1.csv"));
        let law = law(&parameters);
        let nodes: Vec<_> = law
            .tension()
            .nodes()
            .iter()
            .chain(law.compression().nodes())
            .collect();
        assert_eq!(nodes.len(), table["kappa"].len());
        for (i, node) in nodes.iter().enumerate() {
            // Tolerance: fifteen printed digits.
            assert!((node.kappa - table["kappa"][i]).abs() < 1e-15);
            assert!((node.effective - table["sigma_bar_MPa"][i]).abs() < 1e-12);
        }
    }
}

#[test]
fn inadmissible_damage_of_the_mortar_is_capped_and_reported() {
    let (_, warnings) = DamagePlasticity::new(&mortar(850.0), None).expect("capped, not refused");
    let [TableWarning::DamageCapped { row, to, .. }] = warnings.as_slice() else {
        panic!("one warning: {warnings:?}")
    };
    // theory/damage-plasticity.md, Decisions, "Inadmissible damage", gives five digits.
    assert_eq!(*row, 2);
    assert!((to - 0.93865).abs() < 5e-6, "{to}");
    assert!(
        DamagePlasticity::new(&mortar(2300.0), None)
            .expect("sound")
            .1
            .is_empty()
    );
}

#[test]
fn first_yield_of_the_paper_is_exact() {
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/exact/cdp_yield_surface_exact_daltri.csv"
    ))
    .expect("the data is there");
    let mut checked = 0;
    for line in text.lines().filter(|l| !l.starts_with('#')) {
        let mut fields = line.split(',');
        let (material, path, value) = (
            fields.next().unwrap_or_default(),
            fields.next().unwrap_or_default(),
            fields.next().and_then(|v| v.parse::<f64>().ok()),
        );
        let Some(value) = value else { continue };
        let law = law(&if material == "brick" {
            brick()
        } else {
            mortar(850.0)
        });
        let ratio = |s: &str| s.trim().parse::<f64>().expect("a ratio");
        let direction = if let Some(r) = path.strip_prefix("CC 1:") {
            Vector6::new(-1.0, -ratio(r), 0.0, 0.0, 0.0, 0.0)
        } else if let Some(t) = path.strip_prefix("TC t=") {
            let t = ratio(t.split('|').next().unwrap_or_default());
            Vector6::new(-1.0, t, 0.0, 0.0, 0.0, 0.0)
        } else if path == "uniaxial tension" {
            Vector6::new(1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        } else if path.starts_with("hydrostatic") {
            tensor::UNIT
        } else {
            continue;
        };
        // F is homogeneous up to a constant: f(s) = s f₁ + f₀ along a ray.
        let f0 = law.yield_function(&Vector6::zeros(), 0.0, 0.0);
        let f1 = law.yield_function(&direction, 0.0, 0.0) - f0;
        let scale = direction.amax();
        let found = -f0 / f1 * scale;
        // The file has six digits.
        assert!(
            (found - value).abs() <= 1e-6 * value + 5e-5,
            "{line}: {found}"
        );
        checked += 1;
    }
    assert_eq!(checked, 22);
}

#[test]
fn lateral_pressure_raises_the_strength_as_the_closed_form() {
    let law = law(&brick());
    // theory/damage-plasticity.md, eq. 5: s = σ̄_c + p (1 + 2α + γ)/(1 − α).
    for p in [1.0, 5.0, 20.0] {
        let s = 11.0 + p * (1.0 + 2.0 * 0.16 / 1.32 + 3.0) / (1.0 - 0.16 / 1.32);
        let stress = Vector6::new(-s, -p, -p, 0.0, 0.0, 0.0);
        // Tolerance: rounding of numbers of order 100.
        assert!(law.yield_function(&stress, 0.0, 0.0).abs() < 1e-12);
    }
}

#[test]
fn lee_and_fenves_uniaxial_laws_through_tables() {
    for tension in [true, false] {
        let branch = if tension { "tension" } else { "compression" };
        let table = csv(&format!("exact/leefenves_closed_form_{branch}.csv"));
        let e = 31700.0;
        let rows: Vec<TableRow> = (0..table["strain"].len())
            .map(|i| TableRow {
                stress: table["stress_MPa"][i],
                inelastic_strain: if i == 0 {
                    0.0
                } else {
                    table["strain"][i] - table["stress_MPa"][i] / e
                },
                damage: if i == 0 { 0.0 } else { table["D"][i] },
            })
            .collect();
        // Every other row; the values between are interpolated.
        let coarse: Vec<TableRow> = rows.iter().copied().step_by(2).collect();
        let mut parameters = brick();
        parameters.elastic.E = e;
        parameters.elastic.nu = 0.0;
        let other = if tension { [18.3, 18.3] } else { [3.48, 3.48] };
        let flat = vec![
            TableRow {
                stress: other[0],
                inelastic_strain: 0.0,
                damage: 0.0,
            },
            TableRow {
                stress: other[1],
                inelastic_strain: 0.01,
                damage: 0.0,
            },
        ];
        if tension {
            parameters.tension = coarse;
            parameters.compression = flat;
        } else {
            parameters.compression = coarse;
            parameters.tension = flat;
        }
        let law = law(&parameters);
        let peak = rows.iter().map(|r| r.stress).fold(0.0, f64::max);
        let sign = if tension { 1.0 } else { -1.0 };
        let mut history = MaterialHistory::default();
        let (mut worst, mut at) = (0.0, 0.0);
        for (i, row) in rows.iter().enumerate() {
            let axial = sign * table["strain"][i];
            let (answer, _) = uniaxial(&law, axial, &history);
            history = answer;
            let error = (sign * history.stress[0] - row.stress).abs() / peak;
            if error > worst {
                (worst, at) = (error, table["strain"][i]);
            }
        }
        println!("Lee–Fenves {branch}: {worst:.1e} of the peak at strain {at:.5}");
        // The chords between rows of the table are up to 0.33 % of the peak below the closed form.
        assert!(worst < 5e-3, "{branch}: {worst}");
    }
}

/// Axial strain with zero lateral stresses, by bisection on the lateral strain.
fn uniaxial(law: &DamagePlasticity, axial: f64, old: &MaterialHistory) -> (MaterialHistory, f64) {
    let at = |lateral: f64| {
        let strain = Vector6::new(axial, lateral, lateral, 0.0, 0.0, 0.0);
        law.update(&strain, old, 1.0, false)
            .expect("an answer")
            .history
    };
    // The effective lateral stress increases with the lateral strain.
    let (mut low, mut high) = (-0.1, 0.1);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if at(middle).stress[1] > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    (at(low), low)
}

fn random_walk(random: &mut Random, scale: f64) -> Vec<Vector6<f64>> {
    let mut strain = Vector6::zeros();
    let mut drift = Vector6::from_fn(|_, _| random.signed());
    (0..40)
        .map(|step| {
            if step % 8 == 7 {
                drift = Vector6::from_fn(|_, _| random.signed());
            }
            strain += (drift + 0.5 * Vector6::from_fn(|_, _| random.signed())) * scale;
            strain
        })
        .collect()
}

fn variants() -> Vec<DamagePlasticityParameters> {
    let mut all = Vec::new();
    for base in [brick(), mortar(850.0), mortar(2300.0)] {
        for interpolation in [Interpolation::Eff1, Interpolation::Lit] {
            for viscosity in [0.0, 0.7] {
                let mut p = base.clone();
                p.interpolation = interpolation;
                p.viscosity = viscosity;
                all.push(p);
            }
        }
    }
    let mut recovering = brick();
    recovering.tension_recovery = 0.3;
    recovering.compression_recovery = 0.6;
    all.push(recovering);
    all
}

#[test]
fn tangents_match_central_differences() {
    let mut random = Random(1);
    let (mut checked, mut kinks) = (0, 0);
    for parameters in variants() {
        let law = law(&parameters);
        let e = parameters.elastic.E;
        for walk in 0..6 {
            let scale = parameters.tension[0].stress / e * if walk % 2 == 0 { 0.3 } else { 2.0 };
            let mut history = MaterialHistory::default();
            for strain in random_walk(&mut random, scale) {
                let answer = law.update(&strain, &history, 1.0, true).expect("an answer");
                let h = 1e-5 * parameters.tension[0].stress / e;
                for j in 0..6 {
                    let mut d = Vector6::zeros();
                    d[j] = h;
                    let side = |s: f64| {
                        law.update(&(strain + d * s), &history, 1.0, false)
                            .expect("an answer")
                            .stress
                    };
                    let (up, down) = (side(1.0), side(-1.0));
                    let column = answer.tangent.column(j);
                    let central = (up - down) / (2.0 * h);
                    let error = (central - column).amax();
                    // At a kink (a principal stress changes sign, first yield, a table row within h) the tangent is
                    // that of one side (theory/return-map.md, Decisions, "Kinks").
                    let forward = ((up - answer.stress) / h - column).amax();
                    let backward = ((answer.stress - down) / h - column).amax();
                    // Error of second order in h: 2.6e-7 E with ten times this h and 2.6e-9 E with it
                    // (theory/return-map.md, Verification, requires 5e-5 E). One-sided differences have larger
                    // errors.
                    if error > 1e-7 * e {
                        kinks += 1;
                        assert!(
                            forward.min(backward) < 2e-3 * e,
                            "central {error:.2e}, forward {forward:.2e}, backward {backward:.2e}"
                        );
                    }
                    checked += 1;
                }
                history = answer.history;
            }
        }
    }
    println!("{checked} columns, {kinks} at kinks");
    // Kinks are rare; frequent ones would indicate a wrong tangent.
    assert!(kinks * 200 < checked, "{kinks} of {checked}");
}

#[test]
fn a_rotated_path_gives_rotated_stresses() {
    let mut random = Random(2);
    for parameters in variants() {
        let law = law(&parameters);
        let axis = nalgebra::Vector3::new(random.signed(), random.signed(), random.signed());
        let r = *Rotation3::new(axis).matrix();
        let turn = |s: &Vector6<f64>, shear: f64| {
            let mut t = *s;
            for k in 3..6 {
                t[k] *= shear;
            }
            let m = r * tensor::matrix(&t) * r.transpose();
            let back = 1.0 / shear;
            Vector6::new(
                m[(0, 0)],
                m[(1, 1)],
                m[(2, 2)],
                back * m[(0, 1)],
                back * m[(1, 2)],
                back * m[(0, 2)],
            )
        };
        let scale = parameters.tension[0].stress / parameters.elastic.E;
        let path = random_walk(&mut random, scale);
        let turned: Vec<_> = path.iter().map(|s| turn(s, 0.5)).collect();
        let (a, _) = drive(&law, &path, 1);
        let (b, _) = drive(&law, &turned, 1);
        for (a, b) in a.iter().zip(&b) {
            // Tolerance: rounding, amplified by the tolerance of the return map.
            assert!((turn(a, 1.0) - b).amax() < 1e-9, "{a} {b}");
        }
    }
}

#[test]
fn dissipation_and_balance_on_random_walks() {
    let mut random = Random(3);
    for parameters in variants() {
        let law = law(&parameters);
        let scale = parameters.tension[0].stress / parameters.elastic.E;
        for _ in 0..5 {
            let mut old = MaterialHistory::default();
            let mut last = Vector6::zeros();
            let (mut work, mut dissipated, mut elastic) = (0.0, 0.0, 0.0);
            for strain in random_walk(&mut random, scale) {
                let answer = law.update(&strain, &old, 1.0, false).expect("an answer");
                let new = answer.history;
                work += 0.5 * (old.stress + new.stress).dot(&(strain - last));
                dissipated += answer.energy.plastic_damage + answer.energy.viscous;
                elastic = answer.energy.elastic;
                // theory/damage-plasticity.md, eq. 16: plastic work is not negative (effective stress times inviscid
                // flow), d_t and d_c do not decrease; the recovery term may have either sign.
                let flow = new.plastic_strain - old.plastic_strain;
                let c0 = wythe::material::elastic_stiffness(&parameters.elastic);
                let effective = c0 * (strain - new.plastic_strain);
                assert!(effective.dot(&flow) >= -1e-15);
                assert!(new.tensile_damage >= old.tensile_damage);
                assert!(new.compressive_damage >= old.compressive_damage);
                assert!(new.damage >= 0.0 && new.damage < 1.0);
                old = new;
                last = strain;
            }
            // Tolerance of the identity of the trapezoidal rule: rounding of sums of some 0.1 N/mm².
            let error = (work - elastic - dissipated).abs();
            assert!(
                error < 1e-12 * (1.0 + work.abs()),
                "{error:.2e} of {work:.2e}"
            );
        }
    }
}

#[test]
fn uniaxial_cycles_dissipate() {
    let law = law(&brick());
    let mut history = MaterialHistory::default();
    let mut total = 0.0;
    for k in 0..400 {
        let s = f64::from(k) / 400.0;
        let axial = 1.5e-3 * s * (s * 40.0).sin();
        let old = history;
        let (new, lateral) = uniaxial(&law, axial, &old);
        let strain = Vector6::new(axial, lateral, lateral, 0.0, 0.0, 0.0);
        let energy = law
            .update(&strain, &old, 1.0, false)
            .expect("an answer")
            .energy;
        total += energy.plastic_damage;
        history = new;
    }
    assert!(total > 0.0);
    assert!(history.tensile_damage > 0.3);
}

#[test]
fn cold_random_steps_always_find_their_root() {
    let mut random = Random(4);
    for parameters in variants() {
        let law = law(&parameters);
        for _ in 0..2000 {
            let size = 10.0_f64.powf(-5.0 + 4.0 * random.uniform());
            let strain = Vector6::from_fn(|_, _| random.signed() * size);
            let old = MaterialHistory::default();
            let new = law
                .update(&strain, &old, 1.0, false)
                .expect("a root")
                .history;
            let c0 = wythe::material::elastic_stiffness(&parameters.elastic);
            let effective = c0 * (strain - new.plastic_strain);
            let f = law.yield_function(&effective, new.kappa_t, new.kappa_c);
            // Tolerance: rounding of a trial stress of up to 1e3 MPa in the return.
            assert!(f < 1e-9 * (1.0 + size * parameters.elastic.E), "{f:.2e}");
        }
    }
}

#[test]
fn viscosity_vanishes_with_its_coefficient_and_delays_otherwise() {
    let path: Vec<_> = (1..=40)
        .map(|k| Vector6::new(2e-5 * f64::from(k), 0.0, 0.0, 0.0, 0.0, 0.0))
        .collect();
    let with = |viscosity: f64| {
        let mut p = brick();
        p.viscosity = viscosity;
        drive(&law(&p), &path, 1)
            .0
            .iter()
            .map(|s| s[0])
            .fold(0.0, f64::max)
    };
    let peak = with(0.0);
    // Error of first order in μ.
    assert!((with(1e-9) - peak).abs() < 1e-6);
    assert!(with(5.0) > 1.1 * peak);
}

#[test]
fn the_bounded_tangent_is_symmetric_and_between_its_bounds() {
    let mut random = Random(11);
    let mut softening = 0;
    for parameters in variants() {
        let law = law(&parameters);
        let c0 = law.secant_stiffness(1.0);
        for _ in 0..200 {
            let strain = Vector6::from_fn(|_, _| 5e-4 * random.signed());
            let old = MaterialHistory::default();
            let answer = law.update(&strain, &old, 1.0, true).expect("an answer");
            let intact = 1.0 - answer.history.viscous_damage;
            let bounded = law.bounded(&answer.tangent, intact);
            let skew = (bounded - bounded.transpose()).amax();
            assert!(skew < 1e-12 * c0.amax(), "{skew:.1e}");
            for _ in 0..20 {
                let e = Vector6::from_fn(|_, _| random.signed());
                let ratio = e.dot(&(bounded * e)) / (intact * e.dot(&(c0 * e)));
                assert!((0.3 - 1e-9..1.0 + 1e-9).contains(&ratio), "{ratio}");
                softening += usize::from(e.dot(&(answer.tangent * e)) < 0.0);
            }
        }
        // Points that do not yield are unchanged.
        let elastic = law.bounded(&law.secant_stiffness(0.7), 0.7);
        assert!((elastic - c0 * 0.7).amax() < 1e-12 * c0.amax());
    }
    assert!(softening > 0);
}
