//! Mirror images of the nodes, elements and facets of a model in a plane.

use rustc_hash::{FxBuildHasher, FxHashMap};
use std::hash::Hash;

use crate::model::Model;
use crate::model::scene::ContactSurfaces;
use wythe_contact::Part;
use wythe_contact::surface::weights_at;

/// Largest distance of coinciding places, over the diagonal of the model.
const SAME: f64 = 1e-7;
/// Resolution of the weights by which the middles of a facet's parts are distinguished: one over this number.
const PLACES: f64 = 1e6;

/// A plane in which a mesh and its joints are mirrored, and their images. Elements and facets across it are their own
/// images, and so is a joint in it between a body and its image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Images {
    /// Axis normal to the plane.
    pub axis: usize,
    /// Coordinate of the plane on it [mm].
    pub at: f64,
    /// Image of each node, itself if it lies in the plane and its body across it. `[node]`
    pub node: Vec<u32>,
    /// Side of each node: −1 below the plane, 1 above, 0 if it is its own image. A node in the plane whose image belongs
    /// to another body is on the side of its body. `[node]`
    pub side: Vec<i8>,
    /// Whether each node lies in the plane. `[node]`
    lies_in: Vec<bool>,
    /// Image of each element. `[element]`
    pub element: Vec<u32>,
    /// Image of each slave facet. `[facet]`
    pub slave: Vec<u32>,
}

impl Images {
    /// Images in the plane through the middle of the model normal to an axis. None unless mesh, materials and joints
    /// are mirrored.
    pub fn of(model: &Model, axis: usize) -> Option<Self> {
        let mesh = &model.mesh;
        // A half with images beyond a plane would be mirrored in that plane again.
        if mesh.reflected.iter().any(|image| image.sign[axis] < 0.0) {
            return None;
        }
        let [low, high] = mesh.extent(axis);
        let (at, unit) = (0.5 * (low + high), SAME * mesh.diagonal());
        if !(unit > 0.0 && unit.is_finite()) {
            return None;
        }
        let side = |x: &[f64; 3]| {
            let beyond = x[axis] - at;
            i8::from(beyond > unit) - i8::from(beyond < -unit)
        };
        let side: Vec<i8> = mesh.nodes.iter().map(side).collect();
        let mut images = Self {
            axis,
            at,
            node: Vec::new(),
            lies_in: side.iter().map(|side| *side == 0).collect(),
            side,
            element: Vec::new(),
            slave: Vec::new(),
        };
        images.of_nodes(model, unit)?;
        images.element = images.of_elements(model)?;
        images.slave = images.of_facets(&model.contact)?;
        Some(images)
    }

    /// Whether an element or facet with these nodes is on the kept side or across the plane.
    pub fn keeps(&self, nodes: &[u32]) -> bool {
        let side = |n: &u32| self.side[*n as usize];
        nodes.iter().all(|n| side(n) <= 0) || self.lies_across(nodes)
    }

    /// Whether a facet with these nodes lies in the plane: a face of a body that touches its image there.
    pub fn lies_in(&self, nodes: &[u32]) -> bool {
        nodes.iter().all(|n| self.lies_in[*n as usize])
    }

    /// Whether nodes lie on both sides.
    pub fn lies_across(&self, nodes: &[u32]) -> bool {
        let side = |n: &u32| self.side[*n as usize];
        nodes.iter().any(|n| side(n) < 0) && nodes.iter().any(|n| side(n) > 0)
    }

    /// Mirror image of a vector.
    pub fn of_vector(&self, mut v: [f64; 3]) -> [f64; 3] {
        v[self.axis] = -v[self.axis];
        v
    }

    /// Whether the images of these nodes are among them.
    pub fn hold_together(&self, nodes: &[u32]) -> bool {
        let mut own = nodes.to_vec();
        own.sort_unstable();
        nodes
            .iter()
            .all(|n| own.binary_search(&self.node[*n as usize]).is_ok())
    }

    /// Finds the images of nodes, and the sides of nodes in the plane. Nodes of several bodies may coincide, so images
    /// are searched body by body.
    fn of_nodes(&mut self, model: &Model, unit: f64) -> Option<()> {
        let mesh = &model.mesh;
        // Coordinates of decks are round numbers. The offset keeps them away from the bounds of cells.
        let cell = |x: [f64; 3]| x.map(|x| (x / unit + 0.37).floor() as i64);
        let axis = self.axis;
        let relative = |mut x: [f64; 3]| {
            x[axis] -= self.at;
            x
        };
        let mut body = vec![u32::MAX; mesh.nodes.len()];
        let bodies = mesh.unit.iter().max().map_or(0, |b| *b as usize + 1);
        let mut centre = vec![[0.0; 4]; bodies];
        for (nodes, &b) in mesh.elements.iter().zip(&mesh.unit) {
            for &n in nodes {
                body[n as usize] = b;
                let sum = &mut centre[b as usize];
                (0..3).for_each(|i| sum[i] += mesh.nodes[n as usize][i]);
                sum[3] += 1.0;
            }
        }
        // Bodies without elements, if units are not numbered in sequence, are their own images.
        let is_body = |b: &usize| centre[*b][3] > 0.0;
        let centre = |b: usize| relative([0, 1, 2].map(|i| centre[b][i] / centre[b][3]));
        let all = || (0..bodies).filter(is_body);
        let at = unique(all().map(|b| (cell(centre(b)), b as u32)))?;
        let image = |b: usize| {
            let found = || at.get(&cell(self.of_vector(centre(b)))).copied();
            if is_body(&b) { found() } else { Some(b as u32) }
        };
        let image = (0..bodies).map(image).collect::<Option<Vec<u32>>>()?;
        // A node without an element is that of an image beyond another plane, or represents the other half of a joint.
        let place = |n: usize| {
            let x = relative(mesh.nodes[n]);
            if body[n] != u32::MAX {
                return Some((body[n], [1.0; 3], x));
            }
            let original = mesh.reflected(n as u32)?;
            Some((body[original.of as usize], original.sign, x))
        };
        let places = (0..mesh.nodes.len()).map(place);
        let places = places.collect::<Option<Vec<_>>>()?;
        let signs = |sign: [f64; 3]| sign.map(|sign| sign < 0.0);
        let key = |b: u32, sign: [f64; 3], x: [f64; 3]| (b, signs(sign), cell(x));
        let numbered = places.iter().zip(0_u32..);
        let at = unique(numbered.map(|((b, sign, x), n)| (key(*b, *sign, *x), n)))?;
        let found = places.iter().map(|(b, sign, x)| {
            let there = key(image[*b as usize], *sign, self.of_vector(*x));
            at.get(&there).copied()
        });
        self.node = found.collect::<Option<Vec<u32>>>()?;
        for (n, (b, ..)) in places.iter().enumerate() {
            if self.side[n] == 0 && self.node[n] as usize != n {
                self.side[n] = if centre(*b as usize)[axis] < 0.0 {
                    -1
                } else {
                    1
                };
            }
        }
        Some(())
    }

    fn of_elements(&self, model: &Model) -> Option<Vec<u32>> {
        let mesh = &model.mesh;
        let at = mesh.elements.iter().enumerate();
        let at = unique(at.map(|(e, nodes)| (sorted(*nodes), e as u32)))?;
        let image = |(e, nodes): (usize, &[u32; 8])| {
            let image = *at.get(&sorted(nodes.map(|n| self.node[n as usize])))?;
            let alike = mesh.material[e] == mesh.material[image as usize];
            let whole = image as usize == e || !self.lies_across(nodes);
            (alike && whole).then_some(image)
        };
        mesh.elements.iter().enumerate().map(image).collect()
    }

    /// Master facets only need to exist.
    fn of_facets(&self, contact: &ContactSurfaces) -> Option<Vec<u32>> {
        let image = |facets: &[[u32; 4]], part: &dyn Fn(usize) -> Part| {
            let place = |f: usize, nodes: [u32; 4]| {
                let weights = weights_at(part(f).middle);
                let mut place =
                    [0, 1, 2, 3].map(|a| (nodes[a], (weights[a] * PLACES).round() as i64));
                place.sort_unstable();
                place
            };
            let at = facets.iter().enumerate();
            let at = unique(at.map(|(f, nodes)| (place(f, *nodes), f as u32)))?;
            let image = |(f, nodes): (usize, &[u32; 4])| {
                if self.lies_in(nodes) {
                    // The other face of a joint in the plane is the image of this one.
                    let parts = nodes.iter().all(|n| self.node[*n as usize] != *n);
                    return parts.then_some(f as u32);
                }
                let seen = nodes.map(|n| self.node[n as usize]);
                let whole = sorted(seen) == sorted(*nodes) || !self.lies_across(nodes);
                at.get(&place(f, seen)).copied().filter(|_| whole)
            };
            facets
                .iter()
                .enumerate()
                .map(image)
                .collect::<Option<Vec<u32>>>()
        };
        image(&contact.master_facets, &|_| Part::WHOLE)?;
        let slave = image(&contact.slave_facets, &|f| contact.part(f))?;
        let law = |f: usize| &contact.laws[usize::from(contact.slave_law[f])];
        let alike = |(f, image): (usize, &u32)| law(f) == law(*image as usize);
        slave.iter().enumerate().all(alike).then_some(slave)
    }
}

/// Map by key. None if two entries have the same key. Collisions by intent need no protection, since places and nodes
/// come from a mesh.
fn unique<K: Eq + Hash>(entries: impl Iterator<Item = (K, u32)>) -> Option<FxHashMap<K, u32>> {
    let mut map = FxHashMap::with_capacity_and_hasher(entries.size_hint().0, FxBuildHasher);
    for (key, value) in entries {
        if map.insert(key, value).is_some() {
            return None;
        }
    }
    Some(map)
}

fn sorted<const N: usize>(mut nodes: [u32; N]) -> [u32; N] {
    nodes.sort_unstable();
    nodes
}
