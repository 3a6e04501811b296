//! One point against one facet as a small element: forces, rigid motions, exact stiffness.

use crate::common::Random;
use nalgebra::{Matrix3, Rotation3, Vector3};
use wythe::contact::projection::project;
use wythe::contact::surface::point_at;
use wythe::contact::{
    Anchor, Kinematics, Part, PointsAlong, SlavePoint, corner_points, gauss_points, points_of,
    write_stiffness,
};

/// Slave corners 0 to 3, master corners 4 to 7 [mm].
type Nodes = [[f64; 3]; 8];

/// One configuration with a law that is linear around it.
struct Case {
    nodes: Nodes,
    weights: [f64; 4],
    anchor: [f64; 2],
    area: f64,
    /// Traction at `gap` [MPa].
    traction: [f64; 3],
    gap: [f64; 3],
    tangent: Matrix3<f64>,
}

impl Case {
    fn kinematics(&self, nodes: &Nodes) -> Kinematics {
        let [s0, s1, s2, s3, m0, m1, m2, m3] = *nodes;
        let anchor = Anchor::Same(self.anchor);
        let master = [m0, m1, m2, m3];
        Kinematics::new(&[s0, s1, s2, s3], &self.weights, &master, [0.0; 2], anchor)
            .expect("a foot")
    }

    /// Forces of the law t + K (g − g₀).
    fn force(&self, nodes: &Nodes) -> [[f64; 3]; 8] {
        let kin = self.kinematics(nodes);
        let by = Vector3::new(kin.gap, kin.slip[0], kin.slip[1]) - Vector3::from(self.gap);
        let traction = Vector3::from(self.traction) + self.tangent * by;
        let mut force = [[0.0; 3]; 8];
        kin.add_force(&traction.into(), self.area, &mut force);
        force
    }
}

/// Facets of about 2 mm, one above the other.
fn case(random: &mut Random, warp: f64, height: f64, slip: f64) -> Case {
    let facet = |random: &mut Random, z: f64, flip: bool| {
        let flat = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let mut corners = flat.map(|[x, y]| {
            [
                x + 0.2 * random.signed(),
                y + 0.2 * random.signed(),
                z + warp * random.signed(),
            ]
        });
        if flip {
            corners.swap(1, 3);
        }
        corners
    };
    let slave = facet(random, height, true);
    let master = facet(random, 0.0, false);
    let turn = Rotation3::new(Vector3::from([0, 1, 2].map(|_| 2.0 * random.signed())));
    let mut nodes = [[0.0; 3]; 8];
    for (node, x) in nodes.iter_mut().zip(slave.iter().chain(&master)) {
        *node = (turn * Vector3::from(*x)).into();
    }
    let point = gauss_points(&slave, &Part::WHOLE)[(random.uniform() * 4.0) as usize];
    let mut result = Case {
        nodes,
        weights: point.weights,
        anchor: [slip * random.signed(), slip * random.signed()],
        area: point.area,
        traction: [0, 1, 2].map(|_| 2.0 * random.signed()),
        gap: [0.0; 3],
        tangent: Matrix3::from_fn(|_, _| 5.0 * random.signed()),
    };
    let kin = result.kinematics(&result.nodes);
    result.gap = [kin.gap, kin.slip[0], kin.slip[1]];
    result
}

/// Cell stiffness `[a][b][i][j]` as a function of (row node, row, column node, column).
fn entry(cell: &[f64], a: usize, i: usize, b: usize, j: usize) -> f64 {
    cell[(a * 8 + b) * 9 + 3 * i + j]
}

#[test]
fn exact_stiffness_equals_central_differences() {
    let mut random = Random(41);
    // Flat or warped; touching, penetrating or open; without slip or with large slip.
    for warp in [0.0, 0.05, 0.2] {
        for height in [0.0, -0.02, 0.3] {
            for slip in [0.0, 0.9] {
                for _ in 0..8 {
                    let case = case(&mut random, warp, height, slip);
                    let kin = case.kinematics(&case.nodes);
                    let mut cell = vec![0.0; 24 * 24];
                    kin.add_exact_stiffness(&case.traction, &case.tangent, case.area, &mut cell);
                    let largest = cell.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                    for b in 0..8 {
                        for j in 0..3 {
                            let h = 1e-5;
                            let side = |s: f64| {
                                let mut nodes = case.nodes;
                                nodes[b][j] += s * h;
                                case.force(&nodes)
                            };
                            let (up, down) = (side(1.0), side(-1.0));
                            for a in 0..8 {
                                for i in 0..3 {
                                    let difference = (up[a][i] - down[a][i]) / (2.0 * h);
                                    let error = (difference - entry(&cell, a, i, b, j)).abs();
                                    // Tolerance: h² times third derivatives (curvature over 2 mm), and rounding
                                    // 1e-15/h: 1e-9 to 1e-10 each.
                                    assert!(
                                        error < 1e-8 * largest,
                                        "warp {warp}, height {height}, slip {slip}: {error:.1e} \
                                         of {largest:.1e} at ({a},{i};{b},{j})"
                                    );
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn material_stiffness_is_the_exact_one_of_an_unloaded_joint() {
    let mut random = Random(42);
    for _ in 0..50 {
        // Without traction, gap and slip there is no geometric stiffness.
        let mut case = case(&mut random, 0.2, 0.0, 0.0);
        let kin = case.kinematics(&case.nodes);
        let [.., m0, m1, m2, m3] = case.nodes;
        let foot = point_at(&[m0, m1, m2, m3], kin.xi);
        for a in 0..4 {
            // The slave is moved along the normal until the point lies on the master.
            let up = kin.frame[0] * kin.gap;
            (0..3).for_each(|i| case.nodes[a][i] -= up[i]);
        }
        case.anchor = kin.xi;
        case.tangent = case.tangent + case.tangent.transpose();
        let kin = case.kinematics(&case.nodes);
        assert!(kin.gap.abs() < 1e-14 && kin.slip.iter().all(|s| s.abs() < 1e-14));
        assert!(foot.iter().all(|v| v.is_finite()));
        let (mut material, mut exact) = (vec![0.0; 24 * 24], vec![0.0; 24 * 24]);
        // Two halves sum to the whole.
        let half = kin.stiffness(&case.tangent, 0.5 * case.area);
        write_stiffness(&[half; 2], &mut material);
        kin.add_exact_stiffness(&[0.0; 3], &case.tangent, case.area, &mut exact);
        for a in 0..8 {
            for b in 0..8 {
                for i in 0..3 {
                    for j in 0..3 {
                        let k = entry(&material, a, i, b, j);
                        // Tolerance: rounding of entries of size 10.
                        assert!((k - entry(&exact, a, i, b, j)).abs() < 1e-12);
                        assert!((k - entry(&material, b, j, a, i)).abs() < 1e-13);
                    }
                }
            }
        }
    }
}

#[test]
fn the_force_works_on_the_gap_and_is_in_balance() {
    let mut random = Random(43);
    for _ in 0..200 {
        let case = case(&mut random, 0.2, 0.1, 0.5);
        let kin = case.kinematics(&case.nodes);
        let sigma = case.traction[0];
        let mut force = [[0.0; 3]; 8];
        kin.add_force(&[sigma, 0.0, 0.0], case.area, &mut force);
        // Tension pulls the slave towards the master: its internal force points along n.
        let on_slave: Vector3<f64> = force[..4].iter().map(|f| Vector3::from(*f)).sum();
        assert!((on_slave - kin.frame[0] * (sigma * case.area)).norm() < 1e-13);
        // δW = σ δu A for any motion of the nodes.
        let motion = [(); 8].map(|()| [0, 1, 2].map(|_| random.signed()));
        let h = 1e-6;
        let moved = |s: f64| {
            let mut nodes = case.nodes;
            for (x, v) in nodes.iter_mut().zip(&motion) {
                (0..3).for_each(|i| x[i] += s * h * v[i]);
            }
            case.kinematics(&nodes).gap
        };
        let rate = (moved(1.0) - moved(-1.0)) / (2.0 * h);
        let power: f64 = force
            .iter()
            .zip(&motion)
            .map(|(f, v)| (0..3).map(|i| f[i] * v[i]).sum::<f64>())
            .sum();
        // Tolerance of the central difference: rounding 1e-15/h and h².
        assert!(
            (power - sigma * rate * case.area).abs() < 1e-8,
            "{power} {rate}"
        );
        // Forces of the full traction are in equilibrium; moments as well if it acts along one line.
        let mut sum = Vector3::zeros();
        let mut moment = Vector3::zeros();
        for (x, f) in case.nodes.iter().zip(&force) {
            sum += Vector3::from(*f);
            moment += Vector3::from(*x).cross(&Vector3::from(*f));
        }
        // Tolerance: rounding of forces of 5 N.
        assert!(sum.norm() < 1e-14 && moment.norm() < 1e-13);
        let mut whole = [[0.0; 3]; 8];
        kin.add_force(&case.traction, case.area, &mut whole);
        let sum: Vector3<f64> = whole.iter().map(|f| Vector3::from(*f)).sum();
        assert!(sum.norm() < 1e-14);
    }
}

#[test]
fn rigid_motion_changes_no_gap_and_turns_the_force() {
    let mut random = Random(44);
    for _ in 0..200 {
        let case = case(&mut random, 0.2, 0.1, 0.5);
        let turn = Rotation3::new(Vector3::from([0, 1, 2].map(|_| 2.0 * random.signed())));
        let by = Vector3::from([0, 1, 2].map(|_| 3.0 * random.signed()));
        let moved = case.nodes.map(|x| (turn * Vector3::from(x) + by).into());
        let (a, b) = (case.kinematics(&case.nodes), case.kinematics(&moved));
        // Tolerance: rounding of coordinates of 5 mm through the projection.
        assert!((a.gap - b.gap).abs() < 1e-13);
        assert!((0..2).all(|k| (a.slip[k] - b.slip[k]).abs() < 1e-13));
        let mut forces = [[[0.0; 3]; 8]; 2];
        a.add_force(&case.traction, case.area, &mut forces[0]);
        b.add_force(&case.traction, case.area, &mut forces[1]);
        for (f, g) in forces[0].iter().zip(&forces[1]) {
            assert!((turn * Vector3::from(*f) - Vector3::from(*g)).norm() < 1e-12);
        }
    }
}

#[test]
fn slip_is_measured_from_the_anchor() {
    // A flat master of 4 mm × 2 mm: slip is the path along ξ and η, the gap is the height.
    let master = [
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [4.0, 2.0, 0.0],
        [0.0, 2.0, 0.0],
    ];
    let slave = [
        [1.0, 0.5, 0.3],
        [1.0, 1.5, 0.3],
        [3.0, 1.5, 0.3],
        [3.0, 0.5, 0.3],
    ];
    let anchor = Anchor::Same([-0.5, 0.5]);
    let kin = Kinematics::new(&slave, &[0.25; 4], &master, [0.0; 2], anchor).expect("a foot");
    assert!((kin.gap - 0.3).abs() < 1e-15);
    assert!((kin.slip[0] - 1.0).abs() < 1e-15 && (kin.slip[1] + 0.5).abs() < 1e-15);
    // An anchor at the same place on another facet gives the same slip.
    let elsewhere = Anchor::At([1.0, 1.5, 0.0]);
    let other = Kinematics::new(&slave, &[0.25; 4], &master, [0.0; 2], elsewhere).expect("a foot");
    assert!((0..2).all(|k| (kin.slip[k] - other.slip[k]).abs() < 1e-15));
}

/// Lobatto points of two neighbouring parts integrate polynomials of degree 5 over both, and lie at their ends. In the
/// other direction the points are those of Gauss.
#[test]
fn lobatto_points_integrate_to_the_edges() {
    let corners = [
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
    ];
    let along = |points: &[SlavePoint], d: usize| -> Vec<(f64, f64)> {
        let place = |p: &SlavePoint| (0..4).map(|a| p.weights[a] * corners[a][d]).sum();
        points.iter().map(|p| (place(p), p.area)).collect()
    };
    let row_of = |count: u32| -> Vec<SlavePoint> {
        let halves = [PointsAlong::FirstHalf, PointsAlong::SecondHalf];
        let parts = Part::grid([count, 1]).zip(halves.into_iter().cycle());
        let points =
            parts.flat_map(|(part, half)| points_of(&corners, &part, [half, PointsAlong::Gauss]));
        points.collect()
    };
    let points = row_of(2);
    for power in 0..=5 {
        let exact = if power % 2 == 0 {
            4.0 / f64::from(power + 1)
        } else {
            0.0
        };
        let sum: f64 = along(&points, 0)
            .iter()
            .map(|(x, area)| area * x.powi(power))
            .sum();
        // The outer points lie 5e-7 inside the ends.
        assert!((sum - exact).abs() < 1e-5, "{power}: {sum} {exact}");
    }
    let farthest = along(&points, 0)
        .iter()
        .map(|(x, _)| x.abs())
        .fold(0.0, f64::max);
    assert!((farthest - 1.0).abs() < 1e-6);
    assert!(
        along(&points, 1)
            .iter()
            .all(|(y, _)| (y.abs() - 1.0 / 3.0_f64.sqrt()).abs() < 1e-12)
    );
    // Four parts in a row are two such pairs.
    let row = row_of(4);
    let at_the_middle = along(&row, 0)
        .iter()
        .filter(|(x, _)| x.abs() < 1e-6)
        .count();
    assert_eq!(at_the_middle, 4);
}

#[test]
fn points_integrate_facets() {
    let mut random = Random(45);
    for _ in 0..100 {
        let flat = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corners = flat.map(|[x, y]| {
            [
                25.0 * (x + 0.3 * random.signed()),
                10.0 * (y + 0.3 * random.signed()),
                3.0,
            ]
        });
        let [a, b, c, d] = corners.map(Vector3::from);
        let area = 0.5 * (c - a).cross(&(d - b)).norm();
        let sum = |points: &[SlavePoint; 4]| points.iter().map(|p| p.area).sum::<f64>();
        let (gauss, corner) = (
            gauss_points(&corners, &Part::WHOLE),
            corner_points(&corners, &Part::WHOLE),
        );
        // a₁ × a₂| is linear over a flat facet, so that both rules integrate it up to rounding.
        assert!((sum(&gauss) - area).abs() < 1e-12 * area);
        assert!((sum(&corner) - area).abs() < 1e-12 * area);
        // First moments ∫ N_a dA are exact by Gauss quadrature: partition of unity and linear weight.
        for p in gauss.iter().chain(&corner) {
            assert!((p.weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
        let moment = |points: &[SlavePoint; 4]| -> Vector3<f64> {
            let parts = points.iter().map(|p| {
                (0..4)
                    .map(|k| p.weights[k] * Vector3::from(corners[k]))
                    .sum::<Vector3<f64>>()
                    * p.area
            });
            parts.sum()
        };
        let third = |p: Vector3<f64>, q: Vector3<f64>, r: Vector3<f64>| {
            (p + q + r) / 3.0 * 0.5 * (q - p).cross(&(r - p)).z
        };
        let exact = third(a, b, c) + third(a, c, d);
        assert!((moment(&gauss) - exact).norm() < 1e-11 * area);
        // Corner points are moved by up to 4e-5 mm.
        assert!((moment(&corner) - exact).norm() < 1e-4 * area);
        // The corner points lie inside by 1e-6 of the half facet.
        for (k, p) in corner.iter().enumerate() {
            let x: Vector3<f64> = (0..4)
                .map(|a| p.weights[a] * Vector3::from(corners[a]))
                .sum();
            let away = (x - Vector3::from(corners[k])).norm();
            assert!(away > 1e-7 && away < 1e-4);
            assert!(project(&x, &corners).inside);
        }
    }
}

/// Corner points of a parallelogram have a quarter of its area each.
#[test]
fn corner_points_of_a_parallelogram_have_equal_areas() {
    let corners = [
        [0.0, 0.0, 1.0],
        [30.0, 4.0, 1.0],
        [37.0, 19.0, 1.0],
        [7.0, 15.0, 1.0],
    ];
    // 30 × 15 − 4 × 7 in all.
    for p in corner_points(&corners, &Part::WHOLE) {
        assert!((p.area - 0.25 * 422.0).abs() < 1e-12); // rounding
    }
}
