"""Executors of all kinds, workers that die, samples that fail."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from study_fakes import FakeModel, made, no_mapping, twice
from wythe import Study, StudyError, WorkerDied, study
from wythe._study import Workers

GRID = {"a": [1.0, 2.0, 3.0], "b": [0.0, 1.0]}
PEAKS = [3.0, 2.0, 6.0, 5.0, 9.0, 8.0]


@pytest.fixture(scope="module")
def workers() -> Iterator[Workers]:
    with Workers(3) as executor:
        yield executor


@pytest.fixture
def threads() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(3) as executor:
        yield executor


class Polled:
    """Futures without callbacks, as schedulers of clusters have them."""

    def __init__(self) -> None:
        self.calls = 0

    def submit(self, fn: Callable[..., Any], *args: Any) -> Any:
        self.calls += 1
        value, due = fn(*args), time.monotonic() + 0.02

        class Job:
            def done(self) -> bool:
                return time.monotonic() > due

            def result(self) -> Any:
                return value

        return Job()


class Failing:
    """An executor whose futures all raise."""

    _max_workers = 2

    def __init__(self, error: Exception) -> None:
        self.error = error

    def submit(self, fn: Callable[..., Any], *args: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_exception(self.error)
        return future


def test_every_executor_gives_the_same_table(
    workers: Workers, threads: ThreadPoolExecutor
) -> None:
    spawn = multiprocessing.get_context("spawn")
    tables = []
    with ProcessPoolExecutor(2, mp_context=spawn) as pool:
        for executor in (threads, workers, pool, Polled()):
            tables.append(study(FakeModel(), GRID, executor=executor, progress=False))
    assert list(tables[0]["peak_force_kN"]) == PEAKS
    assert list(tables[0]["gap_mm_highest"]) == [2.0] * 6
    assert all(list(table) == list(tables[0]) for table in tables)


def test_models_and_measures_may_be_functions(workers: Workers) -> None:
    table = study(
        made, samples={"ten": [1.0, 2.0]}, executor=workers, measure=twice, progress=False
    )
    assert list(table["twice"]) == [60.0, 120.0] and table.measures[-1] == "twice"


def test_functions_without_a_module_pass_with_cloudpickle(workers: Workers) -> None:
    pytest.importorskip("cloudpickle")
    table = study(
        lambda sample: made(sample), samples={"ten": [1.0]}, executor=workers, progress=False,
        measure=lambda results: {"half": results.summary["peak_force_kN"] / 2.0},
    )  # fmt: skip
    assert table[0]["half"] == 15.0


def test_what_cannot_be_sent_is_named(workers: Workers) -> None:
    with pytest.raises(TypeError, match="measure: expected something that can be pickled"):
        lock = threading.Lock()
        study(FakeModel(), GRID, executor=workers, measure=lambda _: {"x": lock}, progress=False)


def test_samples_that_fail_are_marked(threads: ThreadPoolExecutor) -> None:
    samples = [
        {"a": 1.0, "fail": False, "stop": "completed"},
        {"a": "impossible", "fail": False, "stop": "completed"},
        {"a": 3.0, "fail": True, "stop": "completed"},
        {"a": 4.0, "fail": False, "stop": "not_converged"},
    ]
    table = study(FakeModel(), samples=samples, executor=threads, progress=False)
    assert list(table["status"]) == ["completed", "failed", "failed", "not_converged"]
    assert table[1]["message"] == "ValueError: a: impossible"
    assert table[2]["message"] == "ValueError: this cannot be; fix: say something else"
    assert table[3]["peak_force_kN"] == 12.0 and table[3]["message"] == "lost its way"
    assert list(table["attempts"]) == [1] * 4 and table[1]["peak_force_kN"] is None


def test_a_key_that_no_sample_can_have_is_told_at_once(threads: ThreadPoolExecutor) -> None:
    with pytest.raises(ValueError, match="`unknown` is not a known key"):
        study(FakeModel(), {"unknown": [1, 2]}, executor=threads, progress=False)


def test_a_measure_that_is_none_is_said(threads: ThreadPoolExecutor) -> None:
    table = study(
        FakeModel(), {"a": [1.0]}, executor=threads, measure=no_mapping, progress=False
    )
    assert table[0]["status"] == "failed" and table[0]["peak_force_kN"] == 3.0
    assert table[0]["message"] == (
        "measure: TypeError: its result: expected a mapping of names to numbers, got 1.0"
    )


def test_trouble_of_the_machine_is_tried_again(
    threads: ThreadPoolExecutor, tmp_path: Path
) -> None:
    model = FakeModel(notes=str(tmp_path))
    table = study(model, {"trouble": [0, 2, 3]}, executor=threads, progress=False)
    assert list(table["status"]) == ["completed", "completed", "failed"]
    assert list(table["attempts"]) == [1, 3, 3]
    assert table[2]["message"] == "OSError: no space left"


def test_a_worker_that_dies_loses_only_its_sample(tmp_path: Path) -> None:
    samples = {"a": [float(n) for n in range(12)], "kill": [0, 0, 1, 0, -1, 0, 2, 0, 0, 0, -1, 0]}
    with Workers(3) as workers:
        table = study(
            FakeModel(notes=str(tmp_path)), samples=samples, executor=workers, progress=False
        )
    assert len(table) == 12
    lost = [row["sample"] for row in table if row["status"] == "lost"]
    assert lost == [5, 11]
    assert table[4]["message"] == "the worker process was killed by SIGKILL in attempt 3"
    assert {row["sample"]: row["attempts"] for row in table if row["attempts"] > 1} == {
        3: 2, 5: 3, 7: 3, 11: 3,
    }  # fmt: skip
    assert [row["status"] for row in table].count("completed") == 10


def test_a_worker_killed_from_outside_is_replaced() -> None:
    with Workers(2) as workers:
        killed: list[int] = []

        def kill(row: dict[str, Any]) -> None:
            if len(killed) < 2:
                # One that was killed is listed until its place is taken.
                killed.append(next(pid for pid in workers.pids() if pid not in killed))
                os.kill(killed[-1], signal.SIGKILL)

        table = study(
            FakeModel(sleep=0.1), {"a": range(12)}, executor=workers, progress=False, callback=kill
        )
        assert len(killed) == 2 and not set(killed) & set(workers.pids())
    assert list(table["status"]) == ["completed"] * 12
    assert list(table["peak_force_kN"]) == [3.0 * a for a in range(12)]


def test_a_broken_pool_of_the_callers_is_said_and_what_is_done_is_kept(tmp_path: Path) -> None:
    spawn = multiprocessing.get_context("spawn")
    samples = {"a": list(range(20)), "kill": [0] * 10 + [1] + [0] * 9}
    notes = tmp_path / "notes"
    notes.mkdir()
    model, out = FakeModel(notes=str(notes)), tmp_path / "out"
    with ProcessPoolExecutor(2, mp_context=spawn) as pool:
        with pytest.raises(StudyError, match="executor: it broke .* samples .*11.* under way") as error:
            study(model, samples=samples, executor=pool, progress=False, out=out)
    assert "of 20 samples are done and kept in" in str(error.value)
    assert error.value.study is not None and len(error.value.study) == len(Study.load(out)) > 5
    with Workers(2) as workers:
        table = study(model, samples=samples, executor=workers, progress=False, out=out)
    assert list(table["status"]) == ["completed"] * 20


def test_an_executor_that_takes_no_more_is_said() -> None:
    pool = ThreadPoolExecutor(1)
    pool.shutdown()
    with pytest.raises(StudyError, match=r"executor: it takes no more samples .* 0 of 6 samples"):
        study(FakeModel(), GRID, executor=pool, progress=False)


def test_executors_in_trouble() -> None:
    with pytest.raises(StudyError, match="a worker cannot take a sample .ModuleNotFoundError"):
        study(FakeModel(), GRID, executor=Failing(ModuleNotFoundError("wythe")), progress=False)
    with pytest.raises(StudyError, match="sample . was cancelled"):
        study(FakeModel(), GRID, executor=Failing(CancelledError()), progress=False)
    table = study(FakeModel(), GRID, executor=Failing(OSError("gone")), progress=False, retries=1)
    assert list(table["status"]) == ["lost"] * 6
    assert table[0]["message"] == "OSError: gone in attempt 2"


def test_processes_of_the_studys_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("wythe._study._dask.is_there", lambda: False)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    table = study(FakeModel(), GRID, executor=2, progress=False)
    assert list(table["peak_force_kN"]) == PEAKS
    assert list(tmp_path.iterdir()) == []


def test_a_stop_does_not_wait_for_what_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wythe._study._dask.is_there", lambda: False)
    samples = [{"a": 1.0, "sleep": 0.0}, {"a": 2.0, "sleep": 600.0}, {"a": 3.0, "sleep": 600.0}]
    table = study(
        FakeModel(), samples=samples, executor=2, progress=False, callback=lambda row: False
    )
    assert list(table["sample"]) == [1] and table.missing == (2, 3)


def test_workers_are_an_executor(workers: Workers) -> None:
    assert list(workers.map(abs, [-1, 2, -3])) == [1, 2, 3]
    with pytest.raises(ZeroDivisionError):
        workers.submit(divmod, 1, 0).result()
    with pytest.raises(WorkerDied, match="ended with exit code 3"):
        workers.submit(os._exit, 3).result()
    with pytest.raises((TypeError, AttributeError), match="pickle"):
        workers.submit(threading.Lock().acquire).result()
    with pytest.raises(RuntimeError, match="cannot be pickled"):
        workers.submit(threading.Lock).result()
    assert workers.submit(abs, -4).result() == 4
    with pytest.raises(ValueError, match="count: expected a whole number from 1, got 0"):
        Workers(0)


def test_workers_shut_down() -> None:
    workers = Workers(1)
    slow = workers.submit(time.sleep, 0.2)
    waiting = [workers.submit(abs, -1) for _ in range(3)]
    workers.shutdown(cancel_futures=True)
    assert slow.result() is None and all(future.cancelled() for future in waiting)
    with pytest.raises(RuntimeError, match="after shutdown"):
        workers.submit(abs, -1)
    assert workers.pids() == []
    killed = Workers(1)
    forever = killed.submit(time.sleep, 600.0)
    while not killed.pids():
        time.sleep(0.01)
    killed.kill()
    assert isinstance(forever.exception(), WorkerDied) and killed.pids() == []
