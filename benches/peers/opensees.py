#!/usr/bin/env python3
"""OpenSeesPy beside wythe on the wall J7D: CPU seconds on one thread, and the loads.

    python3 -m venv target/opensees && target/opensees/bin/pip install openseespy   # Python 3.12
    cargo build --release
    target/opensees/bin/python benches/peers/opensees.py target/release/wythe --to 0.5 --steps 50
    target/opensees/bin/python benches/peers/opensees.py target/release/wythe     # 4 mm, 400 steps

The wheel for Linux wants a BLAS of the system (libopenblas0-pthread was used). wythe runs the deck
whole and by default (half of it) before and after OpenSees and is stopped at the same displacement;
its slower runs count, for hosts drift. Seconds are those on a core: for OpenSees
`time.process_time()` around the making of the model and every `analyze`, not around the reading of
reactions; for wythe user and system time of its process when a row of its history appears (read
from /proc, so Linux). Histories go to `--out` as CSV. Never a dependency, never run in CI.

Alike: units, joints, 1,540 elements and 4,293 nodes; what is held, pressed, locked, driven; tables
of brick and mortar, their strains beyond the peak times l_ref / V^(1/3), the bound on their damage,
viscosity of 0.01 mm of drive; f_t, u_k, zeta, c, delta_k, xi and tan phi = mu of the joints.

What differs in OpenSees:

- Mesh: nodes at a joint must face each other in pairs, so planes in x are those of all courses: a
  brick is cut into 62, 62, 12.5, 67.5 mm instead of four times 51 mm.
- Penalties: 500 E/h, theory's factor. wythe: 50 by default, as stiff joints hold units whose meshes
  do not match in each other's shape; here they match. With `--penalty-factor 50` OpenSees carries
  155 kN in 400 steps and 168 in 200, further from the reference and without need.
- Contact: at these pairs, with areas lumped to the corners. wythe: 2 x 2 points a facet, on any
  facet opposite.
- Displacements are small everywhere. wythe: corotational elements, finite sliding.
- Elements: `bbarBrick` (B-bar, 8 points). There is no hexahedron with incompatible modes for such
  materials; `--element stdBrick` locks more, `--element SSPbrick` has one point and an elastic
  stabilisation, which stays when the element has cracked.
- Brick and mortar: ASDConcrete3D follows the tables, but has no plastic potential: two scalar
  damages, partly plastic, act on the positive and the negative part of the effective stress. Its
  criterion takes f_c / f_t as 5 at least (brick 3.3); dilation angle and eccentricity do not exist.
- Joint: three parts side by side, `zeroLengthContactASDimplex` (pressure and friction mu), a normal
  spring with f_t (ASDConcrete1D, softening by Q, secant unloading) and two tangential ones with c
  (softening by H, plastic). One at a time they give wythe's law exactly (tan phi = mu), but they
  know nothing of each other: opening leaves the cohesion, slip the tensile strength, tension the
  bound on shear as they are, and c bounds each tangential direction by itself.
- Integration: IMPL-EX of the solids, slip, opening and closing alike. Given the extrapolated state
  a step is linear; Newton's method needs two solves, for the first uses the tangent of the step
  before. Nothing is iterated beyond that and no error is controlled: compare two numbers of steps.
  `--implicit` takes the implicit forms of the same laws and halves steps that fail.
"""

import argparse
import csv
import math
import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

import openseespy.opensees as ops  # noqa: E402  (after the number of threads)

DECK = Path(__file__).parents[2] / "examples" / "03_shear_wall_j7d.toml"
MARKS = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.4, 4.0)
PRELOAD_STEPS = 10  # then corrections
FIRST_SINKING = 0.05  # of the top [mm]; the others follow from the reaction
LEAST_DAMAGE_SLOPE = 0.1  # of the plastic strain in the inelastic one, as wythe bounds tables


def number(value):
    """A value of the deck in N, mm, MPa."""
    return float(value.split()[0]) if isinstance(value, str) else float(value)


# --- the wall -----------------------------------------------------------------------------------


class Unit:
    """A representative element: planes, where its mortar begins, its nodes."""

    def __init__(self, start, length, head, planes, z, unit_top, y):
        self.edge = start + length
        self.x = [x for x in planes if start - 1e-6 < x < self.edge + head + 1e-6]
        self.y, self.z, self.unit_top = y, z, unit_top
        self.first = 0

    def node(self, i, j, k):
        return self.first + (k * len(self.y) + j) * len(self.x) + i

    def is_mortar(self, i, k):
        return self.x[i] > self.edge - 1e-6 or self.z[k] > self.unit_top - 1e-6

    def column(self, x):
        """The element column over x."""
        return next(i for i in range(len(self.x) - 1) if self.x[i] < x < self.x[i + 1])


def lay(wall):
    """Units of every course; planes in x are those of all courses, between them as the deck says."""
    length, thickness, height = map(number, wall["unit"])
    bed, head, whole = (number(wall[key]) for key in ("bed_joint", "head_joint", "length"))
    count = int((whole + head + 1e-6) // (length + head))
    bat = whole - count * (length + head)
    assert bat > 0, "this script lays walls with a bat only"
    patterns = []
    for lengths in ([length] * count + [bat], [bat] + [length] * count):
        slots, start = [], 0.0
        for size in lengths:
            joint = head if start + size < whole - 1e-6 else 0.0
            slots.append((start, size, joint))
            start += size + joint
        patterns.append(slots)
    edges = {round(x, 6) for slots in patterns for a, b, h in slots for x in (a, a + b, a + b + h)}
    edges, planes = sorted(edges), []
    for a, b in zip(edges, edges[1:]):
        parts = max(1, round((b - a) / (length / 4)))
        planes += [a + (b - a) * i / parts for i in range(parts)]
    planes.append(edges[-1])
    courses = []
    for k in range(wall["courses"]):
        bottom = k * (height + bed)
        z = [bottom, bottom + height] + ([bottom + height + bed] if k + 1 < wall["courses"] else [])
        y = [0.0, thickness / 2, thickness]
        courses.append([Unit(*slot, planes, z, bottom + height, y) for slot in patterns[k % 2]])
    return courses


def face_pairs(courses, materials, factor):
    """Of every pair of nodes at a joint: normal, area, normal and tangential stiffness [N/mm]."""
    pairs = {}

    def add(axis, nodes, area, sides):
        # The softer of both elements, as wythe's penalty.
        k, nu = min((materials[m][0] / h, materials[m][1]) for m, h in sides)
        for pair in nodes:
            sums = pairs.setdefault((axis, *pair), [0.0, 0.0, 0.0])
            sums[0] += area / 4
            sums[1] += factor * k * area / 4
            sums[2] += factor * k / (2 * (1 + nu)) * area / 4

    for k, course in enumerate(courses):
        for a, b in zip(course, course[1:]):  # head joints
            last = len(a.x) - 2
            for j in range(2):
                for c in range(len(a.z) - 1):
                    nodes = [(a.node(last + 1, j + p, c + q), b.node(0, j + p, c + q))
                             for p in (0, 1) for q in (0, 1)]
                    area = (a.y[j + 1] - a.y[j]) * (a.z[c + 1] - a.z[c])
                    left = a.is_mortar(last, c), a.x[-1] - a.x[-2]
                    right = b.is_mortar(0, c), b.x[1] - b.x[0]
                    add(0, nodes, area, (left, right))
        above = courses[k + 1] if k + 1 < len(courses) else []
        for a in course if above else []:  # bed joints
            top = len(a.z) - 1
            for i in range(len(a.x) - 1):
                middle = (a.x[i] + a.x[i + 1]) / 2
                b = next(u for u in above if u.x[0] < middle < u.x[-1])
                c = b.column(middle)
                for j in range(2):
                    nodes = [(a.node(i + p, j + q, top), b.node(c + p, j + q, 0))
                             for p in (0, 1) for q in (0, 1)]
                    area = (a.y[j + 1] - a.y[j]) * (a.x[i + 1] - a.x[i])
                    below = True, a.z[top] - a.z[top - 1]
                    over = b.is_mortar(c, 0), b.z[1] - b.z[0]
                    add(2, nodes, area, (below, over))
    return pairs


# --- materials ----------------------------------------------------------------------------------


def table(rows, e, scale):
    """Total strains, stresses and damages of a table; strains beyond the peak times `scale`."""
    peak = max(range(len(rows)), key=lambda i: rows[i][0])
    strains, stresses, damages = [0.0], [0.0], [0.0]
    plastic = inelastic = damage = 0.0
    for i, (stress, given, d) in enumerate(rows):
        strain = given if i <= peak else rows[peak][1] + (given - rows[peak][1]) * scale
        least = plastic + LEAST_DAMAGE_SLOPE * (strain - inelastic)
        if d > 0:
            x = e * (strain - least)
            d = max(damage, min(d, x / (x + stress)))
        plastic, inelastic, damage = strain - d / (1 - d) * stress / e, strain, d
        strains.append(strain + stress / e)
        stresses.append(stress)
        damages.append(d)
    # One row more: beyond it stress and damage stay.
    strains.append(strains[-1] + 1.0)
    stresses.append(stresses[-1])
    damages.append(damages[-1])
    return strains, stresses, damages


class Materials:
    """Each made once: solids by their l_eq, springs by their stiffness and strength."""

    def __init__(self, deck, viscosity, implicit):
        self.deck, self.viscosity = deck, viscosity
        self.scheme = ["-tangent"] if implicit else ["-implex"]
        self.tags = {}

    def tag(self, key, make):
        if key not in self.tags:
            self.tags[key] = len(self.tags) + 1
            make(self.tags[key])
        return self.tags[key]

    def solid(self, name, volume):
        size = round(volume ** (1 / 3), 4)
        m = self.deck["materials"][name]
        e, scale = number(m["E"]), number(m["reference_length"]) / size

        def make(tag):
            te, ts, td = table(m["tension"], e, scale)
            ce, cs, cd = table(m["compression"], e, scale)
            ops.nDMaterial("ASDConcrete3D", tag, e, m["nu"], "-Te", *te, "-Ts", *ts, "-Td", *td,
                           "-Ce", *ce, "-Cs", *cs, "-Cd", *cd, "-Kc", 2 / 3, "-eta", self.viscosity,
                           *self.scheme)

        return self.tag((name, size), make)

    def spring(self, stiffness, strength, ultimate, exponent, shear):
        """Softening by (1 - Q); unloading to the origin, or (shear) plastic both ways."""
        key = (shear, round(stiffness, 3), round(strength, 6))

        def make(tag):
            x, y, d = [0.0, strength / stiffness], [0.0, strength], [0.0, 0.0]
            for i in range(1, 21):
                w = ultimate * (i / 20) ** 1.5
                q = (1 - math.exp(-exponent * w / ultimate)) / (1 - math.exp(-exponent))
                left = strength * max(1 - q, 1e-4)
                x.append(strength / stiffness + w if not shear else w + left / stiffness)
                y.append(left)
                d.append(0.0 if shear else 1 - left / (stiffness * x[-1]))
            x.append(x[-1] + 100 * ultimate)
            y.append(y[-1])
            d.append(0.0 if shear else 1 - y[-1] / (stiffness * x[-1]))
            if shear:
                other = x, y, d
            else:  # elastic in compression
                far = 1e3 * ultimate
                other = [0.0, far], [0.0, stiffness * far], [0.0, 0.0]
            ops.uniaxialMaterial("ASDConcrete1D", tag, stiffness, "-Te", *x, "-Ts", *y, "-Td", *d,
                                 "-Ce", *other[0], "-Cs", *other[1], "-Cd", *other[2], *self.scheme)

        return self.tag(key, make)


# --- OpenSees -----------------------------------------------------------------------------------


class Model:
    """The wall in OpenSees. Its time is the sinking of the top, then its drive [mm]."""

    def __init__(self, deck, arguments):
        wall, joint = deck["wall"], deck["interfaces"][deck["wall"]["interface"]]
        preload = deck["steps"][0]
        names = {False: wall["unit_material"], True: wall["mortar_material"]}
        assert joint["tan_phi"] == joint["mu"], "the parts of this joint want tan_phi = mu"
        implicit = arguments.implicit
        ops.wipe()
        ops.model("basic", "-ndm", 3, "-ndf", 3)
        courses, tag, element = lay(wall), 1, 1
        materials = Materials(deck, arguments.viscosity, implicit)
        self.base, top = [], []
        for k, course in enumerate(courses):
            for unit in course:
                unit.first = tag
                for c, z in enumerate(unit.z):
                    for y in unit.y:
                        for x in unit.x:
                            ops.node(tag, x, y, z)
                            if k == 0 and c < 2:
                                self.base.append(tag)
                            elif k + 1 == len(courses):
                                top.append(tag)
                            tag += 1
                for c in range(len(unit.z) - 1):
                    for b in range(2):
                        for a in range(len(unit.x) - 1):
                            n = [unit.node(a + p, b + q, c + r)
                                 for r in (0, 1) for p, q in ((0, 0), (1, 0), (1, 1), (0, 1))]
                            volume = ((unit.x[a + 1] - unit.x[a]) * (unit.y[b + 1] - unit.y[b])
                                      * (unit.z[c + 1] - unit.z[c]))
                            solid = materials.solid(names[unit.is_mortar(a, c)], volume)
                            ops.element(arguments.element, element, *n, solid)
                            element += 1
        self.solids, self.nodes = element - 1, tag - 1
        elastic = {k: (number(deck["materials"][name]["E"]), deck["materials"][name]["nu"])
                   for k, name in names.items()}
        pairs = face_pairs(courses, elastic, joint.get("penalty_factor", arguments.penalty_factor))
        self.pairs = len(pairs)
        for (axis, a, b), (area, kn, ks) in pairs.items():
            # Half of pressure and stick goes through the springs: twice mu in the contact.
            normal = materials.spring(kn / 2, number(joint["f_t"]) * area, number(joint["u_k"]),
                                      joint["zeta"], False)
            shear = materials.spring(ks / 2, number(joint["c"]) * area, number(joint["delta_k"]),
                                     joint["xi"], True)
            n = [1, 0, 0] if axis == 0 else [0, 0, 1]
            ops.element("zeroLengthContactASDimplex", element, a, b, kn / 2, ks / 2,
                        2 * joint["mu"], "-orient", *n, "-intType", 0 if implicit else 1)
            ops.element("zeroLength", element + 1, a, b, "-mat", normal, shear, shear,
                        "-dir", 1, 2, 3, "-orient", *n, 0, 1, 0)
            element += 2
        for node in self.base:
            ops.fix(node, 1, 1, 1)
        for node in top:
            ops.fix(node, 0, 1, 0)
        width, thickness = number(wall["length"]), number(wall["unit"][1])
        self.load = number(preload["top_pressure"]) * width * thickness
        ops.timeSeries("Linear", 1)
        self.top = top
        self.push(1, 3, -1.0)
        self.arguments = arguments
        self.analyse()

    def analyse(self):
        """A fresh analysis, for UmfPack refuses one whose constraints have changed."""
        ops.wipeAnalysis()
        ops.constraints("Transformation")
        ops.numberer("RCM")
        ops.system(*self.arguments.system)
        ops.test("NormUnbalance", self.arguments.tolerance, 25)
        ops.algorithm(*self.arguments.algorithm)
        ops.integrator("LoadControl", FIRST_SINKING)
        ops.analysis("Static")

    def push(self, series, axis, sign):
        """Every node of the top by itself: the node retained by `equalDOF` moved wrongly here."""
        ops.pattern("Plain", series, series)
        for node in self.top:
            ops.sp(node, axis, sign)

    def drive(self):
        """Locks the top where it is and makes time the drive."""
        ops.loadConst("-time", 0.0)
        ops.timeSeries("Linear", 2)
        self.push(2, 1, 1.0)
        self.analyse()

    def reaction(self, axis):
        """Sum over the base [N]."""
        ops.reactions()
        return sum(ops.nodeReaction(node, axis) for node in self.base)

    def force(self):
        """What the drive takes [kN]."""
        return -self.reaction(1) / 1e3


class Failed(Exception):
    """No equilibrium, or forces that are not finite."""


class Runner:
    """Takes steps and counts what they cost."""

    def __init__(self, implicit):
        self.cpu, self.solves, self.halvings, self.size = 0.0, 0, 10 if implicit else 0, None

    def step(self, size, left=None):
        """One step, halved where Newton's method fails."""
        left = self.halvings if left is None else left
        if size != self.size:
            ops.integrator("LoadControl", size)
            self.size = size
        begin = time.process_time()
        failed = ops.analyze(1)
        self.cpu += time.process_time() - begin
        self.solves += ops.testIter()
        if failed:
            if left == 0:
                raise Failed
            self.step(size / 2, left - 1)
            self.step(size / 2, left - 1)


def run_opensees(deck, arguments):
    begin = time.process_time()
    model = Model(deck, arguments)
    runner = Runner(arguments.implicit)
    runner.cpu = time.process_time() - begin
    print(f"OpenSees {ops.version()}: {model.solids} elements, {model.nodes} nodes, "
          f"{model.pairs} pairs, made in {runner.cpu:.1f} s", flush=True)
    rows = []
    where = "preload"
    with open(arguments.out / "opensees.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["displacement_mm", "force_kN", "cpu_s", "solves"])
        try:
            size, sunk, carried = FIRST_SINKING, 0.0, 0.0
            for i in range(1, PRELOAD_STEPS + 3):
                runner.step(size)
                sunk, carried = sunk + size, model.reaction(3)
                size = (min(1, (i + 1) / PRELOAD_STEPS) * model.load - carried) * sunk / carried
                if i > PRELOAD_STEPS and abs(size) < 1e-4 * sunk:
                    break
            model.drive()
            runner.size = None
            print(f"preload: {sunk:.4f} mm, {model.reaction(3) / 1e3:.2f} kN, {runner.cpu:.1f} s, "
                  f"{runner.solves} solves", flush=True)
            for i in range(arguments.steps + 1):
                if i:
                    where = f"{i * arguments.step:.3f} mm"
                    runner.step(arguments.step)
                row = (i * arguments.step, model.force(), runner.cpu, runner.solves)
                rows.append(row)
                writer.writerow([f"{row[0]:.6f}", f"{row[1]:.6f}", f"{row[2]:.2f}", row[3]])
                file.flush()
                if not math.isfinite(row[1]):
                    raise Failed
                if i % max(1, arguments.steps // 20) == 0:
                    u, f, cpu, solves = row
                    print(f"  {u:.3f} mm  {f:8.3f} kN  {cpu:8.1f} s  {solves} solves", flush=True)
        except Failed:
            print(f"OpenSees found no equilibrium at {where}, after {runner.cpu:.1f} s", flush=True)
    return rows


# --- wythe --------------------------------------------------------------------------------------


def cpu_of(process):
    """User and system seconds of a process so far (Linux)."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run_wythe(arguments, turn, fidelity):
    """The deck as it is, stopped behind the last displacement: (u, F, CPU s, solves) a row."""
    folder = arguments.out / f"wythe-{fidelity}-{turn}"
    history = folder / "history.csv"
    history.unlink(missing_ok=True)
    command = [arguments.wythe, "run", str(arguments.deck), "--threads", "1", "--out", str(folder)]
    # In full it solves the whole wall, as OpenSees does.
    command += ["--set", f"fidelity={fidelity}"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    seen, rows, solves, stopped = 0, [], 0, False
    while True:
        running = process.poll() is None
        spent = cpu_of(process) if running else None
        lines = history.read_text().split("\n")[:-1] if history.exists() else []
        for row in csv.DictReader(lines[:1] + lines[1 + seen:]):
            seen += 1
            solves += int(row["iterations"])
            if row["step"] == "1" or not rows:
                u, f = float(row["displacement_mm"]), float(row["force_kN"])
                rows.append((u, f, spent if spent is not None else rows[-1][2], solves))
        if rows and rows[-1][0] >= arguments.to - 1e-9 and not stopped and running:
            process.send_signal(signal.SIGINT)
            stopped = True
        if not running:
            break
        time.sleep(0.02)
    if not rows:
        raise SystemExit(f"no history: {' '.join(command)}")
    with open(f"{folder}.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["displacement_mm", "force_kN", "cpu_s", "solves"])
        writer.writerows(rows)
    return rows


# --- the table ----------------------------------------------------------------------------------


def at(rows, u):
    """Force and solves by interpolation, seconds by the first row there."""
    for (u0, f0, *_), (u1, f1, cpu, solves) in zip(rows, rows[1:]):
        if u0 <= u <= u1 + 1e-9 and u1 > u0:
            return f0 + (f1 - f0) * min(1.0, (u - u0) / (u1 - u0)), cpu, solves
    return None


def report(peer, ours, to):
    print("\n| mm | OpenSees kN | wythe kN | OpenSees CPU s | wythe CPU s | ratio | solves |")
    print("|---|---|---|---|---|---|---|")
    for mark in [m for m in MARKS if m < to - 1e-9] + [to]:
        p, w = at(peer, mark), at(ours, mark)
        cells = [f"{x[i]:.1f}" if x else "–" for i in (0, 1) for x in (p, w)]
        cells += [f"{p[1] / w[1]:.1f}"] if p and w else ["–"]
        cells += [" : ".join(str(x[2]) if x else "–" for x in (p, w))]
        print(f"| {mark:g} | " + " | ".join(cells) + " |")
    for name, rows in (("OpenSees", peer), ("wythe", ours)):
        if rows:
            u, f, *_ = max((row for row in rows if row[0] <= to + 1e-9), key=lambda row: row[1])
            print(f"{name}: peak {f:.1f} kN at {u:.2f} mm")


def main():
    parser = argparse.ArgumentParser(description="OpenSeesPy beside wythe on the wall J7D")
    parser.add_argument("wythe", nargs="?", help="the binary; without it OpenSees runs alone")
    parser.add_argument("--deck", type=Path, default=DECK)
    parser.add_argument("--to", type=float, default=4.0, metavar="MM")
    parser.add_argument("--steps", type=int, default=400, help="of the drive, equal ones")
    parser.add_argument("--out", type=Path, default=Path("target/opensees-results"))
    elements = ("bbarBrick", "stdBrick", "SSPbrick")
    parser.add_argument("--element", choices=elements, default=elements[0])
    parser.add_argument("--penalty-factor", type=float, default=500, metavar="E/h")
    parser.add_argument("--viscosity", type=float, default=0.01, metavar="MM", help="of the solids")
    parser.add_argument("--system", nargs="+", default=["UmfPack"])
    parser.add_argument("--algorithm", nargs="+", default=["Newton"])
    parser.add_argument("--tolerance", type=float, default=1.0, metavar="N")
    parser.add_argument("--implicit", action="store_true")
    arguments = parser.parse_args()
    arguments.step = arguments.to / arguments.steps
    arguments.out.mkdir(parents=True, exist_ok=True)
    deck = tomllib.loads(arguments.deck.read_text())

    def wythe(turn):
        kinds = ("full", "auto") if arguments.wythe else ()
        return {kind: run_wythe(arguments, turn, kind) for kind in kinds}

    before = wythe("before")
    peer = run_opensees(deck, arguments)
    after = wythe("after")
    slower = {}
    for kind, rows in before.items():
        for turn, run in (("before", rows), ("after", after[kind])):
            print(f"wythe {kind}, {turn}: {run[-1][2]:.1f} s of CPU to {run[-1][0]:.3f} mm")
        slower[kind] = max(rows, after[kind], key=lambda run: run[-1][2])
    report(peer, slower.get("full", []), arguments.to)
    if slower and peer:
        u, _, cpu, solves = slower["auto"][-1]
        print(f"wythe by default: {cpu:.1f} s of CPU to {u:.3f} mm, {solves} solves; "
              f"OpenSees took {peer[-1][2] / cpu:.0f} times as long to {peer[-1][0]:.3f} mm")
    return 0


if __name__ == "__main__":
    sys.exit(main())
