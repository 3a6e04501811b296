//! Randomly mutated decks. Each deck is either read or rejected, and a deck that is read is either built or rejected:
//! without panics, in bounded time and memory. Small models are run for some solves.
//!
//! The default is 2,000 decks that are read and 300 that are run. For more: `PROPTEST_CASES=1000000 cargo test
//! --release --test verification random_decks`.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::sample::Index;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::solve;
use wythe::solve::Recorder;
use wythe::state::{Frame, HistoryRow};

/// Small decks as seeds: mutations must reach every key, not every element.
static SEEDS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let examples = [
        "examples/01_couplet_tension.toml",
        "examples/02_couplet_shear.toml",
        "examples/05_sliding_block.toml",
        "examples/06_tilted_column.toml",
        "examples/07_arch.toml",
        "examples/08_block_couplet.toml",
        "examples/41_cyclic_block.toml",
        "examples/71_flemish_wall.toml",
        "examples/72_leaves_and_headers.toml",
        "examples/77_slab_on_springs.toml",
        "examples/80_concrete_in_two_directions.toml",
        "examples/81_prism.toml",
        "examples/86_rocking_block.toml",
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
    // The walls of the paper, but shorter.
    let wall = text("examples/03_shear_wall_j7d.toml".to_owned());
    seeds.push(
        wall.replace("courses = 18", "courses = 3")
            .replace("\"990 mm\"", "\"420 mm\""),
    );
    seeds
});

/// Numbers, texts and fragments that replace expected values.
const VALUES: [&str; 56] = [
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
    "-0.0",
    "1e12",
    "-1e12",
    "1e15",
    "1e-30",
    "1e-9",
    "100000",
    "1000000000",
    "\"1e9 mm\"",
    "\"-204 mm\"",
    "\"1e12 MPa\"",
    "\"1e-9 MPa\"",
    "[1e12, -1e12, 0]",
    "[100000, 1, 1]",
    "[65536, 65536, 65536]",
    "[[0, 0], [1e-12, 1e12], [1, -1e12]]",
];

/// One mutation of a text.
#[derive(Clone, Debug)]
enum Change {
    /// Replaces a value by another one.
    Value(Index, Index),
    /// Multiplies the n-th number of a value by a power of ten or changes its sign.
    Scale(Index, u8, i8),
    /// Exchanges two numbers of a value, such as the bounds of a range.
    Exchange(Index),
    /// Deletes a line.
    Drop(Index),
    /// Repeats a line.
    Twice(Index),
    /// Exchanges two lines.
    Swap(Index, Index),
    /// Copies a value to another place.
    Move(Index, Index),
    /// Inserts a line of another deck.
    Borrow(Index, Index, Index),
    /// Inserts a character.
    Insert(Index, char),
    /// Truncates the text.
    Cut(Index),
    /// Nests brackets.
    Nest(Index, u16),
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let index = any::<Index>;
    let change = prop_oneof![
        8 => (index(), index()).prop_map(|(a, b)| Change::Value(a, b)),
        6 => (index(), 0_u8..4, -12_i8..12).prop_map(|(a, n, b)| Change::Scale(a, n, b)),
        2 => (index(), 0_u8..4).prop_map(|(a, n)| Change::Scale(a, n, 0)),
        2 => index().prop_map(Change::Exchange),
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

/// Lines `key = value` with the position of the value.
fn values(lines: &[String]) -> Vec<(usize, usize)> {
    let of = |(i, line): (usize, &String)| {
        let plain = !line.trim_start().starts_with('#');
        line.find('=').filter(|_| plain).map(|at| (i, at + 1))
    };
    lines.iter().enumerate().filter_map(of).collect()
}

/// The text after one mutation.
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
        Change::Scale(at, n, power) if !places.is_empty() => {
            let (line, column) = *at.get(&places);
            let tail = lines[line].split_off(column);
            lines[line].push_str(&scaled(&tail, *n, *power));
        }
        Change::Exchange(at) if !places.is_empty() => {
            let (line, column) = *at.get(&places);
            let tail = lines[line].split_off(column);
            let first = numbers(&tail);
            let exchanged = match first[..] {
                [(a, b), (c, d), ..] => [
                    &tail[..a],
                    &tail[c..d],
                    &tail[b..c],
                    &tail[a..b],
                    &tail[d..],
                ]
                .concat(),
                _ => tail,
            };
            lines[line].push_str(&exchanged);
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
        Change::Value(..) | Change::Scale(..) | Change::Exchange(..) | Change::Move(..) => {}
    }
    lines.join("\n")
}

/// Positions of unsigned numbers in a value, up to a trailing comment.
fn numbers(value: &str) -> Vec<(usize, usize)> {
    let digit = |c: char| c.is_ascii_digit() || c == '.' || c == 'e';
    let (mut all, mut at) = (Vec::new(), 0);
    let end = value.find('#').unwrap_or(value.len());
    while let Some(begin) = value[at..end].find(|c: char| c.is_ascii_digit()) {
        let begin = at + begin;
        let length = value[begin..end].find(|c| !digit(c)).unwrap_or(end - begin);
        at = begin + length;
        all.push((begin, at));
    }
    all
}

/// The n-th number of `value`, or the last one, times a power of ten; with power 0 its sign is changed.
fn scaled(value: &str, n: u8, power: i8) -> String {
    let all = numbers(value);
    let Some((begin, end)) = all.get(usize::from(n)).or(all.last()).copied() else {
        return value.to_owned();
    };
    let (head, rest) = value.split_at(begin);
    let (number, tail) = rest.split_at(end - begin);
    if power == 0 {
        return format!("{head}-{number}{tail}");
    }
    match number.parse::<u64>() {
        // Counts remain counts, and models remain small.
        Ok(count) if power > 0 && power < 3 => {
            format!(
                "{head}{}{tail}",
                count.saturating_mul(10_u64.pow(power as u32))
            )
        }
        _ => format!("{head}{number}e{power}{tail}"),
    }
}

/// Far above the time of any deck of bounded size: a hang.
const HANG: Duration = Duration::from_secs(60);

fn config() -> ProptestConfig {
    let asked = ProptestConfig::default();
    let cases = std::env::var_os("PROPTEST_CASES").map_or(2_000, |_| asked.cases);
    ProptestConfig {
        cases,
        // A failing deck is short enough to be read without shrinking further.
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

/// Number of solves per run, including those of rejected increments.
const SOLVES: usize = 40;

/// Number of elements above which a scene is not run.
const ELEMENTS: usize = 200;

/// Payload that ends a run deliberately.
struct Enough;

/// Stops a run after some rows or solves.
#[derive(Default)]
struct Few {
    rows: usize,
    solves: usize,
}

impl Recorder for Few {
    fn take(&mut self, _: &Model, _: &HistoryRow, _: Option<&Frame>) -> std::io::Result<bool> {
        self.rows += 1;
        Ok(self.rows < 6)
    }

    fn progress(&mut self, _: usize, _: f64, _: usize) {
        self.solves += 1;
        if self.solves > SOLVES {
            // Only unwinding ends a run between two rows. `resume_unwind` does not call the panic hook, so that
            // nothing is printed.
            resume_unwind(Box::new(Enough));
        }
    }
}

/// Runs a small scene for some solves. Any end other than a result or an error is a panic.
fn run_a_little(model: &Model) {
    if model.mesh.elements.len() > ELEMENTS {
        return;
    }
    let run = catch_unwind(AssertUnwindSafe(|| solve::run(model, &mut Few::default())));
    if let Err(panic) = run
        && !panic.is::<Enough>()
    {
        resume_unwind(panic);
    }
}

/// Number of runs: a tenth of the decks that are read, 300 by default.
fn config_of_runs() -> ProptestConfig {
    let read = config();
    let by_default = std::env::var_os("PROPTEST_CASES").is_none();
    ProptestConfig {
        cases: if by_default {
            300
        } else {
            read.cases.div_ceil(10)
        },
        ..read
    }
}

proptest! {
    #![proptest_config(config_of_runs())]

    #[test]
    fn no_run_of_a_deck_panics_or_hangs(seed in any::<Index>(), changes in changes()) {
        let mut text = seed.get(&SEEDS).clone();
        for change in &changes {
            text = changed(&text, change);
        }
        let start = Instant::now();
        if let Ok(deck) = Deck::from_str(&text, "deck.toml")
            && let Ok((model, _)) = Model::from_deck(&deck)
        {
            run_a_little(&model);
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
