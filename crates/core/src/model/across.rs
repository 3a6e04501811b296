//! Walls that are bent out of their plane by fewer elements than their thickness wants.
//!
//! A section that bends opens on one side and is pressed together on the other: of two elements one has the joint's
//! whole pressure, and the peak comes 4 to 5 % too low (docs/accuracy-speed.md, scene 4); three are 1 % short.

use super::deck::{Deck, DeckLoad, DeckStep, Direction, Subdivision, Wall};

/// Elements through the thickness from which on the peak is within a per cent.
const ENOUGH: u32 = 3;

/// Walls with mortar that something bends and that have too few elements through their thickness, by path.
fn thin(deck: &Deck) -> impl Iterator<Item = (String, &str, &Wall)> {
    deck.walls().filter(|(_, name, wall)| {
        let few = wall.mesh.thickness * wall.leaves < ENOUGH;
        let soft = wall.mortar_material.is_some() && !wall.rigid;
        few && soft && deck.steps.iter().any(|step| bends(step, name, wall))
    })
}

/// Walls that are bent and say nothing of their mesh are cut into enough.
pub(super) fn choose_meshes(deck: &mut Deck) {
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

/// One note for each wall that is bent and says to be cut into too few.
pub(super) fn notes(deck: &Deck) -> Vec<String> {
    thin(deck)
        .map(|(path, name, wall)| {
            let Subdivision { length, height, .. } = wall.mesh;
            format!(
                "mesh: {name} is bent out of its plane with fewer than three elements through its thickness: of two its \
                 peak is some 5 % too low, of three 1 % ({path}.mesh = [{length}, {height}, {ENOUGH}])"
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
