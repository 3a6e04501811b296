"""The parts of a calibration: parameters, tests and settings, as read and checked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Prior:
    """Knowledge about a parameter before the tests."""

    kind: Literal["normal", "lognormal"]
    mean: float
    cv: float

    @property
    def deviation(self) -> float:
        """Standard deviation of the value, or of its logarithm if lognormal."""
        if self.kind == "normal":
            return self.cv * abs(self.mean)
        return math.sqrt(math.log1p(self.cv**2))

    @property
    def centre(self) -> float:
        """Median of the value, or of its logarithm if lognormal."""
        if self.kind == "normal":
            return self.mean
        return math.log(self.mean) - 0.5 * self.deviation**2

    def row(self, value: float) -> float:
        """Residual of a value: its distance from the median in standard deviations."""
        at = value if self.kind == "normal" else math.log(value)
        return (at - self.centre) / self.deviation

    def slope(self, value: float) -> float:
        """Derivative of :meth:`row` with respect to the value."""
        return (1.0 if self.kind == "normal" else 1.0 / value) / self.deviation

    def log_density(self, value: Floats) -> Floats:
        """Logarithm of the density of the value, without its constant. Shape of ``value``."""
        if self.kind == "normal":
            return -0.5 * ((value - self.centre) / self.deviation) ** 2
        logarithm = np.log(value)
        return -0.5 * ((logarithm - self.centre) / self.deviation) ** 2 - logarithm


@dataclass(frozen=True)
class Key:
    """A deck key that a parameter sets, times a factor."""

    key: str
    factor: float
    tests: tuple[str, ...] | None
    """Names of the tests whose decks have the key; None for all."""


@dataclass(frozen=True)
class Parameter:
    """An unknown.

    The fit works with the position between the bounds, 0 to 1, of the value or of its logarithm.
    """

    name: str
    keys: tuple[Key, ...]
    start: float
    low: float
    high: float
    prior: Prior | None
    log: bool
    unit: str

    @property
    def _ends(self) -> tuple[float, float]:
        return (math.log(self.low), math.log(self.high)) if self.log else (self.low, self.high)

    def position(self, value: float) -> float:
        """Position of a value between the bounds."""
        low, high = self._ends
        return ((math.log(value) if self.log else value) - low) / (high - low)

    def value(self, position: float) -> float:
        """The value at a position, within the bounds in spite of rounding."""
        low, high = self._ends
        at = low + position * (high - low)
        return min(max(math.exp(at) if self.log else at, self.low), self.high)

    def values(self, positions: Floats) -> Floats:
        """The values at positions. Shape of ``positions``."""
        low, high = self._ends
        at = low + positions * (high - low)
        return np.clip(np.exp(at) if self.log else at, self.low, self.high)

    def rate(self, value: float) -> float:
        """Derivative of the value with respect to the position."""
        low, high = self._ends
        return (high - low) * (value if self.log else 1.0)

    def spread(self, value: float) -> float:
        """Standard deviation of the position without tests: of the prior, else of a uniform one."""
        uniform = 1.0 / math.sqrt(12.0)
        if self.prior is None:
            return uniform
        return min(1.0 / abs(self.prior.slope(value) * self.rate(value)), uniform)

    def deck_value(self, value: float, factor: float) -> float | str:
        """The value of a key."""
        number = float(value) * factor
        return f"{number!r} {self.unit}" if self.unit else number


@dataclass(frozen=True)
class Curve:
    """A measured curve."""

    name: str
    displacement: Floats
    """Displacement, or what the test has for ``x``. Shape (points,)."""
    force: Floats
    """Force [kN], or what the test has for ``y``. Shape (points,)."""

    @property
    def peak(self) -> float:
        """Largest force."""
        return float(np.max(self.force))


@dataclass(frozen=True)
class Column:
    """A column of ``history.csv``, its sign turned if so written (``-top_mm``)."""

    name: str
    sign: float


@dataclass(frozen=True)
class CurveTest:
    """A test: its deck and the curves of its specimens."""

    name: str
    model: Any
    """The :class:`wythe.Model` of the deck."""
    curves: tuple[Curve, ...]
    x: Column
    y: Column
    steps: tuple[int, ...] | None
    factor: float
    weight: float
    peak: float
    low: float
    high: float


@dataclass(frozen=True)
class Settings:
    """Settings of the fit."""

    iterations: int = 30
    tolerance: float = 1e-4
    step: float = 0.01
    central: bool = True
    noise: float | None = None


@dataclass(frozen=True)
class Sampling:
    """Settings of the posterior."""

    kind: Literal["linearised", "model"]
    walkers: int
    steps: int
    burn: int
    draws: int
    seed: int


@dataclass(frozen=True)
class Job:
    """A calibration as a whole."""

    title: str
    parameters: tuple[Parameter, ...]
    tests: tuple[CurveTest, ...]
    settings: Settings
    sampling: Sampling | None
    out: str | None
    file: str | None

    def changes(self, test: CurveTest, values: Mapping[str, float]) -> dict[str, float | str]:
        """Deck keys of a test with the values of the parameters."""
        return {
            key.key: parameter.deck_value(values[parameter.name], key.factor)
            for parameter in self.parameters
            for key in parameter.keys
            if key.tests is None or test.name in key.tests
        }
