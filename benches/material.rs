//! One point of a solid: elastic, damaged and plastic steps, with and without the tangent.
//!
//! Not covered: reading of histories from memory (all data stay in cache), and tables with more points than those
//! of D'Altri et al. (2018).

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::brick;
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Vector6;
use wythe::material::{DamagePlasticity, MaterialHistory};
use wythe::tensor;

/// A strain and the history before it.
type State = (Vector6<f64>, MaterialHistory);

/// History after one step to `strain`, and the next strain.
fn after(law: &DamagePlasticity, strain: [f64; 6], next: [f64; 6]) -> State {
    let old = MaterialHistory::default();
    let history = law
        .update(&strain.into(), &old, 1.0, false)
        .expect("an answer")
        .history;
    (next.into(), history)
}

fn states(law: &DamagePlasticity) -> [(&'static str, State); 6] {
    let virgin = MaterialHistory::default();
    let cracked = [6e-4, -1e-4, -1e-4, 2e-4, 1e-4, -1e-4];
    [
        // Far from yield: a bound of the stress decides.
        (
            "elastic",
            ([5e-5, -2e-5, 1e-5, 3e-5, -2e-5, 1e-5].into(), virgin),
        ),
        // Below yield, but only the principal stresses show it.
        (
            "near_yield",
            ([1.5e-4, -1.2e-4, -1e-4, 2e-5, -2e-5, 1e-5].into(), virgin),
        ),
        // A crack that closes a little: elastic, but the weight r of the damage changes.
        (
            "unloading",
            after(law, cracked, [4e-4, -1e-4, -1e-4, 2e-4, 1e-4, -1e-4]),
        ),
        (
            "cracking",
            after(law, cracked, [7e-4, -1e-4, -1e-4, 2e-4, 1e-4, -1e-4]),
        ),
        (
            "crushing",
            after(
                law,
                [2e-4, 2e-4, -1.5e-3, 1e-4, -1e-4, 2e-4],
                [2.5e-4, 2.5e-4, -1.8e-3, 1e-4, -1e-4, 2e-4],
            ),
        ),
        (
            "first_crack",
            ([3e-4, -3e-5, -3e-5, 1e-4, 5e-5, 0.0].into(), virgin),
        ),
    ]
}

fn points(c: &mut Criterion) {
    let (law, _) = DamagePlasticity::new(&brick(), None).expect("the tables are sound");
    for (name, (strain, old)) in states(&law) {
        for (kind, tangent) in [("stress", false), ("tangent", true)] {
            c.bench_function(&format!("point/{name}/{kind}"), |b| {
                b.iter(|| law.update(black_box(&strain), black_box(&old), 1.0, tangent));
            });
        }
    }
    let (strain, old) = states(&law)[3].1;
    c.bench_function("point/extrapolated", |b| {
        b.iter(|| law.extrapolated(black_box(&strain), black_box(&old), 1.0));
    });
}

fn principal(c: &mut Criterion) {
    let s = Vector6::new(1.0, -2.0, 3.0, 0.4, -0.5, 0.6);
    c.bench_function("sym6/principal", |b| {
        b.iter(|| tensor::principal(black_box(&s)));
    });
}

criterion_group!(benches, points, principal);
criterion_main!(benches);
