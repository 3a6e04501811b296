"""Reading and writing of golden curves: CSV files with a header of lines that begin with `#`."""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

import cap
import damage_plasticity_path
import drucker_prager
import joint_path
from cap import CapJoint
from damage_plasticity import COMPONENTS, Material
from drucker_prager import DruckerPrager
from joint import Joint
from paths import BRICK, MORTAR_850, TABLE_1, JointCase, MaterialCase
from tables import Floats

FOLDER = Path(__file__).resolve().parents[1] / "data" / "golden"

STRAINS = [f"{'eps' if a[0] == a[1] else 'gam'}_{a}" for a in COMPONENTS]
STRESSES = [f"sig_{a}_MPa" for a in COMPONENTS]
MATERIAL_STATE = ["kt", "kc", "dt", "dc", "d"]
DRUCKER_PRAGER_STATE = MATERIAL_STATE[:4]
GAPS = ["u_mm", "d1_mm", "d2_mm"]
TRACTIONS = ["sig_MPa", "tau1_MPa", "tau2_MPa"]
JOINT_STATE = ["D", "umax_mm", "smax_mm", "dp1_mm", "dp2_mm"]
CAP_STATE = ["D", "sp_mm", "kappa_mm", "up_mm", "dp1_mm", "dp2_mm"]
WORK = "W_N_per_mm"

Table = dict[str, Floats]


def read(path: Path) -> Table:
    """The columns of a file."""
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
    rows = np.array([[float(x) for x in line.split(",")] for line in lines[1:]])
    return dict(zip(lines[0].split(","), rows.T, strict=True))


def columns(table: Table, names: list[str]) -> Floats:
    """Some columns of a table. Shape (rows, names)."""
    return np.stack([table[name] for name in names], axis=-1)


def _reference_material(test: str, material: str = "brick") -> MaterialCase:
    name = f"cdp_{material}_eff1_{test}"
    path = columns(read(FOLDER / f"{name}.csv"), STRAINS)
    return MaterialCase(name, test, {"brick": BRICK, "mortar850": MORTAR_850}[material], path)


def reference_material_cases() -> list[MaterialCase]:
    """The curves of materials by the earlier reference, all along prescribed strains."""
    tests = ("biax_comp_1_1", "cyclic_tct", "nonprop", "simple_shear", "uniax_compression", "uniax_tension")
    return [*map(_reference_material, tests), _reference_material("uniax_tension", "mortar850")]


def reference_joint_cases() -> list[JointCase]:
    """The curves of joints by the earlier reference."""
    names = [f"itf_T1_{test}" for test in ("mixed45", "mode1_cyclic", "mode2_cyclic", "mode2_sig0.5")]
    return [JointCase(name, name, TABLE_1, columns(read(FOLDER / f"{name}.csv"), GAPS)) for name in names]


def material_state(case: MaterialCase) -> list[str]:
    """Columns of the state of a material."""
    return DRUCKER_PRAGER_STATE if isinstance(case.material, DruckerPrager) else MATERIAL_STATE


def material_columns(table: Table, case: MaterialCase) -> Floats:
    """Stresses, strains and equivalent plastic strains times E [MPa]; damages. Shape (rows, 16 or 17)."""
    out = columns(table, [*STRESSES, *STRAINS, *material_state(case)])
    out[:, 6:14] *= case.material.E
    return out


def material_table(case: MaterialCase) -> Table:
    """The curve of a material by the oracle."""
    found: drucker_prager.Curves | damage_plasticity_path.Curves
    if isinstance(case.material, DruckerPrager):
        found = drucker_prager.drive(case.material, case.path, case.stress)
    else:
        found = damage_plasticity_path.drive(case.material, case.path, case.stress, case.seconds)
    names = STRAINS + STRESSES + material_state(case)
    return dict(zip(names, np.hstack([found.strains, found.stresses, found.state]).T, strict=True))


def joint_table(case: JointCase) -> Table:
    """The curve of a joint by the oracle."""
    found: cap.Curves | joint_path.Curves
    if isinstance(case.joint, CapJoint):
        found, state = cap.drive(case.joint, case.path), CAP_STATE
    else:
        found, state = joint_path.drive(case.joint, case.path), JOINT_STATE
    names = [*GAPS, *TRACTIONS, *state, WORK]
    values = np.hstack([case.path, found.tractions, found.state, found.work[:, None]])
    return dict(zip(names, values.T, strict=True))


def given(law: Material | DruckerPrager | Joint | CapJoint) -> dict[str, Any]:
    """The parameters of a law without infinite ones, which are absent from a deck."""
    values = {item.name: getattr(law, item.name) for item in fields(law)}
    return {name: value for name, value in values.items() if value != math.inf}


#: Page of a law in docs/theory, and its columns beside strains, stresses, gaps and tractions.
PAGES: dict[type, tuple[str, str]] = {
    Material: ("damage-plasticity.md", "kt, kc: hardening variables; dt, dc, d: damage"),
    DruckerPrager: ("drucker-prager.md", "kt, kc: equivalent plastic strains; dt, dc: lost shares of the strength"),
    Joint: ("joint.md", "D: damage; umax, smax: largest gaps; dp: plastic slip; W: work"),
    CapJoint: (
        "joint-cap.md",
        "D: damage; sp: path of frictional slip; kappa: of the cap; up, dp: plastic opening and slip; W: work",
    ),
}


def text(case: MaterialCase | JointCase) -> str:
    """A file, with 15 significant digits."""
    law = case.material if isinstance(case, MaterialCase) else case.joint
    page, state = PAGES[type(law)]
    if isinstance(case, MaterialCase):
        table, legend = material_table(case), f"eps, gam: strains; sig: nominal stress; {state}"
        prescribed = f"strains; nominal stresses of {', '.join(case.stress)}" if case.stress else "strains"
        prescribed += f"; rows of {case.seconds:g} s" if getattr(law, "viscosity", 0.0) else ""
    else:
        table, legend = joint_table(case), f"sig, tau: traction; {state}"
        prescribed = "u_mm, d1_mm, d2_mm"
    head = [
        f"{case.name}: {case.says}",
        f"made by: python tests/oracle/make.py {case.name}",
        f"rate equations of docs/theory/{page}, integrated along straight lines between rows, from rest",
        f"parameters: {', '.join(f'{name} = {value!r}' for name, value in given(law).items())}",
        f"prescribed: {prescribed}",
        f"columns: {legend}",
    ]
    rows = np.stack(list(table.values()), axis=-1)
    lines = [f"# {line}" for line in head] + [",".join(table)]
    # Adding zero turns -0.0 into 0.0.
    lines += [",".join(f"{value + 0.0:.15g}" for value in row) for row in rows]
    return "\n".join(lines) + "\n"
