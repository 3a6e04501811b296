//! Interface surfaces as quads: each slave facet, or each part of one, is divided into four around its contact
//! points.

use super::QUAD;
use super::grid::Geometry;
use crate::model::Model;
use crate::results::quarters::{QUARTERS, WEIGHTS};
use wythe_contact::Part;

/// Quads of the interfaces.
#[derive(Debug)]
pub struct Quarters {
    facets: Vec<[u32; 4]>,
    parts: Vec<Part>,
    law: Vec<u16>,
    rest: Vec<[f64; 3]>,
}

impl Quarters {
    /// Quads of a model; `None` without interfaces.
    pub fn of(model: &Model) -> Option<Self> {
        let facets = model.contact.slave_facets.clone();
        let mut quarters = Self {
            parts: (0..facets.len()).map(|f| model.contact.part(f)).collect(),
            law: model.contact.slave_law.clone(),
            facets,
            rest: Vec::new(),
        };
        quarters.rest = quarters.spread(&model.mesh.nodes).ok()?;
        (!quarters.facets.is_empty()).then_some(quarters)
    }

    /// Geometry at rest.
    pub fn geometry(&self) -> Geometry {
        let connectivity = (0..self.facets.len() as i64)
            .flat_map(|f| QUARTERS.into_iter().flatten().map(move |k| 9 * f + k))
            .collect();
        Geometry {
            points: self.rest.clone(),
            connectivity,
            corners: 4,
            kind: QUAD,
        }
    }

    /// Facet and law of each quad.
    pub fn labels(&self) -> [(&'static str, Vec<i64>); 2] {
        let four =
            |of: &dyn Fn(usize) -> i64| (0..self.facets.len()).flat_map(|f| [of(f); 4]).collect();
        [
            ("facet", four(&|f| f as i64)),
            ("law", four(&|f| self.law[f].into())),
        ]
    }

    /// Interpolates a nodal field to the points of the quads. `[facet][9]`
    ///
    /// # Errors
    /// The field has no row for one of the nodes.
    pub fn spread(&self, field: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, String> {
        let mut points = Vec::with_capacity(9 * self.facets.len());
        for (facet, part) in self.facets.iter().zip(&self.parts) {
            let mut corners = [[0.0; 3]; 4];
            for (corner, &n) in corners.iter_mut().zip(facet) {
                let Some(value) = field.get(n as usize) else {
                    let message = format!("displacement: {} rows, node {n} has none", field.len());
                    return Err(message);
                };
                *corner = *value;
            }
            let corners = part.of(&corners);
            for weights in WEIGHTS {
                let at = |i: usize| (0..4).map(|a| weights[a] * corners[a][i]).sum();
                points.push([at(0), at(1), at(2)]);
            }
        }
        Ok(points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::hexahedron::{area_vector, norm};
    use crate::results::fake;

    /// The quads of the parts cover the facet, each around its contact point.
    #[test]
    fn quads_of_parts_fill_the_facet() {
        let mut model = fake::model();
        model.contact.slave_facets = vec![[1, 2, 6, 5]; 6];
        model.contact.slave_law = vec![0; 6];
        model.contact.slave_part = Part::grid([3, 2]).collect();
        let whole = area_vector(&[1, 2, 6, 5].map(|n: usize| model.mesh.nodes[n]));
        let quarters = Quarters::of(&model).unwrap();
        let geometry = quarters.geometry();
        let areas: Vec<f64> = (geometry.connectivity.chunks_exact(4))
            .map(|quad| {
                norm(area_vector(
                    &[0, 1, 2, 3].map(|k| geometry.points[quad[k] as usize]),
                ))
            })
            .collect();
        assert_eq!(areas.len(), 24);
        for area in areas {
            assert!((24.0 * area / norm(whole) - 1.0).abs() < 1e-12, "{area}"); // rounding
        }
    }
}
