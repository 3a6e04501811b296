//! General contact: every face of every body may meet any other body's.

use wythe_contact::{CohesiveFrictional, frame_at};

use super::deck::Deck;
use super::scene::{Model, NamedMaterial};
use super::skin::Skin;
use super::{Mesh, hexahedron};
use crate::error::ModelError;
use crate::material::ElasticParameters;

/// What bodies need to meet anywhere: their skins and a dry law.
#[derive(Clone, Debug)]
pub struct GeneralContact {
    /// Name of the interface in the deck.
    pub interface: String,
    /// Faces and sharp edges.
    pub skin: Skin,
    /// Friction μ [-].
    pub mu: f64,
    /// Normal and shear stiffness of the law behind each facet; of two that meet the softer one counts
    /// [N/mm³]. `[facet]`
    pub stiffness: Vec<[f64; 2]>,
    /// E/h and G/h of the element behind each facet [N/mm³]. `[facet]`
    pub elastic: Vec<[f64; 2]>,
}

impl GeneralContact {
    /// Of the bodies of a mesh. The law is dry; its stiffness is `penalty` times E/h (theory C.8), or
    /// as `given`, normal and shear [N/mm³].
    pub fn new(
        interface: &str,
        mesh: &Mesh,
        materials: &[NamedMaterial],
        mu: f64,
        penalty: f64,
        given: Option<[f64; 2]>,
    ) -> Self {
        let skin = Skin::of(mesh);
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
            .map(|k| given.unwrap_or(k.map(|k| penalty * k)))
            .collect();
        Self {
            interface: interface.to_owned(),
            skin,
            mu,
            stiffness,
            elastic,
        }
    }

    /// The law between two facets.
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

/// The general contact of a model, if its deck wants it.
///
/// # Errors
/// An interface that is not there, or that is bonded.
pub(super) fn general(deck: &Deck, model: &Model) -> Result<Option<GeneralContact>, ModelError> {
    let Some(name) = &deck.contact.general else {
        return Ok(None);
    };
    let Some(interface) = deck.interfaces.get(name) else {
        return Err(deck.error("contact.general", "there is no such interface", "name one"));
    };
    let given = match (interface.normal_stiffness, interface.shear_stiffness) {
        (Some(normal), Some(shear)) => Some([normal.get(), shear.get()]),
        _ => None,
    };
    Ok(Some(GeneralContact::new(
        name,
        &model.mesh,
        &model.materials,
        interface.mu.get(),
        interface.penalty(),
        given,
    )))
}

/// Sizes of a facet: its shortest side [mm].
pub(crate) fn shortest_side(corners: &[[f64; 3]; 4]) -> f64 {
    (0..4)
        .map(|i| hexahedron::norm(hexahedron::difference(corners[(i + 1) % 4], corners[i])))
        .fold(f64::INFINITY, f64::min)
}

/// Outward unit normal of a facet in its middle.
pub(crate) fn normal(corners: &[[f64; 3]; 4]) -> nalgebra::Vector3<f64> {
    frame_at(corners, [0.0; 2])[0]
}
