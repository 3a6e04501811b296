"""Where a straight path leaves the elastic domain: shared by all laws."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

#: Most pieces of a row; more are an endless loop.
PIECES = 200
#: Samples of f along a straight path: the elastic domain need not be convex.
SAMPLES = 65
#: Rounding of f [MPa].
ROUNDING = 1e-12
#: Most halvings of an interval in search of a point inside.
HALVINGS = 30


def leaves(f: Callable[[float], float], start: float) -> float:
    """First time from `start` to 1 at which f, negative inside the domain, becomes positive; 1 if there is none.

    The path may start on the boundary, outside by the drift of the integrator, and go inwards: then halving finds a
    point inside. A path along the boundary, or outwards, leaves where f exceeds that drift by more than rounding.
    """
    outside = max(f(start), 0.0) + ROUNDING
    low = start
    for high in np.linspace(start, 1.0, SAMPLES)[1:]:
        if f(high) <= outside:
            low = high
            continue
        inside, beyond = low, high
        for _ in range(HALVINGS):
            if f(inside) < -ROUNDING:
                return _root(f, inside, beyond)
            middle = low + 0.5 * (beyond - low)
            inside, beyond = (middle, beyond) if f(middle) < -ROUNDING else (inside, middle)
        return _root(lambda t: f(t) - outside, low, high)
    return 1.0


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    # To the last digit, because an error here stays in f for the rest of the path.
    return float(brentq(f, low, high, xtol=1e-16, rtol=1e-15))
