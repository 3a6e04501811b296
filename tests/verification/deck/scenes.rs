//! Block scenes: models from decks.

use std::path::Path;

use crate::common::blocks::{
    GRAVITY, HEAD, PAIR, ROUNDING, area_vector, deck, model, nodes, norm, normals_point_out, volume,
};
use wythe::contact::JointLaw;
use wythe::deck::{Deck, check};
use wythe::model::Model;
use wythe::model::scene::{BeamMotion, ContactPoints, Gravity};

#[test]
fn boxes_have_their_sizes_faces_masses_and_velocities() {
    let model = model(PAIR, GRAVITY);
    let near = |a: f64, b: f64| assert!((a - b).abs() <= ROUNDING * b, "{a} is not {b}");
    near(volume(&model, 0), 400.0 * 200.0 * 50.0);
    near(volume(&model, 1), 200.0 * 100.0 * 80.0);
    let contact = &model.contact;
    assert_eq!(contact.slave_facets.len(), 8);
    assert_eq!(contact.master_facets.len(), 2);
    assert!(contact.slave_body.iter().all(|b| *b == 1));
    assert!(contact.master_body.iter().all(|b| *b == 0));
    let area = |facets: &[[u32; 4]]| {
        facets
            .iter()
            .map(|f| norm(area_vector(nodes(&model, *f))))
            .sum()
    };
    near(area(&contact.slave_facets), 200.0 * 100.0);
    near(area(&contact.master_facets), 400.0 * 200.0);
    normals_point_out(&model);
    assert_eq!(contact.points, ContactPoints::Corner);
    // k_n = 500 min E/h (theory/joint.md, eq. 32): the taller block is the softer side.
    let [normal, shear] = contact.laws[0].stiffness();
    near(normal, 500.0 * 5000.0 / 80.0);
    near(shear, 500.0 * 5000.0 / 80.0 / 2.4);
    // Only the block has a velocity.
    let of_block: Vec<bool> = (0..model.mesh.nodes.len())
        .map(|n| {
            let mut elements = 0..model.mesh.elements.len();
            elements
                .any(|e| model.mesh.unit[e] == 1 && model.mesh.elements[e].contains(&(n as u32)))
        })
        .collect();
    for (moves, v) in of_block.iter().zip(&model.initial_velocity) {
        assert_eq!(*v, if *moves { [1000.0, 0.0, 0.0] } else { [0.0; 3] });
    }
    let held = &model.supports[0];
    assert_eq!(held.nodes.len(), 12);
    assert_eq!(held.fixed, [true; 3]);
    assert_eq!(
        model.steps[0].gravity,
        Gravity::Growing([0.0, 0.0, -9810.0])
    );
}

#[test]
fn turned_boxes_and_corners_are_the_same_block() {
    let by_size = r#"
[[blocks]]
name = "b"
size = [200, 100, 80]
at = [10, 20, 30]
rotate = { axis = "y", angle = 30 }
material = "stone"
mesh = [2, 3, 4]

[[supports]]
on = "b"
"#;
    // x' = x cos θ + z sin θ, z' = z cos θ - x sin θ about y
    let turn = |x: f64, y: f64, z: f64| {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        [x * cos + z * sin, y, z * cos - x * sin]
    };
    let (l, t, h) = (200.0, 100.0, 80.0);
    let corners = [
        turn(0.0, 0.0, 0.0),
        turn(l, 0.0, 0.0),
        turn(l, t, 0.0),
        turn(0.0, t, 0.0),
        turn(0.0, 0.0, h),
        turn(l, 0.0, h),
        turn(l, t, h),
        turn(0.0, t, h),
    ];
    let by_corners = format!(
        "[[blocks]]\nname = \"b\"\ncorners = {corners:?}\nat = [10, 20, 30]\nmaterial = \"stone\"\n\
         mesh = [2, 3, 4]\n[[supports]]\non = \"b\"\n"
    );
    let (a, b) = (model(by_size, GRAVITY), model(&by_corners, GRAVITY));
    assert_eq!(a.mesh.elements, b.mesh.elements);
    for (a, b) in a.mesh.nodes.iter().zip(&b.mesh.nodes) {
        for d in 0..3 {
            // rounding of coordinates of 200 mm
            assert!((a[d] - b[d]).abs() <= 200.0 * ROUNDING);
        }
    }
    assert!((volume(&a, 0) - l * t * h).abs() <= l * t * h * ROUNDING);
    // A rotation about y moves the +x end down.
    assert!(a.mesh.nodes.iter().any(|x| x[2] < 30.0 - 0.49 * l));
}

#[test]
fn touching_faces_find_each_other_in_running_bond() {
    // Name, length, position along x and z, number of copies along x and their pitch [mm].
    let units = [
        ("even", 400, [0, 0], [2, 400]),
        ("odd", 400, [200, 175], [1, 0]),
        ("half", 200, [0, 175], [2, 600]),
    ]
    .map(|(name, length, [x, z], [copies, pitch])| {
        let cells = length / 200;
        format!(
            r#"
[[blocks]]
name = "{name}"
size = [{length}, 200, 175]
mesh = [{cells}, 1, 1]
at = [{x}, 0, {z}]
copies = [{copies}, 1, 2]
pitch = [{pitch}, 0, 350]
material = "stone"
"#
        )
    })
    .concat();
    let wall = format!(
        r#"
[[blocks]]
name = "table"
size = [1400, 300, 100]
at = [-200, -50, -100]
material = "stone"
{units}
[[contacts]]
interface = "dry"

[[supports]]
on = "table"
"#
    );
    let model = model(&wall, GRAVITY);
    assert_eq!(model.mesh.elements.len(), 1 + 2 * 4 + 2 * 2 + 4);
    normals_point_out(&model);
    // Every joint is covered once by slave facets and has master facets. Courses of 800 × 200: bed joints below 4
    // courses (including the table), with slaves or masters of the upper and lower course.
    let contact = &model.contact;
    let slaves = contact.slave_facets.iter().map(|f| nodes(&model, *f));
    let masters = contact.master_facets.iter().map(|f| nodes(&model, *f));
    let (slaves, masters): (Vec<_>, Vec<_>) = (slaves.collect(), masters.collect());
    let level = |q: &[[f64; 3]; 4], z: f64| q.iter().all(|x| x[2] == z);
    for z in [0.0, 175.0, 350.0, 525.0] {
        let area = |of: &[[[f64; 3]; 4]]| -> f64 {
            let at = of.iter().filter(|q| level(q, z));
            at.map(|q| norm(area_vector(*q))).sum()
        };
        assert_eq!(area(&slaves), 800.0 * 200.0, "bed joint at {z}");
        assert!(area(&masters) >= 800.0 * 200.0, "bed joint at {z}");
    }
    // Head joints: 1 in each even course, 2 in each odd one.
    let upright = slaves.iter().filter(|q| area_vector(**q)[0] != 0.0).count();
    assert_eq!(upright, 2 + 4);
    // No face is both slave and master of the same joint: each slave finds a master opposite.
    let report = check(&deck(&format!("{HEAD}{wall}{GRAVITY}")), &model);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(report.sizes.units, 11);
    // Without a mesh line above the head joints, points do not resolve the ends of the units.
    let coarse = wall.replace("mesh = [2, 1, 1]\n", "");
    let coarse_model = crate::common::blocks::model(&coarse, GRAVITY);
    let report = check(&deck(&format!("{HEAD}{coarse}{GRAVITY}")), &coarse_model);
    let said = report
        .warnings
        .iter()
        .any(|w| w.message.contains("reach over the edge"));
    assert!(said, "{:?}", report.warnings);
}

#[test]
fn gravity_grows_tilts_and_stays() {
    let steps = r#"
[[steps]]
kind = "gravity"
gravity = "10 m/s^2"

[[steps]]
kind = "tilt"
angle = 20
axis = "y"

[[steps]]
kind = "tilt"
angle = 30

[[steps]]
kind = "free"
duration = 2

[[steps]]
kind = "free"
angle = 0
"#;
    let model = model(PAIR, steps);
    let at = |step: usize, fraction: f64| model.steps[step].gravity.at(fraction);
    // Downhill is +x if the ground is rotated about y; g = 10000 mm/s².
    let tilted = |degrees: f64| {
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        [1e4 * sin, 0.0, -1e4 * cos]
    };
    for (step, fraction, exact) in [
        (0, 0.0, [0.0; 3]),
        (0, 0.5, [0.0, 0.0, -5e3]),
        (1, 0.0, tilted(0.0)),
        (1, 0.25, tilted(5.0)),
        (2, 0.0, tilted(20.0)),
        (2, 1.0, tilted(30.0)),
        (3, 0.7, tilted(30.0)),
        (4, 0.0, tilted(0.0)),
    ] {
        let found = at(step, fraction);
        for d in 0..3 {
            // two rotations, one rounding each
            assert!(
                (found[d] - exact[d]).abs() <= 1e-11,
                "{step}: {found:?}, {exact:?}"
            );
        }
    }
    assert_eq!(model.steps[3].duration, 2.0);
    assert_eq!(model.steps[3].name, "free");
}

#[test]
fn faces_move_as_the_steps_say() {
    let scene =
        format!("{PAIR}\n[[springs]]\nname = \"pull\"\non = \"top\"\nstiffness = [20, 0, 0]\n");
    let steps = r#"
[[steps]]
kind = "preload"
face = "top.top"
pressure = "0.5 MPa"

[[steps]]
kind = "drive"
face = "top.top"
direction = "-x"
displacement = 3
free = ["z"]

[[steps]]
kind = "gravity"

[[steps]]
kind = "drive"
spring = "pull"
direction = "x"
displacement = 2
"#;
    use BeamMotion::{Driven, Force, Locked};
    let model = model(&scene, steps);
    let beam = &model.beams[0];
    assert_eq!(
        (beam.name.as_str(), beam.normal),
        ("top.top", [0.0, 0.0, 1.0])
    );
    assert_eq!(beam.nodes.len(), 15);
    assert!((beam.area - 2e4).abs() <= 2e4 * ROUNDING);
    // Pressure × area, downwards.
    let load = -0.5 * beam.area;
    let motions: Vec<_> = model.steps.iter().map(|s| s.motion[0]).collect();
    assert_eq!(motions[0], [Locked, Locked, Force(load)]);
    assert_eq!(motions[1], [Driven(-3.0), Locked, Force(load)]);
    assert_eq!(motions[2], [Locked, Locked, Force(load)]);
    assert_eq!(motions[3], motions[2]);
    assert_eq!(
        model.steps[0].driven,
        Some(wythe::model::scene::Driven::along(0, 0))
    );
    assert_eq!(
        model.steps[1].driven,
        Some(wythe::model::scene::Driven::along(0, 0))
    );
    assert_eq!(model.springs[0].stiffness, [20.0, 0.0, 0.0]);
    assert_eq!(model.springs[0].nodes.len(), 30);
    assert_eq!(model.steps[3].springs, [[2.0, 0.0, 0.0]]);
    assert_eq!(model.steps[1].springs, [[0.0; 3]]);
}

#[test]
fn scenes_survive_a_round_trip() {
    let arch = "[arch]\nspan = 900\nthickness = 100\nwidth = 200\nvoussoirs = 5\nangle = 120\n\
                material = \"stone\"\ninterface = \"dry\"\n";
    let turned = PAIR.replace("mesh = [4, 2, 1]", "rotate = { axis = \"-x\", angle = 0 }");
    for scene in [PAIR, arch, &turned] {
        let steps = "[[steps]]\nkind = \"gravity\"\nangle = 5\n[[steps]]\nkind = \"free\"\n";
        let first = deck(&format!("{HEAD}{scene}{steps}"));
        let text = first.to_toml().unwrap();
        assert_eq!(deck(&text), first, "{text}");
    }
}

#[test]
fn a_block_that_flies_needs_no_support() {
    let flying = r#"
[[blocks]]
name = "b"
size = [1, 1, 1]
material = "stone"
"#;
    let free = "[[steps]]\nkind = \"free\"\ngravity = \"9.81 m/s^2\"\n";
    let flies = model(flying, free);
    assert_eq!(
        flies.steps[0].gravity,
        Gravity::Constant([0.0, 0.0, -9810.0])
    );
    let text = format!("{HEAD}{flying}{GRAVITY}");
    let error = Model::from_deck(&deck(&text)).unwrap_err();
    assert!(error.message().contains("b is held by nothing"), "{error}");
    // Lifted off its base the block floats; on the base it does not.
    let lifted = PAIR.replace(
        "size = [200, 100, 80]",
        "size = [200, 100, 80]\nat = [0, 0, 50]",
    );
    let text = format!("{HEAD}{lifted}{GRAVITY}");
    let error = Model::from_deck(&deck(&text)).unwrap_err();
    assert!(
        error.message().contains("top is held by nothing"),
        "{error}"
    );
    // A spring is a support, too.
    let hung = format!("{lifted}[[springs]]\nname = \"s\"\non = \"top\"\nstiffness = [1, 1, 1]\n");
    model(&hung, GRAVITY);
}

#[test]
fn the_examples_build() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in [
        "examples/05_sliding_block",
        "examples/06_tilted_column",
        "examples/07_arch",
        "examples/08_block_couplet",
        "examples/30_toppling_stack",
        "examples/40_airbag",
        "examples/41_cyclic_block",
        "tests/data/scenes/stick_slip",
    ] {
        let path = root.join(name).with_extension("toml");
        let text = std::fs::read_to_string(&path).unwrap();
        let drawing = text.lines().find(|line| !line.starts_with("#:"));
        assert!(
            drawing.is_some_and(|line| line.starts_with("# ")),
            "{name} opens with a drawing"
        );
        let deck = Deck::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let (model, warnings) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}"));
        assert!(warnings.is_empty(), "{name}: {warnings:?}");
        normals_point_out(&model);
    }
}

#[test]
fn the_cases_of_the_atlas_build() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/stability/cases");
    let mut decks = 0;
    for case in std::fs::read_dir(cases).unwrap() {
        for file in std::fs::read_dir(case.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if !name.starts_with("deck") {
                continue;
            }
            let deck = Deck::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
            // Some models lie at the limits of the warnings.
            let (model, _) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}"));
            normals_point_out(&model);
            decks += 1;
        }
    }
    assert!(decks > 0);
}
