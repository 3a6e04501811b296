"""Ctrl-C: it stops a run after the increment in hand, keeps what there is, and the run can go on."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import wythe
from helpers import environment

#: Runs the model in the file, and tells how it ended and how long after its last increment was written.
RUN = """
import json, os, signal, sys, time, wythe
# What a shell starts in its background is deaf to Ctrl-C.
signal.signal(signal.SIGINT, signal.default_int_handler)
model, out = wythe.Model.from_toml(sys.argv[1]), sys.argv[2]
callback = (lambda row: None) if sys.argv[3] == "watched" else None
try:
    model.run(out, callback=callback)
    print("completed")
except KeyboardInterrupt as error:
    ended = time.time()
    written = os.stat(os.path.join(out, "history.csv")).st_mtime
    results = error.results
    print(json.dumps({
        "kind": type(error).__name__,
        "message": str(error),
        "after_s": ended - written,
        "status": results.status,
        "increments": results.history.increments,
        "peak": results.peak_force,
    }))
"""

#: Between the end of an increment and the exception [s]: the folder is made whole, no more. An increment of
#: this wall takes a tenth of that.
LIMIT = 0.1


@pytest.fixture(autouse=True)
def hears() -> Iterator[None]:
    """What a shell starts in its background is deaf to Ctrl-C, and so are these tests then."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wall that takes some seconds, as a file."""
    wall = wythe.templates.shear_wall(drive="0.6 mm", length="420.5 mm", courses=3)
    wall = wall.with_(steps__1__increments={"initial": 0.005, "max": 0.005})
    return Path(wall.save(tmp_path_factory.mktemp("long") / "wall.toml"))


@pytest.fixture(scope="module")
def whole(long: Path) -> wythe.Results:
    """The same, never stopped."""
    return wythe.Model.from_toml(long).run(long.parent / "whole.out")


def interrupted(model: Path, out: Path, watched: str, rows: int) -> dict[str, object]:
    """Runs the model in another process, sends it SIGINT when its history has this many rows, and returns what
    it tells.
    """
    arguments = [sys.executable, "-c", RUN, str(model), str(out), watched]
    process = subprocess.Popen(arguments, env=environment(), stdout=subprocess.PIPE, text=True)
    history, pause = out / "history.csv", threading.Event()
    for _ in range(6000):
        if history.is_file() and history.read_bytes().count(b"\n") > rows:
            break
        pause.wait(0.005)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert said.strip() != "completed", "the run was over before the signal came"
    told: dict[str, object] = json.loads(said)
    return told


@pytest.mark.parametrize("watched", ["watched", "alone"])
def test_an_interrupted_run_ends_at_once_and_goes_on(
    watched: str, long: Path, whole: wythe.Results, tmp_path: Path
) -> None:
    # The machine may be busy with other things at that moment: the best of three counts.
    delays: list[float] = []
    told: dict[str, object] = {}
    out = tmp_path
    while not delays or (min(delays) >= LIMIT and len(delays) < 3):
        out = tmp_path / f"{len(delays)}.out"
        told = interrupted(long, out, watched, rows=20)
        assert told["kind"] == "RunInterrupted"
        assert "results.resume() goes on" in str(told["message"])
        assert told["status"] == "interrupted"
        after = told["after_s"]
        assert isinstance(after, float)
        delays.append(after)
    assert min(delays) < LIMIT

    run = wythe.Results(out)
    assert run.history.increments == told["increments"]
    assert 20 <= run.history.increments < whole.history.increments
    assert run.peak_force == told["peak"]
    assert (run.history.force_kN == whole.history.force_kN[: run.history.increments]).all()
    resumed = run.resume()
    assert resumed.status == "completed"
    history = Path(whole.path, "history.csv").read_bytes()
    assert Path(out, "history.csv").read_bytes() == history
    assert (resumed.frame().stress == whole.frame().stress).all()


def test_an_interrupt_in_the_callback_is_one(model: wythe.Model, tmp_path: Path) -> None:
    def callback(row: wythe.Increment) -> None:
        if row.increment == 5:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(wythe.RunInterrupted) as raised:
        model.run(tmp_path / "out", callback=callback)
    assert isinstance(raised.value.__cause__, KeyboardInterrupt)
    results = raised.value.results
    assert results.path == str(tmp_path / "out")
    assert results.history.increments >= 5
    assert results.resume().status == "completed"


def test_results_of_an_interrupted_run_without_a_folder(model: wythe.Model) -> None:
    def callback(row: wythe.Increment) -> None:
        raise KeyboardInterrupt

    with pytest.raises(wythe.RunInterrupted) as raised:
        model.run(callback=callback)
    results = raised.value.results
    assert results.is_temporary
    del raised
    assert results.history.increments == 1
    assert results.resume().history.increments == 20
    # It has read the folder anew.
    assert results.history.increments == 20
    assert results.status == "completed"


def test_an_interrupt_elsewhere_is_not_hidden() -> None:
    """Before there is anything to go on with, it is the usual exception."""
    with pytest.raises(KeyboardInterrupt) as raised:
        signal.raise_signal(signal.SIGINT)
    assert not isinstance(raised.value, wythe.RunInterrupted)
