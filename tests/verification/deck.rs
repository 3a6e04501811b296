//! Reading decks: units, defaults, overrides, round trips, the laws of single points.

use std::path::{Path, PathBuf};
use wythe::contact::Coupling;
use wythe::material::{Interpolation, MaterialParameters};
use wythe::model::deck::Subdivision;
use wythe::model::scene::{BeamMotion, ContactPoints, Formulation, Output, Procedure};
use wythe::model::{Deck, Model, check, keys};

const EXAMPLES: [&str; 4] = [
    "01_couplet_tension",
    "02_couplet_shear",
    "03_shear_wall_j7d",
    "04_shear_wall_j4d",
];

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name)
        .with_extension("toml")
}

fn load(name: &str, overrides: &[(&str, &str)]) -> Deck {
    let overrides: Vec<_> = overrides
        .iter()
        .map(|(k, v)| ((*k).into(), (*v).into()))
        .collect();
    Deck::load(path(name), &overrides).unwrap()
}

#[test]
fn every_example_builds_and_is_short() {
    for name in EXAMPLES {
        let deck = load(name, &[]);
        Model::from_deck(&deck).unwrap();
        let text = std::fs::read_to_string(path(name)).unwrap();
        let opening = "#:schema ../docs/deck.schema.json\n# ";
        assert!(
            text.starts_with(opening),
            "{name} opens with its schema and a drawing"
        );
        let lines = text
            .lines()
            .filter(|l| !l.is_empty() && !l.starts_with('#'))
            .count();
        assert!(lines <= 45, "{name} has {lines} lines");
        assert!(deck.materials.contains_key("brick") && deck.materials.contains_key("mortar"));
        assert!(deck.interfaces.contains_key("joint"));
    }
}

#[test]
fn a_deck_says_the_same_after_a_round_trip() {
    for name in EXAMPLES {
        let deck = load(name, &[]);
        let text = deck.to_toml().unwrap();
        let again = Deck::from_str(&text, "again.toml").unwrap();
        assert_eq!(deck, again, "{text}");
        assert_eq!(text, again.to_toml().unwrap());
    }
    let changed = load("03_shear_wall_j7d", &[("materials.brick.nu", "0.16")]);
    assert_ne!(changed, load("03_shear_wall_j7d", &[]));
}

#[test]
fn strings_with_units_equal_bare_numbers() {
    let with_units = load("03_shear_wall_j7d", &[]);
    for (key, value) in [
        ("materials.brick.E", "16.7 GPa"),
        ("materials.brick.E", "16700 N/mm^2"),
        ("materials.brick.E", "16700"),
        ("materials.mortar.reference_length", "3.14 cm"),
        ("interfaces.joint.u_k", "360 um"),
        ("wall.length", "0.99 m"),
        ("wall.unit", "[204, \"9.8 cm\", 50.0]"),
        ("steps.0.top_pressure", "2120 kN/m²"),
        ("materials.brick.dilation_angle", "10"),
        ("materials.brick.tension.1.1", "0.2 %"),
        ("wall.mesh", "[5, 2, 2]"),
        ("steps.1.vertical", "\"locked\""),
    ] {
        let mut same = load("03_shear_wall_j7d", &[(key, value)]);
        // what is a default may now be said
        same.steps[1].vertical = with_units.steps[1].vertical;
        assert_eq!(same, with_units, "{key} = {value}");
    }
}

#[test]
fn defaults_are_those_of_the_documentation() {
    let deck = load("03_shear_wall_j7d", &[]);
    let MaterialParameters::DamagePlasticity(p) = deck.material("brick").unwrap() else {
        panic!("the brick has tables")
    };
    assert_eq!(p.dilation_angle, 10.0_f64.to_radians());
    assert_eq!([p.eccentricity, p.fb0_fc0, p.k_c], [0.1, 1.16, 2.0 / 3.0]);
    assert_eq!(
        [p.tension_recovery, p.compression_recovery, p.viscosity],
        [0.0, 1.0, 0.0]
    );
    assert_eq!(p.interpolation, Interpolation::Eff1);
    assert_eq!(p.reference_length, Some(50.0));
    assert_eq!(p.tension[1].inelastic_strain, 0.002);
    assert_eq!(p.compression[2].damage, 0.95);
    assert_eq!(deck.wall.as_ref().unwrap().mesh, Subdivision::COARSE);
    let (model, _) = Model::from_deck(&deck).unwrap();
    assert_eq!(model.formulation, Formulation::Incompatible);
    assert_eq!(model.contact.points, ContactPoints::Gauss);
    let step = &model.steps[1];
    assert_eq!(step.procedure, Procedure::Auto);
    assert_eq!((step.duration, step.tolerance.residual), (1.0, 5e-2));
    assert_eq!(step.tolerance.max_iterations, 25);
    assert_eq!(model.output, Output::default());
    assert_eq!(model.output.every, 5);
    let [elastic, none] =
        ["tension", "compression"].map(|t| (format!("materials.brick.{t}"), "[]"));
    let elastic = load(
        "03_shear_wall_j7d",
        &[(&elastic.0, elastic.1), (&none.0, none.1)],
    );
    assert!(
        matches!(elastic.material("brick").unwrap(), MaterialParameters::Elastic(e) if e.E == 16700.0)
    );
}

#[test]
fn steps_move_the_beam_as_in_the_tests() {
    let area = 990.0 * 98.0;
    let (model, _) = Model::from_deck(&load("03_shear_wall_j7d", &[])).unwrap();
    let [preload, drive] = &model.steps[..] else {
        panic!("two steps")
    };
    use BeamMotion::{Driven, Force, Locked};
    assert_eq!(preload.motion, [[Locked, Locked, Force(-2.12 * area)]]);
    assert_eq!(drive.motion, [[Driven(4.0), Locked, Locked]]);
    assert_eq!([preload.driven, drive.driven], [Some((0, 0)), Some((0, 0))]);

    let (model, _) = Model::from_deck(&load(
        "03_shear_wall_j7d",
        &[("steps.1.vertical", "free"), ("steps.1.direction", "-x")],
    ))
    .unwrap();
    assert_eq!(
        model.steps[1].motion,
        [[Driven(-4.0), Locked, Force(-2.12 * area)]]
    );

    let (model, _) = Model::from_deck(&load("01_couplet_tension", &[])).unwrap();
    for (step, by) in model.steps.iter().zip([0.006, 0.25]) {
        assert_eq!(step.motion, [[Locked, Locked, Driven(by)]]);
        assert_eq!(step.driven, Some((0, 2)));
    }
}

#[test]
fn an_experiment_is_read_beside_the_deck() {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("wall.toml");
    let text = std::fs::read_to_string(path("01_couplet_tension")).unwrap();
    let output = "\n[output]\nmcap = false\nscene_every = 3\nexperiment = \"test.csv\"\n";
    std::fs::write(&deck, text + output).unwrap();
    let build = |csv: Option<&str>| {
        let file = folder.path().join("test.csv");
        match csv {
            Some(csv) => std::fs::write(file, csv).unwrap(),
            None => drop(std::fs::remove_file(file)),
        }
        let deck = Deck::load(&deck, &[]).unwrap();
        Model::from_deck(&deck).map(|(model, _)| model.output)
    };
    let csv = "# couplet\nu_displacement_mm,force_kN\n0,0\n0.01,4.5\n";
    let output = build(Some(csv)).unwrap();
    assert!(!output.mcap && output.scene_every == 3);
    let experiment = output.experiment.unwrap();
    assert_eq!((&*experiment.file, &*experiment.text), ("test.csv", csv));
    assert_eq!(experiment.curve.points, [(0.0, 0.0), (0.01, 4.5)]);
    for (csv, part) in [
        (None, "test.csv: "),
        (
            Some("displacement_mm,force_kN\n0,0\n0.01;4.5\n"),
            "test.csv:3: `0.01;4.5` in the column",
        ),
        (Some("displacement_mm,force_kN\n0,0\n"), "two rows"),
    ] {
        let error = build(csv).unwrap_err();
        assert_eq!(error.key(), "output.experiment");
        assert!(error.message().contains(part), "{error}");
        assert!(error.line().is_some() && !error.advice().is_empty());
    }
    let never = [("output.scene_every".to_owned(), "0".to_owned())];
    let wythe::error::DeckError::Model(error) = Deck::load(&deck, &never).unwrap_err() else {
        panic!("the model is wrong")
    };
    assert_eq!(error.key(), "output.scene_every");
}

#[test]
fn overrides_reach_every_depth() {
    let deck = load(
        "04_shear_wall_j4d",
        &[
            ("steps.1.increments.max", "0.02"),
            ("steps.1.increments.initial", "0.01"),
            ("element.formulation", "b-bar"),
            (
                "contact",
                "{ points = \"corner\", search_radius = \"5 mm\" }",
            ),
            ("interfaces.joint.coupling", "additive"),
            ("output.every", "1"),
        ],
    );
    let (model, _) = Model::from_deck(&deck).unwrap();
    let sizes = model.steps[1].increments;
    assert_eq!([sizes.initial, sizes.max, sizes.min], [0.01, 0.02, 1e-6]);
    assert_eq!(model.formulation, Formulation::BBar);
    assert_eq!(model.contact.points, ContactPoints::Corner);
    assert_eq!(model.contact.search_radius, Some(5.0));
    assert!(
        model
            .contact
            .laws
            .iter()
            .all(|l| l.coupling == Coupling::Additive)
    );
    assert_eq!(model.output.every, 1);
    // the later of two wins
    let twice = load(
        "04_shear_wall_j4d",
        &[("wall.courses", "4"), ("wall.courses", "6")],
    );
    assert_eq!(twice.wall.unwrap().courses, 6);
}

#[test]
fn an_override_replaces_the_other_of_a_pair() {
    let deck = load("01_couplet_tension", &[("interfaces.joint.G_I", "12 N/m")]);
    let joint = &deck.interfaces["joint"];
    assert_eq!(joint.u_k, None);
    // theory C.7: G_I = f_t u_k × 0.215626 (six digits)
    assert!((joint.ultimate_opening() - 0.012 / (0.28 * 0.215626)).abs() < 1e-6);
    assert!((joint.mode_1_energy() - 0.012).abs() < 1e-15);
    // and the other way round, in both modes
    let text = std::fs::read_to_string(path("01_couplet_tension")).unwrap();
    let energies = text
        .replace("u_k = \"0.20 mm\"", "G_I = \"12 N/m\"")
        .replace("delta_k = \"0.4 mm\"", "G_II = \"58 N/m\"");
    let lengths = [("u_k", "0.1"), ("delta_k", "0.3 mm")]
        .map(|(k, v)| (format!("interfaces.joint.{k}"), v.to_owned()));
    let deck = Deck::from_str_with(&energies, "energies.toml", &lengths).unwrap();
    let joint = &deck.interfaces["joint"];
    assert_eq!((joint.G_I, joint.G_II), (None, None));
    assert_eq!(
        (joint.ultimate_opening(), joint.ultimate_slip()),
        (0.1, 0.3)
    );
}

#[test]
fn wrong_overrides_name_themselves() {
    let text = std::fs::read_to_string(path("03_shear_wall_j7d")).unwrap();
    let error = |key: &str, value: &str| {
        Deck::from_str_with(&text, "j7d.toml", &[(key.into(), value.into())]).unwrap_err()
    };
    for (key, value, at, message) in [
        (
            "materials.brick.E",
            "4 mm",
            "materials.brick.E",
            "found \"4 mm\" (a length)",
        ),
        (
            "materials.brick.E",
            "-3",
            "materials.brick.E",
            "-3 is not positive",
        ),
        (
            "materials.brick.E",
            "true",
            "materials.brick.E",
            "expected a pressure",
        ),
        (
            "materials.brick.poisson",
            "0.2",
            "materials.brick.poisson",
            "not a known key",
        ),
        (
            "elemnt.formulation",
            "full",
            "elemnt",
            "`elemnt` is not a known key",
        ),
        (
            "steps.7.displacement",
            "1",
            "steps.7.displacement",
            "`steps` has 2 entries",
        ),
        (
            "steps.first.displacement",
            "1",
            "steps.first.displacement",
            "`steps` has 2 entries",
        ),
        (
            "format.x",
            "1",
            "format.x",
            "`format` is no table: it has no `x`",
        ),
        ("wall..length", "1", "wall..length", "not a dotted path"),
        ("", "1", "", "not a dotted path"),
        (
            "wall.courses",
            "18\nformat = 2",
            "wall.courses",
            "invalid type: string",
        ),
    ] {
        let error = error(key, value);
        assert_eq!(error.file(), format!("--set {key}"), "{error}");
        assert_eq!(error.key(), at);
        assert_eq!(error.line(), Some(1));
        assert!(
            error.message().contains(message),
            "{key}: {}",
            error.message()
        );
    }
    // the column counts in KEY=VALUE
    assert_eq!(
        error("materials.brick.E", "4 mm").column(),
        Some("materials.brick.E=".len() + 1)
    );
    // an error of the file stays one, whatever is overridden
    let broken = text.replace("courses = 18", "courses = 0");
    let overrides = [("wall.length".to_owned(), "1100 mm".to_owned())];
    let error = Deck::from_str_with(&broken, "j7d.toml", &overrides).unwrap_err();
    assert_eq!((error.file(), error.key()), ("j7d.toml", "wall.courses"));
}

#[test]
fn single_points_need_explicit_stiffnesses() {
    let error = load("03_shear_wall_j7d", &[])
        .interface("joint")
        .unwrap_err();
    assert!(error.message().contains("explicit stiffnesses") && error.line().is_some());
    let deck = load(
        "03_shear_wall_j7d",
        &[
            ("interfaces.joint.normal_stiffness", "34000"),
            ("interfaces.joint.shear_stiffness", "14783 N/mm^3"),
        ],
    );
    let law = deck.interface("joint").unwrap();
    assert_eq!(
        [law.normal_stiffness, law.shear_stiffness],
        [34000.0, 14783.0]
    );
    assert_eq!(
        [law.f_t, law.c, law.tan_phi, law.mu],
        [0.20, 0.22, 0.75, 0.75]
    );
    assert_eq!(
        [law.u_k, law.delta_k, law.zeta, law.xi],
        [0.36, 0.4, 4.38, 1.1]
    );
    assert!(
        deck.interface("jiont")
            .unwrap_err()
            .advice()
            .contains("did you mean `joint`?")
    );
    assert!(
        deck.material("morter")
            .unwrap_err()
            .advice()
            .contains("did you mean `mortar`?")
    );
    // a deck of materials alone serves to drive points
    let alone = "format = 1\n[materials.brick]\nE = 1\nnu = 0\n";
    assert!(
        Deck::from_str(alone, "alone.toml")
            .unwrap()
            .material("brick")
            .is_ok()
    );
}

#[test]
fn energies_are_those_of_the_theory() {
    // theory C.7's table [N/m]: two digits after the point for G_I, one for G_II
    for (name, g_1, g_2) in [
        ("01_couplet_tension", 12.08, [142.7, 147.3, 165.7, 188.7]),
        ("03_shear_wall_j7d", 15.53, [36.1; 4]),
    ] {
        let deck = load(name, &[]);
        let joint = &deck.interfaces["joint"];
        assert!((1e3 * joint.mode_1_energy() - g_1).abs() < 0.005, "{name}");
        for (sigma, g_2) in [0.0, -0.1, -0.5, -1.0].into_iter().zip(g_2) {
            assert!(
                (1e3 * joint.mode_2_energy(sigma) - g_2).abs() < 0.05,
                "{name}, {sigma} MPa"
            );
        }
    }
}

#[test]
fn the_checker_reports_sizes_energies_and_warnings() {
    let deck = load("03_shear_wall_j7d", &[]);
    let (model, warnings) = Model::from_deck(&deck).unwrap();
    let report = check(&deck, &model);
    assert_eq!(report.warnings, warnings);
    assert_eq!((report.sizes.units, report.sizes.elements), (90, 1540));
    assert_eq!(
        report.sizes.contact_points,
        4 * model.contact.slave_facets.len()
    );
    // Measured peak of a run: 126 MB; 558 MB with the fine mesh. Within half as much again.
    let of_fine = |d: Deck| check(&d, &Model::from_deck(&d).unwrap().0).memory_mb;
    let fine = of_fine(load("03_shear_wall_j7d", &[("wall.mesh", "fine")]));
    for (estimate, measured) in [(report.memory_mb, 126.0), (fine, 558.0)] {
        let ratio = estimate / measured;
        assert!(
            ratio < 1.5 && ratio > 1.0 / 1.5,
            "{estimate} MB for {measured} MB"
        );
    }
    let text = report.to_string();
    for part in [
        "G_I = 15.53 N/m",
        "G_II = 36.09 N/m",
        "90 units, 1540 elements",
        "pivots",
        "lap 80.00 mm",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }

    let key_of = |overrides: &[(&str, &str)]| -> Vec<String> {
        let deck = load("02_couplet_shear", overrides);
        let (_, warnings) = Model::from_deck(&deck).unwrap();
        warnings.into_iter().map(|w| w.key).collect()
    };
    assert!(key_of(&[]).is_empty());
    assert_eq!(
        key_of(&[("interfaces.joint.mu", "1.1")]),
        ["interfaces.joint.mu"]
    );
    assert_eq!(
        key_of(&[("interfaces.joint.f_t", "0.9")]),
        ["interfaces.joint.f_t"]
    );
    // theory C.5: Table 1 snaps back below k_n = .28 × 4.38/(.2 (1 − e^−4.38)) = 6.21, k_s = 3.59
    let soft = |n: &str, s: &str| {
        key_of(&[
            ("interfaces.joint.normal_stiffness", n),
            ("interfaces.joint.shear_stiffness", s),
        ])
    };
    assert!(soft("6.22", "3.60").is_empty());
    assert_eq!(
        soft("6.20", "3.58"),
        [
            "interfaces.joint.normal_stiffness",
            "interfaces.joint.shear_stiffness"
        ]
    );
    let text = std::fs::read_to_string(path("03_shear_wall_j7d")).unwrap();
    let unscaled = text.replace("reference_length = \"50 mm\"\n", "");
    let (_, warnings) =
        Model::from_deck(&Deck::from_str(&unscaled, "unscaled.toml").unwrap()).unwrap();
    assert!(
        warnings[0].message.contains("scaling is off"),
        "{}",
        warnings[0]
    );
    assert_eq!(warnings[0].key, "materials.brick");
    let line = unscaled
        .lines()
        .position(|l| l == "[materials.brick]")
        .unwrap()
        + 1;
    assert_eq!(warnings[0].line, Some(line));
}

/// The in-plane mortar table is inadmissible as printed: damage 0.93865 at most (theory A.5). In
/// another element the strains beyond the peak are others, and so is the cap.
#[test]
fn capped_damage_names_its_row() {
    let deck = load("03_shear_wall_j7d", &[]);
    let (_, warnings) = Model::from_deck(&deck).unwrap();
    let keys: Vec<&str> = warnings.iter().map(|w| w.key.as_str()).collect();
    assert_eq!(keys, ["materials.mortar.tension.1.2"]);
    let message = &warnings[0].message;
    for part in [
        "row 2: the damage 0.95 is inadmissible",
        "in elements of 33.6 mm",
    ] {
        assert!(message.contains(part), "{part} is not in {message}");
    }
    // A point has no size: the table as given.
    let (_, warnings) = deck.law("mortar", None).unwrap();
    assert_eq!(warnings.len(), 1);
    assert!(
        warnings[0].message.contains("capped to 0.9387"),
        "{}",
        warnings[0]
    );
    // With the out-of-plane modulus the same table is admissible.
    let stiff = load("03_shear_wall_j7d", &[("materials.mortar.E", "2300")]);
    let (_, warnings) = Model::from_deck(&stiff).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn through_joints_and_slivers_are_noticed() {
    let warned = |length: &str| -> Vec<String> {
        let deck = load("03_shear_wall_j7d", &[("wall.length", length)]);
        let (_, warnings) = Model::from_deck(&deck).unwrap();
        warnings.into_iter().map(|w| w.message).collect()
    };
    assert!(
        warned("990 mm")
            .iter()
            .all(|w| !w.contains("sliver") && !w.contains("bond"))
    );
    // 4 whole units and 20 mm: a sliver whose head joints nearly coincide, 32.5 mm apart
    assert!(
        warned("886 mm")
            .iter()
            .any(|w| w.contains("slivers of 20.00 mm"))
    );
    // 4 whole units and 200 mm
    assert!(
        warned("1066 mm")
            .iter()
            .any(|w| w.contains("4.00 mm apart"))
    );
}

#[test]
fn dry_joints_need_no_softening() {
    let text = std::fs::read_to_string(path("02_couplet_shear")).unwrap();
    let joint = text.find("[interfaces.joint]").unwrap()..text.find("[wall]").unwrap();
    let mut dry = text.clone();
    dry.replace_range(
        joint,
        "[interfaces.joint]\nf_t = 0\nc = 0\ntan_phi = 0.7\nmu = 0.7\n\n",
    );
    let deck = Deck::from_str(&dry, "dry.toml").unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    assert!(
        model
            .contact
            .laws
            .iter()
            .all(|l| l.f_t == 0.0 && l.c == 0.0 && l.mu == 0.7)
    );
}

#[test]
fn the_documentation_lists_every_key() {
    let reference = include_str!("../../docs/deck.md");
    for (key, example) in keys::EXAMPLES {
        // `table.key` where a key means different things in different tables
        let key = key.rsplit('.').next().unwrap();
        assert!(
            reference.contains(&format!("`{key}`")),
            "docs/deck.md lacks `{key}`"
        );
        assert!(
            example.contains(key),
            "the example of {key} shows another key"
        );
    }
}

#[test]
fn absurd_sizes_are_refused_before_they_are_built() {
    let text = std::fs::read_to_string(path("03_shear_wall_j7d")).unwrap();
    for (key, value, at) in [
        ("wall.length", "1e300", "wall.length"),
        ("wall.head_joint", "1e300", "wall.head_joint"),
        ("wall.bed_joint", "\"12.5 um\"", "wall.bed_joint"),
        ("wall.unit.1", "1e-300", "wall.unit.1"),
        ("wall.courses", "4000000000", "wall.courses"),
        (
            "wall.mesh",
            "[4000000000, 4000000000, 4000000000]",
            "wall.mesh",
        ),
    ] {
        let error = Deck::from_str_with(&text, "j7d.toml", &[(key.into(), value.into())])
            .and_then(|deck| Model::from_deck(&deck))
            .unwrap_err();
        assert_eq!(error.key(), at, "{error}");
        assert_eq!(error.file(), format!("--set {key}"));
    }
}
