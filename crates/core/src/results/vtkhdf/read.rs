//! Reads `results.vtkhdf` frame by frame.

use std::io;
use std::path::{Path, PathBuf};

use hdf5_metno as hdf5;
use hdf5_metno::types::VarLenUnicode;

use super::about::{self, MODEL, UNITS};
use super::field::{LABELS, Values};
use super::history::{self, FRAME_INCREMENT, HISTORY};
use super::work::SOLIDS;
use super::{INTERFACES, into_io, publication};
use crate::model::Model;
use crate::state::{Frame, HistoryRow, InterfaceFrame, InterfaceState, OutputField};

/// Fields of the interfaces in every file.
const OF_EVERY_LAW: [&str; 7] = [
    "opening", "slip", "traction", "damage", "state", "facet", "law",
];

/// The solids at rest with the labels of their elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestMesh {
    /// Positions [mm]. `[node][xyz]`
    pub nodes: Vec<[f64; 3]>,
    /// Nodes of the hexahedra. `[element]`
    pub elements: Vec<[u32; 8]>,
    /// Index into the names of the materials. `[element]`
    pub material: Vec<u16>,
    /// Unit (body). `[element]`
    pub unit: Vec<u32>,
    /// Course. `[element]`
    pub course: Vec<u16>,
}

/// Interface quads at rest, one around each contact point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestSurface {
    /// Positions [mm]. `[corner][xyz]`
    pub points: Vec<[f64; 3]>,
    /// Corners of the quads. `[point]`
    pub quads: Vec<[u32; 4]>,
}

/// An open field file. Frames are read on request.
#[derive(Debug)]
pub struct FieldsFile {
    path: PathBuf,
    file: hdf5::File,
    room: Room,
    times: Vec<f64>,
    /// Increment of each frame. `[frame]`
    increments: Vec<usize>,
}

impl FieldsFile {
    /// Opens a file. During a run, or after it was killed, the file has the frames published so far.
    ///
    /// # Errors
    /// The file is missing, was changed since it was written, or has no fields of wythe.
    pub fn open(path: &Path) -> io::Result<Self> {
        // HDF5 does not verify its input and reports errors at length, so the check sum comes first.
        publication::check(path)?;
        let length = std::fs::metadata(path)?.len();
        let open = || -> hdf5::Result<Self> {
            let file = hdf5::File::open(path)?;
            let room = Room { length };
            let steps = file.group("VTKHDF/Steps")?;
            let count: i64 = steps.attr("NSteps")?.read_scalar()?;
            let mut times: Vec<f64> = room.all(&steps.dataset("Values")?)?;
            times.truncate(usize::try_from(count).unwrap_or(0));
            let increments = file.group(HISTORY)?.dataset(FRAME_INCREMENT)?;
            Ok(Self {
                path: path.to_owned(),
                increments: whole(&room.all::<i64>(&increments)?)?,
                room,
                file,
                times,
            })
        };
        open().map_err(|error| into_io(&error))
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Step time of each frame [s].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Increment of each frame.
    pub fn increments(&self) -> &[usize] {
        &self.increments
    }

    /// First `count` rows of the history with the columns of `model`, without reactions.
    ///
    /// # Errors
    /// The rows are missing or cannot be read.
    pub fn rows(&self, model: &Model, count: usize) -> io::Result<Vec<HistoryRow>> {
        history::read(&self.file, model, count).map_err(|error| into_io(&error))
    }

    /// External forces on beams, supports and loads at every increment [N], by their paths in the history, such as
    /// `supports/bottom`. `[increment][xyz]`
    ///
    /// # Errors
    /// They cannot be read.
    pub fn reactions(&self) -> io::Result<Vec<(String, Vec<[f64; 3]>)>> {
        let read = || -> hdf5::Result<Vec<(String, Vec<[f64; 3]>)>> {
            let history = self.file.group(HISTORY)?;
            let mut all = Vec::new();
            for group in ["beams", "supports", "loads"] {
                if !history.link_exists(group) {
                    continue;
                }
                for name in history.group(group)?.member_names()? {
                    let path = format!("{group}/{name}");
                    let forces = rows(&self.room.all(&history.dataset(&path)?)?)?;
                    all.push((path, forces));
                }
            }
            Ok(all)
        };
        read().map_err(|error| into_io(&error))
    }

    /// Title of the model and version of the program.
    ///
    /// # Errors
    /// The attributes cannot be read.
    pub fn title_and_version(&self) -> io::Result<(String, String)> {
        let read = |name: &str| -> hdf5::Result<String> {
            let text: VarLenUnicode = self.file.group(MODEL)?.attr(name)?.read_scalar()?;
            Ok(text.to_string())
        };
        let both = || Ok((read("title")?, read("version")?));
        both().map_err(|error: hdf5::Error| into_io(&error))
    }

    /// Text of the deck and its hash; `None` for a run without a deck.
    ///
    /// # Errors
    /// The data cannot be read, or the hash does not match the text.
    pub fn deck(&self) -> io::Result<Option<(String, String)>> {
        let read = || -> hdf5::Result<Option<(String, String)>> {
            let group = self.file.group(MODEL)?;
            if !group.link_exists(about::DECK) {
                return Ok(None);
            }
            let text: VarLenUnicode = group.dataset(about::DECK)?.read_scalar()?;
            let hash: VarLenUnicode = group.attr("hash")?.read_scalar()?;
            if about::hash(&text) != hash.as_str() {
                return Err("the deck has been changed: its hash is another".into());
            }
            Ok(Some((text.to_string(), hash.to_string())))
        };
        read().map_err(|error| into_io(&error))
    }

    /// Names of the materials.
    ///
    /// # Errors
    /// The names cannot be read.
    pub fn materials(&self) -> io::Result<Vec<String>> {
        let read = || -> hdf5::Result<Vec<String>> {
            let names = self.file.group(MODEL)?.attr("materials")?;
            self.room.holds(&names.name(), names.size(), Some(8))?;
            let names = names.read_raw::<VarLenUnicode>()?;
            Ok(names.iter().map(ToString::to_string).collect())
        };
        read().map_err(|error| into_io(&error))
    }

    /// Names of the units; empty in files of versions that did not write them.
    ///
    /// # Errors
    /// The names cannot be read.
    pub fn units(&self) -> io::Result<Vec<String>> {
        let read = || -> hdf5::Result<Vec<String>> {
            let group = self.file.group(MODEL)?;
            if !group.link_exists(UNITS) {
                return Ok(Vec::new());
            }
            let names = self.room.all::<VarLenUnicode>(&group.dataset(UNITS)?)?;
            Ok(names.iter().map(ToString::to_string).collect())
        };
        read().map_err(|error| into_io(&error))
    }

    /// The solids at rest.
    ///
    /// # Errors
    /// The data cannot be read.
    pub fn mesh(&self) -> io::Result<RestMesh> {
        let read = || -> hdf5::Result<RestMesh> {
            let root = self.file.group("VTKHDF")?;
            let all = |name: &str| self.room.all::<i64>(&root.dataset(name)?);
            let label = |name: &str| all(&format!("CellData/{name}"));
            Ok(RestMesh {
                nodes: rows(&self.room.all(&root.dataset("Points")?)?)?,
                elements: rows(&whole(&all("Connectivity")?)?)?,
                material: whole(&label("material")?)?,
                unit: whole(&label("unit")?)?,
                course: whole(&label("course")?)?,
            })
        };
        read().map_err(|error| into_io(&error))
    }

    /// Interface quads at rest; empty if the model has no interfaces.
    ///
    /// # Errors
    /// The data cannot be read.
    pub fn surface(&self) -> io::Result<RestSurface> {
        let read = || -> hdf5::Result<RestSurface> {
            if !self.file.link_exists(INTERFACES) {
                return Ok(RestSurface::default());
            }
            let root = self.file.group(INTERFACES)?;
            Ok(RestSurface {
                points: rows(&self.room.all(&root.dataset("Points")?)?)?,
                quads: rows(&whole(&self.room.all(&root.dataset("Connectivity")?)?)?)?,
            })
        };
        read().map_err(|error| into_io(&error))
    }

    /// Displacement of the corners of the interface quads at a frame [mm]. `[corner][xyz]`
    ///
    /// # Errors
    /// The frame does not exist or cannot be read.
    pub fn surface_displacement(&self, frame: usize) -> io::Result<Vec<[f64; 3]>> {
        if !self.file.link_exists(INTERFACES) {
            return Ok(Vec::new());
        }
        let name = format!("{INTERFACES}/PointData/displacement");
        self.step(frame, &name).map_err(|error| into_io(&error))
    }

    /// Fields of a frame, from 0, without reactions and probes, which are in the history.
    ///
    /// # Errors
    /// The frame does not exist or cannot be read.
    pub fn frame(&self, frame: usize) -> io::Result<Frame> {
        self.read(frame).map_err(|error| into_io(&error))
    }

    fn read(&self, frame: usize) -> hdf5::Result<Frame> {
        let Some(&time) = self.times.get(frame) else {
            let message = format!("there is no frame {frame}: there are {}", self.times.len());
            return Err(message.into());
        };
        let cell = |name: &str| format!("VTKHDF/CellData/{name}");
        let velocity = "VTKHDF/PointData/velocity";
        Ok(Frame {
            time,
            increment: self.increments.get(frame).copied().unwrap_or(0),
            displacement: self.step(frame, "VTKHDF/PointData/displacement")?,
            velocity: match self.file.dataset(velocity) {
                Ok(_) => self.step(frame, velocity)?,
                Err(_) => Vec::new(),
            },
            stress: self.step(frame, &cell("stress"))?,
            plastic_strain: self.step(frame, &cell("plastic_strain"))?,
            tensile_damage: self.scalars(frame, &cell("tensile_damage"))?,
            compressive_damage: self.scalars(frame, &cell("compressive_damage"))?,
            yielded: self
                .scalars::<u8>(frame, &cell("yielded"))?
                .iter()
                .map(|y| *y != 0)
                .collect(),
            crack_width: self.scalars(frame, &cell("crack_width"))?,
            outputs: self.outputs(frame)?,
            interfaces: self.interfaces(frame)?,
            ..Frame::default()
        })
    }

    /// Fields of the solids that are none of those of every law.
    fn outputs(&self, frame: usize) -> hdf5::Result<Vec<OutputField>> {
        let mut outputs = Vec::new();
        for name in self.file.group("VTKHDF/CellData")?.member_names()? {
            if SOLIDS.iter().any(|field| field.name == name) || LABELS.contains(&name.as_str()) {
                continue;
            }
            let values = self.scalars(frame, &format!("VTKHDF/CellData/{name}"))?;
            outputs.push(OutputField { name, values });
        }
        Ok(outputs)
    }

    /// Fields that the joint laws have added, in the order of their names.
    fn interface_outputs(&self, frame: usize) -> hdf5::Result<Vec<OutputField>> {
        let group = format!("{INTERFACES}/CellData");
        let mut names = self.file.group(&group)?.member_names()?;
        names.retain(|name| !OF_EVERY_LAW.contains(&name.as_str()));
        names.sort();
        let read = |name: String| {
            let values = self.scalars(frame, &format!("{group}/{name}"))?;
            Ok(OutputField { name, values })
        };
        names.into_iter().map(read).collect()
    }

    fn interfaces(&self, frame: usize) -> hdf5::Result<InterfaceFrame> {
        if !self.file.link_exists(INTERFACES) {
            return Ok(InterfaceFrame::default());
        }
        let cell = |name: &str| format!("{INTERFACES}/CellData/{name}");
        let states = self.scalars::<u8>(frame, &cell("state"))?;
        let state = |&n: &u8| {
            InterfaceState::from_number(n).ok_or_else(|| format!("{n} is no state").into())
        };
        Ok(InterfaceFrame {
            opening: self.scalars(frame, &cell("opening"))?,
            slip: self.step(frame, &cell("slip"))?,
            traction: self.step(frame, &cell("traction"))?,
            damage: self.scalars(frame, &cell("damage"))?,
            state: states.iter().map(state).collect::<hdf5::Result<_>>()?,
            outputs: self.interface_outputs(frame)?,
        })
    }

    /// Range of rows of one frame of a field whose chunks hold one frame each.
    fn rows_of(&self, field: &hdf5::Dataset, frame: usize) -> hdf5::Result<std::ops::Range<usize>> {
        let shape = field.shape();
        let (all, width) = (
            shape.first().copied().unwrap_or(0),
            shape.get(1).copied().unwrap_or(1),
        );
        let damaged = || format!("{} is damaged: its sizes cannot be", field.name());
        let chunk = field.chunk().unwrap_or_default();
        // The dataset may contain frames that are written but not yet counted.
        let tuples = chunk.first().copied().unwrap_or(0);
        if shape.len() > 2 || (all > 0 && chunk.get(1).copied().unwrap_or(1) < width) {
            return Err(damaged().into());
        }
        let end = frame.checked_add(1).and_then(|n| n.checked_mul(tuples));
        let end = end.ok_or_else(damaged)?;
        if all < end && all > 0 {
            return Err(format!("{} ends within frame {frame}", field.name()).into());
        }
        let rows = frame * tuples..end;
        let chunk = chunk.iter().try_fold(1, |n: usize, m| n.checked_mul(*m));
        let bytes = field.dtype()?.size();
        let size = chunk.and_then(|n| n.checked_mul(bytes));
        self.room.holds(&field.name(), 1, size)?;
        self.room
            .holds(&field.name(), tuples, width.checked_mul(bytes))?;
        Ok(rows.start.min(all)..rows.end.min(all))
    }

    /// Whether the group or dataset exists.
    pub(super) fn has(&self, path: &str) -> bool {
        // HDF5 reports an error if a group on the path is missing.
        let mut at = String::new();
        path.split('/').all(|part| {
            at.push_str(part);
            let there = self.file.link_exists(&at);
            at.push('/');
            there
        })
    }

    pub(super) fn group(&self, path: &str) -> hdf5::Result<hdf5::Group> {
        self.file.group(path)
    }

    /// Values of a frame of the field at `path`, of either type.
    pub(super) fn values(&self, path: &str, frame: usize) -> hdf5::Result<Values> {
        let field = self.file.dataset(path)?;
        if field.dtype()?.is::<u8>() {
            return Ok(Values::Code(self.scalars(frame, path)?));
        }
        if field.ndim() == 1 {
            return Ok(Values::Real {
                values: self.scalars(frame, path)?,
                width: 1,
            });
        }
        let rows = self.rows_of(&field, frame)?;
        let values = field.read_slice_2d::<f64, _>((rows, ..))?;
        let width = values.ncols();
        Ok(Values::Real {
            values: values.into_raw_vec_and_offset().0,
            width,
        })
    }

    fn scalars<T: hdf5::H5Type + Clone>(&self, frame: usize, name: &str) -> hdf5::Result<Vec<T>> {
        let field = self.file.dataset(name)?;
        let rows = self.rows_of(&field, frame)?;
        Ok(field.read_slice_1d::<T, _>(rows)?.to_vec())
    }

    fn step<const N: usize>(&self, frame: usize, name: &str) -> hdf5::Result<Vec<[f64; N]>> {
        let field = self.file.dataset(name)?;
        let rows_of = self.rows_of(&field, frame)?;
        let values = field.read_slice_2d::<f64, _>((rows_of, ..))?;
        rows(&values.iter().copied().collect::<Vec<f64>>())
    }
}

/// Bound for the amount of data in a file of this length, whatever its sizes claim.
#[derive(Clone, Copy, Debug)]
struct Room {
    /// Length of the file [byte].
    length: u64,
}

impl Room {
    /// Largest ratio of unpacked data to file length. `Offsets` and `Types` are not compressed and take 9 bytes per
    /// cell; a cell has at most 8 nodes of 24 bytes each. So an array of the mesh or a frame has at most 21.3 bytes
    /// per byte.
    const UNPACKED: u64 = 24;
    /// Amount allowed in any file, because short series have chunks of a fixed size [byte].
    const LEAST: u64 = 1 << 20;
    /// Smallest size of a chunk of a series in the file [byte].
    const CHUNK: u64 = 256;

    /// Checks that the file can hold `count` values of `bytes` bytes.
    ///
    /// # Errors
    /// The file cannot hold them.
    fn holds(self, name: &str, count: usize, bytes: Option<usize>) -> hdf5::Result<()> {
        let bytes = bytes.and_then(|bytes| bytes.checked_mul(count));
        let most = Self::LEAST + Self::UNPACKED.saturating_mul(self.length);
        if bytes.is_some_and(|bytes| bytes as u64 <= most) {
            return Ok(());
        }
        let length = self.length;
        Err(format!("{name} claims more values than a file of {length} bytes can hold").into())
    }

    /// All values of a dataset in order.
    ///
    /// # Errors
    /// The file cannot hold the values, or they cannot be read.
    fn all<T: hdf5::H5Type>(self, of: &hdf5::Dataset) -> hdf5::Result<Vec<T>> {
        let count = of
            .shape()
            .iter()
            .try_fold(1, |n: usize, m| n.checked_mul(*m));
        let bytes = of.dtype()?.size().max(size_of::<T>());
        self.holds(&of.name(), count.unwrap_or(usize::MAX), Some(bytes))?;
        if let Some(chunk) = of.chunk() {
            let each = chunk.iter().try_fold(bytes, |n, m| n.checked_mul(*m));
            self.holds(&of.name(), 1, each)?;
            let chunks = count.unwrap_or(0) as u64 * bytes as u64 / each.unwrap_or(1).max(1) as u64;
            if chunks > 16 + self.length / Self::CHUNK {
                return Err(format!("{} has {chunks} chunks, more than can be", of.name()).into());
            }
        }
        of.read_raw()
    }
}

/// Converts flat numbers to rows of N.
fn rows<T: Copy, const N: usize>(flat: &[T]) -> hdf5::Result<Vec<[T; N]>> {
    let (rows, rest) = flat.as_chunks::<N>();
    if rest.is_empty() {
        Ok(rows.to_vec())
    } else {
        Err(format!("{} numbers are no rows of {N}", flat.len()).into())
    }
}

/// Converts integers to a smaller type.
fn whole<T: TryFrom<i64>>(numbers: &[i64]) -> hdf5::Result<Vec<T>> {
    let small = |&n: &i64| T::try_from(n).map_err(|_| format!("{n} is out of range").into());
    numbers.iter().map(small).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{VtkHdfWriter, fake};

    #[test]
    fn fields_are_read_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let model = fake::model();
        let mut writer = VtkHdfWriter::create(&path, &model).unwrap();
        let frames: Vec<Frame> = [0.5, 1.0, 1.5].map(|t| fake::frame(&model, t)).into();
        for frame in &frames {
            writer.append(frame).unwrap();
        }
        drop(writer);
        let file = FieldsFile::open(&path).unwrap();
        assert_eq!(file.times(), [0.5, 1.0, 1.5]);
        let mesh = file.mesh().unwrap();
        assert_eq!(mesh.nodes, model.mesh.nodes);
        assert_eq!(mesh.elements, model.mesh.elements);
        assert_eq!(mesh.unit, model.mesh.unit);
        assert_eq!(file.materials().unwrap(), ["brick", "mortar"]);
        assert_eq!(file.title_and_version().unwrap().0, model.title);
        for (i, frame) in frames.iter().enumerate() {
            let read = file.frame(i).unwrap();
            assert_eq!(read.displacement, frame.displacement);
            assert_eq!(read.stress, frame.stress);
            assert_eq!(read.plastic_strain, frame.plastic_strain);
            assert_eq!(read.crack_width, frame.crack_width);
            assert_eq!(read.yielded, frame.yielded);
            assert_eq!(read.interfaces, frame.interfaces);
        }
        let error = file.frame(3).unwrap_err().to_string();
        assert!(error.contains("no frame 3"), "{error}");
    }

    #[test]
    fn files_without_fields_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let missing = FieldsFile::open(&path).unwrap_err();
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
        std::fs::write(&path, "no HDF5").unwrap();
        assert!(FieldsFile::open(&path).is_err());
    }
}
