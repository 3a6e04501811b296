//! Matrix and masses of rigid bodies against finite differences and solid boxes.

use nalgebra::{DMatrix, DVector};

use crate::assembly::{Equations, Evaluation, Solids, System, Trial, Turning};
use crate::deck::Deck;
use crate::linear::Backend;
use crate::model::Model;
use crate::state::{Clock, State};

/// Two rigid stones, one on the other, on a fixed one of another length; the upper one is skew in plan.
const DECK: &str = r#"
format = 1
[materials.stone]
E = "10 GPa"
nu = 0.2
density = "2000 kg/m^3"
[interfaces.soft]
f_t = "5 MPa"
c = "5 MPa"
u_k = "2 mm"
zeta = 2
delta_k = "4 mm"
xi = 2
tan_phi = 0.6
mu = 0.6
normal_stiffness = "20 N/mm^3"
shear_stiffness = "8 N/mm^3"
[[blocks]]
name = "ground"
size = [300, 120, 40]
at = [-50, 0, -40]
material = "stone"
[[blocks]]
name = "lower"
size = [200, 100, 60]
material = "stone"
mesh = [2, 1, 1]
rigid = true
[[blocks]]
name = "upper"
size = [160, 80, 90]
at = [10, 5, 60]
material = "stone"
rigid = true
[[contacts]]
slave = "lower.bottom"
master = "ground.top"
interface = "soft"
[[contacts]]
slave = "upper.bottom"
master = "lower.top"
interface = "soft"
[[supports]]
on = "ground"
[[steps]]
kind = "gravity"
"#;

struct Rig {
    model: Model,
    system: System,
    state: State,
    trial: Trial,
    equations: Equations,
    values: Vec<f64>,
}

impl Rig {
    fn new() -> Self {
        Self::of(DECK)
    }

    fn of(text: &str) -> Self {
        let deck = Deck::from_str(text, "test").unwrap();
        let (model, _) = Model::from_deck(&deck).unwrap();
        let mut system = System::new(&model).unwrap();
        let state = system.initial_state(&model);
        let equations = Equations::new(&system.dofs, &model.steps[0]);
        let mut trial = Trial::default();
        system.start(&model, &mut trial, &state);
        system.search(&mut trial, &state.q);
        let analysed = system.analyse(&equations, Backend::MultifrontalLu);
        Self {
            values: vec![0.0; analysed.unwrap().0],
            model,
            system,
            state,
            trial,
            equations,
        }
    }

    /// Forces on the unknowns of the bodies at `q`, whose matrix is then in `values`.
    fn forces(&mut self, q: &[f64]) -> DVector<f64> {
        let setting = Evaluation {
            dt: 1.0,
            solids: Solids::Implicit,
            shifted: false,
            tangent: true,
            turning: Turning::Exact,
        };
        let (system, trial) = (&mut self.system, &mut self.trial);
        (system.evaluate(
            &self.model,
            &self.state,
            trial,
            q,
            setting,
            &mut Clock::default(),
        ))
        .unwrap();
        system.refill(trial, &mut None, &mut self.values);
        let of_nodes: Vec<f64> = (self.equations.slot_of.iter())
            .map(|slot| trial.force[*slot as usize])
            .collect();
        DVector::from(
            system
                .rigid
                .gathered(&system.dofs, &self.equations, &of_nodes),
        )
    }

    /// `q` moved by `by` of the unknowns.
    fn moved(&self, q: &[f64], by: &[f64]) -> Vec<f64> {
        let system = &self.system;
        let way = system.rigid.scattered(&system.dofs, &self.equations, by);
        let mut q = q.to_vec();
        for (slot, way) in self.equations.slot_of.iter().zip(way) {
            q[*slot as usize] += way;
        }
        system.rigid.straighten(&system.dofs, &mut q);
        q
    }

    /// The filled matrix.
    fn matrix(&self) -> DMatrix<f64> {
        let gather = self.system.gather.as_ref().unwrap();
        let mut matrix = DMatrix::zeros(gather.n, gather.n);
        for (column, range) in gather.col_ptr.windows(2).enumerate() {
            for k in range[0]..range[1] {
                matrix[(gather.row_idx[k] as usize, column)] = self.values[k];
            }
        }
        matrix
    }
}

#[test]
fn the_matrix_is_the_derivative_of_the_resultants() {
    is_the_derivative(Rig::new(), 12);
}

/// A body with a face that is held in a plane has three unknowns.
#[test]
fn so_it_is_for_a_body_that_is_held_in_a_plane() {
    let held = "[[supports]]\non = \"upper.front\"\nfixed = [\"y\"]\n[[steps]]";
    is_the_derivative(Rig::of(&DECK.replace("[[steps]]", held)), 9);
}

fn is_the_derivative(mut rig: Rig, unknowns: usize) {
    assert_eq!(rig.system.rigid.len(), 2);
    let rest = rig.state.q.clone();
    rig.forces(&rest);
    let n = rig.matrix().nrows();
    assert_eq!(n, unknowns);
    // Pressed, pulled aside and turned by some hundredths, so that forces are large and arms have turned.
    let by: Vec<f64> = (0..n)
        .map(|e| 0.05 * (1.0 + 7.0 * e as f64).sin() - 0.02)
        .collect();
    let q = rig.moved(&rest, &by);
    rig.forces(&q);
    let assembled = rig.matrix();
    let mut differences = DMatrix::zeros(n, n);
    let step = 1e-5;
    for e in 0..n {
        let mut sides = [step, -step].map(|by| {
            let mut way = vec![0.0; n];
            way[e] = by;
            way
        });
        // Arms are those of the pose that is left.
        let sides = sides.each_mut().map(|way| {
            rig.forces(&q);
            let q = rig.moved(&q, way);
            rig.forces(&q)
        });
        differences.set_column(e, &((&sides[0] - &sides[1]) / (2.0 * step)));
    }
    let error = (&assembled - &differences).amax() / differences.amax();
    assert!(error < 1e-6, "{error:e}");
}

#[test]
fn bodies_have_the_mass_and_the_moments_of_inertia_of_solid_boxes() {
    let mut rig = Rig::new();
    let rest = rig.state.q.clone();
    rig.forces(&rest);
    rig.values.fill(0.0);
    rig.system.add_mass(&rig.equations, 1.0, &mut rig.values);
    let matrix = rig.matrix();
    for (body, [a, b, c]) in [[200.0, 100.0, 60.0], [160.0, 80.0, 90.0_f64]]
        .into_iter()
        .enumerate()
    {
        let mass = 2e-9 * a * b * c;
        let radius = rig.system.rigid.bodies[body].radius;
        let turning = [[b, c], [a, c], [a, b]]
            .map(|[p, q]| mass * (p * p + q * q) / 12.0 / (radius * radius));
        let exact = [mass, mass, mass, turning[0], turning[1], turning[2]];
        let block = matrix.view((6 * body, 6 * body), (6, 6));
        let error = (block - DMatrix::from_diagonal(&DVector::from_row_slice(&exact))).amax();
        assert!(error < 1e-12 * mass, "{body}: {block} {exact:?}");
    }
}

/// Any displacements lead to the rotation that they were made of, however large it is.
#[test]
fn a_body_is_straightened_to_its_rotation() {
    let rig = Rig::new();
    let (system, mesh) = (&rig.system, &rig.model.mesh);
    let rotation = nalgebra::Rotation3::from_euler_angles(2.8, -0.7, 1.9);
    let mut q = rig.state.q.clone();
    for (n, x) in mesh.nodes.iter().enumerate() {
        let turned = rotation * nalgebra::Vector3::from(*x);
        for i in 0..3 {
            if let Some(q) = q.get_mut(system.dofs.slot[n][i] as usize) {
                *q = turned[i] - x[i];
            }
        }
    }
    let exact = q.clone();
    // A stretch along each stone's own length by a fiftieth has no rotation, and its middle stays.
    let middle = [100.0, 90.0];
    let upper = mesh.names.iter().position(|name| name == "upper").unwrap() as u32;
    let of_upper = mesh.elements.iter().zip(&mesh.unit);
    let of_upper: Vec<u32> = of_upper
        .filter(|(_, unit)| **unit == upper)
        .flat_map(|(nodes, _)| *nodes)
        .collect();
    let is_upper = |n: usize| of_upper.contains(&(n as u32));
    for (n, x) in mesh.nodes.iter().enumerate() {
        let from = x[0] - middle[usize::from(is_upper(n))];
        let by = rotation * nalgebra::Vector3::new(0.02 * from, 0.0, 0.0);
        for i in 0..3 {
            if let Some(q) = q.get_mut(system.dofs.slot[n][i] as usize) {
                *q += by[i];
            }
        }
    }
    system.rigid.straighten(&system.dofs, &mut q);
    let error = q
        .iter()
        .zip(&exact)
        .map(|(q, exact)| (q - exact).abs())
        .fold(0.0, f64::max);
    assert!(error < 1e-10, "{error:e}");
}
