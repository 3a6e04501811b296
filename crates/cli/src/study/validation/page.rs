//! The pages of the validation, as Markdown.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::case::{Case, Content};
use super::outcome::{Outcome, Validated};
use crate::study::cell::Verdict;
use crate::study::expect::{Expectation, Measure, Measured, Wanted, percent};
use crate::study::report::escaped;

impl Validated {
    /// Expectations of a run in this form.
    fn of_form(&self, outcome: &Outcome) -> impl Iterator<Item = &Expectation> {
        let run = self.case.runs.iter().find(|r| r.name == outcome.name);
        let expect = run.map_or(&[][..], |r| &r.expect);
        expect.iter().filter(|e| e.holds_of(self.short))
    }

    /// Number of expectations of a run that state a requirement.
    fn claims(&self, outcome: &Outcome) -> usize {
        let claims = self.of_form(outcome);
        claims.filter(|e| e.wanted != Wanted::Reported).count()
    }

    /// Expectations of a run with their measured values.
    fn expected<'a>(
        &'a self,
        outcome: &'a Outcome,
    ) -> impl Iterator<Item = (&'a Expectation, &'a Measured)> {
        self.of_form(outcome).zip(&outcome.measured)
    }

    /// Measured value of an expectation, by the names of the run and the expectation.
    pub(super) fn measured(&self, run: &str, expect: &str) -> Option<&Measured> {
        let mut all = self.expected(self.outcome(run)?);
        all.find(|(e, _)| e.name == expect).map(|(_, m)| m)
    }
}

/// The page of a case; its pictures, tables and decks lie beside it.
pub fn page(validated: &Validated) -> String {
    let case = &validated.case;
    let mut page = format!("# {}\n\n{}\n\n", case.name(), case.what.trim());
    for outcome in validated.outcomes.iter().filter(|o| o.scene.is_some()) {
        let name = &outcome.name;
        let _ = writeln!(page, "![The scene of {name}]({name}_scene.svg)\n");
    }
    let _ = write!(page, "## Reference data\n\n{}\n\n", case.data.trim());
    let _ = write!(page, "## Results\n\n");
    for chart in &case.charts {
        let what = match &chart.content {
            Content::Curves(_) => "curves",
            Content::Measures { .. } => "measures",
        };
        let (title, name) = (&chart.title, &chart.name);
        let _ = writeln!(
            page,
            "![{title}: {what} of the runs and reference data]({name}.svg)\n"
        );
    }
    measures(&mut page, validated);
    cost(&mut page, validated);
    for outcome in validated.outcomes.iter().filter(|o| o.cracks.is_some()) {
        let name = &outcome.name;
        let _ = writeln!(
            page,
            "\n![Cracks and failed joints of {name}]({name}_cracks.svg)"
        );
    }
    let _ = write!(
        page,
        "\n## Agreement\n\n{}\n\n## Differences\n\n{}\n\n",
        case.agrees.trim(),
        case.differs.trim()
    );
    let _ = writeln!(
        page,
        "`wythe study validation --only {}` repeats this case. Decks and curves lie beside this page under the names of \
         the runs.",
        case.number
    );
    page
}

/// Appends the measured values of all runs.
fn measures(page: &mut String, validated: &Validated) {
    page.push_str("| Run | | Measured | Known | Difference | |\n|---|---|---|---|---|---|\n");
    for outcome in &validated.outcomes {
        let about = about(&validated.case, outcome);
        let first = format!("{}{about}", outcome.name);
        let mut rows = 0;
        for (expect, measured) in validated.expected(outcome) {
            let name = if rows == 0 { first.as_str() } else { "" };
            rows += 1;
            let why = match expect.why.trim() {
                "" => String::new(),
                why => format!(" ({why})"),
            };
            let holds = match (expect.wanted, measured.holds) {
                (Wanted::Reported, true) => "reported",
                (_, true) => "holds",
                (_, false) => "**does not hold**",
            };
            let value = match (&expect.measure, expect.wanted) {
                // Difference from a curve, relative to the largest ordinate.
                (Measure::Curve { .. }, Wanted::Reported) => {
                    format!("{} off", percent(measured.value).trim_start_matches('+'))
                }
                (Measure::Curve { .. }, _) => String::new(),
                _ => digits(measured.value),
            };
            let _ = writeln!(
                page,
                "| {} | {}{} | {value} | {} | {} | {holds} |",
                escaped(name),
                escaped(&expect.name),
                escaped(&why),
                wanted(expect.wanted),
                measured.error.map_or_else(String::new, percent),
            );
        }
        if !outcome.holds() || rows == 0 {
            let name = if rows == 0 { first.as_str() } else { "" };
            let _ = writeln!(
                page,
                "| {} | {} | | | | |",
                escaped(name),
                escaped(&ended(outcome))
            );
        }
    }
}

fn cost(page: &mut String, validated: &Validated) {
    page.push_str(
        "\n| Run | increments | solves | cuts | CPU s | energies |\n|---|---|---|---|---|---|\n",
    );
    for outcome in &validated.outcomes {
        let cost = &outcome.cost;
        let _ = writeln!(
            page,
            "| {} | {} | {} | {} | {:.2} | {:.0e} |",
            outcome.name,
            cost.increments,
            cost.iterations,
            cost.cutbacks,
            cost.seconds,
            outcome.energy
        );
    }
}

/// The page that lists the cases, whose pages lie in `folder`. Rows of cases that were not run are copied from the
/// page `before`.
pub fn index(all: &[Validated], folder: &str, before: &str) -> String {
    let mut page = String::from(
        "# Validation\n\n\
         Results of wythe beside experiments, exact solutions and other models. Nothing is fitted to them; where a\n\
         value had to be chosen, its page says so. Each page has the scene, the data with their source and\n\
         reliability, curves, cracks, agreement and differences; decks and curves lie beside it.\n\n\
         `wythe study validation` repeats all cases, with `--only` one of them; the tests run the short forms\n\
         (`tests/validation/cases.rs`). CPU times are those of one thread on a machine with other load.\n\n\
         | Case | runs | claims that hold | largest difference | CPU s |\n|---|---|---|---|---|\n",
    );
    let kept = before
        .lines()
        .filter_map(|line| Some((numbered(line)?, line.to_owned())));
    let mut rows: BTreeMap<u32, String> = kept.collect();
    for validated in all {
        let case = &validated.case;
        let (mut claims, mut held, mut worst) = (0, 0, None::<f64>);
        for outcome in &validated.outcomes {
            // A run that failed has no measured values: none of its requirements holds.
            claims += validated.claims(outcome);
            for (expect, measured) in validated.expected(outcome) {
                if expect.wanted == Wanted::Reported {
                    continue;
                }
                held += usize::from(measured.holds);
                if let Some(error) = measured.error {
                    worst = Some(
                        worst.map_or(error, |w| if error.abs() > w.abs() { error } else { w }),
                    );
                }
            }
        }
        let seconds: f64 = validated.outcomes.iter().map(|o| o.cost.seconds).sum();
        let row = format!(
            "| [{}]({folder}/{}/README.md) | {} | {} | {} | {seconds:.0} |",
            escaped(&case.name()),
            case.folder_name(),
            validated.outcomes.len(),
            if claims == 0 {
                format!("only reported{}", failed(validated))
            } else {
                format!("{held} of {claims}{}", failed(validated))
            },
            worst.map_or_else(String::new, percent),
        );
        rows.insert(case.number, row);
    }
    for row in rows.values() {
        let _ = writeln!(page, "{row}");
    }
    page
}

/// Note for a row of the index on runs that end otherwise than required or have an expectation that does not hold.
fn failed(validated: &Validated) -> String {
    let failed = validated.outcomes.iter().filter(|o| !o.holds());
    let names: Vec<&str> = failed.map(|o| o.name.as_str()).collect();
    if names.is_empty() {
        String::new()
    } else {
        format!("; **does not hold**: {}", escaped(&names.join(", ")))
    }
}

/// Number of the case in a row of the index.
fn numbered(row: &str) -> Option<u32> {
    row.strip_prefix("| [")?.split(' ').next()?.parse().ok()
}

/// Columns of a run that a chart or an expectation of its case reads, as CSV.
pub fn table(case: &Case, outcome: &Outcome) -> String {
    let mut columns = vec!["time".to_owned()];
    let mut take = |name: &str| {
        if !columns.iter().any(|c| c == name) {
            columns.push(name.to_owned());
        }
    };
    for chart in &case.charts {
        for axis in [&chart.x, &chart.y] {
            axis.column.iter().for_each(|c| take(c));
        }
    }
    for expect in case
        .runs
        .iter()
        .filter(|r| r.name == outcome.name)
        .flat_map(|r| &r.expect)
    {
        expect.measure.columns().for_each(&mut take);
    }
    columns.retain(|name| !outcome.history.column(name).is_empty());
    let mut text = columns.join(",");
    text.push('\n');
    for i in outcome.history.rows(None) {
        let fields: Vec<String> = columns
            .iter()
            .map(|name| digits(outcome.history.column(name)[i]))
            .collect();
        text.push_str(&fields.join(","));
        text.push('\n');
    }
    text
}

/// End of a run in words if it differs from the required one.
fn ended(outcome: &Outcome) -> String {
    match &outcome.verdict {
        Verdict::Completed(_) => "ended as it must".to_owned(),
        Verdict::Wrong(reasons) => reasons.join("; "),
        Verdict::Diverged(place, why) => format!("lost convergence in {place}: {why}"),
        Verdict::Stopped(place) => format!("took too long: {place}"),
        Verdict::Inapplicable(why) | Verdict::Broken(why) => why.clone(),
    }
}

fn about(case: &Case, outcome: &Outcome) -> String {
    let run = case.runs.iter().find(|r| r.name == outcome.name);
    match run.map_or("", |r| r.about.as_str()) {
        "" => String::new(),
        about => format!(": {about}"),
    }
}

fn wanted(wanted: Wanted) -> String {
    match wanted {
        Wanted::Relative(value, tolerance) => {
            format!(
                "{} ± {}",
                digits(value),
                percent(tolerance).trim_start_matches('+')
            )
        }
        Wanted::Absolute(value, tolerance) => format!("{} ± {}", digits(value), digits(tolerance)),
        Wanted::Between(f64::NEG_INFINITY, high) => format!("at most {}", digits(high)),
        Wanted::Between(low, f64::INFINITY) => format!("at least {}", digits(low)),
        Wanted::Between(low, high) => format!("{} to {}", digits(low), digits(high)),
        Wanted::Within(tolerance) => {
            format!("within {}", percent(tolerance).trim_start_matches('+'))
        }
        Wanted::Reported => String::new(),
    }
}

/// A number with five significant digits.
fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let places = 4 - value.abs().log10().floor() as i32;
    if (0..=9).contains(&places) {
        let text = format!("{value:.*}", places as usize);
        if text.contains('.') {
            return text.trim_end_matches('0').trim_end_matches('.').to_owned();
        }
        text
    } else {
        format!("{value:.4e}")
    }
}
