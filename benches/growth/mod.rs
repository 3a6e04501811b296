//! Helpers for benches of scenes of increasing size: runs without results, and growth of times.

use rayon::ThreadPool;
use wythe::model::Model;
use wythe::results::usage::cpu_seconds;
use wythe::solve::Recorder;
use wythe::state::{Frame, HistoryRow, Summary};

/// Recorder that keeps the last row.
#[derive(Default)]
struct Last(Option<HistoryRow>);

impl Recorder for Last {
    fn take(&mut self, _: &Model, row: &HistoryRow, _: Option<&Frame>) -> std::io::Result<bool> {
        self.0 = Some(row.clone());
        Ok(true)
    }
}

/// Runs `model` on the threads of `pool`. Returns CPU time [s], the last row, and the summary.
pub fn run(model: &Model, pool: &ThreadPool) -> (f64, HistoryRow, Summary) {
    let mut last = Last::default();
    let before = cpu_seconds().expect("a clock");
    let summary = pool.install(|| wythe::solve::run(model, &mut last).expect("a run"));
    let seconds = cpu_seconds().expect("a clock") - before;
    (seconds, last.0.expect("a row"), summary)
}

/// Exponent of y as a power of x, by least squares of the logarithms.
pub fn exponent(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0.ln()), mean(|p| p.1.ln()));
    let along: f64 = points.iter().map(|p| (p.0.ln() - x).powi(2)).sum();
    points
        .iter()
        .map(|p| (p.0.ln() - x) * (p.1.ln() - y))
        .sum::<f64>()
        / along
}

/// Writes `docs/FOLDER/table.csv` and `chart.svg`.
pub fn write(folder: &str, table: &str, chart: &str) {
    let folder = format!("{}/docs/{folder}", env!("CARGO_MANIFEST_DIR"));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(format!("{folder}/table.csv"), table).expect("a table");
    std::fs::write(format!("{folder}/chart.svg"), chart).expect("a chart");
}
