//! The table `zoo.csv`: a row per wall.

use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::reference::Difference;
use super::wall::Wall;
use crate::study::process::Ended;
use crate::study::strategies::LimitLoad;
use wythe_core::deck::Strategy;
use wythe_core::error::IoError;
use wythe_core::results::{RunFolder, SummaryFile};
use wythe_core::state::EnergyBalance;

/// Status of a run that exceeded its time limit and wrote no summary.
pub const OUT_OF_TIME: &str = "out_of_time";
/// Status of a run whose model was rejected.
pub const REFUSED: &str = "refused";
/// Status of a run that ended in another way.
pub const CRASHED: &str = "crashed";
/// Statuses in summaries of runs that reached an answer.
const COMPLETED: &str = "completed";
const ANSWERS: [&str; 2] = [COMPLETED, "collapsed"];

/// Largest accepted energy imbalance [-].
pub const ENERGY: f64 = 0.01;
/// Number of linear solves that no wall should need.
pub const SOLVES: usize = 5000;
/// Accepted difference from the reference, of the peak [-].
pub const PEAK: f64 = 0.02;
/// Accepted difference from the reference, of the area under the curve [-].
pub const AREA: f64 = 0.05;

/// A wall and the result of its run. The fields are the columns of `zoo.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(non_snake_case, reason = "units are written as in summary.json")]
// More than 15 fields: one for each column of the table.
pub struct ZooRow {
    /// Seed of the wall.
    pub seed: u64,
    /// Length × thickness × height of a unit [mm].
    pub unit: String,
    /// Thickness of the joints [mm].
    pub joint_mm: f64,
    /// Bond.
    pub bond: String,
    /// Length of the wall [mm].
    pub length_mm: f64,
    /// Number of courses.
    pub courses: usize,
    /// Whether it has an opening.
    pub opening: bool,
    /// Kind of load.
    pub load: String,
    /// Pressure on top; none if there is no pressure [MPa].
    pub pressure_MPa: Option<f64>,
    /// Tensile strength of the units [MPa].
    pub brick_f_t_MPa: f64,
    /// Compressive strength of the units [MPa].
    pub brick_f_c_MPa: f64,
    /// Tensile strength of the mortar; none for a dry wall [MPa].
    pub mortar_f_t_MPa: Option<f64>,
    /// Compressive strength of the mortar; none for a dry wall [MPa].
    pub mortar_f_c_MPa: Option<f64>,
    /// Tensile strength of the joints [MPa].
    pub joint_f_t_MPa: f64,
    /// Cohesion of the joints [MPa].
    pub joint_c_MPa: f64,
    /// Initial friction coefficient of the joints [-].
    pub joint_tan_phi: f64,
    /// Modelling strategy.
    #[serde(default = "detailed")]
    pub strategy: String,
    /// Status from the summary, `completed` for a limit analysis that found a load, or `OUT_OF_TIME`, `REFUSED`, `CRASHED`.
    pub status: String,
    /// Number of bodies; none for a run without a summary.
    pub units: Option<usize>,
    /// Number of unknowns.
    pub dofs: Option<usize>,
    /// Largest force along the motion [kN].
    pub peak_force_kN: Option<f64>,
    /// Displacement at the largest force [mm].
    pub displacement_at_peak_mm: Option<f64>,
    /// Last displacement [mm].
    pub final_displacement_mm: Option<f64>,
    /// Number of converged increments.
    pub increments: usize,
    /// Number of linear solves; for a run without a summary, those of its increments.
    pub solves: usize,
    /// Number of cut-backs.
    pub cutbacks: usize,
    /// CPU time [s].
    pub cpu_s: f64,
    /// Limit of its CPU time [s].
    pub limit_s: f64,
    /// Energy imbalance, see [`EnergyBalance`] [-].
    pub energy_balance_error: Option<f64>,
    /// Number of warnings.
    pub warnings: usize,
    /// Status of the reference; empty if there is none.
    pub reference_status: String,
    /// Peak force of the reference [kN].
    pub reference_peak_force_kN: Option<f64>,
    /// Number of linear solves of the reference.
    pub reference_solves: Option<usize>,
    /// Displacement at which the comparison ends [mm].
    pub compared_to_mm: Option<f64>,
    /// Peak over that of the reference, less 1 [-].
    pub peak_difference: Option<f64>,
    /// Area under the curve over that of the reference, less 1 [-].
    pub area_difference: Option<f64>,
    /// Message of the run at its end.
    pub message: String,
}

/// Strategy of rows without that column, which earlier versions wrote.
fn detailed() -> String {
    Strategy::Detailed.name().to_owned()
}

impl ZooRow {
    /// A row of the table of random walls for this wall. The columns of its run are empty until it ends.
    pub fn of_wall(wall: &Wall) -> Self {
        let [l, t, h] = wall.unit;
        let mortar = Some(wall.mortar).filter(|_| wall.joint > 0.0);
        // The load case with an air bag has no pressure on top.
        let pressed = wall.load != super::Load::Airbag;
        Self {
            seed: wall.seed,
            unit: format!("{l}x{t}x{h}"),
            joint_mm: wall.joint,
            bond: wall.bond.to_owned(),
            length_mm: wall.length,
            courses: wall.courses,
            opening: wall.opening,
            load: wall.load.name().to_owned(),
            pressure_MPa: pressed.then(|| rounded(wall.pressure)),
            brick_f_t_MPa: rounded(wall.brick.f_t),
            brick_f_c_MPa: rounded(wall.brick.f_c),
            mortar_f_t_MPa: mortar.map(|m| rounded(m.f_t)),
            mortar_f_c_MPa: mortar.map(|m| rounded(m.f_c)),
            joint_f_t_MPa: mortar.map_or(0.0, |_| rounded(wall.bonding.f_t)),
            joint_c_MPa: mortar.map_or(0.0, |_| rounded(wall.bonding.c)),
            joint_tan_phi: rounded(wall.bonding.tan_phi),
            strategy: detailed(),
            ..Self::default()
        }
    }

    /// Adds the results of the run in `folder`: its summary, or without a summary the data of its history.
    ///
    /// # Errors
    /// The folder holds other files than those of a run or a limit analysis.
    pub fn took(&mut self, folder: &Path, ended: &Ended, limit_s: f64) -> io::Result<()> {
        (self.cpu_s, self.limit_s) = (ended.cpu_s, limit_s);
        let open = RunFolder::open(folder).ok();
        let summary = open.as_ref().map_or(Ok(None), RunFolder::summary);
        let summary = summary.map_err(io::Error::other)?;
        if let Some(summary) = summary {
            self.summarised(&summary);
            return Ok(());
        }
        if let Some(found) = LimitLoad::read(folder)? {
            COMPLETED.clone_into(&mut self.status);
            self.peak_force_kN = found.force;
            self.message = format!("factor {:.4} of {}", found.factor, found.live_load);
            return Ok(());
        }
        let status = match ended {
            Ended {
                out_of_time: true, ..
            } => OUT_OF_TIME,
            Ended { code: Some(2), .. } => REFUSED,
            _ => CRASHED,
        };
        status.clone_into(&mut self.status);
        self.message = one_line(&ended.stderr);
        let Some(open) = open else {
            return Ok(());
        };
        let history = open.history().map_err(io::Error::other)?;
        let (curve, mut energy) = (history.curve(), EnergyBalance::default());
        for row in &history.rows {
            energy.push(row);
            self.solves += row.iterations;
            self.cutbacks += row.cutbacks;
        }
        self.increments = history.rows.len();
        self.peak_force_kN = curve.peak().map(|p| p.force);
        self.displacement_at_peak_mm = curve.peak().map(|p| p.displacement);
        self.final_displacement_mm = curve.final_displacement();
        self.energy_balance_error = Some(energy.error());
        if let (Some(last), true) = (history.rows.last(), self.message.is_empty()) {
            self.message = format!("in step {} at {:.4} s", last.step, last.time);
        }
        Ok(())
    }

    fn summarised(&mut self, summary: &SummaryFile) {
        self.status = status(summary);
        self.message = one_line(&summary.message);
        (self.units, self.dofs) = (Some(summary.units), Some(summary.dofs));
        self.peak_force_kN = summary.peak_force_kN;
        self.displacement_at_peak_mm = summary.displacement_at_peak_mm;
        self.final_displacement_mm = summary.final_displacement_mm;
        self.increments = summary.increments;
        self.solves = summary.iterations;
        self.cutbacks = summary.cutbacks;
        self.cpu_s = summary.cpu_s.unwrap_or(self.cpu_s);
        self.energy_balance_error = Some(summary.energy_balance_error);
        self.warnings = summary.warnings.len();
    }

    /// Adds the results of the reference.
    pub fn compared(&mut self, reference: &Self, difference: Option<Difference>) {
        self.reference_status.clone_from(&reference.status);
        self.reference_peak_force_kN = reference.peak_force_kN;
        self.reference_solves = Some(reference.solves);
        self.compared_to_mm = difference.map(|d| d.to);
        self.peak_difference = difference.map(|d| d.peak);
        self.area_difference = difference.map(|d| d.area);
    }

    /// Whether the run reached an answer.
    pub fn answered(&self) -> bool {
        ANSWERS.contains(&self.status.as_str())
    }

    /// Whether the energy imbalance exceeds `ENERGY` or is NaN.
    pub fn energies_out(&self) -> bool {
        self.energy_balance_error
            .is_some_and(|e| e > ENERGY || e.is_nan())
    }

    /// Whether the difference from the reference exceeds `PEAK` or `AREA`.
    pub fn far_from_reference(&self) -> bool {
        let far = |difference: Option<f64>, bound| {
            difference.is_some_and(|d| d.abs() > bound || d.is_nan())
        };
        far(self.peak_difference, PEAK) || far(self.area_difference, AREA)
    }

    /// Whether the run fulfils all requirements of the study.
    pub fn good(&self) -> bool {
        let wrong = self.energies_out() || self.far_from_reference();
        self.answered() && !wrong && self.solves <= SOLVES
    }
}

/// Status of a summary as its file names it.
pub fn status(summary: &SummaryFile) -> String {
    match serde_json::to_value(summary.status) {
        Ok(serde_json::Value::String(name)) => name,
        _ => format!("{:?}", summary.status),
    }
}

/// Rounds to three decimals, which suffice to recognise a strength.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// Shortens a message to one line of a table, without its frames of lines.
pub fn one_line(text: &str) -> String {
    const ROOM: usize = 300;
    let words = text.split(|c: char| c.is_whitespace() || "│×╭─╰▶╮╯·┬".contains(c));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    words.join(" ").chars().take(ROOM).collect()
}

/// Text of `zoo.csv`.
pub fn table(rows: &[ZooRow]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        // Plain values are written to memory, which does not fail.
        let written = writer.serialize(row);
        debug_assert!(written.is_ok());
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Reads the rows of a `zoo.csv`; none if there is no file.
///
/// # Errors
/// [`IoError`]: the file cannot be read, or comes from another version of wythe.
pub fn read(path: &Path) -> Result<Vec<ZooRow>, IoError> {
    let error = |why: io::Error| IoError {
        path: path.to_owned(),
        why,
    };
    let text = match std::fs::read(path) {
        Err(why) if why.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        read => read.map_err(error)?,
    };
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let rows: Result<Vec<ZooRow>, csv::Error> = reader.deserialize().collect();
    rows.map_err(|why| error(io::Error::new(io::ErrorKind::InvalidData, why)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wythe_core::deck::{Deck, templates};
    use wythe_core::model::Model;
    use wythe_core::model::sizes::sizes;
    use wythe_core::results::RunDirectory;
    use wythe_core::solve::Recorder;
    use wythe_core::state::{HistoryRow, Status, Summary};

    fn ended(out_of_time: bool, code: Option<i32>, stderr: &str) -> Ended {
        Ended {
            out_of_time,
            code,
            cpu_s: 2.5,
            stderr: stderr.to_owned(),
        }
    }

    #[test]
    fn rows_come_back_from_their_table() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("zoo.csv");
        assert_eq!(read(&path).unwrap(), []);
        let mut dry = ZooRow::of_wall(&Wall::drawn(15));
        dry.status = "not_converged".to_owned();
        dry.message = "in step 2, \"drive\": no equilibrium".to_owned();
        let mut bent = ZooRow::of_wall(&Wall::drawn(2));
        bent.energy_balance_error = Some(0.1 + 0.2);
        assert_eq!((dry.mortar_f_t_MPa, bent.pressure_MPa), (None, None));
        let rows = [dry, bent];
        std::fs::write(&path, table(&rows)).unwrap();
        assert_eq!(read(&path).unwrap(), rows);
        std::fs::write(&path, "seed,wall\n1,2\n").unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("zoo.csv"));
    }

    #[test]
    fn a_run_without_a_summary_counts_by_its_history() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("1.out");
        let deck =
            Deck::from_str(templates::find("couplet").unwrap().text, "couplet.toml").unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let mut run = RunDirectory::create(&path, &model).unwrap();
        for i in 1..=3 {
            let row = HistoryRow {
                increment: i,
                step: 1,
                displacement_mm: f64::from(i as u32),
                force_kN: 10.0,
                iterations: 4,
                cutbacks: 1,
                probes: vec![0.0; model.columns().len()],
                ..HistoryRow::default()
            };
            run.take(&model, &row, None).unwrap();
        }
        let mut row = ZooRow::of_wall(&Wall::drawn(1));
        row.took(&path, &ended(true, None, ""), 2.0).unwrap();
        assert_eq!((row.status.as_str(), row.answered()), (OUT_OF_TIME, false));
        assert_eq!((row.increments, row.solves, row.cutbacks), (3, 12, 3));
        assert_eq!(row.peak_force_kN, Some(10.0));
        assert_eq!((row.cpu_s, row.limit_s), (2.5, 2.0));
        assert!(row.message.starts_with("in step 1"), "{}", row.message);

        let summary = Summary::begun(sizes(&model), 1);
        assert_eq!(summary.status, Status::Completed);
        run.finish(&model, &summary, &[]).unwrap();
        let mut row = ZooRow::of_wall(&Wall::drawn(1));
        row.took(&path, &ended(false, Some(0), ""), 2.0).unwrap();
        assert_eq!((row.status.as_str(), row.answered()), ("completed", true));
    }

    #[test]
    fn a_run_that_left_nothing_says_why() {
        let nowhere = Path::new("no/such.out");
        for (code, status) in [(Some(2), REFUSED), (Some(1), CRASHED), (None, CRASHED)] {
            let mut row = ZooRow::of_wall(&Wall::drawn(1));
            let said = format!("  × wall.length:\n  │ {}", "x".repeat(400));
            row.took(nowhere, &ended(false, code, &said), 1.0).unwrap();
            assert_eq!(row.status, status);
            assert!(row.message.starts_with("wall.length: xx"));
            assert_eq!(row.message.len(), 300);
        }
    }

    #[test]
    fn a_wall_is_good_where_nothing_is_wrong_with_it() {
        let good = ZooRow {
            status: "collapsed".to_owned(),
            energy_balance_error: Some(ENERGY),
            solves: SOLVES,
            peak_difference: Some(-PEAK),
            area_difference: Some(AREA),
            ..ZooRow::default()
        };
        assert!(good.good());
        for spoil in [
            |r: &mut ZooRow| r.status = "not_converged".to_owned(),
            |r: &mut ZooRow| r.energy_balance_error = Some(f64::NAN),
            |r: &mut ZooRow| r.solves += 1,
            |r: &mut ZooRow| r.peak_difference = Some(-0.03),
            |r: &mut ZooRow| r.area_difference = Some(f64::NAN),
        ] {
            let mut row = good.clone();
            spoil(&mut row);
            assert!(!row.good(), "{row:?}");
        }
    }
}
