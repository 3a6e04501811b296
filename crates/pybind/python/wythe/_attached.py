"""Ties, layers, floors, settlements and sections, exported by :mod:`wythe.build`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from wythe._parts import Part, Quantity, _part

#: Coordinates of a point [mm].
Point = Sequence[Quantity]


def tie(
    name: str,
    points: Sequence[Point] | None = None,
    *,
    E: Quantity,
    along: str | None = None,
    courses: Sequence[int] | None = None,
    area: Quantity | None = None,
    diameter: Quantity | None = None,
    bars: int | None = None,
    f_y: Quantity | None = None,
    hardening: Quantity | None = None,
    rupture: float | None = None,
    compression: bool | None = None,
    prestress: Quantity | None = None,
    step: str | None = None,
    bond: str | None = None,
    unbonded: Quantity | None = None,
) -> Part:
    """A rod or cable, or bars in bed joints, one of ``ties`` of :func:`wall` or :func:`blocks`.

    Parameters
    ----------
    points
        Its line at rest [mm]; or the wall ``along`` which bars lie in the bed joints on ``courses``, from 0.
    E
        Young's modulus [MPa].
    area, diameter, bars
        Area of all bars [mm^2], or the diameter of one [mm]; number of equal bars.
    f_y, hardening, rupture
        Yield stress [MPa], its slope over the plastic strain [MPa], strain at which it breaks.
    compression
        Whether it carries compression.
    prestress, step
        Force after stressing [N], and the name of the step in which it is installed.
    bond, unbonded
        ``"anchored"`` at its ends or ``"bonded"``; length over which a bonded one is free at each joint [mm].
    """
    return _part(
        name=name,
        points=points,
        along=along,
        courses=courses,
        area=area,
        diameter=diameter,
        bars=bars,
        E=E,
        f_y=f_y,
        hardening=hardening,
        rupture=rupture,
        compression=compression,
        prestress=prestress,
        step=step,
        bond=bond,
        unbonded=unbonded,
    )


def layer(
    name: str,
    on: str | Sequence[str],
    thickness: Quantity,
    material: str,
    interface: str,
    *,
    unbonded: Quantity | None = None,
) -> Part:
    """A layer on plane faces, bonded to them by an interface; one of ``layers`` of :func:`wall` or :func:`blocks`.

    ``thickness`` is in mm; ``unbonded`` is the length across each joint that is not bonded [mm].
    """
    return _part(
        name=name, on=on, thickness=thickness, material=material, interface=interface, unbonded=unbonded
    )


def floor(
    name: str,
    on: str | Sequence[str],
    *,
    load: Quantity | None = None,
    mass: Quantity | None = None,
    rigid: bool | None = None,
    axial: Quantity | None = None,
    shear: Quantity | None = None,
    spacing: Quantity | None = None,
) -> Part:
    """A floor that loads the walls on which it rests, and ties them; one of ``floors`` of :func:`wall` or
    :func:`blocks`.

    Parameters
    ----------
    on
        Faces on which it rests, sides opposite each other.
    load, mass
        Weight over its area in plan [MPa]; or its mass in all [tonne].
    rigid
        Whether it is a concrete slab, instead of ``axial`` and ``shear``.
    axial, shear
        Stiffness along the span for each width, and against shear in its plane [N/mm].
    spacing
        Largest distance of the springs that stand for joists [mm].
    """
    return _part(
        name=name, on=on, load=load, mass=mass, rigid=rigid, axial=axial, shear=shear, spacing=spacing
    )


def settlement(
    name: str,
    on: str | Sequence[str],
    *,
    along: str | None = None,
    trough: Mapping[str, Quantity] | None = None,
    tilt: Mapping[str, Quantity] | None = None,
    table: Mapping[str, Sequence[Quantity]] | None = None,
) -> Part:
    """Ground that moves by a shape; one of ``settlements`` of :func:`wall` or :func:`blocks`. A step moves it by
    ``drive(displacement, settlement=name)``.

    Parameters
    ----------
    on
        Blocks or faces on it.
    along
        Axis along which the shape varies, ``"x"`` by default.
    trough, tilt, table
        One shape: ``{"centre": 2000, "inflection": 800}``, ``{"from": 0, "to": 4000}`` or
        ``{"at": [0, 1000], "values": [0, 1]}`` [mm].
    """
    return _part(name=name, on=on, along=along, trough=trough, tilt=tilt, table=table)


def section(
    name: str,
    through: Point | None = None,
    normal: str | Sequence[float] | None = None,
    *,
    of: str | Sequence[str] | None = None,
    box: Sequence[Point] | None = None,
    piers: str | None = None,
) -> Part:
    """A plane cut whose force and moment are columns of the history; one of ``sections`` of :func:`wall` or
    :func:`blocks`.

    Parameters
    ----------
    through, normal
        A point of the plane at rest [mm], and its direction, ``"z"`` by default.
    of, box
        Bodies or walls that are cut; two corners between which elements are cut [mm].
    piers
        A wall with openings: a section for each of its piers and spandrels, instead of ``through``.
    """
    return _part(name=name, through=through, normal=normal, of=of, box=box, piers=piers)
