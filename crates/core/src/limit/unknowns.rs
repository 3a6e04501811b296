//! Unknowns of the program: motions of the bodies and forces at the corners, fewer where the scene is a mirror image of
//! itself.

use nalgebra::Vector3;

use super::actions::Actions;
use super::bodies::{Bodies, Motion, Wrench};
use super::joints::Joint;
use super::mirror::Mirror;
use super::program::Corner;
use super::rods::Rod;

/// A corner of a joint and its mirror image, which carry the same force: one set of unknowns stands for both.
#[derive(Clone, Copy, Debug)]
pub struct Orbit {
    /// A corner.
    pub corner: usize,
    /// Its mirror image; none if it is its own one, or without a mirror.
    pub image: Option<usize>,
    /// Number of force components: the normal force, and shear in the plane, or in all directions.
    pub width: usize,
}

impl Orbit {
    /// The corner and its image.
    pub fn members(&self) -> impl Iterator<Item = usize> {
        [Some(self.corner), self.image].into_iter().flatten()
    }
}

/// Unknowns of a program.
#[derive(Clone, Debug)]
pub struct Unknowns {
    /// Independent motions of each body; none of the second body of a pair of images. `[body]`
    pub motions: Vec<Vec<Motion>>,
    /// Reactions of supports that leave some motions, and of springs: wrenches on bodies for a force of 1.
    pub reactions: Vec<Vec<(usize, Wrench)>>,
    /// Corners of joints, each with its mirror image; those between bodies that are held are left out.
    pub corners: Vec<Orbit>,
    /// First column of each orbit of corners, and the one after the last. `[orbit + 1]`
    starts: Vec<usize>,
    /// Rods with one force each, and their images.
    pub rods: Vec<(usize, Option<usize>)>,
    /// The mirror plane.
    pub mirror: Option<Mirror>,
}

impl Unknowns {
    /// All unknowns.
    pub fn all(bodies: &Bodies, joints: &[Joint], rods: &[Rod]) -> Self {
        let mut first = 0;
        let mut corners = Vec::new();
        for joint in joints {
            let own = first..first + joint.corners.len();
            first = own.end;
            if bodies.can_move(joint) {
                corners.extend(own.map(|corner| Orbit {
                    corner,
                    image: None,
                    width: 3,
                }));
            }
        }
        Self {
            motions: bodies.all.iter().map(|b| b.motions.clone()).collect(),
            reactions: bodies.reactions.clone(),
            starts: starts(&corners),
            corners,
            rods: (0..rods.len()).map(|r| (r, None)).collect(),
            mirror: None,
        }
    }

    /// Unknowns of symmetric states, if the scene is a mirror image of itself: by convexity the largest factor has a
    /// symmetric state and a symmetric mechanism. `crushed`: joints have a compressive strength.
    pub fn symmetric(
        bodies: &Bodies,
        joints: &[Joint],
        rods: &[Rod],
        actions: &Actions,
        crushed: bool,
    ) -> Option<Self> {
        // Walls stand along x as a rule, so y comes first.
        [1, 0, 2].into_iter().find_map(|axis| {
            let mirror = Mirror::of(axis, bodies, joints)?;
            mirror.keeps_loads(bodies, actions).then_some(())?;
            let corners = mirror.corners(bodies, joints, crushed)?;
            Some(Self {
                motions: mirror.motions(bodies)?,
                reactions: mirror.reactions(bodies)?,
                starts: starts(&corners),
                corners,
                rods: mirror.rods(bodies, rods)?,
                mirror: Some(mirror),
            })
        })
    }

    /// Columns of an orbit of corners.
    pub fn columns_of(&self, orbit: usize) -> std::ops::Range<usize> {
        self.starts[orbit]..self.starts[orbit + 1]
    }

    /// Orbits of corners with their first columns.
    pub fn orbits(&self) -> impl Iterator<Item = (usize, &Orbit)> + Clone {
        self.starts.iter().copied().zip(&self.corners)
    }

    /// Number of bodies that a body stands for: itself, and its image if that is another one.
    pub fn stands_for(&self, body: usize) -> f64 {
        let count = |mirror: &Mirror| f64::from(mirror.stands_for(body));
        self.mirror.as_ref().map_or(1.0, count)
    }

    /// Directions of the force components of an orbit on the first body of the joint of its corner: the normal force,
    /// which pushes it back, and the shear forces. Only as many as the orbit is wide count.
    pub fn directions(&self, orbit: &Orbit, joint: &Joint) -> [Vector3<f64>; 3] {
        let [normal, first, second] = joint.frame;
        match &self.mirror {
            Some(mirror) if orbit.width < 3 => {
                let mut across = Vector3::zeros();
                across[mirror.axis] = 1.0;
                [-normal, across.cross(&normal), across]
            }
            _ => [-normal, first, second],
        }
    }

    /// A force at the corner of an orbit on the first body of its joint, and the same at one of the members.
    pub fn at_member(
        &self,
        orbit: &Orbit,
        member: usize,
        corners: &[Corner],
        force: Vector3<f64>,
    ) -> Vector3<f64> {
        match &self.mirror {
            Some(mirror) if member != orbit.corner => {
                mirror.reflected(corners[orbit.corner].joint, force)
            }
            _ => force,
        }
    }

    /// First equation of each body, and their number. `[body + 1]`
    pub fn first_rows(&self) -> Vec<usize> {
        let mut first = Vec::with_capacity(self.motions.len() + 1);
        first.push(0);
        let mut next = 0;
        for motions in &self.motions {
            next += motions.len();
            first.push(next);
        }
        first
    }

    /// Column of the first rod: after λ and the corners. Those of reactions follow.
    pub fn first_rod(&self) -> usize {
        self.starts[self.corners.len()]
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.first_rod() + self.rods.len() + self.reactions.len()
    }
}

/// First column of each orbit, after that of λ, and the one after the last.
fn starts(corners: &[Orbit]) -> Vec<usize> {
    let mut starts = vec![1];
    let mut next = 1;
    for orbit in corners {
        next += orbit.width;
        starts.push(next);
    }
    starts
}
