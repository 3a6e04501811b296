//! Choices for any model: meshes, joints, steps.

use super::scene::{Choice, Group};
use wythe_core::deck::schema::{DeckProcedure, Interface, Material, Wall};
use wythe_core::deck::{Deck, Strategy};
use wythe_core::material::{CrackBand, MaterialParameters};

/// Keys of the deck and their values.
type Set = Vec<(String, String)>;

/// A mesh in the deck: its key, and the number of elements along each side.
struct Mesh {
    key: String,
    sides: [u32; 3],
    /// Whether it is the mesh of a wall, whose key gives the height before the thickness.
    of_wall: bool,
    /// Whether one of the elements along a side belongs to the mortar joint. `[side]`
    joint: [bool; 3],
}

/// All meshes of the deck, including default ones.
fn meshes(deck: &Deck) -> Vec<Mesh> {
    let of_wall = |key: String, wall: &Wall| Mesh {
        key,
        sides: [wall.mesh.length, wall.mesh.thickness, wall.mesh.height],
        of_wall: true,
        joint: [
            wall.head_joint.get() > 0.0,
            false,
            wall.bed_joint.get() > 0.0,
        ],
    };
    let plain = |key: String, sides: [u32; 3]| Mesh {
        key,
        sides,
        of_wall: false,
        joint: [false; 3],
    };
    let wall = deck.wall.iter().map(|w| of_wall("wall.mesh".to_owned(), w));
    let walls = deck.walls.iter().enumerate();
    let walls = walls.map(|(i, w)| of_wall(format!("walls.{i}.mesh"), w));
    let blocks = deck.blocks.iter().enumerate();
    let blocks = blocks.map(|(i, block)| plain(format!("blocks.{i}.mesh"), block.mesh));
    let arch = deck
        .arch
        .iter()
        .map(|arch| plain("arch.mesh".to_owned(), arch.mesh));
    wall.chain(walls).chain(blocks).chain(arch).collect()
}

/// Number of elements of a mesh twice as fine along this side; the joint keeps one.
fn finer(mesh: &Mesh, side: usize) -> u32 {
    let n = mesh.sides[side];
    if mesh.joint[side] && n > 1 {
        2 * (n - 1) + 1
    } else {
        2 * n
    }
}

/// Number of elements of a mesh half as fine along this side; the joint keeps one.
fn coarser(mesh: &Mesh, side: usize) -> u32 {
    let n = mesh.sides[side];
    if mesh.joint[side] && n > 1 {
        (n - 1).div_ceil(2) + 1
    } else {
        n.div_ceil(2)
    }
}

fn mesh_of(meshes: &[Mesh], side: impl Fn(&Mesh, usize) -> u32) -> Set {
    let value = |mesh: &Mesh| {
        let [along, through, up] = [0, 1, 2].map(|s| side(mesh, s));
        if mesh.of_wall {
            format!("[{along},{up},{through}]")
        } else {
            format!("[{along},{through},{up}]")
        }
    };
    meshes.iter().map(|m| (m.key.clone(), value(m))).collect()
}

/// All meshes of the deck with twice as many elements along every side.
pub fn refined(deck: &Deck) -> Set {
    mesh_of(&meshes(deck), finer)
}

/// Increments of a step multiplied by `by`.
pub fn scaled(deck: &Deck, step: usize, by: f64) -> Set {
    let now = deck.steps[step].increments();
    let [initial, max] = [now.initial, now.max].map(|size| (by * size).min(1.0));
    vec![
        (format!("steps.{step}.increments.initial"), number(initial)),
        (format!("steps.{step}.increments.max"), number(max)),
    ]
}

/// A number without the digits that rounding adds.
fn number(x: f64) -> String {
    let rounded = format!("{x:.6e}").parse().unwrap_or(x);
    f64::to_string(&rounded)
}

/// Choices for any model that concern solids, contact, joints, threads and the step `last`. The deck may reject
/// some of them.
pub fn offered(deck: &Deck, last: usize) -> Vec<Choice> {
    let solids = solids(deck).into_iter();
    let points = [
        ("corner points", "contact.points", "corner"),
        ("4x4 points", "contact.parts", "[2,2,2]"),
    ];
    let points = points.map(|(name, key, value)| Choice::new(name, Group::Points, one(key, value)));
    let threads = [2, 4].map(|threads| Choice {
        threads,
        ..Choice::new(&format!("{threads} threads"), Group::Threads, Set::new())
    });
    solids
        .chain(points)
        .chain(joints(deck))
        .chain(step(deck, last))
        .chain(fidelities(deck))
        .chain(strategies(deck))
        .chain(threads)
        .collect()
}

fn one(key: &str, value: &str) -> Set {
    vec![(key.to_owned(), value.to_owned())]
}

/// Formulations of elements, meshes and crack bands.
fn solids(deck: &Deck) -> Vec<Choice> {
    let formulation = |name: &str| {
        let set = one("element.formulation", name);
        Choice::new(&format!("element {name}"), Group::Element, set)
    };
    let mut all = ["b-bar", "full"].map(formulation).to_vec();
    let meshes = meshes(deck);
    let elevation = |mesh: &Mesh, side: usize| match side {
        1 => mesh.sides[1],
        _ => finer(mesh, side),
    };
    let thickness = |mesh: &Mesh, side: usize| match side {
        1 => finer(mesh, 1),
        _ => mesh.sides[side],
    };
    for (name, set) in [
        ("mesh coarser", mesh_of(&meshes, coarser)),
        ("mesh finer in elevation", mesh_of(&meshes, elevation)),
        (
            "mesh finer through the thickness",
            mesh_of(&meshes, thickness),
        ),
        ("mesh finer", mesh_of(&meshes, finer)),
    ] {
        all.push(Choice::new(name, Group::Mesh, set));
    }
    for (name, of) in [
        ("volume", CrackBand::Volume),
        ("projected", CrackBand::Projected),
    ] {
        let others = deck
            .materials
            .iter()
            .filter(|(_, m)| cracks(m) && m.band() != of);
        let band = others.flat_map(|(key, _)| one(&format!("materials.{key}.crack_band"), name));
        all.push(Choice::new(name, Group::CrackBand, band.collect()));
    }
    all
}

/// Whether a material cracks and crushes by damage plasticity.
fn cracks(material: &Material) -> bool {
    matches!(
        material.parameters(),
        MaterialParameters::DamagePlasticity(_)
    )
}

/// Stiffnesses of the joints, as a multiple of that of the joined bodies, or scaled if the deck gives values.
fn joints(deck: &Deck) -> Vec<Choice> {
    let key = |name: &str, of: &str| format!("interfaces.{name}.{of}");
    let over = |factor: f64| {
        let of = |(name, joint): (&String, &Interface)| {
            let other = joint.normal_stiffness.is_none() && joint.penalty() != factor;
            other.then(|| (key(name, "penalty_factor"), number(factor)))
        };
        let set = deck.interfaces.iter().filter_map(of).collect();
        Choice::new(&format!("penalty {factor}"), Group::Penalty, set)
    };
    let times = |(name, by): (&str, f64)| {
        let of = |(name, joint): (&String, &Interface)| {
            let said = [
                ("normal_stiffness", joint.normal_stiffness),
                ("shear_stiffness", joint.shear_stiffness),
            ];
            said.map(|(of, k)| Some((key(name, of), number(by * k?.get()))))
        };
        let set = deck.interfaces.iter().flat_map(of).flatten().collect();
        Choice::new(name, Group::Penalty, set)
    };
    let over = [5.0, 50.0, 500.0, 5000.0].map(over).into_iter();
    over.chain([("joints / 4", 0.25), ("joints x 4", 4.0)].map(times))
        .collect()
}

/// Procedure, tangent, increments and tolerance of a step.
fn step(deck: &Deck, step: usize) -> Vec<Choice> {
    let key = |of: &str| format!("steps.{step}.{of}");
    let procedure = |name: &str| {
        let set = one(&key("procedure"), name);
        Choice::new(&name.replace('_', "-"), Group::Procedure, set)
    };
    let mut all = Vec::new();
    if deck.steps[step].procedure != DeckProcedure::Dynamic {
        all.extend(["static", "quasi_static", "dissipation", "implex"].map(procedure));
    }
    let consistent = one(&key("tangent"), "consistent");
    all.push(Choice::new("consistent", Group::Procedure, consistent));
    for (name, by) in [("steps / 2", 0.5), ("steps x 2", 2.0), ("steps x 4", 4.0)] {
        all.push(Choice::new(name, Group::Step, scaled(deck, step, by)));
    }
    let residual = number(0.2 * deck.steps[step].tolerance().residual);
    let tighter = one(&key("tolerance.residual"), &residual);
    all.push(Choice::new("tolerance / 5", Group::Tolerance, tighter));
    all
}

/// Levels of detail. `elastic` is no choice for solids that are elastic anyway.
fn fidelities(deck: &Deck) -> impl Iterator<Item = Choice> + use<> {
    let cracks = deck.materials.values().any(cracks);
    let names = ["full", "elastic"].into_iter();
    names
        .take(1 + usize::from(cracks))
        .map(|name| Choice::new(name, Group::Fidelity, one("fidelity", name)))
}

/// Coarser strategies of walls whose units are not rigid.
fn strategies(deck: &Deck) -> impl Iterator<Item = Choice> + use<> {
    let any = deck.walls().any(|(.., wall)| !wall.rigid && !wall.expanded);
    let names = [Strategy::Simplified, Strategy::Rigid].map(Strategy::name);
    names
        .into_iter()
        .filter(move |_| any)
        .map(|name| Choice::new(name, Group::Strategy, one("strategy", name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In joints with mortar, one element along the length and the height belongs to the joint, and remains one.
    #[test]
    fn finer_and_coarser_meshes_keep_joints_and_cut_dry_stones() {
        let of = |name: &str, side: fn(&Mesh, usize) -> u32| {
            let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
            let deck = Deck::load(format!("{examples}/{name}.toml"), &[]).unwrap();
            let set = mesh_of(&meshes(&deck), side).into_iter();
            set.filter(|(key, _)| key == "wall.mesh")
                .map(|(_, value)| value)
                .collect::<Vec<_>>()
        };
        assert_eq!(of("03_shear_wall_j7d", finer), ["[9,3,4]"]);
        assert_eq!(of("03_shear_wall_j7d", coarser), ["[3,2,1]"]);
        assert_eq!(of("65_quarter_wall", finer), ["[8,4,4]"]);
        assert_eq!(of("65_quarter_wall", coarser), ["[2,1,1]"]);
    }
}
