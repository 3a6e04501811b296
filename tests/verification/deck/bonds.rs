//! Bonds, leaves, openings, corners, dry and partly filled joints. The units fill the wall without gaps or overlaps,
//! and every face between two units is an interface exactly once.

use crate::common::blocks::{area_vector, nodes, norm};
use crate::common::boxes::{Box3, bodies, element_box, volume};
use crate::common::masonry::MATERIALS;
use crate::common::scene;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::Status;

const STEP: &str = "[[steps]]\nkind = \"gravity\"\n";

/// British bricks: twice the thickness plus a joint is the length.
const BRICK: &str = "unit = [215, 102.5, 65]
bed_joint = 10
head_joint = 10
unit_material = \"brick\"
mortar_material = \"mortar\"
interface = \"joint\"
";

fn deck(wall: &str) -> Deck {
    Deck::from_str(&format!("{MATERIALS}{wall}\n{STEP}"), "wall.toml")
        .unwrap_or_else(|e| panic!("{e}"))
}

fn model(wall: &str) -> Model {
    Model::from_deck(&deck(wall))
        .unwrap_or_else(|e| panic!("{e}"))
        .0
}

fn overlap(a: Box3, b: Box3) -> f64 {
    (0..3)
        .map(|d| (a[1][d].min(b[1][d]) - a[0][d].max(b[0][d])).max(0.0))
        .product()
}

fn area(model: &Model, facet: [u32; 4]) -> f64 {
    norm(area_vector(nodes(model, facet)))
}

/// Area over which the bodies touch [mm²], computed from their boxes.
fn touching(boxes: &[Box3]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in boxes.iter().enumerate() {
        for b in &boxes[i + 1..] {
            for d in 0..3 {
                let meet = (a[1][d] - b[0][d]).abs() < 1e-6 || (b[1][d] - a[0][d]).abs() < 1e-6;
                if !meet {
                    continue;
                }
                let others = [(d + 1) % 3, (d + 2) % 3];
                let common = |k: usize| (a[1][k].min(b[1][k]) - a[0][k].max(b[0][k])).max(0.0);
                sum += common(others[0]) * common(others[1]);
            }
        }
    }
    sum
}

/// Checks that the units fill `solid` mm³ of the wall without overlaps, that elements fill their bodies, and that
/// slave facets cover exactly the touching faces.
fn fills(model: &Model, solid: f64) {
    let mesh = &model.mesh;
    let boxes = bodies(mesh);
    let sum: f64 = boxes.iter().map(|b| volume(*b)).sum();
    // Tolerance: sums of some thousand products of coordinates with twelve decimals.
    assert!((sum - solid).abs() < 1e-9 * solid, "{sum} of {solid}");
    let elements: f64 = (0..mesh.elements.len())
        .map(|e| volume(element_box(mesh, e)))
        .sum();
    assert!((elements - sum).abs() < 1e-9 * solid, "{elements} in {sum}");
    for (i, a) in boxes.iter().enumerate() {
        for b in &boxes[i + 1..] {
            assert!(overlap(*a, *b) < 1e-3, "{a:?} and {b:?}");
        }
    }
    let facets = &model.contact.slave_facets;
    let slaves: f64 = facets.iter().map(|f| area(model, *f)).sum();
    let meet = touching(&boxes);
    assert!(
        meet > 0.0 && (slaves - meet).abs() < 1e-9 * meet,
        "{slaves} mm² of slaves for {meet} mm² that touch"
    );
}

#[test]
fn every_bond_fills_the_wall() {
    // 5 whole stretchers, or 4½.
    for length in [1115.0, 1002.5] {
        for (bond, thickness) in [
            ("bond = \"stretcher\"", 102.5),
            ("bond = \"stretcher\"\noverlap = 75", 102.5),
            ("bond = \"stretcher\"\noverlap = 112.5\nleaves = 2", 215.0),
            ("leaves = 3\ncollar_joint = 20", 347.5),
            ("leaves = 2\nheader_courses = 3", 215.0),
            ("bond = \"stack\"", 102.5),
            ("bond = \"header\"", 215.0),
            ("bond = \"english\"", 215.0),
            ("bond = \"english-cross\"", 215.0),
            ("bond = \"flemish\"", 215.0),
            ("bond = \"english\"\nleaves = 3", 327.5),
            ("bond = \"english-cross\"\nleaves = 3", 327.5),
            ("bond = \"english\"\nleaves = 4", 440.0),
        ] {
            let model = model(&format!(
                "[wall]\n{BRICK}length = {length}\ncourses = 7\n{bond}"
            ));
            let height = 7.0 * 65.0 + 6.0 * 10.0;
            fills(&model, length * thickness * height);
        }
    }
}

/// Head joints of an English bond are offset by a quarter of a pitch from those below.
#[test]
fn headers_lap_by_a_quarter() {
    for (bond, length) in [
        ("english", 1115.0),
        ("english-cross", 1340.0),
        ("flemish", 1227.5),
    ] {
        let deck = deck(&format!(
            "[wall]\n{BRICK}length = {length}\ncourses = 6\nbond = \"{bond}\""
        ));
        let model = Model::from_deck(&deck).unwrap().0;
        let notes = wythe::deck::check(&deck, &model).notes;
        let lap = "lap 56.25 mm";
        assert!(notes.iter().any(|n| n.contains(lap)), "{bond}: {notes:?}");
    }
}

/// Rubble between two leaves of different stones, connected by headers.
#[test]
fn a_written_bond_fills_the_wall() {
    let pattern = "bond = \"pattern\"
[[wall.pattern]]
leaves = [{ units = [215, 102.5], headers = [1] }, { thickness = 150, units = [1000], material = \"mortar\" }, \
{ units = [215, 102.5] }]
[[wall.pattern]]
height = 140
leaves = [{ units = [300] }, { thickness = 150, units = [1000], offset = -400, material = \"mortar\" }, \
{ units = [215], offset = -100 }]
";
    let model = model(&format!(
        "[wall]\n{BRICK}length = 1190\ncourses = 5\n{pattern}"
    ));
    let thickness = 102.5 + 10.0 + 150.0 + 10.0 + 102.5;
    let height = 3.0 * 65.0 + 2.0 * 140.0 + 4.0 * 10.0;
    fills(&model, 1190.0 * thickness * height);
}

#[test]
fn openings_are_empty_and_lintels_span_them() {
    let opening = "openings = [{ from = 337.5, to = 665, sill = 2, courses = 3, lintel = { bearing = 102.5, \
                   material = \"steel\" } }]";
    for bond in ["stretcher", "flemish", "english"] {
        let deck = deck(&format!(
            "[wall]\n{BRICK}length = 1002.5\ncourses = 8\nbond = \"{bond}\"\n{opening}"
        ));
        let model = Model::from_deck(&deck)
            .unwrap_or_else(|e| panic!("{bond}: {e}"))
            .0;
        let mesh = &model.mesh;
        let steel = model
            .materials
            .iter()
            .position(|m| m.name == "steel")
            .unwrap();
        let of_steel = |e: &usize| usize::from(mesh.material[*e]) == steel;
        let lintel: f64 = (0..mesh.elements.len())
            .filter(of_steel)
            .map(|e| volume(element_box(mesh, e)))
            .sum();
        let thickness = if bond == "stretcher" { 102.5 } else { 215.0 };
        // Exact up to rounding.
        assert!((lintel - 532.5 * thickness * 65.0).abs() < 1e-3, "{lintel}");
        // The opening is empty except for the bed joint of its sill and unit ends within a joint's width.
        let inside = [[347.5, 0.0, 160.0], [655.0, thickness, 374.0]];
        for body in bodies(mesh) {
            assert!(overlap(body, inside) < 1e-6, "{bond}: {body:?}");
        }
    }
}

/// A corner and a T-junction: the units of the two walls interlock, and their joints are filled.
#[test]
fn walls_that_meet_interlock() {
    // Corner: the second wall starts at the end of the first one. T: it starts in its middle.
    for at in [900.0, 450.0] {
        let walls = format!(
            "[wall]\nclamped = false\n{BRICK}length = 1002.5\ncourses = 4\n[[walls]]\nname = \"return\"\nalong = \
             \"y\"\nat = [{at}, 0, 0]\n{BRICK}length = 777.5\ncourses = 4\n[[supports]]\non = [\"wall.bottom\", \
             \"return.bottom\"]"
        );
        let model = model(&walls);
        let height = 4.0 * 65.0 + 3.0 * 10.0;
        let plan = 1002.5 * 102.5 + 777.5 * 102.5 - 102.5 * 102.5;
        fills(&model, plan * height);
        // In every course a unit of one wall touches one of the other; courses of the second wall are counted
        // separately.
        let boxes = bodies(&model.mesh);
        let mut course = vec![0; boxes.len()];
        for (unit, k) in model.mesh.unit.iter().zip(&model.mesh.course) {
            course[*unit as usize] = *k;
        }
        let second = course.windows(2).position(|k| k[1] < k[0]).unwrap() + 1;
        for k in 0..4 {
            let of = |range: std::ops::Range<usize>| range.filter(|b| course[*b] == k);
            let joined = of(0..second)
                .flat_map(|a| of(second..boxes.len()).map(move |b| [a, b]))
                .any(|pair| touching(&pair.map(|b| boxes[b])) > 0.0);
            assert!(joined, "course {k} at {at} mm");
            // Where the second wall passes through, its unit reaches beyond the first one: a half unit would end there.
            for b in of(second..boxes.len()).filter(|b| boxes[*b][0][1] < 1.0) {
                assert!(boxes[b][1][1] > 1.5 * 102.5, "course {k} at {at} mm");
            }
        }
    }
}

/// A wall that begins with a later course of its bond has header courses up to its top.
#[test]
fn bonds_that_begin_later_reach_the_top() {
    let wall = format!("{BRICK}courses = 7\nleaves = 2\nheader_courses = 6\n");
    let deck = deck(&format!(
        "[wall]\nclamped = false\n{wall}length = 1115\n[[walls]]\nname = \"return\"\nalong = \"y\"\n{wall}length = \
         1115\n[[supports]]\non = [\"wall.bottom\", \"return.bottom\"]"
    ));
    let (model, warnings) = Model::from_deck(&deck).unwrap();
    let notes = wythe::deck::check(&deck, &model).notes;
    let later = |note: &String| note.contains("begins with course");
    assert!(notes.iter().any(later), "{notes:?}");
    let joints = |warning: &wythe::error::Warning| warning.to_string().contains("hardly a bond");
    assert!(!warnings.iter().any(joints), "{warnings:?}");
}

/// Two walls that meet at the end of the first one, the second turned by this angle: their outer faces meet in a line.
fn corner_deck(turn: f64, more: &str) -> String {
    format!(
        "[wall]\nclamped = false\n{BRICK}length = 1215.0\ncourses = 4\nmesh = [3, 2, 1]\n[[walls]]\nname = \
         \"return\"\nat = [1215.0, 0, 0]\nrotate = {{ axis = \"z\", angle = {turn} }}\n{BRICK}length = 1215.0\n\
         courses = 4\nmesh = [3, 2, 1]\n{more}\n[[supports]]\non = [\"wall.bottom\", \"return.bottom\"]"
    )
}

/// Area of all facets of `facets` for which `holds` is true of all corners [mm²].
fn area_where(model: &Model, facets: &[[u32; 4]], holds: impl Fn([f64; 3]) -> bool) -> f64 {
    let of = |facet: &&[u32; 4]| nodes(model, **facet).iter().all(|x| holds(*x));
    facets.iter().filter(of).map(|f| area(model, *f)).sum()
}

/// Walls that meet at any angle fill the corner, bed joints cover all of it, and in every course one wall ends at the
/// other.
#[test]
fn walls_that_meet_at_an_angle_interlock() {
    const THICKNESS: f64 = 102.5;
    let height = 4.0 * 65.0 + 3.0 * 10.0;
    for turn in [30.0_f64, 45.0, 60.0, 90.0, 117.0, 135.0, 150.0] {
        for more in ["", "corners = \"butted\""] {
            let model = model(&corner_deck(turn, more));
            let (sine, cosine) = turn.to_radians().sin_cos();
            let mesh = &model.mesh;
            // Both strips, less the rhombus that they share.
            let strip = 1215.0 * THICKNESS + 0.5 * THICKNESS.powi(2) * cosine / sine;
            let plan = 2.0 * strip - THICKNESS.powi(2) / sine;
            let volume: f64 = (0..mesh.elements.len()).map(|e| mesh.volume(e)).sum();
            // Rounding of sums of a thousand volumes.
            assert!(
                (volume / (plan * height) - 1.0).abs() < 1e-9,
                "{turn} degrees: {volume}"
            );
            let slaves = &model.contact.slave_facets;
            for (k, level) in [75.0, 150.0, 225.0].into_iter().enumerate() {
                let bed = area_where(&model, slaves, |x| (x[2] - level).abs() < 1e-6);
                assert!(
                    (bed / plan - 1.0).abs() < 1e-9,
                    "{turn} degrees, course {k}: {bed} of {plan}"
                );
            }
            // Distance from the inner face of each wall; the joints of the wall that ends lie on it.
            let ends = |x: [f64; 3]| {
                let of_second = -sine * (x[0] - 1215.0) + cosine * x[1];
                (
                    (x[1] - THICKNESS).abs() < 1e-6,
                    (of_second - THICKNESS).abs() < 1e-6,
                )
            };
            // The joints lie beside the corner.
            let inner = (turn / 2.0).to_radians().tan() * THICKNESS;
            let of_joint = |second: bool| {
                area_where(&model, slaves, |x| {
                    let (on_first, on_second) = ends(x);
                    let beside = x[0] > 1215.0 - inner - 3.0 * THICKNESS;
                    beside && if second { on_first } else { on_second }
                })
            };
            // The wall ends at the return in odd courses, the return at the wall in even ones, or in all; the joint is as high
            // as its unit and bed joint.
            let width = THICKNESS / sine;
            let (odd, even) = (width * (75.0 + 65.0), width * (75.0 + 75.0));
            let expected = if more.is_empty() {
                [odd, even]
            } else {
                [0.0, odd + even]
            };
            for (found, expected) in [of_joint(false), of_joint(true)].into_iter().zip(expected) {
                let error = (found - expected).abs();
                assert!(
                    error <= 1e-9 * (odd + even),
                    "{turn} degrees {more}: {found}, {expected}"
                );
            }
        }
    }
}

/// A wall turned by 90 degrees is the mirror image of one along y.
#[test]
fn a_turned_return_is_one_along_y() {
    const PUSH: &str = "
[[probes]]
name = \"top\"
near = [0, 0, 290]
direction = \"y\"
[[steps]]
kind = \"load\"
procedure = \"displacement_control\"
control = { probe = \"top\", displacement = 0.5 }
[[steps.loads]]
name = \"push\"
on = \"wall.front\"
pressure = \"1 kPa\"
";
    let turned = model(&format!("{}{PUSH}", corner_deck(90.0, "")));
    let along = model(&format!(
        "[wall]\nclamped = false\n{BRICK}length = 1215.0\ncourses = 4\nmesh = [3, 2, 1]\n[[walls]]\nname = \
         \"return\"\nat = [1112.5, 0, 0]\nalong = \"y\"\n{BRICK}length = 1215.0\ncourses = 4\nmesh = [3, 2, 1]\n\
         [[supports]]\non = [\"wall.bottom\", \"return.bottom\"]{PUSH}"
    ));
    let slaves = |model: &Model| -> f64 {
        let facets = &model.contact.slave_facets;
        facets.iter().map(|f| area(model, *f)).sum()
    };
    let (a, b) = (slaves(&turned), slaves(&along));
    assert!((a / b - 1.0).abs() < 1e-12, "{a}, {b}");
    assert_eq!(turned.mesh.elements.len(), along.mesh.elements.len());
    assert_eq!(turned.contact.laws.len(), along.contact.laws.len());
    // Pushed until joints open, both answer alike.
    let [a, b] = [turned, along].map(|model| {
        let (recording, summary) = scene::run(&model);
        assert_eq!(summary.status, Status::Completed, "{}", summary.message);
        recording.rows.last().unwrap().clone()
    });
    assert!(a.interface_dissipation_J > 0.01 * a.external_work_J);
    // The order of the sums differs, and increments end at a root mean square of 2e-3 of the mean nodal force, of which
    // less than half reaches the load.
    assert!(
        (a.load_factor / b.load_factor - 1.0).abs() < 1e-3,
        "{} and {}",
        a.load_factor,
        b.load_factor
    );
}

/// Walls that end within another, are too sharp or too close are refused with the values that would do.
#[test]
fn corners_that_cannot_be_built_are_named() {
    let refused = |walls: &str| {
        let text = format!("{MATERIALS}{walls}\n{STEP}");
        let built = Deck::from_str(&text, "wall.toml").and_then(|deck| Model::from_deck(&deck));
        built.err().map(|e| e.to_string()).unwrap_or_default()
    };
    let short = refused(&corner_deck(60.0, "").replacen("length = 1215.0", "length = 1200", 1));
    assert!(
        short.contains("wall ends within return, 15.00 mm before its outer face"),
        "{short}"
    );
    let behind = refused(
        &corner_deck(60.0, "").replace("at = [1215.0, 0, 0]", "at = [1220.0, 8.660254, 0]"),
    );
    assert!(behind.contains("return begins within wall"), "{behind}");
    let sharp = refused(&corner_deck(20.0, ""));
    assert!(sharp.contains("at an angle of 20.0 degrees"), "{sharp}");
    let uneven =
        refused(&corner_deck(60.0, "").replace("at = [1215.0, 0, 0]", "at = [1215.0, 0, 5]"));
    assert!(uneven.contains("courses are not level"), "{uneven}");
}

#[test]
fn dry_units_touch_with_their_faces() {
    let wall = "[wall]
unit = [200, 100, 50]
bed_joint = 0
head_joint = 0
length = 1000
courses = 5
unit_material = \"brick\"
interface = \"dry\"
mesh = [2, 1, 1]
clamped = false
[contact]
points = \"corner\"
[[supports]]
on = \"wall.bottom\"";
    let model = model(wall);
    assert_eq!(model.materials.len(), 1);
    fills(&model, 1000.0 * 100.0 * 250.0);
    // 5 units in even courses, 6 in odd ones; two elements per whole unit, one per half.
    assert_eq!(model.mesh.elements.len(), 5 * 10);
}

#[test]
fn head_joints_are_filled_to_the_given_fraction() {
    let wall = |filling: f64| {
        model(&format!(
            "[wall]\n{BRICK}length = 1002.5\ncourses = 3\nhead_filling = {filling}"
        ))
    };
    let mortar = |model: &Model| {
        let mesh = &model.mesh;
        let elements = (0..mesh.elements.len()).filter(|e| mesh.material[*e] == 1);
        elements.map(|e| volume(element_box(mesh, e))).sum::<f64>()
    };
    let full = mortar(&wall(1.0));
    let heads = 3.0 * 4.0 * 10.0 * 102.5 * 65.0;
    for filling in [0.0, 0.3, 0.8] {
        let part = mortar(&wall(filling));
        // Tolerance: rounding of some hundred products.
        assert!(
            (full - part - (1.0 - filling) * heads).abs() < 1e-3,
            "{filling}: {part} of {full}"
        );
    }
}

/// The same amount of mortar, at the given face.
#[test]
fn head_joints_are_filled_from_the_given_face() {
    for (from, at) in [("front", [0.0, 30.75]), ("back", [71.75, 102.5])] {
        let model = model(&format!(
            "[wall]\n{BRICK}length = 440\ncourses = 1\nhead_filling = 0.3\nfilled_from = \"{from}\"\n\
             clamped = false\n[[supports]]\non = \"wall.bottom\""
        ));
        let mesh = &model.mesh;
        let mortar: Vec<Box3> = (0..mesh.elements.len())
            .filter(|e| mesh.material[*e] == 1)
            .map(|e| element_box(mesh, e))
            .collect();
        // One joint, one element in height, length and depth: 30 % of 102.5 mm.
        assert_eq!(mortar.len(), 1, "{mortar:?}");
        let [low, high] = mortar[0];
        assert!(
            (low[1] - at[0]).abs() < 1e-9 && (high[1] - at[1]).abs() < 1e-9,
            "{mortar:?}"
        );
    }
}

/// Walls may stand on blocks, and their sides have names.
#[test]
fn a_wall_stands_on_a_block() {
    let scene = format!(
        "[wall]\nclamped = false\nat = [0, 0, 100]\n{BRICK}length = 1002.5\ncourses = 3\n[[blocks]]\nname = \
         \"footing\"\nsize = [1002.5, 102.5, 100]\nmaterial = \"steel\"\nmesh = [10, 2, 1]\n[[supports]]\non = \
         \"footing.bottom\"\n[[contacts]]\nslave = \"wall.bottom\"\nmaster = \"footing.top\"\ninterface = \
         \"joint\"\n[[probes]]\nname = \"top\"\non = \"wall.top\"\ndirection = \"z\""
    );
    let model = model(&scene);
    let boxes = bodies(&model.mesh);
    let mesh = &model.mesh;
    let facets = &model.contact.slave_facets;
    let slaves: f64 = facets.iter().map(|f| area(&model, *f)).sum();
    assert!((slaves - touching(&boxes)).abs() < 1e-6 * slaves);
    let top = 100.0 + 3.0 * 65.0 + 20.0;
    assert!(
        model.probes[0]
            .nodes
            .iter()
            .all(|n| (mesh.nodes[*n as usize][2] - top).abs() < 1e-9)
    );
}

#[test]
fn walls_that_cannot_be_laid_are_rejected() {
    for (wall, key, message) in [
        (
            "bond = \"flemish\"\nunit = [215, 110, 65]",
            "wall.unit",
            "thicker than a header",
        ),
        ("overlap = 5", "wall.overlap", "cannot overlap by 5 mm"),
        (
            "bond = \"flemish\"\noverlap = 50",
            "wall.overlap",
            "says nothing",
        ),
        ("bond = \"pattern\"", "wall.pattern", "there is none"),
        (
            "leaves = 2\nheader_courses = 3\ncollar_joint = 20",
            "wall.header_courses",
            "do not fit through",
        ),
        (
            "openings = [{ from = 100, to = 2000, sill = 1, courses = 1 }]",
            "wall.openings.0.to",
            "not within",
        ),
        (
            "openings = [{ from = 225, to = 450, sill = 3, courses = 2, lintel = { bearing = 100 } }]",
            "wall.openings.0.courses",
            "not within the 5",
        ),
        (
            "openings = [{ from = 225, to = 450, sill = 1, courses = 2 }, { from = 337.5, to = 550, sill = 2, courses = 1 }]",
            "wall.openings.1.from",
            "overlap",
        ),
        (
            "head_filling = 1.5",
            "wall.head_filling",
            "not between 0 and 1",
        ),
        ("along = \"z\"", "wall.along", "upwards"),
    ] {
        let own = if wall.contains("unit =") {
            BRICK.replacen("unit = [215, 102.5, 65]\n", "", 1)
        } else {
            BRICK.to_owned()
        };
        let text = format!("{MATERIALS}[wall]\nlength = 1002.5\ncourses = 5\n{own}{wall}\n{STEP}");
        let error = Deck::from_str(&text, "wall.toml")
            .err()
            .unwrap_or_else(|| panic!("accepted: {wall}"));
        assert_eq!(error.key(), key, "{error}");
        assert!(error.message().contains(message), "{error}");
    }
}
