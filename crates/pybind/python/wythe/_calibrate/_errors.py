"""The error of a calibration."""

from __future__ import annotations

from typing import Any

from wythe._errors import WytheError


class CalibrationError(WytheError, ValueError):
    """A calibration cannot start or continue.

    Attributes
    ----------
    message : str
        Description of the error.
    key : str
        Dotted path of the key in the job, tests counted from 0 (``tests.0.deck``); empty for the job as a whole.
    fix : str
        Advice on a correction.
    file : str or None
        The job file, if there is one.
    """

    def __init__(
        self, message: str, *, key: str = "", fix: str = "", file: str | None = None
    ) -> None:
        super().__init__(message)
        self.message = message
        self.key = key
        self.fix = fix
        self.file = file

    def __str__(self) -> str:
        text = ": ".join(part for part in (self.file or "", self.key, self.message) if part)
        return f"{text}\n  fix: {self.fix}" if self.fix else text

    def __reduce__(self) -> tuple[Any, ...]:
        return (_rebuilt, (self.message, self.key, self.fix, self.file))


def _rebuilt(message: str, key: str, fix: str, file: str | None) -> CalibrationError:
    return CalibrationError(message, key=key, fix=fix, file=file)
