"""The deviations of measured points: of each point, of neighbours together, and of whole specimens."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from wythe._calibrate._job import Floats
from wythe._calibrate._problem import Problem

# Largest correlation of neighbouring points that is believed: 39 points then count as one.
MOST_CORRELATED = 0.95


@dataclass(frozen=True)
class Noise:
    """Deviations, all as parts of the peaks.

    The covariance of the residuals of a curve is s² 1 + between² f fᵀ with s² = repeats point², and f the fitted
    forces over the measured peak: specimens are stronger or weaker as a whole. The fit does not weigh residuals by it:
    a fixed stiffness of the deck would then decide how strong each specimen is.
    """

    point: float
    """Deviation of a point, for weight 1."""
    repeats: float
    """How many neighbouring points deviate together."""
    freedom: float
    """Degrees of freedom of ``point``; infinite if it was given."""
    between: float
    """Deviation of the strength of whole specimens; 0 if no test has several."""
    between_freedom: float
    """Degrees of freedom of ``between``: the number of curves less that of tests."""
    shapes: tuple[Floats, ...]
    """Fitted forces over the measured peak, times the roots of the weights. Shape (rows of a curve,) each."""

    @property
    def scale(self) -> float:
        """Deviation s by which residuals are divided."""
        return self.point * float(np.sqrt(self.repeats))

    def information(self, jacobian: Floats, between: bool = True) -> Floats:
        """Information of the points about the parameters: the inverse of the covariance of the least squares.

        With H = JᵀJ/s² and G = between² Σ (Jᵀf)(Jᵀf)ᵀ/s⁴ that covariance is H⁻¹ (H + G) H⁻¹. Shape (parameters,
        parameters).
        """
        whole = jacobian.T @ jacobian / self.scale**2
        return self.damping(jacobian) @ whole if between else whole

    def damping(self, jacobian: Floats) -> Floats:
        """H (H + G)⁻¹: the part of the information that deviating specimens leave. Shape (parameters, parameters)."""
        whole = jacobian.T @ jacobian / self.scale**2
        shared = np.zeros_like(whole)
        at = 0
        for shape in self.shapes:
            along = jacobian[at : at + len(shape)].T @ shape * (self.between / self.scale**2)
            shared += np.outer(along, along)
            at += len(shape)
        left: Floats = whole @ np.linalg.pinv(whole + shared, hermitian=True)
        return left


def shapes(problem: Problem) -> tuple[Floats, ...]:
    """Measured forces over the peak, as the rows of each curve have them."""
    found: list[Floats] = []
    for of in problem.windows:
        for curve in of.curves:
            rows = curve.force / of.size
            if of.test.peak > 0.0:
                rows = np.append(rows, of.test.peak**0.5 * curve.peak / of.size)
            found.append(of.test.weight**0.5 * rows)
    return tuple(found)


def estimated(problem: Problem, residuals: Floats, used: float) -> Noise:
    """The deviations that residuals show, with ``used`` parameters determined by them."""
    measured, curves, at = shapes(problem), [], 0
    for shape in measured:
        curves.append(residuals[at : at + len(shape)] + shape)
        at += len(shape)
    between, freedom, left = _between(problem, residuals, measured)
    given = problem.job.settings.noise
    if given is not None:
        # A given deviation is that of independent points.
        return Noise(given, 1.0, np.inf, between(given), freedom, tuple(curves))
    repeats = _repeats(problem, left)
    sum_of_squares = float(left @ left)
    point = max(np.sqrt(sum_of_squares / max(len(left) - used - freedom, 1.0)), 1e-9)
    spare = max(len(left) / repeats - used, 1.0)
    return Noise(
        point=float(point),
        repeats=repeats,
        freedom=float(spare),
        between=between(float(point) * repeats**0.5),
        between_freedom=freedom,
        shapes=tuple(curves),
    )


def _between(problem: Problem, residuals: Floats, curves: tuple[Floats, ...]) -> tuple[Callable[[float], float], float, Floats]:
    """Deviation of whole specimens as a function of the scale, its degrees of freedom, and residuals without it.

    The factor of a specimen is that of the fitted curve that fits it best.
    """
    counts = [len(of.curves) for of in problem.windows]
    freedom = float(sum(counts) - len(counts))
    if freedom == 0.0:
        return (lambda scale: 0.0), 0.0, residuals
    factors, sizes, left, at = [], [], [], 0
    for shape in curves:
        fitted = residuals[at : at + len(shape)] + shape
        size = max(float(fitted @ fitted), 1e-12)
        factors.append(float(fitted @ shape) / size)
        sizes.append(size)
        left.append(factors[-1] * fitted - shape)
        at += len(shape)
    squares, at = 0.0, 0
    for count in counts:
        own = np.array(factors[at : at + count])
        squares += float(np.sum((own - own.mean()) ** 2))
        at += count

    def deviation(scale: float) -> float:
        # A factor scatters because its points do, too.
        chance = scale**2 * float(np.mean([1.0 / size for size in sizes]))
        return float(np.sqrt(max(squares / freedom - chance, 0.0)))

    return deviation, freedom, np.concatenate(left)


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
