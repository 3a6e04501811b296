//! Dead and live actions of a model: what stays, and what the factor multiplies.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::LimitError;
use super::bodies::{Bodies, Wrench};
use crate::assembly::ExternalLoads;
use crate::model::Model;
use crate::model::amplitude::Amplitude;
use crate::model::scene::{BeamMotion, Gravity, Step};

/// Action that the factor multiplies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Live {
    /// Force along the drive of a beam, a face or a spring; the factor is the force.
    Drive,
    /// Change of the named loads in the step.
    Loads,
    /// Horizontal body force over the weight, as on a tilting table; the factor is the tangent of the angle.
    Tilt,
    /// Body force over the weight along a direction that the user gives.
    BodyForce,
}

impl Live {
    /// In words, with the name of the step.
    pub fn told(self, step: &str) -> String {
        match self {
            Self::Drive => format!("force along the drive of the step `{step}`"),
            Self::Loads => format!("loads of the step `{step}`"),
            Self::Tilt => format!("horizontal body force over the weight, of the step `{step}`"),
            Self::BodyForce => "body force over the weight along the given direction".to_owned(),
        }
    }
}

/// Index of the last step with a live action, and the action.
pub fn live_step(model: &Model) -> Option<(usize, Live)> {
    let live = |step: &Step| {
        // Ground that settles loads nothing.
        let moved = step.motion.iter().zip(&model.beams);
        let moved = moved.filter(|(_, beam)| !beam.settles());
        let drives = moved.flat_map(|(motion, _)| motion);
        let mut drives = drives.filter(|motion| matches!(motion, BeamMotion::Driven(_)));
        let springs = step.springs.iter().flatten().any(|by| *by != 0.0);
        if drives.next().is_some() || springs {
            Some(Live::Drive)
        } else if step.loads.iter().any(Option::is_some) {
            Some(Live::Loads)
        } else if matches!(step.gravity, Gravity::Turning { .. }) {
            Some(Live::Tilt)
        } else {
            None
        }
    };
    let steps = model.steps.iter().enumerate().rev();
    let mut found = steps.filter_map(|(s, step)| Some((s, live(step)?)));
    found.next()
}

/// Wrenches on the bodies, about their centres.
#[derive(Clone, Debug)]
pub struct Actions {
    /// Of dead loads [N, N mm]. `[body]`
    pub dead: Vec<Wrench>,
    /// For a factor of 1.
    pub live: Vec<Wrench>,
    /// Reactions of springs that no step drives: index of the spring, and wrenches on bodies for a force of 1.
    pub springs: Vec<(usize, Vec<(usize, Wrench)>)>,
}

impl Actions {
    /// Actions when step `at` is the live one.
    ///
    /// # Errors
    /// A body force without weight.
    pub fn of(
        model: &Model,
        bodies: &Bodies,
        (at, live): (usize, Live),
        along: Option<[f64; 3]>,
    ) -> Result<Self, LimitError> {
        let none = vec![Wrench::default(); bodies.all.len()];
        let mut actions = Self {
            dead: none.clone(),
            live: none,
            springs: Vec::new(),
        };
        let step = &model.steps[at];
        let gravity = Vector3::from(gravity_before(model, at));
        for (b, body) in bodies.all.iter().enumerate() {
            actions.dead[b].add(&body.weight(gravity));
        }
        actions.add_loads(model, bodies, at);
        actions.add_beams(bodies, step);
        actions.add_springs(model, bodies, step);
        let direction = match (live, &step.gravity, along) {
            (_, _, Some(along)) => Some(Vector3::from(along)),
            (Live::Tilt, Gravity::Turning { from, axis, angle }, None) => {
                let way = Vector3::from(*axis).cross(&Vector3::from(*from));
                way.try_normalize(0.0).map(|way| way * angle.signum())
            }
            _ => None,
        };
        if let Some(direction) = direction {
            let size = gravity.norm();
            if size == 0.0 || bodies.all.iter().all(|body| body.mass == 0.0) {
                return Err(LimitError::Weightless);
            }
            for (b, body) in bodies.all.iter().enumerate() {
                actions.live[b] = body.weight(size * direction);
            }
        }
        Ok(actions)
    }

    /// Adds named loads. In a step that does nothing but load, their values before it are dead and their change is live;
    /// in another one those at its end are dead.
    fn add_loads(&mut self, model: &Model, bodies: &Bodies, at: usize) {
        let loads = live_step(model) == Some((at, Live::Loads));
        let outside = ExternalLoads::new(model);
        let x = &model.mesh.nodes;
        for l in 0..model.loads.len() {
            let carried = carried_before(model, l, at);
            let own = model.steps[at].loads.get(l).copied().flatten();
            let after = own.unwrap_or(carried);
            let before = if loads { carried } else { after };
            let change = [0, 1, 2].map(|i| after[i] - before[i]);
            for (value, wrenches) in [(before, &mut self.dead), (change, &mut self.live)] {
                let mut force = vec![[0.0; 3]; x.len()];
                outside.add(l, value, x, &mut force);
                for (n, force) in force.iter().enumerate() {
                    if let Some(body) = bodies.of_node[n].filter(|_| *force != [0.0; 3]) {
                        let arm = Vector3::from(x[n]) - bodies.all[body].centre;
                        wrenches[body].add(&Wrench::at(arm, Vector3::from(*force)));
                    }
                }
            }
        }
    }

    /// Adds forces on beams, and a live force of 1 N along a drive.
    fn add_beams(&mut self, bodies: &Bodies, step: &Step) {
        for (b, body) in bodies.all.iter().enumerate() {
            let Some(motion) = body.beam.and_then(|beam| step.motion.get(beam)) else {
                continue;
            };
            let mut driven = Vector3::zeros();
            for axis in 0..3 {
                match motion[axis] {
                    BeamMotion::Force(force) => self.dead[b].force[axis] += force,
                    BeamMotion::Driven(by) => driven[axis] = by,
                    BeamMotion::Locked => {}
                }
            }
            if let Some(along) = driven.try_normalize(0.0) {
                self.live[b].force += along;
            }
        }
    }

    /// Adds springs: the driven one carries a live force of 1 N, all others react.
    fn add_springs(&mut self, model: &Model, bodies: &Bodies, step: &Step) {
        for (s, spring) in model.springs.iter().enumerate() {
            let by = step.springs.get(s).copied().unwrap_or_default();
            if let Some(along) = Vector3::from(by).try_normalize(0.0) {
                for (body, wrench) in bodies.shared(model, &spring.nodes, along) {
                    self.live[body].add(&wrench);
                }
            }
            for axis in (0..3).filter(|axis| spring.stiffness[*axis] > 0.0 && by[*axis] == 0.0) {
                let mut along = Vector3::zeros();
                along[axis] = 1.0;
                let reaction = bodies.shared(model, &spring.nodes, along);
                self.springs.push((s, reaction));
            }
        }
    }
}

/// Load `l` when step `at` begins, as the amplitudes of the steps before leave it [N] or [MPa].
fn carried_before(model: &Model, l: usize, at: usize) -> [f64; 3] {
    let mut value = [0.0; 3];
    for step in &model.steps[..at] {
        if let Some(to) = step.loads.get(l).copied().flatten() {
            let part = step.amplitude.as_ref().map_or(1.0, Amplitude::end);
            value = [0, 1, 2].map(|i| value[i] + part * (to[i] - value[i]));
        }
    }
    value
}

/// Acceleration of gravity when step `at` begins [mm/s²].
fn gravity_before(model: &Model, at: usize) -> [f64; 3] {
    match model.steps[at].gravity {
        Gravity::Turning { from, .. } => from,
        // Gravity of the step itself acts with its loads.
        ref gravity => gravity.at(1.0),
    }
}
