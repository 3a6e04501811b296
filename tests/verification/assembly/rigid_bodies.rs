//! Rigid bodies in runs: they keep their shape, move as rigid-body mechanics says, and halves show the whole.

use crate::common::blocks::deck as parsed;
use crate::common::scene::{completed, imbalance, run};
use wythe::model::Model;
use wythe::model::scene::Fidelity;
use wythe::state::Status;

/// Stones on dry joints.
const STONES: &str = r#"
format = 1
[materials.stone]
E = "10 GPa"
nu = 0.2
density = "2000 kg/m^3"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.6
mu = 0.6
normal_stiffness = "50 N/mm^3"
shear_stiffness = "20 N/mm^3"
"#;

/// Example 86 as one rigid body, released at half of the angle at which it would fall.
fn rocking() -> String {
    let text = include_str!("../../../examples/86_rocking_block.toml");
    let text = text.replace("mesh = [2, 1, 10]", "rigid = true");
    let stiff = "mu = 1\nnormal_stiffness = \"1000 N/mm^3\"\nshear_stiffness = \"400 N/mm^3\"";
    text.replace("mu = 1", stiff)
}

/// Energy of a block of mass m that turns about its edge, with R its half diagonal: ½ (4/3 m R²) ω² = m g R (cos(α − θ)
/// − cos α) at the impact. A lumped mass would give two thirds of ω².
#[test]
fn a_block_rocks_with_the_moment_of_inertia_of_a_solid() {
    let text = rocking().replace("initial = 0.01, max = 0.01", "initial = 0.004, max = 0.004");
    for text in [
        text.clone(),
        text.replace("rigid = true", "mesh = [1, 1, 1]"),
    ] {
        rocks(&text);
    }
}

fn rocks(text: &str) {
    let recording = completed(&Model::from_deck(&parsed(text)).unwrap().0);
    let (width, height, start) = (0.2_f64, 1.0_f64, 5.65496_f64.to_radians());
    let (radius, slenderness) = (0.5 * width.hypot(height), (width / height).atan());
    let fall = 9.81 * radius * ((slenderness - start).cos() - slenderness.cos());
    let exact = (2.0 * fall / (4.0 / 3.0)).sqrt() / radius * 1e3;
    let fastest = recording.rows.iter().map(|row| row.probes[1]);
    let fastest = fastest.fold(0.0, f64::max);
    // The last increment before the impact ends up to 4 ms early, 1.5 % of the velocity.
    assert!(
        fastest < 1.003 * exact && fastest > 0.98 * exact,
        "{fastest} mm/s of {exact} mm/s"
    );
    assert!(imbalance(&recording) < 5e-3);
}

/// Lengths of all edges of a body, while a block falls over: no strain adds up, however far it turns.
#[test]
fn a_body_keeps_its_shape_while_it_falls_over() {
    // Released beyond the angle at which it falls.
    let text = rocking()
        .replace("5.65496 deg", "14 deg")
        .replace("duration = \"0.45 s\"", "duration = \"1.2 s\"");
    let (model, _) = Model::from_deck(&parsed(&text)).unwrap();
    let (recording, _) = run(&model);
    let frame = recording.frames.last().unwrap();
    let block = model
        .mesh
        .names
        .iter()
        .position(|name| name == "block")
        .unwrap();
    let elements = 0..model.mesh.elements.len();
    let element = elements
        .rev()
        .find(|e| model.mesh.unit[*e] as usize == block)
        .unwrap();
    let nodes = model.mesh.elements[element];
    let (mut most, mut turned) = (0.0_f64, 0.0_f64);
    for a in nodes.map(|n| n as usize) {
        for b in nodes.map(|n| n as usize) {
            let rest = [0, 1, 2].map(|i| model.mesh.nodes[a][i] - model.mesh.nodes[b][i]);
            let now =
                [0, 1, 2].map(|i| rest[i] + frame.displacement[a][i] - frame.displacement[b][i]);
            let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            most = most.max((length(now) - length(rest)).abs());
            let cosine = (0..3).map(|i| rest[i] * now[i]).sum::<f64>() / length(rest).powi(2);
            turned = turned.max(1.0 - cosine);
        }
    }
    assert!(most < 1e-9, "{most:e} mm");
    assert!(
        turned > 0.3,
        "turned by {:.0} degrees only",
        (1.0 - turned).acos().to_degrees()
    );
}

/// Units of one element through the thickness lie across its middle plane, and so do headers; the joint between two
/// leaves lies in it.
#[test]
fn halves_of_rigid_walls_have_the_forces_of_the_whole() {
    // The stones of two leaves stick and slip, from 0.08 mm on in another sequence with other increments.
    for (leaf, bond, drive) in [
        ("100 mm", "stretcher", 4.0),
        ("210 mm", "stretcher", 4.0),
        ("100 mm", "english", 0.05),
    ] {
        let text = format!(
            r#"
[contact]
points = "corner"
[wall]
unit = ["200 mm", "{leaf}", "100 mm"]
bed_joint = 0
head_joint = 0
length = "600 mm"
courses = 5
bond = "{bond}"
unit_material = "stone"
interface = "dry"
rigid = true
[[steps]]
kind = "gravity"
[[steps]]
kind = "preload"
top_pressure = "0.3 MPa"
[[steps]]
kind = "drive"
direction = "x"
displacement = {drive}
vertical = "free"
increments = {{ initial = 0.05, max = 0.05 }}
tolerance = {{ residual = 1e-5 }}
"#
        );
        let (mut model, _) = Model::from_deck(&parsed(&format!("{STONES}{text}"))).unwrap();
        let mut forces = Vec::new();
        for fidelity in [Fidelity::Auto, Fidelity::Full] {
            model.fidelity = fidelity;
            let (recording, summary) = run(&model);
            assert_eq!(summary.status, Status::Completed, "{}", summary.message);
            assert_eq!(
                summary.mirror_planes.len(),
                usize::from(fidelity == Fidelity::Auto)
            );
            let rows = recording.rows.iter();
            forces.push(rows.map(|row| row.force_kN).fold(0.0, f64::max));
        }
        let apart = (forces[0] / forces[1] - 1.0).abs();
        assert!(apart < 1e-4, "{leaf}: {forces:?}");
    }
}

/// Stone on stone on ground, pushed at the top. Sections lie in the joint and in the lower stone, which therefore stays a
/// solid.
#[test]
fn sections_of_rigid_stones_balance_the_loads() {
    let text = r#"
[[blocks]]
name = "lower"
size = [100, 50, 200]
mesh = [1, 1, 4]
material = "stone"
rigid = true
[[blocks]]
name = "upper"
size = [100, 50, 200]
at = [0, 0, 200]
material = "stone"
rigid = true
[[contacts]]
slave = "upper.bottom"
master = "lower.top"
interface = "dry"
[[supports]]
on = "lower.bottom"
[[sections]]
name = "joint"
through = [0, 0, 200]
[[sections]]
name = "stone"
through = [0, 0, 100]
[[steps]]
kind = "load"
procedure = "static"
tolerance = { residual = 1e-6 }
[[steps.loads]]
name = "push"
on = "upper.top"
traction = ["0.002 MPa", 0, "-0.04 MPa"]
"#;
    let (model, _) = Model::from_deck(&parsed(&format!("{STONES}{text}"))).unwrap();
    let (recording, summary) = run(&model);
    assert_eq!(summary.status, Status::Completed, "{}", summary.message);
    let columns = model.columns();
    let last = recording.rows.last().unwrap();
    let value = |name: &str| {
        let at = columns.iter().position(|column| column == name).unwrap();
        last.probes[at]
    };
    for (name, height) in [("joint", 0.2), ("stone", 0.3)] {
        // Tractions on 100 x 50 mm²; the top moves by hundredths of a millimetre, which the vertical force adds.
        for (column, exact) in [("N_kN", -0.2), ("Vx_kN", 0.01), ("My_kNm", 0.01 * height)] {
            let found = value(&format!("{name}_{column}"));
            let error = (found / exact - 1.0).abs();
            assert!(error < 5e-3, "{name} {column}: {found} {exact}");
        }
    }
}
