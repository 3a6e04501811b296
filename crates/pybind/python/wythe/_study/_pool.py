"""Worker processes on this machine that tolerate the death of a process.

A concurrent.futures.ProcessPoolExecutor breaks as a whole when one of its processes dies, and does not identify the
call. Here each worker is a thread that supervises one process. When the process dies, the future of its call gets a
:class:`WorkerDied`, and the thread starts another process.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import queue
import signal
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from typing import Any, NamedTuple, ParamSpec, TypeVar

from wythe._study._errors import StudyError
from wythe._study._samples import whole

P = ParamSpec("P")
T = TypeVar("T")

GUARD = (
    "a script that starts workers must do so under `if __name__ == \"__main__\":`, because each worker "
    "imports the script"
)

# Exit code of a worker whose script starts workers while it is imported.
UNGUARDED = 87

# Number of attempts to start a process that is killed during its start.
STARTS = 3


def leave_import() -> None:
    """Ends this process without a traceback if it is a worker that still imports the script: the waiting process
    says what to write."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise SystemExit(UNGUARDED)


def check_script() -> None:
    """Rejects a script that cannot be imported by workers, before they start and write long tracebacks: one that knows
    nothing of ``__name__`` starts the study again."""
    leave_import()
    main = sys.modules.get("__main__")
    path = getattr(main, "__file__", None)
    if path is None or getattr(main, "__spec__", None) is not None:
        return
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
    except (OSError, UnicodeDecodeError):
        return
    if "__name__" not in text and "parent_process" not in text:
        raise WorkerBroken(GUARD)


class WorkerDied(Exception):
    """The process of a call has died."""


class WorkerBroken(StudyError):
    """A worker process cannot start."""


class Workers(Executor):
    """A number of worker processes on this machine (one per core by default), each with one call at a time.

    It is an executor of concurrent.futures whose workers may be killed: only the call of the killed worker is lost,
    with :class:`WorkerDied`, and another process replaces it. Processes start on demand and import the script again
    (``spawn``). They ignore Ctrl-C, which the waiting process handles, and end with that process.
    """

    def __init__(self, count: int | None = None) -> None:
        check_script()
        if count is None:
            count = os.cpu_count() or 1
        self._max_workers = whole("count", count, 1)
        self._calls: queue.SimpleQueue[_Call | None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._workers: list[_Worker] = []
        self._shut = False

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Submits a call; its arguments and result are pickled."""
        future: Future[T] = Future()
        with self._lock:
            if self._shut:
                raise RuntimeError("cannot submit after shutdown")
            self._calls.put(_Call(future, fn, args, kwargs))
            if len(self._workers) < self._max_workers:
                self._workers.append(_Worker(self._calls))
        return future

    def pids(self) -> list[int]:
        """Numbers of the running processes."""
        with self._lock:
            found = [worker.pid() for worker in self._workers]
        return [pid for pid in found if pid is not None]

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends the workers after their calls."""
        self._finish(wait, cancel_futures, kill=False)

    def kill(self) -> None:
        """Ends the workers and their calls at once."""
        self._finish(wait=True, cancel=True, kill=True)

    def _finish(self, wait: bool, cancel: bool, kill: bool) -> None:
        with self._lock:
            self._shut = True
            workers = list(self._workers)
        with contextlib.suppress(queue.Empty):
            while cancel:
                if (call := self._calls.get_nowait()) is not None:
                    call.future.cancel()
        for worker in workers:
            if kill:
                worker.kill()
            # One end for each worker; more of them do no harm.
            self._calls.put(None)
        for worker in workers if wait else ():
            worker.thread.join()


class _Call(NamedTuple):
    """A submitted call."""

    future: Future[Any]
    fn: Callable[..., Any]
    args: Any
    kwargs: Any


class _Worker:
    """One thread and its process."""

    def __init__(self, calls: queue.SimpleQueue[_Call | None]) -> None:
        self._calls = calls
        self._process: SpawnProcess | None = None
        self._pipe: Connection | None = None
        self._killed = False
        self._lock = threading.Lock()
        # A daemon thread does not block the end of a program without shutdown().
        self.thread = threading.Thread(target=self._serve, name="wythe worker", daemon=True)
        self.thread.start()

    def pid(self) -> int | None:
        """Number of the process, if it is running."""
        process = self._process
        return process.pid if process is not None and process.is_alive() else None

    def kill(self) -> None:
        """Ends the process for good."""
        with self._lock:
            self._killed = True
            if self._process is not None:
                self._process.kill()

    def _serve(self) -> None:
        while (call := self._calls.get()) is not None:
            if call.future.set_running_or_notify_cancel():
                try:
                    result = self._ask(call)
                except BaseException as error:
                    call.future.set_exception(error)
                else:
                    call.future.set_result(result)
            # Frees the arguments before the thread waits for the next call.
            del call
        if self._pipe is not None:
            self._pipe.close()
        if self._process is not None:
            self._process.join()

    def _ask(self, call: _Call) -> Any:
        # Pickled first, so that an error of pickling is not taken for a death of the process.
        message = pickle.dumps((call.fn, call.args, call.kwargs))
        pipe, process = self._begin()
        try:
            pipe.send_bytes(message)
            # A dead process may have left its answer in the pipe, or children that keep the pipe open.
            if pipe not in wait([pipe, process.sentinel]):
                raise EOFError
            good, value = pickle.loads(pipe.recv_bytes())
        except (EOFError, OSError):
            raise WorkerDied(f"the worker process {_cause(process)}") from None
        if not good:
            raise value
        return value

    def _begin(self) -> tuple[Connection, SpawnProcess]:
        """A ready process, started if necessary."""
        if self._process is not None and self._pipe is not None and self._process.is_alive():
            return self._pipe, self._process
        cause, code = "", None
        for _ in range(STARTS):
            pipe, process = self._started()
            with contextlib.suppress(EOFError, OSError):
                if pipe in wait([pipe, process.sentinel]):
                    pipe.recv_bytes()
                    return pipe, process
            cause, code = _cause(process), process.exitcode
            # Only a killed process is started again; one that ended by itself would end again.
            if code is not None and code >= 0:
                break
        if self._killed:
            raise WorkerDied("the worker processes were ended")
        if code == UNGUARDED:
            raise WorkerBroken(GUARD)
        raise WorkerBroken(
            f"a worker process cannot start: it {cause}. What it wrote is above; {GUARD}"
        )

    def _started(self) -> tuple[Connection, SpawnProcess]:
        context = multiprocessing.get_context("spawn")
        with self._lock:
            if self._killed:
                raise WorkerDied("the worker processes were ended")
            if self._pipe is not None:
                self._pipe.close()
            self._pipe, theirs = context.Pipe()
            self._process = context.Process(target=_work, args=(theirs,), daemon=True)
            self._process.start()
            theirs.close()
            return self._pipe, self._process


def _cause(process: SpawnProcess) -> str:
    """Description of the end of a process."""
    process.join()
    code = process.exitcode
    if code is not None and code < 0:
        try:
            return f"was killed by {signal.Signals(-code).name}"
        except ValueError:
            return f"was killed by signal {-code}"
    return f"ended with exit code {code}"


def _work(pipe: Connection) -> None:
    """Main function of a worker process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    pipe.send_bytes(b"ready")
    while True:
        try:
            message = pipe.recv_bytes()
        except (EOFError, OSError):
            return
        try:
            fn, args, kwargs = pickle.loads(message)
            answer = (True, fn(*args, **kwargs))
        except BaseException as error:
            answer = (False, error)
        try:
            packed = pickle.dumps(answer)
        except Exception:
            packed = pickle.dumps((False, RuntimeError(f"cannot be pickled: {answer[1]!r}")))
        pipe.send_bytes(packed)


def _end_with_parent() -> None:
    """Ends this process when its parent has died, even during a call."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
