//! Load-displacement curves of runs and experiments.
//!
//! A cyclic experiment is drawn with its loops as thin lines and with its envelope. Of several experiments, the band
//! between the lowest and the highest is filled.

use super::axes::{Axes, Label};
use crate::experiment::{Experiment, Point};
use crate::results::branch::{self, Branch};
use crate::results::colours::Rgb;
use crate::results::curve::brief;

/// Width and height of the picture [px].
const SIZE: (f64, f64) = (900.0, 600.0);
/// Colours of runs in order, repeated if there are more runs.
const RUNS: [Rgb; 5] = [
    [31, 78, 121],
    [178, 34, 34],
    [46, 125, 50],
    [123, 63, 152],
    [190, 110, 20],
];
/// Colours of experiments in order.
const TESTS: [Rgb; 4] = [
    [95, 95, 95],
    [150, 130, 100],
    [120, 140, 150],
    [150, 120, 140],
];
const LOOPS: Rgb = [190, 190, 190];

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
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    pub colour: Rgb,
    pub width: f64,
    pub dashed: bool,
}

/// Style of a run.
pub(super) fn run_pen(index: usize) -> Pen {
    Pen {
        colour: RUNS[index % RUNS.len()],
        width: 2.0,
        dashed: false,
    }
}

/// Curves of runs and experiments as SVG text. Experiments on the opposite side are mirrored to that of the first
/// run.
///
/// # Errors
/// No point has finite numbers.
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
            width: 2.0,
            dashed: i >= TESTS.len(),
        };
        let turned = |p: &Point| (sign * p.0, sign * p.1);
        let all: Vec<Point> = experiment.points.iter().map(turned).collect();
        if branch::returns(&experiment.points) {
            let thin = Pen {
                colour: LOOPS,
                width: 1.0,
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
    let names = ["displacement [mm]", "force [kN]"];
    let labels: Vec<Label> = runs.iter().enumerate().flat_map(of_marks).collect();
    Axes {
        size: SIZE,
        title,
        names,
        band: (&band.0, "experiments, from lowest to highest"),
        lines: &lines,
        labels: &labels,
    }
    .svg()
}

/// Force and displacement at the marks of a run.
fn of_marks((index, run): (usize, &Line)) -> impl Iterator<Item = Label> {
    let colour = run_pen(index).colour;
    run.marks.iter().map(move |&at| Label {
        at,
        text: format!("{} kN at {} mm", brief(at.1), brief(at.0)),
        colour,
    })
}

/// Curves of runs over known curves, as SVG text. The known ones are drawn first. A line without points shows its
/// markers only.
///
/// # Errors
/// No point has finite numbers.
pub fn curves(
    title: &str,
    axes: [&str; 2],
    runs: &[Line],
    known: &[Line],
) -> Result<String, String> {
    let pen = |i: usize| Pen {
        colour: TESTS[i % TESTS.len()],
        width: 2.0,
        dashed: i >= TESTS.len(),
    };
    let below = known.iter().cloned().zip((0..).map(pen));
    let above = runs.iter().cloned().zip((0..).map(run_pen));
    let lines: Vec<(Line, Pen)> = below.chain(above).collect();
    picture(title, axes, &lines)
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

/// One line without a name, and the text at each of its marks.
pub(in crate::results) fn marked(
    size: (f64, f64),
    title: &str,
    names: [&str; 2],
    (line, said): (&Line, &str),
) -> Result<String, String> {
    let label = |at: &Point| Label {
        at: *at,
        text: said.to_owned(),
        colour: RUNS[1],
    };
    let labels: Vec<Label> = line.marks.iter().map(label).collect();
    let above = Line {
        points: Vec::new(),
        ..line.clone()
    };
    let below = plain("", line.points.clone());
    Axes {
        size,
        title,
        names,
        band: (&[], ""),
        lines: &[(below, run_pen(0)), (above, run_pen(1))],
        labels: &labels,
    }
    .svg()
}

/// Lines on axes; later lines are on top.
pub(super) fn picture(
    title: &str,
    names: [&str; 2],
    lines: &[(Line, Pen)],
) -> Result<String, String> {
    Axes {
        size: SIZE,
        title,
        names,
        band: (&[], ""),
        lines,
        labels: &[],
    }
    .svg()
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

    /// A peak lies at its place to a hundredth of a pixel, with a label beside it that no line crosses.
    #[test]
    fn curves_have_decimals_and_the_peak_its_mark() {
        let points: Vec<Point> = (0..200)
            .map(|i| 0.01 * f64::from(i))
            .map(|d| (d, 12.0 * (1.5 * d).sin()))
            .collect();
        let peak = points[105];
        let run = Line {
            name: "run".to_owned(),
            points: points.clone(),
            marks: vec![peak],
        };
        let svg = load_displacements("", &[run], &[]).unwrap();
        let text = svg.split("<polyline points=\"").nth(1).unwrap();
        let text = text.split('"').next().unwrap();
        let drawn: Vec<[f64; 2]> = text
            .split(' ')
            .map(|p| p.split_once(',').unwrap())
            .map(|(x, y)| [x, y].map(|c| c.parse().unwrap()))
            .collect();
        assert_eq!(drawn.len(), points.len());
        let whole = drawn.iter().filter(|p| p[1].fract() == 0.0).count();
        assert!(whole < 20, "{whole} of {} rounded", drawn.len());
        // Steps of equal displacements are equal, to the hundredth that is written.
        for w in drawn.windows(3) {
            assert!((w[2][0] - 2.0 * w[1][0] + w[0][0]).abs() < 0.025);
        }
        let [x, y] = drawn[105];
        assert!(svg.contains(&format!(r#"class="mark" cx="{x:.2}" cy="{y:.2}""#)));
        assert!(svg.contains("12.00 kN at 1.050 mm"));
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
