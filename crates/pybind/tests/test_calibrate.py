"""Calibrations of closed-form curves: values, intervals, what is not seen, failing runs, files."""

from __future__ import annotations

import json
import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import wythe
from calibration_fakes import KEYS, Bar, measured
from wythe import Calibration, CalibrationError, CurveFit, FailedRun, Posterior, calibrate

pytest.importorskip("scipy")

F = {"key": "f", "start": 1.5, "bounds": [0.5, 4.0]}
K = {"key": "k", "start": 8.0, "bounds": [2.0, 40.0], "scale": "log"}
U = {"key": "u", "start": 1.2, "bounds": [0.5, 3.0]}


def fitted(
    parameters: dict[str, Any], *, deck: Bar | None = None, curves: list[Any] | None = None, **more: Any
) -> Calibration:
    """A calibration of one test in threads; ``test`` has more keys of the test."""
    own = more.pop("test", {})
    test = {"name": "bar", "deck": deck or Bar(), "curves": curves or [measured()], **own}
    with ThreadPoolExecutor(2) as threads:
        return calibrate(
            tests=[test], parameters=parameters, executor=threads, progress=False, **more
        )


@pytest.fixture(scope="module")
def found() -> Calibration:
    return fitted({"f": F, "k": K, "u": U}, posterior="linearised", title="Bar")


def test_values_without_noise_are_exact() -> None:
    exact = fitted({"f": F, "k": K, "u": U}, curves=[measured(noise=0.0)], fit={"tolerance": 1e-10})
    for name in ("f", "k", "u"):
        # The curve is read between 200 rows: its kink lies between two of them.
        assert exact.values[name] == pytest.approx(KEYS[name], rel=1e-4)
    assert exact.noise < 1e-4 and exact.converged and exact.message


def test_errors_are_those_of_linear_regression() -> None:
    # On the rising branch the force is k x: the standard error of k has a closed form.
    x = np.linspace(0.01, 0.1, 25)
    scatter = np.random.default_rng(3).standard_normal(25) * 0.02
    curve = np.stack([x, 10.0 * x + scatter], axis=1)
    found = fitted({"k": {"key": "k", "start": 9.0, "bounds": [1.0, 30.0]}}, curves=[curve])
    best = float(x @ curve[:, 1] / (x @ x))
    left = curve[:, 1] - best * x
    error = math.sqrt(float(left @ left) / 24 / float(x @ x))
    # Both are exact but for the tolerance of the fit, 1e-4 of the change of the cost.
    assert found.values["k"] == pytest.approx(best, rel=1e-4)
    assert found.repeats == 1.0
    assert found.standard_errors["k"] == pytest.approx(error, rel=1e-3)
    # Student's quantile of 24 degrees of freedom.
    low, high = found.intervals["k"]
    assert (high - low) / 2.0 == pytest.approx(2.0639 * error, rel=1e-3)
    assert found.noise == pytest.approx(math.sqrt(float(left @ left) / 24) / curve[:, 1].max(), rel=1e-3)


def test_priors_weigh_like_measurements() -> None:
    # With a known noise the prior is one more measurement of k: means and information add.
    x = np.linspace(0.01, 0.1, 10)
    curve = np.stack([x, 10.0 * x], axis=1)
    noise = 0.1
    given = {"key": "k", "start": 9.0, "bounds": [1.0, 30.0], "prior": {"kind": "normal", "mean": 14.0, "cv": 0.1}}
    found = fitted({"k": given}, curves=[curve], fit={"noise": noise})
    # Residuals are over the peak, 1 kN.
    tests, prior = float(x @ x) / noise**2, 1.0 / 1.4**2
    assert found.values["k"] == pytest.approx((10.0 * tests + 14.0 * prior) / (tests + prior), rel=1e-3)
    assert found.standard_errors["k"] == pytest.approx((tests + prior) ** -0.5, rel=1e-3)
    lognormal = {**given, "prior": {"mean": 14.0, "cv": 0.1}, "scale": "log"}
    pulled = fitted({"k": lognormal}, curves=[curve], fit={"noise": noise})
    assert 10.0 < pulled.values["k"] < 14.0


def test_the_interval_of_an_unseen_parameter_is_that_of_its_bounds(found: Calibration) -> None:
    assert found.unseen == ()
    blind = fitted({"f": F, "loose": {"key": "unused", "start": 1.0, "bounds": [0.5, 3.0]}})
    assert blind.unseen == ("The tests do not see loose: its interval is as wide as its bounds.",)
    assert blind.intervals["loose"] == (0.5, 3.0)
    assert blind.values["loose"] == pytest.approx(1.0)
    assert blind.standard_errors["loose"] == math.inf
    assert blind.singular_values[-1] == 0.0 and blind.singular_values[0] > 1.0
    assert "do not see loose" in repr(blind) and "beyond bounds" in repr(blind)
    prior = {"key": "unused", "start": 1.0, "bounds": [0.1, 9.0], "prior": {"mean": 2.0, "cv": 0.2}}
    known = fitted({"f": F, "loose": prior})
    assert known.unseen == ("The tests do not see loose: its interval is as wide as its prior.",)
    # The value is the median of the prior, its error the deviation of the logarithm times the value.
    median, deviation = 2.0 / math.hypot(1.0, 0.2), math.sqrt(math.log1p(0.04))
    assert known.values["loose"] == pytest.approx(median, rel=1e-3)
    assert known.standard_errors["loose"] == pytest.approx(median * deviation, rel=1e-2)


def test_a_value_at_its_bound_is_named() -> None:
    for bounds, which, bound in (([0.5, 1.9], "upper", 1.9), ([2.5, 4.0], "lower", 2.5)):
        found = fitted({"f": {**F, "start": sum(bounds) / 2, "bounds": bounds}, "k": K})
        assert found.at_bounds == {"f": which} == found.summary["at_bounds"]
        assert found.values["f"] == pytest.approx(bound, rel=1e-3)
        assert found.unseen == ()
        assert found.notes[0].startswith(f"f is at its {which} bound, {bound:g}: the best value lies beyond.")
        assert "interval do not hold; widen this bound" in repr(found)
    inside = fitted({"f": F, "k": K})
    assert inside.at_bounds == {} and inside.notes == ()
    # Nothing stops a value at a bound that the curves do not move.
    blind = fitted({"f": F, "loose": {"key": "unused", "start": 3.0, "bounds": [0.5, 3.0]}})
    assert blind.at_bounds == {} and "do not see loose" in blind.unseen[0]
    # A prior stops a value at a bound, too.
    prior = {"key": "unused", "start": "1 MPa", "bounds": ["0.5 MPa", "1.5 MPa"], "prior": {"mean": "3 MPa", "cv": 0.1}}
    pulled = fitted({"f": F, "loose": prior})
    assert pulled.at_bounds == {"loose": "upper"} and "upper bound, 1.5 MPa" in pulled.notes[0]


def test_the_page_tells_of_a_bound(tmp_path: Path) -> None:
    stopped = fitted({"f": {**F, "bounds": [0.5, 1.8]}, "k": K})
    stopped.save(tmp_path)
    page = (tmp_path / "calibration.md").read_text()
    assert "* A bound stops f: its interval does not hold.\n* The tests see every other parameter." in page
    assert "\n* f is at its upper bound, 1.8: " in page


def test_a_large_misfit_is_told() -> None:
    found = fitted({"f": F}, curves=[measured() * [1.0, 1e3]])
    assert found.at_bounds == {"f": "upper"} and found.unseen == ()
    assert found.notes[1].startswith("The misfit is large: the fitted curves differ by up to ")
    assert "from curve 0 of bar. Check the units" in found.notes[1] and found.notes[1] in repr(found)


def test_two_parameters_that_act_alike_are_named() -> None:
    twin = {"key": "twin", "start": 1.0, "bounds": [0.3, 3.0]}
    found = fitted({"f": F, "twin": twin})
    (sentence,) = [line for line in found.unseen if "apart" in line]
    assert sentence.startswith("The tests do not tell f and twin apart: more of f with less of twin ")
    assert found.correlation[0, 1] == pytest.approx(-1.0, abs=0.01)
    # Only the product is known.
    assert found.values["f"] * found.values["twin"] == pytest.approx(2.0, rel=0.02)
    np.testing.assert_allclose(np.diag(found.correlation), 1.0)


def test_a_parameter_sets_several_keys_with_factors() -> None:
    keys = ["f", {"key": "k", "factor": 5.0}, {"key": "u", "factor": 0.5, "tests": ["bar"]}]
    found = fitted({"f": {"keys": keys, "start": 1.5, "bounds": [0.5, 4.0]}})
    value = found.values["f"]
    assert value == pytest.approx(2.0, rel=0.02)
    assert found.changes() == {"f": value, "k": 5.0 * value, "u": 0.5 * value}
    assert found.changes({"f": 1.0})["k"] == 5.0
    assert found.model("bar").to_dict()["u"] == 0.5 * value
    with pytest.raises(KeyError, match="the tests are bar"):
        found.model("rod")


def test_units_go_into_the_deck() -> None:
    with pytest.raises(CalibrationError, match="units differ"):
        fitted({"f": {"key": "f", "start": "1 MPa", "bounds": ["0.5 MPa", "4 kPa"]}})
    couplet = wythe.templates.couplet()
    wrong = {"key": "interfaces.joint.f_t", "start": "1 mm", "bounds": ["0.5 mm", "4 mm"]}
    with pytest.raises(CalibrationError, match=r"refuses interfaces.joint.f_t = 1.0 mm"):
        calibrate(tests=[{"deck": couplet, "curves": measured()}], parameters={"f_t": wrong})


def test_columns_steps_factors_and_windows() -> None:
    curve = measured(noise=0.0)
    half = fitted({"f": F}, curves=[curve], test={"y": "-half_kN", "factor": 2, "from": "0.1 mm", "to": 0.5})
    assert half.values["f"] == pytest.approx(2.0, rel=1e-3)
    (fit,) = half.curves
    assert isinstance(fit, CurveFit)
    assert fit.displacement.min() >= 0.1 and fit.displacement.max() <= 0.5
    assert (fit.test, fit.curve, fit.status) == ("bar", "curve 0", "completed")
    assert fit.force.shape == fit.fitted.shape and fit.x.shape == fit.y.shape
    assert fit.peak == fit.force.max() and fit.fitted_peak == pytest.approx(fit.peak, rel=0.02)
    assert fit.rms < 1e-2
    with pytest.raises(CalibrationError, match="no row of the history") as error:
        fitted({"f": F}, test={"steps": [3]})
    assert error.value.key == "tests.0"
    with pytest.raises(CalibrationError, match="no column `top_mm`") as error:
        fitted({"f": F}, test={"x": "top_mm"})
    assert error.value.key == "tests.0.x" and "history.csv" in error.value.fix


def test_points_beyond_the_drive_do_not_count() -> None:
    found = fitted({"f": F}, deck=Bar(end=0.6))
    assert found.curves[0].displacement.max() <= 0.6
    assert "lie beyond the end of the drive at 0.6" in found.notes[0]
    with pytest.raises(CalibrationError, match="drive the deck farther"):
        fitted({"f": F}, deck=Bar(end=0.03))


def test_the_peak_may_count() -> None:
    # The curves of a deck that is too ductile cannot fit: with the peak as many points, the peak does.
    def ratio(peak: float) -> float:
        fit = fitted({"f": F}, deck=Bar(u=1.6), test={"peak": peak}).curves[0]
        return fit.fitted_peak / fit.peak

    assert abs(ratio(1000.0) - 1.0) < 0.01 < abs(ratio(0.0) - 1.0)


def test_weights_decide_between_tests() -> None:
    def value(weight: float) -> float:
        with ThreadPoolExecutor(2) as threads:
            tests = [
                {"name": "weak", "deck": Bar(), "curves": [measured(f=1.6)]},
                {"name": "strong", "deck": Bar(), "curves": [measured(f=2.4)], "weight": weight},
            ]
            return calibrate(tests=tests, parameters={"f": F}, executor=threads, progress=False).values["f"]

    assert value(0.001) == pytest.approx(1.6, rel=0.02)
    assert value(1000.0) == pytest.approx(2.4, rel=0.02)


def test_runs_that_fail_are_listed_and_do_not_lead_the_fit() -> None:
    found = fitted({"f": {**F, "start": 1.9}}, deck=Bar(fail_above=1.905))
    # Beyond the limit lies the answer: the fit comes near, from below.
    assert 1.85 < found.values["f"] <= 1.905
    assert found.failures
    for failure in found.failures:
        assert isinstance(failure, FailedRun)
        assert failure.test == "bar" and failure.status == "failed" and failure.values["f"] > 1.905
        assert failure.message == "f: f is above what it bears; fix: less of it"
    assert "failed or ended early" in repr(found)
    with pytest.raises(CalibrationError, match="gave no curve: failed: f: f is above") as error:
        fitted({"f": F}, deck=Bar(fail_above=1.0))
    assert error.value.key == "tests.0"


@pytest.mark.parametrize("status", ["not_converged", "collapsed"])
def test_beyond_the_end_of_a_run_the_model_carries_nothing(status: str) -> None:
    found = fitted({"f": F}, deck=Bar(stop=0.5, status=status))
    fit = found.curves[0]
    beyond = fit.displacement > 0.5
    assert np.any(beyond) and np.all(fit.fitted[beyond] == 0.0) and np.all(fit.fitted[~beyond] > 0.0)
    assert fit.status == status
    assert found.values["f"] == pytest.approx(2.0, rel=0.05)
    assert {failure.status for failure in found.failures} == {status}


def test_points_that_deviate_together_count_less() -> None:
    # The same scatter for ten neighbours each.
    curve = measured(noise=0.0, points=200)
    steps = np.repeat(np.random.default_rng(5).standard_normal(20), 10) * 0.05
    curve[:, 1] += steps
    found = fitted({"f": F}, curves=[curve])
    assert 5.0 < found.repeats < 39.0
    alone = fitted({"f": F}, curves=[measured(noise=0.02, points=200)])
    assert alone.repeats == 1.0


def test_whole_specimens_deviate() -> None:
    # Five specimens with forces times known factors, whose logarithms have the deviation 0.1 about.
    factors = np.array([0.9, 1.1, 0.95, 1.15, 0.9])
    curves = [measured(noise=0.01, seed=seed) * [1.0, factor] for seed, factor in enumerate(factors)]
    parameters = {"f": F, "k": K}
    found = fitted(parameters, curves=curves, posterior={"draws": 0})
    deviation = float(factors.std(ddof=1))
    # Over the mean of the factors, as the fit has it.
    assert found.between == pytest.approx(deviation / factors.mean(), rel=0.05)
    assert found.repeats < 2.0 and found.noise == pytest.approx(0.01, rel=0.2)
    # The strength is that of the mean; its error is that of the mean of five, with Student's four degrees of freedom.
    assert found.values["f"] == pytest.approx(2.0 * factors.mean(), rel=0.02)
    error = 2.0 * deviation / math.sqrt(5.0)
    assert found.standard_errors["f"] == pytest.approx(error, rel=0.1)
    low, high = found.intervals["f"]
    assert (high - low) / 2.0 == pytest.approx(2.776 * error, rel=0.15)
    assert "Deviation of whole specimens" in repr(found)
    # The posterior has the same covariance; 500 independent samples know a deviation to 3 %, here five of that.
    assert found.posterior is not None
    assert found.posterior.mean()["f"] == pytest.approx(found.values["f"], abs=0.2 * found.standard_errors["f"])
    assert found.posterior.deviation()["f"] == pytest.approx(found.standard_errors["f"], rel=0.15)
    assert fitted(parameters, curves=curves[:1]).between == 0.0


def test_the_posterior_is_that_of_the_fit(found: Calibration) -> None:
    posterior = found.posterior
    assert isinstance(posterior, Posterior)
    assert posterior.names == ("f", "k", "u") and posterior.kind == "linearised"
    assert posterior.samples.shape == (32 * 1500, 3) and posterior.draws.shape == (16, 3)
    assert 0.2 < posterior.acceptance < 0.8 and posterior.independent > 500.0
    assert posterior.linearisation_error < 1.0
    low, high, mean, deviation = (
        posterior.quantile(0.025), posterior.quantile(0.975), posterior.mean(), posterior.deviation()
    )  # fmt: skip
    for name in found.names:
        # 500 independent samples: means within 0.2 and deviations within 0.1, four standard errors.
        assert mean[name] == pytest.approx(found.values[name], abs=0.2 * found.standard_errors[name])
        assert deviation[name] == pytest.approx(found.standard_errors[name], rel=0.15)
        assert low[name] < found.values[name] < high[name]
    assert "linearised" in repr(posterior)


def test_the_posterior_of_the_model_is_near_the_linearised_one() -> None:
    own = {"kind": "model", "walkers": 8, "steps": 70, "burn": 10, "draws": 0}
    true = fitted({"f": F}, posterior=own)
    assert true.posterior is not None and true.posterior.kind == "model"
    assert math.isnan(true.posterior.linearisation_error)
    assert true.runs > 200
    # 480 samples of which some 50 are independent: a deviation is known to 10 %, here three of that.
    assert true.posterior.deviation()["f"] == pytest.approx(true.standard_errors["f"], rel=0.3)


def test_samples_are_keys_of_decks(found: Calibration) -> None:
    rows = found.samples(3, seed=4)
    assert len(rows) == 3 and set(rows[0]) == {"f", "k", "u"}
    assert rows == found.samples(3, seed=4) != found.samples(3, seed=5)
    with pytest.raises(ValueError, match="from 1 to"):
        found.samples(0)
    with pytest.raises(ValueError, match="there is no posterior"):
        fitted({"f": F}).samples(3)


def test_the_same_call_gives_the_same_bits(found: Calibration) -> None:
    again = fitted({"f": F, "k": K, "u": U}, posterior="linearised", title="Bar")
    assert json.dumps(again.summary) == json.dumps(found.summary)
    assert again.posterior is not None and found.posterior is not None
    assert np.array_equal(again.posterior.samples, found.posterior.samples)


def test_files(found: Calibration, tmp_path: Path) -> None:
    names = {Path(path).name for path in found.save(tmp_path / "out")}
    assert names == {"calibration.json", "calibration.md", "materials.toml", "posterior.csv", "curves.png"}
    said = json.loads((tmp_path / "out" / "calibration.json").read_text())
    assert said == json.loads(json.dumps(found.summary))
    assert said["parameters"]["k"]["value"] == found.values["k"]
    assert said["runs"] == found.runs and said["iterations"] == found.iterations
    page = (tmp_path / "out" / "calibration.md").read_text()
    assert page.startswith("# Bar\n") and "curves.png" in page and "The tests see every parameter." in page
    for name, unit in found.units.items():
        assert f"| {name} | {unit or '–'} |" in page
    assert (tmp_path / "out" / "curves.png").read_bytes().startswith(b"\x89PNG")
    assert len((tmp_path / "out" / "posterior.csv").read_text().splitlines()) == 1 + 32 * 1500
    # A test, its curve, the draws and the fit.
    (axes,) = found.plot().axes
    assert len(axes.lines) == 16 + 1 + 1 and found.tests == ("bar",) and found.title == "Bar"
    # No key of a bar is one of a material.
    assert "in the deck of test bar is no part of a material" in found.materials
    blocked = tmp_path / "blocked"
    blocked.write_text("")
    with pytest.raises(wythe.OutputError):
        found.save(blocked)


def test_a_stopped_calibration_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "out"
    first = fitted({"f": F, "k": K}, out=out)
    batches = sorted((out / "runs").iterdir())
    assert len(batches) > 3 and all((batch / "study.csv").is_file() for batch in batches)

    def never(*arguments: object) -> None:
        raise AssertionError("a run that is there already")

    monkeypatch.setattr(Bar, "run", never)
    again = fitted({"f": F, "k": K}, out=out)
    assert again.summary == first.summary
    assert sorted((out / "runs").iterdir()) == batches


def test_progress_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    test = {"deck": Bar(), "curves": measured()}
    with ThreadPoolExecutor(1) as threads:
        found = calibrate(tests=[test], parameters={"f": F}, executor=threads)
    told = capsys.readouterr().err
    assert "calibrate: 1 runs, misfit" in told and found.tests == ("test 1",)
