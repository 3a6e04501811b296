//! Checks that any joint law should pass: consistent tangent, isotropy in the tangential plane, and energy balance.
//!
//! Each check follows a [`Path`] of gaps and returns an error that names the step at which the law fails.
//! [`Path::random`] generates paths that open, close, slide and change direction.

use std::error::Error;
use std::fmt;

use nalgebra::Vector3;

use crate::joint::JointLaw;
use crate::law::InterfaceHistory;

/// A path of gaps `[u, δ₁, δ₂]` [mm] that starts from zero. `[step]`
#[derive(Clone, Debug, PartialEq)]
pub struct Path(pub Vec<[f64; 3]>);

impl Path {
    /// A random walk of `steps` steps from a seed: openings of about `unit` [mm], closings down to about `closing`
    /// [mm], slips of about `unit` per step. The mean direction changes every six steps.
    pub fn random(seed: u64, steps: usize, unit: f64, closing: f64) -> Self {
        let mut state = seed;
        // splitmix64
        let mut signed = || {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let (mut at, mut drift) = ([0.0; 3], [0.0; 3]);
        let gaps = (0..steps).map(|step| {
            if step % 6 == 0 {
                drift = [0.5 * signed(), signed(), signed()];
            }
            for (at, drift) in at.iter_mut().zip(drift) {
                *at += drift + 0.3 * signed();
            }
            let scale = if at[0] > 0.0 { unit } else { closing };
            [at[0] * scale, at[1] * unit, at[2] * unit]
        });
        Self(gaps.collect())
    }

    /// The same path with every step divided into `parts` equal steps.
    #[must_use]
    pub fn divided(&self, parts: usize) -> Self {
        let (mut from, mut all) = ([0.0; 3], Vec::with_capacity(self.0.len() * parts));
        for to in &self.0 {
            for part in 1..=parts {
                let s = part as f64 / parts as f64;
                all.push([0, 1, 2].map(|i| from[i] + s * (to[i] - from[i])));
            }
            from = *to;
        }
        Self(all)
    }
}

/// A failed check.
#[derive(Clone, Debug, PartialEq)]
pub struct Failed {
    /// Name of the law.
    pub law: &'static str,
    /// The step of the path, from 0.
    pub step: usize,
    /// Its gap [mm].
    pub gap: [f64; 3],
    /// The wrong quantity with its values.
    pub what: String,
}

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [u, s1, s2] = self.gap;
        write!(
            f,
            "joint law {}: step {}, opening {u} mm, slip ({s1}, {s2}) mm: {}",
            self.law, self.step, self.what
        )
    }
}

impl Error for Failed {}

/// Follows a path and stops at a response that is not finite. `look` receives step, gap, old history and response.
fn walk(
    law: &dyn JointLaw,
    path: &Path,
    mut look: impl FnMut(
        usize,
        &[f64; 3],
        &InterfaceHistory,
        &crate::InterfaceResponse,
    ) -> Result<(), String>,
) -> Result<(), Failed> {
    let mut old = law.virgin();
    for (step, gap) in path.0.iter().enumerate() {
        let answer = law.update(*gap, &old);
        let fail = |what: String| Failed {
            law: law.name(),
            step,
            gap: *gap,
            what,
        };
        let h = &answer.history;
        let numbers = answer
            .traction
            .iter()
            .chain(&h.slots)
            .chain(&h.plastic_slip);
        if !numbers.chain(answer.tangent.iter()).all(|n| n.is_finite()) {
            return Err(fail(format!(
                "traction {:?}, tangent {:?} or history is not finite",
                answer.traction, answer.tangent.data.0
            )));
        }
        look(step, gap, &old, &answer).map_err(fail)?;
        old = answer.history;
    }
    Ok(())
}

/// Result of [`tangent`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tangents {
    /// Columns that were compared.
    pub columns: usize,
    /// Columns at corners of the law, where only a one-sided difference agrees.
    pub corners: usize,
}

/// Compares the tangent with finite differences of the traction over `h` [mm]. At corners of the law one of the
/// one-sided differences must agree. `tolerance` is relative to the larger elastic stiffness.
///
/// # Errors A column that agrees neither with the central difference nor with a one-sided difference.
pub fn tangent(
    law: &dyn JointLaw,
    path: &Path,
    h: f64,
    tolerance: f64,
) -> Result<Tangents, Failed> {
    let mut found = Tangents::default();
    let [k_n, k_s] = law.stiffness();
    let scale = k_n.max(k_s);
    walk(law, path, |_, gap, old, answer| {
        for j in 0..3 {
            let side = |s: f64| {
                let mut at = *gap;
                at[j] += s * h;
                Vector3::from(law.update(at, old).traction)
            };
            let (up, down, here) = (side(1.0), side(-1.0), Vector3::from(answer.traction));
            let column = answer.tangent.column(j).into_owned();
            let off = |difference: Vector3<f64>| (difference - column).amax() / scale;
            let central = off((up - down) / (2.0 * h));
            let one = off((up - here) / h).min(off((here - down) / h));
            found.columns += 1;
            if central > tolerance {
                found.corners += 1;
                // The error of a one-sided difference is of first order.
                if one.is_nan() || one > 10.0 * tolerance {
                    let most = central.min(one);
                    return Err(format!(
                        "column {j} of the tangent {column:?} is off by {most:.1e} of the stiffness"
                    ));
                }
            }
        }
        Ok(())
    })?;
    Ok(found)
}

/// Follows the path rotated in the tangential plane by `angle` [rad], once plain and once mirrored, and compares the
/// responses.
///
/// # Errors A traction that differs by more than `tolerance` times the largest traction of the path, or a slot that
/// differs by more than `tolerance` times the largest slot.
pub fn objectivity(
    law: &dyn JointLaw,
    path: &Path,
    angle: f64,
    tolerance: f64,
) -> Result<(), Failed> {
    let (s, c) = angle.sin_cos();
    for sign in [1.0, -1.0] {
        let turn = |[n, a, b]: [f64; 3]| [n, c * a - s * b, sign * (s * a + c * b)];
        let mut turned = law.virgin();
        let (mut most, mut most_slot) = (f64::MIN_POSITIVE, f64::MIN_POSITIVE);
        walk(law, path, |_, gap, _, answer| {
            let other = law.update(turn(*gap), &turned);
            turned = other.history;
            let expected = turn(answer.traction);
            for i in 0..3 {
                most = most.max(expected[i].abs());
            }
            for slot in answer.history.slots {
                most_slot = most_slot.max(slot.abs());
            }
            let off = |a: &[f64], b: &[f64]| {
                let pairs = a.iter().zip(b);
                pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            if off(&expected, &other.traction) > tolerance * most {
                return Err(format!(
                    "the traction {:?} turned is {expected:?}, that of the turned gap is {:?}",
                    answer.traction, other.traction
                ));
            }
            let (own, its) = (&answer.history.slots, &other.history.slots);
            if off(own, its) > tolerance * most_slot {
                return Err(format!(
                    "slots {own:?} become {its:?} where the gap is turned"
                ));
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// Checks that in every step the work of the tractions (trapezoidal rule) equals the change of free energy plus
/// dissipation plus crossing work, and that the dissipation is not negative. The path should have small steps.
///
/// Returns work and dissipation of the path [N/mm].
///
/// # Errors A step whose balance error exceeds `tolerance` times the largest energy of the path so far, or whose
/// dissipation is more negative than that.
pub fn dissipation(law: &dyn JointLaw, path: &Path, tolerance: f64) -> Result<[f64; 2], Failed> {
    let mut at = [0.0; 3];
    let (mut stored, mut work, mut lost) = (law.free_energy(&law.virgin()), 0.0, 0.0);
    let mut largest = f64::MIN_POSITIVE;
    walk(law, path, |_, gap, old, answer| {
        let step: f64 = (0..3)
            .map(|i| 0.5 * (old.traction[i] + answer.traction[i]) * (gap[i] - at[i]))
            .sum();
        let now = law.free_energy(&answer.history);
        let crossing = law.crossing_work(old, &answer.history);
        let open = step - (now - stored) - answer.dissipation - crossing;
        (at, stored) = (*gap, now);
        work += step;
        lost += answer.dissipation;
        largest = largest.max(now).max(lost).max(work.abs());
        if open.abs() > tolerance * largest {
            return Err(format!(
                "the energies of the step are open by {open:.2e} N/mm: work {step:.2e}, dissipation {:.2e}",
                answer.dissipation
            ));
        }
        if answer.dissipation < -tolerance * largest {
            return Err(format!("it dissipates {:.2e} N/mm", answer.dissipation));
        }
        Ok(())
    })?;
    Ok([work, lost])
}
