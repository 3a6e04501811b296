"""Runs samples on the workers of a Dask cluster, local or remote.

When a worker dies, Dask runs its tasks elsewhere, up to ``distributed.scheduler.allowed-failures`` times (3 by
default), and then gives up with ``KilledWorker``. Every task assigned to the worker counts as failed, including those
that only waited there, and tasks whose results were lost with the worker are repeated. Therefore each sample reports
its start and its end by events of the scheduler. The start counts attempts and distinguishes running samples from
waiting ones; the end transmits the outcome before it can be lost with the worker.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import logging
import math
import os
import pickle
import queue
import signal
import time
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from wythe._study._errors import StudyError
from wythe._study._executors import Died, Finished, packed, told, unfit
from wythe._study._pool import GUARD, check_script
from wythe._study._samples import Sample
from wythe._study._worker import Job, Outcome, run_sample

# Time limit for fetching an outcome that was not reported; after it the worker may have died [s].
FETCH_S = 5.0
# Time between counts of the workers [s].
COUNTED_EVERY = 1.0
# Time limit for sending a report to the scheduler [s].
REPORT_S = 10.0


def is_there() -> bool:
    """Whether dask.distributed is installed."""
    return importlib.util.find_spec("distributed") is not None


def is_a(kind: str, thing: object) -> bool:
    """Whether this is a Dask ``"Client"`` or ``"Cluster"``."""
    return any(
        base.__name__ == kind and base.__module__.partition(".")[0] == "distributed"
        for base in type(thing).__mro__
    )


@dataclass
class _Task:
    """A submitted sample."""

    number: int
    future: Any = None
    starts: int = 0
    late: bool = False
    """Whether its outcome could not be fetched yet."""


class Dask:
    """Runs samples through a Dask client."""

    def __init__(self, client: Any, job: Job, own: list[Any], wanted: int = 0) -> None:
        if getattr(client, "asynchronous", False):
            raise TypeError("executor: expected a Dask client that is not asynchronous")
        self._client = client
        # Objects owned by the study: a client and its cluster with the wanted number of workers.
        self._own = own
        self._wanted = wanted
        self._work = packed(job)
        self._topic = f"wythe-study-{uuid.uuid4().hex[:12]}"
        self._sent = 0
        self._tasks: dict[str, _Task] = {}
        self._happened: queue.SimpleQueue[tuple[str, Outcome | None]] = queue.SimpleQueue()
        self.workers = 1
        self._counted = -math.inf
        with _reached():
            client.subscribe_topic(self._topic, self._heard)
        self.room()

    def room(self) -> int:
        """Twice the number of threads plus some, so that an adaptive cluster has a reason to grow."""
        now = time.monotonic()
        if now - self._counted > COUNTED_EVERY:
            self._counted = now
            with _reached():
                self.workers = sum(self._client.nthreads().values())
                # Dask does not replace a worker that is killed while it starts.
                if self._wanted > self.workers:
                    self._own[-1].scale(self._wanted)
        return 2 * self.workers + 8

    def submit(self, number: int, sample: Sample) -> None:
        """Sends a sample."""
        self._sent += 1
        key = f"wythe-sample-{self._topic[-12:]}-{number}-{self._sent}"
        task = self._tasks[key] = _Task(number)
        with _reached():
            task.future = self._client.submit(
                _run_and_report, self._work, number, sample, self._topic, key, key=key, pure=False
            )
        task.future.add_done_callback(lambda _: self._happened.put((key, None)))

    def wait(self, seconds: float) -> list[Finished | Died]:
        """Events until now, or until the time limit."""
        end = time.monotonic() + seconds
        late = [key for key, task in self._tasks.items() if task.late]
        events = [event for key in late if (event := self._fetched(key)) is not None]
        while not events:
            try:
                key, outcome = self._happened.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                break
            if key in self._tasks:
                event = self._fetched(key) if outcome is None else self._finished(key, outcome)
                events += [] if event is None else [event]
        return events

    def close(self, finished: bool) -> None:
        """Cancels waiting samples and ends a cluster owned by the study."""
        # The cluster may have ended already.
        with contextlib.suppress(Exception):
            self._client.unsubscribe_topic(self._topic)
            # Ctrl-C may come before a task has its future.
            if futures := [task.future for task in self._tasks.values() if task.future is not None]:
                self._client.cancel(futures, force=True)
        if not finished and self._wanted > 0:
            with contextlib.suppress(Exception):
                _kill(self._own[-1])
        for thing in self._own:
            with contextlib.suppress(Exception):
                thing.close()

    def _heard(self, event: Any) -> None:
        """Receives the report that a sample has started or ended; called from the thread of the client."""
        _, message = event
        key = message["key"]
        if message["outcome"] is not None:
            self._happened.put((key, message["outcome"]))
        elif key in self._tasks:
            self._tasks[key].starts += 1

    def _finished(self, key: str, outcome: Outcome) -> Finished:
        task = self._forget(key)
        return Finished(task.number, outcome, max(1, task.starts))

    def _fetched(self, key: str) -> Finished | Died | None:
        """Event of a finished future whose outcome was not reported."""
        task = self._tasks[key]
        # The result of a pending task was lost with its worker, and Dask repeats the task.
        if task.future.status != "pending":
            try:
                outcome: Outcome = task.future.result(timeout=FETCH_S)
            except Exception as error:
                if (died := self._trouble(key, task, error)) is not None:
                    return died
            else:
                return self._finished(key, outcome)
        task.late = True
        return None

    def _trouble(self, key: str, task: _Task, error: Exception) -> Died | None:
        """Death of a sample, or None if its outcome was not fetched in time or lost."""
        name, status = type(error).__name__, task.future.status
        if name == "KilledWorker":
            worker: Any = getattr(error, "last_worker", None)
            certain = task.starts > 0 and getattr(worker, "nthreads", 0) == 1
            why = f"its worker {getattr(worker, 'address', '')} died"
            return Died(self._forget(key).number, task.starts, certain, why)
        if status == "cancelled" or "Cancelled" in name:
            raise StudyError(
                f"executor: sample {task.number} was cancelled there; is the Dask cluster still up?"
            ) from error
        if status != "error":
            return None
        if isinstance(error, (ImportError, AttributeError, TypeError, pickle.PickleError)):
            raise unfit(error) from error
        return Died(self._forget(key).number, max(1, task.starts), certain=False, why=told(error))

    def _forget(self, key: str) -> _Task:
        task = self._tasks.pop(key)
        # A future with an error would stay at the scheduler.
        task.future.release()
        return task


def on_cluster(cluster: Any, job: Job) -> Dask:
    """Uses a cluster of the caller through a new client."""
    distributed: Any = importlib.import_module("distributed")
    client = distributed.Client(cluster, set_as_default=False)
    try:
        return Dask(client, job, own=[client])
    except BaseException:
        client.close()
        raise


def local_cluster(wanted: int, job: Job) -> Dask:
    """A local cluster owned by the study, with one thread per worker."""
    check_script()
    dask: Any = importlib.import_module("dask")
    distributed: Any = importlib.import_module("distributed")
    own: list[Any] = []
    # Dask reports every death at once, and the study decides on further attempts.
    settings = {
        "distributed.scheduler.allowed-failures": 0,
        "distributed.scheduler.worker-saturation": 1.0,
    }
    try:
        with dask.config.set(settings):
            cluster = distributed.LocalCluster(
                n_workers=wanted,
                threads_per_worker=1,
                processes=True,
                # Samples leave no data in the memory of workers that Dask could manage.
                memory_limit=None,
                dashboard_address=":0",
                silence_logs=logging.CRITICAL,
                # The waiting process handles Ctrl-C.
                preload=["import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"],
            )
        own.append(cluster)
        client = distributed.Client(cluster, set_as_default=False)
        own.insert(0, client)
        return Dask(client, job, own, wanted)
    except BaseException as error:
        for thing in own:
            thing.close()
        if isinstance(error, (RuntimeError, OSError, TimeoutError)):
            raise StudyError(
                f"executor: Dask's LocalCluster does not start ({told(error)}); {GUARD}"
            ) from error
        raise


def _run_and_report(
    work: bytes, number: int, sample: Sample, topic: str, key: str
) -> Outcome:
    """Runs a sample on a worker and reports its start and its outcome."""
    distributed: Any = importlib.import_module("distributed")
    worker = distributed.get_worker()

    def report(outcome: Outcome | None) -> None:
        # Waits until the scheduler has the report, before the worker can die. Without reports attempts are counted
        # by deaths only, and outcomes are fetched.
        with contextlib.suppress(Exception):
            distributed.utils.sync(
                worker.loop,
                worker.scheduler.log_event,
                callback_timeout=REPORT_S,
                topic=topic,
                msg={"key": key, "outcome": outcome},
            )

    report(None)
    # Dask removes the folder of a worker that dies.
    outcome = run_sample(work, number, sample, worker.local_directory)
    report(outcome)
    return outcome


def _kill(cluster: Any) -> None:
    """Kills the workers of a local cluster; a request to close would wait for their samples."""
    for nanny in list(cluster.workers.values()):
        nanny.close_gracefully()
        os.kill(nanny.pid, signal.SIGKILL)


@contextlib.contextmanager
def _reached() -> Iterator[None]:
    """Raises a StudyError if the cluster does not answer."""
    try:
        yield
    except Exception as error:
        raise StudyError(f"executor: the Dask cluster is gone ({told(error)})") from error
