//! A wall of representative elements as hex8: each a block of its own nodes, cut like this,
//!
//! ```text
//!  z  ┌────┬────┬────┬────┬──┐  bed joint (mortar) and, over the head joint, the corner
//!  │  ├────┼────┼────┼────┼──┤
//!  │  │  unit   │    │    │  │  head joint (mortar)
//!  └x └────┴────┴────┴────┴──┘
//! ```
//!
//! and joined to its neighbours by contact. The mortar side is the slave (top of bed joints, +x face
//! of head joints and corners), the sides that face it are masters.

use super::Mesh;
use super::deck::{Interface, Subdivision, Wall};
use super::joint::{Side, law_between};
use super::layout::Slot;
use super::scene::{Beam, ContactSurfaces, Support};
use crate::material::ElasticParameters;

/// Index of the unit material in the model.
pub const UNIT: u16 = 0;
/// Index of the mortar in the model.
pub const MORTAR: u16 = 1;

/// Corners of an element's face, counter-clockwise seen from outside.
const TOP: [usize; 4] = [4, 5, 6, 7];
const BOTTOM: [usize; 4] = [0, 3, 2, 1];
const RIGHT: [usize; 4] = [1, 2, 6, 5];
const LEFT: [usize; 4] = [0, 4, 7, 3];

/// What a wall gives to the model.
#[derive(Clone, Debug, Default)]
pub struct WallParts {
    /// The solids.
    pub mesh: Mesh,
    /// Interfaces between representative elements.
    pub contact: ContactSurfaces,
    /// Body that each slave facet faces (the larger part of it). `[facet]`
    pub facing_body: Vec<u32>,
    /// Held nodes.
    pub supports: Vec<Support>,
    /// The level beam at the top.
    pub beams: Vec<Beam>,
    /// Bodies touched by a support or a beam. `[body]`
    pub held: Vec<bool>,
}

/// One representative element: grid planes in x, y, z, and where its mortar begins.
struct Block {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    /// Elements of the unit along x; those beyond are the head joint.
    unit_x: usize,
    /// Elements of the unit along z; those beyond are the bed joint.
    unit_z: usize,
}

impl Block {
    /// A block over `slot`, from `bottom`; with a bed joint if `top` lies above the unit.
    fn new(slot: &Slot, bottom: f64, top: Option<f64>, wall: &Wall) -> Self {
        let [length, thickness, height] = wall.unit.map(super::quantity::Length::get);
        let unit_x = unit_elements(slot, length, wall.mesh);
        let unit_z = wall.mesh.height as usize - 1;
        let mut x = planes(slot.start, slot.start + slot.length, unit_x);
        if slot.head_joint > 0.0 {
            x.push(slot.start + (slot.length + slot.head_joint));
        }
        let mut z = planes(bottom, bottom + height, unit_z);
        z.extend(top);
        Self {
            x,
            y: planes(0.0, thickness, wall.mesh.thickness as usize),
            z,
            unit_x,
            unit_z,
        }
    }

    /// Elements along x, y, z.
    fn counts(&self) -> [usize; 3] {
        [self.x.len() - 1, self.y.len() - 1, self.z.len() - 1]
    }

    /// Local number of the node on planes i, j, k.
    fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (k * self.y.len() + j) * self.x.len() + i
    }

    /// Local number of the element i, j, k.
    fn element(&self, i: usize, j: usize, k: usize) -> usize {
        let [nx, ny, _] = self.counts();
        (k * ny + j) * nx + i
    }

    fn is_mortar(&self, i: usize, k: usize) -> bool {
        i >= self.unit_x || k >= self.unit_z
    }

    fn append(&self, mesh: &mut Mesh, unit: u32, course: u16) {
        let base = mesh.nodes.len();
        for &z in &self.z {
            for &y in &self.y {
                mesh.nodes.extend(self.x.iter().map(|&x| [x, y, z]));
            }
        }
        let [nx, ny, nz] = self.counts();
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    let n = |a, b, c| (base + self.node(i + a, j + b, k + c)) as u32;
                    mesh.elements.push([
                        n(0, 0, 0),
                        n(1, 0, 0),
                        n(1, 1, 0),
                        n(0, 1, 0),
                        n(0, 0, 1),
                        n(1, 0, 1),
                        n(1, 1, 1),
                        n(0, 1, 1),
                    ]);
                    mesh.material
                        .push(if self.is_mortar(i, k) { MORTAR } else { UNIT });
                    mesh.unit.push(unit);
                    mesh.course.push(course);
                }
            }
        }
    }
}

/// Elements of a unit along x: a bat has its share of them, at least one.
fn unit_elements(slot: &Slot, whole: f64, mesh: Subdivision) -> usize {
    let share = f64::from(mesh.length - 1) * slot.length / whole;
    (share.round() as usize).max(1)
}

/// `n` equal intervals from `a` to `b`; both ends exact.
fn planes(a: f64, b: f64, n: usize) -> Vec<f64> {
    let inner = |i: usize| a + (b - a) * (i as f64 / n as f64);
    (0..=n).map(|i| if i == n { b } else { inner(i) }).collect()
}

/// Builds the wall. `materials` are those of the units and of the mortar.
pub fn build(
    wall: &Wall,
    pattern: &[Vec<Slot>; 2],
    interface: &Interface,
    materials: [&ElasticParameters; 2],
) -> WallParts {
    let courses = wall.courses as usize;
    let rise = wall.unit[2].get() + wall.bed_joint.get();
    let course = |k: usize| -> Vec<Block> {
        let top = (k + 1 < courses).then(|| (k + 1) as f64 * rise);
        pattern[k % 2]
            .iter()
            .map(|slot| Block::new(slot, k as f64 * rise, top, wall))
            .collect()
    };
    let mut builder = Builder::new(wall, interface, materials);
    let mut blocks = course(0);
    for k in 0..courses {
        let above = if k + 1 < courses {
            course(k + 1)
        } else {
            Vec::new()
        };
        builder.course(k, &blocks, &above);
        blocks = above;
    }
    builder.finish()
}

struct Builder<'a> {
    wall: &'a Wall,
    interface: &'a Interface,
    materials: [&'a ElasticParameters; 2],
    parts: WallParts,
    held_nodes: Vec<u32>,
    tied_nodes: Vec<u32>,
}

impl<'a> Builder<'a> {
    fn new(wall: &'a Wall, interface: &'a Interface, m: [&'a ElasticParameters; 2]) -> Self {
        let parts = WallParts::default();
        let (held_nodes, tied_nodes) = (Vec::new(), Vec::new());
        Self {
            wall,
            interface,
            materials: m,
            parts,
            held_nodes,
            tied_nodes,
        }
    }

    fn course(&mut self, k: usize, blocks: &[Block], above: &[Block]) {
        let first = self.parts.held.len();
        for (s, block) in blocks.iter().enumerate() {
            let elements = self.parts.mesh.elements.len();
            let nodes = self.parts.mesh.nodes.len();
            let body = (first + s) as u32;
            block.append(&mut self.parts.mesh, body, k as u16);
            let next = blocks.get(s + 1).map(|b| (b, body + 1));
            self.slaves(
                block,
                elements,
                body,
                next,
                above,
                (first + blocks.len()) as u32,
            );
            self.masters(block, elements, body, k > 0, s > 0);
            self.hold(block, nodes, k);
        }
    }

    /// Top of the bed joint against the course above, +x face of head joint and corner against the
    /// next unit of the course.
    fn slaves(
        &mut self,
        block: &Block,
        base: usize,
        body: u32,
        next: Option<(&Block, u32)>,
        above: &[Block],
        first_above: u32,
    ) {
        let [nx, ny, nz] = block.counts();
        if !above.is_empty() {
            let bed = Side {
                material: self.materials[1],
                size: self.wall.bed_joint.get(),
            };
            for i in 0..nx {
                let (at, column) = column_above(above, block.x[i], block.x[i + 1]);
                let size = above[at].z[1] - above[at].z[0];
                let material = self.materials[usize::from(above[at].is_mortar(column, 0))];
                let law = self.law(bed, Side { material, size });
                for j in 0..ny {
                    let e = base + block.element(i, j, nz - 1);
                    self.slave(e, TOP, body, law, first_above + at as u32);
                }
            }
        }
        if let Some((right, right_body)) = next {
            let head = Side {
                material: self.materials[1],
                size: self.wall.head_joint.get(),
            };
            for k in 0..nz {
                let material = self.materials[usize::from(right.is_mortar(0, k))];
                let law = self.law(
                    head,
                    Side {
                        material,
                        size: right.x[1] - right.x[0],
                    },
                );
                for j in 0..ny {
                    self.slave(
                        base + block.element(nx - 1, j, k),
                        RIGHT,
                        body,
                        law,
                        right_body,
                    );
                }
            }
        }
    }

    fn masters(&mut self, block: &Block, base: usize, body: u32, bottom: bool, left: bool) {
        let [nx, ny, nz] = block.counts();
        if bottom {
            for j in 0..ny {
                for i in 0..nx {
                    self.master(base + block.element(i, j, 0), BOTTOM, body);
                }
            }
        }
        if left {
            for k in 0..nz {
                for j in 0..ny {
                    self.master(base + block.element(0, j, k), LEFT, body);
                }
            }
        }
    }

    fn facet(&self, element: usize, face: [usize; 4]) -> [u32; 4] {
        face.map(|corner| self.parts.mesh.elements[element][corner])
    }

    fn slave(&mut self, element: usize, face: [usize; 4], body: u32, law: u16, facing: u32) {
        let facet = self.facet(element, face);
        self.parts.contact.slave_facets.push(facet);
        self.parts.contact.slave_body.push(body);
        self.parts.contact.slave_law.push(law);
        self.parts.facing_body.push(facing);
    }

    fn master(&mut self, element: usize, face: [usize; 4], body: u32) {
        let facet = self.facet(element, face);
        self.parts.contact.master_facets.push(facet);
        self.parts.contact.master_body.push(body);
    }

    fn law(&mut self, a: Side<'_>, b: Side<'_>) -> u16 {
        let name = &self.wall.interface;
        law_between(&mut self.parts.contact, name, self.interface, a, b)
    }

    /// Notes the nodes of `block` (which begin at `base`) that are held or tied to the beam.
    fn hold(&mut self, block: &Block, base: usize, course: usize) {
        let (bottom, top) = (
            self.wall.clamped.bottom_courses,
            self.wall.clamped.top_courses,
        );
        let courses = self.wall.courses as usize;
        let layer = block.x.len() * block.y.len();
        // Layers of nodes of unit and head joint; the bed joint stays free.
        let unit = (0, block.unit_z + 1);
        let held = match (course, bottom as usize) {
            (0, 0) => (0, 1),
            (k, b) if k < b => unit,
            _ => (0, 0),
        };
        let tied = match (course + 1, top as usize) {
            (k, 0) if k == courses => (block.unit_z, block.unit_z + 1),
            (k, t) if k + t > courses => unit,
            _ => (0, 0),
        };
        let nodes =
            |(from, to): (usize, usize)| (base + from * layer..base + to * layer).map(|n| n as u32);
        self.held_nodes.extend(nodes(held));
        self.tied_nodes.extend(nodes(tied));
        self.parts.held.push(held.1 > 0 || tied.1 > 0);
    }

    fn finish(mut self) -> WallParts {
        self.parts.supports = vec![Support {
            name: "bottom".into(),
            nodes: self.held_nodes,
            fixed: [true; 3],
        }];
        self.parts.beams = vec![Beam {
            name: "top".into(),
            nodes: self.tied_nodes,
            area: self.wall.length.get() * self.wall.unit[1].get(),
            normal: [0.0, 0.0, 1.0],
        }];
        self.parts
    }
}

/// Block and column of the course above that covers most of [a, b].
fn column_above(above: &[Block], a: f64, b: f64) -> (usize, usize) {
    let mut best = (0, 0);
    let mut most = f64::NEG_INFINITY;
    for (s, block) in above.iter().enumerate() {
        // Units and head joints count as wholes: their columns are equal.
        let columns = [
            (0, 0, block.unit_x),
            (block.unit_x, block.unit_x, block.x.len() - 1),
        ];
        for (column, from, to) in columns {
            if from < to {
                let overlap = block.x[to].min(b) - block.x[from].max(a);
                if overlap > most {
                    (most, best) = (overlap, (s, column));
                }
            }
        }
    }
    best
}
