//! The kernels for four points at once against the plain kernels for one point.

use crate::common::Random;
use crate::common::scene::{self, Face};
use nalgebra::{Matrix3, Rotation3, Vector3};
use wythe::assembly::{Evaluation, Solids, System, Trial, Turning};
use wythe::contact::pairs::stays_on;
use wythe::contact::surface::point_at;
use wythe::contact::{
    Anchor, CohesiveFrictional, FourPlaced, FourSeen, Kinematics, Lanes, PointStiffness, Symmetric,
    extend, write_stiffness, write_symmetric,
};
use wythe::model::Model;
use wythe::state::Clock;

/// Size of the facets, and their distance from the origin [mm].
const SIZE: f64 = 25.0;
const FAR: f64 = 1000.0;
/// Number of rounding errors of the coordinates that a length may accumulate in either kernel.
const ROUNDING: f64 = 32.0 * f64::EPSILON * FAR;

type Corners = [[f64; 3]; 4];

/// A facet whose corners deviate from a rectangle by up to `skew` [mm], and from a plane by up to `warp`.
fn facet(random: &mut Random, skew: f64, warp: f64) -> Corners {
    let turn = Rotation3::from_euler_angles(
        3.0 * random.signed(),
        3.0 * random.signed(),
        3.0 * random.signed(),
    );
    let place = Vector3::from_fn(|_, _| FAR * random.signed());
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[s, t]| {
        let local = Vector3::new(
            SIZE * s + skew * random.signed(),
            SIZE * t + skew * random.signed(),
            warp * random.signed(),
        );
        (turn * local + place).into()
    })
}

/// A slave facet whose point `p` lies above its master facet at ξ, with the distance `gap`.
struct Case {
    slave: Corners,
    weights: [[f64; 4]; 4],
    master: [Corners; 4],
    xi: [[f64; 2]; 4],
    start: [[f64; 2]; 4],
    anchor: [[f64; 2]; 4],
}

impl Case {
    /// Every point is a corner of the slave, so that it can be placed freely.
    fn new(random: &mut Random, warp: f64, xi: [[f64; 2]; 4]) -> Self {
        let mut weights = [[0.0; 4]; 4];
        (0..4).for_each(|p| weights[p][p] = 1.0);
        let master = [(); 4].map(|()| facet(random, 3.0, warp));
        let slave = [0, 1, 2, 3].map(|p| {
            let axes = wythe::contact::frame_at(&master[p], xi[p]);
            (point_at(&master[p], xi[p]) + axes[0] * (0.1 * random.signed())).into()
        });
        let mut near = |by: f64| xi.map(|xi| xi.map(|v| v + by * random.signed()));
        Self {
            slave,
            weights,
            start: near(0.02),
            anchor: near(0.001),
            master,
            xi,
        }
    }

    fn four(&self) -> FourSeen {
        let origin = self.slave[0];
        let mut placed = FourPlaced::default();
        for p in 0..4 {
            placed.place(p, &origin, &self.master[p], self.start[p], self.anchor[p]);
        }
        let slave = self.slave.map(|c| [0, 1, 2].map(|i| c[i] - origin[i]));
        let weights = [0, 1, 2, 3].map(|a| Lanes(self.weights.map(|w| w[a])));
        FourSeen::new(&slave, &weights, &placed)
    }

    fn plain(&self, p: usize) -> Option<Kinematics> {
        let anchor = Anchor::Same(self.anchor[p]);
        let (weights, master) = (&self.weights[p], &self.master[p]);
        Kinematics::new(&self.slave, weights, master, self.start[p], anchor)
    }

    fn check(&self) {
        let four = self.four();
        for p in 0..4 {
            let plain = self.plain(p).expect("a foot");
            assert!(four.seen[p], "{:?}", self.xi[p]);
            let near = |a: f64, b: f64, scale: f64, what: &str| {
                assert!(
                    (a - b).abs() <= scale,
                    "{what} of {:?}: {a} {b}",
                    self.xi[p]
                );
            };
            near(four.gap.0[p], plain.gap, ROUNDING, "gap");
            for i in 0..2 {
                near(four.slip[i].0[p], plain.slip[i], 2.0 * ROUNDING, "slip");
                near(four.xi[i].0[p], plain.xi[i], 2.0 * ROUNDING / SIZE, "foot");
                // The given position: on a warped facet the gap direction rotates with the normal.
                near(
                    four.xi[i].0[p],
                    self.xi[p][i],
                    4.0 * ROUNDING / SIZE,
                    "place",
                );
            }
            for axis in 0..3 {
                for i in 0..3 {
                    let (a, b) = (four.frame[axis][i].0[p], plain.frame[axis][i]);
                    near(a, b, 2.0 * ROUNDING / SIZE, "frame");
                }
            }
            for a in 0..8 {
                near(
                    four.weights[a].0[p],
                    plain.weights()[a],
                    2.0 * ROUNDING / SIZE,
                    "weight",
                );
            }
        }
    }
}

#[test]
fn four_points_on_random_facets_equal_single_points() {
    let mut random = Random(11);
    for warp in [0.0, 1e-6, 0.01, 1.0] {
        for _ in 0..500 {
            let xi = [(); 4].map(|()| [1.2 * random.signed(), 1.2 * random.signed()]);
            Case::new(&mut random, warp, xi).check();
        }
    }
}

#[test]
fn four_points_within_rounding_of_an_edge_equal_single_points() {
    let mut random = Random(12);
    for warp in [0.0, 0.3] {
        for by in [-1e-12, 0.0, 1e-12] {
            for edge in [-1.0, 1.0, 1.0 + 1e-3, -1.0 - 1e-3] {
                let along = random.signed();
                let at = edge + by;
                let xi = [[at, along], [along, at], [at, at], [at, -at]];
                Case::new(&mut random, warp, xi).check();
            }
        }
    }
}

/// A point with a difficult projection is left to the plain kernel, and the other points are not affected.
#[test]
fn difficult_points_are_left_to_the_plain_kernel() {
    let mut random = Random(13);
    for hard in 0..4 {
        let xi = [[0.3, -0.2], [0.9, 0.9], [-0.5, 0.1], [0.0, 0.7]];
        let mut case = Case::new(&mut random, 0.2, xi);
        let before = case.four();
        for kind in 0..4 {
            match kind {
                // Collapsed to a line, to a point, to NaN; and a distant start.
                0 => case.master[hard][3] = case.master[hard][0],
                1 => case.master[hard] = [case.master[hard][1]; 4],
                2 => case.master[hard] = [[f64::NAN; 3]; 4],
                _ => case.start[hard] = [40.0, 40.0],
            }
            if kind == 0 {
                case.master[hard][2] = case.master[hard][1];
            }
            let four = case.four();
            assert!(!four.seen[hard] || case.plain(hard).is_some(), "{kind}");
            for p in (0..4).filter(|&p| p != hard) {
                assert!(four.seen[p]);
                assert_eq!(four.gap.0[p], before.gap.0[p], "{kind} {p}");
                assert_eq!(four.xi[0].0[p], before.xi[0].0[p], "{kind} {p}");
            }
        }
    }
}

/// Both kernels agree whether a point near an edge stays on its facet, unless rounding decides.
#[test]
fn both_kernels_agree_whether_a_point_stays_on_its_facet() {
    let mut random = Random(14);
    let edge = 1.0 + 1e-3;
    for _ in 0..200 {
        for by in [-1e-10, 1e-10] {
            let xi = [(); 4].map(|()| [edge + by, 0.9 * random.signed()]);
            let case = Case::new(&mut random, 0.1, xi);
            let four = case.four();
            for p in 0..4 {
                let foot = extend(&case.slave[p].into(), &case.master[p], case.start[p]);
                let foot = foot.expect("a foot").xi;
                assert_eq!(stays_on(foot), by < 0.0);
                assert_eq!(stays_on(four.xi.map(|v| v.0[p])), by < 0.0);
            }
        }
    }
}

#[test]
fn a_cell_equals_the_plain_sum_of_its_points() {
    let mut random = Random(15);
    for count in 1..=4 {
        for _ in 0..50 {
            let (mut fast, mut plain) = (Vec::new(), Vec::new());
            for _ in 0..count {
                let weights = [(); 8].map(|()| random.signed());
                let axes = Rotation3::from_euler_angles(random.signed(), random.signed(), 1.0);
                let axes = axes.matrix().column_iter().map(|c| [c[0], c[1], c[2]]);
                let frame: Vec<[f64; 3]> = axes.collect();
                let frame = [frame[0], frame[1], frame[2]];
                let k = [140.0, 60.0, 20.0 * random.signed(), 30.0];
                let tangent = Matrix3::new(k[0], 0.0, 0.0, 0.0, k[1], k[2], 0.0, k[2], k[3]);
                let rotation = Matrix3::from_columns(&frame.map(Vector3::from));
                fast.push(Symmetric::new(weights, &frame, k, 600.0));
                plain.push(PointStiffness {
                    weights,
                    block: rotation * tangent * rotation.transpose() * 600.0,
                });
            }
            let (mut a, mut b) = (vec![f64::NAN; 576], vec![f64::NAN; 576]);
            write_symmetric(pulp::Scalar::new(), &fast, &mut a);
            write_stiffness(&plain, &mut b);
            for (k, (a, b)) in a.iter().zip(&b).enumerate() {
                // Tolerance: a few rounding errors of the largest entries of four points.
                assert!(
                    (a - b).abs() <= 4.0 * 16.0 * f64::EPSILON * 84_000.0,
                    "{k}: {a} {b}"
                );
            }
        }
    }
}

/// Two blocks of 60 × 40 × 20 mm on each other, with facets of 30 × 20 below and 20 × 20 above.
fn two_blocks() -> Model {
    let mut model = scene::empty();
    let (size, material) = ([60.0, 40.0, 20.0], scene::elastic(1000.0, 0.2));
    let lower = scene::block(&mut model, [0.0; 3], size, [2, 2, 1], &material);
    let upper = scene::block(&mut model, [0.0, 0.0, 20.0], size, [3, 2, 1], &material);
    scene::master(&mut model, &lower, Face::Top);
    let law = CohesiveFrictional::dry(0.6, 200.0, 90.0);
    scene::slave(&mut model, &upper, Face::Bottom, law);
    model
}

/// A search that uses the forces from the same positions finds the same pairs as a search without them. Facets are
/// passed, edges are left, and steps are too high.
#[test]
fn pairs_are_the_same_with_and_without_earlier_forces() {
    let model = two_blocks();
    let mut random = Random(16);
    let mut system = System::new(&model).unwrap();
    let state = system.initial_state(&model);
    let setting = Evaluation {
        dt: 1.0,
        solids: Solids::Held,
        shifted: true,
        tangent: false,
        turning: Turning::Ignored,
    };
    let (mut passed, mut lost) = (0, 0);
    for _ in 0..6 {
        let mut trial = Trial::default();
        system.start(&model, &mut trial, &state);
        system.search(&mut trial, &state.q);
        let mut at = [0.0; 3];
        let ends = [0, 1].map(|_| 30.0 * random.signed());
        for step in 0..40 {
            for i in 0..2 {
                at[i] += ends[i] / 40.0;
            }
            at[2] = 0.02 * random.signed() - if step > 30 { 0.4 } else { 0.0 };
            let mut q = state.q.clone();
            for (node, slots) in system.dofs.slot.iter().enumerate() {
                for i in 0..3 {
                    let rigid = if node >= 18 { at[i] } else { 0.0 };
                    q[slots[i] as usize] = rigid + 0.01 * random.signed();
                }
            }
            let mut anew = trial.clone();
            let mut clock = Clock::default();
            system
                .evaluate(&model, &state, &mut trial, &q, setting, &mut clock)
                .unwrap();
            system.search(&mut trial, &q);
            system.search(&mut anew, &q);
            for (known, found) in trial.joints.pairs.iter().zip(&anew.joints.pairs) {
                assert_eq!(known.facet, found.facet);
                for i in 0..2 {
                    // Tolerance: two projections with different starts; coordinates of 60 mm on facets of 20 mm.
                    assert!((known.xi[i] - found.xi[i]).abs() < 1e-13);
                }
            }
            assert_eq!(trial.joints.anchors.len(), anew.joints.anchors.len());
            let changed = state.pairs.iter().zip(&trial.joints.pairs);
            passed += changed
                .filter(|(a, b)| a.facet != b.facet && b.facet.is_some())
                .count();
            lost += trial
                .joints
                .pairs
                .iter()
                .filter(|pair| pair.facet.is_none())
                .count();
        }
    }
    assert!(passed > 100 && lost > 100, "{passed} {lost}");
}
