"""Loads and steps, exported by :mod:`wythe.build`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypedDict

import numpy.typing as npt

from wythe._model import Value

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: A number in base units, or a text with a unit.
Quantity = float | str
#: Part of a deck.
Part = dict[str, Any]
#: Rows of numbers.
Rows = Sequence[Sequence[float]] | npt.NDArray[Any]


class MotionOptions(TypedDict, total=False):
    """Further keys of a step (docs/reference/deck.md, ``steps``)."""

    name: str
    viscosity: Quantity
    tangent: str
    control: Mapping[str, Value]
    alpha: float
    rayleigh: Mapping[str, Quantity]
    ground: Mapping[str, str]
    ground_unit: Quantity
    ground_factor: Mapping[str, float]
    ground_start: Quantity
    loads: Sequence[Part]
    amplitude: Rows | str
    increments: Mapping[str, float]
    tolerance: Mapping[str, float]


class StepOptions(MotionOptions, total=False):
    """Further keys of a step whose duration and procedure are optional."""

    duration: Quantity
    procedure: str


def _part(**keys: Any) -> Part:
    return {key: value for key, value in keys.items() if value is not None}


def preload(
    pressure: Quantity,
    *,
    face: str | Sequence[str] | None = None,
    beam: str | None = None,
    free: Sequence[str] | None = None,
    **options: Unpack[StepOptions],
) -> Part:
    """A step that applies a pressure [MPa] to the top of a wall, a face of blocks, or a beam.

    Parameters
    ----------
    pressure
        Pressure [MPa], compression positive.
    face, beam
        Loaded face in a scene of blocks, or a beam (:func:`beam`).
    free
        Directions in which the face of blocks may move.
    options
        Further keys of the step: ``name``, ``duration``, ``procedure``, ``increments``, ...
    """
    key = "top_pressure" if face is None and beam is None else "pressure"
    return {"kind": "preload", key: pressure, **_part(face=face, beam=beam, free=free), **options}


def drive(
    displacement: Quantity | None = None,
    direction: str | None = None,
    *,
    cycles: Mapping[str, Any] | None = None,
    face: str | Sequence[str] | None = None,
    spring: str | None = None,
    beam: str | None = None,
    settlement: str | None = None,
    vertical: str | None = None,
    free: Sequence[str] | None = None,
    stop: Mapping[str, Quantity] | None = None,
    **options: Unpack[StepOptions],
) -> Part:
    """A step that drives the top of a wall, a face of blocks, a beam, the far end of a spring or the ground [mm].

    Parameters
    ----------
    displacement
        Displacement in this step [mm]; or ``cycles``.
    direction
        ``"x"`` along the wall (default), ``"y"`` through it or ``"z"`` upwards; ``-`` reverses the direction. The ground
        goes down by default.
    cycles
        Cyclic drive, such as ``{"amplitudes": ["1 mm", "2 mm"], "repeat": 2}``.
    face, spring, beam, settlement
        Driven part, if it is not the top of a clamped wall.
    vertical
        Vertical motion of the top of a wall: ``"locked"`` or ``"free"``.
    free
        Directions in which a face of blocks may move.
    stop
        Conditions that end the step early: ``{"below_peak": 0.8}``, ``{"displacement": "3 mm"}``.
    options
        Further keys of the step: ``name``, ``viscosity``, ``procedure``, ``increments``, ...
    """
    return {
        "kind": "drive",
        "direction": direction or ("x" if settlement is None else "-z"),
        **_part(displacement=displacement, cycles=cycles),
        **_part(face=face, spring=spring, beam=beam, settlement=settlement),
        **_part(vertical=vertical, free=free, stop=stop),
        **options,
    }


def load(
    name: str,
    on: str | Sequence[str] | None = None,
    *,
    near: Sequence[Quantity] | None = None,
    line: tuple[Sequence[Quantity], Sequence[Quantity]] | None = None,
    within: Quantity | None = None,
    pressure: Quantity | None = None,
    follower: bool | None = None,
    traction: Sequence[Quantity] | None = None,
    force: Sequence[Quantity] | None = None,
    line_force: Sequence[Quantity] | None = None,
) -> Part:
    """A load of a step, one of ``loads``: its place and its value at the end of the step.

    Parameters
    ----------
    name
        Name by which later steps change its value.
    on
        Faces; for a ``force`` also blocks.
    near, line, within
        The node nearest to a point; or the nodes within this distance [mm] of the line between two points.
    pressure, follower
        Pressure on faces [MPa], compression positive; it rotates with them unless ``follower`` is false.
    traction
        Traction on the area of faces at rest [MPa].
    force
        Total force [N].
    line_force
        Force per length of the line [N/mm].
    """
    begin, end = line if line is not None else (None, None)
    place = _part(on=on, near=near, to=end, within=within) | ({} if begin is None else {"from": begin})
    value = _part(pressure=pressure, follower=follower, traction=traction, force=force, line_force=line_force)
    return {"name": name, **place, **value}


def loading(
    *changed: Part, stop: Mapping[str, Quantity] | None = None, **options: Unpack[StepOptions]
) -> Part:
    """A step that only changes loads (:func:`load`)."""
    return {"kind": "load", "loads": list(changed), **_part(stop=stop), **options}


def gravity(
    gravity: Quantity | None = None,
    *,
    angle: Quantity | None = None,
    axis: str | None = None,
    **options: Unpack[StepOptions],
) -> Part:
    """A step in which gravity grows from zero; 9810 mm/s^2 by default. The ground may be inclined."""
    return {"kind": "gravity", **_part(gravity=gravity, angle=angle, axis=axis), **options}


def tilt(angle: Quantity, axis: str | None = None, **options: Unpack[StepOptions]) -> Part:
    """A step that tilts the ground to an angle [degrees] about an axis (``"y"``: +x goes down)."""
    return {"kind": "tilt", "angle": angle, **_part(axis=axis), **options}


def free(
    duration: Quantity,
    procedure: str = "dynamic",
    *,
    gravity: Quantity | None = None,
    angle: Quantity | None = None,
    axis: str | None = None,
    **options: Unpack[MotionOptions],
) -> Part:
    """A step of free motion over a duration [s], under inertia and ``ground`` accelerations. Gravity and inclination,
    if given, act from its start.
    """
    return {
        "kind": "free",
        "duration": duration,
        "procedure": procedure,
        **_part(gravity=gravity, angle=angle, axis=axis),
        **options,
    }
