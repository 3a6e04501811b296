//! Ends a step before its loads are whole: where the deck says `stop`.

use serde::{Deserialize, Serialize};

use crate::model::scene::{BeamMotion, Step, Stop};
use crate::results::HistoryRow;

/// Watches the history of a step for what ends it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Watch {
    stop: Stop,
    /// Of the drive.
    sign: f64,
    /// Where the step began [mm].
    start: f64,
    /// Largest force along the drive in this step so far [kN].
    most: f64,
}

/// A displacement counts as reached within this part of it: sums of increments are rounded.
const ROUNDING: f64 = 1e-9;

impl Watch {
    /// Of a step whose driven displacement begins at `start` [mm]; none if it drives nothing. What nothing
    /// stops is watched, too: who resumes may stop it.
    pub(super) fn new(step: &Step, start: f64) -> Option<Self> {
        let stop = step.stop.unwrap_or_default();
        let of_beam = step
            .driven
            .and_then(|(beam, i)| match step.motion[beam][i] {
                BeamMotion::Driven(by) => Some(by),
                _ => None,
            });
        let of_spring = || step.springs.iter().flatten().copied().find(|by| *by != 0.0);
        let by = of_beam.or_else(of_spring)?;
        Some(Self {
            stop,
            sign: by.signum(),
            start,
            most: 0.0,
        })
    }

    /// What this watch of an earlier run has seen, for what stops the step now.
    pub(super) fn go_on(&mut self, earlier: &Self) {
        (self.start, self.most) = (earlier.start, earlier.most);
    }

    /// Whether two watches end a step at the same place.
    pub(super) fn stops_as(&self, step: &Step) -> bool {
        self.stop == step.stop.unwrap_or_default()
    }

    /// Takes a row of the step; why the step ends with it, if it does.
    pub(super) fn take(&mut self, row: &HistoryRow) -> Option<String> {
        let force = self.sign * row.force_kN;
        self.most = self.most.max(force);
        let way = self.sign * (row.displacement_mm - self.start);
        if let Some(by) = self.stop.displacement
            && way >= by * (1.0 - ROUNDING)
        {
            return Some(format!(
                "it has moved by {way:.4} mm, and stop.displacement is {by} mm"
            ));
        }
        // A step that begins under load against its drive has no peak before it is along it.
        let part = self.stop.below_peak?;
        (self.most > 0.0 && force <= part * self.most).then(|| {
            let (percent, most) = (100.0 * force / self.most, self.most);
            format!(
                "the force is down to {percent:.1} % of its peak of {most:.3} kN, and stop.below_peak is {part}"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    fn watch(stop: Stop, by: f64, start: f64) -> Watch {
        let mut step = fake::model().steps.remove(1);
        step.motion = vec![[
            BeamMotion::Driven(by),
            BeamMotion::Locked,
            BeamMotion::Locked,
        ]];
        step.stop = Some(stop);
        Watch::new(&step, start).unwrap()
    }

    #[test]
    fn a_step_ends_below_its_peak_whichever_way_it_drives() {
        let stop = Stop {
            below_peak: Some(0.8),
            displacement: None,
        };
        for sign in [1.0, -1.0] {
            let mut watch = watch(stop, 3.0 * sign, 0.0);
            // Against the drive at first, as after a preload.
            for (d, f) in [
                (0.1, -5.0),
                (0.2, -9.0),
                (0.3, 2.0),
                (1.0, 10.0),
                (1.5, 8.1),
            ] {
                assert_eq!(
                    watch.take(&fake::row(1, 1, sign * d, sign * f)),
                    None,
                    "{f}"
                );
            }
            let why = watch
                .take(&fake::row(1, 1, sign * 2.0, sign * 8.0))
                .unwrap();
            assert!(why.contains("80.0 % of its peak of 10.000 kN"), "{why}");
        }
    }

    #[test]
    fn a_step_ends_where_it_has_moved_far_enough() {
        let stop = Stop {
            below_peak: None,
            displacement: Some(0.3),
        };
        // Driven back from 2 mm: 0.1 three times is not quite 0.3.
        let mut watch = watch(stop, -4.0, 2.0);
        assert_eq!(watch.take(&fake::row(1, 1, 1.8, 1.0)), None);
        let there = 2.0 - (0.1 + 0.1 + 0.1);
        assert!(watch.take(&fake::row(1, 1, there, 1.0)).is_some());
    }

    #[test]
    fn what_drives_nothing_is_not_watched_and_what_stops_for_nothing_goes_on() {
        let mut steps = fake::model().steps;
        steps[0].stop = Some(Stop::default());
        assert!(Watch::new(&steps[0], 0.0).is_none());
        let mut watch = watch(Stop::default(), 3.0, 0.0);
        for force in [1.0, 9.0, 0.1] {
            assert_eq!(watch.take(&fake::row(1, 1, 5.0, force)), None);
        }
    }
}
