"""Runs with the estimate of their error."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import wythe


def test_a_run_states_its_error(model: wythe.Model, tmp_path: Path) -> None:
    run = model.run(tmp_path / "couplet.out", error=True)
    estimate = run.error_estimate
    peak = estimate["peak_force_kN"]
    assert peak["value"] == run.peak_force
    assert peak["error"] == pytest.approx(math.hypot(*peak["parts"].values()), rel=1e-12)
    # A joint of one law all over: mesh and increments change little.
    assert 0.0 < peak["relative"] < 0.05
    for companion in estimate["companions"]:
        results = wythe.Results(Path(run.path) / companion["folder"])
        assert results.status == companion["status"] == "completed"
        assert results.peak_force == companion["figures"]["peak_force_kN"]
        assert results.error_estimate == {}
    assert [of["part"] for of in estimate["companions"]] == ["time", "mesh"]
    assert run.error_lines[0].startswith("peak ")
    assert "±" in run.error_lines[0]
    # The run itself is the same as without.
    plain = model.run()
    assert plain.error_estimate == {}
    assert plain.error_lines == []
    plain.history.to_csv(tmp_path / "plain.csv")
    run.history.to_csv(tmp_path / "with.csv")
    assert (tmp_path / "plain.csv").read_bytes() == (tmp_path / "with.csv").read_bytes()
    # The next run into the folder takes the companions away.
    model.run(run.path)
    assert not (Path(run.path) / "error").exists()


def test_a_run_that_was_stopped_has_no_error(model: wythe.Model) -> None:
    run = model.run(error=True, callback=lambda row: row.increment < 3)
    assert run.status == "stopped"
    assert run.error_estimate["peak_force_kN"] is None
    assert run.error_lines == [
        f"error by {part} not estimated: the run itself was stopped by a callback"
        for part in ("time", "mesh")
    ]


def test_wrong_arguments_are_refused(model: wythe.Model) -> None:
    with pytest.raises(TypeError, match="error: expected True or False"):
        model.run(error=1)  # type: ignore[arg-type]
    law = wythe.JointLaw("free", lambda gap, plastic, state, stiffness: (np.zeros(3), np.zeros((3, 3))))
    with pytest.raises(ValueError, match="not with laws of your own"):
        model.run(error=True, laws={"joint": law})
