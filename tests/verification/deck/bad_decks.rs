//! Every invalid deck gives an error with file, line, key, reason and fix.

use std::path::Path;
use wythe::deck::Deck;
use wythe::error::{DeckError, ModelError};
use wythe::model::Model;

/// The error of `tests/data/bad/NAME.toml`, read and built.
fn error_of(name: &str) -> ModelError {
    let file = format!("tests/data/bad/{name}.toml");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(&file);
    let text = std::fs::read_to_string(path).expect("the test's own file");
    Deck::from_str(&text, &file)
        .and_then(|deck| Model::from_deck(&deck))
        .expect_err("the deck is bad")
}

/// (file, key, text of the line, part of the message, part of the advice)
const CASES: &[(&str, &str, &str, &str, &str)] = &[
    (
        "pressed_face_held",
        "steps.0.face",
        "face = \"b.top\"",
        "the support on b.top holds all of b.top in z, in which step 0 (preload) presses it",
        "`fixed` of the support",
    ),
    (
        "free_direction_held",
        "steps.0.free",
        "free = [\"x\"]",
        "the support on b.top holds all of b.top in x, in which step 0 (preload) leaves it free",
        "out of `free`",
    ),
    (
        "stiff_block",
        "materials.stone.E",
        "E = 5e12",
        "E = 5e12 MPa of stone is too stiff for step 0 (free)",
        "rigid = true",
    ),
    (
        "triplet_without_supports",
        "steps.0",
        "[[steps]]",
        "nothing holds left and 2 other bodies in x in step 0 (preload)",
        "[[supports]]",
    ),
    (
        "wrong_key",
        "materials.brick.poisson",
        "poisson = 0.15",
        "`poisson` is not a known key",
        "known here: kind, name, f_b, E, nu",
    ),
    (
        "misspelt_key",
        "materials.brick.referenc_length",
        "referenc_length = \"50 mm\"",
        "not a known key",
        "did you mean `reference_length`?",
    ),
    (
        "wrong_type",
        "materials.mortar.E",
        "E = true",
        "expected a pressure (MPa)",
        "E = \"16.7 GPa\"",
    ),
    (
        "wrong_type_row",
        "materials.brick.tension.1",
        "tension = [[3.5",
        "expected a row [stress, inelastic strain, damage]",
        "tension = [[",
    ),
    (
        "wrong_unit",
        "materials.mortar.E",
        "E = \"4 mm\"",
        "expected a pressure (MPa), found \"4 mm\" (a length)",
        "E = \"16.7 GPa\"",
    ),
    (
        "unknown_unit",
        "wall.length",
        "length = \"990 inch\"",
        "\"inch\" is not a known unit",
        "length = \"990 mm\"",
    ),
    (
        "missing_key",
        "materials.brick.nu",
        "[materials.brick]",
        "the key `nu` is missing",
        "nu = 0.15",
    ),
    (
        "missing_format",
        "format",
        "title",
        "the key `format` is missing",
        "format = 1",
    ),
    (
        "newer_format",
        "format",
        "format = 2",
        "format 2 is not known",
        "format = 1",
    ),
    (
        "missing_table",
        "materials.mortar.tension",
        "tension = [[1.5",
        "the table `compression` is missing",
        "linear elasticity",
    ),
    (
        "negative_modulus",
        "materials.brick.E",
        "E = \"-16700 MPa\"",
        "-16700 is not positive",
        "above 0",
    ),
    (
        "non_monotone_strain",
        "materials.brick.compression.2.1",
        "compression = [[11.0",
        "row 3: the inelastic strain 0.001 does not grow beyond 0.007",
        "order the rows",
    ),
    (
        "fall_before_peak",
        "materials.brick.compression.1.0",
        "compression = [[11.0",
        "row 2: the stress falls to 10.5 before the peak of 11.5 in row 3",
        "rise to one peak",
    ),
    (
        "damage_beyond_cap",
        "materials.brick.compression.2.2",
        "compression = [[11.0",
        "row 3: the damage 0.45 is inadmissible",
        "lower the damage",
    ),
    (
        "inadmissible_damage",
        "materials.mortar.compression.2.2",
        "compression = [[7.8",
        "row 3: the damage 1 is not admissible",
        "0.95",
    ),
    (
        "healing_damage",
        "materials.mortar.compression.2.2",
        "compression = [[7.8",
        "row 3: the damage falls from 0.96 to 0.95",
        "never heals",
    ),
    (
        "length_over_limit",
        "materials.mortar.tension",
        "tension = [[1.5",
        "over the limit of 30.4 mm",
        "refine wall.mesh",
    ),
    (
        "unit_longer_than_wall",
        "wall.unit",
        "unit = [\"204 mm\"",
        "longer than the wall (150 mm)",
        "lengthen the wall",
    ),
    (
        "length_ends_in_joint",
        "wall.length",
        "length = \"857 mm\"",
        "ends within a head joint",
        "853.5 mm",
    ),
    (
        "zero_subdivision",
        "wall.mesh",
        "mesh = [5, 0, 2]",
        "[5, 0, 2] leaves no element",
        "[2, 2, 1]",
    ),
    (
        "unknown_mesh",
        "wall.mesh",
        "mesh = \"medium\"",
        "expected \"coarse\", \"fine\" or",
        "mesh = \"coarse\"",
    ),
    (
        "unconstrained_body",
        "interfaces.joint",
        "[interfaces.joint]",
        "is held by nothing",
        "give mu above 0",
    ),
    (
        "unpressed_dry_joints",
        "steps.0",
        "[[steps]]",
        "no load presses them",
        "begin with a preload",
    ),
    (
        "bonded_general_contact",
        "contact.general",
        "general = \"joint\"",
        "joint is bonded, and bodies that meet later have nothing between them",
        "f_t = 0 and c = 0",
    ),
    (
        "unknown_material",
        "wall.mortar_material",
        "mortar_material = \"morter\"",
        "no material named `morter`",
        "did you mean `mortar`?",
    ),
    (
        "unknown_interface",
        "wall.interface",
        "interface = \"glue\"",
        "no interface named `glue`",
        "the deck has joint",
    ),
    (
        "both_opening_and_energy",
        "interfaces.joint.G_I",
        "G_I = \"12 N/m\"",
        "both `u_k` and `G_I` are given",
        "leave out one",
    ),
    (
        "neither_slip_nor_energy",
        "interfaces.joint.delta_k",
        "[interfaces.joint]",
        "neither `delta_k` nor `G_II`",
        "delta_k = ",
    ),
    (
        "one_stiffness",
        "interfaces.joint.normal_stiffness",
        "normal_stiffness = 34000",
        "without the other",
        "give both",
    ),
    (
        "pressure_in_drive",
        "steps.1.top_pressure",
        "top_pressure = 1",
        "belongs to a preload",
        "leave it out",
    ),
    (
        "missing_displacement",
        "steps.1.displacement",
        "[[steps]]",
        "the key `displacement` is missing",
        "displacement = \"4 mm\"",
    ),
    (
        "all_clamped",
        "wall.clamped",
        "clamped = {",
        "9 courses held and 10 driven are too many of 18",
        "clamp fewer",
    ),
    (
        "increments_out_of_order",
        "steps.1.increments",
        "increments = {",
        "are not in order",
        "0 < min <= initial",
    ),
];

#[test]
fn each_names_key_line_reason_and_fix() {
    for &(name, key, line, message, help) in CASES {
        let error = error_of(name);
        let file = format!("tests/data/bad/{name}.toml");
        let text =
            std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(&file)).unwrap();
        let found = error
            .line()
            .unwrap_or_else(|| panic!("{name}: {error} has no line"));
        let found = text.lines().nth(found - 1).unwrap();
        assert_eq!(error.file(), file);
        assert!(
            error.message().contains(message),
            "{name}: {}",
            error.message()
        );
        assert!(found.starts_with(line), "{name}: points at `{found}`");
        assert!(error.advice().contains(help), "{name}: {}", error.advice());
        assert_eq!(error.key(), key, "{name}");
        // The intended key is also reported as missing.
        let others = error
            .others()
            .iter()
            .filter(|e| name != "wrong_key" || e.key() != "materials.brick.nu");
        assert_eq!(others.count(), 0, "{name}: {:?}", error.others());
    }
}

#[test]
fn every_bad_deck_is_tried() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/bad");
    let elsewhere = ["syntax", "missing_wall", "no_steps", "several"];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let tried = CASES.iter().any(|c| c.0 == name) || elsewhere.contains(&name.as_str());
        assert!(tried, "{name} has no test");
    }
}

#[test]
fn columns_point_at_the_value() {
    let error = error_of("wrong_unit");
    // E = "4 mm": the value begins in the fifth column
    assert_eq!(error.column(), Some(5));
    let error = error_of("inadmissible_damage");
    // compression = [[7.8, 0, 0], [8.2, 0.002, 0], [0.4, 0.015, 1.0]]
    assert_eq!(
        error.column(),
        Some(1 + "compression = [[7.8, 0, 0], [8.2, 0.002, 0], [0.4, 0.015, ".len())
    );
}

#[test]
fn invalid_toml_is_reported_with_its_place() {
    let error = error_of("syntax");
    let text = include_str!("../../data/bad/syntax.toml");
    let line = 1 + text.lines().position(|l| l == "mu = ").unwrap();
    assert_eq!(error.line(), Some(line), "{error}");
    assert!(error.advice().contains("no TOML"));
}

#[test]
fn a_deck_without_wall_or_steps_has_nothing_to_build() {
    let wall = error_of("missing_wall");
    assert_eq!(wall.key(), "wall");
    assert!(wall.message().contains("the table [wall] is missing"));
    let steps = error_of("no_steps");
    assert_eq!(steps.key(), "steps");
    assert!(steps.message().contains("there are no steps"));
}

#[test]
fn all_errors_of_a_deck_come_at_once() {
    let error = error_of("several");
    let keys: Vec<&str> = std::iter::once(&error)
        .chain(error.others())
        .map(ModelError::key)
        .collect();
    assert_eq!(
        keys,
        ["materials.brick.nu", "materials.mortar.E", "wall.courses"]
    );
}

#[test]
fn a_missing_file_is_not_a_bad_model() {
    let error = Deck::load("tests/data/bad/no_such_deck.toml", &[]).unwrap_err();
    let DeckError::Io(error) = error else {
        panic!("{error} is no input/output error")
    };
    assert_eq!(error.why.kind(), std::io::ErrorKind::NotFound);
}

#[test]
fn errors_are_drawn_with_file_line_and_help() {
    let error = error_of("wrong_unit");
    let mut drawn = String::new();
    miette::NarratableReportHandler::new()
        .render_report(&mut drawn, &error)
        .unwrap();
    for part in [
        "materials.mortar.E",
        "wrong_unit.toml",
        "E = \"4 mm\"",
        "write it like this",
    ] {
        assert!(drawn.contains(part), "{part} is not in\n{drawn}");
    }
}
