"""Drucker-Prager and the joint with a cap by the oracle: closed forms, and the equations along a path."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import cap
import drucker_prager
from cap_paths import CAP_CASES, DILATANT, PLAIN
from damage_plasticity import matrix
from drucker_prager import DruckerPrager
from drucker_prager_paths import DRUCKER_PRAGER_CASES, PERFECT, ROCK, TUFF
from golden import FOLDER, STRESSES, WORK, columns, read
from paths import UNIAXIAL, JointCase, MaterialCase, axial, legs


@pytest.mark.parametrize("law", [TUFF, PERFECT, ROCK])
def test_uniaxial_strengths_are_on_the_cone(law: DruckerPrager) -> None:
    for strength in (law.f_t, -law.f_c):
        assert law.F(np.array([strength, 0, 0, 0, 0, 0], dtype=float), 0.0) == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize(("law", "sign"), [(TUFF, 1.0), (ROCK, 1.0), (ROCK, -1.0)])
def test_uniaxial_stress_decays_with_the_plastic_strain(law: DruckerPrager, sign: float) -> None:
    strength, energy = (law.f_t, law.G_I) if sign > 0.0 else (law.f_c, law.G_c)
    path = axial(40, [sign * (strength / law.E + 3.0 * energy / (strength * law.length))])
    found = drucker_prager.drive(law, path, UNIAXIAL)
    stress = sign * found.stresses[:, 0]
    plastic = sign * path[:, 0] - stress / law.E
    omega = np.maximum(strength * law.length * plastic / energy, 0.0)
    # Rounding: the plastic strain is the difference of numbers of the size of E eps = 180 MPa.
    yields = found.state[:, :2].max(axis=1) > 0.0
    assert yields.sum() >= 38
    assert omega[-1] > 2.5
    error = stress - strength * (0.001 + 0.999 * np.exp(-omega))
    assert np.abs(error[yields]).max() < 1e-11
    # Equation 10: the axial plastic strain, all of it in tension or all of it in compression.
    own, other = found.state[-1, :2] if sign > 0.0 else found.state[-1, 1::-1]
    assert own == pytest.approx(plastic[-1], rel=1e-10)
    # w is off by 3 (1e-9 MPa/q)^2, with q above 0.1 MPa.
    assert other < 1e-15


@pytest.mark.parametrize("case", DRUCKER_PRAGER_CASES, ids=lambda case: case.name)
def test_curves_never_exceed_the_cone(case: MaterialCase) -> None:
    law, table = case.material, read(FOLDER / f"{case.name}.csv")
    assert isinstance(law, DruckerPrager)
    # Equation 11 gives omega from the strains that (10) integrates.
    omega = law.f_t * law.length * table["kt"] / law.G_I + law.f_c * law.length * table["kc"] / law.G_c
    stresses = columns(table, STRESSES)
    F = np.array([law.F(stress, o) for stress, o in zip(stresses, omega, strict=True)])
    # Ten times the drift, 3e-13 MPa, and 15 digits of stresses up to 214 MPa.
    assert F.max() < 4e-12
    yields = np.diff(table["kt"] + table["kc"], prepend=0.0) > 0.0
    assert yields.sum() > 10
    # A row may yield in its first part and then be unloaded.
    assert (np.abs(F[yields]) < 4e-12).mean() > 0.9


def test_rotated_strains_give_rotated_stresses() -> None:
    turn = np.linalg.qr(np.array([[0.2, -0.9, 0.4], [1.0, 0.3, 0.1], [-0.3, 0.5, 0.9]]))[0]
    path = next(case.path for case in DRUCKER_PRAGER_CASES if case.name == "dp_rock_spatial")[:40]

    def turned(values: np.ndarray, shear: float) -> np.ndarray:
        scale = np.array([1.0, 1.0, 1.0, shear, shear, shear])
        out = np.array([turn @ matrix(v * scale) @ turn.T for v in values])
        return out[:, [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]] / scale

    straight = drucker_prager.drive(ROCK, path).stresses
    # Ten times the change of the curve by tolerances ten times smaller.
    assert np.abs(drucker_prager.drive(ROCK, turned(path, 0.5)).stresses - turned(straight, 1.0)).max() < 1e-11


def test_tension_of_a_joint_decays_with_the_plastic_opening() -> None:
    for joint in (PLAIN, DILATANT):
        opening = legs((40, 0.3, 0, 0))
        found = cap.drive(joint, opening)
        sigma = found.tractions[:, 0]
        plastic = np.maximum(opening[:, 0] - sigma / joint.normal_stiffness, 0.0)
        # Rounding.
        assert np.abs(sigma - joint.f_t * np.exp(-joint.f_t * plastic / joint.G_I)).max() < 1e-13
        left = math.exp(-joint.f_t * plastic[-1] / joint.G_I)
        elastic = 0.5 * sigma[-1] ** 2 / joint.normal_stiffness
        assert found.work[-1] == pytest.approx(joint.G_I * (1.0 - left) + elastic, rel=1e-11)


def test_shear_of_a_joint_falls_from_the_peak_to_friction() -> None:
    for joint in (PLAIN, replace(DILATANT, tan_psi=0.0)):
        pressure = 0.5
        u = -pressure / joint.normal_stiffness
        found = cap.drive(joint, legs((1, u, 0, 0), (40, u, 0.6, 0.8)))
        left = np.exp(-joint.c * found.state[1:, 1] / joint.G_II)
        bond = joint.c + (joint.tan_phi - joint.mu) * pressure
        limit = joint.mu * pressure + bond * left
        slides = found.state[1:, 1] > 0.0
        assert slides.sum() > 35
        error = np.hypot(*found.tractions[1:, 1:].T) - limit
        assert np.abs(error[slides]).max() < 1e-12
        assert found.drift < 1e-13


@pytest.mark.parametrize("joint", [PLAIN, DILATANT], ids=["plain", "dilatant"])
def test_crushing_follows_the_curve_and_dissipates_its_energy(joint: cap.CapJoint) -> None:
    initial, middle, rest = joint.f_m / 3, joint.f_m / 2, joint.f_m / 7
    k_p, k_m = joint.kappa_p, joint.kappa_m
    # (12) with its printed digits.
    assert joint.f_m * (0.714 * k_p + 0.818 * (k_m - k_p)) == pytest.approx(joint.G_fc, rel=2e-4)

    def curve(k: float) -> float:
        if k <= k_p:
            return initial + (joint.f_m - initial) * math.sqrt(2 * k / k_p - (k / k_p) ** 2)
        if k <= k_m:
            return joint.f_m + (middle - joint.f_m) * ((k - k_p) / (k_m - k_p)) ** 2
        m = 2 * (middle - joint.f_m) / (k_m - k_p)
        return rest + (middle - rest) * math.exp(m * (k - k_m) / (middle - rest))

    # In pure pressure sqrt(C_nn) |sigma| = f_bar and the plastic closing is kappa (5, 8).
    closing = 20.0 * k_m
    found = cap.drive(joint, legs((40, -k_m, 0, 0), (20, -closing, 0, 0)))
    kappa = found.state[:, 2]
    assert kappa[0] < k_p < k_m < kappa[-1]
    limits = np.array([curve(k) for k in kappa])
    # The drift of f on this long path is 1.4e-11 MPa.
    error = math.sqrt(joint.C_nn) * found.tractions[:, 0] + limits
    assert (kappa > 0.0).sum() > 50
    assert np.abs(error[kappa > 0.0]).max() < 5e-11
    assert -found.state[:, 3] == pytest.approx(kappa, rel=1e-11)
    elastic = 0.5 * found.tractions[-1, 0] ** 2 / joint.normal_stiffness
    dissipated = (found.work[-1] - elastic) * math.sqrt(joint.C_nn) - rest * kappa[-1]
    # The rest of the exponential part beyond 20 kappa_m is 1e-20.
    assert dissipated == pytest.approx(joint.G_fc, rel=1e-10)


def test_slip_dilates_the_joint() -> None:
    """At a constant opening the pressure grows by the plastic opening; d u_p/d s_p is linear in it (6)."""
    joint = replace(DILATANT, delta=0.0, f_m=80.0, G_fc=30.0)
    found = cap.drive(joint, legs((1, -0.005, 0, 0), (40, -0.005, 0.4, 0)))
    assert found.branches == {(1,)}
    # -dsigma/ds_p = k_n tan psi_0 (1 + sigma/sigma_u): an exponential.
    rate = joint.normal_stiffness * joint.tan_psi / joint.sigma_u
    left = (1.0 - 0.005 * joint.normal_stiffness / joint.sigma_u) * np.exp(-rate * found.state[1:, 1])
    assert np.abs(found.tractions[1:, 0] - joint.sigma_u * (left - 1.0)).max() < 1e-11
    assert found.state[-1, 1] > 0.2


@pytest.mark.parametrize("case", CAP_CASES, ids=lambda case: case.name)
def test_curves_never_exceed_the_surfaces(case: JointCase) -> None:
    joint, table = case.joint, read(FOLDER / f"{case.name}.csv")
    assert isinstance(joint, cap.CapJoint)
    sigma, shear = table["sig_MPa"], np.hypot(table["tau1_MPa"], table["tau2_MPa"])
    bond = 1.0 - table["D"]
    friction = joint.mu + (joint.tan_phi - joint.mu) * bond
    # Ten times the drift of 2e-12 MPa.
    assert (sigma - bond * joint.f_t).max() < 2e-11
    assert (shear + friction * sigma - bond * joint.c).max() < 2e-11
    # Work is energy and dissipation, which never falls.
    energy = 0.5 * sigma**2 / joint.normal_stiffness + 0.5 * shear**2 / joint.shear_stiffness
    assert np.diff(table[WORK] - energy, prepend=0.0).min() > -1e-12


def test_the_paths_pass_every_set_of_surfaces() -> None:
    names = "cap_dilatant_mixed", "cap_plain_crushed_then_sheared"
    for name, sets in zip(names, ({(0,), (1,), (2,), (0, 1), (1, 2)}, {(0, 1), (1,), (2,)}), strict=True):
        case = next(case for case in CAP_CASES if case.name == name)
        assert isinstance(case.joint, cap.CapJoint)
        found = cap.drive(case.joint, case.path)
        assert found.branches == sets
        assert found.drift < 2e-11
