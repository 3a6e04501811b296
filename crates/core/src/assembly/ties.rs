//! Ties: forces, stiffness and energies of their segments (theory/ties.md).
//!
//! A segment joins two points x_a = Σ N_i x_i and x_b = Σ M_j x_j. With c = M − N at each of its nodes, d = x_b − x_a
//! = d₀ + Σ c u. Its force F along n = d/L loads the nodes by c F n, and has the stiffness c cᵀ (A E_t/L₀ n nᵀ + F/L
//! (I − n nᵀ)). A segment has 16 nodes at most; their coupling is divided into cells as that of springs.

use super::Trial;
use super::pattern::CELL;
use crate::model::Model;
use crate::model::ties::{TieLaw, TieStage};
use crate::state::{State, TieHistory};

/// Nodes of half a cell.
const HALF: usize = 4;
/// Strain up to which a tie that was installed without stress and shortened counts as taut in small motions: a
/// thousandth of a millimetre a metre, less than rods are straight.
const TAUT: f64 = 1e-6;

/// Segments of the ties of a model.
#[derive(Clone, Debug, Default)]
pub struct Ties {
    segments: Vec<Segment>,
    cells: Vec<[u32; 8]>,
    /// Segment of each cell, and its two groups of nodes.
    parts: Vec<(usize, [usize; 2])>,
    /// Number of ties.
    count: usize,
}

/// The straight part of a tie between two of its points.
#[derive(Clone, Debug)]
struct Segment {
    tie: usize,
    strand: usize,
    law: TieLaw,
    /// d₀ [mm].
    way: [f64; 3],
    /// L₀ [mm].
    length: f64,
    /// Nodes with their weights c.
    nodes: Vec<(u32, f64)>,
}

/// A segment at the positions of a trial.
#[derive(Clone, Copy, Debug, Default)]
pub struct TieResponse {
    /// History at the end of the increment.
    pub history: TieHistory,
    /// Force F [N].
    pub force: f64,
    /// Elastic energy [N mm].
    pub elastic: f64,
    /// Dissipation in the increment: plastic work, and the elastic energy of a segment that broke [N mm].
    pub dissipated: f64,
    /// Work of the jack in the increment [N mm].
    pub jacked: f64,
    /// Term of the trapezoidal rule in the increment: its work beyond that of the law [N mm].
    pub numerical: f64,
    /// Direction n.
    direction: [f64; 3],
    /// A E_t/L₀ and F/L [N/mm].
    stiffness: [f64; 2],
}

/// Force and stretch of a tie.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TieReading {
    /// Sum over its strands of the largest force in each [N].
    pub force: f64,
    /// Change of length of its strands, in the mean [mm].
    pub stretch: f64,
}

impl Ties {
    /// Prepares the ties of a model.
    pub fn new(model: &Model) -> Self {
        let mut ties = Self {
            count: model.ties.len(),
            ..Self::default()
        };
        for (t, tie) in model.ties.iter().enumerate() {
            for (k, strand) in tie.strands.iter().enumerate() {
                let share = tie.shares.get(k).copied().unwrap_or(1.0);
                let area = share * tie.law.area;
                for ends in strand.windows(2) {
                    let mut nodes: Vec<(u32, f64)> = Vec::new();
                    for (end, sign) in ends.iter().zip([-1.0, 1.0]) {
                        for (node, weight) in &end.nodes {
                            match nodes.iter_mut().find(|(n, _)| n == node) {
                                Some((_, c)) => *c += sign * weight,
                                None => nodes.push((*node, sign * weight)),
                            }
                        }
                    }
                    let way = [0, 1, 2].map(|d| ends[1].at[d] - ends[0].at[d]);
                    ties.add(Segment {
                        tie: t,
                        strand: k,
                        law: TieLaw { area, ..tie.law },
                        way,
                        length: size(way),
                        nodes,
                    });
                }
            }
        }
        ties
    }

    fn add(&mut self, segment: Segment) {
        let groups: Vec<&[(u32, f64)]> = segment.nodes.chunks(HALF).collect();
        for i in 0..groups.len() {
            for j in i..groups.len() {
                let mut cell = [groups[i][0].0; 8];
                for (half, group) in [i, j].into_iter().enumerate() {
                    for (a, (n, _)) in groups[group].iter().enumerate() {
                        cell[HALF * half + a] = *n;
                    }
                }
                self.cells.push(cell);
                self.parts.push((self.segments.len(), [i, j]));
            }
        }
        self.segments.push(segment);
    }

    /// Cells of eight nodes.
    pub fn cells(&self) -> &[[u32; 8]] {
        &self.cells
    }

    /// Nodes of each segment with their weights c, and its force along its direction [N].
    pub fn forces<'a>(
        &'a self,
        responses: &'a [TieResponse],
    ) -> impl Iterator<Item = (&'a [(u32, f64)], [f64; 3])> {
        let all = self.segments.iter().zip(responses);
        all.map(|(segment, response)| {
            let force = response.direction.map(|n| response.force * n);
            (&segment.nodes[..], force)
        })
    }

    /// Histories at rest. `[segment]`
    pub fn virgin(&self) -> Vec<TieHistory> {
        vec![TieHistory::default(); self.segments.len()]
    }

    /// Installs a tie in these histories without stress at nodal displacements `u` [mm], for small motions about a later
    /// state.
    pub(super) fn install(&self, tie: usize, u: &[[f64; 3]], histories: &mut [TieHistory]) {
        let segments = self.segments.iter().zip(histories);
        for (segment, history) in segments.filter(|(segment, _)| segment.tie == tie) {
            history.offset = 1.0 - size(segment.way_at(u)) / segment.length + TAUT;
        }
    }

    /// Evaluates all segments at the positions of the trial and adds their forces to those of the nodes.
    pub(super) fn evaluate(&self, state: &State, trial: &mut Trial) {
        trial.ties.segments.clear();
        for (segment, old) in self.segments.iter().zip(&state.ties) {
            let stage = (trial.ties.stages.get(segment.tie)).copied();
            let way = segment.way_at(&trial.displacement);
            let before = way_between(&trial.x_start, &segment.nodes);
            let response = segment.respond(stage.unwrap_or_default(), old, way, before);
            for (n, c) in &segment.nodes {
                for i in 0..3 {
                    trial.node_force[*n as usize][i] += c * response.force * response.direction[i];
                }
            }
            trial.ties.segments.push(response);
        }
    }

    /// Writes the stiffness of all cells [N/mm] `[cell][CELL]`. `secant`: compression does not reduce it, so that it is
    /// never negative.
    pub(super) fn write_stiffness(
        &self,
        responses: &[TieResponse],
        secant: bool,
        cells: &mut [f64],
    ) {
        cells.fill(0.0);
        for (cell, &(s, [i, j])) in cells.chunks_exact_mut(CELL).zip(&self.parts) {
            let (segment, response) = (&self.segments[s], &responses[s]);
            let group = |g: usize| segment.nodes.chunks(HALF).nth(g).unwrap_or_default();
            let tangent = response.tangent(secant);
            // A group with itself fills the first quarter of the cell, two groups the second and third.
            let column = if i == j { 0 } else { HALF };
            for (a, (_, first)) in group(i).iter().enumerate() {
                for (b, (_, second)) in group(j).iter().enumerate() {
                    let mut add = |a: usize, b: usize| {
                        for (entry, k) in cell[(a * 8 + b) * 9..][..9].iter_mut().zip(&tangent) {
                            *entry = first * second * k;
                        }
                    };
                    add(a, column + b);
                    if i != j {
                        add(column + b, a);
                    }
                }
            }
        }
    }

    /// ∂p/∂λ of the nodes where ties are stressed in proportion to the loads: adds c P n for final forces P [N].
    pub(super) fn add_jacking(
        &self,
        stages: &[TieStage],
        responses: &[TieResponse],
        force: &mut [[f64; 3]],
    ) {
        for (segment, response) in self.segments.iter().zip(responses) {
            let Some(TieStage::Stressed(full)) = stages.get(segment.tie) else {
                continue;
            };
            for (n, c) in &segment.nodes {
                for i in 0..3 {
                    force[*n as usize][i] += c * full * response.direction[i];
                }
            }
        }
    }

    /// Σ |F n·Δd| over the segments at nodal displacements Δu [N mm].
    pub(super) fn work_turned_over(&self, responses: &[TieResponse], du: &[[f64; 3]]) -> f64 {
        let segments = self.segments.iter().zip(responses);
        let work = |(segment, response): (&Segment, &TieResponse)| {
            let by = way_between(du, &segment.nodes);
            let along: f64 = (0..3).map(|i| response.direction[i] * by[i]).sum();
            (response.force * along).abs()
        };
        segments.map(work).sum()
    }

    /// Force and stretch of each tie at these histories. `[tie]`
    pub fn readings(&self, histories: &[TieHistory]) -> Vec<TieReading> {
        let mut readings = vec![TieReading::default(); self.count];
        let mut strands = vec![0.0; self.count];
        let mut last = None;
        let mut largest = f64::NEG_INFINITY;
        for (segment, history) in self.segments.iter().zip(histories) {
            let reading = &mut readings[segment.tie];
            reading.stretch += history.strain * segment.length;
            let force = segment.law.area * history.stress;
            if last == Some((segment.tie, segment.strand)) {
                // The largest force of the strand replaces the one counted so far.
                reading.force += (force - largest).max(0.0);
            } else {
                strands[segment.tie] += 1.0;
                reading.force += force;
                largest = f64::NEG_INFINITY;
            }
            largest = largest.max(force);
            last = Some((segment.tie, segment.strand));
        }
        for (reading, count) in readings.iter_mut().zip(strands) {
            reading.stretch /= f64::max(count, 1.0);
        }
        readings
    }
}

/// Σ c v of vectors at the nodes.
fn way_between(v: &[[f64; 3]], nodes: &[(u32, f64)]) -> [f64; 3] {
    [0, 1, 2].map(|d| {
        nodes
            .iter()
            .map(|(n, c)| c * v[*n as usize][d])
            .sum::<f64>()
    })
}

impl Segment {
    /// d at nodal displacements `u` [mm].
    fn way_at(&self, u: &[[f64; 3]]) -> [f64; 3] {
        let by = way_between(u, &self.nodes);
        [0, 1, 2].map(|d| self.way[d] + by[d])
    }

    /// The segment with its points `way` apart, `before` at the last commit [mm].
    fn respond(
        &self,
        stage: TieStage,
        old: &TieHistory,
        way: [f64; 3],
        before: [f64; 3],
    ) -> TieResponse {
        let law = &self.law;
        let (length, volume) = (size(way), law.area * self.length);
        let strain = length / self.length - 1.0;
        let mut new = TieHistory { strain, ..*old };
        let mut modulus = 0.0;
        match stage {
            TieStage::Absent => new.offset = -strain,
            TieStage::Stressed(force) => {
                new.stress = force / law.area;
                new.offset = new.stress / law.E + old.plastic_strain - strain;
            }
            TieStage::Fixed if old.is_broken => new.stress = 0.0,
            TieStage::Fixed => {
                let total = strain + old.offset;
                modulus = law.update(total, &mut new);
                new.is_broken = total > law.rupture;
            }
        }
        let stored = |stress: f64| 0.5 * stress * stress / law.E * volume;
        let (elastic, stored_before) = (stored(new.stress), stored(old.stress));
        let mean = 0.5 * (old.stress + new.stress);
        let broke = stage == TieStage::Fixed && old.is_broken;
        let dissipated = if broke {
            stored_before
        } else {
            mean * volume * (new.plastic_strain - old.plastic_strain)
        };
        let jacked = mean * volume * (new.offset - old.offset);
        let along = |stress: f64, way: [f64; 3]| {
            let size = size(way).max(f64::MIN_POSITIVE);
            way.map(|w| law.area * stress * w / size)
        };
        let (first, second) = (along(old.stress, before), along(new.stress, way));
        let work: f64 = (0..3)
            .map(|i| 0.5 * (first[i] + second[i]) * (way[i] - before[i]))
            .sum();
        TieResponse {
            history: new,
            force: law.area * new.stress,
            elastic,
            dissipated,
            jacked,
            numerical: work + jacked - (elastic - stored_before) - dissipated,
            direction: way.map(|w| w / length.max(f64::MIN_POSITIVE)),
            stiffness: [
                law.area * modulus / self.length,
                law.area * new.stress / length.max(f64::MIN_POSITIVE),
            ],
        }
    }
}

impl TieLaw {
    /// Stress of a strain, that of the prestress included, from the history in `history`, which becomes the new one.
    /// Returns the slope [MPa].
    fn update(&self, strain: f64, history: &mut TieHistory) -> f64 {
        let trial = self.E * (strain - history.plastic_strain);
        if trial < 0.0 && !self.compression {
            history.stress = 0.0;
            return 0.0;
        }
        let beyond = trial.abs() - (self.f_y + self.hardening * history.yielded);
        // An infinite yield stress leaves −∞.
        if beyond <= 0.0 {
            history.stress = trial;
            return self.E;
        }
        let flow = beyond / (self.E + self.hardening);
        history.yielded += flow;
        history.plastic_strain += flow * trial.signum();
        history.stress = self.E * (strain - history.plastic_strain);
        self.E * self.hardening / (self.E + self.hardening)
    }
}

impl TieResponse {
    /// A E_t/L₀ n nᵀ + F/L (I − n nᵀ), by rows [N/mm].
    fn tangent(&self, secant: bool) -> [f64; 9] {
        let [along, across] = self.stiffness;
        let across = if secant { across.max(0.0) } else { across };
        let n = self.direction;
        std::array::from_fn(|k| {
            let (i, j) = (k / 3, k % 3);
            let own = if i == j { across } else { 0.0 };
            own + (along - across) * n[i] * n[j]
        })
    }
}

fn size(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}
