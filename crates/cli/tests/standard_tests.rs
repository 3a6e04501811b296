//! Standard tests: the decks of `wythe new --test` run, and `wythe evaluate` gives back what went in, or what a
//! closed form bounds.
//!
//! The joint is the catalogue's `M5 on clay`: f_t = 0.17858 MPa, c = 0.25 MPa, tan phi = mu = 0.5, G_I = 0.012 N/mm,
//! G_II = 0.02325 N/mm.

mod common;

use common::*;
use serde_json::Value;
use std::f64::consts::FRAC_1_SQRT_2;
use std::path::Path;

const F_T: f64 = 0.17858;
const C: f64 = 0.25;
const TAN_PHI: f64 = 0.5;
/// Modulus of units and beds in series over whole courses: (55 + 10)/(55/6240 + 10/1000) MPa.
const SERIES: f64 = 3454.9;

/// Writes the decks of a test, runs them with these changes, and evaluates the runs.
fn evaluated(folder: &Path, test: &str, options: &[&str], changes: &[&str]) -> Value {
    let name = folder.join("specimen").display().to_string();
    let written = wythe(&[&["new", &name, "--test", test][..], options].concat());
    assert_eq!(code(&written), 0, "{}", stderr(&written));
    let decks = stdout(&written);
    let decks = decks
        .lines()
        .filter_map(|line| line.strip_suffix(" is written"));
    let mut folders = Vec::new();
    for deck in decks {
        let mut arguments = vec!["run", deck, "--threads", "1", "--quiet"];
        for change in changes {
            arguments.extend(["--set", change]);
        }
        let run = wythe(&arguments);
        assert_eq!(code(&run), 0, "{test}: {}", stderr(&run));
        folders.push(deck.replace(".toml", ".out"));
    }
    let mut arguments = vec!["evaluate", "--json"];
    arguments.extend(folders.iter().map(String::as_str));
    let found = wythe(&arguments);
    assert_eq!(code(&found), 0, "{test}: {}", stderr(&found));
    serde_json::from_str(&stdout(&found)).unwrap()
}

/// Units, mortar and a joint of these strengths, and the begin of a wall of 200 × 100 × 50 mm units.
fn masonry(tension: f64, cohesion: f64) -> String {
    format!(
        "format = 1\n[materials.unit]\nE = 6000\nnu = 0.15\n[materials.mortar]\nE = 1000\nnu = 0.15\n[interfaces.joint]\n\
         f_t = {tension}\nu_k = 0.3\nzeta = 4.38\nc = {cohesion}\ndelta_k = 0.4\nxi = 1.1\ntan_phi = 0.7\nmu = 0.7\n[wall]\n\
         unit = [200, 100, 50]\nbed_joint = 10\nhead_joint = 10\nunit_material = \"unit\"\nmortar_material = \"mortar\"\n\
         interface = \"joint\"\n"
    )
}

/// The history of the run of a deck of this text.
fn history_of(folder: &Path, text: &str) -> String {
    let deck = folder.join("deck.toml");
    std::fs::write(&deck, text).unwrap();
    let (deck, out) = (deck.display().to_string(), folder.join("deck.out"));
    let to = out.display().to_string();
    let run = wythe(&["run", &deck, "--quiet", "--threads", "1", "--out", &to]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    std::fs::read_to_string(out.join("history.csv")).unwrap()
}

/// The last value of a column.
fn last(history: &str, name: &str) -> f64 {
    column(history, name).last().copied().unwrap()
}

/// A value of the list at a pointer.
fn value(found: &Value, list: &str, name: &str) -> f64 {
    let list = found.pointer(list).unwrap().as_array().unwrap();
    let found = list.iter().find(|value| value["name"] == name);
    found.unwrap_or_else(|| panic!("{name}"))["value"]
        .as_f64()
        .unwrap()
}

fn of_run(found: &Value, run: usize, name: &str) -> f64 {
    value(found, &format!("/runs/{run}/values"), name)
}

fn no_notes(found: &Value) {
    assert_eq!(found["notes"].as_array().unwrap(), &Vec::<Value>::new());
}

fn between(value: f64, low: f64, high: f64) {
    assert!(
        (low..=high).contains(&value),
        "{value} is not within {low} to {high}"
    );
}

#[test]
fn a_couplet_in_tension_gives_strength_and_energy_back() {
    let folder = tempfile::tempdir().unwrap();
    let found = evaluated(folder.path(), "couplet-tension", &[], &[]);
    no_notes(&found);
    // The stress is uneven at the edges, so that the strength is a little lower than f_t, never higher.
    between(of_run(&found, 0, "f_t"), 0.98 * F_T, F_T);
    // Every point of the joint dissipates G_I; the trapezoidal rule over the increments costs the rest.
    between(of_run(&found, 0, "G_I"), 0.99 * 0.012, 1.01 * 0.012);
}

#[test]
fn direct_shear_gives_cohesion_and_friction_back() {
    let folder = tempfile::tempdir().unwrap();
    let found = evaluated(folder.path(), "direct-shear", &[], &[]);
    no_notes(&found);
    for (run, pressure) in [0.1, 0.5, 1.0].into_iter().enumerate() {
        // No bed carries more than its law; uneven shear takes some per cent.
        let most = C + TAN_PHI * pressure;
        between(of_run(&found, run, "f_v"), 0.96 * most, most);
        between(
            of_run(&found, run, "f_vr"),
            0.995 * TAN_PHI * pressure,
            1.005 * TAN_PHI * pressure,
        );
    }
    between(value(&found, "/together", "c"), 0.95 * C, 1.001 * C);
    between(
        value(&found, "/together", "tan_phi"),
        0.97 * TAN_PHI,
        1.001 * TAN_PHI,
    );
    // The residual force is no bound for the force on the way: G_II is found within 5 %.
    between(of_run(&found, 0, "G_II"), 0.95 * 0.02325, 1.05 * 0.02325);
}

#[test]
fn triplets_give_the_initial_shear_strength() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--precompression", "0.2, 1 MPa", "--unit", "210x100x60"];
    let found = evaluated(folder.path(), "en1052-3", &options, &[]);
    no_notes(&found);
    for (run, pressure) in [0.2, 1.0].into_iter().enumerate() {
        // Shear is uneven along the beds, more than in direct shear: the middle unit is pushed at one end.
        let most = C + TAN_PHI * pressure;
        between(of_run(&found, run, "f_v"), 0.88 * most, most);
    }
    between(value(&found, "/together", "f_v0"), 0.88 * C, C);
    between(
        value(&found, "/together", "tan_phi_r"),
        0.995 * TAN_PHI,
        1.005 * TAN_PHI,
    );
    let f_vk0 = value(&found, "/together", "f_vk0");
    assert!((f_vk0 / value(&found, "/together", "f_v0") - 0.8).abs() < 1e-12); // by definition
}

/// A bed that bends carries at least f_t by the elastic formula, and at most three times as much: tension f_t over
/// the whole depth against an edge.
#[test]
fn bent_joints_carry_between_the_elastic_and_the_plastic_limit() {
    for (test, name) in [("en1052-5", "f_w"), ("out-of-plane-four-point", "f_x")] {
        let folder = tempfile::tempdir().unwrap();
        let found = evaluated(folder.path(), test, &[], &[]);
        no_notes(&found);
        between(of_run(&found, 0, name), F_T, 3.0 * F_T);
    }
}

#[test]
fn flexure_normal_to_the_beds_is_stronger_than_parallel() {
    let folder = tempfile::tempdir().unwrap();
    let found = evaluated(folder.path(), "en1052-2", &[], &[]);
    no_notes(&found);
    assert_eq!(found["runs"][0]["run"], "specimen-parallel");
    let [parallel, normal] = [0, 1].map(|run| of_run(&found, run, "f_x"));
    between(parallel, F_T, 3.0 * F_T);
    // Beds slide and units tear where head joints alone would open: two to four times as strong for clay units by EN
    // 1996-1-1, 3.6.3, less and more a quarter, as these are characteristic values of many units.
    between(normal, 0.75 * 2.0 * parallel, 4.0 / 0.75 * parallel);
}

#[test]
fn a_wallette_is_as_strong_as_between_mortar_and_unit() {
    let folder = tempfile::tempdir().unwrap();
    let found = evaluated(folder.path(), "en1052-1", &[], &[]);
    no_notes(&found);
    between(of_run(&found, 0, "f"), 5.0, 20.8);
    // The gauges span three courses, nothing yields at a third of the load: E is that of units of 6,240 MPa and beds of
    // 1,000 MPa in series, 55 and 10 mm. Head joints, 10 of 260 mm, take 1.6 %, the stiffness of the joints 1.1 %; the
    // mortar, which units confine, gives up to 1/(1 - 2 nu^2/(1 - nu)) = 1.06 times its part of 0.53 back.
    between(of_run(&found, 0, "E"), 0.96 * SERIES, 1.01 * SERIES);
}

/// The traction that a cut takes away is that which the jack gives back, if the wall is elastic and the traction even.
#[test]
fn a_flat_jack_gives_the_stress_of_the_wall_back() {
    let folder = tempfile::tempdir().unwrap();
    let found = evaluated(folder.path(), "flat-jack", &[], &[]);
    no_notes(&found);
    assert_eq!(found["runs"][1]["run"], "specimen-slot");
    // Units are stiffer than head joints, so that the stress across the bed is uneven by some per cent.
    for name in ["f_m", "f_m_left", "f_m_middle", "f_m_right"] {
        between(value(&found, "/together", name), 0.95 * 0.5, 1.05 * 0.5);
    }
    // The slot closes under the stress: more than the masonry there shortens, at most as a crack of its length in an
    // elastic plate of E = 3,455 MPa: 2 s l / E in its middle (Inglis), beside what the masonry shortens.
    let [whole, slot] = [0, 1].map(|run| of_run(&found, run, "gauges"));
    between(
        slot - whole,
        -2.0 * 0.5 * 390.0 / (0.7 * 3455.0),
        -0.25 * 0.5 * 390.0 / 3455.0,
    );
}

/// A unit pushed in place slides on both of its beds.
#[test]
fn a_unit_pushed_in_place_slides_on_its_beds() {
    let folder = tempfile::tempdir().unwrap();
    let options = ["--precompression", "0.1, 0.6 MPa"];
    let found = evaluated(folder.path(), "astm-c1531", &options, &[]);
    // Under the higher pressure a unit of the course above cracks before the tested one slides.
    let notes = found["notes"].as_array().unwrap();
    let [note] = &notes[..] else {
        panic!("{notes:?}")
    };
    let note = note.as_str().unwrap();
    assert!(
        note.starts_with("specimen-0.6: solids had cracked"),
        "{note}"
    );
    // The room for the jack and the free head joint carry nothing: at most all of their share comes to the unit, whose
    // stress is then (250 + 125 + 10)/250 = 1.54 times that of the wall.
    for (run, pressure) in [0.1, 0.6].into_iter().enumerate() {
        let most = C + TAN_PHI * 1.54 * pressure;
        between(
            of_run(&found, run, "f_v"),
            0.8 * (C + TAN_PHI * pressure),
            most,
        );
        between(
            of_run(&found, run, "f_vr"),
            TAN_PHI * pressure,
            TAN_PHI * 1.54 * pressure,
        );
    }
    // Shear is uneven along the beds, as of triplets.
    between(value(&found, "/together", "f_v0"), 0.75 * C, C);
    between(
        value(&found, "/together", "tan_phi_r"),
        TAN_PHI,
        1.54 * TAN_PHI,
    );
}

/// The stress between the slots is that of a homogeneous wall, whose gauges read 1.10 E on the mean and 0.90 E in the
/// middle: there the stress is above the pressure of the jacks.
#[test]
fn two_flat_jacks_give_the_modulus_of_the_masonry_between_them() {
    let folder = tempfile::tempdir().unwrap();
    let found = evaluated(folder.path(), "flat-jack-double", &[], &[]);
    no_notes(&found);
    // Both from runs of this deck with 6,240 MPa in all solids and joints that do not break. Beds that are softer than
    // units change the stress by some per cent.
    let [all, middle] = ["E", "E_middle"].map(|name| of_run(&found, 0, name));
    between(all, 0.94 * 1.10 * SERIES, 1.06 * 1.10 * SERIES);
    between(middle, 0.94 * 0.90 * SERIES, 1.06 * 0.90 * SERIES);
}

/// N = p t L on a wall as high as H: a rigid block carries N L/H with its top level, half of it if that may turn.
#[test]
fn walls_in_shear_carry_no_more_than_a_rigid_block() {
    let size = ["--size", "640x580", "--precompression", "0.3 MPa"];
    for (test, times) in [
        ("shear-compression", 1.0),
        ("shear-compression-cantilever", 0.5),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let found = evaluated(folder.path(), test, &size, &[]);
        // Half units of 130 mm and courses of 65 mm: 640 × 575 mm.
        let most = times * 1e-3 * 0.3 * 120.0 * 640.0 * 640.0 / 575.0;
        // The toes are not rigid: the compressed length takes a part, up to half in so squat a wall. The tensile bond of
        // the lowest bed opens before the peak; the tolerance of equilibrium leaves less than 2 %.
        between(of_run(&found, 0, "V_max"), 0.5 * most, 1.02 * most);
    }
}

#[test]
fn a_wall_to_and_fro_has_the_largest_force_of_its_loops() {
    let folder = tempfile::tempdir().unwrap();
    let size = ["--size", "510x450", "--precompression", "0.3 MPa"];
    let loops = [
        "steps.1.cycles.amplitudes=[\"0.5 mm\"]",
        "steps.1.cycles.repeat=1",
    ];
    let found = evaluated(folder.path(), "shear-compression-cyclic", &size, &loops);
    let history = folder.path().join("specimen.out/history.csv");
    let history = std::fs::read_to_string(history).unwrap();
    let force = column(&history, "force_kN");
    let most = force.iter().map(|force| force.abs()).fold(0.0, f64::max);
    assert_eq!(of_run(&found, 0, "V_max"), most);
    let turned = column(&history, "displacement_mm")
        .iter()
        .any(|way| *way < -0.49);
    assert!(turned);
}

#[test]
fn diagonal_compression_gives_strength_by_both_definitions() {
    let folder = tempfile::tempdir().unwrap();
    let found = evaluated(folder.path(), "rilem-lumb6", &["--size", "510x510"], &[]);
    let [p, s, tension] = ["P_max", "S_s", "f_t_rilem"].map(|name| of_run(&found, 0, name));
    // 510 × 510 × 120 mm, the height 10 mm less for the bed joint on top of it.
    let area = 120.0 * 0.5 * (510.0 + 510.0);
    assert!(
        (s / (FRAC_1_SQRT_2 * 1e3 * p / area) - 1.0).abs() < 1e-6,
        "{s}, {p}"
    );
    assert!((tension / s - FRAC_1_SQRT_2).abs() < 1e-6);
    // The modulus of the wall lies below that of the unit.
    between(of_run(&found, 0, "G"), 100.0, 6240.0 / 2.3);
}

/// Strips whose foot is clamped by its support: the first crack comes at M = p H²/8 = f_t t²/6. A mechanism with hinges
/// at the foot and in the span, of at most M = f_t t²/2 and the weight W of the strip times t/2 each, carries 11.66 M/H².
#[test]
fn walls_under_an_airbag_carry_between_the_first_crack_and_a_mechanism() {
    let (height, thickness) = (575.0_f64, 120.0_f64);
    let crack = 8.0 * F_T * thickness * thickness / 6.0 / (height * height);
    let weight = 1.9e-9 * 9810.0 * height * thickness;
    let hinge = F_T * thickness * thickness / 2.0 + weight * thickness / 2.0;
    let mechanism = 11.66 * hinge / (height * height);
    let strength = |test: &str, size: &str| {
        let folder = tempfile::tempdir().unwrap();
        let found = evaluated(folder.path(), test, &["--size", size], &[]);
        no_notes(&found);
        1e-3 * of_run(&found, 0, "p_max")
    };
    between(strength("out-of-plane", "510x580"), crack, mechanism);
    // Upright edges that are held carry a part.
    assert!(strength("out-of-plane-two-way", "770x580") > strength("out-of-plane", "770x580"));
}

/// Squat walls slide on their lowest bed when tan alpha = mu; slender ones would turn earlier.
#[test]
fn a_dry_wall_on_a_tilting_table_slides_at_its_friction() {
    let folder = tempfile::tempdir().unwrap();
    let found = evaluated(folder.path(), "tilting-table", &["--size", "1000x330"], &[]);
    // An increment of the tilt below, and above the tolerance of equilibrium, 5e-3 of the forces: a wall that begins to
    // slide is still at rest within it.
    between(of_run(&found, 0, "load_factor"), 0.98 * 0.7, 1.005 * 0.7);
}

/// A joint that is stronger than its mortar: the mortar tears, and the value is said to be that of the mortar.
#[test]
fn a_couplet_whose_mortar_tears_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("strong.toml");
    let joint =
        "f_t = 2\nc = 3\ntan_phi = 1\nmu = 0.8\nzeta = 4.38\nxi = 1.1\nG_I = 0.1\nG_II = 0.3\n";
    let materials = format!(
        "[materials.unit]\nname = \"limestone\"\n[materials.mortar]\nname = \"lime\"\n[interfaces.joint]\n{joint}"
    );
    std::fs::write(&file, materials).unwrap();
    let options = ["--materials", &file.display().to_string()];
    let found = evaluated(folder.path(), "couplet-tension", &options, &[]);
    let notes = found["notes"].as_array().unwrap();
    assert!(
        notes.len() == 1 && notes[0].as_str().unwrap().contains("units or mortar broke"),
        "{notes:?}"
    );
}

#[test]
fn options_and_folders_that_are_wrong_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let name = folder.path().join("a").display().to_string();
    let refused = |options: &[&str]| {
        let output = wythe(&[&["new", &name, "--test", "en1052-3"][..], options].concat());
        assert_eq!(code(&output), 2);
        stderr(&output)
    };
    assert!(refused(&["--unit", "250x120"]).contains("--unit: \"250x120\" has 2 sizes, not 3"));
    assert!(refused(&["--precompression", "1 kN"]).contains("expected"));
    let file = folder.path().join("mine.toml").display().to_string();
    std::fs::write(&file, "[materials.unit]\nE = \n").unwrap();
    let said = refused(&["--materials", &file]).replace(['\n', '│', ' '], "");
    assert!(said.contains("mine.toml:line2:"), "{said}");
    let empty = folder.path().display().to_string();
    let output = wythe(&["evaluate", &empty]);
    assert_eq!(code(&output), 4, "{}", stderr(&output));
    assert!(stderr(&output).contains("no results of a run"));
    // A run of a deck without [test].
    let deck = repository("examples/01_couplet_tension.toml")
        .display()
        .to_string();
    let out = folder.path().join("b.out").display().to_string();
    wythe(&["run", &deck, "--quiet", "--out", &out]);
    let output = wythe(&["evaluate", &out]);
    assert_eq!(code(&output), 2);
    assert!(
        stderr(&output).contains("has no table [test]"),
        "{}",
        stderr(&output)
    );
}

/// Pressure follows the faces of a wall that is turned, and a traction is turned with it: openings and energies are
/// those of the wall upright.
#[test]
fn a_turned_wall_behaves_as_the_upright_one() {
    let folder = tempfile::tempdir().unwrap();
    let ends = [0.0_f64, 30.0, 90.0].map(|degrees| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        // A pull of 0.1 MPa along the wall's own x, that opens head joints and slides beds.
        let text = format!(
            "{}length = 410\ncourses = 4\nclamped = false\nat = [50, 20, 10]\nrotate = {{ axis = \"-y\", angle = {degrees} }}\n\
             [[supports]]\non = \"wall.bottom\"\n[[probes]]\nname = \"along\"\non = \"wall.right\"\ndirection = [{cos}, 0, \
             {sin}]\n[[steps]]\nkind = \"load\"\n[[steps.loads]]\nname = \"press\"\non = \"wall.top\"\npressure = 0.3\n[[steps]]\n\
             kind = \"load\"\n[[steps.loads]]\nname = \"pull\"\non = \"wall.right\"\ntraction = [{}, 0, {}]\n",
            masonry(0.05, 0.15),
            0.1 * cos,
            0.1 * sin
        );
        let history = history_of(folder.path(), &text);
        ["along_mm", "elastic_energy_J", "interface_dissipation_J"].map(|name| last(&history, name))
    });
    assert!(ends[0].iter().all(|value| *value > 0.0), "{ends:?}");
    for end in &ends[1..] {
        for (a, b) in end.iter().zip(&ends[0]) {
            // The tolerance of equilibrium, 2e-3 of the mean nodal force, leaves less than that.
            assert!((a / b - 1.0).abs() < 2e-3, "{ends:?}");
        }
    }
}

/// A couplet that is turned and sheared along its bed, by a face or by a spring, has the curve of the upright one.
#[test]
fn a_couplet_sheared_along_a_vector_has_the_curve_of_the_one_sheared_along_an_axis() {
    let folder = tempfile::tempdir().unwrap();
    let face = ("face = \"wall-1-0.top\"", "");
    let spring = (
        "spring = \"jack\"",
        "[[springs]]\nname = \"jack\"\non = \"wall-1-0\"\nstiffness = [1e6, 0, 1e6]\n",
    );
    // Peak and last force [kN], and the way [mm].
    let curve = |degrees: f64, (drive, table): (&str, &str)| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let text = format!(
            "{}length = 200\ncourses = 2\nclamped = false\nrotate = {{ axis = \"-y\", angle = {degrees} }}\n[[supports]]\n\
             on = \"wall.bottom\"\n{table}[[steps]]\nkind = \"drive\"\n{drive}\ndirection = [{}, 0, {}]\ndisplacement = 0.3\n",
            masonry(0.3, 0.25),
            2.0 * cos,
            2.0 * sin
        );
        let history = history_of(folder.path(), &text);
        let force = column(&history, "force_kN");
        let most = force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [
            most,
            last(&history, "force_kN"),
            last(&history, "displacement_mm"),
        ]
    };
    for (by, degrees) in [(face, 30.0), (spring, -50.0)] {
        let [a, b] = [curve(0.0, by), curve(degrees, by)];
        assert!(
            (a[2] - 0.3).abs() < 1e-12 && (b[2] - 0.3).abs() < 1e-12,
            "{a:?}, {b:?}"
        );
        // Peaks lie within increments.peak = 0.5 % of each other; residual forces follow the law.
        assert!((a[0] / b[0] - 1.0).abs() < 5e-3, "{a:?}, {b:?}");
        assert!((a[1] - b[1]).abs() < 5e-3 * a[0], "{a:?}, {b:?}");
    }
}

/// After a preload of the level beam the history shows the spring that is driven, not the beam.
#[test]
fn a_driven_spring_is_shown_after_a_preload_of_the_top() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "{}length = 200\ncourses = 3\nclamped = {{ bottom_courses = 0, top_courses = 0 }}\n[[springs]]\nname = \"jack\"\n\
         on = \"wall-1-0.left\"\nstiffness = [1e6, 0, 0]\n[[steps]]\nkind = \"preload\"\ntop_pressure = 0.2\n[[steps]]\n\
         kind = \"drive\"\nspring = \"jack\"\ndirection = \"x\"\ndisplacement = 0.02\n",
        masonry(0.3, 0.25)
    );
    let history = history_of(folder.path(), &text);
    assert!((last(&history, "displacement_mm") - 0.02).abs() < 1e-12);
    assert!(last(&history, "force_kN") > 0.0);
}
