//! Scenes that nothing holds along an axis.

use super::schema::Deck;
use crate::error::Warning;
use crate::model::Model;
use crate::model::scene::{BeamMotion, Step};

/// One warning for each axis along which neither supports nor springs, ties or beams hold any part of a scene at rest.
/// It is free to move there as a whole, and the smallest force sets it in motion.
pub(super) fn loose_scene(deck: &Deck, model: &Model) -> Vec<Warning> {
    // Bodies that fly are meant to move, and a drive along an axis holds the scene there.
    let moves = |step: &Step| step.procedure.has_inertia();
    if model.steps.is_empty() || model.steps.iter().any(moves) || !model.ties.is_empty() {
        return Vec::new();
    }
    let supported = |axis: usize| model.supports.iter().any(|support| support.fixed[axis]);
    let sprung = |axis: usize| model.springs.iter().any(|s| s.stiffness[axis] != 0.0);
    let beams_hold = |axis: usize| {
        let mut motion = model.steps.iter().flat_map(|step| &step.motion);
        motion.any(|motion| !matches!(motion[axis], BeamMotion::Force(_)))
    };
    let is_loose = |axis: &usize| !(supported(*axis) || sprung(*axis) || beams_hold(*axis));
    let loose = (0..3).filter(is_loose);
    let warnings = loose.map(|axis| {
        let axis = ["x", "y", "z"][axis];
        deck.warning(
            "supports",
            format!(
                "nothing holds the scene along {axis}: it is free to move there as a whole, and the smallest force sets it in \
                 motion; hold a node or a face there, for instance with fixed = [\"{axis}\"]"
            ),
        )
    });
    warnings.collect()
}
