//! Assembly of the equations of a model: unknowns, matrix pattern, forces and stiffness of solids, joints,
//! springs, ties and loads.

mod branch_holding;
pub mod bulk;
pub mod contact;
mod damping;
mod dissipation;
pub mod dofs;
mod external_loads;
mod general;
mod increment_work;
mod mass;
mod matrix;
mod numerical_stiffness;
pub mod pattern;
mod rigid;
mod sections;
mod small_motion;
mod solid;
mod springs;
mod steered;
mod stiffness_reuse;
mod ties;
mod traction_patterns;
mod trial;

pub use bulk::{Bulk, Solids};
pub use contact::Contact;
pub use damping::StiffnessDamping;
pub use dofs::{DofMap, Equations};
pub use external_loads::ExternalLoads;
pub use general::{General, Live};
pub use increment_work::{PARTS, Works};
pub use mass::Mass;
pub use pattern::Gather;
pub use rigid::RigidBodies;
pub use sections::Cut;
pub use small_motion::PointMotion;
pub use springs::Springs;
pub use steered::Steered;
pub use ties::{TieReading, TieResponse, Ties};
pub use trial::{
    Awake, STIFFEST_UNDER_LOADS, Trial, TrialCells, TrialJoints, TrialShift, TrialSolids,
    TrialTies, TrialTouches,
};

use crate::linear::Analysis;
use crate::material::{LocalFailure, MaterialHistory};
use crate::model::Model;
use crate::model::scene::Fidelity;
use crate::model::ties::TieStage;
use crate::state::{Poses, State};
use pattern::CELL;
use wythe_contact::PointPair;

/// Settings of one evaluation of forces and stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// Size of the increment in step time [s].
    pub dt: f64,
    /// Treatment of the solids.
    pub solids: Solids,
    /// True: joints iterate with the shifted penalty. False: their law is applied directly.
    pub shifted: bool,
    /// Whether stiffness is written as well.
    pub tangent: bool,
    /// Part of the stiffness of follower pressures that is written.
    pub turning: Turning,
}

/// Treatment in the matrix of follower pressures, whose direction turns with their facets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turning {
    /// Their stiffness is left out.
    #[default]
    Ignored,
    /// Their full stiffness, which is unsymmetric.
    Exact,
}

/// All parts of a model that are prepared once and evaluated in every iterate.
// More than 15 fields: the parts of a model, the matrix of the step and its analysis.
pub struct System {
    /// Unknowns.
    pub dofs: DofMap,
    /// Solid elements.
    pub bulk: Bulk,
    /// Joints: planned contact.
    pub contact: Contact,
    /// General contact.
    pub general: General,
    /// Masses.
    pub mass: Mass,
    /// Springs to the ground.
    pub springs: Springs,
    /// Ties.
    pub ties: Ties,
    /// Rigid bodies.
    pub rigid: RigidBodies,
    /// Named loads.
    pub outside: ExternalLoads,
    /// Sections.
    pub cuts: Vec<Cut>,
    /// Stiffness along the displacement that controls the load, in steps with such a displacement.
    pub steered: Option<Steered>,
    /// Nodal force that the rounding of positions can cause [N]. Forces below a small multiple of it count as
    /// zero.
    pub rounding_force: f64,
    gather: Option<Gather>,
    /// Masses that couple the nodes of elements, once a step with inertia needed them. `[entry]`
    couplings: std::sync::OnceLock<Vec<f64>>,
    /// Symbolic analysis of the last matrix. The next step and the check of symmetry often have the same
    /// pattern.
    analysis: Option<Analysis>,
    analysed_version: usize,
    analysed_pairs: Vec<[u32; 2]>,
}

impl Evaluation {
    /// Whether stiffness written at `poses` may be reused. The matrix must be symmetric and used by iterates
    /// only. Named loads exclude reuse because the numerical stiffness of the points grows under them.
    fn keeps(&self, poses: &Poses, trial: &Trial) -> bool {
        let secant = matches!(self.solids, Solids::Secant | Solids::Softened);
        let kept = self.tangent && self.shifted && secant && !poses.is_empty();
        kept && !trial.is_under_loads()
    }
}

impl System {
    /// Prepares the parts of a model.
    ///
    /// # Errors
    /// [`bulk::BulkError`] if an element or its material cannot be prepared.
    pub fn new(model: &Model) -> Result<Self, bulk::BulkError> {
        let mut system = Self::deformable(model)?;
        let bodies = RigidBodies::new(model, &system.dofs, &system.springs, &system.ties);
        system.make_rigid(bodies);
        Ok(system)
    }

    /// Prepares the parts of a model, with stiff solids in place of rigid bodies.
    ///
    /// # Errors
    /// [`bulk::BulkError`] if an element or its material cannot be prepared.
    pub fn deformable(model: &Model) -> Result<Self, bulk::BulkError> {
        let (dofs, bulk) = (DofMap::new(model), Bulk::new(model)?);
        let mass = Mass::new(model, &bulk, &dofs);
        Ok(Self {
            rigid: RigidBodies::default(),
            general: General::new(model, &mass),
            mass,
            cuts: Cut::all(model),
            dofs,
            bulk,
            contact: Contact::new(model),
            springs: Springs::new(model),
            ties: Ties::new(model),
            outside: ExternalLoads::new(model),
            steered: None,
            rounding_force: crate::model::rounding::force(model),
            gather: None,
            couplings: std::sync::OnceLock::new(),
            analysis: None,
            analysed_version: 0,
            analysed_pairs: Vec::new(),
        })
    }

    /// Replaces rigid bodies by stiff solids, until they are given back to [`Self::make_rigid`].
    pub(crate) fn let_deform(&mut self) -> RigidBodies {
        self.bulk.leave_out(std::iter::empty());
        std::mem::take(&mut self.rigid)
    }

    /// Makes these bodies rigid again.
    pub(crate) fn make_rigid(&mut self, bodies: RigidBodies) {
        self.bulk.leave_out(bodies.elements());
        self.rigid = bodies;
    }

    /// State at rest.
    pub fn initial_state(&mut self, model: &Model) -> State {
        let mut state = State {
            increments: 0,
            time: 0.0,
            q: vec![0.0; self.dofs.slots],
            velocity: vec![0.0; self.dofs.slots],
            acceleration: vec![0.0; self.dofs.slots],
            force: vec![0.0; self.dofs.slots],
            spring_ends: vec![[0.0; 3]; model.springs.len()],
            spring_forces: vec![[0.0; 3]; model.springs.len()],
            ties: self.ties.virgin(),
            loads: vec![[0.0; 3]; model.loads.len()],
            weights: [0.0; 3],
            applied: vec![0.0; self.dofs.slots],
            damping: vec![0.0; self.dofs.slots],
            material: vec![MaterialHistory::default(); 8 * model.mesh.elements.len()],
            interface: self.contact.virgin(model),
            pairs: vec![PointPair::default(); self.contact.points.len()],
            touches: Vec::new(),
            poses: self.poses(model),
            last: None,
            moved: None,
            largest_mean_force: 0.0,
            energies: crate::state::Energies::default(),
            fell: false,
            wants_double: false,
        };
        // Points in contact at rest begin to stick where they are.
        let mut trial = Trial::default();
        trial.start(&state);
        self.search(&mut trial, &state.q);
        self.contact.close(model, &trial.joints.pairs);
        state.pairs.clone_from(&trial.joints.pairs);
        self.follow(&mut state.poses, &mut trial);
        state
    }

    /// Poses for stiffness reuse at rest. They are empty where `fidelity` excludes reuse.
    fn poses(&self, model: &Model) -> Poses {
        match model.fidelity {
            Fidelity::Auto => Poses::at_rest(&self.bulk, &self.contact),
            Fidelity::Full | Fidelity::Elastic => Poses::default(),
        }
    }

    /// Renews the poses of elements and points that have moved too far from them, at the positions at which the
    /// trial ends. `poses` belongs to the state that the trial becomes.
    pub fn follow(&self, poses: &mut Poses, trial: &mut Trial) {
        if !poses.is_empty() {
            poses.follow(&self.bulk, &self.contact, trial);
        }
    }

    /// Begins an increment from the committed state.
    pub fn start(&mut self, model: &Model, trial: &mut Trial, state: &State) {
        trial.start(state);
        self.place(trial, &state.q);
        trial.x_start.clone_from(&trial.x);
        self.contact.follow_rims(model, state, trial);
        self.general.begin(&self.contact, state);
    }

    /// Pairs the contact points with master facets at generalised displacements `q`.
    pub fn search(&mut self, trial: &mut Trial, q: &[f64]) {
        self.place(trial, q);
        self.contact.search(trial);
        self.general.search(trial);
    }

    /// Extrapolates the tractions of the last increment: the predictor of an increment of `ratio` times its
    /// size.
    pub fn extrapolate_tractions(
        &self,
        model: &Model,
        state: &State,
        trial: &mut Trial,
        ratio: f64,
    ) {
        self.contact.extrapolate(model, state, trial, ratio);
        trial.bound_by_traction();
    }

    /// Current positions of all nodes.
    fn place(&self, trial: &mut Trial, q: &[f64]) {
        let nodes = self.bulk.reference.len();
        trial.displacement.resize(nodes, [0.0; 3]);
        self.dofs.spread(q, &mut trial.displacement);
        trial.x.resize(nodes, [0.0; 3]);
        for ((x, u), r) in trial
            .x
            .iter_mut()
            .zip(&trial.displacement)
            .zip(&self.bulk.reference)
        {
            for i in 0..3 {
                x[i] = r[i] + u[i];
            }
        }
    }

    /// Evaluates forces, and stiffness where the setting asks for it, at generalised displacements `q`.
    ///
    /// # Errors
    /// Number of the element and the reason, if a law found no solution.
    #[expect(
        clippy::too_many_arguments,
        reason = "called once an iterate; each argument belongs to another owner"
    )]
    pub fn evaluate(
        &mut self,
        model: &Model,
        state: &State,
        trial: &mut Trial,
        q: &[f64],
        setting: Evaluation,
        clock: &mut crate::state::Clock,
    ) -> Result<(), (usize, LocalFailure)> {
        let nodes = self.bulk.reference.len();
        let n_elements = self.bulk.elements.len();
        let n_contact = n_elements + self.contact.cell_count();
        let n_loaded = n_contact + self.general.cells().len();
        let held = self.springs.cells().len() + self.ties.cells().len();
        let external = held + self.outside.cells().len();
        let n_cells = n_loaded + external + self.steered_cells().len();
        self.place(trial, q);
        trial.cells.force.resize(n_loaded, [[0.0; 3]; 8]);
        trial.cells.stiffness.resize(n_cells * CELL, 0.0);
        trial.cells.active.resize(n_cells, false);
        trial.cells.changed.resize(n_cells, true);

        let begin = std::time::Instant::now();
        self.bulk.evaluate(state, trial, setting)?;
        let middle = std::time::Instant::now();
        self.contact
            .evaluate(model, state, trial, setting, n_elements);
        self.general.evaluate(trial, setting, n_contact);
        clock.contact += middle.elapsed().as_secs_f64();
        clock.elements += (middle - begin).as_secs_f64();

        // Nodal sums in cell order.
        trial.node_force.clear();
        trial.node_force.resize(nodes, [0.0; 3]);
        let connectivity = self.loaded_cells();
        for (nodes, force) in connectivity.zip(&trial.cells.force) {
            for (&n, f) in nodes.iter().zip(force) {
                for i in 0..3 {
                    trial.node_force[n as usize][i] += f[i];
                }
            }
        }
        self.rigid.show_forces(trial);
        if setting.tangent {
            self.rigid.set_turning(setting.turning);
        }
        self.evaluate_external(state, trial, setting, n_loaded);
        trial.force.resize(self.dofs.slots, 0.0);
        self.dofs.collect(&trial.node_force, &mut trial.force);
        let magnitude: f64 = trial.cells.force[..n_elements]
            .iter()
            .flatten()
            .map(|f| (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]).sqrt())
            .sum();
        trial.mean_nodal_force = magnitude / (8.0 * self.bulk.count.max(f64::MIN_POSITIVE));
        Ok(())
    }

    /// Evaluates springs, ties, follower loads and the stiffness along the displacement that steers the load. Their cells
    /// begin at `n_loaded`.
    fn evaluate_external(
        &self,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
        n_loaded: usize,
    ) {
        let n_sprung = n_loaded + self.springs.cells().len();
        let n_tied = n_sprung + self.ties.cells().len();
        let n_pressed = n_tied + self.outside.cells().len();
        let n_cells = n_pressed + self.steered_cells().len();
        if !trial.spring_ends.is_empty() {
            let (u, ends) = (&trial.displacement, &trial.spring_ends);
            self.springs.add_forces(u, ends, &mut trial.node_force);
            if setting.tangent {
                let from = n_loaded * CELL;
                self.springs
                    .write_stiffness(&mut trial.cells.stiffness[from..n_sprung * CELL]);
                trial.cells.changed[n_loaded..n_sprung].fill(true);
                trial.cells.active[n_loaded..n_sprung].fill(true);
            }
        }
        self.ties.evaluate(state, trial);
        if setting.tangent && n_tied > n_sprung {
            let secant = setting.turning == Turning::Ignored;
            let cells = &mut trial.cells.stiffness[n_sprung * CELL..n_tied * CELL];
            (self.ties).write_stiffness(&trial.ties.segments, secant, cells);
            trial.cells.changed[n_sprung..n_tied].fill(true);
            trial.cells.active[n_sprung..n_tied].fill(true);
        }
        let pressed = n_tied..n_pressed;
        let were = setting.tangent && trial.cells.active[pressed.clone()].contains(&true);
        let turns = setting.tangent && setting.turning == Turning::Exact;
        if turns && n_pressed > n_tied && !trial.loads.is_empty() {
            self.outside.write_stiffness(
                &trial.loads,
                &trial.x,
                &mut trial.cells.stiffness[n_tied * CELL..n_pressed * CELL],
                &mut trial.cells.active[n_tied..n_pressed],
            );
        } else if setting.tangent {
            trial.cells.active[n_tied..n_pressed].fill(false);
        }
        if were || turns {
            trial.cells.changed[pressed].fill(true);
        }
        if let (Some(steered), true) = (&self.steered, setting.tangent) {
            steered.write(&mut trial.cells.stiffness[n_pressed * CELL..n_cells * CELL]);
            trial.cells.active[n_pressed..n_cells].fill(true);
            trial.cells.changed[n_pressed..n_cells].fill(true);
        }
    }

    /// Restricts evaluation to the cells at the nodes of these slots until `trial.awake` is removed. Forces and
    /// stiffness of all other cells stay those of the last evaluation, because no other node moves.
    pub fn watch(&self, trial: &mut Trial, slots: impl IntoIterator<Item = u32>) {
        let mut moves = vec![false; self.dofs.slots];
        for slot in slots {
            moves[slot as usize] = true;
        }
        // Supported directions have no slot.
        let moving = |slot: &u32| moves.get(*slot as usize).is_some_and(|moves| *moves);
        let nodes: Vec<bool> = (self.dofs.slot.iter())
            .map(|slots| slots.iter().any(moving))
            .collect();
        let near = |cell: &[u32; 8]| cell.iter().any(|&n| nodes[n as usize]);
        let facets = 0..self.contact.points.len() / 4;
        trial.awake = Some(Awake {
            elements: self.bulk.elements.iter().map(near).collect(),
            facets: facets
                .map(|f| self.contact.cells_of(f).any(|(_, cell)| near(cell)))
                .collect(),
        });
    }

    /// Cells that have nodal forces: elements, planned contact, general contact.
    fn loaded_cells(&self) -> impl Iterator<Item = &[u32; 8]> {
        let solids = self.bulk.elements.iter();
        solids
            .chain(self.contact.cells())
            .chain(self.general.cells())
    }

    /// Area at rest of the contact points under pressure at a commit [mm²].
    pub fn pressed_area(&self, state: &State) -> f64 {
        let planned = self.contact.pressed_area(&state.interface);
        if self.general.is_absent() {
            return planned;
        }
        let touches = state.touches.iter();
        let pressed = touches.filter(|touch| touch.history.traction[0] < 0.0);
        planned + pressed.map(|touch| touch.area).sum::<f64>()
    }

    /// Dissipation of the joints in the increment that `trial` ends [N mm].
    pub fn interface_dissipation(&self, trial: &Trial) -> f64 {
        let planned = trial.joints.energy.iter().map(|e| e[1]).sum::<f64>();
        if self.general.is_absent() {
            return planned;
        }
        planned
            + trial
                .general
                .touches
                .iter()
                .map(|t| t.energy[1])
                .sum::<f64>()
            + trial.general.loss[0]
    }

    /// Terms of the trapezoidal rule for points that open or close, and for ties, in the increment that `trial` ends [N mm]
    /// (theory/energies.md, eqs 9 and 10).
    pub fn crossing_work(&self, model: &Model, state: &State, trial: &Trial) -> f64 {
        let planned =
            self.contact.crossing_work(model, state, trial) + trial.ties.sum(|tie| tie.numerical);
        if self.general.is_absent() {
            return planned;
        }
        planned + self.general.crossing_work(trial)
    }

    /// Work of the nodal forces of open points beyond the work of their tractions in the increment that `trial`
    /// ends [N mm]. See [`Contact::turning_work`].
    pub fn turning_work(&self, model: &Model, state: &State, trial: &Trial) -> f64 {
        self.contact.turning_work(model, state, trial)
    }

    fn steered_cells(&self) -> &[[u32; 8]] {
        self.steered.as_ref().map_or(&[], Steered::cells)
    }

    /// Elastic energy of solids, joints, springs and ties at the trial's positions [N mm].
    pub fn elastic_energy(&self, trial: &Trial, spring_forces: &[[f64; 3]]) -> f64 {
        trial.solids.energy.iter().map(|e| e.elastic).sum::<f64>()
            + trial.joints.energy.iter().map(|e| e[0]).sum::<f64>()
            + trial
                .general
                .touches
                .iter()
                .map(|t| t.energy[0])
                .sum::<f64>()
            + self.springs.energy(spring_forces.iter().copied())
            + trial.ties.sum(|tie| tie.elastic)
    }

    /// Forces of the springs on their nodes at the trial's positions [N]. `[spring][xyz]`
    pub fn spring_forces(&self, trial: &Trial) -> Vec<[f64; 3]> {
        let ends = &trial.spring_ends;
        self.springs.forces(&trial.displacement, ends).collect()
    }

    /// Internal forces of the springs if their ends move by `by` [mm] `[spring][xyz]` and the bodies stay [N].
    /// `[slot]`
    pub fn spring_pull(&self, by: &[[f64; 3]]) -> Vec<f64> {
        let mut p = vec![0.0; self.dofs.slots];
        if !by.is_empty() {
            let rest = vec![[0.0; 3]; self.bulk.reference.len()];
            let mut force = rest.clone();
            self.springs.add_forces(&rest, by, &mut force);
            self.dofs.collect(&force, &mut p);
        }
        p
    }

    /// Internal forces at the trial's positions of ties that are stressed, per unit of the load factor, if they are in
    /// these stages at its end [N]. `[slot]`
    pub fn tie_pull(&self, trial: &Trial, stages: &[TieStage]) -> Vec<f64> {
        let responses = &trial.ties.segments;
        self.on_slots(|force| self.ties.add_jacking(stages, responses, force))
    }

    /// Forces of loads with fixed direction and these values on all slots, unknown and prescribed [N]. `[slot]`
    pub fn dead_loads(&self, values: &[[f64; 3]]) -> Vec<f64> {
        self.on_slots(|force| self.outside.add_dead(values, force))
    }

    /// Forces of follower pressures of these values on all slots, for nodes at `x` [mm] [N]. `[slot]`
    pub fn follower_loads(&self, values: &[[f64; 3]], x: &[[f64; 3]]) -> Vec<f64> {
        self.on_slots(|force| self.outside.add_followers(values, x, force))
    }

    fn on_slots(&self, add: impl FnOnce(&mut [[f64; 3]])) -> Vec<f64> {
        let mut force = vec![[0.0; 3]; self.bulk.reference.len()];
        add(&mut force);
        let mut slots = vec![0.0; self.dofs.slots];
        self.dofs.collect(&force, &mut slots);
        slots
    }

    /// Product K Δq over all cells, for a change of the prescribed displacements [N]. `[slot]`
    pub fn multiply(&self, trial: &Trial, dq: &[f64]) -> Vec<f64> {
        let nodes = self.bulk.reference.len();
        let mut du = vec![[0.0; 3]; nodes];
        self.dofs.spread(dq, &mut du);
        let mut force = vec![[0.0; 3]; nodes];
        let connectivity = self.loaded_cells().chain(self.springs.cells());
        let connectivity = connectivity.chain(self.ties.cells());
        let connectivity = connectivity.chain(self.outside.cells());
        let connectivity = connectivity.chain(self.steered_cells());
        for (c, nodes) in connectivity.enumerate() {
            if !trial.cells.active[c] || nodes.iter().all(|&n| du[n as usize] == [0.0; 3]) {
                continue;
            }
            let cell = &trial.cells.stiffness[c * CELL..(c + 1) * CELL];
            for (a, &row) in nodes.iter().enumerate() {
                for (b, &col) in nodes.iter().enumerate() {
                    let block = &cell[(a * 8 + b) * 9..][..9];
                    let d = du[col as usize];
                    for i in 0..3 {
                        force[row as usize][i] +=
                            block[3 * i] * d[0] + block[3 * i + 1] * d[1] + block[3 * i + 2] * d[2];
                    }
                }
            }
        }
        let mut p = vec![0.0; self.dofs.slots];
        self.dofs.collect(&force, &mut p);
        p
    }
}
