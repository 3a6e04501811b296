"""The examples that are studies, on walls small enough for a test."""

from __future__ import annotations

from pathlib import Path

import pytest
from helpers import EXAMPLES, python

SMALL = ("--samples", "4", "--courses", "3", "--drive", "0.05 mm", "--workers", "2")


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("11_bond_scatter.py", "peak of 4 walls: mean "),
        ("12_sensitivity.py", "What moves initial_stiffness_kN_per_mm: 4 samples"),
    ],
)
def test_it_runs_and_goes_on(name: str, says: str, tmp_path: Path) -> None:
    arguments = (str(EXAMPLES / name), *SMALL, "--out", str(tmp_path / "out"))
    first = python(*arguments)
    assert first.returncode == 0, first.stderr
    assert "Study of 4 samples: 4 completed" in first.stdout and says in first.stdout
    assert (tmp_path / "out" / "study.csv").read_text().count("\n") == 5
    # All is done: the table comes from the journal, at once and the same.
    again = python(*arguments)
    assert again.returncode == 0 and again.stdout == first.stdout
