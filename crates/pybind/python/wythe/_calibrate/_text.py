"""A calibration as text: the short form of a terminal, and the page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wythe._calibrate._result import Calibration

# Longest list of failed runs on a page.
FAILURES = 20


def short(of: Calibration) -> str:
    """The parameters as a table, and what is to be known of them."""
    end = "" if of.converged else ", NOT CONVERGED"
    lines = [f"{of.title}: {len(of.curves)} curves of {len(of.tests)} tests, {of.runs} runs{end}"]
    rows = [("parameter", "value", "± error", "95 % interval", "")]
    for name in of.names:
        low, high = of.intervals[name]
        rows.append((name, f"{of.values[name]:.4g}", _error(of, name), f"{low:.4g} to {high:.4g}", of.units[name]))
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = [row[0].ljust(widths[0]), *(row[at].rjust(widths[at]) for at in range(1, 4))]
        lines.append(f"{'  '.join(cells)} {row[4]}".rstrip())
    lines.append(_noise(of))
    lines += of.unseen
    lines += [f"note: {note}" for note in of.notes]
    if of.failures:
        lines.append(f"{len(of.failures)} runs failed or ended early; .failures lists them.")
    return "\n".join(lines)


def page(of: Calibration, pictured: bool) -> str:
    """The page calibration.md."""
    parts = [f"# {of.title}", _opening(of)]
    if pictured:
        parts.append("![Measured points and fitted curves](curves.png)")
    parts += ["## Parameters", _parameters(of)]
    stopped = [f"A bound stops {name}: its interval does not hold." for name in of.at_bounds]
    others = " other" if stopped else ""
    told = of.unseen or ([f"The tests see every{others} parameter."] if len(stopped) < len(of.names) else [])
    seen = "\n".join(f"* {line}" for line in (*stopped, *told))
    singular = ", ".join(f"{value:.3g}" for value in of.singular_values)
    parts += [
        "## What the tests see",
        seen,
        "Singular values of the Jacobian over the noise, its columns times the deviations of priors or bounds: "
        f"{singular}. Below 1 the tests say less about a combination than its prior or bounds.",
    ]
    if len(of.names) > 1:
        parts += ["## Correlation", _correlation(of)]
    if of.posterior is not None:
        parts += ["## Posterior", _posterior(of)]
    parts += ["## Curves", _curves(of)]
    if of.failures:
        parts += ["## Runs that failed or ended early", _failures(of)]
    if of.notes:
        parts += ["## Notes", "\n".join(f"* {note}" for note in of.notes)]
    return "\n\n".join(parts) + "\n"


def _opening(of: Calibration) -> str:
    end = "The fit converged" if of.converged else "The fit did NOT converge"
    return (
        f"{end} after {of.iterations} sets of values and {of.runs} runs ({of.message.rstrip('.')}). {_noise(of)} "
        "`materials.toml` has the values for the next deck, `calibration.json` all numbers."
    )


def _noise(of: Calibration) -> str:
    told = f"Deviation of a point: {100 * of.noise:.2g} % of the peak."
    if of.repeats > 1.0:
        told += f" Neighbours deviate together: {of.repeats:.1f} points count as one."
    if of.between > 0.0:
        told += f" Deviation of whole specimens: {100 * of.between:.2g} %."
    return told


def _error(of: Calibration, name: str) -> str:
    error = of.standard_errors[name]
    return f"{error:.2g}" if math.isfinite(error) else "beyond bounds"


def _parameters(of: Calibration) -> str:
    rows = []
    said = of.summary["parameters"]
    for name in of.names:
        one = said[name]
        low, high = one["interval_95"]
        prior = one["prior"]
        told = "–" if prior is None else f"{prior['kind']}, mean {prior['mean']:g}, cv {prior['cv']:g}"
        keys = ", ".join(f"`{key['key']}`" for key in one["keys"])
        bounds = f"{one['bounds'][0]:g} to {one['bounds'][1]:g}"
        value = f"{one['value']:.4g}"
        interval = f"{low:.4g} to {high:.4g}"
        start = f"{one['start']:g}"
        rows.append([name, one["unit"] or "–", value, _error(of, name), interval, start, bounds, told, keys])
    head = ["", "unit", "value", "standard error", "95 % interval", "start", "bounds", "prior", "keys"]
    return _table(head, rows)


def _correlation(of: Calibration) -> str:
    rows = [[name, *(f"{value:+.2f}" for value in row)] for name, row in zip(of.names, of.correlation, strict=True)]
    return _table(["", *of.names], rows)


def _posterior(of: Calibration) -> str:
    found = of.posterior
    assert found is not None
    how = "Each sample is a run."
    if found.kind == "linearised":
        how = "Curves are linear in the parameters around the best values."
    if math.isfinite(found.linearisation_error):
        how += (
            f" In {len(found.draws)} draws the curves of the model differ from linear ones by "
            f"{found.linearisation_error:.2g} of the noise."
        )
    low, high, middle = found.quantile(0.025), found.quantile(0.975), found.quantile(0.5)
    mean, deviation = found.mean(), found.deviation()
    rows = [
        [n, f"{mean[n]:.4g}", f"{deviation[n]:.2g}", f"{middle[n]:.4g}", f"{low[n]:.4g} to {high[n]:.4g}"]
        for n in found.names
    ]
    told = f"{len(found.samples)} samples by emcee, about {found.independent:.0f} independent. {how}"
    return f"{told}\n\n{_table(['', 'mean', 'deviation', 'median', '95 %'], rows)}"


def _curves(of: Calibration) -> str:
    rows = [
        [c.test, c.curve, str(len(c.force)), f"{c.peak:.4g}", f"{c.fitted_peak:.4g}", f"{c.fitted_peak / c.peak:.3f}",
         f"{100 * c.rms:.2g} %", c.status]
        for c in of.curves
    ]  # fmt: skip
    return _table(["test", "curve", "points", "peak", "fitted peak", "ratio", "rms over peak", "run"], rows)


def _failures(of: Calibration) -> str:
    rows = [
        [f.test, ", ".join(f"{name} = {value:.4g}" for name, value in f.values.items()), f.status, f.message]
        for f in of.failures[:FAILURES]
    ]
    more = len(of.failures) - FAILURES
    return _table(["test", "values", "status", "reason"], rows) + (f"\n\n… {more} more" if more > 0 else "")


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    def line(cells: Sequence[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    return "\n".join([line(head), "|" + "---|" * len(head), *map(line, rows)])
