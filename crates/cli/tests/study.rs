//! The command `wythe study stability`: its output, its files and its exit codes.

mod common;

use std::path::Path;

use common::*;

const CASE: &str = r#"
number = 7
title = "Torn couplet"
mechanics = "It is torn."
source = "f_t A"
deck = "DECK"
short = { set = ["steps.1.displacement=0.01 mm"] }
[[expect]]
name = "peak force"
of = "peak"
column = "force_kN"
value = 5.59776
tolerance = 0.01
"#;

/// A folder with one case on the couplet of the examples.
fn atlas() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    case(folder.path(), "07-torn", CASE);
    folder
}

fn case(folder: &Path, name: &str, text: &str) {
    std::fs::create_dir(folder.join(name)).unwrap();
    let text = text.replace("DECK", &couplet());
    std::fs::write(folder.join(name).join("case.toml"), text).unwrap();
}

fn stability(cases: &Path, more: &[&str]) -> std::process::Output {
    let cases = cases.display().to_string();
    wythe(&[&["study", "stability", "--cases", &cases], more].concat())
}

#[test]
fn an_atlas_is_written_with_its_picture_and_a_part_of_it_is_printed() {
    let folder = atlas();
    let out = folder.path().join("docs");
    let name = out.display().to_string();
    let methods = ["--methods", "auto,quasi_static", "--short"];
    let run = stability(folder.path(), &[&methods[..], &["--out", &name]].concat());
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    assert!(
        stderr(&run).contains("Torn couplet auto completed"),
        "{}",
        stderr(&run)
    );
    let page = std::fs::read_to_string(out.join("stability.md")).unwrap();
    assert!(page.contains("| 7 Torn couplet | completed, 0"), "{page}");
    assert!(
        page.contains("quasi_static: brick has no density"),
        "{page}"
    );
    assert!(out.join("stability.svg").exists());

    let before = std::fs::read_dir(folder.path()).unwrap().count();
    let part = stability(folder.path(), &[&methods[..], &["--only", "7"]].concat());
    assert_eq!(code(&part), 0, "{}", stderr(&part));
    assert!(String::from_utf8_lossy(&part.stdout).contains("## 7 Torn couplet"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), before);
}

#[test]
fn what_is_not_there_is_named_and_exits_as_other_commands_do() {
    let folder = atlas();
    for (more, exit, said) in [
        (["--only", "8"], 2, "no case `8`"),
        (["--methods", "magic"], 2, "no method `magic`"),
        (["--limit", "0"], 2, "seconds above 0"),
        (["--jobs", "0"], 2, "--jobs"),
    ] {
        let run = stability(folder.path(), &more);
        assert_eq!(code(&run), exit, "{more:?}");
        assert!(stderr(&run).contains(said), "{more:?}: {}", stderr(&run));
    }
    assert_eq!(code(&stability(&folder.path().join("nowhere"), &[])), 4);
    let empty = stability(&folder.path().join("07-torn"), &[]);
    assert_eq!(code(&empty), 2);
    assert!(stderr(&empty).contains("holds no case"));
    case(folder.path(), "08-same", CASE);
    let twice = stability(folder.path(), &[]);
    assert_eq!(code(&twice), 2);
    assert!(stderr(&twice).contains("both have the number 7"));
    case(folder.path(), "06-wrong", "number = 1\nheading = \"a\"\n");
    let wrong = stability(folder.path(), &[]);
    assert_eq!(code(&wrong), 2);
    assert!(
        stderr(&wrong).contains("case.toml:2:1"),
        "{}",
        stderr(&wrong)
    );
}
