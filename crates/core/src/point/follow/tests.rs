use super::*;
use crate::deck::{Deck, templates};
use wythe_contact::CohesiveFrictional;

const ONCE: NonZeroUsize = NonZeroUsize::MIN;

/// A joint whose friction decreases from 0.8 to 0.7 with its bond.
fn joint() -> CohesiveFrictional {
    CohesiveFrictional {
        f_t: 0.3,
        c: 0.4,
        tan_phi: 0.8,
        u_k: 0.2,
        delta_k: 0.5,
        zeta: 4.0,
        xi: 3.0,
        ..CohesiveFrictional::dry(0.7, 3e4, 1.3e4)
    }
}

/// A brick that cracks and crushes.
fn brick() -> Material {
    let text = templates::find("shear-wall").unwrap().text;
    let deck = Deck::from_str(text, "shear-wall.toml").unwrap();
    deck.law("brick", None).unwrap().0
}

fn rows<const N: usize>(targets: impl IntoIterator<Item = [Target; N]>) -> Vec<Row<N>> {
    let numbered = targets.into_iter().enumerate();
    numbered
        .map(|(i, targets)| Row {
            time: 0.1 * (i + 1) as f64,
            targets,
        })
        .collect()
}

/// Compression, then shear in both directions, then opening.
fn shear_path() -> Vec<Row<3>> {
    rows((0..60).map(|i| {
        let t = f64::from(i);
        [-1e-5 + 4e-8 * t * t, 0.1 * (0.1 * t).sin(), 1e-3 * t].map(Target::Strain)
    }))
}

#[test]
fn prescribed_strains_reproduce_the_law_row_by_row() {
    let (law, rows) = (joint(), shear_path());
    let walk = interface_path(&law, &rows, ONCE);
    assert_eq!((walk.records.len(), walk.failure), (rows.len(), None));
    let mut old = law.virgin();
    for (row, record) in rows.iter().zip(&walk.records) {
        let response = law.update(record.state.strain.into(), &old);
        let strains = row.targets.iter().zip(&record.state.strain);
        assert!(strains.into_iter().all(|(t, e)| *t == Target::Strain(*e)));
        assert_eq!(record.state.stress, Vector3::from(response.traction));
        assert_eq!(record.tangent, response.tangent);
        assert_eq!(record.state.history, response.history);
        assert_eq!(record.state.time, row.time);
        old = response.history;
    }
    let damage = interface_state(&walk.records[59].state.history)[0];
    assert!(damage > 0.1, "{damage}");
}

#[test]
fn a_path_can_be_resumed() {
    let (law, rows) = (joint(), shear_path());
    let whole = interface_path(&law, &rows, ONCE);
    let (first, second) = rows.split_at(23);
    let mut records = Vec::new();
    let mut state = State::at_rest(law.virgin());
    for part in [first, second] {
        let take = |_, record: &_| records.push(*record);
        state = follow_interface(&law, state, part, ONCE, take).unwrap();
    }
    assert_eq!(records, whole.records);
    assert_eq!(state, whole.records[59].state);
}

#[test]
fn tangents_are_the_derivatives_of_the_stresses() {
    let law = brick();
    // Beyond the peaks in tension (xx) and with shear, so that the point yields.
    let along = |e: f64| [e, -0.2 * e, -0.1 * e, 0.4 * e, 0.1 * e, 0.0].map(Target::Strain);
    let rows = rows((1..=8).map(|i| along(1e-4 * f64::from(i))));
    let walk = material_path(&law, &rows, ONCE);
    let before = walk.records[6].state;
    let last = walk.records[7];
    assert!(material_state(&last.state.history)[0] > 1e-4);
    // Central differences: stresses of some MPa have rounding errors of 1e-15 of that. Divided by 2e-9 this gives
    // 1e-6 MPa, and slopes are 1e3 MPa. The response is smooth there, and 1e-9 squared is negligible beside the
    // strains.
    let h = 1e-9;
    for j in 0..6 {
        let stress = |sign: f64| {
            let mut row = rows[7];
            if let Target::Strain(e) = &mut row.targets[j] {
                *e += sign * h;
            }
            let end = follow_material(&law, before, &[row], ONCE, |_, _| ());
            end.unwrap().stress
        };
        let slope = (stress(1.0) - stress(-1.0)) / (2.0 * h);
        let error = (slope - last.tangent.column(j)).amax();
        assert!(error < 1e-4, "column {j}: {error:.1e} MPa");
    }
}

/// Uniaxial stress: σ = E ε with E of the template.
#[test]
fn prescribed_stresses_are_reached() {
    let law = brick();
    let (free, pulled) = (Target::Stress(0.0), Target::Strain);
    let rows = rows((1..=4).map(|i| [pulled(5e-5 * f64::from(i)), free, free, free, free, free]));
    let walk = material_path(&law, &rows, ONCE);
    for record in &walk.records {
        let state = record.state;
        // The tolerance of the driver is 1e-10 MPa, the stress some MPa.
        assert!((state.stress[0] / state.strain[0] - 16700.0).abs() < 1e-5);
        assert!(state.stress.rows(1, 5).amax() <= 1e-10);
        assert_eq!(material_state(&state.history), [0.0; 5]);
    }
}

#[test]
fn a_failed_row_is_reported_and_the_rows_before_are_kept() {
    let law = joint();
    let pull = |s: f64| [Target::Stress(s), Target::Strain(0.0), Target::Strain(0.0)];
    let walk = interface_path(&law, &rows([0.1, 0.2, 0.4, 0.1].map(pull)), ONCE);
    assert_eq!(walk.records.len(), 2);
    let failure = walk.failure.unwrap();
    let PointFailure::Beyond(limit) = failure.why else {
        panic!("{failure:?}")
    };
    assert_eq!(failure.row, 2);
    // Half of the way from 0.2 to 0.4 MPa. The error is the search tolerance over the stiffness near f_t.
    assert!((limit.fraction - 0.5).abs() < 1e-6, "{limit:?}");

    let mut unsound = shear_path();
    unsound[7].targets[1] = Target::Stress(f64::NAN);
    let walk = interface_path(&law, &unsound, ONCE);
    let failure = RowFailure {
        row: 7,
        why: PointFailure::NotFinite { component: 1 },
    };
    assert_eq!((walk.records.len(), walk.failure), (7, Some(failure)));
    let said = failure.why.explain(&unsound[7], &super::super::INTERFACE);
    assert_eq!(said, "the prescribed value of tau1 is not finite");

    let mut unsound = shear_path();
    unsound[3].time = 0.2;
    let walk = interface_path(&law, &unsound, ONCE);
    assert_eq!(walk.records.len(), 3);
    let why = walk.failure.unwrap().why;
    assert!(matches!(why, PointFailure::Time { to: 0.2, .. }), "{why:?}");
}
