//! Lines on linear axes as SVG, in hundredths of a pixel. The legend lies in a corner without data, or below the axes.
//!
//! ```text
//!   title
//!   y ▲      ● 105.8 kN at 1.9 mm      labels of marks lie where no line and no other label is
//!     │    ╱    ╲         ┌────────┐
//!     │  ╱        ╲___    │ legend │
//!     └───────────────────┴────────┴──▶ x
//! ```

use std::fmt::Write as _;

use super::chart::{Line, Pen};
use super::place::{self, Pixel, Rect};
use crate::experiment::Point;
use crate::results::colours::{Rgb, hex};

/// Space between the edge and the content [px].
const MARGIN: f64 = 20.0;
/// Height of the title [px].
const TITLE: f64 = 40.0;
/// Height of the labels of x with the name of the axis [px].
const BELOW: f64 = 52.0;
/// Height of a line of the legend [px].
const ROW: f64 = 20.0;
/// Length of a sample in the legend [px].
const SAMPLE: f64 = 26.0;
/// Font size of the legend and the marks [px].
const LETTERS: f64 = 13.0;
/// Radius of a mark [px].
const RADIUS: f64 = 4.0;
const BAND: Rgb = [226, 222, 212];
/// Largest number of characters of the title and of a name.
const LONGEST_TITLE: usize = 80;
const LONGEST_NAME: usize = 70;

/// A point with a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    /// Where.
    pub at: Point,
    /// What.
    pub text: String,
    /// Colour.
    pub colour: Rgb,
}

/// Lines on axes over a filled outline; later lines are on top.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes<'a> {
    /// Width and height without the legend [px].
    pub size: (f64, f64),
    /// Title.
    pub title: &'a str,
    /// Names of the axes.
    pub names: [&'a str; 2],
    /// Outline of a filled band with its name; none: empty.
    pub band: (&'a [Point], &'a str),
    /// The lines.
    pub lines: &'a [(Line, Pen)],
    /// Points with a text.
    pub labels: &'a [Label],
}

/// Ranges of the axes and their place.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
    /// Left, top, right, bottom [px].
    inside: Rect,
}

impl Frame {
    fn place(&self, (x, y): Point) -> Pixel {
        let [left, top, right, bottom] = self.inside.0;
        let part = |v: f64, [low, high]: [f64; 2]| (v - low) / (high - low);
        [
            left + part(x, self.x) * (right - left),
            bottom - part(y, self.y) * (bottom - top),
        ]
    }
}

impl Axes<'_> {
    /// The picture.
    ///
    /// # Errors
    /// There are points, and none of them is a number.
    pub fn svg(&self) -> Result<String, String> {
        let all = || {
            let lines = self.lines.iter();
            let of_lines = lines.flat_map(|(l, _)| l.points.iter().chain(&l.marks));
            of_lines.chain(self.band.0)
        };
        if all().next().is_some() && !all().any(finite) {
            return Err("no point has two finite numbers".to_owned());
        }
        let finite = || all().filter(|p| finite(p));
        let (x, y) = (span(finite().map(|p| p.0)), span(finite().map(|p| p.1)));
        let ticks_y = ticks(y, 8);
        let widest = ticks_y.iter().map(|t| place::width(&t.1, 13.0));
        let left = MARGIN + 30.0 + widest.fold(0.0, f64::max);
        let (width, tall) = self.size;
        let inside = Rect([
            left,
            MARGIN + TITLE,
            width - MARGIN - 6.0,
            tall - BELOW - 8.0,
        ]);
        let frame = Frame { x, y, inside };
        let mut svg = String::new();
        let drawn = self.draw(&mut svg, &frame, &ticks_y);
        debug_assert!(drawn.is_ok(), "writing to a string does not fail");
        Ok(svg)
    }

    fn draw(&self, svg: &mut String, frame: &Frame, ticks_y: &[(f64, String)]) -> std::fmt::Result {
        let drawn: Vec<Vec<Vec<Pixel>>> = self
            .lines
            .iter()
            .map(|(line, _)| pieces(&line.points, frame))
            .collect();
        let mut obstacles: Vec<[Pixel; 2]> = drawn
            .iter()
            .flatten()
            .flat_map(|piece| piece.windows(2).map(|w| [w[0], w[1]]))
            .collect();
        let marks = self.lines.iter().flat_map(|(line, _)| &line.marks);
        let marks = marks.filter(|m| finite(m)).map(|m| frame.place(*m));
        obstacles.extend(marks.map(|m| [m, m]));
        let outline = self.band.0.iter().map(|p| frame.place(*p));
        let outline: Vec<Pixel> = outline.collect();
        obstacles.extend(outline.windows(2).map(|w| [w[0], w[1]]));
        let legend = self.legend();
        let names = legend.iter().map(|(name, _)| place::width(name, LETTERS));
        let size = [
            names.fold(0.0, f64::max) + SAMPLE + 26.0,
            legend.len() as f64 * ROW + 10.0,
        ];
        let corner = place::corner(frame.inside, size, &obstacles);
        let (width, tall) = self.size;
        let at = corner.unwrap_or(Rect::at([frame.inside.0[0], tall], size));
        let more = match corner {
            None if !legend.is_empty() => size[1] + 10.0,
            _ => 0.0,
        };
        head(svg, [width, tall + more], self.title)?;
        grid(svg, frame, ticks_y, self.names)?;
        if !outline.is_empty() {
            let points = text_of(&outline);
            writeln!(svg, r#"<polygon points="{points}" fill="{}"/>"#, hex(BAND))?;
        }
        for ((line, pen), pieces) in self.lines.iter().zip(&drawn) {
            curve(svg, pieces, *pen)?;
            for mark in line.marks.iter().filter(|m| finite(m)) {
                let [x, y] = frame.place(*mark);
                let fill = hex(pen.colour);
                writeln!(
                    svg,
                    r##"<circle class="mark" cx="{x:.2}" cy="{y:.2}" r="{RADIUS}" fill="{fill}" stroke="#ffffff" stroke-width="0.8"/>"##
                )?;
            }
        }
        let mut taken: Vec<Rect> = corner.into_iter().filter(|_| !legend.is_empty()).collect();
        for label in self.labels.iter().filter(|l| finite(&l.at)) {
            tag(svg, label, frame, &obstacles, &mut taken)?;
        }
        if !legend.is_empty() {
            write_legend(svg, at, &legend)?;
        }
        svg.push_str("</svg>\n");
        Ok(())
    }

    /// Names with their samples.
    fn legend(&self) -> Vec<(String, Sample)> {
        let band = (!self.band.0.is_empty()).then(|| (self.band.1.to_owned(), Sample::Band));
        let lines = self.lines.iter().filter(|(line, _)| !line.name.is_empty());
        let named = lines.map(|(line, pen)| {
            let sample = if line.points.is_empty() {
                Sample::Mark(*pen)
            } else {
                Sample::Line(*pen)
            };
            (shortened(&line.name, LONGEST_NAME), sample)
        });
        band.into_iter().chain(named).collect()
    }
}

/// Sample in a legend.
#[derive(Clone, Copy)]
enum Sample {
    Band,
    Line(Pen),
    Mark(Pen),
}

fn finite(p: &Point) -> bool {
    p.0.is_finite() && p.1.is_finite()
}

fn head(svg: &mut String, [width, tall]: [f64; 2], title: &str) -> std::fmt::Result {
    writeln!(
        svg,
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0}" height="{tall:.0}" viewBox="0 0 {width:.0} {tall:.0}" font-family="sans-serif"><rect width="100%" height="100%" fill="#ffffff"/>"##
    )?;
    let title = place::escape(&shortened(title, LONGEST_TITLE));
    writeln!(
        svg,
        r#"<text x="{:.1}" y="{:.1}" font-size="19" text-anchor="middle">{title}</text>"#,
        0.5 * width,
        MARGIN + 18.0
    )
}

/// Grid, labels and names of the axes.
fn grid(
    svg: &mut String,
    frame: &Frame,
    ticks_y: &[(f64, String)],
    names: [&str; 2],
) -> std::fmt::Result {
    let [left, top, right, bottom] = frame.inside.0;
    let mut path = String::new();
    let mut labels = String::new();
    let room = ((right - left) / 70.0) as usize;
    for (value, text) in ticks(frame.x, room.max(2)) {
        let [x, _] = frame.place((value, 0.0));
        write!(path, "M{x:.2} {top:.2}V{bottom:.2}")?;
        let y = bottom + 18.0;
        writeln!(
            labels,
            r#"<text x="{x:.2}" y="{y:.1}" text-anchor="middle">{text}</text>"#
        )?;
    }
    for (value, text) in ticks_y {
        let [_, y] = frame.place((0.0, *value));
        write!(path, "M{left:.2} {y:.2}H{right:.2}")?;
        let (x, y) = (left - 8.0, y + 4.5);
        writeln!(
            labels,
            r#"<text x="{x:.1}" y="{y:.2}" text-anchor="end">{text}</text>"#
        )?;
    }
    writeln!(
        svg,
        r##"<path d="{path}" stroke="#e8e8e8" stroke-width="1" fill="none"/>"##
    )?;
    let [zero_x, zero_y] = frame.place((0.0, 0.0));
    let zero = format!("M{left:.2} {zero_y:.2}H{right:.2}M{zero_x:.2} {top:.2}V{bottom:.2}");
    writeln!(
        svg,
        r##"<path d="{zero}" stroke="#b8b8b8" stroke-width="1" fill="none"/>"##
    )?;
    let edge = format!("M{left:.2} {top:.2}V{bottom:.2}H{right:.2}");
    writeln!(
        svg,
        r##"<path d="{edge}" stroke="#404040" stroke-width="1" fill="none"/>"##
    )?;
    writeln!(svg, r##"<g font-size="13" fill="#202020">{labels}</g>"##)?;
    let [x, y] = names.map(place::escape);
    let (middle, low) = (0.5 * (left + right), bottom + 42.0);
    writeln!(
        svg,
        r#"<text x="{middle:.1}" y="{low:.1}" font-size="15" text-anchor="middle">{x}</text>"#
    )?;
    let up = 0.5 * (top + bottom);
    writeln!(
        svg,
        r#"<text transform="translate({:.1} {up:.1}) rotate(-90)" font-size="15" text-anchor="middle">{y}</text>"#,
        MARGIN + 8.0
    )
}

fn curve(svg: &mut String, pieces: &[Vec<Pixel>], pen: Pen) -> std::fmt::Result {
    let (colour, width) = (hex(pen.colour), pen.width);
    let dashes = if pen.dashed {
        r#" stroke-dasharray="7 5""#
    } else {
        ""
    };
    for piece in pieces {
        writeln!(
            svg,
            r#"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-linejoin="round"{dashes}/>"#,
            text_of(piece)
        )?;
    }
    Ok(())
}

/// Lines between numbers that are none; points at the same hundredth of a pixel are drawn once.
fn pieces(points: &[Point], frame: &Frame) -> Vec<Vec<Pixel>> {
    let mut pieces: Vec<Vec<Pixel>> = Vec::new();
    for piece in points.split(|p| !finite(p)).filter(|p| !p.is_empty()) {
        let mut line: Vec<Pixel> = piece.iter().map(|p| frame.place(*p)).collect();
        line.dedup_by_key(|p| p.map(|c| (100.0 * c).round() as i64));
        pieces.push(line);
    }
    pieces
}

fn text_of(points: &[Pixel]) -> String {
    let all: Vec<String> = points
        .iter()
        .map(|[x, y]| format!("{x:.2},{y:.2}"))
        .collect();
    all.join(" ")
}

/// Writes a label where it covers nothing.
fn tag(
    svg: &mut String,
    label: &Label,
    frame: &Frame,
    obstacles: &[[Pixel; 2]],
    taken: &mut Vec<Rect>,
) -> std::fmt::Result {
    let at = frame.place(label.at);
    let size = [place::width(&label.text, LETTERS), LETTERS + 3.0];
    let place = place::beside(at, size, frame.inside, (obstacles, taken));
    let [left, _, _, low] = place.0;
    taken.push(place);
    writeln!(
        svg,
        r##"<text class="label" x="{left:.2}" y="{:.2}" font-size="{LETTERS}" fill="{}" stroke="#ffffff" stroke-width="3" paint-order="stroke">{}</text>"##,
        low - 4.0,
        hex(label.colour),
        place::escape(&label.text)
    )
}

fn write_legend(svg: &mut String, at: Rect, legend: &[(String, Sample)]) -> std::fmt::Result {
    let [left, top, right, bottom] = at.0;
    writeln!(
        svg,
        r##"<g class="legend" font-size="{LETTERS}"><rect x="{left:.1}" y="{top:.1}" width="{:.1}" height="{:.1}" fill="#ffffff" fill-opacity="0.9" stroke="#c8c8c8"/>"##,
        right - left,
        bottom - top
    )?;
    for (i, (name, sample)) in legend.iter().enumerate() {
        let y = top + 5.0 + ROW * (i as f64 + 0.5);
        let x = left + 10.0;
        match sample {
            Sample::Band => writeln!(
                svg,
                r#"<rect x="{x:.1}" y="{:.1}" width="{SAMPLE}" height="10" fill="{}"/>"#,
                y - 5.0,
                hex(BAND)
            )?,
            Sample::Line(pen) => curve(svg, &[vec![[x, y], [x + SAMPLE, y]]], *pen)?,
            Sample::Mark(pen) => writeln!(
                svg,
                r#"<circle cx="{:.1}" cy="{y:.1}" r="{RADIUS}" fill="{}"/>"#,
                x + 0.5 * SAMPLE,
                hex(pen.colour)
            )?,
        }
        writeln!(
            svg,
            r#"<text x="{:.1}" y="{:.1}">{}</text>"#,
            x + SAMPLE + 8.0,
            y + 4.5,
            place::escape(name)
        )?;
    }
    svg.push_str("</g>\n");
    Ok(())
}

fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most - 1).chain(['…']).collect()
}

/// A range that contains the values and zero, with a margin of 6 % beyond values other than zero.
fn span(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    if low == high {
        return [0.0, 1.0];
    }
    let more = 0.06 * (high - low);
    [
        if low < 0.0 { low - more } else { 0.0 },
        if high > 0.0 { high + more } else { 0.0 },
    ]
}

/// Round numbers within a range at even distances, at most `most` + 1, with their texts.
fn ticks([low, high]: [f64; 2], most: usize) -> Vec<(f64, String)> {
    let least = (high - low) / most as f64;
    let decade = 10.0_f64.powf(least.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    let step = factors
        .into_iter()
        .find(|f| f * decade >= least * (1.0 - 1e-9));
    let step = step.unwrap_or(10.0) * decade;
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    let digits = (-step.log10().floor()).max(0.0) as usize;
    let largest = low.abs().max(high.abs());
    let text = |value: f64| {
        if value != 0.0 && !(1e-4..1e7).contains(&largest) {
            let text = format!("{value:.2e}");
            text.replace(".00e", "e").replace("0e", "e")
        } else {
            format!("{:.*}", digits, value + 0.0)
        }
    };
    (first..=last)
        .map(|i| i as f64 * step)
        .map(|value| (value, text(value).replace('-', "−")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let texts = |range, most| {
            let all = ticks(range, most).into_iter();
            all.map(|t| t.1).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(texts([0.0, 112.2], 6), "0 20 40 60 80 100");
        assert_eq!(texts([-0.1, 0.26], 4), "−0.1 0.0 0.1 0.2");
        assert_eq!(texts([0.0, 4e-6], 4), "0.000000 1e−6 2e−6 3e−6 4e−6");
        assert_eq!(span([1.0, 2.0].into_iter()), [0.0, 2.12]);
        assert_eq!(span([-1.0].into_iter()), [-1.06, 0.0]);
        assert_eq!(span(std::iter::empty()), [0.0, 1.0]);
    }
}
