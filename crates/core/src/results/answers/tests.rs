//! Answers of models with invented fields.

use super::*;
use crate::model::scene::{Beam, HeldBy, Support};
use crate::results::fake;
use crate::state;
use approx::assert_relative_eq;

/// The two cubes with a support below the first and a driven beam above it.
fn model() -> Model {
    let mut model = fake::model();
    model.supports = vec![Support {
        name: "bottom".to_owned(),
        nodes: vec![0, 1, 2, 3],
        fixed: [true; 3],
        by: HeldBy::Ground,
    }];
    model.beams = vec![Beam {
        name: "top".to_owned(),
        nodes: vec![4, 5, 6, 7],
        area: 1e4,
        normal: [0.0, 0.0, 1.0],
        shape: Vec::new(),
        free: Vec::new(),
        depth: 0.0,
    }];
    model
}

#[test]
fn drifts_count_over_the_clear_height() {
    let curve = Curve::of_points(&[(0.0, 0.0), (0.5, 10.0), (1.0, 6.0)]);
    let height = crate::results::comparison::clear_height(&model());
    assert_eq!(height, Some(100.0));
    let answers = Answers::of_curve(&curve, height);
    assert_eq!(answers.drift_at_peak, Some(0.005));
    // 8 kN lie in the middle between 0.5 and 1 mm; a few operations.
    let ultimate = answers.bilinear.unwrap().ultimate_drift.unwrap();
    assert_relative_eq!(ultimate, 0.0075, max_relative = 1e-14);
    assert_eq!(answers.opposite_bilinear, None);
    let nothing = Answers::of_curve(&Curve::default(), None);
    assert_eq!(nothing, Answers::default());
    assert!(nothing.lines().is_empty());
}

/// A support that holds only sideways, as a guide of the top does, does not lower the height.
#[test]
fn guides_are_no_base() {
    let mut model = model();
    model.supports.push(Support {
        name: "guide".to_owned(),
        nodes: vec![4, 5],
        fixed: [false, true, false],
        by: HeldBy::Ground,
    });
    let height = crate::results::comparison::clear_height(&model);
    assert_eq!(height, Some(100.0));
}

#[test]
fn first_damage_is_told_with_its_place() {
    let mut model = model();
    model.contact.slave_facets = vec![[1, 2, 6, 5]];
    model.contact.slave_body = vec![0];
    model.contact.slave_law = vec![0];
    model.contact.law_names = vec!["joint".to_owned()];
    model.contact.master_facets = vec![[8, 11, 15, 12]];
    model.contact.master_body = vec![1];
    let onset = |place: u32| state::Onset {
        increment: 3,
        step: 1,
        displacement_mm: 0.2,
        force_kN: 4.0,
        load_factor: 0.1,
        place,
    };
    let noted = state::FirstDamage {
        joint: Some(onset(2)),
        crack: Some(onset(1)),
        crush: None,
    };
    let told = first_damage(&model, &noted);
    let joint = told.joint.unwrap().place;
    assert_eq!(joint.interface.as_deref(), Some("joint"));
    assert_eq!(joint.bodies, ["unit 0", "unit 1"]);
    // Point 2 is at the third corner of its facet: its quarter has its middle there.
    assert_eq!(joint.at_mm, [100.0, 75.0, 75.0]);
    let crack = told.crack.unwrap();
    assert_eq!((crack.increment, crack.step), (3, 1));
    assert_eq!(crack.place.at_mm, [152.0, 50.0, 50.0]);
    assert_eq!(
        crack.place.told(),
        "mortar of unit 1, course 0, at (152, 50, 50) mm"
    );
    assert_eq!(told.crush, None);
}

#[test]
fn answers_are_read_back_as_they_were_written() {
    let curve = Curve::of_points(&[(0.0, 0.0), (2.0, 4.0), (-2.0, -3.0), (0.0, 0.0), (2.0, 3.0)]);
    let mut answers = Answers::of_curve(&curve, Some(100.0));
    answers.failure_mode = Some(FailureMode::SteppedDiagonal);
    answers.failure_measure = Some(FailureMeasure::default());
    answers
        .reactions_at_peak_kN
        .insert("bottom".to_owned(), [1.0, 0.0, -2.0]);
    let text = serde_json::to_string(&answers).unwrap();
    assert!(
        text.contains("\"failure_mode\":\"stepped_diagonal\""),
        "{text}"
    );
    assert_eq!(serde_json::from_str::<Answers>(&text).unwrap(), answers);
    // Keys that an older file does not have are empty.
    assert_eq!(
        serde_json::from_str::<Answers>("{}").unwrap(),
        Answers::default()
    );
}
