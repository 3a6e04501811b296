//! What walls with mortar want if the deck says nothing of it.
//!
//! Stiff joints hold units whose meshes do not match in each other's shape. Before anything cracks a wall that is
//! bent out of its plane is 28 % too stiff with 500 E/h and up to 4 % with 50, and takes six tenths of the time; J7D,
//! which is sheared, 10 and 3 % (docs/accuracy-speed.md, scenes 4 and 3).
//!
//! A section that bends opens on one side and is pressed together on the other: of two elements one has the joint's
//! whole pressure, and the peak comes 3.4 % lower than with three (scene 4).

use super::quantity::Number;
use super::schema::{Deck, DeckLoad, DeckStep, Direction, Subdivision, Wall};

/// Elements through the thickness from which on the peak is within a per cent.
const ENOUGH: u32 = 3;

/// Penalty factor of joints with mortar [-]; elsewhere it is that of theory C.8.
const PENALTY: f64 = 50.0;

/// Walls with mortar, by path.
fn mortared(deck: &Deck) -> impl Iterator<Item = (String, &str, &Wall)> {
    deck.walls()
        .filter(|(.., wall)| wall.mortar_material.is_some())
}

/// Those that something bends out of their plane, and whose units give.
fn bent(deck: &Deck) -> impl Iterator<Item = (String, &str, &Wall)> {
    mortared(deck).filter(|(_, name, wall)| {
        !wall.rigid && deck.steps.iter().any(|step| bends(step, name, wall))
    })
}

/// Those that have too few elements through their thickness.
fn thin(deck: &Deck) -> impl Iterator<Item = (String, &str, &Wall)> {
    bent(deck).filter(|(.., wall)| wall.mesh.thickness * wall.leaves < ENOUGH)
}

/// Chooses what the deck does not say of walls with mortar.
pub(super) fn choose(deck: &mut Deck) {
    choose_meshes(deck);
    choose_penalties(deck);
}

/// Enough elements through the thickness.
fn choose_meshes(deck: &mut Deck) {
    let silent = |path: &String| !deck.says(&format!("{path}.mesh"));
    let paths: Vec<String> = thin(deck).map(|(path, ..)| path).filter(silent).collect();
    for path in paths {
        let place = path.strip_prefix("walls.").and_then(|i| i.parse().ok());
        let wall = match place {
            Some(i) => deck.walls.get_mut::<usize>(i),
            None => deck.wall.as_mut(),
        };
        if let Some(wall) = wall {
            wall.mesh.thickness = ENOUGH.div_ceil(wall.leaves);
        }
    }
}

/// The stiffness of their joints; units that count as rigid want one said. Where anything may meet anywhere it is what stops
/// bodies that fly, and stays.
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

/// One note for each wall that is bent and says to be cut into too few.
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

/// Whether a step pushes or tilts a wall across.
fn bends(step: &DeckStep, name: &str, wall: &Wall) -> bool {
    let (along, through) = wall.axes();
    let axis = |direction: Option<Direction>| direction.map(|d| d.axis().0);
    axis(step.direction) == Some(through)
        || axis(step.axis) == Some(along)
        || step.loads.iter().any(|load| is_across(load, name, through))
}

/// Whether a load lies on the wall and pushes across.
fn is_across(load: &DeckLoad, name: &str, through: usize) -> bool {
    let mut on = load.on.iter().flat_map(|names| &names.0);
    on.any(|on| {
        let (body, face) = on.split_once('.').unwrap_or((on, ""));
        let pushes = match load.value() {
            Some(("pressure", _)) => matches!(face, "front" | "back"),
            Some((_, components)) => components[through] != 0.0,
            None => false,
        };
        body == name && pushes
    })
}
