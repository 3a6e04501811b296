//! Builds the [`Model`] of a deck.

use super::amount;
use super::beams;
use super::bodies::Bodies;
use super::findings;
use super::floors;
use super::general;
use super::held::{Holding, require_held, require_held_each_way};
use super::layers;
use super::loading::{Loading, loading};
use super::loads;
use super::masonry;
use super::meeting::{Meeting, meeting};
use super::overlap;
use super::probes;
use super::quantity::Quantity;
use super::rigid;
use super::scatter;
use super::schema::{Deck, DeckProcedure, DeckStep, StepKind, Strategy};
use super::sections;
use super::symmetry;
use super::ties;
use crate::error::{ErrorKind, Errors, ModelError, Warning};
use crate::material::MaterialParameters;
use crate::model::probes::Probe;
use crate::model::scene::{Model, NamedMaterial, Spring, Support};
use crate::model::sections::Section;

impl Model {
    /// Builds the model that a deck describes; returns it with all warnings.
    ///
    /// # Errors
    /// A deck without a scene or steps, unknown names, contradictions, softening that would snap back within an
    /// element of this mesh, unsupported bodies. All errors that can be found are returned, with the warnings.
    pub fn from_deck(deck: &Deck) -> Result<(Self, Vec<Warning>), ModelError> {
        if !deck.has_scene() {
            return Err(nothing_to_load(deck));
        }
        let deck = &*beams::written_out(deck)?;
        let deck = &*layers::written_out(deck)?;
        let mut errors = Errors::default();
        errors.keep(require_steps(deck));
        let mut bodies = Bodies::new(deck)?;
        errors.keep(require_mass(deck, &bodies));
        let mut parts = match Parts::of(deck, &bodies, &mut errors) {
            Ok(parts) => parts,
            Err(error) => return Err(errors.and(error)),
        };
        let floats = errors.keep(parts.floating(deck, &bodies)).flatten();
        let overlaps = errors.keep(overlap::overlaps(deck, &bodies));
        let mut named = errors.keep(loads::loads(deck, &bodies)).unwrap_or_default();
        let actions = symmetry::Actions {
            springs: &parts.springs,
            loads: named.all(),
            steps: &parts.loading.steps,
        };
        let planes = &parts.supports[parts.of_deck..];
        errors.keep(symmetry::judge_held(deck, &bodies, planes, &actions));
        bodies.mesh.names = bodies.names();
        bodies.mesh.walls = bodies.walls_of_units();
        let ties = errors.keep(ties::ties(deck, &bodies, &mut parts.loading.steps));
        let mut ties = ties.unwrap_or_default();
        let laid_floors = errors.keep(floors::floors(deck, &bodies, &mut parts.loading.steps));
        let (floors, springs_of_floors) = laid_floors.unwrap_or_default();
        ties.extend(springs_of_floors);
        let mut bond = findings::bond(deck, &bodies.walls);
        bond.append(&mut named.warnings);
        let mut model = Self {
            title: deck.title.clone(),
            mesh: bodies.mesh,
            materials: named_materials(bodies.materials, parts.parameters),
            formulation: deck.element.formulation,
            contact: parts.meeting.contact,
            loads: named.assign(&mut parts.loading.steps),
            beams: parts.loading.beams,
            supports: parts.supports,
            initial_velocity: bodies.velocity,
            springs: parts.springs,
            ties,
            floors,
            limit_only: deck.strategy == Strategy::Limit,
            layers: layers::names(deck),
            probes: parts.probes,
            sections: parts.sections,
            steps: parts.loading.steps,
            output: errors.keep(deck.output()).unwrap_or_default(),
            warnings: Vec::new(),
            assumed: deck.assumed().iter().map(ToString::to_string).collect(),
            fidelity: deck.fidelity,
        };
        model.contact.general = errors.keep(general::general(deck, &model)).flatten();
        let laid = bodies.warnings.into_iter().chain(bond);
        let laid = laid.chain(parts.meeting.warnings);
        let laid = laid.chain(overlaps.unwrap_or_default()).chain(floats);
        findings::judged(deck, model, laid.collect(), errors)
    }
}

/// Parts of a model that follow from its bodies.
struct Parts {
    /// Supports of the deck, then those of planes of symmetry, which hold no body against motion in the plane.
    supports: Vec<Support>,
    /// Number of supports of the deck.
    of_deck: usize,
    springs: Vec<Spring>,
    probes: Vec<Probe>,
    sections: Vec<Section>,
    loading: Loading,
    /// Parameters of the materials.
    parameters: Vec<MaterialParameters>,
    meeting: Meeting,
    /// Whether supports, springs and loading of the deck have no errors.
    are_known: bool,
}

impl Parts {
    /// Collects the parts. Parts with errors are empty.
    ///
    /// # Errors
    /// Unknown contact surfaces: the sizes of the elements are unknown then, so that softening cannot be checked.
    fn of(deck: &Deck, bodies: &Bodies<'_>, errors: &mut Errors) -> Result<Self, ModelError> {
        let supports = errors.keep(bodies.supports());
        let springs = errors.keep(bodies.springs());
        let is_held = supports.is_some() && springs.is_some();
        let (mut supports, springs) = (supports.unwrap_or_default(), springs.unwrap_or_default());
        let of_deck = supports.len();
        let of_planes = errors.keep(symmetry::supports(deck, bodies));
        supports.extend(of_planes.unwrap_or_default());
        let probes = errors.keep(probes::probes(deck, bodies));
        let sections = errors.keep(sections::sections(deck, bodies));
        let top = masonry::level_beam(bodies);
        let loading = errors.keep(loading(deck, bodies, top, &supports, &springs));
        let (parameters, mut meeting) = surfaces(deck, bodies)?;
        let are_known = is_held && loading.is_some();
        let mut loading = loading.unwrap_or_default();
        let Loading { beams, steps } = &mut loading;
        errors.keep(symmetry::judge(deck, bodies, beams, steps));
        let contact = &mut meeting.contact;
        contact.points = deck.contact.points;
        contact.search_radius = deck.contact.search_radius.map(Quantity::get);
        errors.keep(scatter::scatter(deck, contact));
        let division = contact.division(deck.contact.parts, &bodies.mesh.nodes);
        require_few_points(deck, division.points())?;
        contact.divide(&division);
        Ok(Self {
            supports,
            of_deck,
            springs,
            probes: probes.unwrap_or_default(),
            sections: sections.unwrap_or_default(),
            loading,
            parameters,
            meeting,
            are_known,
        })
    }

    /// Rejects bodies that neither supports, springs and faces that move as one nor other bodies hold.
    fn floating(&self, deck: &Deck, bodies: &Bodies<'_>) -> Result<Option<Warning>, ModelError> {
        if !self.are_known {
            return Ok(None);
        }
        let Loading { beams, steps } = &self.loading;
        let of_supports = self.supports[..self.of_deck].iter().map(|s| &s.nodes);
        let of_springs = self.springs.iter().map(|s| &s.nodes);
        let of_beams = beams.iter().map(|b| &b.nodes);
        let held = of_supports.chain(of_springs).chain(of_beams);
        let held: Vec<u32> = held.flatten().copied().collect();
        let touching = &self.meeting.touching;
        let floats = require_held(deck, bodies, &held, touching)?;
        let holding = Holding {
            supports: &self.supports,
            springs: &self.springs,
            beams,
            steps,
        };
        require_held_each_way(deck, bodies, touching, holding)?;
        Ok(floats)
    }
}

fn nothing_to_load(deck: &Deck) -> ModelError {
    deck.error(
        "wall",
        "the table [wall] is missing: there is nothing to load",
        "add [wall] with unit, joints, length, courses, materials and interface; or [[blocks]], [[imports]] or [arch]",
    ).of_kind(ErrorKind::Missing)
}

/// Rejects more points of contact than [`amount::MOST_POINTS`].
fn require_few_points(deck: &Deck, points: f64) -> Result<(), ModelError> {
    if points <= amount::MOST_POINTS {
        return Ok(());
    }
    Err(deck
        .error(
            "contact.parts",
            format!("{points} points of contact are too many"),
            "at most 1e7: cut facets into fewer parts",
        )
        .of_kind(ErrorKind::TooMany))
}

fn named_materials(names: Vec<String>, parameters: Vec<MaterialParameters>) -> Vec<NamedMaterial> {
    let named = names.into_iter().zip(parameters);
    named
        .map(|(name, parameters)| NamedMaterial {
            rigid: rigid::base(&name) != name,
            name,
            parameters,
        })
        .collect()
}

/// Parameters of the materials, and the contact surfaces.
fn surfaces(
    deck: &Deck,
    bodies: &Bodies<'_>,
) -> Result<(Vec<MaterialParameters>, Meeting), ModelError> {
    let materials = bodies.materials.iter();
    let parameters = materials
        .map(|name| bodies.parameters(name))
        .collect::<Result<Vec<_>, _>>()?;
    let elastic: Vec<_> = parameters.iter().map(|p| *p.elastic()).collect();
    Ok((parameters, meeting(deck, bodies, &elastic)?))
}

fn require_steps(deck: &Deck) -> Result<(), ModelError> {
    if !deck.steps.is_empty() {
        return Ok(());
    }
    let what = if deck.has_walls() { "wall" } else { "blocks" };
    Err(deck
        .error(
            "steps",
            format!("there are no steps: nothing happens to the {what}"),
            "add [[steps]] with kind = \"drive\", direction and displacement",
        )
        .of_kind(ErrorKind::Missing))
}

/// Rejects gravity and inertia for materials without density.
fn require_mass(deck: &Deck, bodies: &Bodies<'_>) -> Result<(), ModelError> {
    let needs = |s: &DeckStep| {
        let inertia = [DeckProcedure::QuasiStatic, DeckProcedure::Dynamic];
        matches!(s.kind, StepKind::Gravity | StepKind::Tilt | StepKind::Free)
            || (!deck.imports.is_empty() && inertia.contains(&s.procedure))
    };
    let Some(step) = deck.steps.iter().position(needs) else {
        return Ok(());
    };
    let massless = |name: &&String| {
        bodies
            .parameters(name)
            .is_ok_and(|m| m.elastic().density == 0.0)
    };
    let Some(name) = bodies.materials.iter().find(massless) else {
        return Ok(());
    };
    let kind = deck.steps[step].kind.name();
    Err(deck
        .error(
            &format!("materials.{}.density", rigid::base(name)),
            format!("steps.{step} is of the kind {kind}, and {name} has no mass"),
            &crate::deck::keys::example("density"),
        )
        .of_kind(ErrorKind::Missing))
}
