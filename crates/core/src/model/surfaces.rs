//! Contact surfaces: facets, what of them is sampled, and the laws between them.

use super::general::GeneralContact;
use super::hexahedron::norm;
use wythe_contact::{InterfaceLaw, JointLaw, Output, Part, Surface};

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
    /// 2×2 Gauss points; for bonded walls.
    #[default]
    Gauss,
    /// The four corners, moved inwards by 1e-6 of the facet; for dry joints and rigid-like blocks.
    Corner,
}

/// One-pass contact: points on slave facets against master facets of other bodies.
///
/// A facet's nodes run counter-clockwise seen from outside its body, so that its normal points out.
#[derive(Clone, Debug, Default)]
pub struct ContactSurfaces {
    /// Slave facets. `[facet][node]`
    pub slave_facets: Vec<[u32; 4]>,
    /// Body of each slave facet. `[facet]`
    pub slave_body: Vec<u32>,
    /// Index into `laws`. `[facet]`
    pub slave_law: Vec<u16>,
    /// What of its facet each entry samples; empty if all facets are sampled whole. A facet that is cut into parts stands
    /// here once for each of them, one after the other. `[facet]`
    pub slave_part: Vec<Part>,
    /// Master facets. `[facet][node]`
    pub master_facets: Vec<[u32; 4]>,
    /// Body of each master facet. `[facet]`
    pub master_body: Vec<u32>,
    /// Interface laws with their stiffnesses resolved (penalty × representative stiffness), and each unit's
    /// own where their bond scatters.
    pub laws: Vec<InterfaceLaw>,
    /// Names of the laws in the deck; several laws have one. `[law]`
    pub law_names: Vec<String>,
    /// Sampling of the slave facets.
    pub points: ContactPoints,
    /// Gap up to which a point faces a master facet, and beyond which it has lost it with its bond
    /// [mm]; none = the solver chooses.
    pub search_radius: Option<f64>,
    /// Whether every face may meet any other body's, and by which law.
    pub general: Option<GeneralContact>,
}

impl ContactSurfaces {
    /// Slave facets with their bodies, as the search takes them.
    pub fn slave(&self) -> Surface {
        Surface {
            facets: self.slave_facets.clone(),
            body: self.slave_body.clone(),
        }
    }

    /// What the laws tell of their histories, each name once, in the order of the laws.
    pub fn outputs(&self) -> Vec<Output> {
        let mut outputs: Vec<Output> = Vec::new();
        for output in self.laws.iter().flat_map(JointLaw::outputs) {
            if outputs.iter().all(|known| known.name != output.name) {
                outputs.push(*output);
            }
        }
        outputs
    }

    /// What an entry of the slave facets samples.
    pub fn part(&self, facet: usize) -> Part {
        self.slave_part.get(facet).copied().unwrap_or(Part::WHOLE)
    }

    /// Corners of what an entry of the slave facets samples, nodes being at `x` [mm].
    pub fn outline(&self, facet: usize, x: &[[f64; 3]]) -> [[f64; 3]; 4] {
        let corners = self.slave_facets[facet].map(|n| x[n as usize]);
        self.part(facet).of(&corners)
    }

    /// Slave facets, each once with the number of its first part.
    pub fn whole_slaves(&self) -> impl Iterator<Item = (usize, &[u32; 4])> {
        let all = self.slave_facets.iter().enumerate();
        all.filter(|(f, _)| self.is_first(*f))
    }

    fn is_first(&self, facet: usize) -> bool {
        self.slave_part
            .get(facet)
            .is_none_or(|part| part.reaches(0))
    }

    /// Cuts every slave facet into so many parts along x, y and z, nodes being at `x` [mm]: each of its two directions
    /// into those of the axis that it goes along.
    pub(super) fn divide(&mut self, counts: [u32; 3], x: &[[f64; 3]]) {
        if counts == [1; 3] {
            return;
        }
        let facets = std::mem::take(&mut self.slave_facets);
        let bodies = std::mem::take(&mut self.slave_body);
        let laws = std::mem::take(&mut self.slave_law);
        for ((facet, body), law) in facets.into_iter().zip(bodies).zip(laws) {
            let axes = directions(&facet.map(|n| x[n as usize]));
            for part in Part::grid(axes.map(|axis| counts[axis])) {
                self.slave_facets.push(facet);
                self.slave_body.push(body);
                self.slave_law.push(law);
                self.slave_part.push(part);
            }
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

/// The axes that the directions ξ and η of a facet go along: the two that they are turned from least.
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
    // Of equals the first.
    let best = pairs.into_iter().rev();
    best.max_by(|p, q| fit(*p).total_cmp(&fit(*q)))
        .unwrap_or([0, 1])
}
