//! Rigid bodies: walls, blocks and arches with `rigid = true` (theory/rigid-bodies.md).
//!
//! Bodies of which a beam, a spring, a tie or a support holds single nodes stay solids: elastic, and a hundred times as
//! stiff as the stiffest joint, so that joints deform instead. The deck must give the stiffness of the joints. Units of
//! walls have as few elements as their neighbours allow; blocks and voussoirs have those of their `mesh`, by default
//! one.

use super::quantity::{Number, Pressure, Quantity};
use super::schema::{Deck, DeckArch, DeckBlock, Material};
use crate::element::hexahedron::range;
use crate::model::Model;
use crate::model::scene::NamedMaterial;

/// Stiffness E/h of a rigid body over that of the stiffest joint: bodies add a hundredth to the compliance of
/// joints.
const STIFFER: f64 = 100.0;

/// Stiffness of rigid bodies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stiffness {
    /// Young's modulus [MPa].
    pub(super) modulus: f64,
    /// Normal stiffness of the stiffest interface of the deck, used or not [N/mm³].
    pub(super) joint: f64,
    /// Longest side of a rigid body [mm]; of a voussoir, its arc along the centre line counts.
    pub(super) side: f64,
}

/// Returns whether a deck has rigid bodies.
pub(super) fn any(deck: &Deck) -> bool {
    deck.walls().any(|(_, _, wall)| wall.rigid)
        || deck.blocks.iter().any(|b| b.rigid)
        || arch(deck).is_some()
}

fn arch(deck: &Deck) -> Option<&DeckArch> {
    deck.arch.as_ref().filter(|arch| arch.rigid)
}

/// Stiffness of the rigid bodies of a deck; none if there are no such bodies, or if no joint has an explicit
/// stiffness.
///
/// `of_files`: longest side of the rigid blocks of files [mm].
pub(super) fn stiffness(deck: &Deck, of_files: f64) -> Option<Stiffness> {
    if !any(deck) {
        return None;
    }
    let joint = stiffest_joint(deck);
    let walls = deck.walls().filter(|(_, _, wall)| wall.rigid);
    let units = walls.flat_map(|(_, _, wall)| wall.unit.map(Quantity::get));
    let blocks = deck.blocks.iter().filter(|b| b.rigid).flat_map(sides);
    let stones = arch(deck).into_iter().flat_map(|arch| {
        let arc = arch.centre_line() * arch.embrace() / f64::from(arch.voussoirs);
        [arch.thickness.get(), arch.width.get(), arc]
    });
    let side = units.chain(blocks).chain(stones).fold(of_files, f64::max);
    (joint > 0.0).then_some(Stiffness {
        modulus: STIFFER * joint * side,
        joint,
        side,
    })
}

/// Stiffness of the rigid bodies of a model that was built from a deck; none if there are no such bodies.
pub(super) fn of_model(deck: &Deck, model: &Model) -> Option<Stiffness> {
    let is_rigid = |m: &&NamedMaterial| base(&m.name) != m.name;
    let modulus = model
        .materials
        .iter()
        .find(is_rigid)?
        .parameters
        .elastic()
        .E;
    let joint = stiffest_joint(deck);
    Some(Stiffness {
        modulus,
        joint,
        side: modulus / (STIFFER * joint),
    })
}

/// Largest normal stiffness that an interface of the deck gives [N/mm³]; 0 if none does.
fn stiffest_joint(deck: &Deck) -> f64 {
    let said = deck.interfaces.values().filter_map(|i| i.normal_stiffness);
    said.map(Quantity::get).fold(0.0, f64::max)
}

/// Sides of the bounding box of a block [mm]; 0 for a grid of nodes and for blocks of a file.
fn sides(block: &DeckBlock) -> [f64; 3] {
    let of_corners = block.corners.map(|corners| {
        [0, 1, 2].map(|d| {
            let [low, high] = range(corners.map(|c| c[d].get()));
            high - low
        })
    });
    let of_size = block.size.map(|size| size.map(Quantity::get));
    of_size.or(of_corners).unwrap_or_default()
}

/// Name of the material of rigid bodies whose material is `name`.
pub(super) fn name_of(name: &str) -> String {
    format!("{name}{RIGID}")
}

/// Name of the material of the deck from which a rigid one was made.
pub(super) fn base(name: &str) -> &str {
    name.strip_suffix(RIGID).unwrap_or(name)
}

const RIGID: &str = " (rigid)";

/// Material of rigid bodies: density of the deck's material, without tables.
pub(super) fn material(of: &Material, stiffness: Stiffness) -> Material {
    Material::elastic(
        Pressure::new(stiffness.modulus),
        Number::new(0.0),
        of.density,
    )
}
