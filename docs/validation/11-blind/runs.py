"""Runs of the blind predictions, and the tables that are read from them: results, drifts, sensitivity."""

from __future__ import annotations

import csv
import math
import resource
import subprocess
from pathlib import Path

import numpy as np
import wythe

from decks import HERE, LABORATORY, Rule, Wall, deck, stem, walls

ROOT = HERE.parents[2]
RUNS = ROOT / "target" / "blind"
COMMAND = ROOT / "target" / "release" / "wythe"
#: CPU time of a run [s]: of one that does not end by itself the force so far counts, and the table says so.
LIMIT = 600
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


def write(name: str, rows: list[dict[str, object]]) -> None:
    with (HERE / name).open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def read(name: str) -> list[Row]:
    with (HERE / name).open() as file:
        return list(csv.DictReader(file))


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
