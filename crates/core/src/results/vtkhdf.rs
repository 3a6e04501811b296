//! `results.vtkhdf`: the solids and their fields in time, for VTK ≥ 9.3 and ParaView ≥ 5.12.
//!
//! VTKHDF 2.0, one temporal `UnstructuredGrid`. The mesh does not change, so there is one part
//! whose geometry every step shares at offset 0; of the fields each step appends its own rows:
//!
//! ```text
//! /VTKHDF        Version (2, 0), Type "UnstructuredGrid"
//!   NumberOfPoints, NumberOfCells, NumberOfConnectivityIds   [1]
//!   Points [node][xyz]  Connectivity [8·element]  Offsets [element + 1]  Types [element]
//!   PointData/displacement                  [step·node][xyz]
//!   CellData/stress, plastic_strain         [step·element][xx,yy,zz,xy,yz,zx]
//!   CellData/tensile_damage, compressive_damage              [step·element]
//!   CellData/material, unit, course                          [element], the same in every step
//!   FieldData/…    a column of probes each, if there are any         [step]
//!   Steps          NSteps
//!     Values [step]   PartOffsets, NumberOfParts, PointOffsets [step]
//!     CellOffsets, ConnectivityIdOffsets    [step][1]
//!     PointDataOffsets/…, CellDataOffsets/…, FieldDataOffsets/…         [step]
//!     FieldDataSizes/…                      [step][1, 1]
//! /wythe         version, title, materials: names in the order of CellData/material
//! ```
//!
//! A step is written as data, then offsets, then `NSteps`, then a flush: whatever a run is stopped
//! by, the file holds the steps that `NSteps` counts. Each chunk of the file is one step of one
//! field, so that appending never rewrites an earlier step.

use std::io;
use std::path::Path;

use hdf5_metno as hdf5;
use hdf5_metno::types::{FixedAscii, VarLenUnicode};
use ndarray::ArrayView2;

use super::Frame;
use crate::model::{Mesh, Model};

/// Cell type of VTK's linear hexahedron.
const HEXAHEDRON: u8 = 12;

/// Deflate level: higher ones gain a few percent for several times the work.
const DEFLATE: u8 = 4;

/// Writes `results.vtkhdf` step by step.
#[derive(Debug)]
pub struct VtkHdfWriter {
    file: hdf5::File,
    steps: usize,
    step_count: hdf5::Attribute,
    values: hdf5::Dataset,
    /// Series that are 0 in every step, since there is one part with one geometry. `[series][step]`
    zeros: Vec<hdf5::Dataset>,
    /// As `zeros`, of two dimensions. `[series][step][1]`
    zero_columns: Vec<hdf5::Dataset>,
    /// `NumberOfParts`, 1 in every step. `[step]`
    parts: hdf5::Dataset,
    displacement: Field,
    stress: Field,
    plastic_strain: Field,
    tensile_damage: Field,
    compressive_damage: Field,
    /// Values of the probes and their offsets, one tuple a step. `[probe]`
    probes: Vec<Field>,
    /// Components and tuples of the probes, 1 and 1 in every step. `[probe][step][2]`
    field_sizes: Vec<hdf5::Dataset>,
}

/// One growing field and the offsets of its steps.
#[derive(Debug)]
struct Field {
    /// `[step·tuple][component]`, without the second dimension for scalars.
    data: hdf5::Dataset,
    /// First row of each step. `[step]`
    offsets: hdf5::Dataset,
    tuples: usize,
    components: usize,
}

impl VtkHdfWriter {
    /// Creates (or replaces) the file with the model's mesh and no steps.
    ///
    /// # Errors
    /// The file cannot be created or written.
    pub fn create(path: &Path, model: &Model) -> io::Result<Self> {
        Self::create_hdf(path, model).map_err(|error| into_io(&error))
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
        self.steps
    }

    fn create_hdf(path: &Path, model: &Model) -> hdf5::Result<Self> {
        let file = hdf5::File::create(path)?;
        describe(&file, model)?;
        let root = file.create_group("VTKHDF")?;
        root.new_attr::<i64>()
            .shape(2)
            .create("Version")?
            .write(&[2_i64, 0])?;
        text::<16>(&root, "Type", b"UnstructuredGrid")?;
        write_mesh(&root, &model.mesh)?;

        let steps = root.create_group("Steps")?;
        let step_count = steps.new_attr::<i64>().shape(()).create("NSteps")?;
        step_count.write_scalar(&0_i64)?;
        let zeros = ["PartOffsets", "PointOffsets"].map(|name| series(&steps, name));
        let zero_columns =
            ["CellOffsets", "ConnectivityIdOffsets"].map(|name| column(&steps, name));
        let point_offsets = steps.create_group("PointDataOffsets")?;
        let cell_offsets = steps.create_group("CellDataOffsets")?;
        let points = root.create_group("PointData")?;
        let cells = root.create_group("CellData")?;
        // Vectors and tensors are told from anonymous arrays by their number of components.
        let (nodes, elements) = (model.mesh.nodes.len(), model.mesh.elements.len());
        let cell =
            |name, components| Field::create(&cells, &cell_offsets, name, elements, components);
        let mut writer = Self {
            steps: 0,
            step_count,
            values: real_series(&steps, "Values")?,
            zeros: zeros.into_iter().collect::<hdf5::Result<_>>()?,
            zero_columns: zero_columns.into_iter().collect::<hdf5::Result<_>>()?,
            parts: series(&steps, "NumberOfParts")?,
            displacement: Field::create(&points, &point_offsets, "displacement", nodes, 3)?,
            stress: cell("stress", 6)?,
            plastic_strain: cell("plastic_strain", 6)?,
            tensile_damage: cell("tensile_damage", 1)?,
            compressive_damage: cell("compressive_damage", 1)?,
            probes: Vec::new(),
            field_sizes: Vec::new(),
            file,
        };
        if !model.probes.is_empty() {
            let data = root.create_group("FieldData")?;
            let offsets = steps.create_group("FieldDataOffsets")?;
            let sizes = steps.create_group("FieldDataSizes")?;
            for probe in &model.probes {
                let name = &probe.column;
                let field = Field {
                    data: real_series(&data, name)?,
                    offsets: series(&offsets, name)?,
                    tuples: 1,
                    components: 1,
                };
                writer.probes.push(field);
                let size = sizes.new_dataset::<i64>().chunk((SERIES_CHUNK, 2));
                let size = size.shape((0.., 2)).create(name.as_str())?;
                writer.field_sizes.push(size);
            }
        }
        for (name, values) in labels(&model.mesh) {
            let dataset = compressed::<i64>(&cells, elements, 1);
            dataset.shape(elements).create(name)?.write_raw(&values)?;
            writer.zeros.push(series(&cell_offsets, name)?);
        }
        writer.file.flush()?;
        Ok(writer)
    }

    fn append_hdf(&mut self, frame: &Frame) -> hdf5::Result<()> {
        let step = self.steps;
        self.displacement
            .append(step, frame.displacement.as_flattened())?;
        self.stress.append(step, frame.stress.as_flattened())?;
        self.plastic_strain
            .append(step, frame.plastic_strain.as_flattened())?;
        self.tensile_damage.append(step, &frame.tensile_damage)?;
        self.compressive_damage
            .append(step, &frame.compressive_damage)?;
        if frame.probes.len() != self.probes.len() {
            let (found, wanted) = (frame.probes.len(), self.probes.len());
            return Err(format!("{found} probes where {wanted} belong").into());
        }
        for (field, value) in self.probes.iter().zip(&frame.probes) {
            field.append(step, &[*value])?;
        }
        for size in &self.field_sizes {
            size.resize((step + 1, 2))?;
            size.write_slice(ArrayView2::from(&[[1_i64, 1]]), (step..step + 1, ..))?;
        }
        let fields = [
            &self.displacement,
            &self.stress,
            &self.plastic_strain,
            &self.tensile_damage,
            &self.compressive_damage,
        ];
        for field in fields.into_iter().chain(&self.probes) {
            push(&field.offsets, step, index(step * field.tuples))?;
        }
        for zeros in &self.zeros {
            push(zeros, step, 0_i64)?;
        }
        for column in &self.zero_columns {
            column.resize((step + 1, 1))?;
            column.write_slice(ArrayView2::from(&[[0_i64]]), (step..step + 1, ..))?;
        }
        push(&self.parts, step, 1_i64)?;
        push(&self.values, step, frame.time)?;
        self.step_count.write_scalar(&index(step + 1))?;
        self.file.flush()?;
        self.steps += 1;
        Ok(())
    }
}

impl Field {
    fn create(
        data: &hdf5::Group,
        offsets: &hdf5::Group,
        name: &str,
        tuples: usize,
        components: usize,
    ) -> hdf5::Result<Self> {
        let builder = compressed::<f64>(data, tuples, components);
        let dataset = if components == 1 {
            builder.shape(0..).create(name)?
        } else {
            builder.shape((0.., components)).create(name)?
        };
        Ok(Self {
            data: dataset,
            offsets: series(offsets, name)?,
            tuples,
            components,
        })
    }

    /// Appends the rows of one step. A step that failed half-way is overwritten by the next.
    fn append(&self, step: usize, values: &[f64]) -> hdf5::Result<()> {
        let Self {
            data,
            tuples,
            components,
            ..
        } = self;
        if values.len() != tuples * components {
            let message = format!(
                "{}: {} values where {tuples} rows of {components} belong",
                data.name(),
                values.len()
            );
            return Err(message.into());
        }
        let rows = step * tuples..(step + 1) * tuples;
        if *components == 1 {
            data.resize(rows.end)?;
            data.write_slice(values, rows)
        } else {
            data.resize((rows.end, *components))?;
            let view = ArrayView2::from_shape((*tuples, *components), values)
                .map_err(|error| error.to_string())?;
            data.write_slice(view, (rows, ..))
        }
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

fn write_mesh(root: &hdf5::Group, mesh: &Mesh) -> hdf5::Result<()> {
    let (nodes, elements) = (mesh.nodes.len(), mesh.elements.len());
    let one = |name, count: usize| -> hdf5::Result<()> {
        root.new_dataset::<i64>()
            .shape(1)
            .create(name)?
            .write(&[index(count)])
    };
    one("NumberOfPoints", nodes)?;
    one("NumberOfCells", elements)?;
    one("NumberOfConnectivityIds", 8 * elements)?;
    let points = compressed::<f64>(root, nodes, 3)
        .shape((nodes, 3))
        .create("Points")?;
    points.write_raw(mesh.nodes.as_flattened())?;
    let ids: Vec<i64> = mesh
        .elements
        .as_flattened()
        .iter()
        .map(|&n| i64::from(n))
        .collect();
    let connectivity = compressed::<i64>(root, ids.len(), 1).shape(ids.len());
    connectivity.create("Connectivity")?.write_raw(&ids)?;
    let offsets: Vec<i64> = (0..=elements).map(|e| index(8 * e)).collect();
    root.new_dataset::<i64>()
        .shape(offsets.len())
        .create("Offsets")?
        .write_raw(&offsets)?;
    let types = root.new_dataset::<u8>().shape(elements).create("Types")?;
    types.write_raw(&vec![HEXAHEDRON; elements])
}

/// A count as VTK stores it; no mesh comes near the limit.
fn index(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
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

/// A dataset with one chunk a step. Shuffle before deflate: the other way round it has no use.
fn compressed<T: hdf5::H5Type>(
    group: &hdf5::Group,
    tuples: usize,
    components: usize,
) -> hdf5::DatasetBuilderEmpty {
    let builder = group.new_dataset_builder().shuffle().deflate(DEFLATE);
    let builder = if components == 1 {
        builder.chunk(tuples.max(1))
    } else {
        builder.chunk((tuples.max(1), components))
    };
    builder.empty::<T>()
}

/// Values a chunk of the short series, one value a step, holds.
const SERIES_CHUNK: usize = 256;

fn series(group: &hdf5::Group, name: &str) -> hdf5::Result<hdf5::Dataset> {
    group
        .new_dataset::<i64>()
        .chunk(SERIES_CHUNK)
        .shape(0..)
        .create(name)
}

fn real_series(group: &hdf5::Group, name: &str) -> hdf5::Result<hdf5::Dataset> {
    group
        .new_dataset::<f64>()
        .chunk(SERIES_CHUNK)
        .shape(0..)
        .create(name)
}

fn column(group: &hdf5::Group, name: &str) -> hdf5::Result<hdf5::Dataset> {
    group
        .new_dataset::<i64>()
        .chunk((SERIES_CHUNK, 1))
        .shape((0.., 1))
        .create(name)
}

fn push<T: hdf5::H5Type>(series: &hdf5::Dataset, step: usize, value: T) -> hdf5::Result<()> {
    series.resize(step + 1)?;
    series.write_slice(&[value], step..step + 1)
}

/// A string of fixed length, as VTK wants it; shorter texts are padded.
fn text<const N: usize>(group: &hdf5::Group, name: &str, value: &[u8; N]) -> hdf5::Result<()> {
    let value = FixedAscii::<N>::from_ascii(value).map_err(|error| error.to_string())?;
    group
        .new_attr::<FixedAscii<N>>()
        .shape(())
        .create(name)?
        .write_scalar(&value)
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
        assert_eq!(offsets, [0, index(nodes), index(2 * nodes)]);
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
