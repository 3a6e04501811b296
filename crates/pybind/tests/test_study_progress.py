"""How a study tells how far it is."""

from __future__ import annotations

import io
import sys
import types
from typing import Any

import pytest

from study_fakes import FakeModel
from wythe import study
from wythe._study import _progress
from wythe._study._progress import Lines, Progress, duration, terminal


def test_the_line_tells_what_is_done_and_the_pace() -> None:
    progress = Progress(200, 40, None)
    assert progress.line(3.0) == "study: 40 of 200 done, 160 left, waiting for workers"
    progress.workers = 4
    assert progress.line(3.0) == "study: 40 of 200 done, 160 left"
    # The pace is that of this call, not of what the journal had.
    progress.done, progress.failed, progress.unconverged = 60, 2, 1
    assert (
        progress.line(60.0)
        == "study: 60 of 200 done, 1 not converged, 2 failed, 140 left, 20.0/min, 7 min to go"
    )
    progress.done = 200
    assert progress.line(80.0).endswith("0 left, 2.0/s, took 1 min")


def test_times_are_said_as_people_do() -> None:
    told = [duration(seconds) for seconds in (0.0, 59.4, 90.0, 5400.0, 300_000.0)]
    assert told == ["0 s", "59 s", "2 min", "1.5 h", "3.5 d"]


def test_a_terminals_line_is_renewed_in_place() -> None:
    stream = io.StringIO()
    sink = terminal(stream)
    for done in range(1000):
        sink.show(f"{done}", done, last=False)
    sink.show("end", 1000, last=True)
    written = stream.getvalue()
    assert written.endswith("\r\x1b[Kend\n") and written.count("\n") == 1
    assert written.count("\r") < 100


def test_a_log_has_few_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.0]
    monkeypatch.setattr("time.monotonic", lambda: clock[0])
    stream = io.StringIO()
    sink = Lines(stream, 200)
    for done in range(201):
        clock[0] += 1.0
        sink.show(f"{done}", done, last=done == 200)
        sink.show(f"{done}", done, last=done == 200)
    assert stream.getvalue().split() == [str(done) for done in range(0, 201, 20)]


def test_a_notebook_has_one_line_that_is_renewed(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[str] = []

    class Handle:
        def update(self, data: dict[str, str], raw: bool) -> None:
            shown.append(data["text/plain"])

    def display(data: Any, raw: bool, display_id: bool) -> Handle:
        return Handle()

    ipython: Any = types.ModuleType("IPython")
    ipython.get_ipython = lambda: types.SimpleNamespace(kernel=object())
    module: Any = types.ModuleType("IPython.display")
    module.display = display
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", module)
    sink = _progress.sink(10)
    sink.show("begun", 0, last=False)
    sink.show("too soon", 1, last=False)
    sink.show("done", 10, last=True)
    assert shown == ["begun", "done"]


def test_silence_is_silent(capsys: pytest.CaptureFixture[str]) -> None:
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(1) as pool:
        study(FakeModel(), {"a": [1, 2]}, executor=pool, progress=False)
        assert capsys.readouterr().err == ""
        study(FakeModel(), {"a": [1, 2]}, executor=pool)
    told = capsys.readouterr().err.splitlines()
    assert told[-1].startswith("study: 2 of 2 done, 0 left")
