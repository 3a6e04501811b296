//! The cases of docs/validation with their short forms: their expectations hold, and their pages describe the cases
//! as they are.

use std::path::{Path, PathBuf};
use std::time::Duration;

use wythe_cli::study::validation::{
    Case, Chart, Content, Options, Outcome, Validated, cases, chart, index, page, table, validate,
};
use wythe_cli::study::{Cost, History, Measured, StudyError, Verdict, Wanted};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/validation")
}

fn run(cases: &[Case], folder: &Path) -> Vec<Validated> {
    let options = Options {
        short: true,
        // All runs are far below this limit; it stops a run that hangs.
        limit: Duration::from_secs(300),
        jobs: std::thread::available_parallelism().map_or(1, usize::from),
        folder: folder.to_owned(),
    };
    let progress = |case: &Case, outcome: &wythe_cli::study::validation::Outcome| {
        let seconds = outcome.cost.seconds;
        println!("{}, {}: {seconds:.2} s", case.name(), outcome.name);
    };
    validate(cases, &options, &progress, &|| false)
}

#[test]
fn expectations_hold_in_the_short_forms() {
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
            draws_what_was_run(it, validated);
        }
        // Values that are only reported would hold for any solver.
        let expect = validated
            .case
            .runs
            .iter()
            .filter(|r| r.overrides(true).is_some());
        let mut expect = expect.flat_map(|r| &r.expect).filter(|e| e.holds_of(true));
        let claims = expect.any(|e| e.wanted != Wanted::Reported);
        assert!(claims, "{} claims nothing", validated.case.name());
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Checks that every run of a chart has a line and every measure a mark.
fn draws_what_was_run(it: &Chart, validated: &Validated) {
    let empty = Validated {
        outcomes: Vec::new(),
        ..validated.clone()
    };
    let [with, without] = [validated, &empty].map(|of| chart(it, of).unwrap());
    let has_run = |name: &String| validated.outcome(name).is_some();
    // Axes, ticks and the legend are lines of two points.
    let lines = |svg: &str| {
        let points = svg.split("<polyline ").skip(1);
        let points = points.filter_map(|line| line.split("points=\"").nth(1)?.split('"').next());
        points.filter(|p| p.split_whitespace().count() > 2).count()
    };
    let marks = |svg: &str| svg.matches("<circle ").count();
    let (drawn, wanted) = match &it.content {
        Content::Curves(names) => (
            lines(&with) - lines(&without),
            names.iter().filter(|name| has_run(name)).count(),
        ),
        Content::Measures { at, .. } => (
            marks(&with) - marks(&without),
            at.iter().filter(|(name, _)| has_run(name)).count(),
        ),
    };
    assert_eq!(drawn, wanted, "{} of {}", it.name, validated.case.name());
}

/// The case as if each of its runs had completed, without numbers.
fn without_numbers(case: &Case) -> Validated {
    let outcomes = case.runs.iter().map(|run| {
        let of_full = run.expect.iter().filter(|e| e.holds_of(false));
        let measured = of_full.map(|_| Measured {
            value: f64::NAN,
            error: None,
            holds: true,
            text: String::new(),
        });
        Outcome {
            name: run.name.clone(),
            verdict: Verdict::Completed(None),
            measured: measured.collect(),
            cost: Cost::default(),
            energy: 0.0,
            history: History::default(),
            deck: None,
            scene: run.drawing.then(String::new),
            cracks: run.cracks.map(|_| String::new()),
        }
    });
    Validated {
        case: case.clone(),
        short: false,
        outcomes: outcomes.collect(),
    }
}

/// The lines of a page. From tables of measurements and costs only the columns that the case itself gives: run,
/// expectation, known value.
fn told(page: &str) -> Vec<String> {
    let mut columns: Option<&[usize]> = None;
    let mut lines = Vec::new();
    for line in page.lines() {
        if line.starts_with("| Run | | Measured") {
            columns = Some(&[0, 1, 3]);
        } else if line.starts_with("| Run | increments") {
            columns = Some(&[0]);
        } else if !line.starts_with('|') {
            columns = None;
        }
        let cells: Vec<&str> = line.split('|').skip(1).map(str::trim).collect();
        lines.push(match columns {
            // A run that ended unexpectedly has a row of its own.
            Some([_, _, _]) if cells[5].is_empty() && !line.contains("Measured") => continue,
            Some(columns) => columns
                .iter()
                .map(|c| cells[*c])
                .collect::<Vec<_>>()
                .join(" | "),
            None => line.to_owned(),
        });
    }
    lines
}

/// The study writes the pages from the cases. This test fails if a case changes without its page.
#[test]
fn pages_match_the_cases() {
    let listed = std::fs::read_to_string(folder().join("../validation.md")).unwrap();
    for case in cases(&folder()).unwrap() {
        let file = case.folder.join("README.md");
        let stale = |why: &str| -> String {
            let (file, number) = (file.display(), case.number);
            format!("{file}: {why}; run `wythe study validation --only {number}`")
        };
        let stored = std::fs::read_to_string(&file);
        let stored = stored.unwrap_or_else(|why| panic!("{}", stale(&why.to_string())));
        let (stored, wanted) = (told(&stored), told(&page(&without_numbers(&case))));
        for (stored, wanted) in stored.iter().zip(&wanted) {
            assert_eq!(stored, wanted, "{}", stale("not as the case has it"));
        }
        assert_eq!(stored.len(), wanted.len(), "{}", stale("lines are missing"));
        let runs = case.runs.iter().map(|run| &run.name);
        let beside = runs.flat_map(|name| [format!("{name}.csv"), format!("{name}.toml")]);
        let charts = case
            .charts
            .iter()
            .map(|chart| format!("{}.svg", chart.name));
        for name in beside.chain(charts) {
            let beside = case.folder.join(name);
            assert!(beside.is_file(), "{}", beside.display());
        }
        assert!(
            listed.contains(&format!("[{}]", case.name())),
            "{}",
            case.name()
        );
    }
}

/// A case with one compressed block.
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
    for name in ["block_deck.toml", "other.toml"] {
        std::fs::write(folder.path().join(name), DECK).unwrap();
    }
    let case = Case::from_str(text, "case.toml", folder.path());
    (folder, case)
}

#[test]
fn a_failed_expectation_is_shown_on_the_page() {
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
        // The rows of other cases remain.
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

/// A failed run must not overwrite the files of the previous one, and its expectations are counted. A run that meets
/// all expectations but ends wrongly does not pass.
#[test]
fn a_failed_run_is_shown_in_the_list() {
    // The force is given in the file, so that it is rejected when the model is built.
    let (folder, case) = block(CASE);
    let deck = folder.path().join("block_deck.toml");
    std::fs::write(&deck, DECK.replace("on = \"block.top\"", "on = \"blok\"")).unwrap();
    let all = run(&[case.unwrap()], &folder.path().join("runs"));
    let outcome = &all[0].outcomes[0];
    assert!(outcome.deck.is_none() && outcome.history.rows(None).is_empty());
    let listed = index(&all, "validation", "");
    assert!(
        listed.contains("| 0 of 1; **does not hold**: block |"),
        "{listed}"
    );
    let (folder, case) = block(&CASE.replace("about = \"once\"", "energy = 1e-300"));
    let all = run(&[case.unwrap()], folder.path());
    let listed = index(&all, "validation", "");
    assert!(
        listed.contains("| 1 of 1; **does not hold**: block |"),
        "{listed}"
    );
}

/// The page shows the distance from a curve that is only reported.
#[test]
fn a_reported_distance_from_a_curve_is_shown() {
    let curve = "of = \"curve\"\nx = \"time\"\ny = \"load_kN\"\nfile = \"known.csv\"";
    let text = CASE.replace("of = \"final\"\ncolumn = \"residual\"", curve);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("block_deck.toml"), DECK).unwrap();
    std::fs::write(
        folder.path().join("known.csv"),
        "time,load_kN\n0.5,1\n1,2\n",
    )
    .unwrap();
    let case = Case::from_str(&text, "case.toml", folder.path()).unwrap();
    let all = run(&[case], folder.path());
    let page = page(&all[0]);
    let row = page.lines().find(|l| l.contains("residual")).unwrap();
    // Half of the known curve: differences of 1/2 and 1 at a largest value of 2, a quarter to a half of it.
    assert!(
        row.contains(" % off |") && row.contains("| reported |"),
        "{row}"
    );
}

#[test]
fn keys_that_a_point_does_not_read_are_rejected() {
    let point = "point = { material = \"stone\", strain = [1e-4, 0, 0, 0, 0, 0], rows = 2 }";
    let good = CASE.replace("column = \"load_kN\"", "column = \"sig_xx_MPa\"");
    let good = good.replace("column = \"residual\"", "column = \"sig_xx_MPa\"");
    let good = &good[..good.find("[[charts]]").unwrap()];
    let good = good.replace("about = \"once\"", point);
    let columns = block(&good)
        .1
        .err()
        .map(|e| format!("{:?}", miette::Report::new(e)));
    assert!(columns.is_none(), "{columns:?}");
    for key in [
        "status = \"completed\"",
        "energy = 0.1",
        "cracks = true",
        "drawing = true",
    ] {
        let text = good.replace(point, &format!("{point}\n{key}"));
        let error = block(&text).1.unwrap_err();
        let name = key.split(' ').next().unwrap();
        let said = format!("{:?}", miette::Report::new(error));
        assert!(said.contains(&format!("does not read `{name}`")), "{said}");
    }
}

#[test]
fn invalid_cases_are_reported_with_their_place() {
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
        // Names that would overwrite other files.
        (
            "name = \"curve\"",
            "name = \"block_scene\"",
            "another picture",
        ),
        ("name = \"block\"", "name = \"case\"", "case.toml"),
        (
            "[[charts]]",
            "[[runs]]\nname = \"block_deck\"\ndeck = \"other.toml\"\n[[charts]]",
            "block_deck.toml: give the run another name",
        ),
        (
            "y = { column = \"load_kN\", label = \"load [kN]\" }",
            "y = { column = \"load_kN\", label = \"load [kN]\" }\n[[charts.references]]\nname = \"test\"\n\
             file = \"block.csv\"\nx = \"a\"\ny = \"b\"",
            "block.csv: give the run another name",
        ),
        // Keys that this kind of run or chart does not read.
        (
            "x = { column = \"time\",",
            "at = { block = 1 }\nx = { column = \"time\",",
            "`y.expect` and `at`",
        ),
        (
            "y = { column = \"load_kN\",",
            "at = { block = 1 }\ny = { expect = \"peak\",",
            "does not read `x.column`",
        ),
        (
            "x = { column = \"time\",",
            "x = { column = \"time\", expect = \"peak\",",
            "does not read `x.expect`",
        ),
    ] {
        assert!(CASE.contains(from), "{from}");
        let (_folder, case) = block(&CASE.replacen(from, to, 1));
        let error = case.unwrap_err();
        let text = format!("{:?}", miette::Report::new(error));
        assert!(text.contains(said), "{said}: {text}");
    }
}
