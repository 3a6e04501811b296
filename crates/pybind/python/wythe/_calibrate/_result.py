"""The result of a calibration."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from wythe._calibrate._curves import Response
from wythe._calibrate._fit import Fit
from wythe._calibrate._identify import Sight
from wythe._calibrate._job import Floats, Job
from wythe._calibrate._materials import all_changes, materials_toml
from wythe._calibrate._noise import Noise
from wythe._calibrate._posterior import Posterior
from wythe._calibrate._runs import FailedRun
from wythe._calibrate._text import page, short
from wythe._errors import as_path, unwritten, write_text
from wythe._model import Model

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class CurveFit:
    """A measured curve beside the one of the fitted deck.

    Attributes
    ----------
    test, curve : str
        Name of the test, and of the curve.
    displacement, force : array
        The measured points that count. Shape (points,).
    fitted : array
        Forces of the fitted deck at these points. Shape (points,).
    x, y : array
        The whole curve of the fitted deck. Shape (rows,).
    status : str
        Status of the run of the fitted deck.
    peak, fitted_peak : float
        Largest measured force, and largest force of the fitted deck over the same displacements.
    rms : float
        Root mean square of the differences over the measured peak.
    """

    test: str
    curve: str
    displacement: Floats
    force: Floats
    fitted: Floats
    x: Floats
    y: Floats
    status: str
    peak: float
    fitted_peak: float
    rms: float


class Calibration:
    """Parameters found from measured curves, and what is known of them. Made by :func:`wythe.calibrate`."""

    def __init__(self, job: Job, fit: Fit, sight: Sight, correlation: Floats, found: Findings) -> None:
        self._job = job
        self._fit = fit
        self._found = found
        self.title: str = job.title
        """Title of the job."""
        self.names: tuple[str, ...] = tuple(parameter.name for parameter in job.parameters)
        """Names of the parameters."""
        self.units: dict[str, str] = {p.name: p.unit for p in job.parameters}
        """Unit of each parameter; empty for base units (N, mm, MPa)."""
        values = [p.value(float(z)) for p, z in zip(job.parameters, fit.positions, strict=True)]
        self.values: dict[str, float] = dict(zip(self.names, values, strict=True))
        """Best values."""
        self.correlation: npt.NDArray[np.float64] = correlation
        """Correlation of the parameters, with the priors. Shape (parameters, parameters)."""
        self.singular_values: npt.NDArray[np.float64] = sight.singular_values
        """Singular values of the scaled Jacobian, falling; below 1 the tests say less than bounds or prior. Shape
        (parameters,)."""
        self.unseen: tuple[str, ...] = sight.sentences
        """Sentences about parameters and combinations that the tests do not see; empty if they see all."""
        sides = {-1: "lower", 1: "upper"}
        self.at_bounds: dict[str, str] = {
            name: sides[side] for name, side in zip(self.names, fit.at_bounds, strict=True) if side
        }
        """The bound, ``"lower"`` or ``"upper"``, of each parameter that its bound stops; its interval does not hold."""
        self.curves: tuple[CurveFit, ...] = found.curves
        """The measured curves beside those of the fitted decks."""
        self.failures: tuple[FailedRun, ...] = found.failures
        """Runs that failed, or ended before the last measured point."""
        self.notes: tuple[str, ...] = found.notes
        """Further facts: values at their bounds, a large misfit, points that do not count, derivatives that no run
        gave."""
        self.noise: float = fit.noise.point
        """Standard deviation of a point, as a part of the peak of its curve [-]."""
        self.repeats: float = fit.noise.repeats
        """How many neighbouring points deviate together, so that they count as one [-]."""
        self.between: float = fit.noise.between
        """Standard deviation of the strength of whole specimens, as a part of it [-]; 0 if no test has several."""
        self.converged: bool = fit.converged
        """Whether the least squares ended by a tolerance, not by the number of iterations."""
        self.message: str = fit.message
        """Reason for the end of the least squares."""
        self.runs: int = found.runs
        """Number of runs."""
        self.iterations: int = fit.iterations
        """Number of sets of values that were tried."""
        self.posterior: Posterior | None = found.posterior
        """Samples of the posterior, if they were asked for."""
        self._errors, self._intervals, self._freedom = _intervals(job, fit)

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard error of each parameter, with the priors; infinite if it is larger than the range of the bounds."""
        return dict(self._errors)

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Interval of 95 % of each parameter, within the bounds."""
        return dict(self._intervals)

    @property
    def tests(self) -> tuple[str, ...]:
        """Names of the tests."""
        return tuple(test.name for test in self._job.tests)

    def model(self, test: str) -> Model:
        """The deck of a test with the best values."""
        for known in self._job.tests:
            if known.name == test:
                fitted: Model = known.model.with_(self._job.changes(known, self.values))
                return fitted
        raise KeyError(f"there is no test named {test!r}; the tests are {', '.join(self.tests)}")

    def changes(self, values: Mapping[str, float] | None = None) -> dict[str, float | str]:
        """Deck keys with the best values, or with others, for :meth:`wythe.Model.with_` of another deck.

        Keys of some tests only are included; of a key that several parameters set, the first counts.
        """
        return all_changes(self._job, self.values if values is None else values)

    def samples(self, count: int, seed: int = 1) -> list[dict[str, float | str]]:
        """Deck keys with values drawn from the posterior, for ``wythe.study(model, samples=...)``."""
        if self.posterior is None:
            raise ValueError('samples: there is no posterior; calibrate(..., posterior="linearised")')
        drawn = self.posterior.samples
        if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= len(drawn):
            raise ValueError(f"count: expected a whole number from 1 to {len(drawn)}, got {count!r}")
        picked = np.random.default_rng(seed).choice(len(drawn), count, replace=False)
        return [self.changes(dict(zip(self.names, drawn[at].tolist(), strict=True))) for at in picked]

    @property
    def materials(self) -> str:
        """The tables of materials and interfaces with the found values, as TOML for the next deck."""
        return materials_toml(self._job, self.values, self._intervals)

    @property
    def summary(self) -> dict[str, Any]:
        """Content of ``calibration.json``; numbers that are not finite are None."""
        parameters = {
            p.name: {
                "value": self.values[p.name],
                "unit": p.unit,
                "standard_error": _finite(self._errors[p.name]),
                "interval_95": list(self._intervals[p.name]),
                "start": p.start,
                "bounds": [p.low, p.high],
                "scale": "log" if p.log else "linear",
                "prior": None if p.prior is None else
                {"kind": p.prior.kind, "mean": p.prior.mean, "cv": p.prior.cv},
                "keys": [{"key": k.key, "factor": k.factor, "tests": k.tests} for k in p.keys],
            }
            for p in self._job.parameters
        }  # fmt: skip
        return {
            "format": 1,
            "title": self.title,
            "converged": self.converged,
            "message": self.message,
            "parameters": parameters,
            "correlation": self.correlation.tolist(),
            "singular_values": self.singular_values.tolist(),
            "unseen": list(self.unseen),
            "at_bounds": self.at_bounds,
            "noise": self.noise,
            "repeats": self.repeats,
            "between": self.between,
            "freedom": self._freedom,
            "curves": [
                {
                    "test": c.test, "curve": c.curve, "points": len(c.force), "status": c.status,
                    "peak_kN": c.peak, "fitted_peak_kN": c.fitted_peak, "rms": c.rms,
                }
                for c in self.curves
            ],
            "failures": [vars(failure) for failure in self.failures],
            "notes": list(self.notes),
            "runs": self.runs,
            "iterations": self.iterations,
            "posterior": self._posterior_summary(),
        }  # fmt: skip

    def _posterior_summary(self) -> dict[str, Any] | None:
        found = self.posterior
        if found is None:
            return None
        lows, highs = found.quantile(0.025), found.quantile(0.975)
        return {
            "kind": found.kind,
            "samples": len(found.samples),
            "independent": found.independent,
            "acceptance": found.acceptance,
            "linearisation_error": _finite(found.linearisation_error),
            "mean": found.mean(),
            "deviation": found.deviation(),
            "interval_95": {name: [lows[name], highs[name]] for name in found.names},
        }

    def plot(self) -> Figure:
        """Draws the measured points, the fitted curves and, of a posterior, those of its draws; needs matplotlib."""
        from wythe._calibrate._plot import figure

        return figure(self.curves, self._found.bands)

    def save(self, folder: str | os.PathLike[str]) -> list[str]:
        """Writes ``calibration.json``, ``calibration.md``, ``materials.toml``, ``curves.png`` (with matplotlib) and
        ``posterior.csv`` (with a posterior) to a folder, and returns their paths.
        """
        from wythe._calibrate._plot import is_there, png

        name = as_path("folder", folder)
        try:
            os.makedirs(name, exist_ok=True)
        except OSError as error:
            raise unwritten(name, error) from error
        pictured = is_there()
        files = {
            "calibration.json": json.dumps(self.summary, indent=2, ensure_ascii=False) + "\n",
            "calibration.md": page(self, pictured),
            "materials.toml": self.materials,
        }
        if self.posterior is not None:
            rows = [",".join(map(repr, row)) for row in self.posterior.samples.tolist()]
            files["posterior.csv"] = "\n".join([",".join(self.names), *rows]) + "\n"
        written = [write_text(os.path.join(name, file), text) for file, text in files.items()]
        if pictured:
            written.append(png(self.plot(), os.path.join(name, "curves.png")))
        return written

    def __repr__(self) -> str:
        return short(self)


@dataclass(frozen=True)
class Findings:
    """Parts of a result beside the fit."""

    curves: tuple[CurveFit, ...]
    failures: tuple[FailedRun, ...]
    notes: tuple[str, ...]
    runs: int
    posterior: Posterior | None
    bands: dict[str, list[Response]]
    """Curves of draws of the posterior by test."""


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None


def _intervals(
    job: Job, fit: Fit
) -> tuple[dict[str, float], dict[str, tuple[float, float]], dict[str, float | None]]:
    """Standard errors, intervals of 95 % on the scale of the parameter, and their degrees of freedom."""
    from scipy import stats

    errors: dict[str, float] = {}
    intervals: dict[str, tuple[float, float]] = {}
    freedoms: dict[str, float | None] = {}
    variances = np.diag(fit.covariance), np.diag(fit.covariance_of_points)
    for p, z, whole, points in zip(job.parameters, fit.positions, *variances, strict=True):
        freedom = _freedom(fit.noise, float(whole), float(points))
        width = float(stats.norm.ppf(0.975) if math.isinf(freedom) else stats.t.ppf(0.975, freedom))
        error = math.sqrt(float(whole))
        rate = p.rate(p.value(float(z)))
        errors[p.name] = error * rate if error < 1.0 else math.inf
        low, high = max(float(z) - width * error, 0.0), min(float(z) + width * error, 1.0)
        intervals[p.name] = (p.value(low), p.value(high))
        freedoms[p.name] = _finite(freedom)
    return errors, intervals, freedoms


def _freedom(noise: Noise, whole: float, points: float) -> float:
    """Degrees of freedom of a variance of points and specimens (Satterthwaite 1946)."""
    specimens = max(whole - points, 0.0)
    uncertain = points**2 / noise.freedom
    if noise.between_freedom > 0.0:
        uncertain += specimens**2 / noise.between_freedom
    return whole**2 / uncertain if uncertain > 0.0 else math.inf


def correlation_of(fit: Fit) -> Floats:
    """Correlation of the parameters. Shape (parameters, parameters)."""
    covariance = fit.covariance
    deviation = np.sqrt(np.diag(covariance))
    matrix: Floats = covariance / np.outer(deviation, deviation)
    return matrix
