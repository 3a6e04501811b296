//! Closed shells of polygons from files of other programs: OBJ, PLY, STL, COMPAS, DXF.
//!
//! A reader gives a [`Soup`]: polygons in parts with names. [`split`] divides the parts into closed shells,
//! [`Polyhedron`] checks them, and [`hexes`] divides them into hexahedra. Files are not trusted: counts may be wrong,
//! corners may be missing or not finite, and shells may be open.

mod compas;
mod dxf;
pub(in crate::deck) mod hexes;
mod hull;
mod json;
mod merge;
mod obj;
mod ply;
pub(in crate::deck) mod polyhedron;
mod split;
mod stl;

pub(in crate::deck) use polyhedron::Polyhedron;
pub(in crate::deck) use split::{Shell, split};

use crate::error::printable;
use crate::input;
use std::fmt;
use std::path::Path;

/// Size limit of a file of shells [bytes]: some 1,300,000 triangles of a binary STL.
const MOST_BYTES: u64 = 1 << 26;

/// Size limit of a JSON file [bytes]: its values take up to some 20 times its size.
const MOST_OF_JSON: u64 = 1 << 25;

/// Largest number of faces of a file, and of corners of these faces.
const MOST_FACES: usize = 1_000_000;
const MOST_CORNERS: usize = 4_000_000;

/// Endings of the files that are read.
const ENDINGS: &str =
    "stones.obj, stones.ply, stones.stl, assembly.json of COMPAS, or outlines.dxf";

/// Place of a face in its file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Place {
    /// It concerns the file as a whole, or a file without lines.
    #[default]
    Whole,
    /// Line from 1.
    Line(u32),
    /// Byte from 0.
    Byte(u64),
}

/// A polygon of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// Indices of its corners, counter-clockwise seen from outside.
    pub corners: Vec<u32>,
    /// Place in the file.
    pub place: Place,
}

/// Polygons under one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Name in the file.
    pub name: Option<String>,
    /// Faces.
    pub faces: Vec<Polygon>,
}

/// Contents of a file before it is divided into shells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// Corners in the unit of the file. `[vertex][xyz]`
    pub vertices: Vec<[f64; 3]>,
    /// Parts in the order of the file.
    pub parts: Vec<Part>,
    /// Notes for the author.
    pub notes: Vec<String>,
}

/// A file that has no closed shells, or shells that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShellError {
    /// Place in the file.
    pub place: Place,
    /// Description of the error.
    pub message: String,
    /// Advice how to correct it.
    pub help: String,
}

impl ShellError {
    /// An error at a place of the file.
    fn new(place: Place, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            place,
            message: printable(message.into()),
            help: printable(help.into()),
        }
    }
}

impl fmt::Display for ShellError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place {
            Place::Whole => write!(f, ": {}", self.message),
            Place::Line(line) => write!(f, " line {line}: {}", self.message),
            Place::Byte(byte) => write!(f, " byte {byte}: {}", self.message),
        }
    }
}

/// Values of the deck that the files do not have.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Unit of length of the file [mm].
    pub unit: f64,
    /// Thickness of outlines [mm].
    pub thickness: Option<f64>,
}

impl Soup {
    /// Reads the file at `path`; coordinates become mm.
    ///
    /// # Errors
    /// A file that cannot be read, has another ending or contains errors: place and advice.
    pub fn load(path: &Path, reading: Reading) -> Result<Self, ShellError> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let most = match ending.as_deref() {
            Some("json") => MOST_OF_JSON,
            _ => MOST_BYTES,
        };
        let bytes = input::bytes(path, most).map_err(|why| {
            let help = format!("name a file in the deck's folder: {ENDINGS}");
            ShellError::new(Place::Whole, why.to_string(), help)
        })?;
        Self::read(ending.as_deref().unwrap_or_default(), &bytes, reading)
    }

    /// Reads the contents of a file with this ending.
    ///
    /// # Errors
    /// As [`Soup::load`].
    pub fn read(ending: &str, bytes: &[u8], reading: Reading) -> Result<Self, ShellError> {
        let mut soup = match ending {
            "obj" => obj::read(bytes)?,
            "ply" => ply::read(bytes)?,
            "stl" => stl::read(bytes)?,
            "json" => compas::read(bytes)?,
            "dxf" => dxf::read(bytes, reading)?,
            _ => {
                return Err(ShellError::new(
                    Place::Whole,
                    "the ending says no format of closed shells",
                    format!("one of {ENDINGS}"),
                ));
            }
        };
        soup.parts.retain(|part| !part.faces.is_empty());
        soup.require_corners()?;
        for x in &mut soup.vertices {
            *x = x.map(|x| x * reading.unit);
        }
        Ok(soup)
    }

    /// Rejects files without faces, and faces with a corner that does not exist.
    fn require_corners(&self) -> Result<(), ShellError> {
        if self.parts.is_empty() {
            return Err(ShellError::new(
                Place::Whole,
                "there are no faces in it",
                "write the stones as closed shells of polygons or triangles",
            ));
        }
        for face in self.parts.iter().flat_map(|part| &part.faces) {
            let beyond = |corner: &&u32| **corner as usize >= self.vertices.len();
            if let Some(corner) = face.corners.iter().find(beyond) {
                let count = self.vertices.len();
                return Err(ShellError::new(
                    face.place,
                    format!("the face has the vertex {corner} (from 0), and the file has {count}"),
                    "write the file again: a vertex of this face is missing",
                ));
            }
            if face.corners.len() < 3 {
                return Err(ShellError::new(
                    face.place,
                    format!("a face of {} corners", face.corners.len()),
                    "a face has three corners at least",
                ));
            }
        }
        Ok(())
    }
}

/// Counts faces and corners while a file is read, and rejects too many.
#[derive(Default)]
struct Count {
    faces: usize,
    corners: usize,
}

impl Count {
    fn add(&mut self, corners: usize, place: Place) -> Result<(), ShellError> {
        self.faces += 1;
        self.corners += corners;
        if self.faces <= MOST_FACES && self.corners <= MOST_CORNERS {
            return Ok(());
        }
        Err(ShellError::new(
            place,
            format!("more than {MOST_FACES} faces, or {MOST_CORNERS} corners of them"),
            "divide the stones among several files, or write fewer faces for each",
        ))
    }
}

/// The help of truncated files.
const WHOLE: &str = "the file ends too early: copy or write it again";

#[cfg(test)]
pub(in crate::deck::shells) mod tests {
    use super::*;

    pub const MM: Reading = Reading {
        unit: 1.0,
        thickness: None,
    };

    /// Error of a file with this ending, with its place.
    pub fn error(ending: &str, bytes: &[u8]) -> String {
        let error = Soup::read(ending, bytes, MM).unwrap_err();
        format!("{error} | {}", error.help)
    }

    #[test]
    fn other_endings_and_empty_files_are_rejected() {
        assert!(error("step", b"").contains("stones.obj"));
        assert!(error("obj", b"").contains("no faces"));
    }
}
