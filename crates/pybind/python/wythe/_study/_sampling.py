"""Random samples for scatter and sensitivities."""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from wythe._errors import expected, need
from wythe._study._quantity import quantity
from wythe._study._samples import plain, whole


@runtime_checkable
class Distribution(Protocol):
    """An object with quantiles: a distribution of wythe or a frozen distribution of scipy.stats."""

    def ppf(self, q: Any, /) -> Any:
        """The quantile: the value that is not exceeded with probability ``q``."""
        ...


def normal(mean: float, cv: float) -> Distribution:
    """Normal distribution with this mean and coefficient of variation (deviation / \\|mean\\|).

    It is a frozen ``scipy.stats.norm``; needs SciPy (``pip install 'wythe[study]'``).
    """
    mean, cv = _number("mean", mean), _positive("cv", cv)
    if mean == 0.0:
        raise ValueError("mean: expected a number other than 0, of which cv is a part")
    frozen: Distribution = _scipy("stats").norm(mean, cv * abs(mean))
    return frozen


def lognormal(mean: float, cv: float) -> Distribution:
    """Lognormal distribution with this mean and coefficient of variation, for positive quantities such as strengths.

    It is a frozen ``scipy.stats.lognorm``; needs SciPy (``pip install 'wythe[study]'``).
    """
    mean, cv = _positive("mean", mean), _positive("cv", cv)
    # The logarithm is normal with sigma^2 = ln(1 + cv^2) and the mean ln(mean) - sigma^2/2.
    deviation = math.sqrt(math.log1p(cv**2))
    frozen: Distribution = _scipy("stats").lognorm(deviation, scale=mean / math.hypot(1.0, cv))
    return frozen


def latin_hypercube(
    ranges: Mapping[str, object], count: int, seed: int
) -> dict[str, NDArray[Any]]:
    """Latin hypercube samples, as columns for ``study(model, samples=...)``.

    Each range is divided into ``count`` strips of equal probability with one sample each. Pairs of samples exchange
    values as long as that makes the samples more even (``scipy.stats.qmc.LatinHypercube`` with the optimization
    ``"random-cd"``). A range is a pair of bounds of a uniform distribution (``(0.16, 0.24)`` or
    ``("0.16 MPa", "0.24 MPa")``), or an object with ``.ppf``: ``lognormal(mean, cv)``, ``normal(mean, cv)`` or a
    distribution of scipy.stats. The same seed gives the same samples in one version of SciPy. Needs SciPy
    (``pip install 'wythe[study]'``).
    """
    if not isinstance(ranges, Mapping) or not ranges:
        what = 'a mapping of deck keys to ranges, such as {"interfaces.joint.f_t": (0.16, 0.24)}'
        raise expected("ranges", what, ranges)
    count, seed = whole("count", count, 1), whole("seed", seed, 0)
    for key in ranges:
        if not isinstance(key, str) or not key:
            raise expected("ranges", 'keys such as "interfaces.joint.f_t"', key)
    sampler = _scipy("stats.qmc").LatinHypercube(len(ranges), optimization="random-cd", rng=seed)
    # Strictly within (0, 1), because ppf may be infinite at the ends.
    within = np.clip(sampler.random(count), 1e-12, 1.0 - 1e-12)
    return {key: _stretch(key, of, q) for (key, of), q in zip(ranges.items(), within.T, strict=True)}


def _stretch(key: str, of: object, q: NDArray[np.float64]) -> NDArray[Any]:
    if isinstance(of, Distribution):
        values = np.asarray(of.ppf(q), dtype=np.float64)
        if values.shape != q.shape or not np.all(np.isfinite(values)):
            raise ValueError(f"ranges: {key}: ppf gives no finite number for each of {q.size} parts")
        return values
    if not isinstance(of, (tuple, list)) or len(of) != 2:
        raise expected(f"ranges: {key}", "(low, high) or a distribution with ppf", of)
    bounds = [quantity(plain(bound)) for bound in of]
    if None in bounds:
        raise ValueError(f"ranges: {key}: expected two numbers or quantities, got {of!r}")
    (low, unit), (high, other) = (bound for bound in bounds if bound is not None)
    if unit != other:
        raise ValueError(f"ranges: {key}: expected both bounds in one unit, got {of!r}")
    if not low < high:
        raise ValueError(f"ranges: {key}: expected low < high, got {of!r}")
    values = low + (high - low) * q
    return values if unit == "" else np.array([f"{float(value)!r} {unit}" for value in values])


def _scipy(module: str) -> Any:
    """A module of SciPy."""
    need("scipy", "study")
    return importlib.import_module(f"scipy.{module}")


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
        raise expected(name, "a number", value)
    if not math.isfinite(float(value)):
        raise ValueError(f"{name}: expected a finite number, got {value}")
    return float(value)


def _positive(name: str, value: object) -> float:
    number = _number(name, value)
    if number <= 0.0:
        raise ValueError(f"{name}: expected a number above 0, got {number}")
    return number
