//! CSV files with nodes, elements and interfaces of a frame; names and units as in `results.vtkhdf`.

use std::fmt::Write as _;

use crate::results::Snapshot;
use crate::state::{InterfaceState, OutputField};

/// Components of symmetric tensors.
const TENSOR: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// One row per node: position at rest and displacement [mm].
pub fn nodes(snapshot: &Snapshot) -> String {
    let mut text = String::from("node,x_mm,y_mm,z_mm,u_x_mm,u_y_mm,u_z_mm\n");
    let rows = snapshot.mesh.nodes.iter().zip(&snapshot.frame.displacement);
    for (n, (x, u)) in rows.enumerate() {
        row(&mut text, n, &[], &[x, u]);
    }
    text
}

/// One row per element: labels, nodes and fields [MPa, -, mm].
pub fn elements(snapshot: &Snapshot) -> String {
    let (mesh, frame) = (&snapshot.mesh, &snapshot.frame);
    let mut header = String::from("element,material,unit,course");
    header.extend((0..8).map(|i| format!(",node_{i}")));
    for field in ["stress", "plastic_strain"] {
        let unit = if field == "stress" { "_MPa" } else { "" };
        header.extend(TENSOR.map(|c| format!(",{field}_{c}{unit}")));
    }
    header += ",tensile_damage,compressive_damage,crack_width_mm,yielded";
    header.extend(frame.outputs.iter().map(|of| format!(",{}", of.name)));
    header.push('\n');
    let mut text = header;
    for e in 0..mesh.elements.len() {
        let name = &snapshot.materials[usize::from(mesh.material[e])];
        let mut labels = vec![
            quoted(name),
            mesh.unit[e].to_string(),
            mesh.course[e].to_string(),
        ];
        labels.extend(mesh.elements[e].map(|n| n.to_string()));
        let outputs: Vec<f64> = frame.outputs.iter().map(|of| of.values[e]).collect();
        let last = [
            frame.tensile_damage[e],
            frame.compressive_damage[e],
            frame.crack_width[e],
            f64::from(u8::from(frame.yielded[e])),
        ];
        row(
            &mut text,
            e,
            &labels,
            &[&frame.stress[e], &frame.plastic_strain[e], &last, &outputs],
        );
    }
    text
}

/// One row per contact point: centre of its quad at rest, opening and slip [mm], traction [MPa].
pub fn interfaces(snapshot: &Snapshot) -> String {
    let (surface, of) = (&snapshot.surface, &snapshot.frame.interfaces);
    let mut text = String::from(
        "point,state,x_mm,y_mm,z_mm,opening_mm,slip_1_mm,slip_2_mm,traction_n_MPa,traction_1_MPa,\
         traction_2_MPa,damage",
    );
    for OutputField { name, .. } in &of.outputs {
        text += ",";
        text += &quoted(name);
    }
    text += "\n";
    for (p, quad) in surface.quads.iter().enumerate() {
        let corner = |i: usize| {
            quad.map(|n| surface.points[n as usize][i])
                .iter()
                .sum::<f64>()
        };
        let middle = [0, 1, 2].map(|i| 0.25 * corner(i));
        let state = match of.state[p] {
            InterfaceState::Intact => "intact",
            InterfaceState::Softening => "softening",
            InterfaceState::FailedOpen => "failed_open",
            InterfaceState::FailedSliding => "failed_sliding",
        };
        let (opening, damage) = ([of.opening[p]], [of.damage[p]]);
        let further: Vec<f64> = of.outputs.iter().map(|output| output.values[p]).collect();
        let numbers: [&[f64]; 6] = [
            &middle,
            &opening,
            &of.slip[p],
            &of.traction[p],
            &damage,
            &further,
        ];
        row(&mut text, p, &[state.to_owned()], &numbers);
    }
    text
}

/// Writes a row. Numbers are the shortest decimals that read back to the same bits.
fn row(text: &mut String, index: usize, labels: &[String], numbers: &[&[f64]]) {
    let labels = labels.iter().map(|label| format!(",{label}"));
    let numbers = numbers
        .iter()
        .flat_map(|n| n.iter())
        .map(|v| format!(",{v:?}"));
    let cells: String = labels.chain(numbers).collect();
    let written = writeln!(text, "{index}{cells}");
    debug_assert!(written.is_ok(), "writing to a string does not fail");
}

/// RFC 4180.
fn quoted(name: &str) -> String {
    if name.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    #[test]
    fn rows_have_the_columns_of_their_header() {
        let model = fake::model();
        let snapshot = Snapshot {
            materials: vec!["brick, red".to_owned(), "mortar".to_owned()],
            mesh: model.mesh.clone(),
            frame: fake::frame(&model, 0.5),
            ..Snapshot::default()
        };
        let text = nodes(&snapshot);
        assert_eq!(text.lines().count(), 17);
        assert_eq!(
            text.lines().nth(2),
            Some("1,100.0,0.0,0.0,0.0505,0.0005,0.0005")
        );
        let text = elements(&snapshot);
        let columns: Vec<usize> = csv::Reader::from_reader(text.as_bytes())
            .records()
            .map(|r| r.unwrap().len())
            .collect();
        assert_eq!(columns, [28, 28]);
        assert!(text.contains("\n0,\"brick, red\",0,0,0,1,2,3,4,5,6,7,0.0,0.5,"));
        assert_eq!(interfaces(&snapshot).lines().count(), 1);
    }
}
