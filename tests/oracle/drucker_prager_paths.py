"""Golden curves of hyperbolic Drucker-Prager plasticity: materials and paths."""

from __future__ import annotations

import math
from dataclasses import replace

from drucker_prager import DruckerPrager
from paths import ROTATING, SPATIAL, UNIAXIAL, MaterialCase, axial, legs

#: The example of docs/reference/deck.md in elements of 50 mm: softens in tension only.
TUFF = DruckerPrager(2000.0, 0.2, 1.2, 35.0, 10.0, 0.4, G_I=0.03, length=50.0)
#: The same with associated flow and without softening.
PERFECT = replace(TUFF, psi=35.0, G_I=math.inf)
#: An invented rock that softens in tension and in compression.
ROCK = DruckerPrager(20000.0, 0.25, 5.0, 40.0, 20.0, 2.0, G_I=0.08, G_c=8.0, length=30.0)
#: An invented soil.
SOIL = DruckerPrager(60.0, 0.2, 0.05, 25.0, 5.0, 0.02, G_I=0.002, G_c=0.2, length=20.0)

DRUCKER_PRAGER_CASES = [
    MaterialCase(
        "dp_tuff_uniax_cyclic",
        "uniaxial tension, compression, tension, compression: softening in tension only",
        TUFF,
        axial(24, [0.001, -0.004, 0.004, -0.006]),
        UNIAXIAL,
    ),
    MaterialCase(
        "dp_rock_uniax_tension", "uniaxial tension with an unloading", ROCK, axial(20, [0.001, 0.0005, 0.005]), UNIAXIAL
    ),
    MaterialCase(
        "dp_rock_uniax_cyclic",
        "uniaxial compression, tension, compression: both fracture energies",
        ROCK,
        axial(24, [-0.006, 0.001, -0.009]),
        UNIAXIAL,
    ),
    MaterialCase(
        "dp_perfect_confined",
        "confined compression under a lateral pressure of 1 MPa, with an unloading; no softening",
        PERFECT,
        axial(24, [-0.006, -0.002, -0.012], lateral=-1.0),
        UNIAXIAL,
    ),
    MaterialCase(
        "dp_rock_confined",
        "confined compression under a lateral pressure of 1 MPa, with an unloading",
        ROCK,
        axial(24, [-0.003, -0.001, -0.006], lateral=-1.0),
        UNIAXIAL,
    ),
    MaterialCase(
        "dp_soil_oedometric",
        "confined compression without lateral strain, with an unloading",
        SOIL,
        axial(20, [-0.02, -0.01, -0.04]),
    ),
    MaterialCase(
        "dp_tuff_biax_tension",
        "plane stress: biaxial tension, back to zero strain, biaxial tension mostly along y",
        TUFF,
        legs((24, 0.0012, 0.0006, 0, 0, 0, 0), (24, 0, 0, 0, 0, 0, 0), (24, 0.001, 0.0025, 0, 0, 0, 0)),
        ("zz",),
    ),
    MaterialCase(
        "dp_tuff_triaxial_tension",
        "equal tensile strains in all directions, with an unloading, then a tension along x: the round vertex",
        TUFF,
        legs(
            *((16, strain, strain, strain, 0, 0, 0) for strain in (0.0004, 0.0001, 0.0007)), (24, 0.003, 0, 0, 0, 0, 0)
        ),
    ),
    MaterialCase(
        "dp_perfect_simple_shear_cyclic",
        "simple shear in cycles, no other strain: pressure by dilatancy; no softening",
        PERFECT,
        legs(*((24, 0, 0, 0, shear, 0, 0) for shear in (0.003, -0.003, 0.006, 0.0))),
    ),
    MaterialCase(
        "dp_rock_pressed_shear",
        "shear in cycles under 1 MPa along y, no normal stress along x and z",
        ROCK,
        legs((1, 0, -1, 0, 0, 0, 0), *((24, 0, -1, 0, shear, 0, 0) for shear in (0.001, -0.001, 0.0015))),
        ("xx", "yy", "zz"),
    ),
    MaterialCase(
        "dp_rock_rotating",
        "non-proportional: a tensile strain whose direction turns by 180 degrees",
        ROCK,
        ROTATING,
    ),
    MaterialCase("dp_rock_spatial", "non-proportional: five legs with all six strains", ROCK, SPATIAL),
    MaterialCase("dp_tuff_spatial", "non-proportional: five legs with all six strains", TUFF, SPATIAL),
    MaterialCase(
        "dp_perfect_spatial", "non-proportional: five legs with all six strains; no softening", PERFECT, SPATIAL
    ),
]
