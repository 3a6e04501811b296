//! Datasets that grow by one step, and short series with one value per step.

use hdf5_metno as hdf5;
use hdf5_metno::types::VarLenUnicode;
use ndarray::ArrayView2;

use super::grid::Column;

/// Deflate level. Higher levels save a few percent of the size for several times the work.
const DEFLATE: u8 = 1;
/// Values per chunk of a short series. A file has about ninety series, and a small run a few dozen steps.
pub const SERIES_CHUNK: usize = 64;

/// A growing field and the offsets of its steps.
#[derive(Debug)]
pub struct Field {
    /// Values. `[step·tuple][component]`, without the second dimension for scalars.
    pub data: hdf5::Dataset,
    /// First row of each step. `[step]`
    pub offsets: hdf5::Dataset,
    pub tuples: usize,
    pub components: usize,
}

impl Field {
    /// Creates a field of a grid with `tuples` points or cells.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn create(
        data: &hdf5::Group,
        offsets: &hdf5::Group,
        column: &Column,
        tuples: usize,
    ) -> hdf5::Result<Self> {
        let name = column.name;
        let dataset = match column.components {
            0 => compressed::<u8>(data, tuples, 1).shape(0..).create(name)?,
            1 => compressed::<f64>(data, tuples, 1).shape(0..).create(name)?,
            n => compressed::<f64>(data, tuples, n)
                .shape((0.., n))
                .create(name)?,
        };
        mark_unit(&dataset, column.unit)?;
        Ok(Self {
            data: dataset,
            offsets: counts(offsets, name)?,
            tuples,
            components: column.components.max(1),
        })
    }

    /// Opens an existing field and drops everything after its first `steps` steps.
    ///
    /// # Errors
    /// There is no field of that name and shape, or the file cannot be written.
    pub fn open(
        data: &hdf5::Group,
        offsets: &hdf5::Group,
        name: &str,
        (tuples, components): (usize, usize),
        steps: usize,
    ) -> hdf5::Result<Self> {
        let field = Self {
            data: data.dataset(name)?,
            offsets: offsets.dataset(name)?,
            tuples,
            components: components.max(1),
        };
        let rows = steps * tuples;
        match field.data.shape()[..] {
            [there] if field.components == 1 && there >= rows => field.data.resize(rows)?,
            [there, wide] if wide == field.components && wide > 1 && there >= rows => {
                field.data.resize((rows, wide))?;
            }
            ref shape => {
                return Err(format!("{} has the shape {shape:?}", field.data.name()).into());
            }
        }
        cut(&field.offsets, steps)?;
        Ok(field)
    }

    /// Appends the rows of one step.
    ///
    /// # Errors
    /// The number of rows is not that of points or cells, or the file cannot be written.
    pub fn append<T: hdf5::H5Type>(&self, step: usize, values: &[T]) -> hdf5::Result<()> {
        let Self {
            data,
            tuples,
            components,
            ..
        } = self;
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

/// A count in the integer type of VTK; no mesh comes near the limit.
pub fn count(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

/// A compressed dataset with one chunk per step. Shuffling must precede deflation to have an effect.
pub fn compressed<T: hdf5::H5Type>(
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

/// An empty series of counts. `[step]`
pub fn counts(group: &hdf5::Group, name: &str) -> hdf5::Result<hdf5::Dataset> {
    group
        .new_dataset::<i64>()
        .chunk(SERIES_CHUNK)
        .shape(0..)
        .create(name)
}

/// An empty series of numbers. `[step]`
pub fn reals(group: &hdf5::Group, name: &str) -> hdf5::Result<hdf5::Dataset> {
    group
        .new_dataset::<f64>()
        .chunk(SERIES_CHUNK)
        .shape(0..)
        .create(name)
}

/// An empty two-dimensional series of counts. `[step][1]`
pub fn count_column(group: &hdf5::Group, name: &str) -> hdf5::Result<hdf5::Dataset> {
    group
        .new_dataset::<i64>()
        .chunk((SERIES_CHUNK, 1))
        .shape((0.., 1))
        .create(name)
}

/// Writes the value of a step, at most one past the last.
pub fn push<T: hdf5::H5Type>(series: &hdf5::Dataset, step: usize, value: T) -> hdf5::Result<()> {
    series.resize(step + 1)?;
    series.write_slice(&[value], step..step + 1)
}

/// Drops all values after the first `steps`.
pub fn cut(series: &hdf5::Dataset, steps: usize) -> hdf5::Result<()> {
    let mut shape = series.shape();
    if shape.first().is_none_or(|&there| there < steps) {
        let there = shape.first().copied().unwrap_or(0);
        return Err(format!("{} has {there} values, not {steps}", series.name()).into());
    }
    shape[0] = steps;
    series.resize(shape)
}

/// Text of an attribute. Zeros are replaced because HDF5 ends a text there.
pub fn unicode(text: &str) -> hdf5::Result<VarLenUnicode> {
    text.replace('\0', " ")
        .parse()
        .map_err(|_| format!("cannot store {text:?}").into())
}

/// Stores the unit of the values as an attribute.
pub fn mark_unit(dataset: &hdf5::Dataset, unit: &str) -> hdf5::Result<()> {
    let attribute = dataset
        .new_attr::<VarLenUnicode>()
        .shape(())
        .create("unit")?;
    attribute.write_scalar(&unicode(unit)?)
}
