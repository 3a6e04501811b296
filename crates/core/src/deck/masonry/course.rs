//! Units of a course before openings and other walls are cut out, and bonds of stretchers.

use super::layout::Refusal;
use crate::deck::quantity::Quantity;
use crate::deck::schema::{DeckCourse, Wall};

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
    pub(super) fn closer(&self) -> Result<f64, Refusal> {
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

/// Places units of these lengths one after the other.
pub(super) fn slots(lengths: impl IntoIterator<Item = f64>, joint: f64) -> Vec<Slot> {
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
pub(super) fn leaves(count: u32, sizes: &Sizes, slots: &[Slot]) -> Vec<CourseRow> {
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
pub(super) fn filled(cycle: &[f64], length: f64, sizes: &Sizes) -> Result<Vec<f64>, Refusal> {
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

pub(super) fn stack(sizes: &Sizes) -> Result<Vec<Slot>, Refusal> {
    let lengths = filled(&[sizes.unit], sizes.length, sizes)?;
    Ok(slots(lengths, sizes.head))
}

/// Stretcher courses: every second one mirrored, or shifted by the overlap.
pub(super) fn stretchers(wall: &Wall) -> Result<Vec<Vec<Slot>>, Refusal> {
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

/// A course of a written bond; units may begin before the wall and extend beyond its end.
///
/// # Errors
/// A leaf that does not fill the length.
pub(super) fn written(
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
