"""Runs the variants of the two shear walls that docs/validation.md reports, and draws their curves.

    python3 -m pip install matplotlib
    cargo build --release
    python3 tests/validation/variants.py [--jobs 2] [--out target/validation] [NAME...]

Each variant is an example deck with a few keys changed, run on one thread. Runs that are complete are
not repeated; the table is printed, the figures go to docs/validation/.
"""

import argparse
import bisect
import csv
import json
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
J7D, J4D = "03_shear_wall_j7d.toml", "04_shear_wall_j4d.toml"

# name: (example, keys changed, what it is)
VARIANTS = {
    "j7d": (J7D, {}, "as it stands"),
    "j7d-implicit": (
        J7D,
        {"steps.0.tangent": "consistent", "steps.1.tangent": "consistent"},
        "everything implicit, tolerance 5e-3",
    ),
    "j7d-implex": (
        J7D,
        {"steps.0.procedure": "implex", "steps.1.procedure": "implex"},
        "solids extrapolated, tolerance 2e-2",
    ),
    "j7d-tight": (J7D, {"steps.1.tolerance.residual": 5e-3}, "tolerance 5e-3"),
    "j7d-inviscid": (J7D, {"steps.1.viscosity": 0}, "without viscosity"),
    "j7d-fine": (J7D, {"wall.mesh": "fine"}, "108 hex8 a unit"),
    "j7d-elastic": (J7D, "elastic", "elastic units and mortar"),
    "j7d-penalty-20": (J7D, {"interfaces.joint.penalty_factor": 20}, "penalty 20"),
    "j7d-penalty-100": (J7D, {"interfaces.joint.penalty_factor": 100}, "penalty 100"),
    "j7d-half-bond": (J7D, {"wall.length": "961.75 mm"}, "961.75 mm, strict half bond"),
    "j7d-free": (J7D, {"steps.1.vertical": "free"}, "top free under constant load"),
    "j7d-b-bar": (J7D, {"element.formulation": "b-bar"}, "B-bar"),
    "j7d-full": (J7D, {"element.formulation": "full"}, "full integration"),
    "j7d-corner": (J7D, {"contact.points": "corner"}, "contact at the corners"),
    "j4d": (J4D, {}, "as it stands"),
    "j4d-free": (J4D, {"steps.1.vertical": "free"}, "top free under constant load"),
    "j4d-elastic": (J4D, "elastic", "elastic units and mortar"),
}

# file: (title, variants)
FIGURES = {
    "fig11a": ("J7D: mesh of the representative elements", ["j7d", "j7d-fine"]),
    "fig11b": ("J7D: representative elements with CDP and elastic", ["j7d", "j7d-elastic"]),
    "procedure": ("J7D: procedures", ["j7d", "j7d-implex", "j7d-implicit"]),
    "viscosity": ("J7D: viscosity of the step", ["j7d", "j7d-inviscid"]),
    "penalty": ("J7D: penalty factor", ["j7d-penalty-20", "j7d-penalty-100", "j7d"]),
    "elements": ("J7D: element and contact points", ["j7d", "j7d-b-bar", "j7d-full", "j7d-corner"]),
    "top": ("Top locked after preload, and free", ["j7d", "j7d-free", "j4d", "j4d-free"]),
}


def deck(name, out):
    """The deck of a variant and the keys to set."""
    example, changes, _ = VARIANTS[name]
    path = ROOT / "examples" / example
    if changes != "elastic":
        return path, changes
    # Without its tables a material is linear elastic.
    text = re.sub(r"^(tension|compression|reference_length) = .*\n", "", path.read_text(), flags=re.M)
    text = re.sub(r"^viscosity = .*\n?", "", text, flags=re.M)
    path = out / f"{name}.toml"
    path.write_text(text)
    return path, {}


def run(name, out):
    folder = out / name
    if (folder / "summary.json").exists():
        return
    path, changes = deck(name, out)
    command = [ROOT / "target/release/wythe", "run", path, "--out", folder, "--threads", "1"]
    for key, value in changes.items():
        command += ["--set", f"{key}={value}"]
    with open(out / f"{name}.log", "w") as log:
        subprocess.run(command, stdout=log, stderr=log, check=False)
    print(f"{name} done", file=sys.stderr)


def drive(folder):
    """Displacement [mm] and force [kN] of the drive."""
    with open(folder / "history.csv") as file:
        rows = [row for row in csv.DictReader(file) if row["step"] == "1"]
    return (
        [0.0] + [float(row["displacement_mm"]) for row in rows],
        [0.0] + [float(row["force_kN"]) for row in rows],
    )


def at(curve, x):
    xs, ys = curve
    i = min(max(bisect.bisect_left(xs, x), 1), len(xs) - 1)
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])


def table(names, out):
    print("| Run | peak kN | at mm | at 4 mm kN | area | rms | increments | solves | cuts | CPU s |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name in names:
        folder = out / name
        if not (folder / "summary.json").exists():
            continue
        summary = json.loads((folder / "summary.json").read_text())
        curve, base = drive(folder), drive(out / name.split("-")[0])
        end = min(curve[0][-1], base[0][-1])
        grid = [end * k / 800 for k in range(801)]
        ours, theirs = [at(curve, x) for x in grid], [at(base, x) for x in grid]
        area = 100 * (sum(ours) / sum(theirs) - 1)
        square = sum((a - b) ** 2 for a, b in zip(ours, theirs)) / len(grid)
        rms = 100 * square**0.5 / max(theirs)
        last = f"{curve[1][-1]:.1f}" + ("" if curve[0][-1] > 3.999 else f" ({curve[0][-1]:.2f} mm)")
        print(
            f"| {name}: {VARIANTS[name][2]} | {summary['peak_force_kN']:.2f} "
            f"| {summary['displacement_at_peak_mm']:.2f} | {last} | {area:+.2f} % | {rms:.2f} % "
            f"| {summary['increments']} | {summary['iterations']} | {summary['cutbacks']} "
            f"| {summary['cpu_s']:.0f} |"
        )


def draw(out):
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "wythe"
    from matplotlib import pyplot

    to = ROOT / "docs/validation"
    to.mkdir(parents=True, exist_ok=True)
    for file, (title, names) in FIGURES.items():
        names = [name for name in names if (out / name / "summary.json").exists()]
        if len(names) < 2:
            continue
        figure, axes = pyplot.subplots(figsize=(6.4, 4))
        for name in names:
            axes.plot(*drive(out / name), label=f"{name}: {VARIANTS[name][2]}", linewidth=1.2)
        axes.set(xlabel="displacement of the top [mm]", ylabel="force [kN]", title=title)
        axes.set_xlim(left=0)
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8, loc="lower right")
        figure.tight_layout()
        figure.savefig(to / f"{file}.svg", metadata={"Date": None})
        pyplot.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="variants to run; all if none")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, default=ROOT / "target/validation")
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in VARIANTS]
    if unknown:
        parser.error(f"{unknown[0]} is none of {', '.join(VARIANTS)}")
    options.out.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(options.jobs) as pool:
        list(pool.map(lambda name: run(name, options.out), options.names or VARIANTS))
    table(VARIANTS, options.out)
    draw(options.out)


if __name__ == "__main__":
    main()
