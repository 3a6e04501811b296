"""Strategies: one deck, modelled in several ways."""

from __future__ import annotations

from pathlib import Path

import pytest

import wythe

WALL = Path(__file__).resolve().parents[3] / "examples" / "61_wall_with_opening.toml"


def wall() -> wythe.Model:
    return wythe.Model.from_toml(WALL).with_({"steps.1.displacement": "0.2 mm"})


def test_a_model_changes_its_strategy() -> None:
    model = wall()
    coarse = model.with_(strategy="simplified")
    notes = coarse.check().notes
    assert any("by Hilsdorf" in note for note in notes)
    few, many = (m.run() for m in (coarse, model))
    forces = [results.history["force_kN"][-1] for results in (few, many)]
    # Both are elastic up to here; the expanded wall is as stiff within 5 %.
    assert forces[0] == pytest.approx(forces[1], rel=0.05)


def test_a_derived_model_refuses_another_strategy() -> None:
    coarse = wall().with_(strategy="simplified")
    with pytest.raises(wythe.ModelError, match="expanded"):
        coarse.with_(strategy="detailed")


def test_a_limit_has_no_run() -> None:
    with pytest.raises(wythe.LimitError, match="no run"):
        wall().with_(strategy="limit").run()
