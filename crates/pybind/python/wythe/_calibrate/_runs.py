"""The runs of a calibration: batches of decks with values, by the executors of studies."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wythe._calibrate._job import Floats, Job
from wythe._errors import ModelError
from wythe._study import Workers, study
from wythe._study._samples import Sample, fingerprint

# Longest text of a message in a list of failed runs.
MESSAGE = 300


@dataclass(frozen=True)
class FailedRun:
    """A run that gave no curve, or a curve that ended early.

    Attributes
    ----------
    test : str
        Name of the test.
    values : dict
        Values of the parameters by name.
    status : str
        Status of the run, as in a table of :func:`wythe.study`.
    message : str
        Reason.
    """

    test: str
    values: dict[str, float]
    status: str
    message: str


@dataclass(frozen=True)
class Run:
    """What a run gave."""

    status: str
    message: str
    columns: dict[str, Floats] | None
    """Columns of the history, None if the run failed. Shape (increments,) each."""
    seconds: float

    @property
    def whole(self) -> bool:
        """Whether the run reached the end of its steps."""
        return self.status == "completed"


@dataclass(frozen=True)
class Decks:
    """Makes the model of a sample; workers get a copy."""

    job: Job

    def __call__(self, sample: Sample) -> Any:
        """The deck of the test with the values of the sample."""
        test = next(test for test in self.job.tests if test.name == sample["test"])
        values = {p.name: float(str(sample[p.name])) for p in self.job.parameters}
        model = test.model.with_(self.job.changes(test, values))
        # Unneeded output files take a third of the time of a small run.
        with contextlib.suppress(ModelError):
            return model.with_({"output.mcap": False, "output.every": 1_000_000})
        return model

    def to_toml(self) -> str:
        """Text that identifies the decks and keys, by which the journal of a study knows its model again."""
        said = [
            f"{test.name} {test.model.digest} {os.path.abspath(test.model.folder or '.')}" for test in self.job.tests
        ]
        for test in self.job.tests:
            for file in getattr(test.model, "_named_files", list)():
                with contextlib.suppress(OSError):
                    said.append(hashlib.sha256(Path(file).read_bytes()).hexdigest())
        return "\n".join([*said, *(f"{p.name} {p.keys} {p.unit}" for p in self.job.parameters)])


@dataclass(frozen=True)
class Columns:
    """Takes columns of the history of a run, as a text because a cell of a table is one value."""

    names: tuple[str, ...]

    def __call__(self, results: Any) -> dict[str, str]:
        """Columns by name; those that the history does not have are absent."""
        history = results.history
        there = [name for name in self.names if name in history]
        return {"columns": json.dumps({name: history[name].tolist() for name in there})}


class Runs:
    """Runs of the tests with given values; each is computed once."""

    def __init__(self, job: Job, executor: Any, folder: Path | None, show: Callable[[int], None]) -> None:
        self._job = job
        self._executor = executor
        self._folder = folder
        self._show = show
        self._decks = Decks(job)
        names = {column.name for test in job.tests for column in (test.x, test.y)}
        self._columns = Columns(("driven", "step", *sorted(names)))
        self._known: dict[tuple[Any, ...], Run] = {}
        self.done = 0
        """Number of runs so far."""
        self.seconds = 0.0
        """Time of the solver in all runs [s]."""

    def at(self, points: Sequence[Mapping[str, float]]) -> list[list[Run]]:
        """The runs of all tests for each set of values; those that are new run side by side.

        Returns a list per set of values with one run per test.
        """
        wanted = [[self._key(test, values) for test in self._job.tests] for values in points]
        samples: dict[tuple[Any, ...], Sample] = {}
        for keys, values in zip(wanted, points, strict=True):
            for key, test in zip(keys, self._job.tests, strict=True):
                if key not in self._known:
                    samples.setdefault(key, {"test": test.name, **values})
        if samples:
            self._run(samples)
        return [[self._known[key] for key in keys] for keys in wanted]

    def _key(self, test: Any, values: Mapping[str, float]) -> tuple[Any, ...]:
        return (test.name, *self._job.changes(test, values).items())

    def _run(self, samples: dict[tuple[Any, ...], Sample]) -> None:
        rows = list(samples.values())
        table = study(
            self._decks,
            samples=rows,
            executor=self._executor,
            measure=self._columns,
            out=None if self._folder is None else self._folder / self._batch(rows),
            progress=False,
            callback=lambda row: self._show(self.done),
        )
        for key, row in zip(samples, table, strict=True):
            said = row.get("columns")
            columns = None if said is None else json.loads(said)
            self._known[key] = Run(
                status=row["status"],
                message=row["message"][:MESSAGE],
                columns=None if columns is None else {name: np.asarray(of) for name, of in columns.items()},
                seconds=float(row.get("wall_s") or 0.0),
            )
            self.done += 1
            self.seconds += self._known[key].seconds

    def _batch(self, rows: list[Sample]) -> str:
        """Name of the folder of a batch, by its content: the same calibration finds its batches again."""
        said = "\n".join([fingerprint(rows), self._decks.to_toml(), *self._columns.names])
        return hashlib.sha256(said.encode()).hexdigest()[:20]


@contextlib.contextmanager
def workers(executor: Any) -> Iterator[Any]:
    """The executor of all batches: processes of our own stay up between them."""
    if executor is not None and (isinstance(executor, bool) or not isinstance(executor, int)):
        yield executor
        return
    pool = Workers(executor)
    try:
        yield pool
    except BaseException:
        pool.kill()
        raise
    pool.shutdown()
