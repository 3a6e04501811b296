"""What runs in a worker: one sample, from its values to a row's numbers.

Nothing leaves :func:`run_sample` as an exception, so that whatever a future raises is trouble with the
executor or the death of a worker, never with the sample.
"""

from __future__ import annotations

import contextlib
import functools
import importlib
import math
import os
import pickle
import shutil
import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, TypedDict, Union

from wythe._errors import ConvergenceError, ModelError, WytheError, expected
from wythe._study._samples import Sample, plain

Scalar: TypeAlias = Union[bool, int, float, str, None]
"""A cell of the table."""

MEASURES = (
    "peak_force_kN",
    "displacement_at_peak_mm",
    "displacement_at_80_percent_mm",
    "final_displacement_mm",
    "initial_stiffness_kN_per_mm",
    "dofs",
    "increments",
    "iterations",
    "cutbacks",
    "energy_balance_error",
    "wall_s",
    "cpu_s",
    "peak_rss_MB",
)
"""What a row takes from the summary of its run."""


class Outcome(TypedDict):
    """What became of a sample."""

    status: str
    message: str
    measures: dict[str, Scalar]
    again: bool
    """Whether the machine was in trouble rather than the sample, so that another go may help."""


@dataclass(frozen=True)
class Job:
    """What all samples of a study share."""

    model: Any
    """The base model, or a callable that makes one of a sample."""
    measure: Callable[[Any], Mapping[str, object]] | None
    keep: str | None
    """The folder that run folders are kept in."""
    scratch: str | None
    """The folder for those that are not; without one they are temporary folders."""
    asker: str
    """The process that wants to know, as :func:`this_process` calls it."""


# Process numbers are not unique beyond one machine, and forked processes inherit this.
_TOKEN = uuid.uuid4().hex


def this_process() -> str:
    """A name for this process that no other has."""
    return f"{_TOKEN}-{os.getpid()}"


def folder_name(number: int) -> str:
    """Of the run of a sample."""
    return f"sample-{number:04d}"


def pack(job: Job) -> bytes:
    """The job as bytes, once for all samples. With cloudpickle, lambdas and notebooks' functions pass."""
    try:
        pickler: Any = importlib.import_module("cloudpickle")
    except ImportError:
        pickler = pickle
    packed: bytes = pickler.dumps(job)
    return packed


@functools.lru_cache(maxsize=2)
def _unpack(packed: bytes) -> Job:
    job = pickle.loads(packed)
    assert isinstance(job, Job)
    return job


def run_sample(
    work: Job | bytes, number: int, sample: Sample, scratch: str | None = None
) -> Outcome:
    """Runs one sample to its row, come what may; in ``scratch`` rather than where the job says."""
    job = _unpack(work) if isinstance(work, bytes) else work
    out = _out(job, number, scratch)
    running = False
    try:
        model = model_of(job.model, sample)
        if job.keep is None and job.measure is None:
            model = _without_pictures(model)
        running = True
        results = _run(model, out)
        status, message = str(results.status), _line(str(results.message))
        measures = _measures_of(results.summary)
        try:
            measures.update(_measured(job.measure, results, sample))
        except Exception as error:
            status, message = "failed", f"measure: {_told(error)}"
        if job.keep is not None and out is not None:
            _settle(out, Path(job.keep) / folder_name(number))
    except KeyboardInterrupt:
        if job.asker == this_process():
            raise
        return Outcome(status="interrupted", message="interrupted", measures={}, again=True)
    # The solver's own mistakes come as panics, which are no Exceptions.
    except BaseException as error:
        machine = running and isinstance(error, (OSError, MemoryError))
        return Outcome(status="failed", message=_told(error), measures={}, again=machine)
    finally:
        if out is not None:
            shutil.rmtree(out, ignore_errors=True)
    return Outcome(status=status, message=message, measures=measures, again=False)


def model_of(model: Any, sample: Sample) -> Any:
    """The model of a sample."""
    if hasattr(model, "with_"):
        return model.with_(sample)
    made = model(sample)
    if not hasattr(made, "run"):
        raise expected("model(sample)", "a wythe.Model", made)
    return made


def _out(job: Job, number: int, scratch: str | None) -> Path | None:
    """Where a run goes: a name of its own for each attempt, as one given up may still be at work."""
    base = job.keep or scratch or job.scratch
    if base is None:
        return None
    return Path(base) / f"{folder_name(number)}.part-{uuid.uuid4().hex[:8]}"


def _without_pictures(model: Any) -> Any:
    """The model without files that nobody will see: they take a third of a small run's time."""
    with contextlib.suppress(ModelError):
        return model.with_({"output.mcap": False, "output.every": 1_000_000})
    return model


def _run(model: Any, out: Path | None) -> Any:
    try:
        return model.run(out=out, threads=1, progress=False)
    except ConvergenceError as error:
        # A result, marked as such: there is a run up to there.
        return error.results


def _settle(out: Path, final: Path) -> None:
    """Gives the folder of a finished run its name."""
    if final.exists():
        shutil.rmtree(final)
    out.rename(final)


def _measures_of(summary: Mapping[str, Any]) -> dict[str, Scalar]:
    measures = {name: _scalar(name, summary[name]) for name in MEASURES if name in summary}
    for name, ranges in summary.get("probes", {}).items():
        for which in ("lowest", "highest", "last"):
            measures[f"{name}_{which}"] = _scalar(name, ranges.get(which))
    return measures


def _measured(
    measure: Callable[[Any], Mapping[str, object]] | None, results: Any, sample: Sample
) -> dict[str, Scalar]:
    if measure is None:
        return {}
    given = measure(results)
    if not isinstance(given, Mapping):
        raise expected("its result", "a mapping of names to numbers", given)
    for name in given:
        if not isinstance(name, str):
            raise expected("its result", "names of columns", name)
        if name in RESERVED or name in sample:
            raise ValueError(f"{name} is a column already, choose another name")
    return {name: _scalar(name, value) for name, value in given.items()}


def _scalar(name: str, value: object) -> Scalar:
    value = plain(value)
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise expected(name, "a number, a boolean, a string or None", value)


def _told(error: BaseException) -> str:
    text = _line(str(error))
    if isinstance(error, WytheError) and text:
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _line(text: str) -> str:
    """In one line."""
    return "; ".join(line.strip() for line in text.splitlines() if line.strip())


RESERVED = frozenset(("sample", "status", "message", "attempts", *MEASURES))
"""Names of columns that are taken."""
