//! Probes: places whose motion is a column of the history.

use super::bodies::Bodies;
use super::keys;
use super::quantity::{Length, Quantity};
use super::schema::{Deck, DeckPlace, DeckProbe, DeckStep, Heading, Names};
use crate::element::hexahedron::{difference, norm};
use crate::error::{ErrorKind, Errors, ModelError};
use crate::model::Mesh;
use crate::model::probes::Probe;
use crate::model::probes::ProbeQuantity;
use crate::model::scene::Control;

/// The displacement that controls a step, if it has displacement control.
///
/// # Errors
/// Unknown probe, or a probe of velocity.
pub(super) fn control(
    deck: &Deck,
    index: usize,
    step: &DeckStep,
) -> Result<Option<Control>, ModelError> {
    let Some(control) = &step.control else {
        return Ok(None);
    };
    let path = format!("steps.{index}.control.probe");
    let name = &control.probe;
    let Some(probe) = deck.probes.iter().position(|p| p.name == *name) else {
        let help = keys::example("probes");
        return Err(deck
            .error(&path, format!("there is no probe named `{name}`"), &help)
            .of_kind(ErrorKind::UnknownName));
    };
    let measured = match deck.probes[probe].quantity {
        ProbeQuantity::Displacement => "",
        ProbeQuantity::Velocity => "velocity",
        ProbeQuantity::Drift => "drift",
    };
    if !measured.is_empty() {
        return Err(deck
            .error(
                &path,
                format!("the probe `{name}` measures a {measured}"),
                "a displacement steers the load: name a probe of one",
            )
            .of_kind(ErrorKind::UnknownName));
    }
    Ok(Some(Control {
        probe,
        displacement: control.displacement.get(),
    }))
}

/// Resolves the names at a path to nodes.
type Named<'a> = dyn Fn(&str, &Names) -> Result<Vec<u32>, ModelError> + 'a;

/// Probes of a deck.
///
/// # Errors
/// Unknown names, points far from all nodes.
pub(super) fn probes(deck: &Deck, bodies: &Bodies<'_>) -> Result<Vec<Probe>, ModelError> {
    let named = |path: &str, names: &Names| {
        let places = bodies.places(path, names, false)?;
        Ok(bodies.nodes(&places))
    };
    let (mesh, named): (&Mesh, &Named<'_>) = (&bodies.mesh, &named);
    let probe = |(i, probe): (usize, &DeckProbe)| {
        let path = format!("probes.{i}");
        let DeckProbe { on, near, .. } = probe.clone();
        if let Some(ends) = probe.gauge {
            return gauge(deck, mesh, named, (i, probe), ends);
        }
        let direction = probe.direction.map_or([0.0; 3], Heading::unit);
        let minus = probe.minus.as_ref().map_or(Ok(Vec::new()), |place| {
            nodes(deck, mesh, named, &format!("{path}.minus"), place)
        })?;
        let nodes = nodes(deck, mesh, named, &path, &DeckPlace { on, near })?;
        Ok(Probe {
            column: probe.column(),
            over: over(deck, mesh, (&path, probe), [&nodes, &minus])?,
            nodes,
            minus,
            direction,
            quantity: probe.quantity,
        })
    };
    let mut errors = Errors::default();
    let all = deck.probes.iter().enumerate();
    let all = all.filter_map(|one| errors.keep(probe(one))).collect();
    errors.end(all)
}

/// The probe of a gauge: motion of the node nearest to its second end, less that of the node nearest to its first
/// end, along the line from node to node or along the `direction` of the deck.
///
/// # Errors
/// Points far from all nodes; one node nearest to both ends.
fn gauge(
    deck: &Deck,
    mesh: &Mesh,
    named: &Named<'_>,
    (i, probe): (usize, &DeckProbe),
    ends: [[Length; 3]; 2],
) -> Result<Probe, ModelError> {
    let path = format!("probes.{i}");
    let end = |near| {
        let on = probe.on.clone();
        let place = DeckPlace {
            on,
            near: Some(near),
        };
        Ok(nodes(deck, mesh, named, &path, &place)?[0])
    };
    let [first, second] = [end(ends[0])?, end(ends[1])?];
    if first == second {
        return Err(deck
            .error(
                &format!("{path}.gauge"),
                "one node is the nearest to both ends",
                "ends farther apart, or a finer mesh: nodes lie on the lines of the mesh",
            )
            .of_kind(ErrorKind::Geometry));
    }
    let between = difference(mesh.nodes[second as usize], mesh.nodes[first as usize]);
    let line = || {
        let length = norm(between);
        between.map(|x| x / length)
    };
    Ok(Probe {
        column: probe.column(),
        nodes: vec![second],
        minus: vec![first],
        direction: probe.direction.map_or_else(line, Heading::unit),
        quantity: probe.quantity,
        over: 1.0,
    })
}

/// Length by which the motion of a probe is divided [mm].
///
/// # Errors
/// A drift between places of one height.
fn over(
    deck: &Deck,
    mesh: &Mesh,
    (path, probe): (&str, &DeckProbe),
    places: [&[u32]; 2],
) -> Result<f64, ModelError> {
    if probe.quantity != ProbeQuantity::Drift {
        return Ok(1.0);
    }
    let mean = |nodes: &[u32]| {
        let all = nodes.iter().map(|n| mesh.nodes[*n as usize][2]);
        all.sum::<f64>() / nodes.len().max(1) as f64
    };
    let [above, below] = places.map(mean);
    let height = (above - below).abs();
    // Rounding of coordinates and of their mean.
    if height > LEVEL * mesh.diagonal() {
        return Ok(height);
    }
    let message = "a drift is a displacement over a height, and both places have the same height";
    let help = "name a place above and, by `minus`, one below";
    let error = deck.error(&format!("{path}.minus"), message, help);
    Err(error.of_kind(ErrorKind::Geometry))
}

/// Part of the size of the model within which two heights are the same.
const LEVEL: f64 = 1e-9;

/// Nodes of a place, ascending: those of its names, or the one of these (or of all) nearest to its point. Of
/// several equally near nodes the first is taken.
fn nodes(
    deck: &Deck,
    mesh: &Mesh,
    named: &Named<'_>,
    path: &str,
    place: &DeckPlace,
) -> Result<Vec<u32>, ModelError> {
    let nodes = match &place.on {
        // `minus = "base"` has no key `on`; an error then points at the table above.
        Some(names) => named(&format!("{path}.on"), names)?,
        None => mesh.nodes_of_solids(),
    };
    let Some(near) = place.near else {
        return Ok(nodes);
    };
    Ok(vec![nearest(deck, mesh, &nodes, near, path)?])
}

/// The node nearest to `near`, a key of `path`.
///
/// # Errors
/// A point farther from all nodes than the size of the model.
pub(super) fn nearest(
    deck: &Deck,
    mesh: &Mesh,
    nodes: &[u32],
    near: [Length; 3],
    path: &str,
) -> Result<u32, ModelError> {
    let near = near.map(Quantity::get);
    let away = |n: u32| norm(difference(mesh.nodes[n as usize], near));
    let nearest = nodes.iter().map(|&n| (away(n), n));
    let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
    let size = mesh.diagonal();
    match nearest {
        Some((distance, node)) if distance <= size => Ok(node),
        _ => {
            let distance = nearest.map_or(f64::INFINITY, |n| n.0);
            Err(deck.error(
                &format!("{path}.near"),
                format!(
                    "the nearest node is {distance:.4} mm away, farther than the model is large \
                     ({size:.4} mm)"
                ),
                "see that the unit of length is right: bare numbers are in mm",
            ).of_kind(ErrorKind::Geometry))
        }
    }
}
