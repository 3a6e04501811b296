//! Stiffness reuse for elements and points that hardly move.
//!
//! A crack in a façade rotates few elements and opens few joints. The stiffness of an elastic element depends on
//! its rotation and, slightly, on its stress. The stiffness of a sticking point depends on the rotation of its
//! facet. The pose is the position at which the stiffness was written. While the rotation from the pose is at most
//! [`TURN`] and the strain is close to that at the pose, the cell keeps its bits, and the factorisation keeps its
//! results for it (`linear::reuse`). Forces always follow the laws at the present positions, and so does the
//! equilibrium check. Reuse therefore costs no accuracy: the tangent errs by 1e-4 and its stress terms by a
//! twentieth (theory/linear-solver.md, eq. 10).
//!
//! Poses are part of the state, so a resumed run takes the same iterates.

use crate::state::{PointPose, Poses};
use rayon::prelude::*;
use wythe_contact::surface::weights_at;
use wythe_contact::{PointPair, PointStatus, Symmetric, frame_at};

use super::contact::Sight;
use super::{Bulk, Contact, Trial};
use crate::element::{ElementShape, green_strain};

/// Largest relative movement of corners over the element's size at which its stiffness is reused [-].
const TURN: f64 = 1e-4;
/// Stress stiffens and softens slender bodies, so the change of strain is bounded: by this part of it ...
const SHARE: f64 = 0.05;
/// ... or by this strain, at which no wall buckles that is less than 450 times as high as thick (π²/48 (t/h)²) [-].
const STRAIN: f64 = 1e-6;
/// Part of these bounds that applies at a commit. A pose close to its bounds would exceed them in the next
/// iterates.
const AT_COMMIT: f64 = 0.5;

/// Largest part of the points that may slide if sticking points are to keep their numerical stiffness. Where joints
/// slide all over a wall (a tenth to a third of J7D's points), no part of the factorisation can be reused, and the
/// iterates need the growth of all numerical stiffnesses (J7D to 3.3 mm: 269 solves with it, 286 without). In a
/// façade with one crack a hundredth of the points slides.
const FEW: f64 = 0.05;

/// Stiffness in the cells of a slave facet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Joint {
    /// Whether the contact cells of the facet hold the stiffness of its points at the stored positions, so that it
    /// can be used again.
    pub held: bool,
    /// One bit for each point with a master facet.
    pub seen: u8,
    /// Unique entries of each point's stiffness, `[n, 11, 12, 22]` [N/mm³].
    pub k: [[f64; 4]; 4],
}

/// Position at which the stiffness of an elastic element is written in this increment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kept {
    /// Positions of the corners [mm]. `[node][xyz]`
    pub pose: [[f64; 3]; 8],
    /// Whether the cell contains the stiffness at this position.
    pub held: bool,
}

/// Contents of the cells of a trial. Cells without an entry are written again.
#[derive(Clone, Debug, Default)]
pub(super) struct Held {
    /// `[element]`
    pub solids: Vec<Kept>,
    /// `[slave facet]`
    pub joints: Vec<Joint>,
    /// Version of the contact candidates for which the joints' cells were written.
    pub version: usize,
}

impl Held {
    /// Begins an increment with the poses of the state, whatever a rejected attempt wrote since.
    pub fn begin(&mut self, poses: &Poses) {
        if poses.is_empty() {
            return;
        }
        self.solids.resize(poses.solids.len(), Kept::default());
        for (kept, pose) in self.solids.iter_mut().zip(&poses.solids) {
            if kept.pose != *pose {
                *kept = Kept {
                    pose: *pose,
                    held: false,
                };
            }
        }
    }

    /// Makes room for all elements.
    pub fn fit_solids(&mut self, elements: usize) {
        self.solids.resize(elements, Kept::default());
    }

    /// Marks that the cells of the elements were written without their poses.
    pub fn forget_solids(&mut self) {
        for kept in &mut self.solids {
            kept.held = false;
        }
    }

    /// Makes room for all facets. Cells written for other candidates are invalid.
    pub fn fit_joints(&mut self, facets: usize, version: usize) {
        if self.version != version {
            self.joints.clear();
            self.version = version;
        }
        self.joints.resize(facets, Joint::default());
    }

    /// Marks that the points of a slave facet have changed their places on it since its cells were written.
    pub fn forget_joint(&mut self, facet: usize) {
        if let Some(joint) = self.joints.get_mut(facet) {
            *joint = Joint::default();
        }
    }

    /// Marks that all cells were written without their poses.
    pub fn forget(&mut self) {
        self.forget_solids();
        self.joints.clear();
    }
}

/// Whether the stiffness at `pose` is accurate enough for an element with corners `x`. `part` scales the bounds on
/// rotation and strain.
#[inline(always)]
pub(super) fn stands_for(
    pose: &[[f64; 3]; 8],
    x: &[[f64; 3]; 8],
    shape: &ElementShape,
    part: f64,
) -> bool {
    let mut most = 0.0_f64;
    for a in 1..8 {
        for i in 0..3 {
            let now = x[a][i] - x[0][i];
            let then = pose[a][i] - pose[0][i];
            most = most.max((now - then).abs());
        }
    }
    if most > part * TURN * shape.size {
        return false;
    }
    let [now, then] = [x, pose].map(|x| green_strain(shape, x));
    let strain = now.amax().max(then.amax());
    (now - then).amax() <= part * STRAIN.max(SHARE * strain)
}

impl PointPose {
    /// Whether the foot and the frame of a point are those of the pose, up to `turn`.
    #[inline(always)]
    fn is_near(&self, pair: &PointPair, frame: &[[f64; 3]; 3], turn: f64) -> bool {
        if self.pair.facet != pair.facet {
            return false;
        }
        let mut most = 0.0_f64;
        for i in 0..2 {
            most = most.max((self.pair.xi[i] - pair.xi[i]).abs());
        }
        for axis in 0..3 {
            for i in 0..3 {
                most = most.max((self.frame[axis][i] - frame[axis][i]).abs());
            }
        }
        most <= turn
    }

    /// Whether the present kinematics are close enough for the stiffness to be taken at the pose.
    #[inline(always)]
    pub(super) fn stands_for(&self, pair: &PointPair, sight: &Sight) -> bool {
        self.is_near(pair, &sight.frame, TURN)
    }

    /// Stiffness at the pose of a point with slave weights `slave`.
    #[inline(always)]
    pub(super) fn stiffness(&self, slave: &[f64; 4], k: [f64; 4], area: f64) -> Symmetric {
        let [a, b, c, d] = weights_at(self.pair.xi);
        let [e, f, g, h] = *slave;
        let weights = [e, f, g, h, -a, -b, -c, -d];
        Symmetric::new(weights, &self.frame, k, area)
    }
}

impl Poses {
    /// Poses of bodies at rest. Those of contact points are still undetermined.
    pub fn at_rest(bulk: &Bulk, contact: &Contact) -> Self {
        let corners = |nodes: &[u32; 8]| nodes.map(|n| bulk.reference[n as usize]);
        Self {
            solids: bulk.elements.iter().map(corners).collect(),
            points: vec![PointPose::default(); contact.points.len()],
            steady: true,
        }
    }

    /// True where stiffness is not reused.
    pub fn is_empty(&self) -> bool {
        self.solids.is_empty()
    }

    /// Renews the poses that are too far from the positions at which `trial` ends.
    pub(super) fn follow(&mut self, bulk: &Bulk, contact: &Contact, trial: &mut Trial) {
        let slides = trial
            .joints
            .status
            .iter()
            .filter(|s| **s == PointStatus::Slip);
        self.steady = slides.count() as f64 <= FEW * self.points.len() as f64;
        let (x, pairs, held) = (&trial.x, &trial.joints.pairs, &mut trial.cells.held);
        held.fit_solids(self.solids.len());
        held.fit_joints(self.points.len() / 4, contact.version());
        let elements = bulk.elements.par_iter().enumerate();
        let solids = self.solids.par_iter_mut().zip(&mut held.solids);
        solids.zip(elements).for_each(|((pose, kept), (e, nodes))| {
            let corners = nodes.map(|n| x[n as usize]);
            if !stands_for(&kept.pose, &corners, bulk.shape(e), AT_COMMIT) {
                (kept.pose, kept.held) = (corners, false);
            }
            *pose = kept.pose;
        });
        let facets = self.points.par_chunks_exact_mut(4).zip(&mut held.joints);
        let pairs = pairs.par_chunks_exact(4);
        facets.zip(pairs).for_each(|((poses, joint), pairs)| {
            for (pose, pair) in poses.iter_mut().zip(pairs) {
                let frame = contact.frame_of(pair, x).unwrap_or_default();
                if !pose.is_near(pair, &frame, AT_COMMIT * TURN) {
                    *pose = PointPose { pair: *pair, frame };
                    joint.held = false;
                }
            }
        });
    }
}

impl Contact {
    /// n, t₁, t₂ at the foot of a point. None if it has no master facet.
    fn frame_of(&self, pair: &PointPair, x: &[[f64; 3]]) -> Option<[[f64; 3]; 3]> {
        let corners = self.master.corners(pair.facet? as usize, x);
        Some(frame_at(&corners, pair.xi).map(Into::into))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Formulation;
    use crate::element::hex8::CORNERS;
    use crate::material::ElasticParameters;

    /// A cube of 100 mm.
    fn cube() -> ([[f64; 3]; 8], ElementShape) {
        let corners = CORNERS.map(|c| c.map(|v| 50.0 * v));
        let elastic = ElasticParameters {
            E: 1e4,
            nu: 0.2,
            density: 0.0,
        };
        let shape = ElementShape::new(&corners, Formulation::default(), &elastic).unwrap();
        (corners, shape)
    }

    /// Corners rotated about z by an angle and strained along z.
    fn moved(corners: &[[f64; 3]; 8], angle: f64, strain: f64) -> [[f64; 3]; 8] {
        let (s, c) = angle.sin_cos();
        corners.map(|[x, y, z]| [c * x - s * y + 3.0, s * x + c * y, (1.0 + strain) * z])
    }

    #[test]
    fn element_stiffness_is_reused_until_rotation_or_strain_changes() {
        let (corners, shape) = cube();
        let kept = |pose: [f64; 2], now: [f64; 2], part| {
            let [pose, now] = [pose, now].map(|[angle, strain]| moved(&corners, angle, strain));
            stands_for(&pose, &now, &shape, part)
        };
        // Rotation.
        assert!(kept([0.0; 2], [0.6 * TURN, 0.0], 1.0));
        assert!(!kept([0.0; 2], [0.6 * TURN, 0.0], AT_COMMIT));
        assert!(!kept([0.0; 2], [1.5 * TURN, 0.0], 1.0));
        // Strain, starting from zero and from 1e-4.
        assert!(kept([0.0; 2], [0.0, 0.9 * STRAIN], 1.0));
        assert!(!kept([0.0; 2], [0.0, 1.1 * STRAIN], 1.0));
        assert!(kept([0.0, -1e-4], [0.0, -1e-4 * (1.0 - 0.9 * SHARE)], 1.0));
        assert!(!kept([0.0, -1e-4], [0.0, -1e-4 * (1.0 - 1.1 * SHARE)], 1.0));
        // Rotation alone causes no strain.
        let turned = green_strain(&shape, &moved(&corners, 0.5, 1e-3));
        // (1 + e)²/2 − 1/2, to rounding of coordinates over the size.
        assert!((turned.m33 - (1e-3 + 0.5e-6)).abs() < 1e-14, "{turned}");
        assert!((turned.amax() - turned.m33).abs() < 1e-14, "{turned}");
    }

    #[test]
    fn an_increment_reuses_stiffness_only_of_unmoved_elements() {
        let (corners, _) = cube();
        let elsewhere = moved(&corners, 0.1, 0.0);
        let poses = Poses {
            solids: vec![corners; 2],
            ..Poses::default()
        };
        let mut held = Held::default();
        held.begin(&poses);
        held.solids.fill(Kept {
            pose: corners,
            held: true,
        });
        held.solids[1].pose = elsewhere;
        held.begin(&poses);
        let still = held.solids.iter().map(|kept| kept.held);
        assert!(still.eq([true, false]));
        assert!(held.solids.iter().all(|kept| kept.pose == corners));
    }
}
