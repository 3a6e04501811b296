//! Reading decks: units, defaults, overrides, round trips, laws of single points.

use crate::common::examples::{load, path};
use wythe::contact::{Coupling, InterfaceLaw};
use wythe::deck::schema::Subdivision;
use wythe::deck::{Deck, keys};
use wythe::element::Formulation;
use wythe::material::{Interpolation, MaterialParameters};
use wythe::model::Model;
use wythe::model::scene::{BeamMotion, ContactPoints, Output, Procedure};

const EXAMPLES: [&str; 4] = [
    "01_couplet_tension",
    "02_couplet_shear",
    "03_shear_wall_j7d",
    "04_shear_wall_j4d",
];

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
        // written defaults are equal to omitted ones
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
    assert_eq!(model.contact.points, ContactPoints::Auto);
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
    assert_eq!(
        [preload.driven, drive.driven],
        [Some(wythe::model::scene::Driven::along(0, 0)); 2]
    );

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
        assert_eq!(step.driven, Some(wythe::model::scene::Driven::along(0, 2)));
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
    // A copy in another folder finds the file at the original place, as `wythe resume` needs for the deck in a run's
    // folder.
    std::fs::write(folder.path().join("test.csv"), csv).unwrap();
    let copy = folder.path().join("wall.out");
    std::fs::create_dir(&copy).unwrap();
    let copy = copy.join("model.toml");
    std::fs::copy(&deck, &copy).unwrap();
    let copied = Deck::load(&copy, &[]).unwrap();
    assert!(Model::from_deck(&copied).is_err());
    let found = Model::from_deck(&copied.in_folder(folder.path().into()));
    assert!(found.unwrap().0.output.experiment.is_some());
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
                "{ points = \"corner\", parts = [2, 1, 1], search_radius = \"5 mm\" }",
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
    // Bed joints have two parts per facet; head joints, which are normal to x, have one.
    let whole = model.contact.whole_slaves().count();
    assert!((whole + 1..2 * whole).contains(&model.contact.slave_facets.len()));
    assert!(
        model
            .contact
            .laws
            .iter()
            .filter_map(InterfaceLaw::as_cohesive_frictional)
            .all(|l| l.coupling == Coupling::Additive)
    );
    assert_eq!(model.output.every, 1);
    // the last override wins
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
    // theory/joint.md, eq. 30: G_I = f_t u_k × 0.215626 (six digits)
    assert!((joint.ultimate_opening() - 0.012 / (0.28 * 0.215626)).abs() < 1e-6);
    assert!((joint.mode_1_energy() - 0.012).abs() < 1e-15);
    // and the inverse, in both modes
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
    // columns are counted in KEY=VALUE
    assert_eq!(
        error("materials.brick.E", "4 mm").column(),
        Some("materials.brick.E=".len() + 1)
    );
    // an error of the file remains an error if another key is overridden
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
    let law = law.as_cohesive_frictional().unwrap();
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
    // a deck with only materials can drive points
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
    // theory/joint.md, table below eq. 31 [N/m]: two decimals for G_I, one for G_II
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
            .filter_map(InterfaceLaw::as_cohesive_frictional)
            .all(|l| l.f_t == 0.0 && l.c == 0.0 && l.mu == 0.7)
    );
}

#[test]
fn the_documentation_lists_every_key() {
    let reference = include_str!("../../../docs/reference/deck.md");
    for (key, example) in keys::examples() {
        // `table.key` if a key has different meanings in different tables
        let key = key.rsplit('.').next().unwrap();
        assert!(
            reference.contains(&format!("`{key}`")),
            "docs/reference/deck.md lacks `{key}`"
        );
        assert!(
            example.contains(key),
            "the example of {key} shows another key"
        );
    }
}
