//! A run that is killed at any moment and resumed gives the results of an undisturbed run.

mod common;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use common::*;
use wythe_core::results::RunFolder;
use wythe_core::results::checkpoint::CheckpointFile;
use wythe_core::results::mcap::salvage::salvage;
use wythe_core::results::output::CHECKPOINT;

/// A small wall of one second with a frame per increment: its joints open, its bricks crack.
const WALL: [&str; 6] = [
    "--set",
    "output.every=1",
    "--set",
    "steps.1.displacement=0.6 mm",
    "--threads",
    "1",
];

/// Runs to be killed: name, deck and arguments.
fn runs() -> [(&'static str, String, Vec<&'static str>); 3] {
    let implex = [&WALL[..], &["--set", "steps.1.procedure=implex"]].concat();
    let block = repository("tests/stability/cases/07-rocking-block/deck.toml");
    let dynamic = vec!["--set", "output.every=5", "--threads", "1"];
    [
        ("static", wall(), WALL.to_vec()),
        ("implex", wall(), implex),
        ("dynamic", block.display().to_string(), dynamic),
    ]
}

fn wall() -> String {
    repository("tests/stability/small_wall.toml")
        .display()
        .to_string()
}

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}

/// A random number generator with a long period (splitmix64); numbers in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Starts the command and kills it after `wait`. Returns true if it had ended before.
fn killed_after(arguments: &[&str], wait: Duration) -> bool {
    let mut child = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let end = Instant::now() + wait;
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "{arguments:?}: {status}");
            return true;
        }
        if Instant::now() >= end {
            // SIGKILL on systems with signals.
            child.kill().unwrap();
            child.wait().unwrap();
            return false;
        }
        std::thread::sleep(Duration::from_micros(500));
    }
}

/// The files of a killed run can be read: complete rows, messages of all rows except the last, a complete
/// checkpoint with its messages, and fields up to the checkpoint.
fn opens(out: &Path) {
    let folder = RunFolder::open(out).unwrap();
    let rows = folder.history().unwrap().rows.len();
    if rows == 0 && !out.join("results.vtkhdf").exists() {
        // The process was killed while it created the folder.
        return;
    }
    let fields = folder.fields().unwrap();
    let frames = fields.times().len();
    assert!(frames == 0 || fields.frame(frames - 1).is_ok());
    if out.join(CHECKPOINT).exists() {
        let file = CheckpointFile::read(&out.join(CHECKPOINT)).unwrap();
        assert!(file.solver.increments() <= rows && file.frames <= frames);
    }
    if rows > 1 {
        let salvaged = out.join("salvaged.mcap");
        let found = salvage(&out.join("run.mcap"), Some(&salvaged)).unwrap();
        assert!(found.messages >= rows as u64 - 1, "{found:?}, {rows} rows");
        std::fs::remove_file(&salvaged).unwrap();
    }
}

/// Topic, number, log time and data of all messages of a complete file. Warnings are left out: they name lines of
/// the deck, and a resumed run reads the deck in its folder.
fn messages(path: &Path) -> Vec<(String, u32, u64, Vec<u8>)> {
    let bytes = std::fs::read(path).unwrap();
    assert!(mcap::Summary::read(&bytes).unwrap().is_some());
    let messages = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(Result::unwrap);
    let told = messages.map(|m| {
        let topic = m.channel.topic.clone();
        (topic, m.sequence, m.log_time, m.data.into_owned())
    });
    let warning = b"\"level\":3";
    told.filter(|(topic, .., data)| {
        topic != "/log" || !data.windows(warning.len()).any(|part| part == warning)
    })
    .map(|(topic, number, time, data)| {
        // The numbering of the log includes warnings.
        let number = if topic == "/log" { 0 } else { number };
        (topic, number, time, data)
    })
    .collect()
}

/// Kills a run `kills` times, with random numbers from `seed`, and compares its result with that of an undisturbed
/// run.
fn survives((name, deck, arguments): &(&str, String, Vec<&str>), kills: usize, seed: u64) {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole.out");
    let out = whole.display().to_string();
    let start = Instant::now();
    let output = wythe(&[&["run", deck, "--out", &out], &arguments[..]].concat());
    let alone = start.elapsed();
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let wanted = text(&whole.join("history.csv"));

    let (mut random, mut done, mut rounds) = (Random(seed), 0, 0);
    while done < kills {
        rounds += 1;
        let out = folder.path().join(format!("{rounds}.out"));
        let folder_of_it = out.display().to_string();
        let first = [&["run", deck, "--out", &folder_of_it], &arguments[..]].concat();
        let again = ["resume", &folder_of_it, "--threads", "1"];
        let mut started = false;
        loop {
            let can_resume = started && out.join(CHECKPOINT).exists();
            let arguments = if can_resume { &again[..] } else { &first[..] };
            // Sometimes at once, mostly in the first third.
            let wait = alone.mul_f64(random.next().powi(2) * 0.5);
            if killed_after(arguments, wait) {
                break;
            }
            started = out.join("history.csv").exists();
            done += 1;
            if started && text(&out.join("history.csv")).ends_with('\n') {
                opens(&out);
            }
        }
        assert_eq!(
            text(&out.join("history.csv")),
            wanted,
            "round {rounds}, seed {seed}"
        );
        let [a, b] = [&whole, &out].map(|out| RunFolder::open(out).unwrap());
        let (one, other) = (a.summary().unwrap().unwrap(), b.summary().unwrap().unwrap());
        assert_eq!(one.iterations, other.iterations);
        assert_eq!(one.log, other.log);
        assert_eq!(one.energy_balance_error, other.energy_balance_error);
        let (one, other) = (a.fields().unwrap(), b.fields().unwrap());
        let last = |fields: &wythe_core::results::FieldsFile| {
            format!("{:?}", fields.frame(fields.times().len() - 1).unwrap())
        };
        assert_eq!(last(&one), last(&other));
        let [said, again] = [&whole, &out].map(|out| messages(&out.join("run.mcap")));
        assert!(said == again, "run.mcap, round {rounds}, seed {seed}");
        assert_eq!(one.times(), other.times());
        assert_eq!(one.increments(), other.increments());
        std::fs::remove_dir_all(&out).unwrap();
    }
    println!("{name}: {done} kills in {rounds} rounds");
}

/// Each run is killed four times; `tests/run-kills` sets a larger number and the seed.
#[test]
fn killed_runs_go_on_to_the_same_bytes() {
    let number = |name: &str| -> Option<u64> { std::env::var(name).ok()?.parse().ok() };
    let kills = number("WYTHE_KILLS").unwrap_or(4);
    let seed = number("WYTHE_KILLS_SEED").unwrap_or(1);
    for run in runs() {
        survives(&run, kills as usize, seed);
    }
}

/// Runs a couplet to its end.
fn done(folder: &Path) -> String {
    let out = folder.join("couplet.out").display().to_string();
    let output = wythe(&["run", &couplet(), "--out", &out]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    out
}

#[test]
fn a_complete_run_has_nothing_to_do_until_its_last_step_is_longer() {
    let folder = tempfile::tempdir().unwrap();
    let out = done(folder.path());
    let history = Path::new(&out).join("history.csv");
    let before = text(&history);
    let nothing = wythe(&["resume", &out]);
    assert_eq!(code(&nothing), 0, "{}", stderr(&nothing));
    assert!(String::from_utf8_lossy(&nothing.stdout).contains("nothing to do"));
    assert_eq!(text(&history), before);

    // The first step leads to 0.006 mm, the second 0.25 mm further.
    let output = wythe(&["resume", &out, "--set", "steps.1.displacement=0.3125"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let after = text(&history);
    assert!(after.starts_with(&before));
    let end = column(&after, "displacement_mm").last().copied().unwrap();
    assert!((end - 0.3185).abs() < 1e-9, "{end}");
    assert!(text(&Path::new(&out).join("summary.json")).contains("\"completed\""));
    // The folder now holds the longer deck.
    let nothing = wythe(&["resume", &out]);
    assert!(String::from_utf8_lossy(&nothing.stdout).contains("nothing to do"));
    let shorter = wythe(&["resume", &out, "--set", "steps.1.displacement=0.25"]);
    assert_eq!(code(&shorter), 2, "{}", stderr(&shorter));
    assert!(
        stderr(&shorter).contains("not longer"),
        "{}",
        stderr(&shorter)
    );
}

#[test]
fn what_cannot_go_on_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("nowhere").display().to_string();
    let refused = wythe(&["resume", &nowhere]);
    assert_eq!(code(&refused), 4);
    assert!(stderr(&refused).contains("no results of a run"));

    let out = done(folder.path());
    let changed = wythe(&["resume", &out, "--set", "interfaces.joint.f_t=0.3"]);
    assert_eq!(code(&changed), 2);
    let said = stderr(&changed);
    assert!(
        said.contains("interfaces.joint.f_t was") && said.contains("help:"),
        "{said}"
    );

    let checkpoint = Path::new(&out).join(CHECKPOINT);
    let whole = std::fs::read(&checkpoint).unwrap();
    std::fs::write(&checkpoint, &whole[..whole.len() / 2]).unwrap();
    let damaged = wythe(&["resume", &out]);
    assert_eq!(code(&damaged), 4);
    assert!(
        stderr(&damaged).contains("is damaged"),
        "{}",
        stderr(&damaged)
    );
    std::fs::remove_file(&checkpoint).unwrap();
    let missing = wythe(&["resume", &out]);
    assert_eq!(code(&missing), 4);
    assert!(
        stderr(&missing).contains("wythe run"),
        "{}",
        stderr(&missing)
    );

    // None of these attempts has changed the results.
    std::fs::write(&checkpoint, &whole).unwrap();
    assert_eq!(code(&wythe(&["resume", &out])), 0);
}

/// The fields also contain the rows; without both, the run begins anew.
#[test]
fn a_history_that_is_lost_is_made_anew_or_the_run_begins_anew() {
    let folder = tempfile::tempdir().unwrap();
    let out = done(folder.path());
    let at = |name: &str| Path::new(&out).join(name);
    let whole = text(&at("history.csv"));
    let short: String = whole.split_inclusive('\n').take(3).collect();
    for lost in ["results.vtkhdf", ""] {
        std::fs::write(at("history.csv"), &short).unwrap();
        std::fs::remove_file(at("summary.json")).unwrap();
        let said = if lost.is_empty() {
            "history.csv cannot be read (it ends before the checkpoint): it is kept as \
             history.damaged.csv, and it is made anew from results.vtkhdf"
        } else {
            std::fs::write(at(lost), "no fields").unwrap();
            "the run begins anew"
        };
        let resumed = wythe(&["resume", &out]);
        assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
        assert!(stderr(&resumed).contains(said), "{}", stderr(&resumed));
        assert_eq!(text(&at("history.csv")), whole);
        assert_eq!(text(&at("history.damaged.csv")), short);
        let fields = RunFolder::open(Path::new(&out)).unwrap().fields().unwrap();
        assert!(fields.times().len() > 1, "{lost}");
    }
}

/// The checkpoint has all data of the solver: the run continues although other files are lost.
#[test]
fn fields_and_messages_that_cannot_be_read_begin_anew() {
    let folder = tempfile::tempdir().unwrap();
    let out = done(folder.path());
    let at = |name: &str| Path::new(&out).join(name);
    let history = text(&at("history.csv"));
    for name in ["run.mcap", "results.vtkhdf"] {
        std::fs::write(at(name), "no such file").unwrap();
    }
    std::fs::remove_file(at("summary.json")).unwrap();
    let resumed = wythe(&["resume", &out]);
    assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
    for name in ["run.mcap", "results.vtkhdf"] {
        let said = format!("{name} cannot be read");
        assert!(stderr(&resumed).contains(&said), "{}", stderr(&resumed));
        let (stem, ending) = name.split_once('.').unwrap();
        let kept = at(&format!("{stem}.damaged.{ending}"));
        assert_eq!(text(&kept), "no such file");
    }
    assert_eq!(text(&at("history.csv")), history);
    assert!(RunFolder::open(Path::new(&out)).unwrap().fields().is_ok());
    let said = |topic: &str| {
        let messages = messages(&at("run.mcap"));
        messages.iter().filter(|(of, ..)| of == topic).count()
    };
    // The new file has no messages of past steps, only log messages on the resumption.
    assert_eq!((said("/step"), said("/log")), (0, 2));

    // Messages may be switched off, and on again later.
    std::fs::remove_file(at("summary.json")).unwrap();
    let resumed = wythe(&["resume", &out, "--set", "output.mcap=false"]);
    assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
    assert!(
        stderr(&resumed).contains("run.mcap ends here"),
        "{}",
        stderr(&resumed)
    );
    let out = folder.path().join("silent.out").display().to_string();
    let silent = wythe(&[
        "run",
        &couplet(),
        "--out",
        &out,
        "--set",
        "output.mcap=false",
    ]);
    assert_eq!(code(&silent), 0, "{}", stderr(&silent));
    std::fs::remove_file(Path::new(&out).join("summary.json")).unwrap();
    let resumed = wythe(&["resume", &out, "--set", "output.mcap=true"]);
    assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
    assert!(
        stderr(&resumed).contains("run.mcap was not wanted before"),
        "{}",
        stderr(&resumed)
    );
    messages(&Path::new(&out).join("run.mcap"));
}

#[test]
fn a_second_run_into_the_same_folder_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("wall.out");
    let name = out.display().to_string();
    let mut first = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args([&["run", &wall(), "--out", &name], &WALL[..]].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !out.join(CHECKPOINT).exists() {
        assert!(begun.elapsed() < Duration::from_secs(120));
        std::thread::sleep(Duration::from_millis(5));
    }
    let second = wythe(&["run", &wall(), "--out", &name]);
    let third = wythe(&["resume", &name]);
    first.kill().unwrap();
    first.wait().unwrap();
    for refused in [second, third] {
        assert_eq!(code(&refused), 4, "{}", stderr(&refused));
        assert!(stderr(&refused).contains("another run is writing"));
    }
    // The lock ends with the process that held it.
    assert!(killed_after(&["resume", &name], Duration::from_secs(600)));
}

/// Deck, record and results are moved together; the original folder no longer exists.
#[test]
fn a_project_that_is_moved_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let [here, there] = ["here", "there/deeper"].map(|name| folder.path().join(name));
    std::fs::create_dir_all(here.join("data")).unwrap();
    std::fs::create_dir_all(there.parent().unwrap()).unwrap();
    let pulse = text(&repository("tests/data/ground/pulse.csv"));
    std::fs::write(here.join("data/ground.csv"), &pulse).unwrap();
    let deck = text(&repository(
        "tests/stability/cases/06-braking-block/deck.toml",
    ));
    let deck = deck.replacen(
        "procedure = \"dynamic\"",
        "procedure = \"dynamic\"\nground = { x = \"data/ground.csv\" }",
        1,
    );
    std::fs::write(here.join("block.toml"), deck).unwrap();
    let run = wythe(&["run", &here.join("block.toml").display().to_string()]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let wanted = text(&here.join("block.out/history.csv"));
    std::fs::rename(&here, &there).unwrap();
    let out = there.join("block.out");
    std::fs::remove_file(out.join("summary.json")).unwrap();
    let resumed = wythe(&["resume", &out.display().to_string()]);
    assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
    assert_eq!(text(&out.join("history.csv")), wanted);
    // Exports find the record too.
    let export = wythe(&["export", &out.display().to_string(), "--to", "inp"]);
    assert_eq!(code(&export), 0, "{}", stderr(&export));
    // Without the record, the message names the searched folder.
    std::fs::remove_dir_all(there.join("data")).unwrap();
    std::fs::remove_file(out.join("summary.json")).unwrap();
    let lost = wythe(&["resume", &out.display().to_string()]);
    assert_eq!(code(&lost), 2);
    assert!(
        stderr(&lost).replace(' ', "").contains("data/ground.csv"),
        "{}",
        stderr(&lost)
    );
}

/// A record named by the deck is found from the folder of results, and a changed record is reported.
#[test]
fn files_beside_the_deck_are_found_again() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("ground.csv");
    let pulse = text(&repository("tests/data/ground/pulse.csv"));
    std::fs::write(&record, &pulse).unwrap();
    let deck = text(&repository(
        "tests/stability/cases/06-braking-block/deck.toml",
    ));
    let deck = deck.replacen(
        "procedure = \"dynamic\"",
        "procedure = \"dynamic\"\nground = { x = \"ground.csv\" }",
        1,
    );
    assert!(deck.contains("ground.csv"));
    std::fs::write(folder.path().join("block.toml"), deck).unwrap();
    let name = folder
        .path()
        .join("elsewhere/block.out")
        .display()
        .to_string();
    let begun = Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args(["run", "block.toml", "--out", &name])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(code(&begun), 0, "{}", stderr(&begun));
    let summary = Path::new(&name).join("summary.json");
    std::fs::remove_file(&summary).unwrap();
    let resumed = wythe(&["resume", &name]);
    assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
    assert!(summary.exists());
    std::fs::write(&record, pulse.replacen("0.1,0.2", "0.1,0.3", 1)).unwrap();
    std::fs::remove_file(&summary).unwrap();
    let refused = wythe(&["resume", &name]);
    assert_eq!(code(&refused), 2, "{}", stderr(&refused));
    assert!(
        stderr(&refused).contains("a file that"),
        "{}",
        stderr(&refused)
    );
}
