"""Values of Python as types of JSON."""

from __future__ import annotations

import numbers
import os
from collections.abc import Mapping, Sequence
from typing import Any

from wythe._errors import ModelError, as_path, expected


#: Deepest nesting of a value; the tables of a deck have six.
DEEPEST = 50


def plain(where: str, value: Any, depth: int = 0) -> Any:
    """Converts values to types of JSON; None in tables is omitted."""
    if depth > DEEPEST:
        raise ValueError(f"{where[:60]}...: nested deeper than {DEEPEST}; does a mapping or list contain itself?")
    if hasattr(value, "tolist") and hasattr(value, "dtype"):
        value = value.tolist()
    if isinstance(value, Mapping):
        table: dict[str, Any] = {}
        for key, item in value.items():
            if not isinstance(key, str):
                raise expected(where, "keys that are str", key)
            if item is not None:
                table[key] = plain(f"{where}.{key}" if where != "deck" else key, item, depth + 1)
        return table
    if isinstance(value, (str, bool)):
        return value
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, numbers.Real):
        number = float(value)
        if number != number or number in (float("inf"), float("-inf")):
            raise ModelError(f"{number} is no finite number", key=where, fix="give a finite number")
        return number
    if isinstance(value, os.PathLike):
        return as_path(where, value)
    if isinstance(value, Sequence) or hasattr(value, "__iter__"):
        return [plain(f"{where}.{i}", item, depth + 1) for i, item in enumerate(value)]
    raise expected(where, "a number, a text, a flag, a sequence or a mapping", value)
