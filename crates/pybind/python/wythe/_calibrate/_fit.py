"""Least squares, and the statistics at its end."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from wythe._calibrate._job import Floats
from wythe._calibrate._noise import Noise, estimated, shapes
from wythe._calibrate._problem import Problem
from wythe._errors import need

# First guess of the deviation of a point, as a part of the peak, while it is estimated.
NOISE = 0.05
# The estimate has settled if it changes by less than this part, after at most so many fits.
SETTLED = 0.02
PASSES = 6
# Eigenvalues of the information below this are those of combinations that nothing determines.
LEAST = 1e-6
# A position so near to 0 or 1 is at its bound, if the slope of the misfit leads beyond it.
AT_BOUND = 0.01


@dataclass(frozen=True)
class Fit:
    """The end of the least squares. Positions are those between the bounds, 0 to 1."""

    positions: Floats
    """Shape (parameters,)."""
    residuals: Floats
    """Of the measured points, over their peaks. Shape (rows,)."""
    jacobian: Floats
    """Derivatives of ``residuals``. Shape (rows, parameters)."""
    priors: Floats
    """Derivatives of the rows of the priors. Shape (priors, parameters)."""
    prior_rows: Floats
    """Residuals of the priors, over their deviations. Shape (priors,)."""
    noise: Noise
    converged: bool
    message: str
    iterations: int

    @property
    def covariance(self) -> Floats:
        """Covariance of the positions, with the priors. Shape (parameters, parameters)."""
        return self._inverse(between=True)

    @property
    def covariance_of_points(self) -> Floats:
        """The same, if whole specimens did not deviate."""
        return self._inverse(between=False)

    @property
    def at_bounds(self) -> tuple[int, ...]:
        """-1 for a parameter that its lower bound stops, 1 for one that its upper bound stops, 0 for others.

        The least squares keep within the bounds and end just inside. The bound stops a position that is near to it
        if a step to the least misfit, of this parameter alone, leads beyond.
        """
        weight = max(self.noise.scale, 1e-12) ** -2
        slopes = weight * (self.jacobian.T @ self.residuals) + self.priors.T @ self.prior_rows
        curvatures = weight * (self.jacobian**2).sum(axis=0) + (self.priors**2).sum(axis=0)
        found: list[int] = []
        for z, slope, curvature in zip(self.positions, slopes, curvatures, strict=True):
            aim = z - slope / curvature if curvature > 0.0 else z
            low, high = z < AT_BOUND and aim < 0.0, z > 1.0 - AT_BOUND and aim > 1.0
            found.append(int(high) - int(low))
        return tuple(found)

    def _inverse(self, between: bool) -> Floats:
        whole = self.noise.information(self.jacobian, between) + self.priors.T @ self.priors
        values, vectors = np.linalg.eigh(0.5 * (whole + whole.T))
        spread: Floats = (vectors / np.maximum(values, LEAST)) @ vectors.T
        return spread


def fitted(problem: Problem, say: Callable[[str], None]) -> Fit:
    """Fits the parameters; with priors again until the estimated noise, which weighs them, has settled."""
    settings = problem.job.settings
    priors = any(parameter.prior is not None for parameter in problem.job.parameters)
    point = NOISE if settings.noise is None else settings.noise
    noise = Noise(point, 1.0, np.inf, 0.0, 0.0, shapes(problem))
    positions, iterations = problem.start, 0
    for number in range(1, PASSES + 1):
        answer = _least_squares(problem, positions, noise, say)
        positions, iterations = answer.x, iterations + int(answer.nfev)
        fit = _judged(problem, answer, iterations)
        settled = abs(fit.noise.scale / noise.scale - 1.0) < SETTLED
        if not priors or number == PASSES or settled:
            return fit
        noise = fit.noise
    raise AssertionError("the last pass returns")


def _least_squares(problem: Problem, start: Floats, noise: Noise, say: Callable[[str], None]) -> Any:
    need("scipy", "study")
    optimize = importlib.import_module("scipy.optimize")
    settings = problem.job.settings

    def rows(positions: Floats) -> Floats:
        found = problem.residuals(positions)
        say(f"misfit {100.0 * float(np.sqrt(np.mean(found**2))):.2f} % of the peak")
        return np.concatenate([found / noise.scale, problem.prior_rows(positions)])

    def slopes(positions: Floats) -> Floats:
        return np.concatenate([problem.jacobian(positions) / noise.scale, problem.prior_jacobian(positions)])

    return optimize.least_squares(
        rows,
        start,
        jac=slopes,
        bounds=(np.zeros(len(start)), np.ones(len(start))),
        method="trf",
        x_scale=1.0,
        ftol=settings.tolerance,
        xtol=settings.tolerance,
        gtol=1e-10,
        max_nfev=settings.iterations,
    )


def _judged(problem: Problem, answer: Any, iterations: int) -> Fit:
    """The end of a fit with the deviation of its points."""
    positions = np.asarray(answer.x, dtype=np.float64)
    residuals, jacobian = problem.residuals(positions), problem.jacobian(positions)
    priors = problem.prior_jacobian(positions)
    used = _used(jacobian, priors, float(residuals @ residuals) / len(residuals))
    return Fit(
        positions=positions,
        residuals=residuals,
        jacobian=jacobian,
        priors=priors,
        prior_rows=problem.prior_rows(positions),
        noise=estimated(problem, residuals, used),
        converged=answer.status > 0,
        message=str(answer.message),
        iterations=iterations,
    )


def _used(jacobian: Floats, priors: Floats, variance: float) -> float:
    """Number of parameters that the points determine: the trace of their part in the information."""
    points = jacobian.T @ jacobian / max(variance, 1e-18)
    whole = points + priors.T @ priors + LEAST * np.eye(len(points))
    return float(np.trace(np.linalg.solve(whole, points)))
