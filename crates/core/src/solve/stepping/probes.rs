//! Values of the probes of a model.

use crate::assembly::DofMap;
use crate::assembly::dofs::HELD;
use crate::model::Model;
use crate::model::axis::component_along;
use crate::model::probes::ProbeQuantity;
use crate::state::State;

/// Values of the probes at the last commit [mm, mm/s]. `[probe]`
pub(in crate::solve) fn probes(model: &Model, dofs: &DofMap, state: &State) -> Vec<f64> {
    let probes = model.probes.iter();
    let value = probes.map(|probe| {
        let of_slot = match probe.quantity {
            ProbeQuantity::Displacement | ProbeQuantity::Drift => &state.q,
            ProbeQuantity::Velocity => &state.velocity,
        };
        let mean = |nodes: &[u32], axis: usize| {
            let at = |n: &u32| match dofs.slot[*n as usize][axis] {
                HELD => 0.0,
                slot => dofs.sign[*n as usize][axis] * of_slot[slot as usize],
            };
            nodes.iter().map(at).sum::<f64>() / nodes.len().max(1) as f64
        };
        let motion = component_along(probe.direction, |axis| {
            mean(&probe.nodes, axis) - mean(&probe.minus, axis)
        });
        motion / probe.over
    });
    value.collect()
}
