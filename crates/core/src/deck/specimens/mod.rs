//! Standard specimens of masonry as decks: units and joints by the deck's words, platens, gauges, loading, and the
//! table `[test]` by which [`crate::results::evaluation`] reads what the test reports.
//!
//! docs/reference/standard-tests.md describes each test, its sizes and its definitions, with sources.

mod compression;
mod flat_jack;
mod flexure;
mod joints;
mod materials;
mod options;
mod out_of_plane;
mod pushed_unit;
mod text;
mod tilting;
mod walls;

pub use options::{Options, SpecimenError};

use super::schema::TestKind;
use options::Specimen;

/// A standard test that can be written as decks.
#[derive(Clone, Copy, Debug)]
pub struct StandardTest {
    /// Name, as in `wythe new --test NAME`.
    pub name: &'static str,
    /// Evaluation of its runs.
    pub kind: TestKind,
    /// Description in one line.
    pub about: &'static str,
    /// Writes the decks.
    write: fn(&Specimen) -> Vec<SpecimenDeck>,
    /// Precompressions if none is given [MPa]; empty: the test has none.
    pressures: &'static [f64],
}

/// A deck of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SpecimenDeck {
    /// What sets it apart from the other decks of the test, such as `0.2`; empty if it is the only one.
    pub part: String,
    /// The deck: TOML, whose first line names the schema.
    pub text: String,
}

impl SpecimenDeck {
    /// The only deck of a test.
    fn only(text: String) -> Vec<Self> {
        let part = String::new();
        vec![Self { part, text }]
    }

    /// A deck for each precompression [MPa]; its part is empty if there is one only.
    fn for_each_pressure(specimen: &Specimen, text: impl Fn(f64) -> String) -> Vec<Self> {
        let pressures = &specimen.pressures;
        let deck = |pressure: &f64| Self {
            part: if pressures.len() > 1 {
                text::mm(*pressure)
            } else {
                String::new()
            },
            text: text(*pressure),
        };
        pressures.iter().map(deck).collect()
    }
}

/// Precompressions of EN 1052-3, procedure A, for units stronger than 10 MPa [MPa].
const EN1052_3: &[f64] = &[0.2, 0.6, 1.0];

/// All tests.
pub const TESTS: [StandardTest; 18] = [
    StandardTest {
        name: "en1052-1",
        kind: TestKind::Compression,
        about: "wallette in compression: strength and modulus (EN 1052-1)",
        write: compression::wallette,
        pressures: &[],
    },
    StandardTest {
        name: "en1052-2",
        kind: TestKind::Flexure,
        about: "wallettes bent by four lines, parallel and normal to the bed joints (EN 1052-2)",
        write: flexure::both,
        pressures: &[],
    },
    StandardTest {
        name: "en1052-3",
        kind: TestKind::Triplet,
        about: "triplets sheared under three precompressions: initial shear strength (EN 1052-3, procedure A)",
        write: joints::triplets,
        pressures: EN1052_3,
    },
    StandardTest {
        name: "en1052-5",
        kind: TestKind::BondWrench,
        about: "couplet whose upper unit is wrenched off by a lever: bond strength (EN 1052-5)",
        write: joints::wrench,
        pressures: &[],
    },
    StandardTest {
        name: "couplet-tension",
        kind: TestKind::CoupletTension,
        about: "couplet pulled apart: tensile strength and fracture energy of the joint",
        write: joints::tension,
        pressures: &[],
    },
    StandardTest {
        name: "direct-shear",
        kind: TestKind::DirectShear,
        about: "couplets sheared under three constant pressures, without bending (van der Pluijm)",
        write: joints::direct_shear,
        pressures: &[0.1, 0.5, 1.0],
    },
    StandardTest {
        name: "astm-e519",
        kind: TestKind::Diagonal,
        about: "square wall pressed along its diagonal: shear strength and modulus (ASTM E519)",
        write: walls::diagonal,
        pressures: &[],
    },
    StandardTest {
        name: "rilem-lumb6",
        kind: TestKind::Diagonal,
        about: "the same test by RILEM LUM B6; both evaluations are given",
        write: walls::diagonal,
        pressures: &[],
    },
    StandardTest {
        name: "shear-compression",
        kind: TestKind::ShearCompression,
        about: "wall pressed and sheared in double bending: its top stays level",
        write: walls::double_bending,
        pressures: &[0.5],
    },
    StandardTest {
        name: "shear-compression-cantilever",
        kind: TestKind::ShearCompression,
        about: "wall pressed and sheared as a cantilever: its top may turn",
        write: walls::cantilever,
        pressures: &[0.5],
    },
    StandardTest {
        name: "shear-compression-cyclic",
        kind: TestKind::ShearCompression,
        about: "wall in double bending, pushed to and fro by growing drifts",
        write: walls::cyclic,
        pressures: &[0.5],
    },
    StandardTest {
        name: "out-of-plane",
        kind: TestKind::OutOfPlane,
        about: "strip of wall under an airbag, held at foot and head (one-way bending)",
        write: out_of_plane::one_way,
        pressures: &[],
    },
    StandardTest {
        name: "out-of-plane-two-way",
        kind: TestKind::OutOfPlane,
        about: "wall under an airbag, held along its four edges (two-way bending)",
        write: out_of_plane::two_way,
        pressures: &[],
    },
    StandardTest {
        name: "out-of-plane-four-point",
        kind: TestKind::Flexure,
        about: "strip of wall bent upright by four lines (as EN 1052-2, parallel to the bed joints)",
        write: flexure::upright,
        pressures: &[],
    },
    StandardTest {
        name: "tilting-table",
        kind: TestKind::TiltingTable,
        about: "dry wall on a table that tilts until the wall falls",
        write: tilting::table,
        pressures: &[],
    },
    StandardTest {
        name: "flat-jack",
        kind: TestKind::FlatJack,
        about: "wall under stress without and with a slot, whose jack brings the gauges back (ASTM C1196)",
        write: flat_jack::single,
        pressures: &[0.5],
    },
    StandardTest {
        name: "flat-jack-double",
        kind: TestKind::FlatJackDouble,
        about: "two slots whose jacks press the masonry between them: modulus (ASTM C1197)",
        write: flat_jack::double,
        pressures: &[0.5],
    },
    StandardTest {
        name: "astm-c1531",
        kind: TestKind::PushedUnit,
        about: "a unit of a wall, freed at both ends, pushed along its beds under three stresses (ASTM C1531)",
        write: pushed_unit::pushed,
        pressures: &[0.1, 0.3, 0.6],
    },
];

/// Names of the tests.
pub const NAMES: [&str; TESTS.len()] = {
    let mut names = [""; TESTS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = TESTS[i].name;
        i += 1;
    }
    names
};

/// The test of this name, if there is one.
pub fn find(name: &str) -> Option<&'static StandardTest> {
    TESTS.iter().find(|test| test.name == name)
}

impl StandardTest {
    /// Decks of the test, which run as they are: one for each precompression or direction.
    ///
    /// # Errors
    /// An option that cannot be read, or that the test does not have.
    pub fn decks(&self, options: &Options) -> Result<Vec<SpecimenDeck>, SpecimenError> {
        Ok((self.write)(&Specimen::new(self, options)?))
    }
}

#[cfg(test)]
mod tests;
