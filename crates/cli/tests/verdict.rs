//! The verdict on a run: in its last line, in its summary, and in all commands that read the run.

mod common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::*;

/// Runs a deck with this text into a folder beside it.
fn run_text(folder: &Path, text: &str, more: &[&str]) -> (Output, PathBuf) {
    let deck = folder.join("model.toml");
    std::fs::write(&deck, text).unwrap();
    run(folder, &deck, more)
}

fn run(folder: &Path, deck: &Path, more: &[&str]) -> (Output, PathBuf) {
    let out = folder.join("model.out");
    let (deck, to) = (deck.display().to_string(), out.display().to_string());
    let output = wythe(&[&["run", &deck, "--out", &to, "--threads", "1"][..], more].concat());
    (output, out)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn summary(out: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(out.join("summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn last_line(output: &Output) -> String {
    said(output).lines().last().unwrap_or_default().to_owned()
}

fn info(out: &Path) -> String {
    said(&wythe(&["info", &out.display().to_string()]))
}

/// An arch of rigid voussoirs without its keystone has no equilibrium under any part of its weight.
#[test]
fn an_arch_without_its_crown_collapses_and_the_run_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let deck = repository("tests/data/scenes/arch_without_crown.toml");
    let (output, out) = run(folder.path(), &deck, &[]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let summary = summary(&out);
    assert_eq!(summary["status"], "collapsed");
    assert_eq!(summary["verdict_kind"], "collapsed");
    let verdict = summary["verdict"].as_str().unwrap();
    for part in [
        "collapsed at load factor",
        "step 0 (gravity)",
        "r0v6",
        "r0v8",
        "fell by",
        "kinetic energy",
    ] {
        assert!(verdict.contains(part), "{part}: {verdict}");
    }
    // The run ends when a voussoir has fallen by its thickness of 200 mm, not at the end of the step 4.9 m below.
    let bodies = summary["fall"]["bodies"].as_array().unwrap();
    let most = bodies[0]["moved_mm"].as_f64().unwrap();
    assert!((200.0..300.0).contains(&most), "{most}");
    // The arch is symmetric, so the voussoirs on both sides fall alike.
    assert!(bodies.len().is_multiple_of(2), "{bodies:?}");
    assert_eq!(last_line(&output), verdict);
    assert!(info(&out).contains(verdict), "{}", info(&out));
    // The run is complete.
    let again = wythe(&["resume", &out.display().to_string()]);
    assert_eq!(code(&again), 0, "{}", stderr(&again));
    assert!(said(&again).contains("nothing to do"), "{}", said(&again));
    let report = wythe(&["report", &out.display().to_string()]);
    assert_eq!(code(&report), 0, "{}", stderr(&report));
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("collapsed at load factor"));
}

/// A block on a tilting table slides without end above tan⁻¹ 0.5 = 26.6° of 40°.
#[test]
fn a_block_that_slides_off_collapses_at_the_load_factor_at_which_it_began() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"
format = 1
[materials.stone]
E = 1000
nu = 0.2
density = "2000 kg/m^3"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.5
mu = 0.5
normal_stiffness = 100
shear_stiffness = 100
[[blocks]]
name = "table"
size = [2000, 100, 50]
material = "stone"
[[blocks]]
name = "stone"
size = [100, 100, 50]
at = [1900, 0, 50]
material = "stone"
[[contacts]]
slave = "stone.bottom"
master = "table.top"
interface = "dry"
[[supports]]
on = "table"
[[steps]]
kind = "gravity"
[[steps]]
kind = "tilt"
angle = 40
axis = "y"
"#;
    let (output, out) = run_text(folder.path(), text, &[]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let summary = summary(&out);
    assert_eq!(summary["status"], "collapsed", "{summary}");
    let factor = summary["fall"]["load_factor"].as_f64().unwrap();
    let exact = 0.5_f64.atan().to_degrees() / 40.0;
    // The increments are a hundredth of the step, or less after cut-backs.
    assert!((factor - exact).abs() < 0.011, "{factor}, {exact}");
    assert_eq!(summary["fall"]["step"], 1);
    assert_eq!(summary["fall"]["bodies"][0]["name"], "stone");
}

const PULLED: &str = r#"
format = 1
[materials.stone]
E = 1000
nu = 0
[[blocks]]
name = "bar"
size = [100, 10, 10]
material = "stone"
[[supports]]
on = "bar.left"
[[steps]]
kind = "drive"
face = "bar.right"
direction = "x"
displacement = 0.1
free = ["y", "z"]
"#;

/// An elastic bar has no peak: no text calls its last force a peak, in either direction of the drive. 1 GPa · 100
/// mm² · 10⁻³ = 0.1 kN.
#[test]
fn what_still_rises_has_no_peak_and_drives_are_counted_along_their_way() {
    let mut rows = Vec::new();
    for direction in ["x", "-x"] {
        let folder = tempfile::tempdir().unwrap();
        let text = PULLED.replace("\"x\"\n", &format!("\"{direction}\"\n"));
        let (output, out) = run_text(folder.path(), &text, &["--progress", "plain"]);
        assert_eq!(code(&output), 0, "{}", stderr(&output));
        let summary = summary(&out);
        assert_eq!(summary["verdict_kind"], "still_rising", "{summary}");
        let (force, way) = (
            &summary["peak_force_kN"],
            &summary["displacement_at_peak_mm"],
        );
        // Strains of 1e-3 in a corotational frame.
        assert!((force.as_f64().unwrap() - 0.1).abs() < 2e-4, "{force}");
        assert!((way.as_f64().unwrap() - 0.1).abs() < 1e-9, "{way}");
        assert!(last_line(&output).starts_with("still rising at the end: 0.1"));
        let picture = std::fs::read_to_string(out.join("load_displacement.svg")).unwrap();
        let report = wythe(&["report", &out.display().to_string()]);
        assert_eq!(code(&report), 0, "{}", stderr(&report));
        let told = [said(&output), info(&out), picture];
        for told in told {
            assert!(
                !told.contains("peak ") || told.contains("no peak yet"),
                "{told}"
            );
            assert!(!told.contains("peak 0"), "{told}");
        }
        let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
        rows.push((
            column(&history, "displacement_mm"),
            column(&history, "force_kN"),
        ));
        for value in rows
            .last()
            .map(|(d, f)| [d, f])
            .into_iter()
            .flatten()
            .flatten()
        {
            assert!(*value > 0.0, "{direction}: {value}");
        }
    }
    assert_eq!(rows[0].0.len(), rows[1].0.len());
}

/// A step that reverses the drive of an earlier one is counted along the first.
#[test]
fn a_step_back_is_counted_along_the_first_drive() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = PULLED.replace("\"x\"\n", "\"-x\"\n");
    text += &PULLED[PULLED.find("[[steps]]").unwrap()..];
    text += "stop = { displacement = 0.05 }\n";
    let (output, out) = run_text(folder.path(), &text, &[]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let moved = column(&history, "displacement_mm");
    let most = moved.iter().copied().fold(0.0, f64::max);
    assert!((most - 0.1).abs() < 1e-9, "{moved:?}");
    // 0.1 mm forward and 0.05 mm back, in increments of 0.0125 of 0.1 mm.
    let end = moved.last().unwrap();
    assert!((0.0487..0.0501).contains(end), "{end}");
}

/// One quarter of a couplet is solved; forces in messages are those of the whole, as in the history.
#[test]
fn messages_speak_of_the_whole_scene() {
    let folder = tempfile::tempdir().unwrap();
    let deck = repository("examples/01_couplet_tension.toml");
    let set = [
        "--set",
        "steps.1.displacement=0.014",
        "--set",
        "steps.1.stop={ below_peak = 0.8 }",
    ];
    let (output, out) = run(folder.path(), &deck, &set);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let summary = summary(&out);
    assert!(!summary["mirror_planes"].as_array().unwrap().is_empty());
    let log = summary["log"].to_string();
    let told = log.split("of its peak of ").nth(1).unwrap();
    let told: f64 = told.split(' ').next().unwrap().parse().unwrap();
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let (steps, forces) = (column(&history, "step"), column(&history, "force_kN"));
    let second = steps.iter().zip(&forces).filter(|p| *p.0 == 1.0);
    let most = second.map(|p| *p.1).fold(0.0, f64::max);
    // The message is rounded to a newton.
    assert!((told - most).abs() <= 5.1e-4, "{told}, {most}");
    assert_eq!(summary["verdict_kind"], "peak_passed");
    assert!(log.contains("at load factor 0."), "{log}");
}

/// A run, the commands that read it and its comparison with a test give the same figures by the same definitions.
#[test]
fn figures_are_the_same_wherever_they_are_read() {
    let folder = tempfile::tempdir().unwrap();
    // A preload along the drive moves the driven face but is not part of the curve.
    let text = PULLED.replace(
        "[[steps]]",
        "[[steps]]\nkind = \"preload\"\nface = \"bar.right\"\npressure = 0.2\nfree = [\"x\", \"y\", \"z\"]\n\n[[steps]]",
    );
    let (output, out) = run_text(folder.path(), &text, &[]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let summary = summary(&out);
    let stiffness = summary["initial_stiffness_kN_per_mm"].as_f64().unwrap();
    assert!(said(&output).contains(&format!("initial stiffness {stiffness:.2} kN/mm")));
    assert!(
        info(&out).contains(&format!("initial stiffness {stiffness:.2} kN/mm")),
        "{}",
        info(&out)
    );
    let test = folder.path().join("test.csv");
    std::fs::write(
        &test,
        "displacement_mm,force_kN\n0,0\n0.05,0.04\n0.1,0.09\n",
    )
    .unwrap();
    let (run, test) = (out.display().to_string(), test.display().to_string());
    let compared = wythe(&["compare", &run, &test, "--json"]);
    assert_eq!(code(&compared), 0, "{}", stderr(&compared));
    let compared: serde_json::Value = serde_json::from_str(&said(&compared)).unwrap();
    for key in [
        "peak_force_kN",
        "displacement_at_peak_mm",
        "initial_stiffness_kN_per_mm",
    ] {
        assert_eq!(compared["run"][key], summary[key], "{key}");
    }
}

/// A wall that carries its load stands, and the run reports its largest displacement.
#[test]
fn what_carries_its_loads_stands() {
    let folder = tempfile::tempdir().unwrap();
    let steps = PULLED.find("[[steps]]").unwrap();
    let text = format!(
        "{}[[steps]]\nkind = \"preload\"\nface = \"bar.right\"\npressure = 1\nfree = [\"x\", \"y\", \"z\"]\n",
        &PULLED[..steps]
    );
    let (output, out) = run_text(folder.path(), &text, &[]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let verdict = summary(&out)["verdict"].as_str().unwrap().to_owned();
    // σ L/E = 0.1 mm.
    assert!(
        verdict.starts_with("stands: moved by at most 0.100"),
        "{verdict}"
    );
    assert!(verdict.ends_with("(bar)"), "{verdict}");
}

/// A block falls by g t²/2 = 12.2625 mm in 0.05 s, whatever its stiffness, or the run rejects it and names the
/// material and its E.
#[test]
fn stiff_blocks_fall_or_are_refused() {
    let deck = repository("tests/data/bad/stiff_block.toml");
    for (stiffness, falls) in [
        ("5e3", true),
        ("5e8", true),
        ("5e9", true),
        ("3e10", false),
        ("5e12", false),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let set = format!("materials.stone.E={stiffness}");
        let (output, out) = run(folder.path(), &deck, &["--set", &set]);
        if falls {
            assert_eq!(code(&output), 0, "{stiffness}: {}", stderr(&output));
            let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
            let fallen = -column(&history, "z_mm").last().unwrap();
            // A hundred increments, the first by backward Euler: half an increment more.
            assert!(
                (fallen - 12.2625).abs() < 0.01 * 12.2625,
                "{stiffness}: {fallen}"
            );
        } else {
            assert_eq!(code(&output), 2, "{stiffness}");
            let told = stderr(&output);
            assert!(
                told.contains("materials.stone.E") && told.contains("of stone"),
                "{told}"
            );
        }
    }
}
