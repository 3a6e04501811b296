//! The matrix of a system: its pattern, analysis and filling from the cells.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use super::dofs::PRESCRIBED;
use super::{DofMap, Equations, Gather, System, Trial};
use crate::linear::eigen::{EigenError, Lowest, MassMatrix, lowest};
use crate::linear::{Backend, LinearError, LinearSolver, Options, Pattern};

/// Part of the largest entry of a diagonal below which a negative entry is rounding.
const ROUNDING: f64 = 1e-13;

impl System {
    /// True if contact candidates have changed since the last analysis.
    pub fn pattern_changed(&self) -> bool {
        self.gather.is_none()
            || self.analysed_version != self.contact.version()
            || self.analysed_pairs != self.general.pairs()
    }

    /// Orders and analyses the matrix for the present candidates. Returns its number of entries and its solver.
    ///
    /// # Errors
    /// [`LinearError`] of the analysis.
    pub fn analyse(
        &mut self,
        equations: &Equations,
        backend: Backend,
    ) -> Result<(usize, LinearSolver), LinearError> {
        let cells = self.cells();
        let (gather, solver) = if self.rigid.is_empty() {
            self.ordered(&cells, &self.dofs, equations, backend)?
        } else {
            let mut rigid = std::mem::take(&mut self.rigid);
            let reduced = rigid.reduce(&self.dofs, equations, &cells);
            let ordered = self.ordered(&reduced.cells, &reduced.dofs, &reduced.equations, backend);
            self.rigid = rigid;
            ordered?
        };
        let entries = gather.row_idx.len();
        self.gather = Some(gather);
        self.couplings = OnceLock::new();
        self.analysis = solver.analysis().cloned();
        self.analysed_version = self.contact.version();
        self.analysed_pairs.clear();
        self.analysed_pairs.extend_from_slice(self.general.pairs());
        Ok((entries, solver))
    }

    /// Nodes of all cells that contribute to the matrix.
    fn cells(&self) -> Vec<[u32; 8]> {
        let mut cells = self.bulk.elements.clone();
        cells.extend(self.contact.cells());
        cells.extend(self.general.cells());
        cells.extend(self.springs.cells());
        cells.extend(self.ties.cells());
        cells.extend(self.outside.cells());
        cells.extend(self.steered_cells());
        cells
    }

    /// Matrix pattern, elimination order and solver for these cells and the given unknowns.
    fn ordered(
        &self,
        cells: &[[u32; 8]],
        dofs: &DofMap,
        equations: &Equations,
        backend: Backend,
    ) -> Result<(Gather, LinearSolver), LinearError> {
        let gather = Gather::new(cells, dofs, equations, backend.kind());
        let mut group = Vec::with_capacity(equations.len());
        let mut coordinates: Vec<[f64; 3]> = Vec::new();
        let mut last = usize::MAX;
        for &slot in &equations.slot_of {
            let (node, _) = dofs.node_of(slot as usize);
            if node != last {
                // A beam couples many nodes and has no position.
                let at_beam = slot as usize >= dofs.beam_start;
                coordinates.push(if at_beam {
                    [f64::NAN; 3]
                } else {
                    self.bulk.reference[node]
                });
                last = node;
            }
            group.push(coordinates.len() as u32 - 1);
        }
        let pattern = Pattern::new(gather.n, gather.col_ptr.clone(), gather.row_idx.clone())?
            .with_nodes(&group, &coordinates)?;
        let known = self.analysis.as_ref();
        let solver = LinearSolver::analyse_beside(pattern, Options::new(backend), known)?;
        Ok((gather, solver))
    }

    /// Factorises the symmetric matrix of the trial's cells in the given unknowns. Each diagonal entry is first
    /// increased by `part_of_own` times itself. Success proves that the matrix is positive definite.
    ///
    /// # Errors
    /// [`LinearError`] of the analysis or the factorisation.
    pub fn try_factor(
        &self,
        dofs: &DofMap,
        equations: &Equations,
        trial: &Trial,
        part_of_own: f64,
    ) -> Result<(), LinearError> {
        let (gather, mut solver, mut values) = self.apart(dofs, equations, trial)?;
        for at in gather.diagonal().flatten() {
            values[at] *= 1.0 + part_of_own;
        }
        solver.factorise(&values).map(|_| ())
    }

    /// The lowest modes with the symmetric matrix of the trial's cells as their stiffness.
    ///
    /// # Errors
    /// [`EigenError`].
    pub fn lowest_modes(
        &self,
        equations: &Equations,
        trial: &Trial,
        wanted: usize,
    ) -> Result<Lowest, EigenError> {
        let (_, mut solver, values) = self.apart(&self.dofs, equations, trial)?;
        lowest(&mut solver, &values, &self.mass_of(equations), wanted)
    }

    /// The lowest eigenvalue of the symmetric matrix of the trial's cells over its own diagonal.
    ///
    /// # Errors
    /// [`EigenError`].
    pub fn lowest_over_diagonal(
        &self,
        dofs: &DofMap,
        equations: &Equations,
        trial: &Trial,
    ) -> Result<Lowest, EigenError> {
        let (gather, mut solver, values) = self.apart(dofs, equations, trial)?;
        let diagonal = gather.diagonal().map(|at| at.map_or(0.0, |at| values[at]));
        let diagonal: Vec<f64> = diagonal.collect();
        let rounding = ROUNDING * diagonal.iter().copied().fold(0.0, f64::max);
        if let Some(equation) = diagonal.iter().position(|k| *k < -rounding) {
            return Err(LinearError::NotPositiveDefinite { equation }.into());
        }
        let own = MassMatrix {
            diagonal,
            below: Vec::new(),
        };
        lowest(&mut solver, &values, &own, 1)
    }

    /// Symmetric matrix of the trial's cells, with its pattern and a solver of its own.
    fn apart(
        &self,
        dofs: &DofMap,
        equations: &Equations,
        trial: &Trial,
    ) -> Result<(Gather, LinearSolver, Vec<f64>), LinearError> {
        let (gather, solver) =
            self.ordered(&self.cells(), dofs, equations, Backend::MultifrontalLlt)?;
        let mut values = vec![0.0; gather.row_idx.len()];
        gather.fill(
            &trial.cells.stiffness,
            &trial.cells.active,
            None,
            &mut values,
        );
        Ok((gather, solver, values))
    }

    /// Sums the cells into the matrix.
    pub fn fill(&self, trial: &Trial, values: &mut [f64]) {
        if let Some(gather) = &self.gather {
            gather.fill(&trial.cells.stiffness, &trial.cells.active, None, values);
        }
    }

    /// Sums the cells into a matrix that was filled from this pattern before, at filling `last`. Only entries
    /// with a contribution of a changed cell are summed again.
    pub fn refill(&mut self, trial: &mut Trial, last: &mut Option<u64>, values: &mut [f64]) {
        /// Each filling has its own number. It identifies the trial and the matrix that belong together, also
        /// after a rejected increment.
        static FILLINGS: AtomicU64 = AtomicU64::new(1);
        let Some(gather) = &self.gather else { return };
        let known = *last == Some(trial.cells.filling)
            && trial.cells.changed.len() == trial.cells.active.len();
        let changed = known.then_some(&trial.cells.changed[..]);
        if self.rigid.is_empty() {
            gather.fill(&trial.cells.stiffness, &trial.cells.active, changed, values);
        } else {
            self.rigid.fill(gather, trial, changed, values);
        }
        trial.cells.changed.clear();
        trial.cells.changed.resize(trial.cells.active.len(), false);
        trial.cells.filling = FILLINGS.fetch_add(1, Ordering::Relaxed);
        *last = Some(trial.cells.filling);
    }

    /// Node and direction of an equation of the matrix. A body stands under one of its nodes.
    pub(crate) fn node_of_equation(
        &self,
        equations: &Equations,
        equation: usize,
    ) -> (usize, usize) {
        let reduced = self.rigid.reduction();
        let (dofs, equations) = reduced.map_or((&self.dofs, equations), |reduced| {
            (&reduced.dofs, &reduced.equations)
        });
        dofs.node_of(equations.slot_of[equation] as usize)
    }

    /// Adds `factor` times the masses to the matrix of `equations`.
    pub fn add_mass(&self, equations: &Equations, factor: f64, values: &mut [f64]) {
        let Some(gather) = &self.gather else { return };
        self.add_diagonal(equations, factor, &self.mass.slot, values);
        (self.rigid).add_coupling(gather, factor, &self.mass, values);
        let couplings = self
            .couplings
            .get_or_init(|| self.couplings(equations, gather));
        for (value, coupling) in values.iter_mut().zip(couplings) {
            *value += factor * coupling;
        }
    }

    /// Masses that couple the nodes of elements. `[entry]`
    fn couplings(&self, equations: &Equations, gather: &Gather) -> Vec<f64> {
        let mut values = vec![0.0; gather.row_idx.len()];
        let of_slot = if self.rigid.is_empty() {
            let own = equations.of_slot.iter();
            own.map(|e| (*e != PRESCRIBED).then_some(*e as usize))
                .collect()
        } else {
            self.rigid.equations_of(self.dofs.slots)
        };
        self.mass.each_coupling(|row, column, mass| {
            if let (Some(row), Some(column)) = (of_slot[row], of_slot[column]) {
                gather.add(row, column, mass, &mut values);
            }
        });
        values
    }

    /// Masses of the equations [tonne].
    pub(crate) fn mass_of(&self, equations: &Equations) -> MassMatrix {
        let slots = equations.slot_of.iter().map(|&slot| slot as usize);
        let mut diagonal: Vec<f64> = slots.map(|slot| self.mass.slot[slot]).collect();
        let mut below = Vec::new();
        self.mass.each_coupling(|row, column, mass| {
            let [row, column] = [row, column].map(|slot| equations.of_slot[slot]);
            if row == column && row != PRESCRIBED {
                diagonal[row as usize] += mass;
            } else if row > column && row != PRESCRIBED {
                below.push((row, column, mass));
            }
        });
        MassMatrix { diagonal, below }
    }

    /// Adds `factor` times the given coefficients to the diagonal of the matrix of `equations`. `coefficients`:
    /// `[slot]`
    pub fn add_diagonal(
        &self,
        equations: &Equations,
        factor: f64,
        coefficients: &[f64],
        values: &mut [f64],
    ) {
        let Some(gather) = &self.gather else { return };
        if !self.rigid.is_empty() {
            (self.rigid).add_diagonal(gather, &self.dofs, factor, coefficients, values);
            return;
        }
        for (e, &slot) in equations.slot_of.iter().enumerate() {
            gather.add(e, e, factor * coefficients[slot as usize], values);
        }
    }
}
