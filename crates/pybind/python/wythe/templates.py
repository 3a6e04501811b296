"""Template models: each runs without changes, and its parameters are the most common ones.

Every parameter is a quantity: a number in base units (mm, MPa, degrees) or a text with its unit
(``"2.12 MPa"``). ``with_`` changes all other values of a model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from wythe import _wythe
from wythe._model import Model, Value

__all__ = ["arch", "column", "couplet", "dry_wall", "names", "out_of_plane", "shear_wall", "text"]

#: A number in base units, or a text with a unit.
Quantity = float | str


def names() -> dict[str, str]:
    """Names of the templates, as for ``wythe new --template``, with their descriptions."""
    return {name: about for name, about, _ in _wythe.templates()}


def text(name: str) -> str:
    """The commented deck of a template."""
    for known, _, deck in _wythe.templates():
        if known == name:
            return deck
    raise ValueError(f"name: expected one of {', '.join(names())}, got {name!r}")


def _made(name: str, changes: Mapping[str, Value | None]) -> Model:
    said = {key: value for key, value in changes.items() if value is not None}
    return Model.from_toml(text(name)).with_({"title": name.replace("-", " "), **said})


def shear_wall(
    preload: Quantity | None = None,
    drive: Quantity | None = None,
    *,
    length: Quantity | None = None,
    courses: int | None = None,
    mesh: str | Sequence[int] | None = None,
    vertical: str | None = None,
) -> Model:
    """A wall under vertical load, pushed in its plane until it cracks and crushes.

    Parameters
    ----------
    preload
        Pressure on the top [MPa].
    drive
        Displacement of the top [mm].
    length
        Length of the wall [mm].
    courses
        Number of courses.
    mesh
        ``"coarse"``, ``"fine"``, or numbers of elements along the length, height and thickness of a brick.
    vertical
        ``"locked"``: the top keeps its height after the preload; ``"free"``: it moves under its load.
    """
    return _made(
        "shear-wall",
        {
            "steps.0.top_pressure": preload,
            "steps.1.displacement": drive,
            "steps.1.vertical": vertical,
            "wall.length": length,
            "wall.courses": courses,
            "wall.mesh": mesh,
        },
    )


def couplet(
    displacement: Quantity | None = None,
    *,
    f_t: Quantity | None = None,
    mesh: str | Sequence[int] | None = None,
) -> Model:
    """Two bricks with a joint, pulled apart.

    Parameters
    ----------
    displacement
        Displacement after the peak [mm].
    f_t
        Tensile strength of the joint [MPa].
    mesh
        ``"coarse"``, ``"fine"``, or numbers of elements along the length, height and thickness of a brick.
    """
    return _made(
        "couplet",
        {
            "steps.1.displacement": displacement,
            "interfaces.joint.f_t": f_t,
            "wall.mesh": mesh,
        },
    )


def out_of_plane(
    preload: Quantity | None = None,
    drive: Quantity | None = None,
    *,
    length: Quantity | None = None,
    courses: int | None = None,
    mesh: str | Sequence[int] | None = None,
) -> Model:
    """A strip of wall under vertical load, pushed out of its plane.

    Parameters
    ----------
    preload
        Pressure on the top [MPa].
    drive
        Displacement of the top normal to the wall [mm].
    length
        Length of the strip [mm].
    courses
        Number of courses.
    mesh
        ``"coarse"``, ``"fine"``, or numbers of elements along the length, height and thickness of a brick.
    """
    return _made(
        "out-of-plane",
        {
            "steps.0.top_pressure": preload,
            "steps.1.displacement": drive,
            "wall.length": length,
            "wall.courses": courses,
            "wall.mesh": mesh,
        },
    )


def arch(
    tilt: Quantity | None = None,
    *,
    radius: Quantity | None = None,
    thickness: Quantity | None = None,
    voussoirs: int | None = None,
    embrace: Quantity | None = None,
    friction: float | None = None,
) -> Model:
    """A semicircular arch of dry voussoirs under its weight, tilted.

    Parameters
    ----------
    tilt
        Inclination of the ground at the end [degrees].
    radius
        Radius of the centre line [mm].
    thickness
        Radial thickness [mm].
    voussoirs
        Number of voussoirs.
    embrace
        Angle of embrace [degrees]; 180 is a semicircle.
    friction
        Friction coefficient of the joints.
    """
    return _made(
        "arch",
        {
            "steps.1.angle": tilt,
            "arch.radius": radius,
            "arch.thickness": thickness,
            "arch.voussoirs": voussoirs,
            "arch.angle": embrace,
            "interfaces.dry.mu": friction,
            "interfaces.dry.tan_phi": friction,
        },
    )


def dry_wall(tilt: Quantity | None = None, *, friction: float | None = None) -> Model:
    """Dry blocks in running bond on a tilting table.

    Parameters
    ----------
    tilt
        Inclination of the table at the end [degrees].
    friction
        Friction coefficient of the joints.
    """
    return _made(
        "dry-wall",
        {
            "steps.1.angle": tilt,
            "interfaces.dry.mu": friction,
            "interfaces.dry.tan_phi": friction,
        },
    )


def column(
    duration: Quantity | None = None,
    *,
    friction: float | None = None,
    velocity: Sequence[Quantity] | None = None,
) -> Model:
    """A column of loose blocks after an impact, which slide and rock.

    Parameters
    ----------
    duration
        Duration of the motion [s].
    friction
        Friction coefficient of the joints.
    velocity
        Initial velocity of the top block: x, y, z [mm/s].
    """
    return _made(
        "column",
        {
            "steps.1.duration": duration,
            "interfaces.dry.mu": friction,
            "interfaces.dry.tan_phi": friction,
            "blocks.2.velocity": velocity,
        },
    )
