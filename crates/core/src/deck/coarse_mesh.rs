//! Warnings about meshes with too few points of contact along a unit or through a wall (docs/known-limits.md).

use super::masonry::Masonry;
use super::schema::{Bond, Deck};
use super::wall_defaults::bends;
use crate::error::Warning;

/// Least number of elements along a unit and its head joint: with one along the unit alone, a joint has points at a quarter
/// and three quarters of it only.
const ALONG: u32 = 3;

/// Least number of elements, or of parts of a facet, through a wall that is bent.
const THROUGH: u32 = 3;

/// Warnings about the mesh of a wall with mortar. Joints of dry walls have points at the edges of their faces.
pub(super) fn coarse_mesh(deck: &Deck, masonry: &Masonry<'_>) -> Vec<Warning> {
    let wall = masonry.wall;
    if wall.mortar_material.is_none() || wall.rigid || wall.expanded {
        return Vec::new();
    }
    let (along, through) = wall.axes();
    let parts = |axis: usize| deck.contact.parts[axis];
    let path = format!("{}.mesh", masonry.path);
    let mut warnings = Vec::new();
    let overlaps = wall.courses > 1 && wall.bond != Bond::Stack;
    if overlaps && (wall.mesh.length - 1) * parts(along) < ALONG - 1 {
        let message = "one element along a unit: its joints have so few points that walls are up to 50 % too soft where head \
                       joints of neighbouring courses do not match, and have up to 41 % less than their peak; the default \
                       has 4 and one of the head joint";
        warnings.push(deck.warning(&path, message));
    }
    let mut steps = deck.steps.iter();
    let bent = steps.any(|step| bends(step, &masonry.name, wall));
    let rows = wall.mesh.thickness * parts(through);
    if bent && rows < THROUGH {
        let message = format!(
            "{rows} of 3 elements through a wall that is bent: its force is about {} % too low; contact.parts divides the joints \
             instead",
            if rows == 1 { 16 } else { 3 }
        );
        warnings.push(deck.warning(&path, message));
    }
    warnings
}
