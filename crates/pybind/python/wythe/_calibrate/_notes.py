"""Notes on a fit: values at their bounds, and a large misfit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from wythe._calibrate._fit import Fit
from wythe._calibrate._job import Parameter
from wythe._calibrate._read import names

if TYPE_CHECKING:
    from wythe._calibrate._result import CurveFit

# Root mean square of the differences over the peak above which a fitted curve is none.
LARGE = 0.3


def of_bounds(parameters: tuple[Parameter, ...], fit: Fit) -> list[str]:
    """A sentence for each parameter that its bound stops."""
    said: list[str] = []
    for parameter, side in zip(parameters, fit.at_bounds, strict=True):
        if side:
            which, bound = ("upper", parameter.high) if side > 0 else ("lower", parameter.low)
            value = f"{bound:g} {parameter.unit}".rstrip()
            said.append(
                f"{parameter.name} is at its {which} bound, {value}: the best value lies beyond. "
                "Its error and its interval do not hold; widen this bound."
            )
    return said


def of_misfit(curves: Sequence[CurveFit]) -> list[str]:
    """A sentence if fitted curves are far from the measured ones."""
    far = [curve for curve in curves if curve.rms > LARGE]
    if not far:
        return []
    worst = max(curve.rms for curve in far)
    listed = names(f"{curve.curve} of {curve.test}" for curve in far)
    return [
        f"The misfit is large: the fitted curves differ by up to {100 * worst:.0f} % of the peak from {listed}. "
        "Check the units of the measured curves (displacements in mm, forces in kN) and the deck."
    ]
