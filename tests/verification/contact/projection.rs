//! Closest points of facets against brute force, and near vertices, edges and faces.

use crate::common::Random;
use nalgebra::{Rotation3, Vector3};
use wythe::contact::projection::{extend, project};
use wythe::contact::surface::point_at;

type Corners = [[f64; 3]; 4];

const UNIT: Corners = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

/// The corners rotated, moved and scaled.
fn placed(corners: &Corners, size: f64, turn: &Rotation3<f64>, at: &Vector3<f64>) -> Corners {
    corners.map(|c| (turn * (size * Vector3::from(c)) + at).into())
}

/// Distance by sampling the whole facet, then shrinking squares around the ten best samples.
fn sampled_distance(p: &Vector3<f64>, corners: &Corners) -> f64 {
    const N: i32 = 40;
    let at = |xi: [f64; 2]| (p - point_at(corners, xi)).norm();
    let mut samples = Vec::new();
    for i in -N..=N {
        for j in -N..=N {
            let xi = [i, j].map(|k| f64::from(k) / f64::from(N));
            samples.push((at(xi), xi));
        }
    }
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = f64::INFINITY;
    for &(mut d, mut xi) in &samples[..10] {
        let mut step = 1.0 / f64::from(N);
        while step > 1e-10 {
            let (before, from) = (d, xi);
            for (i, j) in [
                (1, 0),
                (-1, 0),
                (0, 1),
                (0, -1),
                (1, 1),
                (-1, -1),
                (1, -1),
                (-1, 1),
            ] {
                let to = [from[0] + f64::from(i) * step, from[1] + f64::from(j) * step]
                    .map(|v| v.clamp(-1.0, 1.0));
                let there = at(to);
                if there < d {
                    (d, xi) = (there, to);
                }
            }
            if d >= before {
                step *= 0.5;
            }
        }
        best = best.min(d);
    }
    best
}

#[test]
fn distance_equals_sampling_on_flat_and_warped_facets() {
    let mut random = Random(31);
    let (mut inside, mut outside) = (0, 0);
    for k in 0..600 {
        let warp = [0.0, 0.02, 0.15, 0.4][k % 4];
        let corners = UNIT.map(|c| {
            [
                c[0] + 0.3 * random.signed(),
                c[1] + 0.3 * random.signed(),
                warp * random.signed(),
            ]
        });
        let size = [1.0, 50.0, 1e-6, 1e4][k / 4 % 4];
        let turn = Rotation3::new(Vector3::from([0, 1, 2].map(|_| 3.0 * random.signed())));
        let corners = placed(&corners, size, &turn, &Vector3::zeros());
        let local = [1.6, 1.6, 0.8].map(|s| s * random.signed());
        let p = turn * (size * Vector3::from(local));
        let found = project(&p, &corners);
        let expected = sampled_distance(&p, &corners);
        // The sampled distance is an upper bound. Its error is the square of the last step over the distance, or the
        // step itself (1e-10) if the distance vanishes.
        let error = (found.distance - expected) / size;
        assert!(error.abs() < 1e-9, "{k}: {error:.2e} {found:?}");
        assert!((point_at(&corners, found.xi) - found.point).norm() <= 1e-14 * size * 4.0);
        assert!(found.xi.iter().all(|v| v.abs() <= 1.0));
        if found.inside {
            inside += 1;
            // Tolerance: rounding of a unit normal times the distance.
            assert!((found.gap.abs() - found.distance).abs() < 1e-12 * size);
        } else {
            outside += 1;
        }
        let side = found.normal.dot(&(p - found.point));
        assert!((found.gap - side).abs() <= 1e-15 * size);
    }
    assert!(inside > 100 && outside > 100, "{inside} {outside}");
}

#[test]
fn a_foot_is_where_the_perpendicular_stands() {
    let mut random = Random(32);
    for k in 0..400 {
        let warp = [0.0, 0.05, 0.2][k % 3];
        let corners = UNIT.map(|c| {
            [
                c[0] + 0.2 * random.signed(),
                c[1] + 0.2 * random.signed(),
                warp * random.signed(),
            ]
        });
        let xi = [1.2 * random.signed(), 1.2 * random.signed()];
        // A point on the normal at ξ, nearer than any radius of curvature.
        let normal = wythe::contact::frame_at(&corners, xi)[0];
        let gap = 0.1 * random.signed();
        let p = point_at(&corners, xi) + normal * gap;
        let foot = extend(&p, &corners, [0.0; 2]).expect("a foot");
        // Tolerance: rounding over the facet's curvature.
        assert!(
            (foot.xi[0] - xi[0]).abs() < 1e-11 && (foot.xi[1] - xi[1]).abs() < 1e-11,
            "{k}"
        );
        assert!((foot.gap - gap).abs() < 1e-13 && (foot.normal - normal).norm() < 1e-11);
        assert_eq!(foot.inside, xi[0].abs() <= 1.0 && xi[1].abs() <= 1.0);
    }
}

#[test]
fn about_vertices_edges_and_faces() {
    // Exact distance to the square [−1, 1]² × 0, at ±1e-12 around vertices, edges and faces.
    let turn = Rotation3::new(Vector3::new(0.3, -0.7, 1.1));
    let centre = Vector3::new(3.0, -2.0, 5.0);
    for (turn, centre) in [(Rotation3::identity(), Vector3::zeros()), (turn, centre)] {
        let corners = placed(&UNIT, 1.0, &turn, &centre);
        for place in 0..27 {
            let at = [place % 3, place / 3 % 3, place / 9].map(|k| f64::from(k) - 1.0);
            for d in 0..27 {
                let by = [d % 3, d / 3 % 3, d / 9].map(|k| (f64::from(k) - 1.0) * 1e-12);
                let p = [at[0] + by[0], at[1] + by[1], 0.1 * at[2] + by[2]];
                let out = |v: f64| (v.abs() - 1.0).max(0.0);
                let expected = Vector3::new(out(p[0]), out(p[1]), p[2]).norm();
                let q = turn * Vector3::from(p) + centre;
                let found = project(&q, &corners);
                // Tolerance: rounding of coordinates of size 6.
                assert!((found.distance - expected).abs() < 8e-15, "{p:?} {found:?}");
                assert!((found.gap - p[2]).abs() < 8e-15, "{p:?} {found:?}");
                assert!((found.normal - turn * Vector3::z()).norm() < 1e-14);
            }
        }
    }
}

#[test]
fn collapsed_facets_give_their_closest_point() {
    let mut random = Random(33);
    // Triangles (two coincident corners, exactly or nearly), needles and points; of any size.
    for k in 0..400 {
        let mut corners = UNIT;
        let e = [0.0, 1e-13, -1e-13, 1e-300][k / 5 % 4];
        match k % 5 {
            0 => corners[3] = [corners[2][0] + e, corners[2][1], 0.0],
            1 => corners[1] = [corners[0][0], corners[0][1] + e, e],
            2 => corners = [UNIT[0], UNIT[1], UNIT[1], UNIT[0]],
            3 => corners = [UNIT[0]; 4].map(|c| [c[0] + e, c[1], c[2]]),
            _ => corners[2] = [0.0, 0.0, 0.0],
        }
        let size = [1.0, 1e-9, 1e3][k % 3];
        let turn = Rotation3::new(Vector3::from([0, 1, 2].map(|_| random.signed())));
        let corners = placed(&corners, size, &turn, &Vector3::zeros());
        let p = if k % 7 == 0 {
            // On the collapsed corner itself.
            Vector3::from(corners[k % 4])
        } else {
            turn * (size * Vector3::from([0, 1, 2].map(|_| 1.5 * random.signed())))
        };
        let found = project(&p, &corners);
        let numbers = found
            .point
            .iter()
            .chain(found.normal.iter())
            .chain(&found.xi);
        assert!(
            numbers
                .chain([&found.gap, &found.distance])
                .all(|v| v.is_finite()),
            "{found:?}"
        );
        assert!((found.normal.norm() - 1.0).abs() < 1e-14);
        let expected = sampled_distance(&p, &corners);
        // Upper bound as above; a vanishing distance is sampled to 1e-10.
        let error = (found.distance - expected) / size;
        assert!(error.abs() < 1e-9, "{k}: {error:.2e} {found:?}");
        // If a facet has no area, no foot is returned.
        if let Some(foot) = extend(&p, &corners, [0.0; 2]) {
            assert!(foot.xi.iter().chain([&foot.gap]).all(|v| v.is_finite()));
            assert!(k % 5 != 2 && k % 5 != 3, "{k}");
        }
    }
}
