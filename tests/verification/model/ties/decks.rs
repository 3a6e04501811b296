//! Ties of decks: bad ones, bars in bed joints, the examples.

use super::rods::rod;
use crate::common::blocks::{Bad, GRAVITY, HEAD, PAIR, refuses};
use crate::common::{examples, scene};
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::state::Status;

/// A rod through both blocks of [`PAIR`].
const TIE: &str = r#"
[[ties]]
name = "rod"
points = [[50, 50, -25], [50, 50, 80]]
diameter = "16 mm"
E = "210 GPa"
f_y = "355 MPa"
prestress = "10 kN"
"#;

const BAD: &[Bad] = &[
    (
        "name = \"rod\"",
        "name = \"a rod\"",
        "ties.0.name",
        "no name for a column",
        "a letter",
    ),
    (
        "[50, 50, 80]]",
        "[50, 50, 90]]",
        "ties.0.points",
        "lies in no solid",
        "in a body",
    ),
    (
        "[50, 50, 80]]",
        "[50, 50, -25]]",
        "ties.0.points",
        "no length",
        "move one",
    ),
    (
        "[50, 50, 80]]",
        "[50, 60, -15]]",
        "ties.0.points",
        "within one element of base",
        "another element",
    ),
    (
        "[50, 50, 80]]",
        "[50, 50, 80], [9, 9, 9]]",
        "ties.0.points",
        "has 3 points",
        "bonded",
    ),
    (
        "points = [[50, 50, -25], [50, 50, 80]]\n",
        "",
        "ties.0.points",
        "neither `points` nor",
        "courses",
    ),
    (
        "diameter = \"16 mm\"",
        "area = 0",
        "ties.0.area",
        "not positive",
        "above 0",
    ),
    (
        "diameter = \"16 mm\"\n",
        "",
        "ties.0.area",
        "neither `area` nor",
        "diameter",
    ),
    (
        "diameter = \"16 mm\"",
        "diameter = \"-1 mm\"",
        "ties.0.diameter",
        "not positive",
        "above 0",
    ),
    (
        "diameter = \"16 mm\"",
        "diameter = 16\narea = 200",
        "ties.0.area",
        "both",
        "of each",
    ),
    (
        "E = \"210 GPa\"",
        "E = 0",
        "ties.0.E",
        "not positive",
        "above 0",
    ),
    (
        "f_y = \"355 MPa\"",
        "f_y = 0",
        "ties.0.f_y",
        "not positive",
        "above 0",
    ),
    (
        "f_y = \"355 MPa\"",
        "f_y = 40",
        "ties.0.prestress",
        "reach its yield stress",
        "larger area",
    ),
    (
        "f_y = \"355 MPa\"",
        "hardening = 40",
        "ties.0.hardening",
        "stays elastic",
        "f_y",
    ),
    (
        "prestress = \"10 kN\"",
        "prestress = 1\nbond = \"bonded\"",
        "ties.0.prestress",
        "cannot be stressed",
        "anchored",
    ),
    (
        "prestress = \"10 kN\"",
        "unbonded = 1",
        "ties.0.unbonded",
        "free over its whole",
        "bonded",
    ),
    (
        "prestress = \"10 kN\"",
        "step = \"gravty\"",
        "ties.0.step",
        "no step named",
        "did you mean `gravity`",
    ),
    (
        "prestress = \"10 kN\"",
        "along = \"wall\"",
        "ties.0.points",
        "both `points` and",
        "courses",
    ),
    (
        "points = [[50, 50, -25], [50, 50, 80]]",
        "along = \"wal\"\ncourses = [1]",
        "ties.0.along",
        "no wall named",
        "along",
    ),
    (
        "[50, 50, 80]]",
        "[150, 50, -25]]\nbond = \"bonded\"\nprestres = 1",
        "ties.0.prestres",
        "not a known key",
        "prestress",
    ),
    (
        "points = [[50, 50, -25], [50, 50, 80]]",
        "points = [[10, 50, 0], [190, 50, 0]]\nbond = \"bonded\"\nstep = \"gravity\"",
        "ties.0.prestress",
        "cannot be stressed",
        "anchored",
    ),
];

#[test]
fn wrong_ties_are_rejected() {
    refuses(&format!("{HEAD}{PAIR}{TIE}{GRAVITY}"), BAD);
    let drive =
        "\n[[steps]]\nkind = \"drive\"\nface = \"top.top\"\ndirection = \"z\"\ndisplacement = 1\n";
    let driven: &[Bad] = &[(
        "f_y",
        "f_y",
        "ties.0.prestress",
        "steps.0 drives",
        "a step before it",
    )];
    refuses(&format!("{HEAD}{PAIR}{TIE}{drive}"), driven);
    let lies = TIE.replace("prestress = \"10 kN\"", "bond = \"bonded\"");
    let flat: &[Bad] = &[(
        "points = [[50, 50, -25], [50, 50, 80]]",
        "points = [[10, 50, 0], [190, 50, 0]]",
        "ties.0.points",
        "lies in base and in top at once",
        "off the joint",
    )];
    refuses(&format!("{HEAD}{PAIR}{lies}{GRAVITY}"), flat);
    let plane = "\n[[symmetry]]\nnormal = \"x\"\nat = 300\nkeep = \"below\"\n";
    let across: &[Bad] = &[(
        "[50, 50, 80]]",
        "[300, 50, -25]]",
        "ties.0.points",
        "reaches the plane of symmetry",
        "whole scene",
    )];
    refuses(&format!("{HEAD}{PAIR}{TIE}{plane}{GRAVITY}"), across);
}

/// A wall of two and a half units and four courses, with a bar of 6 mm in two of its bed joints.
const WALL: &str = r#"
format = 1

[materials.brick]
E = "10 GPa"
nu = 0.15
density = "1900 kg/m^3"

[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.7
mu = 0.7

[wall]
unit = [200, 100, 50]
bed_joint = 10
head_joint = 10
length = 520
courses = 4
unit_material = "brick"
mortar_material = "brick"
interface = "dry"

[[ties]]
name = "bars"
along = "wall"
courses = [0, 2]
diameter = 6
bars = 2
E = "200 GPa"
f_y = "500 MPa"
unbonded = 60

[[steps]]
kind = "preload"
top_pressure = 0.1
"#;

/// Two bars in each joint, each of them bound to both courses by half of its area.
#[test]
fn bars_in_bed_joints_are_bound_to_both_courses() {
    let deck = Deck::from_str(WALL, "wall.toml").unwrap();
    let (model, _) = Model::from_deck(&deck).unwrap();
    assert_eq!(deck.columns(), model.columns());
    assert_eq!(model.columns()[..2], ["bars-0_kN", "bars-0_stretch_mm"]);
    let circle = 0.25 * std::f64::consts::PI * 36.0;
    for (tie, course) in model.ties.iter().zip([0_u16, 2]) {
        assert!((tie.law.area / (0.5 * circle) - 1.0).abs() < 1e-12);
        assert!(tie.law.compression);
        assert_eq!(tie.strands.len(), 4);
        for (strand, (k, y)) in tie
            .strands
            .iter()
            .zip([(0, 25.0), (1, 25.0), (0, 75.0), (1, 75.0)])
        {
            for point in strand {
                assert_eq!(model.mesh.course[point.element as usize], course + k);
                assert!((point.at[1] - y).abs() < 1e-9, "{point:?}");
                let at = |d: usize| -> f64 {
                    point
                        .nodes
                        .iter()
                        .map(|(n, w)| w * model.mesh.nodes[*n as usize][d])
                        .sum()
                };
                (0..3).for_each(|d| assert!((at(d) - point.at[d]).abs() < 1e-9, "{point:?}"));
            }
            // From end to end.
            let [low, high] = model.mesh.extent(0);
            assert!(
                (strand[0].at[0] - low).abs() < 0.02,
                "{:?} {low}",
                strand[0]
            );
            assert!(
                (strand[strand.len() - 1].at[0] - high).abs() < 0.02,
                "{strand:?} {high}"
            );
        }
    }
    let bad: &[Bad] = &[
        (
            "courses = [0, 2]",
            "courses = [0, 3]",
            "ties.0.courses",
            "no bed joint on course 3",
            "from 0",
        ),
        (
            "courses = [0, 2]",
            "courses = [2, 2]",
            "ties.0.name",
            "two columns",
            "once",
        ),
        (
            "courses = [0, 2]",
            "courses = []",
            "ties.0.courses",
            "is empty",
            "courses = [",
        ),
        (
            "courses = [0, 2]\n",
            "",
            "ties.0.courses",
            "is missing",
            "courses = [",
        ),
        (
            "along = \"wall\"",
            "along = \"wal\"",
            "ties.0.along",
            "no wall named",
            "did you mean `wall`",
        ),
    ];
    refuses(WALL, bad);
}

/// Without the rod the arch of example 93 falls; with it the arch stands.
#[test]
fn a_rod_keeps_a_thin_arch_from_falling() {
    let deck = examples::load("93_arch_with_a_tie", &[]);
    let (model, _) = Model::from_deck(&deck).unwrap();
    let (recording, summary) = scene::run(&model);
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    let (force, stretch) = rod(recording.rows.last().unwrap());
    let weight = 2e-9 * 9810.0 * std::f64::consts::PI * 1000.0 * 85.0 * 200.0;
    println!("force {force} N, stretch {stretch} mm, weight of the arch {weight} N");
    // Elastic: E A/L. It carries a small part of the weight.
    let stiffness = 210e3 * 0.25 * std::f64::consts::PI * 64.0 / 1496.2;
    assert!((force / (stiffness * stretch) - 1.0).abs() < 1e-6);
    assert!(force > 0.0 && force < 0.5 * weight, "{force}");
    let mut without = model;
    without.ties.clear();
    for step in &mut without.steps {
        step.ties.clear();
    }
    let (_, summary) = scene::run(&without);
    assert_ne!(summary.status, Status::Completed, "{}", summary.message);
}

/// The bars of example 94 carry on, up to their yield force, where the masonry has torn.
#[test]
fn bars_carry_on_where_a_wallette_tears() {
    let (model, with) = examples::completed("94_wallette_with_bars", &[]);
    let last = with.rows.last().unwrap();
    let columns = model.columns();
    let of_bars = model.ties.iter().map(|tie| format!("{}_kN", tie.name));
    let place = |name: String| columns.iter().position(|column| *column == name).unwrap();
    let bars: f64 = of_bars.map(|name| last.probes[place(name)]).sum();
    let most = with.rows.iter().map(|row| row.force_kN).fold(0.0, f64::max);
    let area = 0.25 * std::f64::consts::PI * 16.0;
    println!(
        "at the end {} kN, of them {bars} kN of the bars; most {most} kN",
        last.force_kN
    );
    // Four bars: the force of yielding, and hardening of 1 GPa up to the strain of rupture.
    let yields = 4.0 * 500.0 * area * 1e-3;
    assert!(
        bars <= yields * (1.0 + 1e3 * 0.05 / 500.0),
        "{bars} {yields}"
    );
    assert!(
        bars > 0.2 * yields && last.force_kN > 0.9 * bars,
        "{bars} {last:?}"
    );
}
