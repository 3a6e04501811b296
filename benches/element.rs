//! One hex8 element in its corotational frame: elastic, with one yielding point, extrapolated with damage,
//! cracked.
//!
//! Not covered: transfer from and to memory (`benches/system.rs` evaluates a whole wall).

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::{Random, brick};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Rotation3, Vector3};
use wythe::assembly::bulk;
use wythe::assembly::bulk::{ElementSlot, Marks};
use wythe::assembly::pattern::CELL;
use wythe::assembly::{Evaluation, Solids, Turning};
use wythe::element::Formulation;
use wythe::element::hex8::CORNERS;
use wythe::element::{Corotated, ElementShape};
use wythe::material::{DamagePlasticity, Material, MaterialHistory, PointEnergy};

/// Corners of an element, bent and stretched until exactly one Gauss point yields.
fn one_yielding(
    shape: &ElementShape,
    law: &DamagePlasticity,
    corners: &[[f64; 3]; 8],
) -> [[f64; 3]; 8] {
    let virgin = MaterialHistory::default();
    let at = |size: f64| {
        CORNERS.map(|c| {
            let bent = 1.0 + 0.3 * c[1] + 0.2 * c[2] + 0.1 * c[1] * c[2];
            [size * c[0] * bent, 0.5 * size * c[0]]
        })
    };
    for step in 1..1000 {
        let mut x = *corners;
        for (x, u) in x.iter_mut().zip(at(1e-4 * f64::from(step))) {
            x[0] += u[0];
            x[1] += u[1];
        }
        let frame = Corotated::new(shape, &x).expect("a sound element");
        let yields = |e| {
            law.update(e, &virgin, 1.0, false)
                .expect("an answer")
                .history
                .kappa_t
                > 0.0
        };
        if shape
            .strains(&frame.local)
            .iter()
            .filter(|e| yields(*e))
            .count()
            == 1
        {
            return x;
        }
    }
    panic!("no stretch lets a single point yield");
}

#[expect(clippy::too_many_lines, reason = "a list of what is timed")]
fn element(c: &mut Criterion) {
    let (law, _) = DamagePlasticity::new(&brick(), None).expect("the tables are sound");
    let corners = CORNERS.map(|c| [25.5 * c[0], 24.5 * c[1], 25.0 * c[2]]);
    let shape = ElementShape::new(&corners, Formulation::Incompatible, &brick().elastic)
        .expect("a sound element");
    let mut random = Random(31);
    // Rotated by some degrees and pulled beyond the first crack.
    let turn = Rotation3::new(Vector3::new(0.02, -0.03, 0.05));
    let x = corners.map(|c| {
        let noise = Vector3::new(random.signed(), random.signed(), random.signed()) * 1e-3;
        (turn * (Vector3::new(1.0006 * c[0], c[1], c[2]) + noise)).into()
    });
    // Some MPa of compression, as in a loaded wall.
    let pressed = corners.map(|c| (turn * Vector3::new(c[0], c[1], 0.9999 * c[2])).into());
    let bent = one_yielding(&shape, &law, &corners);
    let frame = Corotated::new(&shape, &x).expect("a sound element");
    let strains = shape.strains(&frame.local);
    let virgin = MaterialHistory::default();
    let cracked = strains.map(|e| {
        let answer = law.update(&(e * 0.8), &virgin, 1.0, false);
        answer.expect("an answer").history
    });

    let mut group = c.benchmark_group("hex8");
    let mut cell = vec![0.0; CELL];
    let law = Material::DamagePlasticity(Box::new(law));
    let extrapolated = Solids::Extrapolated { ratio: 1.0 };
    let mut damaged = [virgin; 8];
    damaged[2] = cracked[2];
    let mut force = [[0.0; 3]; 8];
    let mut energy = PointEnergy::default();
    let cases = vec![
        ("secant_elastic", Solids::Secant, [virgin; 8], pressed),
        ("held_elastic", Solids::Held, [virgin; 8], pressed),
        ("implicit_elastic", Solids::Implicit, [virgin; 8], pressed),
        ("secant_one_yielding", Solids::Secant, [virgin; 8], bent),
        ("softened_one_yielding", Solids::Softened, [virgin; 8], bent),
        ("implicit_one_yielding", Solids::Implicit, [virgin; 8], bent),
        ("extrapolated_intact", extrapolated, [virgin; 8], x),
        ("extrapolated_one_point_damaged", extrapolated, damaged, x),
        ("extrapolated_damaged", extrapolated, cracked, x),
        ("secant_cracking", Solids::Secant, [virgin; 8], x),
        ("secant_cracked", Solids::Secant, cracked, x),
        ("softened_cracked", Solids::Softened, cracked, x),
        ("implicit_cracked", Solids::Implicit, cracked, x),
    ];
    for (name, solids, old, x) in cases {
        let mut new = old;
        let mut marks = Marks::of(&old, &new);
        for (kind, tangent) in [("force", false), ("force_and_stiffness", true)] {
            let setting = Evaluation {
                dt: 1.0,
                solids,
                shifted: true,
                tangent,
                turning: Turning::Ignored,
            };
            group.bench_function(format!("{name}/{kind}"), |b| {
                b.iter(|| {
                    let mut slot = ElementSlot {
                        force: &mut force,
                        cell: &mut cell,
                        written: &mut false,
                        new: &mut new,
                        energy: &mut energy,
                        marks: &mut marks,
                        kept: None,
                    };
                    bulk::element(&shape, &law, black_box(&x), &old, setting, &mut slot)
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, element);
criterion_main!(benches);
