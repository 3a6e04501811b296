//! Direct update of traction patterns that nodes hardly feel (shifted penalty; theory/equilibrium.md, eq. 10).
//!
//! Four points of a facet carry more traction patterns than its nodes have displacements. Where curved faces have
//! slid on each other, their gaps contain such patterns, and the law demands t = k g for them. An iterate of the
//! shifted penalty reduces the error of these patterns by the part k'/k only, some thousandths, and nodal forces do
//! not show it. The patterns matter, because their pressure bounds the friction of sliding points.
//!
//! The error of an elastic point is m = k g − t. If every node is supported by springs of the numerical stiffness,
//! the change of tractions that removes the error is
//!
//! ```text
//! δt = m − B y,   (BᵀA B + Λ) y = BᵀA m
//! ```
//!
//! with the relative displacements B y of the points, their areas A, and Λ = k'/k times the diagonal of BᵀA B.
//! Patterns that nodes do not feel (BᵀA m = 0) change by all of m. The others change by no more than in an iterate.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use wythe_contact::{JointLaw, PointStatus, Shift};

use super::contact::{Contact, Soft, total_gap};
use super::{System, Trial};
use crate::assembly::DofMap;
use crate::model::Model;
use crate::state::State;

/// Largest number of conjugate gradient steps. BᵀA B is a mass matrix, and each step halves the residual.
const STEPS: usize = 60;
/// Accepted reduction of their residual, over the least k'/k. Parts that nodes feel are k/k' times as large in m as
/// in the tractions.
const FALL: f64 = 0.3;

/// Least k'/k for this update. With a stiffer penalty the patterns exceed the strengths, and no iteration finds
/// equilibrium with them.
const SOFTEST: f64 = 1e-3;

/// A point under pressure.
struct Pressed {
    /// Its index among all points.
    point: usize,
    nodes: [u32; 8],
    weights: [f64; 8],
    /// n, t₁, t₂.
    frame: [Vector3<f64>; 3],
    area: f64,
    /// Projector on the elastic directions: n, and all directions where the point sticks.
    elastic: Matrix3<f64>,
    /// Error m in these directions [MPa].
    missing: Vector3<f64>,
    /// k'/k.
    softness: f64,
}

impl Pressed {
    /// Movement of the slave relative to the master [mm] if nodes move by `y`. `[node]`
    fn relative(&self, y: &[Vector3<f64>]) -> Vector3<f64> {
        let nodes = self.nodes.iter().zip(&self.weights);
        nodes.fold(Vector3::zeros(), |sum, (&n, w)| sum + y[n as usize] * *w)
    }
}

impl System {
    /// Tractions of points with their patterns updated [MPa]. They are returned only if the update changes the work
    /// of sliding points by more than `most` [N mm] over the displacement `dq` of the increment [mm] `[slot]`.
    pub fn settled_tractions(
        &self,
        model: &Model,
        state: &State,
        trial: &Trial,
        dq: &[f64],
        most: f64,
    ) -> Option<Vec<(usize, [f64; 3])>> {
        let dissipated: f64 = trial.joints.energy.iter().map(|e| e[1]).sum();
        if dissipated.is_nan() || dissipated <= most {
            return None;
        }
        let mut way = vec![[0.0; 3]; trial.x.len()];
        self.dofs.spread(dq, &mut way);
        let way: Vec<_> = way.into_iter().map(Vector3::from).collect();
        let points = self.contact.pressed(model, trial);
        let changes = settling(&points, &self.dofs);
        let settle = |(pressed, change): (&Pressed, [f64; 3])| {
            // A traction beyond its bounds would be interpreted as an opening of the joint.
            let history = &trial.joints.history[pressed.point];
            let law = self.contact.law(model, pressed.point);
            let settled = [0, 1, 2].map(|i| history.traction[i] + change[i]);
            let settled = law.within_bounds(settled, history);
            let by = self
                .contact
                .change_of(model, state, trial, pressed, settled);
            let moved = pressed.relative(&way);
            let axes = by.iter().zip(&pressed.frame);
            let works = axes.map(|(by, axis)| pressed.area * by * axis.dot(&moved));
            (works.sum::<f64>(), (pressed.point, settled))
        };
        let settled = points
            .par_iter()
            .zip(changes)
            .with_min_len(TASK)
            .map(settle);
        let (works, changes): (Vec<f64>, Vec<_>) = settled.unzip();
        let work: f64 = works.iter().sum();
        (work.abs() > most).then_some(changes)
    }
}

/// Points and nodes of a task.
const TASK: usize = 512;

/// Connectivity of points and nodes.
struct Web {
    /// Nodes of each point. Nodes are indices in the ascending list of the points' nodes and the originals of
    /// images among them.
    at: Vec<[u32; 8]>,
    /// Start of each node's entries in `of`. `[node index + 1]`
    start: Vec<u32>,
    /// Points of each node, ascending, and the position of the node in the point.
    of: Vec<(u32, u8)>,
    images: Vec<Image>,
}

/// A node beyond a plane of symmetry and its original, as indices.
struct Image {
    node: usize,
    of: usize,
    sign: Vector3<f64>,
}

impl Web {
    fn new(points: &[Pressed], dofs: &DofMap) -> Self {
        let mut place = vec![u32::MAX; dofs.slot.len()];
        for &n in points.iter().flat_map(|p| &p.nodes) {
            place[n as usize] = 0;
        }
        for image in dofs.reflected() {
            if place[image.node as usize] == 0 {
                place[image.of as usize] = 0;
            }
        }
        let mut places = 0;
        for place in place.iter_mut().filter(|place| **place == 0) {
            *place = places;
            places += 1;
        }
        let at = points.iter().map(|p| p.nodes.map(|n| place[n as usize]));
        let at: Vec<[u32; 8]> = at.collect();
        let mut start = vec![0_u32; places as usize + 1];
        for &n in at.iter().flatten() {
            start[n as usize + 1] += 1;
        }
        for n in 0..places as usize {
            start[n + 1] += start[n];
        }
        let mut of = vec![(0, 0); 8 * points.len()];
        let mut next = start.clone();
        for (p, at) in (0..).zip(&at) {
            for (a, &n) in (0..).zip(at) {
                of[next[n as usize] as usize] = (p, a);
                next[n as usize] += 1;
            }
        }
        let images = dofs.reflected().iter().filter_map(|image| {
            let [node, of] = [image.node, image.of].map(|n| place[n as usize]);
            (node != u32::MAX).then(|| Image {
                node: node as usize,
                of: of as usize,
                sign: Vector3::from(image.sign),
            })
        });
        Self {
            images: images.collect(),
            at,
            start,
            of,
        }
    }

    /// Sum over the points of each node. `[node index]`
    fn sum<T>(&self, term: impl Fn(usize, usize) -> T + Sync, zero: T) -> Vec<T>
    where
        T: Copy + Send + Sync + std::ops::AddAssign,
    {
        let nodes = self.start.par_windows(2).with_min_len(TASK);
        nodes
            .map(|range| {
                let mut sum = zero;
                for &(p, a) in &self.of[range[0] as usize..range[1] as usize] {
                    sum += term(p as usize, usize::from(a));
                }
                sum
            })
            .collect()
    }

    /// Movement of each point's slave relative to its master [mm] if nodes move by `y` `[node index]`. `[point]`
    fn relative<'a>(
        &'a self,
        points: &'a [Pressed],
        y: &'a [Vector3<f64>],
    ) -> impl IndexedParallelIterator<Item = (&'a Pressed, Vector3<f64>)> {
        let all = points.par_iter().zip(&self.at).with_min_len(TASK);
        all.map(|(p, at)| {
            let nodes = at.iter().zip(&p.weights);
            let moved = nodes.fold(Vector3::zeros(), |sum, (&n, w)| sum + y[n as usize] * *w);
            (p, moved)
        })
    }

    /// Adds forces on images to their originals and clears them.
    fn fold(&self, f: &mut [Vector3<f64>]) {
        for image in &self.images {
            let own = std::mem::take(&mut f[image.node]);
            f[image.of] += own.component_mul(&image.sign);
        }
    }
}

/// δt of each point in its frame [MPa], by conjugate gradients preconditioned with the diagonal.
#[expect(
    clippy::too_many_lines,
    reason = "one conjugate gradient iteration, whose steps share its vectors"
)]
fn settling(points: &[Pressed], dofs: &DofMap) -> Vec<[f64; 3]> {
    let web = Web::new(points, dofs);
    let dot = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> f64 {
        a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
    };
    let missing = |p: usize, a: usize| {
        let p = &points[p];
        p.missing * (p.area * p.weights[a])
    };
    let own = |p: usize, a: usize| {
        let p = &points[p];
        p.area * p.weights[a] * p.weights[a] * (1.0 + p.softness)
    };
    let mut r = web.sum(missing, Vector3::zeros());
    let mut diagonal = web.sum(own, 0.0);
    web.fold(&mut r);
    for image in &web.images {
        diagonal[image.of] += std::mem::take(&mut diagonal[image.node]);
    }
    let scaled = |r: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
        let entries = r.iter().zip(&diagonal);
        entries
            .map(|(r, d)| if *d > 0.0 { r / *d } else { *r })
            .collect()
    };
    let mut y = vec![Vector3::zeros(); r.len()];
    let mut z = scaled(&r);
    let mut direction = z.clone();
    let mut size = dot(&r, &z);
    let softest = points
        .iter()
        .fold(1.0_f64, |least, p| least.min(p.softness));
    let enough = (FALL * softest).powi(2) * size;
    let mut force = vec![Vector3::zeros(); points.len()];
    for _ in 0..STEPS {
        if size.is_nan() || size <= enough {
            break;
        }
        // Images move with their originals.
        for image in &web.images {
            direction[image.node] = direction[image.of].component_mul(&image.sign);
        }
        let moved = web.relative(points, &direction);
        moved
            .map(|(p, moved)| p.elastic * moved * p.area)
            .collect_into_vec(&mut force);
        let pull = |p: usize, a: usize| {
            let (w, area, softness) = (points[p].weights[a], points[p].area, points[p].softness);
            let node = web.at[p][a] as usize;
            force[p] * w + direction[node] * (area * w * w * softness)
        };
        let mut pulled = web.sum(pull, Vector3::zeros());
        web.fold(&mut pulled);
        let step = size / dot(&direction, &pulled);
        for i in 0..y.len() {
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
    let moved = web.relative(points, &y);
    moved
        .map(|(p, moved)| {
            let change = p.missing - p.elastic * moved;
            p.frame.map(|axis| axis.dot(&change))
        })
        .collect()
}

impl Contact {
    /// Points under pressure on facets where at least one point slides.
    fn pressed(&self, model: &Model, trial: &Trial) -> Vec<Pressed> {
        let facets = trial.joints.status.par_chunks_exact(4).enumerate();
        facets
            .with_min_len(TASK / 4)
            .flat_map_iter(|(f, status)| self.pressed_of(model, trial, f, status))
            .collect()
    }

    /// Those of one facet whose points have this status.
    fn pressed_of(
        &self,
        model: &Model,
        trial: &Trial,
        f: usize,
        status: &[PointStatus],
    ) -> impl Iterator<Item = Pressed> {
        let [normal_stiffness, shear_stiffness] = self.law(model, 4 * f).stiffness();
        let softness = (self.numerical[f][0] / normal_stiffness).min(1.0);
        let counts = status.contains(&PointStatus::Slip) && softness >= SOFTEST;
        let slave = self.slave.corners(f, &trial.x);
        let press = |p: usize| {
            let point = 4 * f + p;
            let history = &trial.joints.history[point];
            if !counts || history.traction[0] >= 0.0 {
                return None;
            }
            let (anchor, pair) = (trial.joints.anchors[point], trial.joints.pairs[point]);
            let (cell, kin) = self.see(point, &slave, anchor, pair, &trial.x)?;
            let [n, t_1, t_2] = kin.frame;
            let mut elastic = n * n.transpose();
            let mut missing = n * (normal_stiffness * kin.gap - history.traction[0]);
            if status[p] == PointStatus::Stick {
                elastic = Matrix3::identity();
                for (i, t) in [t_1, t_2].into_iter().enumerate() {
                    let slip = history.slip[i] - history.plastic_slip[i];
                    missing += t * (shear_stiffness * slip - history.traction[1 + i]);
                }
            }
            Some(Pressed {
                point,
                nodes: self.cells[self.candidates.range(f).start + cell],
                weights: *kin.weights(),
                frame: kin.frame,
                area: self.points[point].area,
                elastic,
                missing,
                softness,
            })
        };
        [0, 1, 2, 3].map(press).into_iter().flatten()
    }

    /// Change of the traction from the shifted law at a point if the traction carried over is `settled` instead of
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
        let (anchor, pair) = (trial.joints.anchors[at], trial.joints.pairs[at]);
        let Some((_, kin)) = self.see(at, &slave, anchor, pair, &trial.x) else {
            return [0.0; 3];
        };
        let old = self.carried(&state.interface[at], anchor, pair, &kin.frame, &trial.x);
        let present = trial.joints.history[at].traction;
        let respond = |traction: [f64; 3]| {
            let soft = Soft::of(state, trial);
            let shift = Shift {
                stiffness: self.shifted_stiffness(f, law, &traction, &old, soft),
                traction,
                bounding: traction[0],
            };
            let opening = self.opening(at, kin.gap);
            law.update_shifted(total_gap(opening, &kin, &old), &old, &shift)
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

    /// Two points that depend on the same node, over a fixed master, with the normal errors `m` [MPa].
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
    fn patterns_without_nodal_force_settle_fully_and_others_hardly() {
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
