"""Every public name is documented, and used by some test."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path

import pytest
import wythe

TESTS = Path(__file__).parent
TEXT = "\n".join(path.read_text() for path in TESTS.glob("test_*.py") if path != Path(__file__))


def public(module: object, name: str = "wythe") -> Iterator[tuple[str, object]]:
    """Names of the package, of its modules and of the classes in them."""
    for short in module.__all__:  # type: ignore[attr-defined]
        thing = getattr(module, short)
        yield f"{name}.{short}", thing
        if inspect.ismodule(thing):
            yield from public(thing, f"{name}.{short}")
        elif inspect.isclass(thing):
            yield from of_class(thing, f"{name}.{short}")


def of_class(thing: type, name: str) -> Iterator[tuple[str, object]]:
    own = [base for base in thing.__mro__ if base.__module__.startswith("wythe")]
    seen = {short for base in own for short in (*vars(base), *getattr(base, "__annotations__", {}))}
    if is_dataclass(thing):
        seen |= {field.name for field in fields(thing)}
    for short in sorted(seen):
        if not short.startswith("_"):
            yield f"{name}.{short}", inspect.getattr_static(thing, short, None)


NAMES = dict(public(wythe))


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_tested(name: str) -> None:
    *_, short = name.split(".")
    assert re.search(rf"\b{re.escape(short)}\b", TEXT), f"no test speaks of {name}"


@pytest.mark.parametrize("name", NAMES)
def test_a_name_is_documented(name: str) -> None:
    thing = NAMES[name]
    described = inspect.isroutine(thing) or inspect.isclass(thing) or inspect.ismodule(thing)
    if described or isinstance(thing, property):
        assert inspect.getdoc(thing), f"{name} has no documentation"


def test_names_are_sorted() -> None:
    for module in (wythe, wythe.build, wythe.templates, wythe.tests):
        assert list(module.__all__) == sorted(module.__all__)
        assert len(set(module.__all__)) == len(module.__all__)


def test_what_is_not_public_is_not_offered() -> None:
    """A name without an underscore that is not in ``__all__`` was forgotten, or is one of Python's own."""
    for module in (wythe.build, wythe.templates):
        made = {
            name
            for name, thing in vars(module).items()
            if inspect.isfunction(thing) and thing.__module__ == module.__name__
        }
        assert {name for name in made if not name.startswith("_")} == set(module.__all__)
