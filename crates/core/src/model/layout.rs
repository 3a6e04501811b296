//! Where the units of a wall lie: plain arithmetic along each course, before any mesh.
//!
//! ```text
//! course 1 ┌──124──┬──204──┬──204──┬──204──┬──204──┐   mirrored
//! course 0 ├──204──┬──204──┬──204──┬──204──┬──124──┤   whole units, then the bat
//!          0                                      990
//! ```

use super::deck::Wall;

/// One unit of a course, without its joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Its −x face [mm].
    pub start: f64,
    /// Its length [mm].
    pub length: f64,
    /// Thickness of the head joint at its +x end [mm]; 0 for the last of the course.
    pub head_joint: f64,
}

/// The wall cannot be laid so.
#[derive(Clone, Debug)]
pub struct Refusal {
    /// Key to blame.
    pub key: &'static str,
    /// What is wrong.
    pub message: String,
    /// How to mend it.
    pub help: String,
}

/// Lengths agree to this fraction of a unit: decks round to 0.01 mm, arithmetic to much less.
const TOLERANCE: f64 = 1e-6;

/// More units than this in a course are a slip of the unit of length.
const MOST_UNITS: f64 = 1e4;

/// Units of the even courses (0, 2, …) and of the odd ones.
///
/// Even courses: whole units from the left, the last one cut to the length. Odd courses: the mirror
/// image. Where whole units fill the length, its mirror image would put all head joints above each
/// other, so odd courses begin and end with a half unit of length (l − t)/2. A length of n + ½ units
/// makes the bat a half unit of itself. A course of one unit is a prism: all courses alike.
///
/// # Errors
/// A unit longer than the wall, or a length that ends within a joint.
pub fn course_pattern(wall: &Wall) -> Result<[Vec<Slot>; 2], Refusal> {
    let (unit, joint) = (wall.unit[0].get(), wall.head_joint.get());
    let length = wall.length.get();
    let tolerance = TOLERANCE * unit;
    if unit > length + tolerance {
        return Err(Refusal {
            key: "wall.unit",
            message: format!("the unit ({unit} mm) is longer than the wall ({length} mm)"),
            help: "lengthen the wall or shorten the unit".to_owned(),
        });
    }
    // n pitches and the rest: n units with their head joints, then what is left for the bat.
    let pitch = unit + joint;
    let whole = ((length + joint + tolerance) / pitch).floor();
    if whole > MOST_UNITS {
        return Err(Refusal {
            key: "wall.length",
            message: format!("{length} mm are {whole} units of {unit} mm in a course"),
            help: format!("at most {MOST_UNITS}: is the unit of length the one meant?"),
        });
    }
    let bat = length - whole * pitch;
    let units = vec![unit; whole as usize];
    if (bat + joint).abs() <= tolerance {
        if units.len() == 1 {
            let alone = slots(&units, joint);
            return Ok([alone.clone(), alone]);
        }
        let half = (unit - joint) / 2.0;
        if half <= 0.0 {
            return Err(Refusal {
                key: "wall.head_joint",
                message: format!("the joint ({joint} mm) leaves nothing of a half unit"),
                help: "a head joint is shorter than a unit".to_owned(),
            });
        }
        let mut odd = units.clone();
        odd[0] = half;
        odd.push(half);
        return Ok([slots(&units, joint), slots(&odd, joint)]);
    }
    if bat <= tolerance {
        let below = whole * pitch - joint;
        return Err(Refusal {
            key: "wall.length",
            message: format!(
                "{length} mm ends within a head joint: {whole} units fill {below} mm and the next \
                 begins at {} mm",
                below + joint
            ),
            help: format!(
                "take {below} mm for {whole} whole units, or {} mm for a half unit more",
                below + joint + (unit - joint) / 2.0
            ),
        });
    }
    let mut even = units;
    even.push(bat);
    let odd: Vec<f64> = even.iter().rev().copied().collect();
    Ok([slots(&even, joint), slots(&odd, joint)])
}

/// Units of these lengths one after the other.
fn slots(lengths: &[f64], joint: f64) -> Vec<Slot> {
    let mut start = 0.0;
    let mut slots = Vec::with_capacity(lengths.len());
    for (i, &length) in lengths.iter().enumerate() {
        let head_joint = if i + 1 < lengths.len() { joint } else { 0.0 };
        slots.push(Slot {
            start,
            length,
            head_joint,
        });
        start += length + head_joint;
    }
    slots
}

/// The shortest unit, and the least distance from a head joint to one of the next course [mm].
/// Small numbers mean slivers and through joints.
pub fn bat_and_lap(pattern: &[Vec<Slot>; 2]) -> (f64, f64) {
    let middle = |s: &Slot| s.start + s.length + s.head_joint / 2.0;
    let heads = |course: &[Slot]| -> Vec<f64> {
        course
            .iter()
            .filter(|s| s.head_joint > 0.0)
            .map(middle)
            .collect()
    };
    let (even, odd) = (heads(&pattern[0]), heads(&pattern[1]));
    let distances = even
        .iter()
        .flat_map(|a| odd.iter().map(move |b| (a - b).abs()));
    let shortest = pattern
        .iter()
        .flatten()
        .map(|s| s.length)
        .fold(f64::INFINITY, f64::min);
    (shortest, distances.fold(f64::INFINITY, f64::min))
}
