//! Formulas of the tests. Forces are in kN, lengths in mm, stresses in MPa.

use super::line::Line;
use super::run::{EvaluationError, TestRun};
use super::{RunValues, TestValue, flat_jack};
use crate::deck::quantity::Quantity;
use crate::deck::schema::TestKind;

/// Part of the largest force at which moduli are read, by EN 1052-1.
pub(super) const THIRD: f64 = 1.0 / 3.0;

/// Last part of the way over which a residual force is averaged.
pub(super) const LAST: f64 = 0.1;

pub(super) type Values = Result<Vec<TestValue>, EvaluationError>;

/// Results of one run.
pub(super) fn values(run: &TestRun) -> Values {
    match run.test.kind {
        TestKind::Compression => compression(run),
        TestKind::Flexure => flexure(run),
        TestKind::Triplet | TestKind::PushedUnit => triplet(run),
        TestKind::BondWrench => wrench(run),
        TestKind::CoupletTension => tension(run),
        TestKind::DirectShear => direct_shear(run),
        TestKind::Diagonal => diagonal(run),
        TestKind::ShearCompression => shear_compression(run),
        TestKind::OutOfPlane => out_of_plane(run),
        TestKind::TiltingTable => tilting(run),
        TestKind::FlatJack => flat_jack::single(run),
        TestKind::FlatJackDouble => flat_jack::double(run),
    }
}

/// Results of all runs together.
pub(super) fn together(
    runs: &[TestRun],
    values: &[RunValues],
    notes: &mut Vec<String>,
) -> Vec<TestValue> {
    let names = match runs[0].test.kind {
        TestKind::Triplet => ["f_v0", "f_vk0", "tan_alpha", "tan_alpha_k", "tan_phi_r"],
        TestKind::DirectShear => ["c", "", "tan_phi", "", "tan_phi_r"],
        TestKind::PushedUnit => ["f_v0", "", "tan_alpha", "", "tan_phi_r"],
        TestKind::FlatJack => return flat_jack::together(runs, notes),
        _ => return Vec::new(),
    };
    let pairs = |name: &str| -> Vec<(f64, f64)> {
        let of = |values: &RunValues, wanted: &str| {
            let found = values.values.iter().find(|value| value.name == wanted);
            found.map(|value| value.value)
        };
        let pair = |values: &RunValues| Some((of(values, "f_p")?, of(values, name)?));
        values.iter().filter_map(pair).collect()
    };
    let (Some(peak), Some(rest)) = (Line::through(&pairs("f_v")), Line::through(&pairs("f_vr")))
    else {
        notes.push("cohesion and friction need runs with at least two precompressions".to_owned());
        return Vec::new();
    };
    let all = [
        TestValue::new(
            names[0],
            peak.at_zero,
            "MPa",
            "shear strength without precompression: the line through the runs at 0",
        ),
        TestValue::new(
            names[1],
            0.8 * peak.at_zero,
            "MPa",
            "characteristic value by EN 1052-3: 0.8 f_v0",
        ),
        TestValue::new(
            names[2],
            peak.slope,
            "",
            "slope of this line: friction of the bond",
        ),
        TestValue::new(
            names[3],
            0.8 * peak.slope,
            "",
            "characteristic value by EN 1052-3: 0.8 tan_alpha",
        ),
        TestValue::new(
            names[4],
            rest.slope,
            "",
            "residual friction: slope of the line through the residual strengths",
        ),
    ];
    all.into_iter()
        .filter(|value| !value.name.is_empty())
        .collect()
}

/// Stress of a force [kN] on an area [mm²].
fn stress(force: f64, area: f64) -> f64 {
    1e3 * force / area
}

/// Value of a column of the history where the force of the rising branch first reaches `part` of the largest one.
fn at_part(run: &TestRun, column: &[f64], part: f64) -> Result<f64, EvaluationError> {
    let (peak, end) = run.peak()?;
    let rows = &run.history.rows;
    let wanted = part * peak;
    let i = (0..=end)
        .find(|i| rows[*i].force_kN >= wanted)
        .unwrap_or(end);
    let (f, x) = (rows[i].force_kN, column[i]);
    // The first increment starts from rest.
    let (f0, x0) = i
        .checked_sub(1)
        .map_or((0.0, 0.0), |k| (rows[k].force_kN, column[k]));
    Ok(if f > f0 {
        x0 + (x - x0) * (wanted - f0) / (f - f0)
    } else {
        x
    })
}

/// Strain of a gauge where the force reaches a third of the largest one; longer is positive.
fn strain(run: &TestRun, probe: &str) -> Result<f64, EvaluationError> {
    let column = format!("{probe}_mm");
    let Some(length) = run.gauges.get(&column) else {
        let run = run.name.clone();
        return Err(EvaluationError::NoColumn { run, column });
    };
    Ok(at_part(run, &run.column(&column)?, THIRD)? / length)
}

/// Mean force over the last part of the way [kN], and the way driven [mm].
fn residual(run: &TestRun) -> (f64, f64) {
    let curve = run.curve();
    let points = curve.points();
    let Some((last, _)) = points.last() else {
        return (0.0, 0.0);
    };
    let from = last - LAST * (last - curve.start().0);
    let tail: Vec<f64> = points.iter().filter(|p| p.0 >= from).map(|p| p.1).collect();
    (
        tail.iter().sum::<f64>() / tail.len().max(1) as f64,
        last - curve.start().0,
    )
}

/// Area below the curve [J = kN mm], with `less` [kN] taken off the force.
fn work(run: &TestRun, less: f64) -> f64 {
    let curve = run.curve();
    let mut before = curve.start();
    let mut sum = 0.0;
    for &point in curve.points() {
        sum +=
            0.5 * ((before.1 - less).max(0.0) + (point.1 - less).max(0.0)) * (point.0 - before.0);
        before = point;
    }
    sum
}

fn compression(run: &TestRun) -> Values {
    let (peak, area) = (run.peak()?.0, run.area()?);
    let f = stress(peak, area);
    let shortening = -0.5 * (strain(run, "front")? + strain(run, "back")?);
    let modulus = THIRD * f / shortening;
    Ok(vec![
        TestValue::new(
            "f",
            f,
            "MPa",
            "compressive strength, F_max over length times thickness",
        ),
        TestValue::new(
            "f_k",
            f / 1.2,
            "MPa",
            "characteristic strength by EN 1052-1: f / 1.2",
        ),
        TestValue::new(
            "E",
            modulus,
            "MPa",
            "modulus: secant at F_max / 3 over the gauges",
        ),
        TestValue::new(
            "E_over_f_k",
            modulus / (f / 1.2),
            "",
            "E over f_k; EN 1996-1-1 recommends 1000",
        ),
    ])
}

fn flexure(run: &TestRun) -> Values {
    let (_, row) = run.peak()?;
    let force = run.column("first_kN")?[row] + run.column("second_kN")?[row];
    let width = run.size("length", run.test.length)?;
    let thickness = run.size("thickness", run.test.thickness)?;
    let Some([outer, inner]) = run.test.spans.map(|spans| spans.map(Quantity::get)) else {
        let run = run.name.clone();
        return Err(EvaluationError::NoSize { run, key: "spans" });
    };
    let f = 1e3 * 3.0 * force * (outer - inner) / (2.0 * width * thickness * thickness);
    Ok(vec![
        TestValue::new("F_max", force, "kN", "largest force on both inner bearings"),
        TestValue::new(
            "f_x",
            f,
            "MPa",
            "flexural strength, 3 F_max (l_1 - l_2) / (2 b t^2)",
        ),
    ])
}

fn triplet(run: &TestRun) -> Values {
    let area = 2.0 * run.area()?;
    Ok(vec![
        TestValue::new(
            "f_p",
            run.size("pressure", run.test.pressure)?,
            "MPa",
            "precompression",
        ),
        TestValue::new(
            "f_v",
            stress(run.peak()?.0, area),
            "MPa",
            "shear strength, F_max / (2 A)",
        ),
        TestValue::new(
            "f_vr",
            stress(residual(run).0, area),
            "MPa",
            "residual shear strength: mean over the last tenth of the way",
        ),
    ])
}

fn direct_shear(run: &TestRun) -> Values {
    let area = run.area()?;
    let (rest, way) = residual(run);
    let uplift = run.column("uplift_mm")?.last().copied().unwrap_or_default();
    Ok(vec![
        TestValue::new(
            "f_p",
            run.size("pressure", run.test.pressure)?,
            "MPa",
            "constant pressure",
        ),
        TestValue::new(
            "f_v",
            stress(run.peak()?.0, area),
            "MPa",
            "shear strength, F_max / A",
        ),
        TestValue::new(
            "f_vr",
            stress(rest, area),
            "MPa",
            "residual shear strength: mean over the last tenth of the way",
        ),
        TestValue::new(
            "G_II",
            1e3 * work(run, rest) / area,
            "N/mm",
            "fracture energy in shear: area of the curve above the residual force, over A",
        ),
        TestValue::new(
            "uplift_over_slip",
            uplift / way,
            "",
            "rise of the upper unit over its way at the end",
        ),
    ])
}

fn tension(run: &TestRun) -> Values {
    let area = run.area()?;
    Ok(vec![
        TestValue::new(
            "f_t",
            stress(run.peak()?.0, area),
            "MPa",
            "tensile strength, F_max / A",
        ),
        TestValue::new(
            "G_I",
            1e3 * work(run, 0.0) / area,
            "N/mm",
            "fracture energy in tension: area of the curve over A",
        ),
    ])
}

fn wrench(run: &TestRun) -> Values {
    let force = 1e3 * run.peak()?.0;
    let width = run.size("length", run.test.length)?;
    let depth = run.size("thickness", run.test.thickness)?;
    let lever = run.size("lever", run.test.lever)?;
    let modulus = width * depth * depth / 6.0;
    let f = (force * lever - 2.0 / 3.0 * depth * force) / modulus;
    Ok(vec![
        TestValue::new("F_max", 1e-3 * force, "kN", "largest force on the lever"),
        TestValue::new(
            "f_w",
            f,
            "MPa",
            "bond strength, (F e - 2/3 d F) / (b d^2 / 6), without weights",
        ),
    ])
}

fn diagonal(run: &TestRun) -> Values {
    let force = run.peak()?.0;
    let length = run.size("length", run.test.length)?;
    let height = run.size("height", run.test.height)?;
    let thickness = run.size("thickness", run.test.thickness)?;
    let per_area = stress(force, 0.5 * (length + height) * thickness);
    let distortion = strain(run, "horizontal")? - strain(run, "vertical")?;
    let at_third = THIRD * std::f64::consts::FRAC_1_SQRT_2 * per_area;
    Ok(vec![
        TestValue::new("P_max", force, "kN", "largest force"),
        TestValue::new(
            "S_s",
            std::f64::consts::FRAC_1_SQRT_2 * per_area,
            "MPa",
            "shear strength by ASTM E519: 0.707 P / A_n, A_n = (w + h) t / 2",
        ),
        TestValue::new(
            "tau_rilem",
            1.05 * per_area,
            "MPa",
            "shear stress at the centre of an elastic square (Frocht), the reading of RILEM LUM B6: 1.05 P / A_n",
        ),
        TestValue::new(
            "f_t_rilem",
            0.5 * per_area,
            "MPa",
            "principal tension at the centre of an elastic square (Frocht), the reading of RILEM LUM B6: 0.5 P / A_n",
        ),
        TestValue::new(
            "G",
            at_third / distortion,
            "MPa",
            "shear modulus: secant at P_max / 3, S_s over the distortion of the gauges",
        ),
    ])
}

fn shear_compression(run: &TestRun) -> Values {
    let (force, row) = run.peak()?;
    let area = run.area()?;
    let height = run.size("height", run.test.height)?;
    let curve = run.curve();
    let way = (run.history.rows[row].displacement_mm - curve.start().0).abs();
    let mut all = vec![
        TestValue::new(
            "f_p",
            run.size("pressure", run.test.pressure)?,
            "MPa",
            "precompression",
        ),
        TestValue::new("V_max", force.abs(), "kN", "largest shear force"),
        TestValue::new(
            "tau",
            stress(force.abs(), area),
            "MPa",
            "shear stress, V_max over length times thickness",
        ),
        TestValue::new(
            "drift_at_V_max",
            100.0 * way / height,
            "%",
            "displacement at V_max over the height",
        ),
    ];
    if let Some(stiffness) = curve.secant_stiffness(0.7) {
        all.push(TestValue::new(
            "k",
            stiffness,
            "kN/mm",
            "secant stiffness at 0.7 V_max",
        ));
    }
    if let Some(at_80) = curve.displacement_at_80_percent() {
        let way = (at_80 - curve.start().0).abs();
        all.push(TestValue::new(
            "drift_at_0.8_V_max",
            100.0 * way / height,
            "%",
            "the same where the force has fallen to 0.8 V_max",
        ));
    }
    Ok(all)
}

fn out_of_plane(run: &TestRun) -> Values {
    let (force, row) = run.peak()?;
    let area = run.size("length", run.test.length)? * run.size("height", run.test.height)?;
    Ok(vec![
        TestValue::new(
            "p_max",
            1e3 * stress(force, area),
            "kPa",
            "largest pressure of the airbag, force over length times height",
        ),
        TestValue::new(
            "w_at_p_max",
            run.history.rows[row].displacement_mm,
            "mm",
            "deflection of the middle there",
        ),
    ])
}

fn tilting(run: &TestRun) -> Values {
    let angle = run.size("angle", run.test.angle)?;
    let last = run.history.rows.last().map_or(0.0, |row| row.load_factor);
    let (of_angle, of_factor) = if run.has_fallen() {
        (
            "inclination of the last equilibrium",
            "tangent of this angle: horizontal over vertical force",
        )
    } else {
        (
            "inclination at the end of the run: the wall has not fallen",
            "tangent of this angle, which the wall bears: no load factor of collapse",
        )
    };
    let angle = angle * run.collapsed_at.unwrap_or(last);
    Ok(vec![
        TestValue::new("angle", angle, "deg", of_angle),
        TestValue::new("load_factor", angle.to_radians().tan(), "", of_factor),
    ])
}
