"""Runs: how they end, what they leave, who watches."""

from __future__ import annotations

import gc
import io
import os
import re
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import wythe
from helpers import lines, python

#: What a run without pictures of its own choice leaves.
FILES = {
    ".lock",
    "checkpoint.bin",
    "crack_pattern.svg",
    "history.csv",
    "load_displacement.svg",
    "model.toml",
    "results.interfaces.vtkhdf",
    "results.vtkhdf",
    "run.mcap",
    "summary.json",
}


def test_a_run_completes(model: wythe.Model) -> None:
    run = model.run()
    assert run.status == "completed"
    assert run.message == ""
    assert run.summary["status"] == "completed"
    assert run.peak_force == pytest.approx(5.58, rel=0.02)
    assert run.model == model


def test_the_folder_has_every_file(model: wythe.Model, tmp_path: Path) -> None:
    run = model.run(tmp_path / "new" / "couplet.out")
    assert run.path == str(tmp_path / "new" / "couplet.out")
    assert not run.is_temporary
    assert set(os.listdir(run.path)) == FILES
    assert set(os.listdir(model.with_(output__mcap=False).run(run.path).path)) == FILES - {
        "run.mcap"
    }


def test_a_temporary_folder_goes_with_its_object(model: wythe.Model) -> None:
    run = model.run()
    folder, frame = Path(run.path), run.frame()
    assert run.is_temporary
    assert folder.is_dir()
    with pytest.raises(TypeError, match="out=DIR"):
        run.__reduce__()
    del run
    gc.collect()
    assert not folder.parent.exists()
    # What is open stays readable.
    assert frame.displacement.shape == (75, 3)


def test_a_temporary_folder_goes_with_the_process(model: wythe.Model, tmp_path: Path) -> None:
    path = model.save(tmp_path / "couplet.toml")
    done = python(
        "-c", f"import wythe; run = wythe.Model.from_toml({path!r}).run(); print(run.path)"
    )
    assert done.returncode == 0, done.stderr
    assert re.search(r"wythe-\w+/run$", done.stdout.strip())
    assert not Path(done.stdout.strip()).parent.exists()


def test_a_fork_leaves_the_folder(model: wythe.Model) -> None:
    run = model.run()
    child = os.fork()
    if child == 0:
        del run
        gc.collect()
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
    assert Path(run.path).is_dir()


def test_the_threads_do_not_show(tmp_path: Path) -> None:
    """Histories and fields are the same to the last bit on any number of threads."""
    wall = wythe.templates.shear_wall(drive="0.1 mm", length="420.5 mm", courses=3)
    runs = [wall.run(tmp_path / f"{n}", threads=n) for n in (1, 2, 4)]
    histories = {Path(run.path, "history.csv").read_bytes() for run in runs}
    assert len(histories) == 1
    assert [run.summary["threads"] for run in runs] == [1, 2, 4]
    stresses = {run.frame().stress.tobytes() for run in runs}
    assert len(stresses) == 1


def test_more_threads_than_cores_are_told_and_few_are_taken(
    model: wythe.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wythe._run._cores", lambda: 1)
    with pytest.warns(RuntimeWarning, match=r"threads: 5000 are more than the cores .* \(1\), .* 4 are taken") as told:
        run = model.run(threads=5000)
    assert run.summary["threads"] == 4
    assert told[0].filename == __file__
    with pytest.warns(RuntimeWarning, match="2 are taken"):
        model.run(threads=2)


def test_the_callback_sees_every_increment(model: wythe.Model) -> None:
    seen: list[wythe.Increment] = []
    run = model.run(callback=seen.append)
    assert [row.increment for row in seen] == list(range(1, run.history.increments + 1))
    for name, column in run.history.items():
        # Reactions and the like have no attribute of an increment.
        if name != "driven" and name not in run.history.probes:
            assert [getattr(row, name) for row in seen] == column.tolist(), name


def test_probes_are_in_increments_and_history() -> None:
    slide = wythe.build.blocks(
        [
            wythe.build.block("lower", "stone", [40, 20, 10]),
            wythe.build.block("upper", "stone", [40, 20, 10], [0, 0, 10]),
        ],
        materials={"stone": wythe.build.elastic("5 GPa", 0.2)},
        interfaces={"dry": wythe.build.dry_joint(0.5)},
        contacts=[wythe.build.contact("dry")],
        supports=[wythe.build.support("lower.bottom")],
        probes=[wythe.build.probe("slip", "x", "upper.bottom", minus="lower.top")],
        steps=[
            wythe.build.preload("1 MPa", face="upper.top"),
            wythe.build.drive("0.02 mm", face="upper.top", free=["z"]),
        ],
    )
    slips: list[float] = []
    run = slide.run(callback=lambda row: slips.append(row.probes["slip_mm"]))
    assert run.history.probes[:2] == ("slip_mm", "base_shear_kN")
    assert run.history.slip_mm.tolist() == slips
    assert "slip_mm" in dir(run.history)
    assert 0.0 < slips[-1] < 0.02
    assert run.summary["probes"]["slip_mm"]["last"] == slips[-1]


@pytest.mark.parametrize("no", [False, np.False_])
def test_the_callback_may_stop(model: wythe.Model, tmp_path: Path, no: bool) -> None:
    framed = model.with_(output__every=1)
    run = framed.run(tmp_path / "out", callback=lambda row: no if row.increment == 3 else None)
    assert run.status == run.verdict_kind == "stopped"
    assert run.history.increments == 3
    assert "stopped" in run.message
    assert set(os.listdir(run.path)) == FILES


def test_only_false_stops(model: wythe.Model) -> None:
    answers: list[Any] = [0, "", None, [], True, "stop"]
    run = model.run(callback=lambda row: answers[row.increment % len(answers)])
    assert run.status == "completed"


def test_an_exception_of_the_callback_propagates(model: wythe.Model, tmp_path: Path) -> None:
    class Mine(Exception):
        pass

    def callback(row: wythe.Increment) -> None:
        if row.increment == 4:
            raise Mine("enough")

    with pytest.raises(Mine, match="enough"):
        model.with_(output__every=1).run(tmp_path / "out", callback=callback)
    run = wythe.Results(tmp_path / "out")
    assert (run.status, run.history.increments) == ("interrupted", 4)
    assert set(os.listdir(run.path)) == FILES
    whole = model.run(tmp_path / "whole")
    assert lines(Path(run.path, "history.csv")) == lines(Path(whole.path, "history.csv"))[:5]


def test_other_threads_go_on(model: wythe.Model) -> None:
    """Without the interpreter's lock: a thread that counts, counts on."""
    ended = threading.Event()
    counted: list[float] = []

    def count() -> None:
        while not ended.is_set():
            counted.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    began = time.monotonic()
    wythe.templates.couplet().run(threads=1)
    took = time.monotonic() - began
    ended.set()
    thread.join()
    # A lock held for the run would leave a hole as long as it.
    assert np.diff(counted).max() < took / 2


def test_runs_side_by_side_in_threads(model: wythe.Model) -> None:
    runs: list[wythe.Results] = []
    threads = [threading.Thread(target=lambda: runs.append(model.run(threads=1))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({Path(run.path, "history.csv").read_bytes() for run in runs}) == 1
    assert len({run.path for run in runs}) == 4


def test_progress_follows_on_standard_error(
    model: wythe.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = io.StringIO()
    monkeypatch.setattr(sys, "stderr", said)
    model.run(progress=True)
    part, first, *_, last = said.getvalue().splitlines()
    assert part.endswith("y = 49 mm and x = 102 mm: a quarter of it is solved")
    assert re.match(r"couplet: +\d+ %  peak  0\.\d+ mm  1\.\d+ kN  \d+\.\d s", first)
    assert re.match(r"couplet: completed, peak 5\.\d+ kN at 0\.\d+ mm, 20 increments in \d", last)
    said.truncate(0)
    model.run()
    assert said.getvalue().strip("\0") == ""


def test_a_terminal_has_one_line(model: wythe.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    said = Terminal()
    monkeypatch.setattr(sys, "stderr", said)
    # Of a part of it a line would tell.
    model.with_(fidelity="full").run(progress=True)
    text = said.getvalue()
    assert text.count("\n") == 1
    assert text.startswith("\r")
    *_, last = text.split("\r")
    # It covers what stood there.
    assert len(last.rstrip("\n")) >= len(text.split("\r")[-2].rstrip())


def test_a_notebook_has_one_line(model: wythe.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    shell = SimpleNamespace(kernel=None)
    for kernel, count in ((shell, 1), (SimpleNamespace(), 2)):
        said = io.StringIO()
        monkeypatch.setattr(sys, "stderr", said)
        # Whoever has imported IPython is not in a notebook yet.
        ipython = SimpleNamespace(get_ipython=lambda kernel=kernel: kernel)
        monkeypatch.setitem(sys.modules, "IPython", ipython)
        # Of a part of it a line would tell.
        model.with_(fidelity="full").run(progress=True)
        assert said.getvalue().count("\n") == count


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"out": 3}, "out: expected a path (str or os.PathLike), got 3"),
        ({"threads": True}, "threads: expected a whole number from 1, or None, got True"),
        ({"threads": 2.0}, "threads: expected a whole number from 1, or None, got 2.0"),
        ({"threads": 0}, "threads: expected a whole number from 1, got 0"),
        ({"progress": 1}, "progress: expected True or False, got 1"),
        ({"callback": 3}, "callback: expected a function of an Increment, got 3"),
        (
            {"callback": np.zeros((2, 3))},
            "callback: expected a function of an Increment, got an array of shape (2, 3)",
        ),
    ],
)
def test_wrong_arguments_are_named(
    model: wythe.Model, arguments: dict[str, Any], told: str
) -> None:
    with pytest.raises((TypeError, ValueError)) as raised:
        model.run(**arguments)
    assert str(raised.value) == told


def test_a_callback_sees_all_columns(model: wythe.Model, tmp_path: Path) -> None:
    seen: list[dict[str, float]] = []
    run = model.run(tmp_path / "out", callback=lambda row: seen.append(dict(row.probes)))
    assert list(seen[-1]) == list(run.history.probes)
    assert "base_shear_kN" in seen[-1]
    for name, value in seen[-1].items():
        assert value == pytest.approx(run.history[name][-1], rel=1e-12), name
