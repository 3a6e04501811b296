"""Pictures of measured and fitted curves."""

from __future__ import annotations

import importlib
import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from wythe._calibrate._curves import Response
from wythe._errors import need, write_bytes
from wythe._run import in_notebook

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from wythe._calibrate._result import CurveFit

COLUMNS = 3


def is_there() -> bool:
    """Whether matplotlib is installed."""
    try:
        importlib.import_module("matplotlib")
    except ImportError:
        return False
    return True


def figure(curves: Sequence[CurveFit], bands: Mapping[str, list[Response]]) -> Figure:
    """A panel for each test."""
    need("matplotlib", "plot")
    if in_notebook():
        # A notebook shows figures only after pyplot has chosen how.
        pyplot: Any = importlib.import_module("matplotlib.pyplot")
        pyplot.close(pyplot.figure())
    module: Any = importlib.import_module("matplotlib.figure")
    tests = list(dict.fromkeys(curve.test for curve in curves))
    columns = min(COLUMNS, len(tests))
    rows = -(-len(tests) // columns)
    made: Figure = module.Figure(figsize=(4.6 * columns, 3.4 * rows), layout="constrained")
    axes = made.subplots(rows, columns, squeeze=False)
    for panel in axes.flat[len(tests) :]:
        panel.set_visible(False)
    for panel, test in zip(axes.flat, tests, strict=False):
        _panel(panel, [curve for curve in curves if curve.test == test], bands.get(test, []))
    return made


def _panel(panel: Any, curves: Sequence[CurveFit], band: Sequence[Response]) -> None:
    end = 1.05 * max(float(curve.displacement.max()) for curve in curves)
    for at, drawn in enumerate(band):
        label = f"{len(band)} draws of the posterior" if at == 0 else None
        panel.plot(drawn.x, drawn.y, color="C0", alpha=0.25, linewidth=0.8, label=label)
    for at, curve in enumerate(curves):
        markers = {"marker": "osd^v"[at % 5], "markersize": 3, "linestyle": "none", "color": "0.35"}
        panel.plot(curve.displacement, curve.force, label=curve.curve, markerfacecolor="none", **markers)
    panel.plot(curves[0].x, curves[0].y, color="C3", label="fitted")
    panel.set_xlim(min(0.0, float(min(curve.displacement.min() for curve in curves))), end)
    panel.set_title(curves[0].test)
    panel.set_xlabel("displacement [mm]")
    panel.set_ylabel("force [kN]")
    panel.grid(visible=True, alpha=0.3)
    panel.legend(fontsize="small")


def png(made: Figure, name: str) -> str:
    """Writes a picture and returns its name."""
    content = io.BytesIO()
    made.savefig(content, format="png", dpi=130)
    return write_bytes(name, content.getvalue())
