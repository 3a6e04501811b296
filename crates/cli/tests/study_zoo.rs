//! The command `wythe study zoo`: a few cheap walls that check the defaults, and the files and messages of the
//! command.

mod common;

use std::path::Path;

use common::*;

fn zoo(out: &Path, more: &[&str]) -> std::process::Output {
    let out = out.display().to_string();
    wythe(&[&["study", "zoo", "--out", &out], more].concat())
}

/// A column of a table as texts.
fn texts(table: &str, name: &str) -> Vec<String> {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let names = reader.headers().unwrap().clone();
    let index = names.iter().position(|n| n == name).unwrap();
    reader
        .records()
        .map(|r| r.unwrap()[index].to_owned())
        .collect()
}

#[test]
fn walls_come_to_an_answer_with_closed_energies_at_a_bounded_cost() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("zoo");
    let seeds = "7,10,12,18,61,99";
    let run = zoo(&out, &["--seeds", seeds, "--limit", "120", "--jobs", "2"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let table = std::fs::read_to_string(out.join("zoo.csv")).unwrap();
    let column = |name: &str| texts(&table, name);
    let (seeds, loads) = (column("seed"), column("load"));
    let (status, energies, solves) = (
        column("status"),
        column("energy_balance_error"),
        column("solves"),
    );
    assert_eq!(seeds.len(), 6);
    for i in 0..seeds.len() {
        let wall = format!("seed {} ({}): {}", seeds[i], loads[i], column("message")[i]);
        assert!(
            ["completed", "collapsed"].contains(&status[i].as_str()),
            "{wall}: {}",
            status[i]
        );
        // Requirements for every wall.
        assert!(
            energies[i].parse::<f64>().unwrap() <= 0.01,
            "{wall}: {}",
            energies[i]
        );
        assert!(
            solves[i].parse::<usize>().unwrap() <= 5000,
            "{wall}: {}",
            solves[i]
        );
    }
    let page = std::fs::read_to_string(out.join("zoo.md")).unwrap();
    assert!(
        page.contains("](walls/12.out) ([deck](walls/12.toml))"),
        "{page}"
    );
    assert!(out.join("walls/12.out/summary.json").exists() && out.join("solves.svg").exists());

    // The results exist, so no wall is run again, and the page is unchanged.
    let before = std::fs::metadata(out.join("walls/12.out/history.csv")).unwrap();
    let again = zoo(&out, &["--seeds", "12", "--limit", "120"]);
    assert_eq!(code(&again), 0, "{}", stderr(&again));
    let after = std::fs::metadata(out.join("walls/12.out/history.csv")).unwrap();
    assert_eq!(before.modified().unwrap(), after.modified().unwrap());
    assert_eq!(std::fs::read_to_string(out.join("zoo.md")).unwrap(), page);
}

#[test]
fn walls_are_run_by_each_strategy() {
    let folder = tempfile::tempdir().unwrap();
    let run = |strategy: &str, seeds: &str| {
        let out = folder.path().join(strategy);
        let more = ["--strategy", strategy, "--seeds", seeds, "--limit", "60"];
        let run = zoo(&out, &[&more[..], &["--jobs", "2"]].concat());
        assert_eq!(code(&run), 0, "{}", stderr(&run));
        let page = std::fs::read_to_string(out.join("zoo.md")).unwrap();
        assert!(page.contains(&format!("--strategy {strategy}")));
        std::fs::read_to_string(out.join("zoo.csv")).unwrap()
    };
    for strategy in ["rigid", "simplified"] {
        let table = run(strategy, "6,9,12,28");
        assert_eq!(texts(&table, "status"), ["completed"; 4], "{strategy}");
        assert_eq!(texts(&table, "strategy"), [strategy; 4]);
    }
    // Seed 10 is locked between its beams: rigid units carry any force.
    let table = run("limit", "10,12");
    assert_eq!(texts(&table, "status"), ["refused", "completed"]);
    let messages = texts(&table, "message");
    assert!(messages[0].contains("carry any factor") && messages[1].contains("factor"));
    assert!(texts(&table, "peak_force_kN")[1].parse::<f64>().unwrap() > 0.0);
}

#[test]
fn decks_are_written_without_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let run = zoo(folder.path(), &["--seeds", "3..5,4,9", "--decks-only"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    assert!(String::from_utf8_lossy(&run.stdout).starts_with("4 decks in "));
    let walls = std::fs::read_dir(folder.path().join("walls")).unwrap();
    assert_eq!(walls.count(), 4);
    assert!(!folder.path().join("zoo.csv").exists());
    let deck = folder.path().join("walls/5.toml").display().to_string();
    let check = wythe(&["check", &deck]);
    assert_eq!(code(&check), 0, "{}", stderr(&check));
}

#[test]
fn a_wall_whose_time_is_up_is_ended_and_told_first() {
    let folder = tempfile::tempdir().unwrap();
    // The wall takes about 13 s.
    let run = zoo(folder.path(), &["--seeds", "1", "--limit", "0.2"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    assert!(stderr(&run).contains("out_of_time"), "{}", stderr(&run));
    assert!(String::from_utf8_lossy(&run.stdout).starts_with("0 of 1 walls"));
    let page = std::fs::read_to_string(folder.path().join("zoo.md")).unwrap();
    assert!(page.contains("| **out_of_time** |"), "{page}");
}

#[test]
fn slips_are_told() {
    let folder = tempfile::tempdir().unwrap();
    for (more, exit, said) in [
        (&["--seeds", "5..1"][..], 2, "1..200"),
        (&["--seeds", "1..1000000000000"], 2, "are more than 100000"),
        (&["--limit", "0"], 2, "seconds above 0"),
        (&["--decks-only", "--fresh"], 2, "cannot be used"),
    ] {
        let run = zoo(folder.path(), more);
        assert_eq!(code(&run), exit, "{more:?}");
        assert!(stderr(&run).contains(said), "{more:?}: {}", stderr(&run));
    }
    std::fs::write(folder.path().join("zoo.csv"), "seed\nno number\n").unwrap();
    let run = zoo(folder.path(), &["--seeds", "1"]);
    assert_eq!(code(&run), 4, "{}", stderr(&run));
    assert!(stderr(&run).contains("zoo.csv"), "{}", stderr(&run));
}
