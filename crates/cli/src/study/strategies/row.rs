//! Answer of one strategy.

use std::io;
use std::path::Path;

use serde::Deserialize;
use wythe_core::deck::Strategy;
use wythe_core::results::limit::TABLE;
use wythe_core::results::{RunFolder, SummaryFile};

use crate::study::process::Ended;
use crate::study::zoo::{one_line, status};

/// Result of a strategy.
#[derive(Clone, Debug)]
pub struct Row {
    /// The strategy.
    pub strategy: Strategy,
    /// Its answer; none if it gave none.
    pub answer: Answer,
    /// How it ended, in one line.
    pub ended: String,
    /// CPU time [s].
    pub cpu_s: f64,
}

/// Answer of a strategy.
#[derive(Clone, Debug)]
pub enum Answer {
    /// None: refused, or out of time before the first increment.
    None,
    /// A load that rigid units carry.
    Limit(LimitLoad),
    /// A curve.
    Run(Box<Ran>),
}

/// Figures of a limit analysis, from its file.
#[derive(Clone, Debug, Deserialize)]
pub struct LimitLoad {
    /// Factor of the live loads.
    pub factor: f64,
    /// Force along the drive [kN]; none without a drive.
    #[serde(rename = "force_kN")]
    pub force: Option<f64>,
    /// What the factor multiplies.
    pub live_load: String,
}

impl LimitLoad {
    /// Reads the file of a limit analysis in `folder`; none if there is no such file.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(folder: &Path) -> io::Result<Option<Self>> {
        match std::fs::read_to_string(folder.join(TABLE)) {
            Err(why) if why.kind() == io::ErrorKind::NotFound => Ok(None),
            text => serde_json::from_str(&text?)
                .map(Some)
                .map_err(io::Error::other),
        }
    }
}

/// Figures of a run.
#[derive(Clone, Debug, Default)]
pub struct Ran {
    /// Displacement [mm] and force [kN] of its increments in equilibrium; of all if there is none.
    pub points: Vec<(f64, f64)>,
    /// Largest force along the drive: displacement [mm], force [kN].
    pub peak: Option<(f64, f64)>,
    /// Number of linear solves.
    pub solves: usize,
    /// Relative error of the energy balance [-]; none of a run that did not end.
    pub energies: Option<f64>,
    /// Number of warnings.
    pub warnings: usize,
}

impl Row {
    /// Reads the folder of a strategy whose process ended.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn read(strategy: Strategy, folder: &Path, ended: &Ended) -> io::Result<Self> {
        let row = Self {
            strategy,
            answer: Answer::None,
            ended: match ended {
                Ended {
                    out_of_time: true, ..
                } => "out of time".to_owned(),
                _ => one_line(&ended.stderr),
            },
            cpu_s: ended.cpu_s,
        };
        if strategy == Strategy::Limit {
            return row.with_limit(folder);
        }
        let Ok(open) = RunFolder::open(folder) else {
            return Ok(row);
        };
        let history = open.history().map_err(io::Error::other)?;
        let summary = open.summary().map_err(io::Error::other)?;
        Ok(row.with_run(&history.curve(), summary.as_ref()))
    }

    fn with_limit(self, folder: &Path) -> io::Result<Self> {
        Ok(match LimitLoad::read(folder)? {
            None => self,
            Some(found) => Self {
                ended: format!("associated friction, dry joints: {}", found.live_load),
                answer: Answer::Limit(found),
                ..self
            },
        })
    }

    fn with_run(self, curve: &wythe_core::results::Curve, summary: Option<&SummaryFile>) -> Self {
        let peak = curve.peak().map(|peak| (peak.displacement, peak.force));
        let mut points: Vec<_> = curve.in_equilibrium().map(|(_, point)| *point).collect();
        if points.is_empty() {
            points = curve.points().to_vec();
        }
        let mut ran = Ran {
            points,
            peak,
            ..Ran::default()
        };
        let Some(summary) = summary else {
            return Self {
                answer: Answer::Run(Box::new(ran)),
                ..self
            };
        };
        ran.solves = summary.iterations;
        ran.energies = Some(summary.energy_balance_error);
        ran.warnings = summary.warnings.len();
        Self {
            answer: Answer::Run(Box::new(ran)),
            ended: status(summary).replace('_', " "),
            cpu_s: summary.cpu_s.unwrap_or(self.cpu_s),
            ..self
        }
    }

    /// Largest force [kN], of a limit analysis the force along the drive.
    pub fn force(&self) -> Option<f64> {
        match &self.answer {
            Answer::None => None,
            Answer::Limit(found) => found.force,
            Answer::Run(ran) => ran.peak.map(|peak| peak.1),
        }
    }
}
