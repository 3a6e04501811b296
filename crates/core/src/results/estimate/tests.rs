use super::*;
use approx::assert_relative_eq;

/// A wall with a peak of 50 kN at 2 mm and an area of 145 J.
fn wall() -> Curve {
    Curve::of_points(&[(0.0, 0.0), (1.0, 40.0), (2.0, 50.0), (4.0, 30.0)])
}

fn compared(part: Part, refinement: f64, differences: [f64; 3]) -> Compared {
    Compared {
        part,
        refinement,
        differences,
    }
}

#[test]
fn an_error_of_its_order_is_found_from_any_finer_companion() {
    // A figure is off by 6 where sizes are 1, and by 6/r or 6/r² where they are 1/r.
    for r in [1.25_f64, 1.5, 2.0, 4.0] {
        for (part, left) in [(Part::Time, 6.0 / r), (Part::Mesh, 6.0 / (r * r))] {
            let companion = compared(part, r, [6.0 - left, 0.0, 0.0]);
            // A few operations in f64.
            assert_relative_eq!(companion.error(0), 6.0, max_relative = 1e-14);
        }
    }
}

#[test]
fn parts_add_as_independent_errors() {
    let of = [
        compared(Part::Time, 2.0, [0.15, 1.0, 0.05]),
        compared(Part::Mesh, 2.0, [0.3, 0.75, 0.375]),
    ];
    let estimate = ErrorEstimate::of(&wall(), &of, Vec::new());
    let peak = estimate.peak_force_kN.unwrap();
    assert_eq!((peak.value, peak.mostly), (50.0, Part::Mesh));
    assert_eq!(peak.parts[&Part::Time], 0.3);
    assert_eq!(peak.parts[&Part::Scatter], SCATTER * 50.0);
    let expected = (0.3_f64.powi(2) + 0.4_f64.powi(2) + 0.1_f64.powi(2)).sqrt();
    assert_relative_eq!(peak.error, expected, max_relative = 1e-14);
    assert_relative_eq!(
        peak.relative.unwrap(),
        expected / 50.0,
        max_relative = 1e-14
    );
    let area = estimate.area_J.unwrap();
    assert_eq!((area.value, area.mostly), (145.0, Part::Time));
    // The increments beside the peak are 1 and 2 mm away.
    let moved = estimate.displacement_at_peak_mm.unwrap();
    assert_eq!((moved.value, moved.parts[&Part::FlatPeak]), (2.0, 2.0));
    assert_eq!(moved.mostly, Part::FlatPeak);
    // No extrapolation: peaks jump.
    assert_eq!(
        (moved.parts[&Part::Time], moved.parts[&Part::Mesh]),
        (0.05, 0.375)
    );
    assert!(estimate.passes_peak);
}

#[test]
fn companions_that_agree_by_chance_leave_the_scatter() {
    let of = [compared(Part::Time, 2.0, [0.0; 3])];
    let estimate = ErrorEstimate::of(&wall(), &of, Vec::new());
    let peak = estimate.peak_force_kN.unwrap();
    assert_eq!((peak.error, peak.mostly), (SCATTER * 50.0, Part::Scatter));
}

#[test]
fn lines_have_the_digits_of_the_error() {
    let of = [
        compared(Part::Time, 2.0, [0.05, 0.5, 0.01]),
        compared(Part::Mesh, 2.0, [0.9, 3.0, 0.15]),
    ];
    let estimate = ErrorEstimate::of(&wall(), &of, Vec::new());
    // Peak: √(0.1² + 1.2² + 0.1²) = 1.21; area: √(1² + 4² + 0.29²) = 4.13; width 2 mm.
    assert_eq!(
        estimate.lines(),
        [
            "peak 50.0 ± 1.3 kN (2.4 %, mostly mesh) at 2 ± 2 mm",
            "area 145 ± 5 J (2.9 %, mostly mesh) to the end"
        ]
    );
}

#[test]
fn a_part_that_is_lacking_is_named_and_never_zero() {
    let of = [compared(Part::Time, 2.0, [0.05, 0.5, 0.01])];
    let mut estimate = ErrorEstimate::of(&wall(), &of, Vec::new());
    estimate.not_estimated = vec![
        NotEstimated {
            part: Part::Mesh,
            why: "its companion has not converged".to_owned(),
        },
        NotEstimated {
            part: Part::Penalty,
            why: "as in the deck".to_owned(),
        },
    ];
    let lines = estimate.lines();
    assert_eq!(
        lines[0],
        "peak 50.00 ± 0.15 kN (0.3 %, without mesh) at 2 ± 2 mm"
    );
    assert_eq!(
        lines[2..],
        ["error by mesh not estimated: its companion has not converged"]
    );
    let parts = estimate.peak_force_kN.unwrap().parts;
    assert!(!parts.contains_key(&Part::Mesh), "{parts:?}");
}

#[test]
fn without_companions_or_motion_there_are_no_figures() {
    let nothing = ErrorEstimate::of(&wall(), &[], Vec::new());
    assert_eq!(
        (nothing.peak_force_kN.clone(), nothing.lines().len()),
        (None, 0)
    );
    let of = [compared(Part::Time, 2.0, [0.0; 3])];
    assert_eq!(
        ErrorEstimate::of(&Curve::default(), &of, Vec::new()).area_J,
        None
    );
}

#[test]
fn the_estimate_reads_back_from_json() {
    let of = [compared(Part::Mesh, 1.5, [0.1, 0.2, 0.3])];
    let mut estimate = ErrorEstimate::of(&wall(), &of, Vec::new());
    estimate.companions.push(Companion {
        part: Part::Mesh,
        folder: "error/mesh".to_owned(),
        set: vec!["wall.mesh=[7, 3, 3]".to_owned()],
        refinement: Some(1.5),
        status: Some(Status::Completed),
        figures: Figures::of(&wall()),
    });
    let text = serde_json::to_string(&estimate).unwrap();
    assert!(
        text.contains(r#""parts":{"mesh":"#) && text.contains(r#""mostly":"flat_peak""#),
        "{text}"
    );
    assert_eq!(
        serde_json::from_str::<ErrorEstimate>(&text).unwrap(),
        estimate
    );
}
