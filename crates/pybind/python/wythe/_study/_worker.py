"""Code executed in a worker: runs one sample and returns the numbers of its row.

:func:`run_sample` raises no exception, so that an exception of a future always means a failure of the executor or
the death of a worker, never a failure of the sample.
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
"""Measures of a row from the summary of its run."""


class Outcome(TypedDict):
    """Outcome of a sample."""

    status: str
    message: str
    measures: dict[str, Scalar]
    again: bool
    """Whether the machine failed rather than the sample, so that another attempt may succeed."""


@dataclass(frozen=True)
class Job:
    """Common data of all samples of a study."""

    model: Any
    """The base model, or a callable that makes a model of a sample."""
    measure: Callable[[Any], Mapping[str, object]] | None
    keep: str | None
    """Folder in which run folders are kept."""
    scratch: str | None
    """Folder for run folders that are not kept; None for temporary folders."""
    asker: str
    """Process of the study, as named by :func:`this_process`."""


# Process numbers are unique on one machine only; forked processes inherit the token.
_TOKEN = uuid.uuid4().hex


def this_process() -> str:
    """A unique name of this process."""
    return f"{_TOKEN}-{os.getpid()}"


def folder_name(number: int) -> str:
    """Name of the run folder of a sample."""
    return f"sample-{number:04d}"


def pack(job: Job) -> bytes:
    """The job as bytes, for all samples. With cloudpickle it may have lambdas and functions of notebooks."""
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
    """Runs one sample and returns its outcome in all cases; ``scratch`` replaces the scratch folder of the job."""
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
    # A panic of the solver is a BaseException but not an Exception.
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
    """Folder of a run, unique for each attempt because an abandoned attempt may still be running."""
    base = job.keep or scratch or job.scratch
    if base is None:
        return None
    return Path(base) / f"{folder_name(number)}.part-{uuid.uuid4().hex[:8]}"


def _without_pictures(model: Any) -> Any:
    """The model without unneeded output files, which take a third of the time of a small run."""
    with contextlib.suppress(ModelError):
        return model.with_({"output.mcap": False, "output.every": 1_000_000})
    return model


def _run(model: Any, out: Path | None) -> Any:
    try:
        return model.run(out=out, threads=1, progress=False)
    except ConvergenceError as error:
        # The status marks the results, which are valid up to the loss of convergence.
        return error.results


def _settle(out: Path, final: Path) -> None:
    """Gives the folder of a finished run its final name."""
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
    """The text in one line."""
    return "; ".join(line.strip() for line in text.splitlines() if line.strip())


RESERVED = frozenset(("sample", "status", "message", "attempts", *MEASURES))
"""Reserved names of columns."""
