//! Bodies that stand within each other at the end of a run. Planned contact knows the faces that are paired alone: a
//! body that comes upon another face enters the other body.

use std::collections::HashSet;

use wythe_contact::surface::{blend, weights_at};
use wythe_contact::{Aabb, Bvh};

use super::run::Run;
use crate::element::exterior::exterior_faces;
use crate::element::hex8::{CORNERS, FACES};
use crate::element::inside::{natural, weights};
use crate::model::mesh::Mesh;

/// Depth that is reported, over the shortest edge of both bodies [-].
const DEEP: f64 = 0.02;
/// The same of bodies that press on each other. Their contact points lie within the facets, so corners enter where a
/// joint turns: by up to 0.02 in walls that rock, fall or are crushed.
const DEEP_IN_CONTACT: f64 = 0.1;

/// Parameters of the points of a face that are looked for in other bodies [-]. Edges are often flush with those of
/// another body.
const AT: f64 = 0.8;

/// A point of a face within an element of another body.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entered {
    /// Body of the face.
    body: u32,
    /// Place of the point at rest [mm].
    rest: [f64; 3],
    /// The element that it entered.
    element: u32,
    /// Distance to the nearest exterior face of the element [mm].
    depth: f64,
}

impl Run<'_> {
    /// Warning, if bodies stand within each other and did not at rest.
    pub(in crate::solve) fn entered_bodies(&self) -> Option<String> {
        let mesh = &self.model.mesh;
        let mut x = vec![[0.0; 3]; mesh.nodes.len()];
        self.system.dofs.spread(&self.state.q, &mut x);
        for (x, rest) in x.iter_mut().zip(&mesh.nodes) {
            *x = [0, 1, 2].map(|i| x[i] + rest[i]);
        }
        // Joints close under pressure, and by more where they are crushed.
        let closed = self.state.interface.iter().map(|h| -h.opening);
        let closed = closed.fold(0.0, f64::max);
        let bodies = bodies(mesh);
        let body = |facet: &[u32; 4]| bodies[facet[0] as usize];
        let contact = &self.model.contact;
        let facets = contact.slave_facets.iter().flat_map(|facet| [facet; 4]);
        let met = facets.zip(&self.state.pairs).filter_map(|(slave, pair)| {
            let master = &contact.master_facets[pair.facet? as usize];
            Some((body(slave)?, body(master)?))
        });
        let met: HashSet<(u32, u32)> = met.flat_map(|(a, b)| [(a, b), (b, a)]).collect();
        let general = contact.general.is_some();
        let edges = mesh.smallest_edges();
        let least = |a: u32, b: u32| {
            let part = if general || met.contains(&(a, b)) {
                DEEP_IN_CONTACT
            } else {
                DEEP
            };
            let edge = edges[a as usize].min(edges[b as usize]);
            (part * edge).max(2.0 * closed)
        };
        let found = deepest(mesh, &x, &least)?;
        let [a, b, c] = found.rest;
        Some(format!(
            "{} stands {:.3} mm within {} at the end, with its point that was at ({a:.1}, {b:.1}, {c:.1}) mm: {}",
            mesh.called(found.body),
            found.depth,
            mesh.body_of(found.element as usize),
            if general {
                "smaller increments keep them apart"
            } else {
                "only faces that are paired meet; contact.general lets all faces meet"
            }
        ))
    }
}

/// Body of each node. `[node]`
fn bodies(mesh: &Mesh) -> Vec<Option<u32>> {
    let mut bodies = vec![None; mesh.nodes.len()];
    for (nodes, body) in mesh.elements.iter().zip(&mesh.unit) {
        for node in nodes {
            bodies[*node as usize] = Some(*body);
        }
    }
    bodies
}

/// The deepest of the points of the exterior faces with nodes at `x` that are farther within another body than at rest, by more
/// than a length that depends on both bodies [mm].
fn deepest(mesh: &Mesh, x: &[[f64; 3]], least: &dyn Fn(u32, u32) -> f64) -> Option<Entered> {
    let faces = exterior_faces(&mesh.elements, |e| mesh.unit[e]);
    let mut exterior = vec![[false; FACES.len()]; mesh.elements.len()];
    for &(e, face) in &faces {
        exterior[e as usize][usize::from(face)] = true;
    }
    let corners = |e: usize, x: &[[f64; 3]]| mesh.elements[e].map(|n| x[n as usize]);
    let boxes: Vec<Aabb> = (0..mesh.elements.len())
        .map(|e| Aabb::of(&corners(e, x)))
        .collect();
    let bvh = Bvh::build(&boxes);
    let (mut stack, mut deepest) = (Vec::new(), None::<Entered>);
    for (own, face) in &faces {
        let own = *own as usize;
        let nodes = FACES[usize::from(*face)].map(|corner| mesh.elements[own][corner] as usize);
        for xi in [[-AT, -AT], [AT, -AT], [AT, AT], [-AT, AT]] {
            let weights = weights_at(xi);
            let at = |x: &[[f64; 3]]| -> [f64; 3] { blend(&weights, &nodes.map(|n| x[n])).into() };
            let (now, rest) = (at(x), at(&mesh.nodes));
            bvh.query(&boxes, &Aabb::of(&[now]), &mut stack, |element| {
                let e = element as usize;
                let bodies = [mesh.unit[own], mesh.unit[e]];
                if bodies[0] == bodies[1] {
                    return;
                }
                let Some(depth_now) = depth(&corners(e, x), now, &exterior[e]) else {
                    return;
                };
                let before = depth(&corners(e, &mesh.nodes), rest, &exterior[e]).unwrap_or(0.0);
                let depth = depth_now - before;
                if depth > least(bodies[0], bodies[1]) && deepest.is_none_or(|d| d.depth < depth) {
                    deepest = Some(Entered {
                        body: bodies[0],
                        rest,
                        element,
                        depth,
                    });
                }
            });
        }
    }
    deepest
}

/// Distance of a point within an element to its nearest exterior face [mm]. None outside, and in elements without
/// exterior faces, into which nothing comes but through others.
fn depth(corners: &[[f64; 3]; 8], point: [f64; 3], exterior: &[bool; 6]) -> Option<f64> {
    let xi = natural(corners, point).filter(|xi| xi.iter().all(|xi| xi.abs() < 1.0))?;
    let at = |xi: [f64; 3]| {
        let n = weights(xi);
        [0, 1, 2].map(|i| (0..8).map(|a| n[a] * corners[a][i]).sum::<f64>())
    };
    let apart = |a: [f64; 3], b: [f64; 3]| {
        let squares = (0..3).map(|i| (a[i] - b[i]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let faces = FACES.iter().zip(exterior).filter(|(_, is)| **is);
    let depths = faces.filter_map(|(face, _)| {
        let [first, rest @ ..] = face.map(|corner| CORNERS[corner]);
        let axis = (0..3).find(|d| rest.iter().all(|c| c[*d] == first[*d]))?;
        let mut foot = xi;
        foot[axis] = first[axis];
        Some(apart(point, at(foot)))
    });
    depths.min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of 100 mm.
    fn cube() -> [[f64; 3]; 8] {
        CORNERS.map(|c| c.map(|c| 50.0 * c))
    }

    #[test]
    fn the_depth_is_that_below_the_nearest_exterior_face() {
        let all = [true; 6];
        let deep = depth(&cube(), [20.0, 0.0, 47.0], &all).unwrap();
        // Rounding of Newton's method, 1e-12 of an edge.
        assert!((deep - 3.0).abs() < 1e-9, "{deep}");
        assert_eq!(depth(&cube(), [20.0, 0.0, 51.0], &all), None);
        assert_eq!(depth(&cube(), [20.0, 0.0, 47.0], &[false; 6]), None);
    }
}
