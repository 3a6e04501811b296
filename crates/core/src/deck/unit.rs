//! Grammar of units: `number factor ((* | · | / | space) factor)*`. A factor is a unit with an optional power:
//! `mm`, `m^2`, `s²`, `mm^-1`. A `/` applies only to the factor after it.

use std::fmt;

/// Exponents of mm, tonne, s, degree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension(pub [i8; 4]);

/// Dimension, its name, its base unit.
const NAMES: [([i8; 4], &str, &str); 16] = [
    ([0, 0, 0, 0], "a number without a unit", ""),
    ([1, 0, 0, 0], "a length", "mm"),
    ([2, 0, 0, 0], "an area", "mm^2"),
    ([3, 0, 0, 0], "a volume", "mm^3"),
    ([0, 1, 0, 0], "a mass", "tonne"),
    ([0, 0, 1, 0], "a time", "s"),
    ([0, 0, -1, 0], "a rate", "s^-1"),
    ([1, 0, -1, 0], "a velocity", "mm/s"),
    ([1, 0, -2, 0], "an acceleration", "mm/s^2"),
    ([0, 0, 0, 1], "an angle", "deg"),
    ([1, 1, -2, 0], "a force", "N"),
    ([-1, 1, -2, 0], "a pressure", "MPa"),
    ([-3, 1, 0, 0], "a density", "tonne/mm^3"),
    ([0, 1, -2, 0], "a force per length", "N/mm"),
    ([-2, 1, -2, 0], "a stiffness per area", "N/mm^3"),
    ([2, 1, -2, 0], "an energy", "N mm"),
];

impl Dimension {
    /// Name of the dimension, without its unit.
    pub fn name(self) -> String {
        if let Some((_, name, _)) = NAMES.iter().find(|n| n.0 == self.0) {
            return (*name).to_owned();
        }
        let powers = ["mm", "tonne", "s", "deg"]
            .iter()
            .zip(self.0)
            .filter(|p| p.1 != 0);
        let factors: Vec<String> = powers
            .map(|(unit, power)| format!("{unit}^{power}"))
            .collect();
        format!("a quantity in {}", factors.join(" "))
    }
}

/// Prints the name with the base unit: `a pressure (MPa)`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match NAMES.iter().find(|n| n.0 == self.0) {
            Some((_, name, unit)) if !unit.is_empty() => write!(f, "{name} ({unit})"),
            _ => f.write_str(&self.name()),
        }
    }
}

/// A unit of `factor` × 10^`ten` base units.
///
/// The power of ten is separate so that `"12 N/m"` and `"0.012 N/mm"` are equal to the last bit: the exponent is
/// shifted before the decimal number is read.
struct Unit {
    name: &'static str,
    factor: f64,
    ten: i32,
    dimension: [i8; 4],
}

const fn unit(name: &'static str, factor: f64, ten: i32, dimension: [i8; 4]) -> Unit {
    Unit {
        name,
        factor,
        ten,
        dimension,
    }
}

const UNITS: [Unit; 29] = [
    unit("um", 1.0, -3, [1, 0, 0, 0]),
    unit("µm", 1.0, -3, [1, 0, 0, 0]),
    unit("mm", 1.0, 0, [1, 0, 0, 0]),
    unit("cm", 1.0, 1, [1, 0, 0, 0]),
    unit("m", 1.0, 3, [1, 0, 0, 0]),
    unit("mN", 1.0, -3, [1, 1, -2, 0]),
    unit("N", 1.0, 0, [1, 1, -2, 0]),
    unit("kN", 1.0, 3, [1, 1, -2, 0]),
    unit("MN", 1.0, 6, [1, 1, -2, 0]),
    unit("Pa", 1.0, -6, [-1, 1, -2, 0]),
    unit("kPa", 1.0, -3, [-1, 1, -2, 0]),
    unit("MPa", 1.0, 0, [-1, 1, -2, 0]),
    unit("GPa", 1.0, 3, [-1, 1, -2, 0]),
    unit("bar", 1.0, -1, [-1, 1, -2, 0]),
    unit("J", 1.0, 3, [2, 1, -2, 0]),
    unit("kJ", 1.0, 6, [2, 1, -2, 0]),
    unit("g", 1.0, -6, [0, 1, 0, 0]),
    unit("kg", 1.0, -3, [0, 1, 0, 0]),
    unit("t", 1.0, 0, [0, 1, 0, 0]),
    unit("tonne", 1.0, 0, [0, 1, 0, 0]),
    unit("ms", 1.0, -3, [0, 0, 1, 0]),
    unit("s", 1.0, 0, [0, 0, 1, 0]),
    unit("min", 60.0, 0, [0, 0, 1, 0]),
    unit("Hz", 1.0, 0, [0, 0, -1, 0]),
    unit("h", 3600.0, 0, [0, 0, 1, 0]),
    unit("deg", 1.0, 0, [0, 0, 0, 1]),
    unit("°", 1.0, 0, [0, 0, 0, 1]),
    unit("rad", 180.0 / std::f64::consts::PI, 0, [0, 0, 0, 1]),
    unit("%", 1.0, -2, [0, 0, 0, 0]),
];

/// Value in base units and dimension of a text such as `"30 kN/m^2"`.
///
/// # Errors
/// A sentence that says which part could not be read.
pub fn parse(text: &str) -> Result<(f64, Dimension), String> {
    read(text).map_err(|why| match with_powers(text) {
        Some(better) => format!("powers are written with \"^\": \"{better}\""),
        None => why,
    })
}

/// The corrected text, if only the signs of powers are missing: `N/mm^2` for `N/mm2` and `N/mm**2`.
fn with_powers(text: &str) -> Option<String> {
    let (_, _, units) = number(text.trim());
    let mut better = String::new();
    let mut before = ' ';
    let mut rest = units.replace("**", "^");
    while let Some(c) = rest.chars().next() {
        let signed = rest[c.len_utf8()..].starts_with(|c: char| c.is_ascii_digit());
        let is_power = c.is_ascii_digit() || (c == '-' && signed);
        if before.is_alphabetic() && is_power {
            better.push('^');
        }
        better.push(c);
        before = c;
        rest.drain(..c.len_utf8());
    }
    let text = text.trim();
    let number = &text[..text.len() - units.len()];
    let better = format!("{number}{better}");
    (better != text && read(&better).is_ok()).then_some(better)
}

/// As [`parse`], without a corrected text.
fn read(text: &str) -> Result<(f64, Dimension), String> {
    let text = text.trim();
    let (mantissa, exponent, rest) = number(text);
    let mut rest = rest.trim_start();
    let (mut factor, mut ten, mut dimension) = (1.0, i64::from(exponent), [0_i8; 4]);
    let mut sign = 1;
    let mut first = true;
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix('/').filter(|_| !first) {
            (sign, rest) = (-1, after.trim_start());
        } else if let Some(after) = rest.strip_prefix(['*', '·']).filter(|_| !first) {
            rest = after.trim_start();
        }
        let (unit, power, after) = unit_and_power(rest)?;
        let power = sign * power;
        for (total, own) in dimension.iter_mut().zip(unit.dimension) {
            let exponent = i32::from(*total) + i32::from(own) * power;
            *total = i8::try_from(exponent).map_err(|_| "its powers are too large".to_owned())?;
        }
        factor *= unit.factor.powi(power);
        ten += i64::from(unit.ten * power);
        (sign, first, rest) = (1, false, after.trim_start());
    }
    let value: f64 = format!("{mantissa}e{ten}")
        .parse()
        .map_err(|_| "it does not begin with a number".to_owned())?;
    Ok((value * factor, Dimension(dimension)))
}

/// Mantissa and decimal exponent of the number at the start of `text`, and the rest of the text.
fn number(text: &str) -> (&str, i32, &str) {
    let digits = |from: usize| {
        let is_part = |c: char| c.is_ascii_digit() || c == '.';
        text[from..]
            .find(|c| !is_part(c))
            .map_or(text.len(), |i| from + i)
    };
    let end = digits(usize::from(text.starts_with(['+', '-'])));
    let (mantissa, rest) = text.split_at(end);
    if let Some(after) = rest.strip_prefix(['e', 'E']) {
        let sign = usize::from(after.starts_with(['+', '-']));
        let count = after[sign..]
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(after.len() - sign);
        if let Ok(exponent) = after[..sign + count].parse() {
            return (mantissa, exponent, &after[sign + count..]);
        }
    }
    (mantissa, 0, rest)
}

/// One unit with its power, and the rest of the text.
fn unit_and_power(text: &str) -> Result<(&'static Unit, i32, &str), String> {
    let is_name = |c: char| c.is_alphabetic() || c == '%' || c == '°';
    let end = text.find(|c| !is_name(c)).unwrap_or(text.len());
    let name = &text[..end];
    let unit = UNITS.iter().find(|u| u.name == name).ok_or_else(|| {
        if name.is_empty() {
            format!("a unit is missing before \"{text}\"")
        } else {
            let alike = UNITS.iter().filter(|u| u.name.eq_ignore_ascii_case(name));
            let alike: Vec<String> = alike.map(|u| format!("\"{}\"", u.name)).collect();
            match &alike[..] {
                [] => format!(
                    "\"{name}\" is not a known unit (such as N, kN, mm, m, MPa, GPa, kg, tonne, s, deg)"
                ),
                alike => format!("\"{name}\" is not a known unit: {} is", alike.join(" or ")),
            }
        }
    })?;
    let rest = &text[end..];
    if let Some(after) = rest.strip_prefix(['²', '³']) {
        return Ok((unit, if rest.starts_with('²') { 2 } else { 3 }, after));
    }
    let Some(after) = rest.strip_prefix('^') else {
        return Ok((unit, 1, rest));
    };
    let sign = usize::from(after.starts_with(['-', '+']));
    let end = after[sign..]
        .find(|c: char| !c.is_ascii_digit())
        .map_or(after.len(), |i| i + sign);
    match after[..end].parse::<i32>() {
        Ok(power) if power != 0 && power.abs() <= 6 => Ok((unit, power, &after[end..])),
        _ => Err(format!(
            "\"^\" after \"{name}\" wants a whole power between -6 and 6"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_convert_to_the_last_bit() {
        // Exact: the exponent is shifted before the decimal number is read.
        for (text, value, dimension) in [
            ("2.12 MPa", 2.12, [-1, 1, -2, 0]),
            ("4 mm", 4.0, [1, 0, 0, 0]),
            ("4mm", 4.0, [1, 0, 0, 0]),
            ("3.14 cm", 31.4, [1, 0, 0, 0]),
            ("0.314e+2 mm", 31.4, [1, 0, 0, 0]),
            ("30 kN/m^2", 0.03, [-1, 1, -2, 0]),
            ("30 kN/m²", 0.03, [-1, 1, -2, 0]),
            ("30 kN m^-2", 0.03, [-1, 1, -2, 0]),
            ("1.9e-9 tonne/mm^3", 1.9e-9, [-3, 1, 0, 0]),
            ("1900 kg/m^3", 1.9e-9, [-3, 1, 0, 0]),
            ("16.7 GPa", 16700.0, [-1, 1, -2, 0]),
            ("12 N/m", 0.012, [0, 1, -2, 0]),
            ("12 J/m^2", 0.012, [0, 1, -2, 0]),
            ("34000 N/mm^3", 34000.0, [-2, 1, -2, 0]),
            ("34 N/mm/mm/mm", 34.0, [-2, 1, -2, 0]),
            ("34000 MPa/mm", 34000.0, [-2, 1, -2, 0]),
            ("1 kg*m/s^2", 1.0, [1, 1, -2, 0]),
            ("10 deg", 10.0, [0, 0, 0, 1]),
            ("0.5 %", 0.005, [0, 0, 0, 0]),
            ("-1e1", -10.0, [0, 0, 0, 0]),
        ] {
            assert_eq!(parse(text), Ok((value, Dimension(dimension))), "{text}");
        }
        let (half_turn, _) = parse("3.141592653589793 rad").unwrap();
        // Two roundings: 180/π and the product.
        assert!((half_turn - 180.0).abs() <= 2.0 * 180.0 * f64::EPSILON);
    }

    #[test]
    fn a_unit_without_the_power_sign_is_suggested_with_it() {
        for (text, better) in [
            ("2 N/mm2", "2 N/mm^2"),
            ("20 kN/m2", "20 kN/m^2"),
            ("1900 kg/m3", "1900 kg/m^3"),
            ("2 N mm-2", "2 N mm^-2"),
            ("2 N/mm**2", "2 N/mm^2"),
            ("-9.81e0m/s2", "-9.81e0m/s^2"),
        ] {
            let why = parse(text).unwrap_err();
            assert!(why.contains(&format!("\"{better}\"")), "{text}: {why}");
            assert!(parse(better).is_ok());
        }
        for text in ["2 N/mx2", "2 mm2 7", "N2"] {
            assert!(
                !parse(text).unwrap_err().contains("powers are written"),
                "{text}"
            );
        }
        assert!(parse("2 Mpa").unwrap_err().contains("\"MPa\" is"));
        assert!(parse("2 KN/m").unwrap_err().contains("\"kN\" is"));
    }

    #[test]
    fn values_that_are_not_quantities_are_rejected() {
        for text in [
            "",
            "MPa",
            "2 Mpa",
            "2 MPa/",
            "2 /mm",
            "2 mm^",
            "2 mm^0",
            "2 mm^99",
            "2 mm^3 7",
            "1..2 mm",
            "1e mm",
            ".",
            "e3",
            "2 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 mm^6 \
             mm^6 mm^6 mm^6 mm^6 mm^6",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }
}
