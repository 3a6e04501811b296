"""``wythe.study``: many runs of one model on this machine or a cluster."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import inspect
import os
import pickle
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from wythe._errors import OutputError, as_path, expected, unwritten
from wythe._study import _dask
from wythe._study._drive import drive
from wythe._study._errors import StudyError, StudyInterrupted
from wythe._study._executors import Futures, Place
from wythe._study._journal import FORMAT, Header, Journal, Line
from wythe._study._pool import Workers, leave_import
from wythe._study._progress import Progress, sink
from wythe._study._samples import Sample, expand, fingerprint, whole
from wythe._study._table import Study
from wythe._study._worker import RESERVED, Job, Outcome, model_of, this_process

# Number of samples that are tried before an invalid key is reported.
TRIED = 20
# Statuses that another attempt may change; a continued study repeats these samples.
UNSETTLED = ("interrupted", "lost")


def study(
    model: Any,
    parameters: Mapping[str, Any] | None = None,
    samples: Any = None,
    *,
    executor: Any = None,
    measure: Callable[[Any], Mapping[str, Any]] | None = None,
    out: str | os.PathLike[str] | None = None,
    keep: Literal["none", "results"] = "none",
    retries: int = 2,
    progress: bool = True,
    callback: Callable[[dict[str, Any]], bool | None] | None = None,
) -> Study:
    """Runs a model once for each sample and returns a table with one row per sample.

    Parameters
    ----------
    model
        The base model, or a function that makes a model of a sample (``model(sample) -> wythe.Model``) if the
        change cannot be expressed by keys of the deck.
    parameters
        Deck keys and their values (``{"interfaces.joint.f_t": [0.1, 0.2]}``). All combinations are run; the
        first key varies slowest.
    samples
        Used instead of ``parameters``, with one sample per row: a sequence of mappings, a mapping of columns of
        equal length (as from :func:`wythe.latin_hypercube`), or a pandas DataFrame.
    executor
        Executor of the runs, each with one thread of the solver: an executor with the interface of
        concurrent.futures, or a Dask client or cluster. An integer is a number of worker processes on this
        machine. The default is one worker per core, in a LocalCluster of Dask if dask.distributed is installed,
        otherwise in :class:`wythe.Workers`.
    measure
        Function for further columns: it receives the results of each run and returns names and numbers.
    out
        Folder for a journal. The same call with the same folder continues a study that stopped or was killed;
        lost and interrupted samples are tried again.
    keep
        ``"results"`` keeps the folder of each run as ``out/sample-0001``; the workers need access to it.
    retries
        Number of further attempts for a sample whose worker died or whose machine failed.
    progress
        Whether to show the progress on stderr.
    callback
        Function called with each finished row, in any order; the study stops if it returns False.

    Returns
    -------
    Study
        The table: parameters, ``status``, ``message``, ``attempts`` and measures. The status is
        ``"completed"``, ``"collapsed"``, ``"not_converged"`` (with the measures up to there), ``"interrupted"``,
        ``"failed"`` (the model or the files of the run are rejected; ``message`` has the reason) or ``"lost"``
        (its worker died more than ``retries`` times).

    Raises
    ------
    TypeError, ValueError
        An argument is invalid.
    wythe.ModelError
        The model accepts none of the samples: a key is misspelt, or no value is in its range.
    OutputError
        The folder cannot be written.
    StudyError
        The study cannot start or continue. Finished samples are kept in ``out`` and in ``study`` of the error.
    KeyboardInterrupt
        Ctrl-C: :class:`wythe.StudyInterrupted`, whose ``study`` has the finished samples.
    """
    _check(model, executor, measure, keep, retries, progress, callback)
    if keep == "results" and out is None:
        raise ValueError('keep: "results" needs a folder to keep them in, out=...')
    rows = expand(parameters, samples)
    taken = sorted(set(rows[0]) & RESERVED)
    if taken:
        argument = "samples" if parameters is None else "parameters"
        raise ValueError(f"{argument}: {taken[0]} is a column of the table, expected another name")
    leave_import()
    _try_out(model, rows)
    folder = None if out is None else Path(as_path("out", out))
    if folder is not None and folder.exists() and not folder.is_dir():
        raise StudyError(f"out: {folder} is a file, expected a folder or a new name")
    job = Job(
        model=model,
        measure=measure,
        keep=str(folder.resolve()) if folder is not None and keep == "results" else None,
        scratch=None,
        asker=this_process(),
    )
    with contextlib.ExitStack() as stack:
        journal = None
        if folder is not None:
            try:
                journal = Journal(folder, _header(model, rows, measure))
            except OSError as error:
                raise unwritten(str(folder), error) from error
            stack.callback(journal.close)
        return _Pass(rows, journal, bool(progress), callback).run(executor, job, retries)


class _Pass:
    """One pass of a study: the part computed by one call of :func:`study`."""

    def __init__(
        self,
        samples: list[Sample],
        journal: Journal | None,
        progress: bool,
        callback: Callable[[dict[str, Any]], bool | None] | None,
    ) -> None:
        self._samples = samples
        self._journal = journal
        self._callback = callback
        before = [] if journal is None else journal.lines
        self._lines: dict[int, Line] = {
            line["sample"]: line for line in before if line["status"] not in UNSETTLED
        }
        count = len(samples)
        self._progress = Progress(count, len(self._lines), sink(count) if progress else None)
        for line in self._lines.values():
            self._count(line["status"])

    def run(self, executor: Any, job: Job, retries: int) -> Study:
        left = [n for n in range(1, len(self._samples) + 1) if n not in self._lines]
        if not left:
            return self._table()
        place: Place | None = None
        finished = False
        try:
            place = _place(executor, job, len(left))
            self._show(place)
            drive(place, self._samples, left, retries, self._record, lambda: self._show(place))
            finished = True
        except StudyError as error:
            raise StudyError(f"{error}. {self._standing()}", self._table()) from error.__cause__
        except KeyboardInterrupt:
            raise StudyInterrupted(f"study interrupted. {self._standing()}", self._table()) from None
        finally:
            if place is not None:
                place.close(finished and len(self._lines) == len(self._samples))
            self._progress.show(last=True)
            self._write_table()
        return self._table()

    def _record(self, number: int, attempts: int, outcome: Outcome) -> bool:
        line = Line(
            sample=number,
            parameters=self._samples[number - 1],
            status=outcome["status"],
            message=outcome["message"],
            attempts=attempts,
            measures=outcome["measures"],
        )
        if self._journal is not None:
            try:
                self._journal.add(line)
            except OSError as error:
                raise StudyError(f"out: the journal cannot be written ({error})") from error
        self._lines[number] = line
        self._progress.done += 1
        self._count(line["status"])
        answer = None if self._callback is None else self._callback(Study([line], 1)[0])
        # numpy.False_ is not the object False.
        return not (isinstance(answer, (bool, np.bool_)) and not answer)

    def _count(self, status: str) -> None:
        self._progress.failed += status in ("failed", "lost")
        self._progress.unconverged += status == "not_converged"

    def _show(self, place: Place | None) -> None:
        self._progress.workers = 0 if place is None else place.workers
        self._progress.show()

    def _table(self) -> Study:
        folder = None if self._journal is None else self._journal.folder
        return Study(list(self._lines.values()), len(self._samples), folder)

    def _write_table(self) -> None:
        if self._journal is not None:
            with contextlib.suppress(OutputError):
                self._table().to_csv(self._journal.folder / "study.csv")

    def _standing(self) -> str:
        done = f"{len(self._lines)} of {len(self._samples)} samples are done"
        if self._journal is None:
            return f"{done}: this error's .study has them; with out=FOLDER a study can be continued"
        return f"{done} and kept in {self._journal.folder}: the same call goes on from there"


def _place(executor: Any, job: Job, left: int) -> Place:
    """The executor of the samples."""
    if executor is None or isinstance(executor, (int, np.integer)):
        # More workers than samples would be idle.
        count = min(int(executor or os.cpu_count() or 1), left)
        if _dask.is_there():
            return _dask.local_cluster(count, job)
        return Futures(Workers(count), job, own=True)
    if _dask.is_a("Client", executor):
        return _dask.Dask(executor, job, own=[])
    if _dask.is_a("Cluster", executor):
        return _dask.on_cluster(executor, job)
    return Futures(executor, job, own=False)


def _check(
    model: Any, executor: Any, measure: Any, keep: Any, retries: Any, progress: Any, callback: Any
) -> None:
    """Checks the arguments of a study."""
    if isinstance(executor, (int, np.integer)):
        whole("executor", executor, 1)
    elif executor is not None and not _dask.is_a("Cluster", executor):
        if not callable(getattr(executor, "submit", None)):
            what = "an executor with submit(), a Dask client, or a number of worker processes"
            raise expected("executor", what, executor)
    if not hasattr(model, "with_") and not callable(model):
        raise expected("model", "a wythe.Model or a function of a sample", model)
    for name, function, of in (("measure", measure, "the results"), ("callback", callback, "a row")):
        if function is not None and not callable(function):
            raise expected(name, f"a function of {of}", function)
    if keep not in ("none", "results"):
        raise ValueError(f'keep: expected "none" or "results", got {keep!r}')
    whole("retries", retries, 0)
    if not isinstance(progress, bool):
        raise expected("progress", "True or False", progress)


def _try_out(model: Any, samples: list[Sample]) -> None:
    """Builds models of the first samples, so that an invalid key is reported before all runs fail."""
    errors: list[Exception] = []
    for sample in samples[:TRIED] if hasattr(model, "with_") else ():
        try:
            model_of(model, sample)
        except Exception as error:
            errors.append(error)
        else:
            return
    if errors:
        raise errors[0]


def _header(model: Any, samples: list[Sample], measure: Any) -> Header:
    return Header(
        wythe_study=FORMAT,
        model=_identity(model),
        samples=fingerprint(samples),
        count=len(samples),
        measure="" if measure is None else _identity(measure),
    )


def _identity(thing: Any) -> str:
    """Identity of a model or a function: its name and a hash of its content."""
    digest = hashlib.sha256()
    if hasattr(thing, "to_toml"):
        digest.update(thing.to_toml().encode())
        _take_files(digest, thing)
        return f"model {digest.hexdigest()}"
    # The hash covers the source of a function and the data of a callable object.
    of = thing.func if isinstance(thing, functools.partial) else thing
    with contextlib.suppress(OSError, TypeError):
        digest.update(inspect.getsource(of if inspect.isroutine(of) else type(of)).encode())
    with contextlib.suppress(Exception):
        digest.update(pickle.dumps(thing, protocol=4))
    _take_surroundings(digest, of)
    name = getattr(of, "__qualname__", type(of).__qualname__)
    return f"{name} {digest.hexdigest()}"


def _take_files(digest: Any, model: Any) -> None:
    """Adds the content of the files that the deck of a model names."""
    for file in getattr(model, "_named_files", list)():
        with contextlib.suppress(OSError):
            digest.update(Path(file).read_bytes())


def _take_surroundings(digest: Any, function: Any) -> None:
    """Adds the values of a function's closure and of the globals that it uses, as far as they can be written down."""
    if not inspect.isfunction(function):
        return
    around = inspect.getclosurevars(function)
    for name, value in sorted({**around.globals, **around.nonlocals}.items()):
        if inspect.ismodule(value):
            continue
        digest.update(name.encode())
        if hasattr(value, "to_toml") and not isinstance(value, type):
            digest.update(value.to_toml().encode())
            _take_files(digest, value)
            continue
        with contextlib.suppress(OSError, TypeError):
            digest.update(inspect.getsource(value).encode())
        with contextlib.suppress(Exception):
            digest.update(pickle.dumps(value, protocol=4))
