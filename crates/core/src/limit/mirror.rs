//! Mirror planes of a scene: images of bodies, corners, reactions and rods.

use nalgebra::Vector3;
use std::collections::{BTreeMap, HashMap};

use super::actions::Actions;
use super::bodies::{Bodies, Motion, RigidBody, Wrench};
use super::joints::Joint;
use super::rods::Rod;
use super::unknowns::Orbit;

/// Part of the size of the scene, or of its loads, by which images may differ: rounding of the polygons.
const SAME: f64 = 1e-9;
/// Size of the cells in which joints are looked up, over the size of the scene.
const CELL: f64 = 1e-4;

/// A mirror plane with its normal along an axis.
#[derive(Clone, Debug)]
pub struct Mirror {
    /// Axis of its normal.
    pub axis: usize,
    normal: Vector3<f64>,
    /// Coordinate of the plane [mm].
    at: f64,
    /// Distance of places that count as one [mm].
    near: f64,
    /// Mirror image of each body. `[body]`
    images: Vec<usize>,
    /// Mirror image of each joint that matters, and whether its bodies come in the other order. `[joint]`
    joints: Vec<Option<(usize, bool)>>,
}

impl Mirror {
    /// The plane in the middle of all joints that matter, if each of them has an image.
    pub fn of(axis: usize, bodies: &Bodies, joints: &[Joint]) -> Option<Self> {
        let matter = || joints.iter().filter(|joint| bodies.can_move(joint));
        let places = || matter().flat_map(|joint| joint.corners.iter().map(|x| x[axis]));
        let low = places().fold(f64::INFINITY, f64::min);
        let high = places().fold(f64::NEG_INFINITY, f64::max);
        let mut normal = Vector3::zeros();
        normal[axis] = 1.0;
        let mut mirror = Self {
            axis,
            normal,
            at: 0.5 * (low + high),
            near: SAME * bodies.size,
            images: (0..bodies.all.len()).collect(),
            joints: vec![None; joints.len()],
        };
        (low <= high && mirror.pair(bodies, joints)).then_some(mirror)
    }

    /// Finds the images of joints, and by them those of bodies; false if there is none, or not one alone.
    fn pair(&mut self, bodies: &Bodies, joints: &[Joint]) -> bool {
        let cells = Cells::of(CELL * bodies.size, bodies, joints);
        let mut images: Vec<Option<usize>> = vec![None; bodies.all.len()];
        for (j, joint) in joints.iter().enumerate() {
            if !bodies.can_move(joint) {
                continue;
            }
            let middle = self.image(joint.middle());
            let mut others = cells.near(middle, self.near);
            let Some(other) = others.find(|other| self.are_images(joint, &joints[*other])) else {
                return false;
            };
            let turned = self.flipped(joint.frame[0]).dot(&joints[other].frame[0]) < 0.0;
            self.joints[j] = Some((other, turned));
            for (k, body) in joint.bodies.into_iter().enumerate() {
                let image = joints[other].bodies[if turned { 1 - k } else { k }];
                if images[body].is_some_and(|known| known != image) {
                    return false;
                }
                images[body] = Some(image);
            }
        }
        for (body, image) in images.iter().enumerate() {
            self.images[body] = image.unwrap_or(body);
        }
        let mutual = |(b, image): (usize, &usize)| self.images[*image] == b;
        self.images.iter().enumerate().all(mutual)
    }

    /// Whether two joints are images of each other.
    fn are_images(&self, joint: &Joint, other: &Joint) -> bool {
        let normal = self.flipped(joint.frame[0]);
        joint.strength == other.strength
            && joint.corners.len() == other.corners.len()
            && normal.cross(&other.frame[0]).norm() <= SAME
            && joint
                .corners
                .iter()
                .all(|x| self.corner_at(self.image(*x), other).is_some())
    }

    /// Corner of a joint at a place.
    fn corner_at(&self, place: Vector3<f64>, joint: &Joint) -> Option<usize> {
        let close = |x: &Vector3<f64>| (place - x).norm() <= self.near;
        joint.corners.iter().position(close)
    }

    /// The image of a body.
    pub fn image_of(&self, body: usize) -> usize {
        self.images[body]
    }

    /// Number of bodies that a body stands for: itself and its image. 0 of the second body of a pair.
    pub fn stands_for(&self, body: usize) -> u8 {
        match self.images[body].cmp(&body) {
            std::cmp::Ordering::Less => 0,
            std::cmp::Ordering::Equal => 1,
            std::cmp::Ordering::Greater => 2,
        }
    }

    /// Symmetric motions of the bodies that are their own images, all motions of the first body of each pair, and none
    /// of the second one. `None` if a motion is neither symmetric nor antisymmetric, or if supports or beams leave some
    /// motions to a pair.
    ///
    /// Spins of a body refer to its centre. If the centre is not in the plane, its antisymmetric spins are those about
    /// the foot of the centre and symmetric velocities, which a body with spins has.
    pub fn motions(&self, bodies: &Bodies) -> Option<Vec<Vec<Motion>>> {
        let all = bodies.all.iter().enumerate();
        let of_body = |(b, body): (usize, &RigidBody)| {
            if self.images[b] == b {
                return self.symmetric(&body.motions);
            }
            let other = &bodies.all[self.images[b]];
            let apart = (self.image(body.centre) - other.centre).norm();
            let counts = [body.motions.len(), other.motions.len()];
            let alike = counts == [0, 0] || (counts == [6, 6] && apart <= self.near);
            let first = b < self.images[b];
            alike.then(|| {
                if first {
                    body.motions.clone()
                } else {
                    Vec::new()
                }
            })
        };
        all.map(of_body).collect()
    }

    /// The symmetric ones of motions; none if one is neither symmetric nor antisymmetric.
    fn symmetric(&self, motions: &[Motion]) -> Option<Vec<Motion>> {
        let along = |v: &Vector3<f64>| v.cross(&self.normal).norm() <= SAME * v.norm();
        let beside = |v: &Vector3<f64>| v[self.axis].abs() <= SAME * v.norm();
        let mut kept = Vec::with_capacity(3);
        for motion in motions {
            if beside(&motion.velocity) && along(&motion.spin) {
                kept.push(*motion);
            } else if !(along(&motion.velocity) && beside(&motion.spin)) {
                return None;
            }
        }
        Some(kept)
    }

    /// Whether dead and live loads are symmetric.
    pub fn keeps_loads(&self, bodies: &Bodies, actions: &Actions) -> bool {
        [&actions.dead, &actions.live].into_iter().all(|wrenches| {
            let all = wrenches.iter().enumerate();
            let mut moving = all.filter(|(b, _)| !bodies.all[*b].motions.is_empty());
            let force = moving.clone().map(|(_, w)| w.force.norm()).sum::<f64>();
            let moment = moving.clone().map(|(_, w)| w.moment.norm()).sum::<f64>();
            let size = SAME * (force + moment / bodies.size);
            moving.all(|(b, wrench)| {
                let image = self.images[b];
                let [force, moment] = self.about_foot(bodies, image, &wrenches[image]);
                let mirrored = self.mirrored(self.about_foot(bodies, b, wrench));
                let turns = bodies.all[b].motions.iter().any(|m| m.spin.norm() > 0.0);
                // Twice the part that is not symmetric.
                (force - mirrored[0]).norm() <= 2.0 * size
                    && (!turns || (moment - mirrored[1]).norm() <= 2.0 * size * bodies.size)
            })
        })
    }

    /// Orbits of the corners. With a compressive strength the edges of the blocks of stress of a joint that is its own
    /// image must be so, too; none if they are not.
    pub fn corners(&self, bodies: &Bodies, joints: &[Joint], crushed: bool) -> Option<Vec<Orbit>> {
        let mut firsts = Vec::with_capacity(joints.len());
        let mut next = 0;
        for joint in joints {
            firsts.push(next);
            next += joint.corners.len();
        }
        let mut orbits = Vec::new();
        for (j, joint) in joints.iter().enumerate() {
            if !bodies.can_move(joint) {
                continue;
            }
            let (other, turned) = self.joints[j]?;
            let own = j == other && !turned;
            let level = |edge: &Vector3<f64>| edge[self.axis].abs() <= SAME;
            if own && crushed && joint.is_rectangle() && !joint.edges().iter().any(level) {
                return None;
            }
            // Between two images forces are normal to the plane.
            let width = match (j == other, turned) {
                (true, true) => 1,
                (true, false) => 2,
                (false, _) => 3,
            };
            for (v, x) in joint.corners.iter().enumerate() {
                let image = self.corner_at(self.image(*x), &joints[other])?;
                let pair = (firsts[j] + v, firsts[other] + image);
                if pair.0 <= pair.1 {
                    orbits.push(Orbit {
                        corner: pair.0,
                        image: (pair.0 < pair.1).then_some(pair.1),
                        width,
                    });
                }
            }
        }
        Some(orbits)
    }

    /// Force on the first body of the image of a joint, for a force on the first body of the joint.
    pub fn reflected(&self, joint: usize, force: Vector3<f64>) -> Vector3<f64> {
        let turned = self.joints[joint].is_some_and(|(_, turned)| turned);
        let flipped = self.flipped(force);
        if turned { -flipped } else { flipped }
    }

    /// Symmetric reactions on the bodies that stand for others; none if the image of a reaction is none.
    pub fn reactions(&self, bodies: &Bodies) -> Option<Vec<Vec<(usize, Wrench)>>> {
        let all: Vec<_> = bodies.reactions.iter().map(|r| &r[..]).collect();
        let groups = self.pairs(bodies, &all, &[1.0, -1.0], &|_, _| true)?;
        let reactions = groups.into_iter().map(|(r, _)| {
            // The image of an antisymmetric reaction is its opposite.
            let mut sums = Summed::new();
            for (b, parts) in self.summed(bodies, &bodies.reactions[r]) {
                for (body, parts) in [(b, parts), (self.images[b], self.mirrored(parts))] {
                    let sum = sums.entry(body).or_default();
                    (0..2).for_each(|i| sum[i] += parts[i]);
                }
            }
            sums
        });
        let acts = |sums: &Summed| {
            let size = |[force, moment]: &[Vector3<f64>; 2]| {
                force.norm() > SAME || moment.norm() > self.near
            };
            sums.values().any(size)
        };
        let about_centres = |sums: Summed| {
            let first = sums.into_iter().filter(|(b, _)| *b <= self.images[*b]);
            let wrenches = first.map(|(b, [force, moment])| {
                let moment = moment - self.arm(bodies, b).cross(&force);
                (b, Wrench { force, moment })
            });
            wrenches.collect()
        };
        Some(reactions.filter(acts).map(about_centres).collect())
    }

    /// Rods with their images; none if the image of a rod is none.
    pub fn rods(&self, bodies: &Bodies, rods: &[Rod]) -> Option<Vec<(usize, Option<usize>)>> {
        let like =
            |a: usize, b: usize| (rods[a].most, rods[a].least) == (rods[b].most, rods[b].least);
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
    ) -> Option<Vec<(usize, Option<usize>)>> {
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
            let image = |(b, w): (&usize, &[Vector3<f64>; 2])| (self.images[*b], self.mirrored(*w));
            let mirrored: Summed = set.iter().map(image).collect();
            let bodies: Vec<usize> = mirrored.keys().copied().collect();
            let image = |other: &&usize| {
                !taken[**other] && like(s, **other) && self.equal(&sets[**other], &mirrored, signs)
            };
            let others = with.get(&bodies)?;
            // Its own image first: two equal sets would else be a pair.
            let found = others.iter().filter(|o| **o == s).find(image);
            let found = *found.or_else(|| others.iter().find(image))?;
            taken[s] = true;
            taken[found] = true;
            orbits.push((s, (found != s).then_some(found)));
        }
        Some(orbits)
    }

    /// Forces and moments of wrenches ([`Mirror::about_foot`]), added for each body that can move.
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

    /// Force of a wrench, and its moment about the foot of the centre in the plane. Of a body with an image, the moment
    /// about the centre.
    fn about_foot(&self, bodies: &Bodies, body: usize, wrench: &Wrench) -> [Vector3<f64>; 2] {
        let arm = self.arm(bodies, body);
        [wrench.force, wrench.moment + arm.cross(&wrench.force)]
    }

    /// Way from the point to which moments refer to the centre of a body.
    fn arm(&self, bodies: &Bodies, body: usize) -> Vector3<f64> {
        if self.images[body] == body {
            (bodies.all[body].centre[self.axis] - self.at) * self.normal
        } else {
            Vector3::zeros()
        }
    }

    fn image(&self, x: Vector3<f64>) -> Vector3<f64> {
        x + 2.0 * (self.at - x[self.axis]) * self.normal
    }

    /// Image of a vector.
    pub fn flipped(&self, v: Vector3<f64>) -> Vector3<f64> {
        v - 2.0 * v[self.axis] * self.normal
    }

    /// Image of a force and a moment, or of a velocity and a spin, which turn the other way round.
    pub fn mirrored(&self, [force, moment]: [Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
        [self.flipped(force), -self.flipped(moment)]
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

/// Joints by the cells of space in which their middles lie.
struct Cells {
    size: f64,
    joints: HashMap<[i64; 3], Vec<usize>>,
}

impl Cells {
    /// Cells of a size [mm] with the joints that matter.
    fn of(size: f64, bodies: &Bodies, joints: &[Joint]) -> Self {
        let mut cells = Self {
            size,
            joints: HashMap::new(),
        };
        for (j, joint) in joints.iter().enumerate() {
            if bodies.can_move(joint) {
                let cell = cells.around(joint.middle());
                cells.joints.entry(cell).or_default().push(j);
            }
        }
        cells
    }

    fn around(&self, x: Vector3<f64>) -> [i64; 3] {
        [0, 1, 2].map(|i| (x[i] / self.size).floor() as i64)
    }

    /// Joints in the cells within a distance of a place, which is less than a cell.
    fn near(&self, x: Vector3<f64>, distance: f64) -> impl Iterator<Item = usize> {
        let low = self.around(x.add_scalar(-distance));
        let high = self.around(x.add_scalar(distance));
        let corners = (0..8).map(move |k| [0, 1, 2].map(|i| [low[i], high[i]][k >> i & 1]));
        let mut cells: Vec<[i64; 3]> = corners.collect();
        cells.sort_unstable();
        cells.dedup();
        let found = cells.into_iter().filter_map(|cell| self.joints.get(&cell));
        found.flatten().copied()
    }
}
