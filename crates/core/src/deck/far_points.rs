//! Points of probes and loads that lie in no body.

use super::quantity::{Length, Quantity};
use super::schema::Deck;
use crate::element::hexahedron::{difference, norm};
use crate::error::Warning;
use crate::model::{Mesh, Model};

/// A point as near as this part of the diagonal of an element lies at its face: lengths in decks are rounded.
const AT_FACE: f64 = 0.01;

/// Warnings about points of `near` and `gauge` outside all elements, which take the motion or the force of a node that
/// may be far away.
pub(super) fn far_points(deck: &Deck, model: &Model) -> Vec<Warning> {
    let points = points(deck);
    if points.is_empty() {
        return Vec::new();
    }
    let mut inside = vec![false; points.len()];
    for e in 0..model.mesh.elements.len() {
        let corners = model.mesh.corners(e);
        for ((_, point), inside) in points.iter().zip(&mut inside) {
            *inside = *inside || holds(&corners, *point);
        }
    }
    let outside = points.iter().zip(inside).filter(|(_, inside)| !inside);
    let told = outside.map(|((path, point), _)| {
        let (distance, [x, y, z]) = nearest_node(&model.mesh, *point);
        let message = format!(
            "the point lies in no body: the nearest node is {distance:.4} mm away, at [{x:.4}, {y:.4}, {z:.4}]"
        );
        deck.warning(path, message)
    });
    told.collect()
}

/// All points by their keys. Those of probes with `on` name a body themselves.
fn points(deck: &Deck) -> Vec<(String, [f64; 3])> {
    let mut all = Vec::new();
    let mut add = |path: String, point: [Length; 3]| all.push((path, point.map(Quantity::get)));
    for (i, probe) in deck.probes.iter().enumerate() {
        if probe.on.is_none() {
            if let Some(near) = probe.near {
                add(format!("probes.{i}.near"), near);
            }
            for (k, end) in probe.gauge.iter().flatten().enumerate() {
                add(format!("probes.{i}.gauge.{k}"), *end);
            }
        }
        let minus = probe.minus.as_ref();
        if let Some(near) = minus
            .filter(|minus| minus.on.is_none())
            .and_then(|minus| minus.near)
        {
            add(format!("probes.{i}.minus.near"), near);
        }
    }
    for (s, step) in deck.steps.iter().enumerate() {
        for (l, load) in step.loads.iter().enumerate() {
            if let Some(near) = load.near {
                add(format!("steps.{s}.loads.{l}.near"), near);
            }
        }
    }
    all
}

/// Whether a point lies in the box around an element.
fn holds(corners: &[[f64; 3]; 8], point: [f64; 3]) -> bool {
    let slack = AT_FACE * norm(difference(corners[6], corners[0]));
    (0..3).all(|i| {
        let along = corners.iter().map(|corner| corner[i]);
        let least = along.clone().fold(f64::INFINITY, f64::min);
        let most = along.fold(f64::NEG_INFINITY, f64::max);
        (least - slack..=most + slack).contains(&point[i])
    })
}

/// Distance [mm] and place of the node of the solids that is nearest to a point.
fn nearest_node(mesh: &Mesh, point: [f64; 3]) -> (f64, [f64; 3]) {
    let nodes = mesh.nodes_of_solids();
    let away = nodes.iter().map(|n| mesh.nodes[*n as usize]);
    let away = away.map(|x| (norm(difference(x, point)), x));
    away.min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((f64::INFINITY, point))
}
