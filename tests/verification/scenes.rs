//! Scenes of blocks and arches: what a deck builds, and what it refuses.

use std::path::Path;
use wythe::model::scene::{BeamMotion, ContactPoints, Gravity};
use wythe::model::{Deck, Model, check};

/// Rounding of a few hundred sums of coordinates, relative to their size.
const ROUNDING: f64 = 1e-12;

const HEAD: &str = r#"
format = 1

[materials.stone]
E = "5 GPa"
nu = 0.2
density = "2000 kg/m^3"

[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.4
mu = 0.4

[interfaces.smooth]
f_t = 0
c = 0
tan_phi = 0
mu = 0

[contact]
points = "corner"
"#;

/// A base, and a block of another mesh on it.
const PAIR: &str = r#"
[[blocks]]
name = "base"
size = [400, 200, 50]
at = [-100, -50, -50]
material = "stone"
mesh = [2, 1, 1]

[[blocks]]
name = "top"
size = [200, 100, 80]
material = "stone"
mesh = [4, 2, 1]
velocity = ["1 m/s", 0, 0]

[[contacts]]
slave = "top.bottom"
master = "base.top"
interface = "dry"

[[supports]]
on = "base"
"#;

const GRAVITY: &str = "\n[[steps]]\nkind = \"gravity\"\n";

fn deck(text: &str) -> Deck {
    Deck::from_str(text, "scene.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn model(scene: &str, steps: &str) -> Model {
    let deck = deck(&format!("{HEAD}{scene}{steps}"));
    Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}")).0
}

fn nodes(model: &Model, facet: [u32; 4]) -> [[f64; 3]; 4] {
    facet.map(|n| model.mesh.nodes[n as usize])
}

fn area_vector(q: [[f64; 3]; 4]) -> [f64; 3] {
    let d = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let (u, v) = (d(q[2], q[0]), d(q[3], q[1]));
    [
        0.5 * (u[1] * v[2] - u[2] * v[1]),
        0.5 * (u[2] * v[0] - u[0] * v[2]),
        0.5 * (u[0] * v[1] - u[1] * v[0]),
    ]
}

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn volume(model: &Model, body: u32) -> f64 {
    let of = |e: &usize| model.mesh.unit[*e] == body;
    (0..model.mesh.elements.len())
        .filter(of)
        .map(|e| model.mesh.volume(e))
        .sum()
}

/// Every facet's normal points away from the centre of its body.
fn normals_point_out(model: &Model) {
    let contact = &model.contact;
    let slaves = contact.slave_facets.iter().zip(&contact.slave_body);
    let masters = contact.master_facets.iter().zip(&contact.master_body);
    for (facet, body) in slaves.chain(masters) {
        let mut of_body: Vec<u32> = (0..model.mesh.elements.len())
            .filter(|e| model.mesh.unit[*e] == *body)
            .flat_map(|e| model.mesh.elements[e])
            .collect();
        of_body.sort_unstable();
        of_body.dedup();
        assert!(facet.iter().all(|n| of_body.contains(n)));
        let centre = [0, 1, 2].map(|d| {
            let sum: f64 = of_body
                .iter()
                .map(|n| model.mesh.nodes[*n as usize][d])
                .sum();
            sum / of_body.len() as f64
        });
        let x = nodes(model, *facet);
        let out: f64 = (0..3)
            .map(|d| area_vector(x)[d] * (x.iter().map(|x| x[d]).sum::<f64>() / 4.0 - centre[d]))
            .sum();
        assert!(out > 0.0, "facet {facet:?} of body {body} looks inwards");
    }
}

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
    // k_n = 500 min E/h (theory C.8): the softer side is the higher block.
    near(contact.laws[0].normal_stiffness, 500.0 * 5000.0 / 80.0);
    near(contact.laws[0].shear_stiffness, 500.0 * 5000.0 / 80.0 / 2.4);
    // Velocities of the block alone.
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
    // The +x end of a turn about y goes down.
    assert!(a.mesh.nodes.iter().any(|x| x[2] < 30.0 - 0.49 * l));
}

#[test]
fn an_arch_is_made_of_equal_voussoirs_on_springings() {
    let arch = r#"
[arch]
radius = "1 m"
thickness = 105
width = 200
voussoirs = 7
material = "stone"
interface = "dry"
mesh = [2, 1, 3]
"#;
    let model = model(arch, GRAVITY);
    // A flat-faced voussoir is a prism: ½ (r_o² − r_i²) sin β × width with β = π/7.
    let beta = std::f64::consts::PI / 7.0;
    let exact = 0.5 * (1052.5_f64.powi(2) - 947.5_f64.powi(2)) * beta.sin() * 200.0;
    for body in 0..7 {
        let found = volume(&model, body);
        assert!(
            (found - exact).abs() <= exact * ROUNDING,
            "{found} is not {exact}"
        );
    }
    // The springings: t deep, 1.5 t along the radius.
    for body in [7, 8] {
        let exact = 105.0 * 157.5 * 200.0;
        assert!((volume(&model, body) - exact).abs() <= exact * ROUNDING);
    }
    normals_point_out(&model);
    // 8 joints of 1 × 3 facets; the masters of the springings are single facets
    assert_eq!(model.contact.slave_facets.len(), 24);
    assert_eq!(model.contact.master_facets.len(), 6 * 3 + 2);
    // Facets of slaves cover the 8 joints of t × width.
    let area: f64 = (model.contact.slave_facets.iter())
        .map(|f| norm(area_vector(nodes(&model, *f))))
        .sum();
    let exact = 8.0 * 105.0 * 200.0;
    assert!((area - exact).abs() <= exact * ROUNDING);
    // Neighbours have their joint in the same place, to the bit.
    let on_masters: Vec<[f64; 3]> = (model.contact.master_facets.iter())
        .flat_map(|f| nodes(&model, *f))
        .collect();
    let inner = (model
        .contact
        .slave_facets
        .iter()
        .zip(&model.contact.slave_body))
    .filter(|(f, _)| nodes(&model, **f).iter().all(|x| x[2] > 1.0));
    let mut count = 0;
    for (facet, _) in inner {
        count += 1;
        assert!(nodes(&model, *facet).iter().all(|x| on_masters.contains(x)));
    }
    assert_eq!(count, 6 * 3);
    assert_eq!(model.supports[0].nodes.len(), 16);
    // The feet are level.
    let lowest = |body: u32| {
        let elements = (0..model.mesh.elements.len()).filter(|e| model.mesh.unit[*e] == body);
        let x = elements.flat_map(|e| model.mesh.corners(e));
        x.map(|x| x[2]).fold(f64::INFINITY, f64::min)
    };
    // sin and cos of π/2 in floating point
    assert!(lowest(0).abs() <= 1e-12 * 1000.0 && lowest(6).abs() <= 1e-12 * 1000.0);

    let by_span = arch.replace("radius = \"1 m\"", "span = 1895");
    let same = self::model(&by_span, GRAVITY);
    assert_eq!(same.mesh.nodes, model.mesh.nodes);
}

#[test]
fn touching_faces_find_each_other_in_running_bond() {
    let wall = r#"
[[blocks]]
name = "table"
size = [1400, 300, 100]
at = [-200, -50, -100]
material = "stone"

[[blocks]]
name = "even"
size = [400, 200, 175]
mesh = [2, 1, 1]
copies = [2, 1, 2]
pitch = [400, 0, 350]
material = "stone"

[[blocks]]
name = "odd"
size = [400, 200, 175]
mesh = [2, 1, 1]
at = [200, 0, 175]
copies = [1, 1, 2]
pitch = [0, 0, 350]
material = "stone"

[[blocks]]
name = "half"
size = [200, 200, 175]
at = [0, 0, 175]
copies = [2, 1, 2]
pitch = [600, 0, 350]
material = "stone"

[[contacts]]
interface = "dry"

[[supports]]
on = "table"
"#;
    let model = model(wall, GRAVITY);
    assert_eq!(model.mesh.elements.len(), 1 + 2 * 4 + 2 * 2 + 4);
    normals_point_out(&model);
    // Every joint is covered once by slaves and can be met by masters. Courses of 800 × 200: bed joints
    // below 4 courses (table included), of slaves or masters of the upper and lower course.
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
    // Nothing is slave and master of the same joint: each slave finds an opposite master in its place.
    let report = check(&deck(&format!("{HEAD}{wall}{GRAVITY}")), &model);
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    assert_eq!(report.sizes.units, 11);
    // Without a line of the mesh above the head joints, points do not know where the units end.
    let coarse = wall.replace("mesh = [2, 1, 1]\n", "");
    let coarse_model = self::model(&coarse, GRAVITY);
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
    // Downhill is +x if the ground is turned about y; g = 10000 mm/s².
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
            // two turns, rounded each
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
    assert_eq!(model.steps[0].driven, Some((0, 0)));
    assert_eq!(model.steps[1].driven, Some((0, 0)));
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
    // Lifted off its base it floats; on it, it does not.
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
    // A spring holds too.
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
        "tests/data/scenes/stick_slip",
    ] {
        let path = root.join(name).with_extension("toml");
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("# "), "{name} opens with a drawing");
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
            let (model, warnings) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}"));
            assert!(warnings.is_empty(), "{}: {warnings:?}", path.display());
            normals_point_out(&model);
            decks += 1;
        }
    }
    assert!(decks > 0);
}

/// What is replaced in the good scene, by what, the key of the error, part of it, part of the advice.
const BAD: &[(&str, &str, &str, &str, &str)] = &[
    (
        "name = \"top\"",
        "name = \"a.b\"",
        "blocks.1.name",
        "is no name",
        "a dot parts",
    ),
    (
        "name = \"top\"",
        "name = \"base\"",
        "blocks.1.name",
        "two blocks named `base`",
        "of its own",
    ),
    (
        "size = [200, 100, 80]",
        "size = [200, 0, 80]",
        "blocks.1.size.1",
        "0 is not positive",
        "above 0",
    ),
    (
        "size = [200, 100, 80]",
        "size = [200, \"1 s\", 80]",
        "blocks.1.size.1",
        "expected a length",
        "size = [",
    ),
    (
        "size = [200, 100, 80]\n",
        "",
        "blocks.1.size",
        "neither `size` nor `corners`",
        "size = [",
    ),
    (
        "size = [200, 100, 80]",
        "sise = [200, 100, 80]",
        "blocks.1.sise",
        "not a known key",
        "`size`",
    ),
    (
        "mesh = [4, 2, 1]",
        "mesh = [4, 0, 1]",
        "blocks.1.mesh",
        "leaves no element",
        "along x, y, z",
    ),
    (
        "mesh = [4, 2, 1]",
        "mesh = \"coarse\"",
        "blocks.1.mesh",
        "expected an array",
        "along x, y, z",
    ),
    (
        "mesh = [4, 2, 1]",
        "mesh = [4000, 4000, 4000]",
        "blocks.1.mesh",
        "too many",
        "coarsen",
    ),
    (
        "mesh = [4, 2, 1]",
        "copies = [2, 1, 1]",
        "blocks.1.pitch",
        "the same place",
        "pitch =",
    ),
    (
        "mesh = [4, 2, 1]",
        "copies = [0, 1, 1]",
        "blocks.1.copies",
        "0 copies",
        "at least 1",
    ),
    (
        "mesh = [4, 2, 1]",
        "pitch = [1, 1, 1]",
        "blocks.1.pitch",
        "no copies",
        "copies =",
    ),
    (
        "size = [200, 100, 80]",
        "corners = [[0,0,0],[1,0,0],[0,1,0],[1,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1]]",
        "blocks.1.corners",
        "not in order",
        "above them",
    ),
    (
        "mesh = [4, 2, 1]",
        "rotate = { axis = \"up\", angle = 3 }",
        "blocks.1.rotate.axis",
        "`up` is not a known choice",
        "x, y, z",
    ),
    (
        "velocity = [\"1 m/s\"",
        "velocity = [\"1 m\"",
        "blocks.1.velocity.0",
        "expected a velocity",
        "velocity =",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = \"topp.bottom\"",
        "contacts.0.slave",
        "no block named `topp`",
        "did you mean `top`?",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = \"top.under\"",
        "contacts.0.slave",
        "no face `under`",
        "bottom (-z)",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = \"top\"",
        "contacts.0.slave",
        "`top` is no face",
        "top.top",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = \"top.top\"",
        "contacts.0",
        "no master faces it",
        "look at each other",
    ),
    (
        "slave = \"top.bottom\"",
        "slave = []",
        "contacts.0.slave",
        "the list is empty",
        "name a block",
    ),
    (
        "slave = \"top.bottom\"\n",
        "",
        "contacts.0.slave",
        "`slave` is missing",
        "neither",
    ),
    (
        "master = \"base.top\"",
        "master = \"top.top\"",
        "contacts.0",
        "meet itself",
        "different blocks",
    ),
    (
        "interface = \"dry\"",
        "interface = \"dri\"",
        "contacts.0.interface",
        "no interface named `dri`",
        "`dry`",
    ),
    (
        "interface = \"dry\"",
        "interface = \"smooth\"",
        "interfaces.smooth",
        "neither bond nor friction",
        "give mu",
    ),
    (
        "on = \"base\"",
        "on = \"bass\"",
        "supports.0.on",
        "no block named `bass`",
        "did you mean `base`?",
    ),
    (
        "on = \"base\"",
        "on = \"base\"\nfixed = []",
        "supports.0.fixed",
        "holds no direction",
        "fixed =",
    ),
    (
        "on = \"base\"",
        "on = \"base\"\nfixed = [\"up\"]",
        "supports.0.fixed.0",
        "not a known choice",
        "known here: x, y, z",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\ngravity = \"9.81 m/s\"",
        "steps.0.gravity",
        "expected an acceleration",
        "m/s^2",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\ngravity = 0",
        "steps.0.gravity",
        "0 is not positive",
        "above 0",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"tilt\"\nangle = 3",
        "steps.0.kind",
        "no gravity yet",
        "a step before",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"tilt\"",
        "steps.0.angle",
        "`angle` is missing",
        "angle =",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\nangle = 500",
        "steps.0.angle",
        "half a turn",
        "angle =",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\naxis = \"z\"",
        "steps.0.axis",
        "tilts nothing",
        "axis =",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\nface = \"top.top\"",
        "steps.0.face",
        "belongs to a preload or drive",
        "of its own",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"preload\"\ntop_pressure = 1",
        "steps.0.top_pressure",
        "scene of a wall",
        "`pressure`",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"preload\"\nface = \"top.top\"\npressure = -1",
        "steps.0.pressure",
        "pulls",
        "compression",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"drive\"\nface = \"base.top\"\ndirection = \"x\"\ndisplacement = 1",
        "steps.0.face",
        "supports hold base.top",
        "another face",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"drive\"\nspring = \"s\"\ndirection = \"x\"\ndisplacement = 1",
        "steps.0.spring",
        "no spring named `s`",
        "[[springs]]",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"drive\"\nface = \"top.top\"\ndirection = \"x\"\ndisplacement = 1\nfree = [\"x\"]",
        "steps.0.free",
        "cannot be free",
        "other directions",
    ),
    (
        "density = \"2000 kg/m^3\"",
        "",
        "materials.stone.density",
        "has no mass",
        "density =",
    ),
    (
        "[contact]",
        "[wall]\nunit = [4, 4, 4]\nbed_joint = 1\nhead_joint = 1\nlength = 4\ncourses = 2\nunit_material = \"stone\"\nmortar_material = \"stone\"\ninterface = \"dry\"\n[contact]",
        "wall",
        "either a wall",
        "take out",
    ),
];

#[test]
fn bad_scenes_name_the_key_and_the_fix() {
    let good = format!("{HEAD}{PAIR}{GRAVITY}");
    let mut wrong = Vec::new();
    for (from, to, key, message, advice) in BAD {
        assert!(good.contains(from), "{from}");
        // the last one: blocks say some keys twice
        let at = good.rfind(from).unwrap();
        let bad = format!("{}{to}{}", &good[..at], &good[at + from.len()..]);
        let error = Deck::from_str(&bad, "scene.toml")
            .and_then(|deck| Model::from_deck(&deck))
            .map_or_else(|e| e, |_| panic!("accepted: {to}"));
        let right = error.key() == *key
            && error.message().contains(message)
            && error.advice().contains(advice)
            && error.line().is_some()
            && error.file() == "scene.toml";
        if !right {
            wrong.push(format!("{to}\n{error}\n(advice: {})\n", error.advice()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What is replaced in a good arch, by what, the key of the error, part of it.
const BAD_ARCHES: &[(&str, &str, &str, &str)] = &[
    (
        "radius = 1000",
        "",
        "arch.radius",
        "neither `radius` nor `span`",
    ),
    (
        "radius = 1000",
        "radius = 1000\nspan = 1900",
        "arch.span",
        "both",
    ),
    (
        "radius = 1000",
        "radius = -1000",
        "arch.radius",
        "not positive",
    ),
    (
        "thickness = 105",
        "thickness = 1100",
        "arch.thickness",
        "no arch",
    ),
    ("width = 200", "width = 0", "arch.width", "not positive"),
    (
        "voussoirs = 7",
        "voussoirs = 1",
        "arch.voussoirs",
        "no arch",
    ),
    (
        "voussoirs = 7",
        "voussoirs = 7\nangle = 200",
        "arch.angle",
        "an arch over 200",
    ),
    (
        "voussoirs = 7",
        "voussoirs = 7\nmesh = [1, 1, 0]",
        "arch.mesh",
        "leaves no element",
    ),
    (
        "material = \"stone\"",
        "material = \"stobe\"",
        "arch.material",
        "no material named",
    ),
    (
        "interface = \"dry\"",
        "interface = \"wet\"",
        "arch.interface",
        "no interface named",
    ),
    (
        "interface = \"dry\"",
        "interface = \"dry\"\nrise = 3",
        "arch.rise",
        "not a known key",
    ),
];

#[test]
fn bad_arches_name_the_key() {
    let arch = "[arch]\nradius = 1000\nthickness = 105\nwidth = 200\nvoussoirs = 7\n\
                material = \"stone\"\ninterface = \"dry\"\n";
    model(arch, GRAVITY);
    for (from, to, key, message) in BAD_ARCHES {
        assert!(arch.contains(from));
        let bad = format!("{HEAD}{}{GRAVITY}", arch.replace(from, to));
        let error = Deck::from_str(&bad, "scene.toml")
            .and_then(|deck| Model::from_deck(&deck))
            .map_or_else(|e| e, |_| panic!("accepted: {to}"));
        assert_eq!(error.key(), *key, "{error}");
        assert!(error.message().contains(message), "{error}");
    }
}

#[test]
fn faces_that_share_nodes_cannot_be_driven_apart() {
    let steps = "[[steps]]\nkind = \"drive\"\nface = \"top.top\"\ndirection = \"x\"\ndisplacement = 1\n\
                 [[steps]]\nkind = \"drive\"\nface = \"top.right\"\ndirection = \"x\"\ndisplacement = 1\n";
    let error = Model::from_deck(&deck(&format!("{HEAD}{PAIR}{steps}"))).unwrap_err();
    assert_eq!(error.key(), "steps.1.face");
    assert!(
        error.message().contains("in common with top.top"),
        "{error}"
    );
}
