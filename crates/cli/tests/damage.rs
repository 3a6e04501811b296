//! Damaged folders of runs: a run that continues from them gives correct results, and commands that read them
//! report the damage.
#![cfg(unix)]

mod common;

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use common::*;
use wythe_core::results::RunFolder;

/// A random number generator with a long period (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % end
    }
}

fn copy(from: &Path, to: &Path) {
    let _ = std::fs::remove_dir_all(to);
    std::fs::create_dir(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

fn flip(path: &Path, bit: u64) {
    let mut bytes = std::fs::read(path).unwrap();
    bytes[(bit / 8) as usize] ^= 1 << (bit % 8);
    std::fs::write(path, bytes).unwrap();
}

/// A run that was killed between two checkpoints, well before its end.
fn killed(out: &Path) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args([
            "run",
            &couplet(),
            "--threads",
            "1",
            "--set",
            "output.every=5",
        ])
        .arg("--out")
        .arg(out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    let rows = || std::fs::read_to_string(out.join("history.csv")).map_or(0, |t| t.lines().count());
    // The complete history has 198 lines.
    while rows() < 120 {
        assert!(begun.elapsed() < Duration::from_secs(120));
        assert!(child.try_wait().unwrap().is_none(), "ended before the kill");
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

/// All results of a finished run: history, messages, fields.
fn told(out: &Path) -> [Vec<u8>; 3] {
    let fields = RunFolder::open(out).unwrap().fields().unwrap();
    let frames = (0..fields.times().len()).map(|frame| fields.frame(frame).unwrap());
    let frames: Vec<String> = frames.map(|frame| format!("{frame:?}")).collect();
    let read = |name: &str| std::fs::read(out.join(name)).unwrap();
    [
        read("history.csv"),
        read("run.mcap"),
        frames.concat().into(),
    ]
}

/// Number of bytes at the beginning of each file that identify its format: the magic bytes and the header record
/// of MCAP without its texts (8 + 9 + 4 + 4), the first column names of the history, the superblock of HDF5.
const FORMAT: u64 = 25;

/// A changed bit is either detected, and a warning names the file, or has no effect: then all files equal those of
/// an undisturbed run. The history equals it in both cases.
#[test]
fn a_changed_bit_is_seen_or_leaves_no_trace() {
    let folder = tempfile::tempdir().unwrap();
    let [stopped, out] = ["stopped.out", "again.out"].map(|name| folder.path().join(name));
    let name = out.display().to_string();
    killed(&stopped);
    copy(&stopped, &out);
    let output = wythe(&["resume", &name, "--threads", "1"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(!stderr(&output).contains("cannot be read"));
    let wanted = told(&out);
    let (mut random, mut seen) = (Random(39), [0; 3]);
    for (f, file) in ["history.csv", "run.mcap", "results.vtkhdf"]
        .into_iter()
        .enumerate()
    {
        let length = std::fs::metadata(stopped.join(file)).unwrap().len();
        for attempt in 0..16 {
            copy(&stopped, &out);
            // The first bytes identify the format, and every checkpoint includes them; the other bits lie
            // anywhere.
            let bit = random.below(if attempt < 4 { 8 * FORMAT } else { 8 * length });
            flip(&out.join(file), bit);
            let output = wythe(&["resume", &name, "--threads", "1"]);
            let said = stderr(&output);
            assert_eq!(code(&output), 0, "{file}, bit {bit}: {said}");
            let found = told(&out);
            assert!(found[0] == wanted[0], "{file}, bit {bit}");
            if said.contains(&format!("{file} cannot be read")) {
                seen[f] += 1;
            } else {
                assert!(found == wanted, "{file}, bit {bit}: {said}");
            }
        }
    }
    // In the fields every bit counts, in the other files only those before the checkpoint. The position of the
    // checkpoint depends on the moment of the kill, but it lies after the format bytes.
    assert!(seen[0] >= 4 && seen[1] >= 4 && seen[2] == 16, "{seen:?}");
    // A damaged checkpoint is rejected, and no file is changed.
    let length = std::fs::metadata(stopped.join("checkpoint.bin"))
        .unwrap()
        .len();
    for _ in 0..8 {
        copy(&stopped, &out);
        flip(&out.join("checkpoint.bin"), random.below(8 * length));
        let output = wythe(&["resume", &name]);
        assert_eq!(code(&output), 4, "{}", stderr(&output));
        assert!(
            stderr(&output).contains("checkpoint.bin"),
            "{}",
            stderr(&output)
        );
        for file in ["history.csv", "run.mcap", "results.vtkhdf"] {
            let [a, b] = [&stopped, &out].map(|f| std::fs::read(f.join(file)).unwrap());
            assert!(a == b, "{file}");
        }
    }
}

/// Runs the command with one gibibyte of address space. It must end within ten seconds.
fn limited(arguments: &[&str]) -> Output {
    let begun = Instant::now();
    let output = Command::new("sh")
        .args(["-c", "ulimit -v 1048576 && exec \"$@\"", "sh"])
        .arg(env!("CARGO_BIN_EXE_wythe"))
        .args(arguments)
        .env("LC_ALL", "C.UTF-8")
        .env("RAYON_NUM_THREADS", "2")
        .output()
        .unwrap();
    assert!(begun.elapsed() < Duration::from_secs(10), "{arguments:?}");
    output
}

/// Whatever the damage to a file, commands that read the folder end by themselves: they read the file, or name it.
#[test]
fn damaged_files_are_read_or_named() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, out] = ["whole.out", "damaged.out"].map(|name| folder.path().join(name));
    let run = wythe(&["run", &couplet(), "--out", &whole.display().to_string()]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let curve = folder.path().join("curve.csv");
    std::fs::write(&curve, "displacement_mm,force_kN\n0,0\n0.01,1\n").unwrap();
    let (name, curve) = (out.display().to_string(), curve.display().to_string());
    let elsewhere = folder.path().join("elsewhere");
    let to = elsewhere.display().to_string();
    let page = folder.path().join("page.html").display().to_string();
    let messages = out.join("run.mcap").display().to_string();
    let salvaged = folder.path().join("salvaged.mcap").display().to_string();
    let mut random = Random(4);
    for file in ["results.vtkhdf", "history.csv", "summary.json", "run.mcap"] {
        let bytes = std::fs::read(whole.join(file)).unwrap();
        for attempt in 0..10 {
            copy(&whole, &out);
            let mut bytes = bytes.clone();
            match attempt {
                // Cut, emptied, doubled, replaced by another kind of data.
                0 => bytes.truncate(random.below(bytes.len() as u64) as usize),
                1 => bytes.clear(),
                2 => bytes.extend_from_within(..),
                3 => bytes.fill(0xFF),
                // Eight consecutive bytes with any value.
                4..7 => {
                    let at = random.below(bytes.len() as u64 - 8) as usize;
                    let number = random.below(u64::MAX) >> (16 * (attempt - 4));
                    bytes[at..at + 8].copy_from_slice(&number.to_le_bytes());
                }
                _ => {
                    let at = random.below(bytes.len() as u64) as usize;
                    bytes[at] ^= 0x10;
                }
            }
            std::fs::write(out.join(file), &bytes).unwrap();
            for arguments in [
                &["info", &name][..],
                &["report", &name, "--out", &page],
                &["plot", &name, "--out", &to],
                &["compare", &name, &curve],
                &["export", &name, "--to", "vtu", "--out", &to],
                &["salvage", &messages, "--out", &salvaged],
            ] {
                let output = limited(arguments);
                let said = stderr(&output);
                match output.status.code() {
                    Some(0) => {}
                    // The name may be wrapped.
                    Some(2 | 4) => assert!(
                        said.replace(' ', "").contains(file),
                        "{arguments:?}, {file}, {attempt}: {said}"
                    ),
                    code => panic!("{arguments:?}, {file}, {attempt}: {code:?} {said}"),
                }
            }
        }
    }
}
