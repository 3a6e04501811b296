"""Compares the errors that `wythe run --error` estimates with known ones: the table of docs/how-to/state-the-error.md.

    python docs/accuracy-speed/calibrate_error.py                   # runs what target/error lacks, writes the table
    python docs/accuracy-speed/calibrate_error.py --page            # the table alone, of the runs there are
    python docs/accuracy-speed/calibrate_error.py --wythe target/release/wythe --only couplet

Known errors are those against the references of docs/accuracy-speed, for the decks of its scenes, their default mesh
and others, and increments up to four times as long. It needs Python 3.11 and nothing else. All runs take some ten
minutes of CPU.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PAGE = ROOT / "docs" / "how-to" / "state-the-error.md"
RUNS = ROOT / "target" / "error"
BEGIN, END = "<!-- calibration -->", "<!-- end of calibration -->"
#: Twice the estimate is the bound that a user is promised.
BOUND = 2.0
VOLUME = tuple(f"materials.{name}.crack_band=volume" for name in ("brick", "mortar"))

Point = tuple[float, float]


@dataclass(frozen=True)
class Scene:
    """A scene of the study, and the variants that are run."""

    name: str
    folder: str
    mesh_key: str
    increments: tuple[float, float]
    #: Force of the history over the ordinate of the reference.
    factor: float = 1.0
    #: Displacement at the peak, where the reference is too coarse to tell it [mm].
    displacement: float | None = None
    #: Meshes beside the default.
    meshes: tuple[str, ...] = ()
    #: Other changes beside the default, by name.
    others: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def variants(self) -> dict[str, tuple[str, ...]]:
        """Changes of each variant."""
        initial, largest = self.increments
        steps = {
            f"increments × {by}": (
                f"steps.1.increments.initial={initial * by:g}",
                f"steps.1.increments.max={largest * by:g}",
            )
            for by in (2, 4)
        }
        meshes = {mesh: (f"{self.mesh_key}={mesh.replace(' ', '')}",) for mesh in self.meshes}
        return {"default": (), **meshes, **steps, **self.others}


#: A load of 1 MPa on the front of the wall [kN].
AIRBAG = 795 * 1186 / 1000
SCENES = (
    # The bond is rigid: its peak is at rest. The bricks move it by 0.2 µm.
    Scene("couplet", "01-couplet", "wall.mesh", (0.005, 0.0125), displacement=0.0002, meshes=("[3, 2, 1]",)),
    Scene(
        "small wall", "02-small-wall", "wall.mesh", (0.005, 0.0125),
        meshes=("[5, 2, 2]", "[4, 2, 2]", "[9, 4, 2]"), others={"volume": VOLUME},
    ),
    Scene(
        "J7D", "03-shear-wall-j7d", "wall.mesh", (0.005, 0.0125),
        meshes=("[4, 2, 2]", "[7, 3, 2]"), others={"volume": VOLUME},
    ),
    Scene(
        "J4D", "05-shear-wall-j4d", "wall.mesh", (0.005, 0.0125),
        meshes=("[4, 2, 2]", "[6, 3, 2]"), others={"volume": VOLUME},
    ),
    Scene("airbag", "04-out-of-plane", "wall.mesh", (0.0004, 0.05), factor=AIRBAG, meshes=("[5, 2, 2]",)),
    Scene("arch", "06-arch", "arch.mesh", (0.002, 0.02), meshes=("[2, 1, 2]",)),
)


def curve(path: Path, x: str, y: str, factor: float = 1.0) -> list[Point]:
    """Two columns of a CSV file."""
    with path.open(encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [(float(row[x]), factor * float(row[y])) for row in rows]


def area(points: list[Point], end: float) -> float:
    """Area under a curve up to an abscissa [J]."""
    total = 0.0
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x0 >= end or x1 <= x0:
            continue
        if x1 > end:
            y1, x1 = y0 + (y1 - y0) * (end - x0) / (x1 - x0), end
        total += 0.5 * (y0 + y1) * (x1 - x0)
    return total


def known(scene: Scene, said: dict) -> list[float]:
    """Peak [kN], area [J], displacement at the peak [mm] of the reference."""
    reference = said["reference"]
    factor = scene.factor * reference.get("y_factor", 1.0)
    x, y = (reference.get(axis, said[axis]) for axis in "xy")
    points = curve(HERE / scene.folder / reference["file"], x, y, factor)
    force, at = max((force, at) for at, force in points if at <= said["to"])
    peak = reference.get("peak", force)
    at = at if scene.displacement is None else scene.displacement
    return [peak, area(points, said["to"]), at]


def estimate(out: Path) -> dict | None:
    """Estimate of the error of a run; none if it, or a companion, was interrupted."""
    summary = out / "summary.json"
    if not summary.is_file():
        return None
    estimated = json.loads(summary.read_text(encoding="utf-8")).get("error_estimate")
    stopped = estimated is None or any("interrupted" in lacking["why"] for lacking in estimated["not_estimated"])
    return None if stopped else estimated


def run(wythe: str, deck: Path, sets: list[str], out: Path) -> None:
    """Runs a deck with the estimate of its error."""
    changes = [word for change in sets for word in ("--set", change)]
    command = [wythe, "run", str(deck), "--error", "--quiet", "--threads", "1", "--out", str(out)]
    subprocess.run([*command, "--set", "output.every=1000000", "--set", "output.mcap=false", *changes], check=True)


@dataclass(frozen=True)
class Case:
    """A figure of a run: its known error and its estimate, in the unit of the figure."""

    scene: str
    variant: str
    figure: str
    unit: str
    value: float
    error: float
    estimate: float
    mostly: str

    @property
    def ratio(self) -> float:
        return abs(self.error) / self.estimate

    @property
    def holds(self) -> bool:
        return self.ratio <= BOUND

    def row(self) -> str:
        said = f"{self.error:+.3g} {self.unit}"
        estimate = f"{self.estimate:.3g}"
        percent = f"{100 * self.error / self.value:+.1f}, {100 * self.estimate / self.value:.1f}"
        ratio = f"{self.ratio:.2f}" if self.holds else f"**{self.ratio:.2f}**"
        return (
            f"| {self.scene} | {self.variant} | {self.figure} | {said} | {estimate} | {percent} | {ratio} "
            f"| {self.mostly.replace('_', ' ')} |"
        )


def cases_of(scene: Scene, variant: str, said: dict, out: Path) -> list[Case]:
    """The three figures of a run; none if it has no estimate."""
    estimated = estimate(out)
    if estimated is None:
        return []
    peak, energy, at = known(scene, said)
    with (out / "history.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    driven = [row for row in rows if row["step"] == "1"]
    before = [row for row in rows if row["step"] == "0"][-1:]
    points = [(float(row["displacement_mm"]), float(row["force_kN"])) for row in [*before, *driven]]
    own = area(points, said["to"])
    found = []
    for figure, key, unit, value, right in (
        ("peak", "peak_force_kN", "kN", None, peak),
        ("area", "area_J", "J", own, energy),
        ("displacement", "displacement_at_peak_mm", "mm", None, at),
    ):
        of = estimated[key]
        if of is None:
            continue
        value = of["value"] if value is None else value
        found.append(
            Case(scene.name, variant, figure, unit, value, value - right, of["error"], of["mostly"])
        )
    return found


def median(values: list[float]) -> float:
    ordered = sorted(values)
    middle = len(ordered) // 2
    return ordered[middle] if len(ordered) % 2 else 0.5 * (ordered[middle - 1] + ordered[middle])


def text(cases: list[Case]) -> str:
    """The counts and the table."""
    lines = ["| Figure | Cases | Within the estimate | Within twice the estimate | Median of error over estimate |",
             "|---|---|---|---|---|"]
    figures = ["peak", "area", "displacement"]
    for name, some in [*((f, [c for c in cases if c.figure == f]) for f in figures), ("all", cases)]:
        if not some:
            continue
        within = [sum(c.ratio <= bound for c in some) for bound in (1.0, BOUND)]
        counts = " | ".join(f"{n} ({100 * n / len(some):.0f} %)" for n in within)
        lines.append(f"| {name} | {len(some)} | {counts} | {median([c.ratio for c in some]):.2f} |")
    lines += ["", "| Scene | Variant | Figure | Known error | Estimate | Both, % of the figure | Ratio | Mostly |",
              "|---|---|---|---|---|---|---|---|", *(case.row() for case in cases)]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wythe", default="wythe", help="the command")
    parser.add_argument("--only", nargs="*", help="names of scenes")
    parser.add_argument("--page", action="store_true", help="write the table of the runs there are")
    arguments = parser.parse_args()
    cases = []
    for scene in SCENES:
        said = tomllib.loads((HERE / scene.folder / "scene.toml").read_text(encoding="utf-8"))
        deck = (HERE / scene.folder / said["deck"]).resolve()
        for number, (variant, changes) in enumerate(scene.variants().items()):
            out = RUNS / f"{scene.folder}-{number}.out"
            chosen = arguments.only is None or scene.name in arguments.only
            if chosen and not arguments.page and estimate(out) is None:
                run(arguments.wythe, deck, [*said.get("set", []), *changes], out)
            cases += cases_of(scene, variant, said, out)
            print(f"{scene.name}, {variant}", flush=True)
    table = text(cases)
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(BEGIN)
    _, after = rest.split(END)
    PAGE.write_text(f"{before}{BEGIN}\n\n{table}\n\n{END}{after}", encoding="utf-8")
    print(table.split("\n\n")[0])


if __name__ == "__main__":
    main()
