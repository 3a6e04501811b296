//! Errors and warnings of a model in `check` and `run`, as text and as JSON; and forms of the progress of a run.

mod common;

use common::*;
use serde_json::Value;

/// Three errors of form.
const WRONG: [&str; 6] = [
    "--set",
    "wall.courses=0",
    "--set",
    "materials.brick.E=4 mm",
    "--set",
    "materials.brick.poison=1",
];

/// Both materials snap back with the cube root of the volume, and the joint has a warning.
const SNAPS: [&str; 10] = [
    "--set",
    "materials.brick.crack_band=volume",
    "--set",
    "materials.mortar.crack_band=volume",
    "--set",
    "materials.brick.reference_length=1 mm",
    "--set",
    "materials.mortar.reference_length=1 mm",
    "--set",
    "interfaces.joint.mu=0.9",
];

fn wall() -> String {
    let path = repository("examples/03_shear_wall_j7d.toml");
    path.display().to_string()
}

#[test]
fn check_and_run_tell_all_errors_of_the_form() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").display().to_string();
    let wall = wall();
    let checked = wythe(&[&["check", &wall], &WRONG[..]].concat());
    let run = wythe(&[&["run", &wall, "--out", &out], &WRONG[..]].concat());
    for output in [&checked, &run] {
        assert_eq!(code(output), 2);
        let said = stderr(output);
        for part in [
            "wall.courses",
            "materials.brick.E: expected a pressure (MPa)",
            "`poison` is not a known key",
            "3 errors of form",
            "physics is judged when the form is right",
        ] {
            assert!(said.contains(part), "{part} is not in {said}");
        }
    }
    assert_eq!(stderr(&checked), stderr(&run));
    assert!(!std::path::Path::new(&out).exists());
}

#[test]
fn the_physics_is_told_with_its_warnings() {
    let output = wythe(&[&["check", &wall()], &SNAPS[..]].concat());
    assert_eq!(code(&output), 2);
    let said = stderr(&output);
    for part in [
        "warning: interfaces.joint.mu",
        "materials.brick.tension",
        "materials.mortar.compression",
        "errors of physics",
    ] {
        assert!(said.contains(part), "{part} is not in {said}");
    }
}

fn json(arguments: &[&str]) -> (i32, Value) {
    let output = wythe(arguments);
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
    (
        code(&output),
        serde_json::from_slice(&output.stdout).unwrap(),
    )
}

#[test]
fn machines_read_one_object() {
    let wall = wall();
    let (code, object) = json(&[&["check", "--json", &wall], &WRONG[..]].concat());
    assert_eq!(
        (code, &object["ok"], &object["layer"]),
        (2, &false.into(), &"form".into())
    );
    let errors = object["errors"].as_array().unwrap();
    assert_eq!(errors.len(), 3);
    assert!(
        errors
            .iter()
            .all(|e| e["line"].is_u64() && e["help"].is_string())
    );
    assert!(errors.iter().any(|e| e["key"] == "materials.brick.E"));
    let kinds: Vec<_> = errors.iter().filter_map(|e| e["kind"].as_str()).collect();
    assert_eq!(kinds, ["value", "value", "unknown-key"]);

    let (code, object) = json(&[&["check", "--json", &wall], &SNAPS[..]].concat());
    assert_eq!((code, &object["layer"]), (2, &"physics".into()));
    assert!(object["errors"].as_array().unwrap().len() >= 4);
    assert!(!object["warnings"].as_array().unwrap().is_empty());

    let (code, object) = json(&["check", "--json", &wall]);
    assert_eq!((code, &object["ok"]), (0, &true.into()));
    assert!(
        object["sizes"]["elements"].as_u64().unwrap() > 1000,
        "{object}"
    );
    let warning = &object["warnings"][0];
    assert!(
        warning["line"].is_u64() && warning["column"].is_u64(),
        "{warning}"
    );
}

/// The kind of an error tells what is wrong, whatever the words.
#[test]
fn errors_have_kinds() {
    let kinds = |deck: &str| -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deck.toml");
        std::fs::write(&path, deck).unwrap();
        let (_, object) = json(&["check", "--json", path.to_str().unwrap()]);
        let errors = object["errors"].as_array().unwrap();
        let kinds = errors.iter().map(|e| e["kind"].as_str().unwrap());
        kinds.map(str::to_owned).collect()
    };
    let wall = std::fs::read_to_string(wall()).unwrap();
    assert_eq!(kinds("format = 1\ntitle = \"no end"), ["syntax"]);
    assert_eq!(kinds(&wall.replace("courses", "coursse"))[0], "unknown-key");
    let other = wall.replace("unit_material = \"brick\"", "unit_material = \"brik\"");
    assert_eq!(kinds(&other), ["unknown-name"]);
    let low = wall.replace("E = \"16700 MPa\"", "E = \"-1 MPa\"");
    assert_eq!(kinds(&low), ["value"]);
}

/// A warning is printed with its line and a caret.
#[test]
fn warnings_point_at_their_place() {
    let output = wythe(&["check", &wall()]);
    let text = String::from_utf8(output.stdout).unwrap();
    let mut lines = text
        .lines()
        .skip_while(|l| !l.starts_with("warning: materials.mortar.tension"));
    let (_, written, caret) = (lines.next(), lines.next().unwrap(), lines.next().unwrap());
    let at = caret.find('^').unwrap();
    assert!(written[at..].starts_with("0.95"), "{text}");
}

/// A short run of the couplet.
fn short(more: &[&str]) -> std::process::Output {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").display().to_string();
    let couplet = couplet();
    let run = [
        "run",
        &couplet,
        "--out",
        &out,
        "--set",
        "steps.0.displacement=0.001 mm",
        "--set",
        "steps.1.displacement=0.001 mm",
    ];
    wythe(&[&run, more].concat())
}

#[test]
fn progress_for_machines_is_an_object_a_line() {
    let output = short(&["--progress", "json"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let objects: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let event = |object: &Value| object["event"].as_str().unwrap().to_owned();
    assert_eq!(event(&objects[0]), "begin");
    assert_eq!(event(objects.last().unwrap()), "end");
    assert_eq!(objects.last().unwrap()["status"], "completed");
    let increments: Vec<&Value> = objects.iter().filter(|o| event(o) == "increment").collect();
    assert!(increments.len() > 2);
    let done: Vec<f64> = increments
        .iter()
        .map(|o| o["done"].as_f64().unwrap())
        .collect();
    // The tolerance allows for rounding in a sum of a hundred increments.
    let whole = (done.last().unwrap() - 1.0).abs() < 1e-12;
    assert!(done.is_sorted() && whole, "{done:?}");
    for key in [
        "step",
        "force_kN",
        "displacement_mm",
        "procedure",
        "elapsed_s",
        "eta_s",
    ] {
        assert!(!increments[0][key].is_null(), "{key}");
    }
}

#[test]
fn progress_is_plain_where_no_terminal_is_and_quiet_if_asked() {
    let plain = short(&[]);
    assert!(
        stderr(&plain).contains("step 0 drive: increment 1,"),
        "{}",
        stderr(&plain)
    );
    assert!(!plain.stderr.contains(&0x1b) && !plain.stdout.is_empty());
    let quiet = short(&["--quiet"]);
    assert_eq!(code(&quiet), 0);
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
    assert_eq!(code(&short(&["--quiet", "--progress", "json"])), 2);
}

/// The output has neither colours nor characters outside ASCII if the locale or NO_COLOR asks for it.
#[test]
fn errors_are_ascii_in_a_plain_locale() {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_wythe"))
        .args(["check", &couplet(), "--set", "wall.courses=0"])
        .env("LC_ALL", "C")
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    assert_eq!(code(&output), 2);
    assert!(
        output.stderr.is_ascii(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(!output.stderr.contains(&0x1b));
}

fn json_of(arguments: &[&str]) -> (i32, Value) {
    let output = wythe(&[&["check", "--json"], arguments].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let value = serde_json::from_str(&text).unwrap_or_else(|why| panic!("{why}: {text}"));
    (code(&output), value)
}

/// For any file there is one JSON object with the errors.
#[test]
fn check_as_json_is_json_whatever_the_file_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.display().to_string()
    };
    let here = folder.path().display().to_string();
    let missing = folder.path().join("none.toml").display().to_string();
    let no_file = [missing, here, file("binary.toml", &[0, 159, 146, 150, 255])];
    for path in &no_file {
        let (code, value) = json_of(&[path]);
        assert_eq!((code, &value["ok"]), (4, &Value::from(false)), "{path}");
        assert_eq!(value["layer"], "file", "{path}");
        let error = &value["errors"][0];
        assert_eq!(error["file"].as_str(), Some(path.as_str()));
        assert!(!error["message"].as_str().unwrap().is_empty());
        assert!(!error["help"].as_str().unwrap().is_empty());
    }
    let no_deck = [
        file("empty.toml", b""),
        file("text.toml", b"this is no TOML"),
        file("other.toml", b"[package]\nname = \"x\"\n"),
        file("zero.toml", b"format = 1\n\0"),
        file("deck.json", b"{\"format\": 1}"),
    ];
    for path in &no_deck {
        let (code, value) = json_of(&[path]);
        assert_eq!((code, &value["ok"]), (2, &Value::from(false)), "{path}");
        assert!(!value["errors"].as_array().unwrap().is_empty(), "{path}");
    }
    // The object is printed even if the picture cannot be drawn.
    let wall = wall();
    let (code, value) = json_of(&[&wall, "--picture", "scene.txt"]);
    assert_eq!((code, &value["ok"]), (2, &Value::from(true)));
}

/// Nine blocks in two rows overlap by 1 mm: one line reports all pairs.
#[test]
fn warnings_of_one_kind_are_one_line_with_a_count() {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("model.toml");
    let mut text = String::from(
        "format = 1\n[materials.stone]\nE = 1000\nnu = 0.2\n[interfaces.dry]\nf_t = 0\nc = 0\ntan_phi = 0.5\nmu = 0.5\n\
         normal_stiffness = 100\nshear_stiffness = 100\n[contact]\ngeneral = \"dry\"\n[[supports]]\non = \"b0\"\n\
         [[steps]]\nkind = \"preload\"\nface = \"b8.right\"\n",
    );
    for i in 0..9 {
        let at = 100.0 * f64::from(i);
        text += &format!(
            "[[blocks]]\nname = \"b{i}\"\nsize = [100, 100, 100]\nat = [{at}, 0, 0]\nmaterial = \"stone\"\n"
        );
    }
    // A thousand times the strength of a brick, in nine loads with names of their own.
    text = text.replace(
        "face = \"b8.right\"\n",
        "face = \"b8.right\"\npressure = 1\n[[steps]]\nkind = \"load\"\n",
    );
    let loads: String = (0..9)
        .map(|i| {
            format!(
                "[[steps.loads]]\nname = \"n{i}\"\non = \"b{i}.front\"\npressure = {}\n",
                300_000 + i
            )
        })
        .collect();
    let at = text.find("[[blocks]]").unwrap();
    text.insert_str(at, &loads);
    std::fs::write(&deck, &text).unwrap();
    let path = deck.display().to_string();
    let output = wythe(&["check", &path]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let lines: Vec<&str> = said
        .lines()
        .filter(|l| l.contains("strongest brick"))
        .collect();
    assert_eq!(lines.len(), 1, "{said}");
    assert!(
        lines[0].contains("if it is in Pa: \"300000 Pa\"")
            && lines[0].contains("(and 8 more of this kind)"),
        "{said}"
    );
    let (_, value) = json_of(&[&path]);
    let warnings = value["warnings"].as_array().unwrap();
    let loads = warnings
        .iter()
        .find(|w| w["key"] == "steps.1.loads.0.pressure")
        .unwrap();
    assert_eq!(loads["others"], 8);
}

/// Wrong units and wrong orders of numbers, each with a suggestion.
#[test]
fn magnitudes_that_no_wall_has_are_told_with_what_was_meant() {
    let wall = wall();
    let warned = |set: &[&str]| {
        let sets: Vec<&str> = set.iter().flat_map(|set| ["--set", *set]).collect();
        let (code, value) = json_of(&[&[wall.as_str()], &sets[..]].concat());
        assert_eq!(code, 0, "{set:?}: {value}");
        let warnings = value["warnings"].as_array().unwrap().clone();
        let told = warnings
            .iter()
            .map(|w| format!("{}: {}", w["key"], w["message"]));
        told.collect::<Vec<_>>().join("\n")
    };
    let plain = warned(&[]);
    for (set, part) in [
        (
            &["materials.brick.density=1900"][..],
            "density = \\\"1900 kg/m^3\\\"",
        ),
        (
            &["materials.brick.density=1.9e-6"],
            "density = \\\"1.9e-6 kg/mm^3\\\"",
        ),
        (
            &["materials.brick.density=1.9"],
            "density = \\\"1.9 tonne/m^3\\\"",
        ),
        (&["steps.0.top_pressure=300"], "\\\"300 kPa\\\""),
        (&["steps.0.top_pressure=300000"], "\\\"300000 Pa\\\""),
    ] {
        let told = warned(set);
        assert!(told.contains(part), "{set:?}: {told}");
        assert!(!plain.contains(part));
    }
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("model.toml");
    std::fs::write(
        &deck,
        "format = 1\n[materials.stone]\nE = 20e9\nnu = 0.2\ndensity = 2e-9\n[[blocks]]\nname = \"b\"\n\
         size = [100, 100, 100]\nmaterial = \"stone\"\n[[supports]]\non = \"b.bottom\"\n[[steps]]\nkind = \"gravity\"\ngravity = 9.81\n",
    )
    .unwrap();
    let (_, value) = json_of(&[&deck.display().to_string()]);
    let told = value["warnings"].to_string();
    assert!(told.contains("E = \\\"20000 MPa\\\""), "{told}");
    assert!(told.contains("gravity = \\\"9.81 m/s^2\\\""), "{told}");
    // The bricks of J7D measure 204 x 98 x 50 mm.
    let turned = warned(&["wall.unit=[204, 50, 98]", "wall.length=\"990 mm\""]);
    assert!(turned.contains("[204, 98, 50]"), "{turned}");
}
