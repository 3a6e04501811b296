//! Positions of the units of a wall and of their joints, computed before the mesh.
//!
//! A unit has the bed joint on top of it, the head joint at its far end along the wall, and the nearer halves of the
//! collar joints before and behind it, if other units lie there. So a wall of leaves that are mirror images of each other
//! is its own mirror image, mortar included. Where another wall passes through, the units that end there have the joint to
//! it.

use super::course::{CourseRow, Sizes, Slot};
use super::openings;
use super::snap::{self, Part, Snapped};
use crate::deck::quantity::Quantity;
use crate::deck::schema::{Bond, Deck, Wall};
use crate::error::{ErrorKind, ModelError};
use crate::model::axis::Axis;

/// A unit and its joints: boxes in the axes of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// The unit [mm]. `[xyz][low, high]`
    pub own: [[f64; 2]; 3],
    /// The unit with its joints [mm]. `[xyz][low, high]`
    pub all: [[f64; 2]; 3],
    /// Course on which it stands, from 0.
    pub course: u16,
    /// Kind of the unit.
    pub kind: Kind,
    /// Material, if it is not that of the wall's units.
    pub material: Option<String>,
    /// Whether it ends in the middle of a joint that a plane of symmetry cuts. `[xyz]`
    pub mirror: [bool; 3],
    /// Which half of a unit that can crack in its middle; none: the whole unit.
    pub half: Option<Half>,
}

/// Half of a unit that can crack in its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// The half towards the start of the wall.
    Left,
    /// The other one.
    Right,
}

/// Whether a body of a wall is a unit of a course or the lintel above an opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A unit, with its index in its course.
    Unit(u32),
    /// The lintel of an opening, with the index of the opening.
    Lintel(u32),
}

impl Unit {
    /// Name of the unit in a wall of this name.
    pub fn name(&self, wall: &str) -> String {
        let whole = self.whole_name(wall);
        match self.half {
            None => whole,
            Some(Half::Left) => format!("{whole}-left"),
            Some(Half::Right) => format!("{whole}-right"),
        }
    }

    /// Name of the unit, or of the unit of which it is a half.
    pub fn whole_name(&self, wall: &str) -> String {
        match self.kind {
            Kind::Unit(index) => format!("{wall}-{}-{index}", self.course),
            Kind::Lintel(opening) => format!("{wall}-lintel-{opening}"),
        }
    }

    /// Thickness of the joint at one of its sides [mm]; 0 without a joint.
    pub fn joint(&self, axis: usize, high: bool) -> f64 {
        let side = usize::from(high);
        (self.all[axis][side] - self.own[axis][side]).abs()
    }
}

/// Reason why a wall cannot be built.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// Key of the wall that causes the error.
    pub key: String,
    /// Message.
    pub message: String,
    /// Advice how to correct it.
    pub help: String,
}

impl Refusal {
    pub(in crate::deck) fn new(
        key: impl Into<String>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        Self {
            key: key.into(),
            message: message.into(),
            help: help.into(),
        }
    }

    /// Converts it to an error of the wall at `path`.
    pub fn at(self, deck: &Deck, path: &str) -> ModelError {
        deck.error(&format!("{path}.{}", self.key), self.message, &self.help)
            .of_kind(ErrorKind::Geometry)
    }
}

/// A part of some courses that is removed: an opening, a lintel, another wall.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    /// Range along the wall [mm].
    pub(super) along: [f64; 2],
    /// Courses concerned.
    pub(super) courses: Courses,
    /// Thickness of the joint of units that end there [mm]; none: they end without a joint.
    pub(super) joint: Option<f64>,
    /// Whether a lintel fills it, at which units end with a head joint.
    pub(super) filled: bool,
    /// Description for errors, and the key.
    pub(super) what: String,
    pub(super) key: String,
}

/// Some courses of a wall.
#[derive(Clone, Copy, Debug)]
pub(super) enum Courses {
    /// From the first to before the second.
    Range(u32, u32),
    /// Every second one, from the first (0 or 1) to before the second.
    Every(u32, u32),
}

impl Courses {
    fn has(self, k: u32) -> bool {
        match self {
            Self::Range(from, to) => (from..to).contains(&k),
            Self::Every(first, end) => k % 2 == first && k < end,
        }
    }

    /// Whether course `k` lies between two of every second course.
    pub(super) fn alternate_with(self, k: u32) -> bool {
        match self {
            Self::Range(..) => false,
            Self::Every(first, end) => k % 2 != first && k < end,
        }
    }
}

/// A piece of a course in the axes of the wall.
#[derive(Clone, Debug)]
struct Piece {
    along: [f64; 2],
    through: [f64; 2],
    /// Ends of its joints to another wall, where they make it longer [mm].
    reach: [Option<f64>; 2],
    row: usize,
    material: Option<String>,
    kind: Kind,
    /// Height in courses.
    courses: u32,
}

/// Computes the units of a wall with the courses `pattern`, from which `cuts` are removed, and its lintels with these
/// `spans`. Short pieces are joined to their neighbours.
///
/// # Errors
/// Sizes that are not compatible, openings that leave slivers without a neighbour.
pub(super) fn lay(
    wall: &Wall,
    mut pattern: Vec<Vec<CourseRow>>,
    cuts: &[Cut],
    spans: &[[f64; 2]],
    snapped: &mut Snapped,
) -> Result<Vec<Unit>, Refusal> {
    snap::join_bats(wall, &mut pattern, snapped);
    snap::end_at_walls(wall, &mut pattern, cuts);
    let sizes = Sizes::of(wall);
    let levels = levels(wall);
    let laid: Vec<Vec<Piece>> = (0..wall.courses)
        .map(|k| {
            let rows = &pattern[k as usize % pattern.len()];
            let own = Course { k, rows, spans };
            pieces(wall, &sizes, &own, cuts, snapped)
        })
        .collect::<Result<_, _>>()?;
    let higher: Vec<(usize, &Piece)> = laid
        .iter()
        .enumerate()
        .flat_map(|(k, pieces)| pieces.iter().map(move |piece| (k, piece)))
        .filter(|(_, piece)| piece.courses > 1)
        .collect();
    let orders: Vec<Ordered<'_>> = laid.iter().map(|course| Ordered::of(course)).collect();
    let mut units = Vec::with_capacity(laid.iter().map(Vec::len).sum());
    for (k, course) in laid.iter().enumerate() {
        let beside = Neighbours::of(&sizes, course);
        for piece in course {
            let next = k + piece.courses as usize;
            let above = orders
                .get(next)
                .into_iter()
                .flat_map(|order| order.along(piece.along));
            let standing = higher
                .iter()
                .filter(|(j, p)| *j < next && next < *j + p.courses as usize);
            // Where another wall passes through, its units lie on this piece.
            let passing = cuts.iter().any(|cut| {
                let passes = cut.joint.is_some() && cut.courses.has(next as u32);
                passes && beside.overlaps(cut.along, piece.along)
            });
            let covered = above.chain(standing.map(|(_, piece)| *piece)).any(|p| {
                beside.overlaps(p.along, piece.along) && beside.overlaps(p.through, piece.through)
            });
            let high = levels[next - 1].1;
            let top = if covered || passing {
                levels[next].0
            } else {
                high
            };
            units.push(unit(wall, piece, [levels[k].0, high, top], k, &beside));
        }
    }
    Ok(units)
}

/// Bottom and top of the units of each course [mm].
pub(in crate::deck) fn levels(wall: &Wall) -> Vec<(f64, f64)> {
    let sizes = Sizes::of(wall);
    let base = wall.at[2].get();
    let heights: Vec<f64> = match wall.bond {
        Bond::Pattern => {
            let own =
                |c: &crate::deck::schema::DeckCourse| c.height.map_or(sizes.height, Quantity::get);
            wall.pattern.iter().map(own).collect()
        }
        _ => vec![sizes.height],
    };
    let even = heights.iter().all(|h| *h == sizes.height);
    let mut at = 0.0;
    let level = |k: usize| {
        let height = heights[k % heights.len()];
        // Multiples of the rise, not sums of it: courses of all walls have bitwise equal levels.
        let bottom = if even {
            k as f64 * (sizes.height + sizes.bed)
        } else {
            at
        };
        at = bottom + height + sizes.bed;
        (base + bottom, base + (bottom + height))
    };
    (0..wall.courses as usize).map(level).collect()
}

/// A course before anything is cut out.
struct Course<'a> {
    /// Its number.
    k: u32,
    /// Its leaves.
    rows: &'a [CourseRow],
    /// Ranges of all lintels of the wall. `[opening]`
    spans: &'a [[f64; 2]],
}

/// Pieces of a course, leaf by leaf, from the left, then its lintels.
fn pieces(
    wall: &Wall,
    sizes: &Sizes,
    course: &Course<'_>,
    cuts: &[Cut],
    snapped: &mut Snapped,
) -> Result<Vec<Piece>, Refusal> {
    let Course { k, rows, spans } = *course;
    let here: Vec<&Cut> = cuts.iter().filter(|cut| cut.courses.has(k)).collect();
    let mut pieces: Vec<Piece> = Vec::new();
    let mut headers: Vec<[f64; 2]> = Vec::new();
    let back = rows.iter().map(|r| r.through[1]).fold(0.0, f64::max);
    for (r, row) in rows.iter().enumerate() {
        for interval in intervals(sizes, &here, &headers) {
            let parts = snap::parts(&row.slots, &interval, sizes);
            let parts = snap::join(parts, &interval, sizes, snapped);
            for part in parts {
                let Part { along, slot } = part;
                if snap::is_sliver(&part, sizes) {
                    return Err(snap::refused(&interval, along, [k, r as u32]));
                }
                let end = if slot.header { back } else { row.through[1] };
                pieces.push(Piece {
                    along,
                    through: [row.through[0], end],
                    reach: interval.reached_by(along, sizes),
                    row: r,
                    material: row.material.clone(),
                    kind: Kind::Unit(0),
                    courses: 1,
                });
                if slot.header && r + 1 < rows.len() {
                    headers.push(along);
                }
            }
        }
    }
    pieces.extend(
        openings::lintels(wall, rows, k, spans).map(|(o, along, back, lintel)| Piece {
            along,
            through: [0.0, back],
            reach: [None; 2],
            row: 0,
            material: lintel.material.clone(),
            kind: Kind::Lintel(o),
            courses: lintel.courses,
        }),
    );
    number(&mut pieces);
    Ok(pieces)
}

/// Sorts pieces from the front leaf to the back and from left to right, and numbers the units among them.
fn number(pieces: &mut [Piece]) {
    pieces.sort_by(|a, b| {
        (a.row, a.along[0])
            .partial_cmp(&(b.row, b.along[0]))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let mut index = 0;
    for piece in pieces {
        if let Kind::Unit(i) = &mut piece.kind {
            *i = index;
            index += 1;
        }
    }
}

/// A range of a course between cuts.
pub(super) struct Interval<'a> {
    pub(super) along: [f64; 2],
    /// Ends of the joints to the cuts at either end, where there are any [mm].
    reach: [Option<f64>; 2],
    /// Cuts at its ends.
    pub(super) cut: [Option<&'a Cut>; 2],
}

impl Interval<'_> {
    /// Range of the part of a unit in this interval [mm], if there is any.
    pub(super) fn part_of(&self, slot: &Slot, sizes: &Sizes) -> Option<[f64; 2]> {
        let [low, high] = self.along;
        let along = [slot.start.max(low), (slot.start + slot.length).min(high)];
        (along[1] - along[0] > sizes.tolerance()).then_some(along)
    }

    /// Ends of the joints to cuts that a piece at `along` reaches.
    fn reached_by(&self, along: [f64; 2], sizes: &Sizes) -> [Option<f64>; 2] {
        let touches =
            |side: usize| (along[side] - self.along[side]).abs() <= sizes.head + sizes.tolerance();
        [0, 1].map(|side| self.reach[side].filter(|_| touches(side)))
    }
}

/// Ranges of a course between its cuts and beside the headers of the leaves in front.
fn intervals<'a>(sizes: &Sizes, cuts: &[&'a Cut], headers: &[[f64; 2]]) -> Vec<Interval<'a>> {
    struct Taken<'a> {
        along: [f64; 2],
        reach: Option<[f64; 2]>,
        cut: Option<&'a Cut>,
    }
    let of_cut = |cut: &&'a Cut| {
        let joint = cut.joint.unwrap_or(0.0);
        Taken {
            along: [cut.along[0] - joint, cut.along[1] + joint],
            reach: cut.joint.map(|_| cut.along),
            cut: Some(*cut),
        }
    };
    let of_header = |header: &[f64; 2]| Taken {
        along: [header[0] - sizes.head, header[1] + sizes.head],
        reach: None,
        cut: None,
    };
    let mut taken: Vec<Taken<'a>> = cuts.iter().map(of_cut).collect();
    taken.extend(headers.iter().map(of_header));
    taken.sort_by(|a, b| a.along[0].total_cmp(&b.along[0]));
    let mut free = Vec::new();
    let mut open = Interval {
        along: [0.0, sizes.length],
        reach: [None; 2],
        cut: [None; 2],
    };
    for part in taken {
        if part.along[0] > open.along[0] + sizes.tolerance() {
            free.push(Interval {
                along: [open.along[0], part.along[0].min(sizes.length)],
                reach: [open.reach[0], part.reach.map(|r| r[0])],
                cut: [open.cut[0], part.cut],
            });
        }
        if part.along[1] > open.along[0] {
            open.along[0] = part.along[1];
            open.reach[0] = part.reach.map(|r| r[1]);
            open.cut[0] = part.cut;
        }
    }
    if open.along[0] < sizes.length - sizes.tolerance() {
        free.push(open);
    }
    free
}

/// Pieces of a course in the order of their starts.
struct Ordered<'a> {
    pieces: Vec<&'a Piece>,
    /// Length of the longest piece [mm].
    longest: f64,
}

impl<'a> Ordered<'a> {
    fn of(course: &'a [Piece]) -> Self {
        let mut pieces: Vec<&Piece> = course.iter().collect();
        pieces.sort_by(|a, b| a.along[0].total_cmp(&b.along[0]));
        let lengths = course.iter().map(|p| p.along[1] - p.along[0]);
        let longest = lengths.fold(0.0, f64::max);
        Self { pieces, longest }
    }

    /// Pieces that begin in this range [mm].
    fn from(&self, begin: f64, end: f64) -> impl Iterator<Item = &'a Piece> {
        let first = self.pieces.partition_point(|p| p.along[0] < begin);
        let rest = self.pieces[first..].iter().copied();
        rest.take_while(move |p| p.along[0] <= end)
    }

    /// Candidates for an overlap with this range [mm]: all pieces that overlap it, and possibly more.
    fn along(&self, [from, to]: [f64; 2]) -> impl Iterator<Item = &'a Piece> {
        self.from(from - self.longest, to)
    }
}

/// Neighbours of the pieces of a course.
struct Neighbours<'a> {
    sizes: &'a Sizes,
    course: Ordered<'a>,
}

impl<'a> Neighbours<'a> {
    fn of(sizes: &'a Sizes, course: &'a [Piece]) -> Self {
        let course = Ordered::of(course);
        Self { sizes, course }
    }

    fn overlaps(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        a[1].min(b[1]) - a[0].max(b[0]) > self.sizes.tolerance()
    }

    /// Start of the next piece along the wall, if only a joint lies between.
    fn next(&self, piece: &Piece) -> Option<f64> {
        let end = piece.along[1];
        // Joints to a lintel or a header may be wider where they do not fit the bond.
        let most = 2.0 * self.sizes.head + self.sizes.tolerance();
        let near = self
            .course
            .from(end - 2.0 * self.sizes.tolerance(), end + 2.0 * most);
        let starts = near.filter(|p| {
            let gap = p.along[0] - end;
            self.overlaps(p.through, piece.through) && gap > -self.sizes.tolerance() && gap <= most
        });
        starts.map(|p| p.along[0]).min_by(f64::total_cmp)
    }

    /// Front of the leaf behind the piece, if it has one.
    fn behind(&self, piece: &Piece) -> Option<f64> {
        let back = piece.through[1];
        let behind = self.course.along(piece.along).filter(|p| {
            p.through[0] > back - self.sizes.tolerance() && self.overlaps(p.along, piece.along)
        });
        behind.map(|p| p.through[0]).min_by(f64::total_cmp)
    }

    /// Back of the leaf before the piece, if it has one.
    fn before(&self, piece: &Piece) -> Option<f64> {
        let front = piece.through[0];
        let before = self.course.along(piece.along).filter(|p| {
            p.through[1] < front + self.sizes.tolerance() && self.overlaps(p.along, piece.along)
        });
        before.map(|p| p.through[1]).max_by(f64::total_cmp)
    }
}

/// The unit of a piece, with its joints, in the axes of the scene.
fn unit(
    wall: &Wall,
    piece: &Piece,
    [low, high, top]: [f64; 3],
    k: usize,
    beside: &Neighbours<'_>,
) -> Unit {
    let [from, to] = piece.along;
    let end = beside.next(piece).or(piece.reach[1]).unwrap_or(to);
    let start = piece.reach[0].unwrap_or(from);
    let [front, back] = piece.through;
    // The middle of a joint is the same number for the units on both sides.
    let before = beside.before(piece).map_or(front, |x| 0.5 * (x + front));
    let behind = beside.behind(piece).map_or(back, |x| 0.5 * (back + x));
    let all = [
        [start.min(from), end.max(to)],
        [before.min(front), behind.max(back)],
        [low, top.max(high)],
    ];
    let own = [piece.along, piece.through, [low, high]];
    let own = up_to_neighbours(own, all, beside.sizes.tolerance());
    Unit {
        own: placed(wall, own),
        all: placed(wall, all),
        course: k as u16,
        kind: piece.kind,
        material: piece.material.clone(),
        mirror: [false; 3],
        half: None,
    }
}

/// A unit with its faces moved to the ends of its joints where these are thinner than the tolerance [mm]. Such joints
/// follow from rounding: they would be elements without volume.
fn up_to_neighbours(own: [[f64; 2]; 3], all: [[f64; 2]; 3], tolerance: f64) -> [[f64; 2]; 3] {
    let end = |d: usize, side: usize| {
        let (own, all) = (own[d][side], all[d][side]);
        let is_joint = (all - own).abs() > tolerance;
        if is_joint { own } else { all }
    };
    [0, 1, 2].map(|d| [end(d, 0), end(d, 1)])
}

/// Converts a box along, through and up a wall to the axes of the scene.
fn placed(wall: &Wall, [along, through, up]: [[f64; 2]; 3]) -> [[f64; 2]; 3] {
    let at = wall.at.map(Quantity::get);
    let moved = |range: [f64; 2], by: f64| range.map(|x| if by == 0.0 { x } else { by + x });
    match wall.along {
        Axis::Y => [moved(through, at[0]), moved(along, at[1]), up],
        Axis::X | Axis::Z => [moved(along, at[0]), moved(through, at[1]), up],
    }
}
