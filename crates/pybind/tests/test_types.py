"""The package, its tests and the examples satisfy mypy and pyright, and every public type is known."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from helpers import EXAMPLES, SOURCES, TARGET, python

TESTS = Path(__file__).parent
#: Its pyproject.toml says how both check.
PROJECT = SOURCES.parents[1]
CHECKED = [
    str(SOURCES),
    *map(str, sorted(EXAMPLES.glob("*.py"))),
    *map(str, sorted(TESTS.glob("*.py"))),
]


def test_mypy_strict() -> None:
    arguments = ("--strict", "--cache-dir", str(TARGET / "mypy"))
    done = python("-m", "mypy", *arguments, *CHECKED, folder=PROJECT)
    assert done.returncode == 0, done.stdout + done.stderr


def test_pyright() -> None:
    done = python("-m", "pyright", "--pythonpath", sys.executable, *CHECKED, folder=PROJECT)
    if "summary" not in done.stdout and "informations" not in done.stdout:
        pytest.skip(f"pyright cannot fetch what it runs on: {done.stderr}")
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_public_type_is_known() -> None:
    arguments = ("--verifytypes", "wythe", "--ignoreexternal", "--outputjson")
    done = python("-m", "pyright", "--pythonpath", sys.executable, *arguments)
    if not done.stdout.startswith("{"):
        pytest.skip(f"pyright cannot fetch what it runs on: {done.stderr}")
    found = json.loads(done.stdout)["typeCompleteness"]
    unclear = [
        f"{symbol['name']}: {symbol['diagnostics'][0]['message']}"
        for symbol in found["symbols"]
        if not symbol["isTypeKnown"]
    ]
    assert not unclear
    assert found["completenessScore"] == 1.0
