"""wythe along the paths of the golden curves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import wythe

from cap import CapJoint
from cap_paths import CAP_CASES
from drucker_prager import DruckerPrager
from drucker_prager_paths import DRUCKER_PRAGER_CASES
from golden import (
    FOLDER,
    JOINT_STATE,
    TRACTIONS,
    columns,
    given,
    material_columns,
    read,
    reference_joint_cases,
    reference_material_cases,
)
from paths import JOINT_CASES, MATERIAL_CASES, JointCase, MaterialCase
from tables import Floats

#: Implicit steps to a row, and twice as many.
STEPS = 500
#: Paths on which one implicit step a row has the stresses and the damage of the rates: the ratios of the effective
#: principal stresses do not change while the material yields; the slip is straight, at a constant pressure.
ONE_STEP = {
    "cdp_mortar850_eff1_uniax_compression",
    "cdp_mortar2300_eff1_cyclic",
    "cdp_brick_eff1_cyclic_recovery",
    "cdp_mortar850_eff1_confined",
    "cdp_stone_eff1_uniax_cyclic",
    "cdp_brick_eff1_triaxial_tension",
    "cdp_brick_lit_cyclic",
    "cdp_brick_eff1_scaled",
    "itf_T1_mixed45",
    "itf_T1_mode1_cyclic",
    "itf_T1_mode2_cyclic",
    "itf_T1_mode2_sig0.5",
    "itf_T1_sheared_then_opened",
    "itf_T1_shear_cyclic_varying_pressure",
    "itf_T3_shear_cyclic_open",
    "dp_tuff_uniax_cyclic",
    "dp_rock_uniax_tension",
    "dp_rock_uniax_cyclic",
    "dp_perfect_confined",
    "cap_plain_open_and_crush",
    "cap_plain_shear_cyclic",
}


def cone_by_wythe(case: MaterialCase, substeps: int) -> Floats:
    """Stresses, strains times E, state."""
    table = given(case.material)
    E = table["E"]
    table |= {name: f"{table[name]} deg" for name in ("phi", "psi")}
    # A single point has the length that its table names.
    part = {"kind": "drucker-prager", "reference_length": table.pop("length"), **table}
    found = wythe.drive_material(part, case.path, stress=case.stress, substeps=substeps)
    s = found.state
    state = [s.hardening_tension * E, s.hardening_compression * E, s.tensile_damage, s.compressive_damage]
    return np.hstack([found.stresses, s.strains * E, np.stack(state, axis=-1)])


def material_by_wythe(case: MaterialCase, substeps: int) -> Floats:
    """Stresses, strains times E, state."""
    m = case.material
    if isinstance(m, DruckerPrager):
        return cone_by_wythe(case, substeps)
    part = wythe.build.damage_plasticity(
        m.E, m.nu, m.tension, m.compression,
        dilation_angle=m.dilation_angle, eccentricity=m.eccentricity, fb0_fc0=m.fb0_fc0, K_c=m.K_c,
        tension_recovery=m.tension_recovery, compression_recovery=m.compression_recovery,
        viscosity=m.viscosity, interpolation=m.interpolation,
        # A band of 10 mm.
        reference_length=10.0 * m.length_ratio,
    )  # fmt: skip
    times = case.seconds * np.arange(1.0, len(case.path) + 1.0)
    found = wythe.drive_material(part, case.path, stress=case.stress, times=times, length=10.0, substeps=substeps)
    s = found.state
    state = [
        s.hardening_tension * m.E,
        s.hardening_compression * m.E,
        s.tensile_damage,
        s.compressive_damage,
        s.damage,
    ]
    return np.hstack([found.stresses, s.strains * m.E, np.stack(state, axis=-1)])


def joint_by_wythe(case: JointCase, substeps: int) -> Floats:
    """Tractions, damage."""
    j = case.joint
    if isinstance(j, CapJoint):
        found = wythe.drive_interface({"kind": "cap", **given(j)}, case.path, substeps=substeps)
        return np.hstack([found.tractions, found.state.damage[:, None]])
    stiffness: dict[str, Any] = {"normal_stiffness": j.normal_stiffness, "shear_stiffness": j.shear_stiffness}
    if j.dry:
        part = wythe.build.dry_joint(j.mu, **stiffness)
    else:
        part = wythe.build.joint(
            j.f_t, j.c, j.tan_phi, j.mu,
            zeta=j.zeta, xi=j.xi, u_k=j.u_k, delta_k=j.delta_k, coupling=j.coupling, **stiffness,
        )  # fmt: skip
    found = wythe.drive_interface(part, case.path, substeps=substeps)
    return np.hstack([found.tractions, found.state.damage[:, None]])


def compare(case: Any, golden: Floats, by_wythe: Any, accuracy: float, second_order: float) -> None:
    """Checks that steps converge at first order to the golden curve.

    Twice the finer answer less the coarser one has an error of second order. `accuracy`: that of the golden curve.
    """
    coarse, fine = by_wythe(case, STEPS), by_wythe(case, 2 * STEPS)
    errors = [np.abs(answer - golden).max() for answer in (coarse, fine, 2.0 * fine - coarse)]
    print(f"{case.name}: {errors[0]:.1e} and {errors[1]:.1e} MPa, extrapolated {errors[2]:.1e} MPa")
    # Twice as many steps have half the error; a tenth either way for kinks within a step.
    assert errors[0] < accuracy or 0.4 < errors[1] / errors[0] < 0.6
    assert errors[2] < second_order


@pytest.mark.parametrize("case", [*MATERIAL_CASES, *reference_material_cases()], ids=lambda case: case.name)
def test_materials_follow_the_golden_curves(case: MaterialCase) -> None:
    golden = material_columns(read(FOLDER / f"{case.name}.csv"), case)
    # The curves are accurate to 3e-10 MPa, those of the reference to 1.3e-9. Found: 4.7e-7 MPa of second order.
    compare(case, golden, material_by_wythe, 2e-9, 1e-6)
    if case.name in ONE_STEP:
        # But for the lateral strains, which are of first order: N depends on q.
        error = np.abs(material_by_wythe(case, 1) - golden)
        error[:, 6:12] = 0.0
        # The integrator leaves 1e-12 of E kappa, which is 450 MPa at most, in each of its steps.
        assert error.max() < 1e-9


@pytest.mark.parametrize("case", [*JOINT_CASES, *reference_joint_cases()], ids=lambda case: case.name)
def test_joints_follow_the_golden_curves(case: JointCase) -> None:
    table = read(FOLDER / f"{case.name}.csv")
    if case.name in {other.name for other in JOINT_CASES}:
        golden = columns(table, [*TRACTIONS, JOINT_STATE[0]])
    else:
        golden = columns(table, ["sig_ex_MPa", "tau1_ex_MPa", "tau2_ex_MPa", "D_ex"])
    # Rounding: 15 digits of gaps times k_n = 1e5 N/mm^3, in 1000 steps a row. Found: 4.4e-8 MPa of second order.
    compare(case, golden, joint_by_wythe, 1e-9, 1e-7)
    if case.name in ONE_STEP:
        assert np.abs(joint_by_wythe(case, 1) - golden).max() < 1e-10


@pytest.mark.parametrize("case", DRUCKER_PRAGER_CASES, ids=lambda case: case.name)
def test_cones_follow_the_golden_curves(case: MaterialCase) -> None:
    golden = material_columns(read(FOLDER / f"{case.name}.csv"), case)
    # The curves are accurate to 5e-10 MPa in E times strains. Found: 2.4e-7 MPa of second order, in stresses that reach
    # 210 MPa.
    compare(case, golden, material_by_wythe, 1e-9, 5e-7)
    if case.name in ONE_STEP:
        # Ten times the largest difference, for processors that round otherwise.
        assert np.abs(material_by_wythe(case, 1) - golden).max() < 5e-9


@pytest.mark.parametrize("case", CAP_CASES, ids=lambda case: case.name)
def test_joints_with_a_cap_follow_the_golden_curves(case: JointCase) -> None:
    golden = columns(read(FOLDER / f"{case.name}.csv"), [*TRACTIONS, "D"])
    # The curves are accurate to 6e-12 MPa. Found: 1.6e-7 MPa of second order.
    compare(case, golden, joint_by_wythe, 1e-10, 5e-7)
    if case.name in ONE_STEP:
        assert np.abs(joint_by_wythe(case, 1) - golden).max() < 1e-10
