//! Progress of a run: a live bar on a terminal or one line per increment elsewhere, both on standard error; one JSON
//! object per increment on standard output; or nothing.

mod pace;
mod sparkline;
mod waiting;

use std::io::{IsTerminal, Write};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use wythe_core::model::Model;
use wythe_core::solve::Checkpoint;
use wythe_core::state::HistoryRow;
use wythe_core::state::Method;

use crate::arguments::Progress;
use crate::say::tell;
use crate::unicode;
use pace::Pace;
pub use pace::seconds;
use waiting::Waiting;

/// Ticks of the bar over the whole run.
const TICKS: f64 = 1e4;

/// Largest width of the sparkline in characters.
const SPARKS: usize = 40;

/// Shows the progress of a run.
#[derive(Debug)]
pub struct Terminal {
    voice: Voice,
    started: Instant,
    /// Duration of all steps together [s].
    duration: f64,
    /// Names of the steps.
    steps: Vec<String>,
    /// Text of the last increment.
    last: String,
    /// Forces of all increments [kN].
    forces: Vec<f64>,
    /// Number of the last increment.
    increment: usize,
    /// Procedure of the last increment.
    procedure: &'static str,
    pace: Pace,
    waiting: Waiting,
    unicode: bool,
}

/// Form of the progress.
#[derive(Debug)]
enum Voice {
    /// A bar on a terminal.
    Bar(ProgressBar),
    /// One line per increment.
    Lines,
    /// One JSON object per increment.
    Json,
    /// No output.
    None,
}

impl Voice {
    fn new(how: Progress, quiet: bool, unicode: bool) -> Self {
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        match how {
            _ if quiet => Self::None,
            Progress::Json => Self::Json,
            Progress::Auto if std::io::stderr().is_terminal() && !dumb => {
                let bar = ProgressBar::new(TICKS as u64);
                bar.set_style(style(unicode, unicode::colours()));
                Self::Bar(bar)
            }
            Progress::Auto | Progress::Plain => Self::Lines,
        }
    }
}

/// Template of the bar and the line below it.
fn template(colours: bool) -> String {
    let bar = if colours {
        "{wide_bar:.cyan/dim}"
    } else {
        "{wide_bar}"
    };
    format!("{bar} {{percent:>3}} %\n{{msg}}")
}

/// Style of the bar, with characters that the terminal can draw.
fn style(unicode: bool, colours: bool) -> ProgressStyle {
    let style = ProgressStyle::with_template(&template(colours));
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    style.progress_chars(if unicode {
        "█▉▊▋▌▍▎▏ "
    } else {
        "#>-"
    })
}

impl Terminal {
    /// Progress of a run of this model, which starts now.
    pub fn new(model: &Model, how: Progress, quiet: bool) -> Self {
        let unicode = unicode::is_on();
        Self {
            voice: Voice::new(how, quiet, unicode),
            started: Instant::now(),
            duration: model.steps.iter().map(|step| step.duration).sum(),
            waiting: Waiting::of(model),
            steps: model.steps.iter().map(|step| step.name.clone()).collect(),
            last: String::new(),
            forces: Vec::new(),
            increment: 0,
            procedure: "",
            pace: Pace::default(),
            unicode,
        }
    }

    /// Notes the start of the run into the folder `out`.
    pub fn begin(&self, model: &Model, warnings: &[String], out: &std::path::Path) {
        match &self.voice {
            Voice::Bar(_) | Voice::Lines => {
                for warning in warnings {
                    tell!("warning: {warning}");
                }
            }
            Voice::Json => emit(&json!({
                "event": "begin",
                "title": model.title,
                "steps": self.steps,
                "duration_s": self.duration,
                "warnings": warnings,
                "out": out.display().to_string(),
            })),
            Voice::None => {}
        }
    }

    /// Notes that the run continues from a checkpoint.
    pub fn go_on(&mut self, from: &Checkpoint) {
        self.increment = from.increments();
        self.pace = Pace::from(from.step(), from.time());
        let (step, increment) = (from.step(), self.increment);
        match &self.voice {
            Voice::Bar(_) | Voice::Lines => {
                tell!("going on after increment {increment} (step {step})");
            }
            Voice::Json => emit(&json!({
                "event": "resume",
                "step": step,
                "increment": increment,
                "time_s": from.time(),
            })),
            Voice::None => {}
        }
    }

    /// Shows a finished increment.
    pub fn increment(&mut self, row: &HistoryRow) {
        self.increment = row.increment;
        self.procedure = row.procedure.name();
        self.forces.push(row.force_kN);
        let elapsed = self.started.elapsed().as_secs_f64();
        let time = row.time - self.waiting.until(row);
        self.pace.mark(row.step, elapsed, time);
        let left = self.pace.left(self.duration);
        let eta = left.map_or_else(String::new, |[least, most]| {
            format!(", {} to {} left", seconds(least), seconds(most))
        });
        self.last = format!("{} [{}{eta}]", self.line(row), seconds(elapsed));
        let done = (time / self.duration).clamp(0.0, 1.0);
        match &self.voice {
            Voice::Bar(bar) => {
                bar.set_position((TICKS * done) as u64);
                bar.set_message(self.message(""));
            }
            Voice::Lines => tell!("{}", self.last),
            Voice::Json => emit(&json!({
                "event": "increment",
                "step": row.step,
                "name": self.name(row.step),
                "increment": row.increment,
                "time_s": row.time,
                "done": done,
                "displacement_mm": row.displacement_mm,
                "force_kN": row.force_kN,
                "iterations": row.iterations,
                "cutbacks": row.cutbacks,
                "procedure": self.procedure,
                "elapsed_s": elapsed,
                "eta_s": left.map(|[least, most]| (least * most).sqrt()),
                "left_s": left,
            })),
            Voice::None => {}
        }
    }

    /// Shows the number of linear solves spent on the next increment, in `step`.
    pub fn iteration(&mut self, step: usize, iterations: usize) {
        if let Voice::Bar(bar) = &self.voice {
            let (next, name) = (self.increment + 1, self.name(step));
            let by = match self.procedure {
                "" => String::new(),
                procedure => format!(" by {procedure}"),
            };
            let dots = if self.unicode { "…" } else { "..." };
            let now =
                format!("step {step} {name}{by}: increment {next}, iteration {iterations} {dots}");
            bar.set_message(self.message(&now));
        }
    }

    /// Text below the bar: the forces so far, the last increment, the present one.
    fn message(&self, now: &str) -> String {
        let width = unicode::width().saturating_sub(1);
        let forces = sparkline::draw(&self.forces, SPARKS.min(width / 2), self.unicode);
        let forces = match sparkline::range(&self.forces) {
            Some([low, high]) => format!("{forces} {low:.3} to {high:.3} kN"),
            None => forces,
        };
        let lines = [forces.as_str(), &self.last, now];
        let lines = lines.into_iter().filter(|line| !line.is_empty());
        let lines: Vec<String> = lines.map(|line| fit(line, width, self.unicode)).collect();
        lines.join("\n")
    }

    /// Prints a line that stays above the bar.
    pub fn note(&self, text: &str) {
        match &self.voice {
            Voice::Bar(bar) => bar.println(text),
            Voice::Lines => tell!("{text}"),
            Voice::Json => emit(&json!({ "event": "note", "text": text })),
            Voice::None => {}
        }
    }

    /// Clears the bar.
    pub fn finish(&self) {
        if let Voice::Bar(bar) = &self.voice {
            bar.finish_and_clear();
        }
    }

    /// Text after the progress: words or a JSON object, or nothing.
    pub fn conclude(
        &self,
        words: impl FnOnce() -> String,
        object: impl FnOnce() -> Value,
    ) -> String {
        match &self.voice {
            Voice::Bar(_) | Voice::Lines => words(),
            Voice::Json => format!("{}\n", object()),
            Voice::None => String::new(),
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

/// Prints a JSON object as one line of standard output. A reader that has stopped does not stop the run.
fn emit(object: &Value) {
    let mut out = std::io::stdout().lock();
    let _ = writeln!(out, "{object}").and_then(|()| out.flush());
}

/// A line, cut to `width` characters.
fn fit(line: &str, width: usize, unicode: bool) -> String {
    let dots = if unicode { "…" } else { "..." };
    if line.chars().count() <= width {
        return line.to_owned();
    }
    let kept = line
        .chars()
        .take(width.saturating_sub(dots.chars().count()));
    kept.chain(dots.chars()).take(width).collect()
}

/// Number with its noun: 1 iteration, 2 iterations.
pub fn count(n: usize, what: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{n} {what}{plural}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_to_the_width() {
        assert_eq!(fit("abcdef", 6, true), "abcdef");
        assert_eq!(fit("abcdefg", 6, true), "abcde…");
        assert_eq!(fit("abcdefg", 6, false), "abc...");
        assert_eq!(fit("abcdefg", 2, false), "..");
        assert_eq!(fit("abc", 0, true), "");
    }

    #[test]
    fn templates_of_the_bar_are_sound() {
        for colours in [true, false] {
            assert!(ProgressStyle::with_template(&template(colours)).is_ok());
        }
    }
}
