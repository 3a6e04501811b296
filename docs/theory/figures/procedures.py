"""Sketches of the theory pages on equilibrium, procedures, symmetry and the linear solver.

Run in this folder: `python3 procedures.py`. It writes six SVG files beside itself and needs no other package.
"""

from math import exp
from pathlib import Path

INK, GREY, BLUE, RED, GREEN = "#222222", "#8a8a8a", "#1f5fa8", "#b8352a", "#2e7d4f"
PALE, LIGHT = "#dde7f3", "#f3f3f3"


class Sketch:
    """SVG text with a white ground; coordinates in pixels, y downwards."""

    def __init__(self, width, height):
        self.size = (width, height)
        self.parts = []

    def add(self, text):
        self.parts.append(text)

    def line(self, x1, y1, x2, y2, colour=INK, width=1.5, dash="", arrow=False):
        self.path([(x1, y1), (x2, y2)], colour, width, dash, arrow)

    def path(self, points, colour=INK, width=1.5, dash="", arrow=False, fill="none", close=False):
        d = "M" + " L".join(f"{x:.1f},{y:.1f}" for x, y in points) + (" Z" if close else "")
        dash = f' stroke-dasharray="{dash}"' if dash else ""
        self.add(f'<path d="{d}" fill="{fill}" stroke="{colour}" stroke-width="{width}"{dash}/>')
        if arrow:
            (x1, y1), (x2, y2) = points[-2:]
            length = ((x2 - x1) ** 2 + (y2 - y1) ** 2) ** 0.5
            a, b = (x2 - x1) / length, (y2 - y1) / length
            tip = [(x2, y2), (x2 - 9 * a - 4 * b, y2 - 9 * b + 4 * a), (x2 - 9 * a + 4 * b, y2 - 9 * b - 4 * a)]
            d = "M" + " L".join(f"{x:.1f},{y:.1f}" for x, y in tip) + " Z"
            self.add(f'<path d="{d}" fill="{colour}"/>')

    def rect(self, x, y, width, height, fill="none", colour=INK, stroke=1.2, radius=0):
        self.add(
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" rx="{radius}" '
            f'fill="{fill}" stroke="{colour}" stroke-width="{stroke}"/>'
        )

    def dot(self, x, y, radius=4, fill=INK, colour=INK):
        self.add(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{fill}" stroke="{colour}" stroke-width="1.5"/>')

    def text(self, x, y, words, colour=INK, size=13, anchor="start", bold=False):
        weight = ' font-weight="bold"' if bold else ""
        self.add(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{colour}" text-anchor="{anchor}"{weight}>'
            f"{words.replace('&', '&amp;').replace('<', '&lt;')}</text>"
        )

    def write(self, name):
        width, height = self.size
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}" font-family="sans-serif">'
        )
        ground = f'<rect width="{width}" height="{height}" fill="white"/>'
        text = "\n".join([head, ground, *self.parts, "</svg>"]) + "\n"
        Path(__file__).with_name(name).write_text(text, encoding="utf-8")


def axes(sketch, x0, y0, width, height, across, up):
    sketch.line(x0, y0, x0 + width, y0, arrow=True)
    sketch.line(x0, y0, x0, y0 - height, arrow=True)
    sketch.text(x0 + width, y0 + 20, across, anchor="end")
    sketch.text(x0 + 8, y0 - height + 6, up)


def sum_of(force, opening, parts=200):
    h = opening / parts
    return sum(0.5 * h * (force(i * h) + force((i + 1) * h)) for i in range(parts))


def snap_back():
    """The bar of case 1 of docs/stability.md: 1 m of 2970 MPa behind a joint of 0.28 MPa."""
    f_t, u_k, zeta, compliance = 0.28, 0.2, 4.38, 1000.0 / 2970.0

    def force(opening):
        return f_t * (1 - (1 - exp(-zeta * opening / u_k)) / (1 - exp(-zeta)))

    s = Sketch(640, 330)
    x0, y0 = 60, 280
    scale = (3400.0, 800.0)

    def at(end, f):
        return (x0 + scale[0] * end, y0 - scale[1] * f)

    axes(s, x0, y0, 560, 260, "displacement of the end", "force")
    openings = [0.14 * i / 140 for i in range(141)]
    curve = [at(w + compliance * force(w), force(w)) for w in openings]
    peak, low = curve[0], min(curve[10:], key=lambda p: p[0])
    s.path([at(0, 0), peak], INK, 2)
    s.path(curve, BLUE, 2)
    work, step, total = 0.0, 1e-5, 0.0
    while total < 0.0105:  # dissipated per area: work less the energy that unloading to the origin gives back
        if total >= work:
            s.dot(*at(w + compliance * force(w), force(w)) if total else peak, 3.5, "white", BLUE)
            work += 0.0009
        w = step
        total = sum_of(force, w) - 0.5 * force(w) * w
        step += 1e-4
    beyond = min((p for p in curve[40:]), key=lambda p: abs(p[0] - peak[0]))
    s.line(peak[0] + 3, peak[1] + 10, peak[0] + 3, beyond[1] - 6, RED, 1.5, "6 4", True)
    s.text(peak[0] + 8, peak[1] - 4, "peak")
    s.text(peak[0] + 14, 0.5 * (peak[1] + beyond[1]) - 26, "statics at a prescribed", RED)
    s.text(peak[0] + 14, 0.5 * (peak[1] + beyond[1]) - 9, "displacement jumps", RED)
    s.text(low[0] - 12, low[1] + 4, "turning point", BLUE, anchor="end")
    s.text(peak[0] + 24, 210, "the path in increments of", BLUE)
    s.text(peak[0] + 24, 227, "equal dissipated energy", BLUE)
    s.write("snap-back.svg")


def peak():
    """A bond of 10 kN and 5000 kN/mm behind a spring of 100 kN/mm; it softens by 40 kN/mm."""
    line, bond, soft = 100.0, 5000.0, 40.0

    def traction(gap):
        return min(bond * gap, 10.0 - soft * (gap - 10.0 / bond))

    def state(gap):
        return gap + traction(gap) / line, traction(gap)

    s = Sketch(640, 330)
    x0, y0 = 60, 280

    def at(u, f):
        return (x0 + 2400 * u, y0 - 22 * f)

    axes(s, x0, y0, 560, 260, "displacement u", "force F")
    gaps = [0.0, 0.002] + [0.002 + 0.145 * i / 20 for i in range(1, 21)]
    start, end = 0.07 / 51, 0.002 + 0.083 / 0.6
    s.path([at(*state(g)) for g in gaps], GREY, 2)
    u0, f0 = state(start)
    u1, f1 = state(end)
    s.line(*at(u0, f0), *at(u1, f1), INK, 1.5, "6 4")
    for u, f, name in [(u0, f0, "F₀"), (u1, f1, "F₁")]:
        s.dot(*at(u, f), 4, INK)
        s.text(at(u, f)[0] - 8, at(u, f)[1] - 10, name, anchor="end" if name == "F₀" else "start")
    parts = [1 / 4096, 1 / 256, 1 / 64, 1 / 16, 1 / 8, 1 / 4, 3 / 8, 1 / 2, 5 / 8, 3 / 4, 7 / 8]
    points = [state(start + part * (end - start)) for part in parts]
    best = max(points, key=lambda p: p[1])
    for u, f in points:
        s.dot(*at(u, f), 3.5, "white", BLUE)
    s.dot(*at(*best), 5, RED, RED)
    s.line(at(*best)[0], at(*best)[1] + 8, at(*best)[0], y0, RED, 1.2, "3 3")
    s.text(at(*best)[0] + 14, at(*best)[1] - 2, "largest F(s): the increment is repeated to here", RED)
    s.text(at(0.143, 8)[0], at(0.143, 8)[1] - 4, "F(s) from the laws, eq. 16", BLUE)
    s.text(at(0.115, 4.1)[0], at(0.115, 4.1)[1], "chord of the increment")
    for u, name in [(u0, "u₀"), (u1, "u₁")]:
        s.line(at(u, 0)[0], y0 - 4, at(u, 0)[0], y0 + 4)
        s.text(at(u, 0)[0], y0 + 20, name, anchor="middle")
    s.write("peak.svg")


def flow():
    """Which procedure of `auto` follows which."""
    s = Sketch(720, 606)
    rows = [
        ("static", "secant tangents", "twice rejected in a row *"),
        ("static", "consistent tangents *", "no equilibrium at 0.1 of the first increment, or a snap-back"),
        ("dissipation", "prescribed dissipated energy", "more than six cuts; after a snap-back, consistent tangents first *"),
        ("implex", "extrapolated solids *", "no equilibrium at 0.01 of the first increment"),
        ("direct", "laws with exact tangents", "no equilibrium at 0.01 of the first increment"),
        ("quasi_static", "inertia, backward Euler", "no equilibrium in increments.min"),
        ("static", "largest increments", "nothing is left: not_converged"),
    ]
    left, top, step, width, height = 70, 46, 78, 210, 44
    s.text(left, 26, "procedure = \"auto\"", bold=True, size=14)
    s.text(left + width + 24, 26, "the next one follows after", GREY)
    for i, (name, words, why) in enumerate(rows):
        y = top + step * i
        s.rect(left, y, width, height, PALE if i else LIGHT, radius=6)
        s.text(left + width / 2, y + 19, name, bold=True, anchor="middle")
        s.text(left + width / 2, y + 36, words, size=12, anchor="middle")
        if i + 1 < len(rows):
            s.line(left + width / 2, y + height, left + width / 2, y + step, arrow=True)
        if i + 1 < len(rows):
            s.text(left + width / 2 + 12, y + height + 22, why, size=12)
        else:
            s.text(left + width + 16, y + 26, why, size=12)
    middle = top + 22
    s.path([(left, top + 5 * step + 22), (30, top + 5 * step + 22), (30, middle), (left, middle)], GREEN, 1.5, "", True)
    for i in (1, 2, 3, 4):
        s.line(left, top + step * i + 22, 30, top + step * i + 22, GREEN)
    s.add(
        f'<text transform="translate(20 {top + 3 * step}) rotate(-90)" font-size="12" fill="{GREEN}" '
        'text-anchor="middle">back to the first once the trouble has passed</text>'
    )
    x = 500
    s.rect(x, top, 190, height, "#fbeedd", radius=6)
    s.text(x + 95, top + 19, "relaxation *", bold=True, anchor="middle")
    s.text(x + 95, top + 36, "dashpots at held loads", size=12, anchor="middle")
    s.line(left + width, top + 14, x, top + 14, arrow=True)
    s.line(x, top + 30, left + width, top + 30, GREEN, arrow=True)
    s.text(0.5 * (left + width + x), top + 8, "before another procedure", size=12, anchor="middle")
    s.text(left, 582, "* only where solids soften; with elastic solids direct comes before dissipation", GREY, 12)
    s.text(left, 599, "A matrix that a free body makes singular leads to inertia at once.", GREY, 12)
    s.write("flow.svg")


def line_search():
    s = Sketch(720, 300)
    panels = [
        (50, "stiffens: shortened", lambda e: -1 + e + 5.5 * max(e - 0.22, 0.0), 1.25),
        (410, "softens: lengthened", lambda e: -1 + 0.11 * e, 9.5),
    ]
    y0, tall = 175, 110
    for x0, title, slope, most in panels:
        wide = 270
        s.rect(x0, y0 - 0.2 * tall, wide, 0.4 * tall, PALE, PALE)
        s.line(x0, y0, x0 + wide + 15, y0, arrow=True)
        s.line(x0, y0 + tall + 5, x0, y0 - tall - 15, arrow=True)
        s.text(x0 + wide + 10, y0 + 18, "η")
        s.text(x0 + 8, y0 - tall - 8, "s(η)/|s(0)|")
        s.text(x0 + wide, y0 - tall - 8, title, anchor="end", bold=True)
        etas = [most * i / 100 for i in range(101)]
        curve = [(x0 + wide * e / most, y0 - tall * slope(e)) for e in etas if slope(e) < 1.15]
        s.path(curve, BLUE, 2)
        s.text(x0 - 6, y0 + tall + 4, "−1", anchor="end")
        s.text(x0 - 6, y0 + 4, "0", anchor="end")
        s.dot(x0, y0 + tall, 4, BLUE, BLUE)

    def mark(panel, eta, name, colour=INK, above=True):
        x0, _, slope, most = panels[panel]
        value = min(slope(eta), 1.1)
        x, y = x0 + 270 * eta / most, y0 - tall * value
        s.dot(x, y, 4, "white" if colour == INK else colour, colour)
        s.text(x + (10 if above else 8), y + (-8 if above else 18), name, colour, 12)

    # The first trial of a direction that stiffens lies far above the frame.
    x0 = panels[0][0]
    x = x0 + 270 / 1.25
    s.line(x, y0 - 74, x, y0 - 104, GREY, 1.2, "", True)
    s.text(x + 50, y0 - 58, "1st trial, η = 1:", GREY, 12, anchor="end")
    s.text(x + 50, y0 - 43, "above the frame", GREY, 12, anchor="end")
    mark(0, 0.19, "2nd", INK, False)
    mark(0, 0.32, "accepted", RED, False)
    mark(1, 1.0, "1st trial: more than half is left", INK, False)
    mark(1, 4.0, "2nd", INK, False)
    mark(1, 8.0, "", RED)
    s.text(panels[1][0] + 262, y0 - 30, "accepted, η = 8 at most", RED, 12, anchor="end")
    s.text(panels[0][0] + 264, y0 + 38, "|s(η)| ≤ 0.2 |s(0)|", GREY, 12, anchor="end")
    s.text(panels[1][0] + 8, y0 + 14, "|s(η)| ≤ 0.2 |s(0)|", GREY, 12)
    s.write("line-search.svg")


def mirror():
    """A course of a wall from above, three elements through its thickness: the middle one lies across the plane."""
    s = Sketch(720, 330)
    x0, wide, rows, columns, deep = 60, 240, 3, 4, 46
    top = 70

    def grid(x, y, first, last, fill):
        for r in range(first, last):
            for c in range(columns):
                s.rect(x + wide / columns * c, y + deep * r, wide / columns, deep, fill[r])

    grid(x0, top, 0, 3, [LIGHT, LIGHT, LIGHT])
    s.line(x0 - 25, top + 1.5 * deep, x0 + wide + 25, top + 1.5 * deep, RED, 1.5, "8 4")
    s.text(x0 + wide / 2, top - 14, "the whole scene", bold=True, anchor="middle")
    s.text(x0 + wide + 30, top + 1.5 * deep - 8, "mirror plane", RED, 12)
    x1 = 430
    grid(x1, top, 1, 3, [LIGHT, PALE, LIGHT])
    s.line(x1 - 25, top + 1.5 * deep, x1 + wide + 25, top + 1.5 * deep, RED, 1.5, "8 4")
    s.text(x1 + wide / 2, top - 14, "the half that is solved", bold=True, anchor="middle")
    for c in range(columns + 1):
        x = x1 + wide / columns * c
        for r in (2, 3):
            s.dot(x, top + deep * r, 4, INK)
        s.dot(x, top + deep, 4, "white", INK)
    x = x1 + wide / columns * 2
    s.line(x, top + 2 * deep, x + 26, top + 2 * deep + 20, BLUE, 2, arrow=True)
    s.text(x + 31, top + 2 * deep + 26, "u", BLUE)
    s.line(x, top + deep, x + 26, top + deep - 20, BLUE, 2, arrow=True)
    s.text(x + 31, top + deep - 12, "S u", BLUE)
    y = top + 3 * deep + 40
    s.dot(x0 + 6, y - 4, 4, INK)
    s.text(x0 + 20, y, "nodes with unknowns of their own")
    s.dot(x0 + 6, y + 22, 4, "white", INK)
    s.text(x0 + 20, y + 26, "images of them beyond the plane: same unknowns, opposite sign across the plane")
    s.rect(x0, y + 40, 12, 12, PALE)
    s.text(x0 + 20, y + 52, "elements across the plane: computed whole, counted by one half")
    s.write("mirror-half.svg")


def dissection():
    """A wall in stretcher bond, its separators of three levels, and the fronts of the tree."""
    s = Sketch(760, 360)
    x0, y0, unit, course, courses, units = 30, 60, 44, 22, 10, 8
    s.rect(x0, y0, units * unit, courses * course, LIGHT, "#bbbbbb", 0.8)
    joints = []
    for c in range(courses):
        y = y0 + course * c
        joints.append(f"M{x0},{y} h{units * unit}")
        joints += [f"M{x0 + unit * (i + 1 - 0.5 * (c % 2)):.0f},{y} v{course}" for i in range(units - 1 + c % 2)]
    s.add(f'<path d="{" ".join(joints)}" fill="none" stroke="#bbbbbb" stroke-width="0.8"/>')

    def vertical(middle, first, last, colour, width):
        points = []
        for c in range(first, last):
            x = x0 + middle + (-0.5 * unit if c % 2 else 0)
            points += [(x, y0 + course * c), (x, y0 + course * (c + 1))]
        s.path(points, colour, width)

    half, level = units // 2 * unit, y0 + course * 5
    vertical(half, 0, courses, RED, 3.5)
    s.line(x0, level, x0 + half - 24, level, BLUE, 3)
    s.line(x0 + half + 2, level, x0 + units * unit, level, BLUE, 3)
    for middle in (half // 2, half + half // 2):
        vertical(middle, 0, 5, GREEN, 2)
        vertical(middle, 5, courses, GREEN, 2)
    s.text(x0, 40, "separators of a wall", bold=True)
    s.text(x0, y0 + course * courses + 24, "1st", RED, bold=True)
    s.text(x0 + 30, y0 + course * courses + 24, "2nd", BLUE, bold=True)
    s.text(x0 + 64, y0 + course * courses + 24, "3rd cut; leaves have at most 200 nodes", GREEN)
    # The tree: a front is a square, its eliminated columns are filled.
    left, right = 420, 740
    s.text(left, 40, "fronts of the tree", bold=True)

    def front(x, y, size, part, colour):
        s.rect(x - size / 2, y, size, size, "white")
        s.path(
            [(x - size / 2, y), (x + size / 2, y), (x + size / 2, y + part * size), (x - size / 2 + part * size, y + part * size),
             (x - size / 2 + part * size, y + size), (x - size / 2, y + size)],
            INK, 0.8, fill=colour, close=True,
        )

    middle = 0.5 * (left + right)
    levels = [
        (60, [middle], 62, 1.0, RED),
        (146, [left + 80, right - 80], 50, 0.5, BLUE),
        (218, [left + 40, left + 120, right - 120, right - 40], 36, 0.45, GREEN),
        (276, [left + 20 + 40 * i for i in range(8)], 20, 0.6, GREY),
    ]
    for (ya, xa, size, *_), (yb, xb, *_) in zip(levels, levels[1:]):
        for i, x in enumerate(xa):
            for child in xb[2 * i : 2 * i + 2]:
                s.line(child, yb, x, ya + size, GREY, 1)
    for y, xs, size, part, colour in levels:
        for x in xs:
            front(x, y, size, part, colour)
    s.text(left, 322, "filled: columns eliminated in this front", size=12)
    s.text(left, 340, "white: Schur complement, added to the parent", size=12)
    s.write("dissection.svg")


if __name__ == "__main__":
    for sketch in (snap_back, peak, flow, line_search, mirror, dissection):
        sketch()
