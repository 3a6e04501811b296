//! Time integration by HHT-α and backward Euler, with their energies (docs/theory/inertia.md, eqs 1 to 6).
//!
//! With masses M, damping C, internal forces p and loads F (Hilber, Hughes, Taylor 1977, eqs 1 to 3, α in
//! [−1/3, 0], β = (1−α)²/4, γ = 1/2 − α):
//!
//! ```text
//! M a₁ + (1+α)(p₁ + C v₁ − F₁) − α (p₀ + C v₀ − F₀) = 0
//! u₁ = u₀ + Δt v₀ + Δt² [(1/2−β) a₀ + β a₁],   v₁ = v₀ + Δt [(1−γ) a₀ + γ a₁]
//! ```
//!
//! The first equation is divided by 1+α. The residual is then one of forces, as in statics, and the stiffness of the
//! cells is unchanged: M/((1+α) β Δt²) is added to it. Backward Euler is v₁ = Δu/Δt, a₁ = Δv/Δt.
//!
//! The first increment of a step always uses backward Euler, which needs neither a₀ nor p₀. When a step starts, loads
//! and velocities jump, and the friction that answers them is not yet in p₀. Half an increment without this friction
//! would be an error of first order in the velocity.
//!
//! # Energies
//! Work follows the trapezoidal rule. With the accelerating force g = F − p − C v and the equation of motion in the
//! form ½(g₀+g₁) = M a₁ − (½+α)(g₁−g₀),
//!
//! ```text
//! work of loads = work of p + work of C v + Δ(½ vᵀ M v) + D
//! D = Δuᵀ M a₁ − ½(v₀+v₁)ᵀ M Δv − (½+α)(g₁−g₀)ᵀ Δu
//! ```
//!
//! D arises at the masses, from the scheme alone. Its first part is the work of the inertia forces beyond the change
//! of kinetic energy, its second part comes from the weights of the forces. For α = 0 it vanishes over a cycle.

use crate::assembly::{Equations, Mass, StiffnessDamping, System, Trial};
use crate::model::scene::{BeamMotion, Procedure, Rayleigh, Step};
use crate::state::Method;
use crate::state::State;

/// A time integration scheme.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scheme {
    /// Backward Euler.
    Euler,
    /// HHT with the parameter α.
    Hht(f64),
}

impl Scheme {
    /// α; 0 for backward Euler.
    fn alpha(self) -> f64 {
        match self {
            Self::Euler => 0.0,
            Self::Hht(alpha) => alpha,
        }
    }

    /// ∂a₁/∂u₁ [1/s²] and ∂v₁/∂u₁ [1/s].
    fn slopes(self, dt: f64) -> [f64; 2] {
        match self {
            Self::Euler => [1.0 / (dt * dt), 1.0 / dt],
            Self::Hht(alpha) => {
                let [beta, gamma] = newmark(alpha);
                [1.0 / (beta * dt * dt), gamma / (beta * dt)]
            }
        }
    }

    /// [v₁, a₁] after a displacement Δu in Δt.
    fn rates(self, du: f64, dt: f64, [v, a]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Euler => {
                let next = du / dt;
                [next, (next - v) / dt]
            }
            Self::Hht(alpha) => {
                let [beta, gamma] = newmark(alpha);
                let next = (du - dt * v - dt * dt * (0.5 - beta) * a) / (beta * dt * dt);
                [v + dt * ((1.0 - gamma) * a + gamma * next), next]
            }
        }
    }
}

/// β and γ of HHT-α.
fn newmark(alpha: f64) -> [f64; 2] {
    [0.25 * (1.0 - alpha) * (1.0 - alpha), 0.5 - alpha]
}

/// State of the time integration within one increment.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Scheme of the step.
    of_step: Scheme,
    /// Scheme of the increment.
    scheme: Scheme,
    /// Whether an impact, in which HHT would gain energy, is repeated by backward Euler.
    shock: bool,
    damping: Rayleigh,
    solids: StiffnessDamping,
    /// Velocity of prescribed slots, none for unknowns [mm/s]. `[slot]`
    prescribed: Vec<Option<f64>>,
    dt: f64,
    /// g at the start of the increment [N]. `[slot]`
    net_start: Vec<f64>,
    /// v₁ [mm/s]. `[slot]`
    velocity: Vec<f64>,
    /// a₁ [mm/s²]. `[slot]`
    acceleration: Vec<f64>,
    /// C v₁ [N]. `[slot]`
    damping_force: Vec<f64>,
    /// Part of M a₁ that couples the nodes of rigid bodies [N]. `[slot]`
    coupled: Vec<f64>,
}

impl Motion {
    /// State for a step solved by `method`; none for methods without inertia. Drives are `slope` times as fast as
    /// without an amplitude.
    pub fn new(
        step: &Step,
        method: Method,
        system: &System,
        equations: &Equations,
        slope: f64,
    ) -> Option<Self> {
        if !method.has_inertia() {
            return None;
        }
        let (scheme, damping) = match step.procedure {
            Procedure::Dynamic { alpha, damping } => (Scheme::Hht(alpha), damping),
            _ => (Scheme::Euler, Rayleigh::default()),
        };
        let slots = system.dofs.slots;
        let mut prescribed = vec![Some(0.0); slots];
        for &slot in &equations.slot_of {
            prescribed[slot as usize] = None;
        }
        let mut motion = Self {
            of_step: scheme,
            scheme,
            shock: false,
            damping,
            solids: StiffnessDamping::new(damping.stiffness),
            prescribed,
            dt: 0.0,
            net_start: vec![0.0; slots],
            velocity: vec![0.0; slots],
            acceleration: vec![0.0; slots],
            damping_force: vec![0.0; slots],
            coupled: vec![0.0; slots],
        };
        motion.drive_at(step, system, slope);
        Some(motion)
    }

    /// Sets the velocities of drives to `slope` times those without an amplitude. Where a displacement steers the
    /// load, drives have no prescribed rate, and the inertia of the driven nodes is neglected.
    pub fn drive_at(&mut self, step: &Step, system: &System, slope: f64) {
        if step.control.is_some() {
            return;
        }
        for (b, motion) in step.motion.iter().enumerate() {
            for (i, motion) in motion.iter().enumerate() {
                if let BeamMotion::Driven(by) = motion {
                    let velocity = slope * (by / step.duration);
                    self.prescribed[system.dofs.beam_slot(b, i)] = Some(velocity);
                }
            }
        }
    }

    /// Sets velocities and damping at the start of the step. Drives jump to their velocity; the energy of this jump
    /// is external work.
    pub fn begin(&mut self, system: &System, state: &mut State, trial: &mut Trial) {
        let mass = &system.mass;
        let before = state.energies.kinetic;
        for (v, prescribed) in state.velocity.iter_mut().zip(&self.prescribed) {
            if let Some(prescribed) = prescribed {
                *v = *prescribed;
            }
        }
        state.energies.kinetic = mass.kinetic_energy(&state.velocity);
        state.energies.external += state.energies.kinetic - before;
        self.velocity.copy_from_slice(&state.velocity);
        self.damp(system, trial, None);
        for (s, prescribed) in self.prescribed.iter().enumerate() {
            // The force on a driven beam balances its damping from the start.
            if prescribed.is_some() {
                state.applied[s] += self.damping_force[s] - state.damping[s];
            }
        }
        state.damping.copy_from_slice(&self.damping_force);
    }

    /// Continues from a commit of this motion.
    pub fn rejoin(&mut self, state: &State) {
        self.velocity.copy_from_slice(&state.velocity);
        self.acceleration.copy_from_slice(&state.acceleration);
        self.damping_force.copy_from_slice(&state.damping);
    }

    /// Starts an increment of `dt` [s] under the loads at its start [N]. `[slot]`
    pub fn start(&mut self, state: &State, dt: f64, loads: &[f64]) {
        self.dt = dt;
        self.scheme = match state.last {
            Some(_) if !self.shock => self.of_step,
            _ => Scheme::Euler,
        };
        for s in 0..loads.len() {
            self.net_start[s] = loads[s] - state.force[s] - state.damping[s];
        }
    }

    /// Selects backward Euler for this increment; false if it was already selected.
    pub fn take_shock(&mut self) -> bool {
        !std::mem::replace(&mut self.shock, true)
    }

    /// Returns to the scheme of the step.
    pub fn end_shock(&mut self) {
        self.shock = false;
    }

    /// Predicted displacements at constant acceleration [mm]. `[slot]`
    pub fn predict(&self, state: &State, q: &mut [f64]) {
        let dt = self.dt;
        for s in 0..q.len() {
            if self.prescribed[s].is_none() {
                q[s] = state.q[s] + dt * (state.velocity[s] + 0.5 * dt * state.acceleration[s]);
            }
        }
    }

    /// Updates velocities, accelerations and damping at displacements `q` [mm] `[slot]`. With `tangent` the stiffness
    /// of the damping is added to that of the elements.
    pub fn update(
        &mut self,
        system: &System,
        state: &State,
        trial: &mut Trial,
        q: &[f64],
        tangent: bool,
    ) {
        for s in 0..q.len() {
            [self.velocity[s], self.acceleration[s]] = if let Some(velocity) = self.prescribed[s] {
                [velocity, 0.0]
            } else {
                let start = [state.velocity[s], state.acceleration[s]];
                self.scheme.rates(q[s] - state.q[s], self.dt, start)
            };
        }
        let slope = tangent.then(|| self.scheme.slopes(self.dt)[1]);
        self.damp(system, trial, slope);
        self.coupled.fill(0.0);
        (system.mass).add_coupling(1.0, &self.acceleration, &mut self.coupled);
    }

    /// Evaluates C v [N].
    fn damp(&mut self, system: &System, trial: &mut Trial, slope: Option<f64>) {
        if self.damping.stiffness > 0.0 {
            let force = &mut self.damping_force;
            self.solids
                .evaluate(system, trial, &self.velocity, slope, force);
        } else {
            self.damping_force.fill(0.0);
        }
        let masses = system.mass.slot.iter().zip(&self.velocity);
        for (f, (m, v)) in self.damping_force.iter_mut().zip(masses) {
            *f += self.damping.mass * m * v;
        }
        let force = &mut self.damping_force;
        (system.mass).add_coupling(self.damping.mass, &self.velocity, force);
    }

    /// Terms of the residual of a slot beside p₁ − F₁ [N] (docs/theory/inertia.md, eq. 3).
    pub fn residual(&self, mass: &Mass, slot: usize) -> f64 {
        let alpha = self.scheme.alpha();
        self.damping_force[slot]
            + (mass.slot[slot] * self.acceleration[slot]
                + self.coupled[slot]
                + alpha * self.net_start[slot])
                / (1.0 + alpha)
    }

    /// Factor of the masses in the diagonal of the matrix [1/s²] (docs/theory/inertia.md, eq. 4).
    pub fn mass_factor(&self) -> f64 {
        let [by_acceleration, by_velocity] = self.scheme.slopes(self.dt);
        by_acceleration / (1.0 + self.scheme.alpha()) + self.damping.mass * by_velocity
    }

    /// Mean nodal force of inertia [N], a scale for residuals where no solid is stressed. A body in free motion has
    /// only its momentum, of which a small part is used.
    pub fn mean_force(&self, mass: &Mass) -> f64 {
        /// Part of the force that would stop all motion within the increment.
        const OF_MOMENTUM: f64 = 1e-6;
        let inertia = mass.mean_force(self.acceleration.iter().copied());
        let momentum = mass.mean_force(self.velocity.iter().map(|v| v / self.dt));
        inertia.max(OF_MOMENTUM * momentum)
    }

    /// Size of the force of inertia on a slot, at least a small part of that which would stop it within the increment
    /// [N].
    pub fn size(&self, mass: &Mass, slot: usize) -> f64 {
        /// That part: bodies in free motion have no other force.
        const OF_MOMENTUM: f64 = 1e-5;
        let inertia = mass.slot[slot] * self.acceleration[slot] + self.coupled[slot];
        let stopping = mass.slot[slot] * self.velocity[slot] / self.dt;
        inertia.abs().max(OF_MOMENTUM * stopping.abs())
    }

    /// Largest error of HHT within the increment at the displacements of a slot [mm]: (β − 1/6) Δt² |a₁ − a₀|; 0 for
    /// backward Euler (docs/theory/inertia.md, eq. 15).
    pub fn time_error(&self, state: &State) -> f64 {
        let Scheme::Hht(alpha) = self.scheme else {
            return 0.0;
        };
        let pairs = self.acceleration.iter().zip(&state.acceleration);
        let change = pairs.map(|(a, start)| (a - start).abs());
        let [beta, _] = newmark(alpha);
        (beta - 1.0 / 6.0) * self.dt * self.dt * change.fold(0.0, f64::max)
    }

    /// Whether the slot is prescribed.
    pub fn is_prescribed(&self, slot: usize) -> bool {
        self.prescribed[slot].is_some()
    }

    /// External force on a slot, beside the `load` of the model, at the internal force p = `force` [N].
    pub fn reaction(&self, mass: &Mass, slot: usize, force: f64, load: f64) -> f64 {
        let inertia = mass.slot[slot] * self.acceleration[slot] + self.coupled[slot];
        force + self.damping_force[slot] + inertia - load
    }

    /// Copies velocities, accelerations and damping to the state.
    pub fn commit(&self, state: &mut State) {
        state.velocity.copy_from_slice(&self.velocity);
        state.acceleration.copy_from_slice(&self.acceleration);
        state.damping.copy_from_slice(&self.damping_force);
    }

    /// Kinetic energy at the end of the increment [N mm].
    pub fn kinetic_energy(&self, mass: &Mass) -> f64 {
        mass.kinetic_energy(&self.velocity)
    }

    /// Dissipation of the scheme (docs/theory/inertia.md, eq. 6) and of damping in the increment that ends at `trial`
    /// [N mm].
    pub fn dissipations(
        &self,
        mass: &Mass,
        state: &State,
        trial: &Trial,
        dq: &[f64],
        loads: &[f64],
    ) -> [f64; 2] {
        let weight = 0.5 + self.scheme.alpha();
        let (mut numerical, mut damping) = (0.0, 0.0);
        for (s, &du) in dq.iter().enumerate() {
            damping += 0.5 * (state.damping[s] + self.damping_force[s]) * du;
            if self.prescribed[s].is_some() {
                continue;
            }
            let net = loads[s] - trial.force[s] - self.damping_force[s];
            let (v, a) = (self.velocity[s], self.acceleration[s]);
            let dv = v - state.velocity[s];
            let mean = 0.5 * (v + state.velocity[s]);
            numerical +=
                mass.slot[s] * (a * du - mean * dv) - weight * (net - self.net_start[s]) * du;
        }
        let pairs = || self.velocity.iter().zip(&state.velocity);
        let change: Vec<f64> = pairs().map(|(v, start)| v - start).collect();
        let mean: Vec<f64> = pairs().map(|(v, start)| 0.5 * (v + start)).collect();
        numerical += mass.coupling(dq, &self.acceleration) - mass.coupling(&mean, &change);
        if self.prescribed.iter().any(Option::is_some) {
            // Work of a drive follows the trapezoidal rule, also against the inertia of the nodes beside it.
            let start = state.acceleration.iter().zip(&self.acceleration);
            let difference: Vec<f64> = start.map(|(start, end)| end - start).collect();
            let driven = dq.iter().zip(&self.prescribed);
            let driven: Vec<f64> = driven
                .map(|(du, prescribed)| prescribed.map_or(0.0, |_| *du))
                .collect();
            numerical -= 0.5 * mass.coupling(&driven, &difference);
        }
        [numerical, damping]
    }
}
