"""Answers of a run in the terms of engineers."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import wythe


def test_answers_are_those_of_the_summary(wall: wythe.Results) -> None:
    answers = wall.answers
    written = json.loads((Path(wall.path) / "summary.json").read_text())
    assert answers == written["answers"]
    assert answers["height_mm"] > 0.0
    assert answers["drift_at_peak"] == pytest.approx(
        wall.displacement_at_peak / answers["height_mm"], rel=1e-12
    )
    # A brick cracks, so that its increment is the first with a tensile damage above 0.1.
    crack = answers["first_damage"]["crack"]
    row = int(np.argmax(wall.history.max_tensile_damage > 0.1))
    assert wall.history.max_tensile_damage[row] > 0.1
    assert crack["increment"] == wall.history.increment[row]
    assert crack["displacement_mm"] == wall.history.displacement_mm[row]
    assert crack["force_kN"] == wall.history.force_kN[row]
    assert any(line.startswith("bilinear: ") for line in wall.answer_lines)


def test_a_bilinear_curve_has_the_area_of_the_curve(wall: wythe.Results) -> None:
    found = wall.answers["bilinear"]
    driven = wall.history["driven"]
    x = np.concatenate([[0.0], wall.history.displacement_mm[driven]])
    y = np.concatenate([[0.0], wall.history.force_kN[driven]])
    k, v = found["stiffness_kN_per_mm"], found["ultimate_force_kN"]
    d_u = found["ultimate_displacement_mm"]
    grid = np.concatenate([x[x < d_u], [d_u]])
    force = np.interp(grid, x, y)
    start = wall.history.force_kN[~driven][-1]
    force[0] = start
    area = float(np.sum(0.5 * np.diff(grid) * (force[1:] + force[:-1]))) - start * d_u
    rise = v - start
    # A few hundred operations.
    assert rise * (d_u - rise / (2.0 * k)) == pytest.approx(area, rel=1e-9)


def test_a_history_alone_has_the_answers_of_its_curve(killed: wythe.Results) -> None:
    assert killed.status == "unfinished"
    answers = killed.answers
    assert answers["secant_stiffness_kN_per_mm"] > 0.0
    assert answers["first_damage"] == {"joint": None, "crack": None, "crush": None}


def test_reactions_balance(wall: wythe.Results) -> None:
    reactions = wall.reactions
    assert set(reactions) == {"beams/top", "supports/bottom"}
    below, above = reactions["supports/bottom"], reactions["beams/top"]
    assert below.shape == above.shape == (wall.history.increments, 3)
    # Statics without weight. In equilibrium the root mean square of the forces out of balance is at most 2e-3 of the
    # mean nodal force; nodes between the ends are out of balance as well, so that the ends may differ by more.
    assert np.abs(below + above).max() < 5e-3 * np.abs(above).max()
    np.testing.assert_allclose(above[:, 0] * 1e-3, wall.history.force_kN, atol=1e-9)
    assert wall.answers["drive_direction"] == "x"
    series = wall.base_shear
    assert series is not None
    np.testing.assert_allclose(series, -1e-3 * below[:, 0], atol=1e-12)
    peak = int(np.argmax(wall.history.force_kN))
    shear = wall.answers["base_shear_at_peak_kN"]
    assert shear == pytest.approx(-1e-3 * below[peak, 0], rel=1e-12)


def test_the_base_shear_of_an_oblique_drive_is_along_it(tmp_path: Path) -> None:
    deck = """
format = 1
[materials.stone]
E = "5 GPa"
nu = 0.2
[[blocks]]
name = "post"
size = [100, 100, 400]
material = "stone"
mesh = [2, 2, 4]
[[supports]]
on = "post.bottom"
[[steps]]
kind = "drive"
face = "post.top"
direction = [1, -1, 0]
displacement = "0.1 mm"
"""
    run = wythe.Model.from_toml(deck).run(tmp_path / "post.out")
    assert run.answers["drive_direction"] == "(0.70711, -0.70711, 0)"
    series = run.base_shear
    assert series is not None
    # Statics without weight: the tolerance of equilibrium.
    assert series[-1] == pytest.approx(run.history.force_kN[-1], rel=5e-3)
    assert series[-1] == pytest.approx(run.answers["base_shear_at_peak_kN"], rel=1e-4)


def test_drifts_are_points_of_the_curve(wall: wythe.Results, couplet: wythe.Results) -> None:
    height = wall.answers["height_mm"]
    [point, beyond] = wall.at_drifts([0.3 / height, 1.0])
    assert point["displacement_mm"] == pytest.approx(0.3, rel=1e-12)
    driven = wall.history["driven"]
    force = np.interp(0.3, wall.history.displacement_mm[driven], wall.history.force_kN[driven])
    assert point["force_kN"] == pytest.approx(float(force), rel=1e-12)
    assert point["limit_state"] == "given"
    assert beyond["force_kN"] is None
    with pytest.raises(ValueError, match="no clear height"):
        couplet.at_drifts([0.01])
    assert couplet.at_drifts([0.0001], height=100.0)[0]["displacement_mm"] == pytest.approx(0.01)
    assert wall.at_drifts(0.3 / height) == wall.at_drifts((0.3 / height,)) == [point]
    wrong: Any
    for wrong in ("a lot", [[0.1, 0.2]], {}):
        with pytest.raises(TypeError, match="drifts: expected numbers above 0"):
            wall.at_drifts(wrong)
    with pytest.raises(ValueError, match="above 0"):
        wall.at_drifts([-0.1])
    with pytest.raises(ValueError, match="above 0"):
        wall.at_drifts([0.1], height=math.nan)
