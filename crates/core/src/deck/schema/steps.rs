//! `[[steps]]`: what is done to the wall, in order.

use super::Names;
use super::loads::{DeckAmplitude, DeckCycles, DeckLoad};
use super::procedure::{
    DeckControl, DeckGround, DeckGroundFactor, DeckProcedure, DeckRayleigh, DeckStop,
};
use crate::deck::quantity::{Acceleration, Angle, Length, Number, Pressure, Time};
use crate::model::axis::Axis;
use crate::model::scene::{Increments, Tangent, Tolerance};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A step as written. Keys that belong to the other kind are refused when the deck is checked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckStep {
    /// Name; the kind if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// What the step does.
    pub kind: StepKind,
    /// Preload: pressure on the top [MPa], compression positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub top_pressure: Option<Pressure>,
    /// Drive: direction of the top beam.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<Direction>,
    /// Drive: displacement of the top beam in this step [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Length>,
    /// Drive in x or y: what the beam does vertically meanwhile; locked if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub vertical: Option<Vertical>,
    /// Preload, drive of blocks: the faces that move as one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub face: Option<Names>,
    /// Drive: how far forth and back, instead of `displacement`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cycles: Option<DeckCycles>,
    /// Preload of blocks: pressure on the face [MPa], compression positive.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pressure: Option<Pressure>,
    /// Preload, drive of blocks: directions in which the face is free under what it carries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free: Option<Vec<Axis>>,
    /// Drive of blocks: the spring whose far end moves, instead of a face.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spring: Option<String>,
    /// Preload, drive: the beam of `[[beams]]` that is pressed or driven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beam: Option<String>,
    /// Gravity, free: acceleration of gravity [mm/s²].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Acceleration>,
    /// Gravity, free: inclination of the ground. Tilt: that at its end [deg].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angle: Option<Angle>,
    /// Gravity, tilt, free: horizontal axis about which the ground is turned, right-handed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<Direction>,
    /// Loads with a name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<DeckLoad>,
    /// Part of what the step drives and loads over the parts of its time; evenly if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub amplitude: Option<DeckAmplitude>,
    /// Duration [s]; viscosity is measured in it.
    #[serde(default = "one_second")]
    pub duration: Time,
    /// Viscosity of all solids with tables in this step, where it is above their own [s].
    #[serde(default = "no_time")]
    pub viscosity: Time,
    /// Procedure.
    #[serde(default)]
    pub procedure: DeckProcedure,
    /// Displacement control: the displacement that steers the load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control: Option<DeckControl>,
    /// Drive: what ends the step before its displacement is whole.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop: Option<DeckStop>,
    /// Tangents.
    #[serde(default)]
    pub tangent: Tangent,
    /// Dynamic: α of HHT-α, from −1/3 to 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<Number>,
    /// Dynamic: Rayleigh damping.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rayleigh: Option<DeckRayleigh>,
    /// Dynamic: records of the ground's acceleration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground: Option<DeckGround>,
    /// What 1 in these records means [mm/s²]; 1 mm/s² if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_unit: Option<Acceleration>,
    /// By what they are multiplied, direction by direction; 1 if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_factor: Option<DeckGroundFactor>,
    /// Where in the records the step begins [s]; at their time 0 if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_start: Option<Time>,
    /// Sizes of increments as fractions of the step.
    #[serde(default)]
    pub increments: DeckIncrements,
    /// When an increment counts as converged.
    #[serde(default)]
    pub tolerance: DeckTolerance,
}

/// What a step does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum StepKind {
    /// Presses the top, free to move vertically and nowhere else.
    Preload,
    /// Drives the top beam, a face of a block, or the far end of a spring.
    Drive,
    /// Gravity grows from nothing.
    Gravity,
    /// The ground is tilted: gravity turns.
    Tilt,
    /// Nothing changes but time: for motion under inertia.
    Free,
    /// Nothing changes but the loads with a name.
    Load,
}

impl StepKind {
    /// As the deck spells it.
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
    /// Index of the axis and sign along it.
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

/// What the level beam does vertically while it is driven sideways.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Vertical {
    /// Held where the preload left it, as in the tests of the paper.
    #[default]
    Locked,
    /// Free under the load of the preload.
    Free,
}

/// `increments`; what is not said depends on the kind of the step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckIncrements {
    /// First.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial: Option<Number>,
    /// Largest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<Number>,
    /// Smallest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<Number>,
    /// Part of the largest force that may lie unseen between two increments at a peak, which are shortened there; 1 leaves them as they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak: Option<Number>,
}

/// `tolerance`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckTolerance {
    /// Largest out-of-balance force over the mean nodal force [-]; by default that of the procedure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual: Option<Number>,
    /// Iterations before the increment is cut.
    pub max_iterations: usize,
}

impl Default for DeckTolerance {
    fn default() -> Self {
        Self {
            residual: None,
            max_iterations: 25,
        }
    }
}

fn one_second() -> Time {
    Time::new(1.0)
}

fn no_time() -> Time {
    Time::new(0.0)
}

/// Bodies of masonry vibrate on their joints within a millisecond or less; inertia holds only in increments shorter than that [s].
const LEAST_INCREMENT: f64 = 1e-4;

/// Part of the largest force that may lie unseen between two increments at a peak: well within the 1 % that a mesh
/// leaves open, and nothing that increments of 1/80 of the paper's 4 mm do not see anyway.
const PEAK: f64 = 0.005;

impl DeckStep {
    /// Sizes of increments with the defaults of this kind of step.
    ///
    /// A drive takes 80 increments or more: plasticity is extrapolated within each, and the area
    /// below the curve errs by 1.6 % at 1/80 of the paper's 4 mm. A preload is nearly elastic, and so
    /// is gravity; what tilts or moves freely is to be seen in a hundred pictures. Loads may break what
    /// they act on; where a displacement steers them they go on as a drive does.
    pub fn increments(&self) -> Increments {
        self.increments_of(1.0, f64::INFINITY)
    }

    /// The same where an amplitude moves up to so many times as fast as the step would without: what
    /// the deck does not say goes as far in an increment as ever. Nor is it larger than `finest`, the part of the
    /// step from row to row of the ground's records.
    pub fn increments_of(&self, steepest: f64, finest: f64) -> Increments {
        let steered = self.procedure == DeckProcedure::DisplacementControl;
        let [initial, max, min] = match self.kind {
            StepKind::Preload | StepKind::Gravity => [0.25, 0.5, 1e-4],
            StepKind::Load if !steered => [0.05, 0.1, 1e-6],
            StepKind::Drive | StepKind::Load => [0.005, 0.0125, 1e-6],
            StepKind::Tilt | StepKind::Free => [0.01, 0.01, 1e-6],
        };
        // What comes loose is held by inertia, in long steps, too.
        let min = f64::min(min, LEAST_INCREMENT / self.duration.get());
        let faster = steepest.max(1.0);
        let (initial, max) = (initial / faster, (max / faster).min(finest));
        let first = self.increments.initial.map(Number::get);
        // A default yields to what is said: never a first increment above the largest.
        let max = match (self.increments.max, first) {
            (Some(max), _) => max.get(),
            (None, Some(first)) if steepest > 1.0 || finest < 1.0 => max.max(first),
            (None, _) => max,
        };
        let initial = first.unwrap_or(initial.min(max));
        let min = self.increments.min.map_or(min.min(initial), Number::get);
        // Records and amplitudes may make the first one shorter than what the deck says of the smallest.
        let min = if steepest > 1.0 || finest < 1.0 {
            min.min(initial)
        } else {
            min
        };
        let peak = self.increments.peak.map_or(PEAK, Number::get);
        Increments {
            initial,
            max,
            min,
            peak,
        }
    }

    /// Whether increments are shortened at a peak of its force.
    pub fn sees_peaks(&self) -> bool {
        use DeckProcedure::{ArcLength, Dissipation, Dynamic, QuasiStatic};
        let driven = self.kind == StepKind::Drive || self.control.is_some();
        driven
            && !matches!(
                self.procedure,
                QuasiStatic | Dynamic | ArcLength | Dissipation
            )
    }

    /// Tolerance of the model: 5e-3 of the mean nodal force (theory/equilibrium.md, eq. 16) with consistent tangents; with
    /// the cheaper ones what measures as accurate (docs/decisions/convergence-criteria.md).
    pub fn tolerance(&self) -> Tolerance {
        let default = match (self.tangent, self.procedure) {
            (Tangent::Secant, DeckProcedure::Implex) => 2e-2,
            (Tangent::Secant, _) => 5e-2,
            _ => 5e-3,
        };
        Tolerance {
            residual: self.tolerance.residual.map_or(default, Number::get),
            max_iterations: self.tolerance.max_iterations,
        }
    }

    /// Name, or the kind where none is given.
    pub fn name(&self) -> &str {
        match &self.name {
            Some(name) => name,
            None => self.kind.name(),
        }
    }
}
