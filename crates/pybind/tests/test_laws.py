"""Laws that Python functions give: joints and solids, at points and in runs."""

from __future__ import annotations

import re
from dataclasses import fields
from typing import Any

import numpy as np
import pytest
import wythe
from helpers import ROOT
from wythe import JointLaw, LawError, SolidLaw

STIFFNESS = (400.0, 160.0)


def elastic(gap: Any, plastic: Any, state: Any, stiffness: Any) -> Any:
    k = np.array([stiffness[0], stiffness[1], stiffness[1]])
    return k * (gap - plastic), np.diag(k)


def friction(gap: Any, plastic: Any, state: Any, stiffness: Any) -> Any:
    """Coulomb with μ = 0.6, without tension; the state is the length slipped."""
    k_n, k_s = stiffness
    if gap[0] > 0.0:
        return np.zeros(3), np.zeros((3, 3)), state
    k = np.array([k_n, k_s, k_s])
    traction = k * np.array([gap[0], *(gap - plastic)[1:]])
    tangent = np.diag(k)
    tau, limit = np.hypot(*traction[1:]), -0.6 * traction[0]
    if tau > limit:
        n = traction[1:] / tau
        tangent[1:, 0] = -0.6 * k_n * n
        tangent[1:, 1:] = limit / tau * k_s * (np.eye(2) - np.outer(n, n))
        traction[1:] = limit * n
        state = state + (tau - limit) / k_s
    return traction, tangent, state


FRICTION = JointLaw("friction", friction, state={"slipped": "mm"})


def von_mises(strain: Any, plastic: Any, state: Any, elastic: Any) -> Any:
    """J2 plasticity with yield stress 40 MPa and hardening 500 MPa; the state is κ."""
    young, nu = elastic
    shear, bulk = young / (2 * (1 + nu)), young / (3 * (1 - 2 * nu))
    unit = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    deviator = np.diag([1.0, 1.0, 1.0, 0.5, 0.5, 0.5]) - np.outer(unit, unit) / 3
    tangent = bulk * np.outer(unit, unit) + 2 * shear * deviator
    stress = tangent @ (strain - plastic)
    s = stress - unit * stress[:3].mean()
    q = np.sqrt(1.5 * (s @ (s * [1, 1, 1, 2, 2, 2])))
    beyond = q - 40.0 - 500.0 * state[0]
    if beyond <= 0.0:
        return stress, tangent, state
    kappa = beyond / (3 * shear + 500.0)
    along = (3 * shear / q) ** 2 * (kappa / q - 1 / (3 * shear + 500.0))
    softer = 2 * shear * (3 * shear * kappa / q) * deviator
    return stress - 3 * shear * kappa / q * s, tangent - softer + along * np.outer(s, s), state + kappa


VON_MISES = SolidLaw("von Mises", von_mises, state={"hardening": "1"})


def test_laws_pass_their_checks() -> None:
    JointLaw("elastic", elastic).check(stiffness=STIFFNESS)
    FRICTION.check(stiffness=STIFFNESS, step=1e-3)
    VON_MISES.check(elastic=(20_000, 0.3), step=5e-4)


def test_a_point_slides_at_its_limit() -> None:
    gaps = np.zeros((2, 20, 3))
    gaps[:, :, 0] = -1e-3
    gaps[1, :, 1] = np.linspace(0, 0.01, 20)
    found = FRICTION.drive(gaps, stiffness=STIFFNESS)
    assert found.tractions.shape == (2, 20, 3)
    assert found.tractions[0, -1] == pytest.approx([-0.4, 0.0, 0.0])
    assert found.tractions[1, -1] == pytest.approx([-0.4, 0.24, 0.0])


def test_a_solid_yields_by_hand() -> None:
    strains = np.zeros((5, 6))
    strains[:, 0] = np.linspace(0.002, 0.01, 5)
    found = VON_MISES.drive(strains, elastic=(20_000, 0.3), stress=["yy", "zz"])
    # σ = f_y + H κ and ε = σ/E + κ.
    kappa = (0.01 - 40 / 20e3) / (1 + 500 / 20e3)
    assert found.stresses[-1, 0] == pytest.approx(40 + 500 * kappa, rel=1e-9)


def test_a_couplet_runs_with_a_law_of_ones_own() -> None:
    couplet = wythe.Model.from_toml(ROOT / "examples" / "02_couplet_shear.toml")
    run = couplet.run(laws={"joint": FRICTION})
    # A law without bond carries μ p A.
    assert run.peak_force == pytest.approx(0.6 * 0.5 * 204 * 98 / 1e3, rel=1e-2)
    assert any("Python law `friction`" in warning for warning in run.warnings)


def test_own_laws_refuse_joints_of_which_they_would_not_know_all() -> None:
    """A plane of symmetry halves the gap of a joint, and a scatter its bond; neither reaches a law of one's own."""
    joint = wythe.build.joint(
        0.5, 0.6, 0.7, 0.6, zeta=4, xi=2, G_I=0.02, G_II=0.1, normal_stiffness=400, shear_stiffness=160
    )
    half = wythe.build.wall(
        unit=[200, 100, 100],
        length=400,
        courses=1,
        bed_joint=0,
        head_joint=0,
        bond="stack",
        brick=wythe.build.elastic("10 GPa", 0.0),
        joint=joint,
        clamped=False,
        symmetry=[wythe.build.symmetry("x", 200, "above")],
        supports=[wythe.build.support("wall.bottom", ["z"]), wythe.build.support("wall.front", ["y"])],
        steps=[wythe.build.drive(0.15, "x", face="wall.right", free=["y", "z"])],
    )
    with pytest.raises(ValueError, match=r"a plane of \[\[symmetry\]\] cuts joints of interface `joint`"):
        half.run(laws={"joint": FRICTION})
    text = (ROOT / "examples" / "02_couplet_shear.toml").read_text()
    text = text.replace("[interfaces.joint]", "[interfaces.joint]\nscatter = { cv = 0.2, seed = 1 }")
    with pytest.raises(ValueError, match="the bond of interface `joint` scatters"):
        wythe.Model.from_toml(text).run(laws={"joint": FRICTION})


def test_a_block_runs_with_a_solid_of_ones_own() -> None:
    block = wythe.Model.from_toml(
        """
        format = 1
        materials.steel = { E = "20 GPa", nu = 0.3 }
        blocks = [{ name = "cube", size = [100, 100, 100], material = "steel", mesh = [1, 1, 1] }]
        supports = [
            { on = "cube.bottom", fixed = ["z"] }, { on = "cube.left", fixed = ["x"] },
            { on = "cube.front", fixed = ["y"] },
        ]
        [[steps]]
        kind = "drive"
        face = "cube.top"
        free = ["x", "y"]
        direction = "z"
        displacement = "1 mm"
        """
    )
    run = block.run(laws={"steel": VON_MISES})
    kappa = (0.01 - 40 / 20e3) / (1 + 500 / 20e3)
    # The default tolerance of a step leaves some 1e-5 of the force out of balance.
    assert run.peak_force == pytest.approx(1e4 * (40 + 500 * kappa) / 1e3, rel=1e-4)


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda *_: np.zeros(3), r"the law `wrong` returns \(traction, tangent\), got ndarray"),
        (lambda *_: (np.zeros(2), np.eye(3)), r"traction of the law `wrong` has the shape \(3,\)"),
        (lambda *_: (np.zeros(3), np.eye(2)), r"tangent of the law `wrong` has the shape \(3, 3\)"),
        (lambda *_: (np.full(3, np.nan), np.eye(3)), "traction of the law `wrong` is not finite"),
        (lambda *_: (np.zeros(3), "x"), "tangent of the law `wrong` is no array"),
        (lambda *_: 1 / 0, "the law `wrong` raised ZeroDivisionError"),
    ],
)
def test_a_wrong_law_is_named(function: Any, message: str) -> None:
    law = JointLaw("wrong", function)
    with pytest.raises(LawError, match=message):
        law.drive([[1e-3, 0, 0]], stiffness=STIFFNESS)
    with pytest.raises(LawError, match=message):
        law.check(stiffness=STIFFNESS)
    couplet = wythe.Model.from_toml(ROOT / "examples" / "02_couplet_shear.toml")
    with pytest.raises(LawError, match=message):
        couplet.run(laws={"joint": law})


def test_a_law_that_fails_midway_keeps_its_results(tmp_path: Any) -> None:
    def late(gap: Any, plastic: Any, state: Any, stiffness: Any) -> Any:
        if abs(gap[1]) > 1e-5:
            raise RuntimeError("too far")
        return elastic(gap, plastic, state, stiffness)

    couplet = wythe.Model.from_toml(ROOT / "examples" / "02_couplet_shear.toml")
    with pytest.raises(LawError, match="too far") as caught:
        couplet.run(tmp_path / "run", laws={"joint": JointLaw("late", late)})
    assert isinstance(caught.value.__cause__, RuntimeError)
    assert len(wythe.Results(tmp_path / "run").history) > 0


def test_a_run_with_laws_goes_on_with_them(tmp_path: Any) -> None:
    couplet, laws = wythe.templates.couplet("0.01 mm"), {"joint": JointLaw("elastic", elastic)}
    whole = couplet.run(tmp_path / "whole", laws=laws, threads=1)
    half = len(whole.history) // 2
    stopped = couplet.run(
        tmp_path / "part", laws=laws, threads=1, callback=lambda row: row.increment < half
    )
    assert stopped.status == "stopped"
    with pytest.raises(wythe.ModelError, match=r"resume\(laws=\.\.\.\) takes again"):
        stopped.resume()
    assert stopped.resume(laws=laws, threads=1).status == "completed"
    histories = [(tmp_path / name / "history.csv").read_bytes() for name in ("whole", "part")]
    assert histories[0] == histories[1]


def test_the_taken_names_are_those_of_the_files_of_a_run() -> None:
    folder = ROOT / "crates" / "core" / "src" / "results" / "vtkhdf"
    work, quads = ((folder / name).read_text(encoding="utf-8") for name in ("work.rs", "quads.rs"))
    solids, surfaces = (
        set(re.findall(r'column\("(\w+)"', work.split(f"const {name}:")[1].split("];")[0]))
        for name in ("SOLIDS", "SURFACES")
    )
    of_elements = set(re.findall(r'"(\w+)",', work.split("fn labels")[1]))
    of_points = set(re.findall(r'\("(\w+)", four', quads))
    assert {"stress", "material"} <= solids | of_elements and {"damage", "law"} <= surfaces | of_points
    assert JointLaw._taken == surfaces | of_points | {"plastic_opening"}
    maxima = {field.name[4:] for field in fields(wythe.Increment) if field.name.startswith("max_")}
    assert SolidLaw._taken == solids | of_elements | maxima


def test_a_name_that_the_other_kind_has_is_free() -> None:
    couplet = wythe.templates.couplet("0.01 mm")
    law = JointLaw("joint", lambda g, p, s, k: (*elastic(g, p, s, k), s), state={"stress": "1"})
    assert couplet.run(laws={"joint": law}, threads=1).status == "completed"


def test_wrong_arguments_are_named() -> None:
    couplet = wythe.templates.couplet()
    with pytest.raises(ValueError, match="the model has no interface `mortar`; it has"):
        couplet.run(laws={"mortar": FRICTION})
    with pytest.raises(ValueError, match="the model has no material `stone`; it has"):
        couplet.run(laws={"stone": VON_MISES})
    with pytest.raises(TypeError, match=r"laws\['joint'\]"):
        couplet.run(laws={"joint": friction})  # type: ignore[dict-item]
    with pytest.raises(ValueError, match="state: at most 3"):
        JointLaw("many", friction, state={name: "1" for name in "abcd"})
    with pytest.raises(TypeError, match="state: "):
        JointLaw("odd", friction, state={"Big Name": "1"})
    with pytest.raises(ValueError, match="state: `damage` is the name of a field or column that runs have; taken are"):
        JointLaw("taken", friction, state={"damage": "1"})
    with pytest.raises(ValueError, match="state: `crack_width` is the name of a field"):
        SolidLaw("taken", von_mises, state={"crack_width": "mm"})
    with pytest.raises(TypeError, match="function: "):
        SolidLaw("none", None)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="softening: "):
        JointLaw("soft", friction, softening=(1.0, -1.0))
    with pytest.raises(LawError, match="tangent"):
        JointLaw("stiff", lambda g, p, s, k: (elastic(g, p, s, k)[0], np.eye(3))).check(
            stiffness=STIFFNESS
        )


def test_a_solid_law_is_never_left_out_without_a_word() -> None:
    text = (ROOT / "examples" / "02_couplet_shear.toml").read_text()
    model = wythe.Model.from_toml(text).with_({"fidelity": "elastic"})
    name = next(iter(model.to_dict()["materials"]))
    with pytest.raises(ValueError, match="solids stay linear elastic"):
        model.run(laws={name: VON_MISES})
