"""Drawing of a run: views of the wall, and curves by matplotlib."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Literal, SupportsFloat, Union

from wythe import _wythe
from wythe._errors import as_path, expected

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from wythe._results import Results

__all__ = ["Face", "Kind", "View", "factor_of", "plot_columns", "plot_curve", "seen_from"]

#: Kinds of pictures of :meth:`wythe.Results.picture`.
Kind = Literal["curves", "columns", "cracks", "deflection_height", "deflection_length"]
#: Faces of a wall; the front is at the smallest y.
Face = Literal["front", "back", "left", "right", "top"]
#: Direction of a view: ``"iso"``, a face, or degrees around from the front and above.
View = Union[str, "tuple[float, float]"]


def seen_from(face: str | None, section: str | None, view: View | None) -> str:
    """The one view that is given, as Rust reads it."""
    given = [one for one in (face, section, view) if one is not None]
    if len(given) > 1:
        raise ValueError("face, section, view: expected one of them")
    if section is not None and "=" not in section:
        raise ValueError(f"section: expected an axis and mm, as 'y=125', got {section!r}")
    if not given:
        return "front"
    seen = given[0]
    return seen if isinstance(seen, str) else ",".join(str(float(part)) for part in seen)


def factor_of(scale: float | None) -> float | None:
    """A magnification, or the exception that explains why it is none."""
    if scale is not None and (isinstance(scale, (bool, str)) or not isinstance(scale, SupportsFloat)):
        raise expected("scale", "a number from 0", scale)
    if scale is not None and not (math.isfinite(scale) and scale >= 0.0):
        raise ValueError(f"scale: expected a number from 0, got {scale}")
    return None if scale is None else float(scale)


def plot_curve(
    run: Results, experiment: str | os.PathLike[str] | None, ax: Axes | None, label: str
) -> Axes:
    """The load-displacement curve with its peak, and a measured one."""
    from matplotlib import pyplot

    if ax is None:
        _, ax = pyplot.subplots()
    driven = run.history["driven"]
    way, force = run.history["displacement_mm"][driven], run.history["force_kN"][driven]
    ax.plot(way, force, label=label)
    if not math.isnan(run.peak_force):
        ax.plot([run.displacement_at_peak], [run.peak_force], "o", color="0.3", markersize=4)
    if experiment is not None:
        name, points = _wythe.experiment(as_path("experiment", experiment))
        ax.plot(points[:, 0], points[:, 1], "--", color="0.4", label=name)
    ax.set_xlabel("displacement [mm]")
    ax.set_ylabel("force [kN]")
    ax.grid(True, alpha=0.3)
    ax.legend()
    return ax


def plot_columns(
    run: Results, x: str, names: list[str], ax: Axes | None, label: str | None
) -> Axes:
    """Columns of the history over another one."""
    from matplotlib import pyplot

    for name in [x, *names]:
        if not isinstance(name, str):
            raise expected("x, y", "names of columns", name)
    axes = {name: _wythe.history_column(run.path, name) for name in [x, *names]}
    if ax is None:
        _, ax = pyplot.subplots()
    for name in names:
        said = axes[name] if label is None else label if len(names) == 1 else f"{label}: {name}"
        ax.plot(run.history[x], run.history[name], label=said)
    ax.set_xlabel(axes[x])
    ax.set_ylabel(axes[names[0]] if len(names) == 1 else "")
    ax.grid(True, alpha=0.3)
    ax.legend()
    return ax
