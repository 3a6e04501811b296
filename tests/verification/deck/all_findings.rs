//! All errors of a deck are reported at once, each at its place, without errors that only follow from others.

use crate::common::blocks::{GRAVITY, HEAD, PAIR};
use wythe::deck::Deck;
use wythe::error::ModelError;
use wythe::model::Model;

const WALL: &str = include_str!("../../../examples/03_shear_wall_j7d.toml");

fn refused(text: &str) -> ModelError {
    Deck::from_str(text, "deck.toml")
        .and_then(|deck| Model::from_deck(&deck))
        .expect_err("the deck is bad")
}

/// The deck `good` with the last occurrence of each `from` replaced by its `to`.
fn changed(good: &str, changes: &[(&str, &str)]) -> String {
    let mut text = good.to_owned();
    for (from, to) in changes {
        let at = text.rfind(from).unwrap_or_else(|| panic!("no {from}"));
        text.replace_range(at..at + from.len(), to);
    }
    text
}

/// Wrong keys after these changes, in the order in which they are reported.
fn keys(good: &str, changes: &[(&str, &str)]) -> Vec<String> {
    let error = refused(&changed(good, changes));
    for error in error.all() {
        assert!(error.line().is_some(), "{error} has no line");
        assert!(!error.advice().is_empty(), "{error} has no advice");
    }
    error.all().map(|e| e.key().to_owned()).collect()
}

#[test]
fn all_errors_of_form_are_reported() {
    let found = keys(
        WALL,
        &[
            ("E = \"850 MPa\"", "E = \"850 mm\""),
            ("nu = 0.15", "nu = 0.7"),
            ("zeta = 4.38", "zetta = 4.38"),
            ("mu = 0.75", "mu = true"),
            ("f_t = \"0.20 MPa\"", "f_t = \"-0.20 MPa\""),
            ("bed_joint = \"12.5 mm\"", "bed_joint = [1, 2]"),
            ("head_joint = \"12.5 mm\"\n", ""),
            ("courses = 18", "courses = -18"),
            (
                "mortar_material = \"mortar\"",
                "mortar_material = \"morter\"",
            ),
            ("kind = \"preload\"", "kind = \"preloud\""),
            ("direction = \"x\"", "direction = \"sideways\""),
            ("viscosity = 0.0025", "viscosity = \"1 furlong\""),
        ],
    );
    assert_eq!(
        found,
        [
            "materials.mortar.E",
            "materials.mortar.nu",
            "interfaces.joint.f_t",
            "interfaces.joint.zetta",
            "interfaces.joint.mu",
            "wall.bed_joint",
            "wall.courses",
            "wall.mortar_material",
            "wall.head_joint",
            "steps.0.kind",
            "steps.1.direction",
            "steps.1.viscosity",
        ]
    );
}

/// A plane of symmetry without a place is told the middle of the wall, which is no default.
#[test]
fn a_plane_without_a_place_is_told_the_middle_of_the_wall() {
    for (normal, middle) in [("x", "495 mm"), ("y", "49 mm")] {
        let plane = format!("{WALL}\n[[symmetry]]\nnormal = \"{normal}\"\n");
        let error = refused(&plane);
        assert_eq!(error.key(), "symmetry.0.at");
        assert!(error.advice().contains(middle), "{}", error.advice());
    }
    // Of a wall with an unknown length the middle is unknown, too.
    let unknown = changed(WALL, &[("length = \"990 mm\"", "length = \"990 bar\"")]);
    let error = refused(&format!("{unknown}\n[[symmetry]]\nnormal = \"x\"\n"));
    let mut all = error.all();
    let plane = all.find(|error| error.key() == "symmetry.0.at");
    assert!(plane.is_some_and(|plane| plane.advice().contains("at = ")));
}

/// A misspelt key is not also reported as missing. In a step of unknown kind no other keys are checked.
#[test]
fn consequences_of_an_error_are_not_reported() {
    for (change, key) in [
        (("unit_material", "unit_materiel"), "wall.unit_materiel"),
        (
            ("[interfaces.joint]", "[interfaces.join]"),
            "wall.interface",
        ),
        (("[materials.mortar]", "[material.mortar]"), "material"),
        (("kind = \"drive\"", "kind = \"push\""), "steps.1.kind"),
        (("kind = \"drive\"\n", ""), "steps.1.kind"),
        (
            ("f_t = \"0.20 MPa\"", "f_t = \"0.20 N\""),
            "interfaces.joint.f_t",
        ),
        (
            ("u_k = \"0.36 mm\"", "u_k = \"0.36\""),
            "interfaces.joint.u_k",
        ),
        (("[[steps]]", "[steps]"), ""),
        (("[wall]", "[[wall]]"), "wall"),
        (
            ("length = \"990 mm\"", "lenght = \"990 mm\""),
            "wall.lenght",
        ),
        (
            ("[0.1, 0.002, 0.95]", "[0.1, 0.002]"),
            "materials.mortar.tension.1",
        ),
        (
            ("[0.1, 0.002, 0.95]", "[0.1, \"a\", 0.95]"),
            "materials.mortar.tension.1.1",
        ),
        (("unit = [\"204 mm\"", "unit = [\"204 bar\""), "wall.unit.0"),
    ] {
        assert_eq!(keys(WALL, &[change]), [key], "{change:?}");
    }
}

#[test]
fn wrong_table_headings_are_reported_with_the_right_one() {
    let scene = format!("{HEAD}{PAIR}{GRAVITY}");
    let error = refused(&changed(&scene, &[("[[supports]]", "[supports]")]));
    assert_eq!(error.key(), "supports");
    assert!(error.advice().contains("[[supports]]"), "{error}");
    assert!(error.others().is_empty(), "{:?}", error.others());
    let error = refused(&changed(&scene, &[("[contact]", "[[contact]]")]));
    assert!(error.advice().contains("[contact]"), "{error}");
    assert!(error.others().is_empty(), "{:?}", error.others());
    let error = refused("format = 1\nmaterials = 3\nsteps = [1, 2]\n");
    let keys: Vec<&str> = error.all().map(ModelError::key).collect();
    assert_eq!(keys, ["materials", "steps"]);
}

#[test]
fn unknown_names_are_reported_with_the_form() {
    let scene = format!("{HEAD}{PAIR}{GRAVITY}");
    let found = keys(
        &scene,
        &[
            ("slave = \"top.bottom\"", "slave = \"topp.bottom\""),
            ("master = \"base.top\"", "master = \"base.upper\""),
            ("on = \"base\"", "on = [\"bass\", \"top\", \"none\"]"),
            ("nu = 0.2", "nu = 2"),
            ("interface = \"dry\"", "interface = \"dri\""),
        ],
    );
    assert_eq!(
        found,
        [
            "materials.stone.nu",
            "contacts.0.slave",
            "contacts.0.master",
            "contacts.0.interface",
            "supports.0.on",
            "supports.0.on",
        ]
    );
    // If a name could not be read, no use of a name is reported as unknown.
    let found = keys(
        &scene,
        &[("name = \"top\"", "name = 3"), ("nu = 0.2", "nu = 2")],
    );
    assert_eq!(found, ["materials.stone.nu", "blocks.1.name"]);
}

#[test]
fn invalid_toml_lines_do_not_hide_other_errors() {
    let found = refused(&changed(
        WALL,
        &[
            ("mu = 0.75", "mu = "),
            ("courses = 18", "courses = \"eighteen\""),
            ("displacement = \"4 mm\"", "displacement = 4 mm"),
        ],
    ));
    let lines: Vec<_> = found.all().map(|e| (e.line(), e.key())).collect();
    let line = |start: &str| 1 + WALL.lines().position(|l| l.starts_with(start)).unwrap();
    assert_eq!(
        lines,
        [
            (Some(line("mu =")), ""),
            (Some(line("courses =")), "wall.courses"),
            (Some(line("displacement =")), ""),
        ],
        "{found:?}"
    );
}

/// Snap-back of both materials, a distant probe, a tilt without gravity, and the warnings in addition.
#[test]
fn all_errors_of_physics_are_reported() {
    let probe = "[[probes]]\nname = \"far\"\nnear = [\"1 km\", 0, 0]\ndirection = \"x\"\n\n[wall]";
    let probe = probe.replace("\"1 km\"", "1e6");
    let text = changed(
        WALL,
        &[
            (
                "reference_length = \"31.4 mm\"",
                "reference_length = \"1 mm\"\ncrack_band = \"volume\"",
            ),
            (
                "reference_length = \"50 mm\"",
                "reference_length = \"1 mm\"\ncrack_band = \"volume\"",
            ),
            (
                "kind = \"preload\"\ntop_pressure = \"2.12 MPa\"",
                "kind = \"tilt\"\nangle = 3",
            ),
            ("mu = 0.75", "mu = 0.9"),
            ("[wall]", &probe),
        ],
    );
    let error = refused(&text);
    let mut keys: Vec<&str> = error.all().map(ModelError::key).collect();
    keys.dedup();
    assert_eq!(
        keys,
        [
            "materials.brick.tension",
            "materials.brick.compression",
            "materials.brick.density",
            "materials.mortar.tension",
            "materials.mortar.compression",
            "probes.0.near",
            "steps.0.kind",
        ]
    );
    assert!(
        error
            .warnings()
            .iter()
            .any(|w| w.key == "interfaces.joint.mu" && w.column == Some(6)),
        "{:?}",
        error.warnings()
    );
}

#[test]
fn errors_of_overrides_follow_those_of_the_file() {
    let set = |key: &str, value: &str| (key.to_owned(), value.to_owned());
    let text = changed(WALL, &[("courses = 18", "courses = 0")]);
    let overrides = [
        set("steps.7.displacement", "1"),
        set("materials.brick.nu", "\"much\""),
        set("materials.mortar.nu", "0.8"),
    ];
    let error = Deck::from_str_with(&text, "deck.toml", &overrides).unwrap_err();
    let files: Vec<&str> = error.all().map(ModelError::file).collect();
    assert_eq!(files[0], "deck.toml");
    for (key, _) in &overrides {
        assert!(
            files.contains(&format!("--set {key}").as_str()),
            "{files:?}"
        );
    }
    assert_eq!(files.len(), 4);
}

/// The placeholder values are valid: a deck with only wrong values is reported key by key.
#[test]
fn every_key_can_be_wrong_at_once() {
    let scene = format!("{HEAD}{PAIR}{GRAVITY}");
    for good in [WALL, scene.as_str()] {
        let keys: Vec<&str> = good.lines().filter(|l| !l.starts_with('#')).collect();
        let wrong = |line: &&str| {
            line.split_once(" = ")
                .map(|(key, _)| format!("{key} = 1970-01-01"))
        };
        let text: Vec<String> = keys
            .iter()
            .map(|line| wrong(line).unwrap_or_else(|| (*line).to_owned()))
            .collect();
        let count = text
            .iter()
            .filter(|line| line.ends_with("1970-01-01"))
            .count();
        let error = refused(&text.join("\n"));
        let lines: Vec<_> = error.all().filter_map(ModelError::line).collect();
        assert_eq!(lines.len(), count, "{error:?}");
        assert!(lines.is_sorted_by(|a, b| a < b), "{lines:?}");
    }
}
