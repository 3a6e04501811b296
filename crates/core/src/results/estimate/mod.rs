//! Estimate of the error of a run by its discretisation.
//!
//! ```text
//! run ──────────────────────────────┐
//! companion: half the increments ───┼─▶ differences ─▶ parts (time, mesh, …) ─▶ peak, area, displacement ± error
//! companion: a finer mesh ──────────┘                                           in summary.json
//! ```
//!
//! Let the error of a figure be proportional to the power p of the size of increments or elements. A companion whose
//! sizes are 1/r of those of the run has r⁻ᵖ of its error, so that the run is off by rᵖ/(rᵖ − 1) times the difference
//! between both (Richardson). `docs/how-to/state-the-error.md` compares estimates with known errors.

#[cfg(feature = "run-folder")]
mod companions;
mod figures;
mod rounded;
#[cfg(feature = "run-folder")]
mod running;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Curve;
use crate::state::Status;
pub use figures::{Figures, width};
pub use rounded::{percent, rounded};
#[cfg(feature = "run-folder")]
pub use running::{FOLDER, Prepared, estimate_error, remove_companions};

/// Smallest error that is stated, as a fraction of the figure [-]. Companions may agree by chance, and what is left
/// then is the scatter of equilibria within their tolerance: curves of the same wall that are solved as a half and as
/// a whole differ by 0.1 to 0.4 % of the peak (docs/accuracy-speed.md, scenes 3 and 5).
pub const SCATTER: f64 = 0.002;

/// Cause of a part of the error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Size of the increments and tolerance of equilibrium.
    Time,
    /// Size of the elements.
    Mesh,
    /// Stiffness of joints that stands for a rigid contact.
    Penalty,
    /// Scatter of equilibria within their tolerance.
    Scatter,
    /// Of the displacement at the peak: a flat top, and the distance of the increments.
    FlatPeak,
}

impl Part {
    /// Power of the size with which the error of the part falls. Increments: first order, as of the implicit Euler
    /// method. Elements: second order, that of linear elements with incompatible modes; cracks reduce it, and the
    /// table of `docs/how-to/state-the-error.md` shows how far that matters.
    fn order(self) -> i32 {
        match self {
            Self::Mesh => 2,
            _ => 1,
        }
    }

    /// Name in texts and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Mesh => "mesh",
            Self::Penalty => "penalty",
            Self::Scatter => "scatter",
            Self::FlatPeak => "flat peak",
        }
    }
}

/// Estimated errors of the figures of a run, `error_estimate` in `summary.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct ErrorEstimate {
    /// Largest force [kN].
    pub peak_force_kN: Option<Estimated>,
    /// Area under the curve to the end of the run [J].
    pub area_J: Option<Estimated>,
    /// Displacement at the largest force [mm].
    pub displacement_at_peak_mm: Option<Estimated>,
    /// Whether the largest force is a peak that the run has passed.
    pub passes_peak: bool,
    /// Runs of the same model with another discretisation.
    pub companions: Vec<Companion>,
    /// Parts that are not in the errors.
    pub not_estimated: Vec<NotEstimated>,
}

/// A figure and its error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// Figure of the run.
    pub value: f64,
    /// Estimate of its error, in the same unit: the root of the sum of the squares of the parts.
    pub error: f64,
    /// The same relative to the figure [-]; `None` if the figure is 0.
    pub relative: Option<f64>,
    /// Parts of the error, in the same unit.
    pub parts: BTreeMap<Part, f64>,
    /// The largest part.
    pub mostly: Part,
}

/// A run of the same model with another discretisation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Companion {
    /// Part of the error that it shows.
    pub part: Part,
    /// Its results, relative to the folder of the run.
    pub folder: String,
    /// Changes of the deck, as of `--set`.
    pub set: Vec<String>,
    /// Size of increments or elements of the run over that of the companion [-]; `None` if it has no model.
    pub refinement: Option<f64>,
    /// How it ended; `None` if it did not run.
    pub status: Option<Status>,
    /// Its figures; `None` if it did not end.
    pub figures: Option<Figures>,
}

/// A part of the error that is not known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NotEstimated {
    /// The part.
    pub part: Part,
    /// Reason.
    pub why: String,
}

/// A companion beside the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compared {
    /// Part of the error that it shows.
    pub part: Part,
    /// Size of increments or elements of the run over that of the companion, above 1 [-].
    pub refinement: f64,
    /// [`Figures::differences`].
    pub differences: [f64; 3],
}

impl Compared {
    /// Estimate of the part for force and area: rᵖ/(rᵖ − 1) times their difference, for an error of the order p.
    fn error(&self, figure: usize) -> f64 {
        let r = self.refinement.powi(self.part.order());
        r / (r - 1.0) * self.differences[figure]
    }

    /// Estimate of the part for the displacement at the peak: the difference itself. A peak jumps from one top of the
    /// curve to another, by no power of the size.
    fn error_of_displacement(&self) -> f64 {
        self.differences[2]
    }
}

impl Estimated {
    fn new(value: f64, parts: BTreeMap<Part, f64>) -> Self {
        let error = parts.values().map(|part| part * part).sum::<f64>().sqrt();
        let largest = parts.iter().max_by(|a, b| a.1.total_cmp(b.1));
        Self {
            value,
            error,
            relative: (value != 0.0).then(|| error / value.abs()),
            mostly: largest.map_or(Part::Scatter, |(part, _)| *part),
            parts,
        }
    }

    /// Value and error with the unit, and in brackets the error in percent and its largest part, or the parts that
    /// are lacking: `108.5 ± 1.9 kN (1.7 %, mostly mesh)`.
    fn line(&self, unit: &str, lacking: &[&str]) -> String {
        let said = self.short(unit);
        let notes = match lacking {
            [] => format!("mostly {}", self.mostly.name()),
            _ => format!("without {}", lacking.join(" and ")),
        };
        match self.relative {
            Some(relative) => format!("{said} ({}, {notes})", percent(relative)),
            None => format!("{said} ({notes})"),
        }
    }

    /// Value and error with the unit: `3.6 ± 0.3 mm`.
    pub fn short(&self, unit: &str) -> String {
        let (value, error) = rounded(self.value, self.error);
        format!("{value} ± {error} {unit}")
    }
}

impl ErrorEstimate {
    /// Errors of the figures of a run from its companions. Without a companion that ended, or if nothing moved, the
    /// figures have no error. The parts of `not_estimated` are added to.
    pub fn of(run: &Curve, compared: &[Compared], companions: Vec<Companion>) -> Self {
        let mut estimate = Self {
            companions,
            passes_peak: run.passes_peak(),
            ..Self::default()
        };
        let (Some(figures), false) = (Figures::of(run), compared.is_empty()) else {
            return estimate;
        };
        let parts = |figure: usize| -> BTreeMap<Part, f64> {
            compared.iter().map(|c| (c.part, c.error(figure))).collect()
        };
        let with_scatter = |value: f64, figure: usize| {
            let mut parts = parts(figure);
            parts.insert(Part::Scatter, SCATTER * value.abs());
            Estimated::new(value, parts)
        };
        let peak = with_scatter(figures.peak_force_kN, 0);
        let of_displacement = compared.iter().map(|c| (c.part, c.error_of_displacement()));
        let mut of_displacement: BTreeMap<Part, f64> = of_displacement.collect();
        of_displacement.insert(Part::FlatPeak, width(run, peak.error));
        estimate.displacement_at_peak_mm = Some(Estimated::new(
            figures.displacement_at_peak_mm,
            of_displacement,
        ));
        estimate.peak_force_kN = Some(peak);
        estimate.area_J = Some(with_scatter(figures.area_J, 1));
        estimate
    }

    /// Lines for people: figures with the digits that their errors support, then each part that a companion should
    /// have shown and did not.
    pub fn lines(&self) -> Vec<String> {
        let lacks = |n: &&NotEstimated| n.part != Part::Penalty;
        let lacking: Vec<&NotEstimated> = self.not_estimated.iter().filter(lacks).collect();
        let names: Vec<&str> = lacking.iter().map(|n| n.part.name()).collect();
        let mut lines = Vec::new();
        if let (Some(peak), Some(moved)) = (&self.peak_force_kN, &self.displacement_at_peak_mm) {
            let word = if self.passes_peak { "peak" } else { "largest" };
            lines.push(format!(
                "{word} {} at {}",
                peak.line("kN", &names),
                moved.short("mm")
            ));
        }
        if let Some(area) = &self.area_J {
            lines.push(format!("area {} to the end", area.line("J", &names)));
        }
        let missing = lacking
            .iter()
            .map(|n| format!("error by {} not estimated: {}", n.part.name(), n.why));
        lines.extend(missing);
        lines
    }
}

#[cfg(test)]
mod tests;
