//! Decks that nobody would write: whatever a deck says, it is read or refused, and what is read is built
//! or refused, without a panic and in bounded time and memory.
//!
//! 2,000 cases here; `PROPTEST_CASES=1000000 cargo test --release --test fuzz` for as many as one likes.

use std::path::PathBuf;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::sample::Index;
use wythe::model::{Deck, Model};

/// Decks to begin with, small ones: the mutations reach every key, not every element.
static SEEDS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let examples = [
        "examples/01_couplet_tension.toml",
        "examples/02_couplet_shear.toml",
        "examples/05_sliding_block.toml",
        "examples/06_tilted_column.toml",
        "examples/07_arch.toml",
        "examples/08_block_couplet.toml",
        "tests/data/scenes/stick_slip.toml",
    ];
    let cases = [
        "01-snap-back-bar",
        "04-stick-slip",
        "11-couplet-without-pressure",
        "20-detached-unit",
    ];
    let cases = cases.map(|name| format!("tests/stability/cases/{name}/deck.toml"));
    let paths = examples.into_iter().map(str::to_owned).chain(cases);
    let text = |path: String| std::fs::read_to_string(root.join(&path)).expect(&path);
    let mut seeds: Vec<String> = paths.map(text).collect();
    // The walls of the paper, but short.
    let wall = text("examples/03_shear_wall_j7d.toml".to_owned());
    seeds.push(
        wall.replace("courses = 18", "courses = 3")
            .replace("\"990 mm\"", "\"420 mm\""),
    );
    seeds
});

/// Numbers, texts and pieces that stand where others were expected.
const VALUES: [&str; 40] = [
    "0",
    "1",
    "2",
    "-1",
    "7",
    "0.5",
    "1e-300",
    "1e300",
    "1e308",
    "-1e308",
    "nan",
    "inf",
    "-inf",
    "65536",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "1e9",
    "true",
    "false",
    "\"\"",
    "\"1 mm\"",
    "\"-1 mm\"",
    "\"1e400 mm\"",
    "\"NaN MPa\"",
    "\"1 furlong\"",
    "\"30 deg\"",
    "\"left\"",
    "\"top\"",
    "\"z\"",
    "\"brick\"",
    "\"no.such.name\"",
    "[]",
    "[0]",
    "[1, 2, 3]",
    "[[1, 0, 0]]",
    "[[1.5, 0, 0], [0.1, 0.002, 0.95]]",
    "{}",
    "\"\u{1f9f1}\\u0000\"",
];

/// One change of a text.
#[derive(Clone, Debug)]
enum Change {
    /// A value gets another.
    Value(Index, Index),
    /// A number is multiplied by a power of ten or its sign turned.
    Scale(Index, i8),
    /// A line goes.
    Drop(Index),
    /// A line comes twice.
    Twice(Index),
    /// Two lines change places.
    Swap(Index, Index),
    /// A value of one place stands in another.
    Move(Index, Index),
    /// A line of another deck comes in.
    Borrow(Index, Index, Index),
    /// A character comes in.
    Insert(Index, char),
    /// The text ends here.
    Cut(Index),
    /// Brackets within brackets.
    Nest(Index, u16),
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let index = any::<Index>;
    let change = prop_oneof![
        8 => (index(), index()).prop_map(|(a, b)| Change::Value(a, b)),
        6 => (index(), -12_i8..12).prop_map(|(a, b)| Change::Scale(a, b)),
        3 => index().prop_map(Change::Drop),
        2 => index().prop_map(Change::Twice),
        2 => (index(), index()).prop_map(|(a, b)| Change::Swap(a, b)),
        3 => (index(), index()).prop_map(|(a, b)| Change::Move(a, b)),
        2 => (index(), index(), index()).prop_map(|(a, b, c)| Change::Borrow(a, b, c)),
        1 => (index(), any::<char>()).prop_map(|(a, b)| Change::Insert(a, b)),
        1 => index().prop_map(Change::Cut),
        1 => (index(), any::<u16>()).prop_map(|(a, b)| Change::Nest(a, b)),
    ];
    prop::collection::vec(change, 1..6)
}

/// Lines `key = value`, with the place of the value.
fn values(lines: &[String]) -> Vec<(usize, usize)> {
    let of = |(i, line): (usize, &String)| {
        let plain = !line.trim_start().starts_with('#');
        line.find('=').filter(|_| plain).map(|at| (i, at + 1))
    };
    lines.iter().enumerate().filter_map(of).collect()
}

/// The same with one change.
fn changed(text: &str, change: &Change) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return text.to_owned();
    }
    let places = values(&lines);
    match change {
        Change::Value(at, value) if !places.is_empty() => {
            let (line, column) = *at.get(&places);
            lines[line].truncate(column);
            lines[line].push_str(VALUES[value.index(VALUES.len())]);
        }
        Change::Scale(at, power) if !places.is_empty() => {
            let (line, column) = *at.get(&places);
            let tail = lines[line].split_off(column);
            lines[line].push_str(&scaled(&tail, *power));
        }
        Change::Move(from, to) if !places.is_empty() => {
            let (line, column) = *from.get(&places);
            let value = lines[line][column..].to_owned();
            let (line, column) = *to.get(&places);
            lines[line].truncate(column);
            lines[line].push_str(&value);
        }
        Change::Drop(at) => drop(lines.remove(at.index(lines.len()))),
        Change::Twice(at) => {
            let at = at.index(lines.len());
            lines.insert(at, lines[at].clone());
        }
        Change::Swap(a, b) => {
            let (a, b) = (a.index(lines.len()), b.index(lines.len()));
            lines.swap(a, b);
        }
        Change::Borrow(seed, from, to) => {
            let other: Vec<&str> = seed.get(&SEEDS).lines().collect();
            lines.insert(to.index(lines.len()), (*from.get(&other)).to_owned());
        }
        Change::Insert(at, character) => {
            let line = at.index(lines.len());
            let mut ends = lines[line].char_indices().map(|(i, _)| i);
            let place = ends.next_back().unwrap_or(0);
            lines[line].insert(place, *character);
        }
        Change::Cut(at) => lines.truncate(at.index(lines.len())),
        Change::Nest(at, depth) => {
            let line = at.index(lines.len());
            lines[line] = format!("deep = {}", "[".repeat(usize::from(*depth)));
        }
        Change::Value(..) | Change::Scale(..) | Change::Move(..) => {}
    }
    lines.join("\n")
}

/// The first number of `value` times a power of ten; of none, its sign turned.
fn scaled(value: &str, power: i8) -> String {
    let begin = value.find(|c: char| c.is_ascii_digit());
    let Some(begin) = begin else {
        return value.to_owned();
    };
    let digit = |c: char| c.is_ascii_digit() || c == '.' || c == 'e';
    let length = value[begin..]
        .find(|c| !digit(c))
        .unwrap_or(value.len() - begin);
    let (head, rest) = value.split_at(begin);
    let (number, tail) = rest.split_at(length);
    if power == 0 {
        return format!("{head}-{number}{tail}");
    }
    match number.parse::<u64>() {
        // Counts stay counts, of models that are built in no time.
        Ok(count) if power > 0 && power < 3 => {
            format!(
                "{head}{}{tail}",
                count.saturating_mul(10_u64.pow(power as u32))
            )
        }
        _ => format!("{head}{number}e{power}{tail}"),
    }
}

/// Far beyond what any deck of bounded size takes: a hang.
const HANG: Duration = Duration::from_secs(60);

fn config() -> ProptestConfig {
    let asked = ProptestConfig::default();
    let cases = std::env::var_os("PROPTEST_CASES").map_or(2_000, |_| asked.cases);
    ProptestConfig {
        cases,
        // A failing deck is small enough to be read as it is.
        max_shrink_iters: 200,
        failure_persistence: None,
        ..asked
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn no_deck_panics_or_hangs(seed in any::<Index>(), changes in changes()) {
        let mut text = seed.get(&SEEDS).clone();
        for change in &changes {
            text = changed(&text, change);
        }
        let start = Instant::now();
        if let Ok(deck) = Deck::from_str(&text, "deck.toml")
            && let Err(error) = Model::from_deck(&deck)
        {
            prop_assert!(!error.message().is_empty());
        }
        prop_assert!(start.elapsed() < HANG, "{text}");
    }
}

#[test]
fn the_seeds_build() {
    for seed in SEEDS.iter() {
        let deck = Deck::from_str(seed, "deck.toml").unwrap_or_else(|e| panic!("{e}\n{seed}"));
        Model::from_deck(&deck).unwrap_or_else(|e| panic!("{e}\n{seed}"));
    }
}
