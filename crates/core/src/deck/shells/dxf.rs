//! DXF in ASCII: closed LWPOLYLINE entities, each the outline of a block, extruded by the deck's `thickness`.
//!
//! The group codes are read here: the crate `dxf` knows every entity, brings a dozen crates with it, and its errors
//! name no line. An outline is an elevation: its x is the x of the scene, its y the z of the scene, and the blocks reach
//! from y = 0 to y = thickness.

use super::{Count, Part, Place, Polygon, Reading, ShellError, Soup, WHOLE};
use crate::deck::import::numbers::real;
use std::collections::BTreeMap;

/// Largest number of corners of an outline.
const MOST_OF_OUTLINE: usize = 10_000;

/// Bulge of an arc of 45 degrees, which rises by a tenth of its chord.
const WIDEST: f64 = 0.198_912_4;

/// An entity that is being read.
#[derive(Default)]
struct Entity {
    kind: String,
    line: u32,
    layer: String,
    handle: String,
    is_closed: bool,
    /// Bulge of the side that begins at a corner: the tangent of a quarter of the angle of its arc. `[corner]`
    bulges: Vec<f64>,
    /// Whether its plane is not that of x and y.
    is_turned: bool,
    corners: Vec<[f64; 2]>,
}

/// Reads the contents of a file.
pub(super) fn read(bytes: &[u8], reading: Reading) -> Result<Soup, ShellError> {
    if bytes.starts_with(b"AutoCAD Binary DXF") {
        return Err(ShellError::new(
            Place::Byte(0),
            "this is a binary DXF file",
            "save it as an ASCII DXF",
        ));
    }
    let Some(thickness) = reading.thickness else {
        return Err(ShellError::new(
            Place::Whole,
            "outlines have no thickness",
            "give the block `thickness`: how far the outlines are extruded along y",
        ));
    };
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Reader {
        soup: Soup::default(),
        // Coordinates are scaled by the unit later.
        thickness: thickness / reading.unit,
        unit: reading.unit,
        count: Count::default(),
        others: BTreeMap::new(),
        arcs: (0, 0.0),
        entity: Entity::default(),
        is_inside: false,
        is_ended: false,
        is_unit: false,
    };
    let mut lines = text.lines().enumerate();
    while let Some((i, code)) = lines.next() {
        let line = i as u32 + 1;
        let code: i32 = code.trim().parse().map_err(|_| {
            let code: String = code.trim().chars().take(20).collect();
            ShellError::new(
                Place::Line(line),
                format!("`{code}` is no group code of a DXF file"),
                "save the drawing as an ASCII DXF: group codes and values on lines in turn",
            )
        })?;
        let Some((_, value)) = lines.next() else {
            return Err(ShellError::new(
                Place::Line(line),
                "a value is missing",
                WHOLE,
            ));
        };
        reader.group(code, value.trim(), line)?;
    }
    if !reader.is_ended {
        let last = text.lines().count() as u32;
        return Err(ShellError::new(
            Place::Line(last),
            "`EOF` is missing",
            WHOLE,
        ));
    }
    reader.end()
}

impl Entity {
    /// Name of an outline in messages. Handle and layer may be missing.
    fn called(&self) -> String {
        let mut called = "the LWPOLYLINE".to_owned();
        if !self.handle.is_empty() {
            called += &format!(" {}", self.handle);
        }
        if !self.layer.is_empty() {
            called += &format!(" of the layer `{}`", self.layer);
        }
        called
    }

    fn group(&mut self, code: i32, value: &str, line: u32) -> Result<(), ShellError> {
        let number = || {
            let help = "save the drawing again";
            let message = format!("`{value}` is no finite number");
            real(value).ok_or_else(|| ShellError::new(Place::Line(line + 1), message, help))
        };
        match code {
            5 => value.clone_into(&mut self.handle),
            8 => value.clone_into(&mut self.layer),
            70 => self.is_closed = value.parse::<i64>().unwrap_or(0) & 1 == 1,
            10 => {
                self.corners.push([number()?, f64::NAN]);
                self.bulges.push(0.0);
            }
            20 => {
                let y = number()?;
                if let Some(corner) = self.corners.last_mut() {
                    corner[1] = y;
                }
            }
            42 => {
                let bulge = number()?;
                if let Some(last) = self.bulges.last_mut() {
                    *last = bulge;
                }
            }
            210 | 220 => self.is_turned |= number()? != 0.0,
            230 => self.is_turned |= number()? < 0.0,
            _ => {}
        }
        Ok(())
    }
}

struct Reader {
    soup: Soup,
    /// In the unit of the file.
    thickness: f64,
    count: Count,
    /// Number of entities of each other kind.
    others: BTreeMap<String, usize>,
    /// Unit of length of the deck [mm].
    unit: f64,
    /// Number of arcs and their largest rise above their chords [mm].
    arcs: (usize, f64),
    /// The entity that is being read.
    entity: Entity,
    /// Whether it is one of the section of entities.
    is_inside: bool,
    /// Whether the end of the file was met.
    is_ended: bool,
    /// Whether the last variable of the header is the unit.
    is_unit: bool,
}

impl Reader {
    /// Takes a group code with its value.
    fn group(&mut self, code: i32, value: &str, line: u32) -> Result<(), ShellError> {
        match (code, value) {
            (0, "EOF") => self.is_ended = true,
            (9, name) => self.is_unit = name == "$INSUNITS",
            (70, number) if self.is_unit => {
                self.is_unit = false;
                self.note_unit(number);
            }
            (2, "ENTITIES") if self.entity.kind == "SECTION" => self.is_inside = true,
            _ => {}
        }
        if code == 0 {
            let next = Entity {
                kind: value.to_owned(),
                line,
                ..Entity::default()
            };
            let done = std::mem::replace(&mut self.entity, next);
            if self.is_inside {
                self.finish(done)?;
            }
            self.is_inside &= value != "ENDSEC";
        } else if self.is_inside && self.entity.kind == "LWPOLYLINE" {
            self.entity.group(code, value, line)?;
        }
        Ok(())
    }

    /// Warns about a unit that differs from that of the deck.
    fn note_unit(&mut self, number: &str) {
        let unit = self.unit;
        let known = [
            ("1", "inch", 25.4),
            ("2", "ft", 304.8),
            ("4", "mm", 1.0),
            ("5", "cm", 10.0),
            ("6", "m", 1e3),
        ];
        let said = known.iter().find(|(code, ..)| *code == number);
        if let Some((_, name, length)) =
            said.filter(|(.., length)| (length - unit).abs() > 1e-9 * unit)
        {
            self.soup.notes.push(format!(
                "the drawing says that its unit is {name} ({length} mm), and it is read with {unit} mm"
            ));
        }
    }

    /// Adds a block for an outline.
    fn finish(&mut self, mut of: Entity) -> Result<(), ShellError> {
        if of.kind != "LWPOLYLINE" {
            if !matches!(of.kind.as_str(), "" | "SECTION" | "ENDSEC") {
                let kind = of.kind.chars().take(20).collect();
                *self.others.entry(kind).or_default() += 1;
            }
            return Ok(());
        }
        let place = Place::Line(of.line);
        let called = of.called();
        if of.corners.len() > 1 && of.corners.first() == of.corners.last() {
            of.corners.pop();
            of.is_closed = true;
        }
        let wrong = |message: &str, help: &str| {
            Err(ShellError::new(place, format!("{called} {message}"), help))
        };
        if !of.is_closed {
            return wrong("is not closed", "close it in the drawing, or delete it");
        }
        if of.is_turned {
            return wrong(
                "does not lie in the plane of x and y",
                "draw outlines in the plane of x and y",
            );
        }
        if !(3..=MOST_OF_OUTLINE).contains(&of.corners.len())
            || of.corners.iter().any(|x| x[1].is_nan())
        {
            let message = format!("has {} corners, or one without y", of.corners.len());
            return wrong(&message, "an outline has 3 to 10000 corners");
        }
        if of.bulges.iter().any(|bulge| bulge.abs() > WIDEST) {
            return wrong(
                "has an arc of more than 45 degrees, whose chord would not stand for it",
                "divide it into shorter arcs or straight lines",
            );
        }
        self.count_arcs(&of);
        self.extrude(&of, place)
    }

    /// Counts the arcs of an outline, which become their chords.
    fn count_arcs(&mut self, of: &Entity) {
        let ends = of.corners.iter().cycle().skip(1);
        let sides = of.corners.iter().zip(ends).zip(&of.bulges);
        for ((a, b), bulge) in sides.filter(|(_, bulge)| **bulge != 0.0) {
            let rise = 0.5 * bulge.abs() * (a[0] - b[0]).hypot(a[1] - b[1]);
            self.arcs.0 += 1;
            self.arcs.1 = self.arcs.1.max(rise * self.unit);
        }
    }

    fn extrude(&mut self, of: &Entity, place: Place) -> Result<(), ShellError> {
        let mut outline = of.corners.clone();
        let twice_area = |x: &[[f64; 2]]| -> f64 {
            let next = x.iter().cycle().skip(1);
            x.iter()
                .zip(next)
                .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
                .sum()
        };
        if twice_area(&outline) < 0.0 {
            outline.reverse();
        }
        let n = outline.len() as u32;
        let first = self.soup.vertices.len() as u32;
        for y in [0.0, self.thickness] {
            let corners = outline.iter().map(|[x, z]| [*x, y, *z]);
            self.soup.vertices.extend(corners);
        }
        // Seen from the front, along y, counter-clockwise outlines run around the normal -y.
        let front = (0..n).map(|i| first + i).collect();
        let back = (0..n).rev().map(|i| first + n + i).collect();
        let side = |i: u32| {
            let j = (i + 1) % n;
            vec![first + j, first + i, first + n + i, first + n + j]
        };
        let mut part = Part {
            name: Some(of.layer.clone()).filter(|layer| layer != "0" && !layer.is_empty()),
            faces: Vec::new(),
        };
        for corners in [front, back].into_iter().chain((0..n).map(side)) {
            self.count.add(corners.len(), place)?;
            part.faces.push(Polygon { corners, place });
        }
        self.soup.parts.push(part);
        Ok(())
    }

    fn end(mut self) -> Result<Soup, ShellError> {
        let others: Vec<String> = self
            .others
            .iter()
            .map(|(kind, n)| format!("{n} {kind}"))
            .collect();
        if self.soup.parts.is_empty() {
            let but = if others.is_empty() {
                String::new()
            } else {
                format!(", only {}", others.join(", "))
            };
            return Err(ShellError::new(
                Place::Whole,
                format!("there is no closed LWPOLYLINE among its entities{but}"),
                "draw the outline of each block as a closed polyline",
            ));
        }
        let (arcs, rise) = self.arcs;
        if arcs > 0 {
            self.soup.notes.push(format!(
                "{arcs} arcs are straight lines between their ends, beside which they rise by at most {rise:.2} mm"
            ));
        }
        if !others.is_empty() {
            self.soup.notes.push(format!(
                "entities that are no LWPOLYLINE are not read: {}",
                others.join(", ")
            ));
        }
        Ok(self.soup)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::error;
    use super::*;

    const READING: Reading = Reading {
        unit: 1e3,
        thickness: Some(200.0),
    };

    /// Lines of group codes and values, separated by blanks.
    fn drawing(entities: &str) -> String {
        let all = format!(
            "0 SECTION 2 HEADER 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
        );
        all.replace(' ', "\n")
    }

    const OUTLINE: &str =
        "0 LWPOLYLINE 5 2A 8 arch 90 3 70 1 10 0.0 20 0.0 10 0.0 20 1.5 10 2.0 20 0.0";

    #[test]
    fn a_closed_outline_becomes_a_prism() {
        let text = drawing(&format!("0 LINE 8 0 10 1 {OUTLINE}"));
        let soup = Soup::read("dxf", text.as_bytes(), READING).unwrap();
        let [part] = soup.parts.as_slice() else {
            panic!("{soup:?}");
        };
        assert_eq!(part.name.as_deref(), Some("arch"));
        assert_eq!(part.faces.len(), 5);
        // Clockwise outlines are reversed: the front face runs around -y.
        assert_eq!(
            soup.vertices[..3],
            [[2e3, 0.0, 0.0], [0.0, 0.0, 1.5e3], [0.0, 0.0, 0.0]]
        );
        assert_eq!(soup.vertices[3], [2e3, 200.0, 0.0]);
        assert_eq!(part.faces[2].corners, [1, 0, 3, 4]);
        assert!(soup.notes[0].contains("its unit is mm"), "{:?}", soup.notes);
        assert!(soup.notes[1].contains("1 LINE"), "{:?}", soup.notes);
    }

    /// The side from (0, 1.5) to (2, 0) is an arc that rises by 0.1 times half of its chord.
    #[test]
    fn short_arcs_become_their_chords() {
        let text = drawing(&OUTLINE.replace("20 1.5", "20 1.5 42 0.1"));
        let soup = Soup::read("dxf", text.as_bytes(), READING).unwrap();
        assert_eq!(soup.parts[0].faces.len(), 5);
        let note = "1 arcs are straight lines between their ends, beside which they rise by at most 125.00 mm";
        assert!(soup.notes.iter().any(|n| n == note), "{:?}", soup.notes);
    }

    #[test]
    fn bad_outlines_name_handle_and_line() {
        let said = |text: &str| {
            let error = Soup::read("dxf", text.as_bytes(), READING).unwrap_err();
            error.to_string()
        };
        for (from, to, wanted) in [
            (
                "70 1 10",
                "70 0 10",
                " line 15: the LWPOLYLINE 2A of the layer `arch` is not closed",
            ),
            (
                "5 2A 8 arch 90 3 70 1",
                "8 arch 90 3 70 0",
                ": the LWPOLYLINE of the layer `arch` is not closed",
            ),
            (
                "5 2A 8 arch 90 3 70 1",
                "90 3 70 0",
                ": the LWPOLYLINE is not closed",
            ),
            ("20 1.5", "20 1.5 42 0.5", "has an arc of more than 45"),
            ("90 3", "90 3 230 -1", "plane of x and y"),
            ("20 1.5", "20 nan", " line 32: `nan` is no finite number"),
            ("20 1.5", "", "one without y"),
            (
                "0 LWPOLYLINE",
                "0 POLYLINE",
                "no closed LWPOLYLINE among its entities, only 1 POLYLINE",
            ),
            ("90 3", "ninety 3", "`ninety` is no group code"),
        ] {
            let text = drawing(OUTLINE.replace(from, to).replace("  ", " ").as_str());
            assert!(said(&text).contains(wanted), "{wanted}: {}", said(&text));
        }
        assert!(said(&drawing(OUTLINE).replace("\nEOF", "\nENDSEC")).contains("`EOF` is missing"));
        assert!(error("dxf", drawing(OUTLINE).as_bytes()).contains("thickness"));
        assert!(said("AutoCAD Binary DXF\r\n").contains("binary DXF"));
    }
}
