"""Standard tests: models, runs and evaluation from Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import wythe


FUNCTIONS: list[wythe.tests.Maker] = [
    wythe.tests.en1052_1,
    wythe.tests.en1052_2,
    wythe.tests.en1052_3,
    wythe.tests.en1052_5,
    wythe.tests.couplet_tension,
    wythe.tests.direct_shear,
    wythe.tests.astm_e519,
    wythe.tests.rilem_lumb6,
    wythe.tests.shear_compression,
    wythe.tests.shear_compression_cantilever,
    wythe.tests.shear_compression_cyclic,
    wythe.tests.out_of_plane,
    wythe.tests.out_of_plane_two_way,
    wythe.tests.out_of_plane_four_point,
    wythe.tests.tilting_table,
    wythe.tests.flat_jack,
    wythe.tests.flat_jack_double,
    wythe.tests.astm_c1531,
]


def test_every_test_has_a_function_and_models() -> None:
    assert [make.__name__.replace("_", "-") for make in FUNCTIONS] == list(wythe.tests.names())
    for make in FUNCTIONS:
        test = make(unit="210x100x60")
        assert isinstance(test, wythe.tests.Test)
        assert test.name in wythe.tests.names()
        assert all(isinstance(model, wythe.Model) for model in test.models.values())
        assert make.__doc__


def test_a_couplet_gives_its_strength_back(tmp_path: Path) -> None:
    found = wythe.tests.couplet_tension().run(tmp_path, threads=1)
    # The stress is a little uneven, so that the strength is somewhat lower than f_t = 0.1786 MPa of M5 on clay.
    assert 0.98 * 0.1786 < found["f_t"] <= 0.1786
    assert isinstance(found, wythe.tests.Evaluation)
    assert found.test == "couplet-tension"
    strength = found.runs["couplet-tension"]["f_t"]
    assert isinstance(strength, wythe.tests.TestValue)
    assert (strength.name, strength.unit) == ("f_t", "MPa")
    assert "F_max / A" in strength.about
    assert found.together == {}
    assert found.notes == ()
    assert "f_t" in str(found)
    assert dict(found) == {value.name: value.value for value in found.runs["couplet-tension"].values()}
    again = wythe.tests.evaluate(tmp_path / "couplet-tension.out")
    assert again["f_t"] == found["f_t"]
    assert found.results[""].status == "completed"


def test_several_pressures_are_evaluated_together() -> None:
    found = wythe.tests.direct_shear(precompression=[0.2, 1.0]).run(threads=1)
    assert list(found.runs) == ["direct-shear-0.2", "direct-shear-1"]
    # c = 0.25 MPa and tan phi = 0.5, less some per cent by uneven shear.
    assert 0.95 * 0.25 < found["c"] <= 0.2501
    assert 0.97 * 0.5 < found["tan_phi"] <= 0.5001
    with pytest.raises(KeyError, match="f_v: there are c"):
        found["f_v"]


def test_materials_come_from_models_dictionaries_and_files(tmp_path: Path) -> None:
    wall = wythe.templates.couplet()
    by_model = wythe.tests.couplet_tension(materials=wall).models[""].to_dict()
    assert by_model["interfaces"]["joint"]["f_t"] == 0.28
    path = wall.save(tmp_path / "couplet.toml")
    by_file = wythe.tests.couplet_tension(materials=path or tmp_path / "couplet.toml").models[""]
    assert by_file.to_dict()["interfaces"] == by_model["interfaces"]
    tables = {key: wall.to_dict()[key] for key in ("materials", "interfaces")}
    by_tables = wythe.tests.couplet_tension(materials=tables).models[""]
    assert by_tables.to_dict()["interfaces"] == by_model["interfaces"]


def test_sizes_are_texts_sequences_or_arrays() -> None:
    by_text = wythe.tests.shear_compression(unit="210x100x60", size="900x800", joint="1 cm", precompression=0.5)
    given: list[Any] = [([210, 100.0, 60], (900, 800)), (np.array([210, 100, 60]), np.array([900.0, 800.0]))]
    for unit, size in given:
        by_numbers = wythe.tests.shear_compression(unit=unit, size=size, joint=10, precompression=[0.5])
        assert by_numbers.models == by_text.models


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"unit": [250, 120]}, 'unit: expected 3 numbers in mm, or a text such as "250x120x55", got list'),
        ({"unit": ["250 mm", "120 mm", "55 mm"]}, "unit: expected 3 numbers in mm"),
        ({"unit": 250}, "unit: expected 3 numbers in mm, .* got 250"),
        ({"size": [1200.0, True]}, 'size: expected 2 numbers in mm, or a text such as "1200x1200"'),
        ({"joint": {}}, 'joint: expected numbers, or a text such as "1 cm", got dict'),
        ({"precompression": [None]}, "precompression: expected numbers, or a text such as"),
        ({"materials": 3}, "materials: expected a path"),
    ],
)
def test_options_of_a_wrong_type_are_named(options: dict[str, Any], told: str) -> None:
    with pytest.raises(TypeError, match=told):
        wythe.tests.shear_compression(**options)


def test_wrong_options_are_value_errors() -> None:
    with pytest.raises(ValueError, match="unit: .* has 2 sizes, not 3"):
        wythe.tests.couplet_tension(unit="250x120")
    with pytest.raises(ValueError, match="precompression: couplet-tension has no precompression"):
        wythe.tests.couplet_tension(precompression=0.2)
    with pytest.raises(ValueError, match="there is no test"):
        wythe.tests.standard("brick")
    with pytest.raises(ValueError, match="no table"):
        wythe.tests.evaluate(wythe.templates.couplet().run())
