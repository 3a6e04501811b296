//! The course with which the bond of a wall begins, so that its units interlock with those of the walls that it meets.
//!
//! ```text
//! straight joint          interlocked
//! ├───┴┬──────┬──┤        ├──────┬──────┤     the other wall ends at │ in every second course; where this wall passes
//! ├────│      │  │        ├────│  │     │     through, no head joint of its own should stand there
//! ├───┴┬──────┬──┤        ├──────┬──────┤
//! ```

use super::course::{CourseRow, Sizes};
use super::layout::Cut;
use crate::deck::schema::{Bond, Wall};

/// Distances that differ by less than this fraction of a unit are equal: decks round to 0.001 mm or coarser, and a wall
/// begins with the same course in every orientation.
const TIE: f64 = 1e-3;

/// How the bond of a wall is laid where it meets others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::deck) struct Interlock {
    /// Course of the bond that is the lowest one of the wall.
    pub(in crate::deck) first: usize,
    /// Smallest distance of its head joints, where it passes through another wall, from its joints to this wall in the
    /// courses below and above [mm]. Infinite where no wall meets it.
    pub(in crate::deck) lap: f64,
}

impl Interlock {
    /// Lowest course of the bond with which the units of a wall interlock best, if the first one does not do; of equal
    /// ones the first. `cuts` are those by other walls.
    pub(super) fn of(wall: &Wall, pattern: &[Vec<CourseRow>], cuts: &[Cut]) -> Self {
        let with = |first: usize| Self {
            first,
            lap: lap(&Sizes::of(wall), pattern, cuts, first),
        };
        let plain = with(0);
        if plain.overlaps(wall) || wall.bond == Bond::Pattern {
            return plain;
        }
        let tie = TIE * wall.unit[0].get();
        let others = (1..pattern.len().min(MOST_COURSES)).map(with);
        others.fold(plain, |best, next| {
            let is_better = next.lap > best.lap + tie;
            if is_better { next } else { best }
        })
    }

    /// Whether its head joints are far enough from those of the walls that it meets.
    pub(in crate::deck) fn overlaps(self, wall: &Wall) -> bool {
        self.lap >= least_lap(wall) - TIE * wall.unit[0].get()
    }
}

/// Distance of head joints in neighbouring courses below which units hardly overlap [mm]. Closers are meant to be short.
pub(in crate::deck) fn least_lap(wall: &Wall) -> f64 {
    let unit = match wall.bond {
        Bond::Stretcher | Bond::Stack => wall.unit[0],
        _ => wall.unit[1],
    };
    unit.get() / 8.0
}

/// Courses that show the whole bond; it begins with one of them.
pub(super) const MOST_COURSES: usize = 24;

fn lap(sizes: &Sizes, pattern: &[Vec<CourseRow>], cuts: &[Cut], first: usize) -> f64 {
    let mut lap = f64::INFINITY;
    for cut in cuts {
        let Some(joint) = cut.joint else { continue };
        let [low, high] = cut.along;
        let mut ends = Vec::new();
        if low > TIE * sizes.unit {
            ends.push(low - 0.5 * joint);
        }
        if high < sizes.length - TIE * sizes.unit {
            ends.push(high + 0.5 * joint);
        }
        let passing = (0..MOST_COURSES).filter(|k| cut.courses.alternate_with(*k as u32));
        for row in passing.flat_map(|k| &pattern[(k + first) % pattern.len()]) {
            for slot in &row.slots {
                let head = slot.start + slot.length + 0.5 * sizes.head;
                if head < sizes.length - TIE * sizes.unit {
                    let away = ends.iter().map(|end| (end - head).abs());
                    lap = away.fold(lap, f64::min);
                }
            }
        }
    }
    lap
}
