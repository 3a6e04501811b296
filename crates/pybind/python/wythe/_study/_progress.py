"""Progress of a study: one updated line on a terminal or in a notebook, a few lines elsewhere."""

from __future__ import annotations

import importlib
import math
import sys
import time
from collections.abc import Callable
from typing import Any

from wythe._errors import say
from wythe._run import in_notebook

# Shortest time between updates of the line of a terminal [s].
RENEWED_EVERY = 0.1
# Elsewhere a line follows after the first time, or after a tenth of all samples but not before the second time [s].
TOLD_EVERY = 60.0
NOT_SOONER = 5.0


class Progress:
    """Counts finished samples and reports the rate since the start of this call."""

    def __init__(self, count: int, before: int, sink: InPlace | Lines | None) -> None:
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


class InPlace:
    """One line, updated in place by ``write(line, last)`` and not more often than ``every`` [s]."""

    def __init__(self, write: Callable[[str, bool], object], every: float) -> None:
        self._write = write
        self._every = every
        self._shown = -math.inf

    def show(self, line: str, done: int, last: bool) -> None:
        """Overwrites the previous line."""
        now = time.monotonic()
        if last or now - self._shown >= self._every:
            self._shown = now
            self._write(line, last)


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


def terminal(stream: Any) -> InPlace:
    """The line of a terminal."""
    return InPlace(lambda line, last: say(stream, f"\r\x1b[K{line}" + ("\n" if last else "")), RENEWED_EVERY)


def notebook() -> InPlace:
    """A line below the cell."""
    display: Any = importlib.import_module("IPython.display")
    handle = display.display({"text/plain": "study"}, raw=True, display_id=True)
    return InPlace(lambda line, _: handle.update({"text/plain": line}, raw=True), 5.0 * RENEWED_EVERY)


def sink(count: int) -> InPlace | Lines:
    """The output that suits this process."""
    if in_notebook():
        return notebook()
    stream = sys.stderr
    return terminal(stream) if stream is not None and stream.isatty() else Lines(stream, count)


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
