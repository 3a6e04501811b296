"""How often intervals of 95 % hold the true values: synthetic couplets with scatter, calibrated for many seeds.

    python crates/pybind/tests/calibration_coverage.py --seeds 40
    python crates/pybind/tests/calibration_coverage.py --seeds 40 --specimens 3 --between 0.1

prints a line for each parameter, and how many of its intervals hold the true value. ``--between`` makes whole
specimens stronger or weaker, with this deviation of the logarithm of their forces.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import wythe

TRUE = {"f_t": 0.28, "u_k": 0.20, "c": 0.87, "mu": 0.73}
# Standard deviation of a point, as a part of the peak.
NOISE = 0.03
COARSE = {"initial": 0.05, "max": 0.05, "peak": 1}
# Few increments and elements: what is fitted is made by the same deck.
TENSION = wythe.templates.couplet(mesh=[3, 2, 1]).with_(
    {"steps.0.increments": COARSE, "steps.1.increments": COARSE, "interfaces.joint.f_t": TRUE["f_t"]}
)
SHEAR = TENSION.with_(
    {
        "steps.0": {"kind": "preload", "top_pressure": 0.5},
        "steps.1": {
            "kind": "drive", "direction": "x", "displacement": 0.6, "vertical": "free", "increments": COARSE,
        },
    }
)  # fmt: skip
PARAMETERS = {
    "f_t": {"key": {"key": "interfaces.joint.f_t", "tests": ["tension"]}, "start": 0.22, "bounds": [0.05, 0.8]},
    "u_k": {"key": {"key": "interfaces.joint.u_k", "tests": ["tension"]}, "start": 0.25, "bounds": [0.05, 1.0]},
    "c": {"key": {"key": "interfaces.joint.c", "tests": ["shear"]}, "start": 0.7, "bounds": [0.3, 2.0]},
    "mu": {"key": {"key": "interfaces.joint.mu", "tests": ["shear"]}, "start": 0.65, "bounds": [0.3, 1.0]},
}
FORWARD = {"differences": "forward", "tolerance": 1e-3}


def exact(model: wythe.Model, x: Any) -> Any:
    """Forces of a deck at displacements [kN]."""
    history = model.run(threads=1).history
    driven = history.driven
    return np.interp(x, np.append(0.0, history.displacement_mm[driven]), np.append(0.0, history.force_kN[driven]))


def scattered(x: Any, force: Any, random: np.random.Generator) -> Any:
    """A measured curve. Shape (points, 2)."""
    return np.stack([x, force + NOISE * force.max() * random.standard_normal(x.size)], axis=1)


def held(seeds: int, specimens: int = 1, between: float = 0.0) -> dict[str, int]:
    """How many intervals of each parameter hold its true value."""

    def curves(x: Any, force: Any, random: np.random.Generator) -> list[Any]:
        # Without a deviation between specimens no number is drawn for it.
        factors = [np.exp(between * random.standard_normal()) if between else 1.0 for _ in range(specimens)]
        return [scattered(x, factor * force, random) for factor in factors]

    pulled = np.append(np.linspace(0.0008, 0.006, 10), np.linspace(0.01, 0.2, 25))
    sheared = np.append(np.linspace(0.01, 0.09, 10), np.linspace(0.12, 0.58, 25))
    forces = exact(TENSION, pulled), exact(SHEAR, sheared)
    counts = dict.fromkeys(TRUE, 0)
    with ThreadPoolExecutor(2) as threads:
        for seed in range(seeds):
            random = np.random.default_rng(seed)
            found = wythe.calibrate(
                tests=[
                    {"name": "tension", "deck": TENSION, "curves": curves(pulled, forces[0], random)},
                    {"name": "shear", "deck": SHEAR, "curves": curves(sheared, forces[1], random)},
                ],
                parameters=PARAMETERS,
                fit=FORWARD,
                executor=threads,
                progress=False,
            )
            for name, (low, high) in found.intervals.items():
                counts[name] += low <= TRUE[name] <= high
    return counts


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--specimens", type=int, default=1)
    parser.add_argument("--between", type=float, default=0.0)
    asked = parser.parse_args()
    for name, count in held(asked.seeds, asked.specimens, asked.between).items():
        print(f"{name:4} {count} of {asked.seeds}")
