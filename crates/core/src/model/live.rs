//! The drive or the load whose force and displacement are the curve of a run.

use super::Model;
use super::scene::{Procedure, Step};
use super::steps::DrivenEnd;

/// A drive: a beam or the end of a spring, and the direction of its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drive {
    spring: bool,
    index: usize,
    direction: [f64; 3],
}

impl Drive {
    /// The drive of a step: its beam, if it moves it, else the first spring whose end it moves.
    fn of(step: &Step) -> Option<Self> {
        let beam = step.driven.filter(|driven| driven.way(step).is_some());
        if let Some(driven) = beam {
            return Some(Self {
                spring: false,
                index: driven.beam,
                direction: driven.direction,
            });
        }
        DrivenEnd::of(step).map(|end| Self {
            spring: true,
            index: end.spring,
            direction: end.direction,
        })
    }

    /// The direction with the sense in which a step moves it.
    fn sense_of(self, step: &Step) -> [f64; 3] {
        let way = if self.spring {
            let by = step.springs.get(self.index).copied().unwrap_or_default();
            (0..3).map(|i| self.direction[i] * by[i]).sum::<f64>()
        } else {
            step.driven
                .and_then(|driven| driven.way(step))
                .unwrap_or(1.0)
        };
        self.direction.map(|part| part * way.signum())
    }

    /// Whether another drive moves the same along the same line.
    fn is_like(self, other: Self) -> bool {
        let along = (0..3).map(|i| self.direction[i] * other.direction[i]);
        let along = along.sum::<f64>().abs();
        (self.spring, self.index) == (other.spring, other.index) && along > PARALLEL
    }
}

/// Cosine above which two directions are parallel.
const PARALLEL: f64 = 0.999_999;

/// Part of a step in the curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartInCurve {
    /// Its increments are points of the curve.
    Points,
    /// The curve begins at its last increment, if no points come before it.
    Start,
    /// Its increments show another drive.
    Other,
}

impl Model {
    /// Index of the load whose curve a run shows: the first one that is changed by the last step that steers its loads
    /// (`displacement_control`, a path), or by the last step with loads if none steers.
    pub fn live_load(&self) -> Option<usize> {
        let first = |step: &Step| step.loads.iter().position(Option::is_some);
        let steers = |step: &&Step| {
            let path = matches!(
                step.procedure,
                Procedure::ArcLength | Procedure::Dissipation
            );
            path || step.control.is_some()
        };
        let mut steered = self.steps.iter().rev().filter(steers);
        let mut all = self.steps.iter().rev();
        steered.find_map(first).or_else(|| all.find_map(first))
    }

    /// Part of each step in the curve: that of the last drive, or of the live load in a model that drives nothing.
    /// `[step]`
    pub fn parts_in_curve(&self) -> Vec<PartInCurve> {
        let live = self.live_load();
        let last = self.steps.iter().rev().find_map(Drive::of);
        let any = self.steps.iter().any(Step::drives);
        let other = |step: &Step| match (Drive::of(step), last) {
            (Some(own), Some(last)) => !own.is_like(last),
            // The increments of a preload show the beam that it presses.
            (None, Some(last)) => last.spring && step.driven.is_some(),
            _ => false,
        };
        // Where another drive comes first, the increments before it show that one.
        let rest = if self.steps.iter().any(other) {
            PartInCurve::Other
        } else {
            PartInCurve::Start
        };
        let of = |step: &Step| match (Drive::of(step), last) {
            (Some(own), Some(last)) if own.is_like(last) => PartInCurve::Points,
            (Some(_), Some(_)) => PartInCurve::Other,
            _ if step.drives() => PartInCurve::Points,
            _ if !any
                && live.is_some_and(|live| step.loads.get(live).is_some_and(Option::is_some)) =>
            {
                PartInCurve::Points
            }
            _ => rest,
        };
        self.steps.iter().map(of).collect()
    }

    /// Direction of the drive whose force is the curve, as it moves first, or of the live load in a model that drives
    /// nothing; none if there is neither.
    pub(super) fn direction_of_curve(&self) -> Option<[f64; 3]> {
        match self.steps.iter().rev().find_map(Drive::of) {
            Some(last) => self.steps.iter().find_map(|step| {
                let own = Drive::of(step).filter(|own| own.is_like(last))?;
                Some(own.sense_of(step))
            }),
            None => Some(self.loads.get(self.live_load()?)?.direction),
        }
    }
}
