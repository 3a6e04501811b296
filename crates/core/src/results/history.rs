//! `history.csv`: a row an increment, on disk before the next increment starts.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use super::HistoryRow;

/// Writes `history.csv`. The columns are the fields of [`HistoryRow`], in order.
///
/// Each row goes to the file whole and at once: whoever reads while a run goes on, or after it was
/// killed, never sees half of one. Numbers are the shortest decimals which read back to the same
/// bits.
#[derive(Debug)]
pub struct HistoryWriter {
    file: File,
    /// Bytes of whole rows, the header included.
    whole: u64,
}

impl HistoryWriter {
    /// Creates (or empties) the file at `path` and writes the header.
    ///
    /// # Errors
    /// The file cannot be created or written.
    pub fn create(path: &Path) -> io::Result<Self> {
        let mut history = Self {
            file: File::create(path)?,
            whole: 0,
        };
        history.write(header()?.as_bytes())?;
        Ok(history)
    }

    /// Appends one row.
    ///
    /// # Errors
    /// The row could not be written; what had got to the disk of it is cut off again.
    pub fn append(&mut self, row: &HistoryRow) -> io::Result<()> {
        self.write(&lines(row, false)?)
    }

    /// Writes whole lines or nothing.
    fn write(&mut self, lines: &[u8]) -> io::Result<()> {
        if let Err(error) = self.file.write_all(lines).and_then(|()| self.file.flush()) {
            // Best effort: the error that matters is the one which brought us here.
            let _ = self.file.set_len(self.whole);
            return Err(error);
        }
        self.whole += lines.len() as u64;
        Ok(())
    }
}

/// Names of the columns, ending in a line feed.
fn header() -> io::Result<String> {
    let lines =
        String::from_utf8(lines(&HistoryRow::default(), true)?).map_err(io::Error::other)?;
    Ok(lines.split_inclusive('\n').take(1).collect())
}

/// One row as CSV text, after the header if asked. Each line ends in a line feed.
fn lines(row: &HistoryRow, header: bool) -> io::Result<Vec<u8>> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(header)
        .from_writer(Vec::new());
    writer.serialize(row).map_err(io::Error::other)?;
    writer
        .into_inner()
        .map_err(|error| io::Error::other(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "increment,step,time,displacement_mm,force_kN,reaction_kN,iterations,\
        cutbacks,external_work_J,elastic_energy_J,plastic_damage_dissipation_J,\
        interface_dissipation_J,viscous_dissipation_J,open_points,sliding_points,\
        max_interface_damage,max_tensile_damage,max_compressive_damage";

    #[test]
    fn the_columns_are_those_promised_and_later_ones_come_after() {
        let header = header().unwrap();
        let header = header.strip_suffix('\n').unwrap();
        assert!(header.starts_with(HEADER), "{header}");
        assert_eq!(
            header.strip_prefix(HEADER),
            Some(
                ",out_of_balance,residual,kinetic_energy_J,damping_dissipation_J,\
                 numerical_dissipation_J,load_factor,procedure"
            )
        );
    }

    #[test]
    fn a_row_is_on_disk_when_append_returns_and_reads_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut history = HistoryWriter::create(&path).unwrap();
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
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_an_error() {
        let error = HistoryWriter::create(Path::new("/dev/full")).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
    }
}
