//! A value and its error with no more digits than the error supports.

/// Largest part of the last digit by which an error is rounded down.
const DOWN: f64 = 0.05;

/// Value and error as text, both with the last digit of the error. The error has two digits if the first is 1 and one
/// digit otherwise. It is rounded up, unless a twentieth of the last digit would be lost: at most to 1.5 times, and at
/// least to 0.97 times its size. Both have a plain form without an exponent.
///
/// ```
/// use wythe_core::results::estimate::rounded;
/// assert_eq!(rounded(108.4871, 1.8312), ("108.5".to_owned(), "1.9".to_owned()));
/// assert_eq!(rounded(3.5912, 0.2713), ("3.6".to_owned(), "0.3".to_owned()));
/// ```
pub fn rounded(value: f64, error: f64) -> (String, String) {
    if error <= 0.0 || !error.is_finite() || !value.is_finite() {
        return (value.to_string(), error.to_string());
    }
    let mut power = error.log10().floor() as i32;
    let first = (error / 10f64.powi(power) * (1.0 + 1e-9)).floor();
    if first < 2.0 {
        power -= 1;
    }
    let unit = 10f64.powi(power);
    let error = (error / unit - DOWN).ceil() * unit;
    let nearest = (value / unit).round() * unit;
    let decimals = usize::try_from(-power).unwrap_or(0);
    // No minus before zero.
    let nearest = if nearest == 0.0 { 0.0 } else { nearest };
    (
        format!("{nearest:.decimals$}"),
        format!("{error:.decimals$}"),
    )
}

/// A part of a whole in percent, with two significant digits, at most one decimal: `0.3 %`, `1.7 %`, `12 %`.
pub fn percent(part: f64) -> String {
    let percent = 100.0 * part;
    let decimals = usize::from(percent < 9.95);
    format!("{percent:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(value: f64, error: f64) -> String {
        let (value, error) = rounded(value, error);
        format!("{value} ± {error}")
    }

    #[test]
    fn digits_follow_the_error() {
        assert_eq!(said(108.4871, 1.8312), "108.5 ± 1.9");
        assert_eq!(said(108.4871, 0.1), "108.49 ± 0.10");
        assert_eq!(said(108.4871, 0.104), "108.49 ± 0.11");
        assert_eq!(said(108.4871, 0.21), "108.5 ± 0.3");
        assert_eq!(said(108.4871, 0.3), "108.5 ± 0.3");
        assert_eq!(said(108.4871, 9.7), "108 ± 10");
        assert_eq!(said(108.4871, 12.4), "108 ± 13");
        assert_eq!(said(108.4871, 23.0), "110 ± 30");
        assert_eq!(said(-0.000_612_3, 0.000_043), "-0.00061 ± 0.00005");
        assert_eq!(said(-0.04, 2.0), "0 ± 2");
        assert_eq!(said(1234.0, 300.0), "1200 ± 300");
        assert_eq!(said(1234.0, 304.0), "1200 ± 300");
    }

    #[test]
    fn an_error_of_nothing_leaves_the_value() {
        assert_eq!(said(1.25, 0.0), "1.25 ± 0");
    }

    #[test]
    fn percents_have_two_digits() {
        assert_eq!(
            [0.0031, 0.0172, 0.0999, 0.123].map(percent),
            ["0.3 %", "1.7 %", "10 %", "12 %"]
        );
    }
}
