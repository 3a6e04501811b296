//! Solids: forces and stiffness of all elements, in parallel. Each element writes to its own slot.

use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

use super::pattern::CELL;
pub use super::solid::{ElementSlot, Marks, element};
pub use super::stiffness_reuse::Kept;
use super::{Evaluation, Trial};
use crate::element::{ElementShape, ShapeError, extent};
use crate::material::{
    Curves, DamagePlasticity, Extent, LocalFailure, Material, MaterialHistory, MaterialParameters,
    PointEnergy, TableError,
};
use crate::model::Model;
use crate::state::State;

/// Treatment of the solids within an increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solids {
    /// Material law with its consistent tangent.
    Implicit,
    /// Material law with its secant stiffness (1−d) C₀, which is symmetric and positive definite.
    Secant,
    /// Material law with a symmetric stiffness that includes softening but stays positive definite
    /// (theory/equilibrium.md, eq. 5).
    Softened,
    /// Linear response about the trial's last update, with its viscous strain and damage.
    Held,
    /// Viscous strain and damage extrapolated by their last change times `ratio` = Δt/Δt_n (theory/equilibrium.md,
    /// eqs 19 and 20).
    Extrapolated {
        /// Δt/Δt_n.
        ratio: f64,
    },
}

/// An element or its material cannot be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BulkError {
    /// Bad geometry.
    #[error("element {element}: {why}")]
    Shape {
        /// Element.
        element: usize,
        /// Reason.
        why: ShapeError,
    },
    /// The tables do not fit the size of an element.
    #[error("material {material} in element {element} (l_eq = {l_eq:.1} mm): {why}")]
    Table {
        /// Name of the material.
        material: String,
        /// Element.
        element: usize,
        /// Its equivalent length [mm].
        l_eq: f64,
        /// Reason.
        why: TableError,
    },
}

impl BulkError {
    /// The same error with the number under which messages name the element.
    pub(crate) fn with_number(mut self, number: impl Fn(usize) -> usize) -> Self {
        let (Self::Shape { element, .. } | Self::Table { element, .. }) = &mut self;
        *element = number(*element);
        self
    }
}

/// Elements, their shapes and their material laws. Equal elements share both.
#[derive(Clone, Debug)]
pub struct Bulk {
    /// Connectivity. `[element]`
    pub elements: Vec<[u32; 8]>,
    /// Reference positions [mm]. `[node]`
    pub reference: Vec<[f64; 3]>,
    shapes: Vec<ElementShape>,
    shape_of: Vec<u32>,
    laws: Vec<Material>,
    pub(super) law_of: Vec<u32>,
    /// Whether an element belongs to a rigid body and has neither force nor stiffness. Empty without such bodies.
    /// `[element]`
    is_rigid: Vec<bool>,
    /// Number of elements. An element across a plane of symmetry counts in part.
    pub(super) count: f64,
}

/// Geometries that differ by less than this part of the element's size share one shape.
const SAME: f64 = 1e-9;

impl Bulk {
    /// Prepares the shapes and laws of a model.
    ///
    /// # Errors
    /// [`BulkError`], naming the element.
    pub fn new(model: &Model) -> Result<Self, BulkError> {
        let mesh = &model.mesh;
        let mut bulk = Self {
            elements: mesh.elements.clone(),
            reference: mesh.nodes.clone(),
            shapes: Vec::new(),
            shape_of: Vec::with_capacity(mesh.elements.len()),
            laws: Vec::new(),
            law_of: Vec::with_capacity(mesh.elements.len()),
            is_rigid: Vec::new(),
            count: 0.0,
        };
        let mut known: HashMap<(Vec<i64>, u16, u64), u32> = HashMap::new();
        // First element of each shape, its material and its extent.
        let mut extents: Vec<(usize, u16, Extent)> = Vec::new();
        for (e, &material) in mesh.material.iter().enumerate() {
            let corners = mesh.corners(e);
            let share = mesh.share(&mesh.elements[e]);
            bulk.count += share;
            let key = (shape_key(&corners), material, share.to_bits());
            let index = if let Some(&index) = known.get(&key) {
                index
            } else {
                let named = &model.materials[material as usize];
                let elastic = named.parameters.elastic();
                let shape = ElementShape::new(&corners, model.formulation, elastic)
                    .map_err(|why| BulkError::Shape { element: e, why })?;
                let extent = extent(&corners, shape.volume);
                extents.push((e, material, extent.unwrap_or(Extent::ball(shape.size))));
                bulk.shapes.push(shape.counted(share));
                let index = bulk.shapes.len() as u32 - 1;
                known.insert(key, index);
                index
            };
            bulk.shape_of.push(index);
            bulk.law_of.push(index);
        }
        let mut curves = MaterialCurves::default();
        for (element, material, extent) in &extents {
            let named = &model.materials[*material as usize];
            // Warnings of tables were reported when the model was built.
            let law = curves.law(*material, &named.parameters, *extent, &extents);
            bulk.laws.push(law.map_err(|why| BulkError::Table {
                material: named.name.clone(),
                element: *element,
                l_eq: extent.l_eq,
                why,
            })?);
        }
        Ok(bulk)
    }

    /// Sets the viscosity [s] and the largest rate of damage [1/s] of a step.
    pub fn stabilise(&mut self, viscosity: f64, damage_rate: f64) {
        for law in &mut self.laws {
            if let Material::DamagePlasticity(law) = law {
                law.stabilise(viscosity, damage_rate);
            }
        }
    }

    /// Whether a viscosity acts in any solid.
    pub fn is_viscous(&self) -> bool {
        self.laws
            .iter()
            .any(|law| matches!(law, Material::DamagePlasticity(law) if law.is_viscous()))
    }

    /// The laws without viscosity and without a bound on the rate of damage.
    pub(super) fn prompt_laws(&self) -> Vec<Material> {
        let mut laws = self.laws.clone();
        for law in &mut laws {
            if let Material::DamagePlasticity(law) = law {
                law.make_prompt();
            }
        }
        laws
    }

    /// Leaves out the elements of rigid bodies, and no others.
    pub(super) fn leave_out(&mut self, elements: impl Iterator<Item = usize>) {
        let mut elements = elements.peekable();
        self.is_rigid.clear();
        if elements.peek().is_some() {
            self.is_rigid = vec![false; self.elements.len()];
            elements.for_each(|e| self.is_rigid[e] = true);
        }
    }

    /// Whether an element belongs to a rigid body.
    pub(super) fn is_rigid(&self, e: usize) -> bool {
        self.is_rigid.get(e).is_some_and(|is_rigid| *is_rigid)
    }

    /// Shape of element `e`.
    pub fn shape(&self, e: usize) -> &ElementShape {
        &self.shapes[self.shape_of[e] as usize]
    }

    /// Law of element `e`.
    pub fn law(&self, e: usize) -> &Material {
        &self.laws[self.law_of[e] as usize]
    }

    /// Forces and, where asked for, stiffness of every element at the trial's positions.
    ///
    /// # Errors
    /// Number of the first element whose law found no solution, and the reason.
    pub fn evaluate(
        &self,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
    ) -> Result<(), (usize, LocalFailure)> {
        let n = self.elements.len();
        trial
            .solids
            .history
            .resize(8 * n, MaterialHistory::default());
        trial.solids.energy.resize(n, PointEnergy::default());
        if trial.solids.marks.len() != n {
            let records = state.material.par_chunks_exact(8);
            let pairs = records.zip(trial.solids.history.par_chunks_exact(8));
            trial.solids.marks = pairs.map(|(old, new)| Marks::of(old, new)).collect();
        }
        let keeps = setting.keeps(&state.poses, trial);
        if setting.tangent && !keeps {
            trial.cells.held.forget();
        }
        trial.cells.held.fit_solids(n);
        let (x, awake) = (&trial.x, trial.awake.as_ref());
        let failure = trial.cells.force[..n]
            .par_iter_mut()
            .zip(trial.cells.stiffness[..n * CELL].par_chunks_exact_mut(CELL))
            .zip(&mut trial.cells.changed[..n])
            .zip(trial.solids.history.par_chunks_exact_mut(8))
            .zip(trial.solids.energy.par_iter_mut())
            .zip(trial.solids.marks.par_iter_mut())
            .zip(trial.cells.held.solids.par_iter_mut())
            .enumerate()
            .with_min_len(16)
            .filter_map(
                |(e, ((((((force, cell), written), new), energy), marks), kept))| {
                    if awake.is_some_and(|awake| !awake.elements[e]) {
                        return None;
                    }
                    if self.is_rigid(e) {
                        *force = [[0.0; 3]; 8];
                        return None;
                    }
                    let shape = self.shape(e);
                    let law = &self.laws[self.law_of[e] as usize];
                    let positions = self.elements[e].map(|n| x[n as usize]);
                    let old = &state.material[8 * e..8 * e + 8];
                    let mut slot = ElementSlot {
                        force,
                        cell,
                        written,
                        new,
                        energy,
                        marks,
                        kept: keeps.then_some(kept),
                    };
                    element(shape, law, &positions, old, setting, &mut slot)
                        .err()
                        .map(|why| (e, why))
                },
            )
            .min_by_key(|(e, _)| *e);
        for (e, active) in trial.cells.active[..n].iter_mut().enumerate() {
            *active = !self.is_rigid(e);
        }
        failure.map_or(Ok(()), Err)
    }
}

/// Curves of materials whose crack bands have widths of their own. Elements of one material share a set of curves.
#[derive(Default)]
struct MaterialCurves {
    curves_of: HashMap<u16, Arc<Curves>>,
}

impl MaterialCurves {
    /// Law of a material in an element of this extent. `all`: elements, materials and extents of all shapes.
    fn law(
        &mut self,
        material: u16,
        parameters: &MaterialParameters,
        extent: Extent,
        all: &[(usize, u16, Extent)],
    ) -> Result<Material, TableError> {
        let MaterialParameters::DamagePlasticity(p) = parameters else {
            return Ok(Material::new(parameters, Some(extent.l_eq))?.0);
        };
        if !p.has_bands() {
            return Ok(Material::new(parameters, Some(extent.l_eq))?.0);
        }
        let curves = if let Some(curves) = self.curves_of.get(&material) {
            curves.clone()
        } else {
            let of_it = all.iter().filter(|(_, of, _)| *of == material);
            let widths = Extent::range(of_it.map(|(_, _, extent)| extent));
            let (curves, _) = Curves::of_bands(p, widths)?;
            self.curves_of.insert(material, curves.clone());
            curves
        };
        let law = DamagePlasticity::with(p, curves, extent);
        Ok(Material::DamagePlasticity(Box::new(law)))
    }
}

/// Coordinates relative to the first corner, in units of [`SAME`] times the element's size, and the exponent of that
/// size: elements that are similar, but not of one size, differ in it alone.
fn shape_key(corners: &[[f64; 3]; 8]) -> Vec<i64> {
    let size = (0..3)
        .map(|i| {
            let values = corners.map(|c| c[i]);
            values.iter().copied().fold(f64::MIN, f64::max)
                - values.iter().copied().fold(f64::MAX, f64::min)
        })
        .fold(0.0, f64::max);
    // Rounding up to a power of two gives the same unit to sizes that differ by rounding.
    let exponent = size.max(f64::MIN_POSITIVE).log2().ceil();
    let unit = SAME * exponent.exp2();
    let places = corners
        .iter()
        .flat_map(|c| (0..3).map(move |i| ((c[i] - corners[0][i]) / unit).round() as i64));
    std::iter::once(exponent as i64).chain(places).collect()
}
