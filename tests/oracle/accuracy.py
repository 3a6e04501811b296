"""Prints the table "Accuracy" of README.md.

python tests/oracle/accuracy.py
"""

from __future__ import annotations

import numpy as np

import damage_plasticity_path
import joint_path
from golden import (
    FOLDER,
    JOINT_STATE,
    MATERIAL_STATE,
    STRAINS,
    STRESSES,
    TRACTIONS,
    columns,
    joint_table,
    material_table,
    read,
)
from paths import JOINT_CASES, MATERIAL_CASES, MaterialCase
from tables import Floats
from test_wythe import STEPS, joint_by_wythe, material_by_wythe


def tighten(factor: float) -> None:
    """Divides the tolerances of both integrators."""
    for module in (damage_plasticity_path, joint_path):
        module.RTOL /= factor
        module.ATOL /= factor


def values(table: dict[str, Floats], case: object) -> Floats:
    """What test_wythe.py compares: all in MPa but for the damage."""
    if not isinstance(case, MaterialCase):
        return columns(table, [*TRACTIONS, JOINT_STATE[0]])
    out = columns(table, [*STRESSES, *STRAINS, *MATERIAL_STATE])
    out[:, 6:14] *= case.material.E
    return out


def main() -> None:
    """Prints the table."""
    print("| Curve | Rows | Oracle | wythe, 1 step a row | 1000 steps | extrapolated |")
    print("|---|---|---|---|---|---|")
    for case in [*MATERIAL_CASES, *JOINT_CASES]:
        stored = values(read(FOLDER / f"{case.name}.csv"), case)
        tighten(10.0)
        made = material_table(case) if isinstance(case, MaterialCase) else joint_table(case)
        tighten(0.1)
        by_wythe = material_by_wythe if isinstance(case, MaterialCase) else joint_by_wythe
        one, coarse, fine = (by_wythe(case, n) for n in (1, STEPS, 2 * STEPS))
        traction = slice(0, 6 if isinstance(case, MaterialCase) else 3)
        errors = [
            np.abs(values(made, case) - stored).max(),
            np.abs(one - stored)[:, traction].max(),
            np.abs(fine - stored)[:, traction].max(),
            np.abs(2.0 * fine - coarse - stored)[:, traction].max(),
        ]
        print(f"| `{case.name}` | {len(case.path)} | " + " | ".join(f"{error:.0e}" for error in errors) + " |")


if __name__ == "__main__":
    main()
