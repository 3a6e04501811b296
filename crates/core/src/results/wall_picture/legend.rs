//! Legend of a picture of a wall: damage, crushing, states of joints, widths of cracks.

use std::fmt::Write as _;

use super::MARGIN;
use super::shapes::{Kind, Shape};
use crate::results::colours::{CRACKED, CRUSHED, STATE_NAMES, STATES, damaged, hex};
use crate::results::curve::brief;
use crate::state;

/// Width of the line of the widest crack [px].
const WIDEST: f64 = 9.0;
/// Height of a row [px].
const ROW: f64 = 24.0;
/// Width of the headings [px].
const HEADINGS: f64 = 122.0;
/// Crack widths below this have no scale [mm].
const LEAST: f64 = 1e-3;

/// Scale of the widths of cracks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Widths {
    /// A round width, that of the widest crack or more [mm]; 0 without cracks.
    widest: f64,
}

impl Widths {
    /// Up to this width [mm].
    pub fn of(widest: f64) -> Self {
        if !(widest.is_finite() && widest >= LEAST) {
            return Self { widest: 0.0 };
        }
        let decade = 10.0_f64.powf(widest.log10().floor());
        let factors = [1.0, 2.0, 5.0, 10.0].into_iter();
        let round = factors
            .map(|f| f * decade)
            .find(|w| *w >= widest * (1.0 - 1e-9));
        Self {
            widest: round.unwrap_or(widest),
        }
    }

    /// Width of the line of a crack [px], at least `least`.
    pub fn pixels(&self, width: f64, least: f64) -> f64 {
        if self.widest > 0.0 {
            (WIDEST * width / self.widest).clamp(least, WIDEST)
        } else {
            least
        }
    }
}

/// Rows of a legend.
pub(super) struct Legend<'a> {
    /// States of joints that occur, by their numbers.
    states: [bool; 4],
    widths: &'a Widths,
}

impl<'a> Legend<'a> {
    pub fn of(shapes: &[Shape], widths: &'a Widths) -> Self {
        let mut states = [false; 4];
        for shape in shapes {
            if let Kind::Joint { state, .. } = shape.kind {
                states[state as usize] = true;
            }
        }
        Self { states, widths }
    }

    /// Number of rows: always the same for a model with joints, so that the pictures of an animation fit together.
    fn rows(&self) -> usize {
        2 + usize::from(self.states.contains(&true))
    }

    /// Height of all rows [px].
    pub fn height(&self) -> f64 {
        ROW * self.rows() as f64 + 14.0
    }

    pub fn draw(&self, svg: &mut String, top: f64) -> std::fmt::Result {
        writeln!(svg, r#"<g class="legend" font-size="13">"#)?;
        damage(svg, top)?;
        let mut y = top + ROW;
        if self.states.contains(&true) {
            text(svg, MARGIN, y, "joints")?;
            let mut x = MARGIN + HEADINGS;
            for i in 1..4 {
                stroke(svg, [x, y, 28.0], &hex(STATES[i]), 2.4)?;
                text(svg, x + 36.0, y, STATE_NAMES[i])?;
                x += 36.0 + 8.0 * STATE_NAMES[i].len() as f64 + 22.0;
            }
            y += ROW;
        }
        if self.widths.widest > 0.0 {
            text(svg, MARGIN, y, "crack width")?;
            let mut x = MARGIN + HEADINGS;
            for part in [0.1, 0.5, 1.0] {
                let width = part * self.widths.widest;
                stroke(
                    svg,
                    [x, y, 28.0],
                    &hex(CRACKED),
                    self.widths.pixels(width, 0.7),
                )?;
                text(svg, x + 38.0, y, &format!("{} mm", short(width)))?;
                x += 132.0;
            }
        }
        writeln!(svg, "</g>")
    }
}

/// Four digits without the zeros at the end.
fn short(value: f64) -> String {
    let text = brief(value);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// The scale of tensile damage and the mark of crushing.
fn damage(svg: &mut String, top: f64) -> std::fmt::Result {
    text(svg, MARGIN, top, "tensile damage 0")?;
    let (left, cells) = (MARGIN + HEADINGS, 24);
    for i in 0..cells {
        let fill = hex(damaged(0, (f64::from(i) + 0.5) / f64::from(cells)));
        let x = left + 5.0 * f64::from(i);
        writeln!(
            svg,
            r#"<rect x="{x:.1}" y="{top:.1}" width="5.2" height="14" fill="{fill}"/>"#
        )?;
    }
    let right = left + 5.0 * f64::from(cells) + 6.0;
    text(svg, right, top, "1")?;
    let (x, low) = (right + 44.0, top + 14.0);
    writeln!(
        svg,
        r#"<path d="M{x:.1} {top:.1}L{0:.1} {low:.1}M{x:.1} {low:.1}L{0:.1} {top:.1}" stroke="{1}" stroke-width="1.6"/>"#,
        x + 14.0,
        hex(CRUSHED)
    )?;
    let said = format!("compressive damage above {}", state::CRUSHED);
    text(svg, x + 22.0, top, &said)
}

fn text(svg: &mut String, x: f64, top: f64, said: &str) -> std::fmt::Result {
    writeln!(
        svg,
        r#"<text x="{x:.1}" y="{:.1}">{said}</text>"#,
        top + 12.0
    )
}

fn stroke(
    svg: &mut String,
    [x, top, long]: [f64; 3],
    colour: &str,
    width: f64,
) -> std::fmt::Result {
    let y = top + 7.5;
    writeln!(
        svg,
        r#"<path d="M{x:.1} {y:.1}h{long:.1}" stroke="{colour}" stroke-width="{width:.2}"/>"#
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_widest_crack_has_the_widest_line() {
        let widths = Widths::of(1.7);
        assert_eq!(widths.widest, 2.0);
        assert_eq!(widths.pixels(2.0, 0.7), WIDEST);
        assert_eq!(widths.pixels(1.0, 0.7), 0.5 * WIDEST);
        assert_eq!(widths.pixels(0.0, 0.7), 0.7);
        assert_eq!(Widths::of(2e-4).pixels(1e-4, 1.0), 1.0);
        assert_eq!(Widths::of(f64::NAN).widest, 0.0);
        assert_eq!([0.2, 0.02, 50.0].map(short), ["0.2", "0.02", "50"]);
    }
}
