//! Where on its way a point has come upon a facet, or an edge upon another.
//!
//! Seen from the facet the way of an increment is taken as a straight line in (ξ, η, gap), which is exact
//! where both bodies move without turning relative to each other. The point is in contact if it came
//! through the face from outside; what comes from the side, or from behind, meets another face.

/// A place in the parameters of a facet or of two edges, and the gap there [mm].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Parameters [-].
    pub at: [f64; 2],
    /// Gap, positive outside [mm].
    pub gap: f64,
}

/// How a point came into contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Part of the way at which it did, 0 to 1.
    pub time: f64,
    /// Parameters there.
    pub at: [f64; 2],
    /// Gap there [mm]: 0, or how deep it was already when it came over the facet (negative).
    pub gap: f64,
}

/// The part of the way `[from, to]` on which the parameters are within their `[low, high]`, if any.
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

/// Whether the way from `start` to `end` leads through a face whose parameters lie within their
/// `[low, high]`.
///
/// It does where the gap closes over the face, or where the way comes over the face no more than `behind`
/// [mm] below it: what lies flush, or was pressed in by so much, slides on instead of being caught by the
/// face at the side.
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
    // What came through and has left the face again since is none of its.
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
    fn what_comes_through_the_face_is_met_where_it_does() {
        let entry = way([0.0, -0.5, 3.0], [1.0, 0.5, -1.0]).unwrap();
        assert_eq!((entry.time, entry.at, entry.gap), (0.75, [0.75, 0.25], 0.0));
        // Beyond the face at the end, but it went through.
        let entry = way([0.0, 0.0, 1.0], [4.0, 0.0, -3.0]).unwrap();
        assert_eq!((entry.time, entry.at), (0.25, [1.0, 0.0]));
    }

    #[test]
    fn what_comes_from_the_side_or_from_behind_is_not() {
        assert_eq!(way([-3.0, 0.0, -1.0], [0.0, 0.0, -1.0]), None);
        assert_eq!(way([0.0, 0.0, -1.0], [0.0, 0.0, -2.0]), None);
        // Through the plane beside the face, then under it.
        assert_eq!(way([-3.0, 0.0, 0.5], [0.0, 0.0, -2.5]), None);
        // Over it, and beside it when the gap closes.
        assert_eq!(way([0.0, 0.0, 3.0], [4.0, 0.0, -1.0]), None);
        // It stays outside.
        assert_eq!(way([0.0, 0.0, 3.0], [0.0, 0.0, 0.0]), None);
    }

    #[test]
    fn what_slides_over_the_rim_a_little_below_the_face_is_carried_where_it_is() {
        let entry = way([-2.0, 0.0, -0.05], [0.0, 0.0, -0.07]).unwrap();
        assert_eq!((entry.time, entry.at), (0.5, [-1.0, 0.0]));
        assert!((entry.gap + 0.06).abs() < 1e-15);
        let entry = way([0.0, 0.0, -0.05], [0.0, 0.0, -0.2]).unwrap();
        assert_eq!((entry.time, entry.gap), (0.0, -0.05));
    }
}
