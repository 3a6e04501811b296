//! The straight line through measured pairs.

/// Line y = `at_zero` + `slope` x that has the least squares of its distances in y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    pub(super) at_zero: f64,
    pub(super) slope: f64,
}

impl Line {
    /// The line through pairs (x, y); none if they have fewer than two different x.
    pub(super) fn through(pairs: &[(f64, f64)]) -> Option<Self> {
        let n = pairs.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / n;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let across: f64 = pairs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
        let both: f64 = pairs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        (across > 0.0).then(|| {
            let slope = both / across;
            Self {
                at_zero: y - slope * x,
                slope,
            }
        })
    }
}
