//! Decks of the companions: the deck of the run with smaller increments, and with a finer mesh.

use super::Part;
use crate::deck::Deck;
use crate::deck::schema::Wall;
use crate::model::Model;

/// Changes of a deck, as of `--set`: keys and values.
pub(super) type Set = Vec<(String, String)>;

/// Number of increments of a companion over that of the run, and tolerance of the run over that of the companion.
const FINER_IN_TIME: f64 = 2.0;

/// Numbers of elements of a companion over those of the run along each side, in the order in which they are tried: a
/// deck may refuse the first, as where a plane of symmetry must lie between elements.
const FINER_IN_SPACE: [f64; 2] = [1.5, 2.0];

/// A companion that may be run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sketch {
    /// Part of the error that it shows.
    pub part: Part,
    /// Changes of the deck, of which the first counts that gives a model; or the reason why there is no companion.
    pub sets: Result<Vec<Set>, String>,
    /// Size of the increments of the run over those of the companion; `None`: of elements, which the models tell.
    pub refinement: Option<f64>,
}

/// The companions of a run of this deck, with its model.
pub(super) fn sketches(deck: &Deck, model: &Model) -> [Sketch; 2] {
    let meshes = FINER_IN_SPACE.map(|by| finer_meshes(deck, by)).into_iter();
    [
        Sketch {
            part: Part::Time,
            sets: Ok(vec![smaller_increments(model, FINER_IN_TIME)]),
            refinement: Some(FINER_IN_TIME),
        },
        Sketch {
            part: Part::Mesh,
            sets: meshes.collect(),
            refinement: None,
        },
    ]
}

/// Increments and tolerances of all steps divided by `by`.
fn smaller_increments(model: &Model, by: f64) -> Set {
    let steps = model.steps.iter().enumerate();
    let of = |(i, step): (usize, &crate::model::scene::Step)| {
        let now = step.increments;
        let key = |name: &str, value: f64| (format!("steps.{i}.{name}"), (value / by).to_string());
        let mut set = vec![
            key("increments.initial", now.initial),
            key("increments.max", now.max),
            key("tolerance.residual", step.tolerance.residual),
        ];
        // The smallest increment is at most the first one.
        if now.min > now.initial / by {
            set.push(key("increments.min", now.min));
        }
        set
    };
    steps.flat_map(of).collect()
}

/// Meshes of all walls, blocks and arches of the deck with `by` times as many elements along each side; the joint of
/// a wall keeps its one element. Rigid-like walls have no mesh.
///
/// # Errors
/// In words: the mesh of a body is given and cannot be refined. To refine the other bodies alone would show a part of
/// the error only.
fn finer_meshes(deck: &Deck, by: f64) -> Result<Set, String> {
    let given =
        |name: &str| format!("the mesh of `{name}` comes from a file and cannot be refined");
    if let Some(import) = deck.imports.first() {
        return Err(given(&import.name));
    }
    if let Some(block) = deck.blocks.iter().find(|block| block.nodes.is_some()) {
        return Err(given(&block.name));
    }
    let plain = |mesh: [u32; 3]| format!("{:?}", mesh.map(|n| finer(n, false, by)));
    let one = deck.wall.iter().map(|wall| ("wall.mesh".to_owned(), wall));
    let walls = deck.walls.iter().enumerate();
    let walls = one.chain(walls.map(|(i, wall)| (format!("walls.{i}.mesh"), wall)));
    let walls = walls.filter(|(_, wall)| !wall.rigid);
    let walls = walls.map(|(key, wall)| (key, finer_wall(wall, by)));
    let blocks = deck.blocks.iter().enumerate();
    let blocks = blocks.map(|(i, block)| (format!("blocks.{i}.mesh"), plain(block.mesh)));
    let arch = deck.arch.iter();
    let arch = arch.map(|arch| ("arch.mesh".to_owned(), plain(arch.mesh)));
    let set: Set = walls.chain(blocks).chain(arch).collect();
    if set.is_empty() {
        return Err("units are rigid and have no mesh".to_owned());
    }
    Ok(set)
}

/// Mesh of a wall, in the order of its key.
fn finer_wall(wall: &Wall, by: f64) -> String {
    let joints = [&wall.head_joint, &wall.bed_joint].map(|joint| joint.get() > 0.0);
    let mesh = wall.mesh;
    let finer = [
        finer(mesh.length, joints[0], by),
        finer(mesh.height, joints[1], by),
        finer(mesh.thickness, false, by),
    ];
    format!("{finer:?}")
}

/// Number of elements along a side that is `by` times as fine, rounded up. One of them may be that of a joint.
fn finer(elements: u32, joint: bool, by: f64) -> u32 {
    let of_joint = u32::from(joint && elements > 1);
    of_joint + (by * f64::from(elements - of_joint)).ceil() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(name: &str, set: &[(&str, &str)]) -> Deck {
        let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
        let set: Set = set
            .iter()
            .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()))
            .collect();
        Deck::load(format!("{examples}/{name}.toml"), &set).unwrap()
    }

    fn meshes(name: &str, by: f64) -> Vec<String> {
        let set = finer_meshes(&example(name, &[]), by).unwrap();
        set.into_iter()
            .map(|(key, value)| format!("{key}={value}"))
            .collect()
    }

    #[test]
    fn finer_meshes_keep_the_element_of_the_joint() {
        assert_eq!(meshes("03_shear_wall_j7d", 1.5), ["wall.mesh=[7, 3, 3]"]);
        assert_eq!(meshes("03_shear_wall_j7d", 2.0), ["wall.mesh=[9, 3, 4]"]);
        assert_eq!(
            meshes("07_arch", 1.5)[0].split('=').next(),
            Some("arch.mesh")
        );
        // Dry stones have no joint.
        assert_eq!(finer(4, false, 1.5), 6);
        assert_eq!(finer(1, true, 1.5), 2);
        // An imported mesh is given, so that its block is not refined alone.
        let refused = finer_meshes(&example("50_imported_mesh", &[]), 1.5);
        assert!(refused.unwrap_err().contains("`couplet` comes from a file"));
    }

    #[test]
    fn every_step_has_half_the_increments_and_half_the_tolerance() {
        let deck = example("03_shear_wall_j7d", &[("steps.1.increments.min", "0.004")]);
        let (model, _) = Model::from_deck(&deck).unwrap();
        let set = smaller_increments(&model, 2.0);
        let now = model.steps[1].increments;
        let value = |key: &str| -> f64 {
            let found = set.iter().find(|(k, _)| k == key).unwrap();
            found.1.parse().unwrap()
        };
        assert_eq!(value("steps.1.increments.initial"), 0.5 * now.initial);
        assert_eq!(value("steps.1.increments.max"), 0.5 * now.max);
        assert_eq!(value("steps.1.increments.min"), 0.002);
        assert_eq!(
            value("steps.1.tolerance.residual"),
            0.5 * model.steps[1].tolerance.residual
        );
        assert!(set.iter().any(|(k, _)| k == "steps.0.increments.max"));
        // The deck takes them all.
        let text = deck.to_toml().unwrap();
        Deck::from_str_with(&text, "model.toml", &set).unwrap();
    }
}
