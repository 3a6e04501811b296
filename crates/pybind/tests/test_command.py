"""The command and the package are one program: the same histories, bit for bit, from the same deck."""

from __future__ import annotations

import json
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest
import wythe
from helpers import TARGET, environment, python

#: The command as cargo builds it.
BUILT = TARGET / "release" / "wythe"


@pytest.fixture(scope="module")
def deck(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wall whose bricks crack."""
    wall = wythe.templates.shear_wall(drive="0.3 mm", length="420.5 mm", courses=3)
    return Path(wall.save(tmp_path_factory.mktemp("command") / "wall.toml"))


@pytest.fixture(scope="module")
def python_run(deck: Path) -> wythe.Results:
    return wythe.Model.from_toml(deck).run(deck.parent / "python.out")


def same(run: wythe.Results, folder: Path) -> None:
    assert Path(run.path, "history.csv").read_bytes() == (folder / "history.csv").read_bytes()
    assert Path(run.path, "model.toml").read_bytes() == (folder / "model.toml").read_bytes()
    assert Path(run.path, "run.mcap").read_bytes() == (folder / "run.mcap").read_bytes()
    other = wythe.Results(folder)
    assert (run.frame().stress == other.frame().stress).all()
    assert run.peak_force == other.peak_force


def test_the_module_runs_as_the_package(deck: Path, python_run: wythe.Results) -> None:
    out = deck.parent / "module.out"
    done = python("-m", "wythe", "run", str(deck), "--out", str(out), "--quiet", folder=deck.parent)
    assert done.returncode == 0, done.stderr
    same(python_run, out)


def test_the_command_runs_as_the_package(deck: Path, python_run: wythe.Results) -> None:
    assert BUILT.is_file(), "the command is not built: cargo build --release"
    out = deck.parent / "command.out"
    done = subprocess.run(
        [BUILT, "run", deck, "--out", out, "--quiet"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    same(python_run, out)


def test_one_resumes_what_the_other_began(deck: Path, python_run: wythe.Results) -> None:
    out = deck.parent / "half.out"
    half = wythe.Model.from_toml(deck).run(out, callback=lambda row: row.increment < 20)
    assert half.status == "stopped"
    done = python("-m", "wythe", "resume", str(out), "--quiet")
    assert done.returncode == 0, done.stderr
    assert wythe.Results(out).status == "completed"
    history = Path(python_run.path, "history.csv").read_bytes()
    assert (out / "history.csv").read_bytes() == history


def test_overrides_are_those_of_the_command(deck: Path) -> None:
    out = deck.parent / "other.out"
    short = ("--set", "steps.1.displacement=0.05 mm", "--set", "output.every=1")
    done = python("-m", "wythe", "run", str(deck), "--out", str(out), "--quiet", *short)
    assert done.returncode == 0, done.stderr
    changed = wythe.Model.from_toml(deck, {"steps.1.displacement": "0.05 mm", "output.every": 1})
    same(changed.run(deck.parent / "changed.out"), out)


def test_exit_codes_are_those_of_the_command(
    deck: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert wythe.command(["check", str(deck)]) == 0
    assert "7 units" in capfd.readouterr().out
    assert wythe.command(["check", str(deck), "--set", "wall.courses=0"]) == 2
    assert "wall.courses" in capfd.readouterr().err
    assert wythe.command(["nonsense"]) == 2
    assert wythe.command(["info", str(tmp_path / "none")]) == 4
    assert python("-m", "wythe", "info", str(tmp_path / "none")).returncode == 4


def test_arguments_must_be_texts() -> None:
    for wrong in ("check wall.toml", ["check", 3]):
        with pytest.raises(TypeError, match="arguments: expected a sequence of str"):
            wythe.command(wrong)  # type: ignore[arg-type]


def test_checks_are_those_of_the_command(deck: Path) -> None:
    path = deck.parent / "warned.toml"
    text = wythe.templates.text("couplet").replace('f_t = "0.28 MPa"', 'f_t = "2 MPa"')
    path.write_text(text)
    told = json.loads(python("-m", "wythe", "check", str(path), "--json").stdout)
    found = wythe.Model.from_toml(path).check()
    assert found.ok is told["ok"]
    assert [(w.key, w.line, w.column, w.message) for w in found.warnings] == [
        (w["key"], w["line"], w["column"], w["message"]) for w in told["warnings"]
    ]
    assert list(found.notes) == told["notes"]
    assert found.memory_MB == pytest.approx(told["memory_MB"])
    assert list(found.processor_time_s) == pytest.approx(told["processor_time_s"])
    assert found.elements == told["sizes"]["elements"]


def test_the_entry_point_of_the_wheel(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    from wythe.__main__ import main

    monkeypatch.setattr(sys, "argv", ["wythe", "--version"])
    assert main() == 0
    assert wythe.__version__ in capfd.readouterr().out
    monkeypatch.delitem(sys.modules, "wythe.__main__")
    with pytest.raises(SystemExit) as raised:
        runpy.run_module("wythe", run_name="__main__")
    assert raised.value.code == 0


def test_the_version_is_that_of_the_runs(python_run: wythe.Results) -> None:
    assert re.fullmatch(r"\d+\.\d+\.\d+", wythe.__version__)
    assert python_run.version == python_run.summary["version"] == wythe.__version__


def test_ctrl_c_ends_the_command_with_130(tmp_path: Path) -> None:
    deck = wythe.templates.shear_wall().save(tmp_path / "wall.toml")
    arguments = [sys.executable, "-m", "wythe", "run", deck, "--quiet"]
    process = subprocess.Popen(arguments, env=environment(), stderr=subprocess.DEVNULL)
    history = tmp_path / "wall.out" / "history.csv"
    try:
        while not (history.is_file() and history.read_bytes().count(b"\n") > 2):
            assert process.poll() is None
        process.send_signal(2)
        assert process.wait(timeout=60) == 130
    finally:
        process.kill()
    assert wythe.Results(history.parent).status == "interrupted"
