//! Linear systems: every back end factorises and solves the matrix of the wall J7D (coarse mesh, at rest). The
//! solver of this project also factorises a thick wall and a cube, and solves for several right-hand sides at
//! once.
//!
//! Rates are operations per second (in the throughput, elements are operations of the back end's own factor). With
//! different orderings, compare rates for efficiency and times for speed. The back ends of faer are serial. Not
//! covered: the analysis (once per set of contact candidates), and tangents of a damaged wall, whose values affect
//! only the pivots.
//!
//! This binary has further modes, after `cargo bench --bench linear --no-run`: `<binary> --peers <folder>` serves
//! `benches/peers/pardiso.py`; `<binary> --once <matrix> llt|double|lu [threads] [right-hand sides]` factorises
//! one large matrix (`wall-240-5-139`, `cube-55`) and reports the memory; `<binary> --scale [threads] [repeats]`
//! factorises walls of 10,000 to 500,000 unknowns and gives the exponents of time and memory.

#[path = "peers/matrices.rs"]
mod matrices;
#[path = "peers/serve.rs"]
mod serve;

use criterion::{Criterion, Throughput, criterion_group};
use matrices::matrix;
use std::path::Path;
use wythe::linear::Backend;

fn pools() -> [(usize, rayon::ThreadPool); 3] {
    [1, 2, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        (threads, pool.build().expect("threads"))
    })
}

/// Factorisation and solution of one matrix by one back end on several numbers of threads.
fn measure(c: &mut Criterion, name: &str, backend: Backend, samples: usize) {
    let matrix = matrix(name);
    let mut solver = matrix.analyse(backend);
    let (stats, label) = (solver.stats(), format!("{name}/{backend:?}"));
    eprintln!(
        "{label}: {} equations, {:.2e} numbers in the factor, {:.2e} operations, analysis {:.0} ms",
        solver.n(),
        stats.nnz as f64,
        stats.flops,
        1e3 * stats.analysis_seconds
    );
    let other: Vec<f64> = matrix.values.iter().map(|a| 1.5 * a).collect();
    let values = [&matrix.values, &other];
    let serial = matches!(backend, Backend::FaerLlt | Backend::FaerLu);
    for (threads, pool) in pools().iter().take(if serial { 1 } else { 3 }) {
        let mut group = c.benchmark_group("factorise");
        if stats.flops > 0.0 {
            group.throughput(Throughput::Elements(stats.flops as u64));
        }
        group.sample_size(samples);
        group.bench_function(format!("{label}/{threads}"), |b| {
            // Two matrices alternate, because an unchanged matrix would only be compared with the last.
            let mut turn = values.iter().cycle();
            pool.install(|| {
                b.iter(|| {
                    solver
                        .factorise(turn.next().expect("one"))
                        .expect("factors");
                });
            });
        });
        group.finish();
        let mut group = c.benchmark_group("solve");
        group.sample_size(samples);
        let rhs = vec![1.0; solver.n()];
        let mut x = rhs.clone();
        group.bench_function(format!("{label}/{threads}"), |b| {
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

fn linear(c: &mut Criterion) {
    for backend in [
        Backend::FaerLlt,
        Backend::MultifrontalLlt,
        Backend::MixedLlt,
        Backend::FaerLu,
        Backend::MultifrontalLu,
    ] {
        let samples = if backend == Backend::FaerLu { 10 } else { 50 };
        measure(c, "j7d", backend, samples);
    }
    for name in ["thick", "cube-20"] {
        measure(c, name, Backend::MultifrontalLlt, 10);
        measure(c, name, Backend::MixedLlt, 10);
        measure(c, name, Backend::MultifrontalLu, 10);
    }
}

/// Solution for several right-hand sides at once; elements of the throughput are right-hand sides.
fn columns(c: &mut Criterion) {
    let matrix = matrix("j7d");
    let mut solver = matrix.analyse(Backend::MixedLlt);
    solver.factorise(&matrix.values).expect("factors");
    let mut group = c.benchmark_group("right_hand_sides");
    for columns in [1, 2, 4, 8, 32] {
        group.throughput(Throughput::Elements(columns as u64));
        let rhs = vec![1.0; solver.n() * columns];
        let mut x = rhs.clone();
        let (_, pool) = &pools()[0];
        group.bench_function(columns.to_string(), |b| {
            pool.install(|| {
                b.iter(|| {
                    x.copy_from_slice(&rhs);
                    solver.solve(&mut x).expect("a solution")
                });
            });
        });
    }
    group.finish();
}

criterion_group!(benches, linear, columns);

fn main() -> std::io::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words[..] {
        ["--peers", folder] => serve::serve(Path::new(folder)),
        ["--once", name, kind, ref counts @ ..] => {
            let backend = match kind {
                "lu" => Backend::MultifrontalLu,
                "double" => Backend::MultifrontalLlt,
                _ => Backend::MixedLlt,
            };
            let count = |i: usize| counts.get(i).and_then(|n| n.parse().ok()).unwrap_or(1);
            serve::once(name, backend, count(0), count(1))
        }
        ["--scale", ref counts @ ..] => {
            let count = |i: usize, else_: usize| {
                let given = counts.get(i).and_then(|n| n.parse().ok());
                given.unwrap_or(else_)
            };
            serve::scale(count(0, 1), count(1, 3));
            Ok(())
        }
        _ => {
            benches();
            Criterion::default().configure_from_args().final_summary();
            Ok(())
        }
    }
}
