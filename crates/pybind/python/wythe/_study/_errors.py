"""What can go wrong with a study as a whole; trouble with one sample is a row of its table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wythe._errors import WytheError

if TYPE_CHECKING:
    from wythe._study._table import Study


class StudyError(WytheError):
    """A study cannot begin or go on. What is done is kept: in its folder, and in ``study``."""

    def __init__(self, message: str, study: Study | None = None) -> None:
        super().__init__(message)
        self.study = study
        """The samples finished so far, where some are."""


class StudyInterrupted(KeyboardInterrupt):
    """Ctrl-C. What is done is kept: in the study's folder, and in ``study``."""

    def __init__(self, message: str, study: Study) -> None:
        super().__init__(message)
        self.study = study
        """The samples finished so far."""
