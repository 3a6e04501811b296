//! Numbers as other programs write them.

use crate::deck::quantity::LARGEST;

/// Returns whether a number is small enough in any unit: values of lengths and stresses may differ by 1e6 from
/// those of wythe.
pub(in crate::deck) fn is_sound(number: f64) -> bool {
    number.abs() <= 1e6 * LARGEST
}

/// Parses a finite number: `1.`, `-.5`, `1e3`, Fortran's `1.D+03`.
pub(in crate::deck) fn real(text: &str) -> Option<f64> {
    let text = text.trim();
    let plain = text
        .bytes()
        .all(|b| b.is_ascii_digit() || b"+-.eEdD".contains(&b));
    if !plain {
        return None; // `nan`, `inf`, names
    }
    let number = match text.parse::<f64>() {
        Ok(number) => number,
        Err(_) => text.replace(['d', 'D'], "e").parse().ok()?,
    };
    is_sound(number).then_some(number)
}

/// Parses the numbers of a line; fields that are empty have the value `empty`.
pub(super) fn numbers(fields: &[&str], empty: f64) -> Option<Vec<f64>> {
    let number = |f: &&str| if f.is_empty() { Some(empty) } else { real(f) };
    fields.iter().map(number).collect()
}

/// Parses a label, from 1.
pub(super) fn label(text: &str) -> Option<u64> {
    text.trim().parse().ok().filter(|&label| label > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_and_labels_of_abaqus() {
        for (text, number) in [
            ("1.", 1.0),
            (" -.5 ", -0.5),
            ("1e3", 1e3),
            ("1.D+03", 1e3),
            ("2.5d-1", 0.25),
        ] {
            assert_eq!(real(text), Some(number), "{text}");
        }
        for text in ["", "nan", "inf", "1e400", "1e300", "x", "1,2", "--1"] {
            assert_eq!(real(text), None, "{text}");
        }
        assert_eq!(
            [label("7 "), label("0"), label("-1")],
            [Some(7), None, None]
        );
    }
}
