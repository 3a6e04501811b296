"""Writes the golden curves of the oracle.

    python tests/oracle/make.py [NAME ...] [--out FOLDER]

Without names it writes all of them; without a folder to tests/data/golden.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from cap_paths import CAP_CASES
from drucker_prager_paths import DRUCKER_PRAGER_CASES
from golden import FOLDER, text
from paths import JOINT_CASES, MATERIAL_CASES, JointCase, MaterialCase


def main() -> None:
    """Runs the command."""
    every: list[MaterialCase | JointCase] = [*MATERIAL_CASES, *DRUCKER_PRAGER_CASES, *JOINT_CASES, *CAP_CASES]
    cases = {case.name: case for case in every}
    parser = argparse.ArgumentParser(description="Writes the golden curves of the oracle.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"some of: {', '.join(cases)}")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder; tests/data/golden by default")
    arguments = parser.parse_args()
    for name in arguments.names:
        if name not in cases:
            parser.error(f"no such curve: {name}")
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name in arguments.names or cases:
        (arguments.out / f"{name}.csv").write_text(text(cases[name]))
        print(name)


if __name__ == "__main__":
    main()
