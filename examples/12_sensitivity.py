#      | | | | | | | |  2.12 MPa            what moves the peak
#      v v v v v v v v                                  -1      0      +1
#    ┌─────────────────┐                     friction           ├─────>
#    │░░░░░░░░░░░░░░░░░│──> x, 4 mm          crushing           ├───>
#    ├──┬────┬────┬────┤                     cohesion           ├─>
#    ├──┴─┬──┴─┬──┴─┬──┤  every property     stiffness         <┤
#    ├──┬─┴──┬─┴──┬─┴──┤  ± 10 %, at once    bond in tension    │
#    │░░░░░░░░░░░░░░░░░│
#    └─────────────────┘
#
# A wall under much pressure fails by sliding joints, by splitting and by crushing; which property counts most is
# asked by changing all of them at once, evenly over their ranges, and ranking what the peak goes with.
#
#     python examples/12_sensitivity.py --samples 80
#
# Factors rather than values: a table of a material is scaled as a whole, which no single key of the deck says,
# so that a function makes the model of a sample.

import argparse
import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import wythe

HERE = Path(__file__).parent

# What is changed, and what it scales: keys of the deck, of tables their stresses.
FACTORS = {
    "joint f_t": ("interfaces.joint.f_t",),
    "joint c": ("interfaces.joint.c",),
    "joint tan_phi": ("interfaces.joint.tan_phi",),
    "joint mu": ("interfaces.joint.mu",),
    "brick E": ("materials.brick.E",),
    "mortar E": ("materials.mortar.E",),
    "brick tension": ("materials.brick.tension",),
    "compression": ("materials.brick.compression", "materials.mortar.compression"),
}


def wall(base: wythe.Model, sample: Mapping[str, Any]) -> wythe.Model:
    """The wall with its properties scaled as a sample says."""
    deck = base.to_dict()
    changes: dict[str, Any] = {}
    for name, factor in sample.items():
        for key in FACTORS[name]:
            value: Any = deck
            for part in key.split("."):
                value = value[part]
            if isinstance(value, list):
                changes[key] = [[stress * factor, *others] for stress, *others in value]
            else:
                changes[key] = value * factor
    return base.with_(changes)


def main() -> None:
    arguments = argparse.ArgumentParser(description="Which property moves the wall's peak.")
    arguments.add_argument("--samples", type=int, default=80)
    arguments.add_argument("--range", type=float, default=0.1, help="of every factor about 1")
    arguments.add_argument("--courses", type=int, default=18)
    arguments.add_argument("--drive", default="4 mm", help="how far the top is pushed")
    arguments.add_argument("--workers", type=int, help="processes; as many as cores if not said")
    arguments.add_argument("--out", type=Path, default=HERE / "12_sensitivity.out")
    said = arguments.parse_args()

    base = wythe.Model.from_toml(HERE / "03_shear_wall_j7d.toml").with_(
        {"wall.courses": said.courses, "steps.1.displacement": said.drive}
    )
    ranges = {name: (1.0 - said.range, 1.0 + said.range) for name in FACTORS}
    study = wythe.study(
        functools.partial(wall, base),
        samples=wythe.latin_hypercube(ranges, said.samples, seed=1),
        executor=said.workers,
        out=said.out,
    )
    print(study)
    for measure in ("peak_force_kN", "initial_stiffness_kN_per_mm"):
        print(f"\n{study.ranking(measure)}")
    print(f"\ntable: {said.out / 'study.csv'}")


# Each worker imports this file.
if __name__ == "__main__":
    main()
