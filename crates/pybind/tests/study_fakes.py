"""Models that do what tests of studies need: workers import them from here."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any


class FakeResults:
    """What a run gives."""

    def __init__(self, path: str | None, summary: dict[str, Any]) -> None:
        self.path = path
        self.summary = summary
        self.status = summary["status"]
        self.message = summary["message"]


class FakeModel:
    """peak = 3 a − b, after what the other keys ask for.

    ``sleep`` [s]; ``fail`` (ValueError) and ``trouble`` (OSError, so many times); ``kill`` (its process, so
    many times, -1: always); ``stop`` ("not_converged"). ``notes`` is a folder: each begin leaves a file there.
    """

    def __init__(self, **keys: Any) -> None:
        self.keys = keys

    def with_(self, changes: Mapping[str, Any]) -> FakeModel:
        for key, value in changes.items():
            if key == "unknown":
                raise ValueError("`unknown` is not a known key")
            if key == "a" and value == "impossible":
                raise ValueError("a: impossible")
        return FakeModel(**{**self.keys, **changes})

    def to_toml(self) -> str:
        return json.dumps({k: v for k, v in self.keys.items() if k != "notes"}, sort_keys=True)

    def run(self, out: Any = None, *, threads: int | None = None, progress: bool = False) -> Any:
        assert threads == 1 and not progress
        keys = self.keys
        before = self._begin()
        time.sleep(keys.get("sleep", 0.0))
        kill = keys.get("kill", 0)
        if kill < 0 or before < kill:
            os.kill(os.getpid(), signal.SIGKILL)
        if before < keys.get("trouble", 0):
            raise OSError("no space left")
        if keys.get("fail"):
            raise ValueError("this cannot be\n  fix: say something else")
        if out is not None:
            Path(out).mkdir(parents=True)
            (Path(out) / "summary.json").write_text("{}")
        peak = 3.0 * keys.get("a", 0.0) - keys.get("b", 0.0)
        return FakeResults(
            None if out is None else str(out),
            {
                "status": keys.get("stop", "completed"),
                "message": "lost its way" if "stop" in keys else "",
                "peak_force_kN": peak,
                "displacement_at_80_percent_mm": None,
                "increments": 7,
                "probes": {"gap_mm": {"lowest": 0.0, "highest": 2.0, "last": 1.0}},
                "wall_s": 0.1,
                "warnings": [],
            },
        )

    def _begin(self) -> int:
        """Notes a begin, and tells how many there were before of the same."""
        if "notes" not in self.keys:
            return 0
        folder = Path(self.keys["notes"])
        name = hashlib.sha256(self.to_toml().encode()).hexdigest()[:8]
        before = len(list(folder.glob(f"{name}-*")))
        (folder / f"{name}-{before}-{os.getpid()}").touch()
        return before


def made(sample: Mapping[str, Any]) -> FakeModel:
    """A model of a sample."""
    return FakeModel(a=10.0 * sample["ten"])


def twice(results: Any) -> dict[str, float]:
    """A measure."""
    return {"twice": 2.0 * results.summary["peak_force_kN"]}


def no_mapping(results: Any) -> Any:
    """A measure that is none."""
    return 1.0


def taken_name(results: Any) -> dict[str, float]:
    """A measure of a name that is taken."""
    return {"status": 1.0}
