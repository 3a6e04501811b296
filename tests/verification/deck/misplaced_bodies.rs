//! Misplaced bodies: overlapping, floating, or beyond a gap. The findings name the place.

use crate::common::blocks::{GRAVITY, HEAD, PAIR, deck};
use wythe::model::Model;

/// Reported warnings of a scene.
fn warnings(text: &str) -> Vec<String> {
    let (_, warnings) = Model::from_deck(&deck(text)).unwrap_or_else(|e| panic!("{e}"));
    warnings.iter().map(ToString::to_string).collect()
}

/// Two overlapping bodies: blocks, units and blocks, rotated blocks, voussoirs.
#[test]
fn bodies_that_overlap_are_named_with_their_place() {
    let third = "[[blocks]]\nname = \"third\"\nsize = [50, 50, 50]\nat = [20, 20, 60]\nmaterial = \"stone\"\n\
                 [[supports]]\non = \"third\"\n";
    let text = format!("{HEAD}{PAIR}{third}{GRAVITY}");
    let error = Model::from_deck(&deck(&text)).unwrap_err();
    assert_eq!(error.key(), "blocks.2.at");
    assert!(
        error
            .message()
            .contains("top and third overlap by 20.000 mm near (35.0, 35.0, 70.0) mm"),
        "{error}"
    );
    assert!(error.line().is_some() && error.advice().contains("move one"));
    // A small overlap gives a warning but is accepted.
    let little = text.replace("at = [20, 20, 60]", "at = [20, 20, 79.5]");
    let told = warnings(&little);
    assert!(
        told.iter()
            .any(|w| w.contains("top and third overlap by 0.500 mm")),
        "{told:?}"
    );
    // Adjacent bodies, and a body whose corner points at another.
    for apart in [
        "at = [20, 20, 80]",
        "at = [240, 50, 0]\nrotate = { axis = \"z\", angle = 45 }",
    ] {
        let told = warnings(&text.replace("at = [20, 20, 60]", apart));
        assert!(!told.iter().any(|w| w.contains("overlap")), "{told:?}");
    }
    let wall = "[wall]\nunit = [200, 100, 80]\nbed_joint = 0\nhead_joint = 0\nlength = 400\ncourses = 2\n\
                unit_material = \"stone\"\ninterface = \"dry\"\nmesh = [2, 1, 1]\nclamped = false\n\
                [[blocks]]\nname = \"beam\"\nsize = [400, 100, 50]\nat = [0, 0, 150]\nmaterial = \"stone\"\n\
                [[supports]]\non = [\"wall.bottom\", \"beam\"]\n";
    let error = Model::from_deck(&deck(&format!("{HEAD}{wall}{GRAVITY}"))).unwrap_err();
    assert_eq!(error.key(), "blocks.0.at");
    assert!(
        error
            .message()
            .contains("course 1 (wall-1-0) and beam overlap by 10.000 mm"),
        "{error}"
    );
    let arch = "[arch]\nradius = 1000\nthickness = 100\nwidth = 200\nvoussoirs = 7\nmaterial = \"stone\"\n\
                interface = \"dry\"\n[[blocks]]\nname = \"key\"\nsize = [20, 50, 50]\nat = [0, 50, 920]\n\
                material = \"stone\"\n[[supports]]\non = \"key\"\n";
    let error = Model::from_deck(&deck(&format!("{HEAD}{arch}{GRAVITY}"))).unwrap_err();
    assert!(
        error.message().contains("key and voussoir-3 overlap"),
        "{error}"
    );
}

/// A floating body is reported with its place, also in general contact.
#[test]
fn bodies_that_float_are_named_with_their_place() {
    let lifted = PAIR.replace(
        "size = [200, 100, 80]",
        "size = [200, 100, 80]\nat = [0, 0, 50]",
    );
    let floats = "top is held by nothing, near (100.0, 50.0, 90.0) mm";
    let error = Model::from_deck(&deck(&format!("{HEAD}{lifted}{GRAVITY}"))).unwrap_err();
    assert!(error.message().contains(floats), "{error}");
    let head = HEAD.replace("[contact]", "[contact]\ngeneral = \"dry\"");
    let general = lifted.replace(
        "[[contacts]]\nslave = \"top.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n",
        "",
    );
    let statics = GRAVITY.replace("\"gravity\"", "\"gravity\"\nprocedure = \"static\"");
    let error = Model::from_deck(&deck(&format!("{head}{general}{statics}"))).unwrap_err();
    assert_eq!(error.key(), "steps.0");
    assert!(
        error.message().contains(floats) && error.advice().contains("dynamic"),
        "{error}"
    );
    // With inertia the block falls, which is reported; on its base it is supported.
    let told = |scene: &str| {
        let all = warnings(&format!("{head}{scene}{GRAVITY}"));
        all.iter().any(|w| w.contains("is held by nothing"))
    };
    assert!(told(&general));
    assert!(!told(&general.replace("at = [0, 0, 50]", "at = [0, 0, 0]")));
}

/// A contact whose faces are apart.
#[test]
fn a_face_that_meets_nothing_is_named_with_its_place() {
    let hung = PAIR.replace(
        "size = [200, 100, 80]",
        "size = [200, 100, 80]\nat = [0, 0, 50]",
    );
    let hung = format!("{hung}[[springs]]\nname = \"s\"\non = \"top\"\nstiffness = [1, 1, 1]\n");
    let told = warnings(&format!("{HEAD}{hung}{GRAVITY}"));
    let wanted = "top.bottom near (100.0, 50.0, 50.0) mm meets nothing at rest: not base.top (50.000 mm lie between)";
    assert!(told.iter().any(|w| w.contains(wanted)), "{told:?}");
    let beside = hung.replace("at = [0, 0, 50]", "at = [800, 0, 0]");
    let told = warnings(&format!("{HEAD}{beside}{GRAVITY}"));
    assert!(
        told.iter()
            .any(|w| w.contains("they lie beside each other")),
        "{told:?}"
    );
    let met = hung.replace("at = [0, 0, 50]", "at = [0, 0, 0]");
    let told = warnings(&format!("{HEAD}{met}{GRAVITY}"));
    assert!(
        !told.iter().any(|w| w.contains("meets nothing")),
        "{told:?}"
    );
}

/// A pattern of units that does not match the headers of the leaf in front.
#[test]
fn gaps_and_joints_that_are_too_wide_are_named_with_their_place() {
    let wall = "[wall]\nunit = [200, 95, 80]\nbed_joint = 10\nhead_joint = 10\nlength = 830\ncourses = 2\nbond = \"pattern\"\n\
                unit_material = \"stone\"\nmortar_material = \"stone\"\ninterface = \"dry\"\nclamped = false\n\
                pattern = [{ leaves = [{ units = [200, 200, 200, 200], headers = [1] }, { units = [200, 205, 205, 200], \
                offset = 0 }] }]\n[[supports]]\non = \"wall.bottom\"\n";
    let told = warnings(&format!("{HEAD}{wall}{GRAVITY}"));
    // The header ends at 410 mm, its joint where the front leaf continues; the leaf behind starts at 425 mm.
    let gap = "in course 0 a gap of 5.00 mm beyond the joint parts wall-0-1 from wall-0-5, which begins at 425.00 mm";
    assert!(told.iter().any(|w| w.contains(gap)), "{told:?}");
    // Units as long as those in front leave no gap.
    let even = wall.replace("200, 205, 205, 200", "200, 200, 200, 200");
    let told = warnings(&format!("{HEAD}{even}{GRAVITY}"));
    assert!(!told.iter().any(|w| w.contains("gap of")), "{told:?}");
    // A lintel that ends within a head joint leaves a wider joint.
    let lintel = "[wall]\nunit = [200, 100, 80]\nbed_joint = 10\nhead_joint = 10\nlength = 1040\ncourses = 3\n\
                  unit_material = \"stone\"\nmortar_material = \"stone\"\ninterface = \"dry\"\nclamped = false\n\
                  openings = [{ from = 420, to = 620, sill = 0, courses = 1, lintel = { bearing = 103 } }]\n\
                  [[supports]]\non = \"wall.bottom\"\n";
    let exact = lintel.replace("courses = 3\n", "courses = 3\nsnap = 0\n");
    let told = warnings(&format!("{HEAD}{exact}{GRAVITY}"));
    let wanted = told
        .iter()
        .find(|w| w.contains("head joints of the wall 10 mm"));
    assert!(
        wanted.is_some_and(|w| w.contains("in course 1 the joint behind wall-")),
        "{told:?}"
    );
    // The unit beside it reaches to its joint by default.
    let told = warnings(&format!("{HEAD}{lintel}{GRAVITY}"));
    assert!(!told.iter().any(|w| w.contains("head joints")), "{told:?}");
}

/// Walls of a closed house, along x and y or turned, in which one unit too few fits beside another wall.
#[test]
fn wide_joints_beside_other_walls_name_the_wall_and_the_place_along_it() {
    let wall = |name: &str, at: [u32; 2], lies: &str, length: u32| {
        format!(
            "[[walls]]\nname = \"{name}\"\nat = [{}, {}, 0]\n{lies}\nunit = [200, 100, 100]\nbed_joint = 10\n\
             head_joint = 10\nlength = {length}\ncourses = 4\nunit_material = \"stone\"\nmortar_material = \"stone\"\n\
             interface = \"dry\"\nmesh = [3, 2, 1]\n[[supports]]\non = \"{name}.bottom\"\n",
            at[0], at[1]
        )
    };
    let turned = |angle: i32| format!("rotate = {{ axis = \"z\", angle = {angle} }}");
    let straight = [
        wall("w0", [0, 0], "along = \"x\"", 1370),
        wall("w1", [1270, 0], "along = \"y\"", 950),
        wall("w2", [0, 850], "along = \"x\"", 1370),
        wall("w3", [0, 0], "along = \"y\"", 950),
    ];
    let rotated = [
        wall("w0", [0, 0], &turned(0), 1370),
        wall("w1", [1370, 0], &turned(90), 950),
        wall("w2", [1370, 950], &turned(180), 1370),
        wall("w3", [0, 950], &turned(-90), 950),
    ];
    for walls in [straight, rotated] {
        let text = format!("{HEAD}{}{GRAVITY}", walls.concat());
        let (_, told) = Model::from_deck(&deck(&text)).unwrap_or_else(|e| panic!("{e}"));
        let wide = told
            .iter()
            .find(|w| w.message.contains("mm wide"))
            .unwrap_or_else(|| panic!("{told:?}"));
        assert_eq!(wide.key, "walls.1.length");
        assert!(wide.line.is_some(), "{wide}");
        let place = "behind w1-1-3 from 830.00 to 850.00 mm along the wall is 20.00 mm wide";
        assert!(wide.message.contains(place), "{wide}");
        let remedy = "the wall `w2`, to which the length should be 10.00 mm shorter";
        assert!(wide.message.contains(remedy), "{wide}");
    }
}

/// If there are more shallow overlaps than are listed, a deep one is still listed.
#[test]
fn shallow_overlaps_hide_no_deep_one() {
    let block = |i: usize, from: f64| {
        format!(
            "[[blocks]]\nname = \"b{i}\"\nsize = [100, 100, 100]\nat = [{from}, 0, 200]\nmaterial = \"stone\"\n\
             [[supports]]\non = \"b{i}\"\n"
        )
    };
    // Each overlaps the previous one by 0.5 mm, the last one by 50 mm.
    let mut row: String = (0..8).map(|i| block(i, 99.5 * i as f64)).collect();
    row += &block(8, 99.5 * 7.0 + 50.0);
    let error = Model::from_deck(&deck(&format!("{HEAD}{row}{GRAVITY}"))).unwrap_err();
    assert!(
        error.message().contains("b7 and b8 overlap by 50.000 mm"),
        "{error}"
    );
}

/// An error of a beam is reported for its table in the deck, not for the generated blocks.
#[test]
fn findings_about_beams_name_their_table() {
    let beam = "[[beams]]\nname = \"jack\"\non = \"top.top\"\ndepth = 50\nrotation = \"free\"\ninterface = \"dry\"\n";
    // The lid projects into the place of the beam.
    let lid = "[[blocks]]\nname = \"lid\"\nsize = [400, 200, 50]\nat = [-100, -50, 100]\nmaterial = \"stone\"\n\
               [[supports]]\non = \"lid\"\n";
    let text = format!("{HEAD}{PAIR}{lid}{beam}{GRAVITY}");
    let error = Model::from_deck(&deck(&text)).unwrap_err();
    assert!(error.message().contains("lid and jack overlap"), "{error}");
    assert_eq!(error.key(), "beams.0");
    assert!(error.line().is_some());
}
