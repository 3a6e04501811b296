//! `wythe run --error`: the companions of a run, and the error of its figures.

mod common;

use std::path::Path;

use common::*;
use serde_json::Value;

/// The couplet pulled beyond its peak.
const PULLED: [&str; 2] = ["--set", "steps.1.displacement=0.014"];

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn summary(folder: &Path) -> Value {
    let text = std::fs::read_to_string(folder.join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn run(deck: &str, out: &Path, more: &[&str]) -> std::process::Output {
    wythe(&[&["run", deck, "--out", &text(out)][..], more].concat())
}

/// Value and error of a line such as `peak 5.58 ± 0.02 kN (…)`, as text.
fn stated(line: &str) -> [&str; 2] {
    let words: Vec<&str> = line.split(' ').collect();
    assert_eq!(words[2], "±", "{line}");
    [words[1], words[3]]
}

#[test]
fn figures_have_their_error_and_no_more_digits() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("couplet.out");
    let plain = run(&couplet(), &out, &PULLED);
    let history = std::fs::read(out.join("history.csv")).unwrap();
    assert_eq!(summary(&out)["error_estimate"], Value::Null);
    let output = run(&couplet(), &out, &[&PULLED[..], &["--error"]].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(std::fs::read(out.join("history.csv")).unwrap(), history);

    let said = stdout(&output);
    let lines: Vec<&str> = said.lines().collect();
    let [.., verdict, peak, area] = lines[..] else {
        panic!("{said}")
    };
    assert_eq!(Some(verdict), stdout(&plain).lines().last());
    let estimate = &summary(&out)["error_estimate"];
    for (line, key) in [(peak, "peak_force_kN"), (area, "area_J")] {
        let [value, error] = stated(line);
        let of = |name: &str| estimate[key][name].as_f64().unwrap();
        let decimals = |number: &str| number.split_once('.').map_or(0, |(_, part)| part.len());
        assert_eq!(decimals(value), decimals(error), "{line}");
        // In the last digit: half of it for the value; the error is rounded up, or down by a twentieth.
        let unit = 10f64.powi(-(decimals(error) as i32));
        let near = |number: &str, exact: f64| (number.parse::<f64>().unwrap() - exact) / unit;
        assert!(near(value, of("value")).abs() <= 0.5 + 1e-6, "{line}");
        assert!(
            (-0.05 - 1e-6..1.0).contains(&near(error, of("error"))),
            "{line}"
        );
        assert!(of("error") > 0.0 && of("relative") < 0.1, "{line}");
    }
    assert_eq!(
        estimate["peak_force_kN"]["value"],
        summary(&out)["peak_force_kN"]
    );
    for (i, part) in ["time", "mesh"].into_iter().enumerate() {
        let companion = &estimate["companions"][i];
        assert_eq!(companion["part"], part);
        assert_eq!(companion["status"], "completed");
        let own = summary(&out.join("error").join(part));
        assert_eq!(companion["figures"]["peak_force_kN"], own["peak_force_kN"]);
        assert_eq!(own["error_estimate"], Value::Null);
    }

    // Other commands show it, and the next run takes it away with the companions.
    assert!(stdout(&wythe(&["info", &text(&out)])).contains(peak));
    assert_eq!(code(&wythe(&["report", &text(&out)])), 0);
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains(peak), "{peak}");
    std::fs::write(out.join("error/notes.txt"), "mine").unwrap();
    let again = run(&couplet(), &out, &PULLED);
    assert!(!stdout(&again).contains('±'));
    assert!(!out.join("error/time").exists() && !out.join("error/mesh").exists());
    assert!(out.join("error/notes.txt").is_file());
}

#[test]
fn json_has_the_estimate_in_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("couplet.out");
    let more = ["--error", "--progress", "json"];
    let output = run(&couplet(), &out, &[&PULLED[..], &more].concat());
    let said = stdout(&output);
    let events: Vec<Value> = said
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    let end = events.last().unwrap();
    assert_eq!(end["event"], "end");
    assert_eq!(end["error_estimate"], summary(&out)["error_estimate"]);
    // Increments are those of the run.
    let increments = events.iter().filter(|e| e["event"] == "increment").count();
    assert_eq!(increments as u64, end["increments"].as_u64().unwrap());
}

/// A mesh from a file cannot be refined: its part is lacking, not zero.
#[test]
fn an_imported_mesh_has_no_error_by_mesh_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("imported.out");
    let deck = text(&repository("examples/50_imported_mesh.toml"));
    let output = run(&deck, &out, &["--error"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let said = stdout(&output);
    assert!(said.contains("without mesh)"), "{said}");
    assert!(
        said.lines()
            .last()
            .unwrap()
            .starts_with("error by mesh not estimated: the mesh of `couplet` comes"),
        "{said}"
    );
    let estimate = &summary(&out)["error_estimate"];
    assert_eq!(estimate["not_estimated"][0]["part"], "mesh");
    assert!(estimate["peak_force_kN"]["parts"].get("mesh").is_none());
    assert!(!out.join("error/mesh").exists());
}
