"""Natural modes of models and runs."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
import wythe

COLUMN = """
format = 1
title = "a pier"
[materials.stone]
E = "5 GPa"
nu = 0
density = "2000 kg/m^3"
[[blocks]]
name = "pier"
size = ["200 mm", "150 mm", "2 m"]
material = "stone"
mesh = [2, 2, 20]
[[supports]]
on = "pier.bottom"
[[steps]]
kind = "gravity"
"""


def test_a_pier_has_the_frequencies_of_a_cantilever(tmp_path: Path) -> None:
    modes = wythe.Model.from_toml(COLUMN).modes(4)
    assert isinstance(modes, wythe.Modes)
    assert len(modes) == 4 and modes.table["title"] == "a pier"
    # Bernoulli: 1.8751² √(EI/(ϱA))/(2π L²), from which shear and rotary inertia take 1 %.
    speed = math.sqrt(5000.0 / 2e-9)
    for mode, depth in enumerate((150.0, 200.0)):
        closed = 1.8751**2 * speed * depth / math.sqrt(12.0) / (math.tau * 2000.0**2)
        assert modes.frequencies[mode] == pytest.approx(closed, rel=0.02)
    assert modes.periods == pytest.approx(1.0 / modes.frequencies)
    assert modes.eigenvalues == pytest.approx((math.tau * modes.frequencies) ** 2)
    assert modes.shapes.shape == (4, len(modes.nodes), 3)
    assert np.linalg.norm(modes.shapes, axis=2).max(axis=1) == pytest.approx(1.0)
    assert modes.total_mass == pytest.approx(0.12)
    assert np.all(modes.moving_mass < modes.total_mass)
    assert modes.effective_masses.shape == modes.participation.shape == (4, 3)
    assert np.all(modes.effective_masses.sum(axis=0) <= modes.moving_mass * (1.0 + 1e-9))
    assert modes.effective_masses[0, 1] > 0.5 * modes.total_mass
    assert np.all(modes.residuals < 1e-6)
    assert modes.notes == []
    assert "a pier" in str(modes) and "4 modes" in repr(modes)
    assert modes.picture(0).svg.startswith("<svg") and modes.picture(-1).svg != modes.picture().svg
    files = modes.write(tmp_path / "modes")
    assert [Path(file).name for file in files[:2]] == ["modes.json", "modes.vtkhdf"]
    assert json.loads(Path(files[0]).read_text()) == modes.table
    for wrong in (4, -5):
        with pytest.raises(IndexError, match="there are 4"):
            modes.picture(wrong)


def test_a_run_has_modes_at_its_frames(tmp_path: Path) -> None:
    model = wythe.Model.from_toml(COLUMN)
    results = model.run()
    # The weight alone, 0.04 MPa at the foot, of which the pier would buckle at 300 times as much.
    rest, loaded = model.modes(2), results.modes(2, frame="last")
    assert loaded.frequencies == pytest.approx(rest.frequencies, rel=5e-3)
    assert np.all(loaded.frequencies < rest.frequencies)
    assert loaded.table["frame"]["number"] == results.frames - 1
    with pytest.raises(IndexError):
        results.modes(frame=results.frames)


def test_what_is_wrong_is_said() -> None:
    model = wythe.Model.from_toml(COLUMN)
    with pytest.raises(TypeError, match="count"):
        model.modes(1.5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="count"):
        model.modes(0)
    light = wythe.Model.from_toml(COLUMN.replace('density = "2000 kg/m^3"', "").replace('kind = "gravity"', 'kind = "free"'))
    with pytest.raises(wythe.ModelError, match="density"):
        light.modes()
