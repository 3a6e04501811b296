//! The matrix of the wall J7D (coarse, at rest): factorised and solved by every back end.
//!
//! The rates are operations a second (Throughput: elements are operations of that back end's own
//! factor, so that rates of different orderings tell efficiency, times tell speed). faer's back
//! ends are serial. Not covered: the analysis (once per set of contact candidates), and tangents of
//! a damaged wall, whose values change nothing but pivots.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::path::Path;
use wythe::model::{Deck, Model};
use wythe::solve::Clock;
use wythe::system::linear::{Backend, LinearSolver};
use wythe::system::{Equations, Evaluation, Solids, System, Trial};

/// An analysed solver of the wall, and the values of its tangent. `[entry]`
fn wall(backend: Backend) -> (LinearSolver, Vec<f64>) {
    let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/03_shear_wall_j7d.toml");
    let deck = Deck::load(deck.to_str().expect("a path in UTF-8"), &[]).expect("a deck");
    let (model, _) = Model::from_deck(&deck).expect("a model");
    let mut system = System::new(&model).expect("a system");
    let state = system.initial_state(&model);
    let mut trial = Trial::default();
    trial.start(&state);
    let q = vec![0.0; system.dofs.slots];
    system.search(&mut trial, &q);
    let equations = Equations::new(&system.dofs, model.steps.last().expect("a step"));
    let setting = Evaluation {
        dt: 0.01,
        solids: Solids::Implicit,
        shifted: true,
        tangent: true,
    };
    let clock = &mut Clock::default();
    system
        .evaluate(&model, &state, &mut trial, &q, setting, clock)
        .expect("forces");
    let (entries, solver) = system.analyse(&equations, backend).expect("an analysis");
    let mut values = vec![0.0; entries];
    system.fill(&trial, &mut values);
    (solver, values)
}

fn linear(c: &mut Criterion) {
    let pools = [1, 2, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        (threads, pool.build().expect("threads"))
    });
    for (name, backend, parallel) in [
        ("faer_llt", Backend::FaerLlt, false),
        ("multifrontal_llt", Backend::MultifrontalLlt, true),
        ("faer_lu", Backend::FaerLu, false),
        ("multifrontal_lu", Backend::MultifrontalLu, true),
    ] {
        let (mut solver, values) = wall(backend);
        let stats = solver.stats();
        eprintln!(
            "{name}: {} equations, {:.2e} numbers in the factor, {:.2e} operations, analysis {:.0} ms",
            solver.n(),
            stats.nnz as f64,
            stats.flops,
            1e3 * stats.analysis_seconds
        );
        for (threads, pool) in pools.iter().take(if parallel { 3 } else { 1 }) {
            let mut group = c.benchmark_group("factorise");
            if stats.flops > 0.0 {
                group.throughput(Throughput::Elements(stats.flops as u64));
            }
            group.sample_size(if backend == Backend::FaerLu { 10 } else { 50 });
            group.bench_function(format!("{name}/{threads}"), |b| {
                pool.install(|| b.iter(|| solver.factorise(&values).expect("factors")));
            });
            group.finish();
            let mut group = c.benchmark_group("solve");
            let rhs = vec![1.0; solver.n()];
            let mut x = rhs.clone();
            group.bench_function(format!("{name}/{threads}"), |b| {
                pool.install(|| {
                    b.iter(|| {
                        x.copy_from_slice(&rhs);
                        solver.solve(&mut x).expect("a solution")
                    });
                });
            });
            group.finish();
        }
    }
}

criterion_group!(benches, linear);
criterion_main!(benches);
