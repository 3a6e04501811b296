//! A point driven along a whole path, row by row.

use std::num::NonZeroUsize;

use nalgebra::{Matrix3, SMatrix, SVector, Vector3, Vector6};
use wythe_contact::{InterfaceHistory, JointLaw};

use super::search::{Answer, PointFailure, State, advance};
use super::{Row, Target};
use crate::material::{LocalFailure, Material, MaterialHistory, SolidLaw};

/// Result of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record<const N: usize, H> {
    /// State at the end of the row.
    pub state: State<N, H>,
    /// Consistent tangent of the last implicit step, dσ/dε [MPa] or dt/dg [N/mm³], for all components, whether driven
    /// by strain or by stress; unsymmetric in general. `[of][by]`
    pub tangent: SMatrix<f64, N, N>,
}

/// A row of a prescribed path of strains or gaps at which the law or its path failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowFailure<const N: usize> {
    /// Number of the row, from 0.
    pub row: usize,
    /// The reason.
    pub why: PointFailure<N>,
}

/// Results of a whole path.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk<const N: usize, H> {
    /// Results of the completed rows.
    pub records: Vec<Record<N, H>>,
    /// The failed row, if any.
    pub failure: Option<RowFailure<N>>,
}

/// Drives a point along `rows`, each in `substeps` implicit steps, and passes each result to `take` with the number
/// of its row. Returns the final state.
///
/// # Errors
/// [`RowFailure`]: a target or a time is not finite, time decreases, the law has no solution, or the
/// stresses exceed the strength. The rows before it have been passed to `take`.
pub fn follow<const N: usize, H: Copy>(
    law: &impl Fn(&SVector<f64, N>, &H, f64) -> Result<Answer<N, H>, LocalFailure>,
    from: State<N, H>,
    rows: &[Row<N>],
    substeps: NonZeroUsize,
    mut take: impl FnMut(usize, &Record<N, H>),
) -> Result<State<N, H>, RowFailure<N>> {
    let mut state = from;
    for (index, row) in rows.iter().enumerate() {
        let answer = sound(row, state.time).and_then(|()| advance(law, &state, row, substeps));
        let record = answer.map_err(|why| RowFailure { row: index, why })?;
        take(index, &record);
        state = record.state;
    }
    Ok(state)
}

/// Checks that a row is valid for a point at the time `from` [s].
fn sound<const N: usize>(row: &Row<N>, from: f64) -> Result<(), PointFailure<N>> {
    let finite = |target: &Target| match target {
        Target::Strain(value) | Target::Stress(value) => value.is_finite(),
    };
    if let Some(component) = row.targets.iter().position(|target| !finite(target)) {
        return Err(PointFailure::NotFinite { component });
    }
    if !row.time.is_finite() || row.time < from {
        let to = row.time;
        return Err(PointFailure::Time { from, to });
    }
    Ok(())
}

/// [`follow`] for a solid law; strains and stresses in engineering Voigt notation.
///
/// # Errors
/// As [`follow`].
pub fn follow_material(
    law: &Material,
    from: State<6, MaterialHistory>,
    rows: &[Row<6>],
    substeps: NonZeroUsize,
    take: impl FnMut(usize, &Record<6, MaterialHistory>),
) -> Result<State<6, MaterialHistory>, RowFailure<6>> {
    let update = |strain: &Vector6<f64>, old: &MaterialHistory, dt| {
        let response = law.update(strain, old, dt, true)?;
        Ok(Answer {
            stress: response.stress,
            tangent: response.tangent,
            history: response.history,
        })
    };
    follow(&update, from, rows, substeps, take)
}

/// [`follow`] for a joint law: opening and two slips [mm], normal and two shear tractions [MPa].
///
/// # Errors
/// As [`follow`]; the law itself has a response to every finite gap.
pub fn follow_interface(
    law: &(impl JointLaw + ?Sized),
    from: State<3, InterfaceHistory>,
    rows: &[Row<3>],
    substeps: NonZeroUsize,
    take: impl FnMut(usize, &Record<3, InterfaceHistory>),
) -> Result<State<3, InterfaceHistory>, RowFailure<3>> {
    let update = |gap: &Vector3<f64>, old: &InterfaceHistory, _dt| {
        let response = law.update((*gap).into(), old);
        let (stress, tangent): (Vector3<f64>, Matrix3<f64>) =
            (response.traction.into(), response.tangent);
        Ok(Answer {
            stress,
            tangent,
            history: response.history,
        })
    };
    follow(&update, from, rows, substeps, take)
}

/// A material point driven along a whole path from its initial state.
pub fn material_path(
    law: &Material,
    rows: &[Row<6>],
    substeps: NonZeroUsize,
) -> Walk<6, MaterialHistory> {
    let from = State::at_rest(MaterialHistory::default());
    let mut records = Vec::with_capacity(rows.len());
    let take = |_, record: &_| records.push(*record);
    let failure = follow_material(law, from, rows, substeps, take).err();
    Walk { records, failure }
}

/// An interface point driven along a whole path from its initial state.
pub fn interface_path(
    law: &(impl JointLaw + ?Sized),
    rows: &[Row<3>],
    substeps: NonZeroUsize,
) -> Walk<3, InterfaceHistory> {
    let from = State::at_rest(law.virgin());
    let mut records = Vec::with_capacity(rows.len());
    let take = |_, record: &_| records.push(*record);
    let failure = follow_interface(law, from, rows, substeps, take).err();
    Walk { records, failure }
}

/// State variables of a material point in the results, in the order of [`MATERIAL`](super::MATERIAL): hardening κ_t,
/// κ_c, damage d_t, d_c, d [-].
pub fn material_state(history: &MaterialHistory) -> [f64; 5] {
    [
        history.kappa_t,
        history.kappa_c,
        history.tensile_damage,
        history.compressive_damage,
        history.damage,
    ]
}

/// State variables of an interface point in the results, in the order of [`INTERFACE`](super::INTERFACE): damage D
/// [-].
pub fn interface_state(history: &InterfaceHistory) -> [f64; 1] {
    [history.damage]
}

/// State variables of a material point followed by the outputs of its law, in the order of
/// [`material_layout`](super::material_layout).
pub fn material_outputs(law: &dyn SolidLaw, history: &MaterialHistory) -> Vec<f64> {
    let outputs = law.outputs().iter().map(|output| output.slot.of(history));
    material_state(history).into_iter().chain(outputs).collect()
}

/// State variables of an interface point followed by the outputs of its law, in the order of
/// [`interface_layout`](super::interface_layout).
pub fn interface_outputs(law: &(impl JointLaw + ?Sized), history: &InterfaceHistory) -> Vec<f64> {
    let outputs = law.outputs().iter().map(|output| output.of(history));
    interface_state(history)
        .into_iter()
        .chain(outputs)
        .collect()
}

#[cfg(test)]
mod tests;
