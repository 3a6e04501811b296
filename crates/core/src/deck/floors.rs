//! Floors of a deck: masses on the faces that carry them, and ties between them (theory/ties.md).
//!
//! ```text
//!   plan          side: a face along x
//!   ┌──────────────────────────┐
//!   └──o─────o─────o─────o─────┘   o  bearing: the facet nearest to the joist
//!      │\   /│\   /│\   /│          │  joist, E A for the width that it carries
//!      │  X  │  X  │  X  │ D        X  braces: shear stiffness G t
//!      │/   \│/   \│/   \│
//!   ┌──o─────o─────o─────o─────┐
//!   └──────────────────────────┘
//! ```
//!
//! The first face gives the directions of the floor in plan, u along it and v across, towards the next face along u.
//! Faces along u are sides that face each other along v, and faces along v those along u. Sides are taken in order, and
//! the floor spans from each to the next. A floor with sides in both directions spans both ways, half of it each way.

mod bay;

use super::bodies::Bodies;
use super::plan::{self, PlanFrame};
use super::quantity::{GRAVITY, Quantity};
use super::schema::{Deck, DeckFloor, Names};
use crate::element::facet;
use crate::element::hexahedron::{area_vector, norm, range};
use crate::error::{ErrorKind, Errors, ModelError};
use crate::model::floors::Floor;
use crate::model::scene::Step;
use crate::model::ties::{Tie, TieLaw, TieStage};
use bay::{Bay, Bearing, Side};

/// Thickness of the width that a strand of a tie stands for [mm]: its Young's modulus is then a membrane stiffness.
const UNIT_THICKNESS: f64 = 1.0;

/// Floors of a deck, and their ties, which are there from the first step.
///
/// # Errors
/// Unknown faces, sides without an opposite one, no bearings.
pub(super) fn floors(
    deck: &Deck,
    bodies: &Bodies<'_>,
    steps: &mut [Step],
) -> Result<(Vec<Floor>, Vec<Tie>), ModelError> {
    let (mut floors, mut ties) = (Vec::new(), Vec::new());
    let mut errors = Errors::default();
    for (i, floor) in deck.floors.iter().enumerate() {
        if let Some((made, tied)) = errors.keep(floor_of(deck, bodies, i, floor)) {
            floors.push(made);
            ties.extend(tied);
        }
    }
    for step in steps {
        step.ties.extend(ties.iter().map(|_| TieStage::Fixed));
    }
    errors.end((floors, ties))
}

/// The floor of entry `i` and its ties.
fn floor_of(
    deck: &Deck,
    bodies: &Bodies<'_>,
    i: usize,
    floor: &DeckFloor,
) -> Result<(Floor, Vec<Tie>), ModelError> {
    let path = format!("floors.{i}.on");
    let sides = sides(deck, bodies, &path, &floor.on)?;
    let bays = bays(deck, &path, floor, &sides)?;
    let ways = sides.iter().filter(|sides| !sides.is_empty()).count() as f64;
    let area = bays.iter().map(Bay::area).sum::<f64>() / ways;
    let load = floor.load.map(|load| load.get() * area / GRAVITY);
    let mass = load.or(floor.mass.map(Quantity::get)).unwrap_or(0.0);
    let mut masses = Vec::new();
    for bay in &bays {
        for side in 0..2 {
            let part = 0.5 * mass * bay.area() / (ways * area);
            hang(&mut masses, &bay.bearings(side).collect::<Vec<_>>(), part);
        }
    }
    if bays.is_empty() {
        let all = sides.iter().flatten().flat_map(|side| &side.bearings);
        hang(&mut masses, &all.collect::<Vec<_>>(), mass);
    }
    masses.sort_by_key(|(node, _)| *node);
    masses.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    let made = Floor {
        name: floor.name.clone(),
        area,
        masses,
    };
    let ties = tied(deck, &path, floor, (&bays, ways))?;
    Ok((made, ties))
}

/// Ties of a floor: its joists and its braces.
///
/// # Errors
/// A stiffness without springs: fewer than two joists find facets on both sides.
fn tied(
    deck: &Deck,
    path: &str,
    floor: &DeckFloor,
    (bays, ways): (&[Bay<'_>], f64),
) -> Result<Vec<Tie>, ModelError> {
    let (spacing, [axial, shear]) = (floor.spring_spacing(), floor.stiffness());
    let all = bays.iter().fold([Vec::new(), Vec::new()], |mut all, bay| {
        let own = bay.strands(spacing, [axial, shear / ways]);
        all.iter_mut()
            .zip(own)
            .for_each(|(all, own)| all.extend(own));
        all
    });
    let mut ties = Vec::new();
    // Springs of a floor that spans both ways resist shear twice.
    for (((name, stiffness), strands), ways) in floor.ties().into_iter().zip(all).zip([1.0, ways]) {
        if stiffness == 0.0 {
            continue;
        }
        if strands.is_empty() {
            let message =
                format!("there is no room for {name}: too few facets lie opposite each other");
            let help = "joists join facets of opposite sides, braces need two joists: divide blocks by `mesh`";
            let error = deck.error(path, message, help);
            return Err(error.of_kind(ErrorKind::Geometry));
        }
        let (strands, widths): (Vec<_>, Vec<_>) = strands.into_iter().unzip();
        ties.push(Tie {
            name,
            law: TieLaw {
                area: UNIT_THICKNESS,
                E: stiffness / UNIT_THICKNESS,
                f_y: f64::INFINITY,
                hardening: 0.0,
                rupture: f64::INFINITY,
                compression: true,
            },
            strands,
            shares: widths.iter().map(|width| width / ways).collect(),
        });
    }
    Ok(ties)
}

/// Spreads a mass evenly over the area of facets.
fn hang(masses: &mut Vec<(u32, f64)>, on: &[&Bearing], mass: f64) {
    let area: f64 = on.iter().map(|bearing| bearing.area).sum();
    for bearing in on.iter().filter(|_| mass > 0.0) {
        let parts = bearing
            .shares
            .map(|share| share * mass * bearing.area / area);
        masses.extend(bearing.nodes.into_iter().zip(parts));
    }
}

/// Sides that face each other along u, and those that face each other along v, in order.
fn sides(
    deck: &Deck,
    bodies: &Bodies<'_>,
    path: &str,
    on: &Names,
) -> Result<[Vec<Side>; 2], ModelError> {
    let wrong = |message: String, help: &str| {
        let error = deck.error(path, message, help);
        Err(error.of_kind(ErrorKind::Geometry))
    };
    let mut faces = Vec::new();
    let mut first: Option<(f64, &str)> = None;
    for name in &on.0 {
        let places = bodies.places(path, &Names(vec![name.clone()]), true)?;
        let facets: Vec<_> = places
            .iter()
            .flat_map(|place| bodies.facets(*place))
            .collect();
        let corners = |nodes: &[u32; 4]| nodes.map(|n| bodies.mesh.nodes[n as usize]);
        let angle = plan::angle(facets.iter().map(|(_, nodes)| corners(nodes)));
        let (floor, of) = *first.get_or_insert((angle, name));
        let apart = plan::away(angle, floor).abs();
        if apart > plan::PARALLEL {
            let message = format!("{name} is turned by {apart:.1} degrees against {of}");
            return wrong(
                message,
                "sides of a floor are parallel or at right angles in plan",
            );
        }
        faces.push((name, facets));
    }
    let sides_in = |frame: PlanFrame| -> Result<Vec<(usize, Side)>, String> {
        let x = &bodies.mesh.nodes;
        let sides = faces
            .iter()
            .map(|(name, facets)| side(name, facets, &frame, x));
        sides.collect()
    };
    let frame = PlanFrame::of(first.map_or(0.0, |(angle, _)| angle));
    let oriented = |sides: Vec<_>| sides_in(frame.turned(quarters(&sides)));
    let found = match sides_in(frame).and_then(oriented) {
        Ok(found) => found,
        Err(message) => return wrong(message, "name faces of walls"),
    };
    let mut sides = [Vec::new(), Vec::new()];
    for (along, side) in found {
        sides[1 - along].push(side);
    }
    for sides in &mut sides {
        sides.sort_by(|a: &Side, b: &Side| a.across.total_cmp(&b.across));
    }
    Ok(sides)
}

/// Quarters of a turn of the directions after which the first side lies along u, and the next one along u beyond it:
/// rounding then decides nothing, however the floor is turned.
fn quarters(sides: &[(usize, Side)]) -> usize {
    let Some((along, first)) = sides.first() else {
        return 0;
    };
    let mut others = sides.iter().skip(1).filter(|(other, _)| other == along);
    let is_beyond = others
        .next()
        .is_none_or(|(_, next)| next.across > first.across);
    match (*along == 0, is_beyond) {
        (true, true) => 0,
        (true, false) => 2,
        (false, true) => 3,
        (false, false) => 1,
    }
}

/// The side of these facets, and whether it lies along u or v.
///
/// # Errors
/// A message about a face that is as wide as it is long.
fn side(
    name: &str,
    facets: &[(usize, [u32; 4])],
    frame: &PlanFrame,
    x: &[[f64; 3]],
) -> Result<(usize, Side), String> {
    let corners = |nodes: &[u32; 4]| nodes.map(|n| x[n as usize]);
    let extent = |axis: usize| {
        let all = facets.iter().flat_map(|(_, nodes)| corners(nodes));
        range(all.map(|x| frame.plan(x)[axis]))
    };
    let [u, v] = [extent(0), extent(1)];
    let (long_u, long_v) = (u[1] - u[0], v[1] - v[0]);
    if (long_u - long_v).abs() <= 0.1 * long_u.max(long_v) {
        return Err(format!(
            "{name} is {long_u:.0} by {long_v:.0} mm in plan: a side of a floor is long and narrow"
        ));
    }
    let along = usize::from(long_v > long_u);
    let bearing = |(element, nodes): &(usize, [u32; 4])| {
        let corners = corners(nodes);
        let middle = |d: usize| 0.25 * corners.iter().map(|x| x[d]).sum::<f64>();
        let at = [0, 1, 2].map(middle);
        let plan = frame.plan(at);
        let reach = corners
            .iter()
            .map(|x| (frame.plan(*x)[along] - plan[along]).abs());
        Bearing {
            element: *element,
            nodes: *nodes,
            shares: facet::shares(&corners),
            at,
            plan,
            area: norm(area_vector(&corners)),
            half: reach.fold(0.0, f64::max),
        }
    };
    let bearings: Vec<Bearing> = facets.iter().map(bearing).collect();
    let across = bearings.iter().map(|b| b.plan[1 - along]).sum::<f64>();
    let side = Side {
        name: name.to_owned(),
        across: across / bearings.len() as f64,
        bearings,
        ends: [u, v][along],
    };
    Ok((along, side))
}

/// The bays between sides.
fn bays<'a>(
    deck: &Deck,
    path: &str,
    floor: &DeckFloor,
    sides: &'a [Vec<Side>; 2],
) -> Result<Vec<Bay<'a>>, ModelError> {
    let wrong = |message: String, help: &str| {
        let error = deck.error(path, message, help);
        Err(error.of_kind(ErrorKind::Geometry))
    };
    let springs = floor.stiffness() != [0.0; 2];
    let one = sides.iter().map(Vec::len).sum::<usize>() == 1;
    if one && floor.load.is_none() && !springs {
        return Ok(Vec::new()); // a mass on one wall
    }
    let mut bays = Vec::new();
    for (span, sides) in sides.iter().enumerate() {
        let along = 1 - span;
        if let [alone] = &sides[..] {
            return wrong(
                format!("no face lies opposite {}", alone.name),
                "a floor spans between faces; a `mass` alone may hang on one face",
            );
        }
        for pair in sides.windows(2) {
            let [a, b] = pair else { continue };
            let ends = [a.ends[0].max(b.ends[0]), a.ends[1].min(b.ends[1])];
            let bay = Bay {
                sides: [a, b],
                along,
                ends,
            };
            let bears = ends[0] < ends[1] && bay.span() > 0.0;
            if !bears || (0..2).any(|side| bay.bearings(side).next().is_none()) {
                let names = format!("{} and {}", a.name, b.name);
                let help = "a floor spans between faces that stand opposite each other";
                return wrong(format!("{names} do not face each other"), help);
            }
            bays.push(bay);
        }
    }
    Ok(bays)
}
