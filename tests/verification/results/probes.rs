//! Probes: quantities that a deck adds to the history.

use crate::common::blocks::{Bad, HEAD, deck, model, refuses};
use crate::common::scene::Recording;
use wythe::model::Model;
use wythe::model::scene::Fidelity;
use wythe::state::Status;

/// A block is pushed over another one on a dry joint; then both fly freely.
const SCENE: &str = r#"
[[blocks]]
name = "base"
size = [400, 100, 50]
material = "stone"
mesh = [4, 1, 1]

[[blocks]]
name = "top"
size = [200, 100, 50]
at = [0, 0, 50]
material = "stone"
mesh = [2, 1, 1]

[[contacts]]
slave = "top.bottom"
master = "base.top"
interface = "dry"

[[supports]]
on = "base.bottom"

[[probes]]
name = "slip"
on = "top.bottom"
minus = "base.top"
direction = "x"

[[probes]]
name = "lag"
near = [0, 0, 100]
minus = { on = ["base.top", "base.bottom"], near = [0, 0, 48] }
direction = "-x"

[[probes]]
name = "slip"
on = "top"
direction = "z"
quantity = "velocity"

[[steps]]
kind = "preload"
face = "top.top"
pressure = "0.5 MPa"

[[steps]]
kind = "drive"
face = "top.top"
direction = "x"
displacement = 2
free = ["z"]
increments = { initial = 0.1, max = 0.1 }
procedure = "dynamic"
"#;

#[test]
fn probes_follow_nodes_faces_and_blocks() {
    let mut model = model(SCENE, "");
    let columns: Vec<&str> = model.probes.iter().map(|p| p.column.as_str()).collect();
    assert_eq!(columns, ["slip_mm", "lag_mm", "slip_mm_per_s"]);
    model.output.every = 1;
    model.fidelity = Fidelity::Full; // the test reads its states
    let (recording, summary) = crate::common::scene::run(&model);
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    let Recording {
        rows,
        frames,
        states,
    } = recording;
    let x = &model.mesh.nodes;
    // 20 nodes of the base, 12 of the top.
    let nodes = |from: usize, z: f64| (0..x.len()).filter(move |&n| n / 20 == from && x[n][2] == z);
    for ((row, frame), state) in rows.iter().zip(&frames).zip(&states) {
        assert_eq!(row.probes, frame.probes);
        let u = &frame.displacement;
        let mean = |of: Vec<usize>| of.iter().map(|&n| u[n][0]).sum::<f64>() / of.len() as f64;
        let slip = mean(nodes(1, 50.0).collect()) - mean(nodes(0, 50.0).collect());
        // Tolerance: sums of ten numbers up to 2, in a different order.
        assert!((row.probes[0] - slip).abs() < 1e-14, "{row:?}");
        // The first node of the base's top, and the first node of the driven face.
        assert_eq!(x[10], [0.0, 0.0, 50.0]);
        assert_eq!(row.probes[1], -(row.displacement_mm - u[10][0]));
        let dofs = wythe::assembly::DofMap::new(&model);
        let of_top = (20..32).map(|n| state.velocity[dofs.slot[n][2] as usize]);
        assert!((row.probes[2] - of_top.sum::<f64>() / 12.0).abs() < 1e-12);
    }
    let last = rows.last().unwrap();
    assert!(last.probes[0] > 1.9, "it slid: {last:?}");
    assert!(rows.iter().any(|r| r.probes[2] != 0.0), "something moved");
}

#[test]
fn a_wall_has_probes_near_points_and_on_its_sides() {
    let path = "examples/01_couplet_tension.toml";
    let text = std::fs::read_to_string(path).unwrap();
    let probe = "[[probes]]\nname = \"top\"\nnear = [0, 0, \"1 m\"]\ndirection = \"z\"\n";
    let error = Model::from_deck(&deck(&format!("{text}{probe}"))).unwrap_err();
    assert_eq!(error.key(), "probes.0.near");
    assert!(
        error.message().contains("farther than the model"),
        "{error}"
    );
    let near = probe.replace("1 m", "0.2 m");
    let (model, _) = Model::from_deck(&deck(&format!("{text}{near}"))).unwrap();
    let node = model.probes[0].nodes[0] as usize;
    let highest = model.mesh.nodes.iter().map(|x| x[2]);
    let highest = highest.fold(0.0, f64::max);
    assert_eq!(model.mesh.nodes[node], [0.0, 0.0, highest]);
    let named = |name: &str| {
        let named = probe.replace("near = [0, 0, \"1 m\"]", &format!("on = \"{name}\""));
        Model::from_deck(&deck(&format!("{text}{named}")))
    };
    let (model, _) = named("wall.top").unwrap();
    let nodes = &model.probes[0].nodes;
    assert!(
        nodes
            .iter()
            .all(|n| model.mesh.nodes[*n as usize][2] == highest)
    );
}

#[test]
fn decks_with_probes_survive_a_round_trip() {
    let first = deck(&format!("{HEAD}{SCENE}"));
    let text = first.to_toml().unwrap();
    let again = deck(&text);
    assert_eq!(again, first, "{text}");
}

/// Replaced text of the scene, its replacement, the key of the error, part of it, part of the advice.
const BAD: &[Bad] = &[
    (
        "name = \"lag\"",
        "name = \"slip\"",
        "probes.1.name",
        "two columns named `slip_mm`",
        "of its own",
    ),
    (
        "name = \"lag\"",
        "name = \"displacement\"",
        "probes.1.name",
        "two columns named `displacement_mm`",
        "of its own",
    ),
    (
        "name = \"lag\"",
        "name = \"a,b\"",
        "probes.1.name",
        "no name for a column",
        "a letter",
    ),
    (
        "name = \"lag\"",
        "name = \"\"",
        "probes.1.name",
        "no name for a column",
        "a letter",
    ),
    (
        "near = [0, 0, 100]\n",
        "",
        "probes.1.on",
        "neither `on` nor `near`",
        "on = ",
    ),
    (
        "near = [0, 0, 100]",
        "near = [0, 0, 100000]",
        "probes.1.near",
        "farther than the model",
        "mm",
    ),
    (
        "near = [0, 0, 100]",
        "near = [0, 0, \"1 s\"]",
        "probes.1.near.2",
        "expected a length",
        "near = ",
    ),
    (
        "minus = \"base.top\"",
        "minus = \"bass.top\"",
        "probes.0.minus.on",
        "no block named `bass`",
        "did you mean `base`?",
    ),
    (
        "minus = \"base.top\"",
        "minus = {}",
        "probes.0.minus",
        "neither `on` nor `near`",
        "minus = ",
    ),
    (
        "minus = \"base.top\"",
        "minus = []",
        "probes.0.minus.on",
        "the list is empty",
        "a block or a face",
    ),
    (
        "minus = \"base.top\"",
        "minus = { far = [0, 0, 0] }",
        "probes.0.minus.far",
        "`far` is not a known key",
        "on",
    ),
    (
        "minus = \"base.top\"",
        "minus = 3",
        "probes.0.minus",
        "a table of `on` and `near`",
        "minus = ",
    ),
    (
        "on = \"top.bottom\"",
        "on = \"top.under\"",
        "probes.0.on",
        "no face `under`",
        "bottom (-z)",
    ),
    (
        "direction = \"-x\"",
        "direction = \"up\"",
        "probes.1.direction",
        "`up` is not a known choice",
        "x",
    ),
    (
        "quantity = \"velocity\"",
        "quantity = \"speed\"",
        "probes.2.quantity",
        "`speed` is not a known choice",
        "displacement, velocity",
    ),
];

#[test]
fn bad_probes_name_the_key_and_the_fix() {
    refuses(&format!("{HEAD}{SCENE}"), BAD);
}
