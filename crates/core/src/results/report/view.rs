//! Data of the 3D view: boundary facets at rest, and displacement, damage and joint states of each frame.

use std::io;

use serde::Serialize;

use super::marks::{EncodedMark, Mark};
use super::packed;
use super::skin::BoundaryFacets;
use crate::element::hex8::FACES;
use crate::results::elevation;
use crate::results::vtkhdf::read::{FieldsFile, RestMesh};
use crate::state::Frame;

/// Largest signed number of 16 bits.
const WORD: f64 = 32767.0;

/// Data of the view. Arrays are little-endian in base64; node numbers are `u16` or `u32` by [`View::wide`].
// More than 15 fields: these are the keys that the script of the page reads.
#[derive(Debug, Serialize)]
pub(super) struct View {
    /// Lower corner of the bounding box at rest [mm].
    pub low: [f64; 3],
    /// Sizes of the bounding box [mm].
    pub size: [f64; 3],
    /// Nodes at rest, 0 to 65535 over the box. `[node][xyz]` u16
    pub rest: String,
    /// Whether node numbers have 32 bits.
    pub wide: bool,
    /// Nodes of the elements. `[element][8]`
    pub corners: String,
    /// Boundary faces of the elements, one bit each. `[element]` u8
    pub faces: String,
    /// Corner numbers 0 to 7 of each of the six faces of an element, in the order of the bits in `faces`.
    /// `[face][4]`
    pub hexahedron: [[usize; 4]; 6],
    /// Unit of each element, 0 to 65535. `[element]` u16
    pub unit: String,
    /// Material of each element, an index into `materials`. `[element]` u8
    pub material: String,
    /// Names of the materials.
    pub materials: Vec<String>,
    /// Names of the units; empty if the file has none.
    pub units: Vec<String>,
    /// Edges of the bodies. `[edge][2]`
    pub edges: String,
    /// Facets of the interfaces. `[facet][4]`
    pub facets: String,
    /// Largest crack width of all frames [mm], stored as 255.
    pub widest: f64,
    /// Initial magnification of displacements.
    pub magnification: f64,
    /// Supports, drives and loads; empty after a run.
    pub marks: Vec<EncodedMark>,
    /// The frames.
    pub frames: Vec<EncodedFrame>,
}

/// One frame.
#[derive(Debug, Serialize)]
pub(super) struct EncodedFrame {
    /// Row of the history on this page.
    pub row: usize,
    /// Step time [s].
    pub time: f64,
    /// Displacement stored as 32767 [mm].
    pub most: f64,
    /// Displacements. `[node][xyz]` i16
    pub displacement: String,
    /// Tensile damage, 255 for 1. `[element]` u8
    pub tensile: String,
    /// Compressive damage, 255 for 1. `[element]` u8
    pub compressive: String,
    /// Square root of the crack width, 255 for the largest. `[element]` u8
    pub crack: String,
    /// States of the four points in one byte, the first in the lowest bits. `[facet]` u8
    pub state: String,
}

/// The view before its frames are chosen and read.
#[derive(Debug)]
pub(super) struct Scene<'a> {
    file: &'a FieldsFile,
    skin: BoundaryFacets,
    nodes: usize,
    elements: usize,
    facets: usize,
    view: View,
}

/// Facets of the interfaces on the solids in the last frame; none if they are no faces of the solids.
fn facets(
    file: &FieldsFile,
    mesh: &RestMesh,
    skin: &BoundaryFacets,
) -> io::Result<Option<Vec<[u32; 4]>>> {
    let surface = file.surface()?;
    let Some(last) = file.times().len().checked_sub(1) else {
        return Ok(Some(Vec::new()));
    };
    if surface.points.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let solid = file.frame(last)?.displacement;
    let interface = file.surface_displacement(last)?;
    Ok(skin.facets(mesh, &surface, (&solid, &interface)))
}

impl<'a> Scene<'a> {
    /// Reads the data at rest. Omitted parts are added to `notes`.
    pub fn open(file: &'a FieldsFile, marks: &[Mark], notes: &mut Vec<String>) -> io::Result<Self> {
        let mesh = file.mesh()?;
        let damaged = |what: &str| io::Error::new(io::ErrorKind::InvalidData, what);
        let skin = BoundaryFacets::of(&mesh)
            .ok_or_else(|| damaged("an element names a node that is not there"))?;
        let elements = mesh.elements.len();
        if mesh.unit.len() != elements || mesh.material.len() != elements {
            return Err(damaged("units and materials are not as many as elements"));
        }
        let facets = facets(file, &mesh, &skin)?;
        if facets.is_none() {
            notes.push(
                "The interfaces are not shown: their facets are no faces of the solids.".to_owned(),
            );
        }
        let facets = facets.unwrap_or_default();
        let (low, size) = bounds(&mesh.nodes);
        let fraction = |x: f64, i: usize| ((x - low[i]) / size[i] * 65535.0).round() as u16;
        let wide = skin.nodes.len() > usize::from(u16::MAX);
        let numbers = |flat: &[u32]| {
            if wide {
                packed::longs(flat.iter().copied())
            } else {
                packed::words(flat.iter().map(|&n| n as u16))
            }
        };
        let of = |values: &dyn Fn(usize) -> u32| -> Vec<u32> {
            skin.elements.iter().map(|&e| values(e as usize)).collect()
        };
        let unit = of(&|e| mesh.unit[e]);
        let material = of(&|e| mesh.material[e].into());
        let rest = skin.nodes.iter().map(|&n| mesh.nodes[n as usize]);
        let view = View {
            low,
            size,
            rest: packed::words(rest.flat_map(|x| [0, 1, 2].map(|i| fraction(x[i], i)))),
            wide,
            corners: numbers(skin.corners.as_flattened()),
            faces: packed::encode(&skin.faces),
            hexahedron: FACES,
            unit: packed::words(unit.into_iter().map(|u| u as u16)),
            material: packed::encode(&material.iter().map(|&m| m as u8).collect::<Vec<_>>()),
            materials: file.materials()?,
            units: file.units()?,
            edges: numbers(skin.edges.as_flattened()),
            facets: numbers(facets.as_flattened()),
            widest: 0.0,
            magnification: 1.0,
            marks: Mark::encoded(marks, &skin.nodes),
            frames: Vec::new(),
        };
        Ok(Self {
            file,
            nodes: mesh.nodes.len(),
            elements,
            facets: facets.len(),
            skin,
            view,
        })
    }

    /// Size on the page without frames, and size of each frame [byte].
    pub fn sizes(&self) -> (usize, usize) {
        let view = &self.view;
        let still = [
            &view.rest,
            &view.corners,
            &view.faces,
            &view.unit,
            &view.material,
            &view.edges,
            &view.facets,
        ];
        // A name with its quotes and comma.
        let names = view.units.iter().map(|name| name.len() + 3).sum::<usize>();
        let fixed = names + still.iter().map(|text| text.len()).sum::<usize>();
        let cells = packed::length(self.skin.elements.len());
        let frame = packed::length(6 * self.skin.nodes.len())
            + 3 * cells
            + packed::length(self.facets)
            + FRAME_KEYS;
        (fixed, frame)
    }

    /// Reads the chosen frames, each with its row of the history. A frame that cannot be read is omitted with a note.
    pub fn with_frames(mut self, chosen: &[(usize, usize)], notes: &mut Vec<String>) -> View {
        let mut frames = Vec::new();
        for &(index, row) in chosen {
            match self.file.frame(index) {
                Ok(frame) if self.fits(&frame) => frames.push((row, frame)),
                Ok(_) => notes.push(format!("Frame {index} has not the size of the mesh.")),
                Err(why) => notes.push(format!("Frame {index} cannot be read: {why}")),
            }
        }
        let widths = frames.iter().flat_map(|(_, f)| &f.crack_width);
        self.view.widest = widths
            .copied()
            .filter(|w| w.is_finite())
            .fold(0.0, f64::max);
        if let Some((_, frame)) = frames.last() {
            let extent = self.view.size.into_iter().fold(0.0, f64::max);
            self.view.magnification =
                elevation::suitable(extent, elevation::largest(&frame.displacement));
        }
        self.view.frames = frames
            .iter()
            .map(|(row, frame)| self.encode(*row, frame))
            .collect();
        self.view
    }

    fn fits(&self, frame: &Frame) -> bool {
        frame.displacement.len() == self.nodes
            && [
                &frame.tensile_damage,
                &frame.compressive_damage,
                &frame.crack_width,
            ]
            .iter()
            .all(|field| field.len() == self.elements)
            && (self.facets == 0 || frame.interfaces.state.len() == 4 * self.facets)
    }

    fn encode(&self, row: usize, frame: &Frame) -> EncodedFrame {
        let moved: Vec<f64> = self
            .skin
            .nodes
            .iter()
            .flat_map(|&n| frame.displacement[n as usize])
            .collect();
        let (most, displacement) = words(&moved);
        let cells = |field: &[f64], scale: &dyn Fn(f64) -> f64| {
            let byte = |&e: &u32| (255.0 * scale(field[e as usize]).clamp(0.0, 1.0)).round() as u8;
            packed::encode(&self.skin.elements.iter().map(byte).collect::<Vec<_>>())
        };
        let widest = self.view.widest.max(f64::MIN_POSITIVE);
        let four = |states: &[crate::state::InterfaceState]| {
            let shifted = states.iter().enumerate();
            shifted.fold(0, |byte, (i, s)| byte | (*s as u8) << (2 * i))
        };
        let facets = &frame.interfaces.state[..4 * self.facets];
        EncodedFrame {
            row,
            time: frame.time,
            most,
            displacement: packed::words(displacement.into_iter().map(i16::cast_unsigned)),
            tensile: cells(&frame.tensile_damage, &|d| d),
            compressive: cells(&frame.compressive_damage, &|d| d),
            crack: cells(&frame.crack_width, &|w| (w / widest).sqrt()),
            state: packed::encode(&facets.chunks(4).map(four).collect::<Vec<_>>()),
        }
    }
}

/// Upper estimate for the keys and numbers of a frame [byte].
const FRAME_KEYS: usize = 200;

/// Numbers scaled to 16 bits, and the value stored as 32767.
pub(super) fn words(values: &[f64]) -> (f64, Vec<i16>) {
    let finite = values.iter().filter(|v| v.is_finite());
    let most = finite.fold(0.0_f64, |most, v| most.max(v.abs()));
    if most == 0.0 {
        return (0.0, vec![0; values.len()]);
    }
    let word = |v: &f64| (v / most * WORD).round() as i16;
    (most, values.iter().map(word).collect())
}

/// Lower corner and sizes of the bounding box; no size is 0.
fn bounds(points: &[[f64; 3]]) -> ([f64; 3], [f64; 3]) {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for (x, i) in points.iter().flat_map(|x| [(x, 0), (x, 1), (x, 2)]) {
        low[i] = low[i].min(x[i]);
        high[i] = high[i].max(x[i]);
    }
    if !low.iter().chain(&high).all(|v| v.is_finite()) {
        return ([0.0; 3], [1.0; 3]);
    }
    let size = |i: usize| {
        let size = high[i] - low[i];
        if size > 0.0 { size } else { 1.0 }
    };
    (low, [0, 1, 2].map(size))
}

/// Chooses at most `room` frames, but always the last one and that of the peak; the others at even distances.
pub(super) fn choose(frames: usize, peak: Option<usize>, room: usize) -> Vec<usize> {
    if frames <= room {
        return (0..frames).collect();
    }
    let wanted = std::iter::once(frames - 1).chain(peak.filter(|p| *p < frames));
    let mut chosen: Vec<usize> = wanted.collect();
    chosen.dedup();
    let rest = room.saturating_sub(chosen.len());
    for i in 0..rest {
        chosen.push(i * frames / rest);
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantised_displacements_come_back_within_half_a_step() {
        let values: Vec<f64> = (0..1000).map(|i| (f64::from(i)).sin() * 4.2).collect();
        let (most, words) = words(&values);
        for (value, word) in values.iter().zip(&words) {
            // Rounding to the nearest of 32767 steps.
            assert!((f64::from(*word) / WORD * most - value).abs() <= 0.5001 * most / WORD);
        }
        assert_eq!(super::words(&[0.0, 0.0]), (0.0, vec![0, 0]));
        assert_eq!(super::words(&[f64::NAN, -1.0]).1, [0, -32767]);
        assert_eq!(super::words(&[f64::INFINITY]).1, [0]);
    }

    #[test]
    fn the_frames_kept_are_spread_and_have_peak_and_end() {
        assert_eq!(choose(3, Some(1), 5), [0, 1, 2]);
        assert_eq!(choose(0, None, 5), [0; 0]);
        for room in [1, 2, 3, 7, 20] {
            let kept = choose(101, Some(37), room);
            assert!(kept.len() <= room.max(2), "{kept:?}");
            assert!(kept.contains(&37) && kept.contains(&100), "{kept:?}");
        }
        assert_eq!(choose(10, Some(9), 4), [0, 3, 6, 9]);
    }

    #[test]
    fn a_box_is_never_flat() {
        assert_eq!(bounds(&[]), ([0.0; 3], [1.0; 3]));
        let (low, size) = bounds(&[[0.0, 5.0, -1.0], [2.0, 5.0, 3.0]]);
        assert_eq!((low, size), ([0.0, 5.0, -1.0], [2.0, 1.0, 4.0]));
    }
}
