//! Flat jacks: the pressure that brings the gauges across a slot back, and the modulus of the masonry between two.
//!
//! The factors of the jack and of its area, K_m and K_a of ASTM C1196, are 1: the pressure acts on the whole slot.

use super::TestValue;
use super::formulas::{THIRD, Values};
use super::run::{EvaluationError, TestRun};
use crate::deck::quantity::Quantity;

/// Gauges along the slot.
const GAUGES: [&str; 3] = ["left_mm", "middle_mm", "right_mm"];
/// Pressure of the jacks in the history.
const JACK: &str = "jack_MPa";

/// Readings of a run with jacks: pressure [MPa] and change of each gauge [mm], from the row before the jack works.
struct Readings {
    pressure: Vec<f64>,
    gauges: [Vec<f64>; 3],
}

impl Readings {
    fn of(run: &TestRun) -> Result<Self, EvaluationError> {
        let pressure = run.column(JACK)?;
        let first = pressure.iter().position(|p| *p > 0.0);
        let from = first.unwrap_or(pressure.len()).saturating_sub(1);
        let mut gauges = [const { Vec::new() }; 3];
        for (gauge, name) in gauges.iter_mut().zip(GAUGES) {
            *gauge = run.column(name)?.split_off(from);
        }
        Ok(Self {
            pressure: pressure[from..].to_vec(),
            gauges,
        })
    }

    /// First pressure at which a gauge is `wanted` long [MPa]; none if the jack was not pumped that far.
    fn pressure_at(&self, gauge: usize, wanted: f64) -> Option<f64> {
        let mut rows = self.pressure.windows(2).zip(self.gauges[gauge].windows(2));
        rows.find_map(|(p, x)| {
            let (before, after) = (x[0] - wanted, x[1] - wanted);
            let crosses = before * after <= 0.0 && before != after;
            crosses.then(|| p[0] + (p[1] - p[0]) * before / (before - after))
        })
    }

    /// Change of a gauge up to a pressure [mm].
    fn change_to(&self, gauge: usize, wanted: f64) -> f64 {
        let column = &self.gauges[gauge];
        let start = column.first().copied().unwrap_or_default();
        let rows = self.pressure.windows(2).zip(column.windows(2));
        for (p, x) in rows {
            if p[1] >= wanted && p[1] > p[0] {
                return x[0] + (x[1] - x[0]) * (wanted - p[0]) / (p[1] - p[0]) - start;
            }
        }
        column.last().copied().unwrap_or_default() - start
    }
}

/// Whether a run has a slot.
fn has_slot(run: &TestRun) -> bool {
    run.history.probes.iter().any(|column| column == JACK)
}

/// Mean of the gauges at a row [mm].
fn mean_at(run: &TestRun, row: impl Fn(&[f64]) -> Option<f64>) -> Result<f64, EvaluationError> {
    let mut sum = 0.0;
    for name in GAUGES {
        sum += row(&run.column(name)?).ok_or_else(|| EvaluationError::NoCurve(run.name.clone()))?;
    }
    Ok(sum / GAUGES.len() as f64)
}

/// Values of one run of the test with one slot.
pub(super) fn single(run: &TestRun) -> Values {
    let applied = run.size("pressure", run.test.pressure)?;
    let of = "mean change of the gauges under the stress of the wall, before the jack works";
    let change = if has_slot(run) {
        let readings = Readings::of(run)?;
        let first = readings.gauges.iter().map(|gauge| gauge.first().copied());
        first.flatten().sum::<f64>() / GAUGES.len() as f64
    } else {
        mean_at(run, |column| column.last().copied())?
    };
    Ok(vec![
        TestValue::new("f_p", applied, "MPa", "stress of the wall"),
        TestValue::new("gauges", change, "mm", of),
    ])
}

/// Values of the walls without and with a slot together.
pub(super) fn together(runs: &[TestRun], notes: &mut Vec<String>) -> Vec<TestValue> {
    let [whole, slot] = [false, true]
        .map(|slot| -> Vec<&TestRun> { runs.iter().filter(|run| has_slot(run) == slot).collect() });
    let ([whole], [slot]) = (&whole[..], &slot[..]) else {
        notes.push(
            "the cancellation pressure needs two runs, of the wall without and with the slot, at one stress".to_owned(),
        );
        return Vec::new();
    };
    let pressure = |run: &TestRun| run.test.pressure.map(Quantity::get);
    if pressure(whole) != pressure(slot) {
        notes.push("the walls without and with the slot have different stresses".to_owned());
        return Vec::new();
    }
    let Some(found) = returning(whole, slot, notes) else {
        return Vec::new();
    };
    let mean = found.iter().sum::<f64>() / found.len() as f64;
    let mut values = vec![
        TestValue::new(
            "f_m",
            mean,
            "MPa",
            "stress by the jack: mean pressure at which the gauges are as long as before the cut, K_m K_a = 1",
        ),
        TestValue::new(
            "f_m_left",
            found[0],
            "MPa",
            "the same of the gauge on the left",
        ),
        TestValue::new(
            "f_m_middle",
            found[1],
            "MPa",
            "the same of the gauge in the middle",
        ),
        TestValue::new(
            "f_m_right",
            found[2],
            "MPa",
            "the same of the gauge on the right",
        ),
    ];
    if let Some(applied) = pressure(whole).filter(|applied| *applied > 0.0) {
        values.push(TestValue::new(
            "f_m_over_f_p",
            mean / applied,
            "",
            "stress by the jack over that of the wall",
        ));
    }
    values
}

/// Pressure at which each gauge is as long in the wall with the slot as in the whole one [MPa]; none if one is not.
fn returning(whole: &TestRun, slot: &TestRun, notes: &mut Vec<String>) -> Option<Vec<f64>> {
    let readings = Readings::of(slot).ok()?;
    let mut found = Vec::new();
    for (gauge, name) in GAUGES.iter().enumerate() {
        let target = whole.column(name).ok()?.last().copied()?;
        let Some(at) = readings.pressure_at(gauge, target) else {
            notes.push(format!(
                "the jack does not bring the gauge {name} back: pump it further"
            ));
            return None;
        };
        found.push(at);
    }
    Some(found)
}

/// Values of one run of the test with two slots.
pub(super) fn double(run: &TestRun) -> Values {
    let readings = Readings::of(run)?;
    let largest = readings.pressure.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Err(EvaluationError::NoCurve(run.name.clone()));
    }
    let third = THIRD * largest;
    let mut strains = [0.0; 3];
    for (gauge, name) in GAUGES.iter().enumerate() {
        let Some(length) = run.gauges.get(*name) else {
            return Err(EvaluationError::NoColumn {
                run: run.name.clone(),
                column: (*name).to_owned(),
            });
        };
        strains[gauge] = -readings.change_to(gauge, third) / length;
    }
    let mean = strains.iter().sum::<f64>() / strains.len() as f64;
    Ok(vec![
        TestValue::new(
            "f_p",
            run.size("pressure", run.test.pressure)?,
            "MPa",
            "stress of the wall",
        ),
        TestValue::new("p_max", largest, "MPa", "largest pressure of the jacks"),
        TestValue::new(
            "E",
            third / mean,
            "MPa",
            "modulus: secant at p_max / 3, pressure over the mean strain of the gauges, K_m K_a = 1",
        ),
        TestValue::new(
            "E_middle",
            third / strains[1],
            "MPa",
            "the same of the gauge in the middle alone",
        ),
    ])
}
