//! Progress: a bar on a terminal, a line an increment elsewhere. Both on standard error.

use std::io::IsTerminal;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use wythe_core::model::Model;
use wythe_core::results::HistoryRow;

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
    last: String,
}

impl Terminal {
    /// For a run of this model, from now.
    pub fn new(model: &Model) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(TICKS as u64);
            let template = "{wide_bar} {percent}% {elapsed} ETA {eta}\n{msg}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar
        });
        let duration = model.steps.iter().map(|step| step.duration).sum();
        Self {
            bar,
            started: Instant::now(),
            duration,
            last: String::new(),
        }
    }

    /// An increment is done.
    pub fn increment(&mut self, model: &Model, row: &HistoryRow) {
        self.last = line(model, row);
        let done = (row.time / self.duration).clamp(0.0, 1.0);
        if let Some(bar) = &self.bar {
            bar.set_position((TICKS * done) as u64);
            bar.set_message(self.last.clone());
        } else {
            let elapsed = self.started.elapsed().as_secs_f64();
            // Not a number before anything is done: no estimate then.
            let left = elapsed * (1.0 - done) / done;
            let eta = if left.is_finite() {
                format!(", ETA {left:.0} s")
            } else {
                String::new()
            };
            eprintln!("{} [{elapsed:.1} s{eta}]", self.last);
        }
    }

    /// The solver is at work on an increment.
    pub fn iteration(&mut self, iterations: usize) {
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{}  …{iterations}", self.last));
        }
    }

    /// Clears the bar.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn line(model: &Model, row: &HistoryRow) -> String {
    let name = model
        .steps
        .get(row.step)
        .map_or("", |step| step.name.as_str());
    format!(
        "step {} {name}: increment {}, {:.4} mm, {:.3} kN, {} iterations{}",
        row.step,
        row.increment,
        row.displacement_mm,
        row.force_kN,
        row.iterations,
        match row.cutbacks {
            0 => String::new(),
            n => format!(", {n} cut-backs"),
        }
    )
}
