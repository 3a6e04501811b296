//! The wall J7D: forces and tangents of solids and interfaces, the search, the assembly of the matrix, the
//! factorisation, and one whole iteration on one thread and on two.
//!
//! Not covered: construction of the model, output, and other states of a wall. This one is at 0.4 mm of 4 mm,
//! where a few joints have yielded and no brick has cracked.

mod pushed;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pushed::{Pushed, setting};
use rayon::{ThreadPool, ThreadPoolBuilder};
use wythe::assembly::{Contact, Evaluation, Solids};
use wythe::contact::{Aabb, Candidates};
use wythe::linear::{Backend, LinearSolver};

fn threads(n: usize) -> ThreadPool {
    ThreadPoolBuilder::new()
        .num_threads(n)
        .build()
        .expect("threads")
}

/// Evaluation of solids and of interfaces on one thread.
fn evaluation(c: &mut Criterion, pool: &ThreadPool, wall: &mut Pushed) {
    let elements = wall.system.bulk.elements.len();
    let solids = |solids, tangent| Evaluation {
        solids,
        ..setting(tangent)
    };
    let extrapolated = Solids::Extrapolated { ratio: 1.0 };
    let direct = Evaluation {
        shifted: false,
        ..setting(true)
    };
    let Pushed {
        model,
        system,
        state,
        trial,
        ..
    } = wall;
    let mut group = c.benchmark_group("j7d_solids");
    for (name, setting) in [
        ("held_force", setting(false)),
        ("secant_tangent", setting(true)),
        ("extrapolated_tangent", solids(extrapolated, true)),
        ("implicit_tangent", solids(Solids::Implicit, true)),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| pool.install(|| system.bulk.evaluate(state, trial, setting)));
        });
    }
    group.finish();
    let mut group = c.benchmark_group("j7d_interfaces");
    for (name, setting) in [
        ("shifted_force", setting(false)),
        ("shifted_tangent", setting(true)),
        ("exact_tangent", direct),
    ] {
        group.bench_function(name, |b| {
            b.iter(|| {
                let contact = &system.contact;
                pool.install(|| contact.evaluate(model, state, trial, setting, elements));
            });
        });
    }
    group.finish();
}

/// Search for new candidates, and pairing among known candidates.
fn search(c: &mut Criterion, pool: &ThreadPool, wall: &mut Pushed) {
    let surfaces = &wall.model.contact;
    let (slave, master) = (surfaces.slave(), surfaces.master());
    let x = wall.trial.x.clone();
    let boxes: Vec<Aabb> = (0..slave.facets.len())
        .map(|f| Aabb::of(&slave.corners(f, &x)))
        .collect();
    let mut group = c.benchmark_group("j7d_search");
    group.bench_function("candidates", |b| {
        b.iter(|| Candidates::find(&slave, &boxes, &master, &x, 3.0).len());
    });
    // A new contact has no candidates, so the search finds them first.
    let fresh = Contact::new(&wall.model);
    group.bench_function("candidates_and_pairs", |b| {
        b.iter_batched(
            || fresh.clone(),
            |mut contact| pool.install(|| contact.search(&mut wall.trial)),
            criterion::BatchSize::LargeInput,
        );
    });
    // A state whose forces are not known, and one whose forces are.
    let elsewhere: Vec<f64> = wall.q.iter().map(|q| q + 1e-7).collect();
    group.bench_function("pairs", |b| {
        b.iter(|| pool.install(|| wall.system.search(&mut wall.trial, &elsewhere)));
    });
    wall.search_and_evaluate(setting(true));
    group.bench_function("pairs_known", |b| {
        b.iter(|| pool.install(|| wall.system.search(&mut wall.trial, &wall.q)));
    });
    group.finish();
}

/// Assembly and factorisation of the matrix.
fn matrix(c: &mut Criterion, pool: &ThreadPool, wall: &mut Pushed) {
    wall.search_and_evaluate(setting(true));
    let mut group = c.benchmark_group("j7d_matrix");
    group.bench_function("fill", |b| {
        b.iter(|| pool.install(|| wall.system.fill(&wall.trial, black_box(&mut wall.values))));
    });
    group.bench_function("analyse", |b| {
        b.iter(|| {
            wall.system
                .analyse(&wall.equations, Backend::MixedLlt)
                .map(|(entries, _)| entries)
        });
    });
    // Matrices alternate, because the factors of an unchanged matrix are reused.
    let mut stiffer: Vec<f64> = wall.values.iter().map(|a| a * (1.0 + 1e-9)).collect();
    group.bench_function("factorise", |b| {
        b.iter(|| {
            std::mem::swap(&mut wall.values, &mut stiffer);
            pool.install(|| wall.linear.factorise(black_box(&wall.values)).is_ok())
        });
    });
    let rhs: Vec<f64> = (0..wall.linear.n()).map(|i| (i % 7) as f64 - 3.0).collect();
    let mut solution = rhs.clone();
    group.bench_function("solve", |b| {
        b.iter(|| {
            solution.copy_from_slice(&rhs);
            pool.install(|| wall.linear.solve(&mut solution).is_ok())
        });
    });
    group.finish();
}

/// Search, forces and tangents, assembly, factorisation, solution, and the forces at the new point. Each start
/// differs from the one before by ±1e-9, so that no stiffness and no factor is reused.
fn iteration(wall: &mut Pushed, farther: &mut bool) {
    *farther = !*farther;
    let scale = if *farther {
        1.0 + 1e-9
    } else {
        1.0 / (1.0 + 1e-9)
    };
    wall.q.iter_mut().for_each(|q| *q *= scale);
    let start = wall.q.clone();
    wall.search_and_evaluate(setting(true));
    wall.system.fill(&wall.trial, &mut wall.values);
    let d = wall.direction();
    wall.go(&d);
    wall.evaluate(setting(false));
    wall.q = start;
}

fn benches(c: &mut Criterion) {
    let mut wall = Pushed::new();
    let points = wall.trial.joints.status.len();
    println!(
        "{} elements, {points} points, {} pairs, {} equations, {} entries, {:.2e} operations",
        wall.system.bulk.elements.len(),
        wall.system.contact.cell_count(),
        wall.linear.n(),
        wall.values.len(),
        LinearSolver::stats(&wall.linear).flops,
    );
    let one = threads(1);
    evaluation(c, &one, &mut wall);
    search(c, &one, &mut wall);
    matrix(c, &one, &mut wall);
    let mut farther = false;
    for n in [1, 2] {
        let pool = threads(n);
        c.bench_function(&format!("j7d_iteration/{n}_threads"), |b| {
            b.iter(|| pool.install(|| iteration(&mut wall, &mut farther)));
        });
    }
    let two = threads(2);
    wall.search_and_evaluate(setting(true));
    let Pushed {
        system,
        state,
        trial,
        values,
        ..
    } = &mut wall;
    let mut group = c.benchmark_group("j7d_on_2_threads");
    group.bench_function("solids_secant_tangent", |b| {
        b.iter(|| two.install(|| system.bulk.evaluate(state, trial, setting(true))));
    });
    group.bench_function("fill", |b| {
        b.iter(|| two.install(|| system.fill(trial, black_box(values))));
    });
    group.finish();
}

criterion_group! {
    name = system;
    // Iterations take tens of milliseconds: twenty samples take some seconds.
    config = Criterion::default().sample_size(20);
    targets = benches
}
criterion_main!(system);
