//! The command `wythe study validation`: its output, its files and its exit codes.

mod common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::*;

const CASE: &str = r#"
number = NUMBER
title = "Torn couplet"
what = "It is torn."
data = "f_t A"
agrees = "All of it."
differs = "Nothing."

[[runs]]
name = "torn"
deck = "DECK"
short = { set = ["steps.1.displacement=0.01"] }
cracks = true
[[runs.expect]]
name = "peak force, kN"
of = "peak"
column = "force_kN"
value = VALUE
tolerance = 0.01

[[charts]]
name = "curve"
title = "Force over displacement"
x = { column = "displacement_mm", label = "displacement [mm]" }
y = { column = "force_kN", label = "force [kN]" }
"#;

/// f_t × 204 × 98 mm² [kN].
const STRENGTH: &str = "5.59776";

/// A folder whose `docs/validation` has these cases on the couplet of the examples: number and expected strength.
fn folder(cases: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (number, value) in cases {
        case(folder.path(), number, value);
    }
    folder
}

fn cases(folder: &Path) -> PathBuf {
    folder.join("docs/validation")
}

fn case(folder: &Path, number: &str, value: &str) {
    let own = cases(folder).join(number);
    std::fs::create_dir_all(&own).unwrap();
    let text = CASE.replace("NUMBER", number).replace("VALUE", value);
    let text = text.replace("DECK", &couplet());
    std::fs::write(own.join("case.toml"), text).unwrap();
}

/// Runs the cases of `folder`; the folders of the runs lie beside `docs`.
fn validation(folder: &Path, more: &[&str]) -> Output {
    let cases = cases(folder).display().to_string();
    let runs = folder.join("runs").display().to_string();
    let first = ["study", "validation", "--cases", &cases, "--runs", &runs];
    wythe(&[&first[..], more].concat())
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn read(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn row(index: &str, number: &str) -> String {
    let mut rows = index
        .lines()
        .filter(|l| l.starts_with(&format!("| [{number} ")));
    rows.next().unwrap_or_else(|| panic!("{index}")).to_owned()
}

#[test]
fn pages_are_written_beside_the_cases_and_a_part_leaves_the_rows_of_the_others() {
    let folder = folder(&[("1", STRENGTH), ("2", STRENGTH)]);
    let all = validation(folder.path(), &["--jobs", "2"]);
    assert_eq!(code(&all), 0, "{}", stderr(&all));
    assert!(
        stdout(&all).contains("2 of 2 runs as expected"),
        "{}",
        stdout(&all)
    );
    assert!(
        stderr(&all).contains("1 Torn couplet, torn: holds"),
        "{}",
        stderr(&all)
    );
    let own = cases(folder.path()).join("1");
    assert!(read(own.join("README.md")).contains("| holds |"));
    for name in [
        "torn.csv",
        "torn.toml",
        "torn_scene.svg",
        "torn_cracks.svg",
        "curve.svg",
    ] {
        assert!(own.join(name).is_file(), "{name}");
    }
    assert!(folder.path().join("runs/1/torn/results.vtkhdf").is_file());
    let index = folder.path().join("docs/validation.md");
    let before = read(&index);
    assert!(
        row(&before, "2").contains("(validation/2/README.md)"),
        "{before}"
    );

    // An expectation that does not hold is reported; the exit code is that of a completed study.
    case(folder.path(), "2", "7");
    let part = validation(folder.path(), &["--only", "2"]);
    assert_eq!(code(&part), 0, "{}", stderr(&part));
    assert!(
        stdout(&part).contains("0 of 1 runs as expected"),
        "{}",
        stdout(&part)
    );
    assert!(
        stderr(&part).contains("torn: WRONG: peak force"),
        "{}",
        stderr(&part)
    );
    assert!(read(cases(folder.path()).join("2/README.md")).contains("**does not hold**"));
    let after = read(index);
    assert_eq!(row(&after, "1"), row(&before, "1"));
    assert!(row(&after, "2").contains("0 of 1"), "{after}");
}

#[test]
fn short_forms_write_nothing_unless_they_are_told_where() {
    let folder = folder(&[("1", STRENGTH)]);
    let short = validation(folder.path(), &["--short"]);
    assert_eq!(code(&short), 0, "{}", stderr(&short));
    assert!(
        stdout(&short).contains("1 of 1 runs as expected"),
        "{}",
        stdout(&short)
    );
    let own = cases(folder.path()).join("1");
    assert_eq!(std::fs::read_dir(&own).unwrap().count(), 1);
    assert!(!folder.path().join("docs/validation.md").exists());

    let out = folder.path().join("elsewhere/pages");
    let name = out.display().to_string();
    let told = validation(folder.path(), &["--short", "--out", &name]);
    assert_eq!(code(&told), 0, "{}", stderr(&told));
    assert!(
        stdout(&told).contains(&format!("written to {name}")),
        "{}",
        stdout(&told)
    );
    // 0.006 mm in the first step, 0.01 mm in the second.
    let way = column(&read(out.join("1/torn.csv")), "displacement_mm");
    assert!((way[way.len() - 1] - 0.016).abs() < 1e-9, "{way:?}");
    let index = read(folder.path().join("elsewhere/validation.md"));
    assert!(row(&index, "1").contains("(pages/1/README.md)"), "{index}");
    assert_eq!(std::fs::read_dir(&own).unwrap().count(), 1);
}

#[test]
fn what_is_not_there_is_named_and_exits_as_other_commands_do() {
    let folder = folder(&[("1", STRENGTH)]);
    for (more, exit, said) in [
        (["--only", "8"], 2, "no case `8`"),
        (["--only", "torn"], 2, "--only"),
        (["--limit", "0"], 2, "seconds above 0"),
        (["--jobs", "0"], 2, "--jobs"),
    ] {
        let run = validation(folder.path(), &more);
        assert_eq!(code(&run), exit, "{more:?}");
        assert!(stderr(&run).contains(said), "{more:?}: {}", stderr(&run));
    }
    assert!(!folder.path().join("runs").exists());
    assert_eq!(code(&validation(&folder.path().join("nowhere"), &[])), 4);
    std::fs::remove_file(cases(folder.path()).join("1/case.toml")).unwrap();
    let empty = validation(folder.path(), &[]);
    assert_eq!(code(&empty), 2);
    assert!(
        stderr(&empty).contains("holds no case"),
        "{}",
        stderr(&empty)
    );
}
