//! Traction patterns that the nodes hardly feel, brought to the law at once (shifted penalty).
//!
//! Four points on a facet carry more patterns of tractions than its nodes have displacements. Where
//! bent faces have slid on each other their gaps hold such patterns, and the law asks for t = k g of
//! them; an iterate of the shifted penalty brings the part k'/k of what is missing, some thousandths,
//! and no node tells. Their pressure bounds the friction of points that slide, so that they matter.
//!
//! What an elastic point misses is m = k g − t. With every node on springs of the numerical stiffness
//! the change of the tractions that settles it is
//!
//! ```text
//! δt = m − B y,   (BᵀA B + Λ) y = BᵀA m
//! ```
//!
//! B y: relative displacements of the points, A: their areas, Λ: k'/k times the diagonal of BᵀA B. What
//! nodes do not feel (BᵀA m = 0) changes by all of m, what they feel by no more than in an iterate.

use nalgebra::{Matrix3, Vector3};
use wythe_contact::{PointStatus, Shift};

use super::contact::{Contact, Soft, total_gap};
use super::{System, Trial};
use crate::model::Model;
use crate::solve::State;
use crate::system::DofMap;

/// Most steps of conjugate gradients: BᵀA B is a mass matrix, each step halves what is left.
const STEPS: usize = 60;
/// Accepted fall of their residual over the least k'/k: what nodes feel is in m k/k' times as large as in
/// the tractions.
const FALL: f64 = 0.3;

/// Least k'/k: where the penalty is stiffer its patterns exceed the strengths, and no iteration finds a
/// balance with them.
const SOFTEST: f64 = 1e-3;

/// A point that presses.
struct Pressed {
    /// Its place among all points.
    point: usize,
    nodes: [u32; 8],
    weights: [f64; 8],
    /// n, t₁, t₂.
    frame: [Vector3<f64>; 3],
    area: f64,
    /// Projector on the elastic directions: n, and all where it sticks.
    elastic: Matrix3<f64>,
    /// m in these directions [MPa].
    missing: Vector3<f64>,
    /// k'/k.
    softness: f64,
}

impl Pressed {
    /// Movement of the slave against the master [mm] of nodes that move by `y`. `[node]`
    fn relative(&self, y: &[Vector3<f64>]) -> Vector3<f64> {
        let nodes = self.nodes.iter().zip(&self.weights);
        nodes.fold(Vector3::zeros(), |sum, (&n, w)| sum + y[n as usize] * *w)
    }
}

impl System {
    /// Tractions of points with their patterns settled [MPa], where that would change the work of sliding
    /// points by more than `most` [N mm] over the way `dq` of the increment [mm] `[slot]`; else none.
    pub fn settled_tractions(
        &self,
        model: &Model,
        state: &State,
        trial: &Trial,
        dq: &[f64],
        most: f64,
    ) -> Option<Vec<(usize, [f64; 3])>> {
        let dissipated: f64 = trial.point_energy.iter().map(|e| e[1]).sum();
        if dissipated.is_nan() || dissipated <= most {
            return None;
        }
        let mut way = vec![[0.0; 3]; trial.x.len()];
        self.dofs.spread(dq, &mut way);
        let way: Vec<_> = way.into_iter().map(Vector3::from).collect();
        let points = self.contact.pressed(model, trial);
        let mut work = 0.0;
        let mut changes = Vec::with_capacity(points.len());
        for (pressed, change) in points.iter().zip(settling(&points, &self.dofs)) {
            // Beyond its bounds a traction would be read as an opening of the joint.
            let history = &trial.interface[pressed.point];
            let law = self.contact.law(model, pressed.point);
            let settled = [0, 1, 2].map(|i| history.traction[i] + change[i]);
            let settled = law.within_bounds(settled, history);
            let by = self
                .contact
                .change_of(model, state, trial, pressed, settled);
            let moved = pressed.relative(&way);
            for (by, axis) in by.iter().zip(&pressed.frame) {
                work += pressed.area * by * axis.dot(&moved);
            }
            changes.push((pressed.point, settled));
        }
        (work.abs() > most).then_some(changes)
    }
}

/// δt of each point in its frame [MPa], by conjugate gradients with the diagonal.
fn settling(points: &[Pressed], dofs: &DofMap) -> Vec<[f64; 3]> {
    let nodes = dofs.slot.len();
    let zero = vec![Vector3::zeros(); nodes];
    let dot = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> f64 {
        a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
    };
    let (mut r, mut diagonal) = (zero.clone(), vec![0.0; nodes]);
    for p in points {
        for (&n, w) in p.nodes.iter().zip(&p.weights) {
            r[n as usize] += p.missing * (p.area * w);
            diagonal[n as usize] += p.area * w * w * (1.0 + p.softness);
        }
    }
    fold(dofs, &mut r);
    for image in dofs.reflected() {
        diagonal[image.of as usize] += std::mem::take(&mut diagonal[image.node as usize]);
    }
    let scaled = |r: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
        let entries = r.iter().zip(&diagonal);
        entries
            .map(|(r, d)| if *d > 0.0 { r / *d } else { *r })
            .collect()
    };
    let mut y = zero.clone();
    let mut z = scaled(&r);
    let mut direction = z.clone();
    let mut size = dot(&r, &z);
    let softest = points
        .iter()
        .fold(1.0_f64, |least, p| least.min(p.softness));
    let enough = (FALL * softest).powi(2) * size;
    for _ in 0..STEPS {
        if size.is_nan() || size <= enough {
            break;
        }
        // Images move as what they are images of.
        for image in dofs.reflected() {
            let of = direction[image.of as usize];
            direction[image.node as usize] = of.component_mul(&Vector3::from(image.sign));
        }
        let mut pulled = zero.clone();
        for p in points {
            let force = p.elastic * p.relative(&direction) * p.area;
            for (&n, w) in p.nodes.iter().zip(&p.weights) {
                let n = n as usize;
                pulled[n] += force * *w + direction[n] * (p.area * w * w * p.softness);
            }
        }
        fold(dofs, &mut pulled);
        let step = size / dot(&direction, &pulled);
        for i in 0..nodes {
            y[i] += direction[i] * step;
            r[i] -= pulled[i] * step;
        }
        z = scaled(&r);
        let next = dot(&r, &z);
        for (d, z) in direction.iter_mut().zip(&z) {
            *d = z + *d * (next / size);
        }
        size = next;
    }
    points
        .iter()
        .map(|p| {
            let change = p.missing - p.elastic * p.relative(&y);
            p.frame.map(|axis| axis.dot(&change))
        })
        .collect()
}

/// Lets what acts on images act on what they are images of.
fn fold(dofs: &DofMap, f: &mut [Vector3<f64>]) {
    for image in dofs.reflected() {
        let own = std::mem::take(&mut f[image.node as usize]);
        f[image.of as usize] += own.component_mul(&Vector3::from(image.sign));
    }
}

impl Contact {
    /// The points that press on facets where one slides.
    fn pressed(&self, model: &Model, trial: &Trial) -> Vec<Pressed> {
        let mut found = Vec::new();
        for (f, status) in trial.status.chunks_exact(4).enumerate() {
            if !status.contains(&PointStatus::Slip) {
                continue;
            }
            let law = self.law(model, 4 * f);
            let softness = (self.numerical[f][0] / law.normal_stiffness).min(1.0);
            if softness < SOFTEST {
                continue;
            }
            let slave = self.slave.corners(f, &trial.x);
            for (p, status) in status.iter().enumerate() {
                let point = 4 * f + p;
                let history = &trial.interface[point];
                if history.traction[0] >= 0.0 {
                    continue;
                }
                let (anchor, pair) = (trial.anchors[point], trial.pairs[point]);
                let Some((cell, kin)) = self.see(point, &slave, anchor, pair, &trial.x) else {
                    continue;
                };
                let [n, t_1, t_2] = kin.frame;
                let mut elastic = n * n.transpose();
                let mut missing = n * (law.normal_stiffness * kin.gap - history.traction[0]);
                if *status == PointStatus::Stick {
                    elastic = Matrix3::identity();
                    for (i, t) in [t_1, t_2].into_iter().enumerate() {
                        let slip = history.slip[i] - history.plastic_slip[i];
                        missing += t * (law.shear_stiffness * slip - history.traction[1 + i]);
                    }
                }
                found.push(Pressed {
                    point,
                    nodes: self.cells[self.candidates.range(f).start + cell],
                    weights: *kin.weights(),
                    frame: kin.frame,
                    area: self.points[point].area,
                    elastic,
                    missing,
                    softness,
                });
            }
        }
        found
    }

    /// Change of the shifted law's traction at a point when that of the last iterate is `settled` and not
    /// the present one [MPa].
    fn change_of(
        &self,
        model: &Model,
        state: &State,
        trial: &Trial,
        pressed: &Pressed,
        settled: [f64; 3],
    ) -> [f64; 3] {
        let (at, f) = (pressed.point, pressed.point / 4);
        let law = self.law(model, at);
        let slave = self.slave.corners(f, &trial.x);
        let (anchor, pair) = (trial.anchors[at], trial.pairs[at]);
        let Some((_, kin)) = self.see(at, &slave, anchor, pair, &trial.x) else {
            return [0.0; 3];
        };
        let old = self.carried(&state.interface[at], anchor, pair, &kin.frame, &trial.x);
        let present = trial.interface[at].traction;
        let respond = |traction: [f64; 3]| {
            let soft = Soft::of(state, trial);
            let shift = Shift {
                stiffness: self.shifted_stiffness(f, law, &traction, old.damage, soft),
                traction,
                bounding: traction[0],
            };
            law.update_shifted(total_gap(&kin, &old), &old, &shift)
                .traction
        };
        let after = respond(settled);
        let before = respond(present);
        [0, 1, 2].map(|i| after[i] - before[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two points that hang on the same node of a fixed master and miss `m` [MPa] across their face.
    fn pair(m: [f64; 2], softness: f64) -> Vec<Pressed> {
        let frame = [Vector3::x(), Vector3::y(), Vector3::z()];
        m.iter()
            .enumerate()
            .map(|(point, m)| Pressed {
                point,
                nodes: [0, 1, 2, 3, 4, 5, 6, 7],
                weights: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                frame,
                area: 2.0,
                elastic: frame[0] * frame[0].transpose(),
                missing: frame[0] * *m,
                softness,
            })
            .collect()
    }

    #[test]
    fn what_no_node_feels_is_settled_whole_and_what_they_feel_is_left() {
        assert_eq!(
            settling(&pair([0.3, -0.3], 0.01), &DofMap::of(8, &[], &[], &[])),
            [[0.3, 0.0, 0.0], [-0.3, 0.0, 0.0]]
        );
        // δt = m Λ/(BᵀA B + Λ)
        for change in settling(&pair([0.3, 0.3], 0.01), &DofMap::of(8, &[], &[], &[])) {
            assert!((change[0] - 0.3 * 0.01 / 1.01).abs() < 1e-12, "{change:?}");
        }
    }
}
