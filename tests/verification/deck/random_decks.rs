//! Decks that nobody would write: whatever a deck says, it is read or refused, and what is read is built
//! or refused, without a panic and in bounded time and memory. What is built and small is run for some solves.
//!
//! 2,000 decks are read here and 300 run; `PROPTEST_CASES=1000000 cargo test --release --test verification random_decks` for as many as one likes.

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
    // The walls of the paper, but short.
    let wall = text("examples/03_shear_wall_j7d.toml".to_owned());
    seeds.push(
        wall.replace("courses = 18", "courses = 3")
            .replace("\"990 mm\"", "\"420 mm\""),
    );
    seeds
});

/// Numbers, texts and pieces that stand where others were expected.
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

/// One change of a text.
#[derive(Clone, Debug)]
enum Change {
    /// A value gets another.
    Value(Index, Index),
    /// The n-th number of a value is multiplied by a power of ten or its sign turned.
    Scale(Index, u8, i8),
    /// Two numbers of a value change places, as the bounds of a range would.
    Exchange(Index),
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

/// Where numbers without their signs stand in a value, up to the comment behind it.
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

/// The n-th number of `value`, or its last, times a power of ten; of none, its sign turned.
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

/// Solves of a run here, those of rejected attempts among them.
const SOLVES: usize = 40;

/// Elements of a scene that is run here.
const ELEMENTS: usize = 200;

/// A run has gone far enough.
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
            // Between two rows nothing else ends a run. No message: the hook for panics is not called.
            resume_unwind(Box::new(Enough));
        }
    }
}

/// Runs a small scene for some solves; whatever else ends it than an answer or an error is a panic.
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

/// Cases that are run: a tenth of those that are read, but 300 by default.
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
