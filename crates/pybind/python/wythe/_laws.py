"""Laws of joints and solids as functions of arrays."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

import numpy as np
import numpy.typing as npt

from wythe import _wythe
from wythe._drive import (
    INTERFACE,
    MATERIAL,
    Floats,
    InterfaceResponse,
    MaterialResponse,
    Paths,
    _positive,
    interface_response,
    material_response,
)
from wythe._errors import LawError, expected

__all__ = ["JointLaw", "SolidLaw"]

#: Traction or stress, tangent and, for a law with state, the new state.
Answer = tuple[npt.ArrayLike, npt.ArrayLike] | tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike]
Function = Callable[[Floats, Floats, Floats, Floats], Answer]

#: Largest number of values in the state of a point.
_STATES = 3
#: Fields of contact points in the files of a run (crates/core/src/results/vtkhdf/work.rs and quads.rs). The last one is
#: that of every law of one's own.
_OF_POINTS = frozenset(
    ("displacement", "opening", "slip", "traction", "damage", "state", "facet", "law", "plastic_opening")
)
#: Fields of elements and nodes there, and the NAME of `max_NAME`, a column of every history.
_OF_ELEMENTS = frozenset(
    (
        "displacement", "velocity", "stress", "principal_stress", "plastic_strain", "tensile_damage",
        "compressive_damage", "crack_width", "yielded", "material", "unit", "course", "interface_damage",
    )
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Law:
    """What both kinds of laws have."""

    name: str
    """Name, for messages."""
    function: Function
    """The law."""
    state: Mapping[str, str] = field(default_factory=dict)
    """Names and units of at most three numbers that the law keeps at each point. They are fields of the results."""

    _size: ClassVar[int]
    _traction: ClassVar[str]
    _taken: ClassVar[frozenset[str]]
    """Names that fields of the results and columns of the history have without the law."""

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name:
            raise expected("name", "a text", self.name)
        if not callable(self.function):
            raise expected("function", "a function of four arrays", self.function)
        if not isinstance(self.state, Mapping):
            raise expected("state", "a mapping from names to units", self.state)
        if len(self.state) > _STATES:
            raise ValueError(f"state: at most {_STATES} numbers, got {len(self.state)}")
        for name, unit in self.state.items():
            if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9_]*", name):
                raise expected("state", "names of lower-case letters, digits and `_`", name)
            if name in self._taken:
                taken = ", ".join(sorted(self._taken))
                raise ValueError(f"state: `{name}` is the name of a field or column that runs have; taken are {taken}")
            if not isinstance(unit, str) or not unit:
                raise expected("state", "a unit for each name, '1' for none", unit)

    @property
    def _outputs(self) -> list[tuple[str, str]]:
        return list(self.state.items())

    @property
    def _softening(self) -> list[float]:
        return [0.0, 0.0]

    def _answer(self, strain: Floats, plastic: Floats, state: Floats, elastic: Floats) -> Floats:
        """Calls the function and returns its checked answer as one flat array."""
        try:
            answer = self.function(strain, plastic, state, elastic)
        except Exception as error:
            raise LawError(
                f"the law `{self.name}` raised {type(error).__name__}: {error} (at {strain})"
            ) from error
        size, parts = self._size, 2 + bool(self.state)
        if not isinstance(answer, tuple) or len(answer) != parts:
            names = (self._traction, "tangent", "state")[:parts]
            got = f"{len(answer)} values" if isinstance(answer, tuple) else type(answer).__name__
            raise LawError(f"the law `{self.name}` returns ({', '.join(names)}), got {got}")
        shapes = ((size,), (size, size), (len(self.state),))
        arrays = []
        for value, what, shape in zip(answer, (self._traction, "tangent", "state"), shapes):
            try:
                array = np.asarray(value, dtype=np.float64)
            except (TypeError, ValueError) as error:
                raise LawError(f"the {what} of the law `{self.name}` is no array") from error
            if array.shape != shape:
                raise LawError(
                    f"the {what} of the law `{self.name}` has the shape {shape}, got {array.shape}"
                )
            if not np.isfinite(array).all():
                raise LawError(
                    f"the {what} of the law `{self.name}` is not finite at {strain}: {array}"
                )
            arrays.append(array.ravel())
        return np.concatenate(arrays)


@dataclass(frozen=True, eq=False)
class JointLaw(_Law):
    """The law of a joint as a function of one point.

    ``function(gap, plastic, state, stiffness)`` returns ``(traction, tangent)``, or ``(traction, tangent, state)``
    if the law has a state. It is called for every point in every iteration and must not keep anything itself.

    ===============  ======  ====================================================================
    Array            Shape   Meaning
    ===============  ======  ====================================================================
    ``gap``          (3,)    opening and two slips at the end of the step [mm]
    ``plastic``      (3,)    their plastic parts at its start: gap minus traction over stiffness
    ``state``        (n,)    the law's own numbers at its start; zero at rest
    ``stiffness``    (2,)    elastic stiffness, normal and shear [N/mm^3], from the deck
    ``traction``     (3,)    normal traction and two shears [MPa]; tension is positive
    ``tangent``      (3, 3)  derivatives of the traction with respect to the gap [N/mm^3]
    ===============  ======  ====================================================================

    Parameters
    ----------
    name
        Name, for messages.
    function
        The law.
    state
        Names and units of at most three numbers that the law keeps at each point. They become fields of the
        results, as the plastic opening does. Names of fields that runs have are taken: ``opening``, ``slip``,
        ``traction``, ``damage``, ``state``, ``displacement``, ``facet``, ``law``, ``plastic_opening``.
    softening
        Steepest slopes by which the traction falls in opening and in slip [N/mm^3]. The solver keeps its numerical
        stiffness above them.

    Examples
    --------
    A joint that carries any pressure and no tension:

    >>> import numpy as np
    >>> import wythe
    >>> def no_tension(gap, plastic, state, stiffness):
    ...     k = np.array([stiffness[0], stiffness[1], stiffness[1]])
    ...     if gap[0] > 0.0:
    ...         return np.zeros(3), np.zeros((3, 3))
    ...     return k * (gap - [0, plastic[1], plastic[2]]), np.diag(k)
    >>> law = wythe.JointLaw("no tension", no_tension)
    >>> law.drive([[0.1, 0, 0], [-0.1, 0, 0]], stiffness=(100, 40)).tractions[:, 0]
    array([  0., -10.])
    """

    softening: Sequence[float] = (0.0, 0.0)
    """Steepest slopes of softening in opening and in slip [N/mm^3]."""

    _size: ClassVar[int] = 3
    _traction: ClassVar[str] = "traction"
    _taken: ClassVar[frozenset[str]] = _OF_POINTS

    def __post_init__(self) -> None:
        super().__post_init__()
        slopes = np.asarray(self.softening, dtype=np.float64)
        if slopes.shape != (2,) or not np.isfinite(slopes).all() or (slopes < 0.0).any():
            raise expected("softening", "two slopes from 0", self.softening)

    @property
    def _softening(self) -> list[float]:
        return [float(slope) for slope in self.softening]

    def drive(
        self,
        gaps: npt.ArrayLike,
        *,
        stiffness: Sequence[float],
        stress: Sequence[str] = (),
        substeps: int = 1,
        errors: Literal["raise", "nan"] = "raise",
    ) -> InterfaceResponse:
        """Drives points along prescribed gaps, see :func:`wythe.drive_interface`.

        Parameters
        ----------
        gaps
            Opening and two slips [mm]. Shape (rows, 3) for one path, (paths, rows, 3) for many.
        stiffness
            Normal and shear stiffness [N/mm^3].
        stress, substeps, errors
            See :func:`wythe.drive_interface`.

        Raises
        ------
        LawError
            The function raised an exception, or its answer has a wrong shape or is not finite.
        PointError
            A row has no solution.
        """
        paths = Paths("gaps", gaps, None, stress, INTERFACE, substeps, errors)
        driven = _wythe.drive_joint_law(self, _pair("stiffness", stiffness), *paths.arguments)
        return interface_response(paths, driven)

    def check(self, *, stiffness: Sequence[float], step: float = 1e-3) -> None:
        """Checks the law on a random path: tangent, independence of directions in the plane, balance of energy.

        Parameters
        ----------
        stiffness
            Normal and shear stiffness [N/mm^3].
        step
            Size of a step of the path [mm].

        Raises
        ------
        LawError
            The check that the law fails, with step and gap.
        """
        _wythe.check_joint_law(self, _pair("stiffness", stiffness), _positive("step", step))


@dataclass(frozen=True, eq=False)
class SolidLaw(_Law):
    """The law of a solid as a function of one point, for small strains in the rotating frame of an element.

    ``function(strain, plastic, state, elastic)`` returns ``(stress, tangent)``, or ``(stress, tangent, state)`` if
    the law has a state. Vectors are engineering Voigt: xx, yy, zz, xy, yz, zx.

    ===========  ======  =======================================================================
    Array        Shape   Meaning
    ===========  ======  =======================================================================
    ``strain``   (6,)    strain at the end of the step [-]
    ``plastic``  (6,)    plastic strain at its start: strain minus the elastic strain of the stress
    ``state``    (n,)    the law's own numbers at its start; zero at rest
    ``elastic``  (2,)    Young's modulus [MPa] and Poisson's ratio, from the deck
    ``stress``   (6,)    stress [MPa]; tension is positive
    ``tangent``  (6, 6)  derivatives of the stress with respect to the strain [MPa]
    ===========  ======  =======================================================================

    Parameters
    ----------
    name
        Name, for messages.
    function
        The law.
    state
        Names and units of at most three numbers that the law keeps at each point. They become fields of the
        results and columns of the history. Names of fields that runs have are taken: ``stress``,
        ``principal_stress``, ``plastic_strain``, ``tensile_damage``, ``compressive_damage``, ``crack_width``,
        ``yielded``, ``displacement``, ``velocity``, ``material``, ``unit``, ``course``; and ``interface_damage``, whose
        column of the history is taken.
    """

    _size: ClassVar[int] = 6
    _traction: ClassVar[str] = "stress"
    _taken: ClassVar[frozenset[str]] = _OF_ELEMENTS

    def drive(
        self,
        strains: npt.ArrayLike,
        *,
        elastic: Sequence[float],
        stress: Sequence[str] = (),
        substeps: int = 1,
        errors: Literal["raise", "nan"] = "raise",
    ) -> MaterialResponse:
        """Drives points along prescribed strains, see :func:`wythe.drive_material`.

        Parameters
        ----------
        strains
            Strains [-]. Shape (rows, 6) for one path, (paths, rows, 6) for many.
        elastic
            Young's modulus [MPa] and Poisson's ratio.
        stress, substeps, errors
            See :func:`wythe.drive_material`.

        Raises
        ------
        LawError
            The function raised an exception, or its answer has a wrong shape or is not finite.
        PointError
            A row has no solution.
        """
        paths = Paths("strains", strains, None, stress, MATERIAL, substeps, errors)
        driven = _wythe.drive_solid_law(self, _pair("elastic", elastic), *paths.arguments)
        return material_response(paths, driven)

    def check(self, *, elastic: Sequence[float], step: float) -> None:
        """Checks the law on random paths: tangent, balance of energy, dissipation, isotropy.

        Parameters
        ----------
        elastic
            Young's modulus [MPa] and Poisson's ratio.
        step
            Size of a step of the paths [-]; a fifth of the strain at first yield shows most of a law.

        Raises
        ------
        LawError
            The check that the law fails, with step and strain.
        """
        _wythe.check_solid_law(self, _pair("elastic", elastic), _positive("step", step))


def _pair(argument: str, values: Sequence[float]) -> list[float]:
    try:
        first, second = (float(value) for value in values)
    except (TypeError, ValueError) as error:
        raise expected(argument, "two numbers", values) from error
    return [first, second]


def split(
    laws: Mapping[str, JointLaw | SolidLaw] | None,
) -> Any:
    """The laws of a run by kind, as the Rust half takes them."""
    if laws is None:
        return None
    if not isinstance(laws, Mapping):
        raise expected("laws", "a mapping from names of interfaces and materials to laws", laws)
    for name, law in laws.items():
        if not isinstance(law, (JointLaw, SolidLaw)):
            raise expected(f"laws[{name!r}]", "a wythe.JointLaw or wythe.SolidLaw", law)
    return _Laws(
        [(name, law) for name, law in laws.items() if isinstance(law, JointLaw)],
        [(name, law) for name, law in laws.items() if isinstance(law, SolidLaw)],
    )


@dataclass(frozen=True)
class _Laws:
    interfaces: list[tuple[str, JointLaw]]
    materials: list[tuple[str, SolidLaw]]
