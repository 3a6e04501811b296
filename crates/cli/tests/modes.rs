//! `wythe modes`: figures, files and errors.

mod common;

use common::*;
use serde_json::Value;
use std::path::Path;

/// A pier of three blocks on joints, that is pulled until its lowest joint has opened.
const PIER: &str = r#"
format = 1
title = "a pier"
[materials.stone]
E = "5 GPa"
nu = 0.2
density = "2000 kg/m^3"
[interfaces.joint]
f_t = "0.05 MPa"
c = "0.1 MPa"
tan_phi = 0.7
mu = 0.7
u_k = "0.1 mm"
delta_k = "0.1 mm"
zeta = 4.38
xi = 1.1
[[blocks]]
name = "pier"
size = ["200 mm", "150 mm", "300 mm"]
material = "stone"
mesh = [4, 2, 3]
stack = 3
interface = "joint"
[[supports]]
on = "pier-0.bottom"
[[probes]]
name = "top"
on = "pier-2.top"
direction = "x"
[[steps]]
kind = "gravity"
[[steps]]
kind = "drive"
face = "pier-2.top"
direction = "x"
displacement = "0.2 mm"
free = ["z"]
[output]
every = 1
"#;

fn modes(arguments: &[&str]) -> Value {
    let output = wythe(&[&["modes", "--json"][..], arguments].concat());
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

fn first(found: &Value) -> f64 {
    found["modes"][0]["frequency_Hz"].as_f64().unwrap()
}

fn written(folder: &Path, name: &str) -> String {
    std::fs::write(folder.join(name), PIER).unwrap();
    folder.join(name).display().to_string()
}

#[test]
fn a_cracked_pier_vibrates_more_slowly_than_a_whole_one() {
    let folder = tempfile::tempdir().unwrap();
    let deck = written(folder.path(), "pier.toml");
    let rest = modes(&[&deck, "--count", "3"]);
    assert_eq!(rest["frame"], Value::Null);
    assert_eq!(rest["closed_joint_area"], 1.0);
    let files = folder.path().join("pier.modes");
    for file in ["modes.json", "modes.vtkhdf", "mode_01.svg", "mode_03.svg"] {
        assert!(files.join(file).is_file(), "{file}");
    }
    let kept = std::fs::read_to_string(files.join("modes.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&kept).unwrap(), rest);
    let described = wythe(&["info", &files.join("modes.vtkhdf").display().to_string()]);
    assert_eq!(code(&described), 0, "{}", stderr(&described));
    assert!(stdout(&described).contains('3'), "{}", stdout(&described));
    let out = folder.path().join("pier.out").display().to_string();
    let run = wythe(&["run", &deck, "--quiet", "--threads", "1"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let pressed = modes(&[&out, "--frame", "0", "--count", "3"]);
    let cracked = modes(&[&out, "--count", "3"]);
    assert_eq!(pressed["frame"]["number"], 0);
    // Its weight softens the pier by far less than a hundredth: it would buckle under hundreds of times as much.
    assert!(
        (first(&pressed) / first(&rest) - 1.0).abs() < 0.01,
        "{pressed}"
    );
    assert!(first(&cracked) < 0.9 * first(&pressed), "{cracked}");
    assert!(cracked["closed_joint_area"].as_f64().unwrap() < 1.0);
    assert!(
        cracked["notes"][0].as_str().unwrap().contains("is open"),
        "{cracked}"
    );
    let table = stdout(&wythe(&["modes", &out, "--count", "2"]));
    assert!(
        table.contains("mode") && table.contains("f [Hz]") && table.contains("sum"),
        "{table}"
    );
}

/// A block on springs that a load moves by 1 mm before a step ties it to a held one.
const TIED: &str = r#"
format = 1
[materials.stone]
E = "10 GPa"
nu = 0
density = "2000 kg/m^3"
[[blocks]]
name = "ground"
size = [100, 100, 100]
at = [-600, 0, 0]
material = "stone"
[[blocks]]
name = "block"
size = [100, 100, 100]
material = "stone"
[[springs]]
name = "soil"
on = "block"
stiffness = [100, 130, 170]
[[supports]]
on = "ground"
[[ties]]
name = "rod"
points = [[-500, 50, 50], [0, 50, 50]]
area = 1
E = "200 GPa"
f_y = "100 MPa"
step = "later"
[[steps]]
kind = "load"
loads = [{ name = "pull", on = "block", force = [100, 0, 0] }]
[[steps]]
kind = "load"
name = "later"
loads = [{ name = "pull", on = "block", force = [110, 0, 0] }]
[output]
every = 1
"#;

#[test]
fn a_tie_is_there_from_its_step_on() {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("tied.toml").display().to_string();
    std::fs::write(&deck, TIED).unwrap();
    let run = wythe(&["run", &deck, "--quiet", "--threads", "1"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let out = folder.path().join("tied.out").display().to_string();
    let along = |found: &Value| {
        let rows = found["modes"].as_array().unwrap();
        let part = |row: &&Value| row["effective_part"][0].as_f64().unwrap() > 0.9;
        rows.iter().find(part).unwrap()["frequency_Hz"]
            .as_f64()
            .unwrap()
    };
    let before = along(&modes(&[&out, "--frame", "0"]));
    let after = along(&modes(&[&out]));
    // 2 kg on 100 N/mm, and with 400 N/mm of the rod beside them.
    for (found, stiffness) in [(before, 100.0_f64), (after, 500.0)] {
        let closed = (stiffness / 2e-3).sqrt() / std::f64::consts::TAU;
        assert!((found / closed - 1.0).abs() < 1e-3, "{found} {closed}");
    }
}

#[test]
fn what_cannot_vibrate_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let deck = written(folder.path(), "pier.toml");
    // Without mass and weight.
    let light = PIER.replace("density = \"2000 kg/m^3\"\n", "");
    let light = light.replacen("[[steps]]\nkind = \"gravity\"\n", "", 1);
    let path = folder.path().join("light.toml").display().to_string();
    std::fs::write(&path, light).unwrap();
    for (arguments, exit, words) in [
        (vec![&deck[..], "--frame", "last"], 2, "is a model"),
        (vec![&path[..]], 2, "give a density to stone"),
        (vec!["nowhere.toml"], 4, "nowhere.toml"),
        (
            vec![folder.path().to_str().unwrap()],
            4,
            "no results of a run",
        ),
        (vec![&deck[..], "--count", "0"], 2, "0"),
    ] {
        let output = wythe(&[&["modes"][..], &arguments].concat());
        assert_eq!(code(&output), exit, "{arguments:?}: {}", stderr(&output));
        assert!(
            stderr(&output).contains(words),
            "{words}: {}",
            stderr(&output)
        );
    }
}
