"""The tables of materials and interfaces with found values, as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from wythe import _wythe
from wythe._calibrate._job import Job

TABLES = ("materials", "interfaces")


def materials_toml(
    job: Job, values: Mapping[str, float], intervals: Mapping[str, tuple[float, float]]
) -> str:
    """The tables that parameters set, whole, with a comment for each parameter.

    A table that differs between tests is written once, as in the first test that has it.
    """
    tables: dict[str, dict[str, Any]] = {name: {} for name in TABLES}
    lines = [f"# {job.title}: values found by wythe.calibrate, with intervals of 95 %. Units: N, mm, MPa."]
    for p in job.parameters:
        low, high = intervals[p.name]
        unit = f" {p.unit}" if p.unit else ""
        keys = ", ".join(f"{k.key}" if k.factor == 1.0 else f"{k.key} ({k.factor:g} times it)" for k in p.keys)
        lines.append(f"# {p.name} = {values[p.name]:.5g}{unit} ({low:.4g} to {high:.4g}): {keys}")
    for test in job.tests:
        changes = job.changes(test, values)
        deck = test.model.with_(changes).to_dict()
        for key in changes:
            table, _, rest = key.partition(".")
            name = rest.partition(".")[0]
            if table not in TABLES:
                said = f"# {key} = {changes[key]} in the deck of test {test.name} is no part of a material"
                lines += [] if said in lines else [said]
            elif name not in tables[table]:
                tables[table][name] = deck[table][name]
            elif tables[table][name] != deck[table][name]:
                said = f"# {table}.{name} of test {test.name} differs from this one"
                lines += [] if said in lines else [said]
    text = _wythe.Deck.toml_of_json(json.dumps({name: of for name, of in tables.items() if of}))
    return "\n".join(lines) + "\n\n" + text
