//! `wythe report`: shows the folder of a run on one page.

use wythe_core::results::output::{OF_A_RUN, REPORT};
use wythe_core::results::{Experiment, Report, RunFolder};

use crate::arguments::ReportPage;
use crate::failure::Failure;
use crate::plot::write_answer;
use crate::say::print;
use crate::say::tell;

/// Writes the page and prints its size and the missing parts.
pub fn report(arguments: &ReportPage) -> Result<(), Failure> {
    let folder = RunFolder::open(&arguments.folder)?;
    let experiment = arguments.experiment.as_deref();
    let experiment = experiment.map(Experiment::read).transpose()?;
    let report = Report::of(&folder, experiment.as_ref())?;
    for note in &report.notes {
        tell!("note: {note}");
    }
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| arguments.folder.join(REPORT));
    // The page must not replace another file of the run.
    let others = OF_A_RUN.iter().filter(|name| **name != REPORT);
    let mut inputs: Vec<_> = others.map(|name| arguments.folder.join(name)).collect();
    inputs.extend(arguments.experiment.clone());
    write_answer(&out, report.html.as_bytes(), &inputs)?;
    print(&format!(
        "{}: {:.2} MB, {} of {} frames\n",
        out.display(),
        report.html.len() as f64 / 1e6,
        report.frames,
        report.frames_of_run
    ))
}
