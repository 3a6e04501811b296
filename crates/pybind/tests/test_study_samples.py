"""Grids, samples, and samples drawn at random."""

from __future__ import annotations

import importlib
import sys
from typing import Any

import numpy as np
import pytest

import wythe
from wythe import latin_hypercube, lognormal, normal, study
from wythe._study._samples import expand, fingerprint
from study_fakes import FakeModel


def test_a_grid_is_all_combinations_and_its_first_key_varies_slowest() -> None:
    samples = expand({"a": [1, 2], "b": ["x", "y", "z"]}, None)
    assert [tuple(sample.values()) for sample in samples] == [
        (1, "x"), (1, "y"), (1, "z"), (2, "x"), (2, "y"), (2, "z"),
    ]  # fmt: skip


def test_rows_columns_and_frames_are_the_same_samples() -> None:
    pandas = pytest.importorskip("pandas")
    rows = [{"a": 1, "b": "0.2 MPa"}, {"b": "0.3 MPa", "a": 2}]
    columns = {"a": np.array([1, 2]), "b": ("0.2 MPa", "0.3 MPa")}
    expected = [{"a": 1, "b": "0.2 MPa"}, {"a": 2, "b": "0.3 MPa"}]
    for samples in (rows, iter(rows), columns, pandas.DataFrame(columns)):
        found = expand(None, samples)
        assert found == expected
        assert [list(sample) for sample in found] == [["a", "b"], ["a", "b"]]
        assert all(type(sample["a"]) is int for sample in found)


def test_values_may_be_lists_and_numpys() -> None:
    sizes = np.array([[204.0, 98.0, 50.0], [200.0, 98.0, 50.0]])
    samples = expand({"wall.unit": sizes, "flag": np.array([True])}, None)
    assert samples[1] == {"wall.unit": [200.0, 98.0, 50.0], "flag": True}


def test_samples_are_known_again() -> None:
    one = fingerprint(expand({"a": [1, 2]}, None))
    assert one == fingerprint(expand(None, {"a": range(1, 3)}))
    assert one != fingerprint(expand({"a": [2, 1]}, None))
    assert one != fingerprint(expand({"b": [1, 2]}, None))


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({}, TypeError, "either parameters .* or samples .* neither"),
        ({"parameters": {"a": [1]}, "samples": [{"a": 1}]}, TypeError, "got both"),
        ({"parameters": [1, 2]}, TypeError, "parameters: expected a mapping of deck keys"),
        ({"parameters": {}}, ValueError, "parameters: expected at least one key"),
        ({"parameters": {"a": "0.2 MPa"}}, TypeError, "parameters: a: expected a sequence"),
        ({"parameters": {"a": 0.2}}, TypeError, "parameters: a: expected a sequence .* got 0.2"),
        ({"parameters": {"a": []}}, ValueError, "parameters: a: expected at least one value"),
        ({"parameters": {1: [1]}}, TypeError, "parameters: expected keys such as"),
        ({"parameters": {"a": [1, None]}}, TypeError, r"parameters: a\[1\]: expected a number"),
        ({"parameters": {"a": [float("nan")]}}, ValueError, r"a\[0\]: expected a finite number"),
        ({"parameters": {"a": range(10**4), "b": range(10**4)}}, ValueError, "100000000 combin"),
        ({"parameters": {"wall_s": [1]}}, ValueError, "parameters: wall_s is a column"),
        ({"samples": []}, ValueError, "samples: expected at least one"),
        ({"samples": {}}, ValueError, "samples: expected at least one column"),
        ({"samples": 7}, TypeError, "samples: expected a sequence of mappings"),
        ({"samples": "abc"}, TypeError, "samples: expected a sequence of mappings"),
        ({"samples": [3]}, TypeError, "samples: sample 1: expected a mapping"),
        ({"samples": [{}]}, ValueError, "samples: sample 1 is empty"),
        ({"samples": [{"a": 1}, {"b": 1}]}, ValueError, "sample 1 has a, sample 2 has b"),
        ({"samples": [{"a": 1}, {"a": object()}]}, TypeError, "samples: sample 2, a: expected a"),
        ({"samples": {"a": [1, 2], "b": [1]}}, ValueError, "one length, but a has 2, b has 1"),
        ({"samples": {"a": 1}}, TypeError, "samples: a: expected a sequence"),
        ({"samples": [{"status": 1}]}, ValueError, "samples: status is a column"),
    ],
)
def test_what_is_no_sample_is_refused_by_name(
    arguments: dict[str, Any], error: type[Exception], says: str
) -> None:
    with pytest.raises(error, match=says):
        study(FakeModel(), **arguments)


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"model": 3}, TypeError, "model: expected a wythe.Model or a function of a sample, got 3"),
        ({"measure": "peak"}, TypeError, "measure: expected a function"),
        ({"retries": -1}, ValueError, "retries: expected a whole number from 0, got -1"),
        ({"retries": 1.5}, TypeError, "retries: expected a whole number from 0, got 1.5"),
        ({"keep": "all"}, ValueError, "keep: expected \"none\" or \"results\", got 'all'"),
        ({"keep": "results"}, ValueError, "keep: .* needs a folder"),
        ({"progress": 1}, TypeError, "progress: expected True or False, got 1"),
        ({"callback": 1}, TypeError, "callback: expected a function of a row"),
        ({"executor": 0}, ValueError, "executor: expected a whole number from 1"),
        ({"executor": True}, TypeError, "executor: expected a whole number from 1, got True"),
        ({"executor": "dask"}, TypeError, r"executor: expected an executor with submit\(\)"),
        ({"out": 3}, TypeError, "out: expected a path"),
    ],
)
def test_other_arguments_are_refused_by_name(
    arguments: dict[str, Any], error: type[Exception], says: str
) -> None:
    model = arguments.pop("model", FakeModel())
    with pytest.raises(error, match=says):
        study(model, {"a": [1]}, **{"progress": False, **arguments})


def test_every_strip_of_a_latin_hypercube_has_one_sample() -> None:
    columns = latin_hypercube({"a": (2.0, 4.0), "b": (0, 1), "c": lognormal(1.0, 0.3)}, 50, 7)
    a = np.asarray(columns["a"])
    assert sorted(np.floor((a - 2.0) / 2.0 * 50).astype(int)) == list(range(50))
    # Random pairings of 50 are correlated by 0.14 on the mean; exchanges make the samples more even.
    correlations = np.corrcoef([columns["a"], columns["b"], columns["c"]]) - np.eye(3)
    assert np.max(np.abs(correlations)) < 0.15
    assert expand(None, columns)[0] == {key: float(column[0]) for key, column in columns.items()}


def test_a_seed_says_the_samples() -> None:
    ranges = {"a": (0.0, 1.0), "b": (0.0, 1.0)}
    one, same, other = (latin_hypercube(ranges, 9, seed) for seed in (1, 1, 2))
    assert all(np.array_equal(one[key], same[key]) for key in ranges)
    assert not np.array_equal(one["a"], other["a"])


def test_ranges_may_have_units() -> None:
    column = latin_hypercube({"a": ("1 MPa", "2 MPa")}, 4, 0)["a"]
    numbers = sorted(float(value.removesuffix(" MPa")) for value in map(str, column))
    assert len(numbers) == 4 and 1.0 < numbers[0] < 1.25 and 1.75 < numbers[3] < 2.0


def test_distributions_have_their_moments() -> None:
    # The mean of the strips' samples has an error of order 1/n, of 20000 far below 1e-3; cv 30 times more.
    both: list[wythe.Distribution] = [lognormal(0.2, 0.3), normal(0.2, 0.3)]
    for distribution in both:
        values = np.asarray(latin_hypercube({"a": distribution}, 20_000, 3)["a"], dtype=float)
        assert np.mean(values) == pytest.approx(0.2, rel=1e-3)
        assert np.std(values) / np.mean(values) == pytest.approx(0.3, rel=1e-2)
        assert isinstance(distribution, wythe.Distribution)
    # Median of a lognormal: mean / sqrt(1 + cv²).
    assert float(lognormal(0.2, 0.3).ppf(0.5)) == pytest.approx(0.2 / np.sqrt(1.09), rel=1e-12)


def test_distributions_of_scipy_pass_and_agree() -> None:
    stats: Any = importlib.import_module("scipy.stats")
    sigma = np.sqrt(np.log(1.09))
    theirs = stats.lognorm(sigma, scale=0.2 / np.sqrt(1.09))
    ours = latin_hypercube({"a": lognormal(0.2, 0.3)}, 30, 1)["a"]
    # Both to the accuracy of their inverse normal distributions.
    np.testing.assert_allclose(latin_hypercube({"a": theirs}, 30, 1)["a"], ours, rtol=1e-9)


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ((3, 4, 0), TypeError, "ranges: expected a mapping"),
        (({}, 4, 0), TypeError, "ranges: expected a mapping"),
        (({"a": 3}, 4, 0), TypeError, r"ranges: a: expected \(low, high\) or a distribution"),
        (({"a": (1, 2, 3)}, 4, 0), TypeError, "ranges: a: expected"),
        (({"a": (2, 1)}, 4, 0), ValueError, "ranges: a: expected low < high"),
        (({"a": ("1 MPa", "2 kPa")}, 4, 0), ValueError, "ranges: a: expected both bounds in one"),
        (({"a": ("x", "y")}, 4, 0), ValueError, "ranges: a: expected two numbers"),
        (({1: (1, 2)}, 4, 0), TypeError, "ranges: expected keys"),
        (({"a": (1, 2)}, 0, 0), ValueError, "count: expected a whole number from 1, got 0"),
        (({"a": (1, 2)}, 4.0, 0), TypeError, "count: expected a whole number from 1, got 4.0"),
        (({"a": (1, 2)}, 4, -1), ValueError, "seed: expected a whole number from 0"),
    ],
)
def test_what_is_no_range_is_refused_by_name(
    arguments: tuple[Any, Any, Any], error: type[Exception], says: str
) -> None:
    with pytest.raises(error, match=says):
        latin_hypercube(*arguments)


def test_impossible_distributions_are_refused() -> None:
    with pytest.raises(ValueError, match="mean: expected a number above 0"):
        lognormal(-1.0, 0.3)
    with pytest.raises(ValueError, match="cv: expected a number above 0"):
        normal(1.0, 0.0)
    with pytest.raises(TypeError, match="cv: expected a number, got 'x'"):
        lognormal(1.0, "x")  # type: ignore[arg-type]


def test_a_few_samples_of_one_range_are_drawn() -> None:
    assert 0.0 < float(latin_hypercube({"a": (0.0, 1.0)}, 1, 0)["a"][0]) < 1.0
    two = latin_hypercube({"a": (0.0, 1.0), "b": (0.0, 1.0)}, 2, 0)
    assert all(sorted(np.floor(2.0 * np.asarray(column, dtype=float))) == [0, 1] for column in two.values())


def test_sampling_without_scipy_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    for draw in (lambda: latin_hypercube({"a": (0, 1)}, 4, 0), lambda: lognormal(1.0, 0.2)):
        with pytest.raises(ImportError, match=r"this needs scipy: pip install 'wythe\[study\]'"):
            draw()
