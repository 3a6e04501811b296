//! Touches of general contact within an increment.

use nalgebra::{Matrix3, Vector3};
use wythe_contact::{
    Anchor, CohesiveFrictional, EdgePair, Entry, InterfaceHistory, Kinematics, PointStatus,
    frame_at, surface, to_frame,
};

use super::General;
use crate::state::{Kind, Touch};

/// Beginning of a new touch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// Gap when the increment began [mm].
    pub(super) gap: f64,
    /// Entry of the relative path into contact.
    pub(super) entry: Entry,
}

/// A touch, or a pair close to touching, in an iterate.
#[expect(
    clippy::struct_excessive_bools,
    reason = "four independent facts, none of which follows from others"
)]
#[derive(Clone, Debug)]
// More than 15 fields: one record of a touch through an increment.
pub struct Live {
    /// Touch as it would be committed.
    pub touch: Touch,
    /// History when the increment began, in the frame at the start of the slip.
    pub old: InterfaceHistory,
    /// Facet and parameters at which the slip of this increment begins.
    pub(super) anchor: (u32, [f64; 2]),
    /// Key at the last commit, or key of a new touch.
    pub(super) key: (Kind, u32, u32),
    /// Whether the touch is new in this increment.
    pub(super) fresh: bool,
    /// Work by the trapezoidal rule of its forces on the way before the bodies met [N mm].
    pub(super) approach: f64,
    /// Whether the bodies have met here. Otherwise they are only close.
    pub(super) claims: bool,
    /// Pair of facets of its cell, ascending.
    pub(super) cell: [u32; 2],
    /// Law of the touch.
    pub(super) law: CohesiveFrictional,
    /// Elastic stiffness of the bodies behind it, normal and shear [N/mm³].
    pub(super) numerical: [f64; 2],
    /// Mass that moves with the gap, over the contact area [tonne/mm²].
    pub(super) areal_mass: f64,
    /// Traction of the last iterate [MPa].
    pub(super) last: [f64; 3],
    /// Normal traction that bounds the shear, and its last change [MPa].
    pub(super) bounding: f64,
    pub(super) swing: f64,
    /// Status in this iterate and in the last one.
    pub status: PointStatus,
    pub(super) status_before: PointStatus,
    /// Whether `last` is the traction of the last iterate.
    pub(in crate::assembly) settled: bool,
    /// Whether its slip has reversed between iterates.
    pub(super) turns: bool,
    /// Elastic energy and dissipation [N mm].
    pub energy: [f64; 2],
}

/// Status of a touch that has this history.
fn open(history: &InterfaceHistory) -> PointStatus {
    if history.traction[0] < 0.0 {
        PointStatus::Stick
    } else {
        PointStatus::Open
    }
}

/// Kinematics of a touch.
pub(super) struct Sight {
    pub(super) at: [f64; 2],
    pub(super) gap: f64,
    pub(super) slip: [f64; 2],
    pub(super) frame: [Vector3<f64>; 3],
    /// Weights of the nodes of its two facets.
    pub(super) weights: [f64; 8],
    /// Kinematics with derivatives for the exact stiffness, for corners only.
    pub(super) exact: Option<Kinematics>,
}

impl Sight {
    /// Relative motion of the two bodies at the touch if the nodes of the two facets move by `way` [mm].
    pub(super) fn moved(&self, way: &[[f64; 3]; 8]) -> Vector3<f64> {
        let nodes = self.weights.iter().zip(way);
        nodes.fold(Vector3::zeros(), |sum, (w, u)| sum + Vector3::from(*u) * *w)
    }
}

impl Live {
    fn new(touch: Touch, anchor: (u32, [f64; 2])) -> Self {
        let [a, b] = touch.facets;
        let traction = touch.history.traction;
        Self {
            old: touch.history,
            anchor,
            key: touch.key(),
            fresh: false,
            approach: 0.0,
            claims: true,
            cell: [a.min(b), a.max(b)],
            law: CohesiveFrictional::dry(0.0, 0.0, 0.0),
            numerical: [0.0; 2],
            areal_mass: 0.0,
            last: traction,
            bounding: traction[0],
            swing: 0.0,
            settled: true,
            turns: false,
            status: open(&touch.history),
            status_before: open(&touch.history),
            energy: [0.0; 2],
            touch,
        }
    }

    /// A touch of the last commit that is now at `at` on `second`.
    pub(super) fn followed(touch: &Touch, second: u32, at: [f64; 2]) -> Self {
        let anchor = (touch.second, touch.at);
        let mut one = Self::new(touch.clone(), anchor);
        one.touch.at = at;
        one.touch.second = second;
        if touch.kind == Kind::Corner {
            one.touch.facets[1] = second;
            let [a, b] = one.touch.facets;
            one.cell = [a.min(b), a.max(b)];
        }
        one
    }

    /// A new touch.
    pub(super) fn met(
        (kind, first, second): (Kind, u32, u32),
        facets: [u32; 2],
        at: [f64; 2],
        start: Start,
        area: f64,
    ) -> Self {
        let offset = start.entry.gap.min(0.0);
        let history = InterfaceHistory {
            damage: 1.0,
            opening: start.gap - offset,
            ..InterfaceHistory::default()
        };
        let touch = Touch {
            kind,
            first,
            second,
            facets,
            at,
            area,
            offset,
            history,
        };
        Self {
            fresh: true,
            ..Self::new(touch, (second, start.entry.at))
        }
    }

    pub(super) fn key(&self) -> (Kind, u32, u32) {
        self.key
    }

    /// Begins where an earlier iterate found it.
    pub(super) fn keep_start(&mut self, earlier: &Self) {
        self.anchor = earlier.anchor;
        self.old = earlier.old;
        self.touch.offset = earlier.touch.offset;
    }

    /// Whether it is open in this iterate.
    pub(in crate::assembly) fn is_open(&self) -> bool {
        self.status == PointStatus::Open
    }

    /// Takes over the iteration data of the same touch in an earlier iterate.
    pub(super) fn go_on_from(&mut self, earlier: &Self) {
        self.last = earlier.last;
        self.bounding = earlier.bounding;
        self.swing = earlier.swing;
        self.status = earlier.status;
        (self.settled, self.turns) = (earlier.settled, earlier.turns);
        self.status_before = earlier.status_before;
    }

    /// Takes the traction of the last iterate as bound of the shear of the next one.
    pub(in crate::assembly) fn bound_by_traction(&mut self) {
        (self.bounding, self.swing) = (self.last[0], 0.0);
    }

    /// Takes over the traction of this iterate, like planned contact. Returns whether the status is unchanged.
    pub(in crate::assembly) fn keep_traction(&mut self) -> bool {
        let traction = self.touch.history.traction;
        let was_open = self.status_before == PointStatus::Open;
        let is_open = self.status == PointStatus::Open;
        // If bodies have just met, a line search along free flight gives a traction that would stop a whole body at
        // one place. Tractions are carried over only after the iterates have settled on the soft stiffness here.
        self.settled = is_open || !was_open;
        if self.settled {
            let [_, s, t] = self.last;
            self.turns |= traction[1] * s + traction[2] * t < 0.0;
            self.last = traction;
        }
        let change = traction[0] - self.bounding;
        let part = if change * self.swing < 0.0 { 0.5 } else { 1.0 };
        self.bounding += part * change;
        self.swing = change;
        let steady = self.status == self.status_before;
        self.status_before = self.status;
        steady
    }

    /// Sets the law, the numerical stiffness and the mass behind the touch.
    pub(super) fn weigh(&mut self, of: &General) {
        let [a, b] = self.touch.facets;
        self.law = of.law(self.touch.facets);
        if let Some(general) = &of.of {
            let [k, l] = [a, b].map(|f| general.elastic[f as usize]);
            self.numerical = if l[0] < k[0] { l } else { k };
        }
        let inverse: f64 = match self.touch.kind {
            Kind::Corner => {
                let own = of.faces.inverse_mass[self.touch.first as usize];
                let weights = surface::weights_at(self.touch.at);
                let nodes = of.faces.surface.facets[b as usize];
                let others = nodes.iter().zip(weights);
                own + others
                    .map(|(&n, w)| w * w * of.faces.inverse_mass[n as usize])
                    .sum::<f64>()
            }
            Kind::Edges => [self.touch.first, self.touch.second]
                .iter()
                .zip(self.touch.at)
                .map(|(&e, s)| {
                    let [p, q] = of.sharp(e).nodes.map(|n| of.faces.inverse_mass[n as usize]);
                    (1.0 - s) * (1.0 - s) * p + s * s * q
                })
                .sum(),
        };
        self.areal_mass = if inverse > 0.0 {
            1.0 / (inverse * self.touch.area)
        } else {
            0.0
        };
    }

    /// Gap and slip at positions `x` [mm] `[node]`.
    pub(super) fn see(&self, of: &General, x: &[[f64; 3]]) -> Option<Sight> {
        match self.touch.kind {
            Kind::Corner => self.see_corner(of, x),
            Kind::Edges => self.see_edges(of, x),
        }
    }

    fn see_corner(&self, of: &General, x: &[[f64; 3]]) -> Option<Sight> {
        let Touch {
            first,
            second,
            facets,
            at,
            ..
        } = self.touch;
        let surface = &of.faces.surface;
        let slave = surface.corners(facets[0] as usize, x);
        let master = surface.corners(facets[1] as usize, x);
        let corner = (surface.facets[facets[0] as usize].iter()).position(|&n| n == first)?;
        let (from, xi) = self.anchor;
        let anchor = if from == second {
            Anchor::Same(xi)
        } else {
            let corners = surface.corners(from as usize, x);
            Anchor::At(surface::point_at(&corners, xi).into())
        };
        let kin = Kinematics::new(&slave, &of.weights[corner], &master, at, anchor)?;
        Some(Sight {
            at: kin.xi,
            gap: kin.gap,
            slip: kin.slip,
            frame: kin.frame,
            weights: *kin.weights(),
            exact: Some(kin),
        })
    }

    fn see_edges(&self, of: &General, x: &[[f64; 3]]) -> Option<Sight> {
        let Touch {
            first,
            second,
            facets,
            ..
        } = self.touch;
        let (a, b) = (of.ends(first, x), of.ends(second, x));
        let pair = EdgePair::new(&a, &b, &of.outwards(second, x), self.anchor.1)?;
        let mut weights = [0.0; 8];
        let [s, t] = pair.at;
        let parts = [
            (first, facets[0], 0, s, 1.0),
            (second, facets[1], 4, t, -1.0),
        ];
        for (edge, facet, from, s, sign) in parts {
            let [p, q] = of.sharp(edge).nodes;
            for (a, &n) in of.faces.surface.facets[facet as usize].iter().enumerate() {
                if n == p {
                    weights[from + a] = sign * (1.0 - s);
                } else if n == q {
                    weights[from + a] = sign * s;
                }
            }
        }
        Some(Sight {
            at: pair.at,
            gap: pair.gap,
            slip: pair.slip,
            frame: pair.frame,
            weights,
            exact: None,
        })
    }

    /// History at the start, with its tangential components in the frame of the present facet.
    pub(super) fn carried(
        &self,
        of: &General,
        frame: &[Vector3<f64>; 3],
        x: &[[f64; 3]],
    ) -> InterfaceHistory {
        let (from, xi) = self.anchor;
        let old = &self.old;
        if self.touch.kind == Kind::Edges || from == self.touch.second {
            return *old;
        }
        let there = frame_at(&of.faces.surface.corners(from as usize, x), xi);
        let shear = to_frame([old.traction[1], old.traction[2]], &there, frame);
        InterfaceHistory {
            slip: to_frame(old.slip, &there, frame),
            plastic_slip: to_frame(old.plastic_slip, &there, frame),
            traction: [old.traction[0], shear[0], shear[1]],
            ..*old
        }
    }

    /// Touch after a commit. None if the bodies are apart.
    pub(super) fn committed(&self) -> Option<Touch> {
        let mut touch = self.touch.clone();
        let gap = touch.history.opening + touch.offset;
        let pressed = touch.history.traction[0] < 0.0;
        if !pressed && gap >= 0.0 {
            return None;
        }
        if !pressed {
            // A body that comes out again meets the other where it is.
            touch.offset = gap;
            touch.history.opening = 0.0;
        }
        Some(touch)
    }

    /// Records the term of the trapezoidal rule for the way before the bodies met: their forces at the end of the
    /// increment act on that way, too (theory/contact.md, eq. 19). `sight` and `traction` are present values, `way`
    /// is the movement of the nodes of both facets.
    pub(super) fn note_approach(
        &mut self,
        sight: &Sight,
        traction: &[f64; 3],
        way: &[[f64; 3]; 8],
    ) {
        if !self.fresh {
            return;
        }
        let moved = sight.moved(way);
        let since = [sight.gap - self.touch.offset, sight.slip[0], sight.slip[1]];
        let work: f64 = (0..3)
            .map(|i| traction[i] * (sight.frame[i].dot(&moved) - since[i]))
            .sum();
        self.approach = 0.5 * work * self.touch.area;
    }

    /// Term of the trapezoidal rule for bodies that meet or part [N mm].
    pub(super) fn crossing_work(&self) -> f64 {
        if self.fresh {
            return self.approach;
        }
        self.law.crossing_work(&self.old, &self.touch.history) * self.touch.area
    }

    /// Position in the cell of local node `a` of the two facets.
    pub(super) fn place(&self, a: usize) -> usize {
        if self.touch.facets[0] == self.cell[0] {
            a
        } else {
            (a + 4) % 8
        }
    }

    /// Weights in the node order of the cell.
    pub(super) fn in_cell(&self, weights: &[f64; 8]) -> [f64; 8] {
        let mut placed = [0.0; 8];
        for (a, w) in weights.iter().enumerate() {
            placed[self.place(a)] = *w;
        }
        placed
    }

    /// Adds the exact stiffness of slave and master nodes to the cell. `[a][b][i][j]`
    pub(super) fn add_exact(
        &self,
        kin: &Kinematics,
        traction: &[f64; 3],
        tangent: &Matrix3<f64>,
        cell: &mut [f64],
    ) {
        let mut own = vec![0.0; cell.len()];
        kin.add_exact_stiffness(traction, tangent, self.touch.area, &mut own);
        for a in 0..8 {
            for b in 0..8 {
                let to = (self.place(a) * 8 + self.place(b)) * 9;
                let from = (a * 8 + b) * 9;
                for k in 0..9 {
                    cell[to + k] += own[from + k];
                }
            }
        }
    }
}
