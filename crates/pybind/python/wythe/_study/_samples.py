"""Converts the parameters and samples of the user to a list of samples.

``parameters`` (key -> values) is a full factorial grid whose first key varies slowest. ``samples`` are rows
(mappings), columns (a mapping of them) or a pandas DataFrame. Values are those of a deck: numbers, strings with
units, booleans, and lists of them.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeAlias, Union

from wythe._errors import expected

Value: TypeAlias = Union[bool, int, float, str, "list[Value]"]
"""Value of a deck key."""

Sample: TypeAlias = "dict[str, Value]"
"""Keys and values that define one sample of the base model."""

# Largest number of combinations, so that a mistake in a grid does not fill the memory.
MOST = 10_000_000


def expand(parameters: object, samples: object) -> list[Sample]:
    """The samples of a study, from exactly one of the arguments."""
    if (parameters is None) == (samples is None):
        given = "neither" if samples is None else "both"
        raise TypeError(
            "study: expected either parameters (key -> values, all combinations) or samples "
            f"(one row each), got {given}"
        )
    return grid(parameters) if samples is None else rows(samples)


def grid(parameters: object) -> list[Sample]:
    """All combinations of the values; the first key varies slowest."""
    if not isinstance(parameters, Mapping):
        what = 'a mapping of deck keys to sequences, such as {"interfaces.joint.f_t": [0.1, 0.2]}'
        raise expected("parameters", what, parameters)
    if not parameters:
        raise ValueError("parameters: expected at least one key, got an empty mapping")
    columns = {_key("parameters", key): _column("parameters", key, of) for key, of in parameters.items()}
    count = math.prod(len(column) for column in columns.values())
    if count > MOST:
        raise ValueError(f"parameters: these are {count} combinations, expected at most {MOST}")
    return [
        dict(zip(columns, values, strict=True)) for values in itertools.product(*columns.values())
    ]


def rows(samples: object) -> list[Sample]:
    """Rows, columns or a DataFrame as a list of samples."""
    if hasattr(samples, "columns") and hasattr(samples, "to_dict"):
        frame: Any = samples
        samples = {name: frame[name].tolist() for name in frame.columns}
    if isinstance(samples, Mapping):
        found = _transposed(samples)
    elif isinstance(samples, Iterable) and not isinstance(samples, (str, bytes)):
        found = [_row(number, row) for number, row in enumerate(samples, start=1)]
    else:
        what = "a sequence of mappings, a mapping of columns or a pandas DataFrame"
        raise expected("samples", what, samples)
    if not found:
        raise ValueError("samples: expected at least one, got none")
    keys = list(found[0])
    for number, row in enumerate(found, start=1):
        if set(row) != set(keys):
            raise ValueError(
                f"samples: every sample needs the same keys; sample 1 has {_list(keys)}, "
                f"sample {number} has {_list(row)}"
            )
    return [{key: row[key] for key in keys} for row in found]


def fingerprint(samples: Sequence[Sample]) -> str:
    """Hash that identifies the samples of a study."""
    digest = hashlib.sha256()
    for sample in samples:
        digest.update(json.dumps(sample, ensure_ascii=False).encode())
        digest.update(b"\n")
    return digest.hexdigest()


def whole(argument: str, value: object, least: int) -> int:
    """An integer argument of at least ``least``."""
    value = plain(value)
    if isinstance(value, bool) or not isinstance(value, int):
        raise expected(argument, f"a whole number from {least}", value)
    if value < least:
        raise ValueError(f"{argument}: expected a whole number from {least}, got {value}")
    return value


def plain(value: object) -> object:
    """Converts a NumPy scalar or array to Python types."""
    tolist = getattr(value, "tolist", None)
    return tolist() if callable(tolist) else value


def _transposed(columns: Mapping[Any, object]) -> list[Sample]:
    if not columns:
        raise ValueError("samples: expected at least one column, got an empty mapping")
    read = {_key("samples", key): _column("samples", key, of) for key, of in columns.items()}
    lengths = {key: len(column) for key, column in read.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} has {length}" for key, length in lengths.items())
        raise ValueError(f"samples: expected columns of one length, but {told}")
    return [dict(zip(read, values, strict=True)) for values in zip(*read.values(), strict=True)]


def _row(number: int, row: object) -> Sample:
    if not isinstance(row, Mapping):
        raise expected(f"samples: sample {number}", "a mapping of deck keys to values", row)
    if not row:
        raise ValueError(f"samples: sample {number} is empty, expected at least one key")
    where = f"samples: sample {number}"
    return {_key(where, key): _value(f"{where}, {key}", value) for key, value in row.items()}


def _column(argument: str, key: object, values: object) -> list[Value]:
    where = f"{argument}: {key}"
    values = plain(values)
    if isinstance(values, (str, bytes, Mapping)) or not isinstance(values, Iterable):
        raise expected(where, "a sequence of values, such as [1, 2]", values)
    column = [_value(f"{where}[{at}]", value) for at, value in enumerate(values)]
    if not column:
        raise ValueError(f"{where}: expected at least one value, got none")
    return column


def _key(where: str, key: object) -> str:
    if not isinstance(key, str) or not key:
        raise expected(where, 'keys such as "interfaces.joint.f_t"', key)
    return key


def _value(where: str, value: object) -> Value:
    value = plain(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{where}: expected a finite number, got {value}")
    if isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, (list, tuple)):
        return [_value(f"{where}[{at}]", item) for at, item in enumerate(value)]
    raise expected(where, "a number, a string, a boolean or a list of them", value)


def _list(names: Iterable[str]) -> str:
    return ", ".join(sorted(names))
