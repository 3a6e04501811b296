//! The command `wythe study accuracy-speed`: its output, its files and its exit codes.

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
    // A study of one scene leaves the sections of the others unchanged.
    std::fs::write(&page, text.replace("It is torn.", "It was torn.")).unwrap();
    let part = accuracy(folder.path(), &["--only", "2"]);
    assert_eq!(code(&part), 0, "{}", stderr(&part));
    let text = std::fs::read_to_string(&page).unwrap();
    assert_eq!(text.matches("It was torn.").count(), 1, "{text}");
    assert_eq!(text.matches("It is torn.").count(), 1, "{text}");
    // The page is written from the tables without runs. Measured rows remain; rows of removed peers disappear.
    let table = scenes(folder.path()).join("1/table.csv");
    let measured = std::fs::read_to_string(&table).unwrap();
    let gone = "gone,peer,1,1,1,1,NaN,1,1,NaN,NaN,1,NaN,NaN,NaN,NaN,\n";
    std::fs::write(&table, format!("{measured}{gone}")).unwrap();
    let redrawn = accuracy(folder.path(), &["--redraw"]);
    assert_eq!(code(&redrawn), 0, "{}", stderr(&redrawn));
    let text = std::fs::read_to_string(&page).unwrap();
    assert_eq!(text.matches("It is torn.").count(), 2, "{text}");
    assert_eq!(std::fs::read_to_string(&table).unwrap(), measured);
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

/// A wall pushed in the opposite direction has the same curve, counted along its drive, and the same cracks.
#[test]
fn a_drive_along_minus_x_has_the_curve_of_one_along_x() {
    let folder = folder(&["1", "2"]);
    let sheared = repository("examples/02_couplet_shear.toml");
    let file = |number: &str| scenes(folder.path()).join(number).join("scene.toml");
    let forth = SCENE
        .replace("DECK", &sheared.display().to_string())
        .replace("steps.1.displacement=0.01", "steps.1.displacement=0.3")
        .replace("to = 0.016", "to = 0.3");
    let back = forth.replace(
        "set = [\"steps.1.disp",
        "set = [\"steps.1.direction=-x\", \"steps.1.disp",
    );
    for (number, text) in [("1", forth), ("2", back)] {
        std::fs::write(file(number), text.replace("NUMBER", number)).unwrap();
    }
    let made = accuracy(folder.path(), &["--references"]);
    assert_eq!(code(&made), 0, "{}", stderr(&made));
    let column = |number: &str, name: &str| {
        let csv = file(number).with_file_name("reference.csv");
        column(&std::fs::read_to_string(csv).unwrap(), name)
    };
    for name in ["displacement_mm", "force_kN"] {
        let [forth, back] = ["1", "2"].map(|number| column(number, name));
        let largest = forth.iter().copied().fold(0.0, f64::max);
        assert!(largest > 0.1 && forth.len() == back.len());
        for (a, b) in forth.iter().zip(back) {
            // The iterates are mirrored; the differences are due to rounding.
            assert!((a - b).abs() < 1e-6 * largest, "{name}: {a} {b}");
        }
    }
    let all = accuracy(folder.path(), &[]);
    assert_eq!(code(&all), 0, "{}", stderr(&all));
    let told = stderr(&all);
    let errors = |number: &str| {
        let (_, own) = told
            .split_once(&format!("{number} Torn couplet, default (1): "))
            .unwrap();
        own.split_once(';').unwrap().0.to_owned()
    };
    assert_eq!(errors("1"), errors("2"));
    assert!(errors("2").ends_with("cracks 100 %"), "{told}");
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

#[test]
#[expect(
    clippy::too_many_lines,
    reason = "one study, from its draft to its pages"
)]
fn a_model_of_ones_own_is_drafted_and_run() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("torn.toml");
    std::fs::copy(couplet(), &model).unwrap();
    let model = model.display().to_string();
    let own = |more: &[&str]| wythe(&[&["study", "accuracy-speed", &model], more].concat());
    // A tenth of the displacement in few increments suffices to check that all parts exist.
    let first = own(&[
        "--set",
        "steps.1.displacement=0.01",
        "--set",
        "steps.1.increments={initial=0.1,max=0.1}",
    ]);
    assert_eq!(code(&first), 0, "{}", stderr(&first));
    let out = folder.path().join("torn.accuracy");
    let page = std::fs::read_to_string(out.join("accuracy-speed.md")).unwrap();
    for said in [
        "| mesh finer |",
        "| steps / 2 |",
        "| penalty 500 |",
        "(scenes/torn/chart.svg)",
        "Its own error: `mesh finer`, which lacks only what `steps / 2` has, is ",
        "; `steps / 2`, which lacks only what `mesh finer` has, is ",
    ] {
        assert!(page.contains(said), "{said}: {page}");
    }
    // The printed command must find the scene.
    let scenes = out.join("scenes").display().to_string();
    let command = format!("`wythe study accuracy-speed --scenes {scenes} --only 1 --references`");
    assert!(page.contains(&command), "{command}: {page}");
    for name in ["chart.svg", "table.csv", "reference.csv", "pattern.txt"] {
        assert!(out.join("scenes/torn").join(name).is_file(), "{name}");
    }
    // From then on the scene belongs to the user and is not overwritten.
    let scene = out.join("scenes/torn/scene.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    let start = text.find("[[choices]]").unwrap();
    let end = start + text[start + 1..].find("[[choices]]").unwrap();
    let text = text[..=end].replace("title = \"", "title = \"My ");
    std::fs::write(&scene, text).unwrap();
    let second = own(&[]);
    assert_eq!(code(&second), 0, "{}", stderr(&second));
    let told = stdout(&second);
    assert!(told.contains("1 of 1 choices"), "{told}");
    let page = std::fs::read_to_string(out.join("accuracy-speed.md")).unwrap();
    assert!(page.contains("## 1 My "), "{page}");

    for (more, said) in [
        (&["--set", "fidelity=full"][..], "taken as it stands"),
        (&["--short"], "cannot be used with"),
    ] {
        let run = own(more);
        assert_eq!(code(&run), 2, "{more:?}");
        assert!(stderr(&run).contains(said), "{more:?}: {}", stderr(&run));
    }
    // The self-weight has moved the probe before the load begins, so the comparison begins there.
    let strip = repository("examples/40_airbag.toml").display().to_string();
    let moved = folder.path().join("moved");
    let to = moved.display().to_string();
    let run = wythe(&["study", "accuracy-speed", &strip, "--out", &to]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let reference = moved.join("scenes/40_airbag/reference.csv");
    let text = std::fs::read_to_string(&reference).unwrap();
    assert!(column(&text, "middle_mm")[0] > 0.0, "{text}");

    let toppling = repository("examples/30_toppling_stack.toml");
    let toppling = toppling.display().to_string();
    let elsewhere = folder.path().join("elsewhere").display().to_string();
    let none = wythe(&["study", "accuracy-speed", &toppling, "--out", &elsewhere]);
    assert_eq!(code(&none), 2);
    assert!(
        stderr(&none).contains("scene.toml of your own"),
        "{}",
        stderr(&none)
    );
    assert!(!folder.path().join("elsewhere").exists());
}
