//! What holds, drives or loads a model and where, shown below the pointer before a run.

use std::collections::HashMap;

use serde::Serialize;

use super::packed;
use crate::model::axis::Axis;
use crate::model::loads::LoadOn;
use crate::model::scene::{BeamMotion, HeldBy, Model, Step};
use crate::results::curve::brief;

/// Text about some nodes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    /// The text.
    pub told: String,
    /// Nodes of the mesh.
    pub nodes: Vec<u32>,
}

/// A mark on the page.
#[derive(Debug, Serialize)]
pub(super) struct EncodedMark {
    told: String,
    /// Boundary nodes. u32
    nodes: String,
}

const AXES: [&str; 3] = Axis::NAMES;

impl Mark {
    /// Supports, planes of symmetry, faces that move as one, springs, loads and ties of a model.
    pub fn all(model: &Model) -> Vec<Self> {
        let mut marks = supports(model);
        marks.extend(beams(model));
        marks.extend(springs(model));
        marks.extend(loads(model));
        marks.extend(model.ties.iter().map(|tie| {
            let points = tie.strands.iter().flatten();
            Self {
                told: format!("tie {}", tie.name),
                nodes: points.flat_map(|p| p.nodes.iter().map(|n| n.0)).collect(),
            }
        }));
        marks
    }

    /// The marks for a page that shows these nodes of the mesh; those on none of them are left out.
    pub fn encoded(marks: &[Self], shown: &[u32]) -> Vec<EncodedMark> {
        let places = shown.iter().zip(0_u32..);
        let places: HashMap<u32, u32> = places.map(|(node, place)| (*node, place)).collect();
        let encoded = marks.iter().filter_map(|mark| {
            let nodes = mark.nodes.iter().filter_map(|n| places.get(n).copied());
            let mut nodes: Vec<u32> = nodes.collect();
            nodes.sort_unstable();
            nodes.dedup();
            (!nodes.is_empty()).then(|| EncodedMark {
                told: mark.told.clone(),
                nodes: packed::longs(nodes),
            })
        });
        encoded.collect()
    }
}

fn supports(model: &Model) -> Vec<Mark> {
    let told = model.supports.iter().filter_map(|support| {
        let held: Vec<&str> = (0..3)
            .filter(|i| support.fixed[*i])
            .map(|i| AXES[i])
            .collect();
        let told = match support.by {
            HeldBy::Ground => format!("support {}: {} held", support.name, held.join(", ")),
            HeldBy::Plane { axis, .. } => format!("plane of symmetry normal to {}", AXES[axis]),
            HeldBy::Mirror => return None,
        };
        Some(Mark {
            told,
            nodes: support.nodes.clone(),
        })
    });
    told.collect()
}

fn beams(model: &Model) -> Vec<Mark> {
    let all = model.beams.iter().enumerate().map(|(b, beam)| {
        let moves = |step: &Step| {
            let motion = step.motion.get(b)?;
            let along = AXES.iter().zip(motion);
            let along = along.map(|(axis, motion)| match motion {
                BeamMotion::Locked => format!("{axis} locked"),
                BeamMotion::Force(force) if *force == 0.0 => format!("{axis} free"),
                BeamMotion::Force(force) => format!("{axis} {} kN", brief(1e-3 * force)),
                BeamMotion::Driven(by) => format!("{axis} driven by {} mm", brief(*by)),
            });
            Some(along.collect::<Vec<_>>().join(", "))
        };
        let kind = if beam.settles() {
            "ground that settles"
        } else {
            "moves as one"
        };
        Mark {
            told: in_steps(model, format!("{}, {kind}", beam.name), &moves),
            nodes: beam.nodes.clone(),
        }
    });
    all.collect()
}

fn springs(model: &Model) -> Vec<Mark> {
    let all = model.springs.iter().enumerate().map(|(s, spring)| {
        let stiffness = AXES.iter().zip(spring.stiffness);
        let stiffness = stiffness.filter(|(_, k)| *k != 0.0);
        let stiffness: Vec<String> = stiffness
            .map(|(axis, k)| format!("{axis} {} N/mm", brief(k)))
            .collect();
        let head = format!("spring {}: {}", spring.name, stiffness.join(", "));
        let moves = |step: &Step| {
            let by = step.springs.get(s).filter(|by| **by != [0.0; 3])?;
            Some(format!("its end driven by {} mm", vector(*by)))
        };
        Mark {
            told: in_steps(model, head, &moves),
            nodes: spring.nodes.clone(),
        }
    });
    all.collect()
}

fn loads(model: &Model) -> Vec<Mark> {
    let all = model.loads.iter().enumerate().map(|(l, load)| {
        let value = |step: &Step| {
            let value = (*step.loads.get(l)?)?;
            Some(match &load.acts {
                LoadOn::Shares(shares) => {
                    let sum: f64 = shares.iter().map(|(_, share)| share).sum();
                    format!("{} kN in all", vector(value.map(|v| 1e-3 * sum * v)))
                }
                LoadOn::Follower(_) | LoadOn::Pressure(_) => format!("{} MPa", brief(value[0])),
            })
        };
        Mark {
            told: in_steps(model, format!("load {}", load.name), &value),
            nodes: load.nodes(),
        }
    });
    all.collect()
}

/// A head, and what each step does.
fn in_steps(model: &Model, head: String, of: &dyn Fn(&Step) -> Option<String>) -> String {
    let steps = model.steps.iter().filter_map(|step| {
        let told = of(step)?;
        Some(format!("; {}: {told}", step.name))
    });
    head + &steps.collect::<String>()
}

fn vector(value: [f64; 3]) -> String {
    format!("({})", value.map(brief).join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_on_hidden_nodes_are_left_out() {
        let mark = |told: &str, nodes: &[u32]| Mark {
            told: told.to_owned(),
            nodes: nodes.to_vec(),
        };
        let encoded = Mark::encoded(&[mark("foot", &[7, 9, 7]), mark("inside", &[8])], &[9, 7]);
        let [foot] = &encoded[..] else {
            panic!("{encoded:?}")
        };
        assert_eq!(foot.told, "foot");
        assert_eq!(foot.nodes, packed::longs([0, 1]));
    }
}
