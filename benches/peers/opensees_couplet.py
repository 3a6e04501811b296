#!/usr/bin/env python3
"""OpenSeesPy beside wythe on the couplet in shear (scene 1 of docs/accuracy-speed.md).

    python3 -m venv target/opensees      # Python 3.11; the wheels of 3.7.1 were used
    target/opensees/bin/pip install openseespy
    cargo build --release
    target/opensees/bin/python benches/peers/opensees_couplet.py target/release/wythe

The wheel for Linux wants a BLAS of the system (libopenblas0-pthread was used). The curve goes to
`--out` as CSV. Seconds are `time.process_time()` from the making of the model on, on one thread;
the median of runs by turns with wythe counts. Never a dependency, never run in CI.

What it has alike is told in couplet.py. What stands for the joint, and differs:

- Pairs of nodes that face each other, areas lumped to the corners, as in opensees.py: friction by
  `zeroLengthContactASDimplex`, the bond by springs beside it (ASDConcrete1D), one normal with f_t,
  two tangential ones that follow the law's curve at 20 points and unload elastically. Each knows
  nothing of the others; the bond's strength is taken at the mean pressure and bounds each direction
  by itself.
- Elements: `stdBrick` (full integration), elastic, displacements small.
- Level top: every node of it sinks alike and by as much as the pressure asks before the drive, and
  is then held there, where wythe leaves it free. The joint does not dilate; the pressure grows by
  0.3 % in the drive.
- Balance: 1 N in all. Increments are fixed. Laws are implicit: IMPL-EX of the same begins with
  three times the force, for the first increment extrapolates the sticking joint.
"""

import argparse
import sys
import time
from pathlib import Path

# couplet sets the number of threads, before OpenSees looks.
from couplet import Couplet, compare

import openseespy.opensees as ops

POINTS = 20  # of the springs' curves, as in opensees.py
TOLERANCE, CORRECTIONS = 1.0, 50  # [N], [-]


def spring(tag, stiffness, strength, worn, left, plastic):
    """ASDConcrete1D: softens over `worn`, by `left` of it; unloads elastically or to the origin."""
    x, y, d = [0.0, strength / stiffness], [0.0, strength], [0.0, 0.0]
    for i in range(1, POINTS + 1):
        w = worn * i / POINTS
        stress = strength * max(left(w), 1e-4)
        x.append(w + (stress if plastic else strength) / stiffness)
        y.append(stress)
        d.append(0.0 if plastic else 1 - stress / (stiffness * x[-1]))
    x.append(x[-1] + 100 * worn)
    y.append(y[-1])
    d.append(0.0 if plastic else 1 - y[-1] / (stiffness * x[-1]))
    far = 1e3 * worn  # elastic in compression
    other = (x, y, d) if plastic else ([0.0, far], [0.0, stiffness * far], [0.0, 0.0])
    ops.uniaxialMaterial("ASDConcrete1D", tag, stiffness, "-Te", *x, "-Ts", *y, "-Td", *d,
                         "-Ce", *other[0], "-Cs", *other[1], "-Cd", *other[2], "-tangent")


def make(couplet):
    """The couplet in OpenSees."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 3)
    for tag, place in couplet.nodes.items():
        ops.node(tag, *place)
    ops.nDMaterial("ElasticIsotropic", 1, couplet.modulus, couplet.poisson)
    for tag, (*_, nodes) in enumerate(couplet.solids, 1):
        ops.element("stdBrick", tag, *nodes, 1)
    element, materials = len(couplet.solids), {}
    for (below, above), area in couplet.pairs.items():
        # Half of pressure and stick goes through the springs: twice mu in the contact.
        normal, tangential = couplet.normal * area / 2, couplet.tangential * area / 2
        key = round(area, 6)
        if key not in materials:
            tag = materials[key] = 2 + 2 * len(materials)
            spring(tag, normal, couplet.f_t * area, couplet.u_k, couplet.left_open, False)
            spring(tag + 1, tangential, couplet.bond * area, couplet.delta_k, couplet.left, True)
        tag = materials[key]
        ops.element("zeroLengthContactASDimplex", element + 1, below, above, normal, tangential,
                    2 * couplet.mu, "-orient", 0, 0, 1, "-intType", 0)
        ops.element("zeroLength", element + 2, below, above, "-mat", tag, tag + 1, tag + 1,
                    "-dir", 1, 2, 3, "-orient", 0, 0, 1, 0, 1, 0)
        element += 2
    for tag in couplet.base:
        ops.fix(tag, 1, 1, 1)
    for tag in couplet.top:
        ops.fix(tag, 0, 1, 0)


def analysis():
    ops.wipeAnalysis()
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("UmfPack")
    ops.test("NormUnbalance", TOLERANCE, CORRECTIONS)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")


def move(tag, couplet, axis, sign):
    """Time becomes the displacement of the top."""
    ops.timeSeries("Linear", tag)
    ops.pattern("Plain", tag, tag)
    for node in couplet.top:
        ops.sp(node, axis, sign)
    analysis()


def reaction(couplet, axis):
    """Sum over the base [N]."""
    ops.reactions()
    return sum(ops.nodeReaction(tag, axis) for tag in couplet.base)


class Steps:
    """Takes steps and counts what they cost."""

    def __init__(self):
        self.solves = 0

    def take(self, size, at):
        ops.integrator("LoadControl", size)
        if ops.analyze(1):
            raise SystemExit(f"OpenSees found no equilibrium at {at:.4f} mm")
        self.solves += ops.testIter()


def run():
    """Rows of displacement, force, CPU seconds and solves, see `compare`."""
    couplet, steps = Couplet(), Steps()
    rows, begin = [], time.process_time()
    make(couplet)
    move(1, couplet, 3, -1.0)
    size, sunk = 1e-6, 0.0
    while abs(size) > 1e-9 * couplet.load / couplet.normal:
        steps.take(size, 0.0)
        sunk += size
        carried = reaction(couplet, 3)
        size = (couplet.load - carried) * sunk / carried
        if abs(couplet.load - carried) < TOLERANCE:
            break
    ops.loadConst("-time", 0.0)
    move(2, couplet, 1, 1.0)
    rows.append((0.0, 0.0, time.process_time() - begin, steps.solves))
    at = 0.0
    for u in couplet.drive():
        steps.take(u - at, u)
        at = u
        spent = time.process_time() - begin
        rows.append((u, -reaction(couplet, 1) / 1e3, spent, steps.solves))
    return rows


def main():
    parser = argparse.ArgumentParser(description="OpenSeesPy beside wythe on the couplet in shear")
    parser.add_argument("wythe", nargs="?", help="the binary; without it OpenSees runs alone")
    parser.add_argument("--out", type=Path, default=Path("target/opensees-results"))
    arguments = parser.parse_args()
    compare("opensees", run, arguments.wythe, arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
