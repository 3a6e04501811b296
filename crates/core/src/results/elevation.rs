//! `crack_pattern.svg`: the front of the deformed wall with its cracks; the face y = min of a mesh, and the
//! magnification of displacements in pictures.

use super::Snapshot;
use super::wall_picture::{Look, wall_picture};
use crate::model::{Mesh, Model};
pub use crate::state::CRUSHED;
use crate::state::Frame;

/// Local nodes of the face at −y, counter-clockwise seen from outside.
pub const FRONT: [usize; 4] = [0, 1, 5, 4];

/// Front of a frame as SVG text, without joints, with displacements magnified by [`magnification`].
pub fn crack_pattern(model: &Model, frame: &Frame) -> String {
    let snapshot = Snapshot {
        title: model.title.clone(),
        mesh: model.mesh.clone(),
        frame: frame.clone(),
        ..Snapshot::default()
    };
    crack_pattern_of(&snapshot, Some(model))
}

/// Front of a run at a frame as SVG text, with its joints, and the supports and loads of its model.
pub fn crack_pattern_of(snapshot: &Snapshot, model: Option<&Model>) -> String {
    // Only sections can miss the model.
    wall_picture(snapshot, model, &Look::default()).unwrap_or_default()
}

/// Smallest y and extent in y [mm].
fn depth(mesh: &Mesh) -> (f64, f64) {
    let [front, back] = mesh.extent(1);
    (front, (back - front).max(0.0))
}

/// Elements with a face on y = min.
pub fn front(mesh: &Mesh) -> impl Iterator<Item = usize> + '_ {
    let (front, size) = depth(mesh);
    // Coordinates on the same face may differ by rounding.
    let on_front = move |e: &usize| {
        FRONT
            .iter()
            .all(|&i| mesh.corners(*e)[i][1] - front <= 1e-9 * size)
    };
    (0..mesh.elements.len()).filter(on_front)
}

/// Magnification of displacements: the largest of 1, 2, 5, 10, … that moves no node by more than 4 % of the largest
/// extent of the model, and at least 1.
pub fn magnification(mesh: &Mesh, frame: &Frame) -> f64 {
    let extent = (0..3)
        .map(|i| {
            let (low, high) = mesh
                .nodes
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                    (low.min(x[i]), high.max(x[i]))
                });
            high - low
        })
        .fold(0.0, f64::max);
    suitable(extent, largest(&frame.displacement))
}

/// Largest displacement in the drawing plane, x and z [mm].
pub(super) fn largest(displacement: &[[f64; 3]]) -> f64 {
    let size = displacement.iter().map(|u| u[0].hypot(u[2]));
    size.fold(0.0, f64::max)
}

/// Magnification for displacements up to `largest` on a model of this extent [mm].
pub(super) fn suitable(extent: f64, largest: f64) -> f64 {
    let most = 0.04 * extent / largest;
    // It is not finite if nothing has moved or the model is empty.
    if !(most.is_finite() && most > 1.0) {
        return 1.0;
    }
    let decade = 10_f64.powf(most.log10().floor());
    [5.0, 2.0, 1.0]
        .map(|f| f * decade)
        .into_iter()
        .find(|f| *f <= most)
        .unwrap_or(1.0)
}

/// Lower and upper bounds of corners: x₀, y₀, x₁, y₁; a unit square without corners.
pub(super) fn bounds(corners: impl Iterator<Item = [f64; 2]>) -> [f64; 4] {
    let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
    let found = corners.fold([low, low, high, high], |b, [x, y]| {
        [b[0].min(x), b[1].min(y), b[2].max(x), b[3].max(y)]
    });
    if found[0] <= found[2] {
        found
    } else {
        [0.0, 0.0, 1.0, 1.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    #[test]
    fn the_magnification_is_round_and_moderate() {
        let model = fake::model(); // 202 mm long: 4 % are 8.08 mm
        let mut frame = fake::frame(&model, 0.0);
        assert_eq!(magnification(&model.mesh, &frame), 1.0);
        for (moved, expected) in [
            (0.1, 50.0),
            (0.01, 500.0),
            (0.3, 20.0),
            (1.0, 5.0),
            (50.0, 1.0),
        ] {
            frame.displacement[3] = [0.0, 1e3, moved];
            assert_eq!(magnification(&model.mesh, &frame), expected, "{moved}");
        }
    }
}
