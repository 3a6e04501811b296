//! A program scaled to numbers near 1, solved, and scaled back.

use clarabel::solver::SupportedConeT::{NonnegativeConeT, SecondOrderConeT, ZeroConeT};

use super::blocks::Split;
use super::cones::{Cone, Shape};
use super::iteration::{End, Iteration};
use super::normal::{Nodes, Normal, Parts};
use crate::limit::matrix::Matrix;

/// Solution of a program.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Its end.
    pub end: End,
    /// Largest relative residual, or the relative gap if that is larger.
    pub error: f64,
    /// x. `[column]`
    pub x: Vec<f64>,
    /// Multipliers of the equations. `[equation]`
    pub y: Vec<f64>,
    /// Bound of the objective by the multipliers.
    pub bound: f64,
}

/// Factors by which a program is scaled.
struct Scales {
    /// Of the equations.
    rows: Vec<f64>,
    /// Of the columns; 1 where unknowns have bounds.
    columns: Vec<f64>,
    /// Size of the right sides.
    right: f64,
    /// Factor of the cost.
    cost: f64,
}

/// Cones after the equations, and the cone of each row.
fn cones_of(program: &Matrix) -> Option<(usize, Vec<Cone>, Vec<usize>)> {
    let mut shapes = program.cones.iter();
    let ZeroConeT(equations) = shapes.next()? else {
        return None;
    };
    let (mut cones, mut of_row) = (Vec::new(), Vec::new());
    for shape in shapes {
        let (count, shape) = match shape {
            NonnegativeConeT(count) => (*count, Shape::Ray),
            SecondOrderConeT(3) => (1, Shape::Round),
            _ => return None,
        };
        for _ in 0..count {
            let cone = Cone::new(shape, of_row.len());
            of_row.resize(of_row.len() + cone.rows(), cones.len());
            cones.push(cone);
        }
    }
    Some((*equations, cones, of_row))
}

impl Scales {
    fn of(program: &Matrix, cost: &[f64], split: &Split) -> Self {
        let matrix = &program.entries;
        let equations = split.blocks.iter().flat_map(|block| {
            let own = block.own.chunks_exact(block.equations.len().max(1));
            own.flat_map(|column| block.equations.iter().copied().zip(column.iter().copied()))
        });
        let mut rows = vec![0.0f64; program.equations()];
        for (row, value) in equations {
            rows[row] = rows[row].max(value.abs());
        }
        for row in &mut rows {
            *row = if *row > 0.0 { 1.0 / *row } else { 1.0 };
        }
        let mut columns = vec![1.0; matrix.n];
        for k in &split.columns[split.bounded..] {
            let entries = matrix.colptr[*k]..matrix.colptr[*k + 1];
            let sizes = entries.map(|i| (rows[matrix.rowval[i]] * matrix.nzval[i]).abs());
            let most = sizes.fold(0.0, f64::max);
            columns[*k] = if most > 0.0 { 1.0 / most } else { 1.0 };
        }
        // Loads set the size of the forces, strengths may be far above them.
        let loads = program.right.iter().zip(&rows).map(|(b, r)| (b * r).abs());
        let loads = loads.fold(0.0, f64::max);
        let strengths = || program.right.iter().fold(0.0, |most, b| b.abs().max(most));
        let right = if loads > 0.0 { loads } else { strengths() };
        let costs = cost.iter().zip(&columns).map(|(c, k)| (c * k).abs());
        let most = costs.fold(0.0, f64::max);
        Self {
            right: if right > 0.0 { right } else { 1.0 },
            cost: if most > 0.0 { 1.0 / most } else { 1.0 },
            rows,
            columns,
        }
    }
}

/// Solves a program to a tolerance. `None` if it is none of the kind for this method.
pub fn solve(program: &Matrix, cost: &[f64], nodes: Nodes<'_>, tolerance: f64) -> Option<Answer> {
    let (equations, cones, of_row) = cones_of(program)?;
    let matrix = &program.entries;
    let mut split = Split::of(matrix, equations, &of_row, &cones);
    let scales = Scales::of(program, cost, &split);
    for block in &mut split.blocks {
        let count = block.equations.len().max(1);
        for column in block.own.chunks_exact_mut(count) {
            let rows = block.equations.iter().map(|e| scales.rows[*e]);
            column.iter_mut().zip(rows).for_each(|(a, r)| *a *= r);
        }
    }
    let free = split.columns[split.bounded..].iter().map(|k| {
        let entries = matrix.colptr[*k]..matrix.colptr[k + 1];
        let scaled = entries.map(|i| {
            let row = matrix.rowval[i];
            (row, scales.rows[row] * scales.columns[*k] * matrix.nzval[i])
        });
        scaled.collect()
    });
    let free = free.collect();
    let mut normal = Normal::new(split.blocks, free, equations, nodes)?;
    let scaled = program.right.iter().enumerate();
    let scaled = scaled.map(|(i, b)| scales.rows.get(i).unwrap_or(&1.0) * b / scales.right);
    let mut y: Vec<f64> = scaled.collect();
    let bounds = y.split_off(equations);
    let z = split.rows.iter().map(|row| bounds[*row]).collect();
    let costs = split.columns.iter();
    let costs = costs.map(|k| scales.cost * cost[*k] * scales.columns[*k]);
    let costs = costs.collect();
    let right = Parts {
        x: Vec::new(),
        y,
        z,
    };
    let mut iteration = Iteration::new(&mut normal, split.cones, costs, right);
    let (end, error) = iteration.run(tolerance);
    let [_, bound] = iteration.objectives();
    // A proof that there is no solution has no size.
    let size = if matches!(end, End::Solved | End::Stalled) {
        iteration.tau
    } else {
        1.0
    };
    let mut x = vec![0.0; matrix.n];
    for (k, value) in split.columns.iter().zip(&iteration.x) {
        x[*k] = scales.right * scales.columns[*k] * value / size;
    }
    let y = iteration.y.iter().zip(&scales.rows);
    Some(Answer {
        end,
        error,
        x,
        y: y.map(|(y, r)| r * y / (scales.cost * size)).collect(),
        bound: bound * scales.right / scales.cost,
    })
}
