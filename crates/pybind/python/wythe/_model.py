"""Models: geometry, materials, interfaces and load steps."""

from __future__ import annotations

import hashlib
import html
import json
import os
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from wythe import _wythe
from wythe._errors import ModelError, as_path, expected, write_text
from wythe._json import plain
from wythe._laws import JointLaw, SolidLaw
from wythe._limit import LimitAnalysis, limit_of
from wythe._modes import Modes, as_count
from wythe._picture import Picture
from wythe._results import Results
from wythe._run import Increment, run_deck

__all__ = ["Findings", "Model", "Problem", "Value"]

#: Value of a deck key: a number in base units (N, mm, MPa, tonne, s), a text with a unit (``"2.12 MPa"``),
#: a flag, a path, a list or a table; also NumPy numbers and arrays.
Value = Union[
    float,
    int,
    str,
    bool,
    "os.PathLike[str]",
    Sequence[Any],
    Mapping[str, Any],
    "np.generic[Any]",
    npt.NDArray[Any],
]


@dataclass(frozen=True)
class Problem:
    """An error or a warning of a model.

    Attributes
    ----------
    key : str
        Dotted path of the key.
    message : str
        Description of the problem.
    line, column : int or None
        Position in the text, from 1, if the model was read from a text.
    fix : str
        Advice on a correction; empty for warnings.
    """

    key: str
    message: str
    line: int | None = None
    column: int | None = None
    fix: str = ""

    def __str__(self) -> str:
        place = f" (line {self.line})" if self.line is not None else ""
        fix = f"\n  fix: {self.fix}" if self.fix else ""
        return f"{self.key}{place}: {self.message}{fix}"


@dataclass(frozen=True)
class Findings:
    """Result of :meth:`Model.check`. True if the model can be run.

    Attributes
    ----------
    ok : bool
        Whether the model can be run.
    title : str
        Title of the model.
    errors, warnings : tuple of Problem
        Errors, and facts that the author of the model should know.
    notes : tuple of str
        Derived quantities: stiffnesses, fracture energies.
    units, elements, nodes, dofs, contact_points : int
        Sizes; 0 if the model cannot be built.
    memory_MB : float
        Estimated peak memory [MB].
    processor_time_s : tuple of float
        Estimated processor time [s] where little cracks, and where units snap. Motion with inertia is not foreseen.
    """

    ok: bool
    title: str
    errors: tuple[Problem, ...]
    warnings: tuple[Problem, ...]
    notes: tuple[str, ...]
    units: int
    elements: int
    nodes: int
    dofs: int
    contact_points: int
    memory_MB: float
    processor_time_s: tuple[float, float]

    def __bool__(self) -> bool:
        return self.ok

    def __str__(self) -> str:
        lines = [f"{self.title}: {'can be run' if self.ok else 'cannot be run'}"]
        lines += [f"error: {error}" for error in self.errors]
        lines += [f"warning: {warning}" for warning in self.warnings]
        lines += [f"note: {note}" for note in self.notes]
        if self.ok:
            low, high = self.processor_time_s
            lines.append(
                f"{self.units} units, {self.elements} elements, {self.nodes} nodes, "
                f"{self.dofs} unknowns, {self.contact_points} contact points, "
                f"about {self.memory_MB:.0f} MB and {low:.3g} to {high:.3g} s of processor time"
            )
        return "\n".join(lines)


class Model:
    """A model of masonry: geometry, materials, interfaces, and the steps that load it. Immutable.

    A model is made from a deck (:meth:`from_toml`, :meth:`from_dict`), by :mod:`wythe.templates` or by
    :mod:`wythe.build`. Two models are equal if their decks are.
    """

    __slots__ = ("_deck", "_toml")

    _deck: _wythe.Deck
    _toml: str | None

    def __init__(self, deck: Mapping[str, Any]) -> None:
        """See :meth:`from_dict`."""
        made = type(self).from_dict(deck)
        self._deck = made._deck
        self._toml = made._toml

    @classmethod
    def _of(cls, deck: _wythe.Deck) -> Model:
        model = cls.__new__(cls)
        model._deck = deck
        model._toml = None
        return model

    @classmethod
    def from_toml(
        cls, source: str | os.PathLike[str], overrides: Mapping[str, Value] | None = None
    ) -> Model:
        """Reads a deck from a file or a text.

        Parameters
        ----------
        source
            Path of a file, or the text itself. A str is a text if it has a line break, or if it has a ``=`` and
            does not end with ``.toml``.
        overrides
            Values that replace those of the deck, by dotted path, as with ``wythe run --set``.

        Raises
        ------
        ModelError
            The deck is invalid; the exception has line, key and fix of every error.
        OutputError
            The file cannot be read.
        """
        said = _overrides("overrides", {} if overrides is None else overrides)
        if isinstance(source, str) and _is_text(source):
            # Files named in the text are relative to the current folder.
            return cls._of(_wythe.Deck.read(source, True, None, said))
        return cls._of(_wythe.Deck.load(as_path("source", source), said))

    @classmethod
    def from_dict(
        cls, deck: Mapping[str, Any], folder: str | os.PathLike[str] | None = None
    ) -> Model:
        """Makes a model from nested dictionaries with the keys of a deck.

        Parameters
        ----------
        deck
            Tables as mappings, arrays as sequences or NumPy arrays; keys with the value None are ignored.
            ``format`` may be omitted.
        folder
            Folder of the files named in the deck; the current folder if not given.

        Raises
        ------
        ModelError
            The deck is invalid; the exception has key and fix of every error.
        """
        if not isinstance(deck, Mapping):
            raise expected("deck", "a mapping, as the tables of a deck", deck)
        tables = plain("deck", {"format": 1, **deck})
        text = _wythe.Deck.toml_of_json(json.dumps(tables, allow_nan=False))
        where = None if folder is None else as_path("folder", folder)
        return cls._of(_wythe.Deck.read(text, False, where, []))

    def with_(
        self, changes: Mapping[str, Value | None] | None = None, /, **keys: Value | None
    ) -> Model:
        """A copy of the model with other values.

        Parameters
        ----------
        changes
            Values by dotted path, with array indices from 0: ``{"interfaces.joint.f_t": "0.2 MPa"}``. None
            removes a key, so that its default applies.
        keys
            The same as keywords with ``__`` for each dot: ``wall__courses=10``.

        Raises
        ------
        ModelError
            A key is unknown, or a value is not admissible.
        """
        if changes is not None and not isinstance(changes, Mapping):
            raise expected("with_", "a mapping from keys of the deck to values", changes)
        all_changes: dict[str, Any] = dict(changes or {})
        all_changes.update({name.replace("__", "."): value for name, value in keys.items()})
        if not all_changes:
            return self
        text = self.to_toml()
        gone = [key for key, value in all_changes.items() if value is None]
        if gone:
            deck = self.to_dict()
            for key in gone:
                _remove(deck, key)
            text = _wythe.Deck.toml_of_json(json.dumps(deck))
        kept = {key: value for key, value in all_changes.items() if value is not None}
        said = _overrides("with_", kept)
        return type(self)._of(_wythe.Deck.read(text, False, str(self._deck.folder), said))

    def _named_files(self) -> list[str]:
        """Files that the deck names, and those that its meshes include."""
        return [os.fspath(file) for file in self._deck.files()]

    @property
    def title(self) -> str:
        """Title of the model."""
        return self._deck.title

    @property
    def folder(self) -> str:
        """Folder of the files named in the model."""
        return str(self._deck.folder)

    def to_toml(self) -> str:
        """The deck as TOML with all defaults, in base units (N, mm, MPa, tonne, s)."""
        if self._toml is None:
            self._toml = self._deck.to_toml()
        return self._toml

    def to_dict(self) -> dict[str, Any]:
        """The deck with all defaults as nested dictionaries."""
        deck: dict[str, Any] = json.loads(self._deck.to_json())
        return deck

    def save(self, path: str | os.PathLike[str]) -> str:
        """Writes the deck to a file and returns its path."""
        return write_text(as_path("path", path), self.to_toml())

    def material(self, name: str) -> dict[str, Any]:
        """The material of this name, as an argument of :func:`wythe.drive_material`."""
        return self._named("materials", "material", name)

    def interface(self, name: str) -> dict[str, Any]:
        """The interface of this name, as an argument of :func:`wythe.drive_interface`."""
        return self._named("interfaces", "interface", name)

    def _named(self, table: str, kind: str, name: str) -> dict[str, Any]:
        known: dict[str, dict[str, Any]] = self.to_dict()[table]
        if name not in known:
            names = ", ".join(known) or "none"
            raise KeyError(f"there is no {kind} named {name!r}; the model has {names}")
        return known[name]

    def check(self) -> Findings:
        """Checks form and physics without a run: errors, warnings, derived quantities and sizes."""
        found: dict[str, Any] = json.loads(self._deck.check())
        sizes = found["sizes"] or dict.fromkeys(
            ("units", "elements", "nodes", "dofs", "contact_points"), 0
        )

        def problem(said: dict[str, Any]) -> Problem:
            written = self._deck.is_written
            return Problem(
                key=said["key"],
                message=said["message"],
                line=said["line"] if written else None,
                column=said["column"] if written else None,
                fix=said.get("fix", ""),
            )

        low, high = found["processor_time_s"] or (0.0, 0.0)
        return Findings(
            ok=found["ok"],
            title=found["title"],
            errors=tuple(map(problem, found["errors"])),
            warnings=tuple(map(problem, found["warnings"])),
            notes=tuple(found["notes"]),
            memory_MB=found["memory_MB"] or 0.0,
            processor_time_s=(low, high),
            **sizes,
        )

    def picture(self) -> Picture:
        """Picture of the model: elevation, section and plans with materials and interfaces."""
        return Picture(self._deck.picture())

    def limit(
        self,
        *,
        associated: bool = False,
        bonded: bool = False,
        strength: float | str | None = None,
        along: str | Sequence[float] | None = None,
    ) -> LimitAnalysis:
        """Largest factor of the live loads that rigid units on their joints carry, and the mechanism.

        The factor multiplies the last step that drives, loads or tilts; what stands before it is dead load.

        Parameters
        ----------
        associated
            Whether joints that slide also open, by the friction times the slip: an upper bound.
        bonded
            Whether joints have their tensile strength and cohesion; they are dry otherwise.
        strength
            Compressive strength of the joints: a number [MPa] or a text with a unit; infinite if not given.
        along
            Direction of a body force over the weight, in place of the live step: ``"x"``, ``"-y"``, or a vector.

        Raises
        ------
        LimitError
            No factor: the dead loads alone are too much, any factor is carried, or nothing is live.
        ModelError
            The model is invalid.
        """
        return limit_of(self._deck, associated, bonded, strength, along)

    def to_inp(self) -> str:
        """The model as an input file for Abaqus: nodes, elements, sets, materials, contact and steps."""
        return self._deck.inp()

    def modes(self, count: int = 10) -> Modes:
        """The lowest natural modes at rest without preload: elastic, joints that touch closed with their elastic
        stiffness. Supports hold; beams move as in the first step.

        Parameters
        ----------
        count
            Number of modes.

        Raises
        ------
        ModelError
            The model cannot be built, or something that can move has no mass.
        """
        return Modes(self._deck.modes(as_count(count)))

    def run(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        threads: int | None = None,
        progress: bool = False,
        callback: Callable[[Increment], bool | None] | None = None,
        laws: Mapping[str, JointLaw | SolidLaw] | None = None,
        error: bool = False,
    ) -> Results:
        """Runs the model.

        Other Python threads continue meanwhile. Ctrl-C stops the run after the present increment.

        Parameters
        ----------
        out
            Folder of the results, as with ``wythe run --out``. Without one the results are in a temporary folder,
            which is removed together with the returned object.
        threads
            Number of threads; all cores if not given. The results do not depend on it, to the last bit.
        progress
            Whether a line on standard error shows the progress of the run.
        callback
            Function called with each increment after it is written. The run stops if it returns False.
        laws
            Laws of your own by the name of an interface (:class:`JointLaw`) or material (:class:`SolidLaw`) of the
            deck, which keeps its elastic constants. They are called on one core at a time.
        error
            Whether the model is run again with half the increments and with a finer mesh, to estimate the error of
            peak, area and displacement at the peak (:attr:`Results.error_estimate`). Takes four to six times as long;
            not with ``laws``.

        Returns
        -------
        Results
            Results of a complete run or of a run stopped by the callback.

        Raises
        ------
        ModelError
            The model cannot be run.
        ConvergenceError
            Convergence was lost; ``error.results`` has the results so far.
        LawError
            A law of your own failed.
        OutputError
            The results cannot be written.
        RunInterrupted
            Ctrl-C was pressed (a KeyboardInterrupt); ``error.results`` has the results so far.
        """
        return run_deck(self._deck, out, threads, progress, callback, laws, error)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        return self._deck == other._deck and self._files() == other._files()

    def __hash__(self) -> int:
        # The text is unsuitable: equal models may differ in the order of tables and in the sign of 0.
        return hash((_frozen(self.to_dict()), self._files()))

    def _files(self) -> str:
        """The folder, if the model depends on a file in it; otherwise an empty text."""
        deck = self.to_dict()
        named = any("nodes" in block or "file" in block for block in deck.get("blocks", ()))
        named = named or bool(deck.get("imports"))
        steps = deck.get("steps", ())
        named = named or any("ground" in step for step in steps)
        named = named or any(isinstance(step.get("amplitude"), str) for step in steps)
        named = named or deck.get("output", {}).get("experiment") is not None
        return os.path.abspath(self.folder or ".") if named else ""

    @property
    def digest(self) -> str:
        """SHA-256 of :meth:`to_toml`: the same in every process, and equal to that of ``model.toml`` of a run."""
        return hashlib.sha256(self.to_toml().encode()).hexdigest()

    def __reduce__(self) -> tuple[Any, ...]:
        folder = os.path.abspath(self.folder or ".")
        return (_unpickled, (self.to_toml(), folder))

    def __repr__(self) -> str:
        lines = [f"<wythe.Model {self.title!r}"]
        lines += [f"  {what:11}{said}" for what, said in self._told()]
        return "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(what)}</th>"
            f"<td style='text-align:left'>{html.escape(said)}</td></tr>"
            for what, said in self._told()
        )
        try:
            svg = self._deck.picture()
        except ModelError as error:
            svg = f"<pre>{html.escape(str(error))}</pre>"
        return (
            f"<div><b>{html.escape(self.title)}</b><table>{rows}</table>"
            f"<div style='max-width:36em'>{svg}</div></div>"
        )

    def _told(self) -> list[tuple[str, str]]:
        """Summary of the model as pairs of name and description."""
        deck = self.to_dict()
        told: list[tuple[str, str]] = []
        wall = deck.get("wall")
        if wall:
            size = " x ".join(f"{side:g}" for side in wall["unit"])
            told.append(
                (
                    "wall",
                    f"{wall['length']:g} mm long, {wall['courses']} courses of {size} mm units, "
                    f"joints {wall['bed_joint']:g} and {wall['head_joint']:g} mm, {wall['bond']} bond",
                )
            )
        arch = deck.get("arch")
        if arch:
            size = (
                f"radius {arch['radius']:g} mm" if "radius" in arch else f"span {arch['span']:g} mm"
            )
            told.append(
                (
                    "arch",
                    f"{arch['voussoirs']} voussoirs, {size}, {arch['thickness']:g} mm thick",
                )
            )
        blocks = deck.get("blocks")
        if blocks:
            names = ", ".join(block["name"] for block in blocks[:6])
            told.append(("blocks", names + (", ..." if len(blocks) > 6 else "")))
        for name, material in deck.get("materials", {}).items():
            told.append((name, _material(material)))
        for name, joint in deck.get("interfaces", {}).items():
            told.append((name, _interface(joint)))
        for number, step in enumerate(deck.get("steps", ())):
            told.append((f"step {number}", _step(step)))
        return told


def _material(material: Mapping[str, Any]) -> str:
    law = material["kind"]
    if law == "damage-plasticity":
        law = "damaged plasticity" if material.get("tension") or "f_t" in material else "elastic"
    return f"{law}, E = {material['E']:g} MPa, nu = {material['nu']:g}"


def _interface(joint: Mapping[str, Any]) -> str:
    """Kind, unless it is the default, and strengths and friction, as far as the law has such keys."""
    parts = [] if joint["kind"] == "cohesive-frictional" else [joint["kind"]]
    bond = {name: joint[name] for name in ("f_t", "c") if name in joint}
    if any(bond.values()):
        parts += [f"{name} = {strength:g} MPa" for name, strength in bond.items()]
    elif bond:
        parts.append("dry")
    if "mu" in joint:
        parts.append(f"mu = {joint['mu']:g}")
    return ", ".join(parts)


def _step(step: Mapping[str, Any]) -> str:
    kind = step["kind"]
    name = step.get("name", kind)
    said = kind if name == kind else f"{name}: {kind}"
    if "top_pressure" in step:
        said += f" {step['top_pressure']:g} MPa on top"
    if "pressure" in step:
        said += f" {step['pressure']:g} MPa"
    if kind == "drive":
        said += f" {step['displacement']:g} mm in {step['direction']}"
    if step.get("angle") is not None:
        said += f" to {step['angle']:g} deg"
    return said


def _is_text(source: str) -> bool:
    return "\n" in source or ("=" in source and not source.endswith(".toml"))


def _unpickled(text: str, folder: str) -> Model:
    return Model._of(_wythe.Deck.read(text, False, folder, []))


def _frozen(value: Any) -> Hashable:
    """A hashable copy of a deck; equal decks have equal copies."""
    if isinstance(value, dict):
        return frozenset((key, _frozen(item)) for key, item in value.items())
    if isinstance(value, list):
        return tuple(map(_frozen, value))
    found: Hashable = value
    return found


def _overrides(argument: str, changes: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Keys with their values as TOML."""
    if not isinstance(changes, Mapping):
        raise expected(argument, "a mapping from keys of the deck to values", changes)
    said = []
    for key, value in changes.items():
        if not isinstance(key, str):
            raise expected(argument, "keys that are dotted paths, e.g. 'wall.courses'", key)
        said.append((key, _toml_value(plain(key, value))))
    return said


def _toml_value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        # A JSON string is a TOML string, except that JSON escapes characters beyond 16 bits in two parts.
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml_value, value)) + "]"
    pairs = (f"{json.dumps(key)} = {_toml_value(item)}" for key, item in value.items())
    return "{ " + ", ".join(pairs) + " }"


def _remove(deck: dict[str, Any], key: str) -> None:
    """Removes a key, if it exists."""
    *above, last = key.split(".")
    at: Any = deck
    for part in above:
        if isinstance(at, list) and part.isdecimal() and int(part) < len(at):
            at = at[int(part)]
        elif isinstance(at, dict) and part in at:
            at = at[part]
        else:
            return
    if isinstance(at, dict):
        at.pop(last, None)
    elif isinstance(at, list) and last.isdecimal() and int(last) < len(at):
        del at[int(last)]
