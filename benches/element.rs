//! One hex8 in the rotated frame: elastic, extrapolated with damage, implicit with a crack.
//!
//! Not covered: the way from and to memory (`benches/system.rs` runs over a wall).

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::{Random, brick};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Matrix6, Rotation3, Vector3, Vector6};
use wythe::element::hex8::CORNERS;
use wythe::element::{Corotated, ElementShape};
use wythe::material::{DamagePlasticity, MaterialHistory};
use wythe::model::scene::Formulation;

fn element(c: &mut Criterion) {
    let (law, _) = DamagePlasticity::new(&brick(), None).expect("the tables are sound");
    let corners = CORNERS.map(|c| [25.5 * c[0], 24.5 * c[1], 25.0 * c[2]]);
    let shape = ElementShape::new(&corners, Formulation::Incompatible, &brick().elastic)
        .expect("a sound element");
    let mut random = Random(31);
    // Turned by some degrees and pulled beyond the first crack.
    let turn = Rotation3::new(Vector3::new(0.02, -0.03, 0.05));
    let x = corners.map(|c| {
        let noise = Vector3::new(random.signed(), random.signed(), random.signed()) * 1e-3;
        (turn * (Vector3::new(1.0006 * c[0], c[1], c[2]) + noise)).into()
    });
    let frame = Corotated::new(&shape, &x).expect("a sound element");
    let strains = shape.strains(&frame.local);
    let virgin = MaterialHistory::default();
    let cracked = strains.map(|e| {
        let answer = law.update(&(e * 0.8), &virgin, 1.0, false);
        answer.expect("an answer").history
    });

    let mut group = c.benchmark_group("hex8");
    group.bench_function("frame", |b| {
        b.iter(|| Corotated::new(&shape, black_box(&x)));
    });
    group.bench_function("strains", |b| {
        b.iter(|| shape.strains(black_box(&frame.local)));
    });
    let mut cell = vec![0.0; 576];
    for (name, old) in [("intact", [virgin; 8]), ("damaged", cracked)] {
        for (kind, tangent) in [("force", false), ("force_and_stiffness", true)] {
            group.bench_function(format!("extrapolated_{name}/{kind}"), |b| {
                b.iter(|| {
                    let frame = Corotated::new(&shape, black_box(&x)).expect("a frame");
                    let strains = shape.strains(&frame.local);
                    let mut stresses = [Vector6::zeros(); 8];
                    let mut intact = [1.0; 8];
                    for g in 0..8 {
                        (intact[g], stresses[g]) = law.extrapolated(&strains[g], &old[g], 1.0);
                    }
                    let local = shape.internal_force(&stresses);
                    if tangent {
                        let k = shape.scaled_stiffness(&intact);
                        frame.stiffness(&shape, &k, &local, black_box(&mut cell));
                    }
                    frame.force(&shape, &local)
                });
            });
        }
    }
    for (kind, tangent) in [("force", false), ("force_and_stiffness", true)] {
        group.bench_function(format!("implicit_cracked/{kind}"), |b| {
            b.iter(|| {
                let frame = Corotated::new(&shape, black_box(&x)).expect("a frame");
                let strains = shape.strains(&frame.local);
                let mut stresses = [Vector6::zeros(); 8];
                let mut tangents = [Matrix6::zeros(); 8];
                for g in 0..8 {
                    let answer = law.update(&strains[g], &cracked[g], 1.0, tangent);
                    let answer = answer.expect("an answer");
                    (stresses[g], tangents[g]) = (answer.stress, answer.tangent);
                }
                let local = shape.internal_force(&stresses);
                if tangent {
                    let k = shape.stiffness(&tangents);
                    frame.stiffness(&shape, &k, &local, black_box(&mut cell));
                }
                frame.force(&shape, &local)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, element);
criterion_main!(benches);
