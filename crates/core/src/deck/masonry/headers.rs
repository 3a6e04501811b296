//! Bonds with units through the wall: header, English, Flemish, and stretchers with courses of headers.

use super::course::{CourseRow, Sizes, Slot, filled, leaves, slots, stack};
use super::interlock::MOST_COURSES;
use super::layout::Refusal;
use crate::deck::schema::{Bond, Wall};

/// Courses of stretchers in the leaves of the wall, and a header course every `header_courses` courses.
pub(super) fn with_headers(
    wall: &Wall,
    sizes: &Sizes,
    patterns: &[Vec<Slot>],
) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    let every = wall.header_courses.map_or(0, |n| n as usize);
    let period = patterns.len().saturating_mul(every.max(1));
    // Courses above the wall are not needed, but where the bond begins with a later one.
    let period = period.min(wall.courses as usize + MOST_COURSES);
    let course = |k: usize| {
        if every > 0 && k % every + 1 == every {
            require_two_halves(sizes, "header_courses")?;
            return headers(sizes);
        }
        Ok(leaves(wall.leaves, sizes, &patterns[k % patterns.len()]))
    };
    (0..period).map(course).collect()
}

/// Requires that a header is as long as two stretchers and a collar joint are thick; `key` is that of the error.
fn require_two_halves(sizes: &Sizes, key: &str) -> Result<(), Refusal> {
    let thickness = 2.0 * sizes.width + sizes.collar;
    if (thickness - sizes.unit).abs() <= sizes.tolerance() {
        return Ok(());
    }
    Err(Refusal::new(
        key,
        format!(
            "headers of {} mm do not fit through two leaves of {thickness} mm",
            sizes.unit
        ),
        format!(
            "length of the unit = 2 times its thickness + the collar joint: collar_joint = {}",
            sizes.unit - 2.0 * sizes.width
        ),
    ))
}

/// A course of headers with closers beside the quoins.
fn headers(sizes: &Sizes) -> Result<Vec<CourseRow>, Refusal> {
    let (width, closer) = (sizes.width, sizes.closer()?);
    let end = width + closer + 2.0 * sizes.head;
    let middle = sizes.length - 2.0 * end;
    let lengths = if middle < width {
        filled(&[width], sizes.length, sizes)?
    } else {
        let mut lengths = vec![width, closer];
        lengths.extend(filled(&[width], middle, sizes)?);
        lengths.extend([closer, width]);
        lengths
    };
    Ok(vec![one_row(sizes, slots(lengths, sizes.head))])
}

/// Units through the whole wall, which is one unit thick.
fn one_row(sizes: &Sizes, slots: Vec<Slot>) -> CourseRow {
    let header = |slot: Slot| Slot {
        header: true,
        ..slot
    };
    CourseRow {
        through: [0.0, sizes.unit],
        slots: slots.into_iter().map(header).collect(),
        material: None,
    }
}

pub(super) fn header_bond(sizes: &Sizes) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    let even = slots(filled(&[sizes.width], sizes.length, sizes)?, sizes.head);
    let half = (sizes.width - sizes.head) / 2.0;
    let mut odd = vec![half];
    odd.extend(filled(
        &[sizes.width],
        sizes.length - half - sizes.head,
        sizes,
    )?);
    let odd = slots(odd, sizes.head);
    Ok(vec![vec![one_row(sizes, even)], vec![one_row(sizes, odd)]])
}

/// Two leaves of these stretchers within a wall one unit thick.
fn two_leaves(sizes: &Sizes, slots: &[Slot]) -> Result<Vec<CourseRow>, Refusal> {
    let collar = sizes.unit - 2.0 * sizes.width;
    if collar < -sizes.tolerance() {
        return Err(Refusal::new(
            "unit",
            format!(
                "two stretchers of {} mm are thicker than a header of {} mm is long",
                sizes.width, sizes.unit
            ),
            "length of the unit = 2 times its thickness + a joint",
        ));
    }
    let row = |through| CourseRow {
        through,
        slots: slots.to_vec(),
        material: None,
    };
    let front = row([0.0, sizes.width]);
    Ok(vec![front, row([sizes.unit - sizes.width, sizes.unit])])
}

/// English bond of a wall of two or more half-bricks: courses with stretchers in front and headers behind them, and
/// with headers in front, by turns.
pub(super) fn english(wall: &Wall, sizes: &Sizes) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    let halves = wall.leaves.max(2);
    let stretchers = |slots: &[Slot]| match halves {
        2 => two_leaves(sizes, slots),
        _ => thick(sizes, halves, slots, true),
    };
    let header_course = || match halves {
        2 => headers(sizes),
        _ => thick(sizes, halves, &stack(sizes)?, false),
    };
    let mut courses = vec![stretchers(&stack(sizes)?)?, header_course()?];
    if wall.bond == Bond::EnglishCross {
        let shifted = shifted(sizes)?;
        courses.push(match halves {
            2 => with_through_headers(sizes, shifted)?,
            _ => stretchers(&shifted)?,
        });
        courses.push(header_course()?);
    }
    Ok(courses)
}

/// Every second stretcher course of English cross bond: a header beside the quoin stretcher shifts the others by half a
/// unit. Where whole units fill the length, the other end has such a header, too.
fn shifted(sizes: &Sizes) -> Result<Vec<Slot>, Refusal> {
    let quoin = [sizes.unit, sizes.width];
    let taken = quoin.iter().sum::<f64>() + 2.0 * sizes.head;
    let middle = |quoins: f64| {
        let rest = sizes.length - quoins * taken;
        (rest >= sizes.width).then(|| filled(&[sizes.unit], rest, sizes))
    };
    let Some(one) = middle(1.0) else {
        return stack(sizes); // too short to be shifted
    };
    // The last piece is the shortest one.
    let last = |units: &[f64]| units.last().copied().unwrap_or(0.0);
    let two = middle(2.0).and_then(Result::ok);
    let both = two.filter(|two| one.as_deref().map_or(0.0, last) < last(two));
    let lengths = match both {
        Some(two) => [&quoin[..], &two, &[sizes.width, sizes.unit]].concat(),
        None => [&quoin[..], &one?].concat(),
    };
    Ok(slots(lengths, sizes.head))
}

/// A course of an English bond of three half-bricks or more: rows of stretchers and of headers, each as deep as its
/// units. `first`: whether the front has stretchers.
fn thick(
    sizes: &Sizes,
    halves: u32,
    stretchers: &[Slot],
    first: bool,
) -> Result<Vec<CourseRow>, Refusal> {
    require_two_halves(sizes, "collar_joint")?;
    let plain = |slot: &Slot| Slot {
        header: false,
        ..*slot
    };
    let headers: Vec<Slot> = headers(sizes)?
        .iter()
        .flat_map(|row| row.slots.iter().map(plain))
        .collect();
    let mut rows = Vec::new();
    let (mut front, mut left) = (0.0, halves);
    while left > 0 {
        let stretches = left == 1 || (first && rows.is_empty());
        let depth = if stretches { sizes.width } else { sizes.unit };
        rows.push(CourseRow {
            through: [front, front + depth],
            slots: if stretches {
                stretchers.to_vec()
            } else {
                headers.clone()
            },
            material: None,
        });
        front += depth + sizes.collar;
        left -= if stretches { 1 } else { 2 };
    }
    Ok(rows)
}

pub(super) fn flemish(sizes: &Sizes) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    let (unit, width, closer) = (sizes.unit, sizes.width, sizes.closer()?);
    let even = filled(&[unit, width], sizes.length, sizes)?;
    let end = width + closer + 2.0 * sizes.head;
    let middle = sizes.length - 2.0 * end;
    let mut odd = vec![width, closer];
    if middle < width {
        odd = filled(&[width, unit], sizes.length, sizes)?;
    } else {
        odd.extend(filled(&[unit, width], middle, sizes)?);
        odd.extend([closer, width]);
    }
    [even, odd]
        .into_iter()
        .map(|lengths| with_through_headers(sizes, slots(lengths, sizes.head)))
        .collect()
}

/// Two leaves of these units, of which those no longer than a header go through; a longer one is a pair of stretchers.
fn with_through_headers(sizes: &Sizes, mut all: Vec<Slot>) -> Result<Vec<CourseRow>, Refusal> {
    for slot in &mut all {
        slot.header = slot.length < sizes.width + sizes.tolerance();
    }
    let stretchers: Vec<Slot> = all.iter().filter(|s| !s.header).copied().collect();
    let mut rows = two_leaves(sizes, &stretchers)?;
    rows[0].slots = all;
    Ok(rows)
}
