//! Amplitudes: the part of a step's drives and loads that acts, over the time of the step.

/// Rows of (part of the step's time, factor), linear between them. The first is (0, 0); the last is at time 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitude {
    /// Rows with ascending times. `[row][time, factor]`
    rows: Vec<[f64; 2]>,
}

/// Part of an amplitude between two rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// Time, as part of that of the step, and factor at its start.
    pub from: [f64; 2],
    /// The same at its end.
    pub to: [f64; 2],
}

impl Branch {
    /// The whole of a step without an amplitude: factors equal times.
    pub const WHOLE: Self = Self {
        from: [0.0; 2],
        to: [1.0; 2],
    };

    /// Slope of the factor over the part of the time [-].
    pub fn slope(&self) -> f64 {
        (self.to[1] - self.from[1]) / (self.to[0] - self.from[0])
    }

    /// Factor at a part of the time. At both ends it is exactly that of the row, whatever the rounding of the time.
    pub fn factor(&self, time: f64) -> f64 {
        if *self == Self::WHOLE {
            return time;
        }
        if (time - self.to[0]).abs() <= ROUNDING {
            return self.to[1];
        }
        self.from[1] + (time - self.from[0]) * self.slope()
    }

    /// Part of the time at which a factor is reached, extrapolated beyond the ends. The start, if the factor is
    /// constant.
    pub fn time(&self, factor: f64) -> f64 {
        if *self == Self::WHOLE {
            return factor;
        }
        if factor == self.to[1] {
            return self.to[0];
        }
        if self.slope() == 0.0 {
            return self.from[0];
        }
        self.from[0] + (factor - self.from[1]) / self.slope()
    }
}

/// Difference of times, as parts of a step, below which they are equal.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Error in the rows of an amplitude.
#[derive(Clone, Debug, PartialEq)]
pub struct NoAmplitude {
    /// Faulty row.
    pub row: usize,
    /// Reason.
    pub why: String,
}

impl Amplitude {
    /// Makes an amplitude of rows (part of the time, factor).
    ///
    /// # Errors
    /// [`NoAmplitude`]: fewer than two rows, times that do not ascend from 0 to 1, a first factor other than 0, or
    /// only zero factors.
    pub fn new(rows: Vec<[f64; 2]>) -> Result<Self, NoAmplitude> {
        let wrong = |row: usize, why: String| Err(NoAmplitude { row, why });
        if rows.len() < 2 {
            return wrong(0, "an amplitude has two rows at least".to_owned());
        }
        let last = rows.len() - 1;
        let [[begin, first], [end, _]] = [rows[0], rows[last]];
        if begin != 0.0 || first != 0.0 {
            return wrong(0, format!("it begins at [{begin}, {first}], not at [0, 0]"));
        }
        if let Some(i) = (1..=last).find(|&i| rows[i][0] <= rows[i - 1][0]) {
            let [time, before] = [rows[i][0], rows[i - 1][0]];
            return wrong(i, format!("the time {time} does not ascend from {before}"));
        }
        if end != 1.0 {
            return wrong(
                last,
                format!("it ends at {end}, not at 1, the end of the step"),
            );
        }
        if rows.iter().all(|row| row[1] == 0.0) {
            return wrong(last, "all factors are 0: nothing happens".to_owned());
        }
        Ok(Self { rows })
    }

    /// Rows.
    pub fn rows(&self) -> &[[f64; 2]] {
        &self.rows
    }

    /// Cycles at a constant rate. Each of `amplitudes`, relative to the largest, is driven forth, back to its
    /// negative, and to zero, `repeat` times.
    ///
    /// # Errors
    /// [`NoAmplitude`] if there are none, or none above 0.
    pub fn cycles(amplitudes: &[f64], repeat: u32) -> Result<Self, NoAmplitude> {
        let largest = amplitudes.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 || repeat == 0 {
            let why = "cycles have amplitudes above 0 and are driven once at least".to_owned();
            return Err(NoAmplitude { row: 0, why });
        }
        let way = |a: &f64| 4.0 * a * f64::from(repeat);
        let whole: f64 = amplitudes.iter().map(way).sum();
        let mut rows = vec![[0.0; 2]];
        let mut gone = 0.0;
        for a in amplitudes {
            for _ in 0..repeat {
                for (way, factor) in [(*a, a / largest), (2.0 * a, -a / largest), (*a, 0.0)] {
                    gone += way;
                    rows.push([gone / whole, factor]);
                }
            }
        }
        if let Some(last) = rows.last_mut() {
            last[0] = 1.0; // exact, without rounding
        }
        Self::new(rows)
    }

    /// Number of branches.
    pub fn branches(&self) -> usize {
        self.rows.len() - 1
    }

    /// Branch between row `i` and the next one.
    pub fn branch(&self, i: usize) -> Branch {
        Branch {
            from: self.rows[i],
            to: self.rows[i + 1],
        }
    }

    /// Largest absolute slope of the factor over the part of the time [-].
    pub fn steepest(&self) -> f64 {
        let slopes = (0..self.branches()).map(|i| self.branch(i).slope().abs());
        slopes.fold(0.0, f64::max)
    }

    /// Whether the factor never falls.
    pub fn rises(&self) -> bool {
        (0..self.branches()).all(|i| self.branch(i).slope() >= 0.0)
    }

    /// Factor at the end of the step.
    pub fn end(&self) -> f64 {
        self.rows[self.rows.len() - 1][1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_exact_and_interpolation_is_linear() {
        let amplitude =
            Amplitude::new(vec![[0.0, 0.0], [0.1, 1.0], [0.7, -0.3], [1.0, 0.2]]).unwrap();
        for i in 0..amplitude.branches() {
            let branch = amplitude.branch(i);
            assert_eq!(branch.factor(branch.from[0]), branch.from[1]);
            assert_eq!(branch.factor(branch.to[0]), branch.to[1]);
            assert_eq!(branch.time(branch.to[1]), branch.to[0]);
            let between = 0.25 * branch.from[0] + 0.75 * branch.to[0];
            let back = branch.time(branch.factor(between));
            assert!((back - between).abs() < 1e-15, "{back} {between}"); // rounding
        }
        assert!(!amplitude.rises());
        assert!((amplitude.steepest() - 10.0).abs() < 1e-14);
    }

    #[test]
    fn without_an_amplitude_factors_are_times_to_the_bit() {
        for time in [0.0, 0.1, 1.0 / 3.0, 1.0, 1.0_f64.next_down()] {
            assert_eq!(Branch::WHOLE.factor(time), time);
            assert_eq!(Branch::WHOLE.time(time), time);
        }
    }

    #[test]
    fn cycles_alternate_at_a_constant_rate() {
        let cycles = Amplitude::cycles(&[1.0, 2.0], 2).unwrap();
        // Paths of 8 mm and 16 mm, 24 mm in all.
        let factors: Vec<f64> = cycles.rows().iter().map(|row| row[1]).collect();
        let half = [0.5, -0.5, 0.0];
        let whole = [1.0, -1.0, 0.0];
        assert_eq!(factors[1..], [half, half, whole, whole].concat()[..]);
        for i in 0..cycles.branches() {
            // 24 mm in the whole time, over the largest amplitude.
            assert!((cycles.branch(i).slope().abs() - 12.0).abs() < 1e-12, "{i}");
        }
    }

    #[test]
    fn invalid_rows_are_rejected_with_their_number() {
        for (rows, row) in [
            (vec![[0.0, 0.0]], 0),
            (vec![[0.1, 0.0], [1.0, 1.0]], 0),
            (vec![[0.0, 1.0], [1.0, 1.0]], 0),
            (vec![[0.0, 0.0], [0.5, 1.0], [0.5, 2.0], [1.0, 0.0]], 2),
            (vec![[0.0, 0.0], [0.9, 1.0]], 1),
            (vec![[0.0, 0.0], [1.0, 0.0]], 1),
        ] {
            assert_eq!(
                Amplitude::new(rows.clone()).unwrap_err().row,
                row,
                "{rows:?}"
            );
        }
        assert!(Amplitude::cycles(&[], 2).is_err());
        assert!(Amplitude::cycles(&[0.0], 2).is_err());
    }
}
