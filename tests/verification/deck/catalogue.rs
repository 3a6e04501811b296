//! Materials and joints by name: values, overrides, errors, and the page that lists them.

use std::path::Path;

use wythe::deck::catalogue::tables;
use wythe::deck::quantity::Length;
use wythe::deck::{Deck, check};
use wythe::error::{ErrorKind, ModelError};
use wythe::material::{Branch, MaterialParameters};
use wythe::model::Model;

fn example() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/91_wall_by_names.toml");
    std::fs::read_to_string(path).unwrap()
}

fn deck(tables: &str) -> Deck {
    Deck::from_str(&format!("format = 1\n{tables}"), "names.toml").unwrap()
}

fn errors(tables: &str) -> Vec<ModelError> {
    let read = Deck::from_str(&format!("format = 1\n{tables}"), "names.toml");
    read.expect_err("the deck is bad").all().cloned().collect()
}

/// docs/reference/materials.md holds the catalogue as it is. To renew it: print `tables()` into its three tables.
#[test]
fn the_page_lists_the_catalogue() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/reference/materials.md");
    let page = std::fs::read_to_string(path).unwrap();
    for table in tables() {
        assert!(
            page.contains(&table),
            "docs/reference/materials.md lacks\n{table}"
        );
    }
}

#[test]
fn a_name_fills_what_the_deck_leaves_out() {
    let named = deck("[materials.brick]\nname = \"clay brick, solid\"\nf_b = \"20 MPa\"\n");
    let brick = &named.materials["brick"];
    let [e, nu] = [brick.E.get(), brick.nu.get()];
    assert_eq!([e, nu], [6000.0, 0.15]);
    assert!((brick.density.get() - 1.8e-9).abs() < 1e-24);
    let [tension, compression] =
        [Branch::Tension, Branch::Compression].map(|branch| brick.by_energy(branch).unwrap());
    // 0.05 f_c; 0.029 mm; 15 + 0.43 × 20 − 0.0036 × 400.
    assert_eq!([tension.strength, tension.energy], [1.0, 0.029]);
    assert_eq!([compression.strength, compression.energy], [20.0, 22.16]);
    let [assumed] = named.assumed() else {
        panic!("{:?}", named.assumed())
    };
    let told = assumed.to_string();
    for part in [
        "material brick is `clay brick, solid`: f_c = 20 MPa (f_b of the deck); E = 6000 MPa (300 f_c; Kaushik",
        "G_ft = 0.029 N/mm (0.029 f_t; ductility index",
    ] {
        assert!(told.contains(part), "{part} is not in {told}");
    }
}

#[test]
fn keys_of_the_deck_come_first() {
    let own = deck(
        "[materials.brick]\nname = \"clay brick, solid\"\nf_t = 2\nE = \"9 GPa\"\n\
         [materials.mortar]\nname = \"m 5\"\nf_c = 6\n[interfaces.joint]\nname = \"M5 on clay\"\nc = 0.28\nu_k = 0.3\n",
    );
    let brick = &own.materials["brick"];
    let tension = brick.by_energy(Branch::Tension).unwrap();
    assert_eq!([brick.E.get(), tension.strength], [9000.0, 2.0]);
    // What follows from a strength follows from that of the deck.
    assert!((tension.energy - 0.058).abs() < 1e-15);
    assert_eq!(own.materials["mortar"].E.get(), 1200.0);
    let joint = &own.interfaces["joint"];
    assert!(
        (joint.tensile_strength() - 0.2).abs() < 1e-4,
        "{}",
        joint.tensile_strength()
    );
    assert_eq!(joint.u_k.map(Length::get), Some(0.3));
    assert!(joint.G_I.is_none() && joint.G_II.is_some());
    let taken: Vec<&str> = own.assumed()[0].taken.iter().map(|t| t.key).collect();
    assert_eq!(taken, ["f_c", "nu", "density", "G_ft", "G_fc"]);

    // Empty tables: linear elastic; another law takes the elastic values alone.
    let elastic = deck("[materials.a]\nname = \"tuff\"\ntension = []\ncompression = []\n");
    let parameters = elastic.materials["a"].parameters();
    assert!(matches!(parameters, MaterialParameters::Elastic(_)));
    let cone = deck(
        "[materials.a]\nname = \"tuff\"\nkind = \"drucker-prager\"\nc = 1\nphi = 35\nf_t = 0.3\n",
    );
    assert!(matches!(
        cone.materials["a"].parameters(),
        MaterialParameters::DruckerPrager(_)
    ));
    // A joint with a cap takes what its law reads.
    let cap = deck(
        "[interfaces.a]\nkind = \"cap\"\nname = \"M5 on clay\"\nf_m = 8\nkappa_p = 0.09\nG_fc = 5\nC_ss = 1\n",
    );
    assert!(cap.interfaces["a"].zeta.is_none());
}

#[test]
fn misuse_of_names_is_an_error() {
    let cases = [
        (
            "[materials.brick]\nname = \"solid clay brik\"\n",
            "materials.brick.name",
            3,
            "no material named `solid clay brik`",
            "`clay brick, solid`",
        ),
        (
            "[interfaces.joint]\nname = \"M5 on clai\"\n",
            "interfaces.joint.name",
            3,
            "no joint named `M5 on clai`",
            "`M5 on clay`",
        ),
        (
            "[materials.mortar]\nname = \"M5\"\nf_b = 6\n",
            "materials.mortar.f_b",
            4,
            "this is a mortar",
            "as f_c",
        ),
        (
            "[materials.brick]\nE = 5000\nnu = 0.2\nf_b = 20\n",
            "materials.brick.f_b",
            5,
            "beside `name` only",
            "give `name`",
        ),
        (
            "[materials.brick]\nname = \"tuff\"\nf_b = -20\n",
            "materials.brick.f_b",
            4,
            "-20 is not positive",
            "above 0",
        ),
        (
            "[materials.brick]\nname = \"tuff\"\nf_t = 3\n",
            "materials.brick.f_c",
            2,
            "7.4 MPa is below",
            "a smaller tensile strength",
        ),
        (
            "[materials.brick]\nname = 5\n",
            "materials.brick.name",
            3,
            "expected a string",
            "",
        ),
    ];
    for (text, key, line, message, help) in cases {
        let errors = errors(text);
        let error = &errors[0];
        assert_eq!(
            (error.key(), error.line()),
            (key, Some(line)),
            "{text}: {error}"
        );
        assert!(error.message().contains(message), "{}", error.message());
        assert!(error.advice().contains(help), "{}", error.advice());
    }
    let unknown = errors("[materials.brick]\nname = \"unobtainium\"\n");
    assert_eq!(
        (unknown.len(), unknown[0].kind()),
        (1, ErrorKind::UnknownName)
    );
}

/// The deck of a run holds all values, so that a run goes on without the catalogue.
#[test]
fn a_written_deck_has_the_values() {
    let named = Deck::from_str(&example(), "names.toml").unwrap();
    let again = Deck::from_str(&named.to_toml().unwrap(), "model.toml").unwrap();
    assert_eq!(again.materials, named.materials);
    assert_eq!(again.interfaces, named.interfaces);
    let taken = |deck: &Deck| -> usize { deck.assumed().iter().map(|a| a.taken.len()).sum() };
    assert!(taken(&named) > 15 && taken(&again) == 0);
}

#[test]
fn the_checker_and_the_model_tell_what_is_assumed() {
    let deck = Deck::from_str(&example(), "names.toml").unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    assert_eq!(model.assumed.len(), 3);
    let notes = check(&deck, &model).notes;
    for note in &model.assumed {
        assert!(notes.contains(note), "{note}");
    }
}
