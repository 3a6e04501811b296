//! Tests of the recorder, driven by a scripted solver.

use super::*;
use crate::arguments::Progress;
use std::path::PathBuf;
use wythe_core::deck::Deck;
use wythe_core::model::sizes::Sizes;
use wythe_core::state::{InterfaceFrame, InterfaceState};

const COUPLET: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/01_couplet_tension.toml"
);

fn couplet() -> Model {
    Model::from_deck(&Deck::load(COUPLET, &[]).unwrap())
        .unwrap()
        .0
}

fn frame(model: &Model, time: f64) -> Frame {
    let elements = model.mesh.elements.len();
    let points = 4 * model.contact.slave_facets.len();
    Frame {
        time,
        displacement: vec![[0.0, 0.0, time]; model.mesh.nodes.len()],
        probes: vec![0.0; model.columns().len()],
        stress: vec![[0.0; 6]; elements],
        tensile_damage: vec![0.5; elements],
        compressive_damage: vec![0.0; elements],
        plastic_strain: vec![[0.0; 6]; elements],
        yielded: vec![true; elements],
        crack_width: vec![0.0; elements],
        interfaces: InterfaceFrame {
            opening: vec![0.0; points],
            slip: vec![[0.0; 2]; points],
            traction: vec![[0.0; 3]; points],
            damage: vec![0.0; points],
            state: vec![InterfaceState::Intact; points],
            ..InterfaceFrame::default()
        },
        ..Frame::default()
    }
}

/// Converges `increments` times unless the recorder stops it, then ends with `status`.
fn solve(
    model: &Model,
    recorder: &mut dyn Recorder,
    increments: usize,
    status: Status,
) -> Result<Summary, RunError> {
    let mut summary = Summary::begun(Sizes::default(), 1);
    summary.status = status;
    "step 0, unit 1: the joint has gone".clone_into(&mut summary.message);
    for increment in 1..=increments {
        let t = increment as f64 / increments as f64;
        recorder.progress(0, t, 1);
        let row = HistoryRow {
            increment,
            time: t,
            displacement_mm: t,
            force_kN: 10.0 * t,
            probes: vec![0.0; model.columns().len()],
            ..HistoryRow::default()
        };
        summary.increments = increment;
        if !recorder.take(model, &row, Some(&frame(model, t)))? {
            summary.status = Status::Interrupted;
            break;
        }
    }
    Ok(summary)
}

fn status_in(out: &Path) -> (String, u64) {
    let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let warnings = value["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1);
    (
        value["status"].as_str().unwrap().to_owned(),
        value["increments"].as_u64().unwrap(),
    )
}

/// Number of history rows below the header.
fn rows_in(out: &Path) -> usize {
    let text = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let mut lines = text.lines();
    assert!(lines.next().is_some());
    lines.count()
}

fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    (folder, out)
}

/// Records without interrupts.
fn recorded(
    model: &Model,
    out: &Path,
    solve: impl FnOnce(&mut dyn Recorder) -> Result<Summary, RunError>,
) -> Result<(), Failure> {
    let directory = RunDirectory::create(out, model)?;
    let watched = (directory, quiet(model));
    record(model, &warnings(), watched, &Interrupt::default(), solve)
}

fn quiet(model: &Model) -> Terminal {
    Terminal::new(model, Progress::Auto, true)
}

fn warnings() -> Vec<String> {
    vec!["materials.brick: beware".to_owned()]
}

#[test]
fn a_run_that_completes_leaves_everything() {
    let (model, (_folder, out)) = (couplet(), folder());
    let ended = recorded(&model, &out, |recorder| {
        solve(&model, recorder, 3, Status::Completed)
    });
    assert!(ended.is_ok());
    assert_eq!(status_in(&out), ("completed".to_owned(), 3));
    for name in [
        "history.csv",
        "results.vtkhdf",
        "load_displacement.svg",
        "crack_pattern.svg",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
}

#[test]
fn lost_convergence_keeps_what_was_found_and_says_why() {
    let (model, (_folder, out)) = (couplet(), folder());
    let ended = recorded(&model, &out, |recorder| {
        solve(&model, recorder, 2, Status::NotConverged)
    });
    let failure = ended.unwrap_err();
    assert_eq!(failure.exit_code(), 3);
    let Failure::NotConverged(report) = failure else {
        panic!("{failure:?}")
    };
    assert!(report.to_string().contains("the joint has gone"));
    assert_eq!(status_in(&out), ("not_converged".to_owned(), 2));
    assert_eq!(rows_in(&out), 2);
}

#[test]
fn an_interrupt_ends_the_run_after_the_increment_with_everything_written() {
    let (model, (_folder, out)) = (couplet(), folder());
    let interrupt = Interrupt::default();
    interrupt.request();
    let directory = RunDirectory::create(&out, &model).unwrap();
    let watched = (directory, quiet(&model));
    let ended = record(&model, &warnings(), watched, &interrupt, |recorder| {
        solve(&model, recorder, 5, Status::Completed)
    });
    assert_eq!(ended.unwrap_err().exit_code(), 130);
    assert_eq!(status_in(&out), ("interrupted".to_owned(), 1));
    assert_eq!(rows_in(&out), 1);
}

#[test]
fn a_folder_that_cannot_be_made_is_input_output_and_nothing_is_solved() {
    let (model, (_folder, out)) = (couplet(), folder());
    std::fs::write(&out, "mine").unwrap();
    let ended = recorded(&model, &out, |_| panic!("must not be reached"));
    assert_eq!(ended.unwrap_err().exit_code(), 4);
    assert_eq!(std::fs::read_to_string(&out).unwrap(), "mine");
}

/// A failure to write ends the run; here the fields belong to another mesh.
#[test]
fn results_that_stop_being_writable_are_input_output_and_leave_no_summary() {
    let (model, (_folder, out)) = (couplet(), folder());
    let ended = recorded(&model, &out, |recorder| {
        let mut wrong = frame(&model, 1.0);
        wrong.stress.pop();
        let row = HistoryRow {
            probes: vec![0.0; model.columns().len()],
            ..HistoryRow::default()
        };
        recorder.take(&model, &row, Some(&wrong))?;
        // Fields are written concurrently, so the next row receives the error.
        recorder.take(&model, &row, None)?;
        panic!("the recorder must refuse")
    });
    let failure = ended.unwrap_err();
    assert_eq!(failure.exit_code(), 4);
    let Failure::InputOutput(report) = failure else {
        panic!("{failure:?}")
    };
    assert!(report.to_string().contains("results.vtkhdf"), "{report}");
    assert!(!out.join("summary.json").exists());
}

#[test]
fn no_more_threads_are_taken_than_cores_have_use_for() {
    assert_eq!(few_threads(2, 2), (2, None));
    let (taken, warning) = few_threads(4, 2);
    assert_eq!(taken, 4);
    assert!(warning.is_some_and(|w| w.contains("2 cores")));
    assert_eq!(few_threads(100_000, 2).0, 8);
}
