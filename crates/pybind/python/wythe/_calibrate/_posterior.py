"""The posterior of the parameters, sampled by emcee."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from wythe._calibrate._fit import Fit
from wythe._calibrate._job import Floats, Sampling
from wythe._calibrate._problem import Problem
from wythe._errors import need

# Deviation of the first walkers from the best values, in standard errors.
SPREAD = 0.5


@dataclass(frozen=True)
class Posterior:
    """Samples of the parameters given the tests.

    Attributes
    ----------
    kind : str
        ``"linearised"``: the curves are taken as linear in the parameters around the best values; ``"model"``: each
        sample is a run of all tests.
    names : tuple of str
        Names of the parameters.
    samples : array
        Values of the parameters, without the burn-in. Shape (samples, parameters).
    acceptance : float
        Part of the moves that were accepted; 0.2 to 0.5 is usual.
    independent : float
        Number of independent samples, by the autocorrelation time of the slowest parameter.
    draws : array
        Samples whose tests were run, for the bands of the plot. Shape (draws, parameters).
    linearisation_error : float
        Root mean square over these draws of the curves of the model less the linearised ones, over the noise of a
        point; nan without draws. Above 1 the linearised posterior is a rough one.
    """

    kind: str
    names: tuple[str, ...]
    samples: Floats
    acceptance: float
    independent: float
    draws: Floats
    linearisation_error: float

    def quantile(self, q: float) -> dict[str, float]:
        """A quantile of each parameter by name."""
        found = np.quantile(self.samples, q, axis=0)
        return {name: float(value) for name, value in zip(self.names, found, strict=True)}

    def mean(self) -> dict[str, float]:
        """Mean of each parameter by name."""
        found = np.mean(self.samples, axis=0)
        return {name: float(value) for name, value in zip(self.names, found, strict=True)}

    def deviation(self) -> dict[str, float]:
        """Standard deviation of each parameter by name."""
        found = np.std(self.samples, axis=0, ddof=1)
        return {name: float(value) for name, value in zip(self.names, found, strict=True)}

    def __repr__(self) -> str:
        count, names = len(self.samples), ", ".join(self.names)
        about = f"{count} samples, {self.independent:.0f} independent, {100 * self.acceptance:.0f} % accepted"
        return f"<wythe.Posterior of {names}: {self.kind}, {about}>"


def sampled(problem: Problem, fit: Fit, sampling: Sampling, say: Callable[[str], None]) -> Posterior:
    """Samples the posterior; the same samples for the same seed."""
    need("emcee", "study")
    emcee = importlib.import_module("emcee")
    count = len(problem.job.parameters)
    random = np.random.default_rng(sampling.seed)
    sampler = emcee.EnsembleSampler(
        sampling.walkers, count, _density(problem, fit, sampling, say), vectorize=True
    )
    sampler.random_state = np.random.RandomState(sampling.seed).get_state()
    sampler.run_mcmc(_first(fit, sampling.walkers, random), sampling.steps)
    chain = sampler.get_chain(discard=sampling.burn)
    time = np.max(emcee.autocorr.integrated_time(chain, tol=0, quiet=True))
    flat = chain.reshape(-1, count)
    picked = flat[random.choice(len(flat), sampling.draws, replace=False)]
    error = _linearisation_error(problem, fit, picked) if sampling.draws else np.nan
    return Posterior(
        kind=sampling.kind,
        names=tuple(parameter.name for parameter in problem.job.parameters),
        samples=_values(problem, flat),
        acceptance=float(np.mean(sampler.acceptance_fraction)),
        independent=float(len(flat) / max(float(np.nan_to_num(time, nan=len(flat))), 1.0)),
        draws=_values(problem, picked),
        linearisation_error=float(error),
    )


def _values(problem: Problem, positions: Floats) -> Floats:
    columns = [p.values(z) for p, z in zip(problem.job.parameters, positions.T, strict=True)]
    return np.stack(columns, axis=1)


def _first(fit: Fit, walkers: int, random: np.random.Generator) -> Floats:
    """First positions of the walkers, around the best values and within the bounds. Shape (walkers, parameters)."""
    errors = np.clip(np.sqrt(np.diag(fit.covariance)), 1e-6, 0.2)
    at = fit.positions + SPREAD * errors * random.standard_normal((walkers, len(errors)))
    # Reflected at the bounds, so that walkers of a parameter at its bound differ.
    return np.clip(np.where(at < 0.0, -at, np.where(at > 1.0, 2.0 - at, at)), 1e-9, 1.0 - 1e-9)


def _density(
    problem: Problem, fit: Fit, sampling: Sampling, say: Callable[[str], None]
) -> Callable[[Floats], Floats]:
    """Logarithm of the density of positions, without its constant: (points, parameters) -> (points,)."""

    lost = fit.noise.information(fit.jacobian, between=False) - fit.noise.information(fit.jacobian)
    slope = fit.jacobian.T @ fit.residuals / fit.noise.scale**2
    pull = slope - fit.noise.damping(fit.jacobian) @ slope

    def likelihood(points: Floats) -> Floats:
        if sampling.kind == "linearised":
            rows = fit.residuals + (points - fit.positions) @ fit.jacobian.T
        else:
            say(f"posterior: {len(points)} points")
            rows = problem.residuals_at(list(points))
        squares: Floats = np.sum((rows / fit.noise.scale) ** 2, axis=1)
        moved = points - fit.positions
        # Specimens that deviate leave less of the information, near the best values.
        spared: Floats = 0.5 * np.sum((moved @ lost) * moved, axis=1) + moved @ pull
        return spared - 0.5 * squares

    def density(points: Floats) -> Floats:
        inside = np.all((points >= 0.0) & (points <= 1.0), axis=1)
        found = np.full(len(points), -np.inf)
        if np.any(inside):
            found[inside] = likelihood(points[inside]) + _prior(problem, points[inside])
        return found

    return density


def _prior(problem: Problem, points: Floats) -> Floats:
    """Logarithm of the density of the priors, per position. Without a prior positions are uniform."""
    found = np.zeros(len(points))
    for parameter, z in zip(problem.job.parameters, points.T, strict=True):
        if parameter.prior is not None:
            values = parameter.values(z)
            found += parameter.prior.log_density(values)
            # From a density of the value to one of the position.
            found += np.log(values) if parameter.log else 0.0
    return found


def _linearisation_error(problem: Problem, fit: Fit, picked: Floats) -> Any:
    true = problem.residuals_at(list(picked))
    linear = fit.residuals + (picked - fit.positions) @ fit.jacobian.T
    return np.sqrt(np.mean((true - linear) ** 2)) / fit.noise.point
