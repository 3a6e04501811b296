//! `results.vtkhdf`: the solids, the interfaces and their fields in time, for VTK ≥ 9.3 and
//! ParaView ≥ 5.12.
//!
//! VTKHDF 2.0, two temporal `UnstructuredGrid`s ([`grid`]), of which VTK reads the first:
//!
//! ```text
//! /VTKHDF        the solids, hexahedra
//!   PointData/displacement, velocity (where inertia may act)  [step·node][xyz]
//!   CellData/stress, plastic_strain         [step·element][xx,yy,zz,xy,yz,zx]
//!   CellData/principal_stress               [step·element][3], the largest first
//!   CellData/tensile_damage, compressive_damage, crack_width, yielded     [step·element]
//!   CellData/material, unit, course         [element], the same in every step
//!   FieldData/…    a column of probes each, if there are any         [step]
//! /interfaces    quads, the quarter of a slave facet around each contact point, if there are any
//!   PointData/displacement                  [step·corner][xyz]
//!   CellData/opening, damage, state         [step·point]
//!   CellData/slip [step·point][2]   CellData/traction [step·point][normal, two shears]
//!   CellData/facet, law                     [point], the same in every step
//! /wythe         version, title, materials: names in the order of CellData/material
//! ```
//!
//! Data, offsets, `NSteps`, then a flush: whatever a run is stopped by between two flushes, the file
//! holds the steps that `NSteps` counts.

pub mod grid;
pub(super) mod quarters;
pub mod read;
mod whole;

use std::io;
use std::path::Path;

use hdf5_metno as hdf5;
use hdf5_metno::types::VarLenUnicode;

use super::Frame;
use crate::model::{Mesh, Model};
use grid::{Column, Geometry, Grid, On, Values};
use quarters::Quarters;

/// VTK's kinds of cells.
const HEXAHEDRON: u8 = 12;
const QUAD: u8 = 9;

/// Group of the interfaces in the file.
pub const INTERFACES: &str = "interfaces";

const fn column(name: &'static str, on: On, components: usize) -> Column {
    Column {
        name,
        on,
        components,
    }
}

/// Fields of the solids; the last only where inertia may act.
const SOLIDS: [Column; 9] = [
    column("displacement", On::Points, 3),
    column("stress", On::Cells, 6),
    column("principal_stress", On::Cells, 3),
    column("plastic_strain", On::Cells, 6),
    column("tensile_damage", On::Cells, 1),
    column("compressive_damage", On::Cells, 1),
    column("crack_width", On::Cells, 1),
    column("yielded", On::Cells, 0),
    column("velocity", On::Points, 3),
];

/// Fields of the interfaces.
const SURFACES: [Column; 6] = [
    column("displacement", On::Points, 3),
    column("opening", On::Cells, 1),
    column("slip", On::Cells, 2),
    column("traction", On::Cells, 3),
    column("damage", On::Cells, 1),
    column("state", On::Cells, 0),
];

/// Writes `results.vtkhdf` step by step.
#[derive(Debug)]
pub struct VtkHdfWriter {
    file: hdf5::File,
    solids: Grid,
    interfaces: Option<(Quarters, Grid)>,
    moves: bool,
}

impl VtkHdfWriter {
    /// Creates (or replaces) the file with the model's meshes and no steps.
    ///
    /// # Errors
    /// The file cannot be created or written.
    pub fn create(path: &Path, model: &Model) -> io::Result<Self> {
        Self::create_hdf(path, model).map_err(|error| into_io(&error))
    }

    /// Opens the file of a run of this model, to go on after its first `steps` steps; those after them
    /// are overwritten.
    ///
    /// # Errors
    /// The file is damaged or another model's, has fewer steps, or cannot be written.
    pub fn resume(path: &Path, model: &Model, steps: usize) -> io::Result<Self> {
        if !whole::is_whole(path)? {
            let why = "it was stopped while a frame was being written";
            return Err(io::Error::new(io::ErrorKind::InvalidData, why));
        }
        Self::resume_hdf(path, model, steps).map_err(|error| into_io(&error))
    }

    /// Appends one step, on disk on return.
    ///
    /// # Errors
    /// A field has not as many rows as the mesh has nodes or elements, or the file cannot be
    /// written.
    pub fn append(&mut self, frame: &Frame) -> io::Result<()> {
        self.append_hdf(frame).map_err(|error| into_io(&error))
    }

    /// Steps written so far.
    pub fn steps(&self) -> usize {
        self.solids.steps()
    }

    fn create_hdf(path: &Path, model: &Model) -> hdf5::Result<Self> {
        let file = hdf5::File::create(path)?;
        describe(&file, model)?;
        Self::of_grids(
            file,
            model,
            |file, name, geometry, columns, labels, series| {
                let root = file.create_group(name)?;
                Grid::create(&root, geometry, columns, labels, series)
            },
        )
    }

    fn resume_hdf(path: &Path, model: &Model, steps: usize) -> hdf5::Result<Self> {
        let file = hdf5::File::open_rw(path)?;
        Self::of_grids(
            file,
            model,
            |file, name, geometry, columns, labels, series| {
                let root = file.group(name)?;
                Grid::open(&root, geometry, columns, labels, series, steps)
            },
        )
    }

    /// The grids of a model, each as `grid` makes it in the group of that name.
    fn of_grids(
        file: hdf5::File,
        model: &Model,
        grid: impl Fn(
            &hdf5::File,
            &str,
            &Geometry,
            &[Column],
            &[(&str, Vec<i64>)],
            &[&str],
        ) -> hdf5::Result<Grid>,
    ) -> hdf5::Result<Self> {
        let mesh = &model.mesh;
        let solids = Geometry {
            points: mesh.nodes.clone(),
            connectivity: mesh
                .elements
                .as_flattened()
                .iter()
                .map(|&n| n.into())
                .collect(),
            corners: 8,
            kind: HEXAHEDRON,
        };
        let moves = model.may_move();
        let columns = if moves { &SOLIDS[..] } else { &SOLIDS[..8] };
        let series: Vec<&str> = model.probes.iter().map(|p| p.column.as_str()).collect();
        let solids = grid(&file, "VTKHDF", &solids, columns, &labels(mesh), &series)?;
        let interfaces = match Quarters::of(model) {
            Some(quarters) => {
                let (geometry, labels) = (quarters.geometry(), quarters.labels());
                let grid = grid(&file, INTERFACES, &geometry, &SURFACES, &labels, &[])?;
                Some((quarters, grid))
            }
            None => None,
        };
        file.flush()?;
        Ok(Self {
            file,
            solids,
            interfaces,
            moves,
        })
    }

    fn append_hdf(&mut self, frame: &Frame) -> hdf5::Result<()> {
        // Both grids or neither: the second is written first, and the count of the first is what counts.
        if let Some((quarters, grid)) = &mut self.interfaces {
            let displacement = quarters.spread(&frame.displacement)?;
            let of = &frame.interfaces;
            let state: Vec<u8> = of.state.iter().map(|&s| s as u8).collect();
            let columns = [
                Values::Real(displacement.as_flattened()),
                Values::Real(&of.opening),
                Values::Real(of.slip.as_flattened()),
                Values::Real(of.traction.as_flattened()),
                Values::Real(&of.damage),
                Values::Small(&state),
            ];
            grid.append(self.solids.steps(), frame.time, &columns, &[])?;
        }
        let principal = frame.principal_stresses();
        let yielded: Vec<u8> = frame.yielded.iter().map(|&y| y.into()).collect();
        let columns = [
            Values::Real(frame.displacement.as_flattened()),
            Values::Real(frame.stress.as_flattened()),
            Values::Real(principal.as_flattened()),
            Values::Real(frame.plastic_strain.as_flattened()),
            Values::Real(&frame.tensile_damage),
            Values::Real(&frame.compressive_damage),
            Values::Real(&frame.crack_width),
            Values::Small(&yielded),
            Values::Real(frame.velocity.as_flattened()),
        ];
        let columns = if self.moves {
            &columns[..]
        } else {
            &columns[..8]
        };
        let step = self.solids.steps();
        self.solids
            .append(step, frame.time, columns, &frame.probes)?;
        self.file.flush()
    }
}

/// Title, version and names of the materials, for whoever reads the file without VTK.
fn describe(file: &hdf5::File, model: &Model) -> hdf5::Result<()> {
    let group = file.create_group("wythe")?;
    let unicode = |text: &str| -> hdf5::Result<VarLenUnicode> {
        text.replace('\0', " ")
            .parse()
            .map_err(|_| format!("cannot store {text:?}").into())
    };
    let attribute = |name, text: &str| -> hdf5::Result<()> {
        group
            .new_attr::<VarLenUnicode>()
            .shape(())
            .create(name)?
            .write_scalar(&unicode(text)?)
    };
    attribute("version", env!("CARGO_PKG_VERSION"))?;
    attribute("title", &model.title)?;
    let names: Vec<_> = model
        .materials
        .iter()
        .map(|m| unicode(&m.name))
        .collect::<hdf5::Result<_>>()?;
    group
        .new_attr::<VarLenUnicode>()
        .shape(names.len())
        .create("materials")?
        .write(&names)
}

/// What an element belongs to, under the names of [`Mesh`].
fn labels(mesh: &Mesh) -> [(&'static str, Vec<i64>); 3] {
    [
        (
            "material",
            mesh.material.iter().map(|&m| i64::from(m)).collect(),
        ),
        ("unit", mesh.unit.iter().map(|&u| i64::from(u)).collect()),
        (
            "course",
            mesh.course.iter().map(|&c| i64::from(c)).collect(),
        ),
    ]
}

/// The system's error where HDF5 names one ("…, errno = 28, …"), else what HDF5 says.
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
mod tests {
    use super::*;
    use crate::results::fake;

    #[test]
    fn every_step_reads_back_from_its_own_offset() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let model = fake::model();
        let (nodes, elements) = (model.mesh.nodes.len(), model.mesh.elements.len());
        let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
        let frames: Vec<_> = [0.5, 1.0, 1.5].map(|t| fake::frame(&model, t)).into();
        for frame in &frames {
            writer.append(frame).unwrap();
        }
        assert_eq!(writer.steps(), 3);
        drop(writer);

        let file = hdf5::File::open(&path).unwrap();
        let root = file.group("VTKHDF").unwrap();
        let steps = root.group("Steps").unwrap();
        assert_eq!(
            steps.attr("NSteps").unwrap().read_scalar::<i64>().unwrap(),
            3
        );
        assert_eq!(
            steps.dataset("Values").unwrap().read_raw::<f64>().unwrap(),
            [0.5, 1.0, 1.5]
        );
        let offsets = steps.dataset("PointDataOffsets/displacement").unwrap();
        let offsets = offsets.read_raw::<i64>().unwrap();
        assert_eq!(offsets, [0, nodes as i64, 2 * nodes as i64]);
        let stored = root
            .dataset("PointData/displacement")
            .unwrap()
            .read_raw::<f64>()
            .unwrap();
        let stress = root
            .dataset("CellData/stress")
            .unwrap()
            .read_raw::<f64>()
            .unwrap();
        for (i, frame) in frames.iter().enumerate() {
            assert_eq!(
                &stored[3 * nodes * i..][..3 * nodes],
                frame.displacement.as_flattened()
            );
            assert_eq!(
                &stress[6 * elements * i..][..6 * elements],
                frame.stress.as_flattened()
            );
        }
        let unit = root
            .dataset("CellData/unit")
            .unwrap()
            .read_raw::<i64>()
            .unwrap();
        assert_eq!(unit.len(), elements);
    }

    #[test]
    fn a_file_goes_on_after_the_steps_that_count() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let model = fake::model();
        let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
        for time in [0.5, 1.0, 7.0, 8.0] {
            writer.append(&fake::frame(&model, time)).unwrap();
        }
        drop(writer);
        let mut writer = VtkHdfWriter::resume(&path, &model, 2).unwrap();
        let times = || read::FieldsFile::open(&path).unwrap().times().to_vec();
        assert_eq!(times(), [0.5, 1.0]);
        writer.append(&fake::frame(&model, 1.5)).unwrap();
        drop(writer);
        assert_eq!(times(), [0.5, 1.0, 1.5]);
        let file = read::FieldsFile::open(&path).unwrap();
        for (i, time) in [0.5, 1.0, 1.5].into_iter().enumerate() {
            let (read, frame) = (file.frame(i).unwrap(), fake::frame(&model, time));
            assert_eq!(read.displacement, frame.displacement);
            assert_eq!(read.interfaces, frame.interfaces);
        }
        drop(file);
        let error = VtkHdfWriter::resume(&path, &model, 4).unwrap_err();
        assert!(error.to_string().contains("3 steps, not 4"), "{error}");
        std::fs::write(&path, "no HDF5").unwrap();
        assert!(VtkHdfWriter::resume(&path, &model, 1).is_err());
    }

    #[test]
    fn a_frame_of_another_mesh_is_refused_and_leaves_the_steps_as_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let model = fake::model();
        let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
        writer.append(&fake::frame(&model, 1.0)).unwrap();
        let mut wrong = fake::frame(&model, 2.0);
        wrong.stress.pop();
        let error = writer.append(&wrong).unwrap_err().to_string();
        assert!(error.contains("stress"), "{error}");
        // The next whole frame takes its place.
        writer.append(&fake::frame(&model, 3.0)).unwrap();
        drop(writer);
        let file = hdf5::File::open(&path).unwrap();
        let values = file
            .dataset("VTKHDF/Steps/Values")
            .unwrap()
            .read_raw::<f64>()
            .unwrap();
        assert_eq!(values, [1.0, 3.0]);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_error_of_the_system_comes_through() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/results.vtkhdf");
        let error = VtkHdfWriter::create(&path, &fake::model()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound, "{error}");
        let path = folder.path().join("results.vtkhdf");
        std::os::unix::fs::symlink("/dev/full", &path).unwrap();
        let error = VtkHdfWriter::create(&path, &fake::model()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull, "{error}");
    }

    #[test]
    fn a_copy_taken_without_closing_is_readable() {
        // What a killed run leaves is the file as of the last flush.
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let model = fake::model();
        let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
        writer.append(&fake::frame(&model, 1.0)).unwrap();
        let killed = folder.path().join("killed.vtkhdf");
        std::fs::copy(&path, &killed).unwrap();
        let file = hdf5::File::open(&killed).unwrap();
        let count = file.group("VTKHDF/Steps").unwrap().attr("NSteps").unwrap();
        assert_eq!(count.read_scalar::<i64>().unwrap(), 1);
        let read = file
            .dataset("VTKHDF/PointData/displacement")
            .unwrap()
            .read_raw::<f64>();
        assert_eq!(
            read.unwrap(),
            fake::frame(&model, 1.0).displacement.as_flattened()
        );
    }
}
