//! Defaults of walls with mortar.
//!
//! Stiff joints force units whose meshes do not match into each other's shape. Before the first crack a wall that
//! is bent out of its plane is 28 % too stiff with 500 E/h, and at most 4 % with 50, which takes six tenths of the
//! time. The errors of J7D, which is sheared, are 10 and 3 % (docs/accuracy-speed.md, scenes 4 and 3).
//!
//! A section in bending opens on one side and is compressed on the other. Of two elements one carries the whole
//! pressure of the joint, and the peak is 3.4 % lower than with three (scene 4).

use super::quantity::Number;
use super::schema::{Deck, DeckLoad, DeckStep, Direction, Subdivision, Wall};

/// Smallest number of elements through the thickness with which the peak is accurate within 1 %.
const ENOUGH: u32 = 3;

/// Penalty factor of joints with mortar [-]; others have that of the paper (theory/joint.md, eq. 32).
pub(super) const PENALTY: f64 = 50.0;

/// Walls with mortar, by path.
fn mortared(deck: &Deck) -> impl Iterator<Item = (String, &str, &Wall)> {
    deck.walls()
        .filter(|(.., wall)| wall.mortar_material.is_some())
}

/// Walls with mortar and deformable units that are bent out of their plane.
fn bent(deck: &Deck) -> impl Iterator<Item = (String, &str, &Wall)> {
    mortared(deck).filter(|(_, name, wall)| {
        !wall.rigid && deck.steps.iter().any(|step| bends(step, name, wall))
    })
}

/// Such walls with too few elements through their thickness.
fn thin(deck: &Deck) -> impl Iterator<Item = (String, &str, &Wall)> {
    bent(deck).filter(|(.., wall)| wall.mesh.thickness * wall.leaves < ENOUGH)
}

/// Sets the values that the deck does not give for walls with mortar.
pub(super) fn choose(deck: &mut Deck) {
    choose_meshes(deck);
    choose_penalties(deck);
}

/// Sets enough elements through the thickness.
fn choose_meshes(deck: &mut Deck) {
    let silent = |path: &String| !deck.says(&format!("{path}.mesh"));
    let paths: Vec<String> = thin(deck).map(|(path, ..)| path).filter(silent).collect();
    for path in paths {
        if let Some(wall) = deck.wall_mut(&path) {
            wall.mesh.thickness = ENOUGH.div_ceil(wall.leaves);
        }
    }
}

/// Sets the penalty factor of mortar joints.
///
/// It has no effect on explicit stiffnesses, which rigid units need. With general contact the stiffness also
/// stops moving bodies, and is not changed.
fn choose_penalties(deck: &mut Deck) {
    if deck.contact.general.is_some() {
        return;
    }
    let names: Vec<String> = mortared(deck)
        .flat_map(|(.., wall)| {
            let others = [&wall.head_interface, &wall.collar_interface];
            std::iter::once(&wall.interface).chain(others.into_iter().flatten())
        })
        .cloned()
        .collect();
    for name in names {
        if let Some(interface) = deck.interfaces.get_mut(&name)
            && interface.normal_stiffness.is_none()
        {
            interface.penalty_factor.get_or_insert(Number::new(PENALTY));
        }
    }
}

/// One note for each wall that is bent and has a `mesh` with too few elements in the deck.
pub(super) fn notes(deck: &Deck) -> Vec<String> {
    thin(deck)
        .map(|(path, name, wall)| {
            let Subdivision { length, height, .. } = wall.mesh;
            format!(
                "mesh: {name} is bent out of its plane with fewer than three elements through its thickness: of two its \
                 peak is some 3 % lower ({path}.mesh = [{length}, {height}, {ENOUGH}])"
            )
        })
        .collect()
}

/// Returns whether a step pushes or tilts a wall out of its plane.
pub(super) fn bends(step: &DeckStep, name: &str, wall: &Wall) -> bool {
    let (along, through) = wall.axes();
    let axis = |direction: Option<Direction>| direction.map(|d| d.axis().0);
    step.direction
        .is_some_and(|direction| direction.unit()[through] != 0.0)
        || axis(step.axis) == Some(along)
        || step.loads.iter().any(|load| is_across(load, name, through))
}

/// Returns whether a load lies on the wall, or on a part of it, and pushes out of its plane.
fn is_across(load: &DeckLoad, name: &str, through: usize) -> bool {
    let mut on = load.on.iter().flat_map(|names| &names.0);
    on.any(|on| {
        let body = on.split('.').next().unwrap_or(on);
        let face = on.rsplit_once('.').map_or("", |(_, face)| face);
        let pushes = match load.value() {
            Some(("pressure", _)) => match through {
                0 => matches!(face, "left" | "right"),
                _ => matches!(face, "front" | "back"),
            },
            Some((_, components)) => components[through] != 0.0,
            None => false,
        };
        body == name && pushes
    })
}
