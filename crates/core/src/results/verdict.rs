//! The verdict on a run: its result in one word and one sentence.

use serde::{Deserialize, Serialize};

use super::Curve;
use super::curve::Peak;
use crate::model::Model;
use crate::model::scene::{Procedure, Step};
use crate::state::{Frame, Status, Summary};
use wythe_contact::Aabb;

/// The force still rises if it has risen over this last part of the travel by more than [`RISES`] of the largest
/// force.
const LAST: f64 = 0.1;
const RISES: f64 = 0.005;
/// Ratio of kinetic energy to the energy taken by solids and joints above which a body is moving.
const MOVING: f64 = 1e-3;

/// Result of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Verdict {
    /// In one word.
    pub kind: VerdictKind,
    /// In one sentence without a full stop.
    pub text: String,
}

/// Result of a run in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VerdictKind {
    /// The force along the drive has fallen below its largest value; in a cyclic drive, at the same displacement.
    PeakPassed,
    /// The force along the drive still rises at the end and has no peak yet.
    StillRising,
    /// The force along the drive neither rises nor falls at the end.
    Plateau,
    /// Prescribed loads are in equilibrium.
    Stands,
    /// Everything is at rest at the end, and a body has moved by more than its smallest edge.
    Displaced,
    /// A body is moving under inertia at the end of the run.
    Moves,
    /// There is no equilibrium, and bodies fall.
    Collapsed,
    /// Convergence was lost.
    NotConverged,
    /// The user interrupted the run.
    Interrupted,
    /// A callback of the calling program stopped the run.
    Stopped,
}

/// Largest displacement at the end of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Farthest {
    /// Displacement of a node [mm].
    pub moved: f64,
    /// Name of its body.
    pub body: String,
    /// Smallest edge of the box around the body at rest [mm].
    pub edge: f64,
}

impl Farthest {
    /// The largest nodal displacement of a frame; `None` without nodes.
    pub fn of(model: &Model, frame: &Frame) -> Option<Self> {
        let sizes = frame
            .displacement
            .iter()
            .map(|u| u.iter().map(|u| u * u).sum::<f64>());
        let (node, square) = sizes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let has = |nodes: &[u32; 8]| nodes.contains(&(node as u32));
        let element = model.mesh.elements.iter().position(has)?;
        let unit = model.mesh.unit[element];
        let of_body = model.mesh.elements.iter().zip(&model.mesh.unit);
        let nodes = of_body
            .filter(|(_, of)| **of == unit)
            .flat_map(|(nodes, _)| *nodes);
        let around = Aabb::of(nodes.map(|n| &model.mesh.nodes[n as usize]));
        let edges = (0..3).map(|d| around.max[d] - around.min[d]);
        Some(Self {
            moved: square.sqrt(),
            body: model.mesh.body_of(element),
            edge: edges.fold(f64::INFINITY, f64::min),
        })
    }
}

/// Motion at the end of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Kinetic energy [J].
    pub kinetic: f64,
    /// Ratio of the kinetic energy to the energy taken by solids and joints [-].
    pub part: f64,
}

impl Verdict {
    /// Judges a run by its status, its curve, and the largest displacement and the motion at its end.
    pub fn on(
        model: &Model,
        run: &Summary,
        curve: &Curve,
        farthest: Option<&Farthest>,
        motion: Motion,
    ) -> Self {
        let is = |kind, text| Self { kind, text };
        match run.status {
            Status::Collapsed => is(VerdictKind::Collapsed, run.message.clone()),
            Status::NotConverged => {
                let text = match &run.lost {
                    Some(lost) => format!("not converged at {}, because {}", lost.place, lost.why),
                    None => format!("not converged: {}", run.message),
                };
                is(VerdictKind::NotConverged, so_far(text, curve))
            }
            status @ (Status::Interrupted | Status::Stopped) => {
                let plural = if run.increments == 1 { "" } else { "s" };
                let (kind, by) = match status {
                    Status::Stopped => (VerdictKind::Stopped, "stopped by the callback"),
                    _ => (VerdictKind::Interrupted, "interrupted by the user"),
                };
                let text = format!("{by} after {} increment{plural}", run.increments);
                is(kind, so_far(text, curve))
            }
            Status::Completed => {
                let told = Self::on_curve(model, curve)
                    .unwrap_or_else(|| at_end(farthest, motion, run.fall.is_some()));
                match &run.fall {
                    Some(fall) => is(told.kind, format!("{}; {}", told.text, fall.moved())),
                    None => told,
                }
            }
        }
    }

    /// Verdict from the curve of a drive to and fro.
    fn on_loops(curve: &Curve, peak: Peak) -> Self {
        let both = match curve.opposite_peak() {
            Some(other) => format!("{} and {}", place(peak), place(other)),
            None => place(peak),
        };
        if curve.passes_peak() {
            let text = match curve.opposite_peak() {
                Some(other) if !curve.loses(other) => format!(
                    "peak of {} passed in loops; at most {} on the other side, not passed",
                    place(peak),
                    place(other)
                ),
                _ => format!("peaks of {both} passed in loops"),
            };
            return Self {
                kind: VerdictKind::PeakPassed,
                text,
            };
        }
        // The largest force decides; the other side of the start may have passed its own peak.
        let passed = curve.opposite_peak().filter(|other| curve.loses(*other));
        let rises = |side: f64| curve.rises_outwards(side, LAST) > RISES * peak.force.abs();
        if let Some(other) = passed {
            let (kind, how) = if rises((peak.displacement - curve.start().0).signum()) {
                (VerdictKind::StillRising, "still rising")
            } else {
                (VerdictKind::Plateau, "neither rising nor falling")
            };
            let text = format!(
                "{how} where the drive is farthest out on one side: {}; peak of {} on the other side passed",
                place(peak),
                place(other)
            );
            return Self { kind, text };
        }
        if rises(1.0) || rises(-1.0) {
            return Self {
                kind: VerdictKind::StillRising,
                text: format!("still rising where the drive is farthest out: {both}, no peak yet"),
            };
        }
        Self {
            kind: VerdictKind::Plateau,
            text: format!(
                "neither rising nor falling where the drive is farthest out: at most {both}"
            ),
        }
    }

    /// Verdict from the curve; `None` if nothing is driven and no path is followed.
    fn on_curve(model: &Model, curve: &Curve) -> Option<Self> {
        let is = |kind, text| Some(Self { kind, text });
        // A prescribed load follows its amplitude, so that its curve has no peak of its own.
        let finds = |step: &Step| {
            let follows = matches!(
                step.procedure,
                Procedure::ArcLength | Procedure::Dissipation
            );
            follows || step.control.is_some() || step.drives()
        };
        if !model.steps.iter().any(finds) {
            return None;
        }
        let &(displacement, force) = curve.points().last()?;
        let mut end = format!("{force:.3} kN at {displacement:.4} mm");
        if curve.ends_moving() {
            end.push_str(" that inertia carries");
        }
        let Some(peak) = curve.peak() else {
            let text = format!(
                "inertia carries the force of all increments: none is in equilibrium; {end} at the end"
            );
            return curve.ends_moving().then_some(Self {
                kind: VerdictKind::Moves,
                text,
            });
        };
        if curve.turns_back() {
            return Some(Self::on_loops(curve, peak));
        }
        if curve.passes_peak() {
            let text = format!("peak of {} passed; {end} at the end", place(peak));
            return is(VerdictKind::PeakPassed, text);
        }
        if curve.ends_moving() {
            let text = format!(
                "not at rest at the end: {end}; in equilibrium at most {}",
                place(peak)
            );
            return is(VerdictKind::Moves, text);
        }
        if curve.rises_over(LAST) > RISES * peak.force.abs() {
            let text = format!("still rising at the end: {end}, no peak yet");
            return is(VerdictKind::StillRising, text);
        }
        let text = format!(
            "neither rising nor falling at the end: {end}, at most {}",
            place(peak)
        );
        is(VerdictKind::Plateau, text)
    }
}

/// Force and displacement of a point of the curve.
fn place(peak: Peak) -> String {
    format!("{:.3} kN at {:.4} mm", peak.force, peak.displacement)
}

/// Verdict on a run at the end of prescribed loads.
fn at_end(farthest: Option<&Farthest>, motion: Motion, falls: bool) -> Verdict {
    let far = farthest.map_or_else(String::new, |far| {
        format!("moved by at most {:.4} mm ({})", far.moved, far.body)
    });
    if falls || motion.part > MOVING {
        let text = format!(
            "not at rest at the end: kinetic energy {:.3} J, {far}",
            motion.kinetic
        );
        return Verdict {
            kind: VerdictKind::Moves,
            text,
        };
    }
    if farthest.is_some_and(|farthest| farthest.moved > farthest.edge) {
        return Verdict {
            kind: VerdictKind::Displaced,
            text: format!("at rest at the end, {far}, which is more than its smallest edge"),
        };
    }
    let text = if far.is_empty() {
        "stands".to_owned()
    } else {
        format!("stands: {far}")
    };
    Verdict {
        kind: VerdictKind::Stands,
        text,
    }
}

/// Appends the largest force of the curve to a sentence.
fn so_far(text: String, curve: &Curve) -> String {
    match curve.peak() {
        Some(peak) => format!(
            "{text}; largest force until then {:.3} kN at {:.4} mm",
            peak.force, peak.displacement
        ),
        None => text,
    }
}

impl Motion {
    /// Motion at the end of an increment.
    pub fn of(row: &crate::state::HistoryRow) -> Self {
        let kinetic = row.kinetic_energy_J;
        let part = if kinetic > 0.0 {
            kinetic / row.taken_J()
        } else {
            0.0
        };
        Self { kinetic, part }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;
    use crate::state::{Fall, FallenBody};

    fn verdict(run: &Summary, points: &[(f64, f64)]) -> Verdict {
        let curve = Curve::of_points(points);
        Verdict::on(&fake::model(), run, &curve, None, Motion::default())
    }

    fn completed(points: &[(f64, f64)]) -> (VerdictKind, String) {
        let Verdict { kind, text } = verdict(&fake::summary(Status::Completed), points);
        (kind, text)
    }

    /// A load of the opposite sign, ground that sinks under a constant weight, and a pressed face that is pulled back.
    #[test]
    fn forces_against_the_drive_pass_no_peak_by_their_sign() {
        let (kind, text) = completed(&[(0.0, 0.0), (0.5, -0.2), (1.0, -0.4), (2.0, -0.8)]);
        assert_eq!(kind, VerdictKind::StillRising);
        let rises = "still rising at the end: -0.800 kN at 2.0000 mm, no peak yet";
        assert_eq!(text, rises);
        let (kind, _) = completed(&[(0.0, -35.0), (1.0, -35.001), (2.0, -35.0), (3.0, -35.001)]);
        assert_eq!(kind, VerdictKind::Plateau);
        let (kind, _) = completed(&[(0.0, -14.1), (1.0, -10.0), (2.0, -6.0), (3.0, -2.0)]);
        assert_eq!(kind, VerdictKind::StillRising);
        // Thrust that has grown and falls.
        let (kind, text) = completed(&[(0.0, -1.0), (1.0, -9.0), (2.0, -5.0)]);
        assert_eq!(kind, VerdictKind::PeakPassed);
        assert!(
            text.starts_with("peak of -9.000 kN at 1.0000 mm passed"),
            "{text}"
        );
    }

    #[test]
    fn a_peak_is_one_only_where_the_force_has_fallen() {
        let (kind, text) = completed(&[(0.0, 0.0), (1.0, 10.0), (2.0, 20.0), (3.0, 15.0)]);
        assert_eq!(kind, VerdictKind::PeakPassed);
        assert_eq!(
            text,
            "peak of 20.000 kN at 2.0000 mm passed; 15.000 kN at 3.0000 mm at the end"
        );
        let (kind, text) = completed(&[(0.0, 0.0), (1.0, 10.0), (2.0, 20.0)]);
        assert_eq!(kind, VerdictKind::StillRising);
        assert!(!text.contains("peak of"), "{text}");
        // A sliding joint: 0.4 % below its largest force.
        let slides = [(0.0, 0.0), (0.1, 50.0), (10.0, 49.9), (20.0, 49.8)];
        assert_eq!(completed(&slides).0, VerdictKind::Plateau);
        // From 49.5 to 50 kN over the last tenth of the travel, 1 % of the largest force.
        let hardens = [(0.0, 0.0), (1.0, 40.0), (18.0, 49.5), (20.0, 50.0)];
        assert_eq!(completed(&hardens).0, VerdictKind::StillRising);
    }

    #[test]
    fn a_cyclic_drive_has_a_peak_if_a_later_cycle_has_less_force() {
        let first = [
            (0.0, 0.0),
            (2.0, 50.0),
            (0.0, 0.0),
            (-2.0, -45.0),
            (0.5, 10.0),
        ];
        let (kind, text) = completed(&first);
        assert_eq!(kind, VerdictKind::StillRising);
        assert!(
            text.contains("50.000 kN at 2.0000 mm and -45.000 kN"),
            "{text}"
        );
        let again = [&first[..], &[(0.0, 0.0), (2.0, 44.0)]].concat();
        let (kind, text) = completed(&again);
        assert_eq!(kind, VerdictKind::PeakPassed);
        assert_eq!(
            text,
            "peak of 50.000 kN at 2.0000 mm passed in loops; at most -45.000 kN at -2.0000 mm on the other side, \
             not passed"
        );
        let both = [&again[..], &[(0.0, 0.0), (-2.0, -40.0)]].concat();
        let (kind, text) = completed(&both);
        assert_eq!(kind, VerdictKind::PeakPassed);
        assert_eq!(
            text,
            "peaks of 50.000 kN at 2.0000 mm and -45.000 kN at -2.0000 mm passed in loops"
        );
    }

    #[test]
    fn each_side_of_a_drive_to_and_fro_has_its_own_peak() {
        // A joint that has softened under tension is pressed, and pulled further than before.
        let points = [
            (0.0, 0.0),
            (0.004, 10.0),
            (0.05, 3.0),
            (-0.005, -13.0),
            (-0.01, -27.0),
            (0.05, 3.0),
            (0.09, 1.0),
        ];
        let (kind, text) = completed(&points);
        assert_eq!(kind, VerdictKind::StillRising);
        let parts = [
            "-27.000 kN at -0.0100 mm; peak of 10.000 kN at 0.0040 mm",
            "passed",
        ];
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    }

    #[test]
    fn failed_and_interrupted_runs_have_a_largest_force() {
        let mut lost = fake::summary(Status::NotConverged);
        lost.lost = Some(crate::state::Lost {
            place: "load factor 0.3652 of step 1 (push)".to_owned(),
            why: "the matrix is singular".to_owned(),
        });
        let rising = [(0.0, 0.0), (1.0, 10.0)];
        let told = verdict(&lost, &rising);
        assert_eq!(told.kind, VerdictKind::NotConverged);
        assert_eq!(
            told.text,
            "not converged at load factor 0.3652 of step 1 (push), because the matrix is singular; \
             largest force until then 10.000 kN at 1.0000 mm"
        );
        let told = verdict(&fake::summary(Status::Interrupted), &[]);
        assert_eq!(told.text, "interrupted by the user after 3 increments");
    }

    #[test]
    fn a_collapse_names_its_bodies_and_counts_the_rest() {
        let body = |name: &str, moved_mm: f64, fall_mm: f64| FallenBody {
            name: name.to_owned(),
            unit: 0,
            moved_mm,
            fall_mm,
        };
        let mut fall = Fall {
            step: 0,
            step_name: "gravity".to_owned(),
            load_factor: 0.25,
            kinetic_energy_J: 3.5,
            bodies: vec![body("a", 200.0, 199.0), body("b", 150.0, 20.0)],
            found_in: None,
        };
        assert_eq!(
            fall.collapsed(),
            "collapsed at load factor 0.2500 of step 0 (gravity): a and b fell by up to 199.0 mm; kinetic energy 3.500 J"
        );
        fall.found_in = Some("step 2 (push)".to_owned());
        assert!(
            fall.collapsed().starts_with(
                "collapsed in step 2 (push); the last equilibrium was at load factor 0.2500 of step 0 (gravity): a and b"
            )
        );
        fall.bodies = (0..7).map(|i| body(&format!("s{i}"), 90.0, 5.0)).collect();
        assert_eq!(
            fall.moved(),
            "s0, s1, s2 and 4 others moved by up to 90.0 mm"
        );
        fall.bodies.truncate(1);
        assert_eq!(fall.moved(), "s0 moved by 90.0 mm");
    }

    #[test]
    fn carried_loads_stand_and_moving_models_do_not() {
        let mut model = fake::model();
        model.steps.truncate(1);
        model.steps[0].procedure = Procedure::Auto;
        let run = fake::summary(Status::Completed);
        let far = Farthest {
            moved: 0.125,
            body: "lintel".to_owned(),
            edge: 100.0,
        };
        let nothing = Curve::default();
        let on = |motion| Verdict::on(&model, &run, &nothing, Some(&far), motion);
        let stands = on(Motion::default());
        assert_eq!(stands.kind, VerdictKind::Stands);
        assert_eq!(stands.text, "stands: moved by at most 0.1250 mm (lintel)");
        let moves = on(Motion {
            kinetic: 2.0,
            part: 0.5,
        });
        assert_eq!(moves.kind, VerdictKind::Moves);
        assert!(moves.text.contains("2.000 J"), "{}", moves.text);
    }
}
