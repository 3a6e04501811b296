"""``wythe.calibrate``: parameters of decks from measured curves."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from wythe._calibrate._curves import response
from wythe._calibrate._fit import Fit, fitted
from wythe._calibrate._identify import seen
from wythe._calibrate._job import Job
from wythe._calibrate._notes import of_bounds, of_misfit
from wythe._calibrate._posterior import Posterior, sampled
from wythe._calibrate._problem import Problem
from wythe._calibrate._read import job_of, job_of_file
from wythe._calibrate._result import Calibration, CurveFit, Findings, correlation_of
from wythe._calibrate._runs import Runs, workers
from wythe._errors import as_path, expected, need, say
from wythe._study._pool import leave_import
from wythe._study._progress import InPlace, terminal
from wythe._study._samples import whole


def calibrate(
    job: str | os.PathLike[str] | None = None,
    *,
    tests: Sequence[Mapping[str, Any]] | None = None,
    parameters: Mapping[str, Mapping[str, Any]] | None = None,
    fit: Mapping[str, Any] | None = None,
    posterior: str | Mapping[str, Any] | None = None,
    title: str | None = None,
    executor: Any = None,
    out: str | os.PathLike[str] | None = None,
    progress: bool = True,
) -> Calibration:
    """Finds values of deck keys by least squares, so that decks of tests give the measured curves.

    Residuals are the forces of the runs less those measured, at the measured displacements, over the measured peak
    of the test (the mean of its specimens), and rows of the priors. scipy.optimize.least_squares (``trf``) minimises their squares within the
    bounds; derivatives are differences whose runs are side by side. Needs SciPy, and emcee for a posterior
    (``pip install 'wythe[study]'``). The same call gives the same result with any executor.

    Parameters
    ----------
    job
        A job file (docs/reference/calibration.md lists its keys), instead of ``tests`` and ``parameters``.
    tests
        The tests, each a mapping with the keys of ``[[tests]]``: ``name``, ``deck`` (a path or a
        :class:`wythe.Model`), ``curves`` (paths or arrays of shape (points, 2)), ``x``, ``y``, ``weight``, ….
    parameters
        The unknowns by name, each a mapping with the keys of ``[parameters.NAME]``: ``key`` or ``keys``, ``start``,
        ``bounds``, ``prior``, ``scale``.
    fit
        Settings with the keys of ``[fit]``.
    posterior
        ``"linearised"``, ``"model"``, or a mapping with the keys of ``[posterior]``, to sample the posterior by
        emcee; ``"none"`` leaves out that of the job.
    title
        Title of the result.
    executor
        Where the runs are, as in :func:`wythe.study`; worker processes stay up for the whole calibration.
    out
        Folder of the result, as :meth:`Calibration.save` writes it, and of the journals of all runs: the same call
        continues a calibration that was stopped.
    progress
        Whether to show the progress on stderr.

    Raises
    ------
    TypeError, ValueError
        An argument is invalid.
    CalibrationError
        The job is invalid, or a deck does not run with the start values; it names file, key and fix.
    StudyError
        The executor failed. Finished runs are kept in ``out``.
    OutputError
        The folder cannot be written.
    KeyboardInterrupt
        Ctrl-C: :class:`wythe.StudyInterrupted`; with ``out`` the same call continues.
    """
    if not isinstance(progress, bool):
        raise expected("progress", "True or False", progress)
    if isinstance(executor, (int, np.integer)):
        whole("executor", executor, 1)
    need("scipy", "study")
    read = _read(job, tests, parameters, {"fit": fit, "posterior": posterior, "title": title})
    if read.sampling is not None:
        need("emcee", "study")
    leave_import()
    where = read.out if out is None else as_path("out", out)
    shown = _Progress(progress)
    try:
        with workers(executor) as place:
            folder = None if where is None else Path(where) / "runs"
            problem = Problem(read, Runs(read, place, folder, shown.count))
            found = fitted(problem, shown.say)
            sampling = read.sampling
            drawn = None if sampling is None else sampled(problem, found, sampling, shown.say)
            result = _result(problem, found, drawn)
    finally:
        shown.close()
    if where is not None:
        result.save(where)
    return result


def _read(job: Any, tests: Any, parameters: Any, more: dict[str, Any]) -> Job:
    """The job of the arguments."""
    if (job is None) == (tests is None and parameters is None):
        given = "neither" if job is None else "both"
        raise TypeError(f"calibrate: expected either a job file or tests and parameters, got {given}")
    if job is None:
        return job_of({"tests": tests, "parameters": parameters, **more})
    for name in ("fit", "title"):
        if more[name] is not None:
            raise TypeError(f"{name}: it belongs to tests and parameters; write it in the job file")
    return job_of_file(as_path("job", job), more["posterior"])


def _result(problem: Problem, fit: Fit, posterior: Posterior | None) -> Calibration:
    correlation = correlation_of(fit)
    curves = _curves(problem, fit)
    findings = Findings(
        curves=curves,
        failures=tuple(problem.failures.values()),
        notes=(*of_bounds(problem.job.parameters, fit), *of_misfit(curves), *problem.notes, *problem.blind),
        runs=problem.runs.done,
        posterior=posterior,
        bands=_bands(problem, posterior),
    )
    sight = seen(problem.job.parameters, fit, correlation)
    return Calibration(problem.job, fit, sight, correlation, findings)


def _curves(problem: Problem, fit: Fit) -> tuple[CurveFit, ...]:
    (runs,) = problem.runs.at([problem.values(fit.positions)])
    found: list[CurveFit] = []
    for of, run in zip(problem.windows, runs, strict=True):
        curve = response(of.test, run)
        for measured in of.curves:
            nothing = np.zeros_like(measured.force)
            forces = nothing if curve is None else curve.at(measured.displacement)
            found.append(
                CurveFit(
                    test=of.test.name,
                    curve=measured.name,
                    displacement=measured.displacement,
                    force=measured.force,
                    fitted=forces,
                    x=np.zeros(0) if curve is None else curve.x,
                    y=np.zeros(0) if curve is None else curve.y,
                    status=run.status,
                    peak=measured.peak,
                    fitted_peak=0.0 if curve is None else of.peak(curve, measured),
                    rms=float(np.sqrt(np.mean((forces - measured.force) ** 2)) / measured.peak),
                )
            )
    return tuple(found)


def _bands(problem: Problem, posterior: Posterior | None) -> dict[str, list[Any]]:
    """Curves of the draws, whose runs are there already."""
    if posterior is None:
        return {}
    points = [
        np.array([p.position(float(value)) for p, value in zip(problem.job.parameters, row, strict=True)])
        for row in posterior.draws
    ]
    found = problem.responses(points)
    return {
        test.name: [curves[at] for curves in found if curves[at] is not None]
        for at, test in enumerate(problem.job.tests)
    }


class _Progress:
    """A line on stderr: renewed on a terminal, one for each set of values elsewhere."""

    def __init__(self, wanted: bool) -> None:
        self._wanted = wanted
        self._runs = 0
        self._last = ""
        stream = sys.stderr
        on_terminal = stream is not None and stream.isatty()
        self._line: InPlace | None = terminal(stream) if on_terminal else None
        self._tell: Callable[[str], None] = lambda text: say(sys.stderr, f"{text}\n")

    def count(self, runs: int) -> None:
        """Counts a finished run."""
        self._runs += 1
        if self._wanted and self._line is not None:
            self._line.show(self._text(), runs, False)

    def say(self, text: str) -> None:
        """Tells the state of the fit."""
        self._last = text
        if not self._wanted:
            return
        if self._line is None:
            self._tell(self._text())
        else:
            self._line.show(self._text(), self._runs, False)

    def close(self) -> None:
        """Ends the line."""
        if self._wanted and self._line is not None:
            self._line.show(self._text(), self._runs, True)

    def _text(self) -> str:
        return f"calibrate: {self._runs} runs{', ' if self._last else ''}{self._last}"
