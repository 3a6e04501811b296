"""Errors of a study as a whole; the failure of one sample is a row of its table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wythe._errors import WytheError

if TYPE_CHECKING:
    from wythe._study._table import Study


class StudyError(WytheError):
    """A study cannot start or continue. Finished samples are kept in its folder and in ``study``."""

    def __init__(self, message: str, study: Study | None = None) -> None:
        super().__init__(message)
        self.study = study
        """The samples finished so far, if there are any."""


class StudyInterrupted(KeyboardInterrupt):
    """Ctrl-C. Finished samples are kept in the folder of the study and in ``study``."""

    def __init__(self, message: str, study: Study) -> None:
        super().__init__(message)
        self.study = study
        """The samples finished so far."""
