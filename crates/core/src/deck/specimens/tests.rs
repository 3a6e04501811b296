//! Every test writes decks that are models, with any unit.

use super::*;
use crate::deck::Deck;
use crate::model::Model;

fn options(unit: Option<&str>) -> Options {
    Options {
        unit: unit.map(str::to_owned),
        ..Options::default()
    }
}

fn model(text: &str) -> (Deck, Model) {
    let deck = Deck::from_str_with(text, "test.toml", &[])
        .unwrap_or_else(|error| panic!("{error:?}\n{text}"));
    let (model, _) = Model::from_deck(&deck).unwrap_or_else(|error| panic!("{error:?}\n{text}"));
    (deck, model)
}

#[test]
fn every_test_is_a_model_with_units_of_any_size() {
    for test in &TESTS {
        for unit in [None, Some("210x100x60"), Some("440x215x140")] {
            let decks = test.decks(&options(unit)).unwrap();
            assert!(!decks.is_empty());
            for deck in decks {
                let (deck, _) = model(&deck.text);
                assert_eq!(deck.test.unwrap().kind, test.kind, "{}", test.name);
            }
        }
    }
}

#[test]
fn each_precompression_gives_a_deck() {
    let test = find("en1052-3").unwrap();
    let parts = |options: &Options| -> Vec<String> {
        test.decks(options)
            .unwrap()
            .into_iter()
            .map(|deck| deck.part)
            .collect()
    };
    assert_eq!(parts(&Options::default()), ["0.2", "0.6", "1"]);
    let one = Options {
        precompression: Some("300 kPa".to_owned()),
        ..Options::default()
    };
    assert_eq!(parts(&one), [""]);
}

#[test]
fn options_that_a_test_does_not_have_are_named() {
    let refused = |name: &str, options: Options| {
        let error = find(name).unwrap().decks(&options).unwrap_err();
        error.to_string()
    };
    let with = |change: fn(&mut Options)| {
        let mut options = Options::default();
        change(&mut options);
        options
    };
    let said = refused(
        "couplet-tension",
        with(|o| o.precompression = Some("1".to_owned())),
    );
    assert!(
        said.starts_with("--precompression: couplet-tension has no"),
        "{said}"
    );
    let said = refused("en1052-3", with(|o| o.size = Some("1000x1000".to_owned())));
    assert!(
        said.starts_with("--size: the specimen of en1052-3"),
        "{said}"
    );
    let said = refused("astm-e519", with(|o| o.size = Some("100x1000".to_owned())));
    assert!(
        said.starts_with("--size: 100 x 1000 mm holds no unit"),
        "{said}"
    );
    let said = refused(
        "en1052-3",
        with(|o| o.precompression = Some("0.2, 0.2".to_owned())),
    );
    assert!(said.contains("one twice"), "{said}");
    let said = refused("en1052-3", with(|o| o.joint = Some("0".to_owned())));
    assert!(said.contains("mortar joints"), "{said}");
    let said = refused(
        "en1052-1",
        with(|o| o.materials = Some("[materials.stuff]\nE = 1".to_owned())),
    );
    assert!(said.contains("the file has: stuff"), "{said}");
}

#[test]
fn materials_of_a_file_are_taken_by_their_names() {
    let file = "title = \"other\"\n[materials.brick]\nE = 1000\nnu = 0.2\n[materials.mortar]\nE = 500\nnu = 0.2\n\
                [interfaces.joint]\nf_t = 0.2\nc = 0.3\ntan_phi = 0.7\nmu = 0.7\nu_k = 0.3\ndelta_k = 0.4\nzeta = 4\nxi = 1\n";
    let options = Options {
        materials: Some(file.to_owned()),
        ..Options::default()
    };
    for test in &TESTS {
        for deck in test.decks(&options).unwrap() {
            let (deck, _) = model(&deck.text);
            assert_eq!(deck.wall.unwrap().unit_material, "brick", "{}", test.name);
        }
    }
}

/// The corners that the shoes press lie one above the other.
#[test]
fn the_wall_of_diagonal_compression_stands_on_its_corner() {
    let deck = &find("astm-e519")
        .unwrap()
        .decks(&Options::default())
        .unwrap()[0];
    let (_, model) = model(&deck.text);
    let of_wall = |e: &usize| !model.mesh.names[model.mesh.unit[*e] as usize].starts_with("shoe");
    let elements = (0..model.mesh.elements.len()).filter(of_wall);
    let nodes = elements
        .flat_map(|e| model.mesh.elements[e])
        .map(|n| model.mesh.nodes[n as usize]);
    let lowest = nodes.clone().min_by(|a, b| a[2].total_cmp(&b[2])).unwrap();
    let highest = nodes.max_by(|a, b| a[2].total_cmp(&b[2])).unwrap();
    // The bed joint of the last course, 10 of 1,200 mm, lies above the highest unit.
    assert!(
        lowest[2].abs() < 1e-9 && lowest[0].abs() < 1e-9,
        "{lowest:?}"
    );
    assert!(
        highest[0].abs() < 10.0 && highest[2] > 1600.0,
        "{highest:?}"
    );
}

/// Gauges of a modulus span whole courses: their nodes lie where the deck says, equally high in two units.
#[test]
fn gauges_of_moduli_span_whole_courses() {
    for (unit, bed) in [
        ("250x120x55", 65.0),
        ("400x200x200", 210.0),
        ("200x100x40", 50.0),
    ] {
        for test in ["en1052-1", "flat-jack-double"] {
            let decks = find(test).unwrap().decks(&options(Some(unit))).unwrap();
            let (deck, model) = model(&decks[0].text);
            let mut gauges = 0;
            for (said, probe) in deck.probes.iter().zip(&model.probes) {
                let Some(said) = said.gauge else { continue };
                gauges += 1;
                let nodes = [probe.minus[0], probe.nodes[0]];
                let ends = nodes.map(|n| model.mesh.nodes[n as usize][2]);
                for (end, said) in ends.iter().zip(said) {
                    // The deck has four decimals.
                    assert!((end - said[2].get()).abs() < 1e-4, "{test} {unit}: {end}");
                }
                let courses = (ends[1] - ends[0]) / bed;
                assert!(
                    courses > 0.5 && (courses - courses.round()).abs() < 1e-5,
                    "{test} {unit}: {courses} courses"
                );
            }
            assert!(gauges >= 2, "{test} {unit}");
        }
    }
}

/// Materials without densities and a joint with a bond and without stiffnesses.
const BONDED: &str = "[materials.unit]\nE = 9000\nnu = 0.2\n[materials.mortar]\nE = 2500\nnu = 0.2\n[interfaces.joint]\n\
                      f_t = 0.3\nc = 0.45\ntan_phi = 0.75\nmu = 0.65\nzeta = 4.38\nxi = 1.1\nG_I = 0.02\nG_II = 0.06\n";

fn decks_of(test: &str, materials: &str) -> Result<Vec<SpecimenDeck>, SpecimenError> {
    let options = Options {
        materials: Some(materials.to_owned()),
        ..Options::default()
    };
    find(test).unwrap().decks(&options)
}

#[test]
fn a_wall_on_a_tilting_table_is_dry_whatever_its_materials_say() {
    let text = &decks_of("tilting-table", BONDED).unwrap()[0].text;
    let (deck, _) = model(text);
    let joint = &deck.interfaces["joint"];
    assert!(joint.is_dry(), "{text}");
    assert_eq!(joint.mu.unwrap().get(), 0.65);
    assert_eq!(joint.tan_phi.unwrap().get(), 0.75);
    for said in ["# The wall is dry", "no stiffness", "no density"] {
        assert!(text.contains(said), "{said}: {text}");
    }
    // Values of the file come first; a bond by name has its friction.
    let own = BONDED.replace("nu = 0.2\n", "nu = 0.2\ndensity = 2e-9\n")
        + "normal_stiffness = 50\nshear_stiffness = 20\n";
    let text = &decks_of("tilting-table", &own).unwrap()[0].text;
    assert!(!text.contains("no stiffness") && !text.contains("no density"));
    let (deck, _) = model(text);
    let stiffness = deck.interfaces["joint"].normal_stiffness.unwrap();
    assert_eq!(stiffness.get(), 50.0);
    let (units, _) = BONDED.split_once("[interfaces").unwrap();
    let named = format!("{units}[interfaces.joint]\nname = \"M5 on clay\"\n");
    let (deck, _) = model(&decks_of("tilting-table", &named).unwrap()[0].text);
    assert!(deck.interfaces["joint"].is_dry());
    assert_eq!(deck.interfaces["joint"].mu.unwrap().get(), 0.5);
}

#[test]
fn materials_that_make_no_dry_joint_are_refused() {
    let refused = |materials: &str| {
        decks_of("tilting-table", materials)
            .unwrap_err()
            .to_string()
    };
    let said = refused(&BONDED.replace("mu = 0.65\n", ""));
    assert!(said.contains("[interfaces.joint] has no mu"), "{said}");
    let said = refused(&format!("{BONDED}normal_stiffness = 50\n"));
    assert!(said.contains("one of normal_stiffness"), "{said}");
}

#[test]
fn a_file_of_materials_that_is_no_toml_is_told_with_its_line() {
    let said = decks_of("en1052-3", "[materials.unit]\nE = 9000\nnu = \n").unwrap_err();
    assert!(said.message.starts_with("line 3: "), "{said}");
}

/// Walls that bend out of their plane bear their weight; a deck whose materials have none says so where it would act.
#[test]
fn a_weight_that_is_left_out_is_told() {
    for test in ["out-of-plane", "out-of-plane-two-way"] {
        let text = &decks_of(test, BONDED).unwrap()[0].text;
        assert!(text.contains("# No step of gravity"), "{text}");
        let (deck, _) = model(text);
        assert_eq!(deck.steps.len(), 1);
        let text = &find(test).unwrap().decks(&Options::default()).unwrap()[0].text;
        assert_eq!(model(text).0.steps.len(), 2);
    }
}
