//! The point driver: one implicit step per row, with prescribed strains, or with strains found for prescribed
//! stresses.
//!
//! Some components are driven by strain, the others (free, index f) by stress. A step solves
//!
//! r_f = σ_f(ε) − σ̂_f = 0,   Δε_f = −D_ff⁻¹ r_f
//!
//! with the consistent tangent D of the law. If Newton's method fails, the search approaches the target in smaller
//! parts. The history always takes a single step from the old to the new state. If the parts become too small, the
//! stresses cannot be reached: the point is at its strength.

use std::num::NonZeroUsize;

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::{Layout, Record, Row, Target};
use crate::material::LocalFailure;

/// Largest |σ_f − σ̂_f| [MPa]. Rounding leaves about 1e-14 MPa, since stresses of some 10 MPa come from strains times
/// 10⁴ MPa.
const TOLERANCE: f64 = 1e-10;
const ITERATIONS: usize = 50;
/// Largest number of halvings of one Newton step.
const HALVINGS: i32 = 12;
/// Smallest part of the path to the target that is tried, 2⁻³⁶.
const LEAST_PART: f64 = 1.0 / (1_u64 << 36) as f64;

/// Response of a law to a strain.
#[derive(Clone, Copy, Debug)]
pub struct Answer<const N: usize, H> {
    /// Stress or traction [MPa].
    pub stress: SVector<f64, N>,
    /// Derivative of the stress by the strain, or of the traction by the gap.
    pub tangent: SMatrix<f64, N, N>,
    /// History at the end of the step.
    pub history: H,
}

/// A point between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<const N: usize, H> {
    /// Strain or gap.
    pub strain: SVector<f64, N>,
    /// Stress or traction [MPa].
    pub stress: SVector<f64, N>,
    /// History.
    pub history: H,
    /// Time [s].
    pub time: f64,
}

impl<const N: usize, H> State<N, H> {
    /// Initial state at zero strain and stress.
    pub fn at_rest(history: H) -> Self {
        Self {
            strain: SVector::zeros(),
            stress: SVector::zeros(),
            history,
            time: 0.0,
        }
    }
}

/// Reason why a row has no result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointFailure<const N: usize> {
    /// The law returned an error.
    Law(LocalFailure),
    /// No strain gives the prescribed stresses; the limit is the last state that was reached.
    Beyond(Limit<N>),
    /// A target is not a finite number.
    NotFinite {
        /// Index of the component, from 0.
        component: usize,
    },
    /// The row ends before it begins, or its time is not finite.
    Time {
        /// Time of the point [s].
        from: f64,
        /// Time of the row [s].
        to: f64,
    },
}

/// The last state at which the prescribed stresses were reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit<const N: usize> {
    /// Fraction of the row.
    pub fraction: f64,
    /// Stress or traction at this state [MPa].
    pub stress: SVector<f64, N>,
}

impl<const N: usize> From<LocalFailure> for PointFailure<N> {
    fn from(why: LocalFailure) -> Self {
        Self::Law(why)
    }
}

impl<const N: usize> PointFailure<N> {
    /// Description of the failure with the names of the columns.
    pub fn explain(&self, row: &Row<N>, layout: &Layout<N>) -> String {
        let limit = match self {
            Self::Law(why) => return format!("the law has no answer: {why}"),
            Self::NotFinite { component } => {
                let name = layout.components[*component];
                return format!("the prescribed value of {name} is not finite");
            }
            Self::Time { from, to } => return format!("time runs backwards, from {from} to {to}"),
            Self::Beyond(limit) => limit,
        };
        let (mut missed, mut held) = (Vec::new(), Vec::new());
        for (i, name) in layout.stresses.iter().enumerate() {
            let Target::Stress(asked) = row.targets[i] else {
                continue;
            };
            let reached = limit.stress[i];
            if (asked - reached).abs() > 1e-9 * asked.abs().max(1.0) {
                let (asked, reached) = (short(asked), short(reached));
                missed.push(format!("{name} = {asked} asked, {reached} reached"));
            } else if asked != 0.0 {
                held.push(format!("{name} = {} held", short(asked)));
            }
        }
        missed.append(&mut held);
        let said = if missed.is_empty() {
            "all stresses held at 0".to_owned()
        } else {
            missed.join(", ")
        };
        format!(
            "beyond the strength: no strain gives this stress ({said}; {:.2} % of the way through \
             the row)",
            100.0 * limit.fraction
        )
    }
}

/// The number with seven digits.
fn short(value: f64) -> String {
    let rounded = format!("{value:.6e}").parse::<f64>().unwrap_or(value);
    format!("{rounded:?}")
}

/// Drives the point through one row in `substeps` implicit steps. Targets and time change linearly from the state of
/// the point. Allocates only if a stress is prescribed.
///
/// # Errors
/// [`PointFailure`]: the law has no solution, or no strain gives the prescribed stresses.
pub fn advance<const N: usize, H: Copy>(
    law: &impl Fn(&SVector<f64, N>, &H, f64) -> Result<Answer<N, H>, LocalFailure>,
    from: &State<N, H>,
    row: &Row<N>,
    substeps: NonZeroUsize,
) -> Result<Record<N, H>, PointFailure<N>> {
    let substeps = substeps.get();
    let dt = (row.time - from.time) / substeps as f64;
    let mut state = *from;
    let mut tangent = SMatrix::zeros();
    for k in 1..=substeps {
        let targets = between(from, &row.targets, k as f64 / substeps as f64);
        let update = |strain: &SVector<f64, N>| law(strain, &state.history, dt);
        let (strain, answer) =
            step(&update, &state, &targets).map_err(|failure| match failure {
                // Convert the fraction of the substep to that of the row.
                PointFailure::Beyond(limit) => PointFailure::Beyond(Limit {
                    fraction: ((k - 1) as f64 + limit.fraction) / substeps as f64,
                    ..limit
                }),
                _ => failure,
            })?;
        state = State {
            strain,
            stress: answer.stress,
            history: answer.history,
            time: if k == substeps {
                row.time
            } else {
                state.time + dt
            },
        };
        tangent = answer.tangent;
    }
    Ok(Record { state, tangent })
}

/// Targets at the fraction `t` between state and row.
fn between<const N: usize, H>(from: &State<N, H>, targets: &[Target; N], t: f64) -> [Target; N] {
    std::array::from_fn(|i| match targets[i] {
        // At the end use the target of the row exactly.
        target if t == 1.0 => target,
        Target::Strain(e) => Target::Strain(from.strain[i] + t * (e - from.strain[i])),
        Target::Stress(s) => Target::Stress(from.stress[i] + t * (s - from.stress[i])),
    })
}

/// A strain that gives the prescribed stresses, and the response of the law to it.
type Found<const N: usize, H> = (SVector<f64, N>, Answer<N, H>);

/// One implicit step. The search first tries the whole target. If it fails, it approaches the target in parts that
/// shrink after a failure and grow after a success. If the parts become too small, the stresses cannot be reached.
fn step<const N: usize, H: Copy>(
    update: &impl Fn(&SVector<f64, N>) -> Result<Answer<N, H>, LocalFailure>,
    from: &State<N, H>,
    targets: &[Target; N],
) -> Result<Found<N, H>, PointFailure<N>> {
    let mut limit = Limit {
        fraction: 0.0,
        stress: from.stress,
    };
    let (mut strain, mut part) = (from.strain, 1.0);
    loop {
        // The parts are binary fractions, so that their sum is exactly 1 at the end.
        let t = limit.fraction + part;
        match search(update, strain, &between(from, targets, t)) {
            Ok(Some(found)) if t == 1.0 => return Ok(found),
            Ok(Some((found, answer))) => {
                strain = found;
                limit = Limit {
                    fraction: t,
                    stress: answer.stress,
                };
                // A doubled part must not pass 1 and must stay on its own binary grid.
                while part < 1.0 - t && (t / (2.0 * part)).fract() == 0.0 {
                    part *= 2.0;
                }
            }
            Err(why) if part <= LEAST_PART => return Err(why.into()),
            Ok(None) if part <= LEAST_PART => return Err(PointFailure::Beyond(limit)),
            _ => part *= 0.5,
        }
    }
}

/// Newton's method with step halving from `strain`; `None` if it does not converge.
fn search<const N: usize, H: Copy>(
    update: &impl Fn(&SVector<f64, N>) -> Result<Answer<N, H>, LocalFailure>,
    mut strain: SVector<f64, N>,
    targets: &[Target; N],
) -> Result<Option<Found<N, H>>, LocalFailure> {
    let free: Vec<(usize, f64)> = (0..N)
        .filter_map(|i| match targets[i] {
            Target::Strain(e) => {
                strain[i] = e;
                None
            }
            Target::Stress(s) => Some((i, s)),
        })
        .collect();
    let residual = |answer: &Answer<N, H>| {
        DVector::from_iterator(free.len(), free.iter().map(|&(i, s)| answer.stress[i] - s))
    };
    let mut answer = update(&strain)?;
    if free.is_empty() {
        return Ok(Some((strain, answer)));
    }
    let mut r = residual(&answer);
    for _ in 0..ITERATIONS {
        if r.amax() == 0.0 {
            break;
        }
        let tangent = DMatrix::from_fn(free.len(), free.len(), |a, b| {
            answer.tangent[(free[a].0, free[b].0)]
        });
        let Some(direction) = tangent.lu().solve(&r) else {
            break;
        };
        // Within the tolerance only full steps are tried, because rounding is reached soon.
        let halvings = if r.amax() <= TOLERANCE { 0 } else { HALVINGS };
        let better = (0..=halvings).find_map(|halving| {
            let mut trial = strain;
            for (a, &(i, _)) in free.iter().enumerate() {
                trial[i] -= 0.5_f64.powi(halving) * direction[a];
            }
            let new = update(&trial).ok()?;
            let new_r = residual(&new);
            // A comparison with NaN is false.
            (new_r.norm() < r.norm()).then_some((trial, new, new_r))
        });
        match better {
            Some(better) => (strain, answer, r) = better,
            None => break,
        }
    }
    Ok((r.amax() <= TOLERANCE).then_some((strain, answer)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    /// A stiff spring and a hardening spring that yields at 1 MPa, weakly coupled. The history is the elapsed time.
    fn law(strain: &Vector2<f64>, passed: &f64, dt: f64) -> Result<Answer<2, f64>, LocalFailure> {
        let (stiff, hardened) = (1000.0, 10.0);
        let trial = stiff * strain[1];
        let (second, slope) = if trial.abs() > 1.0 {
            (
                trial.signum() + hardened * (strain[1] - trial.signum() / stiff),
                hardened,
            )
        } else {
            (trial, stiff)
        };
        Ok(Answer {
            stress: Vector2::new(
                stiff * strain[0] + 5.0 * strain[1],
                second + 5.0 * strain[0],
            ),
            tangent: Matrix2::new(stiff, 5.0, 5.0, slope),
            history: passed + dt,
        })
    }

    fn steps(n: usize) -> NonZeroUsize {
        NonZeroUsize::new(n).unwrap()
    }

    fn row(time: f64, targets: [Target; 2]) -> Row<2> {
        Row { time, targets }
    }

    #[test]
    fn prescribed_strains_and_stresses_are_reached() {
        let targets = [Target::Strain(0.01), Target::Stress(3.0)];
        let state = advance(&law, &State::at_rest(0.0), &row(2.0, targets), steps(1))
            .unwrap()
            .state;
        assert_eq!(state.strain[0], 0.01);
        assert!((state.stress[1] - 3.0).abs() <= TOLERANCE);
        // 3 = 1 + 10 (e − 0.001) + 0.05
        assert!((state.strain[1] - 0.196).abs() < 1e-11); // TOLERANCE over the slope of 10
        assert_eq!((state.history, state.time), (2.0, 2.0));
    }

    #[test]
    fn substeps_divide_the_path_and_the_time() {
        let targets = [Target::Strain(0.01), Target::Stress(3.0)];
        let from = State::at_rest(0.0);
        let once = advance(&law, &from, &row(2.0, targets), steps(1))
            .unwrap()
            .state;
        let often = advance(&law, &from, &row(2.0, targets), steps(4))
            .unwrap()
            .state;
        // The law has no memory: both ends agree within the tolerance of the search divided by the slope.
        assert!((often.strain - once.strain).amax() < 1e-10);
        assert!((often.history - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_stress_beyond_the_strength_is_rejected() {
        let perfect = |strain: &Vector2<f64>, h: &f64, _dt: f64| {
            let trial = 1000.0 * strain[1];
            let elastic = trial.abs() <= 1.0;
            Ok(Answer {
                stress: Vector2::new(strain[0], if elastic { trial } else { trial.signum() }),
                tangent: Matrix2::new(1.0, 0.0, 0.0, if elastic { 1000.0 } else { 0.0 }),
                history: *h,
            })
        };
        let targets = [Target::Strain(0.0), Target::Stress(1.5)];
        let failure =
            advance(&perfect, &State::at_rest(0.0), &row(1.0, targets), steps(1)).unwrap_err();
        let PointFailure::Beyond(limit) = failure else {
            panic!("{failure:?}")
        };
        // The path to 1.5 MPa ends at 1 MPa. Bisection leaves 2^-36 of the path, the tolerance is 1e-10 MPa.
        assert!((limit.fraction - 1.0 / 1.5).abs() < 1e-9, "{limit:?}");
        assert!((limit.stress[1] - 1.0).abs() < 1e-9, "{limit:?}");
    }
}
