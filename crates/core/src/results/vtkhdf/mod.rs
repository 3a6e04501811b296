//! `results.vtkhdf`: solids, interfaces and their fields in time, for VTK ≥ 9.3 and ParaView ≥ 5.12.
//!
//! The file has two temporal `UnstructuredGrid`s of VTKHDF 2.0 ([`grid`]). VTK reads the first one, and the second
//! one through the file of `sidecar`.
//!
//! ```text
//! /VTKHDF        the solids, hexahedra
//!   PointData/displacement, velocity (if the model has inertia)  [step·node][xyz]
//!   CellData/stress, plastic_strain         [step·element][xx,yy,zz,xy,yz,zx]
//!   CellData/principal_stress               [step·element][3], the largest first
//!   CellData/tensile_damage, compressive_damage, crack_width, yielded     [step·element]
//!   CellData/material, unit, course         [element], the same in every step
//!   FieldData/…    one series per probe, if there are any             [step]
//! /interfaces    quads, the quarter of a slave facet around each contact point, if there are any
//!   PointData/displacement                  [step·corner][xyz]
//!   CellData/opening, damage, state         [step·point]
//!   CellData/slip [step·point][2]   CellData/traction [step·point][normal, two shears]
//!   CellData/facet, law                     [point], the same in every step
//! /history       one series per column of history.csv                 [increment]
//!   beams/…, supports/…, loads/…  forces  [increment][xyz]   frame_increment [step]
//! /model         version, title, materials: names in the order of CellData/material; deck and its hash
//!   units        names in the order of CellData/unit     [unit]
//! ```
//!
//! Readers never see a partly written file (`publication`).

mod about;
pub mod field;
pub mod grid;
mod history;
mod publication;
mod quads;
pub mod read;
mod series;
mod sidecar;
pub mod still;
mod work;

use std::io;
use std::path::Path;

use hdf5_metno as hdf5;

use crate::model::Model;
use crate::state::{Frame, HistoryRow};
use publication::Publication;
use work::WorkFile;

pub use sidecar::path_of as sidecar_of;

/// VTK numbers of cell types.
const HEXAHEDRON: u8 = 12;
const QUAD: u8 = 9;
const VERTEX: u8 = 1;

/// Group of the interfaces in the file.
pub const INTERFACES: &str = "interfaces";

/// Writes `results.vtkhdf` step by step into a work file, which is published as `results.vtkhdf`.
#[derive(Debug)]
pub struct VtkHdfWriter {
    publication: Publication,
    /// `None` after closing or a write error.
    open: Option<WorkFile>,
}

impl VtkHdfWriter {
    /// Creates or replaces the file with the meshes of the model and no steps, and creates the sidecar.
    ///
    /// # Errors
    /// The files cannot be created or written.
    pub fn create(path: &Path, model: &Model) -> io::Result<Self> {
        let publication = Publication::new(path);
        // HDF5 would write through a link.
        crate::files::remove(&publication.work())?;
        let begun = WorkFile::create(&publication.work(), model);
        let mut writer = Self::begin(publication, begun)?;
        writer.publish()?;
        Ok(writer)
    }

    /// Continues the file of a run of this model after the given increment and with at most this number of frames;
    /// later frames and rows are dropped. Readers see the old file until a frame is written.
    ///
    /// # Errors
    /// The file is missing, damaged or of another model, or it cannot be written.
    pub fn reopen(path: &Path, model: &Model, kept: (usize, usize)) -> io::Result<Self> {
        let publication = Publication::new(path);
        if let Err(why) = publication.take_back() {
            publication.abandon();
            return Err(why);
        }
        let begun = WorkFile::open(&publication.work(), model, kept);
        Self::begin(publication, begun)
    }

    fn begin(publication: Publication, begun: hdf5::Result<WorkFile>) -> io::Result<Self> {
        let sidecar = |open: &WorkFile| sidecar::write(publication.path(), open.has_interfaces());
        let begun = begun.map_err(|error| into_io(&error));
        match begun.and_then(|open| sidecar(&open).map(|()| open)) {
            Ok(open) => Ok(Self {
                publication,
                open: Some(open),
            }),
            Err(error) => {
                publication.abandon();
                Err(error)
            }
        }
    }

    /// Stores the text of the deck and its hash.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep_deck(&mut self, text: &str) -> io::Result<()> {
        self.write(|open| open.keep_deck(text))
    }

    /// Adds the row of an increment; it is written with the next frame.
    pub fn row(&mut self, row: &HistoryRow) {
        if let Some(open) = &mut self.open {
            open.row(row);
        }
    }

    /// Appends one step. Readers see it at once if it is the first one or enough time has passed since the last
    /// publication; otherwise with a later step.
    ///
    /// # Errors
    /// A field has a wrong number of rows, which leaves the file unchanged; or the file cannot be written, and
    /// readers keep the steps published before.
    pub fn append(&mut self, frame: &Frame) -> io::Result<()> {
        let fields = self.opened()?.fields(frame);
        let fields = fields.map_err(|why| io::Error::new(io::ErrorKind::InvalidInput, why))?;
        self.write(|open| open.append(frame, &fields))?;
        // The first step is published at once, whatever the copy of the empty file has cost.
        if self.steps() == 1 || self.publication.is_due() {
            self.publication.publish()?;
        }
        Ok(())
    }

    /// Publishes all steps and rows regardless of the time since the last publication, so that they survive a kill.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn publish(&mut self) -> io::Result<()> {
        self.write(WorkFile::flush)?;
        self.publication.publish()
    }

    /// Writes all data and closes the file.
    ///
    /// # Errors
    /// The file cannot be written; readers keep the published data.
    pub fn finish(mut self) -> io::Result<()> {
        self.close()
    }

    /// Number of steps written so far.
    pub fn steps(&self) -> usize {
        self.open.as_ref().map_or(0, WorkFile::steps)
    }

    fn opened(&mut self) -> io::Result<&mut WorkFile> {
        let gone = || io::Error::other("it could not be written before");
        self.open.as_mut().ok_or_else(gone)
    }

    /// Writes to the work file. After an error HDF5 cannot continue with it.
    fn write(&mut self, write: impl FnOnce(&mut WorkFile) -> hdf5::Result<()>) -> io::Result<()> {
        let written = write(self.opened()?).map_err(|error| into_io(&error));
        if written.is_err() {
            self.open = None;
            self.publication.abandon();
        }
        written
    }

    fn close(&mut self) -> io::Result<()> {
        let Some(open) = self.open.take() else {
            return Ok(());
        };
        match open.close() {
            Ok(()) => self.publication.finish(),
            Err(error) => {
                self.publication.abandon();
                Err(into_io(&error))
            }
        }
    }
}

impl Drop for VtkHdfWriter {
    fn drop(&mut self) {
        // Best effort: `finish` reports errors.
        let _ = self.close();
    }
}

/// The error of the system if HDF5 names one ("…, errno = 28, …"), otherwise the message of HDF5.
fn into_io(error: &hdf5::Error) -> io::Error {
    let text = error.to_string();
    let digits = text.split_once("errno = ").map(|(_, rest)| rest);
    let digits = digits.and_then(|rest| rest.split(|c: char| !c.is_ascii_digit()).next());
    match digits.and_then(|digits| digits.parse().ok()) {
        Some(number) if number > 0 => io::Error::from_raw_os_error(number),
        _ => io::Error::other(format!("HDF5: {text}")),
    }
}

#[cfg(test)]
mod tests;
