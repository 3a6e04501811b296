//! The file `results.vtkhdf` of runs that are killed, run out of disk space, or may not write.
#![cfg(unix)]

mod common;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use wythe_core::results::FieldsFile;
use wythe_core::state::Frame;

use common::*;

/// All frames of a file.
fn frames(out: &Path) -> Vec<Frame> {
    let file = FieldsFile::open(&out.join("results.vtkhdf")).unwrap();
    let count = file.times().len();
    assert_eq!(file.increments().len(), count);
    (0..count)
        .map(|frame| {
            let frame = file.frame(frame).unwrap();
            assert_eq!(frame.stress.len(), frame.crack_width.len());
            assert!(!frame.interfaces.opening.is_empty());
            frame
        })
        .collect()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Runs are killed at random moments, and the files that remain are read.
#[test]
fn a_run_killed_at_any_moment_leaves_whole_frames() {
    let folder = tempfile::tempdir().unwrap();
    for attempt in 0..12 {
        let out = folder.path().join(format!("{attempt}.out"));
        let mut child = Command::new(env!("CARGO_BIN_EXE_wythe"))
            .args(["run", &couplet(), "--threads", "1", "--quiet", "--out"])
            .arg(&out)
            .args([
                "--set",
                "steps.0.increments={ initial=2e-4, max=2e-4, min=1e-9 }",
            ])
            .args(["--set", "output.every=1"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while !out.join("results.vtkhdf").exists() {
            assert!(child.try_wait().unwrap().is_none(), "ended before it began");
            std::thread::sleep(Duration::from_millis(1));
        }
        if attempt == 11 {
            // The run continues until a second frame can be read.
            let begun = Instant::now();
            while frames(&out).len() < 2 {
                assert!(begun.elapsed() < Duration::from_secs(60), "none is shown");
                std::thread::sleep(Duration::from_millis(20));
            }
        } else {
            std::thread::sleep(Duration::from_micros(500 + 37_300 * attempt));
        }
        child.kill().unwrap();
        assert_eq!(child.wait().unwrap().code(), None, "ended before the kill");
        let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
        let times = column(&history, "time");
        let frames = frames(&out);
        // Each frame belongs to its increment.
        for frame in &frames {
            assert_eq!(times[frame.increment - 1], frame.time);
        }
        // The next run removes the files that remain.
        if attempt % 4 == 0 {
            let again = wythe(&["run", &couplet(), "--out", &out.display().to_string()]);
            assert_eq!(code(&again), 0, "{}", stderr(&again));
            assert!(!names(&out).iter().any(|n| n.contains(".vtkhdf.")));
        }
    }
}

/// Runs the couplet in a shell with a resource limit.
fn limited(limit: &str, out: &Path) -> std::process::Output {
    Command::new("sh")
        .arg("-c")
        .arg(format!("{limit} && exec \"$@\""))
        .arg("sh")
        .arg(env!("CARGO_BIN_EXE_wythe"))
        .args(["run", &couplet(), "--quiet", "--set", "output.mcap=false"])
        .args(["--set", "output.every=1", "--out"])
        .arg(out)
        .env("LC_ALL", "C.UTF-8")
        .output()
        .unwrap()
}

/// The largest file size is two thirds of that of the fields, as with an exhausted quota.
#[test]
fn fields_that_find_no_room_are_an_error_and_earlier_frames_stay() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, cut) = (
        folder.path().join("whole.out"),
        folder.path().join("cut.out"),
    );
    let output = limited("true", &whole);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let all = frames(&whole);
    // SIGXFSZ, which would end the process, is ignored; a block has 512 bytes.
    let length = std::fs::metadata(whole.join("results.vtkhdf"))
        .unwrap()
        .len();
    let limit = format!("trap '' XFSZ && ulimit -f {}", length * 2 / 3 / 512);
    let output = limited(&limit, &cut);
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    let said = stderr(&output).replace(' ', "");
    for part in [
        "results.vtkhdf:cannotbewritten",
        "Filetoolarge",
        "freespace",
    ] {
        assert!(said.contains(part), "{part}: {}", stderr(&output));
    }
    let kept = frames(&cut);
    assert!((1..all.len()).contains(&kept.len()), "{}", kept.len());
    for (kept, all) in kept.iter().zip(&all) {
        assert_eq!(kept.time, all.time);
        assert_eq!(kept.displacement, all.displacement);
        assert_eq!(kept.interfaces, all.interfaces);
    }
    assert_eq!(
        names(&cut),
        [
            ".lock",
            "checkpoint.bin",
            "history.csv",
            "model.toml",
            "results.interfaces.vtkhdf",
            "results.vtkhdf"
        ],
        "neither a summary nor halves"
    );
}

/// Not even the beginning of the file fits.
#[test]
fn a_quota_that_is_used_up_is_met_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let output = limited("trap '' XFSZ && ulimit -f 16", &out);
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    let said = stderr(&output).replace(' ', "");
    assert!(said.contains("results.vtkhdf:cannotbewritten"), "{said}");
    assert_eq!(names(&out), [".lock", "history.csv"]);
}

/// A read-only folder of results. Root may write everywhere, so the test then runs as another user.
#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_may_only_be_read_is_an_error() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let folder = tempfile::tempdir().unwrap();
    let mode = |path: &Path, mode| {
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode)).unwrap();
    };
    let (out, deck) = (folder.path().join("wall.out"), folder.path().join("a.toml"));
    let command = folder.path().join("wythe");
    std::fs::copy(couplet(), &deck).unwrap();
    std::fs::copy(env!("CARGO_BIN_EXE_wythe"), &command).unwrap();
    std::fs::create_dir(&out).unwrap();
    for file in [".lock", "history.csv", "results.vtkhdf"] {
        std::fs::write(out.join(file), "of an earlier run").unwrap();
        mode(&out.join(file), 0o666);
    }
    mode(folder.path(), 0o755);
    mode(&command, 0o755);
    mode(&out, 0o555);
    let mut run = if std::fs::metadata(&out).unwrap().uid() == 0 {
        let mut run = Command::new("setpriv");
        run.args(["--reuid=65534", "--regid=65534", "--clear-groups"]);
        run.arg(&command);
        run
    } else {
        Command::new(&command)
    };
    let output = run
        .arg("run")
        .arg(&deck)
        .arg("--out")
        .arg(&out)
        .env("LC_ALL", "C.UTF-8")
        .output()
        .unwrap();
    mode(&out, 0o755);
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    let said = stderr(&output).replace(' ', "");
    for part in [
        "results.vtkhdf:cannotbewritten",
        "Permissiondenied",
        "permissionsofthefolder",
    ] {
        assert!(said.contains(part), "{part}: {}", stderr(&output));
    }
    let fields = std::fs::read_to_string(out.join("results.vtkhdf")).unwrap();
    assert_eq!(fields, "of an earlier run");
}
