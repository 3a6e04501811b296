//! Loose bodies under general contact: a field of pairs of stones, one above the other, that fall by a millimetre
//! onto a table and onto each other and come to rest. One thread; the bench measures the cost per solve and per
//! body.

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

/// `side`² pairs of stones of 50 × 50 × 40 mm.
fn scene(side: usize) -> Model {
    let length = 60 * side + 20;
    let deck = format!(
        r#"
format = 1
[materials.stone]
E = "1 GPa"
nu = 0.2
density = "2000 kg/m^3"
[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.6
mu = 0.6
[contact]
general = "dry"
[[blocks]]
name = "table"
size = [{length}, {length}, 50]
at = [-10, -10, -50]
material = "stone"
[[supports]]
on = "table"
[[blocks]]
name = "lower"
size = [50, 50, 40]
at = [0, 0, 1]
copies = [{side}, {side}, 1]
pitch = [60, 60, 0]
material = "stone"
[[blocks]] # no corner lies above a corner
name = "upper"
size = [50, 50, 40]
at = [1.8, 0, 42]
copies = [{side}, {side}, 1]
pitch = [60, 60, 0]
material = "stone"
[[steps]]
kind = "free"
gravity = "9.81 m/s^2"
procedure = "quasi_static"
duration = "0.04 s"
increments = {{ initial = 0.025, max = 0.025, min = 1e-7 }}
tolerance = {{ residual = 5e-3 }}
"#
    );
    let deck = Deck::from_str(&deck, "bodies.toml").expect("a deck");
    Model::from_deck(&deck).expect("its model").0
}

fn bodies(c: &mut Criterion) {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread");
    let mut group = c.benchmark_group("general contact");
    group.sample_size(10);
    for side in [5, 10, 22] {
        let model = scene(side);
        let run = || wythe::solve::run(&model, &mut Nothing).expect("a run");
        let begun = std::time::Instant::now();
        let summary = pool.install(run);
        let seconds = begun.elapsed().as_secs_f64();
        let count = 2 * side * side;
        println!(
            "{count} bodies: {} increments, {} solves, {:.1} µs a solve and body",
            summary.increments,
            summary.iterations,
            1e6 * seconds / (summary.iterations * count) as f64
        );
        group.bench_function(count.to_string(), |b| b.iter(|| pool.install(run)));
    }
    group.finish();
}

criterion_group!(benches, bodies);
criterion_main!(benches);
