"""Runs and models that the tests share. All are small: the largest takes about a second."""

from __future__ import annotations

import shutil
from pathlib import Path

import matplotlib
import pytest
import wythe

matplotlib.use("agg")


@pytest.fixture
def model() -> wythe.Model:
    """Two bricks and a joint, pulled beyond the peak: 20 increments, 0.1 s."""
    return wythe.templates.couplet().with_(
        {
            "steps.0.increments": {"initial": 0.1, "max": 0.1, "peak": 1},
            "steps.1.increments": {"initial": 0.1, "max": 0.1, "peak": 1},
            "steps.1.displacement": "0.02 mm",
        }
    )


@pytest.fixture(scope="session")
def couplet(tmp_path_factory: pytest.TempPathFactory) -> wythe.Results:
    """The template of the couplet, pulled to 0.026 mm. Not to be written to."""
    folder = tmp_path_factory.mktemp("couplet") / "couplet.out"
    return wythe.templates.couplet("0.02 mm").run(folder)


@pytest.fixture(scope="session")
def wall(tmp_path_factory: pytest.TempPathFactory) -> wythe.Results:
    """A small wall whose bricks crack. Not to be written to."""
    folder = tmp_path_factory.mktemp("wall") / "wall.out"
    shear = wythe.templates.shear_wall(drive="0.6 mm", length="420.5 mm", courses=4)
    return shear.with_(output__every=2).run(folder)


@pytest.fixture
def own(couplet: wythe.Results, tmp_path: Path) -> wythe.Results:
    """A copy of the couplet's folder, to be written to."""
    return wythe.Results(shutil.copytree(couplet.path, tmp_path / "own.out"))


@pytest.fixture
def killed(model: wythe.Model, tmp_path: Path) -> wythe.Results:
    """The folder of a run that was killed after eleven increments, and cannot tell how it ended."""
    running, left = tmp_path / "running.out", tmp_path / "killed.out"

    def kill(row: wythe.Increment) -> bool:
        if row.increment == 12:
            shutil.copytree(running, left)
        return row.increment < 12

    model.run(running, callback=kill)
    return wythe.Results(left)


@pytest.fixture
def measured(tmp_path: Path) -> Path:
    """A measured curve."""
    path = tmp_path / "measured.csv"
    path.write_text("# couplet\ndisplacement_mm,force_kN\n0,0\n0.003,5.0\n0.01,4.5\n0.02,3.0\n")
    return path
