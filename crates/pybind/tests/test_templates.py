"""Templates: the decks of `wythe new`, and their parameters."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import wythe
from helpers import python
from wythe import templates

#: The function of each template.
MAKERS: dict[str, Callable[..., wythe.Model]] = {
    "couplet": templates.couplet,
    "shear-wall": templates.shear_wall,
    "out-of-plane": templates.out_of_plane,
    "arch": templates.arch,
    "dry-wall": templates.dry_wall,
    "column": templates.column,
}

#: Every parameter with a value other than the template's, and the keys that it decides.
PARAMETERS: dict[str, dict[str, tuple[object, dict[str, object]]]] = {
    "couplet": {
        "displacement": ("30 um", {"steps.1.displacement": 0.03}),
        "f_t": ("100 kPa", {"interfaces.joint.f_t": 0.1}),
        "mesh": ("fine", {"wall.mesh": [9, 4, 3]}),
    },
    "shear-wall": {
        "preload": ("2.12 MPa", {"steps.0.top_pressure": 2.12}),
        "drive": (4, {"steps.1.displacement": 4.0}),
        "length": ("420.5 mm", {"wall.length": 420.5}),
        "courses": (6, {"wall.courses": 6}),
        "mesh": ((4, 2, 1), {"wall.mesh": [4, 2, 1]}),
        "vertical": ("free", {"steps.1.vertical": "free"}),
    },
    "out-of-plane": {
        "preload": (0.5, {"steps.0.top_pressure": 0.5}),
        "drive": ("5 mm", {"steps.1.displacement": 5.0}),
        "length": ("420.5 mm", {"wall.length": 420.5}),
        "courses": (6, {"wall.courses": 6}),
        "mesh": ([5, 2, 4], {"wall.mesh": [5, 2, 4]}),
    },
    "arch": {
        "tilt": (3, {"steps.1.angle": 3.0}),
        "radius": ("3 m", {"arch.radius": 3000.0}),
        "thickness": (400, {"arch.thickness": 400.0}),
        "voussoirs": (9, {"arch.voussoirs": 9}),
        "embrace": (150, {"arch.angle": 150.0}),
        "friction": (0.6, {"interfaces.dry.mu": 0.6, "interfaces.dry.tan_phi": 0.6}),
    },
    "dry-wall": {
        "tilt": (3, {"steps.1.angle": 3.0}),
        "friction": (0.6, {"interfaces.dry.mu": 0.6, "interfaces.dry.tan_phi": 0.6}),
    },
    "column": {
        "duration": ("50 ms", {"steps.1.duration": 0.05}),
        "friction": (0.5, {"interfaces.dry.mu": 0.5, "interfaces.dry.tan_phi": 0.5}),
        "velocity": (["1 m/s", 0, 0], {"blocks.2.velocity": [1000.0, 0.0, 0.0]}),
    },
}


def at(model: wythe.Model, key: str) -> Any:
    """A value of the deck by its dotted path."""
    found: Any = model.to_dict()
    for part in key.split("."):
        found = found[int(part)] if isinstance(found, list) else found[part]
    return found


def test_every_template_has_a_function_and_a_line() -> None:
    assert set(MAKERS) == set(templates.names())
    assert all(about and "\n" not in about for about in templates.names().values())


@pytest.mark.parametrize("name", MAKERS)
def test_a_template_is_the_deck_of_the_command(name: str, tmp_path: Path) -> None:
    done = python("-m", "wythe", "new", "made", "--template", name, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    made = tmp_path / "made.toml"
    assert made.read_text() == templates.text(name)
    model = MAKERS[name]()
    assert wythe.Model.from_toml(made, {"title": model.title}) == model
    assert model.check()


@pytest.mark.parametrize("name", MAKERS)
def test_every_parameter_changes_its_keys_only(name: str) -> None:
    maker, known = MAKERS[name], PARAMETERS[name]
    assert set(inspect.signature(maker).parameters) == set(known)
    for parameter, (value, keys) in known.items():
        changed = maker(**{parameter: value})
        for key, said in keys.items():
            assert at(maker(), key) != said
            assert at(changed, key) == pytest.approx(said)
        assert changed.with_({key: at(maker(), key) for key in keys}) == maker()


def test_names_that_are_none() -> None:
    with pytest.raises(ValueError, match="expected one of couplet, shear-wall, .* got 'house'"):
        templates.text("house")
