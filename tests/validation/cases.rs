//! The cases of docs/validation in their short forms: what is claimed of them holds, and their pages tell of them
//! as they are.

use std::path::{Path, PathBuf};
use std::time::Duration;

use wythe::study::StudyError;
use wythe::study::validation::{
    Case, Options, Validated, cases, chart, index, page, table, validate,
};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/validation")
}

fn run(cases: &[Case], folder: &Path) -> Vec<Validated> {
    let options = Options {
        short: true,
        // No run comes near it; one that hangs ends.
        limit: Duration::from_secs(300),
        jobs: std::thread::available_parallelism().map_or(1, usize::from),
        folder: folder.to_owned(),
    };
    let progress = |case: &Case, outcome: &wythe::study::validation::Outcome| {
        let seconds = outcome.cost.seconds;
        println!("{}, {}: {seconds:.2} s", case.name(), outcome.name);
    };
    validate(cases, &options, &progress, &|| false)
}

#[test]
fn what_is_claimed_holds_in_the_short_forms() {
    let out = tempfile::tempdir().unwrap();
    let all = run(&cases(&folder()).unwrap(), out.path());
    let mut failed = Vec::new();
    for validated in &all {
        assert!(!validated.outcomes.is_empty(), "{}", validated.case.name());
        for outcome in validated.outcomes.iter().filter(|o| !o.holds()) {
            let (case, run) = (validated.case.name(), &outcome.name);
            failed.push(format!("{case}, {run}: {:?}", outcome.verdict));
        }
        for it in &validated.case.charts {
            assert!(chart(it, validated).unwrap().contains(&it.y.label));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Pages are written by the study from the cases: whoever changes a case without its page is told here.
#[test]
fn pages_tell_of_the_cases_as_they_are() {
    let listed = std::fs::read_to_string(folder().join("../validation.md")).unwrap();
    for case in cases(&folder()).unwrap() {
        let file = case.folder.join("README.md");
        let page = std::fs::read_to_string(&file).unwrap_or_else(|why| {
            panic!("{}: {why}; run `wythe study validation`", file.display())
        });
        for text in [
            &case.name(),
            &case.what,
            &case.data,
            &case.agrees,
            &case.differs,
        ] {
            assert!(page.contains(text.trim()), "{}: {text}", file.display());
        }
        for run in &case.runs {
            let name = &run.name;
            assert!(
                page.contains(&format!("| {name}")),
                "{}: {name}",
                file.display()
            );
            for end in ["csv", "toml"] {
                let beside = case.folder.join(format!("{name}.{end}"));
                assert!(beside.is_file(), "{}", beside.display());
            }
        }
        for chart in &case.charts {
            let picture = format!("{}.svg", chart.name);
            assert!(
                page.contains(&picture) && case.folder.join(&picture).is_file(),
                "{picture}"
            );
        }
        assert!(
            listed.contains(&format!("[{}]", case.name())),
            "{}",
            case.name()
        );
    }
}

/// A case of one block that is pressed.
const CASE: &str = r#"
number = 1
title = "A block"
what = "It is pressed."
data = "None."
agrees = "All of it."
differs = "Nothing."

[[runs]]
name = "block"
about = "once"
deck = "block_deck.toml"
[[runs.expect]]
name = "peak"
of = "peak"
column = "load_kN"
value = 1.0
tolerance = 1e-6
[[runs.expect]]
name = "residual"
of = "final"
column = "residual"
reported = true

[[charts]]
name = "curve"
title = "Load over time"
x = { column = "time", label = "time [s]" }
y = { column = "load_kN", label = "load [kN]" }
"#;

const DECK: &str = r#"
format = 1
[materials.stone]
E = "10000 MPa"
nu = 0.2
[[blocks]]
name = "block"
size = ["100 mm", "100 mm", "100 mm"]
material = "stone"
mesh = [1, 1, 1]
[[supports]]
on = "block.bottom"
[[steps]]
kind = "load"
[[steps.loads]]
name = "load"
on = "block.top"
force = [0, 0, "-1 kN"]
"#;

fn block(text: &str) -> (tempfile::TempDir, Result<Case, StudyError>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("block_deck.toml"), DECK).unwrap();
    let case = Case::from_str(text, "case.toml", folder.path());
    (folder, case)
}

#[test]
fn a_claim_that_does_not_hold_is_told_on_the_page() {
    for (value, said) in [("1.0", "| holds |"), ("1.1", "**does not hold**")] {
        let (folder, case) = block(&CASE.replace("value = 1.0", &format!("value = {value}")));
        let all = run(&[case.unwrap()], folder.path());
        let [validated] = &all[..] else { panic!() };
        assert_eq!(validated.outcomes[0].holds(), value == "1.0");
        let page = page(validated);
        assert!(
            page.contains(said) && page.contains("| reported |"),
            "{page}"
        );
        let held = if value == "1.0" { "1 of 1" } else { "0 of 1" };
        // The rows of other cases stay.
        let before = "| [7 Another](validation/x/README.md) | 1 | 1 of 1 | | 1 |\n| [1 A block](x) | stale |";
        let listed = index(&all, "validation", before);
        assert!(
            listed.contains(held) && listed.contains("[7 Another]"),
            "{listed}"
        );
        assert!(!listed.contains("stale"), "{listed}");
        let table = table(&validated.case, &validated.outcomes[0]);
        let mut lines = table.lines();
        assert_eq!(lines.next(), Some("time,load_kN,residual"));
        assert!(
            lines.next_back().is_some_and(|l| l.starts_with("1,1,")),
            "{table}"
        );
    }
}

#[test]
fn bad_cases_are_told_with_their_place() {
    for (from, to, said) in [
        ("number = 1", "nummer = 1", "nummer"),
        (
            "column = \"load_kN\"\nvalue",
            "column = \"lod_kN\"\nvalue",
            "lod_kN",
        ),
        (
            "name = \"block\"",
            "name = \"a block\"",
            "no name for a file",
        ),
        (
            "x = { column = \"time\"",
            "x = { column = \"tim\"",
            "no such column",
        ),
        (
            "title = \"Load over time\"",
            "title = \"T\"\nruns = [\"wall\"]",
            "no run `wall`",
        ),
        (
            "reported = true",
            "reported = true\nvalue = 1",
            "takes no value",
        ),
        ("block_deck.toml", "no_deck.toml", "no_deck.toml"),
        (
            "y = { column = \"load_kN\",",
            "y = { expect = \"peak\",",
            "`y.expect` and `at`",
        ),
    ] {
        assert!(CASE.contains(from), "{from}");
        let (_folder, case) = block(&CASE.replacen(from, to, 1));
        let error = case.unwrap_err();
        let text = format!("{:?}", miette::Report::new(error));
        assert!(text.contains(said), "{said}: {text}");
    }
}
