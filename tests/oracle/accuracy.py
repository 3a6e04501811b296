"""Prints the table "Accuracy" of README.md.

python tests/oracle/accuracy.py
"""

from __future__ import annotations

import numpy as np

import cap
import damage_plasticity_path
import drucker_prager
import joint_path
from cap_paths import CAP_CASES
from drucker_prager_paths import DRUCKER_PRAGER_CASES
from golden import FOLDER, TRACTIONS, columns, joint_table, material_columns, material_table, read
from paths import JOINT_CASES, MATERIAL_CASES, MaterialCase
from tables import Floats
from test_wythe import STEPS, joint_by_wythe, material_by_wythe


def tighten(factor: float) -> None:
    """Divides the tolerances of all integrators."""
    for module in (damage_plasticity_path, drucker_prager, joint_path, cap):
        module.RTOL /= factor
        module.ATOL /= factor


def values(table: dict[str, Floats], case: object) -> Floats:
    """The columns that test_wythe.py compares: all in MPa but for the damage."""
    if isinstance(case, MaterialCase):
        return material_columns(table, case)
    return columns(table, [*TRACTIONS, "D"])


def main() -> None:
    """Prints the table."""
    print("| Curve | Rows | Oracle | wythe, 1 step a row | 1000 steps | extrapolated |")
    print("|---|---|---|---|---|---|")
    for case in [*MATERIAL_CASES, *DRUCKER_PRAGER_CASES, *JOINT_CASES, *CAP_CASES]:
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
