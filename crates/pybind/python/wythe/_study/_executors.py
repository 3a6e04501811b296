"""A common interface for executors of all kinds.

The loop in :mod:`._drive` uses ``Place``, which accepts samples and returns events. This module implements it for
executors with the interface of concurrent.futures, :mod:`._dask` for Dask.
"""

from __future__ import annotations

import pickle
import queue
import shutil
import tempfile
import time
from concurrent.futures import BrokenExecutor, CancelledError, ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, Protocol

from wythe._errors import expected
from wythe._study._errors import StudyError
from wythe._study._pool import WorkerBroken, WorkerDied, Workers
from wythe._study._samples import Sample
from wythe._study._worker import Job, Outcome, pack, run_sample

# Assumed number of workers of an executor without the attribute of the standard library.
UNKNOWN = 128
# Time between checks of futures without callbacks [s].
ASKED_EVERY = 0.05


@dataclass(frozen=True)
class Finished:
    """A sample has ended."""

    number: int
    outcome: Outcome
    starts: int = 1
    """Number of its starts since the last event."""


@dataclass(frozen=True)
class Died:
    """The worker of a sample has died or the sample was not returned."""

    number: int
    starts: int
    """Number of its starts since the last event; 0 if it only waited."""
    certain: bool
    """Whether no other sample ran in the same worker."""
    why: str


class Place(Protocol):
    """An executor of samples."""

    workers: int
    """Number of samples that run at a time, if it is known."""

    def room(self) -> int:
        """Largest number of submitted samples, more than the workers so that none of them waits."""
        ...

    def submit(self, number: int, sample: Sample) -> None:
        """Sends a sample."""
        ...

    def wait(self, seconds: float) -> list[Finished | Died]:
        """Returns events, at the latest after this time [s]."""
        ...

    def close(self, finished: bool) -> None:
        """Cancels waiting samples and ends workers owned by the study."""
        ...


class Futures:
    """Runs samples by an executor whose ``submit`` returns futures."""

    def __init__(self, executor: Any, job: Job, own: bool) -> None:
        self._executor = executor
        self._own = own
        # A killed worker cannot remove its temporary folders; this one is removed with the study.
        self._scratch = tempfile.mkdtemp(prefix="wythe-study-") if own else None
        if self._scratch is not None:
            job = replace(job, scratch=self._scratch)
        # Threads need no copy, and some objects cannot be pickled.
        self._work = job if isinstance(executor, ThreadPoolExecutor) else packed(job)
        self._trouble: StudyError | None = None
        self._certain = isinstance(executor, Workers)
        self._under_way: dict[Any, int] = {}
        self._done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        known = getattr(executor, "_max_workers", None)
        self.workers = known if isinstance(known, int) else UNKNOWN

    def room(self) -> int:
        """Twice the number of workers."""
        return 2 * self.workers

    def submit(self, number: int, sample: Sample) -> None:
        """Sends a sample."""
        if self._trouble is not None:
            return
        try:
            future = self._executor.submit(run_sample, self._work, number, sample)
        except BrokenExecutor as error:
            self._trouble = self._broken(error)
            return
        except RuntimeError as error:
            self._trouble = StudyError(f"executor: it takes no more samples ({told(error)})")
            return
        self._under_way[future] = number
        if hasattr(future, "add_done_callback"):
            future.add_done_callback(self._done.put)

    def wait(self, seconds: float) -> list[Finished | Died]:
        """Returns events. An error of the executor is raised after all events before it."""
        events: list[Finished | Died] = []
        for future in self._finished(seconds if self._trouble is None else 0.0):
            try:
                event = self._event(future)
            except StudyError as error:
                self._trouble = self._trouble or error
                continue
            if event is not None:
                events.append(event)
        if self._trouble is not None and not events:
            raise self._trouble
        return events

    def close(self, finished: bool) -> None:
        """Cancels waiting samples and ends the workers owned by the study."""
        for future in self._under_way:
            if hasattr(future, "cancel"):
                future.cancel()
        if self._own and isinstance(self._executor, Workers):
            if finished:
                self._executor.shutdown()
            else:
                self._executor.kill()
        if self._scratch is not None:
            shutil.rmtree(self._scratch, ignore_errors=True)

    def _finished(self, seconds: float) -> list[Any]:
        end = time.monotonic() + seconds
        found: list[Any] = []
        while not found:
            left = max(0.0, end - time.monotonic())
            silent = [future for future in self._under_way if not hasattr(future, "add_done_callback")]
            found = [future for future in silent if future.done()]
            try:
                found.append(self._done.get(timeout=min(left, ASKED_EVERY) if silent else left))
                while True:
                    found.append(self._done.get_nowait())
            except queue.Empty:
                pass
            if time.monotonic() >= end:
                break
        return found

    def _event(self, future: Any) -> Finished | Died | None:
        number = self._under_way.pop(future, None)
        if number is None:
            return None
        try:
            return Finished(number, future.result())
        except WorkerBroken:
            raise
        except WorkerDied as death:
            return Died(number, starts=1, certain=True, why=str(death))
        except BrokenExecutor as error:
            self._under_way[future] = number
            raise self._broken(error) from error
        except CancelledError as error:
            raise StudyError(f"executor: sample {number} was cancelled there") from error
        except (ImportError, AttributeError, TypeError, pickle.PickleError) as error:
            raise unfit(error) from error
        except Exception as error:
            return Died(number, starts=1, certain=self._certain, why=told(error))

    def _broken(self, error: BaseException) -> StudyError:
        running = sorted(self._under_way.values())
        return StudyError(
            f"executor: it broke ({told(error)}), which a killed worker does to it, while samples "
            f"{_some(running)} were under way. The executors of the study's own and Dask's clients "
            "go on without the worker"
        )


def unfit(error: BaseException) -> StudyError:
    """Error for a worker that cannot unpack a sample."""
    return StudyError(
        f"executor: a worker cannot take a sample ({told(error)}); is wythe there in the same version, "
        "and can the worker import the modules of model and measure?"
    )


def packed(job: Job) -> bytes:
    """The job as bytes; raises an error that names the argument that cannot be pickled."""
    try:
        return pack(job)
    except Exception as error:
        for name, thing in (("model", job.model), ("measure", job.measure)):
            try:
                pickle.dumps(thing)
            except Exception:
                what = "something that can be pickled for the workers, such as a function of a module"
                raise expected(name, what, thing) from error
        raise


def told(error: BaseException) -> str:
    """The first line of an error, shortened because some errors quote whole messages."""
    lines = str(error).splitlines()
    return f"{type(error).__name__}: {lines[0][:200]}" if lines else type(error).__name__


def _some(numbers: list[int]) -> str:
    text = ", ".join(map(str, numbers[:8]))
    return f"{text} …" if len(numbers) > 8 else text

