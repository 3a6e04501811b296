"""History of a run, and fields of its frames and interfaces."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from wythe import _wythe
from wythe._errors import as_path, need, write_text

if TYPE_CHECKING:
    import pandas

__all__ = ["Floats", "Frame", "History", "Interfaces"]

#: Numbers of a frame or a column.
Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]



class History(Mapping[str, npt.NDArray[Any]]):
    """The history of a run: a mapping from column names to arrays of shape (increments,).

    Every column of ``history.csv`` is also an attribute, such as ``history.force_kN``. Units are in the names. The
    arrays are read-only. ``driven`` marks rows of steps that drive the model, and ``procedure`` is text; all other
    columns are numbers. Columns of probes have the names of the probes.
    """

    increment: Integers
    step: Integers
    time: Floats
    displacement_mm: Floats
    force_kN: Floats
    reaction_kN: Floats
    iterations: Integers
    cutbacks: Integers
    external_work_J: Floats
    elastic_energy_J: Floats
    plastic_damage_dissipation_J: Floats
    interface_dissipation_J: Floats
    viscous_dissipation_J: Floats
    open_points: Integers
    sliding_points: Integers
    max_interface_damage: Floats
    max_tensile_damage: Floats
    max_compressive_damage: Floats
    out_of_balance: Floats
    residual: Floats
    kinetic_energy_J: Floats
    damping_dissipation_J: Floats
    numerical_dissipation_J: Floats
    contact_area_mm2: Floats
    load_factor: Floats
    procedure: npt.NDArray[np.str_]
    driven: npt.NDArray[np.bool_]

    def __init__(self, columns: Mapping[str, npt.NDArray[Any]], probes: tuple[str, ...]) -> None:
        self._columns = dict(columns)
        self._probes = probes

    @property
    def probes(self) -> tuple[str, ...]:
        """Names of the columns after those that every history has: of probes, loads, outputs of laws, ties, supports and
        sections."""
        return self._probes

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"{name}: the history has {', '.join(self._columns)}") from None

    def __getattr__(self, name: str) -> npt.NDArray[Any]:
        # self._columns would recurse while a copy is made, before it is set.
        columns: dict[str, npt.NDArray[Any]] = self.__dict__.get("_columns", {})
        if name not in columns:
            raise AttributeError(f"the history has no column {name!r}")
        return columns[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._columns]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """Number of columns; ``history.increments`` counts the rows."""
        return len(self._columns)

    @property
    def increments(self) -> int:
        """Number of increments (rows)."""
        return len(self._columns["increment"])

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame with one row per increment."""
        need("pandas", "study")
        import pandas

        return pandas.DataFrame(dict(self._columns)).set_index("increment")

    def to_csv(self, path: str | os.PathLike[str]) -> str:
        """Writes the columns to a CSV file with full precision and returns its path."""
        name = as_path("path", path)
        text = io.StringIO(newline="")
        rows = csv.writer(text)
        rows.writerow(self._columns)
        rows.writerows(zip(*(column.tolist() for column in self._columns.values())))
        return write_text(name, text.getvalue())

    def __repr__(self) -> str:
        return f"<wythe.History: {self.increments} increments of {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        names = ("increment", "step", "time", "displacement_mm", "force_kN", "reaction_kN")
        head = "".join(f"<th>{name}</th>" for name in names)
        count = self.increments
        chosen = range(count) if count <= 10 else [*range(5), *range(count - 5, count)]
        rows = "".join(
            "<tr>" + "".join(f"<td>{self._columns[name][i]:g}</td>" for name in names) + "</tr>"
            for i in chosen
        )
        return f"<table><tr>{head}</tr>{rows}</table><p>{count} increments, {len(self)} columns</p>"


class Interfaces:
    """State of the interface points at a frame. Arrays are read-only with one row per contact point and four points
    per slave facet. They are empty if the model has no interfaces.
    """

    def __init__(self, fields: _wythe.Fields, frame: int) -> None:
        self._fields = fields
        self._frame = frame

    def _field(self, name: str, *width: int, kind: type = np.float64) -> npt.NDArray[Any]:
        full = f"interfaces.{name}"
        if full not in self._fields.names():
            return _nothing(0, *width, kind=kind)
        return self._fields.field(full, self._frame)

    @cached_property
    def opening(self) -> Floats:
        """Opening u, negative if closed [mm]. Shape (points,)."""
        return self._field("opening")

    @cached_property
    def slip(self) -> Floats:
        """Slip along the two tangents of the facet [mm]. Shape (points, 2)."""
        return self._field("slip", 2)

    @cached_property
    def traction(self) -> Floats:
        """Traction: normal, two shears, tension positive [MPa]. Shape (points, 3)."""
        return self._field("traction", 3)

    @cached_property
    def damage(self) -> Floats:
        """Damage D [-]. Shape (points,)."""
        return self._field("damage")

    @cached_property
    def state(self) -> npt.NDArray[np.uint8]:
        """State of the bond: 0 intact, 1 softening, 2 failed and open, 3 failed and sliding. Shape (points,)."""
        return self._field("state", kind=np.uint8)

    @cached_property
    def displacement(self) -> Floats:
        """Displacement of the corners of the quads [mm]. Shape (corners, 3)."""
        return self._field("displacement", 3)

    @cached_property
    def corners(self) -> Floats:
        """Corners of the quads at rest [mm]. Shape (corners, 3)."""
        return self._fields.surface()[0]

    @cached_property
    def quads(self) -> npt.NDArray[np.uint32]:
        """Corners of the quad around each point. Shape (points, 4)."""
        return self._fields.surface()[1]

    def __len__(self) -> int:
        """Number of points."""
        return len(self.quads)

    def __repr__(self) -> str:
        return f"<wythe.Interfaces of frame {self._frame}: {len(self)} points>"


class Frame:
    """Fields of one frame, each read at its first access. Arrays are read-only. Values of elements are means (stress,
    plastic strain, crack width) or largest values (damage) over the points of the element.
    """

    def __init__(self, fields: _wythe.Fields, frame: int, time: float, increment: int) -> None:
        self._fields = fields
        self.number = frame
        self.time = time
        self.increment = increment

    number: int
    """Number, from 0."""
    time: float
    """Step time, accumulated over all steps [s]."""
    increment: int
    """Number of increments up to the frame."""

    def _field(self, name: str) -> npt.NDArray[Any]:
        return self._fields.field(name, self.number)

    @cached_property
    def displacement(self) -> Floats:
        """Displacement [mm]. Shape (nodes, 3)."""
        return self._field("displacement")

    @cached_property
    def velocity(self) -> Floats:
        """Velocity [mm/s]. Shape (nodes, 3), or (0, 3) if no step may have inertia."""
        if "velocity" not in self._fields.names():
            return _nothing(0, 3)
        return self._field("velocity")

    @cached_property
    def stress(self) -> Floats:
        """Nominal stress xx, yy, zz, xy, yz, zx [MPa]. Shape (elements, 6)."""
        return self._field("stress")

    @cached_property
    def principal_stress(self) -> Floats:
        """Principal nominal stresses, the largest first [MPa]. Shape (elements, 3)."""
        return self._field("principal_stress")

    @cached_property
    def plastic_strain(self) -> Floats:
        """Plastic strain, engineering shear [-]. Shape (elements, 6)."""
        return self._field("plastic_strain")

    @cached_property
    def tensile_damage(self) -> Floats:
        """Tensile damage [-]. Shape (elements,)."""
        return self._field("tensile_damage")

    @cached_property
    def compressive_damage(self) -> Floats:
        """Compressive damage [-]. Shape (elements,)."""
        return self._field("compressive_damage")

    @cached_property
    def crack_width(self) -> Floats:
        """Width of the cracks smeared in the elements [mm]. Shape (elements,)."""
        return self._field("crack_width")

    @cached_property
    def yielded(self) -> npt.NDArray[np.bool_]:
        """Whether any point of the element has plastic strain or damage. Shape (elements,)."""
        return self._field("yielded").view(np.bool_)

    @cached_property
    def interfaces(self) -> Interfaces:
        """The interfaces at this frame."""
        return Interfaces(self._fields, self.number)

    def __repr__(self) -> str:
        return f"<wythe.Frame {self.number}: t = {self.time:g} s, increment {self.increment}>"


def _nothing(*shape: int, kind: type = np.float64) -> npt.NDArray[Any]:
    """An empty read-only array for a missing field."""
    nothing: npt.NDArray[Any] = np.zeros(shape, kind)
    nothing.flags.writeable = False
    return nothing
