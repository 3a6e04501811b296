"""The tables of materials and interfaces with found values, as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from wythe import _wythe
from wythe._calibrate._job import Job
from wythe._errors import ModelError

TABLES = ("materials", "interfaces")


def materials_toml(
    job: Job, values: Mapping[str, float], intervals: Mapping[str, tuple[float, float]]
) -> str:
    """The tables that parameters set, whole and with all found values, also those of keys of other tests.

    A table that differs otherwise between tests is that of the first one. Comments tell the intervals, and what is
    not in the tables.
    """
    lines = [f"# {job.title}: values found by wythe.calibrate, with intervals of 95 %. Units: N, mm, MPa."]
    for p in job.parameters:
        low, high = intervals[p.name]
        unit = f" {p.unit}" if p.unit else ""
        keys = ", ".join(f"{k.key}" if k.factor == 1.0 else f"{k.key} ({k.factor:g} times it)" for k in p.keys)
        lines.append(f"# {p.name} = {values[p.name]:.5g}{unit} ({low:.4g} to {high:.4g}): {keys}")
    changes = all_changes(job, values)
    lines += _differences(job, values, changes)
    tables: dict[str, dict[str, Any]] = {}
    for table, name in dict.fromkeys(place for place in map(_place, changes) if place is not None):
        found, notes = _table(job, table, name, changes)
        tables.setdefault(table, {})[name] = found
        lines += notes
    text = _wythe.Deck.toml_of_json(json.dumps(tables))
    return "\n".join(lines) + "\n\n" + text


def all_changes(job: Job, values: Mapping[str, float]) -> dict[str, float | str]:
    """Deck keys of all tests with values; of a key that several set, the first."""
    changes: dict[str, float | str] = {}
    for p in job.parameters:
        for key in p.keys:
            changes.setdefault(key.key, p.deck_value(values[p.name], key.factor))
    return changes


def _place(key: str) -> tuple[str, str] | None:
    """Table and name of a key of a material or an interface."""
    table, _, rest = key.partition(".")
    return (table, rest.partition(".")[0]) if table in TABLES else None


def _differences(job: Job, values: Mapping[str, float], changes: Mapping[str, float | str]) -> list[str]:
    """Values of decks that the tables cannot have."""
    lines: list[str] = []
    for test in job.tests:
        for key, value in job.changes(test, values).items():
            if _place(key) is None:
                lines.append(f"# {key} = {value} in the deck of test {test.name} is no part of a material")
            elif changes[key] != value:
                lines.append(f"# {key} is {value} in test {test.name}")
    return lines


def _table(
    job: Job, table: str, name: str, changes: Mapping[str, float | str]
) -> tuple[dict[str, Any], list[str]]:
    """A table with all its found values, and notes of tests that have another one."""
    own = {key: value for key, value in changes.items() if _place(key) == (table, name)}
    found: dict[str, Any] = {}
    notes: list[str] = []
    for test in job.tests:
        try:
            of_test = test.model.with_(own).to_dict()[table][name]
        except (KeyError, ModelError):
            # This deck has no such table.
            continue
        if not found:
            found = of_test
        elif of_test != found:
            notes.append(f"# {table}.{name} has other fixed values in test {test.name}")
    return found, notes
