//! `load_displacement.svg`: force against displacement with the peak marked.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Curve;

/// Width and height of the picture [px].
const SIZE: (u32, u32) = (800, 560);
const CURVE: RGBColor = RGBColor(31, 78, 121);
const MARK: RGBColor = RGBColor(178, 34, 34);

/// The load-displacement curve as SVG text. A run without a drive has empty axes.
///
/// # Errors
/// Message of plotters if it cannot draw.
pub fn load_displacement(title: &str, curve: &Curve) -> Result<String, String> {
    super::plotting::svg(SIZE, |root| draw(root, title, curve))
}

type Drawn<'a> = Result<(), DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>>;

fn draw<'a>(root: &DrawingArea<SVGBackend<'a>, Shift>, title: &str, curve: &Curve) -> Drawn<'a> {
    root.fill(&WHITE)?;
    let line: Vec<(f64, f64)> = std::iter::once(curve.start())
        .chain(curve.points().iter().copied())
        .collect();
    let mut chart = ChartBuilder::on(root)
        .caption(title, ("sans-serif", 20))
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(
            span(line.iter().map(|p| p.0)),
            span(line.iter().map(|p| p.1)),
        )?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("displacement [mm]")
        .y_desc("force [kN]")
        .axis_desc_style(("sans-serif", 16))
        .label_style(("sans-serif", 14))
        .draw()?;
    chart.draw_series(LineSeries::new(line, CURVE.stroke_width(2)))?;
    if let Some(peak) = curve.peak() {
        let at = (peak.displacement, peak.force);
        chart.draw_series(PointSeries::of_element(
            [at],
            4,
            MARK.filled(),
            &|at, size, style| Circle::new(at, size, style),
        ))?;
        let label = format!(
            "{} {} kN at {} mm",
            curve.word_of_largest(),
            brief(peak.force),
            brief(peak.displacement)
        );
        // The label lies to the right, above the descending curve, or to the left for a peak near the right end.
        let left =
            at.0 > chart.x_range().start + 0.7 * (chart.x_range().end - chart.x_range().start);
        let offset = (if left { -170 } else { 8 }, -20);
        let style = ("sans-serif", 14).into_font().color(&MARK);
        chart.draw_series([EmptyElement::at(at) + Text::new(label, offset, style)])?;
    }
    Ok(())
}

/// Four significant digits without an exponent: peaks lie between micrometres (couplets) and millimetres (walls).
pub(super) fn brief(value: f64) -> String {
    let digits = if value == 0.0 {
        0
    } else {
        3 - value.abs().log10().floor() as i32
    };
    format!("{value:.*}", digits.clamp(0, 9) as usize)
}

/// A range that contains the values and zero, with a margin of 8 %.
fn span(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((0.0_f64, 0.0_f64), |(low, high), v| {
            (low.min(v), high.max(v))
        });
    if low == high {
        0.0..1.0
    } else {
        1.08 * low..1.08 * high
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{StepOfCurve, fake};

    #[test]
    fn the_picture_names_its_axes_and_the_peak() {
        let mut curve = Curve::default();
        for (i, (d, f)) in [(0.5, 40.0), (1.9, 105.84), (4.0, 75.0)]
            .into_iter()
            .enumerate()
        {
            let of = StepOfCurve {
                driven: true,
                ..StepOfCurve::default()
            };
            curve.push(&fake::row(i + 1, 1, d, f), of);
        }
        let svg = load_displacement("Wall <J7D> & more", &curve).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for text in [
            "displacement [mm]",
            "force [kN]",
            "peak 105.8 kN at 1.900 mm",
            "&lt;J7D&gt; &amp;",
        ] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert!(svg.contains("<polyline"));
    }

    #[test]
    fn nothing_driven_gives_empty_axes() {
        let svg = load_displacement("Preload only", &Curve::default()).unwrap();
        assert!(svg.contains("force [kN]") && !svg.contains("peak"));
    }

    #[test]
    fn numbers_keep_four_digits() {
        for (value, text) in [
            (0.003125, "0.003125"),
            (-1.9, "-1.900"),
            (12345.6, "12346"),
            (0.0, "0"),
        ] {
            assert_eq!(brief(value), text);
        }
    }

    #[test]
    fn a_range_holds_zero_and_every_value() {
        assert_eq!(span([1.0, 2.0].into_iter()), 0.0..1.08 * 2.0);
        assert_eq!(span([-1.0].into_iter()), -1.08..0.0);
        assert_eq!(span([f64::NAN].into_iter()), 0.0..1.0);
    }
}
