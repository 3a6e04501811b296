//! Exterior faces of a mesh of hexahedra.

use std::collections::HashMap;

use super::hex8::FACES;

/// Faces that belong to only one element of their body, as (element, index into [`FACES`]), in the order of the
/// elements. `body` gives the body of an element.
pub fn exterior_faces(elements: &[[u32; 8]], body: impl Fn(usize) -> u32) -> Vec<(u32, u8)> {
    let key = |e: usize, face: u8| {
        let mut corners = corners(&elements[e], face);
        corners.sort_unstable();
        (body(e), corners)
    };
    let all =
        || (0..elements.len()).flat_map(|e| (0..FACES.len() as u8).map(move |face| (e, face)));
    let mut count: HashMap<(u32, [u32; 4]), u32> = HashMap::with_capacity(3 * elements.len());
    for (e, face) in all() {
        *count.entry(key(e, face)).or_default() += 1;
    }
    let once = all().filter(|&(e, face)| count[&key(e, face)] == 1);
    once.map(|(e, face)| (e as u32, face)).collect()
}

/// Nodes of face `face` of an element with these nodes, counter-clockwise seen from outside.
pub fn corners(element: &[u32; 8], face: u8) -> [u32; 4] {
    FACES[usize::from(face)].map(|corner| element[corner])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two cubes that share four nodes. The face between them is interior in one body, and exterior in two bodies.
    #[test]
    fn a_shared_face_is_exterior_only_between_bodies() {
        let elements = [[0, 1, 2, 3, 4, 5, 6, 7], [1, 8, 9, 2, 5, 10, 11, 6]];
        let one = exterior_faces(&elements, |_| 0);
        assert_eq!(one.len(), 10);
        assert!(one.is_sorted());
        let shared = |&(e, face): &(u32, u8)| {
            let mut nodes = corners(&elements[e as usize], face);
            nodes.sort_unstable();
            nodes == [1, 2, 5, 6]
        };
        assert!(!one.iter().any(shared));
        let two = exterior_faces(&elements, |e| e as u32);
        assert_eq!(
            (two.len(), two.iter().filter(|f| shared(f)).count()),
            (12, 2)
        );
    }
}
