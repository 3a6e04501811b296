"""Calibrations of couplets: intervals, executors, the job file and the command."""

from __future__ import annotations

import json
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import wythe
from calibration_coverage import FORWARD, PARAMETERS, SHEAR, TENSION, TRUE, exact, held, scattered
from helpers import EXAMPLES, python
from wythe import Workers, calibrate
from wythe._calibrate._read import toml_of

pytest.importorskip("scipy")

JOB = """
title = "Couplet"
fit = { differences = "forward", tolerance = 1e-3 }

[parameters.f_t]
key = "interfaces.joint.f_t"
start = "0.2 MPa"
bounds = ["0.05 MPa", "0.8 MPa"]

[[tests]]
name = "tension"
deck = "couplet.toml"
set = ["wall.mesh=[3, 2, 1]", "steps.1.displacement=0.02 mm"]
curves = ["pulled.csv"]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A job with its deck and curve."""
    x = np.linspace(0.001, 0.02, 20)
    curve = scattered(x, exact(TENSION, x), np.random.default_rng(2))
    rows = "".join(f"{a:.4f},{b:.4f}\n" for a, b in curve)
    (tmp_path / "pulled.csv").write_text(f"# synthetic\ndisplacement_mm,force_kN\n{rows}")
    (tmp_path / "couplet.toml").write_text(wythe.templates.text("couplet"))
    (tmp_path / "joint.toml").write_text(JOB)
    return tmp_path


def test_intervals_hold_the_true_values_in_nine_of_ten_seeds() -> None:
    # Of ten intervals of 95 % one may miss; python crates/pybind/tests/calibration_coverage.py has more seeds.
    counts = held(10)
    assert min(counts.values()) >= 9, counts


def test_every_executor_gives_the_same_bits() -> None:
    x = np.linspace(0.01, 0.58, 30)
    curve = scattered(x, exact(SHEAR, x), np.random.default_rng(1))
    only = {name: PARAMETERS[name] for name in ("c", "mu")}
    found = []
    with ThreadPoolExecutor(2) as threads, Workers(2) as workers:
        for executor in (threads, workers, 1):
            test = {"name": "shear", "deck": SHEAR, "curves": [curve]}
            fit = calibrate(tests=[test], parameters=only, fit=FORWARD, executor=executor, progress=False)
            found.append(json.dumps(fit.summary))
    assert found[0] == found[1] == found[2]


def test_tension_is_not_seen_in_shear() -> None:
    x = np.linspace(0.01, 0.58, 30)
    curve = scattered(x, exact(SHEAR, x), np.random.default_rng(1))
    bond = {"key": "interfaces.joint.zeta", "start": 4.0, "bounds": [2.0, 8.0]}
    with ThreadPoolExecutor(2) as threads:
        found = calibrate(
            tests=[{"name": "shear", "deck": SHEAR, "curves": [curve]}],
            parameters={"c": PARAMETERS["c"], "zeta": bond},
            fit=FORWARD,
            executor=threads,
            progress=False,
        )
    assert found.unseen == ("The tests do not see zeta: its interval is as wide as its bounds.",)
    assert found.intervals["zeta"] == (2.0, 8.0)
    assert found.values["c"] == pytest.approx(TRUE["c"], abs=4.0 * found.standard_errors["c"])


def test_the_command(folder: Path) -> None:
    done = python("-m", "wythe", "calibrate", "joint.toml", "--workers", "1", folder=folder)
    assert done.returncode == 0, done.stderr
    assert "Couplet: 1 curves of 1 tests" in done.stdout and "f_t" in done.stdout and "misfit" in done.stderr
    out = folder / "joint.out"
    said = json.loads((out / "calibration.json").read_text())
    one = said["parameters"]["f_t"]
    assert abs(one["value"] - TRUE["f_t"]) < 4.0 * one["standard_error"] and one["unit"] == "MPa"
    # The tables are those of a deck: the next one takes them.
    tables = toml_of((out / "materials.toml").read_text())
    assert set(tables) == {"interfaces"} and tables["interfaces"]["joint"]["mu"] == 0.73
    deck = wythe.templates.couplet().to_dict()
    deck["interfaces"].update(tables["interfaces"])
    assert wythe.Model.from_dict(deck).check()
    # The same command again runs nothing, and gives the same.
    again = python("-m", "wythe", "calibrate", "joint.toml", "--json", "-q", folder=folder)
    assert json.loads(again.stdout) == said and again.stderr == ""


def test_the_function_reads_the_same_job(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder.parent)
    with ThreadPoolExecutor(2) as threads:
        found = calibrate(folder / "joint.toml", executor=threads, progress=False, posterior="linearised")
        job = (folder / "joint.toml").read_text()
        (folder / "joint.toml").write_text(f'out = "kept"\nposterior = "linearised"\n{job}')
        kept = calibrate(folder / "joint.toml", executor=threads, progress=False, posterior="none")
    assert found.units == {"f_t": "MPa"} and found.posterior is not None and kept.posterior is None
    assert kept.values == found.values and (folder / "kept" / "calibration.md").is_file()
    value = f"{found.values['f_t']!r} MPa"
    assert found.changes() == {"interfaces.joint.f_t": value}
    assert found.samples(2)[0]["interfaces.joint.f_t"] != value
    assert found.model("tension").interface("joint")["f_t"] == found.values["f_t"]


def test_the_next_deck_gets_the_values_of_all_tests() -> None:
    x = np.linspace(0.01, 0.58, 12)
    pulled = np.linspace(0.001, 0.02, 12)
    curves = {"tension": (TENSION, exact(TENSION, pulled), pulled), "shear": (SHEAR, exact(SHEAR, x), x)}
    with ThreadPoolExecutor(2) as threads:
        found = calibrate(
            tests=[
                {"name": name, "deck": deck, "curves": [np.stack([at, force], axis=1)]}
                for name, (deck, force, at) in curves.items()
            ],
            parameters={name: PARAMETERS[name] for name in ("f_t", "c")},
            fit=FORWARD,
            executor=threads,
            progress=False,
        )
    (joint,) = toml_of(found.materials)["interfaces"].values()
    # Each key is set in one test only; the table has both.
    assert (joint["f_t"], joint["c"]) == (found.values["f_t"], found.values["c"])
    assert "other fixed values" not in found.materials


def test_exit_codes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert wythe.command(["calibrate", str(folder / "none.toml")]) == 4
    assert "none.toml: cannot be read" in capsys.readouterr().err
    job = folder / "joint.toml"
    job.write_text(JOB.replace("joint.f_t", "joint.ft"))
    assert wythe.command(["calibrate", str(job)]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"error: {job}: parameters.f_t.key: ") and "fix: did you mean `f_t`?" in told
    assert wythe.command(["calibrate"]) == 2
    assert wythe.command(["calibrate", "joint.toml", "--workers", "0"]) == 2
    assert wythe.command(["calibrate", "--help"]) == 0
    assert "Exit codes" in capsys.readouterr().out
    # One set of values is the start itself: the fit cannot converge.
    job.write_text(JOB.replace("tolerance = 1e-3", "iterations = 1"))
    assert wythe.command(["calibrate", str(job), "--workers", "1", "-q"]) == 3
    assert (folder / "joint.out" / "calibration.json").is_file()
    (folder / "file").write_text("")
    out = str(folder / "file" / "out")
    assert wythe.command(["calibrate", str(job), "--workers", "1", "-q", "--out", out]) == 4


def test_the_help_names_the_command() -> None:
    told = python("-m", "wythe", "--help").stdout
    assert "Of the Python package:\n  calibrate " in told


def test_the_example(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES / "25_calibrate", tmp_path / "25_calibrate")
    for name in ("01_couplet_tension.toml", "02_couplet_shear.toml"):
        shutil.copy(EXAMPLES / name, tmp_path)
    job = tmp_path / "25_calibrate" / "joint.toml"
    # A third of the runs: derivatives from one side, no draws of the posterior.
    text = job.read_text(encoding="utf-8").replace("draws = 12", "draws = 0")
    job.write_text(text.replace("format = 1", 'format = 1\nfit = { differences = "forward", tolerance = 1e-3 }'))
    with ThreadPoolExecutor(2) as threads:
        found = calibrate(job, executor=threads, progress=False)
    assert found.converged and not found.failures
    for name, true in {"f_t": 0.28, "u_k": 0.20, "c": 0.87, "mu": 0.73, "delta_k": 0.40}.items():
        # Three in a thousand are beyond three standard errors.
        assert abs(found.values[name] - true) < 3.0 * found.standard_errors[name]
