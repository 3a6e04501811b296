//! Loading beams: converts `[[beams]]` to blocks, contacts and springs.
//!
//! ```text
//!   p, over the beam's area                  a beam that turns: a stiff block on the faces, its weight and load
//!    | | | | | | |                           spread over it, a jack (spring) that moves the mean of its nodes;
//!  ┌───────────────┐                         one that stays level: the same block, whose top is a face that
//!  │       x ──>   │ depth   d, at half of it  moves as one
//!  ├──┬──┬──┬──┬───┤
//! ```

use super::bodies::Bodies;
use super::plan::{self, PlanFrame};
use super::quantity::{Angle, Density, Force, Length, Number, Pressure, Quantity, SpringStiffness};
use super::rigid;
use super::schema::{
    Deck, DeckBeam, DeckBlock, DeckContact, DeckLoad, DeckSpring, DeckStep, Direction, Material,
    Names, NotConvex, Rotation, StepKind, Turning,
};
use crate::element::hexahedron::range;
use crate::error::{ErrorKind, ModelError};
use crate::model::scene::Increments;
use std::borrow::Cow;
use std::collections::{BTreeSet, HashSet};

/// Young's modulus of a beam over the largest one of the bodies below it.
const STIFFER: f64 = 100.0;

/// Outline of a beam over the area of the faces below it, from which a pressure is cautioned: heads without mortar leave a
/// few percent.
const MOST_OUTLINE: f64 = 1.1;

/// Density of a beam for which the deck gives none [tonne/mm³]: that of air.
pub(super) const AIR: f64 = 1.2e-12;

/// A face is level if the heights of its nodes differ by less than this [mm].
pub(super) const LEVEL: f64 = 0.01;

/// Returns the deck with its beams replaced by blocks, contacts and springs, and with the steps that move them.
///
/// # Errors
/// Faces that are not level, or not at one height; unknown names.
pub(super) fn written_out(deck: &Deck) -> Result<Cow<'_, Deck>, ModelError> {
    if deck.beams.is_empty() {
        return Ok(Cow::Borrowed(deck));
    }
    let mut plain = deck.clone();
    plain.beams.clear();
    let blocks = Bodies::measured(&plain, &deck.beams, |bodies, i, beam| {
        outline(bodies, deck, i, beam)
    })?;
    for (i, (beam, laid)) in deck.beams.iter().zip(&blocks).enumerate() {
        for path in add(&mut plain, beam, laid) {
            plain.stands_for(path, format!("beams.{i}"));
        }
    }
    let (mut told, mut cautions) = (Vec::new(), Vec::new());
    for (i, step) in plain.steps.iter_mut().enumerate() {
        let of = |name: &String| deck.beams.iter().position(|beam| beam.name == *name);
        let Some(b) = step.beam.as_ref().and_then(of) else {
            continue; // no beam, or an unknown one, which was rejected when the deck was read
        };
        let said = &deck.steps[i];
        take_over(step, said, &deck.beams[b], &blocks[b]);
        let caution = said
            .pressure
            .and_then(|p| blocks[b].caution(&deck.beams[b], p.get()));
        cautions.extend(caution.map(|message| (format!("steps.{i}.pressure"), message)));
        for key in ["face", "spring"] {
            told.push((format!("steps.{i}.{key}"), format!("steps.{i}.beam")));
        }
    }
    for (path, from) in told {
        plain.stands_for(path, from);
    }
    plain.cautions.extend(cautions);
    Ok(Cow::Owned(plain))
}

/// Position and stiffness of a beam.
struct Laid {
    /// Lowest corner, with the least coordinates along the sides [mm].
    at: [f64; 3],
    /// Angle from x to its first side [degrees].
    angle: f64,
    /// Sizes [mm].
    size: [f64; 3],
    /// Young's modulus [MPa].
    modulus: f64,
    /// Area of the faces below it [mm²].
    below: f64,
}

impl Laid {
    /// Area in plan [mm²].
    fn area(&self) -> f64 {
        self.size[0] * self.size[1]
    }

    /// A caution about a pressure on a beam that spans voids, which acts on its whole outline.
    fn caution(&self, beam: &DeckBeam, pressure: f64) -> Option<String> {
        (self.area() > MOST_OUTLINE * self.below).then(|| {
            format!(
                "the pressure acts on the outline of the beam {}, {:.4e} mm^2 for {:.4e} mm^2 of faces below it: {:.3} kN in \
                 all, {:.4} MPa on these faces",
                beam.name,
                self.area(),
                self.below,
                1e-3 * pressure * self.area(),
                pressure * self.area() / self.below
            )
        })
    }

    /// Stiffness of the jack [N/mm]: that of the beam along its shortest side.
    fn jack(&self) -> f64 {
        self.modulus * self.size.into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// Young's modulus of a beam on the nodes `below` [MPa]: [`STIFFER`] times the largest one of the elements that have
/// such a node. Rigid-like materials are not multiplied: they are stiff enough.
fn modulus(bodies: &Bodies<'_>, below: &[u32]) -> f64 {
    let below: HashSet<u32> = below.iter().copied().collect();
    let elements = bodies.mesh.elements.iter().zip(&bodies.mesh.material);
    let touched = elements.filter(|(nodes, _)| nodes.iter().any(|n| below.contains(n)));
    let materials: BTreeSet<_> = touched.map(|(_, material)| *material).collect();
    let of = materials.iter().filter_map(|material| {
        let name = bodies.materials.get(usize::from(*material))?;
        let own = bodies.parameters(name).ok()?.elastic().E;
        let is_rigid = rigid::base(name) != name;
        Some(if is_rigid { own } else { STIFFER * own })
    });
    of.fold(0.0, f64::max)
}

/// Position and stiffness of a beam.
fn outline(
    bodies: &Bodies<'_>,
    deck: &Deck,
    i: usize,
    beam: &DeckBeam,
) -> Result<Laid, ModelError> {
    let path = format!("beams.{i}.on");
    let places = bodies.places(&path, &beam.on, true)?;
    let nodes = bodies.nodes(&places);
    let x = || nodes.iter().map(|n| bodies.mesh.nodes[*n as usize]);
    let z = range(x().map(|x| x[2]));
    let (vector, _) = bodies.area(&places);
    let level = z[1] - z[0] <= LEVEL && vector[2] > 0.0;
    if !level {
        return Err(deck
            .error(
                &path,
                format!(
                    "{} is no level face that looks upwards: its heights go from {:.2} to {:.2} mm",
                    beam.on.0.join(", "),
                    z[0],
                    z[1]
                ),
                "name tops of one height, such as on = \"wall.top\"",
            )
            .of_kind(ErrorKind::Geometry));
    }
    let facets = places.iter().flat_map(|place| bodies.facets(*place));
    let angle = plan::angle(facets.map(|(_, facet)| facet.map(|n| bodies.mesh.nodes[n as usize])));
    let frame = PlanFrame::of(angle);
    let [u, v] = [0, 1].map(|d| range(x().map(|x| frame.plan(x)[d])));
    Ok(Laid {
        at: frame.place([u[0], v[0]], z[1]),
        angle,
        size: [u[1] - u[0], v[1] - v[0], beam.depth.get()],
        modulus: modulus(bodies, &nodes),
        below: bodies.area(&places).1,
    })
}

/// Stiffness of the jack of a beam that turns, along the axes of its drives [N/mm]. `[xyz]`
fn stiffness_of_jack(plain: &Deck, beam: &DeckBeam, laid: &Laid) -> [f64; 3] {
    let mut jack = [0.0; 3];
    let own = |step: &&DeckStep| step.beam.as_ref() == Some(&beam.name);
    for step in plain.steps.iter().filter(own) {
        if let (Turning::Free, Some(direction)) = (beam.rotation, step.direction) {
            for (axis, part) in direction.unit().into_iter().enumerate() {
                if part != 0.0 {
                    jack[axis] = laid.jack();
                }
            }
        }
    }
    jack
}

/// Adds the material, block, contact and spring of a beam; returns their paths.
fn add(plain: &mut Deck, beam: &DeckBeam, laid: &Laid) -> Vec<String> {
    let name = &beam.name;
    let mut paths = vec![
        format!("materials.{name}"),
        format!("blocks.{}", plain.blocks.len()),
        format!("contacts.{}", plain.contacts.len()),
    ];
    let density = beam.density.map_or(0.0, Quantity::get).max(AIR);
    plain.materials.insert(
        name.clone(),
        Material::elastic(
            Pressure::new(laid.modulus),
            Number::new(0.0),
            Density::new(density),
        ),
    );
    plain.blocks.push(DeckBlock {
        name: name.clone(),
        size: Some(laid.size.map(Length::new)),
        at: laid.at.map(Length::new),
        rotate: (laid.angle != 0.0).then(|| Rotation {
            axis: Direction::Z,
            angle: Angle::new(laid.angle),
        }),
        corners: None,
        nodes: None,
        file: None,
        units: None,
        thickness: None,
        not_convex: NotConvex::Error,
        material: name.clone(),
        mesh: [1; 3],
        rigid: false,
        velocity: Default::default(),
        stack: None,
        interface: None,
        copies: None,
        pitch: None,
        lattice: None,
    });
    plain.contacts.push(DeckContact {
        slave: Some(beam.on.clone()),
        master: Some(Names(vec![format!("{name}.bottom")])),
        interface: beam.interface.clone(),
    });
    let jack = stiffness_of_jack(plain, beam, laid);
    if jack != [0.0; 3] {
        paths.push(format!("springs.{}", plain.springs.len()));
        plain.springs.push(DeckSpring {
            name: name.clone(),
            on: Names(vec![name.clone()]),
            stiffness: jack.map(SpringStiffness::new),
        });
    }
    paths
}

/// Translates a step on a beam into one on its face, its jack or a load.
fn take_over(step: &mut DeckStep, said: &DeckStep, beam: &DeckBeam, laid: &Laid) {
    step.beam = None;
    let name = &beam.name;
    match (beam.rotation, step.kind) {
        (Turning::Level, _) => step.face = Some(Names(vec![format!("{name}.top")])),
        (Turning::Free, StepKind::Drive) => step.spring = Some(name.clone()),
        (Turning::Free, _) => {
            // Increment sizes that the deck does not give remain those of a preload.
            let Increments {
                initial, max, min, ..
            } = said.increments();
            step.name.get_or_insert_with(|| said.kind.name().to_owned());
            step.kind = StepKind::Load;
            step.increments.initial = Some(Number::new(initial));
            step.increments.max = Some(Number::new(max));
            step.increments.min = Some(Number::new(min));
            let force = step.pressure.take().map_or(0.0, Quantity::get) * laid.area();
            step.loads.push(DeckLoad {
                name: name.clone(),
                on: Some(Names(vec![name.clone()])),
                near: None,
                from: None,
                to: None,
                within: None,
                pressure: None,
                follower: None,
                traction: None,
                force: Some([0.0, 0.0, -force].map(Force::new)),
                line_force: None,
            });
        }
    }
}
