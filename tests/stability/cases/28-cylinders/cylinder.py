"""Nodes of the two bodies of this case: segments of cylinders, fine where they touch.

    python3 cylinder.py

writes upper.csv and lower.csv. A segment is 160 mm wide, 80 mm high and 10 mm deep; its arc of 200 mm
radius touches z = 0 at x = 0. Elements grow away from there.
"""

from math import sqrt

RADIUS, HALF_WIDTH, HEIGHT, DEPTH = 200.0, 80.0, 80.0, 10.0  # [mm]


def spacing(size: float, uniform: float, end: float) -> list[float]:
    """From 0 to `end` [mm]: elements of `size` up to `uniform`, then 12 that grow by equal ratios."""
    marks = [size * i for i in range(round(uniform / size) + 1)]
    low, high = 1.0, 3.0
    for _ in range(60):
        ratio = 0.5 * (low + high)
        length = sum(size * ratio**i for i in range(1, 13))
        low, high = (ratio, high) if length < end - marks[-1] else (low, ratio)
    for i in range(1, 13):
        marks.append(marks[-1] + size * ratio**i)
    return marks[:-1] + [end]


def write(name: str, size: float, upwards: bool) -> None:
    """A segment with elements of `size` [mm] at the contact, above the other or below."""
    half = spacing(size, 6.0, HALF_WIDTH)
    x = [-m for m in reversed(half[1:])] + half
    parts = [m / HEIGHT for m in spacing(size, size, HEIGHT)]
    layers = parts if upwards else parts[::-1]
    with open(name, "w", encoding="utf-8") as file:
        file.write("# made by cylinder.py\nx,y,z\n")
        for part in layers:
            for y in (0.0, DEPTH):
                for along in x:
                    arc = RADIUS - sqrt(RADIUS**2 - along**2)
                    z = arc + part * (HEIGHT - arc)
                    file.write(f"{along:.7g},{y:.7g},{z if upwards else -z:.7g}\n")
    print(f"{name}: mesh = [{len(x) - 1}, 1, {len(layers) - 1}]")


write("upper.csv", 0.25, upwards=True)
write("lower.csv", 0.3, upwards=False)
