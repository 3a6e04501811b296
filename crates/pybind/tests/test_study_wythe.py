"""Studies of real models."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wythe
from wythe import Study, latin_hypercube, study
from wythe._study import Workers

# What depends on the machine and on what else it does.
TIMES = {"wall_s", "cpu_s", "peak_rss_MB", "attempts"}
COUPLET = wythe.templates.couplet().with_({"steps.1.displacement": "0.01 mm"})
GRID = {"interfaces.joint.f_t": ["0.1 MPa", "0.2 MPa"], "interfaces.joint.zeta": [3.0, 4.0]}


def opened(results: wythe.Results) -> dict[str, float]:
    """A measure that looks into the fields."""
    return {"widest_mm": float(np.max(results.interfaces("last").opening))}


def told(table: Study) -> list[dict[str, Any]]:
    return [{key: row[key] for key in row if key not in TIMES} for row in table]


def test_every_executor_gives_the_same_table() -> None:
    pytest.importorskip("distributed")
    with ThreadPoolExecutor(2) as threads, Workers(2) as workers:
        tables = [
            study(COUPLET, GRID, executor=executor, progress=False, measure=opened)
            for executor in (threads, workers, 2)
        ]
    assert list(tables[0]["status"]) == ["completed"] * 4
    assert told(tables[0]) == told(tables[1]) == told(tables[2])
    # The couplet breaks at f_t times its area, but for the last increment before that: 0.006 mm / 80.
    area = 204.0 * 98.0
    strength = np.array([0.1, 0.1, 0.2, 0.2]) * area / 1000.0
    np.testing.assert_allclose(tables[0]["peak_force_kN"], strength, rtol=0.01)
    assert tables[0].ranking()[0]["parameter"] == "interfaces.joint.f_t"
    assert np.all(tables[0]["widest_mm"] > 0.0)


def test_what_the_model_refuses_is_a_row_or_told_at_once() -> None:
    with ThreadPoolExecutor(2) as threads:
        table = study(
            COUPLET, {"interfaces.joint.f_t": [0.1, -0.1]}, executor=threads, progress=False
        )
        assert list(table["status"]) == ["completed", "failed"]
        assert table[1]["message"] == "interfaces.joint.f_t: -0.1 is negative; fix: give 0 or more"
        with pytest.raises(wythe.ModelError, match="did you mean `f_t`") as error:
            study(COUPLET, {"interfaces.joint.ft": [0.1, 0.2]}, executor=threads, progress=False)
        assert error.value.key == "interfaces.joint.ft"


def test_a_run_that_loses_its_way_counts(tmp_path: Path) -> None:
    # No softening can be followed with one iteration an increment, and no smaller one allowed.
    model = COUPLET.with_(
        {"steps.1.procedure": "static", "steps.1.increments.min": 0.005, "steps.1.tolerance.max_iterations": 1}
    )
    with ThreadPoolExecutor(1) as threads:
        table = study(
            model, {"interfaces.joint.f_t": [0.1]}, executor=threads, progress=False,
            out=tmp_path, keep="results",
        )  # fmt: skip
    assert table[0]["status"] == "not_converged" and table[0]["message"] != ""
    assert table[0]["peak_force_kN"] == pytest.approx(0.1 * 204.0 * 98.0 / 1000.0, rel=0.02)
    assert wythe.Results(table.run_folder(1)).peak_force == table[0]["peak_force_kN"]


def test_samples_of_a_latin_hypercube_run() -> None:
    ranges = {"interfaces.joint.f_t": ("0.1 MPa", "0.2 MPa"), "materials.brick.E": (9e3, 2e4)}
    with ThreadPoolExecutor(2) as threads:
        table = study(
            COUPLET, samples=latin_hypercube(ranges, 5, seed=1), executor=threads, progress=False
        )
    assert table.statuses == {"completed": 5}
    assert table.ranking()[0]["spearman"] == pytest.approx(1.0, abs=1e-12)
