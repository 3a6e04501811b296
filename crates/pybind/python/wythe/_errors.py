"""The exceptions of wythe."""

from __future__ import annotations

import contextlib
import importlib
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wythe._results import Results

__all__ = [
    "ConvergenceError",
    "LawError",
    "LimitError",
    "ModelError",
    "OutputError",
    "PointError",
    "RunInterrupted",
    "WytheError",
]


class WytheError(Exception):
    """Base class of the exceptions of wythe."""


class ModelError(WytheError, ValueError):
    """An invalid model: the deck cannot be parsed or its values are not admissible.

    Attributes
    ----------
    kind : str
        Kind of the error, the same whatever the words of the message: ``syntax``, ``unknown-key``, ``missing``,
        ``value``, ``unknown-name``, ``conflict``, ``geometry``, ``unheld``, ``too-many``, ``data``, ``mesh``, ``file``.
    file : str or None
        The file, if there is one.
    line, column : int or None
        Position in the text, from 1, if the model was read from a text.
    key : str
        Dotted path of the key in the deck (``materials.brick.E``); empty for the deck as a whole.
    message : str
        Description of the error.
    fix : str
        Advice on a correction.
    others : tuple of ModelError
        Further errors of the same deck.
    """

    def __init__(
        self,
        message: str,
        *,
        key: str = "",
        fix: str = "",
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        others: Sequence[ModelError] = (),
        kind: str = "value",
    ) -> None:
        super().__init__(message)
        self.kind = kind
        self.message = message
        self.key = key
        self.fix = fix
        self.file = file
        self.line = line
        self.column = column
        self.others: tuple[ModelError, ...] = tuple(others)

    def __str__(self) -> str:
        lines = [self._told()]
        lines += [other._told() for other in self.others]
        return "\n".join(lines)

    def _told(self) -> str:
        place = self.file or ""
        if self.line is not None:
            place = f"{place or 'line '}{':' if place else ''}{self.line}"
            if self.column is not None:
                place += f":{self.column}"
        parts = [part for part in (place, self.key, self.message) if part]
        text = ": ".join(parts)
        return f"{text}\n  fix: {self.fix}" if self.fix else text

    def __reduce__(self) -> tuple[Any, ...]:
        return (
            _rebuilt,
            (
                self.message,
                self.key,
                self.fix,
                self.file,
                self.line,
                self.column,
                self.others,
                self.kind,
            ),
        )


def _rebuilt(
    message: str,
    key: str,
    fix: str,
    file: str | None,
    line: int | None,
    column: int | None,
    others: tuple[ModelError, ...],
    kind: str,
) -> ModelError:
    return ModelError(
        message, key=key, fix=fix, file=file, line=line, column=column, others=others, kind=kind
    )


class LawError(WytheError, ValueError):
    """A law that a Python function gives has failed: an exception, a wrong shape, a number that is not finite, or a
    check that it does not pass. The message names the law; the exception of the function is the cause."""


class LimitError(WytheError, ValueError):
    """A limit analysis has no factor: the dead loads alone are too much, any factor is carried, nothing is live.

    Attributes
    ----------
    message : str
        The reason.
    fix : str
        Advice on a remedy.
    """

    def __init__(self, message: str, fix: str) -> None:
        super().__init__(message, fix)
        self.message = message
        self.fix = fix

    def __str__(self) -> str:
        return f"{self.message}\n  fix: {self.fix}"


class ConvergenceError(WytheError, RuntimeError):
    """A run lost convergence.

    Attributes
    ----------
    message : str
        Place, reason and remedy.
    results : Results
        Results up to the last converged increment.
    """

    def __init__(self, message: str, results: Results) -> None:
        # Both arguments, so that a pickled copy has both.
        super().__init__(message, results)
        self.message = message
        self.results = results

    def __str__(self) -> str:
        return self.message


class PointError(WytheError, RuntimeError):
    """A single point has no solution: a stress exceeds its strength, or a step is too large for the law.

    Attributes
    ----------
    path, row : int
        Path and row of the failure, from 0.
    """

    def __init__(self, message: str, path: int, row: int) -> None:
        super().__init__(message, path, row)
        self.path = path
        self.row = row

    def __str__(self) -> str:
        return f"path {self.path}, row {self.row}: {self.args[0]}"


class OutputError(WytheError, OSError):
    """A file could not be read or written; ``errno`` is the number of the system error, if there is one.

    Attributes
    ----------
    fix : str
        Advice on a remedy.
    """

    fix: str = ""

    def __str__(self) -> str:
        # args is (message,) or (number, message).
        text = str(self.args[-1]) if self.args else ""
        return f"{text}\n  fix: {self.fix}" if self.fix else text


class RunInterrupted(KeyboardInterrupt):
    """Ctrl-C during a run: a KeyboardInterrupt with the results so far.

    Attributes
    ----------
    message : str
        Advice.
    results : Results
        Results up to the last complete increment. ``results.resume()`` continues from there.
    """

    def __init__(self, message: str, results: Results) -> None:
        # Both arguments, so that a pickled copy has both.
        super().__init__(message, results)
        self.message = message
        self.results = results

    def __str__(self) -> str:
        return self.message


# Constructors used by the Rust half.

_Told = tuple[str, "str | None", "int | None", "int | None", str, str, str]


def _model_error(told: list[_Told]) -> ModelError:
    def one(error: _Told, others: Sequence[ModelError] = ()) -> ModelError:
        kind, file, line, column, key, message, fix = error
        return ModelError(
            message,
            key=key,
            fix=fix,
            file=file,
            line=line,
            column=column,
            others=others,
            kind=kind,
        )

    return one(told[0], [one(error) for error in told[1:]])


def _output_error(message: str, fix: str, number: int | None) -> OutputError:
    error = OutputError(message) if number is None else OutputError(number, message)
    error.fix = fix
    return error


def unwritten(name: str, error: OSError) -> OutputError:
    """Exception for a file that Python could not write."""
    return _output_error(f"{name}: cannot be written: {error.strerror}", "", error.errno)


def unread(name: str, error: OSError) -> OutputError:
    """Exception for a file that Python could not read."""
    return _output_error(f"{name}: cannot be read: {error.strerror}", "", error.errno)


def write_text(name: str, text: str) -> str:
    """Writes a file and returns its name."""
    return write_bytes(name, text.encode())


def write_bytes(name: str, content: bytes) -> str:
    """Writes a whole file or nothing, and returns its name. A link of that name is replaced, not followed. A device
    or a pipe is written to directly."""
    part = f"{name}.tmp"
    try:
        # /dev/stdout is a system link and must be followed.
        followed = os.path.abspath(name).startswith(("/dev/", "/proc/")) or not os.path.islink(name)
        if followed and os.path.exists(name) and (not os.path.isfile(name) or os.path.islink(name)):
            with open(name, "wb") as file:
                file.write(content)
            return name
        with contextlib.suppress(FileNotFoundError):
            os.remove(part)
        try:
            with open(part, "xb") as file:
                file.write(content)
            os.replace(part, name)
        except OSError:
            with contextlib.suppress(OSError):
                os.remove(part)
            raise
    except OSError as error:
        raise unwritten(name, error) from error
    return name


def say(stream: Any, text: str) -> None:
    """Writes progress. A missing, closed or full stream must not stop the run."""
    if stream is not None:
        with contextlib.suppress(OSError, ValueError):
            stream.write(text)
            stream.flush()


def _no_frame(message: str, fix: str) -> IndexError:
    return IndexError(f"{message}; {fix}" if fix else message)


def expected(argument: str, what: str, got: object) -> TypeError:
    """Exception for an argument of the wrong type."""
    return TypeError(f"{argument}: expected {what}, got {_kind(got)}")


def _kind(got: object) -> str:
    shape = getattr(got, "shape", None)
    if isinstance(shape, tuple):
        return f"an array of shape {shape}"
    if isinstance(got, (str, int, float, bool)) or got is None:
        return repr(got)
    return f"{type(got).__name__}"


def as_path(argument: str, value: object) -> str:
    """A path as text."""
    if isinstance(value, (str, os.PathLike)):
        path = os.fspath(value)
        if isinstance(path, str) and path:
            return path
    raise expected(argument, "a path (str or os.PathLike)", value)


def need(package: str, extra: str) -> None:
    """Raises an error with the install command if an optional package is missing."""
    try:
        importlib.import_module(package)
    except ImportError as error:
        raise ImportError(f"this needs {package}: pip install 'wythe[{extra}]'") from error
