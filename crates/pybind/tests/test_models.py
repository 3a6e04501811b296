"""Models from decks: files, texts, dictionaries, and other values."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import wythe
from helpers import EXAMPLES

TEXT = wythe.templates.text("couplet")


def test_a_file_a_path_and_its_text_are_one_model(tmp_path: Path) -> None:
    path = tmp_path / "couplet.toml"
    path.write_text(TEXT)
    # The title is the file's name where the deck has none.
    assert wythe.Model.from_toml(path).title == "couplet"
    assert wythe.Model.from_toml(TEXT).title == "model"
    named = {"title": "named"}
    of_text = wythe.Model.from_toml(TEXT, named)
    assert wythe.Model.from_toml(path, named) == of_text
    assert wythe.Model.from_toml(str(path), named) == of_text
    assert wythe.Model.from_toml(path).folder == str(tmp_path)


def test_a_path_may_hold_an_equals_sign(tmp_path: Path) -> None:
    path = tmp_path / "f_t=0.28.toml"
    path.write_text(TEXT)
    assert wythe.Model.from_toml(str(path)).title == "f_t=0.28"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_examples_go_through_every_form(path: Path) -> None:
    model = wythe.Model.from_toml(path)
    again = wythe.Model.from_dict(model.to_dict(), folder=model.folder)
    assert again == model
    assert again.to_toml() == model.to_toml()
    # A text has no folder, which counts where files decide what the model is.
    text = wythe.Model.from_toml(model.to_toml())
    assert wythe.Model.from_dict(text.to_dict(), folder=model.folder) == again
    assert wythe.Model(model.to_dict()) == wythe.Model.from_dict(model.to_dict())


def test_overrides_are_those_of_the_command() -> None:
    changed = wythe.Model.from_toml(
        TEXT,
        {
            "wall.courses": 3,
            "interfaces.joint.f_t": "200 kPa",
            "steps.1.increments": {"max": 0.05},
            "wall.mesh": [4, 2, 1],
            "output.mcap": False,
            "title": 'quotes " and \\ and µ',
        },
    ).to_dict()
    assert changed["wall"]["courses"] == 3
    assert changed["interfaces"]["joint"]["f_t"] == pytest.approx(0.2)
    assert changed["steps"][1]["increments"] == {"max": 0.05}
    assert changed["wall"]["mesh"] == [4, 2, 1]
    assert changed["output"]["mcap"] is False
    assert changed["title"] == 'quotes " and \\ and µ'


def test_dictionaries_take_numpy_and_leave_none_away() -> None:
    plain = wythe.Model.from_toml(EXAMPLES / "03_shear_wall_j7d.toml").to_dict()
    numpy = copy.deepcopy(plain)
    for material in numpy["materials"].values():
        for name in ("tension", "compression"):
            material[name] = np.array(material[name])
        material["E"] = np.float64(material["E"])
    wall = numpy["wall"]
    wall["unit"] = tuple(np.float32(side) for side in wall["unit"])
    wall["courses"] = np.int32(wall["courses"])
    wall["mesh"] = np.array(wall["mesh"], dtype=np.uint8)
    numpy["output"]["mcap"] = np.bool_(numpy["output"]["mcap"])
    numpy["output"]["experiment"] = None
    numpy["probes"] = None
    del numpy["format"]
    assert wythe.Model.from_dict(numpy) == wythe.Model.from_dict(plain)


def test_paths_in_dictionaries_and_their_folder(tmp_path: Path) -> None:
    (tmp_path / "test.csv").write_text("displacement_mm,force_kN\n0,0\n1,1\n")
    deck = wythe.templates.couplet().to_dict()
    deck["output"]["experiment"] = Path("test.csv")
    assert wythe.Model.from_dict(deck, folder=tmp_path).check()
    assert not wythe.Model.from_dict(deck).check()


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: wythe.Model.from_toml(3), "source: expected a path (str or os.PathLike), got 3"),  # type: ignore[arg-type]
        (lambda: wythe.Model.from_toml(TEXT, 3), "overrides: expected a mapping"),  # type: ignore[arg-type]
        (lambda: wythe.Model.from_toml(TEXT, {3: 3}), "overrides: expected keys that are dotted"),  # type: ignore[dict-item]
        (lambda: wythe.Model.from_dict(3), "deck: expected a mapping"),  # type: ignore[arg-type]
        (lambda: wythe.Model.from_dict({3: 3}), "deck: expected keys that are str, got 3"),  # type: ignore[dict-item]
        (lambda: wythe.Model.from_dict({"wall": {"unit": {1}}}, folder=3), "folder: expected"),  # type: ignore[arg-type]
        (lambda: wythe.Model.from_dict({"wall": object()}), "wall: expected a number, a text"),
        (lambda: wythe.Model.from_dict({"steps": [{"a": object()}]}), "steps.0.a: expected"),
        (lambda: wythe.templates.couplet(np.zeros(2)), "steps.1.displacement"),  # type: ignore[arg-type]
        (lambda: wythe.templates.couplet().with_(wall__courses=1j), "wall.courses: expected"),  # type: ignore[arg-type]
    ],
)
def test_wrong_types_name_the_argument(make: Callable[[], object], told: str) -> None:
    with pytest.raises((TypeError, wythe.ModelError)) as raised:
        make()
    assert str(raised.value).startswith(told)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), np.float64("nan")])
def test_numbers_are_finite(bad: float) -> None:
    with pytest.raises(wythe.ModelError, match="no finite number") as raised:
        wythe.templates.couplet(f_t=bad)
    assert raised.value.key == "interfaces.joint.f_t"


def test_with_changes_a_copy() -> None:
    model = wythe.templates.couplet()
    before = model.to_toml()
    changed = model.with_({"wall.courses": 3}, steps__1__displacement="1 mm", title="other")
    assert changed.to_dict()["wall"]["courses"] == 3
    assert changed.to_dict()["steps"][1]["displacement"] == 1.0
    assert (changed.title, model.title) == ("other", "couplet")
    assert model.to_toml() == before
    assert model.with_() is model


def test_with_none_takes_a_key_away() -> None:
    model = wythe.templates.couplet().with_({"output.every": 2, "steps.1.name": None})
    assert model.to_dict()["output"]["every"] == 2
    assert (
        "name" not in model.to_dict()["steps"][1]
        or model.to_dict()["steps"][1]["name"] != "softening"
    )
    again = model.with_({"output.every": None, "output.nothing.such": None, "steps.7": None})
    assert again.to_dict()["output"]["every"] == 5
    assert len(model.with_({"steps.1": None}).to_dict()["steps"]) == 1


def test_with_of_one_of_two_keys_replaces_the_other() -> None:
    joint = wythe.templates.couplet().with_({"interfaces.joint.G_I": "20 N/m"}).interface("joint")
    assert joint["G_I"] == pytest.approx(0.02)
    assert "u_k" not in joint


def test_materials_and_interfaces_by_name() -> None:
    model = wythe.templates.couplet()
    assert model.material("brick")["E"] == 16700.0
    assert model.interface("joint")["mu"] == 0.73
    with pytest.raises(KeyError, match="no material named 'stone'; the model has brick, mortar"):
        model.material("stone")
    with pytest.raises(KeyError, match="no interface named 'bed'; the model has joint"):
        model.interface("bed")


def test_a_saved_model_is_the_same(tmp_path: Path) -> None:
    model = wythe.templates.shear_wall()
    path = model.save(tmp_path / "wall.toml")
    assert path == str(tmp_path / "wall.toml")
    assert wythe.Model.from_toml(path) == model


def test_the_elevation_and_abaqus(model: wythe.Model) -> None:
    assert model.picture().svg.startswith("<svg")
    inp = model.to_inp()
    assert "*NODE" in inp.upper()
    assert "C3D8" in inp


def test_models_cannot_be_changed(model: wythe.Model) -> None:
    any_model: Any = model
    for name in ("title", "folder", "digest", "other"):
        with pytest.raises(AttributeError):
            setattr(any_model, name, "x")


def test_the_schema_knows_the_keys() -> None:
    assert wythe.schema().lstrip().startswith("{")
    assert '"K_c"' in wythe.schema()
    assert wythe.schema() == (EXAMPLES.parent / "docs" / "deck.schema.json").read_text()


def test_numbers_come_through_to_the_last_bit() -> None:
    """A deck from a dictionary is the same as from a text, whatever digits its numbers have."""
    model = wythe.templates.couplet()
    deck = model.to_dict()
    for value in np.random.default_rng(7).uniform(0.1, 0.5, 300):
        deck["interfaces"]["joint"]["f_t"] = value
        made = wythe.Model.from_dict(deck).to_dict()["interfaces"]["joint"]["f_t"]
        said = model.with_({"interfaces.joint.f_t": value}).to_dict()["interfaces"]["joint"]["f_t"]
        assert made == said == value


def test_keys_that_exclude_each_other_are_not_both_set() -> None:
    model = wythe.templates.couplet()
    one = model.with_({"interfaces.joint.G_I": "0.02 N/mm"})
    assert one.with_({"interfaces.joint.u_k": "0.1 mm"}).to_toml() != one.to_toml()
    with pytest.raises(wythe.ModelError, match="the keys exclude each other"):
        model.with_({"interfaces.joint.u_k": "0.1 mm", "interfaces.joint.G_I": "0.02 N/mm"})
