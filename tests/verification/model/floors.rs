//! Floors: their weight on the faces that carry them, and the stiffness of their springs.

use crate::common::blocks::{Bad, GRAVITY, HEAD, deck_and_model, norm, refuses};
use crate::common::scene::{completed, gap};
use wythe::limit::{LimitSettings, analyse};

/// Length of the walls, and distance of their middles [mm].
const LENGTH: f64 = 3000.0;
const SPAN: f64 = 4000.0;

/// Two walls along x, `front` and `back`, with a floor on their tops.
fn two_walls(floor: &str) -> String {
    let wall = |name: &str, y: f64| {
        format!(
            "[[blocks]]\nname = \"{name}\"\nsize = [{LENGTH}, 200, 1000]\nat = [0, {y}, 0]\nmaterial = \"stone\"\nmesh = [6, \
             1, 2]\n[[supports]]\non = \"{name}.bottom\"\n"
        )
    };
    format!(
        "{HEAD}{}{}[[floors]]\nname = \"first\"\non = [\"front.top\", \"back.top\"]\n{floor}\n",
        wall("front", 0.0),
        wall("back", SPAN)
    )
}

/// Force of a drive of the top of the back wall by 0.1 mm [N].
fn force_of(floor: &str, direction: &str) -> f64 {
    let drive = format!(
        "[[steps]]\nkind = \"drive\"\nface = \"back.bottom\"\ndirection = \"{direction}\"\ndisplacement = \"0.1 mm\"\n"
    );
    let scene = two_walls(floor).replace("[[supports]]\non = \"back.bottom\"\n", "");
    let (_, model) = deck_and_model(&format!("{scene}{drive}"));
    let recording = completed(&model);
    1e3 * recording.rows.last().expect("a row").force_kN
}

/// A floor and its walls turned about the vertical axis have the same area, mass and springs.
#[test]
fn a_floor_may_be_turned_with_its_walls() {
    let floor = "load = \"3 kN/m^2\"\naxial = \"10 kN/mm\"";
    let made = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let turn = |text: String, y: f64| {
            let turned = format!(
                "at = [{}, {}, 0]\nrotate = {{ axis = \"z\", angle = {degrees} }}\n",
                -sine * y,
                cosine * y
            );
            text.replace(&format!("at = [0, {y}, 0]\n"), &turned)
        };
        let text = turn(turn(two_walls(floor), 0.0), SPAN);
        let (_, model) = deck_and_model(&format!("{text}{GRAVITY}"));
        let springs: usize = model.ties.iter().map(|tie| tie.shares.len()).sum();
        (model.floors[0].area, model.floors[0].mass(), springs)
    };
    let straight = made(0.0);
    for degrees in [10.0, 30.0, 44.0, 90.0, 150.0] {
        let turned = made(degrees);
        // Sums over facets with rotated coordinates.
        assert!(
            (turned.0 / straight.0 - 1.0).abs() < 1e-9,
            "{degrees}: {turned:?}"
        );
        assert!(
            (turned.1 / straight.1 - 1.0).abs() < 1e-9,
            "{degrees}: {turned:?}"
        );
        assert_eq!(turned.2, straight.2, "{degrees}");
    }
}

/// Two thick piers 1 m apart, turned about the vertical axis, with coordinates rounded to this many decimals. Middles of
/// two rows of facets are equally near to each joist, across and along.
fn turned_piers(meshes: [&str; 2], order: &str, degrees: f64, decimals: usize) -> String {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let pier = |name: &str, y: f64, mesh: &str| {
        format!(
            "[[blocks]]\nname = \"{name}\"\nsize = [1000, 600, 2000]\nat = [{:.decimals$}, {:.decimals$}, 0]\nmaterial = \
             \"stone\"\nmesh = {mesh}\nrotate = {{ axis = \"z\", angle = {degrees} }}\n[[supports]]\non = \
             \"{name}.bottom\"\n",
            -sine * y,
            cosine * y
        )
    };
    let [p, q] = [pier("p", 0.0, meshes[0]), pier("q", 1000.0, meshes[1])];
    format!(
        "{HEAD}{p}{q}[[floors]]\nname = \"f\"\non = {order}\nload = 0.01\naxial = 1000\nshear = 100\nspacing = \
         500\n{GRAVITY}"
    )
}

/// Both ends, length and E A of the springs of a floor in order, its mass, and its stiffness along y when it is turned
/// back.
fn springs(text: &str, degrees: f64) -> (Vec<[f64; 4]>, f64, f64) {
    let (_, model) = deck_and_model(text);
    let (sine, cosine) = degrees.to_radians().sin_cos();
    let back = |x: [f64; 3]| [cosine * x[0] + sine * x[1], cosine * x[1] - sine * x[0]];
    let (mut all, mut along_y) = (Vec::new(), 0.0);
    for tie in &model.ties {
        for (strand, share) in tie.strands.iter().zip(&tie.shares) {
            let [a, b] = [strand[0].at, strand[1].at];
            let length = norm([b[0] - a[0], b[1] - a[1], b[2] - a[2]]);
            let [a, b] = [back(a), back(b)];
            let stiffness = tie.law.E * tie.law.area * share;
            along_y += stiffness * (b[1] - a[1]).powi(2) / length.powi(3);
            all.push([a[0], b[0], length, stiffness]);
        }
    }
    (all, model.floors[0].mass(), along_y)
}

/// Where a joist ends does not depend on how a scene is turned, nor on the rounding of its coordinates; and whatever the
/// length of its springs, the floor has its stiffness: 1000 N/mm times the width over the span.
#[test]
fn rounding_does_not_choose_the_joists() {
    let meshes = [
        ["[4, 2, 4]", "[4, 2, 4]"],
        ["[4, 2, 4]", "[3, 1, 4]"],
        ["[2, 2, 4]", "[4, 4, 4]"],
    ];
    for meshes in meshes {
        for order in ["[\"p.top\", \"q.top\"]", "[\"q.top\", \"p.top\"]"] {
            let (straight, mass, _) = springs(&turned_piers(meshes, order, 0.0, 9), 0.0);
            for degrees in [0.0_f64, 30.0, 37.0, -37.0, 45.0, 90.0, 143.0, 180.0, -90.0] {
                for decimals in [12, 6, 3] {
                    let text = turned_piers(meshes, order, degrees, decimals);
                    let (turned, turned_mass, along_y) = springs(&text, degrees);
                    let scene = format!("{meshes:?}, {order}, {degrees} degrees, {decimals}");
                    assert_eq!(turned.len(), straight.len(), "{scene}");
                    // Coordinates have errors of half a µm at most in spans of a metre; weights are sums.
                    for (a, b) in turned.iter().flatten().zip(straight.iter().flatten()) {
                        assert!((a - b).abs() < 1e-2 + 1e-5 * b.abs(), "{scene}: {a} {b}");
                    }
                    assert!((turned_mass / mass - 1.0).abs() < 1e-5, "{scene}");
                    assert!((along_y / 1000.0 - 1.0).abs() < 1e-5, "{scene}: {along_y}");
                }
            }
        }
    }
}

/// A wall that is turned against the first one is no side of its floor.
#[test]
fn sides_that_are_askew_are_refused() {
    let text = two_walls("load = \"3 kN/m^2\"").replace(
        &format!("at = [0, {SPAN}, 0]\n"),
        &format!("at = [0, {SPAN}, 0]\nrotate = {{ axis = \"z\", angle = 20 }}\n"),
    );
    let bad = (
        "name = \"first\"",
        "name = \"first\"",
        "floors.0.on",
        "turned by 20.0 degrees",
        "parallel",
    );
    refuses(&format!("{text}{GRAVITY}"), &[bad]);
}

#[test]
fn a_floor_weighs_on_both_of_its_walls() {
    let (_, model) = deck_and_model(&format!("{}{GRAVITY}", two_walls("load = \"3 kN/m^2\"")));
    let floor = &model.floors[0];
    let area = LENGTH * SPAN;
    // Both are sums over the facets, up to rounding.
    assert!((floor.area - area).abs() < 1e-6 * area, "{}", floor.area);
    let weight = 3e-3 * area;
    assert!((floor.mass() * 9810.0 - weight).abs() < 1e-9 * weight);
    let recording = completed(&model);
    let row = recording.rows.last().expect("a row");
    let wall = LENGTH * 200.0 * 1000.0 * 2000e-12 * 9810.0;
    for (support, name) in ["front", "back"].iter().enumerate() {
        let carried = row.reactions[support][2];
        // Tolerance of equilibrium: 2e-3.
        assert!(
            (carried - wall - 0.5 * weight).abs() < 2e-3 * carried,
            "{name}: {carried}"
        );
    }
    // The walls stay elastic: the error is that of a path in equilibrium, of second order in its tolerance of 2e-3.
    assert!(gap(row) < 1e-6, "{}", gap(row));
}

/// Joists: E A over the distance of the walls. Braces: G t times the width over it.
#[test]
fn the_springs_of_a_floor_have_its_stiffness() {
    let drives = [("y", 10.0), ("x", 0.5)];
    for (floor, drives) in [
        ("axial = 10\nspacing = 500", &drives[..1]),
        ("axial = 10\nshear = 0.5\nspacing = 500", &drives),
        ("axial = 10\nshear = 0.5\nspacing = 1400", &drives),
        ("axial = 10\nshear = 0.5\nspacing = 9000", &drives),
    ] {
        for (direction, stiffness) in drives {
            let expected = 0.1 * stiffness * LENGTH / SPAN;
            let force = force_of(floor, direction);
            println!("{floor}, {direction}: {force} ({expected})");
            // Both walls yield as cantilevers, by 30 kN/mm each, and the floor by 7.5 N/mm: 5e-4. The drive turns the
            // springs by 2.5e-5.
            assert!(
                (force / expected - 1.0).abs() < 2e-3,
                "{floor}: {force} {expected}"
            );
        }
    }
}

/// Walls on all four sides: the floor spans both ways, and half of it weighs on each pair.
#[test]
fn a_floor_on_four_walls_spans_both_ways() {
    let sides = "[[blocks]]\nname = \"left\"\nsize = [200, 3000, 1000]\nat = [-1000, 500, 0]\nmaterial = \"stone\"\nmesh \
                 = [1, 6, 2]\n[[supports]]\non = \"left.bottom\"\n[[blocks]]\nname = \"right\"\nsize = [200, 3000, 1000]\nat \
                 = [3800, 500, 0]\nmaterial = \"stone\"\nmesh = [1, 6, 2]\n[[supports]]\non = \"right.bottom\"\n";
    let floor = "mass = 4\naxial = 10\nshear = 5\nspacing = 500";
    let four = two_walls(floor).replace(
        "\"back.top\"]",
        "\"back.top\", \"right.top\", \"left.top\"]",
    );
    let (_, model) = deck_and_model(&format!("{four}{sides}{GRAVITY}"));
    let row = completed(&model).rows.last().expect("a row").clone();
    let wall = 9810.0 * 3000.0 * 200.0 * 1000.0 * 2000e-12;
    // Parts by the areas of both ways: 3000 x 4000 and 3000 x 4800.
    let [ours, theirs] = [12.0, 14.4].map(|part| 4.0 * 9810.0 * part / 26.4 / 2.0);
    for (reaction, part) in row.reactions.iter().zip([ours, ours, theirs, theirs]) {
        // Tolerance of equilibrium: 2e-3.
        assert!(
            (reaction[2] - wall - part).abs() < 2e-3 * wall,
            "{reaction:?} {part}"
        );
    }
    assert_eq!(
        model.floors[0].area,
        0.5 * (3000.0 * 4000.0 + 3000.0 * 4800.0)
    );
}

/// A pier that tips about its edge with a floor on it: λ (m h/2 + M h) = (m + M) b/2.
#[test]
fn limit_analysis_knows_the_mass_of_floors() {
    let [width, depth, height] = [200.0, 600.0, 1000.0];
    let scene = format!(
        "{HEAD}[[blocks]]\nname = \"base\"\nsize = [600, 700, 50]\nat = [-100, -50, -50]\nmaterial = \"stone\"\n\
         [[blocks]]\nname = \"pier\"\nsize = [{width}, {depth}, {height}]\nmaterial = \"stone\"\n[[contacts]]\nslave = \
         \"pier.bottom\"\nmaster = \"base.top\"\ninterface = \"dry\"\n[[supports]]\non = \"base.bottom\"\n[[floors]]\nname = \
         \"roof\"\non = \"pier.top\"\nmass = 0.1\n[[steps]]\nkind = \"gravity\"\n"
    );
    let (_, model) = deck_and_model(&scene);
    let settings = LimitSettings {
        along: Some([1.0, 0.0, 0.0]),
        ..LimitSettings::default()
    };
    let factor = analyse(&model, &settings).expect("a factor").factor;
    let own = width * depth * height * 2000e-12;
    let known = (own + 0.1) * 0.5 * width / (0.5 * own * height + 0.1 * height);
    // The programs are solved to 1e-9, their forces settle to 1e-4.
    assert!((factor / known - 1.0).abs() < 1e-4, "{factor} {known}");
}

#[test]
fn bad_floors_are_errors() {
    let good = format!("{}{GRAVITY}", two_walls("load = 0.003"));
    let bad: &[Bad] = &[
        (
            "load = 0.003",
            "",
            "floors.0.load",
            "neither weighs nor ties",
            "kN/m^2",
        ),
        (
            "load = 0.003",
            "load = 0.003\nmass = 1",
            "floors.0.mass",
            "both",
            "in all",
        ),
        (
            "load = 0.003",
            "load = -1",
            "floors.0.load",
            "not positive",
            "above 0",
        ),
        (
            "load = 0.003",
            "rigid = true\naxial = 5",
            "floors.0.rigid",
            "its own stiffness",
            "leave out",
        ),
        (
            "load = 0.003",
            "load = 0.003\nspacing = 5",
            "floors.0.spacing",
            "no springs",
            "leave it out",
        ),
        (
            "kind = \"gravity\"",
            "kind = \"drive\"\nface = \"back.top\"\ndirection = \"x\"\ndisplacement = 1",
            "floors.0",
            "no step has gravity",
            "gravity",
        ),
        (
            "\"back.top\"",
            "\"bock.top\"",
            "floors.0.on",
            "no block named",
            "back",
        ),
        (
            ", \"back.top\"",
            "",
            "floors.0.on",
            "no face lies opposite",
            "one face",
        ),
        (
            "\"back.top\"",
            "\"back.left\"",
            "floors.0.on",
            "lies opposite",
            "one face",
        ),
        (
            "name = \"first\"",
            "name = \"1st\"",
            "floors.0.name",
            "no name for a floor",
            "letter",
        ),
        (
            "load = 0.003",
            "load = 0.003\n[[symmetry]]\nnormal = \"x\"\nat = 1500",
            "floors",
            "planes of symmetry",
            "whole",
        ),
    ];
    refuses(&good, bad);
    let narrow = good.replace("mesh = [6, 1, 2]", "mesh = [1, 1, 2]");
    let springs: &[Bad] = &[(
        "load = 0.003",
        "shear = 5",
        "floors.0.on",
        "no room for first-braces",
        "mesh",
    )];
    refuses(&narrow, springs);
}

/// A floor on a wall that is 300 mm thick at one end and 60 mm at the other, 1200 mm away, weighs at the centroid of its
/// top, (300 + 2 × 60)/(300 + 60) of a third of its length away.
#[test]
fn a_floor_weighs_at_the_centroid_of_its_facets() {
    let (_, model) = deck_and_model(&format!(
        "{HEAD}[[blocks]]\nname = \"wall\"\nmaterial = \"stone\"\n\
         corners = [[0, 0, 0], [1200, 120, 0], [1200, 180, 0], [0, 300, 0], [0, 0, 400], [1200, 120, 400], \
         [1200, 180, 400], [0, 300, 400]]\n[[supports]]\non = \"wall.bottom\"\n\
         [[floors]]\nname = \"roof\"\non = \"wall.top\"\nmass = 0.5\n{GRAVITY}"
    ));
    let masses = &model.floors[0].masses;
    let moment: f64 = masses
        .iter()
        .map(|(n, mass)| mass * model.mesh.nodes[*n as usize][0])
        .sum();
    let known = 1200.0 / 3.0 * 420.0 / 360.0;
    let found = moment / model.floors[0].mass();
    assert!((found / known - 1.0).abs() < 1e-9, "{found} {known}"); // rounding
}
