//! Curves from tables: rejected rows, exactly reproduced values, scaling with element size.

use crate::common::{brick, csv, mortar};
use nalgebra::Vector6;
use wythe::material::{
    Branch, Curve, DamagePlasticity, DamagePlasticityParameters, Interpolation, MaterialHistory,
    TableError, TableRow, elastic_stiffness,
};

fn paper() -> [DamagePlasticityParameters; 3] {
    [brick(), mortar(850.0), mortar(2300.0)]
}

fn branches(p: &DamagePlasticityParameters) -> [(Branch, &[TableRow]); 2] {
    [
        (Branch::Tension, &p.tension),
        (Branch::Compression, &p.compression),
    ]
}

fn row(stress: f64, inelastic_strain: f64, damage: f64) -> TableRow {
    TableRow {
        stress,
        inelastic_strain,
        damage,
    }
}

/// Value at x on the polyline through points (x, y).
fn polyline(points: &[(f64, f64)], x: f64) -> f64 {
    let i = points[1..points.len() - 1]
        .iter()
        .take_while(|p| p.0 < x)
        .count();
    let (a, b) = (points[i], points[i + 1]);
    a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0)
}

#[test]
fn the_uniaxial_response_is_the_tables_own_polyline() {
    for p in paper() {
        for interpolation in [Interpolation::Eff1, Interpolation::Lit] {
            for (branch, rows) in branches(&p) {
                let e = p.elastic.E;
                let (curve, _) =
                    Curve::new(branch, rows, e, None, interpolation).expect("a sound table");
                let response: Vec<_> = rows
                    .iter()
                    .map(|r| (r.inelastic_strain + r.stress / e, r.stress))
                    .collect();
                let last = curve.nodes()[curve.nodes().len() - 1].kappa;
                for k in 0..=1000 {
                    let kappa = last * f64::from(k) / 1000.0;
                    let at = curve.at(kappa);
                    // Uniaxially ε = ε_p + σ̄/E with ε_p = κ (theory/damage-plasticity.md, eqs 8 and 9).
                    let strain = kappa + at.effective / e;
                    let stress = (1.0 - at.damage) * at.effective;
                    let exact = polyline(&response, strain);
                    // Tolerance: rounding of stresses of 10 MPa, and of strains times slopes of 16700 MPa.
                    assert!((stress - exact).abs() < 1e-12, "{stress} {exact}");
                }
                // Constant beyond the last row.
                let (end, beyond) = (curve.at(last), curve.at(2.0 * last));
                assert_eq!(
                    (end.effective, end.damage),
                    (beyond.effective, beyond.damage)
                );
                assert_eq!((beyond.effective_slope, beyond.damage_slope), (0.0, 0.0));
            }
        }
    }
}

#[test]
fn damage_is_linear_in_the_inelastic_strain_on_request() {
    let p = brick();
    let (e, rows) = (p.elastic.E, &p.tension);
    let (curve, warnings) =
        Curve::new(Branch::Tension, rows, e, None, Interpolation::Lit).expect("a sound table");
    assert!(warnings.is_empty());
    let mut seen = 0;
    for node in curve.nodes() {
        let inelastic = node.kappa + (node.effective - node.stress) / e;
        let damage = 1.0 - node.stress / node.effective;
        // Tolerance: rounding of numbers of order one.
        assert!(
            (damage - 0.95 * inelastic / 0.002).abs() < 1e-12,
            "{damage} at {inelastic}"
        );
        seen += 1;
    }
    assert_eq!(seen, 21);
}

#[test]
fn slopes_are_the_derivatives_of_the_values() {
    for p in paper() {
        for (branch, rows) in branches(&p) {
            let (curve, _) = Curve::new(branch, rows, p.elastic.E, None, Interpolation::Eff1)
                .expect("a sound table");
            for pair in curve.nodes().windows(2) {
                let width = pair[1].kappa - pair[0].kappa;
                for s in [0.1, 0.5, 0.9] {
                    let kappa = pair[0].kappa + s * width;
                    let h = 1e-4 * width;
                    let (up, at, down) =
                        (curve.at(kappa + h), curve.at(kappa), curve.at(kappa - h));
                    let damage = (up.damage - down.damage) / (2.0 * h);
                    let effective = (up.effective - down.effective) / (2.0 * h);
                    // Tolerance: curvature of d over h, 1e-8 of its change; rounding of σ̄ over h.
                    assert!((damage - at.damage_slope).abs() < 1e-7 / width);
                    assert!((effective - at.effective_slope).abs() < 1e-9 / width);
                }
            }
        }
    }
}

#[test]
fn unusable_tables_are_rejected_with_branch_and_row() {
    let first = row(3.0, 0.0, 0.0);
    let cases = [
        (vec![first], None),
        (vec![row(3.0, 1e-5, 0.0), row(1.0, 1e-3, 0.5)], Some(1)),
        (vec![row(3.0, 0.0, 0.1), row(1.0, 1e-3, 0.5)], Some(1)),
        (vec![row(0.0, 0.0, 0.0), row(1.0, 1e-3, 0.5)], Some(1)),
        (vec![first, row(-1.0, 1e-3, 0.5)], Some(2)),
        (vec![first, row(f64::NAN, 1e-3, 0.5)], Some(2)),
        (vec![first, row(1.0, f64::INFINITY, 0.5)], Some(2)),
        (vec![first, row(1.0, 1e-3, 1.0)], Some(2)),
        // A drop of 2 MPa within less than 2 MPa/E, at the end and before the peak.
        (vec![first, row(1.0, 1.9e-4, 0.1)], Some(2)),
        (
            vec![first, row(1.0, 1.9e-4, 0.1), row(4.0, 1e-2, 0.1)],
            Some(2),
        ),
        (vec![first, row(1.0, 1e-3, f64::NAN)], Some(2)),
        (vec![first, row(1.0, 1e-3, -0.1)], Some(2)),
        (
            vec![first, row(2.0, 1e-3, 0.5), row(1.0, 1e-3, 0.6)],
            Some(3),
        ),
        (
            vec![first, row(2.0, 1e-3, 0.5), row(1.0, 2e-3, 0.4)],
            Some(3),
        ),
    ];
    for (rows, bad) in cases {
        let found = Curve::new(Branch::Compression, &rows, 1e4, None, Interpolation::Eff1);
        let branch = Branch::Compression;
        match (found, bad) {
            (Err(TableError::TooShort { branch: b }), None) => assert_eq!(b, branch),
            (Err(TableError::Row { branch: b, row, .. }), Some(bad)) => {
                assert_eq!((b, row), (branch, bad), "{rows:?}");
            }
            (other, _) => panic!("{rows:?}: {other:?}"),
        }
    }
}

#[test]
fn the_largest_lengths_of_the_paper_and_the_rejection_beyond() {
    // theory/crack-band.md, eq. 6 and its table, in units of l_ref: tension, compression.
    let printed = [[10.4, 9.2], [1.21, 1.42], [3.29, 3.83]];
    for (p, printed) in paper().into_iter().zip(printed) {
        for ((branch, rows), printed) in branches(&p).into_iter().zip(printed) {
            let scaled = |l| {
                let scaling = Some((1.0, l));
                Curve::new(branch, rows, p.elastic.E, scaling, Interpolation::Eff1)
            };
            let Err(TableError::SnapBack { l_max, .. }) = scaled(1e3) else {
                panic!("far beyond every limit")
            };
            // Tolerance: half of the last printed digit.
            let digit = if printed > 5.0 { 0.05 } else { 0.005 };
            assert!(
                (l_max - printed).abs() <= digit,
                "{branch}: {l_max} {printed}"
            );
            match scaled(1.001 * l_max) {
                Err(TableError::SnapBack {
                    branch: b,
                    row,
                    l_eq,
                    l_max: named,
                }) => {
                    assert_eq!((b, row), (branch, rows.len()));
                    // Tolerance: rounding.
                    assert!((named / l_max - 1.0).abs() < 1e-12 && l_eq > named);
                }
                other => panic!("{other:?}"),
            }
            // Just below the limit the damage is capped or accepted, but there is no snap-back.
            assert!(
                !matches!(scaled(0.999 * l_max), Err(TableError::SnapBack { .. })),
                "{branch}"
            );
        }
    }
}

#[test]
fn the_steepest_softening_segment_is_reported() {
    // Drops of 1 MPa over 2e-3, 2.5e-4 and 1e-3 with E = 1e4 MPa: limits of 20, 2.5 and 10 l_ref.
    let rows = [
        row(4.0, 0.0, 0.0),
        row(3.0, 2e-3, 0.1),
        row(2.0, 2.25e-3, 0.1),
        row(1.0, 3.25e-3, 0.1),
    ];
    let scaling = Some((30.0, 700.0));
    match Curve::new(Branch::Tension, &rows, 1e4, scaling, Interpolation::Eff1) {
        Err(TableError::SnapBack { row, l_max, .. }) => {
            assert_eq!(row, 3);
            // Tolerance: rounding of differences of the strains.
            assert!((l_max - 75.0).abs() < 1e-9, "{l_max}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_energy_per_area_does_not_depend_on_the_elements_size() {
    for p in [brick(), mortar(2300.0)] {
        for (branch, rows) in branches(&p) {
            let l_ref = 50.0;
            let energy = |l_eq: f64| {
                let scaling = Some((l_ref, l_eq));
                let (curve, _) =
                    Curve::new(branch, rows, p.elastic.E, scaling, Interpolation::Eff1)
                        .expect("below the limit");
                // Area below σ(ε_in) beyond the peak, and the whole area before it.
                let nodes = curve.nodes();
                let inelastic: Vec<f64> = nodes
                    .iter()
                    .map(|n| n.kappa + (n.effective - n.stress) / p.elastic.E)
                    .collect();
                let peak = (0..nodes.len())
                    .max_by(|&a, &b| nodes[a].stress.total_cmp(&nodes[b].stress))
                    .expect("nodes");
                let (mut before, mut after) = (0.0, 0.0);
                for i in 1..nodes.len() {
                    let area = 0.5
                        * (nodes[i].stress + nodes[i - 1].stress)
                        * (inelastic[i] - inelastic[i - 1]);
                    if i <= peak {
                        before += area;
                    } else {
                        after += area;
                    }
                }
                (before, l_eq * after)
            };
            let reference = energy(l_ref);
            for l_eq in [5.0, 19.7, 50.0, 120.0] {
                let (before, after) = energy(l_eq);
                // Tolerance: rounding of sums of a few products.
                assert!(
                    (before - reference.0).abs() < 1e-14,
                    "hardening is not scaled"
                );
                assert!((after / reference.1 - 1.0).abs() < 1e-12, "{branch} {l_eq}");
            }
        }
    }
}

/// A law with zero Poisson's ratio, so that a uniaxial elastic strain is a uniaxial stress.
fn plain(change: impl FnOnce(&mut DamagePlasticityParameters)) -> DamagePlasticity {
    let mut p = brick();
    p.elastic.nu = 0.0;
    change(&mut p);
    DamagePlasticity::new(&p, None).expect("sound tables").0
}

/// Strain for the uniaxial effective stress `s`, added to the history's plastic strain.
fn uniaxial(s: f64, history: &MaterialHistory) -> Vector6<f64> {
    let mut strain = history.plastic_strain;
    strain[0] += s / 16700.0;
    strain
}

#[test]
fn recovery_factors_restore_the_given_stiffness() {
    // First cracked, then compressed: the tensile damage counts by (1 − w_c). First crushed, then pulled: the
    // compressive damage counts by (1 − w_t) (theory/damage-plasticity.md, eq. 12).
    for w in [0.0, 0.3, 1.0] {
        let law = plain(|p| (p.tension_recovery, p.compression_recovery) = (w, w));
        let virgin = MaterialHistory::default();
        for (sign, axial, lateral) in [(1.0, 1e-3, 0.0), (-1.0, -8e-3, 5e-4)] {
            let strain = Vector6::new(axial, lateral, lateral, 0.0, 0.0, 0.0);
            let old = law
                .update(&strain, &virgin, 1.0, false)
                .expect("an answer")
                .history;
            let damage = [old.tensile_damage, old.compressive_damage];
            let own = if sign > 0.0 { damage[0] } else { damage[1] };
            assert!(own > 0.1);
            for s in [0.5, -0.5] {
                let new = law
                    .update(&uniaxial(s, &old), &old, 1.0, false)
                    .expect("elastic")
                    .history;
                let (w_t, w_c) = if s > 0.0 { (w, 0.0) } else { (0.0, w) };
                let intact = (1.0 - (1.0 - w_t) * damage[1]) * (1.0 - (1.0 - w_c) * damage[0]);
                // Tolerance: rounding.
                assert!((new.stress[0] - intact * s).abs() < 1e-12, "{w} {s}");
            }
        }
    }
}

#[test]
fn viscosity_relaxes_exponentially_to_the_inviscid_state() {
    // At constant strain backward Euler (theory/damage-plasticity.md, eq. 13) reduces the distance to the inviscid
    // state by μ/(μ+Δt) per step. With infinite viscosity the point remains elastic.
    let strain = Vector6::new(1e-3, -1e-4, 2e-4, 3e-4, 0.0, -1e-4);
    let virgin = MaterialHistory::default();
    let inviscid = plain(|_| ())
        .update(&strain, &virgin, 1.0, false)
        .expect("an answer");
    let (mu, dt) = (2.0, 0.5);
    let law = plain(|p| p.viscosity = mu);
    let mut old = virgin;
    let mut gap = 1.0;
    for _ in 0..20 {
        let new = law
            .update(&strain, &old, dt, false)
            .expect("an answer")
            .history;
        gap *= mu / (mu + dt);
        let expected = inviscid.history.plastic_strain * (1.0 - gap);
        // Tolerance: rounding of strains of 1e-3.
        assert!((new.viscous_strain - expected).amax() < 1e-17);
        assert!((new.viscous_damage - inviscid.history.damage * (1.0 - gap)).abs() < 1e-14);
        old = new;
    }
    let stiff = plain(|p| p.viscosity = 1e30)
        .update(&strain, &virgin, 1.0, false)
        .expect("an answer");
    let mut elastic = brick().elastic;
    elastic.nu = 0.0;
    let exact = elastic_stiffness(&elastic) * strain;
    // θ = 1e-30, so that only rounding remains.
    assert!((stiff.stress - exact).amax() < 1e-12);
}

/// Uniaxial stress along x to the strain `end` in `steps` steps: dissipated energy, final stress, remaining strain
/// energy, all per volume.
fn pull(p: &DamagePlasticityParameters, end: f64, steps: u32) -> (f64, f64, f64) {
    let (law, _) = DamagePlasticity::new(p, None).expect("sound tables");
    let mut old = MaterialHistory::default();
    let (mut dissipated, mut elastic) = (0.0, 0.0);
    for k in 1..=steps {
        let axial = end * f64::from(k) / f64::from(steps);
        let at = |lateral: f64| {
            let strain = Vector6::new(axial, lateral, lateral, 0.0, 0.0, 0.0);
            law.update(&strain, &old, 1.0, false).expect("an answer")
        };
        // The lateral stress increases with the lateral strain.
        let (mut low, mut high) = (-0.05, 0.05);
        while high - low > 1e-17 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if at(middle).stress[1] > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        let answer = at(low);
        dissipated += answer.energy.plastic_damage;
        elastic = answer.energy.elastic;
        old = answer.history;
    }
    (dissipated, old.stress[0], elastic)
}

#[test]
fn the_dissipation_of_a_uniaxial_test_is_the_area_under_its_table() {
    for p in [brick(), mortar(2300.0)] {
        for (sign, rows) in [(1.0, &p.tension), (-1.0, &p.compression)] {
            let e = p.elastic.E;
            let last = rows[rows.len() - 1];
            let strain = |r: &TableRow| r.inelastic_strain + r.stress / e;
            let mut work = 0.5 * rows[0].stress * rows[0].stress / e;
            for pair in rows.windows(2) {
                work +=
                    0.5 * (pair[0].stress + pair[1].stress) * (strain(&pair[1]) - strain(&pair[0]));
            }
            let kept = 0.5 * last.stress * last.stress / (e * (1.0 - last.damage));
            let exact = work - kept;
            let errors = [50, 100, 200].map(|steps| {
                let (dissipated, stress, elastic) = pull(&p, sign * strain(&last), steps);
                // The end of the table is reached for any number of steps; the tolerance is that of the bisection.
                assert!((stress - sign * last.stress).abs() < 1e-4, "{stress}");
                assert!((elastic / kept - 1.0).abs() < 1e-3);
                (dissipated / exact - 1.0).abs()
            });
            println!("dissipation {exact:.5} N/mm², relative errors {errors:?}");
            // Trapezoids across the corners of the table, at which no step ends.
            assert!(errors[2] < 2e-4, "{errors:?}");
        }
    }
}

#[test]
fn biaxial_strength_beside_kupfers_tests() {
    let p = brick();
    let (law, _) = DamagePlasticity::new(&p, None).expect("sound tables");
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/exact/kupfer_strength_ratios.csv"
    ))
    .expect("the data is there");
    let table = csv("exact/kupfer_strength_ratios.csv");
    let ratios = text.lines().filter(|l| l.starts_with("-1:"));
    let mut rows = 0;
    for (i, line) in ratios.enumerate() {
        let second: f64 = line[3..line.find(',').expect("a comma")]
            .parse()
            .expect("a ratio");
        let direction = Vector6::new(-1.0, second, 0.0, 0.0, 0.0, 0.0);
        // (1−α) F is homogeneous up to a constant.
        let constant = law.yield_function(&Vector6::zeros(), 0.0, 0.0);
        let model = -constant
            / (law.yield_function(&direction, 0.0, 0.0) - constant)
            / p.compression[0].stress;
        let (test, named) = (table["over_fc"][i], table["model_over_fc"][i]);
        println!(
            "{line}: test {test}, model {model:.4}, {:+.1} %",
            100.0 * (model / test - 1.0)
        );
        // Tolerance: half of the last digit of the file.
        assert!((model - named).abs() <= 5e-5, "{model} {named}");
        rows += 1;
    }
    assert_eq!(rows, 3);
}
