//! `--strategy`: one deck, four ways to model it.

#[path = "common/mod.rs"]
mod common;

use common::{code, repository, stderr, stdout, wythe};

fn example(name: &str) -> String {
    repository(&format!("examples/{name}"))
        .display()
        .to_string()
}

#[test]
fn a_deck_runs_with_each_strategy() {
    let folder = tempfile::tempdir().unwrap();
    let wall = example("61_wall_with_opening.toml");
    for strategy in ["simplified", "rigid"] {
        let out = folder.path().join(strategy).display().to_string();
        let shorter = "steps.1.displacement=0.2 mm";
        let run = wythe(&[
            "run",
            &wall,
            "--strategy",
            strategy,
            "--set",
            shorter,
            "--out",
            &out,
            "--quiet",
        ]);
        assert_eq!(code(&run), 0, "{}", stderr(&run));
        // The copy of the deck is that of the strategy, and another one refuses it.
        let copy = format!("{out}/model.toml");
        let check = wythe(&["check", &copy]);
        assert_eq!(code(&check), 0, "{}", stderr(&check));
        let other = wythe(&["check", &copy, "--strategy", "detailed"]);
        assert_eq!(code(&other), 2);
        assert!(
            stderr(&other).contains("begin with the deck of the"),
            "{}",
            stderr(&other)
        );
    }
}

#[test]
fn a_run_by_limit_writes_factor_and_mechanism() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").display().to_string();
    let wall = example("63_dry_stone_wall.toml");
    let run = wythe(&["run", &wall, "--strategy", "limit", "--out", &out]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    assert!(stdout(&run).contains("limit"), "{}", stdout(&run));
    let json = std::fs::read_to_string(format!("{out}/limit.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(found["force_kN"].as_f64().unwrap() > 0.0);
    assert!(
        std::fs::read_to_string(format!("{out}/mechanism.svg"))
            .unwrap()
            .contains("<svg")
    );
}

#[test]
fn limit_analysis_has_no_error_by_mesh_or_increments() {
    let wall = example("63_dry_stone_wall.toml");
    let run = wythe(&["run", &wall, "--strategy", "limit", "--error"]);
    assert_eq!(code(&run), 2, "{}", stderr(&run));
    assert!(
        stderr(&run).contains("leave out --error"),
        "{}",
        stderr(&run)
    );
}

#[test]
fn an_unknown_strategy_names_the_known_ones() {
    let wall = example("61_wall_with_opening.toml");
    let check = wythe(&["check", &wall, "--strategy", "coarse"]);
    assert_eq!(code(&check), 2);
    assert!(stderr(&check).contains("simplified"), "{}", stderr(&check));
}

#[test]
fn a_study_puts_the_strategies_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("study").display().to_string();
    let wall = example("61_wall_with_opening.toml");
    let study = [
        "study",
        "strategies",
        &wall,
        "--only",
        "limit,simplified,detailed",
        "--set",
        "steps.1.displacement=0.2 mm",
        // A top that cannot rise holds rigid units whatever the force.
        "--set",
        "steps.1.vertical=free",
        "--out",
        &out,
    ];
    let found = wythe(&study);
    assert_eq!(code(&found), 0, "{}", stderr(&found));
    let page = std::fs::read_to_string(format!("{out}/strategies.md")).unwrap();
    for name in ["limit", "simplified", "detailed"] {
        let line = page.lines().find(|l| l.starts_with(&format!("| {name} |")));
        let line = line.unwrap_or_else(|| panic!("{name}: {page}"));
        let force: f64 = line.split('|').nth(2).unwrap().trim().parse().unwrap();
        assert!(force > 0.0, "{line}");
    }
    assert!(page.contains("completed") && page.contains("force along the drive"));
    let chart = std::fs::read_to_string(format!("{out}/strategies.svg")).unwrap();
    assert!(chart.contains("<svg") && chart.contains("simplified"));
    let unknown = wythe(&["study", "strategies", &wall, "--only", "coarse"]);
    assert_eq!(code(&unknown), 2);
    assert!(
        stderr(&unknown).contains("limit, rigid"),
        "{}",
        stderr(&unknown)
    );
}
