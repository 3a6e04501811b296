//! Layers on faces: converts `[[layers]]` to blocks and contacts.
//!
//! ```text
//!   ┌────┬────┐                 lines of the layer: those of all units' meshes, and at each joint two, half of the
//!   ├──┬─┴──┬─┤   ──▶  ══╪═╪══  unbonded length beside it. The cells between these two have no contact where they lie
//!   └──┴────┴─┘                 on a joint, so that they stretch by its opening alone; the others are bonded.
//! ```

use super::amount::MOST_ELEMENTS;
use super::beams::LEVEL;
use super::bodies::Bodies;
use super::quantity::Length;
use super::schema::{Deck, DeckBlock, DeckContact, DeckLayer, Lattice, Names, NotConvex};
use crate::element::hexahedron::{Face, area_vector, cross, difference, norm, range};
use crate::error::{ErrorKind, ModelError};
use std::borrow::Cow;

/// A face is normal to an axis if its unit normal has at least this component along it.
const ALONG: f64 = 1.0 - 1e-6;

/// Lines nearer than this part of the smallest edge of a facet, or of half of the unbonded length, are one line.
const NEAR: f64 = 0.2;

/// Middle of a cell, and places near its corners.
const POINTS: [[f64; 2]; 5] = [
    [0.5, 0.5],
    [0.01, 0.01],
    [0.99, 0.01],
    [0.99, 0.99],
    [0.01, 0.99],
];

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
    let made = Bodies::measured(&plain, &deck.layers, |bodies, i, layer| {
        lattice(bodies, deck, i, layer)
    })?;
    for (i, (layer, lattice)) in deck.layers.iter().zip(made).enumerate() {
        let paths = [
            format!("blocks.{}", plain.blocks.len()),
            format!("contacts.{}", plain.contacts.len()),
        ];
        for path in paths {
            plain.stands_for(path, format!("layers.{i}"));
        }
        let face = Face::ALL[lattice.touching].0;
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

/// Cells of layer `i`.
fn lattice(
    bodies: &Bodies<'_>,
    deck: &Deck,
    i: usize,
    layer: &DeckLayer,
) -> Result<Lattice, ModelError> {
    let path = format!("layers.{i}.on");
    let places = bodies.places(&path, &layer.on, true)?;
    let units: Vec<Vec<[[f64; 3]; 4]>> = places
        .iter()
        .map(|place| {
            let facets = bodies.open_facets(*place).0.into_iter();
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
    let lines = cover.lines(half, [low, low + out * thickness]);
    let cells: f64 = lines.iter().map(|at| at.len() as f64 - 1.0).product();
    if cells > MOST_ELEMENTS {
        let help = "at most 5e5: let several layers cover parts of the faces";
        let error = deck.error(
            &path,
            format!("the layer has {cells} cells: too many"),
            help,
        );
        return Err(error.of_kind(ErrorKind::TooMany));
    }
    let lattice = cover.lattice(lines, touching);
    if !lattice.bonded.contains(&true) {
        return refused("no element of the layer lies on one unit alone".to_owned());
    }
    Ok(lattice)
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

    /// Cells between `lines` over the units, whose face `touching` is bonded to them.
    fn lattice(&self, lines: [Vec<f64>; 3], touching: usize) -> Lattice {
        let [u, v] = self.plane();
        let cells = lines.each_ref().map(|at| at.len() - 1);
        // Units at the middle of each cell and near its corners.
        let mut owners = vec![[None; POINTS.len()]; cells.iter().product()];
        for (unit, facets) in self.units.iter().enumerate() {
            for facet in facets {
                let of = |d: usize| {
                    let [low, high] = range(facet.iter().map(|x| x[d]));
                    let first = lines[d].partition_point(|x| *x <= low).saturating_sub(1);
                    first..lines[d].partition_point(|x| *x < high).min(cells[d])
                };
                for b in of(v) {
                    for a in of(u) {
                        let mut at = [0; 3];
                        (at[u], at[v]) = (a, b);
                        let owners = &mut owners[(at[2] * cells[1] + at[1]) * cells[0] + at[0]];
                        for (owner, part) in owners.iter_mut().zip(POINTS) {
                            let mut point = facet[0];
                            for (d, k, part) in [(u, a, part[0]), (v, b, part[1])] {
                                point[d] = lines[d][k] + part * (lines[d][k + 1] - lines[d][k]);
                            }
                            if owner.is_none() && covers(facet, point, self.axis, self.out) {
                                *owner = Some(unit);
                            }
                        }
                    }
                }
            }
        }
        let is_solid = |owners: &[Option<usize>; 5]| owners.iter().all(Option::is_some);
        let is_one = |owners: &[Option<usize>; 5]| owners.iter().all(|unit| *unit == owners[0]);
        Lattice {
            lines,
            solid: owners.iter().map(is_solid).collect(),
            bonded: (owners.iter()).map(|o| is_solid(o) && is_one(o)).collect(),
            touching,
        }
    }

    /// Lines along x, y, z, ascending [mm]; along the axis those of its two faces.
    fn lines(&self, half: f64, [near, far]: [f64; 2]) -> [Vec<f64>; 3] {
        let mut lines = [0, 1, 2].map(|_| vec![near.min(far), near.max(far)]);
        for (k, d) in self.plane().into_iter().enumerate() {
            lines[d] = self.lines_along(k, half);
        }
        lines
    }

    /// Lines along direction `k` of the plane, ascending [mm]: those of the meshes, and two beside each joint.
    fn lines_along(&self, k: usize, half: f64) -> Vec<f64> {
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
        let beside = |x: &f64| {
            let after = joints.partition_point(|joint| joint <= x);
            let mut nearest = joints[after.saturating_sub(1)..].iter().take(2);
            nearest.all(|joint| (x - joint).abs() > half + near)
        };
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
