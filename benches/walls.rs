//! Whole runs of the walls J7D and J4D on one thread, with their numbers of increments, linear solves,
//! factorisations and force evaluations (those of the line search included).
//!
//! The runs end at 0.5 mm of the 4 mm, so that the ten samples of criterion take a minute; `WYTHE_BENCH_TO="4 mm"`
//! runs them to the end. Not covered: reading of the deck and writing of results.

use criterion::{Criterion, criterion_group, criterion_main};
use rayon::ThreadPoolBuilder;
use wythe::deck::Deck;
use wythe::model::Model;
use wythe::solve::Recorder;
use wythe::state::{Frame, HistoryRow};

struct Nothing;

impl Recorder for Nothing {
    fn take(&mut self, _: &Model, _: &HistoryRow, _: Option<&Frame>) -> std::io::Result<bool> {
        Ok(true)
    }
}

fn walls(c: &mut Criterion) {
    let to = std::env::var("WYTHE_BENCH_TO").unwrap_or_else(|_| "0.5 mm".to_owned());
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mut group = c.benchmark_group("wall");
    group.sample_size(10);
    for (name, example) in [("j7d", "03_shear_wall_j7d"), ("j4d", "04_shear_wall_j4d")] {
        let path = format!("{}/examples/{example}.toml", env!("CARGO_MANIFEST_DIR"));
        // Only the displacement of the drive changes; the increments remain those for 4 mm.
        let whole = 4.0;
        let part: f64 = to.trim_end_matches("mm").trim().parse().unwrap_or(whole);
        let set = |key: &str, value: String| (format!("steps.1.{key}"), value);
        let overrides = [
            // The whole model is solved; docs/performance.md gives the saving by symmetry.
            ("fidelity".to_owned(), "full".to_owned()),
            set("displacement", to.clone()),
            set("viscosity", (0.0025 * whole / part).to_string()),
            set("increments.initial", (0.005 * whole / part).to_string()),
            set("increments.max", (0.0125 * whole / part).to_string()),
        ];
        let deck = Deck::load(path, &overrides).expect("the example");
        let (model, _) = Model::from_deck(&deck).expect("its model");
        let run = || wythe::solve::run(&model, &mut Nothing).expect("a run");
        let summary = pool.install(run);
        println!(
            "{name} to {to}: {} increments, {} solves, {} factorisations, {} evaluations, {} cuts",
            summary.increments,
            summary.iterations,
            summary.factorisations,
            summary.evaluations,
            summary.cutbacks
        );
        group.bench_function(name, |b| b.iter(|| pool.install(run)));
    }
    group.finish();
}

criterion_group!(benches, walls);
criterion_main!(benches);
