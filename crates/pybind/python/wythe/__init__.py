"""wythe computes masonry to collapse with the detailed micro-model.

>>> import wythe
>>> wall = wythe.templates.couplet()
>>> run = wall.run()
>>> run.status
'completed'

Units are N, mm, MPa, tonne and s; forces of histories are in kN. Tension is positive, and so is the gap of an
open joint.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TypedDict

from wythe import _wythe, build, templates, tests
from wythe._calibrate import (
    Calibration,
    CalibrationError,
    CurveFit,
    FailedRun,
    Posterior,
    calibrate,
)
from wythe._drive import (
    InterfaceResponse,
    InterfaceState,
    MaterialResponse,
    MaterialState,
    drive_interface,
    drive_material,
)
from wythe._errors import (
    ConvergenceError,
    LawError,
    LimitError,
    ModelError,
    OutputError,
    PointError,
    RunInterrupted,
    WytheError,
    as_path,
    expected,
)
from wythe._frames import Frame, History, Interfaces
from wythe._laws import JointLaw, SolidLaw
from wythe._limit import LimitAnalysis
from wythe._model import Findings, Model, Problem
from wythe._modes import Modes
from wythe._picture import Picture
from wythe._results import Results
from wythe._run import Increment
from wythe._study import (
    Distribution,
    Rank,
    Ranking,
    Study,
    StudyError,
    StudyInterrupted,
    WorkerDied,
    Workers,
    latin_hypercube,
    lognormal,
    normal,
    study,
)

__version__ = _wythe.__version__

__all__ = [
    "Calibration",
    "CalibrationError",
    "ConvergenceError",
    "CurveFit",
    "Distribution",
    "FailedRun",
    "Findings",
    "Frame",
    "History",
    "Increment",
    "InterfaceResponse",
    "InterfaceState",
    "Interfaces",
    "JointLaw",
    "LawError",
    "LimitAnalysis",
    "LimitError",
    "MaterialResponse",
    "MaterialState",
    "Model",
    "ModelError",
    "Modes",
    "OutputError",
    "Picture",
    "PointError",
    "Posterior",
    "Problem",
    "Rank",
    "Ranking",
    "Results",
    "RunInterrupted",
    "Salvaged",
    "SolidLaw",
    "Study",
    "StudyError",
    "StudyInterrupted",
    "WorkerDied",
    "Workers",
    "WytheError",
    "__version__",
    "build",
    "calibrate",
    "command",
    "drive_interface",
    "drive_material",
    "latin_hypercube",
    "lognormal",
    "normal",
    "salvage",
    "schema",
    "study",
    "templates",
    "tests",
]


def command(arguments: Sequence[str]) -> int:
    """Runs the ``wythe`` command with these arguments and returns its exit code.

    It prints to the output of the process. It serves commands without a function of their own, such as
    ``study stability``.
    """
    if isinstance(arguments, str) or not all(isinstance(item, str) for item in arguments):
        raise expected("arguments", "a sequence of str, e.g. ['check', 'wall.toml']", arguments)
    if arguments and arguments[0] == "calibrate":
        from wythe._calibrate._command import command as of_calibration

        return of_calibration(arguments[1:])
    code = _wythe.command(["wythe", *arguments])
    if list(arguments) in (["--help"], ["-h"], ["help"]):
        from wythe._calibrate._command import IN_HELP

        print(IN_HELP)
    return code


def schema() -> str:
    """The JSON schema of decks, as ``wythe schema`` prints it."""
    return _wythe.schema()


class Salvaged(TypedDict):
    """Result of :func:`salvage`."""

    messages: int
    attachments: int
    lost_bytes: int
    was_whole: bool


def salvage(path: str | os.PathLike[str], out: str | os.PathLike[str] | None = None) -> Salvaged:
    """Repairs the messages (``run.mcap``) of an interrupted run, in place or as ``out``.

    The file gets its end and its index.

    Returns
    -------
    Salvaged
        A dictionary of ``messages``, ``attachments``, ``lost_bytes`` after the last complete record, and whether
        the file ``was_whole``.
    """
    target = None if out is None else as_path("out", out)
    messages, attachments, lost, whole = _wythe.salvage(as_path("path", path), target)
    return {
        "messages": messages,
        "attachments": attachments,
        "lost_bytes": lost,
        "was_whole": whole,
    }
