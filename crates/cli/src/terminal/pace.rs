//! Estimated remaining time of a run.

/// Pace of a run, measured in the present step only: one step does not predict the next.
#[derive(Debug, Default)]
pub struct Pace {
    step: usize,
    /// Seconds since the start of the run and step time, both at the start of this step.
    start: [f64; 2],
    /// The same at the last increment.
    now: [f64; 2],
}

impl Pace {
    /// Pace of a run resumed within `step` at step time `time` [s].
    pub fn from(step: usize, time: f64) -> Self {
        let at = [0.0, time];
        Self {
            step,
            start: at,
            now: at,
        }
    }

    /// Notes that an increment of `step` ended at `time` [s], `elapsed` seconds after the start of the run.
    pub fn mark(&mut self, step: usize, elapsed: f64, time: f64) {
        if step != self.step {
            (self.step, self.start) = (step, self.now);
        }
        self.now = [elapsed, time];
    }

    /// Seconds until the step time `end`, at the pace of this step; none if it has no pace yet.
    pub fn left(&self, end: f64) -> Option<f64> {
        let [spent, done] = [0, 1].map(|i| self.now[i] - self.start[i]);
        let left = (end - self.now[1]).max(0.0) * spent / done;
        left.is_finite().then_some(left)
    }
}

/// Formats a duration: 7.3 s, 2 min 05 s, 1 h 02 min.
pub fn seconds(value: f64) -> String {
    let whole = value.round() as u64;
    match whole {
        0..60 => format!("{value:.1} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_as_people_say_them() {
        let said = [0.04, 59.4, 60.0, 125.2, 3599.9, 3720.0].map(seconds);
        assert_eq!(
            said,
            [
                "0.0 s",
                "59.4 s",
                "1 min 00 s",
                "2 min 05 s",
                "1 h 00 min",
                "1 h 02 min"
            ]
        );
    }

    #[test]
    fn the_rest_is_estimated_from_the_step_in_hand() {
        let mut pace = Pace::default();
        assert_eq!(pace.left(2.0), None);
        pace.mark(0, 4.0, 1.0);
        assert_eq!(pace.left(2.0), Some(4.0));
        // The second step takes 3 s for a tenth, so 27 s for the rest.
        pace.mark(1, 7.0, 1.1);
        let left = pace.left(2.0).unwrap();
        assert!((left - 27.0).abs() < 1e-9, "{left}"); // rounding of 1.1 − 1
        // Increments before the resumption took none of its time.
        let mut resumed = Pace::from(1, 1.5);
        assert_eq!(resumed.left(2.0), None);
        resumed.mark(1, 2.0, 1.75);
        assert_eq!(resumed.left(2.0), Some(2.0));
    }
}
