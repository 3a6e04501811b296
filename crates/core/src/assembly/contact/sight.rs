//! Kinematics of one contact point, independent of the way they were computed.

use nalgebra::Vector3;
use wythe_contact::stencil::Anchor;
use wythe_contact::{FourSeen, InterfaceHistory, Kinematics, PointPair, frame_at, to_frame};

use super::Contact;

/// Kinematics of a point.
#[derive(Clone, Copy, Debug)]
pub(in crate::assembly) struct Sight {
    /// Index of its cell among those of its facet.
    pub cell: usize,
    /// Normal gap [mm].
    pub gap: f64,
    /// Slip since the last commit [mm].
    pub slip: [f64; 2],
    /// n, t₁, t₂.
    pub frame: [[f64; 3]; 3],
    /// Parameters of the foot.
    pub xi: [f64; 2],
    /// Weights of the relative displacement. `[slave corners, master corners]`
    pub weights: [f64; 8],
}

impl Sight {
    /// Kinematics of one of four points computed together.
    #[inline(always)]
    pub fn of(cell: usize, four: &FourSeen, p: usize) -> Self {
        let mut sight = Self {
            cell,
            gap: four.gap.0[p],
            slip: [four.slip[0].0[p], four.slip[1].0[p]],
            frame: [[0.0; 3]; 3],
            xi: [four.xi[0].0[p], four.xi[1].0[p]],
            weights: [0.0; 8],
        };
        for axis in 0..3 {
            for i in 0..3 {
                sight.frame[axis][i] = four.frame[axis][i].0[p];
            }
        }
        for a in 0..8 {
            sight.weights[a] = four.weights[a].0[p];
        }
        sight
    }

    /// Kinematics of a point computed alone.
    pub fn new(cell: usize, kin: &Kinematics) -> Self {
        Self {
            cell,
            gap: kin.gap,
            slip: kin.slip,
            frame: kin.frame.map(Into::into),
            xi: kin.xi,
            weights: *kin.weights(),
        }
    }

    /// n, t₁, t₂.
    pub fn axes(&self) -> [Vector3<f64>; 3] {
        self.frame.map(Vector3::from)
    }

    /// Adds the internal forces of the eight nodes [N]; area in mm².
    #[inline(always)]
    pub fn add_force(&self, traction: &[f64; 3], area: f64, force: &mut [[f64; 3]; 8]) {
        let [n, t1, t2] = &self.frame;
        let [sigma, tau1, tau2] = traction;
        let along = |i: usize| (n[i] * sigma + t1[i] * tau1 + t2[i] * tau2) * area;
        let t = [along(0), along(1), along(2)];
        for a in 0..8 {
            for i in 0..3 {
                force[a][i] += self.weights[a] * t[i];
            }
        }
    }
}

impl Contact {
    /// Kinematics of a point, and the index of its cell among those of its facet.
    pub(in crate::assembly) fn see(
        &self,
        at: usize,
        slave: &[[f64; 3]; 4],
        committed: PointPair,
        pair: PointPair,
        x: &[[f64; 3]],
    ) -> Option<(usize, Kinematics)> {
        let facet = pair.facet?;
        let cell = self.candidates.of(at / 4).binary_search(&facet).ok()?;
        let master = self.master.corners(facet as usize, x);
        let anchor = self.anchor(committed, pair, x);
        let weights = &self.points[at].weights;
        let kin = Kinematics::new(slave, weights, &master, pair.xi, anchor)?;
        Some((cell, kin))
    }

    /// Start of the slip of this increment: the foot at the last commit, moved with its facet. For a point that
    /// comes into contact it is the present foot.
    fn anchor(&self, committed: PointPair, now: PointPair, x: &[[f64; 3]]) -> Anchor {
        match committed.facet {
            Some(facet) if Some(facet) == now.facet => Anchor::Same(committed.xi),
            Some(facet) => {
                // The point has moved to another facet in this increment.
                let corners = self.master.corners(facet as usize, x);
                Anchor::At(wythe_contact::surface::point_at(&corners, committed.xi).into())
            }
            None => Anchor::Same(now.xi),
        }
    }

    /// History with its tangential components in the frame of the present facet (theory/contact.md, eq. 8).
    pub(in crate::assembly) fn carried(
        &self,
        old: &InterfaceHistory,
        committed: PointPair,
        now: PointPair,
        frame: &[Vector3<f64>; 3],
        x: &[[f64; 3]],
    ) -> InterfaceHistory {
        match committed.facet {
            Some(facet) if Some(facet) != now.facet => {
                let corners = self.master.corners(facet as usize, x);
                let from = frame_at(&corners, committed.xi);
                let shear = to_frame([old.traction[1], old.traction[2]], &from, frame);
                InterfaceHistory {
                    slip: to_frame(old.slip, &from, frame),
                    plastic_slip: to_frame(old.plastic_slip, &from, frame),
                    traction: [old.traction[0], shear[0], shear[1]],
                    ..*old
                }
            }
            _ => *old,
        }
    }
}
