//! Checks of the physics of a model before it is run.

use super::coarse_mesh::coarse_mesh;
use super::contradictions::partly_held;
use super::far_points::far_points;
use super::flat_elements::flat_elements;
use super::head_joints::{gaps, wide_joints};
use super::held_loads::held_loads;
use super::loading::beam_of;
use super::loose_scene::loose_scene;
use super::magnitudes::magnitudes;
use super::masonry::{Masonry, least_lap};
use super::schema::{Bond, Deck, DeckStep, FilledFrom, Interface, Strategy, Subdivision};
use super::{rounding, tables};
use crate::element::extent;
use crate::error::{Errors, ModelError, Warning};
use crate::material::{Extent, MaterialParameters};
use crate::model::Model;
use crate::model::scene::Step;
use std::collections::{HashMap, HashSet};
use wythe_contact::JointLaw;

/// Equivalent lengths l_eq = V^(1/3) of elements [mm] (α_h = 1 for hex8), ascending, each once.
pub(super) fn equivalent_lengths(model: &Model, elements: &[usize]) -> Vec<f64> {
    let mesh = &model.mesh;
    let mut lengths: Vec<f64> = elements.iter().map(|e| mesh.volume(*e).cbrt()).collect();
    lengths.sort_by(f64::total_cmp);
    lengths.dedup_by(|b, a| *b <= *a * (1.0 + SAME_LENGTH));
    lengths
}

/// Elements by the name of their material; several material indices may have one name.
pub(super) fn elements_by_name(model: &Model) -> HashMap<&str, Vec<usize>> {
    let mut of_index: Vec<Vec<usize>> = vec![Vec::new(); model.materials.len()];
    for (e, material) in model.mesh.material.iter().enumerate() {
        of_index[usize::from(*material)].push(e);
    }
    let mut by_name: HashMap<&str, Vec<usize>> = HashMap::new();
    for (material, elements) in model.materials.iter().zip(of_index) {
        by_name
            .entry(material.name.as_str())
            .or_default()
            .extend(elements);
    }
    by_name
}

/// Least and largest width of elements in any direction [mm].
pub(super) fn band_widths(model: &Model, elements: &[usize]) -> [f64; 2] {
    let mesh = &model.mesh;
    let extents: Vec<Extent> = elements
        .iter()
        .filter_map(|&e| extent(&mesh.corners(e), mesh.volume(e)))
        .collect();
    Extent::range(extents.iter())
}

/// Lengths that differ by less than this fraction are equal: coordinates of the mesh are sums of sizes.
const SAME_LENGTH: f64 = 1e-9;

/// Returns the model with its warnings if there are no errors, neither earlier ones nor in its physics. `laid`:
/// warnings about bonds and surfaces.
///
/// # Errors
/// The earlier errors, and softening that would snap back within an element; with the warnings.
pub(super) fn judged(
    deck: &Deck,
    mut model: Model,
    laid: Vec<Warning>,
    mut errors: Errors,
) -> Result<(Model, Vec<Warning>), ModelError> {
    let (mut warnings, wrong) = findings(deck, &model);
    warnings.extend(laid);
    let warnings = Warning::counted(warnings);
    for error in wrong {
        errors.push(error);
    }
    model.warnings.clone_from(&warnings);
    match errors.end(model) {
        Ok(model) => Ok((model, warnings)),
        Err(error) => Err(error.with_warnings(warnings)),
    }
}

/// All warnings about a model, and all errors in its physics: softening that would snap back within an element.
pub(super) fn findings(deck: &Deck, model: &Model) -> (Vec<Warning>, Vec<ModelError>) {
    let mut warnings = Vec::new();
    let mut errors = Vec::new();
    let by_name = elements_by_name(model);
    let mut seen: HashSet<&str> = HashSet::new();
    for material in &model.materials {
        let name = material.name.as_str();
        if !seen.insert(name) {
            continue; // units and mortar of one material
        }
        let elements = &by_name[name];
        if let MaterialParameters::DruckerPrager(_) | MaterialParameters::Custom(_) =
            &material.parameters
        {
            let lengths = equivalent_lengths(model, elements);
            let judged = tables::judge_law(deck, name, &material.parameters, &lengths);
            errors.extend(judged.err());
        }
        if let MaterialParameters::DamagePlasticity(p) = &material.parameters {
            let lengths = equivalent_lengths(model, elements);
            if p.reference_length.is_none() {
                warnings.push(unscaled(deck, name));
            }
            let judged = if p.has_bands() {
                let widths = band_widths(model, elements);
                tables::judge_bands(deck, name, p, widths)
            } else {
                tables::judge(deck, name, p, &lengths)
            };
            match judged {
                Ok(found) => warnings.extend(found),
                Err(error) => errors.push(error),
            }
        }
    }
    for (name, interface) in interfaces(deck, model) {
        warnings.extend(check_interface(deck, name, interface, model));
    }
    errors.extend(rounding::judge(deck, model));
    warnings.extend(peaks_not_seen(deck));
    warnings.extend(magnitudes(deck));
    warnings.extend(rigid_strategy(deck));
    warnings.extend(records_outside(deck, model));
    warnings.extend(far_points(deck, model));
    warnings.extend(velocities_unused(deck, model));
    warnings.extend(held_loads(deck, model));
    warnings.extend(loose_scene(deck, model));
    warnings.extend(flat_elements(deck, model));
    let top = deck.clamped().is_some();
    let of_step = |i: usize| beam_of(deck.steps.get(i)?, &model.beams, top);
    warnings.extend(partly_held(deck, model, of_step));
    let cautions = deck.cautions.iter();
    warnings.extend(cautions.map(|(path, message)| deck.warning(path, message.clone())));
    (warnings, errors)
}

/// A warning that rigid units leave out what may carry a wall.
fn rigid_strategy(deck: &Deck) -> Option<Warning> {
    (deck.strategy == Strategy::Rigid && deck.has_walls()).then(|| {
        deck.warning(
            "strategy",
            "rigid units neither crack nor crush nor bend, which changes forces by tens of percent, and of pressed walls with \
             openings by more than twice: a first estimate, to be compared with strategy = \"simplified\"",
        )
    })
}

/// A warning about velocities of bodies that no step uses.
fn velocities_unused(deck: &Deck, model: &Model) -> Option<Warning> {
    let uses = |step: &Step| step.procedure.has_inertia();
    let moves = model.initial_velocity.iter().any(|v| *v != [0.0; 3]);
    let block = deck
        .blocks
        .iter()
        .position(|block| block.velocity.iter().any(|v| v.get() != 0.0));
    (moves && !model.steps.iter().any(uses)).then(|| {
        let path = block.map_or("imports".to_owned(), |i| format!("blocks.{i}.velocity"));
        let message = "not used: bodies start with it in the first step with the procedure dynamic or quasi_static, and there is none";
        deck.warning(&path, message)
    })
}

/// Duration of a step that the deck does not say [s].
const DEFAULT_DURATION: f64 = 1.0;

/// Warnings about records of the ground that end before their step begins, or begin after it ends.
fn records_outside(deck: &Deck, model: &Model) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for (i, step) in model.steps.iter().enumerate() {
        for (axis, rows) in ["x", "y", "z"].iter().zip(&step.ground.acceleration) {
            let (Some([first, _]), Some([last, _])) = (rows.first(), rows.last()) else {
                continue;
            };
            if *last <= 0.0 || *first >= step.duration {
                let message = format!(
                    "the record acts from {first} s to {last} s after the step begins, and the step lasts {} s: \
                     the ground is at rest throughout (ground_start is the time of the record at which the step \
                     begins)",
                    step.duration
                );
                warnings.push(deck.warning(&format!("steps.{i}.ground.{axis}"), message));
            } else if *last > step.duration && step.duration == DEFAULT_DURATION {
                let message = format!(
                    "the record goes on to {last} s, and the step ends after 1 s, the default of `duration`"
                );
                warnings.push(deck.warning(&format!("steps.{i}.ground.{axis}"), message));
            }
        }
    }
    warnings
}

/// Warnings about steps with `increments.peak` but without peak control.
fn peaks_not_seen(deck: &Deck) -> Vec<Warning> {
    let says = |step: &DeckStep| step.increments.peak.is_some() && !step.sees_peaks();
    let steps = deck.steps.iter().enumerate();
    let silent = steps.filter(|(_, step)| says(step));
    let told = |(i, _)| {
        let message = "not used: peak control needs a driven or controlling displacement, and a procedure without inertia or path following";
        deck.warning(&format!("steps.{i}.increments.peak"), message)
    };
    silent.map(told).collect()
}

/// Interfaces that the model uses, each once.
pub(super) fn interfaces<'a>(deck: &'a Deck, model: &'a Model) -> Vec<(&'a str, &'a Interface)> {
    let of_wall = deck.walls().map(|(_, _, wall)| wall.interface.as_str());
    let mut names: Vec<&str> = of_wall
        .chain(model.contact.law_names.iter().map(String::as_str))
        .collect();
    names.sort_unstable();
    names.dedup();
    let with_law = |name| Some((name, deck.interfaces.get(name)?));
    names.into_iter().filter_map(with_law).collect()
}

/// Warning about a material whose tables are not scaled to the elements.
fn unscaled(deck: &Deck, name: &str) -> Warning {
    deck.warning(
        &format!("materials.{name}"),
        "reference_length is missing: the tables are taken as given in every element, and the \
         energy to break a unit depends on the mesh (scaling is off)",
    )
}

fn check_interface(deck: &Deck, name: &str, f: &Interface, model: &Model) -> Vec<Warning> {
    let path = format!("interfaces.{name}");
    let mut warnings = Vec::new();
    let warn = |key: &str, message: String| deck.warning(&format!("{path}.{key}"), message);
    let (mu, tan_phi) = (f.residual_friction(), f.initial_friction());
    let (c, f_t) = (f.cohesion(), f.tensile_strength());
    if mu > tan_phi && !f.is_dry() {
        let pressure = c / (mu - tan_phi);
        warnings.push(warn(
            "mu",
            format!(
                "the residual friction is above tan_phi = {tan_phi}: under more than {pressure:.3} MPa \
                 the joint hardens as it breaks"
            ),
        ));
    }
    if f_t > 0.0 && tan_phi > 0.0 && f_t >= c / tan_phi {
        let limit = c / tan_phi;
        warnings.push(warn(
            "f_t",
            format!(
                "the Coulomb line ends at c/tan_phi = {limit:.4} MPa, below f_t: a joint pulled \
                 beyond it slides without resistance before it opens"
            ),
        ));
    }
    for (i, key) in ["normal_stiffness", "shear_stiffness"]
        .into_iter()
        .enumerate()
    {
        if let Some([stiffness, least]) = nearest_to_snap_back(model, name, i)
            && stiffness <= least
        {
            warnings.push(warn(
                key,
                format!(
                    "{stiffness:.3} N/mm^3 is not above {least:.3}: the softening snaps back within the \
                     interface (raise the stiffness or penalty_factor)"
                ),
            ));
        }
    }
    let u_k = f.law(1.0, 1.0).ultimate_opening();
    if let Some(radius) = model.contact.search_radius.filter(|radius| *radius < u_k) {
        warnings.push(deck.warning(
            "contact.search_radius",
            format!(
                "{radius} mm is below the ultimate opening of {name}, {u_k:.4} mm: a joint that opens \
                 wider than the radius loses what is left of its bond"
            ),
        ));
    }
    if f.normal_stiffness.is_some() && f.penalty_factor.is_some() {
        warnings.push(warn(
            "penalty_factor",
            "not used: explicit stiffnesses are given".to_owned(),
        ));
    }
    warnings
}

/// Stiffness and steepest softening slope [N/mm³] of the law of an interface that is closest to snap-back, in
/// opening (`mode` 0) or slip (1).
///
/// The slope must stay below the stiffness (theory/joint.md, eq. 23). None if no law softens.
fn nearest_to_snap_back(model: &Model, name: &str, mode: usize) -> Option<[f64; 2]> {
    let contact = &model.contact;
    let laws = contact.laws.iter().zip(&contact.law_names);
    let pairs = laws
        .filter(|(_, n)| *n == name)
        .map(|(law, _)| [law.stiffness()[mode], law.softening_slopes()[mode]]);
    pairs
        .filter(|[_, slope]| *slope > 0.0)
        .min_by(|[k, slope], [l, other]| (k / slope).total_cmp(&(l / other)))
}

/// Warnings about slivers and about head joints that run through.
pub(super) fn bond(deck: &Deck, walls: &[Masonry<'_>]) -> Vec<Warning> {
    walls.iter().flat_map(|wall| bond_of(deck, wall)).collect()
}

fn bond_of(deck: &Deck, masonry: &Masonry<'_>) -> Vec<Warning> {
    let wall = masonry.wall;
    let (shortest, lap) = masonry.bat_and_lap();
    let [unit, joint] = [wall.unit[0].get(), wall.head_joint.get()];
    let least = least_lap(wall);
    let key = format!("{}.length", masonry.path);
    let mut warnings = Vec::new();
    if shortest < least {
        let half = (unit - joint) / 2.0;
        warnings.push(deck.warning(
            &key,
            format!("the bats are slivers of {shortest:.2} mm (a half unit is {half:.2} mm)"),
        ));
    }
    if wall.courses > 1 && lap < least && wall.bond != Bond::Stack {
        warnings.push(deck.warning(
            &key,
            format!(
                "head joints of neighbouring courses are only {lap:.2} mm apart: hardly a bond"
            ),
        ));
    } else if wall.courses > 1 && !masonry.interlock.overlaps(wall) && wall.bond != Bond::Stack {
        let lap = masonry.interlock.lap;
        warnings.push(deck.warning(
            &key,
            format!(
                "where it passes through a wall that meets it, its head joints are only {lap:.2} mm from those to that \
                 wall in the courses beside: a straight joint, hardly a bond"
            ),
        ));
    }
    warnings.extend(unread(deck, masonry));
    warnings.extend(wide_joints(deck, masonry));
    warnings.extend(coarse_mesh(deck, masonry));
    warnings.extend(gaps(deck, masonry));
    warnings
}

/// Warnings about keys of a wall that have no effect because of other keys.
fn unread(deck: &Deck, masonry: &Masonry<'_>) -> Vec<Warning> {
    let (wall, path) = (masonry.wall, &masonry.path);
    let mut warnings = Vec::new();
    if wall.rigid && wall.mesh != Subdivision::default() {
        let message = "not used: rigid units have the elements that their neighbours leave them";
        warnings.push(deck.warning(&format!("{path}.mesh"), message));
    }
    let filling = wall.head_filling.get();
    if wall.filled_from != FilledFrom::Both && (filling == 0.0 || filling == 1.0) {
        let how = if filling == 0.0 { "empty" } else { "full" };
        let message = format!("not used: head_filling = {filling} leaves the head joints {how}");
        warnings.push(deck.warning(&format!("{path}.filled_from"), message));
    }
    warnings
}
