//! Automatic simplifications do not change the results of a scene beyond the tolerance.

use crate::common::blocks::{deck, deck_and_model};
use crate::common::halves::{WALL, apart, both, quantities};
use crate::common::scene::{self, Recording, completed};
use wythe::deck::{Deck, check};
use wythe::model::Model;
use wythe::model::mirrored::{MirrorPlane, mirror_planes};
use wythe::model::scene::{Fidelity, Procedure};
use wythe::model::sizes::Sizes;
use wythe::state::{Frame, HistoryRow, Status};

/// Facets are not divided into parts.
const WHOLE: &str = "[1, 1, 1]";

/// One unit per course: head joints carry nothing, and their points would open and close under zero load.
fn stack() -> String {
    WALL.replace("length = 300", "length = 200\nbond = \"stack\"")
        .replace("near = [300", "near = [200")
}

/// Weight and wind on one end, then compression and push.
const STEPS: &str = r#"
[[steps]]
kind = "gravity"
tolerance = { residual = 1e-4 }
[[steps]]
kind = "load"
loads = [{ name = "wind", on = "wall.left", pressure = "20 kPa" }, { name = "weight", on = "wall.top", traction = [0.02, 0, -0.4] }]
increments = { initial = 0.5, max = 0.5 }
tangent = "direct"
tolerance = { residual = 1e-8 }
"#;

/// Relative difference of every field of two frames, divided by its largest value.
fn frames_apart(a: &Frame, b: &Frame) -> Vec<(&'static str, f64)> {
    let v = |of: &[[f64; 3]]| of.as_flattened().to_vec();
    let t = |of: &[[f64; 6]]| of.as_flattened().to_vec();
    let (i, j) = (&a.interfaces, &b.interfaces);
    assert_eq!(i.state, j.state);
    assert_eq!(a.yielded, b.yielded);
    vec![
        (
            "displacement",
            apart(v(&a.displacement), v(&b.displacement)),
        ),
        ("velocity", apart(v(&a.velocity), v(&b.velocity))),
        ("stress", apart(t(&a.stress), t(&b.stress))),
        (
            "plastic strain",
            apart(t(&a.plastic_strain), t(&b.plastic_strain)),
        ),
        ("reactions", apart(v(&a.reactions), v(&b.reactions))),
        ("probes", apart(a.probes.clone(), b.probes.clone())),
        ("opening", apart(i.opening.clone(), j.opening.clone())),
        (
            "slip",
            apart(
                i.slip.as_flattened().to_vec(),
                j.slip.as_flattened().to_vec(),
            ),
        ),
        ("traction", apart(v(&i.traction), v(&j.traction))),
        ("damage", apart(i.damage.clone(), j.damage.clone())),
    ]
}

/// The half has the same elements and points. The difference is the effect of the tolerance of 1e-8 of a mean nodal
/// force on the fields, which a condition number of some hundreds makes 1e-6.
#[test]
fn a_half_shows_every_field_of_the_whole() {
    every_field_is_that_of_the_whole("mesh = [4, 2, 2]", WHOLE, 0.6);
}

/// The same with elements and facets across the plane, with nodes on one side and their images on the other; of three
/// layers two of four nodes remain.
#[test]
fn a_half_of_elements_shows_every_field_of_the_whole() {
    every_field_is_that_of_the_whole("mesh = [4, 2, 1]", WHOLE, 0.51);
    every_field_is_that_of_the_whole("mesh = [4, 2, 3]", WHOLE, 0.51);
}

/// And with facets across the plane in parts, some across it themselves, some beyond it, others cut along it.
#[test]
fn a_half_of_facets_in_parts_shows_every_field_of_the_whole() {
    for parts in ["[1, 2, 1]", "[2, 3, 1]"] {
        every_field_is_that_of_the_whole("mesh = [4, 2, 1]", parts, 0.51);
    }
    a_quarter_shows_the_whole("mesh = [3, 2, 1]", "[2, 3, 2]");
}

/// Two leaves with a joint between them in the plane; courses of headers lie across it.
fn leaves(bond: &str, collar: f64) -> String {
    let length = 2.0 * 60.0 + collar;
    stack()
        .replace("bond = \"stack\"", bond)
        .replace("length = 200", &format!("length = {length}"))
        .replace(
            "unit = [200, 60, 50]",
            &format!("unit = [{length}, 60, 50]"),
        )
        .replace("near = [200", &format!("near = [{length}"))
        .replace("near = [0, 60, 75]", &format!("near = [0, {length}, 75]"))
        .replace(
            "bed_joint = 0",
            &format!("mortar_material = \"brick\"\ncollar_joint = {collar}\nbed_joint = 0"),
        )
}

/// In a joint in the plane each face meets its own image. Its mortar belongs half to each leaf.
#[test]
fn a_half_of_two_leaves_shows_every_field_of_the_whole() {
    for (bond, collar) in [
        ("bond = \"stack\"\nleaves = 2", 0.0),
        ("bond = \"stack\"\nleaves = 2", 10.0),
        ("bond = \"english\"", 10.0),
    ] {
        let text = leaves(bond, collar);
        let at = 60.0 + 0.5 * collar;
        for (mesh, parts) in [("[4, 2, 2]", WHOLE), ("[2, 1, 2]", "[2, 2, 1]")] {
            let text = text.replace("mesh = [4, 2, 2]", &format!("mesh = {mesh}"));
            let text = text.replace("parts = [1, 1, 1]", &format!("parts = {parts}"));
            every_field_is_that_of(&text, at, 0.55);
        }
    }
}

/// `unknowns`: largest ratio of the unknowns to those of the whole.
fn every_field_is_that_of_the_whole(mesh: &str, parts: &str, unknowns: f64) {
    let stack = stack().replace("mesh = [4, 2, 2]", mesh);
    let stack = stack.replace("parts = [1, 1, 1]", &format!("parts = {parts}"));
    every_field_is_that_of(&stack, 30.0, unknowns);
}

/// The same for a wall with its middle plane `at` this depth.
fn every_field_is_that_of(wall: &str, at: f64, unknowns: f64) {
    let [(model, full), (_, auto)] = both(&format!("{wall}{STEPS}"));
    assert_eq!(mirror_planes(&model), [MirrorPlane { axis: 1, at }]);
    assert_eq!(full.rows.len(), auto.rows.len());
    assert_eq!(full.frames.len(), auto.frames.len());
    // Under the weight alone, rounding of positions is 1e-5 of the fields.
    let loaded = full.rows.iter().position(|row| row.step == 1).unwrap();
    for (a, b) in full.rows.iter().zip(&auto.rows).skip(loaded) {
        assert!(apart(quantities(a), quantities(b)) < 1e-5, "{a:?} {b:?}");
        assert!(apart(a.probes.clone(), b.probes.clone()) < 1e-5);
        assert_eq!(a.reactions.len(), b.reactions.len());
        assert_eq!(a.open_points, b.open_points);
    }
    for (a, b) in full.frames.iter().zip(&auto.frames).skip(loaded) {
        for (field, apart) in frames_apart(a, b) {
            println!("{field}: {apart:.1e}");
            assert!(apart < 1e-5, "{field}: {apart:e}");
        }
    }
    // Nonlinear effects occur: joints slide, and the two sides expand in opposite directions.
    let last = &full.frames[full.frames.len() - 1];
    assert!(
        last.interfaces
            .slip
            .as_flattened()
            .iter()
            .any(|s| s.abs() > 1e-6)
    );
    assert!(last.probes[2].abs() > 1e-6);
    let (own, all) = (auto.states[0].q.len(), full.states[0].q.len());
    assert!((own as f64) < unknowns * all as f64, "{own} of {all}");
}

/// Facets across the plane meet facets that end in it. Only the points on the modelled side are paired, and those
/// beyond are shown as their mirror images.
#[test]
fn facets_across_the_plane_meet_facets_that_end_in_it() {
    let text = r#"format = 1
[materials.stone]
E = 1000
nu = 0.2
[interfaces.joint]
f_t = "0.3 MPa"
c = "0.4 MPa"
tan_phi = 0.7
mu = 0.7
u_k = "0.3 mm"
delta_k = "0.4 mm"
zeta = 4
xi = 1
penalty_factor = 20
[[blocks]]
name = "lower"
size = [100, 100, 50]
material = "stone"
mesh = [2, 2, 1]
[[blocks]]
name = "upper"
size = [100, 100, 50]
at = [0, 0, 50]
material = "stone"
mesh = [3, MESH, 1]
[[contacts]]
slave = "upper.bottom"
master = "lower.top"
interface = "joint"
[[supports]]
on = "lower.bottom"
[[steps]]
kind = "load"
loads = [{ name = "weight", on = "upper.top", traction = [0.2, 0, -0.4] }]
increments = { initial = 0.5, max = 0.5 }
tangent = "direct"
tolerance = { residual = 1e-8 }
"#;
    for mesh in ["1", "3"] {
        let [(model, full), (_, auto)] = both(&text.replace("MESH", mesh));
        assert_eq!(mirror_planes(&model), [MirrorPlane { axis: 1, at: 50.0 }]);
        assert_eq!(full.frames.len(), auto.frames.len());
        for (a, b) in full.rows.iter().zip(&auto.rows) {
            assert!(apart(quantities(a), quantities(b)) < 1e-5, "{a:?} {b:?}");
            assert_eq!(a.sliding_points, b.sliding_points);
        }
        for (a, b) in full.frames.iter().zip(&auto.frames) {
            for (field, apart) in frames_apart(a, b) {
                assert!(apart < 1e-5, "{field}: {apart:e}");
            }
        }
        // No point is lost.
        let last = auto.frames.last().unwrap();
        assert!(last.interfaces.damage.iter().all(|d| *d < 1.0));
    }
}

/// A load may be controlled by the mean of a body that the plane cuts: nodes in the plane count once, those beside it
/// twice.
#[test]
fn a_mean_across_the_plane_controls_the_half() {
    let steered = r#"
[[steps]]
kind = "load"
loads = [{ name = "wind", on = "wall.left", pressure = "20 kPa" }, { name = "weight", on = "wall.top", traction = [0.02, 0, -0.4] }]
procedure = "displacement_control"
control = { probe = "side", displacement = -0.002 }
increments = { initial = 0.5, max = 0.5 }
"#;
    for tangent in ["secant", "direct"] {
        let rest = format!("tangent = \"{tangent}\"\ntolerance = {{ residual = 1e-8 }}\n");
        let [(model, full), (_, auto)] = both(&format!("{}{steered}{rest}", stack()));
        assert_eq!(mirror_planes(&model), [MirrorPlane { axis: 1, at: 30.0 }]);
        assert!(auto.states[0].q.len() < 6 * full.states[0].q.len() / 10);
        assert_eq!(full.rows.len(), auto.rows.len());
        for (a, b) in full.rows.iter().zip(&auto.rows) {
            // The side has nodes in the plane and beside it.
            assert!((b.probes[3] / b.time + 0.002).abs() < 1e-9, "{b:?}");
            assert!((a.load_factor / b.load_factor - 1.0).abs() < 1e-5);
            assert!(apart(quantities(a), quantities(b)) < 1e-5, "{a:?} {b:?}");
            assert!(apart(a.probes.clone(), b.probes.clone()) < 1e-5);
        }
    }
}

/// A quarter is a half of a half, and elements across both planes count by a quarter.
#[test]
fn two_planes_leave_a_quarter() {
    for mesh in [
        "mesh = [4, 2, 2]",
        "mesh = [3, 2, 1]",
        "mesh = [3, 2, 2]",
        "mesh = [2, 2, 3]",
    ] {
        a_quarter_shows_the_whole(mesh, WHOLE);
    }
}

fn a_quarter_shows_the_whole(mesh: &str, parts: &str) {
    let pressed = r#"
[[steps]]
kind = "load"
loads = [{ name = "weight", on = "wall.top", pressure = 1.0 }]
tangent = "direct"
tolerance = { residual = 1e-8 }
"#;
    let text = format!("{}{pressed}", stack()).replace("mesh = [4, 2, 2]", mesh);
    let text = text.replace("parts = [1, 1, 1]", &format!("parts = {parts}"));
    let [(model, full), (_, auto)] = both(&text);
    let at = |axis, at| MirrorPlane { axis, at };
    assert_eq!(mirror_planes(&model), [at(1, 30.0), at(0, 100.0)]);
    quarters_show_the_whole(&full, &auto, mesh);
}

fn quarters_show_the_whole(full: &Recording, auto: &Recording, mesh: &str) {
    for (a, b) in full.frames.iter().zip(&auto.frames) {
        for (field, apart) in frames_apart(a, b) {
            assert!(apart < 1e-5, "{mesh}, {field}: {apart:e}");
        }
    }
    let last = |recording: &Recording| quantities(&recording.rows[recording.rows.len() - 1]);
    assert!(apart(last(full), last(auto)) < 1e-5, "{mesh}");
    assert!(auto.states[0].q.len() < 4 * full.states[0].q.len() / 10);
}

/// Four blocks on a fifth, which touch each other in two planes of symmetry and are joined in both. Slaves are below one
/// plane and above the other. The bond holds: one-pass contact of faces that part and turn is not quite symmetric in the
/// whole (1e-4 of the slip at twice the pull), of which the quarter gives the mean.
#[test]
fn joints_in_two_planes_leave_a_quarter() {
    let block = |name: &str, x: i32, y: i32| {
        format!(
            "[[blocks]]\nname = \"{name}\"\nsize = [100, 50, 80]\nat = [{x}, {y}, 0]\nmaterial = \"brick\"\nmesh = [2, 2, 2]\n"
        )
    };
    let joint = |slave: &str, master: &str| {
        format!("[[contacts]]\nslave = \"{slave}\"\nmaster = \"{master}\"\ninterface = \"joint\"\n")
    };
    let blocks = [("a", 0, 0), ("b", 100, 0), ("c", 0, 50), ("d", 100, 50)];
    let blocks: String = blocks
        .iter()
        .map(|(name, x, y)| block(name, *x, *y))
        .collect();
    let ground = "[[blocks]]\nname = \"ground\"\nsize = [200, 100, 20]\nat = [0, 0, -20]\nmaterial = \"brick\"\nmesh = [4, 3, 1]\n";
    let beds = ["a", "b", "c", "d"].map(|b| joint(&format!("{b}.bottom"), "ground.top"));
    let joints = beds.concat()
        + &joint("a.right", "b.left")
        + &joint("c.right", "d.left")
        + &joint("c.front", "a.back")
        + &joint("d.front", "b.back");
    let load = r#"
[[supports]]
on = "ground.bottom"
[[steps]]
kind = "load"
loads = [{ name = "weight", on = ["a.top", "b.top", "c.top", "d.top"], pressure = 1.0 }, { name = "pull", on = ["a.left", "c.left", "b.right", "d.right"], pressure = -0.25 }]
tangent = "direct"
tolerance = { residual = 1e-8 }
"#;
    let (materials, _) = WALL.split_once("[wall]").unwrap();
    let [(model, full), (_, auto)] = both(&format!("{materials}{ground}{blocks}{joints}{load}"));
    let at = |axis, at| MirrorPlane { axis, at };
    assert_eq!(mirror_planes(&model), [at(1, 50.0), at(0, 100.0)]);
    quarters_show_the_whole(&full, &auto, "blocks");
    let opening = &full.frames.last().unwrap().interfaces.opening;
    assert!(opening.iter().any(|gap| *gap > 0.0), "no joint opens");
}

/// The summary describes the solved part, sizes are those of the whole, and reported nodes have their numbers in the
/// whole.
#[test]
fn the_summary_describes_the_half_and_numbers_are_those_of_the_whole() {
    let pressed = "[[steps]]\nkind = \"load\"\nloads = [{ name = \"weight\", on = \"wall.top\", pressure = 1.0 }]\n";
    let (deck, mut model) = deck_and_model(&format!("{}{pressed}", stack()));
    let (_, summary) = scene::run(&model);
    assert_eq!(summary.mirror_planes, mirror_planes(&model));
    assert_eq!(summary.mirror_planes.len(), 2);
    let whole = check(&deck, &model).sizes;
    let dofs = summary.sizes.dofs;
    assert_eq!(summary.sizes, Sizes { dofs, ..whole });
    assert!(dofs < 4 * whole.dofs / 10);

    // Rounding makes this tolerance unreachable.
    let step = &mut model.steps[0];
    step.procedure = Procedure::Static;
    step.tolerance.residual = 1e-30;
    step.increments.min = step.increments.initial;
    let (_, summary) = scene::run(&model);
    assert_eq!(summary.status, Status::NotConverged);
    // The place is that of a node of the whole.
    let place = |x: &[f64; 3]| format!("({:.1}, {:.1}, {:.1}) mm", x[0], x[1], x[2]);
    let told = &summary.message;
    let named = model.mesh.nodes.iter().any(|x| told.contains(&place(x)));
    assert!(named, "{told}");

    model.fidelity = Fidelity::Full;
    assert_eq!(scene::run(&model).1.mirror_planes, []);
}

/// A pressure on all sides gives a force of its area, and in the plane that of the whole: the ridge of a roof is
/// pressed down. Its facets lie across the other plane, and half of each is loaded.
#[test]
fn a_pressure_all_around_is_that_of_the_whole() {
    let text = r#"format = 1
[materials.stone]
E = 1000
nu = 0.2
[[blocks]]
name = "house"
size = [100, 100, 100]
material = "stone"
mesh = [2, 1, 2]
[[supports]]
on = "house.bottom"
[[steps]]
kind = "load"
increments = { initial = 1, max = 1 }
tangent = "direct"
tolerance = { residual = 1e-8 }
loads = [{ name = "water", pressure = 2, on = ["house.left", "house.right", "house.front", "house.back", "house.top", "house.bottom"] }]
"#;
    let (_, mut model) = deck_and_model(text);
    for [x, _, z] in &mut model.mesh.nodes {
        if *z == 100.0 && *x == 50.0 {
            *z = 120.0;
        }
    }
    let [full, auto] = [Fidelity::Full, Fidelity::Auto].map(|fidelity| {
        model.fidelity = fidelity;
        completed(&model).rows.pop().unwrap()
    });
    let at = |axis| MirrorPlane { axis, at: 50.0 };
    assert_eq!(mirror_planes(&model), [at(1), at(0)]);
    let told = |row: &HistoryRow| [row.force_kN, row.displacement_mm];
    for (a, b) in told(&full).into_iter().zip(told(&auto)) {
        assert!((a - b).abs() < 1e-6 * a.abs(), "{a} {b}");
    }
}

/// An asymmetric model is solved as a whole, with bitwise equal results.
#[test]
fn models_without_symmetry_are_solved_whole() {
    let whole = format!("{WALL}{STEPS}");
    let odd = [
        // The wall is pulled to one side.
        whole.replace(
            "traction = [0.02, 0, -0.4]",
            "traction = [0.02, 0.01, -0.4]",
        ),
        whole.replace(
            "kind = \"gravity\"",
            "kind = \"gravity\"\nangle = \"10 deg\"\naxis = \"x\"",
        ),
        // One side is fixed or loaded.
        whole.replace(
            "[[supports]]",
            "[[supports]]\non = \"wall.front\"\nfixed = [\"y\"]\n[[supports]]",
        ),
        whole.replace("on = \"wall.left\"", "on = \"wall.front\""),
        // The bond of each unit varies, and so does that of each half of a unit.
        whole.replace("[contact]", "scatter = { cv = 0.2, seed = 7 }\n[contact]"),
    ];
    for (i, text) in odd.iter().enumerate() {
        assert_ne!(*text, whole, "{i}");
        let Ok(deck) = Deck::from_str(text, "odd.toml") else {
            panic!("{i}: {text}");
        };
        let (mut model, _) = Model::from_deck(&deck).unwrap_or_else(|e| panic!("{i}: {e}"));
        if text.contains("scatter") {
            // Units lie across the plane, so that both halves have the same bond.
            assert_eq!(mirror_planes(&model).len(), 1);
            let last = model.contact.slave_law.len() - 1;
            model.contact.slave_law[last] = u16::from(model.contact.slave_law[last] == 0);
        }
        assert_eq!(mirror_planes(&model), [], "{i}");
    }
}

/// The checker reports the plane, whether it is used or not.
#[test]
fn the_checker_offers_the_half() {
    let told = |text: &str| {
        let (deck, model) = deck_and_model(text);
        let notes = check(&deck, &model).notes;
        notes.into_iter().find(|note| note.starts_with("fidelity"))
    };
    let whole = format!("{WALL}{STEPS}");
    let full = whole.replacen("format = 1", "format = 1\nfidelity = \"full\"", 1);
    let offered = told(&full).unwrap();
    assert!(
        offered.contains("plane y = 30 mm: with fidelity = \"auto\" one half"),
        "{offered}"
    );
    let auto = told(&whole).unwrap();
    assert!(
        auto.contains("plane y = 30 mm: one half of it, ") && auto.contains("is solved, and"),
        "{auto}"
    );
    assert_eq!(
        told(&whole.replace("on = \"wall.left\"", "on = \"wall.front\"")),
        None
    );
}

/// The error of elastic solids is reported.
#[test]
fn elastic_solids_report_their_largest_stress_ratio() {
    let pressed = |pressure: f64| {
        let text = format!(
            "{WALL}[[steps]]\nkind = \"load\"\nloads = [{{ name = \"weight\", on = \"wall.top\", pressure = {pressure} }}]\n"
        );
        let (_, mut model) = deck_and_model(&text);
        model.fidelity = Fidelity::Elastic;
        let (recording, summary) = scene::run(&model);
        assert_eq!(summary.mirror_planes, mirror_planes(&model));
        assert!(
            recording
                .rows
                .iter()
                .all(|row| row.plastic_damage_dissipation_J == 0.0)
        );
        summary
    };
    let little = pressed(1.0);
    assert_eq!(little.warnings, [""; 0]);
    assert!(
        little
            .log
            .iter()
            .any(|told| told.contains("leaves nothing out")),
        "{:?}",
        little.log
    );
    let much = pressed(20.0);
    let told = much
        .warnings
        .iter()
        .find(|told| told.contains("times their yield stress"));
    let told = told.unwrap_or_else(|| panic!("{:?}", much.warnings));
    let times: f64 = told
        .split("reach ")
        .nth(1)
        .unwrap()
        .split(' ')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    // 20 MPa on solids that yield at 11: a ratio of 1.8, and more at the fixed foot.
    assert!((1.7..4.0).contains(&times), "{told}");
}

/// The key is written back, and errors list the possible values.
#[test]
fn the_key_is_read_and_written() {
    let text =
        format!("{WALL}{STEPS}").replacen("format = 1", "format = 1\nfidelity = \"elastic\"", 1);
    let written = deck(&text).to_toml().unwrap();
    assert!(written.contains("fidelity = \"elastic\""), "{written}");
    let error = Deck::from_str(&text.replace("\"elastic\"", "\"half\""), "wall.toml").unwrap_err();
    assert_eq!(error.key(), "fidelity");
    assert_eq!(error.advice(), "known here: auto, full, elastic");
}
