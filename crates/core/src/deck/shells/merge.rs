//! Merges coplanar faces of a shell into polygons.

use super::polyhedron::{Fault, Plane, Polyhedron};
use super::split::area_vector;
use crate::element::hexahedron::{cross, difference, dot, norm};
use rustc_hash::FxHashMap;

/// Least product of the unit normals of coplanar faces: slivers are compared by their corners only.
const SAME_WAY: f64 = 0.9;

/// The polyhedron of a closed shell, whose faces lie in one plane if their corners do within `flat` [mm]. Each region
/// grows from its largest face, whose plane decides.
pub(super) fn merged(
    vertices: &[[f64; 3]],
    faces: &[Vec<u32>],
    flat: f64,
) -> Result<Polyhedron, Fault> {
    let mut of_edge: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    for (f, face) in faces.iter().enumerate() {
        for (i, a) in face.iter().enumerate() {
            let b = face[(i + 1) % face.len()];
            if of_edge.insert((*a, b), f as u32).is_some() {
                return Err(Fault::Holes);
            }
        }
    }
    let regions = Regions {
        vertices,
        faces,
        of_edge: &of_edge,
        flat,
    };
    let region = regions.grow();
    let loops = regions.outlines(&region)?;
    regions.polyhedron(loops)
}

struct Regions<'a> {
    vertices: &'a [[f64; 3]],
    faces: &'a [Vec<u32>],
    of_edge: &'a FxHashMap<(u32, u32), u32>,
    flat: f64,
}

impl Regions<'_> {
    fn at(&self, n: u32) -> [f64; 3] {
        self.vertices[n as usize]
    }

    /// Faces on the other sides of the edges of a face.
    fn neighbours(&self, f: u32) -> impl Iterator<Item = u32> + '_ {
        let face = &self.faces[f as usize];
        let edges = (0..face.len()).map(|i| (face[(i + 1) % face.len()], face[i]));
        edges.filter_map(|edge| self.of_edge.get(&edge).copied())
    }

    /// Region of each face.
    fn grow(&self) -> Vec<u32> {
        let areas: Vec<[f64; 3]> = self
            .faces
            .iter()
            .map(|face| area_vector(self.vertices, face))
            .collect();
        let sizes: Vec<f64> = areas.iter().map(|area| norm(*area)).collect();
        let mut order: Vec<u32> = (0..self.faces.len() as u32).collect();
        order.sort_by(|a, b| {
            sizes[*b as usize]
                .total_cmp(&sizes[*a as usize])
                .then(a.cmp(b))
        });
        let mut region = vec![u32::MAX; self.faces.len()];
        let mut next = 0;
        let mut stack = Vec::new();
        for seed in order {
            if region[seed as usize] != u32::MAX {
                continue;
            }
            let plane = self.plane(seed, areas[seed as usize]);
            region[seed as usize] = next;
            stack.push(seed);
            while let Some(f) = stack.pop() {
                for g in self.neighbours(f) {
                    let is_free = region[g as usize] == u32::MAX;
                    if is_free && self.lies_in(g, &plane, areas[g as usize]) {
                        region[g as usize] = next;
                        stack.push(g);
                    }
                }
            }
            next += 1;
        }
        region
    }

    fn plane(&self, f: u32, area: [f64; 3]) -> Plane {
        let face = &self.faces[f as usize];
        let length = norm(area).max(f64::MIN_POSITIVE);
        let count = face.len() as f64;
        Plane {
            normal: area.map(|x| x / length),
            origin: [0, 1, 2].map(|d| face.iter().map(|n| self.at(*n)[d]).sum::<f64>() / count),
        }
    }

    fn lies_in(&self, f: u32, plane: &Plane, area: [f64; 3]) -> bool {
        let face = &self.faces[f as usize];
        if face
            .iter()
            .any(|n| plane.above(self.at(*n)).abs() > self.flat)
        {
            return false;
        }
        let edges = (0..face.len())
            .map(|i| difference(self.at(face[(i + 1) % face.len()]), self.at(face[i])));
        let longest = edges.map(norm).fold(0.0, f64::max);
        let size = norm(area);
        size <= longest * self.flat || dot(area, plane.normal) > SAME_WAY * size
    }

    /// Outline of each region.
    fn outlines(&self, region: &[u32]) -> Result<Vec<Vec<u32>>, Fault> {
        let count = region.iter().max().map_or(0, |last| *last as usize + 1);
        let mut next: Vec<FxHashMap<u32, u32>> = vec![FxHashMap::default(); count];
        let mut begin = vec![None; count];
        for (f, face) in self.faces.iter().enumerate() {
            let own = region[f];
            for (i, a) in face.iter().enumerate() {
                let b = face[(i + 1) % face.len()];
                let other = self.of_edge.get(&(b, *a)).map(|g| region[*g as usize]);
                if other == Some(own) {
                    continue;
                }
                begin[own as usize].get_or_insert(*a);
                if next[own as usize].insert(*a, b).is_some() {
                    return Err(Fault::Hole(self.at(*a)));
                }
            }
        }
        let outline = |(next, begin): (FxHashMap<u32, u32>, Option<u32>)| {
            let begin = begin.ok_or(Fault::Holes)?;
            let mut outline = vec![begin];
            let mut at = begin;
            while let Some(to) = next.get(&at).filter(|to| **to != begin) {
                outline.push(*to);
                at = *to;
                if outline.len() > next.len() {
                    break;
                }
            }
            // Further edges are those of a hole.
            let is_one = outline.len() == next.len();
            is_one.then_some(outline).ok_or(Fault::Hole(self.at(begin)))
        };
        next.into_iter().zip(begin).map(outline).collect()
    }

    /// Polyhedron of these faces, without vertices on straight edges.
    fn polyhedron(&self, mut loops: Vec<Vec<u32>>) -> Result<Polyhedron, Fault> {
        let mut met = vec![0_u32; self.vertices.len()];
        for n in loops.iter().flatten() {
            met[*n as usize] += 1;
        }
        let mut is_straight: Vec<bool> = met.iter().map(|count| *count < 3).collect();
        for face in &loops {
            for (i, n) in face.iter().enumerate() {
                let [before, after] =
                    [face.len() - 1, 1].map(|step| self.at(face[(i + step) % face.len()]));
                let (chord, here) = (difference(after, before), difference(self.at(*n), before));
                // Deviation from the chord.
                if norm(cross(chord, here)) > 5.0 * self.flat * norm(chord) {
                    is_straight[*n as usize] = false;
                }
            }
        }
        for face in &mut loops {
            face.retain(|n| !is_straight[*n as usize]);
        }
        loops.retain(|face| face.len() > 2);
        let mut number: FxHashMap<u32, u32> = FxHashMap::default();
        let mut corners = Vec::new();
        for n in loops.iter_mut().flatten() {
            let next = corners.len() as u32;
            let own = *number.entry(*n).or_insert(next);
            if own == next {
                corners.push(self.vertices[*n as usize]);
            }
            *n = own;
        }
        require_closed(&corners, &loops)?;
        Ok(Polyhedron {
            corners,
            faces: loops,
        })
    }
}

/// Requires two faces at each edge, three at each corner, and Euler's number of a ball.
fn require_closed(corners: &[[f64; 3]], faces: &[Vec<u32>]) -> Result<(), Fault> {
    let mut edges: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    let mut met = vec![0; corners.len()];
    for face in faces {
        for (i, a) in face.iter().enumerate() {
            met[*a as usize] += 1;
            *edges.entry((*a, face[(i + 1) % face.len()])).or_default() += 1;
        }
    }
    let is_paired = edges
        .iter()
        .all(|((a, b), count)| *count == 1 && edges.contains_key(&(*b, *a)));
    let euler = 2 * (corners.len() + faces.len()) == edges.len() + 4;
    if let Some(n) = met.iter().position(|count| *count < 3) {
        return Err(Fault::Hole(corners[n]));
    }
    (is_paired && euler).then_some(()).ok_or(Fault::Holes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles of the faces of a box, with a vertex in the middle of each edge of the top and in the middle of the
    /// bottom.
    fn triangles() -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
        let mut x: Vec<[f64; 3]> = Vec::new();
        for k in 0..8 {
            x.push([0, 1, 2].map(|d| f64::from(k >> d & 1)));
        }
        x.push([0.5, 0.5, 0.0]);
        x.push([0.5, 0.0, 1.0]);
        let mut faces = Vec::new();
        for quad in [[0, 4, 6, 2], [1, 3, 7, 5], [2, 6, 7, 3]] {
            faces.push(vec![quad[0], quad[1], quad[2]]);
            faces.push(vec![quad[0], quad[2], quad[3]]);
        }
        for (a, b) in [(0, 2), (2, 3), (3, 1), (1, 0)] {
            faces.push(vec![a, b, 8]);
        }
        faces.push(vec![0, 1, 9]);
        faces.push(vec![1, 5, 9]);
        faces.push(vec![0, 9, 4]);
        faces.push(vec![9, 5, 7, 6]);
        faces.push(vec![9, 6, 4]);
        (x, faces)
    }

    #[test]
    fn triangles_of_a_box_become_six_quadrilaterals() {
        let (x, faces) = triangles();
        let merged = merged(&x, &faces, 2e-3).unwrap();
        assert_eq!((merged.corners.len(), merged.faces.len()), (8, 6));
        assert!(merged.faces.iter().all(|face| face.len() == 4));
        assert_eq!(merged.volume(), 1.0);
        assert_eq!(merged.middle(), [0.5; 3]);
        assert_eq!(merged.warp(), 0.0);
    }

    #[test]
    fn a_bent_face_stays_two_faces() {
        let (mut x, faces) = triangles();
        x[8][2] = -0.1;
        let merged = merged(&x, &faces, 2e-3).unwrap();
        assert_eq!((merged.corners.len(), merged.faces.len()), (9, 9));
    }
}
