//! Names of courses and storeys of a wall.

use crate::common::blocks::HEAD;
use wythe::deck::Deck;
use wythe::model::Model;

const WALL: &str = "[wall]
unit = [200, 100, 50]
bed_joint = 0
head_joint = 0
length = 1000
courses = 12
storeys = [290, 300]
unit_material = \"stone\"
interface = \"dry\"
mesh = [2, 1, 1]
clamped = false
openings = [{ from = 400, to = 600, sill = 2, courses = 2, lintel = { bearing = 100, courses = 2 } }]
[[steps]]
kind = \"gravity\"
";

fn model(more: &str) -> Model {
    let deck = Deck::from_str(&format!("{HEAD}{WALL}{more}"), "wall.toml");
    let deck = deck.unwrap_or_else(|e| panic!("{e}"));
    Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}")).0
}

/// Ranges of the coordinates of the nodes that a support holds [mm]. `[xyz][low, high]`
fn held(name: &str) -> [[f64; 2]; 3] {
    let model = model(&format!(
        "[[supports]]\non = \"wall.bottom\"\n[[supports]]\non = \"{name}\"\n"
    ));
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for n in &model.supports[1].nodes {
        for (range, x) in ranges.iter_mut().zip(model.mesh.nodes[*n as usize]) {
            *range = [range[0].min(x), range[1].max(x)];
        }
    }
    ranges
}

#[test]
fn a_course_and_its_faces_have_names() {
    assert_eq!(held("wall.course-7")[2], [350.0, 400.0]);
    assert_eq!(
        held("wall.course-7.top"),
        [[0.0, 1000.0], [0.0, 100.0], [400.0; 2]]
    );
    assert_eq!(held("wall.course-7.bottom")[2], [350.0; 2]);
    assert_eq!(held("wall.course-7.left")[0], [0.0; 2]);
    assert_eq!(held("wall.course-7.front")[1], [0.0; 2]);
}

#[test]
fn a_lintel_belongs_to_the_course_where_it_begins_and_its_top_to_the_one_where_it_ends() {
    let at = |name: &str, x: f64| {
        let model = model(&format!(
            "[[supports]]\non = \"wall.bottom\"\n[[supports]]\non = \"{name}\"\n"
        ));
        let mut nodes = model.supports[1].nodes.iter();
        nodes.any(|n| (model.mesh.nodes[*n as usize][0] - x).abs() < 1e-9)
    };
    // The lintel is in courses 4 and 5; its middle is at 500 mm.
    assert!(!at("wall.course-4.top", 500.0) && at("wall.course-5.top", 500.0));
    assert!(at("wall.course-4", 500.0) && !at("wall.course-5", 500.0));
}

#[test]
fn a_storey_ends_with_the_course_nearest_to_its_height() {
    assert_eq!(held("wall.storey-1")[2], [0.0, 300.0]);
    assert_eq!(held("wall.storey-1.top")[2], [300.0; 2]);
    // 590 mm from the ground: the top at 600 mm.
    assert_eq!(held("wall.storey-2.top")[2], [600.0; 2]);
}

#[test]
fn unknown_courses_and_storeys_are_named() {
    let refused = |from: &str, to: &str, name: &str| {
        let text = WALL.replace(from, to);
        let text = format!("{HEAD}{text}[[supports]]\non = \"{name}\"\n");
        Deck::from_str(&text, "wall.toml").unwrap_err()
    };
    let error = refused("", "", "wall.course-12.top");
    assert_eq!(error.key(), "supports.0.on");
    let told = format!("{error:?}");
    assert!(told.contains("courses 0 to 11, storeys 1 to 2"), "{told}");
    let error = refused("", "", "wall.course-3.up");
    assert!(format!("{error:?}").contains("no face `up`"), "{error}");
    let error = refused(
        "storeys = [290, 300]",
        "storeys = [290, 400]",
        "wall.bottom",
    );
    assert_eq!(error.key(), "wall.storeys");
    let error = refused("storeys = [290, 300]", "storeys = [290, 5]", "wall.bottom");
    assert!(
        error.to_string().contains("storey 2 has no course"),
        "{error}"
    );
}
