//! Load-displacement curves of runs and experiments.
//!
//! A cyclic experiment is drawn with its loops as thin lines and with its envelope. Of several experiments, the band
//! between the lowest and the highest is filled.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::experiment::{Experiment, Point};
use crate::results::branch::{self, Branch};

/// Width and height of the picture [px].
const SIZE: (u32, u32) = (900, 600);
/// Colours of runs in order, repeated if there are more runs.
const RUNS: [RGBColor; 5] = [
    RGBColor(31, 78, 121),
    RGBColor(178, 34, 34),
    RGBColor(46, 125, 50),
    RGBColor(123, 63, 152),
    RGBColor(190, 110, 20),
];
/// Colours of experiments in order.
const TESTS: [RGBColor; 4] = [
    RGBColor(95, 95, 95),
    RGBColor(150, 130, 100),
    RGBColor(120, 140, 150),
    RGBColor(150, 120, 140),
];
const LOOPS: RGBColor = RGBColor(190, 190, 190);
const BAND: RGBColor = RGBColor(226, 222, 212);

/// A curve with its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Abscissae and ordinates.
    pub points: Vec<Point>,
    /// Points with a marker.
    pub marks: Vec<Point>,
}

/// Style of a line.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    colour: RGBColor,
    width: u32,
    dashed: bool,
}

/// Style of a run.
pub(super) fn run_pen(index: usize) -> Pen {
    Pen {
        colour: RUNS[index % RUNS.len()],
        width: 2,
        dashed: false,
    }
}

/// Curves of runs and experiments as SVG text. Experiments on the opposite side are mirrored to that of the first
/// run.
///
/// # Errors
/// Message of plotters if it cannot draw.
pub fn load_displacements(
    title: &str,
    runs: &[Line],
    experiments: &[Experiment],
) -> Result<String, String> {
    let side = runs.first().map_or(1.0, |run| branch::side(&run.points));
    let mut lines: Vec<(Line, Pen)> = Vec::new();
    let mut branches = Vec::new();
    for (i, experiment) in experiments.iter().enumerate() {
        let (branch, mirrored) = Branch::towards(&experiment.points, side);
        let sign = if mirrored { -1.0 } else { 1.0 };
        let name = if mirrored {
            format!("{}, mirrored", experiment.name)
        } else {
            experiment.name.clone()
        };
        let pen = Pen {
            colour: TESTS[i % TESTS.len()],
            width: 2,
            dashed: i >= TESTS.len(),
        };
        let turned = |p: &Point| (sign * p.0, sign * p.1);
        let all: Vec<Point> = experiment.points.iter().map(turned).collect();
        if branch::returns(&experiment.points) {
            let thin = Pen {
                colour: LOOPS,
                width: 1,
                dashed: false,
            };
            lines.insert(0, (plain("", all), thin));
            let envelope = branch.points().iter().map(|p| (side * p.0, side * p.1));
            lines.push((plain(&format!("{name}: envelope"), envelope.collect()), pen));
        } else {
            lines.push((plain(&name, all), pen));
        }
        branches.push(branch);
    }
    let band = band(&branches).map(|p| (side * p.0, side * p.1));
    let pens = (0..).map(run_pen);
    lines.extend(runs.iter().cloned().zip(pens));
    let axes = ["displacement [mm]", "force [kN]"];
    picture(title, axes, &band.0, &lines)
}

/// Curves of runs over known curves, as SVG text. The known ones are drawn first. A line without points shows its
/// markers only.
///
/// # Errors
/// Message of plotters if it cannot draw.
pub fn curves(
    title: &str,
    axes: [&str; 2],
    runs: &[Line],
    known: &[Line],
) -> Result<String, String> {
    let pen = |i: usize| Pen {
        colour: TESTS[i % TESTS.len()],
        width: 2,
        dashed: i >= TESTS.len(),
    };
    let below = known.iter().cloned().zip((0..).map(pen));
    let above = runs.iter().cloned().zip((0..).map(run_pen));
    let lines: Vec<(Line, Pen)> = below.chain(above).collect();
    picture(title, axes, &[], &lines)
}

fn plain(name: &str, points: Vec<Point>) -> Line {
    Line {
        name: name.to_owned(),
        points,
        marks: Vec::new(),
    }
}

/// Outline of a band: forwards along its upper edge, back along its lower edge.
struct Outline(Vec<Point>);

impl Outline {
    fn map(self, of: impl Fn(Point) -> Point) -> Self {
        Self(self.0.into_iter().map(of).collect())
    }
}

/// Number of intervals of a band.
const STEPS: usize = 300;

/// Band between the lowest and the highest of several experiments, over the range that at least two of them cover.
fn band(branches: &[Branch]) -> Outline {
    let mut ends: Vec<f64> = branches.iter().filter_map(|b| Some(b.range()?.1)).collect();
    ends.sort_by(f64::total_cmp);
    let Some(&end) = ends.len().checked_sub(2).and_then(|i| ends.get(i)) else {
        return Outline(Vec::new());
    };
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for i in 0..=STEPS {
        let d = end * i as f64 / STEPS as f64;
        let forces = || branches.iter().filter_map(|b| b.force(d, false));
        if forces().count() >= 2 {
            low.push((d, forces().fold(f64::INFINITY, f64::min)));
            high.push((d, forces().fold(f64::NEG_INFINITY, f64::max)));
        }
    }
    high.extend(low.into_iter().rev());
    Outline(high)
}

type Failed<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;
type Plane<'a, 'b> = ChartContext<'b, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Lines on axes over a filled outline; later lines are on top.
pub(super) fn picture(
    title: &str,
    axes: [&str; 2],
    band: &[Point],
    lines: &[(Line, Pen)],
) -> Result<String, String> {
    super::svg(SIZE, |root| draw(root, title, axes, band, lines))
}

fn draw<'a>(
    root: &DrawingArea<SVGBackend<'a>, Shift>,
    title: &str,
    axes: [&str; 2],
    band: &[Point],
    lines: &[(Line, Pen)],
) -> Result<(), Failed<'a>> {
    root.fill(&WHITE)?;
    let all = || {
        let of_lines = lines
            .iter()
            .flat_map(|(l, _)| l.points.iter().chain(&l.marks));
        of_lines.chain(band)
    };
    let mut chart = ChartBuilder::on(root)
        .caption(shortened(title, TITLE), ("sans-serif", 20))
        .margin(18)
        .x_label_area_size(46)
        .y_label_area_size(70)
        .build_cartesian_2d(span(all().map(|p| p.0)), span(all().map(|p| p.1)))?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(232, 232, 232))
        .x_desc(axes[0])
        .y_desc(axes[1])
        .axis_desc_style(("sans-serif", 16))
        .label_style(("sans-serif", 14))
        .draw()?;
    if !band.is_empty() {
        chart
            .draw_series([Polygon::new(band.to_vec(), BAND.filled())])?
            .label("experiments, from lowest to highest")
            .legend(|(x, y)| Rectangle::new([(x, y - 5), (x + 22, y + 5)], BAND.filled()));
    }
    for (line, pen) in lines {
        curve(&mut chart, line, *pen)?;
    }
    if lines.iter().any(|(line, _)| !line.name.is_empty()) {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .margin(14)
            .legend_area_size(30)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .label_font(("sans-serif", 14))
            .draw()?;
    }
    Ok(())
}

fn curve<'a>(chart: &mut Plane<'a, '_>, line: &Line, pen: Pen) -> Result<(), Failed<'a>> {
    let style = pen.colour.stroke_width(pen.width);
    let points = line.points.iter().copied();
    let drawn = if pen.dashed {
        chart.draw_series(DashedLineSeries::new(points, 7, 5, style))?
    } else {
        chart.draw_series(LineSeries::new(points, style))?
    };
    if !line.name.is_empty() {
        drawn
            .label(shortened(&line.name, NAME))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 22, y)], style));
    }
    let mark = |at: &Point| Circle::new(*at, 4, pen.colour.filled());
    chart.draw_series(line.marks.iter().map(mark))?;
    Ok(())
}

/// Largest number of characters.
const TITLE: usize = 80;
const NAME: usize = 60;

fn shortened(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most - 1).chain(['…']).collect()
}

/// A range that contains the values and zero, with a margin of 6 %.
fn span(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let finite = values.filter(|v| v.is_finite());
    let (low, high) = finite.fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    if low == high {
        0.0..1.0
    } else {
        1.06 * low..1.06 * high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn experiment(name: &str, points: &[Point]) -> Experiment {
        Experiment {
            name: name.to_owned(),
            points: points.to_vec(),
        }
    }

    #[test]
    fn runs_experiments_and_their_band_are_named() {
        let run = Line {
            name: "wythe <run>".to_owned(),
            points: vec![(0.0, 0.0), (1.0, 10.0), (2.0, 9.0)],
            marks: vec![(1.0, 10.0)],
        };
        let tests = [
            experiment("SW1", &[(0.0, 0.0), (1.0, 9.0), (2.0, 8.0)]),
            experiment("SW2", &[(0.0, 0.0), (-1.0, -11.0), (-1.5, -10.0)]),
        ];
        let svg = load_displacements("Wall & curves", std::slice::from_ref(&run), &tests).unwrap();
        for said in [
            "Wall &amp; curves",
            "force [kN]",
            "wythe &lt;run&gt;",
            "SW1",
            "SW2, mirrored",
            "from lowest to highest",
        ] {
            assert!(svg.contains(said), "{said}");
        }
        let cyclic = [(0.0, 0.0), (1.0, 9.0), (0.2, 0.0), (-1.0, -9.0), (2.0, 8.0)];
        let svg = load_displacements("", &[run], &[experiment("C1", &cyclic)]).unwrap();
        assert!(svg.contains("C1: envelope") && !svg.contains("lowest"));
    }

    #[test]
    fn the_band_lies_between_the_branches() {
        let branches =
            [[(0.0, 0.0), (2.0, 4.0)], [(0.0, 0.0), (3.0, 3.0)]].map(|p| Branch::new(&p, 1.0));
        let Outline(outline) = band(&branches);
        assert_eq!(outline.len(), 2 * (STEPS + 1));
        assert_eq!(outline[STEPS], (2.0, 4.0));
        assert_eq!(outline[STEPS + 1], (2.0, 2.0));
        assert!(band(&branches[..1]).0.is_empty());
    }

    #[test]
    fn nothing_at_all_gives_empty_axes() {
        assert!(
            load_displacements("", &[], &[])
                .unwrap()
                .contains("force [kN]")
        );
    }
}
