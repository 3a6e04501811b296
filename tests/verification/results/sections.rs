//! Sections: their resultants balance loads and reactions; halves and turned walls give the same; drifts; bad input.

use crate::common::blocks::{Bad, HEAD, deck, deck_and_model, refuses};
use crate::common::halves::{apart, both};
use crate::common::scene::{Recording, completed};
use wythe::model::Model;

/// A wall with a window, pressed and pushed, with sections of its piers and at its foot. `@` stands for the rotation.
const WINDOW: &str = r#"format = 1

[materials.brick]
E = "10 GPa"
nu = 0.2
density = "1900 kg/m^3"

[interfaces.joint]
f_t = "0.2 MPa"
c = "0.25 MPa"
tan_phi = 0.75
mu = 0.75
zeta = 4.38
xi = 1.1
G_I = "0.015 N/mm"
G_II = "0.03 N/mm"

[[walls]]
name = "front"
unit = ["200 mm", "100 mm", "60 mm"]
bed_joint = 0
head_joint = 0
length = "1000 mm"
courses = 8
unit_material = "brick"
interface = "joint"
mesh = [2, 1, 1]
openings = [{ from = "400 mm", to = "600 mm", sill = 2, courses = 4 }]
@
[[supports]]
on = "front.bottom"

[[sections]]
piers = "front"

[[sections]]
name = "foot"
through = [0, 0, "60 mm"]

[[sections]]
name = "course"
through = ["500 mm", 0, "30 mm"]
box = [[-2000, -2000, 0], [2000, 2000, "90 mm"]]

[[probes]]
name = "storey"
on = "front.top"
minus = "front.bottom"
direction = "x"
quantity = "drift"

[[steps]]
kind = "gravity"
tolerance = { residual = 1e-4 }

[[steps]]
kind = "preload"
face = "front.top"
pressure = "0.3 MPa"
tolerance = { residual = 1e-4 }

[[steps]]
kind = "drive"
face = "front.top"
direction = "x"
displacement = "0.3 mm"
tolerance = { residual = 1e-4 }
"#;

fn window(rotation: &str) -> String {
    WINDOW.replace('@', rotation)
}

/// The same with joints that do not soften, so that two runs take the same increments.
fn strong(rotation: &str) -> String {
    let text = window(rotation).replace("f_t = \"0.2 MPa\"", "f_t = \"20 MPa\"");
    let text = text.replace("c = \"0.25 MPa\"", "c = \"25 MPa\"");
    text.replace("G_I = \"0.015 N/mm\"", "G_I = \"20 N/mm\"")
        .replace("G_II = \"0.03 N/mm\"", "G_II = \"20 N/mm\"")
}

/// Values of a column of the history.
fn column(model: &Model, recording: &Recording, name: &str) -> Vec<f64> {
    let columns = model.columns();
    let at = columns.iter().position(|column| column == name);
    let at = at.unwrap_or_else(|| panic!("no {name} in {columns:?}"));
    recording.rows.iter().map(|row| row.probes[at]).collect()
}

/// Relative error of sums of some tens of nodal forces in equilibrium to 1e-4 of the mean nodal force.
const BALANCED: f64 = 1e-3;

#[test]
fn sections_balance_the_loads_and_the_reactions() {
    let (_, model) = deck_and_model(&window(""));
    let recording = completed(&model);
    let of = |name: &str| column(&model, &recording, name);
    let sum = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
    let force: Vec<f64> = recording.rows.iter().map(|row| row.force_kN).collect();
    assert!(force.last().unwrap() > &10.0);
    let shear = sum(&of("front-pier-1_Vx_kN"), &of("front-pier-2_Vx_kN"));
    let foot = of("foot_Vx_kN");
    assert!(apart(force.clone(), shear) < BALANCED);
    assert!(apart(force.clone(), foot) < BALANCED);
    assert!(apart(force, of("base_shear_kN")) < BALANCED);
    // The weight of the eight courses, less the window, is above the ground; that of the courses above a section is on it.
    let weight =
        |courses: f64, units: f64| 1.9e-9 * 9810.0 * 60.0 * 100.0 * 1000.0 * courses * units * 1e-3;
    let reaction = of("reaction-front-bottom_z_kN");
    let below: Vec<f64> = reaction.iter().map(|z| weight(1.0, 1.0) - z).collect();
    // Gravity grows in its step; the last two steps have it whole.
    let later = |values: Vec<f64>| -> Vec<f64> {
        let rows = values.iter().zip(&recording.rows);
        rows.filter(|(_, row)| row.step > 0)
            .map(|(v, _)| *v)
            .collect()
    };
    assert!(apart(later(of("foot_N_kN")), later(below)) < BALANCED);
    // Piers are cut in the middle of the window: two of its courses, which are 0.8 of a course each, and two sills of
    // whole courses lie below.
    let piers = sum(&of("front-pier-1_N_kN"), &of("front-pier-2_N_kN"));
    let below: Vec<f64> = reaction
        .iter()
        .map(|z| weight(2.0, 1.0) + weight(2.0, 0.8) - z)
        .collect();
    assert!(apart(later(piers), later(below)) < BALANCED);
    // The drift is the motion of the top, whose units are 480 mm above the ground.
    let top: Vec<f64> = recording
        .rows
        .iter()
        .map(|row| row.displacement_mm / 480.0)
        .collect();
    let driven = |values: Vec<f64>| -> Vec<f64> {
        let rows = values.iter().zip(&recording.rows);
        rows.filter(|(_, row)| row.step == 2)
            .map(|(v, _)| *v)
            .collect()
    };
    // The drive counts from where gravity and preload have left the top.
    let [drift, top] = [driven(of("storey_drift")), driven(top)];
    assert!(apart(drift, top) < 1e-3);
}

/// Deck of a column of one block of 100 × 50 × 400 mm on its support.
fn block(mesh: [u32; 3], rest: &str) -> String {
    format!(
        "{HEAD}[[blocks]]\nname = \"column\"\nsize = [100, 50, 400]\nmaterial = \"stone\"\nmesh = {mesh:?}\n\
         [[supports]]\non = \"column.bottom\"\n{rest}"
    )
}

/// A column of one block, pushed at its top: the moment of a section is force times height.
#[test]
fn the_moment_of_a_section_is_that_of_the_forces_above_it() {
    let rest = r#"
[[sections]]
name = "low"
through = [0, 0, 100]

[[sections]]
name = "middle"
through = [0, 0, 210]

[[steps]]
kind = "load"
tolerance = { residual = 1e-6 }
[[steps.loads]]
name = "push"
on = "column.top"
traction = ["0.002 MPa", "0.001 MPa", "-0.004 MPa"]
"#;
    let (_, model) = deck_and_model(&block([2, 1, 8], rest));
    let recording = completed(&model);
    let last = |name: &str| *column(&model, &recording, name).last().unwrap();
    // Tractions on 100 x 50 mm².
    let force = [0.01, 0.005, -0.02];
    for (name, height) in [("low", 0.3), ("middle", 0.19)] {
        let found = ["N_kN", "Vx_kN", "Vy_kN", "Mx_kNm", "My_kNm", "T_kNm"];
        let found = found.map(|column| last(&format!("{name}_{column}")));
        // Moments refer to the plane of the deck, although the cut follows the faces of the elements, at 200 mm.
        let expected = [
            force[2],
            force[0],
            force[1],
            -force[1] * height,
            force[0] * height,
            0.0,
        ];
        let scale = [0.02, 0.02, 0.02, 0.006, 0.006, 0.006];
        for i in 0..6 {
            // The top moves by 0.02 mm, which adds the moment of the vertical force.
            let error = (found[i] - expected[i]).abs() / scale[i];
            assert!(error < 2e-4, "{name} {i}: {found:?} {expected:?}");
        }
        assert!(
            (found[0] / force[2] - 1.0).abs() < 1e-5,
            "forces balance to the tolerance"
        );
    }
}

/// A column under its weight: its middle carries the upper half.
#[test]
fn a_section_within_a_body_carries_the_weight_above_it() {
    let rest = r#"
[[sections]]
name = "middle"
through = [0, 0, 200]

[[sections]]
name = "low"
through = [0, 0, 100]

[[steps]]
kind = "gravity"
tolerance = { residual = 1e-8 }
"#;
    let (_, model) = deck_and_model(&block([1, 1, 4], rest));
    let recording = completed(&model);
    let weight = 1e-3 * 2e-9 * 100.0 * 50.0 * 400.0 * 9810.0;
    for (name, part) in [("middle_N_kN", 0.5), ("low_N_kN", 0.75)] {
        let found = *column(&model, &recording, name).last().unwrap();
        let error = (found / (-part * weight) - 1.0).abs();
        // Forces balance to 1e-8 of the mean nodal force.
        assert!(error < 1e-6, "{name}: {found} for {}", -part * weight);
    }
}

/// A beam of one block, held at one end, under a layer: its root carries all loads between the cut and its free end.
#[test]
fn a_load_on_the_nodes_of_a_cut_acts_on_both_parts() {
    let text = format!(
        "{HEAD}{}",
        r#"
[[blocks]]
name = "beam"
size = [400, 50, 100]
material = "stone"
mesh = [4, 1, 2]

[[supports]]
on = "beam.left"

[[sections]]
name = "middle"
through = [200, 0, 0]
normal = "x"

[[sections]]
name = "near"
through = [100, 0, 0]
normal = "x"

[[steps]]
kind = "load"
tolerance = { residual = 1e-6 }
[[steps.loads]]
name = "layer"
on = "beam.top"
traction = [0, 0, "-0.01 MPa"]
"#
    );
    let (_, model) = deck_and_model(&text);
    let recording = completed(&model);
    let last = |name: String| *column(&model, &recording, &name).last().unwrap();
    for (name, length) in [("middle", 200.0), ("near", 300.0)] {
        let load = 1e-3 * 0.01 * 50.0 * length;
        let shear = last(format!("{name}_Vz_kN"));
        let moment = last(format!("{name}_My_kNm"));
        // Forces balance to 1e-6 of the mean nodal force; the beam bends by 0.03 mm.
        assert!((shear / -load - 1.0).abs() < 1e-5, "{name}: {shear}");
        let expected = load * 5e-4 * length;
        assert!((moment / expected - 1.0).abs() < 1e-3, "{name}: {moment}");
    }
}

/// Two blocks that a third on both of them joins, which is pulled through the joints below it.
const LINKED: &str = r#"format = 1
[materials.brick]
E = "8 GPa"
nu = 0.2

[interfaces.joint]
f_t = "2 MPa"
G_I = "1000 N/m"
c = "3 MPa"
G_II = "5000 N/m"
tan_phi = 0.75
mu = 0.75
zeta = 4.38
xi = 1.1
normal_stiffness = "100 N/mm^3"
shear_stiffness = "50 N/mm^3"

[[blocks]]
name = "A"
size = [200, 100, 100]
material = "brick"

[[blocks]]
name = "B"
size = [200, 100, 100]
at = [220, 0, 0]
material = "brick"

[[blocks]]
name = "C"
size = [220, 100, 100]
at = [100, 0, 100]
material = "brick"
mesh = [2, 1, 1]

[[contacts]]
interface = "joint"

[[supports]]
on = "A.left"

[[sections]]
name = "link"
through = [215, 0, 0]
normal = "x"

[[sections]]
name = "back"
through = [215, 0, 0]
normal = "-x"

[[steps]]
kind = "load"
tolerance = { residual = 1e-4 }
loads = [{ name = "pull", on = "B.right", force = ["1 kN", 0, 0] }]
"#;

/// The joints at the nodes of the cut carry the rest of the force of its elements.
#[test]
fn a_cut_through_a_body_has_the_forces_of_the_joints_beside_it() {
    let (_, model) = deck_and_model(LINKED);
    let recording = completed(&model);
    let last = |name: &str| *column(&model, &recording, name).last().unwrap();
    // The middle of the cut lies 100 mm above the force.
    for (name, sign) in [("link", 1.0), ("back", -1.0)] {
        let found = ["N_kN", "Vy_kN", "Vz_kN", "My_kNm"].map(|of| last(&format!("{name}_{of}")));
        let expected = [1.0, 0.0, 0.0, -0.1 * sign];
        let scale = [1.0, 1.0, 1.0, 0.1];
        for i in 0..4 {
            let error = (found[i] - expected[i]).abs() / scale[i];
            // The parts move by 0.05 mm against each other, a part of 5e-4 of the arm.
            assert!(error < 2e-3, "{name} {i}: {found:?} {expected:?}");
        }
    }
}

#[test]
fn halves_show_the_sections_of_the_whole() {
    let [(model, full), (reduced, auto)] = both(&strong(""));
    assert_eq!(full.rows.len(), auto.rows.len());
    for column_name in model.columns() {
        let values = [(&model, &full), (&reduced, &auto)].map(|(m, r)| column(m, r, &column_name));
        let [a, b] = values;
        // Parts of 150 kN, of 75 kN m and of the drift. Small values of a spandrel are differences of large ones.
        let scale = match column_name.rsplit_once('_') {
            Some((_, "kN")) => 150.0,
            Some((_, "kNm")) => 75.0,
            _ => 6e-4,
        };
        let apart = a
            .iter()
            .zip(&b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(apart < 1e-3 * scale, "{column_name}: {apart}\n{a:?}\n{b:?}");
    }
}

#[test]
fn sections_turn_with_their_wall() {
    let upright = {
        let (_, model) = deck_and_model(&strong(""));
        let recording = completed(&model);
        let of = |name: &str| column(&model, &recording, name);
        [
            of("front-pier-1_N_kN"),
            of("front-pier-1_Vx_kN"),
            of("front-pier-1_My_kNm"),
            of("front-spandrel-1_N_kN"),
        ]
    };
    // A quarter turn about z: the wall runs along y.
    let turned = strong("rotate = { axis = \"z\", angle = \"90 deg\" }\n");
    let turned = turned.replace("direction = \"x\"", "direction = \"y\"");
    let turned = turned.replace(
        "through = [\"500 mm\", 0, \"30 mm\"]",
        "through = [0, \"500 mm\", \"30 mm\"]",
    );
    let (_, model) = deck_and_model(&turned);
    let recording = completed(&model);
    let of = |name: &str| column(&model, &recording, name);
    let moment = of("front-pier-1_Mx_kNm").iter().map(|m| -m).collect();
    let found = [
        of("front-pier-1_N_kN"),
        of("front-pier-1_Vy_kN"),
        moment,
        of("front-spandrel-1_N_kN"),
    ];
    for (a, b) in upright.into_iter().zip(found) {
        // Both are solved on their own.
        assert!(apart(a.clone(), b.clone()) < BALANCED, "{a:?}\n{b:?}");
    }
}

#[test]
fn decks_tell_the_columns_of_their_models() {
    let text = window("");
    let (read, model) = deck_and_model(&text);
    assert_eq!(read.columns(), model.columns());
    let names: Vec<&str> = model.sections.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "front-pier-1",
            "front-pier-2",
            "front-spandrel-1",
            "foot",
            "course"
        ]
    );
    // Two piers of 400 mm, a spandrel of two courses, the whole wall twice.
    let areas: Vec<f64> = model.sections.iter().map(|s| s.area).collect();
    for (area, expected) in areas.iter().zip([4e4, 4e4, 1.2e4, 1e5, 1e5]) {
        // Rounding of volumes.
        assert!((area / expected - 1.0).abs() < 1e-12, "{areas:?}");
    }
    let again = deck(&read.to_toml().unwrap());
    assert_eq!(again.sections, read.sections);
    for example in [
        "03_shear_wall_j7d",
        "07_arch",
        "66_rocking_pier",
        "65_quarter_wall",
    ] {
        let path = format!("examples/{example}.toml");
        let (read, model) = deck_and_model(&std::fs::read_to_string(path).unwrap());
        assert_eq!(read.columns(), model.columns(), "{example}");
    }
}

/// Replaced text, its replacement, the key of the error, part of it, part of the advice.
const BAD: &[Bad] = &[
    (
        "piers = \"front\"",
        "piers = \"back\"",
        "sections.0.piers",
        "no wall named `back`",
        "wall with openings",
    ),
    (
        "piers = \"front\"",
        "name = \"cut\"",
        "sections.0.through",
        "missing",
        "through",
    ),
    (
        "piers = \"front\"",
        "piers = \"front\"\nnormal = \"x\"",
        "sections.0.piers",
        "planes of their own",
        "leave",
    ),
    (
        "name = \"foot\"",
        "name = \"front-pier-1\"",
        "sections.1.name",
        "two columns",
        "name of its own",
    ),
    (
        "name = \"foot\"",
        "name = \"1st\"",
        "sections.1.name",
        "no name for a column",
        "a letter",
    ),
    (
        "name = \"course\"",
        "name = \"course\"\nnormal = [0, 0, 0]",
        "sections.2.normal",
        "length 0",
        "normal",
    ),
    (
        "through = [0, 0, \"60 mm\"]",
        "through = [0, 0, \"6 m\"]",
        "sections.1.through",
        "`foot` cuts no solid",
        "through",
    ),
    (
        "through = [0, 0, \"60 mm\"]",
        "through = [0, 0, \"1 mm\"]",
        "sections.1.through",
        "between the middles of elements",
        "reaction",
    ),
    (
        "through = [0, 0, \"60 mm\"]",
        "through = [0, 0, 60]\nof = \"side\"",
        "sections.1.of",
        "side",
        "",
    ),
    (
        "[2000, 2000, \"90 mm\"]",
        "[2000, -2000, 90]",
        "sections.2.box",
        "not the lowest",
        "box",
    ),
    (
        "minus = \"front.bottom\"",
        "",
        "probes.0.quantity",
        "between two heights",
        "minus",
    ),
    (
        "minus = \"front.bottom\"",
        "minus = \"front.top\"",
        "probes.0.minus",
        "same height",
        "below",
    ),
];

#[test]
fn bad_sections_are_refused() {
    refuses(&window(""), BAD);
}
