//! Short pieces beside openings and at the ends of bonds are joined to their neighbours.

use crate::common::Random;
use crate::common::boxes::{bodies, volume};
use crate::common::masonry::MATERIALS;
use wythe::deck::Deck;
use wythe::model::Model;

/// Begin of a wall whose keys follow.
const WALL: &str = "[[steps]]
kind = \"gravity\"
[wall]
unit_material = \"brick\"
mortar_material = \"mortar\"
interface = \"joint\"
mesh = [2, 2, 1]
clamped = { bottom_courses = 0, top_courses = 0 }
";

/// A wall of British bricks, 1002.5 mm long.
const BRICKS: &str = "unit = [215, 102.5, 65]
bed_joint = 10
head_joint = 10
length = 1002.5
courses = 8
";

fn read(wall: &str) -> Result<Deck, wythe::error::ModelError> {
    Deck::from_str(&format!("{MATERIALS}{WALL}{wall}"), "wall.toml")
}

fn model(wall: &str) -> (Deck, Model) {
    let deck = read(wall).unwrap_or_else(|e| panic!("{e}"));
    let (model, _) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}"));
    (deck, model)
}

#[test]
fn a_short_piece_joins_the_unit_beside_it() {
    // Course 2 has units from 0 to 215 mm and from 225 mm; 7 mm of the second one are left.
    let opening = "openings = [{ from = 232, to = 500, sill = 2, courses = 1 }]";
    let (deck, model) = model(&format!("{BRICKS}{opening}"));
    let boxes = bodies(&model.mesh);
    let in_course = |b: &&[[f64; 3]; 2]| (b[0][2] - 150.0).abs() < 1e-9;
    let first = boxes.iter().filter(in_course).find(|b| b[0][0] == 0.0);
    let first = first.expect("a unit at the start of course 2");
    // Its head joint is gone with the piece.
    assert!((first[1][0] - 232.0).abs() < 1e-9, "{first:?}");
    let notes = wythe::deck::check(&deck, &model).notes;
    let told = notes.iter().find(|note| note.starts_with("snap"));
    let told = told.expect("a note");
    assert!(told.contains("17.00 mm"), "{told}");
}

#[test]
fn without_snap_a_sliver_is_an_error() {
    let opening = "snap = 0\nopenings = [{ from = 232, to = 500, sill = 2, courses = 1 }]";
    let error = read(&format!("{BRICKS}{opening}")).unwrap_err();
    assert_eq!(error.key(), "wall.openings.0.from");
    assert!(error.message().contains("sliver of 7.00 mm"), "{error}");
    let negative = read(&format!("{BRICKS}snap = -1\n")).unwrap_err();
    assert_eq!(negative.key(), "wall.snap");
}

#[test]
fn a_pier_narrower_than_a_piece_is_named() {
    let openings = "openings = [{ from = 200, to = 400, sill = 2, courses = 3 }, { from = 412, to = 650, sill = 2, \
                    courses = 3 }]";
    let error = read(&format!("{BRICKS}{openings}")).unwrap_err();
    assert!(error.message().contains("sliver of 12.00 mm"), "{error}");
    assert!(error.key().starts_with("wall.openings."), "{}", error.key());
}

#[test]
fn an_opening_and_a_lintel_near_the_end_reach_it() {
    let opening =
        "openings = [{ from = 500, to = 990, sill = 2, courses = 3, lintel = { bearing = 100 } }]";
    let (_, model) = model(&format!("{BRICKS}{opening}"));
    let lintel = bodies(&model.mesh)
        .into_iter()
        .find(|b| (b[0][2] - 375.0).abs() < 1e-9 && (b[0][0] - 400.0).abs() < 1e-9);
    let lintel = lintel.expect("the lintel");
    assert!((lintel[1][0] - 1002.5).abs() < 1e-9, "{lintel:?}");
    let beside = |b: &[[f64; 3]; 2]| b[1][0] > 600.0 && b[0][2] > 149.0 && b[1][2] < 351.0;
    assert!(!bodies(&model.mesh).iter().any(beside));
}

/// A wall with one or two openings anywhere.
fn random(random: &mut Random) -> String {
    let mut pick = |count: usize| index(random, count);
    let sizes = [[250.0, 55.0], [215.0, 65.0], [112.0, 36.0], [440.0, 215.0]];
    let [length, height] = sizes[pick(4)];
    let bonds = [
        "stretcher",
        "stack",
        "header",
        "english",
        "english-cross",
        "flemish",
    ];
    let bond = bonds[pick(6)];
    let head = [10.0, 12.5, 6.0][pick(3)];
    let width = 0.5 * (length - head);
    let units = 6 + pick(8);
    let extra = [0.0, head + width, 0.37 * length][pick(3)];
    let whole = (units as f64 * (length + head) - head + extra).round();
    let courses = 16 + pick(14);
    let count = 1 + pick(2);
    let openings = (0..count).map(|_| {
        let from = 0.8 * whole * random.uniform();
        let wide = 0.5 * length + random.uniform() * (0.4 * whole - 0.5 * length);
        let to = (from + wide).min(whole);
        let sill = index(random, courses - 8);
        let high = 2 + index(random, 4);
        let bearing = (200.0 * random.uniform()).round();
        let lintel = if random.uniform() < 0.6 {
            format!(
                ", lintel = {{ bearing = {bearing}, courses = {} }}",
                1 + index(random, 2)
            )
        } else {
            String::new()
        };
        format!("{{ from = {from:.1}, to = {to:.1}, sill = {sill}, courses = {high}{lintel} }}")
    });
    let openings: Vec<String> = openings.collect();
    format!(
        "unit = [{length}, {width}, {height}]\nbed_joint = {head}\nhead_joint = {head}\nlength = {whole}\ncourses = \
         {courses}\nbond = \"{bond}\"\nopenings = [{}]\n",
        openings.join(", ")
    )
}

fn index(random: &mut Random, count: usize) -> usize {
    (random.uniform() * count as f64) as usize % count
}

/// A thousand random openings: the wall has no short piece, or an error says why it cannot be built.
#[test]
fn random_openings_leave_no_short_pieces() {
    let mut numbers = Random(44);
    let (mut built, mut narrow) = (0, 0);
    for i in 0..1000 {
        let wall = random(&mut numbers);
        let deck = match read(&wall) {
            Ok(deck) => deck,
            Err(error) => {
                let message = error.to_string();
                // Openings that overlap, and lengths that end in a joint, are mistakes of the deck.
                let mistaken = ["overlap", "ends within a head joint", "not within"];
                narrow += usize::from(message.contains("sliver"));
                let known = mistaken.iter().any(|why| message.contains(why));
                assert!(known || message.contains("sliver"), "{wall}{message}");
                continue;
            }
        };
        built += 1;
        // Every tenth is meshed, which takes longer.
        if i % 10 == 0 {
            let (model, _) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{wall}{e}"));
            let unit = deck.wall.as_ref().unwrap().unit[0].get();
            for body in bodies(&model.mesh) {
                let length = body[1][0] - body[0][0];
                // Bodies have their head joints, so that the shortest is longer than the piece.
                assert!(volume(body) > 0.0 && length > 0.1 * unit, "{wall}{body:?}");
            }
        }
    }
    println!("{built} built, {narrow} named for a pier that no snap can mend");
    // The rest are openings that overlap; few are so close to each other.
    assert!(built > 700 && 50 * narrow < built, "{built} {narrow}");
}
