"""Residuals and Jacobian of a calibration as functions of positions between the bounds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from wythe._calibrate._curves import Response, Window, response, window
from wythe._calibrate._errors import CalibrationError
from wythe._calibrate._job import Floats, Job
from wythe._calibrate._runs import FailedRun, Run, Runs

# A step of a linear parameter near 0 is a part of its range.
OF_RANGE = 0.05


class Problem:
    """The misfit of a job."""

    def __init__(self, job: Job, runs: Runs) -> None:
        self.job = job
        self.runs = runs
        self.failures: dict[tuple[str, tuple[float, ...]], FailedRun] = {}
        """Runs that failed or ended before the last measured point."""
        self.blind: list[str] = []
        """Derivatives that no run gave."""
        self.start = np.array([p.position(p.start) for p in job.parameters])
        self.windows: tuple[Window, ...] = ()
        self.notes: list[str] = []
        self.windows = tuple(self._window(at) for at in range(len(job.tests)))
        self.rows = sum(of.rows for of in self.windows)
        self._check_count()
        # Again from memory, with the windows that say whether a run ended early.
        self._responses([self.start])

    def _window(self, at: int) -> Window:
        """The points of a test that count, from its run with the start values."""
        test = self.job.tests[at]
        run = self.runs.at([self.values(self.start)])[0][at]
        try:
            start = response(test, run)
            if start is None:
                raise CalibrationError(
                    f"the run with the start values gave no curve: {run.status}: "
                    f"{run.message or 'no row of the history belongs to a drive'}",
                    fix="give start values and a deck that run, and steps = […] with a drive",
                )
            found, notes = window(test, start)
        except CalibrationError as error:
            raise CalibrationError(
                f"test `{test.name}`: {error.message}",
                key=f"tests.{at}{'.' if error.key else ''}{error.key}",
                fix=error.fix,
                file=self.job.file,
            ) from None
        self.notes += notes
        return found

    def _check_count(self) -> None:
        free = len(self.job.parameters)
        priors = sum(parameter.prior is not None for parameter in self.job.parameters)
        if self.rows + priors <= free:
            raise CalibrationError(
                f"{self.rows} measured points for {free} parameters",
                key="parameters",
                fix="fewer parameters, or more points",
                file=self.job.file,
            )

    def values(self, positions: Floats) -> dict[str, float]:
        """Values of the parameters by name. Shape of ``positions``: (parameters,)."""
        return {p.name: p.value(float(z)) for p, z in zip(self.job.parameters, positions, strict=True)}

    def residuals(self, positions: Floats) -> Floats:
        """Residuals of the measured points. Shape (rows,)."""
        return self._rows(self._responses([positions])[0])

    def residuals_at(self, points: list[Floats]) -> Floats:
        """Residuals at several positions, whose runs are side by side. Shape (points, rows)."""
        return np.array([self._rows(found) for found in self._responses(points)])

    def responses(self, points: list[Floats]) -> list[list[Response | None]]:
        """Curves at several positions, a list with one per test for each."""
        return self._responses(points)

    def jacobian(self, positions: Floats) -> Floats:
        """Derivatives of the residuals with respect to the positions, by differences. Shape (rows, parameters).

        A side whose run failed, or ended before the last measured point, is replaced by the other one.
        """
        steps = [self._step(at, positions) for at in range(len(positions))]
        ahead = [_moved(positions, at, step) for at, step in enumerate(steps)]
        behind = [_moved(positions, at, -step) for at, step in enumerate(steps)]
        both = [z for at, z in enumerate(behind) if self.job.settings.central and 0.0 <= z[at] <= 1.0]
        self._responses([positions, *ahead, *both])
        columns = [
            self._column(positions, at, ahead[at], behind[at]) for at in range(len(positions))
        ]
        return np.stack(columns, axis=1)

    def prior_rows(self, positions: Floats) -> Floats:
        """Residuals of the priors. Shape (priors,)."""
        values = self.values(positions)
        return np.array([p.prior.row(values[p.name]) for p in self.job.parameters if p.prior is not None])

    def prior_jacobian(self, positions: Floats) -> Floats:
        """Derivatives of :meth:`prior_rows`. Shape (priors, parameters)."""
        values = self.values(positions)
        rows = []
        for at, p in enumerate(self.job.parameters):
            if p.prior is not None:
                row = np.zeros(len(self.job.parameters))
                row[at] = p.prior.slope(values[p.name]) * p.rate(values[p.name])
                rows.append(row)
        return np.array(rows).reshape(-1, len(self.job.parameters))

    def _step(self, at: int, positions: Floats) -> float:
        """Step of a difference, as a position; backwards if the forward one leaves the bounds."""
        parameter = self.job.parameters[at]
        value = parameter.value(float(positions[at]))
        size = max(abs(value), 0.0 if parameter.log else OF_RANGE * (parameter.high - parameter.low))
        step = self.job.settings.step * size / parameter.rate(value)
        step = min(step, 0.25)
        return step if positions[at] + step <= 1.0 else -step

    def _column(self, positions: Floats, at: int, ahead: Floats, behind: Floats) -> Floats:
        """A column of the Jacobian, test by test, because a run may fail in one of them."""
        parts: list[Floats] = []
        for number, of in enumerate(self.windows):
            found = {
                float(point[at]): self._responses([point])[0][number]
                for point in (positions, ahead)
            }
            ends = [z for z, curve in found.items() if of.covered(curve)]
            inside = 0.0 <= behind[at] <= 1.0
            if inside and (self.job.settings.central or len(ends) < 2):
                back = self._responses([behind])[0][number]
                found[float(behind[at])] = back
                ends += [float(behind[at])] if of.covered(back) else []
            if len(ends) < 2:
                # Both sides ended early: their curves show what moves, unless there is none.
                ends = [z for z, curve in found.items() if curve is not None]
            if len(ends) < 2:
                self._note_blind(at, of.test.name)
                parts.append(np.zeros(of.rows))
                continue
            low, high = min(ends), max(ends)
            parts.append((of.residuals(found[high]) - of.residuals(found[low])) / (high - low))
        return np.concatenate(parts)

    def _note_blind(self, at: int, test: str) -> None:
        said = f"{test}: no run beside the values gave the derivative by {self.job.parameters[at].name}"
        if said not in self.blind:
            self.blind.append(said)

    def _rows(self, found: list[Response | None]) -> Floats:
        return np.concatenate([of.residuals(curve) for of, curve in zip(self.windows, found, strict=True)])

    def _responses(self, points: list[Floats]) -> list[list[Response | None]]:
        values = [self.values(point) for point in points]
        found: list[list[Response | None]] = []
        for at, runs in zip(values, self.runs.at(values), strict=True):
            curves = [response(test, run) for test, run in zip(self.job.tests, runs, strict=True)]
            found.append(curves)
            self._note_failures(at, runs, curves)
        return found

    def _note_failures(
        self, values: Mapping[str, float], runs: list[Run], curves: list[Response | None]
    ) -> None:
        # The first runs come before the windows.
        for of, run, curve in zip(self.windows, runs, curves, strict=False):
            if not of.covered(curve):
                key = (of.test.name, tuple(values.values()))
                failed = FailedRun(of.test.name, dict(values), run.status, run.message)
                self.failures.setdefault(key, failed)


def _moved(positions: Floats, at: int, step: float) -> Floats:
    moved = positions.copy()
    moved[at] += step
    return moved
