//! Rigid-like bodies: walls, blocks and arches that say `rigid = true`.
//!
//! A body is elastic, and a hundred times as stiff as the stiffest joint: what gives way is the joints, whose stiffness
//! the deck must say. A unit of a wall is as few elements as its neighbours let it be, a block or a voussoir as many as
//! its `mesh` says, one if it says nothing.

use super::quantity::{Number, Pressure, Quantity};
use super::schema::{Deck, DeckArch, DeckBlock, Material};
use crate::element::hexahedron::range;

/// Stiffness E/h of a rigid-like body over that of the stiffest joint: joints give way by a hundredth more.
const STIFFER: f64 = 100.0;

/// How stiff rigid-like bodies are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stiffness {
    /// Young's modulus [MPa].
    pub(super) modulus: f64,
    /// Normal stiffness of the stiffest interface of the deck, whether anything meets by it or not [N/mm³].
    pub(super) joint: f64,
    /// Longest side of such a body [mm]; of a voussoir, of its arc along the centre line.
    pub(super) side: f64,
}

/// Whether anything of a deck is rigid-like.
pub(super) fn any(deck: &Deck) -> bool {
    deck.walls().any(|(_, _, wall)| wall.rigid)
        || deck.blocks.iter().any(|b| b.rigid)
        || arch(deck).is_some()
}

fn arch(deck: &Deck) -> Option<&DeckArch> {
    deck.arch.as_ref().filter(|arch| arch.rigid)
}

/// How stiff the rigid-like bodies of a deck are; none without any, or without a joint whose stiffness is said.
pub(super) fn stiffness(deck: &Deck) -> Option<Stiffness> {
    if !any(deck) {
        return None;
    }
    let said = deck.interfaces.values().filter_map(|i| i.normal_stiffness);
    let joint = said.map(Quantity::get).fold(0.0, f64::max);
    let walls = deck.walls().filter(|(_, _, wall)| wall.rigid);
    let units = walls.flat_map(|(_, _, wall)| wall.unit.map(Quantity::get));
    let blocks = deck.blocks.iter().filter(|b| b.rigid).flat_map(sides);
    let stones = arch(deck).into_iter().flat_map(|arch| {
        let arc = arch.centre_line() * arch.embrace() / f64::from(arch.voussoirs);
        [arch.thickness.get(), arch.width.get(), arc]
    });
    let side = units.chain(blocks).chain(stones).fold(0.0, f64::max);
    (joint > 0.0).then_some(Stiffness {
        modulus: STIFFER * joint * side,
        joint,
        side,
    })
}

/// Sides of the box around a block [mm]; none of a grid of nodes.
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

/// Name of the material of rigid-like bodies of the material `name`.
pub(super) fn name_of(name: &str) -> String {
    format!("{name}{RIGID}")
}

/// The material of the deck behind that of rigid-like bodies.
pub(super) fn base(name: &str) -> &str {
    name.strip_suffix(RIGID).unwrap_or(name)
}

const RIGID: &str = " (rigid)";

/// The material of rigid-like bodies: the mass of the deck's, and no tables.
pub(super) fn material(of: &Material, stiffness: Stiffness) -> Material {
    Material::elastic(
        Pressure::new(stiffness.modulus),
        Number::new(0.0),
        of.density,
    )
}
