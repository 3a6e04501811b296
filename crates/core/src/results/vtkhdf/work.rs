//! The open HDF5 file: two grids, the history and the model.

use std::path::Path;

use hdf5_metno as hdf5;

use super::grid::{Column, Geometry, Grid, Meshed, On, Values};
use super::history::{self, History};
use super::quads::Quarters;
use super::{HEXAHEDRON, INTERFACES, about};
use crate::model::{Mesh, Model};
use crate::state::{Frame, HistoryRow};

const fn column(name: &'static str, on: On, components: usize, unit: &'static str) -> Column {
    Column {
        name,
        on,
        components,
        unit,
    }
}

/// Fields of the solids; the last one only if the model has inertia.
pub(super) const SOLIDS: [Column; 9] = [
    column("displacement", On::Points, 3, "mm"),
    column("stress", On::Cells, 6, "MPa"),
    column("principal_stress", On::Cells, 3, "MPa"),
    column("plastic_strain", On::Cells, 6, "1"),
    column("tensile_damage", On::Cells, 1, "1"),
    column("compressive_damage", On::Cells, 1, "1"),
    column("crack_width", On::Cells, 1, "mm"),
    column("yielded", On::Cells, 0, "1"),
    column("velocity", On::Points, 3, "mm/s"),
];

/// Fields of the interfaces.
const SURFACES: [Column; 6] = [
    column("displacement", On::Points, 3, "mm"),
    column("opening", On::Cells, 1, "mm"),
    column("slip", On::Cells, 2, "mm"),
    column("traction", On::Cells, 3, "MPa"),
    column("damage", On::Cells, 1, "1"),
    column("state", On::Cells, 0, "1"),
];

/// The work file. Field order matters: parts drop before the file, which closes after its last reference.
#[derive(Debug)]
pub struct WorkFile {
    solids: Grid,
    interfaces: Option<(Quarters, Grid)>,
    history: History,
    moves: bool,
    file: hdf5::File,
}

/// Fields of a frame that need conversion for the file.
pub struct Fields {
    principal_stress: Vec<[f64; 3]>,
    yielded: Vec<u8>,
    /// Displacement of the interface corners [mm]. `[corner][xyz]`
    displacement: Vec<[f64; 3]>,
    state: Vec<u8>,
}

impl WorkFile {
    /// Creates a file with the meshes of the model and no steps; it is on the disk on return.
    ///
    /// # Errors
    /// The file exists or cannot be written.
    pub fn create(path: &Path, model: &Model) -> hdf5::Result<Self> {
        let file = hdf5::File::create_excl(path)?;
        about::write(&file, model)?;
        let history = History::create(&file, model)?;
        Self::with(file, history, model, |file, name, of| {
            Grid::create(&file.create_group(name)?, of)
        })
    }

    /// Opens the file of a run of this model to continue after an increment; later data are dropped.
    ///
    /// # Errors
    /// The file cannot be read or written, or it is of another model.
    pub fn open(path: &Path, model: &Model, kept: (usize, usize)) -> hdf5::Result<Self> {
        let file = hdf5::File::open_rw(path)?;
        let frames = history::frames_until(&file, kept.0)?.min(kept.1);
        let history = History::open(&file, model, (kept.0, frames))?;
        Self::with(file, history, model, |file, name, of| {
            Grid::open(&file.group(name)?, of, frames)
        })
    }

    /// Sets up both grids of a model; `grid` creates or opens each one in the group of the given name.
    fn with(
        file: hdf5::File,
        history: History,
        model: &Model,
        grid: impl Fn(&hdf5::File, &str, &Meshed) -> hdf5::Result<Grid>,
    ) -> hdf5::Result<Self> {
        let mesh = &model.mesh;
        let ids = mesh.elements.as_flattened();
        let moves = model.may_move();
        let columns = model.columns();
        let series: Vec<&str> = columns.iter().map(String::as_str).collect();
        let outputs = model.outputs().into_iter();
        let outputs = outputs.map(|o| column(o.name, On::Cells, 1, o.unit));
        let columns_of_solids: Vec<Column> = present(&SOLIDS, moves)
            .iter()
            .copied()
            .chain(outputs)
            .collect();
        let solids = Meshed {
            geometry: &Geometry {
                points: mesh.nodes.clone(),
                connectivity: ids.iter().map(|&n| n.into()).collect(),
                corners: 8,
                kind: HEXAHEDRON,
            },
            columns: &columns_of_solids,
            labels: &labels(mesh),
            series: &series,
        };
        let solids = grid(&file, "VTKHDF", &solids)?;
        let interfaces = match Quarters::of(model) {
            Some(quarters) => {
                let further = model.contact.outputs().into_iter();
                let further = further.map(|output| column(output.name, On::Cells, 1, output.unit));
                let columns: Vec<Column> = SURFACES.into_iter().chain(further).collect();
                let surfaces = Meshed {
                    geometry: &quarters.geometry(),
                    columns: &columns,
                    labels: &quarters.labels(),
                    series: &[],
                };
                let grid = grid(&file, INTERFACES, &surfaces)?;
                Some((quarters, grid))
            }
            None => None,
        };
        file.flush()?;
        Ok(Self {
            solids,
            interfaces,
            history,
            moves,
            file,
        })
    }

    /// Number of steps written so far.
    pub fn steps(&self) -> usize {
        self.solids.steps()
    }

    /// Whether the model has interfaces.
    pub fn has_interfaces(&self) -> bool {
        self.interfaces.is_some()
    }

    /// Stores the text of the deck.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep_deck(&self, text: &str) -> hdf5::Result<()> {
        about::write_deck(&self.file, text)
    }

    /// Adds the row of an increment.
    pub fn row(&mut self, row: &HistoryRow) {
        self.history.push(row);
    }

    /// Converts the fields of a frame and checks them; nothing is written.
    ///
    /// # Errors
    /// The frame does not fit the meshes.
    pub fn fields(&self, frame: &Frame) -> Result<Fields, String> {
        let mut fields = Fields {
            principal_stress: frame.principal_stresses(),
            yielded: frame.yielded.iter().map(|&y| y.into()).collect(),
            displacement: Vec::new(),
            state: frame.interfaces.state.iter().map(|&s| s as u8).collect(),
        };
        if let Some((quarters, grid)) = &self.interfaces {
            fields.displacement = quarters.spread(&frame.displacement)?;
            grid.check(&fields.of_surfaces(frame), &[])?;
        }
        let solids = fields.of_solids(frame, self.moves);
        self.solids.check(&solids, &frame.probes)?;
        Ok(fields)
    }

    /// Appends a step; it is on the disk on return.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn append(&mut self, frame: &Frame, fields: &Fields) -> hdf5::Result<()> {
        let (step, time) = (self.solids.steps(), frame.time);
        if let Some((_, grid)) = &mut self.interfaces {
            grid.append(step, time, &fields.of_surfaces(frame), &[])?;
        }
        let solids = fields.of_solids(frame, self.moves);
        self.solids.append(step, time, &solids, &frame.probes)?;
        self.history.frame(step, frame.increment)?;
        self.flush()
    }

    /// Writes all pending rows and the buffers of HDF5.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn flush(&mut self) -> hdf5::Result<()> {
        self.history.write()?;
        self.file.flush()
    }

    /// Writes all data and closes the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn close(mut self) -> hdf5::Result<()> {
        self.flush()?;
        let file = self.file;
        drop((self.solids, self.interfaces, self.history));
        file.close()
    }
}

impl Fields {
    /// Values in the order of [`SOLIDS`], then those of the outputs.
    fn of_solids<'a>(&'a self, frame: &'a Frame, moves: bool) -> Vec<Values<'a>> {
        let solids = [
            Values::Real(frame.displacement.as_flattened()),
            Values::Real(frame.stress.as_flattened()),
            Values::Real(self.principal_stress.as_flattened()),
            Values::Real(frame.plastic_strain.as_flattened()),
            Values::Real(&frame.tensile_damage),
            Values::Real(&frame.compressive_damage),
            Values::Real(&frame.crack_width),
            Values::Small(&self.yielded),
            Values::Real(frame.velocity.as_flattened()),
        ];
        let outputs = frame.outputs.iter().map(|of| Values::Real(&of.values));
        let solids = present(&solids, moves).iter().copied();
        solids.chain(outputs).collect()
    }

    /// Values in the order of [`SURFACES`], then the outputs of the laws.
    fn of_surfaces<'a>(&'a self, frame: &'a Frame) -> Vec<Values<'a>> {
        let of = &frame.interfaces;
        let mut values = vec![
            Values::Real(self.displacement.as_flattened()),
            Values::Real(&of.opening),
            Values::Real(of.slip.as_flattened()),
            Values::Real(of.traction.as_flattened()),
            Values::Real(&of.damage),
            Values::Small(&self.state),
        ];
        let further = of.outputs.iter();
        values.extend(further.map(|output| Values::Real(&output.values)));
        values
    }
}

/// All fields of the solids, without the velocity if the model has no inertia.
fn present<T>(solids: &[T; SOLIDS.len()], moves: bool) -> &[T] {
    &solids[..SOLIDS.len() - usize::from(!moves)]
}

/// Labels of the elements, with the names used in [`Mesh`].
pub(super) fn labels(mesh: &Mesh) -> [(&'static str, Vec<i64>); 3] {
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
