"""Decks of the blind predictions: what rule.md makes of a row of walls.csv."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
DENSITY = {"clay": 1800, "CS": 1900, "sandstone": 2300, "granite": 2600}
LABORATORY = {
    "Magenes2008": "Pavia", "MagenesCalvi1992": "Pavia", "Graziotti2016a": "Pavia", "Graziotti2016b": "Pavia",
    "Anthoine1995": "Ispra", "AbramsShah1992": "Urbana", "Bosiljkov2003": "Ljubljana", "Manzouri1995": "Boulder",
    "Zilch2008": "Munich", "Fehling2007": "Kassel", "Vasconcelos2005": "Guimarães", "Vasconcelos2009": "Guimarães",
    "Lourenco2005": "Guimarães", "Godio2019": "Lausanne",
}  # fmt: skip


@dataclass(frozen=True)
class Rule:
    """Inputs that the sensitivity varies: factors on what a wall has, or constants of rule.md."""

    modulus: float = 1.0
    strength: float = 1.0
    cohesion: float = 1.0
    friction: float = 1.0
    tension: float = 0.05
    opening: float = 0.012
    slip: float = 0.093


@dataclass(frozen=True)
class Wall:
    """A row of walls.csv, and what the rule makes of it: lengths in mm, stresses in MPa."""

    row: dict[str, str]
    rule: Rule = Rule()

    def text(self, column: str) -> str:
        return self.row[column]

    def number(self, column: str, default: float = math.nan) -> float:
        return float(self.row[column]) if self.row[column] else default

    @property
    def name(self) -> str:
        return f"{self.row['source']} {self.row['wall']}"

    @property
    def height(self) -> float:
        return self.number("H_m") * 1e3

    @property
    def length(self) -> float:
        return self.number("L_m") * 1e3

    @property
    def thickness(self) -> float:
        return self.number("t_m") * 1e3

    @property
    def course(self) -> float:
        return self.height / self.number("courses")

    @property
    def bed_joint(self) -> float:
        if self.text("bed") != "GP":
            return 0.0
        joint = self.course - self.number("h_b_mm")
        return joint if 5.0 <= joint <= 15.0 else 10.0

    @property
    def head_joint(self) -> float:
        return min(self.bed_joint, 10.0)

    @property
    def unit_length(self) -> float:
        halves = round(2.0 * (self.length + self.head_joint) / (self.number("l_b_mm") + self.head_joint))
        return 2.0 * (self.length + self.head_joint) / halves - self.head_joint

    @property
    def zero_moment(self) -> float:
        return self.number("H0_over_H") * self.height

    @property
    def modulus(self) -> float:
        return self.rule.modulus * self.number("E_m_MPa", 700.0 * self.number("f_m_MPa"))

    @property
    def strength(self) -> float:
        return self.rule.strength * self.number("f_m_MPa")

    def moduli(self) -> tuple[float, float]:
        """E of unit and mortar: in series over a course they have the modulus of the masonry."""
        joint, unit = self.bed_joint, self.course - self.bed_joint
        if joint == 0.0:
            return self.number("E_b_MPa", self.modulus), math.nan
        if self.text("E_b_MPa"):
            e_b = self.number("E_b_MPa")
            return e_b, joint / (self.course / self.modulus - unit / e_b)
        ratio = min(max(1.5 * self.number("f_b_MPa") / self.number("f_mo_MPa"), 1.0), 20.0)
        e_b = self.modulus * (unit + ratio * joint) / self.course
        return e_b, e_b / ratio

    @property
    def cohesion(self) -> float:
        return self.rule.cohesion * self.number("f_v0_MPa", 0.25)

    @property
    def friction(self) -> float:
        return round(self.rule.friction * self.number("mu", 0.6), 6)

    @property
    def weight(self) -> float:
        """[N]"""
        return DENSITY[self.text("unit_kind")] * 1e-12 * 9810.0 * self.length * self.thickness * self.height

    @property
    def rigid_limit(self) -> float:
        """Largest force of a rigid block under its load and weight [kN]."""
        load = self.number("sigma_0_MPa") * self.length * self.thickness + self.weight
        return load * self.length / (2.0 * self.zero_moment) / 1e3

    def measured(self, quantity: str) -> float:
        """Mean of both directions of `V` [kN] or `drift` [%]."""
        unit = {"V": "kN", "drift": "pct"}[quantity]
        values = [self.number(f"{quantity}_{sign}_{unit}") for sign in ("plus", "minus")]
        given = [v for v in values if not math.isnan(v)]
        return sum(given) / len(given)

    @property
    def modes(self) -> set[str]:
        """Letters of the test's mode: F, S, L (sliding)."""
        text = self.text("mode").replace("SL", "L").replace("TC", "F").replace("R", "F").replace("G", "S")
        return {letter for letter in text if letter in "FSL"}


def walls() -> list[Wall]:
    with (HERE / "walls.csv").open() as file:
        return [Wall(row) for row in csv.DictReader(file)]


def compression_rows(f_c: float) -> str:
    """Rows over an inelastic strain for a reference length of 1 mm: beyond the peak a strain is a displacement [mm]."""
    energy = 1.6 * f_c if f_c < 12.0 else 15.0 + 0.43 * f_c - 0.0036 * f_c**2
    end = 0.001 + energy / (0.55 * f_c)
    return f"[[{0.8 * f_c:.5g}, 0, 0], [{f_c:.5g}, 0.001, 0], [{0.1 * f_c:.5g}, {end:.6g}, 0.9]]"


def tension_rows(f_t: float) -> str:
    crack = 0.029
    return f"[[{f_t:.5g}, 0, 0], [{f_t / 3:.5g}, {0.8 * crack:.6g}, 0.65], [{0.02 * f_t:.5g}, {3.6 * crack:.6g}, 0.95]]"


def material(name: str, e: float, f_t: float, f_c: float, density: float) -> str:
    return f"""[materials.{name}]
E = {e:.6g}
nu = 0.2
density = "{density} kg/m^3"
tension = {tension_rows(f_t)}
compression = {compression_rows(f_c)}
reference_length = "1 mm"
crack_band = "projected"
"""


def joint(wall: Wall) -> str:
    mu = wall.friction
    if wall.text("bed") == "dry":
        return f"[interfaces.joint]\nf_t = 0\nc = 0\ntan_phi = {mu}\nmu = {mu}\n{dry_stiffness(wall)}"
    c = wall.cohesion
    bonded = f"""[interfaces.joint]
f_t = {c / 1.4:.5g}
c = {c:.5g}
tan_phi = {mu}
mu = {mu}
zeta = 4.38
xi = 1.1
G_I = "{wall.rule.opening} N/mm"
G_II = "{wall.rule.slip * c:.5g} N/mm"
"""
    if wall.text("head") == "U":
        bonded += f"\n[interfaces.dry]\nf_t = 0\nc = 0\ntan_phi = {mu}\nmu = {mu}\n"
    return bonded


def dry_stiffness(wall: Wall) -> str:
    k_n = 1.0 / (wall.course * (1.0 / wall.modulus - 1.0 / wall.number("E_b_MPa")))
    return f'normal_stiffness = "{k_n:.5g} N/mm^3"\nshear_stiffness = "{0.4 * k_n:.5g} N/mm^3"\n'


def deck(wall: Wall) -> str:
    e_b, e_j = wall.moduli()
    f_m, density = wall.strength, DENSITY[wall.text("unit_kind")]
    parts = [f'format = 1\ntitle = "{wall.name}"\n']
    parts.append(material("unit", e_b, wall.rule.tension * wall.number("f_b_MPa"), f_m, density))
    mortar = ""
    if wall.bed_joint > 0.0:
        f_t = max(0.1 * wall.number("f_mo_MPa"), wall.cohesion / 1.4)
        parts.append(material("mortar", e_j, f_t, f_m, density))
        mortar = 'mortar_material = "mortar"\n'
    parts.append('[materials.ground]\nE = "30 GPa"\nnu = 0.2\ndensity = "2400 kg/m^3"\n')
    parts.append(joint(wall))
    heads = 'head_interface = "dry"\n' if wall.text("head") == "U" else ""
    points = '[contact]\npoints = "corner"\n' if wall.text("bed") == "dry" else ""
    mesh = "mesh = [4, 1, 1]\n" if wall.text("bed") == "dry" else ""
    over = (wall.unit_length + wall.head_joint) / 2.0
    parts.append(f"""{points}
[wall]
unit = [{wall.unit_length:.8g}, {wall.thickness:.6g}, {wall.course - wall.bed_joint:.8g}]
bed_joint = {wall.bed_joint:.8g}
head_joint = {wall.head_joint:.8g}
length = {wall.length:.8g}
courses = {wall.text("courses")}
overlap = {over:.8g}
unit_material = "unit"
{mortar}{heads}{mesh}interface = "joint"
clamped = false

[[blocks]]
name = "ground"
size = [{wall.length + 200:.8g}, {wall.thickness:.6g}, 100]
at = [-100, 0, -100]
material = "ground"
mesh = [{max(8, round(wall.length / 60))}, 1, 1]

[[contacts]]
slave = "wall.bottom"
master = "ground.top"
interface = "joint"

[[supports]]
on = "ground"
""")
    level = wall.zero_moment < wall.height
    depth = 100.0 if level else max(20.0, 2.0 * (wall.zero_moment - wall.height))
    parts.append(f"""[[beams]]
name = "beam"
on = "wall.top"
depth = {depth:.6g}
rotation = "{"level" if level else "free"}"
interface = "joint"

[[steps]]
kind = "gravity"

[[steps]]
kind = "preload"
beam = "beam"
pressure = {wall.number("sigma_0_MPa"):.6g}

[[steps]]
kind = "drive"
beam = "beam"
direction = "x"
displacement = {0.01 * wall.height:.6g}
{'free = ["z"]' if level else ""}
stop = {{ below_peak = 0.8 }}

[output]
mcap = false
""")
    return "\n".join(parts)


def stem(wall: Wall) -> str:
    return wall.name.replace(" ", "-").replace(".", "_")
