//! Short pieces beside openings, other walls and the ends of a wall, joined to their neighbours.
//!
//! ```text
//! cut in a unit                      joined
//! ┌────────┬┬───────┬┬─┐             ┌────────┬┬──────────┐
//! │        ││       ││ │ opening     │        ││          │ opening
//! └────────┴┴───────┴┴─┘             └────────┴┴──────────┘
//! ```

use super::course::{CourseRow, Sizes, Slot};
use super::layout::{Cut, Interval, Refusal};
use super::plan::flush;
use crate::deck::schema::{Bond, Wall};

/// A piece shorter than this fraction of a unit is a sliver.
const SLIVER: f64 = 0.1;

/// Pieces that were joined to their neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Snapped {
    /// Length below which a piece is joined [mm].
    pub below: f64,
    /// Number of units that became longer.
    pub count: usize,
    /// Largest length by which a unit became longer [mm].
    pub longest: f64,
}

/// A part of a unit between two cuts of its course.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Range along the wall [mm].
    pub(super) along: [f64; 2],
    /// The unit in its bond.
    pub(super) slot: Slot,
}

impl Part {
    fn length(&self) -> f64 {
        self.along[1] - self.along[0]
    }

    /// Whether less than the unit is left.
    fn is_cut(&self) -> bool {
        let Slot { start, length, .. } = self.slot;
        self.along != [start, start + length]
    }
}

impl Snapped {
    /// Nothing joined yet in this wall.
    pub(super) fn new(wall: &Wall) -> Self {
        Self {
            below: wall.snap_below(),
            ..Self::default()
        }
    }

    /// Extends a range to the end of an interval if the gap is wider than a joint, and no wider than a joint and a
    /// piece. Beside a lintel, whose joint lies beyond the end, no gap is left.
    fn extend(&mut self, range: &mut [f64; 2], side: usize, at: &Interval<'_>, sizes: &Sizes) {
        let end = at.along[side];
        let gap = (end - range[side]).abs();
        let joint = match at.cut[side] {
            Some(cut) if cut.filled && self.below > 0.0 => 0.0,
            _ => sizes.head,
        };
        if gap > joint + sizes.tolerance() && gap <= sizes.head + self.below {
            range[side] = end;
            self.note(gap);
        }
    }

    /// Counts a change of length [mm]; 0: none.
    pub(super) fn note(&mut self, by: f64) {
        self.count += usize::from(by > 0.0);
        self.longest = self.longest.max(by);
    }

    /// Extends a lintel over the room between its head joint and a neighbour or the end of the wall, if that is
    /// narrower than a piece. `room`: the places where its head joint and the neighbour begin [mm].
    pub(super) fn extend_lintel(&mut self, range: &mut [f64; 2], side: usize, room: [f64; 2]) {
        let width = (room[1] - room[0]) * if side == 0 { -1.0 } else { 1.0 };
        if width > 0.0 && width < self.below {
            self.note((room[1] - range[side]).abs());
            range[side] = room[1];
        }
    }
}

/// Joins the short bats of a bond to the units before them, or after them at the start. A written bond is left as it
/// is.
pub(super) fn join_bats(wall: &Wall, bond: &mut [Vec<CourseRow>], snapped: &mut Snapped) {
    if wall.bond == Bond::Pattern {
        return;
    }
    let repeats = wall.courses as usize / bond.len().max(1);
    let sizes = Sizes::of(wall);
    for row in bond.iter_mut().flatten() {
        let mut joined: Vec<Slot> = Vec::with_capacity(row.slots.len());
        let mut short: Option<Slot> = None;
        for slot in std::mem::take(&mut row.slots) {
            let is_beside = |before: &Slot| {
                let gap = slot.start - (before.start + before.length);
                gap <= sizes.head + sizes.tolerance()
            };
            let by = sizes.head + slot.length;
            if slot.length >= snapped.below - sizes.tolerance() {
                let start = short
                    .take()
                    .filter(is_beside)
                    .map_or(slot.start, |s| s.start);
                let longer = slot.start - start;
                snapped.note(longer);
                joined.push(Slot {
                    start,
                    length: slot.length + longer,
                    ..slot
                });
            } else if let Some(before) = joined.last_mut().filter(|before| is_beside(before)) {
                before.length += by;
                snapped.note(by);
                snapped.count += repeats.saturating_sub(1);
            } else {
                short = Some(slot);
            }
        }
        // A bond of nothing else stays.
        joined.extend(short.filter(|_| row.slots.is_empty() && joined.is_empty()));
        row.slots = joined;
    }
}

/// Moves ends of units of a dry wall that miss the face of a wall which meets it by rounding onto this face: units of both
/// walls then end in one plane, in all courses.
pub(super) fn end_at_walls(wall: &Wall, bond: &mut [Vec<CourseRow>], cuts: &[Cut]) {
    let sizes = Sizes::of(wall);
    if sizes.head > sizes.tolerance() {
        return;
    }
    let walls = cuts.iter().filter(|cut| cut.joint.is_some());
    let faces: Vec<f64> = walls.flat_map(|cut| cut.along).collect();
    let rounding = flush(wall);
    let on_face = |x: f64| {
        let near = |face: &&f64| (**face - x).abs() <= rounding;
        faces.iter().find(near).copied().unwrap_or(x)
    };
    for slot in bond.iter_mut().flatten().flat_map(|row| &mut row.slots) {
        let own = [slot.start, slot.start + slot.length];
        let moved = own.map(on_face);
        if moved != own && moved[1] > moved[0] {
            (slot.start, slot.length) = (moved[0], moved[1] - moved[0]);
        }
    }
}

/// Parts of the units of a row in an interval, in order.
pub(super) fn parts(slots: &[Slot], interval: &Interval<'_>, sizes: &Sizes) -> Vec<Part> {
    let part = |slot: &Slot| {
        let along = interval.part_of(slot, sizes)?;
        Some(Part { along, slot: *slot })
    };
    slots.iter().filter_map(part).collect()
}

/// Joins short pieces at the ends of an interval to their neighbours, which fill the interval up to its ends.
pub(super) fn join(
    mut parts: Vec<Part>,
    interval: &Interval<'_>,
    sizes: &Sizes,
    snapped: &mut Snapped,
) -> Vec<Part> {
    for side in [0, 1] {
        let last = |parts: &[Part]| if side == 0 { 0 } else { parts.len() - 1 };
        let mut dropped = false;
        if parts.len() > 1 {
            let end = &parts[last(&parts)];
            dropped = end.is_cut() && end.length() < snapped.below - sizes.tolerance();
            if dropped {
                parts.remove(last(&parts));
            }
        }
        let wall_end = [0.0, sizes.length][side];
        let is_wall_end = (interval.along[side] - wall_end).abs() <= sizes.tolerance();
        if (dropped || is_wall_end || interval.cut[side].is_some()) && !parts.is_empty() {
            let end = last(&parts);
            snapped.extend(&mut parts[end].along, side, interval, sizes);
        }
    }
    parts
}

/// Whether a piece is so short that no wall can be built with it.
pub(super) fn is_sliver(part: &Part, sizes: &Sizes) -> bool {
    part.is_cut() && part.length() < SLIVER * sizes.unit.min(part.slot.length)
}

/// Error of a sliver that no neighbour can take. `place`: its course and leaf.
pub(super) fn refused(interval: &Interval<'_>, along: [f64; 2], place: [u32; 2]) -> Refusal {
    // The cut at the nearer end is named in the error.
    let side =
        usize::from((along[1] - interval.along[1]).abs() < (along[0] - interval.along[0]).abs());
    let cut = interval.cut[side].or(interval.cut[1 - side]);
    let what = cut.map_or("a header, or the end of the wall,", |cut| &cut.what);
    let ([from, to], [k, leaf]) = (along, place);
    Refusal::new(
        cut.map_or_else(|| "pattern".to_owned(), |cut| cut.key.clone()),
        format!(
            "{what} leaves a sliver of {:.2} mm of a unit in course {k}, leaf {leaf}, from {from:.2} to \
             {to:.2} mm along the wall",
            to - from
        ),
        "let it end at a head joint, or farther into the unit; `snap` joins a short piece to its neighbour in the \
         course, where there is one",
    )
}
