"""Tests whose curves have a closed form: workers import them from here.

The force of ``Bar`` rises with ``k`` to the strength ``f`` and falls to nothing at ``u``. ``unused`` changes nothing,
``twin`` multiplies ``f``, so that both are one parameter. ``fail_above`` and ``stop`` are about runs that fail.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import wythe

KEYS: dict[str, Any] = {
    "k": 10.0, "f": 2.0, "u": 1.0, "unused": 1.0, "twin": 1.0, "fail_above": 1e9, "stop": 2.0, "end": 2.0, "status": "",
}  # fmt: skip


class BarResults:
    """What a run gives."""

    def __init__(self, keys: Mapping[str, Any]) -> None:
        stopped = keys["stop"] < keys["end"]
        self.status = (keys["status"] or "not_converged") if stopped else "completed"
        self.message = "no equilibrium" if stopped else ""
        self.summary = {"status": self.status, "message": self.message, "wall_s": 0.0}
        x = np.linspace(0.01, keys["end"], 200)
        x = x[x <= keys["stop"]]
        self.history = {
            "driven": np.ones(x.size, dtype=bool),
            "step": np.zeros(x.size, dtype=np.int64),
            "displacement_mm": x,
            "force_kN": force(keys, x),
            "half_kN": -0.5 * force(keys, x),
        }


def force(keys: Mapping[str, Any], x: Any) -> Any:
    """Force at displacements."""
    strength = keys["f"] * keys["twin"]
    falls = strength * (keys["u"] - x) / max(keys["u"] - strength / keys["k"], 1e-9)
    return np.maximum(np.minimum(keys["k"] * x, falls), 0.0)


class Bar:
    """A model with the parts that a calibration uses."""

    folder = ""

    def __init__(self, **keys: Any) -> None:
        self.keys = {**KEYS, **keys}

    def with_(self, changes: Mapping[str, Any]) -> Bar:
        own = {key: value for key, value in changes.items() if not key.startswith("output.")}
        for key in own:
            if key not in KEYS:
                raise wythe.ModelError(f"`{key}` is not a known key", key=key, kind="unknown-key")
        return Bar(**{**self.keys, **own})

    def to_dict(self) -> dict[str, Any]:
        return dict(self.keys)

    @property
    def digest(self) -> str:
        return hashlib.sha256(json.dumps(self.keys).encode()).hexdigest()

    def run(self, out: object, threads: int, progress: bool) -> BarResults:
        if self.keys["f"] > self.keys["fail_above"]:
            raise wythe.ModelError("f is above what it bears", key="f", fix="less of it")
        return BarResults(self.keys)


def measured(noise: float = 0.02, seed: int = 0, points: int = 40, **keys: Any) -> Any:
    """A curve with normal scatter over its peak. Shape (points, 2)."""
    x = np.linspace(0.02, 0.95, points)
    at = {**KEYS, **keys}
    y = force(at, x)
    scatter = np.random.default_rng(seed).standard_normal(points)
    return np.stack([x, y + noise * y.max() * scatter], axis=1)
