//! `[[steps]]`: loads and drives of a scene, in order.

use super::loads::{DeckAmplitude, DeckCycles, DeckLoad};
use super::procedure::{
    DeckControl, DeckGround, DeckGroundFactor, DeckProcedure, DeckRayleigh, DeckStop,
};
use super::{Heading, Names};
use crate::deck::quantity::{Acceleration, Angle, Length, Number, Pressure, Time};
use crate::model::axis::Axis;
use crate::model::scene::{Increments, Tangent, Tolerance};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// A step. Keys that belong to another kind of step are rejected by the check.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
// More than 15 fields: one for each key of the table.
pub struct DeckStep {
    /// Name; the kind if absent.
    pub name: Option<String>,
    /// Kind of the step.
    pub kind: StepKind,
    /// Preload: pressure on the top [MPa], compression positive.
    pub top_pressure: Option<Pressure>,
    /// Drive: direction of the top beam.
    pub direction: Option<Heading>,
    /// Drive: displacement of the top beam in this step [mm].
    pub displacement: Option<Length>,
    /// Drive in x or y: vertical motion of the beam; locked if absent.
    pub vertical: Option<Vertical>,
    /// Preload, drive of blocks: faces that move as one.
    pub face: Option<Names>,
    /// Drive: amplitudes in both directions, instead of `displacement`.
    pub cycles: Option<DeckCycles>,
    /// Preload of blocks: pressure on the face [MPa], compression positive.
    pub pressure: Option<Pressure>,
    /// Preload, drive of blocks: directions in which the face moves freely under its load.
    pub free: Option<Vec<Axis>>,
    /// Drive of blocks: the spring whose far end moves, instead of a face.
    pub spring: Option<String>,
    /// Drive: the ground of `[[settlements]]` that moves.
    pub settlement: Option<String>,
    /// Preload, drive: the beam of `[[beams]]` that is pressed or driven.
    pub beam: Option<String>,
    /// Gravity, free: acceleration of gravity [mm/s²].
    pub gravity: Option<Acceleration>,
    /// Gravity, free: inclination of the ground [deg]. Tilt: inclination at the end of the step [deg].
    pub angle: Option<Angle>,
    /// Gravity, tilt, free: horizontal axis about which the ground is turned, right-handed.
    pub axis: Option<Direction>,
    /// Named loads.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<DeckLoad>,
    /// Factor of the drive and the loads over the fraction of the step's duration; linear from 0 to 1 if absent.
    pub amplitude: Option<DeckAmplitude>,
    /// Duration [s]; viscosity is measured in this time.
    #[serde(default = "one_second")]
    pub duration: Time,
    /// Viscosity of all solids with tables in this step [s], where it is larger than their own.
    #[serde(default = "no_time")]
    pub viscosity: Time,
    /// Procedure.
    #[serde(default)]
    pub procedure: DeckProcedure,
    /// Displacement control: the displacement that controls the load.
    pub control: Option<DeckControl>,
    /// Drive, load: conditions that end the step before its full displacement or load.
    pub stop: Option<DeckStop>,
    /// Tangents.
    #[serde(default)]
    pub tangent: Tangent,
    /// Dynamic: α of HHT-α, from −1/3 to 0.
    pub alpha: Option<Number>,
    /// Dynamic: Rayleigh damping.
    pub rayleigh: Option<DeckRayleigh>,
    /// Dynamic: records of ground acceleration.
    pub ground: Option<DeckGround>,
    /// Unit of the accelerations in these records [mm/s²]; 1 mm/s² if absent.
    pub ground_unit: Option<Acceleration>,
    /// Factors of these records in each direction; 1 if absent.
    pub ground_factor: Option<DeckGroundFactor>,
    /// Time in the records at which the step begins [s]; 0 if absent.
    pub ground_start: Option<Time>,
    /// Sizes of increments as fractions of the step.
    #[serde(default)]
    pub increments: DeckIncrements,
    /// Criteria of convergence.
    #[serde(default)]
    pub tolerance: DeckTolerance,
}

/// Kind of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StepKind {
    /// Presses the top, which may move vertically only.
    Preload,
    /// Drives the top beam, a face of a block, or the far end of a spring.
    Drive,
    /// Applies gravity.
    Gravity,
    /// Tilts the ground: gravity turns.
    Tilt,
    /// Changes nothing but time: for motion under inertia.
    Free,
    /// Changes named loads only.
    Load,
}

impl StepKind {
    /// Name in the deck.
    pub fn name(self) -> &'static str {
        match self {
            Self::Preload => "preload",
            Self::Drive => "drive",
            Self::Gravity => "gravity",
            Self::Tilt => "tilt",
            Self::Free => "free",
            Self::Load => "load",
        }
    }
}

/// A direction of the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Direction {
    /// Along the wall.
    #[serde(rename = "x")]
    X,
    /// Through the wall.
    #[serde(rename = "y")]
    Y,
    /// Upwards.
    #[serde(rename = "z")]
    Z,
    /// Along the wall, backwards.
    #[serde(rename = "-x")]
    MinusX,
    /// Through the wall, backwards.
    #[serde(rename = "-y")]
    MinusY,
    /// Downwards.
    #[serde(rename = "-z")]
    MinusZ,
}

impl Direction {
    /// Index of the axis, and sign along it.
    pub fn axis(self) -> (usize, f64) {
        match self {
            Self::X => (0, 1.0),
            Self::Y => (1, 1.0),
            Self::Z => (2, 1.0),
            Self::MinusX => (0, -1.0),
            Self::MinusY => (1, -1.0),
            Self::MinusZ => (2, -1.0),
        }
    }
}

/// Vertical motion of the level beam while it is driven sideways.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Vertical {
    /// Held in the position after the preload, as in the tests of the paper.
    #[default]
    Locked,
    /// Free under the load of the preload.
    Free,
}

/// `increments`; defaults depend on the kind of the step.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckIncrements {
    /// First increment.
    pub initial: Option<Number>,
    /// Largest increment.
    pub max: Option<Number>,
    /// Smallest increment.
    pub min: Option<Number>,
    /// Fraction of the largest force that may be missed at a peak between two increments; increments are shortened
    /// there. 1: no peak control.
    pub peak: Option<Number>,
}

/// `tolerance`.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckTolerance {
    /// Largest out-of-balance force over the mean nodal force [-]; the default depends on the procedure.
    pub residual: Option<Number>,
    /// Number of iterations after which the increment is rejected.
    pub max_iterations: usize,
}

impl Default for DeckTolerance {
    fn default() -> Self {
        Self {
            residual: None,
            max_iterations: Tolerance::default().max_iterations,
        }
    }
}

fn one_second() -> Time {
    Time::new(1.0)
}

fn no_time() -> Time {
    Time::new(0.0)
}

/// Largest default of the smallest increment [s]: units vibrate on their joints within a millisecond or less, and
/// inertia stabilises only in increments shorter than that.
const LEAST_INCREMENT: f64 = 1e-4;

impl DeckStep {
    /// Sizes of increments, with the defaults of this kind of step.
    ///
    /// A drive takes 80 increments or more: plasticity is extrapolated within each, and the area below the curve
    /// has an error of 1.6 % at 1/80 of the paper's 4 mm. Preloads and gravity are nearly elastic. Tilts and free
    /// motion have a hundred increments, for output. Loads may break bodies; under displacement control their
    /// increments are those of a drive.
    pub fn increments(&self) -> Increments {
        self.increments_of(1.0, f64::INFINITY)
    }

    /// Sizes of increments where an amplitude changes at most `steepest` times as fast as the step would without
    /// it. Default sizes are divided by this factor. They are at most `finest`, the spacing of the ground record as
    /// a fraction of the step.
    pub fn increments_of(&self, steepest: f64, finest: f64) -> Increments {
        let steered = self.procedure == DeckProcedure::DisplacementControl;
        let driven = Increments::default();
        let [initial, max, min] = match self.kind {
            StepKind::Preload | StepKind::Gravity => [0.25, 0.5, 1e-4],
            StepKind::Load if !steered => [0.05, 0.1, 1e-6],
            StepKind::Drive | StepKind::Load => [driven.initial, driven.max, driven.min],
            StepKind::Tilt | StepKind::Free => [0.01, 0.01, 1e-6],
        };
        // Inertia must stabilise detached bodies in long steps, too.
        let min = f64::min(min, LEAST_INCREMENT / self.duration.get());
        let faster = steepest.max(1.0);
        let (initial, max) = (initial / faster, (max / faster).min(finest));
        let first = self.increments.initial.map(Number::get);
        // A default never contradicts a given value: the first increment is at most the largest.
        let max = match (self.increments.max, first) {
            (Some(max), _) => max.get(),
            (None, Some(first)) if steepest > 1.0 || finest < 1.0 => max.max(first),
            (None, _) => max,
        };
        let initial = first.unwrap_or(initial.min(max));
        let min = self.increments.min.map_or(min.min(initial), Number::get);
        // Records and amplitudes may make the first increment smaller than the smallest one of the deck.
        let min = if steepest > 1.0 || finest < 1.0 {
            min.min(initial)
        } else {
            min
        };
        let peak = self.increments.peak.map_or(driven.peak, Number::get);
        Increments {
            initial,
            max,
            min,
            peak,
        }
    }

    /// Returns whether the step has peak control, which shortens increments at a peak of the force.
    pub fn sees_peaks(&self) -> bool {
        use DeckProcedure::{ArcLength, Dissipation, Dynamic, QuasiStatic};
        let driven = self.kind == StepKind::Drive || self.control.is_some();
        driven
            && !matches!(
                self.procedure,
                QuasiStatic | Dynamic | ArcLength | Dissipation
            )
    }

    /// Tolerance of the residual: 5e-3 of the mean nodal force with consistent tangents (theory/equilibrium.md, eq.
    /// 16); larger ones, measured to be as accurate, with secant tangents (theory/equilibrium.md, Decisions).
    pub fn tolerance(&self) -> Tolerance {
        let default = match (self.tangent, self.procedure) {
            (Tangent::Secant, DeckProcedure::Implex) => 2e-2,
            (Tangent::Secant, _) => Tolerance::default().residual,
            _ => 5e-3,
        };
        Tolerance {
            residual: self.tolerance.residual.map_or(default, Number::get),
            max_iterations: self.tolerance.max_iterations,
        }
    }

    /// Name of the step; its kind if it has none.
    pub fn name(&self) -> &str {
        match &self.name {
            Some(name) => name,
            None => self.kind.name(),
        }
    }
}
