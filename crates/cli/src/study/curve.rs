//! Comparison of a run's curve with a reference.

use std::path::Path;

use wythe_core::error::IoError;

/// A point of a curve: abscissa and ordinate, in the units of their columns.
pub type Point = [f64; 2];

/// Reads two columns of a CSV file with a header; `#` begins a comment.
///
/// # Errors
/// The file cannot be read, a column is missing, or a field is not a finite number.
pub fn read(path: &Path, x: &str, y: &str) -> Result<Vec<Point>, IoError> {
    let wrong = |why: String| IoError {
        path: path.to_owned(),
        why: std::io::Error::new(std::io::ErrorKind::InvalidData, why),
    };
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_path(path)
        .map_err(|error| match error.into_kind() {
            csv::ErrorKind::Io(why) => IoError {
                path: path.to_owned(),
                why,
            },
            other => wrong(format!("{other:?}")),
        })?;
    let header = reader.headers().map_err(|e| wrong(e.to_string()))?.clone();
    let place = |name: &str| {
        let known = || header.iter().collect::<Vec<_>>().join(", ");
        header.iter().position(|h| h == name).ok_or_else(|| {
            wrong(format!(
                "there is no column `{name}`; there are {}",
                known()
            ))
        })
    };
    let columns = [place(x)?, place(y)?];
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| wrong(e.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut point = [0.0; 2];
        for (value, column) in point.iter_mut().zip(columns) {
            let field = record.get(column).unwrap_or_default();
            *value = field
                .parse()
                .ok()
                .filter(|v: &f64| v.is_finite())
                .ok_or_else(|| wrong(format!("line {line}: `{field}` is no number")))?;
        }
        points.push(point);
    }
    if points.len() < 2 {
        return Err(wrong("a curve takes two rows or more".to_owned()));
    }
    Ok(points)
}

/// Difference between a run and a reference [-].
///
/// If the reference advances in x, this is the root mean square of the difference along the run, divided by the
/// largest |y| of the reference. If the reference turns back in x, as after a snap-back, it is the largest
/// distance of a point of the run from the reference polyline, with both axes divided by their ranges.
///
/// # Errors
/// Fewer than two points of the run lie in the range of the reference.
pub fn difference(run: &[Point], reference: &[Point]) -> Result<f64, String> {
    // The reference alone decides, so that all methods are measured alike.
    if advances(reference) {
        root_mean_square(run, reference)
    } else {
        Ok(distance(run, reference))
    }
}

fn advances(curve: &[Point]) -> bool {
    // Equal abscissae do not count as a return.
    curve.windows(2).all(|w| w[1][0] >= w[0][0]) || curve.windows(2).all(|w| w[1][0] <= w[0][0])
}

fn root_mean_square(run: &[Point], reference: &[Point]) -> Result<f64, String> {
    let errors: Vec<Point> = run
        .iter()
        .filter_map(|&[x, y]| interpolate(reference, x).map(|expected| [x, y - expected]))
        .collect();
    if errors.len() < 2 {
        return Err("does not come by the reference".to_owned());
    }
    let (mut squares, mut length) = (0.0, 0.0);
    for pair in errors.windows(2) {
        let dx = (pair[1][0] - pair[0][0]).abs();
        squares += 0.5 * dx * (pair[0][1].powi(2) + pair[1][1].powi(2));
        length += dx;
    }
    let scale = reference.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
    Ok((squares / length).sqrt() / scale)
}

/// y at x by linear interpolation; none beyond the ends.
fn interpolate(curve: &[Point], x: f64) -> Option<f64> {
    curve.windows(2).find_map(|w| {
        let [[x0, y0], [x1, y1]] = [w[0], w[1]];
        let within = (x0 <= x && x <= x1) || (x1 <= x && x <= x0);
        let part = if x1 == x0 { 0.5 } else { (x - x0) / (x1 - x0) };
        within.then_some(y0 + part * (y1 - y0))
    })
}

fn distance(run: &[Point], reference: &[Point]) -> f64 {
    let range = |i: usize| {
        let (low, high) = reference
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                (low.min(p[i]), high.max(p[i]))
            });
        if high > low { high - low } else { 1.0 }
    };
    let scale = [range(0), range(1)];
    let scaled = |p: &Point| [p[0] / scale[0], p[1] / scale[1]];
    let reference: Vec<Point> = reference.iter().map(scaled).collect();
    run.iter()
        .map(scaled)
        .map(|p| {
            let to = reference.windows(2).map(|w| to_segment(p, w[0], w[1]));
            // A NaN gives an infinite distance.
            to.fold(f64::INFINITY, f64::min)
        })
        .fold(0.0, f64::max)
}

fn to_segment(p: Point, a: Point, b: Point) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let from = [p[0] - a[0], p[1] - a[1]];
    let square = along[0].powi(2) + along[1].powi(2);
    let part = if square > 0.0 {
        ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (from[0] - part * along[0]).hypot(from[1] - part * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAMP: [Point; 3] = [[0.0, 0.0], [1.0, 10.0], [2.0, 0.0]];

    #[test]
    fn a_curve_is_no_distance_from_itself_and_an_offset_is_measured() {
        let off = |by: f64| RAMP.map(|[x, y]| [x, y + by]);
        assert_eq!(difference(&RAMP, &RAMP), Ok(0.0));
        // The difference is 0.5 everywhere, the largest ordinate 10.
        assert!((difference(&off(0.5), &RAMP).unwrap() - 0.05).abs() < 1e-15);
        // Intervals are weighted by their length: the curve is exact over half of the range.
        let half = [[0.0, 0.0], [1.0, 10.0], [1.0, 11.0], [1.5, 6.0]];
        let expected = (0.5_f64 / 1.5).sqrt() / 10.0;
        assert!((difference(&half, &RAMP).unwrap() - expected).abs() < 1e-15);
        assert!(difference(&[[3.0, 0.0], [4.0, 0.0]], &RAMP).is_err());
        let lost = difference(&[[0.0, f64::NAN], [1.0, 10.0]], &RAMP).unwrap();
        assert!(lost.is_nan());
    }

    #[test]
    fn a_path_that_returns_is_measured_by_distance() {
        let back = [[0.0, 0.0], [2.0, 10.0], [1.0, 5.0], [3.0, 0.0]];
        assert_eq!(difference(&back, &back), Ok(0.0));
        let beside = [[0.0, 0.0], [2.0, 10.0], [1.0, 5.0], [3.0, 1.0]];
        // Divided by the ranges, the last segment has the direction (2/3, −1/2): a point 0.1 above its end is 0.08
        // from it.
        assert!((difference(&beside, &back).unwrap() - 0.08).abs() < 1e-15);
        // If the reference advances, a run that returns is measured on both ways.
        let there_and_back = [[0.0, 0.0], [1.0, 11.0], [0.0, 0.0]];
        let expected = (0.5_f64 * 2.0 / 2.0).sqrt() / 10.0;
        assert!((difference(&there_and_back, &RAMP).unwrap() - expected).abs() < 1e-15);
        let nan = [[0.0, 0.0], [2.0, f64::NAN], [1.0, 5.0]];
        assert!(difference(&nan, &back).unwrap().is_infinite());
    }
}
