//! Places of texts in a picture where they cover nothing.

pub(crate) use crate::results::svg_text::{escape, width};

/// x to the right and y down [px].
pub(crate) type Pixel = [f64; 2];

/// Left, top, right, bottom [px].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect(pub [f64; 4]);

impl Rect {
    /// With this upper left corner and size.
    pub fn at([left, top]: Pixel, [width, tall]: [f64; 2]) -> Self {
        Self([left, top, left + width, top + tall])
    }

    /// Larger by `by` on each side.
    fn wider(self, by: f64) -> Self {
        let [a, b, c, d] = self.0;
        Self([a - by, b - by, c + by, d + by])
    }

    /// Whether two boxes overlap.
    pub fn meets(&self, other: &Self) -> bool {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        a < g && e < c && b < h && f < d
    }

    fn holds(&self, other: &Self) -> bool {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        a <= e && b <= f && g <= c && h <= d
    }

    /// Whether a line meets the box (Liang and Barsky).
    pub fn cuts(&self, [from, to]: [Pixel; 2]) -> bool {
        let [left, top, right, bottom] = self.0;
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (p, q, low, high) in [
            (from[0], to[0] - from[0], left, right),
            (from[1], to[1] - from[1], top, bottom),
        ] {
            if q == 0.0 {
                if p < low || p > high {
                    return false;
                }
                continue;
            }
            let (a, b) = ((low - p) / q, (high - p) / q);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter <= leave
    }
}

/// A corner of `inside` where a box of this size meets no line; none if there is no such corner.
pub(crate) fn corner(inside: Rect, size: [f64; 2], lines: &[[Pixel; 2]]) -> Option<Rect> {
    const GAP: f64 = 10.0;
    let [left, top, right, bottom] = inside.0;
    let (x, y) = (right - GAP - size[0], bottom - GAP - size[1]);
    let places = [
        [x, y],
        [x, top + GAP],
        [left + GAP, top + GAP],
        [left + GAP, y],
    ];
    places.into_iter().map(|at| Rect::at(at, size)).find(|at| {
        let wide = at.wider(5.0);
        inside.holds(at) && !lines.iter().any(|line| wide.cuts(*line))
    })
}

/// Place of a text of this size beside a point: the first one within `inside` that meets no line and no other text,
/// or the one that meets the fewest lines.
pub(crate) fn beside(
    [x, y]: Pixel,
    [width, tall]: [f64; 2],
    inside: Rect,
    (lines, taken): (&[[Pixel; 2]], &[Rect]),
) -> Rect {
    let mut best: Option<(usize, Rect)> = None;
    for away in [8.0, 18.0, 32.0, 50.0] {
        let (above, below) = (y - away - tall, y + away);
        let (right, left) = (x + away, x - away - width);
        for corner in [
            [x - 0.5 * width, above],
            [right, above],
            [left, above],
            [right, y - 0.5 * tall],
            [left, y - 0.5 * tall],
            [right, below],
            [left, below],
            [x - 0.5 * width, below],
        ] {
            let at = Rect::at(corner, [width, tall]);
            if !inside.holds(&at) || taken.iter().any(|t| t.meets(&at.wider(2.0))) {
                continue;
            }
            let wide = at.wider(2.0);
            let met = lines.iter().filter(|line| wide.cuts(**line)).count();
            if met == 0 {
                return at;
            }
            if best.is_none_or(|(least, _)| met < least) {
                best = Some((met, at));
            }
        }
    }
    let beside = Rect::at([x + 8.0, y - 8.0 - tall], [width, tall]);
    best.map_or(beside, |(_, at)| at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_meet_boxes() {
        let square = Rect([0.0, 0.0, 10.0, 10.0]);
        for (line, meets) in [
            ([[-5.0, 5.0], [15.0, 5.0]], true),
            ([[5.0, 5.0], [5.0, 5.0]], true),
            ([[-5.0, 0.0], [0.0, 15.0]], false),
            ([[11.0, 0.0], [11.0, 10.0]], false),
            ([[-1.0, 9.0], [9.0, -1.0]], true),
        ] {
            assert_eq!(square.cuts(line), meets, "{line:?}");
        }
    }

    #[test]
    fn texts_move_away_from_lines_and_texts() {
        let inside = Rect([0.0, 0.0, 200.0, 100.0]);
        let rising = [[0.0, 100.0], [200.0, 0.0]];
        let at = corner(inside, [50.0, 20.0], &[rising]).unwrap();
        assert_eq!(at.0, [140.0, 70.0, 190.0, 90.0]);
        let everywhere: Vec<_> = (0..20)
            .map(|i| [[0.0, 5.0 * f64::from(i)], [200.0, 5.0 * f64::from(i)]])
            .collect();
        assert_eq!(corner(inside, [50.0, 20.0], &everywhere), None);
        let first = beside([100.0, 50.0], [40.0, 10.0], inside, (&[], &[]));
        assert!(first.0[3] < 50.0);
        let second = beside([100.0, 50.0], [40.0, 10.0], inside, (&[], &[first]));
        assert!(!first.meets(&second));
        let third = beside([100.0, 50.0], [40.0, 10.0], inside, (&[rising], &[]));
        assert!(!third.cuts(rising) && inside.holds(&third));
    }
}
