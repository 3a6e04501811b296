//! Lines of an `.inp` and of the files that it includes: keywords with their parameters, and data.

use crate::deck::import::{Loader, Place, Wrong};
use crate::error::is_hidden;

/// A keyword line: `*ELSET, ELSET=BRICKS, GENERATE`.
#[derive(Clone, Debug)]
pub(super) struct Keyword {
    /// Name in capitals, without the asterisk, with single spaces between words.
    pub(super) name: String,
    /// Names of parameters in capitals, and their values as written, without quotes.
    parameters: Vec<(String, String)>,
    /// Position in the file.
    pub(super) place: Place,
}

impl Keyword {
    fn parse(text: &str, place: Place) -> Self {
        let mut fields = fields(text).into_iter();
        let name = capitals(fields.next().unwrap_or_default().trim_start_matches('*'));
        let parameters = fields
            .filter(|field| !field.is_empty())
            .map(|field| {
                let (key, value) = field.split_once('=').unwrap_or((field, ""));
                (capitals(key), unquoted(value).to_owned())
            })
            .collect();
        Self {
            name,
            parameters,
            place,
        }
    }

    /// Value of a parameter; empty if it has no value.
    pub(super) fn get(&self, parameter: &str) -> Option<&str> {
        let found = self.parameters.iter().find(|(key, _)| key == parameter);
        found.map(|(_, value)| value.as_str())
    }

    pub(super) fn has(&self, parameter: &str) -> bool {
        self.get(parameter).is_some()
    }

    /// The name that a parameter gives.
    ///
    /// # Errors
    /// The parameter is missing or empty.
    pub(super) fn required(&self, parameter: &str) -> Result<String, Wrong> {
        match self.get(parameter) {
            Some(value) if !value.is_empty() => Ok(value.to_owned()),
            _ => Err(Wrong::new(
                self.place,
                format!("*{} without {parameter}=", self.name),
                format!("name it: *{}, {parameter}=...", self.name),
            )),
        }
    }
}

/// The words of a text in capitals, with single spaces between them.
fn capitals(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").to_uppercase()
}

/// Removes blanks and quotes around a text.
pub(super) fn unquoted(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"')
        .and_then(|t| t.strip_suffix('"'))
        .unwrap_or(text)
}

/// Splits a line at commas outside of quotes, and removes blanks around the fields.
fn fields(line: &str) -> Vec<&str> {
    let mut quoted = false;
    let parts = line.split(|c: char| {
        quoted ^= c == '"';
        c == ',' && !quoted
    });
    parts.map(str::trim).collect()
}

/// Start of a comment that wythe writes for itself, see [`Sink::remark`].
pub(super) const REMARK: &str = "** wythe:";

/// Receiver of the lines.
pub(super) trait Sink {
    /// A keyword begins; the one before it has ended.
    fn keyword(&mut self, keyword: &Keyword) -> Result<(), Wrong>;
    /// A data line of the last keyword.
    fn data(&mut self, fields: &[&str], place: Place) -> Result<(), Wrong>;
    /// A comment by which wythe stores data without an Abaqus keyword: `** wythe: KEY = VALUE`, after the last
    /// keyword.
    fn remark(&mut self, key: &str, value: &str);
}

/// Largest depth of inclusion; deeper files most likely include each other in a circle.
const DEEPEST: usize = 16;

/// Largest number of included files; more most likely include each other repeatedly.
const MOST_FILES: usize = 1000;

/// Reads files line by line.
pub(super) struct Lines<'a> {
    load: Loader<'a>,
    /// Names of the files met so far.
    pub(super) files: Vec<String>,
    depth: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(load: Loader<'a>) -> Self {
        Self {
            load,
            files: Vec::new(),
            depth: 0,
        }
    }

    /// Passes all lines of a file, and of the files that it includes, to the sink.
    ///
    /// # Errors
    /// Lines that the sink rejects; files that cannot be read or include each other.
    pub(super) fn scan(
        &mut self,
        name: &str,
        bytes: &[u8],
        sink: &mut impl Sink,
    ) -> Result<(), Wrong> {
        // Titles may have any encoding.
        let text = String::from_utf8_lossy(bytes);
        let file = self.files.len() as u32;
        self.files.push(name.to_owned());
        let mut open: Option<(String, Place)> = None;
        for (n, line) in text.lines().enumerate() {
            let place = Place {
                file,
                line: n as u32 + 1,
            };
            let line = line.trim();
            if let Some((key, value)) = line.strip_prefix(REMARK).and_then(|l| l.split_once('=')) {
                // The remark belongs to the keyword before it.
                if let Some((text, place)) = open.take_if(|(text, _)| !text.ends_with(',')) {
                    self.keyword(&text, place, sink)?;
                }
                sink.remark(key.trim(), value.trim());
                continue;
            }
            if line.starts_with("**") || line.is_empty() {
                continue;
            }
            if line.starts_with('*') {
                if let Some((text, place)) = open.take() {
                    self.keyword(&text, place, sink)?;
                }
                open = Some((line.to_owned(), place));
            } else if let Some((text, _)) = open.as_mut().filter(|(t, _)| t.ends_with(',')) {
                text.push_str(line);
            } else {
                if let Some((text, place)) = open.take() {
                    self.keyword(&text, place, sink)?;
                }
                sink.data(&fields(line), place)?;
            }
        }
        match open {
            Some((text, place)) => self.keyword(&text, place, sink),
            None => Ok(()),
        }
    }

    /// Handles a complete keyword: the file of an *INCLUDE is read in its place, the INPUT= of another keyword
    /// gives its data.
    fn keyword(&mut self, text: &str, place: Place, sink: &mut impl Sink) -> Result<(), Wrong> {
        let keyword = Keyword::parse(text, place);
        if let Some((parameter, _)) = keyword
            .parameters
            .iter()
            .find(|(_, value)| value.contains(is_hidden))
        {
            return Err(Wrong::new(
                place,
                format!(
                    "*{}: a control character stands in {parameter}=",
                    keyword.name
                ),
                "names are of characters that can be seen",
            ));
        }
        if keyword.name == "INCLUDE" {
            let name = keyword.required("INPUT")?;
            return self.include(&name, place, sink);
        }
        sink.keyword(&keyword)?;
        let takes_a_file = ["NODE", "ELEMENT", "NSET", "ELSET", "SURFACE"];
        match keyword.get("INPUT") {
            Some(name) if takes_a_file.contains(&keyword.name.as_str()) => {
                self.include(name, place, sink)
            }
            _ => Ok(()),
        }
    }

    fn include(&mut self, name: &str, place: Place, sink: &mut impl Sink) -> Result<(), Wrong> {
        if self.depth >= DEEPEST || self.files.len() >= MOST_FILES {
            return Err(Wrong::new(
                place,
                format!("{name} is one file too many: do they include each other?"),
                format!("at most {MOST_FILES} files, {DEEPEST} within each other"),
            ));
        }
        let bytes = (self.load)(name).map_err(|why| {
            Wrong::new(
                place,
                format!("{name}: {why}"),
                "files that are included lie in the folder of the first",
            )
        })?;
        self.depth += 1;
        self.scan(name, &bytes, sink)?;
        self.depth -= 1;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Heard(Vec<String>);

    impl Sink for Heard {
        fn keyword(&mut self, keyword: &Keyword) -> Result<(), Wrong> {
            let Keyword {
                name,
                parameters,
                place,
            } = keyword;
            self.0.push(format!(
                "{}:{} *{name} {parameters:?}",
                place.file, place.line
            ));
            Ok(())
        }

        fn data(&mut self, fields: &[&str], place: Place) -> Result<(), Wrong> {
            self.0.push(format!(
                "{}:{} {}",
                place.file,
                place.line,
                fields.join("|")
            ));
            Ok(())
        }

        fn remark(&mut self, key: &str, value: &str) {
            self.0.push(format!("remark {key} {value}"));
        }
    }

    #[test]
    fn a_comment_refers_to_the_keyword_before_it() {
        let text = b"*MATERIAL, NAME=A\n** wythe: reference_length = 50.5\n** wythe writes: a = b\n*ELASTIC\n1, 0.2\n";
        let mut heard = Heard::default();
        let mut nothing = |_: &str| Err(std::io::ErrorKind::NotFound.into());
        Lines::new(&mut nothing)
            .scan("a.inp", text, &mut heard)
            .unwrap();
        assert_eq!(
            heard.0,
            [
                "0:1 *MATERIAL [(\"NAME\", \"A\")]",
                "remark reference_length 50.5",
                "0:4 *ELASTIC []",
                "0:5 1|0.2",
            ]
        );
    }

    #[test]
    fn keywords_continue_over_lines_and_files_are_included_in_place() {
        let text = b"** a comment\r\n*Elset,\r\n elset = \"Set, 1\",\r\n  generate\r\n 1, 5, 1\r\n\r\n\
                     *solid   section, Material=Brick\n*include, input=more.inp\n*Node, input=n.txt\n";
        let mut load = |name: &str| match name {
            "more.inp" => Ok(b"*NODE\n1, 2.,,\n".to_vec()),
            "n.txt" => Ok(b"3, 4\n".to_vec()),
            _ => Err(std::io::ErrorKind::NotFound.into()),
        };
        let mut heard = Heard::default();
        let mut lines = Lines::new(&mut load);
        lines.scan("a.inp", text, &mut heard).unwrap();
        assert_eq!(
            heard.0,
            [
                "0:2 *ELSET [(\"ELSET\", \"Set, 1\"), (\"GENERATE\", \"\")]",
                "0:5 1|5|1",
                "0:7 *SOLID SECTION [(\"MATERIAL\", \"Brick\")]",
                "1:1 *NODE []",
                "1:2 1|2.||",
                "0:9 *NODE [(\"INPUT\", \"n.txt\")]",
                "2:1 3|4",
            ]
        );
    }

    #[test]
    fn circular_includes_are_detected() {
        let mut load = |_: &str| Ok(b"*INCLUDE, INPUT=a.inp\n*INCLUDE, INPUT=a.inp".to_vec());
        let mut lines = Lines::new(&mut load);
        let wrong = lines
            .scan("a.inp", b"*INCLUDE, INPUT=a.inp", &mut Heard::default())
            .unwrap_err();
        assert!(wrong.message.contains("include each other"));
        assert_eq!(lines.files.len(), 17);
    }
}
