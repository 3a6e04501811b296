//! `wythe limit`: warnings about the deck, as text and as JSON.

mod common;

use common::{code, stderr, stdout, wythe};
use serde_json::Value;

/// A stone that tips, of a density that no stone has.
const DECK: &str = r#"
format = 1
[materials.stone]
E = "5 GPa"
nu = 0.2
density = "2 kg/m^3"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.5
mu = 0.7
normal_stiffness = "100 N/mm^3"
shear_stiffness = "40 N/mm^3"
[[blocks]]
name = "ground"
size = [400, 200, 100]
at = [-100, -50, -100]
material = "stone"
[[blocks]]
name = "stone"
size = [100, 100, 200]
material = "stone"
[[contacts]]
slave = "stone.bottom"
master = "ground.top"
interface = "dry"
[[supports]]
on = "ground"
[[steps]]
kind = "gravity"
[[steps]]
kind = "load"
[[steps.loads]]
name = "push"
on = "stone.left"
force = [0.001, 0, 0]
"#;

const WARNING: &str = "warning: materials.stone.density (line 6): ";

fn object(text: &[u8]) -> Value {
    serde_json::from_slice(text).unwrap()
}

#[test]
fn a_limit_analysis_tells_the_warnings_of_a_check() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (deck, out) = (path("deck.toml"), path("out"));
    std::fs::write(&deck, DECK).unwrap();
    let text = wythe(&["limit", &deck, "--along", "x"]);
    assert_eq!(code(&text), 0, "{}", stderr(&text));
    assert!(stderr(&text).starts_with(WARNING), "{}", stderr(&text));
    assert!(stdout(&text).contains("factor 0.500000"));
    let check = object(&wythe(&["check", &deck, "--json"]).stdout);
    assert_eq!(check["warnings"].as_array().unwrap().len(), 1);
    let json = wythe(&["limit", &deck, "--along", "x", "--json", "--out", &out]);
    assert_eq!((code(&json), stderr(&json).as_str()), (0, ""));
    assert_eq!(object(&json.stdout)["warnings"], check["warnings"]);
    let file = std::fs::read(format!("{out}/limit.json")).unwrap();
    assert_eq!(file, json.stdout);
}

#[test]
fn a_run_by_limit_tells_the_warnings_unless_it_is_quiet() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (deck, out) = (path("deck.toml"), path("out"));
    std::fs::write(&deck, DECK).unwrap();
    let run = ["run", &deck, "--strategy", "limit", "--out", &out];
    let told = wythe(&run);
    assert_eq!(code(&told), 0, "{}", stderr(&told));
    assert!(stderr(&told).starts_with(WARNING), "{}", stderr(&told));
    let quiet = wythe(&[&run[..], &["--quiet"]].concat());
    assert_eq!((code(&quiet), stderr(&quiet).as_str()), (0, ""));
    let file = std::fs::read(format!("{out}/limit.json")).unwrap();
    assert_eq!(
        object(&file)["warnings"][0]["key"],
        "materials.stone.density"
    );
}

/// The load on a light stone on a heavy one that can move is far below that on the heavy one.
#[test]
fn a_body_that_is_too_light_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("deck.toml");
    let light = "[[blocks]]\nname = \"light\"\nsize = [0.5, 0.5, 0.5]\nat = [40, 40, 200]\nmaterial = \"stone\"\n\
                 [[contacts]]\nslave = \"light.bottom\"\nmaster = \"stone.top\"\ninterface = \"dry\"\n[[supports]]";
    std::fs::write(&deck, DECK.replacen("[[supports]]", light, 1)).unwrap();
    let deck = deck.display().to_string();
    let text = wythe(&["limit", &deck, "--along", "x"]);
    assert_eq!(code(&text), 0, "{}", stderr(&text));
    // 0.125 over 2e6 mm³.
    let said = "warning: the load on light is 6e-8 of that on the heaviest body";
    assert!(stdout(&text).contains(said), "{}", stdout(&text));
}
