//! `load_displacement.svg`: force against displacement with the peak marked.

use super::Curve;
use super::curve::brief;
use super::plotting::Line;
use super::plotting::chart::marked;

/// Width and height of the picture [px].
const SIZE: (f64, f64) = (800.0, 560.0);

/// The load-displacement curve as SVG text. A run without a drive has empty axes.
///
/// # Errors
/// No point of the curve has finite numbers.
pub fn load_displacement(title: &str, curve: &Curve) -> Result<String, String> {
    let peak = curve.peak();
    let line = Line {
        name: String::new(),
        points: super::comparison::points_of(curve),
        marks: peak
            .iter()
            .map(|peak| (peak.displacement, peak.force))
            .collect(),
    };
    let said = peak.map_or_else(String::new, |peak| {
        let (force, at) = (brief(peak.force), brief(peak.displacement));
        format!("{} {force} kN at {at} mm", curve.word_of_largest())
    });
    marked(
        SIZE,
        title,
        ["displacement [mm]", "force [kN]"],
        (&line, &said),
    )
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
}
