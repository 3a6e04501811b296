"""Tables of a job, read key by key with errors that name the place."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from wythe._calibrate._errors import CalibrationError
from wythe._study._quantity import quantity
from wythe._study._samples import plain


class Table:
    """A table of a job; keys that nobody has read are unknown."""

    def __init__(self, content: object, where: str, file: str | None) -> None:
        self.where = where
        self.file = file
        if not isinstance(content, Mapping):
            self.fail("", f"expected a table of keys, got {told(content)}", "see docs/reference/calibration.md")
        self._content: dict[str, Any] = dict(content)
        self._known: list[str] = []

    def fail(self, key: str, message: str, fix: str) -> NoReturn:
        """Raises the error of a key."""
        path = ".".join(part for part in (self.where, key) if part)
        raise CalibrationError(message, key=path, fix=fix, file=self.file)

    def has(self, key: str) -> bool:
        """Whether the key is there; None counts as absent."""
        self._known.append(key)
        return self._content.get(key) is not None

    def get(self, key: str) -> Any:
        """The value of a key, None without one."""
        self._known.append(key)
        return self._content.get(key)

    def need(self, key: str, fix: str) -> Any:
        """The value of a key that must be there."""
        if not self.has(key):
            self.fail(key, "it is missing", fix)
        return self._content[key]

    def keys(self) -> list[str]:
        """All keys."""
        return list(self._content)

    def text(self, key: str, default: str) -> str:
        """A text."""
        if not self.has(key):
            return default
        value = self._content[key]
        if not isinstance(value, str) or not value:
            self.fail(key, f"expected a text, got {told(value)}", f'write {key} = "…"')
        return value

    def choice(self, key: str, default: str, choices: Sequence[str]) -> str:
        """One of several words."""
        value = self.text(key, default)
        if value not in choices:
            self.fail(key, f"`{value}` is not known", f"write one of {', '.join(choices)}")
        return value

    def number(self, key: str, default: float | None, least: float | None = None) -> float:
        """A number; above ``least`` if given. Without a default it must be there."""
        value = plain(self.need(key, f"write {key} = a number") if default is None else self.get(key))
        if value is None:
            assert default is not None
            return default
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            self.fail(key, f"expected a number, got {told(value)}", f"write {key} = a number")
        if least is not None and not value > least:
            self.fail(key, f"{value:g} is not admissible", f"give a number above {least:g}")
        return float(value)

    def whole(self, key: str, default: int, least: int) -> int:
        """A whole number of at least ``least``."""
        value = plain(self.get(key)) if self.has(key) else default
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            self.fail(key, f"expected a whole number from {least}, got {told(value)}", "give such a number")
        return value

    def quantity(self, key: str, value: object) -> tuple[float, str]:
        """A number and its unit: ``0.2`` or ``"0.2 MPa"``."""
        found = None if isinstance(value, bool) else quantity(plain(value))
        if found is None:
            fix = 'write a number, or a text with a unit: "0.2 MPa"'
            self.fail(key, f"expected a quantity, got {told(value)}", fix)
        return found

    def items(self, key: str, value: object) -> list[Any]:
        """A list of at least one item."""
        if isinstance(value, (str, Mapping)) or not isinstance(value, Sequence) or not value:
            self.fail(key, f"expected a list, got {told(value)}", f"write {key} = […]")
        return list(value)

    def end(self) -> None:
        """Raises an error for a key that is not known."""
        for key in self._content:
            if key not in self._known:
                near = difflib.get_close_matches(key, self._known, 1)
                fix = f"did you mean `{near[0]}`?" if near else f"known are {', '.join(dict.fromkeys(self._known))}"
                self.fail(key, f"`{key}` is not a known key", fix)


def told(value: object) -> str:
    """A value in a message."""
    if isinstance(value, (str, int, float, bool)):
        return repr(value)
    return "none" if value is None else type(value).__name__
