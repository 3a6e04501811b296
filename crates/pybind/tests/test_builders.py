"""Builders: each part makes the model that the same TOML makes."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
import wythe
from helpers import EXAMPLES
from wythe import build


def example(number: str, **named: str) -> wythe.Model:
    """An example, with names of materials and interfaces replaced by those that builders give."""
    (path,) = EXAMPLES.glob(f"{number}_*.toml")
    text = path.read_text()
    for old, new in named.items():
        for kind in ("material", "interface"):
            text = text.replace(f"[{kind}s.{old}]", f"[{kind}s.{new}]")
            text = text.replace(f'{kind} = "{old}"', f'{kind} = "{new}"')
    return wythe.Model.from_toml(text)


STONE = build.elastic("5 GPa", 0.2, density="2000 kg/m^3")
JOINT = build.joint(
    "0.28 MPa", "0.87 MPa", 1.01, 0.73, zeta=4.38, xi=1.1, u_k="0.20 mm", delta_k="0.4 mm"
)


@pytest.mark.parametrize("rows", [list, np.array])
def test_a_wall_that_cracks(rows: type) -> None:
    made = build.wall(
        title="Shear wall J7D",
        unit=["204 mm", "98 mm", "50 mm"],
        bed_joint=12.5,
        head_joint="12.5 mm",
        length="990 mm",
        courses=18,
        mesh="coarse",
        brick=build.damage_plasticity(
            16700,
            0.15,
            tension=rows([[3.5, 0, 0], [0.3, 0.002, 0.95]]),
            compression=rows([[11.0, 0, 0], [11.5, 0.001, 0], [0.6, 0.007, 0.95]]),
            reference_length="50 mm",
        ),
        mortar=build.damage_plasticity(
            "850 MPa",
            0.15,
            tension=rows([[1.5, 0, 0], [0.1, 0.002, 0.95]]),
            compression=rows([[7.8, 0, 0], [8.2, 0.002, 0], [0.4, 0.015, 0.95]]),
            reference_length=31.4,
        ),
        joint=build.joint(
            0.2, 0.22, 0.75, 0.75, zeta=4.38, xi=1.1, u_k="0.36 mm", delta_k="0.4 mm"
        ),
        steps=[build.preload("2.12 MPa"), build.drive("4 mm", viscosity=0.0025)],
    )
    assert made == example("03")


def test_a_strip_under_an_airbag() -> None:
    joint = build.joint(
        "0.20 MPa", "0.30 MPa", 0.75, 0.75, zeta=4.38, xi=1.1, G_I="10 N/m", G_II="30 N/m", penalty_factor=50
    )
    made = build.blocks(
        title="Strip under an airbag",
        materials={"unit": build.elastic("5 GPa", 0.15)},
        interfaces={"joint": joint},
        blocks=[
            build.block(
                "unit", "unit", [100, 100, 100], mesh=[1, 4, 2], copies=[1, 1, 8], pitch=[0, 0, 100]
            )
        ],
        contacts=[build.contact("joint")],
        supports=[
            build.support("unit-0-0-0.bottom", ["x", "y"]),
            build.support("unit-0-0-7.top", ["x", "y"]),
        ],
        springs=[build.spring("foot", "unit-0-0-0.bottom", [0, 0, "1 MN/mm"])],
        probes=[build.probe("middle", "y", near=[50, 100, 400])],
        steps=[
            build.loading(build.load("roof", "unit-0-0-7.top", force=[0, 0, "-1 kN"]), name="roof"),
            build.loading(
                build.load("airbag", "unit.front", pressure="5 kPa"),
                name="airbag",
                procedure="displacement_control",
                control={"probe": "middle", "displacement": "5 mm"},
            ),
        ],
    )
    assert made == example("40")


def test_cycles_and_lines() -> None:
    push = build.drive(cycles={"amplitudes": ["1 mm", "2 mm"], "repeat": 2}, face="block.top", free=["z"])
    (step,) = example("41").to_dict()["steps"][1:]
    assert {key: step[key] for key in push if key != "cycles"} == {
        key: push[key] for key in push if key != "cycles"
    }
    line = build.load("wind", line=([0, 0, 0], [9, 0, 0]), line_force=[0, 1, 0])
    assert line == {"name": "wind", "from": [0, 0, 0], "to": [9, 0, 0], "line_force": [0, 1, 0]}


def test_a_couplet() -> None:
    brick, mortar = build.elastic("16700 MPa", 0.15), build.elastic("2970 MPa", 0.15)
    template = wythe.templates.couplet()
    made = build.wall(
        title="couplet",
        unit=[204, 98, 50],
        bed_joint=15,
        head_joint=15,
        length=204,
        courses=2,
        brick=brick,
        mortar=mortar,
        joint=JOINT,
        clamped={"bottom_courses": 0, "top_courses": 0},
        steps=[
            build.drive("0.006 mm", "z", name="peak"),
            build.drive("0.25 mm", "z", name="softening"),
        ],
    )
    assert made == template


#: The stones of example 07.
semicircle = partial(
    build.arch,
    title="Semicircular arch",
    contact={"points": "corner"},
    thickness="107.01 mm",
    width="200 mm",
    voussoirs=11,
    stone=STONE,
    joint=build.dry_joint(2, normal_stiffness="100 N/mm^3", shear_stiffness="100 N/mm^3"),
    steps=[build.gravity()],
)


def test_an_arch() -> None:
    assert semicircle(radius="1 m") == example("07", dry="joint")


def test_an_arch_by_its_span() -> None:
    deck = example("07", dry="joint").with_({"arch.span": "1.8 m", "arch.angle": "150 deg"})
    assert semicircle(span="1.8 m", angle=150, mesh=[1, 1, 1]) == deck


def test_a_block_that_slides() -> None:
    made = build.blocks(
        [
            build.block("ground", "stone", [1500, 200, 50], [0, 0, "-50 mm"], mesh=[15, 1, 1]),
            build.block("block", "stone", [200, 100, 100], ["50 mm", 50, 0], mesh=[2, 1, 1]),
        ],
        title="Block sliding down an incline",
        points="corner",
        materials={"stone": STONE},
        interfaces={"dry": build.dry_joint(0.4, normal_stiffness="10 N/mm^3", shear_stiffness=4)},
        contacts=[build.contact("dry", "block.bottom", "ground.top")],
        supports=[build.support("ground")],
        steps=[
            build.gravity(),
            build.free("1.2 s", angle="30 deg", increments={"initial": 0.002, "max": 0.01}),
        ],
    )
    assert made == example("05")


def test_a_column_of_copies() -> None:
    made = build.blocks(
        [
            build.block("table", "stone", [800, 300, 100], [-200, -50, -100]),
            build.block("block", "stone", [400, 200, 175], copies=[1, 1, 6], pitch=[0, 0, 175]),
        ],
        title="Column on a tilting table",
        points="corner",
        materials={"stone": STONE},
        interfaces={"dry": build.dry_joint(0.65)},
        contacts=[build.contact("dry")],
        supports=[build.support("table")],
        steps=[build.gravity(), build.tilt("25 deg")],
    )
    assert made == example("06")


def test_bonded_blocks() -> None:
    made = build.blocks(
        [
            build.block("lower", "stone", [200, 100, 50], mesh=[2, 1, 1]),
            build.block("upper", "stone", [200, 100, 50], [0, 0, 50], mesh=[4, 2, 1]),
        ],
        title="Couplet of two blocks",
        materials={"stone": build.elastic("5 GPa", 0.2)},
        interfaces={"joint": JOINT},
        contacts=[build.contact("joint", "upper.bottom", "lower.top")],
        supports=[build.support("lower.bottom")],
        steps=[
            build.preload("0.5 MPa", face="upper.top"),
            build.drive("0.6 mm", face="upper.top", free=["z"]),
        ],
    )
    assert made == example("08")


def test_an_imported_mesh() -> None:
    made = build.blocks(
        [build.block("plate", "stone", [200, 100, 20], mesh=[2, 1, 1])],
        title="Couplet from Abaqus",
        imports=[build.mesh("couplet", "50_imported_mesh.inp", at=[0, 0, 20])],
        materials={"stone": build.elastic("30 GPa", 0.2)},
        interfaces={"joint": JOINT},
        contacts=[
            build.contact("joint", "couplet.UPPER.BED", "couplet.LOWER.TOP"),
            build.contact("joint"),
        ],
        supports=[build.support("plate")],
        probes=[build.probe("slip", "x", on="couplet.UPPER.BED", minus="couplet.LOWER.TOP")],
        steps=[
            build.preload("0.5 MPa", face="couplet.UPPER.TOP"),
            build.drive("0.3 mm", face="couplet.UPPER.TOP", free=["z"]),
        ],
    )
    assert made == example("50")


def test_a_dry_wall_with_an_opening() -> None:
    model = build.wall(
        unit=[200, 100, 50],
        length=1000,
        courses=6,
        brick=build.elastic(20e3, 0.2, density="2300 kg/m^3"),
        joint=build.dry_joint(0.6),
        overlap=100,
        mesh=[2, 1, 1],
        openings=[{"from": 400, "to": 600, "sill": 1, "courses": 3, "lintel": {"bearing": 100, "material": "timber"}}],
        materials={"timber": build.elastic(10e3, 0.3, density="500 kg/m^3")},
        clamped=False,
        supports=[build.support("wall.bottom", box=[[0, 0, 0], [1000, 100, 0]])],
        contact={"points": "corner"},
        steps=[build.gravity()],
    )
    found = model.check()
    # Courses of 5 or 6 units; three of them without what lies between 400 and 600 mm, one with the lintel.
    assert (found.ok, found.units) == (True, 5 + 6 + 4 + 6 + 5 + 6), found


def test_a_pier_below_a_beam() -> None:
    made = build.wall(
        title="Rocking pier",
        unit=["400 mm", "200 mm", "100 mm"],
        length="400 mm",
        courses=10,
        rigid=True,
        clamped=False,
        brick=build.elastic("15500 MPa", 0.2, density="2300 kg/m^3"),
        joint=build.dry_joint(0.7, normal_stiffness="100 N/mm^3", shear_stiffness="40 N/mm^3"),
        contact={"points": "corner"},
        blocks=[
            build.block(
                "ground", "brick", ["600 mm", "200 mm", "50 mm"], at=["-100 mm", 0, "-50 mm"], rigid=True
            )
        ],
        contacts=[build.contact("joint", "wall.bottom", "ground.top")],
        supports=[build.support("ground")],
        beams=[build.beam("beam", "wall.top", "100 mm", "joint", rotation="free")],
        steps=[
            build.gravity(),
            build.preload("0.5 MPa", beam="beam", name="press"),
            build.drive("5 mm", beam="beam", name="push"),
        ],
    )
    assert made == example("66", stone="brick", dry="joint")


def test_a_quarter_of_a_wall() -> None:
    whole = example("65", dry="joint")
    planes = [build.symmetry("x", "300 mm"), build.symmetry("z", "200 mm")]
    assert whole.with_(symmetry=planes) == whole


def test_an_arch_by_its_rise() -> None:
    dry = build.dry_joint(0.7, normal_stiffness="100 N/mm^3", shear_stiffness="40 N/mm^3")
    stone = build.elastic("5000 MPa", 0.2, density="2000 kg/m^3")
    made = build.arch(
        title="Segmental arch on a tilting table",
        contact={"points": "corner"},
        span="2 m",
        rise="500 mm",
        thickness="150 mm",
        width="200 mm",
        voussoirs=13,
        stone=stone,
        joint=dry,
        rigid=True,
        steps=[build.gravity(), build.tilt("10 deg")],
    )
    assert made == example("67", dry="joint")


def test_columns_below_a_lintel() -> None:
    rigid = partial(build.block, material="stone", rigid=True)
    pier = partial(rigid, size=["500 mm", "600 mm", "400 mm"], stack=4, interface="dry")
    made = build.blocks(
        title="Trilithon on a tilting table",
        points="corner",
        materials={"stone": build.elastic("5000 MPa", 0.2, density="2400 kg/m^3")},
        interfaces={
            "dry": build.dry_joint(0.8, normal_stiffness="100 N/mm^3", shear_stiffness="40 N/mm^3")
        },
        blocks=[
            rigid("ground", size=["3 m", "600 mm", "100 mm"], at=["-500 mm", 0, "-100 mm"]),
            pier("left"),
            pier("right", at=["1500 mm", 0, 0]),
            rigid("lintel", size=["2 m", "600 mm", "300 mm"], at=[0, 0, "1600 mm"]),
        ],
        contacts=[
            build.contact("dry", ["left-0.bottom", "right-0.bottom"], "ground.top"),
            build.contact("dry", ["left-3.top", "right-3.top"], "lintel.bottom"),
        ],
        supports=[build.support("ground")],
        probes=[build.probe("lintel", "x", "lintel")],
        steps=[build.gravity(), build.tilt("16 deg")],
    )
    assert made == example("68")


def test_a_wall_says_where_it_stands_and_what_its_joints_are() -> None:
    joint = build.dry_joint(0.6)
    made = build.wall(
        name="gable",
        at=[100, 0, 50],
        along="y",
        unit=[200, 100, 100],
        length=1000,
        courses=2,
        bond="stretcher",
        leaves=2,
        collar_joint=0,
        brick=build.elastic(20e3, 0.2, density="2300 kg/m^3"),
        joint=joint,
        interfaces={"open": build.dry_joint(0.3), "collar": build.dry_joint(0.4)},
        head_interface="open",
        collar_interface="collar",
        clamped=False,
        supports=[build.support("gable.bottom")],
        steps=[build.gravity()],
    )
    told = made.to_dict()["wall"]
    assert (told["name"], told["along"]) == ("gable", "y")
    assert (told["head_interface"], told["collar_interface"]) == ("open", "collar")
    found = made.check()
    assert found.ok, found


def test_the_search_radius_of_blocks() -> None:
    with pytest.raises(wythe.ModelError, match="search_radius"):
        build.blocks(
            [build.block("block", "brick", [100, 100, 100])],
            materials={"brick": build.elastic(20e3, 0.2, density="2300 kg/m^3")},
            interfaces={},
            supports=[build.support("block.bottom")],
            steps=[build.gravity()],
            search_radius=0,
        )


def test_facets_in_parts() -> None:
    def blocks(parts: list[int]) -> wythe.Model:
        return build.blocks(
            [
                build.block("lower", "stone", [200, 100, 50]),
                build.block("upper", "stone", [200, 100, 50], [0, 0, 50]),
            ],
            materials={"stone": build.elastic("5 GPa", 0.2)},
            interfaces={"joint": JOINT},
            contacts=[build.contact("joint", "upper.bottom", "lower.top")],
            supports=[build.support("lower.bottom")],
            steps=[build.preload("0.5 MPa", face="upper.top")],
            parts=parts,
        )

    whole, cut = (blocks(parts).check().contact_points for parts in ([1, 1, 1], [3, 2, 4]))
    assert cut == 6 * whole
    with pytest.raises(wythe.ModelError, match=r"contact\.parts"):
        blocks([0, 1, 1])


def test_contact_points_are_those_of_decks() -> None:
    """Corner points would make an elastic joint three times as stiff against rotation."""
    made = build.blocks(
        [
            build.block("lower", "stone", [200, 100, 50]),
            build.block("upper", "stone", [200, 100, 50], [0, 0, 50]),
        ],
        materials={"stone": STONE},
        interfaces={"joint": JOINT},
        contacts=[build.contact("joint")],
        supports=[build.support("lower.bottom")],
        steps=[build.gravity()],
    )
    assert made.to_dict()["contact"]["points"] == "auto"


def test_arguments_that_exclude_each_other() -> None:
    wall = partial(
        build.wall,
        unit=[200, 100, 50],
        length=600,
        courses=2,
        brick=STONE,
        steps=[build.gravity()],
        clamped=False,
        supports=[build.support("wall.bottom")],
    )
    dry = wall(joint=build.dry_joint(0.6), bed_joint=0, head_joint="0 mm")
    assert dry.to_dict()["wall"]["bed_joint"] == 0.0
    with pytest.raises(ValueError, match="bed_joint: a wall without mortar"):
        wall(joint=build.dry_joint(0.6), bed_joint=5)
    with pytest.raises(ValueError, match="wall: given twice"):
        wall(joint=build.dry_joint(0.6), wall={"courses": 3})
    with pytest.raises(ValueError, match="contact: given twice"):
        build.blocks(
            [build.block("block", "stone", [100, 100, 100])],
            materials={"stone": STONE},
            interfaces={},
            supports=[build.support("block.bottom")],
            steps=[build.gravity()],
            parts=[2, 2, 2],
            contact={"points": "corner"},
        )


def test_ties_layers_floors_settlements_and_sections() -> None:
    stone = {"kind": "drucker-prager", "E": 2000, "nu": 0.2, "c": 1.2, "phi": 35, "f_t": 0.4, "density": 1.6e-9}
    assert build.drucker_prager(2000, 0.2, 1.2, 35, 0.4, density=1.6e-9) == stone
    cap = build.cap_joint(
        0.2, 0.3, 0.7, 0.6, f_m=8, kappa_p=0.1, G_fc=5, G_I=0.02, G_II=0.1,
        normal_stiffness=100, shear_stiffness=40,
    )  # fmt: skip
    assert cap["kind"] == "cap"
    pier = partial(build.block, material="tuff", size=[200, 400, 1000], mesh=[2, 2, 4])
    made = build.blocks(
        [pier("left", at=[0, 0, 0]), pier("right", at=[1800, 0, 0])],
        materials={"tuff": stone, "render": build.elastic(5000, 0.2, density=1.8e-9)},
        interfaces={"bond": cap},
        supports=[build.support("left.bottom")],
        steps=[build.gravity(), build.drive("1 mm", settlement="ground")],
        ties=[build.tie("rod", [[100, 200, 900], [1900, 200, 900]], E=210e3, diameter=16, prestress=1000)],
        layers=[build.layer("render", "left.left", 20, "render", "bond")],
        floors=[build.floor("slab", ["left.top", "right.top"], load="3 kN/m^2", axial=100)],
        settlements=[build.settlement("ground", "right.bottom", table={"at": [1800, 2000], "values": [1, 1]})],
        sections=[build.section("foot", [0, 0, 250], "z", of="left")],
        probes=[build.probe("gap", gauge=[[200, 0, 1000], [1800, 0, 1000]])],
    )
    found = made.check()
    assert found.ok, found
