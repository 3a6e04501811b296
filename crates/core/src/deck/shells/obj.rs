//! Wavefront OBJ: `v`, `f`, `o`, `g`. Lengths have the unit of the deck's `units`.

use super::{Count, Part, Place, Polygon, ShellError, Soup};
use crate::deck::import::numbers::real;

/// Statements that say nothing about closed shells.
const IGNORED: [&str; 10] = [
    "vt",
    "vn",
    "vp",
    "s",
    "l",
    "p",
    "usemtl",
    "mtllib",
    "lod",
    "shadow_obj",
];

/// Reads the contents of a file. Objects (`o`) are parts; groups (`g`) are parts only in a file without objects,
/// because many programs write the sides of one object as groups.
pub(super) fn read(bytes: &[u8]) -> Result<Soup, ShellError> {
    let text = String::from_utf8_lossy(bytes);
    let objects = text.lines().any(|line| line.starts_with("o "));
    let mut reader = Reader {
        soup: Soup::default(),
        part: if objects { "o" } else { "g" },
        count: Count::default(),
    };
    let mut joined = String::new();
    for (i, line) in text.lines().enumerate() {
        let place = Place::Line(i as u32 + 1);
        let line = line.split('#').next().unwrap_or_default().trim();
        if let Some(begin) = line.strip_suffix('\\') {
            joined.push_str(begin);
            joined.push(' ');
            continue;
        }
        if joined.is_empty() {
            reader.line(line, place)?;
        } else {
            joined.push_str(line);
            reader.line(&std::mem::take(&mut joined), place)?;
        }
    }
    Ok(reader.soup)
}

struct Reader {
    soup: Soup,
    /// Statement that begins a part.
    part: &'static str,
    count: Count,
}

impl Reader {
    fn line(&mut self, line: &str, place: Place) -> Result<(), ShellError> {
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match word {
            "v" => self.vertex(rest, place)?,
            "f" => self.face(rest, place)?,
            "o" | "g" if word == self.part => self.soup.parts.push(Part {
                name: Some(rest.trim().to_owned()),
                faces: Vec::new(),
            }),
            "" | "o" | "g" => {}
            ignored if IGNORED.contains(&ignored) => {}
            other => {
                let other: String = other.chars().take(20).collect();
                return Err(ShellError::new(
                    place,
                    format!("`{other}` is no statement of polygons in an OBJ file"),
                    "write the stones as polygons: v, f, o and g are read; curved surfaces are not",
                ));
            }
        }
        Ok(())
    }

    fn vertex(&mut self, rest: &str, place: Place) -> Result<(), ShellError> {
        // Colours or a weight may follow.
        let mut numbers = rest.split_whitespace().map(real);
        let x = [numbers.next(), numbers.next(), numbers.next()];
        let [Some(Some(x)), Some(Some(y)), Some(Some(z))] = x else {
            return Err(ShellError::new(
                place,
                format!("`v {}` is no vertex", short(rest)),
                "v and three finite numbers: v 0.5 0 1.25",
            ));
        };
        self.soup.vertices.push([x, y, z]);
        Ok(())
    }

    fn face(&mut self, rest: &str, place: Place) -> Result<(), ShellError> {
        let known = self.soup.vertices.len() as i64;
        let index = |corner: &str| {
            let first = corner.split('/').next()?;
            let number: i64 = first.parse().ok()?;
            // Negative numbers count back from the last vertex.
            let index = if number > 0 {
                number - 1
            } else {
                known + number
            };
            (number != 0 && (0..i64::from(u32::MAX)).contains(&index)).then_some(index as u32)
        };
        let corners: Option<Vec<u32>> = rest.split_whitespace().map(index).collect();
        let Some(corners) = corners else {
            return Err(ShellError::new(
                place,
                format!("`f {}`: a corner is no number of a vertex", short(rest)),
                "numbers from 1, or from -1 back: f 1 2 3 4, f 1/1/1 2/2/1 3/3/1",
            ));
        };
        self.count.add(corners.len(), place)?;
        if self.soup.parts.is_empty() {
            self.soup.parts.push(Part::default());
        }
        if let Some(part) = self.soup.parts.last_mut() {
            part.faces.push(Polygon { corners, place });
        }
        Ok(())
    }
}

/// The begin of a text in a message.
fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{MM, error};
    use super::*;

    fn parts(text: &str) -> Vec<(Option<String>, usize)> {
        let soup = Soup::read("obj", text.as_bytes(), MM).unwrap();
        let part = |p: Part| (p.name, p.faces.len());
        soup.parts.into_iter().map(part).collect()
    }

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0 # a corner\nv 0 1.5 0 0.2 0.3 0.4\n";

    #[test]
    fn objects_are_parts_and_groups_only_without_them() {
        let of = |text: &str| parts(&format!("{TRIANGLE}{text}"));
        assert_eq!(of("f 1 2 3\nf -3/1 -2/2/2 \\\n -1//1\n"), [(None, 2)]);
        assert_eq!(
            of("g a\nf 1 2 3\ng b\nf 1 2 3\nf 3 2 1"),
            [(Some("a".into()), 1), (Some("b".into()), 2)]
        );
        assert_eq!(
            of("o stone 1\ng a\nf 1 2 3\ng b\nf 1 2 3\no empty\n"),
            [(Some("stone 1".into()), 2)]
        );
    }

    #[test]
    fn bad_lines_are_named() {
        for (text, wanted) in [
            ("v 0 0\n", " line 4: `v 0 0` is no vertex"),
            ("v 0 0 nan\n", " line 4:"),
            ("v 0 0 1e999\n", " line 4:"),
            ("f 1 2 x\n", " line 4: `f 1 2 x`: a corner"),
            ("f 0 1 2\n", " line 4:"),
            ("f 1 2 -9\n", " line 4:"),
            (
                "f 1 2 9\n",
                " line 4: the face has the vertex 8 (from 0), and the file has 3",
            ),
            ("f 1 2\n", " line 4: a face of 2 corners"),
            ("curv 0 1\n", " line 4: `curv` is no statement"),
            ("f 1 2 99999999999999999999\n", " line 4:"),
        ] {
            let said = error("obj", format!("{TRIANGLE}{text}").as_bytes());
            assert!(said.contains(wanted), "{said}");
        }
        let binary: Vec<u8> = (0..2000_u32).map(|i| (i * 7919 % 251) as u8).collect();
        assert!(error("obj", &binary).contains(" line "));
    }
}
