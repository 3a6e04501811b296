"""The stubs say what the module has, and the module has what the stubs say."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import pytest
from helpers import SOURCES, python
from wythe import _wythe

STUB = SOURCES / "_wythe.pyi"

#: What pyo3 gives every class and module.
GIVEN = {"__all__", "__doc__", "__loader__", "__name__", "__package__", "__spec__", "__file__"}


def of_stub(body: list[ast.stmt]) -> dict[str, list[str] | None]:
    """Public names in a stub, and the parameters of those that are functions."""
    found: dict[str, list[str] | None] = {}
    for statement in body:
        if isinstance(statement, ast.FunctionDef):
            decorators = {
                node.id for node in statement.decorator_list if isinstance(node, ast.Name)
            }
            arguments = statement.args
            names = [
                a.arg for a in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)
            ]
            found[statement.name] = None if "property" in decorators else names
        elif isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name):
            found[statement.target.id] = None
        elif isinstance(statement, ast.ClassDef):
            found[statement.name] = None
    return {
        name: names
        for name, names in found.items()
        if not name.startswith("_") or name == "__version__"
    }


def of_module(thing: object) -> dict[str, list[str] | None]:
    """The same of what is there."""
    found: dict[str, list[str] | None] = {}
    for name, value in vars(thing).items():
        if (name.startswith("_") and name != "__version__") or name in GIVEN:
            continue
        value = getattr(thing, name)
        try:
            found[name] = list(inspect.signature(value).parameters)
        except (TypeError, ValueError):
            found[name] = None
        if inspect.isclass(value):
            found[name] = None
    return found


TREE = ast.parse(STUB.read_text())
CLASSES = {node.name: node for node in TREE.body if isinstance(node, ast.ClassDef)}


def test_functions_and_their_parameters() -> None:
    assert of_stub(TREE.body) == of_module(_wythe)


@pytest.mark.parametrize("name", CLASSES)
def test_methods_and_their_parameters(name: str) -> None:
    assert of_stub(CLASSES[name].body) == of_module(getattr(_wythe, name))


def test_mypy_finds_no_difference(tmp_path: Path) -> None:
    pytest.importorskip("mypy", reason="mypy is not installed")
    # pyo3 lists the names of a module in it, which no stub wants.
    allowed = tmp_path / "allowed.txt"
    allowed.write_text("wythe\\._wythe\\.__all__\n")
    config = SOURCES.parents[1] / "pyproject.toml"
    arguments = ("--allowlist", str(allowed), "--mypy-config-file", str(config))
    # In a folder of its own: modules in the current one would hide those of the library.
    done = python("-m", "mypy.stubtest", "wythe._wythe", *arguments, folder=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
