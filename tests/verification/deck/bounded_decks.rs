//! A deck with excessive sizes is rejected before geometry is generated, with bounded time and memory.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use wythe::deck::{Deck, check};
use wythe::error::{MOST_ERRORS, ModelError};
use wythe::model::Model;

/// `wythe check` must end within 10 s on any deck below 1 MB. On a machine that is busy with other tests a deck that
/// takes a second has taken half a minute; without bounds a check takes hours.
const LIMIT: Duration = Duration::from_secs(120);

fn text(example: &str) -> String {
    let path = format!("{}/examples/{example}.toml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

/// Runs the same steps as `wythe check`.
fn judged(text: &str, set: &[(&str, &str)]) -> Result<(), ModelError> {
    let set: Vec<(String, String)> = set
        .iter()
        .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
        .collect();
    let begun = Instant::now();
    let deck = Deck::from_str_with(text, "deck.toml", &set);
    let judged = deck.and_then(|deck| {
        let (model, _) = Model::from_deck(&deck)?;
        let _ = check(&deck, &model).to_string();
        Ok(())
    });
    assert!(begun.elapsed() < LIMIT, "{:?}", begun.elapsed());
    judged
}

#[test]
fn lengths_and_counts_are_checked_before_geometry_is_generated() {
    let leaves = "72_leaves_and_headers";
    for (example, key, value, at) in [
        (
            "71_flemish_wall",
            "wall.head_joint",
            "-204 mm",
            "wall.head_joint",
        ),
        (
            "60_english_bond_wall",
            "wall.head_joint",
            "-204 mm",
            "wall.head_joint",
        ),
        (
            leaves,
            "wall.pattern.0.leaves.0.units",
            "[\"-440 mm\"]",
            "wall.pattern.0.leaves.0.units",
        ),
        (
            leaves,
            "wall.pattern.0.leaves.0.units",
            "[\"0.05 mm\"]",
            "wall.pattern.0.leaves.0.units.0",
        ),
        (
            leaves,
            "wall.pattern.0.leaves.0.offset",
            "1e12",
            "wall.pattern.0.leaves.0.offset",
        ),
        (
            leaves,
            "wall.pattern.0.leaves.0.offset",
            "-1e12",
            "wall.pattern.0.leaves.0.offset",
        ),
        (leaves, "wall.collar_joint", "1e9", "wall.collar_joint"),
        (leaves, "wall.courses", "65535", "wall.courses"),
        (
            "03_shear_wall_j7d",
            "wall.mesh",
            "[300, 300, 300]",
            "wall.mesh",
        ),
        ("03_shear_wall_j7d", "wall.length", "1e300", "wall.length"),
        (
            "03_shear_wall_j7d",
            "contact.search_radius",
            "1e300",
            "contact.search_radius",
        ),
        (
            "41_cyclic_block",
            "steps.1.cycles.repeat",
            "100000000",
            "steps.1.cycles.repeat",
        ),
        (
            "05_sliding_block",
            "blocks.0.copies",
            "[100, 100, 100]",
            "blocks.0.copies",
        ),
        (
            "81_prism",
            "materials.mortar.tension.1.1",
            "1e308",
            "materials.mortar.tension.1.1",
        ),
    ] {
        let error = judged(&text(example), &[(key, value)]).unwrap_err();
        assert!(
            error.all().any(|error| error.key() == at),
            "{example} {key}: {error}"
        );
    }
}

/// Pairing 65,536 elements had quadratic cost.
#[test]
fn a_unit_of_very_many_elements_is_paired_in_little_time() {
    let mesh = [
        ("wall.mesh", "[2, 65536, 2]"),
        ("wall.courses", "2"),
        ("wall.length", "204"),
    ];
    let error = judged(&text("81_prism"), &mesh).unwrap_err();
    assert_eq!(error.key(), "wall.mesh", "{error}");
    for mesh in [
        "[2, 30000, 2]",
        "[30000, 2, 2]",
        "[2, 2, 30000]",
        "[200, 2, 200]",
    ] {
        let set = [
            ("wall.mesh", mesh),
            ("wall.courses", "2"),
            ("wall.length", "204"),
        ];
        // The findings about the physics of such elements do not matter here.
        let _ = judged(&text("81_prism"), &set);
    }
}

#[test]
fn many_errors_are_listed_in_part_and_counted() {
    let mut deck = text("05_sliding_block");
    for i in 0..8000 {
        writeln!(
            deck,
            "[[contacts]]\nslave = \"a{i}.top\"\nmaster = \"b.top\"\ninterface = \"dry\""
        )
        .unwrap();
    }
    let error = judged(&deck, &[]).unwrap_err();
    assert_eq!(error.all().count(), MOST_ERRORS + 1);
    let last = error.all().last().unwrap();
    assert!(
        last.message().ends_with("more errors are not shown"),
        "{last}"
    );
}

#[test]
fn no_text_takes_long() {
    let plain = text("05_sliding_block");
    let name = "n".repeat(300_000);
    let mut rows =
        String::from("[materials.long]\nE = 1\nnu = 0\ncompression = [[1, 0, 0]]\ntension = [");
    (0..60_000).for_each(|_| rows.push_str("[1,0,0],"));
    rows.push_str("]\n");
    for hostile in [
        "garbage\n".repeat(120_000),
        "[".repeat(1_000_000),
        format!("{}=1", "a.".repeat(400_000)),
        format!("{plain}\n[materials.{name}]\n{}", "x=[1]\n".repeat(1000)),
        format!("{plain}\n{rows}"),
        format!(
            "{plain}\n{}",
            (0..60_000)
                .map(|i| format!("k{i} = {i}\n"))
                .collect::<String>()
        ),
        format!("{plain}\ntitle = \"{name}\""),
        "[[steps]]\nkind = \"free\"\n".repeat(40_000),
    ] {
        assert!(judged(&hostile, &[]).is_err());
    }
    let deep = vec!["a"; 60_000].join(".");
    assert!(judged(&plain, &[(&deep, "1")]).is_err());
}

fn blocks(count: usize, place: impl Fn(usize) -> String) -> String {
    let mut deck = String::from(
        "format = 1\n[materials.m]\nE = 1e4\nnu = 0.2\ndensity = 2e-9\n[interfaces.i]\nf_t = 0\nc = 0\ntan_phi = 0.6\nmu = 0.6\n\
         [[contacts]]\ninterface = \"i\"\n[[supports]]\non = \"b0\"\n[[steps]]\nkind = \"gravity\"\n",
    );
    for i in 0..count {
        let at = place(i);
        writeln!(
            deck,
            "[[blocks]]\nname = \"b{i}\"\nsize = [1, 1, 1]\nmaterial = \"m\"\nat = {at}"
        )
        .unwrap();
    }
    deck
}

#[test]
fn very_many_blocks_are_checked_in_any_arrangement() {
    // All blocks at one place: each overlaps every other.
    assert!(judged(&blocks(10_000, |_| "[0, 0, 0]".to_owned()), &[]).is_err());
    // A tower, a wall normal to x, a cube.
    judged(&blocks(6_000, |i| format!("[0, 0, {i}]")), &[]).unwrap();
    judged(
        &blocks(6_000, |i| format!("[0, {}, {}]", i % 80, i / 80)),
        &[],
    )
    .unwrap();
    judged(
        &blocks(6_000, |i| {
            format!("[{}, {}, {}]", i % 18, i / 18 % 18, i / 324)
        }),
        &[],
    )
    .unwrap();
}
