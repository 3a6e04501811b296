//! Steps of the loading: drives, gravity, motion of the ground, increments, procedures and tolerances.

use super::amplitude::{Amplitude, Branch};
use super::axis::{along_axis, component_along};
use super::ties::TieStage;

/// Motion of a beam in one direction during a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamMotion {
    /// Fixed where it was at the start of the step.
    Locked,
    /// Free under a force that changes linearly from its value in the last step to this one [N].
    Force(f64),
    /// Driven linearly by this displacement during the step [mm].
    Driven(f64),
}

impl BeamMotion {
    /// Locks a beam that was driven in place.
    pub(crate) fn lock(&mut self) {
        if matches!(self, Self::Driven(_)) {
            *self = Self::Locked;
        }
    }
}

/// A beam, and the direction along which the history shows its displacement and force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven {
    /// Index of the beam.
    pub beam: usize,
    /// Direction, of length 1. `[xyz]`
    pub direction: [f64; 3],
}

impl Driven {
    /// A beam along an axis, 0 to 2.
    pub fn along(beam: usize, axis: usize) -> Self {
        Self {
            beam,
            direction: along_axis(axis),
        }
    }

    /// Component of a vector along the direction.
    pub fn component(&self, of: impl Fn(usize) -> f64) -> f64 {
        component_along(self.direction, of)
    }

    /// Displacement that a step drives along the direction [mm]; none if it does not drive the beam.
    pub fn way(&self, step: &Step) -> Option<f64> {
        let motion = step.motion.get(self.beam)?;
        let by = |axis: usize| match motion[axis] {
            BeamMotion::Driven(by) => by,
            BeamMotion::Locked | BeamMotion::Force(_) => 0.0,
        };
        let drives = |axis: usize| {
            self.direction[axis] != 0.0 && matches!(motion[axis], BeamMotion::Driven(_))
        };
        (0..3).any(drives).then(|| self.component(by))
    }
}

/// The end of a spring that a step drives, and the direction along which it does, of length 1.
#[derive(Clone, Copy)]
pub(crate) struct DrivenEnd {
    /// Index of the spring.
    pub(crate) spring: usize,
    /// Direction, of length 1. `[xyz]`
    pub(crate) direction: [f64; 3],
}

impl DrivenEnd {
    /// The first end that a step drives.
    pub(crate) fn of(step: &Step) -> Option<Self> {
        let mut ends = step.springs.iter().enumerate();
        let (spring, by) = ends.find(|(_, by)| **by != [0.0; 3])?;
        let axes: Vec<usize> = (0..3).filter(|axis| by[*axis] != 0.0).collect();
        let length = by.iter().map(|by| by * by).sum::<f64>().sqrt() * by[axes[0]].signum();
        let direction = if let [axis] = axes[..] {
            along_axis(axis)
        } else {
            by.map(|by| by / length)
        };
        Some(Self { spring, direction })
    }

    /// Component of a vector along the direction.
    pub(crate) fn component(self, of: [f64; 3]) -> f64 {
        component_along(self.direction, |axis| of[axis])
    }
}

/// One step of the loading.
#[derive(Clone, Debug)]
// More than 15 fields: one for each setting of a step.
pub struct Step {
    /// Name in the deck.
    pub name: String,
    /// Duration in step time [s]. The viscosity of materials refers to it.
    pub duration: f64,
    /// Motion of each beam in x, y, z. `[beam][direction]`
    pub motion: Vec<[BeamMotion; 3]>,
    /// Beam and direction of the force and displacement in the history.
    pub driven: Option<Driven>,
    /// Sizes of the increments.
    pub increments: Increments,
    /// Viscosity of all damage-plastic solids in this step, if it exceeds their own [s].
    pub viscosity: f64,
    /// Procedure of this step.
    pub procedure: Procedure,
    /// Tangents of this step.
    pub tangent: Tangent,
    /// Displacement that controls the load in [`Procedure::DisplacementControl`].
    pub control: Option<Control>,
    /// Conditions that end the step early, if any.
    pub stop: Option<Stop>,
    /// Convergence criteria of an increment.
    pub tolerance: Tolerance,
    /// Acceleration of gravity during the step.
    pub gravity: Gravity,
    /// Acceleration of the ground. All displacements are relative to the ground.
    pub ground: GroundMotion,
    /// Movement of the driven end of each spring during the step, linear in time [mm]. Empty: none. `[spring][xyz]`
    pub springs: Vec<[f64; 3]>,
    /// What the step does with each tie. Empty: all carry their law. `[tie]`
    pub ties: Vec<TieStage>,
    /// Value of each load at the end of the step, or none for loads that stay constant. Empty: all stay constant.
    /// `[load]`
    pub loads: Vec<Option<[f64; 3]>>,
    /// Amplitude of drives and loads. None: linear in time.
    pub amplitude: Option<Amplitude>,
}

/// A step of 1 s in which nothing moves, by the defaults of a deck.
impl Default for Step {
    fn default() -> Self {
        Self {
            name: "step".to_owned(),
            duration: 1.0,
            motion: Vec::new(),
            driven: None,
            increments: Increments::default(),
            viscosity: 0.0,
            procedure: Procedure::Auto,
            tangent: Tangent::Secant,
            control: None,
            stop: None,
            tolerance: Tolerance::default(),
            gravity: Gravity::None,
            ground: GroundMotion::default(),
            springs: Vec::new(),
            ties: Vec::new(),
            loads: Vec::new(),
            amplitude: None,
        }
    }
}

impl Step {
    /// Whether it moves a beam or the end of a spring.
    pub fn drives(&self) -> bool {
        let driven = |motion: &BeamMotion| matches!(motion, BeamMotion::Driven(_));
        let mut springs = self.springs.iter().flatten();
        self.motion.iter().flatten().any(driven) || springs.any(|by| *by != 0.0)
    }

    /// Whether it prescribes a displacement: that of a drive, or one that steers the load.
    pub fn prescribes(&self) -> bool {
        self.drives() || self.control.is_some()
    }

    /// Whether the step changes loads or the direction of gravity, and drives nothing.
    pub fn only_loads(&self) -> bool {
        let turns = matches!(self.gravity, Gravity::Turning { .. });
        let loads = turns || self.loads.iter().any(Option::is_some);
        loads && !self.drives() && self.control.is_none()
    }

    /// Number of branches of the amplitude.
    pub fn branches(&self) -> usize {
        self.amplitude.as_ref().map_or(1, Amplitude::branches)
    }

    /// Branch `i` of the amplitude.
    pub fn branch(&self, i: usize) -> Branch {
        let branch = |amplitude: &Amplitude| amplitude.branch(i);
        self.amplitude.as_ref().map_or(Branch::WHOLE, branch)
    }

    /// Fastest change of drives and loads, over that of a step without an amplitude.
    pub fn steepest(&self) -> f64 {
        self.amplitude.as_ref().map_or(1.0, Amplitude::steepest)
    }

    /// Whether the drive or a load reverses.
    pub fn turns(&self) -> bool {
        self.amplitude.as_ref().is_some_and(|a| !a.rises())
    }
}

/// Acceleration of gravity during a step [mm/s²].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Gravity {
    /// None.
    #[default]
    None,
    /// Constant during the step.
    Constant([f64; 3]),
    /// Linear from zero to this value.
    Growing([f64; 3]),
    /// Rotating evenly about an axis, as seen from a tilting table.
    Turning {
        /// Acceleration when the step begins [mm/s²].
        from: [f64; 3],
        /// Unit vector of the right-handed rotation.
        axis: [f64; 3],
        /// Angle over the whole step [rad].
        angle: f64,
    },
}

impl Gravity {
    /// Acceleration at a fraction 0 to 1 of the step [mm/s²].
    pub fn at(&self, fraction: f64) -> [f64; 3] {
        match self {
            Self::None => [0.0; 3],
            Self::Constant(g) => *g,
            Self::Growing(g) => g.map(|g| fraction * g),
            Self::Turning { from, axis, angle } => turned(*from, *axis, fraction * angle),
        }
    }
}

/// Rayleigh damping C = a M + b K₀ (Rayleigh 1877, §102), with the damping ratio a/(2ω) + bω/2 at ω. K₀ is the
/// elastic stiffness of the solids in their rotating frames. Joints have no damping.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rayleigh {
    /// a [1/s].
    pub mass: f64,
    /// b [s].
    pub stiffness: f64,
}

impl Rayleigh {
    /// Damping with this ratio [-] at two frequencies [Hz]: a = 2ζ ω₁ω₂/(ω₁+ω₂), b = 2ζ/(ω₁+ω₂)
    /// (docs/theory/inertia.md, eq. 13). Between them the ratio is smaller, outside larger.
    pub fn at(ratio: f64, frequencies: [f64; 2]) -> Self {
        let [first, second] = frequencies.map(|f| std::f64::consts::TAU * f);
        let stiffness = 2.0 * ratio / (first + second);
        Self {
            mass: stiffness * first * second,
            stiffness,
        }
    }

    /// Damping ratio at a frequency [Hz].
    pub fn ratio(self, frequency: f64) -> f64 {
        let omega = std::f64::consts::TAU * frequency;
        0.5 * (self.mass / omega + self.stiffness * omega)
    }
}

/// Acceleration of the ground over the time since the step began. It is linear between its rows and zero outside
/// them.
///
/// Displacements and velocities are relative to the ground, so the force −m a acts on every mass beside gravity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroundMotion {
    /// Rows of time [s], ascending, and acceleration [mm/s²]. Empty: none. `[xyz][row]`
    pub acceleration: [Vec<[f64; 2]>; 3],
}

/// Part by which intervals of an even record may differ.
const EVEN: f64 = 0.1;

impl GroundMotion {
    /// Smallest interval between two rows of a record [s]. Infinite without records.
    pub fn spacing(&self) -> f64 {
        let records = self.acceleration.iter().filter(|rows| rows.len() > 1);
        let spacing = |rows: &Vec<[f64; 2]>| {
            let mean = (rows[rows.len() - 1][0] - rows[0][0]) / (rows.len() - 1) as f64;
            let intervals = rows.windows(2).map(|pair| pair[1][0] - pair[0][0]);
            let least = intervals.filter(|dt| *dt > 0.0).fold(mean, f64::min);
            // Times of an even record are rounded.
            if least > (1.0 - EVEN) * mean {
                mean
            } else {
                least
            }
        };
        records.map(spacing).fold(f64::INFINITY, f64::min)
    }

    /// Acceleration at a time since the step began [mm/s²].
    pub fn at(&self, time: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| interpolate(&self.acceleration[i], time))
    }
}

/// Linear interpolation between the rows, zero outside them.
fn interpolate(rows: &[[f64; 2]], time: f64) -> f64 {
    let after = rows.partition_point(|row| row[0] < time);
    match rows.get(after) {
        Some(&[t, a]) if t == time => a,
        Some(&[t, a]) if after > 0 => {
            let [from, start] = rows[after - 1];
            start + (a - start) * (time - from) / (t - from)
        }
        _ => 0.0,
    }
}

/// Vector v rotated about a unit vector a by φ [rad] (Rodrigues): v cos φ + a × v sin φ + a (a·v)(1 − cos φ).
pub(crate) fn turned(v: [f64; 3], a: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let along = (0..3).map(|i| a[i] * v[i]).sum::<f64>() * (1.0 - cos);
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let cross = a[j] * v[k] - a[k] * v[j];
        v[i] * cos + cross * sin + a[i] * along
    })
}

/// Sizes of increments, as parts of the duration of the step.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Increments {
    /// First.
    pub initial: f64,
    /// Largest.
    pub max: f64,
    /// Smallest. A smaller size ends the run.
    pub min: f64,
    /// Part of the largest force that may remain undetected between two increments at a peak, where a displacement is
    /// driven or controls the load.
    pub peak: f64,
}

/// Those of a step that drives a displacement.
impl Default for Increments {
    fn default() -> Self {
        Self {
            initial: 0.005,
            max: 0.0125,
            min: 1e-6,
            peak: 0.005,
        }
    }
}

/// Procedure of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Procedure {
    /// [`Self::Static`] while it finds equilibrium, otherwise the next procedure of the fallback until statics works
    /// again.
    #[default]
    Auto,
    /// Newton's method for equilibrium at prescribed loads.
    Static,
    /// Static, with viscous strain and damage of the solids extrapolated within the increment and updated at its end.
    Implex,
    /// Inertia carries the system over instabilities, and backward Euler damps its motion. The duration is real time.
    QuasiStatic,
    /// HHT-α (Hilber, Hughes, Taylor 1977) with Rayleigh damping. The duration is real time.
    Dynamic {
        /// α in [−1/3, 0]: 0 conserves the energy, −1/3 damps most of the motion that increments do not resolve.
        alpha: f64,
        /// Rayleigh damping.
        damping: Rayleigh,
    },
    /// Equilibrium at prescribed distances along the path (Crisfield 1981). The load is an unknown.
    ArcLength,
    /// Equilibrium at prescribed amounts of dissipated energy (Gutiérrez 2004). The load is an unknown.
    Dissipation,
    /// Equilibrium at prescribed displacements of [`Step::control`]. The load is an unknown.
    DisplacementControl,
}

impl Procedure {
    /// Whether inertia acts in all increments.
    pub fn has_inertia(self) -> bool {
        matches!(self, Self::QuasiStatic | Self::Dynamic { .. })
    }

    /// Whether the step seeks equilibria, and inertia acts only where there is none.
    pub fn seeks_equilibrium(self) -> bool {
        matches!(self, Self::Auto | Self::DisplacementControl)
    }

    /// Whether inertia may act: in all increments, or where the fallback uses it.
    pub fn may_move(self) -> bool {
        self.has_inertia() || self.seeks_equilibrium()
    }
}

/// Which tangents the iterations take, and with them how the laws enter.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    serde::Deserialize,
    serde::Serialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Tangent {
    /// Secant stiffness of the solids, shifted penalty: symmetric and positive definite.
    #[default]
    Secant,
    /// Consistent tangent of the solids, shifted penalty.
    Consistent,
    /// Consistent tangents of solids and interfaces, the penalty taken directly: plain Newton on the
    /// law itself.
    Direct,
}

/// A displacement that controls the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Index of the probe that measures it.
    pub probe: usize,
    /// Its change during the step [mm].
    pub displacement: f64,
}

/// Conditions that end a driven step early. The increment that meets one is the last.
///
/// A checkpoint stores them: raise `VERSION` in `results/checkpoint.rs` when a field is added, removed or moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Stop {
    /// Part of the largest force of this step to which the force falls, both along the drive [-].
    pub below_peak: Option<f64>,
    /// Displacement of the drive [mm].
    pub displacement: Option<f64>,
}

/// Convergence tolerances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Largest out-of-balance force over the mean nodal force [-].
    pub residual: f64,
    /// Newton iterations before the increment is cut.
    pub max_iterations: usize,
}

/// Those of secant tangents (theory/equilibrium.md, Decisions).
impl Default for Tolerance {
    fn default() -> Self {
        Self {
            residual: 5e-2,
            max_iterations: 25,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_as_fine_as_its_shortest_interval() {
        let record = |times: &[f64]| GroundMotion {
            acceleration: [
                times.iter().map(|t| [*t, 1.0]).collect(),
                Vec::new(),
                Vec::new(),
            ],
        };
        assert_eq!(record(&[0.0, 0.5, 0.501, 2.0]).spacing(), 0.501 - 0.5);
        // Rounded times of an even record.
        assert_eq!(record(&[0.0, 0.0033, 0.0067, 0.01]).spacing(), 0.01 / 3.0);
        assert_eq!(GroundMotion::default().spacing(), f64::INFINITY);
    }
}
