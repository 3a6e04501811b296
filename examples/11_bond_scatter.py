#      | | | | | | | |  2.12 MPa                      walls
#      v v v v v v v v                                  │        ▂█▅
#    ┌─────────────────┐                                │      ▃▆███▇▂
#    │░░░░░░░░░░░░░░░░░│──> x, 4 mm                     │    ▂▇███████▅▂
#    ├──┬─0.7┬────┬1.3─┤  each unit's bond has a        └──────────────────── peak force
#    ├──┴─┬──┴1.1─┬──┴─┤  factor of its own          200 walls, 200 draws
#    ├0.9─┴─1.0┴──┬─┴──┤
#    │░░░░░░░░░░░░░░░░░│
#    └─────────────────┘
#
# No two bricks are laid alike, and weak joints lie beside strong ones: the load goes round the weak ones, and
# under compression friction carries much of it, so the peak of the wall J7D scatters far less than its bond.
#
#     python examples/11_bond_scatter.py --samples 200 --cv 0.3
#
# Stopped by Ctrl-C or killed, it goes on where it was when it is called again. `pip install 'wythe[study]'` has
# Dask, which runs the walls; on a cluster the same call takes its client: executor=Client("scheduler:8786").

import argparse
import math
from pathlib import Path
from statistics import NormalDist

import numpy as np
import wythe

HERE = Path(__file__).parent


def main() -> None:
    arguments = argparse.ArgumentParser(description="Scatter of bond, and of the wall's peak.")
    arguments.add_argument("--samples", type=int, default=200)
    arguments.add_argument("--cv", type=float, default=0.3, help="of f_t and c from unit to unit")
    arguments.add_argument("--courses", type=int, default=18)
    arguments.add_argument("--drive", default="4 mm", help="how far the top is pushed")
    arguments.add_argument("--workers", type=int, help="processes; as many as cores if not said")
    arguments.add_argument("--out", type=Path, default=HERE / "11_bond_scatter.out")
    said = arguments.parse_args()

    wall = wythe.Model.from_toml(HERE / "03_shear_wall_j7d.toml").with_(
        {
            "wall.courses": said.courses,
            "steps.1.displacement": said.drive,
            "interfaces.joint.scatter": {"cv": said.cv, "seed": 0},
        }
    )
    study = wythe.study(
        wall,
        {"interfaces.joint.scatter.seed": range(said.samples)},
        executor=said.workers,
        out=said.out,
    )
    print(study)

    peaks = study["peak_force_kN"]
    peaks = np.sort(peaks[np.isfinite(peaks)])
    mean, deviation = float(np.mean(peaks)), float(np.std(peaks, ddof=1))
    print(f"\npeak of {peaks.size} walls: mean {mean:.2f} kN, cv {100 * deviation / mean:.2f} %")
    for part in (0.05, 0.25, 0.5, 0.75, 0.95):
        print(f"  {100 * part:3.0f} % are below {np.quantile(peaks, part):.2f} kN")

    # Kolmogorov's distance: the largest between the parts of walls below a force, drawn and fitted. Fitted
    # to the same walls, one in twenty is above 0.886/√n where the distribution is right (Lilliefors 1967).
    print(f"fits (distance; {0.886 / math.sqrt(peaks.size):.3f} would be chance):")
    logarithms = np.log(peaks)
    center, width = float(np.mean(logarithms)), float(np.std(logarithms, ddof=1))
    normal, lognormal = NormalDist(mean, deviation), NormalDist(center, width)
    print(f"  normal     5 % below {normal.inv_cdf(0.05):.2f} kN ({distance(normal, peaks):.3f})")
    print(
        f"  lognormal  5 % below {math.exp(lognormal.inv_cdf(0.05)):.2f} kN "
        f"({distance(lognormal, logarithms):.3f})"
    )
    print(f"table: {said.out / 'study.csv'}")
    draw(peaks, lognormal, said.out / "peaks.png")


def distance(fitted: NormalDist, drawn: np.ndarray) -> float:
    """Kolmogorov's, of sorted draws."""
    below = np.array([fitted.cdf(float(value)) for value in drawn])
    steps = np.arange(drawn.size + 1) / drawn.size
    return float(max(np.max(steps[1:] - below), np.max(below - steps[:-1])))


def draw(peaks: np.ndarray, fitted: NormalDist, path: Path) -> None:
    """The histogram with the lognormal fit, where matplotlib is installed."""
    try:
        import matplotlib
    except ImportError:
        print("no picture: pip install 'wythe[plot]'")
        return
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(5.0, 3.2), layout="constrained")
    axes.hist(peaks, bins="auto", density=True, color="0.8", edgecolor="0.4")
    force = np.linspace(peaks[0], peaks[-1], 200)
    axes.plot(force, [fitted.pdf(math.log(value)) / value for value in force], color="C3")
    axes.set_xlabel("peak force [kN]")
    axes.set_ylabel("density [1/kN]")
    figure.savefig(path, dpi=150)
    print(f"picture: {path}")


# Each worker imports this file.
if __name__ == "__main__":
    main()
