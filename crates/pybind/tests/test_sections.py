"""Forces in sections of a wall, as a user of the package reads them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import wythe

SCENE = """
format = 1

[materials.stone]
E = "5 GPa"
nu = 0.2

[[blocks]]
name = "column"
size = [100, 50, 400]
material = "stone"
mesh = [1, 1, 8]

[[supports]]
on = "column.bottom"

[[sections]]
name = "foot"
through = [0, 0, 50]

[[steps]]
kind = "drive"
face = "column.top"
direction = "x"
displacement = 0.1
"""


def test_sections_are_read_by_name_and_component(tmp_path: Path) -> None:
    run = wythe.Model.from_toml(SCENE).run(out=tmp_path / "out")
    foot = run.sections["foot"]
    assert list(foot) == ["N_kN", "Vx_kN", "Vy_kN", "Mx_kNm", "My_kNm", "T_kNm"]
    force = run.history["force_kN"]
    assert force[-1] > 0.1
    # The tolerance is that of equilibrium.
    np.testing.assert_allclose(foot["Vx_kN"], force, rtol=5e-3)
    np.testing.assert_allclose(run.history["base_shear_kN"], force, rtol=5e-3)
    [at_peak] = run.answers["sections_at_peak"]
    assert at_peak["name"] == "foot" and at_peak["area_mm2"] == 5000.0
    assert any(line.startswith("section") and "foot" in line for line in run.answer_lines)
