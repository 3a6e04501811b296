"""The table of a study, and the ranking of its parameters."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wythe
from wythe import Study
from wythe._study._journal import Line
from wythe._study._ranking import ranked


def line(sample: int, status: str = "completed", message: str = "", **cells: Any) -> Line:
    """A line with the parameters p and size, and what else is given as measures."""
    return Line(
        sample=sample,
        parameters={"p": f"{sample} MPa", "size": [sample, 2]},
        status=status,
        message=message,
        attempts=1,
        measures=cells,
    )


@pytest.fixture
def table() -> Study:
    """Five samples of six, given out of order."""
    lines = [
        line(3, "not_converged", "lost", peak_force_kN=30.0, increments=5, own="c"),
        line(1, peak_force_kN=10.0, increments=5, own="a"),
        line(2, peak_force_kN=None, increments=6, own="b"),
        line(6, "lost", "its worker died"),
        line(4, "failed", "no <such> thing"),
    ]
    return Study(lines, 6)


def test_rows_come_in_the_order_of_the_samples(table: Study) -> None:
    assert len(table) == 5 and table.total == 6 and table.missing == (5,)
    assert [row["sample"] for row in table] == [1, 2, 3, 4, 6]
    assert table.columns == (
        "sample", "p", "size", "status", "message", "attempts", "peak_force_kN", "increments", "own",
    )  # fmt: skip
    assert table[2] == {
        "sample": 3, "p": "3 MPa", "size": [3, 2], "status": "not_converged", "message": "lost",
        "attempts": 1, "peak_force_kN": 30.0, "increments": 5, "own": "c",
    }  # fmt: skip
    assert table.statuses == {"completed": 2, "not_converged": 1, "failed": 1, "lost": 1}


def test_rows_come_by_slices(table: Study) -> None:
    assert table[1:3] == [table[1], table[2]] and table[-1:] == [table[-1]] and table[9:] == []
    assert table[np.int64(1)] == table[1]  # type: ignore[call-overload]
    with pytest.raises(TypeError, match=r"the number of a row or a slice, got 1\.5"):
        table[1.5]  # type: ignore[call-overload]


def test_columns_are_arrays(table: Study) -> None:
    np.testing.assert_array_equal(table["peak_force_kN"], [10.0, np.nan, 30.0, np.nan, np.nan])
    assert table["sample"].dtype == np.int64 and list(table["sample"]) == [1, 2, 3, 4, 6]
    assert table["status"].dtype.kind == "U"
    assert list(table["size"]) == [[1, 2], [2, 2], [3, 2], [4, 2], [6, 2]]
    assert list(table["own"]) == ["a", "b", "c", None, None]
    with pytest.raises(KeyError, match="no column 'peak'; there are sample, p, size"):
        table["peak"]


def test_the_table_is_told_in_text_and_html(table: Study) -> None:
    text = repr(table)
    assert text.startswith(
        "Study of 6 samples: 2 completed, 1 not converged, 1 failed, 1 lost, 1 not done"
    )
    assert "\n     3  3 MPa  [3, 2]  not_converged             30    c" in text
    assert "sample 4 failed: no <such> thing" in text
    page = table._repr_html_()
    assert "no &lt;such&gt; thing" in page and page.count("<tr>") == 6
    assert repr(Study([], 3)) == "Study of 3 samples: 3 not done"
    long = repr(Study([line(n) for n in range(1, 101)], 100))
    assert len(long.splitlines()) == 15 and "…" in long and long.endswith("100  100 MPa  [100, 2]  completed")


def test_the_table_becomes_a_frame(table: Study) -> None:
    pandas = pytest.importorskip("pandas")
    frame: Any = table.to_pandas()
    assert list(frame.columns) == list(table.columns) and len(frame) == 5
    assert frame["peak_force_kN"].isna().sum() == 3
    assert pandas.api.types.is_float_dtype(frame["peak_force_kN"])


def test_the_table_is_written(table: Study, tmp_path: Path) -> None:
    table.to_csv(tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["sample"] for row in rows] == ["1", "2", "3", "4", "6"]
    assert rows[0]["peak_force_kN"] == "10.0" and rows[1]["peak_force_kN"] == ""
    assert json.loads(rows[0]["size"]) == [1, 2]
    assert list(tmp_path.iterdir()) == [tmp_path / "table.csv"]
    with pytest.raises(wythe.OutputError, match="table.csv: cannot be written"):
        table.to_csv(tmp_path / "none" / "table.csv")
    with pytest.raises(TypeError, match="path: expected a path"):
        table.to_csv(3)  # type: ignore[arg-type]


def test_ties_share_their_mean_rank() -> None:
    # Ranks 4, 1, 4, 2, 4 and 1 to 5: Pearson's correlation of those is 1 / sqrt(8 * 10).
    ranking = ranked("y", [1, 2, 3, 4, 5], {"a": [3, 1, 3, 2, 3]}, [False] * 5)
    assert ranking[0]["spearman"] == pytest.approx(1.0 / np.sqrt(80.0), abs=1e-12)


def test_a_linear_measure_is_ranked_by_its_coefficients() -> None:
    random = np.random.default_rng(1)
    a, b, c = random.normal(size=(3, 400))
    y = 3.0 * a - b + 0.1 * random.normal(size=400)
    inputs = {"c": list(c), "b": list(b), "a": list(a), "d": [2.0] * 400}
    ranking: wythe.Ranking = ranked("y", list(y), inputs, [False] * 400)
    first: wythe.Rank = ranking.ranks[0]
    assert first == ranking[0]
    assert [rank["parameter"] for rank in ranking] == ["a", "b", "c"]
    # Coefficient times deviation of the column over that of y, to what noise of 0.1 leaves of 3 in 400
    # samples: 0.1 / 3 / sqrt(400) = 0.002; three times that.
    regression = {rank["parameter"]: rank["regression"] for rank in ranking}
    assert regression["a"] == pytest.approx(3.0 * a.std() / y.std(), abs=0.005)
    assert regression["b"] == pytest.approx(-b.std() / y.std(), abs=0.005)
    assert abs(regression["c"]) < 0.005
    assert ranking.r_squared == pytest.approx(1.0 - 0.01 / y.var(), abs=1e-3)
    assert ranking.left_out == {"d": "constant"}
    assert abs(ranking[2]["spearman"]) < 3 * ranking.noise and ranking[1]["spearman"] < -ranking.noise


def test_what_is_monotone_is_ranked_first_however_bent() -> None:
    a = np.linspace(0.1, 3.0, 30)
    b = np.tile([1.0, 2.0, 3.0], 10)
    y = np.exp(4.0 * a)
    ranking = ranked("y", list(y), {"b": list(b), "a": list(a)}, [False] * 30)
    assert ranking[0]["parameter"] == "a" and ranking[0]["spearman"] == pytest.approx(1.0, abs=1e-12)
    assert ranking.r_squared < 0.8
    falling = ranked("y", list(-y), {"a": list(a)}, [False] * 30)
    steepest = falling[0]
    assert steepest["spearman"] == pytest.approx(-1.0, abs=1e-12)


def test_quantities_flags_and_words_are_told_apart() -> None:
    inputs: dict[str, list[object]] = {
        "q": ["0.1 MPa", "0.3 MPa", "0.2 MPa", "0.4 MPa"],
        "mixed": ["0.1 MPa", "300 kPa", "0.2 MPa", "0.4 MPa"],
        "word": ["eff1", "lit", "eff1", "lit"],
        "flag": [False, True, False, True],
    }
    ranking = ranked("y", [1.0, 3.0, 2.0, 4.0], inputs, [False, True, True, False])
    assert {rank["parameter"]: rank["spearman"] for rank in ranking} == {
        "q": pytest.approx(1.0), "flag": pytest.approx(np.sqrt(0.8)),
    }  # fmt: skip
    assert ranking.left_out == {"mixed": "not numbers of one unit", "word": "not numbers of one unit"}
    assert ranking.not_converged == 2 and "2 of them not converged" in repr(ranking)


def test_samples_without_the_measure_are_left_out() -> None:
    y = [1.0, None, 3.0, float("nan"), 2.0]
    ranking = ranked("y", y, {"a": [1, 9, 3, -9, 2]}, [True, True, False, False, False])
    assert ranking.samples == 3 and ranking.not_converged == 1
    assert ranking[0]["spearman"] == pytest.approx(1.0)


def test_dependent_columns_have_no_coefficients() -> None:
    a = [1.0, 2.0, 3.0, 4.0, 7.0, 5.0]
    ranking = ranked("y", a, {"a": a, "b": [2 * x for x in a]}, [False] * 6)
    assert all(np.isnan(rank["regression"]) for rank in ranking)
    assert "dependent columns" in repr(ranking) and "–" in ranking._repr_html_()


def test_nothing_to_rank_is_said() -> None:
    same = ranked("y", [2.0] * 5, {"a": list(range(5))}, [False] * 5)
    assert len(same) == 0 and same.left_out == {"a": "y is constant"} and "constant" in repr(same)
    few = ranked("y", [1.0, 2.0], {"a": [1, 2]}, [False] * 2)
    assert few.left_out == {"a": "fewer than 3 samples have y"}
    with pytest.raises(ValueError, match="of: expected a column of numbers, y is none"):
        ranked("y", ["a", "b"], {}, [False] * 2)
    with pytest.raises(KeyError, match="of: no column 'peak'"):
        Study([line(1)], 1).ranking("peak")


def test_a_ranking_becomes_a_frame() -> None:
    pytest.importorskip("pandas")
    frame: Any = ranked("y", [1.0, 3.0, 2.0], {"a": [1, 2, 3]}, [False] * 3).to_pandas()
    assert list(frame.columns) == ["parameter", "spearman", "regression"]
    assert frame["spearman"][0] == pytest.approx(0.5)
