//! Formulas on curves made by hand.

use super::*;
use crate::deck::quantity::Quantity;
use crate::deck::schema::DeckTest;
use crate::results::{ReadHistory, StepOfCurve, VerdictKind};
use crate::state::HistoryRow;
use std::collections::BTreeMap;

/// A run with points of displacement [mm] and force [kN], a probe column, and sizes of 100 × 50 × 400 mm.
fn run(kind: TestKind, points: &[(f64, f64)], columns: &[(&str, Vec<f64>)]) -> TestRun {
    let row = |(i, point): (usize, &(f64, f64))| HistoryRow {
        displacement_mm: point.0,
        force_kN: point.1,
        probes: columns.iter().map(|(_, values)| values[i]).collect(),
        ..HistoryRow::default()
    };
    let mm = |value| Some(Quantity::new(value));
    TestRun {
        name: "run".to_owned(),
        test: DeckTest {
            kind,
            length: mm(100.0),
            thickness: mm(50.0),
            height: mm(400.0),
            spans: Some([Quantity::new(300.0), Quantity::new(100.0)]),
            lever: mm(200.0),
            pressure: Some(Quantity::new(0.5)),
            angle: Some(Quantity::new(45.0)),
        },
        history: ReadHistory {
            rows: points.iter().enumerate().map(row).collect(),
            probes: columns.iter().map(|(name, _)| (*name).to_owned()).collect(),
            steps: Some(vec![StepOfCurve {
                driven: true,
                ..StepOfCurve::default()
            }]),
        },
        gauges: BTreeMap::from([
            ("front_mm".to_owned(), 100.0),
            ("back_mm".to_owned(), 100.0),
            ("vertical_mm".to_owned(), 200.0),
            ("horizontal_mm".to_owned(), 200.0),
            ("left_mm".to_owned(), 100.0),
            ("middle_mm".to_owned(), 100.0),
            ("right_mm".to_owned(), 100.0),
        ]),
        collapsed_at: None,
        verdict: Some(VerdictKind::PeakPassed),
        contradictions: Vec::new(),
    }
}

fn of(found: &Evaluation, name: &str) -> f64 {
    let mut all = found.runs[0].values.iter().chain(&found.together);
    all.find(|value| value.name == name)
        .unwrap_or_else(|| panic!("{name}"))
        .value
}

fn near(value: f64, wanted: f64) {
    assert!(
        (value / wanted - 1.0).abs() < 1e-12,
        "{value}, not {wanted}"
    ); // some roundings
}

#[test]
fn compression_reads_strength_and_modulus() {
    let gauges = [
        ("front_mm", vec![-0.01, -0.02, -0.06, -0.08]),
        ("back_mm", vec![-0.03, -0.06, -0.18, -0.24]),
    ];
    let found = evaluate(&[run(
        TestKind::Compression,
        &[(0.1, 10.0), (0.2, 20.0), (0.5, 45.0), (1.0, 30.0)],
        &gauges,
    )])
    .unwrap();
    // 45 kN on 5,000 mm².
    near(of(&found, "f"), 9.0);
    near(of(&found, "f_k"), 7.5);
    // At 15 kN, half-way between the first two rows, the gauges have shortened by 0.03 of 100 mm on the mean.
    near(of(&found, "E"), 3.0 / 3e-4);
}

#[test]
fn flexure_sums_the_forces_of_both_inner_lines() {
    let lines = [
        ("first_kN", vec![0.5, 1.0, 0.2]),
        ("second_kN", vec![0.5, 1.0, 0.2]),
    ];
    let found = evaluate(&[run(
        TestKind::Flexure,
        &[(0.1, 0.5), (0.2, 1.0), (0.3, 0.2)],
        &lines,
    )])
    .unwrap();
    // M = 1 kN × 100 mm, W = 100 × 50² / 6 mm³.
    near(of(&found, "f_x"), 1e5 * 6.0 / (100.0 * 2500.0));
}

#[test]
fn triplets_lie_on_a_line() {
    let at = |pressure: f64, force: f64| {
        let mut run = run(
            TestKind::Triplet,
            &[(0.1, force), (1.0, 2.0 * pressure), (2.0, 2.0 * pressure)],
            &[],
        );
        run.test.pressure = Some(Quantity::new(pressure));
        run
    };
    // f_v = 0.3 + 0.6 f_p on 2 × 5,000 mm²; residual 0.2 f_p.
    let found = evaluate(&[at(0.5, 6.0), at(1.0, 9.0), at(2.0, 15.0)]).unwrap();
    near(of(&found, "f_v0"), 0.3);
    near(of(&found, "tan_alpha"), 0.6);
    near(of(&found, "f_vk0"), 0.24);
    near(of(&found, "tan_phi_r"), 0.2);
    let alone = evaluate(&[at(0.5, 6.0)]).unwrap();
    assert!(
        alone.together.is_empty() && alone.notes[0].contains("at least two"),
        "{:?}",
        alone.notes
    );
}

#[test]
fn the_wrench_takes_the_compression_of_its_load_off() {
    let found = evaluate(&[run(TestKind::BondWrench, &[(0.1, 0.3), (0.2, 0.1)], &[])]).unwrap();
    // Bending by 300 N at 200 - 25 mm from the middle, less 300 N over the bed of 5,000 mm².
    near(
        of(&found, "f_w"),
        300.0 * 175.0 * 6.0 / (100.0 * 2500.0) - 300.0 / 5000.0,
    );
}

#[test]
fn energies_are_areas_below_the_curve() {
    let triangle = [(0.0, 0.0), (0.1, 1.0), (0.3, 0.0)];
    let found = evaluate(&[run(TestKind::CoupletTension, &triangle, &[])]).unwrap();
    near(of(&found, "f_t"), 0.2);
    near(of(&found, "G_I"), 0.15 * 1e3 / 5000.0);
    let plateau = [(0.0, 0.0), (0.1, 2.0), (0.3, 1.0), (10.0, 1.0)];
    let uplift = [("uplift_mm", vec![0.0, 0.0, 0.05, 0.5])];
    let found = evaluate(&[run(TestKind::DirectShear, &plateau, &uplift)]).unwrap();
    near(of(&found, "f_vr"), 0.2);
    near(of(&found, "uplift_over_slip"), 0.05);
    // Above the residual 1 kN: half of 1 kN over the first 0.1 mm as if from that force on, then over 0.2 mm.
    near(of(&found, "G_II"), 0.15 * 1e3 / 5000.0);
}

#[test]
fn diagonal_compression_has_strengths_by_each_definition() {
    let gauges = [
        ("vertical_mm", vec![-0.02, -0.09]),
        ("horizontal_mm", vec![0.02, 0.2]),
    ];
    let found = evaluate(&[run(
        TestKind::Diagonal,
        &[(0.1, 10.0), (0.5, 30.0)],
        &gauges,
    )])
    .unwrap();
    // A_n = 50 × (100 + 400) / 2 mm².
    let per_area = 30e3 / 12_500.0;
    near(of(&found, "f_t_rilem"), 0.5 * per_area);
    near(of(&found, "S_s"), per_area / 2.0_f64.sqrt());
    // A third of the force is the first row: 0.02 + 0.02 mm on 200 mm.
    near(of(&found, "G"), per_area / 2.0_f64.sqrt() / 3.0 / 2e-4);
}

#[test]
fn a_wall_that_fell_tells_the_tangent_of_its_last_angle() {
    let mut run = run(TestKind::TiltingTable, &[(0.0, 0.0)], &[]);
    run.collapsed_at = Some(0.5);
    let found = evaluate(&[run]).unwrap();
    near(of(&found, "load_factor"), 22.5_f64.to_radians().tan());
    assert_eq!(found.notes, Vec::<String>::new());
}

#[test]
fn a_wall_that_has_not_fallen_has_no_angle_of_collapse() {
    let mut run = run(TestKind::TiltingTable, &[(0.0, 0.0)], &[]);
    run.history.rows[0].load_factor = 1.0;
    run.verdict = Some(VerdictKind::Stands);
    let found = evaluate(&[run]).unwrap();
    near(of(&found, "angle"), 45.0);
    assert!(
        found.runs[0].values[0].about.contains("has not fallen"),
        "{:?}",
        found.runs[0].values
    );
    assert!(
        found.notes[0].contains("no angle of collapse"),
        "{:?}",
        found.notes
    );
}

#[test]
fn a_force_that_still_rises_is_remarked_on_and_mixed_runs_are_refused() {
    let mut rising = run(TestKind::CoupletTension, &[(0.1, 1.0)], &[]);
    rising.verdict = Some(VerdictKind::StillRising);
    let found = evaluate(std::slice::from_ref(&rising)).unwrap();
    assert!(found.notes[0].contains("still rises"), "{:?}", found.notes);
    let other = run(TestKind::BondWrench, &[(0.1, 1.0)], &[]);
    assert!(matches!(
        evaluate(&[rising, other]),
        Err(EvaluationError::Mixed { .. })
    ));
    assert!(matches!(evaluate(&[]), Err(EvaluationError::NoRuns)));
    let still = run(TestKind::BondWrench, &[], &[]);
    assert!(matches!(
        evaluate(&[still]),
        Err(EvaluationError::NoCurve(_))
    ));
}

#[test]
fn units_that_cracked_and_joints_that_did_not_break_are_remarked_on() {
    let points = [(0.1, 4.0), (1.0, 2.0), (1.9, 1.5), (2.0, 1.0)];
    let mut short = run(TestKind::Triplet, &points, &[]);
    let found = evaluate(std::slice::from_ref(&short)).unwrap();
    assert!(found.notes[0].contains("still falls"), "{:?}", found.notes);
    short.history.rows[0].max_tensile_damage = 0.9;
    let found = evaluate(std::slice::from_ref(&short)).unwrap();
    assert!(found.notes[0].contains("0.90"), "{:?}", found.notes);
    // Mortar that tears after the peak, beside a joint that does not: the strength is that of the mortar.
    let points = [(0.1, 3.0), (0.2, 0.5), (1.0, 0.1)];
    let mut torn = run(TestKind::CoupletTension, &points, &[]);
    torn.history.rows[2].max_tensile_damage = 0.95;
    let found = evaluate(std::slice::from_ref(&torn)).unwrap();
    assert!(
        found.notes.len() == 1 && found.notes[0].contains("units or mortar broke"),
        "{:?}",
        found.notes
    );
    torn.history.rows[2].max_interface_damage = 1.0;
    let found = evaluate(&[torn]).unwrap();
    assert!(!found.notes[0].contains("broke"), "{:?}", found.notes);
    // A third of the largest force is left: an area below the curve is missing.
    let couplet = run(TestKind::CoupletTension, &[(0.1, 3.0), (1.0, 1.0)], &[]);
    let found = evaluate(&[couplet]).unwrap();
    assert!(found.notes[0].contains("lacks"), "{:?}", found.notes);
}

#[test]
fn a_flat_jack_gives_the_pressure_that_brings_the_gauges_back() {
    let points = [(0.0, 1.0), (0.0, 2.0), (0.0, 2.0), (0.0, 2.0)];
    let gauges =
        |values: [f64; 4]| ["left_mm", "middle_mm", "right_mm"].map(|name| (name, values.to_vec()));
    let whole = run(
        TestKind::FlatJack,
        &points,
        &gauges([-0.01, -0.02, -0.02, -0.02]),
    );
    let mut columns = gauges([-0.05, -0.10, -0.04, 0.02]).to_vec();
    columns.push(("jack_MPa", vec![0.0, 0.0, 0.5, 1.0]));
    let slot = run(TestKind::FlatJack, &points, &columns);
    let found = evaluate(&[whole.clone(), slot.clone()]).unwrap();
    assert_eq!(found.notes, Vec::<String>::new());
    // From -0.04 at 0.5 to 0.02 at 1 MPa: -0.02 at a third of the way.
    near(of(&found, "f_m"), 2.0 / 3.0);
    near(of(&found, "f_m_over_f_p"), 4.0 / 3.0);
    near(of(&found, "gauges"), -0.02);
    let alone = evaluate(&[slot]).unwrap();
    assert!(alone.together.is_empty() && alone.notes[0].contains("needs two runs"));
    let mut columns = gauges([0.0, 0.0, -0.05, -0.10]).to_vec();
    columns.push(("jack_MPa", vec![0.0, 0.0, 0.5, 1.0]));
    let double = evaluate(&[run(TestKind::FlatJackDouble, &points, &columns)]).unwrap();
    // 1/3 MPa shortens 100 mm by 0.1/3 mm.
    near(of(&double, "E"), 1000.0);
    near(of(&double, "E_middle"), 1000.0);
}

/// A pressure or an angle of `[test]` that no step has is told; equal ones, and steps without any, are not.
#[test]
fn values_of_the_test_that_no_step_has_are_told() {
    let said = |test: &str, step: &str| {
        let text = format!(
            "format = 1\nmaterials.stone = {{ E = \"5 GPa\", nu = 0.2, density = \"2000 kg/m^3\" }}\n\
             [[blocks]]\nname = \"block\"\nsize = [400, 300, 200]\nmaterial = \"stone\"\n\
             [[supports]]\non = \"block.bottom\"\n[test]\nkind = \"direct-shear\"\nlength = 400\nthickness = 300\n{test}\n[[probes]]\nname = \"uplift\"\non = \"block\"\ndirection = \"z\"\n[[steps]]\n{step}\n"
        );
        super::run::contradictions(&crate::deck::Deck::from_str(&text, "test.toml").unwrap())
    };
    let pressed = "kind = \"preload\"\nface = \"block.top\"\npressure = \"0.6 MPa\"";
    let told = said("pressure = \"0.3 MPa\"", pressed);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].starts_with("test.pressure is 0.3, and the steps have 0.6"),
        "{told:?}"
    );
    assert!(said("pressure = \"600 kPa\"", pressed).is_empty());
    assert!(said("pressure = \"0.3 MPa\"", "kind = \"gravity\"").is_empty());
}
