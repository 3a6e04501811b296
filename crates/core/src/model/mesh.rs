//! Nodes and hex8 elements.

/// A mesh of hex8 elements. x runs along the wall's length, y through its thickness, z upwards.
///
/// Node order of an element: (−,−,−) (+,−,−) (+,+,−) (−,+,−), then the same four at +ζ:
/// VTK's hexahedron.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Reference coordinates [mm]. `[node][xyz]`
    pub nodes: Vec<[f64; 3]>,
    /// Connectivity. `[element][local node]`
    pub elements: Vec<[u32; 8]>,
    /// Index into [`Model::materials`](super::Model::materials). `[element]`
    pub material: Vec<u16>,
    /// Which body (representative element, or unit) an element belongs to. `[element]`
    pub unit: Vec<u32>,
    /// Course of the unit, from 0 at the bottom. `[element]`
    pub course: Vec<u16>,
}

impl Mesh {
    /// Coordinates of the eight nodes of element `e` [mm].
    pub fn corners(&self, e: usize) -> [[f64; 3]; 8] {
        self.elements[e].map(|n| self.nodes[n as usize])
    }
}
