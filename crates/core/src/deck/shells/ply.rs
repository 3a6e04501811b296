//! PLY, ASCII and binary: the elements `vertex` and `face`; all others are passed over.

use super::{Count, Part, Place, Polygon, ShellError, Soup, WHOLE};
use crate::deck::import::numbers::{is_sound, real};

/// Longest header [bytes].
const MOST_OF_HEADER: usize = 1 << 16;

/// Reads the contents of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Soup, ShellError> {
    let header = Header::parse(bytes)?;
    let mut source = Source {
        bytes,
        at: header.length,
        line: header.lines,
        form: header.form,
        fields: Vec::new(),
    };
    let mut soup = Soup::default();
    let mut part = Part::default();
    let mut count = Count::default();
    for element in &header.elements {
        source.require_room(element)?;
        for _ in 0..element.count {
            match element.name.as_str() {
                "vertex" => soup.vertices.push(source.vertex(element)?),
                "face" => {
                    let face = source.face(element)?;
                    count.add(face.corners.len(), face.place)?;
                    part.faces.push(face);
                }
                _ => source.pass(element)?,
            }
        }
    }
    soup.parts.push(part);
    Ok(soup)
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl Kind {
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Signed(1),
            "short" | "int16" => Self::Signed(2),
            "int" | "int32" => Self::Signed(4),
            "uchar" | "uint8" => Self::Unsigned(1),
            "ushort" | "uint16" => Self::Unsigned(2),
            "uint" | "uint32" => Self::Unsigned(4),
            "float" | "float32" => Self::Float(4),
            "double" | "float64" => Self::Float(8),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        let (Self::Signed(n) | Self::Unsigned(n) | Self::Float(n)) = self;
        n
    }
}

struct Property {
    name: String,
    kind: Kind,
    /// Kind of the number of values, if it is a list.
    list: Option<Kind>,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

struct Header {
    form: Form,
    elements: Vec<Element>,
    /// Bytes and lines up to the data.
    length: usize,
    lines: u32,
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self, ShellError> {
        let mut header = Self {
            form: Form::Ascii,
            elements: Vec::new(),
            length: 0,
            lines: 0,
        };
        let mut form = None;
        loop {
            let rest = &bytes[header.length..];
            let end = rest.iter().take(MOST_OF_HEADER).position(|b| *b == b'\n');
            header.lines += 1;
            let place = Place::Line(header.lines);
            let wrong = |message: String| {
                ShellError::new(
                    place,
                    message,
                    "write the file again as a PLY of vertices and faces",
                )
            };
            let Some(end) = end else {
                return Err(wrong("the header has no `end_header`".to_owned()));
            };
            let line = String::from_utf8_lossy(&rest[..end]).trim().to_owned();
            header.length += end + 1;
            if header.lines == 1 {
                if line != "ply" {
                    return Err(wrong("the first line is not `ply`".to_owned()));
                }
                continue;
            }
            let words: Vec<&str> = line.split_whitespace().collect();
            match words.as_slice() {
                ["end_header"] => break,
                ["format", "ascii", _] => form = Some(Form::Ascii),
                ["format", "binary_little_endian", _] => form = Some(Form::Little),
                ["format", "binary_big_endian", _] => form = Some(Form::Big),
                words => header.element(words).map_err(wrong)?,
            }
        }
        header.form = form.ok_or_else(|| {
            ShellError::new(
                Place::Line(header.lines),
                "the header has no format that is known",
                "format ascii 1.0, binary_little_endian 1.0 or binary_big_endian 1.0",
            )
        })?;
        header.require_names()?;
        Ok(header)
    }

    /// Takes a line about an element or a property.
    fn element(&mut self, words: &[&str]) -> Result<(), String> {
        match words {
            [] | ["comment" | "obj_info" | "format", ..] => {}
            ["element", name, count] => {
                let count = count
                    .parse()
                    .map_err(|_| format!("`{count}` is no number of elements"))?;
                self.elements.push(Element {
                    name: (*name).to_owned(),
                    count,
                    properties: Vec::new(),
                });
            }
            ["property", rest @ ..] => {
                let property = property(rest);
                let property =
                    property.ok_or_else(|| format!("`{}` is no property", words.join(" ")))?;
                let element = self.elements.last_mut();
                let element = element.ok_or("a property of no element")?;
                element.properties.push(property);
            }
            _ => return Err(format!("`{}` is no line of a header", words.join(" "))),
        }
        Ok(())
    }

    /// Requires coordinates and corners.
    fn require_names(&self) -> Result<(), ShellError> {
        let has = |element: &str, property: &str| {
            let of = self.elements.iter().filter(|e| e.name == element);
            of.flat_map(|e| &e.properties).any(|p| p.name == property)
        };
        let missing = ["x", "y", "z"].iter().find(|name| !has("vertex", name));
        if let Some(name) = missing {
            return Err(ShellError::new(
                Place::Line(self.lines),
                format!("the vertices have no property `{name}`"),
                "element vertex N, property float x, y and z",
            ));
        }
        if has("face", "vertex_indices") || has("face", "vertex_index") {
            return Ok(());
        }
        Err(ShellError::new(
            Place::Line(self.lines),
            "there are no faces with a list `vertex_indices`",
            "a cloud of points is no shell: write the faces, too",
        ))
    }
}

fn property(words: &[&str]) -> Option<Property> {
    let (list, kind, name) = match words {
        ["list", count, kind, name] => (Some(Kind::parse(count)?), kind, name),
        [kind, name] => (None, kind, name),
        _ => return None,
    };
    Some(Property {
        name: (*name).to_owned(),
        kind: Kind::parse(kind)?,
        list,
    })
}

/// Data behind the header.
struct Source<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u32,
    form: Form,
    /// Fields of the current line, reversed. ASCII only.
    fields: Vec<&'a [u8]>,
}

impl Source<'_> {
    fn place(&self) -> Place {
        match self.form {
            Form::Ascii => Place::Line(self.line),
            _ => Place::Byte(self.at as u64),
        }
    }

    fn wrong(&self, message: impl Into<String>, help: &str) -> ShellError {
        ShellError::new(self.place(), message, help)
    }

    /// Rejects more elements than there can be in the rest of the file.
    fn require_room(&self, element: &Element) -> Result<(), ShellError> {
        let size = |p: &Property| p.list.unwrap_or(p.kind).size();
        let one: usize = if self.form == Form::Ascii {
            1
        } else {
            element.properties.iter().map(size).sum()
        };
        // The last line of a text may lack its end, beyond which the place then lies.
        let left = self.bytes.len().saturating_sub(self.at);
        if element
            .count
            .checked_mul(one.max(1))
            .is_some_and(|all| all <= left)
        {
            return Ok(());
        }
        let message = format!(
            "{} elements `{}` are announced, and {left} bytes follow",
            element.count, element.name
        );
        Err(self.wrong(message, WHOLE))
    }

    /// Begins an element: the next line that is not empty.
    fn begin(&mut self) -> Result<(), ShellError> {
        if self.form != Form::Ascii {
            return Ok(());
        }
        let bytes = self.bytes;
        loop {
            if self.at >= bytes.len() {
                return Err(self.wrong("the data end here", WHOLE));
            }
            let rest = &bytes[self.at..];
            let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
            self.at += end + 1;
            self.line += 1;
            let fields = rest[..end].split(u8::is_ascii_whitespace);
            self.fields = fields.filter(|field| !field.is_empty()).collect();
            self.fields.reverse();
            if !self.fields.is_empty() {
                return Ok(());
            }
        }
    }

    /// The next value.
    fn value(&mut self, kind: Kind) -> Result<f64, ShellError> {
        if self.form == Form::Ascii {
            let field = self.fields.pop();
            let text = field.map(String::from_utf8_lossy);
            let number = text.as_deref().and_then(real);
            return number.ok_or_else(|| {
                let said = text.map_or("nothing".to_owned(), |t| {
                    format!("`{}`", t.chars().take(20).collect::<String>())
                });
                self.wrong(
                    format!("a finite number is expected, and there is {said}"),
                    "see the properties in the header",
                )
            });
        }
        let size = kind.size();
        let Some(bytes) = self.bytes.get(self.at..self.at + size) else {
            return Err(self.wrong("the data end here", WHOLE));
        };
        let mut eight = [0; 8];
        for (i, b) in bytes.iter().enumerate() {
            eight[if self.form == Form::Big {
                size - 1 - i
            } else {
                i
            }] = *b;
        }
        let whole = u64::from_le_bytes(eight);
        let number = match kind {
            Kind::Unsigned(_) => whole as f64,
            Kind::Signed(1) => f64::from(whole as u8 as i8),
            Kind::Signed(2) => f64::from(whole as u16 as i16),
            Kind::Signed(_) => f64::from(whole as u32 as i32),
            Kind::Float(4) => f64::from(f32::from_bits(whole as u32)),
            Kind::Float(_) => f64::from_bits(whole),
        };
        self.at += size;
        Ok(number)
    }

    fn vertex(&mut self, element: &Element) -> Result<[f64; 3], ShellError> {
        self.begin()?;
        let place = self.place();
        let mut x = [0.0; 3];
        for property in &element.properties {
            if property.list.is_some() {
                self.list(property, &mut |_| ())?;
                continue;
            }
            let value = self.value(property.kind)?;
            if let Some(d) = ["x", "y", "z"]
                .iter()
                .position(|name| *name == property.name)
            {
                x[d] = value;
            }
        }
        if x.iter().all(|x| is_sound(*x)) {
            return Ok(x);
        }
        Err(ShellError::new(
            place,
            "a coordinate is not finite or too large",
            "write the file again",
        ))
    }

    fn face(&mut self, element: &Element) -> Result<Polygon, ShellError> {
        self.begin()?;
        let place = self.place();
        let mut corners = Vec::new();
        for property in &element.properties {
            if matches!(property.name.as_str(), "vertex_indices" | "vertex_index") {
                let mut bad = false;
                self.list(property, &mut |value| {
                    bad |= !(0.0..f64::from(u32::MAX)).contains(&value) || value.fract() != 0.0;
                    corners.push(value as u32);
                })?;
                if bad {
                    return Err(ShellError::new(
                        place,
                        "a corner of this face is no number of a vertex",
                        "numbers of vertices are whole and count from 0",
                    ));
                }
            } else if property.list.is_some() {
                self.list(property, &mut |_| ())?;
            } else {
                self.value(property.kind)?;
            }
        }
        Ok(Polygon { corners, place })
    }

    /// Passes over an element of another kind.
    fn pass(&mut self, element: &Element) -> Result<(), ShellError> {
        self.begin()?;
        for property in &element.properties {
            if property.list.is_some() {
                self.list(property, &mut |_| ())?;
            } else {
                self.value(property.kind)?;
            }
        }
        Ok(())
    }

    /// Gives the values of a list, or the one value of a property that is no list.
    fn list(&mut self, property: &Property, found: &mut dyn FnMut(f64)) -> Result<(), ShellError> {
        let count = match property.list {
            Some(kind) => self.value(kind)?,
            None => 1.0,
        };
        // Each value takes a byte at least.
        if !(count >= 0.0 && count.fract() == 0.0 && count <= self.bytes.len() as f64) {
            return Err(self.wrong(format!("a list of {count} values"), WHOLE));
        }
        for _ in 0..count as usize {
            let value = self.value(property.kind)?;
            found(value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{MM, error};
    use super::*;

    const HEAD: &str = "ply\nformat ascii 1.0\ncomment a corner\nelement vertex 3\nproperty float x\nproperty double y\n\
                        property float z\nproperty uchar red\nelement note 1\nproperty list uchar short words\nelement \
                        face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const DATA: &str = "0 0 0 9\n1.5 0 0 9\n\n0 2 -1 9\n2 7 8\n3 0 1 2\n";

    fn ascii() -> String {
        format!("{HEAD}{DATA}")
    }

    fn binary(big: bool) -> Vec<u8> {
        let form = if big {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        };
        let mut bytes = HEAD.replace("ascii", form).into_bytes();
        let mut put = |of: &[u8]| {
            let mut of = of.to_vec();
            if big {
                of.reverse();
            }
            bytes.extend(of);
        };
        for [x, y, z] in [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 2.0, -1.0]] {
            put(&(x as f32).to_le_bytes());
            put(&f64::to_le_bytes(y));
            put(&(z as f32).to_le_bytes());
            put(&[9]);
        }
        put(&[2]);
        put(&7_i16.to_le_bytes());
        put(&(-8_i16).to_le_bytes());
        put(&[3]);
        for corner in [0_i32, 1, 2] {
            put(&corner.to_le_bytes());
        }
        bytes
    }

    #[test]
    fn all_forms_give_the_same_face() {
        let wanted = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [0.0, 2.0, -1.0]];
        for bytes in [ascii().into_bytes(), binary(false), binary(true)] {
            let soup = Soup::read("ply", &bytes, MM).unwrap();
            assert_eq!(soup.vertices, wanted);
            assert_eq!(soup.parts[0].faces[0].corners, [0, 1, 2]);
        }
    }

    #[test]
    fn bad_files_name_the_place() {
        let text = |from: &str, to: &str| ascii().replace(from, to).into_bytes();
        let short = binary(false);
        for (bytes, wanted) in [
            (
                text("ply\n", "plx\n"),
                " line 1: the first line is not `ply`",
            ),
            (
                text("end_header\n", ""),
                " line 13: `0 0 0 9` is no line of a header",
            ),
            (
                text("format ascii", "format morse"),
                "no format that is known",
            ),
            (
                text("property float z", "property float depth"),
                "no property `z`",
            ),
            (text("vertex_indices", "strip"), "no faces with a list"),
            (
                text("element vertex 3", "element vertex 99999999999"),
                "99999999999 elements `vertex` are announced",
            ),
            (
                text("element vertex 3", "element vertex -3"),
                " line 4: `-3` is no number",
            ),
            (
                text("1.5 0 0", "1.5 nan 0"),
                " line 15: a finite number is expected, and there is `nan`",
            ),
            (
                text("3 0 1 2", "3 0 1"),
                " line 19: a finite number is expected, and there is nothing",
            ),
            (text("3 0 1 2\n", ""), "are announced"),
            // The last line has no end.
            (
                text("\n3 0 1 2\n", ""),
                "1 elements `face` are announced, and 0 bytes",
            ),
            (
                text("3 0 1 2", "3 0 1 7"),
                " line 19: the face has the vertex 7",
            ),
            (
                text("3 0 1 2", "3 0 1 -2"),
                " line 19: a corner of this face",
            ),
            (text("3 0 1 2", "1e9 0 1 2"), "a list of"),
            (short[..short.len() - 2].to_vec(), "the data end here"),
        ] {
            let said = error("ply", &bytes);
            assert!(said.contains(wanted), "{wanted}: {said}");
        }
    }
}
