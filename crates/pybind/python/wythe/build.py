"""Models from parts: materials, joints, walls, arches, blocks, steps.

Each function gives a part of a deck with the deck's own keys (docs/deck.md); :func:`wall`, :func:`arch` and
:func:`blocks` put them together. A quantity is a number in base units (N, mm, MPa, tonne, s; degrees) or a text
with its unit. What is not given has the deck's default.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypedDict

import numpy.typing as npt

from wythe._model import Model, Value

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = [
    "arch",
    "beam",
    "block",
    "blocks",
    "contact",
    "damage_plasticity",
    "dry_joint",
    "elastic",
    "free",
    "gravity",
    "joint",
    "load",
    "loading",
    "mesh",
    "preload",
    "probe",
    "push",
    "spring",
    "support",
    "symmetry",
    "tilt",
    "wall",
]

#: A number in base units, or a text with a unit.
Quantity = float | str
#: Part of a deck.
Part = dict[str, Any]
#: Rows of numbers.
Rows = Sequence[Sequence[float]] | npt.NDArray[Any]


class MotionOptions(TypedDict, total=False):
    """Further keys of a step (docs/deck.md, ``steps``)."""

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
    """Further keys of a step that need not be one in time."""

    duration: Quantity
    procedure: str


def _part(**keys: Any) -> Part:
    return {key: value for key, value in keys.items() if value is not None}


def elastic(E: Quantity, nu: float, *, density: Quantity | None = None) -> Part:
    """A linear elastic material: Young's modulus [MPa], Poisson's ratio, density [tonne/mm^3]."""
    return _part(E=E, nu=nu, density=density)


def damage_plasticity(
    E: Quantity,
    nu: float,
    tension: Rows,
    compression: Rows,
    *,
    reference_length: Quantity | None = None,
    dilation_angle: Quantity | None = None,
    eccentricity: float | None = None,
    fb0_fc0: float | None = None,
    K_c: float | None = None,
    tension_recovery: float | None = None,
    compression_recovery: float | None = None,
    viscosity: Quantity | None = None,
    interpolation: str | None = None,
    density: Quantity | None = None,
) -> Part:
    """A material that cracks and crushes: concrete damaged plasticity.

    Parameters
    ----------
    E, nu
        Young's modulus [MPa], Poisson's ratio.
    tension, compression
        Rows of stress [MPa] (positive), inelastic strain, damage. Shape (rows, 3).
    reference_length
        Size of the elements for which the tables hold [mm].
    """
    return _part(
        E=E,
        nu=nu,
        tension=tension,
        compression=compression,
        reference_length=reference_length,
        dilation_angle=dilation_angle,
        eccentricity=eccentricity,
        fb0_fc0=fb0_fc0,
        K_c=K_c,
        tension_recovery=tension_recovery,
        compression_recovery=compression_recovery,
        viscosity=viscosity,
        interpolation=interpolation,
        density=density,
    )


def joint(
    f_t: Quantity,
    c: Quantity,
    tan_phi: float,
    mu: float,
    *,
    zeta: float,
    xi: float,
    u_k: Quantity | None = None,
    G_I: Quantity | None = None,
    delta_k: Quantity | None = None,
    G_II: Quantity | None = None,
    penalty_factor: float | None = None,
    normal_stiffness: Quantity | None = None,
    shear_stiffness: Quantity | None = None,
    coupling: str | None = None,
    scatter: Mapping[str, float] | None = None,
) -> Part:
    """A bonded joint: it opens under tension, slides under shear, softens, and rubs.

    Parameters
    ----------
    f_t, c
        Tensile strength, cohesion [MPa].
    tan_phi, mu
        Friction of the bond and of the broken joint.
    zeta, xi
        Brittleness in tension and shear.
    u_k, G_I
        Ultimate opening [mm], or the fracture energy [N/mm]: one of both.
    delta_k, G_II
        Ultimate slip [mm], or the fracture energy [N/mm]: one of both.
    penalty_factor, normal_stiffness, shear_stiffness
        Numerical stiffness: a factor of the elements', or both explicitly [N/mm^3].
    scatter
        ``{"cv": 0.3, "seed": 1}``: each unit's own bond strength, lognormal.
    """
    return _part(
        f_t=f_t,
        c=c,
        tan_phi=tan_phi,
        mu=mu,
        zeta=zeta,
        xi=xi,
        u_k=u_k,
        G_I=G_I,
        delta_k=delta_k,
        G_II=G_II,
        penalty_factor=penalty_factor,
        normal_stiffness=normal_stiffness,
        shear_stiffness=shear_stiffness,
        coupling=coupling,
        scatter=scatter,
    )


def dry_joint(
    mu: float,
    *,
    penalty_factor: float | None = None,
    normal_stiffness: Quantity | None = None,
    shear_stiffness: Quantity | None = None,
) -> Part:
    """A joint without bond: friction only."""
    return _part(
        f_t=0,
        c=0,
        tan_phi=mu,
        mu=mu,
        penalty_factor=penalty_factor,
        normal_stiffness=normal_stiffness,
        shear_stiffness=shear_stiffness,
    )


def preload(
    pressure: Quantity,
    *,
    face: str | Sequence[str] | None = None,
    beam: str | None = None,
    free: Sequence[str] | None = None,
    **options: Unpack[StepOptions],
) -> Part:
    """A step that presses the top of a wall, a face of blocks, or a beam, by a pressure [MPa].

    Parameters
    ----------
    pressure
        Compression is positive.
    face, beam
        What is pressed in a scene of blocks: a face, or one of :func:`beam`.
    free
        Directions in which the face of blocks is free.
    options
        Further keys of the step: ``name``, ``duration``, ``procedure``, ``increments``, ...
    """
    key = "top_pressure" if face is None and beam is None else "pressure"
    return {"kind": "preload", key: pressure, **_part(face=face, beam=beam, free=free), **options}


def push(
    displacement: Quantity | None = None,
    direction: str = "x",
    *,
    cycles: Mapping[str, Any] | None = None,
    face: str | Sequence[str] | None = None,
    spring: str | None = None,
    beam: str | None = None,
    vertical: str | None = None,
    free: Sequence[str] | None = None,
    stop: Mapping[str, Quantity] | None = None,
    **options: Unpack[StepOptions],
) -> Part:
    """A step that drives the top of a wall, a face of blocks or the far end of a spring [mm].

    Parameters
    ----------
    displacement
        How far, in this step; or ``cycles``.
    direction
        ``"x"`` along the wall, ``"y"`` through it, ``"z"`` up, each with ``-`` the other way.
    cycles
        To and fro: ``{"amplitudes": ["1 mm", "2 mm"], "repeat": 2}``.
    face, spring, beam
        What is driven in a scene of blocks.
    vertical
        Of a wall: ``"locked"`` or ``"free"``.
    free
        Directions in which a face of blocks is free.
    stop
        What ends the step sooner: ``{"below_peak": 0.8}``, ``{"displacement": "3 mm"}``.
    options
        Further keys of the step: ``name``, ``viscosity``, ``procedure``, ``increments``, ...
    """
    return {
        "kind": "drive",
        "direction": direction,
        **_part(displacement=displacement, cycles=cycles),
        **_part(face=face, spring=spring, beam=beam, vertical=vertical, free=free, stop=stop),
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
    """A load of a step, one of ``loads``: where it acts and its value at the end of the step.

    Parameters
    ----------
    name
        By which later steps say its value anew.
    on
        Faces; of a ``force`` blocks, too.
    near, line, within
        The node nearest to a point; the nodes along the line from one point to another, so near to it [mm].
    pressure, follower
        On faces [MPa], compression positive; it turns with them unless ``follower`` is false.
    traction
        On the area of faces at rest [MPa].
    force
        In all [N].
    line_force
        Over the length of the line [N/mm].
    """
    begin, end = line if line is not None else (None, None)
    place = _part(on=on, near=near, to=end, within=within) | ({} if begin is None else {"from": begin})
    value = _part(pressure=pressure, follower=follower, traction=traction, force=force, line_force=line_force)
    return {"name": name, **place, **value}


def loading(
    *changed: Part, stop: Mapping[str, Quantity] | None = None, **options: Unpack[StepOptions]
) -> Part:
    """A step that changes nothing but loads: those of :func:`load`."""
    return {"kind": "load", "loads": list(changed), **_part(stop=stop), **options}


def gravity(
    gravity: Quantity | None = None,
    *,
    angle: Quantity | None = None,
    axis: str | None = None,
    **options: Unpack[StepOptions],
) -> Part:
    """A step in which the weight grows from nothing; 9810 mm/s^2 if not said. The ground may be inclined."""
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
    """A step in which only time passes [s]: motion under inertia, and under ``ground`` accelerations.
    Gravity and inclination hold from its start on, if they are said.
    """
    return {
        "kind": "free",
        "duration": duration,
        "procedure": procedure,
        **_part(gravity=gravity, angle=angle, axis=axis),
        **options,
    }


def block(
    name: str,
    material: str,
    size: Sequence[Quantity] | None = None,
    at: Sequence[Quantity] | None = None,
    *,
    corners: Sequence[Sequence[Quantity]] | None = None,
    nodes: str | None = None,
    rotate: Mapping[str, Quantity] | None = None,
    mesh: Sequence[int] | None = None,
    rigid: bool | None = None,
    velocity: Sequence[Quantity] | None = None,
    stack: int | None = None,
    interface: str | None = None,
    copies: Sequence[int] | None = None,
    pitch: Sequence[Quantity] | None = None,
) -> Part:
    """A block: a box by its size and lowest corner, a hexahedron by its corners, or a grid of nodes from a file; with
    ``stack`` a column of so many, joined by ``interface``.
    """
    return _part(
        name=name,
        material=material,
        size=size,
        at=at,
        corners=corners,
        nodes=nodes,
        rotate=rotate,
        mesh=mesh,
        rigid=rigid,
        velocity=velocity,
        stack=stack,
        interface=interface,
        copies=copies,
        pitch=pitch,
    )


def beam(
    name: str,
    on: str | Sequence[str],
    depth: Quantity,
    interface: str,
    *,
    rotation: str | None = None,
    density: Quantity | None = None,
) -> Part:
    """A stiff loading beam on level faces, whose ``rotation`` is ``"level"`` or ``"free"``; goes into the table ``beams``
    of :func:`wall` or :func:`blocks`. :func:`preload` and :func:`push` name it.
    """
    return _part(name=name, on=on, depth=depth, interface=interface, rotation=rotation, density=density)


def mesh(
    name: str,
    file: str,
    *,
    units: str | None = None,
    at: Sequence[Quantity] | None = None,
    rotate: Mapping[str, Quantity] | None = None,
    materials: Mapping[str, str] | None = None,
    velocity: Sequence[Quantity] | None = None,
) -> Part:
    """A mesh of Abaqus (.inp) or Gmsh (.msh), its materials by sets where the file does not say them."""
    return _part(
        name=name,
        file=file,
        units=units,
        at=at,
        rotate=rotate,
        materials=materials,
        velocity=velocity,
    )


def contact(
    interface: str,
    slave: str | Sequence[str] | None = None,
    master: str | Sequence[str] | None = None,
) -> Part:
    """Faces that may meet; without names all that touch at rest."""
    return _part(interface=interface, slave=slave, master=master)


def support(
    on: str | Sequence[str],
    fixed: Sequence[str] | None = None,
    *,
    box: Sequence[Sequence[Quantity]] | None = None,
) -> Part:
    """Bodies or faces that are held, in all directions if none are named; of them what lies in ``box``, if given."""
    return _part(on=on, fixed=fixed, box=box)


def spring(name: str, on: str | Sequence[str], stiffness: Sequence[Quantity]) -> Part:
    """A spring to the ground: stiffness along x, y, z [N/mm]."""
    return _part(name=name, on=on, stiffness=stiffness)


def symmetry(normal: str, at: Quantity, keep: str | None = None) -> Part:
    """A plane of symmetry normal to ``"x"``, ``"y"`` or ``"z"``; what lies ``"below"`` it is modelled, or ``"above"``.

    Goes into the table ``symmetry`` of :func:`wall` or :func:`blocks`; forces and energies are those of the part.
    """
    return _part(normal=normal, at=at, keep=keep)


def probe(
    name: str,
    direction: str,
    on: str | Sequence[str] | None = None,
    *,
    near: Sequence[Quantity] | None = None,
    minus: str | Sequence[str] | Mapping[str, Value] | None = None,
    quantity: str | None = None,
) -> Part:
    """A place whose motion the history follows as a column of its own: the mean of ``on``, or the node ``near``
    a point, less the motion of ``minus``; ``quantity`` is ``"displacement"`` or ``"velocity"``.
    """
    return _part(name=name, on=on, near=near, minus=minus, direction=direction, quantity=quantity)


def wall(
    *,
    unit: Sequence[Quantity],
    length: Quantity,
    courses: int,
    brick: Mapping[str, Any],
    mortar: Mapping[str, Any] | None = None,
    joint: Mapping[str, Any],
    steps: Sequence[Mapping[str, Any]],
    bed_joint: Quantity = 10.0,
    head_joint: Quantity = 10.0,
    bond: str | None = None,
    mesh: str | Sequence[int] | None = None,
    clamped: Mapping[str, int] | bool | None = None,
    overlap: Quantity | None = None,
    leaves: int | None = None,
    collar_joint: Quantity | None = None,
    header_courses: int | None = None,
    head_filling: float | None = None,
    filled_from: str | None = None,
    rigid: bool | None = None,
    pattern: Sequence[Mapping[str, Any]] | None = None,
    openings: Sequence[Mapping[str, Any]] | None = None,
    materials: Mapping[str, Mapping[str, Any]] | None = None,
    interfaces: Mapping[str, Mapping[str, Any]] | None = None,
    title: str = "wall",
    **tables: Value,
) -> Model:
    """A wall of units and mortar, or of dry units.

    Parameters
    ----------
    unit
        Length, thickness, height of a unit [mm].
    length
        Of the wall [mm].
    courses
        How many.
    brick, mortar
        Materials (:func:`damage_plasticity`, :func:`elastic`); without mortar the joints are 0 and dry.
    joint
        The interface (:func:`joint`, :func:`dry_joint`).
    steps
        What happens (:func:`preload`, :func:`push`, ...), in order.
    bed_joint, head_joint
        Thicknesses [mm].
    bond
        ``"stretcher"``, ``"stack"``, ``"header"``, ``"english"``, ``"english-cross"``, ``"flemish"``, ``"pattern"``.
    mesh
        ``"coarse"``, ``"fine"``, or elements along a unit's length, height, thickness.
    clamped
        ``{"bottom_courses": 1, "top_courses": 1}``, or ``False``: supports and steps name its faces.
    overlap, leaves, collar_joint, header_courses, head_filling, filled_from
        Of the bond (docs/deck.md, ``wall``).
    rigid
        Units as good as rigid, in dry walls.
    pattern
        Courses of a bond written out, for ``bond="pattern"``.
    openings
        ``{"from": 360, "to": 630, "sill": 6, "courses": 6, "lintel": {"bearing": 100}}``, ...
    materials, interfaces
        Further ones by name, for lintels, leaves and contacts.
    tables
        Further tables of the deck: ``element``, ``contact``, ``contacts``, ``supports``, ``springs``, ``beams``,
        ``symmetry``, ``output``, ``probes``, ``walls``, ``blocks``.
    """
    solids = {"brick": dict(brick)} | ({} if mortar is None else {"mortar": dict(mortar)})
    if mortar is None:
        bed_joint = head_joint = 0.0
    return Model.from_dict(
        {
            "title": title,
            "materials": solids | {name: dict(own) for name, own in (materials or {}).items()},
            "interfaces": {"joint": dict(joint)} | {name: dict(own) for name, own in (interfaces or {}).items()},
            "wall": _part(
                unit=unit,
                length=length,
                courses=courses,
                bed_joint=bed_joint,
                head_joint=head_joint,
                bond=bond,
                overlap=overlap,
                leaves=leaves,
                collar_joint=collar_joint,
                header_courses=header_courses,
                head_filling=head_filling,
                filled_from=filled_from,
                rigid=rigid,
                pattern=pattern,
                openings=openings,
                unit_material="brick",
                mortar_material=None if mortar is None else "mortar",
                interface="joint",
                mesh=mesh,
                clamped=clamped,
            ),
            "steps": list(steps),
            **tables,
        }
    )


def arch(
    *,
    thickness: Quantity,
    width: Quantity,
    voussoirs: int,
    stone: Mapping[str, Any],
    joint: Mapping[str, Any],
    steps: Sequence[Mapping[str, Any]],
    radius: Quantity | None = None,
    span: Quantity | None = None,
    rise: Quantity | None = None,
    angle: Quantity | None = None,
    rigid: bool | None = None,
    mesh: Sequence[int] | None = None,
    title: str = "arch",
    **tables: Value,
) -> Model:
    """A circular arch of voussoirs on springings.

    Parameters
    ----------
    thickness, width
        Radial and along y [mm].
    voussoirs
        How many.
    stone
        The material; it needs a density.
    joint
        The interface.
    steps
        What happens, in order.
    radius, span
        Of the centre line, or the clear span [mm]: one of both.
    rise, angle
        Clear rise, with the span [mm]; or the angle of embrace [degrees].
    rigid
        Voussoirs as good as rigid.
    mesh
        Elements of a voussoir along the arch, its width, its thickness.
    tables
        Further tables of the deck: ``contact``, ``probes``, ``blocks``, ``contacts``, ``supports``, ...
    """
    return Model.from_dict(
        {
            "title": title,
            "materials": {"stone": dict(stone)},
            "interfaces": {"joint": dict(joint)},
            "contact": {"points": "corner"},
            "arch": _part(
                radius=radius,
                span=span,
                thickness=thickness,
                width=width,
                voussoirs=voussoirs,
                rise=rise,
                angle=angle,
                rigid=rigid,
                material="stone",
                interface="joint",
                mesh=mesh,
            ),
            "steps": list(steps),
            **tables,
        }
    )


def blocks(
    blocks: Sequence[Mapping[str, Any]],
    *,
    materials: Mapping[str, Mapping[str, Any]],
    interfaces: Mapping[str, Mapping[str, Any]],
    contacts: Sequence[Mapping[str, Any]] = (),
    supports: Sequence[Mapping[str, Any]],
    steps: Sequence[Mapping[str, Any]],
    springs: Sequence[Mapping[str, Any]] = (),
    probes: Sequence[Mapping[str, Any]] = (),
    imports: Sequence[Mapping[str, Any]] = (),
    points: str = "corner",
    general: str | None = None,
    title: str = "blocks",
    **tables: Value,
) -> Model:
    """A scene of blocks and imported meshes.

    Parameters
    ----------
    blocks
        :func:`block`.
    materials, interfaces
        By the names that blocks and contacts use.
    contacts, supports, springs, probes, steps
        :func:`contact`, :func:`support`, :func:`spring`, :func:`probe`, and steps in order.
    imports
        :func:`mesh`.
    points
        ``"corner"`` for blocks that rock and slide, ``"gauss"`` for bonded ones.
    general
        A dry interface by which any face may meet any other body's; if absent only those of
        ``contacts`` meet.
    tables
        Further tables of the deck: ``element``, ``output``.
    """
    return Model.from_dict(
        {
            "title": title,
            "materials": dict(materials),
            "interfaces": dict(interfaces),
            "contact": {"points": points} | ({"general": general} if general else {}),
            "blocks": list(blocks),
            "imports": list(imports),
            "contacts": list(contacts),
            "supports": list(supports),
            "springs": list(springs),
            "probes": list(probes),
            "steps": list(steps),
            **tables,
        }
    )
