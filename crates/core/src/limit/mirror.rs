//! Mirror planes through the thickness of a scene, in which each body is its own image.

use nalgebra::Vector3;
use std::collections::BTreeMap;

use super::actions::Actions;
use super::bodies::{Bodies, Motion, Wrench};
use super::joints::Joint;
use super::rods::Rod;
use super::unknowns::Orbit;

/// Part of the size of the scene, or of its loads, by which images may differ: rounding of the polygons.
const SAME: f64 = 1e-9;

/// A mirror plane with its normal along an axis.
pub struct Mirror {
    axis: usize,
    normal: Vector3<f64>,
    /// Coordinate of the plane [mm].
    at: f64,
    /// Distance of places that count as one [mm].
    near: f64,
}

impl Mirror {
    /// The plane in the middle of the first joint that matters; none if no body can move.
    pub fn of(axis: usize, bodies: &Bodies, joints: &[Joint]) -> Option<Self> {
        let joint = joints.iter().find(|joint| bodies.can_move(joint))?;
        let mut normal = Vector3::zeros();
        normal[axis] = 1.0;
        let places = joint.corners.iter().map(|x| x[axis]);
        let low = places.clone().fold(f64::INFINITY, f64::min);
        let high = places.fold(f64::NEG_INFINITY, f64::max);
        Some(Self {
            axis,
            normal,
            at: 0.5 * (low + high),
            near: SAME * bodies.size,
        })
    }

    /// Symmetric motions of all bodies; none if a motion is neither symmetric nor antisymmetric.
    ///
    /// Spins of a body refer to its centre. If the centre is not in the plane, its antisymmetric spins are those about
    /// the foot of the centre and symmetric velocities, which a body with spins has.
    pub fn motions(&self, bodies: &Bodies) -> Option<Vec<Vec<Motion>>> {
        let along = |v: &Vector3<f64>| v.cross(&self.normal).norm() <= SAME * v.norm();
        let beside = |v: &Vector3<f64>| v[self.axis].abs() <= SAME * v.norm();
        let of_body = |body: &super::bodies::RigidBody| {
            let mut kept = Vec::with_capacity(3);
            for motion in &body.motions {
                if beside(&motion.velocity) && along(&motion.spin) {
                    kept.push(*motion);
                } else if !(along(&motion.velocity) && beside(&motion.spin)) {
                    return None;
                }
            }
            Some(kept)
        };
        bodies.all.iter().map(of_body).collect()
    }

    /// Whether dead and live loads are symmetric.
    pub fn keeps_loads(&self, bodies: &Bodies, actions: &Actions) -> bool {
        [&actions.dead, &actions.live].into_iter().all(|wrenches| {
            let force = wrenches.iter().map(|w| w.force.norm()).sum::<f64>();
            let moment = wrenches.iter().map(|w| w.moment.norm()).sum::<f64>();
            let size = SAME * (force + moment / bodies.size);
            let all = wrenches.iter().enumerate();
            let mut moving = all.filter(|(b, _)| !bodies.all[*b].motions.is_empty());
            moving.all(|(b, wrench)| {
                let [force, moment] = self.about_foot(bodies, b, wrench);
                let turns = bodies.all[b].motions.iter().any(|m| m.spin.norm() > 0.0);
                let moment = moment - moment[self.axis] * self.normal;
                force[self.axis].abs() <= size && (!turns || moment.norm() <= size * bodies.size)
            })
        })
    }

    /// Orbits of the corners; none if the polygon of a joint is not its own image. With a compressive strength the
    /// edges of its blocks of stress must be so, too.
    pub fn corners(&self, bodies: &Bodies, joints: &[Joint], crushed: bool) -> Option<Vec<Orbit>> {
        let mut first = 0;
        let mut orbits = Vec::new();
        for joint in joints {
            let own = first;
            first += joint.corners.len();
            if !bodies.can_move(joint) {
                continue;
            }
            let upright = joint.frame[0][self.axis].abs() <= SAME;
            let level = joint
                .edges()
                .iter()
                .any(|edge| edge[self.axis].abs() <= SAME);
            if !upright || (crushed && !level) {
                return None;
            }
            for (v, x) in joint.corners.iter().enumerate() {
                let image = self.image(*x);
                let close = |(_, y): &(usize, &Vector3<f64>)| (image - *y).norm() <= self.near;
                let (w, _) = joint.corners.iter().enumerate().find(close)?;
                if v <= w {
                    orbits.push((own + v, (v < w).then_some(own + w)));
                }
            }
        }
        Some(orbits)
    }

    /// Reactions on symmetric motions; none if the image of a reaction is none.
    pub fn reactions(&self, bodies: &Bodies) -> Option<Vec<Vec<(usize, Wrench)>>> {
        let all: Vec<_> = bodies.reactions.iter().map(|r| &r[..]).collect();
        let groups = self.pairs(bodies, &all, &[1.0, -1.0], &|_, _| true)?;
        let acts = |(r, _): &Orbit| {
            // The image of an antisymmetric reaction is its opposite.
            let mirrored = self.summed(bodies, &bodies.reactions[*r]);
            mirrored.values().any(|[force, moment]| {
                let beside = force - force[self.axis] * self.normal;
                beside.norm() > SAME || moment[self.axis].abs() > self.near
            })
        };
        let kept = groups.into_iter().filter(acts);
        Some(kept.map(|(r, _)| bodies.reactions[r].clone()).collect())
    }

    /// Orbits of the rods; none if the image of a rod is none.
    pub fn rods(&self, bodies: &Bodies, rods: &[Rod]) -> Option<Vec<Orbit>> {
        let like = |a: usize, b: usize| {
            (rods[a].most, rods[a].compression) == (rods[b].most, rods[b].compression)
        };
        // The image of a tension is a tension: a rod through the thickness, its own opposite, has none.
        let ends: Vec<_> = rods.iter().map(|rod| &rod.ends[..]).collect();
        self.pairs(bodies, &ends, &[1.0], &like)
    }

    /// Sets of wrenches with their images among them, times one of the signs.
    fn pairs(
        &self,
        bodies: &Bodies,
        sets: &[&[(usize, Wrench)]],
        signs: &[f64],
        like: &dyn Fn(usize, usize) -> bool,
    ) -> Option<Vec<Orbit>> {
        let sets: Vec<Summed> = sets.iter().map(|set| self.summed(bodies, set)).collect();
        let mut with: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
        for (s, set) in sets.iter().enumerate() {
            let own = set.keys().copied().collect();
            with.entry(own).or_default().push(s);
        }
        let mut orbits = Vec::new();
        let mut taken = vec![false; sets.len()];
        for (s, set) in sets.iter().enumerate() {
            if taken[s] {
                continue;
            }
            let own: Vec<usize> = set.keys().copied().collect();
            let mirrored: Summed = set.iter().map(|(b, w)| (*b, self.mirrored(w))).collect();
            let image = |other: &&usize| {
                !taken[**other] && like(s, **other) && self.equal(&sets[**other], &mirrored, signs)
            };
            let others = with.get(&own)?;
            // Its own image first: two equal sets would else be a pair.
            let found = others.iter().filter(|o| **o == s).find(image);
            let found = *found.or_else(|| others.iter().find(image))?;
            taken[s] = true;
            taken[found] = true;
            orbits.push((s, (found != s).then_some(found)));
        }
        Some(orbits)
    }

    /// Forces and moments of wrenches about the feet of the centres, added for each body that can move.
    fn summed(&self, bodies: &Bodies, wrenches: &[(usize, Wrench)]) -> Summed {
        let mut sums = Summed::new();
        for (b, wrench) in wrenches {
            if bodies.all[*b].motions.is_empty() {
                continue;
            }
            let sum = sums.entry(*b).or_default();
            let parts = self.about_foot(bodies, *b, wrench);
            (0..2).for_each(|i| sum[i] += parts[i]);
        }
        sums
    }

    /// Force, and moment about the foot of the centre of a body in the plane.
    fn about_foot(&self, bodies: &Bodies, body: usize, wrench: &Wrench) -> [Vector3<f64>; 2] {
        let arm = (bodies.all[body].centre[self.axis] - self.at) * self.normal;
        [wrench.force, wrench.moment + arm.cross(&wrench.force)]
    }

    fn image(&self, x: Vector3<f64>) -> Vector3<f64> {
        x + 2.0 * (self.at - x[self.axis]) * self.normal
    }

    /// Image of a force and a moment, which turns the other way round.
    fn mirrored(&self, [force, moment]: &[Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
        let image = |v: &Vector3<f64>| v - 2.0 * v[self.axis] * self.normal;
        [image(force), -image(moment)]
    }

    /// Whether sets of wrenches of the same bodies are equal, times one of the signs.
    fn equal(&self, a: &Summed, b: &Summed, signs: &[f64]) -> bool {
        signs.iter().any(|sign| {
            a.values().zip(b.values()).all(|(a, b)| {
                (a[0] - *sign * b[0]).norm() <= SAME && (a[1] - *sign * b[1]).norm() <= self.near
            })
        })
    }
}

/// Force and moment on each body.
type Summed = BTreeMap<usize, [Vector3<f64>; 2]>;
