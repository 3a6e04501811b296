"""Results of a run, read from its folder on request."""

from __future__ import annotations

import html
import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
import numpy.typing as npt

from wythe import _wythe
from wythe._drawing import Face, Kind, View, factor_of, plot_columns, plot_curve, seen_from
from wythe._errors import OutputError, as_path, expected, need, unwritten, write_text
from wythe._figures import RunFigures, as_height
from wythe._frames import Floats, Frame, Interfaces
from wythe._grids import as_meshio, as_pyvista
from wythe._modes import Modes, as_count
from wythe._picture import Picture
from wythe._temporary import Temporary

if TYPE_CHECKING:
    import meshio
    import pyvista
    from matplotlib.axes import Axes

    from wythe._laws import JointLaw, SolidLaw
    from wythe._model import Model, Value
    from wythe._run import Increment

__all__ = ["Results"]

#: A frame: its number from 0 (from the end if negative), ``"peak"`` or ``"last"``.
FrameNumber = Union[int, "np.integer[Any]", Literal["peak", "last"]]


class Results(RunFigures):
    """Results in the folder of a run that has ended, is in progress or was killed. Large data are read on request.

    Parameters
    ----------
    path
        Folder of a run, or its ``results.vtkhdf``.

    Raises
    ------
    OutputError
        The folder is not that of a run.
    """

    @classmethod
    def _of(cls, path: str, temporary: Temporary | None) -> Results:
        results = cls.__new__(cls)
        results._bind(path, temporary)
        return results

    @cached_property
    def reactions(self) -> dict[str, Floats]:
        """External forces [N] on beams, supports and loads at every increment that ``results.vtkhdf`` has, by
        ``"beams/NAME"``, ``"supports/NAME"``, ``"loads/NAME"``. Shape (increments, 3) each.
        """
        return self._fields.reactions()

    @property
    def base_shear(self) -> Floats | None:
        """Sum of the support reactions along the drive, with the sign with which it balances the drive [kN]; None if
        nothing is driven sideways, or before the end of the run. Shape (increments,).
        """
        direction = self.answers["drive_direction"]
        if direction is None or direction.endswith("z"):
            return None
        if direction.startswith("("):
            parts = [float(part) for part in direction[1:-1].split(",")]
        else:
            sense = -1.0 if direction.startswith("-") else 1.0
            parts = [sense * (direction[-1] == axis) for axis in "xyz"]
        x, y, z = parts
        if abs(z) > max(abs(x), abs(y)):
            return None
        length = float(np.hypot(x, y))
        supports = [of for name, of in self.reactions.items() if name.startswith("supports/")]
        if not supports:
            return None
        along: Floats = -1e-3 / length * np.sum([x * of[:, 0] + y * of[:, 1] for of in supports], axis=0)
        return along

    @property
    def deck(self) -> str | None:
        """Deck of the run as TOML; None if the folder has no copy."""
        try:
            with open(os.path.join(self._path, "model.toml"), encoding="utf-8") as file:
                return file.read()
        except FileNotFoundError:
            return None

    @property
    def model(self) -> Model:
        """Model of the run."""
        from wythe._model import Model

        return Model._of(_wythe.Deck.of_run(self._path))

    @cached_property
    def _fields(self) -> _wythe.Fields:
        return _wythe.Fields.open(os.path.join(self._path, "results.vtkhdf"))

    @property
    def title(self) -> str:
        """Title of the model."""
        return self._fields.title_and_version()[0]

    def _name(self) -> str:
        """The title, if it can be read."""
        try:
            return self.title
        except OutputError:
            return "a run"

    @property
    def version(self) -> str:
        """Version of wythe of the run."""
        return self._fields.title_and_version()[1]

    @cached_property
    def times(self) -> Floats:
        """Step time of each frame [s]. Shape (frames,)."""
        return self._fields.times()

    @property
    def frames(self) -> int:
        """Number of frames."""
        return len(self.times)

    @cached_property
    def materials(self) -> tuple[str, ...]:
        """Names of the materials, in the order of :attr:`material`."""
        return tuple(self._fields.materials())

    @cached_property
    def _mesh(self) -> tuple[npt.NDArray[Any], ...]:
        return tuple(self._fields.mesh())

    @property
    def nodes(self) -> Floats:
        """Positions at rest [mm]. Shape (nodes, 3)."""
        return self._mesh[0]

    @property
    def elements(self) -> npt.NDArray[np.uint32]:
        """Nodes of the hexahedra, in VTK's order. Shape (elements, 8)."""
        return self._mesh[1]

    @property
    def material(self) -> npt.NDArray[np.uint16]:
        """Index of the material of each element. Shape (elements,)."""
        return self._mesh[2]

    @property
    def unit(self) -> npt.NDArray[np.uint32]:
        """Unit (body) of each element. Shape (elements,)."""
        return self._mesh[3]

    @property
    def course(self) -> npt.NDArray[np.uint16]:
        """Course of each element. Shape (elements,)."""
        return self._mesh[4]

    def _frame_number(self, frame: FrameNumber) -> int:
        count = self.frames
        if isinstance(frame, str):
            if frame not in ("peak", "last"):
                raise ValueError(f"frame: expected a number, 'peak' or 'last', got {frame!r}")
            if count == 0:
                raise IndexError(f"frame: there is no {frame} frame: the run has written none yet")
            if frame == "last":
                return count - 1
            at = _wythe.time_of_peak(self._path)
            return count - 1 if at is None else int(np.argmin(np.abs(self.times - at)))
        if isinstance(frame, bool) or not isinstance(frame, (int, np.integer)):
            raise expected("frame", "a number, 'peak' or 'last'", frame)
        number = int(frame) + (count if frame < 0 else 0)
        if not 0 <= number < count:
            raise IndexError(f"frame: there is no frame {frame}: the run has {count}")
        return number

    def frame(self, frame: FrameNumber = "last") -> Frame:
        """Fields of a frame, given by its number from 0, ``"peak"`` (of the largest force) or ``"last"``."""
        number = self._frame_number(frame)
        increment = int(self._fields.increments()[number])
        return Frame(self._fields, number, float(self.times[number]), increment)

    def interfaces(self, frame: FrameNumber = "last") -> Interfaces:
        """The interfaces at a frame."""
        return Interfaces(self._fields, self._frame_number(frame))

    def mesh(self, frame: FrameNumber = "last", *, scale: float = 1.0) -> pyvista.UnstructuredGrid:
        """The deformed solids at a frame with all their fields, for pyvista.

        Parameters
        ----------
        frame
            The frame.
        scale
            Magnification of the deformed shape; the displacement field is not scaled.
        """
        factor = factor_of(scale)
        return as_pyvista(self, self.frame(frame), 1.0 if factor is None else factor)

    def to_meshio(self, frame: FrameNumber = "last") -> meshio.Mesh:
        """The solids at rest with all fields of a frame, for meshio, which writes many formats."""
        return as_meshio(self, self.frame(frame))

    def modes(self, count: int = 10, *, frame: FrameNumber = "last") -> Modes:
        """The lowest natural modes at a frame, with the secant stiffness: damage of the solids, joints closed under
        pressure, by their secant in tension, without stiffness where open.

        Parameters
        ----------
        count
            Number of modes.
        frame
            The frame. Beams and driven faces are held or free as in the first step.

        Raises
        ------
        ModelError
            Something that can move has no mass.
        OutputError
            The folder has no deck.
        """
        number = str(self._frame_number(frame))
        return Modes(_wythe.modes_of_run(self._path, number, as_count(count)))

    def plot(
        self,
        experiment: str | os.PathLike[str] | None = None,
        *,
        x: str | None = None,
        y: str | Sequence[str] | None = None,
        ax: Axes | None = None,
        label: str | None = None,
    ) -> Axes:
        """Plots the load-displacement curve with matplotlib, together with a measured one if given; or any columns of
        the history. A run without a drive has its probes over time.

        Parameters
        ----------
        experiment
            A CSV file with a column of displacements and one of forces (see docs/how-to/compare-with-a-test.md).
        x, y
            Columns of the history, several for ``y``. Default: those of the curve, or time and the probes.
        ax
            Axes to draw into; new ones if not given.
        label
            Label in the legend; the title, or the names of the columns, if not given.

        Raises
        ------
        ValueError
            The history has no such column of numbers.
        """
        need("matplotlib", "plot")
        default_x, default_y = _wythe.default_columns(self._path)
        if x is not None or y is not None or default_x == "time" and experiment is None:
            names = default_y if y is None else [y] if isinstance(y, str) else list(y)
            return plot_columns(self, default_x if x is None else x, names, ax, label)
        return plot_curve(self, experiment, ax, self._name() if label is None else label)

    def picture(
        self,
        kind: Kind = "curves",
        *,
        frame: FrameNumber = "last",
        experiment: str | os.PathLike[str] | None = None,
        against: Mapping[str, Results] | None = None,
        x: str | None = None,
        y: str | Sequence[str] | None = None,
        face: Face | None = None,
        section: str | None = None,
        view: View | None = None,
        scale: float | None = None,
    ) -> Picture:
        """Draws a picture without further packages.

        Parameters
        ----------
        kind
            ``"curves"`` (load-displacement; of a run without a drive its probes over time), ``"columns"`` (any columns
            of the history), ``"cracks"`` (the wall with damage, joints, crack widths, supports and loads),
            ``"deflection_height"``, ``"deflection_length"``.
        frame
            Frame of the cracks and deflections.
        experiment
            CSV file with a measured curve, for ``"curves"``.
        against
            Further runs by name.
        x, y
            Columns, for ``"columns"``; several for ``y``.
        face, section, view
            One of them, for ``"cracks"``: a face (``"back"``), a section at rest (``"y=125"``), or a direction
            (``"iso"``, or degrees around from the front and above).
        scale
            Magnification of the displacements, for ``"cracks"``; a round one if not given.

        Raises
        ------
        ValueError
            There is no such kind, column or view, or the section meets no part of the model.
        """
        kinds = ("curves", "columns", "cracks", "deflection_height", "deflection_length")
        if kind not in kinds:
            raise ValueError(f"kind: expected one of {', '.join(kinds)}, got {kind!r}")
        others = against or {}
        if not isinstance(others, Mapping) or not all(isinstance(run, Results) for run in others.values()):
            raise expected("against", "a mapping from names to Results", against)
        runs = [(self._name(), self._path), *((name, run.path) for name, run in others.items())]
        measured = [] if experiment is None else [as_path("experiment", experiment)]
        if kind == "columns":
            names = [] if y is None else [y] if isinstance(y, str) else list(y)
            return Picture(_wythe.columns_picture(runs, x, names))
        if kind == "cracks":
            number = str(self._frame_number(frame))
            seen = seen_from(face, section, view)
            return Picture(_wythe.wall(self._path, number, seen, factor_of(scale)))
        # Curves need no frame, so a missing one is no error.
        number = "last" if kind == "curves" else str(self._frame_number(frame))
        return Picture(_wythe.picture(kind, runs, measured, number))

    def animate(
        self,
        path: str | os.PathLike[str],
        *,
        face: Face | None = None,
        section: str | None = None,
        view: View | None = None,
        scale: float | None = None,
        width: int = 960,
        delay: float = 0.15,
        curve: bool = True,
        most: int = 120,
    ) -> str:
        """Writes the deformed wall with its cracks, frame by frame, as an animated GIF and returns its path.

        Parameters
        ----------
        path
            Name of the file; it ends in ``.gif``.
        face, section, view, scale
            See :meth:`picture`.
        width
            Width of the picture [px].
        delay
            Time that each frame is shown [s].
        curve
            Whether the load-displacement curve lies beside the wall.
        most
            Largest number of frames, at even distances.
        """
        if not (50 <= width <= 4000 and most >= 1 and delay > 0.0):
            raise ValueError("animate: expected width from 50 to 4000, most from 1, delay above 0")
        name = as_path("path", path)
        if not name.lower().endswith(".gif") and not name.startswith("/dev/"):
            raise ValueError(f"path: expected a name that ends in .gif, the only format of an animation, got {name!r}")
        drawn = (int(width), float(delay), bool(curve), int(most))
        _wythe.animate(self._path, name, seen_from(face, section, view), factor_of(scale), drawn)
        return name

    def report(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        experiment: str | os.PathLike[str] | None = None,
    ) -> str:
        """Writes a report of the run as one self-contained HTML page and returns its path. By default it is in the
        folder of the run.
        """
        name = os.path.join(self._path, "report.html") if out is None else as_path("out", out)
        measured = None if experiment is None else as_path("experiment", experiment)
        _wythe.report(self._path, name, measured)
        return name

    def compare(
        self, experiment: str | os.PathLike[str], *, height: float | None = None
    ) -> dict[str, Any]:
        """Compares the run with an experiment: peaks, stiffnesses, energies, drifts, their ratios, and the
        difference of the curves. ``height`` [mm] is the clear height for drifts, by default that of the model.
        """
        if height is not None:
            height = as_height(height)
        found: dict[str, Any] = json.loads(
            _wythe.compare(self._path, as_path("experiment", experiment), height)
        )
        return found

    def export(
        self,
        to: Literal["vtu", "csv", "inp"],
        out: str | os.PathLike[str] | None = None,
        *,
        frame: FrameNumber | None = "last",
    ) -> list[str]:
        """Writes a frame (all frames if None) as ``"vtu"`` or ``"csv"``, or the model as ``"inp"``, and returns the
        files. The default folder is ``export`` in the folder of the run.
        """
        if to not in ("vtu", "csv", "inp"):
            raise ValueError(f"to: expected 'vtu', 'csv' or 'inp', got {to!r}")
        folder = os.path.join(self._path, "export") if out is None else as_path("out", out)
        if to == "inp":
            text = self.model.to_inp()
            try:
                os.makedirs(folder, exist_ok=True)
            except OSError as error:
                raise unwritten(folder, error) from error
            return [write_text(os.path.join(folder, "model.inp"), text)]
        numbers = range(self.frames) if frame is None else [self._frame_number(frame)]
        written: list[str] = []
        series: list[tuple[float, str]] = []
        for number in numbers:
            files, time = _wythe.export_frame(self._path, to, str(number), folder)
            written += map(str, files)
            series.append((time, os.path.basename(files[0])))
        if to == "vtu" and frame is None:
            name = os.path.join(folder, "series.pvd")
            written.append(write_text(name, _wythe.collection(series)))
        return written

    def resume(
        self,
        changes: Mapping[str, Value] | None = None,
        *,
        threads: int | None = None,
        progress: bool = False,
        callback: Callable[[Increment], bool | None] | None = None,
        laws: Mapping[str, JointLaw | SolidLaw] | None = None,
    ) -> Results:
        """Resumes a stopped run in its folder from the last checkpoint, like ``wythe resume``.

        Parameters
        ----------
        changes
            New values of keys that may change: ``output``, the title, a longer last step.
        threads, progress, callback
            See :meth:`wythe.Model.run`.
        laws
            The laws of your own with which the run began.

        Returns
        -------
        Results
            Results of the whole run. This object discards its cached data and shows the same results.
        """
        from wythe._model import _overrides
        from wythe._run import resume_run

        said = _overrides("changes", {} if changes is None else changes)
        try:
            return resume_run(self, said, threads, progress, callback, laws)
        finally:
            self._forget()

    def _forget(self) -> None:
        """Discards all cached data of the folder."""
        for name in list(self.__dict__):
            if isinstance(getattr(Results, name, None), cached_property):
                del self.__dict__[name]

    def _in_a_line(self) -> str:
        counts = f"{self.summary.get('increments', self.history.increments)} increments"
        seconds = self.summary.get("wall_s")
        parts = [self.status.replace("_", " ")]
        if not math.isnan(self.peak_force):
            word = "peak" if self.verdict_kind == "peak_passed" else "largest"
            parts.append(f"{word} {self.peak_force:.3f} kN at {self.displacement_at_peak:.4f} mm")
        parts.append(counts if seconds is None else f"{counts} in {seconds:.1f} s")
        return ", ".join(parts)

    def __reduce__(self) -> tuple[Any, ...]:
        if self._temporary is not None:
            raise TypeError(
                "these results lie in a temporary folder, which goes with this process: run with "
                "out=DIR to take them elsewhere"
            )
        return (Results, (os.path.abspath(self._path),))

    def __repr__(self) -> str:
        return f"<wythe.Results {self._name()!r}: {self._in_a_line()}; {self.path}>"

    def _repr_html_(self) -> str:
        line = html.escape(repr(self)[1:-1])
        try:
            svg = self.picture("curves").svg
        except (OutputError, ValueError):
            return f"<p>{line}</p>"
        return f"<p>{line}</p><div style='max-width:36em'>{svg}</div>"
