//! `wythe study accuracy-speed`: what it prints and writes, and its exit codes.

mod common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::*;

const SCENE: &str = r#"
number = NUMBER
title = "Torn couplet"
what = "It is torn."
deck = "DECK"
set = ["steps.1.displacement=0.01"]
x = "displacement_mm"
y = "force_kN"
to = 0.016
[reference]
file = "reference.csv"
set = ["steps.1.increments.max=0.1"]
how = "the default in shorter increments."
uncertainty = 0.01
[[choices]]
name = "default"
group = "default"
[[choices]]
name = "penalty 50"
group = "penalty"
set = ["interfaces.joint.penalty_factor=50"]
"#;

/// A folder whose `docs/accuracy-speed` has these scenes on the couplet of the examples.
fn folder(numbers: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for number in numbers {
        let own = scenes(folder.path()).join(number);
        std::fs::create_dir_all(&own).unwrap();
        let text = SCENE.replace("NUMBER", number).replace("DECK", &couplet());
        std::fs::write(own.join("scene.toml"), text).unwrap();
    }
    folder
}

fn scenes(folder: &Path) -> PathBuf {
    folder.join("docs/accuracy-speed")
}

fn accuracy(folder: &Path, more: &[&str]) -> Output {
    let scenes = scenes(folder).display().to_string();
    wythe(&[&["study", "accuracy-speed", "--scenes", &scenes], more].concat())
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn references_are_made_then_the_page_with_charts_and_tables() {
    let folder = folder(&["1", "2"]);
    let without = accuracy(folder.path(), &[]);
    assert_eq!(code(&without), 2);
    let said = stderr(&without);
    assert!(
        said.contains("no reference") && said.contains("--only 1 --references"),
        "{said}"
    );
    let made = accuracy(folder.path(), &["--references"]);
    assert_eq!(code(&made), 0, "{}", stderr(&made));
    assert!(scenes(folder.path()).join("2/reference.csv").is_file());
    assert!(scenes(folder.path()).join("2/pattern.txt").is_file());

    let all = accuracy(folder.path(), &["--repeats", "2"]);
    assert_eq!(code(&all), 0, "{}", stderr(&all));
    assert!(
        stdout(&all).contains("4 of 4 choices came to the end"),
        "{}",
        stdout(&all)
    );
    assert!(
        stderr(&all).contains("1 Torn couplet, penalty 50 (2): peak"),
        "{}",
        stderr(&all)
    );
    let page = folder.path().join("docs/accuracy-speed.md");
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(text.contains("(accuracy-speed/2/chart.svg)"), "{text}");
    for name in ["chart.svg", "table.csv"] {
        assert!(
            scenes(folder.path()).join("1").join(name).is_file(),
            "{name}"
        );
    }
    // A part leaves the sections of the others.
    std::fs::write(&page, text.replace("It is torn.", "It was torn.")).unwrap();
    let part = accuracy(folder.path(), &["--only", "2"]);
    assert_eq!(code(&part), 0, "{}", stderr(&part));
    let text = std::fs::read_to_string(&page).unwrap();
    assert_eq!(text.matches("It was torn.").count(), 1, "{text}");
    assert_eq!(text.matches("It is torn.").count(), 1, "{text}");
    // All sections from the tables, nothing is run.
    let redrawn = accuracy(folder.path(), &["--redraw"]);
    assert_eq!(code(&redrawn), 0, "{}", stderr(&redrawn));
    let text = std::fs::read_to_string(&page).unwrap();
    assert_eq!(text.matches("It is torn.").count(), 2, "{text}");
}

#[test]
fn short_forms_write_nothing_and_what_is_not_there_is_named() {
    let folder = folder(&["1"]);
    assert_eq!(code(&accuracy(folder.path(), &["--references"])), 0);
    let short = accuracy(folder.path(), &["--short"]);
    assert_eq!(code(&short), 0, "{}", stderr(&short));
    assert!(
        stdout(&short).contains("2 of 2 choices"),
        "{}",
        stdout(&short)
    );
    assert!(!folder.path().join("docs/accuracy-speed.md").exists());
    for (more, exit, said) in [
        (&["--only", "8"][..], 2, "no scene `8`"),
        (&["--repeats", "0"], 2, "--repeats"),
        (&["--jobs", "0"], 2, "--jobs"),
        (&["--references", "--short"], 2, "cannot be used with"),
    ] {
        let run = accuracy(folder.path(), more);
        assert_eq!(code(&run), exit, "{more:?}");
        assert!(stderr(&run).contains(said), "{more:?}: {}", stderr(&run));
    }
    std::fs::remove_file(scenes(folder.path()).join("1/scene.toml")).unwrap();
    let empty = accuracy(folder.path(), &[]);
    assert_eq!(code(&empty), 2);
    assert!(
        stderr(&empty).contains("holds no scene"),
        "{}",
        stderr(&empty)
    );
}

#[test]
fn a_reference_that_ends_early_is_not_made() {
    let folder = folder(&["1"]);
    let file = scenes(folder.path()).join("1/scene.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let early = "steps.1.displacement=0.005";
    std::fs::write(&file, text.replace("steps.1.increments.max=0.1", early)).unwrap();
    let run = accuracy(folder.path(), &["--references"]);
    let said = stderr(&run);
    assert_eq!(code(&run), 3, "{said}");
    assert!(
        said.contains("its run ends at") && said.contains("`to`"),
        "{said}"
    );
    assert!(!file.with_file_name("reference.csv").exists());
}
