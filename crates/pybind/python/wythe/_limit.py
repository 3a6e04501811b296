"""Limit analysis of rigid units."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, SupportsFloat

from wythe import _wythe
from wythe._errors import ModelError, as_path, expected
from wythe._frames import Floats
from wythe._picture import Picture

__all__ = ["LimitAnalysis", "limit_of"]


@dataclass(frozen=True)
class LimitAnalysis:
    """Largest factor of the live loads that rigid units on their joints carry.

    Attributes
    ----------
    factor : float
        The factor; of a drive the force [N].
    force : float or None
        Force along the drive [kN]; None if the live load is none.
    live_load : str
        What the factor multiplies.
    associated_factor : float
        Factor if joints open as they slide, an upper bound.
    gap : float
        Distance of the factor to that of its mechanism, over the factor [-]: a certificate of the solution.
    converged : bool
        Whether the joints of the mechanism slide without opening, up to ``opening_work``; the factor is that of the
        last program otherwise.
    opening_work : float
        Work of the pressures on joints that open or close as they slide, over that of the live loads [-].
    programs : int
        Number of programs that were solved.
    mechanism : list of dict
        Motion of each unit: ``name``, ``centre_mm``, ``velocity`` of the centre, ``spin`` [1/mm]. The fastest
        point moves by 1.
    joints : list of dict
        Resultant in each joint: ``bodies``, ``at_mm`` where the normal force acts, ``force_N``, ``normal_N``,
        ``sliding``: the used part of the shear strength; ``corners_mm`` and ``corner_forces_N``.
    ties : list of dict
        Largest force in each tie: ``name``, ``force_N``.
    mirror : str or None
        Axis across the plane about which the scene is symmetric, so that half of its forces were unknown.
    note : str or None
        Remark where the factor is far below the associated one: runs in increments may carry anything between.
    """

    factor: float
    force: float | None
    live_load: str
    associated_factor: float
    gap: float
    converged: bool
    opening_work: float
    programs: int
    mechanism: list[dict[str, Any]] = field(repr=False)
    joints: list[dict[str, Any]] = field(repr=False)
    ties: list[dict[str, Any]] = field(repr=False)
    mirror: str | None
    note: str | None
    picture: Picture = field(repr=False)
    """The mechanism and the forces."""
    _found: _wythe.LimitOfModel = field(repr=False, compare=False)

    @property
    def velocities(self) -> Floats:
        """Velocities of the nodes in the mechanism, the fastest at 1. Shape (nodes, 3)."""
        return self._found.velocities()

    def write(self, out: str | os.PathLike[str]) -> list[str]:
        """Writes ``limit.json``, ``mechanism.vtkhdf``, ``joints.vtkhdf``, ``corners.vtkhdf`` and ``mechanism.svg`` into
        a folder and returns the files."""
        return [str(path) for path in self._found.write(as_path("out", out))]


def limit_of(
    deck: _wythe.Deck,
    associated: bool,
    bonded: bool,
    strength: float | str | None,
    along: str | Sequence[float] | None,
) -> LimitAnalysis:
    """See :meth:`wythe.Model.limit`."""
    for name, flag in (("associated", associated), ("bonded", bonded)):
        if not isinstance(flag, bool):
            raise expected(name, "True or False", flag)
    way = None if along is None else _direction(along)
    limit = deck.limit(associated, bonded, None if strength is None else _strength(strength), way)
    found: dict[str, Any] = json.loads(limit.table())
    return LimitAnalysis(
        factor=found["factor"],
        force=found["force_kN"],
        live_load=found["live_load"],
        associated_factor=found["associated_factor"],
        gap=found["gap"],
        converged=found["converged"],
        opening_work=found["opening_work"],
        programs=found["programs"],
        mechanism=found["mechanism"],
        joints=found["joints"],
        ties=found["ties"],
        mirror=found["mirror"],
        note=found["note"],
        picture=Picture(limit.picture()),
        _found=limit,
    )


def _strength(strength: object) -> float:
    """A pressure above 0 [MPa]; the reader of decks knows the units."""
    if isinstance(strength, str):
        tables = {"format": 1, "materials": {"any": {"E": strength, "nu": 0.0}}}
        try:
            read = _wythe.Deck.read(_wythe.Deck.toml_of_json(json.dumps(tables)), False, None, [])
        except ModelError as error:
            raise ValueError(f"strength: {error.message}") from None
        strength = json.loads(read.to_json())["materials"]["any"]["E"]
    number = float(strength) if isinstance(strength, SupportsFloat) and not isinstance(strength, bool) else 0.0
    if not number > 0.0:
        raise expected("strength", 'a pressure above 0 [MPa], or a text such as "10 MPa"', strength)
    return number


def _direction(along: str | Sequence[float]) -> list[float]:
    if isinstance(along, str):
        sign, name = (-1.0, along[1:]) if along.startswith("-") else (1.0, along)
        if name not in ("x", "y", "z"):
            raise expected("along", '"x", "-x", …, or a vector', along)
        return [sign * float(axis == name) for axis in ("x", "y", "z")]
    if not isinstance(along, Iterable) or not all(isinstance(part, SupportsFloat) for part in along):
        raise expected("along", '"x", "-x", …, or a vector', along)
    vector = [float(part) for part in along]
    length = sum(part * part for part in vector) ** 0.5
    if len(vector) != 3 or not 0.0 < length < float("inf"):
        raise expected("along", "a vector of three numbers other than 0", along)
    return [part / length for part in vector]
