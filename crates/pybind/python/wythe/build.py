"""Models from parts: materials, joints, walls, arches, blocks, steps.

Each function returns a part of a deck with the keys of the deck (docs/reference/deck.md); :func:`wall`, :func:`arch` and
:func:`blocks` combine parts to a model. A quantity is a number in base units (N, mm, MPa, tonne, s; degrees) or a
text with its unit. Omitted arguments take the default of the deck.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from wythe._attached import floor, layer, section, settlement, tie
from wythe._materials import by_name, cap_joint, damage_plasticity, drucker_prager, dry_joint, elastic, joint
from wythe._model import Model, Value
from wythe._parts import (
    MotionOptions as MotionOptions,
    Part as Part,
    Quantity as Quantity,
    Rows as Rows,
    StepOptions as StepOptions,
    _part,
    drive,
    free,
    gravity,
    load,
    loading,
    preload,
    tilt,
)

__all__ = [
    "arch",
    "beam",
    "block",
    "blocks",
    "by_name",
    "cap_joint",
    "contact",
    "damage_plasticity",
    "drive",
    "drucker_prager",
    "dry_joint",
    "elastic",
    "floor",
    "free",
    "gravity",
    "joint",
    "layer",
    "load",
    "loading",
    "mesh",
    "preload",
    "probe",
    "push",
    "section",
    "settlement",
    "spring",
    "support",
    "symmetry",
    "tie",
    "tilt",
    "wall",
]

#: Earlier name of :func:`drive`.
push = drive


def block(
    name: str,
    material: str,
    size: Sequence[Quantity] | None = None,
    at: Sequence[Quantity] | None = None,
    *,
    corners: Sequence[Sequence[Quantity]] | None = None,
    nodes: str | None = None,
    file: str | None = None,
    units: str | None = None,
    thickness: Quantity | None = None,
    not_convex: str | None = None,
    rotate: Mapping[str, Quantity] | None = None,
    mesh: Sequence[int] | None = None,
    rigid: bool | None = None,
    velocity: Sequence[Quantity] | None = None,
    stack: int | None = None,
    interface: str | None = None,
    copies: Sequence[int] | None = None,
    pitch: Sequence[Quantity] | None = None,
) -> Part:
    """A block: a box given by its size and lowest corner, a hexahedron given by its corners, a grid of nodes from a
    file, or the stones of a file of closed shells. ``stack`` makes a column of this number of blocks, joined by ``interface``.
    """
    return _part(
        name=name,
        material=material,
        size=size,
        at=at,
        corners=corners,
        nodes=nodes,
        file=file,
        units=units,
        thickness=thickness,
        not_convex=not_convex,
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
    """A stiff loading beam on horizontal faces, with the ``rotation`` ``"level"`` or ``"free"``.

    It belongs to the table ``beams`` of :func:`wall` or :func:`blocks`; :func:`preload` and :func:`drive` refer to it
    by name.
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
    """A mesh of Abaqus (.inp) or Gmsh (.msh); ``materials`` assigns materials to sets if the file does not."""
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
    """Faces that may come into contact; without names all faces that touch at rest."""
    return _part(interface=interface, slave=slave, master=master)


def support(
    on: str | Sequence[str],
    fixed: Sequence[str] | None = None,
    *,
    box: Sequence[Sequence[Quantity]] | None = None,
) -> Part:
    """Fixes bodies or faces, in all directions by default; only the part within ``box``, if given."""
    return _part(on=on, fixed=fixed, box=box)


def spring(name: str, on: str | Sequence[str], stiffness: Sequence[Quantity]) -> Part:
    """A spring to the ground with its stiffness along x, y and z [N/mm]."""
    return _part(name=name, on=on, stiffness=stiffness)


def symmetry(normal: str, at: Quantity, keep: str | None = None) -> Part:
    """A plane of symmetry normal to ``"x"``, ``"y"`` or ``"z"``; the model is the part ``"below"`` it or ``"above"``.

    It belongs to the table ``symmetry`` of :func:`wall` or :func:`blocks`; forces and energies are those of the part.
    """
    return _part(normal=normal, at=at, keep=keep)


def probe(
    name: str,
    direction: str | Sequence[float] | None = None,
    on: str | Sequence[str] | None = None,
    *,
    near: Sequence[Quantity] | None = None,
    minus: str | Sequence[str] | Mapping[str, Value] | None = None,
    gauge: Sequence[Sequence[Quantity]] | None = None,
    quantity: str | None = None,
) -> Part:
    """A motion recorded in its own column of the history.

    Parameters
    ----------
    direction
        ``"x"``, ``"-z"``, or a vector; optional with a ``gauge``.
    on, near
        The mean of blocks or faces, or the node nearest to a point at rest [mm].
    minus
        A place whose motion is subtracted.
    gauge
        Two points at rest [mm]: by how much the nodes nearest to them move apart.
    quantity
        ``"displacement"``, ``"velocity"`` or ``"drift"``.
    """
    return _part(
        name=name, on=on, near=near, minus=minus, gauge=gauge, direction=direction, quantity=quantity
    )


def _assembled(tables: Mapping[str, Value], own: Part) -> Model:
    """A model of the tables that a builder makes and further ones."""
    twice = sorted(tables.keys() & own.keys())
    if twice:
        raise ValueError(f"{twice[0]}: given twice, as a table and by other arguments, which also make it")
    return Model.from_dict({**own, **tables})


def wall(
    *,
    unit: Sequence[Quantity],
    length: Quantity,
    courses: int,
    brick: Mapping[str, Any],
    mortar: Mapping[str, Any] | None = None,
    joint: Mapping[str, Any],
    steps: Sequence[Mapping[str, Any]],
    name: str | None = None,
    at: Sequence[Quantity] | None = None,
    along: str | None = None,
    rotate: Mapping[str, Any] | None = None,
    bed_joint: Quantity | None = None,
    head_joint: Quantity | None = None,
    bond: str | None = None,
    mesh: str | Sequence[int] | None = None,
    clamped: Mapping[str, int] | bool | None = None,
    overlap: Quantity | None = None,
    leaves: int | None = None,
    collar_joint: Quantity | None = None,
    header_courses: int | None = None,
    head_interface: str | None = None,
    collar_interface: str | None = None,
    head_filling: float | None = None,
    filled_from: str | None = None,
    rigid: bool | None = None,
    pattern: Sequence[Mapping[str, Any]] | None = None,
    corners: str | None = None,
    openings: Sequence[Mapping[str, Any]] | None = None,
    snap: Quantity | None = None,
    storeys: Sequence[Quantity] | None = None,
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
        Length of the wall [mm].
    courses
        Number of courses.
    brick, mortar
        Materials (:func:`damage_plasticity`, :func:`elastic`); without mortar the joints are dry and have no thickness.
    joint
        The interface (:func:`joint`, :func:`dry_joint`).
    steps
        Load steps (:func:`preload`, :func:`drive`, ...) in order.
    name, at, along
        Name of the wall (default ``"wall"``), its lowest corner [mm], and its axis, ``"x"`` or ``"y"``.
    rotate
        Rotation about ``at``, such as ``{"axis": "z", "angle": 30.0}``.
    bed_joint, head_joint
        Thicknesses of the joints [mm]; 10 if not given, without mortar 0.
    bond
        ``"stretcher"``, ``"stack"``, ``"header"``, ``"english"``, ``"english-cross"``, ``"flemish"``, ``"pattern"``.
    mesh
        ``"coarse"``, ``"fine"``, or numbers of elements along the length, height and thickness of a unit.
    clamped
        ``{"bottom_courses": 1, "top_courses": 1}``, or ``False`` if supports and steps refer to its faces.
    overlap, leaves, collar_joint, header_courses, head_filling, filled_from
        Parameters of the bond (docs/reference/deck.md, ``wall``).
    head_interface, collar_interface
        Names of ``interfaces`` for these joints, if they differ from ``joint``.
    rigid
        Whether the units of a dry wall are nearly rigid.
    pattern
        Explicit courses of a bond, for ``bond="pattern"``.
    corners
        How it meets other walls: ``"interlocked"`` (default) or ``"butted"``.
    openings
        Openings such as ``{"from": 360, "to": 630, "sill": 6, "courses": 6, "lintel": {"bearing": 100}}``.
    snap
        Length of the pieces beside openings that are joined to their neighbours [mm]; 0: none.
    storeys
        Heights from floor to floor, the lowest first [mm]; ``wall.storey-1.top`` is then a face.
    materials, interfaces
        Further materials and interfaces by name, for lintels, leaves and contacts.
    tables
        Further tables of the deck: ``element``, ``contact``, ``contacts``, ``supports``, ``springs``,
        ``settlements``, ``floors``, ``beams``, ``ties``, ``layers``, ``sections``, ``symmetry``, ``fidelity``,
        ``output``, ``probes``, ``walls``, ``blocks``.
    """
    solids = {"brick": dict(brick)} | ({} if mortar is None else {"mortar": dict(mortar)})
    joints = {"bed_joint": bed_joint, "head_joint": head_joint}
    thick = [key for key, size in joints.items() if size is not None and str(size).split()[:1] not in (["0"], ["0.0"])]
    if mortar is None and thick:
        raise ValueError(f"{thick[0]}: a wall without mortar has joints without thickness; give mortar, or omit it")
    default = 0.0 if mortar is None else 10.0
    return _assembled(
        tables,
        {
            "title": title,
            "materials": solids | {name: dict(own) for name, own in (materials or {}).items()},
            "interfaces": {"joint": dict(joint)} | {name: dict(own) for name, own in (interfaces or {}).items()},
            "wall": _part(
                name=name,
                at=at,
                along=along,
                rotate=rotate,
                unit=unit,
                length=length,
                courses=courses,
                bed_joint=default if bed_joint is None else bed_joint,
                head_joint=default if head_joint is None else head_joint,
                bond=bond,
                overlap=overlap,
                leaves=leaves,
                collar_joint=collar_joint,
                header_courses=header_courses,
                head_interface=head_interface,
                collar_interface=collar_interface,
                head_filling=head_filling,
                filled_from=filled_from,
                rigid=rigid,
                pattern=pattern,
                corners=corners,
                openings=openings,
                snap=snap,
                storeys=storeys,
                unit_material="brick",
                mortar_material=None if mortar is None else "mortar",
                interface="joint",
                mesh=mesh,
                clamped=clamped,
            ),
            "steps": list(steps),
        },
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
        Radial thickness, and width along y [mm].
    voussoirs
        Number of voussoirs.
    stone
        The material; it needs a density.
    joint
        The interface.
    steps
        Load steps in order.
    radius, span
        Radius of the centre line or clear span [mm]; one of the two.
    rise, angle
        Clear rise [mm], used with the span; or angle of embrace [degrees].
    rigid
        Whether the voussoirs are nearly rigid.
    mesh
        Numbers of elements of a voussoir along the arch, its width and its thickness.
    tables
        Further tables of the deck: ``contact``, ``fidelity``, ``probes``, ``blocks``, ``contacts``, ``supports``, ...
    """
    return _assembled(
        tables,
        {
            "title": title,
            "materials": {"stone": dict(stone)},
            "interfaces": {"joint": dict(joint)},
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
        },
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
    points: str | None = None,
    general: str | None = None,
    parts: Sequence[int] | None = None,
    search_radius: Quantity | None = None,
    title: str = "blocks",
    **tables: Value,
) -> Model:
    """A scene of blocks and imported meshes.

    Parameters
    ----------
    blocks
        Blocks (:func:`block`).
    materials, interfaces
        Materials and interfaces by the names used in blocks and contacts.
    contacts, supports, springs, probes, steps
        Lists of :func:`contact`, :func:`support`, :func:`spring` and :func:`probe`, and the steps in order.
    imports
        Imported meshes (:func:`mesh`).
    points
        Contact points of facets: ``"auto"`` (default), ``"gauss"`` or ``"corner"``. Corner points of an elastic joint
        make it up to three times as stiff against rotation.
    general
        Dry interface for contact between any faces of different bodies; without it only ``contacts`` are
        considered.
    parts
        Numbers of parts along x, y and z into which each slave facet is divided, each with contact points.
    search_radius
        Largest gap at which a point is paired with the opposite surface [mm].
    tables
        Further tables of the deck: ``settlements``, ``floors``, ``beams``, ``ties``, ``layers``, ``sections``,
        ``symmetry``, ``walls``, ``arch``, ``element``, ``fidelity``, ``output``.
    """
    meeting = _part(points=points, parts=parts, general=general, search_radius=search_radius)
    return _assembled(
        tables,
        {
            "title": title,
            "materials": dict(materials),
            "interfaces": dict(interfaces),
            **({"contact": meeting} if meeting else {}),
            "blocks": list(blocks),
            "imports": list(imports),
            "contacts": list(contacts),
            "supports": list(supports),
            "springs": list(springs),
            "probes": list(probes),
            "steps": list(steps),
        },
    )


# All functions belong to this module in help texts and pickles, whatever file defines them.
for _name in __all__:
    globals()[_name].__module__ = __name__
