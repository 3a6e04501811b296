//! Runs a model one increment at a time, at the caller's request.

use super::{Recorder, RunError, run};
use crate::model::Model;
use crate::state::{Frame, HistoryRow, Summary};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// A committed increment.
#[derive(Clone, Debug)]
pub struct Increment {
    /// Its row of the history.
    pub row: HistoryRow,
    /// Fields, if the increment is an output increment of the model.
    pub frame: Option<Frame>,
}

/// Iterator over the increments of a run. The solver works only while [`Iterator::next`] waits for it.
///
/// The run is that of [`run`], bit for bit, on a thread of its own. Dropping the stepper stops it.
#[derive(Debug)]
pub struct Stepper {
    model: Arc<Model>,
    run: Option<Started>,
}

/// A run that has started.
#[derive(Debug)]
struct Started {
    /// Asks for the next increment.
    go: SyncSender<()>,
    increments: Receiver<Increment>,
    solver: JoinHandle<Result<Summary, RunError>>,
}

impl Stepper {
    /// Prepares a run, which the first call of `next` starts.
    pub fn new(model: Arc<Model>) -> Self {
        Self { model, run: None }
    }

    /// Stops the run after the last delivered increment and returns its summary; none if it never started. Its
    /// status is [`Status::Interrupted`](crate::state::Status::Interrupted) if increments were left.
    ///
    /// # Errors
    /// [`RunError`] of a run that could not start.
    ///
    /// # Panics
    /// With the panic of the solver's thread, if it had one.
    pub fn finish(self) -> Result<Option<Summary>, RunError> {
        let Some(Started { go, solver, .. }) = self.run else {
            return Ok(None);
        };
        drop(go);
        match solver.join() {
            Ok(summary) => summary.map(Some),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

impl Iterator for Stepper {
    type Item = Increment;

    /// Solves the next increment. None: the run has ended; [`Stepper::finish`] tells how.
    fn next(&mut self) -> Option<Increment> {
        match &self.run {
            // The run has ended if its thread does not wait any more.
            Some(started) => started.go.send(()).ok()?,
            None => self.run = Some(start(Arc::clone(&self.model))),
        }
        self.run.as_ref()?.increments.recv().ok()
    }
}

fn start(model: Arc<Model>) -> Started {
    let (deliver, increments) = sync_channel(1);
    let (go, requests) = sync_channel(1);
    let mut handover = Handover { deliver, requests };
    let solver = std::thread::spawn(move || run(&model, &mut handover));
    Started {
        go,
        increments,
        solver,
    }
}

/// Hands each increment over and waits for the request of the next.
struct Handover {
    deliver: SyncSender<Increment>,
    requests: Receiver<()>,
}

impl Recorder for Handover {
    fn take(
        &mut self,
        _: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        let increment = Increment {
            row: row.clone(),
            frame: frame.cloned(),
        };
        Ok(self.deliver.send(increment).is_ok() && self.requests.recv().is_ok())
    }
}
