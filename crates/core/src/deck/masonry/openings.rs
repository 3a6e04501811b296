//! Openings: parts of the courses that they and their lintels remove.

use super::course::CourseRow;
use super::layout::{Courses, Cut, Refusal};
use super::snap::Snapped;
use crate::deck::schema::{DeckLintel, DeckOpening, Wall};

/// Cuts of the openings of a wall, whose lintels have these `spans`.
pub(super) fn cuts(wall: &Wall, spans: &[[f64; 2]], snapped: &mut Snapped) -> Vec<Cut> {
    let mut cuts = Vec::new();
    for (o, opening) in wall.openings.iter().enumerate() {
        let key = |name: &str| format!("openings.{o}.{name}");
        let [from, to] = wall.edges(opening);
        snapped.note(opening.from.get() - from);
        snapped.note(to - opening.to.get());
        let top = opening.sill.saturating_add(opening.courses);
        cuts.push(Cut {
            along: [from, to],
            courses: Courses::Range(opening.sill, top),
            joint: None,
            filled: false,
            what: format!("opening {o}"),
            key: key("from"),
        });
        if let Some(lintel) = &opening.lintel {
            let [from, to] = spans[o];
            let head = wall.head_joint.get();
            cuts.push(Cut {
                along: [from - head, to + head],
                courses: Courses::Range(top, top + lintel.courses),
                joint: None,
                filled: true,
                what: format!("the lintel of opening {o}"),
                key: key("lintel.bearing"),
            });
        }
    }
    cuts
}

/// Ranges of the lintels of a wall along it [mm]. A lintel reaches to the end of the wall, or to an opening or lintel
/// beside it, if less than a piece of masonry lies between. `[opening]`
///
/// # Errors
/// Openings outside of the wall, overlapping openings.
pub(super) fn spans(wall: &Wall, snapped: &mut Snapped) -> Result<Vec<[f64; 2]>, Refusal> {
    for (o, opening) in wall.openings.iter().enumerate() {
        require_within(wall, opening, o)?;
    }
    let mut spans: Vec<[f64; 2]> = wall.openings.iter().map(|o| spanned(wall, o)).collect();
    let head = wall.head_joint.get();
    for (o, opening) in wall.openings.iter().enumerate() {
        let Some(lintel) = &opening.lintel else {
            continue;
        };
        let first = opening.sill + opening.courses;
        let beside = |from: u32, to: u32| from < first + lintel.courses && first < to;
        let mut ends = vec![[0.0; 2], [wall.length.get(); 2]];
        for (p, other) in wall.openings.iter().enumerate().filter(|(p, _)| *p != o) {
            let top = other.sill + other.courses;
            if beside(other.sill, top) {
                ends.push(wall.edges(other));
            }
            let above = other.lintel.as_ref().map_or(0, |l| l.courses);
            if beside(top, top + above) {
                ends.push([spans[p][0] - head, spans[p][1] + head]);
            }
        }
        for [low, high] in ends {
            let [from, to] = spans[o];
            snapped.extend_lintel(&mut spans[o], 0, [from - head, high]);
            snapped.extend_lintel(&mut spans[o], 1, [to + head, low]);
        }
    }
    Ok(spans)
}

/// Range along the wall [mm] that the bearings of a lintel ask for.
fn spanned(wall: &Wall, opening: &DeckOpening) -> [f64; 2] {
    let bearing = opening.lintel.as_ref().map_or(0.0, |l| l.bearing.get());
    [
        (opening.from.get() - bearing).max(0.0),
        (opening.to.get() + bearing).min(wall.length.get()),
    ]
}

fn require_within(wall: &Wall, opening: &DeckOpening, o: usize) -> Result<(), Refusal> {
    let (from, to, length) = (opening.from.get(), opening.to.get(), wall.length.get());
    let refuse = |key: &str, message: String, help: &str| {
        Err(Refusal::new(format!("openings.{o}.{key}"), message, help))
    };
    if !(from >= 0.0 && from < to && to <= length) {
        return refuse(
            "to",
            format!("the opening from {from} to {to} mm is not within the {length} mm of the wall"),
            "0 <= from < to <= length",
        );
    }
    let above = opening.lintel.as_ref().map_or(0, |l| l.courses);
    let top = u64::from(opening.sill) + u64::from(opening.courses) + u64::from(above);
    if opening.courses == 0 || top > u64::from(wall.courses) {
        return refuse(
            "courses",
            format!(
                "{} courses above a sill of {}, and {above} of lintel, are not within the {} of the wall",
                opening.courses, opening.sill, wall.courses
            ),
            "at least one; sill + courses + those of the lintel are at most those of the wall",
        );
    }
    let reach = |p: &DeckOpening| {
        let [a, b] = spanned(wall, p);
        let courses = p.lintel.as_ref().map_or(0, |l| l.courses);
        (a, b, p.sill, p.sill + p.courses + courses)
    };
    let own = reach(opening);
    let other = wall.openings[..o]
        .iter()
        .map(reach)
        .position(|other| own.0 < other.1 && other.0 < own.1 && own.2 < other.3 && other.2 < own.3);
    if let Some(other) = other {
        return refuse(
            "from",
            format!("openings {other} and {o}, with their lintels, overlap"),
            "make one of them, or part them by masonry",
        );
    }
    Ok(())
}

/// Lintels that begin in course `k`: index of the opening, range along the wall [mm], depth through the wall [mm],
/// lintel.
pub(super) fn lintels<'a>(
    wall: &'a Wall,
    rows: &[CourseRow],
    k: u32,
    spans: &'a [[f64; 2]],
) -> impl Iterator<Item = (u32, [f64; 2], f64, &'a DeckLintel)> {
    let back = rows.iter().map(|r| r.through[1]).fold(0.0, f64::max);
    let openings = wall.openings.iter().enumerate();
    openings.filter_map(move |(o, opening)| {
        let lintel = opening.lintel.as_ref()?;
        (opening.sill + opening.courses == k).then(|| (o as u32, spans[o], back, lintel))
    })
}
