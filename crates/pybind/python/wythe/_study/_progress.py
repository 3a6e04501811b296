"""How far a study has come: a line that renews itself on a terminal or in a notebook, few lines elsewhere."""

from __future__ import annotations

import importlib
import math
import sys
import time
from typing import Any, Protocol

from wythe._errors import say
from wythe._run import in_notebook

# A terminal's line is renewed so often at most [s].
RENEWED_EVERY = 0.1
# Elsewhere a line comes after so long, or after a tenth of all, but then not sooner than this [s].
TOLD_EVERY = 60.0
NOT_SOONER = 5.0


class Sink(Protocol):
    """Where the line goes."""

    def show(self, line: str, done: int, last: bool) -> None:
        """Shows the line, if it is time to."""
        ...


class Progress:
    """Counts what is done, and tells the pace since this call began."""

    def __init__(self, count: int, before: int, sink: Sink | None) -> None:
        self._count = count
        self._before = before
        self._sink = sink
        self._begun = time.monotonic()
        self.done = before
        self.failed = 0
        """Failed or lost."""
        self.unconverged = 0
        self.workers = 0

    def show(self, last: bool = False) -> None:
        """Shows how far it is."""
        if self._sink is not None:
            self._sink.show(self.line(time.monotonic() - self._begun), self.done, last)

    def line(self, seconds: float) -> str:
        """The line so many seconds after this call began."""
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
    """One line, renewed in place."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self._shown = -RENEWED_EVERY

    def show(self, line: str, done: int, last: bool) -> None:
        """Writes over the line before."""
        now = time.monotonic()
        if last or now - self._shown >= RENEWED_EVERY:
            self._shown = now
            say(self._stream, f"\r\x1b[K{line}" + ("\n" if last else ""))


class Lines:
    """Plain lines, for logs: at each tenth or each minute, and the end."""

    def __init__(self, stream: Any, count: int) -> None:
        self._stream = stream
        self._step = max(1, count // 10)
        self._told = -1
        self._at = -math.inf

    def show(self, line: str, done: int, last: bool) -> None:
        """Writes a line now and then."""
        since = time.monotonic() - self._at
        more = done // self._step > self._told // self._step
        if since >= TOLD_EVERY or (more and since >= NOT_SOONER) or (last and done != self._told):
            self._told, self._at = done, time.monotonic()
            say(self._stream, f"{line}\n")


class Notebook:
    """A line below the cell, renewed in place."""

    def __init__(self) -> None:
        display: Any = importlib.import_module("IPython.display")
        self._handle = display.display({"text/plain": "study"}, raw=True, display_id=True)
        self._shown = -1.0

    def show(self, line: str, done: int, last: bool) -> None:
        """Renews the line."""
        now = time.monotonic()
        if last or now - self._shown >= 5.0 * RENEWED_EVERY:
            self._shown = now
            self._handle.update({"text/plain": line}, raw=True)


def sink(count: int) -> Sink:
    """Where the progress goes here."""
    if in_notebook():
        return Notebook()
    stream = sys.stderr
    if stream is not None and stream.isatty():
        return Terminal(stream)
    return Lines(stream, count)


def duration(seconds: float) -> str:
    """A time as people say it."""
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
