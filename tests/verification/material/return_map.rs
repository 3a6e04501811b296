//! The return map in difficult cases: its nine equations, the vertex, corners, unusual tables.

use crate::common::{Random, brick, mortar};
use nalgebra::{Matrix6, Vector6};
use wythe::material::{
    DamagePlasticity, DamagePlasticityParameters, Interpolation, LocalFailure, MaterialHistory,
    Response, TableRow, elastic_stiffness,
};
use wythe::tensor;

fn law(parameters: &DamagePlasticityParameters) -> DamagePlasticity {
    DamagePlasticity::new(parameters, None)
        .expect("the tables are sound")
        .0
}

fn step(law: &DamagePlasticity, strain: Vector6<f64>, old: &MaterialHistory) -> Response {
    law.update(&strain, old, 1.0, true).expect("an answer")
}

/// Residuals of theory/return-map.md, eq. 8, in the nine unknowns (σ̄, κ_t, κ_c), written without the reduction: the
/// flow rule with N(σ̄), the hardening (theory/damage-plasticity.md, eqs 6 and 8), and F ≤ 0. λ follows from tr Δε_p
/// = λT. Returns the largest residual in MPa (κ times E). Those of the flow rule are divided by its condition number:
/// near the vertex of the potential N rotates by dσ̄/A, which is multiplied by λ C₀.
fn nine_residuals(
    p: &DamagePlasticityParameters,
    law: &DamagePlasticity,
    strain: &Vector6<f64>,
    old: &MaterialHistory,
    new: &MaterialHistory,
) -> f64 {
    let c0 = elastic_stiffness(&p.elastic);
    let effective = c0 * (strain - new.plastic_strain);
    let dilation = p.dilation_angle.tan();
    let a = p.eccentricity * p.tension[0].stress * dilation;
    let flow = new.plastic_strain - old.plastic_strain;
    let lambda = (flow[0] + flow[1] + flow[2]) / dilation;
    let deviator = effective - tensor::UNIT * tensor::mean(&effective);
    let q = (1.5 * tensor::norm_squared(&deviator)).sqrt();
    // N as a tensor, then with engineering shear.
    let n = deviator * (1.5 / a.hypot(q)) + tensor::UNIT * (dilation / 3.0);
    let mut voigt = n;
    for k in 3..6 {
        voigt[k] *= 2.0;
    }
    let stress_residual = (c0 * (flow - voigt * lambda)).amax();
    // Principal values by nalgebra, independent of the tested routine.
    let eigen = |s: &Vector6<f64>| {
        let mut v: Vec<f64> = tensor::matrix(s)
            .symmetric_eigenvalues()
            .iter()
            .copied()
            .collect();
        v.sort_by(|a, b| b.total_cmp(a));
        v
    };
    let principal = eigen(&effective);
    let sum: f64 = principal.iter().map(|s| s.abs()).sum();
    let r = if sum > 0.0 {
        principal.iter().map(|s| s.max(0.0)).sum::<f64>() / sum
    } else {
        0.0
    };
    let rates = eigen(&n);
    let kappa_t = old.kappa_t + lambda * r * rates[0].max(0.0);
    let kappa_c = old.kappa_c + lambda * (1.0 - r) * (-rates[2]).max(0.0);
    let f = law.yield_function(&effective, new.kappa_t, new.kappa_c);
    let yield_residual = if lambda > 0.0 { f.abs() } else { f.max(0.0) };
    let condition = 1.0 + 3.0 * p.elastic.shear_modulus() * lambda / a.hypot(q);
    [
        stress_residual / condition,
        p.elastic.E * (kappa_t - new.kappa_t).abs() / condition,
        p.elastic.E * (kappa_c - new.kappa_c).abs() / condition,
        yield_residual,
    ]
    .into_iter()
    .fold(0.0, f64::max)
}

fn paper() -> Vec<DamagePlasticityParameters> {
    let mut all = Vec::new();
    for base in [brick(), mortar(850.0), mortar(2300.0)] {
        for interpolation in [Interpolation::Eff1, Interpolation::Lit] {
            all.push(DamagePlasticityParameters {
                interpolation,
                ..base.clone()
            });
        }
    }
    all
}

#[test]
fn all_nine_equations_hold_on_random_walks() {
    let mut random = Random(11);
    let mut worst: f64 = 0.0;
    for p in paper() {
        let law = law(&p);
        for walk in 0..40 {
            let scale = p.tension[0].stress / p.elastic.E * [0.2, 1.0, 5.0][walk % 3];
            let mut strain = Vector6::zeros();
            let mut old = MaterialHistory::default();
            for _ in 0..40 {
                strain += Vector6::from_fn(|_, _| random.signed()) * scale;
                let new = law
                    .update(&strain, &old, 1.0, false)
                    .expect("an answer")
                    .history;
                worst = worst.max(nine_residuals(&p, &law, &strain, &old, &new));
                old = new;
            }
        }
    }
    println!("largest residual of 9600 steps: {worst:.1e} MPa");
    // Tolerance: strains of 1e-2, recovered here as differences, have rounding of 1e-18 times E = 1e4 MPa times 1/T =
    // 6; f is evaluated at σ̄ = 10 MPa. (f itself is solved to 1e-12 σ̄_c = 1e-11 MPa or better.)
    assert!(worst < 1e-12, "{worst:.1e}");
}

/// Random positive rows that soften, harden or stay constant, with any admissible damage.
fn odd_table(random: &mut Random, e: f64, strength: f64) -> Vec<TableRow> {
    let mut rows = vec![TableRow {
        stress: strength,
        inelastic_strain: 0.0,
        damage: 0.0,
    }];
    for _ in 0..=(random.uniform() * 5.0) as usize {
        let last = rows[rows.len() - 1];
        let stress = strength * (0.02 + 1.3 * random.uniform());
        // Wide enough to avoid snap-back.
        let least = 1.05 * (last.stress - stress).max(0.0) / e;
        let width = least + 10.0_f64.powf(-5.0 + 3.0 * random.uniform());
        let damage = last.damage + (0.99 - last.damage) * random.uniform().powi(2);
        rows.push(TableRow {
            stress,
            inelastic_strain: last.inelastic_strain + width,
            damage,
        });
    }
    rows
}

#[test]
fn the_map_never_fails_on_tables_that_pass_the_check() {
    let mut random = Random(12);
    let (mut laws, mut plastic, mut worst) = (0, 0, 0.0_f64);
    while laws < 300 {
        let mut p = brick();
        p.elastic.E = 10.0_f64.powf(2.0 + 3.0 * random.uniform());
        p.elastic.nu = 0.49 * random.uniform();
        p.dilation_angle = (1.0 + 50.0 * random.uniform()).to_radians();
        p.eccentricity = [0.0, 0.01, 0.1, 1.0][(random.uniform() * 4.0) as usize];
        p.fb0_fc0 = 1.0 + 0.4 * random.uniform();
        p.k_c = 0.55 + 0.45 * random.uniform();
        p.tension_recovery = random.uniform();
        p.compression_recovery = random.uniform();
        let f_t = p.elastic.E * 10.0_f64.powf(-4.0 + random.uniform());
        p.tension = odd_table(&mut random, p.elastic.E, f_t);
        let f_c = f_t * (2.0 + 10.0 * random.uniform());
        p.compression = odd_table(&mut random, p.elastic.E, f_c);
        // Skip tables that the check rejects.
        let Ok((law, _)) = DamagePlasticity::new(&p, None) else {
            continue;
        };
        laws += 1;
        let mut old = MaterialHistory::default();
        for k in 0..60 {
            let size = f_t / p.elastic.E * 10.0_f64.powf(-0.5 + 2.5 * random.uniform());
            // Half of the steps start from the initial state, half continue a walk.
            if k % 2 == 0 {
                old = MaterialHistory::default();
            }
            let strain = old.plastic_strain + Vector6::from_fn(|_, _| random.signed() * size);
            let new = law
                .update(&strain, &old, 1.0, true)
                .unwrap_or_else(|why| panic!("{why} with {p:?} at {strain} from {old:?}"))
                .history;
            assert!(new.kappa_t >= old.kappa_t && new.kappa_c >= old.kappa_c);
            assert!(new.damage >= 0.0 && new.damage < 1.0, "{}", new.damage);
            let effective = elastic_stiffness(&p.elastic) * (strain - new.plastic_strain);
            let trial = elastic_stiffness(&p.elastic) * (strain - old.plastic_strain);
            let f = law.yield_function(&effective, new.kappa_t, new.kappa_c);
            worst = worst.max(f / trial.amax().max(f_t));
            plastic += i32::from(new.plastic_strain != old.plastic_strain);
            old = new;
        }
    }
    println!("{laws} laws, {plastic} plastic steps, largest F {worst:.1e} of the trial stress");
    assert!(plastic > 5000, "{plastic}");
    // Tolerance: rounding of the trial stress in the plastic strain, amplified by β of up to 100 where the tables
    // give very different effective strengths.
    assert!(worst < 1e-11, "{worst:.1e}");
}

/// Central differences of the stress.
fn differences(
    law: &DamagePlasticity,
    strain: &Vector6<f64>,
    old: &MaterialHistory,
    h: f64,
) -> Matrix6<f64> {
    let mut d = Matrix6::zeros();
    for j in 0..6 {
        let mut e = Vector6::zeros();
        e[j] = h;
        let (up, down) = (
            step(law, strain + e, old).stress,
            step(law, strain - e, old).stress,
        );
        d.set_column(j, &((up - down) / (2.0 * h)));
    }
    d
}

#[test]
fn hydrostatic_tension_returns_along_its_axis_with_the_right_shear_stiffness() {
    for p in [brick(), mortar(2300.0)] {
        let law = law(&p);
        let yield_stress = {
            // theory/damage-plasticity.md, eq. 5: p = (1−α) σ̄_c/(3α + β).
            let (sc, st, alpha) = (p.compression[0].stress, p.tension[0].stress, 0.16 / 1.32);
            let beta = (1.0 - alpha) * sc / st - (1.0 + alpha);
            (1.0 - alpha) * sc / (3.0 * alpha + beta)
        };
        let bulk = p.elastic.bulk_modulus();
        let strain = tensor::UNIT * (2.0 * yield_stress / (3.0 * bulk));
        let old = MaterialHistory::default();
        let answer = step(&law, strain, &old);
        let s = answer.stress;
        assert!(s[0] > 0.0 && s[0] < 2.0 * yield_stress && s[0] == s[1] && s[1] == s[2]);
        assert_eq!(s.rows(3, 3).amax(), 0.0);
        assert!(answer.history.kappa_t > 0.0 && answer.history.kappa_c == 0.0);
        // A shear strain splits the three equal principal stresses symmetrically: there the law is smooth.
        let numeric = differences(&law, &strain, &old, 1e-8);
        for k in 3..6 {
            let (a, b) = (answer.tangent[(k, k)], numeric[(k, k)]);
            // Tolerance: second order in shears of 1e-4 MPa over the hyperbola's a = 0.06 MPa: 3e-6, times a part of
            // the stiffness.
            assert!((a - b).abs() < 1e-6 * p.elastic.E, "{a} {b}");
            // Plastic flow must have softened the point for the test to be meaningful.
            assert!(a < 0.5 * p.elastic.shear_modulus());
        }
    }
}

#[test]
fn without_eccentricity_the_vertex_of_the_cone_is_reached() {
    let p = DamagePlasticityParameters {
        eccentricity: 0.0,
        ..brick()
    };
    let law = law(&p);
    let old = MaterialHistory::default();
    // Mostly volumetric strain with a little shear: beyond the vertex.
    let strain = Vector6::new(6e-4, 5e-4, 5.5e-4, 1e-5, -1e-5, 2e-5);
    let answer = step(&law, strain, &old);
    let effective = elastic_stiffness(&p.elastic) * (strain - answer.history.plastic_strain);
    let deviator = effective - tensor::UNIT * tensor::mean(&effective);
    // Tolerance: rounding of stresses of 10 MPa.
    assert!(deviator.amax() < 1e-13, "{deviator}");
    assert!(
        law.yield_function(&effective, answer.history.kappa_t, 0.0)
            .abs()
            < 1e-11
    );
    // The deviatoric stress is zero, so that no shear stiffness remains.
    let numeric = differences(&law, &strain, &old, 1e-8);
    // The law is smooth within the vertex region of the cone; rounding over h leaves 1e-7 E.
    assert!((answer.tangent - numeric).amax() < 1e-6 * p.elastic.E);
    // A strain with more shear than volume stays on the cone.
    let strain = Vector6::new(6e-4, -4e-4, 1e-4, 1e-5, -1e-5, 2e-5);
    let answer = step(&law, strain, &old);
    let numeric = differences(&law, &strain, &old, 1e-8);
    assert!((answer.tangent - numeric).amax() < 1e-6 * p.elastic.E);
}

#[test]
fn tangents_near_the_corner_where_the_largest_stress_changes_sign() {
    let p = brick();
    let law = law(&p);
    let c0 = elastic_stiffness(&p.elastic);
    let compliance = c0.try_inverse().expect("regular");
    let old = MaterialHistory::default();
    // Biaxial compression with a third stress that ends below or above zero: the γ and β branches of
    // theory/damage-plasticity.md, eqs 2 to 4, which differ in slope.
    let at = |third: f64| {
        let strain = compliance * Vector6::new(-18.0, -11.0, third, 0.3, 0.0, 0.0);
        let answer = step(&law, strain, &old);
        assert!(answer.history.kappa_c > 0.0);
        let effective = c0 * (strain - answer.history.plastic_strain);
        (
            strain,
            answer.tangent,
            tensor::principal_values(&effective)[0],
        )
    };
    let (mut below, mut above) = (0.0, 12.0);
    while above - below > 1e-12 {
        let middle = 0.5 * (below + above);
        if at(middle).2 < 0.0 {
            below = middle;
        } else {
            above = middle;
        }
    }
    for third in [
        0.0,
        below - 1e-3,
        below - 1e-4,
        above + 1e-4,
        above + 1e-3,
        12.0,
    ] {
        let (strain, tangent, largest) = at(third);
        assert_eq!(largest >= 0.0, third >= above);
        // A strain of 1e-9 is 2e-5 MPa: these differences do not cross the corner; rounding over h leaves 1e-7 E.
        let error = (tangent - differences(&law, &strain, &old, 1e-9)).amax();
        assert!(error < 1e-6 * p.elastic.E, "{third}: {error}");
    }
    let jump = (at(below).1 - at(above).1).amax();
    println!("jump of the tangent at the corner: {jump:.0} MPa");
    // At a distance of 1e-12 MPa a smooth law would have the same tangent.
    assert!(jump > 0.01 * p.elastic.E, "{jump}");
}

#[test]
fn nan_and_infinite_strains_are_rejected() {
    let law = law(&brick());
    let old = MaterialHistory::default();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut strain = Vector6::zeros();
        strain[4] = bad;
        let refused = law.update(&strain, &old, 1.0, true).err();
        assert_eq!(refused, Some(LocalFailure::StrainNotFinite));
    }
    // The strain is finite, but its stress is not.
    let huge = Vector6::repeat(1e306);
    let refused = law.update(&huge, &old, 1.0, true).err();
    assert!(
        matches!(refused, Some(LocalFailure::ReturnMap { .. })),
        "{refused:?}"
    );
}
