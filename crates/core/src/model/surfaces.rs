//! Contact surfaces: facets, their sampled parts and their laws.

use super::dry_faces::Division;
use super::general::GeneralContact;
use crate::element::hexahedron::norm;
use crate::material::ElasticParameters;
use wythe_contact::{
    InterfaceLaw, JointLaw, Output, Part, PointsAlong, SlavePoint, Surface, corner_points,
    points_of,
};

/// Where an interface is sampled on a slave facet.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Deserialize,
    serde::Serialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum ContactPoints {
    /// 2×2 Gauss points, in dry joints with points on the edges of the faces.
    #[default]
    Auto,
    /// 2×2 Gauss points.
    Gauss,
    /// The four corners, moved inwards by 1e-6 of the facet.
    Corner,
}

/// One-pass contact: points on slave facets against master facets of other bodies.
///
/// Nodes of a facet run counter-clockwise seen from outside its body, so its normal points outwards.
#[derive(Clone, Debug, Default)]
pub struct ContactSurfaces {
    /// Slave facets. `[facet][node]`
    pub slave_facets: Vec<[u32; 4]>,
    /// Body of each slave facet. `[facet]`
    pub slave_body: Vec<u32>,
    /// Index into `laws`. `[facet]`
    pub slave_law: Vec<u16>,
    /// Sampled part of each entry's facet. Empty if all facets are sampled as a whole. A facet divided into parts has
    /// consecutive entries, one for each part. `[facet]`
    pub slave_part: Vec<Part>,
    /// Points of each entry along its two directions. Empty if all have Gauss points. `[facet]`
    pub slave_points: Vec<[PointsAlong; 2]>,
    /// Whether the facet lies in a plane of symmetry normal to x, y or z, between a body and its image. Empty if no
    /// facet does. `[facet][xyz]`
    pub slave_planes: Vec<[bool; 3]>,
    /// Master facets. `[facet][node]`
    pub master_facets: Vec<[u32; 4]>,
    /// Body of each master facet. `[facet]`
    pub master_body: Vec<u32>,
    /// Joint laws with their stiffnesses resolved (penalty × representative stiffness). Units have laws of their own
    /// where their bond is random.
    pub laws: Vec<InterfaceLaw>,
    /// Names of the laws in the deck. Several laws may share a name. `[law]`
    pub law_names: Vec<String>,
    /// Sampling of the slave facets.
    pub points: ContactPoints,
    /// Gap up to which a point has a master facet, and beyond which it loses the facet and its bond [mm]. None:
    /// chosen by the solver.
    pub search_radius: Option<f64>,
    /// General contact of all faces with other bodies, if any.
    pub general: Option<GeneralContact>,
}

impl ContactSurfaces {
    pub(crate) fn add_slave(&mut self, facet: [u32; 4], body: u32, law: u16) {
        self.slave_facets.push(facet);
        self.slave_body.push(body);
        self.slave_law.push(law);
    }

    pub(crate) fn add_master(&mut self, facet: [u32; 4], body: u32) {
        self.master_facets.push(facet);
        self.master_body.push(body);
    }

    /// Slave facets with their bodies, as input of the contact search.
    pub fn slave(&self) -> Surface {
        Surface {
            facets: self.slave_facets.clone(),
            body: self.slave_body.clone(),
        }
    }

    /// Outputs of the laws, each name once, in the order of the laws.
    pub fn outputs(&self) -> Vec<Output> {
        let mut outputs: Vec<Output> = Vec::new();
        for output in self.laws.iter().flat_map(JointLaw::outputs) {
            if outputs.iter().all(|known| known.name != output.name) {
                outputs.push(*output);
            }
        }
        outputs
    }

    /// Sampled part of an entry of the slave facets.
    pub fn part(&self, facet: usize) -> Part {
        self.slave_part.get(facet).copied().unwrap_or(Part::WHOLE)
    }

    /// Planes of symmetry in which an entry of the slave facets lies, by the axes of their normals.
    pub fn planes(&self, facet: usize) -> [bool; 3] {
        self.slave_planes.get(facet).copied().unwrap_or_default()
    }

    /// Corners of the sampled part of an entry of the slave facets, for nodes at `x` [mm].
    pub fn outline(&self, facet: usize, x: &[[f64; 3]]) -> [[f64; 3]; 4] {
        let corners = self.slave_facets[facet].map(|n| x[n as usize]);
        self.part(facet).of(&corners)
    }

    /// Slave facets, each once, with the index of its first part.
    pub fn whole_slaves(&self) -> impl Iterator<Item = (usize, &[u32; 4])> {
        let all = self.slave_facets.iter().enumerate();
        all.filter(|(f, _)| self.is_first(*f))
    }

    fn is_first(&self, facet: usize) -> bool {
        self.slave_part
            .get(facet)
            .is_none_or(|part| part.reaches(0))
    }

    /// Contact points of an entry of the slave facets, for nodes at `x` [mm].
    pub fn sampled(&self, facet: usize, x: &[[f64; 3]]) -> [SlavePoint; 4] {
        let corners = self.slave_facets[facet].map(|n| x[n as usize]);
        let part = self.part(facet);
        match self.points {
            ContactPoints::Corner => corner_points(&corners, &part),
            ContactPoints::Auto | ContactPoints::Gauss => {
                let along = self.slave_points.get(facet).copied().unwrap_or_default();
                points_of(&corners, &part, along)
            }
        }
    }

    /// Whether contact points lie on the edges of the joint at an entry of the slave facets.
    pub fn samples_edges(&self, facet: usize) -> bool {
        self.points == ContactPoints::Corner
            || (!self.slave_points.is_empty() && self.is_dry(facet))
    }

    /// Whether the joint of an entry of the slave facets has no bond from the start.
    fn is_dry(&self, facet: usize) -> bool {
        let law = self.slave_law.get(facet).map(|law| usize::from(*law));
        let law = law.and_then(|law| self.laws.get(law));
        law.is_some_and(JointLaw::is_dry)
    }

    /// How every slave facet is divided into parts, for nodes at `x` [mm]. `counts` are the numbers of parts along x, y
    /// and z; each of the two directions of a facet takes the number of the axis that it follows. Dry facets are divided
    /// where faces opposite to them end, too, and have points at the ends of faces.
    pub(crate) fn division(&self, counts: [u32; 3], x: &[[f64; 3]]) -> Division {
        let all = self.slave_facets.iter();
        let along = all.map(|facet| directions(&facet.map(|n| x[n as usize])));
        let counts = along.map(|axes| axes.map(|axis| counts[axis]));
        Division::new(self, counts, &self.sampled_at_ends(), x)
    }

    /// Divides every slave facet.
    pub(crate) fn divide(&mut self, division: &Division) {
        let at_ends = !self.sampled_at_ends().is_empty();
        if !at_ends && division.is_whole() {
            return;
        }
        let facets = std::mem::take(&mut self.slave_facets);
        let bodies = std::mem::take(&mut self.slave_body);
        let laws = std::mem::take(&mut self.slave_law);
        let all = facets.into_iter().zip(bodies).zip(laws).enumerate();
        for (f, ((facet, body), law)) in all {
            for (part, points) in division.parts(f) {
                self.add_slave(facet, body, law);
                self.slave_part.push(part);
                if at_ends {
                    self.slave_points.push(points);
                }
            }
        }
    }

    /// Slave facets that have points at the ends of faces: dry ones, if the deck does not say where points are.
    fn sampled_at_ends(&self) -> Vec<usize> {
        match self.points {
            ContactPoints::Auto => (0..self.slave_facets.len())
                .filter(|f| self.is_dry(*f))
                .collect(),
            ContactPoints::Gauss | ContactPoints::Corner => Vec::new(),
        }
    }

    /// Master facets with their bodies.
    pub fn master(&self) -> Surface {
        Surface {
            facets: self.master_facets.clone(),
            body: self.master_body.clone(),
        }
    }
}

/// Axes that the directions ξ and η of a facet follow: the two with the smallest angles to them.
fn directions(corners: &[[f64; 3]; 4]) -> [usize; 2] {
    let along = |ends: [[usize; 2]; 2]| {
        let way = [0, 1, 2].map(|d| {
            ends.map(|[a, b]| corners[b][d] - corners[a][d])
                .iter()
                .sum()
        });
        let length = norm(way);
        way.map(|w: f64| if length > 0.0 { w.abs() / length } else { 0.0 })
    };
    let (xi, eta) = (along([[0, 1], [3, 2]]), along([[0, 3], [1, 2]]));
    let pairs = [[0, 1], [0, 2], [1, 0], [1, 2], [2, 0], [2, 1]];
    let fit = |[a, b]: [usize; 2]| xi[a] + eta[b];
    // The first of equal pairs is taken.
    let best = pairs.into_iter().rev();
    best.max_by(|p, q| fit(*p).total_cmp(&fit(*q)))
        .unwrap_or([0, 1])
}

/// Elastic constants of an element at a joint, and its size normal to the joint.
#[derive(Clone, Copy, Debug)]
pub struct JointSide<'a> {
    /// Elastic constants.
    pub material: &'a ElasticParameters,
    /// Size normal to the joint [mm].
    pub size: f64,
}

/// Stiffnesses k_n and k_s of a joint between two elements [N/mm³]: `factor` times E/h of the softer one, and G/h of
/// the same element (theory/joint.md, eqs 32 and 33).
pub fn joint_stiffness(factor: f64, a: JointSide<'_>, b: JointSide<'_>) -> [f64; 2] {
    let stiffness = |s: &JointSide<'_>| s.material.E / s.size;
    let softer = if stiffness(&b) < stiffness(&a) { b } else { a };
    let normal = factor * stiffness(&softer);
    [normal, normal / (2.0 * (1.0 + softer.material.nu))]
}
