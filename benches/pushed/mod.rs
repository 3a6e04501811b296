//! Initial state for the benches of the system: the wall J7D of `examples/03_shear_wall_j7d.toml`, pushed a little
//! by the solver itself. Joints open and slide, and some points of the mortar yield.

use wythe::assembly::{Equations, Evaluation, Solids, System, Trial, Turning};
use wythe::deck::Deck;
use wythe::linear::{Backend, LinearSolver};
use wythe::model::Model;
use wythe::solve::Recorder;
use wythe::state::{Clock, State};
use wythe::state::{Frame, HistoryRow};

/// Displacement of the top in the initial state [mm].
const PUSHED: f64 = 0.4;

/// Model, system and initial state of the benches.
pub struct Pushed {
    /// The model.
    pub model: Model,
    /// System, analysed for the step of the push.
    pub system: System,
    /// Last committed state.
    pub state: State,
    /// Working data, evaluated at `q` with tangents.
    pub trial: Trial,
    /// Unknowns of the push.
    pub equations: Equations,
    /// Linear solver of the matrix.
    pub linear: LinearSolver,
    /// Values of the matrix.
    pub values: Vec<f64>,
    /// Generalised displacements at the start of the next increment [mm]. `[slot]`
    pub q: Vec<f64>,
}

/// Settings for an iterate, with tangents, or for a trial of the line search, without tangents.
pub fn setting(tangent: bool) -> Evaluation {
    Evaluation {
        dt: 0.0125,
        solids: if tangent {
            Solids::Secant
        } else {
            Solids::Held
        },
        shifted: true,
        tangent,
        turning: Turning::Ignored,
    }
}

/// Recorder that keeps the last state and stops the run.
#[derive(Default)]
struct Stop(Option<State>);

impl Recorder for Stop {
    fn take(&mut self, _: &Model, row: &HistoryRow, _: Option<&Frame>) -> std::io::Result<bool> {
        Ok(row.displacement_mm < PUSHED)
    }

    fn observe(&mut self, state: &State) {
        self.0 = Some(state.clone());
    }
}

impl Pushed {
    /// Runs the wall to the initial state and begins the next increment there.
    pub fn new() -> Self {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/examples/03_shear_wall_j7d.toml"
        );
        // The benches need the state of the whole wall.
        let full = [("fidelity".to_owned(), "full".to_owned())];
        let deck = Deck::load(path, &full).expect("the example is sound");
        let (model, _) = Model::from_deck(&deck).expect("the example is sound");
        let mut stop = Stop::default();
        wythe::solve::run(&model, &mut stop).expect("a run");
        let state = stop.0.expect("a state");
        let last = state.last.as_ref().expect("an increment");
        let q: Vec<f64> = state.q.iter().zip(&last.dq).map(|(q, dq)| q + dq).collect();

        let mut system = System::new(&model).expect("the example is sound");
        system
            .bulk
            .stabilise(model.steps[1].viscosity, f64::INFINITY);
        let mut trial = Trial::default();
        trial.start(&state);
        system.extrapolate_tractions(&model, &state, &mut trial, 1.0);
        system.search(&mut trial, &q);
        let equations = Equations::new(&system.dofs, &model.steps[1]);
        let (entries, linear) = system
            .analyse(&equations, Backend::MixedLlt)
            .expect("a pattern");
        let mut wall = Self {
            model,
            system,
            state,
            trial,
            equations,
            linear,
            values: vec![0.0; entries],
            q,
        };
        wall.evaluate(setting(true));
        wall.system.fill(&wall.trial, &mut wall.values);
        wall
    }

    /// Pairs the contact points and evaluates all forces at `q`.
    pub fn search_and_evaluate(&mut self, setting: Evaluation) {
        self.system.search(&mut self.trial, &self.q);
        self.evaluate(setting);
    }

    /// Evaluates all forces at `q`.
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

    /// d = −K⁻¹ r of the forces last evaluated; there are no external forces.
    pub fn direction(&mut self) -> Vec<f64> {
        let force = &self.trial.force;
        let slots = self.equations.slot_of.iter();
        let mut d: Vec<f64> = slots.map(|&s| -force[s as usize]).collect();
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
}
