"""Single points of a material or an interface along many prescribed paths."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from wythe import _wythe
from wythe._errors import PointError, expected
from wythe._json import plain

__all__ = [
    "InterfaceResponse",
    "InterfaceState",
    "MaterialResponse",
    "MaterialState",
    "drive_interface",
    "drive_material",
]

Floats = npt.NDArray[np.float64]
#: Components of a material and of an interface.
MATERIAL = ("xx", "yy", "zz", "xy", "yz", "zx")
INTERFACE = ("normal", "tau1", "tau2")
#: Strains, stresses, states and tangents of all paths, and the first failure: path, row, reason.
Driven = tuple[list[Any], Union[tuple[int, int, str], None]]
#: A table of a deck, or one table per path.
Tables = Mapping[str, Any] | Sequence[Mapping[str, Any]]


class MaterialState(NamedTuple):
    """State of material points. Leading axes are those of the strains."""

    strains: Floats
    """Strains, including those that were solved for [-]. Shape (..., rows, 6)."""
    hardening_tension: Floats
    """Equivalent plastic strain in tension [-]. Shape (..., rows)."""
    hardening_compression: Floats
    """Equivalent plastic strain in compression [-]. Shape (..., rows)."""
    tensile_damage: Floats
    """Tensile damage [-]. Shape (..., rows)."""
    compressive_damage: Floats
    """Compressive damage [-]. Shape (..., rows)."""
    damage: Floats
    """Present damage of the stiffness [-]. Shape (..., rows)."""


class MaterialResponse(NamedTuple):
    """Response of material points."""

    stresses: Floats
    """Stresses xx, yy, zz, xy, yz, zx [MPa]. Shape (..., rows, 6)."""
    state: MaterialState
    """State after each row."""
    tangents: Floats
    """Consistent tangents, derivatives of stress with respect to strain [MPa]. Shape (..., rows, 6, 6)."""


class InterfaceState(NamedTuple):
    """State of interface points."""

    gaps: Floats
    """Opening and two slips, including those that were solved for [mm]. Shape (..., rows, 3)."""
    damage: Floats
    """Damage D [-]. Shape (..., rows)."""


class InterfaceResponse(NamedTuple):
    """Response of interface points."""

    tractions: Floats
    """Tractions: normal, two shears, tension positive [MPa]. Shape (..., rows, 3)."""
    state: InterfaceState
    """State after each row."""
    tangents: Floats
    """Consistent tangents, derivatives of traction with respect to gap [N/mm^3]. Shape (..., rows, 3, 3)."""


def drive_material(
    material: Tables,
    strains: npt.ArrayLike,
    *,
    stress: Sequence[str] = (),
    times: npt.ArrayLike | None = None,
    length: float | None = None,
    substeps: int = 1,
    errors: Literal["raise", "nan"] = "raise",
) -> MaterialResponse:
    """Drives undamaged material points along prescribed strains with one implicit step per row.

    Parameters
    ----------
    material
        A material from :func:`wythe.build.damage_plasticity` or :meth:`wythe.Model.material`, or a sequence with
        one material per path.
    strains
        Strains xx, yy, zz, xy, yz, zx with engineering shear [-]. Shape (rows, 6) for one path, (paths, rows, 6)
        or more leading axes for many paths, which are computed in parallel.
    stress
        Components (``"yy"``, ...) for which ``strains`` has prescribed stresses [MPa] instead.
    times
        Time at the end of each row [s], for viscosity. Shape (rows,); 1, 2, ... if not given.
    length
        Element length l_eq for the scaling of softening [mm]; without it the tables are not scaled.
    substeps
        Number of implicit steps per row.
    errors
        Treatment of a row without a solution: ``"raise"`` raises a PointError, ``"nan"`` fills the path with nan
        from that row on.

    Returns
    -------
    MaterialResponse
        ``stresses, state, tangents``; read-only arrays with the shape of ``strains``.

    Raises
    ------
    ModelError
        The material is invalid.
    PointError
        A row has no solution; the exception has its path and row.
    """
    if length is not None:
        length = _positive("length", length)
    paths = Paths("strains", strains, times, stress, MATERIAL, substeps, errors)
    deck, keys = _deck("material", "materials", material, paths.count)
    given = paths.arguments
    return material_response(paths, _wythe.drive_material(deck, keys, length, *given))


def drive_interface(
    interface: Tables,
    gaps: npt.ArrayLike,
    *,
    stress: Sequence[str] = (),
    substeps: int = 1,
    errors: Literal["raise", "nan"] = "raise",
) -> InterfaceResponse:
    """Drives undamaged interface points along prescribed gaps with one step per row.

    Parameters
    ----------
    interface
        An interface from :func:`wythe.build.joint` or :meth:`wythe.Model.interface`, or a sequence with one
        interface per path. It needs ``normal_stiffness`` and ``shear_stiffness``, because a point has no adjacent
        elements from which they could follow.
    gaps
        Opening and two slips [mm]. Shape (rows, 3) for one path, (paths, rows, 3) for many.
    stress
        Components (``"normal"``, ``"tau1"``, ``"tau2"``) for which ``gaps`` has prescribed tractions [MPa] instead.
    substeps, errors
        See :func:`drive_material`.

    Returns
    -------
    InterfaceResponse
        ``tractions, state, tangents``; read-only arrays with the shape of ``gaps``.

    Raises
    ------
    ModelError
        The interface is invalid.
    PointError
        A row has no solution; the exception has its path and row.
    """
    paths = Paths("gaps", gaps, None, stress, INTERFACE, substeps, errors)
    deck, keys = _deck("interface", "interfaces", interface, paths.count)
    return interface_response(paths, _wythe.drive_interface(deck, keys, *paths.arguments))


def material_response(paths: Paths, driven: Driven) -> MaterialResponse:
    """The response in the shape of the paths; raises the first failure."""
    (found, stresses, state, tangents), failure = driven
    paths.judge(failure)
    return MaterialResponse(
        stresses=paths.shaped(stresses),
        state=MaterialState(
            paths.shaped(found), *(paths.shaped(state[:, :, i]) for i in range(5))
        ),
        tangents=paths.shaped(tangents),
    )


def interface_response(paths: Paths, driven: Driven) -> InterfaceResponse:
    """The response in the shape of the paths; raises the first failure."""
    (found, tractions, state, tangents), failure = driven
    paths.judge(failure)
    return InterfaceResponse(
        tractions=paths.shaped(tractions),
        state=InterfaceState(paths.shaped(found), paths.shaped(state[:, :, 0])),
        tangents=paths.shaped(tangents),
    )


class Paths:
    """Prescribed paths after their checks."""

    def __init__(
        self,
        argument: str,
        values: npt.ArrayLike,
        times: npt.ArrayLike | None,
        stress: Sequence[str],
        names: tuple[str, ...],
        substeps: int,
        errors: str,
    ) -> None:
        width = len(names)
        numbers = _numbers(argument, values, f"of shape (rows, {width}) or (paths, rows, {width})")
        if numbers.ndim < 2 or numbers.shape[-1] != width or numbers.shape[-2] == 0:
            raise ValueError(
                f"{argument}: expected an array of shape (rows, {width}) or (paths, rows, {width}), "
                f"got {numbers.shape}"
            )
        self._leading = numbers.shape[:-2]
        rows = numbers.shape[-2]
        self.count = int(np.prod(self._leading, dtype=np.int64))
        if not np.isfinite(numbers).all():
            raise ValueError(f"{argument}: expected finite numbers")
        if isinstance(stress, str):
            stress = (stress,)
        for name in stress:
            if name not in names:
                raise ValueError(f"stress: expected some of {', '.join(names)}, got {name!r}")
        if isinstance(substeps, bool) or not isinstance(substeps, (int, np.integer)):
            raise expected("substeps", "a whole number from 1", substeps)
        if substeps < 1:
            raise ValueError(f"substeps: expected a whole number from 1, got {substeps}")
        if errors not in ("raise", "nan"):
            raise ValueError(f"errors: expected 'raise' or 'nan', got {errors!r}")
        self._errors = errors
        self.arguments: tuple[Floats, Floats, list[bool], int] = (
            np.ascontiguousarray(numbers).reshape(-1),
            _times(times, rows),
            [name in stress for name in names],
            int(substeps),
        )

    def judge(self, failure: tuple[int, int, str] | None) -> None:
        """Raises an exception for a failure, unless failures become nan."""
        if failure is not None and self._errors == "raise":
            path, row, why = failure
            raise PointError(why, path, row)

    def shaped(self, values: Floats) -> Floats:
        """Reshapes results of shape (paths, rows, ...) to the leading axes of the paths."""
        return values.reshape(self._leading + values.shape[1:])


def _numbers(argument: str, values: npt.ArrayLike, what: str) -> Floats:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise expected(argument, f"numbers {what}", values) from error


def _times(times: npt.ArrayLike | None, rows: int) -> Floats:
    if times is None:
        return np.arange(1.0, rows + 1.0)
    given = _numbers("times", times, f"of shape ({rows},)")
    if given.shape != (rows,):
        raise ValueError(f"times: expected an array of shape ({rows},), got {given.shape}")
    if not (np.isfinite(given).all() and given[0] >= 0.0 and (np.diff(given) >= 0.0).all()):
        raise ValueError("times: expected finite numbers from 0 that do not decrease")
    return np.ascontiguousarray(given)


def _positive(argument: str, value: float) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
        raise expected(argument, "a number above 0", value)
    if not (float(value) > 0.0 and np.isfinite(value)):
        raise ValueError(f"{argument}: expected a number above 0, got {value}")
    return float(value)


def _deck(argument: str, table: str, tables: Tables, paths: int) -> tuple[str, list[str]]:
    """A deck with the tables under unique names."""
    if isinstance(tables, Mapping):
        # Errors refer to it by this name.
        named: dict[str, Any] = {argument: tables}
    elif isinstance(tables, Sequence) and not isinstance(tables, str):
        if len(tables) != paths:
            raise ValueError(
                f"{argument}: expected one mapping, or one for each of the {paths} paths, got {len(tables)}"
            )
        named = {f"{argument}-{i}": one for i, one in enumerate(tables)}
    else:
        raise expected(argument, "a mapping, or a sequence of them", tables)
    for name, one in named.items():
        if not isinstance(one, Mapping):
            raise expected(name, "a mapping, as wythe.build gives it", one)
    tables_of_json = plain("deck", {"format": 1, table: named})
    to_toml: Callable[[str], str] = _wythe.Deck.toml_of_json
    return to_toml(json.dumps(tables_of_json)), list(named)
