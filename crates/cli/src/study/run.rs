//! A run of a study: its rows, its end and its cost.

use std::io;
use std::time::{Duration, Instant};

use super::cell::Cost;
use super::judge::Ended;
use wythe_core::model::Model;
use wythe_core::results::usage;
use wythe_core::solve;
use wythe_core::solve::Recorder;
use wythe_core::state::EnergyBalance;
use wythe_core::state::{Frame, HistoryRow, Summary};

/// Time limit of a run, and its request to stop.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Largest wall time, checked after each increment.
    pub limit: Duration,
    /// Function that returns true if the run must stop; called after each increment.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

/// A finished run, whatever its status.
pub struct Ran<R> {
    pub ended: Ended,
    pub summary: Summary,
    pub cost: Cost,
    /// Recorder of the run.
    pub recorder: R,
}

/// Runs a model; `recorder` receives its rows, frames and notes.
///
/// # Errors
/// The error that ended the run, in words.
pub fn run<R: Recorder>(model: &Model, recorder: R, watch: Watch<'_>) -> Result<Ran<R>, String> {
    let (started, cpu) = (Instant::now(), usage::thread_cpu_seconds());
    let mut kept = Kept {
        recorder,
        rows: Vec::new(),
        balance: EnergyBalance::default(),
        ends: started + watch.limit,
        stop: watch.stop,
    };
    let summary = solve::run(model, &mut kept).map_err(|e| e.to_string())?;
    // CPU time if the system reports it, else wall time.
    let seconds = usage::thread_cpu_seconds()
        .zip(cpu)
        .map_or(started.elapsed().as_secs_f64(), |(now, then)| now - then);
    Ok(Ran {
        ended: Ended {
            status: summary.status,
            message: summary.message.clone(),
            tolerances: model.steps.iter().map(|s| s.tolerance.residual).collect(),
            probes: model.columns(),
            energy: kept.balance.error(),
            rows: kept.rows,
        },
        cost: Cost {
            increments: summary.increments,
            iterations: summary.iterations,
            cutbacks: summary.cutbacks,
            seconds,
        },
        summary,
        recorder: kept.recorder,
    })
}

/// Recorder that discards everything.
pub struct Nowhere;

impl Recorder for Nowhere {
    fn take(&mut self, _: &Model, _: &HistoryRow, _: Option<&Frame>) -> io::Result<bool> {
        Ok(true)
    }
}

/// Recorder that collects the rows and checks the time limit.
struct Kept<'a, R> {
    recorder: R,
    rows: Vec<HistoryRow>,
    balance: EnergyBalance,
    ends: Instant,
    stop: &'a (dyn Fn() -> bool + Sync),
}

impl<R: Recorder> Recorder for Kept<'_, R> {
    fn take(&mut self, model: &Model, row: &HistoryRow, frame: Option<&Frame>) -> io::Result<bool> {
        let go_on = self.recorder.take(model, row, frame)?;
        self.balance.push(row);
        self.rows.push(row.clone());
        Ok(go_on && Instant::now() < self.ends && !(self.stop)())
    }

    fn wants_fields(&self) -> bool {
        self.recorder.wants_fields()
    }

    fn keep(&mut self, model: &Model, fields: Frame) {
        self.recorder.keep(model, fields);
    }

    fn note(&mut self, text: &str) {
        self.recorder.note(text);
    }
}
