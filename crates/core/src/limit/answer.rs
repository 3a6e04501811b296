//! Results of a limit analysis: mechanism and forces.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use serde::Serialize;

use super::Live;
use super::program::Solution;
use super::scene::RigidScene;

/// Result of a limit analysis.
// More than 15 fields: they are the keys of `limit.json`.
#[derive(Clone, Debug, Serialize)]
pub struct LimitAnalysis {
    /// Largest factor of the live loads.
    pub factor: f64,
    /// What it multiplies.
    pub live: Live,
    /// Index of the live step.
    pub step: usize,
    /// What it multiplies, in words.
    pub live_load: String,
    /// Force along the drive [kN]; `None` if the live load is none.
    #[serde(rename = "force_kN")]
    pub force: Option<f64>,
    /// Certificate: distance of the factor to that of the mechanism, an upper bound of the last program, over the
    /// factor [-].
    pub gap: f64,
    /// Factor with associated friction, where sliding has no dilatancy.
    pub associated_factor: f64,
    /// Number of programs that were solved.
    pub programs: usize,
    /// Whether the joints of the mechanism slide without opening, up to `opening_work`.
    pub converged: bool,
    /// Work of the pressures on joints that open or close as they slide, over that of the live loads [-].
    pub opening_work: f64,
    /// Number of bodies that can move, of joints, and of their corners.
    pub sizes: [usize; 3],
    /// Axis of the normal of the plane about which the scene is symmetric, so that half of its forces were unknown;
    /// `None` if there is none.
    pub mirror: Option<&'static str>,
    /// Units with their mechanism.
    pub mechanism: Vec<MovedUnit>,
    /// Resultants of the joints.
    pub joints: Vec<JointForce>,
    /// Forces of the ties.
    pub ties: Vec<TieForce>,
    /// Lightest body if it is so light that a mechanism of it alone may be missed, else `None`.
    pub light_body: Option<LightBody>,
    /// Remark where the factor is far below the associated one, else `None`.
    pub note: Option<String>,
}

/// A body with a small part of the dead loads on others that it acts on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightBody {
    /// Its name.
    pub name: String,
    /// Its dead load over the largest one of a body of its group [-].
    pub part: f64,
}

/// Motion of a unit in the mechanism. The fastest point of all moves by 1.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MovedUnit {
    /// Number of the unit in the mesh.
    pub unit: u32,
    /// Its name.
    pub name: String,
    /// Point to which the velocity belongs [mm].
    pub centre_mm: [f64; 3],
    /// Velocity of the centre.
    pub velocity: [f64; 3],
    /// Spin [1/mm].
    pub spin: [f64; 3],
}

/// Resultant force in a joint: that of its second body on the first one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointForce {
    /// Names of both bodies.
    pub bodies: [String; 2],
    /// Place: where the normal force acts, or the middle of a joint without one [mm].
    pub at_mm: [f64; 3],
    /// Force [N].
    #[serde(rename = "force_N")]
    pub force: [f64; 3],
    /// Normal force, compression positive [N].
    #[serde(rename = "normal_N")]
    pub normal: f64,
    /// Part of the shear strength that is used [-].
    pub sliding: f64,
    /// Corners of the joint [mm].
    pub corners_mm: Vec<[f64; 3]>,
    /// Forces at the corners, of the second body on the first one [N]. `[corner][xyz]`
    #[serde(rename = "corner_forces_N")]
    pub corner_forces: Vec<[f64; 3]>,
}

/// Force of a tie.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TieForce {
    /// Name of the tie.
    pub name: String,
    /// Largest force in its segments between two bodies, tension positive [N]; 0 without such a segment.
    #[serde(rename = "force_N")]
    pub force: f64,
}

/// Part of the associated factor below which the factor without dilatancy says little about the factor of runs.
const APART: f64 = 0.8;

impl RigidScene<'_> {
    /// Remark on a factor that is far below the associated one.
    pub(super) fn note(&self, factor: f64, associated: f64) -> Option<String> {
        if factor.abs() >= APART * associated.abs() {
            return None;
        }
        let [low, high] = [factor, associated].map(|factor| match self.force(factor) {
            Some(force) => format!("{force:.4} kN"),
            None => format!("{factor:.4}"),
        });
        Some(format!(
            "without dilatancy the solution is not unique: {low} is a low one, and runs in increments may carry \
             anything up to the associated {high}"
        ))
    }

    /// Number of bodies that can move, of joints, and of their corners.
    pub(super) fn sizes(&self) -> [usize; 3] {
        let bodies = self.bodies.all.iter();
        let moving = bodies.filter(|body| !body.motions.is_empty()).count();
        [moving, self.joints.len(), self.corners.len()]
    }

    /// Lightest body, if it is too light beside others.
    pub(super) fn light_body(&self) -> Option<LightBody> {
        self.scales.light.map(|(body, part)| LightBody {
            name: self.model.mesh.called(self.bodies.all[body].unit),
            part,
        })
    }

    /// Motions of all units, with the fastest node at a speed of 1.
    pub(super) fn mechanism(&self, solution: &Solution) -> Vec<MovedUnit> {
        let (mesh, bodies) = (&self.model.mesh, &self.bodies);
        let units = mesh.unit.iter().copied();
        let units: BTreeMap<u32, usize> = units.zip(bodies.of_element.iter().copied()).collect();
        let speed = |(n, body): (usize, &Option<usize>)| {
            body.map_or(0.0, |body| {
                let [velocity, spin] = solution.mechanism[body];
                let arm = Vector3::from(mesh.nodes[n]) - bodies.all[body].centre;
                (velocity + spin.cross(&arm)).norm()
            })
        };
        let nodes = bodies.of_node.iter().enumerate();
        let fastest = nodes.map(speed).fold(0.0, f64::max);
        let scale = if fastest > 0.0 { 1.0 / fastest } else { 1.0 };
        let moved = units.into_iter().map(|(unit, body)| {
            let [velocity, spin] = solution.mechanism[body];
            MovedUnit {
                unit,
                name: mesh.called(unit),
                centre_mm: bodies.all[body].centre.into(),
                velocity: (scale * velocity).into(),
                spin: (scale * spin).into(),
            }
        });
        moved.collect()
    }

    /// Resultants of the joints.
    pub(super) fn joint_forces(&self, solution: &Solution) -> Vec<JointForce> {
        let mut corners = self.corners.iter().zip(&solution.forces);
        let called = |body: usize| self.model.mesh.called(self.bodies.all[body].unit);
        let resultant = |joint: &super::joints::Joint| {
            let count = joint.corners.len();
            let mut force = Vector3::zeros();
            let (mut normal, mut at, mut strength) = (0.0, Vector3::zeros(), 0.0);
            let mut own = Vec::with_capacity(count);
            for (corner, [n, a, b]) in corners.by_ref().take(count) {
                let part = -joint.frame[0] * *n + joint.frame[1] * *a + joint.frame[2] * *b;
                force += part;
                own.push(part.into());
                normal += n;
                at += *n * corner.at;
                strength += joint.strength.friction * n
                    + joint.strength.cohesion * joint.area / count as f64;
            }
            let shear = force - joint.frame[0] * force.dot(&joint.frame[0]);
            let pressed = normal > 0.0;
            JointForce {
                bodies: joint.bodies.map(called),
                at_mm: if pressed { at / normal } else { joint.middle() }.into(),
                force: force.into(),
                normal,
                sliding: if strength > 0.0 {
                    shear.norm() / strength
                } else {
                    0.0
                },
                corners_mm: joint.corners.iter().map(|x| (*x).into()).collect(),
                corner_forces: own,
            }
        };
        self.joints.iter().map(resultant).collect()
    }

    /// Forces of the ties.
    pub(super) fn tie_forces(&self, solution: &Solution) -> Vec<TieForce> {
        let ties = self.model.ties.iter().enumerate().map(|(t, tie)| {
            let own = self.rods.iter().zip(&solution.rods);
            let own = own.filter(|(rod, _)| rod.tie == t).map(|(_, force)| *force);
            TieForce {
                name: tie.name.clone(),
                force: own
                    .max_by(|a, b| a.abs().total_cmp(&b.abs()))
                    .unwrap_or(0.0),
            }
        });
        ties.collect()
    }
}
