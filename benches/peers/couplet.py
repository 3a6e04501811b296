"""The couplet in shear, scene 1 of docs/accuracy-speed.md, for the peers that are run beside it.

What they have alike: two bodies of wythe's default mesh of the whole (5 x 1 hexahedra a layer), the
base held, the top level, pressed, driven by the displacements of wythe's default increments.

Their joints are pairs of nodes or facets that face each other, and have two parts side by side, for
no peer has wythe's law: Coulomb friction mu, and a bond that knows nothing of the pressure.
Strength of the bond is therefore c + (tan phi - mu) p at the mean pressure p, so that both together
have the peak c + p tan phi. Joints yield elastically by a thousandth of delta_k at the strength of
the bond: with wythe's 500 E/h, 0.2 nm, Kratos and OpenSees found no equilibrium, and with 50 E/h
CalculiX took 30 times the time.
"""

import csv
import itertools
import math
import os
import statistics
import subprocess
import tomllib
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[threads] = "1"

ROOT = Path(__file__).parents[2]
DECK = ROOT / "examples" / "02_couplet_shear.toml"
MODULUS = 1e6  # of bricks and mortar [MPa], as the scene sets it
ELASTIC = 1e-3  # slip at the strength of the bond, over delta_k
ALONG, ACROSS = 5, 1  # elements


def number(value):
    """A value of the deck in N, mm, MPa."""
    return float(value.split()[0]) if isinstance(value, str) else float(value)


class Couplet:
    """Nodes, elements, law and drive. Bodies are 0 (brick and mortar) and 1 (brick)."""

    def __init__(self):
        deck = tomllib.loads(DECK.read_text())
        wall, joint = deck["wall"], deck["interfaces"]["joint"]
        length, width, height = map(number, wall["unit"])
        self.area = length * width
        self.modulus, self.poisson = MODULUS, deck["materials"]["brick"]["nu"]
        self.pressure = number(deck["steps"][0]["top_pressure"])
        self.load = self.pressure * self.area
        self.mu, self.f_t = joint["mu"], number(joint["f_t"])
        self.u_k, self.zeta = number(joint["u_k"]), joint["zeta"]
        self.delta_k, self.xi = number(joint["delta_k"]), joint["xi"]
        self.bond = number(joint["c"]) + (joint["tan_phi"] - self.mu) * self.pressure
        self.tangential = self.bond / (ELASTIC * self.delta_k)
        self.normal = 2 * (1 + self.poisson) * self.tangential
        to = number(deck["steps"][1]["displacement"])
        # (displacement, increments to it): those of wythe's default, which grow to 1/80.
        self.legs = [(0.01 * to, 2), (0.0175 * to, 1), (0.02875 * to, 1), (to, 78)]

        self.nodes, self.solids, self.index = {}, [], {}
        bed = number(wall["bed_joint"])
        bodies = (0.0, height, height + bed), (height + bed, 2 * height + bed)
        for body, planes in enumerate(bodies):
            for k, z in enumerate(planes):
                for j in range(ACROSS + 1):
                    for i in range(ALONG + 1):
                        tag = len(self.nodes) + 1
                        self.nodes[tag] = (length * i / ALONG, width * j / ACROSS, z)
                        self.index[body, i, j, k] = tag
            for k in range(len(planes) - 1):
                for j in range(ACROSS):
                    for i in range(ALONG):
                        lower, upper = (self.facet(body, i, j, k + r) for r in (0, 1))
                        self.solids.append((body, k, lower + upper))
        self.base = [tag for (body, _, _, k), tag in self.index.items() if (body, k) == (0, 0)]
        self.top = [tag for (body, _, _, k), tag in self.index.items() if (body, k) == (1, 1)]
        cells = [(i, j) for j in range(ACROSS) for i in range(ALONG)]
        # Of the joint: facets that face each other, and pairs of nodes with their areas.
        self.facets = [(self.facet(0, i, j, 2), self.facet(1, i, j, 0)) for i, j in cells]
        self.pairs = {}
        for lower, upper in self.facets:
            for pair in zip(lower, upper):
                self.pairs[pair] = self.pairs.get(pair, 0.0) + self.area / len(cells) / 4

    def facet(self, body, i, j, k):
        """Nodes of a cell of a plane, counterclockwise seen from above."""
        corners = ((0, 0), (1, 0), (1, 1), (0, 1))
        return [self.index[body, i + p, j + q, k] for p, q in corners]

    def left(self, slip):
        """Part of the bond that is left: 1 - H, Eqs 5 to 8 of D'Altri et al. (2018)."""
        worn = 1 - math.exp(-self.xi * min(slip, self.delta_k) / self.delta_k)
        return 1 - worn / (1 - math.exp(-self.xi))

    def left_open(self, opening):
        """Part of the tensile strength that is left: 1 - Q, of the same equations."""
        worn = 1 - math.exp(-self.zeta * min(opening, self.u_k) / self.u_k)
        return 1 - worn / (1 - math.exp(-self.zeta))

    def energy_of_bond(self):
        """Area under bond × `left` [N/mm]."""
        return self.bond * self.delta_k * (1 / self.xi - 1 / (math.exp(self.xi) - 1))

    def drive(self):
        """Displacements of the top at the ends of the increments [mm]."""
        at, ends = 0.0, []
        for to, parts in self.legs:
            ends += [at + (to - at) * i / parts for i in range(1, parts + 1)]
            at = to
        return ends

    def known(self, u):
        """Force of the closed form [kN]."""
        return (self.mu * self.pressure + self.bond * self.left(u)) * self.area / 1e3


def default_seconds(wythe, out):
    """CPU seconds of the solver in the scene's default, as the study measures them."""
    command = [wythe, "study", "accuracy-speed", "--only", "1", "--repeats", "3", "--out", str(out)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    table = next(out.glob("01-*/table.csv")).read_text().splitlines()
    rows = csv.DictReader(line for line in table if not line.startswith("#"))
    return next(float(row["cpu_s"]) for row in rows if row["choice"] == "default")


def compare(name, run, wythe, out, repeats=7):
    """Runs a peer and wythe by turns, for hosts drift: medians of both count.

    Its curve goes to `out`, errors and ratio to the terminal. `run()` gives rows of displacement
    [mm], force [kN], CPU seconds so far and solves so far.
    """
    out.mkdir(parents=True, exist_ok=True)
    wythe = str(Path(wythe).resolve()) if wythe else None
    runs, seconds = [], []
    for _ in range(repeats):
        if wythe:
            seconds.append(default_seconds(wythe, out.resolve() / "study"))
        runs.append(run())
    runs.sort(key=lambda rows: rows[-1][2])
    rows = runs[len(runs) // 2]
    with open(out / f"{name}.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["displacement_mm", "force_kN", "cpu_s", "solves"])
        for u, f, cpu, solves in rows:
            writer.writerow([f"{u:.6f}", f"{f:.6f}", f"{cpu:.4f}", solves])
    couplet = Couplet()
    steps = [(a, b) for a, b in itertools.pairwise(rows) if a[0] > 0]
    energy = [sum((b[0] - a[0]) * (f(a) + f(b)) / 2 for a, b in steps)
              for f in (lambda row: row[1], lambda row: couplet.known(row[0]))]
    peak = max(row[1] for row in rows)
    cpu = rows[-1][2]
    print(f"{name}: peak {peak:.3f} kN ({peak / couplet.known(0) - 1:+.2%}), "
          f"energy {energy[0] / energy[1] - 1:+.2%}, {rows[-1][3]} solves, {cpu:.3f} s of CPU "
          f"({runs[0][-1][2]:.3f} to {runs[-1][-1][2]:.3f})")
    if seconds:
        default = statistics.median(seconds)
        print(f"wythe's default: {default:.4f} s of CPU "
              f"({min(seconds):.4f} to {max(seconds):.4f}), ratio {cpu / default:.0f}")
