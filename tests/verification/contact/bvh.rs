//! The search for contact pairs against brute force, on random and degenerate surfaces.

use crate::common::Random;
use nalgebra::{Rotation3, Vector3};
use wythe::contact::pairs::RIM;
use wythe::contact::projection::extend;
use wythe::contact::{
    Aabb, Bvh, Candidates, Reach, Search, Surface, frame_at, pair_point, to_frame,
};

/// The reach of a point that nothing holds.
fn within(radius: f64) -> Reach {
    Reach {
        radius,
        rim: RIM,
        flush: f64::INFINITY,
        held: false,
    }
}

fn vector(random: &mut Random, size: f64) -> [f64; 3] {
    [0, 1, 2].map(|_| size * random.signed())
}

/// Boxes of all kinds: solid, flat, points, duplicates, and adjacent cells of a lattice.
fn boxes(random: &mut Random, count: usize) -> Vec<Aabb> {
    let mut result: Vec<Aabb> = Vec::new();
    for k in 0..count {
        let centre = vector(random, 10.0);
        let far: [f64; 3] = match k % 5 {
            0 => [0, 1, 2].map(|i| centre[i] + 3.0 * random.uniform()),
            1 => [
                centre[0] + random.uniform(),
                centre[1] + random.uniform(),
                centre[2],
            ],
            2 => centre,
            3 => {
                let cell = centre.map(f64::floor);
                result.push(Aabb::of([&cell, &cell.map(|c| c + 1.0)]));
                continue;
            }
            _ => {
                let twin = result[random_below(random, result.len())];
                result.push(twin);
                continue;
            }
        };
        result.push(Aabb::of([&centre, &far]));
    }
    result
}

fn random_below(random: &mut Random, n: usize) -> usize {
    ((random.uniform() * n as f64) as usize).min(n - 1)
}

#[test]
fn queries_equal_brute_force() {
    let mut random = Random(21);
    let mut stack = Vec::new();
    let mut hits = 0;
    for count in [0, 1, 2, 4, 5, 9, 64, 333] {
        let mut all = boxes(&mut random, count);
        let mut bvh = Bvh::build(&all);
        for round in 0..4 {
            for k in 0..60 {
                // Every other query touches lattice planes exactly.
                let low = vector(&mut random, 10.0).map(|v| if k % 2 == 0 { v } else { v.floor() });
                let size = 8.0 * random.uniform();
                let size = if k % 2 == 0 { size } else { 1.0 };
                let query = Aabb::of([&low, &low.map(|v| v + size)]);
                let mut found = Vec::new();
                bvh.query(&all, &query, &mut stack, |f| found.push(f as usize));
                found.sort_unstable();
                let expected: Vec<usize> =
                    (0..all.len()).filter(|&f| all[f].touches(&query)).collect();
                assert_eq!(found, expected, "{count} boxes, round {round}");
                hits += found.len();

                let near =
                    bvh.nearest(&low, &mut stack, |f| all[f as usize].distance_squared(&low));
                let expected = (0..all.len() as u32)
                    .map(|f| (f, all[f as usize].distance_squared(&low)))
                    .min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
                assert_eq!(near, expected, "{count} boxes, round {round}");
            }
            for aabb in &mut all {
                let by = vector(&mut random, 1.0);
                for i in 0..3 {
                    aabb.min[i] += by[i];
                    aabb.max[i] += by[i];
                }
            }
            bvh.refit(&all);
        }
    }
    // 120 random queries of 4 mm among 333 boxes in 20 mm find several each.
    assert!(hits > 500, "{hits}");
}

/// A slave block above a floor of several bodies, both with randomly displaced nodes.
struct Scene {
    slave: Surface,
    master: Surface,
    x: Vec<[f64; 3]>,
    /// Number of the first slave node.
    first_slave: usize,
}

/// A grid of n × n facets on [0, size]² with normals up or down.
fn grid(x: &mut Vec<[f64; 3]>, n: usize, size: f64, height: f64, up: bool) -> Vec<[u32; 4]> {
    let first = x.len();
    for j in 0..=n {
        for i in 0..=n {
            let at = |k: usize| size * k as f64 / n as f64;
            x.push([at(i), at(j), height]);
        }
    }
    let node = |i: usize, j: usize| (first + j * (n + 1) + i) as u32;
    let mut facets = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [
                node(i, j),
                node(i + 1, j),
                node(i + 1, j + 1),
                node(i, j + 1),
            ];
            facets.push(if up { [a, b, c, d] } else { [a, d, c, b] });
        }
    }
    facets
}

fn scene(random: &mut Random, n_master: usize, n_slave: usize, jitter: f64) -> Scene {
    let mut x = Vec::new();
    let size = 12.0;
    let floor = grid(&mut x, n_master, size, 0.0, true);
    // The floor consists of two bodies, and facets of the slave's own body are among the masters.
    let half = floor.len() / 2;
    let mut body: Vec<u32> = (0..floor.len()).map(|f| u32::from(f >= half)).collect();
    let first_slave = x.len();
    let under = grid(&mut x, n_slave, size, 0.05, false);
    let mut facets = floor;
    facets.extend(&under);
    body.extend(vec![7; under.len()]);
    for p in &mut x {
        let by = vector(random, jitter);
        for i in 0..3 {
            p[i] += by[i] * if i == 2 { 0.1 } else { 1.0 };
        }
    }
    let slave = Surface {
        facets: under.clone(),
        body: vec![7; under.len()],
    };
    Scene {
        slave,
        master: Surface { facets, body },
        x,
        first_slave,
    }
}

/// Positions on a slave facet: Gauss points, corners, edge middles, and ±1e-12 about them.
fn points_on(scene: &Scene, facet: usize) -> Vec<[f64; 3]> {
    let corners = scene.slave.corners(facet, &scene.x);
    let mut result = Vec::new();
    for s in [-1.0, -0.577, 0.0, 0.577, 1.0] {
        for t in [-1.0, -0.577, 0.0, 0.577, 1.0] {
            for e in [-1e-12, 0.0, 1e-12] {
                let (s, t) = (s + e, t - e);
                let n = [
                    0.25 * (1.0 - s) * (1.0 - t),
                    0.25 * (1.0 + s) * (1.0 - t),
                    0.25 * (1.0 + s) * (1.0 + t),
                    0.25 * (1.0 - s) * (1.0 + t),
                ];
                result.push([0, 1, 2].map(|i| (0..4).map(|a| n[a] * corners[a][i]).sum()));
            }
        }
    }
    result
}

/// The nearest facet onto which the point projects: all facets are tried, lowest number first.
fn brute_force(scene: &Scene, facet: usize, p: &[f64; 3], radius: f64) -> Option<u32> {
    let normal = frame_at(&scene.slave.corners(facet, &scene.x), [0.0; 2])[0];
    let mut best: Option<(f64, u32)> = None;
    for m in 0..scene.master.facets.len() {
        let corners = scene.master.corners(m, &scene.x);
        let facing = normal.dot(&frame_at(&corners, [0.0; 2])[0]) < -0.2;
        if scene.master.body[m] == scene.slave.body[facet] || !facing {
            continue;
        }
        let Some(foot) = extend(&Vector3::from(*p), &corners, [0.0; 2]) else {
            continue;
        };
        let over = foot.xi[0].abs().max(foot.xi[1].abs()) <= 1.0 + 1e-9;
        if over && foot.distance <= radius && best.is_none_or(|(d, _)| foot.distance < d) {
            best = Some((foot.distance, m as u32));
        }
    }
    best.map(|(_, m)| m)
}

fn aabbs(scene: &Scene) -> Vec<Aabb> {
    (0..scene.slave.facets.len())
        .map(|f| Aabb::of(&points_on(scene, f)))
        .collect()
}

#[test]
fn pairs_equal_brute_force_while_surfaces_move_within_the_margin() {
    let mut random = Random(22);
    let (radius, skin) = (0.4, 0.3);
    let (mut paired, mut alone) = (0, 0);
    for (n_master, n_slave, jitter) in [(4, 3, 0.0), (3, 4, 0.0), (4, 4, 0.0), (5, 3, 0.4)] {
        let mut s = scene(&mut random, n_master, n_slave, jitter);
        let candidates = Candidates::find(&s.slave, &aabbs(&s), &s.master, &s.x, radius + skin);
        for round in 0..4 {
            for f in 0..s.slave.facets.len() {
                for p in points_on(&s, f) {
                    let found = pair_point(
                        &Vector3::from(p),
                        None,
                        candidates.of(f),
                        &s.master,
                        &s.x,
                        within(radius),
                    );
                    let expected = brute_force(&s, f, &p, radius);
                    assert_eq!(found.map(|(m, _)| m), expected, "round {round}, {p:?}");
                    paired += usize::from(expected.is_some());
                    alone += usize::from(expected.is_none());
                }
            }
            // Each side moves by less than half the search margin, mostly sideways.
            if round == 0 {
                for (k, p) in s.x.iter_mut().enumerate() {
                    let sign = if k >= s.first_slave { 1.0 } else { -1.0 };
                    p[0] += 0.1 * sign;
                    p[1] -= 0.05 * sign;
                }
            } else if round == 1 {
                for p in &mut s.x {
                    let by = vector(&mut random, 0.02);
                    (0..3).for_each(|i| p[i] += by[i]);
                }
            } else {
                // Separation: the gap opens beyond the radius.
                for p in &mut s.x[s.first_slave..] {
                    p[2] += 0.4;
                }
            }
        }
    }
    assert!(paired > 4000 && alone > 1000, "{paired} {alone}");
}

#[test]
fn a_point_over_a_closed_surface_is_never_lost() {
    // Points above vertices, edges and faces of a flat floor, displaced by 0 and ±1e-12 in all directions.
    let mut random = Random(23);
    let mut s = scene(&mut random, 4, 3, 0.0);
    s.master.facets.truncate(16);
    s.master.body.truncate(16);
    let all: Vec<u32> = (0..16).collect();
    for i in 0..=8 {
        for j in 0..=8 {
            for d in 0..27 {
                let by = [d % 3, d / 3 % 3, d / 9].map(|k| (f64::from(k) - 1.0) * 1e-12);
                let p = [
                    1.5 * f64::from(i) + by[0],
                    1.5 * f64::from(j) + by[1],
                    by[2],
                ];
                let found = pair_point(&Vector3::from(p), None, &all, &s.master, &s.x, within(0.1));
                let (facet, xi) = found.unwrap_or_else(|| panic!("lost at {p:?}"));
                let foot = extend(
                    &Vector3::from(p),
                    &s.master.corners(facet as usize, &s.x),
                    xi,
                )
                .expect("a foot");
                // Tolerance: rounding of coordinates up to 12 mm.
                assert!((foot.gap - by[2]).abs() < 1e-14);
                // The pairing does not change, even slightly beyond the edge.
                let again =
                    pair_point(&Vector3::from(p), found, &all, &s.master, &s.x, within(0.1));
                assert_eq!(again.map(|(f, _)| f), Some(facet));
            }
        }
    }
}

#[test]
fn a_refitted_search_finds_what_a_new_one_finds() {
    let mut random = Random(24);
    let mut s = scene(&mut random, 6, 5, 0.2);
    let mut search = Search::default();
    let mut total = 0;
    for _ in 0..5 {
        let points = aabbs(&s);
        let found = search.candidates(&s.slave, &points, &s.master, &s.x, 0.5);
        assert_eq!(
            found,
            Candidates::find(&s.slave, &points, &s.master, &s.x, 0.5)
        );
        for f in 0..s.slave.facets.len() {
            assert!(found.of(f).is_sorted());
        }
        total += found.len();
        for p in &mut s.x[s.first_slave..] {
            p[0] += 1.3;
        }
    }
    assert!(total > 0);
    // A mesh with a different number of facets requires a new hierarchy.
    let s = scene(&mut random, 3, 2, 0.2);
    let points = aabbs(&s);
    let found = search.candidates(&s.slave, &points, &s.master, &s.x, 0.5);
    assert_eq!(
        found,
        Candidates::find(&s.slave, &points, &s.master, &s.x, 0.5)
    );
}

#[test]
fn collapsed_facets_do_not_disturb_the_search() {
    let mut random = Random(25);
    let mut s = scene(&mut random, 4, 3, 0.0);
    let whole: Vec<Option<u32>> = (0..s.slave.facets.len())
        .flat_map(|f| points_on(&s, f).into_iter().map(move |p| (f, p)))
        .map(|(f, p)| brute_force(&s, f, &p, 0.4))
        .collect();
    // Facets without area, needles and points, numbered after the others.
    for f in 0..8 {
        let [a, b, c, _] = s.master.facets[f];
        s.master
            .facets
            .push([[a, a, a, a], [a, b, b, a], [a, c, c, a]][f % 3]);
        s.master.body.push(0);
    }
    let candidates = Candidates::find(&s.slave, &aabbs(&s), &s.master, &s.x, 0.4);
    let mut k = 0;
    for f in 0..s.slave.facets.len() {
        for p in points_on(&s, f) {
            let point = Vector3::from(p);
            let found = pair_point(&point, None, candidates.of(f), &s.master, &s.x, within(0.4));
            assert_eq!(found.map(|(m, _)| m), whole[k], "{p:?}");
            k += 1;
        }
    }
}

#[test]
fn slip_turns_with_the_frame() {
    let mut random = Random(26);
    let axes = [Vector3::z(), Vector3::x(), Vector3::y()];
    for _ in 0..200 {
        let turn = Rotation3::new(Vector3::from(vector(&mut random, 1.0)));
        let from = axes.map(|a| turn * a);
        let v = [random.signed(), random.signed()];
        let w = [random.signed(), random.signed()];
        // A frame with a large rotation; tolerance: rounding.
        let other = Rotation3::new(Vector3::from(vector(&mut random, 1.5)));
        let to = axes.map(|a| other * a);
        let (a, b) = (to_frame(v, &from, &to), to_frame(w, &from, &to));
        assert!((a[0].hypot(a[1]) - v[0].hypot(v[1])).abs() < 1e-14);
        // Differences transform like the vectors: elastic slip is the small difference of large slips.
        let difference = to_frame([v[0] - w[0], v[1] - w[1]], &from, &to);
        for k in 0..2 {
            assert!((difference[k] - (a[k] - b[k])).abs() < 1e-14);
        }
        // Forward and back.
        let back = to_frame(a, &to, &from);
        assert!((back[0] - v[0]).abs() < 1e-14 && (back[1] - v[1]).abs() < 1e-14);
        // For a rotation in the plane the vector itself does not change.
        let spin = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(from[0]), 0.7);
        let spun = from.map(|a| spin * a);
        let c = to_frame(v, &from, &spun);
        let stays = from[1] * v[0] + from[2] * v[1] - spun[1] * c[0] - spun[2] * c[1];
        assert!(stays.norm() < 1e-14);
    }
    // Slip across a right-angled edge continues down the next face: x → −z.
    let next = [Vector3::x(), -Vector3::z(), Vector3::y()];
    let turned = to_frame([1.0, 0.25], &axes, &next);
    // Tolerance: one rounding.
    assert!((turned[0] - 1.0).abs() < 1e-15 && (turned[1] - 0.25).abs() < 1e-15);
}

#[test]
fn a_point_that_faced_a_surface_stays_on_it_a_little_beyond_its_rim() {
    // A facet of 2 x 2 mm, so that parameters are millimetres.
    let master = Surface {
        facets: vec![[0, 1, 2, 3]],
        body: vec![0],
    };
    let x = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| [x, y, 0.0]);
    let pair = |beyond: f64, present| {
        let point = Vector3::new(1.0 + beyond, 0.3, 0.01);
        pair_point(&point, present, &[0], &master, &x, within(0.1))
    };
    let before = Some((0, [1.0, 0.3]));
    let close = |found: Option<(u32, [f64; 2])>, beyond: f64| {
        let (facet, [xi, eta]) = found.unwrap();
        // Tolerance: rounding of one or two divisions.
        facet == 0 && (xi - 1.0 - beyond).abs() < 1e-12 && (eta - 0.3).abs() < 1e-12
    };
    for beyond in [0.0, 5e-4, 0.05, 0.09] {
        assert!(close(pair(beyond, before), beyond), "{beyond}");
    }
    assert_eq!(pair(0.11, before), None);
    // A point that did not face a facet before has only the margin for rounding and settling: a bond does not extend
    // over a rim.
    assert!(close(pair(5e-4, None), 5e-4));
    assert_eq!(pair(0.05, None), None);
}

/// Two facets side by side, the second one of another body and higher by a step. A point that slides from the first one
/// stays at its rim beside the step, up to a tenth of half a facet, and changes at once where there is none.
#[test]
fn a_point_stays_at_the_rim_beside_a_step_of_another_body() {
    let of = |step: f64, second_body: u32| {
        let corner = |x: f64, y: f64, z: f64| [x, y, z];
        let x = vec![
            corner(0.0, 0.0, 0.0),
            corner(2.0, 0.0, 0.0),
            corner(2.0, 2.0, 0.0),
            corner(0.0, 2.0, 0.0),
            corner(2.0, 0.0, step),
            corner(4.0, 0.0, step),
            corner(4.0, 2.0, step),
            corner(2.0, 2.0, step),
        ];
        let master = Surface {
            facets: vec![[0, 1, 2, 3], [4, 5, 6, 7]],
            body: vec![0, second_body],
        };
        let reach = Reach {
            flush: 1e-5,
            ..within(0.5)
        };
        move |beyond: f64| {
            let point = Vector3::new(2.0 + beyond, 1.0, -1e-3);
            let present = Some((0, [0.9, 0.0]));
            pair_point(&point, present, &[0, 1], &master, &x, reach).map(|(facet, _)| facet)
        }
    };
    // Pressed by 1e-3: a step of half as much is none.
    assert_eq!(of(0.0, 1)(0.05), Some(1));
    assert_eq!(of(4e-4, 1)(0.05), Some(1));
    assert_eq!(of(0.1, 1)(0.05), Some(0));
    assert_eq!(of(0.1, 1)(0.2), Some(1));
    // The facets of one body are a surface.
    assert_eq!(of(0.1, 0)(0.05), Some(1));
}
