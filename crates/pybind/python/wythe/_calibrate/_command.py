"""``wythe calibrate`` of the Python package."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Sequence
from typing import Any

from wythe._calibrate._api import calibrate
from wythe._calibrate._errors import CalibrationError
from wythe._errors import ModelError, OutputError, WytheError, say

ABOUT = """\
Finds parameters of decks from measured curves by least squares (docs/reference/calibration.md lists every key of a
job). It writes a folder with calibration.json, calibration.md, materials.toml and curves.png. The same command
continues a calibration that was stopped."""

CODES = """\
Exit codes: 0 fitted; 2 bad job or usage; 3 the fit did not converge, results kept; 4 input/output; 130 interrupted."""

# Told below the help of the command, whose other half does not know of this one.
IN_HELP = """
Of the Python package:
  calibrate    Find parameters of decks from measured curves"""


def command(arguments: Sequence[str]) -> int:
    """Runs ``wythe calibrate`` with the arguments behind it and returns its exit code."""
    try:
        said = _parser().parse_args(list(arguments))
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 2
    out = said.out
    try:
        found = calibrate(
            said.job,
            posterior=said.posterior,
            executor=said.workers,
            out=_folder(said.job) if out is None else out,
            progress=not said.quiet,
        )
    except KeyboardInterrupt:
        return _failed("interrupted; the same command continues", 130)
    except OutputError as error:
        return _failed(str(error), 4)
    except (CalibrationError, ModelError) as error:
        of_file = isinstance(error, CalibrationError) and isinstance(error.__cause__, OSError)
        return _failed(str(error), 4 if of_file else 2)
    except (WytheError, ImportError) as error:
        return _failed(str(error), 2)
    if said.json:
        print(json.dumps(found.summary, indent=2, ensure_ascii=False))
    elif not said.quiet:
        print(found)
    return 0 if found.converged else 3


def _folder(job: str) -> str | None:
    """The folder of the result, unless the job names one: JOB.out beside the job."""
    from wythe._calibrate._read import job_of_file

    return None if job_of_file(job).out is not None else f"{os.path.splitext(job)[0]}.out"


def _failed(text: str, code: int) -> int:
    say(sys.stderr, f"error: {text}\n")
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="wythe calibrate",
        description=ABOUT,
        epilog=CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add: Any = parser.add_argument
    add("job", metavar="JOB", help="the job, a TOML file")
    add("--out", metavar="DIR", help="folder of the result [default: `out` of the job, else JOB.out beside the job]")
    add("--workers", metavar="N", type=_count, help="number of runs side by side [default: all cores]")
    add(
        "--posterior",
        choices=("none", "linearised", "model"),
        help="sample the posterior so, instead of as the job says",
    )
    add("--json", action="store_true", help="print the summary as JSON")
    add("-q", "--quiet", action="store_true", help="print errors only")
    return parser


def _count(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("expected a whole number from 1")
    return number
