//! Writer of `history.csv`: each row is in the file before the next increment starts.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use crate::files::{Extent, NewFile};
use crate::model::Model;
use crate::model::columns::FIXED;
use crate::state::HistoryRow;

/// Writes `history.csv`. The columns are the fields of [`HistoryRow`] in order, then the model's probes and loads.
///
/// Each row is written by one call. Systems write page by page, however, so a reader may find an incomplete last row
/// during the run or after it was killed. Text without a final line break is not a row;
/// [`RunFolder::history`](super::RunFolder::history) ignores it. Numbers are the shortest decimals that read back to
/// the same bits.
#[derive(Debug)]
pub struct HistoryWriter {
    file: File,
    /// Size of the complete rows and the header [byte], and their check sum.
    whole: u64,
    sum: crc32fast::Hasher,
    /// Number of columns specific to the model, see [`Model::columns`].
    probes: usize,
}

impl HistoryWriter {
    /// Creates the file with its header at `path` and replaces an existing one.
    ///
    /// # Errors
    /// The file cannot be created or written.
    pub fn create(path: &Path, model: &Model) -> io::Result<Self> {
        Self::begin(path, model, header(model).as_bytes())
    }

    /// Creates a file that begins with these complete lines.
    fn begin(path: &Path, model: &Model, lines: &[u8]) -> io::Result<Self> {
        let new = NewFile::create(path)?;
        let mut history = Self {
            file: new.file()?,
            whole: 0,
            sum: crc32fast::Hasher::new(),
            probes: model.columns().len(),
        };
        history.write(lines)?;
        history.sync()?;
        history.file = new.keep()?;
        Ok(history)
    }

    /// Continues a history after the given complete lines: the header and rows of a run of this model. They are
    /// written to a new file, so that a hard link to the old file keeps its content.
    ///
    /// # Errors
    /// The columns are not those of the model, or the file cannot be written.
    pub fn resume(path: &Path, model: &Model, lines: &[u8]) -> io::Result<Self> {
        if !lines.starts_with(header(model).as_bytes()) {
            let why = "its columns are not those of the model";
            return Err(io::Error::new(io::ErrorKind::InvalidData, why));
        }
        Self::begin(path, model, lines)
    }

    /// Size and check sum of the complete rows.
    pub fn extent(&self) -> Extent {
        Extent {
            bytes: self.whole,
            sum: self.sum.clone().finalize(),
        }
    }

    /// Waits until the rows are on the disk.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// Appends one row.
    ///
    /// # Errors
    /// The row has a wrong number of probes, or it cannot be written. A partly written row is removed.
    pub fn append(&mut self, row: &HistoryRow) -> io::Result<()> {
        if row.probes.len() != self.probes {
            let (found, wanted) = (row.probes.len(), self.probes);
            let message = format!("{found} probes where {wanted} belong");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        self.write(&line(row)?)
    }

    /// Writes complete lines or nothing.
    fn write(&mut self, lines: &[u8]) -> io::Result<()> {
        if let Err(error) = self.file.write_all(lines).and_then(|()| self.file.flush()) {
            // Best effort: the first error is the one to report.
            let _ = self.file.set_len(self.whole);
            return Err(error);
        }
        self.whole += lines.len() as u64;
        self.sum.update(lines);
        Ok(())
    }
}

/// Text of a row.
fn line(row: &HistoryRow) -> io::Result<Vec<u8>> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(Vec::new());
    writer
        .serialize((row, &row.probes))
        .map_err(io::Error::other)?;
    writer
        .into_inner()
        .map_err(|error| io::Error::other(error.to_string()))
}

/// Text of the history of a model with these rows.
///
/// # Errors
/// None for rows that were read from a history.
pub fn written(model: &Model, rows: &[HistoryRow]) -> io::Result<Vec<u8>> {
    let mut bytes = header(model).into_bytes();
    for row in rows {
        bytes.extend(line(row)?);
    }
    Ok(bytes)
}

/// Header of the history of a model.
fn header(model: &Model) -> String {
    let fixed = FIXED.map(str::to_owned).into_iter();
    let columns: Vec<String> = fixed.chain(model.columns()).collect();
    format!("{}\n", columns.join(","))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::probes::Probe;
    use crate::model::probes::ProbeQuantity;
    use crate::results::fake;

    const HEADER: &str = "increment,step,time,displacement_mm,force_kN,reaction_kN,iterations,\
        cutbacks,external_work_J,elastic_energy_J,plastic_damage_dissipation_J,\
        interface_dissipation_J,viscous_dissipation_J,open_points,sliding_points,\
        max_interface_damage,max_tensile_damage,max_compressive_damage";

    #[test]
    fn the_columns_are_those_promised_and_later_ones_come_after() {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.serialize(HistoryRow::default()).unwrap();
        let text = String::from_utf8(writer.into_inner().unwrap()).unwrap();
        let header = text.lines().next().unwrap();
        // The fields of a row, in the order of the model's column names.
        assert_eq!(header, FIXED.join(","));
        assert!(header.starts_with(HEADER), "{header}");
        assert_eq!(
            header.strip_prefix(HEADER),
            Some(
                ",out_of_balance,residual,kinetic_energy_J,damping_dissipation_J,\
                 numerical_dissipation_J,contact_area_mm2,load_factor,procedure"
            )
        );
    }

    #[test]
    fn a_row_is_on_disk_when_append_returns_and_reads_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut history = HistoryWriter::create(&path, &fake::model()).unwrap();
        let forces = [1.0 / 3.0, -4.9e-324, 1e300];
        for (i, &force) in forces.iter().enumerate() {
            history
                .append(&HistoryRow {
                    increment: i + 1,
                    force_kN: force,
                    ..<_>::default()
                })
                .unwrap();
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(text.ends_with('\n'));
            assert_eq!(text.lines().count(), i + 2);
            let last: Vec<&str> = text.lines().last().unwrap().split(',').collect();
            assert_eq!(last[0], (i + 1).to_string());
            assert_eq!(last[4].parse::<f64>().unwrap().to_bits(), force.to_bits());
        }
    }

    #[test]
    fn a_resumed_history_continues_after_the_valid_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let model = fake::model();
        let mut history = HistoryWriter::create(&path, &model).unwrap();
        for i in 1..=4 {
            history.append(&fake::row(i, 1, 0.1, 1.0)).unwrap();
        }
        drop(history);
        let whole = std::fs::read(&path).unwrap();
        let second = whole.iter().enumerate().filter(|(_, b)| **b == b'\n');
        let second = second.map(|(i, _)| i + 1).nth(2).unwrap();
        let mut history = HistoryWriter::resume(&path, &model, &whole[..second]).unwrap();
        assert_eq!(history.extent(), Extent::of(&whole[..second]));
        for i in 3..=4 {
            history.append(&fake::row(i, 1, 0.1, 1.0)).unwrap();
        }
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        assert_eq!(history.extent(), Extent::of(&whole));
        assert_eq!(history.extent().read(&path).unwrap(), whole);
        let error = HistoryWriter::resume(&path, &model, b"increment,step\n1,0\n").unwrap_err();
        assert!(error.to_string().contains("columns"), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), whole);
        // A change within the rows is detected; a change after them is not.
        let extent = Extent::of(&whole[..second]);
        for at in 0..whole.len() {
            let mut changed = whole.clone();
            changed[at] ^= 4;
            std::fs::write(&path, &changed).unwrap();
            assert_eq!(extent.read(&path).is_err(), at < second, "byte {at}");
        }
        std::fs::write(&path, &whole[..second - 1]).unwrap();
        assert!(extent.read(&path).is_err());
    }

    #[test]
    fn probes_are_columns_after_the_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut model = fake::model();
        model.probes = ["left_mm", "right_mm"]
            .map(|column| Probe {
                column: column.to_owned(),
                nodes: vec![0],
                minus: Vec::new(),
                direction: [1.0, 0.0, 0.0],
                quantity: ProbeQuantity::Displacement,
                over: 1.0,
            })
            .into();
        let mut history = HistoryWriter::create(&path, &model).unwrap();
        let row = |probes: &[f64]| HistoryRow {
            probes: probes.to_vec(),
            ..HistoryRow::default()
        };
        history.append(&row(&[0.1, -2.0])).unwrap();
        let error = history.append(&row(&[0.1])).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::InvalidInput, "{error}");
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2, "the wrong row left no trace");
        assert!(lines[0].ends_with(",procedure,left_mm,right_mm"));
        assert!(lines[1].ends_with(",0.1,-2.0"), "{}", lines[1]);
        assert_eq!(lines[0].split(',').count(), lines[1].split(',').count());
    }

    #[test]
    #[cfg(unix)]
    fn links_to_a_history_keep_their_content() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let model = fake::model();
        std::fs::write(at("mine"), "mine").unwrap();
        std::os::unix::fs::symlink(at("mine"), at("history.csv")).unwrap();
        let mut history = HistoryWriter::create(&at("history.csv"), &model).unwrap();
        for i in 1..=3 {
            history.append(&fake::row(i, 1, 0.1, 1.0)).unwrap();
        }
        drop(history);
        std::fs::hard_link(at("history.csv"), at("copy")).unwrap();
        let text = |name: &str| std::fs::read_to_string(at(name)).unwrap();
        let whole = text("history.csv");
        let first = header(&model);
        let mut history =
            HistoryWriter::resume(&at("history.csv"), &model, first.as_bytes()).unwrap();
        history.append(&fake::row(9, 1, 0.1, 1.0)).unwrap();
        assert_eq!([text("mine"), text("copy")], ["mine", &whole]);
        assert_eq!(text("history.csv").lines().count(), 2);
    }
}
