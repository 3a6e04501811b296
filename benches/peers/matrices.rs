//! Matrices for the comparison of linear solvers.

use std::path::Path;
use wythe::assembly::{Equations, Evaluation, Solids, System, Trial, Turning};
use wythe::deck::Deck;
use wythe::linear::{Backend, LinearSolver, Options, Pattern};
use wythe::model::Model;
use wythe::state::Clock;

/// A structurally symmetric matrix.
pub struct Matrix {
    pub pattern: Pattern,
    pub values: Vec<f64>, // [entry], both triangles
}

impl Matrix {
    /// Analyses the pattern for a back end.
    pub fn analyse(&self, backend: Backend) -> LinearSolver {
        LinearSolver::analyse(&self.pattern, Options::new(backend)).expect("an analysis")
    }
}

/// Names understood by [`matrix`].
pub const NAMES: [&str; 5] = ["j7d", "j7d-fine", "thick", "cube-20", "cube-30"];

/// Tangent of the wall J7D at rest, or of a grid of nodes: `thick`, `cube-n`, `wall-nx-ny-nz`.
pub fn matrix(name: &str) -> Matrix {
    let counts: Vec<usize> = name.split('-').filter_map(|n| n.parse().ok()).collect();
    match (name, &counts[..]) {
        ("j7d", _) => wall(&[]),
        ("j7d-fine", _) => wall(&[("wall.mesh", "fine")]),
        ("thick", _) => grid([40, 9, 40]),
        (_, &[n]) => grid([n; 3]),
        (_, &[nx, ny, nz]) => grid([nx, ny, nz]),
        _ => panic!("no matrix {name}"),
    }
}

fn wall(set: &[(&str, &str)]) -> Matrix {
    example("03_shear_wall_j7d.toml", set)
}

/// Tangent at rest of a large wall with elastic units, of this length [mm] and number of courses.
pub fn large_wall(length: &str, courses: &str) -> Matrix {
    let set = [("wall.length", length), ("wall.courses", courses)];
    example("70_large_wall.toml", &set)
}

fn example(name: &str, set: &[(&str, &str)]) -> Matrix {
    let deck = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name);
    let own = |&(key, value): &(&str, &str)| (key.to_owned(), value.to_owned());
    let set: Vec<(String, String)> = set.iter().map(own).collect();
    let deck = Deck::load(deck.to_str().expect("a path in UTF-8"), &set).expect("a deck");
    let (model, _) = Model::from_deck(&deck).expect("a model");
    let mut system = System::new(&model).expect("a system");
    let state = system.initial_state(&model);
    let mut trial = Trial::default();
    trial.start(&state);
    let q = vec![0.0; system.dofs.slots];
    system.search(&mut trial, &q);
    let equations = Equations::new(&system.dofs, model.steps.last().expect("a step"));
    let setting = Evaluation {
        dt: 0.01,
        solids: Solids::Implicit,
        shifted: true,
        tangent: true,
        turning: Turning::Ignored,
    };
    let clock = &mut Clock::default();
    system
        .evaluate(&model, &state, &mut trial, &q, setting, clock)
        .expect("forces");
    // Only the analysis for L U lets both triangles be filled.
    let (entries, solver) = system
        .analyse(&equations, Backend::MultifrontalLu)
        .expect("an analysis");
    let mut values = vec![0.0; entries];
    system.fill(&trial, &mut values);
    Matrix {
        pattern: solver.pattern().clone(),
        values,
    }
}

/// A grid of nodes with three equations each, coupled to 27 nodes as in hex8 meshes: springs k = d dᵀ + 0.2
/// between neighbours (d is their unit vector), fixed at x = 0.
fn grid(nodes: [usize; 3]) -> Matrix {
    let [nx, ny, nz] = nodes;
    let around = |i: usize, n: usize| i.saturating_sub(1)..(i + 2).min(n);
    let (mut col_ptr, mut row_idx, mut values) = (vec![0], Vec::new(), Vec::new());
    let (mut node, mut coordinates) = (Vec::new(), Vec::new());
    for at in 0..nx * ny * nz {
        let here = [at % nx, at / nx % ny, at / (nx * ny)];
        let mut list = Vec::new(); // [neighbour] → its node, stiffness of the spring to it
        let mut sum = [[0.0; 3]; 3];
        for c in around(here[2], nz) {
            for b in around(here[1], ny) {
                for a in around(here[0], nx) {
                    let offset = [a, b, c].map(|x| x as f64);
                    let d: [f64; 3] = std::array::from_fn(|i| offset[i] - here[i] as f64);
                    let square = d.iter().map(|x| x * x).sum::<f64>().max(1.0);
                    let k: [[f64; 3]; 3] = std::array::from_fn(|p| {
                        std::array::from_fn(|q| d[p] * d[q] / square + 0.2 * f64::from(p == q))
                    });
                    // The spring of a node with itself fixes it at x = 0 and is zero elsewhere.
                    let other = a + nx * (b + ny * c);
                    if other != at || here[0] == 0 {
                        (0..9).for_each(|i| sum[i / 3][i % 3] += k[i / 3][i % 3]);
                    }
                    list.push((other, k));
                }
            }
        }
        for q in 0..3 {
            for &(other, k) in &list {
                for p in 0..3 {
                    row_idx.push((3 * other + p) as u32);
                    values.push(if other == at { sum[p][q] } else { -k[p][q] });
                }
            }
            col_ptr.push(row_idx.len());
            node.push(at as u32);
        }
        coordinates.push(here.map(|x| x as f64));
    }
    let pattern = Pattern::new(3 * nx * ny * nz, col_ptr, row_idx)
        .and_then(|pattern| pattern.with_nodes(&node, &coordinates))
        .expect("a pattern");
    Matrix { pattern, values }
}
