#!/usr/bin/env python3
"""CalculiX beside wythe on the couplet in shear (scene 1 of docs/accuracy-speed.md).

    apt-get install calculix-ccx       # 2.20 was used
    cargo build --release
    python3 benches/peers/calculix.py target/release/wythe

The curve goes to `--out` as CSV. Seconds are user and system time of the whole process `ccx`, the
same on every row; the median of runs by turns with wythe counts. Never a dependency, never run in
CI. Python 3.11.

What it has alike is told in couplet.py. CalculiX has no cohesive element or contact that softens.
What stands for the joint, and differs:

- Friction: its surface-to-surface contact, linear in pressure, with stick slope. Contact opens
  without strength: f_t is left out.
- Bond: SPRING2 elements with a table, one a pair of nodes, by areas lumped to the corners. The
  table has the law's curve at 40 points of slip; its strength is taken at the mean pressure.
  Springs act along x only, and are elastic: unloaded, they would go back along their curve and
  heal. Here nothing unloads.
- Elements: C3D8I, displacements small.
- Balance: its own tolerance (0.5 % of the mean force). Increments are fixed.
"""

import argparse
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

from couplet import Couplet, compare

POINTS = 40  # of the spring's table


def deck(couplet):
    """The input of CalculiX."""
    lines = ["*NODE"]
    lines += [f"{tag},{x},{y},{z}" for tag, (x, y, z) in couplet.nodes.items()]
    lines += ["*ELEMENT,TYPE=C3D8I,ELSET=solids"]
    lines += [",".join(map(str, [e, *nodes])) for e, (*_, nodes) in enumerate(couplet.solids, 1)]
    for name, layer, face in (("below", (0, 1), "S2"), ("above", (1, 0), "S1")):
        elements = [e for e, (*key, _) in enumerate(couplet.solids, 1) if tuple(key) == layer]
        lines += [f"*SURFACE,NAME={name},TYPE=ELEMENT"] + [f"{e},{face}" for e in elements]
    for name in ("base", "top"):
        lines += [f"*NSET,NSET={name}"] + [f"{tag}," for tag in getattr(couplet, name)]
    lines += ["*MATERIAL,NAME=stiff", "*ELASTIC", f"{couplet.modulus},{couplet.poisson}",
              "*SOLID SECTION,ELSET=solids,MATERIAL=stiff"]
    lines += bonds(couplet)
    lines += ["*SURFACE INTERACTION,NAME=joint",
              # The second value keeps the open side without tension.
              "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=LINEAR", f"{couplet.normal},1e-3",
              "*FRICTION", f"{couplet.mu},{couplet.tangential}",
              "*CONTACT PAIR,INTERACTION=joint,TYPE=SURFACE TO SURFACE", "above,below",
              "*BOUNDARY", "base,1,3", "top,1,2"]
    lead, *others = couplet.top
    for tag in others:  # level
        lines += ["*EQUATION", "2", f"{tag},3,1.,{lead},3,-1."]
    shown = ["*NODE PRINT,NSET=base,TOTALS=ONLY", "RF", "*END STEP"]
    lines += ["*STEP", "*STATIC,DIRECT", "0.5,1.", "*CLOAD", f"{lead},3,{-couplet.load}", *shown]
    for to, parts in couplet.legs:
        lines += [f"*STEP,INC={parts + 1}", "*STATIC,DIRECT", f"{1 / parts:.12f},1.",
                  "*BOUNDARY", f"top,1,1,{to}", *shown]
    return "\n".join(lines) + "\n"


def bonds(couplet):
    """Springs from node to node; those of one area share a table."""
    lines, tag = [], len(couplet.solids)
    for area in sorted({round(area, 6) for area in couplet.pairs.values()}):
        name = f"bond{round(area)}"
        lines += [f"*ELEMENT,TYPE=SPRING2,ELSET={name}"]
        for (below, above), own in couplet.pairs.items():
            if round(own, 6) == area:
                tag += 1
                lines.append(f"{tag},{below},{above}")
        elastic = couplet.bond / couplet.tangential
        slips = [couplet.delta_k * i / POINTS for i in range(POINTS + 1)]
        curve = [(elastic + s, couplet.bond * couplet.left(s)) for s in slips]
        curve.append((10.0, 0.0))
        curve = [(-s, -t) for s, t in reversed(curve)] + [(0.0, 0.0)] + curve
        lines += [f"*SPRING,ELSET={name},NONLINEAR", "1,1"]
        lines += [f"{stress * area:.9e},{slip:.9e}" for slip, stress in curve]
    return lines


def run(folder):
    """Rows of displacement, force, CPU seconds and solves, see `compare`."""
    couplet = Couplet()
    (folder / "couplet.inp").write_text(deck(couplet))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(["ccx", "couplet"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    told = (folder / "couplet.dat").read_text()
    pattern = r"total force \(fx,fy,fz\) for set BASE and time\s+(\S+)\s+(\S+)"
    forces = [-float(force) / 1e3 for _, force in re.findall(pattern, told)][2:]
    lines = [line.split() for line in (folder / "couplet.sta").read_text().splitlines()[2:]]
    solves = [int(line[3]) for line in lines]
    if len(forces) < len(couplet.drive()):
        raise SystemExit(f"ccx ended after {len(forces)} of {len(couplet.drive())} increments")
    return [(0.0, 0.0, cpu, sum(solves[:2]))] + [
        (u, force, cpu, sum(solves[: i + 3]))
        for i, (u, force) in enumerate(zip(couplet.drive(), forces))
    ]


def main():
    parser = argparse.ArgumentParser(description="CalculiX beside wythe on the couplet in shear")
    parser.add_argument("wythe", nargs="?", help="the binary; without it CalculiX runs alone")
    parser.add_argument("--out", type=Path, default=Path("target/calculix-results"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    os.environ["CCX_NPROC_EQUATION_SOLVER"] = "1"
    compare("calculix", lambda: run(arguments.out), arguments.wythe, arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
