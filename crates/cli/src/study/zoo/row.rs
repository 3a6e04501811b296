//! `zoo.csv`: a row a wall.

use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::reference::Difference;
use super::wall::Wall;
use wythe_core::error::IoError;
use wythe_core::results::{ReadError, RunFolder, SummaryFile};
use wythe_core::state::EnergyBalance;

/// How a run ended that wrote no summary: its time was up.
pub const OUT_OF_TIME: &str = "out_of_time";
/// It was refused as a wrong model.
pub const REFUSED: &str = "refused";
/// It ended by itself in another way.
pub const CRASHED: &str = "crashed";
/// How runs end that came to an answer, as summaries name it.
const ANSWERS: [&str; 2] = ["completed", "collapsed"];

/// Energies that are out by more are wrong [-].
pub const ENERGY: f64 = 0.01;
/// Linear solves that no wall should need.
pub const SOLVES: usize = 5000;
/// Differences from the reference that are accepted, of the peak and of the area under the curve [-].
pub const PEAK: f64 = 0.02;
/// See [`PEAK`].
pub const AREA: f64 = 0.05;

/// A wall and what became of it. Its fields are the columns of `zoo.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[expect(non_snake_case, reason = "units are written as in summary.json")]
// More than 15 fields: one for each column of the table.
pub struct ZooRow {
    /// What the wall is drawn from.
    pub seed: u64,
    /// Length × thickness × height of a unit [mm].
    pub unit: String,
    /// Joints [mm].
    pub joint_mm: f64,
    /// Bond.
    pub bond: String,
    /// Length of the wall [mm].
    pub length_mm: f64,
    /// Courses.
    pub courses: usize,
    /// Whether it has an opening.
    pub opening: bool,
    /// What is done to it.
    pub load: String,
    /// Pressure on top; none where it is not pressed [MPa].
    pub pressure_MPa: Option<f64>,
    /// Strengths of the units [MPa].
    pub brick_f_t_MPa: f64,
    /// In compression.
    pub brick_f_c_MPa: f64,
    /// Strengths of the mortar; none of a dry wall [MPa].
    pub mortar_f_t_MPa: Option<f64>,
    /// In compression.
    pub mortar_f_c_MPa: Option<f64>,
    /// Tensile strength of the joints [MPa].
    pub joint_f_t_MPa: f64,
    /// Their cohesion [MPa].
    pub joint_c_MPa: f64,
    /// Their friction at first [-].
    pub joint_tan_phi: f64,
    /// As the summary says it, or `OUT_OF_TIME`, `REFUSED`, `CRASHED`.
    pub status: String,
    /// Bodies; none of a run without a summary.
    pub units: Option<usize>,
    /// Unknowns.
    pub dofs: Option<usize>,
    /// Largest force along the motion [kN].
    pub peak_force_kN: Option<f64>,
    /// Displacement there [mm].
    pub displacement_at_peak_mm: Option<f64>,
    /// Last displacement [mm].
    pub final_displacement_mm: Option<f64>,
    /// Converged increments.
    pub increments: usize,
    /// Linear solves; of a run without a summary those of its increments.
    pub solves: usize,
    /// Cut-backs.
    pub cutbacks: usize,
    /// CPU time [s].
    pub cpu_s: f64,
    /// CPU time that it had [s].
    pub limit_s: f64,
    /// See [`EnergyBalance`] [-].
    pub energy_balance_error: Option<f64>,
    /// Number of warnings.
    pub warnings: usize,
    /// How the reference ended; empty where there is none.
    pub reference_status: String,
    /// Its peak [kN].
    pub reference_peak_force_kN: Option<f64>,
    /// Its linear solves.
    pub reference_solves: Option<usize>,
    /// Displacement up to which the two are compared [mm].
    pub compared_to_mm: Option<f64>,
    /// Peak over that of the reference, less 1 [-].
    pub peak_difference: Option<f64>,
    /// Area under the curve over that of the reference, less 1 [-].
    pub area_difference: Option<f64>,
    /// What the run said of its end.
    pub message: String,
}

/// How the process of a run ended, see [`run`](super::process::run).
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// Its time was up.
    pub out_of_time: bool,
    /// Its exit code; none where a signal ended it.
    pub code: Option<i32>,
    /// CPU time [s].
    pub cpu_s: f64,
    /// Its errors.
    pub stderr: String,
}

impl ZooRow {
    /// The columns that say which wall it is.
    pub fn of_wall(wall: &Wall) -> Self {
        let [l, t, h] = wall.unit;
        let mortar = Some(wall.mortar).filter(|_| wall.joint > 0.0);
        // Its air bag presses a wall from the side only.
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
            ..Self::default()
        }
    }

    /// Takes in how the run into `folder` went: its summary, or what its history has where there is none.
    ///
    /// # Errors
    /// [`ReadError`]: the folder holds something else than a run left there.
    pub fn took(&mut self, folder: &Path, ended: &Ended, limit_s: f64) -> Result<(), ReadError> {
        (self.cpu_s, self.limit_s) = (ended.cpu_s, limit_s);
        let open = RunFolder::open(folder).ok();
        let summary = open.as_ref().map_or(Ok(None), RunFolder::summary)?;
        if let Some(summary) = summary {
            self.summarised(&summary);
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
        let history = open.history()?;
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

    /// Takes in how its reference went.
    pub fn compared(&mut self, reference: &Self, difference: Option<Difference>) {
        self.reference_status.clone_from(&reference.status);
        self.reference_peak_force_kN = reference.peak_force_kN;
        self.reference_solves = Some(reference.solves);
        self.compared_to_mm = difference.map(|d| d.to);
        self.peak_difference = difference.map(|d| d.peak);
        self.area_difference = difference.map(|d| d.area);
    }

    /// Whether it came to an answer.
    pub fn answered(&self) -> bool {
        ANSWERS.contains(&self.status.as_str())
    }

    /// Whether its energies are out by more than `ENERGY`; a NaN is.
    pub fn energies_out(&self) -> bool {
        self.energy_balance_error
            .is_some_and(|e| e > ENERGY || e.is_nan())
    }

    /// Whether it is farther from its reference than `PEAK` or `AREA`.
    pub fn far_from_reference(&self) -> bool {
        let far = |difference: Option<f64>, bound| {
            difference.is_some_and(|d| d.abs() > bound || d.is_nan())
        };
        far(self.peak_difference, PEAK) || far(self.area_difference, AREA)
    }

    /// Whether it is as all walls should be.
    pub fn good(&self) -> bool {
        let wrong = self.energies_out() || self.far_from_reference();
        self.answered() && !wrong && self.solves <= SOLVES
    }
}

/// The status of a summary, as its file names it.
pub fn status(summary: &SummaryFile) -> String {
    match serde_json::to_value(summary.status) {
        Ok(serde_json::Value::String(name)) => name,
        _ => format!("{:?}", summary.status),
    }
}

/// Three digits after the point are enough to recognise a strength by.
fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

/// As much of a message as a table has room for, in one line, without the frames around it.
fn one_line(text: &str) -> String {
    const ROOM: usize = 300;
    let words = text.split(|c: char| c.is_whitespace() || "│×╭─╰▶╮╯·┬".contains(c));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    words.join(" ").chars().take(ROOM).collect()
}

/// The text of `zoo.csv`.
pub fn table(rows: &[ZooRow]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        // Plain values, written to memory: nothing that could fail.
        let written = writer.serialize(row);
        debug_assert!(written.is_ok());
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The rows of a `zoo.csv`; none where there is no file.
///
/// # Errors
/// [`IoError`]: it cannot be read, or was not written by this version of wythe.
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
