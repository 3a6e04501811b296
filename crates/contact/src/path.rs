//! Entry of a point through a facet, or of one edge past another, during an increment.
//!
//! The path of an increment, seen from the facet, is taken as a straight line in (ξ, η, gap). This is exact if the
//! two bodies do not rotate relative to each other. The point is in contact if it entered through the face from
//! outside. A point that arrives from the side or from behind meets another face.

/// A position in the parameters of a facet or of two edges, with the gap [mm].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Parameters [-].
    pub at: [f64; 2],
    /// Gap, positive when open [mm].
    pub gap: f64,
}

/// Entry of a point into contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Fraction of the path at entry, 0 to 1.
    pub time: f64,
    /// Parameters at entry.
    pub at: [f64; 2],
    /// Gap at entry [mm]: 0, or negative if the point was already below the face when it came over it.
    pub gap: f64,
}

/// The interval of the path on which both parameters lie in their ranges `[low, high]`, if there is one.
fn within(start: &Place, end: &Place, range: &[[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for i in 0..2 {
        let [low, high] = range[i];
        let (a, way) = (start.at[i], end.at[i] - start.at[i]);
        if way == 0.0 {
            if !(low..=high).contains(&a) {
                return None;
            }
            continue;
        }
        let (first, second) = ((low - a) / way, (high - a) / way);
        from = from.max(first.min(second));
        to = to.min(first.max(second));
    }
    (from <= to).then_some([from, to])
}

/// Whether and where the path from `start` to `end` enters through a face with the parameter ranges `[low, high]`.
///
/// The path enters where the gap closes over the face. It also enters where it comes over the face at most `behind`
/// [mm] below it, so that flush or slightly penetrating bodies keep sliding instead of catching on the side of the
/// face.
pub fn entry(start: &Place, end: &Place, range: &[[f64; 2]; 2], behind: f64) -> Option<Entry> {
    if end.gap >= 0.0 || start.gap < -behind {
        return None;
    }
    let [over, off] = within(start, end, range)?;
    let gap_at = |time: f64| start.gap + time * (end.gap - start.gap);
    let closes = if start.gap > 0.0 {
        start.gap / (start.gap - end.gap)
    } else {
        0.0
    };
    if closes > off {
        return None;
    }
    let (time, gap) = if closes >= over {
        (closes, start.gap.min(0.0))
    } else {
        (over, gap_at(over))
    };
    // A point that passed through the face and has left its range since is not in contact with it.
    (gap >= -behind).then(|| Entry {
        time,
        at: [0, 1].map(|i| start.at[i] + time * (end.at[i] - start.at[i])),
        gap,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACE: [[f64; 2]; 2] = [[-1.0, 1.0]; 2];

    fn way(from: [f64; 3], to: [f64; 3]) -> Option<Entry> {
        let place = |[s, t, gap]: [f64; 3]| Place { at: [s, t], gap };
        entry(&place(from), &place(to), &FACE, 0.1)
    }

    #[test]
    fn a_point_that_enters_through_the_face_is_in_contact_there() {
        let entry = way([0.0, -0.5, 3.0], [1.0, 0.5, -1.0]).unwrap();
        assert_eq!((entry.time, entry.at, entry.gap), (0.75, [0.75, 0.25], 0.0));
        // The end lies beyond the face, but the path went through it.
        let entry = way([0.0, 0.0, 1.0], [4.0, 0.0, -3.0]).unwrap();
        assert_eq!((entry.time, entry.at), (0.25, [1.0, 0.0]));
    }

    #[test]
    fn a_point_that_arrives_from_the_side_or_from_behind_is_not_in_contact() {
        assert_eq!(way([-3.0, 0.0, -1.0], [0.0, 0.0, -1.0]), None);
        assert_eq!(way([0.0, 0.0, -1.0], [0.0, 0.0, -2.0]), None);
        // The path crosses the plane beside the face and then passes below it.
        assert_eq!(way([-3.0, 0.0, 0.5], [0.0, 0.0, -2.5]), None);
        // The path starts over the face, but the gap closes beside it.
        assert_eq!(way([0.0, 0.0, 3.0], [4.0, 0.0, -1.0]), None);
        // The gap stays open.
        assert_eq!(way([0.0, 0.0, 3.0], [0.0, 0.0, 0.0]), None);
    }

    #[test]
    fn a_point_that_slides_over_the_rim_slightly_below_the_face_is_in_contact() {
        let entry = way([-2.0, 0.0, -0.05], [0.0, 0.0, -0.07]).unwrap();
        assert_eq!((entry.time, entry.at), (0.5, [-1.0, 0.0]));
        assert!((entry.gap + 0.06).abs() < 1e-15);
        let entry = way([0.0, 0.0, -0.05], [0.0, 0.0, -0.2]).unwrap();
        assert_eq!((entry.time, entry.gap), (0.0, -0.05));
    }
}
