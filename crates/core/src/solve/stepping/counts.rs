//! Counters of increments that a run reports when it ends.

use serde::{Deserialize, Serialize};

use crate::state::{ForceBy, HistoryRow, Motion};

/// Counts increments with extrapolated solids, in which a unit snapped.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Snaps {
    count: usize,
    step: usize,
    first: f64,
    worst: f64,
    /// Number of increments with a loosened tolerance, and the largest force that they left.
    loosened: (usize, f64),
}

impl Snaps {
    /// Counts a committed increment whose tolerance of a single force was loosened.
    pub fn loosen(&mut self, row: &HistoryRow) {
        self.loosened.0 += 1;
        self.loosened.1 = self.loosened.1.max(row.out_of_balance);
    }

    /// Warning, if the tolerance was loosened.
    pub fn loosened_warning(&self) -> Option<String> {
        let (count, worst) = self.loosened;
        (count > 0).then(|| {
            format!(
                "{count} increments, which would have ended the run, leave up to {worst:.2} of the mean nodal force out of \
                 balance at single nodes; their root mean square and work are within the tolerance"
            )
        })
    }

    /// Counts a committed increment.
    pub fn add(&mut self, row: &HistoryRow) {
        if self.count == 0 {
            (self.step, self.first) = (row.step, row.displacement_mm);
        }
        self.count += 1;
        self.worst = self.worst.max(row.out_of_balance);
    }

    /// Warning, if an increment was counted.
    pub fn warning(&self) -> Option<String> {
        (self.count > 0).then(|| {
            format!(
                "units snap, first in steps.{} at {:.3} mm: {} increments found no equilibrium and \
                 extrapolate the solids; up to {:.2} of the mean nodal force is out of balance there",
                self.step, self.first, self.count, self.worst
            )
        })
    }
}

/// Kinetic energy over the energy taken, above which a motion is not quasi-static.
const QUASI_STATIC: f64 = 0.05;

/// Counts increments in which a quasi-static step was not quasi-static.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct MotionWarnings {
    count: usize,
    step: usize,
    time: f64,
    worst: f64,
    /// Largest error of the time integration within an increment of `dynamic` [mm], its step, and the largest displacement
    /// [mm].
    coarse: (f64, usize, f64),
}

/// Error of the time integration within an increment over the largest displacement, from which it is reported: that of 14
/// increments in a period, whose frequency errs by 1.4 %.
const COARSE: f64 = 0.01;

impl MotionWarnings {
    /// Notes the error of the time integration in an increment of a step [mm], and the largest displacement at its end
    /// [mm].
    pub fn note_time_error(&mut self, step: usize, error: f64, displacement: f64) {
        if error > self.coarse.0 {
            (self.coarse.0, self.coarse.1) = (error, step);
        }
        self.coarse.2 = self.coarse.2.max(displacement);
    }

    /// Warning, if the increments are coarse for the motion.
    pub fn time_warning(&self) -> Option<String> {
        let (error, step, displacement) = self.coarse;
        (error > COARSE * displacement).then(|| {
            format!(
                "the increments are coarse for the motion of steps.{step}: within one of them the time integration errs by up \
                 to {:.1} % of the largest displacement; see whether smaller ones (increments.max) change the results",
                100.0 * error / displacement
            )
        })
    }

    /// Counts a committed increment if it was not quasi-static.
    pub fn add(&mut self, row: &HistoryRow) {
        let ratio = row.kinetic_energy_J / row.taken_J();
        if ratio > QUASI_STATIC {
            self.count += 1;
            if ratio > self.worst {
                (self.step, self.time, self.worst) = (row.step, row.time, ratio);
            }
        }
    }

    /// Warning, if an increment was counted.
    pub fn warning(&self) -> Option<String> {
        // A body that flies free has taken nothing.
        let most = if self.worst.is_finite() {
            format!("most ({:.0} %)", 100.0 * self.worst)
        } else {
            "most".to_owned()
        };
        (self.count > 0).then(|| {
            format!(
                "the kinetic energy of quasi-static steps is above {:.0} % of what the solids and \
                 interfaces have taken in {} increments, {most} in steps.{} at {:.3e} s: a \
                 longer duration moves more slowly",
                100.0 * QUASI_STATIC,
                self.count,
                self.step,
                self.time
            )
        })
    }
}

/// Part of the peak by which a force that inertia carries may exceed it, or that viscosity may carry, unreported [-].
const EXCESS: f64 = 0.02;

/// Force that inertia carries over the peak from which it is an artefact [-].
const RUNS_AWAY: f64 = 100.0;

/// Largest forces of the drive with and without the increments whose force inertia carries.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Carried {
    motion: Motion,
    /// Largest force of increments in equilibrium, in size [kN].
    peak: f64,
    /// Largest force that inertia carries, in size [kN]; its displacement [mm] and step.
    most: f64,
    displacement: f64,
    step: usize,
    /// Part of the largest force in equilibrium that viscosity carries [-], and its step.
    viscous: (f64, usize),
}

impl Carried {
    /// Adds a committed increment; `by`: origin of its force; `viscous`: part of it that viscosity carries. Returns
    /// whether inertia carries its force.
    pub fn add(&mut self, row: &HistoryRow, by: ForceBy, viscous: f64) -> bool {
        let moving = self.motion.follow(row, by);
        let force = row.force_kN.abs();
        if !moving {
            if force > self.peak {
                self.viscous = (viscous, row.step);
            }
            self.peak = self.peak.max(force);
        } else if force > self.most {
            (self.most, self.displacement, self.step) = (force, row.displacement_mm, row.step);
        }
        moving
    }

    /// Warning, if viscosity carries much of the largest force.
    pub fn viscous_warning(&self) -> Option<String> {
        let (part, step) = self.viscous;
        (part > EXCESS).then(|| {
            format!(
                "viscosity carries about {:.0} % of the largest force, in steps.{step}: a smaller `viscosity`, or none, \
                 gives the force of the wall itself",
                100.0 * part.min(1.0)
            )
        })
    }

    /// Whether inertia drove the force beyond all bounds: no fall needs it.
    pub fn runs_away(&self) -> bool {
        self.peak > 0.0 && self.most > RUNS_AWAY * self.peak
    }

    /// Warning, if a force that does not count exceeds the peak. `whole`: force of the scene over that of the part
    /// solved.
    pub fn warning(&self, whole: f64) -> Option<String> {
        (self.most > (1.0 + EXCESS) * self.peak && self.peak > 0.0).then(|| {
            format!(
                "inertia carries forces of up to {:.3} kN, in steps.{} at {:.3} mm, above the largest of {:.3} kN in \
                 equilibrium: they are not counted as a peak. If the wall slides or rocks there for long, smaller \
                 increments (increments.max) tell which force it keeps",
                whole * self.most,
                self.step,
                self.displacement,
                whole * self.peak
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_far_above_the_peak_is_an_artefact() {
        let carried = |most: f64, peak: f64| Carried {
            peak,
            most,
            ..Carried::default()
        };
        assert!(carried(301.0, 3.0).runs_away());
        assert!(!carried(299.0, 3.0).runs_away());
        // Nothing was in equilibrium before.
        assert!(!carried(299.0, 0.0).runs_away());
    }
}
