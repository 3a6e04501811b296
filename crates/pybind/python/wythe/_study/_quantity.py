"""Parses quantities such as ``0.2`` and ``"0.2 MPa"``."""

from __future__ import annotations

import math
import re

_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")


def quantity(value: object) -> tuple[float, str] | None:
    """A value as a number and its unit (``""`` without one), or None if it is not a number."""
    if isinstance(value, (bool, int, float)):
        return (float(value), "") if math.isfinite(value) else None
    if isinstance(value, str) and (found := _QUANTITY.fullmatch(value)):
        return float(found[1]), found[2]
    return None
