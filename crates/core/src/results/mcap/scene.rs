//! A frame as triangles in metres: the boundary facets of the solids and the facets of the interfaces.
//!
//! Viewers draw a list of triangles in one colour. So faces are grouped: the solids by damage in tenths, the
//! interfaces by state. Each list contains a node once. Positions are rounded to a micrometre.

use std::fmt::Write as _;
use std::io;

use wythe_contact::Part;

use crate::element::exterior::{corners, exterior_faces};
use crate::model::{Mesh, Model};
use crate::results::colours;
use crate::results::quarters::{QUARTERS, WEIGHTS};
use crate::state::{Frame, InterfaceState};

/// Number of damage levels with a colour each.
const LEVELS: usize = 10;
/// Opacity of joints by the number of their state.
const OPACITY: [f64; 4] = [0.3, 1.0, 1.0, 1.0];

/// The visible faces of the solids.
#[derive(Debug)]
pub struct Scene {
    /// Element and nodes, seen from outside, of each face that belongs to one element only.
    skin: Vec<(u32, [u32; 4])>,
}

impl Scene {
    /// Visible faces of a model.
    pub fn of(model: &Model) -> Self {
        Self {
            skin: boundary(&model.mesh),
        }
    }

    /// Solids of a frame as a `foxglove.SceneUpdate`, coloured by the larger of the two damages.
    ///
    /// # Errors
    /// The frame does not fit the model.
    pub fn solids(&self, model: &Model, frame: &Frame, stamp: u64) -> io::Result<String> {
        let elements = model.mesh.elements.len();
        let damages = [&frame.tensile_damage, &frame.compressive_damage];
        if damages.iter().any(|d| d.len() != elements) {
            return Err(misfit("damages", elements));
        }
        let materials = colours::MATERIALS.len();
        let group = |e: usize| {
            let damage = damages[0][e].max(damages[1][e]);
            match ((damage * LEVELS as f64) as usize).min(LEVELS - 1) {
                0 => usize::from(model.mesh.material[e]) % materials,
                level => materials + level - 1,
            }
        };
        let at = positions(model, frame)?;
        let groups: Vec<usize> = (0..elements).map(group).collect();
        let mut nodes = Indices::of(at.len());
        let list = |group: usize| {
            let mut list = Triangles::default();
            nodes.forget();
            for (element, corners) in &self.skin {
                if groups[*element as usize] == group {
                    let quad = corners.map(|n| nodes.at(n, || list.point(at[n as usize])));
                    list.quad(quad);
                }
            }
            list
        };
        let lists: Vec<Triangles> = (0..materials + LEVELS - 1).map(list).collect();
        let color = |group: usize| match group.checked_sub(materials) {
            None => opaque(colours::fractions(colours::material(group))),
            Some(level) => {
                let t = level as f64 / (LEVELS - 2) as f64;
                let [lowest, _, highest] = colours::TENSILE;
                opaque(colours::fractions(colours::mixed(lowest, highest, t)))
            }
        };
        let about = "the larger of tensile and compressive damage, in tenths; none: the material";
        Ok(entity("solids", about, stamp, &lists, color))
    }

    /// Interfaces of a frame as a `foxglove.SceneUpdate`, coloured by state. A facet whose points differ is drawn in
    /// quarters.
    ///
    /// # Errors
    /// The frame does not fit the model.
    pub fn interfaces(model: &Model, frame: &Frame, stamp: u64) -> io::Result<String> {
        let facets = &model.contact.slave_facets;
        let (states, rest) = frame.interfaces.state.as_chunks::<4>();
        if states.len() != facets.len() || !rest.is_empty() {
            return Err(misfit("states of interfaces", 4 * facets.len()));
        }
        let at = positions(model, frame)?;
        let mut nodes = Indices::of(at.len());
        let list = |group: usize| {
            let mut list = Triangles::default();
            nodes.forget();
            for (f, (facet, of)) in facets.iter().zip(states).enumerate() {
                let is = of.map(|state| state as usize == group);
                if is == [true; 4] && model.contact.part(f) == Part::WHOLE {
                    let quad = facet.map(|n| nodes.at(n, || list.point(at[n as usize])));
                    list.quad(quad);
                } else if is != [false; 4] {
                    let points = spread(model.contact.outline(f, &at));
                    for (quarter, _) in QUARTERS.iter().zip(is).filter(|(_, is)| *is) {
                        let quad = quarter.map(|k| list.point(points[k as usize]));
                        list.quad(quad);
                    }
                }
            }
            list
        };
        let lists: Vec<Triangles> = (0..colours::STATES.len()).map(list).collect();
        let about = "intact grey, softening yellow, open red, sliding orange";
        Ok(entity("interfaces", about, stamp, &lists, |s| {
            let [r, g, b] = colours::fractions(colours::STATES[s]);
            [r, g, b, OPACITY[s]]
        }))
    }
}

/// Frame of the model at rest with all fields of a scene.
pub fn rest(model: &Model) -> Frame {
    let mut frame = Frame {
        displacement: vec![[0.0; 3]; model.mesh.nodes.len()],
        tensile_damage: vec![0.0; model.mesh.elements.len()],
        compressive_damage: vec![0.0; model.mesh.elements.len()],
        ..Frame::default()
    };
    frame.interfaces.state = vec![InterfaceState::Intact; 4 * model.contact.slave_facets.len()];
    frame
}

/// Boundary facets with their elements, in the order of the elements.
fn boundary(mesh: &Mesh) -> Vec<(u32, [u32; 4])> {
    let faces = exterior_faces(&mesh.elements, |_| 0).into_iter();
    faces
        .map(|(e, face)| (e, corners(&mesh.elements[e as usize], face)))
        .collect()
}

/// Positions of the nodes [mm]. `[node][xyz]`
fn positions(model: &Model, frame: &Frame) -> io::Result<Vec<[f64; 3]>> {
    let nodes = &model.mesh.nodes;
    if frame.displacement.len() != nodes.len() {
        return Err(misfit("displacements", nodes.len()));
    }
    let at = |(x, u): (&[f64; 3], &[f64; 3])| std::array::from_fn(|i| x[i] + u[i]);
    Ok(nodes.iter().zip(&frame.displacement).map(at).collect())
}

fn misfit(what: &str, wanted: usize) -> io::Error {
    let message = format!("the frame does not have the {wanted} {what} of the model");
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

fn opaque([r, g, b]: [f64; 3]) -> [f64; 4] {
    [r, g, b, 1.0]
}

/// Points of the quarters of a facet. `[corner][xyz]` to `[point][xyz]`
fn spread(corners: [[f64; 3]; 4]) -> [[f64; 3]; 9] {
    WEIGHTS.map(|weights| std::array::from_fn(|i| (0..4).map(|a| weights[a] * corners[a][i]).sum()))
}

/// Indices of the nodes in a list.
struct Indices {
    /// List number, from 1, and index. `[node]`
    known: Vec<(u32, u32)>,
    list: u32,
}

impl Indices {
    /// For this number of nodes.
    fn of(nodes: usize) -> Self {
        Self {
            known: vec![(0, 0); nodes],
            list: 0,
        }
    }

    /// Starts the next list.
    fn forget(&mut self) {
        self.list += 1;
    }

    /// Index of `node`, created by `new` if the node is not yet in the list.
    fn at(&mut self, node: u32, new: impl FnOnce() -> u32) -> u32 {
        let known = &mut self.known[node as usize];
        if known.0 != self.list {
            *known = (self.list, new());
        }
        known.1
    }
}

/// Triangles of one colour.
#[derive(Default)]
struct Triangles {
    /// JSON of the points, separated by commas.
    points: String,
    /// JSON of the indices, separated by commas.
    indices: String,
    count: u32,
}

impl Triangles {
    /// Adds a point at `mm` and returns its index.
    fn point(&mut self, mm: [f64; 3]) -> u32 {
        if self.count > 0 {
            self.points.push(',');
        }
        for (name, x) in ["{\"x\":", ",\"y\":", ",\"z\":"].into_iter().zip(mm) {
            self.points.push_str(name);
            metres(&mut self.points, x);
        }
        self.points.push('}');
        self.count += 1;
        self.count - 1
    }

    fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        for index in [a, b, c, a, c, d] {
            if !self.indices.is_empty() {
                self.indices.push(',');
            }
            digits(&mut self.indices, index.into(), 1);
        }
    }
}

/// Writes millimetres as metres, rounded to a micrometre, without trailing zeros.
fn metres(out: &mut String, mm: f64) {
    let um = (1e3 * mm).round() as i64;
    if um < 0 {
        out.push('-');
    }
    let (whole, part) = (um.unsigned_abs() / 1_000_000, um.unsigned_abs() % 1_000_000);
    digits(out, whole, 1);
    if part > 0 {
        out.push('.');
        digits(out, part, 6);
        out.truncate(out.trim_end_matches('0').len());
    }
}

/// Writes a number with at least `least` digits. `write!` would take most of the time of a scene.
fn digits(out: &mut String, mut number: u64, least: usize) {
    let mut text = [b'0'; 20];
    let mut first = text.len();
    while number > 0 || text.len() - first < least {
        first -= 1;
        text[first] = b'0' + (number % 10) as u8;
        number /= 10;
    }
    out.extend(text[first..].iter().map(|digit| char::from(*digit)));
}

const POSE: &str = r#"{"position":{"x":0,"y":0,"z":0},"orientation":{"x":0,"y":0,"z":0,"w":1}}"#;

/// A scene with one entity, which replaces the previous one of its name; `stamp` in ns.
fn entity(
    name: &str,
    colour: &str,
    stamp: u64,
    lists: &[Triangles],
    color: impl Fn(usize) -> [f64; 4],
) -> String {
    let (sec, nsec) = (stamp / 1_000_000_000, stamp % 1_000_000_000);
    let length: usize = lists.iter().map(|l| l.points.len() + l.indices.len()).sum();
    let mut out = String::with_capacity(length + 4096);
    // Writing to a string does not fail.
    let _ = write!(
        out,
        r#"{{"deletions":[],"entities":[{{"timestamp":{{"sec":{sec},"nsec":{nsec}}},"frame_id":"wall","id":"{name}","lifetime":{{"sec":0,"nsec":0}},"frame_locked":false,"metadata":[{{"key":"colour","value":"{colour}"}}],"arrows":[],"cubes":[],"spheres":[],"cylinders":[],"lines":[],"texts":[],"models":[],"triangles":["#
    );
    let mut first = true;
    for (group, list) in lists.iter().enumerate().filter(|(_, l)| l.count > 0) {
        let [r, g, b, a] = color(group);
        let comma = if first { "" } else { "," };
        first = false;
        let (points, indices) = (&list.points, &list.indices);
        let _ = write!(
            out,
            r#"{comma}{{"pose":{POSE},"color":{{"r":{r:.3},"g":{g:.3},"b":{b:.3},"a":{a}}},"colors":[],"points":[{points}],"indices":[{indices}]}}"#
        );
    }
    out.push_str("]}]}");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;
    use serde_json::Value;

    #[test]
    fn millimetres_are_converted_to_metres() {
        for (mm, text) in [
            (0.0, "0"),
            (1000.0, "1"),
            (-12.5, "-0.0125"),
            (2345.6789, "2.345679"),
            (0.001, "0.000001"),
            (-1e-9, "0"),
            (f64::NAN, "0"),
        ] {
            let mut out = String::new();
            metres(&mut out, mm);
            assert_eq!(out, text);
        }
    }

    #[test]
    fn solids_are_drawn_by_their_deformed_boundary() {
        let model = fake::model();
        let frame = fake::frame(&model, 0.5);
        let text = Scene::of(&model).solids(&model, &frame, 2_500_000_000);
        let scene: Value = serde_json::from_str(&text.unwrap()).unwrap();
        let entity = &scene["entities"][0];
        assert_eq!(entity["timestamp"]["sec"], 2);
        assert_eq!(entity["timestamp"]["nsec"], 500_000_000);
        // Damages 0.15 and 0.4: two lists with one whole cube each.
        let lists = entity["triangles"].as_array().unwrap();
        assert_eq!(lists.len(), 2);
        for (cube, list) in lists.iter().enumerate() {
            assert_eq!(list["points"].as_array().unwrap().len(), 8);
            assert_eq!(list["indices"].as_array().unwrap().len(), 36);
            let volume = volume(list);
            let at_rest = 1e-3 * (1.0 + 0.5e-3_f64).powi(3);
            assert!((volume - at_rest).abs() < 1e-7, "{cube}: {volume}");
        }
    }

    /// Volume enclosed by the triangles [m³], by the divergence theorem; positive if they face outwards.
    fn volume(list: &Value) -> f64 {
        let x = |i: &Value| {
            let point = &list["points"][i.as_u64().unwrap() as usize];
            ["x", "y", "z"].map(|k| point[k].as_f64().unwrap())
        };
        let indices = list["indices"].as_array().unwrap();
        let of = |t: &[Value]| {
            let [a, b, c] = [x(&t[0]), x(&t[1]), x(&t[2])];
            let cross = |i: usize| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                b[j] * c[k] - b[k] * c[j]
            };
            (0..3).map(|i| a[i] * cross(i)).sum::<f64>() / 6.0
        };
        indices.chunks(3).map(of).sum()
    }

    #[test]
    fn facets_are_whole_unless_their_points_differ() {
        let mut model = fake::model();
        // The +x face of the first cube.
        model.contact.slave_facets = vec![[1, 2, 6, 5]];
        let mut frame = fake::frame(&model, 1.0);
        let lists = |frame: &Frame| {
            let text = Scene::interfaces(&model, frame, 0).unwrap();
            let value: Value = serde_json::from_str(&text).unwrap();
            value["entities"][0]["triangles"].clone()
        };
        let whole = lists(&frame);
        assert_eq!(whole[0]["points"].as_array().unwrap().len(), 4);
        assert_eq!(whole[0]["color"]["r"], 0.949);
        frame.interfaces.state[2] = InterfaceState::FailedOpen;
        let split = lists(&frame);
        assert_eq!(split[0]["indices"].as_array().unwrap().len(), 18);
        assert_eq!(split[1]["indices"].as_array().unwrap().len(), 6);
        frame.interfaces.state.pop();
        assert!(Scene::interfaces(&model, &frame, 0).is_err());
    }
}
