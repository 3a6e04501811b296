//! Randomly mutated mesh files. Each file is either read or rejected, without panics and in bounded time and memory.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::sample::Index;
use wythe::deck::import::{ImportedMesh, Units};

/// Seed files by name.
static SEEDS: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/import");
    let names = [
        "cae.inp",
        "flat.inp",
        "two_blocks_41.msh",
        "two_blocks_41b.msh",
        "two_blocks_22.msh",
        "two_blocks_22b.msh",
    ];
    let read = |path: PathBuf| std::fs::read(path).expect("a file of tests/data/import");
    names.map(|name| (name, read(root.join(name)))).into()
});

/// Fragments that replace expected text.
const PIECES: [&str; 44] = [
    "0",
    "-1",
    "1",
    "8",
    "9",
    "1e308",
    "-1e308",
    "nan",
    "18446744073709551615",
    "4294967296",
    "999999999",
    ",",
    ",,,,",
    "*",
    "**",
    "*INCLUDE, INPUT=flat_mesh.inp",
    "*INCLUDE, INPUT=flat.inp",
    "*NSET, NSET=A, GENERATE",
    "1, 1000000000, 1",
    "1, 8, 0",
    "1, 8, -1",
    "8, 1, 1",
    "1, 8, nan",
    "inf",
    "1e30",
    "1e-300",
    "-0",
    "2147483648",
    "*ELSET, ELSET=A, GENERATE",
    "*ELSET, ELSET=\u{1b}[2J",
    "*SURFACE, NAME=S, TYPE=ELEMENT",
    "*ELSET, ELSET=BOTH\nBOTH",
    "*ELEMENT, TYPE=C3D8",
    "*ELEMENT, TYPE=C3D20R, ELSET=BOTH",
    "*SURFACE, NAME=S, TYPE=NODE\n1",
    "*ELASTIC, TYPE=ORTHO",
    "** wythe: reference_length = 1e308",
    "*NODE",
    "\"",
    "=",
    "$EndNodes",
    "$Elements",
    "S1",
    "\u{1f9f1}",
];

/// One mutation of a file.
#[derive(Clone, Debug)]
enum Change {
    /// Replaces a line by a fragment.
    Line(Index, Index),
    /// Replaces a field of a line by a fragment.
    Field(Index, Index, Index),
    /// Moves a line.
    Moved(Index, Index),
    /// Repeats a line.
    Twice(Index),
    /// Changes a byte.
    Byte(Index, u8),
    /// Changes the sign of a number or multiplies it by a power of ten.
    Scale(Index, i8),
    /// Exchanges two fields of a line, such as the bounds of a range.
    Exchange(Index),
    /// Truncates the file.
    Cut(Index),
}

fn change() -> impl Strategy<Value = Change> {
    let index = any::<Index>;
    prop_oneof![
        (index(), index()).prop_map(|(a, b)| Change::Line(a, b)),
        (index(), index(), index()).prop_map(|(a, b, c)| Change::Field(a, b, c)),
        (index(), index()).prop_map(|(a, b)| Change::Moved(a, b)),
        index().prop_map(Change::Twice),
        (index(), any::<u8>()).prop_map(|(a, b)| Change::Byte(a, b)),
        (index(), -30_i8..30).prop_map(|(a, p)| Change::Scale(a, p)),
        index().prop_map(Change::Exchange),
        index().prop_map(Change::Cut),
    ]
}

fn changed(bytes: &[u8], change: &Change) -> Vec<u8> {
    if bytes.is_empty() {
        return Vec::new();
    }
    let mut lines: Vec<Vec<u8>> = bytes.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    let piece = |index: &Index| index.get(&PIECES).as_bytes().to_vec();
    let count = lines.len();
    match change {
        Change::Line(at, with) => lines[at.index(count)] = piece(with),
        Change::Field(at, field, with) => {
            let line = &mut lines[at.index(count)];
            let separator = if line.contains(&b',') { b',' } else { b' ' };
            let mut fields: Vec<Vec<u8>> = line
                .split(|b| *b == separator)
                .map(<[u8]>::to_vec)
                .collect();
            let field = field.index(fields.len());
            fields[field] = piece(with);
            *line = fields.join(&separator);
        }
        Change::Moved(from, to) => {
            let line = lines.remove(from.index(count));
            lines.insert(to.index(count), line);
        }
        Change::Twice(at) => {
            let line = lines[at.index(count)].clone();
            lines.insert(at.index(count), line);
        }
        Change::Byte(at, with) => {
            let mut bytes = bytes.to_vec();
            let at = at.index(bytes.len());
            bytes[at] = *with;
            return bytes;
        }
        Change::Scale(at, power) => {
            let line = &mut lines[at.index(count)];
            let digit = line.iter().position(u8::is_ascii_digit);
            if let Some(digit) = digit {
                let length = line[digit..]
                    .iter()
                    .take_while(|b| b.is_ascii_digit() || **b == b'.')
                    .count();
                let end = digit + length;
                if *power == 0 {
                    line.insert(digit, b'-');
                } else {
                    line.splice(end..end, format!("e{power}").into_bytes());
                }
            }
        }
        Change::Exchange(at) => {
            let line = &mut lines[at.index(count)];
            let separator = if line.contains(&b',') { b',' } else { b' ' };
            let mut fields: Vec<Vec<u8>> = line
                .split(|b| *b == separator)
                .map(<[u8]>::to_vec)
                .collect();
            if let [first, .., last] = &mut fields[..] {
                std::mem::swap(first, last);
            }
            *line = fields.join(&separator);
        }
        Change::Cut(at) => return bytes[..at.index(bytes.len())].to_vec(),
    }
    lines.join(&b'\n')
}

/// Far above the time of any of these small files, on a busy machine.
const LIMIT: Duration = Duration::from_secs(5);

/// Reads a file with the others of its folder beside it, and checks the mesh.
fn read(name: &str, bytes: &[u8]) -> bool {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/import");
    let load = &mut |name: &str| std::fs::read(folder.join(name));
    let begun = Instant::now();
    let read = ImportedMesh::read(name, bytes, &Units::default(), load);
    let sound = read.and_then(|mesh| mesh.check().map(|()| mesh));
    let whole = sound.as_ref().is_ok_and(|mesh| {
        let _ = mesh.bodies();
        let _ = mesh.as_deck("mesh", name, "N, mm, s");
        let outside = mesh.exterior().unwrap_or_default();
        for set in mesh.names() {
            let nodes = mesh.nodes_of(set).unwrap_or_default();
            assert!(nodes.iter().all(|n| (*n as usize) < mesh.nodes.len()));
            let _ = mesh.facets_of(set, &outside);
        }
        true
    });
    if let Err(error) = &sound {
        assert!(!error.message.is_empty() && !error.file.is_empty());
    }
    assert!(begun.elapsed() < LIMIT);
    whole
}

fn config() -> ProptestConfig {
    let mut config = ProptestConfig::default();
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = 3000;
    }
    config.failure_persistence = None;
    config
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn no_file_panics_or_hangs(seed in any::<Index>(), changes in prop::collection::vec(change(), 1..6)) {
        let (name, bytes) = &SEEDS[seed.index(SEEDS.len())];
        let mut bytes = bytes.clone();
        for change in &changes {
            bytes = changed(&bytes, change);
        }
        read(name, &bytes);
    }
}

#[test]
fn the_seeds_are_sound() {
    for (name, bytes) in SEEDS.iter() {
        assert!(read(name, bytes), "{name}");
    }
}

#[test]
fn ranges_without_a_step_and_names_with_control_characters_are_rejected() {
    let (_, flat) = &SEEDS[1];
    let with = |lines: &str| {
        let mut bytes = flat.clone();
        bytes.extend_from_slice(lines.as_bytes());
        read("flat.inp", &bytes)
    };
    assert!(with("\n*ELSET, ELSET=MORE, GENERATE\n1, 2, 1\n"));
    assert!(with("\n*ELSET, ELSET=MORE, GENERATE\n1, 2\n"));
    for range in ["1, 2, 0", "1, 2, -1", "1, 2, nan", "2, 1, 1", "1, x, 1", ""] {
        let generated = format!("\n*ELSET, ELSET=MORE, GENERATE\n{range},\n");
        assert!(!with(&generated), "{range}");
    }
    assert!(!with("\n*ELSET, ELSET=\u{1b}[31m\n1\n"));
}

#[test]
fn false_counts_take_no_memory() {
    let huge = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 18446744073709551615 1 9\n\
                3 1 0 18446744073709551615\n1\n2\n$EndNodes\n";
    assert!(!read("a.msh", huge.as_bytes()));
    let old =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9223372036854775807\n1 0 0 0\n$EndNodes\n";
    assert!(!read("a.msh", old.as_bytes()));
    let range = "*NODE\n1,0,0,0\n*NSET, NSET=A, GENERATE\n1, 18446744073709551615, 1\n";
    assert!(!read("a.inp", range.as_bytes()));
}
