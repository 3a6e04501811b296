//! Deck → [`Model`].

use super::build_blocks;
use super::deck::{Deck, DeckStep, Direction, StepKind, Vertical, Wall};
use super::findings;
use super::general;
use super::gravity::GravityNow;
use super::layout;
use super::probes;
use super::scatter;
use super::scene::{Beam, BeamMotion, Model, NamedMaterial, Step};
use super::supports::unheld_bodies;
use super::wall::{self, WallParts};
use crate::error::{Errors, ModelError, Warning};

impl Model {
    /// Builds the model that a deck describes, with what its author should know.
    ///
    /// # Errors
    /// A missing wall or step, softening that would snap back in the elements of this mesh, bodies
    /// that nothing holds: all that can be found, with the warnings.
    pub fn from_deck(deck: &Deck) -> Result<(Self, Vec<Warning>), ModelError> {
        if deck.has_blocks() {
            return build_blocks::build(deck);
        }
        let Some(wall) = &deck.wall else {
            return Err(deck.error(
                "wall",
                "the table [wall] is missing: there is nothing to load",
                "add [wall] with unit, joints, length, courses, materials and interface; or [[blocks]], \
                 or [arch]",
            ));
        };
        let mut errors = Errors::default();
        errors.keep(require_steps(deck));
        let names = [&wall.unit_material, &wall.mortar_material];
        let materials = [deck.material(names[0])?, deck.material(names[1])?];
        let Some(interface) = deck.interfaces.get(&wall.interface) else {
            return Err(deck.error("wall.interface", "there is no such interface", "name one"));
        };
        let pattern = layout::course_pattern(wall)
            .map_err(|refusal| deck.error(refusal.key, refusal.message, &refusal.help))?;
        require_countable(deck, wall, pattern[0].len().max(pattern[1].len()))?;
        let elastic = [materials[0].elastic(), materials[1].elastic()];
        let parts = wall::build(wall, &pattern, interface, elastic);
        errors.keep(require_held(deck, wall, &parts));

        let WallParts {
            mesh,
            mut contact,
            supports,
            beams,
            ..
        } = parts;
        contact.points = deck.contact.points;
        contact.search_radius = deck.contact.search_radius.map(super::quantity::Length::get);
        errors.keep(scatter::scatter(deck, &mut contact));
        let mut model = Self {
            title: deck.title.clone(),
            materials: names
                .into_iter()
                .zip(materials.clone())
                .map(|(name, parameters)| NamedMaterial {
                    name: name.clone(),
                    parameters,
                })
                .collect(),
            formulation: deck.element.formulation,
            contact,
            supports,
            steps: errors.keep(steps(deck, &beams[0])).unwrap_or_default(),
            beams,
            initial_velocity: Vec::new(),
            springs: Vec::new(),
            probes: errors
                .keep(probes::of_wall(deck, &mesh))
                .unwrap_or_default(),
            mesh,
            output: errors.keep(deck.output()).unwrap_or_default(),
        };
        model.contact.general = errors.keep(general::general(deck, &model)).flatten();
        findings::judged(deck, model, errors)
    }
}

pub(super) fn require_steps(deck: &Deck) -> Result<(), ModelError> {
    if !deck.steps.is_empty() {
        return Ok(());
    }
    let what = if deck.has_blocks() { "blocks" } else { "wall" };
    Err(deck.error(
        "steps",
        format!("there are no steps: nothing happens to the {what}"),
        "add [[steps]] with kind = \"drive\", direction and displacement",
    ))
}

/// More elements than this cannot be factorised on any machine at hand, nor numbered safely.
const MOST_ELEMENTS: f64 = 1e7;

/// Refuses a mesh that is too large before it is made.
fn require_countable(deck: &Deck, wall: &Wall, units: usize) -> Result<(), ModelError> {
    let m = wall.mesh;
    let per_unit = f64::from(m.length) * f64::from(m.height) * f64::from(m.thickness);
    let elements = units as f64 * f64::from(wall.courses) * per_unit;
    if elements <= MOST_ELEMENTS && u16::try_from(wall.courses).is_ok() {
        return Ok(());
    }
    let courses = wall.courses;
    let key = if per_unit > 1e5 {
        "wall.mesh"
    } else {
        "wall.courses"
    };
    Err(deck.error(
        key,
        format!("{courses} courses of {units} units of {per_unit} elements are too many"),
        "at most 1e7 elements and 65535 courses: coarsen wall.mesh or build a part of the wall",
    ))
}

/// Steps of the only beam. During a preload it moves vertically and no other way.
fn steps(deck: &Deck, beam: &Beam) -> Result<Vec<Step>, ModelError> {
    let mut gravity = GravityNow::none();
    let mut load = 0.0; // vertical force on the beam [N], upwards
    let mut steps = Vec::with_capacity(deck.steps.len());
    let mut errors = Errors::default();
    for (i, step) in deck.steps.iter().enumerate() {
        let mut motion = [BeamMotion::Locked; 3];
        match step.kind {
            StepKind::Preload => {
                load = -step
                    .top_pressure
                    .map_or(0.0, super::quantity::Pressure::get)
                    * beam.area;
                motion[2] = BeamMotion::Force(load);
            }
            StepKind::Drive => {
                let (axis, sign) = drive_axis(step);
                if step.vertical == Some(Vertical::Free) {
                    motion[2] = BeamMotion::Force(load);
                }
                let displacement = step.displacement.map_or(0.0, super::quantity::Length::get);
                motion[axis] = BeamMotion::Driven(sign * displacement);
            }
            // The beam stays under its load and moves vertically.
            StepKind::Gravity | StepKind::Tilt | StepKind::Free => {
                motion[2] = BeamMotion::Force(load);
            }
        }
        // A preload is told in the direction of the drive that follows, so that the history keeps
        // one meaning of displacement and force.
        let axis = deck.steps[i..]
            .iter()
            .find(|s| s.kind == StepKind::Drive)
            .map_or(2, |s| drive_axis(s).0);
        let rules = errors.keep(super::loading::rules(deck, i, step, &mut gravity));
        steps.extend(rules.map(|rules| Step {
            motion: vec![motion],
            driven: Some((0, axis)),
            ..rules
        }));
    }
    errors.end(steps)
}

fn drive_axis(step: &DeckStep) -> (usize, f64) {
    step.direction.map_or((0, 1.0), Direction::axis)
}

/// Refuses a wall some units of which nothing holds: joints that slide freely, or dry joints that
/// nothing presses before the wall is moved.
fn require_held(deck: &Deck, wall: &Wall, parts: &WallParts) -> Result<(), ModelError> {
    let interface = &deck.interfaces[&wall.interface];
    let path = format!("interfaces.{}", wall.interface);
    let (friction, dry) = (interface.mu.get(), interface.is_dry());
    let pressed = deck.steps.first().is_some_and(|s| {
        let pressure = s.top_pressure.is_some_and(|p| p.get() > 0.0);
        let (axis, sign) = drive_axis(s);
        let down = s.displacement.is_some_and(|d| sign * d.get() < 0.0) && axis == 2;
        pressure || down
    });
    let slides = dry && friction == 0.0;
    let holds = !slides && (!dry || pressed);
    let pairs = parts
        .contact
        .slave_body
        .iter()
        .copied()
        .zip(parts.facing_body.iter().copied());
    let unheld = unheld_bodies(&parts.held, pairs.filter(|_| holds));
    let Some(&body) = unheld.first() else {
        return Ok(());
    };
    let course = parts.mesh.unit.iter().position(|&u| u as usize == body);
    let course = course.map_or(0, |e| parts.mesh.course[e]);
    let who = format!(
        "unit {body} in course {course} is held by nothing ({} units are)",
        unheld.len()
    );
    Err(if slides {
        deck.error(
            &path,
            format!("{who}: the joint has neither bond nor friction"),
            "give mu above 0, or f_t and c",
        )
    } else {
        deck.error(
            "steps.0",
            format!("{who}: the joints are dry and no load presses them together"),
            "begin with a preload: kind = \"preload\", top_pressure = \"0.3 MPa\"",
        )
    })
}
