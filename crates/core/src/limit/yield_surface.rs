//! Strengths at the corners of the joints, and how they follow the forces where sliding has no dilatancy.

use super::joints::Joint;
use super::program::Corner;

/// Strengths at all corners.
#[derive(Clone, Debug)]
pub struct YieldSurface<'a> {
    corners: Vec<Corner>,
    /// Joints.
    joints: &'a [Joint],
    /// Normal force at each corner through which the surface passes [N].
    normal: Vec<f64>,
}

/// Friction of the surface that stands for sliding without dilatancy, over the friction of the joint (Gilbert,
/// Casapulla and Ahmed 2006).
const LEVEL: f64 = 0.01;
/// Part of the last normal forces that the next surface keeps after [`SWINGS`] programs, so that swings die out.
const KEPT: f64 = 0.6;
/// Programs after which forces are kept.
const SWINGS: usize = 6;
/// Part of the largest normal force by which forces may miss the surface.
const MISSED: f64 = 0.01;
/// Smallest force that counts [N].
const NOTHING: f64 = 1e-6;

impl<'a> YieldSurface<'a> {
    /// Surface of Coulomb's law at all corners of joints.
    pub fn new(joints: &'a [Joint]) -> Self {
        let corners = joints.iter().enumerate().flat_map(|(j, joint)| {
            let share = joint.area / joint.corners.len() as f64;
            joint.corners.iter().map(move |at| Corner {
                joint: j,
                at: *at,
                friction: joint.strength.friction,
                cohesion: joint.strength.cohesion * share,
                tension: joint.strength.tension * share,
            })
        });
        let corners: Vec<Corner> = corners.collect();
        Self {
            normal: vec![0.0; corners.len()],
            corners,
            joints,
        }
    }

    /// Corners with their strengths.
    pub fn corners(&self) -> &[Corner] {
        &self.corners
    }

    /// Replaces Coulomb's law by an almost level one through the forces at the corners (normal, shear) [N], after
    /// `programs` of them.
    pub fn follow(&mut self, forces: &[[f64; 3]], programs: usize) {
        let kept = if programs < SWINGS { 0.0 } else { KEPT };
        let corners = self.corners.iter_mut().zip(&mut self.normal);
        for ((corner, normal), [new, ..]) in corners.zip(forces) {
            *normal = kept * *normal + (1.0 - kept) * new;
            let joint = &self.joints[corner.joint];
            let share = joint.area / joint.corners.len() as f64;
            let friction = joint.strength.friction;
            corner.friction = LEVEL * friction;
            corner.cohesion =
                joint.strength.cohesion * share + (1.0 - LEVEL) * friction * normal.max(0.0);
        }
    }

    /// Whether forces satisfy Coulomb's law of the joints, which the surface stands for, to a small part.
    pub fn holds(&self, forces: &[[f64; 3]]) -> bool {
        let most = forces.iter().map(|[n, ..]| n.abs()).fold(0.0, f64::max);
        let corners = self.corners.iter().zip(forces);
        let miss = |(corner, [n, a, b]): (&Corner, &[f64; 3])| {
            let joint = &self.joints[corner.joint];
            let share = joint.area / joint.corners.len() as f64;
            a.hypot(*b) - joint.strength.friction * n - joint.strength.cohesion * share
        };
        corners.map(miss).fold(0.0, f64::max) <= MISSED * most + NOTHING
    }
}
