"""Key figures, answers and history of a run, read from its folder."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Literal, cast

import numpy as np

from wythe import _wythe
from wythe._errors import OutputError, as_path, expected
from wythe._frames import Floats, History
from wythe._temporary import Temporary

__all__ = ["RunFigures"]

#: Status of a run; ``"unfinished"`` without a summary.
Status = Literal[
    "completed", "collapsed", "not_converged", "interrupted", "stopped", "unfinished"
]
#: Verdict on a run in one word.
VerdictKind = Literal[
    "peak_passed",
    "still_rising",
    "plateau",
    "stands",
    "displaced",
    "moves",
    "collapsed",
    "not_converged",
    "interrupted",
    "stopped",
]


def _changed(folder: str) -> tuple[int, int] | None:
    """What changes when the copy of the deck in a folder is written: its place on the disk and its time."""
    try:
        found = os.stat(os.path.join(folder, "model.toml"))
    except OSError:
        return None
    return found.st_ino, found.st_mtime_ns


def _deck(folder: str) -> bytes | None:
    """Hash of the copy of the deck in a folder."""
    try:
        with open(os.path.join(folder, "model.toml"), "rb") as file:
            return hashlib.sha256(file.read()).digest()
    except OSError:
        return None


def as_height(height: object) -> float:
    """A clear height [mm]."""
    if isinstance(height, bool) or not isinstance(height, (int, float, np.integer, np.floating)):
        raise expected("height", "a number above 0 [mm]", height)
    if not (height > 0.0 and math.isfinite(height)):
        raise ValueError(f"height: expected a number above 0, got {height}")
    return float(height)


class RunFigures:
    """What the summary and the history of a run tell, without its fields."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        name = as_path("path", path)
        if os.path.isfile(name):
            name = os.path.dirname(name) or "."
        self._bind(name, None)
        # Raises an error at once if there is no history.
        self._history()

    def _bind(self, folder: str, temporary: Temporary | None) -> None:
        self._said = folder
        self._folder = os.path.abspath(folder)
        self._temporary = temporary
        self._changed, self._of_deck = _changed(self._folder), _deck(self._folder)

    @property
    def path(self) -> str:
        """The folder. The temporary folder of a run without ``out`` is removed together with this object."""
        return self._said

    @property
    def _path(self) -> str:
        """The folder, as long as it holds the run that it held at first."""
        changed = _changed(self._folder)
        if changed != self._changed:
            # A resumed run writes the same deck again.
            deck = _deck(self._folder)
            if deck is not None and deck != self._of_deck:
                raise OutputError(
                    f"{self._said}: another run was written into the folder, or this one was resumed with another "
                    "deck; wythe.Results(path) opens it anew"
                )
            self._changed = changed
        return self._folder

    @property
    def is_temporary(self) -> bool:
        """Whether the folder is removed together with this object."""
        return self._temporary is not None

    def _history(self) -> History:
        columns, probes = _wythe.history(self._path)
        columns["procedure"] = np.array(columns["procedure"], dtype=np.str_)
        columns["procedure"].flags.writeable = False
        return History(columns, tuple(probes))

    @cached_property
    def history(self) -> History:
        """The history at the time of the first access."""
        return self._history()

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Content of ``summary.json``; empty if the run has not ended or was killed."""
        text = _wythe.summary(self._path)
        if text is None:
            return {}
        said: dict[str, Any] = json.loads(text)
        return said

    @property
    def status(self) -> Status:
        """``"completed"``, ``"collapsed"``, ``"not_converged"``, ``"interrupted"`` (by Ctrl-C or an exception) or
        ``"stopped"`` (by the callback); ``"unfinished"`` without a summary.
        """
        return cast(Status, self.summary.get("status", "unfinished"))

    @property
    def verdict(self) -> str:
        """Verdict on the run in one sentence; empty if the run has not ended or was killed."""
        return str(self.summary.get("verdict", ""))

    @property
    def verdict_kind(self) -> VerdictKind | None:
        """Verdict in one word; None if the run has not ended or was killed."""
        return cast("VerdictKind | None", self.summary.get("verdict_kind"))

    @property
    def message(self) -> str:
        """Place, reason and remedy, if the run did not complete."""
        return str(self.summary.get("message", ""))

    @property
    def warnings(self) -> list[str]:
        """Warnings of the model, followed by those of the run."""
        return list(self.summary.get("warnings", []))

    @property
    def log(self) -> list[str]:
        """Changes of the procedure with their reasons."""
        return list(self.summary.get("log", []))

    @cached_property
    def _figures(self) -> Mapping[str, Any]:
        """Key figures: of the summary, or without one those that follow from the history."""
        return self.summary or _wythe.figures(self._path)

    def _number(self, key: str) -> float:
        value = self._figures.get(key)
        return math.nan if value is None else float(value)

    @property
    def peak_force(self) -> float:
        """Largest force in equilibrium along the drive [kN]; a peak if ``verdict_kind`` says so, nan without one."""
        return self._number("peak_force_kN")

    @property
    def displacement_at_peak(self) -> float:
        """Displacement at the largest force [mm]."""
        return self._number("displacement_at_peak_mm")

    @property
    def displacement_at_80_percent(self) -> float:
        """Displacement after the peak at which the force has fallen to 0.8 of it [mm]; nan if it never does."""
        return self._number("displacement_at_80_percent_mm")

    @property
    def initial_stiffness(self) -> float:
        """Secant stiffness up to a tenth of the peak [kN/mm]."""
        return self._number("initial_stiffness_kN_per_mm")

    @property
    def energy_balance_error(self) -> float:
        """Largest error of the energy balance over the largest work [-]; nan if the run has not ended or was killed."""
        return self._number("energy_balance_error")

    @property
    def error_estimate(self) -> dict[str, Any]:
        """Estimated error of peak, area and displacement at the peak, of a run with ``error=True``; empty without.

        The keys are those of ``error_estimate`` in ``summary.json``.
        """
        return dict(self.summary.get("error_estimate") or {})

    @property
    def error_lines(self) -> list[str]:
        """The same in sentences: ``peak 108.5 ± 1.9 kN (1.7 %, mostly mesh) at 3.6 ± 0.3 mm``; empty without."""
        return _wythe.error_lines(self._path)

    @cached_property
    def answers(self) -> dict[str, Any]:
        """Answers in the terms of engineers: bilinear curve, loops, first damage, mode of failure, crack widths, points
        at the drift limits of EN 1998-3.

        The keys are those of ``answers`` in ``summary.json``. A run that has not ended has those of its curve.
        """
        said: dict[str, Any] = json.loads(_wythe.answers(self._path)[0])
        return said

    @property
    def answer_lines(self) -> list[str]:
        """The answers in lines, as ``wythe info`` prints them."""
        return [f"{head}: {text}" for head, text in _wythe.answers(self._path)[1]]

    def at_drifts(
        self, drifts: float | Sequence[float], *, height: float | None = None
    ) -> list[dict[str, Any]]:
        """Force and displacement of the curve at drifts [-], or at one, over ``height`` [mm], by default the clear
        height of the model. The keys are those of ``performance_points``.

        Raises
        ------
        ValueError
            Nothing was driven, or the model has no clear height and none is given.
        """
        try:
            wanted = [float(drift) for drift in np.atleast_1d(np.asarray(drifts, dtype=np.float64))]
        except (TypeError, ValueError) as error:
            raise expected("drifts", "numbers above 0", drifts) from error
        if not all(drift > 0.0 and math.isfinite(drift) for drift in wanted):
            raise ValueError(f"drifts: expected numbers above 0, got {wanted}")
        if height is not None:
            height = as_height(height)
        found: list[dict[str, Any]] = json.loads(_wythe.at_drifts(self._path, wanted, height))
        return found

    @property
    def sections(self) -> dict[str, dict[str, Floats]]:
        """Forces [kN] and moments [kN m] in the sections by the name of the section, then by that of the component:
        ``"N_kN"``, ``"Vx_kN"``, ``"My_kNm"``, … Shape (increments,) each. Empty without sections.
        """
        found: dict[str, dict[str, Floats]] = {}
        columns = self.history.probes
        for first, column in enumerate(columns):
            name, end = column[: -len("_N_kN")], column[-len("_N_kN") :]
            own = columns[first : first + 6]
            if end == "_N_kN" and own[-1] == f"{name}_T_kNm":
                found[name] = {of[len(name) + 1 :]: self.history[of] for of in own}
        return found
