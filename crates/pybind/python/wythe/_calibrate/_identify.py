"""What the tests see: singular values of the scaled Jacobian, and sentences about them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wythe._calibrate._fit import Fit
from wythe._calibrate._job import Floats, Parameter
from wythe._calibrate._read import names

# Part of the width without tests that an interval keeps: above, the tests do not see the parameter, or hardly.
UNSEEN = 0.9
HARDLY = 0.5
# Part of a direction in which a parameter is named.
NAMED = 0.3
# Correlation from which a pair is named.
PAIRED = 0.95


@dataclass(frozen=True)
class Sight:
    """What the tests see."""

    singular_values: Floats
    """Of the Jacobian over the noise, its columns times the deviations without tests; falling. Shape (parameters,)."""
    kept: Floats
    """Width of each interval as a part of that without tests. Shape (parameters,)."""
    sentences: tuple[str, ...]


def seen(parameters: tuple[Parameter, ...], fit: Fit, correlation: Floats) -> Sight:
    """Judges what the tests see of each parameter, and which combinations they do not see."""
    values = [p.value(float(z)) for p, z in zip(parameters, fit.positions, strict=True)]
    spread = np.array([p.spread(value) for p, value in zip(parameters, values, strict=True)])
    scaled = fit.noise.information(fit.jacobian) * np.outer(spread, spread)
    # Without tests the covariance is the unit matrix; the tests add their information.
    squares, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    # Rounding leaves squares of some 1e-16 of the largest one where there is nothing.
    squares = np.where(squares > 1e-12 * max(float(squares[-1]), 1.0), squares, 0.0)
    singular, directions = np.sqrt(squares[::-1]), vectors.T[::-1]
    left = np.sqrt(((directions.T**2) / (1.0 + singular**2)).sum(axis=1))
    # What stops a value at its bound is the bound: its interval says nothing about the tests.
    stopped = {p.name for p, side in zip(parameters, fit.at_bounds, strict=True) if side}
    sentences = _of_parameters(parameters, left, stopped)
    blind = {p.name for p, part in zip(parameters, left, strict=True) if part > UNSEEN}
    sentences += _of_directions(parameters, singular, directions, blind | stopped)
    told = " ".join(sentences)
    sentences += _of_pairs(parameters, correlation, told, stopped)
    return Sight(singular, left, tuple(sentences))


def _of_parameters(parameters: tuple[Parameter, ...], left: Floats, stopped: set[str]) -> list[str]:
    said: list[str] = []
    for parameter, part in zip(parameters, left, strict=True):
        if parameter.name in stopped:
            continue
        what = "bounds" if parameter.prior is None else "prior"
        if part > UNSEEN:
            said.append(f"The tests do not see {parameter.name}: its interval is as wide as its {what}.")
        elif part > HARDLY:
            share = f"{100 * part:.0f} % of the width of its {what}"
            said.append(f"The tests hardly see {parameter.name}: its interval has {share}.")
    return said


def _of_directions(
    parameters: tuple[Parameter, ...], singular: Floats, directions: Floats, without: set[str]
) -> list[str]:
    """Combinations that the tests do not see, although they see each part of them."""
    said: list[str] = []
    for value, direction in zip(singular, directions, strict=True):
        if value >= 1.0:
            continue
        parts = [
            (p.name, float(part))
            for p, part in zip(parameters, direction, strict=True)
            if abs(part) > NAMED and p.name not in without
        ]
        if len(parts) > 1:
            sign = np.sign(parts[0][1])
            up = names(name for name, part in parts if part * sign > 0.0)
            down = [name for name, part in parts if part * sign < 0.0]
            how = f"more of {up} with less of {names(down)}" if down else f"more of {up} together"
            listed = names(name for name, _ in parts)
            said.append(f"The tests do not tell {listed} apart: {how} leaves the curves as they are.")
    return said


def _of_pairs(
    parameters: tuple[Parameter, ...], correlation: Floats, told: str, stopped: set[str]
) -> list[str]:
    said: list[str] = []
    for at, first in enumerate(parameters):
        for other, second in enumerate(parameters[:at]):
            value = float(correlation[at, other])
            pair = f"{second.name} and {first.name}"
            if stopped & {first.name, second.name}:
                continue
            if abs(value) >= PAIRED and pair not in told:
                said.append(f"The tests know {pair} better together than each: their correlation is {value:+.2f}.")
    return said
