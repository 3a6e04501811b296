//! Bonds: the units of a course before openings and other walls are cut out.
//!
//! ```text
//! stretcher      header       English              Flemish
//! ├───┬───┬─┤   ├┬┬┬┬┬┬┤   ├─┬┬─┬─┬─┬─┬┬─┤   ├─┬┬───┬─┬───┬─┤   odd courses
//! ├─┬───┬───┤   ├┬┬┬┬┬┬┤   ├───┬───┬───┤     ├───┬─┬───┬─┬──┤   even courses
//! ```

use super::layout::Refusal;
use crate::deck::quantity::{Length, Quantity};
use crate::deck::schema::{Bond, DeckCourse, Wall};

/// A leaf of a course: units one after the other along the wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CourseRow {
    /// Coordinates of the front and back of the leaf [mm].
    pub through: [f64; 2],
    /// Its units.
    pub slots: Vec<Slot>,
    /// Material of its units, if it is not that of the wall.
    pub material: Option<String>,
}

/// A unit of a row, without its joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Start along the wall [mm].
    pub start: f64,
    /// Length along the wall [mm].
    pub length: f64,
    /// Whether the unit goes through all leaves behind this one.
    pub header: bool,
}

/// Lengths that differ by less than this fraction of a unit are equal: decks round to 0.01 mm, arithmetic is much
/// more accurate.
pub(super) const TOLERANCE: f64 = 1e-6;

/// Largest number of units of a course: more are a mistake in the unit of length.
pub(super) const MOST_UNITS: f64 = 1e4;

/// Sizes that define a bond [mm].
#[derive(Clone, Copy)]
pub(super) struct Sizes {
    /// Length of a stretcher.
    pub(super) unit: f64,
    /// Thickness of a stretcher, which is the length of a header along the wall.
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) bed: f64,
    pub(super) head: f64,
    pub(super) collar: f64,
    /// Length of the wall.
    pub(super) length: f64,
}

impl Sizes {
    pub(super) fn of(wall: &Wall) -> Self {
        let [unit, width, height] = wall.unit.map(Quantity::get);
        let head = wall.head_joint.get();
        Self {
            unit,
            width,
            height,
            bed: wall.bed_joint.get(),
            head,
            collar: wall.collar_joint.map_or(head, Quantity::get),
            length: wall.length.get(),
        }
    }

    pub(super) fn tolerance(&self) -> f64 {
        TOLERANCE * self.unit
    }

    /// Rejects a course with too many units.
    pub(super) fn require_few(&self) -> Result<(), Refusal> {
        let whole = (self.length / (self.unit.min(self.width) + self.head)).floor();
        if whole <= MOST_UNITS {
            return Ok(());
        }
        Err(Refusal::new(
            "length",
            format!(
                "{} mm are {whole} units of {} mm in a course",
                self.length, self.unit
            ),
            format!("at most {MOST_UNITS}: is the unit of length the one meant?"),
        ))
    }

    /// Length of the closer that shifts a course by a quarter of a stretcher and its joint.
    fn closer(&self) -> Result<f64, Refusal> {
        let closer = (self.unit + self.head) / 4.0 - self.head;
        if closer > 0.0 {
            return Ok(closer);
        }
        Err(Refusal::new(
            "head_joint",
            format!("the joint ({} mm) leaves nothing of a closer", self.head),
            "a closer is a quarter of a unit: make the head joint thinner",
        ))
    }
}

/// Courses of a wall from the lowest one; after the last one the sequence repeats.
///
/// # Errors
/// Sizes that are not compatible. If the length does not fit, the help has the nearest lengths that do.
pub fn courses(wall: &Wall) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    bond(wall).map_err(|refusal| {
        let near = if refusal.key == "length" {
            lengths_that_fit(wall)
        } else {
            Vec::new()
        };
        if near.is_empty() {
            return refusal;
        }
        let near: Vec<String> = near.iter().map(|length| format!("{length} mm")).collect();
        Refusal {
            help: format!("take {}", near.join(" or ")),
            ..refusal
        }
    })
}

/// The nearest lengths below and above that of a wall in which its bond fits [mm]: whole quarters of a unit and its
/// joint.
fn lengths_that_fit(wall: &Wall) -> Vec<f64> {
    let sizes = Sizes::of(wall);
    let quarter = 0.25 * (sizes.unit + sizes.head);
    let present = ((sizes.length + sizes.head) / quarter).floor();
    let fits = |quarters: &f64| {
        let length = quarters * quarter - sizes.head;
        let wall = Wall {
            length: Length::new(length),
            ..wall.clone()
        };
        length > 0.0 && bond(&wall).is_ok()
    };
    let away = (0..MOST_QUARTERS).map(f64::from);
    let below = away.clone().map(|k| present - k).find(fits);
    let above = away.map(|k| present + 1.0 + k).find(fits);
    let length = |quarters: f64| (1e6 * (quarters * quarter - sizes.head)).round() / 1e6;
    below.into_iter().chain(above).map(length).collect()
}

/// Quarters of a unit by which a length is changed at most to find one that fits.
const MOST_QUARTERS: u32 = 12;

/// Courses of a bond, see [`courses`].
fn bond(wall: &Wall) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    let sizes = Sizes::of(wall);
    sizes.require_few()?;
    if wall.bond == Bond::Pattern && wall.pattern.iter().all(|c| c.leaves.is_empty()) {
        return Err(Refusal::new(
            "pattern",
            "the bond is a pattern, and there is none",
            "[[wall.pattern]] with leaves = [{ units = [204] }], one for each course",
        ));
    }
    match wall.bond {
        Bond::Stretcher => with_headers(wall, &sizes, &stretchers(wall)?),
        Bond::Stack => with_headers(wall, &sizes, &[stack(&sizes)?]),
        Bond::Header => header_bond(&sizes),
        Bond::English | Bond::EnglishCross => english(wall, &sizes),
        Bond::Flemish => flemish(&sizes),
        Bond::Pattern => {
            let courses = wall.pattern.iter().enumerate();
            let courses = courses.take((wall.courses as usize).max(1));
            courses
                .map(|(k, course)| written(wall, &sizes, k, course))
                .collect()
        }
    }
}

/// Places units of these lengths one after the other.
fn slots(lengths: impl IntoIterator<Item = f64>, joint: f64) -> Vec<Slot> {
    let mut start = 0.0;
    let mut slots = Vec::new();
    for length in lengths {
        slots.push(Slot {
            start,
            length,
            header: false,
        });
        start += length + joint;
    }
    slots
}

/// Leaves with these units, one behind the other.
fn leaves(count: u32, sizes: &Sizes, slots: &[Slot]) -> Vec<CourseRow> {
    (0..count)
        .map(|leaf| {
            let front = f64::from(leaf) * (sizes.width + sizes.collar);
            CourseRow {
                through: [front, front + sizes.width],
                slots: slots.to_vec(),
                material: None,
            }
        })
        .collect()
}

/// Lengths of units from the left: the cycle is repeated, and the last unit is cut to the length.
///
/// # Errors
/// A length that ends within a joint.
fn filled(cycle: &[f64], length: f64, sizes: &Sizes) -> Result<Vec<f64>, Refusal> {
    let mut lengths = Vec::new();
    let (mut at, tolerance) = (0.0, sizes.tolerance());
    for unit in cycle.iter().copied().cycle() {
        let rest = length - at;
        if rest < unit + tolerance {
            // A difference within the tolerance is not a cut.
            lengths.push(if rest > unit - tolerance { unit } else { rest });
            break;
        }
        lengths.push(unit);
        at += unit + sizes.head;
        if length - at <= tolerance {
            return Err(within_joint(sizes, at - sizes.head));
        }
    }
    Ok(lengths)
}

fn within_joint(sizes: &Sizes, below: f64) -> Refusal {
    let (length, head) = (sizes.length, sizes.head);
    Refusal::new(
        "length",
        format!(
            "{length} mm ends within a head joint: the last unit ends at {below} mm and the next begins at \
             {} mm",
            below + head
        ),
        format!(
            "take {below} mm for whole units, or {} mm for a half unit more",
            below + head + (sizes.unit - head) / 2.0
        ),
    )
}

fn stack(sizes: &Sizes) -> Result<Vec<Slot>, Refusal> {
    let lengths = filled(&[sizes.unit], sizes.length, sizes)?;
    Ok(slots(lengths, sizes.head))
}

/// Stretcher courses: every second one mirrored, or shifted by the overlap.
fn stretchers(wall: &Wall) -> Result<Vec<Vec<Slot>>, Refusal> {
    let sizes = Sizes::of(wall);
    let Some(overlap) = wall.overlap.map(Quantity::get) else {
        return Ok(course_pattern(wall)?.into());
    };
    let first = overlap - sizes.head;
    if first <= 0.0 || overlap >= sizes.unit {
        return Err(Refusal::new(
            "overlap",
            format!(
                "units of {} mm cannot overlap by {overlap} mm: the first unit of every second course would \
                 be {first} mm long",
                sizes.unit
            ),
            format!(
                "more than the head joint, less than a unit; half bond is {} mm",
                f64::midpoint(sizes.unit, sizes.head)
            ),
        ));
    }
    let rest = Sizes {
        length: sizes.length - overlap,
        ..sizes
    };
    let mut odd = vec![first];
    odd.extend(filled(&[sizes.unit], rest.length, &sizes)?);
    Ok(vec![stack(&sizes)?, slots(odd, sizes.head)])
}

/// Courses of stretchers in the leaves of the wall, and a header course every `header_courses` courses.
fn with_headers(
    wall: &Wall,
    sizes: &Sizes,
    patterns: &[Vec<Slot>],
) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    let every = wall.header_courses.map_or(0, |n| n as usize);
    let period = patterns.len().saturating_mul(every.max(1));
    // Courses above the wall are not needed.
    let period = period.min((wall.courses as usize).max(1));
    let course = |k: usize| {
        if every > 0 && k % every + 1 == every {
            let thickness = 2.0 * sizes.width + sizes.collar;
            if (thickness - sizes.unit).abs() > sizes.tolerance() {
                return Err(Refusal::new(
                    "header_courses",
                    format!(
                        "headers of {} mm do not fit through two leaves of {thickness} mm",
                        sizes.unit
                    ),
                    format!(
                        "length of the unit = 2 times its thickness + the collar joint: collar_joint = {}",
                        sizes.unit - 2.0 * sizes.width
                    ),
                ));
            }
            return headers(sizes);
        }
        Ok(leaves(wall.leaves, sizes, &patterns[k % patterns.len()]))
    };
    (0..period).map(course).collect()
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

fn header_bond(sizes: &Sizes) -> Result<Vec<Vec<CourseRow>>, Refusal> {
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
fn english(wall: &Wall, sizes: &Sizes) -> Result<Vec<Vec<CourseRow>>, Refusal> {
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
        let half = (sizes.unit - sizes.head) / 2.0;
        let mut shifted = vec![half];
        let rest = sizes.length - half - sizes.head;
        shifted.extend(filled(&[sizes.unit], rest, sizes)?);
        courses.push(stretchers(&slots(shifted, sizes.head))?);
        courses.push(header_course()?);
    }
    Ok(courses)
}

/// A course of an English bond of three half-bricks or more: rows of stretchers and of headers, each as deep as its
/// units. `first`: whether the front has stretchers.
fn thick(
    sizes: &Sizes,
    halves: u32,
    stretchers: &[Slot],
    first: bool,
) -> Result<Vec<CourseRow>, Refusal> {
    let lacks = sizes.unit - 2.0 * sizes.width - sizes.collar;
    if lacks.abs() > sizes.tolerance() {
        return Err(Refusal::new(
            "collar_joint",
            format!(
                "headers of {} mm are not as deep as two stretchers with a collar joint of {} mm",
                sizes.unit, sizes.collar
            ),
            format!(
                "length of the unit = 2 times its thickness + the collar joint: collar_joint = {}",
                sizes.unit - 2.0 * sizes.width
            ),
        ));
    }
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

fn flemish(sizes: &Sizes) -> Result<Vec<Vec<CourseRow>>, Refusal> {
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
        .map(|lengths| {
            // A unit longer than a header is a pair of stretchers.
            let mut all = slots(lengths, sizes.head);
            for slot in &mut all {
                slot.header = slot.length < width + sizes.tolerance();
            }
            let stretchers: Vec<Slot> = all.iter().filter(|s| !s.header).copied().collect();
            let mut rows = two_leaves(sizes, &stretchers)?;
            rows[0].slots = all;
            Ok(rows)
        })
        .collect()
}

/// A course of a written bond; units may begin before the wall and extend beyond its end.
///
/// # Errors
/// A leaf that does not fill the length.
fn written(
    wall: &Wall,
    sizes: &Sizes,
    k: usize,
    course: &DeckCourse,
) -> Result<Vec<CourseRow>, Refusal> {
    let mut front = 0.0;
    let mut rows: Vec<CourseRow> = Vec::new();
    for (l, leaf) in course.leaves.iter().enumerate() {
        let thickness = leaf.thickness.unwrap_or(wall.unit[1]).get();
        let mut row = CourseRow {
            through: [front, front + thickness],
            slots: Vec::new(),
            material: leaf.material.clone(),
        };
        front += thickness + sizes.collar;
        let mut is_header = vec![false; leaf.units.len()];
        for header in &leaf.headers {
            if let Some(is_header) = is_header.get_mut(*header as usize) {
                *is_header = true;
            }
        }
        let mut start = leaf.offset.get();
        for (i, length) in leaf.units.iter().enumerate().cycle() {
            if start >= sizes.length - sizes.tolerance() {
                break;
            }
            row.slots.push(Slot {
                start,
                length: length.get(),
                header: is_header[i],
            });
            start += length.get() + sizes.head;
        }
        for (end, key) in [(0.0, "offset"), (sizes.length, "units")] {
            let there = |s: &Slot| (s.start..=s.start + s.length).contains(&end);
            let near = |s: &Slot| {
                (s.start - end).abs() <= sizes.tolerance()
                    || (s.start + s.length - end).abs() <= sizes.tolerance()
            };
            if !row.slots.iter().any(|s| there(s) || near(s)) {
                return Err(Refusal::new(
                    format!("pattern.{k}.leaves.{l}.{key}"),
                    format!("at {end} mm, where the wall ends, this leaf has no unit but a joint"),
                    "shift `offset`, or change a length, so that a unit ends or is cut there",
                ));
            }
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Units of the even courses (0, 2, …) and of the odd ones of a plain stretcher bond.
///
/// Even courses have whole units from the left; the last one is cut to the length. Odd courses are the mirror
/// image. Where whole units fill the length, the mirror image would put all head joints above each other; odd
/// courses then begin and end with a half unit of length (l − t)/2. In a length of n + ½ units the bat is such a
/// half unit. Courses of one unit, as in a prism, are all alike.
///
/// # Errors
/// A unit longer than the wall, or a length that ends within a joint.
pub fn course_pattern(wall: &Wall) -> Result<[Vec<Slot>; 2], Refusal> {
    let sizes = Sizes::of(wall);
    let (unit, joint, length) = (sizes.unit, sizes.head, sizes.length);
    let tolerance = sizes.tolerance();
    if unit > length + tolerance {
        return Err(Refusal::new(
            "unit",
            format!("the unit ({unit} mm) is longer than the wall ({length} mm)"),
            "lengthen the wall or shorten the unit",
        ));
    }
    // n units with their head joints, then the rest for the bat.
    let pitch = unit + joint;
    let whole = ((length + joint + tolerance) / pitch).floor();
    let bat = length - whole * pitch;
    let units = vec![unit; whole as usize];
    if (bat + joint).abs() <= tolerance {
        if units.len() == 1 {
            let alone = slots(units, joint);
            return Ok([alone.clone(), alone]);
        }
        let half = (unit - joint) / 2.0;
        if half <= 0.0 {
            return Err(Refusal::new(
                "head_joint",
                format!("the joint ({joint} mm) leaves nothing of a half unit"),
                "a head joint is shorter than a unit",
            ));
        }
        let mut odd = units.clone();
        odd[0] = half;
        odd.push(half);
        return Ok([slots(units, joint), slots(odd, joint)]);
    }
    if bat <= tolerance {
        let below = whole * pitch - joint;
        return Err(Refusal::new(
            "length",
            format!(
                "{length} mm ends within a head joint: {whole} units fill {below} mm and the next \
                 begins at {} mm",
                below + joint
            ),
            format!(
                "take {below} mm for {whole} whole units, or {} mm for a half unit more",
                below + joint + (unit - joint) / 2.0
            ),
        ));
    }
    let mut even = units;
    even.push(bat);
    let odd: Vec<f64> = even.iter().rev().copied().collect();
    Ok([slots(even, joint), slots(odd, joint)])
}
