"""The blind predictions: decks from walls.csv by rule.md, their runs, and the page.

    python docs/validation/11-blind/blind.py               # runs what target/blind lacks, writes results.csv and the page
    python docs/validation/11-blind/blind.py decks         # writes the decks into target/blind only
    python docs/validation/11-blind/blind.py drifts        # drifts.csv from the runs that there are, and the page
    python docs/validation/11-blind/blind.py page          # the page alone, from results.csv

It needs the package wythe and matplotlib. All runs take some tens of minutes on one core.
"""

from __future__ import annotations

import csv
import math
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import wythe

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
RUNS = ROOT / "target" / "blind"
COMMAND = ROOT / "target" / "release" / "wythe"
#: CPU time of a run [s]: of one that does not end by itself the force so far counts, and the table says so.
LIMIT = 600

DENSITY = {"clay": 1800, "CS": 1900, "sandstone": 2300, "granite": 2600}
LABORATORY = {
    "Magenes2008": "Pavia", "MagenesCalvi1992": "Pavia", "Graziotti2016a": "Pavia", "Graziotti2016b": "Pavia",
    "Anthoine1995": "Ispra", "AbramsShah1992": "Urbana", "Bosiljkov2003": "Ljubljana", "Manzouri1995": "Boulder",
    "Zilch2008": "Munich", "Fehling2007": "Kassel", "Vasconcelos2005": "Guimarães", "Vasconcelos2009": "Guimarães",
    "Lourenco2005": "Guimarães", "Godio2019": "Lausanne",
}  # fmt: skip


@dataclass(frozen=True)
class Rule:
    """Inputs that the sensitivity varies: factors on what a wall has, or constants of rule.md."""

    modulus: float = 1.0
    strength: float = 1.0
    cohesion: float = 1.0
    friction: float = 1.0
    tension: float = 0.05
    opening: float = 0.012
    slip: float = 0.093


@dataclass(frozen=True)
class Wall:
    """A row of walls.csv, and what the rule makes of it: lengths in mm, stresses in MPa."""

    row: dict[str, str]
    rule: Rule = Rule()

    def text(self, column: str) -> str:
        return self.row[column]

    def number(self, column: str, default: float = math.nan) -> float:
        return float(self.row[column]) if self.row[column] else default

    @property
    def name(self) -> str:
        return f"{self.row['source']} {self.row['wall']}"

    @property
    def height(self) -> float:
        return self.number("H_m") * 1e3

    @property
    def length(self) -> float:
        return self.number("L_m") * 1e3

    @property
    def thickness(self) -> float:
        return self.number("t_m") * 1e3

    @property
    def course(self) -> float:
        return self.height / self.number("courses")

    @property
    def bed_joint(self) -> float:
        if self.text("bed") != "GP":
            return 0.0
        joint = self.course - self.number("h_b_mm")
        return joint if 5.0 <= joint <= 15.0 else 10.0

    @property
    def head_joint(self) -> float:
        return min(self.bed_joint, 10.0)

    @property
    def unit_length(self) -> float:
        halves = round(2.0 * (self.length + self.head_joint) / (self.number("l_b_mm") + self.head_joint))
        return 2.0 * (self.length + self.head_joint) / halves - self.head_joint

    @property
    def zero_moment(self) -> float:
        return self.number("H0_over_H") * self.height

    @property
    def modulus(self) -> float:
        return self.rule.modulus * self.number("E_m_MPa", 700.0 * self.number("f_m_MPa"))

    @property
    def strength(self) -> float:
        return self.rule.strength * self.number("f_m_MPa")

    def moduli(self) -> tuple[float, float]:
        """E of unit and mortar: in series over a course they have the modulus of the masonry."""
        joint, unit = self.bed_joint, self.course - self.bed_joint
        if joint == 0.0:
            return self.number("E_b_MPa", self.modulus), math.nan
        if self.text("E_b_MPa"):
            e_b = self.number("E_b_MPa")
            return e_b, joint / (self.course / self.modulus - unit / e_b)
        ratio = min(max(1.5 * self.number("f_b_MPa") / self.number("f_mo_MPa"), 1.0), 20.0)
        e_b = self.modulus * (unit + ratio * joint) / self.course
        return e_b, e_b / ratio

    @property
    def cohesion(self) -> float:
        return self.rule.cohesion * self.number("f_v0_MPa", 0.25)

    @property
    def friction(self) -> float:
        return round(self.rule.friction * self.number("mu", 0.6), 6)

    @property
    def weight(self) -> float:
        """[N]"""
        return DENSITY[self.text("unit_kind")] * 1e-12 * 9810.0 * self.length * self.thickness * self.height

    @property
    def rigid_limit(self) -> float:
        """Largest force of a rigid block under its load and weight [kN]."""
        load = self.number("sigma_0_MPa") * self.length * self.thickness + self.weight
        return load * self.length / (2.0 * self.zero_moment) / 1e3

    def measured(self, quantity: str) -> float:
        """Mean of both directions of `V` [kN] or `drift` [%]."""
        unit = {"V": "kN", "drift": "pct"}[quantity]
        values = [self.number(f"{quantity}_{sign}_{unit}") for sign in ("plus", "minus")]
        given = [v for v in values if not math.isnan(v)]
        return sum(given) / len(given)

    @property
    def modes(self) -> set[str]:
        """Letters of the test's mode: F, S, L (sliding)."""
        text = self.text("mode").replace("SL", "L").replace("TC", "F").replace("R", "F").replace("G", "S")
        return {letter for letter in text if letter in "FSL"}


#: Walls of the sensitivity: one of each kind, among those whose runs are short.
VARIED = ("Magenes2008 CS01", "Anthoine1995 ISP1", "Bosiljkov2003 CLM04", "Godio2019 SC5", "Vasconcelos2009 WI2.250",
          "Vasconcelos2009 WS1.175")  # fmt: skip
#: What is varied: name, scatter (coefficient of variation), rule with less, rule with more.
VARIATIONS = (
    ("E of masonry", 0.30, Rule(modulus=0.7), Rule(modulus=1.3)),
    ("f_m", 0.20, Rule(strength=0.8), Rule(strength=1.2)),
    ("c (and f_t) of joints", 0.30, Rule(cohesion=0.7), Rule(cohesion=1.3)),
    ("friction", 0.15, Rule(friction=0.85), Rule(friction=1.15)),
    ("f_t of units, 0.03 and 0.08 f_b", 0.50, Rule(tension=0.03), Rule(tension=0.08)),
    ("G_I", 0.40, Rule(opening=0.0072), Rule(opening=0.0168)),
    ("G_II", 0.50, Rule(slip=0.0465), Rule(slip=0.14)),
)


def walls() -> list[Wall]:
    with (HERE / "walls.csv").open() as file:
        return [Wall(row) for row in csv.DictReader(file)]


def compression_rows(f_c: float) -> str:
    """Rows over an inelastic strain for a reference length of 1 mm: beyond the peak a strain is a displacement [mm]."""
    energy = 1.6 * f_c if f_c < 12.0 else 15.0 + 0.43 * f_c - 0.0036 * f_c**2
    end = 0.001 + energy / (0.55 * f_c)
    return f"[[{0.8 * f_c:.5g}, 0, 0], [{f_c:.5g}, 0.001, 0], [{0.1 * f_c:.5g}, {end:.6g}, 0.9]]"


def tension_rows(f_t: float) -> str:
    crack = 0.029
    return f"[[{f_t:.5g}, 0, 0], [{f_t / 3:.5g}, {0.8 * crack:.6g}, 0.65], [{0.02 * f_t:.5g}, {3.6 * crack:.6g}, 0.95]]"


def material(name: str, e: float, f_t: float, f_c: float, density: float) -> str:
    return f"""[materials.{name}]
E = {e:.6g}
nu = 0.2
density = "{density} kg/m^3"
tension = {tension_rows(f_t)}
compression = {compression_rows(f_c)}
reference_length = "1 mm"
crack_band = "projected"
"""


def joint(wall: Wall) -> str:
    mu = wall.friction
    if wall.text("bed") == "dry":
        return f"[interfaces.joint]\nf_t = 0\nc = 0\ntan_phi = {mu}\nmu = {mu}\n{dry_stiffness(wall)}"
    c = wall.cohesion
    bonded = f"""[interfaces.joint]
f_t = {c / 1.4:.5g}
c = {c:.5g}
tan_phi = {mu}
mu = {mu}
zeta = 4.38
xi = 1.1
G_I = "{wall.rule.opening} N/mm"
G_II = "{wall.rule.slip * c:.5g} N/mm"
"""
    if wall.text("head") == "U":
        bonded += f"\n[interfaces.dry]\nf_t = 0\nc = 0\ntan_phi = {mu}\nmu = {mu}\n"
    return bonded


def dry_stiffness(wall: Wall) -> str:
    k_n = 1.0 / (wall.course * (1.0 / wall.modulus - 1.0 / wall.number("E_b_MPa")))
    return f'normal_stiffness = "{k_n:.5g} N/mm^3"\nshear_stiffness = "{0.4 * k_n:.5g} N/mm^3"\n'


def deck(wall: Wall) -> str:
    e_b, e_j = wall.moduli()
    f_m, density = wall.strength, DENSITY[wall.text("unit_kind")]
    parts = [f'format = 1\ntitle = "{wall.name}"\n']
    parts.append(material("unit", e_b, wall.rule.tension * wall.number("f_b_MPa"), f_m, density))
    mortar = ""
    if wall.bed_joint > 0.0:
        f_t = max(0.1 * wall.number("f_mo_MPa"), wall.cohesion / 1.4)
        parts.append(material("mortar", e_j, f_t, f_m, density))
        mortar = 'mortar_material = "mortar"\n'
    parts.append('[materials.ground]\nE = "30 GPa"\nnu = 0.2\ndensity = "2400 kg/m^3"\n')
    parts.append(joint(wall))
    heads = 'head_interface = "dry"\n' if wall.text("head") == "U" else ""
    points = '[contact]\npoints = "corner"\n' if wall.text("bed") == "dry" else ""
    mesh = "mesh = [4, 1, 1]\n" if wall.text("bed") == "dry" else ""
    over = (wall.unit_length + wall.head_joint) / 2.0
    parts.append(f"""{points}
[wall]
unit = [{wall.unit_length:.8g}, {wall.thickness:.6g}, {wall.course - wall.bed_joint:.8g}]
bed_joint = {wall.bed_joint:.8g}
head_joint = {wall.head_joint:.8g}
length = {wall.length:.8g}
courses = {wall.text("courses")}
overlap = {over:.8g}
unit_material = "unit"
{mortar}{heads}{mesh}interface = "joint"
clamped = false

[[blocks]]
name = "ground"
size = [{wall.length + 200:.8g}, {wall.thickness:.6g}, 100]
at = [-100, 0, -100]
material = "ground"
mesh = [{max(8, round(wall.length / 60))}, 1, 1]

[[contacts]]
slave = "wall.bottom"
master = "ground.top"
interface = "joint"

[[supports]]
on = "ground"
""")
    level = wall.zero_moment < wall.height
    depth = 100.0 if level else max(20.0, 2.0 * (wall.zero_moment - wall.height))
    parts.append(f"""[[beams]]
name = "beam"
on = "wall.top"
depth = {depth:.6g}
rotation = "{"level" if level else "free"}"
interface = "joint"

[[steps]]
kind = "gravity"

[[steps]]
kind = "preload"
beam = "beam"
pressure = {wall.number("sigma_0_MPa"):.6g}

[[steps]]
kind = "drive"
beam = "beam"
direction = "x"
displacement = {0.01 * wall.height:.6g}
{'free = ["z"]' if level else ""}
stop = {{ below_peak = 0.8 }}

[output]
mcap = false
""")
    return "\n".join(parts)


def stem(wall: Wall) -> str:
    return wall.name.replace(" ", "-").replace(".", "_")


def run(wall: Wall, name: str = "") -> Path:
    """Runs the deck unless it has run, or the same deck has under another name (tests that were repeated)."""
    text = deck(wall)
    path = RUNS / f"{name or stem(wall)}.toml"
    out = path.with_suffix(".out")
    done = out / "cpu.txt"
    if path.is_file() and path.read_text() == text and done.is_file():
        return out
    path.write_text(text)
    body = text.split("\n", 3)[3]
    for other in sorted(RUNS.glob("*.toml")):
        folder = other.with_suffix(".out")
        if other != path and (folder / "cpu.txt").is_file() and other.read_text().split("\n", 3)[3] == body:
            return folder
    limit = ["bash", "-c", f'ulimit -t {LIMIT}; exec "$@"', "run", str(COMMAND), "run", str(path)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    answer = subprocess.run([*limit, "--out", str(out), "--threads", "1", "--quiet"], capture_output=True, text=True)
    used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    done.parent.mkdir(exist_ok=True)
    done.write_text(f"{used:.1f} {answer.returncode}\n{answer.stderr[-2000:]}\n")
    return out


def mode_of(wall: Wall, results: wythe.Results, lasting: bool = True) -> str:
    """Mode of a run by its last state: S, F, FS or L (sliding); the rule is in rule.md, `lasting` its addition."""
    frame = results.frame("last")
    joints = frame.interfaces
    quads = joints.corners[joints.quads]  # (points, 4, 3)
    middle = quads.mean(axis=1)
    normal = np.cross(quads[:, 2] - quads[:, 0], quads[:, 3] - quads[:, 1])
    kind = np.abs(normal).argmax(axis=1)  # 0 head joints, 2 bed joints
    height, course = wall.height, wall.course
    top = frame.displacement[results.nodes[:, 2] > height - 1e-3, 0].mean()
    beds = kind == 2
    for level in range(int(wall.number("courses")) + 1):
        near = beds & (np.abs(middle[:, 2] - level * course) < 0.6 * course)
        here = near & (np.abs(middle[:, 2] - np.median(middle[near, 2])) < 1e-3) if near.any() else near
        if here.any() and np.abs(joints.slip[here]).max(axis=1).mean() > 0.5 * abs(top):
            return "L"
    inner = range(math.ceil(0.25 * height / course), math.floor(0.75 * height / course))
    unit = np.array([results.materials[m] == "unit" for m in results.material])
    levels = results.nodes[results.elements].mean(axis=1)[:, 2]
    cut = 0
    for k in inner:
        low, high = k * course, (k + 1) * course
        gap = (kind == 0) & (middle[:, 2] > low) & (middle[:, 2] < high) & (joints.opening > 0.1)
        crack = unit & (levels > low) & (levels < high) & (frame.tensile_damage > 0.9)
        cut += bool(gap.any() or crack.any())
    # Added after the first run (rule.md): a stepped crack through which a wall rocks keeps its force.
    if cut < 0.7 * len(inner) or (lasting and results.verdict_kind != "peak_passed"):
        return "F"
    return "FS" if results.peak_force >= 0.95 * wall.rigid_limit else "S"


def table() -> list[dict[str, object]]:
    """A row of results.csv for each wall that has run."""
    rows = []
    for wall in walls():
        out = run(wall)
        cpu, code = (out / "cpu.txt").read_text().split("\n")[0].split()
        results = wythe.Results(out)
        # Forces that inertia carries between two equilibria do not count (theory/inertia.md, eq. 12).
        force, moved = results.peak_force, results.displacement_at_peak
        rows.append({
            "source": wall.text("source"), "wall": wall.text("wall"), "laboratory": LABORATORY[wall.text("source")],
            "status": results.status, "V_kN": round(force, 2), "V_test_kN": round(wall.measured("V"), 2),
            "ratio": round(force / wall.measured("V"), 3),
            "drift_pct": round(100.0 * moved / wall.height, 3),
            "drift_test_pct": round(wall.measured("drift"), 3),
            "rigid_kN": round(wall.rigid_limit, 1), "mode": mode_of(wall, results),
            "mode_test": wall.text("mode"), "right": int(bool(set(mode_of(wall, results)) & wall.modes)),
            "right_first": int(bool(set(mode_of(wall, results, lasting=False)) & wall.modes)),
            "verdict": results.verdict_kind, "solves": results.summary.get("iterations", ""),
            "energy_error": f"{results.energy_balance_error:.1e}", "cpu_s": cpu,
        })  # fmt: skip
    return rows


Row = dict[str, str]


def vary() -> None:
    """Runs the variations and writes sensitivity.csv."""
    chosen = {w.name: w for w in walls()}
    rows = []
    for name in VARIED:
        base = wythe.Results(run(chosen[name])).peak_force
        for what, scatter, less, more in VARIATIONS:
            values = []
            for k, rule in enumerate((less, more)):
                wall = Wall(chosen[name].row, rule)
                out = run(wall, f"{stem(wall)}-{what.split()[0]}-{k}")
                values.append(wythe.Results(out).peak_force / base - 1.0)
                print(name, what, f"{values[-1]:+.3f}", flush=True)
            rows.append({"wall": name, "input": what, "scatter": scatter, "less": round(values[0], 4), "more": round(values[1], 4)})
    write("sensitivity.csv", rows)


def sensitivity() -> list[str]:
    """Table of the changes of the largest force, and the band that the scatter of all inputs makes."""
    rows = read("sensitivity.csv")
    lines = ["| Input (scatter) | " + " | ".join(VARIED) + " |", "|---|" + "---|" * len(VARIED)]
    for what, scatter, _, _ in VARIATIONS:
        these = {r["wall"]: r for r in rows if r["input"] == what}
        cells = [f"{100 * float(these[w]['less']):+.0f}, {100 * float(these[w]['more']):+.0f} %" for w in VARIED]
        lines.append(f"| {what} ({100 * scatter:.0f} %) | " + " | ".join(cells) + " |")
    bands = []
    for name in VARIED:
        spread = [0.5 * (float(r["more"]) - float(r["less"])) for r in rows if r["wall"] == name]
        bands.append(f"± {100 * math.sqrt(sum(x * x for x in spread)):.0f} %")
    lines.append("| all, as independent | " + " | ".join(bands) + " |")
    return lines


def write(name: str, rows: list[dict[str, object]]) -> None:
    with (HERE / name).open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read(name: str) -> list[Row]:
    with (HERE / name).open() as file:
        return list(csv.DictReader(file))


def groups(rows: list[Row]) -> list[tuple[str, list[Row]]]:
    """Rows by what the page compares."""
    kind = {(w.text("source"), w.text("wall")): w for w in walls()}
    wall = {id(row): kind[row["source"], row["wall"]] for row in rows}
    within = [row for row in rows if float(row["V_test_kN"]) <= float(row["rigid_kN"])]
    out = [
        ("all walls", rows),
        ("all within the limit of a rigid block", within),
        ("bricks", [r for r in rows if wall[id(r)].text("set") == "brick"]),
        ("bricks, general-purpose mortar", [r for r in rows if wall[id(r)].text("set") == "brick" and wall[id(r)].text("bed") == "GP"]),
        ("bricks, thin layers", [r for r in rows if wall[id(r)].text("bed") == "TL"]),
        ("stones, dry", [r for r in rows if wall[id(r)].text("bed") == "dry"]),
        ("stones, lime mortar", [r for r in rows if wall[id(r)].text("set") == "stone" and wall[id(r)].text("bed") == "GP"]),
        ("double bending", [r for r in rows if wall[id(r)].number("H0_over_H") < 1.0]),
        ("cantilevers", [r for r in rows if wall[id(r)].number("H0_over_H") >= 1.0]),
    ]  # fmt: skip
    for name in dict.fromkeys(LABORATORY.values()):
        out.append((name, [r for r in rows if r["laboratory"] == name]))
    for letter, name in (("S", "tests in shear"), ("F", "tests in flexure"), ("SF", "hybrid tests"), ("L", "sliding")):
        modes = [r for r in rows if "".join(sorted(wall[id(r)].modes, reverse=True)) == letter]
        out.append((name, modes))
    return out


def summary_row(name: str, rows: list[Row]) -> str:
    ratio = np.array([float(r["ratio"]) for r in rows])
    drift = np.array([float(r["drift_pct"]) / float(r["drift_test_pct"]) for r in rows])
    close = np.mean((drift >= 0.5) & (drift <= 2.0))
    right, first = (np.mean([r[c] == "1" for r in rows]) for c in ("right", "right_first"))
    spread = ratio.std(ddof=1) / ratio.mean() if len(ratio) > 1 else math.nan
    cov = f"{100 * spread:.0f} %" if len(ratio) > 1 else ""
    return f"| {name} | {len(rows)} | {ratio.mean():.2f} | {cov} | {100 * first:.0f} % | {100 * right:.0f} % | {100 * close:.0f} % |"


def secant(u: np.ndarray, force: np.ndarray, level: float) -> float:
    """Force over displacement where a curve from the origin first reaches a force; none if it does not."""
    for i in range(len(force) - 1):
        if force[i] < level <= force[i + 1]:
            return level / (u[i] + (u[i + 1] - u[i]) * (level - force[i]) / (force[i + 1] - force[i]))
    return math.nan


def measured_stiffness(wall: Wall, points: list[Row]) -> float:
    """Secant stiffness of the measured envelope at half of its largest force, mean of both directions [kN/mm]."""
    these = [r for r in points if (r["source"], r["wall"]) == (wall.text("source"), wall.text("wall"))]
    found = []
    for sign in (1, -1):
        side = sorted((sign * float(r["displacement_mm"]), sign * float(r["force_kN"])) for r in these)
        side = [(0.0, 0.0), *(point for point in side if point[0] > 0.0)]
        u, force = np.array(side).T
        found.append(secant(u, force, 0.5 * wall.measured("V")))
    return float(np.nanmean(found)) if not np.all(np.isnan(found)) else math.nan


def drift_rows() -> list[dict[str, object]]:
    """A row of drifts.csv for each wall: the drifts between which its run carries 0.95 of its peak, and stiffnesses."""
    results = {(r["source"], r["wall"]): r for r in read("results.csv")}
    points = read("curves.csv")
    rows = []
    for wall in walls():
        history = wythe.Results(run(wall)).history
        u, force = (np.concatenate([[0.0], x[history.driven]]) for x in (history.displacement_mm, history.force_kN))
        peak = float(results[wall.text("source"), wall.text("wall")]["V_kN"])
        near = np.flatnonzero(force >= 0.95 * peak)
        stiffness = (secant(u, force, 0.5 * peak), measured_stiffness(wall, points))
        rows.append({
            "source": wall.text("source"), "wall": wall.text("wall"),
            "from_pct": round(100.0 * u[near[0]] / wall.height, 3), "to_pct": round(100.0 * u[near[-1]] / wall.height, 3),
            "end_pct": round(100.0 * u.max() / wall.height, 3),
            "k_kN_mm": f"{stiffness[0]:.4g}", "k_test_kN_mm": "" if math.isnan(stiffness[1]) else f"{stiffness[1]:.4g}",
        })  # fmt: skip
    return rows


def drift_groups(rows: list[Row]) -> list[tuple[str, list[Row]]]:
    """Rows by what the section on drifts compares."""
    kind = {(w.text("source"), w.text("wall")): w for w in walls()}
    of = lambda row: kind[row["source"], row["wall"]]
    bricks = [r for r in rows if of(r).text("set") == "brick"]
    stones = [r for r in rows if of(r).text("set") == "stone"]
    out = [
        ("all walls", rows),
        ("bricks, general-purpose mortar", [r for r in bricks if of(r).text("bed") == "GP"]),
        ("bricks, thin layers", [r for r in bricks if of(r).text("bed") == "TL"]),
        ("stones, lime mortar", [r for r in stones if of(r).text("bed") == "GP"]),
        ("stones, dry, cyclic tests", [r for r in stones if of(r).text("bed") == "dry" and r["source"] != "Lourenco2005"]),
        ("stones, dry, monotonic tests", [r for r in rows if r["source"] == "Lourenco2005"]),
        ("double bending", [r for r in rows if of(r).number("H0_over_H") < 1.0]),
        ("cantilevers", [r for r in rows if of(r).number("H0_over_H") >= 1.0]),
        ("tests in shear alone", [r for r in rows if of(r).modes == {"S"}]),
        ("tests in flexure alone", [r for r in rows if of(r).modes == {"F"}]),
        ("other tests", [r for r in rows if of(r).modes not in ({"S"}, {"F"})]),
    ]
    for name in dict.fromkeys(r["source"] for r in rows):
        out.append((name, [r for r in rows if r["source"] == name]))
    return out


def drift_row(name: str, rows: list[Row], also: dict[tuple[str, str], Row]) -> str:
    """Ratios of the drifts of a group, and where the measured drifts lie."""
    extra = [also[r["source"], r["wall"]] for r in rows]
    test, own = (np.array([float(r[c]) for r in rows]) for c in ("drift_test_pct", "drift_pct"))
    low, high = (np.array([float(e[c]) for e in extra]) for c in ("from_pct", "to_pct"))
    lower, middle, upper = np.percentile(own / test, (16, 50, 84))
    inside = int(((test >= low) & (test <= high)).sum())
    near = int(((2.0 * test >= low) & (test <= 2.0 * high)).sum())
    curves = np.array([bool(e["k_test_kN_mm"]) for e in extra])
    said = " | "
    if curves.any():
        stiffness = np.array([float(e["k_kN_mm"]) / float(e["k_test_kN_mm"]) for e in extra if e["k_test_kN_mm"]])
        softened = own[curves] * stiffness / test[curves]
        close = int(((softened >= 0.5) & (softened <= 2.0)).sum())
        said = f"{np.median(stiffness):.1f} | {np.median(softened):.2f}, {close} of {curves.sum()}"
    return (
        f"| {name} | {len(rows)} | {middle:.2f} | {lower:.2f} to {upper:.2f} | {int((test > 1.0).sum())} "
        f"| {int((test < low).sum())}, {inside}, {int((test > high).sum())} | {near} | {said} |"
    )


def drifts(rows: list[Row]) -> list[str]:
    """Table of the drifts at the largest force."""
    also = {(r["source"], r["wall"]): r for r in read("drifts.csv")}
    lines = [
        "| Walls | Number | Ratio of drifts, median | 16 to 84 % | Measured above 1 % | Measured below, within, above the flat top "
        "| Within a factor of 2 of it | Stiffness, run over test | Ratio times this: median, within a factor of 2 |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    return lines + [drift_row(name, these, also) for name, these in drift_groups(rows) if these]


def matrix(rows: list[Row]) -> list[str]:
    """Modes of the runs against those of the tests."""
    kind = {(w.text("source"), w.text("wall")): w for w in walls()}
    names = {"S": "shear", "F": "flexure", "FS": "both", "L": "sliding"}
    lines = ["| Test | " + " | ".join(f"run: {names[m]}" for m in ("S", "FS", "F", "L")) + " |", "|---|---|---|---|---|"]
    labels = {"S": "shear", "F": "flexure", "SF": "shear and flexure", "L": "sliding", "LF": "sliding and flexure"}
    of = lambda row: "".join(sorted(kind[row["source"], row["wall"]].modes, key="SLF".index))
    for modes in sorted({of(r) for r in rows}):
        count = [sum(of(r) == modes and r["mode"] == m for r in rows) for m in ("S", "FS", "F", "L")]
        label = labels.get(modes, "shear, sliding and flexure")
        lines.append(f"| {label} | " + " | ".join(map(str, count)) + " |")
    return lines


def pictures(rows: list[Row]) -> None:
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "wythe", "font.size": 9, "svg.fonttype": "none"})
    meta = {"Date": None, "Creator": None}
    figure, axes = plt.subplots(figsize=(6, 5.4), layout="constrained")
    ends = np.array([10.0, 1000.0])
    axes.loglog(ends, ends, color="0.4", lw=1)
    axes.fill_between(ends, ends / 1.2, ends * 1.2, color="0.9", lw=0)
    for k, name in enumerate(dict.fromkeys(LABORATORY.values())):
        these = [r for r in rows if r["laboratory"] == name]
        test, run_ = ([float(r[c]) for r in these] for c in ("V_test_kN", "V_kN"))
        axes.plot(test, run_, "os^vDPX*h"[k], ms=6, mfc="none", color=f"C{k}", label=name)
    axes.set(xlabel="largest force of the test [kN]", ylabel="predicted [kN]", xlim=ends, ylim=ends)
    axes.legend(fontsize=8)
    axes.set_title("Predicted and measured; the band is 20 % wide on either side", fontsize=9)
    figure.savefig(HERE / "predicted.svg", metadata=meta)
    measured = read("curves.csv")
    chosen = [w for w in walls() if w.text("set") == "stone"]
    for part, name in ((lambda w: w.text("bed") == "GP", "mortar"), (lambda w: w.text("bed") == "dry", "dry")):
        these = [w for w in chosen if part(w)]
        columns = 4
        lines = math.ceil(len(these) / columns)
        figure, grid = plt.subplots(lines, columns, figsize=(9, 1.9 * lines), layout="constrained", squeeze=False)
        for axes in grid.flat[len(these):]:
            axes.axis("off")
        for axes, wall in zip(grid.flat, these, strict=False):
            points = [r for r in measured if (r["source"], r["wall"]) == (wall.text("source"), wall.text("wall"))]
            u, f = (np.array([float(r[c]) for r in points]) for c in ("displacement_mm", "force_kN"))
            for sign in (1, -1):
                side = sign * u >= 0
                axes.plot(sign * u[side], sign * f[side], color="0.6", lw=1)
            history = wythe.Results(run(wall)).history
            d = history.driven
            axes.plot(history.displacement_mm[d], history.force_kN[d], color="C3", lw=1.2)
            axes.set_title(wall.text("wall"), fontsize=8)
            axes.set_xlim(0, 0.012 * wall.height)
            axes.set_ylim(0, None)
            axes.tick_params(labelsize=7)
        figure.supxlabel("displacement [mm]", fontsize=8)
        figure.supylabel("force [kN]", fontsize=8)
        figure.savefig(HERE / f"curves-{name}.svg", metadata=meta)
        plt.close(figure)


def page() -> None:
    rows = read("results.csv")
    pictures(rows)
    text = (HERE / "page.txt").read_text()
    summary = [
        "| Walls | Number | Mean | CoV | Mode right, first rule | Mode right | Drift within a factor of 2 |",
        "|---|---|---|---|---|---|---|",
    ]
    summary += [summary_row(name, these) for name, these in groups(rows) if these]
    names = {"S": "shear", "F": "flexure", "FS": "both", "L": "sliding"}
    long = ["| Wall | V test | V run | Ratio | Drift test | Drift run | Mode test | Mode run | Solves, CPU |", "|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        dagger = " †" if float(r["V_test_kN"]) > float(r["rigid_kN"]) else ""
        ended = "" if r["status"] in ("completed", "collapsed") else f" ({r['status'].replace('_', ' ')})"
        long.append(
            f"| {r['source']} {r['wall']}{dagger} | {r['V_test_kN']} | {r['V_kN']}{ended} | {r['ratio']} | {r['drift_test_pct']} "
            f"| {r['drift_pct']} | {r['mode_test']} | {names[r['mode']]} | {r['solves']}, {r['cpu_s']} s |"
        )
    for mark, lines in (("summary", summary), ("modes", matrix(rows)), ("walls", long), ("sensitivity", sensitivity()), ("drifts", drifts(rows))):
        text = text.replace(f"<!-- {mark} -->", "\n".join(lines))
    (HERE / "README.md").write_text(text)


def main() -> None:
    RUNS.mkdir(parents=True, exist_ok=True)
    task = sys.argv[1] if len(sys.argv) > 1 else "all"
    chosen = [w for w in walls() if len(sys.argv) < 3 or any(a in w.name for a in sys.argv[2:])]
    if task == "decks":
        for wall in chosen:
            (RUNS / f"{stem(wall)}.toml").write_text(deck(wall))
        return
    if task in ("run", "all"):
        for wall in chosen:
            out = run(wall)
            print(wall.name, (out / "cpu.txt").read_text().split("\n")[0], flush=True)
    if task in ("vary", "all"):
        vary()
    if task in ("table", "all"):
        write("results.csv", table())
    if task in ("drifts", "all"):
        write("drifts.csv", drift_rows())
    if task in ("page", "drifts", "table", "all"):
        page()


if __name__ == "__main__":
    main()
