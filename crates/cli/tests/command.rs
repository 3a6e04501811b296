//! Exit codes, messages and files of the command.

mod common;

use std::io::BufRead;
use std::path::Path;
use std::process::Command;

use common::*;
use wythe_core::results::RunFolder;

#[test]
fn usage_errors_exit_with_2() {
    assert_eq!(code(&wythe(&[])), 2);
    assert_eq!(code(&wythe(&["run"])), 2);
    assert_eq!(code(&wythe(&["run", "a.toml", "--threads", "0"])), 2);
    assert_eq!(code(&wythe(&["check", "a.toml", "--set", "novalue"])), 2);
    assert_eq!(code(&wythe(&["--version"])), 0);
    assert_eq!(code(&wythe(&["drive", "material", "--help"])), 0);
}

#[test]
fn a_missing_model_exits_with_4_and_a_bad_one_with_2() {
    let missing = wythe(&["check", "no/such/model.toml"]);
    assert_eq!(code(&missing), 4);
    assert!(stderr(&missing).contains("no/such/model.toml"));
    let bad = repository("tests/data/bad/negative_modulus.toml");
    let bad = wythe(&["check", &bad.display().to_string()]);
    assert_eq!(code(&bad), 2);
    assert!(
        stderr(&bad).contains("materials.brick.E"),
        "{}",
        stderr(&bad)
    );
    let set = wythe(&["check", &couplet(), "--set", "wall.courses=0"]);
    assert_eq!(code(&set), 2);
    assert!(
        stderr(&set).contains("--set wall.courses"),
        "{}",
        stderr(&set)
    );
}

/// A wrong model is rejected before the folder is created, with the file, the place and advice.
#[test]
fn every_bad_deck_exits_with_2_and_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out").display().to_string();
    let mut tried = 0;
    for entry in std::fs::read_dir(repository("tests/data/bad")).unwrap() {
        let deck = entry.unwrap().path();
        let name = deck.file_name().unwrap().to_string_lossy().into_owned();
        let output = wythe(&["run", &deck.display().to_string(), "--out", &out]);
        assert_eq!(code(&output), 2, "{name}: {}", stderr(&output));
        let said = stderr(&output);
        // The path may be wrapped in the middle.
        assert!(
            said.replace(' ', "").contains(&format!("{name}:")),
            "{name}: {said}"
        );
        assert!(said.contains("help:"), "{name}: {said}");
        assert!(!Path::new(&out).exists(), "{name}");
        tried += 1;
    }
    assert!(tried > 30);
}

#[test]
fn check_prints_the_sizes() {
    let output = wythe(&["check", &couplet()]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        text.contains("2 units") && text.contains("contact points"),
        "{text}"
    );
}

#[test]
fn results_that_cannot_be_written_exit_with_4() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    std::fs::write(&out, "mine").unwrap();
    let output = wythe(&["run", &couplet(), "--out", &out.display().to_string()]);
    assert_eq!(code(&output), 4);
    assert!(
        stderr(&output).contains("this is a file"),
        "{}",
        stderr(&output)
    );
}

/// One folder would lie below a file. In the other, files may not hold a single byte, as with an exhausted quota.
#[test]
#[cfg(target_os = "linux")]
fn folders_and_disks_that_refuse_exit_with_4_and_leave_nothing_that_looks_whole() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "mine").unwrap();
    let below = file.join("wall.out");
    let full = folder.path().join("full.out");
    for (limit, out, said) in [
        ("true", &below, "cannot be created"),
        // SIGXFSZ, which would end the process, is ignored.
        ("trap '' XFSZ && ulimit -f 0", &full, "File too large"),
    ] {
        let output = Command::new("sh")
            .args(["-c", &format!("{limit} && exec \"$@\""), "sh"])
            .args([env!("CARGO_BIN_EXE_wythe"), "run", &couplet(), "--out"])
            .arg(out)
            .env("LC_ALL", "C.UTF-8")
            .output()
            .unwrap();
        assert_eq!(code(&output), 4, "{}", stderr(&output));
        assert!(stderr(&output).contains(said), "{}", stderr(&output));
        assert!(!out.join("summary.json").exists());
    }
}

/// The command writes to a device and never replaces it by a file.
#[test]
#[cfg(target_os = "linux")]
fn answers_go_to_devices_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    std::fs::write(
        &path,
        "eps_xx,eps_yy,eps_zz,gam_xy,gam_yz,gam_zx\n1e-5,0,0,0,0,0\n",
    )
    .unwrap();
    let (path, model) = (path.display().to_string(), couplet());
    let drive = [
        "drive", "material", "brick", "--model", &model, "--path", &path, "--out",
    ];
    let output = wythe(&[&drive[..], &["/dev/full"]].concat());
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    assert!(
        stderr(&output).contains("the disk is full"),
        "{}",
        stderr(&output)
    );
    // The device still exists: no file was moved over it.
    use std::os::unix::fs::FileTypeExt;
    let device = std::fs::metadata("/dev/full").unwrap().file_type();
    assert!(device.is_char_device());
    let output = wythe(&[&drive[..], &["/dev/stdout"]].concat());
    assert_eq!(
        column(&String::from_utf8(output.stdout).unwrap(), "d"),
        [0.0]
    );
}

/// The second step cannot converge: it has one iteration for a tolerance below rounding, and no cut-backs.
#[test]
fn lost_convergence_exits_with_3_keeps_what_was_and_says_what_to_try() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let model = repository("examples/02_couplet_shear.toml")
        .display()
        .to_string();
    let output = wythe(&[
        "run",
        &model,
        "--out",
        &out.display().to_string(),
        "--set",
        "steps.1.tolerance = { residual = 1e-15, max_iterations = 1 }",
        "--set",
        "steps.1.increments = { initial = 0.1, max = 0.1, min = 0.1 }",
    ]);
    assert_eq!(code(&output), 3, "{}", stderr(&output));
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    let steps = column(&history, "step");
    assert!(
        !steps.is_empty() && steps.iter().all(|s| *s == 0.0),
        "{steps:?}"
    );
    let times = column(&history, "time");
    assert_eq!(times.last(), Some(&1.0)); // the preload is complete
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "not_converged");
    assert_eq!(summary["increments"].as_f64(), Some(steps.len() as f64));
    let message = summary["message"].as_str().unwrap();
    for part in [
        "step 1 (drive), at load factor 0.0000",
        "no equilibrium within 1 iterations",
        "worst at wall-",
        "on an interface, node ",
        "try steps.1.tolerance.max_iterations",
        "steps.1.increments.min below 1e-1",
    ] {
        assert!(message.contains(part), "{part} is not in {message}");
    }
    // The printed message has the same advice.
    assert!(
        stderr(&output).contains("steps.1.increments.min below"),
        "{}",
        stderr(&output)
    );
    for name in [
        "results.vtkhdf",
        "load_displacement.svg",
        "crack_pattern.svg",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
}

/// Sends a signal to a process, as a terminal does.
#[cfg(unix)]
fn signal(name: &str, child: &std::process::Child) {
    let sent = Command::new("kill")
        .args([name, &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}

/// Starts a couplet with enough increments to be interrupted, and waits until some of them are written.
#[cfg(unix)]
fn long_run(out: &Path) -> std::process::Child {
    use std::process::Stdio;
    let mut child = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args(["run", &couplet(), "--threads", "1", "--out"])
        .arg(out)
        .args(["--set", "steps.0.increments.max=0.0002"])
        .args(["--set", "steps.0.increments.initial=0.0002"])
        .args(["--set", "steps.0.increments.min=1e-9"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let rows = || {
        let text = std::fs::read_to_string(out.join("history.csv")).unwrap_or_default();
        text.matches('\n').count()
    };
    while rows() < 12 {
        assert!(
            child.try_wait().unwrap().is_none(),
            "ended before it could be interrupted"
        );
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child
}

#[test]
#[cfg(unix)]
fn an_interrupt_finishes_the_increment_writes_everything_and_exits_with_130() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let mut child = long_run(&out);
    signal("-INT", &child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary = std::fs::read_to_string(out.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "interrupted");
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    assert!(history.ends_with('\n'));
    let increments = column(&history, "increment");
    assert_eq!(increments.last().copied(), summary["increments"].as_f64());
    assert!(out.join("load_displacement.svg").is_file());
}

/// The first increment of a fine wall takes long enough for two interrupts.
#[test]
#[cfg(unix)]
fn a_second_interrupt_stops_at_once() {
    use std::process::Stdio;
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let mut child = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .arg("run")
        .arg(repository("examples/03_shear_wall_j7d.toml"))
        .args(["--threads", "1", "--set", "wall.mesh=fine", "--out"])
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The command listens to signals before it creates the files.
    while !out.join("results.vtkhdf").exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended before it began");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    signal("-INT", &child);
    let mut said = std::io::BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(said.any(|line| line.unwrap().contains("Ctrl-C again stops at once")));
    signal("-INT", &child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    // No increment was finished, and no summary claims that the run is complete.
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    assert_eq!(history.lines().count(), 1, "{history}");
    assert!(!out.join("summary.json").exists());
}

#[test]
#[cfg(unix)]
fn a_killed_run_leaves_rows_that_are_read_and_no_summary() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let mut child = long_run(&out);
    signal("-KILL", &child);
    assert_eq!(child.wait().unwrap().code(), None);
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    // The process may be killed between the writes of two pages of a row.
    let (whole, cut) = history.rsplit_once('\n').unwrap();
    // Every row except the last, incomplete one can be read, to its last cell.
    let rows = column(whole, "out_of_balance").len();
    assert!(rows >= 11);
    assert!(!out.join("summary.json").exists());
    // A row that ends in the middle is ignored; the complete rows before it are read.
    for rest in [cut, "99,0,0.5"] {
        std::fs::write(out.join("history.csv"), format!("{whole}\n{rest}")).unwrap();
        let read = RunFolder::open(&out).unwrap().history().unwrap();
        assert_eq!(read.rows.len(), rows, "{rest:?}");
    }
}
