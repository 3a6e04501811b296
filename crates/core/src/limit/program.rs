//! The second-order cone program of the static theorem, solved by clarabel.
//!
//! ```text
//! max λ   subject to   G f + r + p + λ q = 0     power of forces, reactions, dead and live loads on each motion
//!                      |t_v| ≤ μ_v n_v + c_v     friction at each corner v
//!                      n_v ≥ −f_v                no tension, or little
//! ```

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::{NonnegativeConeT, SecondOrderConeT, ZeroConeT};
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus, SupportedConeT,
};
use nalgebra::Vector3;

use super::LimitError;
use super::bodies::{Bodies, Wrench};
use super::joints::Joint;
use super::rods::Rod;

/// A corner of a joint, at which a force acts.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Index of its joint.
    pub joint: usize,
    /// Place [mm].
    pub at: Vector3<f64>,
    /// Friction [-].
    pub friction: f64,
    /// Largest shear force without pressure [N].
    pub cohesion: f64,
    /// Largest tensile force [N].
    pub tension: f64,
}

/// The program.
pub struct Program<'a> {
    /// Bodies.
    pub bodies: &'a Bodies,
    /// Joints.
    pub joints: &'a [Joint],
    /// Corners.
    pub corners: &'a [Corner],
    /// Dead and live wrenches on the bodies.
    pub loads: [&'a [Wrench]; 2],
    /// Compressive strength of the joints [MPa]; none if it is infinite.
    pub strength: Option<f64>,
    /// Segments of ties.
    pub rods: &'a [Rod],
}

/// Solution of a program.
#[derive(Clone, Debug)]
pub struct Solution {
    /// λ.
    pub factor: f64,
    /// Distance to the bound of λ by the mechanism, over λ [-].
    pub gap: f64,
    /// Force at each corner: normal, compression positive, and two shear forces [N]. `[corner]`
    pub forces: Vec<[f64; 3]>,
    /// Force of each rod, tension positive [N]. `[rod]`
    pub rods: Vec<f64>,
    /// Velocity and spin of each body in the mechanism, for a live power of 1. `[body]`
    pub mechanism: Vec<[Vector3<f64>; 2]>,
}

/// Matrix entries as they are found.
#[derive(Default)]
struct Triplets {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl Triplets {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        if value != 0.0 {
            self.rows.push(row);
            self.columns.push(column);
            self.values.push(value);
        }
    }
}

/// Adds the cone N² ≤ f_c A (N − 2 Σ n_v s_v/h): the block of stress f_c that carries N ends at an edge, h is the depth
/// of the joint towards this edge, and `arms` are the columns of the n_v and 2 s_v/h. With a tensile strength N is
/// N + f_t A, and f_c is f_c + f_t: stresses count from −f_t. `most` is (f_c + f_t) A, `tension` f_t A.
fn add_crushing(
    [most, tension]: [f64; 2],
    arms: &[(usize, f64)],
    entries: &mut Triplets,
    right: &mut Vec<f64>,
) {
    let row = right.len();
    for (column, arm) in arms {
        let left = 1.0 - arm;
        entries.add(row, *column, -left);
        entries.add(row + 1, *column, -2.0);
        entries.add(row + 2, *column, left);
    }
    right.extend([most + tension, 2.0 * tension, most - tension]);
}

/// Factor below which the gap is relative to this one instead.
const SMALL: f64 = 1e-3;
/// Factors below this, with live loads as large as the dead ones, are zero.
const NOISE: f64 = 1e-7;

fn without_noise(factor: f64) -> f64 {
    if factor.abs() < NOISE { 0.0 } else { factor }
}

/// Relative gap and residual of the solution.
const TOLERANCE: f64 = 1e-9;
/// The same where the solver does not reach it.
const COARSE: f64 = 1e-6;

impl Program<'_> {
    /// Solves the program.
    ///
    /// # Errors
    /// [`LimitError`]: no state carries the dead loads, no factor is too large, the solver fails.
    pub fn solve(&self) -> Result<Solution, LimitError> {
        let strict = self.solve_to(TOLERANCE);
        match strict {
            Err(LimitError::Solver(_)) => self.solve_to(COARSE),
            found => found,
        }
    }

    fn solve_to(&self, tolerance: f64) -> Result<Solution, LimitError> {
        let scale = self.force_scale();
        let (matrix, right, cones) = self.matrix(scale);
        let columns = matrix.n;
        let mut cost = vec![0.0; columns];
        cost[0] = -1.0;
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .max_iter(200)
            .tol_gap_abs(tolerance)
            .tol_gap_rel(tolerance)
            .tol_feas(tolerance)
            .build()
            .map_err(|why| LimitError::Solver(why.to_string()))?;
        let quadratic = CscMatrix::zeros((columns, columns));
        let mut solver = DefaultSolver::new(&quadratic, &cost, &matrix, &right, &cones, settings)
            .map_err(|why| LimitError::Solver(why.to_string()))?;
        solver.solve();
        let found = &solver.solution;
        let live = self.live_scale(scale);
        match found.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {}
            SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
                let mechanism = self.mechanism(&found.z, 1.0);
                return Err(LimitError::Falls(self.fastest(&mechanism)));
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => {
                return Err(LimitError::Unbounded);
            }
            other => return Err(LimitError::Solver(format!("{other:?}"))),
        }
        let of_corner = |v: usize| [0, 1, 2].map(|i| scale * found.x[1 + 3 * v + i]);
        Ok(Solution {
            factor: without_noise(found.x[0]) * live,
            gap: (found.x[0] + found.obj_val_dual).abs() / found.x[0].abs().max(SMALL),
            forces: (0..self.corners.len()).map(of_corner).collect(),
            rods: (self.first_rod()..)
                .take(self.rods.len())
                .map(|column| scale * found.x[column])
                .collect(),
            mechanism: self.mechanism(&found.z, 1.0 / live),
        })
    }

    /// Size of the forces: the sum of the dead loads, or the largest force that a bond or a joint without crushing
    /// carries; else 1 N.
    fn force_scale(&self) -> f64 {
        let sizes = self.loads[0].iter().map(|wrench| wrench.force.norm());
        let sum = sizes.sum::<f64>();
        let strengths = self.joints.iter().map(|joint| {
            let bond = joint.strength.cohesion.max(joint.strength.tension);
            bond.max(self.strength.unwrap_or(0.0)) * joint.area
        });
        let rods = self.rods.iter().map(|rod| rod.most);
        let strengths = strengths.chain(rods.filter(|most| most.is_finite()));
        let most = strengths.fold(sum, f64::max);
        // Strengths that no force reaches set no scale.
        let scale = if sum > 0.0 {
            most.min(100.0 * sum)
        } else {
            most
        };
        if scale > 0.0 { scale } else { 1.0 }
    }

    /// Factor of the live loads for the unknown λ of 1: that which makes them as large as the dead ones.
    fn live_scale(&self, scale: f64) -> f64 {
        let powers = self.bodies.all.iter().zip(self.loads[1]);
        let powers = powers.flat_map(|(body, wrench)| {
            body.motions.iter().map(|motion| motion.power(wrench).abs())
        });
        let sum = powers.sum::<f64>();
        if sum > 0.0 { scale / sum } else { 1.0 }
    }

    /// Matrix, right side and cones in the form A x + s = b. Unknowns: λ, forces at the corners, reactions. Forces are
    /// multiples of `scale`.
    fn matrix(&self, scale: f64) -> (CscMatrix<f64>, Vec<f64>, Vec<SupportedConeT<f64>>) {
        let first = self.first_rows();
        let equations = first[self.bodies.all.len()];
        let mut entries = Triplets::default();
        let mut right = vec![0.0; equations];
        let live = self.live_scale(scale) / scale;
        let act = |entries: &mut Triplets, body: usize, column: usize, wrench: &Wrench| {
            for (m, motion) in self.bodies.all[body].motions.iter().enumerate() {
                entries.add(first[body] + m, column, motion.power(wrench));
            }
        };
        for (b, body) in self.bodies.all.iter().enumerate() {
            for (m, motion) in body.motions.iter().enumerate() {
                right[first[b] + m] = -motion.power(&self.loads[0][b]) / scale;
                entries.add(first[b] + m, 0, live * motion.power(&self.loads[1][b]));
            }
        }
        for (v, corner) in self.corners.iter().enumerate() {
            let joint = &self.joints[corner.joint];
            let [normal, first, second] = joint.frame;
            // Compression pushes the first body back against the normal.
            for (i, along) in [-normal, first, second].into_iter().enumerate() {
                for (body, sign) in joint.bodies.into_iter().zip([1.0, -1.0]) {
                    let arm = corner.at - self.bodies.all[body].centre;
                    let wrench = Wrench::at(arm, sign * along);
                    act(&mut entries, body, 1 + 3 * v + i, &wrench);
                }
            }
        }
        let ends = self.rods.iter().map(|rod| &rod.ends[..]);
        let single = self.bodies.reactions.iter().map(|reaction| &reaction[..]);
        for (column, wrenches) in (self.first_rod()..).zip(ends.chain(single)) {
            for (body, wrench) in wrenches {
                act(&mut entries, *body, column, wrench);
            }
        }
        let columns = self.first_rod() + self.rods.len() + self.bodies.reactions.len();
        let mut cones = vec![ZeroConeT(equations)];
        self.add_rods(scale, &mut entries, &mut right, &mut cones);
        self.add_strengths(scale, &mut entries, &mut right, &mut cones);
        let size = (right.len(), columns);
        let Triplets {
            rows,
            columns,
            values,
        } = entries;
        let matrix = CscMatrix::new_from_triplets(size.0, size.1, rows, columns, values);
        (matrix, right, cones)
    }

    /// Column of the first rod; those of reactions follow.
    fn first_rod(&self) -> usize {
        1 + 3 * self.corners.len()
    }

    /// Adds the bounds of the rods.
    fn add_rods(
        &self,
        scale: f64,
        entries: &mut Triplets,
        right: &mut Vec<f64>,
        cones: &mut Vec<SupportedConeT<f64>>,
    ) {
        let before = right.len();
        for (column, rod) in (self.first_rod()..).zip(self.rods) {
            if rod.most.is_finite() {
                entries.add(right.len(), column, 1.0);
                right.push(rod.most / scale);
            }
            let least = if rod.compression { -rod.most } else { 0.0 };
            if least.is_finite() {
                entries.add(right.len(), column, -1.0);
                right.push(-least / scale);
            }
        }
        if right.len() > before {
            cones.push(NonnegativeConeT(right.len() - before));
        }
    }

    /// Adds the cones of the corners.
    fn add_strengths(
        &self,
        scale: f64,
        entries: &mut Triplets,
        right: &mut Vec<f64>,
        cones: &mut Vec<SupportedConeT<f64>>,
    ) {
        for (v, corner) in self.corners.iter().enumerate() {
            let column = 1 + 3 * v;
            let row = right.len();
            entries.add(row, column, -corner.friction);
            entries.add(row + 1, column + 1, -1.0);
            entries.add(row + 2, column + 2, -1.0);
            right.extend([corner.cohesion / scale, 0.0, 0.0]);
            cones.push(SecondOrderConeT(3));
        }
        let row = right.len();
        for (v, corner) in self.corners.iter().enumerate() {
            entries.add(row + v, 1 + 3 * v, -1.0);
            right.push(corner.tension / scale);
        }
        cones.push(NonnegativeConeT(self.corners.len()));
        let Some(strength) = self.strength else {
            return;
        };
        let mut first = 0;
        for joint in self.joints {
            let own = first..first + joint.corners.len();
            first = own.end;
            let tension = joint.strength.tension * joint.area / scale;
            let most = strength * joint.area / scale + tension;
            for arms in joint.arms() {
                let arms = own.clone().map(|v| 1 + 3 * v).zip(arms);
                let arms: Vec<(usize, f64)> = arms.collect();
                add_crushing([most, tension], &arms, entries, right);
                cones.push(SecondOrderConeT(3));
            }
        }
    }

    /// First equation of each body, and their number. `[body + 1]`
    fn first_rows(&self) -> Vec<usize> {
        let mut first = Vec::with_capacity(self.bodies.all.len() + 1);
        let mut next = 0;
        for body in &self.bodies.all {
            first.push(next);
            next += body.motions.len();
        }
        first.push(next);
        first
    }

    /// Velocities and spins from the multipliers of the equations.
    fn mechanism(&self, multipliers: &[f64], scale: f64) -> Vec<[Vector3<f64>; 2]> {
        let first = self.first_rows();
        let bodies = self.bodies.all.iter().enumerate();
        let moved = bodies.map(|(b, body)| {
            let mut moved = [Vector3::zeros(); 2];
            for (m, motion) in body.motions.iter().enumerate() {
                let rate = scale * multipliers[first[b] + m];
                moved[0] += rate * motion.velocity;
                moved[1] += rate * motion.spin;
            }
            moved
        });
        moved.collect()
    }

    /// Body that moves fastest.
    fn fastest(&self, mechanism: &[[Vector3<f64>; 2]]) -> usize {
        let speed =
            |moved: &[Vector3<f64>; 2]| moved[0].norm() + moved[1].norm() * self.bodies.size;
        let all = mechanism.iter().enumerate();
        let fastest = all.max_by(|a, b| speed(a.1).total_cmp(&speed(b.1)));
        fastest.map_or(0, |(body, _)| body)
    }
}
