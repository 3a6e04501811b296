//! Ground that settles by a given shape.

use crate::common::blocks::{Bad, HEAD, deck_and_model, refuses};
use crate::common::scene::{self, gap};
use wythe::model::Model;
use wythe::state::Status;

/// Elastic piers on the ground, `count` of them every 2 m, 100 mm wide and 1 m high, and probes on their tops.
fn piers(count: usize, settlement: &str) -> String {
    let names: Vec<String> = (0..count).map(|i| format!("\"pier-{i}.bottom\"")).collect();
    let mut text = format!(
        "{HEAD}\n[[settlements]]\nname = \"ground\"\non = [{}]\n{settlement}\n",
        names.join(", ")
    );
    for i in 0..count {
        let at = 2000 * i;
        text.push_str(&format!(
            "[[blocks]]\nname = \"pier-{i}\"\nsize = [100, 100, 1000]\nat = [{at}, 0, 0]\nmaterial = \"stone\"\n\
             mesh = [1, 1, 4]\n"
        ));
        for direction in ["x", "z"] {
            text.push_str(&format!(
                "[[probes]]\nname = \"{direction}-{i}\"\non = \"pier-{i}.top\"\ndirection = \"{direction}\"\n"
            ));
        }
    }
    text
}

const DRIVE: &str =
    "[[steps]]\nkind = \"drive\"\nsettlement = \"ground\"\ndisplacement = \"20 mm\"\n";

/// Values of the probes at the end of a run [mm]. `[pier][x, z]`
fn tops(model: &Model) -> Vec<[f64; 2]> {
    let (recording, summary) = scene::run(model);
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    let last = recording.rows.last().expect("a row");
    last.probes
        .chunks(2)
        .map(|pair| [pair[0], pair[1]])
        .collect()
}

/// For small slopes a narrow pier follows the ground: it goes down by the trough s at its middle, and its top goes
/// sideways by −s′ h.
#[test]
fn piers_on_a_trough_lean_towards_its_middle() {
    let (centre, inflection, deepest) = (5050.0, 3000.0, 20.0);
    let trough = format!("trough = {{ centre = {centre}, inflection = {inflection} }}");
    let (_, model) = deck_and_model(&format!("{}{DRIVE}", piers(6, &trough)));
    for (i, [x, z]) in tops(&model).into_iter().enumerate() {
        let s = (2000.0 * i as f64 + 50.0 - centre) / inflection;
        let down = deepest * (-0.5_f64 * s * s).exp();
        // u_z = −w(x); the base turns by −w′ and the top goes by w′ h, w′ = −w s / i.
        let lean = -down * s / inflection * 1000.0;
        println!("pier {i}: {x} ({lean}), {z} ({})", -down);
        // Curvature over the width of a pier and second-order terms: (50/3000)²/2 of 20 mm, θ² h/2 = 0.01 mm.
        assert!((z + down).abs() < 0.02, "pier {i}: {z} and {}", -down);
        assert!((x - lean).abs() < 0.02, "pier {i}: {x} and {lean}");
    }
}

/// Probes on the ground itself give the mean of its nodes, each with its part of the settlement.
#[test]
fn probes_on_the_ground_follow_its_shape() {
    let tilt = "along = \"x\"\ntilt = { from = 0, to = 4100 }";
    let probes: String = (0..3)
        .map(|i| {
            format!(
                "[[probes]]\nname = \"foot-{i}\"\non = \"pier-{i}.bottom\"\ndirection = \"-z\"\n"
            )
        })
        .collect();
    let (_, model) = deck_and_model(&format!("{}{probes}{DRIVE}", piers(3, tilt)));
    let recording = scene::completed(&model);
    let feet = &recording.rows.last().expect("a row").probes[6..];
    for (i, foot) in feet.iter().enumerate() {
        // The middle of the pier is at 50 + 2000 i of 4100 mm.
        let right = 20.0 * (50.0 + 2000.0 * i as f64) / 4100.0;
        assert!((foot - right).abs() < 1e-9, "{feet:?}");
    }
}

#[test]
fn a_tilt_is_a_rigid_rotation_without_force() {
    let tilt = "along = \"x\"\ntilt = { from = 0, to = 100 }";
    let (_, model) = deck_and_model(&format!(
        "{}{}",
        piers(1, tilt),
        DRIVE.replace("20 mm", "0.1 mm")
    ));
    let (recording, summary) = scene::run(&model);
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    let last = recording.rows.last().expect("a row");
    // −0.1 mm over 100 mm: a turn of 1e-3 about y, and the top moves by 1 mm along x.
    assert!((last.probes[0] - 1.0).abs() < 1e-3, "{:?}", last.probes);
    // The base keeps its length along x while it turns: a strain of θ²/2 = 5e-7, 0.0025 MPa of 5000 MPa.
    assert!(last.force_kN.abs() < 1e-3, "{last:?}");
}

/// The work of the ground is the energy of a block that it bends: forces and displacements belong to each other.
#[test]
fn the_work_of_the_ground_is_stored() {
    let scene = format!(
        "{HEAD}[[blocks]]\nname = \"slab\"\nsize = [1000, 100, 100]\nmaterial = \"stone\"\nmesh = [10, 1, 1]\n\
         [[settlements]]\nname = \"ground\"\non = \"slab.bottom\"\ntable = {{ at = [0, 400, 1000], values = [0, 1, 0.25] \
         }}\n{}",
        DRIVE.replace("20 mm", "0.5 mm")
    );
    let (_, model) = deck_and_model(&scene);
    let recording = scene::completed(&model);
    let last = recording.rows.last().expect("a row");
    assert!(last.force_kN > 1.0, "{last:?}");
    assert!(gap(last) < 1e-6, "{}", gap(last));
}

/// A dry wall on three footings spans the middle one, which settles and stays there.
#[test]
fn a_dry_wall_spans_the_footing_that_settles() {
    let mut scene = format!(
        "{HEAD}[wall]\nunit = [200, 100, 60]\nbed_joint = 0\nhead_joint = 0\nlength = 2000\ncourses = 6\nunit_material = \
         \"stone\"\ninterface = \"dry\"\nmesh = [2, 1, 1]\nclamped = false\n"
    );
    for (i, (at, length)) in [(0, 650), (750, 500), (1350, 650)].iter().enumerate() {
        scene.push_str(&format!(
            "[[blocks]]\nname = \"footing-{i}\"\nsize = [{length}, 100, 100]\nat = [{at}, 0, -100]\nmaterial = \"stone\"\n"
        ));
    }
    scene.push_str(
        "[[contacts]]\nslave = \"wall.bottom\"\nmaster = [\"footing-0.top\", \"footing-1.top\", \
         \"footing-2.top\"]\ninterface = \"dry\"\n[[settlements]]\nname = \"ground\"\non = [\"footing-0\", \"footing-1\", \
         \"footing-2\"]\ntable = { at = [700, 701, 1299, 1300], values = [0, 1, 1, 0] }\n[[probes]]\nname = \"top\"\non = \
         \"wall.top\"\ndirection = \"z\"\n[[steps]]\nkind = \"gravity\"\n",
    );
    scene.push_str(&DRIVE.replace("20 mm", "10 mm"));
    scene.push_str(&DRIVE.replace("20 mm", "-2 mm"));
    let (_, model) = deck_and_model(&scene);
    let recording = scene::completed(&model);
    let settled = recording.rows.iter().rfind(|row| row.step == 1);
    let settled = settled.expect("a row of the drive");
    let last = recording.rows.last().expect("a row");
    println!("{settled:?}\n{last:?}");
    // The footing carries itself, 98 N, and the stones below the arch: a triangle of 600 mm at 45 degrees at most.
    let weight = |area: f64| area * 0.1 * 2000.0 * 9.81 * 1e-3;
    let [own, wedge] = [weight(0.5 * 0.1), weight(0.5 * 0.6 * 0.3)];
    let carried = -settled.force_kN;
    assert!(
        carried > 0.999 * own && carried < own + 2.0 * wedge,
        "{carried}"
    );
    // Stones that followed the footing would go down by millimetres: 0.05 mm is a 200th of its way.
    assert!(settled.probes[0].abs() < 0.05, "{settled:?}");
    assert!((settled.displacement_mm - 10.0).abs() < 1e-9);
    assert!((last.displacement_mm - 8.0).abs() < 1e-9);
    // Stones rest on the footing that settles without a drop of more than the arch.
    assert!(gap(last) < 0.01, "{}", gap(last));
}

/// Ground of which every node goes half of the way feels half of the weight that stands on it.
#[test]
fn the_force_of_the_ground_is_weighed_by_its_parts() {
    let half = "table = { at = [0, 100], values = [0.5, 0.5] }";
    let steps = format!(
        "[[steps]]\nkind = \"gravity\"\n{}",
        DRIVE.replace("20 mm", "1 mm")
    );
    let (_, model) = deck_and_model(&format!("{}{steps}", piers(1, half)));
    let recording = scene::completed(&model);
    let last = recording.rows.last().expect("a row");
    let weight = 0.1 * 0.1 * 1.0 * 2000.0 * 9.81 * 1e-3;
    // Tolerance of equilibrium: 2e-3.
    assert!(
        (last.force_kN + 0.5 * weight).abs() < 2e-3 * weight,
        "{last:?}"
    );
    assert!(
        (last.probes[1] - tops_start(&recording) + 0.5).abs() < 1e-6,
        "{last:?}"
    );
    assert!(gap(last) < 1e-6, "{}", gap(last));
}

/// Height of the top when the drive begins [mm].
fn tops_start(recording: &scene::Recording) -> f64 {
    let before = recording.rows.iter().rfind(|row| row.step == 0);
    before.map_or(0.0, |row| row.probes[1])
}

#[test]
fn bad_settlements_are_errors() {
    let good = format!(
        "{}{DRIVE}",
        piers(2, "trough = { centre = 0, inflection = 900 }")
    );
    let bad: &[Bad] = &[
        (
            "inflection = 900",
            "inflection = 0",
            "settlements.0.trough.inflection",
            "not positive",
            "above 0",
        ),
        (
            "trough = { centre = 0, inflection = 900 }",
            "",
            "settlements.0.trough",
            "has one shape",
            "inflection",
        ),
        (
            "trough = { centre = 0, inflection = 900 }",
            "tilt = { from = 5, to = 5 }",
            "settlements.0.tilt.to",
            "two points",
            "0 at the first",
        ),
        (
            "trough = { centre = 0, inflection = 900 }",
            "table = { at = [0, 5, 4], values = [0, 1, 0] }",
            "settlements.0.table.at",
            "are no table",
            "ascending",
        ),
        (
            "trough = { centre = 0, inflection = 900 }",
            "table = { at = [0, 5], values = [0, 0] }",
            "settlements.0.on",
            "moves none",
            "is 0 at all",
        ),
        (
            "settlement = \"ground\"",
            "settlement = \"grund\"",
            "steps.0.settlement",
            "no settlement named",
            "ground",
        ),
        (
            "settlement = \"ground\"",
            "settlement = \"ground\"\nface = \"pier-0.top\"",
            "steps.0.settlement",
            "either",
            "its own",
        ),
        (
            "pier-1.bottom",
            "pier-9.bottom",
            "settlements.0.on",
            "no block named",
            "pier",
        ),
    ];
    refuses(&good, bad);
}

/// Ground that tilts below a wall of rigid units turns it as a body: the ground does the work of half its weight. Units
/// that the slope stretched had three quarters of that.
#[test]
fn ground_that_tilts_turns_rigid_units() {
    let text = format!(
        "{HEAD}\n[interfaces.joint]\nf_t = 5\nc = 7.5\ntan_phi = 0.7\nmu = 0.7\nzeta = 4.38\nxi = 1.1\nG_I = 1\nG_II = \
         5\nnormal_stiffness = 20\nshear_stiffness = 8\n[wall]\nunit = [400, 200, 200]\nbed_joint = 0\nhead_joint \
         = 0\nlength = 2000\ncourses = 6\nunit_material = \"stone\"\ninterface = \"joint\"\nrigid = true\nclamped = \
         false\n[[settlements]]\nname = \"ground\"\non = \"wall.bottom\"\ntilt = {{ from = 0, to = 2000 }}\n\
         [[steps]]\nkind = \"gravity\"\n[[steps]]\nkind = \"drive\"\nsettlement = \"ground\"\ndisplacement = 10\n"
    );
    let (_, model) = deck_and_model(&text);
    let recording = scene::completed(&model);
    let force = recording.rows.last().expect("a row").force_kN;
    let weight: f64 = {
        let mesh = &model.mesh;
        let density = model.materials[0].parameters.elastic().density;
        let volumes = (0..mesh.elements.len()).map(|e| mesh.volume(e));
        1e-3 * 9810.0 * density * volumes.sum::<f64>()
    };
    // The slope of 0.5 % adds terms of second order.
    assert!(
        (force / (-0.5 * weight) - 1.0).abs() < 0.01,
        "{force} {weight}"
    );
}
