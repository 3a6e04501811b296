//! Fields of a commit, as they are written to files.

use nalgebra::Vector6;

use super::run::Run;
use crate::material::{ElasticParameters, LawOutput, MaterialHistory};
use crate::state::{Frame, HistoryRow, InterfaceFrame, InterfaceState, OutputField};
use crate::tensor;
use wythe_contact::{InterfaceHistory, JointLaw};

impl Run<'_> {
    /// Fields of the last commit, whose row is `row`.
    pub(in crate::solve) fn frame(&self, row: &HistoryRow) -> Frame {
        let (model, state) = (self.model, &self.state);
        let (mesh, dofs) = (&model.mesh, &self.system.dofs);
        let spread = |of: &[f64]| {
            let mut field = vec![[0.0; 3]; mesh.nodes.len()];
            dofs.spread(of, &mut field);
            field
        };
        let mut frame = Frame {
            time: state.time,
            increment: state.increments,
            step: row.step,
            displacement: spread(&state.q),
            velocity: if model.may_move() {
                spread(&state.velocity)
            } else {
                Vec::new()
            },
            interfaces: self.interface_frame(),
            reactions: row.reactions.clone(),
            probes: row.probes.clone(),
            ..Frame::default()
        };
        frame.outputs = self
            .model
            .outputs()
            .iter()
            .map(|of| self.output_field(of))
            .collect();
        for (e, points) in state.material.chunks_exact(8).enumerate() {
            let mean = |of: fn(&MaterialHistory) -> Vector6<f64>| {
                let sum: Vector6<f64> = points.iter().map(of).sum();
                (sum / 8.0).into()
            };
            let most = |of: fn(&MaterialHistory) -> f64| points.iter().map(of).fold(0.0, f64::max);
            frame.stress.push(mean(|h| h.stress));
            frame.plastic_strain.push(mean(|h| h.plastic_strain));
            frame.tensile_damage.push(most(|h| h.tensile_damage));
            frame
                .compressive_damage
                .push(most(|h| h.compressive_damage));
            frame.yielded.push(points.iter().any(has_yielded));
            let elastic = model.materials[mesh.material[e] as usize]
                .parameters
                .elastic();
            let l_eq = mesh.volume(e).cbrt();
            let width = |h: &MaterialHistory| {
                let band = if h.crack_band > 0.0 {
                    h.crack_band
                } else {
                    l_eq
                };
                band * crack_strain(h, elastic)
            };
            frame
                .crack_width
                .push(points.iter().map(width).sum::<f64>() / 8.0);
        }
        frame
    }

    /// Largest value of an output at the points of each element.
    fn output_field(&self, output: &LawOutput) -> OutputField {
        let (mesh, name) = (&self.model.mesh, output.name);
        let elements = self.state.material.chunks_exact(8).zip(&mesh.material);
        let value = |(points, material): (&[MaterialHistory], &u16)| {
            let parameters = &self.model.materials[usize::from(*material)].parameters;
            let own = parameters.outputs().iter().find(|own| own.name == name);
            own.map_or(0.0, |own| {
                let values = points.iter().map(|point| own.slot.of(point));
                values.fold(f64::NEG_INFINITY, f64::max)
            })
        };
        OutputField {
            name: name.to_owned(),
            values: elements.map(value).collect(),
        }
    }

    /// Largest value of each output of the solids at the last commit.
    pub(super) fn most_of_outputs(&self) -> impl Iterator<Item = f64> {
        let most = |of: LawOutput| {
            let values = self.output_field(&of).values.into_iter();
            values.fold(f64::NEG_INFINITY, f64::max)
        };
        self.model.outputs().into_iter().map(most)
    }

    fn interface_frame(&self) -> InterfaceFrame {
        let mut frame = InterfaceFrame::default();
        for (p, history) in self.state.interface.iter().enumerate() {
            let law = self.system.contact.law(self.model, p);
            frame.opening.push(history.opening);
            frame.slip.push(history.slip);
            frame.traction.push(history.traction);
            frame.damage.push(history.damage);
            frame.state.push(InterfaceState::of(law, history));
        }
        for output in self.model.contact.outputs() {
            let histories = self.state.interface.iter().enumerate();
            let value = |(p, history): (usize, &InterfaceHistory)| {
                let law = self.system.contact.law(self.model, p);
                let own = law.outputs().iter().find(|own| own.name == output.name);
                own.map_or(f64::NAN, |own| own.of(history))
            };
            frame.outputs.push(OutputField {
                name: output.name.to_owned(),
                values: histories.map(value).collect(),
            });
        }
        frame
    }

    /// Forces on the model [N]: external forces on the beams, then reactions of the supports, which also carry gravity,
    /// inertia and loads of their own nodes, then resultants of the named loads.
    pub(in crate::solve) fn reactions(&self) -> Vec<[f64; 3]> {
        let (model, state, dofs) = (self.model, &self.state, &self.system.dofs);
        let (outside, nodes) = (&self.system.outside, model.mesh.nodes.len());
        let mut loaded = vec![[0.0; 3]; if outside.is_empty() { 0 } else { nodes }];
        let mut resultants = Vec::with_capacity(model.loads.len());
        for (l, value) in state.loads.iter().enumerate() {
            let mut own = vec![[0.0; 3]; nodes];
            outside.add(l, *value, &self.trial.x, &mut own);
            let mut resultant = [0.0; 3];
            for (all, own) in loaded.iter_mut().zip(own) {
                for i in 0..3 {
                    all[i] += own[i];
                    resultant[i] += own[i];
                }
            }
            resultants.push(resultant);
        }
        let moves = state.acceleration.iter().any(|a| *a != 0.0);
        let inertia = moves.then(|| self.system.mass.held_forces(&state.acceleration));
        let held = |n: usize, i: usize| {
            let weight = self.system.mass.node[n] * state.weights[i];
            let inertia = inertia.as_ref().map_or(0.0, |forces| forces[n][i]);
            let own = self.trial.node_force[n][i] + inertia - weight;
            loaded.get(n).map_or(own, |loaded| own - loaded[i])
        };
        let beams =
            (0..model.beams.len()).map(|b| [0, 1, 2].map(|i| state.applied[dofs.beam_slot(b, i)]));
        // A node that two supports hold in one direction counts with the first of them.
        let mut counted = vec![[false; 3]; nodes];
        let supports = model.supports.iter().map(|support| {
            [0, 1, 2].map(|i| {
                if !support.fixed[i] {
                    return 0.0;
                }
                let own = support.nodes.iter().map(|&n| n as usize);
                let own = own.filter(|&n| !std::mem::replace(&mut counted[n][i], true));
                own.map(|n| held(n, i)).sum()
            })
        });
        beams.chain(supports).chain(resultants).collect()
    }
}

fn has_yielded(history: &MaterialHistory) -> bool {
    history.damage > 0.0 || history.plastic_strain != Vector6::zeros()
}

/// Largest principal inelastic strain of a cracked point [-]: viscous (plastic) strain and the part of the strain due
/// to damage, which an elastic point under the same stress would not have (docs/theory/damage-plasticity.md, eq. 14).
fn crack_strain(history: &MaterialHistory, elastic: &ElasticParameters) -> f64 {
    let whole = 1.0 - history.viscous_damage;
    if history.tensile_damage <= 0.0 || whole <= 0.0 {
        return 0.0;
    }
    let stress = &history.stress;
    let trace = 3.0 * tensor::mean(stress);
    let strain = Vector6::from_fn(|i, _| {
        if i < 3 {
            ((1.0 + elastic.nu) * stress[i] - elastic.nu * trace) / elastic.E
        } else {
            stress[i] / elastic.shear_modulus()
        }
    });
    let mut inelastic = history.viscous_strain + history.viscous_damage / whole * strain;
    // From engineering shear to tensor components.
    for i in 3..6 {
        inelastic[i] *= 0.5;
    }
    tensor::principal_values(&inelastic)[0].max(0.0)
}
