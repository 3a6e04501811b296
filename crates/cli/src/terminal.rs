//! Progress: a live bar on a terminal, a line an increment elsewhere. Both on standard error.

use std::io::IsTerminal;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use wythe_core::model::Model;
use wythe_core::results::HistoryRow;
use wythe_core::solve::{Checkpoint, Method};

/// Ticks of the bar over the whole run.
const TICKS: f64 = 1e4;

/// Tells how a run goes on.
#[derive(Debug)]
pub struct Terminal {
    /// None where standard error is no terminal.
    bar: Option<ProgressBar>,
    started: Instant,
    /// Step time of all steps together [s].
    duration: f64,
    /// Names of the steps.
    steps: Vec<String>,
    /// What the last increment gave.
    last: String,
    /// Number of the last increment.
    increment: usize,
    pace: Pace,
}

/// How fast a run goes: one step says nothing of the next.
#[derive(Debug, Default)]
struct Pace {
    step: usize,
    /// Seconds since the run began and step time, when this step began.
    start: [f64; 2],
    /// The same now.
    now: [f64; 2],
}

impl Pace {
    /// An increment of `step` ends at `time` [s], `elapsed` seconds after the run began.
    fn mark(&mut self, step: usize, elapsed: f64, time: f64) {
        if step != self.step {
            (self.step, self.start) = (step, self.now);
        }
        self.now = [elapsed, time];
    }

    /// Seconds to the step time `end`, at the pace of this step; none if it has not moved.
    fn left(&self, end: f64) -> Option<f64> {
        let [spent, done] = [0, 1].map(|i| self.now[i] - self.start[i]);
        let left = (end - self.now[1]).max(0.0) * spent / done;
        left.is_finite().then_some(left)
    }
}

impl Terminal {
    /// For a run of this model, from now.
    pub fn new(model: &Model) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(TICKS as u64);
            if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %\n{msg}") {
                bar.set_style(style);
            }
            bar
        });
        Self {
            bar,
            started: Instant::now(),
            duration: model.steps.iter().map(|step| step.duration).sum(),
            steps: model.steps.iter().map(|step| step.name.clone()).collect(),
            last: String::new(),
            increment: 0,
            pace: Pace::default(),
        }
    }

    /// For a run of this model that goes on from a checkpoint, from now.
    pub fn resumed(model: &Model, checkpoint: &Checkpoint) -> Self {
        let at = [0.0, checkpoint.time()];
        Self {
            increment: checkpoint.increments(),
            pace: Pace {
                step: checkpoint.step(),
                start: at,
                now: at,
            },
            ..Self::new(model)
        }
    }

    /// An increment is done.
    pub fn increment(&mut self, row: &HistoryRow) {
        self.increment = row.increment;
        let elapsed = self.started.elapsed().as_secs_f64();
        self.pace.mark(row.step, elapsed, row.time);
        let eta = self.pace.left(self.duration);
        let eta = eta.map_or_else(String::new, |left| format!(", ETA {}", seconds(left)));
        self.last = format!("{} [{}{eta}]", self.line(row), seconds(elapsed));
        let done = (row.time / self.duration).clamp(0.0, 1.0);
        if let Some(bar) = &self.bar {
            bar.set_position((TICKS * done) as u64);
            bar.set_message(self.last.clone());
        } else {
            eprintln!("{}", self.last);
        }
    }

    /// So many linear solves were spent on the increment after the last in `step`.
    pub fn iteration(&mut self, step: usize, iterations: usize) {
        if let Some(bar) = &self.bar {
            let (next, name) = (self.increment + 1, self.name(step));
            let now = format!("step {step} {name}: increment {next}, iteration {iterations} …");
            let gap = if self.last.is_empty() { "" } else { "\n" };
            bar.set_message(format!("{}{gap}{now}", self.last));
        }
    }

    /// A line that stays.
    pub fn note(&self, text: &str) {
        if let Some(bar) = &self.bar {
            bar.println(text);
        } else {
            eprintln!("{text}");
        }
    }

    /// Clears the bar.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn name(&self, step: usize) -> &str {
        self.steps.get(step).map_or("", String::as_str)
    }

    fn line(&self, row: &HistoryRow) -> String {
        format!(
            "step {} {}: increment {}, {:.4} mm, {:.3} kN, {}{}{}",
            row.step,
            self.name(row.step),
            row.increment,
            row.displacement_mm,
            row.force_kN,
            count(row.iterations, "iteration"),
            match row.cutbacks {
                0 => String::new(),
                n => format!(", {}", count(n, "cut-back")),
            },
            match row.procedure {
                Method::Static => String::new(),
                other => format!(", {}", other.name()),
            }
        )
    }
}

/// 1 iteration, 2 iterations.
pub fn count(n: usize, what: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{n} {what}{plural}")
}

/// 7.3 s, 2 min 05 s, 1 h 02 min.
fn seconds(value: f64) -> String {
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
        // The second step takes 3 s for a tenth: 27 s for the rest of it.
        pace.mark(1, 7.0, 1.1);
        let left = pace.left(2.0).unwrap();
        assert!((left - 27.0).abs() < 1e-9, "{left}"); // rounding of 1.1 − 1
    }
}
