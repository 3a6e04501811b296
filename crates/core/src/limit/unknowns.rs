//! Unknowns of the program: motions of the bodies and forces at the corners, fewer where the scene is a mirror image of
//! itself.

use nalgebra::Vector3;

use super::actions::Actions;
use super::bodies::{Bodies, Motion, Wrench};
use super::joints::Joint;
use super::mirror::Mirror;
use super::rods::Rod;

/// A corner or rod and its mirror image; none if it is its own one, or without a mirror.
pub type Orbit = (usize, Option<usize>);

/// Number of members of an orbit.
pub fn members(orbit: &Orbit) -> f64 {
    if orbit.1.is_some() { 2.0 } else { 1.0 }
}

/// Unknowns of a program.
#[derive(Clone, Debug)]
pub struct Unknowns {
    /// Independent motions of each body. `[body]`
    pub motions: Vec<Vec<Motion>>,
    /// Reactions of supports that leave some motions, and of springs: wrenches on bodies for a force of 1.
    pub reactions: Vec<Vec<(usize, Wrench)>>,
    /// Corners with one force each, those between bodies that are held left out.
    pub corners: Vec<Orbit>,
    /// Rods with one force each.
    pub rods: Vec<Orbit>,
    /// Axis of the normal of the mirror plane; shear forces along it are zero.
    pub axis: Option<usize>,
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
                corners.extend(own.map(|v| (v, None)));
            }
        }
        Self {
            motions: bodies.all.iter().map(|b| b.motions.clone()).collect(),
            reactions: bodies.reactions.clone(),
            corners,
            rods: (0..rods.len()).map(|r| (r, None)).collect(),
            axis: None,
        }
    }

    /// Unknowns of symmetric states, if the scene is a mirror image of itself in which each body is its own image: by
    /// convexity the largest factor has a symmetric state and a symmetric mechanism. `crushed`: joints have a
    /// compressive strength.
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
            Some(Self {
                motions: mirror.motions(bodies)?,
                reactions: mirror.reactions(bodies)?,
                corners: mirror.corners(bodies, joints, crushed)?,
                rods: mirror.rods(bodies, rods)?,
                axis: Some(axis),
            })
        })
    }

    /// Number of force components at a corner.
    pub fn width(&self) -> usize {
        if self.axis.is_some() { 2 } else { 3 }
    }

    /// Directions of the force components on the first body of a joint: the normal force, which pushes it back, and
    /// the shear forces. Only the first [`Unknowns::width`] count.
    pub fn directions(&self, joint: &Joint) -> [Vector3<f64>; 3] {
        let [normal, first, second] = joint.frame;
        match self.axis {
            Some(axis) => {
                let mut across = Vector3::zeros();
                across[axis] = 1.0;
                [-normal, across.cross(&normal), across]
            }
            None => [-normal, first, second],
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
        1 + self.width() * self.corners.len()
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.first_rod() + self.rods.len() + self.reactions.len()
    }
}
