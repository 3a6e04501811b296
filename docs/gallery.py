"""Makes docs/gallery.md and its pictures: all decks of examples/, run and drawn.

    python docs/gallery.py              # runs what target/gallery lacks, draws all, writes the page
    python docs/gallery.py 03 62        # draws these only
    python docs/gallery.py --page       # the page alone, from the table of examples/README.md

It needs the package wythe and nothing else. All runs take a few minutes.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import wythe

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "gallery"
RUNS = ROOT / "target" / "gallery"
COLUMNS = 3
WIDTH = 420  # pixels of a picture

#: Walls that fail in their plane are drawn as elevations with their failed joints, loops as curves, others in space.
ELEVATIONS = ("03", "04", "42", "60", "61", "63", "82", "83", "92")
CURVES = ("41", "79", "80")
#: Part of the run at which the picture is taken, where the end shows less.
MOMENTS = {"30": 0.8, "89": 0.8, "90": 0.85}
#: The camera: degrees about z from the front, and above the horizon.
TURN, RISE = 28.0, 18.0
#: Faces of an element, seen from outside.
FACES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
PALETTE = ((214, 158, 128), (222, 218, 206), (188, 182, 148), (160, 176, 190), (196, 170, 200))


def results(deck: Path) -> wythe.Results:
    folder = RUNS / f"{deck.stem}.out"
    if not (folder / "summary.json").is_file():
        wythe.Model.from_toml(deck).run(folder)
    return wythe.Results(folder)


def rounded(factor: float) -> float:
    """The next of 1, 2, 5, 10, … below a factor; 1 at least."""
    power = 10.0 ** np.floor(np.log10(max(factor, 1.0)))
    return float(max(1.0, max(power * k for k in (1, 2, 5) if power * k <= max(factor, 1.0))))


def boundary(elements: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Faces that one element only has: their nodes, and their elements."""
    faces = elements[:, FACES].reshape(-1, 4)
    owners = np.repeat(np.arange(len(elements)), 6)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    outer = np.sort(first[count == 1])
    return faces[outer], owners[outer]


def parts_of(quad: np.ndarray, length: float) -> list[tuple[np.ndarray, list[bool]]]:
    """A quadrilateral cut into parts no longer than `length`; which of their edges are within it."""
    along = [np.linalg.norm(quad[1] - quad[0]), np.linalg.norm(quad[2] - quad[1])]
    n, m = (max(1, int(np.ceil(edge / length))) for edge in along)

    def point(i: int, j: int) -> np.ndarray:
        r, s = i / n, j / m
        return np.asarray((1 - s) * ((1 - r) * quad[0] + r * quad[1]) + s * ((1 - r) * quad[3] + r * quad[2]))

    return [
        (
            np.array([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]),
            [j > 0, i < n - 1, j < m - 1, i > 0],
        )
        for i in range(n)
        for j in range(m)
    ]


def in_space(run: wythe.Results, moment: float) -> str:
    """The deformed solids, seen from the front, the right and above, as SVG."""
    frame = run.frame(round(moment * (run.frames - 1)))
    size = float(np.ptp(run.nodes, axis=0).max())
    largest = float(np.abs(frame.displacement).max())
    scale = rounded(0.06 * size / largest) if largest > 0 else 1.0
    nodes = run.nodes + scale * frame.displacement
    turn, rise = np.radians(TURN), np.radians(RISE)
    right = np.array([np.cos(turn), np.sin(turn), 0.0])
    towards = np.array([np.sin(turn) * np.cos(rise), -np.cos(turn) * np.cos(rise), np.sin(rise)])
    up = np.cross(towards, right)
    flat = nodes @ np.stack([right, up, towards], axis=1)

    faces, owners = boundary(run.elements)
    corners = nodes[faces]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    edges: dict[tuple[int, int], list[int]] = {}
    for face, of in enumerate(faces):
        for k in range(4):
            a, b = int(of[k]), int(of[(k + 1) % 4])
            edges.setdefault((min(a, b), max(a, b)), []).append(face)

    def is_drawn(edge: tuple[int, int]) -> bool:
        sides = edges[edge]
        if len(sides) != 2:
            return True
        one, other = sides
        bent = normals[one] @ normals[other] < 0.9
        return bool(bent or run.material[owners[one]] != run.material[owners[other]])

    shown = flat[:, :2]
    if scale == 1.0:  # What fell is small beside its ground: only what moved, and a margin, is shown.
        way = np.abs(frame.displacement).max(axis=1)
        shown = shown[way > 0.02 * largest]
    low, high = shown.min(axis=0), shown.max(axis=0)
    if scale == 1.0:
        low, high = np.maximum(low - 0.2 * (high - low), flat[:, :2].min(axis=0)), high + 0.05 * (high - low)
        high = np.minimum(high, flat[:, :2].max(axis=0))
    unit = min((WIDTH - 20) / (high[0] - low[0]), 300 / (high[1] - low[1]))
    height = unit * (high[1] - low[1]) + 20
    left = (WIDTH - unit * (high[0] - low[0])) / 2
    longest, margin = float((high - low).max()) / 25, max(left, 30.0) / unit

    def at(point: np.ndarray) -> str:
        return f"{left + unit * (point[0] - low[0]):.1f},{height - 10 - unit * (point[1] - low[1]):.1f}"

    light = np.array([0.25, -0.75, 0.6]) / np.linalg.norm([0.25, -0.75, 0.6])
    damage = np.maximum(frame.tensile_damage, frame.compressive_damage)
    pieces: list[tuple[float, str]] = []
    for face in map(int, np.flatnonzero(normals @ towards > 1e-6)):
        shade = 0.62 + 0.38 * max(0.0, float(normals[face] @ light))
        whole = np.array(PALETTE[int(run.material[owners[face]]) % len(PALETTE)])
        torn = float(damage[owners[face]])
        r, g, b = (shade * ((1 - torn) * whole + torn * np.array([40, 20, 30]))).astype(int)
        fill = f"#{r:02x}{g:02x}{b:02x}"
        of = [int(node) for node in faces[face]]
        drawn = [is_drawn((min(of[k], of[k - 3]), max(of[k], of[k - 3]))) for k in range(4)]
        # Large faces in parts, so that the farthest comes first everywhere.
        for quad, inner in parts_of(flat[of], longest):
            if (quad[:, :2] < low - margin).all(axis=0).any() or (quad[:, :2] > high + margin).all(axis=0).any():
                continue
            points = " ".join(map(at, quad))
            part = f'<polygon points="{points}" fill="{fill}" stroke="{fill}" stroke-width="0.9"/>'
            for k in range(4):
                if drawn[k] and not inner[k]:
                    part += f'<path d="M{at(quad[k])}L{at(quad[k - 3])}" stroke="#4a3a32" stroke-width="0.6"/>'
            pieces.append((float(quad[:, 2].mean()), part))
    pieces.sort(key=lambda piece: piece[0])
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height + 22:.0f}" '
        f'viewBox="0 0 {WIDTH} {height + 22:.0f}"><rect width="100%" height="100%" fill="#fff"/>',
        *(part for _, part in pieces),
        f'<rect y="{height:.0f}" width="100%" height="22" fill="#fff"/>',
    ]
    told = f"displacements × {scale:g}" if scale != 1 else "displacements as they are"
    parts.append(
        f'<text x="{WIDTH - 8}" y="{height + 14:.0f}" text-anchor="end" font-family="DejaVu Sans" font-size="11" '
        f'fill="#333">{told}</text></svg>'
    )
    return "\n".join(parts)


def width(svg: str) -> float:
    found = re.search(r'<svg[^>]*? width="([\d.]+)', svg)
    assert found is not None
    return float(found[1])


def draw(deck: Path) -> None:
    run = results(deck)
    number = deck.stem[:2]
    if number in ELEVATIONS:
        svg = run.picture("cracks").svg
    elif number in CURVES:
        svg = run.picture("curves").svg
    else:
        svg = in_space(run, MOMENTS.get(number, 1.0))
    PICTURES.mkdir(exist_ok=True)
    wythe.Picture(svg).save(PICTURES / f"{deck.stem}.png", zoom=WIDTH / width(svg))


def page() -> str:
    """Rows of three pictures and the texts of the examples below them."""
    table = (ROOT / "examples" / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| \[(\d\d)\]\((\w+)\.toml\) \| (.*?) \| (.*?) \| (.*?) \|$", table, re.M)
    lines = [
        "# Gallery",
        "",
        "Made by `python docs/gallery.py` from the decks of `examples/` and the table of their README. Walls that",
        "fail in their plane are elevations: red joints are open, orange ones slide, dark bricks are cracked. All",
        "others are views of the deformed solids, darker where they are damaged. Run one with",
        "`wythe run examples/NAME.toml`.",
        "",
    ]
    for start in range(0, len(rows), COLUMNS):
        part = rows[start : start + COLUMNS]
        part += [("", "", "", "", "")] * (COLUMNS - len(part))
        pictures, texts = [], []
        for _, name, scene, shows, takes in part:
            pictures.append(f"![{scene}](gallery/{name}.png)" if name else "")
            texts.append(f"**{scene}**<br>{shows}<br>`{name}`, {takes}" if name else "")
        lines += [f"| {' | '.join(pictures)} |", "|---|---|---|", f"| {' | '.join(texts)} |", ""]
    return "\n".join(lines)


def main(arguments: list[str]) -> None:
    decks = sorted((ROOT / "examples").glob("[0-9][0-9]_*.toml"))
    if "--page" not in arguments:
        for deck in decks:
            if not arguments or deck.stem[:2] in arguments:
                draw(deck)
                print(deck.stem)
    (ROOT / "docs" / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
