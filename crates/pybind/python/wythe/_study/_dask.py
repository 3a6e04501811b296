"""Behind a Dask client: samples on the workers of a cluster, be it this machine or a real one.

When a worker dies, Dask runs its tasks elsewhere, up to ``distributed.scheduler.allowed-failures`` times
(3 by default), and then gives up with ``KilledWorker``. It holds every task that the worker had to account, those
too that only waited there, and it repeats those whose results died with the worker. So each sample
reports its begin and its end by events of the scheduler: the begin counts attempts and tells the sample
that ran from one that waited; the end has the outcome, before a death can take it along.
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
from typing import Any

from wythe._study._errors import StudyError
from wythe._study._executors import Died, Finished, packed, told, unfit
from wythe._study._pool import GUARD
from wythe._study._samples import Sample
from wythe._study._worker import Job, Outcome, run_sample

# An outcome that was not heard is fetched; if that takes longer, its worker may have died with it [s].
FETCH_S = 5.0
# How often the workers are counted [s].
COUNTED_EVERY = 1.0
# A report waits so long for the scheduler, and is given up then [s].
REPORT_S = 10.0


def is_there() -> bool:
    """Whether dask.distributed is installed."""
    return importlib.util.find_spec("distributed") is not None


def is_client(thing: object) -> bool:
    """Whether this is a Dask client."""
    return any(
        base.__name__ == "Client" and base.__module__.partition(".")[0] == "distributed"
        for base in type(thing).__mro__
    )


def is_cluster(thing: object) -> bool:
    """Whether this is a Dask cluster."""
    return any(
        base.__name__ == "Cluster" and base.__module__.partition(".")[0] == "distributed"
        for base in type(thing).__mro__
    )


class Dask:
    """Behind a client."""

    def __init__(self, client: Any, job: Job, own: list[Any], wanted: int = 0) -> None:
        if getattr(client, "asynchronous", False):
            raise TypeError("executor: expected a Dask client that is not asynchronous")
        self._client = client
        # What is the study's own: a client, and then its cluster of so many workers.
        self._own = own
        self._wanted = wanted
        self._work = packed(job)
        self._topic = f"wythe-study-{uuid.uuid4().hex[:12]}"
        self._sent = 0
        # By key.
        self._futures: dict[str, Any] = {}
        self._numbers: dict[str, int] = {}
        self._starts: dict[str, int] = {}
        self._late: set[str] = set()
        self._happened: queue.SimpleQueue[tuple[str, Outcome | None]] = queue.SimpleQueue()
        self.workers = 1
        self._counted = -math.inf
        try:
            client.subscribe_topic(self._topic, self._heard)
        except Exception as error:
            raise _gone(error) from error
        self.room()

    def room(self) -> int:
        """Twice the threads and some, so that a cluster that adapts sees work and grows."""
        now = time.monotonic()
        if now - self._counted > COUNTED_EVERY:
            self._counted = now
            try:
                self.workers = sum(self._client.nthreads().values())
                # Dask gives up a worker that is killed while it starts.
                if self._wanted > self.workers:
                    self._own[-1].scale(self._wanted)
            except Exception as error:
                raise _gone(error) from error
        return 2 * self.workers + 8

    def submit(self, number: int, sample: Sample) -> None:
        """Sends a sample."""
        self._sent += 1
        key = f"wythe-sample-{self._topic[-12:]}-{number}-{self._sent}"
        self._numbers[key], self._starts[key] = number, 0
        try:
            future = self._client.submit(
                _run_and_report, self._work, number, sample, self._topic, key, key=key, pure=False
            )
        except Exception as error:
            raise _gone(error) from error
        self._futures[key] = future
        future.add_done_callback(lambda _: self._happened.put((key, None)))

    def wait(self, seconds: float) -> list[Finished | Died]:
        """What has happened."""
        end = time.monotonic() + seconds
        events: list[Finished | Died] = []
        for key in list(self._late):
            self._take(events, self._fetched(key))
        while not events:
            try:
                key, outcome = self._happened.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                break
            if key not in self._futures:
                continue
            if outcome is not None:
                events.append(self._finished(key, outcome))
            else:
                self._take(events, self._fetched(key))
        return events

    def close(self, finished: bool) -> None:
        """Cancels what waits; ends a cluster that is the study's own."""
        # The cluster may be gone already.
        with contextlib.suppress(Exception):
            self._client.unsubscribe_topic(self._topic)
            if self._futures:
                self._client.cancel(list(self._futures.values()), force=True)
        if not finished and self._wanted > 0:
            with contextlib.suppress(Exception):
                _kill(self._own[-1])
        for thing in self._own:
            with contextlib.suppress(Exception):
                thing.close()

    def _heard(self, event: Any) -> None:
        """A worker's report that a sample begins or has ended; called from the client's thread."""
        _, message = event
        key = message["key"]
        if message["outcome"] is not None:
            self._happened.put((key, message["outcome"]))
        else:
            self._starts[key] = self._starts.get(key, 0) + 1

    def _finished(self, key: str, outcome: Outcome) -> Finished:
        starts = max(1, self._starts[key])
        return Finished(self._forget(key), outcome, starts)

    def _fetched(self, key: str) -> Finished | Died | None:
        """What a future says that is done before its outcome was heard."""
        future = self._futures[key]
        if future.status == "pending":
            # Its worker took the result with it; it is on its way again.
            self._late.add(key)
            return None
        try:
            outcome: Outcome = future.result(timeout=FETCH_S)
        except Exception as error:
            return self._trouble(key, future.status, error)
        return self._finished(key, outcome)

    def _trouble(self, key: str, status: str, error: Exception) -> Died | None:
        name = type(error).__name__
        if name == "KilledWorker":
            worker: Any = getattr(error, "last_worker", None)
            starts = self._starts[key]
            certain = starts > 0 and getattr(worker, "nthreads", 0) == 1
            why = f"its worker {getattr(worker, 'address', '')} died"
            return Died(self._forget(key), starts, certain, why)
        if status == "cancelled" or "Cancelled" in name:
            raise StudyError(
                f"executor: sample {self._numbers[key]} was cancelled there; is the Dask cluster still up?"
            ) from error
        if status == "error":
            if isinstance(error, (ImportError, AttributeError, TypeError, pickle.PickleError)):
                raise unfit(error) from error
            starts = max(1, self._starts[key])
            return Died(self._forget(key), starts, certain=False, why=told(error))
        # Not fetched in time, or lost on the way.
        self._late.add(key)
        return None

    def _forget(self, key: str) -> int:
        # The error of a death would keep it at the scheduler.
        self._futures.pop(key).release()
        self._starts.pop(key)
        self._late.discard(key)
        return self._numbers.pop(key)

    @staticmethod
    def _take(events: list[Finished | Died], event: Finished | Died | None) -> None:
        if event is not None:
            events.append(event)


def on_cluster(cluster: Any, job: Job) -> Dask:
    """A cluster of the caller's, by a client of its own."""
    distributed: Any = importlib.import_module("distributed")
    client = distributed.Client(cluster, set_as_default=False)
    try:
        return Dask(client, job, own=[client])
    except BaseException:
        client.close()
        raise


def local_cluster(count: int | None, job: Job) -> Dask:
    """A cluster of this machine that is the study's own: one thread a worker, a worker a core."""
    dask: Any = importlib.import_module("dask")
    distributed: Any = importlib.import_module("distributed")
    own: list[Any] = []
    wanted = count or os.cpu_count() or 1
    # Every death is told at once, and how often a sample is tried is the study's to say.
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
                # Samples leave nothing in the workers' memory that Dask could manage.
                memory_limit=None,
                dashboard_address=":0",
                silence_logs=logging.CRITICAL,
                # Ctrl-C is for the process that waits.
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
    """Runs a sample on a worker, and reports its begin and its outcome."""
    distributed: Any = importlib.import_module("distributed")
    worker = distributed.get_worker()

    def report(outcome: Outcome | None) -> None:
        # Waits until the scheduler knows, lest a death be quicker. Without reports attempts are told from
        # deaths alone, and outcomes are fetched.
        with contextlib.suppress(Exception):
            distributed.utils.sync(
                worker.loop,
                worker.scheduler.log_event,
                callback_timeout=REPORT_S,
                topic=topic,
                msg={"key": key, "outcome": outcome},
            )

    report(None)
    # Dask removes the worker's folder when the worker dies.
    outcome = run_sample(work, number, sample, worker.local_directory)
    report(outcome)
    return outcome


def _kill(cluster: Any) -> None:
    """Ends the workers of a local cluster at once: asked to close, they would finish their samples first."""
    for nanny in list(cluster.workers.values()):
        nanny.close_gracefully()
        os.kill(nanny.pid, signal.SIGKILL)


def _gone(error: Exception) -> StudyError:
    return StudyError(f"executor: the Dask cluster is gone ({told(error)})")
