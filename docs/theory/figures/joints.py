"""Draws the figures of joint.md, contact.md and shifted-penalty.md beside this file.

    python3 docs/theory/figures/joints.py

Curves come from the equations of the pages, with the interface of Table 1 of D'Altri et al. (2018).
Units N, mm, MPa. Needs nothing but Python.
"""

from math import cos, exp, expm1, log1p, pi, sin
from pathlib import Path

HERE = Path(__file__).parent

# Table 1.
F_T, U_K, ZETA = 0.28, 0.20, 4.38
C, TAN_PHI, MU, DELTA_K, XI = 0.87, 1.01, 0.73, 0.4, 1.1

BLACK, GREY, LIGHT = "#222222", "#777777", "#d8d8d8"
BLUE, RED, GREEN, ORANGE = "#1f5fa8", "#b5302a", "#2c7a3f", "#c07a12"
FILL = "#e8eef6"


def softening(x, brittleness):
    """S of eqs 6 and 8 at x, the separation over the ultimate one."""
    if x >= 1.0:
        return 1.0
    if brittleness == 0.0:
        return x
    return expm1(-brittleness * x) / expm1(-brittleness)


def inverse(s, brittleness):
    """The separation over the ultimate one at which S = s."""
    return -log1p(s * expm1(-brittleness)) / brittleness


def limit(sigma, damage):
    """Bound of the shear traction, eq. 15 of joint.md."""
    cohesive = max(C - TAN_PHI * sigma, 0.0)
    return (1.0 - damage) * cohesive + damage * MU * max(-sigma, 0.0)


class Drawing:
    """SVG text in pixels of a view box; y points down."""

    def __init__(self, width, height, title):
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
            f'height="{height}" font-family="sans-serif" font-size="12" role="img">',
            f"<title>{title}</title>",
            f'<rect width="{width}" height="{height}" fill="white"/>',
        ]

    def path(self, points, colour=BLACK, width=1.5, dash=None, fill="none", close=False):
        text = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points) + ("Z" if close else "")
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<path d="{text}" fill="{fill}" stroke="{colour}" stroke-width="{width}"{dashes}/>'
        )

    def arrow(self, start, end, colour=BLACK, width=1.2, both=False, size=7.0):
        """A line with a head at its end, or at both."""
        self.path([start, end], colour, width)
        ends = [(start, end)] + ([(end, start)] if both else [])
        for (x0, y0), (x1, y1) in ends:
            length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
            ux, uy = (x1 - x0) / length, (y1 - y0) / length
            base = (x1 - size * ux, y1 - size * uy)
            side = 0.35 * size
            self.path(
                [
                    (x1, y1),
                    (base[0] - side * uy, base[1] + side * ux),
                    (base[0] + side * uy, base[1] - side * ux),
                ],
                colour,
                0.5,
                fill=colour,
                close=True,
            )

    def dot(self, at, colour=BLACK, radius=3.0, fill=None):
        x, y = at
        self.parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{fill or colour}" stroke="{colour}"/>'
        )

    def text(self, at, words, colour=BLACK, anchor="start", size=None, turn=None):
        x, y = at
        more = f' font-size="{size}"' if size else ""
        more += f' transform="rotate({turn} {x:.1f} {y:.1f})"' if turn else ""
        words = words.replace("&", "&amp;").replace("<", "&lt;")
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" text-anchor="{anchor}"{more}>{words}</text>'
        )

    def save(self, name):
        (HERE / name).write_text("\n".join(self.parts) + "\n</svg>\n", encoding="utf-8")


class Axes:
    """A drawing with axes: data in, pixels out."""

    def __init__(self, drawing, box, x_range, y_range, labels):
        self.drawing = drawing
        self.left, self.top, self.right, self.bottom = box
        self.x_range, self.y_range = x_range, y_range
        x_0 = min(max(0.0, x_range[0]), x_range[1])
        y_0 = min(max(0.0, y_range[0]), y_range[1])
        drawing.arrow(self.at(x_range[0], y_0), self.at(x_range[1], y_0), GREY, 1.0)
        drawing.arrow(self.at(x_0, y_range[0]), self.at(x_0, y_range[1]), GREY, 1.0)
        x, y = self.at(x_range[1], y_0)
        drawing.text((x, y + 32), labels[0], anchor="end")
        x, y = self.at(x_0, y_range[1])
        drawing.text((x + 8, y + 6), labels[1])

    def at(self, x, y):
        (x0, x1), (y0, y1) = self.x_range, self.y_range
        return (
            self.left + (x - x0) / (x1 - x0) * (self.right - self.left),
            self.bottom - (y - y0) / (y1 - y0) * (self.bottom - self.top),
        )

    def curve(self, points, colour=BLACK, width=1.8, dash=None):
        self.drawing.path([self.at(x, y) for x, y in points], colour, width, dash)

    def tick(self, axis, value, words, colour=BLACK):
        x, y = self.at(value, 0.0) if axis == "x" else self.at(0.0, value)
        if axis == "x":
            self.drawing.path([(x, y - 3), (x, y + 3)], GREY, 1.0)
            self.drawing.text((x, y + 17), words, colour, "middle")
        else:
            self.drawing.path([(x - 3, y), (x + 3, y)], GREY, 1.0)
            self.drawing.text((x - 7, y + 4), words, colour, "end")

    def label(self, at, words, colour=BLACK, shift=(0, 0), **how):
        x, y = self.at(*at)
        self.drawing.text((x + shift[0], y + shift[1]), words, colour, **how)


def steps(start, end, count):
    return [start + (end - start) * k / count for k in range(count + 1)]


def tension():
    d = Drawing(460, 290, "Traction over opening for several brittlenesses, with secant unloading")
    a = Axes(d, (50, 20, 445, 240), (-0.02, 0.235), (-0.08, 0.325), ("opening u − u₀ [mm]", "σ [MPa]"))
    for zeta, colour in [(1.1, GREEN), (4.38, BLUE), (10.0, ORANGE)]:
        points = [(w, (1.0 - softening(w / U_K, zeta)) * F_T) for w in steps(0.0, U_K, 48)]
        a.curve([(0.0, 0.0), *points, (0.23, 0.0)], colour)
    a.label((0.105, 0.105), "ζ = 1.1", GREEN, (8, -4))
    a.label((0.078, 0.062), "ζ = 4.38", BLUE)
    a.curve([(0.048, 0.024), (0.06, -0.03)], ORANGE, 0.8)
    a.label((0.06, -0.04), "ζ = 10", ORANGE, (-6, 8))
    top = 0.04
    height = (1.0 - softening(top / U_K, ZETA)) * F_T
    a.curve([(top, height), (0.0, 0.0)], BLUE, 1.5, "5 3")
    a.curve([(0.0, 0.0), (-0.002, -0.07)], BLUE, 1.8)
    d.dot(a.at(top, height), BLUE)
    a.label((top, height), "secant", BLUE, (9, 2))
    a.label((-0.002, -0.07), "k_n u", BLUE, (8, 4))
    a.tick("y", F_T, "f_t")
    a.tick("x", U_K, "u_k")
    a.tick("x", 0.1, "0.1")
    d.save("joint-tension.svg")


def shear():
    d = Drawing(480, 320, "Shear traction over slip at three pressures")
    a = Axes(d, (105, 20, 465, 270), (0.0, 0.52), (0.0, 2.1), ("slip |δ| [mm]", "|τ| [MPa]"))
    for pressure, colour in [(0.1, GREEN), (0.5, BLUE), (1.0, RED)]:
        points = [(s, limit(-pressure, softening(s / DELTA_K, XI))) for s in steps(0.0, DELTA_K, 40)]
        a.curve([(0.0, 0.0), *points, (0.51, MU * pressure)], colour)
        a.label((0.51, MU * pressure), f"{pressure} MPa", colour, (0, -6), anchor="end")
        a.tick("y", C + TAN_PHI * pressure, "c + tan φ |σ|" if pressure == 1.0 else "", colour)
    a.label((0.34, MU), "μ |σ|", RED, (6, 14))
    brittle = [(s, limit(-0.5, softening(s / DELTA_K, 4.0))) for s in steps(0.0, DELTA_K, 40)]
    a.curve(brittle, BLUE, 1.2, "2 3")
    a.label((0.135, 0.7), "ξ = 4", BLUE, size=11)
    # Unloading and reloading in shear is elastic.
    at = 0.12
    top = limit(-1.0, softening(at / DELTA_K, XI))
    a.curve([(at, top), (at - 0.003, 1.12)], RED, 1.4, "5 3")
    d.dot(a.at(at, top), RED)
    a.label((at, 1.24), "k_s", RED, (-7, 0), anchor="end")
    a.label((0.17, limit(-1.0, softening(0.425, XI))), "ξ = 1.1", RED, (6, -8))
    a.tick("y", C, "c")
    a.tick("x", DELTA_K, "δ_k")
    a.tick("x", 0.2, "0.2")
    d.save("joint-shear.svg")


def failure():
    d = Drawing(460, 310, "Failure line and its fall with damage")
    a = Axes(d, (30, 20, 440, 260), (-1.25, 0.5), (0.0, 2.25), ("σ [MPa]", "|τ| [MPa]"))
    for damage, colour, words in [(0.0, BLACK, "D = 0"), (0.5, BLUE, "D = 0.5"), (1.0, RED, "D = 1")]:
        cut = (1.0 - damage) * F_T
        points = [(-1.2, limit(-1.2, damage)), (0.0, limit(0.0, damage))]
        if cut > 0.0:
            points += [(cut, limit(cut, damage)), (cut, 0.0)]
        a.curve(points, colour, 2.0)
        a.label((-1.2, limit(-1.2, damage)), words, colour, (4, -8))
    a.label((0.0, C), "c", BLACK, (6, -6))
    a.tick("x", F_T, "f_t")
    # Slopes.
    for damage, colour, words, slope in [(0.0, BLACK, "tan φ", TAN_PHI), (1.0, RED, "μ", MU)]:
        low, high = limit(-0.45, damage), limit(-0.75, damage)
        a.curve([(-0.45, low), (-0.75, low), (-0.75, high)], colour, 1.0)
        a.label((-0.6, low), "1", colour, (0, 13), anchor="middle")
        a.label((-0.75, low + 0.5 * slope * 0.3), words, colour, (-5, 4), anchor="end")
    a.label((F_T, 0.3), "cut-off", BLACK, (8, 0))
    d.save("joint-failure.svg")


def damage():
    d = Drawing(460, 300, "Damage over opening and over slip")
    a = Axes(d, (60, 20, 440, 250), (0.0, 1.2), (0.0, 1.12), ("(u − u₀)/u_k,  |δ_p|/δ_k", "D"))
    ways = steps(0.0, 1.0, 48)
    a.curve([(x, softening(x, ZETA)) for x in ways] + [(1.15, 1.0)], BLUE)
    a.curve([(x, softening(x, XI)) for x in ways] + [(1.15, 1.0)], RED)
    a.label((0.345, 0.71), "Q, ζ = 4.38", BLUE)
    a.label((0.72, softening(0.72, XI)), "H, ξ = 1.1", RED, (8, 14))
    # A slip of 0.3 δ_k first, then opening.
    slip = 0.3
    before = softening(slip, XI)
    begins = inverse(before, ZETA)
    a.curve([(0.0, before), (begins, before)], BLACK, 2.4)
    shifted = [(x, softening(x + begins, ZETA)) for x in steps(0.0, 1.0 - begins, 40)]
    a.curve(shifted, GREEN, 1.5, "5 3")
    a.curve([(begins, before), (slip, before)], GREY, 1.0, "2 3")
    d.dot(a.at(slip, before), RED)
    a.label((slip, before), "slip of 0.3 δ_k: D = 0.42", RED, (9, 10))
    a.label((0.004, before), "max", BLACK, (0, 14))
    a.label((0.015, 0.86), "additive", GREEN)
    a.tick("y", 1.0, "1")
    a.tick("x", 1.0, "1")
    a.tick("x", 0.5, "0.5")
    d.save("joint-damage.svg")


def projection():
    d = Drawing(460, 290, "A point against a master facet: foot, normal, gap and slip")

    def place(xi, eta, height=0.0):
        """An oblique view of the plane of the facet."""
        return (215 + 125 * xi + 55 * eta, 205 - 48 * eta - 14 * xi - height)

    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    d.path([place(*c) for c in corners], BLACK, 1.4, fill=FILL, close=True)
    for eta in (-0.5, 0.0, 0.5):
        d.path([place(-1, eta), place(1, eta)], LIGHT, 0.8)
    for xi in (-0.5, 0.0, 0.5):
        d.path([place(xi, -1), place(xi, 1)], LIGHT, 0.8)
    d.arrow(place(-1, -1), place(-0.35, -1), GREY, 1.2)
    d.arrow(place(-1, -1), place(-1, -0.2), GREY, 1.2)
    x, y = place(-0.35, -1)
    d.text((x - 4, y + 16), "ξ", GREY)
    x, y = place(-1, -0.2)
    d.text((x - 14, y + 2), "η", GREY)
    foot, anchor = place(0.3, 0.1), place(-0.45, -0.3)
    point = place(0.3, 0.1, 95)
    d.path([point, foot], BLACK, 1.2, "4 3")
    d.dot(point, BLUE)
    d.text((point[0] + 8, point[1] - 4), "x_s, point of the slave facet", BLUE)
    d.dot(foot, BLACK)
    d.text((foot[0] - 2, foot[1] + 17), "foot x_m", BLACK)
    d.dot(anchor, RED)
    d.text((anchor[0] - 4, anchor[1] + 17), "y, anchor", RED, "middle")
    d.arrow(anchor, foot, RED, 1.8)
    d.text((0.5 * (anchor[0] + foot[0]) - 8, 0.5 * (anchor[1] + foot[1]) - 8), "Δδ", RED, "end")
    left = place(0.3, 0.1, 3)[0] - 14
    d.arrow((left, point[1]), (left, foot[1]), BLUE, 1.0, both=True)
    d.text((left - 6, 0.5 * (point[1] + foot[1]) + 4), "u", BLUE, "end")
    d.arrow(foot, (foot[0], foot[1] - 52), GREEN, 2.0)
    d.text((foot[0] + 7, foot[1] - 44), "n", GREEN)
    t_1 = place(0.72, 0.1)
    d.arrow(foot, t_1, GREEN, 2.0)
    d.text((t_1[0] + 5, t_1[1] + 4), "t₁", GREEN)
    t_2 = place(0.3, 0.72)
    d.arrow(foot, t_2, GREEN, 2.0)
    d.text((t_2[0] + 6, t_2[1] + 2), "t₂", GREEN)
    x, y = place(1, -1)
    d.text((x - 4, y + 18), "master facet", BLACK, "end")
    d.save("contact-projection.svg")


def rim():
    d = Drawing(460, 230, "A point without bond is moved to the rim of its master")
    d.path([(30, 130), (270, 130), (270, 205), (30, 205)], BLACK, 1.4, fill=FILL, close=True)
    d.text((45, 190), "master", BLACK)
    d.path([(90, 50), (390, 50), (390, 126), (90, 126)], BLACK, 1.4, fill="#f6efe4", close=True)
    d.text((105, 72), "slave facet hangs over the rim", BLACK)
    d.dot((94, 126), BLUE, 4)
    d.dot((386, 126), BLUE, 4, "white")
    d.arrow((378, 113), (286, 113), RED, 1.6)
    d.text((332, 103), "moved to the rim", RED, "middle")
    d.dot((278, 126), BLUE, 4)
    d.arrow((94, 154), (94, 133), BLUE, 1.6)
    d.arrow((278, 154), (278, 133), BLUE, 1.6)
    d.text((386, 146), "place at rest", BLUE, "middle")
    d.text((288, 172), "9e-4 of a half facet", GREY)
    d.text((288, 186), "beyond the rim", GREY)
    d.save("contact-rim.svg")


def entry():
    d = Drawing(460, 250, "Which ways through the parameters of a face make contact")
    a = Axes(d, (40, 20, 440, 225), (-1.9, 1.9), (-1.0, 1.1), ("", "gap"))
    x, y = a.at(1.9, 0.0)
    d.text((x, y - 8), "ξ", anchor="end")
    d.path([a.at(-1, 0), a.at(-1, -1), a.at(1, -1), a.at(1, 0)], BLACK, 1.0, fill=FILL)
    d.path([a.at(-1, 0), a.at(1, 0)], BLACK, 4.0)
    a.label((0.45, -0.02), "face", BLACK, (4, 16))
    low = -0.17
    d.path([a.at(-1.85, low), a.at(-1.0, low)], GREY, 1.0, "2 3")
    ways = [
        ((-0.95, 0.85), (-0.25, -0.75), BLUE),
        ((1.75, -0.6), (0.55, -0.6), RED),
        ((-1.75, -0.06), (-0.6, -0.12), GREEN),
    ]
    for start, end, colour in ways:
        d.arrow(a.at(*start), a.at(*end), colour, 1.8)
    t = 0.85 / 1.6
    d.dot(a.at(-0.95 + 0.7 * t, 0.0), BLUE, 4)
    a.label((0.0, 0.5), "through the face: contact", BLUE, (12, 0))
    d.dot(a.at(-1.0, -0.06 - 0.06 * 0.75 / 1.15), GREEN, 4)
    a.label((-1.88, -0.4), "over the rim,", GREEN)
    a.label((-1.88, -0.4), "flush: carried", GREEN, (0, 15))
    a.label((1.03, -0.6), "from the side:", RED, (4, 18))
    a.label((1.03, -0.6), "another face", RED, (4, 32))
    d.save("contact-entry.svg")


def iteration():
    """Pressure over penetration: the law, the line of the body, and five iterates."""
    d = Drawing(480, 330, "Fixed point of the shifted penalty")
    a = Axes(d, (90, 20, 465, 285), (0.0, 1.25), (0.0, 1.15), ("penetration −u", "pressure t = −σ"))
    law, soft, body, reach = 5.0, 1.0, 1.0, 1.15

    def on_body(gap):
        return body * (reach - gap)

    a.curve([(0.0, 0.0), (0.22, 1.1)], BLACK, 2.2)
    a.curve([(0.08, on_body(0.08)), (reach, 0.0)], GREY, 1.6)
    pressure = 0.0
    for k in range(5):
        start = (1.0 - soft / law) * pressure
        gap = (body * reach - start) / (body + soft)
        pressure = on_body(gap)
        if k < 3:
            a.curve([(0.0, start), (gap, soft * gap + start)], BLUE, 1.1, "4 3")
            a.label((gap, pressure), str(k + 1), BLUE, (9, 4))
        if k == 1:
            a.tick("y", start, "(1 − k′/k) t₁", BLUE)
        d.dot(a.at(gap, pressure), BLUE, 3.5, "white")
    exact = body * reach / (law + body)
    d.dot(a.at(exact, law * exact), RED, 4)
    a.curve([(exact, law * exact), (0.46, 0.94)], RED, 0.8)
    a.label((0.47, 0.925), "fixed point: t = k |u|", RED)
    a.label((0.22, 1.1), "law, slope k", BLACK, (8, 13))
    a.label((0.75, on_body(0.75)), "body in balance", GREY, (10, -2))
    a.label((0.34, 0.34), "slope k′", BLUE, (10, 10))
    d.save("shifted-iteration.svg")


def envelope():
    """Tension over the gap of one iterate: the opening that the law reads."""
    d = Drawing(480, 300, "The opening that an iterate beyond the envelope reads")
    a = Axes(d, (85, 20, 465, 250), (0.0, 1.15), (0.0, 1.5), ("gap", "σ"))
    strength, soft, law = 0.8, 1.3, 16.0
    gap = 0.95
    mixed = soft * gap
    a.curve([(0.0, 0.0), (strength / law, strength), (1.1, strength)], BLACK, 2.2)
    a.curve([(0.0, 0.0), (gap + 0.08, soft * (gap + 0.08))], BLUE, 1.4, "5 3")
    d.dot(a.at(gap, mixed), BLUE, 3.5, "white")
    d.dot(a.at(gap, strength), RED)
    a.curve([(gap, mixed), (gap, 0.0)], GREY, 1.0, "2 3")
    a.tick("x", gap, "u")
    a.tick("y", strength, "(1−D) f_t")
    a.label((gap, mixed), "T", BLUE, (-8, -4), anchor="end")
    a.label((0.36, soft * 0.36), "slope k′", BLUE, (10, 10))
    a.label((strength / law, 0.6), "slope k", BLACK, (4, 0))
    a.label((0.25, strength), "envelope", BLACK, (0, -7))
    first = strength / soft
    y = 0.12
    d.arrow(a.at(first, y), a.at(gap, y), RED, 1.2, both=True)
    a.curve([(first, strength), (first, 0.0)], GREY, 1.0, "2 3")
    a.label((first, y), "(T − (1−D) f_t)/k′", RED, (-6, 4), anchor="end")
    d.save("shifted-envelope.svg")


if __name__ == "__main__":
    for draw in (tension, shear, failure, damage, projection, rim, entry, iteration, envelope):
        draw()
