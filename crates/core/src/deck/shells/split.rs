//! Divides the parts of a file into closed shells.
//!
//! Vertices of a part with equal coordinates are one vertex. Faces belong to one shell if they meet at an edge. Where
//! stones of one part touch, four or more faces meet at an edge; a face is then followed by the next one in the sense
//! of rotation through the solid behind it.

mod orient;

use super::{Part, Place, Polygon, ShellError, Soup};
use crate::deck::import::root;
use crate::element::hexahedron::{cross, difference, dot, norm};
use rustc_hash::{FxHashMap, FxHashSet};
use std::f64::consts::TAU;

/// A closed shell: each edge has two faces, which run along it in opposite directions.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::deck) struct Shell {
    /// Name of its part.
    pub(in crate::deck) part: Option<String>,
    /// Place of its first face in the file.
    pub(in crate::deck) place: Place,
    /// Corners [mm].
    pub(in crate::deck) vertices: Vec<[f64; 3]>,
    /// Faces, counter-clockwise seen from outside.
    pub(in crate::deck) faces: Vec<Vec<u32>>,
    /// Whether the file has its faces clockwise.
    is_inverted: bool,
}

/// Largest number of faces that meet at an edge.
const MOST_AT_EDGE: usize = 64;

/// Faces that differ by less than this angle lie upon each other [rad].
const SAME_ANGLE: f64 = 1e-6;

/// Divides all parts of a file into shells, and appends notes.
///
/// # Errors
/// Open shells, edges of more than two faces, shells that are turned inside out while others are not.
pub(in crate::deck) fn split(
    soup: &Soup,
    notes: &mut Vec<String>,
) -> Result<Vec<Shell>, ShellError> {
    let mut shells = Vec::new();
    let (mut repeated, mut turned) = (0, 0);
    for part in &soup.parts {
        let welded = Welded::of(soup, part);
        repeated += welded.repeated;
        turned += welded.turned;
        shells.extend(welded.shells()?);
    }
    if turned > 0 {
        notes.push(format!(
            "{turned} faces run the other way round than their neighbours: they are turned outwards"
        ));
    }
    if repeated > 0 {
        notes.push(format!(
            "{repeated} faces are there twice in their part: each counts once"
        ));
    }
    if let Some(shell) = shells
        .iter()
        .find(|shell| volume(&shell.vertices, &shell.faces) <= 0.0)
    {
        let message = format!("{} has no volume", shell.called());
        return Err(ShellError::new(
            shell.place,
            message,
            "delete it, or write the stone as a closed shell",
        ));
    }
    if shells.iter().all(|shell| shell.is_inverted) {
        let count = shells.len();
        notes.push(format!(
            "the faces of all {count} shells look inwards: they are reversed"
        ));
    } else if let Some(shell) = shells.iter().find(|shell| shell.is_inverted) {
        return Err(ShellError::new(
            shell.place,
            format!(
                "{} is turned inside out, with a negative volume; others are not",
                shell.called()
            ),
            "reverse its faces; a cavity within a stone is not read",
        ));
    }
    Ok(shells)
}

impl Shell {
    /// Name in messages, with the middle of its vertices.
    pub(in crate::deck) fn called(&self) -> String {
        let count = self.vertices.len() as f64;
        let middle = [0, 1, 2].map(|d| self.vertices.iter().map(|x| x[d]).sum::<f64>() / count);
        format!("{} near {}", named(self.part.as_deref()), point(middle))
    }
}

fn named(part: Option<&str>) -> String {
    part.map_or_else(|| "a shell".to_owned(), |part| format!("`{part}`"))
}

/// Formats a point, such as `(10, 20, 5) mm`.
pub(super) fn point(x: [f64; 3]) -> String {
    let [x, y, z] = x.map(|x| (x * 1e3).round() / 1e3 + 0.0);
    format!("({x}, {y}, {z}) mm")
}

/// Volume within closed polygons [mm³]: each is a fan of triangles.
pub(super) fn volume(vertices: &[[f64; 3]], faces: &[Vec<u32>]) -> f64 {
    let Some(origin) = vertices.first() else {
        return 0.0;
    };
    let at = |n: u32| difference(vertices[n as usize], *origin);
    let of_face = |face: &Vec<u32>| -> f64 {
        let triangles = face[1..].windows(2);
        triangles
            .map(|pair| dot(cross(at(face[0]), at(pair[0])), at(pair[1])) / 6.0)
            .sum()
    };
    faces.iter().map(of_face).sum()
}

/// Area vector of a polygon [mm²]: half the sum of cross products (Newell).
pub(super) fn area_vector(vertices: &[[f64; 3]], face: &[u32]) -> [f64; 3] {
    let origin = vertices[face[0] as usize];
    let mut sum = [0.0; 3];
    for pair in face[1..].windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|n| difference(vertices[n as usize], origin));
        let area = cross(a, b);
        (0..3).for_each(|d| sum[d] += 0.5 * area[d]);
    }
    sum
}

/// A face that begins with its least corner.
fn turned(face: &[u32]) -> Vec<u32> {
    let least = (0..face.len()).min_by_key(|i| face[*i]).unwrap_or_default();
    let (end, begin) = face.split_at(least);
    [begin, end].concat()
}

/// A part whose vertices with equal coordinates are one.
struct Welded {
    name: Option<String>,
    vertices: Vec<[f64; 3]>,
    faces: Vec<Vec<u32>>,
    places: Vec<Place>,
    /// Whether its faces were reversed, because they look inwards.
    is_reversed: bool,
    /// Number of faces that were there twice.
    repeated: usize,
    /// Number of faces that were turned because their neighbours run the other way round.
    turned: usize,
}

/// A face along an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct HalfEdge {
    low: u32,
    high: u32,
    /// Whether the face runs from `low` to `high`.
    is_forward: bool,
    face: u32,
}

impl Welded {
    fn of(soup: &Soup, part: &Part) -> Self {
        let mut welded = Self {
            name: part.name.clone(),
            vertices: Vec::new(),
            faces: Vec::new(),
            places: Vec::new(),
            is_reversed: false,
            repeated: 0,
            turned: 0,
        };
        let mut faces: FxHashSet<Vec<u32>> = FxHashSet::default();
        let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        for Polygon { corners, place } in &part.faces {
            let mut face: Vec<u32> = Vec::with_capacity(corners.len());
            for corner in corners {
                // -0 is 0.
                let x = soup.vertices[*corner as usize].map(|x| x + 0.0);
                let next = welded.vertices.len() as u32;
                let n = *known.entry(x.map(f64::to_bits)).or_insert(next);
                if n == next {
                    welded.vertices.push(x);
                }
                if face.last() != Some(&n) {
                    face.push(n);
                }
            }
            if face.len() > 1 && face.first() == face.last() {
                face.pop();
            }
            if face.len() < 3 {
                continue;
            }
            if faces.insert(turned(&face)) {
                welded.faces.push(face);
                welded.places.push(*place);
            } else {
                welded.repeated += 1;
            }
        }
        welded.orient();
        if volume(&welded.vertices, &welded.faces) < 0.0 {
            welded.is_reversed = true;
            welded.faces.iter_mut().for_each(|face| face.reverse());
        }
        welded
    }

    fn half_edges(&self) -> Vec<HalfEdge> {
        let mut all = Vec::new();
        for (f, face) in self.faces.iter().enumerate() {
            for (i, a) in face.iter().enumerate() {
                let b = face[(i + 1) % face.len()];
                all.push(HalfEdge {
                    low: b.min(*a),
                    high: b.max(*a),
                    is_forward: *a < b,
                    face: f as u32,
                });
            }
        }
        all.sort_unstable();
        all
    }

    fn shells(&self) -> Result<Vec<Shell>, ShellError> {
        let mut parent: Vec<u32> = (0..self.faces.len() as u32).collect();
        let mut join = |a: u32, b: u32| {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b) as usize] = a.min(b);
        };
        let edges = self.half_edges();
        for edge in edges.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high)) {
            self.require_two_sides(edge)?;
            match edge {
                [a, b] => join(a.face, b.face),
                many => {
                    for [a, b] in self.around(many)? {
                        join(a, b);
                    }
                }
            }
        }
        let mut shell_of: FxHashMap<u32, usize> = FxHashMap::default();
        let mut of_shell: Vec<Vec<u32>> = Vec::new();
        for f in 0..self.faces.len() as u32 {
            let shell = *shell_of
                .entry(root(&mut parent, f))
                .or_insert(of_shell.len());
            if shell == of_shell.len() {
                of_shell.push(Vec::new());
            }
            of_shell[shell].push(f);
        }
        Ok(of_shell.iter().map(|faces| self.shell(faces)).collect())
    }

    /// A shell of these faces with vertices of its own.
    fn shell(&self, faces: &[u32]) -> Shell {
        let mut number: FxHashMap<u32, u32> = FxHashMap::default();
        let mut vertices = Vec::new();
        let mut renumbered = Vec::with_capacity(faces.len());
        for f in faces {
            let mut face: Vec<u32> = Vec::with_capacity(4);
            for n in &self.faces[*f as usize] {
                let next = vertices.len() as u32;
                let own = *number.entry(*n).or_insert(next);
                if own == next {
                    vertices.push(self.vertices[*n as usize]);
                }
                face.push(own);
            }
            renumbered.push(face);
        }
        let is_negative = volume(&vertices, &renumbered) < 0.0;
        if is_negative {
            for face in &mut renumbered {
                face.reverse();
            }
        }
        Shell {
            part: self.name.clone(),
            place: faces
                .first()
                .map_or(Place::Whole, |f| self.places[*f as usize]),
            vertices,
            faces: renumbered,
            is_inverted: self.is_reversed != is_negative,
        }
    }

    /// Rejects edges of one face, and edges along which faces run in one direction.
    fn require_two_sides(&self, edge: &[HalfEdge]) -> Result<(), ShellError> {
        let forward = edge.iter().filter(|half| half.is_forward).count();
        if 2 * forward == edge.len() && edge.len() <= MOST_AT_EDGE {
            return Ok(());
        }
        let [a, b] = [edge[0].low, edge[0].high].map(|n| self.vertices[n as usize]);
        let (message, help) = match edge.len() {
            1 => (
                "is open: one face only lies at the edge",
                "close the shell: fill holes, and let neighbouring faces have the same corners along their edge",
            ),
            2 => (
                "has neighbouring faces in opposite senses of rotation: one looks inwards, at the edge",
                "turn all faces outwards (`unify normals` in most programs)",
            ),
            _ => (
                "has too many faces, or an odd number of them, at the edge",
                "let each edge have two faces: remove faces within the stone and faces that are there twice",
            ),
        };
        let message = format!(
            "{} {message} from {} to {}",
            named(self.name.as_deref()),
            point(a),
            point(b)
        );
        Err(ShellError::new(
            self.places[edge[0].face as usize],
            message,
            help,
        ))
    }

    /// Pairs of faces of one solid around an edge where several solids touch.
    fn around(&self, edge: &[HalfEdge]) -> Result<Vec<[u32; 2]>, ShellError> {
        let [a, b] = [edge[0].low, edge[0].high].map(|n| self.vertices[n as usize]);
        let along = difference(b, a);
        let length = norm(along);
        let along = along.map(|x| x / length);
        let into = |half: &HalfEdge| {
            let normal = area_vector(&self.vertices, &self.faces[half.face as usize]);
            let inwards = cross(normal, along);
            let sign = if half.is_forward { 1.0 } else { -1.0 };
            inwards.map(|x| sign * x)
        };
        let first = into(&edge[0]);
        let second = cross(along, first);
        let angle = |half: &HalfEdge| {
            let inwards = into(half);
            dot(inwards, second).atan2(dot(inwards, first))
        };
        let angles: Vec<f64> = edge.iter().map(angle).collect();
        let mut is_taken = vec![false; edge.len()];
        let mut pairs = Vec::new();
        for (i, _) in edge.iter().enumerate().filter(|(_, half)| !half.is_forward) {
            // A positive rotation leads from a face that runs backwards through its solid. Faces upon each other
            // belong to two solids.
            let turn = |j: usize| {
                let turn = (angles[j] - angles[i]).rem_euclid(TAU);
                if turn < SAME_ANGLE { turn + TAU } else { turn }
            };
            let others = (0..edge.len()).filter(|j| edge[*j].is_forward && !is_taken[*j]);
            if let Some(mate) = others.min_by(|j, k| turn(*j).total_cmp(&turn(*k))) {
                is_taken[mate] = true;
                pairs.push([edge[i].face, edge[mate].face]);
            }
        }
        Ok(pairs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quadrilaterals of boxes from `low` to `high`, all in one part with common vertices.
    pub fn boxes(boxes: &[[[f64; 3]; 2]]) -> Soup {
        let mut soup = Soup::default();
        let mut faces = Vec::new();
        for [low, high] in boxes {
            let first = soup.vertices.len() as u32;
            for k in 0..8 {
                let at = |d: usize| if k >> d & 1 == 1 { high[d] } else { low[d] };
                soup.vertices.push([at(0), at(1), at(2)]);
            }
            for face in [
                [0, 4, 6, 2],
                [1, 3, 7, 5],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 2, 3, 1],
                [4, 5, 7, 6],
            ] {
                faces.push(Polygon {
                    corners: face.map(|n| first + n).to_vec(),
                    place: Place::Line(1 + faces.len() as u32),
                });
            }
        }
        soup.parts.push(Part {
            name: Some("wall".into()),
            faces,
        });
        soup
    }

    fn volumes(soup: &Soup) -> Vec<f64> {
        let shells = split(soup, &mut Vec::new()).unwrap();
        shells
            .iter()
            .map(|s| volume(&s.vertices, &s.faces))
            .collect()
    }

    const UNIT: [[f64; 3]; 2] = [[0.0; 3], [1.0; 3]];

    #[test]
    fn stones_that_touch_are_separate_shells() {
        let beside = [[1.0, 0.0, 0.0], [3.0, 1.0, 1.0]];
        let above = [[0.0, 0.0, 1.0], [1.0, 1.0, 1.5]];
        // At the edge x = z = 1 six faces of three stones meet.
        assert_eq!(volumes(&boxes(&[UNIT, beside, above])), [1.0, 2.0, 0.5]);
        let diagonal = [[1.0, 0.0, 1.0], [2.0, 1.0, 2.0]];
        assert_eq!(volumes(&boxes(&[UNIT, diagonal])), [1.0, 1.0]);
        let all = [UNIT, beside, above, [[1.0, 0.0, 1.0], [3.0, 1.0, 1.5]]];
        assert_eq!(volumes(&boxes(&all)), [1.0, 2.0, 0.5, 1.0]);
    }

    #[test]
    fn faces_that_are_there_twice_count_once() {
        let mut soup = boxes(&[UNIT]);
        let mut again = soup.parts[0].faces.clone();
        again[0].corners.rotate_left(1);
        soup.parts[0].faces.extend(again);
        let mut notes = Vec::new();
        assert_eq!(split(&soup, &mut notes).unwrap().len(), 1);
        assert!(notes[0].contains("6 faces are there twice"), "{notes:?}");
    }

    #[test]
    fn inverted_shells_are_reversed_only_if_all_are() {
        let turned = |soup: &mut Soup, faces: std::ops::Range<usize>| {
            soup.parts[0].faces[faces]
                .iter_mut()
                .for_each(|f| f.corners.reverse());
        };
        let mut soup = boxes(&[UNIT, [[1.0, 0.0, 0.0], [3.0, 1.0, 1.0]]]);
        turned(&mut soup, 0..12);
        let mut notes = Vec::new();
        let shells = split(&soup, &mut notes).unwrap();
        assert_eq!(shells.len(), 2);
        assert!(notes[0].contains("all 2 shells look inwards"), "{notes:?}");
        let mut soup = boxes(&[UNIT, [[5.0, 0.0, 0.0], [6.0, 1.0, 1.0]]]);
        turned(&mut soup, 6..12);
        let error = split(&soup, &mut Vec::new()).unwrap_err();
        assert!(
            error
                .message
                .contains("`wall` near (5.5, 0.5, 0.5) mm is turned inside out"),
            "{error}"
        );
        let mut soup = boxes(&[UNIT, [[5.0, 0.0, 0.0], [6.0, 1.0, 1.0]]]);
        turned(&mut soup, 2..6);
        let mut notes = Vec::new();
        let shells = split(&soup, &mut notes).unwrap();
        assert!(
            shells
                .iter()
                .all(|s| (volume(&s.vertices, &s.faces) - 1.0).abs() < 1e-12)
        );
        assert!(
            notes[0].contains("4 faces run the other way round"),
            "{notes:?}"
        );
    }

    #[test]
    fn open_shells_name_the_edge() {
        let mut soup = boxes(&[UNIT]);
        soup.parts[0].faces.pop();
        let error = split(&soup, &mut Vec::new()).unwrap_err();
        assert_eq!(error.place, Place::Line(1));
        assert!(error.message.contains("`wall` is open"), "{error}");
        assert!(error.message.contains("1) mm"), "{error}");
        let mut soup = boxes(&[UNIT]);
        let mut inner = soup.parts[0].faces[5].clone();
        inner.corners.reverse();
        soup.parts[0].faces.push(inner);
        let error = split(&soup, &mut Vec::new()).unwrap_err();
        assert!(error.message.contains("odd number"), "{error}");
    }
}
