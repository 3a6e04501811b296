"""Wrong jobs: each error names the key and the fix."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import wythe
from calibration_fakes import Bar, measured
from wythe import CalibrationError, calibrate

pytest.importorskip("scipy")

F: dict[str, Any] = {"key": "f", "start": 1.5, "bounds": [0.5, 4.0]}
TEST: dict[str, Any] = {"name": "bar", "deck": Bar(), "curves": [measured()]}


def refused(
    *, parameter: dict[str, Any] | None = None, test: dict[str, Any] | None = None, **more: Any
) -> CalibrationError:
    """The error of a job; a key that is None is left out."""
    with pytest.raises(CalibrationError) as error:
        calibrate(
            tests=[{**TEST, **(test or {})}],
            parameters={"f": {**F, **(parameter or {})}},
            executor=1,
            progress=False,
            **more,
        )
    assert error.value.fix, str(error.value)
    return error.value


@pytest.mark.parametrize(
    ("parameter", "key", "says"),
    [
        ({"strat": 1.0}, "strat", "did you mean `start`"),
        ({"start": None}, "start", "missing"),
        ({"start": 9.0}, "start", "not between the bounds 0.5 and 4"),
        ({"start": "much"}, "start", "expected a quantity, got 'much'"),
        ({"start": True}, "start", "expected a quantity"),
        ({"bounds": [4.0, 0.5]}, "bounds", "not below"),
        ({"bounds": [1.0]}, "bounds", "expected two"),
        ({"bounds": 3}, "bounds", "expected a list"),
        ({"bounds": [0.0, 4.0], "scale": "log"}, "bounds", "a logarithmic scale needs bounds above 0"),
        ({"bounds": [0.0, 4.0], "prior": {"mean": 1, "cv": 0.1}}, "bounds", "a lognormal prior needs"),
        ({"scale": "cubic"}, "scale", "one of linear, log"),
        ({"prior": {"kind": "flat", "mean": 1, "cv": 0.1}}, "prior.kind", "one of normal, lognormal"),
        ({"prior": {"mean": 1, "cv": 0}}, "prior.cv", "0 is not admissible"),
        ({"prior": {"mean": -1, "cv": 0.1}}, "prior.mean", "above 0"),
        ({"prior": {"cv": 0.1}}, "prior.mean", "missing"),
        ({"prior": 3}, "prior", "expected a table"),
        ({"key": None}, "key", "either key or keys"),
        ({"keys": ["f"]}, "key", "either key or keys"),
        ({"key": "g"}, "key", "refuses g = 1.5: `g` is not a known key"),
        ({"key": 3}, "key", "expected a deck key"),
        ({"key": {"key": ""}}, "key.key", "dotted path"),
        ({"key": None, "keys": ["f", {"key": "k", "tests": ["rod"]}]}, "keys.1.tests", "no test named 'rod'"),
        ({"key": None, "keys": [{"key": "f", "fcator": 2}]}, "keys.0.fcator", "did you mean `factor`"),
    ],
)
def test_a_parameter(parameter: dict[str, Any], key: str, says: str) -> None:
    error = refused(parameter=parameter)
    assert error.key == f"parameters.f.{key}"
    assert says in str(error)


@pytest.mark.parametrize(
    ("test", "key", "says"),
    [
        ({"wieght": 1}, "wieght", "did you mean `weight`"),
        ({"weight": 0}, "weight", "above 0"),
        ({"peak": -1}, "peak", "negative"),
        ({"factor": "two"}, "factor", "expected a number"),
        ({"deck": None}, "deck", "missing"),
        ({"deck": 3}, "deck", "a path or a wythe.Model"),
        ({"deck": "none.toml"}, "deck", "none.toml"),
        ({"set": {"g": 3}}, "set", "`g` is not a known key"),
        ({"set": ["f"]}, "set", "expected KEY=VALUE"),
        ({"curves": None}, "curves", "missing"),
        ({"curves": []}, "curves", "expected a list"),
        ({"curves": ["none.csv"]}, "curves.0", "cannot be read"),
        ({"curves": [np.zeros((5, 3))]}, "curves.0", "shape (points, 2), got one of shape (5, 3)"),
        ({"curves": [np.zeros((5, 1))]}, "curves.0", "shape (points, 2), got one of shape (5, 1)"),
        ({"curves": [[0.0, 1.0]]}, "curves.0", "shape (points, 2), got one of shape (2,)"),
        ({"curves": [np.zeros((2, 2))]}, "curves.0", "with 3 points or more, got 2"),
        ({"curves": [7]}, "curves.0", "shape (points, 2), got 7"),
        ({"curves": [[[0, 1], [1, float("nan")], [2, 3]]]}, "curves.0", "not finite"),
        ({"curves": [-measured()]}, "curves.0", "no force above 0"),
        ({"curves": [np.vstack([measured(), measured()])]}, "curves.0", "the envelope of a cyclic test"),
        ({"from": 0.93}, "curves", "points between from and to"),
        ({"from": 1.0, "to": 0.5}, "to", "larger displacement"),
        ({"to": "1 cm"}, "to", "the unit cm"),
        ({"steps": ["one"]}, "steps", "count the steps"),
        ({"name": 3}, "name", "expected a text"),
    ],
)
def test_a_test(test: dict[str, Any], key: str, says: str) -> None:
    error = refused(test=test)
    assert error.key == f"tests.0.{key}"
    assert says in str(error)


@pytest.mark.parametrize(
    ("more", "key", "says"),
    [
        ({"fit": {"steps": 1}}, "fit.steps", "did you mean `step`"),
        ({"fit": {"iterations": 0}}, "fit.iterations", "whole number from 1"),
        ({"fit": {"differences": "left"}}, "fit.differences", "central, forward"),
        ({"fit": {"noise": 0}}, "fit.noise", "above 0"),
        ({"posterior": "exact"}, "posterior.kind", "one of linearised, model, none"),
        ({"posterior": {"walkers": 3}}, "posterior.walkers", "whole number from 4"),
        ({"posterior": {"steps": 50, "burn": 50}}, "posterior.burn", "not below"),
        ({"posterior": {"sead": 1}}, "posterior.sead", "did you mean `seed`"),
    ],
)
def test_settings(more: dict[str, Any], key: str, says: str) -> None:
    error = refused(**more)
    assert error.key == key
    assert says in str(error)


def test_names() -> None:
    with pytest.raises(CalibrationError, match="`peak force` cannot be a name"):
        calibrate(tests=[TEST], parameters={"peak force": F})
    with pytest.raises(CalibrationError, match="`status` cannot be a name"):
        calibrate(tests=[TEST], parameters={"status": F})
    with pytest.raises(CalibrationError, match="there is none"):
        calibrate(tests=[TEST], parameters={})
    with pytest.raises(CalibrationError, match="the name of another test") as error:
        calibrate(tests=[TEST, TEST], parameters={"f": F})
    assert error.value.key == "tests.1.name"


def test_more_parameters_than_points() -> None:
    parameters = {name: {**F, "key": name, "bounds": [0.1, 20.0]} for name in ("f", "k", "u")}
    with pytest.raises(CalibrationError, match="3 measured points for 3 parameters"):
        test = {**TEST, "curves": [measured(points=3)]}
        calibrate(tests=[test], parameters=parameters, executor=1, progress=False)


def test_arguments() -> None:
    with pytest.raises(TypeError, match="either a job file or tests and parameters, got neither"):
        calibrate()
    with pytest.raises(TypeError, match="got both"):
        calibrate("job.toml", tests=[TEST])
    with pytest.raises(TypeError, match="fit: it belongs to"):
        calibrate("job.toml", fit={})
    with pytest.raises(TypeError, match="progress: expected True or False"):
        calibrate("job.toml", progress=1)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="executor: expected a whole number from 1, got 0"):
        calibrate("job.toml", executor=0)


def test_the_error_of_a_file_names_it(tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    with pytest.raises(CalibrationError, match=r"job.toml: cannot be read: No such file"):
        calibrate(job)
    job.write_text("tests = [")
    with pytest.raises(CalibrationError, match=r"job.toml: no TOML: Invalid value") as syntax:
        calibrate(job)
    assert syntax.value.file == str(job)
    (tmp_path / "couplet.toml").write_text(wythe.templates.text("couplet"))
    (tmp_path / "measured.csv").write_text("displacement_mm,force_kN\n0,0\n0.1,x\n")
    text = (
        '[parameters.f_t]\nkey = "interfaces.joint.ft"\nstart = 0.2\nbounds = [0.1, 1]\n'
        '[[tests]]\ndeck = "couplet.toml"\ncurves = ["measured.csv"]\n'
    )
    job.write_text(text)
    with pytest.raises(CalibrationError, match=r"job.toml: tests.0.curves.0: .*measured.csv:3: `x`"):
        calibrate(job)
    (tmp_path / "measured.csv").write_text("displacement_mm,force_kN\n0,0\n0.001,2\n0.002,4\n")
    with pytest.raises(CalibrationError, match=r"job.toml: parameters.f_t.key: (?s:.*)did you mean `f_t`") as error:
        calibrate(job)
    assert (error.value.file, error.value.key) == (str(job), "parameters.f_t.key")
    assert "did you mean" in error.value.fix and error.value.message
    copy = pickle.loads(pickle.dumps(error.value))
    assert str(copy) == str(error.value) and isinstance(copy, wythe.WytheError)
    job.write_text(f"format = 2\n{text}")
    with pytest.raises(CalibrationError, match="format 2 is not known"):
        calibrate(job)
