//! Options of a specimen, as a user writes them, and their values.

use super::StandardTest;
use super::materials::Materials;
use crate::deck::quantity::is_sound;
use crate::deck::schema::TestKind;
use crate::deck::unit::{self, Dimension};

/// Options of a specimen; those that are absent have defaults.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Length, thickness, height of a unit, such as `250x120x55` [mm].
    pub unit: Option<String>,
    /// Thickness of the joints, such as `10` [mm] or `1 cm`.
    pub joint: Option<String>,
    /// Precompressions, such as `0.2, 0.6, 1.0 MPa`; each gives a deck.
    pub precompression: Option<String>,
    /// Length and height of a wall, such as `1200x1200` [mm]; the nearest whole units and courses are taken.
    pub size: Option<String>,
    /// Text of a TOML file with the tables `[materials]` and `[interfaces]`.
    pub materials: Option<String>,
}

/// An option that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{option}: {message}")]
pub struct SpecimenError {
    /// Name of the option.
    pub option: &'static str,
    /// Message.
    pub message: String,
    /// Advice how to correct it.
    pub help: String,
}

impl SpecimenError {
    pub(super) fn new(option: &'static str, message: String, help: &str) -> Self {
        Self {
            option,
            message,
            help: help.to_owned(),
        }
    }
}

/// What a deck of a specimen is made of.
#[derive(Clone, Debug)]
pub(super) struct Specimen {
    /// Name of the test.
    pub name: &'static str,
    /// Length, thickness, height of a unit [mm].
    pub unit: [f64; 3],
    /// Thickness of bed and head joints [mm].
    pub joint: f64,
    /// Precompressions [MPa].
    pub pressures: Vec<f64>,
    /// Length and height of a wall, if given [mm].
    pub size: Option<[f64; 2]>,
    /// Materials and joint.
    pub materials: Materials,
}

const LENGTH: Dimension = Dimension([1, 0, 0, 0]);
const PRESSURE: Dimension = Dimension([-1, 1, -2, 0]);

impl Specimen {
    /// Reads the options of a test.
    ///
    /// # Errors
    /// An option that cannot be read, or that the test does not have.
    pub(super) fn new(test: &StandardTest, options: &Options) -> Result<Self, SpecimenError> {
        let dry = test.kind == TestKind::TiltingTable;
        let unit = match &options.unit {
            Some(text) => sizes(
                "--unit",
                text,
                "250x120x55: length, thickness, height in mm",
            )?,
            None => [250.0, 120.0, 55.0],
        };
        let joint = match &options.joint {
            Some(text) => values("--joint", text, LENGTH, "10, or \"1 cm\"")?[0],
            None if dry => 0.0,
            None => 10.0,
        };
        if dry != (joint == 0.0) || joint < 0.0 {
            let has = if dry {
                "is laid dry"
            } else {
                "has mortar joints"
            };
            let message = format!("{joint} mm, and the specimen of {} {has}", test.name);
            let help = if dry {
                "leave it out"
            } else {
                "a thickness above 0"
            };
            return Err(SpecimenError::new("--joint", message, help));
        }
        let size = options.size.as_ref();
        let size = size.map(|text| sizes("--size", text, "1200x1200: length, height in mm"));
        let size = size.transpose()?;
        if size.is_some() && !test.has_size() {
            let message = format!("the specimen of {} has the size of its units", test.name);
            return Err(SpecimenError::new(
                "--size",
                message,
                "leave it out, or change --unit",
            ));
        }
        if let Some([length, height]) = size
            && (length < unit[0] || height < unit[2])
        {
            let message = format!(
                "{length} x {height} mm holds no unit, which is {} mm long and {} mm high",
                unit[0], unit[2]
            );
            return Err(SpecimenError::new(
                "--size",
                message,
                "a larger size, or a smaller --unit",
            ));
        }
        Ok(Self {
            name: test.name,
            unit,
            joint,
            pressures: pressures(test, options)?,
            size,
            materials: Materials::new(options.materials.as_deref(), dry)?,
        })
    }
}

impl StandardTest {
    /// Whether the length and the height of the specimen are free.
    fn has_size(&self) -> bool {
        use TestKind::{Compression, Diagonal, OutOfPlane, ShearCompression, TiltingTable};
        let free = [
            Compression,
            Diagonal,
            OutOfPlane,
            ShearCompression,
            TiltingTable,
        ];
        free.contains(&self.kind)
    }
}

/// Precompressions of a test [MPa].
fn pressures(test: &StandardTest, options: &Options) -> Result<Vec<f64>, SpecimenError> {
    let Some(text) = &options.precompression else {
        return Ok(test.pressures.to_vec());
    };
    let option = "--precompression";
    if test.pressures.is_empty() {
        let message = format!("{} has no precompression", test.name);
        return Err(SpecimenError::new(option, message, "leave it out"));
    }
    let all = values(option, text, PRESSURE, "\"0.2, 0.6, 1.0 MPa\"")?;
    let mut sorted = all.clone();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    if all.iter().any(|p| *p < 0.0) || sorted.len() < all.len() {
        let message = format!("\"{text}\" has a value below 0, or one twice");
        return Err(SpecimenError::new(
            option,
            message,
            "pressures of 0 or more, each once",
        ));
    }
    Ok(all)
}

/// Sizes with `x` between them and one unit at the end, all above 0 [mm].
fn sizes<const N: usize>(
    option: &'static str,
    text: &str,
    example: &str,
) -> Result<[f64; N], SpecimenError> {
    let all = values(option, &text.replace(['x', '×'], ","), LENGTH, example)?;
    let wrong = |message| SpecimenError::new(option, message, example);
    let sizes: [f64; N] = all
        .try_into()
        .map_err(|all: Vec<f64>| wrong(format!("\"{text}\" has {} sizes, not {N}", all.len())))?;
    if sizes.iter().any(|size| *size <= 0.0) {
        return Err(wrong(format!("\"{text}\" has a size that is not above 0")));
    }
    Ok(sizes)
}

/// Numbers with commas between them and one unit at the end, in base units. A bare number is in these already.
fn values(
    option: &'static str,
    text: &str,
    dimension: Dimension,
    example: &str,
) -> Result<Vec<f64>, SpecimenError> {
    let wrong = |why: String| SpecimenError::new(option, format!("\"{text}\": {why}"), example);
    // The unit begins with a letter; `e` stands in numbers.
    let end = text.find(|c: char| c.is_alphabetic() && c != 'e' && c != 'E');
    let end = end.unwrap_or(text.len());
    let (numbers, of) = text.split_at(end);
    let value = |number: &str| -> Result<f64, SpecimenError> {
        let number = number.trim();
        let value = if of.trim().is_empty() {
            number
                .parse::<f64>()
                .map_err(|why| wrong(why.to_string()))?
        } else {
            let (value, found) = unit::parse(&format!("{number} {}", of.trim())).map_err(&wrong)?;
            if found != dimension {
                return Err(wrong(format!(
                    "{} expected, found {}",
                    dimension,
                    found.name()
                )));
            }
            value
        };
        if is_sound(value) {
            Ok(value)
        } else {
            Err(wrong(format!("{value} is out of bounds")))
        }
    };
    numbers.split(',').map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_numbers_share_the_unit_at_their_end() {
        let read = |text| values("--joint", text, PRESSURE, "");
        assert_eq!(read("0.2, 0.6, 1.0 MPa"), Ok(vec![0.2, 0.6, 1.0]));
        assert_eq!(read("200, 600 kPa"), Ok(vec![0.2, 0.6]));
        assert_eq!(read("1 N/mm^2"), Ok(vec![1.0]));
        assert_eq!(read("0.3"), Ok(vec![0.3]));
        assert!(read("0.2 mm").unwrap_err().message.contains("pressure"));
        assert!(read("").is_err() && read("MPa").is_err() && read("a,b").is_err());
        assert_eq!(
            sizes("--unit", "25x12x5.5 cm", ""),
            Ok([250.0, 120.0, 55.0])
        );
        assert!(sizes::<3>("--unit", "250x120", "").is_err());
        assert!(sizes::<2>("--size", "0x120", "").is_err());
    }
}
