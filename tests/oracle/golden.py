"""Reading and writing of golden curves: CSV files with a header of lines that begin with `#`."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np

import damage_plasticity_path
import joint_path
from damage_plasticity import COMPONENTS
from paths import BRICK, MORTAR_850, TABLE_1, JointCase, MaterialCase
from tables import Floats

FOLDER = Path(__file__).resolve().parents[1] / "data" / "golden"

STRAINS = [f"{'eps' if a[0] == a[1] else 'gam'}_{a}" for a in COMPONENTS]
STRESSES = [f"sig_{a}_MPa" for a in COMPONENTS]
MATERIAL_STATE = ["kt", "kc", "dt", "dc", "d"]
GAPS = ["u_mm", "d1_mm", "d2_mm"]
TRACTIONS = ["sig_MPa", "tau1_MPa", "tau2_MPa"]
JOINT_STATE = ["D", "umax_mm", "smax_mm", "dp1_mm", "dp2_mm"]
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


def material_table(case: MaterialCase) -> Table:
    """The curve of a material by the oracle."""
    found = damage_plasticity_path.drive(case.material, case.path, case.stress, case.seconds)
    names = STRAINS + STRESSES + MATERIAL_STATE
    return dict(zip(names, np.hstack([found.strains, found.stresses, found.state]).T, strict=True))


def joint_table(case: JointCase) -> Table:
    """The curve of a joint by the oracle."""
    found = joint_path.drive(case.joint, case.path)
    names = [*GAPS, *TRACTIONS, *JOINT_STATE, WORK]
    values = np.hstack([case.path, found.tractions, found.state, found.work[:, None]])
    return dict(zip(names, values.T, strict=True))


def text(case: MaterialCase | JointCase) -> str:
    """A file, with 15 significant digits."""
    law = case.material if isinstance(case, MaterialCase) else case.joint
    parameters = ", ".join(f"{field.name} = {getattr(law, field.name)!r}" for field in fields(law))
    if isinstance(case, MaterialCase):
        table, page = material_table(case), "damage-plasticity.md"
        given = f"strains; nominal stresses of {', '.join(case.stress)}" if case.stress else "strains"
        given += f"; rows of {case.seconds:g} s" if case.material.viscosity else ""
        legend = "eps, gam: strains; sig: nominal stress; kt, kc: hardening variables; dt, dc, d: damage"
    else:
        table, page, given = joint_table(case), "joint.md", "u_mm, d1_mm, d2_mm"
        legend = "sig, tau: traction; D: damage; umax, smax: largest gaps; dp: plastic slip; W: work"
    head = [
        f"{case.name}: {case.says}",
        f"made by: python tests/oracle/make.py {case.name}",
        f"rate equations of docs/theory/{page}, integrated along straight lines between rows, from rest",
        f"parameters: {parameters}",
        f"prescribed: {given}",
        f"columns: {legend}",
    ]
    rows = np.stack(list(table.values()), axis=-1)
    lines = [f"# {line}" for line in head] + [",".join(table)]
    # Adding zero turns -0.0 into 0.0.
    lines += [",".join(f"{value + 0.0:.15g}" for value in row) for row in rows]
    return "\n".join(lines) + "\n"
