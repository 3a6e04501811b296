//! Rigid bodies of a model and the motions that supports and beams leave to them.

use nalgebra::{DMatrix, Vector3};
use std::collections::BTreeMap;

use super::LimitError;
use super::joints::Joint;
use crate::model::Model;
use crate::model::scene::{Beam, BeamMotion, HeldBy, Step};

/// A force and its moment about a point [N, N mm].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force.
    pub force: Vector3<f64>,
    /// Moment.
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// A force at a distance from the point.
    pub fn at(arm: Vector3<f64>, force: Vector3<f64>) -> Self {
        Self {
            force,
            moment: arm.cross(&force),
        }
    }

    /// The opposite wrench.
    pub fn reversed(&self) -> Self {
        Self {
            force: -self.force,
            moment: -self.moment,
        }
    }

    /// Adds another wrench about the same point.
    pub fn add(&mut self, other: &Self) {
        self.force += other.force;
        self.moment += other.moment;
    }
}

/// A motion that a body may have: velocity of its centre, and spin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Velocity of the centre.
    pub velocity: Vector3<f64>,
    /// Spin; multiplied by a length it is a velocity.
    pub spin: Vector3<f64>,
}

impl Motion {
    /// Power of a wrench about the centre.
    pub fn power(&self, wrench: &Wrench) -> f64 {
        self.velocity.dot(&wrench.force) + self.spin.dot(&wrench.moment)
    }
}

/// A rigid body: a unit of the mesh, or several that a beam ties.
#[derive(Clone, Debug, Default)]
pub struct RigidBody {
    /// Number of its first unit in the mesh.
    pub unit: u32,
    /// Point to which its moments refer, its centroid at rest [mm].
    pub centre: Vector3<f64>,
    /// Mass [tonne].
    pub mass: f64,
    /// First moment of the mass [tonne mm].
    first_moment: Vector3<f64>,
    /// Volume [mm³].
    volume: f64,
    /// Independent motions; none of a body that is held.
    pub motions: Vec<Motion>,
    /// Beam that ties its units, if any.
    pub beam: Option<usize>,
}

impl RigidBody {
    /// Wrench of its mass under an acceleration [mm/s²].
    pub fn weight(&self, acceleration: Vector3<f64>) -> Wrench {
        let at = if self.mass > 0.0 {
            self.first_moment / self.mass
        } else {
            self.centre
        };
        Wrench::at(at - self.centre, self.mass * acceleration)
    }
}

/// Forces and moments, over the size of the scene, below which reactions hold no motion.
const HELD: f64 = 1e-9;

/// All bodies of a model.
#[derive(Clone, Debug)]
pub struct Bodies {
    /// The bodies.
    pub all: Vec<RigidBody>,
    /// Body of each element. `[element]`
    pub of_element: Vec<usize>,
    /// Body of each node of the solids. `[node]`
    pub of_node: Vec<Option<usize>>,
    /// Size of the scene [mm].
    pub size: f64,
    /// Reactions of supports that leave some motions: wrenches on bodies for a force of 1.
    pub reactions: Vec<Vec<(usize, Wrench)>>,
}

impl Bodies {
    /// Bodies of a model, with the motions that `step` leaves to its beams.
    ///
    /// # Errors
    /// Planes of symmetry: a mechanism need not be symmetric.
    pub fn of(model: &Model, step: &Step) -> Result<Self, LimitError> {
        let on_ground = |by: &HeldBy| *by == HeldBy::Ground;
        if !model.supports.iter().all(|support| on_ground(&support.by)) {
            return Err(LimitError::Symmetry);
        }
        let mesh = &model.mesh;
        let mut number = BTreeMap::new();
        for unit in &mesh.unit {
            let next = number.len();
            number.entry(*unit).or_insert(next);
        }
        let of_unit = |e: usize| number[&mesh.unit[e]];
        let mut unit_of_node = vec![None; mesh.nodes.len()];
        for (e, nodes) in mesh.elements.iter().enumerate() {
            for n in nodes {
                unit_of_node[*n as usize] = Some(of_unit(e));
            }
        }
        let tied = tied(&model.beams, &unit_of_node, number.len());
        let mut bodies = Self {
            all: vec![RigidBody::default(); number.len()],
            of_element: (0..mesh.elements.len()).map(|e| tied[of_unit(e)]).collect(),
            of_node: unit_of_node
                .iter()
                .map(|unit| unit.map(|u| tied[u]))
                .collect(),
            size: mesh.diagonal(),
            reactions: Vec::new(),
        };
        bodies.weigh(model);
        bodies.release(model, step);
        bodies.hold(model);
        bodies.hold_by_reactions();
        Ok(bodies)
    }

    /// Adds volumes and masses.
    fn weigh(&mut self, model: &Model) {
        let mesh = &model.mesh;
        for (e, body) in self.of_element.iter().enumerate() {
            let (volume, at) = (mesh.volume(e), Vector3::from(mesh.centroid(e)));
            let material = &model.materials[usize::from(mesh.material[e])];
            let mass = material.parameters.elastic().density * volume;
            let body = &mut self.all[*body];
            if body.volume == 0.0 {
                body.unit = mesh.unit[e];
            }
            body.volume += volume;
            body.centre += volume * at;
            body.mass += mass;
            body.first_moment += mass * at;
        }
        for (n, mass) in model.floors.iter().flat_map(|floor| &floor.masses) {
            let Some(body) = self.of_node[*n as usize] else {
                continue;
            };
            let body = &mut self.all[body];
            body.mass += mass;
            body.first_moment += *mass * Vector3::from(mesh.nodes[*n as usize]);
        }
        for body in &mut self.all {
            if body.volume > 0.0 {
                body.centre /= body.volume;
            }
        }
    }

    /// Gives six motions to each body, and to those of beams the ones that the step leaves them.
    fn release(&mut self, model: &Model, step: &Step) {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let still = Vector3::zeros();
        for body in self.all.iter_mut().filter(|body| body.volume > 0.0) {
            let moves = axes.map(|velocity| Motion {
                velocity,
                spin: still,
            });
            let turns = axes.map(|axis| Motion {
                velocity: still,
                spin: axis / self.size,
            });
            body.motions = moves.into_iter().chain(turns).collect();
        }
        let beams = model.beams.iter().enumerate();
        for (b, beam) in beams.filter(|(_, beam)| !beam.settles()) {
            let Some(body) = beam.nodes.iter().find_map(|n| self.of_node[*n as usize]) else {
                continue;
            };
            let motion = step.motion.get(b).copied();
            let motion = motion.unwrap_or([BeamMotion::Locked; 3]);
            let mut motions = Vec::new();
            let mut driven = still;
            for axis in 0..3 {
                match motion[axis] {
                    BeamMotion::Locked => {}
                    BeamMotion::Driven(by) => driven[axis] = by,
                    BeamMotion::Force(_) => motions.push(axes[axis]),
                }
            }
            if driven != still {
                motions.push(driven.normalize());
            }
            let all = motions.into_iter().map(|velocity| Motion {
                velocity,
                spin: still,
            });
            self.all[body].motions = all.collect();
            self.all[body].beam = Some(b);
        }
    }

    /// Holds the bodies of supports. A body of which three nodes that are not on a line are fixed is held as a whole.
    fn hold(&mut self, model: &Model) {
        let ground = model.beams.iter().filter(|beam| beam.settles());
        let ground = ground.map(|beam| (&beam.nodes, [true; 3]));
        let supports = model.supports.iter().map(|s| (&s.nodes, s.fixed));
        for (nodes, fixed) in supports.chain(ground) {
            let mut held: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
            for n in nodes {
                if let Some(body) = self.of_node[*n as usize] {
                    held.entry(body).or_default().push(*n);
                }
            }
            for (body, nodes) in held {
                let x = nodes
                    .iter()
                    .map(|n| Vector3::from(model.mesh.nodes[*n as usize]));
                let x: Vec<Vector3<f64>> = x.collect();
                if fixed == [true; 3] && spans_a_plane(&x, self.size) {
                    self.all[body].motions.clear();
                    continue;
                }
                for x in x {
                    for axis in (0..3).filter(|axis| fixed[*axis]) {
                        let mut force = Vector3::zeros();
                        force[axis] = 1.0;
                        let arm = x - self.all[body].centre;
                        self.reactions.push(vec![(body, Wrench::at(arm, force))]);
                    }
                }
            }
        }
    }

    /// Holds bodies whose reactions leave none of their motions, such as those of a face that is fixed along x by one
    /// support and along y and z by another one. Reactions on held bodies go.
    fn hold_by_reactions(&mut self) {
        let mut of_body: BTreeMap<usize, Vec<Wrench>> = BTreeMap::new();
        for (body, wrench) in self.reactions.iter().flatten() {
            of_body.entry(*body).or_default().push(*wrench);
        }
        for (body, wrenches) in of_body {
            let motions = &mut self.all[body].motions;
            if motions.is_empty() || wrenches.len() < motions.len() {
                continue;
            }
            let power = |m: usize, r: usize| motions[m].power(&wrenches[r]);
            let powers = DMatrix::from_fn(motions.len(), wrenches.len(), power);
            if powers.rank(HELD) == motions.len() {
                motions.clear();
            }
        }
        let all = &self.all;
        let moves = |(body, _): &(usize, Wrench)| !all[*body].motions.is_empty();
        self.reactions.retain(|reaction| reaction.iter().any(moves));
    }

    /// Whether a body of a joint can move.
    pub fn can_move(&self, joint: &Joint) -> bool {
        let mut bodies = joint.bodies.iter();
        bodies.any(|body| !self.all[*body].motions.is_empty())
    }

    /// Wrenches of a force of 1 along a direction that acts equally on nodes.
    pub fn shared(
        &self,
        model: &Model,
        nodes: &[u32],
        along: Vector3<f64>,
    ) -> Vec<(usize, Wrench)> {
        let part = along / nodes.len().max(1) as f64;
        let of = |n: &u32| {
            let body = self.of_node[*n as usize]?;
            let arm = Vector3::from(model.mesh.nodes[*n as usize]) - self.all[body].centre;
            Some((body, Wrench::at(arm, part)))
        };
        nodes.iter().filter_map(of).collect()
    }
}

/// Number of the first unit of those that beams tie, for each unit.
fn tied(beams: &[Beam], unit_of_node: &[Option<usize>], units: usize) -> Vec<usize> {
    let mut first: Vec<usize> = (0..units).collect();
    for beam in beams.iter().filter(|beam| !beam.settles()) {
        let own = beam.nodes.iter().filter_map(|n| unit_of_node[*n as usize]);
        let own: Vec<usize> = own.map(|unit| first[unit]).collect();
        let Some(least) = own.iter().copied().min() else {
            continue;
        };
        for of in &mut first {
            if own.contains(of) {
                *of = least;
            }
        }
    }
    first
}

/// Whether points are not all on one line.
fn spans_a_plane(x: &[Vector3<f64>], size: f64) -> bool {
    let Some(first) = x.first() else {
        return false;
    };
    let far = x.iter().map(|x| x - first);
    let far = far.max_by(|a, b| a.norm().total_cmp(&b.norm()));
    let Some(along) = far.and_then(|way| way.try_normalize(1e-9 * size)) else {
        return false;
    };
    let beside = |x: &Vector3<f64>| (x - first).cross(&along).norm();
    x.iter().any(|x| beside(x) > 1e-9 * size)
}
