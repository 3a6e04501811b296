"""The oracle against the stored curves, those of the earlier reference, and closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

import damage_plasticity_path
import joint_path
from cap_paths import CAP_CASES
from damage_plasticity import Law, invariants, matrix
from drucker_prager_paths import DRUCKER_PRAGER_CASES
from golden import (
    FOLDER,
    JOINT_STATE,
    STRAINS,
    STRESSES,
    TRACTIONS,
    WORK,
    columns,
    joint_table,
    material_table,
    read,
    reference_joint_cases,
    reference_material_cases,
)
from paths import (
    BRICK,
    JOINT_CASES,
    MATERIAL_CASES,
    MORTAR_850,
    MORTAR_2300,
    STONE,
    TABLE_1,
    TABLE_3,
    JointCase,
    Material,
    MaterialCase,
    axial,
    legs,
)
from tables import curve

EXACT = FOLDER.parent / "exact"
MATERIALS, JOINTS = [*MATERIAL_CASES, *DRUCKER_PRAGER_CASES], [*JOINT_CASES, *CAP_CASES]
REFERENCE_MATERIAL, REFERENCE_JOINT = reference_material_cases(), reference_joint_cases()


def worst(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a - b).max())


# ---- The stored curves are those of the oracle --------------------------------------------------------------


@pytest.mark.parametrize("case", MATERIALS, ids=lambda case: case.name)
def test_stored_material_curves_are_reproduced(case: MaterialCase) -> None:
    stored, made = read(FOLDER / f"{case.name}.csv"), material_table(case)
    assert list(stored) == list(made)
    # Integration with tolerances ten times smaller moves stresses by 3e-11 MPa at most, damage by 9e-13, strains
    # and hardening variables by 3e-10 MPa / E, those of the cone by 5e-10. Ten times that for processors that round
    # otherwise.
    assert worst(columns(stored, STRESSES), columns(made, STRESSES)) < 3e-10
    damages = [name for name in ("dt", "dc", "d") if name in stored]
    assert worst(columns(stored, damages), columns(made, damages)) < 9e-12
    strains = [*STRAINS, "kt", "kc"]
    bound = 5e-9 if case in DRUCKER_PRAGER_CASES else 3e-9
    assert case.material.E * worst(columns(stored, strains), columns(made, strains)) < bound


@pytest.mark.parametrize("case", JOINTS, ids=lambda case: case.name)
def test_stored_joint_curves_are_reproduced(case: JointCase) -> None:
    stored, made = read(FOLDER / f"{case.name}.csv"), joint_table(case)
    assert list(stored) == list(made)
    # Integration with tolerances ten times smaller moves tractions by 5.4e-12 MPa at most, those of the cap by 5.9e-12,
    # damage and slips by 1.5e-12, work by 1.2e-11 N/mm. Ten times that for processors that round otherwise.
    bound = 5.9e-11 if case in CAP_CASES else 5.4e-11
    assert worst(columns(stored, TRACTIONS), columns(made, TRACTIONS)) < bound
    state = [name for name in stored if name not in (*TRACTIONS, WORK)]
    assert worst(columns(stored, state), columns(made, state)) < 1.5e-11
    assert worst(stored[WORK], made[WORK]) < 1.2e-10


def test_each_stored_curve_is_compared() -> None:
    cases = [*MATERIALS, *JOINTS, *REFERENCE_MATERIAL, *REFERENCE_JOINT]
    known = {case.name for case in cases}
    assert {path.stem for path in FOLDER.glob("*.csv")} == known | {"tables_brick_eff1", "tables_mortar850_eff1"}


# ---- The curves of the earlier reference --------------------------------------------------------------------


@pytest.mark.parametrize("case", REFERENCE_MATERIAL, ids=lambda case: case.name)
def test_the_oracle_finds_the_rate_solutions_of_the_reference(case: MaterialCase) -> None:
    material, table = case.material, read(FOLDER / f"{case.name}.csv")
    found = damage_plasticity_path.drive(material, case.path)
    # The largest error that the headers estimate is 1.3e-9 MPa.
    assert worst(found.stresses, columns(table, STRESSES)) < 2e-9
    assert worst(found.state[:, 2:], columns(table, ["dt", "dc", "d"])) < 2e-9
    assert material.E * worst(found.state[:, :2], columns(table, ["kt", "kc"])) < 2e-9


@pytest.mark.parametrize("case", REFERENCE_MATERIAL, ids=lambda case: case.name)
def test_the_reference_solves_the_equations_of_a_backward_euler_step(case: MaterialCase) -> None:
    """Residuals of an implicit step from each row to the next, without solving anything."""
    material, table = case.material, read(FOLDER / f"{case.name}.csv")
    law = Law(material)
    strains, d = case.path, table["dBE"]
    stresses = columns(table, [f"sigBE_{s[4:]}" for s in STRESSES]) / (1.0 - d)[:, None]
    kappa = columns(table, ["ktBE", "kcBE"])
    plastic = strains - np.linalg.solve(material.stiffness, stresses.T).T
    last_plastic, last_kappa, yielding = np.zeros(6), np.zeros(2), 0
    for i, stress in enumerate(stresses):
        (kt, kc), principal = kappa[i], np.linalg.eigvalsh(matrix(stress))
        sbt, _, dt, _ = material.tensile.at(kt, material.tensile.segment(kt))
        sbc, _, dc, _ = material.compressive.at(kc, material.compressive.segment(kc))
        increment, n = plastic[i] - last_plastic, law.flow(stress)
        multiplier = max(float(increment @ n) / float(n @ n), 0.0)
        r = law.weight(principal)
        f = law.yield_function(stress, sbt, sbc)
        # 15 digits of stresses up to 20 MPa, divided by 1 - d > 0.025, make 8e-13 MPa.
        assert material.E * worst(increment, multiplier * n) < 4e-12
        assert (
            material.E * worst(kappa[i] - last_kappa, multiplier * np.array(law.hardening(principal, r))) < 4e-12
        )
        assert f < 4e-12
        if material.E * multiplier > 1e-6:
            yielding += 1
            assert abs(f) < 4e-12
        assert 1.0 - d[i] == pytest.approx(law.integrity(r, dt, dc), abs=1e-14)
        last_plastic, last_kappa = plastic[i], kappa[i]
    assert yielding > 40


@pytest.mark.parametrize("case", REFERENCE_JOINT, ids=lambda case: case.name)
def test_the_oracle_finds_the_curves_of_joints_of_the_reference(case: JointCase) -> None:
    table, gaps = read(FOLDER / f"{case.name}.csv"), case.path
    found = joint_path.drive(case.joint, gaps)
    # The last of 15 digits of a slip of 0.44 mm times k_s is 2e-11 MPa. On these paths one implicit step a row (be)
    # and the rates (ex) have the same answer.
    for kind in ("be", "ex"):
        tractions = columns(table, [f"{t.removesuffix('_MPa')}_{kind}_MPa" for t in TRACTIONS])
        assert worst(found.tractions, tractions) < 3e-11
        assert worst(found.state[:, 0], table[f"D_{kind}"]) < 1e-14
    names = [f"{s.removesuffix('_mm')}_be_mm" for s in JOINT_STATE[1:]]
    assert worst(found.state[:, 1:], columns(table, names)) < 1e-14
    # The reference summed its work by trapezoids, 400 a row. One that holds a jump is off by half its width times the
    # jump, which is at most twice the largest traction.
    steps = np.linalg.norm(np.diff(gaps, axis=0, prepend=0.0), axis=1)
    largest = np.linalg.norm(found.tractions, axis=1).max() + TABLE_1.f_t
    error = np.diff(found.work - table[WORK], prepend=0.0)
    assert (np.abs(error) <= steps / 400 * largest + 1e-12).all()


@pytest.mark.parametrize(("name", "material"), [("brick", BRICK), ("mortar850", MORTAR_850)])
def test_nodes_of_the_tables_are_those_of_the_reference(name: str, material: Material) -> None:
    lines = (FOLDER / f"tables_{name}_eff1.csv").read_text().splitlines()
    for branch, found in (("t", material.tensile), ("c", material.compressive)):
        rows = [line.split(",")[1:] for line in lines if line.startswith(f"{branch},")]
        nodes = np.stack([found.kappa, found.eps_in, found.sigma, found.sigma_bar, found.damage], axis=-1)
        # 15 digits.
        np.testing.assert_allclose(nodes, np.array(rows, dtype=float), rtol=1e-14, atol=1e-15)


# ---- Closed forms -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("material", [BRICK, MORTAR_2300, STONE])
def test_tables_without_a_bound_keep_their_damage(material: Material) -> None:
    for interpolation in ("eff1", "lit"):
        rows = np.array(material.tension)
        if interpolation == "lit" and material is MORTAR_2300:
            continue  # a damage linear in the strain would make the plastic strain fall between its rows
        found = curve(material.tension, material.E, interpolation=interpolation)
        assert np.interp(rows[:, 1], found.eps_in, found.damage) == pytest.approx(rows[:, 2], abs=1e-13)


def test_first_yield_equals_the_closed_forms() -> None:
    directions = {"uniaxial tension": [1, 0, 0], "hydrostatic tension p": [1, 1, 1]}
    for ratio in ("0", "0.25", "0.52", "0.75", "1"):
        directions[f"CC 1:{ratio}"] = [-1, -float(ratio), 0]
    for ratio in ("0.05", "0.1", "0.2", "0.5"):
        directions[f"TC t={ratio}|c|  |c|="] = [-1, float(ratio), 0]
    checked = 0
    for line in (EXACT / "cdp_yield_surface_exact_daltri.csv").read_text().splitlines()[2:]:
        name, path, value = line.split(",")
        if path not in directions:
            continue
        material = {"brick": BRICK, "mortar": MORTAR_850}[name]
        stress = float(value) * np.array([*directions[path], 0.0, 0.0, 0.0], dtype=float)
        strengths = material.tension[0][0], material.compression[0][0]
        # The file has six digits; f is at most 7 times as steep as the stress.
        assert abs(Law(material).yield_function(stress, *strengths)) < 7 * 5e-6 * float(value)
        checked += 1
    assert checked == 22


@pytest.mark.parametrize("material", [BRICK, MORTAR_850, MORTAR_2300, STONE])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_uniaxial_curves_are_the_polylines_of_the_tables(material: Material, sign: float) -> None:
    rows = np.array(material.tension if sign > 0.0 else material.compression)
    strain = rows[:, 1] + rows[:, 0] / material.E
    path = axial(30, [sign * 1.1 * strain[-1]])
    found = damage_plasticity_path.drive(material, path, ("yy", "zz"))
    polyline = np.interp(np.abs(path[:, 0]), [0.0, *strain], [0.0, *rows[:, 0]])
    # Rounding: stresses up to 26 MPa from strains that E = 30000 MPa multiplies.
    assert worst(sign * found.stresses[:, 0], polyline) < 1e-11
    assert np.abs(found.stresses[:, 1:]).max() < 1e-13


def test_flow_and_hardening_are_consistent() -> None:
    """Trace of N is T; in uniaxial states kappa is the axial plastic strain."""
    law = Law(STONE)
    for sign in (1.0, -1.0):
        stress = np.array([sign * 3.0, 0, 0, 0, 0, 0])
        n, principal = law.flow(stress), np.linalg.eigvalsh(matrix(stress))
        assert n[:3].sum() == pytest.approx(STONE.T, rel=1e-14)
        h_t, h_c = law.hardening(principal, law.weight(principal))
        assert (h_t, h_c) == pytest.approx((n[0], 0.0) if sign > 0.0 else (0.0, -n[0]), rel=1e-14)
    assert invariants(np.array([2.0, 2.0, 2.0, 0, 0, 0]))[1] == 0.0


def test_work_of_a_joint_is_its_fracture_energy() -> None:
    """Equations 30 and 31 of docs/theory/joint.md, beside the elastic parts and friction."""
    for j in (TABLE_1, TABLE_3):
        share = [1.0 / b - 1.0 / math.expm1(b) for b in (j.zeta, j.xi)]
        opened = joint_path.drive(j, legs((40, j.u_0 + j.u_k, 0, 0)))
        # Up to u_0 the triangle of the penalty.
        assert opened.work[-1] == pytest.approx(0.5 * j.f_t * j.u_0 + j.f_t * j.u_k * share[0], rel=1e-10)
        pressure, slip = 0.5, 1.2 * j.delta_k
        slid = joint_path.drive(
            j, legs((1, -pressure / j.normal_stiffness, 0, 0), (40, -pressure / j.normal_stiffness, slip, 0))
        )
        peak, rest = j.c + j.tan_phi * pressure, j.mu * pressure
        bond = (peak - rest) * j.delta_k * share[1]
        # The traction follows the plastic slip, which is less than the slip by tau/k_s; the elastic energy is left of
        # the pressure and of the residual friction.
        friction = rest * (slip - rest / j.shear_stiffness)
        elastic = 0.5 * pressure**2 / j.normal_stiffness + 0.5 * rest**2 / j.shear_stiffness
        assert slid.work[-1] == pytest.approx(bond + friction + elastic, rel=1e-10)


def test_softening_of_joints_has_the_printed_digits() -> None:
    tension = read(EXACT / "daltri_interface_tension.csv")
    gaps = np.zeros((len(tension["u_mm"]), 3))
    gaps[:, 0] = tension["u_mm"] + TABLE_1.u_0
    # Six digits.
    assert worst(joint_path.drive(TABLE_1, gaps).tractions[:, 0], tension["sigma_T1_MPa"]) < 6e-7
    shear = read(EXACT / "daltri_interface_shear.csv")
    for pressure in ("0.1", "0.5", "1.0"):
        traction = shear[f"tau_s{pressure}"]
        gaps = np.zeros((len(traction) + 1, 3))
        gaps[:, 0] = -float(pressure) / TABLE_1.normal_stiffness
        # The file counts slip without its elastic part.
        gaps[1:, 1] = shear["slip_mm"] + traction / TABLE_1.shear_stiffness
        assert worst(joint_path.drive(TABLE_1, gaps).tractions[1:, 1], traction) < 6e-6


# ---- The oracle satisfies its equations ---------------------------------------------------------------------


def test_plastic_states_stay_on_the_yield_surface() -> None:
    for case in MATERIAL_CASES[-4:]:
        found = damage_plasticity_path.drive(case.material, case.path[:40], case.stress, case.seconds)
        assert found.state[-1, :2].max() > 0.0
        # Errors of the integrator, 1e-12 of stresses up to 30 MPa a step, over some hundred steps.
        assert found.drift < 3e-9


def test_rotated_paths_give_rotated_stresses() -> None:
    turn = np.linalg.qr(np.array([[0.2, -0.9, 0.4], [1.0, 0.3, 0.1], [-0.3, 0.5, 0.9]]))[0]
    path = next(case.path for case in MATERIAL_CASES if case.name == "cdp_stone_eff1_spatial")[:40]

    def turned(values: np.ndarray, shear: float) -> np.ndarray:
        scale = np.array([1.0, 1.0, 1.0, shear, shear, shear])
        out = np.array([turn @ matrix(v * scale) @ turn.T for v in values])
        return out[:, [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]] / scale

    straight = damage_plasticity_path.drive(STONE, path).stresses
    # Twice the tolerance of the stored curves.
    assert worst(damage_plasticity_path.drive(STONE, turned(path, 0.5)).stresses, turned(straight, 1.0)) < 6e-10
