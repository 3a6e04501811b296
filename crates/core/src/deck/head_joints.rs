//! Warnings about the head joints of a wall: wider ones than the deck says, and gaps without a joint.

use super::masonry::{Corner, Masonry, Unit};
use super::schema::{Bond, Deck, DeckOpening, Wall};
use crate::error::Warning;

/// Warning about head joints wider than those of the wall, which patterns, lintels and other walls may cause.
pub(super) fn wide_joints(deck: &Deck, masonry: &Masonry<'_>) -> Option<Warning> {
    let (along, _) = masonry.wall.axes();
    let origin = masonry.wall.at[along].get();
    let joint = masonry.wall.head_joint.get();
    // Along the wall, a joint to a wall at an angle is wider than across.
    let sines = masonry.corners.iter().map(Corner::sine);
    let widest = joint / sines.fold(1.0, f64::min);
    let wide = |u: &&Unit| u.joint(along, true) > widest + 1e-6 * masonry.wall.unit[0].get();
    let mut units = masonry.units.iter().filter(wide);
    let first = units.next()?;
    let [from, to] = [first.own[along][1], first.all[along][1]].map(|x| x - origin);
    let rest = units.count();
    let others = if rest > 0 {
        format!(", and {rest} others")
    } else {
        String::new()
    };
    let (key, remedy) = cause(deck, masonry, [from, to], to - from - joint);
    Some(deck.warning(
        &key,
        format!(
            "in course {} the joint behind {} from {from:.2} to {to:.2} mm along the wall is {:.2} mm wide, the head joints \
             of the wall {joint} mm{others}: {remedy}",
            first.course,
            first.name(&masonry.name),
            to - from
        ),
    ))
}

/// Key that makes a head joint with these ends along a wall [mm] wider than the others by `more` mm, and the remedy.
fn cause(deck: &Deck, masonry: &Masonry<'_>, [from, to]: [f64; 2], more: f64) -> (String, String) {
    let (wall, path) = (masonry.wall, &masonry.path);
    if wall.bond == Bond::Pattern {
        let remedy = "longer units in that course of the pattern fill it".to_owned();
        return (format!("{path}.pattern"), remedy);
    }
    let slack = 1e-3 * wall.unit[0].get();
    let walls: Vec<_> = deck.walls().collect();
    for (other, [low, high]) in masonry.met(deck) {
        if to < low - slack || from > high + slack {
            continue;
        }
        let Some((other, name, _)) = walls.get(other) else {
            continue;
        };
        let why = format!("no unit fits between it and the wall `{name}`");
        // At its end, a wall that is shorter brings both to their places.
        return if low <= slack || high >= wall.length.get() - slack {
            let remedy = format!(
                "{why}, to which the length should be {more:.2} mm shorter, with {name} as much nearer"
            );
            (format!("{path}.length"), remedy)
        } else {
            let remedy = format!("{why}, which should stand {more:.2} mm nearer");
            (format!("{other}.at"), remedy)
        };
    }
    let remedy = |edge: &str| format!("{edge} {more:.2} mm nearer leaves no such rest");
    if wall.openings.is_empty() {
        return (format!("{path}.length"), remedy("an end of the wall"));
    }
    (format!("{path}.openings"), remedy("the edge of an opening"))
}

/// Warning about neighbouring units of a course without a joint between them.
pub(super) fn gaps(deck: &Deck, masonry: &Masonry<'_>) -> Option<Warning> {
    let wall = masonry.wall;
    let (along, _) = wall.axes();
    let origin = wall.at[along].get();
    let least = 1e-6 * wall.unit[0].get();
    let in_opening = |course: u16, x: f64| {
        let courses = |o: &DeckOpening| {
            let above = o.lintel.as_ref().map_or(0, |l| l.courses);
            o.sill..o.sill + o.courses + above
        };
        let mut openings = wall.openings.iter();
        openings.any(|o| {
            courses(o).contains(&u32::from(course)) && (o.from.get()..=o.to.get()).contains(&x)
        })
    };
    // Where another wall passes through, a gap of its thickness is intended.
    let most = if masonry.joined.is_empty() && masonry.corners.is_empty() {
        f64::INFINITY
    } else {
        3.0 * wall.head_joint.get()
    };
    let mut found = Vec::new();
    for course in masonry.units.chunk_by(|a, b| a.course == b.course) {
        let mut by_start: Vec<usize> = (0..course.len()).collect();
        by_start.sort_by(|a, b| course[*a].own[along][0].total_cmp(&course[*b].own[along][0]));
        for unit in course {
            for i in following(wall, course, &by_start, unit) {
                let next = &course[i];
                let gap = next.own[along][0] - unit.all[along][1].max(unit.own[along][1]);
                let middle = next.own[along][0] - 0.5 * gap - origin;
                if gap > least && gap <= most && !in_opening(unit.course, middle) {
                    found.push((unit, next, gap));
                }
            }
        }
    }
    let &(unit, next, gap) = found.first()?;
    let others = match found.len() {
        1 => String::new(),
        n => format!(", and at {} other places", n - 1),
    };
    let key = if wall.bond == Bond::Pattern {
        "pattern"
    } else {
        "bond"
    };
    Some(deck.warning(
        &format!("{}.{key}", masonry.path),
        format!(
            "in course {} a gap of {gap:.2} mm beyond the joint parts {} from {}, which begins at {:.2} mm{others}: nothing \
             joins them there",
            unit.course,
            unit.name(&masonry.name),
            next.name(&masonry.name),
            next.own[along][0] - origin
        ),
    ))
}

/// Next units of a course after `unit`, one in each leaf that it goes through, in ascending order. `by_start`:
/// units of the course in the order of their starts.
fn following(wall: &Wall, course: &[Unit], by_start: &[usize], unit: &Unit) -> Vec<usize> {
    let (along, through) = wall.axes();
    let least = 1e-6 * wall.unit[0].get();
    let start = |i: usize| course[i].own[along][0];
    let beside = |a: &Unit, b: &Unit| {
        let [a, b] = [a.own[through], b.own[through]];
        a[1].min(b[1]) - a[0].max(b[0]) > least
    };
    let behind = by_start.partition_point(|i| start(*i) <= unit.own[along][1] - least);
    let (mut seen, mut next): (Vec<usize>, Vec<usize>) = (Vec::new(), Vec::new());
    // Parts of the thickness of `unit` without a next unit so far.
    let mut left = vec![unit.own[through]];
    for &i in &by_start[behind..] {
        let last = seen.last().map_or(f64::INFINITY, |i| start(*i));
        if left.is_empty() && start(i) > last + least {
            break; // all others stand behind units found before
        }
        let other = &course[i];
        if !beside(unit, other) {
            continue;
        }
        let covers = |s: &usize| beside(&course[*s], other) && start(*s) < start(i) - least;
        if !seen.iter().any(covers) {
            next.push(i);
        }
        seen.push(i);
        let [front, back] = other.own[through];
        left = left
            .into_iter()
            .flat_map(|[a, b]| [[a, b.min(front)], [a.max(back), b]])
            .filter(|[a, b]| b - a > least)
            .collect();
    }
    next.sort_unstable();
    next
}
