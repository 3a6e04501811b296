//! Mode of failure of each wall of a building, by the rule of [`failure`](super::failure).

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::failure::{FailureMeasure, FailureMode};
use super::scene::Scene;
use crate::model::Model;
use crate::model::mesh::WallOfUnits;
use crate::results::Snapshot;

/// What a wall of a building did that stands along the drive.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct WallAnswer {
    /// Name of the wall.
    pub name: String,
    /// Mean displacement of its top along the drive in the frame that is judged [mm].
    pub displacement_mm: f64,
    /// Mode of failure; `None` if nothing failed.
    pub failure_mode: Option<FailureMode>,
    /// Quantities by which the mode is told.
    pub failure_measure: FailureMeasure,
}

impl WallAnswer {
    /// In words.
    pub fn told(&self) -> String {
        let mode = self
            .failure_mode
            .map_or("nothing failed", FailureMode::told);
        format!(
            "{}: {mode}; its top at {:.3} mm",
            self.name, self.displacement_mm
        )
    }
}

/// Answers of all walls of a scene whose longer side runs along the drive, from the frame of the peak and from the frame that is
/// judged; none of a model with one wall only. `force_lost`: whether the force of the whole has fallen.
pub(super) fn of_walls(
    model: &Model,
    whole: &Scene,
    (peak, last): (Option<&Snapshot>, &Snapshot),
    force_lost: bool,
) -> Vec<WallAnswer> {
    let walls = &model.mesh.walls;
    if walls.len() <= 1 {
        return Vec::new();
    }
    let of_wall = |wall: &WallOfUnits| {
        let scene = whole.of_wall(model, wall)?;
        let displacement_mm = top(model, &scene, last);
        let mut measure = FailureMeasure::of(&scene, last, displacement_mm.abs(), force_lost);
        if let Some(peak) = peak {
            measure.add_peak(&scene, peak);
        }
        Some(WallAnswer {
            name: wall.name.clone(),
            displacement_mm,
            failure_mode: measure.mode(),
            failure_measure: measure,
        })
    };
    walls.par_iter().filter_map(of_wall).collect()
}

/// Mean displacement of the nodes at the top of a wall along its drive [mm].
fn top(model: &Model, scene: &Scene, last: &Snapshot) -> f64 {
    let [bottom, top] = scene.levels;
    let near = NEAR * (top - bottom);
    let nodes = scene.solids.iter().flat_map(|e| model.mesh.elements[*e]);
    let nodes = nodes.filter(|n| (model.mesh.nodes[*n as usize][2] - top).abs() <= near);
    let moved = nodes.map(|n| last.frame.displacement[n as usize][scene.axis]);
    let (sum, count) = moved.fold((0.0, 0.0), |(sum, count), u| (sum + u, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// Heights within this part of that of the wall are its top [-].
const NEAR: f64 = 1e-6;
