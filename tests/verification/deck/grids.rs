//! Blocks with nodes from a file.

use std::fs;

use crate::common::blocks::HEAD;
use wythe::deck::Deck;
use wythe::model::Model;

const SCENE: &str = r#"
[[blocks]]
name = "base"
size = [4, 2, 1]
at = [0, 0, -1]
material = "stone"
mesh = [4, 1, 1]

[[blocks]]
name = "body"
nodes = "body.csv"
material = "stone"
mesh = [2, 1, 1]

[[contacts]]
interface = "dry"

[[supports]]
on = "base"

[[steps]]
kind = "gravity"
"#;

/// Nodes of two elements of 1 × 2 × 1 mm, the middle ones raised.
const NODES: &str = "# a roof\nx,y,z\n0,0,0\n1,0,0\n2,0,0\n0,2,0\n1,2,0\n2,2,0\n\
                     0,0,1\n1,0,1.5\n2,0,1\n0,2,1\n1,2,1.5\n2,2,1\n";

/// Writes the file of nodes and reads the scene beside it.
fn build(scene: &str, nodes: &str) -> Result<Model, wythe::error::DeckError> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("body.csv"), nodes).unwrap();
    let path = folder.path().join("deck.toml");
    fs::write(&path, format!("{HEAD}{scene}")).unwrap();
    let deck = Deck::load(&path, &[])?;
    Ok(Model::from_deck(&deck)?.0)
}

#[test]
fn a_grid_has_the_nodes_of_its_file() {
    let model = build(SCENE, NODES).unwrap_or_else(|e| panic!("{e}"));
    // 5 x 2 x 2 nodes of the base come first.
    assert_eq!(model.mesh.nodes[20..].len(), 12);
    assert_eq!(model.mesh.nodes[27], [1.0, 0.0, 1.5]);
    let volume: f64 = (4..6).map(|e| model.mesh.volume(e)).sum();
    // 2 x 2 x 1 mm and half of 2 x 2 x 0.5 mm, summed in f64.
    assert!((volume - 5.0).abs() < 1e-12, "{volume}");
    // The block stands on the base, its elements on those below.
    assert_eq!(
        model.contact.slave_facets.len() + model.contact.master_facets.len(),
        6
    );
    let moved = SCENE.replace("mesh = [2, 1, 1]", "mesh = [2, 1, 1]\nat = [0.5, 0, 0]\nrotate = { axis = \"y\", angle = 0 }\ncopies = [2, 1, 1]\npitch = [2, 0, 0]");
    let model = build(&moved, NODES).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(model.mesh.nodes[27], [1.5, 0.0, 1.5]);
    assert_eq!(model.mesh.nodes[39], [3.5, 0.0, 1.5]);
}

#[test]
fn a_box_as_a_grid_is_the_same_model() {
    let flat = NODES.replace("1.5", "1");
    let grid = build(SCENE, &flat).unwrap_or_else(|e| panic!("{e}"));
    let boxed = SCENE.replace("nodes = \"body.csv\"", "size = [2, 2, 1]");
    let boxed = build(&boxed, "").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(grid.mesh, boxed.mesh);
    let surfaces = |m: &Model| format!("{:?}", m.contact);
    assert_eq!(surfaces(&grid), surfaces(&boxed));
}

#[test]
fn bad_files_name_the_line_and_the_fix() {
    let swapped = NODES.replace("0,0,1\n1,0,1.5", "1,0,1.5\n0,0,1");
    for (nodes, line, message) in [
        (
            NODES.replace("2,2,0", "2,2"),
            " line 8:",
            "`2,2` is no node",
        ),
        (NODES.replace("2,2,0", "2,2,nan"), " line 8:", "no node"),
        (NODES.replace("2,2,0", "two,2,0"), " line 8:", "no node"),
        (
            NODES.replace("x,y,z", "x,y,z\nx,y,z"),
            " line 3:",
            "no node",
        ),
        (
            NODES.replace("2,2,1\n", ""),
            " line 13:",
            "11 nodes end here, not 3 x 2 x 2",
        ),
        (format!("{NODES}0,0,0\n"), " line 15:", "13 nodes"),
        (String::new(), " line 0:", "0 nodes"),
        (swapped, " line 3:", "flat or folded"),
        (
            NODES.replace("2,0,1\n", "2,0,-1\n"),
            " line 4:",
            "flat or folded",
        ),
    ] {
        let before = format!("{HEAD}{SCENE}");
        let before = before.split("nodes = \"body.csv\"").next().unwrap();
        let of_deck = before.matches('\n').count() + 1;
        let error = build(SCENE, &nodes).map_or_else(|e| e, |_| panic!("accepted: {nodes}"));
        let wythe::error::DeckError::Model(error) = error else {
            panic!("{error}");
        };
        assert_eq!(error.key(), "blocks.1.nodes");
        assert_eq!(error.line(), Some(of_deck));
        let text = error.message();
        assert!(text.contains("body.csv") && text.contains(line), "{text}");
        assert!(text.contains(message), "{text}");
        assert!(!error.advice().is_empty());
    }
}

#[test]
fn bad_decks_name_the_key() {
    for (from, to, key, message) in [
        (
            "nodes = \"body.csv\"",
            "nodes = \"nobody.csv\"",
            "blocks.1.nodes",
            "nobody.csv",
        ),
        (
            "nodes = \"body.csv\"",
            "nodes = 3",
            "blocks.1.nodes",
            "expected a string",
        ),
        (
            "nodes = \"body.csv\"",
            "nodes = \"body.csv\"\nsize = [1, 1, 1]",
            "blocks.1.nodes",
            "both `size` and `nodes`",
        ),
        (
            "nodes = \"body.csv\"\n",
            "",
            "blocks.1.size",
            "neither `size`",
        ),
    ] {
        let error = build(&SCENE.replace(from, to), NODES);
        let error = error.map_or_else(|e| e, |_| panic!("accepted: {to}"));
        let wythe::error::DeckError::Model(error) = error else {
            panic!("{error}");
        };
        assert_eq!(error.key(), key, "{error}");
        assert!(error.message().contains(message), "{error}");
    }
}

#[test]
fn an_override_gives_a_grid_in_place_of_a_size_and_back() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("body.csv"), NODES).unwrap();
    let path = folder.path().join("deck.toml");
    fs::write(&path, format!("{HEAD}{SCENE}")).unwrap();
    let set = |key: &str, value: &str| [(key.to_owned(), value.to_owned())];
    let deck = Deck::load(&path, &set("blocks.1.size", "[1, 1, 1]")).unwrap();
    assert!(deck.blocks[1].nodes.is_none());
    let boxed = SCENE.replace("nodes = \"body.csv\"", "size = [1, 1, 1]");
    fs::write(&path, format!("{HEAD}{boxed}")).unwrap();
    let deck = Deck::load(&path, &set("blocks.1.nodes", "body.csv")).unwrap();
    assert!(deck.blocks[1].size.is_none());
    Model::from_deck(&deck).unwrap();
}
