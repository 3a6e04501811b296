//! Interfaces: one point of the law, one projection, one stencil, and the search over 4,800 facets beside the
//! hierarchy of parry3d.
//!
//! Not covered: distribution over threads, scattering into the matrix, and reading of histories from memory (all
//! data stay in cache).

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::{Random, table_3};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{Matrix3, Vector3};
use parry3d_f64::bounding_volume::Aabb as ParryAabb;
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::partitioning::{Bvh as ParryBvh, BvhBuildStrategy, BvhWorkspace};
use wythe::contact::projection::{extend, project};
use wythe::contact::{
    Aabb, Anchor, Bvh, Candidates, FourPlaced, FourSeen, Kinematics, Lanes, Part, Search, Shift,
    Surface, Symmetric, gauss_points, write_stiffness, write_symmetric,
};

fn law(c: &mut Criterion) {
    let law = table_3();
    let p = -1.0 / law.normal_stiffness;
    let slid = law.update([p, 0.02, 0.01], &law.virgin()).history;
    let opened = law.update([0.01, 0.0, 0.0], &law.virgin()).history;
    let states = [
        ("stick", [p, 1e-6, 2e-6], law.virgin()),
        ("slip", [p, 0.03, 0.02], slid),
        ("softening", [0.02, 0.0, 0.0], opened),
        ("opening_and_slipping", [0.02, 0.01, 0.0], opened),
    ];
    let mut group = c.benchmark_group("interface_point");
    for (name, gap, old) in &states {
        group.bench_function(*name, |b| {
            b.iter(|| law.update(black_box(*gap), black_box(old)).traction);
        });
        let shift = Shift {
            stiffness: [140.0, 60.0],
            traction: old.traction,
            bounding: old.traction[0],
        };
        group.bench_function(format!("{name}_shifted"), |b| {
            b.iter(|| {
                law.update_shifted(black_box(*gap), black_box(old), &shift)
                    .traction
            });
        });
    }
    group.finish();
}

const FLAT: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [51.0, 0.0, 0.0],
    [51.0, 49.0, 0.0],
    [0.0, 49.0, 0.0],
];

/// Corners of the slave facet, weights of its points, and their placement on the master facet.
type Four = ([[f64; 3]; 4], [Lanes; 4], FourPlaced);

/// Gauss points of a slave facet, slightly away from the feet of the last iterate.
fn placed(slave: &[[f64; 3]; 4], master: &[[f64; 3]; 4]) -> Four {
    let (points, mut placed) = (gauss_points(slave, &Part::WHOLE), FourPlaced::default());
    for (p, point) in points.iter().enumerate() {
        let anchor = Anchor::Same([0.0; 2]);
        let kin = Kinematics::new(slave, &point.weights, master, [0.0; 2], anchor);
        let foot = kin.expect("a foot").xi;
        let start = [foot[0] + 1e-4, foot[1] - 1e-4];
        placed.place(p, &[0.0; 3], master, start, foot);
    }
    let weights = [0, 1, 2, 3].map(|a| Lanes([0, 1, 2, 3].map(|p: usize| points[p].weights[a])));
    (*slave, weights, placed)
}

/// [`FourSeen::new`] for the widest vector unit.
struct SeeFour<'a>(&'a Four);

impl pulp::NullaryFnOnce for SeeFour<'_> {
    type Output = FourSeen;

    #[inline(always)]
    fn call(self) -> FourSeen {
        let (slave, weights, placed) = self.0;
        FourSeen::new(slave, weights, placed)
    }
}

/// [`write_symmetric`] for the widest vector unit.
struct Write<'a>(&'a [Symmetric], &'a mut [f64]);

impl pulp::WithSimd for Write<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) {
        write_symmetric(simd, self.0, self.1);
    }
}

fn geometry(c: &mut Criterion) {
    let mut warped = FLAT;
    warped[2] = [52.0, 48.0, 0.7];
    let point = Vector3::new(37.0, 11.0, 0.3);
    let mut group = c.benchmark_group("projection");
    for (name, corners) in [("flat", FLAT), ("warped", warped)] {
        group.bench_function(format!("foot_{name}"), |b| {
            b.iter(|| extend(black_box(&point), black_box(&corners), [0.2, 0.1]));
        });
        group.bench_function(format!("closest_{name}"), |b| {
            b.iter(|| project(black_box(&point), black_box(&corners)));
        });
    }
    group.finish();

    let slave = FLAT.map(|[x, y, z]| [x + 3.0, 49.0 - y, z + 0.01]);
    let weights = [0.25; 4];
    let anchor = Anchor::Same([0.0, 0.0]);
    let kin = Kinematics::new(&slave, &weights, &warped, [0.1, 0.0], anchor).expect("a foot");
    let tangent = Matrix3::from_diagonal(&Vector3::new(140.0, 60.0, 60.0));
    let traction = [-1.0, 0.4, 0.1];
    let mut group = c.benchmark_group("stencil");
    group.bench_function("kinematics", |b| {
        b.iter(|| Kinematics::new(black_box(&slave), &weights, &warped, [0.1, 0.0], anchor));
    });
    let mut cell = vec![0.0; 24 * 24];
    group.bench_function("stiffness_of_four_points", |b| {
        b.iter(|| write_stiffness(&[kin.stiffness(black_box(&tangent), 600.0); 4], &mut cell));
    });
    let placed = placed(&slave, &warped);
    group.bench_function("kinematics_of_four_points", |b| {
        let arch = pulp::Arch::new();
        b.iter(|| arch.dispatch(SeeFour(black_box(&placed))));
    });
    for count in [1, 2, 4] {
        let points = [Symmetric::new(
            [0.2; 8],
            &kin.frame.map(Into::into),
            [140.0, 60.0, 1.0, 60.0],
            600.0,
        ); 4];
        group.bench_function(format!("stiffness_of_{count}_written"), |b| {
            let arch = pulp::Arch::new();
            b.iter(|| arch.dispatch(Write(black_box(&points[..count]), &mut cell)));
        });
    }
    group.bench_function("exact_stiffness", |b| {
        b.iter(|| kin.add_exact_stiffness(&traction, black_box(&tangent), 600.0, &mut cell));
    });
    group.finish();
}

/// 20 courses of 10 blocks of 24 facets: bed faces of 5 × 2, end faces of 1 × 2 facets, half a mortar joint apart.
fn wall() -> (Surface, Vec<[f64; 3]>) {
    let (mut surface, mut x) = (Surface::default(), Vec::new());
    for course in 0..20_u32 {
        for block in 0..10_u32 {
            let shift = if course % 2 == 0 { 0.0 } else { 100.0 };
            let low = [
                f64::from(block) * 200.0 + shift,
                0.0,
                f64::from(course) * 60.0,
            ];
            let mut quad = |p: [[f64; 3]; 4]| {
                let first = x.len() as u32;
                x.extend(p.map(|q| [0, 1, 2].map(|i| low[i] + q[i])));
                surface
                    .facets
                    .push([first, first + 1, first + 2, first + 3]);
                surface.body.push(course * 10 + block);
            };
            for j in 0..2 {
                let (y0, y1) = (f64::from(j) * 50.0, f64::from(j + 1) * 50.0);
                for i in 0..5 {
                    let (a, b) = (f64::from(i) * 40.0, f64::from(i + 1) * 40.0);
                    quad([[a, y0, 0.0], [a, y1, 0.0], [b, y1, 0.0], [b, y0, 0.0]]);
                    quad([[a, y0, 60.0], [b, y0, 60.0], [b, y1, 60.0], [a, y1, 60.0]]);
                }
                quad([
                    [0.0, y0, 0.0],
                    [0.0, y0, 60.0],
                    [0.0, y1, 60.0],
                    [0.0, y1, 0.0],
                ]);
                quad([
                    [200.0, y0, 0.0],
                    [200.0, y1, 0.0],
                    [200.0, y1, 60.0],
                    [200.0, y0, 60.0],
                ]);
            }
        }
    }
    // As in a deformed wall, no facet lies in a plane normal to an axis.
    let mut random = Random(5);
    for p in &mut x {
        for v in p.iter_mut() {
            *v += 0.2 * random.signed();
        }
    }
    (surface, x)
}

fn to_parry(aabb: &Aabb) -> ParryAabb {
    let vector = |v: [f64; 3]| ParryVector::new(v[0], v[1], v[2]);
    ParryAabb::new(vector(aabb.min), vector(aabb.max))
}

fn search(c: &mut Criterion) {
    let (surface, x) = wall();
    let boxes: Vec<Aabb> = (0..surface.facets.len())
        .map(|f| Aabb::of(&surface.corners(f, &x)))
        .collect();
    let queries: Vec<Aabb> = boxes.iter().map(|b| b.fattened(3.0)).collect();
    let parry_boxes: Vec<ParryAabb> = boxes.iter().map(to_parry).collect();
    let parry_queries: Vec<ParryAabb> = queries.iter().map(to_parry).collect();
    let parry_build = || ParryBvh::from_leaves(BvhBuildStrategy::Binned, &parry_boxes);

    let mut ours = Bvh::build(&boxes);
    let mut parry = parry_build();
    let mut stack = Vec::new();
    for (query, parry_query) in queries.iter().zip(&parry_queries) {
        let mut found = Vec::new();
        ours.query(&boxes, query, &mut stack, |f| found.push(f));
        found.sort_unstable();
        let mut same: Vec<u32> = parry.intersect_aabb(parry_query).collect();
        same.sort_unstable();
        assert_eq!(found, same, "both answer alike");
    }

    let mut group = c.benchmark_group(format!("bvh_{}_quads", boxes.len()));
    group.bench_function("build", |b| b.iter(|| Bvh::build(black_box(&boxes))));
    group.bench_function("build_parry", |b| b.iter(parry_build));
    group.bench_function("refit", |b| b.iter(|| ours.refit(black_box(&boxes))));
    let mut workspace = BvhWorkspace::default();
    group.bench_function("refit_parry", |b| {
        b.iter(|| {
            for (f, aabb) in parry_boxes.iter().enumerate() {
                parry.insert_or_update_partially(*aabb, f as u32, 0.0);
            }
            parry.refit(&mut workspace);
        });
    });
    group.bench_function("all_queries", |b| {
        b.iter(|| {
            let mut count = 0;
            for query in &queries {
                ours.query(&boxes, query, &mut stack, |_| count += 1);
            }
            count
        });
    });
    group.bench_function("all_queries_parry", |b| {
        b.iter(|| {
            parry_queries
                .iter()
                .map(|q| parry.intersect_aabb(q).count())
                .sum::<usize>()
        });
    });
    group.bench_function("candidates", |b| {
        b.iter(|| Candidates::find(&surface, &boxes, &surface, &x, 3.0).len());
    });
    let mut search = Search::default();
    group.bench_function("candidates_refitted", |b| {
        b.iter(|| search.candidates(&surface, &boxes, &surface, &x, 3.0).len());
    });
    group.finish();
}

criterion_group!(benches, law, geometry, search);
criterion_main!(benches);
