//! Readers that stop, full disks and signals: none of them loses a run.
#![cfg(target_os = "linux")]

mod common;

use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use common::*;
use wythe_core::results::RunFolder;

/// Starts the command with these streams.
fn started(arguments: &[&str], streams: (Stdio, Stdio)) -> Child {
    Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args(arguments)
        .env("LC_ALL", "C.UTF-8")
        .stdin(Stdio::null())
        .stdout(streams.0)
        .stderr(streams.1)
        .spawn()
        .unwrap()
}

fn full() -> Stdio {
    File::options()
        .write(true)
        .open("/dev/full")
        .unwrap()
        .into()
}

/// A pipe whose reader has closed before anything is written.
fn broken() -> Stdio {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    writer.into()
}

fn ends(mut child: Child) -> Option<i32> {
    child.wait().unwrap().code()
}

fn is_complete(out: &Path) -> bool {
    let summary = RunFolder::open(out).unwrap().summary().unwrap();
    summary.is_some_and(|summary| summary.status == wythe_core::state::Status::Completed)
}

#[test]
fn a_run_goes_on_when_standard_error_fails() {
    let folder = tempfile::tempdir().unwrap();
    for (name, stream) in [("full", full()), ("broken", broken())] {
        let out = folder.path().join(format!("{name}.out"));
        let arguments = ["run", &couplet(), "--out", &out.display().to_string()];
        assert_eq!(
            ends(started(&arguments, (Stdio::null(), stream))),
            Some(0),
            "{name}"
        );
        assert!(is_complete(&out), "{name}");
    }
}

/// A reader of standard output that stops is not an error, a full disk is one, and the results are complete in
/// both cases.
#[test]
fn a_run_goes_on_when_standard_output_fails() {
    let folder = tempfile::tempdir().unwrap();
    for progress in ["plain", "json"] {
        for (stream, wanted) in [(full(), 4), (broken(), 0)] {
            let out = folder.path().join(format!("{progress}{wanted}.out"));
            let name = out.display().to_string();
            let arguments = ["run", &couplet(), "--progress", progress, "--out", &name];
            let child = started(&arguments, (stream, Stdio::null()));
            assert_eq!(ends(child), Some(wanted), "{progress}");
            assert!(is_complete(&out), "{progress} {wanted}");
        }
    }
}

#[test]
fn what_was_asked_for_on_standard_output_must_fit_there() {
    for asked in [
        &["schema"][..],
        &["--help"],
        &["check", &couplet(), "--json"],
    ] {
        for (stream, wanted) in [(full(), 4), (broken(), 0)] {
            let child = started(asked, (stream, Stdio::null()));
            assert_eq!(ends(child), Some(wanted), "{asked:?}");
        }
    }
    // The exit codes of errors remain if the messages cannot be written.
    for (asked, wanted) in [(&["check", "no/such.toml"][..], 4), (&["run"], 2)] {
        assert_eq!(ends(started(asked, (full(), full()))), Some(wanted));
    }
}

/// Whether this process ignores signals of this number, and so do the processes that it starts.
fn is_ignored(signal: u32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    let mask = u64::from_str_radix(mask.unwrap().trim(), 16).unwrap();
    mask >> (signal - 1) & 1 == 1
}

/// Starts a run of some seconds into `out` and waits for its first checkpoint.
fn under_way(out: &Path, before: &[&str]) -> Child {
    let model = repository("tests/stability/small_wall.toml");
    let mut command = match before {
        [] => Command::new(env!("CARGO_BIN_EXE_wythe")),
        [first, rest @ ..] => {
            let mut command = Command::new(first);
            command.args(rest).arg(env!("CARGO_BIN_EXE_wythe"));
            command
        }
    };
    let child = command
        .args(["run", &model.display().to_string(), "--threads", "1"])
        // Without a signal the run would take ten thousand increments.
        .args([
            "--set",
            "steps.1.increments={ initial=1e-4, max=1e-4, min=1e-9 }",
        ])
        .args(["--set", "steps.1.displacement=0.6 mm", "--out"])
        .arg(out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !out.join("checkpoint.bin").exists() {
        assert!(begun.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

fn send(signal: &str, child: &Child) {
    let sent = Command::new("kill")
        .args([format!("-{signal}"), child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
}

/// `timeout` and shells send a signal to a process and again to its group.
#[test]
fn sigterm_and_sighup_end_a_run_after_its_increment_however_often_they_come() {
    let folder = tempfile::tempdir().unwrap();
    for (signal, number) in [("TERM", 15), ("HUP", 1)] {
        if is_ignored(number) {
            continue;
        }
        let out = folder.path().join(format!("{signal}.out"));
        let child = under_way(&out, &[]);
        for _ in 0..3 {
            send(signal, &child);
        }
        assert_eq!(ends(child), Some(130), "{signal}");
        let folder = RunFolder::open(&out).unwrap();
        let summary = folder.summary().unwrap().unwrap();
        assert_eq!(summary.status, wythe_core::state::Status::Interrupted);
        let file =
            wythe_core::results::checkpoint::CheckpointFile::read(&out.join("checkpoint.bin"));
        // The last increment has a checkpoint of its own.
        assert_eq!(file.unwrap().solver.increments(), summary.increments);
        assert_eq!(folder.history().unwrap().rows.len(), summary.increments);
    }
}

#[test]
fn what_runs_below_nohup_outlives_its_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("nohup.out");
    let mut child = under_way(&out, &["nohup"]);
    send("HUP", &child);
    // After more increments the process still runs.
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "ended by SIGHUP");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!out.join("summary.json").exists());
}
