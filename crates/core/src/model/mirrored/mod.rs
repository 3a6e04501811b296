//! Models that are their own mirror image, and the half that represents the whole (theory/symmetry.md).
//!
//! The half has the same nodes, elements, joints and laws as the whole on one side of the plane. Each of its results
//! belongs to the whole and, mirrored, to the other side.

mod cut;
mod images;

pub(crate) use cut::Half;
pub(crate) use images::Images;

use super::Model;
use super::axis::Axis;
use std::borrow::Cow;
use std::fmt;

/// A plane in which a model is mirrored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorPlane {
    /// Axis normal to it: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Coordinate of the plane on the axis [mm].
    pub at: f64,
}

impl fmt::Display for MirrorPlane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Rounded to 1e-6 without a negative zero, so that no rounding error is shown.
        let at = (1e6 * self.at).round() / 1e6 + 0.0;
        write!(f, "{} = {at} mm", Axis::NAMES[self.axis])
    }
}

/// Name of the remaining part of a model after a number of planes. None for the whole.
pub(crate) fn part(planes: usize) -> Option<&'static str> {
    match planes {
        0 => None,
        1 => Some("one half"),
        2 => Some("a quarter"),
        _ => Some("an eighth"),
    }
}

/// First plane in which a model with its supports, loads and output is mirrored, and the half below it.
pub(crate) fn halved(model: &Model) -> Option<(Images, Half)> {
    // Walls are mirrored through their thickness more often than along their length.
    [1, 0, 2].into_iter().find_map(|axis| {
        let images = Images::of(model, axis)?;
        let half = cut::half(model, &images)?;
        Some((images, half))
    })
}

/// Mirror planes of a model, in the order in which halves are taken, and the part that `fidelity = "auto"` solves:
/// the half left when no further plane is found, or the whole model.
pub(crate) fn reduced(model: &Model) -> (Vec<MirrorPlane>, Cow<'_, Model>) {
    let (mut planes, mut least) = (Vec::new(), Cow::Borrowed(model));
    while let Some((Images { axis, at, .. }, half)) = halved(&least) {
        planes.push(MirrorPlane { axis, at });
        least = Cow::Owned(half.model);
    }
    (planes, least)
}

/// Mirror planes of a model, in the order in which halves are taken.
pub fn mirror_planes(model: &Model) -> Vec<MirrorPlane> {
    reduced(model).0
}
