//! Reports of complete and incomplete folders.

use std::path::Path;

use super::*;
use crate::results::output::{DECK, FIELDS, HISTORY, SUMMARY};
use crate::results::{RunDirectory, fake};
use crate::solve::Recorder;

/// A finished run of three increments, two of them driven.
fn run(path: &Path) {
    let model = fake::model();
    let mut run = RunDirectory::create(path, &model).unwrap();
    for (i, (step, d, f)) in [(0, 0.0, 0.0), (1, 1.0, 20.0), (1, 2.0, 10.0)]
        .into_iter()
        .enumerate()
    {
        let mut row = fake::row(i + 1, step, d, f);
        row.time = i as f64;
        run.take(&model, &row, Some(&fake::frame(&model, row.time)))
            .unwrap();
    }
    let mut summary = fake::summary(Status::Completed);
    summary.log = vec!["static: <no> equilibrium".to_owned()];
    run.finish(&model, &summary, &["<img src=x>".to_owned()])
        .unwrap();
}

fn report(path: &Path) -> Report {
    Report::of(&RunFolder::open(path).unwrap(), None).unwrap()
}

/// Data of the page.
fn data(html: &str) -> serde_json::Value {
    let (_, rest) = html
        .split_once("<script type=\"application/json\" id=\"data\">")
        .unwrap();
    let (json, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(json).unwrap()
}

#[test]
fn a_page_has_the_whole_run_and_loads_nothing_external() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path());
    let report = report(folder.path());
    assert_eq!((report.frames, report.frames_of_run), (3, 3));
    assert_eq!(report.notes, [""; 0]);
    let html = &report.html;
    assert!(html.starts_with("<!doctype html>"));
    assert!(html.contains("<strong>20.00</strong>") && html.contains("completed"));
    assert!(html.contains("static: &lt;no&gt; equilibrium"));
    // The only address is the SVG namespace, which is not fetched.
    let rest = html.replace("http://www.w3.org/2000/svg", "");
    for outside in ["http:", "https:", "src=", "@import", "url("] {
        let found = rest.replace("&lt;img src=x&gt;", "").contains(outside);
        assert!(!found, "{outside}");
    }
    let data = data(html);
    assert_eq!(data["series"]["rows"], 3);
    assert_eq!(data["series"]["peak"], 1);
    let view = &data["view"];
    assert_eq!(view["materials"], serde_json::json!(["brick", "mortar"]));
    assert!(!view["units"].as_array().unwrap().is_empty());
    let rows: Vec<_> = view["frames"].as_array().unwrap().iter().collect();
    assert_eq!(rows.len(), 3);
    assert_eq!(rows[2]["row"], 2);
    // All 16 nodes are on the boundary: 0.001 · 2 · (x + 1) at the largest x of 202
    assert_eq!(rows[2]["most"], 0.406);
    let moved = packed::decode(rows[2]["displacement"].as_str().unwrap());
    assert_eq!(moved.len(), 16 * 3 * 2);
    // 0.3 t + 0.1 e at t = 2, of 255
    assert_eq!(
        packed::decode(rows[2]["tensile"].as_str().unwrap()),
        [153, 179]
    );
}

#[test]
fn a_deck_cannot_write_markup_into_the_page() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path());
    let evil = "</title></script><script>alert(1)</script>{{DATA}}";
    std::fs::write(
        folder.path().join(DECK),
        format!("title = \"{evil}\"\n# </pre><script>alert(2)</script>\n"),
    )
    .unwrap();
    let experiment = Experiment {
        name: evil.to_owned(),
        points: vec![(0.0, 0.0), (1.0, 30.0)],
    };
    let open = RunFolder::open(folder.path()).unwrap();
    let html = Report::of(&open, Some(&experiment)).unwrap().html;
    assert!(!html.contains("<script>alert") && !html.contains("<img"));
    assert!(html.contains("&lt;/title&gt;&lt;/script&gt;"));
    assert_eq!(data(&html)["experiment"]["name"], evil);
    assert!(html.contains("measured 30.00 kN"));
    let (opened, closed) = (
        html.matches("<script").count(),
        html.matches("</script>").count(),
    );
    assert_eq!((opened, closed), (2, 2));
}

#[test]
fn frames_are_omitted_if_the_page_would_become_too_large() {
    let folder = tempfile::tempdir().unwrap();
    let model = fake::model();
    let mut run = RunDirectory::create(folder.path(), &model).unwrap();
    for i in 0..200 {
        let force = if i == 71 { 9.0 } else { 1.0 };
        let mut row = fake::row(i + 1, 1, i as f64, force);
        row.time = i as f64;
        run.take(
            &model,
            &row,
            Some(&fake::frame(&model, 0.01 * i as f64 + 1.0)),
        )
        .unwrap();
    }
    drop(run);
    let open = RunFolder::open(folder.path()).unwrap();
    let whole = Report::within(&open, None, LIMIT).unwrap();
    assert_eq!(whole.frames, 200);
    let limit = whole.html.len() - 20_000;
    let small = Report::within(&open, None, limit).unwrap();
    assert!(small.html.len() <= limit, "{} > {limit}", small.html.len());
    assert!((50..200).contains(&small.frames), "{}", small.frames);
    assert!(
        small
            .html
            .contains(&format!("{} of 200 frames", small.frames))
    );
    // The last frame and that of the peak always stay.
    let least = Report::within(&open, None, 0).unwrap();
    assert!((1..=2).contains(&least.frames));
}

#[test]
fn an_incomplete_folder_gives_a_page_of_its_parts() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path);
    std::fs::remove_file(path.join(SUMMARY)).unwrap();
    let killed = report(path);
    assert!(killed.html.contains("no summary: going on, or killed"));
    assert_eq!((killed.frames, killed.notes.len()), (3, 0));

    std::fs::write(path.join(SUMMARY), "{").unwrap();
    std::fs::write(path.join(FIELDS), "no HDF5").unwrap();
    let damaged = report(path);
    assert_eq!(damaged.frames, 0);
    assert!(data(&damaged.html)["view"].is_null());
    assert!(damaged.notes[0].starts_with("summary.json cannot be read"));
    assert!(damaged.notes[1].starts_with("results.vtkhdf cannot be read"));

    std::fs::remove_file(path.join(FIELDS)).unwrap();
    let without = report(path);
    assert_eq!(without.notes[1], "The folder has no results.vtkhdf.");

    // Only the header: a run that has just begun.
    let text = std::fs::read_to_string(path.join(HISTORY)).unwrap();
    let header = text.lines().next().unwrap().to_owned() + "\n";
    std::fs::write(path.join(HISTORY), header).unwrap();
    let begun = report(path);
    assert_eq!(data(&begun.html)["series"]["rows"], 0);
    assert!(data(&begun.html)["series"]["peak"].is_null());

    std::fs::write(path.join(HISTORY), "a,b\n").unwrap();
    assert!(Report::of(&RunFolder::open(path).unwrap(), None).is_err());
}

#[test]
fn undriven_runs_and_numbers_that_are_not_finite_give_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let model = fake::model();
    let mut run = RunDirectory::create(folder.path(), &model).unwrap();
    let mut row = fake::row(1, 0, 0.0, f64::NAN);
    row.residual = f64::INFINITY;
    let mut frame = fake::frame(&model, 1.0);
    frame.displacement[0] = [f64::NAN, f64::INFINITY, 0.0];
    frame.tensile_damage[0] = f64::NAN;
    run.take(&model, &row, Some(&frame)).unwrap();
    drop(run);
    let report = report(folder.path());
    assert_eq!(report.frames, 1);
    assert!(!report.html.contains("Peak force"));
    assert_eq!(data(&report.html)["series"]["driven"], packed::encode(&[0]));
}

#[test]
fn a_frame_belongs_to_the_row_of_its_time() {
    let rows: Vec<_> = [0.5, 1.0, 1.5]
        .map(|time| HistoryRow {
            time,
            ..HistoryRow::default()
        })
        .into();
    let of = |time| nearest(&rows, time);
    assert_eq!([0.0, 0.5, 1.0, 1.1, 1.5, 9.0].map(of), [0, 0, 1, 1, 2, 2]);
    assert_eq!(nearest(&[], 1.0), 0);
}
