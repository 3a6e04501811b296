"""Builders: every part of a deck, key by key."""

from __future__ import annotations

import inspect

import pytest
import wythe
from wythe import build

STONE = build.elastic("5 GPa", 0.2, density="2000 kg/m^3")
JOINT = build.joint(
    "0.28 MPa", "0.87 MPa", 1.01, 0.73, zeta=4.38, xi=1.1, u_k="0.20 mm", delta_k="0.4 mm"
)


def test_springs_probes_corners_and_all_that_steps_may_have() -> None:
    corners = [[x, y, z] for z in (0, 10) for x, y in ((0, 0), (20, 0), (20, 20), (0, 20))]
    made = build.blocks(
        [
            build.block("lower", "stone", corners=corners, at=[0, 0, -10]),
            build.block(
                "upper",
                "stone",
                [20, 20, 10],
                velocity=["1 cm/s", 0, 0],
                rotate={"axis": "z", "angle": "90 deg"},
            ),
        ],
        points="corner",
        materials={"stone": STONE},
        interfaces={"joint": JOINT},
        contacts=[build.contact("joint")],
        supports=[build.support("lower", ["x", "y", "z"])],
        springs=[build.spring("soft", "upper.top", ["1 kN/m", 0, 0])],
        probes=[
            build.probe("gap", "z", "upper.bottom", minus="lower.top"),
            build.probe("corner", "x", near=[20, 0, 10], quantity="velocity"),
        ],
        steps=[
            build.gravity("9.81 m/s^2", angle=1, axis="x"),
            build.drive(
                "1 mm",
                "-x",
                spring="soft",
                stop={"below_peak": 0.8},
                control={"probe": "gap", "displacement": "0.1 mm"},
                procedure="displacement_control",
                tolerance={"max_iterations": 30},
            ),
            build.free("0.1 s", alpha=-0.1, rayleigh={"mass": "0.5 s^-1"}),
        ],
        output={"every": 3},
        element={"formulation": "b-bar"},
    )
    same = wythe.Model.from_toml(
        """
        format = 1
        title = "blocks"
        materials.stone = { E = 5000, nu = 0.2, density = 2e-9 }
        contact.points = "corner"
        output.every = 3
        element.formulation = "b-bar"
        [interfaces.joint]
        f_t = 0.28
        c = 0.87
        tan_phi = 1.01
        mu = 0.73
        zeta = 4.38
        xi = 1.1
        u_k = 0.2
        delta_k = 0.4
        [[blocks]]
        name = "lower"
        material = "stone"
        at = [0, 0, -10]
        corners = [[0, 0, 0], [20, 0, 0], [20, 20, 0], [0, 20, 0],
                   [0, 0, 10], [20, 0, 10], [20, 20, 10], [0, 20, 10]]
        [[blocks]]
        name = "upper"
        material = "stone"
        size = [20, 20, 10]
        velocity = [10, 0, 0]
        rotate = { axis = "z", angle = 90 }
        [[contacts]]
        interface = "joint"
        [[supports]]
        on = "lower"
        [[springs]]
        name = "soft"
        on = "upper.top"
        stiffness = [1, 0, 0]
        [[probes]]
        name = "gap"
        direction = "z"
        on = "upper.bottom"
        minus = "lower.top"
        [[probes]]
        name = "corner"
        direction = "x"
        near = [20, 0, 10]
        quantity = "velocity"
        [[steps]]
        kind = "gravity"
        gravity = 9810
        angle = 1
        axis = "x"
        [[steps]]
        kind = "drive"
        direction = "-x"
        displacement = 1
        spring = "soft"
        stop = { below_peak = 0.8 }
        procedure = "displacement_control"
        control = { probe = "gap", displacement = 0.1 }
        tolerance = { max_iterations = 30 }
        [[steps]]
        kind = "free"
        duration = 0.1
        procedure = "dynamic"
        alpha = -0.1
        rayleigh = { mass = 0.5 }
        """
    )
    assert made == same


def test_every_argument_of_materials_and_joints_is_a_key() -> None:
    """What a part is given it says, under the deck's name; what it is not given it leaves out."""
    numbers = {"f_t": 0.2, "c": 0.3, "tan_phi": 0.7, "mu": 0.6, "zeta": 4.0, "xi": 1.5}
    numbers |= {"u_k": 0.3, "delta_k": 0.5, "penalty_factor": 100.0}
    numbers |= {"normal_stiffness": 50.0, "shear_stiffness": 20.0}
    joint = build.joint(**numbers, coupling="additive")  # type: ignore[arg-type]
    assert joint == {**numbers, "coupling": "additive"}
    assert build.joint(0.2, 0.3, 0.7, 0.6, zeta=4, xi=1, G_I="10 N/m", G_II=0.1)["G_II"] == 0.1
    solid = build.damage_plasticity(
        1000,
        0.2,
        [[1, 0, 0], [0.1, 0.01, 0.9]],
        [[5, 0, 0], [1, 0.01, 0.9]],
        reference_length=10,
        dilation_angle="20 deg",
        eccentricity=0.2,
        fb0_fc0=1.2,
        K_c=0.7,
        tension_recovery=0.1,
        compression_recovery=0.9,
        viscosity=1e-4,
        crack_band="projected",
        interpolation="lit",
        density=2e-9,
    )
    energies = {"f_t": 1, "G_ft": "30 N/m", "f_c": 20, "G_fc": 22}
    keys = set(inspect.signature(build.damage_plasticity).parameters)
    assert set(solid) == keys - set(energies)
    assert build.damage_plasticity(6000, 0.15, **energies) == {"E": 6000, "nu": 0.15, **energies}  # type: ignore[arg-type]
    model = wythe.templates.couplet()
    changed = model.with_({"materials.brick": solid, "interfaces.joint": joint})
    # A deck says the law of each, which is the default here.
    assert changed.material("brick") == {"kind": "damage-plasticity", **solid, "dilation_angle": 20.0}
    assert changed.interface("joint") == {"kind": "cohesive-frictional", **joint}
    assert build.elastic(5, 0.1) == {"E": 5, "nu": 0.1}


def test_materials_and_joints_by_name_take_what_is_left_out() -> None:
    model = wythe.templates.couplet().with_(
        {
            "materials.brick": build.by_name("clay brick, solid", f_b="20 MPa"),
            "interfaces.joint": build.by_name("M5 on clay", normal_stiffness=50, shear_stiffness=20),
        }
    )
    brick, joint = model.material("brick"), model.interface("joint")
    assert (brick["E"], brick["f_c"], brick["G_ft"]) == (6000, 20, 0.029)
    assert (joint["c"], joint["mu"], joint["normal_stiffness"]) == (0.25, 0.5, 50)
    with pytest.raises(wythe.ModelError, match="no material named"):
        model.with_({"materials.brick": build.by_name("clay brik")})


def test_a_block_of_nodes_and_a_joint_that_scatters_are_parts() -> None:
    assert build.block("a", "stone", nodes="nodes.csv") == {
        "name": "a",
        "material": "stone",
        "nodes": "nodes.csv",
    }
    scattered = build.joint(0, 0, 0, 0, zeta=1, xi=1, scatter={"cv": 0.3, "seed": 1})
    assert scattered["scatter"] == {"cv": 0.3, "seed": 1}


def test_errors_are_those_of_the_deck() -> None:
    with pytest.raises(wythe.ModelError) as raised:
        build.wall(
            unit=[204, 98, 50],
            length=990,
            courses=0,
            brick=STONE,
            mortar=STONE,
            joint=build.joint(0.2, 0.2, 0.7, 0.7, zeta=4, xi=1, delta_k=0.4),
            steps=[build.preload(1)],
        )
    keys = [raised.value.key, *(other.key for other in raised.value.others)]
    assert "wall.courses" in keys
    assert any(key.startswith("interfaces.joint") for key in keys)
    assert raised.value.line is None
