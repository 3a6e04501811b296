//! Bodies at rest as closed shells: OBJ, PLY, STL.
//!
//! Each body is the shell of its boundary facets [mm]. Numbers have all their digits, so that `[[blocks]] file` reads
//! the same bodies back.

use std::fmt::Write as _;

use rustc_hash::FxHashMap;

use crate::model::Mesh;
use crate::model::boundary_facets::BoundaryFacets;

/// Boundary facets of a body.
struct Skin {
    name: String,
    vertices: Vec<[f64; 3]>,
    facets: Vec<[usize; 4]>,
}

/// Skins of all bodies. Images beyond planes of symmetry are left as they are.
fn skins(mesh: &Mesh) -> Vec<Skin> {
    let boundary = BoundaryFacets::of(mesh);
    let bodies = boundary.body.chunk_by(|a, b| a == b);
    let mut first = 0;
    let skin = |of: &[u32]| {
        let facets = &boundary.facets[first..first + of.len()];
        first += of.len();
        let mut number: FxHashMap<u32, usize> = FxHashMap::default();
        let mut vertices = Vec::new();
        let mut own = |n: u32| {
            *number.entry(n).or_insert_with(|| {
                vertices.push(mesh.nodes[n as usize]);
                vertices.len() - 1
            })
        };
        let facets = facets.iter().map(|facet| facet.map(&mut own)).collect();
        Skin {
            name: mesh.called(of[0]),
            vertices,
            facets,
        }
    };
    bodies.map(skin).collect()
}

/// Wavefront OBJ: an object of quadrilaterals for each body.
pub fn obj(mesh: &Mesh) -> String {
    let mut text = "# closed shells, mm\n".to_owned();
    let mut first = 1;
    for skin in skins(mesh) {
        let _ = writeln!(text, "o {}", skin.name);
        for [x, y, z] in &skin.vertices {
            let _ = writeln!(text, "v {x} {y} {z}");
        }
        for facet in &skin.facets {
            let [a, b, c, d] = facet.map(|n| first + n);
            let _ = writeln!(text, "f {a} {b} {c} {d}");
        }
        first += skin.vertices.len();
    }
    text
}

/// PLY in ASCII: quadrilaterals of all bodies, whose names are comments.
pub fn ply(mesh: &Mesh) -> String {
    let skins = skins(mesh);
    let mut text = "ply\nformat ascii 1.0\ncomment closed shells, mm\n".to_owned();
    for skin in &skins {
        let _ = writeln!(text, "comment {}: {} faces", skin.name, skin.facets.len());
    }
    let vertices: usize = skins.iter().map(|skin| skin.vertices.len()).sum();
    let faces: usize = skins.iter().map(|skin| skin.facets.len()).sum();
    let _ = writeln!(
        text,
        "element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z"
    );
    let _ = writeln!(
        text,
        "element face {faces}\nproperty list uchar int vertex_indices\nend_header"
    );
    for [x, y, z] in skins.iter().flat_map(|skin| &skin.vertices) {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    let mut first = 0;
    for skin in &skins {
        for facet in &skin.facets {
            let [a, b, c, d] = facet.map(|n| first + n);
            let _ = writeln!(text, "4 {a} {b} {c} {d}");
        }
        first += skin.vertices.len();
    }
    text
}

/// STL in ASCII: a solid of triangles for each body, two for each facet.
pub fn stl(mesh: &Mesh) -> String {
    let mut text = String::new();
    for skin in skins(mesh) {
        let _ = writeln!(text, "solid {}", skin.name);
        for [a, b, c, d] in &skin.facets {
            for corners in [[a, b, c], [a, c, d]] {
                // Readers find the normal from the sense of rotation.
                text.push_str("facet normal 0 0 0\nouter loop\n");
                for n in corners {
                    let [x, y, z] = skin.vertices[*n];
                    let _ = writeln!(text, "vertex {x} {y} {z}");
                }
                text.push_str("endloop\nendfacet\n");
            }
        }
        let _ = writeln!(text, "endsolid {}", skin.name);
    }
    text
}
