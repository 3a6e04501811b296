//! Onset and end of motion: initial velocities, carried momentum, masses, bodies that fell.

use crate::model::scene::{BeamMotion, Step};
use crate::solve::stepping::explain;
use crate::solve::stepping::run::Run;
use crate::state::LastIncrement;
use crate::state::QUIET;

impl Run<'_> {
    /// Sets velocities to zero where statics takes over; the kinetic energy becomes numerical dissipation.
    pub(in crate::solve) fn bring_to_rest(&mut self) {
        self.last_equilibrium = None;
        let state = &mut self.state;
        state.energies.numerical += std::mem::take(&mut state.energies.kinetic);
        for rates in [
            &mut state.velocity,
            &mut state.acceleration,
            &mut state.damping,
        ] {
            rates.fill(0.0);
        }
    }

    /// Gives the bodies the velocities of the last increment when inertia takes over from statics
    /// (docs/theory/inertia.md, eq. 9). From rest, the drive would have to accelerate them, by a force that no
    /// equilibrium has. A jump to another equilibrium is excluded, because it is not a motion. `sense`: sign of the load
    /// that grows; 0 where a displacement steers it.
    pub(in crate::solve) fn carry_momentum(&mut self, sense: f64) {
        let (state, mass) = (&mut self.state, &self.system.mass);
        let grows = |last: &&LastIncrement| sense == 0.0 || sense * last.load > 0.0;
        let forth = |last: &&LastIncrement| grows(last) && last.dt > 0.0;
        let last = state.last.as_ref().or(state.moved.as_ref());
        let Some(last) = last.filter(forth) else {
            return;
        };
        let velocity: Vec<f64> = last.dq.iter().map(|dq| dq / last.dt).collect();
        let kinetic = mass.kinetic_energy(&velocity);
        if state.energies.kinetic == 0.0 && kinetic < QUIET * state.energies.taken() {
            state.velocity = velocity;
            state.energies.kinetic = kinetic;
            // The energy was moved to the numerical dissipation by statics, or was never counted.
            state.energies.numerical -= kinetic;
        }
    }

    /// A beam or node that moves in a step and has no mass, if there is one.
    pub(in crate::solve) fn massless(&self, step: &Step) -> Option<String> {
        let (model, system) = (self.model, &self.system);
        let free_beams = step.motion.iter().enumerate().flat_map(|(b, motion)| {
            let free = |i: &usize| matches!(motion[*i], BeamMotion::Force(_));
            (0..3).filter(free).map(move |i| (b, i))
        });
        let mut unknowns =
            (0..system.dofs.beam_start).chain(free_beams.map(|(b, i)| system.dofs.beam_slot(b, i)));
        let slot = unknowns.find(|&slot| system.mass.slot[slot] <= 0.0)?;
        Some(if slot >= system.dofs.beam_start {
            let beam = (slot - system.dofs.beam_start) / 3;
            format!("the beam {}", model.beams[beam].name)
        } else {
            explain::place(model, &self.part, system.dofs.node_of(slot).0)
        })
    }

    /// Sets the initial velocities of the model in its first step with inertia.
    pub(in crate::solve) fn set_in_motion(&mut self, index: usize) {
        let (model, system, state) = (self.model, &self.system, &mut self.state);
        let first = model.steps.iter().position(|s| s.procedure.has_inertia());
        if first == Some(index) && !model.initial_velocity.is_empty() {
            system
                .mass
                .mean_velocity(&system.dofs, &model.initial_velocity, &mut state.velocity);
            state.energies.kinetic = system.mass.kinetic_energy(&state.velocity);
            state.energies.external += state.energies.kinetic;
        }
    }

    /// Marks the state if, under inertia, something moved farther than the search reach of contact: it fell.
    pub(in crate::solve) fn mark_fallen(&mut self) {
        let reach = self.system.contact.reach();
        self.state.fell |= self.state.q.iter().any(|q| q.abs() > reach);
    }
}
