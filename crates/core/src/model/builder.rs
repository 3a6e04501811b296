//! Builds a [`Model`] from Rust, block by block, without a deck.

use super::axis::along_axis;
use super::general::{DryStiffness, GeneralContact};
use super::probes::{Probe, ProbeQuantity};
use super::scene::{Beam, HeldBy, NamedMaterial, Step, Support};
use super::surfaces::{JointSide, joint_stiffness};
use super::ties::{self, Bonded, Tie, TieFault, TieLaw, TiePoint};
use super::{Mesh, Model};
use crate::element::hexahedron::{Face, area_vector, norm};
use crate::material::MaterialParameters;
use wythe_contact::InterfaceLaw;

/// Builds a [`Model`].
///
/// Methods return handles to what they add; later methods take the handles, which belong to this builder alone.
/// [`ModelBuilder::model`] is open to
/// whatever no method sets, and [`ModelBuilder::build`] checks the whole.
///
/// ```
/// use wythe_core::element::hexahedron::Face;
/// use wythe_core::material::{ElasticParameters, MaterialParameters};
/// use wythe_core::model::builder::ModelBuilder;
/// use wythe_core::model::scene::{BeamMotion, Driven, Step};
///
/// let mut wall = ModelBuilder::new("a block drawn out");
/// let stone = ElasticParameters { E: 5000.0, nu: 0.2, density: 0.0 };
/// let stone = wall.material("stone", MaterialParameters::Elastic(stone));
/// let block = wall.block("block", [0.0; 3], [100.0, 100.0, 50.0], [2, 2, 1], stone);
/// wall.support("ground", block.face(Face::Bottom), [true; 3]);
/// wall.beam("top", &[(&block, Face::Top)]);
/// let motion = [BeamMotion::Locked, BeamMotion::Locked, BeamMotion::Driven(0.01)];
/// wall.step(Step { motion: vec![motion], driven: Some(Driven::along(0, 2)), ..Step::default() });
/// assert_eq!(wall.build()?.mesh.elements.len(), 4);
/// # Ok::<(), wythe_core::model::builder::BuildError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ModelBuilder {
    /// The model so far.
    pub model: Model,
}

/// Index of a material of a [`ModelBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialId(u16);

/// Index of a joint law of a [`ModelBuilder`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawId(u16);

/// A block of a [`ModelBuilder`]: a body with a grid of hex8 elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    body: u32,
    first_node: u32,
    first_element: u32,
    cells: [usize; 3],
    material: MaterialId,
}

/// Fault in a model that [`ModelBuilder::build`] finds.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The model has no elements.
    #[error("the model has no blocks: add one with ModelBuilder::block")]
    NoBlocks,
    /// The model has no steps.
    #[error(
        "the model has no steps, so that nothing happens to it: add one with ModelBuilder::step"
    )]
    NoSteps,
    /// An element has no volume.
    #[error(
        "element {element} of {body} has the volume {volume} mm³: give its block positive sizes"
    )]
    NoVolume {
        /// Index of the element.
        element: usize,
        /// Name of its body.
        body: String,
        /// Its volume [mm³].
        volume: f64,
    },
    /// A node, material, law, probe, beam or load does not exist.
    #[error("{owner} refers to {kind} {index}, and there are {count}")]
    NoSuch {
        /// The part of the model that refers to it.
        owner: String,
        /// Kind of the missing part.
        kind: &'static str,
        /// Its index.
        index: usize,
        /// Number of parts of this kind.
        count: usize,
    },
    /// More materials or joint laws than an index can number.
    #[error("there are {count} {kind}, and at most {MOST_INDICES}: share them between blocks")]
    TooMany {
        /// Kind of the parts.
        kind: &'static str,
        /// Their number.
        count: usize,
    },
    /// A list of a step has another length than the parts that it moves.
    #[error("step {step} moves {given} {kind}, and there are {count}: give one entry for each")]
    Count {
        /// Name of the step.
        step: String,
        /// Kind of the parts: beams, springs, ties or loads.
        kind: &'static str,
        /// Number of entries.
        given: usize,
        /// Number of parts.
        count: usize,
    },
}

/// Number of different indices of materials and joint laws.
const MOST_INDICES: usize = 1 << 16;

impl ModelBuilder {
    /// A model without parts.
    pub fn new(title: &str) -> Self {
        Self {
            model: Model::empty(title),
        }
    }

    /// Adds a material.
    pub fn material(&mut self, name: &str, parameters: MaterialParameters) -> MaterialId {
        self.model.materials.push(NamedMaterial {
            name: name.to_owned(),
            parameters,
            rigid: false,
        });
        MaterialId((self.model.materials.len() - 1) as u16)
    }

    /// Makes rigid bodies of the units of a material. Its parameters give their weight, and the stiffness of units that
    /// cannot be rigid bodies because beams, springs or ties hold some of their nodes.
    pub fn rigid(&mut self, material: MaterialId) -> &mut Self {
        self.model.materials[usize::from(material.0)].rigid = true;
        self
    }

    /// Adds a block with its lower corner at `low` and edges `size` along the axes [mm], of `cells` elements along
    /// x, y, z.
    pub fn block(
        &mut self,
        name: &str,
        low: [f64; 3],
        size: [f64; 3],
        cells: [usize; 3],
        material: MaterialId,
    ) -> Block {
        let mesh = &mut self.model.mesh;
        let block = Block {
            body: mesh.names.len() as u32,
            first_node: mesh.nodes.len() as u32,
            first_element: mesh.elements.len() as u32,
            cells: cells.map(|c| c.max(1)),
            material,
        };
        let cells = block.cells;
        for at in grid(cells.map(|c| c + 1)) {
            let x = |d: usize| low[d] + size[d] * at[d] as f64 / cells[d] as f64;
            mesh.nodes.push([0, 1, 2].map(x));
        }
        for [i, j, k] in grid(cells) {
            let ring = [(0, 0), (1, 0), (1, 1), (0, 1)];
            let mut nodes = [0; 8];
            for (n, (di, dj)) in ring.into_iter().enumerate() {
                nodes[n] = block.node([i + di, j + dj, k]);
                nodes[n + 4] = block.node([i + di, j + dj, k + 1]);
            }
            mesh.elements.push(nodes);
            mesh.material.push(material.0);
            mesh.unit.push(block.body);
            mesh.course.push(0);
        }
        mesh.names.push(name.to_owned());
        block
    }

    /// Adds a joint law. [`InterfaceLaw::custom`] makes one of a law of your own.
    pub fn law(&mut self, name: &str, law: impl Into<InterfaceLaw>) -> LawId {
        let contact = &mut self.model.contact;
        contact.laws.push(law.into());
        contact.law_names.push(name.to_owned());
        LawId((contact.laws.len() - 1) as u16)
    }

    /// Makes a face a slave face: its points carry `law` where they meet a master face of another block. The finer
    /// of two faces should be the slave.
    pub fn slave(&mut self, block: &Block, face: Face, law: LawId) {
        for facet in block.facets(face) {
            self.model.contact.add_slave(facet, block.body, law.0);
        }
    }

    /// Makes a face a master face.
    pub fn master(&mut self, block: &Block, face: Face) {
        for facet in block.facets(face) {
            self.model.contact.add_master(facet, block.body);
        }
    }

    /// Lets all faces meet all faces of other blocks, with a dry law of friction μ and stiffness 500 E/h.
    /// Add it after the last block.
    pub fn general_contact(&mut self, mu: f64) {
        let Model {
            mesh, materials, ..
        } = &self.model;
        let contact = GeneralContact::new("dry", mesh, materials, mu, DryStiffness::Penalty(500.0));
        self.model.contact.general = Some(contact);
    }

    /// Stiffnesses k_n and k_s of a joint between two blocks, `factor` times E/h and G/h of the softer one
    /// [N/mm³] (theory/joint.md, eqs 32 and 33). h is the size of their elements along `axis`.
    pub fn stiffness(&self, factor: f64, axis: usize, between: [&Block; 2]) -> [f64; 2] {
        let [a, b] = between.map(|block| JointSide {
            material: self.model.materials[usize::from(block.material.0)]
                .parameters
                .elastic(),
            size: self.element_size(block, axis),
        });
        joint_stiffness(factor, a, b)
    }

    fn element_size(&self, block: &Block, axis: usize) -> f64 {
        let x = self.model.mesh.corners(block.first_element as usize);
        x[6][axis] - x[0][axis]
    }

    /// Fixes nodes in the directions x, y, z.
    pub fn support(&mut self, name: &str, nodes: Vec<u32>, fixed: [bool; 3]) {
        self.model.supports.push(Support {
            name: name.to_owned(),
            nodes,
            fixed,
            by: HeldBy::Ground,
        });
    }

    /// Ties faces to a beam that moves without rotating; returns its index. Steps move it. Its normal and area are
    /// those of the faces together.
    pub fn beam(&mut self, name: &str, faces: &[(&Block, Face)]) -> usize {
        let mut nodes = Vec::new();
        let mut whole = [0.0; 3];
        for (block, face) in faces {
            nodes.extend(block.face(*face));
            for facet in block.facets(*face) {
                let area = area_vector(&facet.map(|n| self.model.mesh.nodes[n as usize]));
                whole = [0, 1, 2].map(|d| whole[d] + area[d]);
            }
        }
        let area = norm(whole);
        self.model.beams.push(Beam {
            name: name.to_owned(),
            nodes,
            area,
            normal: whole.map(|a| if area > 0.0 { a / area } else { 0.0 }),
            shape: Vec::new(),
            free: Vec::new(),
            depth: 0.0,
        });
        self.model.beams.len() - 1
    }

    /// Adds a probe of the mean displacement of nodes along an axis; returns its index.
    pub fn probe(&mut self, column: &str, nodes: Vec<u32>, axis: usize) -> usize {
        self.model.probes.push(Probe {
            column: column.to_owned(),
            nodes,
            minus: Vec::new(),
            direction: along_axis(axis),
            quantity: ProbeQuantity::Displacement,
            over: 1.0,
        });
        self.model.probes.len() - 1
    }

    /// Gives a block a velocity at the start of the first step with inertia [mm/s].
    pub fn velocity(&mut self, block: &Block, velocity: [f64; 3]) {
        let all = &mut self.model.initial_velocity;
        all.resize(self.model.mesh.nodes.len(), [0.0; 3]);
        for n in block.nodes() {
            all[n as usize] = velocity;
        }
    }

    /// Rotates a block about a point by an angle [rad] about an axis.
    pub fn rotate(&mut self, block: &Block, about: [f64; 3], axis: [f64; 3], angle: f64) {
        let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::from(axis));
        let rotation = nalgebra::Rotation3::from_axis_angle(&axis, angle);
        let centre = nalgebra::Vector3::from(about);
        for n in block.nodes() {
            let x = nalgebra::Vector3::from(self.model.mesh.nodes[n as usize]) - centre;
            self.model.mesh.nodes[n as usize] = (centre + rotation * x).into();
        }
    }

    /// Adds a tie that is held at its two ends only [mm]; returns its index. It is there from the start, unless
    /// [`Step::ties`] say otherwise. Add it after the bodies that it ties, once they are rotated.
    ///
    /// # Errors
    /// [`TieFault`]: ends outside all blocks, or in one element.
    pub fn tie(&mut self, name: &str, ends: [[f64; 3]; 2], law: TieLaw) -> Result<usize, TieFault> {
        let points = ties::anchored(&self.model.mesh, ends)?;
        Ok(self.add_tie(name, points, law))
    }

    /// Adds a tie along a line of points [mm] that is bound to all blocks which it crosses, but for the length
    /// `unbonded` [mm] at each joint, half of it on either side; returns its index.
    ///
    /// # Errors
    /// [`TieFault`]: ends outside all blocks, all in one element, a line in the common face of two blocks.
    pub fn bonded_tie(
        &mut self,
        name: &str,
        line: &[[f64; 3]],
        unbonded: f64,
        law: TieLaw,
    ) -> Result<usize, TieFault> {
        let of = Bonded {
            unbonded,
            only: None,
        };
        let points = ties::bonded(&self.model.mesh, line, &of)?;
        Ok(self.add_tie(name, points, law))
    }

    fn add_tie(&mut self, name: &str, points: Vec<TiePoint>, law: TieLaw) -> usize {
        self.model.ties.push(Tie {
            name: name.to_owned(),
            law,
            strands: vec![points],
            shares: Vec::new(),
        });
        self.model.ties.len() - 1
    }

    /// Adds a step.
    pub fn step(&mut self, step: Step) {
        self.model.steps.push(step);
    }

    /// Checks the model and returns it.
    ///
    /// # Errors
    /// [`BuildError`]: the first fault.
    pub fn build(mut self) -> Result<Model, BuildError> {
        check(&self.model)?;
        let Model { mesh, contact, .. } = &mut self.model;
        let division = contact.division([1; 3], &mesh.nodes);
        contact.divide(&division);
        Ok(self.model)
    }
}

impl Block {
    fn node(&self, [i, j, k]: [usize; 3]) -> u32 {
        let [a, b, _] = self.cells;
        self.first_node + (i + (a + 1) * (j + (b + 1) * k)) as u32
    }

    /// All nodes, ascending.
    pub fn nodes(&self) -> Vec<u32> {
        let count = self.cells.iter().map(|c| c + 1).product::<usize>() as u32;
        (self.first_node..self.first_node + count).collect()
    }

    /// Facets of a face, counter-clockwise seen from outside. `[facet][node]`
    pub fn facets(&self, face: Face) -> Vec<[u32; 4]> {
        let (axis, high) = face.side();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut facets = Vec::new();
        for b in 0..self.cells[v] {
            for a in 0..self.cells[u] {
                let mut facet = [(a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1)].map(|(a, b)| {
                    let mut at = [0; 3];
                    at[axis] = if high { self.cells[axis] } else { 0 };
                    (at[u], at[v]) = (a, b);
                    self.node(at)
                });
                if !high {
                    facet.swap(1, 3);
                }
                facets.push(facet);
            }
        }
        facets
    }

    /// Nodes of a face, ascending.
    pub fn face(&self, face: Face) -> Vec<u32> {
        let mut nodes: Vec<u32> = self.facets(face).into_iter().flatten().collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Node at the lower corner.
    pub fn corner(&self) -> u32 {
        self.first_node
    }

    /// Elements, as indices into the mesh.
    pub fn elements(&self) -> std::ops::Range<usize> {
        let first = self.first_element as usize;
        first..first + self.cells.iter().product::<usize>()
    }
}

/// Points of a grid, x fastest.
pub(crate) fn grid([a, b, c]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..a * b * c).map(move |n| [n % a, n / a % b, n / (a * b)])
}

fn check(model: &Model) -> Result<(), BuildError> {
    let Model { mesh, contact, .. } = model;
    if mesh.elements.is_empty() {
        return Err(BuildError::NoBlocks);
    }
    if model.steps.is_empty() {
        return Err(BuildError::NoSteps);
    }
    for (kind, count) in [
        ("materials", model.materials.len()),
        ("joint laws", contact.laws.len()),
    ] {
        if count > MOST_INDICES {
            return Err(BuildError::TooMany { kind, count });
        }
    }
    check_mesh(model)?;
    let nodes = mesh.nodes.len();
    for beam in &model.beams {
        check_nodes(&format!("beam {}", beam.name), &beam.nodes, nodes)?;
    }
    for support in &model.supports {
        check_nodes(&format!("support {}", support.name), &support.nodes, nodes)?;
    }
    for probe in &model.probes {
        let owner = format!("probe {}", probe.column);
        check_nodes(&owner, &probe.nodes, nodes)?;
        check_nodes(&owner, &probe.minus, nodes)?;
    }
    for spring in &model.springs {
        check_nodes(&format!("spring {}", spring.name), &spring.nodes, nodes)?;
    }
    for tie in &model.ties {
        for node in tie.strands.iter().flatten().flat_map(|point| &point.nodes) {
            check_nodes(&format!("tie {}", tie.name), &[node.0], nodes)?;
        }
    }
    for floor in &model.floors {
        for (node, _) in &floor.masses {
            check_nodes(&format!("floor {}", floor.name), &[*node], nodes)?;
        }
    }
    for (facet, law) in contact.slave_law.iter().enumerate() {
        let owner = || format!("slave facet {facet}");
        check_index(owner, "law", usize::from(*law), contact.laws.len())?;
    }
    model
        .steps
        .iter()
        .try_for_each(|step| check_step(model, step))
}

fn check_mesh(model: &Model) -> Result<(), BuildError> {
    let Mesh {
        nodes,
        elements,
        material,
        ..
    } = &model.mesh;
    for (element, corners) in elements.iter().enumerate() {
        check_nodes(&format!("element {element}"), corners, nodes.len())?;
        let owner = || format!("element {element}");
        let index = usize::from(material[element]);
        check_index(owner, "material", index, model.materials.len())?;
        let volume = model.mesh.volume(element);
        if volume.is_nan() || volume <= 0.0 {
            return Err(BuildError::NoVolume {
                element,
                body: model.mesh.body_of(element),
                volume,
            });
        }
    }
    Ok(())
}

fn check_step(model: &Model, step: &Step) -> Result<(), BuildError> {
    let owner = || format!("step {}", step.name);
    let count = |kind, given: usize, count: usize| {
        let name = step.name.clone();
        let wrong = BuildError::Count {
            step: name,
            kind,
            given,
            count,
        };
        if given == count { Ok(()) } else { Err(wrong) }
    };
    count("beams", step.motion.len(), model.beams.len())?;
    if !step.springs.is_empty() {
        count("springs", step.springs.len(), model.springs.len())?;
    }
    if !step.ties.is_empty() {
        count("ties", step.ties.len(), model.ties.len())?;
    }
    if !step.loads.is_empty() {
        count("loads", step.loads.len(), model.loads.len())?;
    }
    if let Some(driven) = step.driven {
        check_index(owner, "beam", driven.beam, model.beams.len())?;
    }
    if let Some(control) = &step.control {
        check_index(owner, "probe", control.probe, model.probes.len())?;
    }
    Ok(())
}

fn check_nodes(owner: &str, nodes: &[u32], count: usize) -> Result<(), BuildError> {
    let all = nodes.iter().map(|n| *n as usize);
    all.into_iter()
        .try_for_each(|n| check_index(|| owner.to_owned(), "node", n, count))
}

fn check_index(
    owner: impl Fn() -> String,
    kind: &'static str,
    index: usize,
    count: usize,
) -> Result<(), BuildError> {
    let missing = || BuildError::NoSuch {
        owner: owner(),
        kind,
        index,
        count,
    };
    if index < count {
        Ok(())
    } else {
        Err(missing())
    }
}
