//! Models that are their own mirror image, and the half that tells of the whole.
//!
//! The half has the very nodes, elements, joints and laws of the whole on one side of the plane, so that each of its
//! results is one of the whole and of its mirror image.

mod cut;
mod images;

pub(crate) use cut::Half;
pub(crate) use images::Images;

use super::Model;
use super::axis::Axis;
use std::borrow::Cow;
use std::fmt;

/// A plane by which a model is mirrored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorPlane {
    /// Axis normal to it: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Where it lies on the axis [mm].
    pub at: f64,
}

impl fmt::Display for MirrorPlane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // To a millionth, so that no rounding is told; and no −0.
        let at = (1e6 * self.at).round() / 1e6 + 0.0;
        write!(f, "{} = {at} mm", Axis::NAMES[self.axis])
    }
}

/// What is left of a model that so many planes cut in two, in words; none if it is whole.
pub(crate) fn part(planes: usize) -> Option<&'static str> {
    match planes {
        0 => None,
        1 => Some("one half"),
        2 => Some("a quarter"),
        _ => Some("an eighth"),
    }
}

/// The first plane by which a model, its supports, loads and all that it tells of are mirrored, and the half below it.
pub(crate) fn halved(model: &Model) -> Option<(Images, Half)> {
    // Walls are mirrored through their thickness more often than along their length.
    [1, 0, 2].into_iter().find_map(|axis| {
        let images = Images::of(model, axis)?;
        let half = cut::half(model, &images)?;
        Some((images, half))
    })
}

/// Planes by which a model is its own mirror image, in the order in which halves are taken of it, and what `fidelity = "auto"`
/// solves of it: the half that is left when no other can be taken, or all of it.
pub(crate) fn reduced(model: &Model) -> (Vec<MirrorPlane>, Cow<'_, Model>) {
    let (mut planes, mut least) = (Vec::new(), Cow::Borrowed(model));
    while let Some((Images { axis, at, .. }, half)) = halved(&least) {
        planes.push(MirrorPlane { axis, at });
        least = Cow::Owned(half.model);
    }
    (planes, least)
}

/// Planes by which a model is its own mirror image, in the order in which halves are taken of it.
pub fn mirror_planes(model: &Model) -> Vec<MirrorPlane> {
    reduced(model).0
}
