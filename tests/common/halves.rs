//! A wall that `auto` solves as a half, its solution in full and with `auto`, and the difference between both.

use wythe::model::Model;
use wythe::state::HistoryRow;

use super::blocks::deck_and_model;
use super::scene::{Recording, completed};

/// Two courses of a wall with many kinds of load and damage, symmetric about y = 30 mm.
pub const WALL: &str = r#"format = 1
[materials.brick]
E = "10 GPa"
nu = 0.2
density = "1800 kg/m^3"
tension = [[3.0, 0, 0], [0.3, 0.004, 0.9]]
compression = [[11.0, 0, 0], [11.5, 0.001, 0], [0.6, 0.02, 0.9]]
reference_length = "50 mm"
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
[contact]
search_radius = "5 mm"
parts = [1, 1, 1]
[wall]
unit = [200, 60, 50]
length = 300
courses = 3
bed_joint = 0
head_joint = 0
unit_material = "brick"
interface = "joint"
mesh = [4, 2, 2]
clamped = false
[[supports]]
on = "wall.bottom"
[[probes]]
name = "front"
near = [300, 0, 150]
direction = "x"
[[probes]]
name = "back"
near = [300, 60, 100]
direction = "x"
[[probes]]
name = "swells"
near = [0, 60, 75]
direction = "y"
[[probes]]
name = "side"
on = "wall.right"
direction = "z"
"#;

/// The full solution, then the one with `auto`.
pub fn both(text: &str) -> [(Model, Recording); 2] {
    ["full", "auto"].map(|fidelity| {
        let text = text.replacen(
            "format = 1\n",
            &format!("format = 1\nfidelity = \"{fidelity}\"\n"),
            1,
        );
        let (_, mut model) = deck_and_model(&text);
        model.output.every = 1;
        let recording = completed(&model);
        (model, recording)
    })
}

/// Largest difference of two lists of numbers divided by the largest number.
pub fn apart(a: impl IntoIterator<Item = f64>, b: impl IntoIterator<Item = f64>) -> f64 {
    let (a, b): (Vec<f64>, Vec<f64>) = (a.into_iter().collect(), b.into_iter().collect());
    assert_eq!(a.len(), b.len());
    let size = a.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    let differences = a.iter().zip(&b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max) / size
}

/// The entries of a row that are quantities of the scene and do not depend on the method of solution.
pub fn quantities(row: &HistoryRow) -> Vec<f64> {
    vec![
        row.displacement_mm,
        row.force_kN,
        row.reaction_kN,
        row.external_work_J,
        row.elastic_energy_J,
        row.plastic_damage_dissipation_J,
        row.interface_dissipation_J,
        row.max_interface_damage,
        row.max_tensile_damage,
        row.contact_area_mm2,
        row.kinetic_energy_J,
    ]
}
