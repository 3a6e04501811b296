//! Numerical stiffness of the shifted penalty.

use std::collections::HashMap;

use nalgebra::Vector3;
use wythe_contact::{JointLaw, frame_at};

use crate::element::hex8::FACES;
use crate::model::Model;

/// Numerical stiffness over E/h of the slave's element. It is low enough to prevent oscillation and grows where
/// nothing oscillates (theory/equilibrium.md, eq. 7).
const NUMERICAL_PENALTY: f64 = 1.0;
/// A point whose shear is below this part of its limit does not oscillate between stick and slip. It gets [`FIRM`]
/// times the numerical stiffness (theory/equilibrium.md, eq. 7).
pub(super) const WELL_WITHIN: f64 = 0.85;
/// Factor of the numerical stiffness of such a point.
pub(super) const FIRM: f64 = 3.0;

/// Least numerical stiffness over the steepest softening of the law. It makes the fixed-point iteration converge.
const LEAST_OVER_SOFTENING: f64 = 4.0;

/// Normal and shear numerical stiffness from the element behind each slave facet [N/mm³], and half of the element's
/// mass over the facet's area [tonne/mm²]. `[slave facet]`
pub fn numerical_stiffness(model: &Model) -> (Vec<[f64; 2]>, Vec<f64>) {
    let mut owner: HashMap<[u32; 4], usize> = HashMap::new();
    for (e, nodes) in model.mesh.elements.iter().enumerate() {
        for face in FACES {
            let mut key = face.map(|a| nodes[a]);
            key.sort_unstable();
            owner.insert(key, e);
        }
    }
    let contact = &model.contact;
    contact
        .slave_facets
        .iter()
        .zip(&contact.slave_law)
        .map(|(facet, &law)| {
            let law = &contact.laws[law as usize];
            let sorted = |mut key: [u32; 4]| {
                key.sort_unstable();
                key
            };
            // A facet of images alone faces its originals across a joint in a plane of symmetry.
            let original = |n: u32| model.mesh.reflected(n).map_or(n, |image| image.of);
            let own = owner.get(&sorted(*facet));
            let own = own.or_else(|| owner.get(&sorted(facet.map(original))));
            let Some(&e) = own else {
                return (law.stiffness(), 0.0);
            };
            let corners = model.mesh.corners(e);
            let elastic = model.materials[model.mesh.material[e] as usize]
                .parameters
                .elastic();
            let height = thickness(&corners, &facet.map(|n| model.mesh.nodes[n as usize]));
            let factor = NUMERICAL_PENALTY / height;
            let [opening, slip] = law.softening_slopes();
            let stiffness = [
                (factor * elastic.E).max(LEAST_OVER_SOFTENING * opening),
                (factor * elastic.shear_modulus()).max(LEAST_OVER_SOFTENING * slip),
            ];
            (stiffness, 0.5 * elastic.density * height)
        })
        .unzip()
}

/// Size of an element normal to one of its faces: twice the mean distance of its corners from the face.
fn thickness(corners: &[[f64; 3]; 8], face: &[[f64; 3]; 4]) -> f64 {
    let normal = frame_at(face, [0.0; 2])[0];
    let base: f64 = face
        .iter()
        .map(|c| normal.dot(&Vector3::from(*c)))
        .sum::<f64>()
        / 4.0;
    let mean: f64 = corners
        .iter()
        .map(|c| normal.dot(&Vector3::from(*c)))
        .sum::<f64>()
        / 8.0;
    2.0 * (mean - base).abs()
}
