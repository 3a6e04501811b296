//! The wall J7D of `examples/03_shear_wall_j7d.toml`, pressed and pushed a little: joints open and
//! slide, some points of the mortar have yielded. What the benches of the system start from.

use wythe::model::scene::{BeamMotion, Step};
use wythe::model::{Deck, Model};
use wythe::solve::{Clock, State};
use wythe::system::linear::{Backend, LinearSolver};
use wythe::system::{Equations, Evaluation, Solids, System, Trial};

/// Model, system and the state the benches start from.
pub struct Pushed {
    /// The model.
    pub model: Model,
    /// Its system, analysed for the step of the push.
    pub system: System,
    /// Last committed state.
    pub state: State,
    /// Scratch: evaluated at `q`, with tangents.
    pub trial: Trial,
    /// Unknowns of the push.
    pub equations: Equations,
    /// The matrix's solver.
    pub linear: LinearSolver,
    /// Its values.
    pub values: Vec<f64>,
    /// Generalised displacements of the start of the next increment [mm]. `[slot]`
    pub q: Vec<f64>,
    /// Forces on the beams [N]. `[slot]`
    external: Vec<f64>,
    /// Change of `q` in the last increment of the step [mm]. `[slot]`
    last: Option<Vec<f64>>,
}

/// An iterate, with tangents, or a trial of the line search along its direction, without.
pub fn setting(tangent: bool) -> Evaluation {
    Evaluation {
        dt: 0.02,
        solids: if tangent {
            Solids::Secant
        } else {
            Solids::Held
        },
        shifted: true,
        tangent,
    }
}

impl Pushed {
    /// Presses the wall in four increments and pushes it in four of 0.08 mm, without line search
    /// and cuts: enough for a typical state, no substitute for `solve::run`.
    pub fn new() -> Self {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/examples/03_shear_wall_j7d.toml"
        );
        let deck = Deck::load(path, &[]).expect("the example is sound");
        let (model, _) = Model::from_deck(&deck).expect("the example is sound");
        let mut system = System::new(&model).expect("the example is sound");
        let state = system.initial_state(&model);
        let equations = Equations::new(&system.dofs, &model.steps[0]);
        let (entries, linear) = system
            .analyse(&equations, Backend::MultifrontalLlt)
            .expect("a pattern");
        let mut wall = Self {
            q: state.q.clone(),
            external: vec![0.0; system.dofs.slots],
            last: None,
            values: vec![0.0; entries],
            trial: Trial::default(),
            model,
            system,
            state,
            equations,
            linear,
        };
        let steps = wall.model.steps.clone();
        for (step, increments, size) in [(&steps[0], 4, 0.25), (&steps[1], 4, 0.02)] {
            wall.begin(step);
            for k in 1..=increments {
                wall.start(step, size, f64::from(k));
                wall.converge();
                wall.commit(size);
            }
        }
        wall.start(&steps[1], 0.02, 5.0);
        wall.matrix();
        wall
    }

    /// Takes over the boundary conditions of a step.
    fn begin(&mut self, step: &Step) {
        self.equations = Equations::new(&self.system.dofs, step);
        self.analyse();
        self.system.bulk.stabilise(step.viscosity);
        self.last = None;
    }

    fn analyse(&mut self) {
        let (entries, linear) = self
            .system
            .analyse(&self.equations, Backend::MultifrontalLlt)
            .expect("a pattern");
        self.values = vec![0.0; entries];
        self.linear = linear;
    }

    /// Start of the increment that ends at `k · size` of the step: the last one again, or the
    /// tangent with the prescribed displacements on the right-hand side.
    fn start(&mut self, step: &Step, size: f64, k: f64) {
        self.trial.start(&self.state);
        self.q.clone_from(&self.state.q);
        let mut target = self.state.q.clone();
        self.external.fill(0.0);
        for (b, motion) in step.motion.iter().enumerate() {
            for (i, motion) in motion.iter().enumerate() {
                let slot = self.system.dofs.beam_slot(b, i);
                match *motion {
                    BeamMotion::Locked => {}
                    BeamMotion::Driven(by) => target[slot] += size * by,
                    BeamMotion::Force(to) => self.external[slot] = size * k * to,
                }
            }
        }
        if let Some(last) = &self.last {
            self.q = target;
            for &slot in &self.equations.slot_of {
                self.q[slot as usize] += last[slot as usize];
            }
            return;
        }
        self.matrix();
        let change: Vec<f64> = target.iter().zip(&self.q).map(|(t, q)| t - q).collect();
        let moved = self.system.multiply(&self.trial, &change);
        for (force, moved) in self.trial.force.iter_mut().zip(&moved) {
            *force += moved;
        }
        let d = self.direction();
        self.q = target;
        self.go(&d);
    }

    /// Pairs, forces, tangents and matrix at `q`.
    fn matrix(&mut self) {
        self.search_and_evaluate(true);
        if self.system.pattern_changed() {
            self.analyse();
        }
        self.system.fill(&self.trial, &mut self.values);
    }

    /// Pairs the contact points, and all forces at `q`.
    pub fn search_and_evaluate(&mut self, tangent: bool) {
        self.system.search(&mut self.trial, &self.q);
        self.evaluate(setting(tangent));
    }

    /// All forces at `q`.
    pub fn evaluate(&mut self, setting: Evaluation) {
        self.system
            .evaluate(
                &self.model,
                &self.state,
                &mut self.trial,
                &self.q,
                setting,
                &mut Clock::default(),
            )
            .expect("sound elements");
    }

    /// d = −K⁻¹ r of the forces last evaluated.
    pub fn direction(&mut self) -> Vec<f64> {
        let mut d: Vec<f64> = self
            .equations
            .slot_of
            .iter()
            .map(|&s| self.external[s as usize] - self.trial.force[s as usize])
            .collect();
        self.linear.factorise(&self.values).expect("definite");
        self.linear.solve(&mut d).expect("a solution");
        d
    }

    /// q ← q + d.
    pub fn go(&mut self, d: &[f64]) {
        for (d, &slot) in d.iter().zip(&self.equations.slot_of) {
            self.q[slot as usize] += d;
        }
    }

    fn converge(&mut self) {
        for iteration in 0..30 {
            self.matrix();
            let out = self.equations.slot_of.iter().map(|&s| s as usize);
            let worst = out
                .map(|s| (self.trial.force[s] - self.external[s]).abs())
                .fold(0.0, f64::max);
            if iteration > 0 && worst <= 0.05 * self.trial.mean_nodal_force {
                return;
            }
            let d = self.direction();
            self.go(&d);
            self.evaluate(setting(false));
            self.trial.keep_tractions();
        }
        panic!("the wall of the benches is not in balance");
    }

    fn commit(&mut self, size: f64) {
        self.evaluate(Evaluation {
            dt: size,
            solids: Solids::Implicit,
            shifted: true,
            tangent: false,
        });
        let dq = self.q.iter().zip(&self.state.q).map(|(a, b)| a - b);
        self.last = Some(dq.collect());
        self.state.q.clone_from(&self.q);
        self.state.material.clone_from(&self.trial.material);
        self.state.interface.clone_from(&self.trial.interface);
        self.state.pairs.clone_from(&self.trial.pairs);
    }
}
