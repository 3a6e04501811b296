//! Early end of a step by its `stop` table.

use serde::{Deserialize, Serialize};

use super::history_row::{sense_of_beam, sense_of_control, sense_of_spring};
use crate::model::scene::{Step, Stop};
use crate::model::steps::DrivenEnd;

/// Watches the drive or load of a step for the conditions that end it.
///
/// A checkpoint stores it, and [`Stop`] within: raise `VERSION` in `results/checkpoint.rs` when a field of either is
/// added, removed or moved.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::solve) struct Watch {
    stop: Stop,
    /// Sign of this step's drive in the direction of the history.
    sign: f64,
    /// Force of the whole scene over that of the part solved.
    #[serde(skip, default = "one")]
    whole: f64,
    /// Whether the drive reverses.
    turns: bool,
    /// Displacement at the start of the step [mm].
    start: f64,
    /// Largest force in this step so far, along the drive and against it [kN].
    most: [f64; 2],
    /// Largest displacement in this step so far, along the drive and against it [mm].
    farthest: [f64; 2],
}

fn one() -> f64 {
    1.0
}

/// Relative tolerance for a displacement that counts as reached: sums of increments are rounded.
const ROUNDING: f64 = 1e-9;

impl Watch {
    /// Watch for a step of `steps` whose displacement starts at `start` [mm]; none if the step neither drives nor
    /// loads. Steps without `stop` are watched too, because a resumed run may add it. `whole` is the force of the
    /// scene over that of the part solved.
    pub(in crate::solve) fn new(
        steps: &[Step],
        step: &Step,
        start: f64,
        whole: f64,
    ) -> Option<Self> {
        let stop = step.stop.unwrap_or_default();
        let of_beam = step
            .driven
            .and_then(|driven| Some(driven.way(step)? * sense_of_beam(steps, driven)));
        let of_spring = || {
            let driven = DrivenEnd::of(step)?;
            let by = driven.component(step.springs[driven.spring]);
            Some(by * sense_of_spring(steps, driven))
        };
        let loads = step.loads.iter().any(Option::is_some);
        let of_load = || {
            let by = step.control.map(|control| control.displacement);
            loads.then(|| by.map_or(1.0, |by| by * sense_of_control(steps)))
        };
        let by = of_beam.or_else(of_spring).or_else(of_load)?;
        Some(Self {
            stop,
            sign: by.signum(),
            whole,
            turns: step.turns(),
            start,
            most: [0.0; 2],
            farthest: [0.0; 2],
        })
    }

    /// Takes over the observations of an earlier run for the present conditions.
    pub(in crate::solve) fn go_on(&mut self, earlier: &Self) {
        (self.start, self.most, self.farthest) = (earlier.start, earlier.most, earlier.farthest);
    }

    /// Whether both watches have the same conditions.
    pub(in crate::solve) fn stops_as(&self, step: &Step) -> bool {
        self.stop == step.stop.unwrap_or_default()
    }

    /// Takes the displacement [mm] and the force [kN] of an increment. Returns the reason if the step ends with it.
    ///
    /// A drive that reverses has a peak in either direction, and unloading must not count as a fall below it. There
    /// the force counts only where the displacement is at least as large as ever before on this side, at the tips of
    /// the loops. Forces carried by inertia (`swings`) do not count.
    pub(in crate::solve) fn take(
        &mut self,
        [displacement, force]: [f64; 2],
        swings: bool,
    ) -> Option<String> {
        let way = self.sign * (displacement - self.start);
        let side = usize::from(self.turns && way < 0.0);
        let sense = if side == 1 { -self.sign } else { self.sign };
        let force = sense * force;
        if !swings {
            self.most[side] = self.most[side].max(force);
        }
        let most = self.most[side];
        let out = if self.turns { way.abs() } else { way };
        if let Some(by) = self.stop.displacement
            && out >= by * (1.0 - ROUNDING)
        {
            return Some(format!(
                "it has moved by {way:.4} mm, and stop.displacement is {by} mm"
            ));
        }
        let outermost = out >= self.farthest[side] * (1.0 - ROUNDING);
        self.farthest[side] = self.farthest[side].max(out);
        // A step that starts under load against its drive has no peak before its force acts along the drive.
        let part = self.stop.below_peak?;
        let counts = (outermost || !self.turns) && !swings;
        (counts && most > 0.0 && force <= part * most).then(|| {
            let percent = 100.0 * force / most;
            let most = self.whole * most;
            format!(
                "the force is down to {percent:.1} % of its peak of {most:.3} kN, and stop.below_peak is {part}"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::amplitude::Amplitude;
    use crate::model::scene::BeamMotion;
    use crate::results::fake;

    fn watch(stop: Stop, by: f64, start: f64) -> Watch {
        let mut step = fake::model().steps.remove(1);
        step.motion = vec![[
            BeamMotion::Driven(by),
            BeamMotion::Locked,
            BeamMotion::Locked,
        ]];
        step.stop = Some(stop);
        // An earlier step drives along the axis, so the history counts along it.
        let mut first = step.clone();
        first.motion[0][0] = BeamMotion::Driven(1.0);
        Watch::new(&[first, step.clone()], &step, start, 1.0).unwrap()
    }

    #[test]
    fn a_step_stops_below_its_peak_in_either_direction() {
        let stop = Stop {
            below_peak: Some(0.8),
            displacement: None,
        };
        for sign in [1.0, -1.0] {
            let mut watch = watch(stop, 3.0 * sign, 0.0);
            // The force acts against the drive at first, as after a preload.
            for (d, f) in [
                (0.1, -5.0),
                (0.2, -9.0),
                (0.3, 2.0),
                (1.0, 10.0),
                (1.5, 8.1),
            ] {
                assert_eq!(watch.take([sign * d, sign * f], false), None, "{f}");
            }
            let why = watch.take([sign * 2.0, sign * 8.0], false).unwrap();
            assert!(why.contains("80.0 % of its peak of 10.000 kN"), "{why}");
        }
    }

    #[test]
    fn a_step_stops_at_its_displacement() {
        let stop = Stop {
            below_peak: None,
            displacement: Some(0.3),
        };
        // Driven back from 2 mm; 0.1 three times is not quite 0.3.
        let mut watch = watch(stop, -4.0, 2.0);
        assert_eq!(watch.take([1.8, 1.0], false), None);
        let there = 2.0 - (0.1 + 0.1 + 0.1);
        assert!(watch.take([there, 1.0], false).is_some());
    }

    #[test]
    fn steps_without_a_drive_or_a_stop_condition_are_not_stopped() {
        let mut steps = fake::model().steps;
        steps[0].stop = Some(Stop::default());
        assert!(Watch::new(&steps, &steps[0], 0.0, 1.0).is_none());
        let mut watch = watch(Stop::default(), 3.0, 0.0);
        for force in [1.0, 9.0, 0.1] {
            assert_eq!(watch.take([5.0, force], false), None);
        }
    }

    /// Loops of 1 mm and 2 mm: unloading ends nothing, a tip that has lost a fifth of its peak does.
    #[test]
    fn a_cyclic_step_ends_at_the_tip_of_a_loop_that_is_down() {
        let mut step = fake::model().steps.remove(1);
        step.motion = vec![[
            BeamMotion::Driven(2.0),
            BeamMotion::Locked,
            BeamMotion::Locked,
        ]];
        step.stop = Some(Stop {
            below_peak: Some(0.8),
            displacement: None,
        });
        step.amplitude = Some(Amplitude::cycles(&[1.0, 2.0], 2).unwrap());
        let mut watch = Watch::new(std::slice::from_ref(&step), &step, 0.0, 1.0).unwrap();
        let loops = [
            (0.5, 5.0),
            (1.0, 10.0),
            (0.5, 1.0),
            (0.0, -4.0),
            (-1.0, -9.0),
            (0.0, 4.0),
            (1.0, 9.0),
            (0.0, -3.0),
            (-1.0, -7.5), // 0.83 of the peak on this side
            (0.9, 7.0),   // less displacement than before on this side
        ];
        for (d, f) in loops {
            assert_eq!(watch.take([d, f], false), None, "{d} {f}");
        }
        let why = watch.take([1.0, 8.0], false).unwrap();
        assert!(why.contains("80.0 % of its peak of 10.000 kN"), "{why}");
        assert!(watch.take([-1.0, -7.3], false).is_none());
        assert!(watch.take([-2.0, -7.0], false).is_some());
    }

    #[test]
    fn an_oscillating_force_is_neither_the_peak_nor_below_it() {
        let stop = Stop {
            below_peak: Some(0.8),
            displacement: Some(5.0),
        };
        let mut watch = watch(stop, 3.0, 0.0);
        assert_eq!(watch.take([1.0, 10.0], false), None);
        // Forces above and below the peak of 10 kN, carried by inertia.
        assert_eq!(watch.take([1.1, 15.0], true), None);
        assert_eq!(watch.take([1.2, 2.0], true), None);
        assert_eq!(watch.take([1.3, 9.0], false), None);
        assert!(watch.take([1.4, 7.9], false).is_some());
        // The displacement counts all the same.
        assert!(watch.take([5.0, 9.0], true).is_some());
    }
}
