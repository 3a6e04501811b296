"""Limit analysis, as a user of the package asks for it."""

from __future__ import annotations

from pathlib import Path

import pytest

import wythe

SCENE = """
format = 1

[materials.stone]
E = "5 GPa"
nu = 0.2
density = "2000 kg/m^3"

[interfaces.dry]
f_t = 0
c = 0
tan_phi = 0.4
mu = 0.4

[[blocks]]
name = "base"
size = [600, 200, 50]
at = [-100, -50, -50]
material = "stone"

[[blocks]]
name = "top"
size = [200, 100, 800]
material = "stone"

[[contacts]]
interface = "dry"

[[supports]]
on = "base.bottom"

[[steps]]
kind = "gravity"
"""


def test_a_block_tips_at_its_width_over_its_height(tmp_path: Path) -> None:
    model = wythe.Model.from_toml(SCENE)
    found = model.limit(along="x")
    assert isinstance(found, wythe.LimitAnalysis)
    # The tolerance of the program.
    assert found.factor == pytest.approx(0.25, rel=1e-6)
    assert found.associated_factor == pytest.approx(0.25, rel=1e-6)
    assert found.force is None and "body force" in found.live_load
    assert found.converged and found.programs >= 2 and found.gap < 1e-6
    # It tips: no joint opens as it slides, up to the bound of the search.
    assert 0.0 <= found.opening_work <= 0.02
    top = next(unit for unit in found.mechanism if unit["name"] == "top")
    assert top["spin"][1] > 0.0
    [joint] = found.joints
    assert joint["at_mm"][0] == pytest.approx(200.0, rel=1e-6)
    assert found.ties == []
    assert found.picture.save(tmp_path / "mechanism.svg")
    assert model.limit(along=[0.0, -2.0, 0.0], associated=True).factor == pytest.approx(0.125, rel=1e-6)
    crushed = model.limit(along="x", strength=0.05, bonded=True).factor
    assert crushed == pytest.approx(0.25 * (1.0 - 2e-9 * 9810.0 * 800.0 / 0.05), rel=1e-6)
    assert model.limit(along="x", strength="50 kPa", bonded=True).factor == pytest.approx(crushed, rel=1e-9)


def test_files_have_the_mechanism_and_the_forces(tmp_path: Path) -> None:
    found = wythe.Model.from_toml(SCENE).limit(along="x", associated=True)
    names = ["limit.json", "mechanism.vtkhdf", "joints.vtkhdf", "corners.vtkhdf", "mechanism.svg"]
    assert found.write(tmp_path / "limit") == [str(tmp_path / "limit" / name) for name in names]
    assert all((tmp_path / "limit" / name).is_file() for name in names)
    speed = (found.velocities**2).sum(axis=1) ** 0.5
    # The fastest node has a speed of 1, to rounding.
    assert speed.max() == pytest.approx(1.0, rel=1e-12)
    assert found.mirror == "y"
    [joint] = found.joints
    for axis in range(3):
        forces = sum(force[axis] for force in joint["corner_forces_N"])
        assert forces == pytest.approx(joint["force_N"][axis], abs=1e-9 * joint["normal_N"])


def test_what_has_no_factor_says_why() -> None:
    model = wythe.Model.from_toml(SCENE)
    with pytest.raises(wythe.LimitError, match="no step drives") as caught:
        model.limit()
    assert "tilt" in caught.value.fix and caught.value.message in str(caught.value)
    for wrong in ("w", [0.0, 0.0, 0.0]):
        with pytest.raises((TypeError, ValueError), match="along"):
            model.limit(along=wrong)
    for weak in (-1.0, 0, True, [1.0], float("nan"), "0 MPa"):
        with pytest.raises((TypeError, ValueError), match="^strength: "):
            model.limit(along="x", strength=weak)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"strength: expected a pressure \(MPa\), found .1 mm. \(a length\)"):
        model.limit(along="x", strength="1 mm")
