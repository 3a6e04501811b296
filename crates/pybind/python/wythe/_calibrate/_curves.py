"""Curves of runs beside measured ones: the residuals of a calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wythe._calibrate._errors import CalibrationError
from wythe._calibrate._job import Curve, CurveTest, Floats
from wythe._calibrate._runs import Run

# Residual of every point of a run that failed: ten times the measured peak, worse than any curve.
BAD = 10.0
# Room for rounding at the last displacement of a run, as a part of it.
ROUNDING = 1e-9


@dataclass(frozen=True)
class Response:
    """The curve of a run, with displacements that do not fall."""

    x: Floats
    """Displacement. Shape (rows,)."""
    y: Floats
    """Force. Shape (rows,)."""
    whole: bool
    """Whether the run reached the end of its steps."""

    def at(self, x: Floats) -> Floats:
        """Forces at displacements, linear between rows. Shape of ``x``.

        Beyond its end a run that lost convergence or collapsed carries nothing; a whole run keeps its last force.
        """
        found: Floats = np.interp(x, self.x, self.y)
        if not self.whole:
            found[x > self.x[-1] * (1.0 + ROUNDING)] = 0.0
        return found


def response(test: CurveTest, run: Run) -> Response | None:
    """The curve of a run of a test; None if it has none."""
    if run.columns is None:
        return None
    for column, key in ((test.x, "x"), (test.y, "y")):
        if column.name not in run.columns:
            raise CalibrationError(
                f"the history of the runs has no column `{column.name}`",
                key=key,
                fix="name a column of history.csv, or a probe of the deck",
            )
    x = test.x.sign * run.columns[test.x.name]
    y = test.factor * test.y.sign * run.columns[test.y.name]
    taken = run.columns["driven"].astype(bool)
    if test.steps is not None:
        taken = np.isin(run.columns["step"], test.steps)
    # A probe may have no number in some rows.
    taken &= np.isfinite(x) & np.isfinite(y)
    if not np.any(taken):
        return None
    first = int(np.argmax(taken))
    # The state in which the drive begins: of the row before it, or at rest.
    before = np.nan_to_num([x[first - 1], y[first - 1]]) if first > 0 else (0.0, 0.0)
    x, y = np.append(before[0], x[taken]), np.append(before[1], y[taken])
    # On the way out only: rows behind the farthest one are left out.
    out = x >= np.maximum.accumulate(x)
    return Response(x[out], y[out], run.whole)


@dataclass(frozen=True)
class Window:
    """The points of a test that count."""

    test: CurveTest
    curves: tuple[Curve, ...]
    """The measured curves, cut to the window."""

    @property
    def rows(self) -> int:
        """Number of residuals."""
        return sum(len(curve.force) + (self.test.peak > 0.0) for curve in self.curves)

    @property
    def end(self) -> float:
        """The largest displacement that counts."""
        return max(float(np.max(curve.displacement)) for curve in self.curves)

    @property
    def size(self) -> float:
        """Force by which residuals are divided: the mean of the peaks of the specimens.

        Each divided by its own peak, weak specimens would count more.
        """
        return float(np.mean([curve.peak for curve in self.curves]))

    def covered(self, found: Response | None) -> bool:
        """Whether a run has an own force at every point."""
        if found is None:
            return False
        return found.whole or bool(found.x[-1] * (1.0 + ROUNDING) >= self.end)

    def residuals(self, found: Response | None) -> Floats:
        """Forces of the run less measured ones, over the peak of the test, times the root of the weight.

        Each curve has its points, then its peak if that counts. Shape (rows,).
        """
        if found is None:
            return np.full(self.rows, BAD * self.test.weight**0.5)
        parts: list[Floats] = []
        for curve in self.curves:
            parts.append((found.at(curve.displacement) - curve.force) / self.size)
            if self.test.peak > 0.0:
                share = (self.peak(found, curve) - curve.peak) / self.size
                parts.append(np.array([np.sqrt(self.test.peak) * share]))
        rows: Floats = self.test.weight**0.5 * np.concatenate(parts)
        return rows

    def peak(self, found: Response, curve: Curve) -> float:
        """Largest force of a run over the displacements of a curve."""
        low, high = float(np.min(curve.displacement)), float(np.max(curve.displacement))
        inside = (found.x >= low) & (found.x <= high)
        ends = found.at(np.array([low, high]))
        return float(max(np.max(found.y[inside], initial=-np.inf), np.max(ends)))


def window(test: CurveTest, start: Response | None) -> tuple[Window, list[str]]:
    """The points that count: those between ``from`` and ``to`` that the drive of the deck reaches.

    Returns the window, and a note for each curve with points beyond the drive.
    """
    reach = np.inf if start is None or not start.whole else start.x[-1] * (1.0 + 1e-6)
    notes: list[str] = []
    curves: list[Curve] = []
    for curve in test.curves:
        inside = (curve.displacement >= test.low) & (curve.displacement <= test.high)
        kept = inside & (curve.displacement <= reach)
        lost = int(np.count_nonzero(inside) - np.count_nonzero(kept))
        if np.count_nonzero(kept) < 3 or np.max(curve.force[kept]) <= 0.0:
            raise CalibrationError(
                f"the deck drives to {reach:.4g}, so that {np.count_nonzero(kept)} points of {curve.name} count",
                key="curves",
                fix="drive the deck farther, or check the unit of the displacements",
            )
        if lost:
            notes.append(
                f"{test.name}: {lost} points of {curve.name} lie beyond the end of the drive at "
                f"{float(start.x[-1] if start is not None else reach):.4g} and do not count"
            )
        curves.append(Curve(curve.name, curve.displacement[kept], curve.force[kept]))
    return Window(test, tuple(curves)), notes
