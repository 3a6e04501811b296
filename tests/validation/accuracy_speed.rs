//! The scenes of docs/accuracy-speed with their short forms: the default settings are as accurate as documented, and
//! errors in a scene are reported with their place.

use std::path::{Path, PathBuf};
use std::time::Duration;

use wythe_cli::study::StudyError;
use wythe_cli::study::accuracy::{
    Group, Options, Origin, Outcome, Scene, Studied, advice, chart, front, page, read, renew,
    scenes, study, table,
};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/accuracy-speed")
}

fn options(short: bool, repeats: usize) -> Options {
    Options {
        short,
        // All runs are far below this limit; it stops a run that hangs.
        limit: Duration::from_secs(300),
        jobs: std::thread::available_parallelism().map_or(1, usize::from),
        repeats,
    }
}

fn run(scenes: &[Scene], options: &Options) -> Vec<Studied> {
    let progress = |scene: &Scene, outcome: &Outcome, _: usize| {
        let (name, errors) = (&outcome.choice.name, &outcome.errors);
        println!(
            "{}, {name}: {errors:?}, {:.2} s",
            scene.name(),
            outcome.cpu_seconds()
        );
    };
    study(scenes, options, &progress, &|| false)
}

#[test]
fn the_default_has_peak_and_energy_of_the_reference_and_a_coarse_step_is_not_better() {
    let scenes = scenes(&folder()).unwrap();
    let all = run(&scenes, &options(true, 1));
    assert_eq!(all.len(), 2, "couplet and small wall have short forms");
    for studied in &all {
        let name = studied.scene.name();
        let default = studied.default().unwrap();
        let errors = default
            .errors
            .clone()
            .unwrap_or_else(|why| panic!("{name}: {why}"));
        // The documented accuracy of the default settings: −0.2 % of the couplet's peak, +0.96 % of the small wall's, and
        // +0.07 and +1.2 % of their energies. With the cube root of the volume as crack band the small wall lost 8 % of
        // the energy.
        assert!(errors.peak.abs() < 0.01, "{name}: {errors:?}");
        assert!(errors.energy.abs() < 0.02, "{name}: {errors:?}");
        let lost: Vec<_> = studied
            .outcomes
            .iter()
            .filter(|o| o.errors.is_err())
            .collect();
        assert!(lost.is_empty(), "{name}: {lost:?}");
        let points = studied.points();
        assert!(!front(&points, studied.scene.reference.uncertainty).is_empty());
        assert!(points.iter().all(|p| p.0 > 0.0 && p.1.is_finite()));
        let svg = chart(studied).unwrap().unwrap();
        for outcome in &studied.outcomes {
            assert!(
                svg.contains(&format!("\n{}\n", outcome.choice.name)),
                "{name}: {}",
                outcome.choice.name
            );
        }
        assert_eq!(table(studied).lines().count(), studied.outcomes.len() + 2);
    }
    // The couplet's reference is a closed form without cracks; that of the small wall is a run.
    for outcome in &all[0].outcomes {
        assert_eq!(outcome.cracks, None, "{}", outcome.choice.name);
    }
    let cracks = |name: &str| {
        let mut of = all[1].outcomes.iter();
        of.find(|o| o.choice.name == name).unwrap().cracks.unwrap()
    };
    // Other increments give the same cracks except for single cells (0.99 and 0.99). Solids that cannot crack lack
    // their part (0.87), and the joints of a unit with four by two elements fail elsewhere (0.81).
    assert!((cracks("steps x 2") - cracks("default")).abs() < 0.1);
    assert!(cracks("default") > 0.9 && cracks("default") <= 1.0);
    for name in ["elastic", "mesh 4x2x2"] {
        let overlap = cracks(name);
        assert!((0.5..0.9).contains(&overlap), "{name}: {overlap}");
    }
    // Increments four times as large also find a peak that exists from the start. Under inertia no increment is
    // repeated for a peak, so that part of it is lost; the study shows this.
    let of = |name: &str| {
        all[0]
            .outcomes
            .iter()
            .find(|o| o.choice.name == name)
            .unwrap()
    };
    let peak = |name: &str| of(name).errors.clone().unwrap().peak.abs();
    assert!(peak("steps x 4") <= peak("default"));
    assert!(peak("quasi-static") > 2.0 * peak("default"));
}

#[test]
fn the_page_has_a_section_for_each_scene_with_its_chart_and_its_table() {
    let text = std::fs::read_to_string(folder().join("../accuracy-speed.md")).unwrap();
    let said = advice(&folder()).unwrap();
    assert!(!said.trim().is_empty() && text.contains(said.trim()));
    for scene in scenes(&folder()).unwrap() {
        let again = format!("run `wythe study accuracy-speed --only {}`", scene.number);
        assert!(
            text.contains(&format!("\n## {}\n", scene.name())),
            "{again}"
        );
        for said in [&scene.what, &scene.says, &scene.reference.how] {
            assert!(text.contains(said.trim()), "{}: {again}", scene.name());
        }
        for choice in &scene.choices {
            assert!(
                text.contains(&format!("\n| {} | ", choice.name)),
                "{}: {again}",
                choice.name
            );
        }
        let svg = std::fs::read_to_string(scene.folder.join("chart.svg")).unwrap();
        for peer in &scene.peers {
            assert!(
                text.contains(&format!("\n| {} | peer | ", peer.name)),
                "{again}"
            );
            assert!(text.contains(peer.differs.trim()), "{}: {again}", peer.name);
            assert!(svg.contains(&format!("\n{}\n", peer.name)), "{again}");
        }
        for name in ["chart.svg", "table.csv"] {
            assert!(scene.folder.join(name).is_file(), "{name}: {again}");
        }
    }
}

const SCENE: &str = r#"
number = 7
title = "A block"
what = "It is pulled."
deck = "deck.toml"
x = "displacement_mm"
y = "force_kN"
to = 0.1
[reference]
file = "reference.csv"
how = "Hooke."
uncertainty = 0.001
command = "by hand"
[[choices]]
name = "default"
group = "default"
[[choices]]
name = "half"
group = "several"
set = ["blocks.0.size.1=50"]
factor = 2
"#;

/// A bar of 100 mm with free sides: 10 kN at 0.1 mm.
const DECK: &str = r#"
format = 1
[materials.stone]
E = "1000 MPa"
nu = 0.0
[[blocks]]
name = "block"
size = ["100 mm", "100 mm", "100 mm"]
material = "stone"
mesh = [1, 2, 1]
[[supports]]
on = "block.bottom"
[[steps]]
kind = "drive"
face = "block.top"
direction = "z"
displacement = "0.1 mm"
"#;

/// The scene of this text in a folder with its deck and its reference.
fn scene(text: &str) -> (tempfile::TempDir, Result<Scene, StudyError>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("deck.toml"), DECK).unwrap();
    let reference = "displacement_mm,force_kN\n0,0\n0.1,10\n";
    std::fs::write(folder.path().join("reference.csv"), reference).unwrap();
    for (name, end) in [("peer.csv", "0.1,12,3"), ("early.csv", "0.06,7,2")] {
        let rows = format!("displacement_mm,force_kN,cpu_s\n0,0,1\n0.05,5,1.5\n{end}\n");
        std::fs::write(folder.path().join(name), rows).unwrap();
    }
    let scene = Scene::from_str(text, "scene.toml", folder.path());
    (folder, scene)
}

/// The error message with its advice.
fn why(text: &str) -> String {
    let (_folder, scene) = scene(text);
    let error = scene.expect_err(text);
    format!("{:?}", miette::Report::new(error))
}

#[test]
fn errors_in_a_scene_are_reported_with_their_place() {
    let changed = |from: &str, to: &str| {
        assert!(SCENE.contains(from), "{from}");
        why(&SCENE.replacen(from, to, 1))
    };
    for (from, to, said) in [
        ("\"force_kN\"", "\"force\"", "no column `force`"),
        ("to = 0.1", "to = 0.2", "from 0 to 0.1"),
        ("to = 0.1", "to = 0.1\nsteps = [1]", "no step 1"),
        ("to = 0.1", "to = -1", "beyond `from`"),
        (
            "to = 0.1",
            "to = 0.1\nshort_to = 0.3",
            "between `from` and `to`",
        ),
        (
            "group = \"default\"",
            "group = \"penalty\"",
            "none of the choices is the default",
        ),
        (
            "group = \"several\"",
            "group = \"default\"",
            "two choices are the default",
        ),
        (
            "group = \"several\"",
            "group = \"colour\"",
            "known here: default, element",
        ),
        (
            "name = \"half\"",
            "name = \"default\"",
            "two choices have this name",
        ),
        ("name = \"half\"", "name = \"a,b\"", "no comma"),
        ("factor = 2", "factor = 0", "above 0"),
        ("factor = 2", "threads = 0", "1 or more"),
        ("factor = 2", "short = 3", "boolean"),
        (
            "blocks.0.size.1",
            "blocks.0.sizes",
            "the deck of `half` is wrong",
        ),
        (
            "uncertainty = 0.001",
            "uncertainty = 0",
            "no number is exact",
        ),
        ("command = \"by hand\"", "", "its `set` or its `command`"),
        (
            "command = \"by hand\"",
            "command = \"by hand\"\nset = []",
            "a reference says its `set`",
        ),
        ("\"reference.csv\"", "\"other.csv\"", "other.csv"),
    ] {
        let why = changed(from, to);
        assert!(why.contains(said), "{to}: {why}");
    }
    let peer = with_peer();
    for (from, to, said) in [
        (
            "name = \"Other\"",
            "name = \"half\"",
            "choices or peers have this name",
        ),
        (
            "name = \"Other\"",
            "name = \"a|b\"",
            "no comma, quote or bar",
        ),
        ("default_cpu = 2", "default_cpu = 0", "above 0"),
        ("default_cpu = 2", "", "default_cpu"),
        (
            "default_cpu = 2",
            "default_cpu = 2\ncpu = \"s\"",
            "no column `s`",
        ),
        ("to = 0.1", "to = 0.09\nshort_to = 0.05", ""),
        ("peer.csv", "early.csv", "does not come to 0.1"),
    ] {
        assert!(peer.contains(from), "{from}");
        let text = peer.replacen(from, to, 1);
        let (_folder, scene) = scene(&text);
        let told = scene.map_or_else(
            |e| format!("{:?}", miette::Report::new(e)),
            |_| String::new(),
        );
        assert!(
            told.contains(said) && told.is_empty() == said.is_empty(),
            "{to}: {told}"
        );
    }
    let in_deck = changed("set = [\"blo", "set = [\"E\", \"blo");
    assert!(in_deck.contains("not KEY=VALUE"), "{in_deck}");
}

#[test]
fn a_bar_by_hooke_has_no_error_whole_or_half() {
    let (folder, scene) = scene(SCENE);
    let all = run(&[scene.unwrap()], &options(false, 3));
    let studied = &all[0];
    assert_eq!(studied.outcomes.len(), 2);
    for outcome in &studied.outcomes {
        let errors = outcome.errors.clone().unwrap();
        // Corotation at 0.1 % strain, and the equilibrium tolerance.
        assert!(
            errors.of_chart() < 2e-3,
            "{}: {errors:?}",
            outcome.choice.name
        );
        assert_eq!((outcome.cpu.len(), outcome.wall.len()), (3, 3));
    }
    assert_eq!(studied.ratios()[0], [1.0, 1.0]);

    // Writing the page for some scenes keeps the sections of the others.
    let before = "# Accuracy against speed\n\n## 2 Another\n\nOf it.\n\n## 7 Old\n\nOld.\n";
    let page = page(&all, "Do this.", "scenes", before);
    let place = |text: &str| page.find(text).unwrap_or_else(|| panic!("{text}: {page}"));
    assert!(place("Do this.") < place("## 2 Another\n\nOf it.\n\n## 7 A block"));
    assert!(!page.contains("Old."));
    for said in [
        "medians of 3",
        "| default |  | ",
        "forces times 2",
        "within 1 % of the reference",
    ] {
        place(said);
    }
    // Reading the table gives the same page.
    let file = folder.path().join("table.csv");
    std::fs::write(&file, table(studied)).unwrap();
    let again = read(&studied.scene, &file).unwrap();
    // Times and their ratios are stored with few digits, so that they are rounded only once.
    std::fs::write(&file, table(&again)).unwrap();
    assert_eq!(table(&read(&studied.scene, &file).unwrap()), table(&again));
    for (one, other) in again.outcomes.iter().zip(&studied.outcomes) {
        assert_eq!(
            (&one.choice, one.cost.iterations),
            (&other.choice, other.cost.iterations)
        );
        assert!((one.cpu_seconds() - other.cpu_seconds()).abs() < 1e-4);
    }
    std::fs::write(&file, table(studied).replace("rms", "rsm")).unwrap();
    let why = read(&studied.scene, &file).unwrap_err().to_string();
    assert!(why.contains("no column `rms`"), "{why}");
}

/// A bar that is compressed before it is pulled. Only the requested steps count, from their start.
#[test]
fn rows_of_other_steps_are_left_out() {
    let pressed = DECK
        .split_once("[[steps]]")
        .unwrap()
        .1
        .replace("0.1", "-0.05");
    let deck = DECK.replacen("[[steps]]", &format!("[[steps]]{pressed}[[steps]]"), 1);
    for (steps, there) in [("", false), ("steps = [1]\n", true)] {
        let (folder, scene) = scene(SCENE);
        scene.unwrap();
        std::fs::write(folder.path().join("deck.toml"), &deck).unwrap();
        // The first step compresses: the columns follow its direction.
        let text = SCENE
            .replace("to = 0.1\n", &format!("to = 0.05\n{steps}"))
            .replace("= \"displacement_mm\"", "= \"-displacement_mm\"")
            .replace("= \"force_kN\"", "= \"-force_kN\"");
        let scene = Scene::from_str(&text, "scene.toml", folder.path()).unwrap();
        for outcome in &run(&[scene], &options(false, 1))[0].outcomes {
            match &outcome.errors {
                // As without that step.
                Ok(errors) => assert!(there && errors.of_chart() < 2e-3, "{errors:?}"),
                Err(why) => assert!(!there && why.contains("turns back"), "{why}"),
            }
        }
    }
}

/// The scene with results of another program.
fn with_peer() -> String {
    let peer = "[[peers]]\nname = \"Other\"\ndiffers = \"All of it.\"\nfile = \"peer.csv\"\ndefault_cpu = 2\n";
    [SCENE, peer].concat()
}

#[test]
fn another_program_is_shown_in_chart_and_tables_but_not_run() {
    let (folder, scene) = scene(&with_peer());
    let scene = scene.unwrap();
    let all = run(std::slice::from_ref(&scene), &options(false, 1));
    let studied = &all[0];
    assert_eq!(studied.outcomes.len(), 2);
    let peers = studied.peers();
    let (peer, errors) = (peers[0].0, peers[0].1.clone().unwrap());
    assert_eq!((peer.ratio(), peer.peak()), (1.5, 12.0));
    // Tolerance: rounding; for the area, trapezoids across the corner of the curve.
    assert!((errors.peak - 0.2).abs() < 1e-12, "{errors:?}");
    assert!((errors.energy - 0.1).abs() < 1e-6, "{errors:?}");
    let text = page(&all, "", "scenes", "");
    for said in [
        "\n| Other | peer | +20 % | +10 % | ",
        " | | 1.50 | 3.00 | | | | |\n",
        "*Other*, measured separately, where the default took 2.00 s of CPU. All of it.",
    ] {
        assert!(text.contains(said), "{said}: {text}");
    }
    assert!(chart(studied).unwrap().unwrap().contains("\nOther\n"));
    let csv = table(studied);
    assert!(csv.contains("\nOther,peer,12.000000,0.200000,"), "{csv}");
    // The peer's values come from the scene, not from the table.
    let file = folder.path().join("table.csv");
    std::fs::write(&file, csv).unwrap();
    assert_eq!(read(&scene, &file).unwrap().outcomes.len(), 2);
    // An older table has no cracks.
    let old = "# sitting\nchoice,group,peak,peak_error,energy_error,rms,cpu_s,cpu_ratio,wall_s,wall_ratio,threads,\
               increments,solves,cuts,energy_imbalance,why\nhalf,several,1,0,0,0,1,1,1,1,1,1,1,1,0,\n";
    std::fs::write(&file, old).unwrap();
    let old = read(&scene, &file).unwrap();
    assert_eq!((old.outcomes.len(), old.outcomes[0].cracks), (1, None));
    let short = study(&[scene], &options(true, 1), &|_, _, _| {}, &|| false);
    assert!(short[0].peers().is_empty());
}

#[test]
fn a_reference_is_made_by_its_documented_run() {
    let text = SCENE.replace(
        "command = \"by hand\"",
        "set = [\"steps.0.increments.max=0.1\"]",
    );
    let text = text.replace("\"reference.csv\"", "\"made.csv\"");
    let (folder, scene) = scene(&text);
    let scene = scene.unwrap();
    assert!(!scene.reference.there() && matches!(scene.reference.origin, Origin::Run(_)));
    let made = renew(&scene, Duration::from_secs(60), &|| false)
        .unwrap()
        .unwrap();
    // The scene is given with its folder, because it does not belong to the project.
    let scenes = scene.folder.parent().unwrap().display();
    let command = format!("# wythe study accuracy-speed --scenes {scenes} --only 7 --references\n");
    assert!(made.curve.starts_with(&command), "{made:?}");
    std::fs::write(&scene.reference.file, made.curve).unwrap();
    // Neither this run nor the choices have cracks.
    let pattern = made.pattern.unwrap();
    assert!(
        pattern.starts_with("10 0 0 mm") && !pattern.contains('#'),
        "{pattern}"
    );
    assert_eq!(pattern.lines().count(), 11, "{pattern}");
    std::fs::write(folder.path().join("pattern.txt"), pattern).unwrap();
    let scene = Scene::from_str(&text, "scene.toml", folder.path()).unwrap();
    assert!((scene.known(false).unwrap().peak() / 10.0 - 1.0).abs() < 2e-3);
    let all = run(std::slice::from_ref(&scene), &options(false, 1));
    assert!(all[0].outcomes.iter().all(|o| o.cracks == Some(1.0)));
    std::fs::write(folder.path().join("pattern.txt"), "10 0 0 mm\nxx\n").unwrap();
    let wrong = Scene::from_str(&text, "scene.toml", folder.path()).unwrap_err();
    assert!(format!("{:?}", miette::Report::new(wrong)).contains("line 2"));
    let default = scene.choices.iter().filter(|c| c.group == Group::Default);
    assert_eq!(default.count(), 1);
}
