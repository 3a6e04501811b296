//! A temporal `UnstructuredGrid` of VTKHDF 2.0 in a group of a file.
//!
//! The mesh does not change, so one part with one geometry serves all steps at offset 0. Each step appends its own
//! rows to the fields as one chunk, and earlier steps are never rewritten. A step is written in the order data,
//! offsets, `NSteps`, so that an incomplete step is not counted.

use hdf5_metno as hdf5;
use hdf5_metno::types::FixedAscii;
use ndarray::ArrayView2;

use super::series::{
    Field, SERIES_CHUNK, compressed, count, count_column, counts, cut, push, reals,
};

/// Geometry of a grid with cells of one type.
#[derive(Debug)]
pub struct Geometry {
    /// Positions at rest [mm]. `[point][xyz]`
    pub points: Vec<[f64; 3]>,
    /// Points of the cells, cell by cell. `[cell][corner]`
    pub connectivity: Vec<i64>,
    /// Corners per cell.
    pub corners: usize,
    /// VTK number of the cell type.
    pub kind: u8,
}

impl Geometry {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.connectivity.len() / self.corners.max(1)
    }
}

/// Location of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    /// Points.
    Points,
    /// Cells.
    Cells,
}

/// A field that changes from step to step.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Name.
    pub name: &'static str,
    /// Location of its values.
    pub on: On,
    /// Number of components; 0 marks a scalar field of small integers.
    pub components: usize,
    /// Unit of its values.
    pub unit: &'static str,
}

impl Column {
    /// Number of tuples and of components per step.
    fn shape(&self, geometry: &Geometry) -> (usize, usize) {
        let tuples = match self.on {
            On::Points => geometry.points.len(),
            On::Cells => geometry.cells(),
        };
        (tuples, self.components.max(1))
    }
}

/// Values of one field at one step.
#[derive(Clone, Copy, Debug)]
pub enum Values<'a> {
    /// `[tuple][component]`
    Real(&'a [f64]),
    /// `[tuple]`
    Small(&'a [u8]),
}

impl Values<'_> {
    fn len(self) -> usize {
        match self {
            Self::Real(values) => values.len(),
            Self::Small(values) => values.len(),
        }
    }
}

/// Description of a grid.
pub struct Meshed<'a> {
    /// Points and cells.
    pub geometry: &'a Geometry,
    /// Fields.
    pub columns: &'a [Column],
    /// Numbers of the cells by name. `[label](name, [cell])`
    pub labels: &'a [(&'static str, Vec<i64>)],
    /// Names of the series with one value per step.
    pub series: &'a [&'a str],
}

/// Series that are 0 in every step, of one dimension and of two dimensions.
const ZEROS: [&str; 2] = ["PartOffsets", "PointOffsets"];
const ZERO_COLUMNS: [&str; 2] = ["CellOffsets", "ConnectivityIdOffsets"];

/// Writes a grid step by step.
#[derive(Debug)]
pub struct Grid {
    steps: usize,
    step_count: hdf5::Attribute,
    values: hdf5::Dataset,
    /// Series that are 0 in every step because there is one part with one geometry. `[series][step]`
    zeros: Vec<hdf5::Dataset>,
    /// The same with two dimensions. `[series][step][1]`
    zero_columns: Vec<hdf5::Dataset>,
    /// `NumberOfParts`, 1 in every step. `[step]`
    parts: hdf5::Dataset,
    fields: Vec<Field>,
    /// Series with one value per step. `[series]`
    series: Vec<Field>,
    /// Numbers of components and tuples of the series, 1 and 1 in every step. `[series][step][2]`
    series_sizes: Vec<hdf5::Dataset>,
}

impl Grid {
    /// Writes geometry and labels into an empty group and creates the fields and the series.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn create(root: &hdf5::Group, of: &Meshed<'_>) -> hdf5::Result<Self> {
        write_kind(root)?;
        write_geometry(root, of.geometry)?;
        let steps = root.create_group("Steps")?;
        let step_count = steps.new_attr::<i64>().shape(()).create("NSteps")?;
        step_count.write_scalar(&0_i64)?;
        let zeros = ZEROS.map(|name| counts(&steps, name));
        let zero_columns = ZERO_COLUMNS.map(|name| count_column(&steps, name));
        let (points, cells) = (
            root.create_group("PointData")?,
            root.create_group("CellData")?,
        );
        let point_offsets = steps.create_group("PointDataOffsets")?;
        let cell_offsets = steps.create_group("CellDataOffsets")?;
        let mut grid = Self {
            steps: 0,
            step_count,
            values: reals(&steps, "Values")?,
            zeros: zeros.into_iter().collect::<hdf5::Result<_>>()?,
            zero_columns: zero_columns.into_iter().collect::<hdf5::Result<_>>()?,
            parts: counts(&steps, "NumberOfParts")?,
            fields: Vec::new(),
            series: Vec::new(),
            series_sizes: Vec::new(),
        };
        for column in of.columns {
            let (data, offsets) = match column.on {
                On::Points => (&points, &point_offsets),
                On::Cells => (&cells, &cell_offsets),
            };
            let (tuples, _) = column.shape(of.geometry);
            grid.fields
                .push(Field::create(data, offsets, column, tuples)?);
        }
        for (name, values) in of.labels {
            let builder = compressed::<i64>(&cells, values.len(), 1);
            builder
                .shape(values.len())
                .create(*name)?
                .write_raw(values)?;
            grid.zeros.push(counts(&cell_offsets, name)?);
        }
        if !of.series.is_empty() {
            grid.create_series(root, &steps, of.series)?;
        }
        Ok(grid)
    }

    fn create_series(
        &mut self,
        root: &hdf5::Group,
        steps: &hdf5::Group,
        names: &[&str],
    ) -> hdf5::Result<()> {
        let data = root.create_group("FieldData")?;
        let offsets = steps.create_group("FieldDataOffsets")?;
        let sizes = steps.create_group("FieldDataSizes")?;
        for name in names {
            self.series.push(Field {
                data: reals(&data, name)?,
                offsets: counts(&offsets, name)?,
                tuples: 1,
                components: 1,
            });
            let size = sizes.new_dataset::<i64>().chunk((SERIES_CHUNK, 2));
            self.series_sizes.push(size.shape((0.., 2)).create(*name)?);
        }
        Ok(())
    }

    /// Opens a grid written by [`Grid::create`] and drops everything after its first `steps` steps.
    ///
    /// # Errors
    /// The file cannot be read or written, or it has another grid.
    pub fn open(root: &hdf5::Group, of: &Meshed<'_>, steps: usize) -> hdf5::Result<Self> {
        let Meshed {
            geometry,
            columns,
            labels,
            series,
        } = *of;
        let ids = root.dataset("Connectivity")?.read_raw::<i64>()?;
        let points = root.dataset("Points")?.shape();
        if ids != geometry.connectivity || points != [geometry.points.len(), 3] {
            return Err(format!("{} is the mesh of another model", root.name()).into());
        }
        let group = root.group("Steps")?;
        let step_count = group.attr("NSteps")?;
        let written: i64 = step_count.read_scalar()?;
        if written < count(steps) {
            return Err(format!("{} has {written} steps, not {steps}", root.name()).into());
        }
        // The step count is reduced before the data are cut, because readers rely on it.
        step_count.write_scalar(&count(steps))?;
        let field = |kind: &str, name: &str, shape| {
            let offsets = group.group(&format!("{kind}Offsets"))?;
            Field::open(&root.group(kind)?, &offsets, name, shape, steps)
        };
        let series_of = |name: &str| {
            let series = group.dataset(name)?;
            cut(&series, steps).map(|()| series)
        };
        let all = |names: &mut dyn Iterator<Item = String>| -> hdf5::Result<Vec<_>> {
            names.map(|name| series_of(&name)).collect()
        };
        let of_labels = labels.iter().map(|(l, _)| format!("CellDataOffsets/{l}"));
        let mut sizes = series.iter().map(|name| format!("FieldDataSizes/{name}"));
        let of_column = |column: &Column| {
            let kind = match column.on {
                On::Points => "PointData",
                On::Cells => "CellData",
            };
            field(kind, column.name, column.shape(geometry))
        };
        Ok(Self {
            steps,
            values: series_of("Values")?,
            zeros: all(&mut ZEROS.into_iter().map(str::to_owned).chain(of_labels))?,
            zero_columns: all(&mut ZERO_COLUMNS.into_iter().map(str::to_owned))?,
            parts: series_of("NumberOfParts")?,
            fields: columns.iter().map(of_column).collect::<hdf5::Result<_>>()?,
            series: series
                .iter()
                .map(|name| field("FieldData", name, (1, 1)))
                .collect::<hdf5::Result<_>>()?,
            series_sizes: all(&mut sizes)?,
            step_count,
        })
    }

    /// Checks the sizes of the values of a step; nothing is written.
    ///
    /// # Errors
    /// A field has a wrong number of rows.
    pub fn check(&self, columns: &[Values], series: &[f64]) -> Result<(), String> {
        if series.len() != self.series.len() {
            let (found, wanted) = (series.len(), self.series.len());
            return Err(format!("{found} probes where {wanted} belong"));
        }
        if columns.len() != self.fields.len() {
            let (found, wanted) = (columns.len(), self.fields.len());
            return Err(format!("{found} fields where {wanted} belong"));
        }
        for (field, values) in self.fields.iter().zip(columns) {
            let (tuples, components) = (field.tuples, field.components);
            if values.len() != tuples * components {
                let (name, found) = (field.data.name(), values.len());
                return Err(format!(
                    "{name}: {found} values where {tuples} rows of {components} belong"
                ));
            }
        }
        Ok(())
    }

    /// Number of steps written so far.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Writes step `step`, at most one past the last. Columns and series are in the order of creation and have passed
    /// [`Grid::check`].
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn append(
        &mut self,
        step: usize,
        time: f64,
        columns: &[Values],
        series: &[f64],
    ) -> hdf5::Result<()> {
        for (field, values) in self.fields.iter().zip(columns) {
            match values {
                Values::Real(values) => field.append(step, values)?,
                Values::Small(values) => field.append(step, values)?,
            }
        }
        for (field, value) in self.series.iter().zip(series) {
            field.append(step, &[*value])?;
        }
        for size in &self.series_sizes {
            size.resize((step + 1, 2))?;
            size.write_slice(ArrayView2::from(&[[1_i64, 1]]), (step..step + 1, ..))?;
        }
        for field in self.fields.iter().chain(&self.series) {
            push(&field.offsets, step, count(step * field.tuples))?;
        }
        for zeros in &self.zeros {
            push(zeros, step, 0_i64)?;
        }
        for column in &self.zero_columns {
            column.resize((step + 1, 1))?;
            column.write_slice(ArrayView2::from(&[[0_i64]]), (step..step + 1, ..))?;
        }
        push(&self.parts, step, 1_i64)?;
        push(&self.values, step, time)?;
        self.step_count.write_scalar(&count(step + 1))?;
        self.steps = step + 1;
        Ok(())
    }
}

/// Writes the version and type of an unstructured grid.
fn write_kind(root: &hdf5::Group) -> hdf5::Result<()> {
    root.new_attr::<i64>()
        .shape(2)
        .create("Version")?
        .write(&[2_i64, 0])?;
    let kind = FixedAscii::<16>::from_ascii(b"UnstructuredGrid");
    root.new_attr::<FixedAscii<16>>()
        .shape(())
        .create("Type")?
        .write_scalar(&kind.map_err(|error| error.to_string())?)
}

fn write_geometry(root: &hdf5::Group, geometry: &Geometry) -> hdf5::Result<()> {
    let (points, cells) = (geometry.points.len(), geometry.cells());
    let one = |name, value: usize| -> hdf5::Result<()> {
        root.new_dataset::<i64>()
            .shape(1)
            .create(name)?
            .write(&[count(value)])
    };
    one("NumberOfPoints", points)?;
    one("NumberOfCells", cells)?;
    one("NumberOfConnectivityIds", geometry.connectivity.len())?;
    compressed::<f64>(root, points, 3)
        .shape((points, 3))
        .create("Points")?
        .write_raw(geometry.points.as_flattened())?;
    let ids = &geometry.connectivity;
    compressed::<i64>(root, ids.len(), 1)
        .shape(ids.len())
        .create("Connectivity")?
        .write_raw(ids)?;
    let offsets: Vec<i64> = (0..=cells).map(|c| count(geometry.corners * c)).collect();
    root.new_dataset::<i64>()
        .shape(offsets.len())
        .create("Offsets")?
        .write_raw(&offsets)?;
    let types = root.new_dataset::<u8>().shape(cells).create("Types")?;
    types.write_raw(&vec![geometry.kind; cells])
}
