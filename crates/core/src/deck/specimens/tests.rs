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
    for test in TESTS.iter().filter(|test| test.name != "tilting-table") {
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
