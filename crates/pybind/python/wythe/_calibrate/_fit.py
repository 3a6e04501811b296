"""Least squares, and the statistics at its end."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from wythe._calibrate._job import Floats
from wythe._calibrate._problem import Problem
from wythe._errors import need

# First guess of the deviation of a point, as a part of the peak, while it is estimated.
NOISE = 0.05
# The estimate has settled if it changes by less than this part, after at most so many fits.
SETTLED = 0.02
PASSES = 6
# Eigenvalues of the information below this are those of combinations that nothing determines.
LEAST = 1e-6
# Largest correlation of neighbouring points that is believed: 39 points then count as one.
MOST_CORRELATED = 0.95


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
    noise: float
    """Deviation of an independent point, as a part of the peak, for weight 1."""
    repeats: float
    """How many neighbouring points deviate together, as much as one independent point."""
    freedom: float
    """Degrees of freedom of the estimate of the noise; infinite if it was given."""
    converged: bool
    message: str
    iterations: int

    @property
    def scale(self) -> float:
        """Deviation by which residuals are divided: points that deviate together count less."""
        return self.noise * float(np.sqrt(self.repeats))

    @property
    def covariance(self) -> Floats:
        """Covariance of the positions, with the priors. Shape (parameters, parameters)."""
        rows = np.concatenate([self.jacobian / self.scale, self.priors])
        values, vectors = np.linalg.eigh(rows.T @ rows)
        spread: Floats = (vectors / np.maximum(values, LEAST)) @ vectors.T
        return spread


def fitted(problem: Problem, say: Callable[[str], None]) -> Fit:
    """Fits the parameters; with priors again until the estimated noise, which weighs them, has settled."""
    settings = problem.job.settings
    priors = any(parameter.prior is not None for parameter in problem.job.parameters)
    noise = NOISE if settings.noise is None else settings.noise
    positions, scale, iterations = problem.start, noise, 0
    for number in range(1, PASSES + 1):
        answer = _least_squares(problem, positions, scale, say)
        positions, iterations = answer.x, iterations + int(answer.nfev)
        fit = _judged(problem, answer, iterations)
        if not priors or number == PASSES or abs(fit.scale / scale - 1.0) < SETTLED:
            return fit
        scale = fit.scale
    raise AssertionError("the last pass returns")


def _least_squares(problem: Problem, start: Floats, scale: float, say: Callable[[str], None]) -> Any:
    need("scipy", "study")
    optimize = importlib.import_module("scipy.optimize")
    settings = problem.job.settings

    def rows(positions: Floats) -> Floats:
        found = problem.residuals(positions)
        say(f"misfit {100.0 * float(np.sqrt(np.mean(found**2))):.2f} % of the peak")
        return np.concatenate([found / scale, problem.prior_rows(positions)])

    def slopes(positions: Floats) -> Floats:
        return np.concatenate([problem.jacobian(positions) / scale, problem.prior_jacobian(positions)])

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
    given = problem.job.settings.noise
    # A given deviation is that of independent points.
    repeats = 1.0 if given is not None else _repeats(problem, residuals)
    if given is not None:
        noise, freedom = given, np.inf
    else:
        sum_of_squares = float(residuals @ residuals)
        used = _used(jacobian, priors, sum_of_squares / len(residuals))
        noise = max(np.sqrt(sum_of_squares / max(len(residuals) - used, 1.0)), 1e-9)
        freedom = max(len(residuals) / repeats - used, 1.0)
    return Fit(
        positions=positions,
        residuals=residuals,
        jacobian=jacobian,
        priors=priors,
        noise=float(noise),
        repeats=repeats,
        freedom=float(freedom),
        converged=answer.status > 0,
        message=str(answer.message),
        iterations=iterations,
    )


def _used(jacobian: Floats, priors: Floats, variance: float) -> float:
    """Number of parameters that the points determine: the trace of their part in the information."""
    points = jacobian.T @ jacobian / max(variance, 1e-18)
    whole = points + priors.T @ priors + LEAST * np.eye(len(points))
    return float(np.trace(np.linalg.solve(whole, points)))


def _repeats(problem: Problem, residuals: Floats) -> float:
    """How many points deviate together, from the correlation rho of neighbours: (1 + rho)/(1 - rho).

    That is the factor of the variance of a mean of an autoregressive sequence. It is 1 if the correlation may be
    chance (below two of its standard deviations, 1/sqrt(points)).
    """
    products, squares, pairs, at = 0.0, 0.0, 0, 0
    for of in problem.windows:
        for curve in of.curves:
            part = residuals[at : at + len(curve.force)]
            products += float(part[1:] @ part[:-1])
            squares += float(part @ part)
            pairs += len(part) - 1
            at += len(part) + (of.test.peak > 0.0)
    rho = products / squares if squares > 0.0 else 0.0
    if rho < 2.0 / np.sqrt(max(pairs, 1)):
        return 1.0
    rho = min(rho, MOST_CORRELATED)
    return (1.0 + rho) / (1.0 - rho)
