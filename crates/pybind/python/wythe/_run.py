"""Execution of runs: progress, callbacks and exceptions."""

from __future__ import annotations

import numbers
import os
import sys
import time
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TextIO

import numpy as np

from wythe import _wythe
from wythe._errors import ConvergenceError, RunInterrupted, as_path, expected, say
from wythe._laws import JointLaw, SolidLaw, split
from wythe._results import Results
from wythe._temporary import Temporary

__all__ = ["Increment"]


@dataclass(frozen=True)
class Increment:
    """A converged increment, passed to the callback of a run. Units are in the names.

    The attributes are the columns of ``history.csv`` that every run has; ``probes`` has the further ones by name: of
    probes, loads, ties, sections, reactions and the base shear.
    """

    increment: int
    step: int
    time: float
    displacement_mm: float
    force_kN: float
    reaction_kN: float
    iterations: int
    cutbacks: int
    external_work_J: float
    elastic_energy_J: float
    plastic_damage_dissipation_J: float
    interface_dissipation_J: float
    viscous_dissipation_J: float
    open_points: int
    sliding_points: int
    max_interface_damage: float
    max_tensile_damage: float
    max_compressive_damage: float
    out_of_balance: float
    residual: float
    kinetic_energy_J: float
    damping_dissipation_J: float
    numerical_dissipation_J: float
    contact_area_mm2: float
    load_factor: float
    procedure: str
    probes: Mapping[str, float]


#: Largest number of threads per core, as for the command; more only wait for each other.
MOST_OF_A_CORE = 4

Callback = Callable[[Increment], "bool | None"]


def in_notebook() -> bool:
    """Whether this is the kernel of a notebook, which can overwrite a line as a terminal does."""
    ipython: Any = sys.modules.get("IPython")
    return ipython is not None and hasattr(ipython.get_ipython(), "kernel")


class Follower:
    """Shows the progress of a run as a line on standard error."""

    def __init__(self, title: str, steps: list[dict[str, Any]], out: TextIO) -> None:
        self._title = title
        self._out = out
        self._in_place = out.isatty() or in_notebook()
        self._names = [str(step.get("name", step["kind"])) for step in steps]
        self._total = sum(float(step.get("duration", 1.0)) for step in steps)
        self._began = time.monotonic()
        self._shown = 0.0
        self._width = 0

    def show(self, row: Increment) -> None:
        """Shows an increment, if enough time has passed since the last one."""
        now = time.monotonic()
        if now - self._shown < (0.1 if self._in_place else 5.0):
            return
        self._shown = now
        done = row.time / self._total if self._total > 0.0 else 0.0
        self._say(
            f"{self._title}: {100 * min(done, 1.0):3.0f} %  {self._names[row.step]}  "
            f"{row.displacement_mm:.3f} mm  {row.force_kN:.2f} kN  {now - self._began:.1f} s",
            end="" if self._in_place else "\n",
        )

    def note(self, text: str) -> None:
        """Shows a message of the solver."""
        self._say(text, end="\n")

    def finish(self, text: str) -> None:
        """Shows the last line."""
        self._say(f"{self._title}: {text}", end="\n")

    def _say(self, text: str, end: str) -> None:
        start = "\r" if self._in_place else ""
        padding = " " * max(0, self._width - len(text)) if self._in_place else ""
        self._width = len(text) if end == "" else 0
        say(self._out, start + text + padding + end)


def _threads(threads: object) -> int | None:
    if threads is None:
        return None
    if isinstance(threads, bool) or not isinstance(threads, numbers.Integral):
        raise expected("threads", "a whole number from 1, or None", threads)
    threads = int(threads)
    if threads < 1:
        raise ValueError(f"threads: expected a whole number from 1, got {threads}")
    cores = _cores()
    taken = min(threads, MOST_OF_A_CORE * cores)
    if threads > cores:
        warnings.warn(
            f"threads: {threads} are more than the cores of this process ({cores}), which only slows it down; "
            f"{taken} are taken",
            RuntimeWarning,
            stacklevel=4,
        )
    return taken


def _cores() -> int:
    """Number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _listeners(
    callback: Callback | None, follower: Follower | None
) -> tuple[Callable[[dict[str, Any], dict[str, float]], bool] | None, Callable[[str], None] | None]:
    if callback is not None and not callable(callback):
        raise expected("callback", "a function of an Increment", callback)
    if callback is None and follower is None:
        return None, None

    def on_row(row: dict[str, Any], columns: dict[str, float]) -> bool:
        increment = Increment(**row, probes=columns)
        if follower is not None:
            follower.show(increment)
        answer = True if callback is None else callback(increment)
        # numpy.False_ is not the object False.
        return not (isinstance(answer, (bool, np.bool_)) and not answer)

    return on_row, None if follower is None else follower.note


def run_deck(
    deck: _wythe.Deck,
    out: str | os.PathLike[str] | None,
    threads: int | None,
    progress: bool,
    callback: Callback | None,
    laws: Mapping[str, JointLaw | SolidLaw] | None = None,
    error: bool = False,
) -> Results:
    """Implements :meth:`wythe.Model.run`."""
    of_python = split(laws)
    if not isinstance(error, bool):
        raise expected("error", "True or False", error)
    if error and laws:
        raise ValueError("error: not with laws of your own, which the companions of the run do not have")
    count = _threads(threads)
    follower = _follower(deck, progress)
    on_row, on_note = _listeners(callback, follower)
    temporary = None
    if out is None:
        temporary = Temporary()
        folder = temporary.run
    else:
        folder = as_path("out", out)

    def solve() -> None:
        _wythe.run(deck, folder, count, on_row, on_note, of_python)
        if error:
            _wythe.estimate_error(deck, folder, count, on_note)

    return _ended(folder, temporary, follower, solve, bool(laws))


def resume_run(
    results: Results,
    overrides: list[tuple[str, str]],
    threads: int | None,
    progress: bool,
    callback: Callback | None,
    laws: Mapping[str, JointLaw | SolidLaw] | None = None,
) -> Results:
    """Implements :meth:`wythe.Results.resume`."""
    of_python = split(laws)
    count = _threads(threads)
    text = results.deck
    follower = None
    if text is not None and progress:
        follower = _follower(_wythe.Deck.read(text, False, None, []), progress)
    on_row, on_note = _listeners(callback, follower)
    try:
        return _ended(
            results.path,
            results._temporary,
            follower,
            lambda: _wythe.resume(results._path, overrides, count, on_row, on_note, of_python),
            bool(laws),
        )
    finally:
        # The results remain those of the run, which may have another deck now.
        results._bind(results.path, results._temporary)


def _follower(deck: _wythe.Deck, progress: bool) -> Follower | None:
    if not isinstance(progress, bool):
        raise expected("progress", "True or False", progress)
    return Follower(deck.title, deck.steps(), sys.stderr) if progress else None


def _ended(
    folder: str,
    temporary: Temporary | None,
    follower: Follower | None,
    solve: Callable[[], object],
    with_laws: bool,
) -> Results:
    try:
        solve()
    except KeyboardInterrupt as interrupt:
        if not os.path.isfile(os.path.join(folder, "history.csv")):
            raise
        results = Results._of(folder, temporary)
        if follower is not None:
            follower.finish("interrupted")
        if results.status in ("completed", "collapsed"):
            said = "interrupted in a companion: the run is complete, the estimate of its error is not"
        else:
            again = "resume(laws=...)" if with_laws else "resume()"
            said = f"interrupted after a whole increment; error.results.{again} goes on"
        raise RunInterrupted(said, results) from interrupt
    results = Results._of(folder, temporary)
    if follower is not None:
        follower.finish(results._in_a_line())
    if results.status == "not_converged":
        raise ConvergenceError(results.message, results)
    return results
