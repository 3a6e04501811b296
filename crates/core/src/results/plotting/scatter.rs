//! Scatter plot on two logarithmic axes with names, colours by series and a Pareto front.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;

use crate::experiment::Point;

/// Width and height of the picture [px].
const SIZE: (u32, u32) = (1200, 660);
/// Colours of series, repeated if there are more series.
const COLOURS: [RGBColor; 14] = [
    RGBColor(20, 20, 20),
    RGBColor(178, 34, 34),
    RGBColor(31, 78, 121),
    RGBColor(46, 125, 50),
    RGBColor(123, 63, 152),
    RGBColor(190, 110, 20),
    RGBColor(0, 127, 143),
    RGBColor(200, 60, 130),
    RGBColor(110, 110, 40),
    RGBColor(90, 90, 160),
    RGBColor(110, 80, 60),
    RGBColor(95, 95, 95),
    RGBColor(212, 175, 0),
    RGBColor(230, 80, 20),
];
const FRONT: RGBColor = RGBColor(150, 170, 190);
const FLOOR: RGBColor = RGBColor(120, 120, 120);
/// Size of names, and width of a character [px].
const LETTERS: i32 = 13;
const LETTER: f64 = 6.8;
/// Margin around the picture, space for axis labels below and beside, width of the legend, and its line height [px].
const MARGIN: u32 = 18;
const BELOW: u32 = 46;
const BESIDE: u32 = 76;
const LEGEND: u32 = 240;
const LINE: i32 = 17;
/// Radius of a point [px].
const RADIUS: i32 = 5;

/// A point with its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spot {
    /// Name written beside the point.
    pub name: String,
    /// Coordinates, both positive.
    pub at: Point,
    /// Index of the series.
    pub series: usize,
    /// Whether the point has a ring.
    pub marked: bool,
}

/// Points on logarithmic axes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scatter<'a> {
    /// Title.
    pub title: &'a str,
    /// Names of the axes.
    pub axes: [&'a str; 2],
    /// Names of the series; those without points are not in the legend.
    pub series: &'a [&'a str],
    /// The points.
    pub spots: &'a [Spot],
    /// Points of the front, in the order of x.
    pub front: &'a [Point],
    /// An ordinate with its name, below which differences are meaningless.
    pub floor: Option<(f64, &'a str)>,
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Plane<'a, 'b> = ChartContext<'b, SVGBackend<'a>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;
type Failed<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

impl Scatter<'_> {
    /// The plot as SVG text.
    ///
    /// # Errors
    /// There is no point, a point is not positive, or plotters cannot draw.
    pub fn svg(&self) -> Result<String, String> {
        let above_zero = |p: &Point| p.0 > 0.0 && p.1 > 0.0 && p.0.is_finite() && p.1.is_finite();
        let mut points = self.spots.iter().map(|s| &s.at).chain(self.front);
        if self.spots.is_empty() || !points.all(above_zero) {
            return Err("logarithmic axes want points above zero".to_owned());
        }
        super::svg(SIZE, |root| self.draw(root))
    }

    fn draw<'a>(&self, root: &Area<'a>) -> Result<(), Failed<'a>> {
        root.fill(&WHITE)?;
        let xs = self.spots.iter().map(|s| s.at.0);
        let ys = self.spots.iter().map(|s| s.at.1);
        let ys = ys.chain(self.floor.map(|f| f.0));
        // Leaves space for names on the right and above.
        let (xs, ys) = (span(xs, 1.3, 2.0), span(ys, 1.6, 2.0));
        let mut chart = ChartBuilder::on(root)
            .caption(self.title, ("sans-serif", 20))
            .margin(MARGIN)
            .margin_right(MARGIN + LEGEND)
            .x_label_area_size(BELOW)
            .y_label_area_size(BESIDE)
            .build_cartesian_2d(xs.log_scale(), ys.log_scale())?;
        chart
            .configure_mesh()
            .light_line_style(RGBColor(246, 246, 246))
            .bold_line_style(RGBColor(225, 225, 225))
            .x_desc(self.axes[0])
            .y_desc(self.axes[1])
            .x_label_formatter(&|v| digits(*v))
            .y_label_formatter(&|v| digits(*v))
            .axis_desc_style(("sans-serif", 16))
            .label_style(("sans-serif", 14))
            .draw()?;
        self.lines(&mut chart)?;
        for spot in self.spots {
            let mark = Circle::new(spot.at, RADIUS, colour(spot.series).filled());
            chart.draw_series([mark])?;
        }
        let ringed = self.spots.iter().filter(|s| s.marked);
        chart.draw_series(ringed.map(|s| Circle::new(s.at, RADIUS + 5, BLACK.stroke_width(2))))?;
        self.legend(root)?;
        self.names(root, &chart)
    }

    /// Draws the front as steps, and the floor.
    fn lines<'a>(&self, chart: &mut Plane<'a, '_>) -> Result<(), Failed<'a>> {
        if let Some(last) = self.front.last() {
            let corner = |w: &[Point]| [w[0], (w[1].0, w[0].1)];
            let stairs = self.front.windows(2).flat_map(corner).chain([*last]);
            chart.draw_series(LineSeries::new(stairs, FRONT.stroke_width(3)))?;
        }
        if let Some((floor, _)) = self.floor {
            let range = span(self.spots.iter().map(|s| s.at.0), 1.3, 2.0);
            let line = [(range.start, floor), (range.end, floor)];
            chart.draw_series(DashedLineSeries::new(line, 6, 5, FLOOR.stroke_width(1)))?;
        }
        Ok(())
    }

    /// Draws the legend to the right of the plot, with the lines and series that occur.
    fn legend<'a>(&self, root: &Area<'a>) -> Result<(), Failed<'a>> {
        let left = (SIZE.0 - MARGIN - LEGEND) as i32 + 12;
        let mut y = MARGIN as i32 + 40;
        let mut say = |name: &str, mark: &dyn Fn(i32) -> Result<(), Failed<'a>>| {
            mark(y)?;
            let style = ("sans-serif", LETTERS).into_font();
            let at = (left + 24, y - LETTERS / 2);
            y += LINE;
            root.draw(&Text::new(name.to_owned(), at, style))
        };
        let stroke = |[from, to]: [i32; 2], y: i32, style: ShapeStyle| {
            root.draw(&PathElement::new([(left + from, y), (left + to, y)], style))
        };
        if !self.front.is_empty() {
            let style = FRONT.stroke_width(3);
            say("front: nothing is better in both", &|y| {
                stroke([0, 16], y, style)
            })?;
        }
        if let Some((_, name)) = self.floor {
            let style = FLOOR.stroke_width(1);
            say(name, &|y| {
                stroke([0, 6], y, style).and(stroke([11, 17], y, style))
            })?;
        }
        for (i, name) in self.series.iter().enumerate() {
            if self.spots.iter().any(|s| s.series == i) {
                let mark = colour(i).filled();
                say(name, &|y| {
                    root.draw(&Circle::new((left + 8, y), RADIUS, mark))
                })?;
            }
        }
        Ok(())
    }

    /// Writes names beside their points, where other names leave space.
    fn names<'a>(&self, root: &Area<'a>, chart: &Plane<'a, '_>) -> Result<(), Failed<'a>> {
        let pixels: Vec<(i32, i32)> = self
            .spots
            .iter()
            .map(|s| chart.backend_coord(&s.at))
            .collect();
        let point = |(x, y): &(i32, i32)| Frame([x - RADIUS, y - RADIUS, x + RADIUS, y + RADIUS]);
        let mut taken: Vec<Frame> = pixels.iter().map(point).collect();
        for (spot, at) in self.spots.iter().zip(&pixels) {
            let width = (LETTER * spot.name.chars().count() as f64) as i32;
            let place = place(*at, width, &taken);
            let colour = colour(spot.series);
            if let Some(line) = leader(*at, place) {
                root.draw(&PathElement::new(line, colour.mix(0.4).stroke_width(1)))?;
            }
            let style = ("sans-serif", LETTERS).into_font().color(&colour);
            root.draw(&Text::new(
                spot.name.clone(),
                (place.0[0], place.0[1]),
                style,
            ))?;
            taken.push(place);
        }
        Ok(())
    }
}

/// Left, top, right, bottom [px].
#[derive(Clone, Copy)]
struct Frame([i32; 4]);

impl Frame {
    fn meets(&self, other: &Self) -> bool {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        a < g && e < c && b < h && f < d
    }
}

/// Position of a name: the first free one of positions at growing distance, right before left.
fn place((x, y): (i32, i32), width: i32, taken: &[Frame]) -> Frame {
    let frame = |left: i32, top: i32| Frame([left, top, left + width, top + LETTERS]);
    let beside = [x + 9, x - 9 - width];
    let shifts = (0..12)
        .flat_map(|i| [-i, i])
        .map(|i| y - LETTERS / 2 + i * (LETTERS - 2));
    let mut places = shifts.flat_map(|top| beside.map(|left| frame(left, top)));
    let (from, to) = (MARGIN + BESIDE, SIZE.0 - MARGIN - LEGEND);
    let inside = |f: &Frame| f.0[0] > from as i32 && f.0[2] < to as i32;
    let free = |f: &Frame| inside(f) && !taken.iter().any(|t| t.meets(f));
    places
        .find(free)
        .unwrap_or(frame(beside[0], y - LETTERS / 2))
}

/// Line from a point to its name, if the name is not directly beside it.
fn leader((x, y): (i32, i32), Frame([left, top, right, bottom]): Frame) -> Option<[(i32, i32); 2]> {
    let nearest = if left > x { left } else { right };
    let middle = i32::midpoint(top, bottom);
    ((middle - y).abs() > LETTERS).then_some([(x, y), (nearest, middle)])
}

fn colour(series: usize) -> RGBColor {
    COLOURS[series % COLOURS.len()]
}

/// A range of the values with factors for the margins.
fn span(values: impl Iterator<Item = f64>, below: f64, above: f64) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    low / below..high * above
}

/// The shortest text of a number.
fn digits(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(name: &str, at: Point, series: usize) -> Spot {
        Spot {
            name: name.to_owned(),
            at,
            series,
            marked: series == 0,
        }
    }

    #[test]
    fn points_are_labelled_and_the_legend_has_only_present_series() {
        let spots = [spot("default", (1.0, 2.0), 0), spot("a < b", (3.0, 0.1), 2)];
        let front = [(1.0, 2.0), (3.0, 0.1)];
        let series = ["of nothing said", "never", "mesh"];
        let chart = Scatter {
            title: "Chart",
            axes: ["time", "error"],
            series: &series,
            spots: &spots,
            front: &front,
            floor: Some((0.05, "floor")),
        };
        let svg = chart.svg().unwrap();
        for said in [
            "a &lt; b",
            "default",
            "mesh",
            "floor",
            "front: nothing",
            "error",
        ] {
            assert!(svg.contains(said), "{said}");
        }
        assert!(!svg.contains("never"));
        let without = Scatter {
            front: &[],
            ..chart
        }
        .svg()
        .unwrap();
        assert!(!without.contains("front"));
        // Two points, two in the legend, one ring.
        assert_eq!(svg.matches("<circle ").count(), 5);
    }

    /// For any number and length of names.
    #[test]
    fn the_legend_lies_beside_all_names() {
        let at = (900, 300);
        let name = place(at, 120, &[]);
        assert!(
            name.0[2] < (SIZE.0 - MARGIN - LEGEND) as i32,
            "{:?}",
            name.0
        );
    }

    #[test]
    fn a_distant_label_has_a_leader_line() {
        let at = (400, 300);
        let beside = place(at, 80, &[]);
        assert_eq!(leader(at, beside), None);
        let wall = Frame([0, 260, 1000, 340]);
        let away = place(at, 80, &[wall]);
        let [from, to] = leader(at, away).unwrap();
        assert_eq!(from, at);
        assert!(to.0 == away.0[0] && (away.0[1]..=away.0[3]).contains(&to.1));
    }

    #[test]
    fn coordinates_without_a_logarithm_are_rejected() {
        for at in [(0.0, 1.0), (1.0, -1.0), (1.0, f64::NAN)] {
            let chart = Scatter {
                series: &["a"],
                spots: &[spot("a", at, 0)],
                ..Scatter::default()
            };
            assert!(chart.svg().is_err());
        }
        assert!(Scatter::default().svg().is_err());
    }

    #[test]
    fn names_of_points_in_one_place_do_not_cover_each_other() {
        let mut taken = Vec::new();
        for _ in 0..10 {
            let next = place((400, 300), 80, &taken);
            assert!(!taken.iter().any(|t: &Frame| t.meets(&next)));
            taken.push(next);
        }
    }
}
