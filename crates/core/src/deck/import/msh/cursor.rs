//! Reads numbers of a `.msh` in text or binary form.

use crate::deck::import::numbers::real;
use crate::deck::import::{Place, Wrong};

/// Reading position in the file.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u32,
    /// Byte order of binary numbers; none if numbers are text.
    pub(super) binary: Option<Endian>,
}

/// Byte order of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Endian {
    Little,
    Big,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            line: 1,
            binary: None,
        }
    }

    /// Current position; a binary file has no lines.
    pub(super) fn place(&self) -> Place {
        let line = if self.binary.is_some() { 0 } else { self.line };
        Place { file: 0, line }
    }

    pub(super) fn wrong(&self, message: impl Into<String>, help: &str) -> Wrong {
        Wrong::new(self.place(), message, help)
    }

    /// Rest of the line; none at the end of the file.
    pub(super) fn line(&mut self) -> Option<String> {
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let end = rest.iter().position(|b| *b == b'\n');
        let line = &rest[..end.unwrap_or(rest.len())];
        self.at += end.map_or(rest.len(), |end| end + 1);
        self.line = self.line.saturating_add(1);
        Some(String::from_utf8_lossy(line).into_owned())
    }

    /// Next word of text, on any line.
    pub(super) fn word(&mut self) -> Option<&'a str> {
        while let Some(b) = self.bytes.get(self.at).filter(|b| b.is_ascii_whitespace()) {
            self.line = self.line.saturating_add(u32::from(*b == b'\n'));
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let word = &rest[..end.unwrap_or(rest.len())];
        self.at += word.len();
        if word.is_empty() {
            return None;
        }
        std::str::from_utf8(word).ok()
    }

    /// Line of the next word of text.
    pub(super) fn line_of_next(&self) -> u32 {
        let blank = self.bytes[self.at..]
            .iter()
            .take_while(|b| b.is_ascii_whitespace());
        let newlines = blank.filter(|b| **b == b'\n').count();
        self.line.saturating_add(newlines as u32)
    }

    /// Moves behind the line that ends the section.
    ///
    /// # Errors
    /// The section has no such line.
    pub(super) fn skip_end_of(&mut self, section: &str) -> Result<(), Wrong> {
        let end = format!("$End{section}");
        let rest = &self.bytes[self.at..];
        let found = rest
            .windows(end.len())
            .position(|window| window == end.as_bytes());
        let upto = found.ok_or_else(|| {
            let message = format!("the section ${section} does not end");
            self.wrong(message, "it was cut off: save it again")
        })?;
        let newlines = rest[..upto].split(|b| *b == b'\n').count() - 1;
        self.line = self.line.saturating_add(newlines as u32);
        self.at += upto;
        self.line();
        Ok(())
    }

    /// Returns whether the section ends here.
    pub(super) fn at_end_of(&mut self, section: &str) -> bool {
        let (at, line) = (self.at, self.line);
        let end = self
            .word()
            .is_some_and(|w| w.strip_prefix("$End") == Some(section));
        (self.at, self.line) = (at, line);
        end
    }

    fn raw<const N: usize>(&mut self, endian: Endian) -> Result<[u8; N], Wrong> {
        let bytes = self.bytes.get(self.at..self.at + N);
        let mut bytes: [u8; N] = bytes.and_then(|b| b.try_into().ok()).ok_or_else(|| {
            self.wrong(
                "the file ends within a section",
                "it was cut off: save it again",
            )
        })?;
        self.at += N;
        if endian == Endian::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn text<T>(&mut self, what: &str, read: impl Fn(&str) -> Option<T>) -> Result<T, Wrong> {
        match self.word() {
            Some(word) => read(word).ok_or_else(|| {
                self.wrong(
                    format!("`{word}` stands where {what} belongs"),
                    "the file does not follow its format: save it again",
                )
            }),
            None => Err(self.wrong(
                "the file ends within a section",
                "it was cut off: save it again",
            )),
        }
    }

    /// Reads a signed integer of 4 bytes.
    pub(super) fn int(&mut self) -> Result<i64, Wrong> {
        match self.binary {
            Some(endian) => Ok(i64::from(i32::from_le_bytes(self.raw(endian)?))),
            None => self.text("a whole number", |w| w.parse().ok()),
        }
    }

    /// Reads a count or a tag of version 4, of 8 bytes.
    pub(super) fn size(&mut self) -> Result<u64, Wrong> {
        match self.binary {
            Some(endian) => Ok(u64::from_le_bytes(self.raw(endian)?)),
            None => self.text("a whole number from 0", |w| w.parse().ok()),
        }
    }

    /// Reads a tag: of 4 bytes in version 2, of 8 bytes in version 4.
    pub(super) fn tag(&mut self, version: u32) -> Result<u64, Wrong> {
        if version >= 4 {
            return self.size();
        }
        let tag = self.int()?;
        u64::try_from(tag).map_err(|_| {
            self.wrong(
                format!("`{tag}` stands where a number of a node or an element belongs"),
                "the file does not follow its format: save it again",
            )
        })
    }

    /// Reads a coordinate of 8 bytes.
    pub(super) fn real(&mut self) -> Result<f64, Wrong> {
        let Some(endian) = self.binary else {
            return self.text("a number", real);
        };
        let number = f64::from_le_bytes(self.raw(endian)?);
        if number.is_finite() {
            Ok(number)
        } else {
            Err(self.wrong(
                "a coordinate is not finite",
                "the file is damaged: save it again",
            ))
        }
    }
}
