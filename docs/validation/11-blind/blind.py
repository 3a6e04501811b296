"""The blind predictions: decks from walls.csv by rule.md, their runs, and the page.

    python docs/validation/11-blind/blind.py               # runs what target/blind lacks, writes results.csv and the page
    python docs/validation/11-blind/blind.py decks         # writes the decks into target/blind only
    python docs/validation/11-blind/blind.py drifts        # drifts.csv from the runs that there are, and the page
    python docs/validation/11-blind/blind.py page          # the page alone, from results.csv

It needs the package wythe and matplotlib. All runs take some tens of minutes on one core.
"""

from __future__ import annotations

import math
import sys

import numpy as np
import wythe

from decks import HERE, LABORATORY, deck, stem, walls
from runs import RUNS, VARIATIONS, VARIED, Row, drift_rows, read, run, table, vary, write



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
