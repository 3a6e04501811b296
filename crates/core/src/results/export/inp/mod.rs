//! `model.inp`: the model for Abaqus with nodes, elements, sets, materials, surfaces, contact and steps. Parts that
//! Abaqus cannot express are comments, above all the bond of the interfaces.

mod contact;
mod materials;
mod steps;

use std::fmt::Write as _;

use crate::model::{Mesh, Model};

/// Largest number of entries per line in Abaqus.
const A_LINE: usize = 16;

/// The model as an input file in N, mm, MPa, tonne, s. Nodes and elements are numbered from 1.
pub fn inp(model: &Model) -> String {
    let mut text = String::new();
    let written = write(&mut text, model);
    debug_assert!(written.is_ok(), "writing to a string does not fail");
    text
}

fn write(text: &mut String, model: &Model) -> std::fmt::Result {
    writeln!(text, "*HEADING\n{}", one_line(&model.title))?;
    writeln!(
        text,
        "** Written by wythe {}. Units: N, mm, MPa, tonne, s.",
        env!("CARGO_PKG_VERSION")
    )?;
    writeln!(
        text,
        "** Sets: UNIT_, MATERIAL_, SUPPORT_, BEAM_. Comments say what is not translated."
    )?;
    mesh(text, &model.mesh)?;
    let names = Names {
        materials: labels(model.materials.iter().map(|m| m.name.as_str())),
        supports: labels(model.supports.iter().map(|s| s.name.as_str())),
        beams: labels(model.beams.iter().map(|b| b.name.as_str())),
    };
    sets(text, model, &names)?;
    for (m, (material, name)) in model.materials.iter().zip(&names.materials).enumerate() {
        if model.mesh.material.iter().any(|&of| usize::from(of) == m) {
            writeln!(
                text,
                "*SOLID SECTION, ELSET=MATERIAL_{name}, MATERIAL={name}"
            )?;
        }
        materials::material(text, name, &material.parameters)?;
    }
    contact::contact(text, model)?;
    steps::steps(text, model, &names)
}

/// Labels in Abaqus, in the order of the model.
struct Names {
    materials: Vec<String>,
    supports: Vec<String>,
    beams: Vec<String>,
}

/// Writes nodes and elements.
fn mesh(text: &mut String, mesh: &Mesh) -> std::fmt::Result {
    writeln!(text, "*NODE, NSET=ALL_NODES")?;
    for (n, [x, y, z]) in mesh.nodes.iter().enumerate() {
        writeln!(text, "{}, {x:?}, {y:?}, {z:?}", n + 1)?;
    }
    writeln!(
        text,
        "** C3D8I has incompatible modes, as wythe's elements have by default."
    )?;
    writeln!(text, "*ELEMENT, TYPE=C3D8, ELSET=ALL_ELEMENTS")?;
    for (e, nodes) in mesh.elements.iter().enumerate() {
        let nodes: Vec<String> = nodes.iter().map(|n| (n + 1).to_string()).collect();
        writeln!(text, "{}, {}", e + 1, nodes.join(", "))?;
    }
    Ok(())
}

/// Writes the sets of units, materials, supports and beams.
fn sets(text: &mut String, model: &Model, names: &Names) -> std::fmt::Result {
    let mesh = &model.mesh;
    let units = mesh.unit.iter().max().map_or(0, |last| *last as usize + 1);
    let mut of_unit = vec![Vec::new(); units];
    for (e, unit) in mesh.unit.iter().enumerate() {
        of_unit[*unit as usize].push(e);
    }
    for (unit, elements) in of_unit.into_iter().enumerate() {
        let name = format!("UNIT_{unit}");
        set(text, "ELSET", &name, elements.into_iter())?;
    }
    for (m, name) in names.materials.iter().enumerate() {
        let of = (0..mesh.elements.len()).filter(|&e| usize::from(mesh.material[e]) == m);
        set(text, "ELSET", &format!("MATERIAL_{name}"), of)?;
    }
    let node = |&n: &u32| n as usize;
    for (support, name) in model.supports.iter().zip(&names.supports) {
        let name = format!("SUPPORT_{name}");
        set(text, "NSET", &name, support.nodes.iter().map(node))?;
    }
    for (beam, name) in model.beams.iter().zip(&names.beams) {
        let name = format!("BEAM_{name}");
        set(text, "NSET", &name, beam.nodes.iter().map(node))?;
    }
    Ok(())
}

/// Writes a set of nodes or elements, numbered from 1; an empty set is omitted.
fn set(
    text: &mut String,
    kind: &str,
    name: &str,
    members: impl Iterator<Item = usize>,
) -> std::fmt::Result {
    let members: Vec<String> = members.map(|m| (m + 1).to_string()).collect();
    if members.is_empty() {
        return Ok(());
    }
    writeln!(text, "*{kind}, {kind}={name}")?;
    for line in members.chunks(A_LINE) {
        writeln!(text, "{}", line.join(", "))?;
    }
    Ok(())
}

/// Valid labels for Abaqus: at most 60 capital letters, digits and underscores, each label unique.
fn labels<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut labels: Vec<String> = Vec::new();
    for name in names {
        let allowed = |c: char| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_uppercase()
            } else {
                '_'
            }
        };
        let label: String = name.chars().take(60).map(allowed).collect();
        let taken = |label: &String| labels.contains(label);
        let label = if taken(&label) || label.is_empty() {
            format!("{label}_{}", labels.len())
        } else {
            label
        };
        labels.push(label);
    }
    labels
}

fn one_line(title: &str) -> String {
    // The heading must not begin as a comment or keyword.
    title
        .replace(['\n', '\r'], " ")
        .trim_start_matches('*')
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::Deck;

    const WALL: &str = include_str!("../../../../../../examples/03_shear_wall_j7d.toml");

    #[test]
    fn a_wall_has_its_nodes_sets_and_tables() {
        let short = [("wall.courses".to_owned(), "4".to_owned())];
        let deck = Deck::from_str_with(WALL, "wall.toml", &short).unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let text = inp(&model);
        let after = |keyword: &str| {
            let at = text.find(keyword).unwrap_or_else(|| panic!("{keyword}"));
            text[at..]
                .lines()
                .skip(1)
                .take_while(|l| !l.starts_with('*'))
                .collect::<Vec<_>>()
        };
        assert_eq!(after("*NODE").len(), model.mesh.nodes.len());
        let elements = after("*ELEMENT, TYPE=C3D8");
        assert_eq!(elements.len(), model.mesh.elements.len());
        assert_eq!(elements[0].split(", ").count(), 9);
        let in_units: usize = text
            .lines()
            .filter(|l| l.starts_with("*ELSET, ELSET=UNIT_"))
            .count();
        assert_eq!(
            in_units,
            model.mesh.unit.iter().max().map_or(0, |u| *u as usize + 1)
        );
        assert_eq!(after("*ELASTIC")[0], "16700.0, 0.15");
        let tension = after("*CONCRETE TENSION STIFFENING");
        assert_eq!(tension.len(), deck.materials["brick"].tension.len());
        assert!(text.contains("*SOLID SECTION, ELSET=MATERIAL_BRICK, MATERIAL=BRICK"));
        assert!(text.contains("*NSET, NSET=BEAM_TOP"));
        let held = after("*BOUNDARY");
        assert!(held.len() >= 3 && held[0].ends_with(", 1, 1"), "{held:?}");
    }

    #[test]
    fn labels_are_plain_and_unique() {
        let found = labels(["brick (red)", "BRICK_RED_", "a/b"].into_iter());
        assert_eq!(found, ["BRICK__RED_", "BRICK_RED_", "A_B"]);
        assert_eq!(labels(["a b", "a-b"].into_iter()), ["A_B", "A_B_1"]);
    }
}
