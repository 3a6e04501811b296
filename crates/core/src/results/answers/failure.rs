//! Mode of failure of a wall that is pushed sideways, by a rule that looks at its joints and units.
//!
//! The rule follows that of the blind predictions (docs/validation/11-blind/rule.md), which names the mode of 85 % of
//! 74 tests rightly; docs/reference/files.md lists the differences. It is looked up in this order:
//!
//! 1. *bed sliding*: the mean slip of a bed joint exceeds [`SLIDES`] of the displacement of the top, and [`OPEN`];
//! 2. *shear along a diagonal*: in at least [`CUT`] of the courses within the middle half of the height a head joint
//!    is open by more than [`OPEN`] or a unit is cracked (tensile damage above [`BROKEN`]), and the force has fallen.
//!    It is *mixed*, with flexure, if at the largest force the resultant in the lowest bed joint lies beyond
//!    [`TIPS`] of half its length; otherwise *diagonal through units* if units are cracked in more than half of
//!    these courses, else *stepped diagonal*;
//! 3. flexure: *toe crushing* if a solid is crushed (compressive damage above 0.25) and the force has fallen, else
//!    *rocking* if a bed joint is open by more than [`OPEN`], or a head joint or unit as in 2.
//!
//! All but the eccentricity are those of the last frame; of a drive to and fro, of the frame where it is farthest from
//! its start, the last one of them. The eccentricity stands for the largest force over the limit
//! of a rigid block, N L/(2 H₀): the moment at the base is V H₀ = N e.

use serde::{Deserialize, Serialize};

use super::scene::{Lie, Scene};
use crate::results::Snapshot;
use crate::state::CRUSHED;

/// Slip of a bed joint over the displacement of the top from which the joint slides [-].
pub const SLIDES: f64 = 0.5;
/// Part of the inner courses that a diagonal cuts [-].
pub const CUT: f64 = 0.7;
/// Opening from which a joint is open [mm].
pub const OPEN: f64 = 0.1;
/// Tensile damage from which a unit is cracked through [-].
pub const BROKEN: f64 = 0.9;
/// Eccentricity over half the length from which the wall tips as well [-].
pub const TIPS: f64 = 0.95;

/// Mode of failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureMode {
    /// Bed joints open, and the wall turns about its toe.
    Rocking,
    /// The toe is crushed, and the force falls.
    ToeCrushing,
    /// A bed joint slides.
    BedSliding,
    /// A diagonal crack through head and bed joints.
    SteppedDiagonal,
    /// A diagonal crack through units.
    DiagonalUnits,
    /// A diagonal crack at the limit of rocking.
    Mixed,
}

impl FailureMode {
    /// In words.
    pub fn told(self) -> &'static str {
        match self {
            Self::Rocking => "rocking",
            Self::ToeCrushing => "toe crushing",
            Self::BedSliding => "sliding along a bed joint",
            Self::SteppedDiagonal => "stepped diagonal cracking",
            Self::DiagonalUnits => "diagonal cracking through units",
            Self::Mixed => "diagonal cracking and rocking",
        }
    }

    /// Whether it is a failure in shear.
    pub fn is_shear(self) -> bool {
        !matches!(self, Self::Rocking | Self::ToeCrushing)
    }
}

/// Quantities by which the mode is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct FailureMeasure {
    /// Largest mean slip of a bed joint over the displacement of the top [-].
    pub slip_over_drift: f64,
    /// Height of this joint [mm]; `None` without bed joints.
    pub height_of_slip_mm: Option<f64>,
    /// Number of courses within the middle half of the height.
    pub inner_courses: usize,
    /// Number of them with an open head joint.
    pub courses_with_open_heads: usize,
    /// Number of them with a cracked unit.
    pub courses_with_cracked_units: usize,
    /// Number of them with either.
    pub cut_courses: usize,
    /// Eccentricity of the resultant in the lowest bed joint over half its length at the largest force [-].
    pub eccentricity: Option<f64>,
    /// Largest opening of a bed joint [mm].
    pub bed_opening_mm: f64,
    /// Largest compressive damage [-].
    pub compressive_damage: f64,
    /// Whether the force has fallen from its peak, or the structure has collapsed.
    pub force_lost: bool,
}

impl FailureMeasure {
    /// Measures the last frame, of which the top has moved by `travel` [mm].
    pub fn of(scene: &Scene, last: &Snapshot, travel: f64, force_lost: bool) -> Self {
        let damage = |e: &usize| last.frame.compressive_damage[*e];
        let mut measure = Self {
            force_lost,
            inner_courses: scene.inner.len(),
            compressive_damage: scene.solids.iter().map(damage).fold(0.0, f64::max),
            ..Self::default()
        };
        measure.add_beds(scene, last, travel);
        measure.add_courses(scene, last);
        measure
    }

    fn add_beds(&mut self, scene: &Scene, last: &Snapshot, travel: f64) {
        let joints = &last.frame.interfaces;
        for bed in &scene.beds {
            let slips = bed
                .iter()
                .map(|p| joints.slip[*p][0].hypot(joints.slip[*p][1]));
            let slip = slips.sum::<f64>() / bed.len() as f64;
            // A joint that has slid by less than an open one is open has not failed.
            let over = if travel > 0.0 && slip > OPEN {
                slip / travel
            } else {
                0.0
            };
            if self.height_of_slip_mm.is_none() || over > self.slip_over_drift {
                self.slip_over_drift = over;
                self.height_of_slip_mm = Some(scene.points[bed[0]].middle[2]);
            }
            let opening = bed.iter().map(|p| joints.opening[*p]);
            self.bed_opening_mm = opening.fold(self.bed_opening_mm, f64::max);
        }
    }

    fn add_courses(&mut self, scene: &Scene, last: &Snapshot) {
        let frame = &last.frame;
        for course in &scene.inner {
            let [low, high] = course.levels;
            let mut points = scene.points.iter().zip(&frame.interfaces.opening);
            let open = points.any(|(point, opening)| {
                let inside = point.middle[2] > low && point.middle[2] < high;
                point.lie == Lie::Head && inside && *opening > OPEN
            });
            let broken = |e: &usize| frame.tensile_damage[*e] > BROKEN;
            let cracked = course.units.iter().any(broken);
            self.courses_with_open_heads += usize::from(open);
            self.courses_with_cracked_units += usize::from(cracked);
            self.cut_courses += usize::from(open || cracked);
        }
    }

    /// Adds the eccentricity at the largest force.
    pub fn add_peak(&mut self, scene: &Scene, peak: &Snapshot) {
        self.eccentricity = Base::of(scene, peak).map(|base| base.eccentricity);
    }

    /// The mode; `None` if nothing failed.
    pub fn mode(&self) -> Option<FailureMode> {
        if self.slip_over_drift > SLIDES {
            return Some(FailureMode::BedSliding);
        }
        let is_cut =
            self.inner_courses > 0 && self.cut_courses as f64 >= CUT * self.inner_courses as f64;
        if is_cut && self.force_lost {
            let tips = self.eccentricity.is_some_and(|e| e >= TIPS);
            let units = 2 * self.courses_with_cracked_units > self.cut_courses;
            return Some(match (tips, units) {
                (true, _) => FailureMode::Mixed,
                (false, true) => FailureMode::DiagonalUnits,
                (false, false) => FailureMode::SteppedDiagonal,
            });
        }
        if self.compressive_damage > CRUSHED && self.force_lost {
            return Some(FailureMode::ToeCrushing);
        }
        (self.bed_opening_mm > OPEN || is_cut).then_some(FailureMode::Rocking)
    }
}

/// Forces in the lowest bed joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base {
    /// Normal force, compression positive [N].
    pub normal: f64,
    /// Length along the drive [mm].
    pub length: f64,
    /// Eccentricity of the normal force over half the length [-].
    pub eccentricity: f64,
}

impl Base {
    /// Forces at a frame; `None` without a bed joint under compression.
    pub fn of(scene: &Scene, snapshot: &Snapshot) -> Option<Self> {
        let bed = scene.beds.first()?;
        let traction = &snapshot.frame.interfaces.traction;
        let [low, high] = scene.ends_of_base;
        let (mut normal, mut moment) = (0.0, 0.0);
        for p in bed {
            let point = &scene.points[*p];
            let force = -traction[*p][0] * point.area;
            normal += force;
            moment += force * point.at[scene.axis];
        }
        let length = high - low;
        if normal <= 0.0 || length <= 0.0 {
            return None;
        }
        let eccentricity = (moment / normal - 0.5 * (low + high)).abs() / (0.5 * length);
        eccentricity.is_finite().then_some(Self {
            normal,
            length,
            eccentricity,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(heads: usize, units: usize, both: usize) -> FailureMeasure {
        FailureMeasure {
            inner_courses: 10,
            courses_with_open_heads: heads,
            courses_with_cracked_units: units,
            cut_courses: both,
            force_lost: true,
            ..FailureMeasure::default()
        }
    }

    #[test]
    fn the_rule_decides_in_its_order() {
        let nothing = FailureMeasure::default();
        assert_eq!(nothing.mode(), None);
        let opens = FailureMeasure {
            bed_opening_mm: 0.2,
            ..nothing
        };
        assert_eq!(opens.mode(), Some(FailureMode::Rocking));
        let crushed = FailureMeasure {
            compressive_damage: 0.3,
            ..opens
        };
        assert_eq!(crushed.mode(), Some(FailureMode::Rocking));
        let lost = FailureMeasure {
            force_lost: true,
            ..crushed
        };
        assert_eq!(lost.mode(), Some(FailureMode::ToeCrushing));
        assert_eq!(cut(7, 3, 7).mode(), Some(FailureMode::SteppedDiagonal));
        assert_eq!(cut(4, 5, 7).mode(), Some(FailureMode::DiagonalUnits));
        assert_eq!(cut(6, 0, 6).mode(), None);
        let tips = FailureMeasure {
            eccentricity: Some(0.96),
            ..cut(7, 3, 7)
        };
        assert_eq!(tips.mode(), Some(FailureMode::Mixed));
        // A stepped crack through which a wall rocks keeps its force.
        let keeps = FailureMeasure {
            force_lost: false,
            ..tips
        };
        assert_eq!(keeps.mode(), Some(FailureMode::Rocking));
        let slides = FailureMeasure {
            slip_over_drift: 0.51,
            ..tips
        };
        assert_eq!(slides.mode(), Some(FailureMode::BedSliding));
    }
}
