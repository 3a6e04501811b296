//! General contact of all faces with other bodies.

use wythe_contact::{CohesiveFrictional, frame_at};

use crate::element::hexahedron;
use crate::material::ElasticParameters;
use crate::model::Mesh;
use crate::model::boundary_facets::BoundaryFacets;
use crate::model::scene::NamedMaterial;

/// Data for general contact: boundary facets and a dry law.
#[derive(Clone, Debug)]
pub struct GeneralContact {
    /// Name of the interface in the deck.
    pub interface: String,
    /// Boundary facets and sharp edges.
    pub skin: BoundaryFacets,
    /// Friction μ [-].
    pub mu: f64,
    /// Normal and shear stiffness of the law for the element behind each facet [N/mm³]. Of two facets in contact the
    /// softer one counts. `[facet]`
    pub stiffness: Vec<[f64; 2]>,
    /// E/h and G/h of the element behind each facet [N/mm³]. `[facet]`
    pub elastic: Vec<[f64; 2]>,
}

/// Stiffness of the law of general contact.
#[derive(Clone, Copy, Debug)]
pub enum DryStiffness {
    /// This factor times E/h and G/h of the element behind a facet (theory/joint.md, eqs 32 and 33).
    Penalty(f64),
    /// Normal and shear stiffness [N/mm³].
    Given([f64; 2]),
}

impl GeneralContact {
    /// Makes the data for the bodies of a mesh. The law is dry.
    pub fn new(
        interface: &str,
        mesh: &Mesh,
        materials: &[NamedMaterial],
        mu: f64,
        stiffness: DryStiffness,
    ) -> Self {
        let skin = BoundaryFacets::of(mesh);
        let elastic: Vec<[f64; 2]> = skin
            .facets
            .iter()
            .zip(&skin.element)
            .map(|(facet, &e)| {
                let e = e as usize;
                let material = materials[mesh.material[e] as usize].parameters.elastic();
                over_height(mesh, e, facet, material)
            })
            .collect();
        let stiffness = elastic
            .iter()
            .map(|k| match stiffness {
                DryStiffness::Penalty(factor) => k.map(|k| factor * k),
                DryStiffness::Given(stiffness) => stiffness,
            })
            .collect();
        Self {
            interface: interface.to_owned(),
            skin,
            mu,
            stiffness,
            elastic,
        }
    }

    /// Law between two facets.
    pub fn law(&self, a: u32, b: u32) -> CohesiveFrictional {
        let [k, l] = [a, b].map(|f| self.stiffness[f as usize]);
        let [normal, shear] = if l[0] < k[0] { l } else { k };
        CohesiveFrictional::dry(self.mu, normal, shear)
    }
}

/// E and G over the size of an element normal to one of its faces [N/mm³].
fn over_height(
    mesh: &Mesh,
    element: usize,
    facet: &[u32; 4],
    material: &ElasticParameters,
) -> [f64; 2] {
    let x = facet.map(|n| mesh.nodes[n as usize]);
    let height = mesh.volume(element) / hexahedron::norm(hexahedron::area_vector(&x));
    [material.E / height, material.shear_modulus() / height]
}

/// Shortest side of a facet [mm].
pub(crate) fn shortest_side(corners: &[[f64; 3]; 4]) -> f64 {
    (0..4)
        .map(|i| hexahedron::norm(hexahedron::difference(corners[(i + 1) % 4], corners[i])))
        .fold(f64::INFINITY, f64::min)
}

/// Outward unit normal at the centre of a facet.
pub(crate) fn normal(corners: &[[f64; 3]; 4]) -> nalgebra::Vector3<f64> {
    frame_at(corners, [0.0; 2])[0]
}
