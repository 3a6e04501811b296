"""Natural modes of a model or of a frame of a run."""

from __future__ import annotations

import json
import math
import os
from typing import Any

import numpy as np

from wythe import _wythe
from wythe._errors import as_path, expected
from wythe._frames import Floats
from wythe._picture import Picture

__all__ = ["Modes"]


def as_count(count: object) -> int:
    """A number of modes, or the exception that explains why it is none."""
    if isinstance(count, bool) or not isinstance(count, (int, np.integer)):
        raise expected("count", "a number of modes", count)
    if count < 1:
        raise ValueError(f"count: expected 1 or more, got {count}")
    return int(count)


class Modes:
    """Natural modes, the lowest first: :meth:`Model.modes` and :meth:`Results.modes` find them.

    Index 0 is the first mode. Masses are in tonne.
    """

    def __init__(self, found: _wythe.FoundShapes) -> None:
        self._found = found
        self._table: dict[str, Any] = json.loads(found.table())

    @property
    def table(self) -> dict[str, Any]:
        """All figures: the content of ``modes.json``."""
        return self._table

    def _column(self, key: str) -> Floats:
        rows = [math.inf if row[key] is None else row[key] for row in self._table["modes"]]
        values: Floats = np.array(rows, dtype=float)
        values.flags.writeable = False
        return values

    @property
    def frequencies(self) -> Floats:
        """Frequencies [Hz]; 0 of bodies that nothing holds. Shape (modes,)."""
        return self._column("frequency_Hz")

    @property
    def periods(self) -> Floats:
        """Periods [s]; inf without frequency. Shape (modes,)."""
        return self._column("period_s")

    @property
    def eigenvalues(self) -> Floats:
        """Squares of the circular frequencies [1/s²]; negative where the state is unstable. Shape (modes,)."""
        return self._column("eigenvalue")

    @property
    def participation(self) -> Floats:
        """Participation factors in x, y, z, of shapes with a largest displacement of 1. Shape (modes, 3)."""
        return self._column("participation")

    @property
    def effective_masses(self) -> Floats:
        """Effective modal masses in x, y, z [tonne]. Shape (modes, 3)."""
        return self._column("effective_mass_t")

    @property
    def residuals(self) -> Floats:
        """Relative residuals of the pairs. Shape (modes,)."""
        return self._column("residual")

    @property
    def shapes(self) -> Floats:
        """Shapes at the nodes, with a largest displacement of 1. Shape (modes, nodes, 3)."""
        return self._found.shapes()

    @property
    def nodes(self) -> Floats:
        """Positions of the nodes at rest [mm]. Shape (nodes, 3)."""
        return self._found.nodes()

    @property
    def total_mass(self) -> float:
        """Mass of the model [tonne]."""
        return float(self._table["total_mass_t"])

    @property
    def moving_mass(self) -> Floats:
        """Mass at free displacements in x, y, z [tonne]: the sum of the effective masses of all modes."""
        mass: Floats = np.array(self._table["moving_mass_t"], dtype=float)
        return mass

    @property
    def notes(self) -> list[str]:
        """Remarks: free or unstable motions, open joints."""
        return list(self._table["notes"])

    def picture(self, mode: int = 0) -> Picture:
        """Picture of a shape: the bodies at rest and displaced, in parallel projection."""
        count = len(self)
        if isinstance(mode, bool) or not isinstance(mode, (int, np.integer)):
            raise expected("mode", "a number", mode)
        if not -count <= mode < count:
            raise IndexError(f"mode: there is no mode {mode}: there are {count}")
        return Picture(self._found.picture(int(mode) % count))

    def write(self, out: str | os.PathLike[str]) -> list[str]:
        """Writes ``modes.json``, ``modes.vtkhdf`` and a picture of each mode into a folder and returns the files."""
        return [str(path) for path in self._found.write(as_path("out", out))]

    def __len__(self) -> int:
        return len(self._table["modes"])

    def __str__(self) -> str:
        return self._found.text()

    def __repr__(self) -> str:
        first = ", ".join(f"{f:.3g}" for f in self.frequencies[:3])
        return f"<wythe.Modes {self._table['title']!r}: {len(self)} modes, {first} ... Hz>"
