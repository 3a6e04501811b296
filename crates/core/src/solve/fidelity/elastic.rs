//! Solids that stay linear elastic, with the largest ratio of their stress to the yield stress.

use nalgebra::Vector6;
use serde::{Deserialize, Serialize};

use crate::material::{Material, MaterialParameters, SolidLaw};
use crate::model::Model;
use crate::model::scene::Fidelity;
use crate::solve::Checkpoint;
use crate::solve::Recorder;
use crate::state::State;
use crate::state::{Frame, HistoryRow};

/// Largest ratio of stress to yield stress in any solid so far.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(in crate::solve) struct Reached {
    /// Stress over yield stress [-].
    pub part: f64,
    element: usize,
    increment: usize,
}

/// A model with elastic solids, and the laws that they replace.
#[derive(Clone, Debug)]
pub(in crate::solve) struct Elastic {
    pub model: Model,
    /// Laws in their initial state, without element size: only their initial yield surface is used. `[material]`
    laws: Vec<Option<Material>>,
}

impl Elastic {
    /// Copy of a model whose solids are all linear elastic, for `fidelity = "elastic"` ([`Fidelity::Elastic`]).
    pub fn of(model: &Model) -> Self {
        let mut elastic = Model {
            fidelity: Fidelity::Auto,
            ..model.clone()
        };
        let law = |parameters: &MaterialParameters| match parameters {
            MaterialParameters::Elastic(_) => None,
            _ => Material::new(parameters, None).ok().map(|(law, _)| law),
        };
        let laws = elastic.materials.iter_mut().map(|material| {
            let law = law(&material.parameters);
            material.parameters = MaterialParameters::Elastic(*material.parameters.elastic());
            law
        });
        Self {
            laws: laws.collect(),
            model: elastic,
        }
    }

    /// Name of a law that does not tell which part of its yield stress is reached.
    fn unknown(&self) -> Option<&'static str> {
        let laws = self.laws.iter().flatten().map(Material::law);
        let mut silent = laws.filter(|law| law.reached(&Vector6::zeros()).is_none());
        silent.next().map(SolidLaw::name)
    }
}

/// Ratio of a stress to the yield stress: 1 on the initial yield surface; 0 if the law does not know it.
fn reached(law: &Material, stress: &Vector6<f64>) -> f64 {
    law.law().reached(stress).unwrap_or_default()
}

/// Recorder that observes the stresses of each commit.
pub(super) struct Watch<'a> {
    pub elastic: &'a Elastic,
    pub recorder: &'a mut dyn Recorder,
    pub reached: Reached,
}

impl Watch<'_> {
    /// Message about the largest stress.
    pub fn told(&self) -> String {
        let Reached {
            part: largest,
            element: e,
            increment,
        } = self.reached;
        let mesh = &self.elastic.model.mesh;
        if let Some(law) = self.elastic.unknown() {
            return format!(
                "fidelity is \"elastic\", and the law `{law}` does not say where it yields: what yields or cracks is \
                 left out; fidelity = \"auto\" has it"
            );
        }
        if largest <= 1.0 {
            return format!(
                "the solids reach {largest:.2} times their yield stress: that they are elastic leaves nothing out"
            );
        }
        format!(
            "fidelity is \"elastic\": the solids reach {largest:.2} times their yield stress (increment {increment}, \
             {}), and what yields or cracks is left out; fidelity = \"auto\" has it",
            mesh.body_of(e)
        )
    }
}

impl Recorder for Watch<'_> {
    fn take(
        &mut self,
        model: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        self.recorder.take(model, row, frame)
    }

    fn wants_fields(&self) -> bool {
        self.recorder.wants_fields()
    }

    fn keep(&mut self, model: &Model, fields: Frame) {
        self.recorder.keep(model, fields);
    }

    fn observe(&mut self, state: &State) {
        let mesh = &self.elastic.model.mesh;
        for (e, points) in state.material.chunks_exact(8).enumerate() {
            let Some(law) = &self.elastic.laws[usize::from(mesh.material[e])] else {
                continue;
            };
            let parts = points.iter().map(|point| reached(law, &point.stress));
            let part = parts.fold(0.0, f64::max);
            if part > self.reached.part {
                self.reached = Reached {
                    part,
                    element: e,
                    increment: state.increments,
                };
            }
        }
        self.recorder.observe(state);
    }

    fn checkpoint(&mut self, last: bool, make: &dyn Fn() -> Checkpoint) -> std::io::Result<()> {
        let reached = self.reached;
        self.recorder.checkpoint(last, &|| {
            let mut checkpoint = make();
            checkpoint.reached = reached;
            checkpoint
        })
    }

    fn note(&mut self, text: &str) {
        self.recorder.note(text);
    }

    fn progress(&mut self, step: usize, time: f64, iterations: usize) {
        self.recorder.progress(step, time, iterations);
    }
}
