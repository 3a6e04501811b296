"""Golden curves of damage plasticity and of the cohesive-frictional joint: materials, joints and paths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cap import CapJoint
from damage_plasticity import Material
from drucker_prager import DruckerPrager
from joint import Joint
from tables import Floats

#: Table 3 of the paper.
BRICK = Material(
    16700.0,
    0.15,
    [(3.5, 0.0, 0.0), (0.3, 0.002, 0.95)],
    [(11.0, 0.0, 0.0), (11.5, 0.001, 0.0), (0.6, 0.007, 0.95)],
)
#: Table 3 of the paper, in plane.
MORTAR_850 = Material(
    850.0, 0.15, [(1.5, 0.0, 0.0), (0.1, 0.002, 0.95)], [(7.8, 0.0, 0.0), (8.2, 0.002, 0.0), (0.4, 0.015, 0.95)]
)
#: Table 3 of the paper, out of plane.
MORTAR_2300 = replace(MORTAR_850, E=2300.0)
#: An invented material: no parameter has its default, both tables have four rows.
STONE = Material(
    30000.0,
    0.22,
    [(2.0, 0.0, 0.0), (2.4, 0.0001, 0.05), (0.8, 0.0008, 0.6), (0.2, 0.003, 0.92)],
    [(20.0, 0.0, 0.0), (26.0, 0.0012, 0.1), (18.0, 0.003, 0.4), (4.0, 0.009, 0.85)],
    dilation_angle=25.0,
    eccentricity=0.2,
    fb0_fc0=1.2,
    K_c=0.75,
    tension_recovery=0.3,
    compression_recovery=0.7,
)
MATERIALS = {"brick": BRICK, "mortar850": MORTAR_850, "mortar2300": MORTAR_2300, "stone": STONE}

#: Table 1 of the paper, stiffnesses as in the reference's curves.
TABLE_1 = Joint(0.28, 0.87, 1.01, 0.73, 0.2, 0.4, 4.38, 1.1, 99000.0, 43043.47826086957)
#: Table 3 of the paper, in plane, 500 times the stiffness of the mortar.
TABLE_3 = Joint(0.2, 0.22, 0.75, 0.75, 0.36, 0.4, 4.38, 1.1, 34000.0, 14783.0)
#: An invented joint without bond. Its brittleness and ultimate gaps have no effect.
DRY = Joint(0.0, 0.0, 0.65, 0.65, 1.0, 1.0, 1.0, 1.0, 5000.0, 2000.0)
#: Openings under a pressure of 1 MPa [mm].
PRESSED_1, PRESSED_3 = -1.0 / TABLE_1.normal_stiffness, -1.0 / TABLE_3.normal_stiffness


@dataclass(frozen=True)
class MaterialCase:
    """A golden curve of a material."""

    name: str
    says: str
    material: Material | DruckerPrager
    #: Strains, or nominal stresses in the columns that `stress` names. Shape (rows, 6).
    path: Floats
    stress: tuple[str, ...] = ()
    #: Duration of a row [s].
    seconds: float = 1.0


@dataclass(frozen=True)
class JointCase:
    """A golden curve of a joint."""

    name: str
    says: str
    joint: Joint | CapJoint
    #: u and two slips [mm]. Shape (rows, 3).
    path: Floats


def legs(*corners: Sequence[float]) -> Floats:
    """A path from rest through corners: number of rows on the way there, then the components. Shape (rows, n)."""
    out, last = [], np.zeros(len(corners[0]) - 1)
    for rows, *corner in corners:
        to = np.array(corner, dtype=float)
        out += [last + (to - last) * (i + 1) / rows for i in range(int(rows))]
        last = to
    return np.array(out)


def axial(rows: int, strains: Sequence[float], lateral: float = 0.0) -> Floats:
    """Strains along x with lateral stresses, which a first row applies if they are not zero."""
    first = [(1, 0.0, lateral, lateral, 0, 0, 0)] if lateral else []
    return legs(*first, *((rows, strain, lateral, lateral, 0, 0, 0) for strain in strains))


UNIAXIAL = ("yy", "zz")
#: Legs with all six strains.
SPATIAL = legs(
    (16, 0.0003, -0.0001, 0.0002, 0.0004, -0.0003, 0.0001),
    (16, -0.0008, 0.0005, -0.0004, 0.0002, 0.0009, -0.0005),
    (16, -0.0012, -0.0015, 0.0003, -0.0011, 0.0004, 0.0008),
    (16, 0.0006, -0.0004, 0.0005, 0.0005, -0.0012, 0.0016),
    (16, 0.0002, 0.0004, -0.0025, -0.0007, 0.0006, -0.0004),
)
_ANGLES = np.radians(np.arange(3, 181, 3))
#: A tensile strain of 0.0004 whose direction turns by 180 degrees in the plane xy.
ROTATING = legs(
    (12, 0.0004, 0, 0, 0, 0, 0),
    *((1, 4e-4 * np.cos(a) ** 2, 4e-4 * np.sin(a) ** 2, 0, 4e-4 * np.sin(2 * a), 0, 0) for a in _ANGLES),
)

MATERIAL_CASES = [
    MaterialCase(
        "cdp_mortar850_eff1_uniax_compression", "uniaxial compression", MORTAR_850, axial(60, [-0.03]), UNIAXIAL
    ),
    MaterialCase(
        "cdp_mortar2300_eff1_cyclic",
        "uniaxial tension, compression, tension, compression, tension; full recovery where cracks close",
        MORTAR_2300,
        axial(24, [0.0016, -0.008, 0.002, -0.018, 0.004]),
        UNIAXIAL,
    ),
    MaterialCase(
        "cdp_brick_eff1_cyclic_recovery",
        "uniaxial cycles with partial recovery in both directions",
        replace(BRICK, tension_recovery=0.4, compression_recovery=0.6),
        axial(24, [0.001, -0.003, 0.002, -0.006, 0.003]),
        UNIAXIAL,
    ),
    MaterialCase(
        "cdp_brick_eff1_biax_tension",
        "plane stress: biaxial tension, back to zero strain, biaxial tension mostly along y",
        BRICK,
        legs((24, 0.0012, 0.0006, 0, 0, 0, 0), (24, 0, 0, 0, 0, 0, 0), (24, 0.001, 0.0015, 0, 0, 0, 0)),
        ("zz",),
    ),
    MaterialCase(
        "cdp_mortar850_eff1_biax_tension_compression",
        "plane stress: tension along x with compression along y, in changing ratios",
        MORTAR_850,
        legs((24, 0.003, -0.006, 0, 0, 0, 0), (24, 0, -0.014, 0, 0, 0, 0), (24, 0.006, -0.01, 0, 0, 0, 0)),
        ("zz",),
    ),
    MaterialCase(
        "cdp_brick_eff1_biax_compression",
        "plane stress: biaxial compression, partly unloaded, compression mostly along y",
        BRICK,
        legs((24, -0.002, -0.0006, 0, 0, 0, 0), (24, -0.001, 0, 0, 0, 0, 0), (24, -0.002, -0.004, 0, 0, 0, 0)),
        ("zz",),
    ),
    MaterialCase(
        "cdp_brick_eff1_oedometric",
        "confined compression without lateral strain, with an unloading",
        BRICK,
        axial(20, [-0.003, -0.002, -0.006]),
    ),
    MaterialCase(
        "cdp_mortar850_eff1_confined",
        "confined compression under a lateral pressure of 1 MPa, with an unloading",
        MORTAR_850,
        axial(24, [-0.012, -0.006, -0.03], lateral=-1.0),
        UNIAXIAL,
    ),
    MaterialCase(
        "cdp_mortar2300_eff1_simple_shear_cyclic",
        "simple shear in cycles, no other strain",
        MORTAR_2300,
        legs(*((24, 0, 0, 0, shear, 0, 0) for shear in (0.003, -0.003, 0.006, 0.0))),
    ),
    MaterialCase(
        "cdp_stone_eff1_pressed_shear",
        "shear in cycles under 4 MPa along y, no normal stress along x and z",
        STONE,
        legs(
            (1, 0, -4, 0, 0, 0, 0), *((n, 0, -4, 0, g, 0, 0) for n, g in ((24, 0.002), (36, -0.002), (36, 0.003)))
        ),
        ("xx", "yy", "zz"),
    ),
    MaterialCase(
        "cdp_brick_eff1_rotating",
        "non-proportional: a tensile strain whose direction turns by 180 degrees",
        BRICK,
        ROTATING,
    ),
    MaterialCase("cdp_brick_eff1_spatial", "non-proportional: five legs with all six strains", BRICK, SPATIAL),
    MaterialCase("cdp_stone_eff1_spatial", "non-proportional: five legs with all six strains", STONE, SPATIAL),
    MaterialCase(
        "cdp_stone_eff1_uniax_cyclic",
        "uniaxial cycles",
        STONE,
        axial(24, [0.0006, -0.004, 0.0015, -0.008, 0.003]),
        UNIAXIAL,
    ),
    MaterialCase(
        "cdp_brick_eff1_triaxial_tension",
        "equal tensile strains in all directions, with an unloading: flow at the vertex of the potential",
        BRICK,
        legs(*((16, strain, strain, strain, 0, 0, 0) for strain in (0.0004, 0.0001, 0.0007))),
    ),
    MaterialCase(
        "cdp_brick_lit_cyclic",
        "a uniaxial cycle with the nodes of `lit`",
        replace(BRICK, interpolation="lit"),
        axial(24, [0.001, -0.004, 0.002]),
        UNIAXIAL,
    ),
    MaterialCase(
        "cdp_brick_eff1_scaled",
        "a uniaxial cycle in a crack band of 0.4 times the reference length",
        replace(BRICK, length_ratio=2.5),
        axial(24, [0.0015, -0.003, 0.003]),
        UNIAXIAL,
    ),
    MaterialCase(
        "cdp_brick_eff1_viscous",
        "non-proportional: five legs with all six strains, 1 s a row",
        replace(BRICK, viscosity=3.0),
        SPATIAL,
    ),
]

JOINT_CASES = [
    JointCase(
        "itf_T1_open_and_slide",
        "opening with sliding in changing ratios and directions, until the joint is open",
        TABLE_1,
        legs((24, 0.01, 0.02, 0.01), (24, 0.03, 0.03, 0.06), (24, 0.08, 0.2, 0.1), (24, 0.25, 0.3, 0)),
    ),
    JointCase(
        "itf_T1_sheared_then_opened",
        "sheared under 0.5 MPa, unloaded, opened: constant traction until Q exceeds the damage by shear",
        TABLE_1,
        legs(
            (1, 0.5 * PRESSED_1, 0, 0),
            (20, 0.5 * PRESSED_1, 0.12, 0),
            (4, 0, 0.12, 0),
            (30, 0.06, 0.12, 0),
            (20, 0.22, 0.12, 0),
        ),
    ),
    JointCase(
        "itf_T1_shear_cyclic_varying_pressure",
        "cyclic shear under a pressure between 0.1 and 1.2 MPa that varies with the slip",
        TABLE_1,
        legs(
            (1, 0.2 * PRESSED_1, 0, 0),
            (16, 0.6 * PRESSED_1, 0.1, 0),
            (32, 1.0 * PRESSED_1, -0.1, 0),
            (32, 0.3 * PRESSED_1, 0.25, 0),
            (32, 1.2 * PRESSED_1, -0.3, 0),
            (32, 0.1 * PRESSED_1, 0.5, 0),
        ),
    ),
    JointCase(
        "itf_T1_shear_circle",
        "slip along a circle under 0.5 MPa",
        TABLE_1,
        legs(
            (1, 0.5 * PRESSED_1, 0, 0),
            (10, 0.5 * PRESSED_1, 0.05, 0),
            *((1, 0.5 * PRESSED_1, 0.05 * np.cos(a), 0.05 * np.sin(a)) for a in np.radians(np.arange(6, 361, 6))),
        ),
    ),
    JointCase(
        "itf_T3_unload_in_tension",
        "opened, half closed in tension, slid while open, opened further, closed",
        TABLE_3,
        legs(
            (16, 0.02, 0, 0),
            (8, 0.004, 0, 0),
            (16, 0.03, 0.01, 0),
            (16, 0.01, 0.03, 0),
            (16, 0.05, 0.03, 0.02),
            (16, 0, 0.03, 0.02),
            (2, 0.3 * PRESSED_3, 0.03, 0.02),
        ),
    ),
    JointCase(
        "itf_T3_reclosed",
        "torn apart, moved while open, closed elsewhere, slid under pressure, opened, closed again with slip",
        TABLE_3,
        legs(
            (20, 0.4, 0.05, 0.02),
            (8, 0.1, 0.2, -0.1),
            (4, 0, 0.2, -0.1),
            (4, 0.5 * PRESSED_3, 0.2, -0.1),
            (16, 0.5 * PRESSED_3, 0, -0.1),
            (16, 1.5 * PRESSED_3, 0, 0.1),
            (4, 0, 0, 0.1),
            (8, 0.05, 0.1, 0.1),
            (8, 0, 0.12, 0.1),
            (8, 0.4 * PRESSED_3, 0.12001, 0.10002),
            (16, 0.4 * PRESSED_3, 0, 0),
        ),
    ),
    JointCase(
        "itf_T3_shear_cyclic_open",
        "cyclic shear of a joint that is open in its softening range",
        TABLE_3,
        legs(
            (8, 0.01, 0, 0),
            (12, 0.01, 0.01, 0),
            (20, 0.01, -0.02, 0),
            (24, 0.02, 0.03, 0),
            (24, 0.02, -0.05, 0),
            (24, 0.02, 0.2, 0),
        ),
    ),
    JointCase(
        "itf_T1_additive",
        "coupling `additive`: sheared, opened, both, closed, slid back, torn apart",
        replace(TABLE_1, coupling="additive"),
        legs(
            (1, 0.5 * PRESSED_1, 0, 0),
            (16, 0.5 * PRESSED_1, 0.1, 0),
            (16, 0.02, 0.1, 0),
            (24, 0.06, 0.16, 0.04),
            (8, 0.5 * PRESSED_1, 0.16, 0.04),
            (24, 0.5 * PRESSED_1, 0, 0),
            (24, 0.2, 0.2, 0.1),
        ),
    ),
    JointCase(
        "itf_dry_spiral",
        "no bond: slip along a spiral under a pressure between 0.25 and 0.75 MPa",
        DRY,
        legs(
            *(
                (
                    1,
                    (-0.5 - 0.25 * np.sin(3 * a)) / DRY.normal_stiffness,
                    0.02 * a * np.cos(a),
                    0.02 * a * np.sin(a),
                )
                for a in np.radians(np.arange(9, 721, 9))
            )
        ),
    ),
]
