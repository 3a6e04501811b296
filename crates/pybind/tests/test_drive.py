"""Single points along paths, against closed forms, the command and each other."""

from __future__ import annotations

import csv
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import wythe

Floats = npt.NDArray[np.float64]
JOINT = wythe.build.joint(
    0.28,
    0.87,
    1.01,
    0.73,
    u_k="0.20 mm",
    zeta=4.38,
    delta_k="0.4 mm",
    xi=1.1,
    normal_stiffness=34000,
    shear_stiffness=14783,
)
BRICK = wythe.templates.shear_wall().material("brick")


def opening(to: float, rows: int = 200) -> Floats:
    gaps = np.zeros((rows, 3))
    gaps[:, 0] = np.linspace(to / rows, to, rows)
    return gaps


def test_an_interface_softens_by_its_law() -> None:
    """Theory C: sigma = f_t (e^(-zeta u/u_k) - e^-zeta)/(1 - e^-zeta) once it has opened by f_t/k_n."""
    response = wythe.drive_interface(JOINT, opening(0.19))
    assert isinstance(response, wythe.InterfaceResponse)
    assert isinstance(response.state, wythe.InterfaceState)
    tractions, state, tangents = response
    assert tractions.shape == (200, 3) and tangents.shape == (200, 3, 3)
    assert state.gaps.shape == (200, 3) and state.damage.shape == (200,)
    np.testing.assert_array_equal(state.gaps, opening(0.19))
    assert (np.diff(state.damage) >= 0.0).all() and 0.0 < state.damage[-1] < 1.0
    # The area below the curve is the fracture energy, but for what lies beyond 0.19 of 0.2 mm.
    energy = 0.28 * 0.20 * (1.0 / 4.38 - 1.0 / (math.exp(4.38) - 1.0))
    fine = wythe.drive_interface(JOINT, opening(0.2, 4000)).tractions[:, 0]
    # Trapezoids of 5e-5 mm cut the peak, 0.28 MPa high, by less than one of their widths.
    assert np.trapezoid(fine, dx=0.2 / 4000) == pytest.approx(energy, abs=0.28 * 5e-5)


def test_a_broken_joint_rubs() -> None:
    """Pressed by 1 MPa and slid beyond δ_k, it carries mu times the pressure."""
    path = [[-1.0, slip, 0.0] for slip in (0.0, 0.01, 0.5, 1.0)]
    response = wythe.drive_interface(JOINT, path, stress=["normal"])
    np.testing.assert_allclose(response.tractions[:, 0], -1.0)
    np.testing.assert_allclose(response.state.gaps[:, 0], -1.0 / 34000)
    assert response.tractions[1, 1] > 0.73
    np.testing.assert_allclose(response.tractions[2:, 1], 0.73)


def test_tangents_are_derivatives() -> None:
    last, step = 60, 1e-7
    gaps = opening(0.05, last)
    gaps[:, 1] = np.linspace(0.0, 0.02, last)
    there = wythe.drive_interface(JOINT, gaps)
    moved = np.stack([gaps] * 6)
    for i in range(3):
        moved[2 * i, -1, i] += step
        moved[2 * i + 1, -1, i] -= step
    beside = wythe.drive_interface(JOINT, moved).tractions[:, -1]
    slopes = (beside[0::2] - beside[1::2]).T / (2.0 * step)
    # Central differences of a smooth law: rounding 1e-16/1e-7, curvature times 1e-14.
    np.testing.assert_allclose(there.tangents[-1], slopes, rtol=1e-5, atol=1e-5)


def test_a_material_cracks_under_uniaxial_stress() -> None:
    strains = np.zeros((60, 6))
    strains[:, 0] = np.linspace(1e-5, 6e-4, 60)
    free = ("yy", "zz", "xy", "yz", "zx")
    response = wythe.drive_material(BRICK, strains, stress=free)
    assert isinstance(response, wythe.MaterialResponse)
    assert isinstance(response.state, wythe.MaterialState)
    state = response.state
    # The stresses asked for are met to what the driver asks, 1e-10 MPa.
    assert np.abs(response.stresses[:, 1:]).max() < 1e-10
    elastic = response.stresses[:, 0] < 3.5 * 0.999
    elastic[np.argmax(response.stresses[:, 0]) :] = False
    # Hooke's law, met to the driver's tolerance.
    np.testing.assert_allclose(
        response.stresses[elastic, 0], 16700.0 * strains[elastic, 0], rtol=1e-9
    )
    np.testing.assert_allclose(state.strains[elastic, 1], -0.15 * strains[elastic, 0], rtol=1e-9)
    # Rounding of the principal stresses leaves 1e-21.
    assert state.tensile_damage[-1] > 0.1 and state.compressive_damage[-1] < 1e-15
    assert state.hardening_tension[-1] > 1e-5 and state.hardening_compression[-1] < 1e-15
    np.testing.assert_allclose(state.damage, state.tensile_damage, rtol=1e-12)
    assert response.tangents.shape == (60, 6, 6)


def test_many_paths_are_each_alone() -> None:
    """6,400 rows are shared among threads; one path of 100 is not."""
    rng = np.random.default_rng(3)
    paths = np.cumsum(rng.normal(scale=2e-5, size=(8, 8, 100, 6)), axis=2)
    together = wythe.drive_material(BRICK, paths)
    assert together.stresses.shape == (8, 8, 100, 6)
    assert together.tangents.shape == (8, 8, 100, 6, 6)
    assert together.state.damage.shape == (8, 8, 100)
    for i, j in ((0, 0), (3, 5), (7, 7)):
        alone = wythe.drive_material(BRICK, paths[i, j])
        np.testing.assert_array_equal(together.stresses[i, j], alone.stresses)
        np.testing.assert_array_equal(together.tangents[i, j], alone.tangents)


def test_each_path_may_have_its_own_table() -> None:
    joints = [{**JOINT, "f_t": f_t} for f_t in (0.1, 0.2, 0.4)]
    tractions = wythe.drive_interface(joints, np.stack([opening(0.1)] * 3)).tractions
    for i, joint in enumerate(joints):
        alone = wythe.drive_interface(joint, opening(0.1))
        np.testing.assert_array_equal(tractions[i], alone.tractions)


def test_arrays_are_sealed() -> None:
    tractions, state, tangents = wythe.drive_interface(JOINT, opening(0.1))
    for array in (tractions, *state, tangents):
        assert not array.flags.writeable


def test_times_and_lengths_are_told_to_the_law() -> None:
    strains = np.zeros((40, 6))
    strains[:, 0] = np.linspace(1e-5, 1e-3, 40)
    viscous = {**BRICK, "viscosity": 0.01}
    slow = wythe.drive_material(viscous, strains, times=np.arange(1, 41) * 1e3)
    fast = wythe.drive_material(viscous, strains, times=np.arange(1, 41) * 1e-3)
    assert fast.stresses[:, 0].max() > 1.05 * slow.stresses[:, 0].max()
    large = wythe.drive_material(BRICK, strains, length=100.0)
    given = wythe.drive_material(BRICK, strains, length=50.0)
    # At the tables' own length nothing is scaled; a larger element falls faster.
    same = wythe.drive_material(BRICK, strains)
    np.testing.assert_allclose(given.stresses, same.stresses, rtol=1e-12)
    assert large.stresses[-1, 0] < given.stresses[-1, 0]
    fine = wythe.drive_material(BRICK, strains, substeps=10)
    # Inviscid loading along one direction does not depend on the steps, but for what the returns leave.
    np.testing.assert_allclose(fine.stresses[:, 0], same.stresses[:, 0], rtol=1e-3)


def test_the_command_gives_the_same_numbers(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    gaps = np.cumsum(rng.normal(scale=0.004, size=(50, 3)), axis=0)
    path = tmp_path / "path.csv"
    with path.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("u_mm", "d1_mm", "d2_mm"))
        rows.writerows(gaps.tolist())
    deck = wythe.templates.couplet().with_({"interfaces.joint": JOINT})
    model = deck.save(tmp_path / "deck.toml")
    command = ["drive", "interface", "joint", "--model", model, "--path", str(path)]
    said = subprocess.run(
        [sys.executable, "-m", "wythe", *command], capture_output=True, text=True, check=True
    )
    lines = list(csv.DictReader(said.stdout.splitlines()))
    tractions, state, _ = wythe.drive_interface(JOINT, gaps)
    for i, name in enumerate(("sig_MPa", "tau1_MPa", "tau2_MPa")):
        assert [float(line[name]) for line in lines] == tractions[:, i].tolist()
    assert [float(line["D"]) for line in lines] == state.damage.tolist()


def test_what_is_beyond_the_strength_is_told_with_its_place() -> None:
    asked = np.zeros((2, 3, 3))
    asked[:, :, 0] = [[0.1, 0.2, 0.25], [0.1, 0.5, 0.1]]
    with pytest.raises(wythe.PointError, match="path 1, row 1: beyond the strength") as caught:
        wythe.drive_interface(JOINT, asked, stress=["normal"])
    assert (caught.value.path, caught.value.row) == (1, 1)
    tractions = wythe.drive_interface(JOINT, asked, stress=["normal"], errors="nan").tractions
    np.testing.assert_allclose(tractions[0, :, 0], asked[0, :, 0], atol=1e-10)
    assert np.isnan(tractions[1, 1:]).all() and np.isfinite(tractions[1, 0]).all()


WRONG: list[tuple[Callable[[], Any], type[Exception], str]] = [
    (
        lambda: wythe.drive_material(BRICK, np.zeros((3, 5))),
        ValueError,
        r"strains: expected an array of shape \(rows, 6\) .*got \(3, 5\)",
    ),
    (lambda: wythe.drive_interface(JOINT, np.zeros(3)), ValueError, "gaps: expected an array"),
    (lambda: wythe.drive_interface(JOINT, np.zeros((0, 3))), ValueError, "gaps: expected an array"),
    (lambda: wythe.drive_interface(JOINT, "abc"), TypeError, "gaps: expected numbers"),
    (lambda: wythe.drive_interface(JOINT, [[0, math.nan, 0]]), ValueError, "gaps: expected finite"),
    (lambda: wythe.drive_material(3, np.zeros((1, 6))), TypeError, "material: expected a mapping"),  # type: ignore[arg-type]
    (
        lambda: wythe.drive_material([BRICK], np.zeros((3, 2, 6))),
        ValueError,
        "material: expected one mapping, or one for each of the 3 paths, got 1",
    ),
    (
        lambda: wythe.drive_interface(JOINT, opening(0.1), stress=["up"]),
        ValueError,
        "stress: expected some of normal, tau1, tau2, got 'up'",
    ),
    (
        lambda: wythe.drive_material(BRICK, np.zeros((2, 6)), times=[1.0]),
        ValueError,
        r"times: expected an array of shape \(2,\)",
    ),
    (
        lambda: wythe.drive_material(BRICK, np.zeros((2, 6)), times=[2.0, 1.0]),
        ValueError,
        "times: expected finite numbers from 0 that do not decrease",
    ),
    (
        lambda: wythe.drive_material(BRICK, np.zeros((2, 6)), length=-1.0),
        ValueError,
        "length: expected a number above 0",
    ),
    (
        lambda: wythe.drive_interface(JOINT, opening(0.1), substeps=0),
        ValueError,
        "substeps: expected a whole number from 1",
    ),
    (
        lambda: wythe.drive_interface(JOINT, opening(0.1), errors="ignore"),  # type: ignore[arg-type]
        ValueError,
        "errors: expected 'raise' or 'nan'",
    ),
    (
        lambda: wythe.drive_interface({**JOINT, "f_t": -1}, opening(0.1)),
        wythe.ModelError,
        "f_t: -1 is negative",
    ),
    (
        lambda: wythe.drive_interface(wythe.templates.couplet().interface("joint"), opening(0.1)),
        wythe.ModelError,
        "normal_stiffness = ",
    ),
]


@pytest.mark.parametrize(("call", "kind", "message"), WRONG)
def test_wrong_arguments_are_named(
    call: Callable[[], Any], kind: type[Exception], message: str
) -> None:
    with pytest.raises(kind, match=message):
        call()
