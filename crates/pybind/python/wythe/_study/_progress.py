"""Progress of a study: one updated line on a terminal or in a notebook, a few lines elsewhere."""

from __future__ import annotations

import importlib
import math
import sys
import time
from typing import Any, Protocol

from wythe._errors import say
from wythe._run import in_notebook

# Shortest time between updates of the line of a terminal [s].
RENEWED_EVERY = 0.1
# Elsewhere a line follows after the first time, or after a tenth of all samples but not before the second time [s].
TOLD_EVERY = 60.0
NOT_SOONER = 5.0


class Sink(Protocol):
    """Output of the progress."""

    def show(self, line: str, done: int, last: bool) -> None:
        """Shows the line, if enough time has passed."""
        ...


class Progress:
    """Counts finished samples and reports the rate since the start of this call."""

    def __init__(self, count: int, before: int, sink: Sink | None) -> None:
        self._count = count
        self._before = before
        self._sink = sink
        self._begun = time.monotonic()
        self.done = before
        self.failed = 0
        """Number of failed or lost samples."""
        self.unconverged = 0
        self.workers = 0

    def show(self, last: bool = False) -> None:
        """Shows the progress."""
        if self._sink is not None:
            self._sink.show(self.line(time.monotonic() - self._begun), self.done, last)

    def line(self, seconds: float) -> str:
        """Text of the line at this time after the start of the call [s]."""
        left = self._count - self.done
        parts = [f"study: {self.done} of {self._count} done"]
        if self.unconverged:
            parts.append(f"{self.unconverged} not converged")
        if self.failed:
            parts.append(f"{self.failed} failed")
        parts.append(f"{left} left")
        here = self.done - self._before
        if left and self.workers == 0:
            parts.append("waiting for workers")
        elif here and seconds > 0.0:
            pace = here / seconds
            parts.append(_pace(pace))
            parts.append(f"{duration(left / pace)} to go" if left else f"took {duration(seconds)}")
        return ", ".join(parts)


class Terminal:
    """One line, updated in place."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self._shown = -RENEWED_EVERY

    def show(self, line: str, done: int, last: bool) -> None:
        """Overwrites the previous line."""
        now = time.monotonic()
        if last or now - self._shown >= RENEWED_EVERY:
            self._shown = now
            say(self._stream, f"\r\x1b[K{line}" + ("\n" if last else ""))


class Lines:
    """Plain lines for logs: at each tenth of the samples or each minute, and at the end."""

    def __init__(self, stream: Any, count: int) -> None:
        self._stream = stream
        self._step = max(1, count // 10)
        self._told = -1
        self._at = -math.inf

    def show(self, line: str, done: int, last: bool) -> None:
        """Writes a line at intervals."""
        since = time.monotonic() - self._at
        more = done // self._step > self._told // self._step
        if since >= TOLD_EVERY or (more and since >= NOT_SOONER) or (last and done != self._told):
            self._told, self._at = done, time.monotonic()
            say(self._stream, f"{line}\n")


class Notebook:
    """A line below the cell, updated in place."""

    def __init__(self) -> None:
        display: Any = importlib.import_module("IPython.display")
        self._handle = display.display({"text/plain": "study"}, raw=True, display_id=True)
        self._shown = -1.0

    def show(self, line: str, done: int, last: bool) -> None:
        """Updates the line."""
        now = time.monotonic()
        if last or now - self._shown >= 5.0 * RENEWED_EVERY:
            self._shown = now
            self._handle.update({"text/plain": line}, raw=True)


def sink(count: int) -> Sink:
    """The output that suits this process."""
    if in_notebook():
        return Notebook()
    stream = sys.stderr
    if stream is not None and stream.isatty():
        return Terminal(stream)
    return Lines(stream, count)


def duration(seconds: float) -> str:
    """A time as text with a suitable unit."""
    if seconds < 60.0:
        return f"{max(0.0, seconds):.0f} s"
    if seconds < 3600.0:
        return f"{seconds / 60.0:.0f} min"
    if seconds < 172_800.0:
        return f"{seconds / 3600.0:.1f} h"
    return f"{seconds / 86400.0:.1f} d"


def _pace(per_second: float) -> str:
    if per_second >= 1.0:
        return f"{per_second:.1f}/s"
    if per_second * 60.0 >= 1.0:
        return f"{per_second * 60.0:.1f}/min"
    return f"{per_second * 3600.0:.1f}/h"
