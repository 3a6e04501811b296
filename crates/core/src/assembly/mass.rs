//! Mass from the densities, and the forces of a uniform acceleration.
//!
//! The mass of an element is its consistent matrix (Hughes 2000, §7.3.2; theory/inertia.md, eq. 7), kept as its row
//! sums at the nodes, the lumped masses, and the rest that couples the nodes:
//!
//! ```text
//! M_ab = ∫ ρ N_a N_b dV = m_a δ_ab + C_ab,   m_a = ∫ ρ N_a dV,   Σ_b C_ab = 0
//! ```
//!
//! Both give a moving body its momentum; the rest gives it its moments of inertia. The 2×2×2 Gauss points of the
//! element integrate the volume of a trilinear hexahedron exactly, so the total mass is exact. Floors add their masses
//! to nodes. Nodes tied to a beam add to its mass. Mass at supported displacements moves nothing.

use super::Bulk;
use super::dofs::{DofMap, HELD};
use crate::element::hex8::CORNERS;
use crate::model::Model;

/// Pairs b ≤ a of the nodes of an element.
const PAIRS: [(usize, usize); 36] = {
    let mut pairs = [(0, 0); 36];
    let (mut a, mut pair) = (0, 0);
    while a < 8 {
        let mut b = 0;
        while b <= a {
            pairs[pair] = (a, b);
            (b, pair) = (b + 1, pair + 1);
        }
        a += 1;
    }
    pairs
};

/// Coupling of the nodes of the elements.
#[derive(Clone, Debug)]
struct Couplings {
    /// Nodes of the elements. `[element][node]`
    nodes: Vec<[u32; 8]>,
    /// C_ab of the pairs b ≤ a [tonne]. `[element][pair]`
    of_pairs: Vec<[f64; 36]>,
    /// Slots of the nodes. `[node][xyz]`
    slots: Vec<[u32; 3]>,
    /// Parts of the slots' displacements that the nodes make. `[node][xyz]`
    parts: Vec<[f64; 3]>,
}

impl Couplings {
    /// Coupling of all elements.
    fn new(bulk: &Bulk, dofs: &DofMap, model: &Model) -> Self {
        let of = |e: usize| {
            let all = consistent(&bulk.shape(e).weight);
            let density = density(model, e);
            let mut pairs = [0.0; 36];
            for (pair, (a, b)) in pairs.iter_mut().zip(PAIRS) {
                let lumped: f64 = if a == b { all[a].iter().sum() } else { 0.0 };
                *pair = density * (all[a][b] - lumped);
            }
            pairs
        };
        Self {
            nodes: bulk.elements.clone(),
            of_pairs: (0..bulk.elements.len()).map(of).collect(),
            slots: dofs.slot.clone(),
            parts: dofs.sign.clone(),
        }
    }

    /// Visits the pairs of nodes of an element, each pair of different nodes in both orders.
    fn each_of(&self, element: usize, mut visit: impl FnMut([usize; 2], f64)) {
        let nodes = &self.nodes[element];
        for (coupling, (a, b)) in self.of_pairs[element].iter().zip(PAIRS) {
            let [a, b] = [nodes[a] as usize, nodes[b] as usize];
            visit([a, b], *coupling);
            if a != b {
                visit([b, a], *coupling);
            }
        }
    }

    /// Visits the directions of the pairs of nodes.
    fn each_node(&self, mut visit: impl FnMut([usize; 2], usize, f64)) {
        for element in 0..self.nodes.len() {
            self.each_of(element, |nodes, coupling| {
                (0..3).for_each(|i| visit(nodes, i, coupling));
            });
        }
    }

    /// Visits the pairs of slots that it couples, each pair of different nodes in both orders.
    fn each(&self, mut visit: impl FnMut(usize, usize, f64)) {
        self.each_node(|[a, b], i, coupling| {
            let [row, column] = [self.slots[a][i], self.slots[b][i]];
            if row != HELD && column != HELD {
                let mass = self.parts[a][i] * self.parts[b][i] * coupling;
                visit(row as usize, column as usize, mass);
            }
        });
    }
}

/// Masses of nodes and of generalised displacements.
#[derive(Clone, Debug)]
pub struct Mass {
    /// Mass of each node [tonne]. `[node]`
    pub node: Vec<f64>,
    /// Mass that each generalised displacement moves [tonne], Σ w² m of its nodes, which make the parts w of it. `[slot]`
    pub slot: Vec<f64>,
    /// The same for uniform accelerations [tonne], Σ w m. `[slot]`
    lever: Vec<f64>,
    /// Direction of each slot's displacement. `[slot]`
    direction: Vec<u8>,
    /// Coupling in the elements.
    elements: Couplings,
    /// Number of elements, for the mean over their nodes. An element across a plane of symmetry counts in part.
    count: f64,
}

impl Mass {
    /// Sums the masses of a model.
    pub fn new(model: &Model, bulk: &Bulk, dofs: &DofMap) -> Self {
        let mut node = vec![0.0; model.mesh.nodes.len()];
        for (e, nodes) in bulk.elements.iter().enumerate() {
            for (&n, mass) in nodes.iter().zip(nodal_masses(model, bulk, e)) {
                node[n as usize] += mass;
            }
        }
        for (n, mass) in model.floors.iter().flat_map(|floor| &floor.masses) {
            node[*n as usize] += mass;
        }
        let mut slot = vec![0.0; dofs.slots];
        let (mut lever, mut direction) = (slot.clone(), vec![0; dofs.slots]);
        let mut part = dofs.sign.clone();
        // The sign of an image is no part of a settlement.
        for image in dofs.reflected() {
            part[image.node as usize] = [1.0; 3];
        }
        for ((mass, slots), part) in node.iter().zip(&dofs.slot).zip(&part) {
            for (i, &s) in slots.iter().enumerate() {
                if s != HELD {
                    slot[s as usize] += part[i] * part[i] * mass;
                    lever[s as usize] += part[i] * mass;
                    direction[s as usize] = i as u8;
                }
            }
        }
        Self {
            node,
            slot,
            lever,
            direction,
            elements: Couplings::new(bulk, dofs, model),
            count: bulk.count,
        }
    }

    /// Inertia forces on supported displacements at the accelerations of the slots [N]. `[node][xyz]`
    pub fn held_forces(&self, acceleration: &[f64]) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; self.node.len()];
        self.elements.each_node(|[a, b], i, coupling| {
            let [row, column] = [a, b].map(|n| self.elements.slots[n][i]);
            if row == HELD && column != HELD {
                let part = self.elements.parts[b][i];
                forces[a][i] += coupling * part * acceleration[column as usize];
            }
        });
        forces
    }

    /// Visits the pairs of nodes that an element couples, and C_ab [tonne].
    pub(super) fn each_coupling_of(&self, element: usize, visit: impl FnMut([usize; 2], f64)) {
        self.elements.each_of(element, visit);
    }

    /// Visits the pairs of slots that elements couple, and C_ab times their parts [tonne].
    pub(super) fn each_coupling(&self, visit: impl FnMut(usize, usize, f64)) {
        self.elements.each(visit);
    }

    /// Adds the part of M v that couples nodes to `to`. `[slot]`
    pub fn add_coupling(&self, factor: f64, v: &[f64], to: &mut [f64]) {
        (self.elements).each(|row, column, mass| to[row] += factor * mass * v[column]);
    }

    /// The part of uᵀ M v that couples nodes. `[slot]`
    pub fn coupling(&self, u: &[f64], v: &[f64]) -> f64 {
        let mut sum = 0.0;
        (self.elements).each(|row, column, mass| sum += u[row] * mass * v[column]);
        sum
    }

    /// Total mass [tonne].
    pub fn total(&self) -> f64 {
        self.node.iter().sum()
    }

    /// Component of a uniform acceleration along a slot.
    pub fn along(&self, slot: usize, acceleration: [f64; 3]) -> f64 {
        acceleration[self.direction[slot] as usize]
    }

    /// Inertia forces M a of a uniform acceleration [N]. `[slot]`
    pub fn forces(&self, acceleration: [f64; 3], forces: &mut [f64]) {
        for ((f, m), &i) in forces.iter_mut().zip(&self.lever).zip(&self.direction) {
            *f = m * acceleration[i as usize];
        }
    }

    /// Generalised velocities from nodal ones `[node]` [mm/s]. They preserve the momentum of tied nodes.
    pub fn mean_velocity(&self, dofs: &DofMap, nodal: &[[f64; 3]], velocity: &mut [f64]) {
        velocity.fill(0.0);
        let nodes = nodal.iter().zip(&self.node).zip(&dofs.slot);
        for (((v, m), slots), sign) in nodes.zip(&dofs.sign) {
            for (i, &s) in slots.iter().enumerate() {
                if s != HELD {
                    velocity[s as usize] += m * sign[i] * v[i] / self.slot[s as usize];
                }
            }
        }
    }

    /// Kinetic energy ½ vᵀ M v [N mm].
    pub fn kinetic_energy(&self, velocity: &[f64]) -> f64 {
        let twice: f64 = self.slot.iter().zip(velocity).map(|(m, v)| m * v * v).sum();
        0.5 * (twice + self.coupling(velocity, velocity))
    }

    /// Mean magnitude of M a over the elements' nodes [N], with the acceleration a of each slot [mm/s²]. It is the
    /// scale of forces where nothing is stressed.
    pub fn mean_force(&self, acceleration: impl Iterator<Item = f64>) -> f64 {
        let sum: f64 = self
            .slot
            .iter()
            .zip(acceleration)
            .map(|(m, a)| m * a.abs())
            .sum();
        sum / (8.0 * self.count.max(f64::MIN_POSITIVE))
    }
}

/// Masses of the nodes of an element [tonne], their parts of its mass.
fn nodal_masses(model: &Model, bulk: &Bulk, element: usize) -> [f64; 8] {
    let density = density(model, element);
    nodal_volumes(&bulk.shape(element).weight).map(|volume| density * volume)
}

/// Density of an element [tonne/mm³].
fn density(model: &Model, element: usize) -> f64 {
    let material = usize::from(model.mesh.material[element]);
    model.materials[material].parameters.elastic().density
}

/// ∫ N_a dV [mm³] from det J · w at the Gauss points, which are ordered like the nodes.
fn nodal_volumes(weight: &[f64; 8]) -> [f64; 8] {
    CORNERS.map(|a| {
        let points = CORNERS.iter().zip(weight);
        points.map(|(g, w)| w * shape(a, *g)).sum()
    })
}

/// N_a at the Gauss point nearest to corner `g`.
fn shape(a: [f64; 3], g: [f64; 3]) -> f64 {
    let at = 1.0 / 3.0_f64.sqrt();
    (0..3).map(|i| 0.5 * (1.0 + at * a[i] * g[i])).product()
}

/// ∫ N_a N_b dV [mm³] in the same way.
fn consistent(weight: &[f64; 8]) -> [[f64; 8]; 8] {
    let mut sum = [[0.0; 8]; 8];
    for (g, w) in CORNERS.iter().zip(weight) {
        let n = CORNERS.map(|a| shape(a, *g));
        for a in 0..8 {
            for b in 0..8 {
                sum[a][b] += w * n[a] * n[b];
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::Mass;
    use crate::assembly::{Equations, System};
    use crate::deck::Deck;
    use crate::linear::Backend;
    use crate::model::Model;

    /// A block of one element, free or with what the tests add.
    const DECK: &str = r#"
format = 1
[materials.stone]
E = "10 GPa"
nu = 0.2
density = "2000 kg/m^3"
[[blocks]]
name = "block"
size = [200, 100, 60]
at = [30, -20, 10]
material = "stone"
[[steps]]
kind = "free"
"#;

    fn system(more: &str) -> (Model, System) {
        let deck = DECK.replace("[[steps]]", &format!("{more}[[steps]]"));
        let deck = Deck::from_str(&deck, "test").unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let system = System::new(&model).unwrap();
        (model, system)
    }

    fn twice_kinetic(mass: &Mass, v: &[f64]) -> f64 {
        2.0 * mass.kinetic_energy(v)
    }

    #[test]
    fn a_block_of_one_element_has_the_moments_of_inertia_of_a_solid() {
        let (model, system) = system("");
        let (dofs, mass) = (&system.dofs, &system.mass);
        let size: [f64; 3] = [200.0, 100.0, 60.0];
        let centre = [130.0, 30.0, 40.0];
        let all = 2e-9 * size.iter().product::<f64>();
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let (mut turns, mut moves) = (vec![0.0; dofs.slots], vec![0.0; dofs.slots]);
            for (x, slots) in model.mesh.nodes.iter().zip(&dofs.slot) {
                turns[slots[u] as usize] = centre[v] - x[v];
                turns[slots[v] as usize] = x[u] - centre[u];
                moves[slots[axis] as usize] = 1.0;
            }
            let inertia = all * (size[u].powi(2) + size[v].powi(2)) / 12.0;
            // Rounding.
            assert!((twice_kinetic(mass, &turns) / inertia - 1.0).abs() < 1e-12);
            assert!((twice_kinetic(mass, &moves) / all - 1.0).abs() < 1e-12);
            // M r = 0 for the product of a rotation and a translation about the centre.
            assert!(mass.coupling(&turns, &moves).abs() < 1e-12 * inertia);
        }
    }

    #[test]
    fn the_matrix_has_the_masses_that_the_forces_have() {
        let (model, mut system) = system("[[supports]]\non = \"block.left\"\n");
        let equations = Equations::new(&system.dofs, &model.steps[0]);
        for backend in [Backend::MultifrontalLlt, Backend::FaerLu] {
            let (entries, solver) = system.analyse(&equations, backend).unwrap();
            let mut values = vec![0.0; entries];
            system.add_mass(&equations, 3.0, &mut values);
            for column in 0..equations.len() {
                let mut way = vec![0.0; system.dofs.slots];
                way[equations.slot_of[column] as usize] = 1.0;
                let mut forces: Vec<f64> = (way.iter().zip(&system.mass.slot))
                    .map(|(a, m)| m * a)
                    .collect();
                system.mass.add_coupling(1.0, &way, &mut forces);
                for row in column..equations.len() {
                    let entry = solver.pattern().find(row, column);
                    let entry = entry.map_or(0.0, |k| values[k]);
                    let force = 3.0 * forces[equations.slot_of[row] as usize];
                    // Rounding.
                    assert!(
                        (entry - force).abs() < 1e-15,
                        "{row} {column} {entry} {force}"
                    );
                }
            }
        }
    }

    /// Newton's law: the inertia forces on free and on held displacements together are those of the whole mass.
    #[test]
    fn supports_feel_their_part_of_the_inertia() {
        let (model, system) = system("[[supports]]\non = \"block.left\"\n");
        let (dofs, mass) = (&system.dofs, &system.mass);
        let way: Vec<f64> = (0..dofs.slots).map(|s| (s as f64).sin()).collect();
        let mut forces: Vec<f64> = (way.iter().zip(&mass.slot)).map(|(a, m)| m * a).collect();
        mass.add_coupling(1.0, &way, &mut forces);
        let held = mass.held_forces(&way);
        let mut u = vec![[0.0; 3]; model.mesh.nodes.len()];
        dofs.spread(&way, &mut u);
        for i in 0..3 {
            let slots = dofs.slot.iter().map(|slots| slots[i]);
            let free: f64 = (slots.filter(|s| *s != super::HELD))
                .map(|s| forces[s as usize])
                .sum();
            let at_supports: f64 = held.iter().map(|force| force[i]).sum();
            let whole: f64 = u.iter().zip(&mass.node).map(|(u, m)| m * u[i]).sum();
            assert!(at_supports.abs() > 1e-6, "{at_supports}");
            // Rounding.
            assert!((free + at_supports - whole).abs() < 1e-15);
        }
    }
}
