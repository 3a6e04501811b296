"""Random samples for scatter and sensitivities."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from wythe._errors import expected
from wythe._study._quantity import quantity
from wythe._study._samples import plain, whole

# Number of random pairings of the columns, of which the least correlated is used.
PAIRINGS = 20


@runtime_checkable
class Distribution(Protocol):
    """An object with quantiles: a distribution of wythe or a frozen distribution of scipy.stats."""

    def ppf(self, q: Any, /) -> Any:
        """The quantile: the value that is not exceeded with probability ``q``."""
        ...


@dataclass(frozen=True)
class Normal:
    """Normal distribution with a mean and a standard deviation."""

    mean: float
    deviation: float

    def ppf(self, q: Any, /) -> NDArray[np.float64]:
        """Quantiles."""
        return np.asarray(self.mean + self.deviation * _standard_normal(q))


@dataclass(frozen=True)
class Lognormal:
    """Lognormal distribution with a mean and a coefficient of variation."""

    mean: float
    cv: float

    def ppf(self, q: Any, /) -> NDArray[np.float64]:
        """Quantiles: the logarithm is normal with σ² = ln(1 + cv²), μ = ln(mean) − σ²/2."""
        variance = math.log1p(self.cv**2)
        return np.exp(
            math.log(self.mean) - variance / 2.0 + math.sqrt(variance) * _standard_normal(q)
        )


def normal(mean: float, cv: float) -> Normal:
    """Normal distribution with this mean and coefficient of variation (deviation / \\|mean\\|)."""
    mean, cv = _number("mean", mean), _positive("cv", cv)
    if mean == 0.0:
        raise ValueError("mean: expected a number other than 0, of which cv is a part")
    return Normal(mean, cv * abs(mean))


def lognormal(mean: float, cv: float) -> Lognormal:
    """Lognormal distribution with this mean and coefficient of variation, for positive quantities such as strengths."""
    return Lognormal(_positive("mean", mean), _positive("cv", cv))


def latin_hypercube(
    ranges: Mapping[str, object], count: int, seed: int
) -> dict[str, NDArray[Any]]:
    """Latin hypercube samples, as columns for ``study(model, samples=...)``.

    Each range is divided into ``count`` strips of equal probability with one sample each. The least correlated of
    several random pairings is used. A range is a pair of bounds of a uniform distribution (``(0.16, 0.24)`` or
    ``("0.16 MPa", "0.24 MPa")``), or an object with ``.ppf``: ``lognormal(mean, cv)``, ``normal(mean, cv)`` or a
    distribution of scipy.stats. The same seed gives the same samples.
    """
    if not isinstance(ranges, Mapping) or not ranges:
        what = 'a mapping of deck keys to ranges, such as {"interfaces.joint.f_t": (0.16, 0.24)}'
        raise expected("ranges", what, ranges)
    count, seed = whole("count", count, 1), whole("seed", seed, 0)
    for key in ranges:
        if not isinstance(key, str) or not key:
            raise expected("ranges", 'keys such as "interfaces.joint.f_t"', key)
    random = np.random.default_rng(seed)
    strips = _pairing(random, len(ranges), count)
    # [key][sample], strictly within (0, 1) because ppf may be infinite at the ends.
    within = np.clip((strips + random.random(strips.shape)) / count, 1e-12, 1.0 - 1e-12)
    return {key: _stretch(key, of, q) for (key, of), q in zip(ranges.items(), within, strict=True)}


def _pairing(random: np.random.Generator, keys: int, count: int) -> NDArray[np.int64]:
    """Index of the strip of each sample in each range: [key][sample]."""
    best: NDArray[np.int64] | None = None
    least = math.inf
    for _ in range(PAIRINGS):
        strips = np.array([random.permutation(count) for _ in range(keys)])
        if keys == 1 or count < 3:
            return strips
        largest = float(np.max(np.abs(np.corrcoef(strips) - np.eye(keys))))
        if best is None or largest < least:
            best, least = strips, largest
    assert best is not None
    return best


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


def _standard_normal(q: Any) -> NDArray[np.float64]:
    quantile = NormalDist().inv_cdf
    parts = np.asarray(q, dtype=np.float64)
    return np.array([quantile(float(part)) for part in parts.ravel()]).reshape(parts.shape)


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
