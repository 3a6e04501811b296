//! A curve as one line of text.

const BLOCKS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
const ASCII: [char; 8] = ['_', '.', ',', '-', '=', '+', '*', '#'];

/// Smallest and largest of the finite values.
pub fn range(values: &[f64]) -> Option<[f64; 2]> {
    let numbers = values.iter().copied().filter(|v| v.is_finite());
    let spread = |[low, high]: [f64; 2], v: f64| [low.min(v), high.max(v)];
    let all = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], spread);
    (all[0] <= all[1]).then_some(all)
}

/// Draws all values in at most `width` characters, scaled from the smallest to the largest. Where several values
/// share a character, it shows the last of them.
pub fn draw(values: &[f64], width: usize, unicode: bool) -> String {
    let Some([low, high]) = range(values) else {
        return String::new();
    };
    let levels = if unicode { BLOCKS } else { ASCII };
    let count = values.len().min(width);
    let level = |i: usize| {
        let value = values[(i + 1) * values.len() / count - 1];
        let height = if high > low {
            (value - low) / (high - low)
        } else {
            0.0
        };
        // A value that is not a number is drawn as the lowest.
        levels[(height * levels.len() as f64).min(levels.len() as f64 - 1.0) as usize]
    };
    (0..count).map(level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_rises_and_falls() {
        assert_eq!(draw(&[0.0, 1.0, 2.0, 1.0, 0.0], 40, true), "▁▅█▅▁");
        assert_eq!(draw(&[0.0, 1.0, 2.0, 1.0, 0.0], 40, false), "_=#=_");
    }

    #[test]
    fn many_values_share_the_width_and_the_last_is_seen() {
        let ramp: Vec<f64> = (0..1000).map(f64::from).collect();
        let drawn = draw(&ramp, 8, true);
        assert_eq!(drawn, "▁▂▃▄▅▆▇█");
        assert_eq!(draw(&ramp, 0, true), "");
    }

    #[test]
    fn nothing_and_no_numbers_are_drawn_as_nothing() {
        assert_eq!(draw(&[], 10, true), "");
        assert_eq!(draw(&[f64::NAN], 10, true), "");
        assert_eq!(draw(&[3.0, 3.0], 10, true), "▁▁");
        assert_eq!(draw(&[f64::NAN, 1.0, 2.0], 10, true).chars().count(), 3);
    }
}
