//! Sides of elements: the exterior ones, those that a set of a file denotes, and the connected bodies.

use std::collections::BTreeMap;

use super::{ImportedMesh, find};

/// Local nodes of the sides S1 to S6 of a hex8 in Abaqus numbering: the order of its faces in wythe.
pub use crate::element::hex8::FACES as SIDES;

/// Connected bodies of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bodies {
    /// Body of each element, numbered in the order of first elements. `[element]`
    pub of_element: Vec<u32>,
    /// Names of the bodies: that of the instance if the body is the whole instance, else `0`, `1`, … or
    /// `INSTANCE-0`, ….
    pub names: Vec<String>,
}

impl ImportedMesh {
    /// Nodes of a side, counter-clockwise seen from outside.
    pub fn facet(&self, (element, side): (u32, u8)) -> [u32; 4] {
        SIDES[usize::from(side)].map(|n| self.elements[element as usize][n])
    }

    /// Exterior sides: those of one element only, in the order of element and side.
    ///
    /// # Errors
    /// The third element that has a side in common with two others.
    pub fn exterior(&self) -> Result<Vec<(u32, u8)>, u32> {
        let mut all = Vec::with_capacity(6 * self.elements.len());
        for e in 0..self.elements.len() as u32 {
            for side in 0..6 {
                let mut nodes = self.facet((e, side));
                nodes.sort_unstable();
                all.push((nodes, e, side));
            }
        }
        all.sort_unstable();
        let mut outside = Vec::new();
        for same in all.chunk_by(|a, b| a.0 == b.0) {
            match same {
                [(_, e, side)] => outside.push((*e, *side)),
                [_, _] => {}
                _ => return Err(same[2].1),
            }
        }
        outside.sort_unstable();
        Ok(outside)
    }

    /// Nodes that `name` denotes, ascending. Names are searched in this order: set of nodes, surface, set of
    /// elements, instance.
    pub fn nodes_of(&self, name: &str) -> Option<Vec<u32>> {
        let of_elements = |elements: &mut dyn Iterator<Item = u32>| -> Vec<u32> {
            elements
                .flat_map(|e| self.elements[e as usize])
                .collect::<Vec<u32>>()
        };
        let mut nodes = if let Some(set) = get(&self.node_sets, name) {
            set.clone()
        } else if let Some(surface) = get(&self.surfaces, name) {
            surface.iter().flat_map(|&s| self.facet(s)).collect()
        } else if let Some(set) = get(&self.element_sets, name) {
            of_elements(&mut set.iter().copied())
        } else {
            of_elements(&mut self.elements_of_instance(name)?.into_iter())
        };
        nodes.sort_unstable();
        nodes.dedup();
        Some(nodes)
    }

    /// Sides that `name` denotes: those of a surface, or else the sides of `outside` whose nodes are all in the set
    /// of nodes, or whose elements are in the set of elements, of this name.
    pub fn facets_of(&self, name: &str, outside: &[(u32, u8)]) -> Option<Vec<(u32, u8)>> {
        if let Some(surface) = get(&self.surfaces, name) {
            return Some(surface.clone());
        }
        if let Some(set) = get(&self.node_sets, name) {
            return Some(self.sides_between(set, outside));
        }
        let elements = match get(&self.element_sets, name) {
            Some(set) => set.clone(),
            None => self.elements_of_instance(name)?,
        };
        let mut inside = vec![false; self.elements.len()];
        for e in elements {
            inside[e as usize] = true;
        }
        let of_set = outside.iter().filter(|(e, _)| inside[*e as usize]);
        Some(of_set.copied().collect())
    }

    /// Sides of `outside` whose nodes are all in `nodes`.
    pub(super) fn sides_between(&self, nodes: &[u32], outside: &[(u32, u8)]) -> Vec<(u32, u8)> {
        let mut inside = vec![false; self.nodes.len()];
        for n in nodes {
            inside[*n as usize] = true;
        }
        let all = |s: &&(u32, u8)| self.facet(**s).iter().all(|n| inside[*n as usize]);
        outside.iter().filter(all).copied().collect()
    }

    /// Elements of a set of elements, or of an instance.
    pub fn elements_of(&self, name: &str) -> Option<Vec<u32>> {
        match get(&self.element_sets, name) {
            Some(set) => Some(set.clone()),
            None => self.elements_of_instance(name),
        }
    }

    /// Names of sets of elements and of instances.
    pub fn names_of_elements(&self) -> Vec<&str> {
        let all = self.element_sets.keys().chain(&self.instances);
        all.map(String::as_str).collect()
    }

    /// All names of sets, surfaces and instances, each once.
    pub fn names(&self) -> Vec<&str> {
        let sets = self.node_sets.keys().chain(self.element_sets.keys());
        let all = sets.chain(self.surfaces.keys()).chain(&self.instances);
        let mut names: Vec<&str> = all.map(String::as_str).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Elements of an instance.
    fn elements_of_instance(&self, name: &str) -> Option<Vec<u32>> {
        let name = find(name, self.instances.iter().map(String::as_str))?;
        let of = |e: &u32| {
            self.element_instance[*e as usize]
                .is_some_and(|i| self.instances[usize::from(i)] == name)
        };
        Some((0..self.elements.len() as u32).filter(of).collect())
    }

    /// Divides the mesh into bodies: elements connected by common nodes.
    pub fn bodies(&self) -> Bodies {
        let mut parent: Vec<u32> = (0..self.nodes.len() as u32).collect();
        for nodes in &self.elements {
            let mut low = root(&mut parent, nodes[0]);
            for &n in &nodes[1..] {
                let other = root(&mut parent, n);
                let high = low.max(other);
                low = low.min(other);
                parent[high as usize] = low;
            }
        }
        let mut number: BTreeMap<u32, u32> = BTreeMap::new();
        let mut instance = Vec::new();
        let mut of_element = Vec::with_capacity(self.elements.len());
        for (e, nodes) in self.elements.iter().enumerate() {
            let root = root(&mut parent, nodes[0]);
            let next = number.len() as u32;
            let body = *number.entry(root).or_insert(next);
            if body == next {
                instance.push(self.element_instance[e]);
            }
            of_element.push(body);
        }
        Bodies {
            of_element,
            names: self.body_names(&instance),
        }
    }

    fn body_names(&self, instance: &[Option<u16>]) -> Vec<String> {
        let mut count = vec![0_usize; self.instances.len()];
        for i in instance.iter().flatten() {
            count[usize::from(*i)] += 1;
        }
        let mut met = vec![0_usize; self.instances.len()];
        let mut flat = 0;
        let mut names = Vec::with_capacity(instance.len());
        for i in instance {
            names.push(if let Some(i) = i.map(usize::from) {
                met[i] += 1;
                let name = &self.instances[i];
                if count[i] == 1 {
                    name.clone()
                } else {
                    format!("{name}-{}", met[i] - 1)
                }
            } else {
                flat += 1;
                (flat - 1).to_string()
            });
        }
        names
    }
}

/// The set that `name` denotes.
fn get<'a, T>(sets: &'a BTreeMap<String, T>, name: &str) -> Option<&'a T> {
    // Most names are written as in the file.
    sets.get(name)
        .or_else(|| sets.get(find(name, sets.keys().map(String::as_str))?))
}

/// Root of the tree of a node.
pub(in crate::deck) fn root(parent: &mut [u32], node: u32) -> u32 {
    let mut node = node;
    while parent[node as usize] != node {
        let above = parent[node as usize];
        parent[node as usize] = parent[above as usize];
        node = above;
    }
    node
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::hex8::CORNERS;
    use crate::element::hexahedron::{area_vector, difference, dot, mean};

    #[test]
    fn sides_look_outwards() {
        for side in SIDES {
            let x = side.map(|n| CORNERS[n]);
            let middle = mean(&x);
            // The element is centred at the origin; its sides have area 4 at distance 1.
            assert_eq!(dot(area_vector(&x), middle), 4.0, "{side:?}");
            assert_eq!(dot(difference(x[0], middle), middle), 0.0);
        }
    }

    #[test]
    fn connected_elements_form_a_body() {
        let cube = |first: u32| std::array::from_fn(|n| first + n as u32);
        let mut mesh = ImportedMesh {
            nodes: vec![[0.0; 3]; 20],
            // The third element shares the last four nodes of the first.
            elements: vec![cube(0), cube(8), [4, 5, 6, 7, 16, 17, 18, 19]],
            element_instance: vec![None; 3],
            ..ImportedMesh::default()
        };
        assert_eq!(mesh.bodies().of_element, [0, 1, 0]);
        assert_eq!(mesh.bodies().names, ["0", "1"]);
        assert_eq!(mesh.exterior().unwrap().len(), 16);
        mesh.instances = vec!["A".to_owned(), "B".to_owned()];
        mesh.element_instance = vec![Some(0), Some(1), Some(0)];
        assert_eq!(mesh.bodies().names, ["A", "B"]);
        mesh.element_instance = vec![Some(0); 3];
        assert_eq!(mesh.bodies().names, ["A-0", "A-1"]);
        mesh.elements.push(mesh.elements[2]);
        mesh.element_instance.push(None);
        assert_eq!(mesh.exterior(), Err(3));
    }
}
