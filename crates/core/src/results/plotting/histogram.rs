//! Histogram with a logarithmic axis and stacked bars of several series.

use plotters::coord::Shift;
use plotters::prelude::*;

/// Width and height of the picture [px].
const SIZE: (u32, u32) = (900, 420);
/// Number of bars per factor of ten.
const TO_TEN: i32 = 8;
/// Colours of series, repeated if there are more series.
const COLOURS: [RGBColor; 6] = [
    RGBColor(120, 160, 190),
    RGBColor(150, 190, 140),
    RGBColor(222, 130, 122),
    RGBColor(240, 178, 92),
    RGBColor(196, 180, 214),
    RGBColor(110, 110, 110),
];
/// Margin around the picture, space below and beside the axes for labels [px].
const MARGIN: u32 = 16;
const BELOW: u32 = 46;
const BESIDE: u32 = 60;

/// A series of a histogram.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    /// Name in the legend.
    pub name: String,
    /// Index of the colour.
    pub colour: usize,
    /// Positive values.
    pub values: Vec<f64>,
}

/// A histogram of positive values as SVG text. The series are stacked in the given order; those without values are
/// not in the legend. `axis` labels the values, `counts` the bars.
///
/// # Errors
/// There is no value, a value is not positive, or plotters cannot draw.
pub fn histogram(title: &str, axis: &str, counts: &str, series: &[Bars]) -> Result<String, String> {
    let all = || series.iter().flat_map(|s| &s.values);
    if all().next().is_none() || !all().all(|v| *v > 0.0 && v.is_finite()) {
        return Err("a logarithmic axis wants values above zero".to_owned());
    }
    super::svg(SIZE, |root| draw(root, [title, axis, counts], series))
}

type Failed<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

/// Index of the bar of a value; bar 0 begins at 1.
fn bar(value: f64) -> i32 {
    (value.log10() * f64::from(TO_TEN)).floor() as i32
}

/// Lower end of a bar.
fn edge(bar: i32) -> f64 {
    10.0_f64.powf(f64::from(bar) / f64::from(TO_TEN))
}

fn draw<'a>(
    root: &DrawingArea<SVGBackend<'a>, Shift>,
    [title, axis, counts]: [&str; 3],
    series: &[Bars],
) -> Result<(), Failed<'a>> {
    root.fill(&WHITE)?;
    let bars = || series.iter().flat_map(|s| &s.values).map(|v| bar(*v));
    let (first, last) = (bars().min().unwrap_or(0), bars().max().unwrap_or(0));
    let count = |of: &Bars, at: i32| of.values.iter().filter(|v| bar(**v) == at).count();
    let heights = (first..=last).map(|at| series.iter().map(|s| count(s, at)).sum::<usize>());
    let highest = heights.max().unwrap_or(1);
    let mut chart = ChartBuilder::on(root)
        .caption(title, ("sans-serif", 20))
        .margin(MARGIN)
        .x_label_area_size(BELOW)
        .y_label_area_size(BESIDE)
        .build_cartesian_2d(
            (edge(first)..edge(last + 1)).log_scale(),
            0.0..highest as f64 * 1.05,
        )?;
    chart
        .configure_mesh()
        .light_line_style(RGBColor(246, 246, 246))
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(axis)
        .y_desc(counts)
        .x_label_formatter(&|v| marked(*v))
        .y_label_formatter(&|v| whole(*v))
        .axis_desc_style(("sans-serif", 16))
        .label_style(("sans-serif", 14))
        .draw()?;
    let mut below = vec![0_usize; (last - first + 1) as usize];
    for of_series in series.iter().filter(|s| !s.values.is_empty()) {
        let colour = COLOURS[of_series.colour % COLOURS.len()];
        let mut rectangles = Vec::new();
        for (at, below) in (first..=last).zip(&mut below) {
            let above = *below + count(of_series, at);
            if above > *below {
                let corners = [(edge(at), *below as f64), (edge(at + 1), above as f64)];
                rectangles.push(Rectangle::new(corners, colour.filled()));
                rectangles.push(Rectangle::new(corners, WHITE.stroke_width(1)));
            }
            *below = above;
        }
        chart
            .draw_series(rectangles)?
            .label(format!("{} ({})", of_series.name, of_series.values.len()))
            .legend(move |(x, y)| Rectangle::new([(x, y - 6), (x + 14, y + 6)], colour.filled()));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.9))
        .border_style(RGBColor(225, 225, 225))
        .label_font(("sans-serif", 14))
        .draw()
}

/// Label of a count; empty between integers.
fn whole(value: f64) -> String {
    if value == value.round() {
        value.to_string()
    } else {
        String::new()
    }
}

/// Label on the logarithmic axis: only numbers that begin with 1, 2 or 5, because space is limited.
fn marked(value: f64) -> String {
    let text = value.round().to_string();
    if text.starts_with(['1', '2', '5']) {
        text
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bars(name: &str, values: &[f64]) -> Bars {
        Bars {
            name: name.to_owned(),
            colour: 0,
            values: values.to_vec(),
        }
    }

    #[test]
    fn bars_are_stacked_and_series_without_a_value_are_omitted() {
        let series = [
            bars("completed", &[100.0, 101.0, 1000.0]),
            bars("collapsed", &[]),
            bars("out_of_time", &[100.0]),
        ];
        let svg = histogram("Zoo", "solves", "walls", &series).unwrap();
        for said in ["completed (3)", "out_of_time (1)", "solves", "walls"] {
            assert!(svg.contains(said), "{said}");
        }
        assert!(!svg.contains("collapsed"));
        // Three bars, each filled and outlined; two marks of the legend with its frame and background; the background
        // of the picture.
        assert_eq!(svg.matches("<rect ").count(), 3 * 2 + 2 + 2 + 1);
    }

    #[test]
    fn bars_meet_at_the_powers_of_ten() {
        assert_eq!((bar(1.0), bar(10.0), bar(9.999)), (0, TO_TEN, TO_TEN - 1));
        assert!((edge(2 * TO_TEN) - 100.0).abs() < 1e-9); // rounding of the power
    }

    #[test]
    fn histogram_values_without_a_logarithm_are_rejected() {
        for values in [&[][..], &[0.0], &[f64::NAN], &[1.0, -1.0]] {
            assert!(histogram("", "", "", &[bars("a", values)]).is_err());
        }
    }
}
