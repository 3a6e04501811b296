//! Layers on faces: converts `[[layers]]` to blocks and contacts.
//!
//! ```text
//!   ┌────┬────┐                 lines of the layer: those of all units' meshes, and at each joint two, half of the
//!   ├──┬─┴──┬─┤   ──▶  ══╪═╪══  unbonded length beside it. The cells between these two have no contact where they lie
//!   └──┴────┴─┘                 on a joint, so that they stretch by its opening alone; the others are bonded.
//! ```

use super::bodies::Bodies;
use super::quantity::Length;
use super::schema::{Deck, DeckBlock, DeckContact, DeckLayer, Lattice, Names, NotConvex};
use crate::element::hexahedron::{Face, area_vector, cross, difference, norm, range};
use crate::error::{ErrorKind, Errors, ModelError};
use std::borrow::Cow;

/// A face is normal to an axis if its unit normal has at least this component along it.
const ALONG: f64 = 1.0 - 1e-6;

/// Faces lie in one plane if their nodes differ by less than this along the normal [mm].
const LEVEL: f64 = 0.01;

/// Lines nearer than this part of the smallest edge of a facet, or of half of the unbonded length, are one line.
const NEAR: f64 = 0.2;

/// Largest part of the smallest edge of a unit that is unbonded at each of its ends.
const MOST_UNBONDED: f64 = 0.3;

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

/// Names of the bodies of layers.
pub(super) fn names(deck: &Deck) -> Vec<String> {
    let layers = deck.blocks.iter().filter(|block| block.lattice.is_some());
    layers.map(|block| block.name.clone()).collect()
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
        file: None,
        units: None,
        thickness: None,
        not_convex: NotConvex::default(),
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
    let units: Vec<Vec<[[f64; 3]; 4]>> = faces
        .map(|face| {
            let facets = face.facets.iter();
            let corners = facets.map(|(_, facet)| facet.map(|n| bodies.mesh.nodes[n as usize]));
            corners.collect()
        })
        .collect();
    let facets = || units.iter().flatten();
    let refused = |why: String| {
        let names = layer.on.0.join(", ");
        let help = "name faces of one plane normal to x, y or z, such as on = \"wall.front\"";
        let error = deck.error(&path, format!("{names}: {why}"), help);
        Err(error.of_kind(ErrorKind::Geometry))
    };
    let Some(first) = facets().next().map(area_vector) else {
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
    let [low, high] = range(facets().flatten().map(|x| x[axis]));
    if high - low > LEVEL || !facets().all(aligned) {
        return refused(format!(
            "the faces do not lie in one plane: from {low:.2} to {high:.2} mm along its normal"
        ));
    }
    let touching = 2 * axis + usize::from(out < 0.0);
    let cover = Cover { units, axis, out };
    let half = half_unbonded(bodies, &format!("layers.{i}"), layer, &cover)?;
    let thickness = layer.thickness.get();
    let lattice = cover.lattice(low, thickness, half, touching);
    Ok((lattice, Face::ALL[touching].0))
}

/// Half of the unbonded length at a joint [mm], at most a part of the smallest unit. By default it is the length √(E t
/// (1/k_s + t/3G)) over which a membrane of thickness t takes over its force from the units, through the bond's k_s and
/// its own shear, which decreases linearly over its thickness (docs/decisions/layers-over-joints.md).
///
/// # Errors
/// A given length that is longer; unknown material.
fn half_unbonded(
    bodies: &Bodies<'_>,
    path: &str,
    layer: &DeckLayer,
    cover: &Cover,
) -> Result<f64, ModelError> {
    let smallest = cover.extents().flatten();
    let smallest = smallest.map(|[low, high]| high - low);
    let most = MOST_UNBONDED * smallest.fold(f64::INFINITY, f64::min);
    if let Some(length) = layer.unbonded {
        let half = 0.5 * length.get();
        if half <= most {
            return Ok(half);
        }
        let error = bodies.deck.error(
            &format!("{path}.unbonded"),
            "this is more than 0.6 of the smallest edge of a unit below the layer",
            &format!("at most {:.1} mm, or no value for the default", 2.0 * most),
        );
        return Err(error.of_kind(ErrorKind::Geometry));
    }
    let law = bodies.parameters(&layer.material)?;
    let (solid, t) = (law.elastic(), layer.thickness.get());
    let bond = bodies.deck.interfaces.get(&layer.interface);
    let k_s = bond.and_then(|bond| bond.shear_stiffness);
    let soft = k_s.map_or(0.0, |k_s| solid.E * t / k_s.get());
    let half = (soft + t * t * (1.0 + solid.nu) * (2.0 / 3.0)).sqrt();
    Ok(half.min(most))
}

/// Faces of units in a plane normal to an axis.
struct Cover {
    /// Facets of each unit. `[unit][facet][corner][xyz]`
    units: Vec<Vec<[[f64; 3]; 4]>>,
    /// The axis.
    axis: usize,
    /// Whether the units end at the plane upwards along the axis (1) or downwards (−1).
    out: f64,
}

impl Cover {
    /// Directions in the plane.
    fn plane(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Extents of each unit along the directions in the plane [mm].
    fn extents(&self) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
        let of = |unit: &Vec<[[f64; 3]; 4]>, d: usize| range(unit.iter().flatten().map(|x| x[d]));
        self.units
            .iter()
            .map(move |unit| self.plane().map(|d| of(unit, d)))
    }

    /// Cells over the units in the plane at `place`, of this thickness, whose face `touching` is bonded to them.
    fn lattice(&self, place: f64, thickness: f64, half: f64, touching: usize) -> Lattice {
        let [u, v] = self.plane();
        let mut lines = [Vec::new(), Vec::new(), Vec::new()];
        for (k, d) in [u, v].into_iter().enumerate() {
            lines[d] = self.lines(k, half);
        }
        let beyond = place + self.out * thickness;
        lines[self.axis] = vec![place.min(beyond), place.max(beyond)];
        let cells = lines.each_ref().map(|at| at.len() - 1);
        let mut solid = vec![false; cells.iter().product()];
        let mut bonded = solid.clone();
        for b in 0..cells[v] {
            for a in 0..cells[u] {
                let (mut at, mut corner) = ([0; 3], [place; 3]);
                (at[u], at[v]) = (a, b);
                let cell = (at[2] * cells[1] + at[1]) * cells[0] + at[0];
                // The middle, and points near the corners.
                let points = [
                    [0.5, 0.5],
                    [0.01, 0.01],
                    [0.99, 0.01],
                    [0.99, 0.99],
                    [0.01, 0.99],
                ];
                let owners = points.map(|part| {
                    for (d, (k, part)) in [u, v].into_iter().zip([a, b].into_iter().zip(part)) {
                        corner[d] = lines[d][k] + part * (lines[d][k + 1] - lines[d][k]);
                    }
                    self.unit_at(corner)
                });
                solid[cell] = owners.iter().all(Option::is_some);
                bonded[cell] = solid[cell] && owners.iter().all(|unit| *unit == owners[0]);
            }
        }
        Lattice {
            lines,
            solid,
            bonded,
            touching,
        }
    }

    /// Unit whose face has a point of the plane.
    fn unit_at(&self, point: [f64; 3]) -> Option<usize> {
        let on = |unit: &Vec<[[f64; 3]; 4]>| {
            let mut facets = unit.iter();
            facets.any(|facet| covers(facet, point, self.axis, self.out))
        };
        self.units.iter().position(on)
    }

    /// Lines along direction `k` of the plane, ascending [mm]: those of the meshes, and two beside each joint.
    fn lines(&self, k: usize, half: f64) -> Vec<f64> {
        let d = self.plane()[k];
        let facets = || self.units.iter().flatten();
        let [first, last] = range(facets().flatten().map(|x| x[d]));
        let sizes = facets().map(|facet| {
            let [low, high] = range(facet.iter().map(|x| x[d]));
            high - low
        });
        let near = NEAR * sizes.fold(half, f64::min);
        let inside = |x: &f64| first + near < *x && *x < last - near;
        let ends = self.extents().flat_map(|extent| extent[k]);
        let joints = distinct(ends.filter(inside).collect(), near);
        let of_meshes = facets().flatten().map(|x| x[d]);
        let beside = |x: &f64| joints.iter().all(|joint| (x - joint).abs() > half + near);
        let mut lines: Vec<f64> = of_meshes.filter(beside).collect();
        lines.extend(joints.iter().flat_map(|joint| [joint - half, joint + half]));
        lines.retain(inside);
        let mut lines = distinct(lines, near);
        lines.insert(0, first);
        lines.push(last);
        lines
    }
}

/// Sorted values, without those that follow another one within `near`.
fn distinct(mut values: Vec<f64>, near: f64) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup_by(|next, kept| *next - *kept <= near);
    values
}

/// Whether a point lies within a facet whose corners run counter-clockwise about `out` times the axis.
fn covers(facet: &[[f64; 3]; 4], point: [f64; 3], axis: usize, out: f64) -> bool {
    (0..4).all(|k| {
        let (a, b) = (facet[k], facet[(k + 1) % 4]);
        out * cross(difference(b, a), difference(point, a))[axis] >= 0.0
    })
}
