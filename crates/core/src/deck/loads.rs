//! Named loads: where they act, and their values in the steps.

mod place;

use super::bodies::Bodies;
use super::schema::{Deck, DeckLoad, Names};
use crate::element::facet;
use crate::element::hexahedron::norm;
use crate::error::{Errors, ModelError, Warning};
use crate::model::loads::{Load, LoadOn};
use crate::model::scene::Step;
use place::{Place, Site};
use std::collections::HashMap;

/// Loads of a deck, and their values in the steps.
#[derive(Debug, Default)]
pub(super) struct Named {
    loads: Vec<Load>,
    /// Value at the end of each step; none if it does not change. `[step][load]`
    values: Vec<Vec<Option<[f64; 3]>>>,
    /// Warnings about the faces on which they act.
    pub(super) warnings: Vec<Warning>,
}

/// Part of the area on which a load acts by which it may be wrong unnoticed.
const WRONG_AREA: f64 = 0.01;

impl Named {
    /// Loads in the order in which steps first name them.
    pub(super) fn all(&self) -> &[Load] {
        &self.loads
    }

    /// Gives the steps their values and returns the loads.
    pub(super) fn assign(self, steps: &mut [Step]) -> Vec<Load> {
        for (step, values) in steps.iter_mut().zip(self.values) {
            step.loads = values;
        }
        self.loads
    }
}

/// Reads the loads of a scene.
///
/// # Errors
/// Unknown names; points and lines far from all nodes.
pub(super) fn loads(deck: &Deck, bodies: &Bodies<'_>) -> Result<Named, ModelError> {
    let place = |path: &str, names: &Names, faces: bool| {
        let places = bodies.places(path, names, faces)?;
        let (mut facets, mut excess) = (Vec::new(), 0.0);
        for place in &places {
            let (open, beyond) = bodies.open_facets(*place);
            facets.extend(open);
            excess += beyond;
        }
        if facets.is_empty() {
            facets.extend(places.iter().flat_map(|place| bodies.facets(*place)));
        }
        let whole = places.iter().filter(|place| place.face.is_none()).count();
        Ok(Place {
            nodes: bodies.nodes(&places),
            mixed: whole > 0 && whole < places.len(),
            facets: facets.into_iter().map(|(_, facet)| facet).collect(),
            excess,
        })
    };
    named(deck, &Site::new(deck, &bodies.mesh, &place))
}

fn named(deck: &Deck, site: &Site<'_>) -> Result<Named, ModelError> {
    let mut all = Named {
        values: vec![Vec::new(); deck.steps.len()],
        ..Named::default()
    };
    let mut errors = Errors::default();
    let mut places: HashMap<&str, usize> = HashMap::new();
    for (s, step) in deck.steps.iter().enumerate() {
        for (l, load) in step.loads.iter().enumerate() {
            let path = format!("steps.{s}.loads.{l}");
            let Some((_, value)) = load.value() else {
                continue;
            };
            let index = if let Some(index) = places.get(load.name.as_str()) {
                *index
            } else {
                let new = new_load(site, &path, load);
                let Some(new) = errors.keep(new) else {
                    continue;
                };
                all.warnings.extend(site.wrong_area(&path, load));
                places.insert(&load.name, all.loads.len());
                all.loads.push(new);
                all.loads.len() - 1
            };
            let known = &mut all.loads[index];
            if known.direction == [0.0; 3] && matches!(known.acts, LoadOn::Shares(_)) {
                known.direction = unit(value);
            }
            let values = &mut all.values[s];
            values.resize(values.len().max(index + 1), None);
            values[index] = Some(value);
        }
    }
    for values in &mut all.values {
        values.resize(all.loads.len(), None);
    }
    errors.end(all)
}

/// Builds a load that is named for the first time.
fn new_load(site: &Site<'_>, path: &str, load: &DeckLoad) -> Result<Load, ModelError> {
    let (acts, direction) = if load.pressure.is_some() {
        let facets = site.facets(path, load)?;
        let areas = site.area_vectors(&facets);
        let sum = areas
            .iter()
            .fold([0.0; 3], |sum, (_, a)| [0, 1, 2].map(|i| sum[i] - a[i]));
        // The area vectors of a closed surface sum to zero but for rounding.
        let size: f64 = areas.iter().map(|(_, a)| norm(*a)).sum();
        let direction = if norm(sum) > 1e-9 * size {
            unit(sum)
        } else {
            [0.0; 3]
        };
        if load.follower.unwrap_or(true) {
            (LoadOn::Follower(facets), direction)
        } else {
            (LoadOn::Pressure(areas), direction)
        }
    } else if load.traction.is_some() {
        let facets = site.facets(path, load)?;
        (LoadOn::Shares(site.areas(&facets)), [0.0; 3])
    } else if load.line_force.is_some() {
        (LoadOn::Shares(site.lengths(path, load)?), [0.0; 3])
    } else {
        let mut shares = site.shares(path, load)?;
        let whole: f64 = shares.iter().map(|share| share.1).sum();
        for (_, share) in &mut shares {
            *share /= whole;
        }
        (LoadOn::Shares(shares), [0.0; 3])
    };
    Ok(Load {
        name: load.name.clone(),
        columns: load.columns(),
        direction,
        acts,
    })
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = norm(v);
    if length > 0.0 {
        v.map(|x| x / length)
    } else {
        v
    }
}

impl Site<'_> {
    /// A warning about a pressure or traction on facets that another wall covers in part.
    fn wrong_area(&self, path: &str, load: &DeckLoad) -> Option<Warning> {
        if load.pressure.is_none() && load.traction.is_none() {
            return None;
        }
        let on = self.on(path, load, true).ok()?;
        let areas = self.areas(&on.facets);
        let total: f64 = areas.iter().map(|(_, area)| area).sum();
        (on.excess.abs() > WRONG_AREA * total).then(|| {
            let message = format!(
                "the load acts on {total:.4e} mm^2, and {:.4e} mm^2 of these faces are not covered by other walls: facets count \
                 whole or not at all; a finer mesh comes nearer",
                total - on.excess
            );
            self.deck.warning(&format!("{path}.on"), message)
        })
    }

    /// ∫ N n dA of the nodes of the facets at rest [mm²].
    fn area_vectors(&self, facets: &[[u32; 4]]) -> Vec<(u32, [f64; 3])> {
        let of = facets.iter().flat_map(|facet| {
            let x = facet.map(|n| self.mesh.nodes[n as usize]);
            facet.iter().copied().zip(facet::area_vectors(&x))
        });
        place::summed(of, |sum, a| [0, 1, 2].map(|i| sum[i] + a[i]))
    }

    /// ∫ N dA of the nodes of the facets at rest [mm²].
    fn areas(&self, facets: &[[u32; 4]]) -> Vec<(u32, f64)> {
        let of = facets.iter().flat_map(|facet| {
            let x = facet.map(|n| self.mesh.nodes[n as usize]);
            facet.iter().copied().zip(facet::areas(&x))
        });
        place::summed(of, |sum, a| sum + a)
    }

    /// Weights by which a force is distributed: areas of faces, volumes of blocks, lengths along a line, or one
    /// node.
    fn shares(&self, path: &str, load: &DeckLoad) -> Result<Vec<(u32, f64)>, ModelError> {
        if load.from.is_some() {
            return self.lengths(path, load);
        }
        if let Some(near) = load.near {
            return Ok(vec![(self.nearest(path, load, near)?, 1.0)]);
        }
        let on = self.on(path, load, false)?;
        if on.facets.is_empty() {
            Ok(self.volumes(&on.nodes))
        } else {
            Ok(self.areas(&on.facets))
        }
    }
}
