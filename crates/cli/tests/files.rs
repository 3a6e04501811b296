//! Output files are never written through a link or over an input.
#![cfg(unix)]

mod common;

use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::*;
use wythe_core::results::output::OF_A_RUN;

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// Names of all files of a run, and their temporary names.
fn names() -> Vec<String> {
    let names = OF_A_RUN.iter();
    names
        .flat_map(|name| ["", ".tmp", ".part"].map(|end| format!("{name}{end}")))
        .collect()
}

/// Symbolic and hard links have the names of all files of a run. Then the run continues while hard links to its
/// own files exist.
#[test]
fn a_run_writes_through_no_link() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("couplet.out");
    let name = out.display().to_string();
    for hard in [false, true] {
        std::fs::create_dir(&out).unwrap();
        for (i, name) in names().iter().enumerate() {
            let mine = folder.path().join(format!("mine{i}"));
            std::fs::write(&mine, "mine").unwrap();
            if hard {
                std::fs::hard_link(&mine, out.join(name)).unwrap();
            } else {
                symlink(&mine, out.join(name)).unwrap();
            }
        }
        let run = wythe(&["run", &couplet(), "--out", &name]);
        assert_eq!(code(&run), 0, "{}", stderr(&run));
        let report = wythe(&["report", &name]);
        assert_eq!(code(&report), 0, "{}", stderr(&report));
        for (i, name) in names().iter().enumerate() {
            let mine = folder.path().join(format!("mine{i}"));
            assert_eq!(text(&mine), "mine", "{name}");
        }
        // A copy of the folder by links, as snapshots make it, keeps its bytes when the run continues.
        let copy = folder.path().join("copy");
        std::fs::create_dir(&copy).unwrap();
        let mut before = Vec::new();
        for name in OF_A_RUN.iter().filter(|name| out.join(name).exists()) {
            std::fs::hard_link(out.join(name), copy.join(name)).unwrap();
            before.push((name, std::fs::read(out.join(name)).unwrap()));
        }
        let resumed = wythe(&["resume", &name, "--set", "steps.1.displacement=0.3125"]);
        assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
        for (name, bytes) in before {
            assert!(std::fs::read(copy.join(name)).unwrap() == bytes, "{name}");
        }
        std::fs::remove_dir_all(&out).unwrap();
        std::fs::remove_dir_all(&copy).unwrap();
    }
}

#[test]
fn what_commands_write_takes_the_place_of_links() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let typed = |name: &str| at(name).display().to_string();
    let run = wythe(&["run", &couplet(), "--out", &typed("a.out")]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    std::fs::write(at("mine"), "mine").unwrap();
    std::fs::write(
        at("path.csv"),
        "eps_xx,eps_yy,eps_zz,gam_xy,gam_yz,gam_zx\n1e-5,0,0,0,0,0\n",
    )
    .unwrap();
    for (name, command) in [
        ("page.html", "report a.out --out page.html"),
        ("plots/curves.svg", "plot a.out --out plots"),
        ("export/model.inp", "export a.out --to inp --out export"),
        (
            "export/series.pvd",
            "export a.out --to vtu --frame all --out export",
        ),
        ("scene.svg", "check COUPLET --picture scene.svg"),
        (
            "answer.csv",
            "drive material brick --model COUPLET --path path.csv --out answer.csv",
        ),
        ("wall.toml", "new wall --force"),
        ("deck.schema.json", "new wall --force"),
        ("man/wythe-run.1", "man --out man"),
        (
            "salvaged.mcap",
            "salvage a.out/run.mcap --out salvaged.mcap",
        ),
    ] {
        let path = at(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        for link in [path.clone(), at(&format!("{name}.tmp"))] {
            let _ = std::fs::remove_file(&link);
            symlink(at("mine"), link).unwrap();
        }
        let output = Command::new(env!("CARGO_BIN_EXE_wythe"))
            .args(command.split(' ').map(|word| match word {
                "COUPLET" => couplet(),
                word => word.to_owned(),
            }))
            .current_dir(folder.path())
            .output()
            .unwrap();
        assert_eq!(code(&output), 0, "{command}: {}", stderr(&output));
        assert_eq!(text(&at("mine")), "mine", "{command}");
        assert!(path.symlink_metadata().unwrap().is_file(), "{command}");
    }
    // A link to a missing file is not followed, even with `--force`.
    symlink(at("nowhere"), at("new.toml")).unwrap();
    let refused = wythe(&["new", &typed("new")]);
    assert_eq!(code(&refused), 4, "{}", stderr(&refused));
    assert!(!at("nowhere").exists());
}

#[test]
fn inputs_are_never_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let typed = |name: &str| at(name).display().to_string();
    std::fs::copy(couplet(), at("model.toml")).unwrap();
    let deck = text(&at("model.toml"));
    std::fs::write(at("curve.csv"), "displacement_mm,force_kN\n0,0\n1,1\n").unwrap();
    symlink(at("model.toml"), at("link.toml")).unwrap();
    std::fs::write(at("plain.toml"), &deck).unwrap();
    std::fs::write(at("history.csv"), "displacement_mm,force_kN\n0,0\n1,1\n").unwrap();
    let here = typed(".");
    let experiment = ["--set", "output.experiment=\"history.csv\""];
    let run = |model: &str, more: &[&str]| {
        wythe(&[&["run", &typed(model), "--out", &here], more].concat())
    };
    for (output, name) in [
        (run("model.toml", &[]), "model.toml"),
        (run("link.toml", &[]), "model.toml"),
        (run("plain.toml", &experiment), "history.csv"),
    ] {
        assert_eq!(code(&output), 4, "{}", stderr(&output));
        let said = stderr(&output).replace(' ', "");
        assert!(said.contains(&format!("{name}:aresult")), "{said}");
        assert!(!at(".lock").exists() && !at("summary.json").exists());
    }
    // Results with the names of their own inputs.
    std::fs::write(
        at("path.csv"),
        "eps_xx,eps_yy,eps_zz,gam_xy,gam_yz,gam_zx\n1e-5,0,0,0,0,0\n",
    )
    .unwrap();
    let (model, path) = (typed("plain.toml"), typed("path.csv"));
    let drive = [
        "drive", "material", "brick", "--model", &model, "--path", &path, "--out",
    ];
    for target in [&model, &path] {
        let refused = wythe(&[&drive[..], &[target]].concat());
        assert_eq!(code(&refused), 4, "{}", stderr(&refused));
    }
    let done = wythe(&["run", &model, "--out", &typed("a.out")]);
    assert_eq!(code(&done), 0, "{}", stderr(&done));
    let history = typed("a.out/history.csv");
    let refused = wythe(&["report", &typed("a.out"), "--out", &history]);
    assert_eq!(code(&refused), 4, "{}", stderr(&refused));
    assert!(text(&at("a.out/history.csv")).starts_with("increment,"));
    assert_eq!(
        [text(&at("model.toml")), text(&at("plain.toml"))],
        [deck.as_str(); 2]
    );
}

/// Otherwise the run would continue to write into the replaced file.
#[test]
fn the_messages_of_a_run_in_progress_are_salvaged_elsewhere_only() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let mut child = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .arg("run")
        .arg(repository("tests/stability/small_wall.toml"))
        .args(["--threads", "1", "--set", "steps.1.displacement=0.6 mm"])
        .args([
            "--set",
            "steps.1.increments={ initial=1e-4, max=1e-4, min=1e-9 }",
        ])
        .arg("--out")
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !out.join("checkpoint.bin").exists() {
        assert!(begun.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    let messages = out.join("run.mcap").display().to_string();
    let elsewhere = folder.path().join("salvaged.mcap").display().to_string();
    let refused = wythe(&["salvage", &messages]);
    let same = wythe(&["salvage", &messages, "--out", &messages]);
    let salvaged = wythe(&["salvage", &messages, "--out", &elsewhere]);
    child.kill().unwrap();
    child.wait().unwrap();
    for refused in [refused, same] {
        assert_eq!(code(&refused), 4, "{}", stderr(&refused));
        assert!(
            stderr(&refused).contains("another run"),
            "{}",
            stderr(&refused)
        );
    }
    assert_eq!(code(&salvaged), 0, "{}", stderr(&salvaged));
    // No process holds the file any more.
    let salvaged = wythe(&["salvage", &messages]);
    assert_eq!(code(&salvaged), 0, "{}", stderr(&salvaged));
}
