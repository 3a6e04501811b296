//! Performance points: force and displacement of the curve at the drift limits of a code, or of the user.
//!
//! EN 1998-3:2005, annex C, gives the drift of primary unreinforced masonry walls at the limit state of significant
//! damage (C.4.2.1 and C.4.3.1): 0.008 H₀/D if flexure controls, 0.004 if shear does; near collapse is 4/3 of it. D is
//! the length of the wall in its plane, H₀ the distance between the section of the largest moment and the point of
//! contraflexure.

use serde::{Deserialize, Serialize};

use super::failure::FailureMode;
use crate::results::backbone::Backbone;

/// Drift of a primary wall in shear at significant damage [-].
pub const SHEAR: f64 = 0.004;
/// Drift of a primary wall in flexure at significant damage, times D/H₀ [-].
pub const FLEXURE: f64 = 0.008;
/// Drift at near collapse over that at significant damage [-].
pub const COLLAPSE: f64 = 4.0 / 3.0;

/// Limit state of a performance point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitState {
    /// Significant damage of EN 1998-3.
    SignificantDamage,
    /// Near collapse of EN 1998-3.
    NearCollapse,
    /// A drift that the user gives.
    Given,
}

impl LimitState {
    /// In words.
    pub fn told(self) -> &'static str {
        match self {
            Self::SignificantDamage => "significant damage",
            Self::NearCollapse => "near collapse",
            Self::Given => "given",
        }
    }
}

/// A point of the curve at a limit of drift.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct PerformancePoint {
    /// Limit state.
    pub limit_state: LimitState,
    /// Drift [-].
    pub drift: f64,
    /// Displacement of the drive [mm].
    pub displacement_mm: f64,
    /// Force there [kN]; `None` if the run did not get so far.
    pub force_kN: Option<f64>,
    /// Source of the limit.
    pub source: String,
}

/// Force and displacement at drifts that the user gives [-], with the clear height [mm].
pub fn at_drifts(side: &Backbone, height: f64, drifts: &[f64]) -> Vec<PerformancePoint> {
    let given = |drift: &f64| point(side, height, (LimitState::Given, *drift), "given");
    drifts.iter().map(given).collect()
}

/// Points at the limits of EN 1998-3 for the mode of failure. `slenderness` is H₀/D [-], which limits in flexure
/// need; without it they are left out.
pub fn of_code(
    side: &Backbone,
    height: f64,
    mode: FailureMode,
    slenderness: Option<f64>,
) -> Vec<PerformancePoint> {
    let flexure = || {
        let slenderness = slenderness?;
        let source =
            format!("EN 1998-3:2005, C.4.2.1, flexure: 0.008 H0/D, H0/D = {slenderness:.2}");
        Some((FLEXURE * slenderness, source))
    };
    let shear = || {
        let source = "EN 1998-3:2005, C.4.3.1, shear: 0.004".to_owned();
        Some((SHEAR, source))
    };
    let limit = if mode.is_shear() { shear() } else { flexure() };
    let Some((drift, source)) = limit else {
        return Vec::new();
    };
    let collapse = "EN 1998-3:2005, annex C: 4/3 of significant damage".to_owned();
    vec![
        point(
            side,
            height,
            (LimitState::SignificantDamage, drift),
            &source,
        ),
        point(
            side,
            height,
            (LimitState::NearCollapse, COLLAPSE * drift),
            &collapse,
        ),
    ]
}

fn point(
    side: &Backbone,
    height: f64,
    (limit_state, drift): (LimitState, f64),
    source: &str,
) -> PerformancePoint {
    let travel = drift * height;
    PerformancePoint {
        limit_state,
        drift,
        displacement_mm: side.displacement(travel),
        force_kN: side.force_at(travel).map(|along| side.force(along)),
        source: source.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Curve;
    use approx::assert_relative_eq;

    fn side() -> Backbone {
        let points = [(0.0, 0.0), (-2.0, -50.0), (-5.0, -40.0)];
        Backbone::of(&Curve::of_points(&points), false).unwrap()
    }

    #[test]
    fn limits_depend_on_the_mode() {
        let points = of_code(&side(), 1000.0, FailureMode::SteppedDiagonal, None);
        assert_eq!(points[0].displacement_mm, -4.0);
        // A few operations.
        assert_relative_eq!(
            points[0].force_kN.unwrap(),
            -130.0 / 3.0,
            max_relative = 1e-14
        );
        // 5.33 mm is beyond the end of the run.
        assert_relative_eq!(points[1].drift, 0.004 * 4.0 / 3.0, max_relative = 1e-14);
        assert_eq!(points[1].force_kN, None);
        let points = of_code(&side(), 1000.0, FailureMode::Rocking, Some(0.25));
        assert_relative_eq!(points[0].displacement_mm, -2.0, max_relative = 1e-14);
        assert!(of_code(&side(), 1000.0, FailureMode::Rocking, None).is_empty());
        let given = at_drifts(&side(), 1000.0, &[0.001, 0.002]);
        assert_eq!(given[0].force_kN, Some(-25.0));
        assert_eq!(given[1].limit_state, LimitState::Given);
    }
}
