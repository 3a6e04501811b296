//! Ties of a model as rods between rigid bodies: a force along each segment from its
//! prestress up to its yield force.

use nalgebra::Vector3;

use super::bodies::{Bodies, Wrench};
use crate::model::Model;
use crate::model::steps::Step;
use crate::model::ties::TieStage;

/// A segment of a tie between two bodies.
#[derive(Clone, Debug)]
pub struct Rod {
    /// Index of its tie.
    pub tie: usize,
    /// Bodies at its ends, and the wrench on each of a tension of 1 N.
    pub ends: [(usize, Wrench); 2],
    /// Largest force [N]; infinite without a yield stress.
    pub most: f64,
    /// Least force [N]: its prestress, 0, or the largest compression that it carries.
    pub least: f64,
}

impl Rod {
    /// Bodies at its ends.
    pub fn bodies(&self) -> [usize; 2] {
        [self.ends[0].0, self.ends[1].0]
    }

    /// All segments of ties whose ends lie in two bodies, stressed in these steps.
    pub fn all(model: &Model, steps: &[Step], bodies: &Bodies) -> Vec<Self> {
        let mut rods = Vec::new();
        for (t, tie) in model.ties.iter().enumerate() {
            let most = tie.law.f_y * tie.law.area;
            let least = if tie.law.compression {
                -most
            } else {
                prestress(steps, t).min(most)
            };
            for ends in tie.segments() {
                let body = ends.map(|end| bodies.of_element[end.element as usize]);
                let at = ends.map(|end| Vector3::from(end.at));
                let Some(along) = (at[1] - at[0]).try_normalize(0.0) else {
                    continue;
                };
                if body[0] == body[1] {
                    continue;
                }
                // Tension pulls each end towards the other one.
                let end = |k: usize, force: Vector3<f64>| {
                    let arm = at[k] - bodies.all[body[k]].centre;
                    (body[k], Wrench::at(arm, force))
                };
                rods.push(Self {
                    tie: t,
                    ends: [end(0, along), end(1, -along)],
                    most,
                    least,
                });
            }
        }
        rods
    }
}

/// Force to which these steps stress a tie last, 0 without [N].
fn prestress(steps: &[Step], tie: usize) -> f64 {
    let stages = steps.iter().filter_map(|step| step.ties.get(tie));
    let mut forces = stages.filter_map(|stage| match stage {
        TieStage::Stressed(force) => Some(*force),
        TieStage::Fixed | TieStage::Absent => None,
    });
    forces.next_back().unwrap_or(0.0)
}
