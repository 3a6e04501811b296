//! STL, ASCII and binary: triangles without common vertices, which are welded later.

use super::{Count, Part, Place, Polygon, ShellError, Soup, WHOLE};
use crate::deck::import::numbers::{is_sound, real};

/// Length of the header and the number of triangles of a binary file [bytes].
const HEAD: usize = 84;
/// Length of a triangle [bytes].
const TRIANGLE: usize = 50;

/// Reads the contents of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Soup, ShellError> {
    let counted = bytes
        .get(80..HEAD)
        .map(|n| u32::from_le_bytes([n[0], n[1], n[2], n[3]]));
    let exact =
        counted.is_some_and(|n| bytes.len() as u64 == HEAD as u64 + TRIANGLE as u64 * u64::from(n));
    // Some programs begin binary files with `solid`, too.
    if bytes.trim_ascii_start().starts_with(b"solid") && !exact {
        ascii(bytes)
    } else {
        binary(bytes, counted)
    }
}

fn binary(bytes: &[u8], counted: Option<u32>) -> Result<Soup, ShellError> {
    let Some(count) = counted.map(|n| n as usize) else {
        return Err(ShellError::new(
            Place::Byte(bytes.len() as u64),
            "this is neither an ASCII nor a binary STL file",
            "an ASCII file begins with `solid`, a binary one has 84 bytes before its triangles",
        ));
    };
    let held = (bytes.len() - HEAD) / TRIANGLE;
    if held < count {
        return Err(ShellError::new(
            Place::Byte(bytes.len() as u64),
            format!("{count} triangles are announced, and {held} are there"),
            WHOLE,
        ));
    }
    let mut soup = Soup::default();
    let mut part = Part::default();
    let mut counter = Count::default();
    for (i, triangle) in bytes[HEAD..].chunks_exact(TRIANGLE).take(count).enumerate() {
        let place = Place::Byte((HEAD + TRIANGLE * i) as u64);
        counter.add(3, place)?;
        let first = soup.vertices.len() as u32;
        for corner in triangle[12..48].chunks_exact(12) {
            let number = |d: usize| {
                let b = &corner[4 * d..4 * d + 4];
                f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            };
            let x = [0, 1, 2].map(number);
            if !x.iter().all(|x| is_sound(*x)) {
                return Err(ShellError::new(
                    place,
                    format!(
                        "triangle {} has a corner that is not finite or too large",
                        i + 1
                    ),
                    "write the file again; a text file begins with `solid`",
                ));
            }
            soup.vertices.push(x);
        }
        let corners = vec![first, first + 1, first + 2];
        part.faces.push(Polygon { corners, place });
    }
    if bytes.len() > HEAD + TRIANGLE * count {
        let more = bytes.len() - HEAD - TRIANGLE * count;
        let note = format!("{more} bytes after the last of {count} triangles are not read");
        soup.notes.push(note);
    }
    soup.parts.push(part);
    Ok(soup)
}

fn ascii(bytes: &[u8]) -> Result<Soup, ShellError> {
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Ascii::default();
    let mut last = 0;
    for (i, line) in text.lines().enumerate() {
        last = i as u32 + 1;
        reader.line(line.trim(), Place::Line(last))?;
    }
    if reader.is_open || !reader.corners.is_empty() {
        return Err(ShellError::new(
            Place::Line(last),
            "`endsolid` is missing",
            WHOLE,
        ));
    }
    Ok(reader.soup)
}

#[derive(Default)]
struct Ascii {
    soup: Soup,
    counter: Count,
    /// Whether a solid was begun and not ended.
    is_open: bool,
    /// Corners of the current facet.
    corners: Vec<u32>,
}

impl Ascii {
    fn line(&mut self, line: &str, place: Place) -> Result<(), ShellError> {
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match word.to_ascii_lowercase().as_str() {
            "" | "facet" | "outer" | "endloop" => {}
            "solid" => {
                self.is_open = true;
                let name = rest.trim();
                self.soup.parts.push(Part {
                    name: (!name.is_empty()).then(|| name.to_owned()),
                    faces: Vec::new(),
                });
            }
            "endsolid" => self.is_open = false,
            "vertex" => {
                let x: Option<Vec<f64>> = rest.split_whitespace().map(real).collect();
                let Some([x, y, z]) = x.as_deref() else {
                    return Err(ShellError::new(
                        place,
                        "this is no vertex",
                        "vertex and three finite numbers: vertex 0.5 0 1.25",
                    ));
                };
                self.corners.push(self.soup.vertices.len() as u32);
                self.soup.vertices.push([*x, *y, *z]);
            }
            "endfacet" => self.facet(place)?,
            other => {
                let other: String = other.chars().take(20).collect();
                let help = "write the file again; solid, facet, outer loop, vertex, endloop, endfacet and endsolid \
                            are read";
                let message = format!("`{other}` is no word of an ASCII STL file");
                return Err(ShellError::new(place, message, help));
            }
        }
        Ok(())
    }

    /// Adds the facet that ends here.
    fn facet(&mut self, place: Place) -> Result<(), ShellError> {
        let corners = std::mem::take(&mut self.corners);
        self.counter.add(corners.len(), place)?;
        if let (Some(part), 3) = (self.soup.parts.last_mut(), corners.len()) {
            part.faces.push(Polygon { corners, place });
            return Ok(());
        }
        Err(ShellError::new(
            place,
            format!("a facet of {} corners", corners.len()),
            "each facet has three lines `vertex`",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{MM, error};
    use super::*;

    fn encoded(count: u32, corners: &[[f32; 3]]) -> Vec<u8> {
        let mut bytes = b"solid, says this binary file".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(count.to_le_bytes());
        for triangle in corners.chunks(3) {
            bytes.extend([0; 12]);
            bytes.extend(triangle.iter().flatten().flat_map(|x| x.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    const CORNERS: [[f32; 3]; 3] = [[0.0; 3], [1.5, 0.0, 0.0], [0.0, 2.0, -1.0]];
    const TEXT: &str = "solid a stone\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.5 0 0\n   \
                        vertex 0 2 -1\n  endloop\n endfacet\nendsolid a stone\n";

    #[test]
    fn both_forms_give_the_same_triangle() {
        let binary = Soup::read("stl", &encoded(1, &CORNERS), MM).unwrap();
        let text = Soup::read("stl", TEXT.as_bytes(), MM).unwrap();
        assert_eq!(binary.vertices, text.vertices);
        assert_eq!(binary.vertices, CORNERS.map(|x| x.map(f64::from)));
        assert_eq!(text.parts[0].name.as_deref(), Some("a stone"));
        assert_eq!(text.parts[0].faces[0].corners, [0, 1, 2]);
        assert_eq!(binary.parts[0].faces[0].corners, [0, 1, 2]);
    }

    #[test]
    fn bad_files_name_the_place() {
        let mut nan = CORNERS;
        nan[1][2] = f32::NAN;
        for (bytes, wanted) in [
            (
                encoded(u32::MAX, &CORNERS),
                "4294967295 triangles are announced",
            ),
            (encoded(1, &CORNERS)[..120].to_vec(), " line "),
            (encoded(1, &nan), " byte 84: triangle 1 has a corner"),
            (b"so".to_vec(), "neither an ASCII nor a binary"),
            (
                TEXT.replace("-1", "inf").into_bytes(),
                " line 6: this is no vertex",
            ),
            (
                TEXT.replace("vertex 0 2 -1\n", "\n").into_bytes(),
                " line 8: a facet of 2",
            ),
            (
                TEXT.replace("endsolid a stone\n", "").into_bytes(),
                "`endsolid` is missing",
            ),
        ] {
            let mut bytes = bytes;
            if wanted.contains("announced") {
                bytes[0] = b'x';
            }
            let said = error("stl", &bytes);
            assert!(said.contains(wanted), "{said}");
        }
    }
}
