"""The history of a run: its columns, what they mean, and how they leave."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
import wythe
from helpers import borrowed, read_only


def test_the_history_is_that_of_the_file(wall: wythe.Results) -> None:
    history = wall.history
    with open(Path(wall.path) / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(history) == [*rows[0], "driven"]
    assert len(history) == len(list(history))
    assert history.increments == len(rows)
    for name, column in history.items():
        if name == "procedure":
            read_only(column)
        else:
            borrowed(column, (len(rows),), column.dtype.type)
        assert getattr(history, name) is column
        if name == "driven":
            continue
        read = [row[name] for row in rows]
        assert column.tolist() == (read if name == "procedure" else [float(text) for text in read])
    whole = {name for name, column in history.items() if column.dtype == np.int64}
    counts = ("increment", "step", "iterations", "cutbacks", "open_points", "sliding_points")
    assert whole == set(counts)
    assert history.procedure.dtype.kind == "U"


def test_the_types_of_columns_are_those_that_are_told() -> None:
    """Annotations of the class against what a history has, so that editors and checkers say the truth."""
    told = dict(wythe.History.__annotations__)
    run = wythe.templates.couplet().run()
    own = [name for name in run.history if name not in run.history.probes]
    assert list(told) == own
    kinds: dict[str, type[np.generic]] = {
        "Floats": np.float64,
        "Integers": np.int64,
        "npt.NDArray[np.str_]": np.str_,
        "npt.NDArray[np.bool_]": np.bool_,
    }
    for name, column in run.history.items():
        told.setdefault(name, "Floats")
        assert column.dtype.type is kinds[told[name]], name


def test_driven_rows_are_those_of_drives(wall: wythe.Results, couplet: wythe.Results) -> None:
    assert (wall.history.driven == (wall.history.step == 1)).all()
    assert couplet.history.driven.all()


def test_a_history_speaks(couplet: wythe.Results, tmp_path: Path) -> None:
    history = couplet.history
    with pytest.raises(KeyError, match="forces: the history has increment, step, "):
        history["forces"]
    with pytest.raises(AttributeError, match="no column 'forces'"):
        history.forces  # noqa: B018
    assert "force_kN" in dir(history)
    assert "force_kN" in history
    assert history.probes[0] == "base_shear_kN"
    assert f"{history.increments} increments of increment, step" in repr(history)
    shown = history._repr_html_()
    assert shown.count("<tr>") == 11
    assert f"{history.increments} increments, 31 columns" in shown
    frame = history.to_pandas()
    assert frame.index.name == "increment"
    assert (frame["force_kN"].to_numpy() == history.force_kN).all()
    path = history.to_csv(tmp_path / "history.csv")
    with open(path, newline="") as file:
        again = [float(row["force_kN"]) for row in csv.DictReader(file)]
    assert again == history.force_kN.tolist()
    with pytest.raises(wythe.OutputError, match="cannot be written"):
        history.to_csv(tmp_path / "no" / "history.csv")


def test_the_energies_add_up(wall: wythe.Results) -> None:
    history = wall.history
    stored = history.elastic_energy_J + history.kinetic_energy_J
    dissipated = (
        history.plastic_damage_dissipation_J
        + history.interface_dissipation_J
        + history.viscous_dissipation_J
        + history.damping_dissipation_J
        + history.numerical_dissipation_J
    )
    gap = np.abs(history.external_work_J - stored - dissipated).max()
    assert gap / history.external_work_J.max() == pytest.approx(wall.energy_balance_error, abs=1e-3)
    assert wall.energy_balance_error < 0.01
    # Statics: nothing moves in time. The numerical part is of points that cross from facet to facet.
    assert not history.kinetic_energy_J.any()
    assert not history.damping_dissipation_J.any()
    assert np.abs(history.numerical_dissipation_J).max() < 1e-3 * history.external_work_J.max()
    # What is dissipated stays so.
    assert (np.diff(history.interface_dissipation_J) > -1e-6).all()
    assert (np.diff(history.plastic_damage_dissipation_J) > -1e-6).all()


def test_the_columns_mean_what_they_are_called(wall: wythe.Results) -> None:
    history = wall.history
    assert history.increment.tolist() == list(range(1, history.increments + 1))
    assert (np.diff(history.time) > 0.0).all()
    assert history.time[-1] == pytest.approx(2.0)
    assert history.displacement_mm[-1] == pytest.approx(0.6)
    # 1 MPa on 420.5 x 98 mm; then the beam is held where it is, and the wall dilates against it.
    preload = history.reaction_kN[history.step == 0][-1]
    assert preload == pytest.approx(420.5 * 98e-3, rel=1e-3)
    assert (history.reaction_kN[history.driven] > 0.5 * preload).all()
    assert history.load_factor[-1] == pytest.approx(1.0)
    assert (history.iterations >= 1).all()
    assert (history.cutbacks >= 0).all()
    frame = wall.frame()
    assert history.max_tensile_damage[-1] == frame.tensile_damage.max()
    assert history.max_compressive_damage[-1] == frame.compressive_damage.max()
    assert history.max_interface_damage[-1] == frame.interfaces.damage.max()
    assert 0 < history.sliding_points[-1] <= len(frame.interfaces)
    assert 0 < history.open_points[-1] <= (frame.interfaces.opening > 0.0).sum()
    assert 0.0 < history.contact_area_mm2[-1] < history.contact_area_mm2[0]
    # The balance that is kept: 5 % of the mean nodal force at the worst node.
    assert history.residual.max() <= 0.05
    assert history.out_of_balance.max() <= 0.05
    assert set(history.procedure) == {"static"}
