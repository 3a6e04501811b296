"""How stiffly edges are held in the plane, from free to rigid: the runs, table and chart of edge-stiffness.md.

    python docs/validation/03-out-of-plane/edges.py                    # runs what target/edges lacks, writes all
    python docs/validation/03-out-of-plane/edges.py --wythe target/release/wythe

It needs Python 3.11 and matplotlib. All runs take some ten minutes of CPU.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
RUNS = ROOT / "target" / "edges"
PAGE = HERE / "edge-stiffness.md"
TABLE = HERE / "edge-stiffness.csv"
CHART = HERE / "edge-stiffness.svg"

EXAMPLE = ROOT / "examples" / "62_out_of_plane_wall.toml"
ELASTIC = HERE / "elastic_edges.toml"
FRICTION = HERE / "friction.toml"

#: Width of the strips of elastic_edges.toml [mm].
STRIP = 2.0
#: Stiffness of the edges [N/mm per mm of edge].
STIFFNESS = (1.0, 10.0, 30.0, 100.0, 1000.0, 10000.0)
#: Friction of the frame.
FRICTIONS = (0.2, 0.4, 0.58, 0.8, 1.2)
#: Cohesion of the joints [MPa]: the printed one, and one with which the wall carries the pressure of the test.
COHESIONS = (0.22, 0.66)
#: Pressure "slightly prior to failure" [kN/m²], from the paper.
TEST = 20.0
#: Deflection at which pressures are compared [mm]: that of the peak if edges are free.
AT = 0.7
COMMON = (
    "wall.mesh=coarse", "steps.1.control.displacement=2.5", "steps.1.increments.max=0.05", "output.every=1000000",
    "output.mcap=false",
)  # fmt: skip


def rigid() -> str:
    """Supports of three rigid edges; the foot is that of the example."""
    line = '{{on="wall.back",box=[[{}],[{}]],fixed=[{}]}}'
    all_three, across = '"x","y","z"', '"y"'
    lines = [
        line.format("0,53,0", "795,53,0", across),
        line.format("0,53,1186", "795,53,1186", all_three),
        line.format("0,53,0", "0,53,1186", all_three),
        line.format("795,53,0", "795,53,1186", all_three),
        '{on="wall.bottom",fixed=["x","z"]}',
    ]
    return f"supports=[{','.join(lines)}]"


@dataclass(frozen=True)
class Case:
    """A run: how its edges are held, and its cohesion."""

    edges: str
    value: float | None
    cohesion: float
    deck: Path
    sets: tuple[str, ...] = ()

    @property
    def folder(self) -> Path:
        value = "" if self.value is None else f"-{self.value:g}"
        return RUNS / f"{self.edges}{value}-c{self.cohesion:g}.out"

    def run(self, wythe: str) -> None:
        """Runs the deck, unless it was run."""
        if (self.folder / "summary.json").is_file():
            return
        sets = [*COMMON, f"interfaces.joint.c={self.cohesion:g}", *self.sets]
        changes = [word for change in sets for word in ("--set", change)]
        command = [wythe, "run", str(self.deck), "--quiet", "--threads", "1", "--out", str(self.folder), *changes]
        subprocess.run(command, check=True)


def cases() -> list[Case]:
    """All runs, from free to rigid."""
    found = []
    for c in COHESIONS:
        found.append(Case("free", None, c, EXAMPLE))
        for k in STIFFNESS:
            found.append(Case("elastic", k, c, ELASTIC, (f"interfaces.edge.shear_stiffness={k / STRIP:g}",)))
        found.append(Case("rigid", None, c, EXAMPLE, (rigid(),)))
    for mu in FRICTIONS:
        sets = (f"interfaces.edge.mu={mu:g}", f"interfaces.edge.tan_phi={mu:g}")
        found.append(Case("friction", mu, COHESIONS[0], FRICTION, sets))
    return found


@dataclass(frozen=True)
class Measured:
    """Figures of a run: pressures [kN/m²] and deflections of the middle [mm]."""

    case: Case
    largest: float
    at_largest: float
    rises: bool
    at: float
    at_test: float | None
    solves: int
    cpu_s: float


def between(points: list[tuple[float, float]], x: float) -> float | None:
    """Ordinate where the abscissa is first reached, linear between points."""
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        if x0 <= x <= x1 and x1 > x0:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return None


def measured(case: Case) -> Measured:
    """The figures of a run that is there."""
    with (case.folder / "history.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["step"] == "1"]
    curve = [(0.0, 0.0), *((float(r["middle_mm"]), 1000 * float(r["airbag_MPa"])) for r in rows)]
    at, largest = max(curve, key=lambda point: point[1])
    summary = json.loads((case.folder / "summary.json").read_text(encoding="utf-8"))
    if summary["status"] != "completed":
        raise SystemExit(f"{case.folder}: {summary['status']}")
    return Measured(
        case, largest, at, at == curve[-1][0], between(curve, AT) or float("nan"),
        between([(p, u) for u, p in curve], TEST), summary["iterations"], summary["cpu_s"],
    )  # fmt: skip


def said(value: float | None, digits: int = 1) -> str:
    return "" if value is None else f"{value:.{digits}f}"


def table(all_: list[Measured]) -> str:
    """The tables of the page."""
    head = (
        f"| largest to 2.5 mm | at, mm | at {AT:g} mm | deflection at {TEST:g} kN/m², mm | solves |\n"
        "|---|---|---|---|---|---|---|\n"
    )
    lines = ["| Edges, N/mm per mm | c, MPa " + head]
    names = {"free": "free", "rigid": "rigid"}
    for m in all_:
        if m.case.edges == "friction":
            continue
        name = names.get(m.case.edges) or f"{m.case.value:,g}".replace(",", ",")
        lines.append(row(name, m))
    lines.append("\n| Friction of the frame | c, MPa " + head)
    lines += [row(f"{m.case.value:g}", m) for m in all_ if m.case.edges == "friction"]
    return "".join(lines).rstrip("\n")


def row(name: str, m: Measured) -> str:
    largest = f"{m.largest:.1f}" + (", rises" if m.rises else "")
    return (
        f"| {name} | {m.case.cohesion:.2f} | {largest} | {m.at_largest:.2f} | {m.at:.1f} "
        f"| {said(m.at_test, 2)} | {m.solves} |\n"
    )


def write_table(all_: list[Measured]) -> None:
    with TABLE.open("w", encoding="utf-8", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow([
            "edges", "value", "cohesion_MPa", "largest_kPa", "at_mm", "rises_at_end", f"at_{AT:g}_mm_kPa",
            f"deflection_at_{TEST:g}_kPa_mm", "solves", "cpu_s",
        ])  # fmt: skip
        for m in all_:
            value = "" if m.case.value is None else f"{m.case.value:g}"
            out.writerow([
                m.case.edges, value, m.case.cohesion, f"{m.largest:.3f}", f"{m.at_largest:.4f}", int(m.rises),
                f"{m.at:.3f}", said(m.at_test, 4), m.solves, f"{m.cpu_s:.1f}",
            ])  # fmt: skip


def chart(all_: list[Measured]) -> None:
    """Largest pressure, and that at a deflection, over the stiffness of the edges."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "wythe", "font.size": 9, "svg.fonttype": "none"})
    figure, axes = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
    ends = {"free": STIFFNESS[0] / 10, "rigid": STIFFNESS[-1] * 10}
    for c, colour in zip(COHESIONS, ("#b03a2e", "#2e6da4")):
        some = [m for m in all_ if m.case.cohesion == c and m.case.edges != "friction"]
        x = [ends.get(m.case.edges, m.case.value) for m in some]
        axes.plot(x, [m.largest for m in some], "o-", color=colour, label=f"c = {c:.2f} MPa: largest to 2.5 mm")
        axes.plot(x, [m.at for m in some], "s--", color=colour, mfc="white", label=f"c = {c:.2f} MPa: at {AT:g} mm")
    axes.axhline(TEST, color="black", lw=1)
    axes.text(ends["rigid"], TEST * 1.02, "the test, slightly before failure", va="bottom", ha="right")
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = [ends["free"], *STIFFNESS, ends["rigid"]]
    axes.set_xticks(ticks, ["free", *(f"{k:,g}" for k in STIFFNESS), "rigid"])
    axes.set_yticks([10, 20, 50, 100], ["10", "20", "50", "100"])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.set_xlabel("stiffness of the edges in the plane [N/mm per mm of edge]")
    axes.set_ylabel("pressure [kN/m²]")
    axes.legend(loc="upper left", frameon=False)
    figure.savefig(CHART, metadata={"Date": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wythe", default="wythe", help="the command")
    arguments = parser.parse_args()
    all_ = []
    for case in cases():
        case.run(arguments.wythe)
        all_.append(measured(case))
        m = all_[-1]
        print(f"{case.folder.stem}: {m.largest:.2f} kN/m² at {m.at_largest:.2f} mm, {m.cpu_s:.0f} s", flush=True)
    write_table(all_)
    chart(all_)
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split("<!-- tables -->\n")
    _, after = rest.split("<!-- end of tables -->")
    PAGE.write_text(f"{before}<!-- tables -->\n\n{table(all_)}\n\n<!-- end of tables -->{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
