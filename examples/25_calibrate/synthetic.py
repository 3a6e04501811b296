"""Makes the curves of this folder: examples 01 and 02 as they are, with scatter on each point.

    python examples/25_calibrate/synthetic.py

They are no measurements. What a calibration should find is known: the values of the decks.
"""

from pathlib import Path

import numpy as np
import wythe

HERE = Path(__file__).parent
NOISE, SEED = 0.03, 25


def write(name, deck, changes, displacements, random):
    history = wythe.Model.from_toml(HERE.parent / deck, changes).run(threads=1).history
    driven = history.driven
    x, y = (np.append(0.0, column[driven]) for column in (history.displacement_mm, history.force_kN))
    force = np.interp(displacements, x, y)
    force += NOISE * force.max() * random.standard_normal(force.size)
    of = "".join(f", {key} = {value}" for key, value in changes.items())
    lines = [
        f"# SYNTHETIC, no measurement: examples/{deck}{of},",
        f"# with normal scatter of {100 * NOISE:g} % of the peak on each point (numpy.random.default_rng({SEED})).",
        "displacement_mm,force_kN",
        *(f"{a:.5f},{b:.4f}" for a, b in zip(displacements, force)),
    ]
    (HERE / name).write_text("\n".join(lines) + "\n")


random = np.random.default_rng(SEED)
pulled = np.append(np.linspace(0.0006, 0.006, 10), np.linspace(0.01, 0.2, 25))
sheared = np.append(np.linspace(0.01, 0.1, 10), np.linspace(0.12, 0.56, 23))
for number in (1, 2):
    write(f"tension-{number}.csv", "01_couplet_tension.toml", {}, pulled, random)
for name, pressure in (("01", "0.1 MPa"), ("05", "0.5 MPa"), ("10", "1 MPa")):
    write(f"shear-{name}.csv", "02_couplet_shear.toml", {"steps.0.top_pressure": pressure}, sheared, random)
