//! `frame_0007.vtu`: the XML format of VTK for unstructured grids, for readers without VTKHDF.
//!
//! Numbers are little-endian in base64 without compression; the size of each array precedes it as UInt64. Fields have
//! the names of `results.vtkhdf`. Positions are those at rest; the field `displacement` warps them.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write as _;

use crate::model::{Mesh, Model};
use crate::results::Snapshot;
use crate::state::OutputField;

/// VTK numbers of cell types.
const HEXAHEDRON: u8 = 12;
const QUAD: u8 = 9;

/// Solids at a frame.
pub fn solids(snapshot: &Snapshot) -> String {
    let (mesh, frame) = (&snapshot.mesh, &snapshot.frame);
    let mut xml = Xml::begin(mesh.nodes.len(), mesh.elements.len(), frame.time);
    xml.open("PointData");
    xml.reals("displacement", 3, frame.displacement.as_flattened());
    if !frame.velocity.is_empty() {
        xml.reals("velocity", 3, frame.velocity.as_flattened());
    }
    xml.close("PointData");
    xml.open("CellData");
    xml.reals("stress", 6, frame.stress.as_flattened());
    xml.reals(
        "principal_stress",
        3,
        frame.principal_stresses().as_flattened(),
    );
    xml.reals("plastic_strain", 6, frame.plastic_strain.as_flattened());
    xml.reals("tensile_damage", 1, &frame.tensile_damage);
    xml.reals("compressive_damage", 1, &frame.compressive_damage);
    xml.reals("crack_width", 1, &frame.crack_width);
    for output in &frame.outputs {
        xml.reals(&output.name, 1, &output.values);
    }
    xml.small("yielded", frame.yielded.iter().map(|&y| u8::from(y)));
    xml.end_of_solids(mesh)
}

/// Solids of a model at rest, with the labels of the elements.
pub fn model(model: &Model) -> String {
    let mesh = &model.mesh;
    let mut xml = Xml::begin(mesh.nodes.len(), mesh.elements.len(), 0.0);
    xml.open("PointData");
    // Bits 1, 2 and 4: fixed in x, y and z.
    let mut held = vec![0_u8; mesh.nodes.len()];
    for support in &model.supports {
        for n in &support.nodes {
            for (d, fixed) in support.fixed.iter().enumerate() {
                held[*n as usize] |= u8::from(*fixed) << d;
            }
        }
    }
    xml.small("support", held.into_iter());
    // 0 without a beam, otherwise the number of the beam from 1.
    let mut beam_of = vec![0_i64; mesh.nodes.len()];
    for (b, beam) in model.beams.iter().enumerate() {
        for n in &beam.nodes {
            beam_of[*n as usize] = b as i64 + 1;
        }
    }
    xml.whole("beam", beam_of.into_iter());
    xml.close("PointData");
    xml.open("CellData");
    xml.end_of_solids(mesh)
}

/// Contact facets, slaves first, with their law (-1 for a master) and body.
pub fn surfaces(model: &Model) -> String {
    let (mesh, contact) = (&model.mesh, &model.contact);
    let masters = &contact.master_facets;
    let slaves: Vec<(usize, &[u32; 4])> = contact.whole_slaves().collect();
    let facets = slaves.iter().map(|(_, facet)| **facet);
    let facets: Vec<[u32; 4]> = facets.chain(masters.iter().copied()).collect();
    let mut xml = Xml::begin(mesh.nodes.len(), facets.len(), 0.0);
    xml.open("CellData");
    let of_slaves = slaves.iter().map(|(f, _)| i64::from(contact.slave_law[*f]));
    let of_masters = std::iter::repeat_n(-1, masters.len());
    xml.whole("law", of_slaves.chain(of_masters));
    let bodies = slaves.iter().map(|(f, _)| &contact.slave_body[*f]);
    let bodies = bodies.chain(&contact.master_body);
    xml.whole("unit", bodies.map(|&b| i64::from(b)));
    xml.close("CellData");
    xml.cells(&mesh.nodes, facets.as_flattened(), 4, QUAD);
    xml.end()
}

/// Interfaces at a frame: a quad around each contact point.
pub fn interfaces(snapshot: &Snapshot) -> String {
    let (surface, of) = (&snapshot.surface, &snapshot.frame.interfaces);
    let mut xml = Xml::begin(
        surface.points.len(),
        surface.quads.len(),
        snapshot.frame.time,
    );
    xml.open("PointData");
    xml.reals(
        "displacement",
        3,
        snapshot.surface_displacement.as_flattened(),
    );
    xml.close("PointData");
    xml.open("CellData");
    xml.reals("opening", 1, &of.opening);
    xml.reals("slip", 2, of.slip.as_flattened());
    xml.reals("traction", 3, of.traction.as_flattened());
    xml.reals("damage", 1, &of.damage);
    xml.small("state", of.state.iter().map(|&s| s as u8));
    for OutputField { name, values } in &of.outputs {
        xml.reals(name, 1, values);
    }
    xml.close("CellData");
    xml.cells(&surface.points, surface.quads.as_flattened(), 4, QUAD);
    xml.end()
}

/// `NAME.pvd`: a time series of frame files for ParaView. `files` lists times [s] and names of files in the same
/// folder.
pub fn collection(files: &[(f64, String)]) -> String {
    let mut text = String::from("<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
    for (time, file) in files {
        text += &format!("<DataSet timestep=\"{time:?}\" part=\"0\" file=\"{file}\"/>\n");
    }
    text + "</Collection>\n</VTKFile>\n"
}

/// The text written so far.
struct Xml(String);

impl Xml {
    /// Labels and corners of the elements, and the end of the file.
    fn end_of_solids(mut self, mesh: &Mesh) -> String {
        self.whole("material", mesh.material.iter().map(|&m| i64::from(m)));
        self.whole("unit", mesh.unit.iter().map(|&u| i64::from(u)));
        self.whole("course", mesh.course.iter().map(|&c| i64::from(c)));
        self.close("CellData");
        self.cells(&mesh.nodes, mesh.elements.as_flattened(), 8, HEXAHEDRON);
        self.end()
    }

    fn begin(points: usize, cells: usize, time: f64) -> Self {
        let mut xml = Self(String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n",
        ));
        xml.field(
            "Float64",
            "TimeValue",
            "NumberOfTuples=\"1\"",
            &time.to_le_bytes(),
        );
        xml.0 += "</FieldData>\n";
        xml.0 += &format!("<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n");
        xml
    }

    fn open(&mut self, tag: &str) {
        self.0 += &format!("<{tag}>\n");
    }

    fn close(&mut self, tag: &str) {
        self.0 += &format!("</{tag}>\n");
    }

    /// Adds an array of bytes; `shape` is a further attribute.
    fn field(&mut self, kind: &str, name: &str, shape: &str, bytes: &[u8]) {
        let written = writeln!(
            self.0,
            "<DataArray type=\"{kind}\" Name=\"{name}\" {shape} format=\"binary\">"
        );
        debug_assert!(written.is_ok(), "writing to a string does not fail");
        let count = (bytes.len() as u64).to_le_bytes();
        let all: Vec<u8> = count.iter().chain(bytes).copied().collect();
        STANDARD.encode_string(all, &mut self.0);
        self.0 += "\n</DataArray>\n";
    }

    fn reals(&mut self, name: &str, components: usize, values: &[f64]) {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.field("Float64", name, &of(components), &bytes);
    }

    fn whole(&mut self, name: &str, values: impl Iterator<Item = i64>) {
        let bytes: Vec<u8> = values.flat_map(i64::to_le_bytes).collect();
        self.field("Int64", name, &of(1), &bytes);
    }

    fn small(&mut self, name: &str, values: impl Iterator<Item = u8>) {
        self.field("UInt8", name, &of(1), &values.collect::<Vec<u8>>());
    }

    fn cells(&mut self, points: &[[f64; 3]], nodes: &[u32], corners: usize, kind: u8) {
        let count = nodes.len() / corners;
        self.open("Points");
        self.reals("Points", 3, points.as_flattened());
        self.close("Points");
        self.open("Cells");
        self.whole("connectivity", nodes.iter().map(|&n| i64::from(n)));
        self.whole("offsets", (1..=count).map(|i| (corners * i) as i64));
        self.small("types", std::iter::repeat_n(kind, count));
        self.close("Cells");
    }

    fn end(mut self) -> String {
        self.0 += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
        self.0
    }
}

fn of(components: usize) -> String {
    format!("NumberOfComponents=\"{components}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exported_model_has_groups_of_elements_and_contact_faces() {
        let mut fake = crate::results::fake::model();
        let text = model(&fake);
        for name in ["material", "unit", "course", "support", "beam"] {
            assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
        }
        fake.contact.slave_facets = vec![[4, 5, 6, 7]];
        (fake.contact.slave_body, fake.contact.slave_law) = (vec![0], vec![0]);
        let text = surfaces(&fake);
        let masters = fake.contact.master_facets.len();
        assert!(
            text.contains(&format!("NumberOfCells=\"{}\"", 1 + masters)),
            "{text}"
        );
    }

    #[test]
    fn every_field_is_there_with_its_length() {
        let model = crate::results::fake::model();
        let snapshot = Snapshot {
            mesh: model.mesh.clone(),
            frame: crate::results::fake::frame(&model, 1.0),
            ..Snapshot::default()
        };
        let text = solids(&snapshot);
        assert!(text.contains("NumberOfPoints=\"16\" NumberOfCells=\"2\""));
        for name in [
            "TimeValue",
            "displacement",
            "principal_stress",
            "crack_width",
            "unit",
        ] {
            assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
        }
        assert!(!text.contains("velocity"));
        // 8 bytes of size and 2 numbers: 24 bytes, 32 characters.
        let at = text.find("Name=\"crack_width\"").unwrap();
        assert_eq!(text[at..].lines().nth(1).map(str::len), Some(32));
        assert!(collection(&[(0.5, "a.vtu".to_owned())]).contains("timestep=\"0.5\""));
    }
}
