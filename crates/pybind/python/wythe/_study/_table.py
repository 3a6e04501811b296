"""Table of a study with one row per sample."""

from __future__ import annotations

import csv
import io
import json
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

import numpy as np
from numpy.typing import NDArray

from wythe._errors import as_path, expected, need, write_text
from wythe._study._errors import StudyError
from wythe._study._journal import Line, read
from wythe._study._ranking import Ranking, ranked
from wythe._study._text import page
from wythe._study._worker import MEASURES, folder_name

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped, unused-ignore]

STATUSES = ("completed", "collapsed", "not_converged", "interrupted", "failed", "lost")
"""Statuses of a sample; all but the last two have a run."""

# Numbers of rows shown in text and in a notebook, number of messages below, and columns in text.
SHOWN = 12
SHOWN_IN_HTML = 40
MESSAGES = 3
SHORT = ("peak_force_kN", "displacement_at_peak_mm", "initial_stiffness_kN_per_mm")


class Study:
    """Table of a study, as returned by :func:`wythe.study`. Rows are in the order of the samples.

    It supports ``len(study)``, ``study[0]`` (a row as a dict), ``study[:3]`` (a list of rows),
    ``study["peak_force_kN"]`` (a column) and iteration over the rows. Columns are ``sample`` (from 1), the parameters, ``status``, ``message``, ``attempts`` and the
    measures.
    """

    def __init__(self, lines: Sequence[Line], total: int, folder: Path | None = None) -> None:
        self._lines = sorted(lines, key=lambda line: line["sample"])
        self.total = total
        """Number of samples of the study, finished or not."""
        self.folder = folder
        """Folder of the journal, if there is one."""
        self.parameters: tuple[str, ...] = _names(line["parameters"] for line in self._lines)
        """Names of the columns of parameters."""
        found = _names(line["measures"] for line in self._lines)
        known = tuple(name for name in MEASURES if name in found)
        self.measures: tuple[str, ...] = known + tuple(n for n in found if n not in known)
        """Names of the columns of measures."""

    @staticmethod
    def load(folder: str | os.PathLike[str]) -> Study:
        """Reads the table from the folder of a study, finished or not."""
        path = Path(as_path("folder", folder))
        header, lines = read(path)
        return Study(lines, header["count"], path)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns."""
        return ("sample", *self.parameters, "status", "message", "attempts", *self.measures)

    @property
    def missing(self) -> tuple[int, ...]:
        """Samples that are not finished because the study was stopped."""
        done = {line["sample"] for line in self._lines}
        return tuple(number for number in range(1, self.total + 1) if number not in done)

    @property
    def statuses(self) -> dict[str, int]:
        """Number of samples by status."""
        counts = Counter(line["status"] for line in self._lines)
        return {status: counts[status] for status in STATUSES if counts[status]}

    def __len__(self) -> int:
        return len(self._lines)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (self._row(line) for line in self._lines)

    @overload
    def __getitem__(self, what: str) -> NDArray[Any]: ...

    @overload
    def __getitem__(self, what: int) -> dict[str, Any]: ...

    @overload
    def __getitem__(self, what: slice) -> list[dict[str, Any]]: ...

    def __getitem__(self, what: str | int | slice) -> NDArray[Any] | dict[str, Any] | list[dict[str, Any]]:
        """A column by its name, a row by its index from 0, or several rows by a slice."""
        if isinstance(what, str):
            return self.column(what)
        if isinstance(what, slice):
            return [self._row(line) for line in self._lines[what]]
        if not isinstance(what, SupportsIndex):
            raise expected("study[…]", "the name of a column, the number of a row or a slice", what)
        return self._row(self._lines[what])

    def column(self, name: str) -> NDArray[Any]:
        """A column of floats (NaN if missing), integers, booleans or texts."""
        if name not in self.columns:
            raise KeyError(f"no column {name!r}; there are {', '.join(self.columns)}")
        return _array([self._cell(line, name) for line in self._lines])

    def ranking(self, of: str = "peak_force_kN") -> Ranking:
        """Ranks the parameters by their effect on a measure.

        The ranking uses Spearman's rank correlation, which detects any monotone relation, and the coefficients of
        a linear regression of standardised columns: the change of the measure in standard deviations for a change
        of the parameter by one standard deviation. Samples without a number in ``of`` are excluded; samples that
        did not converge are included.
        """
        if of not in self.columns:
            raise KeyError(f"of: no column {of!r}; there are {', '.join(self.columns)}")
        cells = [self._cell(line, of) for line in self._lines]
        inputs = {
            name: [line["parameters"].get(name) for line in self._lines] for name in self.parameters
        }
        flags = [line["status"] == "not_converged" for line in self._lines]
        return ranked(of, cells, inputs, flags)

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a DataFrame; needs pandas (``pip install 'wythe[study]'``)."""
        need("pandas", "study")
        import pandas

        columns = {name: self.column(name) for name in self.columns}
        return pandas.DataFrame(columns, columns=list(columns))

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the table as CSV; missing numbers are empty, lists are JSON."""
        text = io.StringIO(newline="")
        writer = csv.writer(text)
        writer.writerow(self.columns)
        for row in self:
            writer.writerow([_csv(row[name]) for name in self.columns])
        write_text(as_path("path", path), text.getvalue())

    def run_folder(self, sample: int) -> Path:
        """Folder of the run of a sample, in a study with ``keep="results"``."""
        path = None if self.folder is None else self.folder / folder_name(sample)
        if path is None or not path.is_dir():
            raise StudyError(f"the run of sample {sample} was not kept; study(..., out=..., keep=\"results\")")
        return path

    def __repr__(self) -> str:
        names = self._shown_columns(text=True)
        rows = self._texts(names, self._lines)
        if len(rows) > SHOWN:
            rows[SHOWN - 4 : -4] = [["…"] * len(names)]
        widths = [max(map(len, column)) for column in zip(names, *rows, strict=True)]
        table = [
            "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
            for row in (names, *rows)
        ]
        return "\n".join([self._title(), *(table if rows else []), *self._messages()])

    def _repr_html_(self) -> str:
        names = self._shown_columns(text=False)
        more = len(self) - SHOWN_IN_HTML
        notes = [f"… {more} more"] if more > 0 else []
        return page(self._title(), names, self._texts(names, self._lines[:SHOWN_IN_HTML]), notes)

    def _texts(self, names: list[str], lines: list[Line]) -> list[list[str]]:
        return [[_told(self._cell(line, name)) for name in names] for line in lines]

    def _title(self) -> str:
        parts = [f"{number} {status.replace('_', ' ')}" for status, number in self.statuses.items()]
        if self.missing:
            parts.append(f"{len(self.missing)} not done")
        noun = "sample" if self.total == 1 else "samples"
        return f"Study of {self.total} {noun}: {', '.join(parts) or 'none done'}"

    def _messages(self) -> list[str]:
        """Messages of the samples that did not complete, each once."""
        said: dict[str, list[int]] = {}
        for line in self._lines:
            if line["message"]:
                said.setdefault(f"{line['status']}: {line['message']}", []).append(line["sample"])
        told = [
            f"sample {samples[0]}{f' and {len(samples) - 1} more' if len(samples) > 1 else ''} {message}"
            for message, samples in said.items()
        ]
        return [*told[:MESSAGES], *(["…"] if len(told) > MESSAGES else [])]

    def _shown_columns(self, text: bool) -> list[str]:
        short = [name for name in SHORT if name in self.measures]
        own = [name for name in self.measures if name not in MEASURES]
        says = any(line["message"] for line in self._lines)
        names = ["sample", *self.parameters, "status", *short, *own]
        return [*names, "message"] if says and not text else names

    def _row(self, line: Line) -> dict[str, Any]:
        return {name: self._cell(line, name) for name in self.columns}

    def _cell(self, line: Line, name: str) -> Any:
        if name in self.parameters:
            return line["parameters"].get(name)
        if name in self.measures:
            return line["measures"].get(name)
        row: Any = line
        return row[name]


def _names(mappings: Any) -> tuple[str, ...]:
    """All keys in the order of their first occurrence."""
    return tuple(dict.fromkeys(name for mapping in mappings for name in mapping))


def _array(cells: list[Any]) -> NDArray[Any]:
    # The narrowest type first; a bool is an int.
    for kind, dtype in ((bool, np.bool_), (int, np.int64), (str, np.str_)):
        if cells and all(isinstance(cell, kind) for cell in cells):
            return np.array(cells, dtype=dtype)
    if all(cell is None or isinstance(cell, (int, float)) for cell in cells):
        return np.array([np.nan if cell is None else cell for cell in cells], dtype=np.float64)
    column = np.empty(len(cells), dtype=np.object_)
    column[:] = cells
    return column


def _told(value: object) -> str:
    if value is None:
        return "–"
    if isinstance(value, float):
        return f"{value:.5g}"
    return json.dumps(value) if isinstance(value, list) else str(value)


def _csv(value: object) -> object:
    if value is None:
        return ""
    return json.dumps(value) if isinstance(value, (list, bool)) else value
