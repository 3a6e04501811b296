//! Layers on faces: converts `[[layers]]` to blocks and contacts.
//!
//! ```text
//!   ┌────┬────┐         units, with lines of their mesh      the layer has the lines of all of them, so that
//!   ├──┬─┴──┬─┤   ──▶   ├──┼─┼──┼─┤  the layer               each of its facets lies on one unit; it is one
//!   └──┴────┴─┘                                              element thick and goes on over the joints
//! ```

use super::bodies::Bodies;
use super::quantity::Length;
use super::schema::{Deck, DeckBlock, DeckContact, DeckLayer, Lattice, Names};
use crate::element::hexahedron::{Face, area_vector, cross, difference, norm, range};
use crate::error::{ErrorKind, Errors, ModelError};
use std::borrow::Cow;

/// A face is normal to an axis if its unit normal has at least this component along it.
const ALONG: f64 = 1.0 - 1e-6;

/// Faces lie in one plane if their nodes differ by less than this along the normal [mm].
const LEVEL: f64 = 0.01;

/// Lines nearer than this part of the smallest edge of a facet are one line. The contact points of the facets beside it
/// still lie on their units: they are 0.21 of a facet from its edge.
const NEAR: f64 = 0.2;

/// Returns the deck with its layers replaced by blocks and contacts.
///
/// # Errors
/// Faces that are not in one plane normal to an axis; unknown names.
pub(super) fn written_out(deck: &Deck) -> Result<Cow<'_, Deck>, ModelError> {
    if deck.layers.is_empty() {
        return Ok(Cow::Borrowed(deck));
    }
    let mut plain = deck.clone();
    plain.layers.clear();
    let mut errors = Errors::default();
    let made = {
        // As for beams, bodies are built here to find the faces, and a second time with the layers.
        let bodies = Bodies::new(&plain)?;
        let layers = deck.layers.iter().enumerate();
        let made = layers.filter_map(|(i, layer)| errors.keep(lattice(&bodies, deck, i, layer)));
        made.collect::<Vec<_>>()
    };
    let made = errors.end(made)?;
    for (i, (layer, (lattice, face))) in deck.layers.iter().zip(made).enumerate() {
        let paths = [
            format!("blocks.{}", plain.blocks.len()),
            format!("contacts.{}", plain.contacts.len()),
        ];
        for path in paths {
            plain.stands_for(path, format!("layers.{i}"));
        }
        plain.contacts.push(DeckContact {
            slave: Some(Names(vec![format!("{}.{face}", layer.name)])),
            master: Some(layer.on.clone()),
            interface: layer.interface.clone(),
        });
        plain.blocks.push(block(layer, lattice));
    }
    Ok(Cow::Owned(plain))
}

/// The block of a layer.
fn block(layer: &DeckLayer, lattice: Lattice) -> DeckBlock {
    let ends = lattice.lines.each_ref().map(|at| [at[0], at[at.len() - 1]]);
    DeckBlock {
        name: layer.name.clone(),
        size: Some(ends.map(|[low, high]| Length::new(high - low))),
        at: ends.map(|[low, _]| Length::new(low)),
        rotate: None,
        corners: None,
        nodes: None,
        material: layer.material.clone(),
        mesh: lattice.lines.each_ref().map(|at| at.len() as u32 - 1),
        rigid: false,
        velocity: Default::default(),
        stack: None,
        interface: None,
        copies: None,
        pitch: None,
        lattice: Some(lattice),
    }
}

/// Cells of layer `i`, and the name of its face that touches the faces which it covers.
fn lattice(
    bodies: &Bodies<'_>,
    deck: &Deck,
    i: usize,
    layer: &DeckLayer,
) -> Result<(Lattice, &'static str), ModelError> {
    let path = format!("layers.{i}.on");
    let places = bodies.places(&path, &layer.on, true)?;
    let faces = places
        .iter()
        .filter_map(|place| place.face.map(|face| &bodies.all[place.body].faces[face]));
    let facets: Vec<[[f64; 3]; 4]> = faces
        .flat_map(|face| &face.facets)
        .map(|(_, facet)| facet.map(|n| bodies.mesh.nodes[n as usize]))
        .collect();
    let refused = |why: String| {
        let names = layer.on.0.join(", ");
        let help = "name faces of one plane normal to x, y or z, such as on = \"wall.front\"";
        let error = deck.error(&path, format!("{names}: {why}"), help);
        Err(error.of_kind(ErrorKind::Geometry))
    };
    let Some(first) = facets.first().map(area_vector) else {
        return refused("there is no face".to_owned());
    };
    let along = |d: usize| first[d].abs() >= ALONG * norm(first);
    let Some(axis) = (0..3).find(|d| along(*d)) else {
        return refused("the faces are not normal to an axis".to_owned());
    };
    let out = first[axis].signum();
    let aligned = |facet: &[[f64; 3]; 4]| {
        let area = area_vector(facet);
        out * area[axis] >= ALONG * norm(area)
    };
    let [low, high] = range(facets.iter().flatten().map(|x| x[axis]));
    if high - low > LEVEL || !facets.iter().all(aligned) {
        return refused(format!(
            "the faces do not lie in one plane: from {low:.2} to {high:.2} mm along its normal"
        ));
    }
    let lattice = cells_of(&facets, (axis, out), low, layer.thickness.get());
    let touching = 2 * axis + usize::from(out < 0.0);
    Ok((lattice, Face::ALL[touching].0))
}

/// Cells over facets in the plane at `place` normal to an axis, from which the layer extends to the side `out` of it.
fn cells_of(
    facets: &[[[f64; 3]; 4]],
    (axis, out): (usize, f64),
    place: f64,
    thickness: f64,
) -> Lattice {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut lines = [Vec::new(), Vec::new(), Vec::new()];
    for d in [u, v] {
        lines[d] = merged(facets, d);
    }
    let beyond = place + out * thickness;
    lines[axis] = vec![place.min(beyond), place.max(beyond)];
    let cells = lines.each_ref().map(|at| at.len() - 1);
    let mut solid = vec![false; cells.iter().product()];
    let between = |d: usize, [from, to]: [f64; 2]| {
        let middles = lines[d].windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let inside = middles
            .enumerate()
            .filter(move |(_, x)| from < *x && *x < to);
        inside.collect::<Vec<_>>()
    };
    for facet in facets {
        let of = |d: usize| range(facet.iter().map(|x| x[d]));
        for (b, y) in between(v, of(v)) {
            for (a, x) in between(u, of(u)) {
                let mut middle = facet[0];
                (middle[u], middle[v]) = (x, y);
                if covers(facet, middle, axis, out) {
                    let mut at = [0; 3];
                    (at[u], at[v]) = (a, b);
                    solid[(at[2] * cells[1] + at[1]) * cells[0] + at[0]] = true;
                }
            }
        }
    }
    Lattice { lines, solid }
}

/// Coordinates of the corners of the facets along an axis, ascending; near ones are one.
fn merged(facets: &[[[f64; 3]; 4]], d: usize) -> Vec<f64> {
    let mut all: Vec<f64> = facets.iter().flatten().map(|x| x[d]).collect();
    all.sort_by(f64::total_cmp);
    let sizes = facets.iter().map(|facet| {
        let [low, high] = range(facet.iter().map(|x| x[d]));
        high - low
    });
    let near = NEAR * sizes.fold(f64::INFINITY, f64::min);
    let last = all.last().copied().unwrap_or_default();
    let mut lines: Vec<f64> = Vec::new();
    for x in all {
        if lines.last().is_none_or(|line| x - line > near) {
            lines.push(x);
        }
    }
    // The outermost line stays where it is.
    if let Some(end) = lines.last_mut() {
        *end = last;
    }
    lines
}

/// Whether a point lies within a facet whose corners run counter-clockwise about `out` times the axis.
fn covers(facet: &[[f64; 3]; 4], point: [f64; 3], axis: usize, out: f64) -> bool {
    (0..4).all(|k| {
        let (a, b) = (facet[k], facet[(k + 1) % 4]);
        out * cross(difference(b, a), difference(point, a))[axis] >= 0.0
    })
}
