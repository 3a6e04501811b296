//! Answers of a run in the terms of engineers and codes: `answers` in `summary.json`.
//!
//! ```text
//! curve ────────────────▶ secant stiffness, drifts, bilinear idealisation, loops
//! solver ───────────────▶ first damage
//! last frame, peak frame ▶ mode of failure, crack widths
//! mode and curve ───────▶ performance points
//! ```
//!
//! All are whole-model values along the drive. Every definition is here and nowhere else; the command, the report and
//! Python show what is in `summary.json`. Of a run without a summary they have the answers of the curve.

mod bilinear;
mod cracks;
mod failure;
mod first_damage;
mod lines;
mod loops;
mod performance;
mod place;
mod scene;
mod sections;
#[cfg(test)]
mod tests;
mod walls;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

pub use super::backbone::Backbone;
pub use bilinear::{Bilinear, ELASTIC, ULTIMATE};
pub use cracks::{BURLAND, Crack, CrackWidths, burland_class, name_of_class};
pub use failure::{FailureMeasure, FailureMode};
pub use first_damage::{FirstDamage, Onset, first_damage};
pub use lines::{Line, of_point};
pub use loops::{Loop, loops};
pub use performance::{LimitState, PerformancePoint, at_drifts, of_code};
pub use place::Place;
pub use sections::SectionForces;
pub use walls::WallAnswer;

use super::snapshot::Snapshots;
use super::{Curve, FrameChoice, Snapshot};
use crate::model::Model;
use crate::model::drive::Drive;
use crate::state::{HistoryRow, Status, Summary};

/// Answers of a run; the names of the fields are the keys. What a run does not have is `None` or empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[allow(non_snake_case)]
// More than 15 fields: one for each key of the file.
pub struct Answers {
    /// Clear height between the supports below and the driven part above [mm]; `None` if nothing above is driven
    /// sideways.
    pub height_mm: Option<f64>,
    /// Direction in which force and displacement count, such as `x` or `-y`; `None` if nothing is driven.
    pub drive_direction: Option<String>,
    /// Displacement at the peak over the height [-].
    pub drift_at_peak: Option<f64>,
    /// Secant stiffness up to 0.7 of the peak [kN/mm].
    pub secant_stiffness_kN_per_mm: Option<f64>,
    /// Bilinear curve of the same energy.
    pub bilinear: Option<Bilinear>,
    /// The same for the opposite side of a drive to and fro.
    pub opposite_bilinear: Option<Bilinear>,
    /// Loops of a drive to and fro.
    pub loops: Vec<Loop>,
    /// First damage.
    pub first_damage: FirstDamage,
    /// Base shear at the largest force: the sum of the support reactions along the drive, with the sign with which it
    /// balances the drive [kN]; `None` if nothing is driven sideways.
    pub base_shear_at_peak_kN: Option<f64>,
    /// Forces of the supports at the largest force, by the names of `supports/NAME` [kN]. `[xyz]`
    pub reactions_at_peak_kN: BTreeMap<String, [f64; 3]>,
    /// Forces in the sections at the largest force.
    pub sections_at_peak: Vec<SectionForces>,
    /// Mode of failure; `None` if nothing failed or nothing moves sideways.
    pub failure_mode: Option<FailureMode>,
    /// Quantities by which the mode is told; `None` if nothing moves sideways.
    pub failure_measure: Option<FailureMeasure>,
    /// Mode of failure of each wall along the drive; empty if the model has one wall only.
    pub walls: Vec<WallAnswer>,
    /// Widest cracks at the frame nearest to the peak; `None` if nothing is driven.
    pub cracks_at_peak: Option<CrackWidths>,
    /// Widest cracks at the last frame.
    pub cracks_at_end: Option<CrackWidths>,
    /// Points of the curve at the limits of EN 1998-3 for the mode of failure.
    pub performance_points: Vec<PerformancePoint>,
}

impl Answers {
    /// The answers of a curve alone, with the clear height [mm].
    pub fn of_curve(curve: &Curve, height: Option<f64>) -> Self {
        let side = Backbone::of(curve, false);
        let turns = curve.turns_back();
        let opposite = Backbone::of(curve, true).filter(|_| turns);
        let bilinear = |side: &Backbone| Bilinear::of(side, height);
        let travel = curve
            .peak()
            .map(|p| (p.displacement - curve.start().0).abs());
        Self {
            height_mm: height,
            drift_at_peak: travel.zip(height).map(|(travel, height)| travel / height),
            secant_stiffness_kN_per_mm: side.as_ref().and_then(|side| side.secant(ELASTIC)),
            bilinear: side.as_ref().and_then(bilinear),
            opposite_bilinear: opposite.as_ref().and_then(bilinear),
            loops: loops(curve),
            ..Self::default()
        }
    }

    /// All answers of a run that has ended. Without fields, those of the frames are left out.
    pub fn of_run(model: &Model, run: &Summary, curve: &Curve, frames: Option<&Snapshots>) -> Self {
        let height = super::comparison::clear_height(model);
        let mut answers = Self {
            first_damage: first_damage(model, &run.first_damage),
            drive_direction: Drive::of(model).map(Drive::name),
            ..Self::of_curve(curve, height)
        };
        let Some(frames) = frames else {
            return answers;
        };
        let at = |choice| frames.at(choice).ok();
        let last = at(FrameChoice::Last);
        let peak = at(FrameChoice::Peak).filter(|_| curve.peak().is_some());
        answers.cracks_at_end = last.as_ref().map(|last| CrackWidths::of(model, last));
        answers.cracks_at_peak = peak.as_ref().map(|peak| CrackWidths::of(model, peak));
        answers.add_reactions(model, curve, frames);
        answers.add_sections(model, curve, frames);
        let farthest = frames.farthest_from(curve.start().0);
        let farthest = farthest.filter(|_| curve.turns_back());
        let judged = farthest.and_then(|frame| at(FrameChoice::Number(frame)));
        if let Some(judged) = judged.or(last) {
            answers.judge((model, run, curve), peak.as_ref(), &judged);
        }
        answers
    }

    /// Adds the reactions at the largest force.
    fn add_reactions(&mut self, model: &Model, curve: &Curve, frames: &Snapshots) {
        let time = frames.history().time_of_peak();
        let mut rows = frames.history().rows.iter();
        let row = rows.find(|row| Some(row.time) == time);
        let read = |row: &HistoryRow| frames.reactions(row.increment).ok();
        let (Some(forces), true) = (row.and_then(read), curve.peak().is_some()) else {
            return;
        };
        // A row of another recorder may be without forces, which the file has as NaN.
        if forces.iter().any(|(_, f)| f.iter().any(|f| !f.is_finite())) {
            return;
        }
        for (path, force) in forces {
            if let Some(name) = path.strip_prefix("supports/") {
                let force = force.map(|f| 1e-3 * f);
                self.reactions_at_peak_kN.insert(name.to_owned(), force);
            }
        }
        if self.reactions_at_peak_kN.is_empty() {
            return;
        }
        let sideways = Drive::of(model).and_then(Drive::sideways);
        self.base_shear_at_peak_kN = sideways.map(|[x, y]| {
            let along = |force: &[f64; 3]| -(x * force[0] + y * force[1]);
            self.reactions_at_peak_kN.values().map(along).sum()
        });
    }

    /// Adds the forces in the sections at the largest force; of a run without a curve, in the last increment.
    fn add_sections(&mut self, model: &Model, curve: &Curve, frames: &Snapshots) {
        let history = frames.history();
        let peak = history.time_of_peak().filter(|_| curve.peak().is_some());
        let row = match peak {
            Some(peak) => history.rows.iter().find(|row| row.time == peak),
            None => history.rows.last(),
        };
        self.sections_at_peak = row.map_or_else(Vec::new, |row| SectionForces::all(model, row));
    }

    /// Adds the mode of failure and the performance points, from the frames at the peak and at the end.
    fn judge(
        &mut self,
        (model, run, curve): (&Model, &Summary, &Curve),
        peak: Option<&Snapshot>,
        last: &Snapshot,
    ) {
        let Some(scene) = scene::Scene::of(model, last) else {
            return;
        };
        let lost = curve.passes_peak() || run.status == Status::Collapsed;
        let travel = travel(&scene, curve, last);
        let mut measure = FailureMeasure::of(&scene, last, travel, lost);
        if let Some(peak) = peak {
            measure.add_peak(&scene, peak);
        }
        self.failure_mode = measure.mode();
        self.failure_measure = Some(measure);
        self.walls = walls::of_walls(model, &scene, (peak, last), lost);
        let side = Backbone::of(curve, false);
        if let (Some(side), Some(height), Some(mode)) = (side, self.height_mm, self.failure_mode) {
            let slenderness = peak.and_then(|peak| slenderness(&scene, peak, curve));
            self.performance_points = of_code(&side, height, mode, slenderness);
        }
    }
}

/// Displacement of the top [mm]: that of the drive at the last frame, else the largest of a node along the axis.
fn travel(scene: &scene::Scene, curve: &Curve, last: &Snapshot) -> f64 {
    let row = last.row.as_ref().filter(|_| curve.peak().is_some());
    let of_drive = row.map(|row| (row.displacement_mm - curve.start().0).abs());
    of_drive.unwrap_or_else(|| {
        let along = last.frame.displacement.iter().map(|u| u[scene.axis].abs());
        along.fold(0.0, f64::max)
    })
}

/// H₀/D at the largest force: the moment in the lowest bed joint over the force, and over the length of the joint [-].
fn slenderness(scene: &scene::Scene, peak: &Snapshot, curve: &Curve) -> Option<f64> {
    let base = failure::Base::of(scene, peak)?;
    // The force of the frame, which may lie beside the peak.
    let of_frame = peak.row.as_ref().map(|row| row.force_kN);
    let force = 1e3 * of_frame.or(curve.peak().map(|p| p.force))?.abs();
    let moment = base.normal * base.eccentricity * 0.5 * base.length;
    (force > 0.0).then(|| moment / force / base.length)
}
