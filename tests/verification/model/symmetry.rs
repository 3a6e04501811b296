//! Planes of symmetry: the modelled part gives the curve of the whole; asymmetric models are rejected.

use crate::common::blocks::{self, Bad, deck_and_model as model, refuses};
use crate::common::scene::rows;
use wythe::contact::InterfaceLaw;
use wythe::deck::check;

const STONE: &str = "format = 1
[materials.stone]
E = 5000
nu = 0.2
density = \"2000 kg/m^3\"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.6
mu = 0.6
normal_stiffness = 50
shear_stiffness = 20
[wall]
unit = [200, 100, 80]
bed_joint = 0
head_joint = 0
length = 600
unit_material = \"stone\"
interface = \"dry\"
mesh = [4, 2, 2]
clamped = false
";

fn plane(normal: &str, at: f64, keep: &str) -> String {
    format!("[[symmetry]]\nnormal = \"{normal}\"\nat = {at}\nkeep = \"{keep}\"\n")
}

fn hold(on: &str, axis: &str, corners: &str) -> String {
    format!("[[supports]]\non = \"{on}\"\nfixed = [\"{axis}\"]\nbox = {corners}\n")
}

/// A compressed prism of dry stones, whole, in halves and quarters, on either side of the planes.
#[test]
fn parts_of_a_prism_carry_parts_of_its_load() {
    let steps = "[[supports]]
on = \"wall.bottom\"
fixed = [\"z\"]
[[steps]]
kind = \"preload\"
face = \"wall.top\"
pressure = 0.5
free = [\"x\", \"y\"]
[[steps]]
kind = \"drive\"
face = \"wall.top\"
direction = \"-z\"
displacement = 0.5
";
    let whole = [
        hold("wall.bottom", "x", "[[300, 0, 0], [300, 100, 0]]"),
        hold("wall.bottom", "y", "[[0, 50, 0], [600, 50, 0]]"),
    ]
    .concat();
    let force = |planes: &str| {
        let text = format!("{STONE}courses = 4\n{planes}{steps}");
        let rows = rows(&blocks::deck(&text));
        let last = &rows[rows.len() - 1];
        [last.force_kN, last.elastic_energy_J, last.external_work_J]
    };
    let whole = force(&whole);
    let half = plane("x", 300.0, "below") + &hold("wall.bottom", "y", "[[0, 50, 0], [600, 50, 0]]");
    let through =
        plane("y", 50.0, "above") + &hold("wall.bottom", "x", "[[300, 0, 0], [300, 100, 0]]");
    let quarter = |keep| plane("x", 300.0, keep) + &plane("y", 50.0, "below");
    for (part, planes) in [
        (2.0, half),
        (2.0, through),
        (4.0, quarter("below")),
        (4.0, quarter("above")),
    ] {
        // Increments end in equilibrium within 2e-3 of the mean nodal force: 3e-7 measured for the force. Work is
        // summed over increments, which the parts choose themselves: 2e-5.
        let within = [1e-5, 1e-4, 1e-4];
        for ((whole, found), within) in whole.into_iter().zip(force(&planes)).zip(within) {
            assert!(
                (part * found / whole - 1.0).abs() < within,
                "{part} times {found} is not {whole}\n{planes}"
            );
        }
    }
}

const EXAMPLE: &str = include_str!("../../../examples/65_quarter_wall.toml");

/// Pressure of the airbag at these deflections of the middle [mm].
fn pressures(text: &str, at: &[f64]) -> Vec<f64> {
    let (deck, model) = model(text);
    let columns = model.columns();
    let place = |name: &str| columns.iter().position(|c| c == name).unwrap();
    let (deflection, step) = (place("middle_mm"), deck.steps.len() - 1);
    let curve: Vec<[f64; 2]> = rows(&blocks::deck(text))
        .iter()
        .filter(|r| r.step == step)
        .map(|r| [r.probes[deflection], r.load_factor])
        .collect();
    at.iter()
        .map(|&u| {
            let after = curve.iter().position(|p| p[0] >= u).unwrap();
            let ([a, p], [b, q]) = (curve[after - 1], curve[after]);
            p + (q - p) * (u - a) / (b - a)
        })
        .collect()
}

/// Example 65: out-of-plane bending beyond the load at which joints open, whole and by halves and quarters.
#[test]
fn a_quarter_of_a_wall_bends_like_the_whole() {
    let planes = EXAMPLE.find("[[symmetry]]").unwrap();
    let (probes, supports) = (
        EXAMPLE.find("[[probes]]").unwrap(),
        EXAMPLE.find("[[supports]]").unwrap(),
    );
    let (head, tail) = (&EXAMPLE[..planes], &EXAMPLE[probes..]);
    let tail = tail.replace("displacement = \"1 mm\"", "displacement = \"0.5 mm\"");
    let feet = hold("wall.back", "y", "[[0, 100, 0], [600, 100, 0]]");
    let head_of = hold("wall.back", "y", "[[0, 100, 400], [600, 100, 400]]");
    let middle = hold("wall", "z", "[[0, 0, 200], [600, 100, 200]]");
    let both = tail.replace("\"wall.bottom\"", "[\"wall.bottom\", \"wall.top\"]");
    let upright = hold("wall", "x", "[[300, 0, 200], [300, 100, 200]]");
    let whole = [head, &feet, &head_of, &middle, &upright, &both].concat();
    let half = [
        head,
        &feet,
        &head_of,
        &middle,
        &plane("x", 300.0, "below"),
        &both,
    ]
    .concat();
    let quarter = [head, &EXAMPLE[planes..supports], &feet, &tail].concat();
    let at = [0.05, 0.1, 0.2, 0.3, 0.45];
    let whole = pressures(&whole, &at);
    // Joints open well before the end: the stiffness drops to less than half.
    assert!(whole[4] / at[4] < 0.5 * whole[0] / at[0]);
    for part in [half, quarter] {
        for (found, whole) in pressures(&part, &at).into_iter().zip(&whole) {
            // The curve is interpolated between different increments: 4e-4 measured.
            assert!((found / whole - 1.0).abs() < 2e-3, "{found}, {whole}");
        }
    }
}

const MORTAR: &str = "format = 1
[materials.brick]
E = 16700
nu = 0.15
[materials.mortar]
E = 2300
nu = 0.15
[interfaces.joint]
f_t = 0.12
u_k = 0.36
zeta = 4.38
tan_phi = 0.58
c = 0.22
delta_k = 0.4
xi = 1.1
mu = 0.58
penalty_factor = 500
[wall]
unit = [112, 53, 36]
bed_joint = 10
head_joint = 10
length = 356
courses = 5
unit_material = \"brick\"
mortar_material = \"mortar\"
interface = \"joint\"
mesh = [5, 2, 2]
clamped = false
";

/// With mortar the halves of a wall are mirror images except for the faces at which joints open: the bond in the
/// plane now breaks in the middle of the mortar.
#[test]
fn half_a_wall_with_mortar_is_nearly_half_of_the_whole() {
    let common = [
        hold("wall.back", "y", "[[0, 53, 0], [356, 53, 0]]"),
        hold("wall.back", "y", "[[0, 53, 220], [356, 53, 220]]"),
        hold("wall.back", "y", "[[0, 53, 0], [0, 53, 220]]"),
    ]
    .concat();
    let steps = "[[supports]]
on = \"wall.bottom\"
fixed = [\"x\", \"z\"]
[[probes]]
name = \"middle\"
near = [178, 53, 110]
direction = \"y\"
[[steps]]
kind = \"load\"
procedure = \"displacement_control\"
control = { probe = \"middle\", displacement = 0.2 }
[[steps.loads]]
name = \"airbag\"
on = \"wall.front\"
pressure = 0.1
";
    let edge = hold("wall.back", "y", "[[356, 53, 0], [356, 53, 220]]");
    let at = [0.02, 0.05, 0.1, 0.18];
    let whole = pressures(&[MORTAR, &common, &edge, steps].concat(), &at);
    let half = pressures(
        &[MORTAR, &common, &plane("x", 178.0, "below"), steps].concat(),
        &at,
    );
    for (half, whole) in half.into_iter().zip(whole) {
        // 0.4 % at the peak, 1.4 % beyond it: the joint in the middle breaks at a place that differs by 5 mm.
        assert!((half / whole - 1.0).abs() < 0.02, "{half}, {whole}");
    }
}

/// Supports and contact of the part, by counting.
#[test]
fn planes_cut_units_and_joints() {
    let steps =
        "[[supports]]\non = \"wall.bottom\"\nfixed = [\"z\"]\n[[steps]]\nkind = \"gravity\"\n";
    let text = format!("{STONE}courses = 2\n{}{steps}", plane("x", 300.0, "below"));
    let (deck, model) = model(&text);
    // Half of the bed, and everything below the plane: 1.5 stones of 200, and a half and a whole one.
    let volume: f64 = (0..model.mesh.elements.len())
        .map(|e| model.mesh.volume(e))
        .sum();
    assert!((volume / (300.0 * 100.0 * 160.0) - 1.0).abs() < 1e-12);
    // The stone of the lower course is fixed at the plane, that of the upper one meets the mirror.
    let held = model
        .supports
        .iter()
        .find(|s| s.name == "symmetry-x")
        .unwrap();
    assert!(held.nodes.iter().all(|n| {
        let x = model.mesh.nodes[*n as usize];
        x[0] == 300.0 && x[2] <= 80.0
    }));
    assert_eq!(held.nodes.len(), 9);
    let mirror = model
        .supports
        .iter()
        .find(|s| s.name == "mirror-x")
        .unwrap();
    assert_eq!((mirror.nodes.len(), mirror.fixed), (4, [true; 3]));
    let laws = &model.contact.laws;
    let law = laws.iter().position(InterfaceLaw::is_half).unwrap();
    assert_eq!(model.contact.law_names[law], "dry");
    let own = laws[law].as_cohesive_frictional().unwrap();
    // Half the opening at the same traction, and no friction.
    assert_eq!((own.normal_stiffness, own.mu, own.c), (100.0, 0.0, 0.0));
    let facets = model
        .contact
        .slave_law
        .iter()
        .filter(|l| usize::from(**l) == law);
    // Four facets, each in quarters.
    assert_eq!(facets.count(), 16);
    let notes = check(&deck, &model).notes;
    assert!(
        notes.iter().any(|n| n.contains("half of the whole")),
        "{notes:?}"
    );
}

const BAD: &[Bad] = &[
    (
        "at = 300",
        "at = 250",
        "symmetry.0.at",
        "is not symmetric about x = 250 mm: in course 0 the unit wall-0-0",
        "whole units",
    ),
    (
        "at = 300",
        "at = -10",
        "symmetry.0.at",
        "lies beyond the plane",
        "keep =",
    ),
    (
        "at = 300",
        "at = 900",
        "symmetry.0.at",
        "nothing lies in the plane",
        "end there",
    ),
    (
        "length = 600",
        "length = 500",
        "symmetry.0.at",
        "is not symmetric",
        "whole units",
    ),
    (
        "mesh = [4, 2, 2]",
        "mesh = [3, 2, 2]",
        "symmetry.0.at",
        "would cut an element: the unit wall-0-1",
        "even number",
    ),
    (
        "normal = \"x\"",
        "normal = \"up\"",
        "symmetry.0.normal",
        "not a known choice",
        "x, y, z",
    ),
    (
        "keep = \"below\"",
        "keep = \"left\"",
        "symmetry.0.keep",
        "not a known choice",
        "below, above",
    ),
    (
        "keep = \"below\"",
        "keep = \"below\"\n[[symmetry]]\nnormal = \"x\"\nat = 0",
        "symmetry.1.normal",
        "two planes",
        "one plane",
    ),
    (
        "on = \"wall.bottom\"",
        "on = [\"wall.bottom\", \"wall.right\"]",
        "supports.0.on",
        "cuts the wall at this side",
        "leave it out",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\nangle = 3\naxis = \"y\"",
        "steps.0",
        "gravity pulls along x",
        "the whole scene",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"drive\"\nface = \"wall.top\"\ndirection = \"x\"\ndisplacement = 1",
        "steps.0.direction",
        "wall.top is driven along x, across",
        "the whole scene",
    ),
    (
        "kind = \"gravity\"",
        "kind = \"gravity\"\n[[blocks]]\nname = \"lintel\"\nsize = [600, 100, 50]\nat = [0, 0, 160]\nmaterial = \"stone\"",
        "symmetry.0.at",
        "lintel reaches 300.000 mm beyond the plane of symmetry x = 300 mm",
        "of blocks",
    ),
];

#[test]
fn models_without_the_symmetry_are_rejected() {
    let text = format!(
        "{STONE}courses = 2\n{}[[supports]]\non = \"wall.bottom\"\n[[steps]]\nkind = \"gravity\"\n",
        plane("x", 300.0, "below")
    );
    refuses(&text, BAD);
}

/// A chain line in the elevation and in each section or plan that the plane crosses, and one in the legend.
#[test]
fn planes_are_drawn() {
    let lines = |text: &str| {
        let (_, model) = model(text);
        let svg = wythe::results::plotting::scene(&model);
        svg.matches("stroke-dasharray").count()
    };
    let planes = EXAMPLE.find("[[symmetry]]").unwrap();
    let end = EXAMPLE.find("[[supports]]").unwrap();
    // x and z: two in the elevation, one in the section, one in each of two plans, and one in the legend.
    assert_eq!(lines(EXAMPLE), 6);
    let whole = format!("{}{}", &EXAMPLE[..planes], &EXAMPLE[end..]);
    assert_eq!(lines(&whole), 0);
}

/// The name of a body does not turn its supports into a plane of symmetry.
#[test]
fn a_block_with_the_name_of_a_plane_is_held_by_the_ground() {
    let text = format!(
        "{}[[blocks]]\nname = \"symmetry-x\"\nsize = [200, 100, 50]\nmaterial = \"stone\"\n\
         [[supports]]\non = \"symmetry-x.bottom\"\n{}",
        blocks::HEAD,
        blocks::GRAVITY
    );
    let svg = wythe::results::plotting::scene(&model(&text).1);
    assert!(svg.contains(">held<") && !svg.contains("plane of symmetry"));
}
