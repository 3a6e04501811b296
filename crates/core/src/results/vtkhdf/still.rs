//! A file with one grid and one step: `VTKHDF` as in `results.vtkhdf`, without interfaces.

use std::io;
use std::path::Path;

use hdf5_metno as hdf5;

use super::grid::{Column, Geometry, Grid, Meshed, On, Values};
use super::history::{FRAME_INCREMENT, HISTORY};
use super::publication::Publication;
use super::work::labels;
use super::{HEXAHEDRON, VERTEX, about, into_io};
use crate::model::Model;

/// Values of a field, with its name and its unit.
#[derive(Clone, Copy, Debug)]
pub struct StillField<'a> {
    /// Name.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Vectors or numbers at the points.
    pub values: At<'a>,
}

/// Values at points.
#[derive(Clone, Copy, Debug)]
pub enum At<'a> {
    /// `[point][xyz]`
    Vectors(&'a [[f64; 3]]),
    /// `[point]`
    Numbers(&'a [f64]),
}

/// Writes the mesh of a model with fields at its nodes, and material, unit and course of each element.
///
/// # Errors
/// A field has a wrong number of values, or the file cannot be written.
pub fn write_mesh(path: &Path, model: &Model, fields: &[StillField]) -> io::Result<()> {
    let mesh = &model.mesh;
    let ids = mesh.elements.as_flattened().iter();
    let geometry = Geometry {
        points: mesh.nodes.clone(),
        connectivity: ids.map(|n| (*n).into()).collect(),
        corners: 8,
        kind: HEXAHEDRON,
    };
    write(path, model, &geometry, &labels(mesh), fields)
}

/// Writes points [mm] with fields.
///
/// # Errors
/// As [`write_mesh`].
pub fn write_points(
    path: &Path,
    model: &Model,
    points: Vec<[f64; 3]>,
    fields: &[StillField],
) -> io::Result<()> {
    let geometry = Geometry {
        connectivity: (0..points.len() as i64).collect(),
        points,
        corners: 1,
        kind: VERTEX,
    };
    write(path, model, &geometry, &[], fields)
}

fn write(
    path: &Path,
    model: &Model,
    geometry: &Geometry,
    labels: &[(&'static str, Vec<i64>)],
    fields: &[StillField],
) -> io::Result<()> {
    let publication = Publication::new(path);
    // HDF5 would write through a link.
    crate::files::remove(&publication.work())?;
    let columns = fields.iter().map(|field| Column {
        name: field.name,
        on: On::Points,
        components: match field.values {
            At::Vectors(_) => 3,
            At::Numbers(_) => 1,
        },
        unit: field.unit,
    });
    let columns: Vec<Column> = columns.collect();
    let values = fields.iter().map(|field| match field.values {
        At::Vectors(values) => Values::Real(values.as_flattened()),
        At::Numbers(values) => Values::Real(values),
    });
    let values: Vec<Values> = values.collect();
    let written = || -> hdf5::Result<()> {
        let file = hdf5::File::create_excl(publication.work())?;
        about::write(&file, model)?;
        let increments = file.create_group(HISTORY)?.new_dataset::<i64>();
        increments
            .shape(1)
            .create(FRAME_INCREMENT)?
            .write(&[0_i64])?;
        let of = Meshed {
            geometry,
            columns: &columns,
            labels,
            series: &[],
        };
        let mut grid = Grid::create(&file.create_group("VTKHDF")?, &of)?;
        grid.check(&values, &[])?;
        grid.append(0, 0.0, &values, &[])?;
        drop(grid);
        file.close()
    };
    let written = written().map_err(|error| into_io(&error));
    let finished = written.and_then(|()| publication.finish());
    if finished.is_err() {
        publication.abandon();
    }
    finished
}
