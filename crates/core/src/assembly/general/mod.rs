//! General contact of any two bodies at any place (theory/contact.md).
//!
//! Two bodies with plane faces touch where a corner of one lies on a face of the other, or where two edges cross.
//! Bodies that lie flat on each other touch at the corners of the common area, which are such places. Each place is
//! a [`Touch`] with the history of its own dry law. It begins where the relative path passes through the face,
//! follows the sliding, and ends where the corner or edge leaves. A cell of the matrix is a pair of facets, as in
//! planned contact.

mod broad;
mod corners;
mod edges;
mod faces;
mod forces;
mod live;

use std::collections::{HashMap, HashSet};

use crate::state::{Kind, Touch};
use nalgebra::Vector3;
use rayon::prelude::*;
use wythe_contact::{CohesiveFrictional, Part, corner_points};

use super::{Contact, Mass, Trial};
use crate::model::Model;
use crate::model::general::GeneralContact;
use crate::state::State;
use broad::Nearby;
use corners::Watch;
use faces::Faces;
pub use live::Live;

/// Gap up to which a possible touch has a place in the matrix, over the shortest side of the facets.
const NEAR: f64 = 0.06;
/// Depth behind a face, over the same side, up to which a corner counts as lying on the face. Coordinates of decks
/// are rounded, and faces that are flush with the face of a pressed body lie slightly behind it.
const FLUSH: f64 = 1e-3;
/// Depth, over the same side, up to which a corner or edge found inside a body without a touch is held where it is.
/// It can get there only by an error, and must not pass through the body.
const LOST: f64 = 0.1;
/// How far beyond the rim of its facet a corner still belongs to it, over half a facet [-].
const STAY: f64 = 1e-3;

/// Surfaces of all bodies and their neighbourhood.
#[derive(Clone, Debug, Default)]
pub struct General {
    of: Option<GeneralContact>,
    faces: Faces,
    /// Weights of points slightly inwards of a facet's corners. `[corner][corner]`
    weights: [[f64; 4]; 4],
    /// Slave facets of planned contact among the boundary facets. `[slave facet]`
    planned: Vec<Option<Planned>>,
    /// Neighbouring corners, facets and edges.
    nearby: Nearby,
    /// Touches at the last commit.
    start: Vec<Touch>,
    /// Depth of the deepest touch of each body [mm]. `[body]`
    depth: Vec<f64>,
    /// Pairs (facet, body): planned contact holds the facet on the body with all its points.
    held: HashSet<(u32, u32)>,
    /// Pairs (node, body): planned contact holds the node on the body with a point beside it. Depth of these points
    /// [mm].
    held_nodes: HashMap<(u32, u32), f64>,
    /// Corners that may reach facets in this increment, sorted by node.
    watch: Vec<Watch>,
    /// Whether `watch` belongs to this increment and these neighbours.
    watched: bool,
    /// Pairs of facets between which forces may act, ascending.
    cells: Vec<[u32; 2]>,
    cell_nodes: Vec<[u32; 8]>,
}

impl General {
    /// Prepares the boundary facets of a model. Empty for a model without general contact.
    pub fn new(model: &Model, mass: &Mass) -> Self {
        let Some(of) = &model.contact.general else {
            return Self::default();
        };
        let faces = Faces::new(model, &of.skin, mass);
        let unit = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        Self {
            nearby: Nearby::new(&faces.size),
            planned: planned_facets(model, of),
            weights: corner_points(&unit, &Part::WHOLE).map(|p| p.weights),
            depth: vec![0.0; faces.surface.body.last().map_or(0, |b| *b as usize + 1)],
            of: Some(of.clone()),
            faces,
            ..Self::default()
        }
    }

    /// True where the model has no general contact. All other functions then do nothing.
    pub fn is_absent(&self) -> bool {
        self.of.is_none()
    }

    /// Contact cells: nodes of a facet of one body and of a facet of another.
    pub fn cells(&self) -> &[[u32; 8]] {
        &self.cell_nodes
    }

    /// Pairs of facets of these cells.
    pub(super) fn pairs(&self) -> &[[u32; 2]] {
        &self.cells
    }

    fn facets_at(&self, node: u32) -> &[u32] {
        self.faces.at(node)
    }

    fn normal(&self, facet: u32, x: &[[f64; 3]]) -> Vector3<f64> {
        crate::model::general::normal(&self.faces.surface.corners(facet as usize, x))
    }

    fn body(&self, facet: u32) -> u32 {
        self.faces.surface.body[facet as usize]
    }

    /// Depth up to which two bodies count as flush, with facets of shortest side `size` [mm] (theory/contact.md,
    /// eq. 14).
    fn flush(&self, size: f64, bodies: [u32; 2]) -> f64 {
        let depth = bodies.map(|b| self.depth[b as usize]);
        FLUSH * size + 2.0 * depth[0].max(depth[1])
    }

    /// Begins an increment from the committed state, whose positions are `x` [mm] `[node]`.
    pub fn begin(&mut self, contact: &Contact, state: &State) {
        if self.is_absent() {
            return;
        }
        self.watched = false;
        self.start.clone_from(&state.touches);
        self.depth.fill(0.0);
        for touch in &state.touches {
            let deep = -(touch.history.opening + touch.offset).min(0.0);
            for f in touch.facets {
                let depth = &mut self.depth[self.faces.surface.body[f as usize] as usize];
                *depth = depth.max(deep);
            }
        }
        self.note_planned(contact, state);
        self.cells.clear();
    }

    /// Records the places held by planned contact. General contact leaves them alone.
    fn note_planned(&mut self, contact: &Contact, state: &State) {
        self.held.clear();
        self.held_nodes.clear();
        // Number of parts of each facet that a body holds with all their points.
        let mut held: HashMap<(u32, u32), u32> = HashMap::new();
        for (slave, planned) in self.planned.iter().enumerate() {
            let Some(planned) = planned else { continue };
            let bodies: [Option<u32>; 4] =
                [0, 1, 2, 3].map(|p| contact.faced_body(&state.pairs[4 * slave + p]));
            let points = &state.interface[4 * slave..4 * slave + 4];
            let depth = points.iter().fold(0.0, |d: f64, p| d.max(-p.opening));
            for (p, body) in bodies.iter().enumerate() {
                let Some(body) = *body else { continue };
                if planned.part.reaches(p) {
                    let node = contact.slave.facets[slave][p];
                    let deepest = self.held_nodes.entry((node, body)).or_default();
                    *deepest = depth.max(*deepest);
                }
            }
            if let Some(body) = bodies[0].filter(|body| bodies == [Some(*body); 4]) {
                let entries = held.entry((planned.facet, body)).or_default();
                *entries += 1;
                if *entries == planned.entries {
                    self.held.insert((planned.facet, body));
                }
            }
        }
    }

    /// Finds the touches at the positions of `trial`, from those at the last commit.
    pub fn search(&mut self, trial: &mut Trial) {
        if self.is_absent() || trial.x_start.is_empty() {
            return;
        }
        let (x0, x) = (&trial.x_start, &trial.x);
        if !self.nearby.holds(x0, x) {
            let mut nearby = std::mem::take(&mut self.nearby);
            nearby.search(self, x0, x);
            self.nearby = nearby;
            self.watched = false;
        }
        if !self.watched {
            self.watch = self.watch(x0);
            self.watched = true;
        }
        let before = std::mem::take(&mut trial.general.touches);
        let (mut live, lost) = self.follow(x0, x);
        let corners = self.new_corners(&live, &before, x0, x);
        let edges = self.new_edges(&live, &before, x0, x);
        live.extend(corners);
        live.extend(edges);
        live.sort_by_key(Live::key);
        for one in &mut live {
            if let Ok(i) = before.binary_search_by_key(&one.key(), Live::key) {
                one.go_on_from(&before[i]);
            }
            one.weigh(self);
        }
        trial.general.loss = lost;
        self.add_cells(live.iter().map(|one| one.cell));
        trial.general.touches = live;
    }

    /// Touches of the last commit that continue. For the others, the sums over them of [`Self::parted`] [N mm].
    fn follow(&self, x0: &[[f64; 3]], x: &[[f64; 3]]) -> (Vec<Live>, [f64; 2]) {
        let followed: Vec<Option<Live>> = (self.start.par_iter())
            .map(|touch| match touch.kind {
                Kind::Corner => self.follow_corner(touch, x),
                Kind::Edges => self.follow_edges(touch, x),
            })
            .collect();
        let mut lost = [0.0; 2];
        for (touch, still) in self.start.iter().zip(&followed) {
            if still.is_none() {
                let [freed, work] = self.parted(touch, x0, x);
                lost[0] += freed;
                lost[1] += work;
            }
        }
        (followed.into_iter().flatten().collect(), lost)
    }

    /// Energy released by a touch that ended, and the work by the trapezoidal rule of the forces that it had when
    /// the increment began [N mm].
    fn parted(&self, touch: &Touch, x0: &[[f64; 3]], x: &[[f64; 3]]) -> [f64; 2] {
        let freed = self.law(touch.facets).free_energy(&touch.history) * touch.area;
        let Some(sight) = Live::followed(touch, touch.second, touch.at).see(self, x0) else {
            return [freed, 0.0];
        };
        let way = self.way(touch.facets, [x0, x]);
        let moved = sight.moved(&way);
        let work: f64 = (0..3)
            .map(|i| touch.history.traction[i] * sight.frame[i].dot(&moved))
            .sum();
        [freed, 0.5 * work * touch.area]
    }

    /// Law between two facets.
    fn law(&self, [a, b]: [u32; 2]) -> CohesiveFrictional {
        let none = || CohesiveFrictional::dry(0.0, 0.0, 0.0);
        self.of.as_ref().map_or_else(none, |of| of.law(a, b))
    }

    /// Adds cells that do not exist yet.
    fn add_cells(&mut self, wanted: impl Iterator<Item = [u32; 2]>) {
        let before = self.cells.len();
        let mut cells = std::mem::take(&mut self.cells);
        cells.extend(wanted);
        cells.sort_unstable();
        cells.dedup();
        if cells.len() != before || cells.len() != self.cell_nodes.len() || before == 0 {
            self.cell_nodes.clear();
            self.cell_nodes.extend(cells.iter().map(|pair| {
                let [a, b] = pair.map(|f| self.faces.surface.facets[f as usize]);
                [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]]
            }));
        }
        self.cells = cells;
    }
}

/// A slave facet of planned contact, or a part of one.
#[derive(Clone, Copy, Debug)]
struct Planned {
    /// Its boundary facet.
    facet: u32,
    part: Part,
    /// Number of parts of this facet among the slaves.
    entries: u32,
}

/// Slave facets of planned contact among the boundary facets. `[slave facet]`
fn planned_facets(model: &Model, of: &GeneralContact) -> Vec<Option<Planned>> {
    let sorted = |facet: &[u32; 4]| {
        let mut key = *facet;
        key.sort_unstable();
        key
    };
    let known: HashMap<[u32; 4], u32> = (of.skin.facets.iter())
        .enumerate()
        .map(|(f, facet)| (sorted(facet), f as u32))
        .collect();
    let slaves = model.contact.slave_facets.iter().enumerate();
    slaves
        .map(|(f, nodes)| {
            let facet = *known.get(&sorted(nodes))?;
            let part = model.contact.part(f);
            let [xi, eta] = part.half.map(|half| (1.0 / half).round() as u32);
            Some(Planned {
                facet,
                part,
                entries: xi * eta,
            })
        })
        .collect()
}
