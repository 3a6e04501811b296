"""Draws the sketches of the theory pages of the solids: python docs/theory/figures/solids.py.

Plain Python, no packages. Every curve is computed from the equations of the pages with the numbers of the paper's
Table 3 (D'Altri et al. 2018); the files beside this one are overwritten.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

Point = tuple[float, float]
Map = Callable[[float, float], Point]

TENSION, COMPRESSION, INK, GREY, PALE = "#1f5fa8", "#b5382a", "#222", "#777", "#e9eef5"


class Sketch:
    """An SVG of lines and labels. Labels know subscripts: ``σ_{t0}``."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self.size, self.title, self.parts = (width, height), title, list[str]()

    def line(
        self,
        points: Iterable[Point],
        colour: str = INK,
        width: float = 1.5,
        dash: str = "",
        arrow: str = "",
        fill: str = "none",
    ) -> None:
        """A polyline; ``arrow`` is any of ``start`` and ``end``; a filled one is closed."""
        path = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)
        more = f' stroke-dasharray="{dash}"' if dash else ""
        more += "".join(f' marker-{where}="url(#a)"' for where in arrow.split())
        close = "" if fill == "none" else "Z"
        self.parts.append(f'<path d="{path}{close}" fill="{fill}" stroke="{colour}" stroke-width="{width}"{more}/>')

    def dot(self, at: Point, colour: str = INK, radius: float = 3.0) -> None:
        """A filled circle."""
        x, y = at
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}"/>')

    def ring(self, at: Point, radius: float, dash: str = "") -> None:
        """An open circle."""
        x, y = at
        self.parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="none" stroke="{GREY}" '
            f'stroke-dasharray="{dash}"/>'
        )

    def text(self, x: float, y: float, label: str, anchor: str = "middle", colour: str = INK, size: int = 13) -> None:
        """A label with its base line at y."""
        spans, drop = "", 0
        for k, piece in enumerate(re.split(r"_\{(.*?)\}", label)):
            low = k % 2
            if not piece:
                continue
            shift, drop = 4 * low - drop, 4 * low
            of = f' dy="{shift}"' if shift else ""
            of += f' font-size="{size - 3}"' if low else ""
            spans += f"<tspan{of}>{piece}</tspan>" if of else piece
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{colour}">{spans}</text>'
        )

    def axes(self, at: Map, x: Point, y: Point, names: Sequence[str], origin: Point = (0.0, 0.0)) -> None:
        """Two axes with arrows through an origin, named at their ends."""
        (left, _), (right, low) = at(x[0], origin[1]), at(x[1], origin[1])
        (middle, bottom), (_, top) = at(origin[0], y[0]), at(origin[0], y[1])
        self.line([(left, low), (right, low)], GREY, 1, arrow="end")
        self.line([(middle, bottom), (middle, top)], GREY, 1, arrow="end")
        self.text(right + 8, low + 4, names[0], "start")
        self.text(middle, top - 8, names[1])

    def measure(self, a: Point, b: Point, label: str, off: Point) -> None:
        """A line with arrows at both ends, and its label beside the middle."""
        self.line([a, b], GREY, 1, arrow="start end")
        self.text((a[0] + b[0]) / 2 + off[0], (a[1] + b[1]) / 2 + off[1], label)

    def save(self, name: str) -> None:
        """Writes the file beside this one."""
        width, height = self.size
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}" font-family="sans-serif">\n<title>{self.title}</title>\n'
            '<defs><marker id="a" markerWidth="9" markerHeight="8" refX="8" refY="4" orient="auto-start-reverse" '
            f'markerUnits="userSpaceOnUse"><path d="M0 0.5L9 4L0 7.5Z" fill="{GREY}"/></marker></defs>\n'
            f'<rect width="{width}" height="{height}" fill="white"/>\n'
        )
        text = head + "\n".join(self.parts) + "\n</svg>\n"
        Path(__file__).with_name(f"{name}.svg").write_text(text, encoding="utf-8")


def frame(origin: Point, scale: Point) -> Map:
    """From numbers to pixels, y upwards."""
    return lambda x, y: (origin[0] + scale[0] * x, origin[1] - scale[1] * y)


Row = tuple[float, float, float]
Node = tuple[float, float, float, float]
# Mortar of the out-of-plane walls: stress [MPa], inelastic strain, damage.
E = 2300.0
MORTAR: dict[str, list[Row]] = {
    "t": [(1.5, 0.0, 0.0), (0.1, 0.002, 0.95)],
    "c": [(7.8, 0.0, 0.0), (8.2, 0.002, 0.0), (0.4, 0.015, 0.95)],
}


def nodes(rows: Sequence[Row]) -> list[Node]:
    """Strain, stress, effective stress, κ at the rows (damage-plasticity.md, eq. 9)."""
    found = []
    for stress, inelastic, damage in rows:
        effective = stress / (1 - damage)
        kappa = inelastic - damage / (1 - damage) * stress / E
        found.append((inelastic + stress / E, stress, effective, kappa))
    return found


def between(a: Node, b: Node, part: float) -> Node:
    """A state on the segment from one node to the next, all four linear in κ."""
    mixed = [p + part * (q - p) for p, q in zip(a, b, strict=True)]
    return mixed[0], mixed[1], mixed[2], mixed[3]


def uniaxial() -> None:
    """Uniaxial curves, with what a table's row and the plastic strain are."""
    s = Sketch(760, 330, "Uniaxial tension and compression: table, damage and plastic strain")
    for branch, x0, scale, end, colour, title in (
        ("t", 60, (115e3, 95.0), 0.00255, TENSION, "tension"),
        ("c", 440, (15e3, 22.0), 0.0195, COMPRESSION, "compression"),
    ):
        at = frame((x0, 280), scale)
        curve = nodes(MORTAR[branch])
        top = 235 / scale[1]
        s.axes(at, (0, end), (0, top), ("ε", f"σ_{{{branch}}} [MPa]"))
        strain, stress, effective, kappa = between(curve[-2], curve[-1], 0.5)
        line = [at(0, 0), *(at(e, y) for e, y, _, _ in curve), at(end * 0.97, curve[-1][1])]
        # Effective stress over the same strain.
        s.line([at(e, y) for e, _, y, _ in curve], GREY, 1.5, "6 4")
        s.line([at(kappa, 0), at(strain, effective)], GREY, 1, "2 3")
        s.line([at(strain - stress / E, 0), at(strain, stress)], GREY, 1, "2 3")
        s.line([at(strain, stress), at(kappa, 0)], colour, 1.5)
        s.line(line, colour, 2.5)
        s.dot(at(strain, stress), colour)
        s.dot(at(strain, effective), GREY)
        x, y = at(*curve[0][:2])
        s.text(x - 6, y - 6, f"σ_{{{branch}0}}", "end")
        s.text(*at(0.4 * curve[0][0], 0.62 * curve[0][1]), "E", "end")
        x, y = at(strain, effective)
        s.text(x - 2, y - 13, f"σ̄_{{{branch}}}", "start", GREY)
        s.text(*at(strain + 0.02 * end, stress + 0.02 * top), f"(σ_{{{branch}}}, ε_{{in}}, d)", "start", colour)
        x, y = at(strain - 0.65 * stress / E, 0.35 * stress)
        s.line([at(kappa + 0.35 * (strain - kappa), 0.35 * stress), (x + 6, y)], colour, 0.8)
        s.text(x + 9, y + 4, "(1−d) E", "start", colour)
        for e, label, side in ((kappa, "ε_{pl}", "end"), (strain - stress / E, "ε_{in}", "start")):
            x, y = at(e, 0)
            s.line([(x, y - 4), (x, y + 4)])
            s.text(x + (-3 if side == "end" else 3), y + 19, label, side)
        s.text(at(0.5 * end, 0)[0], 320, title, colour=colour)
    s.save("uniaxial")


def yield_value(stress: Sequence[float], tension: float, compression: float) -> float:
    """f (damage-plasticity.md, eq. 2)."""
    alpha, gamma = (1.16 - 1) / (2 * 1.16 - 1), 3 * (1 - 2 / 3) / (2 * 2 / 3 - 1)
    beta = (1 - alpha) * compression / tension - (1 + alpha)
    mean, largest = sum(stress) / 3, max(stress)
    q = math.sqrt(1.5 * sum((x - mean) ** 2 for x in stress))
    by_largest = (beta if largest >= 0 else gamma) * largest
    return q + 3 * alpha * mean + by_largest - (1 - alpha) * compression


def surface(of: Callable[[float, float], Sequence[float]], angles: Iterable[float]) -> list[Point]:
    """Where f = 0 along rays from zero stress: f is homogeneous up to its constant."""
    tension, compression = 3.5, 11.0
    constant = yield_value((0.0, 0.0, 0.0), tension, compression)
    found = []
    for angle in angles:
        x, y = math.cos(angle), math.sin(angle)
        slope = yield_value(of(x, y), tension, compression) - constant
        if slope > 1e-9:
            found.append((-constant / slope * x, -constant / slope * y))
    return found


def root(of: Callable[[float], float], low: float, high: float) -> float:
    """Where a function that is negative at ``low`` and positive at ``high`` is zero."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if of(middle) < 0 else (low, middle)
    return low


def yield_surface() -> None:
    """First yield of the brick: plane stress, and the plane of equal lateral stresses with its corners."""
    s = Sketch(760, 410, "Initial yield surface of the brick in two planes of principal stresses")
    at = frame((262, 150), (14.0, 14.0))
    turn = [math.radians(2.5 * k) for k in range(145)]
    s.line([at(*p) for p in surface(lambda x, y: (x, y, 0.0), turn)], INK, 2, fill=PALE)
    s.axes(at, (-15.5, 5.5), (-15.5, 5.5), ("σ_{1}", "σ_{2}"))
    biaxial = 11 * 1.16
    for point, label, off, colour in (
        ((3.5, 0.0), "f_{t}", (0.6, -1.5), TENSION),
        ((-11.0, 0.0), "f_{c0}", (-1.2, 0.8), COMPRESSION),
        ((-biaxial, -biaxial), "f_{b0}", (-1.6, -1.5), COMPRESSION),
    ):
        s.dot(at(*point), colour)
        s.text(*at(point[0] + off[0], point[1] + off[1]), label, colour=colour)
    s.text(175, 396, "plane stress, σ_{3} = 0")

    # σ_l in two directions and σ_a in the third: there f is linear between its corners.
    def f(lateral: float, axial: float) -> float:
        return yield_value((lateral, lateral, axial), 3.5, 11.0)

    left, bottom = -16.0, -24.5
    apex = root(lambda p: f(p, p), 0, 20)
    corner = root(lambda y: -f(0, y), -30, 0)
    border = [
        (left, root(lambda y: f(left, y), left, 10)),
        (root(lambda p: -f(p, 0), -30, 0), 0.0),
        (apex, apex),
        (0.0, corner),
        (root(lambda p: f(p, bottom), -20, 0), bottom),
    ]
    at = frame((560, 104), (11.0, 11.0))
    s.line([at(*p) for p in [*border, (left, bottom)]], "none", 0, fill=PALE)
    s.line([at(*p) for p in border], INK, 2)
    s.axes(at, (left, 7), (bottom, 7), ("σ_{l}", "σ_{a}"))
    for point, label, off, colour in (
        ((0.0, 3.5), "f_{t}", (-1.0, 1.0), TENSION),
        ((0.0, corner), "f_{c0}", (-2.2, -0.3), COMPRESSION),
        (border[1], "f_{b0}", (0.0, 1.2), COMPRESSION),
    ):
        s.dot(at(*point), colour)
        s.text(*at(point[0] + off[0], point[1] + off[1]), label, colour=colour)
    s.text(505, 396, "two equal stresses σ_{l}, the third σ_{a}")
    # The corner at f_c0, stretched five times along σ_l.
    close = frame((680, 262), (55.0, 11.0))

    def edge(lateral: float) -> Point:
        return lateral, root(lambda y: -f(lateral, y), -30, 0) - corner

    ends = [edge(-0.9), edge(0.9)]
    s.line([close(*p) for p in (ends[0], (0.0, 0.0), ends[1], (-0.9, ends[1][1]))], "none", 0, fill=PALE)
    s.line([close(*p) for p in (ends[0], (0.0, 0.0), ends[1])], INK, 2)
    s.line([close(*p) for p in ends], COMPRESSION, 1.2, "4 3")
    s.dot(close(0, 0), COMPRESSION)
    s.text(*close(-0.62, -1.4), "γ", "end")
    s.text(*close(0.3, 1.5), "β", "end")
    s.text(688, 326, "corner at f_{c0},", size=11)
    s.text(688, 341, "σ_{l} stretched by 5,", size=11)
    s.text(688, 356, "chord outside", colour=COMPRESSION, size=11)
    x, y = at(0, corner)
    s.ring((x, y), 10, "2 2")
    s.line([(x + 10, y + 1), (632, 250)], GREY, 1, "2 2")
    s.save("yield-surface")


def recovery() -> None:
    """Tension, closure, compression, tension again: stiffness recovery of a uniaxial cycle."""
    s = Sketch(520, 320, "Stiffness recovery at crack closure in a uniaxial cycle")
    at = frame((170, 160), (145e3, 82.0))
    curve = nodes(MORTAR["t"])
    strain, stress, effective, kappa = between(curve[0], curve[1], 0.35)
    damage = 1 - stress / effective
    s.axes(at, (-0.0003, 0.0021), (-1.7, 1.65), ("ε", "σ [MPa]"))
    closed = -1.4
    s.line([at(kappa, 0), at(kappa + closed / (E * (1 - damage)) * 0.5, closed * 0.5)], GREY, 1.5, "6 4")
    s.line([at(kappa, 0), at(kappa + closed / E, closed)], COMPRESSION, 2.5)
    s.line([at(strain, stress), at(kappa, 0)], TENSION, 1.5)
    s.line([at(0, 0), *(at(e, y) for e, y, _, _ in curve)], TENSION, 2.5)
    s.dot(at(strain, stress), TENSION)
    x, y = at(kappa, 0)
    s.line([(x, y - 4), (x, y + 4)])
    s.text(x + 4, y + 18, "ε_{pl}", "start")
    s.text(*at(0.00018, 0.75), "E", "end")
    s.text(*at(kappa + 0.52 * (strain - kappa) + 0.00006, 0.42 * stress), "(1 − d_{t}) E", "start", TENSION)
    x, y = at(kappa + 0.7 * closed / E, 0.7 * closed)
    s.text(x + 14, y + 4, "w_{c} = 1: E at once", "start", COMPRESSION)
    x, y = at(kappa + closed / (E * (1 - damage)) * 0.5, closed * 0.5)
    s.text(x - 6, y + 6, "w_{c} = 0: (1 − d_{t}) E", "end", GREY)
    s.save("stiffness-recovery")


def scaling() -> None:
    """A compression table in bands of several widths: what lies beyond the peak is stretched by l_ref/l."""
    s = Sketch(560, 330, "A compression table scaled by the reference length over the band width")
    at = frame((60, 280), (13e3, 26.0))
    s.axes(at, (0, 0.0345), (0, 9.2), ("ε", "σ_{c} [MPa]"))
    peak = MORTAR["c"][1]
    limit = E * (0.015 - 0.002) / (8.2 - 0.4)
    for ratio, label, part, colour in (
        (0.5, "l = l_{ref}/2", 0.35, TENSION),
        (1.0, "l = l_{ref}: table", 0.82, INK),
        (2.0, "l = 2 l_{ref}", 0.93, COMPRESSION),
        (limit, "", 0.0, GREY),
    ):
        rows = [(y, e if e <= peak[1] else peak[1] + (e - peak[1]) / ratio, d) for y, e, d in MORTAR["c"]]
        line = [(0.0, 0.0), *((e + y / E, y) for y, e, d in rows)]
        tail = [(0.0325, rows[-1][0])] if ratio == 0.5 else []
        s.line([at(*p) for p in line[2:] + tail], colour, 2.5 if label else 1.5, "" if label else "5 3")
        (x0, y0), (x1, y1) = at(*line[-2]), at(*line[-1])
        if label:
            s.text(x0 + part * (x1 - x0) + 8, y0 + part * (y1 - y0) - 2, label, "start", colour)
    s.line([at(0, 0), at(7.8 / E, 7.8), at(0.002 + 8.2 / E, 8.2)], INK, 2.5)
    s.text(*at(0.0016, 4.5), "E", "end")
    x, y = at(0.002 + 8.2 / E, 8.2)
    s.text(x + 8, y - 6, "peak: not scaled up to here", "start", size=12)
    x, y = at(0.002 + 8.2 / E, 0)
    s.line([(x, y), (x, y + 6)], GREY, 1)
    s.text(x, y + 20, f"snap-back at l = {limit:.2f} l_{{ref}}", "middle", GREY, 12)
    s.save("table-scaling")


def length(n: Sequence[float], edges: Sequence[float]) -> float:
    """Projected length (crack-band.md, eq. 2) of a brick."""
    signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    gradient = [[x / (4 * e) for x, e in zip(c, edges, strict=True)] for c in signs]
    return 2 / sum(abs(sum(a * b for a, b in zip(n, g, strict=True))) for g in gradient)


def projected() -> None:
    """The length across a crack of a bed joint's element."""
    s = Sketch(760, 300, "Projected length of a flat brick for cracks of several directions")
    edges = (51.0, 12.5, 49.0)
    at = frame((185, 150), (5.2, 5.2))
    a, b, _ = (0.5 * e for e in edges)
    s.line([at(-a, -b), at(a, -b), at(a, b), at(-a, b)], INK, 1.5, fill=PALE)
    s.measure(at(-a, -b - 13), at(a, -b - 13), "a", (0, 17))
    s.measure(at(-a - 4, -b), at(-a - 4, b), "b", (-12, 4))
    angle = math.radians(60)
    n = (math.cos(angle), math.sin(angle), 0.0)
    half = 0.5 * length(n, edges)
    s.line([at(-22 * n[1], 22 * n[0]), at(22 * n[1], -22 * n[0])], GREY, 1.5, "6 4")
    s.line([at(0, 0), at(17 * n[0], 17 * n[1])], GREY, 1.2, arrow="end")
    s.line([at(-half * n[0], -half * n[1]), at(half * n[0], half * n[1])], TENSION, 3)
    s.text(*at(17 * n[0] + 1.5, 17 * n[1] + 0.5), "n", "start")
    s.text(*at(-4.2, -4.5), "l(n)", "end", TENSION)
    s.text(*at(-20, 12.5), "crack", "middle", GREY)
    s.line([at(0, 0), at(14, 0)], GREY, 1, "2 2")
    arc = [math.radians(5 * k) for k in range(13)]
    s.line([at(8 * math.cos(t), 8 * math.sin(t)) for t in arc], GREY, 1)
    s.text(*at(8.6, 3.0), "θ", "start")
    s.ring(at(0, 0), 0.5 * 5.2 * (edges[0] * edges[1] * edges[2]) ** (1 / 3), "3 4")
    s.text(*at(14.8, 9.8), "diameter ∛V", "start", GREY, 12)
    at = frame((460, 250), (2.6, 3.6))
    s.axes(at, (0, 95), (0, 58), ("θ", "l(n) [mm]"))
    for degrees in (0, 30, 60, 90):
        x, y = at(degrees, 0)
        s.line([(x, y), (x, y + 4)], GREY, 1)
        s.text(x, y + 18, f"{degrees}°", size=12)
    curve = []
    for k in range(91):
        t = math.radians(k)
        curve.append(at(k, length((math.cos(t), math.sin(t), 0.0), edges)))
    s.line(curve, TENSION, 2.5)
    cube = (edges[0] * edges[1] * edges[2]) ** (1 / 3)
    s.line([at(0, cube), at(90, cube)], GREY, 1.5, "6 4")
    s.text(*at(62, cube + 2), f"∛V = {cube:.1f} mm", "middle", GREY, 12)
    s.text(*at(19, 50), "1/max(cos θ/a, sin θ/b)", "start", TENSION)
    for value, label in ((51.0, "a = 51"), (12.5, "b = 12.5")):
        x, y = at(0, value)
        s.line([(x - 4, y), (x, y)], GREY, 1)
        s.text(x - 7, y + 4, label, "end", size=12)
    s.save("projected-length")


# ξ, η, ζ of the nodes, in the order of the code (`CORNERS`).
CORNERS = [(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def hex8() -> None:
    """Nodes and Gauss points of the hex8 as they are numbered."""
    s = Sketch(420, 320, "Nodes and Gauss points of the hex8 in the order of the code")

    def at(x: float, y: float, z: float) -> Point:
        return 190 + 85 * x + 45 * y, 165 - 80 * z - 30 * y

    points = [at(*c) for c in CORNERS]
    for a, b in ((0, 3), (2, 3), (3, 7)):
        s.line([points[a], points[b]], GREY, 1, "4 3")
    for a, b in ((0, 1), (1, 2), (0, 4), (1, 5), (2, 6), (4, 5), (5, 6), (6, 7), (7, 4)):
        s.line([points[a], points[b]], INK, 2)
    g = 1 / math.sqrt(3)
    for k, (corner, point) in enumerate(zip(CORNERS, points, strict=True)):
        x, y, z = corner
        gx, gy = at(g * x, g * y, g * z)
        s.line([(gx - 4, gy), (gx + 4, gy)], TENSION, 1.5)
        s.line([(gx, gy - 4), (gx, gy + 4)], TENSION, 1.5)
        s.text(gx + 6, gy - 4, str(k), "start", TENSION, 11)
        s.dot(point)
        left = k in (0, 4, 5, 7)
        s.text(point[0] + (-9 if left else 9), point[1] + (16 if z < 0 else -7), str(k), size=15)
    origin = at(0, 0, 0)
    for end, label, off in (
        ((1.75, 0, 0), "ξ", (10, 4)),
        ((0, 2.1, 0), "η", (8, -3)),
        ((0, 0, 1.6), "ζ", (0, -7)),
    ):
        tip = at(*end)
        s.line([origin, tip], GREY, 1, arrow="end")
        s.text(tip[0] + off[0], tip[1] + off[1], label)
    s.text(200, 312, "dots: nodes, crosses: Gauss points at ±1/√3", size=12)
    s.save("hex8-nodes")


def corotational() -> None:
    """The rotated frame of a deformed element, seen in two dimensions."""
    s = Sketch(600, 270, "Corotational frame: reference, rotated reference and deformed element")
    square = [(-1.0, -0.7), (1.0, -0.7), (1.0, 0.7), (-1.0, 0.7)]
    at = frame((120, 150), (70.0, 70.0))
    moved = frame((410, 120), (70.0, 70.0))
    turn = math.radians(24)
    c, d = math.cos(turn), math.sin(turn)
    local = [(-0.15, 0.1), (0.3, 0.05), (0.2, 0.35), (-0.2, -0.15)]
    bent = [(x + u, y + v) for (x, y), (u, v) in zip(square, local, strict=True)]
    mean = [sum(p[i] for p in bent) / 4 for i in (0, 1)]
    deformed = [(c * (x - mean[0]) - d * (y - mean[1]), d * (x - mean[0]) + c * (y - mean[1])) for x, y in bent]
    # F = Σ x_a b_aᵀ at the centroid, R its rotation (hex8.md, eq. 6), in two dimensions.
    gradient = [(math.copysign(1 / 4, x) / 1.0, math.copysign(1 / 4, y) / 0.7) for x, y in square]
    f = [[sum(p[i] * b[j] for p, b in zip(deformed, gradient, strict=True)) for j in (0, 1)] for i in (0, 1)]
    turn = math.atan2(f[1][0] - f[0][1], f[0][0] + f[1][1])
    c, d = math.cos(turn), math.sin(turn)
    turned = [(c * x - d * y, d * x + c * y) for x, y in square]
    s.line([at(*p) for p in square], INK, 1.5, fill=PALE)
    s.line([moved(*p) for p in [*turned, turned[0]]], GREY, 1.5, "5 4")
    s.line([moved(*p) for p in [*deformed, deformed[0]]], COMPRESSION, 2)
    s.line([at(0, 0), moved(0, 0)], GREY, 1, "2 3", arrow="end")
    for k in range(4):
        s.line([moved(*turned[k]), moved(*deformed[k])], TENSION, 2)
        s.dot(moved(*deformed[k]), COMPRESSION)
    s.dot(at(0, 0))
    s.dot(moved(0, 0))
    s.text(*at(0.0, -0.3), "X_{c}")
    s.text(*moved(0.12, -0.28), "x_{c}")
    s.text(*at(1.15, 0.8), "X_{a}")
    for axis, label in (((0.55, 0.0), "R e_{1}"), ((0.0, 0.55), "R e_{2}")):
        x, y = axis
        tip = moved(c * x - d * y, d * x + c * y)
        s.line([moved(0, 0), tip], INK, 1.2, arrow="end")
        s.text(tip[0] + 6, tip[1] + (4 if x else 1), label, "start", size=12)
    x, y = moved(*deformed[2])
    s.text(x + 10, y - 4, "x_{a}", "start", COMPRESSION)
    (x0, y0), (x1, y1) = moved(*turned[2]), moved(*deformed[2])
    s.text(max(x0, x1) + 20, (y0 + y1) / 2 + 12, "R ū_{a}", "start", TENSION)
    s.text(120, 250, "reference")
    s.text(410, 250, "dashed: reference turned by R", colour=GREY)
    s.save("corotational-frame")


if __name__ == "__main__":
    for draw in (uniaxial, yield_surface, recovery, scaling, projected, hex8, corotational):
        draw()
