//! The second-order cone program of the static theorem, solved by the interior-point method of this module or by clarabel.
//!
//! ```text
//! max λ   subject to   G f + r + p + λ q = 0     power of forces, reactions, dead and live loads on each motion
//!                      |t_v| ≤ μ_v n_v + c_v     friction at each corner v
//!                      n_v ≥ −f_v                no tension, or little
//! ```

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver, SolverStatus};
use nalgebra::Vector3;

use super::LimitError;
use super::bodies::{Bodies, RigidBody, Wrench};
use super::interior::{self, Answer, End};
use super::joints::Joint;
use super::matrix::Matrix;
use super::rods::Rod;
use super::scales::ForceScales;
use super::unknowns::Unknowns;

/// A corner of a joint, at which a force acts (Coulomb's law of the joint, its bond shared by the corners).
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

impl Corner {
    /// All corners of joints, joint by joint.
    pub fn all(joints: &[Joint]) -> Vec<Self> {
        let corners = joints.iter().enumerate().flat_map(|(j, joint)| {
            let corners = joint.corners.iter().zip(joint.shares());
            corners.map(move |(at, share)| Self {
                joint: j,
                at: *at,
                friction: joint.strength.friction,
                cohesion: joint.strength.cohesion * share,
                tension: joint.strength.tension * share,
            })
        });
        corners.collect()
    }
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
    /// Motions and forces that are unknown.
    pub unknowns: &'a Unknowns,
    /// Sizes of the forces.
    pub scales: &'a ForceScales,
    /// Velocities by which the corners may slip without opening, for a live power of 1 in the units of the program;
    /// empty for associated friction. `[orbit of corners]`
    pub slips: &'a [f64],
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
    /// Velocity and spin of each body in the mechanism, for a live power of 1. Bodies of groups that take no part in it
    /// are at rest. `[body]`
    pub mechanism: Vec<[Vector3<f64>; 2]>,
    /// Velocity by which each corner slips, in the units of [`Program::slips`]. `[orbit of corners]`
    pub slips: Vec<f64>,
    /// Largest relative velocity of a corner, in these units.
    pub fastest: f64,
    /// Work of the pressures on corners that open or close as they slide, over that of the live loads; that of the
    /// dilatancy if it is associated [-].
    pub opening_work: f64,
    /// Largest velocity by which a corner closes, over the largest relative velocity of a corner [-]: bodies would pass
    /// through each other where slips are allowed that do not happen.
    pub closing: f64,
}

/// Factor below which the gap is relative to this one instead.
const SMALL: f64 = 1e-3;
/// Factors below this, with live loads as large as the dead ones, are zero.
const NOISE: f64 = 1e-7;

fn without_noise(factor: f64) -> f64 {
    if factor.abs() < NOISE { 0.0 } else { factor }
}

/// Part of the work of the loads on the mechanism below which a group of bodies is at rest.
const IDLE: f64 = 1e-6;
/// Relative gap and residual of a solution.
const TOLERANCE: f64 = 1e-9;
/// The same where the solver does not reach it.
const COARSE: f64 = 1e-6;
/// Joints of a body above which it is no part of a regular bond.
const MANY: usize = 30;

/// Solves a program by clarabel.
fn by_clarabel(program: &Matrix, cost: &[f64], tolerance: f64) -> Result<Answer, LimitError> {
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .max_iter(200)
        .tol_gap_abs(tolerance)
        .tol_gap_rel(tolerance)
        .tol_feas(tolerance)
        .build()
        .map_err(|why| LimitError::Solver(why.to_string()))?;
    let columns = program.entries.n;
    let quadratic = CscMatrix::zeros((columns, columns));
    let (right, cones) = (&program.right, &program.cones);
    let solver = DefaultSolver::new(&quadratic, cost, &program.entries, right, cones, settings);
    let mut solver = solver.map_err(|why| LimitError::Solver(why.to_string()))?;
    solver.solve();
    let found = solver.solution;
    let end = match found.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => End::Solved,
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => End::Infeasible,
        SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => End::Unbounded,
        other => return Err(LimitError::Solver(format!("{other:?}"))),
    };
    Ok(Answer {
        end,
        error: tolerance,
        x: found.x,
        y: found.z,
        bound: found.obj_val_dual,
    })
}

impl Program<'_> {
    /// Solves the program.
    ///
    /// # Errors
    /// [`LimitError`]: no state carries the dead loads, no factor is too large, the solver fails.
    pub fn solve(&self) -> Result<Solution, LimitError> {
        let program = self.matrix();
        let cost = self.cost(&program);
        let (nodes, places) = self.nodes();
        let own = interior::solve(&program, &cost, (&nodes, &places), TOLERANCE);
        let sound = |answer: &Answer| answer.end != End::Stalled || answer.error <= COARSE;
        let answer = match own.filter(sound) {
            Some(answer) => answer,
            None => by_clarabel(&program, &cost, TOLERANCE)
                .or_else(|_| by_clarabel(&program, &cost, COARSE))?,
        };
        let live = self.scales.live;
        match answer.end {
            End::Infeasible => {
                let mechanism = self.mechanism(&answer.y);
                return Err(LimitError::Falls(self.fastest(&mechanism)));
            }
            End::Unbounded => return Err(LimitError::Unbounded),
            End::Solved | End::Stalled => {}
        }
        let factor = answer.x[0];
        let size = factor.abs().max(SMALL);
        let objective: f64 = cost.iter().zip(&answer.x).map(|(c, x)| c * x).sum();
        let gap = (objective - answer.bound).abs() / size;
        // A solution that is not in balance to the tolerance is no better than this.
        let miss = if answer.end == End::Stalled {
            answer.error
        } else {
            0.0
        };
        let moved = self.corner_velocities(&program, &answer.y);
        let opening_work = self.opening_work(&answer.x, &moved) / size;
        let fastest = moved.iter().map(|v| v[0].hypot(v[1]));
        let fastest = fastest.fold(0.0, f64::max);
        let closing = moved.iter().fold(0.0, |most: f64, v| most.max(-v[0]));
        Ok(Solution {
            fastest,
            closing: closing / fastest.max(f64::MIN_POSITIVE),
            slips: moved.into_iter().map(|[_, slip]| slip).collect(),
            opening_work,
            factor: without_noise(factor) * live,
            gap: gap.max(miss),
            forces: self.forces(&answer.x),
            rods: self.rod_forces(&answer.x),
            mechanism: self.mechanism(&answer.y),
        })
    }

    /// Costs of the unknowns: −1 of λ, and μ s of the normal force at a corner that may slip by s.
    fn cost(&self, program: &Matrix) -> Vec<f64> {
        let mut cost = vec![0.0; program.entries.n];
        cost[0] = -1.0;
        for ((column, orbit), slip) in self.unknowns.orbits().zip(self.slips) {
            cost[column] = self.corners[orbit.corner].friction * slip;
        }
        cost
    }

    /// Opening and slip of each orbit of corners by the multipliers of the equations.
    fn corner_velocities(&self, program: &Matrix, multipliers: &[f64]) -> Vec<[f64; 2]> {
        let equations = program.equations();
        let entries = &program.entries;
        let velocity = |column: usize| {
            let own = entries.colptr[column]..entries.colptr[column + 1];
            let own = own.filter(|e| entries.rowval[*e] < equations);
            own.map(|e| entries.nzval[e] * multipliers[entries.rowval[e]])
                .sum::<f64>()
        };
        let orbits = (0..self.unknowns.corners.len()).map(|o| {
            let mut own = self.unknowns.columns_of(o).map(velocity);
            let opening = own.next().unwrap_or(0.0);
            [opening, own.map(|v| v.powi(2)).sum::<f64>().sqrt()]
        });
        orbits.collect()
    }

    /// Σ μ n |v − s| over the corners with slips v and allowed slips s, in the units of the program.
    fn opening_work(&self, x: &[f64], moved: &[[f64; 2]]) -> f64 {
        let allowed = self.slips.iter().copied().chain(std::iter::repeat(0.0));
        let orbits = self.unknowns.orbits().zip(moved).zip(allowed);
        let work = orbits.map(|(((column, orbit), [_, slip]), allowed)| {
            let friction = self.corners[orbit.corner].friction;
            (friction * x[column] * (slip - allowed)).abs()
        });
        work.sum()
    }

    /// Body of each equation, and the places of the bodies. A body with many joints has none, so that it is eliminated
    /// last.
    fn nodes(&self) -> (Vec<u32>, Vec<[f64; 3]>) {
        let mut joints = vec![0; self.bodies.all.len()];
        for body in self.joints.iter().flat_map(|joint| joint.bodies) {
            joints[body] += 1;
        }
        let bodies = self.unknowns.motions.iter().enumerate();
        let nodes = bodies.flat_map(|(b, motions)| motions.iter().map(move |_| b as u32));
        let place = |(body, joints): (&RigidBody, &usize)| {
            if *joints > MANY {
                [f64::NAN; 3]
            } else {
                body.centre.into()
            }
        };
        let places = self.bodies.all.iter().zip(&joints).map(place);
        (nodes.collect(), places.collect())
    }

    /// Forces at all corners from the unknowns.
    fn forces(&self, x: &[f64]) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; self.corners.len()];
        for (column, orbit) in self.unknowns.orbits() {
            let joint = &self.joints[self.corners[orbit.corner].joint];
            let directions = self.unknowns.directions(orbit, joint);
            let scale = self.scales.between(joint.bodies);
            let own = &x[column..][..orbit.width];
            let parts = directions.iter().zip(own);
            let force: Vector3<f64> = parts.map(|(along, part)| along * (scale * part)).sum();
            for member in orbit.members() {
                let force = self.unknowns.at_member(orbit, member, self.corners, force);
                let [normal, first, second] = self.joints[self.corners[member].joint].frame;
                forces[member] = [-normal, first, second].map(|along| force.dot(&along));
            }
        }
        forces
    }

    /// Forces of all rods from the unknowns.
    fn rod_forces(&self, x: &[f64]) -> Vec<f64> {
        let mut forces = vec![0.0; self.rods.len()];
        for ((r, image), force) in self
            .unknowns
            .rods
            .iter()
            .zip(&x[self.unknowns.first_rod()..])
        {
            let scale = self.scales.between(self.rods[*r].bodies());
            for rod in [Some(*r), *image].into_iter().flatten() {
                forces[rod] = scale * force;
            }
        }
        forces
    }

    /// Whether each group takes part in a mechanism: the loads do work on its bodies. Groups that do not have velocities of
    /// the size of the tolerance over that of their forces, which is large for a light group. `[group]`
    fn moving(&self, multipliers: &[f64], first: &[usize]) -> Vec<bool> {
        let [dead, live] = self.loads.map(|loads| {
            self.scales.sums(|b| {
                let part = self.unknowns.stands_for(b) / self.scales.of_body(b);
                let motions = self.unknowns.motions[b].iter();
                let own = motions.zip(&multipliers[first[b]..]);
                own.map(|(motion, rate)| part * rate * motion.power(&loads[b]))
                    .sum()
            })
        });
        let both = dead.iter().zip(live);
        let both = both.map(|(dead, live)| dead.abs() + self.scales.live * live.abs());
        let works: Vec<f64> = both.collect();
        let most = works.iter().copied().fold(0.0, f64::max);
        works.iter().map(|work| *work >= IDLE * most).collect()
    }

    /// Velocities and spins from the multipliers of the equations.
    fn mechanism(&self, multipliers: &[f64]) -> Vec<[Vector3<f64>; 2]> {
        let first = self.unknowns.first_rows();
        let moving = self.moving(multipliers, &first);
        let moves = |b: usize| self.scales.group(b).is_some_and(|group| moving[group]);
        let bodies = self.unknowns.motions.iter().enumerate();
        let moved = bodies.map(|(b, motions)| {
            let mut moved = [Vector3::<f64>::zeros(); 2];
            let motions = motions.iter().enumerate();
            for (m, motion) in motions.filter(|_| moves(b)) {
                let rate = self.scales.live / self.scales.of_body(b) * multipliers[first[b] + m];
                moved[0] += rate * motion.velocity;
                moved[1] += rate * motion.spin;
            }
            moved
        });
        let mut moved: Vec<_> = moved.collect();
        if let Some(mirror) = &self.unknowns.mirror {
            for b in 0..moved.len() {
                if mirror.stands_for(b) == 0 {
                    moved[b] = mirror.mirrored(moved[mirror.image_of(b)]);
                }
            }
        }
        moved
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
