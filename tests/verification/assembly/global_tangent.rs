//! The assembled tangent against finite differences of the assembled force, with contact in all its states.

use crate::common::Random;
use crate::common::scene::{self, Face};
use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};
use wythe::assembly::{Evaluation, Solids, System, Trial, Turning};
use wythe::contact::{CohesiveFrictional, PointStatus};
use wythe::element::Formulation;
use wythe::material::MaterialParameters;
use wythe::model::Model;
use wythe::model::scene::ContactPoints;
use wythe::state::{Clock, State};

/// Two blocks of 60 × 40 × 20 mm, one on the other, 2 × 2 facets below and 3 × 2 above.
fn two_blocks(material: &MaterialParameters, law: CohesiveFrictional) -> Model {
    let mut model = scene::empty();
    let size = [60.0, 40.0, 20.0];
    let lower = scene::block(&mut model, [0.0; 3], size, [2, 2, 1], material);
    let upper = scene::block(&mut model, [0.0, 0.0, 20.0], size, [3, 2, 1], material);
    scene::master(&mut model, &lower, Face::Top);
    scene::slave(&mut model, &upper, Face::Bottom, law);
    model
}

/// Nodes of the lower block of [`two_blocks`].
const LOWER: usize = 18;

/// Soft enough that differences of 1e-6 mm stay on one branch: f_t/k_n = 1e-3 mm.
fn soft(law: CohesiveFrictional) -> CohesiveFrictional {
    CohesiveFrictional {
        mu: 0.8 * law.tan_phi,
        normal_stiffness: 200.0,
        shear_stiffness: 90.0,
        ..law
    }
}

struct Rig {
    model: Model,
    system: System,
    state: State,
    trial: Trial,
    clock: Clock,
}

impl Rig {
    fn new(model: Model) -> Self {
        let mut system = System::new(&model).unwrap();
        let state = system.initial_state(&model);
        Self {
            model,
            system,
            state,
            trial: Trial::default(),
            clock: Clock::default(),
        }
    }

    fn force(&mut self, q: &[f64], setting: Evaluation) -> Vec<f64> {
        let Self {
            model,
            system,
            state,
            trial,
            clock,
        } = self;
        system
            .evaluate(model, state, trial, q, setting, clock)
            .unwrap();
        trial.force.clone()
    }

    /// Evaluates an increment to `q`, with pairs searched there.
    fn go(&mut self, q: &[f64], setting: Evaluation) {
        self.trial.start(&self.state);
        self.system.search(&mut self.trial, q);
        self.force(q, setting);
    }

    fn commit(&mut self, q: &[f64]) {
        self.state.q.copy_from_slice(q);
        self.state.interface.clone_from(&self.trial.joints.history);
        self.state.material.clone_from(&self.trial.solids.history);
        self.state.pairs.clone_from(&self.trial.joints.pairs);
    }

    /// ∂F/∂q from the assembled cells and from central differences, with the statuses of the points.
    fn tangents(
        &mut self,
        q: &[f64],
        setting: Evaluation,
    ) -> (DMatrix<f64>, DMatrix<f64>, Vec<PointStatus>) {
        let n = q.len();
        self.force(
            q,
            Evaluation {
                tangent: true,
                ..setting
            },
        );
        let status = self.trial.joints.status.clone();
        let mut assembled = DMatrix::zeros(n, n);
        let mut direction = vec![0.0; n];
        for j in 0..n {
            direction[j] = 1.0;
            assembled.set_column(j, &self.system.multiply(&self.trial, &direction).into());
            direction[j] = 0.0;
        }
        let mut differences = DMatrix::zeros(n, n);
        let mut moved = q.to_vec();
        for j in 0..n {
            moved[j] = q[j] + STEP;
            let above = self.force(&moved, setting);
            assert_eq!(
                self.trial.joints.status, status,
                "a point changed its branch"
            );
            moved[j] = q[j] - STEP;
            let below = self.force(&moved, setting);
            assert_eq!(
                self.trial.joints.status, status,
                "a point changed its branch"
            );
            moved[j] = q[j];
            for i in 0..n {
                differences[(i, j)] = (above[i] - below[i]) / (2.0 * STEP);
            }
        }
        (assembled, differences, status)
    }
}

/// Step of the differences [mm]: a thousandth of the elastic opening of [`soft`].
const STEP: f64 = 1e-6;

const DIRECT: Evaluation = Evaluation {
    dt: 1.0,
    solids: Solids::Implicit,
    shifted: false,
    tangent: false,
    turning: Turning::Ignored,
};

const SHIFTED: Evaluation = Evaluation {
    shifted: true,
    ..DIRECT
};

/// Motion of the upper block relative to the lower one: tilt about y through the middle of the joint, spin about z
/// through one of its corners, and shift [mm].
struct Relative {
    tilt: f64,
    spin: f64,
    shift: [f64; 3],
    /// Random nodal displacements [mm].
    rough: f64,
}

/// Positions with all nodes rotated by `turn` and the upper block moved by `relative`.
fn place(model: &Model, turn: &Matrix3<f64>, relative: &Relative, random: &mut Random) -> Vec<f64> {
    let mut q = Vec::new();
    for (node, x) in model.mesh.nodes.iter().enumerate() {
        let x = Vector3::from(*x);
        let mut y = x;
        if node >= LOWER {
            let (tilt, spin) = (
                Vector3::new(0.0, relative.tilt, 0.0),
                Vector3::new(0.0, 0.0, relative.spin),
            );
            let (middle, corner) = (
                Vector3::new(30.0, 20.0, 20.0),
                Vector3::new(60.0, 0.0, 20.0),
            );
            y += tilt.cross(&(x - middle))
                + spin.cross(&(x - corner))
                + Vector3::from(relative.shift);
        }
        for i in 0..3 {
            y[i] += relative.rough * random.signed();
        }
        q.extend((turn * y - x).iter());
    }
    q
}

fn turn() -> Matrix3<f64> {
    let axis = Vector3::new(1.0, 2.0, 3.0).normalize();
    Rotation3::from_scaled_axis(axis * 0.7).into_inner()
}

fn count(status: &[PointStatus], which: PointStatus) -> usize {
    status.iter().filter(|s| **s == which).count()
}

/// Largest entry of the difference divided by the largest entry.
fn distance(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    (a - b).amax() / b.amax()
}

/// Two increments of tilting and sliding, with points that open, stick, slide and unload. `aside` [mm] is an
/// additional shift of the upper block in the first increment.
fn mixed_states(
    rig: &mut Rig,
    setting: Evaluation,
    turn: &Matrix3<f64>,
    aside: [f64; 3],
    rough: f64,
) -> Vec<f64> {
    let mut random = Random(7);
    let first = Relative {
        tilt: 4e-4,
        spin: 3e-4,
        shift: [aside[0] + 4e-3, aside[1], aside[2] - 2e-3],
        rough,
    };
    let q = place(&rig.model, turn, &first, &mut random);
    rig.go(&q, setting);
    rig.commit(&q);
    let second = Relative {
        tilt: 3e-4,
        spin: 1.5e-3,
        shift: [aside[0] + 6e-3, aside[1] + 1e-3, aside[2] - 3e-3],
        rough,
    };
    let q = place(&rig.model, turn, &second, &mut random);
    rig.go(&q, setting);
    q
}

#[test]
fn direct_tangent_with_open_sticking_and_sliding_points_of_turned_bodies() {
    let law = soft(crate::common::table_3());
    for formulation in [
        Formulation::Full,
        Formulation::BBar,
        Formulation::Incompatible,
    ] {
        // The solids are as soft as the interface, so that neither dominates.
        let mut model = two_blocks(&scene::elastic(2000.0, 0.15), law);
        model.formulation = formulation;
        let mut rig = Rig::new(model);
        let q = mixed_states(&mut rig, DIRECT, &turn(), [0.0; 3], 5e-4);
        let (assembled, differences, status) = rig.tangents(&q, DIRECT);
        let counts =
            [PointStatus::Open, PointStatus::Stick, PointStatus::Slip].map(|s| count(&status, s));
        assert!(counts.iter().all(|&c| c > 0), "{counts:?}");
        let damaged = rig.trial.joints.history.iter();
        let damaged = damaged.filter(|h| h.damage > 0.0 && h.damage < 1.0).count();
        assert!(damaged > 0, "no point softens");
        let error = distance(&assembled, &differences);
        println!("{formulation:?}: {counts:?}, {damaged} damaged, error {error:.1e}");
        // Tolerance: positions near 60 mm are rounded to 7e-15 mm; over a step of 1e-6 mm that is 7e-9 of K.
        assert!(error < 2e-8, "{formulation:?}: {error:e}");
        // Friction is non-associated, so that the tangent must be unsymmetric.
        assert!(distance(&assembled.transpose(), &assembled) > 1e-3);
    }
}

#[test]
fn direct_tangent_with_cracked_and_crushed_solids_and_corner_points() {
    let law = CohesiveFrictional {
        f_t: 4.0,
        c: 8.0,
        ..soft(crate::common::table_3())
    };
    let mortar = MaterialParameters::DamagePlasticity(crate::common::mortar(2300.0));
    let mut model = two_blocks(&mortar, law);
    model.contact.points = ContactPoints::Corner;
    let mut rig = Rig::new(model);
    // Nodes of 20 mm elements move by 0.06 mm: strains beyond the mortar's cracking, 1.5/2300. The block is shifted,
    // because its corners would otherwise lie on the edges of the master's facets and cross them.
    let q = mixed_states(&mut rig, DIRECT, &turn(), [1.0, 2.0, -0.05], 0.06);
    let pairs = rig.trial.joints.pairs.iter().zip(&rig.state.pairs);
    let facing = pairs.clone().filter(|(now, _)| now.facet.is_some()).count();
    assert!(
        facing < rig.trial.joints.pairs.len()
            && pairs.filter(|(a, b)| a.facet != b.facet).count() == 0
    );
    let (assembled, differences, status) = rig.tangents(&q, DIRECT);
    let counts =
        [PointStatus::Open, PointStatus::Stick, PointStatus::Slip].map(|s| count(&status, s));
    let cracked = rig
        .trial
        .solids
        .history
        .iter()
        .filter(|h| h.tensile_damage > 0.0);
    let (cracked, error) = (cracked.count(), distance(&assembled, &differences));
    println!(
        "{counts:?}, {cracked} of {} cracked, error {error:.1e}",
        rig.trial.solids.history.len()
    );
    assert!(counts.iter().all(|&c| c > 0) && cracked > 10);
    // Tolerance: rounding as above. The curvature of the return map adds less: (1e-6/20 / 6.5e-4)²/6 = 1e-9.
    assert!(error < 2e-8, "{error:e}");
}

#[test]
fn a_point_that_crossed_to_the_next_facet_keeps_an_exact_tangent_for_its_own_motion() {
    let law = CohesiveFrictional::dry(0.6, 200.0, 90.0);
    let mut rig = Rig::new(two_blocks(&scene::elastic(2000.0, 0.15), law));
    let mut random = Random(3);
    let shifted = Relative {
        tilt: 1e-4,
        spin: 0.0,
        shift: [13.0, 0.3, -0.05],
        rough: 5e-4,
    };
    let q = place(&rig.model, &turn(), &shifted, &mut random);
    rig.go(&q, DIRECT);
    let pairs = rig.trial.joints.pairs.iter().zip(&rig.state.pairs);
    let crossed = pairs.filter(|(now, old)| now.facet.is_some() && now.facet != old.facet);
    assert!(crossed.count() >= 4);
    let (assembled, differences, _) = rig.tangents(&q, DIRECT);
    let own = |m: &DMatrix<f64>| m.columns(3 * LOWER, m.ncols() - 3 * LOWER).into_owned();
    let error = distance(&own(&assembled), &own(&differences));
    // Tolerance as in the first test. Slip of 13 mm from a distant anchor rotates no faster than that of 1e-2 mm.
    assert!(error < 2e-8, "{error:e}");
    // The facet where the slip began does not belong to the pair: the effect of its strain is neglected.
    let whole = distance(&assembled, &differences);
    println!("own motion {error:.1e}, with the master's {whole:.1e}");
}

#[test]
fn shifted_tangent_is_symmetric_and_the_derivative_at_the_slave() {
    let virgin = CohesiveFrictional {
        f_t: 20.0,
        c: 20.0,
        // The softening is too slow to raise the numerical stiffness.
        u_k: 100.0,
        delta_k: 100.0,
        ..soft(crate::common::table_3())
    };
    let dry = CohesiveFrictional::dry(0.6, 200.0, 90.0);
    for (name, law) in [
        ("dry", dry),
        ("virgin", virgin),
        ("damaged", soft(crate::common::table_3())),
    ] {
        // The numerical stiffness is 2 E/h = 200 N/mm³; the law must be stiffer to be shifted.
        let law = CohesiveFrictional {
            normal_stiffness: 4.0 * law.normal_stiffness,
            shear_stiffness: 4.0 * law.shear_stiffness,
            ..law
        };
        let mut rig = Rig::new(two_blocks(&scene::elastic(2000.0, 0.15), law));
        // The lower block keeps its shape.
        let q = mixed_states(&mut rig, SHIFTED, &turn(), [0.0; 3], 0.0);
        // The normal traction of the last iterate bounds the shear.
        rig.trial.keep_tractions();
        let (assembled, differences, status) = rig.tangents(&q, SHIFTED);
        let slides = count(&status, PointStatus::Slip);
        assert!(
            name == "virgin" || (slides > 0 && slides < status.len()),
            "{name}: {slides} slide"
        );
        // Tolerance: sums of the same products in a different order.
        let asymmetry = distance(&assembled.transpose(), &assembled);
        assert!(asymmetry < 1e-14, "{name}: {asymmetry:e}");
        let n = q.len() - 3 * LOWER;
        let own = |m: &DMatrix<f64>| m.view((3 * LOWER, 3 * LOWER), (n, n)).into_owned();
        let error = distance(&own(&assembled), &own(&differences));
        let whole = distance(&assembled, &differences);
        println!("{name}: slave {error:.1e}, whole {whole:.1e}");
        if name == "damaged" {
            // ∂D and negative stiffness are neglected deliberately, so that the tangent is not the exact derivative.
            assert!(error > 1e-4, "{error:e}");
        } else {
            // The frame of the master rotates only with the master. Tolerance as in the first test.
            assert!(error < 2e-8, "{name}: {error:e}");
        }
        // The rotation of the frame and the motion of the foot are neglected: traction over facet size, relative to
        // the stiffness of solids and contact.
        let traction = rig.trial.shift.traction.iter().flatten();
        let traction = traction.fold(0.0, |most: f64, t| most.max(t.abs()));
        let bound = 4.0 * traction / (20.0 * 200.0);
        assert!(
            name == "damaged" || whole < bound,
            "{name}: {whole:e} of {bound:e}"
        );
    }
}
